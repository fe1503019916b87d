# SPDX-License-Identifier: MIT
"""tactor play on ALSA's null and file devices, which need no hardware and pace themselves; and drive time from run to run."""
import datetime
import json
import math
import os
import random
import re
import resource
import signal
import struct
import subprocess
import time

from harness import ALSA_CONFIG, FELT_CONFIG, GRID, PATIENCE_S, TOOL, ToolTest, Wav, main, wav_file
from serving import Server

# The fade of 10 ms is in one period: it is written whole, even where the machine stands still beyond the wait for it.
WHOLE_FADE = ("--period-frames", "1024", "--periods", "3")


class Play(ToolTest):
    SHORT = ("--path", "M 0 10 L 40 30", "--duration", "0.3")

    def test_a_device_gets_what_render_writes(self):
        self.ok("render", *self.SHORT, "--sample-format", "s16", "-o", "o.wav")
        self.ok("play", *self.SHORT, "--sample-format", "s16", "-D", f"raw:{self.dir}/out.raw")
        wav, raw = Wav(self.dir / "o.wav").data, (self.dir / "out.raw").read_bytes()
        # The first frame of a stroke is a zero crossing: compare from the first sound on.
        start, lead = (next(i for i, v in enumerate(data) if v) // 18 for data in (raw, wav))
        heard = raw[(start - lead) * 18:]
        self.assertEqual((heard[:len(wav)], set(heard[len(wav):])), (wav, {0}))

    def test_samples_of_ones_own_come_out_bit_for_bit(self):
        rng = random.Random(4)
        floats = b"".join(struct.pack("<f", rng.uniform(-0.25, 0.25)) for _ in range(9 * 2000))
        # A quarter of full scale at most keeps the level of -12 dBFS.
        files = {"float": (floats, 32, 3), **{f"s{bits}": (b"".join(rng.randrange(-2 ** (bits - 3), 2 ** (bits - 3)).to_bytes(bits // 8, "little", signed=True)
                                                                    for _ in range(9 * 2000)), bits, 1) for bits in (16, 24, 32)}}
        for name, (data, bits, tag) in files.items():
            self.write("Nine.WAV", wav_file(data, 9, bits, tag))
            self.ok("render", "Nine.WAV", "--sample-format", name, "-o", "o.wav")
            self.assertEqual(Wav(self.dir / "o.wav").data, data, name)
            raw = self.dir / f"{name}.raw"
            r = self.ok("play", "Nine.WAV", "--sample-format", name, "-D", f"raw:{raw}")
            before, heard, after = raw.read_bytes().partition(data)
            self.assertEqual((heard == data, set(before + after)), (True, {0}), name)
            self.assertIn("Nine.WAV: played", r.stdout)
        # Eight bits: 128 is zero, and 160 a quarter.
        self.write("eight.wav", wav_file(bytes([128, 160, 97] * 3), 9, 8))
        self.ok("render", "eight.wav", "--sample-format", "s16", "-o", "o.wav")
        self.assertEqual(Wav(self.dir / "o.wav").data, struct.pack("<hhh", 0, 8192, -7936) * 3)

    def test_what_render_writes_plays_again(self):
        self.write("a.toml", '[array]\nname = "a"\ngrid = { rows = 1, columns = 2, pitch_mm = 20.0 }\nmax_dbfs = -12\n[sync]\nchannel = 2\n')
        for name in ("float", "s16", "s24", "s32"):
            self.ok("render", "--path", "M 0 0 L 20 0", "--array", "a.toml", "--sample-format", name, "-o", "w.wav")
            r = self.ok("play", "w.wav", "--array", "a.toml", "--sample-format", name, "--format", "json", "-D", f"raw:{self.dir}/{name}.raw")
            self.assertIn(Wav(self.dir / "w.wav").data, (self.dir / f"{name}.raw").read_bytes(), name)
            counters = json.loads(r.stdout)["counters"]
            self.assertEqual((counters["power_limited_frames"], counters["drives_cut"]), (0, 0))

    def test_samples_that_do_not_fit_are_refused_with_what_to_do(self):
        tone = [round(0.5 * 32768 * math.sin(k * math.pi / 96)) for k in range(4800)]

        def written(name, channels, rate=48000, data=None):
            data = b"".join(struct.pack("<h", v) * channels for v in tone) if data is None else data
            return self.write(name, wav_file(data, channels, 16, rate=rate))

        written("nine.wav", 9)
        says = "channel 0 (tactor 0) peaks at -6.02 dBFS, 5.98 dB above the level of -12 dBFS (make the samples quieter by 5.98 dB, or use --level-dbfs -6.02)"
        self.refused(2, "play", "nine.wav", "-D", "null", says=[says])
        self.refused(2, "render", "nine.wav", "-o", "o.wav", says=[says])
        self.ok("play", "nine.wav", "--level-dbfs", "-6.02", "-D", "null")
        self.write("a.toml", '[array]\nname = "a"\ngrid = { rows = 3, columns = 3, pitch_mm = 20.0 }\nmax_dbfs = -20\n')
        self.refused(2, "play", "nine.wav", "--array", "a.toml", "--level-dbfs", "0", says=["13.98 dB above its max_dbfs of -20 dBFS"])
        written("slow.wav", 9, 44100)
        self.refused(2, "play", "slow.wav", "--level-dbfs", "0", says=["its rate is 44100 Hz, but the stream's is 48000 Hz (use --rate 44100, or convert the file: sox IN -r 48000 OUT)"])
        self.ok("play", "slow.wav", "--level-dbfs", "0", "--rate", "44100", "-D", "null")
        written("two.wav", 2)
        self.refused(2, "play", "two.wav", "--level-dbfs", "0", says=["2 channels, but the stream has 9 (add silent channels: sox IN OUT remix 1 2 0 0 0 0 0 0 0)"])
        written("ten.wav", 10)
        self.refused(2, "play", "ten.wav", "--level-dbfs", "0", says=["10 channels, but the stream has 9 (use --channels 10, or leave some channels out: sox IN OUT remix 1 2 3 4 5 6 7 8 9)"])
        self.ok("play", "ten.wav", "--level-dbfs", "0", "--channels", "10", "-D", "null")
        written("empty.wav", 9, data=b"")
        self.refused(2, "play", "empty.wav", says=["empty.wav: it has no samples"])
        self.write("cut.wav", (self.dir / "nine.wav").read_bytes()[:-1000])
        self.refused(2, "play", "cut.wav", says=["cut.wav: it is cut short"])
        self.write("text.wav", "x y")
        self.refused(2, "play", "text.wav", says=["text.wav: it is not a WAV file"])
        self.refused(2, "play", "missing.wav", says=["missing.wav: No such file"])
        self.refused(2, "play", "nine.wav", "--sl", "7", says=["nine.wav: a sensation level needs a carrier"])
        for option in (("--soa", "0.1"), ("--carrier", "100"), ("--ramp", "0.01"), ("--speed", "10"), ("--together", "sum")):
            self.refused(2, "play", "nine.wav", *option, says=[f"has samples, which play as they are (leave out {option[0]})"])
        for command in (("plan",), ("plot", "-o", "o.svg"), ("compare",)):
            self.refused(2, *command, "nine.wav", says=["nine.wav: it has samples, but no stroke to plan (use tactor play or tactor render)"])
        with (self.dir / "huge.wav").open("wb") as f:
            f.truncate(3 << 30)
        self.refused(2, "play", "huge.wav", says=["huge.wav: it has 3072 MB of samples, but tactor loads at most 1024 MB"])

    def test_samples_have_the_limits_and_the_end_of_strokes(self):
        def tone(seconds, peak):
            cycle = b"".join(struct.pack("<h", round(peak * 32768 * math.sin(k * math.pi / 96))) * 9 for k in range(192))
            return wav_file(cycle * (250 * seconds), 9, 16)

        self.write("tone.wav", tone(1, 0.25))
        for options, cut, limited in (((), False, False), (("--max-drive-s", "0.3", "--drive-window-s", "1"), True, False), (("--power-dbfs", "-20"), False, True)):
            counters = json.loads(self.ok("play", "tone.wav", "-D", "null", "--format", "json", *options).stdout)["counters"]
            self.assertEqual((counters["drives_cut"] > 0, counters["power_limited_frames"] > 1000), (cut, limited), options)
        self.write("long.wav", tone(60, 0.01))
        raw = self.dir / "out.raw"
        p = self.start_tool("play", "long.wav", "tone.wav", "-D", f"raw:{raw}", "--sample-format", "s16", "--format", "json", *WHOLE_FADE, stdout=subprocess.PIPE)
        self.heard_for(p, raw, 18 * 4800)
        p.send_signal(signal.SIGINT)
        out, _ = p.communicate(timeout=PATIENCE_S)
        self.assertEqual((p.returncode, [s["state"] for s in json.loads(out)["strokes"]]), (130, ["cancelled", "not played"]))
        heard = memoryview(raw.read_bytes()).cast("h")
        self.assertEqual(set(heard[-9:]), {0})
        self.assertLessEqual(max(abs(a - b) for a, b in zip(heard[9:], heard)), 328 * 0.0328 + 2)

    def test_device_and_strokes_are_named(self):
        r = self.ok("play", "park2016-1", "park2016-2", "--duration", "0.2")
        self.assertTrue("null" in r.stderr and "9 channels" in r.stdout and "\033" not in r.stdout, r.stdout)
        self.assertLess(r.stdout.index("park2016-1: played"), r.stdout.index("park2016-2: played"))
        self.write("a.toml", '[array]\nname = "a"\ngrid = { rows = 2, columns = 2, pitch_mm = 40.0 }\n'
                             '[output]\npcm = "null"\nchannels = 6\nperiod_frames = 128\nperiods = 4\nrate = 44100\n')
        self.assertRegex(self.ok("play", *self.SHORT, "--array", "a.toml").stdout, "6 channels, 44100 Hz.*128 of 512")
        for device in ("nowhere", "eigth", "hw:CARD=NoSuchCard"):
            self.refused(3, "play", *self.SHORT, "-D", device)

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
        stroke = '[[stroke]]\npath = "M 0 10 L 1 10"\nduration_s = 1.0\nstart_s = 0.0\n'
        for strokes, cut in ((1, False), (20, True)):  # weak ones count together
            self.write("s.toml", stroke * strokes)
            r = self.ok("play", "s.toml", *long[5:], "--level-dbfs", "-40.1", "--together", "sum", "--max-drive-s", "0.3", "--drive-window-s", "1")
            self.assertEqual((json.loads(r.stdout)["counters"]["drives_cut"] > 0, "wait 0.7 s before the next stroke" in r.stderr), (cut, cut), r.stderr)

    def test_the_kernel_ends_a_thread_that_runs_away_with_real_time_priority(self):
        """In microseconds without a pause, after which the amplifier's own process switches off."""
        p = self.start_tool("play", *self.SHORT[:3], "3600", "-D", "null", stdout=subprocess.PIPE, text=True)
        self.assertIn("null: 9 channels", p.stdout.readline())
        soft, hard = resource.prlimit(p.pid, resource.RLIMIT_RTTIME)
        self.assertTrue(0 < soft <= 200_000 and soft <= hard <= 1_000_000, (soft, hard))
        p.send_signal(signal.SIGINT)
        self.assertEqual((p.wait(PATIENCE_S), p.stdout.close()), (130, None))

    def test_ctrl_c_fades_out_reports_and_exits_130(self):
        raw = self.dir / "out.raw"
        for number, status in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            p = self.start_tool("play", "park2016-1", "park2016-2", "--duration", "3600", "-D", f"raw:{raw}", "--sample-format", "s16",
                                "--level-dbfs", "0", "--format", "json", *WHOLE_FADE, stdout=subprocess.PIPE)
            self.heard_for(p, raw, 18 * 4800)
            p.send_signal(number)
            out, _ = p.communicate(timeout=PATIENCE_S)
            self.assertEqual((p.returncode, [s["state"] for s in json.loads(out)["strokes"]]), (status, ["cancelled", "not played"]))
            heard = memoryview(raw.read_bytes()).cast("h")
            self.assertEqual(set(heard[-9:]), {0})
            # A full-scale carrier of 250 Hz moves by at most 2 pi 250 / 48000 of full scale in a frame.
            self.assertLessEqual(max(abs(a - b) for a, b in zip(heard[9:], heard)), 32768 * 0.0328)
            raw.unlink()

    def test_strokes_are_repeated_with_a_pause(self):
        raw = self.dir / "out.raw"
        short = ("--path", "M 0 10 H 1", "--duration", "0.1", "--algorithm", "continuous", "--sample-format", "s16", "--format", "json")
        told = json.loads(self.ok("play", *short, "-D", f"raw:{raw}", "--repeat", "3", "--pause", "0.25").stdout)
        (stroke,) = told["strokes"]
        self.assertEqual((stroke["rounds"], stroke["state"], stroke["frames"]), (3, "finished", 3 * stroke["length_frames"]))
        frames = [any(frame) for frame in zip(*[iter(memoryview(raw.read_bytes()).cast("h"))] * 9)]
        begins = [i for i, sounds in enumerate(frames) if sounds and not any(frames[max(i - 1000, 0):i])]
        self.assertEqual(len(begins), 3)
        lines = self.ok("play", *self.SHORT, "-D", "null", "--repeat", "2").stdout
        self.assertEqual(lines.count(": played 0."), 2)
        p = self.start_tool("play", "park2016-1", *short[2:], "-D", f"raw:{self.dir}/f.raw", "--repeat", "forever", stdout=subprocess.PIPE)
        self.heard_for(p, self.dir / "f.raw", 18 * 20000)
        p.send_signal(signal.SIGINT)
        out, _ = p.communicate(timeout=PATIENCE_S)
        self.assertEqual(p.returncode, 130)
        self.assertGreaterEqual(json.loads(out)["strokes"][0]["rounds"], 2)
        for options in (("--repeat", "0"), ("--repeat", "1.5"), ("--repeat", "always"), ("--pause", "1"), ("--repeat", "2", "--pause", "-1"),
                        ("--repeat", "2", "--arm", "--pause", "1")):
            self.refused(2, "play", *self.SHORT, *options, says=(options[-2] if options[-1] != "always" else "--repeat",))
        self.refused(2, "play", "--live", "-", "--repeat", "2", says=("--repeat",))

    def test_latency_is_periods_times_period(self):
        self.write("c.toml", '[output]\npcm = "null"\nperiod_frames = 500\nperiods = 5\n')
        self.write("d.toml", "[defaults]\nlatency-ms = 5\n[output]\nperiod_frames = 128\n")
        self.write("a.toml", 'array.preset = "palm-3x3"\n[defaults]\nlatency-ms = 10\n')
        for options, sizes in (("", ("96", "288", "6.0")), ("--latency-ms 3", ("48", "144", "3.0")), ("--latency-ms 10 --periods 2", ("240", "480", "10.0")),
                               ("--period-frames 64 --periods 4", ("64", "256", "5.3")), ("--config c.toml --latency-ms 5", ("48", "240", "5.0")),
                               ("--config d.toml", ("80", "240", "5.0")), ("--config d.toml --latency-ms 3", ("48", "144", "3.0")),
                               ("--config d.toml --period-frames 64", ("64", "192", "4.0")), ("--config d.toml --array a.toml", ("160", "480", "10.0"))):
            out = self.ok("play", *self.SHORT, *options.split()).stdout
            self.assertEqual(re.search(r"period (\d+) of (\d+) frames, latency ([0-9.]+) ms", out).groups(), sizes, options)
        for options in ("--latency-ms 3 --period-frames 64", "--latency-ms nan", "--latency-ms 0", "--period-frames 1.5", "--periods 1", "--reopen-s -1",
                        "--sync-delay-ms x", "--format xml"):
            self.refused(2, "play", *self.SHORT, *options.split())

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

    def test_strokes_that_meet_are_reported_with_how_much_weaker_they_are(self):
        self.write("two.toml", "".join(f'[[stroke]]\nstart_s = 0.0\npath = "{path}"\nduration_s = 0.56\n'
                                       for path in ("M 0 20 H 40", "M 40 20 H 0")))
        ran = self.ok("play", "two.toml", "park2016-1", "-D", "null", "--level-dbfs", "-30", "--format", "json")
        self.assertIn("two.toml: weakened by 6.02 dB: strokes 1 and 2 meet on tactor 4 at 0.28 s (use --together sum to let strokes add up)", ran.stderr)
        two, alone = json.loads(ran.stdout)["strokes"]
        self.assertAlmostEqual(two["weakened_db"], -6.0206, 3)
        self.assertEqual(two["meets"]["strokes"], [0, 1])
        self.assertEqual(alone["weakened_db"], 0)
        self.assertNotIn("meets", alone)
        self.assertIn("; weakened by 6.02 dB", self.ok("play", "two.toml", "-D", "null", "--level-dbfs", "-30").stdout)

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

        p = self.start_tool("play", "long.toml", "park2016-1", "-D", f"raw:{folder}/out.raw", "--sample-format", "s32", *args,
                            preexec_fn=lambda: signal.signal(signal.SIGXFSZ, signal.SIG_IGN), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
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
        r, _, _ = self.on_failing_device("--void-on-xrun", "--reopen-s", PATIENCE_S)
        self.assertEqual(r.returncode, 1)
        self.assertRegex(r.stderr, r"tactor: long.toml: interrupted after .*void")
        self.assertIn("long.toml: interrupted after", r.stdout)
        self.assertNotIn("park2016-1", r.stdout)

    def test_a_device_that_comes_back_gets_the_next_stroke(self):
        r, told, states = self.on_failing_device("--format", "json", "--reopen-s", PATIENCE_S, "--log", "play.log", "--verbose", comes_back=True)
        # The first did not finish, whatever came after it.
        self.assertEqual((r.returncode, states), (1, ["interrupted", "finished"]), r.stderr)
        self.assertEqual(told["counters"]["reopened"], 1)
        self.assertRegex(r.stderr, "(?s)warning: long.toml: interrupted.*waiting for.*is back.*\ntactor: long.toml: interrupted after")
        self.assertRegex((self.dir / "play.log").read_text(), r'(?s)error the stream has ended: .*info waiting for PCM "raw:.*'
                         r'info PCM "raw:.*" is back.*info stream on .*info the stream has ended\n')

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
            at = datetime.datetime.fromisoformat(lines[-1].split()[0])
            self.assertLess(abs(datetime.datetime.now(datetime.timezone.utc) - at).total_seconds(), PATIENCE_S)
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

    def test_a_log_is_written_only_to_logs(self):
        array = self.write("a.toml", GRID)
        (self.dir / "link.log").symlink_to("elsewhere")
        os.mkfifo(self.dir / "pipe")
        for name in ("a.toml", "link.log", "pipe", "/dev/null", ".", "none/play.log", ""):
            self.assertEqual(self.refused(2, "play", *self.SHORT, "-D", "null", "--log", name).stdout, "", name)
        self.assertEqual((array.read_text(), (self.dir / "elsewhere").exists()), (GRID, False))
        self.refused(2, "check", "--verbose")
        self.refused(3, "play", *self.SHORT, "-D", "nowhere", "--log", "play.log")

    def test_ctrl_c_does_not_wait_for_a_buffer_of_a_minute(self):
        p = self.start_tool("play", "park2016-1", "-D", "null", "--period-frames", "1048576", "--rate", "8000", stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE)
        self.assertIn(b"latency 393216.0 ms", p.stdout.readline())
        p.send_signal(signal.SIGINT)
        # 0.4 s on a quiet machine; the period takes 131 s, the buffer 393 s.
        out, _ = p.communicate(timeout=120)
        self.assertEqual(p.returncode, 130)
        self.assertIn(b"park2016-1: cancelled", out)

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


class KeptDrive(ToolTest):
    """Drive time of a tactor counts on from one run of a user to the next. Windows last an hour: no machine is so slow that time itself
    gives it back."""
    LIMITS = ("--max-drive-s", "0.5", "--drive-window-s", "3600")
    STILL = ("--path", "M 0 0 L 0.001 0", "--algorithm", "continuous")  # one tactor, all the time

    def setUp(self):
        super().setUp()
        self.write("alsa.conf", ALSA_CONFIG + FELT_CONFIG)
        self.runtime = self.dir / "run"
        self.runtime.mkdir(mode=0o700)
        self.env["XDG_RUNTIME_DIR"] = str(self.runtime)

    def play(self, device="felt", seconds=0.3, **more):
        return self.ok("play", *self.STILL, "--duration", seconds, *self.LIMITS, "--format", "json", "-D", device, **more)

    def cuts(self, *args, **more):
        return json.loads(self.play(*args, **more).stdout)["counters"]["drives_cut"]

    def kept(self):
        return sorted(self.runtime.rglob("drive-time-*"))

    def test_runs_of_a_user_on_a_device_count_together(self):
        self.write("alsa.conf", ALSA_CONFIG)
        self.ok("render", "park2016-1", "-o", "x.wav")
        self.refused(3, "play", *self.STILL, "-D", "nowhere")
        self.refused(2, "play", *self.STILL, "--max-drive-s", "0", "-D", "null")
        self.write("alsa.conf", ALSA_CONFIG + FELT_CONFIG)
        self.assertEqual(self.kept(), [])  # nothing was opened
        self.assertEqual(self.cuts(), 0)
        self.assertEqual([(f.name, f.parent.stat().st_mode & 0o777) for f in self.kept()], [("drive-time-felt", 0o700)])
        self.assertEqual(self.cuts(env={"XDG_RUNTIME_DIR": str(self.dir)}), 0)  # another user
        self.assertEqual((self.cuts(), self.cuts("felt2")), (1, 0))

    def test_the_null_device_and_what_plays_on_it_keep_none(self):
        self.write("alsa.conf", ALSA_CONFIG + 'pcm.other { type plug slave.pcm { type null } }\n')
        for device in ("null", "other", "eight", f"raw:{self.dir}/x.raw"):
            array = ("--array", "palm-2x4") if device == "eight" else ()
            runs = [
                self.ok("play", *self.STILL, "--duration", 0.4, *self.LIMITS, "--format", "json", "-D", device, *array) for _ in range(2)]
            self.assertEqual([json.loads(r.stdout)["counters"]["drives_cut"] for r in runs], [0, 0], device)
        self.assertEqual(self.kept(), [])

    def test_a_service_counts_earlier_runs_and_is_counted_also_when_it_reopens_the_device(self):
        config = "[limits]\nmax_drive_s = 0.5\nwindow_s = 3600\n"
        s = Server(self, "--idle-stop", "0.1", config=config, env={"XDG_RUNTIME_DIR": str(self.runtime)}, device=("-D", "felt"))
        client = s.client()
        self.ok("play", *self.STILL, "--duration", "0.1", "--socket", s.where["socket"])
        self.until(lambda: client.ok("status")["stream"]["state"] == "idle", s.process)
        self.assertEqual(self.cuts(), 0)
        self.ok("play", *self.STILL, "--duration", "0.2", "--socket", s.where["socket"])
        self.assertEqual(s.terminate()[0], 0)
        self.assertEqual(self.cuts(seconds=0.1), 1)

    def test_a_run_beside_a_service_counts_together_with_it(self):
        config = "[limits]\nmax_drive_s = 0.5\nwindow_s = 3600\n"
        s = Server(self, "--log", self.dir / "log", config=config, env={"XDG_RUNTIME_DIR": str(self.runtime)}, device=("-D", "felt"))
        self.ok("play", *self.STILL, "--duration", "0.1", "--socket", s.where["socket"])  # its stream runs from now on
        self.assertEqual(self.cuts(seconds=0.39), 0)
        self.run_tool("play", *self.STILL, "--duration", "0.3", "--socket", s.where["socket"])
        self.assertEqual(s.terminate()[0], 0)
        self.assertIn("cut short or silent: a tactor was driven for too long", (self.dir / "log").read_text())

    def test_a_file_that_is_cut_counts_as_the_limit_and_is_said_once(self):
        self.assertEqual(self.cuts(seconds=0.05), 0)
        file = self.runtime / "tactor/drive-time-felt"
        file.write_bytes(file.read_bytes()[:-5])
        check = self.ok("check", "-D", "felt").stdout
        self.assertRegex(check, r"(?m)^warning +drive time ")
        r = self.play(seconds=0.05)
        warning = f"tactor: warning: {file} cannot be read completely: each tactor counts as driven for as long as allowed\n"
        self.assertEqual(r.stderr.count(warning), 1)
        self.assertGreater(json.loads(r.stdout)["counters"]["drives_cut"], 0)
        self.assertNotIn(str(file), self.play(seconds=0.05).stderr)
        self.assertRegex(self.ok("check", "-D", "felt").stdout, r"(?m)^ok +drive time ")


if __name__ == "__main__":
    main()
