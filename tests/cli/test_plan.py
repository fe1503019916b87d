# SPDX-License-Identifier: MIT
"""tactor plan: the plan as JSON, CSV and text, against independent calculations."""
import csv
import io
import json
import math

from harness import ROOT, ToolTest, main


def circle(centre, start_deg, sweep_deg, share):
    angle = math.radians(start_deg + sweep_deg * share)
    return centre[0] + 16 * math.cos(angle), centre[1] + 16 * math.sin(angle)


class Presets(ToolTest):
    # centre, first angle, sweep, duration, bursts
    MOTIONS = {
        "park2016-1": ((20, 20), -90, -180, 1.4, 21),
        "park2016-2": ((0, 20), -90, 180, 1.4, 21),
        "park2016-3": ((20, 20), 90, 270, 2.1, 31),
        "park2016-4": ((20, 20), 0, -270, 2.1, 31),
    }

    def test_the_four_target_motions_are_planned_as_in_the_paper(self):
        for name, (centre, first, sweep, duration, bursts) in self.MOTIONS.items():
            p = self.plan(name)
            self.assertEqual(p["schema"], "tactor-plan/1")
            self.assertEqual((p["algorithm"], p["phantom"]), ("park2016", "inverse-distance"))
            self.assertEqual(len(p["bursts"]), bursts, name)
            self.assertEqual(p["soa_s"], 0.07)
            self.assertAlmostEqual(p["total_s"], duration + 0.07, 9)
            self.assertAlmostEqual(p["stroke"]["length_mm"], 16 * math.radians(abs(sweep)), 6)
            for k, burst in enumerate(p["bursts"]):
                self.assertAlmostEqual(burst["onset_s"], k * 0.07, 9)
                self.assertAlmostEqual(burst["duration_s"], 0.07, 9)
                at = circle(centre, first, sweep, k * 0.07 / duration)
                self.assertAlmostEqual(burst["x_mm"], at[0], 6)
                self.assertAlmostEqual(burst["y_mm"], at[1], 6)

    def test_drives_name_tactor_and_channel_in_order_of_tactor(self):
        for burst in self.plan("park2016-4")["bursts"]:
            tactors = [d["tactor"] for d in burst["drives"]]
            self.assertEqual(tactors, sorted(tactors))
            self.assertEqual(tactors, [d["channel"] for d in burst["drives"]])

    def test_presets_are_marked_as_reconstructed(self):
        self.assertIn("reconstructed", self.plan("park2016-1")["stroke"]["note"])


class Faces(ToolTest):
    def test_the_three_closest_are_warned_of_where_they_miss_the_point(self):
        self.write("wide.toml", '[array]\nname = "wide"\ngrid = { rows = 3, columns = 3, pitch_mm = [20.0, 40.0] }\n')
        drawn = ("--path", "M 0 10 L 40 10", "--duration", "1", "--array", "wide.toml")
        run = self.ok("plan", *drawn, "--faces", "nearest", "--format", "json")
        plan = json.loads(run.stdout)
        places = [(t["x_mm"], t["y_mm"]) for t in plan["array"]["tactors"]]
        in_line = 0
        for burst in plan["bursts"]:
            p = (burst["x_mm"], burst["y_mm"])
            three = sorted(range(9), key=lambda i: (round(math.dist(p, places[i]), 6), i))[:3]
            d = {i: math.dist(p, places[i]) for i in three}
            ys = {places[i][1] for i in three}
            if len(burst["drives"]) == 3:
                self.assertEqual({x["tactor"] for x in burst["drives"]}, set(three))
                in_line += len(ys) == 1
                total = sum(1 / v for v in d.values())
                for x in burst["drives"]:
                    self.assertAlmostEqual(x["amplitude"], math.sqrt(1 / d[x["tactor"]] / total), 12)
        self.assertGreater(in_line, 0)
        self.assertIn(f"for {in_line} of them the three are in one line", plan["warnings"][0])
        self.assertEqual(self.ok("plan", *drawn, "--faces", "nearest").stdout.count("warning"), 1)
        usual = json.loads(self.ok("plan", *drawn, "--format", "json").stdout)
        self.assertNotIn("faces", usual)
        self.assertEqual(usual, json.loads(self.ok("plan", *drawn, "--faces", "delaunay", "--format", "json").stdout))

    def test_their_origin_is_reported_for_files_too_and_the_command_line_wins(self):
        array = '[array]\nname = "p"\ngrid = { rows = 2, columns = 3, pitch_mm = 20.0 }\n[defaults]\nfaces = "nearest"\n'
        self.write("p.toml", array)
        drawn = ("--path", "M 1 2 L 30 15", "--array", "p.toml", "--format", "json")
        self.assertEqual(json.loads(self.ok("plan", *drawn).stdout)["faces"], "nearest")
        self.assertNotIn("faces", json.loads(self.ok("plan", *drawn, "--faces", "delaunay").stdout))
        self.write("s.toml", '[stroke]\npath = "M 1 2 L 30 15"\nfaces = "nearest"\n')
        self.assertEqual(self.plan("s.toml")["faces"], "nearest")

    def test_other_models_refuse_them(self):
        for phantom in ("barycentric", "linear", "log", "gaussian"):
            self.refused(2, "plan", "park2016-1", "--faces", "nearest", "--phantom", phantom,
                         says=[f"--faces: nearest goes with inverse-distance only, not with {phantom}",
                               "(use --faces delaunay or --phantom inverse-distance)"])
        self.refused(2, "plan", "park2016-1", "--faces", "neerest")


class TactileBrush(ToolTest):
    ARRAY = '[array]\nname = "a"\ngrid = { rows = 3, columns = 4, pitch_mm = 15.0 }\n'

    def brush(self, *args):
        self.write("a.toml", self.ARRAY)
        return self.plan("--array", "a.toml", "--algorithm", "tactile-brush", *args)

    def test_the_worked_example_comes_out(self):
        p = self.brush("--path", "M 10 30 L 45 10", "--duration", "1")
        expected = [(0, 72.392), (70.465, 398.526), (245.294, 593.592), (482.543, 558.798), (708.659, 291.341)]
        self.assertEqual(len(p["bursts"]), 5)
        for burst, (onset, duration) in zip(p["bursts"], expected):
            self.assertAlmostEqual(burst["onset_s"] * 1000, onset, 3)
            self.assertAlmostEqual(burst["duration_s"] * 1000, duration, 3)
            self.assertIn("tau_s", burst)
        self.assertIsNone(p["soa_s"])
        self.assertAlmostEqual(p["total_s"], 1.041341, 6)  # the fourth burst outlasts the stroke
        self.assertTrue(p["conflicts"] and all(c["from_s"] < c["to_s"] for c in p["conflicts"]))
        self.assertTrue(any("0.16" in w for w in p["warnings"]))

    def test_too_fast_a_stroke_is_refused_with_a_time_that_works(self):
        self.write("a.toml", self.ARRAY)
        args = ["plan", "--array", "a.toml", "--algorithm", "tactile-brush", "--path", "M 10 30 L 45 10"]
        said = self.refused(2, *args, "--duration", "0.15").stderr
        times = [float(w.strip("(),;:")) for w in said.replace("=", " ").split()
                 if w.strip("(),;:").replace(".", "", 1).isdigit() and "." in w]
        works = [t for t in times if 0.15 < t < 2 and self.run_tool(*args, "--duration", t).returncode == 0]
        self.assertTrue(works, said)

    def test_points_can_be_dropped_instead(self):
        p = self.brush("--path", "M 10 30 L 45 10", "--duration", "0.15", "--drop-points")
        self.assertTrue(p["dropped"])
        self.assertEqual(len(p["bursts"]) + len(p["dropped"]), 5)
        self.assertTrue(all(b["duration_s"] >= 0 for b in p["bursts"]))

    def test_an_end_off_the_grid_is_refused_or_snapped(self):
        self.write("a.toml", self.ARRAY)
        args = ["--array", "a.toml", "--algorithm", "tactile-brush", "--path", "M 10 29 L 45 10", "--duration", "1"]
        self.refused(2, "plan", *args)
        self.assertAlmostEqual(self.plan(*args, "--snap")["bursts"][0]["y_mm"], 30.0, 9)


class Options(ToolTest):
    def test_fit_samples_both_ends(self):
        p = self.plan("--path", "M 0 0 L 40 0", "--duration", "1", "--timing", "fit")
        self.assertEqual(len(p["bursts"]), 16)
        self.assertAlmostEqual(p["soa_s"], 1 / 15, 9)
        self.assertAlmostEqual(p["bursts"][-1]["x_mm"], 40, 9)
        self.assertAlmostEqual(p["bursts"][0]["duration_s"], (1 / 15 - 0.0473) / 0.32, 9)

    def test_soa_sets_onsets_and_durations(self):
        p = self.plan("park2016-1", "--soa", "0.06")
        self.assertAlmostEqual(p["bursts"][1]["onset_s"], 0.06, 9)
        self.assertAlmostEqual(p["bursts"][1]["duration_s"], (0.06 - 0.0473) / 0.32, 9)

    def test_speed_and_duration_set_the_time(self):
        self.assertAlmostEqual(self.plan("--path", "M 0 10 L 40 10")["stroke"]["duration_s"], 40 / 60, 9)
        self.assertAlmostEqual(self.plan("--path", "M 0 10 L 40 10", "--speed", "80")["stroke"]["duration_s"], 0.5, 9)
        self.assertAlmostEqual(self.plan("park2016-1", "--speed", "50.26548245743669")["stroke"]["duration_s"], 1, 9)

    def test_continuous_lists_its_points_instead_of_bursts(self):
        p = self.plan("park2016-1", "--algorithm", "continuous")
        self.assertEqual(p["bursts"], [])
        self.assertIsNone(p["soa_s"])
        points = p["continuous"]["points"]
        self.assertEqual(len(points), 1401)
        self.assertAlmostEqual(points[-1]["t_s"], 1.4, 9)
        self.assertAlmostEqual(points[700]["x_mm"], 4.0, 6)

    def test_points_outside_can_be_clamped(self):
        p = self.plan("--path", "M 0 -5 L 40 -5", "--outside", "clamp")
        self.assertTrue(all(b["y_mm"] == 0 for b in p["bursts"]))

    def test_a_stroke_s_time_wins_over_the_speed_of_defaults(self):
        self.write("c.toml", "[defaults]\nspeed = 20\n")
        line = 'path = "M 0 20 L 40 20"\n'
        self.write("time.toml", f"[stroke]\n{line}duration_s = 1\n")
        self.write("speed.toml", f"[stroke]\n{line}speed_mm_s = 80\n")
        self.write("rests.toml", f"[stroke]\n{line}duration_s = 1\npauses = [[0.5, 0.2]]\n")
        self.write("none.toml", f"[stroke]\n{line}")
        self.write("times.csv", "t_s,x_mm,y_mm\n0,0,20\n1,40,20\n")
        svg = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 40 40" width="40mm" height="40mm"><path {} d="M 0 20 L 40 20"/></svg>'
        self.write("time.svg", svg.format('data-duration-s="1"'))
        self.write("none.svg", svg.format(""))

        def lasts(*args):
            return json.loads(self.ok("plan", *args, "--format", "json").stdout)["stroke"]["duration_s"]
        for name, own_s, asked_s in (("time.toml", 1.0, 2.0), ("speed.toml", 0.5, 2.0), ("rests.toml", 1.0, 2.2), ("times.csv", 1.0, 2.0),
                                     ("time.svg", 1.0, 2.0)):
            self.assertAlmostEqual(lasts(name, "--config", "c.toml"), own_s, msg=name)
            self.assertAlmostEqual(lasts(name, "--config", "c.toml", "--speed", "20"), asked_s, msg=name)
        self.assertAlmostEqual(lasts("park2016-1", "--config", "c.toml"), 1.4)
        for name in ("none.toml", "none.svg"):
            self.assertAlmostEqual(lasts(name, "--config", "c.toml"), 2.0, msg=name)
            self.assertAlmostEqual(lasts(name), 40 / 60, msg=name)
        self.assertAlmostEqual(lasts("--path", "M 0 20 L 40 20", "--config", "c.toml"), 2.0)
        self.assertAlmostEqual(lasts("none.toml", "--config", "c.toml", "--duration", "3"), 3.0)

    def test_config_gives_defaults_that_the_command_line_overrides(self):
        self.write("c.toml", '[array]\npreset = "palm-2x4"\n[defaults]\nphantom = "barycentric"\nsoa = 0.06\n')
        p = self.plan("--path", "M 0 0 L 60 0", "--config", "c.toml")
        self.assertEqual((p["array"]["name"], p["phantom"], p["soa_s"]), ("palm-2x4", "barycentric", 0.06))
        p = self.plan("--path", "M 0 0 L 40 0", "--config", "c.toml", "--soa", "0.07", "--array", "palm-3x3")
        self.assertEqual((p["array"]["name"], p["soa_s"]), ("palm-3x3", 0.07))
        p = self.plan("--path", "M 0 0 L 60 0", env={"TACTOR_CONFIG": "c.toml"})
        self.assertEqual(p["array"]["name"], "palm-2x4")
        self.write("xdg/tactor/tactor.toml", "[defaults]\nsoa = 0.05\n")
        p = self.plan("park2016-1", env={"XDG_CONFIG_HOME": str(self.dir / "xdg")})
        self.assertEqual(p["soa_s"], 0.05)

    def test_numbers_carry_nine_digits_and_repeat_in_any_locale(self):
        one = self.ok("plan", "park2016-1", "--format", "json").stdout
        self.assertIn("0.8944271909", one)
        for locale in ("de_DE.UTF-8", "fr_FR.UTF-8"):
            self.assertEqual(self.ok("plan", "park2016-1", "--format", "json", env={"LC_ALL": locale}).stdout, one)

    def test_csv_has_a_line_for_each_drive(self):
        rows = list(csv.DictReader(io.StringIO(self.ok("plan", "park2016-1", "--format", "csv").stdout)))
        self.assertEqual(len(rows), sum(len(b["drives"]) for b in self.plan("park2016-1")["bursts"]))
        self.assertEqual(float(rows[0]["x_mm"]), 20.0)

    def test_text_lists_the_bursts(self):
        text = self.ok("plan", "park2016-1").stdout
        self.assertIn("21 bursts", text)
        self.assertEqual(sum(line.strip().startswith(("0.", "1.")) for line in text.splitlines()), 21)


class StrokeFiles(ToolTest):
    def test_timed_points_from_a_csv_file(self):
        self.write("s.csv", "t_s,x_mm,y_mm,intensity\n0,0,10,1\n0.7,20,10,0.5\n1.4,40,10,1\n")
        p = self.plan("s.csv")
        self.assertEqual(len(p["bursts"]), 21)
        self.assertAlmostEqual(p["bursts"][10]["x_mm"], 20, 6)
        energy = sum(d["amplitude"] ** 2 for d in p["bursts"][10]["drives"])
        self.assertAlmostEqual(math.sqrt(energy), 0.5, 6)

    def test_the_first_line_of_a_csv_file_is_the_zero_of_the_stroke(self):
        self.write("late.csv", "t_s,x_mm,y_mm\n1000,0,10\n1001,40,30\n")
        self.write("zero.csv", "t_s,x_mm,y_mm\n0,0,10\n1,40,30\n")
        late, zero = (self.plan(f) for f in ("late.csv", "zero.csv"))
        self.assertEqual(late["start_s"], 0.0)
        self.assertEqual(late | {"stroke": zero["stroke"]}, zero)
        self.assertIn("starts at 0 s, 44.7214 mm in 1 s, 1.05 s of sound", self.ok("plan", "late.csv").stdout)
        self.assertIn("50400 frames (1.050 s)", self.ok("render", "late.csv", "-o", "late.wav").stdout)

    def test_text_json_and_csv_have_the_start_of_each_stroke(self):
        stroke = '[[stroke]]\npath = "M 0 0 L 40 0"\nduration_s = 0.7\n'
        self.write("one.toml", stroke + "start_s = 1000.0625\n")
        self.write("two.toml", stroke + "start_s = 3.5\n" + stroke)
        self.assertIn("\nstarts at 1000.0625 s, ", self.ok("plan", "one.toml").stdout)
        self.assertEqual(self.plan("one.toml")["start_s"], 1000.0625)
        self.assertEqual([p["start_s"] for p in self.plan("two.toml")["plans"]], [3.5, 4.27])
        text = self.ok("plan", "two.toml").stdout
        self.assertTrue("\nstarts at 3.5 s, " in text and "\nstarts at 4.27 s, " in text, text)
        rows = csv.DictReader(io.StringIO(self.ok("plan", "two.toml", "--format", "csv").stdout))
        self.assertEqual({(r["stroke"], r["start_s"]) for r in rows}, {("0", "3.5"), ("1", "4.27")})

    def test_repeated_times_are_warned_of_by_every_command(self):
        self.write("s.csv", "t_s,x_mm,y_mm\n0,0,10\n0.7,9,9\n0.7,20,10\n1.4,40,10\n")
        p = self.plan("s.csv")
        self.assertAlmostEqual(p["bursts"][10]["x_mm"], 20, 6)
        self.assertEqual(len(p["warnings"]), 1)
        warning = "warning: s.csv:4: repeats the time of the line before"
        self.assertIn(warning, self.ok("plan", "s.csv").stdout)
        for command in (("plan", "--format", "csv"), ("render", "-o", "s.wav"), ("plot", "-o", "s.svg"),
                        ("play", "-D", "null")):
            with self.subTest(command=command):
                self.assertIn("tactor: " + warning, self.ok(command[0], "s.csv", *command[1:]).stderr)
        warning = "warning: park2016: s.csv:4: repeats the time"
        self.assertEqual(self.ok("compare", "s.csv").stdout.count(warning), 1)
        self.assertIn("tactor: " + warning, self.ok("compare", "s.csv", "--format", "csv").stderr)

    def test_standard_input_holds_a_stroke_file(self):
        p = self.plan("-", stdin='[stroke]\npath = "M 0 10 L 40 30"\nduration_s = 1.0\n')
        self.assertEqual(len(p["bursts"]), 15)

    def test_several_strokes_in_one_file_are_all_listed(self):
        self.write("two.toml", '[[stroke]]\npath = "M 0 0 L 40 0"\nduration_s = 0.7\n'
                               '[[stroke]]\nstart_s = 2.0\npath = "M 0 40 L 40 40"\nduration_s = 0.7\n')
        plans = self.plan("two.toml")["plans"]
        self.assertEqual([q["start_s"] for q in plans], [0.0, 2.0])
        self.assertEqual([len(q["bursts"]) for q in plans], [11, 11])

    def test_svg_shapes_are_strokes_in_millimetres(self):
        self.write("s.svg", '<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="40mm" '
                            'viewBox="0 0 80 80"><g transform="translate(0 20)"><path d="M 0 0 L 80 0"/></g></svg>')
        p = self.plan("s.svg")
        self.assertAlmostEqual(p["stroke"]["length_mm"], 40, 6)
        self.assertAlmostEqual(p["bursts"][0]["y_mm"], 10, 6)

    def test_wrong_keys_of_movement_and_order_are_refused_with_their_place(self):
        for key in ('easing = "fast"', "speed_mm_s = [[0, 0]]", "intensity = [[0, 2]]", "pauses = [[0.5, -1]]", "repeat = 0", "pause_s = -1",
                    "start_s = -1", 'start_from = "x"', "reverse = 2", 'algorithm = "x"', 'phantom = "x"', "soa_s = 0", "burst_s = 0",
                    "level_db = 100", "fit = 2", "fit_margin_mm = 1"):
            self.write("s.toml", f'[stroke]\npath = "M 0 0 L 40 0"\n{key}\n')
            with self.subTest(key):
                self.assertEqual(self.refused(2, "plan", "s.toml").stdout, "")
        self.write("s.toml", "[[stroke]]\nrepeat = 2\n")
        self.refused(2, "plan", "s.toml")

    def test_a_stroke_that_would_start_before_the_piece_is_refused(self):
        line = '[[stroke]]\npath = "M 0 0 L 40 0"\nduration_s = 0.7\n'
        self.write("s.toml", line + line + 'start_s = -2\nstart_from = "end"\n')
        for command in (("plan", "s.toml"), ("render", "s.toml", "-o", "s.wav"), ("plot", "s.toml", "-o", "s.svg")):
            self.refused(2, *command)
        self.assertFalse((self.dir / "s.wav").exists() or (self.dir / "s.svg").exists())

    def test_strokes_of_a_file_start_repeat_and_choose(self):
        plans = self.plan(ROOT / "examples/strokes/knocks.toml")["plans"]
        self.assertEqual(len(plans), 7)
        starts = [p["start_s"] for p in plans]
        once = plans[0]["total_s"] + plans[1]["total_s"]
        self.assertAlmostEqual(starts[2], once + 0.3, 9)
        self.assertAlmostEqual(starts[6], 3 * once + 2 * 0.3 + 0.5, 9)
        self.assertEqual({p["algorithm"] for p in plans[:6]}, {"park2016"})
        self.assertEqual((plans[6]["algorithm"], plans[6]["phantom"]), ("continuous", "barycentric"))
        self.assertAlmostEqual(plans[1]["bursts"][0]["x_mm"], 30.0, 9)
        strongest = [max(d["amplitude"] for b in p["bursts"] for d in b["drives"]) for p in plans[:2]]
        self.assertAlmostEqual(20 * math.log10(strongest[1] / strongest[0]), -9.0, 6)

    def test_a_stroke_s_level_is_in_decibels_for_any_intensity_scale(self):
        sound = 'path = "M 10 20 L 30 20"\nduration_s = 0.3\nintensity = [[0, 0.4], [1, 0.8]]\n'
        self.write("s.toml", f"[[stroke]]\n{sound}[[stroke]]\n{sound}level_db = -9\n")
        self.write("measured.toml", '[array]\npreset = "palm-3x3"\n' +
                   "".join(f"[[tactor]]\ntactor = {i}\nthreshold_dbfs = -40\n" for i in range(9)))
        for scale in ((), ("--intensity-scale", "stevens"), ("--intensity-scale", "sl", "--sl", "12", "--array", "measured.toml")):
            for algorithm in ("park2016", "continuous"):
                plain, weak = self.plan("s.toml", "--algorithm", algorithm, *scale)["plans"]
                for a, b in zip(plain["bursts"] or plain["continuous"]["points"], weak["bursts"] or weak["continuous"]["points"]):
                    self.assertAlmostEqual(20 * math.log10(b["intensity"] / a["intensity"]), -9.0, 6)
                    for x, y in zip(a["drives"], b["drives"]):
                        self.assertAlmostEqual(20 * math.log10(y["amplitude"] / x["amplitude"]), -9.0, 6)

    def test_speed_keeps_pauses_and_duration_scales_them(self):
        self.write("s.toml", '[stroke]\npath = "M 0 0 L 40 0"\npauses = [[0.5, 0.5]]\nspeed_mm_s = 40\n')
        self.assertAlmostEqual(self.plan("s.toml")["stroke"]["duration_s"], 1.5, 9)
        self.assertAlmostEqual(self.plan("s.toml", "--speed", "20")["stroke"]["duration_s"], 2.5, 9)
        self.assertAlmostEqual(self.plan("s.toml", "--duration", "3")["stroke"]["duration_s"], 3.0, 9)

    def test_a_path_too_short_to_be_felt_as_motion_gives_a_warning(self):
        for command in (("plan",), ("render", "-o", "s.wav")):
            done = self.ok(*command, "--path", "M 10 10 h 3")
            self.assertIn("shorter than a fifth", done.stdout + done.stderr)
        self.assertNotIn("a fifth", self.ok("plan", "--path", "M 10 10 h 4.1").stdout)

    def test_every_example_can_be_planned(self):
        arrays = sorted((ROOT / "examples/arrays").glob("*.toml"))
        self.assertTrue(arrays)
        for array in arrays:
            first = self.plan("--path", "M 0 0 L 1 0", "--array", array, "--outside", "clamp")["array"]["tactors"][0]
            at = f"M {first['x_mm']} {first['y_mm']} l 0.1 0.1"
            self.assertTrue(self.plan("--path", at, "--array", array, "--outside", "clamp")["bursts"])
        strokes = [f for f in sorted((ROOT / "examples/strokes").iterdir()) if f.suffix in (".toml", ".csv", ".svg")]
        self.assertGreaterEqual({f.suffix for f in strokes}, {".toml", ".csv", ".svg"})
        for stroke in strokes:
            self.plan(stroke, *(("--array", "palm-2x4") if stroke.stem.endswith("-2x4") else ()))

    def test_each_built_in_array_has_presets_that_fit_it(self):
        for name in ("wave-2x4", "round-2x4"):
            for algorithm in ("park2016", "continuous"):
                self.plan(name, "--array", "palm-2x4", "--algorithm", algorithm)
            p = self.plan(name, "--array", "palm-2x4")
            self.assertNotIn("note", p["stroke"])
            self.assertEqual({d["tactor"] for b in p["bursts"] for d in b["drives"]}, set(range(8)), name)


if __name__ == "__main__":
    main()
