# SPDX-License-Identifier: MIT
"""tactor check on ALSA's null and file devices."""
import json
import re

from harness import GRID, ToolTest, main


class Check(ToolTest):
    def check(self, *args, status=0, **more):
        r = self.run_tool("check", "--format", "json", *args, **more)
        self.assertEqual(r.returncode, status, r.stdout + r.stderr)
        told = json.loads(r.stdout)
        self.assertEqual(told["schema"], "tactor-check/1")
        return told, {f["check"]: f for f in told["findings"]}

    def test_the_null_device_passes_anywhere(self):
        told, found = self.check("-D", "null")
        self.assertEqual(told["errors"], 0)
        self.assertEqual(found["device"]["level"], "ok")
        self.assertIn("9 channels, 48000 Hz", found["device"]["found"])
        for name in ("array", "channels", "levels", "actuators", "bursts", "limits", "sound rights", "sound servers",
                     "amplifier", "GPIO rights", "real time", "memory"):
            self.assertIn(name, found)
        for f in told["findings"]:
            self.assertEqual(set(f), {"check", "level", "found", "cure"})
            if f["level"] != "ok":
                self.assertTrue(f["cure"], f)

    def test_text_is_plain_and_fits_80_columns(self):
        out = self.ok("check", "-D", "null").stdout
        self.assertNotIn("\033", out)
        self.assertLessEqual(max(map(len, out.splitlines())), 79)
        self.assertRegex(out, r"(?m)^ok       array +palm-3x3: 9 tactors, 3 x 3, 40 x 40 mm")
        self.assertRegex(out, r"\n\n0 errors, \d+ warnings?, \d+ ok\n$")

    def test_without_a_device_there_is_a_warning(self):
        _, found = self.check()
        self.assertEqual(found["device"]["level"], "warning")
        self.assertIn("tactor devices", found["device"]["cure"])

    def test_the_stream_is_opened_as_by_play_and_nothing_sounds(self):
        _, found = self.check("-D", "null", "--rate", "96000", "--latency-ms", "3")
        self.assertIn("96000 Hz, s32, period 96 of 288 frames, latency 3.0 ms", found["device"]["found"])
        _, found = self.check("-D", f"raw:{self.dir}/out.raw")
        self.assertEqual(found["device"]["level"], "warning")
        self.assertFalse((self.dir / "out.raw").exists())

    def test_a_device_that_is_not_available_is_status_3(self):
        r = self.refused(3, "check", "-D", "nowhere")
        self.assertRegex(r.stdout, r"(?m)^error    device +PCM \"nowhere\"")
        _, found = self.check("-D", "eight", status=3)
        self.assertIn("9 channels", found["device"]["found"])
        self.assertIn("channels 8", found["device"]["cure"])

    def test_a_bad_file_is_status_2_and_hides_nothing_of_the_machine(self):
        self.write("bad.toml", "[array]\ngrid = { rows = 2, columns = 2, pitch = 20.0 }\n")
        _, found = self.check("--array", "bad.toml", status=2)
        self.assertIn("bad.toml:2", found["array"]["found"])
        self.assertIn("pitch_mm", found["array"]["cure"])
        self.assertIn("real time", found)
        self.refused(2, "check", "--array", "palm-9x9")

    def test_a_missing_array_is_named_once(self):
        r = self.run_tool("check", "--array", "palm-3x4")
        self.assertEqual(r.returncode, 2)
        self.assertEqual(r.stdout.count("array"), 1, r.stdout)

    def test_impossible_levels_are_status_2(self):
        self.write("a.toml", GRID.replace("-3.0", "30.0"))
        _, found = self.check("--array", "a.toml", status=2)
        self.assertIn("tactor 1", found["levels"]["found"])
        self.check("-D", "null", "--carrier", "30000", status=2)

    def test_levels_say_how_far_slow_tactors_are_driven(self):
        self.assertNotIn("rise_ms", self.check("--array", "palm-3x3")[1]["levels"]["found"])
        tactor = "[[tactor]]\nx_mm = {}\ny_mm = 0\nchannel = {}\nmax_dbfs = {}\n"
        self.write("a.toml", '[array]\nname = "row"\n' + tactor.format(0, 0, -6) + "rise_ms = 3\n" + tactor.format(20, 1, -3) +
                   "rise_ms = 2\n" + tactor.format(40, 2, -1))
        self.assertEqual(self.check("--array", "a.toml")[1]["levels"]["found"],
                         "peaks of -12 dBFS, at beginnings of bursts up to -6 to -3 dBFS for rise_ms")

    def test_actuators_are_checked_against_bursts(self):
        self.write("a.toml", GRID.replace("piezo", "erm"))
        _, found = self.check("--array", "a.toml")
        self.assertEqual(found["actuators"]["level"], "warning")
        self.write("a.toml", GRID)
        _, found = self.check("--array", "a.toml", "--carrier", "60")
        self.assertEqual((found["actuators"]["found"], found["bursts"]["level"]), ("piezo", "warning"))

    def test_limits_are_those_of_the_options(self):
        _, found = self.check("-D", "null", "--max-drive-s", "2", "--power-dbfs", "0")
        self.assertEqual(found["limits"]["found"], "all together at most +0 dB of one at full scale; each at most 2 s in 10 s")

    def test_limits_that_a_file_lifts_are_warnings(self):
        for lifted in ("power_dbfs = 60", "max_drive_s = 20", "window_s = 3"):
            self.write("a.toml", GRID.replace("columns = 2", "columns = 4") + f"[limits]\n{lifted}\n")
            limits = self.check("--array", "a.toml")[1]["limits"]
            self.assertEqual(limits["level"], "warning", lifted)
            self.assertIn(lifted.split()[0], limits["cure"])

    def test_a_missing_amplifier_is_a_warning_where_a_person_feels_it(self):
        self.assertEqual(self.check("-D", "null")[1]["amplifier"]["level"], "ok")
        self.assertEqual(self.check("-D", f"raw:{self.dir}/out.raw")[1]["amplifier"]["level"], "ok")
        # A card, on this machine without one.
        self.assertEqual(self.check("-D", "hw:CARD=Tactor", status=3)[1]["amplifier"]["level"], "warning")

    def test_missing_lines_are_status_3(self):
        self.write("a.toml", GRID + '[amplifier]\nline = { chip = "no-such-chip", offset = 17 }\n')
        _, found = self.check("--array", "a.toml", status=3)
        self.assertEqual(found["amplifier"]["level"], "error")
        self.assertIn("GPIO line 17 of no-such-chip", found["amplifier"]["found"])
        self.assertNotIn("amplifier", self.check("--array", "a.toml", "--no-gpio")[1])

    def test_wrong_usage_is_refused(self):
        self.write("there.toml", "")
        for args, says in ((["--auto"], "--walk"), (["-o", "x.toml"], "--walk"), (["--walk", "--auto", "-o", "x.toml"], "--auto"),
                           (["--walk", "-o", "there.toml"], "already"), (["--walk", "-o", "no/x.toml"], "no folder no"),
                           (["--format", "csv"], "text, json"), (["park2016-1"], "park2016-1")):
            self.refused(2, "check", *args, says=[says])
        self.assertEqual((self.dir / "there.toml").read_text(), "")


if __name__ == "__main__":
    main()
