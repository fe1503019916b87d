# SPDX-License-Identifier: MIT
"""The amplifier's line through every end of a player."""
import os
import signal
import time

from rig import AmplifierTest


class Amplifier(AmplifierTest):
    def test_it_is_on_while_a_stroke_plays_and_off_before_and_after(self):
        self.assertFalse(self.on())
        p = self.playing("1", strokes=1)
        seen = []
        while p.poll() is None:
            seen.append(self.on())
            time.sleep(0.005)
        self.assertEqual(p.returncode, 0, p.stderr.read())
        self.assertTrue(any(seen))
        # On once, off once.
        self.assertEqual(sum(a != b for a, b in zip(seen, seen[1:])), 1, seen)
        self.assertFalse(self.on())

    def test_ctrl_c_and_sigterm_switch_it_off(self):
        for number, status in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            p = self.playing()
            p.send_signal(number)
            # The fade and the silence behind it come first: 16 periods of 240 frames are queued.
            self.off_within(signal.Signals(number).name, self.LIMIT_S + 0.12)
            self.assertEqual(p.wait(20), status)

    def test_sigkill_switches_it_off_at_any_moment(self):
        for delay in (0.0, 0.05, 0.3):
            p = self.playing()
            time.sleep(delay)
            p.kill()
            self.off_within("SIGKILL")
            p.wait(20)

    def test_sigstop_switches_it_off_and_sigcont_lets_the_player_end_well(self):
        p = self.playing()
        os.kill(p.pid, signal.SIGSTOP)
        self.off_within("SIGSTOP")
        os.kill(p.pid, signal.SIGCONT)
        p.send_signal(signal.SIGINT)
        p.wait(20)
        self.assertFalse(self.on())

    def test_a_busy_line_names_its_holder(self):
        first = self.playing()
        second = self.tool("play", "park2016-1", "--array", self.array, "-D", "null")
        self.assertEqual(second.returncode, 3, second.stderr)
        self.assertIn("tactor", second.stderr.split(":", 2)[2])
        first.send_signal(signal.SIGINT)
        first.wait(20)
