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


class Figures(AnalyzeTest):
    def test_every_figure_matches_r_and_nothing_else_is_printed(self):
        known = {"method", "task", "trials", "early", "left_out", "a", "b", "participant", "why"}
        for name in studies.STUDIES:
            golden = check_r.read((check_r.GOLDEN / f"{name}.tsv").read_text(encoding="utf-8"))
            self.assertGreater(len(golden), 100)
            told = self.analysis(self.study(name))
            self.assertEqual(list(check_r.differences(golden, told)), [], name)
            places = {p for p, _ in check_r.flat(told) if p.startswith("runs.")}
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
        said = self.ok("analyze", "missing")
        self.assertIn("marks: sub-E5 is left out: no trial that counts in some of the cells", said.stderr)
        self.assertIn("taste: choose, 6 participants", said.stdout)
        self.assertEqual(sorted(told["warnings"]),
                         sorted(line.removeprefix("tactor: warning: ") for line in said.stderr.splitlines()))

    def test_missing_figures_are_null_with_warnings_and_one_line_on_the_terminal(self):
        told = self.analysis(self.study("constant"))
        self.assertIsNone(told["runs"]["taste"]["preference"]["motion"]["motion-3"]["p_holm"])
        self.assertIn("taste: motion-3: no variance over participants, so no t test", told["warnings"])
        self.assertIn("marks: park2016, motion-1: no variance over participants, so no interval", told["warnings"])
        text = studies.definition("same", studies.FOUR, studies.TWO, [studies.run("marks", "rate", 8)])
        studies.write_study(self.dir / "same", text, ["1", "2"], lambda *_: 3)
        told = self.analysis("same")
        self.assertEqual({told["runs"]["marks"]["anova"]["motion"][k] for k in ("F", "p", "epsilon_gg", "mauchly_w", "eta2_partial")}, {None})
        self.assertEqual({p["p"] for p in told["runs"]["marks"]["tukey"]["park2016"]}, {None})
        self.assertIn("marks: methods: no variance over participants, so no t test", told["warnings"])
        said = self.ok("analyze", "same")
        self.assertEqual(said.stderr, f"tactor: warning: {told['warnings'][0]} ({len(told['warnings']) - 1} more warnings: --format json)\n")
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


class Forms(AnalyzeTest):
    def test_no_printed_interval_is_beyond_a_per_cent_or_a_scale(self):
        beyond = 0
        for name in ("simulated", "few", "ties", "three-by-three"):
            text = self.ok("analyze", self.study(name)).stdout
            beyond += sum(v < 0 or v > 100 for p, v in check_r.flat(self.analysis(name)["runs"]) if v is not None
                          and re.search(r"\.(preference|correct)\..*\.ci\.[01]$", p))
            shown = re.findall(r"^  \S.*? +[\d.]+ +[\d.]+ +(-?[\d.]+) \.\.\. (-?[\d.]+) ", text, re.M)
            self.assertTrue(all(0 <= float(low) <= float(high) <= 100 for low, high in shown), shown)
            self.assertEqual(bool(shown), "Columns: mean and se" in text, name)
            rated = re.findall(r" all \S+ \(\S+\), 95 % (-?[\d.]+) \.\.\. (-?[\d.]+)$", text, re.M)
            self.assertTrue(all(float(low) >= 1 for low, _ in rated), rated)
            shown = re.findall(r"^\| \S.*? \| [\d.]+ \| [\d.]* \| (-?[\d.]+) to (-?[\d.]+) \|", self.ok("report", name).stdout, re.M)
            self.assertTrue(shown and all(0 <= float(low) <= float(high) <= 100 for low, high in shown), shown)
        self.assertGreater(beyond, 0)  # else nothing was tried

    def test_each_trial_that_counts_has_a_line(self):
        text = self.ok("analyze", self.study("simulated"), "--format", "tsv").stdout
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
        text = self.ok("analyze", self.study("simulated")).stdout
        self.assertLessEqual(max(map(len, text.splitlines())), 80)
        self.assertIn("SIMULATED", text.splitlines()[0])
        self.assertIn("144 trials void, not counted", text)
        every = " ".join(text.split())
        self.assertIn("13.23^2 is 175.0, not 40.66", every)
        told = self.analysis("simulated")["runs"]
        self.assertIn(f"{told['similarity']['preference']['all']['mean']:.2f}", text)
        for run in told.values():
            for effect, found in run.get("anova", {}).items():
                if found["F"] is not None:
                    self.assertRegex(every, rf"\b{effect}: F\([0-9, ]+\) = {found['F']:.2f}")
        for form in ("text", "json", "tsv"):
            self.assertEqual(*(self.ok("analyze", "simulated", "--format", form, env={"LC_ALL": locale}).stdout
                               for locale in ("C", "de_DE.UTF-8")))
        self.assertNotIn("Park et al.", self.ok("analyze", self.study("ties")).stdout)

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

    def says(self, *texts, args=("-o", "never.svg")):
        with self.subTest(texts):
            self.assertEqual(self.refused(2, "analyze", self.folder, *args, says=texts).stdout, "")
            self.assertFalse((self.dir / "never.svg").exists())

    def changed(self, name, text, *says):
        """Analyses the study with another text of a file; it must be refused."""
        file = self.folder / name
        before = file.read_bytes()
        file.write_text(text)
        self.says(*says)
        file.write_bytes(before)

    def cells(self, name, line, **values):
        """Returns a table with other values in a line; lines count from 1."""
        lines = (self.folder / name).read_text().split("\n")
        cells = lines[line - 1].split("\t")
        for column, value in values.items():
            cells[studies.COLUMNS.index(column)] = value
        return "\n".join([*lines[:line - 1], "\t".join(cells), *lines[line:]])

    def test_impossible_answers_and_names_are_refused(self):
        for why, values in (
                ("response is \"3\" (a whole number from 1 to 2)", {"response": "3"}), ("there is no response", {"response": "n/a"}),
                ('motion "motion-9" is none of the run\'s (one of motion-1', {"motion": "motion-9"}),
                ('method_1 "brush" is none', {"method_1": "brush"}), ("method_2 is missing", {"method_2": "n/a"}),
                ("both stimuli are of one method", {"method_1": "park2016", "method_2": "park2016"}),
                ("trial 2 counts twice", {"trial": "2"}), ("trial is \"0\"", {"trial": "0"}), ("no trial", {"trial": "n/a"}),
                ("attempt is", {"attempt": "x"}), ("void is missing", {"void": "n/a"}), ("void is \"yes\"", {"void": "yes"}),
                ("response_time is", {"response_time": "soon"}), ("response_time is", {"response_time": "nan"}),
                ('motion "\\x1b[2Jx" is none', {"motion": "\x1b[2Jx"})):  # which steers no terminal
            self.changed(BEH, self.cells(BEH, 7, **values), f"{BEH}:7: ", why)
        name = BEH.replace("taste", "marks")
        for why, response, rating in (("response is \"6\" (a whole number from 1 to 5)", "6", "6"), ("response is 2 and rating 3", "2", "3"),
                                      ("there is no rating", "n/a", "n/a"), ("response is", "3.5", "3.5")):
            self.changed(name, self.cells(name, 4, response=response, rating=rating), f"{name}:4: {why}")
        self.ok("analyze", self.folder)

    def test_incomplete_tables_are_refused(self):
        text = (self.folder / BEH).read_text()
        for broken, why in ((text[:-20], ":41: the last line is cut off (tactor experiment --resume keeps what"), (text.replace("\t", " ", 1), ":2: it has"),
                            ("", ": it is empty"), (text.replace("void", "vo\x00id", 1), ":1:87: is binary"),
                            (text.replace("\tvoid", "\tmotion", 1), ":1: the column motion is there twice"),
                            (text.replace("\tvoid", "\tVoid", 1), ":1: there is no column void")):
            self.changed(BEH, broken, f"{BEH}{why}")
        (self.folder / BEH).unlink()
        os.mkfifo(self.folder / BEH)
        for form in ("text", "json", "tsv"):
            self.says(f"{BEH}: it is no file", args=("--format", form))

    def test_impossible_participants_are_refused(self):
        people = (self.folder / "participants.tsv").read_text()
        for text, why in ((people + "sub-../../etc\tn/a\tn/a\tn/a\n", "participants.tsv:8: this is no participant_id"),
                          (people + "07\tn/a\tn/a\tn/a\n", "participants.tsv:8: this is no participant_id"),
                          (people + "sub-01\tn/a\tn/a\tn/a\n", "participants.tsv:8: sub-01 is there twice"),
                          ("participant_id\n", "participants.tsv: nobody is in it"),
                          (re.sub("sub-04.*\n", "", people), "sub-04: it is of nobody in participants.tsv")):
            self.changed("participants.tsv", text, why)
        for args, why in ((("--participants", "01,Nobody"), '--participants: "Nobody" is not in participants.tsv (there are 01, 02'),
                          (("--exclude", "99"), "--exclude"), (("--exclude", "01,02,03,04,05,06"), "nobody is left"),
                          (("--participants", "01,,02"), "a code is empty")):
            self.says(why, args=args)

    def test_folders_that_are_no_study_are_refused(self):
        for args in ((self.dir / "none",), (self.folder / "participants.tsv",), (self.dir,), (), (self.folder, "--format", "csv")):
            self.refused(2, "analyze", *args)
        shutil.rmtree(self.folder / "sourcedata")
        self.says("session.json: No such file")

    def test_impossible_sessions_are_refused(self):
        name = "sourcedata/sub-02/session.json"
        told = json.loads((self.folder / name).read_text())
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
            self.changed(name, broken, why)
        (self.folder / name).write_text(json.dumps(told | {"experiment": {"text": text + "# changed\n"}}))
        self.assertIn("the texts of their experiments differ", self.ok("analyze", self.folder).stderr)

    def test_an_unreachable_participant_is_not_a_missing_one(self):
        # Like git-annex before fetching; a folder that was moved and linked; a file in place of a folder.
        beh = self.folder / "sub-02/beh"
        for name, target, why in ((beh / "sub-02_task-taste_beh.tsv", "../../.annex/none", "is a link to nothing"),
                                  (beh, "beh", "symbolic links"), (beh, "/nowhere", "is a link to nothing"),
                                  (self.folder / "sub-02", "sub-02", "symbolic links"),
                                  (self.folder / "sourcedata/sub-02/session.json", "none", "is a link to nothing"),
                                  (beh, None, "is no folder")):
            name.rename(self.dir / "aside")
            if target:
                name.symlink_to(target)
            else:
                name.write_text("")
            self.says(str(name.relative_to(self.dir)), why)
            name.unlink()
            (self.dir / "aside").rename(name)
        self.ok("analyze", self.folder)

    def test_files_of_no_run_are_not_overlooked(self):
        other = self.folder / BEH.replace("taste", "other")
        other.write_text("trial\n")
        self.says("task-other_beh.tsv: it is of no run of the experiment")
        other.rename(other.with_name(f".{other.name}"))
        self.ok("analyze", self.folder)


if __name__ == "__main__":
    main()
