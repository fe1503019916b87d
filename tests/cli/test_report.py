# SPDX-License-Identifier: MIT
"""tactor report: each number against the study's files, differences between participants, marks of simulated data, and
refusals."""
import hashlib
import json
import re
import shutil
import statistics

import experiments
from experiments import ExperimentTest, contents, read_table
from harness import main
import studies

RUNS = ("similarity", "uniformity", "similarityrating", "uniformityrating")


def section(text, heading):
    """Returns the text from a heading to the next of the same rank or above."""
    rank = heading.split(" ")[0]
    found = re.search(rf"^{re.escape(heading)}[^\n]*\n(.*?)(?=^#{{1,{len(rank)}}} |\Z)", text, re.M | re.S)
    assert found, f"no {heading}"
    return found[1]


def tables(text):
    """Returns each table as a list of dicts by the head's cells."""
    found = []
    for block in re.findall(r"(?:^\|.*\n)+", text, re.M):
        head, _, *rows = ([c.strip() for c in line.strip("|").split(" | ")] for line in block.splitlines())
        found.append([dict(zip(head, row)) for row in rows])
    return found


class ReportTest(ExperimentTest):
    def report(self, *args):
        return self.ok("report", *args).stdout

    def change(self, code, change, folder="study"):
        """Rewrites a session with change(its JSON)."""
        path = self.dir / folder / f"sourcedata/sub-{code}/session.json"
        told = json.loads(path.read_text())
        change(told)
        path.write_text(json.dumps(told))

    def plans(self, code, folder="study"):
        return {p.stem: json.loads(p.read_text()) for p in (self.dir / folder / f"sourcedata/sub-{code}/plans").iterdir()}


class Numbers(ReportTest):
    made = None  # sessions wait for the disk at each line: once is enough for all

    def setUp(self):
        super().setUp()
        if Numbers.made is None:
            for code in ("01", "02", "03"):
                self.simulate(code, definition="park2016", spec="seed=1,sigma=1,void=0.05")
            Numbers.made = contents(self.dir / "study")
        for name, data in Numbers.made.items():
            self.write(f"study/{name}", data)
        self.text = self.report("study")
        self.one = self.session("01")

    def test_the_array_is_the_session_s(self):
        apparatus = section(self.text, "## Apparatus")
        self.assertIn("Array: palm-3x3, 9 tactors.", apparatus)
        places, thresholds = tables(apparatus)
        self.assertEqual(len(places), 9)
        for row, tactor in zip(places, self.one["array"]["tactors"]):
            for shown, key in (("x (mm)", "x_mm"), ("y (mm)", "y_mm"), ("channel", "channel"), ("polarity", "polarity"),
                               ("gain (dB)", "gain_db"), ("limit (dBFS)", "max_dbfs")):
                self.assertEqual(float(row[shown]), tactor[key])
        self.assertEqual([r["threshold (dBFS)"] for r in thresholds], ["sub-01", "sub-02", "sub-03", "mean (sd)"])
        for i, v in enumerate(self.one["thresholds_dbfs"]):
            self.assertEqual(float(thresholds[0][f"tactor {i}"]), v)
        self.assertIn(f"{self.one['level']['sl_db']:g} dB SL", apparatus)
        self.assertIn("assumed, not measured", apparatus)
        self.assertIn("Sample rate (Hz): 48000. Channels: 9. Device: none.", apparatus)

    def test_the_plans_are_those_of_the_session(self):
        rows, = tables(section(self.text, "## Stimuli"))
        plans, stimuli = self.plans("01"), self.one["stimuli"]
        self.assertEqual(len(rows), len(stimuli))
        for row, told in zip(rows, stimuli):
            self.assertEqual((row["motion"], row["method"]), (told["motion"], told["method"]))
            self.assertEqual(row["SHA-256 of the plan"], f"`{told['sha256']}`")
            plan = plans[told["sha256"]]
            for shown, value in (("target (s)", plan["stroke"]["duration_s"]), ("length (mm)", plan["stroke"]["length_mm"]),
                                 ("sound (s)", plan["total_s"])):
                self.assertAlmostEqual(float(row[shown]) / value, 1, 5)
            self.assertEqual(row["SOA (s)"], "-" if plan["soa_s"] is None else f"{plan['soa_s']:g}")
            self.assertEqual(int(row["overlaps"]), len(plan["conflicts"]))
            durations = [b["duration_s"] for b in plan["bursts"]]
            shown = re.fullmatch(r"(\d+) of (\S+)(?: to (\S+))? s", row["bursts"])
            self.assertEqual(int(shown[1]), len(durations))
            self.assertAlmostEqual(float(shown[2]), min(durations), 5)
            self.assertAlmostEqual(float(shown[3] or shown[2]), max(durations), 5)
        self.assertIn(r"Carrier: sine, carrier\_hz 250, phase stroke, raised-cosine ramps; ramps of 0 to 0.002 s", self.text)
        self.assertIn(r"\mathrm{SOA} = 0.32\,d + 0.0473", self.text)
        self.assertIn("algorithm park2016, phantom inverse-distance, faces delaunay, soa 0.07, slope 0.32", self.text)
        self.assertIn("reconstructed: the figure that shows it", self.text)

    def test_trials_and_voids_are_counted_from_the_tables(self):
        counts, = tables(section(self.text, "## Data"))
        voids = 0
        for row in counts:
            code = row["participant"][4:]
            for name, column in zip(RUNS, list(row)[1:]):
                trials = self.rows(code, name)
                bad = [t for t in trials if t["void"] == "true"]
                voids += len(bad)
                self.assertEqual(row[column], f"{len(trials) - len(bad)} / {len(bad)} / "
                                              f"{sum(int(t['xruns']) > 0 for t in bad)}")
        self.assertGreater(voids, 3)

    def test_procedure_is_from_the_definition_and_the_sessions(self):
        procedure = section(self.text, "## Procedure")
        for told in ("Gap between the two stimuli of a trial: 1 s.", "Question: Which of the two moved more evenly in speed?",
                     "Labels of the scale: very uneven, very even", "Break after the run: 60 s", "rated from 1 to 5",
                     "Trials: 40; practice trials before, which do not count: 4", "sooner after the stimulus than: 0.15 s"):
            self.assertIn(told, procedure)
        for row, code in zip(tables(procedure)[0], ("01", "02", "03"), strict=True):
            session = self.session(code)
            self.assertEqual((row["participant"], row["order of the runs"], row["seed"], row["display"]),
                             (f"sub-{code}", ", ".join(session["order"]), str(session["seed"]), "simulated"))

    def test_versions_and_hashes_are_given(self):
        data = section(self.text, "## Data")
        text = self.one["experiment"]["text"]
        self.assertIn(f"definition: {hashlib.sha256(text.encode()).hexdigest()}\n", data)
        self.assertIn(f"tactor: {self.one['versions']['tactor']} (", data)

    def test_results_are_those_of_analyze(self):
        told = self.analysis()["runs"]

        def four(value):
            return "" if value is None else f"{round(value, 12) + 0.0:.4g}"
        for name, run in told.items():
            results = section(self.text, f"### {name} (SIMULATED)")
            found = tables(results)
            self.assertIn(f"Participants: 3. Trials that count: {run['trials']}.", results)
            if run["task"] == "choose":
                for row, t in zip(found[0], [run["preference"]["all"], *run["preference"]["motion"].values()], strict=True):
                    self.assertEqual([row[k] for k in ("mean", "se", "t", "df")], [four(t[k]) for k in ("mean", "se", "t", "df")])
                    self.assertAlmostEqual(float(row["p"]), t["p"], 4)
                    self.assertEqual(row["95 % interval"], " to ".join(four(min(max(v, 0), 100)) for v in t["ci"]))
                first = run["first_interval"]
                self.assertIn(f"first interval was chosen in {four(first['mean'])} %", results)
            else:
                t = run["paired"]
                self.assertIn(f"paired: {four(t['difference'])}, 95 %\ninterval {four(t['ci'][0])} to", results)
                self.assertIn(f"t({four(t['df'])}) = {four(t['t'])}", results)
                for table, means in zip(found, run["means"].values()):
                    self.assertEqual([row["mean"] for row in table],
                                     [four(t["mean"]) for t in (means["all"], *means["motion"].values())])
            effects = next(t for t in found if "effect" in t[0])
            self.assertEqual([(r["effect"], r["F"], r["epsilon (HF)"]) for r in effects],
                             [(n, four(e["F"]), four(e["epsilon_hf"])) for n, e in run["anova"].items()])
            tukey = run["tukey"] if run["task"] == "choose" else [p for pairs in run["tukey"].values() for p in pairs]
            self.assertEqual([(r["pair"], r["difference"]) for t in found if "pair" in t[0] for r in t],
                             [(f"{p['a']} - {p['b']}", four(p["difference"])) for p in tukey])

    def test_the_equations_of_both_algorithms_and_their_sources_are_given(self):
        for told in (r"A_i = \sqrt{(1/d_i) / \sum_{j=1}^{3} 1/d_j}\,A_v", r"A_1 = \sqrt{d_2 / (d_1 + d_2)}\,A_v",
                     r"m_{i+1} = (\tau_{i+1} - \tau_i - b + (1 - a)\,m_i) / (1 + a)", "- Israr, A., Poupyrev, I. (2011)",
                     "- Park, J., Kim, J., Oh, Y., Tan, H. Z. (2016)"):
            self.assertIn(told, self.text)

    def test_simulated_data_are_marked_at_the_top_and_at_each_result(self):
        self.assertIn("**SIMULATED: no person answered.**", "\n".join(self.text.splitlines()[:4]))
        results = section(self.text, "## Results (SIMULATED)")
        runs = results.partition("### ")[2]
        for line in runs.splitlines():
            if line.endswith(":") or line.startswith("### "):
                self.assertIn("simulated", line.lower())

    def test_a_file_is_written_whole_and_replaced(self):
        self.write("methods.md", "")
        said = self.ok("report", "study", "-o", "methods.md")
        self.assertRegex((self.dir / "methods.md").read_text().removeprefix(self.text), r"\A\n<!-- sha256 [0-9a-f]{64}.*-->\n\Z")
        self.assertEqual(said.stdout, "")
        self.ok("report", "study", "-o", "study/derivatives/tactor/methods.md")
        self.assertTrue((self.dir / "study/derivatives/tactor/methods.md").read_text().startswith(self.text))
        self.assertEqual(self.report("study"), self.text)


class Differences(ReportTest):
    def setUp(self):
        super().setUp()
        for code in ("01", "02", "03"):
            self.simulate(code)

    def test_mixed_versions_are_given_with_their_participants(self):
        def older(told):
            told["versions"] = {"tactor": "0.0.9", "build": "an older one"}
        self.change("02", older)
        own = self.session("01")["versions"]["tactor"]
        self.assertRegex(self.report("study"), rf"- tactor: {re.escape(own)} \(.*\) \(sub-01, sub-03\); 0\.0\.9 \(an older one\) \(sub-02\)")

    def test_different_thresholds_levels_and_arrays_are_reported(self):
        def measured(told):
            told["thresholds_assumed"] = False
            for i, t in enumerate(told["array"]["tactors"]):
                t["threshold_dbfs"] = -40.5 - i
            told["thresholds_dbfs"] = [-40.5 - i for i in range(9)]
        self.change("03", measured)
        text = self.report("study")
        self.assertIn("tactors without one (sub-01, sub-02); from the array file, none assumed (sub-03)", text)
        rows = tables(section(text, "### Levels and thresholds"))[0]
        self.assertEqual(rows[2]["tactor 4"], "-44.5")
        of_4 = [-40, -40, -44.5]
        self.assertEqual(rows[3]["tactor 4"], f"{statistics.mean(of_4):.2f} ({statistics.stdev(of_4):.2f})")
        self.assertEqual(len(tables(section(text, "### Array and sound"))), 1)  # places are alike

        def moved(told):
            told["array"]["tactors"][8]["x_mm"] = 42.0
            told["level"] = {"sl_db": None, "dbfs": -18.5}
        self.change("02", moved)
        text = self.report("study")
        self.assertEqual(len(tables(section(text, "### Array and sound"))), 2)
        self.assertIn("Tactors of sub-02:", text)
        self.assertIn("-18.5 dBFS, the same for all tactors except for their gains (sub-02)", text)

    def test_definitions_with_different_questions_are_reported(self):
        def other(told):
            e = told["experiment"]
            e["text"] = e["text"].replace("gap_s = 0.25", "gap_s = 0.5")
            e["sha256"] = hashlib.sha256(e["text"].encode()).hexdigest()
        self.change("01", other)
        text = self.report("study")
        self.assertIn("Gap between the two stimuli of a trial: 0.5 s (sub-01); 0.25 s (sub-02, sub-03).", text)
        self.assertIn("the texts of their experiments differ", text)

    def test_participants_are_those_of_their_table(self):
        path = self.dir / "study/participants.tsv"
        path.write_text("participant_id\tage\tsex\thandedness\nsub-01\t26\tF\tR\nsub-02\t36\tM\tR\nsub-03\tn/a\tF\tL\n"
                        "sub-04\t99\tn/a\tn/a\n")
        text = section(self.report("study", "--exclude", "04"), "## Participants")
        self.assertIn("3 participants: sub-01, sub-02, sub-03. Age: 26 to 36 years, mean 31.0, sd 7.1, of 2 participants; 1 not "
                      "recorded. Sex: 2 F, 1 M. Handedness: 1 L, 2 R.", text)
        self.assertIn("Left out: sub-04 (no trial counts", self.report("study"))
        text = self.report("study", "--participants", "02")
        self.assertIn("1 participant: sub-02. Age: 36 years, mean 36.0. ", text)
        self.assertNotIn("sub-01", text.replace("Excluded: sub-01 (not among those selected).", ""))

    def test_names_are_no_markdown_and_steer_no_terminal(self):
        def named(told):
            told["device"] = {"pcm": "hw:0\x1b[2J", "name": "a | b *c*"}
            told["date"] = "2026-11-21T10:00:00Z"
        self.change("01", named)
        text = self.report("study")
        self.assertNotIn("\x1b", text)
        self.assertIn(r"pcm: hw:0\\x1b\[2J, name: a \| b \*c\* (sub-01); none (sub-02, sub-03)", text)
        self.assertEqual(tables(section(text, "### As it was held"))[0][0]["days (UTC)"], "2026-11-21")

    def test_other_methods_have_their_own_words(self):
        for kind, told in (("barycentric", r"A_i = \sqrt{b_i}"), ("gaussian", r"e^{-d_i^2"), ("linear", "A_i = b_i A_v"),
                           ("log", r"\log_2(1 + b_i)")):
            self.write(f"{kind}.toml", experiments.SMALL.replace(
                'algorithm = "park2016"', f'algorithm = "continuous"\nphantom = "{kind}"\ncarrier = 200'))
            self.simulate("07", definition=f"{kind}.toml", folder=kind)
            text = self.report(kind)
            self.assertIn(told, text)
            self.assertIn("No bursts: the intensities", text)
            self.assertIn(r"Carrier: sine, carrier\_hz 200, phase stroke, raised-cosine ramps; sine, carrier\_hz 250", text)
        self.assertIn("| continuous |", text)

    def test_other_keys_of_an_array_file_are_reported(self):
        tactor = '[[tactor]]\nx_mm = {}\ny_mm = {}\nchannel = {}\nthreshold_dbfs = {}\nactuator = "lra"\nrise_ms = 20\n'
        self.write("own.toml", '[array]\nname = "own"\n' + "".join(
            tactor.format(20 * (i % 3), 20 * (i // 3), i, "[[100, -40], [250, -50.5]]" if i == 4 else f"-{40 + i}.25") for i in range(9)))
        self.simulate("04", "--array", "own.toml", folder="other")
        text = self.report("other")
        rows = tables(section(text, "### Levels and thresholds"))[0]
        self.assertEqual((rows[0]["tactor 3"], rows[0]["tactor 4"]), ("-43.25", "-40 at 100 Hz, -50.5 at 250 Hz"))
        self.assertEqual((rows[1]["tactor 3"], rows[1]["tactor 4"]), ("-43.25", "none"))
        self.assertEqual({row["actuator"] for row in tables(section(text, "### Array and sound"))[0]}, {"lra"})
        self.assertIn("tactor 0 rises in 0.02 s", text)
        self.assertIn("Thresholds: from the array file, none assumed.", text)

    def test_the_measured_displacement_is_stated_in_um_and_as_an_acceleration(self):
        self.write("own.toml", '[array]\npreset = "palm-3x3"\ndisplacement_um_at_0dbfs = 35.5\n[[tactor]]\ntactor = 4\n'
                               "displacement_um_at_0dbfs = 20\n")
        self.ok("calibrate", "--participant", "04", "-o", "04.toml", "--array", "own.toml", "--simulate", "threshold=-45,spread=2")
        self.simulate("04", "--array", "04.toml", folder="own")
        told = [t["displacement_um_at_0dbfs"] for t in self.session("04", "own")["array"]["tactors"]]
        self.assertEqual(told, [35.5] * 4 + [20] + [35.5] * 4)
        text = self.report("own")
        self.assertIn("Peak acceleration of a sine at 0 dBFS, from the displacement: 49.348 to 87.5927 m/s2 at 250 Hz.", text)
        self.assertEqual([float(row["displacement at 0 dBFS (um)"]) for row in tables(section(text, "### Array and sound"))[0]], told)
        self.simulate("04", folder="other")
        self.assertNotIn("acceleration", self.report("other"))

    def test_the_data_of_a_participant_who_withdraws_are_gone(self):
        for name in ("sub-02", "sourcedata/sub-02"):
            shutil.rmtree(self.dir / "study" / name)
        people = self.dir / "study/participants.tsv"
        people.write_text("".join(line for line in people.read_text().splitlines(True) if not line.startswith("sub-02\t")))
        self.assertFalse([name for name, text in contents(self.dir / "study").items() if b"sub-02" in text or "sub-02" in name])
        told = self.analysis()
        self.assertEqual((told["participants"], {r["n"] for r in told["runs"].values()}), (2, {2}))
        text = self.report("study")
        self.assertIn("sub-01", text)
        self.assertNotIn("sub-02", text)
        self.assertRegex(text, r"\b2 participants\b")

    def test_the_measurement_of_thresholds_is_described(self):
        self.ok("calibrate", "--participant", "P1", "-o", "P1.toml", "--simulate", "threshold=-45,spread=2")
        made = (self.dir / "P1.toml").read_text()
        date = re.search(r'^date = "(.*)"$', made, re.M)[1]
        said = self.simulate("P1", "--array", "P1.toml", folder="own")
        self.assertIn("the thresholds are simulated", said.stderr)
        told = self.session("P1", "own")["calibration"]
        self.assertEqual({k: told[k] for k in ("participant", "method", "rule", "carrier_hz", "interval_s", "feedback", "masker",
                                               "date", "simulated")},
                         {"participant": "P1", "method": "staircase", "rule": "1up3down", "carrier_hz": 250, "interval_s": 0.5,
                          "feedback": True, "masker": "none", "date": date, "simulated": True})
        self.assertEqual([t["tactor"] for t in told["tactors"]], list(range(9)))
        self.simulate("02", folder="own")
        row, = tables(section(self.report("own"), "### Levels and thresholds"))[1]
        self.assertEqual(row, {"thresholds of": "sub-P1", "measured with": "P1", "method": "staircase", "rule": "1up3down",
                               "carrier (Hz)": "250", "interval (s)": "0.5", "feedback": "true", "masker": "none", "date": date,
                               "simulated": "true", "warnings": "the thresholds are simulated, not measured"})

    def test_thresholds_of_another_participant_or_carrier_are_reported(self):
        self.ok("calibrate", "--participant", "P1", "-o", "P1.toml", "--carrier", 100, "--simulate", "threshold=-45,spread=2")
        self.write("P1.toml", (self.dir / "P1.toml").read_text().replace("simulated = true", "simulated = false"))
        said = self.simulate("P2", "--array", "P1.toml", folder="others")
        for told in ("belong to participant P1, but this is a session of P2", "were measured at 100 Hz, but a carrier is 250 Hz"):
            self.assertIn(f"tactor: warning: the thresholds {told}", said.stderr)
            self.assertIn(told, self.report("others"))
        row, = tables(section(self.report("others"), "### Levels and thresholds"))[1]
        self.assertEqual((row["carrier (Hz)"], row["simulated"]), ("100", "false"))


class AsItWasHeld(ReportTest):
    def test_noise_display_days_and_consent_are_those_of_the_sessions(self):
        definition = self.small(experiments.SMALL.replace("[[motion]]", '[masking]\nnoise = "white"\nlevel_dbfs = -30\n[[motion]]', 1))
        noise = {"masker": "hw:1", "masking": {"noise": "pink", "level_dbfs": -20, "fade_s": 0.1, "while": "run"}}
        page, terminal = {"display": "page"}, {"display": "terminal without animation"}
        openings = {"01": [terminal], "02": [page | noise] * 3, "03": [page, terminal]}
        for code in openings:
            self.simulate(code, definition=definition)

        def real(told, streams):
            told.update(simulated=False, simulation=None, date="2026-11-21T09:00:00.000000Z", consent="2026-11-21T08:59:00.000000Z",
                        walk=[{"tactor": i % 9, "asked": f"2026-11-21T08:59:{i + 10}.000000Z"} for i in range(18)])
            told["streams"] = [{"stream": i + 1, "opened": f"2026-11-2{i + 1}T09:00:00.000000Z", "device": "hw:0", "masker": None, "masking": None, **one}
                               for i, one in enumerate(streams)]
        for code, streams in openings.items():
            self.change(code, lambda told, streams=streams: real(told, streams))
        text = section(self.report("study"), "### As it was held")
        keys = ("days (UTC)", "consent", "tactors confirmed before", "display", "masking noise", "its device")
        self.assertEqual([[row[k] for k in keys] for row in tables(text)[0]], [
            ["2026-11-21", "2026-11-21T08:59:00.000000Z", "9", "terminal without animation", "none", "none"],
            ["2026-11-21, 2026-11-22, 2026-11-23", "2026-11-21T08:59:00.000000Z", "9", "page",
             r"noise: pink, level\_dbfs: -20, fade\_s: 0.1, while: run", "hw:1"],
            ["2026-11-21, 2026-11-22", "2026-11-21T08:59:00.000000Z", "9", "page; terminal without animation", "none", "none"]])

    def test_ages_that_are_no_numbers_and_exclusions_are_given_as_they_are(self):
        for code in ("01", "02", "03", "04"):
            self.simulate(code)
        self.write("study/participants.tsv", "participant_id\tage\tsex\thandedness\n" + "".join(
            f"sub-{code}\t{age}\tn/a\tn/a\n" for code, age in (("01", "31"), ("02", "89+"), ("03", "n/a"), ("04", "nan"))))
        self.assertIn("Age: 31 years, mean 31.0, of 1 participant; 1 89+; 1 nan; 1 not recorded. Sex", self.report("study"))
        text = self.report("study", "--exclude", "sub-02:fell asleep,03")
        self.assertIn("Excluded: sub-02 (fell asleep).", text)
        self.assertIn("Excluded: sub-03 (no reason was given).", text)
        self.assertIn("sub-04 (not among those selected)", self.report("study", "--participants", "01,02,03"))
        self.assertNotIn("Excluded", self.report("study"))
        self.assertIn("excluded: sub-02 (fell asleep)", self.ok("analyze", "study", "--exclude", "02:fell asleep").stdout)

    def test_missing_thresholds_are_fine_where_the_level_needs_none(self):
        self.simulate(definition=self.small(experiments.SMALL.replace("gap_s = 0.25", "gap_s = 0.25\nlevel = { dbfs = -20 }")))
        levels = section(self.report("study"), "### Levels and thresholds")
        self.assertIn("Thresholds: not used: the level is in dBFS.", levels)
        self.assertNotIn("| none |", levels)
        self.assertNotIn("threshold (dBFS)", levels)


class OtherStudies(ReportTest):
    def test_data_of_other_programs_are_reported_as_far_as_they_go(self):
        for name, make in studies.STUDIES.items():
            make(self.dir / name)
            text = self.report(name)
            self.assertIn("Level: not recorded. Thresholds: not recorded.", text)
            self.assertIn("The stimuli are not recorded.", text)
            for told in ("0.32", "250", "48000"):
                self.assertNotIn(told, text.partition("## Data")[0], name)
            self.assertNotIn("nan", re.findall(r"\w+", text.lower()), name)
            self.assertEqual("SIMULATED" in text, name == "simulated")
        self.assertIn("/ not recorded |", section(self.report("simulated"), "## Data"))
        self.assertIn("Left out: sub-E5 (no trial counts in some of the cells).", self.report("missing"))
        answers = tables(section(self.report("three-by-three"), "### which"))
        which = json.loads(self.ok("analyze", "three-by-three", "--format", "json").stdout)["runs"]["which"]
        counted = next(t for t in answers if "motion-1" in t[0])
        self.assertEqual({row["motion"]: {k: int(row[k]) for k in ("motion-1", "motion-2", "motion-3")} for row in counted},
                         which["confusion"]["tactile-brush"])
        pairs = [p for method in which["pairs"].values() for p in method]
        shown = [r for t in answers if "pair" in t[0] for r in t]
        self.assertEqual([r["pair"] for r in shown], [f"{p['a']} - {p['b']}" for p in pairs])
        for row, pair in zip(shown, pairs):
            self.assertAlmostEqual(float(row["p (Holm)"]), pair["p_holm"], 3)


class Refusals(ReportTest):
    def setUp(self):
        super().setUp()
        self.simulate()

    def says(self, *texts):
        for more in ((), ("-o", "never.md")):
            result = self.refused(2, "report", "study", *more, says=texts)
            self.assertEqual(result.stdout, "")
        self.assertFalse((self.dir / "never.md").exists())

    def test_impossible_folders_and_names_are_refused(self):
        for args in ((), ("none",), (self.dir,), ("study", "--exclude", "01"), *(("study", "-o", file) for file in (
                "study/participants.tsv", "nowhere/m.md", "/dev/full"))):
            self.refused(2, "report", *args)
        self.write("study/sub-01/beh/sub-01_task-whichone_beh.tsv", "half")
        self.says("sub-01_task-whichone_beh.tsv")

    def test_changes_after_the_session_are_reported(self):
        good = (self.dir / "study/sourcedata/sub-01/session.json").read_text()
        for change, why in (
                (lambda t: t["experiment"].update(text=t["experiment"]["text"] + "# more\n"), "it has changed since the session"),
                (lambda t: t["array"].update(tactors=7), "array.tactors: it is not a list"),
                (lambda t: t["thresholds_dbfs"].__setitem__(2, [[250]]), "thresholds_dbfs[2][0]: it is not a frequency"),
                (lambda t: t.update(level=[7]), "level: it is not an object"),
                (lambda t: t.update(thresholds_assumed="yes"), "thresholds_assumed: it is neither true nor false"),
                (lambda t: t["stimuli"][0].update(sha256="../../../passwd"), "passwd.json"),
                (lambda t: t["stimuli"].pop(0), "plan_1 is not one of the plans in session.json for this motion")):
            self.change("01", change)
            self.says(why)
            self.write("study/sourcedata/sub-01/session.json", good)
        self.ok("report", "study")

    def test_a_changed_or_lost_plan_is_reported(self):
        plan = sorted((self.dir / "study/sourcedata/sub-01/plans").iterdir())[0]
        text = plan.read_bytes()
        plan.write_bytes(text + b"\n")
        self.says(plan.name, "it has changed since the session")
        plan.unlink()
        self.says(plan.name, "No such file")
        plan.write_bytes(text)
        beh = self.dir / "study/sub-01/beh/sub-01_task-howgood_beh.tsv"
        rows = read_table(beh)
        table = beh.read_text()
        other = next(r["plan_1"] for r in rows if r["plan_1"] != rows[0]["plan_1"])
        beh.write_text(table.replace(rows[0]["plan_1"], other, 1))
        self.says("sub-01_task-howgood_beh.tsv:2: plan_1 is not one of the plans")
        beh.write_text(table)
        self.ok("report", "study")


if __name__ == "__main__":
    main()
