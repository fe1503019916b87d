# SPDX-License-Identifier: MIT
"""Each option in each front end: there by the name that `tactor help OPTION` says, or left out for a reason."""
import json
import re

from harness import ROOT, ToolTest, main

COMMANDS = ("plan", "render", "plot", "compare", "play", "check", "calibrate", "experiment", "devices", "off", "serve")
GROUPS = ("Stroke", "Place", "Timing", "Sound", "Level", "Device", "Real time", "Output")
OWNER = "the owner's: it guards people or the machine"
OTHER = "a parameter of its own in the protocol"
# Options that no client of the service may give.
NO_CLIENT = {
    "path": OTHER, "shape": OTHER, "live": OTHER, "smooth": OTHER, "arm": OTHER,
    "array": OWNER, "config": OWNER, "device": OWNER, "channels": OWNER, "rate": OWNER, "sample-format": OWNER, "no-gpio": OWNER,
    "power-dbfs": OWNER, "max-drive-s": OWNER, "drive-window-s": OWNER, "latency-ms": OWNER, "period-frames": OWNER, "periods": OWNER,
    "require-realtime": OWNER, "reopen-s": OWNER, "sync-delay-ms": OWNER, "verbose": OWNER, "log": OWNER,
    "texture": "a client names no file", "texture-mm": "a client names no file",
    "fit": "a file that a client sends may say it", "fit-margin": "a file that a client sends may say it",
    "void-on-xrun": "the client sees each end itself", "observer": "a comparison is the tool's", "spread": "a comparison is the tool's",
    "spread-seed": "a comparison is the tool's", "spread-sigma": "a comparison is the tool's", "spread-threshold-db": "a comparison is the tool's",
    "spread-place-mm": "a comparison is the tool's",
}
# Options that a method of an experiment leaves to the definition, or to the session.
NO_METHOD = {
    "duration": "a motion's", "speed": "a motion's", "compensate": "of people who are asked what they feel, it would decide the answer",
    "sigma-mm": "of compensate", "sigma-v-mm-s": "of compensate", "waveform": "all methods of a study vibrate alike",
    "am": "all methods of a study vibrate alike", "noise-seed": "of waveform", "phase": "all methods of a study sound alike",
    "ramp": "all methods of a study sound alike", "envelope": "all methods of a study sound alike", "attack": "of envelope", "release": "of envelope",
    "level-dbfs": "[experiment] level", "sl": "[experiment] level", "intensity-scale": "its motions have the intensities that they have",
    "stevens-exponent": "of intensity-scale",
}


class Options(ToolTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.told = {}

    def options_of(self, command):
        """Names in the groups of the table, as --help lists them."""
        text = self.ok(command, "--help").stdout
        parts = re.split(r"^(\w[\w ]*):$", text, flags=re.M)
        inside = "".join(body for title, body in zip(parts[1::2], parts[2::2]) if title in GROUPS)
        return set(re.findall(r"^  (?:-\w,)?--([a-z][a-z-]*)", inside, re.M))

    def about(self, name):
        if name not in self.told:
            text = self.ok("help", name).stdout
            self.told[name] = dict(re.findall(r"^  (\S[^:\n]*): +(.*)$", text, re.M))
        return self.told[name]

    def every(self):
        return sorted(set().union(*map(self.options_of, COMMANDS)))

    def test_help_says_which_commands_take_an_option(self):
        takes = {command: self.options_of(command) for command in COMMANDS}
        self.assertGreater(len(self.every()), 60)
        for name in self.every():
            said = self.about(name)["Commands"].split(", ")
            self.assertEqual(said, [c for c in COMMANDS if name in takes[c]], name)

    def test_the_manual_has_each(self):
        page = (ROOT / "man/tactor.1").read_text(encoding="utf-8")
        for name in self.every():
            self.assertRegex(page, rf"(?m)^\.(It|Fl|Op|Pq)?.*\bFl (\w , )?-{name}\b", name)

    def test_a_client_has_each_or_there_is_a_reason(self):
        schema = json.loads((ROOT / "src/cli/schemas/tactor-protocol-1.schema.json").read_text(encoding="utf-8"))
        known = schema["$defs"]["options"]["properties"]
        page = (ROOT / "man/tactor-protocol.7").read_text(encoding="utf-8")
        section = page.partition(".Ss Options\n")[2].partition(".Bd")[0]
        on_page = set(re.findall(r"[a-z_]{2,}", " ".join(re.findall(r"^\.Cm (.*)$", section, re.M)))) - {"options"}
        by_client = {name for name in self.every() if "JSON-RPC" in self.about(name)}
        self.assertEqual({self.about(n)["JSON-RPC"].removeprefix("options.") for n in by_client}, set(known))
        self.assertEqual(set(known), on_page)
        self.assertEqual(set(self.every()) - by_client, set(NO_CLIENT))
        for name in by_client:
            self.assertEqual(self.about(name)["OSC"], name.replace("-", "_") + "=")

    def test_a_method_of_an_experiment_has_each_or_there_is_a_reason(self):
        page = (ROOT / "man/tactor-experiment.5").read_text(encoding="utf-8")
        line = re.search(r"^\.It Cm (algorithm .*)$", page, re.M)[1]
        by_method = {name for name in self.every() if "[[method]]" in self.about(name)}
        self.assertEqual({w.replace("_", "-") for w in re.findall(r"[a-z_-]{2,}", line)}, by_method)
        clients = {name for name in self.every() if "JSON-RPC" in self.about(name)}
        self.assertEqual(clients - by_method, set(NO_METHOD))

    def test_each_key_of_defaults_is_taken_by_its_name(self):
        for name in self.every():
            if "[defaults]" in self.about(name):
                file = self.write("d.toml", f"[defaults]\n{self.about(name)['[defaults]']} = []\n")
                self.refused(2, "plan", "park2016-1", "--config", file, says=[f"d.toml:2:{len(name) + 4}: {name} is"])

    def test_what_is_no_option_is_no_command_either(self):
        self.refused(2, "help", "nosuch", says=["nosuch", "no such command"])
        for name in ("soa", "--soa", "max-drive-s", "max_drive_s"):
            self.assertIn("Range:", self.ok("help", name).stdout)


if __name__ == "__main__":
    main()
