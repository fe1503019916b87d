#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Mean ratings in a run of a study, by motion and method, with standard errors over participants: as a figure.

    study_figure.py FOLDER RUN FIGURE.png|.pdf|.svg

Also prints how the last method differs from the first. Needs pandas and Matplotlib.
"""
import sys

import pandas

import tactor

folder, run, figure = sys.argv[1:]
trials = pandas.DataFrame(tactor.study.read(folder))
rated = trials[(trials.run == run) & ~trials.void]
people = rated.pivot_table("rating", ["participant", "motion"], "method_1").groupby("motion")
title = f"{run}, simulated" if rated.simulated.any() else run
axes = people.mean().plot.bar(yerr=people.sem(), rot=0, ylabel="mean rating", title=title)
axes.figure.savefig(figure)

test = tactor.study.analyze(folder)["runs"][run]["paired"]
print(f"difference {test['difference']:.2f}, t({test['df']:.0f}) = {test['t']:.2f}, p = {test['p']:.3g}")
