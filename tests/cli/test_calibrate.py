# SPDX-License-Identifier: MIT
"""tactor calibrate: simulated sessions, sessions of a person at a terminal and through a pipe, and refusals."""
import csv
import json
import os
import pty
import re
import resource
import select
import signal
import struct
import subprocess
import tomllib

from harness import GRID, PATIENCE_S, TOOL, ToolTest, main
from pages import Session

OBSERVER = "threshold=-45,spread=2,lapse=0.02"
SHORT = ("--reversals", 4, "--discard", 2)


class CalibrateTest(ToolTest):
    def simulated(self, name, *args, spec=OBSERVER):
        return self.ok("calibrate", "--participant", "P07", "-o", name, "--simulate", spec, *args)

    def rows(self, name):
        with (self.dir / name).open(newline="") as file:
            return list(csv.DictReader(file, delimiter="\t"))

    def toml(self, name):
        return tomllib.loads((self.dir / name).read_text())


class Simulated(CalibrateTest):
    def test_the_result_is_an_array_for_every_command(self):
        said = self.simulated("me.toml", "--tactors", "0-8", "--carrier", 200)
        self.assertIn("SIMULATED", said.stdout)
        plan = self.plan("park2016-3", "--array", "me.toml", "--sl", 7)
        made = self.toml("me.toml")
        for got, tactor, entry in zip(made["calibration"]["tactor"], made["tactor"], plan["array"]["tactors"]):
            self.assertEqual(got["threshold_dbfs"], tactor["threshold_dbfs"])
            self.assertEqual(got["threshold_dbfs"], entry["threshold_dbfs"])
            self.assertLess(abs(got["threshold_dbfs"] + 44.5), 4)
        for command in (("render", "park2016-3", "-o", "x.wav"), ("play", "park2016-3", "-D", "null"), ("check",)):
            self.ok(*command, "--array", "me.toml", *([] if command[0] == "check" else ["--sl", 7]))
        told = made["calibration"]
        self.assertEqual({k: told[k] for k in ("participant", "method", "rule", "carrier_hz", "interval_s", "feedback",
                                               "masker", "simulated")},
                         {"participant": "P07", "method": "staircase", "rule": "1up3down", "carrier_hz": 200,
                          "interval_s": 0.5, "feedback": True, "masker": "none", "simulated": True})
        self.assertRegex(told["date"], r"^\d{4}-\d\d-\d\d$")
        self.assertIsInstance(told["seed"], int)

    def test_a_second_carrier_adds_to_the_first(self):
        self.simulated("low.toml", "--tactors", "0,1", "--carrier", 100, spec="threshold=-20,spread=1")
        self.simulated("both.toml", "--tactors", "0,1", "--carrier", 250, "--array", "low.toml", spec="threshold=-41,spread=1")
        low, both = self.toml("low.toml"), self.toml("both.toml")
        for first, second, found in zip(low["tactor"], both["tactor"], both["calibration"]["tactor"]):
            self.assertEqual(second["threshold_dbfs"], [[100, first["threshold_dbfs"]], [250, found["threshold_dbfs"]]])
        self.ok("check", "--array", "both.toml")

    def test_thresholds_of_others_do_not_stay(self):
        self.simulated("P07.toml", *SHORT)
        said = self.ok("calibrate", "--participant", "P08", "-o", "P08.toml", "--simulate", OBSERVER, "--array", "P07.toml",
                       "--tactors", "0-6", *SHORT)
        self.assertIn("thresholds are P07's, simulated: those of tactors 7, 8 are left out", said.stderr)
        self.assertEqual(["threshold_dbfs" in t for t in self.toml("P08.toml")["tactor"]], [True] * 7 + [False] * 2)
        # Thresholds of the same participant stay.
        said = self.simulated("again.toml", "--array", "P07.toml", "--tactors", 0, *SHORT)
        self.assertNotIn("left out", said.stderr)
        self.assertTrue(all("threshold_dbfs" in t for t in self.toml("again.toml")["tactor"]))

    def test_a_measured_tactor_can_be_played_while_the_rest_is_not_measured(self):
        self.simulated("me.toml", "--tactors", 4, *SHORT)
        at_4 = ("--path", "M 20 20 L 20.001 20", "--array", "me.toml", "--sl", 7)
        plan = self.plan(*at_4)
        self.assertEqual({d["tactor"] for b in plan["bursts"] for d in b["drives"] if d["amplitude"] != 0}, {4})
        self.assertEqual([p is None for p in plan["render"]["peak_dbfs"]], [i != 4 for i in range(9)])
        self.ok("render", *at_4, "-o", "x.wav")
        self.refused(2, "render", "park2016-1", "--array", "me.toml", "--sl", 7, "-o", "y.wav")

    def test_log_and_result_agree(self):
        self.simulated("me.toml", "--tactors", "3,1", "--practice", 2)
        rows, told = self.rows("me.tsv"), self.toml("me.toml")["calibration"]["tactor"]
        self.assertEqual(list(rows[0]), "trial tactor level_dbfs interval response correct reversal practice "
                                        "response_time_s onset_frame".split())
        self.assertEqual([int(r["trial"]) for r in rows], list(range(1, len(rows) + 1)))
        self.assertEqual([r["practice"] for r in rows[:3]], ["true", "true", "false"])
        self.assertEqual([t["tactor"] for t in told], [3, 1])
        for t in told:
            own = [r for r in rows if r["tactor"] == str(t["tactor"]) and r["practice"] == "false"]
            self.assertEqual(len(own), t["trials"])
            self.assertEqual([float(r["level_dbfs"]) for r in own if r["reversal"] == "true"], t["reversals_dbfs"])
            counted = t["reversals_dbfs"][-8:]
            mean = sum(counted) / 8
            self.assertAlmostEqual(t["threshold_dbfs"], mean, 9)
            self.assertAlmostEqual(t["sd_db"], (sum((x - mean) ** 2 for x in counted) / 7) ** 0.5, 9)
            for checks, key, by in ((own[-20:-10], "check_right", 6), (own[-10:], "check_below_right", -6)):
                self.assertEqual(sum(r["correct"] == "true" for r in checks), t[key])
                self.assertEqual({float(r["level_dbfs"]) for r in checks}, {round(mean + by, 6)})
            self.assertEqual(t["staircases"], 1)
        for r in rows:
            self.assertEqual(r["correct"] == "true", r["interval"] == r["response"])

    def test_the_same_seed_gives_the_same_bytes(self):
        for name, seed in (("a", 1), ("b", 1), ("c", 2)):
            self.simulated(f"{name}.toml", "--seed", seed, "--tactors", 0)
        logs = {n: (self.dir / f"{n}.tsv").read_bytes() for n in "abc"}
        files = {n: re.sub(r"date = .*", "", (self.dir / f"{n}.toml").read_text()) for n in "abc"}
        self.assertEqual((logs["a"], files["a"]), (logs["b"], files["b"]))
        self.assertNotEqual(logs["a"], logs["c"])

    def test_a_session_cut_off_at_any_line_goes_on_to_the_same_files(self):
        self.simulated("a.toml", *SHORT, "--tactors", "0,1")
        log, made, began = ((self.dir / f"a.{e}").read_bytes() for e in ("tsv", "toml", "json"))
        ends = [0, 5] + [i + 1 for i, c in enumerate(log) if c == 10] + [len(log) - 3]
        for end in ends:
            for name, data in (("b.tsv", log[:end]), ("b.json", began)):
                self.write(name, data)
            (self.dir / "b.toml").unlink(missing_ok=True)
            self.simulated("b.toml", *SHORT, "--tactors", "0,1", "--resume")
            self.assertEqual((self.dir / "b.tsv").read_bytes(), log, end)
            self.assertEqual((self.dir / "b.toml").read_bytes(), made, end)
        before = {f.name: f.stat().st_mtime_ns for f in self.dir.iterdir()}
        self.assertIn("finished", self.simulated("b.toml", *SHORT, "--tactors", "0,1", "--resume").stdout)
        self.assertEqual({f.name: f.stat().st_mtime_ns for f in self.dir.iterdir()}, before)

    def test_a_disk_that_fills_loses_no_trial(self):
        self.simulated("whole.toml", *SHORT, "--tactors", 0)
        args = ("calibrate", "--participant", "P07", "-o", "me.toml", "--simulate", OBSERVER, *SHORT, "--tactors", 0)
        whole = (self.dir / "whole.tsv").read_bytes()

        def small():
            resource.setrlimit(resource.RLIMIT_FSIZE, (700, 700))
        result = subprocess.run([TOOL, *map(str, args)], cwd=self.dir, env=self.env, preexec_fn=small,
                                capture_output=True, text=True, timeout=PATIENCE_S, check=False)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("me.tsv: File too large (what was answered before is kept", result.stderr)
        self.assertTrue(whole.startswith((self.dir / "me.tsv").read_bytes()))
        self.assertFalse((self.dir / "me.toml").exists())
        self.ok(*args, "--resume")
        self.assertEqual((self.dir / "me.tsv").read_bytes(), whole)

    def test_lapses_do_not_hold_a_threshold_far_above(self):
        said = self.ok("calibrate", "--participant", "S25", "-o", "me.toml", "--seed", 25, "--simulate",
                       "threshold=-45,spread=2,lapse=0.05")
        self.assertNotIn("too high", said.stderr)
        for t in self.toml("me.toml")["calibration"]["tactor"]:
            self.assertLess(abs(t["threshold_dbfs"] + 44.5), 5, t)
            self.assertLess(t["check_below_right"], 9)

    def test_a_threshold_far_above_the_others_is_named_and_can_be_measured_again(self):
        said = self.simulated("me.toml", "--tactors", "0-4", spec="threshold=-45,-44,-46,-20,-45,spread=1")
        self.assertRegex(said.stderr, r"tactor: warning: tactor 3: the threshold is likely to be too high: it is 2\d\.\d dB above "
                                      r"the median of the array's \(-4\d\.\d dBFS\) \(measure it again: --tactors 3 --array me\.toml")
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
        self.refused(2, "calibrate", "--participant", "P1", "-o", "me.toml", "--simulate", "seed=x,threshold=-45")

    def test_a_participant_who_feels_nothing_has_no_threshold_with_a_warning(self):
        said = self.simulated("me.toml", "--tactors", "0,1", spec="threshold=-45,500,spread=2")
        self.assertIn("tactor 1 has no threshold (not felt)", said.stderr)
        self.assertNotIn("tactor 0 has no", said.stderr)
        entries = self.toml("me.toml")["calibration"]["tactor"]
        self.assertEqual(["threshold_dbfs" in t for t in entries], [True, False])
        self.refused(2, "plan", "park2016-1", "--array", "me.toml", "--sl", 7)

    def test_a_level_that_does_not_fit_is_warned_of_at_once_and_refused_later(self):
        self.write("weak.toml", '[array]\npreset = "palm-3x3"\n' + "".join(
            f"[[tactor]]\ntactor = {i}\nmax_dbfs = -10\n" for i in range(9)))
        said = self.simulated("me.toml", "--array", "weak.toml", spec="threshold=-14,spread=0.5")
        self.assertRegex(said.stderr, r"tactor 0: 7 dB above its threshold of -1\d\.\d\d dBFS are \d\.\d\d dB more")
        threshold = self.toml("me.toml")["tactor"][0]["threshold_dbfs"]
        told = self.refused(2, "render", "--path", "M 0 0 L 0.001 0", "--array", "me.toml", "--sl", 7, "-o", "x.wav",
                            says=["tactor 0", f"threshold of {threshold:.4g} dBFS", "dB are missing", "max_dbfs"])
        self.assertNotIn("full scale", told.stderr)

    def test_the_array_file_keeps_its_other_keys(self):
        self.write("desk.toml", GRID + '[limits]\nmax_drive_s = 2\n[defaults]\ncarrier = 180\n')
        self.simulated("me.toml", "--array", "desk.toml")
        made = self.toml("me.toml")
        self.assertEqual(made["array"]["name"], "desk")
        self.assertEqual((made["output"]["pcm"], made["limits"]["max_drive_s"]), ("null", 2))
        self.assertEqual((made["tactor"][1]["gain_db"], made["tactor"][0]["actuator"]), (-3, "piezo"))
        self.assertEqual(made["calibration"]["carrier_hz"], 180)
        self.ok("check", "--array", "me.toml")

    def test_no_level_is_above_the_array_s_limit(self):
        self.write("low.toml", '[array]\npreset = "palm-3x3"\n[[tactor]]\ntactor = 4\nmax_dbfs = -25\n[limits]\npower_dbfs = -18\n')
        said = self.simulated("me.toml", "--array", "low.toml", "--practice", 1, *SHORT, spec="threshold=0,spread=0.001")
        self.assertIn("no level is above -18 dBFS, which power_dbfs in [limits] allows, and max_dbfs does not, of tactors "
                      "0, 1, 2, 3, 5, 6, 7, 8\n", said.stderr)
        rows = self.rows("me.tsv")
        self.assertEqual(max(float(r["level_dbfs"]) for r in rows), -18.001)
        of_4 = [float(r["level_dbfs"]) for r in rows if r["tactor"] == "4"]
        self.assertEqual((of_4[0], max(of_4)), (-25, -25))

    def test_the_first_line_has_the_ceiling_of_each_tactor(self):
        self.write("mixed.toml", '[array]\npreset = "palm-3x3"\n[[tactor]]\ntactor = 4\nmax_dbfs = -25\n')
        args = ("calibrate", "--participant", "P1", "-o", "me.toml", "--array", "mixed.toml", "--tactors", "3-5", *SHORT)
        warning = ("tactor: warning: no max_dbfs below 0 limits tactors 3, 5: the level may go to full scale (set max_dbfs in [[tactor]] "
                   "of the array file)")
        told = self.run_tool(*args, "-D", "null", stdin="1\n").stderr
        self.assertEqual(told.splitlines()[:2], ["tactor: highest level: 0 dBFS at tactors 3, 5; -25 dBFS at tactor 4", warning])
        told = self.simulated("you.toml", *args[5:]).stderr
        self.assertEqual(told.splitlines()[:2], ["tactor: highest level: 0 dBFS at tactors 3, 5; -25 dBFS at tactor 4", warning])
        self.write("mixed.toml", '[array]\npreset = "palm-3x3"\n' + "".join(f"[[tactor]]\ntactor = {i}\nmax_dbfs = -6\n" for i in range(9)))
        self.assertEqual(self.simulated("all.toml", *args[5:]).stderr, "tactor: highest level: -6 dBFS at tactors 3, 4, 5\n")

    def test_an_observer_may_be_a_step(self):
        self.simulated("me.toml", *SHORT, "--tactors", 0, spec="threshold=-45,spread=0")
        for r in self.rows("me.tsv"):
            if float(r["level_dbfs"]) >= -45:
                self.assertEqual(r["correct"], "true")

    def test_levels_above_thresholds_of_another_carrier_give_a_warning(self):
        self.simulated("me.toml", "--carrier", 100, *SHORT)
        told = "thresholds were measured at 100 Hz, and a carrier is 250 Hz"
        at = ("--array", "me.toml", "--sl", 7)
        for command in (("plan", "park2016-1"), ("render", "park2016-1", "-o", "x.wav"),
                        ("play", "park2016-1", "park2016-1", "-D", "null")):
            self.assertEqual(self.ok(*command, *at).stderr.count(told), 1)
            self.assertNotIn(told, self.ok(*command, *at, "--carrier", 100).stderr)
        self.assertNotIn(told, self.ok("plan", "park2016-1", "--array", "me.toml").stderr)

    def test_adjustment_measures_thresholds(self):
        self.simulated("me.toml", "--method", "adjustment", "--tactors", 4)
        rows, told = self.rows("me.tsv"), self.toml("me.toml")["calibration"]
        self.assertEqual([(r["response"], r["interval"], r["correct"]) for r in rows], [("set", "n/a", "n/a")] * 6)
        self.assertEqual(told["method"], "adjustment")
        mean = sum(float(r["level_dbfs"]) for r in rows) / 6
        self.assertAlmostEqual(told["tactor"][0]["threshold_dbfs"], mean, 9)


class Person(CalibrateTest):
    ARGS = ("calibrate", "--participant", "P1", "-o", "me.toml", "-D", "null", "--tactors", 1, "--interval", 0.05,
            "--start-dbfs", -20)

    def test_answers_come_from_lines_and_a_session_resumes(self):
        result = self.refused(1, *self.ARGS, stdin="1\nx\n2\n")
        self.assertIn('"x" is neither 1 nor 2', result.stdout)
        self.assertEqual([r["response"] for r in self.rows("me.tsv")], ["1", "2"])
        result = self.refused(1, *self.ARGS, "--resume", stdin="2\n")
        self.assertIn("goes on at trial 3", result.stdout)
        rows = self.rows("me.tsv")
        self.assertEqual([r["trial"] for r in rows], ["1", "2", "3"])
        for r in rows:
            self.assertGreaterEqual(float(r["response_time_s"]), 0)
            self.assertGreater(int(r["onset_frame"]), 23999)
            self.assertEqual(r["correct"] == "true", r["interval"] == r["response"])
        self.refused(2, *self.ARGS, stdin="1\n")

    def test_nothing_tells_which_interval_has_the_stimulus(self):
        result = self.run_tool(*self.ARGS, "--feedback", "off", stdin="1\n" * 6)
        told = re.findall(r"trial \d+:(.*)which", result.stdout)
        self.assertEqual(set(told), {" interval 1 interval 2 "})
        self.assertEqual(len({r["interval"] for r in self.rows("me.tsv")}), 2)
        self.assertNotRegex(result.stdout, "right|wrong|dBFS")

    def read_noise(self, name):
        """Returns the power of each 10 ms that the second device received (S32, stereo)."""
        values = [v for v, in struct.iter_unpack("<i", (self.dir / name).read_bytes())]
        self.assertEqual(values[::2], values[1::2])
        left = [v / 2 ** 31 for v in values[::2]]
        return [sum(v * v for v in left[i:i + 480]) / 480 for i in range(0, len(left) - 479, 480)]

    def pieces(self, power):
        """Returns the length of each piece of full noise, in 10 ms."""
        full = "".join(str(int(10 ** -2 * 0.7 < p < 10 ** -2 * 1.4)) for p in power)
        return [len(r) for r in re.findall("1+", full)]

    def test_noise_covers_both_intervals_of_each_trial(self):
        args = (*self.ARGS, "--masker", "raw:noise.raw", "--masker-dbfs", -20)
        self.refused(1, *args, stdin="1\n2\n")
        power = self.read_noise("noise.raw")
        # Both devices' clocks stand still where the machine does; timed/test_times.py checks durations.
        self.assertIn(len(self.pieces(power)), (1, 2, 3))
        self.assertEqual(power[0], 0)
        self.assertEqual(json.loads((self.dir / "me.json").read_text())["masker"],
                         "white noise, -20 dBFS")
        self.refused(2, *self.ARGS, "--resume")
        self.refused(1, *args[:-3], "null", *args[-2:], "--resume")  # another device without noise
        for args, status, says in ((("--masker", "hw:CARD=Nowhere"), 3, "hw:CARD=Nowhere"),
                                   (("--masker", ""), 2, "--masker")):
            self.refused(status, "calibrate", "--participant", "P2", "-o", f"n{status}.toml", "-D", "null", *args, says=[says])

    def test_the_noise_stands_in_the_result(self):
        self.run_tool(*self.ARGS, "--method", "adjustment", "--masker", "null", "--masker-noise", "pink", stdin="a\n" * 6)
        self.assertEqual(self.toml("me.toml")["calibration"]["masker"], "pink noise, -30 dBFS, null")
        self.ok("check", "--array", "me.toml")

    def test_levels_do_not_come_from_the_array_s_old_thresholds(self):
        self.write("a.toml", '[array]\nname = "a"\ngrid = { rows = 1, columns = 2, pitch_mm = 20.0 }\n[[tactor]]\ntactor = 1\n'
                             "max_dbfs = -15\nthreshold_dbfs = [[100, -8], [250, -6]]\n")
        self.refused(1, *self.ARGS, "--array", "a.toml", stdin="1\n")
        self.assertEqual([float(r["level_dbfs"]) for r in self.rows("me.tsv")], [-20])

    def test_a_trial_waits_where_its_tactor_would_be_driven_too_long(self):
        self.write("a.toml", '[array]\nname = "a"\ngrid = { rows = 1, columns = 2, pitch_mm = 20.0 }\n[limits]\n'
                             "max_drive_s = 0.14\nwindow_s = 2\n")
        args = [TOOL, *map(str, self.ARGS), "--array", "a.toml"]
        result = self.refused(1, *args[1:], stdin="1\n2\n1\n")
        self.assertNotIn("a limit changed it", result.stdout)
        self.write("a.toml", (self.dir / "a.toml").read_text().replace("0.14\nwindow_s = 2", "2.5\nwindow_s = 1200"))
        args[args.index("me.toml")] = "you.toml"
        args[args.index("0.05")] = "1"
        with subprocess.Popen(args, cwd=self.dir, env=self.env, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True) as tool:
            tool.stdin.write("1\n2\n")
            tool.stdin.flush()
            while not (line := tool.stdout.readline()).startswith("a pause of 2"):
                self.assertTrue(line)
            tool.send_signal(signal.SIGINT)
            tool.stdin.close()
            self.assertEqual(tool.wait(PATIENCE_S), 130)
        self.assertEqual(len(self.rows("you.tsv")), 2)

    def test_feedback_is_shown_only_when_asked_for(self):
        result = self.run_tool(*self.ARGS, stdin="1\n" * 4)
        told = re.findall(r"^(right|wrong)$", result.stdout, re.M)
        self.assertEqual(told, ["right" if r["correct"] == "true" else "wrong" for r in self.rows("me.tsv")])

    def test_a_whole_adjustment_by_lines(self):
        result = self.run_tool(*self.ARGS, "--method", "adjustment", stdin="--<a\n+>a\n--a\n++a\n-a\n+\n<a\n")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual([float(r["level_dbfs"]) for r in self.rows("me.tsv")],
                         [-9.5, -22, -11, -22, -9, -22.5])
        self.assertAlmostEqual(self.toml("me.toml")["tactor"][1]["threshold_dbfs"], -16, 9)

    def test_keys_of_a_terminal_answer_and_ctrl_c_ends_it(self):
        pid, fd = pty.fork()
        if pid == 0:
            os.chdir(self.dir)
            os.execve(TOOL, [str(TOOL), *map(str, self.ARGS)], self.env)
        seen = ""

        def until(pattern):
            nonlocal seen
            while not re.search(pattern, seen):
                if not select.select([fd], [], [], PATIENCE_S)[0]:
                    raise AssertionError(f"no {pattern} in {seen!r}")
                seen += os.read(fd, 4096).decode()
            seen = seen[re.search(pattern, seen).end():]
        until("\\d+ tactors?, about \\d+ trials: some \\d+ minutes?\\.\r?\n")
        until("Any key begins")
        os.write(fd, b" 2")  # the second is too early: it does not count
        until("trial 1: interval 1 interval 2 which\\? ")
        os.write(fd, b"1")
        until("trial 2: interval 1 interval 2 which\\? ")
        os.write(fd, b"1" * 60)  # held down: it answers nothing
        until("tactor: a key is held down")
        os.write(fd, b"2")
        until("trial 3: interval 1")
        os.write(fd, b"\x03")
        try:
            until("ended before trial 3")
            while os.read(fd, 4096):
                pass
        except OSError:
            pass  # the terminal closes with the program
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]), 130)
        os.close(fd)
        self.assertEqual([r["response"] for r in self.rows("me.tsv")], ["1", "2"])

    def test_a_session_killed_at_any_moment_loses_no_answer(self):
        with subprocess.Popen([TOOL, *map(str, self.ARGS)], cwd=self.dir, env=self.env, stdin=subprocess.PIPE,
                              stdout=subprocess.PIPE, text=True) as tool:
            tool.stdin.write("1\n1\n")
            tool.stdin.flush()
            for line in tool.stdout:
                if line.startswith("trial 2"):
                    break
            tool.stdout.readline()
            tool.send_signal(signal.SIGKILL)
        self.assertEqual(len(self.rows("me.tsv")), 2)
        self.refused(1, *self.ARGS, "--resume")


class Page(CalibrateTest):
    """The participant's page; test_experiment_page.py has the tests for every page."""

    def start(self, *more):
        s = Session(self, (*Person.ARGS, "--display", "page", *more))
        self.page = s.participant()
        return s

    def until_text(self, pattern):
        while not re.match(pattern, self.page.next().get("text", "")):
            pass

    def test_intervals_are_shown_and_answered_on_the_page(self):
        s = self.start()
        s.key("1")  # text typed at the terminal is no answer
        self.assertEqual(self.page.answer("introduce", 1)["choices"], ["Begin"])
        for trial in (1, 2, 3):
            for interval in (1, 2):
                self.until_text(f"Interval {interval}$")
                self.assertEqual((self.page.seen[-1]["stimuli"], self.page.seen[-1]["playing"]), (2, interval))
            asked = self.page.next()
            s.key("2")
            self.assertEqual((asked["question"], asked["choices"]), ("Which one vibrated?", ["", ""]))
            self.page.say(ask=asked["ask"], answer=1)
            self.page.say(ask=asked["ask"], answer=2)  # each question takes one
            self.until_text("That was (right|wrong)")
        s.process.send_signal(signal.SIGINT)
        self.assertEqual(s.end(), 130)
        self.assertEqual([r["response"] for r in self.rows("me.tsv")], ["1"] * 3)
        self.assertIn("trial 1: interval 1 interval 2 which? 1", s.shown)

    def test_the_page_speaks_the_words_of_an_experiment(self):
        self.write("mine.toml", '[page]\nbegin = "Los"\ncalibrate_choose = "Zwei"\ncalibrate_interval = "Abschnitt"\n'
                                'calibrate_which = "Welcher?"\ncalibrate_right = "Ja"\ncalibrate_wrong = "Nein"\n')
        s = self.start("--page-words", "mine.toml")
        asked = self.page.answer("introduce", 1)
        self.assertEqual((asked["text"], asked["choices"]), ("Zwei", ["Los"]))
        self.until_text("Abschnitt 2$")
        self.assertEqual(self.page.answer("question", 1)["question"], "Welcher?")
        self.until_text("Ja|Nein")
        s.process.send_signal(signal.SIGINT)
        self.assertEqual(s.end(), 130)

    def test_a_level_is_set_on_the_page(self):
        s = self.start("--method", "adjustment")
        self.page.answer("introduce", 1)
        for change in (1, 2, 3, 4):  # down by 2 and by half a dB, and up again
            self.page.answer("question", change)
        for _ in range(6):
            self.page.answer("question", 5)
        self.page.until("over", asked=False)
        self.assertEqual(s.end(), 0, s.said)
        levels = [float(r["level_dbfs"]) for r in self.rows("me.tsv")]
        self.assertEqual(len(levels), 6)
        self.assertAlmostEqual(self.toml("me.toml")["calibration"]["tactor"][0]["threshold_dbfs"], sum(levels) / 6, 9)

    def test_bad_options_are_refused(self):
        self.refused(2, *Person.ARGS, "--page", "0.0.0.0:0")
        self.write("none.toml", '[experiment]\nname = "x"\n')
        self.refused(2, *Person.ARGS, "--display", "page", "--page-words", "none.toml", says=["none.toml", "there is no [page]"])
        self.write("some.toml", '[page]\nbegin = "Los"\n')
        self.refused(2, *Person.ARGS, "--page-words", "some.toml", says=["--page-words", "there is no page"])
        self.refused(2, *Person.ARGS, "--page", "0", "--display", "terminal")
        self.refused(2, "calibrate", "--participant", "P07", "-o", "me.toml", "--simulate", OBSERVER, "--display", "page")


class BadInput(CalibrateTest):
    def bad(self, *args, says, status=2):
        before = sorted(f.name for f in self.dir.iterdir())
        self.refused(status, "calibrate", "--participant", "P07", "-o", "me.toml", "--simulate", OBSERVER, *args, says=says)
        self.assertEqual(sorted(f.name for f in self.dir.iterdir()), before)

    def test_each_fault_is_reported_before_a_trial(self):
        self.write("limited.toml", '[array]\npreset = "palm-3x3"\n[[tactor]]\ntactor = 4\nmax_dbfs = -30\n')
        self.write("quiet.toml", '[array]\npreset = "palm-3x3"\n[limits]\npower_dbfs = -25\n')
        self.write("short.toml", '[array]\npreset = "palm-3x3"\n[limits]\nmax_drive_s = 0.3\n')
        (self.dir / "folder.tsv").mkdir()
        (self.dir / "link.tsv").symlink_to("elsewhere.tsv")
        for args, says in [
                (("--tactors", "9"), ["no tactor 9", "0 to 8"]),
                (("--tactors", "1,0-2"), ["tactor 1 is named twice"]),
                (("--tactors", "5-3"), ["5-3", "3-5"]),
                (("--tactors", "a"), ['"a"', "0,3-5"]),
                (("--tactors", "99999999999"), ["99999999999"]),
                (("--array", "limited.toml", "--start-dbfs", "-20"), ["tactor 4", "-30 dBFS at most (max_dbfs)", "-20"]),
                (("--array", "quiet.toml", "--start-dbfs", "-20"), ["tactor 0", "-25 dBFS at most (power_dbfs in [limits])"]),
                (("--array", "short.toml"), ["--interval", "0.5 s in 10 s", "0.3 s (max_drive_s)"]),
                (("--method", "adjustment", "--interval", "1"), ["steady pulses of 1 s", "7 s in 10 s", "allow 5 s"]),
                (("--carrier", "24000"), ["--carrier", "24000 Hz", "rate of 48000 Hz"]),
                (("--start-dbfs", "3"), ["3 is out of range"]),
                (("--steps", "4,,1"), ["--steps"]),
                (("--steps", "-1"), ["--steps"]),
                (("--reversals", "25"), ["2 to 24"]),
                (("--reversals", "5", "--discard", "4"), ["5 reversals 4 are discarded"]),
                (("--practice", "1.5"), ["not a whole number"]),
                (("--interval", "0"), ["--interval"]),
                (("--feedback", "yes"), ["on, off"]),
                (("--rule", "2up1down"), ["1up3down"]),
                (("--method", "limits"), ["staircase"]),
                (("--method", "adjustment", "--rule", "1up2down"), ["--rule", "adjustment"]),
                (("--masker-dbfs", "-20"), ["--masker-dbfs", "no device for the noise"]),
                (("--masker", "null", "--masker-dbfs", "-3"), ["--masker-dbfs", "-3 dBFS", "full scale from -5 dBFS"]),
                (("--masker", "null", "--masker-noise", "pink", "--masker-dbfs", "-12"), ["from -15 dBFS"]),
                (("--masker", "null", "--masker-noise", "brown"), ["white, pink"]),
                (("--log", "x.txt"), [".tsv"]),
                (("--log", "nowhere/x.tsv"), ["nowhere/x.tsv"]),
                (("--log", "folder.tsv"), ["folder.tsv"]),
                (("--log", "link.tsv"), ["link.tsv: it is a link"]),
                (("--log", "x" * 300 + ".tsv"), ["name"]),
                (("--seed", "-1"), ["--seed"]),
                (("--carrier", "nan"), ["--carrier"])]:
            self.bad(*args, says=says)
        self.refused(2, "calibrate", "-o", "me.toml")
        self.refused(2, "calibrate", "--participant", "P07")
        self.refused(2, "calibrate", "--participant", "P-7", "-o", "me.toml")
        self.refused(2, "calibrate", "--participant", "P7", "-o", "me.txt")
        self.refused(2, "calibrate", "--participant", "P7", "-o", "me.toml")
        self.refused(2, "calibrate", "--participant", "P7", "-o", "me.toml", "-D", "null", "--carrier", 24000)
        self.assertFalse((self.dir / "me.tsv").exists())
        self.refused(2, "calibrate", "--participant", "P7", "-o", "none/me.toml", "-D", "null")
        self.refused(1, "calibrate", "--participant", "P7", "-o", "/proc/me.toml", "-D", "null")
        self.refused(2, "calibrate", "--participant", "P7", "-o", "me.toml", "--simulate", "level=3")

    def test_existing_files_are_not_overwritten(self):
        self.write("me.toml", "mine")
        self.bad(says=["me.toml: there is such a file already"])
        self.assertEqual((self.dir / "me.toml").read_text(), "mine")
        (self.dir / "me.toml").unlink()
        self.write("me.tsv", "my\ttable\n")
        self.bad(says=["me.tsv: it is no log of a calibration"])
        self.bad("--resume", says=["me.tsv: it is no log of a calibration"])
        self.assertEqual((self.dir / "me.tsv").read_text(), "my\ttable\n")

    def test_another_program_s_json_is_not_replaced(self):
        for text in ('{"date":"2020-01-01","mydata":[1,2,3]}', "[]", "mine"):
            self.write("me.json", text)
            self.bad(says=["me.json: it does not say how a calibration was begun"])
            self.bad("--resume", says=["me.json: it does not say how a calibration was begun"])
            self.assertEqual((self.dir / "me.json").read_text(), text)

    def test_only_its_own_output_makes_a_session_finished(self):
        self.simulated("me.toml", *SHORT, "--tactors", 0)
        same = (*SHORT, "--tactors", 0, "--resume")
        self.assertIn("finished", self.simulated("me.toml", *same).stdout)
        self.bad(*same, "--carrier", 100, says=["me.json", "carrier_hz"])
        self.refused(2, "calibrate", "--participant", "P08", "-o", "me.toml", "--simulate", OBSERVER, *same)
        made = (self.dir / "me.toml").read_text()
        for text in (made.replace("simulated = true", "simulated = false"), made.replace('date = "20', 'date = "19'),
                     made.partition("[calibration]")[0]):
            self.write("me.toml", text)
            self.bad(*same, says=["me.toml: it is not what this session came to"])
        self.write("me.toml", "some text")
        self.bad(*same, says=["me.toml"])
        (self.dir / "me.toml").unlink()
        (self.dir / "me.toml").mkdir()
        self.bad(*same, says=["me.toml"])
        (self.dir / "me.toml").rmdir()
        self.write("me.toml", made)
        (self.dir / "me.json").unlink()
        self.bad(*same, says=["me.json: it is missing"])

    def test_a_session_resumes_only_with_its_options(self):
        self.simulated("me.toml", "--tactors", 0)
        (self.dir / "me.toml").unlink()
        self.bad("--resume", "--tactors", 4, "--array", "palm-2x4", says=["me.json", "begun with tactors [0], and [4]"])
        for args, says in [(("--tactors", 1), "tactors"), (("--carrier", 100), "carrier_hz 250.0, and 100.0"),
                           (("--seed", 1), "seed"), (("--tactors", 0, "--array", "palm-2x4"), "array_sha256")]:
            self.bad("--resume", *(args if "--tactors" in args else ("--tactors", 0, *args)), says=["me.json", says])
        self.bad("--tactors", 0, says=["me.tsv: there is such a file already", "--resume"])

    def test_two_sessions_on_one_log_are_refused(self):
        with subprocess.Popen([TOOL, *map(str, Person.ARGS)], cwd=self.dir, env=self.env, stdin=subprocess.PIPE,
                              stdout=subprocess.PIPE, text=True) as first:
            first.stdout.readline()  # the question: the log is open
            for more in ((), ("--resume",)):
                self.refused(2, *Person.ARGS, *more)
            first.send_signal(signal.SIGINT)
            self.assertEqual(first.wait(PATIENCE_S), 130)

    def test_a_missing_keypad_is_refused(self):
        self.refused(2, *Person.ARGS, "--keypad", "/dev/null")
        self.refused(3, *Person.ARGS, "--keypad", "/dev/input/nobody")
        self.bad("--keypad", "/dev/input/event0", says=["--keypad: nobody is asked"])

    def test_a_session_without_answers_leaves_no_trace(self):
        args = ("calibrate", "--participant", "P07", "-o", "me.toml", "--tactors", 0)
        self.refused(3, *args, "-D", "hw:CARD=Nowhere")
        self.refused(1, *args, "-D", "null")
        self.assertEqual(list(self.dir.glob("me.*")), [])
        self.refused(1, *args, "-D", "null", stdin="1\n")
        self.assertEqual(json.loads((self.dir / "me.json").read_text())["participant"], "P07")


if __name__ == "__main__":
    main()
