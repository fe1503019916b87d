# SPDX-License-Identifier: MIT
"""A session on a real clock: the stimuli of a pair and the noise, as one card receives them; and a card that goes away."""
import json
import subprocess

import rig
from rig import OUT, RATE, Capture, Card, SessionTest, until

# Two streams and their mixer share two emulated processors.
PERIOD, PERIODS = 480, 32
CHANNELS, NOISE = 11, 9  # the array's nine and the noise's two
GAP_S = 0.0321

PAIRS = SessionTest.HEAD.replace("[[motion]]", f"""gap_s = {GAP_S}
[masking]
noise = "white"
level_dbfs = -30
[[motion]]""") + """[[method]]
name = "Birch"
algorithm = "park2016"
[[run]]
name = "pairs"
task = "choose"
attribute = "similarity"
question = "Which one?"
trials = 2
"""


class Experiment(SessionTest):
    def side_by_side(self):
        """Configures the array's stream and the noise's on channels of one card, sample by sample in parallel."""
        stream = """pcm.{name} {{
    type dshare
    ipc_key 20160409
    ipc_perm 0600
    slave {{ pcm "{card}" channels {channels} format S32_LE rate {rate} period_size {period} buffer_size {buffer} }}
    bindings {{ {bindings} }}
}}
"""
        which = {"tactors": range(NOISE), "phones": range(NOISE, CHANNELS)}
        self.write(".asoundrc", "".join(
            stream.format(name=name, card=OUT.format(0), channels=CHANNELS, rate=RATE, period=PERIOD, buffer=PERIOD * PERIODS,
                          bindings=" ".join(f"{i} {c}" for i, c in enumerate(channels))) for name, channels in which.items()))

    def test_a_card_that_goes_away_makes_its_trial_void_and_the_session_goes_on(self):
        self.addCleanup(Card.plug_in)
        self.grid()
        self.write("pairs.toml", PAIRS.replace("duration = 0.2", "duration = 2").replace('noise = "white"', 'noise = "none"'))
        p = self.start("experiment", "pairs.toml", "--participant", "01", "-o", "study", stdin=subprocess.PIPE)
        p.stdin.write("y\n" * 10 + "1\n" * 10)
        p.stdin.flush()
        until(p, "Trial 1/2")
        pull = Card.pull_out()
        pull.wait(60)
        Card.plug_in()
        said, err = p.communicate(timeout=200)
        self.assertEqual(p.returncode, 0, said + err)
        rows = self.table("pairs")
        self.assertEqual([(r["trial"], r["attempt"], r["void"]) for r in rows[:1]], [("1", "1", "true")], rows)
        self.assertEqual(sorted(r["trial"] for r in rows if r["void"] == "false"), ["1", "2"])
        self.assertEqual({r["stream"] for r in rows if r["void"] == "false"}, {"2"})
        self.assertEqual(len(json.loads((self.dir / "study/sourcedata/sub-01/session.json").read_text())["streams"]), 2)

    def test_the_gap_is_exact_and_the_noise_covers_both(self):
        self.side_by_side()
        array = self.grid()
        array.write_text(array.read_text().replace(f"period_frames = {rig.PERIOD}", f"period_frames = {PERIOD}"))
        capture = Capture(self.dir, CHANNELS, "S32_LE")
        self.hold(PAIRS, "y\n" * 9 + "1\n" * 9, "-D", "tactors", "--masker", "phones")
        got = capture.stop()
        frame = capture.frame_bytes
        heard = b"".join(got[i:i + 4 * NOISE] for i in range(0, len(got), frame))
        noise = b"".join(got[i + 4 * NOISE:i + frame] for i in range(0, len(got), frame))
        rows = [r for r in self.table("pairs") if r["void"] == "false"]
        self.assertEqual(len(rows), 2)
        after = 0
        for row in rows:
            first, second = (self.rendered(row[f"plan_{i}"], array) for i in (1, 2))
            pair = first + bytes(4 * NOISE * round(GAP_S * RATE)) + second
            at = heard.find(pair, after)
            self.assertGreaterEqual(at, 0, "both stimuli, and so many frames between them")
            self.assertEqual(at % (4 * NOISE), 0)
            self.assertEqual(int(row["frame_2"]) - int(row["frame_1"]), len(first) // (4 * NOISE) + round(GAP_S * RATE))
            after = at + len(pair)
            # White noise has hardly a zero sample.
            under = noise[at // (4 * NOISE) * 8:after // (4 * NOISE) * 8]
            self.assertLess(sum(under[i:i + 4] == bytes(4) for i in range(0, len(under), 4)), 3)
        print(f"pairs: {len(rows)} of {len(pair) // (4 * NOISE)} frames with a gap of {round(GAP_S * RATE)}, byte by byte, under noise")
