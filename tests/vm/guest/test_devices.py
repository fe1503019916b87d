# SPDX-License-Identifier: MIT
"""tactor devices and tactor check on a real kernel: a card and GPIO lines, free and in use, and the walk over the array."""
import json
import signal

from rig import PERIOD, Capture, GpioSim, RigTest, wait_for


class Devices(RigTest):
    def devices(self, *args):
        r = self.tool("devices", "--format", "json", *args)
        self.assertEqual(r.returncode, 0, r.stderr)
        told = json.loads(r.stdout)
        return {p["name"]: p for p in told["pcms"]}, {c["label"]: c for c in told["gpio_chips"]}

    def test_a_card_gives_its_properties_and_stays_unconfigured(self):
        pcms, _ = self.devices("--array", self.grid())
        card = pcms["hw:CARD=Loopback,DEV=0"]
        print(self.tool("devices").stdout)
        self.assertEqual((card["hardware"], card["opened"], card["fits"], card["holders"]), (True, True, True, []))
        self.assertEqual(card["can"]["channels"], [{"min": 1, "max": 32}])
        self.assertIn(48000, card["can"]["usual_rates_hz"])
        self.assertIn("s32", card["can"]["formats"])
        self.assertLessEqual(card["can"]["period_frames"]["min"], PERIOD)
        self.assertEqual(sum(name.startswith("hw:CARD=Loopback") for name in pcms), 2)
        # PCMs that would start the card are named only.
        self.assertTrue(all(not p["tried"] for n, p in pcms.items() if n.startswith(("dmix", "sysdefault"))))

    def test_players_and_holders_of_lines_are_named(self):
        sim = GpioSim(names=[(3, "AMP")])
        self.addCleanup(sim.close)
        array = self.grid(extra=f'[amplifier]\nline = {{ chip = "{sim.label}", offset = 3 }}\n')
        chip = self.devices()[1][sim.label]
        self.assertEqual(chip["lines"][3], {"offset": 3, "name": "AMP", "direction": "input", "consumer": None})
        # An xrun of the emulated machine ends one stroke, not the run.
        p = self.start("play", *["park2016-1"] * 50, "--duration", "60", "--array", array)
        wait_for(lambda: sim.value(3) == 1, "the amplifier is on")
        pcms, chips = self.devices()
        self.assertIn({"pid": p.pid, "program": "tactor"}, pcms["hw:CARD=Loopback,DEV=0"]["holders"])
        self.assertEqual(pcms["hw:CARD=Loopback,DEV=1"]["holders"], [])
        self.assertEqual(chips[sim.label]["lines"][3],
                         {"offset": 3, "name": "AMP", "direction": "output", "consumer": "tactor"})
        p.send_signal(signal.SIGINT)
        self.assertEqual(p.wait(timeout=60), 130)


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
        p = self.start("check", "--walk", "--auto", "--array", self.array, "--sample-format", "s16")
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
