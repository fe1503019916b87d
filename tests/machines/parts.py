# SPDX-License-Identifier: MIT
"""Simulated studies in two parts side by side: the bytes of one run, how much faster, and what a part costs.

Usage: parts.py TOOL     the times are of this machine, which must have nothing else to do. Ends with a line that counts.
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
STUDIES = 400


def main():
    tool = pathlib.Path(sys.argv[1]).resolve()
    cores = len(os.sched_getaffinity(0))

    def power(studies, *more):
        return [str(tool), "experiment", str(ROOT / "examples/experiments/speed-jnd.toml"), "--power", "12", "--studies", str(studies),
                "--simulate", "pse=76,jnd=14", *more]

    def seconds(*commands):
        began = time.monotonic()
        running = [subprocess.Popen(c, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) for c in commands]
        outputs = [p.communicate()[0] for p in running]
        if any(p.returncode for p in running):
            raise RuntimeError(f"{commands}: status {[p.returncode for p in running]}")
        return time.monotonic() - began, outputs[0]

    with tempfile.TemporaryDirectory() as folder:
        files = [f"{folder}/part{k}.json" for k in (1, 2)]
        one_s, whole = seconds(power(STUDIES))
        two_s, _ = seconds(*(power(STUDIES, "--part", f"{k}/2", "-o", f) for k, f in enumerate(files, 1)))
        merge_s, merged = seconds(power(STUDIES, "--merge", *files))
        first_s, _ = seconds(power(1, "--part", "1/1", "-o", f"{folder}/first.json"))  # a part of other studies is not replaced
    print(f"{STUDIES} studies of 12 people: {one_s:.1f} s; two parts side by side on {cores} cores: {two_s:.1f} s, {one_s / two_s:.2f} times as fast")
    print(f"a part of one study: {first_s:.2f} s, of it {one_s / STUDIES:.2f} s its study; joining two parts: {merge_s:.2f} s")
    same = merged == whole and whole != b""
    fast = cores < 2 or one_s / two_s > 1.5
    for good, what in ((same, "the parts do not join to the bytes of one run"), (fast, "two cores are hardly faster than one")):
        if not good:
            print(f"FAILED: {what}")
    print(f"{same + fast} passed, {2 - same - fast} failed, 0 skipped")
    return 0 if same and fast else 1


if __name__ == "__main__":
    sys.exit(main())
