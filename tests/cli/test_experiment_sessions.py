# SPDX-License-Identifier: MIT
"""Studies in which each participant has several sessions: their files, orders and numbers, and what is read of them."""
import collections
import csv
import io
import json
import re
import shutil

from experiments import COLUMNS, GROUPED, SMALL, ExperimentTest, contents, read_table
from harness import main

TASKS = ("whichone", "howgood", "what")


def several(text, n=2):
    return text.replace("gap_s = 0.25", f"gap_s = 0.25\nsessions = {n}")


class SessionTest(ExperimentTest):
    def setUp(self):
        super().setUp()
        self.write("two.toml", several(SMALL))

    def hold(self, code, session, *more, definition="two.toml", **other):
        return self.simulate(code, "--session", str(session), *more, definition=definition, **other)

    def dry(self, *args, definition="two.toml"):
        return json.loads(self.ok("experiment", definition, "--dry-run", "--format", "json", *args).stdout)


class Held(SessionTest):
    def test_each_session_has_files_of_its_own(self):
        self.hold("01", 1)
        self.hold("01", 2)
        files = contents(self.dir / "study")
        own = [f for n in (1, 2) for f in (f"sub-01/ses-{n}/sub-01_ses-{n}_scans.tsv", f"sourcedata/sub-01/ses-{n}/session.json",
                                           f"sourcedata/sub-01/ses-{n}/practice.tsv",
                                           *(f"sub-01/ses-{n}/beh/sub-01_ses-{n}_task-{t}_beh.tsv" for t in TASKS))]
        shared = ["README", "dataset_description.json", "participants.json", "participants.tsv", *(f"task-{t}_beh.json" for t in TASKS)]
        self.assertEqual(sorted(f for f in files if "/plans/" not in f), sorted(own + shared))
        self.assertEqual([p["participant_id"] for p in read_table(self.dir / "study/participants.tsv")], ["sub-01"])
        self.assertIn("sub-CODE/ses-N/beh", files["README"].decode())
        self.assertEqual(json.loads(files["task-what_beh.json"])["session"]["Description"], "Number of the session, from 1")
        for n in (1, 2):
            for scan in read_table(self.dir / f"study/sub-01/ses-{n}/sub-01_ses-{n}_scans.tsv"):
                rows = read_table(self.dir / f"study/sub-01/ses-{n}" / scan["filename"])
                self.assertEqual(sorted(rows[0]), sorted([*COLUMNS, "session"]))
                self.assertEqual({r["session"] for r in rows}, {str(n)})
            facts = json.loads(files[f"sourcedata/sub-01/ses-{n}/session.json"])
            self.assertEqual((facts["session"], facts["order"]), (n, [r["name"] for r in self.dry("--participant", f"0{n}", "--session", "1")["runs"]]))
            for stimulus in facts["stimuli"]:
                self.assertIn(f"sourcedata/sub-01/ses-{n}/plans/{stimulus['sha256']}.json", files)

    def test_a_run_belongs_to_some_sessions(self):
        text = several(SMALL, 3).replace('name = "how good"', 'name = "how good"\nsessions = [1, 3]')
        self.write("two.toml", text)
        for n in (1, 2, 3):
            self.hold("01", n)
            names = {r["name"] for r in self.dry("--participant", "01", "--session", str(n))["runs"]}
            self.assertEqual("how good" in names, n != 2)
            self.assertEqual((self.dir / f"study/sub-01/ses-{n}/beh/sub-01_ses-{n}_task-howgood_beh.tsv").exists(), n != 2)
        told = self.analysis()["runs"]
        self.assertEqual((told["how good"]["trials"], told["what"]["trials"]), (8, 9))
        self.assertIn("- Sessions that have the run: 1, 3\n", self.ok("report", "study").stdout)
        power = json.loads(self.ok("experiment", "two.toml", "--power", "2", "--studies", "2", "--simulate", "sigma=1", "--format", "json").stdout)
        by = {r["name"]: r["comparisons"][-1]["comparison"] for r in power["runs"] if r["comparisons"]}
        self.assertEqual((by["how good"], by["what"]), ("rating by session, 1 - 3, paired t against 0", "correct by session, analysis of variance (p_gg)"))
        # A table of a session that does not have the run is not silently left out.
        table = self.dir / "study/sub-01/ses-2/beh/sub-01_ses-2_task-howgood_beh.tsv"
        table.write_bytes((self.dir / "study/sub-01/ses-1/beh/sub-01_ses-1_task-howgood_beh.tsv").read_bytes())
        self.refused(2, "analyze", "study", says=[f"{table.relative_to(self.dir)}: the experiment has no such run in this session"])
        for wrong, why in (("[4]", "sessions is 4"), ("[0]", "sessions is 0"), ("[1, 1]", "session 1 occurs twice"), ("[]", "no session has the run"), ("[1.5]", "1.5 is not")):
            self.write("wrong.toml", text.replace("sessions = [1, 3]", f"sessions = {wrong}"))
            self.refused(2, "experiment", "wrong.toml", "--dry-run", "--session", "1", says=[why])
        self.write("wrong.toml", re.sub(r'(?m)^(task = .*)$', r"\1\nsessions = [1]", several(SMALL)))
        self.refused(2, "experiment", "wrong.toml", "--dry-run", "--session", "2", says=["session 2 has no run"])

    def test_orders_trials_and_answers_are_drawn_anew(self):
        self.hold("01", 1)
        self.hold("01", 2)
        first, second = ([read_table(self.dir / f"study/sub-01/ses-{n}/beh/sub-01_ses-{n}_task-{t}_beh.tsv") for t in TASKS] for n in (1, 2))
        for column in ("motion", "response_time"):
            self.assertNotEqual([[r[column] for r in rows] for rows in first], [[r[column] for r in rows] for rows in second])
        self.assertEqual([self.dry("--participant", "05", "--session", n)[k] for n in ("1", "2") for k in ("session", "order_row")], [1, 5, 2, 6])
        self.assertEqual([self.dry("--participant", "06", "--session", "2", *more)["order_row"] for more in ((), ("--order", "4"))], [1, 4])
        self.assertIn("participant 01, session 2 of 2, row 2 of 6,", self.ok("experiment", "two.toml", "--dry-run", "--session", "2").stdout)
        # The first session of a study of one session is drawn from other numbers.
        one = self.dry(definition=self.small())
        self.assertNotIn("session", one)
        self.assertNotEqual(one["runs"], self.dry("--session", "1")["runs"])

    def test_a_session_that_was_broken_off_goes_on(self):
        self.hold("01", 1)
        self.hold("01", 2, spec="seed=2,void=0.3")
        whole = contents(self.dir / "study")
        session = self.dir / "study/sub-01/ses-2"
        names = [s["filename"] for s in read_table(session / "sub-01_ses-2_scans.tsv")]
        self.assertIn("whichone", names[2])
        self.forget_last_run("study/sub-01/ses-2/sub-01_ses-2_scans.tsv")
        (self.dir / "study/sourcedata/sub-01/ses-2/practice.tsv").unlink()
        (session / names[1]).write_bytes((session / names[1]).read_bytes()[:-90])
        self.hold("01", 2, status=2, says=("--participant: there is already session 2 of 01",))
        self.hold("01", 2, "--resume", spec="seed=2,void=0.3")
        self.assertEqual(self.without_cut(), whole)
        self.assertIn("sub-01_ses-2: SIMULATED, no person answered: the session is finished",
                      self.hold("01", 2, "--resume", spec="seed=2,void=0.3").stdout)
        self.assertEqual(self.without_cut(), whole)

    def test_wrong_numbers_are_refused(self):
        self.small()
        for definition, number in (("two.toml", None), ("two.toml", "3"), ("small.toml", "1"), ("two.toml", "0"), ("two.toml", "1.5")):
            self.refused(2, "experiment", definition, "--dry-run", *(() if number is None else ("--session", number)))
        self.refused(2, "experiment", "two.toml", "--power", "4", "--simulate", "seed=1", "--session", "1")
        for n in (0, 100):
            self.write("many.toml", several(SMALL, n))
            self.refused(2, "experiment", "many.toml", "--dry-run", "--session", "1")
        self.hold("01", 1)
        self.simulate("02", definition="small.toml", status=2, says=("sub-01_ses-1 was run with a different experiment: the number of sessions changed from 2 to 1",))
        self.assertIn("study: the folder has no sub-02_ses-1", self.hold("02", 2).stderr)
        self.assertNotIn("not here", self.hold("01", 2).stderr)

    def test_a_participant_stays_in_one_group(self):
        self.write("grouped.toml", several(GROUPED))
        self.hold("01", 1, "--group", "palm", definition="grouped.toml")
        self.hold("01", 2, "--group", "arm", definition="grouped.toml", status=2, says=('sub-01_ses-1 was in group "palm", but this session is in group "arm"',))
        self.hold("01", 2, "--group", "palm", definition="grouped.toml")
        self.edit("study/sourcedata/sub-01/ses-2/session.json", '"group": "palm"', '"group": "arm"')
        self.refused(2, "analyze", "study")


class Read(SessionTest):
    def setUp(self):
        super().setUp()
        for code, n in (("01", 1), ("01", 2), ("02", 1), ("02", 2), ("03", 2)):
            self.hold(code, n)

    def test_trials_of_all_sessions_are_analysed_together(self):
        told = self.analysis()
        self.assertEqual([w for w in told["warnings"] if "sub-" in w], ["sub-03 has no session 1"])
        self.assertEqual((told["participants"], told["runs"]["how good"]["n"]), (3, 3))
        wide = list(csv.DictReader(io.StringIO(self.ok("analyze", "study", "--format", "wide").stdout)))
        for person, sessions in zip(wide, ((1, 2), (1, 2), (2,))):
            code = person["participant_id"]
            cells = collections.defaultdict(list)
            for n in sessions:
                for r in read_table(self.dir / f"study/{code}/ses-{n}/beh/{code}_ses-{n}_task-howgood_beh.tsv"):
                    cells[f"how_good.{r['method_1']}.{r['motion'].replace(' ', '_')}"].append(int(r["rating"]))
            self.assertEqual({c: float(person[c]) for c in cells}, {c: sum(v) / len(v) for c, v in cells.items()})
        names = [f"how_good.{method}.{motion}" for method in ("brush", "park") for motion in ("to_the_right", "down")]
        self.assertEqual([c for c in wide[0] if c.startswith("how_good")], [*names, *(f"{c}.ses_{n}" for n in (1, 2) for c in names)])
        self.assertEqual({c: wide[2][c] for c in cells}, {c: wide[2][f"{c}.ses_2"] for c in cells})
        self.assertEqual({wide[2][f"{c}.ses_1"] for c in cells}, {""})
        self.assertNotIn(".ses_", self.ok("analyze", "study", "--participants", "03", "--format", "wide").stdout)
        lines, rows = self.trials()
        self.assertIn('# lmer(rating ~ method * (motion * factor(session)) + (1 + method + factor(session) | participant), data = subset(d, run == "how good"))', lines)
        self.assertIn("# lmer(rating ~ method * motion + (1 + method | participant), ",  # no trials of another session
                      self.ok("analyze", "study", "--participants", "03", "--format", "tsv").stdout)
        self.assertEqual(list(rows[0])[:3], ["participant", "session", "run"])
        self.assertEqual(collections.Counter((r["participant"], r["session"]) for r in rows), {(c, s): 11 for c, s in (("01", "1"), ("01", "2"), ("02", "1"), ("02", "2"), ("03", "2"))})

    def test_long_names_of_columns_keep_the_session(self):
        self.write("long.toml", several(SMALL.replace('"how good"', f'"{"r" * 30}"').replace('"to the right"', f'"{"m" * 30}"')))
        for n in (1, 2):
            self.hold("01", n, definition="long.toml", folder="long")
        columns = self.ok("analyze", "long", "--format", "wide").stdout.splitlines()[0].split(",")
        self.assertLessEqual(max(map(len, columns)), 64)
        self.assertIn(f"{'r' * 14}.brush.{'m' * 14}.ses_2", columns)

    def test_the_first_study_of_power_has_all_sessions(self):
        told = json.loads(self.ok("experiment", "two.toml", "--power", "2", "--studies", "1", "--simulate", "seed=1,sigma=1", "--format", "json").stdout)
        runs = self.analysis("--participants", "01,02")["runs"]
        for run in told["runs"]:
            own = runs[run["name"]]
            test = {"choose": lambda: own["preference"]["all"], "rate": lambda: own["paired"], "identify": lambda: own["correct"]["park"]["all"]}[run["task"]]()
            self.assertEqual((run["power"][0]["untested"], run["power"][0]["significant"]), (int(test["p"] is None), int((test["p"] or 1) < 0.05)))

    def test_the_report_states_sessions_and_the_time_between_them(self):
        text = self.ok("report", "study").stdout
        self.assertIn("Sessions of each participant: 2; from the start of one to the start of the next: not recorded.", text)
        self.assertIn('SHA-256 of "seed/experiment/code/ses-N/run"', text)
        for name in ("01_ses-1", "01_ses-2", "03_ses-2"):
            self.assertIn(f"| sub-{name} | 4 / 0 / 0 | 4 / 0 / 0 | 3 / 0 / 0 |".replace("_", r"\_"), text)
        for code, n, day in (("01", 1, "03"), ("01", 2, "10"), ("02", 1, "04"), ("02", 2, "05"), ("03", 2, "30")):
            self.edit(f"study/sourcedata/sub-{code}/ses-{n}/session.json", '"date": null', f'"date": "2026-11-{day}T09:00:00.000000Z"')
        self.assertIn("to the start of the next: 1 to 7 days.", self.ok("report", "study").stdout)

    def test_what_does_not_fit_the_sessions_is_refused(self):
        study = self.dir / "study"
        shutil.copytree(study, self.dir / "kept")
        table = "sub-01/ses-2/beh/sub-01_ses-2_task-what_beh.tsv"
        cases = (lambda: self.edit(f"study/{table}", "\t2\t1\t2\t", "\t1\t1\t2\t"),  # a trial that counts twice within a session
                 lambda: shutil.copytree(study / "sourcedata/sub-01/ses-2", study / "sourcedata/sub-01/ses-3"),
                 lambda: (study / "sourcedata/sub-01/ses-2/session.json").rename(study / "sourcedata/sub-01/session.json"),
                 lambda: (study / table).rename((study / table).with_name("sub-01_ses-1_task-what_beh.tsv")),
                 lambda: (study / "sub-01/ses-2").rename(study / "sub-01/ses-02"))
        for change in cases:
            change()
            for command in ("analyze", "report"):
                self.refused(2, command, "study")
            shutil.rmtree(study)
            shutil.copytree(self.dir / "kept", study)
        self.ok("analyze", "study")


if __name__ == "__main__":
    main()
