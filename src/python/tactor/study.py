# SPDX-License-Identifier: MIT
"""Studies that `tactor experiment` has written: their trials and their statistics, from the folder::

    trials = pandas.DataFrame(tactor.study.read("strokes"))
    statistics = tactor.study.analyze("strokes")

Both functions check the whole folder as `tactor analyze` does, and change nothing in it.
"""
from __future__ import annotations

import os
import typing as _t

from tactor import _tactor
from tactor._checks import _need, encoded
from tactor._errors import InputError

__all__ = ["analyze", "read"]


def read(folder: str | os.PathLike[str], *, participants: _t.Iterable[str] | None = None,
         exclude: _t.Iterable[str] | None = None) -> list[dict[str, _t.Any]]:
    """Reads each trial of a study, void ones included: only those whose `void` is False count.

    Parameters
    ----------
    folder : path-like
        Folder of the study.
    participants : str or iterable of str, optional
        Codes of the participants to read, with or without "sub-"; a str has commas between them. Default: all.
    exclude : str or iterable of str, optional
        Codes of the participants to leave out. Their files are not opened.

    Returns
    -------
    list of dict
        In the order of participants, runs and lines. Each dict has "participant" (the code without "sub-"), "run", "task",
        "simulated" (True for the answers of a simulated observer), and the columns of the tables, which tactor-experiment(1)
        describes. Times are float, in seconds; counts, frames and ratings are int; "void" and "early" are bool; all others are
        str, and so is "response" in each task. n/a is None, and so is a column that the table does not have. Columns that you
        have added to a table are str.

    Raises
    ------
    InputError
        For what `tactor analyze` refuses in a folder, and for a cell that is not of its type, with file and line; for codes that
        are not in the study. A missing folder is also a FileNotFoundError.
    """
    return _tactor.read_study(encoded(folder, "folder"), *_selection(participants, exclude))  # type: ignore[no-any-return]


def analyze(folder: str | os.PathLike[str], *, participants: _t.Iterable[str] | None = None,
            exclude: _t.Iterable[str] | None = None, drop_early: bool = False,
            response_time: tuple[float, float] | None = None) -> dict[str, _t.Any]:
    """Returns the statistics of a study as `tactor analyze --format json` prints them: a tactor-analysis/1 object.

    tactor-json(5) describes it. Void trials do not count. None stands for a figure that cannot be computed; "warnings" has the
    reasons.

    Parameters
    ----------
    folder : path-like
        Folder of the study.
    participants, exclude : str or iterable of str, optional
        As in `read`.
    drop_early : bool, optional
        True: trials whose answers are marked early do not count.
    response_time : tuple of two floats, optional
        Shortest and longest response time of trials that count, in seconds, from 0 to 1e6. A trial without one does not count.

    Raises
    ------
    InputError
        As in `read`; for two times that are not a range.
    """
    import json
    if response_time is not None:
        _need(response_time, tuple, "response_time")
        if len(response_time) != 2 or not 0 <= response_time[0] < response_time[1] <= 1e6:
            raise InputError("response_time", f"{response_time} is not a range of times", "give the shortest and the longest, such as (0.2, 5)",
                             field="response_time")
    text = _tactor.analyze_study(encoded(folder, "folder"), *_selection(participants, exclude), bool(drop_early), response_time)
    return json.loads(text)  # type: ignore[no-any-return]


def _selection(participants: _t.Iterable[str] | None, exclude: _t.Iterable[str] | None) -> tuple[list[str], list[str]]:
    """Returns the codes of both options; refuses an empty list of participants, which would mean all."""
    only = _codes("participants", participants)
    if participants is not None and not only:
        raise InputError("participants", "no participant remains", "name at least one, or leave out participants", field="participants")
    return only, _codes("exclude", exclude)


def _codes(what: str, given: _t.Iterable[str] | None) -> list[str]:
    codes = [] if given is None else given.split(",") if isinstance(given, str) else list(given)
    for code in codes:
        _need(code, str, what)
    return codes
