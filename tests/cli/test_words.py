# SPDX-License-Identifier: MIT
"""Words of messages: numbers for people, names once, and hints."""
import os
import re
import subprocess
import threading

from harness import GRID, PATIENCE_S, TOOL, ToolTest, main, wav_bytes

GRID_ONE = '[array]\nname = "one"\ngrid = { rows = 1, columns = 1, pitch_mm = 20.0 }\n'


class Numbers(ToolTest):
    def test_one_is_singular(self):
        self.write("one.toml", GRID_ONE)
        one = ("--path", "M 0 0 L 10 0", "--duration", "0.05")
        self.assertIn(", 1 burst, SOA", self.ok("plan", *one).stdout)
        self.assertIn(", 2 bursts, SOA", self.ok("plan", *one[:2], "--duration", "0.08").stdout)
        dot = ("--path", "M 0 0 L 1 0", "--outside", "clamp", "--array", "one.toml")
        self.assertIn("o.wav: 1 channel, 48000 Hz", self.ok("render", *dot, "-o", "o.wav").stdout)
        self.assertIn("null: 1 channel, 48000 Hz", self.both("play", *dot, "-D", "null"))
        checked = self.both("check", "--array", "one.toml", "-D", "null")
        self.assertIn("1 of 1 channel drives a tactor: 0", " ".join(checked.split()))
        short = self.both("plan", *one, "--burst", "0.003")
        self.assertIn("1 of 1 burst is shorter than one cycle", short)
        for text in (short, checked):
            self.assertIsNone(re.search(r"\b1 (bursts|strokes|tactors|channels|warnings|frames|samples|cycles)\b", text))

    def both(self, *args):
        r = self.run_tool(*args)
        return r.stdout + r.stderr

    def test_times_have_no_exponents(self):
        for path, says in (("M 0 0 L 0.0000016 0", "in 26.7 ns"), ("M 0 0 L 0.0016 0", "in 26.7 us"),
                           ("M 0 0 L 16 0", "in 0.266667 s")):
            for command in ("plan", "compare"):
                out = self.ok(command, "--path", path).stdout
                self.assertIn(says, out)
                self.assertIsNone(re.search(r"\de-\d+ s", out), out)

    def test_a_stroke_is_named_once(self):
        self.write("s.toml", '[[stroke]]\nname = "ok"\npath = "M 0 0 L 20 0"\n'
                             '[[stroke]]\nname = "wave"\npath = "M 20 20 L 90 20"\n')
        said = self.refused(2, "plan", "s.toml").stderr
        self.assertEqual(said.count("wave"), 1, said)


class Options(ToolTest):
    def test_a_unit_gets_a_hint_with_the_number_to_give(self):
        for option, value, says in (
                ("--soa", "70ms", ["give seconds without a unit, as 0.07", "0.0473 to 0.07 s"]),
                ("--burst", "60 ms", ["give seconds without a unit, as 0.06", "0.0001 to 10 s"]),
                ("--duration", "2s", ["as 2;"]), ("--duration", "3min", ["as 180;"]),
                ("--duration", "1,5", ["a decimal point, as 1.5", "0.001 to 86400 s"]),
                ("--carrier", "0.2kHz", ["give Hz without a unit, as 200"]), ("--speed", "6cm/s", ["as 60"]),
                ("--level-dbfs", "-20dB", ["as -20"])):
            said = self.refused(2, "plan", "park2016-1", f"{option}={value}", says=[option, "not a number", *says]).stderr
            self.assertNotIn("1000000000", said)
        self.assertNotIn("1000000000", self.refused(2, "plan", "park2016-1", "--soa", "1e300").stderr)
        self.refused(2, "play", "park2016-1", "-D", "null", "--reopen-s", "-1")
        # A unit that no factor can make right is only refused.
        self.assertNotIn("without a unit", self.refused(2, "plan", "park2016-1", "--soa", "70furlongs").stderr)
        self.refused(2, "plan", "park2016-1", "--soa", "70")

    def test_a_name_is_suggested_only_where_it_is_near(self):
        said = self.refused(2, "plan", "park2016-1", "--seed", "3").stderr
        self.assertNotIn("did you mean", said)
        for slip, meant in (("--speeed", "--speed"), ("--sped", "--speed"), ("--arry", "--array"), ("--algoritm", "--algorithm"),
                            ("--duratoin", "--duration")):
            self.refused(2, "plan", "park2016-1", slip, "3", says=[f"did you mean {meant}?"])
        for other in ("--loop", "--verbose", "--xyz", "--soap-opera"):
            self.assertNotIn("did you mean", self.refused(2, "plan", "park2016-1", other).stderr)


class Slips(ToolTest):
    """A command line that is nearly right: the message has what was probably meant."""

    def test_the_command_comes_first(self):
        for args, says in ((("--config", "f.toml", "plan", "park2016-1"), "tactor plan --config f.toml park2016-1"),
                           (("park2016-1", "play"), "tactor play park2016-1"),
                           (("--path", "M 0 0 L 9 9", "plan"), 'tactor plan --path "M 0 0 L 9 9"')):
            self.refused(2, *args, says=["the command comes first: " + says])
        self.refused(2, "plam", "plan", says=["did you mean plan?"])

    def test_blanks_need_quotes(self):
        for command in (("plan",), ("play", "-D", "null")):
            self.refused(2, *command, "--path", "M", "0", "10", "L", "40", "-30", "--duration", "1",
                         says=['quote the path: --path "M 0 10 L 40 -30"'])
        self.write("my last drawing.toml", '[stroke]\npath = "M 0 0 L 9 9"\n')
        self.write("my array.toml", GRID)
        for args, name in ((("plan", "my", "last", "drawing.toml"), "my last drawing.toml"),
                           (("play", "my", "last", "drawing.toml", "-D", "null"), "my last drawing.toml"),
                           (("plan", "park2016-1", "--array", "my", "array.toml"), "my array.toml")):
            self.refused(2, *args, says=[f'quote it: "{name}"'])
        # A name that no file has yet.
        self.refused(2, "render", "park2016-1", "-o", "my", "sound.wav", says=["render takes one STROKE", "blanks"])

    def test_characters_of_print_are_named(self):
        for args, says in ((("plan", "park2016-1", "\u2013\u2013duration", "2"), "type --duration"),
                           (("plan", "park2016-1", "\u2013duration", "2"), "type --duration"),
                           (("plan", "park2016-1", "\u2014duration", "2"), "type --duration"),
                           (("play", "park2016-1", "\u2011D", "null"), "type -D"),
                           (("plan", "park2016-1", "--level-dbfs", "\u221212"), "type -12"),
                           (("plan", "park2016-1", "--level-dbfs=\u201312"), "type --level-dbfs=-12"),
                           (("plan", "--path", "M 20 20 L 20 \u20135"), "type M 20 20 L 20 -5"),
                           (("plan", "--path", "\u201cM", "0", "0", "L", "9", "9\u201d"), 'type " on the keyboard')):
            self.refused(2, *args, says=[says, "as in print"])

    def test_options_by_their_letter_and_by_other_names(self):
        for args, says in ((("play", "park2016-1", "-d", "null"), "did you mean -D?"),
                           (("play", "park2016-1", "-v"), "did you mean --void-on-xrun or --verbose?"),
                           (("-v",), "did you mean --version?"),
                           (("play", "park2016-1", "--volume", "3"), "did you mean --level-dbfs?"),
                           (("serve", "--port", "4003"), "did you mean --http?"),
                           (("play", "park2016-1", "-duration", "1"), "did you mean --duration?")):
            self.refused(2, *args, says=[says])
        self.assertNotIn("did you mean", self.refused(2, "plan", "park2016-1", "-s").stderr)

    def test_values_that_lack_a_sign_or_are_no_port(self):
        self.refused(2, "play", "park2016-1", "--level-dbfs", "12", says=["did you mean -12?"])
        self.write("d.toml", "[defaults]\nlevel-dbfs = 12\n")
        self.refused(2, "plan", "park2016-1", "--config", "d.toml", says=["did you mean -12?"])
        for option in ("--http", "--tcp", "--osc"):
            self.refused(2, "serve", option, "80000", says=["80000 is no port", "0 to 65535"])

    def test_help_lists_the_options_that_have_a_word(self):
        text = self.ok("help", "level").stdout
        self.assertIn("  --level-dbfs DB ", text)
        self.assertEqual(re.findall(r"^  (?:-\w,)?--([a-z-]+)", self.ok("help", "reopen").stdout, re.M), ["reopen-s"])
        self.assertTrue(self.ok("help", "soa").stdout.startswith("--soa S\n"))
        self.refused(2, "help", "nosuchthing")

    def test_usage_has_as_many_strokes_as_a_command_takes(self):
        for command in ("plan", "render", "plot", "compare"):
            self.assertIn(f"Usage: tactor {command} [OPTIONS] [STROKE]\n", self.ok(command, "--help").stdout)
            more = {"render": ("-o", "x.wav"), "plot": ("-o", "x.svg")}.get(command, ())
            self.refused(2, command, "park2016-1", "park2016-2", *more, says=[f"{command} takes one STROKE"])
        self.assertIn("Usage: tactor play [OPTIONS] [STROKE...]\n", self.ok("play", "--help").stdout)


class Files(ToolTest):
    def test_open_quotes_are_found_where_they_open(self):
        for text, place in (('[array]\nname = "palm\ngrid = { rows = 3, columns = 3, pitch_mm = 20.0 }\n', "2:8"),
                            ("[array]\nname = 'palm\n", "2:8"), ('[array]\nname = "palm', "2:8")):
            self.write("a.toml", text)
            said = self.refused(2, "plan", "park2016-1", "--array", "a.toml",
                                says=[f"a.toml:{place}: ", "no closing quote", "on the same line"]).stderr
            self.assertNotIn("U+0009", said)
        self.write("a.toml", '[array]\nname = """palm\n\n')
        self.refused(2, "plan", "park2016-1", "--array", "a.toml")
        self.write("a.toml", "[array]\nname = palm\n")
        self.refused(2, "plan", "park2016-1", "--array", "a.toml")
        # Another fault before it comes first; quotes in comments and in other strings are no quotes.
        self.write("a.toml", "[array\nname = 'palm\n")
        self.refused(2, "plan", "park2016-1", "--array", "a.toml")
        self.write("a.toml", GRID.replace("oak", "it's \"oak").replace('"desk"', "'5\" desk'"))
        self.ok("check", "--array", "a.toml", "-D", "null")

    def test_utf_16_is_named(self):
        stroke = '[stroke]\npath = "M 0 0 L 20 0"\n'
        csv = "t_s,x_mm,y_mm\n0,0,0\n1,20,0\n"
        for name, text in (("s.toml", stroke), ("s.csv", csv), ("s.txt", csv)):
            for code in ("utf-16", "utf-16-le", "utf-16-be"):
                data = text.encode(code)
                self.write(name, data)
                self.refused(2, "plan", name, says=[f"{name}: is UTF-16", "save it as UTF-8"])
            self.write(name, text.encode("utf-8-sig"))
            self.ok("plan", name)
        self.write("a.toml", GRID.encode("utf-16"))
        self.refused(2, "plan", "park2016-1", "--array", "a.toml")

    def test_binary_data_are_named(self):
        wav = wav_bytes([0.0] * 100)
        for name, data, what in (("s.wav", wav, "a WAV file"), ("s.toml", wav, "a WAV file"), ("s.csv", wav, "a WAV file"),
                                 ("s.svg", wav, "a WAV file"), ("s", b"RF64" + wav[4:], "a WAV file"),
                                 ("p.png", b"\x89PNG\r\n\x1a\n\0", "a PNG picture"), ("p.pdf", b"%PDF-1.7\n%\xe2", "a PDF document"),
                                 ("t.csv", b"PK\x03\x04\x14\0", "a ZIP archive or office document")):
            self.write(name, data)
            self.refused(2, "plan", name, says=[f"{name}: is {what}, not text (strokes are TOML, CSV or SVG"])
        self.refused(2, "plan", "park2016-1", "--array", "s.wav")
        self.refused(2, "plan", "park2016-1", "--config", "p.png")

    def test_latin_1_is_named_with_its_place(self):
        stroke = '[stroke]\nname = "caf\xe9"\npath = "M 0 0 L 20 0"\n'
        self.write("s.toml", stroke.encode("latin-1"))
        self.refused(2, "plan", "s.toml")
        self.write("s.toml", stroke)
        self.assertEqual(self.plan("s.toml")["stroke"]["name"], "caf\xe9")
        self.write("a.toml", GRID.replace("oak", "ch\xeane").encode("latin-1"))
        self.refused(2, "plan", "park2016-1", "--array", "a.toml")

    def test_a_files_own_keys_stay_as_they_are(self):
        self.write("s.toml", '[stroke]\npath = "M 0 0 L 20 0"\nburst = 3\n')
        said = self.refused(2, "plan", "s.toml").stderr
        self.assertNotIn("--", said)

    def test_a_folder_is_named_so_everywhere(self):
        (self.dir / "folder.json").mkdir()
        for args in (("plan", "."), ("plan", "folder.json"), ("plan", "park2016-1", "--array", "."), ("plan", "park2016-1", "--config", "."),
                     ("experiment", "./", "--dry-run"), ("render", "park2016-1", "-o", "."), ("play", "park2016-1", "-D", "null", "--log", ".")):
            said = self.refused(2, *args).stderr
            self.assertNotIn("irectory", said)

    def test_slips_of_presets_have_a_suggestion(self):
        self.refused(2, "plan", "prak2016-1")
        self.refused(2, "plan", "park2016-1", "--array", "plam-3x3")

    def test_a_write_only_file_cannot_be_read(self):
        r = subprocess.run([TOOL, "plan", "/dev/stdout"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                           env=self.env, timeout=PATIENCE_S, check=False, stdin=subprocess.DEVNULL)
        self.assertEqual((r.returncode, r.stdout), (2, ""))
        self.assertIn("/dev/stdout: is where this program writes to (name a file", r.stderr)
        self.refused(2, "plot", "park2016-1", "-o", "/dev/stdout")
        self.refused(2, "plot", "park2016-1", "-o", "picture")

    def test_waiting_for_a_named_pipe_is_reported(self):
        os.mkfifo(self.dir / "s.toml")
        def write():
            (self.dir / "s.toml").write_text('[stroke]\npath = "M 0 0 L 20 0"\n', encoding="ascii")
        writer = threading.Thread(target=write, daemon=True)
        writer.start()
        r = self.ok("plan", "s.toml")
        writer.join()
        self.assertIn("s.toml: is a pipe: waiting for a program that writes to it", r.stderr)
        for command, name in (("render", "o.wav"), ("plot", "o.svg")):
            os.mkfifo(self.dir / name)
            got = []
            reader = threading.Thread(target=lambda n=name: got.append((self.dir / n).read_bytes()),
                                      daemon=True)
            reader.start()
            r = self.ok(command, "park2016-1", "-o", name)
            reader.join()
            self.assertIn(f"{name}: is a pipe: waiting for a program that reads it", r.stderr)
            self.assertGreater(len(got[0]), 1000)


class Journal(ToolTest):
    def said(self, *args, is_journal=True):
        """Returns the output to a file that is, or is not, systemd's journal."""
        with open(self.dir / "said", "w+b") as file:
            at = os.fstat(file.fileno())
            number = at.st_ino if is_journal else at.st_ino + 1
            subprocess.run([TOOL, *args], stdout=subprocess.DEVNULL, stderr=file, cwd=self.dir, check=False, timeout=PATIENCE_S,
                           env=self.env | {"JOURNAL_STREAM": f"{at.st_dev}:{number}"})
            file.seek(0)
            return file.read().decode().splitlines()

    def test_lines_have_levels(self):
        short = ("--path", "M 0 0 L 10 0", "--duration", "0.05", "--burst", "0.003")
        for is_journal, warning, error in ((True, "<4>", "<3>"), (False, "", "")):
            lines = self.said("render", *short, "-o", "w.wav", is_journal=is_journal)
            self.assertTrue(lines)
            for line in lines:
                self.assertTrue(line.startswith(warning + "tactor: warning: "), line)
            self.assertTrue(self.said("plan", "--path", "M 0 0 L", is_journal=is_journal)[0].startswith(error + "tactor: "))

    def test_the_log_has_levels_in_place_of_time_and_kind(self):
        lines = self.said("play", "park2016-1", "-D", "null", "--verbose")
        self.assertIn("<6>strokes may sound", lines)
        self.assertIn("<6>the stream has ended", lines)
        self.assertRegex("\n".join(self.said("play", "park2016-1", "-D", "null", "--verbose", is_journal=False)),
                         r"(?m)^\d{4}-\S+Z info strokes may sound$")


class Walk(ToolTest):
    def test_b_goes_one_step_back(self):
        self.write("a.toml", GRID)
        r = self.run_tool("check", "--walk", "--array", "a.toml", "-o", "felt.toml",
                          stdin="\n".join(["b", "0", "b", "1", "0"]) + "\n")
        self.assertEqual(r.returncode, 0, r.stderr)
        self.assertIn("This is the first, there is none before it.", r.stdout)
        self.assertEqual(re.findall(r"tactor (\d) \(channel", r.stdout), ["0", "0", "1", "0", "1"])
        self.assertNotIn("b back", r.stdout.split("tactor 1")[0])
        self.assertIn("b back", r.stdout)
        self.assertIn("tactors 0 to 1 are on channels 1, 0", r.stdout)


if __name__ == "__main__":
    main()
