#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A detection threshold in some minutes: two down, one up.

    staircase.py [DEVICE]          the device plays; answer y or n. Without one: "null", and a simulated observer of -34 dBFS
"""
import random
import sys

import tactor

device = sys.argv[1] if len(sys.argv) > 1 else "null"
palm = tactor.Array.preset("palm-3x3")
plan = tactor.plan(palm, tactor.Stroke.along(tactor.Path.svg("M 0 20 L 40 20"), duration=0.14))
level, steps, down, once, reversals = -20.0, [4.0, 4.0, 2.0, 2.0, 1.0, 1.0], True, False, []
observer = random.Random(1)
with tactor.Player(device, palm) as player:
    while len(reversals) < len(steps):
        player.play(tactor.Score(palm, plan, level_dbfs=level))
        felt = level + observer.gauss(0, 1) > -34 if device == "null" else input("felt? ").startswith("y")
        if felt and not once:
            once = True
            continue
        reversals += [level] if felt != down else []
        down, once = felt, False
        level = min(0.0, level + steps[min(len(reversals), len(steps) - 1)] * (-1 if down else 1))
print(f"threshold: {sum(reversals[2:]) / len(reversals[2:]):.1f} dBFS (reversals at {', '.join(f'{r:g}' for r in reversals)})")
