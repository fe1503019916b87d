# SPDX-License-Identifier: MIT
"""Files of tactor plot: formats, sizes, refusals, and pictures that change only on purpose."""
import json
import os
import re
import struct
import unittest

from harness import ROOT, SANITIZED, main
from pictures import BRUSH, NS, PlotTest, Png, Svg, number


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

    def test_the_png_shows_the_same_as_the_svg(self):
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

    def test_svg_has_the_given_size_with_title_and_description(self):
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
        # Approximate widths of DejaVu Sans, in em.
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
    def test_an_hour_makes_a_picture_of_ordinary_size(self):
        for view in ("wave",) if SANITIZED else ("both", "wave"):
            self.ok("plot", "--path", "M 0 0 C 40 0 0 40 40 40", "--duration", "3600", "--view", view, "-o", "a.svg")
            self.assertLess((self.dir / "a.svg").stat().st_size, 300_000)

    def test_a_thousand_tactors_make_a_page(self):
        self.write("many.toml", '[array]\nname = "many"\ngrid = { rows = 32, columns = 32, pitch_mm = 4.0 }\n')
        for options in ([], ["--algorithm", "continuous", "--phantom", "gaussian"]):
            svg = self.svg("--path", "M 1 1 L 120 100 L 3 90", "--array", "many.toml", *options)
            self.assertEqual(len(svg.all("tactor")), 1024)
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
    def test_unknown_formats_and_values_are_refused(self):
        self.refused(2, "plot", "park2016-1", "-o", "a.jpg")
        self.refused(2, "plot", "park2016-1", "-o", "a")
        self.refused(2, "plot", "park2016-1")
        self.refused(2, "plot", "park2016-1", "-o", "a.svg", "--view", "aray")
        for width in ("0", "59", "1001", "nan", "1e9", "x"):
            self.refused(2, "plot", "park2016-1", "-o", "a.svg", "--width", width, says=("--width", width))
        for dpi in ("0", "-5", "1e7", "inf"):
            self.refused(2, "plot", "park2016-1", "-o", "a.png", "--dpi", dpi, says=("--dpi", dpi))
        self.refused(2, "plot", "park2016-1", "-o", "a.png", "--dpi", "2400", "--width", "1000")
        self.refused(2, "plot", "park2016-1", "park2016-2", "-o", "a.svg")
        self.assertEqual([p.name for p in self.dir.iterdir()], ["alsa.conf"])

    def test_a_failed_write_leaves_nothing_behind(self):
        self.refused(2, "plot", "park2016-1", "-o", "none/a.svg")
        (self.dir / "folder.svg").mkdir()
        self.refused(2, "plot", "park2016-1", "-o", "folder.svg")
        old = self.write("old.png", b"old")
        os.symlink("/dev/full", self.dir / "full.svg")
        self.refused(1, "plot", "park2016-1", "-o", "full.svg")
        self.refused(2, "plot", "nothing", "-o", "old.png")
        self.assertEqual(old.read_bytes(), b"old")
        self.assertEqual(sorted(p.name for p in self.dir.iterdir()), ["alsa.conf", "folder.svg", "full.svg", "old.png"])

    @unittest.skipIf(os.geteuid() == 0, "root may write everywhere")
    def test_a_folder_without_rights_is_refused(self):
        closed = self.dir / "closed"
        closed.mkdir(mode=0o500)
        self.refused(1, "plot", "park2016-1", "-o", "closed/a.svg")

    def test_a_file_is_replaced_whole_and_a_link_stays(self):
        target = self.write("target.svg", "")
        os.symlink("target.svg", self.dir / "link.svg")
        self.ok("plot", "park2016-1", "-o", "link.svg")
        self.assertTrue((self.dir / "link.svg").is_symlink())
        Svg(target)
        self.assertEqual(target.stat().st_mode & 0o777, 0o666 & ~self.umask())

    def umask(self):
        mask = os.umask(0)
        os.umask(mask)
        return mask


class Animated(PlotTest):
    def lit(self, element):
        """Returns when a circle is seen, s in the loop: (loop, from, to)."""
        change = next(a for a in element.iter(NS + "animate") if a.get("attributeName") == "opacity")
        self.assertEqual((element.get("opacity"), change.get("calcMode"), change.get("repeatCount")), ("0", "discrete", "indefinite"))
        loop = float(change.get("dur").removesuffix("s"))
        times, shown = ([float(v) for v in change.get(name).split(";")] for name in ("keyTimes", "values"))
        self.assertEqual(times[0], 0.0)
        self.assertEqual(shown, [1.0, 0.0] if len(times) == 2 else [0.0, 1.0, 0.0])
        return loop, times[-2] * loop, times[-1] * loop

    def test_tactors_light_up_while_they_play(self):
        svg = self.svg("park2016-1", "--animate")
        plan = json.loads(self.ok("plan", "park2016-1", "--format", "json").stdout)
        want = [(d["tactor"], b["onset_s"], b["onset_s"] + b["duration_s"]) for b in plan["bursts"] for d in b["drives"]]
        discs = svg.all("plays")
        self.assertEqual(len(discs), len(want))
        end = max(to for _, _, to in want)
        for disc, (tactor, start, stop) in zip(discs, want):
            loop, lit, dark = self.lit(disc)
            self.near(loop, end + 0.8, 1e-4)
            self.near(lit, start, 1e-4)
            self.near(dark, stop, 1e-4)
            place = plan["array"]["tactors"][tactor]
            for at, want_at in zip((number(disc, "cx"), number(disc, "cy")), svg.place(place["x_mm"], place["y_mm"])):
                self.near(at, want_at, 0.01)

    def test_the_target_moves_and_a_still_picture_has_none_of_it(self):
        svg = self.svg("wave-2x4", "--array", "palm-2x4", "--animate", "--algorithm", "continuous")
        self.assertEqual(len(svg.all("target")), 1)
        self.assertEqual(len(svg.all("now")), 1)
        moves = [a for a in svg.all("target")[0].iter(NS + "animate") if a.get("attributeName") == "cx"]
        self.assertEqual(len(moves[0].get("keyTimes").split(";")), len(moves[0].get("values").split(";")))
        self.assertGreater(len(moves[0].get("values").split(";")), 60)
        self.assertGreater(len(svg.all("plays")), 10)
        self.assertNotIn("animate", (self.dir / "still.svg").read_text() if self.ok("plot", "park2016-1", "-o", "still.svg") else "")

    def test_what_cannot_move_is_refused(self):
        for more in (("-o", "a.png"), ("-o", "a.pdf"), ("-o", "a.svg", "--view", "wave")):
            self.refused(2, "plot", "park2016-1", "--animate", *more)
        self.refused(2, "plot", "--path", "M 0 0 L 40 40", "--duration", "200", "--animate", "-o", "a.svg")
        self.assertEqual(list(self.dir.glob("a.*")), [])


class Goldens(PlotTest):
    """Pictures that change only on purpose: run with TACTOR_UPDATE_GOLDEN=1 to accept the present ones."""

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
        self.check_golden(ROOT / "examples/park2016-3.svg", "park2016-3", "--animate")

    def test_the_picture_of_the_readme_that_eases(self):
        self.check_golden(ROOT / "examples/reach.svg", str(ROOT / "examples/strokes/reach.toml"))

    def test_the_picture_of_groups_and_repeats(self):
        self.check_golden(ROOT / "examples/knocks.svg", str(ROOT / "examples/strokes/knocks.toml"))

    def test_the_picture_of_the_waves(self):
        self.check_golden(ROOT / "examples/textures.svg", str(ROOT / "examples/strokes/textures.toml"), "--view", "wave")

    def test_the_picture_of_a_recording_along_the_path(self):
        self.check_golden(ROOT / "examples/comb.svg", str(ROOT / "examples/strokes/comb.toml"), "--view", "wave")

    def test_tactile_brush(self):
        self.check_golden(ROOT / "tests/plot/golden/tactile-brush.svg", "park2016-1", *BRUSH)

    def test_continuous(self):
        self.check_golden(ROOT / "tests/plot/golden/continuous.svg", "park2016-2", "--algorithm", "continuous",
                          "--phantom", "barycentric")

    def test_wave(self):
        self.check_golden(ROOT / "tests/plot/golden/wave.svg", "park2016-1", "--view", "wave")


if __name__ == "__main__":
    main()
