# SPDX-License-Identifier: MIT
"""Outputs of every command: pipes, standard output, files of others and inputs, which none replaces; names chosen by strangers; and
inputs of the largest size."""
import contextlib
import hashlib
import itertools
import os
import pathlib
import pty
import re
import resource
import select
import signal
import struct
import subprocess

from experiments import ExperimentTest, contents
from harness import GRID, PATIENCE_S, TOOL, ToolTest, Wav, main, wav_bytes
import studies

ESCAPE = "\x1b[31m"
MB = 1 << 20
LONG = ("--path", "M 0 10 L 40 30", "--duration", "7200")


class Output(ToolTest):
    def start(self, *args, **more):
        return self.start_tool(*args, **({"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | more))

    def ended(self, *args, **more):
        """Runs the tool; returns exit status, output and messages."""
        process = self.start(*args, **more)
        out, said = process.communicate(timeout=PATIENCE_S)
        return process.returncode, out, said

    def open_terminal(self):
        ours, theirs = pty.openpty()
        self.addCleanup(os.close, ours)
        return ours, theirs


class Sound(Output):
    def test_standard_output_and_pipes_get_the_files_bytes_and_nothing_else(self):
        self.ok("render", "park2016-1", "-o", "file.wav")
        expected = (self.dir / "file.wav").read_bytes()
        for name in ("-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"):
            status, out, said = self.ended("render", "park2016-1", "-o", name)
            self.assertEqual((status, out[:len(expected)]), (0, expected))
            if name in ("-", "/dev/stdout"):
                self.assertEqual((len(out), b"70560 frames" in said), (len(expected), True))
        os.mkfifo(self.dir / "pipe")
        process = self.start("render", "park2016-1", "-o", "pipe")
        self.assertEqual((self.dir / "pipe").read_bytes(), expected)
        process.communicate(timeout=PATIENCE_S)
        self.assertTrue(process.returncode == 0 and (self.dir / "pipe").is_fifo())
        ours, theirs = self.open_terminal()
        self.assertIn(b"terminal", self.ended("render", "park2016-1", "-o", "-", stdout=theirs)[2])
        os.close(theirs)

    def test_an_unread_pipe_can_be_interrupted(self):
        os.mkfifo(self.dir / "pipe")
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
            process = self.start("render", "park2016-1", "-o", "pipe")

            def is_blocked(process=process):  # SIGINT, as soon as the tool handles signals itself
                lines = pathlib.Path(f"/proc/{process.pid}/status").read_text(encoding="ascii").splitlines()
                return int(next(line for line in lines if line.startswith("SigBlk:")).split()[1], 16) & 1 << (signal.SIGINT - 1)
            self.until(is_blocked, process)
            process.send_signal(number)
            process.communicate(timeout=PATIENCE_S)
            self.assertEqual(process.returncode, 128 + number)

    def test_a_typing_slip_replaces_nothing(self):
        for name in ("thesis.tex", "notes.wav"):
            self.write(name, "years of work")
            self.refused(2, "render", "park2016-1", "-o", name)
            self.assertEqual((self.dir / name).read_text(), "years of work")
        self.write("empty.wav", "")
        for name in ("empty.wav", "empty.wav", "NEW.WAV"):
            self.ok("render", "park2016-1", "-o", name)
        self.assertEqual(Wav(self.dir / "NEW.WAV").frames, 70560)

    def test_above_the_greatest_size_there_is_a_hint_and_no_part(self):
        status, _, said = self.ended("render", "park2016-1", "-o", "o.wav", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (MB, MB)))
        self.assertEqual((status, b"ulimit -f" in said, [p.name for p in self.dir.iterdir()]), (1, True, ["alsa.conf"]), said)


class Readers(Output):
    def closed(self, *args, **more):
        """Runs the tool with standard output into a pipe without a reader."""
        ours, theirs = os.pipe()
        os.close(ours)
        try:
            return self.ended(*args, **({"stdout": theirs} | {k: v(theirs) for k, v in more.items()}))
        finally:
            os.close(theirs)

    def test_an_early_closed_pipe_is_no_error_for_any_output(self):
        # More than a buffer holds, and less: help, listings, tables.
        studies.simulated(self.dir / "study")
        (self.dir / "link.svg").symlink_to("/dev/stdout")
        for args in (("help", "play"), ("--version",), ("plan", *LONG), ("plan", "park2016-1", "--format", "json"),
                     ("compare", "park2016-1"), ("check", "-D", "null"), ("devices",), ("analyze", "study"),
                     ("analyze", "study", "--format", "tsv"), ("report", "study"), ("experiment", "park2016", "--dry-run"),
                     ("experiment", "park2016", "--print"), ("plot", "park2016-1", "-o", "o.svg"), ("play", "park2016-1", "-D", "null"),
                     ("render", "park2016-1", "-o", "-"), ("render", "park2016-1", "-o", "/dev/fd/1"), ("plot", "park2016-1", "-o", "link.svg")):
            status, _, said = self.closed(*args)
            self.assertEqual((status, b"standard output" in said), (128 + signal.SIGPIPE, False), f"{args}: {said}")
        status, _, said = self.closed("render", "park2016-1", "-o", "/dev/fd/9", stdout=lambda _: subprocess.PIPE,
                                      preexec_fn=lambda theirs: lambda: os.dup2(theirs, 9), pass_fds=lambda _: [9])
        self.assertEqual((status, b"run to the end" in said), (1, True), said)

    def test_full_and_closed_outputs_are_reported_and_a_lost_standard_error_changes_no_status(self):
        with open("/dev/full", "wb", buffering=0) as full:
            for args in (("help", "play"), ("plan", "park2016-1"), ("devices",), ("--version",)):
                status, _, said = self.ended(*args, stdout=full)
                self.assertEqual((status, said.startswith(b"tactor: standard output: No space left on device")), (1, True), said)
            for wanted, args in ((2, ("plan", "no-such-preset")), (0, ("play", "park2016-1")), (0, ("render", "park2016-1", "-o", "-"))):
                for more in ({"stderr": full}, {"preexec_fn": lambda: os.close(2)}):
                    self.assertEqual(self.ended(*args, **more)[0], wanted, f"{args} {more}")
        for args in (("render", "park2016-1", "-o", "-"), ("plan", "park2016-1"), ("render", "park2016-1", "-o", "x.wav")):
            status, _, said = self.ended(*args, preexec_fn=lambda: os.close(1))
            self.assertEqual((status, b"Bad file descriptor (send the output to " in said), (1, True), said)
        self.ok("render", "park2016-1", "-o", "y.wav")
        self.assertEqual((self.dir / "x.wav").read_bytes(), (self.dir / "y.wav").read_bytes())

    def test_names_cannot_steer_the_terminal(self):
        self.write("s.toml", '[stroke]\nname = "a\\u001b[31mred\\u009b2J\\u007f"\npath = "M 0 0 L 40 0"\n')
        self.write(f"b{ESCAPE}.toml", '[array]\nname = "x"\n')
        self.write("a.toml", '[array]\nname = "r\\u001b[31m"\ngrid = { rows = 3, columns = 3, pitch_mm = 20.0 }\n')
        for args in (("plan", "s.toml"), ("compare", "s.toml"), ("play", "s.toml"), ("plan", f"b{ESCAPE}.toml"),
                     ("plan", f"no{ESCAPE}"), ("plot", "s.toml", "-o", f"p{ESCAPE}.svg"), (f"no{ESCAPE}",),
                     ("render", "s.toml", "-o", f"w{ESCAPE}.wav"), ("plan", "s.toml", "--array", "a.toml"),
                     ("check", "--array", "a.toml"), ("check", "--array", f"no{ESCAPE}.toml"),
                     ("devices", "--array", f"no{ESCAPE}.toml"), ("plan", "s.toml", f"--carrier={ESCAPE}")):
            r = self.run_tool(*args)
            for text in (r.stdout, r.stderr):
                self.assertFalse([c for c in text if (ord(c) < 32 and c != "\n") or 127 <= ord(c) < 160], f"{args}: {text!r}")
        self.assertIn("\\x1b[31m", self.ok("plan", "s.toml").stdout)
        self.assertEqual(self.plan("s.toml")["stroke"]["name"], "a\x1b[31mred\x9b2J\x7f")

    def test_a_line_end_in_a_name_begins_no_line(self):
        self.write("s.toml", '[stroke]\nname = "a\\ntactor: forged"\npath = "M 0 0 L 40 0"\n')
        self.write("two.toml", '[[stroke]]\nname = "a\\ntactor: forged"\npath = "M 0 0 L 40 0"\nduration_s = 9e9\n[[stroke]]\npath = "M 0 0 H 9"\n')
        self.write("a.toml", '[array]\nname = "r\\ntactor: forged"\ngrid = { rows = 3, columns = 3, pitch_mm = 20.0 }\n')
        self.write("b\ntactor: forged.toml", '[stroke]\npath = "M 0 0 L 40 0"\n')
        for args in (("plan", "s.toml"), ("compare", "s.toml"), ("play", "s.toml", "-D", "null"), ("plan", "two.toml"), ("plan", "s.toml", "--array", "a.toml"),
                     ("compare", "s.toml", "--array", "a.toml"), ("plan", "b\ntactor: forged.toml"), ("play", "b\ntactor: forged.toml", "-D", "null"),
                     ("a\ntactor: forged",), ("plan", "no\ntactor: forged"), ("check", "--array", "a.toml", "-D", "null"), ("devices", "--array", "a.toml"), ("experiment", "park2016", "--dry-run", "--array", "a.toml")):
            r = self.run_tool(*args)
            self.assertNotRegex(r.stdout + r.stderr, "(?m)^tactor: forged", args)

    def test_long_work_shows_its_progress(self):
        # Half a minute of planning: work that ends within half a second shows nothing.
        self.write("s.toml", "".join(f'[[stroke]]\npath = "M 0 {i % 40} L 40 20"\nduration_s = 20\n' for i in range(100_000)))
        os.mkfifo(self.dir / f"l{ESCAPE}.wav")
        reader = os.open(self.dir / f"l{ESCAPE}.wav", os.O_RDONLY | os.O_NONBLOCK)
        self.addCleanup(os.close, reader)
        for args, name in ((("compare", "park2016-1", "--spread", "100000"), b"compare: "),
                           (("experiment", "park2016", "--power", "1000", "--studies", "100000", "--simulate", "seed=1,sigma=1"), b"--power: "),
                           (("plan", "s.toml"), b"s.toml: "), (("render", *LONG, "-o", f"l{ESCAPE}.wav"), rb"l\\x1b\[31m.wav: ")):
            with self.subTest(args):
                terminal, side = self.open_terminal()
                process = self.start(*args, stdout=subprocess.DEVNULL, stderr=side)
                os.close(side)
                said = b""
                while not said.endswith(b" %"):
                    ready = select.select([terminal, reader], [], [], PATIENCE_S)[0]
                    self.assertTrue(ready, said)
                    with contextlib.suppress(BlockingIOError):
                        os.read(reader, MB)
                    if terminal in ready:
                        said += os.read(terminal, 4096)
                process.kill()
                process.wait()
                self.assertRegex(said, rb"\r\x1b\[K" + name + rb"\d+\.\d %$")


class Inputs(ExperimentTest):
    SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="40mm" viewBox="0 0 40 40"><path d="M 0 20 L 40 20"/></svg>'
    STROKE = '[stroke]\npath = "M 0 20 L 40 20"\n'
    # Inputs, and a command that reads each.
    READ = (("s.svg", "s.svg"), ("s.csv", "s.csv"), ("s.toml", "s.toml"), ("p.json", "p.json"), ("a.toml", "s.toml --array a.toml"),
            ("c.toml", "s.toml --config c.toml"), ("a.toml", "s.toml --array more.toml"), ("a.toml", "s.toml --config more.toml"),
            ("tex.wav", "s.toml --waveform tex.wav"), ("tex.wav", "tex.toml"), ("tex.wav", "s.toml --config wave.toml"),
            ("tex.wav", "s.toml --waveform tex.wav --texture length --texture-mm 20"))

    def setUp(self):
        super().setUp()
        for name, text in (("s.svg", self.SVG), ("s.csv", "t_s,x_mm,y_mm\n0,0,20\n1,40,20\n"), ("s.toml", self.STROKE),
                           ("a.toml", GRID.replace("rows = 1", "rows = 3").replace("columns = 2", "columns = 3")), ("c.toml", "[output]\nrate = 48000\n"),
                           ("more.toml", '[array]\nfile = "a.toml"\n'), ("wave.toml", '[defaults]\nwaveform = "tex.wav"\n'),
                           ("tex.toml", self.STROKE + 'waveform = "tex.wav"\n'), ("tex.wav", wav_bytes([(k % 64 - 31.5) / 32 for k in range(64)]))):
            self.write(name, text)
        self.write("p.json", self.ok("plan", "s.toml", "--format", "json").stdout)

    def kept(self, file, *args, **more):
        """Checks that a command does not write over the file."""
        before = (self.dir / file).read_bytes()
        r = self.run_tool(*args, **more)
        self.assertEqual((r.returncode, r.stderr[:8], (self.dir / file).read_bytes()), (2, "tactor: ", before), f"{file} {args}: {r.stderr}")
        return r.stderr

    def link(self, file, extension):
        link = self.dir / f"link{extension}"
        link.unlink(missing_ok=True)
        os.link(self.dir / file, link)
        return link.name

    def test_pictures_sound_and_logs_do_not_replace_what_the_command_reads(self):
        for file, args in self.READ:
            for command, extension in (("plot", ".svg"), ("plot", ".png"), ("render", ".wav")):
                self.kept(file, command, *args.split(), "-o", self.link(file, extension))
            self.assertIn("input", self.kept(file, "plot", *args.split(), "-o", self.link(file, ".svg"), "--force"))
            self.assertIn(file, self.kept(file, "play", *args.split(), "-D", "null", "--log", file))
        self.kept("s.svg", "compare", "s.svg", "-o", "s.svg", "--force")
        self.refused(2, "plot", "s.svg", "-o", "s.svg", "--force")
        self.refused(2, "render", "tex.toml", "-o", "./tex.wav")
        for _ in range(2):
            self.ok("render", "s.toml", "--waveform", "tex.wav", "-o", "new.wav")  # not an input

    def test_standard_input_counts(self):
        for args, extension in ((("render", "-"), ".wav"), (("plot", "-", "--force"), ".svg")):
            with open(self.dir / "s.toml", encoding="utf-8") as f:
                r = subprocess.run([TOOL, *args, "-o", self.link("s.toml", extension)], cwd=self.dir, env=self.env, stdin=f, capture_output=True,
                                   timeout=PATIENCE_S, check=False)
            self.assertEqual((r.returncode, (self.dir / "s.toml").read_text()), (2, self.STROKE), r.stderr)

    def spared(self, file, *args, stdin=os.devnull):
        """Checks that a command does not write over a file that it reads and its standard output goes to."""
        before = (self.dir / file).read_bytes()
        with open(self.dir / file, "r+b") as out, open(self.dir / stdin, "rb") as f:
            out.seek(0, os.SEEK_END)
            r = subprocess.run([TOOL, *args], cwd=self.dir, env=self.env, stdin=f, stdout=out, stderr=subprocess.PIPE, timeout=PATIENCE_S, check=False, text=True)
        self.assertEqual((r.returncode, (self.dir / file).read_bytes()), (2, before), f"{args}: {r.stderr}")
        self.assertIn("it is the output of this program (write to another file)", r.stderr)

    def test_standard_output_goes_over_no_input(self):
        for file, args in self.READ:
            self.spared(file, "plan", *args.split())
        self.write("live.txt", "0 20 1\n")
        for file, args, stdin in (("s.toml", "render s.toml -o -", os.devnull), ("s.toml", "compare s.toml", os.devnull),
                                  ("a.toml", "check --array a.toml", os.devnull), ("s.toml", "plan -", "s.toml"),
                                  ("live.txt", "play --live - -D null", "live.txt"), ("live.txt", "play --live - --socket none", "live.txt")):
            self.spared(file, *args.split(), stdin=stdin)

    def test_a_calibration_replaces_none_of_its_inputs(self):
        calibrate = ("calibrate", "--participant", "P07", "--simulate", "threshold=-40,spread=2", "--tactors", "0", "--array", "a.toml", "--config", "c.toml")
        for file in ("a.toml", "c.toml"):
            self.assertIn(file, self.kept(file, *calibrate, "-o", file))
            self.assertIn(file, self.kept(file, *calibrate, "-o", "new.toml", "--log", file))
        self.assertFalse((self.dir / "new.toml").exists())

    def test_analysis_report_and_experiment_replace_nothing_of_the_study(self):
        self.simulate()
        before = contents(self.dir / "study")
        for command, extension, files in (("analyze", ".svg", ("sourcedata/sub-01/session.json",)), ("report", ".md", ("participants.tsv",))):
            for file in (*files, next((self.dir / "study").glob("sub-01/beh/*.tsv")).relative_to(self.dir / "study")):
                for more in ((), ("--force",)):
                    self.kept(f"study/{file}", command, "study", "-o", self.link(f"study/{file}", extension), *more)
                self.spared(f"study/{file}", command, "study")
                self.assertEqual(contents(self.dir / "study"), before)
        definition = self.dir / "study/participants.json"
        definition.unlink()
        definition.write_text((self.dir / "small.toml").read_text())
        before = definition.read_bytes()
        self.simulate("02", definition="study/participants.json")
        self.assertEqual(definition.read_bytes(), before)

    def test_a_file_of_another_program_or_one_that_was_changed_is_replaced_only_with_force(self):
        self.simulate()
        png = b"\x89PNG\r\n\x1a\n" + struct.pack(">I4sIIBBBBBI", 13, b"IHDR", 1, 1, 8, 2, 0, 0, 0, 0)
        foreign = {".svg": self.SVG.encode(), ".png": png, ".pdf": b"%PDF-1.4\n" + b"x" * 40000 + b"\nstartxref\n9\n%%EOF\n",
                   ".md": b"# Methods\n\nA year of writing.\n", ".wav": wav_bytes([0.25, -0.25])}
        for command, stroke, extension in (*(("plot", "park2016-1", e) for e in (".svg", ".png", ".pdf")), ("compare", "park2016-1", ".svg"),
                                           ("analyze", "study", ".svg"), ("report", "study", ".md"), ("render", "park2016-1", ".wav")):
            with self.subTest(command=command, extension=extension):
                name = f"mine{extension}"
                self.write(name, foreign[extension])
                said = self.kept(name, command, stroke, "-o", name)
                self.assertTrue(name in said and "tactor did not write it" in said and "--force" in said, said)
                self.ok(command, stroke, "-o", name, "--force")
                ours = (self.dir / name).read_bytes()
                self.assertNotEqual(ours, foreign[extension])
                self.ok(command, stroke, "-o", name)  # its own
                self.assertEqual((self.dir / name).read_bytes(), ours)
                for edited in (ours[:-30] + bytes([ours[-30] ^ 1]) + ours[-29:], ours[:4000] + b" " + ours[4000:], ours + b"A label\n"):
                    self.write(name, edited)
                    said = self.kept(name, command, stroke, "-o", name)
                    # An edit may also hide that tactor wrote a PDF.
                    self.assertRegex(said, rf"{name}.*(somebody changed it after tactor wrote it|tactor did not write it).*--force")
                    self.ok(command, stroke, "-o", name, "--force")
                    self.assertEqual((self.dir / name).read_bytes(), ours)
                digits = re.search(rb"sha256.([0-9a-f]{64})", ours)
                note = {".svg": ours[digits.start() - 5:], ".md": ours[digits.start() - 6:], ".pdf": ours[digits.start() - 2:digits.end() + 1],
                        ".png": ours[digits.start() - 8:digits.end() + 4], ".wav": ours[-92:]}[extension]
                self.assertEqual(hashlib.sha256(ours.replace(note, b"")).hexdigest(), digits[1].decode())
        self.ok("plot", "park2016-1", "-o", "p.svg")
        edited = (self.dir / "p.svg").read_text(encoding="utf-8").replace(
            'encoding="UTF-8"?>', 'encoding="UTF-8" standalone="no"?>\n<!-- Created with Inkscape -->', 1)
        self.write("p.svg", edited)
        self.kept("p.svg", "plot", "park2016-1", "-o", "p.svg")  # an editor has saved it


class Large(ToolTest):
    """Endless input, or input of the largest size: bounded memory, and time that grows only with the size."""

    def write_pieces(self, name, pieces):
        """Writes in pieces: this process's peak memory counts as the peak of its children."""
        with open(self.dir / name, "wb") as f:
            for piece in pieces:
                f.write(piece)
        return self.dir / name

    def cost(self, *args, stdin=subprocess.DEVNULL):
        """Returns exit status, messages, peak memory in MB and processor time in seconds."""
        with open(self.dir / "said", "w+b") as said:
            p = subprocess.Popen([TOOL, *args], stdin=stdin, stdout=subprocess.DEVNULL, stderr=said, cwd=self.dir, env=self.env)
            try:
                _, status, usage = os.wait4(p.pid, 0)
            except BaseException:
                p.kill()
                raise
            said.seek(0)
            return os.waitstatus_to_exitcode(status), said.read().decode(), usage.ru_maxrss / 1024, usage.ru_utime + usage.ru_stime

    def test_memory_is_bounded_for_any_input(self):
        with open("/dev/zero", "rb") as endless:
            status, said, mb, _ = self.cost("plan", "-", stdin=endless)
        self.assertEqual((status, said), (2, "tactor: standard input: it is larger than 512 MB (check that it is the right file)\n"))
        self.assertLess(mb, 600)
        self.write_pieces("values.csv", (b"0," * (MB // 2) for _ in range(64)))
        status, said, mb, _ = self.cost("plan", "values.csv")
        self.assertTrue(status == 2 and "values.csv:1:2001: the line has more than 1000 values" in said, said)
        self.assertLess(mb, 128)
        points = (b"%d.%03d,%d,%d.%020d\n" % (i // 1000, i % 1000, i % 40, i % 31, 7) for i in range(1_000_000))
        path = self.write_pieces("long.csv", itertools.chain([b"t_s,x_mm,y_mm\n"], points))
        status, said, mb, _ = self.cost("plan", "long.csv", "--format", "csv")
        self.assertEqual((status, said), (0, ""))
        self.assertLess(mb, path.stat().st_size / MB + 32 + 32)  # points of 32 bytes; the tool itself
        # A tenth of a kilobyte a burst; 4 MB for a curve of any length.
        for algorithm, rate, most_bytes in (("park2016", "48000", 100 * 3600 / 0.07), ("continuous", "8000", 4 * MB)):
            costs = [self.cost("render", "park2016-1", "--algorithm", algorithm, "--duration", s, "--rate", rate, "-o", "-") for s in ("1", "3600")]
            self.assertEqual([status for status, *_ in costs], [0, 0])
            self.assertLess((costs[1][2] - costs[0][2]) * MB, most_bytes, algorithm)

    def test_a_text_for_a_tree_has_a_lower_limit(self):
        for name, most in (("big.svg", 48), ("big.toml", 48), ("big.tact", 16), ("big.haptic", 16), ("big.ahap", 16)):
            with open(self.dir / name, "wb") as f:
                f.truncate(500 * MB)
            self.refused(2, "plan", name, says=[f"{name}: it is larger than {most} MB"])
            self.assertLess(self.cost("plan", name)[2], most + 32)  # MB; the tool itself

    def test_time_grows_with_the_size(self):
        def seconds_for(points):
            parts = [i / (points - 1) for i in range(points)]
            speeds = ", ".join(f"[{p:.9f}, {20 + 80 * (i * 7919 % points) / points:.3f}]" for i, p in enumerate(parts))
            carriers = ", ".join(f"[{p:.9f}, {100 + 200 * (i * 104729 % points) / points:.3f}]" for i, p in enumerate(parts))
            self.write("two.toml", f'[[stroke]]\npath = "M 0 20 L 40 20"\neasing = "minimum-jerk"\nspeed_mm_s = [{speeds}]\ncarrier_profile = [{carriers}]\n')
            status, said, _, used = self.cost("render", "two.toml", "-o", "two.wav")
            self.assertEqual((status, said), (0, ""))
            return used

        def seconds_for_shapes(shapes):
            self.write("drawing.svg", "<svg>\n" + "".join(f"<path d='M {i % 40} 0 L 40 {i % 40}'/>\n" for i in range(shapes)) + "</svg>\n")
            status, said, _, used = self.cost("plan", "drawing.svg", "--format", "csv")
            self.assertEqual(status, 0, said)
            return used

        # Eight times as many: quadratic time would be 64 times.
        self.assertLess(seconds_for(80_000), 24 * seconds_for(10_000))
        # The largest of three: the others had luck. Ten times as many took seventy times as long when each was looked up in the file.
        self.assertLess(seconds_for_shapes(15000), 25 * max(seconds_for_shapes(1500) for _ in range(3)))


if __name__ == "__main__":
    main()
