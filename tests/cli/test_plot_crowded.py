# SPDX-License-Identifier: MIT
"""tactor plot: crowded pictures. Widths of text by the table of DejaVu Sans."""
import itertools

from harness import main
from pictures import NS, number
from sheets import ARRAYS, WIDTHS, Sheets, box, grid, overlap


class Crowded(Sheets):
    """Many strokes on 64 tactors: the picture reports what has no space, and fits one page."""
    PAGE_MM = 247.05  # of A4, rounding included

    def sheets(self, view="both"):
        self.write("a.toml", ARRAYS["64"][0])
        for count, gap in ((10, 0.3), (14, 0.1), (14, None)):
            self.write("s.toml", "".join(
                f'[[stroke]]\nname = "stroke {i + 1}"\npath = "M {12 * i % 200} {10 + 190 * i // count} C 63 0 126 210 {200 - 10 * i} '
                f'{10 + 190 * (3 * i % count) // count}"\nspeed_mm_s = 60.0\n' + (f"start_s = {gap * i}\n" if gap else "")
                for i in range(count)))
            for width in WIDTHS:
                yield (count, gap, width), self.svg("s.toml", "--array", "a.toml", "--width", width, "--view", view,
                                                    "--level-dbfs", "-20")

    def notes(self, svg):
        return " ".join(e.text for e in svg.all("note"))

    def test_it_fits_a_page(self):
        for what, svg in self.sheets():
            self.assertLessEqual(float(svg.root.get("height")[:-2]), self.PAGE_MM, what)

    def test_the_most_of_everything_fits_a_page(self):
        self.write("a.toml", grid(16, 16, 10))
        self.write("s.toml", "".join(f'[[stroke]]\nname = "one of very many strokes, number {i + 1}"\npath = "M 0 {2.5 * i} L 150 {2.5 * i}"\n'
                                     f"speed_mm_s = 60.0\nstart_s = {i / 100}\n" for i in range(60)))
        for view in ("both", "array", "timing", "wave"):
            for width in (*WIDTHS, 300):
                svg = self.svg("s.toml", "--array", "a.toml", "--width", width, "--view", view, "--level-dbfs", "-40")
                self.assertLessEqual(float(svg.root.get("height")[:-2]), self.PAGE_MM * max(1, width / 170), (view, width))

    def test_texts_are_complete(self):
        for what, svg in self.sheets():
            self.assertNotIn("\u2026", self.notes(svg), what)

    def test_each_row_has_its_number_and_each_bar_its_row(self):
        for what, svg in self.sheets():
            rows = sorted(number(e, "y1") for e in svg.all("row-line"))
            labels = svg.all("row-label")
            self.assertEqual(len(labels), len(rows), what)
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
