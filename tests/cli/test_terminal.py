# SPDX-License-Identifier: MIT
"""Text on terminals of several widths: lines break at words, and nothing is lost."""
import fcntl
import os
import pty
import struct
import subprocess
import termios

from harness import PATIENCE_S, ROOT, TOOL, ToolTest, main

NINE = ("--path", "M 5 5 L 35 30", "--phantom", "gaussian")
# A machine without the packages, whose list of packages is old.
APT_GET = """#!/bin/sh
echo "$*" >>log
case " $* " in
*" --assume-no "*) echo "0 upgraded, 163 newly installed, 0 to remove and 0 not upgraded."
    echo "Need to get 113 MB/120 MB of archives."; echo "After this operation, 547 MB of additional disk space will be used."; exit 1 ;;
*" install "*) echo "Get:1 fetching"; echo "Unpacking it"; grep -q update log ;;
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
            for columns in (40, 132):
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

    def make_machine(self, apt_get, **others):
        fakes = {"dpkg_query": "#!/bin/sh\n", "dpkg": "#!/bin/sh\n", "sudo": '#!/bin/sh\nexec "$@"\n'} | others
        for name, text in (fakes | {"apt_get": apt_get}).items():
            self.write(f"bin/{name.replace('_', '-')}", text).chmod(0o755)
        self.env |= {"PATH": f"{self.dir}/bin:{os.environ['PATH']}"}

    def install(self, apt_get, **others):
        """Returns the exit status and the output of installing packages on a machine with that apt-get and other programs."""
        self.make_machine(apt_get, **others)
        return self.on_terminal(80, "library", program=ROOT / "tests/install-packages")

    def test_packages_show_their_price_and_progress(self):
        status, text = self.install(APT_GET)
        self.assertEqual(status, 0, text)
        first, _, second = text.partition("trying again")
        self.assertIn("\n163 packages, 113 MB to load, 547 MB of disk\n", first)
        for part in (first, second):
            self.assertIn("Unpacking it", part)
        calls = (self.dir / "log").read_text(encoding="utf-8").splitlines()
        self.assertEqual(["update" if "update" in c else "install" for c in calls if "assume-no" not in c], ["install", "update", "install"])

    def test_no_network_is_one_line(self):
        status, text = self.install(APT_GET.replace("esac", """*) echo "Err:1 http://h/debian bookworm InRelease"
            echo "E: Failed to fetch http://h/debian/InRelease  Temporary failure resolving 'h'" >&2; exit 100 ;;\nesac"""))
        self.assertEqual(status, 1, text)
        self.assertEqual(text.splitlines()[-1].split("\x1b[K")[-1],
                         "apt-get: the list of packages cannot be fetched: Temporary failure resolving 'h' (http://h/debian/InRelease)")

    def test_missing_rights_are_named_once(self):
        status, text = self.install(APT_GET, id="#!/bin/sh\necho 1000\n", sudo="#!/bin/sh\necho asked >>log\nexit 1\n")
        self.assertEqual(status, 1, text)
        self.assertRegex(text.splitlines()[-1], "^install-packages: as root, run: apt-get install --no-install-recommends dpkg-dev g")
        self.assertEqual((self.dir / "log").read_text(encoding="utf-8").count("asked"), 1)

    def test_another_apt_is_named_and_waited_for(self):
        status, text = self.install(APT_GET.replace("esac", f"""*) grep -q tried log || {{ echo tried >>log
            echo "E: Could not get lock /var/lib/apt/lists/lock. It is held by process {os.getpid()} (x)" >&2; exit 100; }} ;;\nesac"""))
        self.assertEqual(status, 0, text)
        self.assertIn(f"waiting: process {os.getpid()} (python3) is installing", text)

    def test_an_interrupted_install_says_that_apt_goes_on(self):
        os.mkfifo(self.dir / "end")
        self.make_machine(APT_GET.replace("echo \"Unpacking it\"", "trap 'echo Setting it up' INT; echo \"Unpacking it\"; until read -r _ <end; do :; done"))
        child, terminal = pty.fork()
        if child == 0:
            os.chdir(self.dir)
            os.execve(ROOT / "tests/install-packages", ["install-packages", "library"], os.environ | self.env)
        self.addCleanup(os.close, terminal)
        text = b""
        for word, then in ((b"Unpacking it", lambda: os.write(terminal, b"\x03")),
                           (b"interrupted: apt ends what it has begun", lambda: (self.dir / "end").write_text("go\n", encoding="utf-8"))):
            while word not in text:
                text += os.read(terminal, 4096)
            then()
        self.assertNotEqual(os.waitpid(child, 0)[1], 0)
        self.assertNotIn(b"trying again", text)


if __name__ == "__main__":
    main()
