# SPDX-License-Identifier: MIT
"""tactor render: samples as a reader of the plan's JSON computes them, and what sounds; test_output.py has the files."""
import json
import math
import os

import record
from harness import ToolTest, Wav, main, wav_bytes
from record import PAIR, STROKES

RATE = ("--rate", "8000")
LINE = ("--path", "M 0 0 L 40 0", "--duration", "0.4", *RATE, "--carrier", "130")
STROKE = '[stroke]\npath = "M 0 0 L 40 0"\nduration_s = 0.5\n'
ROW = '[array]\nname = "row"\ngrid = { rows = 1, columns = 3, pitch_mm = 20.0 }\n'
SLOW = "[[tactor]]\ntactor = 0\nrise_ms = 20\n[[tactor]]\ntactor = 1\nrise_ms = 50\nmax_dbfs = -10\ngain_db = -2\n"
CURVED = "".join(f"[[tactor]]\ntactor = {i}\nthreshold_dbfs = [[100, -20], [250, -41.0]]\n" for i in range(3))
BRUSH = ("--array", "grid.toml", "--algorithm", "tactile-brush", "--path", "M 10 30 L 45 10", "--duration", "1")


class RenderTest(ToolTest):
    def setUp(self):
        super().setUp()
        for name, text in (("pair.toml", PAIR), ("strokes.toml", STROKES), ("slow.toml", ROW + SLOW), ("curved.toml", ROW + CURVED),
                           ("grid.toml", '[array]\nname = "a"\ngrid = { rows = 3, columns = 4, pitch_mm = 15.0 }\n'),
                           ("rise.toml", STROKE + "carrier_profile = [[0, 90], [0.4, 90], [1, 300]]\n"),
                           ("squares.toml", "[defaults]\nstevens-exponent = 2\n"),
                           ("soft.csv", "t_s,x_mm,y_mm,intensity\n0,10,30,0.4\n1,45,10,0.4\n"),
                           ("touch.csv", "t_s,x_mm,y_mm,intensity\n12.5,0,10,1\n13,20,10,0.25\n13.5,40,30,0.5\n")):
            self.write(name, text)

    def rendered(self, *args):
        self.ok("render", *args, "-o", "o.wav")
        return Wav(self.dir / "o.wav")

    def from_json(self, *args, recording=None):
        return record.samples(json.loads(self.ok("plan", *args, "--format", "json").stdout), recording)


class Samples(RenderTest):
    # Ways to sound, and how far a sample may be from the formula: half a step of a float, or what a search for a wave's peak misses.
    SINE, WAVE = 4e-8, 6e-5
    CASES = (
        (SINE, ("park2016-1",)),
        (SINE, ("park2016-3", "--phase", "burst", *RATE)),
        (SINE, ("park2016-1", "--ramp", "0.0051", "--level-dbfs", "-3.25", *RATE)),
        (SINE, ("park2016-2", "--soa", "0.0613", "--phase", "burst", "--rate", "22050")),
        (SINE, (*BRUSH, "--phase", "burst", *RATE)),
        (SINE, (*BRUSH, "--overlap", "max", "--carrier", "243", *RATE)),
        (SINE, (*BRUSH, "--overlap", "sum", *RATE)),
        (SINE, (*BRUSH[:4], "soft.csv", "--intensity-scale", "stevens", "--config", "squares.toml", *RATE)),
        (SINE, ("park2016-1", "--algorithm", "continuous", "--carrier", "251", "--phantom", "gaussian", *RATE)),
        (SINE, ("strokes.toml", "--array", "pair.toml", "--level-dbfs", "-20", *RATE)),
        (SINE, ("strokes.toml", "--array", "pair.toml", "--sl", "7", "--phase", "burst", "--rate", "11025")),
        (SINE, ("park2016-2", "--compensate", "low-speed", *RATE)),
        (SINE, ("touch.csv", *RATE)),
        (SINE, (*LINE, "--attack", "0.01", "--release", "0.03")),
        (SINE, (*LINE, "--envelope", "linear", "--attack", "0.02")),
        (SINE, (*LINE, "--envelope", "exponential", "--attack", "0.01", "--release", "0.03")),
        (SINE, (*LINE, "--envelope", "tukey:0.7")),
        (SINE, (*LINE, "--am", "23:0.5", "--phase", "burst")),
        (SINE, (*LINE, "--array", "slow.toml", "--attack", "0.004")),
        (SINE, (*LINE, "--array", "slow.toml", "--level-dbfs", "-30")),
        (SINE, (*LINE, "--array", "curved.toml", "--sl", "7")),
        (SINE, ("rise.toml", "--array", "curved.toml", "--sl", "7", *RATE)),
        (SINE, ("rise.toml", *RATE)),
        (SINE, ("rise.toml", "--phase", "burst", *RATE)),
        (SINE, ("rise.toml", "--algorithm", "continuous", *RATE)),
        (WAVE, ("rise.toml", "--waveform", "sawtooth", *RATE)),
        (WAVE, (*LINE, "--waveform", "square")),
        (WAVE, (*LINE, "--waveform", "triangle")),
        (WAVE, (*LINE, "--waveform", "square", "--am", "300")),
        (WAVE, (*LINE, "--waveform", "noise:60-75", "--noise-seed", "7")),
    )

    def check(self, tolerance, *args, recording=None):
        with self.subTest(args=args):
            wanted, found = self.from_json(*args, recording=recording), list(zip(*self.rendered(*args).samples(), strict=True))
            self.assertEqual([len(c) for c in wanted], [len(c) for c in found])
            self.assertGreater(max(map(max, wanted)), 0.003)
            self.assertLess(max(abs(a - b) for x, y in zip(wanted, found) for a, b in zip(x, y)), tolerance)

    def test_samples_follow_from_the_json_of_the_plan(self):
        for tolerance, args in self.CASES:
            self.check(tolerance, *args)

    def test_so_do_those_of_recordings(self):
        values = [round(32767 * math.sin(2 * math.pi * i / 40) * (1 - i / 400)) for i in range(400)]
        self.write("r.wav", wav_bytes([v / 32767 for v in values], rate=8000))
        line = (*LINE[:-1], "20", "--waveform", "r.wav")
        for more in ((), ("--texture", "time"), ("--texture", "length", "--texture-mm", "15")):
            self.check(self.WAVE, *line, *more, recording=[v / 32768 for v in values])

    def test_each_format_has_them_to_half_a_step(self):
        wanted = self.from_json("park2016-1")
        for name, tag, bits in (("float", 3, 32), ("s16", 1, 16), ("s24", 1, 24), ("s32", 1, 32)):
            wav = self.rendered("park2016-1", "--sample-format", name)
            self.assertEqual((wav.tag, wav.bits, wav.channels, wav.rate, wav.frames), (tag, bits, 9, 48000, 70560))
            worst = max(abs(a - b) for x, y in zip(wanted, zip(*wav.samples())) for a, b in zip(x, y))
            self.assertLess(worst, 2e-8 if tag == 3 else 0.5000001 / 2 ** (bits - 1))

    def test_options_are_recorded(self):
        render = self.plan("park2016-1", "--rate", "44100", "--ramp", "0.003", "--level-dbfs", "-9.5", "--phase", "burst",
                           "--overlap", "max")["render"]
        self.assertEqual(render, {"rate": 44100, "channels": 9, "frames": 64827, "phase": "burst", "ramp_s": 0.003,
                                  "level_dbfs": -9.5, "overlap": "max", "peak_dbfs": [-9.5] * 9, "marker": None})
        first, second, third = self.plan("strokes.toml", "--array", "pair.toml", "--sl", "7", "--together", "sum")["plans"]
        self.assertEqual((first["render"]["peak_dbfs"], first["render"]["sl_db"], first["render"]["ramp_s"]), ([-34.5, -23.0], 7.0, None))
        self.assertNotIn("level_dbfs", first["render"])
        self.assertEqual(first["render"]["marker"], {"channel": 3, "duration_s": 0.005})
        self.assertEqual([p["start_frame"] for p in (first, second, third)], [4800, 4800 + 26880, 14400])
        self.assertEqual(first["render"], third["render"])
        for more, ramps in (((), {0.0}), (("--carrier", "255"), {0.0, 0.002}), (("--envelope", "tukey:0.5"), {0.0175})):
            self.assertLessEqual({round(b["ramp_s"], 9) for b in self.plan("park2016-1", *more)["bursts"]}, ramps)


class Together(RenderTest):
    def setUp(self):
        super().setUp()
        self.write("cross.toml", "".join(f'[[stroke]]\nstart_s = 0.0\npath = "{path}"\nduration_s = 1.4\n'
                                         for path in ("M 0 20 H 40", "M 40 20 H 0", "M 20 0 V 40")))

    def peaks_dbfs(self, *args):
        peaks = [max(map(abs, channel)) for channel in zip(*self.rendered("cross.toml", *args).samples())]
        return [20 * math.log10(p) if p else -math.inf for p in peaks]

    def test_strokes_that_meet_are_no_louder_than_the_level(self):
        for how in ((), ("--algorithm", "continuous")):
            with self.subTest(how):
                peaks = self.peaks_dbfs("--level-dbfs", "-40", *how)
                self.assertAlmostEqual(max(peaks), -40, delta=0.02)  # a crest of the carrier is near the crest of the sum
                self.assertLessEqual(max(peaks), -40 + 1e-5)
                self.assertEqual(peaks.index(max(peaks)), 4)
                as_is = self.peaks_dbfs("--level-dbfs", "-40", "--together", "sum", *how)
                self.assertAlmostEqual(as_is[4], -40 + 20 * math.log10(3), delta=0.02)
                for weak, strong in zip(peaks, as_is):
                    self.assertTrue(weak == strong == -math.inf or abs(strong - weak - 20 * math.log10(3)) < 0.01)

    def test_it_is_said_by_how_much_and_where(self):
        said = "cross.toml: weakened by 9.54 dB: strokes 1, 2 and 3 meet on tactor 4 at 0.7 s (use --together sum to let strokes add up)"
        for args in (("render", "cross.toml", "-o", "o.wav"), ("plan", "cross.toml", "--format", "csv"),
                     ("plot", "cross.toml", "--view", "wave", "-o", "o.svg")):
            self.assertIn(said, self.ok(*args).stderr)
        self.assertIn(said.partition(": ")[2], self.ok("plan", "cross.toml").stdout)
        plans = self.plan("cross.toml")["plans"]
        for plan in plans:
            self.assertAlmostEqual(plan["weakened_db"], -20 * math.log10(3), 6)
            self.assertEqual(plan["meets"], {"tactor": 4, "at_s": plan["meets"]["at_s"], "strokes": [0, 1, 2]})
            self.assertAlmostEqual(plan["meets"]["at_s"], 0.7, 3)
            self.assertAlmostEqual(plan["render"]["peak_dbfs"][4], -12 - 20 * math.log10(3), 6)
        alone = self.plan("park2016-1")
        self.assertEqual(alone["weakened_db"], 0)
        self.assertNotIn("meets", alone)
        self.assertEqual(self.ok("render", "park2016-1", "-o", "o.wav").stderr, "")
        # Strokes that add up keep their sum in the plan, too.
        self.write("sum.json", self.ok("plan", "cross.toml", "--together", "sum", "--level-dbfs", "-40", "--format", "json").stdout)
        self.assertEqual([p["weakened_db"] for p in self.plan("sum.json")["plans"]], [0, 0, 0])
        self.assertAlmostEqual(self.plan("sum.json", "--together", "weaken")["plans"][0]["weakened_db"], -20 * math.log10(3), 6)

    def test_a_sum_is_held_to_the_limits(self):
        self.write("limited.toml", '[array]\npreset = "palm-3x3"\n[[tactor]]\ntactor = 4\nmax_dbfs = -31\n')
        self.refused(2, "render", "cross.toml", "--array", "limited.toml", "--level-dbfs", "-40", "--together", "sum", "-o", "o.wav",
                     says=["limited.toml:3:1: tactor 4 would play at -30.46 dBFS"])
        self.ok("render", "cross.toml", "--array", "limited.toml", "--level-dbfs", "-40", "-o", "o.wav")

    def test_a_stroke_s_own_level_is_at_most_that_asked_for(self):
        self.write("loud.toml", STROKE + "level_db = 28\n")
        for command in (("render", "-o", "o.wav"), ("plan",), ("play", "-D", "null")):
            self.refused(2, command[0], "loud.toml", *command[1:], "--level-dbfs", "-40",
                         says=["loud.toml:4:12: level_db is 28 (use -120 to 0)"])


class Sound(RenderTest):
    def test_usual_values_have_the_same_bytes(self):
        plain = self.rendered("park2016-3").data
        for more in (("--waveform", "sine", "--am", "0", "--intensity-scale", "linear", "--envelope", "raised-cosine"), ("--compensate", "none")):
            self.assertEqual(self.rendered("park2016-3", *more).data, plain)
        noise = (*LINE, "--waveform", "noise:80-300")
        self.assertEqual(self.rendered(*noise, "--noise-seed", "1").data, self.rendered(*noise).data)

    def test_an_intensity_above_1_is_refused_until_the_recorders_scale_is_said(self):
        self.write("track.csv", "t_s,x_mm,y_mm,intensity\n0,5,5,255\n1,35,35,128\n")
        self.write("track.toml", "[stroke]\ntimed = [[0, 5, 5, 255], [1, 35, 35, 128]]\n")
        for name in ("track.csv", "track.toml"):
            self.refused(2, "plan", name)
            samples = self.rendered(name, "--algorithm", "continuous", "--level-dbfs", "-60", "--intensity-max", "255").samples()
            self.assertAlmostEqual(20 * math.log10(max(abs(v) for f in samples for v in f)), -60, delta=6)

    def test_stroke_files_and_defaults_choose_their_wave(self):
        self.write("beside.wav", wav_bytes([math.sin(2 * math.pi * i / 40) * (1 - i / 400) for i in range(400)]))
        for keys, options in (('waveform = "square"', ("--waveform", "square")), ("am_hz = 20\nam_depth = 0.5", ("--am", "20:0.5")),
                              ('waveform = "noise:50-300"\nnoise_seed = 7', ("--waveform", "noise:50-300", "--noise-seed", "7")),
                              ('waveform = "beside.wav"\ntexture = "length"\ntexture_mm = 10.0',
                               ("--waveform", "beside.wav", "--texture", "length", "--texture-mm", "10"))):
            self.write("own.toml", STROKE + keys)
            own = self.rendered("own.toml").data
            self.assertEqual(self.rendered(*LINE[:2], "--duration", "0.5", *options).data, own, keys)
            # A stroke's own value wins.
            self.assertEqual(self.rendered("own.toml", "--waveform", "triangle" if "waveform" in keys else "sine").data, own)
        self.write("c.toml", '[defaults]\nwaveform = "square"\nam = "20:0.5"\nenvelope = "linear"\nattack = 0.01\n')
        options = ("--waveform", "square", "--am", "20:0.5", "--envelope", "linear", "--attack", "0.01")
        self.assertEqual(self.rendered(*LINE, "--config", "c.toml").data, self.rendered(*LINE, *options).data)

    def test_a_recording_that_is_cut_short_gives_a_warning(self):
        self.write("r.wav", wav_bytes([math.sin(i / 6) for i in range(400)])[:44 + 2 * 100])
        for command in (("plan",), ("render", "-o", "x.wav"), ("plot", "-o", "x.svg")):
            said = self.ok(command[0], *LINE[:2], "--waveform", "r.wav", "--carrier", "20", *command[1:])
            self.assertIn("r.wav: the recording is incomplete: it has 100 of 400 samples", said.stdout + said.stderr)

    def test_impossible_sounds_are_refused(self):
        self.write("stereo.wav", wav_bytes([0.5, -0.5] * 40, channels=2))
        self.write("no.wav", b"RIFFxxxxAVI ")
        self.write("cut.wav", wav_bytes([0.5, -0.5])[:30])
        self.write("odd.wav", wav_bytes([0.5, -0.5], tag=7))
        self.write("still.wav", wav_bytes([0.0] * 8))
        os.mkfifo(self.dir / "pipe.wav")
        for options in ("--waveform sqare", "--waveform noise", "--waveform noise:5", "--waveform noise:500-50", "--waveform noise:50-30000",
                        "--waveform none.wav", "--waveform stereo.wav", "--waveform no.wav", "--waveform cut.wav", "--waveform odd.wav",
                        "--waveform still.wav", "--waveform pipe.wav", "--am x", "--am 30:", "--am 30:2", "--am -3", "--am 23900",
                        "--noise-seed 3", "--waveform noise:50-500 --noise-seed -1", "--texture time", "--texture x", "--texture-mm 3",
                        "--envelope round", "--envelope linear:3", "--envelope tukey:3", "--envelope tukey --attack 0.01", "--attack 10ms",
                        "--release -1", "--intensity-scale log", "--intensity-scale sl", "--phase continuous", "--carrier 24000",
                        "--rate 8000 --carrier 5000", "--level-dbfs 0.5"):
            with self.subTest(options):
                self.refused(2, "render", *LINE[:2], *options.split(), "-o", "bad.wav", says=[options.split()[-2]])
        self.refused(2, "render", *LINE[:2], *self.defaults(stevens_exponent=0), "-o", "bad.wav", says=["stevens-exponent: 0 is out of range"])
        for options in ("--sl 7", "--array curved.toml --carrier 100 --sl 21"):
            self.refused(2, "render", *LINE[:2], *options.split(), "-o", "bad.wav")
        self.assertFalse((self.dir / "bad.wav").exists())

    def test_impossible_sounds_of_files_have_their_place_and_name_no_option(self):
        for key in ('waveform = "sqare"', 'waveform = ""', "waveform = 3", 'waveform = "noise:1-"', 'waveform = "gone.wav"', 'am_hz = "x"',
                    "am_hz = -1", "am_depth = 0.5", "am_hz = 3\nam_depth = 2", "noise_seed = 3", 'waveform = "noise:50-500"\nnoise_seed = 1.5',
                    'texture = "time"', 'waveform = "square"\ntexture_mm = 3', "carrier_profile = []", "carrier_profile = [[0, 100], [0, 200]]",
                    "carrier_profile = [[0, 0]]", "carrier_profile = [[2, 100]]", "carrier_profile = [3]",
                    "carrier_hz = 100\ncarrier_profile = [[0, 100]]", "carrier_profile = [[0, 30000]]",
                    "carrier_profile = [[0, 100], [1, 24000]]", "carrier_profile = [[0, 100], [1, 23990]]\nam_hz = 20", "carrier_hz = 30000",
                    'waveform = "noise:10-90000"', "fit = true\nfit_margin_mm = 30", "level_db = 100", "pauses = [[0.5, 0.3, 2]]"):
            with self.subTest(key=key):
                self.write("bad.toml", STROKE + key + "\n")
                self.assertNotIn("--", self.refused(2, "plan", "bad.toml").stderr)
        for key in ("threshold_dbfs = []", "threshold_dbfs = [[100, -20], [100, -30]]", "threshold_dbfs = [[100]]", "threshold_dbfs = [[0, -3]]",
                    "threshold_dbfs = [[100, 3]]", 'threshold_dbfs = "x"', "rise_ms = 0", "gain_db = 13.0", "max_dbfs = -20.0"):
            with self.subTest(key=key):
                self.write("bad.toml", f"{ROW}[[tactor]]\ntactor = 0\n{key}\n")
                self.refused(2, "plan", *LINE, "--array", "bad.toml")
        for line in ('waveform = "sqare"', 'waveform = "noise:300.5-20"', 'am = "x"', 'envelope = "x"', "attack = -1", 'intensity-scale = "x"'):
            self.write("c.toml", f"[defaults]\n{line}\n")
            self.refused(2, "plan", *LINE, "--config", "c.toml")
        self.refused(2, "plan", "-", stdin='[stroke]\npath = "M 0 0 L 40 0"\nwaveform = "x.wav"\n')

    def test_the_largest_array_is_rendered_and_played(self):
        self.write("large.toml", '[array]\nname = "large"\ngrid = { rows = 32, columns = 32, pitch_mm = 2 }\n')
        stroke = ("--array", "large.toml", "--path", "M 0 0 L 4 4", "--duration", "0.1")
        self.ok("render", *stroke, "-o", "large.wav")
        self.assertEqual(Wav(self.dir / "large.wav").channels, 1024)
        self.ok("play", *stroke, "-D", "null")


if __name__ == "__main__":
    main()
