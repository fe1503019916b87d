# SPDX-License-Identifier: MIT
"""tactor check and its walk on a real kernel: findings about a card and its lines, free and in use."""
import json
import signal
import subprocess

from rig import TOOL, Capture, GpioSim, RigTest, wait_for


class Check(RigTest):
    def setUp(self):
        super().setUp()
        self.sim = GpioSim(names=[(1, "AMP"), (2, "OUT")])
        self.addCleanup(self.sim.close)
        self.array = self.grid(extra=f'[amplifier]\nline = {{ chip = "{self.sim.label}", offset = 1 }}\n'
                                     '[sync]\nout = { name = "OUT" }\n')

    def check(self, status):
        r = self.tool("check", "--array", self.array, "--format", "json")
        self.assertEqual(r.returncode, status, r.stdout + r.stderr)
        return {f["check"]: f for f in json.loads(r.stdout)["findings"]}

    def test_findings_of_a_free_and_a_used_card(self):
        found = self.check(0)
        print(self.tool("check", "--array", self.array).stdout)
        self.assertIn("9 channels, 48000 Hz", found["device"]["found"])
        self.assertEqual(found["amplifier"]["found"], f'line 1 "AMP" of {self.sim.label} (/dev/{self.sim.chip}), free')
        self.assertEqual(found["sync out"]["level"], "ok")
        self.assertEqual(found["sound servers"]["level"], "ok")
        self.assertIn("drive time", found)
        # The check drives nothing.
        self.assertEqual((self.sim.value(1), self.sim.value(2)), (0, 0))

        # An xrun of the emulated machine ends one stroke, not the run.
        p = self.start("play", *["park2016-1"] * 50, "--duration", "60", "--array", self.array)
        wait_for(lambda: self.sim.value(1) == 1, "the amplifier is on")
        found = self.check(3)
        self.assertIn(f"tactor (process {p.pid}) plays on it", found["device"]["found"])
        self.assertIn('held by "tactor"', found["amplifier"]["found"])
        self.assertEqual(found["sound servers"]["level"], "warning")
        self.assertEqual(self.sim.value(1), 1)
        p.send_signal(signal.SIGINT)
        self.assertEqual(p.wait(timeout=60), 130)

    def test_the_walk_drives_each_channel_with_the_amplifier_on(self):
        capture = Capture(self.dir, 9, "S16_LE")
        p = subprocess.Popen([TOOL, "check", "--walk", "--auto", "--array", self.array, "--sample-format", "s16"],
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=self.dir, env=self.env)
        wait_for(lambda: self.sim.value(1) == 1, "the amplifier is on")
        out, err = p.communicate(timeout=120)
        self.assertEqual(p.returncode, 0, err)
        self.assertIn("tactor 8: channel 8, at 40, 40 mm", out)
        self.assertEqual(self.sim.value(1), 0)
        raw = memoryview(capture.stop()).cast("h")
        order = []
        for i in range(0, len(raw) - 8, 9 * 11):
            loud = [c for c, v in enumerate(raw[i:i + 9]) if v]
            self.assertLessEqual(len(loud), 1)
            if loud and order[-1:] != loud:
                order += loud
        self.assertEqual(order, list(range(9)))
