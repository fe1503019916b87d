# SPDX-License-Identifier: MIT
"""A plan's JSON is a record: samples of every kind are computed here from it and the formulas of tactor-json(5) alone."""
import cmath
import hashlib
import json
import math

from harness import ToolTest, Wav, main, wav_bytes

RATE = 8000
MARGIN = 1 + 2e-5
LINE = ("--path", "M 0 0 L 40 0", "--duration", "0.4", "--rate", str(RATE), "--carrier", "130")
RISING = """
[array]
name = "slow"
grid = { rows = 1, columns = 3, pitch_mm = 20.0 }
[[tactor]]
tactor = 0
rise_ms = 20
[[tactor]]
tactor = 1
rise_ms = 50
max_dbfs = -10
gain_db = -2
"""


def frame(seconds, rate):
    return math.floor(seconds * rate + 0.5 + 1e-6)


class Envelope:
    """Returns attack and release of bursts, in frames, and their window."""

    def __init__(self, kind, attack, release):
        self.kind, self.attack, self.release = kind, attack, release

    @staticmethod
    def of(length, ramp_s, render):
        e = render.get("envelope") or {"kind": "raised-cosine", "attack_s": None, "release_s": None}
        if e["kind"] == "tukey":
            a = min(frame(0.5 * e["tukey_part"] * length / render["rate"], render["rate"]), length // 2)
            return Envelope(e["kind"], a, a)
        if e["release_s"] is None:
            a = min(frame(ramp_s, render["rate"]), length // 2)
            return Envelope(e["kind"], a, a)
        a, r = frame(ramp_s, render["rate"]), frame(e["release_s"], render["rate"])
        if a + r > length:
            a = math.floor(a * (length / (a + r)))
        return Envelope(e["kind"], a, min(r, length - a))

    def rise(self, part):
        if self.kind == "linear":
            return part
        if self.kind == "exponential":
            return (1 - math.exp(-5 * part)) / (1 - math.exp(-5))
        return 0.5 - 0.5 * math.cos(math.pi * part)

    def at(self, k, length):
        if not 0 <= k < length:
            return 0.0
        if k < self.attack:
            return self.rise(k / self.attack)
        left = length - k
        if left >= self.release:
            return 1.0
        return 1 - self.rise(1 - left / self.release) if self.kind == "exponential" else self.rise(left / self.release)


class Carrier:
    """A carrier: at(m, origin) is its sample at frame m of the stroke; its phase is 0 at frame `origin`."""

    def __init__(self, stroke, rate, samples=None):
        self.stroke, self.rate = stroke, rate
        self.course = stroke.get("course") or []
        self.wave = stroke.get("waveform", "sine")
        self.samples = samples
        self.loop = self.coefficients = None
        highest = max([c["hz"] for c in self.course], default=stroke["carrier_hz"])
        am = stroke.get("am_hz", 0.0) if stroke.get("am_depth", 0.0) > 0 else 0.0
        self.harmonics = max(1, math.ceil((rate / 2 - am) / highest) - 1)
        if self.wave.startswith("noise:"):
            self.loop = self.noise()
        elif samples and stroke["texture"] == "time":
            mean = sum(samples) / len(samples)
            self.loop = self.to_peak([v - mean for v in samples])
        elif samples:
            n = len(samples)
            mean = sum(samples) / n
            own = max((n - 1) // 2, 1)
            self.coefficients = {h: sum((v - mean) * cmath.exp(-2j * math.pi * h * i / n) for i, v in enumerate(samples))
                                 for h in range(1, min(self.harmonics, own) + 1)}
        elif self.wave != "sine":
            self.coefficients = {h: -1j * b for h in range(1, min(self.harmonics, 4096) + 1) if (b := self.height(h))}
        if self.coefficients:
            peak = max(abs(self.cycle(i / 20000)) for i in range(20000))
            self.coefficients = {h: c / (peak * MARGIN) for h, c in self.coefficients.items()}

    def height(self, h):
        odd = h % 2 == 1
        return {"square": odd / h, "triangle": odd * (1 if h % 4 == 1 else -1) / h ** 2, "sawtooth": (1 if odd else -1) / h}[self.wave]

    def cycle(self, turns):
        return sum((c * cmath.exp(2j * math.pi * h * turns)).real for h, c in self.coefficients.items())

    @staticmethod
    def to_peak(x):
        peak = max(map(abs, x))
        return [v / (peak * MARGIN) for v in x]

    def noise(self):
        low, high = map(float, self.wave[6:].split("-"))
        length = min(2 ** math.ceil(math.log2(4 * self.rate)), 2 ** 20)
        state, mask, lines = self.stroke["noise_seed"], 2 ** 64 - 1, []
        for k in range(math.ceil(low * length / self.rate), min(math.floor(high * length / self.rate), length // 2 - 1) + 1):
            state = (state + 0x9E3779B97F4A7C15) & mask
            z = (state ^ state >> 30) * 0xBF58476D1CE4E5B9 & mask
            z = (z ^ z >> 27) * 0x94D049BB133111EB & mask
            lines.append((k, 2 * math.pi * ((z ^ z >> 31) >> 11) / 2 ** 53))
        step = 2 * math.pi / length
        return self.to_peak([sum(math.cos(k * m % length * step + r) for k, r in lines) for m in range(length)])

    def turns(self, m):
        if not self.course:
            return self.stroke["carrier_hz"] * m / self.rate
        t, turns = m / self.rate, 0.0
        for a, b in zip(self.course, self.course[1:]):
            span = b["t_s"] - a["t_s"]
            if t < b["t_s"]:
                d = t - a["t_s"]
                return turns + a["hz"] * d + (0.5 * (b["hz"] - a["hz"]) / span * d * d if span > 0 else 0.0)
            turns += 0.5 * span * (a["hz"] + b["hz"])
        return turns + self.course[-1]["hz"] * (t - self.course[-1]["t_s"])

    def at(self, m, origin):
        if self.loop:
            v = self.loop[m % len(self.loop)]
        else:
            turns = self.turns(m) - (self.turns(origin) if origin else 0.0)
            v = self.cycle(turns) if self.coefficients else math.sin(2 * math.pi * turns)
        if "am_hz" in self.stroke:
            d = self.stroke["am_depth"]
            v *= (1 + d * math.sin(2 * math.pi * self.stroke["am_hz"] * m / self.rate)) / (1 + d)
        return v


class Lag:
    """An actuator that follows by a first-order lag, for bursts of an envelope."""

    def __init__(self, rise, e):
        self.rise, self.e = rise, e
        keep = math.exp(-1 / rise)
        whole = e.attack + e.release

        def part(a, b):
            y = 0.0
            for k in range(a, b):
                y = keep * y + (1 - keep) * e.at(k, whole)
            return y
        self.attacked, self.released = part(0, e.attack), part(e.attack, whole)

    def left(self, x):
        return math.exp(-x / self.rise)

    def risen(self, x):
        return 1 - (1 - self.attacked) * self.left(x - self.e.attack)

    def fallen(self, x):
        return self.risen(x - self.e.release) * self.left(self.e.release) + self.released


class Record:
    """Returns the samples of a plan, channel by channel."""

    def __init__(self, plan, samples=None):
        self.plan, self.render = plan, plan["render"]
        self.rate = self.render["rate"]
        self.start = plan["start_frame"]
        self.carrier = Carrier(plan["stroke"], self.rate, samples)
        self.tactors = plan["array"]["tactors"]

    def gain(self, tactor, frame_of_piece):
        t = self.tactors[tactor]
        db = self.render["peak_dbfs"][tactor]
        if isinstance(t["threshold_dbfs"], list) and "sl_db" in self.render:
            course = self.carrier.course
            hz, s = self.plan["stroke"]["carrier_hz"], (frame_of_piece - self.start) / self.rate
            for a, b in zip(course, course[1:]):
                if a["t_s"] <= s < b["t_s"]:
                    hz = a["hz"] + (b["hz"] - a["hz"]) * (s - a["t_s"]) / (b["t_s"] - a["t_s"])
            if course and s >= course[-1]["t_s"]:
                hz = course[-1]["hz"]
            points = t["threshold_dbfs"]
            db = points[0][1] if hz <= points[0][0] else points[-1][1]
            for (f, d), (g, e) in zip(points, points[1:]):
                if f <= hz <= g:
                    db = d + (e - d) * math.log(hz / f) / math.log(g / f)
            db += self.render["sl_db"]
        return t.get("polarity", 1) * 10 ** (db / 20)

    def bursts(self):
        """Returns (tactor, first frame, frames, amplitude, greatest intensity, envelope), also of those that boost others."""
        all_of_them = []
        for b in self.plan["bursts"]:
            first = frame(b["onset_s"], self.rate)
            length = frame(b["onset_s"] + b["duration_s"], self.rate) - first
            for d in b["drives"]:
                e = Envelope.of(length, b["ramp_s"], self.render)
                all_of_them.append((d["tactor"], self.start + first, length, d["amplitude"], b["intensity"], e))
        return all_of_them + self.boosts(all_of_them)

    def boosts(self, bursts):
        more = []
        for number, t in enumerate(self.tactors):
            if "rise_s" not in t:
                continue
            rise, own = t["rise_s"] * self.rate, [b for b in bursts if b[0] == number]
            strength, until = 0.0, 0
            half = self.rate / 2 / self.plan["stroke"]["carrier_hz"]
            gain = abs(self.gain(number, self.start))
            room = 10 ** (min(0, t.get("max_dbfs", 0)) / 20) / gain - max((b[3] for b in own), default=0)
            for _, first, length, amplitude, intensity, e in own:
                lag = Lag(rise, e)
                before = strength * lag.left(first - min(until, first))
                least = max(1, math.ceil(max(1, e.attack + e.release) / half))
                most = math.floor(min(length, 5 * rise) / half)
                boost, frames = 0.0, 0
                if amplitude > before and most >= least and room > 0:
                    for j in range(least, most + 1):
                        frames = math.floor(j * half + 0.5 + 1e-6)
                        missing = max(amplitude * (1 - lag.risen(frames)) - before * lag.left(frames), 0) / lag.fallen(frames)
                        boost = min(missing, room)
                        if missing <= room:
                            break
                    if boost * gain > 1e-5:
                        more.append((number, first, frames, boost, math.inf, e))
                strength = before * lag.left(length) + amplitude * lag.fallen(length)
                strength += boost * lag.fallen(frames) * lag.left(length - frames) if boost else 0.0
                until = first + length
        return more

    def continuous(self, n):
        c = self.plan["continuous"]
        length = frame(self.plan["stroke"]["duration_s"], self.rate)
        window = Envelope.of(length, c["ramp_s"], self.render).at(n - self.start, length)
        at = [frame(p["t_s"], self.rate) for p in c["points"]]
        i = max(i for i, f in enumerate(at) if f <= n - self.start or i == 0)
        j = min(i + 1, len(at) - 1)
        part = (n - self.start - at[i]) / (at[j] - at[i]) if j > i else 0.0
        out = {}
        for k, weight in ((i, 1 - part), (j, part)):
            for d in c["points"][k]["drives"]:
                out[d["tactor"]] = out.get(d["tactor"], 0.0) + weight * d["amplitude"] * window
        return out

    def samples(self, n):
        """Returns all channels at a frame."""
        out = [0.0] * self.render["channels"]
        if "continuous" in self.plan:
            drives = [(t, [(a, math.inf, False)], self.start) for t, a in self.continuous(n).items()]
        else:
            sounding = {}
            self.all = getattr(self, "all", None) or self.bursts()
            for t, first, length, amplitude, intensity, e in self.all:
                if first <= n < first + length:
                    sounding.setdefault(t, []).append((amplitude * e.at(n - first, length), intensity, first))
            drives = []
            for t, all_of_them in sounding.items():
                first = min(b[2] for b in all_of_them)
                drives.append((t, all_of_them, first))
        for t, all_of_them, first in drives:
            origin = first - self.start if self.render["phase"] == "burst" else 0
            own = [a for a, limit, _ in all_of_them if limit != math.inf or len(all_of_them) == 1]
            boosts = [a for a, limit, _ in all_of_them if limit == math.inf and len(all_of_them) > 1]
            rule = self.render["overlap"]
            amplitude = {"energy": lambda: math.hypot(*own), "max": lambda: max(own), "sum": lambda: sum(own)}[rule]() if len(own) > 1 else own[0]
            if rule == "energy" and len(own) > 1:
                amplitude = min(amplitude, max(limit for _, limit, _ in all_of_them if limit != math.inf))
            gain = self.gain(t, n if "continuous" in self.plan else first)
            out[self.tactors[t]["channel"]] += gain * (amplitude + sum(boosts)) * self.carrier.at(n - self.start, origin)
        return out


class Samples(ToolTest):
    def check(self, *args, samples=None, tolerance=1e-6, stroke=None):
        with self.subTest(args=args):
            text = self.ok("plan", *args, "--format", "json").stdout
            self.write("p.json", text)
            self.ok("render", *args, "-o", "x.wav")
            frames = Wav(self.dir / "x.wav").samples()
            record = Record(json.loads(text), samples)
            peak = max(abs(v) for f in frames for v in f)
            self.assertGreater(peak, 0.01)
            for n in range(0, len(frames), 7):
                for c, (got, want) in enumerate(zip(frames[n], record.samples(n))):
                    self.assertAlmostEqual(got, want, delta=tolerance * peak, msg=f"frame {n}, channel {c}")

    def test_sines_in_both_phases_and_all_algorithms(self):
        for phase in ("stroke", "burst"):
            self.check(*LINE, "--phase", phase)
        self.check("park2016-1", "--rate", str(RATE), "--ramp", "0.005")
        self.check("--path", "M 20 4 L 20 36", "--duration", "1", "--rate", str(RATE), "--phantom", "gaussian")
        self.check(*LINE, "--algorithm", "continuous", tolerance=2e-3)

    def test_envelopes(self):
        for extra in (("--attack", "0.01"), ("--attack", "0.01", "--release", "0.03"), ("--attack", "0.05", "--release", "0.06"),
                      ("--envelope", "linear", "--attack", "0.02"), ("--envelope", "exponential", "--attack", "0.02"),
                      ("--envelope", "exponential", "--attack", "0.01", "--release", "0.03"), ("--envelope", "tukey:0.7")):
            self.check(*LINE, *extra)

    def test_overlapping_bursts_of_the_brush(self):
        for rule in ("energy", "max", "sum"):
            self.check("--path", "M 0 0 L 40 20", "--duration", "1", "--rate", str(RATE), "--algorithm", "tactile-brush", "--overlap", rule,
                       "--level-dbfs", "-20", tolerance=5e-3)

    def test_modulation(self):
        for extra in (("--am", "30"), ("--am", "23:0.5", "--phase", "burst")):
            self.check(*LINE, *extra)

    def test_shapes_below_half_the_rate(self):
        for shape in ("square", "triangle", "sawtooth"):
            self.check(*LINE, "--waveform", shape, tolerance=2e-4)
        self.check(*LINE, "--waveform", "square", "--am", "300", tolerance=2e-4)

    def test_a_carrier_that_changes(self):
        self.write("s.toml", '[stroke]\npath = "M 0 0 L 40 0"\nduration_s = 0.5\ncarrier_profile = [[0, 90], [0.4, 90], [1, 300]]\n')
        for extra in ((), ("--phase", "burst"), ("--waveform", "sawtooth"), ("--algorithm", "continuous")):
            self.check("s.toml", "--rate", str(RATE), *extra, tolerance=2e-3 if "continuous" in extra else 2e-4)

    def test_noise(self):
        self.check(*LINE, "--waveform", "noise:60-75", "--noise-seed", "7", tolerance=2e-5)

    def test_recordings(self):
        values = [round(32767 * math.sin(2 * math.pi * i / 40) * (1 - i / 400)) for i in range(400)]
        self.write("r.wav", wav_bytes([v / 32767 for v in values], rate=RATE))
        samples = [v / 32768 for v in values]
        slow = ("--path", "M 0 0 L 40 0", "--duration", "0.4", "--rate", str(RATE), "--waveform", "r.wav")
        self.check(*slow, "--carrier", "20", samples=samples, tolerance=2e-4)
        self.check(*slow, "--texture", "time", samples=samples, tolerance=2e-5)
        self.check(*slow, "--texture", "length", "--texture-mm", "15", samples=samples, tolerance=2e-4)

    def test_boosts_of_slow_actuators(self):
        self.write("a.toml", RISING)
        for extra in ((), ("--attack", "0.004"), ("--level-dbfs", "-30")):
            self.check(*LINE, "--array", "a.toml", *extra)

    def test_sensation_levels_along_a_carrier(self):
        points = "".join(f"[[tactor]]\ntactor = {i}\nthreshold_dbfs = [[100, -20], [250, -41.0]]\n" for i in range(3))
        self.write("a.toml", '[array]\nname = "m"\ngrid = { rows = 1, columns = 3, pitch_mm = 20.0 }\n' + points)
        self.write("s.toml", '[stroke]\npath = "M 0 0 L 40 0"\nduration_s = 0.5\ncarrier_profile = [[0, 90], [1, 300]]\n')
        self.check("s.toml", "--array", "a.toml", "--sl", "7", "--rate", str(RATE))
        self.check(*LINE, "--array", "a.toml", "--sl", "7")


class Recordings(ToolTest):
    def test_a_plan_names_its_recording_and_refuses_another(self):
        sound = wav_bytes([math.sin(2 * math.pi * i / 40) for i in range(400)], rate=RATE)
        self.write("r.wav", sound)
        args = ("--path", "M 0 0 L 40 0", "--duration", "0.4", "--waveform", "r.wav", "--carrier", "20")
        plan = self.plan(*args)
        self.assertEqual(plan["stroke"]["recording"], {"file": str((self.dir / "r.wav").resolve()), "sha256": hashlib.sha256(sound).hexdigest(),
                                                       "frames": 400, "rate": RATE})
        self.write("p.json", json.dumps(plan))
        self.ok("render", "p.json", "-o", "x.wav")
        self.write("r.wav", sound[:-2] + b"\1\0")
        for command in (("render", "p.json", "-o", "x.wav"), ("plan", "p.json"), ("play", "p.json", "-D", "null"), ("plot", "p.json", "-o", "x.svg")):
            self.refused(2, *command)
        self.write("r.wav", sound)
        self.ok("plan", "p.json")
        for key, value in (("frames", 399), ("rate", 16000), ("sha256", "0" * 64)):
            self.write("q.json", json.dumps(plan | {"stroke": plan["stroke"] | {"recording": plan["stroke"]["recording"] | {key: value}}}))
            self.refused(2, "plan", "q.json")
        del plan["stroke"]["recording"]
        self.write("old.json", json.dumps(plan))
        self.ok("plan", "old.json")

    def test_a_recording_that_is_cut_short_gives_a_warning(self):
        sound = wav_bytes([math.sin(2 * math.pi * i / 40) for i in range(400)], rate=RATE)
        self.write("r.wav", sound[:44 + 2 * 100])
        for command in (("plan",), ("render", "-o", "x.wav"), ("plot", "-o", "x.svg")):
            said = self.ok(command[0], "--path", "M 0 0 L 40 0", "--waveform", "r.wav", "--carrier", "20", *command[1:])
            self.assertIn("r.wav: the recording is cut short: it has 100 of 400 samples", said.stdout + said.stderr)


if __name__ == "__main__":
    main()
