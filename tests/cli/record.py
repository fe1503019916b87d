# SPDX-License-Identifier: MIT
"""The samples of a plan from its JSON alone, by the formulas of tactor-json(5), as a reader of the record would write them."""
import math


def frame_at(t_s, rate):
    return math.floor(t_s * rate + 0.5 + 1e-6)


def window(k, length, ramp):
    """Returns a raised cosine at both ends."""
    inside = min(k, length - k)
    return 0.5 - 0.5 * math.cos(math.pi * inside / ramp) if inside < ramp else 1.0


class Burst:
    """A tactor's part in a burst, in frames of the stroke."""

    def __init__(self, burst, amplitude, rate):
        self.from_s, self.to_s = burst["onset_s"], burst["onset_s"] + burst["duration_s"]
        self.first, self.end = frame_at(self.from_s, rate), frame_at(self.to_s, rate)
        self.length = self.end - self.first
        self.ramp = min(frame_at(burst["ramp_s"], rate), self.length // 2)
        self.amplitude = amplitude
        self.strength = max(burst["intensity"], math.sqrt(sum(d["amplitude"] ** 2 for d in burst["drives"])))

    def at(self, n):
        return self.amplitude * window(n - self.first, self.length, self.ramp)


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
    return min(max(b.strength for b in sounding), math.sqrt(sum(a * a for a in parts)))


def envelopes_of_bursts(plan):
    """Returns for each group on a tactor: tactor, first frame of its carrier, and (frame, amplitude) in order."""
    rate, overlap = plan["render"]["rate"], plan["render"]["overlap"]
    by_tactor = {}
    for burst in plan["bursts"]:
        for d in burst["drives"]:
            by_tactor.setdefault(d["tactor"], []).append(Burst(burst, d["amplitude"], rate))
    for tactor, bursts in by_tactor.items():
        for group in groups(bursts):
            first = group[0].first
            frames = range(first, max(b.end for b in group))
            yield tactor, first if plan["render"]["phase"] == "burst" else 0, (
                (n, joined([b for b in group if b.first <= n < b.end], n, overlap)) for n in frames)


def envelopes_of_points(plan):
    """Returns the same of a continuous stroke: straight lines from point to point, one window over all."""
    rate, points = plan["render"]["rate"], plan["continuous"]["points"]
    length = frame_at(plan["stroke"]["duration_s"], rate)
    ramp = min(frame_at(plan["continuous"]["ramp_s"], rate), length // 2)
    frames = [min(length, frame_at(k * plan["continuous"]["step_s"], rate)) for k in range(len(points))]
    for a, b, first, end in zip(points, points[1:], frames, frames[1:]):
        was, will = ({d["tactor"]: d["amplitude"] for d in p["drives"]} for p in (a, b))
        for tactor in was.keys() | will.keys():
            x, y = was.get(tactor, 0.0), will.get(tactor, 0.0)
            yield tactor, 0, ((n, (x + (y - x) * (n - first) / (end - first)) * window(n, length, ramp))
                              for n in range(first, end))


def samples(told):
    """Returns channels of samples, full scale 1, of an object of tactor-plan/1 or tactor-plans/1."""
    plans = told.get("plans", [told])
    render = plans[0]["render"]
    out = [[0.0] * render["frames"] for _ in range(render["channels"])]
    for plan in plans:
        start, carrier = plan["start_frame"], 2 * math.pi * plan["stroke"]["carrier_hz"] / render["rate"]
        tactors = {t["tactor"]: t for t in plan["array"]["tactors"]}
        for tactor, carrier_start, envelope in envelopes_of_points(plan) if "continuous" in plan else envelopes_of_bursts(plan):
            peak = tactors[tactor]["polarity"] * 10 ** (render["peak_dbfs"][tactor] / 20)
            channel = out[tactors[tactor]["channel"]]
            for n, amplitude in envelope:
                channel[start + n] += peak * amplitude * math.sin(carrier * (n - carrier_start))
        if render["marker"]:
            marker = out[render["marker"]["channel"]]
            for n in range(max(1, frame_at(render["marker"]["duration_s"], render["rate"]))):
                if start + n < len(marker):
                    marker[start + n] = 1.0
    return out
