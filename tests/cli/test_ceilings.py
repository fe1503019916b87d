# SPDX-License-Identifier: MIT
"""Tests ceilings on level and time in two files: the lower one applies, also if a preset names the array."""
import array
import json
import subprocess
import tomllib

from harness import PATIENCE_S, ROOT, TOOL, ToolTest, end_process, main
from serving import ServeTest

QUIET = '[array]\npreset = "palm-3x3"\n[serve]\nmax_level_dbfs = {}\n'
# Two tactors changed places, and may have little.
MINE = """[array]
preset = "palm-3x3"
[[tactor]]
tactor = 3
channel = 5
max_dbfs = -30
[[tactor]]
tactor = 5
channel = 3
max_dbfs = -30
gain_db = -2
[output]
pcm = "null"
channels = 12
"""


class Service(ServeTest):
    def check_ceiling(self, ceiling_dbfs, *args, config=""):
        """Starts a server; returns its status. Its clients' level may be the ceiling, and nothing above it."""
        samples = self.dir / "out.raw"
        s = self.serve(*args, device=("-D", f"raw:{samples}"), config=config)
        c = s.client()
        self.assertEqual([s.where["max_level_dbfs"], c.ok("hello")["max_level_dbfs"]], [ceiling_dbfs] * 2)
        louder = c.error("play", path="M 0 0 L 40 0", options={"level_dbfs": ceiling_dbfs + 0.1})
        self.check_error(louder, -32602, "options.level_dbfs")
        c.await_end(c.ok("play", path="M 20 20", options={"duration": 0.1, "level_dbfs": ceiling_dbfs})["stroke"])
        status = c.ok("status")
        self.assertEqual(status["max_level_dbfs"], ceiling_dbfs)
        self.assertIn(f"ceiling    {ceiling_dbfs} dBFS\n", self.ok("status", "--socket", s.where["socket"]).stdout)
        self.assertEqual(s.terminate()[0], 0)
        peak = max(map(abs, array.array("i", samples.read_bytes()))) / 2**31
        self.assertAlmostEqual(peak, 10 ** (ceiling_dbfs / 20), delta=1e-4)
        return status

    def test_serve_in_the_file_of_array_counts_and_the_lower_ceiling_holds(self):
        quiet = self.write("quiet.toml", QUIET.format(-40) + "max_strokes = 9\nmax_clients = 40\n")
        status = self.check_ceiling(-40, "--array", quiet, config="[serve]\nmax_level_dbfs = -20\nmax_strokes = 7\n")
        self.assertEqual([status["limits"][key] for key in ("max_strokes", "max_clients")], [7, 40])
        loud = self.write("loud.toml", QUIET.format(-20))
        self.check_ceiling(-40, "--array", loud, config="[serve]\nmax_level_dbfs = -40\n")
        self.check_ceiling(-20, "--array", loud, config="[defaults]\nlevel-dbfs = -40\n")
        # The ceiling of a file that another file names applies, too.
        outer = self.write("outer.toml", '[array]\nfile = "quiet.toml"\n[serve]\nmax_level_dbfs = -12\n')
        self.check_ceiling(-40, "--array", outer)

    def test_a_ceiling_of_the_command_line_is_lower_or_refused(self):
        quiet = self.write("quiet.toml", QUIET.format(-40) + "[limits]\nmax_drive_s = 2\nwindow_s = 20\npower_dbfs = 0\n")
        self.check_ceiling(-45, "--array", quiet, "--max-level-dbfs", "-45", "--max-drive-s", "1", "--drive-window-s", "30", "--power-dbfs", "-3")
        self.check_ceiling(-6, "--max-level-dbfs", "-6")  # no file says any
        level = self.write("level.toml", '[array]\npreset = "palm-3x3"\n[defaults]\nlevel-dbfs = -30\n')
        for file, option, value in ((quiet, "--max-level-dbfs", "-39"), (level, "--max-level-dbfs", "-29"), (quiet, "--max-drive-s", "3"),
                                    (quiet, "--drive-window-s", "19"), (quiet, "--power-dbfs", "1")):
            self.refused(2, "serve", "--socket", "no.sock", "-D", "null", "--array", file.name, option, value)
        self.refused(2, "serve", "--max-level-dbfs", "3")

    def test_the_lower_limit_of_a_tactor_holds_whichever_file_says_it(self):
        grid = '[array]\nname = "g"\ngrid = {{ rows = 1, columns = 2, pitch_mm = 20.0 }}\nmax_dbfs = {}\n'
        for name, db in (("low", -20), ("high", -10)):
            self.write(f"{name}.toml", grid.format(db))
        stroke = ("--path", "M 0 0 H 20", "--level-dbfs", "-15", "-D", "null")
        for config, named in (("low", "high"), ("high", "low"), ("low", "low")):
            self.refused(2, "play", *stroke, "--config", f"{config}.toml", "--array", f"{named}.toml", says=["low.toml:3:8: tactor 0 would", "above its max_dbfs of -20 dBFS"])
        self.ok("play", *stroke, "--config", "high.toml", "--array", "high.toml")
        # An error of something else names the file that states it.
        self.write("loud.toml", grid.format(-10) + "[[tactor]]\ntactor = 0\ngain_db = 15\n")
        self.refused(2, "play", *stroke[:2], "--level-dbfs", "-12", "-D", "null", "--config", "low.toml", "--array", "loud.toml", says=["loud.toml:5:1: tactor 0", "gain_db is 15"])
        self.write("far.toml", grid.format(-20).replace("20.0", "25.0"))  # another array, which has its own limits
        self.ok("play", *stroke, "--config", "far.toml", "--array", "high.toml")

    def test_a_ceiling_that_is_none_is_refused_whichever_file_says_it(self):
        bad = self.write("bad.toml", QUIET.format('"-40"'))
        good = self.write("good.toml", QUIET.format(-20))
        for one, other in ((bad, good), (good, bad)):
            self.refused(2, "serve", "--socket", "no.sock", "-D", "null", "--array", one.name, "--config", other.name)

    def test_the_start_and_check_show_the_ceiling_and_where_it_is_from(self):
        level = '[array]\npreset = "palm-3x3"\n[defaults]\nlevel-dbfs = -30\n'
        for text, says in ((QUIET.format(-40), "-40 dBFS (max_level_dbfs, a.toml:4:18)"), (level, "-30 dBFS (level-dbfs under [defaults], a.toml:4:14)"),
                           ('[array]\npreset = "palm-3x3"\n', "-12 dBFS (no file has max_level_dbfs under [serve])")):
            self.write("a.toml", text)
            p = self.start_tool("serve", "--socket", "s.sock", "-D", "null", "--array", "a.toml", stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
            self.addCleanup(end_process, p)
            lines = [p.stdout.readline() for _ in range(2)]
            p.terminate()
            p.wait(PATIENCE_S)
            self.assertEqual([line.partition(": ")[0] for line in lines], ["listening", "ceiling"])
            self.assertEqual(lines[1], f"ceiling: {says}\n")
            found = json.loads(self.ok("check", "--array", "a.toml", "--level-dbfs", "-50", "--format", "json").stdout)["findings"]
            self.assertIn(f"clients of tactor serve get at most {says}", [f["found"] for f in found if f["check"] == "service"])

    def test_a_service_on_a_preset_has_the_configuration_s_array(self):
        hello = self.serve("--array", "palm-3x3", config=MINE).client().ok("hello")
        self.assertEqual([t["channel"] for t in hello["array"]["tactors"]], [0, 1, 2, 5, 4, 3, 6, 7, 8])
        self.assertEqual(hello["stream"]["channels"], 12)


class Limits(ToolTest):
    def test_of_two_limits_the_lower_holds(self):
        """The greatest time without a rest, and the part of all time, are the least of both files' parts."""
        array_file = '[array]\npreset = "palm-3x3"\n[limits]\n{}'
        for one, other, says in (("max_drive_s = 2\n", "max_drive_s = 3\n", "at most 2 s in 10 s"),
                                 ("max_drive_s = 2\nwindow_s = 20\n", "max_drive_s = 4\nwindow_s = 8\n", "at most 2 s in 20 s"),
                                 ("max_drive_s = 2\n", "window_s = 5\n", "at most 2 s in 10 s"), ("power_dbfs = -3\n", "max_drive_s = 1\n", "at most 1 s in 10 s"),
                                 ("power_dbfs = -3\n", "power_dbfs = -6\n", "at most -6 dB"), ("power_dbfs = -3\n", "max_drive_s = 8\n", "at most -3 dB")):
            for a, b in ((one, other), (other, one)):
                self.write("a.toml", array_file.format(a))
                self.write("b.toml", f"[limits]\n{b}")
                self.assertIn(says, self.ok("check", "--array", "a.toml", "--config", "b.toml").stdout.replace("\n" + " " * 24, " "))
                self.write("c.toml", f'[array]\nfile = "a.toml"\n[limits]\n{b}')
                self.assertIn(says, self.ok("check", "--array", "c.toml").stdout.replace("\n" + " " * 24, " "))

    def test_one_max_dbfs_is_for_all_tactors_without_their_own(self):
        self.write("a.toml", '[array]\npreset = "palm-3x3"\nmax_dbfs = -40\n[[tactor]]\ntactor = 4\nmax_dbfs = -20\n')
        tap = ("--duration", "0.1", "--level-dbfs", "-30", "-o", "x.wav", "--array", "a.toml")
        self.ok("render", "--path", "M 20 20", *tap)
        self.refused(2, "render", "--path", "M 0 0", *tap, says=["tactor 0 would play at -30 dBFS, above its max_dbfs of -40 dBFS"])
        # A file that names another one never lifts its limits.
        self.write("b.toml", '[array]\nfile = "a.toml"\nmax_dbfs = -25\n')
        self.refused(2, "render", "--path", "M 0 0", *tap[:-1], "b.toml", says=["its max_dbfs of -40 dBFS"])
        self.refused(2, "render", "--path", "M 20 20", "--duration", "0.1", "--level-dbfs", "-22", "-o", "x.wav", "--array", "b.toml", says=["its max_dbfs of -25 dBFS"])
        self.write("c.toml", "[array]\nmax_dbfs = -25\n[[tactor]]\nx_mm = 0\ny_mm = 0\n[[tactor]]\nx_mm = 20\ny_mm = 0\nmax_dbfs = 0\n")
        self.ok("render", "--path", "M 20 0", *tap[:-1], "c.toml")
        self.refused(2, "render", "--path", "M 0 0", "--duration", "0.1", "--level-dbfs", "-24", "-o", "x.wav", "--array", "c.toml", says=["its max_dbfs of -25 dBFS"])
        self.write("d.toml", '[array]\npreset = "palm-3x3"\nmax_dbfs = 3\n')
        self.refused(2, "check", "--array", "d.toml")


class Presets(ToolTest):
    def setUp(self):
        super().setUp()
        self.mine = self.write("mine.toml", MINE)

    def channels(self, *args):
        r = self.ok("plan", "--path", "M 0 20 H 40", "--level-dbfs", "-40", "--format", "json", *args)
        return {(t["x_mm"], t["y_mm"]): t["channel"] for t in json.loads(r.stdout)["array"]["tactors"]}, r.stderr

    def test_a_preset_is_the_configuration_s_array_where_that_has_its_places(self):
        for more in ((), ("--array", "palm-3x3")):
            channels, says = self.channels("--config", "mine.toml", *more)
            self.assertEqual((channels[0, 20], channels[40, 20], says), (5, 3, ""))
            self.refused(2, "play", "--path", "M 0 20 H 40", "-D", "null", "--level-dbfs", "-18", "--config", "mine.toml", *more,
                         says=["tactor 3 would play at -18 dBFS, above its max_dbfs of -30 dBFS"])
            self.assertEqual(self.ok("check", "--config", "mine.toml", "--level-dbfs", "-40", *more).stdout.count("9 of 12 channels"), 1)
        # A turned array has the preset's places, with other numbers.
        self.write("turned.toml", '[array]\npreset = "palm-3x3"\nrotate_deg = 180\n')
        self.assertEqual(self.channels("--config", "turned.toml", "--array", "palm-3x3")[0][0, 0], 8)

    def test_a_preset_with_other_places_is_itself_and_says_so_once(self):
        self.write("eight.toml", '[array]\npreset = "palm-2x4"\n[[tactor]]\ntactor = 0\nmax_dbfs = -60\n[output]\nchannels = 16\n')
        channels, says = self.channels("--config", "eight.toml", "--array", "palm-3x3")
        self.assertEqual(list(channels.values()), list(range(9)))
        self.assertEqual(says, "tactor: warning: palm-3x3: the array of eight.toml has other places: its limits, gains and channels do not apply here\n")
        self.assertIn("9 of 9 channels", self.ok("check", "--config", "eight.toml", "--array", "palm-3x3").stdout)
        # The channels of [output] are the usual array's if no array is configured.
        self.write("output.toml", "[output]\nchannels = 16\n")
        for more, channels in (((), 16), (("--array", "palm-3x3"), 16), (("--array", "palm-2x4"), 8)):
            r = self.ok("check", "--config", "output.toml", *more)
            self.assertIn(f"{8 if channels == 8 else 9} of {channels} channels", r.stdout)
            self.assertEqual(r.stderr, "")

    def test_a_definition_that_names_a_preset_has_the_configuration_s_limits(self):
        text = self.ok("experiment", "park2016", "--print").stdout.replace("{ sl_db = 7 }", "{ dbfs = -18 }")
        named = self.write("named.toml", text.replace('name = "park2016"\n', 'name = "park2016"\narray = "palm-3x3"\n', 1))
        self.assertEqual(tomllib.loads(named.read_text())["experiment"]["array"], "palm-3x3")
        self.write("plain.toml", text)
        for definition in ("named.toml", "plain.toml"):
            self.ok("experiment", definition, "--dry-run")
            self.refused(2, "experiment", definition, "--dry-run", "--config", "mine.toml", says=["above its max_dbfs of -30 dBFS"])

    def test_shipped_definitions_leave_the_array_to_the_configuration(self):
        shipped = sorted((ROOT / "examples/experiments").glob("*.toml"))
        self.assertGreater(len(shipped), 5)
        for file in shipped:
            self.assertNotIn("array", tomllib.loads(file.read_text(encoding="utf-8"))["experiment"], file.name)
        self.assertNotIn("array", tomllib.loads(self.ok("experiment", "park2016", "--print").stdout)["experiment"])


if __name__ == "__main__":
    main()
