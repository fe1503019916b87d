# SPDX-License-Identifier: MIT
"""tactor plot and compare: each label is nearest to its object, and strokes can be told apart, at every width.
Boxes of texts are measured here by the advances of DejaVu Sans, the widest of the usual fonts."""
import itertools
import math

from harness import main
from pictures import NS, PlotTest, Svg, number
from sheets import ARRAYS, WIDTHS, Sheets, box, distance, grid, overlap, strokes

class Labels(Sheets):
    def check_labels(self, what, svg):
        circles = {int(g.get("data-tactor")): g.find(NS + "circle") for g in svg.all("tactor")}
        sites = {i: (number(c, "cx"), number(c, "cy"), number(c, "r")) for i, c in circles.items()}
        inside = {int(g.get("data-tactor")): g.find(NS + "text") for g in svg.all("tactor")}
        beside = {int(e.get("data-tactor")): e for e in svg.all("tactor-label")}
        notes = " ".join(e.text for e in svg.all("note"))
        for i, (x, y, r) in sites.items():
            if inside[i] is not None:
                self.assertEqual(inside[i].text, str(i))
                corner = max(math.hypot(cx - x, cy - y) for cx in box(inside[i])[::2] for cy in box(inside[i])[1::2])
                self.assertLess(corner, r, (what, i))
            elif i in beside:
                self.assertEqual(beside[i].text.split()[0], str(i))
            else:
                self.assertIn("no space for the number", notes, (what, i))
        marks = [(number(e, "cx"), number(e, "cy"), number(e, "r")) for e in svg.all("burst") + svg.all("start")]
        marks += [(number(e, "x") + number(e, "width") / 2, number(e, "y") + number(e, "height") / 2, number(e, "width") / 2)
                  for e in svg.all("end")]
        for i in (i for i in sites if inside[i] is not None):
            for x, y, r in marks:
                self.assertGreater(distance(box(inside[i]), x, y), r - 0.5, (what, i))
        for i, e in beside.items():
            far = sorted((distance(box(e), x, y), k) for k, (x, y, _) in sites.items())
            self.assertEqual(far[0][1], i, (what, e.text))
            self.assertLess(far[0][0], far[1][0] / 1.1, (what, e.text))
        labels = list(beside.values()) + svg.all("start-label") + svg.all("end-label")
        for a, b in itertools.combinations(labels, 2):
            self.assertFalse(overlap(box(a), box(b)), (what, a.text, b.text))
        for e in labels:
            for i, (x, y, r) in sites.items():
                self.assertGreaterEqual(distance(box(e), x, y), r - 0.01, (what, e.text, i))
            self.assertGreaterEqual(box(e)[0], 0)
        return [i for i in sites if inside[i] is None and i not in beside]

    def test_each_label_is_nearest_to_its_tactor_and_on_nothing_else(self):
        without = [what for what, svg in self.pictures("array") if self.check_labels(what, svg)]
        self.assertLessEqual(len(without), 3, without)  # of 36, where bursts crowd on the narrowest page

    def test_idle_tactors_keep_their_numbers(self):
        for what, svg in self.pictures("array", counts=(1,), widths=(85,)):
            shown = len(svg.all("number")) + len(svg.all("tactor-label"))
            self.assertGreaterEqual(shown, len(svg.all("tactor")), what)

    def test_labels_without_room_are_reported(self):
        self.write("a.toml", grid(30, 30, 5))
        svg = self.svg("--path", "M 2 2 L 140 140", "--array", "a.toml", "--width", "60", "--view", "array")
        self.assertIn("no space for the numbers", " ".join(e.text for e in svg.all("note")))

    def test_a_channel_is_named_once(self):
        for file, channels in (("nine", False), ("twelve", True)):
            self.write("a.toml", ARRAYS[file][0])
            self.write("s.toml", strokes(1, ARRAYS[file][1]))
            svg = self.svg("s.toml", "--array", "a.toml")
            self.assertIn("tactor (ch)" if channels else "tactor", [e.text for e in svg.all("row-heading")])
            for e in svg.all("row-label"):
                self.assertEqual("(" in e.text, channels, e.text)
            self.assertEqual(any("ch" in e.text for e in svg.all("tactor-label")), channels)
            self.assertEqual(any("tactor n on channel n" in t for t in svg.texts()), not channels)


class Strokes(Sheets):
    def test_names_and_colours_are_in_the_legend(self):
        for what, svg in self.pictures("both", counts=(3, 10), widths=(60, 170)):
            count = what[1]
            names = [e.text for e in svg.all("stroke-name")]
            self.assertEqual(len(names), count, what)
            self.assertEqual([n.split()[0] for n in names], [str(i + 1) for i in range(count)])
            self.assertIn("curve" if count == 3 else "stroke a", names[0])
            colours = [e.get("fill") for e in svg.all("stroke-colour")]
            self.assertEqual(len(set(colours)), count)
            self.assertEqual([e.get("stroke") for e in svg.all("path")], colours)
            for bar in svg.all("bar", "sound"):
                self.assertEqual(bar.get("fill"), colours[int(bar.get("data-stroke"))])
            for e, f in itertools.combinations(svg.all("stroke-name"), 2):
                self.assertFalse(overlap(box(e), box(f)), (what, e.text, f.text))

    def test_names_that_begin_alike_are_told_apart(self):
        self.write("a.toml", ARRAYS["nine"][0])
        self.write("s.toml", "".join(f'[[stroke]]\nname = "a long name of stroke {i + 1}"\npath = "M {i} 0 L 40 40"\n' for i in range(14)))
        for width in (60, 85, 170):
            names = [e.text.partition(" ")[2] for e in self.svg("s.toml", "--array", "a.toml", "--width", str(width)).all("stroke-name")]
            self.assertEqual((len(names), len(set(names))), (14, 14), names)

    def test_bars_of_simultaneous_strokes_do_not_overlap(self):
        seen = 0
        for what, svg in self.pictures("timing", counts=(3,), widths=(170,)):
            rows = {}
            for bar in svg.all("bar", "sound"):
                self.assertIsNone(bar.get("fill-opacity"), what)
                rows.setdefault(bar.get("data-tactor"), []).append(bar)
            for bars in rows.values():
                for a, b in itertools.combinations(bars, 2):
                    sides = [(number(e, "x"), number(e, "y"), number(e, "x") + number(e, "width"),
                              number(e, "y") + number(e, "height")) for e in (a, b)]
                    if a.get("data-stroke") != b.get("data-stroke"):
                        seen += min(sides[0][2], sides[1][2]) > max(sides[0][0], sides[1][0])
                        self.assertFalse(overlap(*sides), what)
        self.assertGreater(seen, 20)

    def test_each_row_has_its_label_and_very_many_strokes_still_make_a_page(self):
        for what, svg in self.pictures("timing", counts=(10,), widths=(60,)):
            playing = {bar.get("data-row") for bar in svg.all("envelope")} or {b.get("data-tactor") for b in svg.all("bar", "sound")}
            self.assertEqual(len(svg.all("row-label")), len(playing), what)
        self.write("a.toml", ARRAYS["nine"][0])
        self.write("s.toml", "".join(f'[[stroke]]\nname = "s{i}"\npath = "M {i % 20} 0 L 40 {i % 40} L 0 40"\nstart_s = {i / 100}\n'
                                     for i in range(55)))
        svg = self.svg("s.toml", "--array", "a.toml")
        self.assertLess(float(svg.root.get("height")[:-2]), 250)
        self.assertIn("colours repeat after 10 strokes", " ".join(e.text for e in svg.all("note")))

    def test_the_strip_of_colours_has_a_unit_and_is_only_for_time(self):
        self.write("a.toml", ARRAYS["nine"][0])
        for count in (1, 3):
            self.write("s.toml", strokes(count, ARRAYS["nine"][1]))
            svg = self.svg("s.toml", "--array", "a.toml")
            self.assertNotIn("colour", svg.texts())
            self.assertEqual(svg.texts().count("time (s)"), 2 if count == 1 else 1)
            self.assertEqual([e.get("id") for e in svg.root.iter() if e.get("id") in ("time-colours", "strokes")],
                             ["time-colours" if count == 1 else "strokes"])


class Compare(PlotTest):
    def test_the_picture_has_a_scale_few_digits_and_little_advice(self):
        for width in WIDTHS:
            self.ok("compare", "--path", "M 5 5 C 20 -5 20 45 39 30", "--duration", "2.61799387", "-o", "c.svg", "--width", width)
            svg = Svg(self.dir / "c.svg")
            said = " ".join(svg.texts())
            self.assertIn("in 2.618 s", said)
            self.assertIn("refused", said)
            self.assertNotIn("--", said)
            mm = float(svg.id("scale-bar").get("data-mm"))
            bar = svg.all("bar", "scale-bar")[0]
            panel = [g for g in svg.all("panel") if g.get("data-algorithm") == "park2016"][0]
            first, second = [e for e in panel.iter() if e.get("class") == "tactor"][:2]
            self.near((number(bar, "x2") - number(bar, "x1")) / mm, (number(second, "cx") - number(first, "cx")) / 20, 0.01)


if __name__ == "__main__":
    main()
