# SPDX-License-Identifier: MIT
"""Destinations of `render`: pipes, standard output, files of others; and names chosen by strangers in the output."""
import contextlib
import os
import pathlib
import pty
import resource
import select
import signal
import stat
import subprocess
import sys
import termios

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "study"))
import studies

from harness import PATIENCE_S, TOOL, ToolTest, Wav, main

ESCAPE = "\x1b[31m"


class Output(ToolTest):
    def start(self, *args, **more):
        return subprocess.Popen([TOOL, *args], cwd=self.dir, env=self.env, stderr=subprocess.PIPE,
                                **({"stdout": subprocess.PIPE} | more))

    def await_blocked_signals(self, process):
        """Waits until the tool handles signals itself: SIGINT is among those that it blocks."""
        def blocked():
            with open(f"/proc/{process.pid}/status", encoding="ascii") as f:
                return int(next(line for line in f if line.startswith("SigBlk:")).split()[1], 16)
        self.until(lambda: blocked() & 1 << (signal.SIGINT - 1), process)

    def leftovers(self):
        return sorted(p.name for p in self.dir.iterdir() if p.name != "alsa.conf")


class Pipes(Output):
    def setUp(self):
        super().setUp()
        self.ok("render", "park2016-1", "-o", "file.wav")
        self.expected = (self.dir / "file.wav").read_bytes()
        os.mkfifo(self.dir / "pipe")

    def test_standard_output_gets_the_files_bytes_and_nothing_else(self):
        for name in ("-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"):
            process = self.start("render", "park2016-1", "-o", name)
            out, said = process.communicate(timeout=PATIENCE_S)
            self.assertEqual(process.returncode, 0, said)
            if name in ("-", "/dev/stdout"):
                self.assertEqual(out, self.expected)
                self.assertIn(b"70560 frames", said)
            else:
                self.assertTrue(out.startswith(self.expected))

    def test_a_redirected_file_is_written_from_its_position(self):
        with open(self.dir / "all", "wb", buffering=0) as f:
            f.write(b"before")
            self.assertEqual(self.start("render", "park2016-1", "-o", "-", stdout=f).wait(timeout=PATIENCE_S), 0)
        self.assertEqual((self.dir / "all").read_bytes(), b"before" + self.expected)

    def test_a_pipe_gets_the_files_bytes(self):
        process = self.start("render", "park2016-1", "-o", "pipe")
        self.assertEqual((self.dir / "pipe").read_bytes(), self.expected)
        process.communicate(timeout=PATIENCE_S)
        self.assertEqual(process.returncode, 0)
        self.assertTrue(stat.S_ISFIFO((self.dir / "pipe").stat().st_mode))

    def test_an_unread_pipe_can_be_interrupted(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
            process = self.start("render", "park2016-1", "-o", "pipe")
            self.await_blocked_signals(process)
            process.send_signal(number)
            process.communicate(timeout=PATIENCE_S)
            self.assertEqual(process.returncode, 128 + number)

    def test_a_reader_that_waits_gets_the_sound(self):
        process = self.start("render", "park2016-1", "-o", "pipe")
        with open(self.dir / "pipe", "rb", buffering=0) as reader:
            reader.read(4096)
            process.send_signal(signal.SIGINT)
            process.communicate(timeout=PATIENCE_S)
        self.assertEqual(process.returncode, 130)

    def test_a_reader_that_leaves_is_an_error_with_a_hint(self):
        process = self.start("render", "park2016-1", "-o", "pipe")
        with open(self.dir / "pipe", "rb", buffering=0) as reader:
            reader.read(4096)
        _, said = process.communicate(timeout=PATIENCE_S)
        self.assertEqual(process.returncode, 1)
        self.assertIn(b"pipe: cannot be written", said)
        self.assertIn(b"ended before", said)

    def test_samples_do_not_go_to_a_terminal(self):
        terminal, side = pty.openpty()
        self.addCleanup(os.close, terminal)
        process = self.start("render", "park2016-1", "-o", "-", stdout=side)
        os.close(side)
        _, said = process.communicate(timeout=PATIENCE_S)
        self.assertEqual(process.returncode, 2)
        self.assertIn(b"terminal", said)


class Files(Output):
    def test_a_typing_slip_replaces_nothing(self):
        self.write("thesis.tex", "years of work")
        self.write("notes.wav", "not a sound")
        self.refused(2, "render", "park2016-1", "-o", "thesis.tex")
        self.refused(2, "render", "park2016-1", "-o", "notes.wav")
        self.assertEqual((self.dir / "thesis.tex").read_text(), "years of work")
        self.assertEqual((self.dir / "notes.wav").read_text(), "not a sound")
        self.write("empty.wav", "")
        for name in ("empty.wav", "empty.wav", "NEW.WAV"):
            self.ok("render", "park2016-1", "-o", name)
        self.assertEqual(Wav(self.dir / "NEW.WAV").frames, 70560)

    def test_an_output_keeps_the_rights_of_the_file_that_it_replaces(self):
        for command, name in (("render", "o.wav"), ("plot", "o.svg")):
            self.ok(command, "park2016-1", "-o", name)
            (self.dir / name).chmod(0o640)
            self.ok(command, "park2016-1", "-o", name)
            self.assertEqual((self.dir / name).stat().st_mode & 0o7777, 0o640)

    def test_links_of_others_are_not_followed(self):
        (self.dir / "shared").mkdir()
        (self.dir / "shared").chmod(0o1777)
        self.write("victim.wav", "")
        (self.dir / "shared/o.wav").symlink_to(self.dir / "victim.wav")
        self.refused(2, "render", "park2016-1", "-o", "shared/o.wav")
        self.assertEqual((self.dir / "victim.wav").read_bytes(), b"")

    def test_above_the_greatest_size_there_is_a_hint_and_no_part(self):
        small = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 20, 1 << 20))  # noqa: E731
        process = self.start("render", "park2016-1", "-o", "o.wav", preexec_fn=small)
        _, said = process.communicate(timeout=PATIENCE_S)
        self.assertEqual(process.returncode, 1, said)
        self.assertIn(b"ulimit -f", said)
        self.assertEqual(self.leftovers(), [])

    def test_quit_leaves_nothing(self):
        # It stands still at its progress line: the terminal is stopped.
        terminal, side = pty.openpty()
        self.addCleanup(os.close, terminal)
        termios.tcflow(side, termios.TCOOFF)
        process = subprocess.Popen([TOOL, "render", "--path", "M 0 10 L 40 30", "--duration", "7200", "-o", "long.wav"], cwd=self.dir,
                                   env=self.env, stdout=subprocess.DEVNULL, stderr=side)
        self.until(self.leftovers, process)
        process.send_signal(signal.SIGQUIT)
        termios.tcflow(side, termios.TCOON)
        os.close(side)
        self.assertEqual(process.wait(timeout=PATIENCE_S), 128 + signal.SIGQUIT)
        self.assertEqual(self.leftovers(), [])


class People(Output):
    def test_a_reader_of_only_the_beginning_gets_no_error(self):
        process = self.start("plan", "--path", "M 0 10 L 40 30", "--duration", "3600")
        process.stdout.readline()
        process.stdout.close()
        said = process.stderr.read()
        self.assertEqual((process.wait(timeout=PATIENCE_S), said), (128 + signal.SIGPIPE, b""))
        process.stderr.close()

    def test_an_early_closed_pipe_is_no_error_for_any_output(self):
        # More than a buffer holds, and less: help, listings, tables.
        studies.simulated(self.dir / "study")
        for args in (("help", "play"), ("help",), ("--version",), ("plan", "park2016-1"), ("plan", "park2016-1", "--format", "json"),
                     ("compare", "park2016-1"), ("check", "-D", "null"), ("devices",), ("analyze", "study"),
                     ("analyze", "study", "--format", "tsv"), ("report", "study"), ("experiment", "park2016", "--dry-run"),
                     ("experiment", "park2016", "--print"), ("plot", "park2016-1", "-o", "o.svg"), ("play", "park2016-1", "-D", "null")):
            ours, theirs = os.pipe()
            os.close(ours)
            process = self.start(*args, stdout=theirs)
            os.close(theirs)
            _, said = process.communicate(timeout=PATIENCE_S)
            self.assertEqual(process.returncode, 128 + signal.SIGPIPE, f"{args}: {said}")
            self.assertNotIn(b"standard output", said, args)

    def test_a_full_disk_is_named_for_any_output(self):
        for args in (("help", "play"), ("plan", "park2016-1"), ("devices",), ("--version",)):
            with open("/dev/full", "wb") as full:
                process = self.start(*args, stdout=full)
                _, said = process.communicate(timeout=PATIENCE_S)
            self.assertEqual(process.returncode, 1, args)
            self.assertIn(b"No space left on device", said, args)

    def test_a_reader_of_only_the_beginning_of_sound_gets_no_error_either(self):
        # For any name of standard output; a named pipe has its error elsewhere.
        (self.dir / "link.svg").symlink_to("/dev/stdout")
        for command, name in (("render", "-"), ("render", "/dev/stdout"), ("render", "/dev/fd/1"), ("render", "/proc/self/fd/1"),
                              ("plot", "link.svg")):
            ours, theirs = os.pipe()
            os.close(ours)
            process = self.start(command, "park2016-1", "-o", name, stdout=theirs)
            os.close(theirs)
            _, said = process.communicate(timeout=PATIENCE_S)
            self.assertEqual((process.returncode, said), (128 + signal.SIGPIPE, b""), name)
        ours, theirs = os.pipe()
        os.close(ours)
        process = self.start("render", "park2016-1", "-o", f"/dev/fd/{theirs}", pass_fds=[theirs])
        os.close(theirs)
        _, said = process.communicate(timeout=PATIENCE_S)
        self.assertEqual(process.returncode, 1)
        self.assertIn(b"ended before all was written", said)

    def test_missing_standard_error_changes_no_status(self):
        closed = lambda: os.close(2)  # noqa: E731
        with open("/dev/full", "wb", buffering=0) as full:
            for status, args in ((2, ("plan", "no-such-preset")), (0, ("play", "park2016-1")),
                                 (2, ("plan", "--nonsense")), (0, ("render", "park2016-1", "-o", "-"))):
                for more in ({"stderr": full}, {"preexec_fn": closed}):
                    r = subprocess.run([TOOL, *args], cwd=self.dir, env=self.env, stdout=subprocess.DEVNULL, check=False,
                                       timeout=PATIENCE_S, **more)
                    self.assertEqual(r.returncode, status, f"{args} {more}")

    def test_closed_standard_output_is_reported(self):
        for args in (("render", "park2016-1", "-o", "-"), ("plan", "park2016-1"), ("render", "park2016-1", "-o", "x.wav")):
            r = subprocess.run([TOOL, *args], cwd=self.dir, env=self.env, stderr=subprocess.PIPE, text=True, check=False,
                               timeout=PATIENCE_S, preexec_fn=lambda: os.close(1))
            self.assertEqual(r.returncode, 1, args)
            self.assertIn("Bad file descriptor (it is closed: ", r.stderr)
        self.assertEqual(self.ok("render", "park2016-1", "-o", "y.wav").returncode, 0)
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

    def test_the_progress_line_shows_names_too(self):
        terminal, side = pty.openpty()
        self.addCleanup(os.close, terminal)
        os.mkfifo(self.dir / f"l{ESCAPE}.wav")
        process = subprocess.Popen([TOOL, "render", "--path", "M 0 10 L 40 30", "--duration", "7200", "-o", f"l{ESCAPE}.wav"],
                                   cwd=self.dir, env=self.env, stdout=subprocess.DEVNULL, stderr=side)
        os.close(side)
        said = b""
        # Read until its progress line; it waits for more to be read.
        with open(self.dir / f"l{ESCAPE}.wav", "rb", buffering=0) as reader:
            while b"%" not in said:
                ready = select.select([terminal, reader], [], [], PATIENCE_S)[0]
                self.assertTrue(ready, said)
                if reader in ready:
                    self.assertTrue(reader.read(1 << 16))
                if terminal in ready:
                    said += os.read(terminal, 4096)
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.wait(timeout=PATIENCE_S), 130)
        self.assertIn(b"l\\x1b[31m.wav: ", said)

    def test_long_work_shows_its_progress(self):
        # Half a minute of planning: work that ends within half a second shows nothing.
        self.write("s.toml", "".join(f'[[stroke]]\npath = "M 0 {i % 40} L 40 20"\nduration_s = 20\n' for i in range(100_000)))
        for args, name in ((("compare", "park2016-1", "--spread", "100000"), b"compare: "),
                           (("experiment", "park2016", "--power", "1000", "--studies", "100000", "--simulate", "seed=1,sigma=1"), b"--power: "),
                           (("plan", "s.toml"), b"s.toml: ")):
            with self.subTest(args):
                terminal, side = pty.openpty()
                self.addCleanup(os.close, terminal)
                process = subprocess.Popen([TOOL, *args], cwd=self.dir, env=self.env, stdout=subprocess.DEVNULL, stderr=side)
                os.close(side)
                said = b""
                with contextlib.suppress(OSError):  # it has ended
                    while not said.endswith(b" %"):
                        self.assertTrue(select.select([terminal], [], [], PATIENCE_S)[0], said)
                        said += os.read(terminal, 4096)
                process.kill()
                process.wait()
                self.assertRegex(said, rb"\r\x1b\[K" + name + rb"\d+\.\d %$")


if __name__ == "__main__":
    main()
