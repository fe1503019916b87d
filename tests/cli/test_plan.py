# SPDX-License-Identifier: MIT
"""tactor plan: strokes as the user names them, and the plan as JSON, CSV and text."""
import csv
import io
import math
import re

from harness import ROOT, ToolTest, main, wav_bytes

LINE = ("--path", "M 0 0 L 40 0")
LOW = ("--array", "palm-2x4")
TAP = ("--path", "M 20 20", "--duration", "1")
MOVE = ("--compensate", "low-speed")
ARM = ROOT / "examples/arrays/arm-line-4.toml"
# Every command that takes a stroke.
COMMANDS = (("plan",), ("render", "-o", "o.wav"), ("plot", "-o", "o.svg"), ("compare",), ("play", "-D", "null"))


def places(plan):
    return [(b["x_mm"], b["y_mm"]) for b in plan["bursts"]]


class PlanTest(ToolTest):
    def both(self, *args):
        r = self.ok(*args)
        return r.stdout + r.stderr

    def table(self, *args):
        return list(csv.DictReader(io.StringIO(self.ok(*args, "--format", "csv").stdout)))


class Forms(PlanTest):
    def test_json_csv_and_text_have_the_same_bursts(self):
        plan = self.plan("park2016-4")
        self.assertEqual((plan["schema"], plan["algorithm"], plan["phantom"], plan["soa_s"]), ("tactor-plan/1", "park2016", "inverse-distance", 0.07))
        self.assertIn("reconstructed", plan["stroke"]["note"])
        self.assertAlmostEqual(plan["stroke"]["length_mm"], 16 * math.radians(270), 6)
        rows = [(b["onset_s"], b["x_mm"], b["y_mm"], d["tactor"], d["channel"], d["amplitude"]) for b in plan["bursts"] for d in b["drives"]]
        for k, burst in enumerate(plan["bursts"]):
            self.assertAlmostEqual(burst["onset_s"], k * 0.07, 9)
            turned = math.radians(-270 * k * 0.07 / 2.1)
            self.assertLess(math.dist(places(plan)[k], (20 + 16 * math.cos(turned), 20 + 16 * math.sin(turned))), 1e-6)
        self.assertEqual([tuple(float(line[n]) for n in ("onset_s", "x_mm", "y_mm", "tactor", "channel", "amplitude"))
                          for line in self.table("plan", "park2016-4")], [tuple(map(float, row)) for row in rows])
        text = self.ok("plan", "park2016-4").stdout
        self.assertIn("31 bursts", text)
        self.assertEqual(sum(line.strip().startswith(("0.", "1.", "2.")) for line in text.splitlines()), 31)

    def test_continuous_lists_its_points_instead_of_bursts(self):
        p = self.plan("park2016-1", "--algorithm", "continuous")
        points = p["continuous"]["points"]
        self.assertEqual((p["bursts"], p["soa_s"], len(points)), ([], None, 1401))
        self.assertAlmostEqual(points[-1]["t_s"], 1.4, 9)
        self.assertAlmostEqual(points[700]["x_mm"], 4.0, 6)

    def test_the_tactile_brush_lists_conflicts_and_dropped_points(self):
        self.write("a.toml", '[array]\nname = "a"\ngrid = { rows = 3, columns = 4, pitch_mm = 15.0 }\n')
        brush = ("--array", "a.toml", "--algorithm", "tactile-brush", "--path", "M 10 30 L 45 10")
        p = self.plan(*brush, "--duration", "1")
        self.assertTrue(p["conflicts"] and all(c["from_s"] < c["to_s"] for c in p["conflicts"]))
        self.assertTrue(all("tau_s" in b for b in p["bursts"]))
        p = self.plan(*brush, "--duration", "0.15", "--drop-points")
        self.assertEqual((len(p["bursts"]) + len(p["dropped"]), p["soa_s"]), (5, None))
        self.refused(2, "plan", *brush, "--duration", "0.15")
        self.refused(2, "plan", *brush[:-1], "M 10 29 L 45 10", "--duration", "1")
        self.assertAlmostEqual(self.plan(*brush[:-1], "M 10 29 L 45 10", "--duration", "1", "--snap")["bursts"][0]["y_mm"], 30.0, 9)

    def test_text_json_and_csv_have_the_start_of_each_stroke(self):
        stroke = '[[stroke]]\npath = "M 0 0 L 40 0"\nduration_s = 0.7\n'
        self.write("two.toml", stroke + "start_s = 1000.0625\n" + stroke)
        self.assertEqual([p["start_s"] for p in self.plan("two.toml")["plans"]], [1000.0625, 1000.8325])
        text = self.ok("plan", "two.toml").stdout
        self.assertTrue("\nstarts at 1000.0625 s, " in text and "\nstarts at 1000.8325 s, " in text, text)
        self.assertEqual({(r["stroke"], r["start_s"]) for r in self.table("plan", "two.toml")}, {("0", "1000.0625"), ("1", "1000.8325")})
        self.write("late.csv", "t_s,x_mm,y_mm\n1000,0,10\n1001,40,30\n")
        self.assertIn("starts at 0 s, 44.7214 mm in 1 s, 1.05 s of sound", self.ok("plan", "late.csv").stdout)

    def test_numbers_and_times_are_written_for_people(self):
        one = ("--path", "M 0 0 L 10 0", "--duration", "0.05")
        self.assertIn(", 1 burst, SOA", self.ok("plan", *one).stdout)
        self.assertIn(", 2 bursts, SOA", self.ok("plan", *one[:2], "--duration", "0.08").stdout)
        self.assertIn("1 of 1 burst is shorter than one cycle", self.both("plan", *one, "--burst", "0.003"))
        for path, says in (("M 0 0 L 0.0000016 0", "in 26.7 ns"), ("M 0 0 L 0.0016 0", "in 26.7 us"), ("M 0 0 L 16 0", "in 0.266667 s")):
            for command in ("plan", "compare"):
                self.assertIn(says, self.ok(command, "--path", path).stdout)

    def test_output_is_the_same_in_any_locale(self):
        for command, forms in (("plan", ("text", "json", "csv")), ("compare", ("text", "json"))):
            for form in forms:
                seen = {self.ok(command, "park2016-1", "--format", form, env={"LC_ALL": locale}).stdout
                        for locale in ("C", "de_DE.UTF-8", "fr_FR.UTF-8")}
                self.assertEqual(len(seen), 1)
        self.assertIn("0.8944271909", self.ok("plan", "park2016-1", "--format", "json").stdout)

    def test_text_says_how_it_vibrates(self):
        self.write("brush.wav", wav_bytes([math.sin(k / 3) for k in range(800)]))
        self.write("p.toml", '[stroke]\npath = "M 0 0 L 40 0"\ncarrier_profile = [[0, 60], [1, 250]]\n')
        for options, says in (("", "sine of 250 Hz, level -12 dBFS"), ("--carrier 100", "sine of 100 Hz, "),
                              ("--waveform noise:60-400", "noise of 60 to 400 Hz, level"),
                              ("--waveform square --am 30", "square of 250 Hz, AM of 30 Hz, level"),
                              ("--am 30:0.5 --level-dbfs -20", "AM of 30 Hz and depth 0.5, level -20 dBFS"),
                              ("--waveform brush.wav", "brush.wav at 250 Hz"),
                              ("--waveform brush.wav --texture time", "brush.wav at its own rate"),
                              ("--waveform brush.wav --texture length", "brush.wav along the path")):
            out = self.ok("plan", "park2016-1", *options.split()).stdout
            self.assertTrue("\nvibration: " in out and says in out, out)
        self.assertIn("sine of 60 to 250 Hz", self.ok("plan", "p.toml").stdout)
        for more, says, never in ((("--waveform", "noise:60-400"), "noise of 60 to 400 Hz", "250 Hz"), ((), "250 Hz", "sine")):
            self.ok("plot", "park2016-1", *more, "-o", "o.svg")
            svg = (self.dir / "o.svg").read_text(encoding="utf-8")
            self.assertTrue(says in svg and never not in svg)
            self.assertIn(says, " ".join(self.ok("check", "-D", "null", *more).stdout.split()))


class Options(PlanTest):
    def test_options_of_time_and_place_reach_the_plan(self):
        for options, expected in (("--soa 0.06", {"onset": 0.06, "burst": (0.06 - 0.0473) / 0.32}), ("--speed 80", {"lasts": 0.5}), ("", {"lasts": 40 / 60}),
                                  ("--duration 3", {"lasts": 3.0}), ("--duration 1 --timing fit", {"onset": 1 / 15, "lasts": 1.0}),
                                  ("--burst 0.05", {"burst": 0.05}), ("--duration 1.4 --faces nearest", {"lasts": 1.4})):
            p = self.plan(*LINE, *options.split())
            found = {"onset": p["bursts"][1]["onset_s"], "burst": p["bursts"][0]["duration_s"], "lasts": p["stroke"]["duration_s"]}
            for name, value in expected.items():
                self.assertAlmostEqual(found[name], value, 9, f"{options}: {name}")
        self.assertTrue(all(b["y_mm"] == 0 for b in self.plan("--path", "M 0 -5 L 40 -5", "--outside", "clamp")["bursts"]))

    def test_config_gives_defaults_that_the_command_line_overrides(self):
        self.write("c.toml", '[array]\npreset = "palm-2x4"\n[defaults]\nphantom = "barycentric"\nsoa = 0.06\ncompensate = "low-speed"\nsigma-mm = 3\n')
        p = self.plan(*LINE, "--config", "c.toml")
        self.assertEqual((p["array"]["name"], p["phantom"], p["soa_s"], p["compensation"]["sigma_mm"]), ("palm-2x4", "barycentric", 0.06, 3))
        p = self.plan(*LINE, "--config", "c.toml", "--soa", "0.07", "--array", "palm-3x3", "--compensate", "none")
        self.assertEqual((p["array"]["name"], p["soa_s"]), ("palm-3x3", 0.07))
        self.assertNotIn("compensation", p)
        self.assertEqual(self.plan(*LINE, env={"TACTOR_CONFIG": "c.toml"})["array"]["name"], "palm-2x4")
        self.write("xdg/tactor/tactor.toml", '[defaults]\nsoa = 0.05\nfaces = "nearest"\n')
        p = self.plan("park2016-1", env={"XDG_CONFIG_HOME": str(self.dir / "xdg")})
        self.assertEqual((p["soa_s"], p["faces"]), (0.05, "nearest"))

    def test_faces_are_reported_where_they_are_not_the_usual_ones(self):
        self.write("wide.toml", '[array]\nname = "wide"\ngrid = { rows = 3, columns = 3, pitch_mm = [20.0, 40.0] }\n')
        drawn = ("--path", "M 0 10 L 40 10", "--array", "wide.toml")
        near = self.plan(*drawn, "--faces", "nearest")
        self.assertEqual(near["faces"], "nearest")
        self.assertRegex(near["warnings"][0], r"for \d+ of them the three are in one line")
        self.assertEqual(self.ok("plan", *drawn, "--faces", "nearest").stdout.count("warning"), 1)
        self.assertNotIn("faces", self.plan(*drawn, "--faces", "delaunay"))
        self.assertIn("gaussian spreads by 20 mm", self.ok("plan", *drawn, "--phantom", "gaussian").stdout)

    def test_a_stroke_that_does_not_fit_does_with_fit(self):
        for command in COMMANDS:
            with self.subTest(command=command[0]):
                self.refused(2, *command, "park2016-3", *LOW)
                self.ok(*command, "park2016-3", *LOW, "--fit")
        self.assertEqual(len(self.plan("park2016-3", *LOW, "--fit")["bursts"]), 31)  # with its original time

    def test_json_and_text_report_the_fit(self):
        self.assertNotIn("fit", self.plan("wave-2x4", *LOW)["stroke"])
        corner = ("--path", "M 100 100 H 200 V 110")
        fit = self.plan(*corner, *LOW, "--fit", "--fit-margin", "5")["stroke"]["fit"]
        self.assertEqual(fit["margin_mm"], 5)
        for value, wanted in zip(fit["matrix"], (0.5, 0, 0, 0.5, 5 - 50, 10 - 52.5)):
            self.assertAlmostEqual(value, wanted, 6)
        self.assertIn("fitted: (150, 105) mm as drawn becomes (30, 10) mm, lengths times 0.6\n", self.ok("plan", *corner, *LOW, "--fit").stdout)
        self.assertIn("onto the line of the array", self.ok("plan", "park2016-1", "--array", ARM, "--fit").stdout)

    def test_compensation_is_told_by_every_command(self):
        for command in (*COMMANDS, ("plan", "--format", "csv")):
            said = self.both(command[0], "park2016-1", *MOVE, *command[1:])
            for word in ("low-speed", "sigma 5 mm", "sigma_v 100 mm/s", "built for taps"):
                self.assertIn(word, said, command)
        edge = ("--path", "M 0 0 L 40 40 L 0 40", "--speed", "150", "--phantom", "barycentric", "--sigma-mm", "8", *self.defaults(sigma_v_mm_s=150), *MOVE)
        p = self.plan(*edge)
        c = p["compensation"]
        self.assertEqual((c["sigma_mm"], c["sigma_v_mm_s"], c["built_for"]), (8, 150, "taps"))
        self.assertGreater(c["bursts_at_edge"], 0)
        self.assertAlmostEqual(c["residual_rms_mm"], c["predicted_rms_mm"], 9)
        said = self.both("plan", *edge)
        self.assertIn(f"{c['bursts_at_edge']} of {len(p['bursts'])} bursts cannot be moved far enough", said)
        self.assertIn(f"{c['residual_rms_mm']:.3f} mm RMS", said)
        self.write("s.toml", '[stroke]\npath = "M 0 20 H 40"\nintensity = 0\n')
        self.assertIsNone(self.plan("s.toml", *MOVE)["compensation"]["predicted_rms_mm"])
        self.assertIn("there is no audible burst to move for the low-speed observer", self.both("plan", "s.toml", *MOVE))

    def test_impossible_options_are_refused(self):
        for options in ("--soa 0.0473", "--soa 0.0701", "--soa -1", "--burst 0", "--burst 11", "--burst x", "--burst 0.08", "--compensate more",
                        "--sigma-mm 4", "--compensate low-speed --algorithm continuous",
                        "--faces nearest --phantom gaussian", "--faces neerest", "--fit-margin 1", "--fit --fit-margin -1", "--fit --fit-margin 20",
                        "--timing fit --duration 0.1 --path M0,0L4,0", "--duration 1 --speed 2", "--level-dbfs -12 --sl 7"):
            with self.subTest(options):
                self.refused(2, "plan", *(() if "--path" in options else ("park2016-1",)), *options.split())
        self.refused(2, "plan", "park2016-1", *MOVE, "--sigma-mm", "1000", *self.defaults(sigma_v_mm_s=0.001))
        self.refused(2, "plan", "park2016-1", "--timing", "fit", *self.defaults(min_duration=5))
        self.refused(2, "plan", "--path", "M 0 0 V 5", "--array", ARM, "--fit")
        self.refused(2, "plan", ROOT / "examples/strokes/several.toml", "--array", ARM, "--fit")
        self.ok("plan", "park2016-1", "--soa", "0.0474")
        for option in ("--duration", "--speed", "--soa", "--burst", "--carrier", "--rate", "--level-dbfs", "--ramp", "--sl"):
            for value in ("nan", "-inf", "1e300", "abc", "", "1,5", "0x10", "1e999"):
                r = self.run_tool("plan", "park2016-1", f"{option}={value}")
                self.assertEqual((r.returncode, r.stderr[:8]), (2, "tactor: "), f"{option}={value}: {r.stdout[:200]}{r.stderr}")


class Strokes(PlanTest):
    def test_a_place_and_a_duration_are_a_tap(self):
        def is_tap(plan):
            self.assertEqual((plan["stroke"]["length_mm"], plan["stroke"]["duration_s"], set(places(plan))), (0, 1.0, {(20, 20)}))
        is_tap(self.plan(*TAP))
        for algorithm in ("park2016", "continuous"):
            for command in COMMANDS:
                self.ok(*command, *TAP, "--algorithm", algorithm)
        self.assertEqual(self.plan(*TAP, "--fit")["stroke"]["length_mm"], 0)
        for text in ('path = "M 20 20"', "points = [[20, 20]]", "points = [[20, 20], [20, 20]]", 'path = "M 20 20"\neasing = "in-out"'):
            self.write("s.toml", f"[stroke]\n{text}\nduration_s = 1\n")
            is_tap(self.plan("s.toml"))
            self.write("s.toml", f"[stroke]\n{text}\n")
            self.refused(2, "plan", "s.toml")
        self.write("s.toml", '[stroke]\npath = "M 20 20"\nduration_s = 1\npauses = [[0.5, 0.1]]\n')
        self.refused(2, "plan", "s.toml")
        for more in ((), ("--speed", "50")):
            self.assertNotIn("duration_s", self.refused(2, "plan", "--path", "M 20 20", *more).stderr)

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
            self.assertLess(max(math.dist(place, (width / 2, height / 2)) for place in places(p)), 1e-9)
            self.assertEqual(p["stroke"]["duration_s"], 0.3)

    def test_shapes_have_durations_and_speeds_in_every_command_and_fit_small_arrays(self):
        for command in COMMANDS:
            self.ok(*command, "--shape", "eight")
        self.assertEqual(self.plan("--shape", "circle", "--duration", "2")["stroke"]["duration_s"], 2)
        self.assertAlmostEqual(self.plan("--shape", "circle", "--speed", "100")["stroke"]["duration_s"], math.pi * 40 / 100, 6)
        for name, columns in (("line.toml", 4), ("one.toml", 1)):
            self.write(name, f'[array]\nname = "row"\ngrid = {{ rows = 1, columns = {columns}, pitch_mm = 15.0 }}\n')
        for shape in ("tap", "line", "circle", "eight", "spiral"):
            self.plan("--shape", shape, "--array", "line.toml")
        self.plan("--shape", "tap", "--array", "one.toml")
        for args in (("circle", "--array", "one.toml"), ("square",), ("tap", "park2016-1"), ("tap", "--path", "M 0 0 L 9 9")):
            self.refused(2, "plan", "--shape", *args)

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
        for command, says in (("plan", "standard input on "), ("play", "standard input: played")):
            self.assertIn(says, self.ok(command, "-", stdin='[stroke]\npath = "M 0 0 L 20 0"\n').stdout)

    def test_every_command_warns_once(self):
        self.write("s.csv", "t_s,x_mm,y_mm\n0,0,10\n0.7,9,9\n0.7,20,10\n1.4,40,10\n")
        self.write("four.toml", "".join(f'[[stroke]]\npath = "M 0 {y} L 20 {y}"\nduration_s = 0.{y + 3}\n' for y in range(4)))
        short = ("--path", "M 0 0 L 20 0", "--duration", "0.14", "--burst", "0.003")
        for command in (*COMMANDS, ("plan", "--format", "csv")):
            with self.subTest(command=command):
                which = "park2016: " if command[0] == "compare" else ""
                self.assertEqual(self.both(*command, "s.csv").count(f"warning: {which}s.csv:4: it has the same time as the previous line"), 1)
                said = " ".join(self.both(*command, *short).split())
                self.assertTrue("break the timing law" in said and "shorter than one cycle of the carrier" in said, said)
        self.assertEqual(len(self.plan(*short)["warnings"]), 2)
        for command in (("play", "-D", "null"), ("render", "-o", "o.wav"), ("plot", "-o", "o.svg"), ("plan", "--format", "csv")):
            said = self.ok(*command, "four.toml", "--burst", "0.003").stderr
            self.assertEqual(said.count("shorter than one cycle"), 1, said)
            self.assertIn("; and 3 more like it", said)
        said = self.ok("experiment", "park2016", "--dry-run").stderr
        self.assertEqual((said.count("beyond the range for which the timing law was fitted"), said.count("motion-1")), (1, 1), said)

    def test_a_stroke_that_cannot_be_played_is_named_with_its_place(self):
        far = 'path = "M 0 0 L 400 0"\n'
        self.write("one.toml", '[stroke]\nname = "swing"\n' + far)
        self.write("two.toml", f'[[stroke]]\npath = "M 0 0 L 40 0"\n[[stroke]]\nname = "wave"\n{far}')
        self.write("start.toml", '[[stroke]]\npath = "M 0 0 L 40 0"\n[[stroke]]\npath = "M 0 0 L 40 0"\nstart_from = "end"\nstart_s = -5\n')
        self.write("preset.toml", '[stroke]\npreset = "wave-2x4"\n')
        self.write("small.toml", '[array]\nname = "s"\ngrid = { rows = 2, columns = 2, pitch_mm = 9.0 }\n')
        for command in COMMANDS:
            for file in ("one.toml", "start.toml"):
                if (command[0], file) != ("compare", "start.toml"):
                    self.refused(2, *command, file)
        self.assertEqual([p.name for p in self.dir.glob("o.*")], [])
        self.assertEqual(self.refused(2, "plan", "two.toml").stderr.count("wave"), 1)
        for args in (("--path", "M 20 20 L 60 20"), ("--path", "M 20 20 L 60 20", "--algorithm", "tactile-brush"),
                     ("--path", "M 20 20 L 60 20", "--algorithm", "continuous"), ("preset.toml",), ("wave-2x4",), ("park2016-3", *LOW),
                     ("park2016-1", "--array", "small.toml")):
            self.refused(2, "plan", *args)
        self.refused(2, "plan", "-", stdin="[stroke]\n" + far)

    def test_slow_strokes_last_as_their_speeds_say(self):
        plans = self.plan(ROOT / "examples/strokes/slow.toml")["plans"]
        self.assertEqual([round(p["total_s"], 3) for p in plans], [13.333, 1.333, 0.133])  # 40 mm at 3, 30 and 300 mm/s
        self.assertEqual([round(p["start_s"], 3) for p in plans], [0, 14.333, 16.667])

    def test_every_example_can_be_planned(self):  # test_plot.py plans on each array
        strokes = [f for f in sorted((ROOT / "examples/strokes").iterdir()) if f.suffix in (".toml", ".csv", ".svg")]
        self.assertEqual({f.suffix for f in strokes}, {".toml", ".csv", ".svg"})
        for stroke in strokes:
            self.plan(stroke, *(LOW if stroke.stem.endswith("-2x4") else ()))


if __name__ == "__main__":
    main()
