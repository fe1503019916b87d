# SPDX-License-Identifier: MIT
"""Paths: curves on the skin."""
from __future__ import annotations

import typing as _t

from tactor import _tactor
from tactor._array import Point
from tactor._checks import _floats, _Member, _need, _number, _place, _Stated

if _t.TYPE_CHECKING:
    import numpy as _np
    from numpy.typing import ArrayLike as _ArrayLike, NDArray as _NDArray


class Path(_Stated):
    """A curve on the skin, by arc length. Immutable.

    Made by `svg`, `polyline` or `arc`.

    Raises
    ------
    InputError
        For what is not path data (with its column), for numbers that are not finite or beyond 1e6 mm, and for no point.
    """

    __slots__ = ()

    def __init__(self) -> None:
        raise TypeError("use Path.svg(), Path.polyline() or Path.arc()")

    @classmethod
    def svg(cls, data: str) -> Path:
        """SVG path data in millimetres: "M 0 10 C 20 -5 20 45 40 30"."""
        _need(data, str, "data")
        return cls._wrap(_tactor.Path.svg(data))

    @classmethod
    def polyline(cls, points: _ArrayLike) -> Path:
        """Straight lines from point to point, shape (n, 2), mm."""
        return cls._wrap(_tactor.Path.polyline(_floats("points", points)))

    @classmethod
    def arc(cls, centre: _t.Sequence[float], radius_mm: float, from_deg: float, sweep_deg: float) -> Path:
        """A circular arc; angles from the x axis towards the y axis (clockwise on a screen), a sweep of at most 360 degrees."""
        angles = _number("from_deg", from_deg), _number("sweep_deg", sweep_deg)
        return cls._wrap(_tactor.Path.arc(*_place("centre", centre), _number("radius_mm", radius_mm), *angles))

    length_mm: _Member[float] = _Member("length_mm", "Length, to a micrometre.")
    data: _Member[str] = _Member("data", "SVG path data of the curve.")

    @_t.overload
    def at(self, s_mm: float) -> Point: ...
    @_t.overload
    def at(self, s_mm: _t.Sequence[float] | _NDArray[_np.float64]) -> _NDArray[_np.float64]: ...
    def at(self, s_mm: _t.Any) -> _t.Any:
        """Returns the point at an arc length, clamped to 0 ... length; of an array of lengths the points, shape (n, 2)."""
        if isinstance(s_mm, (int, float)) and -1e300 < s_mm < 1e300:
            return Point(*self._core.at(s_mm))
        lengths = _floats("s_mm", s_mm)
        if lengths.ndim == 0:
            return Point(*self._core.at(float(lengths)))
        return self._core.at_all(lengths.ravel())

    def meets_x(self, x_mm: float) -> list[float]:
        """Returns the arc lengths, ascending, at which the path meets the line x = x_mm, touching included."""
        return self._core.meets_x(_number("x_mm", x_mm))  # type: ignore[no-any-return]

    def meets_y(self, y_mm: float) -> list[float]:
        """Does the same for the line y = y_mm."""
        return self._core.meets_y(_number("y_mm", y_mm))  # type: ignore[no-any-return]

    def __repr__(self) -> str:
        data = self.data
        return f"<tactor.Path {data if len(data) <= 60 else data[:57] + '...'!r}: {self.length_mm:.6g} mm>"
