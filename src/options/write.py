# SPDX-License-Identifier: MIT
"""Writes from the table of options: python3 src/options/write.py, where tactor can be imported.

* src/python/tactor/_calls.py: signatures and docstrings of the calls that take options; the modules around do the work.
* $defs/options of the protocol's schema.
* In man: heads and ranges of options, and the options that commands share (write_manual.py).

tests/python/test_written.py holds all of them current.
"""
import functools
import json
import pathlib
import re
import textwrap

import write_manual

from tactor import _tactor

WIDTH = 160
ROWS = _tactor.option_rows()

HEAD = '''# SPDX-License-Identifier: MIT
"""Calls that take options. Written from the table of options by src/options/write.py: change it there."""
from __future__ import annotations

import typing as _t

if _t.TYPE_CHECKING:
    import os
    from tactor._array import Array
    from tactor._parts import PhantomModel
    from tactor._plan import Plan
    from tactor._score import _Plans
    from tactor._stroke import Stroke
    from tactor._ticket import LiveStroke, _LogKind
    from tactor._tool import Comparison
{types}
'''

PLAN = '''

def plan({signature}) -> Plan:
    """Plans a stroke on an array. Options are the tool's, see tactor-options(7); None is its default.

    Parameters
    ----------
    array : Array
    stroke : Stroke
{parameters}

    Returns
    -------
    Plan

    Raises
    ------
    InputError
        SOA out of bounds, a path outside the array, timing that cannot be done, no grid for the Tactile Brush.

    Notes
    -----
    `phantom` may be a model of your own. "inverse-distance" is that of Park et al. 2016, Eq. 10. "nearest" takes the closest three tactors of all, as
    their paper says it to the letter; a warning counts the bursts that their triangle misses. The timing law is of Israr and Poupyrev 2011, "low-speed"
    of Goldreich 2007. What says how the plan sounds counts for a `Score` that says nothing else.
    """
    given = dict(locals())
    from tactor._plan import make_plan
    return make_plan(given)
'''

COMPARE = '''

def compare({signature}) -> Comparison:
    """What algorithms are predicted to feel like on the same stroke: a model, never a measurement.

    Parameters
    ----------
    array : Array
    stroke : Stroke
    algorithms : iterable of str
        What to compare; default: all three, or `algorithm` alone.
    phantoms : iterable of str
        With which phantom models; default: that of `phantom`.
{parameters}

    Returns
    -------
    Comparison
        A list of dicts. An algorithm that cannot play the stroke says why under "refused".

    Raises
    ------
    InputError
        Where none can play it.
    """
    given = dict(locals())
    from tactor._tool import make_comparison
    return make_comparison(given)
'''

SCORE = '''

class ScoreCall:
    """The call that makes a score."""

    __slots__ = ()

    def __init__({signature}) -> None:
        """Makes a score.

        Parameters
        ----------
        array : Array
        plans : Plan, or iterable of Plan or of (float, Plan)
            A number is the start in seconds; a plan without one starts at its stroke's, or when the plan before it has ended.
{parameters}

        Without any limit on power and drive time the piece is as it was designed: a player has its own.
        """
        given = dict(locals())
        del given["self"]
        self._make(given)

    def _make(self, given: dict[str, _t.Any]) -> None:
        raise NotImplementedError
'''

PLAYER = '''

class PlayerCalls:
    """The calls that open a player and begin a live stroke."""

    __slots__ = ()

    def __init__({signature}) -> None:
        """Opens a device.

        Parameters
        ----------
        device : str
            An ALSA name as `tactor play -D` takes it: "hw:CARD=Tactor", "null", "file:...".
        array : Array
            Gives each channel's limit; one from a file brings what that says of amplifier, lines and limits.
        config : path-like, optional
            Configuration; default: the tool's ($TACTOR_CONFIG, the user's, the system's), amplifier and limits included. os.devnull: none.
        log : callable, optional
            `log(kind, text)` is told of xruns, recovery, mutes and limits that act, in the player's thread of Python.
        keep_drive_time : bool
            What earlier players and runs of this user drove on this device counts, and what this one drives counts for later ones. False: it
            begins with 0, and is not kept.
{parameters}
        """
        given = dict(locals())
        del given["self"]
        self._open(given)

    def _open(self, given: dict[str, _t.Any]) -> None:
        raise NotImplementedError
'''

LIVE = '''
    def live({signature}) -> LiveStroke:
        """Begins a stroke that is fed point by point; silent until the first.

        Parameters
        ----------
        timeout : float
            A producer that gives no point for so long, s, has failed: it fades out, interrupted.
        longest : float
            A stroke that has sounded for so long, s, fades out, interrupted; None: it may go on for ever.
        smooth : float
            For points that come in bursts, s, 0 (off) to 1: it moves evenly, and is at each point so long after that came.
        intensity_max : float
            The intensity of a point that means 1, 0.001 to 1e6; 255 for a sensor of 8 bits. None: as the file says, else 1.
{parameters}

        What nobody says is as the array's file says; but `algorithm` is "continuous", and `outside` "clamp".

        Returns
        -------
        LiveStroke

        Raises
        ------
        InputError
            For options that cannot be.
        StreamError
            When the stream has ended.
        """
        given = dict(locals())
        del given["self"]
        return self._begin(given)

    def _begin(self, given: dict[str, _t.Any]) -> LiveStroke:
        raise NotImplementedError
'''


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


def call(template, rows, before=(), after=(), own_phantom=False, told=entries):
    """A template with the signature and the parameters of these rows."""
    parts = [*before, *(f"{r['name']}: {name_type(r, own_phantom)} = None" for r in rows), *after]
    start, end = next(line for line in template.splitlines() if "{signature}" in line).split("{signature}")
    lines = [start]
    for part in [f"{p}, " for p in parts[:-1]] + [parts[-1]]:
        if len(lines[-1] + part + end) > WIDTH:
            lines.append(" " * len(start))
        lines[-1] += part
    signature = "\n".join(line.rstrip() for line in lines)[len(start):]
    indent = len(re.search(r"^( *)-{10}$", template, re.M)[1])
    return template.replace("{signature}", signature).replace("{parameters}\n", f"{told(rows, indent)}\n".lstrip("\n"))


def calls():
    """The text of src/python/tactor/_calls.py."""
    def rows(place, but=()):
        return [in_seconds(r) for r in ROWS if place in r["places"] and r["name"] not in but]

    types = "".join(f"    {literal(r)} = _t.Literal[{', '.join(repr(c).replace(chr(39), chr(34)) for c in r['choices'])}]\n" for r in ROWS
                    if r["kind"] == "choice" and {"plan", "score", "compare", "player"} & set(r["places"]))
    of_live = [r for r in rows("live", {"texture_mm"}) if "plan" in r["places"]]
    return "".join((
        HEAD.replace("{types}\n", types),
        call(PLAN, rows("plan"), ["array: Array", "stroke: Stroke", "*"], own_phantom=True,
             told=lambda rows, indent: "\n".join(entry(r, indent) for r in rows)),
        call(COMPARE, rows("compare"), ["array: Array", "stroke: Stroke", "*", "algorithms: _t.Union[str, _t.Iterable[_Algorithm], None] = None",
                                        "phantoms: _t.Union[str, _t.Iterable[_Phantom], None] = None"]),
        call(SCORE, rows("score"), ["self", "array: Array", "plans: _Plans", "*"]),
        call(PLAYER, rows("player"), ["self", "device: str", "array: Array", "*"],
             ["config: _t.Union[str, os.PathLike[str], None] = None",
              "log: _t.Callable[[_LogKind, str], object] | None = None", "keep_drive_time: bool = True"]),
        call(LIVE, of_live, ["self", "*"], ["timeout: float = 0.5", "longest: float | None = None", "smooth: float = 0.0", "intensity_max: float | None = None"], own_phantom=True),
    ))


def make_schema(row):
    if row["kind"] == "choice":
        return {"enum": row["choices"]}
    if row["kind"] == "bool":
        return {"type": "boolean"}
    if row["kind"] == "str":
        return {"type": ["string", "number"] if row["may_be_number"] else "string"}
    kind = {"type": "integer" if row["kind"] == "int" else "number"}
    return {**kind, **{key: int(b) if b == int(b) else b for key, b in zip(("minimum", "maximum"), row["bounds"])}}


def schema(text):
    """The text of the protocol's schema with the options of this table."""
    options = ",\n".join(f'        "{r["name"]}": {json.dumps(make_schema(r))}' for r in ROWS if "client" in r["places"])
    return re.sub(r'("options": \{\n      "type": "object",.*?"properties": \{\n).*?(\n      \})', lambda m: m[1] + options + m[2], text, count=1, flags=re.S)


SRC = pathlib.Path(__file__).parents[1]
WRITTEN = {SRC / "python/tactor/_calls.py": lambda text: calls(), SRC / "cli/schemas/tactor-protocol-1.schema.json": schema}
WRITTEN |= {page: functools.partial(write_manual.written, page.name, rows=ROWS) for page in (SRC.parent / "man").glob("*.[1-8]")}

if __name__ == "__main__":
    for file, write in WRITTEN.items():
        file.write_text(write(file.read_text(encoding="utf-8")), encoding="utf-8")
