# SPDX-License-Identifier: MIT
"""tactor experiment: tracks that end early, and tracks of several procedures. The values and the ends of tracks are compared
with a second QUEST+ and a second staircase, which are written here."""
import json
import math

from experiments import BARE, DESK, ExperimentTest, PersonTest, Terminal, contents
from harness import main
from studies import measures, toml

RANGE = (-40, -8)
LEVELS = dict(question="Which was stronger?", methods=["park"], vary="level_dbfs", range=list(RANGE))
COMPARED = dict(LEVELS, task="adaptive", standard=-24)
RUNS = {name: toml("run", name, **keys) for name, keys in {
    "bayes": dict(COMPARED, procedure="quest", stop_sd=2, trials=120, tracks=2),
    "endless": dict(COMPARED, procedure="quest", trials=40, tracks=2),
    "stairs": dict(COMPARED, procedure="1up2down", reversals=6, trials=200, methods=["park", "soft"], steps=[4, 2]),
    "felt": dict(LEVELS, task="interval", procedure=["quest", "1up3down"], stop_sd=3.5, reversals=5, steps=[4, 2], trials=160),
    "mixed": dict(COMPARED, procedure=["1up2down", "quest", "1up2down"], trials=60),
}.items()}
# An observer with void trials.
WHO = "seed={},pse=-24,jnd=4,void=0.1"


def adaptive(*names):
    """Returns the definition with the runs of these names."""
    return measures("desk.toml", *(RUNS[name] for name in names), keys="gap_s = 0.1\n")


def phi(z):
    return 0.5 * math.erfc(-z / math.sqrt(2))


def entropy(chances):
    return -sum(p * math.log(p) for p in chances if p > 0)


class Quest:
    """QUEST+ (Watson 2017) over levels. `two_sided`: lapses press either key; else guesses are right in half."""

    def __init__(self, two_sided, step):
        self.values = list(range(RANGE[0], RANGE[1] + 1, step))
        width = RANGE[1] - RANGE[0]
        parameters = [(a, width / 40 * 20 ** (i / 4), lapse) for a in self.values for i in range(5) for lapse in (0, 0.02, 0.04)]
        self.thresholds = [a for a, _, _ in parameters]
        self.likely = [1 / len(parameters)] * len(parameters)
        self.chance = {x: [lapse / 2 + (1 - lapse) * phi((x - a) / b) if two_sided else 0.5 + (0.5 - lapse) * phi((x - a) / b)
                           for a, b, lapse in parameters] for x in self.values}

    def expect(self, x):
        """Returns the entropy that is expected after a trial with the value x."""
        total = 0
        for chances in (self.chance[x], [1 - p for p in self.chance[x]]):
            joint = [p * c for p, c in zip(self.likely, chances)]
            share = sum(joint)
            total += share * entropy([p / share for p in joint])
        return total

    def answer(self, x, positive):
        likely = [p * (c if positive else 1 - c) for p, c in zip(self.likely, self.chance[x])]
        self.likely = [p / sum(likely) for p in likely]

    def sd(self):
        mean = sum(p * a for p, a in zip(self.likely, self.thresholds))
        return math.sqrt(sum(p * (a - mean) ** 2 for p, a in zip(self.likely, self.thresholds)))


def walk(answers, down, mirrored, steps, start):
    """Returns the values of a staircase's trials, and the number of reversals after each answer."""
    value, in_row, up, reversals, values, turned = start, 0, None, 0, [], []
    for positive in answers:
        values.append(value)
        counts = positive != mirrored
        in_row = in_row + 1 if counts else 0
        if not counts or in_row == down:
            in_row = 0
            reversals += up is not None and up == positive
            up = not positive
            value += steps[min(len(steps) - 1, reversals // 2)] * (1 if up else -1)
            value = max(RANGE[0], min(RANGE[1], value))
        turned.append(reversals)
    return values, turned


class Adaptive(ExperimentTest):
    def setUp(self):
        super().setUp()
        self.write("desk.toml", DESK)

    def hold(self, text, code="01", *more, seed=1, folder="study"):
        self.write("tasks.toml", text)
        return self.ok("experiment", "tasks.toml", "--participant", code, "-o", folder, "--simulate", WHO.format(seed), *more)

    def tracks(self, run, code="01", folder="study"):
        """Returns value and answer of the trials that count, by track."""
        found = {}
        for r in self.rows(code, run, folder):
            if r["void"] == "false":
                found.setdefault(int(r["track"]), []).append((float(r["value"]), (r["response"] == "2") == (r["method_1"] in ("standard", "none"))))
        return found

    def counted(self, run, code="01"):
        """Returns trials and end of each track, as analyze counts them."""
        told = self.analysis()["runs"][run]
        return {t["track"]: (t["trials"], t["ended"]) for t in told["tracks"] if t["participant"] == code}

    def check_quest(self, trials, two_sided, stop_sd, step=1):
        """Checks the values of a track; returns the posterior sd at its end. The sd must not be below stop_sd before."""
        q = Quest(two_sided, step)
        for i, (value, positive) in enumerate(trials):
            expected = {x: q.expect(x) for x in q.values}
            self.assertLess(expected[value] - min(expected.values()), 1e-9, (i, value))
            if i:
                self.assertGreaterEqual(q.sd(), stop_sd)
            q.answer(value, positive)
        return q.sd()

    def test_a_track_of_quest_ends_when_its_posterior_sd_is_below_stop_sd(self):
        told = self.hold(adaptive("bayes"))
        tracks = self.tracks("bayes")
        self.assertEqual(sorted(tracks), [1, 2])
        for trials in tracks.values():
            self.assertLess(len(trials), 60)
            self.assertLess(self.check_quest(trials, True, 2), 2)
        self.assertEqual(self.counted("bayes"), {n: (len(trials), True) for n, trials in tracks.items()})
        count = sum(map(len, tracks.values()))
        self.assertIn(f"{count} trials in 1 run", told.stdout)
        text = self.ok("analyze", "study", "--format", "tables")
        self.assertIn(f"2 of 2 tracks ended by stop_sd = 2; trials of a track: {min(map(len, tracks.values()))} to "
                      f"{max(map(len, tracks.values()))}, mean {count / 2:.4g}; posterior sd: ", " ".join(text.stdout.split()))
        self.assertNotIn("of at most", text.stderr)
        # Trials are missing only after the end of their track.
        ends = {n: max(i for i, r in enumerate(self.rows("01", "bayes")) if r["track"] == str(n)) for n in tracks}
        played = [int(r["trial"]) for r in self.rows("01", "bayes")[:min(ends.values())] if r["attempt"] == "1"]
        self.assertEqual(played, list(range(1, len(played) + 1)))

    def test_a_staircase_ends_at_its_reversal(self):
        self.hold(adaptive("stairs"))
        tracks = self.tracks("stairs")
        self.assertEqual(sorted(tracks), [1, 2, 3, 4])
        for n, trials in tracks.items():
            values, turned = walk([positive for _, positive in trials], 2, n % 2 == 0, (4, 2), RANGE[n % 2])
            self.assertEqual(values, [value for value, _ in trials])
            self.assertEqual((turned[-1], turned[-2]), (6, 5))
        self.assertEqual(self.counted("stairs"), {n: (len(trials), True) for n, trials in tracks.items()})

    def test_a_run_has_tracks_of_several_procedures(self):
        self.hold(adaptive("felt", "mixed"))
        felt = self.tracks("felt")
        self.assertLess(self.check_quest(felt[1], False, 3.5, 2), 3.5)
        values, turned = walk([positive for _, positive in felt[2]], 3, False, (4, 2), RANGE[1])
        ends = self.analysis()["runs"]["felt"]["tracks"]
        self.assertEqual([(t["motion"], t["method"], t["procedure"], t["reversals"], t["sd"] is None) for t in ends],
                         [("east", "park", "quest", None, False), ("east", "park", "1up3down", turned[-1], True)])
        self.assertAlmostEqual(ends[0]["sd"], self.check_quest(felt[1], False, 3.5, 2), 6)
        text = " ".join(self.ok("analyze", "study", "--format", "tables").stdout.split())
        self.assertIn(f"park, quest: 1 of 1 track ended by stop_sd = 3.5, reversals = 5; trials of a track: {len(felt[1])} to ", text)
        self.assertIn("park, 1up3down: 1 of 1 track ended by stop_sd = 3.5, reversals = 5; trials of a track: ", text)
        self.assertIn("; reversals: 5 to 5, mean 5 ", text)
        rows = [r for r in self.trials()[1] if r["run"] == "felt"]
        self.assertEqual({n: [float(r["value"]) for r in rows if r["track"] == str(n)] for n in felt}, {n: [v for v, _ in own] for n, own in felt.items()})
        self.assertEqual((values, turned[-1], turned[-2]), ([value for value, _ in felt[2]], 5, 4))
        # Every second staircase is mirrored, and begins at the other end.
        mixed = self.tracks("mixed")
        self.assertEqual([len(mixed[n]) for n in (1, 2, 3)], [20, 20, 20])
        self.check_quest(mixed[2], True, 0)
        for n, mirrored in ((1, False), (3, True)):
            self.assertEqual(walk([positive for _, positive in mixed[n]], 2, mirrored, (4, 2, 1), RANGE[not mirrored])[0], [value for value, _ in mixed[n]])
        told = self.analysis()["runs"]
        self.assertEqual((told["mixed"]["tracks"], told["mixed"]["track_rule"]), ([], ""))
        self.assertEqual(told["felt"]["track_rule"], "stop_sd = 3.5, reversals = 5")
        # Figures are of all tracks together.
        self.assertEqual(told["mixed"]["trials"], 60)

    def test_a_track_that_does_not_end_has_its_share_of_the_trials(self):
        self.hold(adaptive("endless"), folder="whole")
        self.hold(adaptive("endless").replace('procedure = "quest"', 'procedure = "quest"\nstop_sd = 0.01'))
        self.assertEqual(self.rows("01", "endless"), self.rows("01", "endless", "whole"))
        self.assertEqual(self.counted("endless"), {1: (20, False), 2: (20, False)})
        self.assertNotIn("that count, of", self.ok("analyze", "study").stderr)

    def test_a_session_whose_tracks_have_their_shares_is_not_reported(self):
        # Four tracks share 44 trials in two orders: each order has five or six trials, so a track has ten to twelve.
        text = measures("desk.toml", toml("run", "both", **dict(COMPARED, procedure=["quest", "1up1down"], methods=["park", "soft"], stop_sd=0.01, reversals=2, trials=44)),
                        keys="gap_s = 0.1\n")
        for code in ("01", "02", "03", "04"):
            self.hold(text, code)
        tracks = self.analysis()["runs"]["both"]["tracks"]
        self.assertIn(10, [t["trials"] for t in tracks if not t["ended"]])
        self.assertIn(True, [t["ended"] for t in tracks])
        self.assertNotIn("that count, of", self.ok("analyze", "study").stderr)

    def test_a_session_that_was_killed_at_any_answer_goes_on_as_if_it_had_not_been(self):
        self.hold(adaptive("felt", "bayes"))
        whole = contents(self.dir / "study")
        tables = {run: self.dir / f"study/sub-01/beh/sub-01_task-{run}_beh.tsv" for run in ("felt", "bayes")}
        order = json.loads((self.dir / "study/sourcedata/sub-01/session.json").read_text())["order"]
        self.assertIn("true", {r["void"] for run in tables for r in self.rows("01", run)})
        for run in order:
            lines = whole[str(tables[run].relative_to(self.dir / "study"))].splitlines(True)
            for keep in range(1, len(lines) - 1):
                for later in order[order.index(run) + 1:]:
                    tables[later].unlink(missing_ok=True)
                tables[run].write_bytes(b"".join(lines[:1 + keep]))
                self.hold(adaptive("felt", "bayes"), "01", "--resume")
                now = contents(self.dir / "study")
                for table in tables.values():
                    name = str(table.relative_to(self.dir / "study"))
                    self.assertEqual(now[name], whole[name], (run, keep))

    def test_a_session_that_lacks_trials_is_reported(self):
        self.hold(adaptive("bayes"))
        table = self.dir / "study/sub-01/beh/sub-01_task-bayes_beh.tsv"
        lines = table.read_text().splitlines(True)
        last = max(i for i, r in enumerate(self.rows("01", "bayes")) if r["void"] == "false")
        table.write_text("".join(lines[:1 + last]))
        count = sum(map(len, self.tracks("bayes").values()))
        self.assertIn(f"bayes: sub-01 has {count} trials that count, of at most 120", self.ok("analyze", "study").stderr)
        self.assertIn(False, [ended for _, ended in self.counted("bayes").values()])
        # Trials that the analysis leaves out count in their tracks.
        self.hold(adaptive("bayes"), "01", "--resume")
        ended = self.counted("bayes")
        told = self.analysis("--response-time", "0,0.6")["runs"]["bayes"]
        self.assertGreater(told["dropped"], 0)
        self.assertEqual({t["track"]: (t["trials"], t["ended"]) for t in told["tracks"]}, ended)
        # A track that the run does not have.
        rows = table.read_text()
        track = rows.splitlines()[0].split("\t").index("track")
        cells = rows.splitlines()[1].split("\t")
        cells[track] = "3"
        table.write_text("\n".join([rows.splitlines()[0], "\t".join(cells), *rows.splitlines()[2:]]) + "\n")
        self.refused(2, "analyze", "study", says=('track is "3"',))

    def test_a_dry_run_and_the_report_say_what_may_end_early(self):
        self.write("tasks.toml", adaptive("bayes", "felt", "endless"))
        text = self.ok("experiment", "tasks.toml", "--dry-run").stdout
        self.assertRegex(text, r"bayes \(adaptive\), at most 120 trials, at most \d+ s without the answers")
        self.assertRegex(text, r"endless \(adaptive\), 40 trials, \d+ s without the answers")
        runs = json.loads(self.ok("experiment", "tasks.toml", "--dry-run", "--format", "json").stdout)["runs"]
        self.assertEqual({r["name"]: (r["may_end_early"], len(r["trials"])) for r in runs}, {"bayes": (True, 120), "felt": (True, 160), "endless": (False, 40)})
        self.hold(adaptive("bayes", "felt", "endless"))
        self.ok("report", "study", "-o", "methods.md")
        report = " ".join((self.dir / "methods.md").read_text().replace("\\_", "_").split())
        for told in ("Trials: at most 120;", "Trials: 40;", "2 tracks in each condition, values from -40 to -8 in steps of 1; QUEST+ (Watson 2017)",
                     "a track of QUEST+ ended when the posterior standard deviation of its threshold was below 2, or without trials left",
                     "1 of them: QUEST+", "1 of them: staircases (Levitt 1971) from -8: a step down after 3 right answers in a row",
                     "a staircase ended at its reversal number 5, or without trials left", "2 of 2 tracks ended by stop_sd = 2; trials of a track: ",
                     "- Levitt, H. (1971)", "- Watson, A. B. (2017)"):
            self.assertIn(told, report)

    def test_power_counts_only_the_trials_that_are_played(self):
        def power(stop):
            self.write("tasks.toml", adaptive("endless").replace('procedure = "quest"', f'procedure = "quest"\n{stop}'))
            told = self.ok("experiment", "tasks.toml", "--power", "8", "--studies", "40", "--format", "json", "--simulate", "seed=1,pse=-22,jnd=4")
            return json.loads(told.stdout)["runs"][0]["power"][0]["power"]
        self.assertEqual(power(""), power("stop_sd = 0.01"))
        self.assertGreater(power(""), power("stop_sd = 7") + 0.2)

    def test_wrong_keys_are_refused_with_their_line(self):
        for run, old, new, at, says in (
                ("bayes", "stop_sd = 2", "reversals = 4", "reversals", 'reversals does not apply to procedure "quest" (leave out reversals)'),
                ("stairs", "reversals = 6", "stop_sd = 2", "stop_sd", 'stop_sd does not apply to procedure "1up2down" (leave out stop_sd)'),
                ("bayes", "stop_sd = 2", "stop_sd = 0", "stop_sd", "stop_sd is 0"), ("bayes", "stop_sd = 2", "stop_sd = 33", "stop_sd", "stop_sd is 33"),
                ("stairs", "reversals = 6", "reversals = 0", "reversals", "reversals is 0"),
                ("felt", '"1up3down"]', '"2up"]', "procedure", "procedure '2up' is unknown"), ("felt", '["quest", "1up3down"]', "[]", "procedure", "procedure is empty"),
                ("felt", "stop_sd = 3.5", "tracks = 3", "tracks", "tracks is 3, but procedure has 2"),
                ("felt", '"1up3down"]', '"1up1down"]', "procedure", "as guesses do"),
                ("felt", '["quest", ', '["1up2down", ', "stop_sd", 'stop_sd does not apply to procedure "1up2down"'),
                ("mixed", '"quest", "1up2down"]', '"quest"]', "procedure", '1 track of procedure "1up2down" would test one side of the pse more')):
            text = adaptive(run).replace(old, new, 1)
            self.assertNotEqual(text, adaptive(run))
            self.write("tasks.toml", text)
            told = self.refused(2, "experiment", "tasks.toml", "--dry-run", says=[says]).stderr
            line = 1 + [x.split(" =")[0] for x in text.splitlines()].index(at)
            self.assertIn(f"tasks.toml:{line}:", told)


class AtTheTerminal(PersonTest):
    def test_a_track_goes_on_when_the_answer_that_ended_it_is_made_void(self):
        self.write("short.toml", BARE + toml("run", "climb", task="adaptive", question="One or two?", choices=["one", "two"], methods=["Birch"],
                                             motions=["east"], vary="length_mm", range=[4, 20], procedure="1up1down", reversals=1, trials=6))
        t = Terminal(self, self.args())
        t.begin(agrees=False)
        t.answer("Trial 1/at most 6: [^?]*One or two\\? ", "2")
        t.answer("Trial 2/at most 6: [^?]*One or two\\? ", "1")
        t.answer("Any key ends", "v")
        t.answer("Trial 3/at most 6: [^?]*One or two\\? ", "2")
        t.answer("Trial 4/at most 6: [^?]*One or two\\? ", "1")
        t.answer("Any key ends", " ")
        self.assertEqual(t.end(), 0, t.said())
        self.assertEqual(self.answers("climb"), [("1", "1", "false", "2"), ("2", "1", "true", "1"), ("3", "1", "false", "2"), ("4", "1", "false", "1")])
        table = contents(self.dir / "study")["sub-01/beh/sub-01_task-climb_beh.tsv"]
        self.ok(*self.args("--resume"))
        self.assertEqual(contents(self.dir / "study")["sub-01/beh/sub-01_task-climb_beh.tsv"], table)


if __name__ == "__main__":
    main()
