# SPDX-License-Identifier: MIT
"""The card goes away in mid-stroke, and comes back."""
import json
import pathlib

from rig import AmplifierTest, Card, wait_for


class Unplug(AmplifierTest):
    def setUp(self):
        super().setUp()
        self.addCleanup(Card.plug_in)

    def sounding(self):
        """Waits until a second of the stream has been played: the stroke has begun."""
        status = pathlib.Path("/proc/asound/Loopback/pcm0p/sub0/status").read_text()
        return any(int(line.split(":")[1]) > 48000 for line in status.splitlines() if line.startswith("hw_ptr"))

    def test_the_stroke_is_interrupted_and_the_amplifier_off(self):
        p = self.start("play", "--path", "M 0 10 L 40 30", "--duration", "60", "--array", self.array, "--format", "json")
        wait_for(self.on, "the amplifier is on")
        wait_for(self.sounding, "the stroke has begun")
        pull = Card.pull_out()
        wait_for(lambda: not self.on(), "the amplifier is off", 2)
        out, said = p.communicate(timeout=30)
        pull.wait(20)
        self.assertEqual(p.returncode, 1, said)
        self.assertIn("interrupted", said)
        states = [s["state"] for s in json.loads(out)["strokes"]]
        self.assertEqual(states, ["interrupted"])

    def test_playing_goes_on_when_the_card_comes_back(self):
        p = self.start("play", "park2016-1", "park2016-2", "--duration", "5", "--array", self.array, "--reopen-s", "60",
                       "--format", "json")
        wait_for(self.on, "the amplifier is on")
        wait_for(self.sounding, "the stroke has begun")
        pull = Card.pull_out()
        wait_for(lambda: not self.on(), "the amplifier is off", 2)
        pull.wait(20)
        Card.plug_in()
        wait_for(lambda: self.on() or p.poll() is not None, "the amplifier is on again", 30)
        out, said = p.communicate(timeout=60)
        states = [s["state"] for s in json.loads(out)["strokes"]]
        self.assertEqual(states, ["interrupted", "finished"], said)
        self.assertFalse(self.on())
