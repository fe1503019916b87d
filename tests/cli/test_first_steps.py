# SPDX-License-Identifier: MIT
"""First steps of a user: shapes, taps, presets on the wrong array; and one syntax for strokes in all commands."""
import json
import math
import re

from harness import ToolTest, main, wav_bytes
from serving import Server

TAP = ("--path", "M 20 20", "--duration", "1")
LINE = '[array]\nname = "line"\ngrid = { rows = 1, columns = 4, pitch_mm = 15.0 }\n'
ONE = '[array]\nname = "one"\ngrid = { rows = 1, columns = 1, pitch_mm = 20.0 }\n'


def places(plan):
    return [(b["x_mm"], b["y_mm"]) for b in plan["bursts"]]


class Taps(ToolTest):
    def is_tap(self, plan, seconds=1.0, place=(20, 20)):
        self.assertEqual((plan["stroke"]["length_mm"], plan["stroke"]["duration_s"]), (0, seconds))
        self.assertEqual(set(places(plan)), {place})

    def test_a_place_and_a_duration_are_a_tap(self):
        for data in ("M 20 20", "M 20 20 Z", "M20,20L20,20", "M 20 20 l 0 0 l 0 0"):
            self.is_tap(self.plan("--path", data, "--duration", "1"))
        for algorithm in ("park2016", "continuous"):
            self.ok("render", *TAP, "--algorithm", algorithm, "-o", "tap.wav")
            self.ok("play", *TAP, "--algorithm", algorithm, "-D", "null")
        self.ok("plot", *TAP, "-o", "tap.svg")
        self.ok("compare", *TAP)
        self.assertEqual(self.plan(*TAP, "--fit")["stroke"]["length_mm"], 0)

    def test_a_missing_duration_has_a_hint(self):
        for more in ((), ("--speed", "50")):
            said = self.refused(2, "plan", "--path", "M 20 20", *more).stderr
            self.assertNotIn("duration_s", said)

    def test_files_have_taps(self):
        for text in ('path = "M 20 20"', "points = [[20, 20]]", "points = [[20, 20], [20, 20]]",
                     'path = "M 20 20"\neasing = "in-out"'):
            self.write("s.toml", f"[stroke]\n{text}\nduration_s = 1\n")
            self.is_tap(self.plan("s.toml"))
            self.write("s.toml", f"[stroke]\n{text}\n")
            self.refused(2, "plan", "s.toml")
        self.write("s.toml", '[stroke]\npath = "M 20 20"\nduration_s = 1\npauses = [[0.5, 0.1]]\n')
        self.refused(2, "plan", "s.toml")
        self.write("s.svg", '<svg><path d="M 20 20 Z" data-duration-s="1"/></svg>')
        self.is_tap(self.plan("s.svg"))
        self.write("s.svg", '<svg><path d="M 20 20 Z"/></svg>')
        self.refused(2, "plan", "s.svg")

    def test_definitions_and_the_service_have_taps(self):
        text = self.ok("experiment", "park2016", "--print").stdout
        text = re.sub(r'preset = "park2016-1"', 'path = "M 20 20"\nduration_s = 1', text)
        self.write("e.toml", text)
        methods = self.run_tool("experiment", "e.toml", "--dry-run")
        self.assertNotIn("no length", methods.stderr)
        s = Server(self)
        client = s.client()
        self.is_tap(client.ok("plan", path="M 20 20", options={"duration": 1}))
        fault = client.error("plan", path="M 20 20")
        self.assertIn("options.duration", json.dumps(fault))


class Shapes(ToolTest):
    def test_each_shape_is_as_large_as_the_array(self):
        for array, width, height in (("palm-3x3", 40, 40), ("palm-2x4", 60, 20)):
            for shape, x_span, y_span in (("line", width, 0), ("circle", height, height), ("eight", min(width, 2 * height), None),
                                          ("spiral", None, None)):
                with self.subTest(array=array, shape=shape):
                    p = self.plan("--shape", shape, "--array", array, "--algorithm", "continuous")
                    xs, ys = zip(*((q["x_mm"], q["y_mm"]) for q in p["continuous"]["points"]))
                    for low, high, most, span in ((min(xs), max(xs), width, x_span), (min(ys), max(ys), height, y_span)):
                        self.assertTrue(-1e-6 <= low and high <= most + 1e-6, (low, high))
                        if span is not None:
                            self.assertAlmostEqual(high - low, span, 1)
                    self.assertAlmostEqual(p["stroke"]["length_mm"] / p["stroke"]["duration_s"], 60, 6)
            p = self.plan("--shape", "tap", "--array", array)
            for x, y in places(p):
                self.assertAlmostEqual(math.dist((x, y), (width / 2, height / 2)), 0, 9)
            self.assertEqual(p["stroke"]["duration_s"], 0.3)

    def test_shapes_have_durations_speeds_and_fit_small_arrays(self):
        self.assertEqual(self.plan("--shape", "circle", "--duration", "2")["stroke"]["duration_s"], 2)
        p = self.plan("--shape", "circle", "--speed", "100")
        self.assertAlmostEqual(p["stroke"]["duration_s"], math.pi * 40 / 100, 6)
        self.write("line.toml", LINE)
        self.write("one.toml", ONE)
        for shape in ("tap", "line", "circle", "eight", "spiral"):
            self.plan("--shape", shape, "--array", "line.toml")
        self.plan("--shape", "tap", "--array", "one.toml")
        self.refused(2, "plan", "--shape", "circle", "--array", "one.toml")

    def test_every_command_that_takes_a_stroke_takes_a_shape(self):
        for args in (("render", "-o", "o.wav"), ("plot", "-o", "o.svg"), ("compare",), ("play", "-D", "null"), ("plan",)):
            self.ok(*args, "--shape", "eight")
        self.refused(2, "plan", "--shape", "square")
        self.refused(2, "plan", "--shape", "tap", "park2016-1")
        self.refused(2, "plan", "--shape", "tap", "--path", "M 0 0 L 9 9")
        self.refused(2, "plan")

    def test_the_service_takes_a_shape(self):
        s = Server(self)
        self.assertAlmostEqual(s.client().ok("plan", stroke="circle")["stroke"]["length_mm"], math.pi * 40, 3)
        self.ok("play", "--shape", "tap", "--socket", s.where["socket"])


class Presets(ToolTest):
    def test_a_preset_on_another_array_names_its_own(self):
        said = self.refused(2, "plan", "wave-2x4").stderr
        self.assertLess(said.index("palm-2x4 is"), said.index("--fit"))
        self.refused(2, "plan", "park2016-3", "--array", "palm-2x4")
        self.write("s.toml", '[stroke]\npreset = "wave-2x4"\n')
        self.refused(2, "plan", "s.toml")
        self.assertNotIn("drawn for", self.refused(2, "plan", "--path", "M 0 0 L 90 0").stderr)
        s = Server(self)
        self.assertIn("palm-2x4 is the one", json.dumps(s.client().error("plan", stroke="wave-2x4")))


class Names(ToolTest):
    def test_all_commands_call_a_stroke_alike(self):
        self.write("tap.csv", "t_s,x_mm,y_mm\n0,20,20\n1,20,20\n")
        self.write("s.toml", '[stroke]\nname = "wave"\npath = "M 0 0 L 20 0"\n')
        self.write("two.toml", '[[stroke]]\npath = "M 0 0 L 20 0"\n[[stroke]]\nname = "b"\npath = "M 0 0 L 20 0"\n')
        for args, title in ((("tap.csv",), "tap.csv"), (("s.toml",), "s.toml: wave"), (("park2016-1",), "park2016-1"),
                            (TAP, "--path"), (("--shape", "line"), "--shape line")):
            for command in ("plan", "compare"):
                self.assertEqual(self.ok(command, *args).stdout.partition(" on palm-3x3")[0], title)
            self.assertIn(f"\n{title.partition(': ')[0]}: played", self.ok("play", *args, "-D", "null").stdout)
        self.assertEqual(re.findall("(.*) on palm-3x3", self.ok("plan", "two.toml").stdout), ["two.toml: two-1", "two.toml: b"])
        self.assertEqual(self.ok("plan", "-", stdin='[stroke]\npath = "M 0 0 L 20 0"\n').stdout.partition(" on ")[0], "standard input")


class Sound(ToolTest):
    def test_plan_prints_tactors_and_strengths(self):
        self.write("brush.wav", wav_bytes([math.sin(k / 3) for k in range(800)]))
        self.write("p.toml", '[stroke]\npath = "M 0 0 L 40 0"\ncarrier_profile = [[0, 60], [1, 250]]\n')
        for args, says in (((), "sine of 250 Hz, level -12 dBFS"), (("--carrier", "100"), "sine of 100 Hz, "),
                           (("--waveform", "noise:60-400"), "noise of 60 to 400 Hz, level"),
                           (("--waveform", "square", "--am", "30"), "square of 250 Hz, AM of 30 Hz, level"),
                           (("--am", "30:0.5", "--level-dbfs", "-20"), "AM of 30 Hz and depth 0.5, level -20 dBFS"),
                           (("--waveform", "brush.wav"), "brush.wav at 250 Hz"),
                           (("--waveform", "brush.wav", "--texture", "time"), "brush.wav in its own time"),
                           (("--waveform", "brush.wav", "--texture", "length"), "brush.wav along the path")):
            out = self.ok("plan", "park2016-1", *args).stdout
            self.assertIn("\nvibration: ", out)
            self.assertIn(says, out)
        self.assertIn("sine of 60 to 250 Hz", self.ok("plan", "p.toml").stdout)

    def test_pictures_and_check_say_it_too(self):
        for args, says, never in ((("--waveform", "noise:60-400"), "noise of 60 to 400 Hz", "250 Hz"), ((), "250 Hz", "sine")):
            self.ok("plot", "park2016-1", *args, "-o", "o.svg")
            svg = (self.dir / "o.svg").read_text(encoding="utf-8")
            self.assertIn(says, svg)
            self.assertNotIn(never, svg)
            self.assertIn(says, " ".join(self.ok("check", "-D", "null", *args).stdout.split()))

    def test_levels_above_thresholds_name_calibrate(self):
        self.refused(2, "plan", "park2016-1", "--sl", "7")


class Warnings(ToolTest):
    def test_equal_thresholds_are_one(self):
        self.write("four.toml", "".join(f'[[stroke]]\npath = "M 0 {y} L 20 {y}"\nduration_s = 0.{y + 3}\n' for y in range(4)))
        for args in (("play", "-D", "null"), ("render", "-o", "o.wav"), ("plot", "-o", "o.svg"), ("plan", "--format", "csv")):
            said = self.ok(*args, "four.toml", "--burst", "0.003").stderr
            self.assertEqual(said.count("shorter than one cycle"), 1, said)
            self.assertIn("; and 3 more like it", said)
        said = self.ok("experiment", "park2016", "--dry-run").stderr
        self.assertEqual(said.count("beyond the range for which the timing law was fitted"), 1, said)
        self.assertIn("motion-1", said)


if __name__ == "__main__":
    main()
