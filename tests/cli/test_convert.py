# SPDX-License-Identifier: MIT
"""Strokes as files of other formats: the same plan there and back, and a warning for each thing that is lost."""
import base64
import json
import os
import re

from harness import ROOT, main
from serving import ServeTest

LINES = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 40 40"><path id="a" d="M0 0 L40 0 L40 20" data-speed-mm-s="50"/>' \
        '<path id="b &amp; c" d="M0 40 L40 40" data-duration-s="0.9" data-start-s="1.5" data-carrier-hz="200" data-intensity="0.5" data-easing="in-out"/></svg>'
TRACE = "t_s,x_mm,y_mm,intensity\n0,3,4,0.25\n0.4,20.125,17,1\n0.75,nan,nan,0\n0.8,36,31.7,0.6\n1.1,8,39,1\n"
# Two strokes with all that a file can say of them, and what follows them.
RICH = """[[stroke]]
name = "first \\"one\\""
path = "M 0 10 C 20 -5 20 45 40 30"
speed_mm_s = [[0, 40], [1, 90]]
intensity = [[0, 0.5], [1, 1]]
pauses = [[0.5, 0.2, 0.75]]
carrier_profile = [[0, 150], [1, 260]]
algorithm = "continuous"
phantom = "linear"
[[stroke]]
name = "second"
timed = [[0, 40, 0], [0.25, 20, 20, 0.5], [1, 0, 40]]
start_from = "start"
start_s = 0.25
soa_s = 0.06
waveform = "noise:100-300"
noise_seed = 7
am_hz = 20
am_depth = 0.5
level_db = -3
[[stroke]]
repeat = 2
pause_s = 0.1
[[stroke.stroke]]
points = [[0, 0], [20, 0], [20, 20]]
duration_s = 0.4
[[stroke.stroke]]
arc = { centre = [20, 20], radius_mm = 10, from_deg = 0, sweep_deg = 270 }
start_from = "piece"
start_s = 0.1
"""


class Convert(ServeTest):
    def setUp(self):
        super().setUp()
        for name, text in (("lines.svg", LINES), ("trace.csv", TRACE), ("rich.toml", RICH)):
            self.write(name, text)

    def convert(self, source, to, *more):
        """Converts; returns the warnings without their beginning."""
        result = self.ok("convert", source, to, *more)
        self.assertRegex(result.stdout, f"^{to}: ")
        lines = [line for line in result.stderr.splitlines() if line]
        for line in lines:
            self.assertTrue(line.startswith("tactor: warning: "), line)
        return [line.removeprefix("tactor: warning: ").removeprefix(f"{to}: ") for line in lines]

    def plans(self, stroke, *more):
        """Returns the plans of a stroke without names: what sounds, when and how."""
        all_of_it = self.plan(stroke, *more)
        plans = all_of_it.get("plans", [all_of_it])
        for p in plans:
            del p["stroke"]["name"]
            for key in ("note", "fit"):
                p["stroke"].pop(key, None)
            del p["warnings"]  # of the file that was read
        return plans

    def assert_alike(self, one, other):
        """Compares plans: all texts and counts are equal, and numbers differ by no more than their rounding in a file."""
        if isinstance(one, float) or isinstance(other, float):
            self.assertAlmostEqual(one, other, delta=1e-9 * max(1.0, abs(one)))
        elif isinstance(one, (dict, list)):
            self.assertEqual((type(one), len(one)), (type(other), len(other)))
            for key in one if isinstance(one, dict) else range(len(one)):
                self.assert_alike(one[key], other[key])
        else:
            self.assertEqual(one, other)

    def test_a_stroke_file_holds_all_that_a_stroke_file_says(self):
        for n, source in enumerate(("rich.toml", "trace.csv", "lines.svg", "park2016-3", "wave-2x4", *(ROOT / f"examples/strokes/{name}.toml" for name in ("reach", "knocks", "several")))):
            array = ("--array", "palm-2x4") if source == "wave-2x4" else ()
            told = self.convert(source, f"{n}.toml", *array)
            self.assertEqual([t for t in told if "cannot hold" in t and "reconstructed" not in t], [], source)
            self.assert_alike(self.plans(f"{n}.toml", *array), self.plans(source, *array))

    def test_there_and_back_gives_the_same_plan(self):
        for source, way in (("trace.csv", ("toml", "csv")), ("trace.csv", ("csv",)), ("lines.svg", ("toml", "svg")), ("lines.svg", ("svg", "toml")),
                            ("rich.toml", ("json", "json"))):
            at = source
            for n, extension in enumerate(way):
                to = f"{source}-{n}.{extension}"
                for told in self.convert(at, to):
                    self.assertRegex(told, "^CSV cannot hold the name$|^a plan cannot hold the path between its bursts$|no place .nan.")
                at = to
            self.assert_alike(self.plans(at), self.plans(source))

    def test_the_strokes_of_a_plan_give_the_same_plan(self):
        for n, args in enumerate((("park2016-3",), ("park2016-1", "--soa", "0.06"), ("park2016-1", "--algorithm", "continuous", "--phantom", "log"),
                                  ("trace.csv", "--carrier", "180"))):
            self.convert(args[0], f"{n}.json", *args[1:])
            told = self.convert(f"{n}.json", f"{n}.toml")
            self.assertIn("a stroke file cannot hold the plan's array, level and ramps", told)
            [was], [now] = self.plans(f"{n}.json"), self.plans(f"{n}.toml")
            self.assertEqual(was["algorithm"], now["algorithm"])
            if was["algorithm"] == "park2016":
                self.assert_alike([[b["onset_s"], b["drives"]] for b in now["bursts"]], [[b["onset_s"], b["drives"]] for b in was["bursts"]])
            else:
                there = [(a["x_mm"] - b["x_mm"], a["y_mm"] - b["y_mm"]) for a, b in zip(was["continuous"]["points"], now["continuous"]["points"])]
                self.assertLess(max(abs(d) for pair in there for d in pair), 0.01)

    def test_each_thing_that_is_lost_is_told_once(self):
        line = "[stroke]\npath = 'M 0 10 L 40 10'\n"
        for keys, to, told in (("name = 'a'", "x.csv", ["CSV cannot hold the name"]),
                               ("start_s = 0.5", "x.csv", ["CSV cannot hold the start"]), ("start_s = 0.5", "x.svg", []),
                               ("carrier_hz = 200", "x.csv", ["CSV cannot hold the carrier"]), ("carrier_hz = 200", "x.svg", []),
                               ("carrier_hz = 23000", "x.toml", []), ("carrier_hz = 23000", "x.svg", ["SVG cannot hold the carrier"]),
                               ("carrier_profile = [[0, 100], [1, 300]]", "x.svg", ["SVG cannot hold the carrier profile"]),
                               ("waveform = 'square'", "x.svg", ["SVG cannot hold the waveform"]),
                               ("am_hz = 30", "x.svg", ["SVG cannot hold the amplitude modulation"]),
                               ("algorithm = 'continuous'\nphantom = 'log'", "x.svg", ["SVG cannot hold the algorithm", "SVG cannot hold the phantom model"]),
                               ("faces = 'nearest'", "x.csv", ["CSV cannot hold the faces"]),
                               ("soa_s = 0.06\nburst_s = 0.02", "x.csv", ["CSV cannot hold the SOA", "CSV cannot hold the duration of bursts"]),
                               ("level_db = -6", "x.svg", ["SVG cannot hold the level relative to other strokes"]),
                               ("duration_s = 2", "x.svg", []), ("easing = 'minimum-jerk'", "x.svg", []), ("intensity = 0.4", "x.svg", []),
                               ("intensity = [[0, 0.2], [1, 1]]", "x.svg", ["SVG cannot hold the changes of intensity (up to 0.8 away)"]),
                               ("pauses = [[0.5, 1]]", "x.svg", ["SVG cannot hold the exact movement (up to 12 mm away)"])):
            self.write("in.toml", line + ("" if "name" in keys else "name = 'x'\n" if to == "x.csv" else "") + keys + "\n")
            (self.dir / to).unlink(missing_ok=True)
            self.assertEqual(self.convert("in.toml", to), told, keys)
        told = self.convert("rich.toml", "x.svg")
        self.assertIn("SVG cannot hold the waveform of stroke 2", told)
        self.assertIn("SVG cannot hold the algorithm of stroke 1", told)
        self.assertEqual(len(told), len(set(told)))
        self.assertEqual(self.convert("park2016-1", "park2016-1.csv")[0], "CSV cannot hold the note that it is reconstructed")
        self.assertEqual(self.convert("in.toml", "x.wav"), ["samples cannot hold the paths of strokes"])

    def test_starts_that_a_format_cannot_hold_become_times(self):
        self.convert("rich.toml", "x.svg")
        was, now = ([round(p["start_s"], 9) for p in self.plan(name)["plans"]] for name in ("rich.toml", "x.svg"))
        self.assertEqual(len(now), 6)
        del was[2], now[2]  # still follows the second stroke, whose method SVG cannot hold
        self.assertEqual(now, was)

    def test_options_become_keys_or_are_named(self):
        options = ("--algorithm", "tactile-brush", "--phantom", "barycentric", "--carrier", "190", "--waveform", "triangle", "--am", "25:0.5", "--duration", "1.3")
        self.write("line.toml", "[stroke]\npath = 'M 0 0 L 40 20'\n")
        self.assertEqual(self.convert("line.toml", "x.toml", *options), [])
        self.assert_alike(self.plans("x.toml"), self.plans("line.toml", *options))
        told = self.convert("line.toml", "y.toml", "--level-dbfs", "-20", "--snap", "--speed", "70", "--fit")
        self.assertEqual(told, ["a stroke file cannot hold --snap", "a stroke file cannot hold --level-dbfs"])
        self.assert_alike(self.plans("y.toml"), self.plans("line.toml", "--speed", "70", "--fit"))
        config = self.defaults(algorithm="continuous", speed=55)
        self.convert("line.toml", "z.toml", *config)
        self.assert_alike(self.plans("z.toml"), self.plans("line.toml", *config))

    def test_samples_and_plans_are_those_of_render_and_plan(self):
        self.convert("rich.toml", "a.wav", "--level-dbfs", "-20", "--sample-format", "s16")
        self.ok("render", "rich.toml", "-o", "b.wav", "--level-dbfs", "-20", "--sample-format", "s16")
        self.assertEqual((self.dir / "a.wav").read_bytes(), (self.dir / "b.wav").read_bytes())
        self.convert("rich.toml", "a.json")
        self.assertEqual((self.dir / "a.json").read_text(), self.ok("plan", "rich.toml", "--format", "json").stdout)
        self.assertEqual((self.dir / "a.json").read_text(), self.plan_again("a.json"))
        self.ok("convert", "-", "c.csv", stdin=TRACE)
        self.assert_alike(self.plans("c.csv"), self.plans("trace.csv"))

    def plan_again(self, file):
        self.convert(file, "again.json")
        return (self.dir / "again.json").read_text()

    def test_the_service_exports_the_same_files(self):
        c = self.serve().client()
        for source, kind, text in (("rich.toml", "toml", RICH), ("trace.csv", "csv", TRACE), ("lines.svg", "toml", LINES)):
            self.convert(source, f"x.{kind}", "--force")
            written = re.sub(r"\n# sha256 .*\n$", "", (self.dir / f"x.{kind}").read_text())
            params = {source.rpartition(".")[2]: text, "as": kind}
            exported = base64.b64decode(c.ok("export", **params)["base64"]).decode()
            # The service knows no name of a file, by which convert calls strokes without a name.
            self.assertEqual(re.sub(r'name = "(?:rich|toml)-', 'name = "', written), re.sub(r'name = "(?:rich|toml)-', 'name = "', exported))

    def test_what_cannot_be_converted_is_refused_and_leaves_nothing(self):
        self.write("theirs.toml", "# mine\n")
        self.write("tone.wav", b"RIFF")
        before = sorted(os.listdir(self.dir))
        for args in (("rich.toml", "x.csv"), ("rich.toml", "x.txt"), ("rich.toml", "x"), ("rich.toml", "-"), ("rich.toml", ""), ("tone.wav", "x.toml"),
                     ("rich.toml", "rich.toml"), ("trace.csv", "rich.toml"), ("rich.toml", "theirs.toml"), ("rich.toml", "no/x.toml"), ("none.toml", "x.toml"),
                     ("rich.toml",), (), ("rich.toml", "x.toml", "y.toml"), ("rich.toml", "x.toml", "--path", "M 0 0"), ("rich.toml", "rich.toml", "--force"),
                     ("rich.toml", "x.csv", "--array", "palm-2x4", "--config", "none.toml")):
            self.refused(2, "convert", *args)
        self.write("out.toml", "[[stroke]]\npath = 'M 0 0 L 90 0'\n")
        self.refused(2, "convert", "out.toml", "x.json")
        self.refused(2, "convert", "out.toml", "x.wav")
        (self.dir / "out.toml").unlink()
        self.assertEqual(sorted(os.listdir(self.dir)), before)
        self.assertEqual((self.dir / "theirs.toml").read_text(), "# mine\n")

    def test_a_file_is_replaced_only_as_tactor_wrote_it(self):
        for to in ("a.toml", "a.svg", "a.csv", "a.json", "a.wav"):
            source, other = "trace.csv", "park2016-2"
            self.convert(source, to)
            self.convert(source, to)
            if to == "a.json":  # its bytes are its identity
                self.refused(2, "convert", other, to)
            else:
                self.convert(other, to)
            kept = (self.dir / to).read_bytes() + b"\n"
            self.write(to, kept)
            self.refused(2, "convert", source, to)
            self.assertEqual((self.dir / to).read_bytes(), kept)
            self.convert(source, to, "--force")
            self.assertNotEqual((self.dir / to).read_bytes(), kept)


if __name__ == "__main__":
    main()
