# SPDX-License-Identifier: MIT
"""The codes of a session on a channel of a card and on eight lines at once, against the captured sound."""
import re
import struct

from rig import RATE, GpioSim, SessionTest
from test_sync import Onsets, Watch

CHANNELS, CODE = 10, 9
BIT = RATE * 2 // 1000
LEAD = 9 * BIT
TRIALS = 10
STIMULUS, ANSWER = 0x81, 0x42  # only stimuli have the first line's bit; each answer is 2

RATINGS = SessionTest.HEAD + f"""[[run]]
name = "ratings"
task = "rate"
attribute = "similarity"
trials = {TRIALS}
scale = 3
"""


class Codes(SessionTest):
    def test_codes_end_where_the_stimulus_begins_and_the_lines_switch_there(self):
        gpio = GpioSim()
        self.addCleanup(gpio.close)
        array = self.grid(extra=f'[sync]\ncode = {{ channel = {CODE}, chip = "{gpio.label}", offsets = {list(range(8))}, pulse_ms = 60 }}\n'
                                f"[sync.codes]\nstimulus = {STIMULUS}\nanswer = {ANSWER - 1}\nvoid = 2\n")
        onsets, watch = Onsets(self.dir, CHANNELS), Watch(gpio, 0)
        err = self.hold(RATINGS, "y\n" * 9 + "\n" + "2\n" * 3 * TRIALS, timeout=300)
        heard, pulses = onsets.stop(), watch.stop()
        self.assertEqual([gpio.value(i) for i in range(8)], [0] * 8)

        got = (self.dir / "capture.raw").read_bytes()
        code = [v[0] for v in struct.iter_unpack("<i", b"".join(got[i + 4 * CODE:i + 4 * CODE + 4] for i in range(0, len(got) - 39, 4 * CHANNELS)))]
        found, at = [], 0
        while at < len(code) - LEAD:
            if code[at]:
                found.append((at, sum((code[at + (i + 1) * BIT + BIT // 2] > 0) << i for i in range(8))))
                at += LEAD
            at += 1
        events = [e for e in self.table("ratings", "events") if e["event"] != "void"]
        rows = {(r["trial"], r["attempt"]): r for r in self.table("ratings")}
        self.assertEqual([n for _, n in found if n in (STIMULUS, ANSWER)], [int(e["code"]) for e in events])
        whole = self.rendered(rows[events[0]["trial"], events[0]["attempt"]]["plan_1"], array)
        places = [at for at, n in found if n == STIMULUS]
        exact = 0
        for at, e in zip(places, [e for e in events if int(e["code"]) == STIMULUS]):
            row = rows[e["trial"], e["attempt"]]
            self.assertEqual(int(row["frame_1"]) - int(e["frame"]), LEAD)
            start = (at + LEAD) * 4 * CHANNELS
            exact += got[start:start + len(whole)] == whole or row["void"] == "true"
        self.assertEqual(exact, len(places))
        print(f"code on the channel: {len(places)} stimuli, each {LEAD} frames after its start bit, exact")

        lead_ns = LEAD * 10 ** 9 // RATE
        late = [min(((p[0] - h - lead_ns, p[1] - h - lead_ns) for h in heard), key=lambda d: abs(d[1])) for p in pulses]
        print(f"codes on the lines after the stimulus, ms: n {len(late)}, between {min(d[0] for d in late) / 1e6:.2f} and "
              f"{max(d[1] for d in late) / 1e6:.2f}")
        sent, missed, worst = re.search(r"lines of codes: (\d+) pulses .*, (\d+) missed, late by .* worst (.*) ms", err).groups()
        print(err[err.index("tactor: lines of codes"):].strip())
        self.assertEqual(int(sent) + int(missed), len(places))  # the walk shows no number
        self.assertEqual(len(pulses), int(sent))
        self.assertLess(max(d[0] for d in late) / 1e6, float(worst) + 10)
