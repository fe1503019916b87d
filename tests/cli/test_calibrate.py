# SPDX-License-Identifier: MIT
"""tactor calibrate: simulated sessions, sessions of a person at a terminal, through a pipe and on the page, and refusals.
tests/study has the staircase, the logs that resume, and the arrays that come of them."""
import csv
import json
import re
import resource
import signal
import tomllib

from experiments import noise_pieces
from harness import ALSA_CONFIG, FELT_CONFIG, PATIENCE_S, ToolTest, main
from pages import Session
from terminal import Terminal

OBSERVER = "threshold=-45,spread=2,lapse=0.02"
SHORT = ("--reversals", 4, "--discard", 2)
PALM = '[array]\npreset = "palm-3x3"\n'
TWO = '[array]\nname = "a"\ngrid = { rows = 1, columns = 2, pitch_mm = 20.0 }\n'


def replaced(args, *more):
    """Returns the arguments of a command with more options, each in the place of the same one."""
    return (args[0], *(x for pair in zip(args[1::2], args[2::2]) if pair[0] not in more for x in pair), *more)


class CalibrateTest(ToolTest):
    ARGS = ("calibrate", "--participant", "P1", "-o", "me.toml", "-D", "null", "--tactors", 1, "--interval", 0.05,
            "--start-dbfs", -20)

    def simulated(self, name, *args, spec=OBSERVER):
        return self.ok("calibrate", "--participant", "P07", "-o", name, "--simulate", spec, *args)

    def rows(self, name="me.tsv"):
        with (self.dir / name).open(newline="") as file:
            return list(csv.DictReader(file, delimiter="\t"))

    def responses(self):
        return [r["response"] for r in self.rows()]

    def toml(self, name="me.toml"):
        return tomllib.loads((self.dir / name).read_text())


class Simulated(CalibrateTest):
    def test_the_result_is_an_array_for_every_command(self):
        self.write("desk.toml", PALM + "[[tactor]]\ntactor = 1\ngain_db = -3.0\n[limits]\nmax_drive_s = 4\n[defaults]\ncarrier = 200\n")
        said = self.simulated("me.toml", "--tactors", "0-8", "--array", "desk.toml", "--seed", 4)
        self.assertIn("SIMULATED", said.stdout)
        plan = self.plan("park2016-3", "--array", "me.toml", "--sl", 7)
        made = self.toml()
        for got, tactor, entry in zip(made["calibration"]["tactor"], made["tactor"], plan["array"]["tactors"]):
            self.assertEqual(got["threshold_dbfs"], tactor["threshold_dbfs"])
            self.assertEqual(got["threshold_dbfs"], entry["threshold_dbfs"])
            self.assertLess(abs(got["threshold_dbfs"] + 44.5), 4)
        for command in (("render", "park2016-3", "-o", "x.wav"), ("play", "park2016-3", "-D", "null"), ("check",)):
            self.ok(*command, "--array", "me.toml", *([] if command[0] == "check" else ["--sl", 7]))
        told = made["calibration"]
        self.assertEqual({k: told[k] for k in ("participant", "method", "rule", "carrier_hz", "interval_s", "feedback",
                                               "masker", "simulated", "seed")},
                         {"participant": "P07", "method": "staircase", "rule": "1up3down", "carrier_hz": 200,
                          "interval_s": 0.5, "feedback": True, "masker": "none", "simulated": True, "seed": 4})
        self.assertRegex(told["date"], r"^\d{4}-\d\d-\d\d$")
        self.assertEqual((made["tactor"][1]["gain_db"], made["limits"]["max_drive_s"]), (-3, 4))

    def test_thresholds_of_others_and_other_carriers(self):
        self.simulated("P07.toml", *SHORT)
        said = self.ok("calibrate", "--participant", "P08", "-o", "P08.toml", "--simulate", OBSERVER, "--array", "P07.toml",
                       "--tactors", "0-6", *SHORT)
        self.assertIn("thresholds are P07's, simulated: those of tactors 7, 8 are left out", said.stderr)
        self.assertEqual(["threshold_dbfs" in t for t in self.toml("P08.toml")["tactor"]], [True] * 7 + [False] * 2)
        # Thresholds of the same participant stay, also those of another carrier.
        said = self.simulated("both.toml", "--array", "P07.toml", "--tactors", 0, "--carrier", 100, *SHORT)
        self.assertNotIn("left out", said.stderr)
        thresholds = [t["threshold_dbfs"] for t in self.toml("both.toml")["tactor"]]
        self.assertEqual([[p[0] for p in t] for t in thresholds], [[100, 250]] + [[250]] * 8)
        self.simulated("at100.toml", "--carrier", 100, *SHORT)
        told = "thresholds were measured at 100 Hz, but a carrier is 250 Hz"
        at = ("--array", "at100.toml", "--sl", 7)
        for command in (("plan", "park2016-1"), ("play", "park2016-1", "park2016-1", "-D", "null")):
            self.assertEqual(self.ok(*command, *at).stderr.count(told), 1)
            self.assertNotIn(told, self.ok(*command, *at, "--carrier", 100).stderr)

    def test_a_measured_tactor_can_be_played_while_the_rest_is_not_measured(self):
        said = self.simulated("me.toml", "--tactors", "4,5", *SHORT, spec="threshold=-45,500,spread=2")
        self.assertIn("tactor 5 has no threshold (not felt)", said.stderr)
        self.assertNotIn("tactor 4 has no", said.stderr)
        plan = self.plan("--path", "M 20 20 L 20.001 20", "--array", "me.toml", "--sl", 7)
        self.assertEqual([p is None for p in plan["render"]["peak_dbfs"]], [i != 4 for i in range(9)])
        self.refused(2, "render", "park2016-1", "--array", "me.toml", "--sl", 7, "-o", "y.wav")

    def test_log_and_result_agree(self):
        self.simulated("me.toml", "--tactors", "3,1", "--practice", 2)
        rows, told = self.rows(), self.toml()["calibration"]["tactor"]
        self.assertEqual(list(rows[0]), "trial tactor level_dbfs interval response correct reversal practice "
                                        "response_time_s onset_frame".split())
        self.assertEqual([int(r["trial"]) for r in rows], list(range(1, len(rows) + 1)))
        self.assertEqual([r["practice"] for r in rows[:3]], ["true", "true", "false"])
        self.assertEqual([t["tactor"] for t in told], [3, 1])
        for t in told:
            own = [r for r in rows if r["tactor"] == str(t["tactor"]) and r["practice"] == "false"]
            self.assertEqual(len(own), t["trials"])
            self.assertEqual([float(r["level_dbfs"]) for r in own if r["reversal"] == "true"], t["reversals_dbfs"])
            self.assertAlmostEqual(t["threshold_dbfs"], sum(t["reversals_dbfs"][-8:]) / 8, 9)
            for checks, key in ((own[-20:-10], "check_right"), (own[-10:], "check_below_right")):
                self.assertEqual(sum(r["correct"] == "true" for r in checks), t[key])
        for r in rows:
            self.assertEqual(r["correct"] == "true", r["interval"] == r["response"])

    def test_quest_asks_thirty_times_and_gives_a_posterior_deviation(self):
        args = ("--method", "quest", "--tactors", "3,1,4", "--practice", 1)
        said = self.simulated("me.toml", *args)
        self.assertRegex(said.stdout, r"tactor   3  +-4\d\.\d\d dBFS, posterior sd \d\.\d\d dB, 30 trials\n")
        rows, told = self.rows(), self.toml()["calibration"]
        self.assertEqual((len(rows), told["method"], told["feedback"], "rule" in told), (91, "quest", True, False))
        self.assertEqual({r["reversal"] for r in rows}, {"false"})
        for t in told["tactor"]:
            self.assertEqual(set(t), {"tactor", "threshold_dbfs", "posterior_sd_db", "trials", "reversals_dbfs"})
            self.assertEqual((t["trials"], t["reversals_dbfs"]), (30, []))
            self.assertLess(abs(t["threshold_dbfs"] + 45), 8)
        # A session that goes on asks what the whole one asked.
        whole = (self.dir / "me.tsv").read_bytes()
        (self.dir / "me.toml").unlink()
        (self.dir / "me.tsv").write_bytes(b"".join(whole.splitlines(keepends=True)[:50]))
        self.simulated("me.toml", *args, "--resume")
        self.assertEqual((self.dir / "me.tsv").read_bytes(), whole)
        self.refused(2, "calibrate", "--participant", "P07", "-o", "me.toml", "--simulate", OBSERVER, *args, "--trials", 31, "--resume", says=("trials",))
        less = self.simulated("less.toml", *args, "--stop-sd", 4)
        self.assertTrue(all(t["trials"] < 30 and t["posterior_sd_db"] <= 4 for t in self.toml("less.toml")["calibration"]["tactor"]), less.stdout)

    def test_a_disk_that_fills_loses_no_trial(self):
        self.simulated("whole.toml", *SHORT, "--tactors", 0)
        args = ("calibrate", "--participant", "P07", "-o", "me.toml", "--simulate", OBSERVER, *SHORT, "--tactors", 0)
        whole = (self.dir / "whole.tsv").read_bytes()
        self.refused(1, *args, before=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (700, 700)), says=("me.tsv: File too large",))
        self.assertTrue(whole.startswith((self.dir / "me.tsv").read_bytes()))
        self.assertFalse((self.dir / "me.toml").exists())
        self.ok(*args, "--resume")
        self.assertEqual((self.dir / "me.tsv").read_bytes(), whole)

    def test_a_threshold_far_above_the_others_is_named_and_can_be_measured_again(self):
        said = self.simulated("me.toml", "--tactors", "0-4", spec="threshold=-45,-44,-46,-20,-45,spread=1")
        self.assertRegex(said.stderr, r"tactor: warning: tactor 3: the threshold is likely to be too high: it is 2\d\.\d dB above "
                                      r"the array's median of -4\d\.\d dBFS \(measure it again: --tactors 3 --array me\.toml")
        self.assertEqual(said.stderr.count("too high"), 1)
        again = self.simulated("again.toml", "--tactors", 3, "--array", "me.toml", spec="threshold=-45,spread=1")
        self.assertNotIn("too high", again.stderr)
        first, second = (self.toml(name)["tactor"] for name in ("me.toml", "again.toml"))
        self.assertEqual([a == b for a, b in zip(first, second)], [i != 3 for i in range(9)])
        # An earlier session's outlier stays named, and adjustments are checked alike.
        said = self.simulated("third.toml", "--tactors", 0, "--array", "me.toml", "--method", "adjustment", spec="threshold=-45,spread=1")
        self.assertIn("warning: tactor 3: the threshold is likely", said.stderr)

    def test_the_observer_has_a_seed_like_that_of_an_experiment(self):
        found = []
        for n, seed in enumerate((1, 2, 1)):
            self.simulated(f"{n}.toml", "--tactors", "0-2", spec=f"seed={seed},threshold=-45,spread=2")
            found.append([t["threshold_dbfs"] for t in self.toml(f"{n}.toml")["calibration"]["tactor"]])
        self.assertEqual(found[0], found[2])
        self.assertNotEqual(found[0], found[1])

    def test_a_level_that_does_not_fit_is_warned_of_at_once_and_refused_later(self):
        self.write("weak.toml", PALM + "".join(f"[[tactor]]\ntactor = {i}\nmax_dbfs = -10\n" for i in range(9)))
        said = self.simulated("me.toml", "--array", "weak.toml", spec="threshold=-14,spread=0.5")
        self.assertRegex(said.stderr, r"tactor 0: a level 7 dB above its threshold of -1\d\.\d\d dBFS exceeds its limit by \d\.\d\d dB")
        self.refused(2, "render", "--path", "M 0 0 L 0.001 0", "--array", "me.toml", "--sl", 7, "-o", "x.wav")

    def test_no_level_is_above_the_array_s_limit(self):
        self.write("low.toml", PALM + '[[tactor]]\ntactor = 4\nmax_dbfs = -25\n[limits]\npower_dbfs = -18\n')
        self.simulated("me.toml", "--array", "low.toml", "--practice", 1, *SHORT, spec="threshold=0,spread=0")
        rows = self.rows()
        self.assertEqual(max(float(r["level_dbfs"]) for r in rows), -18.001)
        of_4 = [float(r["level_dbfs"]) for r in rows if r["tactor"] == "4"]
        self.assertEqual((of_4[0], max(of_4)), (-25, -25))

    def test_the_first_line_has_the_ceiling_of_each_tactor(self):
        self.write("mixed.toml", PALM + '[[tactor]]\ntactor = 4\nmax_dbfs = -25\n')
        args = ("--array", "mixed.toml", "--tactors", "3-5", *SHORT)
        first = ["tactor: highest level: 0 dBFS at tactors 3, 5; -25 dBFS at tactor 4",
                 "tactor: warning: no max_dbfs limits tactors 3, 5: the level may reach full scale (set max_dbfs in [array] or [[tactor]] "
                 "of the array file)"]
        told = self.refused(1, "calibrate", "--participant", "P1", "-o", "me.toml", *args, "-D", "null").stderr
        self.assertEqual(told.splitlines()[:2], first)
        self.assertEqual(self.simulated("you.toml", *args).stderr.splitlines()[:2], first)
        self.write("mixed.toml", PALM + "".join(f"[[tactor]]\ntactor = {i}\nmax_dbfs = -6\n" for i in range(9)))
        self.assertEqual(self.simulated("all.toml", *args).stderr, "tactor: highest level: -6 dBFS at tactors 3, 4, 5\n")


class Person(CalibrateTest):
    def test_answers_come_from_lines_and_a_session_resumes(self):
        self.write("a.toml", TWO + "[[tactor]]\ntactor = 1\nmax_dbfs = -15\nthreshold_dbfs = [[100, -8], [250, -6]]\n")
        args = (*self.ARGS, "--array", "a.toml")
        result = self.refused(1, *args, stdin="1\nx\n2\n")
        self.assertIn("That is not an answer: 1 or 2: ", result.stdout)
        self.assertEqual([re.findall(r"^(right|wrong)$", result.stdout, re.M), self.responses()],
                         [["right" if r["correct"] == "true" else "wrong" for r in self.rows()], ["1", "2"]])
        result = self.refused(1, *args, "--resume", stdin="2\n")
        self.assertIn("continues at trial 3", result.stdout)
        rows = self.rows()
        self.assertEqual([r["trial"] for r in rows], ["1", "2", "3"])
        self.assertEqual(float(rows[0]["level_dbfs"]), -20)  # whatever the array's old thresholds are
        for r in rows:
            self.assertGreaterEqual(float(r["response_time_s"]), 0)
            self.assertGreater(int(r["onset_frame"]), 23999)
            self.assertEqual(r["correct"] == "true", r["interval"] == r["response"])
        self.refused(2, *args, stdin="1\n")

    def test_nothing_tells_which_interval_has_the_stimulus(self):
        result = self.run_tool(*self.ARGS, "--feedback", "off", stdin="1\n" * 6)
        told = re.findall(r"trial \d+:(.*)which", result.stdout)
        self.assertEqual(set(told), {" interval 1 interval 2 "})
        self.assertEqual(len({r["interval"] for r in self.rows()}), 2)
        self.assertNotRegex(result.stdout, "right|wrong|dBFS")

    def test_noise_covers_both_intervals_of_each_trial(self):
        noise = ("--masker-dbfs", -20)
        self.refused(1, *self.ARGS, "--masker", "raw:noise.raw", *noise, stdin="1\n2\n")
        # Both devices' clocks stand still where the machine does; timed/test_times.py checks durations.
        self.assertIn(len(noise_pieces(self.dir / "noise.raw")), (1, 2, 3))
        self.assertEqual(json.loads((self.dir / "me.json").read_text())["masker"], "white noise, -20 dBFS")
        self.refused(2, *self.ARGS, "--resume")
        self.refused(1, *self.ARGS, "--masker", "null", *noise, "--resume")  # another device without noise
        self.refused(3, *self.ARGS, "--masker", "hw:CARD=Nowhere", *noise, "--resume")

    def test_a_trial_waits_where_its_tactor_would_be_driven_too_long(self):
        self.write("a.toml", TWO + "[limits]\nmax_drive_s = 0.14\nwindow_s = 2\n")
        result = self.refused(1, *self.ARGS, "--array", "a.toml", stdin="1\n2\n1\n")
        self.assertNotIn("a limit changed it", result.stdout)
        self.write("a.toml", TWO + "[limits]\nmax_drive_s = 2.5\nwindow_s = 1200\n")
        tool = self.begun(*replaced(self.ARGS, "--array", "a.toml", "-o", "you.toml", "--interval", 1), stdin="1\n2\n")
        while not (line := tool.stdout.readline()).startswith("a pause of 2"):
            self.assertTrue(line)
        tool.send_signal(signal.SIGINT)
        self.assertEqual(tool.wait(PATIENCE_S), 130)
        self.assertEqual(len(self.rows("you.tsv")), 2)

    def test_a_trial_waits_for_what_was_driven_before(self):
        (self.dir / "run").mkdir(mode=0o700)
        self.env["XDG_RUNTIME_DIR"] = str(self.dir / "run")
        self.write("alsa.conf", ALSA_CONFIG + FELT_CONFIG)
        self.write("a.toml", TWO + "[limits]\nmax_drive_s = 2\nwindow_s = 20\n")
        self.ok("play", "--path", "M 20 0", "--duration", "1.9", "--algorithm", "continuous", "-D", "felt", "--array", "a.toml", "--level-dbfs", "-20")
        shown = self.refused(1, *replaced(self.ARGS, "--array", "a.toml", "-D", "felt", "--interval", 0.5), stdin="1\n").stdout
        self.assertIn("a pause of ", shown.split("trial 1")[0])
        self.assertNotIn("a limit changed it", shown)

    def test_a_whole_adjustment_by_lines(self):
        self.ok(*self.ARGS, "--method", "adjustment", "--masker", "null", "--masker-noise", "pink", stdin="--<a\n+>a\n--a\n++a\n-a\n+\n<a\n")
        self.assertEqual([float(r["level_dbfs"]) for r in self.rows()], [-9.5, -22, -11, -22, -9, -22.5])
        self.assertAlmostEqual(self.toml()["tactor"][1]["threshold_dbfs"], -16, 9)
        self.assertEqual(self.toml()["calibration"]["masker"], "pink noise, -30 dBFS, null")
        self.ok("check", "--array", "me.toml")

    def test_keys_of_a_terminal_answer_and_ctrl_c_ends_it(self):
        t = Terminal(self, self.ARGS)
        t.until("\\d+ tactors?, about \\d+ trials: some \\d+ minutes?\\.\r?\n")
        t.answer("Any key begins", " 2")  # the second is too early: it does not count
        t.answer("trial 1: interval 1 interval 2 which\\? ", "1")
        t.answer("trial 2: interval 1 interval 2 which\\? ", "1" * 60)  # held down: it answers nothing
        self.until(lambda: "tactor: a key is held down" in t.said())
        t.key("2")
        t.answer("trial 3: interval 1", "\x03")
        self.assertEqual(t.end(), 130)
        self.assertIn("ended before trial 3", t.said())
        self.assertEqual(self.responses(), ["1", "2"])

    def test_a_session_killed_at_any_moment_loses_no_answer(self):
        tool = self.begun(*self.ARGS, stdin="1\n1\n")
        for line in tool.stdout:
            if line.startswith("trial 2"):
                break
        tool.stdout.readline()
        tool.send_signal(signal.SIGKILL)
        tool.wait()
        self.assertEqual(len(self.rows()), 2)
        self.refused(1, *self.ARGS, "--resume")


class Page(CalibrateTest):
    """The participant's page; test_experiment_page.py has the tests for every page."""

    def start(self, *more):
        s = Session(self, replaced(self.ARGS, "--display", "page", *more))
        self.page = s.participant()
        return s

    def until_text(self, pattern):
        while not re.match(pattern, self.page.next().get("text", "")):
            pass

    def test_intervals_are_shown_and_answered_on_the_page_in_the_words_of_an_experiment(self):
        self.write("mine.toml", '[page]\nbegin = "Los"\ncalibrate_choose = "Zwei"\ncalibrate_interval = "Abschnitt"\n'
                                'right = "Ja"\nwrong = "Nein"\n')
        s = self.start("--page-words", "mine.toml")
        s.key("1")  # text typed at the terminal is no answer
        asked = self.page.answer("introduce", 1)
        self.assertEqual((asked["text"], asked["choices"]), ("Zwei", ["Los"]))
        for trial in (1, 2):
            for interval in (1, 2):
                self.until_text(f"Abschnitt {interval}$")
                self.assertEqual((self.page.seen[-1]["stimuli"], self.page.seen[-1]["playing"]), (2, interval))
            asked = self.page.next()
            s.key("2")
            self.assertEqual((asked["question"], asked["choices"]), ("Which one vibrated?", ["", ""]))
            self.page.say(ask=asked["ask"], answer=1)
            self.page.say(ask=asked["ask"], answer=2)  # each question takes one
            self.until_text("Ja|Nein")
        s.process.send_signal(signal.SIGINT)
        self.page.until("over", asked=False)
        self.assertEqual(s.end(), 130)
        self.assertEqual(self.responses(), ["1"] * 2)
        self.assertIn("trial 1: interval 1 interval 2 which? 1", s.shown)

    def test_the_page_tells_the_progress_and_has_a_break_before_the_next_tactor(self):
        s = self.start("--method", "quest", "--trials", 5, "--tactors", "1,4")
        self.page.answer("introduce", 1)
        for trial in range(1, 6):
            asked = self.page.answer("question", 1)
            self.assertEqual(asked["progress"], {"run": 1, "runs": 2, "practice": False, "trial": trial, "trials": 5})
        pause = self.page.answer("introduce", 1)
        self.assertEqual((pause["text"], pause["choices"], pause["progress"]["run"]), ("A break", ["Begin"], 2))
        self.page.until("question")
        s.process.send_signal(signal.SIGINT)
        self.assertEqual(s.end(), 130)
        self.assertEqual(len(self.rows()), 5)

    def test_a_level_is_set_on_the_page(self):
        s = self.start("--method", "adjustment")
        self.page.answer("introduce", 1)
        for change in (1, 2, 3, 4):  # down by 2 and by half a dB, and up again
            self.page.answer("question", change)
        for _ in range(6):
            self.page.answer("question", 5)
        self.page.until("over", asked=False)
        self.assertEqual(s.end(), 0, s.said)
        levels = [float(r["level_dbfs"]) for r in self.rows()]
        self.assertEqual(len(levels), 6)
        self.assertAlmostEqual(self.toml()["calibration"]["tactor"][0]["threshold_dbfs"], sum(levels) / 6, 9)


class Refused(CalibrateTest):
    SIMULATED = ("calibrate", "--participant", "P07", "-o", "me.toml", "--simulate", OBSERVER)

    def bad(self, *args, says=(), base=SIMULATED):
        before = {f.name: f.read_bytes() for f in self.dir.iterdir() if f.is_file()}
        self.refused(2, *replaced(base, *args), says=says)
        self.assertEqual({f.name: f.read_bytes() for f in self.dir.iterdir() if f.is_file()}, before)

    def test_each_fault_is_reported_before_a_trial(self):
        for name, text in (("limited", PALM + "[[tactor]]\ntactor = 4\nmax_dbfs = -30\n"), ("quiet", PALM + "[limits]\npower_dbfs = -25\n"),
                           ("short", PALM + "[limits]\nmax_drive_s = 0.3\n"), ("none", '[experiment]\nname = "x"\n'), ("some", '[page]\nbegin = "Los"\n')):
            self.write(f"{name}.toml", text)
        (self.dir / "folder.tsv").mkdir()
        (self.dir / "link.tsv").symlink_to("elsewhere.tsv")
        for args in ("--tactors 9", "--tactors 1,0-2", "--tactors 5-3", "--tactors a", "--tactors 99999999999",
                     "--array limited.toml --start-dbfs -20", "--array quiet.toml --start-dbfs -20", "--array short.toml",
                     "--method adjustment --interval 1", "--carrier 24000", "--carrier nan", "--start-dbfs 3", "--steps 4,,1", "--steps -1",
                     "--reversals 25", "--reversals 5 --discard 4", "--practice 1.5", "--interval 0", "--feedback yes", "--rule 2up1down",
                     "--method limits", "--method adjustment --rule 1up2down", "--method quest --rule 1up2down", "--trials 40", "--stop-sd 1",
                     "--method adjustment --trials 40", "--method quest --trials 4", "--masker-dbfs -20", "--masker null --masker-dbfs -3",
                     "--masker null --masker-noise pink --masker-dbfs -12", "--masker null --masker-noise brown",
                     "--log x.txt", "--log nowhere/x.tsv", "--log folder.tsv", "--log link.tsv", f"--log {'x' * 300}.tsv", "--seed -1",
                     "--simulate seed=x,threshold=-45", "--simulate level=3", "--keypad /dev/input/event0", "--display page"):
            self.bad(*args.split())
        for args in ("--page 0.0.0.0:0", "--page 0 --display terminal", "--display page --page-words none.toml", "--page-words some.toml",
                     "--keypad /dev/null", "--carrier 24000"):
            self.bad(*args.split(), base=self.ARGS)
        self.bad("--masker", "", base=self.ARGS)
        for args in ("-o me.toml", "--participant P07", "--participant P-7 -o me.toml", "--participant P7 -o me.txt",
                     "--participant P7 -o me.toml", "--participant P7 -o none/me.toml -D null"):
            self.bad(*args.split(), base=("calibrate",))
        self.refused(1, "calibrate", "--participant", "P7", "-o", "/proc/me.toml", "-D", "null")
        self.refused(3, *self.ARGS, "--keypad", "/dev/input/nobody")

    def test_other_files_are_not_overwritten(self):
        for name, text in (("me.toml", "mine"), ("me.tsv", "my\ttable\n"), ("me.json", '{"date":"2020-01-01","mydata":[1,2,3]}'), ("me.json", "[]"),
                           ("me.json", "mine")):
            self.write(name, text)
            self.bad(says=(name,))
            if name != "me.toml":
                self.bad("--resume", says=(name,))
            (self.dir / name).unlink()

    def test_only_its_own_output_makes_a_session_finished(self):
        self.simulated("me.toml", *SHORT, "--tactors", 0)
        same = (*SHORT, "--tactors", 0, "--resume")
        before = {f.name: f.stat().st_mtime_ns for f in self.dir.iterdir()}
        self.assertIn("finished", self.simulated("me.toml", *same).stdout)
        self.assertEqual({f.name: f.stat().st_mtime_ns for f in self.dir.iterdir()}, before)
        self.bad(*same, "--participant", "P08")
        made = (self.dir / "me.toml").read_text()
        for text in (made.replace("simulated = true", "simulated = false"), made.replace('date = "20', 'date = "19'),
                     made.partition("[calibration]")[0], "some text"):
            self.write("me.toml", text)
            self.bad(*same, says=["me.toml"])
        (self.dir / "me.toml").unlink()
        (self.dir / "me.toml").mkdir()
        self.bad(*same, says=["me.toml"])
        (self.dir / "me.toml").rmdir()
        # A session goes on only with its options.
        for more, key in (("4 --array palm-2x4", "began with tactors [0], but now it is [4]"), ("1", "tactors [0], but now it is [1]"),
                          ("0 --carrier 100", "carrier_hz 250.0, but now it is 100.0"), ("0 --seed 1", "seed"), ("0 --array palm-2x4", "the array has changed since")):
            self.bad(*SHORT, "--resume", "--tactors", *more.split(), says=["me.json", key])
        self.bad("--tactors", 0, says=["me.tsv: it exists", "--resume"])
        self.write("me.toml", made)
        (self.dir / "me.json").unlink()
        self.bad(*same, says=["me.json: it is missing"])

    def test_resuming_a_session_that_is_not_there_begins_none(self):
        self.bad("--resume", says=("--resume: there is no log me.tsv", "leave out --resume to begin a new session"))
        self.assertFalse((self.dir / "me.tsv").exists())

    def test_two_sessions_on_one_log_are_refused(self):
        first = self.begun(*self.ARGS)
        first.stdout.readline()  # the question: the log is open
        for more in ((), ("--resume",)):
            self.refused(2, *self.ARGS, *more)
        first.send_signal(signal.SIGINT)
        self.assertEqual(first.wait(PATIENCE_S), 130)

    def test_a_session_without_answers_leaves_no_trace(self):
        args = ("calibrate", "--participant", "P07", "-o", "me.toml", "--tactors", 0)
        self.refused(3, *args, "-D", "hw:CARD=Nowhere")
        self.refused(1, *args, "-D", "null")
        self.assertEqual(list(self.dir.glob("me.*")), [])
        self.refused(1, *args, "-D", "null", stdin="1\n")
        self.assertEqual(json.loads((self.dir / "me.json").read_text())["participant"], "P07")


if __name__ == "__main__":
    main()
