# SPDX-License-Identifier: MIT
"""Answers of two builds of the tool to the same questions.

Usage: answers.py TOOL... > FILE      asks: plans of all presets with each algorithm and phantom, samples in each format
       answers.py --compare A B      counts where two such files differ
Samples must be the same to the byte, and so must simulated sessions: their trials in order, and what was answered. Numbers in plans may differ by TOLERANCE: the C library's sine, hypot and so on
round the last bit as the processor's instructions make it easy, and JSON shows all bits.
"""
import hashlib
import json
import pathlib
import subprocess
import sys
import tempfile

TOLERANCE = 1e-12  # of mm and s; relative above one
PRESETS = [f"park2016-{i}" for i in (1, 2, 3, 4)]
METHODS = [["--algorithm", "park2016"], ["--algorithm", "tactile-brush", "--snap", "--drop-points"],
           ["--algorithm", "continuous"]]
PHANTOMS = ["inverse-distance", "barycentric", "linear", "log", "gaussian"]
FORMATS = ["float", "s16", "s24", "s32"]
CURVE = ["--path", "M 0 10 C 20 -5 20 45 40 30", "--speed", "80"]


def questions():
    for method in METHODS:
        for phantom in PHANTOMS:
            for stroke in [[p] for p in PRESETS] + [CURVE]:
                if method[1] != "tactile-brush" or stroke != CURVE:
                    yield ["plan", *stroke, *method, "--phantom", phantom, "--format", "json"]
        for form in FORMATS:
            yield ["render", "park2016-3", *method, "--phantom", "gaussian", "--sample-format", form]
    for phase in ("stroke", "burst"):
        yield ["render", *CURVE, "--phase", phase, "--carrier", "173.3", "--ramp", "0.003"]
        yield ["render", *CURVE, "--phase", phase, "--rate", "22050"]
    for code in ("01", "02"):
        yield ["experiment", "park2016", "--participant", code, "--seed", "7", "--simulate", "seed=1,sigma=1"]
    yield ["experiment", "park2016", "--participant", "P3", "--dry-run", "--format", "json"]


def said(*command):
    r = subprocess.run(command, capture_output=True, check=False)
    if r.returncode:
        sys.exit(f"{' '.join(command)}: {r.stderr.decode()}")
    return r.stdout


def answer(tool, question):
    if question[0] == "plan" or "--dry-run" in question:
        return json.loads(said(*tool, *question))
    with tempfile.TemporaryDirectory() as folder:
        if question[0] == "experiment":
            said(*tool, *question, "-o", folder)
            return {f.name: f.read_text(encoding="utf-8") for f in sorted(pathlib.Path(folder).glob("sub-*/beh/*.tsv"))}
        file = pathlib.Path(folder) / "a.wav"
        said(*tool, *question, "-o", str(file))
        return hashlib.sha256(file.read_bytes()).hexdigest()


def differences(a, b, where=""):
    if isinstance(a, dict) and isinstance(b, dict) and a.keys() == b.keys():
        for key in a:
            yield from differences(a[key], b[key], f"{where}.{key}")
    elif isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        for i, (x, y) in enumerate(zip(a, b)):
            yield from differences(x, y, f"{where}[{i}]")
    elif isinstance(a, float) and isinstance(b, float):
        if not abs(a - b) <= TOLERANCE * max(1.0, abs(a)):
            yield f"{where}: {a!r} and {b!r}"
    elif a != b:
        yield f"{where}: {str(a)[:80]} and {str(b)[:80]}"


def compare(files):
    ours, theirs = ([json.loads(line) for line in pathlib.Path(f).read_text(encoding="utf-8").splitlines()]
                    for f in files)
    if not ours or [q for q, _ in ours] != [q for q, _ in theirs]:
        sys.exit("answers.py: the questions differ")
    failed = 0
    for (question, a), (_, b) in zip(ours, theirs):
        found = list(differences(a, b))
        if found:
            print(*question)
            print("   ", *found[:5], sep="\n    ")
        failed += bool(found)
    print(f"{len(ours) - failed} passed, {failed} failed")
    return 1 if failed else 0


def main():
    if sys.argv[1] == "--compare":
        return compare(sys.argv[2:])
    for question in questions():
        print(json.dumps([question, answer(sys.argv[1:], question)]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
