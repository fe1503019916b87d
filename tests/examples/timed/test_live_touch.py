# SPDX-License-Identifier: MIT
"""A finger at rest keeps its stroke alive: the program repeats its place in time."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import test_examples  # noqa: E402


class LiveTouch(test_examples.ToolTest):
    start, heard, live_touches = (getattr(test_examples.Examples, n) for n in ("start", "heard", "live_touches"))

    def test_each_touch_is_one_stroke(self):
        self.assertEqual(self.live_touches(), ["finished", "finished"])


if __name__ == "__main__":
    test_examples.main()
