# SPDX-License-Identifier: MIT
"""tactor experiment: tasks that measure. Trials, resumed sessions, results and refusals."""
import csv
import io
import json
import math
import random
import re
import statistics

from experiments import DESK, ExperimentTest, contents  # before error_rates, whose folder it adds to the path
import error_rates
from harness import ROOT, main
from pictures import Svg
from studies import measures, toml

RUNS = {name: toml("run", name, **keys) for name, keys in {
    "values": dict(task="constant", question="Which was stronger?", methods=["park"], vary="level_dbfs", values=[-36, -32, -28, -24, -20, -16, -12],
                   standard=-24, trials_per_value=20),
    "words": dict(task="constant", question="One or two?", choices=["one", "two"], methods=["park"], vary="length_mm", values=[4, 8, 12, 16, 20], trials=40),
    "bayes": dict(task="adaptive", question="Which was stronger?", methods=["park"], vary="level_dbfs", procedure="quest", range=[-40, -8], standard=-24,
                  trials=40),
    "stairs": dict(task="adaptive", question="Which was faster?", vary="speed_mm_s", procedure="1up2down", range=[40, 200], steps=[40, 20], standard=100,
                   trials=24, tracks=2, practice=2),
    "felt": dict(task="detect", methods=["park"], vary="level_dbfs", values=[-60, -50, -40, -30], catch=0.2, trials=50),
    "there": dict(task="detect", methods=["park"], catch=0.5, trials=40),
    "same": dict(task="same-different", trials=40),
    "level": dict(task="adjust", vary="level_dbfs", range=[-40, -8], steps=[1, 4], standard=-24, trials=24, practice=1),
    "size": dict(task="estimate", question="How strong was it?", methods=["park"], vary="level_dbfs", values=[-40, -30, -20, -10], standard=-20, trials=12),
}.items()}
SIMULATE = "seed={},jnd=4,sigma=0.2,exponent=0.6,dprime=2"


def tasks(*names):
    """Returns the definition with the runs of these names."""
    return measures("desk.toml", *(RUNS[name] for name in names), keys="gap_s = 0.1\n")


TASKS = tasks(*RUNS)


class Tasks(ExperimentTest):
    def setUp(self):
        super().setUp()
        self.write("desk.toml", DESK)

    def hold(self, text, code="01", folder="study", spec=None):
        self.write("tasks.toml", text)
        return self.ok("experiment", "tasks.toml", "--participant", code, "-o", folder, "--simulate", spec or SIMULATE.format(1))

    def rows(self, run, code="01"):
        return super().rows(code, run)

    def test_each_task_draws_its_trials(self):
        self.hold(TASKS)
        values = self.rows("values")
        self.assertEqual(len(values), 140)
        for v in range(-36, -8, 4):
            own = [r for r in values if float(r["value"]) == v]
            self.assertEqual([sum(r["method_1"] == "standard" for r in own), len(own)], [10, 20])
        self.assertTrue(all({r["method_1"], r["method_2"]} == {"park", "standard"} for r in values))
        self.assertTrue(all(r["method_2"] == "n/a" and r["response"] in "12" for r in self.rows("words")))
        felt = self.rows("felt")
        self.assertEqual([(r["method_1"], r["value"]) for r in felt].count(("none", "n/a")), 10)
        same = [(r["method_1"], r["method_2"]) for r in self.rows("same")]
        self.assertEqual({p: same.count(p) for p in set(same)}, {(a, b): 10 for a in ("park", "soft") for b in ("park", "soft")})
        self.assertTrue(all(r["method_1"] == "standard" and r["intensity_estimate"] == r["response"] for r in self.rows("size")))
        self.assertNotIn("value", self.rows("same")[0])
        self.assertNotIn("track", values[0])

    def test_a_trial_without_a_stimulus_is_silent_and_as_long(self):
        self.write("tasks.toml", tasks("there"))
        stimuli = json.loads(self.ok("experiment", "tasks.toml", "--dry-run", "--format", "json").stdout)["stimuli"]
        self.hold(tasks("there"))
        plans = {s["method"]: json.loads((self.dir / f"study/sourcedata/sub-01/plans/{s['sha256']}.json").read_text()) for s in stimuli}
        drives = {m: [d["amplitude"] for b in p["bursts"] for d in b["drives"]] for m, p in plans.items()}
        self.assertFalse(any(drives["none"]))
        self.assertGreater(max(drives["park"]), 0)
        self.assertEqual(plans["none"]["total_s"], plans["park"]["total_s"])

    def test_a_staircase_follows_the_answers_of_its_track(self):
        self.hold(tasks("stairs"))
        tracks = {}
        for r in self.rows("stairs"):
            more = (r["response"] == "2") == (r["method_1"] == "standard")
            tracks.setdefault(r["track"], []).append((float(r["value"]), more))
        self.assertEqual([tracks[t][0][0] for t in "1234"], [200, 40, 200, 40])
        for track, trials in tracks.items():
            value, in_row, up, reversals = trials[0][0], 0, None, 0
            for shown, more in trials:
                self.assertEqual(shown, value)
                counts = more == (track in "13")  # every second track is mirrored
                in_row = in_row + 1 if counts else 0
                if counts and in_row < 2:
                    continue
                in_row, reversals, up = 0, reversals + (up is not None and up != (not more)), not more
                value = min(200, max(40, value + (40, 20)[min(1, reversals // 2)] * (1 if up else -1)))

    def test_adjustments_begin_on_both_sides_of_the_standard_and_arrive_by_steps(self):
        self.hold(tasks("level"), spec=SIMULATE.format(1) + ",pse=-22,lapse=0.2")
        rows = self.rows("level")
        self.assertEqual(list(rows[0])[11:15], ["value", "start", "moves", "void"])
        cells = [(r["method_1"], r["method_2"], float(r["start"]) < -24) for r in rows]
        self.assertEqual({c: cells.count(c) for c in cells},
                         {(*order, below): 3 for m in ("park", "soft") for order in ((m, "standard"), ("standard", m)) for below in (True, False)})
        self.assertNotIn(-24, {float(r["start"]) for r in rows})
        self.assertGreater(len({r["start"] for r in rows}), 12)
        plans = {}
        for r in rows:
            value, apart = float(r["value"]), round(abs(float(r["value"]) - float(r["start"])))
            self.assertEqual((float(r["response"]), int(r["moves"])), (value, apart // 4 + apart % 4))
            moved = "1" if r["method_2"] == "standard" else "2"
            plan = json.loads((self.dir / f"study/sourcedata/sub-01/plans/{r['plan_' + moved]}.json").read_text())
            plans.setdefault((r["method_" + moved], value), set()).add(plan["render"]["level_dbfs"])
        self.assertEqual(plans, {(m, v): {v} for m, v in plans})  # the plan is that of the accepted value
        self.assertTrue(any(r["moves"] == "0" for r in rows))  # who lapses accepts the start
        told = json.loads((self.dir / "study/task-level_beh.json").read_text())
        self.assertEqual([told[c]["Description"].split()[0] for c in ("value", "start", "moves")], ["Value", "Value", "Number"])
        given = tasks("level").replace("standard = -24", "standard = -24\nstart = [-40, -12.1]")
        self.hold(given, folder="given")
        self.assertEqual({r["start"] for r in super().rows("01", "level", "given")}, {"-40.000000", "-12.000000"})
        self.assertEqual(json.loads(self.ok("analyze", "given", "--format", "json").stdout)["runs"]["level"]["trials"], 24)

    def test_a_summary_has_units_and_the_values_of_its_tests(self):
        fast = toml("run", "fast", task="constant", question="?", methods=["park"], vary="speed_mm_s", values=[72, 76, 80, 84, 88], standard=80, trials=40)
        for code in ("01", "02", "03"):
            self.hold(tasks("values", "words", "felt", "same", "level", "size") + fast, code, spec=f"seed=2{code},jnd=4,sigma=0.2,exponent=0.6,dprime=2")
        lines = dict(line.split(": ", 1) for line in self.ok("analyze", "study").stdout.splitlines()[1:])
        number = r"-?[\d.]+"
        interval = rf"\({number} \.\.\. {number}\)"
        for name, line in {"values": rf"pse {number} dBFS {interval} against -24, p [=<] {number}", "words": rf"pse {number} mm {interval}",
                           "fast": rf"pse {number} mm/s {interval} against 80, p [=<] {number}", "felt": rf"threshold {number} dBFS {interval}",
                           "same": rf"d' {number} {interval} against 0, likelihood ratio {number}, p [=<] {number}",
                           "level": rf"constant_error {number} dB {interval} against 0, p [=<] {number}", "size": rf"exponent {number} {interval}.*"}.items():
            self.assertRegex(lines[name], rf"\A{line}\Z", name)
        for name, value in (("values", -24), ("fast", 80)):
            self.assertEqual(self.analysis()["runs"][name]["against"], value)
        drawn = "".join(toml("run", task, task=task, motions=["east"], methods=["park"], trials=3) for task in ("locate", "trace"))
        for code in ("01", "02"):
            self.hold(measures("desk.toml", drawn), code, folder="drawn")
        self.assertRegex(self.ok("analyze", "drawn").stdout, rf"\nlocate: error {number} mm {interval}\ntrace: distance {number} mm {interval}\n\Z")

    def test_adjustments_have_the_figures_of_their_values(self):
        for code in ("01", "02", "03", "04", "05"):
            self.hold(tasks("level"), code, spec=f"seed=1{code},void=0.1,jnd=2,pse=-22,pse_sd=1")
        told = self.analysis()["runs"]["level"]
        self.assertEqual((told["against"], told["trials"], list(told["methods"])), (-24, 120, ["constant_error", "sd"]))

        def values(code, method=None):
            return [float(r["value"]) for r in self.rows("level", code) if r["void"] == "false" and method in (None, r["method_1"], r["method_2"])]

        def check(found, method):
            codes = found["participants"]
            self.assertEqual(list(codes), ["01", "02", "03", "04", "05"])
            for code, one in codes.items():
                for key, expected in (("pse", statistics.mean(values(code, method))), ("constant_error", statistics.mean(values(code, method)) + 24),
                                      ("sd", statistics.stdev(values(code, method)))):
                    self.assertAlmostEqual(one[key], expected, places=9)
            errors = [statistics.mean(values(code, method)) + 24 for code in codes]
            mean, se, t = statistics.mean(errors), statistics.stdev(errors) / math.sqrt(5), found["constant_error"]
            for key, expected in (("mean", mean), ("se", se), ("t", mean / se), ("d", mean / se / math.sqrt(5))):
                self.assertAlmostEqual(t[key], expected, places=8)
            self.assertAlmostEqual(t["ci"][1] - mean, 2.7764451051977987 * se, places=8)  # t(4) at 97.5 %
            self.assertAlmostEqual(found["means"]["pse"]["mean"], mean - 24, places=9)
            self.assertAlmostEqual(found["means"]["sd"]["mean"], statistics.mean(statistics.stdev(values(c, method)) for c in codes), places=9)

        check(told["adjustment"], None)
        for method in ("park", "soft"):
            check(told["by"][f"{method}:east"]["adjustment"], method)
        differences = [statistics.stdev(values(c, "park")) - statistics.stdev(values(c, "soft")) for c in told["adjustment"]["participants"]]
        pair, = told["methods"]["sd"]["pairs"]
        self.assertAlmostEqual(pair["difference"], statistics.mean(differences), places=9)
        self.assertAlmostEqual(pair["t"], statistics.mean(differences) / (statistics.stdev(differences) / math.sqrt(5)), places=8)
        tsv = self.ok("analyze", "study", "--format", "tsv").stdout
        self.assertIn('lmer(I(value + 24) ~ method + (1 + method | participant), data = subset(d, run == "level"))', tsv)
        report = " ".join(self.ok("report", "study").stdout.split())
        for text in ("In the method of adjustment", "Procedure: small moves of 1 and large ones of 4; trials began at random values, below and above",
                     f"| constant error | {told['adjustment']['constant_error']['mean']:.4g} |"):
            self.assertIn(text, report)
        self.assertIn("constant error of level (dB)", (self.ok("analyze", "study", "-o", "a.svg"), (self.dir / "a.svg").read_text())[1])

    def test_adjustments_recover_other_observers_and_each_value_is_checked(self):
        """People by a formula of this test: they stop before the end, a fifth of the way, and press in steps of 1 dB."""
        true, noise = {"park": 1.5, "soft": -2.0}, {"park": 1.0, "soft": 2.0}
        for code in range(1, 9):
            draw = random.Random(code)
            self.hold(tasks("level").replace("trials = 24", "trials = 80"), f"{code:02}")
            table = self.dir / f"study/sub-{code:02}/beh/sub-{code:02}_task-level_beh.tsv"
            head, *lines = (line.split("\t") for line in table.read_text(encoding="utf-8").splitlines())
            at = {name: head.index(name) for name in ("method_1", "method_2", "start", "value", "response")}
            for cells in lines:
                method, = {cells[at["method_1"]], cells[at["method_2"]]} - {"standard"}
                end = -24 + true[method] + 0.2 * (float(cells[at["start"]]) + 24) + draw.gauss(0, noise[method])
                value = min(-8, max(-40, round(end)))
                cells[at["value"]], cells[at["response"]] = f"{value:.6f}", f"{value:g}"
            table.write_text("".join("\t".join(cells) + "\n" for cells in (head, *lines)), encoding="utf-8")
        told = self.analysis()["runs"]["level"]
        # Random starts on a side are uniform over 16 dB, and both sides together over 32.
        sd = {m: math.sqrt(noise[m] ** 2 + 0.2 ** 2 * 32 ** 2 / 12 + 1 / 12) for m in true}
        for method in true:
            found = told["by"][f"{method}:east"]["adjustment"]
            self.assertAlmostEqual(found["constant_error"]["mean"], true[method], delta=4 * sd[method] / math.sqrt(8 * 40))
            self.assertAlmostEqual(found["means"]["sd"]["mean"], sd[method], delta=4 * sd[method] / math.sqrt(2 * 8 * 40))
        for figure in ("constant_error", "sd"):
            self.assertLess(told["methods"][figure]["pairs"][0]["p"], 0.001)
        # The observer of the tool, who settles at the pse with the jnd's noise.
        for code in "12":
            self.hold(tasks("level").replace("trials = 24", "trials = 200"), code, "own", spec=f"seed={code},pse=-27,jnd=1")
        own = json.loads(self.ok("analyze", "own", "--format", "json").stdout)["runs"]["level"]["adjustment"]
        self.assertAlmostEqual(own["constant_error"]["mean"], -3, delta=4 * 1.5 / 20)
        self.assertAlmostEqual(own["means"]["sd"]["mean"], math.sqrt(0.6745 ** -2 + 1 / 12), delta=4 * 1.5 / math.sqrt(800))
        # Trials begin at -40, but a participant may move to -8.
        self.write("desk.toml", DESK + "[limits]\npower_dbfs = -20\n")
        self.write("tasks.toml", tasks("level").replace("standard = -24", "standard = -24\nstart = [-40]"))
        self.refused(2, "experiment", "tasks.toml", "--dry-run", says=['with method "', "power_dbfs in [limits]"])

    def test_a_session_that_was_killed_goes_on_as_if_it_had_not_been(self):
        self.hold(re.sub("practice = .\n", "", TASKS))
        whole = contents(self.dir / "study")
        for run, keep in (("stairs", 7), ("bayes", 20), ("felt", 1), ("level", 9), ("size", 11)):
            table = self.dir / f"study/sub-01/beh/sub-01_task-{run}_beh.tsv"
            lines = table.read_text(encoding="utf-8").splitlines(True)
            order = json.loads((self.dir / "study/sourcedata/sub-01/session.json").read_text())["order"]
            for later in order[order.index(run) + 1:]:
                (self.dir / f"study/sub-01/beh/sub-01_task-{later}_beh.tsv").unlink(missing_ok=True)
            table.write_text("".join(lines[:1 + keep]), encoding="utf-8")
            self.ok("experiment", "tasks.toml", "--participant", "01", "-o", "study", "--simulate", SIMULATE.format(1), "--resume")
            now = contents(self.dir / "study")
            self.assertEqual({k: v for k, v in now.items() if k.endswith("_beh.tsv")}, {k: v for k, v in whole.items() if k.endswith("_beh.tsv")})

    def test_values_of_more_digits_than_a_table_are_read_again(self):
        """The tables have six decimals, and the grids of these runs nine or more."""
        grids = {"move": dict(task="adjust", range=[0.05, 0.0677]), "climb": dict(task="adaptive", procedure="1up2down", range=[0.05, 0.0677], steps=[0.0004425]),
                 "some": dict(task="constant", values=[0.0512345678, 0.0523456789, 0.06])}
        self.hold(measures("desk.toml", *(toml("run", name, question="?", methods=["park"], vary="soa_s", standard=0.06, trials=12, **keys) for name, keys in grids.items())),
                  folder="fine", spec="seed=1,pse=0.058,jnd=0.002")
        told = json.loads(self.ok("analyze", "fine", "--format", "json").stdout)["runs"]
        self.assertEqual({name: run["trials"] for name, run in told.items()}, dict.fromkeys(grids, 12))
        self.ok("report", "fine")

    def test_values_and_answers_that_no_trial_can_have_are_refused(self):
        self.hold(TASKS)
        for run, changes in {"values": ({"value": "-30"}, {"value": "n/a"}, {"response": "3"}, {"trial": "141"}, {"response_time": "-0.1"}),
                             "bayes": ({"value": "-8.5"}, {"response": "5000"}), "words": ({"value": "5"},), "same": ({"response": "0"},),
                             "felt": ({"value": "-45"}, {"value": "n/a"}), "size": (*({c: n} for c in ("response", "intensity_estimate") for n in ("5000", "0", "12,5")),
                                      *({"response": n, "intensity_estimate": n} for n in ("-1", "nan", "1e400", "1" * 40)), {"value": "-25"}),
                             "level": ({"value": "-23.25"}, {"response": "-7"}, {"response": "n/a"}, {"response": lambda value: f"{float(value) + 0.3:.1f}"}),
                             "there": ({"response": "yes"},)}.items():
            table = self.dir / f"study/sub-01/beh/sub-01_task-{run}_beh.tsv"
            text = table.read_text(encoding="utf-8")
            lines = text.splitlines()
            columns = lines[0].split("\t")
            line = next(i for i, told in enumerate(lines) if i > 2 and told.split("\t")[columns.index("method_1")] != "none")
            for change in changes:
                with self.subTest(run=run, **change):
                    cells = lines[line].split("\t")
                    for column, cell in change.items():
                        cell = cell(cells[columns.index("value")]) if callable(cell) else cell
                        self.assertNotEqual(cells[columns.index(column)], cell)
                        cells[columns.index(column)] = cell
                    table.write_text("\n".join([*lines[:line], "\t".join(cells), *lines[line + 1:]]) + "\n", encoding="utf-8")
                    for command in ("analyze", "report"):
                        self.refused(2, command, "study", says=(f"{table.relative_to(self.dir)}:{line + 1}: ",))
            table.write_text(text, encoding="utf-8")
        # R writes 100000 so.
        table = self.dir / "study/sub-01/beh/sub-01_task-size_beh.tsv"
        text = table.read_text(encoding="utf-8")
        number = self.rows("size")[0]["response"]
        for other in ("1e+05", "0.5", "1234.5"):
            table.write_text(text.replace(f"\t{number}\t", f"\t{other}\t"), encoding="utf-8")
            self.assertEqual(self.rows("size")[0]["intensity_estimate"], other)
            self.ok("analyze", "study")
        table.write_text(text, encoding="utf-8")
        # A trial without a stimulus has no value; other programs round.
        table = self.dir / "study/sub-01/beh/sub-01_task-felt_beh.tsv"
        text = table.read_text(encoding="utf-8")
        table.write_text(re.sub(r"(?m)^(.*\tnone\t.*\t)n/a(\tfalse)", r"\1-40\2", text, count=1), encoding="utf-8")
        self.refused(2, "analyze", "study", says=("the trial has a value but no stimulus",))
        table.write_text(text.replace("\t-40.000000\t", "\t-39.99999999999999\t"), encoding="utf-8")
        self.assertNotEqual(table.read_text(encoding="utf-8"), text)
        self.ok("analyze", "study")

    def test_results_recover_what_was_simulated(self):
        for i in range(1, 7):
            self.hold(TASKS, f"{i:02}", spec=SIMULATE.format(i))
        runs = self.analysis()["runs"]
        for run, near in (("values", 1.5), ("bayes", 3)):
            p = runs[run]["psychometric"]
            self.assertEqual([p["axis"], sorted(p["participants"])], ["dB", [f"{i:02}" for i in range(1, 7)]])
            self.assertAlmostEqual(p["mean"]["pse"], -24, delta=near)
            self.assertAlmostEqual(p["mean"]["jnd"], 4, delta=1.5)
            for one in p["participants"].values():
                self.assertLess(one["ci"]["pse"][0], one["pse"])
                self.assertGreater(one["ci"]["pse"][1], one["pse"])
        self.assertAlmostEqual(runs["there"]["dprime"]["mean"], 2, delta=0.8)
        self.assertAlmostEqual(runs["same"]["dprime"]["mean"], 2, delta=1)
        same = runs["same"]["dprime"]
        self.assertEqual([same[k] for k in ("t", "p", "p_signflip", "d", "d_ci")], [None] * 5)
        self.assertEqual((same["likelihood_ratio"]["p"], same["likelihood_ratio"]["studies"]), (1 / 2001, 2000))
        self.assertIsNone(runs["there"]["dprime"]["likelihood_ratio"])
        self.check_likelihood_ratio(same)
        self.assertAlmostEqual(runs["size"]["exponent"]["mean"], 0.6, delta=0.1)
        self.assertEqual(set(runs["stairs"]["by"]), {"park:east", "soft:east"})
        wide = list(csv.DictReader(io.StringIO(self.ok("analyze", "study", "--format", "wide").stdout)))
        self.assertAlmostEqual(float(wide[0]["values.pse"]), runs["values"]["psychometric"]["participants"]["01"]["pse"])
        tsv = self.ok("analyze", "study", "--format", "tsv").stdout
        for line in ('positive ~ I(value + 24) + (1 + I(value + 24) | participant), family = binomial("probit"), data = subset(d, run == "values"))',
                     "positive ~ I(value - 12) + (1 + I(value - 12) | participant), ",  # words: the middle
                     "positive ~ I(value - 100) * method + (1 + I(value - 100) + method | participant), ",
                     "positive ~ signal + (1 + signal | participant), ",
                     "log(estimate) ~ I(value + 20) + (1 + I(value + 20) | participant), "):
            self.assertIn(line, tsv)
        told = self.ok("analyze", "study", "--format", "tables", "-o", "a.svg")
        self.assertIn("pse against -24", told.stdout)
        steps = [c for c, p in runs["words"]["psychometric"]["participants"].items() if p["jnd"] is None]
        self.assertNotEqual(steps, [])
        self.assertIn("words: jnd: the answers do not determine it: " + ", ".join(f"sub-{c}" for c in steps), told.stderr)
        self.check_picture(runs)
        self.check_report(runs)

    def check_likelihood_ratio(self, same):
        """The ratio is G of each participant's table, from the rates that are printed: 20 different and 20 equal pairs."""
        g = 0
        for p in same["participants"].values():
            hits, alarms = (round(p[k] * 21 - 0.5) for k in ("hits", "false_alarms"))
            part = lambda k, of: k * math.log(k / of) if k else 0
            one = sum(part(k, 20) for k in (hits, 20 - hits, alarms, 20 - alarms)) - sum(part(k, 40) for k in (hits + alarms, 40 - hits - alarms))
            g += 2 * one if hits > alarms else 0
        self.assertAlmostEqual(same["likelihood_ratio"]["value"], g, delta=1e-9)
        for form in ("text", "tables"):
            self.assertIn(f", likelihood ratio {g:.2f}, p < 0.001", self.ok("analyze", "study", "--format", form).stdout)
        self.assertIn(f"Likelihood ratio of d' against 0: 2 ln = {g:.4g}, p = ", self.ok("report", "study").stdout)

    def test_simulated_observers_lapse_to_either_key(self):
        rates = {}
        for code in ("01", "02", "03", "04"):
            self.hold(tasks("values", "felt", "there", "same"), code, spec="seed=1,jnd=0.1,dprime=10,lapse=0.4")
            for r in self.rows("values", code):
                more = (r["response"] == "2") == (r["method_1"] == "standard")
                if float(r["value"]) != -24:
                    rates.setdefault(("values", float(r["value"]) > -24), []).append(more)
            for run in ("felt", "there"):
                for r in self.rows(run, code):
                    if r["method_1"] == "none" or r.get("value", "n/a") == "n/a" or float(r["value"]) == -30:
                        rates.setdefault((run, r["method_1"] != "none"), []).append(r["response"] == "1")
            for r in self.rows("same", code):
                if r["method_1"] != r["method_2"]:
                    rates.setdefault(("same", True), []).append(r["response"] == "2")
        self.assertEqual(len(rates), 7)
        for (run, more), answers in rates.items():  # either key, in 40 % of the trials
            expected = 0.8 if more else 0.2
            self.assertAlmostEqual(sum(answers) / len(answers), expected, delta=4 * (0.16 / len(answers)) ** 0.5, msg=run)

    def check_picture(self, runs):
        """Each participant's answers are points of their size; d' and a constant error are bars."""
        panels = {p.get("data-title"): p for p in Svg(self.dir / "a.svg").all("curves")}
        place = lambda panel, e: tuple((float(e.get(c)) - float(panel.get(f"data-{axis}0"))) / float(panel.get(f"data-{axis}-scale"))
                                       for c, axis in (("cx", "x"), ("cy", "y")))
        self.assertEqual(list(panels), ["values (n = 6)", "words (n = 6)", "bayes (n = 6)", "park:east (stairs, n = 6)",
                                        "soft:east (stairs, n = 6)", "felt (n = 6)", panels_end := list(panels)[-1]])
        self.assertRegex(panels_end, r"size \(n = 6, exponent 0\.\d\d\)")
        for title, name in (("values (n = 6)", "values"), ("bayes (n = 6)", "bayes"), ("felt (n = 6)", "felt")):
            panel = panels[title]
            dots = [e for e in panel.iter() if e.get("class") == "dot"]
            answers = [a for p in runs[name]["psychometric"]["participants"].values() for a in p["answers"]]
            self.assertEqual(len(dots), len(answers))
            most = max(a["n"] for a in answers)
            radius = max(float(e.get("r")) for e in dots)
            for dot, a in zip(dots, answers):
                x, y = place(panel, dot)
                self.assertAlmostEqual(x, a["value"], delta=0.05)
                self.assertAlmostEqual(y, 100 * a["positive"] / a["n"], delta=0.05)
                self.assertEqual(float(dot.get("data-weight")), a["n"])
                self.assertAlmostEqual(float(dot.get("r")), max(0.5, radius * (a["n"] / most) ** 0.5), delta=0.02)
            fitted = sum(p["alpha"] is not None for p in runs[name]["psychometric"]["participants"].values())
            self.assertEqual([sum(e.get("class") == kind for e in panel.iter()) for kind in ("curve", "mean-curve")], [fitted, 1])
        words = "".join(panels["words (n = 6)"].itertext())
        self.assertIn('answered "two" (%)', words)
        self.assertIn("length (mm)", words)
        bars = {p.get("data-title").replace(" (n = 6)", ""): p for p in Svg(self.dir / "a.svg").all("bars")}
        texts = lambda panel, kind: [e.text for e in panel.iter() if e.get("class") == kind]
        self.assertEqual({title: texts(p, "axis-title") for title, p in bars.items()},
                         {"stairs: pse by method": ["pse (mm/s)"], "there": ["d'"], "same": ["d'"], "level": [error := "constant error of level (dB)"],
                          "level: constant error of level by method": [error], "level: sd by method": ["sd (dB)"]})
        for title in ("level", "level: constant error of level by method"):  # differences of levels begin at 0 dB
            self.assertIn(0, [float(t) for t in texts(bars[title], "tick-label")])

    def check_report(self, runs):
        report = self.ok("report", "study").stdout
        for text in ("chosen by the answers from -40 to -8; standard -24", "Trials without a stimulus, called none, with silence that is as long: 20 %",
                     "slopes (standard deviations of the normal) of 0.8, 1.692, 3.578, 7.566, 16 and lapses of 0, 0.02, 0.04",
                     "staircases (Levitt 1971) from 200, 40: a step down after 2 positive answers in a row",
                     "every second track mirrored, up after 2 negative answers in a row, which leads to 29.3 %", "step sizes of 40, 20, the next one",
                     "| east | park | level\\_dbfs -60 to -8 (35 values) |", "| 35 plans | all |", "| east | park | length\\_mm 20, speed\\_mm\\_s 100 |",
                     "Stimulus called standard: by the same method, with level\\_dbfs of -24", "- Watson, A. B.", "- Levitt, H.", "- Stevens, S. S."):
            self.assertIn(text, report)
        self.assertEqual({line.split(" | ")[-1] for line in report.splitlines() if line.startswith("| east | park |")}, {"all |"})
        for text in ("**standard.**", "**none.**", "sub-01, sub-01", "- Holm, S.", "Attribute: not recorded", "Codes of stimuli"):
            self.assertNotIn(text, report)
        one = runs["values"]["psychometric"]["participants"]["01"]
        self.assertIn(f"| sub-01 | {one['pse']:.4g} | {one['ci']['pse'][0]:.4g} to {one['ci']['pse'][1]:.4g} | {one['jnd']:.4g} |", report)
        there = runs["there"]["dprime"]
        self.assertIn(f"| d' | {there['mean']:.4g} | {there['se']:.4g} |", report)
        self.assertIn(f"| sub-02 | {runs['size']['exponent']['participants']['02']:.4g} |", report)
        self.assertIn("over speed\\_mm\\_s, soft:east:", report)

    def test_groups_are_compared_by_the_main_figure(self):
        grouped = tasks("values", "size") + '[[group]]\nname = "a"\n[[group]]\nname = "b"\n'
        self.write("tasks.toml", grouped)
        for code, group in (("01", "a"), ("02", "b"), ("03", "a"), ("04", "b"), ("05", "b")):
            self.ok("experiment", "tasks.toml", "--participant", code, "--group", group, "-o", "study", "--simulate", SIMULATE.format(1))
        runs = self.analysis()["runs"]
        for run, figures in (("values", {c: p["pse"] for c, p in runs["values"]["psychometric"]["participants"].items()}),
                             ("size", runs["size"]["exponent"]["participants"])):
            one, other = [figures[c] for c in ("01", "03")], [figures[c] for c in ("02", "04", "05")]
            error = statistics.variance(one) + 2 * statistics.variance(other)
            expected = (statistics.mean(one) - statistics.mean(other)) ** 2 / (error / 3 * (1 / 2 + 1 / 3))
            told = runs[run]["group_anova"]
            self.assertEqual((list(told), told["group"]["df1"], told["group"]["df2"]), (["group"], 1, 3))
            self.assertAlmostEqual(told["group"]["F"] / expected, 1, delta=1e-9)
        self.assertIn("the group as a factor between participants:\n    group: F(1, 3)", self.ok("analyze", "study", "--format", "tables").stdout)
        self.assertIn("Analysis of variance with the group as a factor", self.ok("report", "study").stdout)

    def answer(self, run, code, shares):
        """Rewrites a table: of each cell (method_1, method_2, value) as many trials in ten as shares(cell) are positive."""
        file = self.dir / f"study/sub-{code}/beh/sub-{code}_task-{run}_beh.tsv"
        rows, seen = list(csv.DictReader(file.read_text().splitlines(), delimiter="\t")), {}
        for r in rows:
            cell = (r["method_1"], r["method_2"], r["value"] if r["value"] == "n/a" else float(r["value"]))
            n = seen[cell] = seen.get(cell, 0) + 1
            positive = (7 * n) % 10 < shares(cell)
            second = positive == (r["method_1"] in ("standard", "none")) if r["method_2"] != "n/a" else positive
            r["response"] = "2" if second else "1"
        file.write_text("\n".join("\t".join(line) for line in [list(rows[0]), *([*r.values()] for r in rows)]) + "\n")

    def test_the_time_order_error_is_the_difference_between_the_orders(self):
        run = toml("run", "two", task="interval", methods=["park"], vary="level_dbfs", values=[-40, -30, -20], trials=60)
        text = measures("desk.toml", RUNS["values"], run, keys="gap_s = 0.1\n")
        steps = [0, 1, 3, 7, 9, 10]  # of ten; about the place between the third value and the fourth
        shown = lambda value, place: ([0] * 9 + steps + [10] * 9)[9 + round((value - place) / 4 + 2.5)]
        for code, off in (("01", 2), ("02", -2), ("03", 6), ("04", 2)):
            self.hold(text, code)
            self.answer("values", code, lambda cell, off=off: shown(cell[2], -24 + (off if cell[1] == "standard" else -off)))
        told = self.analysis()["runs"]
        people = told["values"]["time_order"]["participants"]
        for code, off in (("01", 2), ("02", -2), ("03", 6), ("04", 2)):
            self.assertLess(abs(people[code]["first"] - (-24 - off)), 0.5, code)
            self.assertAlmostEqual(people[code]["first"] + people[code]["second"], -48, 4)  # one is the other in reverse
            self.assertAlmostEqual(people[code]["difference"], people[code]["second"] - people[code]["first"], 9)
        found = [p["difference"] for p in people.values()]
        test = told["values"]["time_order"]["difference"]
        t = statistics.mean(found) / (statistics.stdev(found) / 2)
        self.assertAlmostEqual(test["t"], t, 9)
        self.assertEqual((told["values"]["time_order"]["figure"], test["df"], list(told["values"]["time_order"]["means"])), ("pse", 3, ["first", "second"]))
        for code, own in told["two"]["time_order"]["participants"].items():
            right = {first: [(r["response"] == "1") == first for r in self.rows("two", code) if (r["method_1"] == "park") == first] for first in (True, False)}
            shares = {first: 100 * sum(all_) / len(all_) for first, all_ in right.items()}
            self.assertEqual((own["first"], own["second"], own["difference"]), (shares[True], shares[False], shares[False] - shares[True]))
        text = self.ok("analyze", "study", "--format", "tables").stdout
        self.assertRegex(text, rf"Time-order error: pse by the interval that held the standard, second minus\n +first:\n    difference against 0 +{test['mean']:.2f} \(se [^\n]*t\(3\) = {t:.2f}, ")
        self.assertIn(f"    sub-03     difference {people['03']['difference']:.2f}  first {people['03']['first']:.2f}", text)
        self.assertIn(f"| difference | {test['mean']:.4g} | ", self.ok("report", "study").stdout)
        wide = {r["participant_id"]: r for r in csv.DictReader(io.StringIO(self.ok("analyze", "study", "--format", "wide").stdout))}
        self.assertEqual([float(wide[f"sub-{c}"]["values.time_order"]) for c in people], found)
        # Answers to words have no standard, and those of one order no difference.
        self.hold(tasks("words"), folder="words")
        self.assertNotIn("time_order", json.loads(self.ok("analyze", "words", "--format", "json").stdout)["runs"]["words"])
        self.answer("values", "01", lambda cell: 5 if cell[1] == "standard" else shown(cell[2], -24))
        told = self.analysis()
        self.assertIsNone(told["runs"]["values"]["time_order"]["participants"]["01"]["difference"])
        self.assertIn("values: time order: the answers of one order do not determine it: sub-01", told["warnings"])

    def test_fits_at_their_limits_and_large_jnds_are_doubted(self):
        text = tasks("values", "felt")
        for code in ("01", "02", "03"):
            self.hold(text, code)
        self.answer("values", "01", lambda cell: 2 if cell[2] < -24 else 8 if cell[2] > -24 else 5)
        self.answer("values", "02", lambda cell: 4 if cell[2] < -30 else 6 if cell[2] > -18 else 5)
        self.answer("values", "03", lambda cell: 0 if cell[2] < -24 else 10 if cell[2] > -24 else 5)
        self.answer("felt", "02", lambda cell: 0)  # 1 is yes
        said = [line.removeprefix("tactor: warning: ") for line in self.ok("analyze", "study").stderr.splitlines()]
        expected = ["values: lapse: it is at its limit of 0.12, so the slope may be wrong: sub-01 (see whether they mixed up the keys; add practice, or easier values)",
                    "values: jnd: it is larger than the range of the values: sub-02 (test values that are farther apart)",
                    "felt: guess: it is at its limit of 0.9: they felt something in most trials without a stimulus: sub-02 (see whether they mixed up the keys; add training)"]
        self.assertEqual([w for w in said if "(see " in w or "(test " in w], expected)
        self.assertEqual([w for w in self.analysis()["warnings"] if "(see " in w or "(test " in w], expected)
        self.assertIn("- Warning: " + expected[1].replace("_", "\\_"), self.ok("report", "study").stdout)

    def test_the_report_joins_notes_that_differ_in_numbers(self):
        self.hold(measures("desk.toml", toml("run", "soa", task="constant", question="?", methods=["soft"], vary="soa_s", values=[0.06, 0.062, 0.064], standard=0.063,
                                             trials=12), keys="gap_s = 0.1\n"))
        notes = [line for line in self.ok("report", "study").stdout.splitlines() if "break the timing law" in line]
        self.assertEqual([line.partition(":")[0] for line in notes], ["- east with soft", "- east with standard"])
        self.assertTrue(notes[0].endswith("; and 2 more like it"), notes)

    def test_a_wide_table_has_the_figures_of_each_method(self):
        for code in ("01", "02"):
            self.hold(tasks("stairs", "there"), code)
        wide = list(csv.DictReader(io.StringIO(self.ok("analyze", "study", "--format", "wide").stdout)))
        told = self.analysis()["runs"]
        self.assertEqual([c for c in wide[0] if c.startswith("stairs")], ["stairs.pse", "stairs.jnd", "stairs.time_order", *(
            f"stairs.{m}.{f}" for m in ("park", "soft") for f in ("pse", "jnd"))])
        self.assertEqual([c for c in wide[0] if c.startswith("there")], ["there.dprime", "there.c"])  # one method
        for row in wide:
            for m in ("park", "soft"):
                own = told["stairs"]["by"][f"{m}:east"]["psychometric"]["participants"][row["participant_id"].removeprefix("sub-")]
                self.assertEqual(float(row[f"stairs.{m}.pse"]), own["pse"])

    def test_power_between_groups_is_that_of_the_noncentral_t_distribution(self):
        text = tasks("level", "there") + toml("group", "a") + toml("group", "b")
        self.write("tasks.toml", text)

        def power(spec, group="a"):
            told = self.ok("experiment", "tasks.toml", "--power", "8,12", "--studies", "300", "--format", "json", "--group", group, "--simulate", spec)
            return {r["name"]: {(c["factor"], c["figure"]): c for c in r["comparisons"]} for r in json.loads(told.stdout)["runs"]}
        found = power("seed=1,jnd=0.001,pse_sd=6,group_d=1,dprime=1")
        self.assertEqual(list(found["level"]), [(factor, figure) for factor in ("method", "group", "group:method") for figure in ("constant_error", "sd")])
        self.assertEqual(list(found["there"]), [("group", "dprime"), ("group", "c")])
        self.assertEqual(found["level"]["group", "constant_error"]["comparison"], "constant_error by group (a, b), participants in each, analysis of variance")
        for at in found["level"]["group", "constant_error"]["power"]:
            # Values are 1 apart, which adds the variance 1/12 to that of people.
            expected = error_rates.find_power(6 / math.hypot(6, math.sqrt(1 / 12)), at["participants"])
            self.assertLess(abs(at["power"] - expected), 3.3 * math.sqrt(expected * (1 - expected) / 300))
            self.assertEqual(at["for_last"], at["significant"])
        at = power("seed=1,jnd=0.001,pse_sd=6,group_d=1,dprime=1", "b")["level"]["group", "constant_error"]["power"][1]
        self.assertEqual(at["for_last"], at["significant"])
        none = power("seed=1,jnd=2,pse_sd=6,jnd_sd=1,correlation=0.5,dprime=1,dprime_sd=0.5")
        for run, tests in none.items():
            for (factor, figure), c in tests.items():
                if factor.startswith("group"):
                    for at in c["power"]:
                        self.assertLess(at["power"], 0.1, (run, factor, figure))  # 5 % and four standard errors

    def test_a_catch_trial_is_of_no_method(self):
        self.hold(tasks("there").replace('methods = ["park"]', 'methods = ["park", "soft"]'))
        notes, rows = self.trials()
        self.assertEqual({(r["method"], r["signal"]) for r in rows}, {("park", "1"), ("soft", "1"), ("none", "0")})
        self.assertIn('# glmer(positive ~ signal + signal:method + (1 + signal + signal:method | participant), family = binomial("probit"), '
                      'data = transform(subset(d, run == "there"), method = replace(method, signal == 0, "park")))', notes)

    def test_power_is_that_of_the_main_figure(self):
        self.write("tasks.toml", tasks("values", "words", "same"))
        power = lambda spec: json.loads(self.ok("experiment", "tasks.toml", "--power", "6", "--studies", "20", "--format", "json",
                                                "--simulate", spec).stdout)["runs"]
        there = {r["name"]: r for r in power("seed=1,pse=-20,jnd=4,dprime=3")}
        self.assertEqual([there["values"]["power"][0]["power"], there["same"]["power"][0]["power"], there["words"]["power"]], [1, 1, []])
        none = {r["name"]: r for r in power("seed=1,pse=-24,jnd=4")}
        self.assertLess(none["values"]["power"][0]["power"], 0.3)

    def test_wrong_keys_are_refused_with_their_line(self):
        for run, old, new, at in (
                ("values", 'vary = "level_dbfs"', 'vary = "waveform"', "vary"), ("values", 'vary = "level_dbfs"', "", "[[run]]"),
                ("values", "values = [-36, -32", "values = [-36, -36", "values"), ("values", "-16, -12]", "-16, 12]", "values"),
                ("values", "standard = -24", "standard = 24", "standard"), ("values", "standard = -24", "", "vary"),
                ("values", "trials_per_value = 20", "trials_per_value = 20\ntrials = 3", "trials_per_value"),
                ("values", "trials_per_value = 20", "trials = 3\nprocedure = \"quest\"", "procedure"),
                ("words", 'choices = ["one", "two"]', 'choices = ["one"]', "choices"), ("words", 'question = "One or two?"\n', "", "[[run]]"),
                ("bayes", "range = [-40, -8]", "range = [-8, -40]", "range"), ("bayes", "range = [-40, -8]", "", "procedure"),
                ("bayes", 'procedure = "quest"', 'procedure = "quest"\nsteps = [4]', "steps"),
                ("stairs", 'procedure = "1up2down"', 'procedure = "2up"', "procedure"), ("stairs", "steps = [40, 20]", "steps = [50, 20]", "steps"),
                ("stairs", "tracks = 2", "tracks = 2\nstart = [50, 60, 70]", "start"), ("stairs", "tracks = 2", "lapse = 0.1", "lapse"),
                ("stairs", "tracks = 2", "tracks = 3", "tracks"), ("stairs", "tracks = 2", "tracks = 1", "tracks"),
                ("felt", "catch = 0.2", "catch = 1", "catch"), ("same", "trials = 40", "trials = 40\ncatch = 0.1", "catch"),
                ("same", "trials = 40", 'trials = 40\nmethods = ["park"]', "[[run]]"), ("same", "trials = 40", 'trials = 40\nvary = "soa"', "vary"),
                ("level", "standard = -24\n", "", "[[run]]"), ("level", "standard = -24", "standard = -50", "range"),
                ("level", "range = [-40, -8]\n", "", "vary"), ("level", "steps = [1, 4]", "steps = [1, 2, 4]", "steps"),
                ("level", "steps = [1, 4]", "steps = [1, 3.9]", "steps"), ("level", "steps = [1, 4]", "start = [-41]", "start"),
                ("level", "range = [-40, -8]", "range = [-40, 8]", "range"), ("level", "trials = 24", "trials_per_value = 2", "trials_per_value"),
                ("size", "values = [-40", 'choices = ["a", "b"]\nvalues = [-40', "choices"),
                ("there", 'name = "park"', 'name = "none"', None)):
            text = tasks(run).replace(old, new, 1)
            self.assertNotEqual(text, tasks(run))
            self.write("tasks.toml", text.replace('methods = ["park"]', 'methods = ["none"]') if at is None else text)
            told = self.refused(2, "experiment", "tasks.toml", "--dry-run").stderr
            line = 1 + [x.split(" =")[0] for x in text.splitlines()].index(at or "[[run]]")
            self.assertIn(f"tasks.toml:{line}:", told, (run, new, told))

    def test_a_key_that_cannot_be_planned_is_named_where_it_stands(self):
        head = '[experiment]\nname = "soa"\narray = "palm-3x3"\nlevel = { dbfs = -18 }\n' + toml("motion", "across", path="M 2 20 H 38", duration=1)
        soa = dict(question="?", vary="soa_s", trials=8)
        adaptive = toml("run", "quest", task="adaptive", procedure="quest", range=[0.05, 0.13], standard=0.09, **soa)
        plain = toml("run", "which", task="rate", attribute="uniformity", trials=2)
        for text, line, says in (
                (toml("method", "a") + adaptive, "range", 'soa_s = 0.072 of motion "across" with method "a", soa_s: 0.072 s is out of range'),
                (toml("method", "a") + toml("run", "r", task="constant", values=[0.05, 0.2], standard=0.07, **soa), "values", "soa_s = 0.2 of motion"),
                (toml("method", "a") + toml("run", "r", task="constant", values=[0.05, 0.06], standard=0.2, **soa), "standard", "soa_s = 0.2 of motion"),
                (toml("method", "a", burst=0.1) + toml("run", "r", task="constant", values=[0.05, 0.12], standard=0.12, **soa), "values",
                 'soa_s = 0.05 of motion "across" with method "a", burst (line 11): 0.1 s is longer than the SOA of 0.05 s'),
                (toml("method", "a", soa=0.01) + plain, "soa", 'motion "across" with method "a", soa: 0.01 s is out of range'),
                (toml("method", "a", soa_s=0.01) + plain, "soa_s", 'motion "across" with method "a", soa_s: 0.01 s is out of range')):
            self.write("tasks.toml", head + text)
            told = self.refused(2, "experiment", "tasks.toml", "--dry-run", says=[says]).stderr
            self.assertIn(f"tasks.toml:{1 + [x.split(' =')[0] for x in (head + text).splitlines()].index(line)}:", told)
        # A motion that leaves the array fails at every value.
        text = head.replace("H 38", "H 380") + toml("method", "a") + adaptive.replace("0.13", "0.07").replace("0.09", "0.06")
        self.write("tasks.toml", text)
        told = self.refused(2, "experiment", "tasks.toml", "--dry-run", says=["leaves the array"]).stderr
        self.assertIn(f"tasks.toml:{1 + text.splitlines().index('[[motion]]')}:", told)

    def test_only_tasks_with_a_right_answer_have_feedback_and_training(self):
        words = RUNS["words"]
        for run, says in ((toml("run", "good", task="rate", attribute="similarity", trials=8, training=4), 'training does not apply to runs with task "rate" (leave out training, or set task to one of '),
                          (toml("run", "path", task="trace", trials=8, training=4), 'training does not apply to runs with task "trace"'),
                          (words + "training = 4\n", "training needs a right answer, but a run without a standard has none (leave out training, or add standard)"),
                          (words + "feedback = true\n", "feedback needs a right answer, but a run without a standard has none (leave out feedback, or add standard)")):
            self.write("tasks.toml", measures("desk.toml", run, keys="gap_s = 0.1\n"))
            self.refused(2, "experiment", "tasks.toml", "--dry-run", says=[says])
        self.hold(measures("desk.toml", RUNS["values"] + "feedback = true\n", RUNS["bayes"] + "training = 4\n", keys="gap_s = 0.1\n"))
        told = self.ok("report", "study").stdout
        self.assertIn("- Participants were told whether the answer was right: ", told)
        for text in ("in all trials", "in practice"):
            self.assertIn(text, told)

    def test_a_run_of_two_intervals_has_values_or_a_procedure(self):
        head = '[experiment]\nname = "i"\narray = "palm-3x3"\nlevel = { dbfs = -18 }\n' + toml("motion", "across", path="M 2 20 H 38", duration=1) + toml("method", "a")
        own = dict(task="interval", vary="level_dbfs", trials=8)
        for keys, line, says in ((dict(own), "vary", "the run has neither values nor procedure (give one of the two)"),
                                 (dict(own, values=[-30, -20], procedure="quest", range=[-30, -20]), "values", "the run has both values and procedure"),
                                 (dict(own, values=[-30, -20], range=[-30, -20]), "range", "range does not apply to a run without a procedure"),
                                 (dict(own, procedure="1up1down", range=[-30, -20]), "procedure", "as guesses do (use 1up2down, 1up3down or quest)"),
                                 (dict(own, values=[-30, -20], standard=-20), "standard", 'standard does not apply to runs with task "interval"')):
            text = head + toml("run", "felt", **keys)
            self.write("tasks.toml", text)
            told = self.refused(2, "experiment", "tasks.toml", "--dry-run", says=[says]).stderr
            self.assertIn(f"tasks.toml:{len(text.splitlines()) - [x.split(' =')[0] for x in text.splitlines()[::-1]].index(line)}:", told)
        # Intervals of a trial are equally long, even where a value changes how long its stimulus is.
        self.write("tasks.toml", head + toml("run", "felt", task="interval", vary="speed_mm_s", values=[20, 60], trials_per_value=2))
        trials = json.loads(self.ok("experiment", "tasks.toml", "--dry-run", "--format", "json").stdout)
        self.assertEqual({t["value"]: round(t["duration_s"], 3) for t in trials["runs"][0]["trials"]}, {20: 4.64, 60: 2.26})

    def test_the_dry_run_shows_values_and_counts_trials_by_value(self):
        self.write("tasks.toml", TASKS)
        told = {r["name"]: r for r in json.loads(self.ok("experiment", "tasks.toml", "--dry-run", "--format", "json").stdout)["runs"]}
        for name, run in told.items():
            values = [t["value"] for t in run["trials"]]
            stated = {v["value"]: v["trials"] for v in run["values"]}
            if name in ("values", "words", "felt", "size", "level"):
                self.assertEqual(stated, {v: values.count(v) for v in set(values)})
                if name == "level":  # where the trials begin
                    continue
                own = TASKS.partition(f'name = "{name}"')[2].partition("values = [")[2].partition("]")[0]
                self.assertEqual({v for v in stated if v is not None}, {float(v) for v in own.split(",")})
            else:
                self.assertEqual((stated, set(values)), ({}, {None}), name)
            self.assertEqual({t["track"] for t in run["trials"]}, {"bayes": {1}, "stairs": {1, 2, 3, 4}}.get(name, {None}), name)
        said = " ".join(self.ok("experiment", "tasks.toml", "--dry-run").stdout.split())
        self.assertIn("level_dbfs: -36 in 20 trials, -32 in 20 trials, -28 in 20 trials,", said)
        self.assertIn("level_dbfs: none in 10 trials, -60 in 10 trials,", said)
        self.assertRegex(said, r"\d+ east park standard (-36|-32|-28|-24|-20|-16|-12) 0\.")
        self.assertRegex(said, r"\d+ east park standard track \d 0\.")

    def test_figures_have_the_digits_of_their_values(self):
        run = toml("run", "taps", task="constant", question="?", methods=["park"], vary="soa_s", values=[0.052, 0.058, 0.064, 0.07], standard=0.061, trials=80)
        text = measures("desk.toml", run)
        for code in ("01", "02"):
            self.hold(text, code, spec=f"seed={code},pse=0.061,jnd=0.004")
        told = json.loads(self.ok("analyze", "study", "--format", "json").stdout)["runs"]["taps"]["psychometric"]
        said = self.ok("analyze", "study", "--format", "tables").stdout
        self.assertRegex(said, rf"\n    pse against 0\.061 +{told['mean']['pse']:.4f} \(se 0\.\d{{4}}\), 95 % -?0\.\d{{4}} \.\.\. 0\.\d{{4}}")
        self.assertIn(f"jnd {told['participants']['01']['jnd']:.4f}", said)

    def test_the_shipped_studies_run_from_definition_to_figure(self):
        experiments = ROOT / "examples/experiments"
        for name, spec, groups, sessions, check in (
                ("numerosity", "jnd=0.14", [()], [()], lambda r: self.assertAlmostEqual(r["more"]["psychometric"]["mean"]["pse"], 0.77, delta=0.05)),
                ("speed-jnd", "jnd=14", [()], [()], lambda r: self.assertAlmostEqual(r["faster"]["psychometric"]["mean"]["jnd"], 14, delta=5)),
                ("pleasantness", "sigma=20", [()], [("--session", "1"), ("--session", "2")], lambda r: self.assertEqual(r["pleasant"]["trials"], 320)),
                ("directions", "sigma=10", [("--group", "three-by-three"), ("--group", "two-by-four")], [()],
                 lambda r: self.assertEqual(set(r["direction"]["groups"]), {"three-by-three", "two-by-four"}))):
            for i in range(1, 5):
                for session in sessions:
                    self.ok("experiment", experiments / f"{name}.toml", "--participant", f"{i:02}", "-o", name, "--simulate", f"seed={i},{spec}",
                            *groups[i % len(groups)], *session)
            check(json.loads(self.ok("analyze", name, "-o", f"{name}.svg", "--format", "json").stdout)["runs"])
            picture = (self.dir / f"{name}.svg").read_text(encoding="utf-8")
            self.assertTrue("<svg" in picture and "\u2026" not in picture, "a name is cut")
            self.ok("report", name)

    def test_the_power_of_the_shipped_studies_is_as_their_lines_say(self):
        lines = (ROOT / "examples/experiments/README.md").read_text(encoding="utf-8")
        for command in re.findall("^    tactor ((?!.*--merge).*)", lines.replace("\\\n", " "), re.M):
            args = command.split()
            args[1] = ROOT / args[1]
            runs = json.loads(self.ok(*args, "--format", "json").stdout)["runs"]
            stated = re.search(rf"\[{args[1].name}\].*\| ([\d, and]+) %", lines).group(1)
            self.assertEqual([round(100 * r["power"][0]["power"]) for r in runs], [int(n) for n in re.findall(r"\d+", stated)], command)


if __name__ == "__main__":
    main()
