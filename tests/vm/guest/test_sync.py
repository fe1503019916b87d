# SPDX-License-Identifier: MIT
"""Sync pulses and start triggers against the captured sound."""
import json
import subprocess
import threading
import time

from rig import BACK, BUILD, CAPTURING, GpioSim, RigTest, wait_for

OUT_LINE, IN_LINE = 3, 5


class Onsets:
    """The capture helper, and the onsets that it reports."""

    def __init__(self, folder, channels=9):
        self.times = []
        self.process = subprocess.Popen(
            [BUILD / "tests/vm/capture", BACK.format(0), str(channels), folder / "capture.raw"],
            stdout=subprocess.PIPE, text=True)
        CAPTURING.append(self.process)
        assert self.process.stdout.readline() == "ready\n"
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        for line in self.process.stdout:
            if line.startswith("onset "):
                self.times.append(int(line.split()[2]))

    def stop(self):
        self.process.terminate()
        self.process.wait(20)
        self.reader.join(20)
        return self.times


class Watch:
    """Returns the two clock readings between which a line rises: a millisecond apart under emulation, more under load."""

    def __init__(self, gpio, offset):
        self.gpio, self.offset, self.rises, self.ended = gpio, offset, [], False
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self):
        before = 0
        looked = time.monotonic_ns()
        while not self.ended:
            asked = time.monotonic_ns()
            now = self.gpio.value(self.offset)
            if now and not before:
                self.rises.append((looked, time.monotonic_ns()))
            before, looked = now, asked

    def stop(self):
        self.ended = True
        self.thread.join(20)
        return self.rises


class Sync(RigTest):
    def setUp(self):
        super().setUp()
        self.gpio = GpioSim()
        self.addCleanup(self.gpio.close)

    def test_pulses_come_with_the_first_sample(self):
        array = self.grid(extra=f'[sync]\nout = {{ chip = "{self.gpio.label}", offset = {OUT_LINE}, pulse_ms = 60 }}\n')
        onsets, watch = Onsets(self.dir), Watch(self.gpio, OUT_LINE)
        strokes = 20
        r = self.tool("play", *["park2016-1"] * strokes, "--duration", "0.21", "--array", array, "--sample-format", "s32",
                      "--format", "json")
        self.assertEqual(r.returncode, 0, r.stderr)
        heard, pulses = onsets.stop(), watch.stop()
        counters = json.loads(r.stdout)["counters"]
        print({name: value for name, value in counters.items() if name.startswith("sync")})
        # A pulse that would come more than 20 ms late is counted instead of sent: a slow host may cost a few.
        self.assertEqual(counters["sync_pulses"] + counters["sync_missed"], strokes)
        self.assertLessEqual(counters["sync_missed"], 4)
        self.assertEqual(len(pulses), counters["sync_pulses"])
        # Strokes without a gap of 0.1 s are one sound: compare each onset with the nearest pulse.
        nearest = [min(pulses, key=lambda p, h=h: abs(p[1] - h)) for h in heard]
        least, most = ([(p[end] - h) / 1e6 for p, h in zip(nearest, heard)] for end in (0, 1))
        print(f"sync pulse after onset, ms: n {len(heard)}, between {min(least):.2f} and {max(most):.2f}")
        self.assertGreaterEqual(len(heard), 1)
        # The counters give the lateness of a pulse on a busy host; this checks them as well as a card that moves by jiffies of
        # 4 ms can.
        self.assertGreater(min(most), -10)
        self.assertLess(max(least), counters["sync_worst_late_s"] * 1e3 + 10)

    def test_an_edge_starts_an_armed_stroke(self):
        array = self.grid(extra=f'[sync]\nin = {{ chip = "{self.gpio.label}", offset = {IN_LINE}, edge = "rising" }}\n')
        self.gpio.pull(IN_LINE, False)
        onsets = Onsets(self.dir)
        delay_ms = 150
        p = self.start("play", "park2016-1", "--duration", "0.2", "--array", array, "--sample-format", "s32", "--arm",
                       "--sync-delay-ms", str(delay_ms))
        wait_for(lambda: "armed" in p.stdout.readline(), "the stroke is armed")
        self.assertEqual(onsets.times, [])
        pulled = time.monotonic_ns()
        self.gpio.pull(IN_LINE, True)
        self.assertEqual(p.wait(30), 0, p.stderr.read())
        heard = onsets.stop()
        self.assertEqual(len(heard), 1)
        error = (heard[0] - pulled) / 1e6 - delay_ms
        print(f"armed stroke: first sample {error:+.2f} ms from {delay_ms} ms after the edge")
        self.assertLess(abs(error), 40)
