# SPDX-License-Identifier: MIT
"""Phantom models that are Python objects, and their faults."""
import os
import subprocess
import sys
import textwrap

import numpy as np
import pytest

import tactor
from conftest import refused

LONG = 120.0  # s: a longer answer never comes


class Meddling:
    """A model that acts on the stroke that asks it."""

    def __init__(self, does):
        self.does = does
        self.stroke = None

    def weights(self, x_mm, y_mm, intensity):
        self.does(self.stroke)
        return {4: intensity}


@pytest.mark.parametrize("smooth", [0.0, 0.05])
def test_a_model_that_moves_its_own_stroke_is_refused_and_ends_it(player, smooth):
    model = Meddling(lambda stroke: stroke.to(20, 20))
    with player.live(phantom=model, timeout=LONG, smooth=smooth) as finger:
        model.stroke = finger
        with pytest.raises(tactor.StreamError, match="its phantom model moves the stroke"):
            finger.to(10, 10)
        assert not finger.to(10, 10)
    assert finger.report.state == "interrupted" and "its phantom model moves the stroke" in finger.report.reason


@pytest.mark.parametrize("does", [
    lambda stroke: stroke.end(), lambda stroke: stroke.cancel(), lambda stroke: (stroke.open, stroke.counts, stroke.done(), repr(stroke)),
    lambda stroke: stroke._player.core.stats(), lambda stroke: stroke._player.core.position(),
])
def test_a_model_may_do_anything_else_to_its_own_stroke(player, does):
    model = Meddling(does)
    with player.live(phantom=model, timeout=LONG) as finger:
        model.stroke = finger
        finger.to(10, 10)
    assert finger.report.state in ("finished", "cancelled")


AT_EXIT = """
    import sys, threading, time
    import tactor

    class Busy:
        def weights(self, x_mm, y_mm, intensity):
            entered.set()
            for _ in range(1000):
                time.sleep(0)
            return {4: intensity}

    class Slow:  # while the interpreter ends, the thread asks for its lock
        def __del__(self, sleep=time.sleep):
            sleep(0.2)

    def feed():
        while True:
            finger.to(20, 20)

    def plan():
        while True:
            tactor.plan(palm, stroke, algorithm="continuous", phantom=Busy())

    def count():
        entered.set()
        while True:
            player.stats()
            palm.faces
            score.render()

    entered = threading.Event()
    palm = tactor.Array.preset("palm-3x3")
    stroke = tactor.Stroke.preset("park2016-1")
    score = tactor.Score(palm, tactor.plan(palm, stroke))
    player = tactor.Player("null", palm)
    finger = player.live(phantom=Busy(), timeout=3600.0)
    slow = Slow()
    threading.Thread(target={"feed": feed, "plan": plan, "count": count}[sys.argv[1]], daemon=True).start()
    entered.wait()
    if sys.argv[1] != "feed":
        finger.cancel()
"""


@pytest.mark.parametrize("what", ["feed", "plan", "count"])
@pytest.mark.unsanitized  # the thread never frees its objects
def test_a_program_ends_while_a_daemon_thread_is_in_the_package(what):
    env = {**os.environ, "TACTOR_CONFIG": os.devnull}
    for _ in range(5):
        r = subprocess.run([sys.executable, "-c", textwrap.dedent(AT_EXIT), what], env=env, capture_output=True, text=True, timeout=LONG, check=False)
        assert r.returncode == 0 and "terminate" not in r.stderr and "Fatal" not in r.stderr, r.stderr


RUBBISH = [
    (None, "it returned None"), (3, "it returned 3"), ([(0, 1.0)], "it returned [(0, 1.0)]"), ({9: 1.0}, "9 is out of range"),
    ({-1: 1.0}, "-1 is out of range"), ({2**70: 1.0}, "is out of range"), ({1.7: 1.0}, "1.7 is not a whole number"),
    ({"3": 1.0}, "'3' is not a number"), ({None: 1.0}, "None is not a number"), ({0: float("nan")}, "nan is out of range"),
    ({0: -1.0}, "-1.0 is out of range"), ({0: "0.5"}, "'0.5' is not a number"), ({0: 10**400}, "is out of range"), ({0: None}, "None is not a number"),
]


@pytest.mark.parametrize("answer,why", RUBBISH)
def test_rubbish_is_refused_and_ends_a_live_stroke_with_that_reason(palm, stroke, player, answer, why):
    class Rubbish:
        name = "rubbish"

        def weights(self, x_mm, y_mm, intensity):
            return answer
    e = refused(lambda: tactor.plan(palm, stroke, phantom=Rubbish()))
    assert why in str(e) and e.what == "phantom rubbish"
    with player.live(phantom=Rubbish(), timeout=LONG) as finger:
        refused(lambda: finger.to(20, 20))
    assert finger.report.state == "interrupted" and why in finger.report.reason


def test_whole_numbers_and_amplitudes_of_numpy_are_accepted(palm, stroke):
    class Given:
        def weights(self, x_mm, y_mm, intensity):
            return {np.int64(4): np.float32(0.5), np.uint8(3): np.array(0.25)}
    drives = tactor.plan(palm, stroke, phantom=Given()).bursts[0].drives
    assert drives == ((3, 0.25), (4, 0.5))
