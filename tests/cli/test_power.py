# SPDX-License-Identifier: MIT
"""tactor experiment --power: how often simulated studies are significant, its refusals, and Ctrl-C."""
import json
import os
import signal

from experiments import ExperimentTest
from harness import main

SPEC = ("--simulate", "seed=4,sigma=6")


class PowerTest(ExperimentTest):
    def power(self, *args, definition="park2016", spec=SPEC):
        return self.ok("experiment", definition, "--power", *args, *spec).stdout

    def told(self, *args, **more):
        return json.loads(self.power(*args, "--format", "json", **more))


class Tells(PowerTest):
    def test_the_first_study_is_the_one_of_the_simulated_sessions(self):
        told = self.told("2,5", "--studies", "1")
        for n in range(1, 6):
            self.simulate(f"{n:02}", definition="park2016", spec=SPEC[1])
            if n not in (2, 5):
                continue
            runs = json.loads(self.ok("analyze", "study", "--format", "json").stdout)["runs"]
            for run in told["runs"]:
                mine = next(p for p in run["power"] if p["participants"] == n)
                own = runs[run["name"]]
                test = own["preference"]["all"] if run["task"] == "choose" else own["paired"]
                self.assertEqual(mine["significant"], int(test["p"] is not None and test["p"] < 0.05), (run["name"], n))
                self.assertEqual(mine["untested"], int(test["p"] is None))

    def test_json_has_counts_shares_and_intervals(self):
        told = self.told("4,12", "--studies", "60")
        self.assertEqual((told["schema"], told["simulated"], told["studies"], told["simulation"], told["alpha"]),
                         ("tactor-power/1", True, 60, "seed=4,sigma=6", 0.05))
        self.assertEqual([r["name"] for r in told["runs"]],
                         ["similarity", "uniformity", "similarity-rating", "uniformity-rating"])
        for run in told["runs"]:
            self.assertEqual([p["participants"] for p in run["power"]], [4, 12])
            for p in run["power"]:
                self.assertEqual(p["power"], p["significant"] / 60)
                self.assertLessEqual(p["ci"][0], p["power"])
                self.assertGreaterEqual(p["ci"][1], p["power"])
                self.assertLessEqual(p["for_last"], p["significant"])
        self.assertTrue(any(0 < p["significant"] < 60 for r in told["runs"] for p in r["power"]))

    def test_text_has_the_same_and_says_that_it_is_simulated(self):
        told, text = self.told("4,12", "--studies", "60"), self.power("4,12", "--studies", "60")
        self.assertIn("60 SIMULATED studies (seed=4,sigma=6)", text)
        for run in told["runs"]:
            block = text.partition(f"\n{run['name']}: {run['comparison']}\n")[2].splitlines()[1:3]
            for line, p in zip(block, run["power"]):
                self.assertEqual(line.split(), [str(p["participants"]), f"{100 * p['power']:.1f}", "%",
                                                f"{100 * p['ci'][0]:.1f}", "...", f"{100 * p['ci'][1]:.1f}",
                                                f"{100 * p['for_last'] / 60:.1f}", "%", str(p["untested"])])

    def test_it_is_reproducible_and_depends_on_the_seed(self):
        one = self.power("6", "--studies", "50")
        self.assertEqual(self.power("6", "--studies", "50"), one)
        self.assertNotEqual(self.power("6", "--studies", "50", spec=("--simulate", "seed=900,sigma=6")), one)
        self.assertEqual(self.told("3")["studies"], 200)

    def test_custom_definitions_with_identify_and_void_trials(self):
        told = self.told("3", "--studies", "20", definition=self.small(), spec=("--simulate", "sigma=5,void=0.3"))
        self.assertEqual([r["comparison"] for r in told["runs"]],
                         ["park chosen, t against 50 %", "park less brush, paired t", "park correct, t against 50.00 %"])

    def test_nothing_is_written(self):
        before = sorted(self.dir.rglob("*"))
        self.power("3", "--studies", "5")
        self.assertEqual(sorted(self.dir.rglob("*")), before)


class Refuses(PowerTest):
    def says(self, *args, says):
        result = self.refused(2, "experiment", "park2016", *args, says=says)
        self.assertEqual(result.stdout, "")

    def test_impossible_numbers_are_refused(self):
        for text in ("1", "0", "-3", "1001", "12,", "", "twelve", "12;14", "1e3", "99999999999999999999999"):
            self.says(f"--power={text}", *SPEC, says=["--power", "2 to 1000"])
        self.says("--power", "8,12,8", *SPEC, says=["8 is said twice"])
        for text in ("0", "-1", "1000001", "many"):
            self.says("--power", "8", f"--studies={text}", *SPEC, says=["--studies", "1 to 1000000"])

    def test_exclusive_options_are_refused(self):
        self.says("--power", "8", says=["--power", "not said who answers", "--simulate"])
        self.says("--studies", "8", "--dry-run", says=["--studies", "there is no --power"])
        for more in (("--participant", "01"), ("-o", "study"), ("--resume",), ("--dry-run",), ("--print",)):
            self.says("--power", "8", *SPEC, *more, says=["it holds no session"])
        self.assertFalse((self.dir / "study").exists())

    def test_a_wrong_definition_is_refused(self):
        self.write("bad.toml", "[experiment]\n")
        self.refused(2, "experiment", "bad.toml", "--power", "8", *SPEC)

    def test_ctrl_c_ends_it_without_a_result(self):
        # The thread waits for the tool from the start: the signal must come while studies are simulated.
        def pending():
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
            os.kill(os.getpid(), signal.SIGINT)
        result = self.run_tool("experiment", "park2016", "--power", "1000", "--studies", "1000000", *SPEC, before=pending)
        self.assertEqual((result.returncode, result.stdout), (130, ""))
        self.assertIn("ended by a signal, before there was a result", result.stderr)


if __name__ == "__main__":
    main()
