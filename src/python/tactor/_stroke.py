# SPDX-License-Identifier: MIT
"""Paths, and strokes along them: made and read."""
from __future__ import annotations

import os
import typing as _t
import warnings

from tactor import _tactor
from tactor._array import Array, Point, _places
from tactor._checks import _floats, _Member, _need, _number, _place, reading, _Stated
from tactor._errors import InputError

if _t.TYPE_CHECKING:
    import numpy as _np
    from numpy.typing import ArrayLike as _ArrayLike, NDArray as _NDArray
    _Note = _t.Literal["none", "reconstructed"]
    _StartFrom = _t.Literal["piece", "start", "end"]
    _Easing = _t.Literal["linear", "in-out", "minimum-jerk"]
    _Profile = float | _t.Sequence[_t.Sequence[float]]


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
        return cls._wrap(_tactor.Path.polyline(_places("points", points)))

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
        if _is_one(s_mm):
            return Point(*self._core.at(_number("s_mm", s_mm)))
        return self._core.at_all(_floats("s_mm", s_mm).ravel())

    def meets_x(self, x_mm: float) -> list[float]:
        """Returns the arc lengths, ascending, at which the path meets the line x = x_mm, touching included."""
        return self._core.meets_x(_number("x_mm", x_mm))  # type: ignore[no-any-return]

    def meets_y(self, y_mm: float) -> list[float]:
        """Does the same for the line y = y_mm."""
        return self._core.meets_y(_number("y_mm", y_mm))  # type: ignore[no-any-return]

    def __repr__(self) -> str:
        data = self.data
        return f"<tactor.Path {data if len(data) <= 60 else data[:57] + '...'!r}: {self.length_mm:.6g} mm>"


def _profile(name: str, points: _t.Any) -> _t.Any:
    """Returns (part, value) as rows of two numbers."""
    table = _floats(name, points)
    if table.size != 0 and (table.ndim != 2 or table.shape[1] != 2):
        raise InputError(name, "it is not a list of (part, value)", "give parts from 0, the path's start, to 1, its end")
    return table.tolist() if table.size else []


def _pauses(pauses: _t.Any) -> _t.Any:
    """Returns (part, seconds) or (part, seconds, intensity) as rows of three numbers."""
    rows = []
    for row in pauses:
        if not hasattr(row, "__len__") or len(row) not in (2, 3):
            raise InputError("pauses", f"an entry is {row!r}", "give (part, seconds) or (part, seconds, intensity)", field="pauses")
        rows.append((*row, 1.0)[:3])
    return _floats("pauses", rows).tolist() if rows else rows


def _is_one(value: _t.Any) -> bool:
    """Returns True for a number, False for a list of them."""
    return not hasattr(value, "__len__") or getattr(value, "ndim", 1) == 0


def _times(t: _t.Any) -> _t.Any:
    times = _floats("t", t)
    if times.ndim != 1:
        raise InputError("t", f"its shape is {times.shape}", "give a time, or a list of them", field="t")
    return times


def _placed(name: str, start: float | None, carrier: float | None) -> tuple[str, float | None, float | None]:
    _need(name, str, "name")
    return (name, None if start is None else _number("start", start, 0.0, 1e6),
            None if carrier is None else _number("carrier", carrier, 1.0, 384000.0))


class Stroke(_Stated):
    """A movement: where the target is at which time, and how strongly. Immutable.

    Made by `along`, `timed`, `preset`, `shape` or `tactor.load`.
    """

    __slots__ = ()

    def __init__(self) -> None:
        raise TypeError("use Stroke.along(), Stroke.timed(), Stroke.preset(), Stroke.shape() or tactor.load()")

    @classmethod
    def along(cls, path: Path, duration: float | None = None, *, speed: _Profile | None = None, intensity: _Profile = 1.0,
              easing: _Easing = "linear", pauses: _t.Sequence[_t.Sequence[float]] = (),
              name: str = "path", start: float | None = None, carrier: float | None = None) -> Stroke:
        """Along a path, at constant speed unless easing, a list of speeds or pauses say otherwise.

        Lists are over the part of the path's length, 0 at its start and 1 at its end; parts ascend, and between them all is linear.

        Parameters
        ----------
        path : Path
            One place makes a tap of the duration, which must be given then.
        duration : float, optional
            Time of the stroke in seconds, pauses included, more than 0 and at most a day.
        speed : float or [(part, mm/s), ...], optional
            Instead of it; 60 where neither is given. With a duration only the ratios of a list count.
        intensity : float or [(part, factor), ...]
            Linear; 1 is the level that is asked for.
        easing : str
            How it gets from rest to rest: "linear", "in-out" or "minimum-jerk" (Flash and Hogan 1985).
        pauses : [(part, seconds), ...] or [(part, seconds, intensity), ...]
            Where it stays for a while, in silence with an intensity of 0.
        name : str
        start : float, optional
            Seconds from the start of a piece; None: when the stroke before it has ended.
        carrier : float, optional
            Hz, instead of the plan's.
        """
        one_speed, one_intensity = _is_one(speed), _is_one(intensity)
        if duration is not None and speed is not None and one_speed:
            raise InputError("duration", "it cannot be combined with speed", "give one of them")
        _need(path, Path, "path")
        _need(easing, str, "easing")
        placing = _placed(name, start, carrier)
        duration = None if duration is None else _number("duration", duration)
        if one_speed and speed is not None:
            speed = _number("speed", speed)
        if one_intensity:
            intensity = _number("intensity", intensity)
        core = _tactor.Stroke.along(
            name, path._core, duration, speed if one_speed else None, intensity if one_intensity else 1.0, easing,
            [] if one_speed else _profile("speed", speed), [] if one_intensity else _profile("intensity", intensity), _pauses(pauses))
        return cls._wrap(core.same_as(*placing))

    @classmethod
    def timed(cls, t: _ArrayLike, x: _ArrayLike, y: _ArrayLike, intensity: _ArrayLike | None = None, *, intensity_max: float = 1.0,
              name: str = "timed", start: float | None = None, carrier: float | None = None) -> Stroke:
        """Linear between points of a time, a place and an intensity, as a recorder gives them.

        Parameters
        ----------
        t : array_like
            Seconds, ascending; at least two. The first becomes 0. Of points with equal times the last counts.
        x, y : array_like
            Places, mm. Where one is nan, the touch is lifted.
        intensity : array_like, optional
            Linear, one for each point or one for all; `intensity_max` without. Where it is nan, the touch is lifted.
        intensity_max : float
            The intensity that means 1, the level that is asked for: 100 for per cent, 127 for MIDI, 255 for 8 bits.
        name, start, carrier
            See `along`.
        """
        import numpy as np
        placing = _placed(name, start, carrier)
        intensity_max = _number("intensity_max", intensity_max)
        columns = [np.atleast_1d(_floats(n, v, nan=n != "t"))
                   for n, v in (("t", t), ("x", x), ("y", y), ("intensity", intensity_max if intensity is None else intensity))]
        count = columns[0].size
        for what, column in zip(("t", "x", "y"), columns):
            if column.ndim != 1 or column.size != count:
                raise InputError(what, f"its shape is {column.shape}, but must be ({count},)", "give t, x and y of the same length")
        if columns[3].size not in (1, count) or columns[3].ndim != 1:
            raise InputError("intensity", f"its shape is {columns[3].shape}, but must be ({count},)", "give one for each point, or one for all")
        columns[3] = np.broadcast_to(columns[3], (count,))
        return cls._wrap(_tactor.Stroke.timed(name, np.column_stack(columns), intensity_max).same_as(*placing))

    @classmethod
    def preset(cls, name: str) -> Stroke:
        """Returns a built-in stroke: "park2016-1" ... "park2016-4", "wave-2x4", "round-2x4" (`stroke_presets`)."""
        _need(name, str, "name")
        return cls._wrap(_tactor.Stroke.preset(name))

    @classmethod
    def shape(cls, name: str) -> Stroke:
        """Returns a "tap", "line", "circle", "eight" or "spiral", as large as the array for which it is planned (`stroke_shapes`)."""
        _need(name, str, "name")
        return cls._wrap(_tactor.Stroke.shape(name))

    name: _Member[str] = _Member("name", "Name; may be empty.")
    duration: _Member[float] = _Member("duration_s", "Time from start to end, s.")
    length_mm: _Member[float] = _Member("length_mm", "Length of the way.")
    start: _Member[float | None] = _Member("start_s", "Seconds from where `start_from` says; None is when the stroke before it has ended.")
    start_from: _Member[_StartFrom] = _Member(
        "start_from", 'From where `start` counts, as a file says it. The start of the "piece", or the "start" or "end" of strokes before.')
    choices: _Member[dict[str, str | float]] = _Member(
        "choices", "Options of `plan` that a file gives this stroke (algorithm, phantom, faces, soa, burst), which win over those of the call.")
    level_db: _Member[float] = _Member("level_db", "Its level in a file, relative to the other strokes.")
    carrier: _Member[float | None] = _Member("carrier_hz", "Its own carrier, Hz; None is the plan's.")
    speed: _Member[float | None] = _Member("speed_mm_s", "The speed, mm/s, from which its time follows; None where a time was given.")
    note: _Member[_Note] = _Member("note", "A note on its origin.")
    warnings: _Member[list[str]] = _Member("warnings", "Oddities of the input that were accepted.")

    @_t.overload
    def position(self, t: float) -> Point: ...
    @_t.overload
    def position(self, t: _t.Sequence[float] | _NDArray[_np.float64]) -> _NDArray[_np.float64]: ...
    def position(self, t: _t.Any) -> _t.Any:
        """Returns the target's place at a time in seconds, clamped to 0 ... duration; of an array of n times the places, shape (n, 2), mm."""
        if _is_one(t):
            return Point(*self._core.position(_number("t", t, finite=False)))
        return self._core.positions(_times(t))

    @_t.overload
    def intensity(self, t: float) -> float: ...
    @_t.overload
    def intensity(self, t: _t.Sequence[float] | _NDArray[_np.float64]) -> _NDArray[_np.float64]: ...
    def intensity(self, t: _t.Any) -> _t.Any:
        """Returns the target's intensity at a time in seconds, clamped to 0 ... duration; of an array of n times all, shape (n,), linear."""
        if _is_one(t):
            return self._core.intensity(_number("t", t, finite=False))
        return self._core.intensities(_times(t))

    def meets_x(self, x_mm: float) -> list[float]:
        """Returns the times, ascending, at which the target meets the line x = x_mm."""
        return self._core.meets_x(_number("x_mm", x_mm))  # type: ignore[no-any-return]

    def meets_y(self, y_mm: float) -> list[float]:
        """Does the same for the line y = y_mm."""
        return self._core.meets_y(_number("y_mm", y_mm))  # type: ignore[no-any-return]

    def with_duration(self, duration: float) -> Stroke:
        """Returns the same movement in another time, s, pauses included."""
        return self._wrap(self._core.with_duration(_number("duration", duration)))

    def with_speed(self, speed: float) -> Stroke:
        """Returns the same movement at another mean speed, mm/s; pauses along a path stay as long as they are."""
        return self._wrap(self._core.with_speed(_number("speed", speed)))

    def reversed(self) -> Stroke:
        """Returns the same movement played backwards."""
        return self._wrap(self._core.reversed())

    def with_intensity(self, factor: float) -> Stroke:
        """Returns the same movement with every intensity times a factor; none may get above 1."""
        return self._wrap(self._core.with_intensity(_number("factor", factor)))

    def write(self, file: str | os.PathLike[str], force: bool = False) -> None:
        """Writes a stroke file in TOML that `load` and the tool read.

        Warnings, and a start that counts from another stroke, are lost. Complete or not at all. The last line has a SHA-256: without `force` a file is
        replaced only as tactor wrote it.

        Parameters
        ----------
        file : path-like
            Ends in .toml.
        force : bool
            True replaces a file that tactor did not write, or that somebody changed since.

        Raises
        ------
        InputError
            For another extension, a folder that does not exist, and a file that `force` would replace.
        StreamError
            For what the file system refuses.
        """
        with reading(file) as to:
            if not to.endswith(b".toml"):
                raise InputError(os.fspath(file), "a stroke is written as TOML", "end the name in .toml")
            _tactor.write_toml(to, self._core.text(), bool(force))

    def fitted(self, array: Array, margin_mm: float = 0.0) -> Stroke:
        """Returns the same shape, as large as the array has space for and in its middle; see `fit_strokes`."""
        return fit_strokes([self], array, margin_mm)[0][0]

    def __repr__(self) -> str:
        return f"<tactor.Stroke {self.name!r}: {self.length_mm:.6g} mm in {self.duration:.6g} s>"

    def _repr_svg_(self) -> str:
        palm = _tactor.Array.preset("palm-3x3")
        plan = _tactor.Plan(palm, self._core, {"algorithm": "continuous", "outside": "clamp"}, None)
        return _tactor.svg(palm, [(plan.start_s, plan)], plan.stroke.name, "array")  # type: ignore[no-any-return]


class Fitting(_t.NamedTuple):
    """The new place of a picture: `origin` became `to`, and all distances are `scale` times what they were."""

    origin: Point
    to: Point
    scale: float


def fit_strokes(strokes: _t.Sequence[Stroke], array: Array, margin_mm: float = 0.0) -> tuple[list[Stroke], Fitting]:
    """Moves and scales strokes together, so that they are as large as the array has space for.

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
    return [Stroke._wrap(s) for s in fitted], Fitting(Point(*origin), Point(*to), scale)


def apply_fits(strokes: _t.Sequence[Stroke], array: Array) -> list[Stroke]:
    """Fits strokes as their file asks (`fit`), those of a group together. `plan` does it for a stroke alone.

    Parameters
    ----------
    strokes : sequence of Stroke
        As `load` gives them; a stroke that asks for no fit stays.
    array : Array

    Returns
    -------
    list of Stroke
        In the same order; they ask for no fit.

    Raises
    ------
    InputError
        For a margin that leaves no space.
    """
    _need(array, Array, "array")
    return [Stroke._wrap(s) for s in _tactor.apply_fits(_cores(strokes), array._core)]


def _cores(strokes: _t.Any) -> list[_t.Any]:
    for s in strokes:
        _need(s, Stroke, "strokes")
    return [s._core for s in strokes]


def load(file: str | os.PathLike[str], *, intensity_max: float = 1.0, position: str = "", array: Array | None = None) -> list[Stroke]:
    """Reads a stroke file by its extension, see tactor.toml(5).

    Parameters
    ----------
    file : path-like
    intensity_max : float
        The intensity in a recording (CSV, timed points) that means 1, see `Stroke.timed`.
    position : str
        Place on the body whose touches a .tact file plays, such as "VestBack". Empty: the first, front before back.
    array : Array
        Array whose file has the actuator, [texture], for the touches of a .haptic file (default: the format's actuator).

    Returns
    -------
    list of Stroke
        One or more; those of one piece have their `start`.

    Raises
    ------
    InputError
        With file, line and column.
    """
    _need(position, str, "position")
    if array is not None:
        _need(array, Array, "array")
    settings = None if array is None else array._settings()
    with reading(file) as name:
        return [Stroke._wrap(s) for s in _tactor.Stroke.load(name, _number("intensity_max", intensity_max), position, settings)]


def parse(text: str, name: str = "text", *, intensity_max: float = 1.0, position: str = "") -> list[Stroke]:
    """Reads strokes from the text of a stroke file, whose beginning gives its format. `intensity_max` and `position` as for `load`."""
    _need(text, str, "text")
    _need(position, str, "position")
    _need(name, str, "name")
    return [Stroke._wrap(s) for s in _tactor.Stroke.parse(text, name, _number("intensity_max", intensity_max), position)]


def save(strokes: _t.Union[Stroke, _t.Sequence[Stroke]], file: str | os.PathLike[str], force: bool = False) -> None:
    """Writes strokes as a file that `load` and the tool read; `tactor convert` writes the same.

    Complete or not at all. Warns about each thing that a file of this format cannot hold. A start that the file cannot hold becomes seconds from the
    start of the piece, as if each stroke lasted as long as its path.

    Parameters
    ----------
    strokes : Stroke or sequence of Stroke
        A CSV file has one.
    file : path-like
        Ends in .toml, .csv, .svg or .haptic, which has one vibration without places.
    force : bool
        True replaces a file that tactor did not write, or that somebody changed since.

    Raises
    ------
    InputError
        For another extension, a folder that does not exist, and a file that `force` would replace.
    StreamError
        For what the file system refuses.
    """
    cores = _cores([strokes] if isinstance(strokes, Stroke) else strokes)
    with reading(file) as to:
        for lost in _tactor.save_strokes(cores, to, bool(force)):
            warnings.warn(f"{os.fspath(file)!s}: {lost}", stacklevel=2)


def stroke_presets() -> list[str]:
    """Returns the names of the built-in strokes."""
    return _tactor.stroke_presets()  # type: ignore[no-any-return]


def stroke_shapes() -> list[str]:
    """Returns the names for `Stroke.shape`."""
    return _tactor.stroke_shapes()  # type: ignore[no-any-return]
