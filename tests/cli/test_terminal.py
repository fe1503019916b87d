# SPDX-License-Identifier: MIT
"""Text on terminals of several widths: lines break at words, and nothing is lost."""
import fcntl
import os
import struct
import subprocess
import termios

from harness import PATIENCE_S, ROOT, TOOL, ToolTest, main

NINE = ("--path", "M 5 5 L 35 30", "--phantom", "gaussian")
# A machine without the packages: the list is old, and the first download fails.
APT_GET = """#!/bin/sh
echo "$*" >>log
case " $* " in
*" --simulate "*) grep -q update log ;;
*" install "*) echo "Get:1 fetching"; echo "Unpacking it"; grep -q "retried" log || { echo "retried" >>log; exit 1; } ;;
esac
"""


class Terminal(ToolTest):
    def setUp(self):
        super().setUp()
        self.env |= {"TERM": "dumb", "LC_ALL": "C.UTF-8"}

    def on_terminal(self, columns, *args, program=TOOL):
        """Returns the exit status, and the output of a program on a terminal of that width."""
        ours, theirs = os.openpty()
        self.addCleanup(os.close, ours)
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        process = subprocess.Popen([program, *args], cwd=self.dir, env=self.env, stdin=subprocess.DEVNULL, stdout=theirs, stderr=theirs)
        os.close(theirs)
        data = b""
        try:
            while part := os.read(ours, 65536):
                data += part
        except OSError:  # closed
            pass
        return process.wait(timeout=PATIENCE_S), data.decode().replace("\r\n", "\n")

    def on_terminal_as_piped(self, columns, *args):
        """Returns what is printed to a terminal, which has the words of a pipe. check also lists servers of other tests, which
        come and go: it is asked again until it says the same before and after."""
        for _ in range(100):
            before = self.run_tool(*args)
            status, text = self.on_terminal(columns, *args)
            after = self.run_tool(*args)
            if before.stdout == after.stdout and text.split() == (before.stdout + before.stderr).split():
                break
        self.assertEqual(status, before.returncode)
        self.assertEqual(text.split(), (before.stdout + before.stderr).split(), args)
        return text

    def test_lines_break_at_words(self):
        for args in (("help",), ("help", "play"), ("plan", *NINE), ("plan", "wave-2x4"), ("plan", "park2016-1", "--burst", "0.003"),
                     ("check", "-D", "null"), ("devices",), ("play", "park2016-1", "-D", "nowhere"),
                     ("compare", "park2016-1", "--observer", "low-speed")):
            for columns in (40, 64, 132, 200):
                text = self.on_terminal_as_piped(columns, *args)
                if args[0] == "compare":
                    text = text.rpartition("\n\n")[2]  # without its table
                for line in text.splitlines():
                    self.assertTrue(len(line) < columns or " " not in line.strip(), f"{args} {columns}: {line}")

    def test_a_narrow_terminal_has_the_text_of_an_option_below_it(self):
        for args in (("play", "--help"), ("help", "soa")):
            text = self.on_terminal(40, *args)[1]
            self.assertRegex(text, r"(?m)^  (--path DATA|Range:)\n    \S")
            self.assertNotRegex(text, r"(?m)^ {20}")

    def test_widths_are_bounded(self):
        for columns, least, most in ((10, 25, 39), (300, 85, 199), (0, 60, 79)):
            longest = max(map(len, self.on_terminal(columns, "check", "-D", "null")[1].splitlines()))
            self.assertTrue(least <= longest <= most, longest)

    def test_nothing_wraps_where_a_program_reads(self):
        self.assertEqual(self.refused(2, "plan", "wave-2x4").stderr.count("\n"), 1)

    def test_packages_show_their_progress(self):
        for name, text in (("apt-get", APT_GET), ("dpkg-query", "#!/bin/sh\n"), ("dpkg", "#!/bin/sh\n"),
                           ("sudo", '#!/bin/sh\nexec "$@"\n')):
            self.write(f"bin/{name}", text).chmod(0o755)
        self.env |= {"PATH": f"{self.dir}/bin:{os.environ['PATH']}", "TACTOR_BRIEF": "yes"}
        status, text = self.on_terminal(80, "library", program=ROOT / "tests/install-packages")
        self.assertEqual(status, 0, text)
        first, _, second = text.partition("trying again")
        for part in (first, second):
            self.assertIn("Unpacking it", part)
        calls = (self.dir / "log").read_text(encoding="utf-8").splitlines()
        self.assertEqual([("install" in c, "update" in c) for c in calls if "configure" not in c and c != "retried"],
                         [(True, False), (False, True), (True, False), (False, True), (True, False)])


if __name__ == "__main__":
    main()
