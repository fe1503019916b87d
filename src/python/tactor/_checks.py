# SPDX-License-Identifier: MIT
"""What is wrong with an argument."""
from __future__ import annotations

import typing as _t

from tactor._errors import InputError


def _floats(what: str, values: _t.Any) -> _t.Any:
    import numpy as np
    try:
        return np.ascontiguousarray(values, dtype=np.float64) if np.ndim(values) else np.float64(values)
    except (TypeError, ValueError) as e:
        raise InputError(what, f"it is no array of numbers: {e}") from None


def _need(value: object, kind: type, what: str) -> None:
    """Says which argument is of another type; where it were passed on, nobody would know its name."""
    if not isinstance(value, kind):
        raise TypeError(f"{what}: a {kind.__name__} is wanted, not {type(value).__name__}")


def _counted(n: int, noun: str) -> str:
    return f"{n} {noun}" if n == 1 else f"{n} {noun}s"
