# SPDX-License-Identifier: MIT
"""Readers of the tool's pictures: SVG by its groups and their scales, PNG pixel by pixel."""
import contextlib
import re
import struct
import xml.etree.ElementTree as ET
import zlib

from harness import ToolTest

NS = "{http://www.w3.org/2000/svg}"
# Advances of DejaVu Sans, the widest of the usual fonts.
CAP = 0.73
ADVANCE = {" ": 0.318, "(": 0.39, ")": 0.39, ",": 0.318, "c": 0.55, "h": 0.634, "s": 0.521, "t": 0.392, "a": 0.613,
           "r": 0.411, "e": 0.615, "n": 0.634, "d": 0.635, "k": 0.579, "o": 0.612, "u": 0.634, "v": 0.592, "w": 0.818,
           "p": 0.635, "l": 0.278, "f": 0.352, "i": 0.278, "g": 0.635}
BRUSH = ["--algorithm", "tactile-brush", "--snap", "--drop-points"]


class Svg:
    """A picture of the tool."""

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
        """Returns the place on the page of a place on the skin, pt."""
        g = self.id("array")
        s = float(g.get("data-mm-scale"))
        return float(g.get("data-x0")) + s * x_mm, float(g.get("data-y0")) + s * y_mm

    def time(self, t_s, group="timing"):
        g = self.id(group)
        return float(g.get("data-x0")) + float(g.get("data-x-scale")) * t_s


def read_bars(panel):
    """Maps the group and series of each bar to the value of its end, which is above 0, and to both ends of its error bar."""
    y0, ky = number(panel, "data-y0"), number(panel, "data-y-scale")
    bars, errors = ([e for e in panel.iter() if e.get("class") == kind] for kind in ("bar", "error"))
    return {(bar.get("data-group"), bar.get("data-series")): ((number(bar, "y") - y0) / ky, sorted((number(error, y) - y0) / ky for y in ("y1", "y2")))
            for bar, error in zip(bars, errors, strict=True)}


def number(e, name):
    return float(e.get(name))


def box(e):
    """Returns left, top, right and bottom of a text."""
    size = number(e, "font-size")
    width = size * sum(ADVANCE.get(c, 0.636) for c in e.text)
    left = number(e, "x") - {"middle": width / 2, "end": width}.get(e.get("text-anchor"), 0)
    return left, number(e, "y") - CAP * size, left + width, number(e, "y")


def overlap(a, b):
    return min(a[2], b[2]) - max(a[0], b[0]) > 0.01 and min(a[3], b[3]) - max(a[1], b[1]) > 0.01


class Png:
    """A decoded PNG with 8-bit RGB."""

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


class PlotTest(ToolTest):
    def svg(self, *args, **more):
        self.ok("plot", *args, "-o", "a.svg", **more)
        return Svg(self.dir / "a.svg")

    def near(self, a, b, tolerance=0.002):
        self.assertLessEqual(abs(a - b), tolerance, f"{a} is not {b}")


def pdf_size(data):
    """Returns width and height of a PDF's page, in points. Newer versions of cairo compress the objects."""
    streams = []
    for stream in re.findall(rb"stream\r?\n(.*?)endstream", data, re.S):
        with contextlib.suppress(zlib.error):
            streams.append(zlib.decompressobj().decompress(stream))
    box = re.search(rb"/MediaBox\s*\[\s*0 0 ([0-9.]+) ([0-9.]+)\s*\]", b"\n".join([data, *streams]))
    return float(box[1]), float(box[2])
