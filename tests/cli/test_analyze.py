# SPDX-License-Identifier: MIT
"""tactor analyze: compared with R's results (tests/study/golden, kept by the lane "statistics"), its forms, and its
refusals."""
import csv
import io
import json
import os
import re
import shutil

from harness import ToolTest, main
from pictures import Svg, number, read_bars
import check_r
import studies

BEH = "sub-01/beh/sub-01_task-taste_beh.tsv"


class AnalyzeTest(ToolTest):
    def study(self, name):
        studies.STUDIES[name](self.dir / name)
        return self.dir / name

    def analysis(self, *args):
        return json.loads(self.ok("analyze", *args, "--format", "json").stdout)


class Figures(AnalyzeTest):
    def test_every_figure_matches_r_and_nothing_else_is_printed(self):
        known = {"method", "reference", "task", "trials", "early", "dropped", "left_out", "track_rule", "a", "b", "participant", "why"}
        for name in studies.STUDIES:
            golden = check_r.read((check_r.GOLDEN / f"{name}.tsv").read_text(encoding="utf-8"))
            self.assertGreater(len(golden), 100)
            told = self.analysis(self.study(name))
            self.assertEqual(list(check_r.differences(golden, told)), [], name)
            # Results of a group are those of a study of it alone (test_experiment.py). test_tasks.py and the lane statistics have
            # the comparisons of methods and sessions.
            places = {p for p, _ in check_r.flat(told) if p.startswith("runs.") and p.split(".")[2] not in ("groups", "methods", "sessions")}
            mine = {p for p in places if not any(g == p or g.startswith(p + ".") for g in golden)}
            self.assertEqual({p for p in mine if p.split(".")[-1] not in known}, set(), name)

    def test_trials_and_participants_are_counted(self):
        text = self.ok("analyze", self.study("simulated"), "--format", "json").stdout
        told = json.loads(text)
        self.assertEqual((told["void"]["similarity"], told["runs"]["similarity"]["trials"]), (36, 480))
        self.assertEqual((told["participants"], told["simulated"]), (12, True))
        self.assertEqual(list(told["runs"]), ["similarity", "uniformity", "similarity-rating", "uniformity-rating"])
        t = json.loads(text, parse_float=str)["runs"]["similarity"]["preference"]["all"]["t"]
        self.assertGreaterEqual(len(t.replace(".", "")), 12)
        told = self.analysis(self.study("three-by-three"))["runs"]
        self.assertEqual(told["pair"]["method"], "continuous")  # the definition's last, whatever the run lists first
        self.assertEqual(sum(sum(row.values()) for m in told["which"]["confusion"].values() for row in m.values()), 360)

    def test_a_participant_without_a_cell_is_left_out_of_that_run_and_named(self):
        told = self.analysis(self.study("missing"))
        self.assertEqual([m["participant"] for m in told["runs"]["taste"]["left_out"]], ["C3", "Late"])
        self.assertEqual([m["participant"] for m in told["runs"]["marks"]["left_out"]], ["E5", "Late"])
        said = self.ok("analyze", "missing", "--format", "tables")
        self.assertIn("marks: sub-E5 is left out: no trial counts in some of the cells", said.stderr)
        self.assertIn("taste: choose, 6 participants", said.stdout)
        self.assertEqual(sorted(told["warnings"]),
                         sorted(line.removeprefix("tactor: warning: ") for line in said.stderr.splitlines()))

    def test_missing_figures_are_null_with_warnings_and_one_line_on_the_terminal(self):
        told = self.analysis(self.study("constant"))
        self.assertIsNone(told["runs"]["taste"]["preference"]["motion"]["motion-3"]["p_holm"])
        self.assertIn("taste: motion-3: no variance over participants, so no t test", told["warnings"])
        self.assertIn("marks: park2016, motion-1: no variance over participants, so no interval", told["warnings"])
        text = studies.definition("same", studies.FOUR, studies.TWO, [studies.run("marks", "rate", 8), studies.run("which", "identify", 8)])
        studies.write_study(self.dir / "same", text, ["1", "2"], lambda _, r, cell, __: 3 if r["task"] == "rate" else cell[0])
        told = self.analysis("same")
        self.assertEqual({told["runs"]["marks"]["anova"]["motion"][k] for k in ("F", "p", "epsilon_gg", "epsilon_hf", "mauchly_w", "eta2_partial")}, {None})
        self.assertEqual({p["p"] for p in told["runs"]["marks"]["tukey"]["park2016"]}, {None})
        self.assertIn("marks: methods: no variance over participants, so no t test", told["warnings"])
        self.assertIsNone(told["runs"]["marks"]["means"]["park2016"]["all"]["ci_within"])
        self.assertIn("marks: park2016, all: no variance within participants, so no interval within participants", told["warnings"])
        self.assertEqual({(p["difference"], p["t"], p["p_holm"]) for p in told["runs"]["which"]["pairs"]["park2016"]}, {(0, None, None)})
        self.assertIn("which: park2016, motion-1 - motion-2: no variance over participants, so no t test", told["warnings"])
        said = self.ok("analyze", "same", "--format", "tables")
        self.assertEqual(said.stderr, f"tactor: warning: {told['warnings'][0]} ({len(told['warnings']) - 1} more warnings: tactor analyze --format json)\n")
        self.assertIn("park2016 - tactile-brush: 0.00, signs 1.000", said.stdout)

    def test_one_participant_has_means_and_no_tests(self):
        told = self.analysis(self.study("simulated"), "--participants", "07")
        cell = told["runs"]["similarity"]["preference"]["all"]
        self.assertIsNotNone(cell["mean"])
        self.assertEqual({v for k, v in cell.items() if k != "mean"}, {None})
        self.assertIn("one participant: tests need two", " ".join(told["warnings"]))
        self.ok("analyze", "simulated", "--participants", "07", "-o", "one.svg")

    def test_choosing_participants_ignores_the_others(self):
        folder = self.study("simulated")
        some = self.analysis(folder, "--participants", "sub-02,05,11,12")
        others = ",".join(f"{i:02}" for i in range(1, 13) if i not in (2, 5, 11, 12))
        self.assertEqual(some, self.analysis(folder, "--exclude", others))
        self.assertEqual(some, self.analysis(folder, "--participants", "02,05,11,12,03", "--exclude", "03"))
        self.assertEqual(some["participants"], 4)
        # Opens nothing of the others.
        (folder / "sub-01/beh/sub-01_task-similarity_beh.tsv").write_text("nonsense")
        self.assertEqual(some, self.analysis(folder, "--participants", "02,05,11,12"))

    def test_groups_are_compared_unless_one_only_took_part(self):
        # R 4.2.2, car: Anova(lm(values ~ group), type = 3) with contr.sum
        self.assertIn("  Analysis of variance with the group as a factor between participants:\n    group: F(1, 10) = 0.48, p = 0.503; eta squared partial 0.046, generalised\n           0.023\n", self.ok("analyze", self.study("grouped"), "--format", "tables").stdout)
        self.assertIn("| group:motion | 3.584 | 2, 20 | 0.04674 | 0.6159 | 0.07584 |", self.ok("report", "grouped").stdout)
        # The picture has the mean of each group by method, with its interval within the participants of the group.
        self.ok("analyze", "grouped", "-o", "a.svg")
        panels = {p.get("data-title"): p for p in Svg(self.dir / "a.svg").all("bars")}
        self.assertNotIn("marks: rating by method (n = 12)", panels)  # the bars of all motions have these means
        drawn, groups = read_bars(panels["which: correct by method (n = 12)"]), self.analysis("grouped")["runs"]["which"]["groups"]
        self.assertEqual(len(drawn), 4)
        own = panels["which: correct by method (n = 12)"]
        texts = lambda kind: [e.text for e in own.iter() if e.get("class") == kind]
        self.assertEqual((texts("axis-title"), texts("tick-label")[::10]), (["correct (%)"], ["0", "100"]))
        for (method, group), (mean, ends) in drawn.items():
            cell = groups[group]["methods"]["correct"]["means"][method]
            self.assertAlmostEqual(mean, cell["mean"], delta=0.5)
            self.assertEqual([round(e - min(max(x, 0), 100)) for e, x in zip(ends, cell["ci_within"])], [0, 0])
        told = self.analysis("grouped", "--participants", "01,02")
        self.assertEqual(told["runs"]["which"]["groups"]["palm"]["n"], 2)
        self.assertEqual({e["F"] for e in told["runs"]["which"]["group_anova"].values()}, {None})
        self.assertIn("which: groups: too few participants to compare them", told["warnings"])
        self.assertNotIn("as a factor", self.ok("analyze", "grouped", "--participants", "01,02", "--format", "tables").stdout)

    def test_folders_of_one_experiment_are_analysed_as_one(self):
        whole = self.analysis(self.study("missing"))
        for name, codes in (("one", "ABCD"), ("two", "EFGL")):
            shutil.copytree(self.dir / "missing", self.dir / name)
            people = self.dir / name / "participants.tsv"
            people.write_text("".join(line for line in people.read_text().splitlines(True) if line[4] in codes or line[:4] != "sub-"))
            for path in (self.dir / name).glob("**/sub-??"):
                if path.name[4] not in codes:
                    shutil.rmtree(path)
        self.assertEqual(self.analysis("one", "two"), whole)
        self.assertEqual(self.analysis("one", "two", "--participants", "A1,F6"), self.analysis("missing", "--participants", "A1,F6"))
        self.ok("analyze", "one", "two", "-o", "one/derivatives/tactor/a.svg")
        self.refused(2, "analyze", "one", "missing")
        self.refused(2, "analyze", "one", self.study("constant"))
        self.refused(2, "analyze", self.study("simulated"), "one")


class Forms(AnalyzeTest):
    def test_no_printed_interval_is_beyond_a_per_cent_or_a_scale(self):
        beyond = 0
        for name in ("simulated", "few", "ties", "three-by-three", "among"):
            text = self.ok("analyze", self.study(name), "--format", "tables").stdout
            beyond += sum(v < 0 or v > 100 for p, v in check_r.flat(self.analysis(name)["runs"]) if v is not None
                          and re.search(r"\.(preference|chosen|correct)\..*\.ci\.[01]$", p))
            shown = re.findall(r"^  \S.*? +[\d.]+ +[\d.]+ +(-?[\d.]+) \.\.\. (-?[\d.]+) ", text, re.M)
            self.assertTrue(all(0 <= float(low) <= float(high) <= 100 for low, high in shown), shown)
            self.assertEqual(bool(shown), "Columns: mean and se" in text, name)
            rated = re.findall(r"^  \S.*? +[\d.]+ +[\d.]+ +(-?[\d.]+) \.\.\. -?[\d.]+$", text, re.M)
            self.assertEqual(bool(rated), "Mean rating" in text)
            self.assertTrue(all(float(low) >= 1 for low in rated), rated)
            shown = re.findall(r"^\| \S.*? \| [\d.]+ \| [\d.]* \| (-?[\d.]+) to (-?[\d.]+) \|", self.ok("report", name).stdout, re.M)
            self.assertTrue(shown and all(0 <= float(low) <= float(high) <= 100 for low, high in shown), shown)
        self.assertGreater(beyond, 0)  # else nothing was tried

    def test_trials_can_be_left_out_by_their_answers_and_are_counted(self):
        folder = self.study("simulated")
        tables = {t: list(csv.DictReader(t.read_text().splitlines(), delimiter="\t")) for t in folder.glob("sub-*/beh/*_task-similarity_beh.tsv")}
        # The last two answers of each participant are early; the table has response times of its own.
        for table, rows in tables.items():
            for i, row in enumerate(rows):
                row["early"] = "true" if i >= len(rows) - 2 else "false"
                row["response_time"] = 0.1 * (i + 1)
            table.write_text("\t".join(rows[0]) + "\n" + "".join("\t".join(map(str, r.values())) + "\n" for r in rows))

        def counted(*options, keep):
            told = self.analysis(folder, *options)
            valid = [[r for r in rows if r["void"] == "false"] for rows in tables.values()]
            kept = sum(sum(map(keep, rows)) for rows in valid)
            run = told["runs"]["similarity"]
            self.assertEqual((run["trials"], run["dropped"]), (kept, sum(map(len, valid)) - kept))
            self.assertFalse([w for w in told["warnings"] if "that count, of" in w])
            return told

        self.assertEqual(counted(keep=lambda r: True)["drop_rule"], "")
        told = counted("--drop-early", keep=lambda r: r["early"] == "false")
        self.assertEqual(told["drop_rule"], "answers marked early")
        told = counted("--response-time", "0.35,3.05", keep=lambda r: 0.35 <= r["response_time"] <= 3.05)
        self.assertEqual(told["drop_rule"], "response times outside 0.35 to 3.05 s")
        both = ("--drop-early", "--response-time", "0.35,3.05")
        dropped = counted(*both, keep=lambda r: r["early"] == "false" and 0.35 <= r["response_time"] <= 3.05)["runs"]["similarity"]["dropped"]
        why = "answers marked early; response times outside 0.35 to 3.05 s"
        self.assertIn(f"  {dropped} trials left out: {why}\n", self.ok("analyze", folder, "--format", "tables", *both).stdout)
        self.assertIn(f"Trials left out: {dropped} ({why}).", self.ok("report", folder, *both).stdout)
        self.assertNotIn("Trials left out", self.ok("report", folder).stdout)
        for wrong in ("1", "2,1", "1,nan", "-1,2", "a,b", "1,2,3"):
            self.refused(2, "analyze", folder, "--response-time", wrong, says=["--response-time: ", "is not a range of times"])

    def test_a_summary_has_the_main_figure_of_each_run_in_ten_lines(self):
        told = self.analysis(self.study("simulated"))["runs"]
        text = self.ok("analyze", "simulated", "--exclude", "07:asleep,09").stdout
        self.assertEqual(text.splitlines()[:3], ["park2016: 10 participants, SIMULATED: no person gave these answers", *text.splitlines()[1:2],
                                                 "excluded: sub-07 (asleep), sub-09 (no reason was given)"])
        text = self.ok("analyze", "simulated").stdout
        self.assertTrue(self.ok("analyze", "simulated", "--format", "tables").stdout.startswith(text))
        lines = dict(line.split(": ", 1) for line in text.splitlines()[2:])
        self.assertEqual(list(lines), list(told))
        for name, run in told.items():
            rate = run["task"] == "rate"
            all_motions = run["paired"] if rate else run["preference"]["all"]
            mean, (low, high) = all_motions["difference" if rate else "mean"], all_motions["ci"]
            self.assertEqual(lines[name], f"park2016 {'- tactile-brush' if rate else 'chosen (%)'} {mean:.2f} ({low:.2f} ... {min(high, 100):.2f})"
                                          f"{'' if rate else ' against 50'}, p < 0.001")
        # Four runs have three results each; seven fit.
        text = studies.definition("many", studies.FOUR, studies.TWO, [studies.run(f"run {i}", "identify", 8) for i in range(4)], ["a", "b"])
        studies.write_study(self.dir / "many", text, ["1", "2"], lambda _, r, cell, n: cell[0], groups={"1": "a", "2": "b"}, void=5)
        lines = self.ok("analyze", "many").stdout.splitlines()
        self.assertEqual((len(lines), lines[-1]), (10, "and 5 more results: --format tables"))
        self.assertEqual(lines[2], "run 0: park2016 correct (%) 100.00")

    def test_each_trial_that_counts_has_a_line(self):
        notes, rows = self.trials(self.study("simulated"))
        self.assertEqual(notes[0], "# simulated: no person gave these answers")
        self.assertEqual(notes[2], '# options(contrasts = c("contr.sum", "contr.poly"))')
        self.assertIn('# glmer(chosen ~ motion + order + (1 + motion | participant), family = binomial, '
                      'data = subset(d, run == "similarity"))', notes)
        self.assertIn('# lmer(rating ~ method * motion + (1 + method | participant), '
                      'data = subset(d, run == "similarity-rating"))', notes)
        self.assertIn("skip = 8,", notes[3])
        self.assertEqual(len(rows), 12 * 160)
        told = self.analysis("simulated")["runs"]
        similar = [r for r in rows if r["run"] == "similarity" and r["motion"] == "motion-2"]
        self.assertAlmostEqual(100 * sum(int(r["chosen"]) for r in similar) / len(similar),
                               told["similarity"]["preference"]["motion"]["motion-2"]["mean"], 9)
        self.assertEqual({r["order"] for r in similar}, {"0.5", "-0.5"})
        self.assertEqual({r["method"] for r in similar}, {"park2016"})
        for r in similar:
            self.assertEqual(r["chosen"] == "1", (r["order"] == "0.5") == (r["response"] == "1"))
        rated = [float(r["rating"]) for r in rows if r["run"] == "uniformity-rating" and r["method"] == "tactile-brush"]
        self.assertAlmostEqual(sum(rated) / len(rated),
                               told["uniformity-rating"]["means"]["tactile-brush"]["all"]["mean"], 9)
        self.assertTrue(any(r["attempt"] == "2" for r in rows))
        self.assertNotIn("other", rows[0])

    def test_three_methods_to_choose_from_have_rows_worths_and_a_model(self):
        notes, rows = self.trials(self.study("among"))
        self.assertIn('# glmer(chosen ~ worth + worth:motion + (1 + worth | participant), family = binomial, '
                      'data = within(subset(d, run == "all three"), worth <- sapply(c("park2016", "continuous"), '
                      'function(m) (method == m) - (other == m))))', notes)
        self.assertEqual({(r["method"], r["other"]) for r in rows if r["run"] == "last two"}, {("continuous", "park2016")})
        told = self.analysis("among")["runs"]["all three"]
        for name, cells in told["chosen"].items():
            own = [r["chosen"] == str(int(r["method"] == name)) for r in rows if r["run"] == "all three" and r["motion"] == "motion-2"
                   and name in (r["method"], r["other"])]
            self.assertAlmostEqual(100 * sum(own) / len(own), cells["motion"]["motion-2"]["mean"], 9)
        shown = self.ok("analyze", "among", "--format", "tables").stdout
        self.assertLessEqual(max(map(len, shown.partition("\n\n")[2].splitlines())), 80)
        worths = told["bradley_terry"]
        for name in ("park2016", "continuous"):
            self.assertRegex(shown, rf"(?m)^    {name} +{worths['log_worth'][name]:.2f} \({worths['se'][name]:.2f}\)$")
        self.ok("analyze", "among", "-o", "a.svg")
        panel = Svg(self.dir / "a.svg").all("bars")[0]
        y0, ky = number(panel, "data-y0"), number(panel, "data-y-scale")
        bars = [e for e in panel.iter() if e.get("class") == "bar"]
        self.assertEqual(len(bars), 3 * 4)
        for bar in bars:
            cells, group = told["chosen"][bar.get("data-series")], bar.get("data-group")
            cell = cells["all"] if group == "all" else cells["motion"][group]
            self.assertAlmostEqual((number(bar, "y") - y0) / ky, cell["mean"], delta=0.02)

    def wide(self, name):
        text = self.ok("analyze", name, "--format", "wide").stdout
        return text, list(csv.DictReader(io.StringIO(text)))

    def test_a_wide_table_has_each_participant_once_with_all_cells(self):
        for name in ("three-by-three", "among", "simulated"):
            told = self.analysis(self.study(name))
            text, rows = self.wide(name)
            self.assertEqual(len(text.splitlines()), 1 + told["participants"])
            expected = check_r.wide_means(told)
            self.assertEqual(list(rows[0]), ["participant_id", *(["simulated"] if told["simulated"] else []), *expected])
            self.assertEqual({r.get("simulated", "true") for r in rows}, {"true"})
            for column, mean in expected.items():
                self.assertAlmostEqual(sum(float(r[column]) for r in rows) / len(rows), mean, 9)
        self.assertEqual([r["participant_id"] for r in rows[:2]], ["sub-01", "sub-02"])
        self.assertEqual(self.ok("analyze", "simulated", "--format", "wide", env={"LC_ALL": "de_DE.UTF-8"}).stdout, text)

    def test_a_wide_table_has_empty_cells_for_who_is_left_out(self):
        self.study("missing")
        rows = {r.pop("participant_id"): r for r in self.wide("missing")[1]}
        empty = {code: {c.split(".")[0] for c, v in r.items() if v == ""} for code, r in rows.items()}
        full = {code: {c.split(".")[0] for c, v in r.items() if v != ""} for code, r in rows.items()}
        self.assertEqual({code: runs for code, runs in empty.items() if runs},
                         {"sub-C3": {"taste"}, "sub-E5": {"marks"}, "sub-Late": {"taste", "marks"}})
        self.assertEqual((full["sub-C3"], full["sub-E5"], full["sub-Late"]), ({"marks"}, {"taste"}, set()))

    def test_columns_of_a_wide_table_have_names_for_any_program(self):
        motions = ["a b", "a-b", "A_B", "m" * 39 + "1", "m" * 39 + "2", "nach Süden.", "\u6771"]
        text = studies.definition("odd", motions, studies.TWO, [studies.run("2 points", "rate", 14)])
        studies.write_study(self.dir / "odd", text, ["1", "2"], lambda *_: 3)
        columns = list(self.wide("odd")[1][0])[1:]
        self.assertEqual(len(columns), 14)
        self.assertEqual(len({c.lower() for c in columns}), 14)
        for c in columns:
            self.assertRegex(c, r"^[A-Za-z][A-Za-z0-9._]{0,62}[A-Za-z0-9_]$")
        head = "x2_points.tactile_brush."
        self.assertEqual(columns[:3], [head + "a_b", head + "a_b_2", head + "A_B_3"])
        self.assertEqual(columns[3:7], [head + "m" * 19, head + "m" * 19 + "_2", head + "nach_S_den_", head + "_"])

    def test_r_reads_names_of_any_letters(self):
        name = '"x" # \\\\'
        text = studies.definition("odd", ["motion #1", 'a "b" \\\\ c'], studies.TWO,
                                  [studies.run(name, "rate", 4), studies.run("y", "rate", 4)])
        studies.write_study(self.dir / "odd", text, ["1", "2"], lambda *_: 3, simulated=True)
        lines = self.ok("analyze", "odd", "--format", "tsv").stdout.splitlines()
        notes = next(i for i, line in enumerate(lines) if not line.startswith("#"))
        self.assertIn(f"skip = {notes}, ", lines[3])
        self.assertTrue(lines[notes].startswith("participant\trun\t"))
        self.assertTrue(lines[4].endswith(f"subset(d, run == {json.dumps(name)}))"), lines[4])

    def test_text_fits_a_terminal_in_any_locale_and_gives_the_paper_s_result(self):
        text = self.ok("analyze", self.study("simulated"), "--format", "tables").stdout
        self.assertLessEqual(max(map(len, text.splitlines())), 80)
        self.assertIn("SIMULATED", text.splitlines()[0])
        self.assertIn("144 trials void, not counted", text)
        every = " ".join(text.split())
        self.assertIn("13.23^2 is 175.0, not 40.66", every)
        told = self.analysis("simulated")["runs"]
        times = told["similarity"]["response_time"]
        low, high = min(times["by"].values()), max(times["by"].values())
        self.assertIn(f"response time: median {times['median_s']:.2f} s, from {low:.2f} s (", every)
        self.assertIn(f" to {high:.2f} s (", every)
        self.assertIn(f"{told['similarity']['preference']['all']['mean']:.2f}", text)
        for run in told.values():
            for effect, found in run.get("anova", {}).items():
                if found["F"] is not None:
                    self.assertRegex(every, rf"\b{effect}: F\([0-9, ]+\) = {found['F']:.2f}")
        for form in ("text", "tables", "json", "tsv"):
            self.assertEqual(*(self.ok("analyze", "simulated", "--format", form, env={"LC_ALL": locale}).stdout
                               for locale in ("C", "de_DE.UTF-8")))
        self.assertNotIn("Park et al.", self.ok("analyze", self.study("ties"), "--format", "tables").stdout)
        text = self.ok("analyze", self.study("three-by-three"), "--format", "tables").stdout
        pair = self.analysis("three-by-three")["runs"]["which"]["pairs"]["tactile-brush"][1]
        self.assertIn(f"    motion-1 - motion-3 {pair['difference']:>7.2f} t = {pair['t']:>5.2f}, p = {pair['p']:.3f}, "
                      f"Holm {pair['p_holm']:.3f}\n", text)

    def test_bars_are_as_high_as_means_with_their_standard_errors(self):
        self.ok("analyze", self.study("simulated"), "-o", "a.svg")
        picture, told = Svg(self.dir / "a.svg"), self.analysis("simulated")["runs"]
        panels = picture.all("bars")
        self.assertEqual(len(panels), 4)
        for panel, (name, run) in zip(panels, told.items()):
            self.assertEqual(panel.get("data-title"), f"{name} (n = 12)")
            y0, ky = number(panel, "data-y0"), number(panel, "data-y-scale")
            bars = [e for e in panel.iter() if e.get("class") == "bar"]
            errors = [e for e in panel.iter() if e.get("class") == "error"]
            self.assertEqual((len(bars), len(errors)), ((5, 5) if run["task"] == "choose" else (10, 10)))
            for bar, error in zip(bars, errors):
                group, series = bar.get("data-group"), bar.get("data-series")
                cells = run["preference"] if run["task"] == "choose" else run["means"][series]
                cell = cells["all"] if group == "all" else cells["motion"][group]
                self.assertAlmostEqual((number(bar, "y") - y0) / ky, cell["mean"], delta=0.02)
                low, high = sorted((number(error, y) - y0) / ky for y in ("y1", "y2"))
                self.assertAlmostEqual((high - low) / 2, cell["se"], delta=0.02)
        self.assertEqual(["".join(e.itertext()) for e in picture.all("across")], ["simulated"] * 4)
        self.ok("analyze", self.study("ties"), "-o", "b.svg")
        self.assertNotIn("simulated", (self.dir / "b.svg").read_text())

    def test_error_bars_are_those_that_were_chosen(self):
        cut = 0
        for study in ("simulated", "constant", "among"):
            told = self.analysis(self.study(study))["runs"]
            for bars, key in (("within", "ci_within"), ("ci", "ci")):
                self.ok("analyze", study, "--bars", bars, "-o", f"{bars}.svg")
                for panel, run in zip(Svg(self.dir / f"{bars}.svg").all("bars"), told.values(), strict=True):
                    y0, ky = number(panel, "data-y0"), number(panel, "data-y-scale")
                    least, most = (0, 100) if run["task"] == "choose" else (1, 5)
                    expected = []
                    for bar in (e for e in panel.iter() if e.get("class") == "bar"):
                        cells = run.get("preference") or (run.get("means") or run["chosen"])[bar.get("data-series")]
                        ends = (cells["motion"] | {"all": cells["all"]})[bar.get("data-group")][key]
                        expected += [[max(ends[0], least), min(ends[1], most)]] if ends else []
                        cut += bool(ends) and ends[1] > most
                    drawn = [sorted((number(e, y) - y0) / ky for y in ("y1", "y2")) for e in panel.iter() if e.get("class") == "error"]
                    self.assertEqual(len(drawn), len(expected))
                    for pair in zip(drawn, expected):
                        for shown, end in zip(*pair):
                            self.assertAlmostEqual(shown, end, delta=0.02)
        self.assertGreater(cut, 0)  # else nothing was cut
        self.refused(2, "analyze", "simulated", "--bars", "sd", "-o", "never.svg")

    def test_a_matrix_has_the_number_of_each_answer_and_nothing_for_none(self):
        told = self.analysis(self.study("three-by-three"))["runs"]["which"]["confusion"]
        self.ok("analyze", "three-by-three", "-o", "a.svg")
        panels = Svg(self.dir / "a.svg").all("matrix")
        self.assertEqual([p.get("data-title") for p in panels], [f"which: answers with {m}" for m in told])
        for panel, confusion in zip(panels, told.values()):
            cells = [e for e in panel.iter() if e.get("class") == "cell"]
            counts = {(e.get("data-row"), e.get("data-column")): int(e.get("data-count")) for e in cells}
            self.assertEqual(counts, {(i, k): n for i, row in confusion.items() for k, n in row.items()})
            shown = [e.text for e in panel.iter() if e.get("class") == "count"]
            self.assertEqual(shown, [str(n) for row in confusion.values() for n in row.values() if n])
            light = {e.get("data-row"): [] for e in cells}
            for e in cells:  # the more answers, the less red there is
                light[e.get("data-row")].append((int(e.get("data-count")), -int(e.get("fill")[1:3], 16)))
                self.assertEqual(e.get("data-count") == "0", e.get("fill") == "#ffffff")
            for row in light.values():
                self.assertEqual(sorted(row), sorted(row, key=lambda v: v[1]))

    def test_pictures_of_all_kinds_work_also_among_the_derivatives(self):
        folder = self.study("two-levels")
        within = folder / "derivatives/tactor"
        # For any way to write that folder.
        for study, where, head in ((folder, within / "a.pdf", b"%PDF-"), (f"./{folder.name}/", within / "a.png", b"\x89PNG"),
                                   (folder, f"{folder.name}/../{folder.name}/derivatives/tactor/a.svg", b"<?xml")):
            self.ok("analyze", study, "-o", where)
            self.assertTrue((self.dir / where).read_bytes().startswith(head))
            shutil.rmtree(folder / "derivatives")
        self.refused(2, "analyze", folder, "-o", self.dir / "nowhere/a.svg")
        self.refused(2, "analyze", folder, "-o", "a.jpg")


class Refusals(AnalyzeTest):
    def setUp(self):
        super().setUp()
        self.folder = self.study("constant")

    def bad(self, *args):
        """Analyses the study, which must be refused: the golden messages name what is wrong, and where."""
        self.assertEqual(self.refused(2, "analyze", self.folder, *(args or ("-o", "never.svg"))).stdout, "")
        self.assertFalse((self.dir / "never.svg").exists())

    def changed(self, name, text):
        """Analyses the study with another text of a file; it must be refused."""
        file = self.folder / name
        before = file.read_bytes()
        file.write_text(text)
        with self.subTest(name=name, text=text[-300:]):
            self.bad()
        file.write_bytes(before)

    def cells(self, name, line, **values):
        """Returns a table with other values in a line; lines count from 1."""
        lines = (self.folder / name).read_text().split("\n")
        cells = lines[line - 1].split("\t")
        for column, value in values.items():
            cells[studies.COLUMNS.index(column)] = value
        return "\n".join([*lines[:line - 1], "\t".join(cells), *lines[line:]])

    def test_impossible_answers_and_names_are_refused(self):
        for values in ({"response": "3"}, {"response": "n/a"}, {"motion": "motion-9"}, {"method_1": "brush"}, {"method_2": "n/a"},
                       {"method_1": "park2016", "method_2": "park2016"}, {"trial": "2"}, {"trial": "0"}, {"trial": "n/a"}, {"attempt": "x"},
                       {"void": "n/a"}, {"void": "yes"}, {"response_time": "soon"}, {"response_time": "nan"},
                       {"motion": "\x1b[2Jx"}):  # which steers no terminal
            self.changed(BEH, self.cells(BEH, 7, **values))
        name = BEH.replace("taste", "marks")
        for response, rating in (("6", "6"), ("2", "3"), ("n/a", "n/a"), ("3.5", "3.5")):
            self.changed(name, self.cells(name, 4, response=response, rating=rating))
        self.ok("analyze", self.folder)

    def test_incomplete_tables_are_refused(self):
        text = (self.folder / BEH).read_text()
        for broken in ("", text[:-20], text.replace("\t", " ", 1), text.replace("void", "vo\x00id", 1), text.replace("\tvoid", "\tmotion", 1),
                       text.replace("\tvoid", "\tVoid", 1)):
            self.changed(BEH, broken)
        (self.folder / BEH).unlink()
        os.mkfifo(self.folder / BEH)
        for form in ("text", "json", "tsv"):
            self.bad("--format", form)

    def test_impossible_participants_are_refused(self):
        people = (self.folder / "participants.tsv").read_text()
        for text in (people + "sub-../../etc\tn/a\tn/a\tn/a\n", people + "07\tn/a\tn/a\tn/a\n", people + "sub-01\tn/a\tn/a\tn/a\n", "participant_id\n",
                     re.sub("sub-04.*\n", "", people)):
            self.changed("participants.tsv", text)
        for args in (("--participants", "01,Nobody"), ("--exclude", "99"), ("--exclude", "01,02,03,04,05,06"), ("--participants", "01,,02")):
            self.bad(*args)

    def test_folders_that_are_no_study_are_refused(self):
        for args in ((self.dir / "none",), (self.folder / "participants.tsv",), (self.dir,), (), (self.folder, "--format", "csv")):
            self.refused(2, "analyze", *args)
        shutil.rmtree(self.folder / "sourcedata")
        self.bad()

    def test_impossible_sessions_are_refused(self):
        name = "sourcedata/sub-02/session.json"
        told = json.loads((self.folder / name).read_text())
        text = told["experiment"]["text"]
        for broken in ("{\n\"simulated\": tru", "[]", "[" * 100000, "{}", *(json.dumps(told | other) for other in (
                {"simulated": 1}, {"simulated": True}, {"experiment": "park2016"}, {"experiment": {"text": text + "[[run"}},
                {"experiment": {"text": text.replace("motion-4", "motion-5")}}))):
            self.changed(name, broken)
        (self.folder / name).write_text(json.dumps(told | {"experiment": {"text": text + "# changed\n"}}))
        self.assertIn("the texts of their experiments differ", self.ok("analyze", self.folder).stderr)

    def test_an_unreachable_participant_is_not_a_missing_one(self):
        # Like git-annex before fetching; a folder that was moved and linked; a file in place of a folder.
        beh = self.folder / "sub-02/beh"
        for name, target in ((beh / "sub-02_task-taste_beh.tsv", "../../.annex/none"), (beh, "beh"), (beh, "/nowhere"), (self.folder / "sub-02", "sub-02"),
                             (self.folder / "sourcedata/sub-02/session.json", "none"), (beh, None)):
            name.rename(self.dir / "aside")
            if target:
                name.symlink_to(target)
            else:
                name.write_text("")
            self.bad()
            name.unlink()
            (self.dir / "aside").rename(name)
        self.ok("analyze", self.folder)

    def test_files_of_no_run_are_not_overlooked(self):
        other = self.folder / BEH.replace("taste", "other")
        other.write_text("trial\n")
        self.bad()
        other.rename(other.with_name(f".{other.name}"))
        self.ok("analyze", self.folder)


if __name__ == "__main__":
    main()
