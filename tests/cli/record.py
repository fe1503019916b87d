# SPDX-License-Identifier: MIT
"""The samples of a plan from its JSON alone, by the formulas of tactor-json(5), as a reader of the record would write them."""
import cmath
import math

# An array whose channels, gains and thresholds differ, and strokes that overlap.
PAIR = ('[array]\nname = "pair"\n'
        '[[tactor]]\nx_mm = 0.0\ny_mm = 0.0\nchannel = 2\ngain_db = -6.0\npolarity = -1\nthreshold_dbfs = -41.5\n'
        '[[tactor]]\nx_mm = 10.0\ny_mm = 0.0\nchannel = 0\nthreshold_dbfs = -30\n'
        '[sync]\nchannel = 3\n')
STROKES = ('[[stroke]]\npath = "M 0 0 L 10 0"\nduration_s = 0.5\nstart_s = 0.1\n'
           '[[stroke]]\npath = "M 10 0 L 0 0"\nduration_s = 0.33337\ncarrier_hz = 181.3\n'
           '[[stroke]]\npath = "M 10 0 L 0 0"\nduration_s = 0.5\nstart_s = 0.3\n')
MARGIN = 1 + 2e-5  # of the peak of a wave that is no sine


def frame_at(t_s, rate):
    return math.floor(t_s * rate + 0.5 + 1e-6)


class Envelope:
    """The ramps of a burst, in frames."""

    def __init__(self, length, ramp_s, render):
        given, rate = render.get("envelope") or {"kind": "raised-cosine", "release_s": None}, render["rate"]
        self.kind = given["kind"]
        self.attack = self.release = min(frame_at(ramp_s, rate), length // 2)
        if self.kind == "tukey":
            self.attack = self.release = min(frame_at(0.5 * given["tukey_part"] * length / rate, rate), length // 2)
        elif given["release_s"] is not None:
            a, r = frame_at(ramp_s, rate), frame_at(given["release_s"], rate)
            self.attack = math.floor(a * (length / (a + r))) if a + r > length else a
            self.release = min(r, length - self.attack)

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
    """A carrier: at(n, origin) is its sample at frame n of the stroke; its phase is 0 at frame `origin`."""

    def __init__(self, stroke, rate, recording):
        self.stroke, self.rate = stroke, rate
        self.course = stroke.get("course") or []
        self.loop = self.coefficients = None
        wave = stroke.get("waveform", "sine")
        highest = max([c["hz"] for c in self.course], default=stroke["carrier_hz"])
        harmonics = max(1, math.ceil((rate / 2 - stroke.get("am_hz", 0.0)) / highest) - 1)
        if wave.startswith("noise:"):
            self.loop = self.make_noise(*map(float, wave[6:].split("-")))
        elif recording:
            n, mean = len(recording), sum(recording) / len(recording)
            if stroke["texture"] == "time":
                self.loop = self.scale_to_peak([v - mean for v in recording])
            else:
                self.coefficients = {h: sum((v - mean) * cmath.exp(-2j * math.pi * h * i / n) for i, v in enumerate(recording))
                                     for h in range(1, min(harmonics, max((n - 1) // 2, 1)) + 1)}
        elif wave != "sine":
            heights = {"square": lambda h: h % 2 / h, "triangle": lambda h: h % 2 * (2 - h % 4) / h ** 2, "sawtooth": lambda h: (2 * (h % 2) - 1) / h}
            self.coefficients = {h: -1j * heights[wave](h) for h in range(1, min(harmonics, 4096) + 1) if heights[wave](h)}
        if self.coefficients:
            peak = max(abs(self.sum_up(i / 20000)) for i in range(20000))
            self.coefficients = {h: c / (peak * MARGIN) for h, c in self.coefficients.items()}

    def sum_up(self, turns):
        return sum((c * cmath.exp(2j * math.pi * h * turns)).real for h, c in self.coefficients.items())

    @staticmethod
    def scale_to_peak(x):
        peak = max(map(abs, x))
        return [v / (peak * MARGIN) for v in x]

    def make_noise(self, low, high):
        length = min(2 ** math.ceil(math.log2(4 * self.rate)), 2 ** 20)
        state, mask, lines = self.stroke["noise_seed"], 2 ** 64 - 1, []
        for k in range(math.ceil(low * length / self.rate), min(math.floor(high * length / self.rate), length // 2 - 1) + 1):
            state = (state + 0x9E3779B97F4A7C15) & mask
            z = (state ^ state >> 30) * 0xBF58476D1CE4E5B9 & mask
            z = (z ^ z >> 27) * 0x94D049BB133111EB & mask
            lines.append((k, 2 * math.pi * ((z ^ z >> 31) >> 11) / 2 ** 53))
        step = 2 * math.pi / length
        return self.scale_to_peak([sum(math.cos(k * m % length * step + r) for k, r in lines) for m in range(length)])

    def turns(self, n):
        if not self.course:
            return self.stroke["carrier_hz"] * n / self.rate
        t, turns = n / self.rate, 0.0
        for a, b in zip(self.course, self.course[1:]):
            span = b["t_s"] - a["t_s"]
            if t < b["t_s"]:
                d = t - a["t_s"]
                return turns + a["hz"] * d + (0.5 * (b["hz"] - a["hz"]) / span * d * d if span > 0 else 0.0)
            turns += 0.5 * span * (a["hz"] + b["hz"])
        return turns + self.course[-1]["hz"] * (t - self.course[-1]["t_s"])

    def hz_at(self, t_s):
        for a, b in zip(self.course, self.course[1:]):
            if a["t_s"] <= t_s < b["t_s"]:
                return a["hz"] + (b["hz"] - a["hz"]) * (t_s - a["t_s"]) / (b["t_s"] - a["t_s"])
        return self.course[-1]["hz"] if self.course else self.stroke["carrier_hz"]

    def at(self, n, origin):
        if self.loop:
            v = self.loop[n % len(self.loop)]
        else:
            turns = self.turns(n) - (self.turns(origin) if origin else 0.0)
            v = self.sum_up(turns) if self.coefficients else math.sin(2 * math.pi * turns)
        if "am_hz" in self.stroke:
            d = self.stroke["am_depth"]
            v *= (1 + d * math.sin(2 * math.pi * self.stroke["am_hz"] * n / self.rate)) / (1 + d)
        return v


class Burst:
    """A tactor's part in a burst, in frames of the stroke."""

    def __init__(self, burst, amplitude, render):
        rate = render["rate"]
        self.from_s, self.to_s = burst["onset_s"], burst["onset_s"] + burst["duration_s"]
        self.first, self.end = frame_at(self.from_s, rate), frame_at(self.to_s, rate)
        self.length = self.end - self.first
        self.envelope = Envelope(self.length, burst["ramp_s"], render)
        self.amplitude = amplitude
        self.strength = max(burst["intensity"], math.sqrt(sum(d["amplitude"] ** 2 for d in burst["drives"])))
        self.boost, self.boost_frames = 0.0, 0  # at the beginning, where the actuator is slow

    def at(self, n):
        return self.amplitude * self.envelope.at(n - self.first, self.length)

    def boost_at(self, n):
        return self.boost * self.envelope.at(n - self.first, self.boost_frames)


class Lag:
    """An actuator that follows an envelope by a first-order lag of `rise` frames."""

    def __init__(self, rise, e):
        self.rise, self.e = rise, e
        keep, whole = math.exp(-1 / rise), e.attack + e.release

        def follow(a, b):
            y = 0.0
            for k in range(a, b):
                y = keep * y + (1 - keep) * e.at(k, whole)
            return y
        self.attacked, self.released = follow(0, e.attack), follow(e.attack, whole)

    def left(self, x):
        return math.exp(-x / self.rise)

    def risen(self, x):
        return 1 - (1 - self.attacked) * self.left(x - self.e.attack)

    def fallen(self, x):
        return self.risen(x - self.e.release) * self.left(self.e.release) + self.released


def add_boosts(bursts, rise, half_cycle, gain, most_dbfs):
    """Sets the boosts of a slow tactor's bursts; rise and half_cycle in frames."""
    strength, until = 0.0, 0
    room = 10 ** (min(0, most_dbfs) / 20) / gain - max(b.amplitude for b in bursts)
    for b in bursts:
        lag = Lag(rise, b.envelope)
        before = strength * lag.left(b.first - min(until, b.first))
        most = math.floor(min(b.length, 5 * rise) / half_cycle)
        if b.amplitude > before and room > 0:
            for j in range(max(1, math.ceil(max(1, b.envelope.attack + b.envelope.release) / half_cycle)), most + 1):
                b.boost_frames = math.floor(j * half_cycle + 0.5 + 1e-6)
                missing = max(b.amplitude * (1 - lag.risen(b.boost_frames)) - before * lag.left(b.boost_frames), 0) / lag.fallen(b.boost_frames)
                b.boost = min(missing, room)
                if missing <= room:
                    break
        strength = before * lag.left(b.length) + b.amplitude * lag.fallen(b.length)
        strength += b.boost * lag.fallen(b.boost_frames) * lag.left(b.length - b.boost_frames) if b.boost else 0.0
        until = b.end
        if b.boost * gain <= 1e-5:
            b.boost = 0.0


def groups(bursts):
    """Groups bursts of a tactor that overlap by more than a nanosecond."""
    found = []
    for b in sorted(bursts, key=lambda b: b.first):
        if not b.length:
            continue
        if found and b.first < max(o.end for o in found[-1]) and b.from_s < max(o.to_s for o in found[-1]) - 1e-9:
            found[-1].append(b)
        else:
            found.append([b])
    return found


def joined(sounding, n, overlap):
    """Returns the amplitude of bursts that sound together on a tactor."""
    parts = [b.at(n) for b in sounding]
    if len(parts) == 1:
        return parts[0]
    if overlap == "sum":
        return sum(parts)
    if overlap == "max":
        return max(parts)
    return min(max(b.strength for b in sounding), math.hypot(*parts))


def gain_at(plan, carrier, tactor, n):
    """Returns the factor of a tactor at frame n of the stroke."""
    t, render = plan["array"]["tactors"][tactor], plan["render"]
    db = render["peak_dbfs"][tactor]
    if isinstance(t["threshold_dbfs"], list) and "sl_db" in render:
        hz, points = carrier.hz_at(n / render["rate"]), t["threshold_dbfs"]
        db = points[0][1] if hz <= points[0][0] else points[-1][1]
        for (f, d), (g, e) in zip(points, points[1:]):
            if f <= hz <= g:
                db = d + (e - d) * math.log(hz / f) / math.log(g / f)
        db += render["sl_db"]
    return t["polarity"] * 10 ** (db / 20)


def strengths_of_bursts(plan, carrier):
    """Returns for each group on a tactor: tactor, the frame at which its carrier has phase 0, and (frame, factor) in order."""
    render, by_tactor = plan["render"], {}
    for burst in plan["bursts"]:
        for d in burst["drives"]:
            by_tactor.setdefault(d["tactor"], []).append(Burst(burst, d["amplitude"], render))
    for tactor, bursts in by_tactor.items():
        t = plan["array"]["tactors"][tactor]
        if "rise_s" in t:
            add_boosts(bursts, t["rise_s"] * render["rate"], render["rate"] / 2 / plan["stroke"]["carrier_hz"],
                       abs(gain_at(plan, carrier, tactor, 0)), t.get("max_dbfs", 0))
        for group in groups(bursts):
            first = group[0].first
            gain = gain_at(plan, carrier, tactor, first)
            yield tactor, first if render["phase"] == "burst" else 0, (
                (n, gain * (joined([b for b in group if b.first <= n < b.end], n, render["overlap"]) + sum(b.boost_at(n) for b in group)))
                for n in range(first, max(b.end for b in group)))


def strengths_of_points(plan, carrier):
    """Returns the same of a continuous stroke: straight lines from point to point, one window over all."""
    rate, points = plan["render"]["rate"], plan["continuous"]["points"]
    length = frame_at(plan["stroke"]["duration_s"], rate)
    window = Envelope(length, plan["continuous"]["ramp_s"], plan["render"])
    frames = [min(length, frame_at(k * plan["continuous"]["step_s"], rate)) for k in range(len(points))]
    for a, b, first, end in zip(points, points[1:], frames, frames[1:]):
        was, will = ({d["tactor"]: d["amplitude"] for d in p["drives"]} for p in (a, b))
        for tactor in was.keys() | will.keys():
            x, y = was.get(tactor, 0.0), will.get(tactor, 0.0)
            yield tactor, 0, ((n, gain_at(plan, carrier, tactor, n) * (x + (y - x) * (n - first) / (end - first)) * window.at(n, length))
                              for n in range(first, end))


def samples(told, recording=None):
    """Returns channels of samples, full scale 1, of an object of tactor-plan/1 or tactor-plans/1."""
    plans = told.get("plans", [told])
    render = plans[0]["render"]
    out = [[0.0] * render["frames"] for _ in range(render["channels"])]
    for plan in plans:
        start, carrier = plan["start_frame"], Carrier(plan["stroke"], render["rate"], recording)
        channels = {t["tactor"]: out[t["channel"]] for t in plan["array"]["tactors"]}
        for tactor, origin, strengths in (strengths_of_points if "continuous" in plan else strengths_of_bursts)(plan, carrier):
            for n, strength in strengths:
                channels[tactor][start + n] += strength * carrier.at(n, origin)
        if render["marker"]:
            marker = out[render["marker"]["channel"]]
            for n in range(max(1, frame_at(render["marker"]["duration_s"], render["rate"]))):
                if start + n < len(marker):
                    marker[start + n] = 1.0
    return out
