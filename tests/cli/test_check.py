# SPDX-License-Identifier: MIT
"""tactor check on ALSA's null and file devices, and its walk with answers from a pipe and from a terminal."""
import json
import os
import re
import signal
import tomllib

from harness import GRID, ROOT, ToolTest, main
from terminal import Terminal


class Check(ToolTest):
    def check(self, *args, status=0, **more):
        r = self.run_tool("check", "--format", "json", *args, **more)
        self.assertEqual(r.returncode, status, r.stdout + r.stderr)
        told = json.loads(r.stdout)
        self.assertEqual(told["schema"], "tactor-check/1")
        return told, {f["check"]: f for f in told["findings"]}

    def test_the_null_device_passes_anywhere(self):
        told, found = self.check("-D", "null")
        self.assertEqual((told["errors"], found["device"]["level"]), (0, "ok"))
        self.assertIn("9 channels, 48000 Hz", found["device"]["found"])
        self.assertLessEqual({"array", "channels", "levels", "actuators", "bursts", "limits", "sound rights", "sound servers", "amplifier",
                              "GPIO rights", "real time", "memory"}, set(found))
        for f in told["findings"]:
            self.assertEqual(set(f), {"check", "level", "found", "cure"})
            self.assertTrue(f["level"] == "ok" or f["cure"], f)
        out = self.ok("check", "-D", "null").stdout
        self.assertNotIn("\033", out)
        self.assertLessEqual(max(map(len, out.splitlines())), 79)
        self.assertRegex(out, r"(?m)^ok       array +palm-3x3: 9 tactors, 3 x 3, 40 x 40 mm")
        self.assertRegex(out, r"\n\n0 errors, \d+ warnings?, \d+ ok\n$")

    def test_the_stream_is_opened_as_by_play_and_nothing_sounds(self):
        _, found = self.check("-D", "null", "--rate", "96000", "--latency-ms", "3", "--max-drive-s", "2", "--power-dbfs", "0")
        self.assertIn("96000 Hz, s32, period 96 of 288 frames, latency 3.0 ms", found["device"]["found"])
        self.assertEqual(found["limits"]["found"], "all together at most +0 dB above one at full scale; each at most 2 s in 10 s")
        for args, cure in (((), "tactor devices"), (("-D", f"raw:{self.dir}/out.raw"), "")):
            found = self.check(*args)[1]["device"]
            self.assertTrue(found["level"] == "warning" and cure in found["cure"], found)
        self.assertFalse((self.dir / "out.raw").exists())

    def test_a_missing_device_or_line_is_status_3(self):
        r = self.refused(3, "check", "-D", "nowhere")
        self.assertRegex(r.stdout, r"(?m)^error    device +PCM \"nowhere\"")
        self.write("a.toml", GRID + '[amplifier]\nline = { chip = "no-such-chip", offset = 17 }\n')
        found = self.check("--array", "a.toml", status=3)[1]["amplifier"]
        self.assertTrue(found["level"] == "error" and "GPIO line 17 of no-such-chip" in found["found"], found)
        self.assertNotIn("amplifier", self.check("--array", "a.toml", "--no-gpio")[1])
        # A card, on this machine without one: a missing amplifier is a warning where a person feels it.
        self.assertEqual(self.check("-D", "hw:CARD=Tactor", status=3)[1]["amplifier"]["level"], "warning")
        for device in ("null", f"raw:{self.dir}/out.raw"):
            self.assertEqual(self.check("-D", device)[1]["amplifier"]["level"], "ok")

    def test_a_bad_file_is_status_2_and_hides_nothing_of_the_machine(self):
        self.write("bad.toml", "[array]\ngrid = { rows = 2, columns = 2, pitch = 20.0 }\n")
        _, found = self.check("--array", "bad.toml", status=2)
        self.assertTrue("bad.toml:2" in found["array"]["found"] and "pitch_mm" in found["array"]["cure"] and "real time" in found)
        self.assertEqual(self.refused(2, "check", "--array", "palm-3x4").stdout.count("array"), 1)
        self.write("a.toml", GRID.replace("-3.0", "30.0"))
        self.assertIn("tactor 1", self.check("--array", "a.toml", status=2)[1]["levels"]["found"])
        self.check("-D", "null", "--carrier", "30000", status=2)

    def test_findings_of_the_file_are_warnings(self):
        self.write("a.toml", GRID.replace("piezo", "erm").replace("columns = 2", "columns = 4") + "[limits]\nmax_drive_s = 20\n")
        _, found = self.check("--array", "a.toml", "--carrier", "60")
        self.assertEqual([found[name]["level"] for name in ("actuators", "bursts", "limits")], ["warning"] * 3)
        self.assertIn("max_drive_s", found["limits"]["cure"])
        tactor = "[[tactor]]\nx_mm = {}\ny_mm = 0\nchannel = {}\nmax_dbfs = {}\n"
        self.write("slow.toml", '[array]\nname = "row"\n' + tactor.format(0, 0, 0) + "rise_ms = 60\n")
        self.assertIn("rise_ms is up to 60", self.ok("check", "--array", "slow.toml").stdout)

    def test_wrong_usage_is_refused(self):
        self.write("there.toml", "")
        for args in ("--auto", "-o x.toml", "--walk --auto -o x.toml", "--walk -o there.toml", "--walk -o no/x.toml", "--format csv", "park2016-1"):
            self.refused(2, "check", *args.split())
        self.assertEqual((self.dir / "there.toml").read_text(), "")


# Every table, and keys of each, with values that are no defaults.
EVERY_TABLE = """[array]
name = "desk"
site = "left palm"
up = "fingers"
grid = { rows = 1, columns = 2, pitch_mm = 20 }
rotate_deg = 180
place = [1, -56]
turn = 15
body = 180
max_dbfs = -6
actuator = "piezo"
displacement_um_at_0dbfs = 35
[[tactor]]
tactor = 0
threshold_dbfs = [[100, -24.5], [250, -40.0]]
rise_ms = 5
polarity = -1
gain_db = -2
[[tactor]]
tactor = 1
max_dbfs = -3
[output]
pcm = "null"
rate = 96000
channels = 5
period_frames = 192
periods = 4
[amplifier]
line = { chip = "gpiochip0", offset = 17 }
active_low = true
settle_ms = 25
[sync]
out = { chip = "gpiochip0", offset = 13, pulse_ms = 4 }
channel = 4
in = { name = "GPIO6", edge = "falling", debounce_ms = 2.5, pull = "up" }
code = { channel = 3, bit_ms = 1, pulse_ms = 6, lsl = true }
[sync.codes]
stimulus = 40
answer = 50
void = 60
[limits]
max_drive_s = 2
window_s = 20
power_dbfs = 0
[serve]
max_level_dbfs = -40
http = 4003
tcp = "127.0.0.1:4001"
token_file = "token"
allow_hosts = ["pi.lan", "studio.lan:4003"]
osc_peers = ["192.168.1.7"]
max_clients = 12
[defaults]
level-dbfs = -30
snap = true
algorithm = "tactile-brush"
[calibration]
participant = "P01"
method = "staircase"
carrier_hz = 250
interval_s = 0.5
simulated = false
[[calibration.tactor]]
tactor = 0
threshold_dbfs = -40
sd_db = 1.5
trials = 40
"""


class Walk(ToolTest):
    def setUp(self):
        super().setUp()
        self.write("a.toml", GRID)
        self.raw = self.dir / "out.raw"
        self.recorder = ("-D", f"raw:{self.raw}", "--sample-format", "s16")

    def walk(self, answers, *more, status=0, array=("--array", "a.toml")):
        r = self.run_tool("check", "--walk", *array, *more, stdin="".join(f"{a}\n" for a in answers))
        self.assertEqual(r.returncode, status, r.stderr)
        return r

    def channels(self, array):
        return [t["channel"] for t in self.plan("--path", "M 0 0 L 20 0", "--array", array)["array"]["tactors"]]

    def sounded(self):
        """Returns the channels of out.raw (two of s16) in the order in which they sounded, each run once."""
        raw, order = memoryview(self.raw.read_bytes()).cast("h"), []
        for i in range(0, len(raw), 14):
            loud = [c for c, v in enumerate(raw[i:i + 2]) if v]
            self.assertLessEqual(len(loud), 1, "two at once")
            if loud and order[-1:] != loud:
                order += loud
        return order

    def test_each_tactor_sounds_alone_in_order_at_the_level_of_play(self):
        r = self.walk([0, 1], *self.recorder, "--level-dbfs", "-20")
        self.assertEqual(self.sounded(), [0, 1])
        raw = memoryview(self.raw.read_bytes()).cast("h")
        for c, dbfs in enumerate((-20, -23)):
            self.assertAlmostEqual(max(raw[c::2]) / 32768, 10 ** (dbfs / 20), delta=1e-3)
        self.assertIn("The map is right.", r.stdout)
        self.assertEqual(set(raw[-2:]), {0})
        r = self.ok("check", "--walk", "--auto", "--array", "a.toml", *self.recorder)
        self.assertEqual(self.sounded(), [0, 1])
        self.assertTrue("tactor 1: channel 1, at 20, 0 mm" in r.stdout and "which did you feel" not in r.stdout, r.stdout)

    def test_answers_become_a_new_file_that_says_all_that_the_old_one_does(self):
        r = self.walk([1, 0], "-o", "felt.toml")
        self.assertIn("tactors 0 to 1 are on channels 1, 0", r.stdout)
        self.assertEqual(((self.dir / "a.toml").read_text(), self.channels("felt.toml")), (GRID, [1, 0]))
        self.walk([1, 0, 2, 3, 4, 5, 6, 7], "-D", "null", "-o", "palm.toml", array=("--array", "palm-2x4"))
        self.assertEqual(self.channels("palm.toml"), [1, 0, 2, 3, 4, 5, 6, 7])
        self.write("base/a.toml", GRID)
        self.write("base/b.toml", '[array]\nfile = "a.toml"\n[limits]\nmax_drive_s = 3\n[sync]\nchannel = 4\n'
                                  '[defaults]\nlevel_dbfs = -40\n')
        self.walk([1, 0], "-o", "configured.toml", array=("--config", "base/a.toml"))
        (self.dir / "out").mkdir()
        self.walk([1, 0], "-o", "out/felt.toml", array=("--array", "base/b.toml"))
        (self.dir / "base/a.toml").unlink()
        for file in ("configured.toml", "out/felt.toml"):
            self.assertEqual(self.channels(file), [1, 0])
        self.assertIn("each at most 3 s", self.ok("check", "--array", "out/felt.toml").stdout)
        felt = tomllib.loads((self.dir / "out/felt.toml").read_text())
        self.assertEqual((felt["sync"], felt["defaults"]), ({"channel": 4}, {"level_dbfs": -40}))

    def test_all_that_a_file_says_is_in_the_new_one(self):
        """Each table is compared as a TOML reader reads both files: nothing of the old one is missing."""
        old = self.write("old.toml", EVERY_TABLE)
        self.write("serve.toml", "[serve]\nosc = 4004\n[output]\nrate = 44100\n")
        for args, more in ((("--array", "old.toml", "--config", "serve.toml"), {}), (("--config", "old.toml"), {}),
                           (("--config", "serve.toml"), {"serve": {"osc": 4004}, "output": {"rate": 44100}})):
            self.walk(range(2) if not more else range(9), "-D", "null", "--no-gpio", "--level-dbfs", "-40", "-o", "new.toml", array=args)
            said, new = more or tomllib.loads(old.read_text()), tomllib.loads((self.dir / "new.toml").read_text())
            self.assertEqual({name: new.get(name) for name in said if name not in ("array", "tactor")},
                             {name: table for name, table in said.items() if name not in ("array", "tactor")})
            if not more:
                self.assertEqual(new["array"], {"name": "desk", "site": "left palm", "up": "fingers", "place": [1, -56], "turn": 15, "body": 180})
                tactor = {"x_mm": 0, "y_mm": 0, "channel": 0, "max_dbfs": -6, "actuator": "piezo", "displacement_um_at_0dbfs": 35}
                # Turned by 180 degrees, tactor 0 is on the right.
                self.assertEqual(new["tactor"], [tactor | {"x_mm": 20, "threshold_dbfs": [[100, -24.5], [250, -40.0]], "rise_ms": 5, "polarity": -1, "gain_db": -2},
                                                 tactor | {"channel": 1, "max_dbfs": -3}])
            self.ok("check", "--config", "new.toml", "-D", "null", "--no-gpio")
            (self.dir / "new.toml").unlink()

    def test_a_walk_can_limit_every_tactor_and_so_does_its_file(self):
        self.write("a.toml", GRID.replace("gain_db = -3.0", "max_dbfs = -30"))
        self.walk([0, 1], "--max-dbfs", "-12.5", "--level-dbfs", "-40", "-o", "felt.toml")
        tactors = tomllib.loads((self.dir / "felt.toml").read_text())["tactor"]
        self.assertEqual([t["max_dbfs"] for t in tactors], [-12.5, -30])
        self.assertIn("above its max_dbfs of -41 dBFS", self.walk([0, 1], "--max-dbfs", "-41", "--level-dbfs", "-40", status=2).stderr)
        self.refused(2, "check", "--max-dbfs", "-12")
        self.refused(2, "check", "--walk", "--max-dbfs", "1")
        # The guide shows a line for the head of a file that a walk has written.
        self.walk(range(9), "-D", "null", "--level-dbfs", "-40", "-o", "palm.toml", array=())
        for guide in ("start.md", "study.md"):
            limit = int(re.search(r"under\s`\[array\]`.{1,90}`max_dbfs = (-\d+)`", (ROOT / "man/guide" / guide).read_text(encoding="utf-8"), re.S)[1])
            felt = (self.dir / "palm.toml").read_text()
            self.assertIn("[array]\n", felt)
            self.write("limited.toml", felt.replace("[array]\n", f"[array]\nmax_dbfs = {limit}\n", 1))
            self.refused(2, "render", "park2016-3", "--array", "limited.toml", "--level-dbfs", limit + 1, "-o", "x.wav",
                         says=[f"above its max_dbfs of {limit} dBFS"])
        self.walk(range(9), "-D", "null", "--level-dbfs", "-40", "--max-dbfs", "-12", "-o", "all.toml", array=())
        said = tomllib.loads((self.dir / "all.toml").read_text())
        self.assertEqual(said["array"]["max_dbfs"], -12)

    def test_answers_without_a_map_make_no_file(self):
        for answers, says in (([1, 1], ["tactor 0 (channel 0) and tactor 1 (channel 1)", "at one place, 1"]),
                              ([0, "n"], ["tactor 1 (channel 1) was not felt"]), ([0, "q"], ["stopped after 1 of 2"]),
                              ([0], ["no answer for tactor 1"]), ([], ["no answer for tactor 0"])):
            r = self.walk(answers, "-o", "felt.toml", status=1)
            self.assertTrue(all(text in r.stderr for text in says), r.stderr)
        self.write("a.toml", GRID + '[amplifier]\nline = { name = "no such line" }\n')
        self.walk([0, 1], *self.recorder, "-o", "felt.toml", status=3)
        self.assertFalse((self.dir / "felt.toml").exists() or self.raw.exists() and self.raw.stat().st_size)  # nothing was driven

    def test_r_repeats_b_goes_back_and_nonsense_is_asked_again(self):
        r = self.walk([" 0 ", "r", "9", "", "one", "1"], *self.recorder)
        self.assertEqual(r.stdout.count("tactor 1 (channel 1): which did you feel?"), 5)
        self.assertIn('"9" is not one of these', r.stdout)
        self.assertEqual(self.sounded(), [0, 1])
        r = self.walk(["b", "0", "b", "1", "0"], "-o", "felt.toml")
        self.assertEqual(re.findall(r"tactor (\d) \(channel", r.stdout), ["0", "0", "1", "0", "1"])
        self.assertIn("This is the first tactor.", r.stdout)
        self.assertTrue("b back" in r.stdout and "b back" not in r.stdout.split("tactor 1")[0])
        self.assertEqual(self.channels("felt.toml"), [1, 0])

    def test_a_walk_as_json_asks_on_standard_error(self):
        r = self.walk([1, 0], "--format", "json")
        walked = json.loads(r.stdout)["walk"]
        self.assertEqual(walked["answers"][0], {"tactor": 0, "channel": 0, "felt": 1})
        self.assertEqual((walked["channels"], walked["changed"], walked["problems"]), ([1, 0], True, []))
        self.assertIn("which did you feel?", r.stderr)
        walked = json.loads(self.walk([0, "n"], "--format", "json", status=1).stdout)["walk"]
        self.assertEqual((walked["channels"], len(walked["problems"]), walked["answers"][1]["felt"]), (None, 1, None))

    def on_terminal(self, *args):
        self.env["LC_ALL"] = "C.UTF-8"
        return Terminal(self, ("check", "--walk", "--array", "a.toml", *args))

    def test_on_a_terminal_the_picture_shows_the_tactor(self):
        t = self.on_terminal("-o", "felt.toml")
        for i in range(2):
            # Once more where the machine was too busy to draw while a burst lasted.
            while "█" not in t.until(f"tactor {i} \\(channel {i}\\): which did you feel\\?").string:
                t.key("r\n")
            t.key(f"{i ^ 1}\n")
        t.until("Written: felt.toml")
        self.assertEqual(t.end(), 0)
        self.assertEqual(self.channels("felt.toml"), [1, 0])

    def test_ctrl_c_at_a_question_and_in_a_burst_ends_in_silence_without_a_file(self):
        # Long enough that none of it is over before it has been seen.
        self.write("a.toml", GRID.replace("columns = 2", "columns = 60"))
        for auto in ((), ("--auto",)):
            # The fade is in one period: it is written whole, however long the machine stands still.
            t = self.on_terminal(*self.recorder, "--level-dbfs", "0", "--period-frames", "1024", "--periods", "3", *(auto or ("-o", "felt.toml")))
            if auto:
                self.until(lambda: self.raw.exists() and any(self.raw.read_bytes()[-120 * 4800:]), t)
            else:
                t.until("which did you feel\\?")
            os.kill(t.pid, signal.SIGINT)
            self.assertEqual(t.end(), 130)
            self.assertFalse((self.dir / "felt.toml").exists())
            heard = memoryview(self.raw.read_bytes()).cast("h")
            self.assertEqual(set(heard[-60:]), {0})
            # A tactor at a time: their sum is the sound.
            sound = [sum(heard[i:i + 60]) for i in range(0, len(heard), 60)]
            self.assertGreater(max(sound), 1000)
            self.assertLessEqual(max(abs(a - b) for a, b in zip(sound, sound[1:])), 32768 * 0.0328)
            self.raw.unlink()


if __name__ == "__main__":
    main()
