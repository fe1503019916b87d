# SPDX-License-Identifier: MIT
"""Two players that share a card through ALSA's dmix."""
import array

from rig import RATE, Capture, RigTest

# Two players and the emulated kernel share two processors: deeper than for one.
PERIOD, PERIODS = 480, 32


def peaks(data, channels):
    """Returns the largest magnitude of each channel of 32-bit samples."""
    samples = array.array("i", data)
    return [max((abs(v) for v in samples[c::channels]), default=0) for c in range(channels)]


class Dmix(RigTest):
    def mixer(self):
        self.write(".asoundrc", f"""
pcm.shared {{
    type dmix
    ipc_key 20160408
    ipc_perm 0600
    slave {{ pcm "hw:CARD=Loopback,DEV=0,SUBDEV=0" channels 9 format S32_LE rate {RATE}
             period_size {PERIOD} buffer_size {PERIOD * PERIODS} }}
}}
""")

    def test_two_strokes_from_two_processes_sound_together(self):
        self.mixer()
        palm = self.grid()
        capture = Capture(self.dir, 9, "S32_LE")
        # Along opposite edges of the palm: each has three separate channels.
        players = [self.start("play", "--path", path, "--duration", "3", "--array", palm, "-D", "shared",
                              "--sample-format", "s32", "--period-frames", str(PERIOD), "--periods", str(PERIODS))
                   for path in ("M 0 0 L 40 0", "M 0 40 L 40 40")]
        for p in players:
            _, err = p.communicate(timeout=120)
            self.assertEqual(p.returncode, 0, err)
            self.assertNotIn("xrun", err)
        heard = peaks(capture.stop(), 9)
        full = 2**31 * 10 ** (-12 / 20)
        for channel in (0, 1, 2, 6, 7, 8):
            self.assertAlmostEqual(heard[channel] / full, 1.0, delta=0.35, msg=str(heard))
        self.assertEqual(heard[3:6], [0, 0, 0])
        print(f"dmix: peaks of the channels relative to the level asked for: {[round(v / full, 3) for v in heard]}")
