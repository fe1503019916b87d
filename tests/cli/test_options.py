# SPDX-License-Identifier: MIT
"""Each option in each front end: present under the name in `tactor help OPTION`, or left out for a reason; and the manual."""
import json
import re
import subprocess

from harness import ROOT, TOOL, ToolTest, main

COMMANDS = ("plan", "render", "plot", "convert", "compare", "play", "check", "calibrate", "experiment", "devices", "off", "serve")
GROUPS = ("Stroke", "Place", "Timing", "Sound", "Level", "Device", "Real time", "Output")
OWNER = "the owner's: it guards people or the machine"
OTHER = "a separate parameter of the protocol"
# Options that no client of the service may give.
NO_CLIENT = {
    "path": OTHER, "shape": OTHER, "live": OTHER, "smooth": OTHER, "arm": OTHER,
    "array": OWNER, "config": OWNER, "device": OWNER, "channels": OWNER, "rate": OWNER, "sample-format": OWNER, "no-gpio": OWNER, "no-desktop": OWNER,
    "power-dbfs": OWNER, "max-drive-s": OWNER, "drive-window-s": OWNER, "latency-ms": OWNER, "period-frames": OWNER, "periods": OWNER,
    "require-realtime": OWNER, "reopen-s": OWNER, "sync-delay-ms": OWNER, "verbose": OWNER, "log": OWNER,
    "texture": "a client names no file", "texture-mm": "a client names no file",
    "fit": "a file that a client sends may say it", "fit-margin": "a file that a client sends may say it",
    "void-on-xrun": "the client sees each end itself", "observer": "a comparison is the tool's", "spread": "a comparison is the tool's",
    "spread-seed": "a comparison is the tool's", "spread-sigma": "a comparison is the tool's", "spread-threshold-db": "a comparison is the tool's",
    "spread-place-mm": "a comparison is the tool's",
}
# Options of a client that no option of a method is.
NO_METHOD = dict.fromkeys(("intensity-max", "position"), "a key of the method's own file, as of a motion's")
# Options that a stroke file may give for one stroke. The other options of planning hold for the piece: its strokes share one
# clock and one array.
IN_STROKE = {"duration", "speed", "carrier", "algorithm", "phantom", "faces", "soa", "burst", "waveform", "noise-seed", "texture", "texture-mm", "fit"}
# Options that commands use and only [defaults] of a file sets: about a place on the body, a person or an observer.
FILE_ONLY = {"slope", "intercept", "min-duration", "sigma-v-mm-s", "stevens-exponent", "spread-seed", "no-desktop"}
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
# - Bounds: calibrate's seed and spread-seed are of 32 bits. ALSA has 1024 channels at most, a rendered score may have more. A file's strokes lie within a day.
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
            entries = re.findall(r"^\.It (?:Fl (?:\w , )?-|Cm )([a-z-]+) ?(.*)\n((?:(?!\.It |\.El$).*\n)*)", body, re.M)
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
            text = self.ok("help", name).stdout.partition("\n\n")[0]  # a key of files may follow
            self.told[name] = dict(re.findall(r"^  (\S[^:\n]*): +(.*)$", text, re.M))
        return self.told[name]

    def every(self):
        return sorted(FILE_ONLY.union(*map(self.list_options, COMMANDS)))

    def test_help_names_the_commands_that_take_an_option(self):
        takes = {command: self.list_options(command) for command in COMMANDS}
        self.assertGreater(len(self.every()), 60)
        for name in set(self.every()) - FILE_ONLY:
            said = self.about(name)["Commands"].split(", ")
            self.assertEqual(said, [c for c in COMMANDS if name in takes[c]], name)

    def test_only_a_file_sets_what_describes_a_place_a_person_an_observer_or_a_computer(self):
        value = {"slope": 0.4, "intercept": 0.03, "min-duration": 0.069, "sigma-v-mm-s": 80, "stevens-exponent": 0.9, "spread-seed": 2,
                 "no-desktop": "true"}
        plain = {"plan": ("--timing", "fit", "--compensate", "low-speed", "--intensity-scale", "stevens"), "compare": ("--spread", "20")}
        for name in FILE_ONLY:
            about = self.about(name)
            self.assertEqual((about["[defaults]"], "Commands" in about), (name, False))
            for command in about["Used by"].split(", "):
                self.assertNotIn(name, self.list_options(command))
                required = {"render": ("-o", "x.wav"), "plot": ("-o", "x.svg"), "convert": ("x.toml",), "calibrate": ("--participant", "P1", "-o", "x.toml"),
                            "experiment": ("--participant", "P1", "-o", "x")}.get(command, ())
                stroke = () if command in ("check", "calibrate", "serve") else ("soft.csv",)
                said = self.refused(2, command, *stroke, *required, f"--{name}", str(value[name])).stderr
                self.assertIn(f"--{name}: only a file can set it (put {name} into [defaults] of a file for --array)", said)
            if name == "no-desktop":  # tests/session/test_reserved.cpp tries it
                continue
            # The cure works.
            self.write("soft.csv", "t_s,x_mm,y_mm,intensity\n0,5,5,0.4\n0.51,35,35,0.4\n")
            self.write("felt.toml", f'[array]\npreset = "palm-3x3"\n[defaults]\n{name} = {value[name]}\n')
            command = "compare" if name == "spread-seed" else "plan"
            args = (command, "soft.csv", *plain[command], "--format", "json")
            self.assertNotEqual(self.run_tool(*args, "--array", "felt.toml").stdout, self.ok(*args).stdout, name)

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
                takers = f"[defaults] of a file sets it, for {self.about(name)['Used by']}." if name in FILE_ONLY else f"Commands: {self.about(name)['Commands']}."
                self.assertIn(takers, body)
                if "Range" in self.about(name):
                    self.assertIn(f"Range: {self.about(name)['Range']}.", body)
                if usual := re.search(r"\(default:? ([^);]+)", help_line):
                    self.assertIn(f"Default: {usual[1]}.", body)

    def test_a_client_has_each_option_or_there_is_a_reason(self):
        schema = json.loads((TOOL.parent / "schemas/tactor-protocol-1.schema.json").read_text(encoding="utf-8"))
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
        part = re.search(r"^\.Ss Methods\n(.*?)^\.Ss ", page, re.M | re.S)[1]
        keys = {key.replace("_", "-") for line in re.findall(r"^\.It Cm (.*)$", part, re.M) for key in line.split(" , ")}
        by_method = {name for name in self.every() if "[[method]]" in self.about(name)}
        self.assertEqual(keys - {"name", "preset", "path", "file", "intensity-max", "position"}, by_method)
        clients = {name for name in self.every() if "JSON-RPC" in self.about(name)}
        self.assertEqual(clients - by_method, set(NO_METHOD))

    def test_a_stroke_of_a_file_has_the_options_of_a_stroke(self):
        self.assertEqual({n for n in self.every() if "Stroke files" in self.about(n)}, IN_STROKE)

    def test_a_prediction_takes_no_option_that_only_sounds(self):
        compare = self.list_options("compare")
        self.assertLessEqual({"carrier", "sl", "intensity-scale"}, compare)
        for name in ("level-dbfs", "ramp", "phase", "envelope", "attack", "release", "am", "waveform", "rate", "sample-format"):
            self.assertIn(name, self.list_options("plan"))
            self.assertNotIn(name, compare)

    def test_each_command_that_measures_takes_the_options_of_the_device(self):
        of_stream = {"latency-ms", "period-frames", "periods", "require-realtime", "no-gpio"}
        for command in ("play", "check", "serve", "calibrate", "experiment"):
            self.assertLessEqual(of_stream, self.list_options(command), command)
        self.assertIn("sync-delay-ms", self.list_options("serve"))
        for option in ("--no-gpio", "--require-realtime", "--verbose"):
            self.refused(2, "calibrate", "--participant", "P1", "-o", "c.toml", "--simulate", "seed=1", option, says=[option, "a simulated session plays nothing"])
        self.refused(2, "experiment", "park2016", "--participant", "P1", "-o", "study", "--simulate", "seed=1,sigma=1", "--periods", "4")

    def test_help_takes_an_option_in_any_spelling(self):
        for name in ("soa", "--soa", "max-drive-s", "max_drive_s"):
            self.assertIn("Range:", self.ok("help", name).stdout)

    def test_help_explains_the_options_of_single_commands_too(self):
        for command in COMMANDS + ("analyze", "report", "status"):
            for name in re.findall(r"^  (?:-\w,)?--([a-z-]+)", self.ok(command, "--help-all").stdout, re.M):
                if name not in ("help", "help-all"):
                    text = self.ok("help", name).stdout
                    self.assertRegex(text, rf"Commands:.*\b{command}\b|tactor {command}: --{name}\b", name)

    def test_keys_of_defaults_have_the_ranges_of_their_options_in_the_manual(self):
        table = re.search(r"^\[defaults\]\tunit\tvalues\n(.*?)^\.TE", read_page("tactor.toml.5"), re.M | re.S)[1]
        keys = [(key, said) for key, said in re.findall(r"^([\w-]+)\t.*\tT\{\n(.*)\nT\}$", table, re.M) if re.match(RANGE, said)]
        self.assertGreaterEqual(len(keys), 17)
        for key, said in keys:
            self.assertEqual(read_range(said), read_range(self.about(key)["Range"]), key)


# The readers of files, and what their lists of keys look like.
READERS = {
    "files/setup.cpp": r"refuse_other_keys\(\s*\{([^}]*)\}", "files/stroke/toml.cpp": r"(?:refuse_other_keys\(|(?:_keys|kinds)\[\] = )\{([^}]*)\}",
    "options/serve.cpp": r"\bkey\{(\"\w+\")", "study/data/page_words.cpp": r"page_word\{(\"\w+\")",
    "study/data/questionnaire.cpp": r"refuse_other_keys\(\{([^}]*)\}", "study/experiment/read_definition.cpp": r"refuse_other_keys\(\{([^}]*)\}",
}


class Keys(ToolTest):
    def test_help_explains_each_key_that_a_reader_accepts(self):
        for file, lists in READERS.items():
            names = set(re.findall(r'"(\w+)"', " ".join(re.findall(lists, (ROOT / "src" / file).read_text(encoding="utf-8")))))
            self.assertGreater(len(names), 5, file)
            for name in names - {"experiment", "serve"}:  # commands
                self.assertRegex(self.ok("help", name).stdout, r"In files: |: see tactor|Stroke files: |\[defaults\]: ", f"{file}: {name}")

    def test_it_names_each_table_and_says_what_the_manual_says(self):
        for word, tables in (("max_dbfs", ["[array]", "[[tactor]]"]), ("pulse-ms", ["[sync]", "[sync]"]), ("level_dbfs", ["[masking]"]),
                             ("slope", ["[[run]]"]), ("pitch_mm", ["[array]"]), ("chip", ["[amplifier]", "[sync]", "[sync]"])):
            self.assertEqual(re.findall(r"^  In files: +(\S+),", self.ok("help", word).stdout, re.M), tables, word)
        for word in ("limits", "[limits]"):
            self.assertIn("[limits]: see tactor.toml(5); tactor help KEY explains a key\n  power_dbfs, max_drive_s, window_s\n", self.ok("help", word).stdout)
        said = self.ok("help", "rest_s").stdout
        self.assertIn('A list of two times, as rest_s = [2, 4], draws', " ".join(said.split()))
        self.assertIn("see tactor-experiment(5)", said)
        self.assertIn("  Range:            -200 to 60 dB\n  Default:          0\n", self.ok("help", "gain_db").stdout)
        for word in ("gain_db", "rest_s", "code", "[page]"):
            self.assertLessEqual(max(map(len, self.ok("help", word).stdout.splitlines())), 80)
        self.assertIn("--max-dbfs DB", self.ok("help", "max_dbfs").stdout)

    def test_it_explains_a_key_by_each_name_that_messages_use(self):
        for word, key, table in (("limits.power_dbfs", "power_dbfs", "[limits]"), ("sync.codes.void", "codes.void", "[sync]"), ("out.pulse-ms", "out.pulse_ms", "[sync]"),
                                 ("calibration.tactor.sd_db", "sd_db", "[[calibration.tactor]]"),
                                 ("level.sl_db", "level", "[experiment]"), ("experiment.level.dbfs", "level", "[experiment]"), ("[[stroke.stroke]]", "stroke", "[stroke]")):
            text = self.ok("help", word).stdout
            self.assertTrue(text.startswith(f"{key}\n  "), f"{word}: {text}")
            self.assertEqual(re.findall(r"^  In files: +(\S+),", text, re.M), [table], word)
        self.assertEqual(self.ok("help", "defaults.soa").stdout, self.ok("help", "soa").stdout)
        for word in ("sync.codes", "[sync.codes]", "codes"):
            self.assertEqual(self.ok("help", word).stdout, "[sync]: see tactor.toml(5); tactor help KEY explains a key\n"
                             "  codes.stimulus, codes.standard, codes.catch, codes.answer, codes.void\n", word)

    def test_a_mistyped_key_gets_the_nearest_one(self):
        for word, like in (("threshold_dbs", "threshold_dbfs"), ("limits.power_dbf", "limits.power_dbfs"), ("level.nothing", "level"), ("nothing_like_it", None)):
            text = self.refused(2, "help", word).stderr
            self.assertIn(f"tactor: {word}: no such command, option or key ({f'did you mean {like}? See' if like else 'see'} tactor --help)", text)
        text = self.ok("help", "max_dbf").stdout
        self.assertRegex(text, r'(?m)^Options with "max-dbf" in their names; tactor help OPTION explains one:\n  --max-dbfs DB .*')
        self.assertTrue(text.endswith('\n\nKeys of files with "max-dbf" in their names; tactor help KEY explains one:\n  max_dbfs\n'), text)
        self.assertIn("no such command (", self.refused(2, "thresholds").stderr)


RANGE = r"(-?[\d.e+]+) to ([\d.e+^]+)"
SECTIONS = ["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "FILES", "EXIT STATUS", "EXAMPLES", "SEE ALSO"]


def read_range(text):
    parts = [n.partition("^") for n in re.search(RANGE, text).groups()]
    return [float(base) ** float(power or 1) for base, _, power in parts]


def read_page(name):
    return (ROOT / "man" / name).read_text(encoding="utf-8")


def section(page, title):
    return re.search(rf"^\.Sh {title}\n(.*?)(?=^\.Sh |\Z)", page, re.M | re.S)[1]


def options_in(text):
    """Returns the options that are items, or stand under "Common options", which other commands share."""
    common = "".join(re.findall(r'^\.\\" Common options.*\n((?:.*\n)*?)\.El', text, re.M))
    heads = re.findall(r"^\.It .*", text, re.M) + re.findall(r"^\.Fl .*", common, re.M)
    return {"-" + name for head in heads for name in re.findall(r"(?:Fl|,) (-[\w-]+|[a-zA-Z](?= |$))", head)}


class Manual(ToolTest):
    """Each command has a page with the options of its --help, and with examples."""

    def read_help(self, *command):
        text = self.ok(*command, "--help-all" if command else "--help").stdout
        return text, {name for names in re.findall(r"^  (-\S+)", text, re.M) for name in names.split(",")}

    def test_each_command_has_its_options_in_its_page_all_sections_and_three_examples(self):
        text, options = self.read_help()
        commands = re.findall(r"^  (\w+) ", text.partition("Subcommands:")[2], re.M)
        self.assertGreaterEqual(len(commands), 5)
        for command in commands:
            page, (text, own) = read_page(f"tactor-{command}.1"), self.read_help(command)
            with self.subTest(command):
                self.assertEqual(options_in(section(page, "OPTIONS")), own - {"-h", "--help", "--help-all"})
                self.assertEqual([title for title in re.findall(r"^\.Sh (.*)", page, re.M) if title in SECTIONS], SECTIONS)
                self.assertIn(f".Nm tactor-{command}", section(page, "NAME"))
                self.assertIn(f".Nm tactor\n.Cm {command}\n", section(page, "SYNOPSIS"))
                self.assertGreaterEqual(len(re.findall(r"^\.Dl .*\btactor ", section(page, "EXAMPLES"), re.M)), 3)
                self.assertRegex(text, rf"(?m)^Examples:\n  tactor {command}")
        page = read_page("tactor.1")
        self.assertEqual(options_in(section(page, "OPTIONS")), options)
        listed = re.findall(r"^\.It Cm (\w+)\n.*\n\.Xr tactor-(\w+) 1", section(page, "COMMANDS"), re.M)
        self.assertEqual(sorted(listed), sorted((command, command) for command in commands))

    def test_a_plan_is_a_stroke_of_the_commands_that_take_one(self):
        self.write("plan.json", self.ok("plan", "park2016-1", "--format", "json").stdout)
        for command, *more in (("plan",), ("render", "-o", "x.wav"), ("play", "-D", "null"), ("plot", "-o", "x.svg"), ("compare",)):
            taken = self.run_tool(command, "plan.json", *more).returncode == 0
            self.assertEqual(".json: a plan" in " ".join(self.read_help(command)[0].split()), taken, command)

    def test_pages_read_as_intended(self):
        for page in sorted((ROOT / "man").glob("*.[1-8]")):
            with self.subTest(page=page.name):
                # .Dq takes the whole line, also what follows "No" or another .Dq: .Do ... Dc ends before.
                self.assertEqual(re.findall(r"^\..*\b(?:[DQS]q|Ql) .* (?:No|[DQS]q|Ql) .*$", page.read_text(encoding="utf-8"), re.M), [])
                text = subprocess.run(["man", "-E", "UTF-8", "-l", "-Tutf8", page], capture_output=True, encoding="utf-8", check=True,
                                      env=self.env | {"MANWIDTH": "80"}).stdout
                self.assertGreater(len(text), 1000)
                self.assertEqual(re.findall(r"^.*[\w”] +[,;:)](?:\s.*)?$", text, re.M), [])
                self.assertEqual(re.findall("“[^”]*“|”[^“]*”", text), [])


if __name__ == "__main__":
    main()
