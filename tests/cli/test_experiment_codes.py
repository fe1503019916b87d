# SPDX-License-Identifier: MIT
"""tactor experiment with [sync] code: the events of a session, and what is refused. tests/study reads the codes back from the
samples, tests/vm from a card and lines."""
import json
import os
import re
import signal
import subprocess
import time

from experiments import ADJUST, DESK, SHORT, SMALL, PersonTest, Terminal, contents, read_table
from harness import ROOT, main
import studies

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

    def levels(self, task):
        return json.loads((self.dir / f"study/task-{task}_events.json").read_text())["code"]["Levels"]

    def check(self, run, task):
        """Compares the events of a run with its table, each row's stimuli and the answer or void."""
        events = iter(self.events(task))
        levels = self.levels(task)
        for row in self.rows("01", task):
            pair = row["frame_2"] != "n/a"
            for i in (i for i in (1, 2, 3) if row.get(f"frame_{i}", "n/a") != "n/a"):
                e = next(events)
                what = f'stimulus, motion "{row["motion"]}", method "{row[f"method_{i}"]}"' + f", interval {i}" * pair
                self.assertEqual((e["trial"], e["attempt"], e["event"], levels[e["code"]], int(e["frame"])),
                                 (row["trial"], row["attempt"], "stimulus", what, int(row[f"frame_{i}"]) - LEAD))
                later = (int(row[f"frame_{i}"]) - int(row["frame_1"])) / RATE
                self.assertAlmostEqual(float(e["onset"]), float(row["onset"]) + later, 5)
            e = next(events)
            answer = f'answer, run "{run}", answer ' + (f'"{row["response"]}"' if run == "what" else row["response"])
            self.assertEqual((e["trial"], e["attempt"], e["event"], levels[e["code"]], e["duration"]),
                             (row["trial"], row["attempt"], *(("void", "void") if row["void"] == "true" else ("answer", answer)), "0.000000"))
            self.assertGreaterEqual(int(e["frame"]), int(row["frame_1"]) + round(float(row["duration"]) * RATE))
        self.assertEqual(list(events), [])

    def test_simulated_sessions_record_events_and_resume_with_them(self):
        self.simulate("01", "--array", "array.toml", spec="seed=2,void=0.3")
        for run, task in (("which-one", "whichone"), ("how good", "howgood"), ("what", "what")):
            self.check(run, task)
            described = json.loads((self.dir / f"study/task-{task}_events.json").read_text())
            self.assertEqual(list(described), COLUMNS)
            # Pairs: 2 motions by 2 methods in 2 intervals; alone: 2 by 2; answers: 2, 7 and 2 motions; void.
            levels = described["code"]["Levels"]
            self.assertEqual(list(levels), [str(n) for n in range(1, 8 + 4 + 2 + 7 + 2 + 1 + 1)])
            self.assertEqual(len(set(levels.values())), len(levels))
            self.assertEqual(levels, self.session()["codes"]["numbers"])
        listed = self.ok("experiment", "small.toml", "--dry-run", "--array", "array.toml").stdout
        self.assertEqual([line for line in listed.splitlines() if line.startswith("code ")], [f"code {n}: {text}" for n, text in levels.items()])
        self.assertEqual({k: v for k, v in self.session()["codes"].items() if k != "numbers"}, {"channel": 15, "bit_ms": 2.0})
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
        self.assertIn("other sessions sent codes, but this one does not", self.simulate("02").stderr)
        self.write("array.toml", ARRAY.replace("15", "14"))
        self.simulate("01", "--array", "array.toml", "--resume", spec="seed=2,void=0.3", status=2, says=["codes"])
        self.write("array.toml", '[array]\npreset = "palm-3x3"\n[output]\nchannels = 16\n')
        self.simulate("01", "--array", "array.toml", "--resume", spec="seed=2,void=0.3", status=2, says=['"codes" has changed since'])

    def test_each_of_three_stimuli_has_a_code(self):
        text = SMALL.partition("[[run]]")[0] + studies.toml("run", "odd", task="oddity", trials=12)
        self.write("odd.toml", text)
        self.simulate("01", "--array", "array.toml", definition="odd.toml", spec="seed=2,void=0.3")
        self.check("odd", "odd")
        self.assertEqual(len(self.events("odd")), 4 * len(self.rows("01", "odd")))
        levels = self.levels("odd").values()  # 2 motions by 2 methods in 3 intervals
        self.assertEqual([sum(part in text for text in levels) for part in ("interval 1", "interval 2", "interval 3", "answer 3")], [4, 4, 4, 1])

    def test_without_codes_there_are_no_events(self):
        self.simulate("01")
        self.assertEqual([n for n in contents(self.dir / "study") if "_events" in n], [])

    def test_what_cannot_be_sent_is_refused_with_file_and_line(self):
        for old, new, says in (("channel = 15", "channel = 4", "array.toml:4:8: code: channel 4 drives a tactor"),
                               ("[sync]", "[output]\nchannels = 12\n[sync]", "array.toml:6:8: the code's channel is 15, but there are 12 channels"),
                               ("15 }", "15 }\n[sync.codes]\nanswer = 254", 'need numbers up to 265 (void), but 255 is the largest'),
                               ("channel = 15", 'chip = "c", offsets = [5, 6, 7, 8]', 'need numbers up to 24 (void), but 15 is the largest (use more lines, or'),
                               ("channel = 15", 'chip = "c", offsets = [5, 6, 7, 8, 9], pulse_ms = 800',
                                "array.toml:4:8: code: pulse_ms is 800, but the answer's number may come 7"),
                               ('code = { channel = 15 }', 'out = { chip = "c", offset = 5, pulse_ms = 2000 }', "[sync] out: pulse_ms is 2000"),
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
        self.assertEqual([self.levels("pairs")[events[i]["code"]] for i in (2, 6)], ['answer, run "pairs", answer 1', "void"])
        self.assertLess(int(events[5]["frame"]), int(events[6]["frame"]))
        info, outlet, *marks = (line.split() for line in said.read_text().splitlines())
        self.assertEqual((info, outlet), (["info", "tactor", "Markers", "1", "0", "4", "tactor-01"], ["outlet", "0", "360"]))
        self.assertEqual([code for _, _, code in marks], [e["code"] for e in events + self.events("marks")])
        # The time of a marker is that of its event; the markers of both stimuli are sent after them.
        self.assertAlmostEqual(float(marks[1][0]) - float(marks[0][0]), float(events[1]["onset"]) - float(events[0]["onset"]), 2)

    def test_each_time_that_an_adjustment_plays_has_its_codes(self):
        self.write("desk.toml", DESK + "[sync]\ncode = { channel = 2 }\n")
        self.write("short.toml", ADJUST)
        self.ok(*self.args(), stdin="y\ny\n" + "+\n>\na\n" + "a\n" * 3)
        self.simulate("01", definition="short.toml", folder="simulated", spec="seed=1,jnd=3")
        levels = self.levels("equal")
        for folder, steps in (("study", None), ("simulated", 5)):
            events = iter(read_table(self.dir / folder / "sub-01/beh/sub-01_task-equal_events.tsv"))
            for n, row in enumerate(self.rows("01", "equal", folder)):
                value, end = int(float(row["start"])), int(float(row["value"]))
                if steps is None:
                    played = [value, min(-20, value + 5), min(-20, value + 6)] if n == 0 else [value]
                else:
                    played = [value]
                    while value != end:
                        value += (1 if end > value else -1) * (steps if abs(end - value) >= steps else 1)
                        played.append(value)
                    self.assertEqual(len(played), int(row["moves"]) + 1)
                self.assertEqual(played[-1], end)
                for level in played:
                    for i in (1, 2):
                        e = next(events)
                        what = f", interval {i}" if row[f"method_{i}"] == "standard" else f", level_dbfs {level}, interval {i}"
                        kind = "standard" if row[f"method_{i}"] == "standard" else "stimulus"
                        self.assertEqual((e["trial"], e["event"], levels[e["code"]]), (row["trial"], kind, f'{kind}, motion "east", method "Birch"{what}'))
                self.assertEqual(int(e["frame"]), int(row["frame_2"]) - LEAD)  # the row is about the last of them
                e = next(events)
                self.assertEqual((e["event"], levels[e["code"]]), ("answer", 'answer, run "equal"'))
            self.assertEqual(list(events), [])

    def box(self):
        """Returns both ends of a terminal that stands for a trigger box, and its path. The tool's end stays open."""
        box, port = os.openpty()
        for end in (box, port):
            self.addCleanup(os.close, end)
        os.set_blocking(box, False)
        return box, os.ttyname(port)

    def test_a_serial_trigger_box_gets_each_number_and_then_0(self):
        box, path = self.box()
        self.write("desk.toml", DESK + f'[sync]\ncode = {{ serial = "{path}", baud = 57600 }}\n')
        listed = self.ok("experiment", "short.toml", "--dry-run").stdout
        self.assertIn('code 1: stimulus, motion "east", method "Alder"', listed)
        said = self.ok(*self.args(), stdin="y\n" * 3 + "1\n" * 5).stderr
        sent = b""
        while not sent.endswith(b"\0") or len(sent) < 2:  # the kernel hands them over a while later
            try:
                sent += os.read(box, 4096)
            except BlockingIOError:
                time.sleep(0.01)
        events = self.events("pairs") + self.events("marks")
        codes = [int(e["code"]) for e in events]
        # A busy machine may miss the time of a stimulus, and says so; each answer has its byte.
        numbers = [n for n in sent if n]
        count, missed = map(int, re.search(r"serial port of codes: (\d+) pulses? for stimuli, (\d+) missed, late by ", said).groups())
        self.assertEqual((sent[0], sent[-1], len(codes) - len(numbers) <= missed), (0, 0, True), (sent, said))
        rest = iter(codes)
        self.assertTrue(all(n in rest for n in numbers), (codes, numbers))
        answers = [c for c, e in zip(codes, events) if e["event"] == "answer"]
        self.assertEqual([n for n in numbers if n in answers], answers)
        # Walk and practice send no numbers, so they do not count.
        pulses = self.session()["streams"][0]["pulses"]
        self.assertEqual((pulses["sent"], pulses["missed"], count), (len(numbers) - len(answers), missed, pulses["sent"]))
        self.assertLessEqual(pulses["mean_late_s"], pulses["worst_late_s"])
        self.assertEqual({k: v for k, v in self.session()["codes"].items() if k != "numbers"}, {"serial": {"baud": 57600}})
        self.assertIn("for a recorder: a serial port (57600 baud).", self.ok("report", "study").stdout)

    def test_a_session_goes_on_without_a_trigger_box_that_has_gone(self):
        box, port = os.openpty()
        self.write("desk.toml", DESK + f'[sync]\ncode = {{ serial = "{os.ttyname(port)}" }}\n')
        pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
        process = self.start_tool(*self.args(), **pipes, text=True)
        self.assertEqual(os.read(box, 1), b"\0")
        os.close(port)
        os.close(box)
        said = process.communicate("y\n" * 3 + "1\n" * 5)[1]
        self.assertEqual(process.returncode, 0, said)
        self.assertEqual(said.count("tactor: the serial port did not accept a code\n"), 4)  # of an answer
        self.assertEqual([e["event"] for e in self.events("marks")], ["stimulus", "answer"] * 2)

    def test_what_is_no_serial_port_is_refused_before_the_first_trial(self):
        self.write("as-it-was", "as it was")
        for path, status, says in (("/dev/ttyNONE", 3, "No such file or directory"), ("/dev/null", 2, "it is not a serial port"),
                                   (f"{self.dir}/as-it-was", 2, "it is not a serial port")):
            self.write("desk.toml", DESK + f'[sync]\ncode = {{ serial = "{path}" }}\n')
            self.refused(status, *self.args(), stdin="", says=(f"desk.toml:5:8: serial: {path}: {says}",))
        self.assertEqual((self.dir / "as-it-was").read_text(), "as it was")
        self.write("desk.toml", DESK + '[sync]\ncode = { serial = "/dev/tty" }\n')
        t = Terminal(self, self.args())
        self.assertEqual(t.end(), 2)
        self.assertIn("serial: /dev/tty: it is the terminal of this session", t.said())
        self.write("desk.toml", DESK + '[sync]\ncode = { serial = "/dev/ttyS0", baud = 1 }\n')
        self.refused(2, "experiment", "short.toml", "--dry-run", says=("desk.toml:5:40: baud is 1 (use one of 4800, 9600, ",))
        self.assertFalse((self.dir / "study").exists())

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

    def test_values_standards_and_catch_trials_have_numbers_of_their_own(self):
        runs = (studies.run("jnd", "constant", 16, question="?", vary="length_mm", values=[4, 8], standard=6, motions=["down"], methods=["park"])
                + studies.run("felt", "detect", 20, vary="level_dbfs", values=[-40, -30], catch=0.2, motions=["down"], methods=["park"])
                + studies.run("size", "estimate", 4, question="?", vary="level_dbfs", values=[-30, -20], motions=["down"], methods=["park"]))
        # A level in dBFS: nobody's thresholds are needed.
        text = SMALL.partition("[[run]]")[0].replace("gap_s", "level = { dbfs = -20 }\ngap_s") + runs
        definition = self.small(text)
        self.simulate("01", "--array", "array.toml", definition=definition, spec="seed=1,jnd=2")
        one = 'motion "down", method "park"'
        expected = ([f"stimulus, {one}, length_mm {v}, interval {i}" for v in (4, 8) for i in (1, 2)]
                    + [f"stimulus, {one}, level_dbfs {v}" for v in (-40, -30)] + [f"stimulus, {one}, level_dbfs {v}" for v in (-20,)]
                    + [f"standard, {one}, interval {i}" for i in (1, 2)] + [f"catch, {one}"]
                    + [f'answer, run "{r}", answer {n}' for r in ("jnd", "felt") for n in (1, 2)] + ['answer, run "size"', "void"])
        self.assertEqual(list(self.levels("felt").values()), expected)
        levels = self.levels("felt")
        for task in ("jnd", "felt"):
            rows = {r["trial"]: r for r in self.rows("01", task)}
            for e in self.events(task):
                row = rows[e["trial"]]
                if e["event"] == "catch":
                    self.assertEqual(row["method_1"], "none")
                elif e["event"] == "standard":
                    self.assertEqual(row[f"method_{levels[e['code']][-1]}"], "standard")
                elif e["event"] == "stimulus":
                    self.assertIn(f" {float(row['value']):g}", levels[e["code"]])
        # Joined: one number for all values and both intervals.
        self.write("array.toml", ARRAY + '[sync.codes]\nstimulus = { first = 10, by = ["motion", "method"] }\nstandard = { by = [] }\nanswer = 200\n')
        listed = json.loads(self.ok("experiment", definition, "--dry-run", "--array", "array.toml", "--format", "json").stdout)["codes"]
        self.assertEqual([(c["code"], c["meanings"]) for c in listed[:4]],
                         [(10, [f"stimulus, {one}"]), (11, ["standard"]), (12, [f"catch, {one}"]), (200, ['answer, run "jnd", answer 1'])])
        many = studies.run("many", "constant", 0, question="?", vary="length_mm", values=list(range(4, 40)), standard=6).replace("trials = 0\n", "trials_per_value = 2\n")
        self.write("array.toml", ARRAY)
        self.small(text + many)
        self.refused(2, "experiment", definition, "--dry-run", "--array", "array.toml",
                     says=["array.toml:4:8: code: ", 'combine events under [sync.codes]: stimulus = { by = ["motion", "method"] }'])

    def test_a_library_that_is_none_is_refused(self):
        self.write("desk.toml", DESK + "[sync]\ncode = { lsl = true }\n")
        self.refused(3, *self.args(), env={"PYLSL_LIB": "none.so"}, says=["none.so"])


if __name__ == "__main__":
    main()
