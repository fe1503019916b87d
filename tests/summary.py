# SPDX-License-Identifier: MIT
"""Counts test cases over all suites of a Meson test run, and over further lanes, and prints the closing line.

Usage: summary.py testlog.json [[NAME=]LOG ...]; without a name a log is a lane, named as the file. Exit status 1 when something failed or nothing ran.
A suite that says nothing countable counts as one test; a lane without a closing line has failed.
"""
import json
import pathlib
import re
import sys

DOCTEST = re.compile(r"\[doctest\] test cases:\s+\d+ \|\s+(\d+) passed \|\s+(\d+) failed \|\s+(\d+) skipped")
COUNTED = re.compile(r"^(\d+) passed, (\d+) failed(?:, (\d+) skipped)?$", re.M)
# Lines that unittest prints above each case that failed, and those of this script for a lane's suites.
FAILED = re.compile(r"^(?:FAIL|ERROR|\s*FAILED): +(.*)$", re.M)
# doctest names a case above each of its messages, too.
CASE = re.compile(r"^TEST CASE: +(.*)$", re.M)


def failed_cases(text):
    """Returns the names of the cases that failed, each once."""
    names = [name for block in re.split(r"^={9,}$", text, flags=re.M) if " ERROR: " in block for name in CASE.findall(block)]
    return list(dict.fromkeys(names + FAILED.findall(text)))


def suite_counts(result, output):
    match = DOCTEST.search(output) or COUNTED.search(output)
    passed, failed, skipped = (int(n or 0) for n in match.groups()) if match else (0, 0, 0)
    if result not in ("OK", "SKIP", "EXPECTEDFAIL") and failed == 0:
        failed = 1  # crashed, timed out, or failed outside its cases
    if result == "SKIP":
        skipped = max(skipped, 1)
    if passed + failed + skipped == 0:
        passed = 1
    return passed, failed, skipped


def lane_counts(text):
    lines = COUNTED.findall(text)
    return tuple(int(n or 0) for n in lines[-1]) if lines else (0, 1, 0)


def results(arguments):
    with open(arguments[0], encoding="utf-8") as log:
        for entry in map(json.loads, log):
            text = re.sub(r"\x1b\[[0-9;]*m", "", entry.get("stdout", ""))
            yield entry["name"], suite_counts(entry["result"], text), text
    for argument in arguments[1:]:
        name, _, file = argument.rpartition("=")
        text = pathlib.Path(file).read_text(encoding="utf-8", errors="replace")
        yield name or f"lane {pathlib.Path(file).stem}", lane_counts(text), text


def main():
    totals = [0, 0, 0]
    for name, counts, text in results(sys.argv[1:]):
        print(f"{name:<28} {counts[0]:>6} passed {counts[1]:>4} failed {counts[2]:>4} skipped")
        if counts[1]:
            for case in failed_cases(text) or [f"{name}: crashed, ran out of time or named no case"]:
                print("  FAILED: " + case)
        for line in re.findall(r"^\s*((?:SKIPPED|SHORTENED): .*)$", text, re.M):
            print("  " + line)
        totals = [a + b for a, b in zip(totals, counts)]
    print(f"{totals[0]} passed, {totals[1]} failed, {totals[2]} skipped")
    return 1 if totals[1] or not totals[0] else 0


if __name__ == "__main__":
    sys.exit(main())
