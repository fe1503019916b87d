# SPDX-License-Identifier: MIT
"""What a phantom model of the user's answers, held against what it may."""
from __future__ import annotations

import math
import operator
import typing as _t

from tactor._checks import _shown
from tactor._errors import InputError


def answer(model: _t.Any, name: str, x_mm: float, y_mm: float, intensity: float, tactors: int) -> list[tuple[int, float]]:
    """Tactors and amplitudes above 0 that a model gives, in order of tactor; called by the extension."""
    said = model.weights(x_mm, y_mm, intensity)
    if not hasattr(said, "items"):
        raise _refused(name, f"it returned {_shown(said)}")
    drives = []
    for one in said.items():
        if not isinstance(one, tuple) or len(one) != 2:
            raise _refused(name, f"its items() have {_shown(one)}")
        drives.append((_tactor(name, one[0], tactors), _amplitude(name, *one)))
    drives.sort()
    for (tactor, _), (following, _) in zip(drives, drives[1:]):
        if tactor == following:
            raise _refused(name, f"it drives tactor {tactor} twice")
    return [drive for drive in drives if drive[1] > 0.0]


def _tactor(name: str, key: _t.Any, tactors: int) -> int:
    try:
        tactor = operator.index(key)
    except TypeError:
        raise _refused(name, f"it drives tactor {_shown(key)}, which is no whole number") from None
    if not 0 <= tactor < tactors:
        raise _refused(name, f"it drives tactor {_shown(tactor)} of {tactors}")
    return tactor


def _amplitude(name: str, key: _t.Any, value: _t.Any) -> float:
    amplitude = -1.0
    if not isinstance(value, (str, bytes, bytearray)):
        try:
            amplitude = float(value)
        except (TypeError, ValueError, OverflowError):
            pass
    if not 0.0 <= amplitude < math.inf:
        raise _refused(name, f"tactor {_shown(key)} has the amplitude {_shown(value)}")
    return amplitude


def _refused(name: str, why: str) -> InputError:
    return InputError(f"phantom {name}", why, "weights() returns a dict of tactor and amplitude, which is finite and not below 0")
