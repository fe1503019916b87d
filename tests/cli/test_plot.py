# SPDX-License-Identifier: MIT
"""tactor plot: contents and places of the pictures, their files, and what has no space.
Places are computed here from the plan and from the scales that the picture's groups state."""
import itertools
import json
import math
import os
import re
import shutil
import subprocess

from harness import ROOT, SANITIZED, main
from pictures import BRUSH, NS, PlotTest, Png, Svg, box, number, overlap, pdf_size
import studies

SEVERAL = ROOT / "examples/strokes/several.toml"
KNOCKS = ROOT / "examples/strokes/knocks.toml"
PAGE_MM = 247.05  # height of A4 without margins, rounding included


def grid(rows, columns, pitch):
    return f'[array]\nname = "grid"\ngrid = {{ rows = {rows}, columns = {columns}, pitch_mm = {pitch}.0 }}\n'


class Array(PlotTest):
    def check_bursts(self, svg, plan, bursts):
        """Checks for dots where the plan has bursts, joined to the tactors that play them."""
        tactors = {t["tactor"]: t for t in plan["array"]["tactors"]}
        groups = {int(g.get("data-burst")): g for g in svg.all("joins")}
        self.assertEqual(sorted(groups), [i for i, _ in bursts])
        for dot, (i, b) in zip(svg.all("burst"), bursts, strict=True):
            self.assertEqual(dot.get("id"), f"burst-{i}")
            x, y = svg.place(b["x_mm"], b["y_mm"])
            self.near(number(dot, "cx"), x)
            self.near(number(dot, "cy"), y)
            lines = groups[i].findall(NS + "line")
            self.assertEqual([int(l.get("data-tactor")) for l in lines], [d["tactor"] for d in b["drives"]])
            for line, drive in zip(lines, b["drives"]):
                to = tactors[drive["tactor"]]
                for got, want in zip([number(line, k) for k in ("x1", "y1", "x2", "y2")], [x, y, *svg.place(to["x_mm"], to["y_mm"])]):
                    self.near(got, want)
                self.near(float(line.get("data-amplitude")), drive["amplitude"], 1e-5)

    def test_without_a_stroke_the_array_alone_is_drawn(self):
        self.assertRegex(self.ok("plot", "--array", "palm-2x4", "-o", "array.svg").stdout, r"^array.svg: the array without a stroke, 85 x [\d.]+ mm\n$")
        svg = Svg(self.dir / "array.svg")
        self.assertEqual([t for t in svg.texts() if t.isdigit()], [str(i) for i in range(8)])
        for kind in ("burst", "path", "start"):
            self.assertEqual(svg.all(kind), [])
        self.assertEqual(svg.root.findtext(f"{NS}title"), "palm-2x4")
        for more in (["--view", "timing"], ["--view", "wave"], ["--animate"]):
            self.refused(2, "plot", "--array", "palm-2x4", *more, "-o", "array2.svg", says=["the stroke is missing"])

    def test_options_of_a_stroke_need_one(self):
        for more in ("--duration 3", "--speed 60", "--fit", "--algorithm continuous", "--carrier 200", "--level-dbfs -20", "--outside clamp"):
            self.refused(2, "plot", *more.split(), "-o", "forgotten.svg", says=["the stroke is missing"])
            self.assertFalse((self.dir / "forgotten.svg").exists(), more)
        self.write("c.toml", "[defaults]\nspeed = 50\n")
        self.ok("plot", "--config", "c.toml", "-o", "array.svg")  # defaults are not for this stroke alone

    def test_tactors_and_the_scale_bar_are_to_scale(self):
        for name in ("palm-3x3", *(ROOT / "examples/arrays").glob("*.toml")):
            options = ["--path", "M 5 0 L 15 0", "--array", name, "--outside", "clamp"]
            tactors, svg = self.plan(*options)["array"]["tactors"], self.svg(*options)
            self.assertEqual(len(svg.all("tactor")), len(tactors))
            labels = {l.get("data-tactor"): l.text for l in svg.all("tactor-label")}
            same = all(t["channel"] == t["tactor"] for t in tactors)
            for t in tactors:
                g = svg.id(f"tactor-{t['tactor']}")
                for got, want in zip((number(g.find(NS + "circle"), "cx"), number(g.find(NS + "circle"), "cy")), svg.place(t["x_mm"], t["y_mm"])):
                    self.near(got, want)
                inside, label = g.find(NS + "text"), labels.get(str(t["tactor"]))
                if inside is not None:
                    self.assertEqual((inside.text, label), (str(t["tactor"]), None if same else f"ch {t['channel']}"))
                else:
                    self.assertEqual(label, f"{t['tactor']}" if same else f"{t['tactor']} (ch {t['channel']})")
            bar, mm = svg.all("bar", "scale-bar")[0], float(svg.id("scale-bar").get("data-mm"))
            self.near(number(bar, "x2") - number(bar, "x1"), mm * float(svg.id("array").get("data-mm-scale")))
            self.assertIn(f"{mm:g} mm", svg.texts())

    def test_several_strokes_share_one_time_and_one_array(self):
        plans, svg = self.plan(SEVERAL)["plans"], self.svg(SEVERAL)
        self.assertEqual(len(svg.all("path")), len(plans))
        bursts = [b | {"onset_s": p["start_s"] + b["onset_s"]} for p in plans for b in p["bursts"]]
        self.check_bursts(svg, plans[0], list(enumerate(bursts)))
        self.assertEqual(len(svg.all("bar", "sound")), sum(len(b["drives"]) for b in bursts))
        for bar in svg.all("bar", "sound"):
            self.near(number(bar, "x"), svg.time(bursts[int(bar.get("data-burst"))]["onset_s"]))
        self.assertEqual({n for e in svg.all("start-label") for n in e.text.split(", ")}, {f"{i + 1}" for i in range(len(plans))})
        ids = [e.get("id") for e in svg.id("timing").iter() if e.get("id")]
        self.assertGreater(ids.index("stroke-starts"), ids.index("soa"))  # over all lines

    def test_of_many_bursts_every_nth_is_drawn_and_the_picture_says_so(self):
        options = ["park2016-1", "--duration", "60"]
        svg, plan = self.svg(*options), self.plan(*options)
        stride = int(svg.id("array").get("data-stride"))
        self.assertGreater(stride, 1)
        self.check_bursts(svg, plan, [(i, b) for i, b in enumerate(plan["bursts"]) if i % stride == 0])
        self.assertIn(f"one burst in {stride} is drawn on the array", svg.texts())

    def test_moved_bursts_are_drawn_where_they_play_and_where_they_are_felt(self):
        plan = self.plan("park2016-3", "--compensate", "low-speed")
        self.write("p.json", json.dumps(plan))
        for source in (("park2016-3", "--compensate", "low-speed"), ("p.json",)):
            svg = self.svg(*source, "--view", "array")
            for ring, dot, tap, burst in zip(svg.all("felt-at"), svg.all("burst"), plan["compensation"]["taps"], plan["bursts"], strict=True):
                for mark, place in ((ring, (tap["felt_x_mm"], tap["felt_y_mm"])), (dot, (burst["x_mm"], burst["y_mm"]))):
                    self.assertLess(math.dist((number(mark, "cx"), number(mark, "cy")), svg.place(*place)), 0.02)
            for word in ("target", "played", "predicted", "low-speed", "taps", "sigma 5 mm", "100 mm/s"):
                self.assertIn(word, " ".join(svg.texts()))


class Timing(PlotTest):
    def test_no_line_strikes_through_a_number(self):
        for speed in ("60", "400"):
            svg = self.svg("park2016-1", "--speed", speed)
            for name in ("soa", "duration"):
                (text,) = svg.id(name).findall(NS + "text")
                for line in svg.id(name).findall(NS + "line"):
                    (x0, x1), (y0, y1) = (sorted((number(line, c + "1"), number(line, c + "2"))) for c in "xy")
                    self.assertFalse(overlap(box(text), (x0, y0 - 0.1, x1, y1 + 0.1)), (speed, name))

    def test_an_all_silent_plan_is_drawn_too(self):
        self.write("s.toml", '[stroke]\npath = "M 0 20 H 40"\nintensity = 0\n')
        for view in ("both", "array", "wave"):
            svg = self.svg("s.toml", "--view", view)
            self.assertTrue(view != "both" or svg.all("bar", "sound") == [])

    def test_bars_that_are_too_dense_are_drawn_as_curves(self):
        dense = self.svg("park2016-1", "--duration", "120")
        self.assertEqual(dense.id("timing").get("data-drawn"), "columns")
        self.assertEqual(dense.all("bar", "sound"), [])
        self.assertGreater(len(dense.all("envelope")), 4)

    def test_a_short_wave_shows_its_carrier(self):
        svg = self.svg("park2016-3", "--duration", "0.14", "--view", "wave")
        ys = [float(p.split(",")[1]) for p in svg.all("envelope")[0].get("points").split()]
        self.assertGreater(sum((b - a) * (c - b) < 0 for a, b, c in zip(ys, ys[1:], ys[2:])), 20)

    def test_a_continuous_stroke_moves_its_target(self):
        svg = self.svg("wave-2x4", "--array", "palm-2x4", "--animate", "--algorithm", "continuous")
        self.assertEqual((len(svg.all("target")), len(svg.all("now"))), (1, 1))
        move = next(a for a in svg.all("target")[0].iter(NS + "animate") if a.get("attributeName") == "cx")
        self.assertEqual(move.get("keyTimes").count(";"), move.get("values").count(";"))
        self.assertGreater(move.get("values").count(";"), 60)
        self.assertGreater(len(svg.all("plays")), 10)
        self.assertNotIn("animate", self.svg("park2016-1").text)


class Files(PlotTest):
    def test_the_png_shows_the_same_as_the_svg_and_cuts_nothing_off(self):
        svg = self.svg("park2016-3", "--view", "array")
        self.ok("plot", "park2016-3", "--view", "array", "-o", "a.png", "--dpi", "300")
        png = Png(self.dir / "a.png")
        self.near(png.width, float(svg.root.get("width")[:-2]) / 25.4 * 300, 1)
        for dot in svg.all("burst"):
            got = png.pixel(int(number(dot, "cx") * 300 / 72), int(number(dot, "cy") * 300 / 72))
            self.assertLess(max(abs(a - int(dot.get("fill")[i:i + 2], 16)) for a, i in zip(got, (1, 3, 5))), 4, dot.get("id"))
        edge = [png.pixel(x, y) for x in range(png.width) for y in (0, png.height - 1)] + [png.pixel(x, y) for y in range(png.height) for x in (0, png.width - 1)]
        self.assertEqual(set(edge), {(255, 255, 255)})

    def test_the_same_picture_is_the_same_file_in_every_locale(self):
        for ext in ("svg", "png", "pdf"):
            self.ok("plot", "park2016-2", "-o", f"a.{ext}", "--width", "120")
            self.ok("plot", "park2016-2", "-o", f"b.{ext}", "--width", "120", env={"LC_ALL": "de_DE.UTF-8", "TZ": "Asia/Tokyo"})
            self.assertEqual((self.dir / f"a.{ext}").read_bytes(), (self.dir / f"b.{ext}").read_bytes())
        svg = Svg(self.dir / "a.svg")
        self.assertEqual((svg.root.get("width"), svg.root.find(NS + "title").text), ("120mm", "park2016-2 on palm-3x3"))
        self.assertIn("21 bursts", svg.root.find(NS + "desc").text)
        points = [120 / 25.4 * 72, float(svg.root.get("height").removesuffix("mm")) / 25.4 * 72]
        for size, expected in zip(pdf_size((self.dir / "a.pdf").read_bytes()), points, strict=True):
            self.assertAlmostEqual(size, expected, delta=1)

    def test_no_text_leaves_the_page_or_lies_on_another(self):
        for job in (["park2016-1"], ["park2016-3"], ["park2016-1", *BRUSH], ["park2016-3", "--algorithm", "continuous"],
                    ["park2016-3", "--duration", "0.1"], [SEVERAL], ["--path", "M 0 0 L 100 0", "--array", ROOT / "examples/arrays/arm-line-4.toml"],
                    ["park2016-3", "--view", "wave"], ["park2016-4", "--width", "60"], ["park2016-4", "--width", "180"]):
            svg = self.svg(*job)
            page = [float(v) for v in svg.root.get("viewBox").split()]
            self.assertGreaterEqual(min(number(t, "font-size") for t in svg.root.iter(NS + "text")), 6.0)
            boxes = [(box(t), t.text) for t in svg.root.iter(NS + "text")]
            for (left, top, right, bottom), text in boxes:
                self.assertTrue(0 <= left and 0 <= top and right <= page[2] and bottom <= page[3], (job, text))
            for (a, text), (b, other) in itertools.combinations(boxes, 2):
                self.assertFalse(overlap((a[0] + 0.8, a[1] + 0.3, a[2], a[3]), b), (job, text, other))

    def test_large_and_small_ones_make_a_page(self):
        for view in ("wave",) if SANITIZED else ("both", "wave"):
            self.assertLess(len(self.svg("--path", "M 0 0 C 40 0 0 40 40 40", "--duration", "3600", "--view", view).text), 300_000)
        self.write("many.toml", grid(32, 32, 4))
        svg = self.svg("--path", "M 1 1 L 120 100 L 3 90", "--array", "many.toml", "--algorithm", "continuous", "--phantom", "gaussian")
        self.assertEqual(len(svg.all("tactor")), 1024)
        self.assertLess(float(svg.root.get("height")[:-2]), 250)
        self.assertLess(len(svg.text), 1_500_000)
        self.write("one.toml", '[array]\nname = "one"\n[[tactor]]\nx_mm = 3.0\ny_mm = 4.0\nchannel = 7\n')
        svg = self.svg("--path", "M 3 4 L 4 4", "--duration", "0.05", "--array", "one.toml", "--outside", "clamp")
        self.assertEqual(len(svg.all("burst")), 1)
        svg = self.svg("--path", "M 20 20 L 900000 20", "--duration", "2", "--outside", "clamp")
        page = float(svg.root.get("viewBox").split()[2])
        self.assertTrue(all(0 <= float(p.split(",")[0]) <= page for line in svg.all("path") for p in line.get("points").split()))

    def test_impossible_pictures_are_refused_and_leave_nothing(self):
        for args in ("-o x.jpg", "-o x", "-o /dev/stdout", "", "-o x.svg --view aray", "-o x.svg --width 59", "-o x.svg --width 1001", "-o x.svg --width nan",
                     "-o x.png --dpi 0", "-o x.png --dpi 1e7", "-o x.png --dpi inf", "-o x.png --dpi 2400 --width 1000", "park2016-2 -o x.svg",
                     "--animate -o x.png", "--animate -o x.pdf", "--animate -o x.svg --view wave", "-o none/x.svg", "-o folder.svg"):
            (self.dir / "folder.svg").mkdir(exist_ok=True)
            with self.subTest(args):
                self.refused(2, "plot", "park2016-1", *args.split())
        self.refused(2, "plot", "--path", "M 0 0 L 40 40", "--duration", "200", "--animate", "-o", "x.svg")
        self.write("old.png", b"old")
        os.symlink("/dev/full", self.dir / "full.svg")
        self.refused(1, "plot", "park2016-1", "-o", "full.svg")
        self.refused(1, "plot", "park2016-1", "-o", "x.pdf", env={"PATH": "/nonexistent"})
        self.refused(2, "plot", "nothing", "-o", "old.png")
        self.assertEqual((self.dir / "old.png").read_bytes(), b"old")
        self.assertEqual(sorted(p.name for p in self.dir.iterdir()), ["alsa.conf", "folder.svg", "full.svg", "old.png"])

    def test_titles_can_be_changed_and_all_formats_have_one_typeface(self):
        studies.simulated(self.dir / "study")
        for args, own in ((("plot", "park2016-1"), "park2016-1"), (("compare", "park2016-1"), "park2016-1"), (("analyze", "study"), "(simulated)")):
            plain, none, other = (self.draw(*args, *more) for more in ((), ("--title", "none"), ("--title", "Figure 2")))
            self.assertTrue(any(own in t for t in plain.texts()) and not any(own in t for t in none.texts()), args)
            self.assertLess(float(none.root.get("height")[:-2]), float(plain.root.get("height")[:-2]))
            self.assertTrue(any(t.startswith("Figure 2") for t in other.texts()))
            self.assertTrue(plain.root.get("font-family").startswith("'DejaVu Sans'"))
            self.ok(*args, "-o", "a.pdf")
            if shutil.which("pdffonts"):
                fonts = subprocess.run(["pdffonts", self.dir / "a.pdf"], capture_output=True, text=True, check=True).stdout
                names = {line.split()[0].partition("+")[2] for line in fonts.splitlines()[2:]}
                self.assertTrue(names and all(n.startswith("DejaVuSans") for n in names), names)

    def draw(self, command, *args):
        self.ok(command, *args, "-o", "a.svg")
        return Svg(self.dir / "a.svg")

    def test_analyze_shows_each_participant_and_its_error_bars(self):
        studies.simulated(self.dir / "study")
        svg = self.draw("analyze", "study", "--width", "85")
        self.near(float(svg.root.get("width")[:-2]), 85)
        self.assertEqual(len(svg.all("value")), len(list((self.dir / "study").glob("sub-*"))) * len(svg.all("bar")))
        # For each participant a line for each method over the motions, and one over the methods of a run with two.
        self.assertEqual(len(svg.all("value-line")), 12 * (1 + 1 + 3 + 3))
        dots = {(e.get("cx"), e.get("cy")) for e in svg.all("value")}
        self.assertEqual({tuple(at.split(",")) for e in svg.all("value-line") for at in e.get("points").split()} - dots, set())
        for panel in svg.all("bars"):
            order = [e.get("class") for e in panel.iter()]
            self.assertLess(order.index("across"), min(order.index("error"), order.index("value")))
        self.assertEqual(len({number(p[0], "x") for p in svg.all("bars")}), 1)  # one below the other
        self.refused(2, "analyze", "study", "-o", "a.svg", "--width", "20")
        self.ok("analyze", "study", "-o", "a.png", "--dpi", "72")


class Crowded(PlotTest):
    """Many strokes and tactors: strokes can be told apart, and the picture reports what has no space."""

    def notes(self, svg):
        return " ".join(e.text for e in svg.all("note"))

    def drawn(self, *args, view="both", width="170"):
        return self.svg("s.toml", "--array", "a.toml", "--view", view, "--width", width, "--level-dbfs", "-40", *args)

    def test_bars_of_simultaneous_strokes_do_not_overlap(self):
        self.write("a.toml", grid(3, 3, 20))
        self.write("s.toml", "".join(f'[[stroke]]\npath = "M 0 {10 * i} L 40 {20 - i}"\nspeed_mm_s = 60.0\nstart_s = {0.1 * i}\n' for i in range(3)))
        rows, seen = {}, 0
        for bar in self.drawn(view="timing").all("bar", "sound"):
            rows.setdefault(bar.get("data-tactor"), []).append(bar)
        for a, b in (pair for bars in rows.values() for pair in itertools.combinations(bars, 2)):
            (p, q) = ((number(e, "x"), number(e, "y"), number(e, "x") + number(e, "width"), number(e, "y") + number(e, "height")) for e in (a, b))
            if a.get("data-stroke") != b.get("data-stroke"):
                seen += min(p[2], q[2]) > max(p[0], q[0])
                self.assertFalse(overlap(p, q))
        self.assertGreater(seen, 20)

    def test_what_has_no_space_is_stated_and_very_many_strokes_make_a_page(self):
        self.write("a.toml", grid(30, 30, 5))
        self.write("s.toml", '[stroke]\npath = "M 2 2 L 140 140"\n')
        self.assertIn("no space for the number", self.notes(self.drawn(view="array", width="60")))
        self.write("a.toml", grid(10, 10, 10))
        self.write("s.toml", '[stroke]\npath = "' + " ".join(f"{'M' if y == 0 else 'L'} 0 {y} L 90 {y} L 90 {y + 5} L 0 {y + 5}" for y in range(0, 91, 10)) + '"\n')
        for view in ("timing", "wave"):
            svg = self.drawn("--outside", "clamp", view=view)
            shown = [int(e.text) for e in svg.all("row-label")]
            self.assertEqual(shown, list(range(0, 100, shown[1])))
            self.assertIn(f"one row in {shown[1]} has its number", self.notes(svg))
        self.assertTrue("no space for the peaks of rows" in self.notes(svg) and svg.all("peak") == [])
        self.write("a.toml", grid(3, 3, 20))
        for count, notes in ((30, ()), (61, ("starts of more than 60 strokes are not marked", "strokes on one tactor overlap"))):
            self.write("s.toml", "".join(f'[[stroke]]\npath = "M {i / 2} 0 L 40 40"\nstart_s = 0\n' for i in range(count)))
            svg = self.drawn(view="timing", width="60")
            for note in notes:
                self.assertIn(note, self.notes(svg))
            self.assertEqual([e.text for e in svg.id("stroke-starts").findall(NS + "text")] if not notes else ["stroke 1-30"], ["stroke 1-30"])
        self.assertIn("colours repeat after 10 strokes", self.notes(self.drawn()))
        self.write("a.toml", grid(16, 16, 10))
        self.write("s.toml", "".join(f'[[stroke]]\nname = "one of very many strokes, number {i + 1}"\npath = "M 0 {2.5 * i} L 150 {2.5 * i}"\n'
                                     f"speed_mm_s = 60.0\nstart_s = {i / 100}\n" for i in range(60)))
        for width in (60, 300):
            self.assertLessEqual(float(self.drawn(width=width).root.get("height")[:-2]), PAGE_MM * max(1, width / 170), width)


class Goldens(PlotTest):
    """Pictures that change only on purpose: run with TACTOR_UPDATE_GOLDEN=1 to accept the present ones."""

    NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
    PICTURES = (
        ("examples/park2016-3.svg", "park2016-3", "--animate"),
        ("man/guide/reach.svg", ROOT / "examples/strokes/reach.toml"),
        ("man/guide/knocks.svg", KNOCKS),
        ("man/guide/textures.svg", ROOT / "examples/strokes/textures.toml", "--view", "wave"),
        ("tests/plot/golden/tactile-brush.svg", "park2016-1", *BRUSH),
        ("tests/plot/golden/continuous.svg", "park2016-2", "--algorithm", "continuous", "--phantom", "barycentric"),
    )

    def test_pictures_are_those_of_the_documents(self):
        for name, *args in self.PICTURES:
            with self.subTest(name):
                golden, now = ROOT / name, self.svg(*args).text.partition("<!-- sha256 ")[0]  # rounded otherwise, it is another
                if os.environ.get("TACTOR_UPDATE_GOLDEN"):
                    golden.write_text(now, encoding="utf-8")
                then = golden.read_text(encoding="utf-8")
                self.assertEqual(self.NUMBER.sub("#", now), self.NUMBER.sub("#", then))
                # Other processors and libraries may round the last digit otherwise.
                for a, b in zip(self.NUMBER.findall(now), self.NUMBER.findall(then)):
                    self.near(float(a), float(b), 0.011)


if __name__ == "__main__":
    main()
