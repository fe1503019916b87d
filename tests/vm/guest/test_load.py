# SPDX-License-Identifier: MIT
"""Minutes of play on a real kernel while another process loads the CPU. TACTOR_VM_MINUTES, default 10."""
import json
import os
import subprocess
import sys

from rig import RigTest

# What an emulated processor on a shared host can hold: it may be without the host's for a tenth of a second.
PERIOD, PERIODS = 480, 32


class Load(RigTest):
    def test_no_xrun_in_minutes_of_play_under_load(self):
        minutes = float(os.environ.get("TACTOR_VM_MINUTES", "10"))
        array = self.grid()
        busy = subprocess.Popen([sys.executable, "-c", "while True: sum(i * i for i in range(10000))"])
        try:
            r = self.tool("play", "--path", "M 0 10 L 40 30 L 0 30 Z", "--duration", str(minutes * 60), "--array", array,
                          "--period-frames", str(PERIOD), "--periods", str(PERIODS), "--format", "json", timeout=minutes * 60 + 300)
        finally:
            busy.kill()
            busy.wait()
        self.assertEqual(r.returncode, 0, r.stderr)
        report = json.loads(r.stdout)
        print(f"{minutes:g} minutes at {PERIODS} periods of {PERIOD} frames under load: {json.dumps(report['counters'])}")
        self.assertEqual(report["counters"]["xruns"], 0)
        self.assertEqual([s["state"] for s in report["strokes"]], ["finished"])
