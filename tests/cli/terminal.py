# SPDX-License-Identifier: MIT
"""A program on a pseudo-terminal."""
import codecs
import contextlib
import os
import pty
import re
import select
import signal
import tempfile

from harness import PATIENCE_S, TOOL


class Terminal:
    """The tool or another program on a pseudo-terminal; standard error goes to a file, as an experimenter's console would."""

    def __init__(self, test, args, program=TOOL, term="xterm", has_console=True):
        self.console = tempfile.TemporaryFile("w+")
        test.addCleanup(self.console.close)
        self.pid, self.fd = pty.fork()
        if self.pid == 0:
            if has_console:
                os.dup2(self.console.fileno(), 2)
            os.chdir(test.dir)
            os.execvpe(program, [str(program), *map(str, args)], test.env | {"TERM": term})
        test.addCleanup(self.kill)
        self.decoder = codecs.getincrementaldecoder("utf-8")("replace")
        self.all = self.seen = ""

    def read(self):
        if not select.select([self.fd], [], [], PATIENCE_S)[0]:
            raise AssertionError(f"nothing more after {self.seen!r}")
        text = self.decoder.decode(os.read(self.fd, 4096))
        self.all += text
        self.seen += text

    def until(self, pattern):
        while not (found := re.search(pattern, self.seen)):
            self.read()
        self.seen = self.seen[found.end():]
        return found

    def key(self, keys):
        os.write(self.fd, keys.encode())

    def answer(self, pattern, key):
        self.until(pattern)
        self.key(key)

    def poll(self):
        """Returns nothing while it runs, as Popen.poll() does."""
        return os.waitid(os.P_PID, self.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT)

    def end(self):
        """Returns its exit status."""
        with contextlib.suppress(OSError):  # the terminal closes with the program
            while True:
                self.read()
        return self.wait()

    def wait(self):
        os.close(self.fd)
        pid, self.pid = self.pid, None
        return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])

    def kill(self):
        if self.pid is not None:
            os.kill(self.pid, signal.SIGKILL)
            self.wait()

    def said(self):
        self.console.seek(0)
        return self.console.read()
