# SPDX-License-Identifier: MIT
"""tactor plot: what is in the pictures, where, and what is refused.

Places are computed here from the plan and from the scales that the picture's own groups state.
"""
import os
import re
import struct
import unittest
import xml.etree.ElementTree as ET
import zlib

from harness import ROOT, ToolTest, main

NS = "{http://www.w3.org/2000/svg}"
PT = 72.0 / 25.4
BRUSH = ["--algorithm", "tactile-brush", "--snap", "--drop-points"]


class Svg:
    """A picture of ours."""

    def __init__(self, path):
        self.text = path.read_text(encoding="utf-8")
        self.root = ET.fromstring(self.text)

    def all(self, kind, inside=None):
        where = self.root if inside is None else self.id(inside)
        return [e for e in where.iter() if e.get("class") == kind]

    def id(self, name):
        found = [e for e in self.root.iter() if e.get("id") == name]
        assert len(found) == 1, f"{len(found)} elements have the id {name}"
        return found[0]

    def texts(self):
        return ["".join(e.itertext()) for e in self.root.iter(NS + "text")]

    def place(self, x_mm, y_mm):
        """Where a place on the skin is on the page, in pt."""
        g = self.id("array")
        s = float(g.get("data-mm-scale"))
        return float(g.get("data-x0")) + s * x_mm, float(g.get("data-y0")) + s * y_mm

    def time(self, t_s, group="timing"):
        g = self.id(group)
        return float(g.get("data-x0")) + float(g.get("data-x-scale")) * t_s


def number(e, name):
    return float(e.get(name))


class Png:
    """A PNG with 8-bit RGB, decoded."""

    def __init__(self, path):
        data = path.read_bytes()
        assert data[:8] == b"\x89PNG\r\n\x1a\n"
        self.chunks, at = {}, 8
        while at < len(data):
            size, name = struct.unpack(">I4s", data[at:at + 8])
            body = data[at + 8:at + 8 + size]
            assert zlib.crc32(name + body) == struct.unpack(">I", data[at + 8 + size:at + 12 + size])[0], name
            self.chunks[name] = self.chunks.get(name, b"") + body
            at += 12 + size
        self.width, self.height, depth, colour = struct.unpack(">IIBB", self.chunks[b"IHDR"][:10])
        assert (depth, colour) == (8, 2), (depth, colour)
        self.rows = self.unfilter(zlib.decompress(self.chunks[b"IDAT"]))

    def unfilter(self, raw):
        n, rows, before = 3 * self.width, [], bytes(3 * self.width)
        for y in range(self.height):
            kind, row = raw[y * (n + 1)], bytearray(raw[y * (n + 1) + 1:(y + 1) * (n + 1)])
            for i in range(n):
                a, b, c = (row[i - 3], before[i], before[i - 3]) if i >= 3 else (0, before[i], 0)
                if kind == 1:
                    row[i] = (row[i] + a) & 255
                elif kind == 2:
                    row[i] = (row[i] + b) & 255
                elif kind == 3:
                    row[i] = (row[i] + (a + b) // 2) & 255
                elif kind == 4:
                    p = a + b - c
                    row[i] = (row[i] + min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]) & 255
            rows.append(bytes(row))
            before = row
        return rows

    def pixel(self, x, y):
        return tuple(self.rows[y][3 * x:3 * x + 3])

    def grey(self):
        return [(r[i] * 2 + r[i + 1] * 7 + r[i + 2]) / 10 for r in self.rows for i in range(0, len(r), 3)]


class PlotTest(ToolTest):
    def svg(self, *args, **more):
        self.ok("plot", *args, "-o", "a.svg", **more)
        return Svg(self.dir / "a.svg")

    def near(self, a, b, tolerance=0.002):
        self.assertLessEqual(abs(a - b), tolerance, f"{a} is not {b}")


class ArrayView(PlotTest):
    def check_bursts(self, svg, plan, bursts):
        """Dots where the plan has bursts, joined to the tactors that play them."""
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

    def test_each_burst_is_where_the_plan_says_and_joined_to_its_tactors(self):
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
            for t in plan["array"]["tactors"]:
                g = svg.id(f"tactor-{t['tactor']}")
                circle = g.find(NS + "circle")
                x, y = svg.place(t["x_mm"], t["y_mm"])
                self.near(number(circle, "cx"), x)
                self.near(number(circle, "cy"), y)
                inside = g.find(NS + "text")
                label = labels[str(t["tactor"])]
                if inside is not None:
                    self.assertEqual((inside.text, label), (str(t["tactor"]), f"ch {t['channel']}"))
                else:
                    self.assertEqual(label, f"{t['tactor']} (ch {t['channel']})")

    def test_the_scale_bar_is_as_long_as_it_says(self):
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

    def test_the_path_is_where_the_stroke_runs(self):
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
        self.assertTrue({f"start {i + 1}" for i in range(len(plans))} <= set(svg.texts()))

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
        self.assertEqual([t.text for t in svg.all("row-label")], [f"{t} ({channels[t]})" for t in playing])
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

    def test_a_bar_for_each_tactor_of_each_burst(self):
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

    def test_what_is_too_dense_for_bars_is_drawn_as_its_largest_amplitude(self):
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
        from math import log10
        want = [f"{-6 + 20 * log10(loudest[t]):.1f}" for t in sorted(loudest)]
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


class Formats(PlotTest):
    def test_a_png_is_as_large_as_asked_and_not_blank(self):
        for width, dpi in ((85, 150), (120, 100)):
            self.ok("plot", "park2016-3", "-o", "a.png", "--width", width, "--dpi", dpi)
            png = Png(self.dir / "a.png")
            self.assertEqual(png.width, round(width / 25.4 * dpi))
            self.assertEqual(struct.unpack(">IIB", png.chunks[b"pHYs"])[0], round(dpi / 0.0254))
            grey = png.grey()
            mean = sum(grey) / len(grey)
            self.assertGreater(sum((g - mean) ** 2 for g in grey) / len(grey), 300)
            self.assertGreater(mean, 200)  # mostly white
            edge = [png.pixel(x, y) for x in range(png.width) for y in (0, 1, png.height - 2, png.height - 1)]
            edge += [png.pixel(x, y) for y in range(png.height) for x in (0, 1, png.width - 2, png.width - 1)]
            self.assertEqual(set(edge), {(255, 255, 255)}, "something is cut off at the edge")

    def test_the_png_shows_what_the_svg_says(self):
        svg = self.svg("park2016-3", "--view", "array")
        self.ok("plot", "park2016-3", "--view", "array", "-o", "a.png", "--dpi", "300")
        png = Png(self.dir / "a.png")
        for dot in svg.all("burst"):
            want = tuple(int(dot.get("fill")[i:i + 2], 16) for i in (1, 3, 5))
            got = png.pixel(int(number(dot, "cx") * 300 / 72), int(number(dot, "cy") * 300 / 72))
            self.assertLess(max(abs(a - b) for a, b in zip(got, want)), 4, dot.get("id"))

    def test_a_pdf_is_a_pdf(self):
        self.ok("plot", "park2016-1", "-o", "a.pdf")
        data = (self.dir / "a.pdf").read_bytes()
        self.assertTrue(data.startswith(b"%PDF-1."))
        self.assertIn(b"%%EOF", data[-16:])
        self.assertNotIn(b"CreationDate", data)

    def test_the_same_picture_is_the_same_file_in_every_locale(self):
        for ext in ("svg", "png", "pdf"):
            self.ok("plot", "park2016-2", "-o", f"a.{ext}")
            self.ok("plot", "park2016-2", "-o", f"b.{ext}", env={"LC_ALL": "de_DE.UTF-8", "TZ": "Asia/Tokyo"})
            self.assertEqual((self.dir / f"a.{ext}").read_bytes(), (self.dir / f"b.{ext}").read_bytes())

    def test_svg_is_of_the_size_asked_with_title_and_description(self):
        svg = self.svg("park2016-1", "--width", "120")
        self.assertEqual(svg.root.get("width"), "120mm")
        self.assertEqual(svg.root.find(NS + "title").text, "park2016-1 on palm-3x3")
        self.assertIn("21 bursts", svg.root.find(NS + "desc").text)
        self.assertEqual(svg.root.get("role"), "img")
        ids = [e.get("id") for e in svg.root.iter() if e.get("id")]
        self.assertEqual(len(ids), len(set(ids)))
        sizes = [number(t, "font-size") for t in svg.root.iter(NS + "text")]
        self.assertGreaterEqual(min(sizes), 6.0)

    def test_no_text_leaves_the_page_and_no_labels_overlap(self):
        # About those of DejaVu Sans, in em.
        width = {c: w for letters, w in (("0123456789", 0.64), (" ().,:'il|", 0.34), ("fjrt-", 0.38), ("mMW", 0.95))
                 for c in letters}
        jobs = [["park2016-%d" % i] for i in (1, 2, 3, 4)] + [
            ["park2016-1", *BRUSH], ["park2016-3", "--algorithm", "continuous"], ["park2016-3", "--duration", "0.1"],
            [ROOT / "examples/strokes/several.toml"], ["--path", "M 0 0 L 60 20", "--array", "palm-2x4"],
            ["--path", "M 0 0 L 100 0", "--array", ROOT / "examples/arrays/arm-line-4.toml"],
            ["park2016-3", "--view", "wave"], ["park2016-4", "--width", "60"], ["park2016-4", "--width", "180"]]
        for job in jobs:
            svg = self.svg(*job)
            page = [float(v) for v in svg.root.get("viewBox").split()]
            boxes = []
            for t in svg.root.iter(NS + "text"):
                size, x, y, text = number(t, "font-size"), number(t, "x"), number(t, "y"), "".join(t.itertext())
                w = sum(width.get(c, 0.61) for c in text) * size
                w *= 1.1 if t.get("font-weight") else 1.0
                x -= {"middle": w / 2, "end": w}.get(t.get("text-anchor"), 0.0)
                box = (x, y - 0.72 * size, x + w, y)
                self.assertGreaterEqual(box[0], 0, (job, text))
                self.assertGreaterEqual(box[1], 0, (job, text))
                self.assertLessEqual(box[2], page[2], (job, text))
                self.assertLessEqual(box[3], page[3], (job, text))
                for other, name in boxes:
                    apart = (box[0] >= other[2] - 0.8 or other[0] >= box[2] - 0.8 or
                             box[1] >= other[3] - 0.3 or other[1] >= box[3] - 0.3)
                    self.assertTrue(apart, f"{job}: \"{text}\" lies on \"{name}\"")
                boxes.append((box, text))


class Bounds(PlotTest):
    def test_an_hour_makes_a_picture_like_any_other(self):
        for view in ("both", "wave"):
            self.ok("plot", "--path", "M 0 0 C 40 0 0 40 40 40", "--duration", "3600", "--view", view, "-o", "a.svg")
            self.assertLess((self.dir / "a.svg").stat().st_size, 300_000)

    def test_thousands_of_tactors_make_a_page(self):
        self.write("many.toml", '[array]\nname = "many"\ngrid = { rows = 64, columns = 64, pitch_mm = 2.0 }\n')
        for options in ([], ["--algorithm", "continuous", "--phantom", "gaussian"]):
            svg = self.svg("--path", "M 1 1 L 120 100 L 3 90", "--array", "many.toml", *options)
            self.assertEqual(len(svg.all("tactor")), 4096)
            self.assertLess(float(svg.root.get("height")[:-2]), 250)
            self.assertLess(len(svg.text), 1_500_000)

    def test_one_tactor_one_burst_and_a_path_far_outside_can_be_drawn(self):
        self.write("one.toml", '[array]\nname = "one"\n[[tactor]]\nx_mm = 3.0\ny_mm = 4.0\nchannel = 7\n')
        svg = self.svg("--path", "M 3 4 L 4 4", "--duration", "0.05", "--array", "one.toml", "--outside", "clamp")
        self.assertEqual(len(svg.all("burst")), 1)
        self.assertIn("duration 0.07 s", svg.texts())
        svg = self.svg("--path", "M 20 20 L 900000 20", "--duration", "2", "--outside", "clamp")
        x1, _ = svg.place(40, 20)
        page = float(svg.root.get("viewBox").split()[2])
        self.assertTrue(0 < x1 < page)
        for line in svg.all("path"):
            for p in line.get("points").split():
                self.assertTrue(0 <= float(p.split(",")[0]) <= page)

    def test_hostile_names_are_text(self):
        self.write("a&b <c>.toml", '[[stroke]]\nname = "<script>\\u0001\\"&\\u00e4"\npath = "M 0 0 L 40 0"\n')
        svg = self.svg("a&b <c>.toml", "--duration", "1")
        self.assertNotIn("<script>", svg.text)
        self.assertTrue(any(t.startswith("<script>") for t in svg.texts()))


class Refusals(PlotTest):
    def test_unknown_formats_and_values(self):
        self.refused(2, "plot", "park2016-1", "-o", "a.jpg", says=("a.jpg", '".jpg"', ".svg, .png or .pdf"))
        self.refused(2, "plot", "park2016-1", "-o", "a", says=("no extension",))
        self.refused(2, "plot", "park2016-1", says=("--output",))
        self.refused(2, "plot", "park2016-1", "-o", "a.svg", "--view", "aray", says=("--view", "aray", "array"))
        for width in ("0", "59", "1001", "nan", "1e9", "x"):
            self.refused(2, "plot", "park2016-1", "-o", "a.svg", "--width", width, says=("--width", width))
        for dpi in ("0", "-5", "1e7", "inf"):
            self.refused(2, "plot", "park2016-1", "-o", "a.png", "--dpi", dpi, says=("--dpi", dpi))
        self.refused(2, "plot", "park2016-1", "-o", "a.png", "--dpi", "2400", "--width", "1000", says=("--dpi", "pixels"))
        self.refused(2, "plot", "park2016-1", "park2016-2", "-o", "a.svg", says=("park2016-2",))
        self.assertEqual([p.name for p in self.dir.iterdir()], ["alsa.conf"])

    def test_what_cannot_be_written_leaves_nothing_behind(self):
        self.refused(2, "plot", "park2016-1", "-o", "none/a.svg", says=("none", "does not exist"))
        (self.dir / "folder.svg").mkdir()
        self.refused(2, "plot", "park2016-1", "-o", "folder.svg", says=("is a folder",))
        old = self.write("old.png", b"old")
        os.symlink("/dev/full", self.dir / "full.svg")
        self.refused(1, "plot", "park2016-1", "-o", "full.svg", says=("full.svg", "No space"))
        self.refused(2, "plot", "nothing", "-o", "old.png")
        self.assertEqual(old.read_bytes(), b"old")
        self.assertEqual(sorted(p.name for p in self.dir.iterdir()), ["alsa.conf", "folder.svg", "full.svg", "old.png"])

    @unittest.skipIf(os.geteuid() == 0, "root may write everywhere")
    def test_a_folder_without_rights(self):
        closed = self.dir / "closed"
        closed.mkdir(mode=0o500)
        self.refused(1, "plot", "park2016-1", "-o", "closed/a.svg", says=("Permission denied", "where you may write"))

    def test_a_file_is_replaced_whole_and_a_link_stays(self):
        target = self.write("target.svg", "old")
        os.symlink("target.svg", self.dir / "link.svg")
        self.ok("plot", "park2016-1", "-o", "link.svg")
        self.assertTrue((self.dir / "link.svg").is_symlink())
        Svg(target)
        self.assertEqual(target.stat().st_mode & 0o777, 0o666 & ~self.umask())

    def umask(self):
        mask = os.umask(0)
        os.umask(mask)
        return mask


class Goldens(PlotTest):
    """Pictures that change only on purpose: run with TACTOR_UPDATE_GOLDEN=1 to accept what is drawn now."""

    NUMBER = re.compile(r"-?\d+(?:\.\d+)?")

    def check_golden(self, golden, *args):
        self.ok("plot", *args, "-o", "now.svg")
        now = (self.dir / "now.svg").read_text(encoding="utf-8")
        if os.environ.get("TACTOR_UPDATE_GOLDEN"):
            golden.write_text(now, encoding="utf-8")
        then = golden.read_text(encoding="utf-8")
        self.assertEqual(self.NUMBER.sub("#", now), self.NUMBER.sub("#", then), golden)
        # Other processors and libraries may round the last digit otherwise.
        for a, b in zip(self.NUMBER.findall(now), self.NUMBER.findall(then)):
            self.near(float(a), float(b), 0.011)

    def test_the_picture_of_the_readme(self):
        self.check_golden(ROOT / "examples/park2016-3.svg", "park2016-3")

    def test_tactile_brush(self):
        self.check_golden(ROOT / "tests/plot/golden/tactile-brush.svg", "park2016-1", *BRUSH)

    def test_continuous(self):
        self.check_golden(ROOT / "tests/plot/golden/continuous.svg", "park2016-2", "--algorithm", "continuous",
                          "--phantom", "barycentric")

    def test_wave(self):
        self.check_golden(ROOT / "tests/plot/golden/wave.svg", "park2016-1", "--view", "wave")


if __name__ == "__main__":
    main()
