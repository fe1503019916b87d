# SPDX-License-Identifier: MIT
"""Wrong usage and bad input of any command: a clear error with a hint, the right exit status, nothing on standard output; and help."""
import os
import re
import shlex
import subprocess
import threading

from harness import GRID, PATIENCE_S, TOOL, ToolTest, main, wav_bytes

STROKE = '[stroke]\npath = "M 0 0 L 20 0"\n'
CSV = "t_s,x_mm,y_mm\n0,0,0\n1,20,0\n"


class ErrorsTest(ToolTest):
    def refused_each(self, *lines):
        """Runs command lines; the golden message of each names what is wrong with it."""
        for line in lines:
            with self.subTest(line):
                self.assertEqual(self.refused(2, *shlex.split(line)).stdout, "")


class Help(ErrorsTest):
    def test_help_is_a_command_and_has_an_example_for_every_command(self):
        for command in ((), ("plan",), ("play",), ("experiment",)):
            text = self.ok(*command, "--help").stdout
            self.assertEqual(self.ok("help", *command).stdout, text)
            self.assertIn("Examples:\n  tactor ", text)
        self.assertEqual(self.ok("help", "help").stdout, self.ok("--help").stdout)
        self.assertIn("tactor help play", self.ok("help").stdout)
        for command in ("plan", "render", "plot", "compare"):
            self.assertIn(f"Usage: tactor {command} [OPTIONS] [STROKE]\n", self.ok(command, "--help").stdout)
        self.assertIn("Usage: tactor play [OPTIONS] [STROKE...]\n", self.ok("play", "--help").stdout)

    def test_help_fits_a_screen_and_help_all_describes_the_rest(self):
        for command in ("plan", "play", "calibrate", "experiment", "compare", "check", "serve", "devices"):
            short, whole = (self.ok(command, option).stdout for option in ("--help", "--help-all"))
            self.assertLessEqual(len(short.splitlines()), 40, command)
            described, listed = (re.findall(r"^  (?:-\w,)?(--[a-z-]+)", text, re.M) for text in (whole, short))
            others = re.search(rf"^(\d+) more options?: tactor {command} --help-all lists them", short, re.M)
            self.assertEqual(int(others[1]) if others else 0, len(set(described) - set(listed) - {"--help", "--help-all"}), command)
            self.assertEqual(len(described), len(set(described)), command)
        whole = self.ok("--help-all").stdout  # the pages of all commands
        self.assertTrue("\nUsage: tactor stop [OPTIONS]\n" in whole and "{" not in whole)

    def test_help_lists_the_options_that_have_a_word(self):
        self.assertIn("  --level-dbfs DB ", self.ok("help", "level").stdout)
        self.assertEqual(re.findall(r"^  (?:-\w,)?--([a-z-]+)", self.ok("help", "reopen").stdout, re.M), ["reopen-s"])
        self.assertTrue(self.ok("help", "soa").stdout.startswith("--soa S\n"))
        for key, table in (("max_dbfs", "[array]"), ("max_dbfs", "[[tactor]]"), ("max-level-dbfs", "[serve]")):
            self.assertIn(f"  In files:         {table}, see tactor.toml(5)\n", self.ok("help", key).stdout)
        self.assertIn('(default: "The same" and "As different as can be")', " ".join(self.ok("help", "task").stdout.split()))
        self.assertIn("equally often (default: random values", " ".join(self.ok("help", "start").stdout.split()))
        for key, name in (("max_drive_s", "max_drive_s"), ("window_s", "window_s"), ("power_dbfs", "power_dbfs")):
            self.assertIn(f"  [limits]:         {name}\n", self.ok("help", key).stdout)

    def test_without_arguments_it_says_what_to_try(self):
        says = self.refused(2).stderr
        self.assertTrue(says.startswith("tactor: command line: the command is missing (tactor --help lists the commands)\n"), says)
        tries = re.findall(r"^  tactor (.*?)  ", says, re.M)
        self.assertEqual([t.split()[0] for t in tries], ["plan", "plot", "serve"])
        for words in tries[:2]:
            self.ok(*words.split())

    def test_version_is_printed(self):
        lines = self.ok("--version").stdout.splitlines()
        self.assertRegex(lines[0], r"^tactor \d+\.\d+\.\d+$")
        for name, says in (("build", r"\w+, optimization \w+"), ("compiler", r"(gcc|clang) \d+\.\d+"),
                           ("processor", rf"{os.uname().machine}, (baseline|avx2|avx-512) loops"),
                           ("libraries", r"alsa-lib \d+\.\d+\.\d+.*, libgpiod [12]\.\d+.*, Boost 1\.\d+.*")):
            self.assertRegex("\n".join(lines), rf"(?m)^{name} +{says}")


class CommandLine(ErrorsTest):
    def test_wrong_usage_is_refused(self):
        self.refused_each(
            "help nosuchthing", "help plam", "plam park2016-1", "plam plan", "plan", "plan park2016-1 park2016-2", "render park2016-1 park2016-2 -o x.wav",
            "plan park2016-1 --path 'M 0 0 L 1 1'", "render park2016-1", "render park2016-1 -o", "plan park2016-1 --soa",
            "plan park2016-1 --soa 0.07 --soa 0.07", "experiment", "report", "plan park2016-1 --algorithm park2017", "plan park2016-1 --format xml",
            "plan park2016-9", "plan prak2016-1", "plan park2016-1 --array palm-3x4", f"plan park2016-1 --array {'a' * 300}",
            "plan park2016-1 --rate 48000.5", "play park2016-1 --periods 2.5", "play park2016-1 -D null --reopen-s -1",
            "plan --path ''", "plan --path 'M 0 0,L 1 1'", "plan --path 'M 5 5 Z'", "plan --path 'M 0 0 L 1e9 0'", "analyze ''", "report ''",
            "plan park2016-1 ''", "devices ''", "plot park2016-1 -o ''", "play park2016-1 --socket ''", "status --socket ''",
            "check park2016-1", "devices --format csv", "devices --array palm-9x9")

    def test_a_unit_gets_a_hint_with_the_number_to_give(self):
        self.refused_each(*(f"plan park2016-1 {given}" for given in (
            "--soa=70ms", "--burst='60 ms'", "--duration=2s", "--duration=3min", "--duration=1,5", "--carrier=0.2kHz", "--speed=6cm/s",
            "--level-dbfs=-20dB", "--soa=70furlongs", "--soa=70", "--soa=1e300")))  # no factor makes the last three right

    def test_what_is_nearly_right_is_suggested(self):
        self.refused_each(
            "plan park2016-1 --speeed 3", "plan park2016-1 --sped 3", "plan park2016-1 --arry 3", "plan park2016-1 --algoritm 3",
            "play park2016-1 -d null", "-v", "play park2016-1 -v", "play park2016-1 --volume 3", "serve --port 4003",
            "play park2016-1 -duration 1", "plan park2016-1 --array plam-3x3", "play park2016-1 --level-dbfs 12", "serve --http 80000",
            "serve --tcp 80000", "serve --osc 80000", "serve --level-dbfs -40", "serve --sl 7", "experiment park2016 --level-dbfs -20", "experiment park2016 --sl 7",
            "calibrate --level-dbfs -20", "plan park2016_3",
            # Names that are not near any known one.
            "plan park2016-1 --seed 3", "plan park2016-1 --loop", "plan park2016-1 --soap-opera", "plan park2016-1 -s")

    def test_the_command_comes_first_and_blanks_need_quotes(self):
        self.write("my last drawing.toml", STROKE)
        self.write("my array.toml", GRID)
        self.refused_each(
            "--config f.toml plan park2016-1", "park2016-1 play", "--path 'M 0 0 L 9 9' plan", "plan --path M 0 10 L 40 -30 --duration 1",
            "play -D null --path M 0 10 L 40 -30 --duration 1", "plan my last drawing.toml", "play my last drawing.toml -D null",
            "plan park2016-1 --array my array.toml", "render park2016-1 -o my sound.wav")  # a name that no file has yet

    def test_characters_of_print_are_named(self):
        self.refused_each(
            "plan park2016-1 \u2013\u2013duration 2", "plan park2016-1 \u2013duration 2", "plan park2016-1 \u2014duration 2", "play park2016-1 \u2011D null",
            "plan park2016-1 --level-dbfs \u221212", "plan park2016-1 --level-dbfs=\u201312", "plan --path 'M 20 20 L 20 \u20135'",
            "plan --path \u201cM 0 0 L 9 9\u201d")

    def test_what_defaults_say_is_refused_at_its_place(self):
        for text in ("soa = 5", "burst = 3", "carrier = 30000", 'waveform = "no.wav"', "level-dbfs = 12"):
            self.write("d.toml", f'array.preset = "palm-3x3"\n[defaults]\n{text}\n')
            self.refused_each("plan park2016-1 --array d.toml", "plan park2016-1 --config d.toml")
        # Values of the command line or a stroke win.
        self.write("d.toml", "[defaults]\nsoa = 5\ncarrier = 30000\n")
        self.refused(2, "plan", "park2016-1", "--config", "d.toml", "--soa", "6", says=["--soa"])
        self.write("c.svg", '<svg xmlns="http://www.w3.org/2000/svg"><path d="M 0 0 L 40 0" data-carrier-hz="9000"/></svg>')
        self.refused(2, "plan", "c.svg", "--config", "d.toml", "--soa", "0.07", "--rate", "8000", says=["c.svg"])

    def test_standard_input_that_cannot_be_read_has_a_hint(self):
        for command in (("plan", "-"), ("play", "--live", "-", "-D", "null"), ("check", "--walk", "-D", "null")):
            says = ["standard input: Bad file descriptor (give lines from a terminal, a file or a pipe)"]
            self.refused(2, *command, says=says, before=lambda: os.close(0))


class Files(ErrorsTest):
    def test_missing_files_and_folders_are_named(self):
        self.refused_each("plan no/such.toml", "plan missing.csv", "plan park2016-1 --array missing.toml", "plan park2016-1 --config missing.toml")
        self.refused(2, "plan", "park2016-1", env={"TACTOR_CONFIG": "gone.toml"})
        (self.dir / "folder.json").mkdir()
        self.refused_each("plan .", "plan folder.json", "plan park2016-1 --array .", "plan park2016-1 --config .", "experiment ./ --dry-run",
                          "render park2016-1 -o .", "play park2016-1 -D null --log .")

    def test_faults_have_their_place_and_keys_stay_as_they_are(self):
        for name, text in (("a.toml", '[array]\nname = "a"\ngrid = { rows = 3, columns = 3, pich_mm = 20.0 }\n'), ("a.toml", "[array\n"), ("a.toml", ""),
                           ("a.toml", GRID + "channels = 1\n"), ("s.toml", STROKE + "burst = 3\n"), ("s.csv", CSV + "0.5,2,0\n"), ("s.csv", ""), ("s.svg", "<svg")):
            self.write(name, text)
            self.refused_each("plan park2016-1 --array a.toml" if name == "a.toml" else f"plan {name}")
        self.refused(2, "plan", "-", stdin="")

    def test_open_quotes_are_found_where_they_open(self):
        grid = "grid = { rows = 3, columns = 3, pitch_mm = 20.0 }\n"
        for text, place in ((f'[array]\nname = "palm\n{grid}', "2:8"), ("[array]\nname = 'palm\n", "2:8"), ('[array]\nname = "palm', "2:8"),
                            ('[array]\nname = """palm\n\n', ""), ("[array]\nname = palm\n", ""),
                            ("[array\nname = 'palm\n", "1:")):  # another fault before it comes first
            self.write("a.toml", text)
            said = self.refused(2, "plan", "park2016-1", "--array", "a.toml", says=[f"a.toml:{place}"]).stderr
            self.assertEqual("no closing quote" in said and "on the same line" in said, place == "2:8", said)
        # Quotes in comments and in other strings are no quotes.
        self.write("a.toml", GRID.replace("oak", "it's \"oak").replace('"desk"', "'5\" desk'"))
        self.ok("check", "--array", "a.toml", "-D", "null")

    def test_what_is_no_text_is_named(self):
        wav = wav_bytes([0.0] * 100)
        for name, data, says in (("s.wav", wav, "it has samples"), ("s.toml", wav, "is a WAV file, not text"), ("s.csv", wav, "is a WAV file"), ("s.svg", wav, "is a WAV file"),
                                 ("s", b"RF64" + wav[4:], "is a WAV file"), ("p.png", b"\x89PNG\r\n\x1a\n\0", "is a PNG picture"),
                                 ("p.pdf", b"%PDF-1.7\n%\xe2", "is a PDF document"), ("t.csv", b"PK\x03\x04\x14\0", "is a ZIP archive or office document"),
                                 *((name, text.encode(code), "is UTF-16") for name, text in (("s.toml", STROKE), ("s.csv", CSV), ("s.txt", CSV))
                                   for code in ("utf-16", "utf-16-le", "utf-16-be")),
                                 ("s.toml", f'{STROKE}name = "caf\xe9"\n'.encode("latin-1"), "s.toml:3:11")):
            self.write(name, data)
            self.refused(2, "plan", name, says=[name, says])
        for data in (wav, GRID.encode("utf-16"), GRID.replace("oak", "ch\xeane").encode("latin-1")):
            self.write("a.toml", data)
            for option in ("--array", "--config"):
                self.refused(2, "plan", "park2016-1", option, "a.toml")
        for name, text in (("s.toml", f'{STROKE}name = "caf\xe9"\n'), ("s.csv", CSV)):
            self.write(name, text.encode("utf-8-sig"))
            self.ok("plan", name)

    def test_names_that_are_no_files_to_read_are_refused(self):
        r = subprocess.run([TOOL, "plan", "/dev/stdout"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                           env=self.env, timeout=PATIENCE_S, check=False, stdin=subprocess.DEVNULL)
        self.assertEqual((r.returncode, r.stdout), (2, ""))
        self.assertIn("/dev/stdout: it is the output of this program (name a file", r.stderr)
        os.mkfifo(self.dir / "pipe.toml")
        for name in ("pipe.toml", "/dev/zero"):
            self.write("mine.toml", f'[array]\nfile = "{name}"\n')
            self.refused(2, "plan", "park2016-1", "--array", "mine.toml")

    def test_waiting_for_a_named_pipe_is_reported(self):
        for name in ("s.toml", "o.wav", "o.svg"):
            os.mkfifo(self.dir / name)
        threading.Thread(target=lambda: (self.dir / "s.toml").write_text(STROKE, encoding="ascii"), daemon=True).start()
        self.assertIn("s.toml: it is a pipe: waiting for a program that writes to it", self.ok("plan", "s.toml").stderr)
        for command, name in (("render", "o.wav"), ("plot", "o.svg")):
            got = []
            reader = threading.Thread(target=lambda n=name, got=got: got.append((self.dir / n).read_bytes()), daemon=True)
            reader.start()
            self.assertIn(f"{name}: it is a pipe: waiting for a program that reads it", self.ok(command, "park2016-1", "-o", name).stderr)
            reader.join()
            self.assertGreater(len(got[0]), 1000)


class Journal(ErrorsTest):
    def said(self, *args, is_journal=True):
        """Returns the output to a file that is, or is not, systemd's journal."""
        with open(self.dir / "said", "w+b") as file:
            at = os.fstat(file.fileno())
            number = at.st_ino if is_journal else at.st_ino + 1
            subprocess.run([TOOL, *args], stdout=subprocess.DEVNULL, stderr=file, cwd=self.dir, check=False, timeout=PATIENCE_S,
                           env=self.env | {"JOURNAL_STREAM": f"{at.st_dev}:{number}"})
            file.seek(0)
            return file.read().decode().splitlines()

    def test_lines_have_levels_in_place_of_time_and_kind(self):
        short = ("--path", "M 0 0 L 10 0", "--duration", "0.05", "--burst", "0.003")
        for is_journal, warning, error in ((True, "<4>", "<3>"), (False, "", "")):
            lines = self.said("render", *short, "-o", "w.wav", is_journal=is_journal)
            self.assertTrue(lines and all(line.startswith(warning + "tactor: warning: ") for line in lines), lines)
            self.assertTrue(self.said("plan", "--path", "M 0 0 L", is_journal=is_journal)[0].startswith(error + "tactor: "))
        lines = self.said("play", "park2016-1", "-D", "null", "--verbose")
        self.assertLessEqual({"<6>strokes may sound", "<6>the stream has ended"}, set(lines))
        self.assertRegex("\n".join(self.said("play", "park2016-1", "-D", "null", "--verbose", is_journal=False)),
                         r"(?m)^\d{4}-\S+Z info strokes may sound$")


if __name__ == "__main__":
    main()
