#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Trials in PsychoPy's time: when the stroke was at the skin, and how long the answer took.

    psychopy_trial.py [DEVICE]     a window asks, and the device plays. Without one: "null", and a simulated participant

Reports have CLOCK_MONOTONIC's times. PsychoPy's clock begins when it is imported, and may be the time of day: where it
stands is measured before each trial. Prints a line a trial, tab-separated.
"""
import random
import sys
import time

import tactor

try:
    from psychopy import core
    get_time = core.getTime
except ImportError:  # without PsychoPy, a clock that began with the machine
    get_time = time.monotonic


def offset(readings=50):
    """Returns PsychoPy's clock less CLOCK_MONOTONIC and its greatest error, s: the quickest of several readings."""
    best, ahead = float("inf"), 0.0
    for _ in range(readings):
        before = time.monotonic()
        theirs = get_time()
        after = time.monotonic()
        if after - before < best:
            best, ahead = after - before, theirs - (before + after) / 2
    return ahead, best / 2


class Window:
    """Asks by PsychoPy."""

    def __init__(self):
        from psychopy import event, visual
        self.event, self.window = event, visual.Window()
        self.text = visual.TextStim(self.window, "Left (f) or right (j)?")

    def answer(self, stroke, onset):
        self.text.draw()
        self.window.flip()
        self.event.clearEvents()
        key, at = self.event.waitKeys(keyList=["f", "j"], timeStamped=True)[0]
        return {"f": "left", "j": "right"}[key], at


class Simulated:
    """Answers after some 0.4 s, mostly right."""

    chance = random.Random(1)

    def answer(self, stroke, onset):
        said = stroke if self.chance.random() < 0.9 else {"left": "right", "right": "left"}[stroke]
        return said, onset + max(0.2, self.chance.gauss(0.4, 0.1))


device = sys.argv[1] if len(sys.argv) > 1 else "null"
participant = Simulated() if device == "null" else Window()
palm = tactor.Array.preset("palm-3x3")
paths = {"left": "M 35 20 L 5 20", "right": "M 5 20 L 35 20"}
plans = {name: tactor.plan(palm, tactor.Stroke.along(tactor.Path.svg(d), duration=0.3)) for name, d in paths.items()}
# Weak, for the first time on a card: then come up in steps of 6 dB.
scores = {name: tactor.Score(palm, plan, level_dbfs=-40) for name, plan in plans.items()}
print("stroke", "started_s", "onset_s", "within_s", "response", "response_time_s", sep="\t")
with tactor.Player(device, palm) as player:
    for name in ("left", "right", "right", "left"):
        ahead, within = offset()
        begins = time.monotonic() + 0.1
        ticket = player.submit(scores[name], at_s=begins)
        response, at = participant.answer(name, begins + ahead)
        report = ticket.wait()
        onset = report.started_s + ahead
        print(name, f"{report.started_s:.6f}", f"{onset:.6f}", f"{within:.9f}", response, f"{at - onset:.4f}", sep="\t")
