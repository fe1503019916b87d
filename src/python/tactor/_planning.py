# SPDX-License-Identifier: MIT
"""From a stroke to a plan."""
from __future__ import annotations

import typing as _t

from tactor import _tactor
from tactor._array import Array
from tactor._checks import _need
from tactor._options import _PLANNING_AND_SOUNDING, _SOUNDING, settled
from tactor._plan import Plan
from tactor._stroke import Stroke


def make_plan(given: dict[str, _t.Any]) -> Plan:
    """The plan of plan()'s arguments."""
    options = dict(given)
    array, stroke = options.pop("array"), options.pop("stroke")
    _need(array, Array, "array")
    _need(stroke, Stroke, "stroke")
    options = settled(array, options, _PLANNING_AND_SOUNDING)
    asked = {name: options[name] for name in _SOUNDING if options.get(name) is not None}
    return Plan._of(_tactor.Plan(array._core, stroke._core, options), array, asked=asked)


def burst_duration(*, soa: float | None = None, burst: float | None = None, slope: float | None = None,
                   intercept: float | None = None) -> float:
    """Duration of park2016's bursts in seconds: `burst`, or what the timing law gives for the SOA.

    Raises
    ------
    InputError
        For an SOA out of bounds.
    """
    return _tactor.burst_duration(dict(soa=soa, burst=burst, slope=slope, intercept=intercept))  # type: ignore[no-any-return]
