# SPDX-License-Identifier: MIT
"""Bad input: a clear error, the right exit status, nothing half written."""
import os
import re
import subprocess

from harness import TOOL, ToolTest, main


class CommandLine(ToolTest):
    def test_help_has_an_example_for_every_command(self):
        for command in ((), ("plan",), ("render",), ("play",)):
            self.assertIn("Examples:\n  tactor ", self.ok(*command, "--help").stdout)

    def test_help_is_a_command_too(self):
        self.assertEqual(self.ok("help").stdout, self.ok("--help").stdout)
        self.assertEqual(self.ok("help", "help").stdout, self.ok("--help").stdout)
        self.assertIn("tactor help play", self.ok("help").stdout)
        for command in ("plan", "play", "experiment"):
            self.assertEqual(self.ok("help", command).stdout, self.ok(command, "--help").stdout)
        self.refused(2, "help", "plam")

    def test_without_arguments_it_says_what_to_try(self):
        says = self.refused(2).stderr
        self.assertTrue(says.startswith("tactor: command line: no command (tactor --help lists them)\n"), says)
        tries = re.findall(r"^  tactor (.*?)  ", says, re.M)
        self.assertEqual([t.split()[0] for t in tries], ["plan", "plot", "serve"])
        for words in tries[:2]:
            self.ok(*words.split())

    def test_help_fits_a_screen_and_help_all_describes_the_rest(self):
        for command in ("plan", "play", "calibrate", "experiment", "compare", "check", "serve", "devices"):
            short, whole = (self.ok(command, option).stdout for option in ("--help", "--help-all"))
            self.assertLessEqual(len(short.splitlines()), 45, command)
            self.assertEqual(set(re.findall(r"--[a-z][a-z-]+", whole)) - set(re.findall(r"--[a-z][a-z-]+", short)), {"--help"}, command)
            described = re.findall(r"^  (?:-\w,)?(--[a-z-]+)", whole, re.M)
            self.assertEqual(len(described), len(set(described)), command)

    def test_a_missing_argument_is_named_with_a_hint(self):
        for args, says in ((("render", "park2016-1"), "tactor: --output: this option is missing (say --output FILE.wav; tactor render --help)\n"),
                           (("render", "park2016-1", "-o"), "tactor: --output: its value is missing (say --output FILE.wav; tactor render --help)\n"),
                           (("plan", "park2016-1", "--soa"), "tactor: --soa: its value is missing (say --soa S; tactor plan --help)\n"),
                           (("plan", "park2016-1", "--soa", "0.07", "--soa", "0.07"), "tactor: --soa: it is given more than once (give it once)\n"),
                           (("experiment",), "tactor: command line: no EXPERIMENT (tactor experiment EXPERIMENT; tactor experiment --help)\n"),
                           (("report",), "tactor: command line: no DIR (tactor report DIR; tactor report --help)\n")):
            self.assertEqual(self.refused(2, *args).stderr, says)

    def test_a_strokes_file_is_named(self):
        far = 'path = "M 0 0 L 400 0"\n'
        self.write("one.toml", '[stroke]\nname = "swing"\n' + far)
        self.write("two.toml", f"[[stroke]]\n{far}[[stroke]]\n{far}")
        for command in (("plan",), ("render", "-o", "x.wav"), ("play", "-D", "null"), ("plot", "-o", "x.svg"), ("compare",)):
            self.refused(2, command[0], "one.toml", *command[1:])
        self.refused(2, "plan", "two.toml")
        self.refused(2, "plan", "-", stdin="[stroke]\n" + far)
        self.refused(2, "plan", "--path", "M 0 0 L 400 0")
        self.refused(2, "plan", "park2016-1", "--array", self.write("s.toml", '[array]\nname = "s"\ngrid = { rows = 2, columns = 2, pitch_mm = 9.0 }\n'))

    def test_version_is_printed(self):
        lines = self.ok("--version").stdout.splitlines()
        self.assertRegex(lines[0], r"^tactor \d+\.\d+\.\d+$")
        for name, says in (("build", r"\w+, optimization \w+"), ("compiler", r"(gcc|clang) \d+\.\d+"),
                           ("processor", rf"{os.uname().machine}, (baseline|avx2|avx-512) loops"),
                           ("libraries", r"alsa-lib \d+\.\d+\.\d+.*, libgpiod [12]\.\d+.*, Boost 1\.\d+.*")):
            self.assertRegex("\n".join(lines), rf"(?m)^{name} +{says}")

    def test_wrong_usage_is_refused(self):
        self.refused(2)
        self.refused(2, "plam", "park2016-1")
        self.refused(2, "plan", "park2016-1", "--speeed", "3")
        self.refused(2, "plan")
        self.refused(2, "plan", "park2016-1", "park2016-2")
        self.refused(2, "plan", "park2016-1", "--path", "M 0 0 L 1 1")
        self.refused(2, "plan", "park2016-1", "--duration", "1", "--speed", "2")
        self.refused(2, "plan", "park2016-1", "--level-dbfs", "-12", "--sl", "7")
        self.refused(2, "render", "park2016-1")
        self.refused(2, "plan", "park2016-9")
        self.refused(2, "plan", "park2016-1", "--array", "palm-3x4")
        self.refused(2, "plan", "park2016-1", "--array", "a" * 300)
        self.refused(2, "plan", "park2016-1", "--algorithm", "park2017")
        self.refused(2, "plan", "park2016-1", "--format", "xml")

    def test_absurd_numbers_are_refused(self):
        for option in ("--duration", "--speed", "--soa", "--burst", "--carrier", "--rate", "--level-dbfs", "--ramp", "--sl"):
            for value in ("nan", "inf", "-inf", "-1e300", "1e300", "abc", "", "1,5", "0x10", "1e999"):
                r = self.run_tool("plan", "park2016-1", f"{option}={value}")
                self.assertEqual(r.returncode, 2, f"{option}={value}: {r.stdout[:200]}{r.stderr}")
                self.assertTrue(r.stderr.startswith("tactor: "), r.stderr)

    def test_a_burst_of_its_own_duration_has_bounds_and_every_command_warns(self):
        for burst in ("0", "-1", "1e-5", "11", "1e99", "nan", "x"):
            self.refused(2, "plan", "park2016-1", "--burst", burst)
        self.refused(2, "plan", "park2016-1", "--burst", "0.08")
        self.refused(2, "compare", "park2016-1", "--burst", "0.08")
        self.ok("plan", "park2016-1", "--burst", "0.08", "--soa", "0.2")
        short = ("--path", "M 0 0 L 20 0", "--duration", "0.14", "--burst", "0.003")
        for command in (("plan",), ("render", "-o", "o.wav"), ("play", "-D", "null"), ("plot", "-o", "o.svg"),
                        ("compare",)):
            r = self.ok(command[0], *short, *command[1:])
            said = " ".join((r.stdout + r.stderr).split())
            self.assertIn("leave the timing law", said, command)
            self.assertIn("shorter than one cycle of the carrier", said, command)
        plan = self.plan(*short)
        self.assertEqual([b["duration_s"] for b in plan["bursts"]], [0.003] * 3)
        self.assertEqual(plan["soa_s"], 0.07)
        self.assertEqual(len(plan["warnings"]), 2)
        self.write("tactor.toml", "[defaults]\nburst = 0.05\n")
        self.assertEqual(self.plan("park2016-1", "--config", "tactor.toml")["bursts"][0]["duration_s"], 0.05)
        self.refused(2, "plan", "park2016-1", "--config", self.write("bad.toml", "[defaults]\nburst = 0\n"))

    def test_faults_of_a_stroke_file_are_refused_at_their_place(self):
        line = 'path = "M 0 0 L 40 0"\n'
        self.write("carrier.toml", f"[stroke]\n{line}carrier_hz = 24000\n")
        self.write("profile.toml", f"[[stroke]]\n{line}[[stroke]]\n{line}carrier_profile = [[0, 100], [1, 30000]]\n")
        self.write("noise.toml", f'[[stroke]]\n{line}[[stroke]]\n{line}waveform = "noise:20-30000"\n')
        self.write("start.toml", f'[[stroke]]\n{line}[[stroke]]\n{line}start_from = "end"\nstart_s = -5\n')
        for file, where in (("carrier.toml", "3:14: carrier_hz: 24000 Hz"), ("profile.toml", "5:19: carrier_profile: 30000 Hz"),
                            ("noise.toml", "5:12: waveform: 30000 Hz"), ("start.toml", "6:11: start_s: 5 s before the end")):
            for command in (("plan",), ("render", "-o", "x.wav"), ("play", "-D", "null"), ("plot", "--view", "wave", "-o", "x.svg")):
                self.refused(2, command[0], file, *command[1:], says=[f"tactor: {file}:{where}"])
            self.refused(2, "plan", "-", stdin=(self.dir / file).read_text(encoding="utf-8"), says=[f"tactor: standard input:{where}"])
        self.refused(2, "plot", "start.toml", "-o", "x.svg")

    def test_what_defaults_say_is_refused_at_its_place(self):
        for text, where in (("soa = 5", "3:7: soa: 5 s is out of bounds"), ("burst = 3", "3:9: burst: 3 s is longer"),
                            ("carrier = 30000", "3:11: carrier: 30000 Hz cannot be rendered"),
                            ('waveform = "no.wav"', "3:12: waveform: no.wav: No such file")):
            self.write("d.toml", f'array.preset = "palm-3x3"\n[defaults]\n{text}\n')
            for option in ("--array", "--config"):
                said = self.refused(2, "plan", "park2016-1", option, "d.toml", says=[f"tactor: d.toml:{where}"]).stderr
                self.assertNotIn("--", said)
        # Values of the command line or a stroke win.
        self.write("d.toml", "[defaults]\nsoa = 5\ncarrier = 30000\n")
        self.refused(2, "plan", "park2016-1", "--config", "d.toml", "--soa", "6")
        self.write("c.svg", '<svg xmlns="http://www.w3.org/2000/svg"><path d="M 0 0 L 40 0" data-carrier-hz="9000"/></svg>')
        self.refused(2, "plan", "c.svg", "--config", "d.toml", "--soa", "0.07", "--rate", "8000")

    def test_standard_input_is_named_so(self):
        two = '[[stroke]]\npath = "M 0 0 L 40 0"\n[[stroke]]\npath = "M 0 0 L 400 0"\n'
        self.refused(2, "plan", "-", stdin=two)
        self.assertIn("standard input: played", self.ok("play", "-", "-D", "null", stdin='[stroke]\npath = "M 0 0 L 20 0"\n').stdout)

    def test_standard_input_that_cannot_be_read_has_a_hint(self):
        for command in (("plan", "-"), ("play", "--live", "-", "-D", "null"), ("check", "--walk", "-D", "null")):
            says = ["standard input: Bad file descriptor (give lines from a terminal, a file or a pipe)"]
            self.refused(2, *command, says=says, before=lambda: os.close(0))

    def test_messages_have_hints(self):
        self.refused(2, "plan", "park2016-1", "--rate", "48000.5")
        self.refused(2, "play", "park2016-1", "--periods", "2.5")
        self.refused(2, "plan", "--path", "")
        for command in (("analyze", ""), ("report", ""), ("plan", "park2016-1", ""), ("devices", ""), ("plot", "park2016-1", "-o", "")):
            self.refused(2, *command)
        for command in (("play", "park2016-1"), ("status",), ("stop",)):
            self.refused(2, *command, "--socket", "")
        self.refused(2, "plan", "--path", "M 0 0,L 1 1")
        self.write("a.toml", '[array]\nname = "a"\ngrid = { rows = 2.0, columns = 2, pitch_mm = 9.0 }\n')
        self.refused(2, "plan", "park2016-1", "--array", "a.toml")
        self.write("p.toml", '[stroke]\npath = "M 0 0 L 40 0"\npauses = [[0.5, 0.3, 2]]\n')
        self.assertNotIn("rests", self.refused(2, "plan", "p.toml").stderr)

    def test_soa_out_of_bounds_names_both(self):
        for soa in ("0.0473", "0.04", "0.0701", "1", "0", "-1"):
            self.refused(2, "plan", "park2016-1", "--soa", soa)
        self.ok("plan", "park2016-1", "--soa", "0.0474")

    def test_carriers_above_nyquist_are_refused(self):
        self.refused(2, "plan", "park2016-1", "--carrier", "24000")
        self.refused(2, "render", "park2016-1", "--carrier", "5000", "--rate", "8000", "-o", "o.wav")

    def test_levels_above_full_scale_are_refused(self):
        self.refused(2, "plan", "park2016-1", "--level-dbfs", "0.5")
        self.write("a.toml", '[array]\nname = "a"\ngrid = { rows = 3, columns = 3, pitch_mm = 20.0 }\n'
                             "[[tactor]]\ntactor = 4\ngain_db = 13.0\n")
        self.refused(2, "plan", "park2016-1", "--array", "a.toml")
        self.write("a.toml", '[array]\nname = "a"\ngrid = { rows = 3, columns = 3, pitch_mm = 20.0 }\n'
                             "[[tactor]]\ntactor = 1\nmax_dbfs = -20.0\n")
        self.refused(2, "plan", "park2016-1", "--array", "a.toml")
        self.refused(2, "plan", "park2016-1", "--sl", "7")

    def test_fit_names_times_that_work(self):
        said = self.refused(2, "plan", "--path", "M 0 0 L 4 0", "--duration", "0.1", "--timing", "fit").stderr
        self.assertIn("0.07", said)
        self.assertIn("0.1074", said)


class Paths(ToolTest):
    def test_a_bad_path_is_refused(self):
        for data in ("", "M", "M 0 0", "M 0 0 L", "M 0 0 L nan 3", "M 0 0 L inf 3", "M 0 0 L 1e400 3", "M 0 0 X 1 1",
                     "L 1 1", "M 0 0 L 0 0", "M 5 5 Z", "M 0 0 L 10 0 M 20 0 L 30 0", "hello", "M 0 0 L 1e9 0"):
            r = self.run_tool("plan", f"--path={data}")
            self.assertEqual(r.returncode, 2, f"{data}: {r.stdout[:100]} {r.stderr}")
            self.assertTrue(r.stderr.startswith("tactor: "), r.stderr)

    def test_a_path_that_leaves_the_array_gives_the_place(self):
        self.refused(2, "plan", "--path", "M 20 20 L 60 20")
        for algorithm in ("tactile-brush", "continuous"):
            self.refused(2, "plan", "--path", "M 20 20 L 60 20", "--algorithm", algorithm)


class Files(ToolTest):
    def test_missing_files_are_named(self):
        self.refused(2, "plan", "no/such.toml")
        self.refused(2, "plan", "missing.csv")
        self.refused(2, "plan", "park2016-1", "--array", "missing.toml")
        self.refused(2, "plan", "park2016-1", "--config", "missing.toml")
        self.refused(2, "plan", "park2016-1", env={"TACTOR_CONFIG": "gone.toml"})
        (self.dir / "folder.toml").mkdir()
        self.refused(2, "plan", "folder.toml")
        self.refused(2, "plan", "park2016-1", "--array", "folder.toml")

    def array_refused(self, text, *says):
        self.write("a.toml", text)
        return self.refused(2, "plan", "park2016-1", "--array", "a.toml", says=says)

    def test_bad_arrays_are_refused(self):
        grid = '[array]\nname = "a"\ngrid = { rows = 3, columns = 3, pitch_mm = 20.0 }\n'
        pair = "[[tactor]]\nx_mm = 0.0\ny_mm = 0.0\n"
        self.array_refused("[array\n", "a.toml:1")
        self.array_refused('[array]\nname = "a"\ngrid = { rows = 3, columns = 3, pich_mm = 20.0 }\n', "a.toml:3",
                           "pich_mm", "pitch_mm")
        self.array_refused(grid + "[outputs]\n", "outputs", "output")
        self.array_refused('[array]\nname = "a"\ngrid = { rows = -3, columns = 3, pitch_mm = 20.0 }\n', "a.toml:3")
        self.array_refused('[array]\nname = "a"\ngrid = { rows = 3, columns = 3, pitch_mm = nan }\n', "a.toml:3")
        self.array_refused('[array]\nname = "a"\ngrid = { rows = 3, columns = 3, pitch_mm = inf }\n', "a.toml:3")
        self.array_refused('[array]\nname = "a"\ngrid = { rows = 100000, columns = 100000, pitch_mm = 1.0 }\n',
                           "a.toml:3")
        self.array_refused('[array]\nname = "a"\n' + pair + pair, "a.toml:6", "a.toml:3")
        self.array_refused('[array]\nname = "a"\n' + pair + "channel = 5\n[[tactor]]\nx_mm = 9.0\ny_mm = 0.0\n"
                           "channel = 5\n", "channel 5")
        self.array_refused(grid + "[output]\nchannels = 8\n", "a.toml:5", "8", "9")
        self.array_refused('[array]\nname = "a"\n', "a.toml")
        self.array_refused("", "a.toml")

    def test_bad_strokes_are_refused(self):
        def bad(name, text, *says):
            self.write(name, text)
            self.refused(2, "plan", name, says=says)
        bad("s.toml", '[stroke]\npath = "M 0 0 L 1 1"\nduraton_s = 3\n', "s.toml:3", "duraton_s", "duration_s")
        bad("s.toml", "[stroke]\n", "s.toml")
        bad("s.csv", "t_s,x_mm\n0,0\n", "s.csv:1", "y_mm")
        bad("s.csv", "t_s,x_mm,y_mm\n0,0,0\n0.5,nan,0\n", "s.csv:3")
        bad("s.csv", "t_s,x_mm,y_mm\n0,0,0\n0.5,1\n", "s.csv:3")
        bad("s.csv", "t_s,x_mm,y_mm\n0,0,0\n1,1,0\n0.5,2,0\n", "s.csv:4")
        bad("s.csv", "", "s.csv")
        bad("s.svg", "<svg", "s.svg")
        bad("s.svg", '<svg xmlns="http://www.w3.org/2000/svg"></svg>', "s.svg")
        self.refused(2, "plan", "-", stdin="")

    def test_a_million_points_are_read(self):
        n = 1_000_000
        lines = (f"{i * 1e-5:.5f},{20 + 15 * ((i % 2000) / 1000 - 1):.4f},20" for i in range(n))
        self.write("big.csv", "t_s,x_mm,y_mm\n" + "\n".join(lines) + "\n")
        self.assertEqual(len(self.plan("big.csv")["bursts"]), 143)
        self.write("big.toml", '[stroke]\nduration_s = 1.0\npath = "M 0 0 L ' +
                   " ".join(f"{20 + i % 7} {20 + i % 5}" for i in range(n)) + '"\n')
        self.assertEqual(len(self.plan("big.toml")["bursts"]), 15)

    def test_a_full_disk_under_standard_output_is_a_failure(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("there is no /dev/full")
        with open("/dev/full", "w", encoding="ascii") as full:
            r = subprocess.run([TOOL, "plan", "park2016-1"], stdout=full, stderr=subprocess.PIPE, text=True,
                               env=self.env, check=False)
        self.assertEqual(r.returncode, 1, r.stderr)
        self.assertTrue(r.stderr.startswith("tactor: standard output: "))


if __name__ == "__main__":
    main()
