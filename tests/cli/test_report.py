# SPDX-License-Identifier: MIT
"""tactor report: each number against the study's files, differences between participants, marks of simulated data, and
refusals."""
import hashlib
import json
import re
import shutil
import statistics
import sys

import experiments
from experiments import ExperimentTest, contents, read_table
from harness import ROOT, main

sys.path.insert(0, str(ROOT / "tests/study"))
import studies  # noqa: E402

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
        self.assertIn("palm-3x3: 9 tactors in 3 rows and 3 columns, 20 mm from column to column and 20 mm from row to row",
                      apparatus)
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
        self.assertIn("**not measured**", apparatus)
        self.assertIn("Sample rate (Hz): 48000. Channels: 9. Device: none.", apparatus)

    def test_the_plans_are_those_of_the_session(self):
        rows, = tables(section(self.text, "### Motions and plans"))
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
        self.assertIn("Carrier: sine of 250 Hz; the phase ran on through each stimulus; raised-cosine ramps of 0 to 0.002 s",
                      self.text)
        self.assertIn(r"\mathrm{SOA} = 0.32\,d + 0.0473", self.text)
        self.assertIn("SOA 0.07 s, timing fixed", self.text)
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
        self.assertIn(f"Void trials: {voids}, of which had gaps in the sound: {voids};", self.text)

    def test_procedure_is_from_the_definition_and_the_sessions(self):
        procedure = section(self.text, "## Procedure")
        for told in ("Gap between the two stimuli of a choice: 1 s.", "Question: Which of the two moved more evenly in speed?",
                     "Labels of the scale: very uneven, very even", "Break after the run: 60 s", "rated from 1 to 5",
                     "Trials: 40; practice trials before, which do not count: 4",
                     "white noise of -30 dBFS (root mean square), faded over 0.05 s, while stimuli played"):
            self.assertIn(told, procedure)
        for code in ("01", "02", "03"):
            session = self.session(code)
            self.assertIn(f"{', '.join(session['order'])} (sub-{code})", procedure)
            self.assertIn(f"{session['seed']} (sub-{code})", procedure)
        self.assertEqual(procedure.count("of each participant: 5\n"), 4)

    def test_versions_and_hashes_are_given(self):
        data = section(self.text, "### Versions and hashes")
        text = self.one["experiment"]["text"]
        self.assertIn(f"`{hashlib.sha256(text.encode()).hexdigest()}`", data)
        self.assertIn(f"tactor: {self.one['versions']['tactor']} (", data)

    def test_results_are_those_of_analyze(self):
        told = json.loads(self.ok("analyze", "study", "--format", "json").stdout)["runs"]

        def p(value):
            return "p < 0.001" if value < 0.001 else f"p = {value:.3f}"
        for name, run in told.items():
            results = section(self.text, f"### {name} (SIMULATED)")
            if run["task"] == "choose":
                t = run["preference"]["all"]
                self.assertIn(f"park2016 was chosen in {t['mean']:.2f} % (se {t['se']:.2f}, 95 % interval {t['ci'][0]:.2f} ... "
                              f"{t['ci'][1]:.2f}) of trials, against 50 %: t({t['df']:.0f}) = {t['t']:.2f}, {p(t['p'])}", results)
                for row in tables(results)[0]:
                    self.assertEqual(row["mean"], f"{run['preference']['motion'][row['motion']]['mean']:.2f}")
                first = run["first_interval"]
                self.assertIn(f"first interval was chosen in {first['mean']:.2f} %", results)
            else:
                t = run["paired"]
                self.assertIn(f"paired: {t['difference']:.2f} (se ", results)
                self.assertIn(f"t({t['df']:.0f}) = {t['t']:.2f}, {p(t['p'])}", results)
                for row in tables(results)[0]:
                    self.assertEqual(row["mean"], f"{run['means'][row['method']]['motion'][row['motion']]['mean']:.2f}")
            for e in run["anova"].values():
                self.assertIn(f"F({e['df1']:.0f}, {e['df2']:.0f}) = {e['F']:.2f}, {p(e['p'])}", results)

    def test_the_equations_of_both_algorithms_and_their_sources_are_given(self):
        for told in (r"A_i = \sqrt{(1/d_i) / \sum_{j=1}^{3} 1/d_j}\,A_v", r"A_1 = \sqrt{d_2 / (d_1 + d_2)}\,A_v",
                     r"m_{i+1} = (\tau_{i+1} - \tau_i - b + (1 - a)\,m_i) / (1 + a)", "- Israr, A., Poupyrev, I. (2011)",
                     "- Park, J., Kim, J., Oh, Y., Tan, H. Z. (2016)"):
            self.assertIn(told, self.text)

    def test_simulated_data_are_marked_at_the_top_and_at_each_result(self):
        self.assertIn("**SIMULATED: nobody was asked.**", "\n".join(self.text.splitlines()[:4]))
        results = section(self.text, "## Results (SIMULATED)")
        runs = results.partition("### ")[2].partition("### Warnings")[0]
        for line in runs.splitlines():
            if line.startswith("- ") or line.endswith(":") or line.startswith("### "):
                self.assertIn("simulated", line.lower())

    def test_a_file_is_written_whole_and_replaced(self):
        self.write("methods.md", "")
        said = self.ok("report", "study", "-o", "methods.md")
        self.assertEqual((self.dir / "methods.md").read_text(), self.text)
        self.assertEqual(said.stdout, "")
        self.ok("report", "study", "-o", "study/derivatives/tactor/methods.md")
        self.assertEqual((self.dir / "study/derivatives/tactor/methods.md").read_text(), self.text)
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
        self.assertEqual(len(tables(section(text, "### Array"))), 1)  # places are alike

        def moved(told):
            told["array"]["tactors"][8]["x_mm"] = 42.0
            told["level"] = {"sl_db": None, "dbfs": -18.5}
        self.change("02", moved)
        text = self.report("study")
        self.assertEqual(len(tables(section(text, "### Array"))), 2)
        self.assertIn("in no grid, 20 mm from neighbour to neighbour (median)", text)
        self.assertIn("-18.5 dBFS, the same for all tactors but for their gains (sub-02)", text)

    def test_definitions_with_different_questions_are_reported(self):
        def other(told):
            e = told["experiment"]
            e["text"] = e["text"].replace("gap_s = 0.25", "gap_s = 0.5")
            e["sha256"] = hashlib.sha256(e["text"].encode()).hexdigest()
        self.change("01", other)
        text = self.report("study")
        self.assertIn("Gap between the two stimuli of a choice: 0.5 s (sub-01); 0.25 s (sub-02, sub-03).", text)
        self.assertIn("the texts of their experiments differ", text)

    def test_participants_are_those_of_their_table(self):
        path = self.dir / "study/participants.tsv"
        path.write_text("participant_id\tage\tsex\thandedness\nsub-01\t26\tF\tR\nsub-02\t36\tM\tR\nsub-03\tn/a\tF\tL\n"
                        "sub-04\t99\tn/a\tn/a\n")
        text = section(self.report("study", "--exclude", "04"), "## Participants")
        self.assertIn("3 participants: sub-01, sub-02, sub-03. Age: 26 to 36 years, mean 31.0, sd 7.1 (of 2; the others': not "
                      "recorded). Sex: 2 F, 1 M. Handedness: 1 L, 2 R.", text)
        text = self.report("study")
        self.assertIn("sub-04 is among the participants and has no session.", text)
        self.assertIn("sub-04 is left out: no trial that counts", text)
        text = self.report("study", "--participants", "02")
        self.assertIn("1 participant: sub-02. Age: 36 years, mean 36.0. ", text)
        self.assertNotIn("sub-01", text.replace("Excluded from all that follows: sub-01 (not among those selected).", ""))

    def test_names_are_no_markdown_and_steer_no_terminal(self):
        def named(told):
            told["device"] = {"pcm": "hw:0\x1b[2J", "name": "a | b *c*"}
            told["date"] = "2026-11-21T10:00:00Z"
        self.change("01", named)
        text = self.report("study")
        self.assertNotIn("\x1b", text)
        self.assertIn(r"pcm: hw:0\\x1b\[2J, name: a \| b \*c\* (sub-01); none (sub-02, sub-03)", text)
        self.assertIn("Dates of the sessions (UTC): 2026-11-21.", text)

    def test_other_methods_have_their_own_words(self):
        for kind, told in (("barycentric", r"A_i = \sqrt{b_i}"), ("gaussian", r"e^{-d_i^2"), ("linear", "A_i = b_i A_v"),
                           ("log", r"\log_2(1 + b_i)")):
            text = self.small().replace(".toml", "")
            self.write(f"{kind}.toml", (self.dir / f"{text}.toml").read_text().replace(
                'algorithm = "park2016"', f'algorithm = "continuous"\nphantom = "{kind}"\ncarrier = 200'))
            self.simulate("07", definition=f"{kind}.toml", folder=kind)
            text = self.report(kind)
            self.assertIn(told, text)
            self.assertIn("no bursts: the intensities", text)
            self.assertIn("Carrier: sine of 200 Hz, sine of 250 Hz; the phase ran on", text)
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
        self.assertIn("actuators: lra", text)
        self.assertIn("rise times of the actuators, for which bursts begin stronger where they can: tactor 0 0.02 s", text)
        self.assertIn("Thresholds: from the array file, none assumed.", text)


    def test_the_measured_displacement_is_stated_in_um_and_as_an_acceleration(self):
        self.write("own.toml", '[array]\npreset = "palm-3x3"\ndisplacement_um_at_0dbfs = 35.5\n[[tactor]]\ntactor = 4\n'
                               "displacement_um_at_0dbfs = 20\n")
        self.ok("calibrate", "--participant", "04", "-o", "04.toml", "--array", "own.toml", "--simulate", "threshold=-45,spread=2")
        self.simulate("04", "--array", "04.toml", folder="own")
        told = [t["displacement_um_at_0dbfs"] for t in self.session("04", "own")["array"]["tactors"]]
        self.assertEqual(told, [35.5] * 4 + [20] + [35.5] * 4)
        self.assertIn("Peak displacement of a sine at 0 dBFS, as measured: 20 to 35.5 um, which is 49.348 to 87.5927 m/s2 at 250 Hz.",
                      self.report("own"))
        self.simulate("04", folder="other")
        self.assertNotIn("displacement", self.report("other"))

    def test_the_data_of_a_participant_who_withdraws_are_gone(self):
        for code in ("01", "02", "03"):
            self.simulate(code, folder="left")
        for name in ("sub-02", "sourcedata/sub-02"):
            shutil.rmtree(self.dir / "left" / name)
        people = self.dir / "left/participants.tsv"
        people.write_text("".join(line for line in people.read_text().splitlines(True) if not line.startswith("sub-02\t")))
        self.assertFalse([name for name, text in contents(self.dir / "left").items() if b"sub-02" in text or "sub-02" in name])
        told = json.loads(self.ok("analyze", "left", "--format", "json").stdout)
        self.assertEqual((told["participants"], {r["n"] for r in told["runs"].values()}), (2, {2}))
        text = self.report("left")
        self.assertIn("sub-01", text)
        self.assertNotIn("sub-02", text)
        self.assertRegex(text, r"\b2 participants\b")

    def test_the_measurement_of_thresholds_is_described(self):
        self.ok("calibrate", "--participant", "P1", "-o", "P1.toml", "--simulate", "threshold=-45,spread=2")
        made = (self.dir / "P1.toml").read_text()
        date = re.search(r'^date = "(.*)"$', made, re.M)[1]
        said = self.simulate("P1", "--array", "P1.toml", folder="own")
        self.assertIn("the thresholds were simulated", said.stderr)
        told = self.session("P1", "own")["calibration"]
        self.assertEqual({k: told[k] for k in ("participant", "method", "rule", "carrier_hz", "interval_s", "feedback", "masker",
                                               "date", "simulated")},
                         {"participant": "P1", "method": "staircase", "rule": "1up3down", "carrier_hz": 250, "interval_s": 0.5,
                          "feedback": True, "masker": "none", "date": date, "simulated": True})
        self.assertEqual([t["tactor"] for t in told["tactors"]], list(range(9)))
        self.assertIn(f"Calibration: of participant P1, staircase 1up3down, carrier 250 Hz, intervals of 0.5 s, with feedback, "
                      f"masker: none, on {date}, **SIMULATED: nobody was asked**; the thresholds were simulated",
                      self.report("own"))
        self.simulate("02", folder="own")
        self.assertIn("(sub-P1); none (sub-02)", self.report("own"))

    def test_thresholds_of_another_participant_or_carrier_are_reported(self):
        self.ok("calibrate", "--participant", "P1", "-o", "P1.toml", "--carrier", 100, "--simulate", "threshold=-45,spread=2")
        self.write("P1.toml", (self.dir / "P1.toml").read_text().replace("simulated = true", "simulated = false"))
        said = self.simulate("P2", "--array", "P1.toml", folder="others")
        for told in ("of participant P1, not P2", "measured at 100 Hz, and a carrier is 250 Hz"):
            self.assertIn(f"tactor: warning: the thresholds {'were ' if told[0] == 'm' else 'are '}{told}", said.stderr)
            self.assertIn(told, self.report("others"))
        self.assertNotIn("SIMULATED", self.report("others").partition("Calibration:")[2].partition("\n")[0])


class AsItWasHeld(ReportTest):
    """Simulated sessions, changed into those of people."""

    NOISE = '[masking]\nnoise = "white"\nlevel_dbfs = -30\n[[motion]]'
    ASKED = "white noise of -30 dBFS (root mean square), faded over 0.05 s, while stimuli played"

    def hold(self, *streams, **facts):
        """Makes a session for each list of openings of the device."""
        self.small(experiments.SMALL.replace("[[motion]]", self.NOISE, 1))
        codes = [f"{i + 1:02}" for i in range(len(streams))]
        for code in codes:
            self.ok("experiment", "small.toml", "--participant", code, "-o", "study", "--simulate", "seed=1,sigma=1")
        for code, own in zip(codes, streams):
            def real(told, own=own):
                told.update({"simulated": False, "simulation": None, "date": "2026-11-21T09:00:00.000000Z"}, **facts)
                told["streams"] = [{"stream": i + 1, "opened": f"2026-11-2{i + 1}T09:00:00.000000Z", "device": "hw:0",
                                    "masker": None, "masking": None, **one} for i, one in enumerate(own)]
            self.change(code, real)

    def people(self, *rows):
        self.write("study/participants.tsv", "participant_id\tage\tsex\thandedness\n" +
                   "".join(f"sub-{code}\t{age}\tn/a\tn/a\n" for code, age in rows))

    def test_noise_and_animation_are_those_of_the_sessions(self):
        noise = {"masker": "hw:1", "masking": {"noise": "pink", "level_dbfs": -20, "fade_s": 0.1, "while": "run"}}
        self.hold([{"display": "terminal without animation"}], [{"display": "page", **noise}],
                  [{"display": "terminal with animation", "masker": "hw:2"}])  # the last like those of older versions
        text = self.report("study")
        self.assertIn(f"Masking noise: none (the definition asks for {self.ASKED}) (sub-01); pink noise of -20 dBFS (root mean "
                      f"square), faded over 0.1 s, through each run, from hw:1 (sub-02); {self.ASKED}, from hw:2 (sub-03).", text)
        self.assertIn("Animation of the target before the first stimulus: no, the terminal could not show it (the definition "
                      "asks for it) (sub-01); yes, on the page (sub-02); yes, on the terminal (sub-03)\n", text)
        self.assertIn("Animation of the target before the first stimulus: no\n", text)  # the run without animation
        self.assertIn("Display: terminal without animation (sub-01); page (sub-02); terminal with animation (sub-03).", text)
        self.simulate("01", folder="simulated")
        self.assertIn("none: the session was simulated (the definition asks for it)", self.report("simulated"))

    def test_different_openings_of_the_device_are_reported(self):
        self.hold([{"display": "page"}, {"display": "terminal without animation"}])
        beh = self.dir / "study/sub-01/beh/sub-01_task-whichone_beh.tsv"
        head, *lines = beh.read_text().splitlines()
        at = head.split("\t").index("stream")
        rows = [line.split("\t") for line in lines]
        rows[-1][at] = "2"
        beh.write_text("\n".join([head, *("\t".join(r) for r in rows)]) + "\n")
        self.assertIn("yes, on the page (opening 1 of the device), no, the terminal could not show it (opening 2 of the device)",
                      self.report("study"))

    def test_days_and_consent_of_a_session_that_resumed_later(self):
        self.hold([{"display": "page"}] * 3, consent="2026-11-21T08:59:00.000000Z",
                  walk=[{"tactor": i % 9, "asked": f"2026-11-21T08:59:{i + 10}.000000Z"} for i in range(18)])
        text = self.report("study")
        self.assertIn("Dates of the sessions (UTC): 2026-11-21 to 2026-11-23.", text)
        self.assertIn("The session of sub-01 was held on 2026-11-21, 2026-11-22, 2026-11-23.", text)
        self.assertIn("Consent: given on 2026-11-21T08:59:00.000000Z.", text)
        self.assertIn("before the runs: 9 tactors, the last on 2026-11-21T08:59:27.000000Z.", text)

    def test_ages_follow_bids(self):
        for code in ("01", "02", "03", "04"):
            self.simulate(code)
        self.people(("01", "31"), ("02", "89+"), ("03", "n/a"), ("04", "30-39"))
        self.assertIn('Age: 31 to 89 years, mean 60.0, sd 41.0 (1 recorded as at least so old, as 89+, and counted as that) '
                      '(of 2; of 1: not recorded); sub-04: "30-39". Sex', self.report("study"))
        self.people(("01", "inf"), ("02", "nan"), ("03", "-3"), ("04", "n/a"))
        self.assertIn('Age: sub-01: "inf"; sub-02: "nan"; sub-03: "-3". Sex', self.report("study"))

    def test_exclusions_have_their_reasons(self):
        for code in ("01", "02", "03", "04"):
            self.simulate(code)
        text = self.report("study", "--exclude", "sub-02:fell asleep,03")
        self.assertIn("Excluded from all that follows: sub-02 (fell asleep).", text)
        self.assertIn("Excluded from all that follows: sub-03 (no reason was given).", text)
        self.assertIn("sub-04 (not among those selected)", self.report("study", "--participants", "01,02,03"))
        self.assertNotIn("Excluded", self.report("study"))
        self.assertIn("excluded: sub-02 (fell asleep)", self.ok("analyze", "study", "--exclude", "02:fell asleep").stdout)

    def test_void_trials_that_did_not_come_again_are_counted(self):
        self.simulate("01", spec="seed=1,sigma=1,void=0.5")
        self.assertIn("they do not count. All of them came again.", self.report("study"))
        beh = self.dir / "study/sub-01/beh/sub-01_task-howgood_beh.tsv"
        head, *lines = beh.read_text().splitlines()
        last = max(i for i, line in enumerate(lines) if "\ttrue\t" in line)
        beh.write_text("\n".join([head, *lines[:last + 1]]) + "\n")  # broken off after a void one
        self.assertRegex(self.report("study"), r"they do not count. \d+ of them came again, [1-9]\d* did not\.")

    def test_missing_thresholds_are_fine_where_the_level_needs_none(self):
        self.small(experiments.SMALL.replace("gap_s = 0.25", "gap_s = 0.25\nlevel = { dbfs = -20 }"))
        self.ok("experiment", "small.toml", "--participant", "01", "-o", "study", "--simulate", "seed=1,sigma=1")
        levels = section(self.report("study"), "### Levels and thresholds")
        self.assertIn("Thresholds: not used: the level is in dBFS.", levels)
        self.assertNotIn("| none |", levels)
        self.assertNotIn("threshold (dBFS)", levels)

    def test_papers_that_the_text_names_are_listed_and_no_others(self):
        self.simulate("01")
        self.assertNotIn("Yun", self.report("study"))
        self.small(experiments.SMALL.replace('algorithm = "park2016"', 'algorithm = "park2016"\nphantom = "gaussian"'))
        self.ok("experiment", "small.toml", "--participant", "01", "-o", "other", "--simulate", "seed=1,sigma=1")
        self.assertIn("- Yun, G.", self.report("other"))
        text = self.report("other")
        named, _, listed = text.partition("## References")
        for name in re.findall(r"^- (\w+)", listed, re.M):
            self.assertIn(name, named)


class OtherStudies(ReportTest):
    def test_data_of_other_programs_are_reported_as_far_as_they_go(self):
        for name, make in studies.STUDIES.items():
            make(self.dir / name)
            text = self.report(name)
            self.assertIn("Level: not recorded. Thresholds: not recorded.", text)
            self.assertIn("The stimuli are not recorded.", text)
            for told in ("0.32", "250 Hz", "48000", "20 mm"):
                self.assertNotIn(told, text.partition("## Data")[0], name)
            self.assertNotIn("nan", re.findall(r"\w+", text.lower()), name)
            self.assertEqual("SIMULATED" in text, name == "simulated")
        self.assertIn("Void trials: 144, of which had gaps in the sound: not recorded;", self.report("simulated"))
        text = self.report("missing")
        self.assertIn("sub-Late is among the participants and has no session.", text)
        self.assertIn("sub-E5 is left out: no trial that counts in some of the cells.", text)
        answers = tables(section(self.report("three-by-three"), "### which"))
        told = json.loads(self.ok("analyze", "three-by-three", "--format", "json").stdout)["runs"]["which"]["confusion"]
        self.assertEqual({row["motion, then its answers"]: {k: int(row[k]) for k in ("motion-1", "motion-2", "motion-3")}
                          for row in answers[1]}, told["tactile-brush"])


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
        self.refused(2, "report")
        self.refused(2, "report", "none")
        self.refused(2, "report", self.dir)
        self.refused(2, "report", "study", "-o", "study/participants.tsv")
        self.refused(2, "report", "study", "-o", "nowhere/m.md")
        self.refused(2, "report", "study", "-o", "/dev/full")
        self.refused(2, "report", "study", "--exclude", "01")
        self.write("study/sub-01/beh/sub-01_task-whichone_beh.tsv", "half")
        self.says("sub-01_task-whichone_beh.tsv")

    def test_changes_after_the_session_are_reported(self):
        good = (self.dir / "study/sourcedata/sub-01/session.json").read_text()
        for change, why in (
                (lambda t: t["experiment"].update(text=t["experiment"]["text"] + "# more\n"), "its SHA-256 is"),
                (lambda t: t["array"]["tactors"][3].update(x_mm="left"), "array.tactors[3].x_mm: is no number"),
                (lambda t: t["array"]["tactors"][3].pop("y_mm"), "array.tactors[3].y_mm: is missing"),
                (lambda t: t["array"].update(tactors=7), "array.tactors: is no list"),
                (lambda t: t["array"]["tactors"][3].update(channel=-1), "array.tactors[3].channel: is no whole number"),
                (lambda t: t["array"]["tactors"][3].update(polarity=1e300), "array.tactors[3].polarity: is no whole number"),
                (lambda t: t["array"]["tactors"][3].update(actuator="pump"), 'session.json: array.tactors[3].actuator: is "pump", which is not known'),
                (lambda t: t["array"]["tactors"][3].update(x_mm=20.0), "session.json: array: is none: "),
                (lambda t: t["thresholds_dbfs"].__setitem__(2, [[250]]), "thresholds_dbfs[2][0]: is no frequency"),
                (lambda t: t.update(level=[7]), "level: is no object"),
                (lambda t: t.update(order=[7]), "order[0]: is no text"),
                (lambda t: t.update(thresholds_assumed="yes"), "thresholds_assumed: is neither true nor false"),
                (lambda t: t["stimuli"][0].update(sha256="../../../passwd"), "passwd.json"),
                (lambda t: t["stimuli"].pop(0), "plan_1 is no plan of its motion by its method")):
            self.change("01", change)
            self.says(why)
            self.write("study/sourcedata/sub-01/session.json", good)
        self.ok("report", "study")

    def test_a_changed_or_lost_plan_is_reported(self):
        plan = sorted((self.dir / "study/sourcedata/sub-01/plans").iterdir())[0]
        text = plan.read_bytes()
        plan.write_bytes(text + b"\n")
        self.says(plan.name, "its SHA-256 is")
        plan.unlink()
        self.says(plan.name, "No such file")
        plan.write_bytes(text)
        beh = self.dir / "study/sub-01/beh/sub-01_task-howgood_beh.tsv"
        rows = read_table(beh)
        table = beh.read_text()
        other = next(r["plan_1"] for r in rows if r["plan_1"] != rows[0]["plan_1"])
        beh.write_text(table.replace(rows[0]["plan_1"], other, 1))
        self.says("sub-01_task-howgood_beh.tsv:2: plan_1 is no plan of its motion")
        beh.write_text(table)
        self.ok("report", "study")

    def test_a_failing_disk_leaves_the_old_file(self):
        self.write("locked/m.md", "old")
        shutil.copytree(self.dir / "study", self.dir / "locked/study")
        self.refused(2, "report", "study", "-o", "locked/m.md/x.md")
        self.assertEqual((self.dir / "locked/m.md").read_text(), "old")


if __name__ == "__main__":
    main()
