# SPDX-License-Identifier: MIT
"""Stored plans are played, rendered and drawn unchanged."""
import json

from harness import ROOT, ToolTest, main

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
    f"[[tactor]]\ntactor = {i}\nthreshold_dbfs = {-40.1 - i}\n" for i in range(4))
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


class PlanFile(ToolTest):
    def stored(self, *args, name="plan.json"):
        self.write(name, self.ok("plan", *args, "--format", "json").stdout)
        return name

    def same(self, *args):
        """Renders a stroke from its plan: the bytes are the same, and its plan is the same text."""
        file = self.stored(*args)
        self.ok("render", *args, "-o", "stroke.wav")
        self.ok("render", file, "-o", "plan.wav")
        self.assertEqual((self.dir / "stroke.wav").read_bytes(), (self.dir / "plan.wav").read_bytes(), args)
        self.assertEqual(self.ok("plan", file, "--format", "json").stdout, (self.dir / file).read_text(), args)

    def test_a_plan_renders_the_bytes_of_its_stroke(self):
        for algorithm in ("park2016", "tactile-brush", "continuous"):
            for phantom in ("inverse-distance", "barycentric", "gaussian"):
                with self.subTest(algorithm=algorithm, phantom=phantom):
                    self.same("park2016-3", "--algorithm", algorithm, "--phantom", phantom)
        self.same("park2016-1", "--algorithm", "continuous", "--duration", "5.00033")
        self.same("--path", "M 0 10 C 20 5 20 35 40 30", "--algorithm", "continuous", "--speed", "33")
        self.same("wave-2x4", "--array", "palm-2x4")
        for name in ("reach", "knocks"):
            self.same(str(ROOT / f"examples/strokes/{name}.toml"))

    def test_a_plan_holds_the_stroke_s_placing(self):
        self.same("park2016-1", "--array", "palm-2x4", "--fit", "--fit-margin", "1.3")
        self.write("arm.toml", '[array]\nname = "arm"\ngrid = { rows = 1, columns = 6, pitch_mm = 35.0 }\n')
        self.same("park2016-3", "--array", "arm.toml", "--fit")
        # For a line that lies across, the last digits may differ.
        self.write("across.toml", '[array]\nname = "across"\n' + "".join(
            f"[[tactor]]\nx_mm = {11.1 * i}\ny_mm = {-23.4 * i}\nchannel = {i}\n" for i in range(5)))
        first = self.stored("park2016-3", "--array", "across.toml", "--fit")
        matrix = json.loads((self.dir / first).read_text())["stroke"]["fit"]["matrix"]
        again = json.loads(self.ok("plan", first, "--format", "json").stdout)["stroke"]["fit"]["matrix"]
        self.assertLess(matrix[1], 0)
        for x, y in zip(matrix, again):
            self.assertAlmostEqual(x, y, delta=1e-12)

    def test_a_plan_holds_its_rendering(self):
        self.same("park2016-3", "--rate", "44100", "--level-dbfs", "-20.05", "--phase", "burst", "--ramp", "0.0013")
        self.same("park2016-2", "--algorithm", "tactile-brush", "--overlap", "max", "--carrier", "187.5")
        self.write("desk.toml", DESK)
        self.same("park2016-1", "--array", "desk.toml")
        self.write("heard.toml", HEARD)
        self.same("--path", "M 0 10 L 30 12", "--array", "heard.toml", "--sl", "7.7")

    def test_a_plan_holds_its_faces(self):
        self.write("wide.toml", '[array]\nname = "wide"\ngrid = { rows = 3, columns = 3, pitch_mm = [20.0, 40.0] }\n')
        drawn = ("--path", "M 0 10 L 40 10", "--array", "wide.toml", "--faces", "nearest")
        for algorithm in ("park2016", "continuous"):
            self.same(*drawn, "--algorithm", algorithm)
            self.assertEqual(json.loads((self.dir / "plan.json").read_text())["faces"], "nearest")
        file = self.stored(*drawn)
        self.assertIn("inverse-distance (faces nearest)", self.ok("plan", file).stdout)
        self.ok("plot", file, "-o", "plan.svg")
        self.assertIn("(faces nearest)", (self.dir / "plan.svg").read_text())
        plan = json.loads((self.dir / file).read_text())
        plan["faces"] = "neerest"
        self.write("changed.json", json.dumps(plan))
        self.refused(2, "plan", "changed.json")
        self.refused(2, "render", file, "--faces", "delaunay", "-o", "x.wav")

    def test_several_strokes_begin_at_their_frames(self):
        self.write("three.toml", THREE)
        for algorithm in ("park2016", "continuous"):
            self.same("three.toml", "--algorithm", algorithm, "--rate", "44100")

    def test_options_of_rendering_win_and_those_of_planning_are_refused(self):
        file = self.stored("park2016-1", "--rate", "44100")
        self.ok("render", file, "--rate", "48000", "--level-dbfs", "-20", "-o", "plan.wav")
        self.ok("render", "park2016-1", "--level-dbfs", "-20", "-o", "stroke.wav")
        self.assertEqual((self.dir / "stroke.wav").read_bytes(), (self.dir / "plan.wav").read_bytes())
        for option in (("--soa", "0.06"), ("--algorithm", "continuous"), ("--duration", "2"), ("--fit",), ("--snap",),
                       ("--carrier", "200"), ("--overlap", "sum"), ("--timing", "fit")):
            said = self.refused(2, "render", file, *option, "-o", "x.wav", says=[f"{option[0]}: plan.json is planned"])
            self.assertFalse((self.dir / "x.wav").exists(), said)

    def test_defaults_of_planning_do_not_change_a_plan(self):
        file = self.stored("park2016-1")
        self.ok("render", file, "-o", "plan.wav")
        config = self.write("tactor.toml", '[defaults]\nalgorithm = "continuous"\nlevel-dbfs = -30.0\nsoa = 0.06\n')
        self.ok("render", file, "--config", config, "-o", "configured.wav")
        self.assertEqual((self.dir / "plan.wav").read_bytes(), (self.dir / "configured.wav").read_bytes())
        palm = self.write("palm.toml", '[array]\nname = "p"\ngrid = { rows = 3, columns = 3, pitch_mm = 20.0 }\n'
                          '[defaults]\nlevel-dbfs = -30.0\nphase = "burst"\nramp = 0.003\n')
        self.ok("render", file, "--array", palm, "-o", "configured.wav")
        self.assertEqual((self.dir / "plan.wav").read_bytes(), (self.dir / "configured.wav").read_bytes())

    def test_every_command_that_plays_or_draws_takes_a_plan(self):
        for algorithm in ("park2016", "continuous"):
            file = self.stored("park2016-1", "--algorithm", algorithm)
            self.ok("plot", file, "-o", "a.svg")
            self.ok("plot", file, "--view", "wave", "-o", "b.svg")
            self.ok("play", file, "-D", "null")
            self.assertEqual(self.ok("plan", file).stdout, self.ok("plan", "park2016-1", "--algorithm", algorithm).stdout)
        self.refused(2, "compare", file)
        self.refused(2, "render", file, "park2016-1", "-o", "x.wav")

    def test_a_different_array_is_refused(self):
        file = self.stored("park2016-1")
        self.ok("render", file, "--array", "palm-3x3", "-o", "x.wav")
        self.refused(2, "play", file, "--array", "palm-2x4", "-D", "null")
        desk = self.write("desk.toml", DESK)
        self.refused(2, "render", file, "--array", desk, "-o", "y.wav")
        wide = self.write("wide.toml", '[array]\nname = "wide"\ngrid = { rows = 3, columns = 3, pitch_mm = 21.0 }\n')
        said = self.refused(2, "render", file, "--config", wide, "-o", "y.wav")
        self.assertIn("(21, 0) mm here", said.stderr)
        self.assertFalse((self.dir / "y.wav").exists())
        other = self.stored("wave-2x4", "--array", "palm-2x4", name="other.json")
        self.refused(2, "play", file, other, "-D", "null")

    def test_a_plan_comes_through_a_pipe(self):
        self.ok("render", "park2016-1", "-o", "stroke.wav")
        stored = (self.dir / self.stored("park2016-1")).read_text()
        for text in (stored, "\ufeff\n" + stored):
            self.ok("render", "-", "-o", "pipe.wav", stdin=text)
            self.assertEqual((self.dir / "pipe.wav").read_bytes(), (self.dir / "stroke.wav").read_bytes())
        self.assertEqual(self.ok("plan", "-", "--format", "json", stdin=stored).stdout, stored)
        self.ok("play", "-", "-D", "null", stdin=stored)
        self.ok("plot", "-", "-o", "pipe.svg", stdin=stored)
        self.refused(2, "render", "-", "--phantom", "gaussian", "-o", "x.wav", stdin=stored)
        self.refused(2, "compare", "-", stdin=stored)
        self.refused(2, "render", "-", "-o", "x.wav", stdin=stored[:700])
        self.refused(2, "render", "-", "-o", "x.wav", stdin=" {}")
        self.assertFalse((self.dir / "x.wav").exists())

    def test_a_broken_plan_is_refused_with_the_place(self):
        good = self.plan("park2016-1", "--algorithm", "continuous")
        bursts = self.plan("park2016-1")
        self.refused(2, "render", "none.json", "-o", "x.wav")
        self.refused(2, "render", self.dir.name + ".json/", "-o", "x.wav")
        (self.dir / "folder.json").mkdir()
        self.refused(2, "render", "folder.json", "-o", "x.wav")

        def refuses(text, *says):
            self.write("bad.json", text if isinstance(text, str) else json.dumps(text))
            self.refused(2, "render", "bad.json", "-o", "x.wav", says=["bad.json", *says])

        refuses("")
        refuses("[]", "no plan in it", "tactor plan STROKE --format json")
        refuses("{\n  \"schema\": \"tactor-plan/1\",\n  \"algorithm\" }", "line 3, column 15")
        refuses({"schema": "tactor-play/1"}, "its schema is tactor-play/1")
        refuses("[" * 100000, "bad.json")

        def without(plan, *keys):
            p = json.loads(json.dumps(plan))
            at = p
            for k in keys[:-1]:
                at = at[k]
            del at[keys[-1]]
            return p

        def changed(plan, value, *keys):
            p = json.loads(json.dumps(plan))
            at = p
            for k in keys[:-1]:
                at = at[k]
            at[keys[-1]] = value
            return p

        refuses(without(good, "continuous", "points", 700), "continuous.points", "1401 samples")
        refuses(without(good, "continuous", "points", 7, "x_mm"), "points[7].x_mm: is missing")
        refuses(without(bursts, "render", "phase"), "render.phase: is missing")
        refuses(without(bursts, "array", "tactors", 2, "channel"), "array.tactors[2].channel: is missing")
        refuses(changed(bursts, "loud", "bursts", 3, "intensity"), "bursts[3].intensity: is no number")
        refuses(changed(bursts, 9, "bursts", 3, "drives", 0, "tactor"), "bursts[3]", "tactor 9 of 9")
        refuses(changed(bursts, 0.0, "bursts", 3, "onset_s"), "bursts[3]", "before")
        refuses(changed(bursts, "tango", "render", "overlap"), "render.overlap", '"tango"')
        refuses(changed(bursts, "tango", "render", "phase"), 'render.phase: is "tango", which is not known')
        refuses(changed(bursts, [], "bursts"), "bursts")
        refuses(changed(bursts, 250, "stroke", "carier_hz"), "stroke.carier_hz: is no field of it (did you mean 'carrier_hz'?)")
        refuses(changed(bursts, 1, "bursts", 3, "drives", 0, "gain_db"), "bursts[3].drives[0].gain_db: is no field of it")
        refuses(changed(bursts, 4.5, "array", "tactors", 2, "channel"), "array.tactors[2].channel: is no whole number from 0 to 1000000")
        refuses(changed(bursts, 0, "stroke", "duration_s"), "stroke.duration_s: is 0, not above 0")
        refuses(changed(bursts, 1, "render", "sl_db"), "render: has not exactly one of level_dbfs and sl_db")
        refuses(changed(good, 0.002, "continuous", "step_s"), "continuous.step_s", "0.001")
        refuses(changed(good, 1e300, "continuous", "points", 5, "drives", 0, "amplitude"), "points[5].drives[0].amplitude", "not from 0 to 1000")
        refuses(changed(good, -0.1, "continuous", "points", 5, "drives", 0, "amplitude"), "points[5].drives[0].amplitude", "not from 0 to 1000")
        refuses(changed(good, 1.5, "continuous", "points", 5, "drives", 0, "amplitude"), "points[5]: drives tactor 0 at 1.5, above its intensity of 1")
        refuses(changed(bursts, 1.5, "bursts", 3, "drives", 0, "amplitude"), "bursts[3]: drives tactor", "at 1.5, above its intensity of 1")
        # A custom model may exceed its intensity, as far as the channel goes.
        own = changed(changed(good, 900.0, "continuous", "points", 5, "drives", 0, "amplitude"), "own", "phantom")
        self.write("loud.json", json.dumps(own))
        self.refused(2, "render", "loud.json", "-o", "x.wav")
        refuses(json.dumps(bursts).replace('"total_s": ', '"total_s": 1e999, "x": '), "bad.json")
        self.write("ends.json", json.dumps(changed(bursts, -1.0, "total_s")))
        self.refused(2, "render", "ends.json", "-o", "x.wav")
        self.assertFalse((self.dir / "x.wav").exists())


main()
