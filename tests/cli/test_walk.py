# SPDX-License-Identifier: MIT
"""tactor check --walk on ALSA's null and file devices, with answers from a pipe and from a terminal."""
import contextlib
import fcntl
import json
import os
import pty
import signal
import struct
import subprocess
import termios
import tomllib

from harness import GRID, PATIENCE_S, TOOL, ToolTest, main


class Walk(ToolTest):
    def walk(self, answers, *more, **kw):
        return self.run_tool("check", "--walk", *more, stdin="".join(f"{a}\n" for a in answers), **kw)

    def channels(self, array):
        return [t["channel"] for t in self.plan("--path", "M 0 0 L 20 0", "--array", array)["array"]["tactors"]]

    def sounded(self, channels):
        """Returns the channels of out.raw (s16) in the order in which they sounded, each run once."""
        raw = memoryview((self.dir / "out.raw").read_bytes()).cast("h")
        order = []
        for i in range(0, len(raw), channels * 7):
            loud = [c for c, v in enumerate(raw[i:i + channels]) if v]
            self.assertLessEqual(len(loud), 1, "two at once")
            if loud and order[-1:] != loud:
                order += loud
        return order

    def test_each_tactor_sounds_alone_in_order_at_the_level_of_play(self):
        self.write("a.toml", GRID)
        r = self.walk([0, 1], "--array", "a.toml", "-D", f"raw:{self.dir}/out.raw", "--sample-format", "s16",
                      "--level-dbfs", "-20")
        self.assertEqual(r.returncode, 0, r.stderr)
        self.assertEqual(self.sounded(2), [0, 1])
        raw = memoryview((self.dir / "out.raw").read_bytes()).cast("h")
        peaks = [max(raw[c::2]) / 32768 for c in range(2)]
        for peak, dbfs in zip(peaks, (-20, -23)):
            self.assertAlmostEqual(peak, 10 ** (dbfs / 20), delta=1e-3)
        self.assertIn("The map is right.", r.stdout)
        self.assertEqual(set(raw[-2:]), {0})

    def test_answers_become_a_new_file(self):
        self.write("a.toml", GRID)
        r = self.walk([1, 0], "--array", "a.toml", "-o", "felt.toml")
        self.assertEqual(r.returncode, 0, r.stderr)
        self.assertIn("tactors 0 to 1 are on channels 1, 0", r.stdout)
        self.assertEqual((self.dir / "a.toml").read_text(), GRID)
        self.assertEqual(self.channels("felt.toml"), [1, 0])

    def test_the_new_file_says_all_that_the_old_one_does(self):
        r = self.walk([1, 0, 2, 3, 4, 5, 6, 7], "--array", "palm-2x4", "-D", "null", "-o", "palm.toml")
        self.assertEqual(r.returncode, 0, r.stderr)
        self.assertEqual(self.channels("palm.toml"), [1, 0, 2, 3, 4, 5, 6, 7])
        self.write("base/a.toml", GRID)
        self.write("base/b.toml", '[array]\nfile = "a.toml"\n[limits]\nmax_drive_s = 3\n[sync]\nchannel = 4\n'
                                  '[defaults]\nlevel_dbfs = -40\n')
        self.write("out/keep", "")
        r = self.walk([1, 0], "--array", "base/b.toml", "-o", "out/felt.toml")
        self.assertEqual(r.returncode, 0, r.stderr)
        self.assertEqual(self.channels("out/felt.toml"), [1, 0])
        (self.dir / "base/a.toml").unlink()
        self.assertIn("each at most 3 s", self.ok("check", "--array", "out/felt.toml").stdout)
        felt = tomllib.loads((self.dir / "out/felt.toml").read_text())
        self.assertEqual((felt["sync"], felt["defaults"]), ({"channel": 4}, {"level_dbfs": -40}))
        self.write("base/a.toml", GRID)
        # The configuration's own array as well.
        r = self.walk([1, 0], "--config", "base/a.toml", "-o", "felt.toml")
        self.assertEqual((r.returncode, self.channels("felt.toml")), (0, [1, 0]), r.stderr)

    def test_answers_that_are_no_permutation_make_no_file(self):
        self.write("a.toml", GRID)
        for answers, says in (([1, 1], ["tactor 0 (channel 0) and tactor 1 (channel 1)", "at one place, 1"]),
                              ([0, "n"], ["tactor 1 (channel 1) was felt nowhere"])):
            r = self.walk(answers, "--array", "a.toml", "-o", "felt.toml")
            self.assertEqual(r.returncode, 1)
            for text in says:
                self.assertIn(text, r.stderr)
            self.assertFalse((self.dir / "felt.toml").exists())

    def test_leaving_and_the_end_of_the_answers_make_no_file(self):
        self.write("a.toml", GRID)
        for answers, says in (([0, "q"], "left after 1 of 2"), ([0], "no answer for tactor 1"), ([], "no answer for tactor 0")):
            r = self.walk(answers, "--array", "a.toml", "-o", "felt.toml")
            self.assertEqual(r.returncode, 1)
            self.assertIn(says, r.stderr)
            self.assertFalse((self.dir / "felt.toml").exists())

    def test_r_repeats_and_nonsense_is_asked_again(self):
        self.write("a.toml", GRID)
        r = self.walk([" 0 ", "r", "9", "", "one", "1"], "--array", "a.toml", "-D", f"raw:{self.dir}/out.raw",
                      "--sample-format", "s16")
        self.assertEqual(r.returncode, 0, r.stderr)
        self.assertEqual(r.stdout.count("tactor 1 (channel 1): which did you feel?"), 5)
        self.assertIn('"9" is none of these', r.stdout)
        self.assertEqual(self.sounded(2), [0, 1])

    def test_auto_asks_nothing(self):
        self.write("a.toml", GRID)
        r = self.ok("check", "--walk", "--auto", "--array", "a.toml", "-D", f"raw:{self.dir}/out.raw", "--sample-format", "s16")
        self.assertEqual(self.sounded(2), [0, 1])
        self.assertIn("tactor 1: channel 1, at 20, 0 mm", r.stdout)
        self.assertNotIn("which did you feel", r.stdout)

    def test_a_walk_as_json_asks_on_standard_error(self):
        self.write("a.toml", GRID)
        r = self.walk([1, 0], "--array", "a.toml", "--format", "json")
        walked = json.loads(r.stdout)["walk"]
        self.assertEqual(walked["answers"][0], {"tactor": 0, "channel": 0, "felt": 1})
        self.assertEqual((walked["channels"], walked["changed"], walked["problems"]), ([1, 0], True, []))
        self.assertIn("which did you feel?", r.stderr)
        r = self.walk([0, "n"], "--array", "a.toml", "--format", "json")
        self.assertEqual(r.returncode, 1)
        walked = json.loads(r.stdout)["walk"]
        self.assertEqual((walked["channels"], len(walked["problems"]), walked["answers"][1]["felt"]), (None, 1, None))

    def test_a_setup_with_errors_drives_nothing(self):
        self.write("a.toml", GRID + '[amplifier]\nline = { name = "no such line" }\n')
        r = self.walk([0, 1], "--array", "a.toml", "-D", f"raw:{self.dir}/out.raw", "--sample-format", "s16", "-o", "felt.toml")
        self.assertEqual(r.returncode, 3)
        self.assertFalse((self.dir / "felt.toml").exists())
        self.assertEqual((self.dir / "out.raw").stat().st_size if (self.dir / "out.raw").exists() else 0, 0)

    def on_terminal(self, *args):
        """Starts the tool on a pseudo-terminal; returns its process, and the end to read and write."""
        ours, theirs = pty.openpty()
        fcntl.ioctl(ours, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
        p = subprocess.Popen([TOOL, *args], stdin=theirs, stdout=theirs, stderr=subprocess.PIPE, cwd=self.dir,
                             env=self.env | {"TERM": "xterm", "LC_ALL": "C.UTF-8"})
        os.close(theirs)
        self.addCleanup(os.close, ours)
        self.addCleanup(lambda: p.poll() is None and p.kill())
        return p, ours

    def read_until(self, fd, text):
        seen = b""
        while text.encode() not in seen:
            seen += os.read(fd, 4096)
        return seen.decode()

    def test_on_a_terminal_the_picture_shows_the_tactor(self):
        self.write("a.toml", GRID)
        p, fd = self.on_terminal("check", "--walk", "--array", "a.toml", "-o", "felt.toml")
        for i in range(2):
            # Once more where the machine was too busy to draw while a burst lasted.
            while "█" not in self.read_until(fd, f"tactor {i} (channel {i}): which did you feel?"):
                os.write(fd, b"r\n")
            os.write(fd, f"{i ^ 1}\n".encode())
        self.read_until(fd, "Written: felt.toml")
        self.assertEqual(p.wait(timeout=PATIENCE_S), 0)
        self.assertEqual(self.channels("felt.toml"), [1, 0])

    def test_ctrl_c_at_a_question_and_in_a_burst_ends_in_silence_without_a_file(self):
        # Long enough that none of it is over before it has been seen.
        self.write("a.toml", GRID.replace("columns = 2", "columns = 60"))
        raw = self.dir / "out.raw"
        for auto in ((), ("--auto",)):
            # The fade is in one period: it is written whole, however long the machine stands still.
            p, fd = self.on_terminal("check", "--walk", "--array", "a.toml", "-D", f"raw:{raw}", "--sample-format", "s16",
                                     "--level-dbfs", "0", "--period-frames", "1024", "--periods", "3",
                                     *(auto or ("-o", "felt.toml")))
            if auto:
                self.until(lambda: raw.exists() and any(raw.read_bytes()[-120 * 4800:]), p)
            else:
                self.read_until(fd, "which did you feel?")
            p.send_signal(signal.SIGINT)
            with contextlib.suppress(OSError):  # the terminal closes with the program
                while os.read(fd, 4096):
                    pass
            self.assertEqual(p.wait(timeout=PATIENCE_S), 130)
            self.assertFalse((self.dir / "felt.toml").exists())
            heard = memoryview(raw.read_bytes()).cast("h")
            self.assertEqual(set(heard[-60:]), {0})
            # A tactor at a time: their sum is the sound.
            sound = [sum(heard[i:i + 60]) for i in range(0, len(heard), 60)]
            self.assertGreater(max(sound), 1000)
            self.assertLessEqual(max(abs(a - b) for a, b in zip(sound, sound[1:])), 32768 * 0.0328)
            raw.unlink()


if __name__ == "__main__":
    main()
