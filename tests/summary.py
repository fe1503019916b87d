# SPDX-License-Identifier: MIT
"""Counts test cases over all suites of a Meson test run and prints the closing line.

Usage: summary.py testlog.json. Exit status 1 when something failed or nothing ran.
A suite that says nothing countable counts as one test.
"""
import json
import re
import sys

DOCTEST = re.compile(r"\[doctest\] test cases:\s+\d+ \|\s+(\d+) passed \|\s+(\d+) failed \|\s+(\d+) skipped")
COUNTED = re.compile(r"^(\d+) passed, (\d+) failed(?:, (\d+) skipped)?$", re.M)


def count(entry):
    match = DOCTEST.search(re.sub(r"\x1b\[[0-9;]*m", "", entry.get("stdout", "")))
    match = match or COUNTED.search(entry.get("stdout", ""))
    passed, failed, skipped = (int(n or 0) for n in match.groups()) if match else (0, 0, 0)
    if entry["result"] not in ("OK", "SKIP", "EXPECTEDFAIL") and failed == 0:
        failed = 1  # crashed, timed out, or failed outside its cases
    if entry["result"] == "SKIP":
        skipped = max(skipped, 1)
    if passed + failed + skipped == 0:
        passed = 1
    return passed, failed, skipped


def main():
    totals = [0, 0, 0]
    with open(sys.argv[1], encoding="utf-8") as log:
        for line in log:
            entry = json.loads(line)
            counts = count(entry)
            print(f"{entry['name']:<28} {counts[0]:>6} passed {counts[1]:>4} failed {counts[2]:>4} skipped")
            for text in re.findall(r"^SKIPPED: .*$", entry.get("stdout", ""), re.M):
                print("  " + text)
            totals = [a + b for a, b in zip(totals, counts)]
    print(f"{totals[0]} passed, {totals[1]} failed, {totals[2]} skipped")
    return 1 if totals[1] or not totals[0] else 0


if __name__ == "__main__":
    sys.exit(main())
