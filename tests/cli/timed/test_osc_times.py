# SPDX-License-Identifier: MIT
"""OSC's time tags on two real clocks: the sender's and the DAC's."""
from harness import main
from osc import begun_by_a_time_tag
from serving import ServeTest


class OscTimes(ServeTest):
    def test_a_time_tag_is_the_time_of_the_first_sample_at_the_dac(self):
        began, period_s = begun_by_a_time_tag(self, self.serve("--osc", "0"))
        began.sort(key=abs)
        # play and drive to the sample, as far as the two clocks' readings agree; the live stroke to a period, and later where
        # the service waits for its turn.
        self.assertLess(abs(began[0]), 0.001)
        self.assertLess(abs(began[1]), 0.001)
        self.assertGreater(began[2], -1.5 * period_s - 0.002)
        self.assertLess(began[2], 0.25)


if __name__ == "__main__":
    main()
