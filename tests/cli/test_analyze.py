# SPDX-License-Identifier: MIT
"""tactor analyze: compared with R's results (tests/study/golden, kept by the lane "statistics"), its forms, and its
refusals."""
import csv
import io
import json
import os
import re
import shutil
import sys

from harness import ROOT, ToolTest, main
from pictures import Svg, number

sys.path.insert(0, str(ROOT / "tests/study"))
import check_r  # noqa: E402
import studies  # noqa: E402

BEH = "sub-01/beh/sub-01_task-taste_beh.tsv"


class AnalyzeTest(ToolTest):
    def study(self, name):
        studies.STUDIES[name](self.dir / name)
        return self.dir / name

    def analysis(self, *args):
        return json.loads(self.ok("analyze", *args, "--format", "json").stdout)


class AsRHasIt(AnalyzeTest):
    def test_every_figure_matches_r(self):
        for name in studies.STUDIES:
            self.study(name)
            golden = check_r.read((check_r.GOLDEN / f"{name}.tsv").read_text(encoding="utf-8"))
            self.assertGreater(len(golden), 100)
            self.assertEqual(list(check_r.differences(golden, self.analysis(name))), [], name)

    def test_nothing_is_printed_that_r_did_not_compute(self):
        known = {"method", "task", "trials", "early", "left_out", "a", "b", "participant", "why"}
        for name in studies.STUDIES:
            golden = set(check_r.read((check_r.GOLDEN / f"{name}.tsv").read_text(encoding="utf-8")))
            self.study(name)
            told = {p for p, _ in check_r.flat(self.analysis(name)) if p.startswith("runs.")}
            mine = {p for p in told if not any(g == p or g.startswith(p + ".") for g in golden)}
            self.assertEqual({p for p in mine if p.split(".")[-1] not in known}, set(), name)

    def test_numbers_have_all_their_digits(self):
        text = self.ok("analyze", self.study("simulated"), "--format", "json").stdout
        t = json.loads(text, parse_float=str)["runs"]["similarity"]["preference"]["all"]["t"]
        self.assertGreaterEqual(len(t.replace(".", "")), 12)
        self.assertNotIn("nan", text.lower().replace("inance", ""))


class Counting(AnalyzeTest):
    """Computes by hand, from the lines of the tables."""

    def rows(self, folder, code, run):
        return list(csv.DictReader((folder / f"sub-{code}/beh/sub-{code}_task-{run}_beh.tsv").open(), delimiter="\t"))

    def test_void_trials_do_not_count_and_cells_weigh_alike(self):
        folder = self.study("simulated")
        told = self.analysis(folder)
        means, voids = [], 0
        for code in (f"{i:02}" for i in range(1, 13)):
            cells = {}
            for row in self.rows(folder, code, "similarity"):
                voids += row["void"] == "true"
                if row["void"] == "false":
                    chosen = row["method_" + row["response"]] == "park2016"
                    cells.setdefault(row["motion"], []).append(100 * chosen)
            means.append(sum(sum(c) / len(c) for c in cells.values()) / len(cells))
        all_of_it = told["runs"]["similarity"]["preference"]["all"]
        self.assertAlmostEqual(all_of_it["mean"], sum(means) / 12, 9)
        self.assertEqual(told["void"]["similarity"], voids)
        self.assertEqual((voids, told["runs"]["similarity"]["trials"]), (36, 480))
        self.assertEqual((told["participants"], told["simulated"]), (12, True))
        self.assertEqual(list(told["runs"]), ["similarity", "uniformity", "similarity-rating", "uniformity-rating"])

    def test_f_of_two_methods_is_t_squared(self):
        for name in ("simulated", "ties", "missing", "two-levels"):
            for run in self.analysis(self.study(name))["runs"].values():
                if run["task"] == "rate":
                    self.assertAlmostEqual(run["anova"]["method"]["F"] / run["paired"]["t"] ** 2, 1, 9)

    def test_a_participant_without_a_cell_is_left_out_of_that_run_and_named(self):
        folder = self.study("missing")
        told = self.analysis(folder)
        runs = told["runs"]
        self.assertEqual((told["participants"], runs["taste"]["n"], runs["marks"]["n"]), (8, 6, 6))
        self.assertEqual([m["participant"] for m in runs["taste"]["left_out"]], ["C3", "Late"])
        self.assertEqual([m["participant"] for m in runs["marks"]["left_out"]], ["E5", "Late"])
        self.assertEqual(runs["taste"]["preference"]["all"]["df"], 5)
        said = self.ok("analyze", folder)
        self.assertIn("tactor: warning: taste: sub-C3 is left out: no trial that counts\n", said.stderr)
        self.assertIn("marks: sub-E5 is left out: no trial that counts in some of the cells", said.stderr)
        self.assertIn("taste: choose, 6 participants", said.stdout)
        self.assertEqual(sorted(told["warnings"]),
                         sorted(line.removeprefix("tactor: warning: ") for line in said.stderr.splitlines()))

    def test_no_variance_is_null_with_a_warning(self):
        told = self.analysis(self.study("constant"))
        cell = told["runs"]["taste"]["preference"]["motion"]["motion-3"]
        self.assertEqual(cell, {"mean": 100, "se": 0, "ci": None, "t": None, "df": 5, "p": None, "p_signflip": 1 / 32,
                                "d": None, "d_ci": None, "p_holm": None})
        self.assertIn("taste: motion-3: no variance over participants, so no t test", told["warnings"])
        self.assertIsNone(told["runs"]["marks"]["means"]["park2016"]["motion"]["motion-1"]["ci"])
        self.assertIn("marks: park2016, motion-1: no variance over participants, so no interval", told["warnings"])

    def test_missing_figures_have_one_line_of_warnings(self):
        text = studies.definition("same", studies.FOUR, studies.TWO, [studies.run("marks", "rate", 8)])
        studies.write_study(self.dir / "same", text, ["1", "2"], lambda *_: 3)
        warnings = self.analysis("same")["warnings"]
        self.assertGreater(len(warnings), 10)
        self.assertEqual(self.ok("analyze", "same").stderr,
                         f"tactor: warning: {warnings[0]} ({len(warnings) - 1} more warnings: --format json)\n")

    def test_equal_ratings_have_no_analysis_of_variance(self):
        text = studies.definition("same", studies.FOUR, studies.TWO, [studies.run("marks", "rate", 8)])
        studies.write_study(self.dir / "same", text, ["1", "2", "3"], lambda *_: 3)
        told = self.analysis("same")
        run = told["runs"]["marks"]
        for method in studies.TWO:
            self.assertIn(f"marks: {method}, all: no variance over participants, so no interval", told["warnings"])
        self.assertEqual({run["anova"]["motion"][k] for k in ("F", "p", "epsilon_gg", "mauchly_w", "eta2_partial")}, {None})
        self.assertEqual((run["paired"]["t"], run["paired"]["difference"], run["paired"]["p_signflip"]), (None, 0, 1))
        self.assertEqual({p["p"] for p in run["tukey"]["park2016"]}, {None})

    def test_equal_means_with_rounded_sums_are_no_result(self):
        # Each rates both methods alike, each motion of one like another of the other: thirds in another order.
        numbers = studies.Numbers(7)
        sums = {code: [3 + numbers.below(12) for _ in studies.FOUR] for code in "123456"}
        text = studies.definition("equal", studies.FOUR, studies.TWO, [studies.run("marks", "rate", 24)])

        def answers(code, _, cell, n):
            at = studies.FOUR.index(cell[0])
            return (sums[code][at if cell[1] == "park2016" else (at + 1) % 4] + n) // 3
        studies.write_study(self.dir / "equal", text, list(sums), answers)
        folder = self.dir / "equal"
        told = self.analysis(folder)
        run = told["runs"]["marks"]
        self.assertEqual([run["paired"][k] for k in ("difference", "t", "p", "d_z", "p_signflip")], [0, None, None, None, 1])
        self.assertIsNone(run["anova"]["method"]["F"])
        self.assertIn("marks: methods: no variance over participants, so no t test", told["warnings"])
        self.assertIn("park2016 - tactile-brush: 0.00, signs 1.000", self.ok("analyze", folder).stdout)

    def test_one_participant_has_means_and_no_tests(self):
        folder = self.study("simulated")
        told = self.analysis(folder, "--participants", "07")
        cell = told["runs"]["similarity"]["preference"]["all"]
        self.assertIsNotNone(cell["mean"])
        self.assertEqual({v for k, v in cell.items() if k != "mean"}, {None})
        self.assertIn("one participant: tests need two", " ".join(told["warnings"]))
        self.ok("analyze", folder, "--participants", "07", "-o", "one.svg")

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

    def test_the_last_method_is_that_of_the_definition_whatever_a_run_lists_first(self):
        told = self.analysis(self.study("three-by-three"))["runs"]
        self.assertEqual(told["pair"]["method"], "continuous")
        self.assertEqual(sum(sum(row.values()) for m in told["which"]["confusion"].values() for row in m.values()), 360)


class Forms(AnalyzeTest):
    def test_columns_are_explained_and_no_interval_is_beyond_a_per_cent(self):
        beyond = 0
        for name in studies.STUDIES:
            folder = self.study(name)
            text = self.ok("analyze", folder).stdout
            told = self.analysis(folder)
            beyond += sum(v < 0 or v > 100 for p, v in check_r.flat(told["runs"]) if v is not None
                          and re.search(r"\.(preference|correct)\..*\.ci\.[01]$", p))
            shown = re.findall(r"^  \S.*? +[\d.]+ +[\d.]+ +(-?[\d.]+) \.\.\. (-?[\d.]+) ", text, re.M)
            self.assertTrue(all(0 <= float(low) <= float(high) <= 100 for low, high in shown), shown)
            self.assertEqual(bool(shown), "Columns: mean and se" in text, name)
            rated = re.findall(r" all \S+ \(\S+\), 95 % (-?[\d.]+) \.\.\. (-?[\d.]+)$", text, re.M)
            self.assertTrue(all(float(low) >= 1 for low, _ in rated), rated)
            shown = re.findall(r"^\| \S.*? \| [\d.]+ \| [\d.]* \| (-?[\d.]+) to (-?[\d.]+) \|", self.ok("report", folder).stdout, re.M)
            self.assertTrue(shown and all(0 <= float(low) <= float(high) <= 100 for low, high in shown), shown)
        self.assertGreater(beyond, 0)  # else nothing was tried

    def test_each_trial_that_counts_has_a_line(self):
        folder = self.study("simulated")
        text = self.ok("analyze", folder, "--format", "tsv").stdout
        notes = [line for line in text.splitlines() if line.startswith("#")]
        self.assertEqual(notes[0], "# simulated: these are no people's answers")
        self.assertEqual(notes[2], '# options(contrasts = c("contr.sum", "contr.poly"))')
        self.assertIn('# glmer(chosen ~ motion + order + (1 + motion | participant), family = binomial, '
                      'data = subset(d, run == "similarity"))', notes)
        self.assertIn('# lmer(rating ~ method * motion + (1 + method | participant), '
                      'data = subset(d, run == "similarity-rating"))', notes)
        self.assertIn("skip = 8,", notes[3])
        rows = list(csv.DictReader(io.StringIO("".join(line + "\n" for line in text.splitlines() if line[0] != "#")),
                                   delimiter="\t"))
        self.assertEqual(len(rows), 12 * 160)
        told = self.analysis(folder)["runs"]
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

    def test_r_reads_names_of_any_letters(self):
        name = '"x" # \\\\'
        text = studies.definition("odd", ["motion #1", 'a "b" \\\\ c'], studies.TWO,
                                  [studies.run(name, "rate", 4), studies.run("y", "rate", 4)])
        folder = self.dir / "odd"
        studies.write_study(folder, text, ["1", "2"], lambda *_: 3, simulated=True)
        lines = self.ok("analyze", folder, "--format", "tsv").stdout.splitlines()
        notes = next(i for i, line in enumerate(lines) if not line.startswith("#"))
        self.assertIn(f"skip = {notes}, ", lines[3])
        self.assertTrue(lines[notes].startswith("participant\trun\t"))
        self.assertTrue(lines[4].endswith(f"subset(d, run == {json.dumps(name)}))"), lines[4])

    def test_text_fits_a_terminal_and_gives_the_paper_s_result(self):
        text = self.ok("analyze", self.study("simulated")).stdout
        self.assertLessEqual(max(map(len, text.splitlines())), 80)
        self.assertIn("SIMULATED", text.splitlines()[0])
        self.assertIn("144 trials void, not counted", text)
        self.assertIn("13.23^2 is 175.0, not 40.66", " ".join(text.split()))
        told = self.analysis("simulated")["runs"]["similarity"]
        self.assertIn(f"F(3, 33) = {told['anova']['motion']['F']:.2f}", text)
        self.assertIn(f"{told['preference']['all']['mean']:.2f}", text)
        every = " ".join(text.split())
        for run in self.analysis("simulated")["runs"].values():
            for effect, found in run.get("anova", {}).items():
                if found["F"] is not None:
                    self.assertRegex(every, rf"\b{effect}: F\([0-9, ]+\) = {found['F']:.2f}")
        self.assertNotIn("Park et al.", self.ok("analyze", self.study("ties")).stdout)

    def test_the_same_in_any_locale(self):
        folder = self.study("three-by-three")
        for form in ("text", "json", "tsv"):
            seen = {self.ok("analyze", folder, "--format", form, env={"LC_ALL": locale}).stdout
                    for locale in ("C", "de_DE.UTF-8")}
            self.assertEqual(len(seen), 1)

    def test_bars_are_as_high_as_means_with_their_standard_errors(self):
        folder = self.study("simulated")
        self.ok("analyze", folder, "-o", "a.svg")
        picture, told = Svg(self.dir / "a.svg"), self.analysis(folder)["runs"]
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
        self.assertEqual(len(picture.all("across")), 4)
        self.assertEqual({"".join(e.itertext()) for e in picture.all("across")}, {"simulated"})
        self.ok("analyze", self.study("ties"), "-o", "b.svg")
        self.assertNotIn("simulated", (self.dir / "b.svg").read_text())

    def test_pictures_of_all_kinds_work_also_among_the_derivatives(self):
        folder = self.study("two-levels")
        for name, head in (("a.pdf", b"%PDF-"), ("a.png", b"\x89PNG"), ("a.svg", b"<?xml")):
            where = folder / "derivatives/tactor" / name
            self.ok("analyze", folder, "-o", where)
            self.assertTrue(where.read_bytes().startswith(head))
        # For any way to write that folder.
        shutil.rmtree(folder / "derivatives")
        self.ok("analyze", f"./{folder.name}/", "-o", folder / "derivatives/tactor/b.svg")
        shutil.rmtree(folder / "derivatives")
        self.ok("analyze", folder, "-o", f"{folder.name}/../{folder.name}/derivatives/tactor/b.svg")
        self.refused(2, "analyze", folder, "-o", self.dir / "nowhere/a.svg")
        self.refused(2, "analyze", folder, "-o", "a.jpg")


class Refusals(AnalyzeTest):
    def setUp(self):
        super().setUp()
        self.folder = self.study("constant")

    def says(self, *texts, args=()):
        for form in ("text", "json", "tsv"):
            result = self.refused(2, "analyze", self.folder, "--format", form, *args, says=texts)
            self.assertEqual(result.stdout, "")
        result = self.refused(2, "analyze", self.folder, "-o", "never.svg", *args)
        self.assertFalse((self.dir / "never.svg").exists())

    def line(self, number, column, value):
        """Changes a cell of the first participant's first table; lines count from 1."""
        path = self.folder / BEH
        text = path.read_text()
        lines = text.split("\n")
        cells = lines[number - 1].split("\t")
        cells[studies.COLUMNS.index(column)] = value
        lines[number - 1] = "\t".join(cells)
        path.write_text("\n".join(lines))
        return text

    def test_impossible_answers_and_names_are_refused(self):
        for column, value, why in (
                ("response", "3", "response is \"3\" (a whole number from 1 to 2)"), ("response", "n/a", "there is no response"),
                ("motion", "motion-9", 'motion "motion-9" is none of the run\'s (one of motion-1'),
                ("method_1", "brush", 'method_1 "brush" is none'), ("method_2", "n/a", "method_2 is missing"),
                ("trial", "2", "trial 2 counts twice"), ("trial", "0", "trial is \"0\""), ("trial", "n/a", "no trial"),
                ("attempt", "x", "attempt is"), ("void", "n/a", "void is missing"), ("void", "yes", "void is \"yes\""),
                ("response_time", "soon", "response_time is"), ("response_time", "nan", "response_time is")):
            with self.subTest(f"{column} {value}"):
                before = self.line(7, column, value)
                self.says(f"{BEH}:7: ", why)
                (self.folder / BEH).write_text(before)
        both = self.line(7, "method_1", "park2016")
        self.line(7, "method_2", "park2016")
        self.says(f"{BEH}:7: both stimuli are of one method")
        (self.folder / BEH).write_text(both)
        self.ok("analyze", self.folder)

    def test_impossible_ratings_are_refused(self):
        name = BEH.replace("taste", "marks")
        text = (self.folder / name).read_text()
        lines = text.split("\n")
        at = studies.COLUMNS.index
        for response, rating, why in (("6", "6", "response is \"6\" (a whole number from 1 to 5)"), ("2", "3", "response is 2 and rating 3"),
                                      ("n/a", "n/a", "there is no rating"), ("3.5", "3.5", "response is")):
            cells = lines[3].split("\t")
            cells[at("response")], cells[at("rating")] = response, rating
            (self.folder / name).write_text("\n".join([*lines[:3], "\t".join(cells), *lines[4:]]))
            self.says(f"{name}:4: {why}")
        (self.folder / name).write_text(text)

    def test_incomplete_tables_are_refused(self):
        text = (self.folder / BEH).read_text()
        for broken, why in ((text[:-20], ":41: the last line is cut off (tactor experiment --resume keeps what"), (text.replace("\t", " ", 1), ":2: it has"),
                            ("", ": it is empty"), (text.replace("void", "vo\x00id", 1), ":1:87: is binary"),
                            (text.replace("\tvoid", "\tmotion", 1), ":1: the column motion is there twice"),
                            (text.replace("\tvoid", "\tVoid", 1), ":1: there is no column void")):
            (self.folder / BEH).write_text(broken)
            self.says(f"{BEH}{why}")
        (self.folder / BEH).unlink()
        os.mkfifo(self.folder / BEH)
        self.says(f"{BEH}: it is no file")

    def test_impossible_participants_are_refused(self):
        people = self.folder / "participants.tsv"
        text = people.read_text()
        for extra, why in (("sub-../../etc\tn/a\tn/a\tn/a\n", "participants.tsv:8: this is no participant_id"),
                           ("07\tn/a\tn/a\tn/a\n", "participants.tsv:8: this is no participant_id"),
                           ("sub-01\tn/a\tn/a\tn/a\n", "participants.tsv:8: sub-01 is there twice")):
            people.write_text(text + extra)
            self.says(why)
        people.write_text("".join(line for line in text.splitlines(True) if "sub-04" not in line))
        self.says("sub-04: it is of nobody in participants.tsv")
        people.write_text(text)
        self.says('--participants: "Nobody" is not in participants.tsv (there are 01, 02', args=["--participants", "01,Nobody"])
        self.says("--exclude", "not in participants.tsv", args=["--exclude", "99"])
        self.says("nobody is left", args=["--exclude", "01,02,03,04,05,06"])
        self.says("a code is empty", args=["--participants", "01,,02"])

    def test_folders_that_are_no_study_are_refused(self):
        self.refused(2, "analyze", self.dir / "none")
        self.refused(2, "analyze", self.folder / "participants.tsv")
        self.refused(2, "analyze", self.dir)
        self.refused(2, "analyze")
        self.refused(2, "analyze", self.folder, "--format", "csv")
        shutil.rmtree(self.folder / "sourcedata")
        self.says("session.json: No such file")

    def test_impossible_sessions_are_refused(self):
        name = "sourcedata/sub-02/session.json"
        path = self.folder / name
        good = path.read_text()
        told = json.loads(good)
        text = told["experiment"]["text"]
        for broken, why in (
                ("{\n\"simulated\": tru", f"{name}:2: it is no JSON"), ("[]", f"{name}:1: it is no object"),
                ("[" * 100000, f"{name}:1: it is no JSON"), ("{}", "simulated: is missing"),
                (json.dumps(told | {"simulated": 1}), "simulated: is neither true nor false"),
                (json.dumps(told | {"experiment": "park2016"}), "experiment: is no object"),
                (json.dumps(told | {"experiment": {"text": text + "[[run"}}), "experiment.text:"),
                (json.dumps(told | {"experiment": {"text": text.replace("motion-4", "motion-5")}}),
                 "sub-01 and sub-02: their experiments differ"),
                (json.dumps(told | {"simulated": True}), "sub-01 and sub-02: one is simulated and one is not")):
            path.write_text(broken)
            self.says(why)
        path.write_text(json.dumps(told | {"experiment": {"text": text + "# changed\n"}}))
        self.assertIn("the texts of their experiments differ", self.ok("analyze", self.folder).stderr)
        path.write_text(good)

    def test_an_unreachable_participant_is_not_a_missing_one(self):
        # Like git-annex before fetching; a folder that was moved and linked; a file in place of a folder.
        beh = self.folder / "sub-02/beh"
        for name, target, why in ((beh / "sub-02_task-taste_beh.tsv", "../../.annex/none", "is a link to nothing"),
                                  (beh, "beh", "symbolic links"), (beh, "/nowhere", "is a link to nothing"),
                                  (self.folder / "sub-02", "sub-02", "symbolic links"),
                                  (self.folder / "sourcedata/sub-02/session.json", "none", "is a link to nothing"),
                                  (beh, None, "is no folder")):
            with self.subTest(f"{name} {why}"):
                name.rename(self.dir / "aside")
                if target:
                    name.symlink_to(target)
                else:
                    name.write_text("")
                self.says(str(name.relative_to(self.dir)), why)
                name.unlink()
                (self.dir / "aside").rename(name)
        self.ok("analyze", self.folder)

    def test_a_study_without_participants_is_refused(self):
        folder = self.dir / "nobody"
        folder.mkdir()
        (folder / "participants.tsv").write_text("participant_id\n")
        self.refused(2, "analyze", folder)

    def test_files_of_no_run_are_not_overlooked(self):
        self.folder.joinpath(BEH.replace("taste", "other")).write_text("trial\n")
        self.says("task-other_beh.tsv: it is of no run of the experiment")
        self.folder.joinpath(BEH.replace("taste", "other")).unlink()
        (self.folder / "sub-01/beh/.sub-01_task-other_beh.tsv").write_text("half")
        self.ok("analyze", self.folder)
        (self.folder / "task-taste_beh.json").write_text('{"TaskName": "marks"}')
        self.says('task-taste_beh.json: its TaskName is not "taste"')
        (self.folder / "task-taste_beh.json").unlink()
        self.ok("analyze", self.folder)

    def test_text_from_files_cannot_steer_a_terminal(self):
        self.line(7, "motion", "\x1b[2Jx")
        result = self.refused(2, "analyze", self.folder)
        self.assertNotIn("\x1b", result.stderr)


if __name__ == "__main__":
    main()
