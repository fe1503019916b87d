# SPDX-License-Identifier: MIT
"""How often tests find a difference that is not there, in simulated studies of 12 people who differ.

Usage: error_rates.py TOOL. All methods of a study have the same options under other names, and people's mean values equal those compared
with. Of 1,000 studies 4 to 6 % should be significant: a share outside the 99.9 % interval about 5 % fails. Ends with a line that counts.
"""
import concurrent.futures
import json
import pathlib
import subprocess
import sys
import tempfile

PEOPLE, STUDIES = 12, 1000
LOW, HIGH = 0.029, 0.074  # binomial, 1,000 studies, 99.9 %
GG_LOW = 0.012  # three levels: with 12 people the correction of Greenhouse and Geisser is conservative
START = """[experiment]
name = "none"
array = "palm-3x3"
level = { dbfs = -20 }
"""
MOTIONS = """[[motion]]
name = "right"
path = "M0 20H40"
duration = 0.7
[[motion]]
name = "down"
path = "M20 0V40"
duration = 0.7
"""
SPEEDS = 'question = "?"\nvary = "speed_mm_s"\nvalues = [20, 40, 50, 60, 70, 80, 100]\n'
RUNS = {
    "choose": 'attribute = "similarity"\ntrials = 40\n',
    "rate": 'attribute = "similarity"\nscale = "vas"\nlabels = ["a", "b"]\ntrials = 24\n',
    "identify": 'trials = 48\n',
    "detect": 'catch = 0.5\ntrials = 96\n',
    "estimate": SPEEDS + 'trials = 42\nstandard = 60\n',
    "constant": SPEEDS + 'trials = 168\nstandard = 60\n',
    "adaptive": 'question = "?"\nvary = "speed_mm_s"\nprocedure = "1up1down"\nrange = [20, 100]\nstandard = 60\nstart = 100\nsteps = [16, 8, 4]\ntrials = 240\ntracks = 2\n',
    "interval": SPEEDS + 'trials = 168\n',
    "locate": 'trials = 24\n',
    "trace": 'trials = 24\n',
    "same-different": 'trials = 40\n',
    "oddity": 'trials = 36\n',
    "adjust": 'question = "?"\nvary = "speed_mm_s"\nrange = [20, 100]\nstandard = 60\ntrials = 48\n',
}
USUAL = "sigma=20,pse=60,jnd=10,pse_sd=5,jnd_sd=5,dprime=1.5,dprime_sd=0.5,exponent_sd=0.2,correlation=0.5,method_sd=10"
OTHERS = {"identify": "sigma=60", "estimate": "sigma=0.3,exponent_sd=0.2", "same-different": "dprime=0", "oddity": "dprime=0"}


def define(task, methods, sessions):
    return (START + f"sessions = {sessions}\n" + MOTIONS + "".join(f'[[method]]\nname = "{m}"\n' for m in methods)
            + f'[[run]]\nname = "{task}"\ntask = "{task}"\n' + RUNS[task])


def simulate(tool, folder, task, methods, sessions):
    file = folder / f"{task}-{len(methods)}.toml"
    file.write_text(define(task, methods, sessions), encoding="utf-8")
    done = subprocess.run([tool, "experiment", file, "--power", str(PEOPLE), "--studies", str(STUDIES), "--simulate",
                           OTHERS.get(task, USUAL), "--format", "json"],
                          capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(done.stderr[-2000:])
    run = json.loads(done.stdout)["runs"][0]
    tests = [(f"{c['figure']} by {c['factor']}", c["power"]) for c in run["comparisons"]]
    # A simulated drawing is moved as a whole, so its length and direction do not vary.
    tests = [t for t in tests if t[0].partition(" ")[0] not in ("length", "direction")]
    # Leaves out tests against chance and against 0: these people are above both.
    if task not in ("identify", "detect"):
        tests = [("main: " + run["comparison"], p) for p in [run["power"]] if p] + tests
    return [(task, len(methods), name, p[0]) for name, p in tests]


def main():
    passed = failed = 0
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(2) as pool:
        designs = [(task, methods, sessions) for task in RUNS for methods, sessions in (("ab", 2), ("abc", 1))
                   if task not in ("same-different", "oddity") or methods == "ab"]
        for rows in pool.map(lambda d: simulate(sys.argv[1], pathlib.Path(folder), *d), designs):
            for task, methods, name, at in rows:
                share = at["significant"] / STUDIES
                right = (LOW if methods == 2 else GG_LOW) <= share <= HIGH and at["untested"] < STUDIES / 100
                passed, failed = passed + right, failed + (not right)
                print(f"{'' if right else 'FAILED: '}{task}, {methods} methods, {name}: {100 * share:.1f} % of {STUDIES} studies of {PEOPLE} people")
    print(f"{passed} passed, {failed} failed, 0 skipped")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
