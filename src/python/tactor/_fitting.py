# SPDX-License-Identifier: MIT
"""Strokes that are made as large as an array."""
from __future__ import annotations

import typing as _t

from tactor import _tactor
from tactor._array import Array, Point
from tactor._checks import _need, _number
from tactor._stroke import Stroke


class Fitting(_t.NamedTuple):
    """Where a picture was put: `origin` became `to`, and all distances are `scale` times what they were."""

    origin: Point
    to: Point
    scale: float


def fit_strokes(strokes: _t.Sequence[Stroke], array: Array, margin_mm: float = 0.0) -> tuple[list[Stroke], Fitting]:
    """Moves and scales strokes, all alike as one picture, so that it is as large as the array has space for.

    Parameters
    ----------
    strokes : sequence of Stroke
    array : Array
    margin_mm : float
        Distance kept from the array's edge.

    Returns
    -------
    tuple
        The strokes, and where the picture was put.

    Raises
    ------
    InputError
        For a margin that leaves no space.
    """
    _need(array, Array, "array")
    fitted, origin, to, scale = _tactor.fit_strokes(_cores(strokes), array._core, _number("margin_mm", margin_mm))
    return [Stroke._of(s) for s in fitted], Fitting(Point(*origin), Point(*to), scale)


def apply_fits(strokes: _t.Sequence[Stroke], array: Array) -> list[Stroke]:
    """Strokes as their file asks for them to be fitted (`fit`), those of a group as one picture. `plan` does it for a stroke alone.

    Parameters
    ----------
    strokes : sequence of Stroke
        As `load` gives them; what asks for nothing stays.
    array : Array

    Returns
    -------
    list of Stroke
        In the same order; they ask for nothing more.

    Raises
    ------
    InputError
        For a margin that leaves no space.
    """
    _need(array, Array, "array")
    return [Stroke._of(s) for s in _tactor.apply_fits(_cores(strokes), array._core)]


def _cores(strokes: _t.Any) -> list[_t.Any]:
    for s in strokes:
        _need(s, Stroke, "strokes")
    return [s._core for s in strokes]
