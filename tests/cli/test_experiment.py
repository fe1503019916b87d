# SPDX-License-Identifier: MIT
"""tactor experiment: the definition, the dry run, simulated sessions, the folder that they write, and --power."""
import collections
import csv
import fcntl
import hashlib
import io
import json
import math
import os
import pathlib
import re
import shutil
import signal
import subprocess
import unittest

from experiments import COLUMNS, SMALL, ExperimentTest, contents, read_table
from harness import PATIENCE_S, ROOT, TOOL, main, wav_bytes
from studies import toml

FORM = (toml("run", "about", task="questionnaire", when="before", title="About you") + toml("run.item", "hand", question="Hand?", kind="choice", choices=["left", "right"])
        + toml("run.item", "years", question="Years?", kind="number", range=[0, 99])
        + toml("run.item", "tired", question="Tired?", kind="scale", scale=9, labels=["no", "yes"]))


class Definition(ExperimentTest):
    def test_the_shipped_definition_is_printed_and_can_be_used(self):
        text = self.ok("experiment", "park2016", "--print").stdout
        self.assertEqual(text, (ROOT / "examples/experiments/park2016.toml").read_text(encoding="utf-8"))
        self.write("mine.toml", text)
        self.assertEqual(self.ok("experiment", "mine.toml", "--dry-run", "--format", "json").stdout,
                         self.ok("experiment", "park2016", "--dry-run", "--format", "json").stdout)

    def test_faults_have_file_and_line_hints_name_keys_and_nothing_is_written(self):
        for old, new in (("gap_s = 0.25", "gaps_s = 0.25"), ("gap_s = 0.25", "rest_s = 61"), ("gap_s = 0.25", "level = { sl_db = 50 }"),
                         ('path = "M0 20H40"', 'path = "M0 20H90"'), ('path = "M0 20H40"', 'path = "M3 17H40"'),
                         ("duration = 0.7", "duration = 0.01"), ('name = "how good"', 'name = "Which One"')):
            self.small(SMALL.replace(old, new, 1))
            for more in (("--dry-run",), ("--participant", "01", "-o", "study", "--simulate", "seed=1")):
                self.assertEqual(self.refused(2, "experiment", "small.toml", *more).stdout, "")
            self.assertFalse((self.dir / "study").exists())

    def test_wrong_options_are_refused(self):
        self.small()
        for args in ("", "--participant 01", "--participant P-1", "--participant=", "--display tv", "--seed 1.5", "--simulate sigma=x",
                     "--dry-run --order 0", "--dry-run --order 7", "--dry-run --group palm", "--format xml", "--simulate seed=1 --power 4 --check-noise --masker null", "--simulate seed=1 --power 4 --display page",
                     "--simulate seed=1 --participant 01 -o study --format json", "--simulate seed=1 --dry-run -o study --resume"):
            self.refused(2, "experiment", "small.toml", *args.split())
        for name in ("park2061", "none.toml"):
            self.refused(2, "experiment", name, "--dry-run")
        self.refused(2, "experiment", "park2016", "--participant", "01", "-o", "study", "-D", "null")  # needs measured thresholds
        self.assertFalse((self.dir / "study").exists())

    def test_strokes_that_a_limit_would_change_are_refused_before_the_session(self):
        long = SMALL.replace("gap_s = 0.25", "level = { dbfs = -18 }", 1).replace('path = "M0 20H40"\nduration = 0.7',
                                                                                   'path = "M0 20H2"\nduration = 6', 1)
        self.small(long.replace('algorithm = "tactile-brush"', 'algorithm = "continuous"', 1))
        for more in (("--dry-run",), ("--participant", "01", "-o", "study", "--simulate", "seed=1"),
                     ("--participant", "01", "-o", "study", "-D", "null")):
            self.refused(2, "experiment", "small.toml", *more)
        self.assertFalse((self.dir / "study").exists())
        palm = '[array]\npreset = "palm-3x3"\n'
        self.write("more.toml", palm + "[limits]\nmax_drive_s = 10\n")
        self.write("weak.toml", palm + "[limits]\npower_dbfs = -30\n")
        self.ok("experiment", "small.toml", "--dry-run", "--array", "more.toml")
        self.small(long.replace("duration = 6", "duration = 0.7", 1))
        self.ok("experiment", "small.toml", "--dry-run")
        self.refused(2, "experiment", "small.toml", "--dry-run", "--array", "weak.toml")

    def test_simulated_thresholds_are_reported(self):
        self.ok("calibrate", "--participant", "01", "-o", "felt.toml", "--simulate", "threshold=-45")
        self.assertIn("thresholds are simulated",
                      self.ok("experiment", "park2016", "--dry-run", "--array", "felt.toml").stderr)
        # The preset is the configuration's array, which has the same places.
        self.assertIn("thresholds are simulated", self.ok("experiment", "park2016", "--dry-run", "--config", "felt.toml").stderr)


class DryRun(ExperimentTest):
    def dry(self, *more):
        result = self.ok("experiment", *more, "--dry-run", "--format", "json")
        return json.loads(result.stdout), result.stderr

    def test_the_shipped_definition_has_all_its_trials_and_waits_only_where_needed(self):
        told, warned = self.dry("park2016", "--participant", "02")
        self.assertEqual([r["name"] for r in told["runs"]],
                         ["uniformity", "similarity-rating", "similarity", "uniformity-rating"])
        for run in told["runs"]:
            self.assertEqual([t["trial"] for t in run["trials"]], list(range(1, 41)))
            self.assertEqual({t["method_2"] is None for t in run["trials"]}, {run["task"] == "rate"})
        self.assertIn("-40 dBFS", warned)
        self.assertTrue(told["thresholds_assumed"])
        trials = sum(len(r["practice"]) + len(r["trials"]) for r in told["runs"])
        self.assertLess(sum(r["waits"] for r in told["runs"]), trials / 20)

    def test_a_session_gets_the_listed_trials(self):
        told, _ = self.dry(self.small(), "--participant", "P3", "--seed", "8")
        self.simulate("P3", "--seed", "8")
        for run in told["runs"]:
            rows = self.rows("P3", run["file_name"])
            for row, trial in zip(rows, run["trials"], strict=True):
                for key in ("trial", "motion", "method_1", "method_2", "plan_1", "plan_2"):
                    self.assertEqual(row[key], "n/a" if trial[key] is None else str(trial[key]))
                self.assertAlmostEqual(float(row["duration"]), trial["duration_s"], 6)

    def test_a_stimulus_whose_bursts_add_up_is_weakened_by_itself(self):
        # Bursts of the Tactile Brush that follow each other share a tactor here: two halves of the energy, both 0.707, make 1.414.
        small = self.small(SMALL.replace("gap_s = 0.25", "gap_s = 0.25\nlevel = { dbfs = -20 }").replace("M20 0V40", "M10 0L40 30")
                           .replace('algorithm = "tactile-brush"', 'algorithm = "tactile-brush"\noverlap = "sum"'))
        weaker = {(s["motion"], s["method"]): s["weakened_db"] for s in self.dry(small)[0]["stimuli"]}
        self.assertEqual([weaker["to the right", "brush"], weaker["to the right", "park"], weaker["down", "park"]], [0, 0, 0])
        self.assertAlmostEqual(weaker["down", "brush"], -20 * math.log10(2 ** 0.5), 2)
        self.assertIn("motion down with method brush: weakened by 3.01 dB", self.ok("experiment", small, "--dry-run").stdout)
        self.simulate(definition=small)
        self.assertEqual({(s["motion"], s["method"]): s["weakened_db"] for s in self.session()["stimuli"]}, weaker)
        self.assertIn("down with brush: 3.01 dB weaker than the level, so that no tactor exceeds it", self.ok("report", "study").stdout)

    def test_random_rests_are_listed_and_recorded(self):
        told, _ = self.dry(self.small(SMALL.replace("gap_s = 0.25", "gap_s = 0.25\nrest_s = [2, 4]")), "--participant", "01")
        self.assertEqual(told["rest_s"], [2, 4])
        rests = {r["name"]: [t["rest_s"] for t in r["trials"]] for r in told["runs"]}
        self.assertTrue(all(2 <= t <= 4 for r in rests.values() for t in r))
        self.simulate("01", definition="small.toml")
        self.assertEqual(self.session()["rests_s"], rests)
        self.simulate("01", "--resume", definition="small.toml")
        self.assertIn("Rest before each trial: 2 to 4 s, drawn for each trial.", self.ok("report", "study").stdout)

    def test_times_count_leads_animations_and_rests(self):
        small = self.small(SMALL.replace("gap_s = 0.25", "gap_s = 0.25\nrest_s = 6"))
        told, _ = self.dry(small)
        self.assertEqual(told["rest_s"], 6)
        for run in told["runs"]:
            trials = run["practice"] + run["trials"]
            shown = 0.7 if run["animation"] else 0
            self.assertAlmostEqual(run["duration_s"], sum(6 + shown + 0.5 + t["duration_s"] for t in trials), 4)
            self.assertEqual((run["waits"], run["waits_s"]), (0, 0))
        text = self.ok("experiment", small, "--dry-run").stdout
        self.assertEqual(len(re.findall(r"^ +\d+  ", text, re.M)), sum(len(r["trials"]) for r in told["runs"]))
        self.assertEqual(len(re.findall(r"^practice  ", text, re.M)), 1)

    def test_times_count_the_waits_for_max_drive_s(self):
        text = SMALL.replace("trials = 4", "trials = 40").replace("duration = 0.7", "duration = 1.6")
        self.write("tired.toml", "[limits]\nmax_drive_s = 4.0\nwindow_s = 20.0\n")
        told, _ = self.dry(self.small(text), "--config", "tired.toml")
        rested, _ = self.dry(self.small(text.replace("gap_s = 0.25", "gap_s = 0.25\nrest_s = 30")), "--config", "tired.toml")
        for run, other in zip(told["runs"], rested["runs"]):
            trials = run["practice"] + run["trials"]
            shown = 1.6 if run["animation"] else 0
            played = sum(shown + 0.5 + t["duration_s"] for t in trials)
            self.assertAlmostEqual(run["duration_s"], played + run["waits_s"], 3)
            if len(trials) > 30:
                self.assertGreater(run["waits"], 10)
            self.assertEqual(other["waits"], 0)
        said = self.ok("experiment", "small.toml", "--dry-run", "--config", "tired.toml").stdout
        self.assertIn("s without the answers", said)

    def test_codes_that_differ_in_capitals_only_are_one_on_some_disks(self):
        self.simulate("p1")
        before = contents(self.dir / "study")
        for more in ((), ("--resume",)):
            self.simulate("P1", *more, status=2)
        self.assertEqual(contents(self.dir / "study"), before)
        self.simulate("p2")

    def test_the_seed_is_the_option_s_or_the_definition_s_or_the_code_s(self):
        small = self.small()
        self.assertEqual(self.dry(small), self.dry(small, "--participant", "01"))
        self.assertEqual(self.dry(small, "--participant", "abc")[0]["seed"], 0xba7816bf)
        self.small(SMALL.replace("gap_s = 0.25", "gap_s = 0.25\nseed = 77"))
        self.assertEqual(self.dry("small.toml", "--participant", "abc")[0]["seed"], 77)
        self.assertEqual(self.dry("small.toml", "--seed", "5")[0]["seed"], 5)

    def felt(self, name, thresholds, extra=""):
        self.write(name, '[array]\nname = "felt"\ngrid = { rows = 3, columns = 3, pitch_mm = 20.0 }\n' + "".join(
            f"[[tactor]]\ntactor = {i}\nthreshold_dbfs = {t}\n{extra if i == 8 else ''}" for i, t in enumerate(thresholds)))
        return name

    def test_a_plan_is_what_tactor_plan_prints(self):
        felt = self.felt("felt.toml", [-40 - i for i in range(9)])
        told, warned = self.dry("park2016", "--array", felt)
        self.assertFalse(told["thresholds_assumed"])
        self.assertNotIn("-40 dBFS", warned)
        for motion in (1, 3):
            plan = self.ok("plan", f"park2016-{motion}", "--algorithm", "park2016", "--sl", 7, "--array", felt,
                           "--format", "json").stdout
            self.assertIn({"sha256": hashlib.sha256(plan.encode()).hexdigest(), "motion": f"motion-{motion}",
                           "method": "park2016", "weakened_db": 0.0}, told["stimuli"])

    def test_a_method_has_the_options_that_tactor_plan_and_render_have(self):
        felt = self.felt("felt.toml", [-40 - i for i in range(9)])
        self.write("grain.wav", wav_bytes([0.5, 0.5, -0.5, -0.5] * 20))
        motion, again = ("--path", "M0 20H40", "--duration"), ("--path", "M 40 0 V 40", "--speed", "40")
        methods = {
            "rough": ('waveform = "square"\nam = "30:0.5"\nenvelope = "linear"\nattack_s = 0.01\nphase = "burst"\nlevel_dbfs = -20\nsoa = 0.06\n',
                      (*motion, "0.7", *"--waveform square --am 30:0.5 --envelope linear --attack 0.01 --phase burst --level-dbfs -20 --soa 0.06".split())),
            "grain": ('waveform = "grain.wav"\ntexture = "time"\nsl_db = 10\nduration = 1.2\n',
                      (*motion, "1.2", *"--waveform grain.wav --texture time --sl 10".split())),
            "moved": ('compensate = "low-speed"\nsigma_mm = 4\ncarrier_hz = 200\n',
                      (*motion, "0.7", *"--compensate low-speed --sigma-mm 4 --carrier 200 --sl 7".split())),
            "other": ('path = "M 40 0 V 40"\nspeed = 40\nramp = 0.01\n', (*again, *"--ramp 0.01 --sl 7".split()))}
        text = ('[experiment]\nname = "any"\n[[motion]]\nname = "east"\npath = "M0 20H40"\nduration = 0.7\n' +
                "".join(f'[[method]]\nname = "{name}"\n{keys}' for name, (keys, _) in methods.items()) +
                '[[run]]\nname = "how"\ntask = "rate"\nattribute = "similarity"\ntrials = 4\n')
        told, _ = self.dry(self.small(text), "--array", felt)
        plans = {s["method"]: s["sha256"] for s in told["stimuli"]}
        self.simulate("01", "--array", felt, definition="small.toml")
        for name, (_, args) in methods.items():
            plan = self.ok("plan", *args, "--array", felt, "--format", "json").stdout
            self.assertEqual(hashlib.sha256(plan.encode()).hexdigest(), plans[name], name)
            self.ok("render", *args, "--array", felt, "-o", "stroke.wav")
            self.ok("render", f"study/sourcedata/sub-01/plans/{plans[name]}.json", "-o", "stimulus.wav")
            self.assertEqual((self.dir / "stroke.wav").read_bytes(), (self.dir / "stimulus.wav").read_bytes(), name)
        levels = {s["method"]: s.get("level") for s in told["stimuli"]}
        self.assertEqual(levels, {"rough": {"sl_db": None, "dbfs": -20}, "grain": {"sl_db": 10, "dbfs": None}, "moved": None, "other": None})
        self.assertEqual(self.session()["stimuli"], told["stimuli"])
        said = self.ok("experiment", "small.toml", "--dry-run", "--array", felt).stdout
        self.assertIn("level 7 dB SL\nmethod rough: level -20 dBFS\nmethod grain: level 10 dB SL\n\nrun 1", said)
        report = self.ok("report", "study").stdout
        self.assertIn("(7 dB SL); by rough -20 dBFS; by grain 10 dB SL.", report)
        self.assertIn("waveform square, am 30:0.5, phase burst, envelope linear, attack 0.01, level", report)

    def test_thresholds_are_needed_where_a_method_s_level_is_above_them(self):
        small = self.small(SMALL.replace("gap_s = 0.25", "level = { dbfs = -20 }"))
        self.assertFalse(self.dry(small)[0]["thresholds_assumed"])
        self.small(SMALL.replace("gap_s = 0.25", "level = { dbfs = -20 }").replace('algorithm = "park2016"', "sl_db = 5"))
        self.assertTrue(self.dry(small)[0]["thresholds_assumed"])
        self.refused(2, "experiment", small, "--participant", "01", "-o", "study", "-D", "null", says=["levels in dBFS"])

    def test_of_thresholds_at_several_carriers_that_of_the_trial_counts(self):
        felt = self.felt("felt.toml", ["[[100, -20], [250, -40]]"] * 9)
        self.small(SMALL.replace('algorithm = "park2016"', 'algorithm = "park2016"\ncarrier = 100', 1))
        self.assertFalse(self.dry("small.toml", "--array", felt)[0]["thresholds_assumed"])
        self.simulate("01", "--array", felt, definition="small.toml")
        session = self.session()
        self.assertEqual(session["thresholds_dbfs"], [[[100, -20], [250, -40]]] * 9)
        self.assertEqual(session["array"]["tactors"][0]["threshold_dbfs"], [[100, -20], [250, -40]])
        for stimulus in session["stimuli"]:
            plan = json.loads((self.dir / f"study/sourcedata/sub-01/plans/{stimulus['sha256']}.json").read_text())
            for peak in plan["render"]["peak_dbfs"]:
                self.assertAlmostEqual(peak, 7 + {"park": -20, "brush": -40}[stimulus["method"]])

    def test_the_walk_is_checked_and_has_the_methods_carrier(self):
        # Along the middle row: tactor 8 is driven in the walk alone.
        small = self.small(re.sub(r'\[\[motion\]\]\nname = "down".*?(?=\[\[method)', "", SMALL[:SMALL.rindex("[[run]]")], flags=re.S))
        for felt in (self.felt("high.toml", [-40] * 8 + [-2]), self.felt("weak.toml", [-40] * 9, "max_dbfs = -60\n")):
            said = self.refused(2, "experiment", small, "--dry-run", "--array", felt)
            self.assertEqual(said.stdout, "")
            self.refused(2, "experiment", small, "--array", felt, "--participant", "01", "-o", "study", "-D", "null")
            self.assertFalse((self.dir / "study").exists())
            self.simulate(definition=small, folder=felt[:4])  # without that walk
        at_100 = self.small(SMALL.replace('algorithm = "', 'carrier = 100\nalgorithm = "'))
        felt = self.felt("low.toml", ["[[100, -20], [250, -2]]"] * 9)
        self.dry(at_100, "--array", felt)
        self.refused(2, "experiment", self.small(), "--dry-run", "--array", felt)
        self.write("some.toml", '[array]\nname = "some"\ngrid = { rows = 3, columns = 3, pitch_mm = 20.0 }\n'
                                "[[tactor]]\ntactor = 0\nthreshold_dbfs = [[100, -20], [250, -40]]\n")
        self.assertTrue(self.dry(self.small(), "--array", "some.toml")[0]["thresholds_assumed"])
        self.refused(2, "experiment", "small.toml", "--array", "some.toml", "--participant", "01", "-o", "study", "-D", "null")


class Simulated(ExperimentTest):
    def test_the_folder_follows_bids(self):
        self.assertIn("SIMULATED", self.simulate("P07").stdout)
        study = self.dir / "study"
        for name in ("README", "dataset_description.json", "participants.json", "task-what_beh.json"):
            self.assertIn("simulated", (study / name).read_text().lower(), name)
        files = set(contents(study))
        plans = {f for f in files if f.startswith("sourcedata/sub-P07/plans/")}
        self.assertEqual(files - plans, {
            "README", "dataset_description.json", "participants.json", "participants.tsv", "task-howgood_beh.json",
            "task-what_beh.json", "task-whichone_beh.json", "sub-P07/sub-P07_scans.tsv",
            "sub-P07/beh/sub-P07_task-howgood_beh.tsv", "sub-P07/beh/sub-P07_task-what_beh.tsv",
            "sub-P07/beh/sub-P07_task-whichone_beh.tsv", "sourcedata/sub-P07/session.json",
            "sourcedata/sub-P07/practice.tsv"})
        self.assertEqual(len(plans), 4)
        for plan in plans:
            self.assertEqual(hashlib.sha256((study / plan).read_bytes()).hexdigest(), pathlib.Path(plan).stem)
        description = json.loads((study / "dataset_description.json").read_text())
        for key in ("Name", "BIDSVersion", "DatasetType", "Authors", "GeneratedBy"):
            self.assertIn(key, description)
        self.assertEqual(description["Authors"], ["A. Author"])
        self.assertEqual(description["DatasetType"], "raw")
        self.assertGreater(len((study / "README").read_bytes()), 150)
        self.assertEqual(read_table(study / "participants.tsv"),
                         [{"participant_id": "sub-P07", "age": "n/a", "sex": "n/a", "handedness": "n/a"}])
        for run in ("whichone", "howgood", "what"):
            described = json.loads((study / f"task-{run}_beh.json").read_text())
            self.assertEqual(set(COLUMNS) - set(described), set())
            self.assertEqual(list(self.rows("P07", run)[0]), COLUMNS)

    def test_the_runs_are_in_the_order_in_which_they_were_held(self):
        self.simulate("02")
        scans = read_table(self.dir / "study/sub-02/sub-02_scans.tsv")
        self.assertEqual([s["filename"] for s in scans],
                         [f"beh/sub-02_task-{r}_beh.tsv" for r in ("howgood", "what", "whichone")])
        times = [s["acq_time"] for s in scans]
        self.assertEqual(times, sorted(times))
        for t in times:
            self.assertRegex(t, r"^2000-01-01T\d\d:\d\d:\d\d\.\d{6}Z$")

    def test_each_task_has_its_columns(self):
        self.simulate()
        rate = 48000
        for row in self.rows("01", "whichone"):
            self.assertEqual({row["method_1"], row["method_2"]}, {"brush", "park"})
            self.assertIn(row["response"], ("1", "2"))
            self.assertEqual(row["rating"], "n/a")
            # Both methods take the same time as before; the gap is exact to the frame.
            first = self.frames_of_plan(row["plan_1"])
            self.assertEqual(int(row["frame_2"]) - int(row["frame_1"]), first + rate // 4)
            self.assertAlmostEqual(float(row["duration"]), (first + rate / 4 + self.frames_of_plan(row["plan_2"])) / rate, 6)
        for row in self.rows("01", "howgood"):
            self.assertEqual((row["method_2"], row["plan_2"], row["frame_2"]), ("n/a", "n/a", "n/a"))
            self.assertEqual(row["response"], row["rating"])
            self.assertIn(int(row["rating"]), range(1, 8))
        for row in self.rows("01", "what"):
            self.assertIn(row["response"], ("to the right", "down"))
            self.assertEqual((row["rating"], row["method_1"], row["method_2"]), ("n/a", "park", "n/a"))
        for run in ("whichone", "howgood", "what"):
            rows = self.rows("01", run)
            self.assertEqual(float(rows[0]["onset"]), 0)
            for row in rows:
                self.assertEqual((row["void"], row["xruns"], row["stream"], row["attempt"]), ("false", "0", "1", "1"))
                self.assertGreater(float(row["response_time"]), 0)
                self.assertAlmostEqual(float(row["onset"]), (int(row["frame_1"]) - int(rows[0]["frame_1"])) / rate, 5)
            ends = [float(r["onset"]) + float(r["duration"]) + float(r["response_time"]) for r in rows]
            self.assertTrue(all(float(r["onset"]) > e for r, e in zip(rows[1:], ends)))

    def test_three_methods_are_compared_in_pairs_from_definition_to_report(self):
        third = '[[method]]\nname = "third"\nalgorithm = "continuous"\nphantom = "gaussian"\n[[run]]'
        small = self.small(SMALL.replace("[[run]]", third, 1).replace("trials = 4", "trials = 12"))
        for code in ("01", "02", "03"):
            self.simulate(code, definition=small, spec="seed=1,sigma=2")
        seen = collections.Counter((r["motion"], r["method_1"], r["method_2"]) for r in self.rows("02", "whichone"))
        self.assertEqual((len(seen), set(seen.values())), (2 * 6, {1}))
        run = self.analysis()["runs"]["which-one"]
        self.assertEqual((run["bradley_terry"]["reference"], list(run["bradley_terry"]["se"])), ("brush", ["brush", "park", "third"]))
        self.assertAlmostEqual(sum(m["all"]["mean"] for m in run["chosen"].values()), 150)
        text = self.ok("report", "study").stdout
        self.assertIn("two stimuli of one motion, with two of brush, park, third,", text)
        self.assertEqual(re.findall(r"Per cent of the trials with (\w+) in which people chose it", text), ["brush", "park", "third"])
        self.assertRegex(text, r"relative to brush, which has 0:\n\n\| method .*\n\| --- .*\n\| brush \| 0 \| 0 \|\n\| park \| \S+ \| \S+ \|\n")
        told = json.loads(self.ok("experiment", small, "--power", "3", "--studies", "4", "--simulate", "sigma=1", "--format", "json").stdout)
        self.assertEqual(told["runs"][0]["comparison"], "third chosen in its trials, t against 50 %")

    def test_ratings_on_a_line_and_on_many_steps(self):
        for scale, told, range_text in (('"vas"\nlabels = ["bad", "good"]', "vas", "0 to 100 on a visual analogue scale"), ("21", 21, "1 to 21")):
            small, spec, folder = self.small(SMALL.replace("trials = 4\nscale = 7", f"trials = 40\nscale = {scale}")), "seed=1,sigma=60", f"study-{told}"
            dry = json.loads(self.ok("experiment", small, "--dry-run", "--format", "json").stdout)
            self.assertEqual({r["name"]: r["scale"] for r in dry["runs"]}, {"which-one": None, "how good": told, "what": None})
            for more in ((), ("--resume",)):
                self.simulate("01", *more, definition=small, spec=spec, folder=folder)
            rows = self.rows("01", "howgood", folder)
            ratings = [int(r["rating"]) for r in rows]
            self.assertRegex(range_text, rf"^{min(ratings)} to {max(ratings)}\b")
            self.assertEqual([r["response"] for r in rows], [r["rating"] for r in rows])
            self.assertIn(f"Mean rating of park, {range_text}:\n", self.ok("analyze", folder, "--format", "tables").stdout)
            self.assertIn(f"rated from {range_text}.", self.ok("report", folder).stdout)
            described = json.loads((self.dir / folder / "task-howgood_beh.json").read_text())
            self.assertEqual(described["response"]["Description"], f"The rating, {range_text}")

    def test_the_session_file_is_complete(self):
        self.simulate("01", "--seed", "12")
        s = self.session()
        self.assertEqual((s["simulated"], s["seed"], s["simulation"]), (True, 12, "seed=1,sigma=1"))
        self.assertEqual(s["experiment"]["text"], SMALL)
        self.assertEqual(s["experiment"]["sha256"], hashlib.sha256(SMALL.encode()).hexdigest())
        self.assertEqual(s["thresholds_dbfs"], [-40] * 9)
        self.assertTrue(s["thresholds_assumed"])
        self.assertEqual(len(s["array"]["tactors"]), 9)
        self.assertEqual(s["device"], None)
        self.assertIn("tactor", s["versions"])

    def test_void_trials_come_again_at_the_end_of_their_run(self):
        self.simulate(spec="seed=4,sigma=1,void=0.5", definition=self.small(SMALL.replace("trials = 4", "trials = 12")))
        rows = self.rows("01", "howgood")
        queue = [(n, 1) for n in range(1, 13)]
        first = {}
        for row in rows:
            trial, attempt = queue.pop(0)
            self.assertEqual((int(row["trial"]), int(row["attempt"])), (trial, attempt))
            stimulus = row["motion"], row["method_1"], row["plan_1"]
            self.assertEqual(first.setdefault(trial, stimulus), stimulus)
            if row["void"] == "true":
                self.assertEqual((row["response"], row["rating"], row["response_time"], row["xruns"]),
                                 ("n/a", "n/a", "n/a", "1"))
                queue.append((trial, attempt + 1))
        self.assertEqual(queue, [])
        self.assertGreater(len(rows), 12)

    def test_the_same_session_is_the_same_bytes(self):
        self.simulate(folder="one")
        self.simulate(folder="two")
        self.assertEqual(contents(self.dir / "one"), contents(self.dir / "two"))
        self.simulate(folder="three", spec="seed=2,sigma=1")
        self.assertNotEqual(contents(self.dir / "one"), contents(self.dir / "three"))


class Folder(ExperimentTest):
    def test_a_table_that_is_missing_before_a_later_one_is_not_asked_for_again(self):
        self.simulate()
        scans = (self.dir / "study/sub-01/sub-01_scans.tsv").read_text(encoding="utf-8").splitlines()
        self.assertGreater(len(scans), 2)
        table = self.dir / "study/sub-01" / scans[1].split("\t")[0]
        table.unlink()
        before = contents(self.dir / "study")
        self.simulate("01", "--resume", status=2, says=(f"{table.relative_to(self.dir)}: it is missing", "restore the file"))
        self.assertEqual(contents(self.dir / "study"), before)

    def test_a_session_that_stopped_anywhere_resumes_as_if_it_had_not(self):
        spec = "seed=4,sigma=1,void=0.3"
        self.simulate(spec=spec, folder="whole")
        whole = contents(self.dir / "whole")
        table = "sub-01/beh/sub-01_task-howgood_beh.tsv"
        text = whole[table]
        # After any byte of any line except the header and the first, which come at once.
        least = text.index(b"\n", text.index(b"\n") + 1) + 1
        for cut in sorted({least, *range(len(text) - 101, len(text), 9), *range(least, len(text), 299)}):
            os.system(f"rm -rf {self.dir}/study && cp -r {self.dir}/whole {self.dir}/study")
            (self.dir / "study" / table).write_bytes(text[:cut])
            self.forget_last_run()
            self.simulate("01", "--resume", spec=spec)
            self.assertEqual(self.without_cut(), whole, f"cut at {cut} of {len(text)}")

    def test_a_session_of_another_version_resumes_if_its_stimuli_are_the_same(self):
        self.simulate()
        whole = contents(self.dir / "study")
        table = self.dir / "study/sub-01/beh/sub-01_task-howgood_beh.tsv"
        session = self.dir / "study/sourcedata/sub-01/session.json"
        told = json.loads(session.read_text(encoding="utf-8"))

        def begun_by_another_version(change):
            table.write_bytes(b"".join(whole["sub-01/beh/sub-01_task-howgood_beh.tsv"].splitlines(True)[:-1]))
            other = json.loads(json.dumps(told))
            other["versions"] = {"tactor": "0.0.9", "build": "another one"}
            change(other)
            session.write_text(json.dumps(other, indent=2) + "\n", encoding="utf-8")
            self.forget_last_run()

        begun_by_another_version(lambda other: other["stimuli"][0].update(duration_s=9))
        self.simulate("01", "--resume", status=2, says=("stimuli", "continue with the same"))
        begun_by_another_version(lambda other: None)
        self.simulate("01", "--resume")
        self.assertEqual(table.read_bytes(), whole["sub-01/beh/sub-01_task-howgood_beh.tsv"])
        self.assertEqual(json.loads(session.read_text(encoding="utf-8"))["versions"]["tactor"], "0.0.9")
        self.ok("analyze", "study")

    def test_a_session_resumes_only_with_its_options(self):
        self.simulate("01", "--seed", "3")
        for seed, spec, says in (("4", "seed=1,sigma=1", "seed 3"), ("3", "seed=9", "simulation")):
            self.simulate("01", "--seed", seed, "--resume", spec=spec, status=2, says=(says, "continue with the same"))
        self.small(SMALL + "# a word more\n")
        self.simulate("01", "--seed", "3", "--resume", definition="small.toml", status=2)

    def test_lines_of_another_session_are_refused(self):
        self.simulate()
        file = self.dir / "study/sub-01/beh/sub-01_task-howgood_beh.tsv"
        lines = file.read_text().splitlines(True)
        file.write_text("".join([lines[0], lines[2], lines[1], *lines[3:]]))
        self.simulate("01", "--resume", status=2)

    def test_other_sessions_and_experiments_need_another_folder(self):
        self.simulate()
        file = self.dir / "study/sourcedata/sub-01/session.json"
        text = file.read_text()
        file.write_text(text.replace('"simulated": true', '"simulated": false'))
        self.simulate("02", status=2)
        file.write_text(text)
        self.small(SMALL.replace('name = "down"', 'name = "up"'))
        self.simulate("02", definition="small.toml", status=2)

    def test_a_code_that_is_too_long_leaves_no_folder(self):
        self.simulate("P" * 250, status=2, says=("a code of 250 characters is too long (use a shorter participant code)",))
        self.assertFalse((self.dir / "study").exists())

    def test_new_begins_a_session_and_with_resume_continues_one(self):
        self.simulate("P1", "--resume", "--new")
        before = contents(self.dir / "study")
        self.simulate("P1", "--new", status=2)
        self.simulate("P1", "--resume", "--new", says=("the session is finished",))
        self.assertEqual(contents(self.dir / "study"), before)
        self.simulate("P2", "--new")

    def test_resuming_a_session_that_is_not_there_begins_none(self):
        for code in ("P1", "P2"):
            self.simulate(code, "--resume", status=2, says=(f"--resume: there is no sub-{code} in study", "add --new to begin a new session"))
            self.assertEqual((self.dir / "study").exists(), code == "P2")
            if code == "P1":
                self.simulate("P1")
                before = contents(self.dir / "study")
        self.assertEqual(contents(self.dir / "study"), before)

    def test_a_warning_names_codes_that_look_alike(self):
        for code, others in (("01", []), ("C02", []), ("P01", ["01"]), ("1", ["01", "P01"]), ("11", []), ("P02", []), ("2", ["C02", "P02"]), ("Anna", [])):
            said = self.simulate(code).stderr
            self.assertEqual(sorted(re.findall(rf"warning: study: sub-(\w+) and sub-{code}: these codes look alike: check whether they are one person", said)), others)
        for command in ("analyze", "report"):
            said = self.ok(command, "study").stderr
            self.assertEqual(len(re.findall("look alike", said)), 5, said)
        self.assertNotIn("look alike", self.ok("analyze", "study", "--participants", "01,C02,11").stderr)

    def test_words_that_give_an_answer_its_meaning_make_another_experiment(self):
        """Participants whose scale was turned round are not averaged with the others."""
        said = SMALL.replace('name = "how good"\n', 'name = "how good"\nquestion = "How good?"\nlabels = ["bad", "good"]\n').replace(
            'name = "which-one"\n', 'name = "which-one"\nchoices = ["the first", "the second"]\n') + FORM
        self.assertEqual(said.count("labels"), 2)
        self.simulate(definition=self.small(said))
        for old, new, place, what, before, now in (
                ('["bad", "good"]', '["good", "bad"]', 'in run "how good", ', "labels", '["bad", "good"]', '["good", "bad"]'),
                ('["the first", "the second"]', '["the second", "the first"]', 'in run "which-one", ', "choices",
                 '["the first", "the second"]', '["the second", "the first"]'),
                ("How good?", "How bad?", 'in run "how good", ', "question", '"How good?"', '"How bad?"'),
                ("scale = 7", "scale = 8", 'in run "how good", ', "scale", '"1 to 7"', '"1 to 8"'),
                ('"left", "right"', '"right", "left"', 'in run "about", item "hand", ', "choices", '["left", "right"]', '["right", "left"]'),
                ('["no", "yes"]', '["yes", "no"]', 'in run "about", item "tired", ', "labels", '["no", "yes"]', '["yes", "no"]'),
                ("scale = 9", 'scale = "vas"', 'in run "about", item "tired", ', "scale", '"1 to 9"', '"0 to 100"'),
                ("Tired?", "Awake?", 'in run "about", item "tired", ', "question", '"Tired?"', '"Awake?"'),
                ("[0, 99]", "[1, 99]", 'in run "about", item "years", ', "range", '"0 to 99"', '"1 to 99"'),
                ('"years"', '"months"', 'in run "about", ', "items", '["hand", "years", "tired"]', '["hand", "months", "tired"]'),
                ('"before"', '"after"', 'in run "about", ', "time", '"before the first run"', '"after the last run"'),
                ('name = "down"', 'name = "up"', 'in run "which-one", ', "motions", '["to the right", "down"]', '["to the right", "up"]'),
                ('name = "what"', 'name = "which"', "", "runs", '["which-one", "how good", "what"]', '["which-one", "how good", "which"]')):
            with self.subTest(old=old):
                self.assertEqual(said.count(old), 1)
                changed = self.small(said.replace(old, new))
                self.simulate("02", definition=changed, status=2, says=(
                    f"study: sub-01 was run with a different experiment: {place}the {what} changed from {before} to {now}",
                    "(give each experiment its own folder)"))
                shutil.rmtree(self.dir / "two", ignore_errors=True)
                self.simulate("02", definition=changed, folder="two")
                self.refused(2, "analyze", "study", "two", says=(
                    f"sub-01 and sub-02: their experiments differ: {place}sub-01 has the {what} {before}, but sub-02 has {now}",))
                self.ok("analyze", "study", "two", "--exclude", "02")
        # Words besides, and a questionnaire more, do not.
        for text in (said.replace('title = "A small one"', 'title = "One"'), said.replace("About you", "You"), said.replace(FORM, "")):
            shutil.rmtree(self.dir / "two", ignore_errors=True)
            self.simulate("02", definition=self.small(text), folder="two")
            self.ok("analyze", "study", "two")
        self.assertIn("sub-01 used a different text of this definition", self.simulate("03", definition=self.small(text)).stderr)

    def test_a_changed_definition_is_reported(self):
        self.assertNotIn("different text", self.simulate("02").stderr + self.simulate("01").stderr)
        self.small(SMALL.replace("gap_s = 0.25", "gap_s = 0.5"))
        told = self.simulate("03", definition="small.toml").stderr
        self.assertIn("warning: study: sub-01, sub-02 used a different text of this definition", told)

    def test_a_second_session_of_a_participant_is_refused(self):
        self.simulate()
        holder = os.open(self.dir / "study/.sub-p02.lock", os.O_RDWR | os.O_CREAT)
        fcntl.flock(holder, fcntl.LOCK_EX)
        for code in ("P02", "p02"):  # one name on a disk that ignores capitals
            self.simulate(code, status=2)
        self.simulate("03")
        os.close(holder)  # as a crash does, with the file left behind
        self.simulate("P02")
        self.assertEqual([f.name for f in (self.dir / "study").iterdir() if f.name.endswith(".lock")], [])

    def test_a_session_waits_while_another_changes_what_they_share(self):
        self.simulate("02")
        folder = os.open(self.dir / "study", os.O_RDONLY)
        fcntl.flock(folder, fcntl.LOCK_EX)
        booth = self.start_tool("experiment", self.small(), "--participant", "01", "-o", "study", "--simulate", "seed=1,sigma=1")
        self.until(lambda: re.search(rf"-> FLOCK .* {booth.pid} ", pathlib.Path("/proc/locks").read_text()), booth)
        os.close(folder)
        self.assertEqual(booth.wait(PATIENCE_S), 0)

    def test_several_booths_fill_one_folder_at_once(self):
        definition = self.small(SMALL + FORM)
        codes = [f"{n:02}" for n in range(1, 9)]
        booths = [self.start_tool("experiment", definition, "--participant", code, "-o", "study", "--simulate", "seed=1,sigma=1") for code in codes]
        for booth in booths:
            self.assertEqual(booth.wait(PATIENCE_S), 0)
        for table in ("participants.tsv", "phenotype/about.tsv"):
            rows = (self.dir / "study" / table).read_text().splitlines()[1:]
            self.assertEqual(sorted(row.split("\t")[0] for row in rows), [f"sub-{code}" for code in codes], table)
        self.ok("analyze", "study")
        for code in codes:
            self.simulate(code, folder="alone", definition=definition)
        self.assertEqual(sorted(contents(self.dir / "study")), sorted(contents(self.dir / "alone")))

    def test_a_folder_of_other_things_is_left_alone(self):
        self.write("study/letter.txt", "dear")
        self.simulate(status=2)
        self.assertEqual(set(contents(self.dir / "study")), {"letter.txt"})
        self.write("file", "x")
        self.simulate(folder="file", status=2)
        self.simulate(folder="none/study", status=2)
        self.simulate(folder="/proc/study", status=1)

    @unittest.skipIf(os.geteuid() == 0, "root may write everywhere")
    def test_a_folder_without_write_permission_is_refused(self):
        (self.dir / "study").mkdir(mode=0o555)
        self.simulate(status=1)

    def test_the_experimenter_s_columns_in_the_list_of_participants_stay(self):
        self.simulate()
        file = self.dir / "study/participants.tsv"
        file.write_text("participant_id\tage\tsex\thandedness\tgroup\r\nsub-01\t24\tF\tR\told\r\n")
        self.simulate("02")
        self.assertEqual(file.read_bytes(), b"participant_id\tage\tsex\thandedness\tgroup\r\nsub-01\t24\tF\tR\told\r\n"
                                            b"sub-02\tn/a\tn/a\tn/a\tn/a\r\n")
        file.write_bytes(b"group\tparticipant_id\nold\tsub-01\nnew\tsub-02\n")
        self.simulate("03")
        self.assertEqual(file.read_bytes(), b"group\tparticipant_id\nold\tsub-01\nnew\tsub-02\nn/a\tsub-03\n")

    def test_leftovers_of_a_crash_are_removed(self):
        self.simulate(folder="whole")
        whole = contents(self.dir / "whole")
        os.system(f"cp -r {self.dir}/whole {self.dir}/study")
        for name in (".README.0badcafe.part", "sub-01/beh/.x.00000001.part", "sourcedata/sub-01/plans/.y.2.part"):
            self.write(f"study/{name}", "half")
        self.simulate("01", "--resume")
        self.assertEqual(contents(self.dir / "study"), whole)


class Orders(ExperimentTest):
    def dry(self, *args):
        return json.loads(self.ok("experiment", *args, "--dry-run", "--format", "json").stdout)

    def test_a_replacement_takes_over_a_row_and_keeps_it(self):
        self.simulate("02")
        self.simulate("05", "--order", "2")
        order = self.session("02")["order"]
        self.assertEqual((self.session("05")["order"], self.session("05")["order_row"]), (order, 2))
        self.assertIn("finished", self.simulate("05", "--resume", "--order", "2").stdout)
        self.simulate("05", "--resume", status=2, says=('began with order ["how good"',))
        self.simulate("05", "--resume", "--order", "3", status=2, says=("began with order_row 2, but now it is 3",))
        self.simulate("02", "--resume", "--order", "3", status=2, says=("began with order_row none",))
        report = self.ok("report", "study").stdout
        for text in (f"| {', '.join(order)} (row 2) |", f"| {', '.join(order)} |", "is a row of a Williams square (Williams 1949), chosen by"):
            self.assertIn(text, report)

    def test_the_row_of_a_code_is_listed(self):
        self.assertEqual([self.dry(self.small(), "--participant", code)["order_row"] for code in ("01", "P07", "12")], [1, 1, 6])
        self.assertIn("participant P08, row 2 of 6, seed", self.ok("experiment", "small.toml", "--participant", "P08", "--dry-run").stdout)

    def test_latin_and_random_orders(self):
        self.write("latin.toml", SMALL.replace("gap_s", 'order = "latin"\ngap_s'))
        names = [[r["name"] for r in self.dry("latin.toml", "--order", n)["runs"]] for n in (1, 2, 3)]
        self.assertEqual(names, [["which-one", "how good", "what"], ["how good", "what", "which-one"], ["what", "which-one", "how good"]])
        self.write("random.toml", SMALL.replace("gap_s", 'order = "random"\ngap_s'))
        self.refused(2, "experiment", "random.toml", "--dry-run", "--order", "2")
        self.simulate("01", definition="random.toml")
        self.assertIn("The order of the runs is random, drawn for each participant.", self.ok("report", "study").stdout)

    def test_blocks_stand_together_and_a_session_keeps_their_order(self):
        self.small(SMALL.replace("trials = 4\nscale", 'trials = 12\nblocks = "methods"\nscale'))
        self.simulate("02", definition="small.toml")
        self.assertEqual([r["method_1"] for r in self.rows("02", "howgood")], 6 * ["park"] + 6 * ["brush"])
        self.simulate("02", "--resume", "--order", "8", definition="small.toml", status=2, says=("began with order_row 2, but now it is 8",))
        self.assertIn("- Blocks: the methods, ordered like the runs", self.ok("report", "study").stdout)


class Groups(ExperimentTest):
    def test_a_group_has_its_runs_motions_and_methods_and_is_recorded(self):
        self.grouped(("01", "palm"), ("02", "arm"), ("03", "few"))
        study = self.dir / "study"
        self.assertEqual([p["group"] for p in read_table(study / "participants.tsv")], ["palm", "arm", "few"])
        levels = json.loads((study / "participants.json").read_text())["group"]["Levels"]
        self.assertEqual((list(levels), levels["few"]), (["palm", "arm", "few"], "how good: motions down, methods park"))
        self.assertEqual(json.loads((study / "task-howgood_beh.json").read_text())["group"]["Description"], "Group of the participant")
        self.assertEqual((self.session("02")["group"], self.session("02")["order"]), ("arm", ["how good", "which-one"]))
        for code, group, motions, methods in (("01", "palm", {"to the right", "down"}, {"brush", "park"}), ("03", "few", {"down"}, {"park"})):
            rows = self.rows(code, "howgood")
            self.assertEqual(sorted(rows[0]), sorted([*COLUMNS, "group"]))
            self.assertEqual([{r[c] for r in rows} for c in ("group", "motion", "method_1")], [{group}, motions, methods])
        self.assertEqual({s["motion"] for s in self.session("03")["stimuli"]}, {"down"})

    def test_what_does_not_fit_the_groups_is_refused(self):
        self.grouped(("01", "palm"))
        more = {"definition": "grouped.toml", "status": 2}
        self.simulate("02", **more, says=("--group", "one of palm, arm, few"))
        self.simulate("02", "--group", "leg", **more)
        self.simulate("01", "--resume", "--group", "arm", **more, says=('began with group "palm", but now it is "arm"',))
        people = self.dir / "study/participants.tsv"
        people.write_text(people.read_text() + "sub-02\t30\tn/a\tn/a\tarm\n")  # a list made before
        self.simulate("02", "--group", "palm", **more, says=('participants.tsv:3: sub-02 is listed in group "arm", but this session is in group "palm"',))
        self.grouped(("02", "arm"))
        self.edit("study/sourcedata/sub-01/session.json", '"group": "palm"', '"group": "leg"')
        self.refused(2, "analyze", "study")

    def test_each_group_has_the_results_of_a_study_of_its_own(self):
        people = [("01", "palm"), ("02", "palm"), ("03", "arm"), ("04", "arm"), ("05", "few"), ("06", "few")]
        self.grouped(*people)
        told = self.analysis()
        self.assertFalse([w for w in told["warnings"] if "left out" in w])
        told = told["runs"]
        self.assertEqual({name: (run["n"], list(run["groups"])) for name, run in told.items()},
                         {"which-one": (4, ["palm", "arm"]), "how good": (4, ["palm", "arm", "few"]), "what": (2, ["palm"])})
        for group in ("palm", "arm"):
            alone = self.analysis("--participants", ",".join(c for c, g in people if g == group))["runs"]
            for name, run in told.items():
                if group in run["groups"]:
                    self.assertEqual(run["groups"][group], {k: v for k, v in alone[name].items() if k not in ("groups", "group_anova")})
        few = told["how good"]["groups"]["few"]
        means = [sum(int(r["rating"]) for r in self.rows(code, "howgood")) / 4 for code in ("05", "06")]
        self.assertEqual((few["n"], list(few["means"]), few["paired"]), (2, ["park"], None))
        self.assertAlmostEqual(few["means"]["park"]["motion"]["down"]["mean"], sum(means) / 2, 12)
        self.assertIn("how good, group few: rate, 2 participants, 8 trials", self.ok("analyze", "study", "--format", "tables", "-o", "a.svg").stdout)
        self.assertIn('data-title="how good, group few (n = 2)"', (self.dir / "a.svg").read_text())
        rows = list(csv.DictReader(io.StringIO(self.ok("analyze", "study", "--format", "wide").stdout)))
        self.assertEqual([(r["participant_id"][4:], r["group"]) for r in rows], people)
        self.assertEqual({c for c, v in rows[4].items() if v}, {"participant_id", "simulated", "group", "how_good.park.down"})
        self.assertEqual([float(r["how_good.park.down"]) for r in rows[4:]], means)

    def test_tables_for_r_and_the_report_state_the_group(self):
        self.grouped(("01", "palm"), ("02", "arm"), ("03", "few"))
        lines, rows = self.trials()
        self.assertIn('# lmer(rating ~ method * (group * motion) + (1 + method | participant), data = subset(d, run == "how good"))', lines)
        self.assertIn('# glmer(correct ~ motion + (1 + motion | participant), family = binomial, data = subset(d, run == "what"))', lines)
        self.assertEqual({(r["group"], r["run"], r["motion"], r["method"]) for r in rows if r["participant"] == "03"},
                         {("few", "how good", "down", "park")})
        report = self.ok("report", "study").stdout
        for text in ("- Group few: how good: motions down, methods park\n", "| sub-03 | few |", "### how good, group few (SIMULATED)\n",
                     "| participant | group | days (UTC) |"):
            self.assertIn(text, report)

    def test_two_of_three_methods_are_chosen_from_in_a_group(self):
        third = SMALL.replace("[[run]]", '[[method]]\nname = "linear"\nphantom = "linear"\n[[run]]', 1)
        self.write("grouped.toml", third + '[[group]]\nname = "two"\nmethods = ["park", "linear"]\n[[group]]\nname = "all"\n')
        for code in ("01", "02"):
            self.simulate(code, "--group", "two", definition="grouped.toml")
        run = self.analysis()["runs"]["which-one"]
        self.assertEqual((run["n"], list(run["chosen"]), run["groups"]["two"]["method"]), (0, ["brush", "park", "linear"], "linear"))
        self.assertEqual([(r["method"], r["other"], r["chosen"]) for r in self.trials()[1] if r["run"] == "which-one"],
                         [(r["method_1"], r["method_2"], "1" if r["response"] == "1" else "0") for code in ("01", "02") for r in self.rows(code, "whichone")
                          if r["void"] == "false"])


class Power(ExperimentTest):
    SPEC = ("--simulate", "seed=4,sigma=6")

    def power(self, *args, definition="park2016", spec=SPEC):
        return self.ok("experiment", definition, "--power", *args, *spec).stdout

    def told(self, *args, **more):
        return json.loads(self.power(*args, "--format", "json", **more))

    def test_the_first_study_is_the_one_of_the_simulated_sessions(self):
        told = self.told("2,5", "--studies", "1")
        for n in range(1, 6):
            self.simulate(f"{n:02}", definition="park2016", spec=self.SPEC[1])
            if n not in (2, 5):
                continue
            runs = self.analysis()["runs"]
            for run in told["runs"]:
                mine = next(p for p in run["power"] if p["participants"] == n)
                own = runs[run["name"]]
                test = own["preference"]["all"] if run["task"] == "choose" else own["paired"]
                self.assertEqual(mine["significant"], int(test["p"] is not None and test["p"] < 0.05), (run["name"], n))
                self.assertEqual(mine["untested"], int(test["p"] is None))

    def test_json_has_counts_shares_and_intervals_and_text_the_same(self):
        told, text = self.told("4,12", "--studies", "60"), self.power("4,12", "--studies", "60")
        self.assertEqual((told["schema"], told["simulated"], told["studies"], told["simulation"], told["alpha"]),
                         ("tactor-power/1", True, 60, "seed=4,sigma=6", 0.05))
        self.assertEqual([r["name"] for r in told["runs"]],
                         ["similarity", "uniformity", "similarity-rating", "uniformity-rating"])
        self.assertIn("60 SIMULATED studies (seed=4,sigma=6)", text)
        for run in told["runs"]:
            self.assertEqual([p["participants"] for p in run["power"]], [4, 12])
            block = text.partition(f"\n{run['name']}: {run['comparison']}\n")[2].splitlines()[1:3]
            for line, p in zip(block, run["power"]):
                self.assertEqual(p["power"], p["significant"] / 60)
                self.assertTrue(p["ci"][0] <= p["power"] <= p["ci"][1] and p["for_last"] <= p["significant"])
                for k, bound, ends in ((p["significant"], p["ci"][0], range(p["significant"], 61)), (60 - p["significant"], p["ci"][1], range(p["significant"] + 1))):
                    tail = sum(math.comb(60, i) * bound ** i * (1 - bound) ** (60 - i) for i in ends)
                    self.assertAlmostEqual(tail, 0.025 if k else 1, 9)  # exact: Clopper and Pearson 1934
                self.assertEqual(line.split(), [str(p["participants"]), f"{100 * p['power']:.1f}", "%",
                                                f"{100 * p['ci'][0]:.1f}", "...", f"{100 * p['ci'][1]:.1f}",
                                                f"{100 * p['for_last'] / 60:.1f}", "%", str(p["untested"])])
        self.assertTrue(any(0 < p["significant"] < 60 for r in told["runs"] for p in r["power"]))
        self.assertEqual(self.power("4,12", "--studies", "60"), text)
        self.assertNotEqual(self.power("4,12", "--studies", "60", spec=("--simulate", "seed=900,sigma=6")), text)
        self.assertEqual(self.told("3")["studies"], 200)

    def test_custom_definitions_with_identify_and_void_trials(self):
        self.small()
        before = sorted(self.dir.rglob("*"))
        told = self.told("3", "--studies", "20", definition="small.toml", spec=("--simulate", "sigma=5,void=0.3"))
        self.assertEqual([r["comparison"] for r in told["runs"]],
                         ["park chosen, t against 50 %", "park less brush, paired t", "park correct, t against 50.00 %"])
        self.assertEqual(sorted(self.dir.rglob("*")), before)

    def test_parts_merge_to_the_bytes_of_one_run(self):
        args = ("experiment", self.small(), "--power", "3,2", "--studies", "10", "--simulate", "sigma=5")
        for k in (1, 2, 3):
            self.assertEqual(self.ok(*args, "--part", f"{k}/3", "-o", f"{k}.json").stdout, "")
        for form in ("text", "json"):
            self.assertEqual(self.ok(*args, "--format", form, "--merge", "3.json", "1.json", "2.json").stdout,
                             self.ok(*args, "--format", form).stdout)
        self.ok(*args, "--part", "1/1", "-o", "whole.json")
        self.assertEqual(self.ok(*args, "--merge", "whole.json").stdout, self.ok(*args).stdout)
        self.refused(2, *args, "--merge", "1.json", "3.json", says=["part 2/3 is missing"])
        self.refused(2, *args, "--merge", "1.json", "2.json", "1.json", says=["1.json: part: part 1 is also in 1.json"])
        self.refused(2, *args, "--merge", "1.json", "whole.json", says=["whole.json: parts: it is 1, but 1.json has 3"])
        told = json.loads((self.dir / "2.json").read_text())
        for key, value in (("definition", "0" * 64), ("version", "0.0.1"), ("simulation", "seed=2,sigma=5"), ("stimuli", None), ("seed", 3),
                           ("studies", 11), ("participants", [3]), ("part", 4), ("part", 1.5), ("schema", "tactor-power/1"), ("runs", []),
                           ("runs", [[{"participants": 3, "significant": 11, "for_last": 0, "untested": 0}] * 2] * 3)):
            self.write("other.json", json.dumps(told | {key: value}))
            self.refused(2, *args, "--merge", "1.json", "other.json", "3.json", says=[f"tactor: other.json: {key}"])
        self.write("other.json", "[")
        for more in (("--merge", "other.json"), ("--merge", "none.json"), ("--part", "1/3"), ("--part", "0/3", "-o", "x"), ("--part", "4/3", "-o", "x"),
                     ("--part", "1", "-o", "x"), ("--part", "1/11", "-o", "x"), ("--part", "1/3", "-o", "none/x"), ("-o", "study"),
                     ("--part", "1/3", "-o", "x", "--merge", "1.json")):
            self.refused(2, *args, *more)
        self.assertFalse((self.dir / "x").exists())
        # A part is written again by itself alone.
        kept = (self.dir / "1.json").read_bytes()
        for more, says in ((("--part", "1/4"), "1.json: it holds part 1 of 3 ("), (("--part", "2/3"), "1.json: it holds part 1 of 3 ("),
                           (("--part", "1/3", "--seed", "9"), "1.json: it holds part 1 of 3 of studies with a different seed")):
            self.refused(2, *args, *more, "-o", "1.json", says=[says, "name another file, or remove this one"])
        self.assertEqual((self.dir / "1.json").read_bytes(), kept)
        self.ok(*args, "--part", "1/3", "-o", "1.json")
        self.assertEqual((self.dir / "1.json").read_bytes(), kept)
        self.write("thesis.tex", "years of work")
        self.refused(2, *args, "--part", "1/3", "-o", "thesis.tex", says=["thesis.tex: it exists, and tactor did not write it"])

    def test_a_job_array_does_all_parts(self):
        args = (self.small(), "--power", "3", "--studies", "4", "--simulate", "sigma=5")
        text = (ROOT / "examples/experiments/power.sbatch").read_text(encoding="utf-8")
        self.assertIn("#SBATCH --array=1-100\n", text)
        self.assertIn("\nparts=100 ", text)
        array = self.write("three.sbatch", text.replace("parts=100", "parts=3"))
        # The second task is lost; it runs again alone, in an array of one.
        for k, count in (("1", "3"), ("3", "3"), ("2", "1")):
            subprocess.run(["sh", array, *map(str, args)], cwd=self.dir, check=True, stderr=subprocess.DEVNULL,
                           env=self.env | {"PATH": f"{TOOL.parent}:{os.environ['PATH']}", "SLURM_ARRAY_TASK_ID": k, "SLURM_ARRAY_TASK_COUNT": count})
        self.assertEqual(self.ok("experiment", *args, "--merge", *(f"part{k}.json" for k in (1, 2, 3))).stdout, self.ok("experiment", *args).stdout)

    def test_impossible_numbers_and_exclusive_options_are_refused(self):
        self.write("bad.toml", "[experiment]\n")
        for args in (*(f"--power={n}" for n in ("1", "0", "-3", "1001", "12,", "", "twelve", "12;14", "2.5", "99999999999999999999999", "8,12,8")),
                     *(f"--power 8 --studies={n}" for n in ("0", "-1", "1000001", "many")),
                     *(f"--power 8 {more}" for more in ("--participant 01", "-o study", "--resume", "--order 2", "--dry-run", "--print"))):
            self.assertEqual(self.refused(2, "experiment", "park2016", *args.split(), *self.SPEC).stdout, "")
        for args in ("park2016 --power 8", "park2016 --studies 8 --dry-run", "bad.toml --power 8 --simulate seed=4"):
            self.assertEqual(self.refused(2, "experiment", *args.split()).stdout, "")
        self.assertFalse((self.dir / "study").exists())

    def test_ctrl_c_ends_it_without_a_result(self):
        # The thread waits for the tool from the start: the signal must come while studies are simulated.
        def pending():
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
            os.kill(os.getpid(), signal.SIGINT)
        result = self.run_tool("experiment", "park2016", "--power", "1000", "--studies", "1000000", *self.SPEC, before=pending)
        self.assertEqual((result.returncode, result.stdout), (130, ""))
        self.assertIn("ended by a signal before there was a result", result.stderr)


if __name__ == "__main__":
    main()
