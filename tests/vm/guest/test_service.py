# SPDX-License-Identifier: MIT
"""tactor serve on a card that goes away, and at each possible end: messages to clients, and the amplifier's state."""
import json
import os
import signal
import socket

from rig import AmplifierTest, Card, wait_for

ENDS = ("finished", "cancelled", "interrupted")
LONG = {"path": "M 0 0 L 40 40", "options": {"duration": 60, "algorithm": "continuous"}}


class Client:
    """A connection; keeps its messages."""

    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.settimeout(60)
        self.socket.connect(str(path))
        self.lines = self.socket.makefile("r", encoding="utf-8")
        self.told = []
        self.last = 0

    def call(self, method, **params):
        self.last += 1
        self.socket.sendall(json.dumps({"jsonrpc": "2.0", "id": self.last, "method": method, "params": params}).encode() + b"\n")
        while True:
            m = json.loads(self.lines.readline())
            if m.get("id") == self.last:
                return m["result"]
            self.told.append(m)

    def hear(self, method, **params):
        """Waits for such a notification; true when it came, false when the connection ended before."""
        while True:
            for m in self.told:
                if m["method"] == method and params.items() <= m["params"].items():
                    return True
            line = self.lines.readline()
            if not line:
                return False
            self.told.append(json.loads(line))

    def await_end(self, number):
        """Returns the end of a stroke."""
        while True:
            for m in self.told:
                if m["method"] == "stroke" and m["params"]["stroke"] == number and m["params"]["state"] in ENDS:
                    return m["params"]["state"]
            self.told.append(json.loads(self.lines.readline()))

    def close(self):
        self.lines.close()
        self.socket.close()


class Service(AmplifierTest):
    def setUp(self):
        super().setUp()
        self.path = self.dir / "tactor.sock"
        self.addCleanup(Card.plug_in)

    def serve(self):
        p = self.start("serve", "--socket", self.path, "--array", self.array, "--format", "json")
        self.assertIn("listening", p.stdout.readline())
        return p

    def client(self):
        c = Client(self.path)
        self.addCleanup(c.close)
        return c

    def sounding(self, c):
        c.call("subscribe", events=["stream"])
        number = c.call("play", **LONG)["stroke"]
        self.assertTrue(c.hear("stroke", stroke=number, state="started"))
        self.assertTrue(self.on())
        return number

    def test_a_card_that_goes_and_comes_back(self):
        p = self.serve()
        c = self.client()
        number = self.sounding(c)
        pull = Card.pull_out()
        self.assertTrue(c.hear("stroke", stroke=number, state="interrupted"))
        wait_for(lambda: not self.on(), "the amplifier is off", 5)
        self.assertTrue(c.hear("stream", state="lost"))
        pull.wait(20)
        c.told.clear()
        Card.plug_in()
        self.assertTrue(c.hear("stream", state="running"))
        self.sounding(c)
        p.send_signal(signal.SIGTERM)
        self.assertEqual(p.wait(30), 0)
        self.assertFalse(self.on())

    def test_killed_and_started_again(self):
        p = self.serve()
        c = self.client()
        self.sounding(c)
        p.kill()
        self.off_within("SIGKILL of the service", self.LIMIT_S + 0.2)
        p.wait(20)
        self.assertFalse(c.hear("stroke", state="finished"))
        again = self.serve()  # the socket of the one before is no obstacle
        self.sounding(self.client())
        again.send_signal(signal.SIGTERM)
        self.assertEqual(again.wait(30), 0)

    def test_stopped_and_going_on(self):
        p = self.serve()
        c = self.client()
        number = self.sounding(c)
        os.kill(p.pid, signal.SIGSTOP)
        self.off_within("SIGSTOP of the service", self.LIMIT_S + 0.2)
        os.kill(p.pid, signal.SIGCONT)
        # Its sound since then is unknown: it is reported as interrupted, and the next one plays.
        self.assertEqual(c.await_end(number), "interrupted")
        self.sounding(c)
        p.send_signal(signal.SIGTERM)
        self.assertEqual(p.wait(30), 0)
        self.assertFalse(self.on())

    def test_a_client_that_goes_in_mid_stroke_leaves_it_to_its_end(self):
        p = self.serve()
        first, second = self.client(), self.client()
        number = first.call("play", path="M 0 0 L 40 40", options={"duration": 2})["stroke"]
        second.call("subscribe", events=["strokes"])
        first.close()
        self.assertTrue(second.hear("stroke", stroke=number, state="finished"))
        p.send_signal(signal.SIGTERM)
        self.assertEqual(p.wait(30), 0)
