# SPDX-License-Identifier: MIT
"""Tests an array of 24 tactors on two machines, over PipeWire's RTP: equal samples, their times, and faults.

Usage: rtp.py TOOL [MINUTES]     as root, with PipeWire 1.4. Three network namespaces with the files of examples/rtp are the
machines; they and all processes end with this one. MINUTES (default 2): how long the two receivers' times are compared.
Ends with a line that counts.
"""
import array
import os
import pathlib
import re
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time

from namespaces import CYCLE, EXAMPLES, FRAME, HALF, RATE, Machine, Recording, ends, run, wait_for

NEEDED = "unshare nsenter ip nft chrt ptp4l dbus-daemon pipewire wireplumber pw-record pw-link pw-dump".split()
ARRAY = ("--array", str(EXAMPLES / "both.toml"), "--sample-format", "s24")
# Every tactor has its turn; both halves vibrate from the first sample to the last.
TOUR = (*ARRAY, "--path", "M 0 0 H 100 V 20 H 0 V 40 H 100 V 60 H 0", "--speed", "160")
BORDER = (*ARRAY, "--path", "M 50 0 V 60", "--duration", "6", "--algorithm", "continuous")
PACKET = 20 + 8 + 12 + 16 * 24 * 3  # bytes of IP


class Trial:
    def __init__(self, tool, folder):
        self.tool, self.folder, self.passed, self.failed = tool, folder, 0, 0

    def run(self, minutes):
        run("ip", "link", "add", "switch", "type", "bridge")
        run("ip", "link", "set", "dev", "switch", "up")
        self.sender = Machine(self.folder, "sender", "10.24.0.1")
        self.receivers = [Machine(self.folder, "receiver-left", "10.24.0.2"), Machine(self.folder, "receiver-right", "10.24.0.3")]
        self.recordings = [Recording(r) for r in self.receivers]
        self.tour, channels = self.rendered(TOUR)
        self.border, _ = self.rendered(BORDER)
        self.check(f"The stroke sounds on channels {channels}", channels == list(range(2 * HALF)))
        self.equality_and_times(minutes)
        self.losses()
        right, later = next((r for r in (self.late() for _ in range(3)) if r[0]), (False, []))
        self.check(f"tactor stopped for 15 ms, six times: both receivers play on, in the end {later} ms too late", right)
        self.dead_receiver()
        self.fault("tactor killed", lambda player: player.kill(), lambda: None, False)
        self.fault("The sender's PipeWire killed", lambda _: self.sender.kill(), self.sender.begin, True)
        cable = ("ip", "link", "set", "dev", "sender")
        self.fault("The sender's cable pulled", lambda _: run(*cable, "down"), lambda: run(*cable, "up"), True)

    def check(self, what, right):
        self.passed, self.failed = self.passed + bool(right), self.failed + (not right)
        print(("" if right else "FAILED: ") + what, flush=True)

    def rendered(self, stroke):
        """Returns both halves' sound, 24-bit samples as floats, with the frames before each; and the channels that sound."""
        run(self.tool, "render", *stroke, "-o", str(self.folder / "rendered.wav"))
        data = (self.folder / "rendered.wav").read_bytes()
        at = data.index(b"data") + 8
        data = data[at:at + int.from_bytes(data[at - 4:at], "little")]  # the file's mark follows
        values = array.array("f", [int.from_bytes(data[i:i + 3], "little", signed=True) / (1 << 23) for i in range(0, len(data), 3)])
        halves = [b"".join(values[i:i + HALF].tobytes() for i in range(first, len(values), 2 * HALF)) for first in (0, HALF)]
        return [(h[slice(*(FRAME * e for e in ends(h)))], ends(h)[0]) for h in halves], [c for c in range(2 * HALF) if any(values[c::2 * HALF])]

    def play(self, stroke, wait_s=0.0):
        """Plays a stroke; returns when both receivers have played so much of it."""
        for r in self.recordings:
            r.drop()
        # Stroke after stroke is more than tactors may be driven by default.
        player = self.sender.start(self.tool, "play", *stroke, "-D", "pipewire", "--period-frames", str(CYCLE), "--max-drive-s", "600",
                                   "--drive-window-s", "600")
        wait_for(lambda: all(len(r.data.lstrip(b"\0")) >= wait_s * RATE * FRAME for r in self.recordings), "no sound")
        return player

    def hear(self):
        """Plays TOUR; returns for each receiver whether it played what was rendered, and when the stroke began there, in s."""
        self.play(TOUR).wait(60)
        heard = [r.sound() for r in self.recordings]
        return [h[0] == m[0] for h, m in zip(heard, self.tour)], [h[1] - m[1] / RATE for h, m in zip(heard, self.tour)]

    def equality_and_times(self, minutes):
        offsets, count, different, reported, end = [], 0, [0, 0], 0, time.monotonic() + 60 * minutes
        machines = [self.sender, *self.receivers]
        while count == 0 or time.monotonic() < end:
            late = sum(m.late() for m in machines)
            same, times = self.hear()
            count, different = count + 1, [d + (not s) for d, s in zip(different, same)]
            if all(same):
                offsets.append(1e6 * (times[1] - times[0]))
            else:
                reported += sum(m.late() for m in machines) > late
        ptp = [[int(o) for o in r.log("ptp4l", r"master offset +(-?\d+)")] for r in self.receivers]
        self.check(f"{count} strokes in {minutes:g} min: {len(offsets)} equal tactor render in 24 bits at both receivers; {different[0]} differ at "
                   f"the left one, {different[1]} at the right one; of those, logs report late cycles for {reported}; missing packets: "
                   f"{[r.missing() for r in self.receivers]}", len(offsets) >= 0.9 * count)
        self.check(f"The right receiver plays {statistics.median(offsets):.0f} us after the left one (median; {min(offsets):.0f} to "
                   f"{max(offsets):.0f} us), by one clock", abs(statistics.median(offsets)) < 500)
        self.check(f"ptp4l, which sets no clock here, measures offsets of {[statistics.median(map(abs, p)) for p in ptp if p]} ns (median; "
                   f"{[len(p) for p in ptp]} times) between receivers and sender", all(ptp) or minutes < 1)

    def losses(self):
        nft, before = [*self.receivers[0].prefix, "nft"], self.receivers[0].missing()
        player = self.play(BORDER, 0.5)
        # Each 400th packet, 20 of them.
        run(*nft, "table inet loss { chain in { type filter hook input priority 0\n"
            f"udp dport 5004 numgen inc mod 400 0 quota until {20 * PACKET} bytes counter drop\n}}\n}}\n")
        status, heard, wanted = player.wait(30), [r.sound()[0] for r in self.recordings], self.border[0][0]
        dropped = int(re.search(r"counter packets (\d+)", run(*nft, "list", "ruleset"))[1])
        run(*nft, "flush", "ruleset")
        wrong, gaps = [i for i in range(0, len(wanted), FRAME) if heard[0][i:i + FRAME] != wanted[i:i + FRAME]], []
        for i in wrong:
            if not gaps or i > gaps[-1][1] + 10 * FRAME:
                gaps.append([i, i])
            gaps[-1][1] = i
        silent, ms = not any(any(heard[0][i:i + FRAME]) for i in wrong), [(b - a) / FRAME / RATE * 1000 for a, b in gaps]
        counted = self.receivers[0].missing() - before
        self.check(f"{dropped} packets lost before the left receiver: its log counts {counted}; {len(ms)} gaps of {min(ms):.0f} to {max(ms):.0f} ms, "
                   f"{'silent' if silent else 'with wrong samples'}; tactor exits with {status}", dropped == counted == len(ms) == 20 and silent)
        self.check("The right receiver played that stroke as rendered", heard[1] == self.border[1][0])

    def fault(self, what, do, repair, stops):
        """Does a fault in mid-stroke and repairs it; checks when the receivers fall silent, and that they play again."""
        # A stroke that other work on this machine ended before the fault tells nothing.
        for _ in range(3):
            player, cause, told = self.play(BORDER, 0.5), time.monotonic(), ""
            do(player)
            if stops:
                wait_for(lambda: all(re.search(r'"rtp.receiving": "?false', r.says("pw-dump")) for r in self.receivers), "rtp.receiving stays true")
                told = f"; rtp.receiving is false after {time.monotonic() - cause:.1f} s"
            took = [1000 * (r.sound()[2] - cause) for r in self.recordings]
            status = player.wait(60)
            repair()
            if min(took) > 0:
                break
        self.check(f"{what}{told}; silence after {took[0]:.0f} and {took[1]:.0f} ms; tactor exits with {status}", 0 < min(took) <= max(took) < 100)
        self.check("After that both play what is rendered", any(all(self.hear()[0]) for _ in range(3)))

    def late(self):
        """Stops tactor for 15 ms six times; returns whether the receivers still play the last second, and how much too late."""
        player = self.play(BORDER, 0.5)
        for _ in range(6):
            player.send_signal(signal.SIGSTOP)
            time.sleep(0.015)
            player.send_signal(signal.SIGCONT)
            time.sleep(0.2)
        player.wait(30)
        heard, wanted = [r.sound()[0] for r in self.recordings], [b[0] for b in self.border]
        return (all(h[-RATE * FRAME:] == w[-RATE * FRAME:] for h, w in zip(heard, wanted)),
                [(len(h) - len(w)) / FRAME / RATE * 1000 for h, w in zip(heard, wanted)])

    def dead_receiver(self):
        player = self.play(BORDER, 0.5)
        self.receivers[0].kill()
        status, right = player.wait(30), self.recordings[1].sound()[0] == self.border[1][0]
        self.recordings[0].recorder.kill()
        self.check(f"The left receiver's PipeWire killed: the right one plays on as rendered; tactor exits with {status}", right)
        self.receivers[0].begin()
        self.recordings[0] = Recording(self.receivers[0])
        self.check("After that both play what is rendered", any(all(self.hear()[0]) for _ in range(3)))


def why_not():
    if lacks := [n for n in NEEDED if not shutil.which(n)]:
        return f"{', '.join(lacks)} not here"
    version = [int(n) for n in re.search(r"libpipewire (\d+)\.(\d+)", run("pipewire", "--version")).groups()]
    return "needs root" if os.geteuid() else "PipeWire is older than 1.4" if version < [1, 4] else None


def main():
    if os.getpid() != 1:
        if why := why_not():
            print(f"SKIPPED: machines: {why}\n0 passed, 0 failed, 1 skipped")
            return 0
        # With the new process end its children and namespaces. A chroot cannot make its mounts private.
        chroot = subprocess.run(["unshare", "--mount", "true"], stderr=subprocess.DEVNULL, check=False).returncode
        return subprocess.run(["unshare", "--net", "--pid", "--fork", "--kill-child", "--mount", "--propagation",
                               "unchanged" if chroot else "private", sys.executable, *sys.argv], check=False).returncode
    run("mount", "-t", "proc", "proc", "/proc")
    with tempfile.TemporaryDirectory(prefix="tactor-") as folder:
        trial = Trial(str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(folder))
        try:
            trial.run(float(sys.argv[2]) if len(sys.argv) > 2 else 2.0)
        except (OSError, ValueError, subprocess.SubprocessError) as e:
            trial.check(f"{type(e).__name__}: {e}", False)
    print(f"{trial.passed} passed, {trial.failed} failed, 0 skipped")
    return 1 if trial.failed else 0


if __name__ == "__main__":
    sys.exit(main())
