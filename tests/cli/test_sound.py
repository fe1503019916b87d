# SPDX-License-Identifier: MIT
"""Carriers, envelopes and scales: options, stroke files and plans."""
import math
import os

from harness import ToolTest, Wav, main, wav_bytes

LINE = ("--path", "M 0 0 L 40 0", "--duration", "0.7")
WAVES = ("square", "triangle", "sawtooth", "noise:50-500")
STROKE = '[stroke]\npath = "M 0 0 L 40 0"\nduration_s = 0.7\n'
CURVED = """
[array]
name = "measured"
grid = { rows = 1, columns = 3, pitch_mm = 20.0 }
"""


class Sound(ToolTest):
    def wave(self, name="grain.wav", **more):
        (self.dir / name).write_bytes(wav_bytes([math.sin(2 * math.pi * i / 40) * (1 - i / 400) for i in range(400)], **more))
        return name

    def rendered(self, *args, name="x.wav"):
        self.ok("render", *args, "-o", name)
        return Wav(self.dir / name)

    def same_from_plan(self, *args):
        direct = self.rendered(*args)
        self.write("plan.json", self.ok("plan", *args, "--format", "json").stdout)
        self.assertEqual(self.rendered("plan.json", name="y.wav").data, direct.data, args)
        self.assertEqual(self.ok("plan", "plan.json", "--format", "json").stdout, (self.dir / "plan.json").read_text(), args)
        return direct

    def test_each_wave_is_different_and_keeps_the_level(self):
        seen = {self.rendered(*LINE).data}
        for extra in [("--waveform", w) for w in WAVES] + [("--am", "30"), ("--am", "30:0.5")]:
            wav = self.same_from_plan(*LINE, *extra)
            self.assertNotIn(wav.data, seen)
            seen.add(wav.data)
            peak = max(abs(v) for frame in wav.samples() for v in frame)
            self.assertLessEqual(peak, 10 ** (-12 / 20) * (1 + 1e-6))
        self.same_from_plan("park2016-1", "--algorithm", "continuous", "--waveform", "square", "--am", "7:1")

    def test_an_explicit_sine_has_the_same_bytes(self):
        plain = self.rendered("park2016-3")
        self.assertEqual(self.rendered("park2016-3", "--waveform", "sine", "--am", "0", "--intensity-scale", "linear").data, plain.data)
        self.assertEqual(self.rendered("park2016-3", "--envelope", "raised-cosine").data, plain.data)

    def test_an_intensity_above_1_is_refused_until_the_recorders_scale_is_said(self):
        self.write("track.csv", "t_s,x_mm,y_mm,intensity\n0,5,5,255\n1,35,35,128\n")
        self.write("track.toml", "[stroke]\ntimed = [[0, 5, 5, 255], [1, 35, 35, 128]]\n")
        for name, where in (("track.csv", "2:7"), ("track.toml", "2:20")):
            self.refused(2, "plan", name, says=(f"{name}:{where}: intensity 255 is above 1", "--intensity-max 255 for 8 bits"))
            wav = self.same_from_plan(name, "--algorithm", "continuous", "--level-dbfs", "-60", "--intensity-max", "255")
            peak = max(abs(v) for frame in wav.samples() for v in frame)
            self.assertLessEqual(peak, 10 ** (-60 / 20) * (1 + 1e-6))
            self.assertGreater(peak, 10 ** (-66 / 20))

    def test_a_plan_finds_its_recording_beside_itself(self):
        self.wave()
        self.write("plan.json", self.ok("plan", *LINE, "--waveform", "grain.wav", "--format", "json").stdout)
        before = self.rendered("plan.json").data
        (self.dir / "there").mkdir()
        for name in ("grain.wav", "plan.json"):
            (self.dir / name).rename(self.dir / "there" / name)
        self.assertEqual(self.rendered("there/plan.json").data, before)
        (self.dir / "there/grain.wav").write_bytes(wav_bytes([0.0, 1.0, -1.0]))
        self.assertEqual(self.run_tool("render", "there/plan.json", "-o", "x.wav").returncode, 2)

    def test_a_pipe_is_no_recording(self):
        os.mkfifo(self.dir / "grain.wav")
        self.refused(2, "plan", *LINE, "--waveform", "grain.wav", says=("grain.wav: is a pipe (name a WAV file",))

    def test_noise_has_a_seed(self):
        args = (*LINE, "--waveform", "noise:80-300")
        one = self.rendered(*args)
        self.assertEqual(self.rendered(*args, "--noise-seed", "1").data, one.data)
        self.assertNotEqual(self.same_from_plan(*args, "--noise-seed", "9007199254740991").data, one.data)

    def test_a_wav_file_is_a_cycle_or_a_texture(self):
        self.wave()
        seen = set()
        for extra in ((), ("--texture", "time"), ("--texture", "length"), ("--texture", "length", "--texture-mm", "5")):
            seen.add(self.same_from_plan(*LINE, "--waveform", "grain.wav", *extra).data)
        self.assertEqual(len(seen), 4)

    def test_stroke_files_choose_their_wave(self):
        self.wave("beside.wav")
        for keys, options in (('waveform = "square"', ("--waveform", "square")),
                              ("am_hz = 20\nam_depth = 0.5", ("--am", "20:0.5")),
                              ('waveform = "noise:50-300"\nnoise_seed = 7', ("--waveform", "noise:50-300", "--noise-seed", "7")),
                              ('waveform = "beside.wav"\ntexture = "length"\ntexture_mm = 10.0',
                               ("--waveform", "beside.wav", "--texture", "length", "--texture-mm", "10"))):
            file = self.write("own.toml", STROKE + keys)
            self.assertEqual(self.rendered("own.toml").data, self.rendered(*LINE, *options).data, keys)
            # A stroke's own value wins.
            other = "triangle" if "waveform" in keys else "sine"
            self.assertEqual(self.rendered("own.toml", "--waveform", other).data, self.rendered("own.toml").data, file)

    def test_the_carrier_may_change_along_the_path(self):
        self.write("rise.toml", STROKE + "carrier_profile = [[0, 100], [0.5, 100], [1, 300]]")
        plan = self.plan("rise.toml")
        self.assertEqual(plan["stroke"]["course"], [{"t_s": 0, "hz": 100}, {"t_s": 0.35, "hz": 100}, {"t_s": 0.7, "hz": 300}])
        self.assertEqual(plan["stroke"]["carrier_hz"], 100)
        self.same_from_plan("rise.toml", "--algorithm", "continuous")
        self.same_from_plan("rise.toml", "--waveform", "square")

    def test_an_eased_carrier_is_bent_and_a_plan_keeps_that(self):
        self.write("eased.toml", STROKE + 'easing = "minimum-jerk"\ncarrier_profile = [[0, 100], [1, 300]]')
        course = self.plan("eased.toml")["stroke"]["course"]
        self.assertEqual([(p["t_s"], p["hz"], "bend" in p) for p in course], [(0, 100, True), (0.7, 300, False)])
        self.same_from_plan("eased.toml", "--algorithm", "continuous")

    def test_gaussian_warns_where_tactors_are_too_far_apart_for_it(self):
        for pitch, told in (("20.0", False), ("[20.0, 40.0]", True)):
            self.write("grid.toml", f'[array]\nname = "g"\ngrid = {{ rows = 3, columns = 3, pitch_mm = {pitch} }}\n')
            said = self.ok("plan", "--path", "M 0 20 L 40 20", "--array", "grid.toml", "--phantom", "gaussian").stdout
            self.assertEqual("gaussian spreads by the 20 mm" in said, told, said)

    def test_envelopes_are_rendered_and_kept_in_plans(self):
        seen = {self.rendered(*LINE).data}
        for extra in (("--envelope", "linear", "--attack", "0.01"), ("--envelope", "exponential", "--attack", "0.01", "--release", "0.02"),
                      ("--attack", "0.01", "--release", "0.02"), ("--envelope", "tukey"), ("--envelope", "tukey:0.25")):
            data = self.same_from_plan(*LINE, *extra).data
            self.assertNotIn(data, seen)
            seen.add(data)
        burst = self.plan(*LINE, "--envelope", "tukey:0.5")["bursts"][0]
        self.assertAlmostEqual(burst["ramp_s"], 0.25 * burst["duration_s"])

    def test_the_threshold_at_the_carrier_counts(self):
        points = "".join(f"[[tactor]]\ntactor = {i}\nthreshold_dbfs = [[100, -20], [250, -41.0]]\n" for i in range(3))
        self.write("measured.toml", CURVED + points)
        for carrier, threshold in ((50, -20), (100, -20), (250, -41), (400, -41), (math.sqrt(100 * 250), -30.5)):
            args = (*LINE, "--array", "measured.toml", "--sl", "7", "--carrier", repr(float(carrier)))
            peaks = self.plan(*args)["render"]["peak_dbfs"]
            for peak in peaks:
                self.assertAlmostEqual(peak, threshold + 7, places=9)
            greatest = max(abs(frame[0]) for frame in self.same_from_plan(*args).samples())
            self.assertAlmostEqual(20 * math.log10(greatest), threshold + 7, delta=0.15)
        self.write("rise.toml", STROKE + "carrier_profile = [[0, 250], [1, 100]]")
        for algorithm in ("park2016", "continuous"):
            samples = self.same_from_plan("rise.toml", "--array", "measured.toml", "--sl", "7", "--algorithm", algorithm).samples()
            at_end = max(abs(frame[2]) for frame in samples)
            self.assertAlmostEqual(20 * math.log10(at_end), -13, delta=2.0)
        self.refused(2, "plan", "rise.toml", "--array", "measured.toml", "--sl", "21")

    def test_half_as_strong_follows_the_scale(self):
        self.write("half.toml", STROKE + "intensity = 0.5\n")
        greatest = lambda *args: max(d["amplitude"] for b in self.plan("half.toml", *args)["bursts"] for d in b["drives"])
        self.assertAlmostEqual(greatest(), 0.5)
        self.assertAlmostEqual(greatest("--intensity-scale", "stevens"), 0.5 ** (1 / 0.6))
        self.assertAlmostEqual(greatest("--intensity-scale", "stevens", "--stevens-exponent", "0.95"), 0.5 ** (1 / 0.95))
        points = "".join(f"[[tactor]]\ntactor = {i}\nthreshold_dbfs = -40\n" for i in range(3))
        self.write("measured.toml", CURVED + points)
        sl = ("--array", "measured.toml", "--sl", "20", "--intensity-scale", "sl")
        self.assertAlmostEqual(greatest(*sl), 10 ** (-10 / 20))
        self.same_from_plan("half.toml", *sl)
        self.same_from_plan("half.toml", "--intensity-scale", "stevens", "--algorithm", "continuous")

    def test_bad_options_have_hints(self):
        self.wave("stereo.wav", channels=2)
        (self.dir / "no.wav").write_bytes(b"RIFFxxxxAVI ")
        (self.dir / "cut.wav").write_bytes(wav_bytes([0.5, -0.5])[:30])
        (self.dir / "odd.wav").write_bytes(wav_bytes([0.5, -0.5], tag=7))
        (self.dir / "still.wav").write_bytes(wav_bytes([0.0] * 8))
        for args, says in ((("--waveform", "sqare"), ["--waveform", "sqare", "noise:LO-HI"]),
                           (("--waveform", "noise"), ["--waveform"]),
                           (("--waveform", "noise:5"), ["noise:50-500"]),
                           (("--waveform", "noise:500-50"), ["noise from 500 to 50"]),
                           (("--waveform", "noise:50-30000"), ["half the rate"]),
                           (("--waveform", "none.wav"), ["none.wav"]),
                           (("--waveform", "stereo.wav"), ["2 channels"]),
                           (("--waveform", "no.wav"), ["no WAV file"]),
                           (("--waveform", "cut.wav"), ["cut.wav"]),
                           (("--waveform", "odd.wav"), ["format 7"]),
                           (("--waveform", "still.wav"), ["silence"]),
                           (("--am", "x"), ["--am", "30:0.5"]),
                           (("--am", "30:"), ["--am"]),
                           (("--am", "30:2"), ["--am", "depth"]),
                           (("--am", "-3"), ["--am"]),
                           (("--am", "23900"), ["--am"]),
                           (("--noise-seed", "3"), ["--noise-seed", "noise:LO-HI"]),
                           (("--waveform", "noise:50-500", "--noise-seed", "-1"), ["--noise-seed"]),
                           (("--texture", "time"), ["--texture", "FILE.wav"]),
                           (("--texture", "x"), ["--texture", "cycle, time, length"]),
                           (("--texture-mm", "3"), ["--texture-mm"]),
                           (("--envelope", "round"), ["--envelope", "raised-cosine"]),
                           (("--envelope", "linear:3"), ["--envelope", "tukey"]),
                           (("--envelope", "tukey:3"), ["--envelope"]),
                           (("--envelope", "tukey", "--attack", "0.01"), ["--attack", "--envelope tukey"]),
                           (("--attack", "10ms"), ["--attack", "as 0.01"]),
                           (("--release", "-1"), ["--release"]),
                           (("--intensity-scale", "log"), ["--intensity-scale", "stevens"]),
                           (("--intensity-scale", "sl"), ["--intensity-scale", "--sl"]),
                           (("--stevens-exponent", "0.6"), ["--stevens-exponent", "--intensity-scale stevens"]),
                           (("--intensity-scale", "stevens", "--stevens-exponent", "0"), ["--stevens-exponent"])):
            with self.subTest(args=args):
                self.refused(2, "render", *LINE, *args, "-o", "bad.wav", says=says)
                self.assertFalse((self.dir / "bad.wav").exists())

    def test_a_fault_of_a_file_does_not_name_an_option(self):
        for keys, says in (('carrier_profile = [[0, 30000]]', "bad.toml:4:19: carrier_profile: 30000 Hz cannot be rendered"),
                           ('carrier_profile = [[0, 100], [1, 24000]]', "bad.toml:4:19: carrier_profile: 24000 Hz cannot be rendered"),
                           ('carrier_profile = [[0, 100], [1, 23990]]\nam_hz = 20', "carrier_profile: with its modulation 24010 Hz"),
                           ('carrier_hz = 30000', "bad.toml:4:14: carrier_hz: 30000 Hz"),
                           ('waveform = "noise:10-90000"', "bad.toml:4:12: waveform: 90000 Hz cannot be rendered"),
                           ('fit = true\nfit_margin_mm = 30', "bad.toml: fit_margin_mm: 30 mm on each side leave no space")):
            with self.subTest(keys=keys):
                self.write("bad.toml", STROKE + keys + "\n")
                self.refused(2, "render", "bad.toml", "-o", "bad.wav", says=[says])

    def test_bad_keys_have_their_line(self):
        for key in ('waveform = "sqare"', 'waveform = ""', "waveform = 3", 'waveform = "noise:1-"', 'waveform = "gone.wav"',
                    'am_hz = "x"', "am_hz = -1", "am_depth = 0.5", "am_hz = 3\nam_depth = 2", "noise_seed = 3",
                    'waveform = "noise:50-500"\nnoise_seed = 1.5', 'texture = "time"', 'waveform = "square"\ntexture_mm = 3',
                    "carrier_profile = []", "carrier_profile = [[0, 100], [0, 200]]", "carrier_profile = [[0, 0]]",
                    "carrier_profile = [[2, 100]]", "carrier_profile = [3]", "carrier_hz = 100\ncarrier_profile = [[0, 100]]"):
            with self.subTest(key=key):
                self.write("bad.toml", STROKE + key + "\n")
                self.refused(2, "plan", "bad.toml")
        for key in ("[]", "[[100, -20], [100, -30]]", "[[100]]", "[[0, -3]]", "[[100, 3]]", '"x"'):
            with self.subTest(threshold=key):
                self.write("a.toml", CURVED + f"[[tactor]]\ntactor = 0\nthreshold_dbfs = {key}\n")
                self.refused(2, "plan", *LINE, "--array", "a.toml")
        self.write("a.toml", CURVED + "[[tactor]]\ntactor = 0\nrise_ms = 0\n")
        self.refused(2, "plan", *LINE, "--array", "a.toml")
        self.refused(2, "plan", "-", stdin='[stroke]\npath = "M 0 0 L 40 0"\nwaveform = "x.wav"\n')

    def test_they_may_be_defaults(self):
        self.write("c.toml", '[defaults]\nwaveform = "square"\nam = "20:0.5"\nenvelope = "linear"\nattack = 0.01\n'
                             'intensity-scale = "stevens"\nstevens-exponent = 0.9\n')
        options = ("--waveform", "square", "--am", "20:0.5", "--envelope", "linear", "--attack", "0.01", "--intensity-scale", "stevens",
                   "--stevens-exponent", "0.9")
        self.assertEqual(self.rendered(*LINE, "--config", "c.toml").data, self.rendered(*LINE, *options).data)
        for line in ('waveform = "sqare"', 'waveform = "noise:300.5-20"', "waveform = 3", 'am = "x"', 'envelope = "x"', "attack = -1", 'intensity-scale = "x"'):
            self.write("c.toml", f"[defaults]\n{line}\n")
            self.refused(2, "plan", *LINE, "--config", "c.toml")

    def test_slow_actuators_get_more_at_first(self):
        self.write("slow.toml", CURVED + "[[tactor]]\ntactor = 0\nrise_ms = 20\n")
        self.write("fast.toml", CURVED)
        slow = self.same_from_plan(*LINE, "--array", "slow.toml").samples()
        fast = self.rendered(*LINE, "--array", "fast.toml").samples()
        greatest = lambda wav, c: max(abs(frame[c]) for frame in wav)
        self.assertGreater(greatest(slow, 0), 2 * greatest(fast, 0))
        self.assertLessEqual(greatest(slow, 0), 1.0)
        self.assertEqual([frame[1:] for frame in slow], [frame[1:] for frame in fast])

    def test_check_knows_slow_actuators(self):
        self.write("slow.toml", CURVED + "[[tactor]]\ntactor = 1\nrise_ms = 60\n")
        said = self.run_tool("check", "--array", "slow.toml")
        self.assertIn("rise_ms is up to 60", said.stdout + said.stderr)


if __name__ == "__main__":
    main()
