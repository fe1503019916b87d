# SPDX-License-Identifier: MIT
"""Tests that a card receives the samples that render writes, unless the player reports an xrun or the recorder an overrun; and of two players that
share it through ALSA's dmix, the sum.

Both happen where the emulated machine gets no time: such a recording says nothing, and another is made. How many there
were is printed. A difference without either is a fault at once.
"""
import array
import json

from rig import OUT, PERIOD, PERIODS, RATE, Capture, RigTest, wav_data


def difference(heard, data, frame):
    """Returns the first difference, and its kind: frames missing, repeated, or others."""
    at = next((n for n in range(0, len(data), frame) if heard[n:n + frame] != data[n:n + frame]), None)
    if at is None:
        return ""
    some = 100 * frame
    lost = data.find(heard[at:at + some], at)
    twice = heard.find(data[at:at + some], at)
    what = f"{(lost - at) // frame} frames are missing" if lost >= 0 else \
        f"{(twice - at) // frame} frames come between" if twice >= 0 else "other frames follow"
    return f"from frame {at // frame} of {len(data) // frame} on {what}"


RECORDINGS = 5  # at most


class Loopback(RigTest):
    tried_again = False

    def record(self, channels, name, alsa_name, stroke, array):
        """Returns the received bytes, and the bytes in a frame; none for silence."""
        capture = Capture(self.dir, channels, alsa_name)
        played = self.tool("play", *stroke, "--array", array, "--sample-format", name, "--format", "json")
        got = capture.stop()
        xruns = json.loads(played.stdout)["counters"]["xruns"] if played.stdout else 0
        if xruns or capture.overruns:
            print(f"{channels} channels {name}: recorded again: {xruns} xruns of the player, {capture.overruns} overruns of the recorder")
            return None
        self.assertEqual(played.returncode, 0, played.stderr)
        return got, capture.frame_bytes

    def compare(self, channels, name, alsa_name, stroke):
        array = self.grid(channels)
        rendered = self.tool("render", *stroke, "--array", array, "--sample-format", name, "-o", "o.wav")
        self.assertEqual(rendered.returncode, 0, rendered.stderr)
        recordings = (self.record(channels, name, alsa_name, stroke, array) for _ in range(RECORDINGS))
        made, recorded = next(((n, r) for n, r in enumerate(recordings, 1) if r), (RECORDINGS, None))
        self.assertIsNotNone(recorded, f"{channels} channels {name}: none of {RECORDINGS} recordings says anything")
        got, frame = recorded
        data = wav_data(self.dir / "o.wav")
        lead = next(i for i, v in enumerate(data) if v) // frame
        start = next(i for i, v in enumerate(got) if v) // frame - lead
        heard = got[start * frame:start * frame + len(data)]
        self.assertEqual(difference(heard, data, frame), "", f"{channels} channels {name}")
        self.assertEqual(len(heard), len(data))
        print(f"{channels} channels {name}: {len(data) // frame} frames identical in recording {made}, device {OUT.format(0)}, "
              f"{PERIODS} periods of {PERIOD}")

    def test_nine_and_sixteen_channels_arrive_bit_by_bit(self):
        for channels, name, alsa_name in ((9, "s16", "S16_LE"), (9, "s32", "S32_LE"), (16, "s16", "S16_LE"),
                                          (16, "s32", "S32_LE")):
            self.compare(channels, name, alsa_name, ["park2016-1"])

    def test_the_other_algorithms_arrive_too(self):
        for algorithm in ("tactile-brush", "continuous"):
            self.compare(9, "s32", "S32_LE", ["park2016-3", "--algorithm", algorithm])


# Two players and the emulated kernel share two processors: deeper than for one.
SHARED_PERIOD, SHARED_PERIODS = 480, 32


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
             period_size {SHARED_PERIOD} buffer_size {SHARED_PERIOD * SHARED_PERIODS} }}
}}
""")

    def test_two_strokes_from_two_processes_sound_together(self):
        self.mixer()
        palm = self.grid()
        capture = Capture(self.dir, 9, "S32_LE")
        # Along opposite edges of the palm: each has three separate channels.
        players = [self.start("play", "--path", path, "--duration", "3", "--array", palm, "-D", "shared",
                              "--sample-format", "s32", "--period-frames", str(SHARED_PERIOD), "--periods", str(SHARED_PERIODS))
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
