# SPDX-License-Identifier: MIT
"""Properties that need two real clocks or an idle machine: noise over stimuli, strokes in a row, no page fault."""
import json
import time
import unittest

import test_calibrate
import test_experiment_person
import test_questionnaire
from experiments import Terminal, noise_pieces, read_table
from harness import SANITIZED, ToolTest, main
from serving import LONG, ServeTest


class Trials(test_calibrate.CalibrateTest):
    def test_noise_covers_both_intervals_of_each_trial(self):
        self.refused(1, *test_calibrate.Person.ARGS, "--masker", "raw:noise.raw", "--masker-dbfs", -20, stdin="1\n2\n",
                     says=["trial 3: the input ended"])
        pieces = noise_pieces(self.dir / "noise.raw")
        # Three trials: half a second before interval 1, two intervals of 50 ms, half a second between.
        self.assertGreaterEqual(sum(pieces), 3 * 109)
        self.assertLessEqual(len(pieces), 3)
        self.assertGreaterEqual(min(pieces), 109)


class Sessions(test_experiment_person.PersonTest):
    noisy = test_experiment_person.Masking.noisy

    def test_noise_surrounds_each_stimulus(self):
        self.ok(*self.args("--masker", "raw:noise.raw", definition=self.noisy()), stdin=test_experiment_person.ByLines.ANSWERS)
        pieces = noise_pieces(self.dir / "noise.raw")
        # Two tactors of the walk (0.65 s), three pairs and two single stimuli after half a second each; without answers to wait
        # for, neighbours may merge.
        least = 2 * 65 + 100 * sum(0.5 + float(r["duration"]) for r in
                                   read_table(self.dir / "study/sourcedata/sub-01/practice.tsv")
                                   + self.rows("01", "pairs") + self.rows("01", "marks"))
        self.assertGreaterEqual(sum(pieces), least - 7)
        self.assertGreaterEqual(min(pieces), 64)

    def test_noise_lasts_through_the_run(self):
        self.ok(*self.args("--masker", "raw:noise.raw", definition=self.noisy('while = "run"\n')), stdin=test_experiment_person.ByLines.ANSWERS)
        pieces = noise_pieces(self.dir / "noise.raw")
        whole = [100 * (float(r["onset"]) + float(r["duration"])) for r in
                 (self.rows("01", "pairs")[-1], self.rows("01", "marks")[-1])]
        for run in whole:  # from its first sample to its last, in one piece
            self.assertTrue([p for p in pieces if p >= run], (pieces, whole))

    def test_noise_while_its_level_is_checked(self):
        self.ok("experiment", self.noisy(), "--check-noise", "-D", "null", "--masker", "raw:noise.raw", stdin="s\ns\nn\nx\nn\nq\n")
        self.assertGreaterEqual(sum(noise_pieces(self.dir / "noise.raw")), 40)


class Questionnaires(test_questionnaire.Forms):
    def test_a_key_of_the_item_before_types_nothing(self):
        t = Terminal(self, self.args())
        t.walk()
        t.answer("Age\\? 0 to 120: ", "33\n")
        t.answer("Hand\\?", "1")
        t.answer("Remark\\?", "11")  # pressed twice, and held
        t.answer("", "x1\n")
        t.answer("Ease\\?", "\n\n70\n")
        t.answer("Any key begins", " ")
        for _ in (1, 2):
            t.answer("Which one\\? 1 or 2: ", "2")
        t.answer("Tired\\? 1 no, 2 a little, 3 very: ", "2")
        t.answer("", "3")
        t.answer("Any key begins", " ")
        for _ in (1, 2):
            t.answer("How even\\?.*: ", "1")
        t.answer("Anything else\\? ", "1")
        t.answer("", "\n")
        t.answer("Again\\?", "5")
        t.answer("Any key ends", " ")
        self.assertEqual(t.end(), 0, t.said())
        self.assertEqual(self.told("about"), [["sub-01", "33", "1", "x1", "70"]])
        self.assertEqual(self.told("tired"), [["sub-01", "pairs", "3"]])
        self.assertEqual(self.told("end"), [["sub-01", "n/a", "5"]])


class Served(ServeTest):
    def test_stop_is_soon_in_a_buffer_of_two_seconds(self):
        c = self.serve("--latency-ms", "2000").client()
        stroke = c.ok("play", **LONG)["stroke"]
        c.stroke(stroke, "started")
        began = time.monotonic()
        c.ok("stop")
        self.assertEqual(c.await_end(stroke)["state"], "cancelled")
        self.assertLess(time.monotonic() - began, 0.6)

    def test_strokes_of_a_file_follow_each_other(self):
        c = self.serve().client()
        toml = "".join(f"[[stroke]]\npath = 'M 0 0 L 40 {y}'\nduration_s = 0.1\n" for y in (0, 10, 20))
        numbers = c.ok("play", toml=toml, options={"algorithm": "continuous"})["strokes"]
        starts = [c.stroke(n, "started")["started_s"] for n in numbers]
        self.assertAlmostEqual(starts[2] - starts[0], 0.2, delta=0.001)


class Memory(ToolTest):
    @unittest.skipIf(SANITIZED, "a sanitizer's own memory is not locked")
    def test_with_locked_memory_the_audio_thread_meets_no_page_fault(self):
        counters = json.loads(self.ok("play", "--path", "M 0 10 L 40 30", "--duration", "0.3", "--format", "json").stdout)["counters"]
        if not counters["locked_memory"]:
            self.skipTest("memory cannot be locked here")
        self.assertEqual((counters["minor_faults"], counters["major_faults"]), (0, 0))


if __name__ == "__main__":
    main()
