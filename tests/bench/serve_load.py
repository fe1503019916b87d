#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""`tactor serve` under load, on ALSA's null device: 100 clients, 1,000 live points a second and 10,000 strokes a minute together.

Usage: serve_load.py TOOL [SECONDS]      e.g. tests/bench/serve_load.py build/src/cli/tactor
SECONDS (60) twice, and again where the second part added much memory: what each part adds is what leaks. What is exact decides: each request has one reply, each
stroke one end, nothing is refused, nothing is left over, no memory is. The time from a live stroke's first `to` to the period that
has it, by when the server says that its first sample is at the DAC, is held in a whole minute only: in a shorter one chance has the
word. Xruns depend on the machine and are printed.
"""
import asyncio
import collections
import itertools
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

CLIENTS = 100
PLAYS_PER_S = 145
LIVE_AT_ONCE = 12  # of the 16 that sound at once
POINTS = 42  # of a live stroke, which makes a thousand a second of all
POINT_S = 0.012
MOST_MEMORY_KIB = 4096  # that a second part may add: the allocator's reserve differs from run to run
MOST_PARTS = 12  # a leak adds to each; where the machine stood still, messages waited once
PATIENCE_S = 120
MOST_PERIODS = 2  # in which 99 of 100 first points are
ENDS = ("finished", "cancelled", "interrupted")
STROKE = {"path": "M 0 0 L 40 40", "options": {"algorithm": "continuous", "duration": 0.1, "level_dbfs": -40}}


class Client:
    """A connection: its requests, and its messages."""

    def __init__(self):
        self.asked = 0
        self.points = 0
        self.waiting = {}
        self.refused = []
        self.numbers = set()
        self.ends = collections.Counter()
        self.states = collections.Counter()
        self.first_to = {}  # by stroke: time of its first point
        self.delays = []  # from there to its first sample at the DAC, s

    async def connect(self, path):
        self.reader, self.writer = await asyncio.open_unix_connection(path, limit=1 << 22)
        self.task = asyncio.create_task(self.listen())

    async def listen(self):
        while line := await self.reader.readline():
            m = json.loads(line)
            if "id" in m:
                self.replied(m)
            elif m["method"] == "stroke":
                self.told(m["params"])

    def replied(self, m):
        answer = self.waiting.pop(m["id"])  # a second reply, or one to nobody, is a KeyError: fatal
        if "error" in m:
            self.refused.append(m["error"])
        elif "stroke" in m["result"]:
            assert m["result"]["stroke"] not in self.numbers, m
            self.numbers.add(m["result"]["stroke"])
        if answer is not None:
            answer.set_result(m.get("result", {}))

    def told(self, p):
        if p["state"] in ENDS:
            self.ends[p["stroke"]] += 1
            self.states[p["state"]] += 1
        elif p["stroke"] in self.first_to:
            self.delays.append(p["started_s"] - self.first_to.pop(p["stroke"]))

    def send(self, method, answer=None, **params):
        self.asked += 1
        self.waiting[self.asked] = answer
        self.writer.write(json.dumps({"jsonrpc": "2.0", "id": self.asked, "method": method, "params": params}).encode() + b"\n")

    async def call(self, method, **params):
        answer = asyncio.get_running_loop().create_future()
        self.send(method, answer, **params)
        return await asyncio.wait_for(answer, PATIENCE_S)

    def settled(self):
        return not self.waiting and set(self.ends) == self.numbers


async def at(moment):
    await asyncio.sleep(max(0.0, moment - time.monotonic()))


async def play(clients, begin, count):
    for i in range(count):
        await at(begin + i / PLAYS_PER_S)
        next(clients).send("play", **STROKE)


async def draw(clients, begin, strokes):
    """Draws one live stroke after the other, each of another client."""
    for i in range(strokes):
        c = next(clients)
        start = begin + i * POINTS * POINT_S
        await at(start)
        number = (await c.call("begin", timeout_s=PATIENCE_S, options={"level_dbfs": -40}))["stroke"]
        for k in range(POINTS):
            await at(start + k * POINT_S)
            if k == 0:
                c.first_to[number] = time.monotonic()
            c.points += 1
            c.send("to", stroke=number, x_mm=k % 41, y_mm=(7 * k) % 41)
        c.send("end", stroke=number)


async def part(clients, seconds):
    """Runs the load for so long, until all of it is settled. Returns the number of strokes."""
    begin = time.monotonic() + 0.1
    turns = itertools.cycle(clients)
    live = max(1, round(seconds / (POINTS * POINT_S)))
    plays = round(seconds * PLAYS_PER_S)
    # Live strokes begin one after the other, not twelve at a time.
    between_s = POINTS * POINT_S / LIVE_AT_ONCE
    await asyncio.gather(play(turns, begin, plays), *(draw(turns, begin + w * between_s, live) for w in range(LIVE_AT_ONCE)))
    last = time.monotonic() + PATIENCE_S
    while not all(c.settled() for c in clients) and time.monotonic() < last:
        await asyncio.sleep(0.05)
    return plays + LIVE_AT_ONCE * live


def memory_kib(process):
    text = pathlib.Path(f"/proc/{process.pid}/status").read_text(encoding="ascii")
    return next(int(line.split()[1]) for line in text.splitlines() if line.startswith("VmRSS:"))


def processor_s(process):
    fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Checks:
    def __init__(self):
        self.passed = self.failed = self.skipped = 0

    def check(self, what, fine, found=""):
        self.passed += bool(fine)
        self.failed += not fine
        if not fine:
            print(f"FAILED: {what}: {found}")


def tell_delays(delays, stream, checks):
    # A period is written when there is space for it: the rest of the buffer is before it.
    period_s = stream["period_frames"] / stream["rate"]
    periods = sorted((d - stream["latency_s"] + period_s) / period_s for d in delays)
    if not periods:
        return
    p99 = periods[int(0.99 * len(periods))]
    print(f"from a first `to` to the period that has it, in periods of {1000 * period_s:.3g} ms, of {len(periods)}:"
          f" median {periods[len(periods) // 2]:.2f}, p99 {p99:.2f}, most {periods[-1]:.2f}")
    if checks is not None:
        checks.check("of 100 first points 99 are in the second period at the latest", p99 <= MOST_PERIODS, p99)


async def load(process, path, seconds, checks):
    clients = [Client() for _ in range(CLIENTS)]
    watcher = Client()
    for c in [*clients, watcher]:
        await c.connect(path)
        await c.call("hello")  # a client silent for seconds is disconnected
    stream = (await watcher.call("hello"))["stream"]
    memory, used = [], processor_s(process)
    wanted = 0
    while len(memory) < 2 or (len(memory) < MOST_PARTS and memory[-1] - memory[-2] > MOST_MEMORY_KIB):
        wanted += await part(clients, seconds)
        memory.append(memory_kib(process))
    used = processor_s(process) - used
    states = sum((c.states for c in clients), collections.Counter())
    numbers = [n for c in clients for n in c.numbers]
    asked = sum(c.asked for c in clients)
    print(f"{CLIENTS} clients, {len(memory)} times {seconds:g} s: {len(numbers)} strokes ({dict(states)}), {asked} requests,"
          f" {sum(c.points for c in clients)} live points among them")
    checks.check("each request has its reply", not any(c.waiting for c in clients), [len(c.waiting) for c in clients])
    checks.check("nothing is refused", not any(c.refused for c in clients), [c.refused[0] for c in clients if c.refused][:3])
    checks.check("each stroke has its own number", len(numbers) == len(set(numbers)) == wanted, (len(numbers), wanted))
    checks.check("each stroke has one end", all(set(c.ends.values()) <= {1} and c.settled() for c in clients))
    status = await watcher.call("status")
    checks.check("nothing is left over", status["strokes"] == [] and status["clients"] == CLIENTS + 1, status)
    if os.environ.get("TACTOR_SANITIZE", "none") == "none":
        checks.check("the last part adds no memory", memory[-1] - memory[-2] <= MOST_MEMORY_KIB, memory)
    else:
        checks.skipped += 1
        print("SKIPPED: load: what memory it takes is the sanitizer's")
    print(f"memory {memory[0]} KiB, after the last part {memory[-1] - memory[-2]:+} KiB; processor {100 * used / (len(memory) * seconds):.0f} %;"
          f" xruns {status['stream']['xruns']}{'' if status['stream']['realtime'] else ' (without real-time priority)'}")
    tell_delays([d for c in clients for d in c.delays], stream, checks if seconds >= 60 else None)
    for c in [*clients, watcher]:
        c.writer.close()
        await c.task


def main():
    tool = sys.argv[1]
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 60.0
    checks = Checks()
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "s.sock")
        config = pathlib.Path(folder, "serve.toml")
        config.write_text(f"[serve]\nmax_clients = {2 * CLIENTS}\n", encoding="ascii")
        with subprocess.Popen([tool, "serve", "--socket", path, "-D", "null", "--config", config, "--format", "json"],
                              stdout=subprocess.PIPE) as process:
            try:
                process.stdout.readline()
                asyncio.run(load(process, path, seconds, checks))
            finally:
                process.terminate()
                checks.check("it ends in order", process.wait(PATIENCE_S) == 0, process.returncode)
    print(f"{checks.passed} passed, {checks.failed} failed, {checks.skipped} skipped")
    return checks.failed != 0


if __name__ == "__main__":
    sys.exit(main())
