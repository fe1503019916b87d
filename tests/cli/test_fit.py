# SPDX-License-Identifier: MIT
"""--fit: any stroke on any array, by every command that takes one."""
import math

from harness import ROOT, ToolTest, main

LOW = ("--array", "palm-2x4")
TWO = ('[[stroke]]\npoints = [[0, 0], [0, 100]]\nduration_s = 1.4\n'
       '[[stroke]]\npoints = [[300, 0], [300, 100]]\nduration_s = 1.4\n')
SVG = ('<svg xmlns="http://www.w3.org/2000/svg"><circle cx="500" cy="500" r="400" data-duration-s="2.8"/></svg>')
CSV = "t_s,x_mm,y_mm\n0,0,0\n0.7,1920,0\n1.4,1920,1080\n"


def places(plan):
    return [(b["x_mm"], b["y_mm"]) for b in plan["bursts"]]


class Fit(ToolTest):
    def inside(self, plan, width=60, height=20):
        for x, y in places(plan):
            self.assertTrue(-1e-6 <= x <= width + 1e-6 and -1e-6 <= y <= height + 1e-6, (x, y))

    def test_a_stroke_that_does_not_fit_does_with_it(self):
        said = self.refused(2, "plan", "park2016-3", *LOW).stderr
        self.assertIn("--fit", said)
        p = self.plan("park2016-3", *LOW, "--fit")
        self.inside(p)
        self.assertEqual(len(p["bursts"]), 31)  # with its original time
        for x, y in places(p):
            self.assertAlmostEqual(math.dist((x, y), (30, 10)), 10, 6)

    def test_every_kind_of_stroke_can_be_fitted(self):
        self.write("two.toml", TWO)
        self.write("a.svg", SVG)
        self.write("a.csv", CSV)
        for args in (["--path", "M 0 0 C 500 0 500 900 0 900"], ["park2016-1"], ["two.toml"], ["a.svg"], ["a.csv"], ["wave-2x4"]):
            with self.subTest(args=args):
                p = self.plan(*args, *LOW, "--fit")
                for one in p.get("plans", [p]):
                    self.inside(one)
        p = self.plan("-", *LOW, "--fit", stdin=TWO)["plans"]
        for q, corner in zip(p, ((0, 0), (60, 0)), strict=True):  # one picture
            self.assertLess(math.dist(places(q)[0], corner), 1e-9)

    def test_every_command_fits(self):
        for args in (("plan",), ("render", "-o", "a.wav"), ("plot", "-o", "a.svg"), ("compare", "-o", "b.svg"),
                     ("play", "-D", "null", "--duration", "0.2")):
            with self.subTest(command=args[0]):
                self.refused(2, args[0], "park2016-3", *LOW, *args[1:])
                self.ok(args[0], "park2016-3", *LOW, "--fit", *args[1:])

    def test_every_preset_fits_every_example_array(self):
        presets = ["park2016-1", "park2016-2", "park2016-3", "park2016-4", "wave-2x4", "round-2x4"]
        arrays = ["palm-3x3", "palm-2x4", *sorted((ROOT / "examples/arrays").glob("*.toml"))]
        self.assertGreaterEqual(len(arrays), 6)
        for array in arrays:
            for preset in presets:
                self.plan(preset, "--array", array, "--fit", "--outside", "error")

    def test_times_and_speeds_count_after_the_fit(self):
        for args, expected in ((("--path", "M 0 0 H 600"), 1.0), (("--path", "M 0 0 H 600", "--speed", "30"), 2.0),
                               (("--path", "M 0 0 H 600", "--duration", "4"), 4.0), (("park2016-1",), 1.4),
                               (("park2016-1", "--speed", "10"), math.pi)):
            with self.subTest(args=args):
                self.assertAlmostEqual(self.plan(*args, *LOW, "--fit")["stroke"]["duration_s"], expected, 6)

    def test_json_and_text_report_the_fit(self):
        self.assertNotIn("fit", self.plan("wave-2x4", *LOW)["stroke"])
        fit = self.plan("--path", "M 100 100 H 200 V 110", *LOW, "--fit", "--fit-margin", "5")["stroke"]["fit"]
        self.assertEqual(fit["margin_mm"], 5)
        a, b, c, d, e, f = fit["matrix"]
        self.assertAlmostEqual(a, 0.5, 9)
        self.assertAlmostEqual(d, 0.5, 9)
        self.assertAlmostEqual(b, 0, 9)
        self.assertAlmostEqual(c, 0, 9)
        self.assertAlmostEqual(a * 100 + e, 5, 6)
        self.assertAlmostEqual(d * 105 + f, 10, 6)
        text = self.ok("plan", "--path", "M 100 100 H 200 V 110", *LOW, "--fit").stdout
        self.assertIn("fitted: (150, 105) mm as drawn is (30, 10) mm here, lengths times 0.6\n", text)
        line = ("--array", ROOT / "examples/arrays/arm-line-4.toml", "--fit")
        self.assertIn("onto the line of the array", self.ok("plan", "park2016-1", *line).stdout)
        self.assertEqual(self.plan("park2016-1", *line)["stroke"]["fit"]["matrix"][3], 0)

    def test_impossible_margins_are_refused(self):
        self.refused(2, "plan", "wave-2x4", *LOW, "--fit", "--fit-margin", "10")
        self.refused(2, "plan", "wave-2x4", *LOW, "--fit", "--fit-margin", "-1")
        self.refused(2, "plan", "wave-2x4", *LOW, "--fit", "--fit-margin", "nan")
        self.refused(2, "plan", "wave-2x4", *LOW, "--fit-margin", "1")
        self.refused(2, "plan", "--path", "M 0 0 V 5", "--array", ROOT / "examples/arrays/arm-line-4.toml", "--fit")
        self.refused(2, "plan", ROOT / "examples/strokes/several.toml", "--array", ROOT / "examples/arrays/arm-line-4.toml", "--fit")


if __name__ == "__main__":
    main()
