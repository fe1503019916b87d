# SPDX-License-Identifier: MIT
"""Strokes as files of other formats: the same plan there and back, and a warning for each thing that is lost."""
import base64
import json
import os
import re
import struct

from harness import ROOT, Wav, main, wav_bytes
from serving import ServeTest

LINES = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 40 40"><path id="a" d="M0 0 L40 0 L40 20" data-speed-mm-s="50"/>' \
        '<path id="b &amp; c" d="M0 40 L40 40" data-duration-s="0.9" data-start-s="1.5" data-carrier-hz="200" data-intensity="0.5" data-easing="in-out"/></svg>'
TRACE = "t_s,x_mm,y_mm,intensity\n0,3,4,0.25\n0.4,20.125,17,1\n0.75,nan,nan,0\n0.8,36,31.7,0.6\n1.1,8,39,1\n"
# Two strokes with all that a file can say of them, and what follows them.
RICH = """[[stroke]]
name = "first \\"one\\""
path = "M 0 10 C 20 -5 20 45 40 30"
speed_mm_s = [[0, 40], [1, 90]]
intensity = [[0, 0.5], [1, 1]]
pauses = [[0.5, 0.2, 0.75]]
carrier_profile = [[0, 150], [1, 260]]
algorithm = "continuous"
phantom = "linear"
[[stroke]]
name = "second"
timed = [[0, 40, 0], [0.25, 20, 20, 0.5], [1, 0, 40]]
start_from = "start"
start_s = 0.25
soa_s = 0.06
waveform = "noise:100-300"
noise_seed = 7
am_hz = 20
am_depth = 0.5
level_db = -3
[[stroke]]
repeat = 2
pause_s = 0.1
[[stroke.stroke]]
points = [[0, 0], [20, 0], [20, 20]]
duration_s = 0.4
[[stroke.stroke]]
arc = { centre = [20, 20], radius_mm = 10, from_deg = 0, sweep_deg = 270 }
start_from = "piece"
start_s = 0.1
"""


def linear(points, t):
    """The value of points (time, value) at a time; of two points with the same time the second counts from then on."""
    before, after = [p for p in points if p[0] <= t], [p for p in points if p[0] > t]
    if not before or not after:
        return before[-1][1] if before else points[0][1]
    (t0, v0), (t1, v1) = before[-1], after[0]
    return v0 + (v1 - v0) * (t - t0) / (t1 - t0)


def felt_haptic(text):
    """A .haptic file by its specification, on the generic actuator: amplitude and Hz at a time, and (start, length, amplitude, Hz) of emphases."""
    file = json.loads(text)
    assert file["version"] == {"major": 1, "minor": 0, "patch": 0} and isinstance(file["metadata"], dict)
    points, frequency = (file["signals"]["continuous"]["envelopes"][n] for n in ("amplitude", "frequency"))
    assert len(points) >= 2 and points[-1]["time"] > 0 and all(f["time"] <= points[-1]["time"] for f in frequency)
    for all_of_them, name in ((points, "amplitude"), (frequency, "frequency")):
        assert all(a["time"] <= b["time"] for a, b in zip(all_of_them, all_of_them[1:])) and all(0 <= p[name] <= 1 for p in all_of_them)
    marked = [(p, p["emphasis"]) for p in points if "emphasis" in p]
    assert all(p["amplitude"] <= e["amplitude"] <= 1 and 0 <= e["frequency"] <= 1 for p, e in marked)
    starts = [p["time"] for p, _ in marked] + [points[-1]["time"]]
    touches = [(t, min(0.027 - 0.007 * e["frequency"], end - t), e["amplitude"], 55 + 75 * e["frequency"]) for t, end, (_, e) in zip(starts, starts[1:], marked)]

    def at(t):
        ducked = 0.5 if any(start <= t < start + lasts for start, lasts, *_ in touches) else 1
        return ducked * linear([(p["time"], p["amplitude"]) for p in points], t), 55 + 145 * linear([(p["time"], p["frequency"]) for p in frequency] or [(0, 0.5)], t)
    return points[-1]["time"], at, touches


def felt_ahap(pattern):
    """An AHAP pattern by Apple's description, sharpness as 65 to 300 Hz: as felt_haptic(), from intensities and sharpnesses that no curve exceeds."""
    def value(event, name):
        return next(p["ParameterValue"] for p in event["EventParameters"] if p["ParameterID"] == name)
    def control(t):
        curves = [[(c["Time"] + p["Time"], p["ParameterValue"]) for p in c["ParameterCurveControlPoints"]] for c in (e["ParameterCurve"] for e in pattern if "ParameterCurve" in e)]
        return linear(curves[0], t) if curves and t >= curves[0][0][0] else 1
    events = [e["Event"] for e in pattern if "Event" in e]

    def at(t):
        strong = [((value(e, "HapticIntensity") * control(t)) ** 2, 65 + 235 * value(e, "HapticSharpness")) for e in events
                  if e["EventType"] == "HapticContinuous" and e["Time"] <= t < e["Time"] + e["EventDuration"]]
        total = sum(a for a, _ in strong)
        return total, sum(a * hz for a, hz in strong) / total if total else None
    return at, [(e["Time"], 0.022, (value(e, "HapticIntensity") * control(e["Time"])) ** 2, 65 + 235 * value(e, "HapticSharpness")) for e in events if e["EventType"] == "HapticTransient"]


def haptic(amplitude, frequency=()):
    """The text of a .haptic file; a point is (time, amplitude) or (time, amplitude, emphasis' amplitude, emphasis' frequency)."""
    points = [{"time": p[0], "amplitude": p[1]} | ({"emphasis": {"amplitude": p[2], "frequency": p[3]}} if p[2:] else {}) for p in amplitude]
    return json.dumps({"version": {"major": 1, "minor": 0, "patch": 0}, "metadata": {}, "signals": {"continuous": {"envelopes": {
        "amplitude": points, "frequency": [{"time": t, "frequency": f} for t, f in frequency]}}}})


def event(time, intensity, sharpness, duration=None):
    values = [{"ParameterID": f"Haptic{n}", "ParameterValue": v} for n, v in (("Intensity", intensity), ("Sharpness", sharpness))]
    kind = {"EventType": "HapticTransient"} if duration is None else {"EventType": "HapticContinuous", "EventDuration": duration}
    return {"Event": {"Time": time, "EventParameters": values} | kind}


FADE = {"ParameterCurve": {"ParameterID": "HapticIntensityControl", "Time": 0.4, "ParameterCurveControlPoints": [{"Time": 0, "ParameterValue": 1}, {"Time": 0.5, "ParameterValue": 0.4}]}}
BUZZ = haptic([(0.1, 0.2), (0.3, 0.6, 0.7, 0.37), (0.3, 0.123), (0.31, 0.123, 0.1, 0.5), (0.77777, 1), (1, 0), (1.1, 0, 0.4, 1), (1.11, 0, 0.9, 0), (1.5, 0.05), (1.5, 0.4), (1.6, 0.35)],
              [(0.2, 0.1), (0.6, 0.9), (0.6, 0.4), (1.2, 1), (1.3, 0.65)])


class Haptic(ServeTest):
    def convert(self, source, to, *more):
        """Converts; returns what the file cannot hold, without names."""
        lines = self.ok("convert", source, to, "--force", *more).stderr.splitlines()
        told = [line.partition("HAPTIC cannot hold ")[2] for line in lines if "cannot hold" in line]
        return [t for t in told if not t.startswith("the name")]

    def samples(self, source):
        self.ok("render", source, "--force", "-o", "v.wav")
        return Wav(self.dir / "v.wav").data

    def check(self, file, was, touches, delta=2e-3):
        """Compares what a file makes felt with what it was, every 2 ms but not at steps."""
        lasts, at, emphases = felt_haptic((self.dir / file).read_text())
        for t in (0.00037 + 0.002 * k for k in range(int(lasts / 0.002))):
            (a, hz), (b, other_hz) = was(t), at(t)
            self.assertAlmostEqual(a, b, delta=delta, msg=t)
            if a > 0.01:
                self.assertAlmostEqual(hz, other_hz, delta=1, msg=t)
        self.assertEqual(len(emphases), len(touches))
        for one, other in zip(emphases, touches):
            for a, b, by in zip(one, other, (1e-9, 0.005, 1e-9, 0.01)):
                self.assertAlmostEqual(a, b, delta=by)

    def test_a_file_stays_the_same_to_the_last_sample(self):
        plain = haptic([(0, 0.5), (1, 1)])
        emphases_alone = haptic([(0, 0), (0.2, 0, 1, 0.25), (0.4, 0, 0.3, 0.75), (1, 0)])
        for n, text in enumerate((BUZZ, plain, emphases_alone, (ROOT / "examples/strokes/knock.haptic").read_text())):
            self.write(f"{n}.haptic", text)
            for source, to in ((f"{n}.haptic", "once.haptic"), ("once.haptic", "twice.haptic"), (f"{n}.haptic", "way.toml"), ("way.toml", "back.haptic")):
                self.assertEqual([t for t in self.convert(source, to) if to.endswith(".haptic")], [], source)
            self.assertEqual((self.dir / "once.haptic").read_text(), (self.dir / "twice.haptic").read_text())
            self.assertEqual((self.dir / "once.haptic").read_text(), (self.dir / "back.haptic").read_text())
            self.assertTrue(self.samples(f"{n}.haptic") == self.samples("once.haptic"))
        thirds = BUZZ.replace("0.65", repr(2 / 3)).replace("0.77777", repr(7 / 9)).replace("0.35", repr(1 / 3))  # more digits than a file gets
        self.write("t.haptic", thirds)
        self.assertEqual(self.convert("t.haptic", "once.haptic"), [])
        was, now = (struct.unpack(f"<{len(data) // 4}f", data) for data in map(self.samples, ("t.haptic", "once.haptic")))
        self.assertLess(max(abs(a - b) for a, b in zip(was, now, strict=True)), 1e-6 * max(was))

    def test_ahap_is_felt_the_same(self):
        pattern = [event(0, 0.9, 0.25), event(0.1, 0.7, 0.2, 0.5), event(0.25, 0.6, 0.1), event(0.3, 0.5, 0.5, 0.6), event(0.7, 1, 0), event(1.2, 0.8, 0.27), FADE]
        self.write("a.ahap", json.dumps({"Version": 1, "Pattern": pattern}))
        told = self.convert("a.ahap", "o.haptic")
        self.assertEqual([t.partition(" (")[0] for t in told], ["the durations of short touches", "the waveforms of short touches"])
        self.check("o.haptic", *felt_ahap(pattern))

    def test_what_ahap_can_and_haptic_cannot_is_told(self):
        for pattern, told in (([event(0, 1, 1, 1)], ["the carrier (up to 1e+02 Hz away)"]),
                              ([event(0, 1, 0, 1), event(0.5, 1, 0)], ["the changes of intensity (up to 0.5 away)", "the durations of short touches", "the waveforms of short touches"]),
                              ([event(0, 1, 1), event(0, 0.5, 0, 1)], ["the durations of short touches (up to 2 ms away)", "the carriers of short touches (up to 1.7e+02 Hz away)", "the waveforms of short touches"]),
                              ([event(0, 0.5, 0.5, 1)], [])):
            self.write("a.ahap", json.dumps({"Version": 1, "Pattern": pattern}))
            found = self.convert("a.ahap", "o.haptic")
            self.assertEqual(len(found), len(told), found)
            for a, b in zip(found, told):
                self.assertTrue(a.startswith(b), (a, b))
        lasts, at, _ = felt_haptic((self.dir / "o.haptic").read_text())
        self.assertEqual(lasts, 1)
        self.assertAlmostEqual(at(0.5)[0], 0.25)  # the square of the intensity
        self.assertAlmostEqual(at(0.5)[1], 182.5)

    def test_strokes_become_one_vibration(self):
        self.write("s.toml", """[[stroke]]
timed = [[0, 20, 20, 0.25], [0.5, 20, 20, 0.75], [1, 20, 20, 0]]
algorithm = "continuous"
carrier_hz = [[0, 60], [0.5, 60], [0.5, 180], [1, 150]]
[[stroke]]
start_s = 0.5
timed = [[0, 20, 20, 0.2], [0.4, 20, 20, 0.2]]
algorithm = "continuous"
carrier_hz = 90
level_db = -6
[[stroke]]
path = "M 20 20"
duration_s = 0.4
algorithm = "continuous"
carrier_hz = 70
""")
        self.assertEqual(self.convert("s.toml", "o.haptic"), ["the changes of intensity (up to 0.15 away)"])  # together above 1
        low = 0.2 * 10 ** (-6 / 20)

        def was(t):
            first = linear([(0, 0.25), (0.5, 0.75), (1, 0)], t) * (t < 1), linear([(0, 60), (0.5, 60), (0.5, 180), (1, 150)], t)
            all_of_them = [first, (low * (0.5 <= t < 0.9), 90), (1.0 * (0.9 <= t < 1.3), 70)]
            total = sum(a for a, _ in all_of_them)
            return min(total, 1), sum(a * hz for a, hz in all_of_them) / total if total else 0
        self.check("o.haptic", was, [])

    def test_places_and_methods_are_told(self):
        rest = '[stroke]\npath = "M 20 20"\nduration_s = 1\nalgorithm = "continuous"\ncarrier_hz = 100\n'
        for text, told in ((rest, []), (rest.replace("20 20", "5 5"), ["the place"]), (rest.replace("M 20 20", "M 0 0 L 40 40"), ["the movement"]),
                           (rest.replace("continuous", "park2016"), ["the algorithm"]), (rest.replace('algorithm = "continuous"\n', ""), ["the algorithm"]),
                           (rest + "am_hz = 30\n", ["the amplitude modulation"]), (rest + 'waveform = "square"\n', ["the waveform"]), (rest + "level_db = -6\n", []),
                           (rest + "intensity = 0.5\n", []),
                           (rest.replace("100", "250"), ["the carrier (up to 50 Hz away)"]), (rest + 'phantom = "log"\n', ["the phantom model"]),
                           (rest.replace("M 20 20", "M 0 20 L 40 20").replace("carrier_hz = 100", "carrier_profile = [[0, 60], [1, 160]]"), ["the movement"])):
            self.write("s.toml", text)
            self.assertEqual(self.convert("s.toml", "o.haptic"), told, text)
        _, at, _ = felt_haptic((self.dir / "o.haptic").read_text())
        self.assertAlmostEqual(at(0.25)[1], 85, delta=0.1)
        told = self.convert(ROOT / "examples/strokes/swipe.tact", "o.haptic")
        self.assertEqual(told[:2], ["the algorithm", "the movement"])

    def test_texture_numbers_do_not_change_a_file(self):
        self.write("t.toml", "[texture]\nlow_hz = 100\nhigh_hz = 300\nducking = 1\n")
        self.write("b.haptic", BUZZ)
        self.assertEqual(self.convert("b.haptic", "o.haptic"), [])
        self.assertEqual(self.convert("b.haptic", "t.haptic", "--config", "t.toml"), [])
        self.assertEqual((self.dir / "o.haptic").read_text(), (self.dir / "t.haptic").read_text())
        c = self.serve(config=(self.dir / "t.toml").read_text()).client()
        exported = c.ok("export", haptic=BUZZ, **{"as": "haptic"})
        self.assertEqual(exported["name"], "strokes.haptic")
        self.assertEqual(base64.b64decode(exported["base64"]).decode(), (self.dir / "o.haptic").read_text())

    def test_a_file_lasts_as_long_as_its_amplitude(self):
        for n, points in enumerate(([(0, 0, 1, 0.5), (1, 0)], [(0, 0), (1, 0)])):
            self.write(f"{n}.haptic", haptic(points))
            self.assertEqual(len(self.samples(f"{n}.haptic")), 48000 * 9 * 4)
        self.write("end.haptic", haptic([(0, 0.5), (1, 0.5, 1, 0.5)]))
        self.assertIn("end.haptic: 1 emphasis is left out, because", self.ok("convert", "end.haptic", "end.toml").stderr)
        self.write("none.ahap", json.dumps({"Version": 1, "Pattern": [event(0, 1, 0, 0)]}))
        self.refused(2, "convert", "none.ahap", "none.toml", says=["none.ahap: it has no haptic event"])

    def test_what_haptic_cannot_hold_at_all_is_refused(self):
        many = {"Version": 1, "Pattern": [event(0, 1, 0, 1000), *[{"ParameterCurve": {"ParameterID": "HapticIntensityControl", "Time": 0, "ParameterCurveControlPoints": [
            {"Time": t / 10, "ParameterValue": t % 2} for t in range(7000)]}}]]}
        self.write("m.ahap", json.dumps(many))
        self.refused(2, "convert", "m.ahap", "o.haptic", says=["more than 100000 points"])
        self.write("o.haptic", "{}")
        self.refused(2, "convert", "park2016-1", "o.haptic", says=["--force"])
        self.assertEqual((self.dir / "o.haptic").read_text(), "{}")


class Convert(ServeTest):
    def setUp(self):
        super().setUp()
        for name, text in (("lines.svg", LINES), ("trace.csv", TRACE), ("rich.toml", RICH)):
            self.write(name, text)

    def convert(self, source, to, *more):
        """Converts; returns the warnings without their beginning."""
        result = self.ok("convert", source, to, *more)
        self.assertRegex(result.stdout, f"^{to}: ")
        lines = [line for line in result.stderr.splitlines() if line]
        for line in lines:
            self.assertTrue(line.startswith("tactor: warning: "), line)
        return [line.removeprefix("tactor: warning: ").removeprefix(f"{to}: ") for line in lines]

    def plans(self, stroke, *more):
        """Returns the plans of a stroke without names: what sounds, when and how."""
        all_of_it = self.plan(stroke, *more)
        plans = all_of_it.get("plans", [all_of_it])
        for p in plans:
            del p["stroke"]["name"]
            for key in ("note", "fit"):
                p["stroke"].pop(key, None)
            del p["warnings"]  # of the file that was read
        return plans

    def assert_alike(self, one, other):
        """Compares plans: all texts and counts are equal, and numbers differ by no more than their rounding in a file."""
        if isinstance(one, float) or isinstance(other, float):
            self.assertAlmostEqual(one, other, delta=1e-9 * max(1.0, abs(one)))
        elif isinstance(one, (dict, list)):
            self.assertEqual((type(one), len(one)), (type(other), len(other)))
            for key in one if isinstance(one, dict) else range(len(one)):
                self.assert_alike(one[key], other[key])
        else:
            self.assertEqual(one, other)

    def test_a_stroke_file_holds_all_that_a_stroke_file_says(self):
        for n, source in enumerate(("rich.toml", "trace.csv", "lines.svg", "park2016-3", "wave-2x4", *(ROOT / f"examples/strokes/{name}.toml" for name in ("reach", "knocks", "several")))):
            array = ("--array", "palm-2x4") if source == "wave-2x4" else ()
            told = self.convert(source, f"{n}.toml", *array)
            self.assertEqual([t for t in told if "cannot hold" in t and "reconstructed" not in t and "the fit" not in t], [], source)
            self.assert_alike(self.plans(f"{n}.toml", *array), self.plans(source, *array))

    def test_there_and_back_gives_the_same_plan(self):
        for source, way in (("trace.csv", ("toml", "csv")), ("trace.csv", ("csv",)), ("lines.svg", ("toml", "svg")), ("lines.svg", ("svg", "toml")),
                            ("rich.toml", ("json", "json"))):
            at = source
            for n, extension in enumerate(way):
                to = f"{source}-{n}.{extension}"
                for told in self.convert(at, to):
                    self.assertRegex(told, "^CSV cannot hold the name$|^a plan cannot hold the path between its bursts$|no place .nan.")
                at = to
            self.assert_alike(self.plans(at), self.plans(source))

    def test_a_recording_is_held_by_its_name_and_a_fit_is_not(self):
        (self.dir / "grain.wav").write_bytes(wav_bytes([0.5, 0.5, -0.5, -0.5] * 20))
        self.write("grain.toml", '[stroke]\nname = "a"\npath = "M 0 0 H 40"\nduration_s = 0.5\nwaveform = "grain.wav"\n')
        self.assertEqual(self.convert("grain.toml", "again.toml", "--force"), [])
        self.assert_alike(self.plans("again.toml"), self.plans("grain.toml"))
        for to, held in (("swipe.toml", "TOML"), ("swipe.svg", "SVG")):
            self.assertIn(f"{held} cannot hold the fit to the array", self.convert(ROOT / "examples/strokes/swipe.tact", to, "--force"))

    def test_touches_stay_in_svg(self):
        touches = '[[stroke]]\nname = "b"\ntimed = [[0, 20, 20], [0.3, 20, 20]]\n', '[[stroke]]\nname = "a"\npath = "M 0 0 H 40"\nduration_s = 0.5\n'
        for text in (touches[0], "".join(touches), "".join(touches[::-1])):
            self.write("t.toml", text)
            self.assertEqual(self.convert("t.toml", "t.svg", "--force"), [])
            self.assertEqual(self.convert("t.svg", "again.toml", "--force"), [])
            self.assert_alike(self.plans("again.toml"), self.plans("t.toml"))
        self.write("b.haptic", BUZZ)
        self.assertTrue(all("SVG cannot hold" in told for told in self.convert("b.haptic", "b.svg")))

    def test_the_strokes_of_a_plan_give_the_same_plan(self):
        for n, args in enumerate((("park2016-3",), ("park2016-1", "--soa", "0.06"), ("park2016-1", "--algorithm", "continuous", "--phantom", "log"),
                                  ("trace.csv", "--carrier", "180"))):
            self.convert(args[0], f"{n}.json", *args[1:])
            told = self.convert(f"{n}.json", f"{n}.toml")
            self.assertIn("a stroke file cannot hold the plan's array, level and ramps", told)
            [was], [now] = self.plans(f"{n}.json"), self.plans(f"{n}.toml")
            self.assertEqual(was["algorithm"], now["algorithm"])
            if was["algorithm"] == "park2016":
                self.assert_alike([[b["onset_s"], b["drives"]] for b in now["bursts"]], [[b["onset_s"], b["drives"]] for b in was["bursts"]])
            else:
                there = [(a["x_mm"] - b["x_mm"], a["y_mm"] - b["y_mm"]) for a, b in zip(was["continuous"]["points"], now["continuous"]["points"])]
                self.assertLess(max(abs(d) for pair in there for d in pair), 0.01)

    def test_each_thing_that_is_lost_is_told_once(self):
        line = "[stroke]\npath = 'M 0 10 L 40 10'\n"
        for keys, to, told in (("name = 'a'", "x.csv", ["CSV cannot hold the name"]),
                               ("start_s = 0.5", "x.csv", ["CSV cannot hold the start"]), ("start_s = 0.5", "x.svg", []),
                               ("carrier_hz = 200", "x.csv", ["CSV cannot hold the carrier"]), ("carrier_hz = 200", "x.svg", []),
                               ("carrier_hz = 23000", "x.toml", []), ("carrier_hz = 23000", "x.svg", ["SVG cannot hold the carrier"]),
                               ("carrier_profile = [[0, 100], [1, 300]]", "x.svg", ["SVG cannot hold the carrier profile"]),
                               ("waveform = 'square'", "x.svg", ["SVG cannot hold the waveform"]),
                               ("am_hz = 30", "x.svg", ["SVG cannot hold the amplitude modulation"]),
                               ("algorithm = 'continuous'\nphantom = 'log'", "x.svg", ["SVG cannot hold the algorithm", "SVG cannot hold the phantom model"]),
                               ("faces = 'nearest'", "x.csv", ["CSV cannot hold the faces"]),
                               ("soa_s = 0.06\nburst_s = 0.02", "x.csv", ["CSV cannot hold the SOA", "CSV cannot hold the duration of bursts"]),
                               ("level_db = -6", "x.svg", ["SVG cannot hold the level relative to other strokes"]),
                               ("duration_s = 2", "x.svg", []), ("easing = 'minimum-jerk'", "x.svg", []), ("intensity = 0.4", "x.svg", []),
                               ("intensity = [[0, 0.2], [1, 1]]", "x.svg", ["SVG cannot hold the changes of intensity (up to 0.8 away)"]),
                               ("pauses = [[0.5, 1]]", "x.svg", ["SVG cannot hold the exact movement (up to 12 mm away)"])):
            self.write("in.toml", line + ("" if "name" in keys else "name = 'x'\n" if to == "x.csv" else "") + keys + "\n")
            (self.dir / to).unlink(missing_ok=True)
            self.assertEqual(self.convert("in.toml", to), told, keys)
        told = self.convert("rich.toml", "x.svg")
        self.assertIn("SVG cannot hold the waveform of stroke 2", told)
        self.assertIn("SVG cannot hold the algorithm of stroke 1", told)
        self.assertEqual(len(told), len(set(told)))
        self.assertEqual(self.convert("park2016-1", "park2016-1.csv")[0], "CSV cannot hold the note that it is reconstructed")
        self.assertEqual(self.convert("in.toml", "x.wav"), ["samples cannot hold the paths of strokes"])

    def test_starts_that_a_format_cannot_hold_become_times(self):
        self.convert("rich.toml", "x.svg")
        was, now = ([round(p["start_s"], 9) for p in self.plan(name)["plans"]] for name in ("rich.toml", "x.svg"))
        self.assertEqual(len(now), 6)
        del was[2], now[2]  # still follows the second stroke, whose method SVG cannot hold
        self.assertEqual(now, was)

    def test_options_become_keys_or_are_named(self):
        options = ("--algorithm", "tactile-brush", "--phantom", "barycentric", "--carrier", "190", "--waveform", "triangle", "--am", "25:0.5", "--duration", "1.3")
        self.write("line.toml", "[stroke]\npath = 'M 0 0 L 40 20'\n")
        self.assertEqual(self.convert("line.toml", "x.toml", *options), [])
        self.assert_alike(self.plans("x.toml"), self.plans("line.toml", *options))
        told = self.convert("line.toml", "y.toml", "--level-dbfs", "-20", "--snap", "--speed", "70", "--fit")
        self.assertEqual(told, ["a stroke file cannot hold --snap", "a stroke file cannot hold --level-dbfs"])
        self.assert_alike(self.plans("y.toml"), self.plans("line.toml", "--speed", "70", "--fit"))
        config = self.defaults(algorithm="continuous", speed=55)
        self.convert("line.toml", "z.toml", *config)
        self.assert_alike(self.plans("z.toml"), self.plans("line.toml", *config))

    def test_samples_and_plans_are_those_of_render_and_plan(self):
        self.convert("rich.toml", "a.wav", "--level-dbfs", "-20", "--sample-format", "s16")
        self.ok("render", "rich.toml", "-o", "b.wav", "--level-dbfs", "-20", "--sample-format", "s16")
        self.assertEqual((self.dir / "a.wav").read_bytes(), (self.dir / "b.wav").read_bytes())
        self.convert("rich.toml", "a.json")
        self.assertEqual((self.dir / "a.json").read_text(), self.ok("plan", "rich.toml", "--format", "json").stdout)
        self.assertEqual((self.dir / "a.json").read_text(), self.plan_again("a.json"))
        self.ok("convert", "-", "c.csv", stdin=TRACE)
        self.assert_alike(self.plans("c.csv"), self.plans("trace.csv"))

    def plan_again(self, file):
        self.convert(file, "again.json")
        return (self.dir / "again.json").read_text()

    def test_the_service_exports_the_same_files(self):
        c = self.serve().client()
        for source, kind, text in (("rich.toml", "toml", RICH), ("trace.csv", "csv", TRACE), ("lines.svg", "toml", LINES)):
            self.convert(source, f"x.{kind}", "--force")
            written = re.sub(r"\n# sha256 .*\n$", "", (self.dir / f"x.{kind}").read_text())
            params = {source.rpartition(".")[2]: text, "as": kind}
            exported = base64.b64decode(c.ok("export", **params)["base64"]).decode()
            # The service knows no name of a file, by which convert calls strokes without a name.
            self.assertEqual(re.sub(r'name = "(?:rich|toml)-', 'name = "', written), re.sub(r'name = "(?:rich|toml)-', 'name = "', exported))
        swipe = ROOT / "examples/strokes/swipe.tact"
        for kind in ("haptic", "toml"):
            told = [line.split(": ", 3)[3] for line in self.ok("convert", swipe, f"s.{kind}").stderr.splitlines() if "cannot hold" in line]
            self.assertEqual(c.ok("export", tact=swipe.read_text(), **{"as": kind})["warnings"], [t for t in told if "the name" not in t])
            self.assertTrue(told)

    def test_what_cannot_be_converted_is_refused_and_leaves_nothing(self):
        self.write("theirs.toml", "# mine\n")
        self.write("tone.wav", b"RIFF")
        before = sorted(os.listdir(self.dir))
        for args in (("rich.toml", "x.csv"), ("rich.toml", "x.txt"), ("rich.toml", "x"), ("rich.toml", "-"), ("rich.toml", ""), ("tone.wav", "x.toml"),
                     ("rich.toml", "rich.toml"), ("trace.csv", "rich.toml"), ("rich.toml", "theirs.toml"), ("rich.toml", "no/x.toml"), ("none.toml", "x.toml"),
                     ("rich.toml",), (), ("rich.toml", "x.toml", "y.toml"), ("rich.toml", "x.toml", "--path", "M 0 0"), ("rich.toml", "rich.toml", "--force"),
                     ("rich.toml", "x.csv", "--array", "palm-2x4", "--config", "none.toml")):
            self.refused(2, "convert", *args)
        self.write("out.toml", "[[stroke]]\npath = 'M 0 0 L 90 0'\n")
        self.refused(2, "convert", "out.toml", "x.json")
        self.refused(2, "convert", "out.toml", "x.wav")
        (self.dir / "out.toml").unlink()
        self.assertEqual(sorted(os.listdir(self.dir)), before)
        self.assertEqual((self.dir / "theirs.toml").read_text(), "# mine\n")

    def test_a_file_is_replaced_only_as_tactor_wrote_it(self):
        for to in ("a.toml", "a.svg", "a.csv", "a.json", "a.wav"):
            source, other = "trace.csv", "park2016-2"
            self.convert(source, to)
            self.convert(source, to)
            if to == "a.json":  # its bytes are its identity
                self.refused(2, "convert", other, to)
            else:
                self.convert(other, to)
            kept = (self.dir / to).read_bytes() + b"\n"
            self.write(to, kept)
            self.refused(2, "convert", source, to)
            self.assertEqual((self.dir / to).read_bytes(), kept)
            self.convert(source, to, "--force")
            self.assertNotEqual((self.dir / to).read_bytes(), kept)


if __name__ == "__main__":
    main()
