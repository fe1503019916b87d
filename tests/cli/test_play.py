# SPDX-License-Identifier: MIT
"""tactor play on ALSA's null and file devices, which need no hardware and pace themselves."""
import json
import os
import re
import resource
import signal
import subprocess
import time

from harness import GRID, PATIENCE_S, TOOL, ToolTest, Wav, main

PATIENCE = str(PATIENCE_S)
# The fade of 10 ms is in one period: it is written whole, even where the machine stands still beyond the wait for it.
WHOLE_FADE = ("--period-frames", "1024", "--periods", "3")


class Play(ToolTest):
    SHORT = ("--path", "M 0 10 L 40 30", "--duration", "0.3")

    def test_without_a_device_it_plays_to_null_and_says_so(self):
        r = self.ok("play", *self.SHORT)
        self.assertIn("null", r.stderr)
        self.assertIn("9 channels", r.stdout)

    def test_a_device_gets_what_render_writes(self):
        for name, pcm_bytes in (("s16", 2), ("s32", 4)):
            self.ok("render", *self.SHORT, "--sample-format", name, "-o", "o.wav")
            self.ok("play", *self.SHORT, "--sample-format", name, "-D", f"raw:{self.dir}/out.raw")
            wav, raw = Wav(self.dir / "o.wav"), (self.dir / "out.raw").read_bytes()
            frame = 9 * pcm_bytes
            self.assertEqual(len(raw) % frame, 0)
            # The first frame of a stroke is a zero crossing: compare from the first sound on.
            start = next(i for i, v in enumerate(raw) if v) // frame
            lead = next(i for i, v in enumerate(wav.data) if v) // frame
            heard = raw[(start - lead) * frame:]
            self.assertEqual(heard[:len(wav.data)], wav.data, name)
            self.assertEqual(set(heard[len(wav.data):]), {0})

    def test_several_strokes_play_one_after_the_other(self):
        r = self.ok("play", "park2016-1", "park2016-2", "--duration", "0.2")
        self.assertLess(r.stdout.index("park2016-1: played"), r.stdout.index("park2016-2: played"))

    def test_device_and_map_come_from_the_array_file(self):
        self.write("a.toml", '[array]\nname = "a"\ngrid = { rows = 2, columns = 2, pitch_mm = 40.0 }\n'
                             '[output]\npcm = "null"\nchannels = 6\nperiod_frames = 128\nperiods = 4\nrate = 44100\n')
        out = self.ok("play", *self.SHORT, "--array", "a.toml").stdout
        for text in ("6 channels", "44100 Hz", "128", "512"):
            self.assertIn(text, out)

    def test_a_missing_device_is_status_3(self):
        self.refused(3, "play", "park2016-1", "-D", "nowhere")

    def test_a_device_with_other_channels_names_its_own(self):
        self.refused(3, "play", "park2016-1", "-D", "eight")
        self.ok("play", "--path", "M 0 0 L 60 0", "--duration", "0.2", "--array", "palm-2x4", "-D", "eight")

    def test_limits_of_the_drive_are_options_too(self):
        long = ("play", "--path", "M 0 10 L 1 10", "--duration", "1", "-D", "null", "--format", "json")
        for options, cuts in (((), 0), (("--max-drive-s", "0.3", "--drive-window-s", "1"), 1),
                              (("--max-drive-s", "0.3", "--drive-window-s", "0.3"), 0)):
            counters = json.loads(self.ok(*long, *options).stdout)["counters"]
            self.assertEqual(counters["drives_cut"] > 0, cuts > 0, (options, counters))
        counters = json.loads(self.ok(*long, "--power-dbfs", "-40").stdout)["counters"]
        self.assertGreater(counters["power_limited_frames"], 1000)
        self.refused(2, *long, "--max-drive-s", "0")
        self.refused(2, *long, "--power-dbfs", "loud")

    def test_weak_strokes_together_count_as_a_strong_one(self):
        stroke = '[[stroke]]\npath = "M 0 10 L 1 10"\nduration_s = 1.0\nstart_s = 0.0\n'
        limits = ("--level-dbfs", "-40.1", "--max-drive-s", "0.3", "--drive-window-s", "1")
        for strokes, cut in ((1, False), (20, True)):
            self.write("s.toml", stroke * strokes)
            r = self.ok("play", "s.toml", "-D", "null", "--format", "json", *limits)
            self.assertEqual(json.loads(r.stdout)["counters"]["drives_cut"] > 0, cut)
            self.assertEqual("wait 0.7 s before the next stroke" in r.stderr, cut, r.stderr)

    def test_ctrl_c_fades_out_and_exits_130(self):
        for number, status in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            p = subprocess.Popen([TOOL, "play", "--path", "M 0 10 L 40 30", "--duration", "3600", "-D",
                                  f"raw:{self.dir}/out.raw", "--sample-format", "s16", "--level-dbfs", "0",
                                  *WHOLE_FADE],
                                 cwd=self.dir, env=self.env, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            self.assertIn(b"9 channels", p.stdout.readline())
            self.heard_for(p, self.dir / "out.raw", 18 * 4800)
            p.send_signal(number)
            p.communicate(timeout=PATIENCE_S)
            self.assertEqual(p.returncode, status)
            raw = memoryview((self.dir / "out.raw").read_bytes()).cast("h")
            self.assertEqual(set(raw[-9:]), {0})
            steps = [max(abs(raw[i] - raw[i - 9]) for i in range(k, min(k + 9000, len(raw))))
                     for k in range(9, len(raw), 9000)]
            # A full-scale carrier of 250 Hz moves by at most 2 pi 250 / 48000 of full scale in a frame.
            self.assertLessEqual(max(steps), 32768 * 0.0328)
            (self.dir / "out.raw").unlink()

    def test_latency_is_periods_times_period(self):
        def sizes(*more):
            return re.search(r"period (\d+) of (\d+) frames, latency ([0-9.]+) ms", self.ok("play", *self.SHORT, *more).stdout)
        self.assertEqual(sizes().groups(), ("96", "288", "6.0"))
        self.assertEqual(sizes("--latency-ms", "3").groups(), ("48", "144", "3.0"))
        self.assertEqual(sizes("--latency-ms", "10", "--periods", "2").groups(), ("240", "480", "10.0"))
        self.assertEqual(sizes("--period-frames", "64", "--periods", "4").groups(), ("64", "256", "5.3"))
        self.write("c.toml", '[output]\npcm = "null"\nperiod_frames = 500\nperiods = 5\n')
        self.assertEqual(sizes("--config", "c.toml", "--latency-ms", "5").groups(), ("48", "240", "5.0"))
        self.refused(2, "play", *self.SHORT, "--latency-ms", "3", "--period-frames", "64")
        self.write("d.toml", "[defaults]\nlatency-ms = 5\n[output]\nperiod_frames = 128\n")
        self.assertEqual(sizes("--config", "d.toml").groups(), ("80", "240", "5.0"))
        self.assertEqual(sizes("--config", "d.toml", "--latency-ms", "3").groups(), ("48", "144", "3.0"))
        self.assertEqual(sizes("--config", "d.toml", "--period-frames", "64").groups(), ("64", "192", "4.0"))
        self.write("a.toml", 'array.preset = "palm-3x3"\n[defaults]\nlatency-ms = 10\n')
        self.assertEqual(sizes("--config", "d.toml", "--array", "a.toml").groups(), ("160", "480", "10.0"))
        for option, value in (("--latency-ms", "nan"), ("--latency-ms", "0"), ("--period-frames", "1.5"),
                              ("--periods", "1"), ("--reopen-s", "-1"), ("--sync-delay-ms", "x"), ("--format", "xml")):
            self.refused(2, "play", *self.SHORT, option, value, says=[option])

    def test_the_run_is_reported_as_json(self):
        before_ns = time.monotonic_ns()
        r = self.ok("play", "park2016-1", "--duration", "0.3", "--format", "json", "-D", "null")
        after_ns = time.monotonic_ns()
        told = json.loads(r.stdout)
        self.assertEqual(told["schema"], "tactor-play/1")
        self.assertEqual({k: told["device"][k] for k in ("pcm", "channels", "rate_hz", "period_frames", "buffer_frames")},
                         {"pcm": "null", "channels": 9, "rate_hz": 48000, "period_frames": 96, "buffer_frames": 288})
        (stroke,) = told["strokes"]
        self.assertEqual((stroke["stroke"], stroke["state"], stroke["reason"]), ("park2016-1", "finished", None))
        self.assertEqual(stroke["frames"], stroke["length_frames"])
        self.assertTrue(before_ns < stroke["started_ns"] < after_ns, stroke["started_ns"])
        counters = told["counters"]
        self.assertEqual((counters["xruns"], counters["xrun_s"], counters["reopened"]), (0, [], 0))
        self.assertGreaterEqual(counters["frames"], stroke["frames"])

    def test_counters_are_reported_where_asked_for_and_where_one_is_bad(self):
        quiet = self.ok("play", *self.SHORT, "-D", "null").stdout
        if not re.search(r"(?m)^xruns +[1-9]", quiet):  # of a machine that stood still
            self.assertRegex(quiet, r"\A.*\n--path: played \d\.\d+ s\n\Z")
        for more in (("--verbose",), ("--power-dbfs", "-40")):
            out = self.ok("play", *self.SHORT, "-D", "null", *more).stdout
            for name in ("xruns", "latest wake-up", "ring low water", "page faults", "limited", "real time"):
                self.assertRegex(out, f"(?m)^{name} +\\S")

    def on_failing_device(self, *args, comes_back=False):
        """Plays two strokes to a file of s32 that refuses writes after a second of the first, which lasts an hour;
        `comes_back` once the tool waits for it."""
        folder = self.dir / "device"
        folder.mkdir()
        self.write("long.toml", '[stroke]\npath = "M 0 10 L 40 30"\nduration_s = 3600\n')

        def ignore():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)

        p = subprocess.Popen([TOOL, "play", "long.toml", "park2016-1", "-D", f"raw:{folder}/out.raw", "--sample-format", "s32",
                              *args], preexec_fn=ignore, cwd=self.dir, env=self.env, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                             text=True)
        self.addCleanup(p.kill)
        self.heard_for(p, folder / "out.raw", 60000 * 36)
        _, hard = resource.prlimit(p.pid, resource.RLIMIT_FSIZE)
        size = (folder / "out.raw").stat().st_size  # more than a log has
        if comes_back:
            folder.rename(self.dir / "gone")
        resource.prlimit(p.pid, resource.RLIMIT_FSIZE, (size, hard))
        said = ""
        if comes_back:
            while "waiting for" not in said:
                said += (line := p.stderr.readline())
                self.assertTrue(line, said)
            resource.prlimit(p.pid, resource.RLIMIT_FSIZE, (hard, hard))
            folder.mkdir()
        out, err = p.communicate(timeout=PATIENCE_S)
        told = json.loads(out) if "json" in args else {"strokes": []}
        for s in told["strokes"]:
            self.assertEqual(s["started_ns"] is None, s["frames"] == 0)
        return subprocess.CompletedProcess(p.args, p.returncode, out, said + err), told, [s["state"] for s in told["strokes"]]

    def heard_for(self, process, file, size):
        """Waits until so many bytes from the first sound on are in the file."""
        first = None

        def heard():
            nonlocal first
            if first is None and file.exists():
                data = file.read_bytes()
                first = len(data) - len(data.lstrip(b"\0")) if data.strip(b"\0") else None
            return first is not None and file.stat().st_size >= first + size
        self.until(heard, process)

    def test_a_stroke_that_the_device_cuts_is_reported_and_ends_the_run(self):
        r, told, states = self.on_failing_device("--format", "json")
        self.assertEqual((r.returncode, states), (1, ["interrupted", "not played"]), r.stderr)
        self.assertGreater(told["strokes"][0]["frames"], 48000)
        self.assertLess(told["strokes"][0]["frames"], told["strokes"][0]["length_frames"])
        self.assertRegex(r.stderr, r"tactor: long.toml: interrupted after \d+\.\d+ s: .*--reopen-s")

    def test_an_interrupted_stroke_voids_the_run_where_asked_for(self):
        r, _, _ = self.on_failing_device("--void-on-xrun", "--reopen-s", PATIENCE)
        self.assertEqual(r.returncode, 1)
        self.assertRegex(r.stderr, r"tactor: long.toml: interrupted after .*void")
        self.assertIn("long.toml: interrupted after", r.stdout)
        self.assertNotIn("park2016-1", r.stdout)

    def test_a_device_that_comes_back_gets_the_next_stroke(self):
        r, told, states = self.on_failing_device("--format", "json", "--reopen-s", PATIENCE, comes_back=True)
        # The first did not finish, whatever came after it.
        self.assertEqual((r.returncode, states), (1, ["interrupted", "finished"]), r.stderr)
        self.assertEqual(told["counters"]["reopened"], 1)
        self.assertRegex(r.stderr, "(?s)warning: long.toml: interrupted.*waiting for.*is back.*\ntactor: long.toml: interrupted after")

    LOG_LINE = r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z (debug|info|warning|error) \S.*"

    def test_a_log_has_the_stream_s_setup_and_is_appended_to(self):
        quiet = self.ok("play", *self.SHORT, "-D", "null")
        self.assertNotRegex(quiet.stderr, self.LOG_LINE)
        for times in (1, 2):
            r = self.ok("play", *self.SHORT, "-D", "null", "--log", "play.log")
            self.assertEqual(r.stderr, quiet.stderr)
            lines = (self.dir / "play.log").read_text().splitlines()
            for line in lines:
                self.assertRegex(line, f"^{self.LOG_LINE}$")
            self.assertEqual(sum('info PCM "null": 9 channels, 48000 Hz' in line for line in lines), times)
            self.assertEqual(sum(line.endswith("info the stream has ended") for line in lines), times)
        self.assertRegex(self.ok("play", *self.SHORT, "-D", "null", "--verbose").stderr, f"(?m)^{self.LOG_LINE}$")

    def test_a_log_has_a_line_a_stroke(self):
        before_s = time.monotonic()
        self.ok("play", *self.SHORT, "-D", "null", "--log", "play.log")
        self.ok("play", "--live", "-", "-D", "null", "--log", "play.log", stdin="20 20\n")
        self.ok("check", "--walk", "--auto", "-D", "null", "--log", "play.log")
        after_s = time.monotonic()
        lines = re.findall(r" info stroke (.*): began \d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z \((\d+\.\d{6}) s by CLOCK_MONOTONIC\), "
                           r"finished after (\d+\.\d{3}) s\n", (self.dir / "play.log").read_text())
        self.assertEqual([name for name, _, _ in lines], ["--path", "live"] + [f"tactor {k}" for k in range(9)])
        for _, at_s, played_s in lines:
            self.assertTrue(before_s < float(at_s) < after_s, at_s)
            self.assertGreater(float(played_s), 0)

    def test_a_log_has_a_lost_device_and_its_return(self):
        r, _, _ = self.on_failing_device("--reopen-s", PATIENCE, "--log", "play.log", "--verbose", comes_back=True)
        self.assertEqual(r.returncode, 1, r.stderr)
        log = (self.dir / "play.log").read_text()
        self.assertRegex(log, r'(?s)error the stream has ended: .*info waiting for PCM "raw:.*info PCM "raw:.*" is back'
                              r".*info stream on .*info the stream has ended\n")

    def test_a_log_is_written_only_to_logs(self):
        array = self.write("a.toml", GRID)
        (self.dir / "link.log").symlink_to("elsewhere")
        os.mkfifo(self.dir / "pipe")
        for name, why in (("a.toml", "no log"), ("link.log", "is a link"), ("pipe", "no regular file"), ("/dev/null", "no regular file"),
                          (".", "folder"), ("none/play.log", "No such file"), ("", "empty")):
            r = self.refused(2, "play", *self.SHORT, "-D", "null", "--log", name, says=[why])
            self.assertEqual(r.stdout, "", name)
        self.assertEqual(array.read_text(), GRID)
        self.assertFalse((self.dir / "elsewhere").exists())
        self.refused(2, "check", "--verbose")
        self.refused(3, "play", *self.SHORT, "-D", "nowhere", "--log", "play.log")

    def test_ctrl_c_does_not_wait_for_a_buffer_of_a_minute(self):
        p = subprocess.Popen([TOOL, "play", "park2016-1", "-D", "null", "--period-frames", "1048576",
                              "--rate", "8000"], cwd=self.dir,
                             env=self.env, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.assertIn(b"latency 393216.0 ms", p.stdout.readline())
        p.send_signal(signal.SIGINT)
        # 0.4 s on a quiet machine; the period takes 131 s, the buffer 393 s.
        out, _ = p.communicate(timeout=120)
        self.assertEqual(p.returncode, 130)
        self.assertIn(b"park2016-1: cancelled", out)

    def test_ctrl_c_still_reports(self):
        p = subprocess.Popen([TOOL, "play", "park2016-1", "park2016-2", "--duration", "600", "-D",
                              f"raw:{self.dir}/out.raw", "--format", "json"], cwd=self.dir, env=self.env,
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.heard_for(p, self.dir / "out.raw", 36 * 4800)
        p.send_signal(signal.SIGINT)
        out, _ = p.communicate(timeout=PATIENCE_S)
        self.assertEqual(p.returncode, 130)
        self.assertEqual([s["state"] for s in json.loads(out)["strokes"]], ["cancelled", "not played"])

    def test_without_rights_it_plays_and_says_how_to_get_them(self):
        def no_rights():
            for limit in (resource.RLIMIT_RTPRIO, resource.RLIMIT_MEMLOCK):
                resource.setrlimit(limit, (0, 0))
            if os.geteuid() == 0:
                os.setgroups([])
                os.setgid(65534)
                os.setuid(65534)

        os.chmod(self.dir, 0o777)
        # Folder for the coverage build's counts, writable by that user.
        env = {**self.env, "GCOV_PREFIX": str(self.dir)}
        try:
            subprocess.run([TOOL, "--version"], preexec_fn=no_rights, env=env, check=True, capture_output=True)
        except (OSError, subprocess.CalledProcessError):
            self.skipTest("another user cannot run the tool here")

        def play(*more):
            return subprocess.run([TOOL, "play", *self.SHORT, "-D", "null", *more], preexec_fn=no_rights, cwd=self.dir,
                                  env=env, capture_output=True, text=True, check=False)

        r = play()
        self.assertEqual(r.returncode, 0, r.stderr)
        for text in ("no real-time priority", "memory is not locked", "limits.d", "rtprio", "group audio"):
            self.assertIn(text, r.stderr)
        self.assertIn("not locked", play("--verbose").stdout)
        self.assertEqual(len(r.stderr.splitlines()), 1)
        r = play("--require-realtime")
        self.assertEqual(r.returncode, 3)
        self.assertIn("limits.d", r.stderr)

    def test_lines_of_the_configuration_must_exist_unless_switched_off(self):
        self.write("c.toml", '[amplifier]\nline = { chip = "no-such-chip", offset = 3 }\n')
        self.refused(3, "play", *self.SHORT, "--config", "c.toml", "-D", "null")
        self.ok("play", *self.SHORT, "--config", "c.toml", "-D", "null", "--no-gpio")
        self.refused(2, "play", *self.SHORT, "--arm", "-D", "null")

    def test_the_marker_channel_of_the_configuration_is_played(self):
        self.write("c.toml", "[sync]\nchannel = 9\n")
        self.ok("play", *self.SHORT, "--config", "c.toml", "--sample-format", "s16", "-D", f"raw:{self.dir}/out.raw")
        raw = memoryview((self.dir / "out.raw").read_bytes()).cast("h")
        marked = [v for v in raw[9::10] if v]
        self.assertEqual(len(marked), 240)  # 5 ms
        self.assertGreaterEqual(min(marked), 32767)

    def test_a_mistyped_device_gets_a_suggestion(self):
        self.refused(3, "play", *self.SHORT, "-D", "eigth")
        self.refused(3, "play", *self.SHORT, "-D", "hw:CARD=NoSuchCard")

    def test_output_is_plain_when_piped(self):
        self.assertNotIn("\033", self.ok("play", *self.SHORT).stdout)  # on a terminal: test_picture.py


if __name__ == "__main__":
    main()
