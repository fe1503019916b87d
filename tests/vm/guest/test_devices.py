# SPDX-License-Identifier: MIT
"""tactor devices on a real kernel: a card with its holder, a GPIO chip with the holders of its lines."""
import json
import signal

from rig import PERIOD, GpioSim, RigTest, wait_for


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
