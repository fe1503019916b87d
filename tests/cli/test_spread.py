# SPDX-License-Identifier: MIT
"""compare --spread: intervals of the sensations of different people, and their agreement with a calculation from the draw."""
import csv
import io
import json
import math
import xml.etree.ElementTree as ElementTree

from harness import ToolTest, main

SVG = "{http://www.w3.org/2000/svg}"
MASK = (1 << 64) - 1


class Draws:
    """Generates numbers by SplitMix64."""

    def __init__(self, seed):
        self.state = seed

    def part(self):
        self.state = (self.state + 0x9e3779b97f4a7c15) & MASK
        z = self.state
        z = ((z ^ (z >> 30)) * 0xbf58476d1ce4e5b9) & MASK
        z = ((z ^ (z >> 27)) * 0x94d049bb133111eb) & MASK
        return ((z ^ (z >> 31)) >> 11) * 2.0 ** -53


def people(n, seed, tactors, factor, db, mm):
    d = Draws(seed)
    for _ in range(n):
        sigma = factor ** (2 * d.part() - 1)
        each = []
        for _ in range(tactors):
            gain = 10 ** (db * (2 * d.part() - 1) / 20)
            turn = 2 * math.pi * d.part()
            away = mm * math.sqrt(d.part())
            each.append((gain, away * math.cos(turn), away * math.sin(turn)))
        yield sigma, each


def pulled(onsets, places, coupling):
    """Solves (I + K) x = m by Thomas."""
    n = len(onsets)
    k = [coupling(onsets[i + 1] - onsets[i]) for i in range(n - 1)]
    out = []
    for c in (0, 1):
        diagonal = [1 + (k[i - 1] if i else 0) + (k[i] if i < n - 1 else 0) for i in range(n)]
        right = [p[c] for p in places]
        for i in range(1, n):
            f = -k[i - 1] / diagonal[i - 1]
            diagonal[i] += f * k[i - 1]
            right[i] -= f * right[i - 1]
        x = [0.0] * n
        x[-1] = right[-1] / diagonal[-1]
        for i in range(n - 2, -1, -1):
            x[i] = (right[i] + k[i] * x[i + 1]) / diagonal[i]
        out.append(x)
    return list(zip(*out))


def quantile(values, part):
    values = sorted(values)
    at = part * (len(values) - 1)
    i = int(at)
    return values[i] + (at - i) * (values[min(i + 1, len(values) - 1)] - values[i])


class Spread(ToolTest):
    def compare(self, *args):
        return json.loads(self.ok("compare", *args, "--format", "json").stdout)

    def test_intervals_are_those_of_the_people_drawn(self):
        told = self.compare("park2016-1", "--algorithms", "park2016", "--observer", "low-speed", "--spread", "60",
                            "--spread-seed", "11", "--spread-sigma", "3", "--spread-threshold-db", "4", "--spread-place-mm", "1.5")
        self.assertEqual(told["spread"], {"people": 60, "seed": 11, "sigma_factor": 3, "threshold_db": 4, "place_mm": 1.5,
                                          "parts": [0.05, 0.95]})
        plan = self.plan("park2016-1")
        at = [(t["x_mm"], t["y_mm"]) for t in plan["array"]["tactors"]]
        onsets = [b["onset_s"] for b in plan["bursts"]]
        targets = [(b["x_mm"], b["y_mm"]) for b in plan["bursts"]]
        errors, ratios = [], []
        for sigma, each in people(60, 11, 9, 3, 4, 1.5):
            places = []
            for burst in plan["bursts"]:
                energy = [((d["amplitude"] * each[d["tactor"]][0]) ** 2, d["tactor"]) for d in burst["drives"]]
                total = sum(e for e, _ in energy)
                places.append(tuple(sum(e * (at[i][c] + each[i][1 + c]) for e, i in energy) / total for c in (0, 1)))
            felt = pulled(onsets, places, lambda t, s=sigma: (5 * s / (100 * t)) ** 2)
            errors.append(math.sqrt(sum(math.dist(a, b) ** 2 for a, b in zip(felt, targets)) / len(felt)))
            ratios.append(sum(map(math.dist, felt, felt[1:])) / sum(map(math.dist, targets, targets[1:])))
        got = told["results"][0]["spread"]
        for name, values in (("rms_error_mm", errors), ("length_ratio", ratios)):
            for end, part in zip(got[name], (0.05, 0.95)):
                self.assertAlmostEqual(end, quantile(values, part), delta=1e-6, msg=name)
        self.assertIsNone(got["speed_cv"])

    def test_people_without_differences_feel_the_table_s_values(self):
        for observer in ("centroid", "low-speed"):
            told = self.compare("park2016-3", "--observer", observer, "--spread", "3", "--spread-sigma", "1",
                                "--spread-threshold-db", "0", "--spread-place-mm", "0")
            for row in told["results"]:
                for name, ends in (row["spread"] or {}).items():
                    for end in ends or ():
                        self.assertAlmostEqual(end, row[name], 9, f"{observer} {row['algorithm']} {name}")
            self.assertEqual([row["spread"] is None for row in told["results"]], [False, False, observer == "low-speed"])

    def test_wider_ranges_give_wider_intervals_and_seeds_the_same_people(self):
        def interval(*more):
            return self.compare("park2016-1", "--algorithms", "park2016", "--spread", "100", *more)["results"][0]["spread"]
        narrow, wide = interval("--spread-place-mm", "0.5", "--spread-threshold-db", "1"), interval()
        for name in ("rms_error_mm", "speed_cv", "intensity_cv"):
            self.assertLess(narrow[name][1] - narrow[name][0], wide[name][1] - wide[name][0])
            self.assertLess(wide[name][0], wide[name][1])
        self.assertEqual(wide, interval("--spread-seed", "1"))
        self.assertNotEqual(wide, interval("--spread-seed", "2"))

    def test_text_and_csv_hold_the_same_and_state_the_ranges(self):
        for observer, figures in (("centroid", ("rms_error_mm", "largest_error_mm", "speed_cv", "intensity_cv")),
                                  ("low-speed", ("rms_error_mm", "largest_error_mm", "felt_length_mm", "length_ratio"))):
            args = ("park2016-1", "--observer", observer, "--spread", "20")
            rows = self.compare(*args)["results"]
            text = self.ok("compare", *args).stdout
            for word in ("20 people", "seed 1", "6 dB", "2 mm"):
                self.assertIn(word, text)
            self.assertEqual("sigma from 1/2 to 2" in text, observer == "low-speed")
            lines = [line.split() for line in text.splitlines() if line.lstrip().startswith(("5 %", "95 %"))]
            table = list(csv.DictReader(io.StringIO(self.ok("compare", *args, "--format", "csv").stdout)))
            spreads = [r["spread"] for r in rows if r["spread"]]
            self.assertEqual(len(lines), 2 * len(spreads))
            for i, spread in enumerate(spreads):
                for end in (0, 1):
                    self.assertEqual(lines[2 * i + end][2:], [f"{spread[f][end]:.3f}" for f in figures])
                    self.assertEqual([float(table[i][f + ("_05", "_95")[end]]) for f in figures],
                                     [spread[f][end] for f in figures])
            self.assertEqual((table[0]["people"], table[0]["seed"]), ("20", "1"))

    def test_the_picture_has_bands_and_ways(self):
        for observer in ("centroid", "low-speed"):
            self.ok("compare", "park2016-3", "--observer", observer, "--spread", "50", "-o", "c.svg")
            tree = ElementTree.parse(self.dir / "c.svg").getroot()
            algorithms = 3 if observer == "centroid" else 2
            bands = [e for e in tree.iter() if e.get("class") == "band"]
            self.assertEqual(len(bands), algorithms)
            self.assertEqual(len([e for e in tree.iter() if e.get("class") == "person"]), 40 * algorithms)
            chart = next(e for e in tree.iter() if e.get("class") == "chart")
            y0, scale = float(chart.get("data-y0")), float(chart.get("data-y-scale"))
            numbers = [float(n) for n in bands[0].get("points").replace(",", " ").split()]
            speeds = [(y - y0) / scale for y in numbers[1::2]]
            self.assertGreater(max(speeds) - min(speeds), 20)
            text = " ".join(t.text for t in tree.iter(SVG + "text"))
            for word in ("50 people", "seed 1", "6 dB"):
                self.assertIn(word, text)

    def test_wrong_usage_is_refused(self):
        for value in ("0", "1", "2.5", "1e9", "many"):
            self.refused(2, "compare", "park2016-1", "--spread", value)
        for option, value in (("--spread-seed", "-1"), ("--spread-sigma", "0.5"), ("--spread-threshold-db", "nan"),
                              ("--spread-place-mm", "-2")):
            self.refused(2, "compare", "park2016-1", "--spread", "5", f"{option}={value}", says=[option])
            self.refused(2, "compare", "park2016-1", option, "2")
        self.refused(2, "compare", "park2016-1", "--duration", "3600", "--spread", "100000", "-o", "c.svg", "--algorithms",
                     "park2016")


if __name__ == "__main__":
    main()
