#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures the processor time of short commands and of `aplay --version` in one run.

Usage: start.py TOOL [ROUNDS]      e.g. tests/bench/start.py build/src/cli/tactor
The commands take turns, so that what else the machine does disturbs all of them; the median of each counts.
"""
import os
import shutil
import statistics
import subprocess
import sys


def processor_ms(command):
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, close_fds=False)
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"{' '.join(command)}: status {process.returncode}")
    return 1000.0 * (used.ru_utime + used.ru_stime)


def main():
    tool = sys.argv[1]
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 300
    aplay = shutil.which("aplay")
    if aplay is None:
        sys.exit("start.py: aplay is missing, with which the tool is compared (package alsa-utils)")
    commands = [[aplay, "--version"], [tool, "--version"], [tool, "plan", "park2016-1"], [tool, "plan", "--help"]]
    for command in commands:
        processor_ms(command)  # from disk, once
    spent = [[processor_ms(c) for c in commands] for _ in range(rounds)]
    medians = [statistics.median(column) for column in zip(*spent)]
    for command, least, median in zip(commands, (min(c) for c in zip(*spent)), medians):
        print(f"{' '.join([os.path.basename(command[0]), *command[1:]]):24} {median:6.2f} ms, at best {least:5.2f}"
              f"   {median / medians[0]:5.2f} times aplay")


if __name__ == "__main__":
    main()
