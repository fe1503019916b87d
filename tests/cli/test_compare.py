# SPDX-License-Identifier: MIT
"""tactor compare: its figures against a calculation from the plan, and its texts about refusals."""
import csv
import io
import json
import math
import struct
import xml.etree.ElementTree as ElementTree
import zlib

from harness import ToolTest, main

MOTIONS = {  # centre, first angle, sweep, duration
    "park2016-1": ((20, 20), -90, -180, 1.4),
    "park2016-2": ((0, 20), -90, 180, 1.4),
    "park2016-3": ((20, 20), 90, 270, 2.1),
    "park2016-4": ((20, 20), 0, -270, 2.1),
}
ALGORITHMS = ("park2016", "tactile-brush", "continuous")
FIGURES = ("rms_error_mm", "largest_error_mm", "speed_cv", "intensity_cv", "silent_share", "shared_share")


def on_circle(name, t):
    (x, y), first, sweep, duration = MOTIONS[name]
    angle = math.radians(first + sweep * t / duration)
    return x + 16 * math.cos(angle), y + 16 * math.sin(angle)


def cv(values):
    mean = sum(values) / len(values)
    return math.sqrt(sum((v - mean) ** 2 for v in values) / len(values)) / mean


def sounding(plan, t, last):
    """Returns the bursts that sound at t: begun and not ended, to the nanosecond."""
    closing = last and not any(abs(b["onset_s"] - t) <= 1e-9 for b in plan["bursts"])
    end = t - 1e-9 if closing else t + 1e-9
    return [b for b in plan["bursts"] if b["onset_s"] <= t + 1e-9 and b["onset_s"] + b["duration_s"] > end]


def felt(plan, i, last):
    """Returns position (or None), intensity and whether a tactor is shared, at i ms."""
    at = {t["tactor"]: (t["x_mm"], t["y_mm"]) for t in plan["array"]["tactors"]}
    now = [plan["continuous"]["points"][i]] if "continuous" in plan else sounding(plan, i / 1000, last)
    on = {}
    for burst in now:
        for d in burst["drives"]:
            on.setdefault(d["tactor"], []).append((d["amplitude"], burst["intensity"]))
    energy = {k: sum(a * a for a, _ in v) if len(v) == 1 else min(max(i for _, i in v) ** 2, sum(a * a for a, _ in v))
              for k, v in on.items()}
    total = sum(energy.values())
    place = tuple(sum(e * at[k][c] for k, e in energy.items()) / total for c in (0, 1)) if total else None
    return place, math.sqrt(total), any(len(v) > 1 for v in on.values())


def figures(plan, target):
    """Computes section 9 of the rendering model, one sample at a time."""
    duration = plan["stroke"]["duration_s"]
    n = math.floor(duration * 1000 + 1e-6) + 1
    samples = [felt(plan, i, abs(i / 1000 - duration) < 1e-9) for i in range(n)]
    errors = [math.dist(s[0], target(i / 1000)) for i, s in enumerate(samples) if s[0]]
    first = next(i for i, s in enumerate(samples) if s[0])
    held = []
    for s in samples[first:]:
        held.append(s[0] or held[-1])
    smooth = {i: tuple(math.fsum(p[c] for p in held[i - 50:i + 51]) / 101 for c in (0, 1))
              for i in range(50, len(held) - 50)}
    speeds = [math.dist(smooth[i + 1], smooth[i - 1]) / 0.002 for i in smooth
              if i - 1 in smooth and i + 1 in smooth and samples[first + i][0]]
    return {
        "rms_error_mm": math.sqrt(sum(e * e for e in errors) / len(errors)),
        "largest_error_mm": max(errors),
        "speed_cv": cv(speeds),
        "intensity_cv": cv([s[1] for s in samples]),
        "silent_share": sum(s[0] is None for s in samples) / n,
        "shared_share": sum(s[2] for s in samples) / n,
    }


class CompareTest(ToolTest):
    def compare(self, *args, **more):
        return json.loads(self.ok("compare", *args, "--format", "json", **more).stdout)

    def agrees(self, result, expected, where):
        for name in FIGURES:
            self.assertAlmostEqual(result[name], expected[name], delta=1e-6, msg=f"{where}: {name}")

    def check(self, *args, target, algorithms=ALGORITHMS):
        for result in self.compare(*args, "--algorithms", ",".join(algorithms))["results"]:
            p = self.plan(*args, "--algorithm", result["algorithm"])
            self.assertEqual(result["phantom"], p["phantom"])
            self.agrees(result, figures(p, target), (args, result["algorithm"]))


class Figures(CompareTest):
    def test_the_four_target_motions_agree_with_a_calculation_from_the_plan(self):
        for name in MOTIONS:
            for phantom in ("inverse-distance", "barycentric"):
                self.check(name, "--phantom", phantom, target=lambda t, name=name: on_circle(name, t))

    def test_silence_between_bursts(self):
        args = ("park2016-2", "--soa", "0.06")
        self.check(*args, target=lambda t: on_circle("park2016-2", t), algorithms=("park2016",))
        result = self.compare(*args, "--algorithms", "park2016")["results"][0]
        self.assertAlmostEqual(result["silent_share"], 0.33, delta=0.01)
        self.assertGreater(result["intensity_cv"], 0.5)

    def test_changing_speed_and_intensity(self):
        points = [(0, 0, 20, 1.0), (0.3, 20, 20, 0.4), (0.9017, 20, 30, 0.9), (1.2, 20, 40, 0.7)]
        self.write("s.csv", "t_s,x_mm,y_mm,intensity\n" + "".join(f"{t},{x},{y},{i}\n" for t, x, y, i in points))

        def target(t):
            for (t0, *p, _), (t1, *q, _) in zip(points, points[1:]):
                if t <= t1 + 1e-12:
                    u = (t - t0) / (t1 - t0)
                    return tuple(a + u * (b - a) for a, b in zip(p, q))
            return points[-1][1:3]
        self.check("s.csv", target=target)

    def test_the_model_ranks_the_two_algorithms_as_the_readme_does(self):
        gain = {}
        for name in MOTIONS:
            rows = {r["algorithm"]: r for r in self.compare(name)["results"]}
            park, brush = rows["park2016"], rows["tactile-brush"]
            self.assertLess(park["rms_error_mm"], brush["rms_error_mm"])
            self.assertLess(park["speed_cv"], brush["speed_cv"])
            gain[name] = [brush[f] - park[f] for f in ("rms_error_mm", "speed_cv")]
        for long in ("park2016-3", "park2016-4"):
            for short in ("park2016-1", "park2016-2"):
                self.assertGreater(gain[long][0], gain[short][0] + 0.4)
                self.assertLess(abs(gain[long][1] - gain[short][1]), 0.1)  # no such difference in speed


class Table(CompareTest):
    def test_every_chosen_algorithm_with_every_chosen_phantom(self):
        c = self.compare("park2016-1", "--algorithms", "continuous,park2016", "--phantoms", "barycentric,linear")
        self.assertEqual(c["schema"], "tactor-compare/1")
        self.assertIn("not a measurement", c["note"])
        self.assertEqual([(r["algorithm"], r["phantom"]) for r in c["results"]],
                         [("continuous", "barycentric"), ("continuous", "linear"),
                          ("park2016", "barycentric"), ("park2016", "linear")])
        self.assertAlmostEqual(c["stroke"]["length_mm"], 16 * math.pi, 6)
        self.assertIn("reconstructed", c["stroke"]["note"])
        self.assertEqual(len(c["array"]["tactors"]), 9)
        self.assertEqual([r["bursts"] for r in c["results"]], [None, None, 21, 21])

    def test_the_defaults_are_three_algorithms_and_the_chosen_phantom(self):
        self.assertEqual([r["algorithm"] for r in self.compare("park2016-1")["results"]], list(ALGORITHMS))
        self.write("c.toml", '[defaults]\nphantom = "log"\nalgorithm = "continuous"\n')
        results = self.compare("park2016-1", "--config", "c.toml")["results"]
        self.assertEqual([(r["algorithm"], r["phantom"]) for r in results], [(a, "log") for a in ALGORITHMS])
        self.assertEqual(len(self.compare("park2016-1", "--algorithm", "tactile-brush")["results"]), 1)

    def test_text_and_csv_hold_the_same_figures(self):
        results = self.compare("park2016-3", "--phantoms", "inverse-distance,gaussian")["results"]
        text = self.ok("compare", "park2016-3", "--phantoms", "inverse-distance,gaussian")
        rows = [line.split() for line in text.stdout.splitlines() if line.split(" ")[0] in ALGORITHMS]
        table = list(csv.DictReader(io.StringIO(self.ok("compare", "park2016-3", "--phantoms",
                                                        "inverse-distance,gaussian", "--format", "csv").stdout)))
        self.assertEqual((len(rows), len(table)), (6, 6))
        for row, line, result in zip(rows, table, results):
            self.assertEqual(row[:2], [result["algorithm"], result["phantom"]])
            shown = [f"{result[f]:.3f}" for f in FIGURES[:4]] + [f"{100 * result[f]:.1f}" for f in FIGURES[4:]]
            self.assertEqual(row[3:], shown)
            self.assertEqual([float(line[f]) for f in FIGURES], [result[f] for f in FIGURES])
            self.assertEqual(line["bursts"], "" if result["bursts"] is None else str(result["bursts"]))
        self.assertTrue(all(len(line) <= 80 for line in text.stdout.splitlines() if line[:4] in ("park", "tact", "cont")))
        self.assertIn("not a measurement", text.stdout)
        self.assertEqual(text.stdout.count("warning: tactile-brush"), 1)

    def test_strokes_of_a_file_are_compared_each(self):
        self.write("two.toml", '[[stroke]]\nname = "a, b"\npath = "M 0 0 L 40 0"\nduration_s = 0.7\n'
                               '[[stroke]]\nname = "c"\npath = "M 0 40 L 40 40"\nduration_s = 0.8\n')
        c = self.compare("two.toml")
        self.assertEqual([x["stroke"]["name"] for x in c["comparisons"]], ["a, b", "c"])
        self.assertEqual([len(x["results"]) for x in c["comparisons"]], [3, 3])
        rows = list(csv.DictReader(io.StringIO(self.ok("compare", "two.toml", "--format", "csv").stdout)))
        self.assertEqual([(r["stroke"], r["name"]) for r in rows], [("0", "a, b")] * 3 + [("1", "c")] * 3)
        self.assertEqual(self.ok("compare", "two.toml").stdout.count("error mm"), 2)

    def test_the_same_in_any_locale(self):
        for form in ("text", "json", "csv"):
            seen = {self.ok("compare", "park2016-2", "--format", form, env={"LC_ALL": locale}).stdout
                    for locale in ("C", "de_DE.UTF-8", "fr_FR.UTF-8")}
            self.assertEqual(len(seen), 1)


def pulled(onsets, places, sigma, sigma_v):
    """Solves (I + K) x = m of section 10, written out, by Gauss and Jordan."""
    n = len(onsets)
    a = [[float(i == j) for j in range(n)] for i in range(n)]
    for i in range(n - 1):
        k = (sigma / (sigma_v * (onsets[i + 1] - onsets[i]))) ** 2
        a[i][i] += k
        a[i + 1][i + 1] += k
        a[i][i + 1] -= k
        a[i + 1][i] -= k
    rows = [row + list(place) for row, place in zip(a, places)]
    for i in range(n):
        rows[i] = [v / rows[i][i] for v in rows[i]]
        for r in range(n):
            if r != i and rows[r][i]:
                rows[r] = [v - rows[r][i] * w for v, w in zip(rows[r], rows[i])]
    return [tuple(row[n:]) for row in rows]


class LowSpeed(CompareTest):
    ASK = ("--observer", "low-speed")

    def centre(self, plan, burst):
        at = {t["tactor"]: (t["x_mm"], t["y_mm"]) for t in plan["array"]["tactors"]}
        energy = sum(d["amplitude"] ** 2 for d in burst["drives"])
        return tuple(sum(d["amplitude"] ** 2 * at[d["tactor"]][c] for d in burst["drives"]) / energy for c in (0, 1))

    def test_each_burst_is_felt_where_the_equations_of_the_plan_put_it(self):
        for args, sigma, sigma_v in ((("park2016-3", "--algorithm", "park2016"), 5, 100),
                                     (("park2016-1", "--algorithm", "tactile-brush"), 8.5, 60)):
            p = self.plan(*args)
            result = self.compare(*args, *self.ASK, "--sigma-mm", str(sigma), "--sigma-v-mm-s", str(sigma_v))["results"][0]
            onsets = [b["onset_s"] for b in p["bursts"]]
            felt_at = pulled(onsets, [self.centre(p, b) for b in p["bursts"]], sigma, sigma_v)
            targets = [on_circle(args[0], t) for t in onsets]
            self.assertEqual(len(result["taps"]), len(onsets))
            for tap, t, place, target in zip(result["taps"], onsets, felt_at, targets):
                self.assertEqual(tap["onset_s"], t)
                self.assertLess(math.dist((tap["felt_x_mm"], tap["felt_y_mm"]), place), 1e-9)
                self.assertLess(math.dist((tap["target_x_mm"], tap["target_y_mm"]), target), 1e-3)
            errors = [math.dist(a, b) for a, b in zip(felt_at, targets)]
            length, asked = (sum(map(math.dist, chain, chain[1:])) for chain in (felt_at, targets))
            for name, value in (("rms_error_mm", math.sqrt(sum(e * e for e in errors) / len(errors))),
                                ("largest_error_mm", max(errors)), ("felt_length_mm", length),
                                ("target_length_mm", asked), ("length_ratio", length / asked)):
                self.assertAlmostEqual(result[name], value, delta=1e-6, msg=name)
            self.assertIsNone(result["silent_share"])

    def test_every_output_names_the_model_its_parameters_and_its_purpose(self):
        args = ("park2016-1", *self.ASK, "--sigma-mm", "7.5", "--sigma-v-mm-s", "120")
        told = self.compare(*args)
        self.assertEqual(told["observer"], {"name": "low-speed", "sigma_mm": 7.5, "sigma_v_mm_s": 120, "built_for": "taps"})
        self.ok("compare", *args, "-o", "c.svg")
        drawn = " ".join(t.text for t in ElementTree.parse(self.dir / "c.svg").getroot().iter(SVG + "text"))
        for text in (self.ok("compare", *args).stdout, told["note"], drawn):
            for word in ("low-speed", "7.5 mm", "120 mm/s", "built for taps", "nobody has fitted", "not a measurement"):
                self.assertIn(word, text)
        for line in csv.DictReader(io.StringIO(self.ok("compare", *args, "--format", "csv").stdout)):
            self.assertEqual([line[n] for n in ("observer", "sigma_mm", "sigma_v_mm_s", "built_for")],
                             ["low-speed", "7.5", "120", "taps"])

    def test_continuous_has_no_prediction_and_every_output_says_so(self):
        result = self.compare("park2016-1", *self.ASK)["results"][2]
        self.assertIsNone(result["refused"])
        self.assertIn("no bursts", result["unpredicted"])
        self.assertIsNone(result["rms_error_mm"])
        self.assertIn("no prediction: continuous has no bursts", self.ok("compare", "park2016-1", *self.ASK).stdout)
        line = list(csv.DictReader(io.StringIO(self.ok("compare", "park2016-1", *self.ASK, "--format", "csv").stdout)))[2]
        self.assertIn("no bursts", line["unpredicted"])
        self.assertEqual(line["rms_error_mm"], "")
        self.ok("compare", "park2016-1", *self.ASK, "--algorithms", "continuous", "-o", "c.svg")
        tree = ElementTree.parse(self.dir / "c.svg").getroot()
        self.assertTrue(any("no prediction" in t.text for t in find_kind(tree, "refused", "text")))
        self.assertEqual(find_kind(tree, "chart"), [])

    def test_the_picture_shows_where_each_burst_is_felt(self):
        told = self.compare("park2016-3", *self.ASK)["results"][0]["taps"]
        self.ok("compare", "park2016-3", *self.ASK, "-o", "c.svg")
        panel = find_kind(ElementTree.parse(self.dir / "c.svg").getroot(), "panel")[0]
        tactors = [(float(c.get("cx")), float(c.get("cy"))) for c in find_kind(panel, "tactor", "circle")]
        scale = (tactors[8][0] - tactors[0][0]) / 40
        dots = [(float(c.get("cx")), float(c.get("cy"))) for c in find_kind(panel, "felt-at", "circle")]
        self.assertEqual(len(dots), len(told))
        for dot, tap in zip(dots, told):
            self.assertLess(math.dist(dot, (tactors[0][0] + scale * tap["felt_x_mm"],
                                            tactors[0][1] + scale * tap["felt_y_mm"])), 0.01)

    def test_the_parameters_are_checked_and_may_be_defaults(self):
        self.refused(2, "compare", "park2016-1", "--observer", "fast")
        for option in ("--sigma-mm", "--sigma-v-mm-s"):
            for value in ("0", "-1", "1e9", "nan", "five"):
                self.refused(2, "compare", "park2016-1", *self.ASK, f"{option}={value}", says=[option])
            self.refused(2, "compare", "park2016-1", option, "5", says=[option, "--observer low-speed", "--compensate"])
        self.refused(2, "compare", "park2016-1", *self.ASK, "--sigma-mm", "5mm")
        self.write("c.toml", '[defaults]\nobserver = "low-speed"\nsigma-mm = 10\nsigma-v-mm-s = 50.0\n')
        told = self.compare("park2016-1", "--config", "c.toml")
        self.assertEqual((told["observer"]["sigma_mm"], told["observer"]["sigma_v_mm_s"]), (10, 50))
        self.ok("plan", "park2016-1", "--config", "c.toml")


SVG = "{http://www.w3.org/2000/svg}"


def find_kind(tree, kind, tag="*"):
    return [e for e in tree.iter() if e.get("class") == kind and (tag == "*" or e.tag == SVG + tag)]


def spots(polyline):
    numbers = [float(n) for n in polyline.get("points").replace(",", " ").split()]
    return list(zip(numbers[::2], numbers[1::2]))


class Pictures(CompareTest):
    def picture(self, *args):
        self.ok("compare", *args, "-o", "c.svg")
        return ElementTree.parse(self.dir / "c.svg").getroot()

    def test_the_bursts_are_drawn_where_they_are_felt(self):
        tree = self.picture("park2016-3")
        panels = find_kind(tree, "panel")
        self.assertEqual([p.get("data-algorithm") for p in panels], list(ALGORITHMS))
        p = self.plan("park2016-3")
        tactors = [(float(c.get("cx")), float(c.get("cy"))) for c in find_kind(panels[0], "tactor", "circle")]
        self.assertEqual(len(tactors), 9)
        scale = (tactors[8][0] - tactors[0][0]) / 40

        def page(x, y):
            return tactors[0][0] + scale * x, tactors[0][1] + scale * y
        dots = [(float(c.get("cx")), float(c.get("cy"))) for c in find_kind(panels[0], "felt-at", "circle")]
        self.assertEqual(len(dots), 31)
        for dot, burst in zip(dots, p["bursts"]):
            place, _, _ = felt(p | {"bursts": [burst]}, round(burst["onset_s"] * 1000), False)
            self.assertLess(math.dist(dot, page(*place)), 0.01)
        for x, y in spots(find_kind(panels[0], "target", "polyline")[0]):
            self.assertAlmostEqual(math.dist((x, y), page(20, 20)), 16 * scale, delta=0.06)
        start = find_kind(panels[1], "start", "circle")
        self.assertEqual(len(start), 1)
        self.assertEqual(len(find_kind(panels[2], "felt-at")), 0)
        self.assertTrue(find_kind(panels[2], "felt", "polyline"))

    def test_speeds_are_drawn_to_scale_beside_the_target(self):
        tree = self.picture("park2016-1", "--phantom", "barycentric")
        chart, = find_kind(tree, "chart")
        self.assertEqual([s.get("data-name") for s in find_kind(chart, "series")], ["target", *ALGORITHMS])
        x0, kx, y0, ky = (float(chart.get(f"data-{n}")) for n in ("x0", "x-scale", "y0", "y-scale"))
        speed = 16 * math.pi / 1.4
        for name in ("target", "continuous"):
            line = next(s for s in find_kind(chart, "series") if s.get("data-name") == name)
            for x, y in (s for curve in find_kind(line, "curve") for s in spots(curve)):
                self.assertAlmostEqual((y - y0) / ky, speed, delta=0.5)
                self.assertTrue(-0.001 < (x - x0) / kx < 1.401)
        text = [t.text for t in tree.iter(SVG + "text")]
        self.assertIn("speed (mm/s)", text)
        self.assertIn("time (s)", text)
        self.assertTrue(any("not a measurement" in t for t in text))

    def test_each_phantom_has_a_row_and_refusals_say_why(self):
        tree = self.picture(*Refusals.OFF_GRID, "--phantoms", "inverse-distance,linear,gaussian")
        self.assertEqual((len(find_kind(tree, "panel")), len(find_kind(tree, "chart"))), (9, 3))
        self.assertTrue(any("refused" in t.text for t in find_kind(tree, "refused", "text")))
        ids = [e.get("id") for e in tree.iter() if e.get("id")]
        self.assertEqual(len(ids), len(set(ids)))

    def test_png_and_pdf_are_written(self):
        self.ok("compare", "park2016-1", "-o", "c.pdf")
        self.assertTrue((self.dir / "c.pdf").read_bytes().startswith(b"%PDF-"))
        self.ok("compare", "park2016-1", "-o", "c.png", "--width", "120", "--dpi", "100")
        data = (self.dir / "c.png").read_bytes()
        self.assertAlmostEqual(struct.unpack(">I", data[16:20])[0], 120 / 25.4 * 100, delta=1)
        at, pixels = 8, b""
        while at < len(data):
            size, kind = struct.unpack(">I4s", data[at:at + 8])
            pixels += data[at + 8:at + 8 + size] if kind == b"IDAT" else b""
            at += 12 + size
        self.assertGreater(len(set(zlib.decompress(pixels))), 50)

    def test_impossible_pictures_are_refused(self):
        self.refused(2, "compare", "park2016-1", "-o", "c.gif")
        self.refused(2, "compare", "park2016-1", "-o", "c.svg", "--width", "5")
        for dpi in ("1e9", "300.5"):
            self.refused(2, "compare", "park2016-1", "-o", "c.png", "--dpi", dpi)
        self.write("two.toml", '[[stroke]]\npath = "M 0 0 L 40 0"\n[[stroke]]\npath = "M 0 40 L 40 40"\n')
        self.refused(2, "compare", "two.toml", "-o", "c.svg")
        self.assertFalse((self.dir / "c.svg").exists())


class Faces(CompareTest):
    def test_a_comparison_names_its_faces(self):
        asked = ("park2016-1", "--faces", "nearest", "--phantoms", "inverse-distance,log")
        told = self.compare(*asked)
        self.assertEqual(told["faces"], "nearest")
        self.assertEqual([r["refused"] is None for r in told["results"]], [True, False] * 3)
        self.assertIn("--faces: nearest goes with inverse-distance only", told["results"][1]["refused"])
        self.assertIn("is not used", told["results"][2]["warnings"][0])
        self.assertNotIn("faces", self.compare("park2016-1"))
        self.assertIn(", faces nearest\n", self.ok("compare", *asked).stdout)
        lines = list(csv.DictReader(io.StringIO(self.ok("compare", *asked, "--format", "csv").stdout)))
        self.assertEqual([line["faces"] for line in lines], ["nearest"] * 6)
        self.ok("compare", "park2016-1", "--faces", "nearest", "-o", "c.svg")
        self.assertIn("faces nearest", " ".join(ElementTree.parse(self.dir / "c.svg").getroot().itertext()))


class Refusals(CompareTest):
    OFF_GRID = ("--path", "M 3 3 L 37 30", "--duration", "1")

    def test_an_algorithm_that_cannot_play_the_stroke_says_why_in_its_row(self):
        rows = self.compare(*self.OFF_GRID)["results"]
        self.assertIn("--snap", rows[1]["refused"])
        self.assertNotIn("rms_error_mm", rows[1])
        self.assertEqual([rows[0]["refused"], rows[2]["refused"]], [None, None])
        self.assertIn("tactile-brush inverse-distance refused: ", self.ok("compare", *self.OFF_GRID).stdout)
        line = list(csv.DictReader(io.StringIO(self.ok("compare", *self.OFF_GRID, "--format", "csv").stdout)))[1]
        self.assertIn("--snap", line["refused"])
        self.assertEqual(line["rms_error_mm"], "")

    def test_options_that_allow_more_are_applied(self):
        self.assertIsNone(self.compare(*self.OFF_GRID, "--snap")["results"][1]["refused"])
        fast = ("park2016-3", "--duration", "0.12")
        self.assertIn("--drop-points", self.compare(*fast)["results"][1]["refused"])
        brush = self.compare(*fast, "--drop-points")["results"][1]
        self.assertIn("left out", brush["warnings"][0])

    def test_a_stroke_that_none_can_play_is_bad_input(self):
        r = self.refused(2, "compare", "--path", "M 20 20 L 60 20")
        self.assertEqual((r.stdout, r.stderr.count("\n")), ("", 1))
        self.refused(2, "compare", *self.OFF_GRID, "--algorithms", "tactile-brush")
        self.write("two.toml", '[[stroke]]\npath = "M 0 0 L 40 0"\n[[stroke]]\npath = "M 0 40 L 50 40"\n')
        r = self.refused(2, "compare", "two.toml", "--format", "json")
        self.assertEqual(len(json.loads(r.stdout)["comparisons"]), 2)

    def test_wrong_usage_is_refused(self):
        self.refused(2, "compare")
        self.refused(2, "compare", "park2016-1", "park2016-2")
        self.refused(2, "compare", "park2016-1", "--algorithms", "park2017")
        self.refused(2, "compare", "park2016-1", "--algorithms", "")
        self.refused(2, "compare", "park2016-1", "--algorithms", "park2016,")
        self.refused(2, "compare", "park2016-1", "--phantoms", "log,log")
        self.refused(2, "compare", "park2016-1", "--phantoms", "log", "--phantom", "log")
        self.refused(2, "compare", "park2016-1", "--format", "xml")
        self.refused(2, "compare", "park2016-1", "--soa", "0.08")
        self.refused(2, "compare", "park2016-1", "--duration", "3601")
        self.assertIn("Examples:\n  tactor compare", self.ok("compare", "--help").stdout)


if __name__ == "__main__":
    main()
