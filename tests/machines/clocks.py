# SPDX-License-Identifier: MIT
"""Two virtual machines with a card, a clock and an amplifier each play the halves of one array.

Usage: clocks.py SOURCE_ROOT BUILD_FOLDER ROLE     runs in each machine; tests/machines/clocks starts both. The one called left runs the
trial. Each card counts by its machine's CLOCK_MONOTONIC (snd-dummy with hrtimer), so the time of a frame is known to the sample. The
emulated processors of both count the host's time stamp counter, so one constant, from datagrams there and back, compares their clocks.
Ends with a line that counts.
"""
import bisect
import contextlib
import io
import os
import re
import socket
import statistics
import struct
import subprocess
import sys
import time

from namespaces import wait_for
from node import ADDRESSES, ECHO, OSC, RATE, ROOT, RPC, RUN, STROKE, Node, Peer, serve_agent, two_machines

UNIX_IN_NTP_S = 2208988800
LONG = "M 0 30" + " H 80 H 0" * 5
CONTROL = ("cmdport 0", "bindcmdaddress /", "pidfile /run/tmp/chrony.pid")
CHRONY = (("chronyd", "-d", "-u", "root", *CONTROL, "local stratum 8", "allow 10.25.0.0/24"),
          ("chronyd", "-d", "-u", "root", *CONTROL, f"server {ADDRESSES['left']} minpoll 0 maxpoll 0", "makestep 0.01 3"))
PTP = tuple(("ptp4l", "-S", "-i", "eth0", "-m", "--step_threshold=0.01",
             "--logSyncInterval=-2", *more) for more in (("--priority1=10",), ("-s",)))


def padded(text):
    """Returns a string of OSC."""
    return (text.encode() + b"\0").ljust((len(text) + 4) // 4 * 4, b"\0")


class Line:
    """Reads a column of samples as a function of another one, by straight lines."""

    def __init__(self, samples, x, y):
        self.x, self.y = [s[x] for s in samples], [s[y] for s in samples]

    def __call__(self, at):
        i = min(max(bisect.bisect(self.x, at), 1), len(self.x) - 1)
        (x0, x1), (y0, y1) = self.x[i - 1:i + 1], self.y[i - 1:i + 1]
        return y0 + (at - x0) * (y1 - y0) / (x1 - x0)


class Trial:
    def __init__(self, left, right):
        self.left, self.right, self.passed, self.failed = left, right, 0, 0
        self.printed = ""
        self.limit_s = 0.02  # the emulated network is too slow for the example to know more

    def check(self, what, right):
        self.passed, self.failed = self.passed + bool(right), self.failed + (not right)
        print(("" if right else "FAILED: ") + what, flush=True)

    def measure_counters(self):
        """Sets the lead of right's counter over left's, and half of the shortest time there and back, in s."""
        first = self.left.now()
        found = []
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as s:
            s.settimeout(1)
            s.connect((ADDRESSES["right"], ECHO))
            for number in range(3000):
                before = self.left.counter.read()
                s.send(number.to_bytes(4, "little"))
                with contextlib.suppress(TimeoutError):
                    answer = s.recv(64)
                    after = self.left.counter.read()
                    if int.from_bytes(answer[:4], "little") == number:
                        found.append((after - before, int.from_bytes(answer[4:], "little") - (before + after) // 2))
        last = self.left.now()
        self.ticks_s = (last[0] - first[0]) / (last[1] - first[1])
        least, self.lead = min(found)
        self.known_s = least / 2 / self.ticks_s
        near = [lead for trip, lead in found if trip < 1.2 * least]
        print(f"datagrams there and back take {1e6 * least / self.ticks_s:.0f} us at least; {len(near)} nearly so, whose leads differ by "
              f"{1e6 * (max(near) - min(near)) / self.ticks_s:.0f} us")

    def apart(self):
        """Returns how much right's clock is ahead of left's now, in s."""
        left, right = self.left.now(), self.right.now()
        return right[2] - left[2] - (right[0] - self.lead - left[0]) / self.ticks_s

    def draw(self, osc):
        """Draws by the example, or by its machines and OSC; returns when both were asked to begin, in s."""
        ends, after_s = [f"{a}:{RPC}" for a in ADDRESSES.values()], 0.5
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            if not osc:
                start = two_machines.draw(*ends, STROKE, f"{RUN}/token", self.limit_s, after_s)
                self.printed += out.getvalue()
                return start
            one = two_machines.Machine(ends[0], {"token": (RUN / "token").read_text(encoding="ascii").strip()})
        start = one.lead_s + time.monotonic() + after_s
        message = padded("/tactor/play") + padded(",is") + bytes((0, 0, 0, 1)) + padded(STROKE)
        bundle = padded("#bundle") + struct.pack(">Qi", round((start + UNIX_IN_NTP_S) * 2**32), len(message)) + message
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as s:
            s.settimeout(60)
            for address in ADDRESSES.values():
                s.sendto(bundle, (address, OSC))
            ended = 0
            while ended < 2:
                answer = s.recv(1000).rstrip(b"\0")
                ended += answer.endswith((b"finished", b"cancelled", b"interrupted"))
                if answer.startswith(b"/tactor/error"):
                    raise ValueError(answer)
        return start

    def strokes(self, what, osc, count=15):
        """Draws some strokes after a first one, before which the streams do not run; prints how far apart both machines began."""
        for _ in range(3):
            self.printed = ""
            wait_for(lambda: not any(n.trigger() for n in (self.left, self.right)), "no stream")
            try:
                asked = [self.draw(osc)]
                triggers = [n.trigger() for n in (self.left, self.right)]
                asked += [self.draw(osc) for _ in range(count)]
            except SystemExit as e:
                print(f"again: the example ends with {e}")
                continue
            same = triggers == [n.trigger() for n in (self.left, self.right)]  # later they have ended
            played = [n.played() for n in (self.left, self.right)]
            if same and all(len(p) == count + 1 for p in played):
                break
            print(f"again: the stream began at {triggers}; {[len(p) for p in played]} sounds of {count + 1}")
        else:
            raise ValueError(f"{what}: in each of three tries a stream began anew, or a sound is missing")
        late, apart, clock = [[], []], [], []
        lines = [(Line(c, 1, 2), Line(c, 1, 0)) for c in (n.clocks() for n in (self.left, self.right))]
        for start, *sounds in zip(asked, *played):
            at = [trigger + frame / RATE for trigger, (frame, _) in zip(triggers, sounds)]
            for i, (real, _) in enumerate(lines):
                late[i].append(1e3 * (real(at[i]) - start))
            ticks = [counter(t) for (_, counter), t in zip(lines, at)]
            apart.append(1e3 * (ticks[1] - self.lead - ticks[0]) / self.ticks_s)
            clock.append(apart[-1] - late[1][-1] + late[0][-1])
        equal = sum(e for p in played for _, e in p)
        self.check(f"{what}: {equal} of {2 * len(asked)} halves equal tactor render", equal == 2 * len(asked))

        def say(values):
            return f"{statistics.median(values):.3f} (worst {max(values, key=abs):.3f})"
        self.check(f"    right began after left by {say(apart[1:])} ms, known to {1e3 * self.known_s:.3f} ms; of it the clocks {say(clock[1:])} ms",
                   abs(statistics.median(apart[1:])) < 2 or self.limit_s > 1)
        self.check(f"    by its own clock left was late by {say(late[0][1:])} ms, right by {say(late[1][1:])} ms",
                   all(abs(statistics.median(values[1:])) < 1 for values in late))
        reported = [float(t) for t in re.findall(r"finished, (\S+) ms late", self.printed)]
        if not osc:
            ahead, known = zip(*(map(float, t) for t in re.findall(r"([+-]\S+) ms from .* known to (\S+) ms", self.printed)))
            self.check(f"    the first stroke was late by {late[0][0]:.1f} and {late[1][0]:.1f} ms, and reported as {reported[0]} and {reported[1]} ms; the "
                       f"example found the clocks {statistics.median(ahead):.3f} ms apart, known to {statistics.median(known):.3f} ms",
                       all(abs(r - max(t[0], 0)) < 5 for r, t in zip(reported, late)))

    def run(self):
        self.measure_counters()
        self.right.set_clock(0.3 - self.apart())
        for node in (self.left, self.right):
            node.serve()
        wait_for(lambda: all("listening: osc" in n.log("serve") for n in (self.left, self.right)), "the services")
        try:
            self.draw(False)
            refused = ""
        except SystemExit as e:
            refused = str(e)
        self.check(f"clocks 0.3 s apart: {refused}", "synchronise" in refused)
        limit_s, self.limit_s = self.limit_s, 60.0
        self.strokes("Not synchronised", False)
        self.limit_s = limit_s
        for what, commands in (("chrony", CHRONY), ("ptp4l", PTP)):
            self.synchronise(what, commands)
            self.strokes(f"{what}, start", False)
            self.strokes(f"{what}, OSC", True)
            for node in (self.left, self.right):
                node.kill(what)
            self.right.set_clock(0.05)
        self.faults()

    def synchronise(self, what, commands):
        """Waits until the clocks stay within 0.5 ms for ten seconds."""
        for node, command in zip((self.left, self.right), commands):
            node.start(what, *command)
        began, near = time.monotonic(), None
        while near is None or time.monotonic() - near < 10:
            time.sleep(0.2)
            near = None if abs(self.apart()) > 0.0005 else near or time.monotonic()
            if time.monotonic() - began > 180:
                raise TimeoutError(f"{what}: {1e3 * self.apart():.3f} ms apart: {self.right.log(what)[-2000:]}")
        print(f"{what} took {near - began:.0f} s to bring the clocks within 0.5 ms", flush=True)

    def faults(self):
        self.right.set_clock(-self.apart())
        self.fault("the client killed", lambda client: client.kill())
        self.fault("right's service killed", lambda _: self.right.kill("serve"), self.right.serve)
        cable = ("ip", "link", "set", "eth0")
        self.fault("the network down", lambda _: subprocess.run([*cable, "down"], check=True), lambda: subprocess.run([*cable, "up"], check=True))
        self.fault("right's machine off", lambda _: self.right.tell("power_off"), None, [self.left])

    def fault(self, what, do, repair=None, left_over=None):
        """Does it in the middle of a stroke of 4 s; checks that each amplifier goes off with its own stream."""
        nodes = [self.left, self.right]
        wait_for(lambda: all("listening: osc" in n.log("serve") for n in nodes), "a service")
        program = f"import runpy; runpy.run_path('{ROOT}/examples/python/two_machines.py')['draw']" \
                  f"(*{[f'{a}:{RPC}' for a in ADDRESSES.values()]}, '{LONG}', '{RUN}/token', {self.limit_s})"
        client = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        wait_for(lambda: all(n.changes()[-1][1] for n in nodes) or client.poll() is not None, "both amplifiers on")
        if client.poll() is not None:
            raise ValueError(client.stderr.read())
        time.sleep(1)  # the stroke begins within 0.5 s
        do(client)
        if what.startswith("the network"):
            wait_for(lambda: not any(self.left.changes()[-1][1:]), "left's amplifier off")
        if repair:
            repair()
        nodes, took = left_over or nodes, []
        for node in nodes:
            changes = wait_for(lambda n=node: (c := n.changes()) and not any(c[-1][1:]) and c, "an amplifier off")
            off, ended = (max(t for (_, *was), (t, *now) in zip(changes, changes[1:]) if was[i] and not now[i]) for i in (0, 1))
            took.append(1e3 * (off - ended))
        self.check(f"{what}: amplifiers off {', '.join(f'{t:.0f}' for t in took)} ms after their streams' ends; the client says: "
                   f"{client.communicate(timeout=60)[1].strip().rpartition(chr(10))[2] or 'nothing'}", max(took) < 200)


def main():
    _, build, role = sys.argv[1:]
    os.environ["PATH"] += f":{build}/machines/usr/sbin"
    node = Node(role)
    if role == "right":
        serve_agent(node)
    trial = Trial(node, Peer(ADDRESSES["right"]))
    try:
        trial.run()
    except (OSError, ValueError, SystemExit, subprocess.SubprocessError) as e:
        trial.check(f"{type(e).__name__}: {e}", False)
        print(node.log("serve"))
    print(f"{trial.passed} passed, {trial.failed} failed, 0 skipped")
    return 1 if trial.failed else 0


if __name__ == "__main__":
    sys.exit(main())
