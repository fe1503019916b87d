# SPDX-License-Identifier: MIT
"""Latency of stop and of drafts, and the server's memory, while many clients send much."""
import json
import math
import os
import resource
import socket
import subprocess
import sys
import threading
import time
import unittest

from harness import PATIENCE_S, main
from serving import LONG, ServeTest

CLIENTS = 60
MIB = 1 << 20
STOP_S = 0.050
DRAFTS = 300
DRAFT_S = 0.030
ABOVE_REST_BYTES = 100 * MIB
STOP = b'{"jsonrpc":"2.0","id":1,"method":"stop"}\n'
ANSWER = b'{"jsonrpc":"2.0","id":1,"result":{}}\n'


def resident(pid):
    with open(f"/proc/{pid}/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


# In a separate process, which does not keep the bystander waiting for Python's lock: clients that send as fast as they can; the
# server may refuse them.
FLOOD = """
import contextlib, socket, sys, threading
address, count, close_at_once = sys.argv[1], int(sys.argv[2]), sys.argv[3] == "True"
data = sys.stdin.buffer.read()
ready = threading.Barrier(count)
def one():
    s = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    with contextlib.suppress(OSError):
        s.connect(address)
    ready.wait()
    with contextlib.suppress(OSError):
        s.sendall(data)
        if not close_at_once:
            s.shutdown(socket.SHUT_WR)
            while s.recv(65536):
                pass
    s.close()
all_ = [threading.Thread(target=one) for _ in range(count)]
for t in all_:
    t.start()
for t in all_:
    t.join()
"""


# The floor: an idle server at the same priority, asked in turn with the other. Its latency is that of the machine.
ECHO = """
import os, socket, sys
os.setpriority(os.PRIO_PROCESS, 0, int(sys.argv[2]))
s = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
s.bind(sys.argv[1])
s.listen()
print(flush=True)
c = s.accept()[0]
while data := c.recv(100):
    c.sendall(data)
"""


def summarise(waits):
    """Returns the longest, the one that 99 % are below, and the median."""
    waits = sorted(waits)
    return waits[-1], waits[len(waits) * 99 // 100], waits[len(waits) // 2]


@unittest.skipIf(resource.getrlimit(resource.RLIMIT_NOFILE)[1] < 1024, "too few descriptors")
class Flood(ServeTest):
    def look(self, s, data, close_at_once=True):
        """Measures how long a bystander waits for stop and for the floor, and the most memory, while CLIENTS send `data`."""
        bystander = s.client()
        floor = self.floor(os.getpriority(os.PRIO_PROCESS, s.process.pid))
        rest = resident(s.process.pid)
        flood = subprocess.Popen([sys.executable, "-c", FLOOD, s.where["socket"], str(CLIENTS), str(close_at_once)],
                                 stdin=subprocess.PIPE)
        threading.Thread(target=flood.communicate, args=(data,)).start()
        waits, least, most = [], [], rest
        while flood.poll() is None or len(waits) < 50:
            waits.append(self.wait(bystander.socket, STOP, ANSWER))
            least.append(self.wait(floor, STOP, STOP))
            most = max(most, resident(s.process.pid))
            time.sleep(0.001)
        self.assertIsNone(s.process.poll())
        mine = bystander.ok("play", **LONG)["stroke"]
        bystander.ok("stop")
        self.assertEqual(bystander.await_end(mine)["state"], "cancelled")
        bystander.close()
        floor.close()
        time.sleep(1.0)
        memory = ((most - rest) / MIB, (resident(s.process.pid) - rest) / MIB)
        for name, figures in (("stop", summarise(waits)), ("floor", summarise(least))):
            print("{:5} longest {:.4f} s, 99 % {:.4f} s, median {:.4f} s".format(name, *figures))
        print("above rest {:.1f} MiB, afterwards {:.1f} MiB".format(*memory))
        return summarise(waits), summarise(least), memory

    def wait(self, client, question, answer):
        """Measures a stop, in seconds. Does nothing else meanwhile: this process might have to wait for a processor."""
        got = b""
        began = time.monotonic()
        client.sendall(question)
        while not got.endswith(b"\n"):
            got += client.recv(1000)
        waited = time.monotonic() - began
        self.assertEqual(got, answer)
        return waited

    def floor(self, priority):
        path = self.dir / f"floor-{time.monotonic_ns()}.sock"
        echo = self.start_tool("-c", ECHO, path, priority, program=sys.executable, stdout=subprocess.PIPE)
        echo.stdout.readline()
        client = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.addCleanup(client.close)
        client.settimeout(PATIENCE_S)
        client.connect(str(path))
        return client

    def hold(self, s, data, **more):
        """Tests of which a round in three may meet a scheduler that leaves the service without a processor."""
        beyond = []
        for _ in range(3):
            stop, floor, memory = self.look(s, data, **more)
            beyond.append(max(stop[0] - floor[0], stop[1] - floor[1]))
            self.assertLess(memory[1] * MIB, ABOVE_REST_BYTES)
        self.assertLess(sorted(beyond)[1], STOP_S)

    def test_endless_messages_do_not_delay_stop(self):
        for name, data in (("text", b"x" * MIB), ("an open quote", b'"' + b"x" * (MIB - 1)),
                           ("a path", b'{"jsonrpc":"2.0","id":1,"method":"play","params":{"path":"M 0 0' + b" L 9 9" * 170_000)):
            with self.subTest(name):
                self.hold(self.serve("--socket", self.dir / f"{name[:3].strip()}.sock"), data[:MIB])

    def test_whole_messages_do_not_delay_stop(self):
        points = json.dumps({"jsonrpc": "2.0", "id": 1, "method": "play",
                             "params": {"points": [[i / 1000, 20, 20] for i in range(40_000)]}}).encode() + b"\n"
        self.hold(self.serve(), points, close_at_once=False)
        small = json.dumps({"jsonrpc": "2.0", "id": 1, "method": "status"}).encode() + b"\n"
        self.hold(self.serve("--socket", self.dir / "small.sock"), small * 2000, close_at_once=False)

    def test_whole_messages_that_nest_deep_do_not_delay_stop(self):
        self.hold(self.serve(), b"[" * (MIB // 2) + b"]" * (MIB // 2 - 1) + b"\n", close_at_once=False)

    def test_long_paths_do_not_delay_stop(self):
        path = "M 0 0" + "".join(f" L {i % 40} {i * 7 % 40}" for i in range(110_000))
        text = json.dumps({"jsonrpc": "2.0", "id": 1, "method": "plan", "params": {
            "path": path[:950_000].rpartition(" L ")[0], "options": {"duration": 1}, "view": "bursts"}})
        self.hold(self.serve(), text.encode() + b"\n", close_at_once=False)


# In a separate process: twenty clients that go on until it is killed. They draw live, plan drafts of their own, play, and ask for
# what is much to plan.
OTHERS = """
import itertools, json, math, socket, sys, threading, time
def line(algorithm, duration):
    return {"path": "M 0 0 L 40 40", "options": {"algorithm": algorithm, "duration": duration, "level_dbfs": -60}}
class Client:
    def __init__(self):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.socket.connect(sys.argv[1])
        self.lines = self.socket.makefile("rb")
    def send(self, method, params, **more):
        self.socket.sendall(json.dumps({"jsonrpc": "2.0", "method": method, "params": params, **more}).encode() + b"\\n")
    def call(self, method, params):
        self.send(method, params, id=1)
        while b'"id":1' not in (got := self.lines.readline())[:30]:
            assert got
        return got
def live(c):
    n = json.loads(c.call("begin", {"timeout_s": 60, "options": {"level_dbfs": -60}}))["result"]["stroke"]
    for i in itertools.count():
        c.send("to", {"stroke": n, "x_mm": 20 + 18 * math.cos(i / 20), "y_mm": 20 + 18 * math.sin(i / 20)})
        time.sleep(1 / 60)
def draft(c):
    for i in itertools.count():
        c.call("plan", {**line("park2016", 2), "view": "percept", "draft": i})
        time.sleep(1 / 30)
def play(c):
    while True:
        c.call("plan", line("continuous", 4))
        c.call("play", line("continuous", 0.2))
        time.sleep(0.2)
def much(c):
    while True:
        c.call("plan", line("continuous", 10))
        c.call("plan", {**line("continuous", 600), "view": "peaks"})
for what, count in ((live, 8), (draft, 4), (play, 4), (much, 4)):
    for _ in range(count):
        threading.Thread(target=what, args=(Client(),)).start()
print(flush=True)
"""


class Planning(ServeTest):
    def test_drafts_are_answered_while_somebody_draws(self):
        """A page asks 30 times a second for the percept of the stroke so far, 2 s long, beside twenty others."""
        s = self.serve()
        others = self.start_tool("-c", OTHERS, s.where["socket"], program=sys.executable, stdout=subprocess.PIPE)
        others.stdout.readline()
        c = s.client()
        points = [[i / 60, 20 + 18 * math.cos(i / 20), 20 + 18 * math.sin(i / 30)] for i in range(121)]
        for algorithm in ("park2016", "tactile-brush", "continuous"):
            asked = {"points": points, "view": "percept", "options": {"algorithm": algorithm, "drop_points": True, "snap": True}}
            waits, began = [], time.monotonic()
            for i in range(DRAFTS):
                time.sleep(max(0.0, began + i / 30 - time.monotonic()))
                message = json.dumps({"jsonrpc": "2.0", "id": i, "method": "plan", "params": {**asked, "draft": i}}).encode() + b"\n"
                waits.append(self.answered(c.socket, message))
            longest, most, median = summarise(waits)
            print(f"draft, {algorithm}: longest {longest:.4f} s, 99 % {most:.4f} s, median {median:.4f} s")
            self.assertLess(most, DRAFT_S)
        self.assertIsNone(others.poll())
        stream = c.ok("status")["stream"]
        self.assertEqual((stream["state"], stream["xruns"]), ("running", 0))

    def answered(self, client, question):
        """Measures an answer, in seconds; checks it afterwards, and without its schema, which takes longer than all the rest."""
        got = b""
        began = time.monotonic()
        client.sendall(question)
        while not got.endswith(b"\n"):
            got += client.recv(1 << 20)
        waited = time.monotonic() - began
        self.assertIn(b'"result"', got[:100])
        return waited


if __name__ == "__main__":
    main()
