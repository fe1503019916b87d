#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Trials in PsychoPy's time: when the stroke was at the DAC, and how long the answer took.

    tactor serve --tcp 4001 -D hw:CARD=Tactor
    trial.py [PORT]       with PsychoPy's Python; not tried with PsychoPy itself

Prints a line a trial, tab-separated.
"""
import sys

from psychopy import event, visual
from psychopy.hardware import DeviceManager

port = int(sys.argv[1]) if len(sys.argv) > 1 else 4001
tactor = DeviceManager.addDevice("psychopy_tactor.TactorDevice", "tactor", port=port)
window = visual.Window()
question = visual.TextStim(window, "Left (f) or right (j)?")
paths = {"left": "M 35 20 L 5 20", "right": "M 5 20 L 35 20"}
# Weak, for the first time on a card: then come up in steps of 6 dB.
options = {"duration": 0.3, "level_dbfs": -40}

print("stroke", "state", "onset_s", "within_s", "response", "response_time_s", sep="\t")
for name in ("left", "right", "right", "left"):
    question.draw()
    window.flip()
    event.clearEvents()
    stroke = tactor.play(path=paths[name], options=options, start={"delay_s": 0.1})
    key, at = event.waitKeys(keyList=["f", "j"], timeStamped=True)[0]
    report = tactor.wait(stroke)
    if report["state"] != "finished":  # this trial does not count
        print(name, report["state"], report["reason"], sep="\t")
        continue
    response = {"f": "left", "j": "right"}[key]
    print(name, report["state"], f"{report['onset_s']:.6f}", f"{report['within_s']:.6f}", response, f"{at - report['onset_s']:.4f}", sep="\t")
DeviceManager.removeDevice("tactor")
