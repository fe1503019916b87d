# SPDX-License-Identifier: MIT
"""tactor experiment with a person at a terminal, and with lines in place of keys: display, questions, files and refusals.
tests/study has the order of questions, and what a key answers."""
import datetime
import json
import math
import os
import re
import shutil
import time
import unittest

from experiments import ADJUST, BARE, DRAWINGS, ESTIMATES, IDENTIFY, LINE, SHORT, SMALL, WITH_CONSENT, PersonTest, Terminal, contents, noise_pieces, read_table
from harness import PATIENCE_S, main
from studies import toml

AGREED = "y\n" + "y\n" * 2  # consent, and both tactors felt
RATE = 48000


class AtTheTerminal(PersonTest):
    def start(self, *more):
        return Terminal(self, self.args(*more))

    def test_a_whole_session_by_keys_tells_no_method(self):
        t = self.start()
        t.begin()
        t.answer("Practice 1/1", "12")  # too early: no answers
        t.answer("Which one\\? 1 or 2: ", "x3" "1")  # nor are these
        for i in (1, 2):
            t.until(f"Trial {i}/2")
            t.answer("Which one\\? 1 or 2: ", str(i))
        t.until("A break: 0 s")
        t.answer("Any key begins", " ")
        for i in (1, 2):
            t.until(f"Trial {i}/2")
            t.answer("How even\\? 1 \\(not\\), 2 \\(half\\), 3 \\(all\\): ", "3")
        t.answer("Any key ends", " ")
        self.assertEqual(t.end(), 0, t.said())
        rows = self.rows("01", "pairs")
        self.assertEqual(self.answers(), [("1", "1", "false", "1"), ("2", "1", "false", "2")])
        self.assertEqual([r["rating"] for r in self.rows("01", "marks")], ["3", "3"])
        for r in rows:
            gap_frames = self.frames_of_plan(r["plan_1"]) + RATE // 10
            self.assertEqual(int(r["frame_2"]) - int(r["frame_1"]), gap_frames)
            self.assertAlmostEqual(float(r["duration"]), (gap_frames + self.frames_of_plan(r["plan_2"])) / RATE, 6)
            self.assertEqual((r["xruns"], r["stream"]), ("0", "1"))
            self.assertLess(float(r["response_time"]), PATIENCE_S)
        self.assertEqual(rows[0]["onset"], "0.000000")
        self.assertAlmostEqual(float(rows[1]["onset"]), (int(rows[1]["frame_1"]) - int(rows[0]["frame_1"])) / RATE, 5)
        # At least half a second, the animation's 0.2 s, and the stimuli are between two trials.
        self.assertGreater(float(rows[1]["onset"]), float(rows[0]["duration"]) + 0.7)
        # They begin with the answer, whose time counts from the end of the stimuli.
        answered_s = float(rows[0]["duration"]) + float(rows[0]["response_time"])
        self.assertGreater(float(rows[1]["onset"]), answered_s + 0.69)
        self.assertEqual(len(read_table(self.dir / "study/sourcedata/sub-01/practice.tsv")), 1)
        for text in (t.all, re.sub(r'tactor: warning: motion ".*', "", t.said())):
            self.assertNotRegex(text, "(?i)alder|birch|tactile-brush|park")
        # The target moved: the picture was drawn over itself.
        self.assertIn("\033[", t.all)
        self.assertNotIn("cannot be drawn", t.said())

    def test_people_are_told_whether_they_were_right(self):
        runs = (toml("run", "what", task="identify", trials=2, methods=["Birch"], motions=["east", "west"], feedback=True)
                + toml("run", "alike", task="same-different", trials=2, motions=["east"], training=2, question="Alike?")
                + toml("run", "there", task="detect", trials=2, motions=["east"], methods=["Birch"], catch=0.5, feedback=True)
                + toml("run", "when", task="interval", vary="level_dbfs", values=[-30, -20], motions=["east"], methods=["Birch"], trials=2, feedback=True)
                + toml("run", "odd", task="oddity", motions=["east"], trials=6, feedback=True)
                + toml("run", "more", task="constant", question="Which was stronger?", vary="level_dbfs", values=[-30, -25, -20], standard=-25, motions=["east"],
                       methods=["Birch"], trials=6, feedback=True))
        self.write("short.toml", BARE.replace("gap_s = 0.1", 'gap_s = 0.1\norder = "latin"') + runs)
        t = self.start()
        t.walk(agrees=False)
        told = []
        for asked, answers in (("Which movement was it", 2), ("Alike", 4), ("Did you feel it", 2), ("In which interval", 2), ("Which was different", 6), ("Which was stronger", 6)):
            t.answer("Any key begins", " ")
            for n in range(answers):
                t.answer(asked + ".*: ", "1")
                if asked != "Which was stronger" and (asked != "Alike" or n < 2):  # two are training
                    told.append(t.until("That was (right|wrong)\\.")[1] == "right")
        t.answer("Any key ends", " ")
        self.assertEqual(t.end(), 0, t.said())
        told += [said == "right" for said in re.findall("That was (right|wrong)", t.all.rpartition("Any key begins")[2])]
        self.assertEqual(len(re.findall("That was (?:right|wrong)", t.all)), len(told))
        # Reads what was felt from the tables; practice has its own.
        practice = read_table(self.dir / "study/sourcedata/sub-01/practice.tsv")
        truth = ([r["motion"] == "east" for r in self.rows("01", "what")] + [r["method_1"] == r["method_2"] for r in practice]
                 + [r["method_1"] != "none" for r in self.rows("01", "there")] + [r["method_1"] != "none" for r in self.rows("01", "when")]
                 + [r["method_1"] not in (r["method_2"], r["method_3"]) for r in self.rows("01", "odd")]
                 + [(float(r["value"]) > -25) == (r["method_1"] != "standard") for r in self.rows("01", "more") if float(r["value"]) != -25])
        self.assertIn("Which was different from the two others? 1 to 3: ", t.all)
        for r in self.rows("01", "odd"):  # 0.1 s between stimuli
            ends = [int(r[f"frame_{i}"]) + self.frames_of_plan(r[f"plan_{i}"]) for i in (1, 2, 3)]
            self.assertEqual([int(r[f"frame_{i}"]) for i in (2, 3)], [end + RATE // 10 for end in ends[:2]])
            self.assertAlmostEqual(float(r["duration"]), (ends[2] - int(r["frame_1"])) / RATE, 6)
        self.assertEqual(told, truth)
        self.assertEqual({*truth}, {True, False})

    def test_the_terminal_has_the_words_of_the_definition(self):
        keys = ("agree yes no walk felt again back begin practice part target rest pause over or to any_key_begins any_key_ends trial "
                "repeated later no_answer any_number").split()
        words = "[page]\n" + "".join(f'{k} = "<{k}>"\n' for k in keys)
        text = SHORT.replace("labels = [\"not\", \"half\", \"all\"]", "labels = [\"nada\", \"todo\"]").replace("How even?", "?2").replace("Which one?", "?1")
        self.write("short.toml", text.replace("[[motion]]", words + "[[motion]]", 1).replace("Be at ease.", "Be at ease. " * 20))
        t = self.start()
        t.answer("ease.\\s+<agree> y <yes>, n <no>: ", "y")
        t.answer("<walk>[^<]*0: <felt> y <yes>, n <no>, r <again>: ", "y")
        t.answer("1: <felt> y <yes>, n <no>, r <again>, b <back>: ", "y")
        t.answer("<part> 1/2\\s+\\?1\\s+1 <or> 2\\s+<any_key_begins>", " ")
        t.answer("<practice> 1/1: [^?]*\\?1 1 <or> 2: ", "1")
        t.answer("<trial> 1/2: ", "r")
        t.until("<later>")
        t.answer("<trial> 2/2: [^?]*\\?1 1 <or> 2: ", "p1")
        t.answer("<pause>", "g")
        t.answer("<trial> 1/2 \\(<repeated>\\): [^?]*\\?1 1 <or> 2: ", "1")
        t.until("<rest>: 0 s")
        t.answer("<part> 2/2\\s+\\?2\\s+1 \\(nada\\) <to> 3 \\(todo\\)\\s+<any_key_begins>", " ")
        for _ in (1, 2):
            t.answer("\\?2 1 \\(nada\\) <to> 3 \\(todo\\): ", "1")
        t.answer("<over>\\s+<any_key_ends>", " ")
        self.assertEqual(t.end(), 0, t.said())
        self.assertIn(max(len(line) for line in t.all.replace("\r", "").split("\n")), range(70, 80))  # breaks at words
        # And the text read without a terminal.
        lines = self.ok(*self.args(code="02"), stdin="y\ny\ny\n" + "x\n1\n" + "1\n1\n" + "1\n1\n").stdout
        for shown in (t.all, lines):
            # The rest is not in letters, except the picture's words for time and place, and the tool's at its end.
            rest = re.sub(r"\033\[[0-9;?]*[A-Za-z]|<\w+>|Be at\s+ease\.|nada|todo|\b[ynrb] (?=<)|\bs\b|at [\d.-]+, [\d.-]+ mm|sub-0\d: 4 trials.*", "", shown)
            self.assertNotRegex(rest, "[A-Za-z]{2}")
        self.assertIn("<target>\n", lines)
        self.assertIn("<no_answer>: 1 ", lines)

    def test_numbers_above_nine_are_typed_with_enter(self):
        self.write("short.toml", LINE)
        t = self.start()
        t.begin()
        asked = "How even\\? 0 \\(not\\) to 100 \\(all\\): "
        t.answer(asked, "0\n")
        t.answer(asked, "57\x7f5\n")
        t.answer(asked, "101\n")
        t.answer("101\\s+That is not an answer: 0 \\(not\\) to 100 \\(all\\): ", "1p1\n")  # a pause comes
        t.answer("A pause", "g")
        t.answer(asked, "100\n")
        t.answer("Any key ends", " ")
        self.assertEqual(t.end(), 0, t.said())
        self.assertEqual([row[3] for row in self.answers("marks", "rating")], ["0", "55", "11", "100"])
        self.assertIn("57\b \b5", t.all)
        self.assertNotIn("held down", t.said())

    def test_more_than_nine_motions_are_answered_by_typed_numbers(self):
        self.write("short.toml", BARE[:BARE.index("[[motion]]")] + "".join(toml("motion", f"m{i}", path=f"M0 0H{i}", duration=0.2) for i in range(1, 13)) +
                   toml("method", "one") + toml("run", "what", task="identify", trials=2))
        t = self.start()
        t.begin(agrees=False)
        t.answer("Which movement was it\\? 1 m1, [^:]*12\\s+m12: ", "12\n")
        t.answer("12\\s+m12: ", "13\n")
        t.answer("That is not an answer: 1 m1, [^:]*12\\s+m12: ", "1\n")
        t.answer("Any key ends", " ")
        self.assertEqual(t.end(), 0, t.said())
        self.assertEqual(self.answers("what"), [("1", "1", "false", "m12"), ("2", "1", "false", "m1")])

    def test_a_place_is_the_number_of_a_tactor_at_a_terminal(self):
        self.write("short.toml", DRAWINGS.partition('[[run]]\nname = "how"')[0])
        t = self.start()
        t.begin(agrees=False)
        asked = "Where was it\\? 1 to 2: "
        t.answer(asked, "32")  # there is no tactor 3
        t.answer(asked, "1")
        t.answer(asked, "2")
        t.answer("Any key ends", " ")
        self.assertEqual(t.end(), 0, t.said())
        self.assertEqual([r["response"] for r in self.rows("01", "where")], ["0 20 0", "0 0 0", "0 20 0"])

    def test_any_positive_number_is_an_estimate(self):
        self.write("short.toml", ESTIMATES)
        t = self.start()
        t.begin(agrees=False)
        possible = "a number above 0, with a point: 0\\.5, 12, 1500: "
        asked = f"How strong\\? {possible}"
        t.answer(asked, "12,5\n")
        for typed, after in (("12,5", "0"), ("0", "-3"), ("-3", "1e400"), ("1e400", "1" * 40), ("1{16}", "0.5")):
            t.answer(f"{typed}\\s+That is not an answer: {possible}", after + "\n")
        t.answer(f"Trial 2/4: [^?]*{asked}", "12.50\n")
        t.answer(asked, "q")
        self.assertEqual(t.end(), 130, t.said())
        lines = self.ok(*self.args("--resume"), stdin="y\ny\nnan\n-1\n 1500 \n1000000000\n").stdout
        self.assertEqual(lines.count("That is not an answer: a number above 0"), 2)
        rows = self.rows("01", "size")
        self.assertEqual([(r["response"], r["intensity_estimate"]) for r in rows], [(n, n) for n in ("0.5", "12.5", "1500", "1000000000")])
        told = json.loads((self.dir / "study/task-size_beh.json").read_text())
        self.assertEqual([told[c]["Description"] for c in ("response", "intensity_estimate")],
                         ["The number above 0 that the participant gave", "The number above 0 that the participant gave"])
        # The exponent by hand, from the table alone.
        logs = {level: [math.log(float(r["response"])) for r in rows if float(r["value"]) == level] for level in (-30, -20)}
        found = json.loads(self.ok("analyze", "study", "--format", "json").stdout)["runs"]["size"]["exponent"]["participants"]["01"]
        self.assertAlmostEqual(found, (sum(logs[-20]) / 2 - sum(logs[-30]) / 2) / (0.5 * math.log(10)), 9)

    def test_a_participant_moves_the_comparison_until_it_equals_the_standard(self):
        self.write("short.toml", ADJUST)
        t = self.start()
        t.begin(agrees=False)
        asked = r"You change the (first|second) one\. Make both feel equal\. - < > \+ n a: "
        changed = []

        def press(trial, key):
            changed.append((trial, t.until(asked)[1]))
            t.key(key)
            if key not in "rv":
                t.until(re.escape(key.replace("\n", "a")) + "\r?\n")  # the key, not the number of the answer

        for trial, answers, after in (("Trial 1/4", "++>n<", "\n"), ("Trial 2/4", ">", "r"), ("Trial 3/4", "", "a"), ("Trial 4/4", "-", "v")):
            t.until(trial)
            for key in answers + after:
                press(trial, key)
            if after == "r":
                t.until("Once more, later")
        t.answer("", "q")  # in the trial that v left as it was
        self.assertEqual(t.end(), 130, t.said())
        self.assertIn("trial 3 is void: the experimenter made it void", t.said())
        kept = (self.dir / "study/sub-01/beh/sub-01_task-equal_beh.tsv").read_text()
        t = self.start("--resume")
        t.begin(agrees=False)
        t.until("Trial 4/4: ")
        press("Trial 4/4", "a")  # again from its start
        for trial in ("Trial 2/4 \\(again\\): ", "Trial 3/4 \\(again\\): "):
            t.until(trial)
            t.answer(asked, "<")
            t.answer(asked, "a")
        t.answer("Any key ends", " ")
        self.assertEqual(t.end(), 0, t.said())
        self.assertTrue((self.dir / "study/sub-01/beh/sub-01_task-equal_beh.tsv").read_text().startswith(kept))
        rows = self.rows("01", "equal")
        moves = {"++>n<": {-40: (-30, 4), -22: (-21, 2)}, ">": {-40: (-39, 1), -22: (-21, 1)}, "": {-40: (-40, 0), -22: (-22, 0)},
                 "<": {-40: (-40, 0), -22: (-23, 1)}}
        for row, (answers, void) in zip(rows, (("++>n<", "false"), (">", "true"), ("", "true"), ("", "false"), ("<", "false"), ("<", "false")), strict=True):
            value, count = moves[answers][float(row["start"])]
            self.assertEqual((float(row["value"]), row["moves"], row["void"], row["response"]),
                             (value, str(count), void, "n/a" if answers == ">" else str(value)))
            self.assertEqual({which for trial, which in changed if trial == f"Trial {row['trial']}/4"}, {"second" if row["method_1"] == "standard" else "first"})
            played = self.frames_of_plan(row["plan_1"]) + RATE // 10
            self.assertEqual(int(row["frame_2"]) - int(row["frame_1"]), played)
            self.assertLess(0 if answers == ">" else float(row["response_time"]), PATIENCE_S)
        self.assertEqual([(r["trial"], r["attempt"]) for r in rows], [("1", "1"), ("2", "1"), ("3", "1"), ("4", "1"), ("2", "2"), ("3", "2")])
        # Each move plays both stimuli again: five of them before the first line's, each with gap and 0.5 s.
        self.assertGreater(int(rows[0]["frame_1"]), 5 * RATE * (float(rows[0]["duration"]) + 0.5))
        values = [float(r["value"]) for r in rows if r["void"] == "false"]
        told = json.loads(self.ok("analyze", "study", "--format", "json").stdout)["runs"]["equal"]["adjustment"]["participants"]["01"]
        self.assertAlmostEqual(told["constant_error"], sum(values) / 4 + 30, 9)

    def test_the_experimenter_s_keys_work(self):
        t = self.start()
        t.begin()
        t.answer("Which one\\? ", "1")  # practice
        t.answer("Trial 1/2", "r")  # while it plays
        t.until("Once more, later")
        t.answer("Trial 2/2: [^?]*Which one\\? ", "r")  # during the question
        t.until("Once more, later")
        t.answer("Trial 1/2 \\(again\\): [^?]*Which one\\? ", "p2")
        t.answer("A pause", "1g")
        t.answer("Trial 2/2 \\(again\\): [^?]*Which one\\? ", "v")
        t.key("1" * 50 + "2")  # a key that is held down answers nothing
        t.answer("Trial 1/2 \\(again\\): [^?]*Which one\\? ", "1")
        t.answer("Any key begins", "v")  # in the next run's introduction: back to this one
        t.answer("Trial 1/2 \\(again\\): [^?]*Which one\\? ", "2")
        t.answer("Any key begins", " ")
        t.answer("How even\\? ", "1")
        t.answer("How even\\? ", "2")
        t.answer("Any key ends", "v")
        t.answer("Trial 2/2 \\(again\\): How even\\? ", "3")
        t.answer("Any key ends", " ")
        self.assertEqual(t.end(), 0, t.said())
        self.assertEqual(self.answers(), [("1", "1", "true", "n/a"), ("2", "1", "true", "n/a"), ("1", "2", "true", "2"),
                                          ("2", "2", "false", "2"), ("1", "3", "true", "1"), ("1", "4", "false", "2")])
        self.assertEqual(self.rows("01", "pairs")[0]["frame_2"], "n/a")  # its second stimulus never began
        self.assertEqual(self.answers("marks", "rating"), [("1", "1", "false", "1"), ("2", "1", "true", "2"), ("2", "2", "false", "3")])
        self.assertEqual(t.said().count("is void: the experimenter repeated it"), 2)
        self.assertEqual(t.said().count("is void: the experimenter made it void"), 3)
        self.assertEqual(t.said().count("a key is held down"), 1)
        self.ok(*self.args("--resume"))

    def test_consent_has_the_time_of_the_yes(self):
        self.env["NO_COLOR"] = "1"  # leaves the target on the terminal
        t = self.start()
        t.answer("Do you agree", "y")
        t.until("0: Did you feel it")
        seen = datetime.datetime.now(datetime.timezone.utc)
        time.sleep(0.05)
        t.key("y")
        t.answer("1: Did you feel it", "y")
        t.answer("Any key begins", " ")
        t.answer("Which one\\? ", "q")
        self.assertEqual(t.end(), 130)
        self.assertIn("tactor: ended by the experimenter (q): the answers are in study (continue with --resume)", t.said())
        s = self.session("01")
        agreed, asked = (datetime.datetime.fromisoformat(v.replace("Z", "+00:00")) for v in (s["consent"], s["walk"][0]["asked"]))
        self.assertLess(agreed, seen)
        self.assertGreater(asked, seen)
        self.assertEqual(s["streams"][0]["display"], "terminal with animation")
        self.assertRegex(t.all, r"\033\[\d+A")
        self.assertNotRegex(t.all, r"\033\[[0-9;]*m")

    def test_ctrl_c_ends_at_any_place_and_the_session_resumes(self):
        for place, key in (("Do you agree", "\x03"), ("0: Did you feel it", "q")):
            t = self.start()
            if key == "q":
                t.answer("Do you agree", "y")
            t.answer(place, key)
            self.assertEqual(t.end(), 130)
            self.assertFalse((self.dir / "study/sourcedata").exists())
        self.assertIn("tactor: ended by the experimenter (q) before the first trial or questionnaire was complete: nothing was written", t.said())
        for n, answers in enumerate(("", "", "1", "12")):
            t = self.start(*(("--resume",) if n else ()))
            t.begin(agrees=not n, key=" " if n else "\x03")
            for answer in answers:
                t.answer("Which one\\? ", answer)
            if n:
                t.answer(("Practice 1/1", "Trial 1/2: ", "A break")[n - 1], "\x03")
            self.assertEqual(t.end(), 130, n)
            self.assertIn("continue with --resume", t.said())
        self.assertEqual([r["response"] for r in self.rows("01", "pairs")], ["1", "2"])
        # The break was over with the interruption, and the stream is another.
        result = self.ok(*self.args("--resume"), stdin="y\ny\n1\n2\n")
        self.assertNotIn("A break", result.stdout)
        self.assertEqual({r["stream"] for r in self.rows("01", "pairs")}, {"4"})
        self.assertEqual({r["stream"] for r in self.rows("01", "marks")}, {"5"})
        self.assertEqual([s["stream"] for s in self.session("01")["streams"]], [1, 2, 3, 4, 5])


class ByLines(PersonTest):
    ANSWERS = AGREED + "1\n1\n2\n" + "1\n2\n"

    def test_a_session_and_its_files(self):
        result = self.ok(*self.args(), stdin=self.ANSWERS)
        self.assertIn('warning: playing to "null", not to hardware', result.stderr)
        self.assertIn("warning: the target cannot be drawn", result.stderr)
        s = self.session("01")
        self.assertEqual((s["simulated"], s["device"], s["sound_server"], s["masker"], s["thresholds_assumed"]),
                         (False, "null", None, None, False))
        self.assertEqual([w["tactor"] for w in s["walk"]], [0, 1])
        self.assertEqual([(x["device"], x["display"], x["masking"]) for x in s["streams"]], [("null", "terminal without animation", None)])
        self.assertNotIn("simulated", (self.dir / "study/README").read_text().lower() + result.stdout.lower())
        for at in (s["date"], s["consent"], s["streams"][0]["opened"], s["walk"][0]["asked"],
                   *(scan["acq_time"] for scan in read_table(self.dir / "study/sub-01/sub-01_scans.tsv"))):
            self.assertRegex(at, r"^20\d\d-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{6}Z$")
        text = self.ok("report", "study").stdout
        self.assertIn(f"| {s['consent']} | 2 | terminal without animation | none | none |", text)
        self.assertFalse(self.analysis()["simulated"])
        before = contents(self.dir / "study")
        self.assertIn("finished", self.ok(*self.args("--resume")).stdout)
        self.refused(2, *self.args())
        self.refused(2, "experiment", "short.toml", "--participant", "03", "-o", "study", "--simulate", "seed=1")
        self.assertEqual(contents(self.dir / "study"), before)

    def test_no_consent_no_data(self):
        for said, warned in (("put your names here", True), ("A. Author", False)):
            self.write("short.toml", SHORT.replace("gap_s", f'authors = ["{said}"]\ngap_s', 1))
            told = self.refused(1, *self.args(), stdin="n\n").stderr
            self.assertEqual('the data name "put your names here"' in told, warned)
        self.assertFalse((self.dir / "study").exists())
        (self.dir / "study").mkdir()
        self.assertNotIn("authors", self.refused(1, *self.args(), stdin="n\n").stderr)
        self.refused(3, *self.args(device="hw:CARD=Nowhere"))
        self.assertEqual(list((self.dir / "study").iterdir()), [])
        # After that the folder does not accept the other kind of session, either.
        self.ok("experiment", "short.toml", "--participant", "02", "-o", "study", "--simulate", "seed=1")
        for name in ("README", "dataset_description.json", "participants.json", "task-pairs_beh.json"):
            self.assertIn("simulated", (self.dir / "study" / name).read_text().lower(), name)
        for name in ("sourcedata", "sub-02"):
            shutil.rmtree(self.dir / "study" / name)
        self.refused(2, *self.args())
        (self.dir / "study/dataset_description.json").write_text('{"Name": "ours", "BIDSVersion": "1.8.0"}')
        self.ok(*self.args(), stdin=self.ANSWERS)
        self.assertIn("ours", (self.dir / "study/dataset_description.json").read_text())

    def test_unwritable_files_are_reported_before_the_first_question(self):
        def told(status, *says, code="01"):
            self.assertNotIn("agree", self.refused(status, *self.args(code=code), stdin=self.ANSWERS, says=says).stdout)
            self.assertFalse((self.dir / "study/sourcedata").exists())
        told(2, "File name too long", "a shorter participant code", code="9" * 235)
        self.assertFalse((self.dir / "study").exists())
        self.write("study/dataset_description.json", "{}")
        self.write("study/sub-01", "a file")
        told(2, "study/sub-01", "Not a directory")

    @unittest.skipIf(os.geteuid() == 0, "root may write everywhere")
    def test_a_study_without_rights_is_reported_before_the_first_question(self):
        self.write("study/dataset_description.json", "{}")
        (self.dir / "study/sourcedata").mkdir()
        (self.dir / "study").chmod(0o555)
        self.refused(1, *self.args(code="02"), stdin=self.ANSWERS)
        (self.dir / "study").chmod(0o755)
        self.assertEqual(contents(self.dir / "study/sourcedata"), {})

    def test_a_tactor_that_is_not_felt_ends_it_and_may_be_driven_again(self):
        result = self.refused(1, *self.args(), stdin="y\nr\nx\ny\nb\ny\nn\n")
        self.assertEqual(re.findall(r"(\d): Did you feel it", result.stdout), list("00101"))
        self.assertFalse((self.dir / "study/sourcedata").exists())

    def test_identify_names_the_motions(self):
        self.write("what.toml", BARE + IDENTIFY)
        result = self.ok(*self.args(definition="what.toml"), stdin="y\ny\n3\n1\n2\n")
        self.assertIn("Which movement was it? 1 east, 2 west: ", result.stdout)
        self.assertIn("That is not an answer: 1 east, 2 west", result.stdout)
        self.assertNotIn("agree", result.stdout)  # without a consent question
        self.assertEqual([r["response"] for r in self.rows("01", "what")], ["east", "west"])
        told = self.analysis()["runs"]["what"]
        self.assertEqual((told["n"], told["trials"]), (1, 2))

    def test_a_wait_for_max_drive_s_is_shown_once(self):
        self.write("tired.toml", "[limits]\nmax_drive_s = 0.5\nwindow_s = 4.0\n")
        shown = self.ok(*self.args("--config", "tired.toml"), stdin=self.ANSWERS).stdout
        self.assertIn(shown.count("One moment, please."), range(1, 6))  # of five trials

    def test_the_end_of_answers_loses_none(self):
        self.refused(1, *self.args("--verbose", "--log", "stream.log"), stdin=AGREED + "1\n1\n")
        self.assertRegex((self.dir / "stream.log").read_text(), r"20\d\d-\d\d-\d\dT\S+ info ")
        self.assertEqual(len(self.rows("01", "pairs")), 1)
        # A session that ended before its date was written has one.
        file = self.dir / "study/sourcedata/sub-01/session.json"
        began = json.loads(file.read_text())
        self.assertRegex(began["date"], r"^20\d\d-")
        file.write_text(json.dumps(began | {"date": None}))
        result = self.ok(*self.args("--resume"), stdin="y\ny\n" + "2\n1\n2\n")
        self.assertRegex(self.session()["date"], r"^20\d\d-")
        self.assertNotIn("Do you agree", result.stdout)
        self.assertNotIn("Practice 1", result.stdout)
        rows = self.rows("01", "pairs")
        self.assertEqual([(r["trial"], r["response"], r["stream"]) for r in rows], [("1", "1", "1"), ("2", "2", "2")])
        # Over the gap between two streams the clock of the day counts.
        self.assertGreater(float(rows[1]["onset"]), float(rows[0]["duration"]))

    def test_a_session_killed_at_any_moment_loses_no_answer(self):
        tool = self.begun(*self.args(), stdin=AGREED + "1\n2\n")
        for line in tool.stdout:
            if line.startswith("Trial 2"):
                break
        tool.kill()
        tool.wait()
        self.assertEqual([r["response"] for r in self.rows("01", "pairs")], ["2"])
        self.ok(*self.args("--resume"), stdin="y\ny\n" + "1\n1\n2\n")
        self.assertEqual([r["response"] for r in self.rows("01", "pairs")], ["2", "1"])

    def test_an_early_answer_is_marked_and_counted(self):
        self.write("short.toml", SHORT.replace("trials = 2\npractice = 1", "trials = 2\npractice = 1\nmin_response_s = 10")
                   .replace("scale = 3", "scale = 3\nmin_response_s = 0"))
        self.ok(*self.args(), stdin=self.ANSWERS)
        self.assertEqual([r["early"] for r in self.rows("01", "pairs")], ["true"] * 2)
        self.assertEqual([r["early"] for r in self.rows("01", "marks")], ["false"] * 2)
        runs = self.analysis()["runs"]
        self.assertEqual((runs["pairs"]["early"], runs["marks"]["early"]), (2, 0))
        self.assertEqual([(t["run"], [*t.items()][-1]) for t in self.trials()[1]], [("pairs", ("early", "true"))] * 2 + [("marks", ("early", "false"))] * 2)
        self.assertIn("2 answers early (sooner after the stimulus than min_response_s), counted", self.ok("analyze", "study", "--format", "tables").stdout)
        text = self.ok("report", "study").stdout
        self.assertIn("Answers marked early, which count: 2.", text)
        self.assertIn("sooner after the stimulus than: 10 s", text)
        described = json.loads((self.dir / "study/task-pairs_beh.json").read_text())["early"]
        self.assertEqual(described["Levels"]["true"], "sooner than 10 s")

    def test_a_session_goes_on_after_a_rating_of_0(self):
        self.write("short.toml", LINE)
        shown = self.refused(1, *self.args(), stdin=AGREED + "0\n57\n101\n").stdout
        self.assertIn("How even? 0 (not) to 100 (all): That is not an answer: 0 (not) to 100 (all): ", shown)
        self.ok(*self.args("--resume"), stdin="y\ny\n100\n9\n")
        rows = self.rows("01", "marks")
        self.assertEqual([r["rating"] for r in rows], ["0", "57", "100", "9"])
        self.assertEqual([r["response"] for r in rows], [r["rating"] for r in rows])

    def test_both_answers_of_a_choice_have_words(self):
        self.write("short.toml", SHORT.replace("animation = true", 'choices = ["the first", "the second"]'))
        shown = self.ok(*self.args(), stdin=self.ANSWERS).stdout
        self.assertEqual(re.findall(r" (\d/\d): the first\.\.\. the second\.\.\. Which one\? 1 \(the first\) or 2 \(the second\): (\d)\n", shown),
                         [("1/1", "1"), ("1/2", "1"), ("2/2", "2")])
        described = json.loads((self.dir / "study/task-pairs_beh.json").read_text())
        self.assertEqual(described["response"]["Levels"], {"1": "the first", "2": "the second"})
        self.assertIn("Words of the two answers: the first, the second", self.ok("report", "study").stdout)

    def test_a_left_hand_has_mirrored_motions_and_is_recorded(self):
        text = SHORT.replace('path = "M0 0H20"', 'path = "M0 0H15"\nmirror = true')
        self.write("left.toml", text)
        self.write("right.toml", text.replace("M0 0H15", "M20 0H5"))
        self.refused(2, *self.args(definition="left.toml"), says=("--hand", "add --hand left or --hand right"))
        plans = [{(s["motion"], s["method"]): s["sha256"] for s in json.loads(self.ok(
            "experiment", name, "--dry-run", "--format", "json", *more).stdout)["stimuli"]}
            for name, more in (("left.toml", ("--hand", "left")), ("right.toml", ()), ("left.toml", ("--hand", "right")))]
        self.assertEqual(plans[0], plans[1])
        self.assertNotEqual(plans[0], plans[2])
        self.ok(*self.args("--hand", "left", definition="left.toml"), stdin=self.ANSWERS)
        self.assertEqual(self.session("01")["hand"], "left")
        self.assertIn("| left | east |", self.ok("report", "study").stdout)


class Masking(PersonTest):
    def noisy(self, extra=""):
        self.write("noisy.toml", SHORT.replace("[[motion]]", f'[masking]\nnoise = "white"\nlevel_dbfs = -20\n{extra}[[motion]]', 1))
        return "noisy.toml"

    def test_noise_surrounds_each_stimulus_or_lasts_through_the_run(self):
        # Two tactors of the walk, three pairs and two single stimuli; without answers to wait for, neighbours may merge. Both devices'
        # clocks stand still where the machine does; timed/test_times.py checks durations.
        for code, extra, most in (("01", "", 7), ("02", 'while = "run"\n', 4)):
            self.ok(*self.args("--masker", f"raw:noise{code}.raw", definition=self.noisy(extra), code=code), stdin=ByLines.ANSWERS)
            self.assertEqual(self.session(code)["masker"], f"raw:noise{code}.raw")
            self.assertIn(len(noise_pieces(self.dir / f"noise{code}.raw")), range(1, most + 1))

    def test_renamed_headphones_are_accepted(self):
        args = self.args(definition=self.noisy())
        self.refused(1, *args, "--masker", "raw:one.raw", stdin=AGREED + "1\n")
        self.refused(2, *args, "--resume")
        self.ok(*args, "--masker", "raw:two.raw", "--resume", stdin="y\ny\n" + "1\n2\n1\n2\n")
        s = self.session()
        self.assertEqual((s["masker"], [one["masker"] for one in s["streams"]]), ("raw:one.raw", ["raw:one.raw", "raw:two.raw"]))
        self.assertEqual(s["streams"][1]["masking"], {"noise": "white", "level_dbfs": -20, "fade_s": 0.05, "while": "stimulus"})
        self.assertEqual([w["tactor"] for w in s["walk"]], [0, 1, 0, 1])
        self.assertIn(r"noise: white, level\_dbfs: -20, fade\_s: 0.05, while: stimulus | raw:one.raw; raw:two.raw |",
                      self.ok("report", "study").stdout)

    def test_noise_that_did_not_play_is_not_reported_as_played(self):
        said = self.ok(*self.args(definition=self.noisy()), stdin=ByLines.ANSWERS).stderr
        self.assertIn("masking noise has no device", said)
        text = self.ok("report", "study").stdout
        self.assertIn("| terminal without animation | none | none |", text)
        self.assertNotIn("noise: white", text)
        self.assertIn("before the first stimulus, shown on: terminal without animation", text)

    def test_the_noise_level_is_checked_by_ear(self):
        check = ("experiment", self.noisy(), "--check-noise", "-D", "null")
        said = self.ok(*check, "--masker", "raw:noise.raw", stdin="s\ns\nn\nx\nn\nq\n").stdout
        self.assertIn("white noise, -20 dBFS, on raw:noise.raw", said)
        self.assertEqual(said.splitlines()[1:2] + said.splitlines()[4:], ["noise", "silence", "noise"])
        self.assertRegex(said.splitlines()[2], r"^a stimulus of 0\.\d\d s$")
        self.assertLessEqual(len(noise_pieces(self.dir / "noise.raw")), 3)
        self.assertFalse((self.dir / "study").exists())
        self.ok(*check, "--masker", "null")  # without keys it ends
        self.refused(2, *check)
        self.refused(2, "experiment", "short.toml", "--check-noise", "-D", "null", "--masker", "null")
        self.refused(2, *check[:-2], "--simulate", "seed=1", "--masker", "null")

    def test_simulated_sessions_need_no_device(self):
        self.write("noisy.toml", SMALL.replace("[[motion]]", '[masking]\nnoise = "pink"\n[[motion]]', 1))
        result = self.simulate("01", definition="noisy.toml")
        self.assertNotIn("--masker", result.stderr)
        self.assertEqual((self.session()["masker"], self.session()["device"]), (None, None))


class Refused(PersonTest):
    def test_each_fault_is_reported_before_a_trial(self):
        noisy = Masking.noisy(self)
        self.write("sl.toml", SHORT.replace("{ dbfs = -20 }", "{ sl_db = 7 }"))
        self.write("loud.toml", (self.dir / noisy).read_text().replace("= -20\n", "= -3\n"))
        for more, which in ((("--display", "hologram"), {}), ((), {"definition": "sl.toml"}), ((), {"device": None}),
                            ((), {"definition": "loud.toml"}), (("--dry-run",), {"definition": "loud.toml"}), (("--log", ""), {}),
                            (("--masker", "null"), {}), (("--masker", ""), {}), (("--keypad", "/dev/null"), {}),
                            (("--keypad", "/dev/null", "--simulate", "seed=1"), {}),
                            *((mode + more, {}) for mode in (("--simulate", "seed=1"), ("--dry-run",), ("--print",))
                              for more in (("--verbose",), ("--log", "x.log")))):
            self.refused(2, *self.args(*more, **which), stdin=AGREED)
        self.refused(2, "experiment", "short.toml", "--power", "4", "--simulate", "seed=1", "--verbose")
        for more, which in (((), {"device": "hw:CARD=Nowhere"}), (("--keypad", "/dev/input/nobody"), {}),
                            (("--masker", "hw:CARD=Nowhere"), {"definition": noisy})):
            self.refused(3, *self.args(*more, **which), stdin=AGREED)
        self.assertFalse((self.dir / "study/sub-01").exists() or (self.dir / "x.log").exists())

    def test_a_run_that_cannot_be_simulated_is_refused_before_the_first(self):
        self.write("short.toml", SHORT.replace('"uniformity"', '"all"'))
        says = ['simulate: the observer cannot judge "all" (add simulate_as']
        self.simulate("01", definition="short.toml", status=2, says=says)
        self.assertFalse((self.dir / "study").exists())
        self.assertEqual(self.refused(2, "experiment", "short.toml", "--power", "4", "--simulate", "seed=1", says=says).stdout, "")

    def test_a_sound_server_in_between_is_reported(self):
        # Recognised by its type alone: a plugin with that name and nothing behind it.
        self.write("alsa.conf", (self.dir / "alsa.conf").read_text() +
                   "pcm.shared { type pipewire }\npcm.!pipewire { type null }\n")
        told = self.refused(2, *self.args(device="shared"))
        self.assertFalse((self.dir / "study").exists())
        self.assertNotIn("tactor: warning: PipeWire", told.stderr)
        allowed = self.run_tool(*self.args("--allow-sound-server", device="shared"), stdin="n\n")
        self.assertIn("tactor: warning: PipeWire is between player and device", allowed.stderr)
        self.refused(2, *self.args("--masker", "shared", definition=Masking.noisy(self)))


if __name__ == "__main__":
    main()
