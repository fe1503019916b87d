# SPDX-License-Identifier: MIT
"""Writes from the tables of options and of stroke formats: python3 src/options/write.py, where tactor can be imported.

* In src/python/tactor: options in the signatures and docstrings of functions that take them, and the types of options.
* In man: heads and ranges of options, and the options that commands share (write_manual.py); the formats in tactor.toml(5).

tests/python/test_package.py holds all of them current.
"""
import functools
import pathlib
import re
import textwrap

import write_manual

from tactor import _tactor

WIDTH = 160
ROWS = _tactor.option_rows()
FORMATS = _tactor.stroke_formats()


def literal(row):
    return "_" + "".join(word.capitalize() for word in row["name"].split("_"))


def in_seconds(row):
    """The row as Python has it: times in seconds."""
    if row["unit"] != "ms":
        return row
    low, _, high = row["range"].removesuffix(" ms").partition(" to ")
    return {**row, "name": row["name"].removesuffix("_ms"), "help": row["help"].replace("(default 50)", "(default 0.05)"),
            "range": f"{float(low) / 1e3:g} to {float(high) / 1e3:g} s"}


def name_type(row, own_phantom):
    if row["name"] == "phantom" and own_phantom:
        return f"_t.Union[{literal(row)}, PhantomModel, None]"
    if row["kind"] == "choice":
        return f"{literal(row)} | None"
    if row["kind"] == "str" and row["may_be_number"]:
        return "_t.Union[float, str, None]"
    return f"{row['kind']} | None"


def first_up(text):
    return text[0].upper() + text[1:]


def entry(row, indent):
    kind = {"choice": "str"}.get(row["kind"], row["kind"])
    kind = "float or str" if kind == "str" and row["may_be_number"] else kind
    said = [(row["help"] if re.match(r'[^ ]+( [^ ]+)?: ', row["help"]) else first_up(row["help"])) + "."]
    if row["form"]:
        said.append(f'As "{row["form"]}".')
    if row["choices"]:
        said.append("One of " + ", ".join(f'"{c}"' for c in row["choices"]) + ".")
    if row["range"]:
        said.append(first_up(row["range"]) + ".")
    text = textwrap.fill(" ".join(said), WIDTH - 20, break_on_hyphens=False)
    return textwrap.indent(f"{row['name']} : {kind}\n{textwrap.indent(text, '    ')}", " " * indent)


def entries(rows, indent):
    """Parameters of these rows; plan() describes its own."""
    told = [r["name"] for r in rows if "plan" in r["places"]]
    lines = textwrap.wrap(", ".join(told), WIDTH - 20)
    as_in_plan = [textwrap.indent(f"{line.removesuffix(',')}\n    As in `plan`.", " " * indent) for line in lines]
    return "\n".join(as_in_plan + [entry(r, indent) for r in rows if r["name"] not in told])


def call(text, function, rows, before=(), after=(), own_phantom=False, told=entries):
    """The text of a module with these rows in the signature and the docstring of a function, and the entries there of the parameters around."""
    owner, _, name = function.rpartition(".")
    found = re.compile(rf'^(?P<start>(?P<indent> *)def {name}\().*?(?P<end>\) -> \w+:)\n(?P<doc>.*?-{{10}}\n)(?P<entries>.*?)(?=\n\n|\n *""")', re.M | re.S)
    m = found.search(text, text.index(f"class {owner}(") if owner else 0)
    parts = [*before, *(f"{r['name']}: {name_type(r, own_phantom)} = None" for r in rows), *after]
    lines = [m["start"]]
    for part in [f"{p}, " for p in parts[:-1]] + [parts[-1]]:
        if len(lines[-1] + part + m["end"]) > WIDTH:
            lines.append(" " * len(m["start"]))
        lines[-1] += part
    signature = "\n".join(line.rstrip() for line in lines) + m["end"]
    indent = len(m["indent"]) + 4
    by_hand = {part.partition(":")[0] for part in (*before, *after)}
    around = [e for e in re.split(rf"\n(?= {{{indent}}}\w)", m["entries"]) if re.match(r" *(\w+)", e)[1] in by_hand]
    return text[:m.start()] + f"{signature}\n{m['doc']}" + "\n".join((*around, told(rows, indent))) + text[m.end():]


def rows(place):
    return [in_seconds(r) for r in ROWS if place in r["places"]]


def plan(text):
    types = "".join(f"    {literal(r)} = _t.Literal[{', '.join(repr(c).replace(chr(39), chr(34)) for c in r['choices'])}]\n" for r in ROWS
                    if r["kind"] == "choice" and {"plan", "score", "compare", "player"} & set(r["places"]))
    text = re.sub(r"(    _\w+ = _t\.Literal\[.*\]\n)+", types, text, count=1)
    return call(text, "plan", rows("plan"), ["array: Array", "stroke: Stroke", "*"], own_phantom=True,
                told=lambda rows, indent: "\n".join(entry(r, indent) for r in rows))


def compare(text):
    return call(text, "compare", rows("compare"), ["array: Array", "stroke: Stroke", "*", "algorithms: _t.Union[str, _t.Iterable[_Algorithm], None] = None",
                                                   "phantoms: _t.Union[str, _t.Iterable[_Phantom], None] = None"])


def score(text):
    return call(text, "Score.__init__", rows("score"), ["self", "array: Array", "plans: _Plans", "*"])


def player(text):
    text = call(text, "Player.__init__", rows("player"), ["self", "device: str", "array: Array", "*"],
                ["config: _t.Union[str, os.PathLike[str], None] = None",
                 "log: _t.Callable[[_LogKind, str], object] | None = None", "keep_drive_time: bool = True"])
    return call(text, "Player.live", [r for r in rows("live") if "plan" in r["places"] and r["name"] != "texture_mm"], ["self", "*"],
                ["timeout: float = 0.5", "longest: float | None = None", "smooth: float = 0.0", "intensity_max: float | None = None"], own_phantom=True)


def formats(text):
    """The text of tactor.toml(5) with its table of formats."""
    rows = "".join(f"{f['title']}\t{', '.join(f['extensions'])}\t{f['name']}\t{f['media_type']}\t{'yes' if f['written'] else 'no'}\n" for f in FORMATS)
    return re.sub(r"(format\textension\tparameter.*\n)(?:.*\t.*\n)*", lambda m: m[1] + rows, text)


SRC = pathlib.Path(__file__).parents[1]
WRITTEN = {SRC / "python/tactor/_plan.py": plan, SRC / "python/tactor/_tool.py": compare, SRC / "python/tactor/_score.py": score,
           SRC / "python/tactor/_player.py": player}
WRITTEN |= {page: functools.partial(write_manual.written, page.name, rows=ROWS) for page in (SRC.parent / "man").glob("*.[1-8]")}
PAGE = SRC.parent / "man/tactor.toml.5"
WRITTEN[PAGE] = lambda text: formats(write_manual.written(PAGE.name, text, rows=ROWS))

if __name__ == "__main__":
    for file, write in WRITTEN.items():
        file.write_text(write(file.read_text(encoding="utf-8")), encoding="utf-8")
