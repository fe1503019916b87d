# SPDX-License-Identifier: MIT
"""Content of other programs: .tact, .haptic and AHAP files."""
import json
import math

from harness import ToolTest, Wav, main
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

    def test_a_muted_track_is_not_played(self):
        touch = mode("DOT_MODE", touches=[dots(0, 300, (0, 1))])
        for muted in (False, "false", "False"):
            self.write("m.tact", tact(effect(0, 300, VestFront=touch), effect(400, 100, VestFront=touch), enable=[muted]))
            self.assertEqual([p["start_s"] for p in self.plan("m.tact")["plans"]] if "plans" in self.plan("m.tact") else [self.plan("m.tact")["start_s"]], [0.4])
        self.write("m.tact", tact(effect(0, 300, VestFront=touch), enable=["no"]))
        self.refused(2, "plan", "m.tact", says=["enable", "neither true nor false"])

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
                ("place", tact(good, layouts={"VestFront": VEST[1:]}), "0 is not an index in project.layout.layouts.VestFront"),
                ("fade", tact(good).replace('"NONE"', '"FADE"'), "one of NONE, FADE_IN"),
                ("mode", tact(good).replace('"DOT_MODE"', '"DOT"'), "DOT_MODE or PATH_MODE")):
            self.write(f"{name}.tact", text)
            self.refused(2, "plan", f"{name}.tact", says=[f"{name}.tact", says])


RATE = 48000
LEVEL = ("--level-dbfs", "0")
POINT = ("--path", "M 20 20")


def haptic(amplitude, frequency=None, version=1):
    def points(name, pairs):
        return [{"time": p[0], name: p[1]} | ({"emphasis": {"amplitude": p[2], "frequency": p[3]}} if len(p) > 2 else {}) for p in pairs]
    envelopes = {"amplitude": points("amplitude", amplitude)} | ({} if frequency is None else {"frequency": points("frequency", frequency)})
    return json.dumps({"version": {"major": version, "minor": 0, "patch": 0}, "metadata": {"author": "by hand"}, "signals": {"continuous": {"envelopes": envelopes}}})


def ahap(*pattern, **more):
    return json.dumps({"Version": 1.0, "Pattern": list(pattern)} | more)


def event(kind, time, duration=None, intensity=None, sharpness=None):
    values = [{"ParameterID": f"Haptic{n}", "ParameterValue": v} for n, v in (("Intensity", intensity), ("Sharpness", sharpness)) if v is not None]
    return {"Event": {"Time": time, "EventType": kind, "EventParameters": values} | ({} if duration is None else {"EventDuration": duration})}


def curve(name, time, *points):
    return {"ParameterCurve": {"ParameterID": name, "Time": time, "ParameterCurveControlPoints": [{"Time": t, "ParameterValue": v} for t, v in points]}}


class Vibrations(ToolTest):
    def render(self, *args):
        """The samples of the middle tactor of palm-3x3."""
        self.ok("render", *args, *LEVEL, "--force", "-o", "v.wav", "--attack", "0", "--release", "0")
        return [frame[4] for frame in Wav(self.dir / "v.wav").samples()]

    def texture(self, text, *args, name="t.haptic"):
        self.write(name, text)
        return self.render(*POINT, "--waveform", name, *args)

    def peak(self, samples, at_s, window_s=0.02):
        return max(map(abs, samples[round(at_s * RATE):round((at_s + window_s) * RATE)]))

    def hertz(self, samples, from_s, to_s):
        """Frequency by the places where the samples rise through 0, between two of them."""
        part = samples[round(from_s * RATE):round(to_s * RATE)]
        rises = [i + a / (a - b) for i, (a, b) in enumerate(zip(part, part[1:])) if a < 0 <= b]
        return (len(rises) - 1) * RATE / (rises[-1] - rises[0])

    def test_amplitude_and_frequency_are_linear_and_the_last_point_is_the_end(self):
        x = self.texture(haptic([(0, 0.2), (0.5, 0.6), (0.5, 0.1), (1.0, 0.3)], [(0, 0), (0.5, 0), (0.5, 1), (0.8, 1)]))
        self.assertEqual(len(x), RATE)
        for at, wanted in ((0.1, 0.28), (0.4, 0.52), (0.6, 0.14), (0.9, 0.26)):
            self.assertAlmostEqual(self.peak(x, at - 0.01), wanted, delta=0.012)
        self.assertAlmostEqual(self.hertz(x, 0.02, 0.48), 55, delta=0.05)
        self.assertAlmostEqual(self.hertz(x, 0.52, 0.98), 200, delta=0.2)
        for missing in (None, []):
            self.assertAlmostEqual(self.hertz(self.texture(haptic([(0, 1), (1, 1)], missing)), 0, 1), 127.5, delta=0.1)

    def test_an_emphasis_is_the_published_one_and_ducks_the_rest(self):
        for frequency, hz, lasts in ((0.0, 55, 0.027), (1.0, 130, 0.020), (0.5, 92.5, 0.0235)):
            x = self.texture(haptic([(0, 0), (0.3, 0, 0.8, frequency), (0.6, 0)]))
            sounding = [n / RATE for n, v in enumerate(x) if abs(v) > 1e-6]
            self.assertAlmostEqual(sounding[0], 0.3, delta=2e-4)
            self.assertAlmostEqual(sounding[-1], 0.3 + lasts, delta=3e-4)
            for n, v in enumerate(x[round(0.3 * RATE):round((0.3 + lasts) * RATE)]):
                turns = hz * n / RATE % 1
                if min(turns, abs(turns - 0.5), 1 - turns) > 0.01:  # beside the steps of the square
                    self.assertAlmostEqual(v, 0.8 * ((1 - frequency) * math.sin(2 * math.pi * turns) + frequency * (1 if turns < 0.5 else -1)), delta=2e-4)
        x = self.texture(haptic([(0, 0.6), (0.3, 0.6, 0, 0), (0.6, 0.6)]))
        self.assertAlmostEqual(self.peak(x, 0.302, 0.022), 0.3, delta=0.002)
        self.assertAlmostEqual(self.peak(x, 0.33), 0.6, delta=0.002)
        loud = self.texture(haptic([(0, 1), (0.3, 1, 1, 0), (0.6, 1)]))
        self.assertLessEqual(max(map(abs, loud)), 1.0)
        self.assertAlmostEqual(max(map(abs, loud)), 1.0, delta=0.001)

    def test_an_actuators_own_numbers_replace_them(self):
        text = haptic([(0, 1), (0.3, 1, 0, 1), (0.6, 1)], [(0, 0), (0.3, 0), (0.3, 1), (0.6, 1)])
        self.write("c.toml", "[texture]\nlow_hz = 100\nhigh_hz = 300\nducking = 0.25\nemphasis_high_s = 0.05\n")
        self.write("a.acf", """{ // of somebody's device
            metadata: { version: "1.0.0", device: 'It\\'s', },
            continuous: { gain: .5, emphasis_ducking: 0.25, frequency_min: 100.0, frequency_max: 300, },
            emphasis: { gain: +1., fade_out_percent: 50, frequency_min: { output_frequency: 60, duration_ms: 30, shape: 'sine' },
                        frequency_max: { output_frequency: 120, duration_ms: 50, shape: "saw" } } }""")
        self.write("f.toml", '[texture]\nacf = "a.acf"\n')
        for config, gain in (("c.toml", 1.0), ("f.toml", 0.5)):
            x = self.texture(text, "--config", config)
            self.assertAlmostEqual(self.hertz(x, 0.01, 0.29), 100, delta=0.1)
            self.assertAlmostEqual(self.hertz(x, 0.36, 0.59), 300, delta=0.5)
            self.assertAlmostEqual(self.peak(x, 0.31, 0.035), 0.25 * gain, delta=0.003)
            self.assertAlmostEqual(self.peak(x, 0.355), gain, delta=0.003)
        # An emphasis alone, a sawtooth with a tooth at half a cycle, loses half of its strength.
        self.write("f.toml", '[texture]\nacf = "a.acf"\nemphasis_high_wave = "square"\n')
        x = self.texture(haptic([(0, 0), (0.3, 0, 0.8, 1), (0.6, 0)]), "--config", "f.toml")
        for at in (0.301, 0.326, 0.349):
            self.assertAlmostEqual(self.peak(x, at, 0.0008), 0.8 * (1 - 0.5 * (at - 0.3) / 0.05), delta=0.01)
        self.write("f.toml", "[texture]\nfade_out = 1\n")
        last = self.plan("t.haptic", "--config", "f.toml")["plans"][-1]["continuous"]["points"][-1]
        self.assertAlmostEqual(last["intensity"], 0)
        self.write("bad.toml", '[texture]\nacf = "none.acf"\n')
        self.refused(2, "plan", "park2016-1", "--config", "bad.toml", says=["none.acf"])
        self.write("bad.toml", "[texture]\ngain = 2\n")
        self.refused(2, "plan", "park2016-1", "--config", "bad.toml", says=["gain"])

    def test_a_touch_that_rests_is_continuous_for_any_duration(self):
        self.write("t.haptic", haptic([(0, 1), (0.5, 1)]))
        for more, lasts in (((), 0.5), (("--duration", "3"), 3)):
            told = json.loads(self.ok("plan", *POINT, "--waveform", "t.haptic", *more, "--format", "json").stdout)
            self.assertEqual((told["algorithm"], told["stroke"]["duration_s"]), ("continuous", lasts))

    def test_along_a_stroke_by_time_and_by_length(self):
        """By length the envelope follows the way, and the frequency stays."""
        self.write("t.haptic", haptic([(0, 0), (0.25, 1), (0.5, 0)], [(0, 0), (0.5, 0)]))
        line = ("--path", "M 0 20 L 40 20", "--duration", "2", "--algorithm", "continuous", "--phantom", "barycentric", "--waveform", "t.haptic", "--texture")
        energy = {}
        for how in ("time", "length"):
            self.ok("render", *line, how, *LEVEL, "--force", "-o", "v.wav")
            frames = Wav(self.dir / "v.wav").samples()
            energy[how] = [math.sqrt(max(sum(v * v for v in f) for f in frames[n:n + RATE // 50])) for n in range(0, 2 * RATE, RATE // 50)]
        for k, (by_time, by_length) in enumerate(zip(energy["time"], energy["length"])):
            t = k / 50 + 0.01
            self.assertAlmostEqual(by_time, 1 - abs(4 * (t % 0.5) - 1), delta=0.06)
            self.assertAlmostEqual(by_length, 1 - abs(t - 1), delta=0.03)
        middle = [f[4] for f in frames]  # of the second, by length
        self.assertAlmostEqual(self.hertz(middle, 0.8, 1.2), 55, delta=0.1)

    def test_a_plan_plays_as_its_stroke(self):
        self.write("t.haptic", haptic([(0, 0), (0.25, 1, 1, 0.3), (0.5, 0)]))
        self.write("c.toml", "[texture]\nhigh_hz = 300\n")
        for how in ("time", "length"):
            stroke = ("park2016-1", "--waveform", "t.haptic", "--texture", how)
            self.write("p.json", self.ok("plan", *stroke, "--format", "json", "--config", "c.toml").stdout)
            sounds = []
            for args in (stroke, ("p.json",)):
                self.ok("render", *args, "--config", "c.toml", "--force", "-o", "v.wav")
                sounds.append(Wav(self.dir / "v.wav").data)
            self.assertTrue(sounds[0] == sounds[1] and any(sounds[0]), how)

    def test_a_file_is_a_stroke_too(self):
        self.write("k.haptic", haptic([(0, 0.2), (0.3, 0.6, 0.8, 0.5), (0.6, 0.6)], [(0, 0), (0.6, 1)]))
        plans = self.plan("k.haptic")["plans"]
        self.assertEqual([(p["start_s"], round(p["stroke"]["duration_s"], 6)) for p in plans], [(0, 0.6), (0.3, 0.0235), (0.3, 0.0235)])
        self.assertEqual([p["stroke"].get("waveform", "sine") for p in plans], ["sine", "sine", "square"])
        self.assertEqual([c["hz"] for c in plans[0]["stroke"]["course"]], [55, 200])
        self.assertEqual({(round(b["x_mm"], 9), round(b["y_mm"], 9)) for p in plans for b in p["continuous"]["points"]}, {(20, 20)})
        at = {round(b["t_s"], 3): b["intensity"] for b in plans[0]["continuous"]["points"]}
        for t, v in ((0.0, 0.2), (0.15, 0.4), (0.31, 0.3), (0.4, 0.6)):
            self.assertAlmostEqual(at[t], v, 6)

    def test_ahap_is_quadratic_with_its_own_actuator(self):
        def render(*pattern):
            return self.texture(ahap(*pattern), name="a.ahap")
        x = render(event("HapticContinuous", 0, 0.5, 0.5, 0), event("HapticContinuous", 0.5, 0.5), event("HapticTransient", 1.2, None, 0.8, 1))
        self.assertEqual(len(x), round(1.222 * RATE))
        self.assertAlmostEqual(self.peak(x, 0.2), 0.25, delta=0.002)
        self.assertAlmostEqual(self.hertz(x, 0.01, 0.49), 65, delta=0.1)
        self.assertAlmostEqual(self.peak(x, 0.7), 1.0, delta=0.002)
        self.assertAlmostEqual(self.hertz(x, 0.51, 0.99), 182.5, delta=0.3)
        self.assertAlmostEqual(max(map(abs, x[round(1.01 * RATE):round(1.19 * RATE)])), 0)
        self.assertAlmostEqual(self.peak(x, 1.2), 0.64, delta=0.002)
        self.assertAlmostEqual(self.hertz(x, 1.2, 1.222), 300, delta=1)
        x = render(event("HapticContinuous", 0, 1, 0.8, 0.5), curve("HapticIntensityControl", 0.5, (0, 1), (0.5, 0.5)), curve("HapticSharpnessControl", 0.5, (0, 0.5), (0.1, 0.5)))
        self.assertAlmostEqual(self.peak(x, 0.4), 0.64, delta=0.002)
        self.assertAlmostEqual(self.peak(x, 0.74), (0.8 * 0.75) ** 2, delta=0.02)
        self.assertAlmostEqual(self.hertz(x, 0.52, 0.98), 300, delta=1)
        # Curves hold for transients, too; control points with the curve's own time are absolute.
        x = render(event("HapticTransient", 0.6, None, 1, 0), curve("HapticIntensityControl", 0.5, (0.5, 1), (0.7, 0)))
        self.assertAlmostEqual(self.peak(x, 0.6), 0.25, delta=0.002)
        # Transients that overlap add up; both files say the same of these.
        both = event("HapticTransient", 0.1, None, 0.6, 0), event("HapticTransient", 0.11, None, 0.5, 1)
        x = render(*both)
        for n, v in enumerate(x[round(0.1 * RATE):round(0.132 * RATE)]):
            t = n / RATE
            self.assertAlmostEqual(v, (t < 0.022) * 0.36 * math.sin(2 * math.pi * 65 * t) + (t >= 0.01) * 0.25 * math.sin(2 * math.pi * 300 * (t - 0.01)), delta=1e-3)
        self.assertEqual([(p["start_s"], round(p["stroke"]["duration_s"], 9)) for p in self.plan("a.ahap")["plans"]], [(0.1, 0.022), (0.11, 0.022)])

    def test_hostile_ahap_is_refused_or_cut_short(self):
        """The readers took minutes for these: each file fits in a message to the service."""
        self.write("k.ahap", ahap(event("HapticTransient", 0), *[{f"key {i}": 1} for i in range(50000)]))
        told = self.ok("plan", "k.ahap", "--format", "csv").stderr
        self.assertIn("'key 0' is left out; and 19 more like it", told)
        self.assertEqual(told.count("more is left out"), 1)
        self.write("m.ahap", ahap(*[event("HapticContinuous", 0, 10)] * 5000, curve("HapticIntensityControl", 0, *[(t / 500, t % 2) for t in range(5000)])))
        self.refused(2, "plan", "m.ahap", says=["too many events and control points overlap"])

    def test_ahap_tells_what_it_leaves_out(self):
        self.write("n.ahap", ahap(event("AudioCustom", 0), event("HapticTransient", 0, None, 3, -1), curve("AudioVolumeControl", 0, (0, 1)),
                                  curve("HapticIntensityControl", 0.5, (0.5, 1)), Metadata={}, Extra=1)[:-1] + ",} // the end")
        r = self.ok("plan", "n.ahap", "--format", "csv").stderr
        for word in ("'AudioCustom' is left out", "'AudioVolumeControl' is left out", "'Extra' is left out", "from the start of the file"):
            self.assertEqual(r.count(word), 1, r)
        self.assertNotIn("Metadata", r)
        shift = curve("HapticSharpnessControl", 0, (0, 0))
        shift["ParameterCurve"]["Foo"] = 1
        shift["ParameterCurve"]["ParameterCurveControlPoints"][0]["Bar"] = 1
        tap = event("HapticTransient", 0)
        tap["Event"]["EventParameters"].append({"ParameterID": "HapticSharpness", "ParameterValue": 1, "Baz": 1})
        step = {"Parameter": {"ParameterID": "HapticIntensityControl", "ParameterValue": 1, "Time": 0, "Qux": 1}}
        self.write("u.ahap", ahap(shift, tap, step))
        r = self.ok("plan", "u.ahap", "--format", "csv").stderr
        for key in ("Foo", "Bar", "Baz", "Qux"):
            self.assertEqual(r.count(f"'{key}' is left out"), 1, r)
        self.write("e.haptic", haptic([(0, 0.5), (0.3, 0.5, 1, 1), (0.3, 0.5, 1, 0), (0.6, 0.5)]))
        for args in (("e.haptic",), (*POINT, "--waveform", "e.haptic")):
            self.assertIn("1 emphasis is left out", self.ok("plan", *args, "--format", "csv").stderr)
        self.assertIn("left out", self.ok("plan", *POINT, "--waveform", "n.ahap").stdout)

    def test_carriers_over_time(self):
        self.write("c.toml", '[stroke]\npath = "M 20 20"\nduration_s = 1\nalgorithm = "continuous"\ncarrier_hz = [[0.2, 100], [0.5, 100], [0.5, 300], [0.7, 200]]\n')
        x = self.render("c.toml")
        for from_s, to_s, hz in ((0.01, 0.49, 100), (0.72, 0.99, 200)):
            self.assertAlmostEqual(self.hertz(x, from_s, to_s), hz, delta=0.2)
        self.assertAlmostEqual(self.hertz(x, 0.5, 0.7), 250, delta=3)
        for wrong in ("[]", "[[0]]", "[[1, 100], [0, 100]]", "[[-1, 100]]", "[[0, 0]]", "[[0, 30000]]"):
            self.write("w.toml", f'[stroke]\npath = "M 0 0 L 40 0"\ncarrier_hz = {wrong}\n')
            self.refused(2, "render", "w.toml", "--force", "-o", "w.wav", says=["carrier_hz"])

    def test_what_is_no_vibration_is_refused(self):
        for name, text, says in (
                ("two.haptic", haptic([(0, 1), (1, 1)], version=2), "version 2 is not supported"), ("none.haptic", '{"signals": {}}', "version"),
                ("one.haptic", haptic([(0, 1)]), "at least two"), ("now.haptic", haptic([(0, 1), (0, 0)]), "all its times are 0"),
                ("back.haptic", haptic([(1, 1), (0, 0)]), "ascending"), ("early.haptic", haptic([(-1, 1), (1, 0)]), "time"),
                ("loud.haptic", haptic([(0, 2), (1, 0)]), "amplitude"), ("late.haptic", haptic([(0, 1), (1e9, 0)]), "time"),
                ("nan.haptic", haptic([(0, math.nan), (1, 0)]), "it is not JSON"), ("deep.haptic", '{"a":' * 100, "nested"),
                ("curves.ahap", ahap({"ParameterCurves": {}}), "ParameterCurve"), ("empty.ahap", ahap(), "no haptic event"),
                ("time.ahap", ahap(event("HapticTransient", "soon")), "Time"), ("long.ahap", ahap(event("HapticContinuous", 0, 1e6)), "EventDuration"),
                ("open.ahap", ahap(event("HapticContinuous", 0)), "EventDuration"), ("big.ahap", ahap(*[event("HapticTransient", 0)] * 10001), "10000 events")):
            self.write(name, text)
            self.refused(2, "plan", name, says=[name, says])
            self.refused(2, "plan", *POINT, "--waveform", name, says=[name, says])
        self.write("silent.haptic", haptic([(0, 0), (1, 0)], []))
        self.assertEqual({b["intensity"] for b in self.plan("silent.haptic")["continuous"]["points"]}, {0})

    def test_extremes_stay_under_the_level(self):
        """Every tactor stays below the level, whatever a file says."""
        loud = [(t / 100, 1, 1, t % 2) for t in range(100)]
        self.write("x.haptic", haptic(loud, [(0, 1)]))
        self.write("x.ahap", ahap(*[event("HapticContinuous", 0, 1, 9, 9)] * 20, *[event("HapticTransient", t / 100, None, 9, 9) for t in range(100)]))
        self.write("x.tact", tact(*[effect(0, 1000, VestFront=mode("DOT_MODE", touches=[dots(0, 1000, *[(i, 1) for i in range(20)])]))] * 10))
        for args in (("x.haptic",), ("x.ahap",), ("x.tact",), (*POINT, "--waveform", "x.haptic"), ("park2016-1", "--waveform", "x.ahap", "--texture", "length")):
            self.ok("render", *args, "--level-dbfs", "-20", "--force", "-o", "x.wav")
            self.assertLessEqual(max(abs(v) for f in Wav(self.dir / "x.wav").samples() for v in f), 0.1 * (1 + 1e-5), args)


if __name__ == "__main__":
    main()
