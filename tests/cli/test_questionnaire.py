# SPDX-License-Identifier: MIT
"""Questionnaires of tactor experiment: asked at the terminal, by lines and on the page; their tables; sessions that go on."""
import json

from experiments import SHORT, PersonTest, Terminal, contents, read_table
from harness import ROOT, main
from pages import PageTest
from studies import toml

FORMS = SHORT.replace("practice = 1\n", "").replace("animation = true\n", "") + toml(
    "run", "about", task="questionnaire", title="About you", text="Four questions.") + """item = [
  { name = "age", question = "Age?", kind = "number", range = [0, 120] },
  { name = "hand", question = "Hand?", kind = "choice", choices = ["left", "right"] },
  { name = "remark", question = "Remark?", kind = "text" },
  { name = "ease", question = "Ease?", kind = "scale", scale = "vas", labels = ["ill", "well"] },
]
""" + (toml("run", "tired", task="questionnaire", when="between") + toml("run.item", "now", question="Tired?", kind="scale", labels=["no", "a little", "very"])
       + toml("run", "end", task="questionnaire", when="after") + toml("run.item", "remark", question="Anything else?", kind="text")
       + toml("run.item", "again", question="Again?", kind="scale", scale=5, labels=["never", "always"]))
AGREED = "y\n" * 3
EXAMPLE = ROOT / "examples/experiments/questionnaires.toml"


class Forms(PersonTest):
    def setUp(self):
        super().setUp()
        self.write("short.toml", FORMS)

    def begun(self):
        """Returns the answers to a questionnaire that is not complete."""
        return json.loads((self.dir / "study/sourcedata/sub-01/session.json").read_text()).get("answers")

    def told(self, name):
        return [list(row.values()) for row in read_table(self.dir / f"study/phenotype/{name}.tsv")]


class AtTheTerminal(Forms):
    def test_letters_are_text_and_the_experimenter_s_keys_elsewhere(self):
        t = Terminal(self, self.args())
        t.walk()
        t.answer("About you\\s+Four questions.\\s+Age\\? 0 to 120: ", "121\n")
        t.answer("not an answer: 0 to 120: ", "p3\x7f33\n")  # a pause comes
        t.answer("A pause", "g")
        t.answer("Hand\\? 1 left, 2 right, b Back: ", "32")
        t.answer("Remark\\? Backspace Back: ", "rvpgq é\x7fë\x1b[Dx\n")
        t.answer("Ease\\? 0 \\(ill\\) to 100 \\(well\\), b Back: ", "70\n")
        t.answer("Any key begins", " ")
        for _ in (1, 2):
            t.answer("Which one\\? 1 or 2: ", "1")
        t.answer("Tired\\? 1 no, 2 a little, 3 very: ", "2")
        t.answer("(?s)A break.*Any key begins", " ")
        for _ in (1, 2):
            t.answer("How even\\?.*: ", "1")
        t.answer("Anything else\\? ", "\n")
        t.answer("Again\\? 1 \\(never\\) to 5 \\(always\\), b Back: ", "5")
        t.answer("Any key ends", " ")
        self.assertEqual(t.end(), 0, t.said())
        self.assertIn("rvpgq é\b \bëx", t.all)
        self.assertEqual(self.told("about"), [["sub-01", "33", "2", "rvpgq ëx", "70"]])
        self.assertEqual(read_table(self.dir / "study/phenotype/tired.tsv"), [{"participant_id": "sub-01", "after": "pairs", "now": "2"}])
        self.assertEqual(self.told("end"), [["sub-01", "n/a", "5"]])

    def test_lines_are_whole_texts(self):
        lines = AGREED + "33\n1\n q  \"x\"\n0\n" + "1\n1\n" + "3\n" + "1\n1\n" + '"quoted" n/a\n9\n1\n'
        said = self.ok(*self.args(), stdin=lines).stdout
        self.assertIn("That is not an answer: 1 (never) to 5 (always)", said)
        self.assertEqual(self.told("about"), [["sub-01", "33", "1", '" q  ""x"""', "0"]])
        self.assertEqual(self.told("end")[0][1], '"""quoted"" n/a"')  # or it would be read without its quotes
        self.assertIn("finished", self.ok(*self.args("--resume"), stdin="").stdout)

    def test_ctrl_c_in_a_text_ends_and_the_session_goes_on_there(self):
        t = Terminal(self, self.args())
        t.walk()
        t.answer("Age\\?", "2\n")
        t.answer("Hand\\?", "1")
        t.answer("Remark\\? Backspace Back: ", "abc\x03")
        self.assertEqual(t.end(), 130)
        self.assertEqual(self.begun(), {"about": ["2", "1"]})
        self.assertFalse((self.dir / "study/phenotype/about.tsv").exists())
        # A code that is mistyped begins no other session.
        self.refused(2, *[{"01": "1"}.get(a, a) for a in self.args("--resume")], says=("there is no sub-1 in study",))
        said = self.ok(*self.args("--resume"), stdin="y\ny\n" + "words\n50\n" + "1\n1\n" + "3\n" + "1\n1\n" + "x\n1\n").stdout
        self.assertEqual(self.told("about"), [["sub-01", "2", "1", "words", "50"]])
        self.assertNotIn("Age?", said)
        self.assertIsNone(self.begun())

    def test_nothing_is_written_before_the_first_answer(self):
        t = Terminal(self, self.args())
        t.walk()
        t.answer("Age\\?", "12\x03")
        self.assertEqual(t.end(), 130)
        self.assertFalse((self.dir / "study").exists())

    def test_b_goes_one_item_back(self):
        t = Terminal(self, self.args())
        t.walk()
        t.answer("Age\\? 0 to 120: ", "33\n")
        t.answer("Hand\\? 1 left, 2 right, b Back: ", "b")
        t.answer("Age\\? 0 to 120: ", "34\n")
        t.answer("Hand\\?", "1")
        t.answer("Remark\\? Backspace Back: ", "\x7f")
        t.answer("Hand\\?", "2")
        t.answer("Remark\\?", "b\x7fbb\n")  # letters are text, and Backspace deletes them
        t.answer("Ease\\? 0 \\(ill\\) to 100 \\(well\\), b Back: ", "7b")
        t.answer("Remark\\?", "c\n")
        t.answer("Ease\\?", "70\n")
        t.until("Any key begins")
        self.assertEqual(self.told("about"), [["sub-01", "34", "2", "c", "70"]])
        t.key("b")
        t.answer("Ease\\?", "71\n")
        t.until("Any key begins")
        self.assertEqual(self.told("about"), [["sub-01", "34", "2", "c", "71"]])
        t.key(" ")
        for _ in (1, 2):
            t.answer("Which one\\? 1 or 2: ", "b1")  # and nothing else
        t.answer("Tired\\? 1 no, 2 a little, 3 very: ", "2")
        t.answer("A break", "b")
        t.answer("Tired\\?", "3")
        t.answer("Any key begins", " ")
        for _ in (1, 2):
            t.answer("How even\\?.*: ", "1")
        t.answer("Anything else\\? ", "x\n")
        t.answer("Again\\? 1 \\(never\\) to 5 \\(always\\), b Back: ", "5")
        t.answer("Any key ends", "b")
        t.answer("Again\\?", "4")
        t.answer("Any key ends", " ")
        self.assertEqual(t.end(), 0, t.said())
        self.assertEqual(self.told("tired"), [["sub-01", "pairs", "3"]])
        self.assertEqual(self.told("end"), [["sub-01", "x", "4"]])

    def test_lines_go_back_too(self):
        lines = AGREED + "33\nb\n34\n1\nb\nb\nc\n1\n" + "1\n1\n" + "2\n" + "1\n1\n" + "x\nb\ny\n4\n"
        self.ok(*self.args(), stdin=lines)
        self.assertEqual(self.told("about"), [["sub-01", "34", "1", "c", "1"]])
        self.assertEqual(self.told("end"), [["sub-01", "y", "4"]])

    def test_v_within_a_questionnaire_makes_no_trial_void(self):
        lines = AGREED + "33\n1\nx\n0\n" + "1\n1\n" + "v\n3\n" + "1\n1\n" + "y\nv\n1\n"
        said = self.ok(*self.args(), stdin=lines).stderr
        self.assertEqual(said.count("v does not work within a questionnaire; b goes one item back"), 2)
        self.assertEqual([r["void"] for r in self.rows("01", "pairs")], ["false"] * 2)
        self.assertEqual([r["void"] for r in self.rows("01", "marks")], ["false"] * 2)


class OnThePage(Forms, PageTest):
    def test_a_form_goes_on_at_its_next_item_until_it_is_complete(self):
        s, p = self.start_both()
        p.answer("consent", 1)
        p.walk()
        asked = p.answer("questionnaire", 1)
        self.assertEqual((asked["question"], asked["text"], asked["choices"]), ("About you", "Four questions.", ["Begin"]))
        p.answer("questionnaire", 33)
        p.answer("questionnaire", 1)
        p.until("questionnaire")
        s.process.kill()
        s.end()
        self.assertEqual(self.begun(), {"about": ["33", "1"]})
        self.assertFalse((self.dir / "study/phenotype/about.tsv").exists())
        s, p = self.start_both("--resume")
        p.walk()
        p.answer("questionnaire", 1)
        for item, back in ((3, True), (2, True), (1, False)):
            asked = p.until("questionnaire")
            self.assertEqual((asked["progress"]["trial"], asked["progress"]["trials"], asked.get("back", False)), (item, 4, back))
            p.say(ask=asked["ask"], back=True)
        self.assertEqual(asked["entry"], {"lowest": 0, "greatest": 120})
        self.assertEqual(p.until("questionnaire")["ask"], asked["ask"])  # there is nothing before it
        p.say(ask=asked["ask"], answer=121)
        p.answer("questionnaire", 0)
        p.answer("questionnaire", 2)
        asked = p.until("questionnaire")
        s.key("p")
        s.told("a pause comes before the next question")
        self.assertEqual(asked["entry"], {"most": 2000})
        p.say(ask=asked["ask"], text="x" * 2001)
        self.assertEqual(p.until("questionnaire")["ask"], asked["ask"])
        p.say(ask=asked["ask"], text="two\nlines\tand\x07\n€")
        p.until("pause", asked=False)
        s.key("g")
        asked = p.until("questionnaire")
        s.key("b")  # the experimenter, for the participant
        asked = p.until("questionnaire")
        p.say(ask=asked["ask"], text="one\nline€")
        self.assertEqual(len(p.answer("questionnaire", 101)["choices"]), 101)
        asked = p.until("introduce")
        self.assertEqual(self.told("about"), [["sub-01", "0", "2", "one\\nline€", "100"]])
        p.say(ask=asked["ask"], back=True)
        p.answer("questionnaire", 100)
        p.until("introduce")
        s.process.kill()  # the form is complete
        s.end()
        self.assertEqual(self.told("about"), [["sub-01", "0", "2", "one\\nline€", "99"]])
        self.assertIsNone(self.begun())
        s, p = self.start_both("--resume")
        p.begin(agrees=False)
        for _ in (1, 2):
            p.answer("question", 1)
        p.until("questionnaire")
        s.key("q")
        self.assertEqual(s.end(), 130)
        self.assertFalse((self.dir / "study/phenotype/tired.tsv").exists())
        s, p = self.start_both("--resume")
        p.walk()
        p.answer("questionnaire", 3)
        p.answer("introduce", 1)
        for _ in (1, 2):
            p.answer("question", 1)
        p.until("questionnaire")  # all trials are done
        s.process.kill()
        s.end()
        s, p = self.start_both("--resume")
        asked = p.until("questionnaire")  # and nothing is left to be felt
        p.say(ask=asked["ask"], text="")
        p.answer("questionnaire", 1)
        self.assertEqual(s.end(), 0, s.said)
        self.assertEqual(self.told("tired"), [["sub-01", "pairs", "3"]])
        self.assertEqual(self.told("end"), [["sub-01", "n/a", "1"]])
        self.assertIn("finished", self.ok(*self.args("--resume")).stdout)


class Tables(Forms):
    def test_answers_are_drawn_and_lines_of_others_stay(self):
        self.simulate("01", definition="short.toml")
        whole = contents(self.dir / "study")
        table = self.dir / "study/phenotype/about.tsv"
        self.assertEqual(self.told("about")[0][3], "simulated")
        added = table.read_text().replace("age\t", "rater\tage\t").replace("sub-01\t", "sub-01\tA. B.\t").rstrip("\n")
        table.write_text(added)
        self.simulate("02", definition="short.toml")
        self.assertTrue(table.read_text().startswith(added + "\nsub-02\tn/a\t"), table.read_text())
        # A session that goes on draws what it would have drawn.
        table.write_bytes(whole["phenotype/about.tsv"])
        last = self.dir / "study/phenotype/end.tsv"
        last.unlink()
        self.simulate("01", "--resume", definition="short.toml")
        self.assertEqual(last.read_bytes(), whole["phenotype/end.tsv"])
        report = self.ok("report", "study").stdout
        self.assertIn("**Questionnaire about**: About you, before the first run, 4 items. Answered by 1 of 2 participants, 1 time in all.", report)
        self.assertIn("**Questionnaire tired**: after each run but the last, 1 item. Answered by 2 of 2 participants, 2 times in all.", report)
        self.assertEqual(list(self.analysis()["runs"]), ["pairs", "marks"])
        self.ok("experiment", "short.toml", "--simulate", "seed=1", "--power", "2", "--studies", "1")
        table.write_text("participant_id\tage\n")
        self.simulate("03", definition="short.toml", status=2, says=("phenotype/about.tsv", "hand"))

    def test_the_report_refuses_an_impossible_answer(self):
        self.simulate("01", definition="short.toml")
        table = self.dir / "study/phenotype/tired.tsv"
        table.write_text("participant_id\tafter\tnow\nsub-01\tpairs\t4\n")
        self.refused(2, "report", "study", says=('phenotype/tired.tsv:2: now is "4" (give a whole number from 1 to 3)',))
        table.write_text("participant_id\tafter\tnow\nsub-01\tpairs\tn/a\n")
        self.ok("report", "study")

    def test_each_session_asks_anew_and_the_report_counts_people(self):
        self.edit("short.toml", "gap_s", "sessions = 2\ngap_s")
        for session in ("1", "2"):
            self.simulate("01", "--session", session, definition="short.toml")
        first, second = read_table(self.dir / "study/phenotype/about.tsv")
        self.assertEqual([first.pop("session"), second.pop("session")], ["1", "2"])
        self.assertNotEqual(first, second)
        self.assertIn("4 items. Answered by 1 of 1 participant, 2 times in all.", self.ok("report", "study").stdout)

    def test_the_description_has_questions_and_levels(self):
        self.simulate("01", definition="short.toml")
        told = json.loads((self.dir / "study/phenotype/about.json").read_text())
        self.assertIn("About you, asked before the first run. Four questions.", told["MeasurementToolMetadata"]["Description"])
        self.assertEqual(told["age"], {"Description": "Age?"})
        self.assertEqual(told["hand"], {"Description": "Hand?", "Levels": {"1": "left", "2": "right"}})
        self.assertEqual(told["ease"]["Levels"], {"0": "ill", "100": "well"})

    def test_a_dry_run_lists_them(self):
        self.assertIn("questionnaire end: after the last run, 2 items\n", self.ok("experiment", "short.toml", "--dry-run").stdout)
        told = json.loads(self.ok("experiment", "short.toml", "--dry-run", "--format", "json").stdout)["questionnaires"]
        self.assertEqual(told[1], {"name": "tired", "when": "after each run but the last", "items": ["now"]})

    def test_the_example_runs(self):
        self.assertIn("symptoms: after the last run, 16 items", self.ok("experiment", EXAMPLE, "--dry-run").stdout)
        self.simulate("01", definition=EXAMPLE)
        row, = read_table(self.dir / "study/phenotype/symptoms.tsv")
        self.assertEqual(len(row), 17)
        self.assertLessEqual({v for k, v in row.items() if k != "participant_id"}, set("1234"))
        about, = read_table(self.dir / "study/phenotype/demographics.tsv")
        self.assertIn(int(about["age"]), range(18, 121))


if __name__ == "__main__":
    main()
