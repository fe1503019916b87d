# SPDX-License-Identifier: MIT
"""The live picture of play, on an emulated terminal: its rows, and the rows left behind."""
import fcntl
import os
import re
import select
import signal
import struct
import subprocess
import sys
import termios
import time

try:
    import pyte
except ImportError:
    # Debian's package is for Debian's python, and python3 may be another one.
    if sys.executable != "/usr/bin/python3" and os.path.exists("/usr/lib/python3/dist-packages/pyte"):
        os.execv("/usr/bin/python3", ["/usr/bin/python3", *sys.argv])
    print("SKIPPED: the live picture: python3-pyte is not here\n0 passed, 0 failed, 1 skipped")
    sys.exit(0)

from harness import PATIENCE_S, ToolTest, main  # noqa: E402

LONG = ("play", "--path", "M 0 10 L 40 30", "--duration", "3600", "-D", "null")
SHORT = ("play", "--path", "M 0 10 L 40 30", "--duration", "0.5", "-D", "null")
TIME = r"\d / 3600\.\d\d s"
SHADES = set("·░▒▓█")
# Codes of colours: magenta, whose contrast (WCAG 2) is 4.5 on black and 4.7 on white; the terminal's own two, reversed; their end.
COLOURS = {b"35", b"7", b"0"}


class Window:
    """The tool on a terminal of a given size."""

    def __init__(self, test, args, columns, rows, **env):
        self.primary, secondary = os.openpty()
        self.screen = pyte.Screen(columns, rows)
        self.stream = pyte.ByteStream(self.screen)
        self.raw = b""
        self.set_size(columns, rows)
        test.addCleanup(self.close)
        self.process = test.start_tool(*args, stdin=secondary, stdout=secondary, stderr=subprocess.PIPE,
                                       env=test.env | {"TERM": "xterm", "LC_ALL": "C.UTF-8"} | env, start_new_session=True)
        os.close(secondary)

    def close(self):
        if self.primary >= 0:
            os.close(self.primary)

    def set_size(self, columns, rows):
        fcntl.ioctl(self.primary, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def resize(self, columns, rows):
        self.screen.resize(rows, columns)
        self.set_size(columns, rows)

    def read(self, timeout=PATIENCE_S):
        """Reads the output; false when the other end is closed."""
        if not select.select([self.primary], [], [], timeout)[0]:
            raise AssertionError(f"nothing comes:\n{self.text()}")
        try:
            data = os.read(self.primary, 65536)
        except OSError:
            return False
        self.raw += data
        self.stream.feed(data)
        return bool(data)

    def until(self, condition):
        deadline = time.monotonic() + PATIENCE_S
        while not condition(self):
            assert time.monotonic() < deadline, f"never:\n{self.text()}"
            assert self.read(), f"it ended early:\n{self.text()}"

    def to_the_end(self):
        deadline = time.monotonic() + PATIENCE_S
        while self.read():
            assert time.monotonic() < deadline, f"it goes on:\n{self.text()}"
        self.process.wait()
        return self.process.returncode

    def lines(self):
        return [line.rstrip() for line in self.screen.display]

    def text(self):
        return "\n".join(self.lines()).rstrip()

    def shades(self):
        return sum(c in SHADES for c in self.text())


def has_picture(w, duration="3600"):
    """Returns a whole picture: the output may end in the middle of a frame."""
    return w.raw.endswith(b"\033[J") and w.shades() >= 27 and re.search(rf"\d / {duration}\.\d\d s", w.text())


class Picture(ToolTest):
    def test_the_picture_has_array_levels_place_time_and_progress(self):
        w = Window(self, LONG, 80, 24)
        w.until(has_picture)
        w.until(lambda w: "▓" in w.text() or "▒" in w.text() or "█" in w.text())
        text = w.text()
        self.assertEqual(w.shades(), 27, text)  # nine tactors of three characters; the touch is between two of them
        self.assertEqual(sum(line.strip() == "o" for line in w.lines()), 1, text)
        self.assertRegex(text, r"\[ {30}\] \d+\.\d\d / 3600\.\d\d s   at 0\.\d, 10\.\d mm")
        self.assertIn("9 channels", w.lines()[0])

    def test_ctrl_z_leaves_no_row_behind(self):
        w = Window(self, LONG, 80, 24)
        w.until(has_picture)
        for again in range(2):
            w.process.send_signal(signal.SIGTSTP)
            os.waitpid(w.process.pid, os.WUNTRACED)
            while select.select([w.primary], [], [], 0.2)[0]:
                w.read()
            self.assertEqual((w.shades(), len(w.text().splitlines())), (0, 1), w.text())
            w.process.send_signal(signal.SIGCONT)
            w.until(lambda w: has_picture(w) and w.shades() == 27)
            self.assertEqual(sum("3600" in line for line in w.lines()), 1, w.text())
        w.process.send_signal(signal.SIGINT)
        self.assertEqual(w.to_the_end(), 130)

    def test_the_touch_is_where_the_stroke_is(self):
        # To and fro, until enough of it has been seen.
        w = Window(self, ("play", "--path", "M 0 0" + " L 40 40 L 0 0" * 150, "--duration", "600", "-D", "null"), 80, 24)
        seen = set()

        def look(w):
            rows = [(y, line.index("o")) for y, line in enumerate(w.lines()) if re.match(r"[ ·░▒▓█]*o[ ·░▒▓█]*$", line)]
            at = re.search(r"at ([\d.]+), ([\d.]+) mm", w.text())
            if has_picture(w, "600") and rows and at:
                self.assertEqual(len(rows), 1, w.text())
                self.assertEqual(at[1], at[2])
                seen.add((float(at[1]), *rows[0]))
            return len(seen) > 3 and max(seen)[0] > 38 and min(seen)[0] < 2

        w.until(look)
        places = sorted(seen)
        self.assertEqual([p[1] for p in places], sorted(p[1] for p in places))
        self.assertEqual([p[2] for p in places], sorted(p[2] for p in places))
        self.assertGreater(places[-1][1] - places[0][1], 8)
        self.assertGreater(places[-1][2] - places[0][2], 16)

    def test_the_picture_removes_itself(self):
        for columns, rows in ((80, 24), (200, 60), (79, 11)):
            w = Window(self, SHORT, columns, rows)
            self.assertEqual(w.to_the_end(), 0)
            self.assertIn(b"/ 0.56 s", w.raw)
            self.assertFalse(w.screen.cursor.hidden)
            self.assertFalse(SHADES & set(w.text()), w.text())
            self.assertRegex(w.text(), r"(?m)^--path: played \d")
            self.assertNotIn("/ 0.56 s", w.text())

    def frames(self, w):
        """Returns the pictures, each between "up" and "clear the rest"."""
        return re.findall(r"\r(?:\033\[\d+A)?((?:(?!\033\[\d*A)[^\r])*?)\033\[J", w.raw.decode(errors="ignore").replace("\r\n", "\n"))

    def test_small_terminals_neither_wrap_nor_scroll(self):
        self.write("big.toml", '[array]\nname = "big"\ngrid = { rows = 30, columns = 30, pitch_mm = 10.0 }\n')
        for array, sizes in (("palm-3x3", ((20, 4), (12, 3), (5, 5))), ("big.toml", ((80, 24), (20, 6), (8, 2), (2, 2), (1, 1)))):
            for columns, rows in sizes:
                w = Window(self, (*LONG, "--array", array), columns, rows)
                w.until(lambda w: len(self.frames(w)) > 2)
                w.process.send_signal(signal.SIGINT)
                self.assertEqual(w.to_the_end(), 130)
                frames = self.frames(w)
                for frame in frames:
                    lines = re.sub(r"\033\[[\d;]*[mK]", "", frame).split("\n")
                    self.assertLessEqual(len(lines), rows, (columns, rows, frame))
                    self.assertLess(max(map(len, lines)), max(columns, 2), (columns, rows, frame))
                if columns >= 8 and rows >= 2:
                    self.assertTrue(any(" s" in f for f in frames), (columns, rows))
                self.assertEqual(any(SHADES & set(f) for f in frames), columns >= 12 and rows >= 4, (array, columns, rows))

    def test_the_picture_follows_the_size_of_the_window(self):
        w = Window(self, LONG, 100, 40)
        w.until(has_picture)
        for columns, rows in ((60, 15), (30, 8), (120, 50), (80, 24)):
            w.resize(columns, rows)
            before = len(w.raw)
            # A single picture, its last line above the cursor, once the output for the old size has been read.
            w.until(lambda w, before=before: len(w.raw) > before + 3000 and has_picture(w) and len(re.findall(TIME, w.text())) == 1
                    and re.search(TIME, w.lines()[w.screen.cursor.y - 1]) and w.screen.cursor.x == 0)
        self.process_ends(w, signal.SIGINT, 130)

    def process_ends(self, w, number, status):
        w.process.send_signal(number)
        self.assertEqual(w.to_the_end(), status)
        self.assertFalse(SHADES & set(w.text()), w.text())
        self.assertFalse(w.screen.cursor.hidden)
        self.assertIn("cancelled after", w.text())

    def test_any_end_leaves_a_clean_terminal(self):
        for number, status in ((signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129), (signal.SIGKILL, -signal.SIGKILL)):
            w = Window(self, LONG, 80, 24)
            w.until(has_picture)
            mode = termios.tcgetattr(w.primary)
            if number != signal.SIGKILL:
                self.process_ends(w, number, status)
                continue
            w.process.send_signal(number)
            self.assertEqual(w.to_the_end(), status)
            self.assertFalse(w.screen.cursor.hidden or b"\033[?" in w.raw)  # no mode was set that would need a reset
            self.assertEqual(mode, termios.tcgetattr(w.primary))
        w = Window(self, LONG, 80, 24)
        w.until(has_picture)
        os.close(w.primary)
        w.primary = -1
        w.process.send_signal(signal.SIGHUP)
        self.assertIn(w.process.wait(timeout=PATIENCE_S), (1, 129))

    def test_a_full_terminal_does_not_hold_it_up(self):
        w = Window(self, LONG, 200, 60)
        w.until(has_picture)
        # Without a reader the terminal's buffer fills, and writes block.
        out = os.open(f"/proc/{w.process.pid}/fd/1", os.O_WRONLY | os.O_NONBLOCK | os.O_NOCTTY)
        try:
            while True:
                os.write(out, b"x" * 1000)
        except BlockingIOError:
            pass
        finally:
            os.close(out)
        w.process.send_signal(signal.SIGTERM)
        try:
            # The final report must be written and waits for a reader; the sound has ended before.
            self.assertEqual(w.to_the_end(), 143)
        finally:
            w.process.kill()

    def test_output_is_plain_or_without_colours_where_asked_for(self):
        for env, more, plain, coloured in (({"TERM": "dumb"}, (), True, False), ({"TERM": ""}, (), True, False), ({}, ("--format", "json"), True, False),
                                           ({"NO_COLOR": "1"}, (), False, False), ({"NO_COLOR": ""}, (), False, True), ({}, (), False, True)):
            w = Window(self, (*SHORT, *more), 80, 24, **env)
            self.assertEqual(w.to_the_end(), 0)
            self.assertEqual(b"\033" not in w.raw, plain, env)
            self.assertEqual(re.search(rb"\033\[\d+A", w.raw) is not None, not plain, env)  # it was drawn again
            self.assertEqual(re.search(rb"\033\[[0-9;]*m", w.raw) is not None, coloured, env)
            self.assertLessEqual(set(re.findall(rb"\033\[([0-9;]*)m", w.raw)), COLOURS)

    def test_letters_where_the_locale_has_no_shades(self):
        w = Window(self, LONG, 80, 24, LC_ALL="C")
        w.until(lambda w: re.search(r"\.\.\.", w.text()) and re.search("[:+x#]{2}", w.text()))
        self.assertTrue(w.text().isascii())

    def test_an_error_in_the_middle_leaves_a_clean_terminal(self):
        w = Window(self, ("play", "--path", "M 0 10 L 40 30", "--duration", "3600", "-D", "raw:/dev/full"), 80, 24)
        self.assertEqual(w.to_the_end(), 1)
        self.assertFalse(SHADES & set(w.text()), w.text())
        # On a slow machine the device is lost before the stroke begins: then the error is the whole output.
        said = w.text() + w.process.stderr.read().decode()
        self.assertRegex(said, "interrupted after|not played")


if __name__ == "__main__":
    main()
