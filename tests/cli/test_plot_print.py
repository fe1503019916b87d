# SPDX-License-Identifier: MIT
"""Pictures printed 85 mm wide: titles, typefaces, numbers and colours with one meaning."""
import itertools
import pathlib
import re
import subprocess
import sys
import shutil

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "study"))
import studies

from harness import ROOT, main
from pictures import NS, PlotTest, Svg, box, number, overlap

KNOCKS = ROOT / "examples/strokes/knocks.toml"
GRID = '[array]\nname = "eight"\ngrid = { rows = 8, columns = 8, pitch_mm = 10.0 }\n'


class Print(PlotTest):
    def study(self):
        studies.simulated(self.dir / "study")
        return "study"

    def drawn(self, command, *args):
        self.ok(command, *args, "-o", "a.svg")
        return Svg(self.dir / "a.svg")

    def test_a_title_can_be_changed_or_left_out(self):
        study = self.study()
        for args, own in ((("plot", "park2016-1"), "park2016-1"), (("compare", "park2016-1"), "park2016-1"), (("analyze", study), "(simulated)")):
            plain, none = self.drawn(*args), self.drawn(*args, "--title", "none")
            self.assertTrue(any(own in t for t in plain.texts()))
            self.assertFalse(any(own in t for t in none.texts()), args)
            self.assertLess(float(none.root.get("height")[:-2]), float(plain.root.get("height")[:-2]))
            self.assertTrue(any(t.startswith("Figure 2") for t in self.drawn(*args, "--title", "Figure 2").texts()))

    def test_all_formats_have_one_typeface(self):
        for args in (("plot", "park2016-1"), ("compare", "park2016-1"), ("analyze", self.study())):
            self.assertTrue(self.drawn(*args).root.get("font-family").startswith("'DejaVu Sans'"))
            self.ok(*args, "-o", "a.pdf")
            if shutil.which("pdffonts"):
                fonts = subprocess.run(["pdffonts", self.dir / "a.pdf"], capture_output=True, text=True, check=True).stdout
                names = {line.split()[0].partition("+")[2] for line in fonts.splitlines()[2:]}
                self.assertTrue(names and all(n.startswith("DejaVuSans") for n in names), names)

    def test_no_line_strikes_through_a_dimension(self):
        for speed in ("60", "200", "400"):
            svg = self.svg("park2016-1", "--speed", speed)
            for name in ("soa", "duration"):
                (text,) = svg.id(name).findall(NS + "text")
                for line in svg.id(name).findall(NS + "line"):
                    x0, x1 = sorted((number(line, "x1"), number(line, "x2")))
                    y0, y1 = sorted((number(line, "y1"), number(line, "y2")))
                    self.assertFalse(overlap(box(text), (x0, y0 - 0.1, x1, y1 + 0.1)), (speed, name))

    def test_numbers_of_starts_lie_over_all_lines(self):
        svg = self.svg(ROOT / "examples/strokes/several.toml")
        ids = [e.get("id") for e in svg.id("timing").iter() if e.get("id")]
        self.assertGreater(ids.index("stroke-starts"), ids.index("soa"))

    def test_numbers_of_strokes_do_not_read_as_tactors(self):
        svg = self.svg(KNOCKS)
        boxes = svg.all("start-box")
        labels = svg.all("start-label")
        self.assertEqual(len(boxes), len(labels))
        self.assertEqual({e.text for e in labels}, {"1, 3, 5", "2, 4, 6", "7"})
        for e, b in zip(labels, boxes):
            self.assertIsNone(e.get("font-weight"))
            self.assertTrue(number(b, "x") < box(e)[0] and box(e)[2] < number(b, "x") + number(b, "width"))

    def test_repeats_look_alike_and_no_colour_is_without_legend(self):
        svg = self.svg(KNOCKS)
        self.assertEqual([e.text for e in svg.all("stroke-name")], ["1, 3, 5 knock-1", "2, 4, 6 knock-2", "7 after"])
        colours = [e.get("fill") for e in svg.all("stroke-colour")]
        self.assertEqual(len(set(colours)), 3)
        paths = svg.all("path")
        self.assertEqual([p.get("stroke") for p in paths], colours)
        # Lines over another path let it show through.
        self.assertEqual([p.get("stroke-dasharray") is not None for p in paths], [False, True, False])
        self.assertEqual({e.get("stroke") for e in svg.all("join")}, {"#969696"})

    def test_labels_of_ends_and_numbers_of_tactors_are_apart(self):
        self.write("a.toml", GRID)
        starts = [(x, y) for x in range(0, 71, 5) for y in (0, 35, 66, 70)]
        for x, y in starts:
            svg = self.svg("--path", f"M {x} {y} L 35 20", "--array", "a.toml", "--view", "array")
            labels = svg.all("start-label") + svg.all("end-label") + svg.all("tactor-label") + svg.all("number")
            for a, b in itertools.combinations(labels, 2):
                self.assertFalse(overlap(box(a), box(b)), (x, y, a.text, b.text))

    def test_tactors_of_a_comparison_have_their_numbers(self):
        svg = self.drawn("compare", "park2016-1")
        self.assertEqual(len(svg.all("panel")), 3)
        for panel in svg.all("panel"):
            self.assertEqual([e.text for e in panel.iter(NS + "text") if e.get("class") == "number"], [str(i) for i in range(9)])

    def test_analyze_shows_each_participant_and_its_error_bars(self):
        study = self.study()
        people = len([p for p in (self.dir / study).iterdir() if p.name.startswith("sub-")])
        svg = self.drawn("analyze", study, "--width", "85")
        self.near(float(svg.root.get("width")[:-2]), 85)
        self.assertEqual(len(svg.all("value")), people * len(svg.all("bar")))
        order = [e.get("class") for e in svg.root.iter()]
        for panel in svg.all("bars"):
            order = [e.get("class") for e in panel.iter() if e.get("class") in ("bar", "across", "value", "error")]
            self.assertLess(order.index("across"), order.index("error"))
            self.assertLess(order.index("across"), order.index("value"))
        self.assertEqual(len({number(p[0], "x") for p in svg.all("bars")}), 1)  # one below the other
        self.refused(2, "analyze", study, "-o", "a.svg", "--width", "20")
        self.ok("analyze", study, "-o", "a.png", "--dpi", "72")


if __name__ == "__main__":
    main()
