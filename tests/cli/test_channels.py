# SPDX-License-Identifier: MIT
"""Cards with more or fewer channels than the array, without a choice of channels."""
import json

from harness import ALSA_CONFIG, ToolTest, main
from serving import Server

FIXED = "pcm.%s { type multi slaves.a { pcm { type null } channels %d }\n%s }\n"
FITS = "the array palm-2x4 fits"


def fixed(name, channels):
    return FIXED % (name, channels, "\n".join(f"bindings.{c} {{ slave a channel {c} }}" for c in range(channels)))


class Channels(ToolTest):
    STROKE = ("--path", "M 0 20 L 40 40", "--duration", "0.2")

    def setUp(self):
        super().setUp()
        kept = f'pcm.kept {{ type file slave.pcm "sixteen" file "{self.dir}/out.raw" format raw }}\n'
        self.write("alsa.conf", ALSA_CONFIG + fixed("sixteen", 16) + fixed("ten", 10) + kept)

    def frames(self, channels, sample_bytes=4):
        """Returns the frames at the device from the first sound on, each as a list of the bytes of its samples."""
        raw = (self.dir / "out.raw").read_bytes()
        frame = channels * sample_bytes
        self.assertEqual(len(raw) % frame, 0)
        all_of = [[raw[i + c * sample_bytes:i + (c + 1) * sample_bytes] for c in range(channels)] for i in range(0, len(raw), frame)]
        first = next(i for i, f in enumerate(all_of) if any(map(any, f)))
        return all_of[first:]

    def test_the_fewest_channels_that_hold_the_array_are_taken_and_the_others_are_silent(self):
        r = self.ok("play", *self.STROKE, "-D", "kept", "--sample-format", "s32")
        self.assertIn("kept: 9 of 16 channels, 48000 Hz", r.stdout)
        wide = self.frames(16)
        self.ok("play", *self.STROKE, "-D", f"raw:{self.dir}/out.raw", "--sample-format", "s32")
        narrow = self.frames(9)
        self.assertEqual([f[:9] for f in wide][:9600], narrow[:9600])
        self.assertEqual({s for f in wide for s in f[9:]}, {bytes(4)})
        told = json.loads(self.ok("play", *self.STROKE, "-D", "sixteen", "--format", "json").stdout)
        self.assertEqual((told["device"]["channels"], told["device"]["device_channels"]), (9, 16))
        told = json.loads(self.ok("play", *self.STROKE, "-D", "null", "--format", "json").stdout)
        self.assertEqual((told["device"]["channels"], told["device"]["device_channels"]), (9, 9))

    def test_a_marker_still_has_its_channel(self):
        self.write("a.toml", 'array.preset = "palm-3x3"\nsync.channel = 12\n')
        r = self.ok("play", *self.STROKE, "--array", "a.toml", "-D", "kept", "--sample-format", "s32")
        self.assertIn("13 of 16 channels", r.stdout)
        sounding = {c for f in self.frames(16) for c, s in enumerate(f) if any(s)}
        self.assertIn(12, sounding)
        self.assertFalse(sounding & {9, 10, 11, 13, 14, 15})

    def test_a_marker_beyond_the_device_is_named(self):
        self.write("a.toml", 'array.preset = "palm-2x4"\nsync.channel = 12\n')
        says = "the array palm-2x4 fits, but not channel 12, which a marker or a plan asks for"
        self.refused(3, "play", "--path", "M 0 0 L 60 0", "--duration", "0.2", "--array", "a.toml", "-D", "eight", says=[says])
        pcms = json.loads(self.ok("devices", "--format", "json", "--array", "a.toml").stdout)["pcms"]
        self.assertIn(says, next(p for p in pcms if p["name"] == "eight")["misfit"])
        r = self.run_tool("check", "--array", "a.toml", "-D", "eight", "--format", "json")
        self.assertIn(says, next(f for f in json.loads(r.stdout)["findings"] if f["check"] == "device")["cure"])

    def test_a_given_number_is_exact(self):
        self.assertIn(": 16 channels,", self.ok("play", *self.STROKE, "-D", "sixteen", "--channels", "16").stdout)
        says = ["cannot play 9 channels", "it can do channels 16", "without a number of channels it leaves the other channels silent"]
        r = self.refused(3, "play", *self.STROKE, "-D", "sixteen", "--channels", "9", says=says)
        self.assertNotIn("fits", r.stderr)
        self.refused(2, "play", *self.STROKE, "-D", "sixteen", "--channels", "8")
        self.refused(2, "play", *self.STROKE, "--channels", "0")
        self.write("a.toml", 'array.preset = "palm-3x3"\noutput.channels = 10\n')
        self.refused(3, "play", *self.STROKE, "--array", "a.toml", "-D", "sixteen")
        self.assertIn(": 10 channels,", self.ok("play", *self.STROKE, "--array", "a.toml", "-D", "ten").stdout)
        self.ok("render", *self.STROKE, "--channels", "16", "-o", "o.wav")
        self.assertEqual((self.dir / "o.wav").read_bytes()[22:24], (16).to_bytes(2, "little"))

    def test_a_plan_needs_as_many_channels_as_its_array(self):
        self.write("p.json", self.ok("plan", *self.STROKE, "--format", "json").stdout)
        self.assertIn("9 of 16 channels", self.ok("play", "p.json", "-D", "sixteen").stdout)

    def test_a_card_with_fewer_channels_names_an_array_that_fits(self):
        self.refused(3, "play", *self.STROKE, "-D", "eight", says=["cannot play 9 channels", "it can do channels 8", FITS])
        r = self.run_tool("check", "-D", "eight", "--format", "json")
        found = next(f for f in json.loads(r.stdout)["findings"] if f["check"] == "device")
        self.assertEqual((r.returncode, found["level"]), (3, "error"))
        self.assertIn(FITS, found["cure"])

    def test_check_devices_and_the_service_use_it(self):
        r = self.run_tool("check", "-D", "sixteen", "--format", "json")
        found = next(f for f in json.loads(r.stdout)["findings"] if f["check"] == "device")
        self.assertEqual(found["level"], "ok")
        self.assertIn("9 of 16 channels", found["found"])
        pcms = {p["name"]: p for p in json.loads(self.ok("devices", "--format", "json").stdout)["pcms"]}
        self.assertEqual([pcms[n]["fits"] for n in ("sixteen", "ten", "eight")], [True, True, False])
        self.assertIn(FITS, pcms["eight"]["misfit"])
        s = Server(self, device=("-D", "sixteen"))
        c = s.client()
        self.assertEqual(c.ok("hello")["stream"]["channels"], 9)
        n = c.ok("play", stroke="park2016-1", options={"duration": 0.2})["stroke"]
        self.assertEqual(c.await_end(n)["state"], "finished")

    def test_the_service_does_not_wait_for_a_card_with_too_few_channels(self):
        self.refused(3, "serve", "--socket", f"{self.dir}/s", "-D", "eight")

    def test_live_strokes_and_a_walk_use_it_too(self):
        self.assertIn("9 of 16 channels", self.ok("play", "--live", "-", "-D", "sixteen", stdin="20 20\n").stdout)
        self.ok("check", "--walk", "--auto", "-D", "sixteen")


if __name__ == "__main__":
    main()
