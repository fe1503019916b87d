# SPDX-License-Identifier: MIT
"""Stored plans are played, rendered and drawn unchanged, and broken ones refused."""
import copy
import hashlib
import json
import math

from harness import ROOT, ToolTest, main, wav_bytes

DESK = """[array]
name = "desk"
grid = { rows = 3, columns = 3, pitch_mm = 20.0 }
[[tactor]]
tactor = 4
channel = 11
gain_db = -3.3
max_dbfs = -1.5
polarity = -1
[output]
channels = 14
[sync]
channel = 13
"""
HEARD = '[array]\nname = "heard"\ngrid = { rows = 2, columns = 2, pitch_mm = 30.0 }\n' + "".join(
    f"[[tactor]]\ntactor = {i}\nthreshold_dbfs = [[100, {-20.1 - i}], [250, -41.0]]\nrise_ms = 20\n" for i in range(4))
THREE = """[[stroke]]
name = "first"
path = "M 1.1 2.2 L 39 33.3"
duration_s = 0.7123
[[stroke]]
name = "second"
path = "M 1 2 C 20 -1 20 45 40 30"
duration_s = 0.33337
[[stroke]]
name = "third"
points = [[0, 10], [30, 12]]
duration_s = 0.5
start_s = 0.25
carrier_hz = 187.5
"""
WAVED = '[stroke]\npath = "M 0 0 L 30 0"\nduration_s = 0.5\nintensity = 0.5\n'
GRAIN = wav_bytes([math.sin(2 * math.pi * i / 40) * (1 - i / 400) for i in range(400)])


class PlanFile(ToolTest):
    def setUp(self):
        super().setUp()
        for name, text in (("desk.toml", DESK), ("heard.toml", HEARD), ("three.toml", THREE), ("half.toml", WAVED), ("grain.wav", GRAIN),
                           ("rise.toml", WAVED + 'easing = "minimum-jerk"\ncarrier_profile = [[0, 100], [1, 300]]'),
                           ("wide.toml", '[array]\nname = "wide"\ngrid = { rows = 3, columns = 3, pitch_mm = [20.0, 40.0] }\n'),
                           ("arm.toml", '[array]\nname = "arm"\ngrid = { rows = 1, columns = 6, pitch_mm = 35.0 }\n'),
                           ("silent.toml", '[stroke]\npath = "M 0 20 H 40"\nintensity = 0\n')):
            self.write(name, text)

    def stored(self, *args, name="plan.json"):
        self.write(name, self.ok("plan", *args, "--format", "json").stdout)
        return name

    def rendered(self, *args):
        self.ok("render", *args, "-o", "sound.wav")
        return (self.dir / "sound.wav").read_bytes()

    def test_a_plan_renders_the_bytes_of_its_stroke_and_is_the_same_text(self):
        for args in (*(f"park2016-3 --algorithm {a} --phantom {p}" for a in ("park2016", "tactile-brush", "continuous")
                       for p in ("inverse-distance", "barycentric", "linear", "log", "gaussian")),
                     "park2016-1 --algorithm continuous --duration 5.00033", "wave-2x4 --array palm-2x4", "half.toml --algorithm continuous --speed 33",
                     "park2016-1 --array palm-2x4 --fit --fit-margin 1.3", "park2016-3 --array arm.toml --fit",
                     "park2016-3 --rate 44100 --level-dbfs -20.05 --phase burst --ramp 0.0013",
                     "park2016-2 --algorithm tactile-brush --overlap max --carrier 187.5", "park2016-1 --array desk.toml",
                     "half.toml --array heard.toml --sl 7.7", "half.toml --array heard.toml --sl 20 --intensity-scale sl",
                     "half.toml --intensity-scale stevens", "half.toml --intensity-scale stevens --algorithm continuous", "park2016-1 --faces nearest",
                     "park2016-1 --faces nearest --algorithm continuous", "three.toml --rate 44100", "three.toml --algorithm continuous --rate 44100",
                     "rise.toml", "rise.toml --algorithm continuous", "rise.toml --waveform square", "rise.toml --array heard.toml --sl 7",
                     "half.toml --waveform noise:80-300 --noise-seed 9007199254740991", "half.toml --waveform triangle --am 30:0.5",
                     "park2016-1 --algorithm continuous --waveform square --am 7:1", "half.toml --waveform grain.wav",
                     "half.toml --waveform grain.wav --texture time", "half.toml --waveform grain.wav --texture length --texture-mm 5",
                     "half.toml --envelope exponential --attack 0.01 --release 0.02", "half.toml --envelope tukey:0.25", "park2016-1 --compensate low-speed",
                     "silent.toml --compensate low-speed", *(f"{ROOT}/examples/strokes/{name}.toml" for name in ("reach", "knocks"))):
            with self.subTest(args):
                file = self.stored(*args.split())
                self.assertEqual(self.rendered(*args.split()), self.rendered(file))
                self.assertEqual(self.ok("plan", file, "--format", "json").stdout, (self.dir / file).read_text())

    def test_a_fit_across_keeps_its_matrix_to_the_last_digits(self):
        self.write("across.toml", '[array]\nname = "across"\n' + "".join(
            f"[[tactor]]\nx_mm = {11.1 * i}\ny_mm = {-23.4 * i}\nchannel = {i}\n" for i in range(5)))
        first = self.stored("park2016-3", "--array", "across.toml", "--fit")
        matrix = json.loads((self.dir / first).read_text())["stroke"]["fit"]["matrix"]
        again = self.plan(first)["stroke"]["fit"]["matrix"]
        self.assertLess(matrix[1], 0)
        self.assertLess(max(abs(x - y) for x, y in zip(matrix, again)), 1e-12)

    def test_options_of_rendering_win_and_those_of_planning_are_refused(self):
        file = self.stored("park2016-1", "--rate", "44100")
        self.assertEqual(self.rendered(file, "--rate", "48000", "--level-dbfs", "-20"), self.rendered("park2016-1", "--level-dbfs", "-20"))
        for option in ("--soa 0.06", "--algorithm continuous", "--duration 2", "--fit", "--snap", "--carrier 200", "--overlap sum", "--timing fit",
                       "--faces delaunay", "--compensate low-speed"):
            self.refused(2, "render", file, *option.split(), "-o", "x.wav", says=[option.split()[0]])
        self.assertFalse((self.dir / "x.wav").exists())

    def test_defaults_of_planning_do_not_change_a_plan(self):
        file = self.stored("park2016-1")
        plain = self.rendered(file)
        config = self.write("tactor.toml", '[defaults]\nalgorithm = "continuous"\nlevel-dbfs = -30.0\nsoa = 0.06\n')
        palm = self.write("palm.toml", '[array]\nname = "p"\ngrid = { rows = 3, columns = 3, pitch_mm = 20.0 }\n'
                          '[defaults]\nlevel-dbfs = -30.0\nphase = "burst"\nramp = 0.003\n')
        for more in (("--config", config), ("--array", palm)):
            self.assertEqual(self.rendered(file, *more), plain)

    def test_every_command_that_plays_or_draws_takes_a_plan_from_a_file_or_a_pipe(self):
        for algorithm in ("park2016", "continuous"):
            args = ("park2016-1", "--algorithm", algorithm, "--faces", "nearest")
            file = self.stored(*args)
            stored = (self.dir / file).read_text()
            for command in (("plot", "-o", "a.svg"), ("plot", "--view", "wave", "-o", "b.svg"), ("play", "-D", "null")):
                self.ok(*command, file)
                self.ok(*command, "-", stdin=stored)
            self.assertIn("(faces nearest)", (self.dir / "a.svg").read_text())
            self.assertEqual(self.ok("plan", file).stdout, self.ok("plan", *args).stdout)
            self.assertEqual(self.ok("plan", "-", "--format", "json", stdin="\ufeff\n" + stored).stdout, stored)
        self.refused(2, "compare", file)
        self.refused(2, "render", file, "park2016-1", "-o", "x.wav")
        for text in (stored[:700], " {}"):
            self.refused(2, "render", "-", "-o", "x.wav", stdin=text)
        self.refused(2, "compare", "-", stdin=stored)
        self.refused(2, "render", "-", "--phantom", "gaussian", "-o", "x.wav", stdin=stored)
        self.assertFalse((self.dir / "x.wav").exists())

    def test_a_different_array_is_refused(self):
        file = self.stored("park2016-1")
        self.ok("render", file, "--array", "palm-3x3", "-o", "x.wav")
        self.refused(2, "play", file, "--array", "palm-2x4", "-D", "null")
        self.refused(2, "render", file, "--array", "desk.toml", "-o", "y.wav")
        self.refused(2, "render", file, "--config", "wide.toml", "-o", "y.wav")
        self.refused(2, "play", file, self.stored("wave-2x4", "--array", "palm-2x4", name="other.json"), "-D", "null")
        self.assertFalse((self.dir / "y.wav").exists())

    def test_a_plan_names_its_recording_finds_it_beside_itself_and_refuses_another(self):
        file = self.stored("half.toml", "--waveform", "grain.wav")
        plan = json.loads((self.dir / file).read_text())
        self.assertEqual(plan["stroke"]["recording"], {"file": str((self.dir / "grain.wav").resolve()), "sha256": hashlib.sha256(GRAIN).hexdigest(),
                                                       "frames": 400, "rate": 8000})
        before = self.rendered(file)
        for key, value in (("frames", 399), ("rate", 16000), ("sha256", "0" * 64)):
            self.write("q.json", json.dumps(plan | {"stroke": plan["stroke"] | {"recording": plan["stroke"]["recording"] | {key: value}}}))
            self.refused(2, "plan", "q.json")
        self.write("grain.wav", GRAIN[:-2] + b"\1\0")
        for command in (("render", "-o", "x.wav"), ("plan",), ("play", "-D", "null"), ("plot", "-o", "x.svg")):
            self.refused(2, *command, file)
        self.write("grain.wav", GRAIN)
        self.write("old.json", json.dumps(plan | {"stroke": {k: v for k, v in plan["stroke"].items() if k != "recording"}}))
        self.ok("plan", "old.json")
        (self.dir / "there").mkdir()
        for name in ("grain.wav", file):
            (self.dir / name).rename(self.dir / "there" / name)
        self.assertEqual(self.rendered(f"there/{file}"), before)
        self.write("there/grain.wav", wav_bytes([0.0, 1.0, -1.0]))
        self.refused(2, "render", f"there/{file}", "-o", "x.wav")

    def test_a_broken_plan_is_refused_with_the_place(self):
        good, bursts, moved = (self.plan("park2016-1", *more) for more in (("--algorithm", "continuous"), (), ("--compensate", "low-speed")))

        def changed(plan, place, value=None):
            p = copy.deepcopy(plan)
            *keys, last = (int(k) if k.isdigit() else k for k in place.split("."))
            at = p
            for k in keys:
                at = at[k]
            if value is None:
                del at[last]
            else:
                at[last] = value
            return json.dumps(p)

        drive = "continuous.points.5.drives.0.amplitude"
        # A custom model may exceed its intensity; where that adds up, as far as the channel goes.
        own = json.loads(changed(good, drive, 900.0)) | {"phantom": "own"}
        own["render"]["together"] = "sum"
        for text in ("", "[]", "{\n  \"schema\": \"tactor-plan/1\",\n  \"algorithm\" }", '{"schema": "tactor-play/1"}', "[" * 100000,
                     changed(good, "continuous.points.700"), changed(good, "continuous.points.7.x_mm"), changed(bursts, "render.phase"),
                     changed(bursts, "array.tactors.2.channel"), changed(bursts, "bursts.3.intensity", "loud"), changed(bursts, "bursts.3.intensity", 25.0),
                     changed(bursts, "bursts.3.drives.0.tactor", 9), changed(bursts, "bursts.3.onset_s", 0.0),
                     changed(bursts, "render.overlap", "tango"), changed(bursts, "render.phase", "tango"), changed(bursts, "bursts", []),
                     changed(bursts, "stroke.carier_hz", 250), changed(bursts, "bursts.3.drives.0.gain_db", 1),
                     changed(bursts, "array.tactors.2.channel", 4.5), changed(bursts, "stroke.duration_s", 0), changed(bursts, "render.sl_db", 1),
                     changed(good, "continuous.step_s", 0.002), changed(good, drive, 1e300), changed(good, drive, -0.1), changed(good, drive, 1.5),
                     changed(bursts, "bursts.3.drives.0.amplitude", 1.5), changed(bursts, "faces", "neerest"), changed(bursts, "total_s", -1.0),
                     changed(moved, "compensation.taps.3.felt_x_mm", "far"), json.dumps(own),
                     changed(bursts, "stroke.course", [{"t_s": 0, "hz": 100, "bend": [1e7, 0, 0, 0]}, {"t_s": 1e308, "hz": 200}]),
                     changed(bursts, "stroke.course", [{"t_s": 0, "hz": 100, "bend": [1e6, 0, 0, 0]}, {"t_s": 1, "hz": 200}]),
                     json.dumps(bursts).replace('"total_s": ', '"total_s": 1e999, "x": ')):
            self.write("bad.json", text)
            self.refused(2, "render", "bad.json", "-o", "x.wav")
        del own["render"]["together"]
        self.write("own.json", json.dumps(own))
        self.assertIn("own.json: weakened by 59.08 dB: it exceeds the level on tactor 0 at ", self.ok("render", "own.json", "-o", "own.wav").stderr)
        (self.dir / "folder.json").mkdir()
        for name in ("none.json", "folder.json", self.dir.name + ".json/"):
            self.refused(2, "render", name, "-o", "x.wav")
        self.assertFalse((self.dir / "x.wav").exists())


if __name__ == "__main__":
    main()
