# SPDX-License-Identifier: MIT
"""Arrays and strokes of all sizes in pictures of all widths, and the places of their texts."""
import math

from pictures import PlotTest, number

WIDTHS = (60, 85, 170)
CAP = 0.73
ADVANCE = {" ": 0.318, "(": 0.39, ")": 0.39, ",": 0.318, "c": 0.55, "h": 0.634, "s": 0.521, "t": 0.392, "a": 0.613,
           "r": 0.411, "e": 0.615, "n": 0.634, "d": 0.635, "k": 0.579, "o": 0.612, "u": 0.634, "v": 0.592, "w": 0.818,
           "p": 0.635, "l": 0.278, "f": 0.352, "i": 0.278, "g": 0.635}
PLACES = [(0, 0), (17, -3), (38, 2), (55, 8), (-4, 22), (14, 25), (33, 19), (60, 27), (2, 47), (22, 44), (41, 50), (58, 45)]


def grid(rows, columns, pitch):
    return f'[array]\nname = "grid"\ngrid = {{ rows = {rows}, columns = {columns}, pitch_mm = {pitch}.0 }}\n'


def irregular():
    return '[array]\nname = "sleeve"\n' + "".join(
        f"[[tactor]]\nx_mm = {x}.0\ny_mm = {y}.0\nchannel = {i * 5 % 12}\n" for i, (x, y) in enumerate(PLACES))


# Text of the array file, and a rectangle inside the array.
ARRAYS = {"nine": (grid(3, 3, 20), (0, 0, 40, 40)), "twelve": (irregular(), (2, 4, 52, 40)),
          "24": (grid(4, 6, 25), (0, 0, 125, 75)), "64": (grid(8, 8, 30), (0, 0, 210, 210))}


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


def box(e):
    """Returns left, top, right and bottom of a text."""
    size = number(e, "font-size")
    width = size * sum(ADVANCE.get(c, 0.636) for c in e.text)
    left = number(e, "x") - {"middle": width / 2, "end": width}.get(e.get("text-anchor"), 0)
    return left, number(e, "y") - CAP * size, left + width, number(e, "y")


def overlap(a, b):
    return min(a[2], b[2]) - max(a[0], b[0]) > 0.01 and min(a[3], b[3]) - max(a[1], b[1]) > 0.01


def distance(b, x, y):
    return math.hypot(max(b[0] - x, x - b[2], 0), max(b[1] - y, y - b[3], 0))


class Sheets(PlotTest):
    def pictures(self, view, counts=(1, 3, 10), widths=WIDTHS):
        for name, (text, where) in ARRAYS.items():
            self.write("a.toml", text)
            for count in counts:
                self.write("s.toml", strokes(count, where))
                for width in widths:
                    yield (name, count, width), self.svg("s.toml", "--array", "a.toml", "--width", width, "--view", view)
