# SPDX-License-Identifier: MIT
"""Content of other programs: bHaptics' .tact files."""
import json
import math

from harness import Wav, main
from serving import ServeTest

SOA_S = 0.07
VEST = [{"index": 5 * row + column, "x": f"{column / 4:.3f}", "y": str(row / 3)[:5]} for row in range(4) for column in range(5)]
# Corners of an array that fills only a part of the box around it, and the same as lines of the array file.
DIAMOND = [(10.0, 0.0), (20.0, 10.0), (10.0, 20.0), (0.0, 10.0), (10.0, 10.0)]
DIAMOND_FILE = '[array]\nname = "d"\n' + "".join(f"[[tactor]]\ntactor = {i}\nchannel = {i}\nx_mm = {x}\ny_mm = {y}\n" for i, (x, y) in enumerate(DIAMOND))


def point(x, y, intensity=1.0, time=None):
    return {"x": x, "y": y, "intensity": intensity} | ({} if time is None else {"time": time})


def path(*points, fade="NONE"):
    return {"movingPattern": "CONST_TDM", "playbackType": fade, "pointList": list(points)}


def dots(start, end, *pairs, fade="NONE"):
    return {"startTime": start, "endTime": end, "playbackType": fade, "pointList": [{"index": i, "intensity": v} for i, v in pairs]}


def mode(name, paths=(), touches=()):
    return {"mode": name, "dotMode": {"dotConnected": False, "feedback": list(touches)}, "pathMode": {"feedback": list(paths)}}


def effect(start, duration, **modes):
    return {"name": "e", "startTime": start, "offsetTime": duration, "modes": modes}


def tact(*effects, enable=(), layouts=None):
    tracks = [{"enable": e, "effects": [one]} for e, one in zip([*enable, *[True] * len(effects)], effects)]
    return json.dumps({"project": {"name": "p", "tracks": tracks, "layout": {"type": "Vest", "layouts": layouts or {"VestBack": VEST, "VestFront": VEST}}},
                       "durationMillis": 0, "intervalMillis": 20, "size": 20})


SWEEP = path(point("0.333", 0, "0.5", "0"), point(0.667, 1, 0.5, 700), fade="FADE_OUT")
EVERYTHING = tact(
    effect("140", "1000",
           VestFront=mode("PATH_MODE", [SWEEP, path(), path(point(0.2, 0.9, 0.8, 0), fade="FADE_IN_OUT"),
                                        path(point(0, 0, 0.1, 100), point(0.5, 0.1, 0.9, 400), point(1, 1, 0.3, 1000), fade="FADE_IN")],
                          [dots(0, 900, (0, 1.0))]),  # what the editor left behind
           VestBack=mode("DOT_MODE", touches=[dots(0, 100, (1, 1))])),
    effect(2000, 500, VestFront=mode("DOT_MODE", [SWEEP], [dots(0, 350, (0, 0.4), ("19", "0.7"), fade="FADE_IN"), dots(100, 100, (3, 1)), dots(50, 200)])),
    effect(0, 500, VestFront=mode("DOT_MODE", touches=[dots(0, 500, (7, 1))])),
    enable=(True, "true", False))


def number(v):
    """A number, or a text with one; thirds as editors round them are meant as thirds."""
    return min((float(v), 1 / 3, 2 / 3), key=lambda c: (c != float(v) and abs(c - float(v)) > 0.001, c == float(v)))


def touches(text, position):
    """Yields start, length, and place and intensity over time of each touch: an independent reader of the format."""
    project = json.loads(text)["project"]
    fades = {"NONE": lambda u: 1, "FADE_IN": lambda u: u, "FADE_OUT": lambda u: 1 - u, "FADE_IN_OUT": lambda u: min(2 * u, 2 - 2 * u)}
    places = {int(p["index"]): p for p in project["layout"]["layouts"][position]}
    for e in (e for t in project["tracks"] if str(t["enable"]).lower() != "false" for e in t["effects"]):
        m = e["modes"].get(position, {"mode": ""})
        start = float(e["startTime"])
        for f in m["dotMode"]["feedback"] if m["mode"] == "DOT_MODE" else []:
            for p in f["pointList"]:
                knots = [(float(f[t]), places[int(p["index"])] | {"intensity": p["intensity"]}) for t in ("startTime", "endTime")]
                yield start, knots, fades[f["playbackType"]]
        for f in m["pathMode"]["feedback"] if m["mode"] == "PATH_MODE" else []:
            knots = [(float(p["time"]), p) for p in f["pointList"]]
            yield start, knots if len(knots) != 1 else [(0, knots[0][1]), (float(e["offsetTime"]), knots[0][1])], fades[f["playbackType"]]


def bursts(text, position, side_mm):
    """All bursts of park2016: onset, x, y and intensity, on an array whose box has this side."""
    for start, knots, fade in touches(text, position):
        if not knots or knots[-1][0] <= knots[0][0]:
            continue
        first, last = knots[0][0], knots[-1][0]
        for k in range(math.floor((last - first) / 1e3 / SOA_S + 1e-9) + 1):
            t = min(first + k * SOA_S * 1e3, last)
            (t0, a), (t1, b) = next((p, q) for p, q in zip(knots, knots[1:]) if t <= q[0])
            u = (t - t0) / (t1 - t0)
            x, y, v = (number(a[n]) + u * (number(b[n]) - number(a[n])) for n in ("x", "y", "intensity"))
            yield (start + first) / 1e3 + k * SOA_S, side_mm * x, side_mm * y, v * fade((t - first) / (last - first))


class Tact(ServeTest):
    def planned(self, *args):
        plan = self.plan(*args)
        return sorted((p["start_s"] + b["onset_s"], b["x_mm"], b["y_mm"], b["intensity"]) for p in plan.get("plans", [plan]) for b in p["bursts"])

    def check(self, expected, planned, places=9):
        expected = sorted(expected)
        self.assertEqual(len(planned), len(expected))
        self.assertGreater(len(expected), 0)
        for burst, wanted in zip(planned, expected):
            for a, b in zip(burst, wanted):
                self.assertAlmostEqual(a, b, places)

    def warnings(self, *args):
        lines = self.ok("plan", *args, "--format", "csv").stderr.splitlines()
        return [line for line in lines if ".tact" in line and "weakened" not in line]

    def test_bursts_are_those_of_an_independent_reader(self):
        self.write("e.tact", EVERYTHING)
        # Straight pieces stand for the product of a fade and an intensity that both change.
        self.check(bursts(EVERYTHING, "VestFront", 40.0), self.planned("e.tact"), 3)
        self.check(bursts(EVERYTHING, "VestBack", 40.0), self.planned("e.tact", "--position", "VestBack"))
        steady = tact(effect(0, 700, VestFront=mode("PATH_MODE", [SWEEP])), effect(30, 350, VestFront=mode("DOT_MODE", touches=[dots(0, 350, (0, 0.4), fade="FADE_IN_OUT")])))
        self.write("s.tact", steady)
        self.check(bursts(steady, "VestFront", 40.0), self.planned("s.tact"))
        self.assertEqual([b[1] for b in self.planned("s.tact")][0], 40 * (1 / 3))  # 0.333 is a third

    def test_the_front_plays_first_and_the_left(self):
        touch = mode("DOT_MODE", touches=[dots(0, 300, (0, 1))])
        layouts = dict.fromkeys(("VestBack", "VestFront", "Right", "Left", "HandR", "HandL", "Head"), VEST)
        for names, first in ((("VestBack", "VestFront"), "VestFront"), (("Right", "Left"), "Left"), (("HandR", "HandL"), "HandL"), (("Left", "VestBack"), "VestBack")):
            for order in (names, names[::-1]):
                self.write("o.tact", tact(effect(0, 300, **dict.fromkeys(order, touch)), layouts=layouts))
                other = next(n for n in names if n != first)
                self.assertEqual(self.warnings("o.tact"), [f"tactor: warning: o.tact: only {first} plays; the option position chooses {other}"])
                self.assertEqual(self.warnings("o.tact", "--position", other), [])
        self.refused(2, "plan", "o.tact", "--position", "Neck", says=["use one of VestBack, Left"])
        self.write("l.toml", '[stroke]\npath = "M 0 0 L 40 0"\n')
        self.refused(2, "plan", "l.toml", "--position", "VestFront", says=["--position"])
        self.refused(2, "plan", "park2016-1", "--position", "VestFront", says=["--position"])
        # A place whose lists are empty, or whose live mode is, has no touches.
        self.write("f.tact", tact(effect(0, 300, VestFront=mode("PATH_MODE", [path()], [dots(0, 300, (0, 1))]), VestBack=touch)))
        self.assertEqual(self.warnings("f.tact"), [])

    def test_a_point_outside_the_hull_moves_to_its_edge(self):
        self.write("d.toml", DIAMOND_FILE)
        self.write("c.tact", tact(effect(0, 300, VestFront=mode("PATH_MODE", [path(point(0, 0, 1, 0), point(1.5, 0.5, 1, 280))]))))
        (_, x0, y0, _), *_, (_, x1, y1, _) = self.planned("c.tact", "--array", "d.toml")
        for v, w in zip((x0, y0, x1, y1), (5, 5, 20, 10)):  # the middle of the diamond's upper left edge, and its right corner
            self.assertAlmostEqual(v, w, 9)
        self.write("line.toml", '[array]\nname = "l"\ngrid = { rows = 1, columns = 3, pitch_mm = 10.0 }\n')
        self.write("one.toml", '[array]\nname = "o"\ngrid = { rows = 1, columns = 1, pitch_mm = 10.0 }\n')
        self.assertEqual({y for _, x, y, _ in self.planned("c.tact", "--array", "line.toml")}, {0})
        self.assertEqual({(x, y) for _, x, y, _ in self.planned("c.tact", "--array", "one.toml")}, {(0, 0)})

    def test_short_paths_are_told(self):
        short = path(point(0, 0, 1, 0), point(1, 1, 1, 139))
        self.write("p.tact", tact(effect(0, 500, VestFront=mode("PATH_MODE", [short, path(point(0, 0, 1, 0), point(1, 1, 1, 140)), path(point(0, 0, 1, 0))]))))
        self.assertEqual(self.warnings("p.tact"), ["tactor: warning: p.tact: 1 path is shorter than 140 ms, of which park2016 makes two bursts"])
        self.write("q.tact", tact(effect(0, 500, VestFront=mode("PATH_MODE", [short, short]))))
        self.assertEqual(self.warnings("q.tact"), ["tactor: warning: q.tact: 2 paths are shorter than 140 ms, of which park2016 makes two bursts"])

    def test_touches_that_overlap_are_weakened_together(self):
        """Three touches at one tactor, in phase: 3 times the level, so 1 / 3 for the whole piece."""
        layouts = {"VestFront": [{"index": i, "x": 0.5, "y": 0.5} for i in range(3)] + [{"index": 3, "x": 0, "y": 0}]}
        self.write("t.tact", tact(effect(0, 700, VestFront=mode("DOT_MODE", touches=[dots(0, 700, (0, 1), (1, 1), (2, 1)), dots(1400, 2000, (3, 1))])), layouts=layouts))
        self.ok("render", "t.tact", "-o", "t.wav", "--level-dbfs", "-20")
        samples = Wav(self.dir / "t.wav").samples()
        peaks = [max(abs(frame[c]) for frame in samples) for c in (4, 0)]
        self.assertAlmostEqual(peaks[0], 0.1, 3)
        self.assertAlmostEqual(peaks[1], 0.1 / 3, 3)

    def test_every_command_and_the_service_play_it(self):
        self.write("e.tact", EVERYTHING)
        wanted = self.planned("e.tact")
        for command in (("render", "-o", "o.wav"), ("plot", "-o", "o.svg"), ("play", "-D", "null")):
            self.ok(command[0], "e.tact", *command[1:])
        self.ok("compare", "e.tact")
        piped = json.loads(self.ok("plan", "-", "--format", "json", stdin=EVERYTHING).stdout)
        self.assertEqual(sum(len(p["bursts"]) for p in piped["plans"]), len(wanted))
        c = self.serve().client()
        for position in ({}, {"position": "VestBack"}):
            played = c.ok("plan", tact=EVERYTHING, options=position)
            self.assertEqual(sum(len(p["bursts"]) for p in played.get("plans", [played])), len(wanted) if not position else 2)
            read = c.ok("import", name="e.tact", text=EVERYTHING, **position)
            self.assertEqual(len(read["strokes"]), len(piped["plans"]) if not position else 1)
            self.write("again.toml", read["toml"])
            self.check(wanted if not position else self.planned("e.tact", "--position", "VestBack"), self.planned("again.toml"))
        self.assertIn("VestBack", c.ok("import", name="e.tact", text=EVERYTHING)["warnings"][0])

    def test_what_cannot_be_read_is_refused(self):
        good = effect(0, 300, VestFront=mode("DOT_MODE", touches=[dots(0, 300, (0, 1))]))
        for name, text, says in (
                ("deep", '{"project":' + "[" * 100 + "]" * 100 + "}", "nested"),
                ("half", EVERYTHING[:-40], "it is not JSON"),
                ("empty", "{}", "project"),
                ("silent", tact(good, enable=(False,)), "nothing plays"),
                ("no time", tact(effect(0, 0, VestFront=mode("PATH_MODE", [path(point(0, 0, 1, 0))]))), "duration"),
                ("nan", tact(good).replace('"index": 0, "intensity": 1', '"index": 0, "intensity": "nan"'), "intensity"),
                ("words", tact(good).replace('"index": 0, "intensity": 1', '"index": 0, "intensity": "half"'), "it is not a number"),
                ("loud", tact(good).replace('"index": 0, "intensity": 1', '"index": 0, "intensity": 100'), "intensity"),
                ("early", tact(good).replace('"startTime": 0', '"startTime": -5'), "startTime"),
                ("late", tact(good).replace('"endTime": 300', '"endTime": 1e300'), "endTime"),
                ("huge", tact(good).replace('"endTime": 300', '"endTime": 1e999'), "it is not JSON"),
                ("back", tact(effect(0, 300, VestFront=mode("PATH_MODE", [path(point(0, 0, 1, 300), point(1, 1, 1, 100))]))), "ascending"),
                ("away", tact(effect(0, 300, VestFront=mode("PATH_MODE", [path(point(0, 0, 1, 0), point("1e9", 1, 1, 300))]))), "x"),
                ("place", tact(good, layouts={"VestFront": VEST[1:]}), "layouts.VestFront has no 0"),
                ("fade", tact(good).replace('"NONE"', '"FADE"'), "one of NONE, FADE_IN"),
                ("mode", tact(good).replace('"DOT_MODE"', '"DOT"'), "DOT_MODE or PATH_MODE")):
            self.write(f"{name}.tact", text)
            self.refused(2, "plan", f"{name}.tact", says=[f"{name}.tact", says])
        with open(self.dir / "long.tact", "wb") as f:
            f.truncate(500 << 20)
        self.refused(2, "plan", "long.tact", says=["longer than 16 MB"])


if __name__ == "__main__":
    main()
