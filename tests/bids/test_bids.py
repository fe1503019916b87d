# SPDX-License-Identifier: MIT
"""The folder of tactor experiment as BIDS, by bids-validator: whole, broken off, resumed, with void trials, and with
derivatives. Usage: test_bids.py TOOL SOURCE_ROOT VALIDATOR"""
import json
import pathlib
import shutil
import subprocess
import sys

VALIDATOR = pathlib.Path(sys.argv.pop(3))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from experiments import SMALL, ExperimentTest  # noqa: E402
from harness import ROOT, main  # noqa: E402

# A single author is enough for an example.
HARMLESS = {"TOO_FEW_AUTHORS"}


class Folders(ExperimentTest):
    def issues(self):
        """Returns the validator's errors and warnings by name, and its summary."""
        said = subprocess.run(["node", VALIDATOR, "--json", self.dir / "study"], capture_output=True, text=True, check=False)
        told = json.loads(said.stdout)
        errors = {i["key"]: [f["evidence"] for f in i["files"]] for i in told["issues"]["errors"]}
        self.assertEqual(said.returncode != 0, bool(errors), said.stderr)
        return errors, {i["key"] for i in told["issues"]["warnings"]}, told["summary"]

    def valid(self, subjects, warned=(), more=()):
        errors, warnings, summary = self.issues()
        self.assertEqual(errors, {})
        self.assertEqual(warnings - HARMLESS, set(warned))
        self.assertEqual(summary["subjects"], subjects)
        self.assertEqual(summary["dataTypes"], ["beh", *more])
        return summary

    def test_two_participants_of_the_paper_s_experiment(self):
        for code in ("01", "02"):
            self.simulate(code, definition="park2016")
        told = self.valid(["01", "02"])
        self.assertEqual(sorted(told["tasks"]), ["similarity", "similarity-rating", "uniformity", "uniformity-rating"])

    def test_questionnaires(self):
        for code in ("01", "02"):
            self.simulate(code, definition=ROOT / "examples/experiments/questionnaires.toml")
        self.valid(["01", "02"])
        self.simulate("03", definition=ROOT / "examples/experiments/questionnaires.toml")
        (self.dir / "study/.bidsignore").unlink()  # one line of each participant is valid, too
        self.valid(["01", "02", "03"])
        # A questionnaire between three runs has two of each.
        between = '[[run]]\nname = "tired"\ntask = "questionnaire"\nwhen = "between"\nitem = [{ name = "now", question = "?", kind = "text" }]\n'
        self.write("between.toml", SMALL + between)
        shutil.rmtree(self.dir / "study")
        self.simulate("01", definition="between.toml")
        self.valid(["01"])

    def test_void_trials_practice_and_derivatives(self):
        for code in ("A1", "b2"):
            self.simulate(code, spec="seed=2,void=0.3")
        rows = [r for code in ("A1", "b2") for task in ("whichone", "howgood", "what") for r in self.rows(code, task)]
        self.assertIn("true", {r["void"] for r in rows})
        self.ok("report", "study", "-o", "study/derivatives/tactor/methods.md")
        self.ok("analyze", "study", "-o", "study/derivatives/tactor/study.svg")
        self.valid(["A1", "b2"])

    def test_a_session_that_was_broken_off_and_resumed(self):
        self.simulate("01")
        self.simulate("02")
        beh = self.dir / "study/sub-02/beh"
        table = beh / "sub-02_task-howgood_beh.tsv"
        scans = self.dir / "study/sub-02/sub-02_scans.tsv"
        order = [line.split("\t")[0] for line in scans.read_text().splitlines()[1:]]
        at = order.index(f"beh/{table.name}")
        for name in order[at + 1:]:
            (self.dir / "study/sub-02" / name).unlink()
        scans.write_text("".join(scans.read_text().splitlines(True)[:at + 2]))
        table.write_text("".join(table.read_text().splitlines(True)[:3]))
        self.valid(["01", "02"], ["INCONSISTENT_SUBJECTS"])
        # The cut off line is kept beside the table, and a missing list is begun anew.
        with table.open("a") as f:
            f.write("12.5\t0.")
        scans.unlink()
        self.simulate("02", "--resume")
        self.assertEqual(len(self.rows("02", "howgood")), 4)
        self.assertEqual(table.with_name(table.name + ".cut-1").read_text(), "12.5\t0.")
        self.valid(["01", "02"])

    def test_columns_filled_in_by_hand(self):
        self.simulate("01")
        path = self.dir / "study/participants.tsv"
        path.write_text(path.read_text().replace("sub-01\tn/a\tn/a\tn/a", "sub-01\t31\tF\tR"))
        self.valid(["01"])

    def test_groups(self):
        self.grouped(("01", "palm"), ("02", "palm"))
        self.valid(["01", "02"])

    def test_several_sessions(self):
        self.write("two.toml", SMALL.replace("gap_s", "sessions = 2\ngap_s"))
        for code, n in (("01", "1"), ("02", "1"), ("01", "2")):
            self.simulate(code, "--session", n, definition="two.toml", spec="seed=2,void=0.3")
        self.assertEqual(self.valid(["01", "02"], ["MISSING_SESSION"])["sessions"], ["1", "2"])
        self.simulate("02", "--session", "2", definition="two.toml")
        self.valid(["01", "02"])

    def test_events_of_codes(self):
        self.write("array.toml", '[array]\npreset = "palm-3x3"\n[sync]\ncode = { channel = 15 }\n')
        for code in ("01", "02"):
            self.simulate(code, "--array", "array.toml", spec="seed=2,void=0.3")
        self.assertEqual(len(list((self.dir / "study").glob("sub-*/beh/*_events.tsv"))), 6)
        self.valid(["01", "02"], more=["events"])

    def test_the_validator_finds_faults(self):
        self.simulate("01")
        good = self.dir / "study/sub-01/beh/sub-01_task-what_beh.tsv"
        bad = good.with_name("sub-01_what_beh.tsv")
        good.rename(bad)
        self.assertIn("NOT_INCLUDED", self.issues()[0])
        bad.rename(good)
        self.valid(["01"])
        text = good.read_text()
        good.write_text(text.replace("\t", "\t\t", 1))
        self.assertNotEqual(self.issues()[0], {})
        good.write_text(text)
        (self.dir / "study/dataset_description.json").unlink()
        self.assertNotEqual(self.issues()[0], {})


if __name__ == "__main__":
    main()
