# SPDX-License-Identifier: MIT
"""Each option in each front end: present under the name in `tactor help OPTION`, or left out for a reason."""
import json
import re

from harness import ROOT, ToolTest, main

COMMANDS = ("plan", "render", "plot", "compare", "play", "check", "calibrate", "experiment", "devices", "off", "serve")
GROUPS = ("Stroke", "Place", "Timing", "Sound", "Level", "Device", "Real time", "Output")
OWNER = "the owner's: it guards people or the machine"
OTHER = "a separate parameter of the protocol"
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
# Options that a method of an experiment leaves to the definition or the session.
NO_METHOD = {
    "duration": "a motion's", "speed": "a motion's", "compensate": "of people who are asked what they feel, it would decide the answer",
    "sigma-mm": "of compensate", "sigma-v-mm-s": "of compensate", "waveform": "all methods of a study vibrate alike",
    "am": "all methods of a study vibrate alike", "noise-seed": "of waveform", "phase": "all methods of a study sound alike",
    "ramp": "all methods of a study sound alike", "envelope": "all methods of a study sound alike", "attack": "of envelope", "release": "of envelope",
    "level-dbfs": "[experiment] level", "sl": "[experiment] level", "intensity-scale": "its motions have the intensities that they have",
    "stevens-exponent": "of intensity-scale", "intensity-max": "a recording's",
}
# Options that a stroke file may give for one stroke. The other options of planning hold for the piece: its strokes share one
# clock and one array.
IN_STROKE = {"duration", "speed", "carrier", "algorithm", "phantom", "faces", "soa", "burst", "waveform", "noise-seed", "texture", "texture-mm", "fit"}
# Other differences between front ends, and their reasons:
# - Configuration: Python's Player and devices() read its [defaults]; plan(), Score() and live() read those of the array file alone, so that a
#   plan is the same on each machine. marker_channel is [sync]'s on the command line, beside the wires.
# - Time: Python gives all times in seconds (latency, sync_delay); the tool's --latency-ms is what other audio programs have. A stream's
#   `longest` and `frame` are a program's; a person presses Ctrl-C.
# - Waiting: a client's next point comes from a program, 0.5 s; play --live reads lines that a person may type, a day. A lost device: play
#   ends, since somebody sees it; an experiment waits an hour for its participant's; calibrate and a walk begin again, because a threshold and a
#   place count on one device; serve waits as long as it runs.
# - Python: intensity_max is an argument of load(), parse() and Stroke.timed(), which read recordings; the service takes it from its clients
#   alone, since [defaults] would weaken what they draw themselves.
# - Bounds: calibrate's seed and --spread-seed are of 32 bits. ALSA has 1024 channels at most, a rendered score may have more. A file's strokes lie within a day.
# - One name for two things, in two commands: --power, --log, --method, --page, --seed. The manual says so at each.
# - /tactor/drive of OSC has its intensity always, as OSC's arguments have places, not names; levels_hz is a page's, which has a WebSocket.
# - drive (one tactor) is for finding wires from a program; a person has check --walk.


def options_of_the_manual():
    """Maps each group of tactor-options(7) to its options, and these to head and text without macros."""
    section = (ROOT / "man/tactor-options.7").read_text(encoding="utf-8").partition("\n.Sh OPTIONS\n")[2].partition("\n.Sh ")[0]
    parts = re.split(r"^\.Ss (.*)$", section, flags=re.M)
    groups = {}
    for title, body in zip(parts[1::2], parts[2::2]):
        if title in GROUPS:
            entries = re.findall(r"^\.It Fl (?:\w , )?-([a-z-]+) ?(.*)\n((?:(?!\.It |\.El$).*\n)*)", body, re.M)
            groups[title] = {name: (head, plain(text)) for name, head, text in entries}
    return groups


def plain(text):
    words = re.sub(r"\b(?:Cm|Ar|Ns|Pq) ", "", re.sub(r"\bFl -", "--", re.sub(r"^\.(?=[A-Z])", "", text, flags=re.M)))
    return re.sub(r" (?=[.,;])", "", " ".join(words.split()))


class Options(ToolTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.told = {}

    def list_groups(self, command):
        """Maps each group of the table to the names in it, as --help lists them."""
        parts = re.split(r"^(\w[\w ]*):$", self.ok(command, "--help-all").stdout, flags=re.M)
        return {title: re.findall(r"^  (?:-\w,)?--([a-z][a-z-]*)", body, re.M) for title, body in zip(parts[1::2], parts[2::2]) if title in GROUPS}

    def list_options(self, command):
        return set().union(*self.list_groups(command).values())

    def about(self, name):
        if name not in self.told:
            text = self.ok("help", name).stdout
            self.told[name] = dict(re.findall(r"^  (\S[^:\n]*): +(.*)$", text, re.M))
        return self.told[name]

    def every(self):
        return sorted(set().union(*map(self.list_options, COMMANDS)))

    def test_help_names_the_commands_that_take_an_option(self):
        takes = {command: self.list_options(command) for command in COMMANDS}
        self.assertGreater(len(self.every()), 60)
        for name in self.every():
            said = self.about(name)["Commands"].split(", ")
            self.assertEqual(said, [c for c in COMMANDS if name in takes[c]], name)

    def test_the_manual_lists_each_option_in_its_group_in_the_order_of_help(self):
        page = options_of_the_manual()
        self.assertEqual(sorted(name for group in page.values() for name in group), self.every())
        for command in COMMANDS:
            for group, names in self.list_groups(command).items():
                self.assertEqual([name for name in page[group] if name in names], names, f"{command}: {group}")

    def test_the_manual_has_the_values_range_default_and_commands_of_each_option(self):
        for name, (head, body) in {k: v for group in options_of_the_manual().values() for k, v in group.items()}.items():
            with self.subTest(name):
                title, help_line = self.ok("help", name).stdout.splitlines()[:2]
                form = title.partition(" ")[2]
                if re.fullmatch(r"[a-z0-9-]+(\|[a-z0-9-]+)+", form):
                    self.assertEqual(head, f"Cm {form.replace('|', ' | ')}")
                self.assertEqual(bool(head), bool(form))
                self.assertIn(f"Commands: {self.about(name)['Commands']}.", body)
                if "Range" in self.about(name):
                    self.assertIn(f"Range: {self.about(name)['Range']}.", body)
                if usual := re.search(r"\(default:? ([^);]+)", help_line):
                    self.assertIn(f"Default: {usual[1]}.", body)

    def test_a_client_has_each_option_or_there_is_a_reason(self):
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

    def test_a_method_of_an_experiment_has_each_option_or_there_is_a_reason(self):
        page = (ROOT / "man/tactor-experiment.5").read_text(encoding="utf-8")
        line = re.search(r"^\.It Cm (algorithm .*)$", page, re.M)[1]
        by_method = {name for name in self.every() if "[[method]]" in self.about(name)}
        self.assertEqual({w.replace("_", "-") for w in re.findall(r"[a-z_-]{2,}", line)}, by_method)
        clients = {name for name in self.every() if "JSON-RPC" in self.about(name)}
        self.assertEqual(clients - by_method, set(NO_METHOD))

    def test_a_stroke_of_a_file_has_the_options_of_a_stroke(self):
        self.assertEqual({n for n in self.every() if "Stroke files" in self.about(n)}, IN_STROKE)

    def test_a_prediction_takes_no_option_that_only_sounds(self):
        compare = self.list_options("compare")
        self.assertLessEqual({"carrier", "sl", "intensity-scale", "stevens-exponent"}, compare)
        for name in ("level-dbfs", "ramp", "phase", "envelope", "attack", "release", "am", "waveform", "rate", "sample-format"):
            self.assertIn(name, self.list_options("plan"))
            self.assertNotIn(name, compare)

    def test_each_command_that_measures_takes_the_options_of_the_device(self):
        of_stream = {"latency-ms", "period-frames", "periods", "require-realtime", "no-gpio"}
        for command in ("play", "check", "serve", "calibrate", "experiment"):
            self.assertLessEqual(of_stream, self.list_options(command), command)
        self.assertIn("sync-delay-ms", self.list_options("serve"))
        for option in ("--no-gpio", "--require-realtime", "--verbose"):
            self.refused(2, "calibrate", "--participant", "P1", "-o", "c.toml", "--simulate", "seed=1", option, says=[option, "nothing is played"])
        self.refused(2, "experiment", "park2016", "--participant", "P1", "-o", "study", "--simulate", "seed=1,sigma=1", "--periods", "4")

    def test_each_key_of_defaults_is_accepted_by_its_name(self):
        for name in self.every():
            if "[defaults]" in self.about(name):
                file = self.write("d.toml", f"[defaults]\n{self.about(name)['[defaults]']} = []\n")
                self.refused(2, "plan", "park2016-1", "--config", file, says=[f"d.toml:2:{len(name) + 4}: {name} is"])

    def test_no_command_takes_an_unknown_option(self):
        self.refused(2, "help", "nosuch")
        for name in ("soa", "--soa", "max-drive-s", "max_drive_s"):
            self.assertIn("Range:", self.ok("help", name).stdout)

    def test_help_explains_the_options_of_single_commands_too(self):
        for command in COMMANDS + ("analyze", "report", "status"):
            for name in re.findall(r"^  (?:-\w,)?--([a-z-]+)", self.ok(command, "--help-all").stdout, re.M):
                if name not in ("help", "help-all"):
                    text = self.ok("help", name).stdout
                    self.assertRegex(text, rf"Commands:.*\b{command}\b|tactor {command}: --{name}\b", name)


if __name__ == "__main__":
    main()
