# SPDX-License-Identifier: MIT
"""OSC's time tags on two real clocks: the senders' and the DAC's."""
import time

from harness import main
from osc import Sender, bundle, message
from serving import ServeTest

DRAWING = "M 0 0 L 40 40"


class OscTimes(ServeTest):
    def test_time_tags_say_when_the_first_sample_is_at_the_dac(self):
        s = self.serve("--osc", "0")
        watcher = s.client()
        watcher.ok("subscribe", events=["strokes"])
        period_s = watcher.ok("hello")["stream"]["period_frames"] / watcher.ok("hello")["stream"]["rate"]
        a = Sender(self, s)
        then = time.time() + 0.6
        a.raw(bundle(then, message("/tactor/play", 1, DRAWING, "duration=0.05"), message("/tactor/drive", 0, 0.5, 0.02),
                     message("/tactor/begin", 2, "timeout_s=5"), message("/tactor/to", 2, 20, 20)))
        began = []
        while len(began) < 3:
            p = watcher.notification(lambda m: m["params"].get("state") == "started")["params"]
            began.append(p["started_unix_s"] - then)
        states = sorted(a.next()[1:] for _ in range(3))
        self.assertEqual(states, [[0, "started"], [1, "started"], [2, "started"]])
        began.sort(key=abs)
        # play and drive to the sample, as far as the two clocks' readings agree; the live stroke to a period, and later where the
        # machine lets the service wait for its turn.
        self.assertLess(abs(began[0]), 0.001)
        self.assertLess(abs(began[1]), 0.001)
        self.assertGreater(began[2], -1.5 * period_s - 0.002)
        self.assertLess(began[2], 0.25)


if __name__ == "__main__":
    main()
