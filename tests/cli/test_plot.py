# SPDX-License-Identifier: MIT
"""tactor plot: contents and places of the pictures.
Places are computed here from the plan and from the scales that the picture's groups state."""
import math

from harness import ROOT, main
from pictures import BRUSH, NS, PlotTest, number


class ArrayView(PlotTest):
    def check_bursts(self, svg, plan, bursts):
        """Checks for dots where the plan has bursts, joined to the tactors that play them."""
        tactors = {t["tactor"]: t for t in plan["array"]["tactors"]}
        dots = svg.all("burst")
        self.assertEqual([d.get("id") for d in dots], [f"burst-{i}" for i, _ in bursts])
        groups = {int(g.get("data-burst")): g for g in svg.all("joins")}
        self.assertEqual(sorted(groups), [i for i, _ in bursts])
        for dot, (i, b) in zip(dots, bursts):
            x, y = svg.place(b["x_mm"], b["y_mm"])
            self.near(number(dot, "cx"), x)
            self.near(number(dot, "cy"), y)
            lines = groups[i].findall(NS + "line")
            self.assertEqual([int(l.get("data-tactor")) for l in lines], [d["tactor"] for d in b["drives"]])
            for line, drive in zip(lines, b["drives"]):
                to = tactors[drive["tactor"]]
                for got, want in zip([number(line, k) for k in ("x1", "y1", "x2", "y2")],
                                     [x, y, *svg.place(to["x_mm"], to["y_mm"])]):
                    self.near(got, want)
                self.near(float(line.get("data-amplitude")), drive["amplitude"], 1e-5)

    def test_each_burst_is_where_the_plan_puts_it_and_joined_to_its_tactors(self):
        for stroke in ("park2016-1", "park2016-2", "park2016-3", "park2016-4"):
            for options in ([], ["--phantom", "gaussian"], BRUSH):
                plan = self.plan(stroke, *options)
                svg = self.svg(stroke, *options, "--view", "array")
                self.check_bursts(svg, plan, list(enumerate(plan["bursts"])))

    def test_joining_lines_are_as_wide_as_amplitudes(self):
        svg = self.svg("park2016-3")
        lines = svg.all("join")
        self.assertEqual(len(lines), sum(len(b["drives"]) for b in self.plan("park2016-3")["bursts"]))
        ratios = [number(l, "stroke-width") / float(l.get("data-amplitude")) for l in lines]
        self.assertLess(max(ratios) / min(ratios), 1.01)

    def test_tactors_are_to_scale_with_numbers_and_channels(self):
        for name in ("palm-3x3", "palm-2x4", *(ROOT / "examples/arrays").glob("*.toml")):
            options = ["--path", "M 5 0 L 15 0", "--array", name, "--outside", "clamp"]
            plan, svg = self.plan(*options), self.svg(*options)
            self.assertEqual(len(svg.all("tactor")), len(plan["array"]["tactors"]))
            labels = {l.get("data-tactor"): l.text for l in svg.all("tactor-label")}
            same = all(t["channel"] == t["tactor"] for t in plan["array"]["tactors"])
            for t in plan["array"]["tactors"]:
                g = svg.id(f"tactor-{t['tactor']}")
                circle = g.find(NS + "circle")
                x, y = svg.place(t["x_mm"], t["y_mm"])
                self.near(number(circle, "cx"), x)
                self.near(number(circle, "cy"), y)
                inside = g.find(NS + "text")
                label = labels.get(str(t["tactor"]))
                if inside is not None:
                    self.assertEqual((inside.text, label), (str(t["tactor"]), None if same else f"ch {t['channel']}"))
                else:
                    self.assertEqual(label, f"{t['tactor']}" if same else f"{t['tactor']} (ch {t['channel']})")

    def test_the_scale_bar_is_as_long_as_its_label(self):
        for name, stroke in (("palm-3x3", "park2016-1"), ("arm-line-4", None), ("ring-8", None)):
            array = name if stroke else ROOT / f"examples/arrays/{name}.toml"
            svg = self.svg(*([stroke] if stroke else ["--path", "M 10 0 L 20 0", "--outside", "clamp"]), "--array", array)
            bar = svg.all("bar", "scale-bar")[0]
            mm = float(svg.id("scale-bar").get("data-mm"))
            scale = float(svg.id("array").get("data-mm-scale"))
            self.near(number(bar, "x2") - number(bar, "x1"), mm * scale)
            self.assertIn(f"{mm:g} mm", svg.texts())

    def test_start_end_and_direction_are_marked(self):
        svg = self.svg("park2016-4")
        x, y = svg.place(36, 20)
        start = svg.all("start")[0]
        self.near(number(start, "cx"), x)
        self.near(number(start, "cy"), y)
        end = svg.all("end")[0]
        x, y = svg.place(20, 36)
        self.near(number(end, "x") + number(end, "width") / 2, x)
        self.near(number(end, "y") + number(end, "height") / 2, y)
        self.assertTrue({"start", "end"} <= set(svg.texts()))
        arrows = svg.all("direction")
        self.assertGreaterEqual(len(arrows), 2)
        cx, cy = svg.place(20, 20)
        for a in arrows:  # the stroke runs against the clock: tips lie that way
            tip, left, right = [tuple(map(float, p.split(","))) for p in a.get("points").split()]
            back = ((left[0] + right[0]) / 2, (left[1] + right[1]) / 2)
            cross = (back[0] - cx) * (tip[1] - cy) - (back[1] - cy) * (tip[0] - cx)
            self.assertLess(cross, 0)

    def test_the_path_is_the_stroke_s(self):
        svg = self.svg("park2016-3")
        (line,) = svg.all("path")
        cx, cy = svg.place(20, 20)
        radius = 16 * float(svg.id("array").get("data-mm-scale"))
        points = [tuple(map(float, p.split(","))) for p in line.get("points").split()]
        self.assertGreater(len(points), 20)
        for x, y in points:
            self.near(((x - cx) ** 2 + (y - cy) ** 2) ** 0.5, radius, 0.06)

    def test_colours_run_from_dark_to_light_with_time(self):
        def grey(e):
            r, g, b = (int(e.get("fill")[i:i + 2], 16) for i in (1, 3, 5))
            return 0.2126 * r + 0.7152 * g + 0.0722 * b
        greys = [grey(d) for d in self.svg("park2016-3").all("burst")]
        self.assertEqual(greys, sorted(greys))
        self.assertGreater(greys[-1] - greys[0], 120)

    def test_several_strokes_share_one_time_and_one_array(self):
        plans = self.plan(ROOT / "examples/strokes/several.toml")["plans"]
        svg = self.svg(ROOT / "examples/strokes/several.toml")
        self.assertEqual(len(svg.all("path")), len(plans))
        bursts = [b | {"onset_s": p["start_s"] + b["onset_s"]} for p in plans for b in p["bursts"]]
        self.check_bursts(svg, plans[0], list(enumerate(bursts)))
        bars = svg.all("bar", "sound")
        self.assertEqual(len(bars), sum(len(b["drives"]) for b in bursts))
        for bar in bars:
            self.near(number(bar, "x"), svg.time(bursts[int(bar.get("data-burst"))]["onset_s"]))
        numbers = {n for e in svg.all("start-label") for n in e.text.split(", ")}
        self.assertEqual(numbers, {f"{i + 1}" for i in range(len(plans))})

    def test_of_many_bursts_every_nth_is_drawn_and_the_picture_says_so(self):
        options = ["park2016-1", "--duration", "60"]
        svg, plan = self.svg(*options), self.plan(*options)
        stride = int(svg.id("array").get("data-stride"))
        self.assertGreater(stride, 1)
        shown = [(i, b) for i, b in enumerate(plan["bursts"]) if i % stride == 0]
        self.check_bursts(svg, plan, shown)
        self.assertIn(f"one burst in {stride} is drawn on the array", svg.texts())


class TimingView(PlotTest):
    def check_bars(self, *options):
        plan, svg = self.plan(*options), self.svg(*options, "--view", "timing")
        g = svg.id("timing")
        top, row, full = (float(g.get(k)) for k in ("data-top", "data-row-height", "data-bar-height"))
        playing = sorted({d["tactor"] for b in plan["bursts"] for d in b["drives"]})
        channels = {t["tactor"]: t["channel"] for t in plan["array"]["tactors"]}
        same = all(t == c for t, c in channels.items())
        self.assertEqual([t.text for t in svg.all("row-label")], [f"{t}" if same else f"{t} ({channels[t]})" for t in playing])
        bars = {(int(b.get("data-burst")), int(b.get("data-tactor"))): b for b in svg.all("bar", "sound")}
        wanted = {(i, d["tactor"]): (b, d) for i, b in enumerate(plan["bursts"]) for d in b["drives"]}
        self.assertEqual(sorted(bars), sorted(wanted))
        for key, bar in bars.items():
            b, d = wanted[key]
            self.near(number(bar, "x"), svg.time(b["onset_s"]))
            self.near(number(bar, "x") + number(bar, "width"), svg.time(b["onset_s"] + b["duration_s"]))
            self.near(number(bar, "height"), full * d["amplitude"])
            self.near(number(bar, "y") + number(bar, "height"), top + row * (playing.index(d["tactor"]) + 1))
        return plan, svg

    def test_each_tactor_of_each_burst_has_a_bar(self):
        for stroke in ("park2016-1", "park2016-2", "park2016-3", "park2016-4"):
            self.check_bars(stroke)
        self.check_bars("park2016-3", "--duration", "0.3", "--array", ROOT / "examples/arrays/palm-measured.toml")
        self.check_bars("--path", "M 0 0 L 100 0", "--array", ROOT / "examples/arrays/arm-line-4.toml")

    def test_conflicts_are_hatched(self):
        plan, svg = self.check_bars("park2016-1", *BRUSH)
        self.assertGreater(len(plan["conflicts"]), 0)
        hatches = svg.all("conflict")
        self.assertEqual(len(hatches), len(plan["conflicts"]))
        for h, c in zip(hatches, plan["conflicts"]):
            rim = [e for e in h if e.get("class") == "rim"][0]
            self.near(number(rim, "x"), svg.time(c["from_s"]))
            self.near(number(rim, "x") + number(rim, "width"), svg.time(c["to_s"]))
            for line in h.findall(NS + "line"):
                for x, y in (("x1", "y1"), ("x2", "y2")):
                    self.assertTrue(number(rim, "x") - 0.01 <= number(line, x) <= number(rim, "x") + number(rim, "width") + 0.01)
                    self.assertTrue(number(rim, "y") - 0.01 <= number(line, y) <= number(rim, "y") + number(rim, "height") + 0.01)
        self.assertIn("two bursts on one tactor", svg.texts())
        opacities = {b.get("fill-opacity") for b in svg.all("bar", "sound")}
        self.assertEqual(opacities, {"0.7"})
        self.assertNotIn("two bursts on one tactor", self.svg("park2016-1").texts())

    def test_ticks_are_at_their_times_and_the_axis_has_its_unit(self):
        svg = self.svg("park2016-3")
        axis = svg.all("axis")[0]
        labels = [e for e in axis if e.get("class") == "tick-label"]
        self.assertGreaterEqual(len(labels), 4)
        for l in labels:
            self.near(number(l, "x"), svg.time(float(l.text)))
        self.assertIn("time (s)", svg.texts())

    def test_soa_and_duration_are_marked_on_the_first_bursts(self):
        plan, svg = self.plan("park2016-3"), self.svg("park2016-3")
        ends = [number(l, "x1") for l in svg.id("soa").findall(NS + "line") if l.get("stroke-dasharray")]
        self.near(ends[0], svg.time(0))
        self.near(ends[1], svg.time(plan["soa_s"]))
        self.assertIn("SOA 0.07 s", svg.texts())
        self.assertIn("duration 0.07 s", svg.texts())
        brush = self.plan("park2016-1", *BRUSH)["bursts"]
        svg = self.svg("park2016-1", *BRUSH)
        self.assertIn(f"first SOA {brush[1]['onset_s'] - brush[0]['onset_s']:.4g} s", svg.texts())
        self.assertIn(f"first duration {brush[0]['duration_s']:.4g} s", svg.texts())

    def test_an_all_silent_plan_is_drawn_too(self):
        self.write("s.toml", '[stroke]\npath = "M 0 20 H 40"\nintensity = 0\n')
        for view in ("both", "timing", "array", "wave"):
            svg = self.svg("s.toml", "--view", view)
            self.assertEqual(svg.all("bar", "sound") if view in ("both", "timing") else [], [])

    def test_continuous_is_drawn_as_curves(self):
        options = ["park2016-3", "--algorithm", "continuous", "--phantom", "barycentric"]
        svg, plan = self.svg(*options), self.plan(*options)
        g = svg.id("timing")
        self.assertEqual(svg.all("bar", "sound"), [])
        top, row, full = (float(g.get(k)) for k in ("data-top", "data-row-height", "data-bar-height"))
        points = plan["continuous"]["points"]
        playing = sorted({d["tactor"] for p in points for d in p["drives"]})
        for curve in svg.all("envelope"):
            r = int(curve.get("data-row"))
            base = top + row * (r + 1)
            shape = [tuple(map(float, p.split(","))) for p in curve.get("points").split()]
            for x, y in shape[2:-2]:
                t = (x - svg.time(0)) / float(g.get("data-x-scale"))
                at = min(max(round(t / 0.001), 0), len(points) - 1)
                near = [d["amplitude"] for p in points[max(at - 5, 0):at + 6] for d in p["drives"]
                        if d["tactor"] == playing[r]]
                if near:
                    self.assertGreater((base - y) / full, min(near) - 0.02)
                    self.assertLess((base - y) / full, max(near) + 0.02)
        self.assertGreater(len(svg.all("burst")), 10)

    def test_bars_that_are_too_dense_are_drawn_as_their_largest_amplitude(self):
        svg = self.svg("park2016-1", "--duration", "120")
        self.assertEqual(svg.id("timing").get("data-drawn"), "columns")
        self.assertEqual(svg.all("bar", "sound"), [])
        self.assertGreater(len(svg.all("envelope")), 4)


class WaveView(PlotTest):
    def test_envelopes_are_as_high_as_the_samples(self):
        svg = self.svg("park2016-3", "--view", "wave", "--level-dbfs", "-6")
        self.assertEqual(svg.id("wave").get("data-drawn"), "envelope")
        plan = self.plan("park2016-3")
        loudest = {}
        for b in plan["bursts"]:
            for d in b["drives"]:
                loudest[d["tactor"]] = max(loudest.get(d["tactor"], 0.0), d["amplitude"])
        want = [f"{-6 + 20 * math.log10(loudest[t]):.1f}" for t in sorted(loudest)]
        self.assertEqual([e.text for e in svg.all("peak")], want)
        heights = []
        for g in svg.all("channel"):
            ys = [float(p.split(",")[1]) for e in g if e.get("class") == "envelope" for p in e.get("points").split()]
            heights.append(max(ys) - min(ys))
        for h, t in zip(heights, sorted(loudest)):
            self.near(h / max(heights), loudest[t] / max(loudest.values()), 0.01)

    def test_a_short_stroke_shows_its_carrier(self):
        svg = self.svg("park2016-3", "--duration", "0.14", "--view", "wave")
        self.assertEqual(svg.id("wave").get("data-drawn"), "carrier")
        curve = svg.all("curve")[0]
        ys = [float(p.split(",")[1]) for p in curve.get("points").split()]
        turns = sum(1 for a, b, c in zip(ys, ys[1:], ys[2:]) if (b - a) * (c - b) < 0)
        self.assertGreater(turns, 20)


if __name__ == "__main__":
    main()
