# SPDX-License-Identifier: MIT
"""Makes the folders of small studies, the same on every machine: R analyses them too.

Usage: studies.py FOLDER [--R]   writes FOLDER/NAME for each; with --R also FOLDER/NAME.runs, what analyze.R reads of
the definition: a line for each run, its name, task, motions, methods, with tabs between and "," in lists.
"""
import itertools
import json
import math
import pathlib
import re
import sys

COLUMNS = ("onset duration trial attempt motion method_1 method_2 response response_time rating void xruns stream "
           "frame_1 frame_2 plan_1 plan_2").split()
ROOT = pathlib.Path(__file__).resolve().parents[2]


class Numbers:
    """A small generator of numbers (Lehmer's), so that no library's version changes a study."""

    def __init__(self, seed):
        self.state = seed

    def unit(self):
        self.state = self.state * 48271 % 2147483647
        return self.state / 2147483647

    def below(self, n):
        return min(n - 1, int(self.unit() * n))

    def shuffled(self, items):
        items = list(items)
        for i in range(len(items) - 1, 0, -1):
            k = self.below(i + 1)
            items[i], items[k] = items[k], items[i]
        return items

    def normal(self):
        return sum(self.unit() for _ in range(12)) - 6


def toml(kind, name, /, **keys):
    """Returns a motion, method, group or run of a definition."""
    return f"[[{kind}]]\n" + "".join(f"{k} = {json.dumps(v)}\n" for k, v in ({"name": name} | keys).items())


def run(name, task, trials, **keys):
    return toml("run", name, task=task, trials=trials, **keys)


def definition(name, motions, methods, runs, groups=()):
    return f'[experiment]\nname = "{name}"\n' + "".join(
        toml(kind, n) for kind, names in (("motion", motions), ("method", methods), ("group", groups)) for n in names) + "".join(runs)


def measures(array, *runs, keys=""):
    """Returns a definition of tasks that measure: one motion by two methods, at levels in dBFS."""
    return (f'[experiment]\nname = "measures"\narray = "{array}"\nlevel = {{ dbfs = -20 }}\n{keys}' + toml("motion", "east", path="M0 0H20", duration=0.2)
            + toml("method", "park") + toml("method", "soft", burst=0.05) + "".join(runs))


def names_in(text):
    """Returns the motions and the methods of a definition."""
    return ([json.loads(n) for k, n in re.findall(r'\[\[(\w+)\]\]\nname = (".*")', text) if k == kind]
            for kind in ("motion", "method"))


def cells(r, motions, methods):
    """Returns the cells of a run, each equally often."""
    ms, ns = r.get("motions", motions), [m for m in methods if m in r.get("methods", methods)]
    pairs = list(itertools.permutations(ns, 2)) if r["task"] == "choose" else [(n, "n/a") for n in ns]
    return [(m, *p) for m in ms for p in pairs]


def table(rows):
    return "\t".join(COLUMNS) + "\n" + "".join(
        "\t".join(str(row.get(c, "n/a")) for c in COLUMNS) + "\n" for row in rows)


def write_study(folder, text, people, answers, simulated=False, void=None, groups=None):
    """Writes a study; answers(code, run, cell, n) is the answer of the n-th trial of a cell, or None without one.
    groups: the group of each code, if the study has groups."""
    motions, methods = names_in(text)
    (folder / "sourcedata").mkdir(parents=True)
    (folder / "participants.tsv").write_text("participant_id\tage\tsex\thandedness" + "\tgroup" * bool(groups) + "\n" + "".join(
        f"sub-{c}\tn/a\tn/a\tn/a" + (f"\t{groups[c]}" if groups else "") + "\n" for c in people))
    shuffle = Numbers(4711)
    for code in people:
        beh, source = folder / f"sub-{code}/beh", folder / f"sourcedata/sub-{code}"
        beh.mkdir(parents=True)
        source.mkdir()
        (source / "session.json").write_text(json.dumps({"simulated": simulated, "experiment": {"text": text}} | (
            {"group": groups[code]} if groups else {})))
        for r in split_runs(text):
            rows, seen = [], {}
            every = cells(r, motions, methods)
            for cell in shuffle.shuffled(every * (r["trials"] // len(every))):
                n = seen[cell] = seen.get(cell, -1) + 1
                answer = answers(code, r, cell, n)
                if answer is None:
                    continue
                row = {"trial": len(rows) + 1, "attempt": 1, "motion": cell[0], "method_1": cell[1],
                       "method_2": cell[2], "response": answer, "response_time": 0.5 + n / 8, "void": "false"}
                row |= {"rating": answer} if r["task"] == "rate" else {}
                rows.append(row)
            # Bad trials come again at the end.
            for row in [r for r in rows if void and r["trial"] % void == 0]:
                rows.append(row | {"attempt": 2})
                row |= {"void": "true", "response": "n/a", "rating": "n/a", "response_time": "n/a"}
            if rows:
                name = re.sub(r"[^0-9A-Za-z]", "", r["name"])
                (beh / f"sub-{code}_task-{name}_beh.tsv").write_text(table(rows))
                (folder / f"task-{name}_beh.json").write_text(json.dumps({"TaskName": r["name"]}))


def split_runs(text):
    """Returns the runs of a definition, without a reader of TOML (Python 3.11 has one, 3.10 not)."""
    runs = []
    for part in text.split("[[run]]\n")[1:]:
        runs.append({k: json.loads(v) for k, v in re.findall(
            r"^(name|task|trials|motions|methods|scale) = (.*)$", part, re.M)})
    return runs


def likes(numbers, strength):
    """Returns answers of a person who prefers the last method by `strength` (choose), and rates so."""
    def answer(_, r, cell, __):
        effect = strength(cell[0])
        if r["task"] == "choose":
            last = numbers.unit() < 0.5 + effect / 4
            return (1 if cell[1] == r["last"] else 2) if last else (2 if cell[1] == r["last"] else 1)
        lift = effect if cell[1] == r["last"] else 0
        return max(1, min(r.get("scale", 5), round(2.6 + lift + 0.9 * numbers.normal())))
    return answer


def with_last(answers, last):
    return lambda code, r, cell, n: answers(code, r | {"last": last}, cell, n)


FOUR = [f"motion-{i}" for i in range(1, 5)]
TWO = ["tactile-brush", "park2016"]


def simulated(folder):
    """Makes the shipped experiment, twelve people, some trials void."""
    text = (ROOT / "examples/experiments/park2016.toml").read_text(encoding="utf-8")
    numbers = Numbers(2016)
    own = {f"{i:02}": 0.4 * numbers.normal() for i in range(1, 13)}
    push = {m: 0.9 + 0.25 * i for i, m in enumerate(FOUR)}

    def answers(code, r, cell, n):
        return likes(numbers, lambda m: max(-1.5, min(1.8, push[m] + own[code])))(code, r | {"last": "park2016"}, cell, n)
    write_study(folder, text, list(own), answers, simulated=True, void=13)


def ties(folder):
    """Makes few trials: many participants have the same figures, and some differences are 0."""
    text = definition("ties", FOUR, TWO, [run("taste", "choose", 16), run("marks", "rate", 16, scale=3)])
    numbers = Numbers(77)
    answers = likes(numbers, lambda m: 0.5 if m != "motion-2" else -0.2)
    write_study(folder, text, [f"{i}" for i in range(1, 9)], with_last(answers, "park2016"))


def missing(folder):
    """Leaves out a participant's first run, another's cell of the second, and a third participant."""
    text = definition("missing", FOUR, TWO, [run("taste", "choose", 40), run("marks", "rate", 40)])
    numbers = Numbers(5)
    base = with_last(likes(numbers, lambda m: 0.8 + 0.2 * FOUR.index(m)), "park2016")

    def answers(code, r, cell, n):
        answer = base(code, r, cell, n)
        absent = (code, r["name"]) == ("C3", "taste") or \
            (code, r["name"], *cell[:2]) == ("E5", "marks", "motion-4", "tactile-brush")
        return None if absent else answer
    write_study(folder, text, ["A1", "B2", "C3", "D4", "E5", "F6", "G7"], answers)
    with (folder / "participants.tsv").open("a") as f:
        f.write("sub-Late\t24\tn/a\tn/a\n")


def constant(folder):
    """Makes everybody always choose the last method for one motion, and rate one cell the same."""
    text = definition("constant", FOUR, TWO, [run("taste", "choose", 40), run("marks", "rate", 40)])
    numbers = Numbers(31)
    base = with_last(likes(numbers, lambda m: 0.7), "park2016")

    def answers(code, r, cell, n):
        answer = base(code, r, cell, n)
        if cell[0] == "motion-3" and r["task"] == "choose":
            return 1 if cell[1] == "park2016" else 2
        if cell[:2] == ("motion-1", "park2016") and r["task"] == "rate":
            return 4
        return answer
    write_study(folder, text, [f"0{i}" for i in range(1, 7)], answers)


def two_levels(folder):
    """Makes two motions only, where sphericity always holds."""
    text = definition("two-levels", FOUR[:2], TWO, [run("taste", "choose", 20), run("marks", "rate", 20, scale=7)])
    numbers = Numbers(12345)
    write_study(folder, text, [f"p{i}" for i in range(5)], with_last(likes(numbers, lambda m: 0.9), "park2016"))


def few(folder):
    """Makes three people and four motions: no Mauchly."""
    text = definition("few", FOUR, TWO, [run("taste", "choose", 40), run("marks", "rate", 40)])
    numbers = Numbers(999)
    write_study(folder, text, ["x1", "x2", "x3"], with_last(likes(numbers, lambda m: 0.6), "park2016"))


def three_by_three(folder):
    """Makes three methods, three motions, and a run that identifies motions."""
    methods = [*TWO, "continuous"]
    text = definition("three", FOUR[:3], methods, [run("marks", "rate", 27, scale=9), run("which", "identify", 36),
                                                   run("pair", "choose", 12, methods=["continuous", "tactile-brush"])])
    numbers = Numbers(271828)
    base = with_last(likes(numbers, lambda m: 0.9), "continuous")

    def answers(code, r, cell, n):
        if r["task"] != "identify":
            return base(code, r, cell, n)
        right = numbers.unit() < (0.45 if cell[1] == "tactile-brush" else 0.7)
        return cell[0] if right else FOUR[numbers.below(3)]
    write_study(folder, text, [f"s{i}" for i in range(1, 11)], answers)


def among(folder):
    """Makes choices among three methods, whose worths differ between people and between motions, and between two."""
    methods = [*TWO, "continuous"]
    text = definition("among", FOUR[:3], methods, [run("all three", "choose", 36),
                                                   run("last two", "choose", 12, methods=methods[1:])])
    numbers = Numbers(1952)
    own = {f"q{i}": {m: worth + 0.5 * numbers.normal() for m, worth in zip(methods, (0, 1.1, 0.4))} for i in range(1, 8)}

    def answers(code, r, cell, n):
        first, second = (own[code][m] for m in cell[1:])
        lift = 0.3 * FOUR.index(cell[0]) * (cell[1] == "continuous")
        return 1 if numbers.unit() < 1 / (1 + math.exp(second - first - lift)) else 2
    write_study(folder, text, list(own), answers, void=17)


def grouped(folder):
    """Makes two groups of unequal sizes, which differ in what the last method does for them, and in which motions."""
    text = definition("grouped", FOUR[:3], TWO, [run("taste", "choose", 24), run("marks", "rate", 24), run("which", "identify", 18)],
                      ["palm", "arm"])
    numbers = Numbers(1953)
    groups = {f"{i:02}": "palm" if i % 5 < 3 else "arm" for i in range(1, 13)}
    own = {code: 0.4 * numbers.normal() + 0.5 * (group == "palm") for code, group in groups.items()}

    def answers(code, r, cell, n):
        if r["task"] != "identify":
            lift = 0.3 * FOUR.index(cell[0]) * (groups[code] == "arm")
            return likes(numbers, lambda m: max(-1.5, min(1.8, own[code] + lift)))(code, r | {"last": "park2016"}, cell, n)
        return cell[0] if numbers.unit() < 0.5 + own[code] / 4 else FOUR[numbers.below(3)]
    write_study(folder, text, list(groups), answers, groups=groups)


STUDIES = {"simulated": simulated, "ties": ties, "missing": missing, "constant": constant, "two-levels": two_levels,
           "few": few, "three-by-three": three_by_three, "among": among, "grouped": grouped}


def for_r(folder, file):
    """Returns the part of the definition that analyze.R reads."""
    text = json.loads(next(folder.glob("sourcedata/sub-*/session.json")).read_text())["experiment"]["text"]
    motions, methods = names_in(text)
    file.write_text("".join("\t".join((
        r["name"], r["task"], ",".join(m for m in motions if m in r.get("motions", motions)),
        ",".join(m for m in methods if m in r.get("methods", methods)))) + "\n" for r in split_runs(text)))


def main():
    target = pathlib.Path(sys.argv[1])
    for name, make in STUDIES.items():
        make(target / name)
        if "--R" in sys.argv:
            for_r(target / name, target / f"{name}.runs")


if __name__ == "__main__":
    main()
