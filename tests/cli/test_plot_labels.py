# SPDX-License-Identifier: MIT
"""tactor plot and compare: each label is nearest to its object, strokes can be told apart, and what has no space is reported: on small
and large arrays, narrow and wide pages."""
import itertools
import math

from harness import main
from pictures import NS, PlotTest, Svg, box, distance, number, overlap

WIDTHS = (60, 170)
PLACES = [(0, 0), (17, -3), (38, 2), (55, 8), (-4, 22), (14, 25), (33, 19), (60, 27), (2, 47), (22, 44), (41, 50), (58, 45)]


def grid(rows, columns, pitch):
    return f'[array]\nname = "grid"\ngrid = {{ rows = {rows}, columns = {columns}, pitch_mm = {pitch}.0 }}\n'


def irregular():
    return '[array]\nname = "sleeve"\n' + "".join(
        f"[[tactor]]\nx_mm = {x}.0\ny_mm = {y}.0\nchannel = {i * 5 % 12}\n" for i, (x, y) in enumerate(PLACES))


# Text of the array file, and a rectangle inside the array.
ARRAYS = {"nine": (grid(3, 3, 20), (0, 0, 40, 40)), "twelve": (irregular(), (2, 4, 52, 40)),
          "64": (grid(8, 8, 30), (0, 0, 210, 210))}


def strokes(count, where):
    """Returns curves over the whole array, the third closed and on tactors; three at once, ten in a row."""
    x, y, w, h = where
    def at(u, v):
        return f"{x + u * w:.1f} {y + v * h:.1f}"
    paths = [("curve", f"M {at(.05, .5)} C {at(.3, 0)} {at(.6, 1)} {at(.95, .4)}"),
             ("sweep left", f"M {at(.9, .9)} L {at(.1, .8)}"),
             ("ring", f"M {at(.3, .3)} L {at(.7, .3)} L {at(.7, .7)} L {at(.3, .7)} Z")]
    if count == 10:
        paths = [(f"stroke {chr(97 + i)}", f"M {at(.1 + .02 * i, .05 + .09 * i)} L {at(.9 - .03 * i, .05 + .095 * (i * 3 % 10))}")
                 for i in range(10)]
    return "\n".join(f'[[stroke]]\nname = "{n}"\npath = "{p}"\nspeed_mm_s = 60.0\n' +
                     (f"start_s = {0.3 * i}\n" if count == 3 else "") for i, (n, p) in enumerate(paths[:count]))


class Sheets(PlotTest):
    def pictures(self, view, counts=(3, 10), widths=WIDTHS):
        for name in ("nine", "64"):
            text, where = ARRAYS[name]
            self.write("a.toml", text)
            for count in counts:
                self.write("s.toml", strokes(count, where))
                for width in widths:
                    yield (name, count, width), self.svg("s.toml", "--array", "a.toml", "--width", width, "--view", view)


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
        self.assertLessEqual(len(without), 1, without)  # where bursts crowd on the narrowest page

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
        for what, svg in self.pictures("both"):
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


class Crowded(Sheets):
    """Many strokes on 64 tactors: the picture reports what has no space, and fits one page."""
    PAGE_MM = 247.05  # of A4, rounding included

    def sheets(self, view="both"):
        self.write("a.toml", ARRAYS["64"][0])
        for count, gap in ((10, 0.3), (14, None)):
            self.write("s.toml", "".join(
                f'[[stroke]]\nname = "stroke {i + 1}"\npath = "M {12 * i % 200} {10 + 190 * i // count} C 63 0 126 210 {200 - 10 * i} '
                f'{10 + 190 * (3 * i % count) // count}"\nspeed_mm_s = 60.0\n' + (f"start_s = {gap * i}\n" if gap else "")
                for i in range(count)))
            for width in WIDTHS:
                yield (count, gap, width), self.svg("s.toml", "--array", "a.toml", "--width", width, "--view", view,
                                                    "--level-dbfs", "-20")

    def notes(self, svg):
        return " ".join(e.text for e in svg.all("note"))

    def test_the_most_of_everything_fits_a_page(self):
        self.write("a.toml", grid(16, 16, 10))
        self.write("s.toml", "".join(f'[[stroke]]\nname = "one of very many strokes, number {i + 1}"\npath = "M 0 {2.5 * i} L 150 {2.5 * i}"\n'
                                     f"speed_mm_s = 60.0\nstart_s = {i / 100}\n" for i in range(60)))
        for width in (60, 300):
            svg = self.svg("s.toml", "--array", "a.toml", "--width", width, "--level-dbfs", "-40")
            self.assertLessEqual(float(svg.root.get("height")[:-2]), self.PAGE_MM * max(1, width / 170), width)

    def test_it_fits_a_page_and_each_row_has_its_number_and_each_bar_its_row(self):
        for what, svg in self.sheets():
            rows = sorted(number(e, "y1") for e in svg.all("row-line"))
            labels = svg.all("row-label")
            self.assertEqual(len(labels), len(rows), what)
            self.assertLessEqual(float(svg.root.get("height")[:-2]), self.PAGE_MM, what)
            self.assertNotIn("\u2026", self.notes(svg), what)
            tops = [float(svg.id("timing").get("data-top")), *rows]
            for e, (top, bottom) in zip(labels, zip(tops, rows)):
                self.assertTrue(top < (box(e)[1] + box(e)[3]) / 2 < bottom, (what, e.text))
            for a, b in itertools.combinations(labels, 2):
                self.assertFalse(overlap(box(a), box(b)), (what, a.text, b.text))
            for bar in svg.all("bar", "sound"):
                i = [e.text for e in labels].index(bar.get("data-tactor"))
                self.assertGreaterEqual(number(bar, "y"), tops[i] - 0.01, what)
                self.assertLessEqual(number(bar, "y") + number(bar, "height"), rows[i] + 0.01, what)

    def test_each_start_has_its_number_or_the_rest_is_counted(self):
        for view in ("timing", "wave"):
            for what, svg in self.sheets(view):
                texts = svg.id("stroke-starts").findall(NS + "text")
                shown = [n for e in texts for n in e.text.replace("stroke ", "").split(", ")]
                self.assertEqual(len(set(shown)), len(shown), what)
                missing = what[0] - len(shown)
                if missing:
                    self.assertIn(f"no space for the start's number of {missing} stroke", self.notes(svg), what)
                self.assertLessEqual(missing, 2 if what[2] == 60 else 0, what)
                for a, b in itertools.combinations(texts, 2):
                    self.assertFalse(overlap(box(a), box(b)), (what, a.text, b.text))

    def test_a_tactor_that_plays_is_joined_to_a_burst_or_reported_as_left_out(self):
        seen = 0
        for what, svg in self.sheets("array"):
            joined = {e.get("data-tactor") for e in svg.all("join")}
            others = [g.get("data-tactor") for g in svg.all("tactor")
                      if g.find(NS + "circle").get("stroke") == "#222222" and g.get("data-tactor") not in joined]
            seen += len(others)
            if others:
                who = f"tactor{'s' if len(others) > 1 else ''} {', '.join(others)}"
                self.assertIn(f"{who if len(others) <= 8 else f'{len(others)} tactors'} play", self.notes(svg), what)
        self.assertGreater(seen, 0)

    def test_of_very_many_rows_the_numbered_ones_are_stated(self):
        self.write("a.toml", grid(10, 10, 10))
        path = " ".join(f"{'M' if y == 0 else 'L'} 0 {y} L 90 {y} L 90 {y + 5} L 0 {y + 5}" for y in range(0, 91, 10))
        for view in ("timing", "wave"):
            svg = self.svg("--path", path, "--array", "a.toml", "--outside", "clamp", "--view", view)
            shown = [int(e.text) for e in svg.all("row-label")]
            self.assertEqual(shown, list(range(0, 100, shown[1])))
            self.assertIn(f"one row in {shown[1]} has its number", self.notes(svg))
        self.assertIn("no space for the peaks of rows", self.notes(svg))
        self.assertEqual(svg.all("peak"), [])

    def test_strokes_that_start_together_are_numbered_within_the_page(self):
        self.write("a.toml", ARRAYS["nine"][0])
        for count in (30, 61):
            self.write("s.toml", "".join(f'[[stroke]]\npath = "M {i / 2} 0 L 40 40"\nstart_s = 0\n' for i in range(count)))
            svg = self.svg("s.toml", "--array", "a.toml", "--width", "60", "--view", "timing")
            if count == 30:
                (text,) = svg.id("stroke-starts").findall(NS + "text")
                self.assertEqual(text.text, "stroke 1-30")
            else:
                self.assertIn("starts of more than 60 strokes are not marked", self.notes(svg))
                self.assertIn("strokes on one tactor lie on each other", self.notes(svg))


if __name__ == "__main__":
    main()
