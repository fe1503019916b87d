# SPDX-License-Identifier: MIT
"""tactor play on ALSA's null and file devices, which need no hardware and pace themselves."""
import os
import pty
import re
import signal
import subprocess

from harness import TOOL, ToolTest, Wav, main


class Play(ToolTest):
    SHORT = ("--path", "M 0 10 L 40 30", "--duration", "0.3")

    def test_without_a_device_it_plays_to_null_and_says_so(self):
        r = self.ok("play", *self.SHORT)
        self.assertIn("null", r.stderr)
        self.assertIn("9 channels", r.stdout)

    def test_what_a_device_gets_is_what_render_writes(self):
        for name, pcm_bytes in (("s16", 2), ("s32", 4)):
            self.ok("render", *self.SHORT, "--sample-format", name, "-o", "o.wav")
            self.ok("play", *self.SHORT, "--sample-format", name, "-D", f"raw:{self.dir}/out.raw")
            wav, raw = Wav(self.dir / "o.wav"), (self.dir / "out.raw").read_bytes()
            frame = 9 * pcm_bytes
            self.assertEqual(len(raw) % frame, 0)
            # The first frame of a stroke is a zero crossing: compare from the first sound on.
            start = next(i for i, v in enumerate(raw) if v) // frame
            lead = next(i for i, v in enumerate(wav.data) if v) // frame
            heard = raw[(start - lead) * frame:]
            self.assertEqual(heard[:len(wav.data)], wav.data, name)
            self.assertEqual(set(heard[len(wav.data):]), {0})

    def test_several_strokes_play_one_after_the_other(self):
        r = self.ok("play", "park2016-1", "park2016-2", "--duration", "0.2")
        self.assertLess(r.stdout.index("park2016-1: played"), r.stdout.index("park2016-2: played"))

    def test_device_and_map_come_from_the_array_file(self):
        self.write("a.toml", '[array]\nname = "a"\ngrid = { rows = 2, columns = 2, pitch_mm = 40.0 }\n'
                             '[output]\npcm = "null"\nchannels = 6\nperiod_frames = 128\nperiods = 4\nrate = 44100\n')
        out = self.ok("play", *self.SHORT, "--array", "a.toml").stdout
        for text in ("6 channels", "44100 Hz", "128", "512"):
            self.assertIn(text, out)

    def test_a_device_that_does_not_exist(self):
        self.refused(3, "play", "park2016-1", "-D", "nowhere", says=["nowhere"])

    def test_a_device_with_other_channels_says_what_it_can(self):
        self.refused(3, "play", "park2016-1", "-D", "eight", says=["9", "8", "channels"])
        self.ok("play", "--path", "M 0 0 L 60 0", "--duration", "0.2", "--array", "palm-2x4", "-D", "eight")

    def test_ctrl_c_fades_out_and_exits_130(self):
        for number, status in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            p = subprocess.Popen([TOOL, "play", "--path", "M 0 10 L 40 30", "--duration", "3600", "-D",
                                  f"raw:{self.dir}/out.raw", "--sample-format", "s16", "--level-dbfs", "0"],
                                 cwd=self.dir, env=self.env, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            self.assertIn(b"9 channels", p.stdout.readline())
            # It sounds when more than the first block has been flushed to the file.
            while not (self.dir / "out.raw").exists() or (self.dir / "out.raw").stat().st_size < 200000:
                self.assertIsNone(p.poll())
            p.send_signal(number)
            p.communicate(timeout=30)
            self.assertEqual(p.returncode, status)
            raw = memoryview((self.dir / "out.raw").read_bytes()).cast("h")
            self.assertEqual(set(raw[-9:]), {0})
            steps = [max(abs(raw[i] - raw[i - 9]) for i in range(k, min(k + 9000, len(raw))))
                     for k in range(9, len(raw), 9000)]
            # A full-scale carrier of 250 Hz moves by at most 2 pi 250 / 48000 of full scale in a frame.
            self.assertLessEqual(max(steps), 32768 * 0.0328)
            (self.dir / "out.raw").unlink()

    def test_output_is_plain_when_piped_and_a_picture_on_a_terminal(self):
        self.assertNotIn("\033", self.ok("play", *self.SHORT).stdout)

        def on_terminal(**more):
            primary, secondary = pty.openpty()
            p = subprocess.Popen([TOOL, "play", *self.SHORT], cwd=self.dir, env=self.env | more, stdout=secondary,
                                 stderr=subprocess.DEVNULL)
            os.close(secondary)
            seen = b""
            while True:
                try:
                    block = os.read(primary, 65536)
                except OSError:
                    break
                if not block:
                    break
                seen += block
            os.close(primary)
            self.assertEqual(p.wait(), 0)
            return seen.decode()

        picture = on_terminal(TERM="xterm")
        self.assertRegex(picture, re.escape("\033[?25l"))
        self.assertGreater(picture.rindex("\033[?25h"), picture.rindex("\033[?25l"))
        self.assertNotIn("\033", on_terminal(TERM="xterm", NO_COLOR="1"))


if __name__ == "__main__":
    main()
