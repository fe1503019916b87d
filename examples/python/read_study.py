#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Answers of a study that is kept as BIDS: how often each was given, by participant.

    read_study.py FOLDER
"""
import collections
import csv
import pathlib
import sys

folder = pathlib.Path(sys.argv[1])
with open(folder / "participants.tsv", newline="", encoding="utf-8") as f:
    codes = [row["participant_id"] for row in csv.DictReader(f, delimiter="\t")]
for code in codes:
    for file in sorted((folder / code / "beh").glob("*_beh.tsv")):
        with open(file, newline="", encoding="utf-8") as f:
            trials = [row for row in csv.DictReader(f, delimiter="\t") if row["void"] == "false"]
        answer = "rating" if trials and trials[0]["rating"] != "n/a" else "response"
        counts = collections.Counter(row[answer] for row in trials)
        print(f"{file.stem}: {len(trials)} trials: " + ", ".join(f"{a} {n} times" for a, n in sorted(counts.items())))
