# SPDX-License-Identifier: MIT
"""A session of tactor experiment with the participant's page."""
import json
import os
import re
import select
import subprocess

from experiments import PersonTest
from harness import PATIENCE_S
from websocket import TEXT, Peer


class Session:
    """The tool with --display page; text written to `keys` is typed by the experimenter."""

    def __init__(self, test, args):
        self.test = test
        pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
        self.process = test.start_tool(*args, **pipes, text=True, bufsize=0)
        self.said = ""
        self.address = self.told(r"page is at http://([^/]+)/\n")[1]

    def told(self, pattern):
        """Waits until standard error has this."""
        while not (found := re.search(pattern, self.said)):
            if not select.select([self.process.stderr], [], [], PATIENCE_S)[0]:
                raise AssertionError(self.said)
            # Does not read by the stream, which would hide the lines after this one from select().
            more = os.read(self.process.stderr.fileno(), 4096)
            assert more, self.said
            self.said += more.decode()
        return found

    def key(self, key):
        self.process.stdin.write(key + "\n")

    def end(self):
        """Returns its exit status."""
        self.shown, more = self.process.communicate(timeout=PATIENCE_S)
        self.said += more
        return self.process.returncode

    def participant(self):
        return Participant(self)


class Participant(Peer):
    """A page, as the wire shows it."""

    def __init__(self, session):
        super().__init__(session.address)
        session.test.addCleanup(self.socket.close)
        self.seen = []
        assert self.upgrade(Origin=f"http://{session.address}") == 101
        self.say(hello=True)
        self.facts = self.next()

    def say(self, **message):
        self.frame(TEXT, json.dumps(message).encode())

    def next(self):
        self.seen.append(json.loads(self.text()))
        return self.seen[-1]

    def until(self, screen, asked=True):
        while (s := self.next())["screen"] != screen or bool(s["ask"]) != asked:
            pass
        return s

    def answer(self, screen, choice):
        s = self.until(screen)
        self.say(ask=s["ask"], answer=choice)
        return s

    def begin(self, agrees=True):
        """Answers up to the first run's first trial."""
        if agrees:
            self.answer("consent", 1)
        self.walk()
        self.answer("introduce", 1)

    def walk(self):
        for _ in (0, 1):
            self.answer("walk", 1)


class PageTest(PersonTest):
    def start(self, *more, **which):
        return Session(self, self.args("--display", "page", *more, **which))

    def start_both(self, *more, **which):
        """Starts a session and its participant's page, on the wire."""
        s = self.start(*more, **which)
        return s, s.participant()
