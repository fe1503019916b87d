# SPDX-License-Identifier: MIT
"""How often tests find a difference that is not there, in simulated studies of 12 people who differ.

Usage: error_rates.py TOOL. All methods of a study have the same options under other names, and people's mean values equal those compared
with. Of 1,000 studies 4 to 6 % should be significant: a share outside the 99.9 % interval about 5 % fails. Ends with a line that counts.
"""
import concurrent.futures
import json
import math
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


def define(task, methods, sessions, groups):
    return (START + f"sessions = {sessions}\n" + MOTIONS + "".join(f'[[method]]\nname = "{m}"\n' for m in methods)
            + f'[[run]]\nname = "{task}"\ntask = "{task}"\n' + RUNS[task] + "".join(f'[[group]]\nname = "{g}"\n' for g in groups))


def count(tool, folder, text, who, *more):
    """Returns what --power finds of the only run of a definition."""
    file = folder / f"{abs(hash(text))}.toml"
    file.write_text(text, encoding="utf-8")
    done = subprocess.run([tool, "experiment", file, "--power", str(PEOPLE), "--studies", str(STUDIES), "--simulate", who, "--format", "json", *more],
                          capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(done.stderr[-2000:])
    return json.loads(done.stdout)["runs"][0]


def simulate(tool, folder, task, methods, sessions, groups):
    run = count(tool, folder, define(task, methods, sessions, groups), OTHERS.get(task, USUAL), *(["--group", groups[0]] if groups else []))
    tests = [(f"{c['figure']} by {c['factor']}", c["power"]) for c in run["comparisons"]]
    # A simulated drawing is moved as a whole, so its length and direction do not vary.
    tests = [t for t in tests if t[0].partition(" ")[0] not in ("length", "direction")]
    # Leaves out tests against chance and against 0: these people are above both.
    if groups:
        tests = [t for t in tests if " by group" in t[0]]
    elif task not in ("identify", "detect"):
        tests = [("main: " + run["comparison"], p) for p in [run["power"]] if p] + tests
    return [(task, len(methods), name, p[0]) for name, p in tests]


def find_power(d, n):
    """Returns the power of the t test of two groups of n people whose means are d standard deviations apart."""
    df = 2 * n - 2
    spread = [(i + 0.5) / 2000 * 3 for i in range(2000)]  # of the estimated standard deviation, about the true one
    density = [math.exp((df - 1) * math.log(s) - df * s * s / 2) for s in spread]

    def beyond(t, off):
        return sum(p * (math.erfc((t * s - off) / math.sqrt(2)) + math.erfc((t * s + off) / math.sqrt(2))) / 2
                   for s, p in zip(spread, density)) / sum(density)
    low, high = 0, 100
    while high - low > 1e-9:
        low, high = ((low + high) / 2, high) if beyond((low + high) / 2, 0) > 0.05 else (low, (low + high) / 2)
    return beyond(low, d * math.sqrt(n / 2))


def check_groups(tool, folder):
    """Compares the power between groups with that of the noncentral t distribution. Of people without noise; values are 2 apart."""
    text = START + MOTIONS + '[[method]]\nname = "a"\n[[run]]\nname = "r"\ntask = "adjust"\n' + RUNS["adjust"] + "".join(
        f'[[group]]\nname = "{g}"\n' for g in "ab")
    power = count(tool, folder, text, "pse=60,jnd=0.001,pse_sd=5,group_d=1", "--group", "b")["comparisons"]
    at = next(c["power"][0] for c in power if (c["factor"], c["figure"]) == ("group", "constant_error"))
    expected = find_power(5 / math.hypot(5, 2 / math.sqrt(12)), PEOPLE)
    right = abs(at["power"] - expected) < 3.3 * math.sqrt(expected * (1 - expected) / STUDIES) and at["for_last"] == at["significant"]
    print(f"{'' if right else 'FAILED: '}power between groups {at['power']:.3f}, by the noncentral t distribution {expected:.3f}")
    return right


def main():
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(2) as pool:
        designs = [(task, methods, sessions, groups) for task in RUNS for methods, sessions, groups in (("ab", 2, ""), ("abc", 1, ""), ("ab", 1, "xy"))
                   if task not in ("same-different", "oddity") or methods == "ab"]
        passed, failed = (1, 0) if check_groups(sys.argv[1], pathlib.Path(folder)) else (0, 1)
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
