# SPDX-License-Identifier: MIT
"""tactor experiment with [sync] code: the events of a session, and what is refused. tests/study reads the codes back from the
samples, tests/vm from a card and lines."""
import json
import os
import signal
import subprocess

from experiments import DESK, SHORT, SMALL, PersonTest, contents, read_table
from harness import ROOT, main

RATE = 48000
LEAD = 9 * 96  # frames of a code
ARRAY = """[array]
preset = "palm-3x3"
[sync]
code = { channel = 15 }
"""
COLUMNS = ["onset", "duration", "trial", "attempt", "event", "code", "frame"]


class Codes(PersonTest):
    def setUp(self):
        super().setUp()
        self.write("array.toml", ARRAY)

    def events(self, task):
        return read_table(self.dir / f"study/sub-01/beh/sub-01_task-{task}_events.tsv")

    def check(self, task, motions, methods):
        """Compares the events of a run with its table, each row's stimuli and the answer or void."""
        events = iter(self.events(task))
        for row in self.rows("01", task):
            for i in (1, 2) if row["frame_2"] != "n/a" else (1,):
                e = next(events)
                place = motions.index(row["motion"]) * len(methods) + methods.index(row[f"method_{i}"])
                self.assertEqual((e["trial"], e["attempt"], e["event"], e["code"], int(e["frame"])),
                                 (row["trial"], row["attempt"], "stimulus", str(10 + place), int(row[f"frame_{i}"]) - LEAD))
                later = (int(row[f"frame_{i}"]) - int(row["frame_1"])) / RATE
                self.assertAlmostEqual(float(e["onset"]), float(row["onset"]) + later, 5)
            e = next(events)
            place = motions.index(row["motion"]) * len(methods) + methods.index(row["method_1"])
            self.assertEqual((e["trial"], e["attempt"], e["event"], e["code"], e["duration"]),
                             (row["trial"], row["attempt"], *(("void", str(30 + place)) if row["void"] == "true" else ("answer", str(20 + place))),
                              "0.000000"))
            self.assertGreaterEqual(int(e["frame"]), int(row["frame_1"]) + round(float(row["duration"]) * RATE))
        self.assertEqual(list(events), [])

    def test_simulated_sessions_record_events_and_resume_with_them(self):
        self.simulate("01", "--array", "array.toml", spec="seed=2,void=0.3")
        for task in ("whichone", "howgood", "what"):
            self.check(task, ["to the right", "down"], ["brush", "park"])
            described = json.loads((self.dir / f"study/task-{task}_events.json").read_text())
            self.assertEqual(list(described), COLUMNS)
            self.assertEqual(described["code"]["Levels"]["23"], 'answer, motion "down" by method "park"')
        self.assertEqual(self.session()["codes"], {"stimulus": 10, "answer": 20, "void": 30, "channel": 15, "bit_ms": 2.0})
        self.assertIn("Codes of stimuli, answers and void trials for a recorder: channel 15 (bits of 2 ms, exact to the sample).",
                      self.ok("report", "study").stdout)
        whole = contents(self.dir / "study")
        self.assertEqual(self.events("whichone")[0]["onset"], "0.000000")
        # A crash within the last event of the second run: its cut line is kept beside the table.
        beh = self.dir / "study/sub-01/beh"
        for name in ("beh", "events"):
            (beh / f"sub-01_task-what_{name}.tsv").unlink()
        table = beh / "sub-01_task-howgood_events.tsv"
        table.write_text(table.read_text()[:-3])
        self.simulate("01", "--array", "array.toml", "--resume", spec="seed=2,void=0.3")
        resumed = self.without_cut()
        for name in ("howgood", "what"):
            n = f"sub-01/beh/sub-01_task-{name}_events.tsv"
            last = whole[n].splitlines()[-1] + b"\n" if name == "howgood" else b""
            self.assertEqual(resumed[n] + last, whole[n])
        self.assertIn("other sessions sent codes, this one sends none", self.simulate("02").stderr)
        self.write("array.toml", ARRAY.replace("15", "14"))
        self.simulate("01", "--array", "array.toml", "--resume", spec="seed=2,void=0.3", status=2, says=["codes"])
        self.write("array.toml", '[array]\npreset = "palm-3x3"\n[output]\nchannels = 16\n')
        self.simulate("01", "--array", "array.toml", "--resume", spec="seed=2,void=0.3", status=2, says=['"codes" is not as it was'])

    def test_without_codes_there_are_no_events(self):
        self.simulate("01")
        self.assertEqual([n for n in contents(self.dir / "study") if "_events" in n], [])

    def test_what_cannot_be_sent_is_refused_with_file_and_line(self):
        for old, new, says in (("channel = 15", "channel = 4", "array.toml:4:8: code: channel 4 drives a tactor"),
                               ("[sync]", "[output]\nchannels = 12\n[sync]", "array.toml:6:8: the code's channel is 15, but there are 12 channels"),
                               ("15 }", "15 }\n[sync.codes]\nanswer = 254", 'the answer\'s number of motion "down" by method "brush" is 256'),
                               ("channel = 15", "lsl = 1", "array.toml:4:16: lsl is 1"),
                               ("channel = 15", 'chip = "c", offsets = [5, 6.7]', "array.toml:4:36: an offset is 6.7")):
            self.write("array.toml", ARRAY.replace(old, new))
            self.simulate("01", "--array", "array.toml", status=2, says=[says])
        self.write("array.toml", ARRAY)
        self.refused(2, "render", "park2016-1", "--array", "array.toml", "--channels", "12", "-o", "x.wav", says=["array.toml:4:8: the code's channel is 15"])
        self.assertFalse((self.dir / "study").exists())

    def test_answers_and_void_trials_of_a_person_have_codes_and_lsl_markers(self):
        library = self.dir / "liblsl.so"
        plain = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
        subprocess.run([os.environ.get("CC", "cc"), "-shared", "-fPIC", "-o", library, ROOT / "tests/python/stand_in_lsl.c"], check=True, env=plain)
        self.write("desk.toml", DESK + "[sync]\ncode = { channel = 2, lsl = true }\n")
        # Consent, walk, practice, a trial; the experimenter makes it void during the next one.
        said = self.dir / "said"
        self.ok(*self.args(), stdin="y\n" * 3 + "1\n" * 2 + "v\n" + "1\n" * 5, env={"PYLSL_LIB": str(library), "STAND_IN_LSL": str(said)})
        rows, events = self.rows("01", "pairs"), self.events("pairs")
        self.assertEqual([(e["trial"], e["attempt"], e["event"]) for e in events],
                         [(t, a, e) for t, a in (("1", "1"), ("2", "1")) for e in ("stimulus", "stimulus", "answer")] +
                         [("1", "1", "void")] + [("1", "2", e) for e in ("stimulus", "stimulus", "answer")])
        for row, first in zip(rows, (events[0], events[3], events[7])):
            self.assertEqual(int(first["frame"]), int(row["frame_1"]) - LEAD)
            self.assertEqual(first["onset"], row["onset"])
        self.assertEqual(int(events[6]["code"]), int(events[2]["code"]) + 10)
        self.assertLess(int(events[5]["frame"]), int(events[6]["frame"]))
        info, outlet, *marks = (line.split() for line in said.read_text().splitlines())
        self.assertEqual((info, outlet), (["info", "tactor", "Markers", "1", "0", "4", "tactor-01"], ["outlet", "0", "360"]))
        self.assertEqual([code for _, _, code in marks], [e["code"] for e in events + self.events("marks")])
        # The time of a marker is that of its event; the markers of both stimuli are sent after them.
        self.assertAlmostEqual(float(marks[1][0]) - float(marks[0][0]), float(events[1]["onset"]) - float(events[0]["onset"]), 2)

    def test_an_answer_is_kept_though_the_session_ends_while_its_code_is_sent(self):
        self.write("desk.toml", DESK + "[sync]\ncode = { channel = 2, bit_ms = 20 }\n")  # a code takes 180 ms
        self.write("short.toml", SHORT.replace("gap_s = 0.1", "gap_s = 0.3"))
        process = self.start_tool(*self.args(), stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        process.stdin.write("y\n" * 3 + "1\n" * 2)
        process.stdin.flush()
        for _ in "practice", "trial":
            while not process.stdout.readline().endswith("1 or 2: 1\n"):
                pass
        process.send_signal(signal.SIGINT)
        process.communicate()
        self.assertEqual(self.answers(), [("1", "1", "false", "1")])
        self.assertEqual([e["event"] for e in self.events("pairs")][:2], ["stimulus", "stimulus"])

    def test_a_library_that_is_none_is_refused(self):
        self.write("desk.toml", DESK + "[sync]\ncode = { lsl = true }\n")
        self.refused(3, *self.args(), env={"PYLSL_LIB": "none.so"}, says=["none.so"])


if __name__ == "__main__":
    main()
