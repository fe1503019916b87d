# SPDX-License-Identifier: MIT
"""Every task that the tool knows, from its definition to its report.

Run as: python3 test_tasks.py TOOL SOURCE_ROOT FOLDER_OF_SCHEMAS
"""
import csv
import io
import json
import math
import pathlib
import re
import statistics
import sys

import jsonschema
from experiments import DESK, ExperimentTest
from harness import main
from pictures import Svg, box, number, overlap, read_bars
import check_r
from studies import STUDIES, measures, toml

SCHEMAS = pathlib.Path(sys.argv[3]).resolve()

# Keys of a run of each task; its main figure in the JSON of a run, and a column of the trials for R.
TASKS = {
    "choose": (dict(attribute="similarity", trials=8), "preference.all.mean", "chosen"),
    "rate": (dict(attribute="similarity", trials=8), "paired.difference", "rating"),
    "identify": (dict(attribute="movement", trials=8), "correct.soft.all.mean", "correct"),
    "detect": (dict(catch=0.5, trials=16), "dprime.mean", "signal"),
    "same-different": (dict(trials=16), "dprime.mean", "positive"),
    "estimate": (dict(question="?", vary="length_mm", values=[5, 10, 20], trials=18), "exponent.mean", "estimate"),
    "constant": (dict(question="?", vary="length_mm", values=[4, 8, 12, 16, 20], standard=12, trials_per_value=8), "psychometric.mean.pse", "value"),
    "adaptive": (dict(question="?", vary="length_mm", procedure="quest", range=[4, 20], standard=12, trials=40), "psychometric.mean.pse", "value"),
    "interval": (dict(vary="length_mm", procedure="1up3down", range=[4, 20], trials=60), "psychometric.tests.threshold.mean", "value"),
    "locate": (dict(trials=8), "drawings.means.error.mean", "error"),
    "trace": (dict(trials=8), "drawings.means.distance.mean", "distance"),
    "dissimilar": (dict(attribute="similarity", trials=12), "means.park - soft.all.mean", "response"),
    "oddity": (dict(trials=24), "dprime.mean", "positive"),
    "adjust": (dict(question="?", vary="length_mm", range=[4, 20], standard=12, trials=16), "adjustment.constant_error.mean", "value"),
}
WEST = toml("motion", "west", path="M20 0H0", duration=0.2)


def define(task):
    # Four methods have six pairs: neither number is that of the other.
    more = toml("method", "hard", burst=0.02) + toml("method", "wide", phantom="gaussian") if task == "dissimilar" else ""
    text = measures("desk.toml", more, toml("run", "only", task=task, **TASKS[task][0]), keys="gap_s = 0.1\n")
    return text.replace("[[method]]", WEST + "[[method]]", 1)


class EveryTask(ExperimentTest):
    def valid(self, text):
        """Returns JSON that its schema accepts."""
        told = json.loads(text)
        name = told["schema"].replace("/", "-")
        schema = json.loads((SCHEMAS / f"{name}.schema.json").read_text(encoding="utf-8"))
        self.assertEqual([e.message[:200] for e in jsonschema.Draft202012Validator(schema).iter_errors(told)], [])
        return told

    def test_the_table_has_all_tasks_of_the_tool_and_r_checks_each(self):
        self.write("desk.toml", DESK)
        self.write("x.toml", define("rate").replace('"rate"', '"none of them"'))
        known = re.search(r"known values: (.*)\)", self.refused(2, "experiment", "x.toml", "--dry-run").stderr)[1]
        self.assertEqual(known.split(", "), [*TASKS, "questionnaire"])
        for name, make in STUDIES.items():
            make(self.dir / name)
        texts = [json.loads(p.read_text())["experiment"]["text"] for p in self.dir.glob("*/sourcedata/sub-*/session.json")]
        checked = set(re.findall(r'^task = "(.*)"$', "\n".join([check_r.MEASURES, check_r.DRAWN, check_r.APART, check_r.ADJUSTED, *texts]), re.M))
        self.assertEqual(checked, set(TASKS))

    def test_from_definition_to_report(self):
        self.write("desk.toml", DESK)
        for task, (_, main_figure, column) in TASKS.items():
            with self.subTest(task=task):
                self.write("t.toml", define(task))
                dry = self.valid(self.ok("experiment", "t.toml", "--dry-run", "--format", "json").stdout)
                self.assertEqual([r["task"] for r in dry["runs"]], [task])
                power = self.valid(self.ok("experiment", "t.toml", "--power", "3", "--studies", "2", "--simulate", "jnd=3", "--format", "json").stdout)
                self.assertEqual(len(power["runs"][0]["power"]), task not in ("interval", "locate", "trace", "dissimilar"))  # they have nothing to compare with
                for code in "123":
                    self.simulate(code, definition="t.toml", folder=task, spec=f"seed={code},jnd=3,dprime=2,sigma=0.3")
                told = self.valid(self.ok("analyze", task, "--format", "json").stdout)["runs"]["only"]
                self.assertEqual((told["n"], told["trials"]), (3, 3 * len(dry["runs"][0]["trials"])))
                if task == "dissimilar":
                    self.assertEqual(list(told["means"]), ["park - soft", "park - hard", "park - wide", "soft - hard", "soft - wide", "hard - wide"])
                mean = told
                for key in main_figure.split("."):
                    mean = mean[key]
                summary = self.ok("analyze", task).stdout
                self.assertRegex(summary, rf"(?m)^only: .* {mean:.2f}( mm| dB| dBFS)?( \(|$)")
                self.assertIn(f" {mean:.2f} ", self.ok("analyze", task, "--format", "tables", "-o", f"{task}.svg").stdout)
                self.assertTrue(Svg(self.dir / f"{task}.svg").all("bars") + Svg(self.dir / f"{task}.svg").all("curves"))
                wide = list(csv.DictReader(io.StringIO(self.ok("analyze", task, "--format", "wide").stdout)))
                self.assertEqual(len(wide), 3)
                # A method of interval has too few trials for some thresholds.
                self.assertNotIn("", [v for row in wide for column, v in row.items() if task != "interval" or column.count(".") < 2])
                _, rows = self.trials(task)
                self.assertEqual(len(rows), told["trials"])
                self.assertNotEqual({r[column] for r in rows}, {"n/a"})
                report = self.ok("report", task).stdout
                self.assertIn(f"**only** ({task}): ", report)
                self.assertNotIn("not recorded", report.partition("## Stimuli")[2].partition("### As it was held")[0] + report.partition("## Data")[2])
                self.assertRegex(report.partition("### only")[2], rf" {mean:.4g}[ ,]")

    def test_a_motion_of_several_strokes_is_drawn_one_after_the_other(self):
        def strokes(*all):
            return "".join(f'[[stroke]]\npath = "{path}"\nduration_s = 0.2\nstart_s = {start}\n' for path, start in all)

        self.write("both.toml", strokes(("M 0 0 H 40", 0), ("M 0 40 H 40", 0)))  # at once
        self.write("many.toml", strokes(*((f"M 0 {3 * i} H 40", 0.3 * i) for i in range(13))))
        self.write("t.toml", '[experiment]\nname = "t"\narray = "palm-3x3"\nlevel = { dbfs = -20 }\n' + toml("method", "park")
                   + toml("motion", "both", file="both.toml") + toml("motion", "many", file="many.toml") + toml("run", "path", task="trace", trials=4))
        self.simulate("1", definition="t.toml", spec="seed=1,sigma=0")
        rows = list(csv.DictReader((self.dir / "study/sub-1/beh/sub-1_task-path_beh.tsv").read_text().splitlines(), delimiter="\t"))
        for motion, size, end_y in (("both", 102, 40), ("many", 332, 36)):
            targets = {r["target"] for r in rows if r["motion"] == motion}
            points = [tuple(map(float, p.split())) for p in targets.pop().split(";")]
            self.assertEqual((targets, len(points), points[0], points[-1][1:]), (set(), size, (0, 0, 0), (40, end_y)))
            self.assertEqual([y for _, _, y in points], sorted(y for _, _, y in points))
        predicted = json.loads((self.dir / "study/sourcedata/sub-1/session.json").read_text())["predictions"]
        self.assertEqual([(p["observer"], p["motion"]) for p in predicted], [(o, m) for m in ("both", "many") for o in ("centroid", "low-speed")])
        for p in predicted[:2]:
            felt = [float(point.split()[2]) for point in p["felt"].split(";")]
            self.assertEqual((felt, set(felt)), (sorted(felt), {0, 40}), p["observer"])
        # Without noise people draw what the centroid observer feels.
        told = self.analysis()["runs"]["path"]["by"]
        for motion in ("both", "many"):
            self.assertLess(told[f"park:{motion}"]["drawings"]["predicted"]["centroid"]["distance"], 0.01)

    def draw_at(self, code, angles):
        """Replaces the drawings of a participant by lines at an angle, degrees clockwise from the target, which depends on the method."""
        table = self.dir / f"study/sub-{code}/beh/sub-{code}_task-path_beh.tsv"
        lines = [line.split("\t") for line in table.read_text().splitlines()]
        response, method = (lines[0].index(name) for name in ("response", "method_1"))
        for line in lines[1:]:
            turn = math.radians(angles[line[method]])
            line[response] = ";".join(f"{i / 10} {20 + r * math.cos(turn):.6f} {20 + r * math.sin(turn):.6f}" for i, r in enumerate((-10, -5, 0, 5, 10)))
        table.write_text("".join("\t".join(line) + "\n" for line in lines))

    def test_directions_over_a_half_turn_are_near_each_other(self):
        self.write("t.toml", '[experiment]\nname = "t"\narray = "palm-3x3"\nlevel = { dbfs = -20 }\n' + toml("method", "park")
                   + toml("motion", "east", path="M 10 20 H 30", duration=0.2) + toml("run", "path", task="trace", trials=4)
                   + toml("group", "near") + toml("group", "turned"))
        # By participant the angle, clockwise, from the target to what is drawn.
        angles = {"near": {"1": -3.0, "2": 1.0, "3": 5.0, "4": 2.0}, "turned": {"5": 174.0, "6": -178.0, "7": 179.0, "8": -173.0}}
        for group, people in angles.items():
            for code, angle in people.items():
                self.simulate(code, "--group", group, definition="t.toml")
                self.draw_at(code, {"park": angle})
        told = self.valid(self.ok("analyze", "study", "--format", "json").stdout)["runs"]["path"]["methods"]["direction"]
        near, turned = ([a % 360 if group == "turned" else a for a in angles[group].values()] for group in angles)
        means = told["group_means"]
        self.assertEqual({group: m["n"] for group, m in means.items()}, {"near": 4, "turned": 4})
        self.assertAlmostEqual((means["turned"]["mean"] - means["near"]["mean"]) % 360, statistics.mean(turned) - statistics.mean(near), 3)
        self.assertAlmostEqual(means["turned"]["se"], statistics.stdev(turned) / 2, 3)
        # With one factor and as many people in both groups, F is the square of Student's t.
        t = (statistics.mean(turned) - statistics.mean(near)) / math.sqrt((statistics.variance(near) + statistics.variance(turned)) / 4)
        self.assertAlmostEqual(told["group_anova"]["group"]["F"] / t ** 2, 1.0, 4)
        pair, = told["group_pairs"]
        self.assertEqual((pair["a"], pair["b"], pair["df"]), ("near", "turned", 6))
        self.assertAlmostEqual(pair["t"] / -t, 1.0, 4)
        self.assertAlmostEqual(pair["d"] / (-t / math.sqrt(2)), 1.0, 4)
        self.assertEqual(pair["p"], pair["p_holm"])
        alone = self.valid(self.ok("analyze", "study", "--participants", "5,6,7,8", "--format", "json").stdout)["runs"]["path"]["drawings"]["means"]["direction"]
        self.assertAlmostEqual(alone["mean"] % 360, statistics.mean(turned), 3)
        self.assertAlmostEqual(alone["se"], statistics.stdev(turned) / 2, 3)
        self.assertRegex(self.ok("analyze", "study").stdout, r"path by group: distance, p [^;]*; frechet, .*; direction, p < 0\.001; ")
        self.assertRegex(self.ok("analyze", "study", "--format", "tables").stdout, r"(?s)distance by group:\n    with the group as a factor between participants:\n    near   [^\n]*\n    turned [^\n]*\n    near - turned: [^\n]* t\(6\) = ")

    def test_a_wide_table_has_the_directions_that_are_compared(self):
        self.write("t.toml", '[experiment]\nname = "t"\narray = "palm-3x3"\nlevel = { dbfs = -20 }\n' + toml("method", "park") + toml("method", "soft")
                   + toml("motion", "east", path="M 10 20 H 30", duration=0.2) + toml("run", "path", task="trace", trials=4))
        angles = {"1": (-170.2, 169.5), "2": (-176.2, 175.5), "3": (176.8, -177.5), "4": (179, -179)}
        for code, (park, soft) in angles.items():
            self.simulate(code, definition="t.toml")
            self.draw_at(code, {"park": park, "soft": soft})
        wide = list(csv.DictReader(io.StringIO(self.ok("analyze", "study", "--format", "wide").stdout)))
        columns = {m: [float(row[f"path.{m}.direction"]) for row in wide] for m in ("park", "soft")}
        for at, m in enumerate(columns):
            for value, (_, pair) in zip(columns[m], angles.items(), strict=True):
                self.assertAlmostEqual(math.remainder(value - pair[at], 360), 0, 3)
        differences = [a - b for a, b in zip(columns["park"], columns["soft"])]
        for d, (park, soft) in zip(differences, angles.values()):
            self.assertAlmostEqual(d, math.remainder(park - soft, 360), 3)
        told = self.analysis()["runs"]["path"]["methods"]["direction"]
        self.assertAlmostEqual(told["pairs"][0]["difference"], statistics.mean(differences), 9)
        for m, values in columns.items():
            self.assertAlmostEqual(told["means"][m]["mean"], statistics.mean(values), 9)
        self.assertLess(statistics.stdev(float(row["path.direction"]) for row in wide), 10)

    def test_the_first_study_of_power_has_the_figures_of_simulated_drawings(self):
        self.write("t.toml", '[experiment]\nname = "t"\narray = "palm-3x3"\nlevel = { dbfs = -20 }\n' + toml("method", "park")
                   + toml("method", "soft", phantom="barycentric") + toml("motion", "east", path="M 10 20 H 30", duration=0.2)
                   + toml("run", "path", task="trace", trials=8))
        for code in ("01", "02", "03", "04", "05", "06"):
            self.simulate(code, definition="t.toml", spec="seed=1,sigma=3")
        run, = self.valid(self.ok("experiment", "t.toml", "--power", "6", "--studies", "1", "--simulate", "seed=1,sigma=3", "--format", "json").stdout)["runs"]
        power = {c["figure"]: c["power"][0] for c in run["comparisons"]}
        told = self.analysis()["runs"]["path"]
        self.assertEqual(list(power), ["distance", "frechet", "length", "direction", "curvature"])
        for figure, at in power.items():
            pair, = told["methods"][figure]["pairs"]
            self.assertEqual((at["untested"], at["significant"]), (0, int(pair["p"] < 0.05)), figure)
        # Both ends of the path, 20 mm long, move by 3 mm: over 8 trials the directions of people differ by 4 degrees, and the lengths by 8 %.
        people = told["drawings"]["participants"].values()
        for figure, expected in (("direction", math.degrees(3 * math.sqrt(2) / 20 / math.sqrt(8))), ("length", 3 * math.sqrt(2) / 20 / math.sqrt(8))):
            spread = statistics.stdev(p[figure] for p in people)
            self.assertTrue(expected / 3 < spread < expected * 3, (figure, spread, expected))

    def test_the_summary_tests_groups_once_by_figure(self):
        self.write("desk.toml", DESK)
        keys = dict(task="constant", question="?", vary="length_mm", values=[4, 8, 12, 16, 20], standard=12, trials_per_value=8)
        self.write("t.toml", measures("desk.toml", toml("run", "long", **keys), toml("group", "a"), toml("group", "b"), keys="gap_s = 0.1\nsessions = 2\n"))
        for code, group in zip("1234", "aabb"):
            for session in "12":
                self.simulate(code, "--group", group, "--session", session, definition="t.toml", spec="seed=1,jnd=3,pse_sd=1,jnd_sd=1")
        told = self.analysis()["runs"]["long"]
        p = {factor: {figure: told[factor][figure]["group_anova"]["group"]["p"] for figure in ("pse", "jnd")} for factor in ("methods", "sessions")}
        self.assertNotEqual(*(round(p[factor]["pse"], 3) for factor in p))
        self.assertIn("\nlong by group: " + "; ".join(f"{figure}, p = {v:.3f}" for figure, v in p["methods"].items()) + "\n", self.ok("analyze", "study").stdout)

    def test_a_picture_has_methods_in_the_plane_and_names_of_all_pairs(self):
        self.write("desk.toml", DESK)
        self.write("t.toml", define("dissimilar"))
        for code in "123":
            self.simulate(code, definition="t.toml", folder="study", spec=f"seed={code},sigma=8")
        self.ok("analyze", "study", "-o", "a.svg")
        picture, told = Svg(self.dir / "a.svg"), self.analysis()["runs"]["only"]
        panel, = picture.all("curves")
        self.assertEqual(panel.get("data-title"), f"only: methods (n = 3, stress {told['scaling']['stress']:.3f})")
        x0, kx, y0, ky = (number(panel, f"data-{k}") for k in ("x0", "x-scale", "y0", "y-scale"))
        self.assertAlmostEqual(abs(ky / kx), 1, places=6)  # to scale
        names = [e for e in panel.iter() if e.get("class") == "name"]
        dots = [e for e in panel.iter() if e.get("class") == "dot"]
        for dot, name, (method, (x, y)) in zip(dots, names, told["scaling"]["places"].items(), strict=True):
            self.assertEqual(name.text, method)
            self.assertAlmostEqual((number(dot, "cx") - x0) / kx, x, delta=0.2)
            self.assertAlmostEqual((number(dot, "cy") - y0) / ky, y, delta=0.2)
        panel, = picture.all("bars")
        legend = [e for e in panel.iter() if e.get("class") == "legend" and e.text]
        self.assertEqual([e.text for e in legend], list(told["means"]))
        texts = [box(e) for e in legend + [e for e in panel.iter() if e.get("class") == "group"]]
        self.assertFalse([(a, b) for i, a in enumerate(texts) for b in texts[:i] if overlap(a, b)])

    def test_methods_at_one_place_of_the_plane_share_a_point(self):
        self.write("desk.toml", DESK)
        self.write("t.toml", define("dissimilar").replace("[[run]]", toml("method", "soft too", burst=0.05) + "[[run]]").replace("trials = 12", "trials = 40"))
        self.simulate("1", definition="t.toml", folder="study", spec="seed=1,sigma=0")
        self.ok("analyze", "study", "-o", "a.svg")
        panel, = Svg(self.dir / "a.svg").all("curves")
        names = [e for e in panel.iter() if e.get("class") == "name"]
        self.assertEqual([e.text for e in names], ["park", "soft, soft too", "hard", "wide"])
        self.assertEqual(len([e for e in panel.iter() if e.get("class") == "dot"]), 4)
        self.assertFalse([(a.text, b.text) for i, a in enumerate(names) for b in names[:i] if overlap(box(a), box(b))])

    def test_drawings_have_one_scale_and_points_where_they_start(self):
        self.write("desk.toml", DESK)
        self.write("t.toml", define("trace").replace("M20 0H0", "M20 0H8"))
        for code in "12":
            self.simulate(code, definition="t.toml", folder="study", spec=f"seed={code},sigma=2")
        self.ok("analyze", "study", "-o", "a.svg")
        panels = Svg(self.dir / "a.svg").all("curves")
        self.assertEqual(len(panels), 4)
        self.assertEqual(len({(p.get("data-x-scale"), p.get("data-y-scale")) for p in panels}), 1)
        ticks = [[e.text for e in p.iter() if e.get("class") == "tick-label"] for p in panels]
        self.assertTrue(ticks[0])
        self.assertEqual([t for t in ticks if t != ticks[0]], [])
        for p in panels:
            dots = [e for e in p.iter() if e.get("class") == "dot"]
            self.assertEqual(len(dots), len([e for e in p.iter() if e.get("class") in ("curve", "mean-curve")]))
            x0, kx, y0, ky = (number(p, f"data-{k}") for k in ("x0", "x-scale", "y0", "y-scale"))
            at = (number(dots[0], "cx") - x0) / kx, (number(dots[0], "cy") - y0) / ky  # the target comes first
            self.assertLess(math.dist(at, (20, 0) if ":west" in p.get("data-title") else (0, 0)), 0.1, p.get("data-title"))

    def test_means_of_cells_are_compared_between_methods_and_sessions(self):
        self.write("desk.toml", DESK)
        text = measures("desk.toml", toml("method", "hard", burst=0.02),
                        toml("run", "marks", task="rate", attribute="similarity", trials=24, scale=101),
                        toml("run", "pair", task="rate", attribute="similarity", trials=16, methods=["park", "soft"]),
                        toml("run", "names", task="identify", trials=48), keys="gap_s = 0.1\nsessions = 2\n")
        self.write("t.toml", text.replace("[[method]]", WEST + "[[method]]", 1))
        for code in "1234":
            for session in "12":
                self.simulate(code, "--session", session, definition="t.toml", folder="study", spec=f"seed={code},sigma=30")
        told = self.valid(self.ok("analyze", "study", "--format", "json").stdout)["runs"]
        self.assertEqual({name: (list(run.get("methods", {})), list(run["sessions"])) for name, run in told.items()},
                         {"marks": (["rating"], ["rating"]), "pair": ([], ["rating"]), "names": (["correct"], ["correct"])})
        _, rows = self.trials("study")
        wide = list(csv.DictReader(io.StringIO(self.ok("analyze", "study", "--format", "wide").stdout)))
        for run, column, scale in (("marks", "rating", 1), ("names", "correct", 100)):
            for factor, levels in (("method", ("park", "soft", "hard")), ("session", ("1", "2"))):
                with self.subTest(run=run, factor=factor):
                    # The mean over cells of the means of a participant's trials in a level.
                    def figure(code, level):
                        cells = {}
                        for r in rows:
                            if (r["run"], r["participant"], r[factor]) == (run, code, level):
                                cells.setdefault((r["method"], r["motion"]), []).append(scale * float(r[column]))
                        return statistics.mean(map(statistics.mean, cells.values()))

                    compared = told[run][factor + "s"][column]
                    self.assertEqual((compared["n"], list(compared["means"])), (4, list(levels)))
                    for level in levels:
                        self.assertAlmostEqual(compared["means"][level]["mean"], statistics.mean(figure(c, level) for c in "1234"), places=9)
                    p = sorted(pair["p"] for pair in compared["pairs"])
                    self.assertEqual(len(p), len(levels) * (len(levels) - 1) // 2)
                    for pair in compared["pairs"]:
                        differences = [figure(c, pair["a"]) - figure(c, pair["b"]) for c in "1234"]
                        mean, sd = statistics.mean(differences), statistics.stdev(differences)
                        self.assertAlmostEqual(pair["difference"], mean, places=9)
                        self.assertAlmostEqual(pair["t"], mean / (sd / 2), places=7)
                    self.assertAlmostEqual(min(pair["p_holm"] for pair in compared["pairs"]), min(1, len(p) * p[0]), places=12)
                    if factor == "session":
                        for row in wide:
                            for n in levels:
                                own = [float(v) for c, v in row.items() if c.startswith(f"{run}.") and c.endswith(f".ses_{n}")]
                                self.assertEqual(len(own), 6)
                                self.assertAlmostEqual(statistics.mean(own), figure(row["participant_id"][4:], n), places=9)
                    self.assertIn(f"{column} by {factor}, within participants:", self.ok("analyze", "study", "--format", "tables").stdout)

    def test_figures_are_compared_between_methods_and_sessions(self):
        self.write("desk.toml", DESK)
        values = dict(vary="length_mm", values=[4, 8, 12, 16, 20], trials_per_value=20)
        self.write("t.toml", measures("desk.toml", toml("run", "length", task="constant", question="?", standard=12, **values),
                                      toml("run", "felt", task="interval", **values), toml("run", "there", task="detect", catch=0.5, trials=80),
                                      toml("run", "same", task="same-different", trials=16), keys="gap_s = 0.1\nsessions = 2\n"))
        for code in "1234":
            for session in "12":
                self.simulate(code, "--session", session, definition="t.toml", folder="study", spec=f"seed={code},jnd=3,pse={10 + int(code)}")
        told = self.valid(self.ok("analyze", "study", "--format", "json").stdout)["runs"]
        self.assertEqual({name: (list(run.get("methods", {})), list(run["sessions"])) for name, run in told.items()},
                         {"length": (["pse", "jnd"],) * 2, "felt": (["threshold"],) * 2, "there": (["dprime", "c"],) * 2, "same": ([], ["dprime", "c"])})
        text = self.ok("analyze", "study", "--format", "tables").stdout
        for run, figure in (("length", "pse"), ("length", "jnd"), ("felt", "threshold"), ("there", "dprime")):
            with self.subTest(run=run, figure=figure):
                # Takes the figures of METHOD:MOTION, which with one motion are those of the method.
                kind = "dprime" if run == "there" else "psychometric"
                of = [[p[figure] for p in told[run]["by"][f"{m}:east"][kind]["participants"].values()] for m in ("park", "soft")]
                differences = [a - b for a, b in zip(*of)]
                mean, sd, n = statistics.mean(differences), statistics.stdev(differences), len(differences)
                compared = told[run]["methods"][figure]
                self.assertEqual([compared["n"], compared["anova"], *compared["means"]], [4, None, "park", "soft"])
                pair, = compared["pairs"]
                self.assertEqual([pair["a"], pair["b"], pair["df"], pair["p_holm"]], ["park", "soft", 3, pair["p"]])
                for key, expected in (("difference", mean), ("t", mean / (sd / math.sqrt(n))), ("d_z", mean / sd)):
                    self.assertAlmostEqual(pair[key], expected, places=9)
                self.assertAlmostEqual(pair["ci"][1] - pair["ci"][0], 2 * 3.182446305284263 * sd / math.sqrt(n), places=9)  # t(3) at 97.5 %
                self.assertIn(f"park - soft: {mean:.2f} (", text)
        # The columns of each session give the tests between sessions.
        wide = list(csv.DictReader(io.StringIO(self.ok("analyze", "study", "--format", "wide").stdout)))
        for run, figure in (("length", "pse"), ("length", "jnd"), ("felt", "threshold"), ("there", "dprime"), ("same", "dprime")):
            of = [[float(row[f"{run}.{figure}.ses_{n}"]) for row in wide] for n in "12"]
            compared = told[run]["sessions"][figure]
            differences = [a - b for a, b in zip(*of)]
            for n, values in zip("12", of):
                self.assertAlmostEqual(compared["means"][n]["mean"], statistics.mean(values), places=9)
            self.assertAlmostEqual(compared["pairs"][0]["t"], statistics.mean(differences) / (statistics.stdev(differences) / 2), places=7)
        # A picture has each figure by method and by session, with intervals within participants and a dot for each of them.
        self.ok("analyze", "study", "-o", "a.svg")
        panels = {p.get("data-title"): p for p in Svg(self.dir / "a.svg").all("bars")}
        self.assertEqual(len([title for title in panels if " by " in title]), 12)
        for factor, columns in (("method", {m: [p["jnd"] for p in told["length"]["by"][f"{m}:east"]["psychometric"]["participants"].values()] for m in ("park", "soft")}),
                                ("session", {n: [float(row[f"length.jnd.ses_{n}"]) for row in wide] for n in "12"})):
            panel = panels[f"length: jnd by {factor} (n = 4)"]
            drawn = read_bars(panel)
            self.assertEqual(list(drawn), [(level, "") for level in columns])
            self.assertEqual(len([e for e in panel.iter() if e.get("class") == "value"]), 8)
            a, b = columns.values()
            # Cousineau and Morey for two conditions: the half width is that of the paired difference by the square root of 2.
            half = 3.182446305284263 * statistics.stdev(x - y for x, y in zip(a, b)) / math.sqrt(2 * 4)
            for level, values in columns.items():
                mean, (low, high) = drawn[level, ""]
                self.assertAlmostEqual(mean, statistics.mean(values), delta=0.02)
                self.assertAlmostEqual(low, statistics.mean(values) - half, delta=0.02)
                self.assertAlmostEqual(high, statistics.mean(values) + half, delta=0.02)
        self.assertIn("pse by session, within participants", self.ok("report", "study").stdout)
        tsv = self.ok("analyze", "study", "--format", "tsv").stdout
        slopes = "+ (1 + I(value - 12) + method + factor(session) | participant)"
        self.assertIn(f'# glmer(positive ~ I(value - 12) * method * factor(session) {slopes}, family = binomial("probit"), ', tsv)

    def test_a_picture_of_levels_leaves_0_db_out(self):
        self.write("desk.toml", DESK)
        self.write("t.toml", measures("desk.toml", toml("run", "level", task="constant", question="?", vary="level_dbfs",
                                                        values=[-32, -28, -24, -20, -16], standard=-24, trials_per_value=20)))
        for code in "123":
            self.simulate(code, definition="t.toml", folder="study", spec=f"seed={code},jnd=3")
        self.ok("analyze", "study", "-o", "a.svg")
        panels = {p.get("data-title"): p for p in Svg(self.dir / "a.svg").all("bars")}
        ends = {name: [number(e, y) for e in panels[f"level: {name} by method (n = 3)"].iter() if e.get("class") == "error" for y in ("y1", "y2")]
                for name in ("pse", "jnd")}
        self.assertGreater(max(ends["pse"]) - min(ends["pse"]), 40)  # pt: some dB fill the panel
        foot = [number(e, "y") + number(e, "height") for e in panels["level: jnd by method (n = 3)"].iter() if e.get("class") == "bar"]
        self.assertAlmostEqual(foot[0], number(panels["level: jnd by method (n = 3)"], "data-y0"), places=2)

    def find_odd(self, row):
        """Returns the place of the stimulus that differs."""
        methods = [row[f"method_{i}"] for i in (1, 2, 3)]
        self.assertEqual(len(set(methods)), 2)
        return next(i for i, m in enumerate(methods, 1) if methods.count(m) == 1)

    def test_three_stimuli_of_which_one_differs(self):
        self.write("desk.toml", DESK)
        self.write("t.toml", measures("desk.toml", toml("run", "two", task="oddity", trials=48, practice=2),
                                      toml("run", "far", task="oddity", vary="length_mm", values=[8, 12, 20], standard=4, trials_per_value=12),
                                      toml("run", "same", task="same-different", trials=16), keys="gap_s = 0.1\nsessions = 2\n"))
        dry = self.valid(self.ok("experiment", "t.toml", "--dry-run", "--session", "1", "--format", "json").stdout)
        self.assertEqual({r["name"]: {("method_3" in t, "plan_3" in t) for t in r["trials"]} for r in dry["runs"]},
                         {"two": {(True, True)}, "far": {(True, True)}, "same": {(False, False)}})
        self.assertRegex(self.ok("experiment", "t.toml", "--dry-run", "--session", "1").stdout, r"method_2 +method_3 +value")
        for code in "1234":
            for session in "12":
                self.simulate(code, "--session", session, definition="t.toml", folder="study", spec=f"seed={code},dprime=2.5,lapse=0.02")
        beh = self.dir / "study/sub-1/ses-1/beh"
        tables = {run: list(csv.DictReader((beh / f"sub-1_ses-1_task-{run}_beh.tsv").read_text().splitlines(), delimiter="\t")) for run in ("two", "far", "same")}
        self.assertFalse({"method_3", "plan_3", "frame_3"} & set(tables["same"][0]))
        for run, names in (("two", {"park", "soft"}), ("far", {"park", "soft", "standard"})):
            counts = {}
            for r in tables[run]:
                odd = self.find_odd(r)
                self.assertEqual([r[f"plan_{i}"] == r[f"plan_{odd}"] for i in (1, 2, 3)], [i == odd for i in (1, 2, 3)])
                frames = [int(r[f"frame_{i}"]) for i in (1, 2, 3)]
                self.assertEqual(frames, sorted(set(frames)))
                key = odd, r[f"method_{odd}"], r.get("value")
                counts[key] = counts.get(key, 0) + 1
            self.assertEqual(set().union(*({r["method_1"], r["method_2"], r["method_3"]} for r in tables[run])), names)
            if run == "two":
                self.assertEqual(counts, {(i, m, None): 8 for i in (1, 2, 3) for m in names})
            else:
                values = {str(float(v)): sum(n for k, n in counts.items() if float(k[2]) == v) for v in (8, 12, 20)}
                self.assertEqual(values, {"8.0": 24, "12.0": 24, "20.0": 24})

        # The integral of Ennis, by Simpson's rule, and its inverse.
        def share(dprime, parts=2000, end=8):
            cdf = statistics.NormalDist().cdf
            f = [2 * (cdf(-z * 3**0.5 + dprime * (2 / 3)**0.5) + cdf(-z * 3**0.5 - dprime * (2 / 3)**0.5)) * math.exp(-z * z / 2) / (2 * math.pi)**0.5
                 for z in (end * i / parts for i in range(parts + 1))]
            return end / parts / 3 * (f[0] + f[-1] + 4 * sum(f[1:-1:2]) + 2 * sum(f[2:-1:2]))

        def dprime(right, trials):
            low, high = 0, 20
            while high - low > 1e-9:
                middle = (low + high) / 2
                low, high = (middle, high) if share(middle) < (right + 0.5) / (trials + 1.5) else (low, middle)
            return high if right > trials / 3 else 0

        told = self.valid(self.ok("analyze", "study", "--format", "json").stdout)["runs"]
        _, rows = self.trials("study")
        self.assertEqual([list(told["far"]["by"]), list(told["two"].get("by", {}))], [[f"{m}:east:{v}" for m in ("park", "soft") for v in (8, 12, 20)], []])
        for name, run, keys in (("two", told["two"], {}), ("far", told["far"], {}), ("far", told["far"]["by"]["soft:east:12"], {"method": "soft", "value": "12"})):
            found = run["dprime"]
            for code, p in found["participants"].items():
                own = [r for r in rows if r["run"] == name and r["participant"] == code and all(r[k] == v for k, v in keys.items())]
                right = sum(r["positive"] == "1" for r in own)
                self.assertEqual((p["right"], p["trials"]), (right, len(own)))
                self.assertAlmostEqual(p["dprime"], dprime(right, len(own)), places=6)
            each = [p["dprime"] for p in found["participants"].values()]
            self.assertAlmostEqual(found["mean"], statistics.mean(each), places=9)
            self.assertAlmostEqual(found["se"], statistics.stdev(each) / 2, places=9)
            percents = [100 * p["right"] / p["trials"] for p in found["participants"].values()]
            self.assertAlmostEqual(found["correct"]["mean"], statistics.mean(percents), places=9)
            g = sum(2 * (k * math.log(3 * k / n) + ((n - k) * math.log(1.5 * (n - k) / n) if k < n else 0))
                    for k, n in ((p["right"], p["trials"]) for p in found["participants"].values()) if 3 * k > n)
            self.assertAlmostEqual(found["likelihood_ratio"]["value"], g, places=9)
        # The answers are those of the tables, and the observer is right as often as the model says.
        right = [self.find_odd(r) == int(r["response"]) for s in "12" for code in "1234" for r in csv.DictReader(
            (self.dir / f"study/sub-{code}/ses-{s}/beh/sub-{code}_ses-{s}_task-two_beh.tsv").read_text().splitlines(), delimiter="\t")]
        self.assertEqual(sum(right), sum(p["right"] for p in told["two"]["dprime"]["participants"].values()))
        expected = 0.98 * share(2.5) + 0.02 / 3
        self.assertAlmostEqual(sum(right) / len(right), expected, delta=4 * (expected * (1 - expected) / len(right))**0.5)
        self.assertEqual({name: (list(run.get("methods", {})), list(run["sessions"])) for name, run in told.items() if name != "same"},
                         {"two": ([], ["dprime", "correct"]), "far": (["dprime", "correct"],) * 2})
        of = [[sum(r["positive"] == "1" for r in rows if (r["run"], r["participant"], r["method"]) == ("far", c, m)) for c in "1234"] for m in ("park", "soft")]
        pair, = told["far"]["methods"]["dprime"]["pairs"]
        self.assertAlmostEqual(pair["difference"], statistics.mean(dprime(a, 36 * 2) - dprime(b, 36 * 2) for a, b in zip(*of)), places=6)
        tsv = self.ok("analyze", "study", "--format", "tsv").stdout
        for line in ('glmer(positive ~ factor(session) + (1 + factor(session) | participant), family = sensR::triangle(), data = subset(d, run == "two"))',
                     "glmer(positive ~ abs(value - 4) * method * factor(session) + (1 + abs(value - 4) + method + factor(session) | participant), family = sensR::triangle(), "):
            self.assertIn(line, tsv)
        report = self.ok("report", "study").stdout
        for text in ("(Ennis 1993)", "- Ennis, D. M. (1993)", "| participant | right | trials | d' |", "Three stimuli, one after the other"):
            self.assertIn(text, report)
        # A session that was killed goes on with the same trials; another third stimulus is refused.
        table = beh / "sub-1_ses-1_task-far_beh.tsv"
        whole = table.read_bytes()
        order = json.loads((self.dir / "study/sourcedata/sub-1/ses-1/session.json").read_text())["order"]
        for later in order[order.index("far") + 1:]:
            (beh / f"sub-1_ses-1_task-{later}_beh.tsv").unlink()
        lines = whole.splitlines(keepends=True)
        again = ("experiment", "t.toml", "--participant", "1", "--session", "1", "-o", "study", "--simulate", "seed=1,dprime=2.5,lapse=0.02", "--resume")
        plans = [r["plan_3"] for r in tables["far"]]
        other = next(p for p in plans if p != plans[0])
        table.write_bytes(lines[0] + lines[1].replace(plans[0].encode() + b"\n", other.encode() + b"\n"))
        self.refused(2, *again, says=("is out of order",))
        table.write_bytes(b"".join(lines[:20]) + lines[20][:-9])
        self.ok(*again)
        self.assertEqual(table.read_bytes(), whole)

    def test_oddity_refuses_what_no_trial_can_have(self):
        self.write("desk.toml", DESK)
        run = dict(task="oddity", trials=12)
        far = dict(run, vary="length_mm", values=[8, 12], standard=4)
        for keys, says in ((dict(run, methods=["park"]), 'run "only" needs two methods, but has 1 method (name two under methods, or add the keys vary'),
                           (dict(run, values=[1, 2]), "vary, values and standard need one another"),
                           ({k: v for k, v in far.items() if k != "standard"}, "vary, values and standard need one another"),
                           (dict(far, standard=8), "the standard is one of the values, so no stimulus would differ"),
                           (dict(run, blocks="methods"), "has two methods in each trial")):
            self.write("t.toml", measures("desk.toml", toml("run", "only", **keys)))
            self.refused(2, "experiment", "t.toml", "--dry-run", says=(says,))
        self.write("t.toml", measures("desk.toml", toml("run", "two", **run), toml("run", "far", **far), keys="gap_s = 0.1\n"))
        self.simulate("1", definition="t.toml", spec="seed=1")
        for name, changes in (("two", ({"response": "4"}, {"response": "0"}, {"method_3": "standard"}, {"method_1": "park", "method_2": "park", "method_3": "park"})),
                              ("far", ({"method_1": "park", "method_2": "park", "method_3": "park"}, {"method_1": "park", "method_2": "soft", "method_3": "soft"},
                                       {"method_1": "park", "method_2": "soft", "method_3": "standard"}, {"value": "9"}, {"method_3": "n/a"}))):
            table = self.dir / f"study/sub-1/beh/sub-1_task-{name}_beh.tsv"
            text = table.read_text()
            head, first, rest = text.split("\n", 2)
            for change in changes:
                with self.subTest(run=name, **change):
                    cells = dict(zip(head.split("\t"), first.split("\t"))) | change
                    table.write_text("\n".join([head, "\t".join(cells.values()), rest]))
                    self.refused(2, "analyze", "study", says=(f"{table.relative_to(self.dir)}:2: ",))
            table.write_text(text)


if __name__ == "__main__":
    main()
