# SPDX-License-Identifier: MIT
"""Minutes of play on a real kernel while another process loads the processor. TACTOR_VM_MINUTES, default 10.

An emulated processor on a shared host may be without the host's for longer than any buffer: how many xruns there were is a
figure to be read. What must hold is what becomes of them.
"""
import json
import os
import subprocess
import sys

from rig import AmplifierTest, wait_for

PERIOD, PERIODS = 480, 32
STROKE_S = 20.0


class Load(AmplifierTest):
    def test_minutes_of_play_under_load(self):
        minutes = float(os.environ.get("TACTOR_VM_MINUTES", "10"))
        # An xrun ends one stroke, not the run.
        strokes = max(2, round(60 * minutes / STROKE_S))
        busy = subprocess.Popen([sys.executable, "-c", "while True: sum(i * i for i in range(10000))"])
        try:
            p = self.start("play", *["park2016-1"] * strokes, "--duration", STROKE_S, "--array", self.array,
                           "--period-frames", PERIOD, "--periods", PERIODS, "--format", "json")
            wait_for(lambda: self.on() or p.poll() is not None, "the amplifier is switched on", 60)
            out, err = p.communicate(timeout=60 * minutes + 600)
        finally:
            busy.kill()
            busy.wait()
        self.assertFalse(self.on())
        report = json.loads(out)
        counters, played = report["counters"], report["strokes"]
        print(f"{minutes:g} minutes at {PERIODS} periods of {PERIOD} frames under load: {json.dumps(counters)}")
        cut = [s for s in played if s["state"] != "finished"]
        self.assertEqual(len(played), strokes)
        self.assertLess(len(cut), strokes, err)
        # Each xrun is reported with its length, and ends its stroke; nothing else ends one.
        for s in cut:
            self.assertEqual((s["state"], s["reason"]), ("interrupted", "xrun: the device ran dry"), s)
        self.assertLessEqual(len(cut), counters["xruns"], err)
        self.assertEqual(len(counters["xrun_s"]), counters["xruns"])
        # The amplifier goes off where the stream stands still for long, and at the end.
        self.assertEqual((counters["off_failures"], counters["left_on"]), (0, False))
