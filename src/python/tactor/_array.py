# SPDX-License-Identifier: MIT
"""Arrays of tactors and their places."""
from __future__ import annotations

import os
import typing as _t

from tactor import _tactor
from tactor._checks import _Columns, _counted, _floats, _Member, _need, _number, _place, reading, _shown, _Value, _whole
from tactor._errors import InputError

if _t.TYPE_CHECKING:
    import numpy as _np
    from numpy.typing import ArrayLike as _ArrayLike, NDArray as _NDArray
    _Actuator = _t.Literal["unknown", "piezo", "voice-coil", "lra", "erm"]
    _EachTactor = _t.Union[float, _t.Iterable[float], None]
    _Worn = tuple[str, str, _t.Optional[tuple[float, float]], _t.Optional[float], _t.Optional[float]]
    _Thresholds = _t.Union[float, _t.Iterable[_t.Union[float, _t.Sequence[tuple[float, float]], None]], None]


class Point(_t.NamedTuple):
    """A place on the skin in millimetres: x to the right, y down, as on a screen."""

    x: float
    y: float


class Tactor(_t.NamedTuple):
    """A vibrating actuator of an array.

    Parameters
    ----------
    position : Point
        Centre, mm.
    channel : int
        Channel of the device, from 0.
    gain_db : float
        Added to levels in dBFS; not to those in dB SL.
    max_dbfs : float
        Hard limit of the channel, at most 0 dBFS.
    threshold_dbfs : float or None
        Measured detection threshold.
    polarity : int
        1, or -1 if its wires are swapped.
    actuator : str
        How it works.
    thresholds : tuple of (float, float)
        Measured at several frequencies, Hz and dBFS, ascending; in place of threshold_dbfs.
    rise_s : float or None
        Time until it moves with 1 - 1/e of its strength.
    displacement_um_at_0dbfs : float or None
        Measured peak displacement at 0 dBFS, um, for reports.
    """

    position: Point
    channel: int
    gain_db: float = 0.0
    max_dbfs: float = 0.0
    threshold_dbfs: float | None = None
    polarity: int = 1
    actuator: _Actuator = "unknown"
    thresholds: tuple[tuple[float, float], ...] = ()
    rise_s: float | None = None
    displacement_um_at_0dbfs: float | None = None


class PerceptMap(_Columns):
    """The predicted percept of a phantom at each place of a grid over an array: a model, never a measurement. Immutable.

    Attributes
    ----------
    y : ndarray, shape (rows,)
        mm.
    x : ndarray, shape (columns,)
        mm.
    positions : ndarray, shape (rows, columns, 2)
        Centre of energy of the tactors that make it, mm; NaN outside the array.
    error_mm : ndarray, shape (rows, columns)
        Distance from where it was asked for to there; NaN outside the array.
    intensity : ndarray, shape (rows, columns)
        Root of the energy of all its tactors, linear; NaN outside the array.
    """

    __slots__ = ("y", "x", "positions", "error_mm", "intensity")

    y: _NDArray[_np.float64]
    x: _NDArray[_np.float64]
    positions: _NDArray[_np.float64]
    error_mm: _NDArray[_np.float64]
    intensity: _NDArray[_np.float64]

    def __repr__(self) -> str:
        return f"<tactor.PerceptMap: {len(self.y)} x {len(self.x)} places>"


class Array(_Value):
    """The tactors: their places, and how each is driven. Immutable.

    Made by `preset`, `from_file`, `grid`, `from_points` or of a name and a sequence of `Tactor`.

    Raises
    ------
    InputError
        For no tactors, two on one place or channel, and numbers out of range.
    """

    __slots__ = ("_core", "_file", "_besides", "_origin", "_setup", "_tactors", "_worn")

    _core: _t.Any
    _file: str | None
    _besides: str  # [output], [amplifier], [sync], [limits], [serve] and [defaults] of its file, as TOML
    _origin: str  # [calibration], the same way
    _setup: _t.Any  # these tables, once they are needed
    _tactors: tuple[Tactor, ...]

    def __init__(self, name: str, tactors: _t.Iterable[Tactor]) -> None:
        self._take(_make_core(name, tactors))

    def _take(self, core: _t.Any, file: str | None = None, besides: str = "", origin: str = "") -> None:
        self._core = core
        self._file = file
        self._besides = besides
        self._origin = origin
        self._setup = None
        self._worn: _Worn = core.site, core.up, core.place, core.turn_deg, core.body_mm
        self._tactors = tuple(Tactor._make((Point(*at), *rest, tuple(thresholds), rise_s, um))
                              for at, *rest, thresholds, rise_s, um in core.rows)

    @classmethod
    def _wrap(cls, core: _t.Any, file: str | None = None, besides: str = "", origin: str = "") -> Array:
        made = cls.__new__(cls)
        made._take(core, file, besides, origin)
        return made

    @classmethod
    def preset(cls, name: str) -> Array:
        """Returns a built-in array: "palm-3x3", "palm-2x4", "dualsense" or "usb-7.1" (`array_presets`)."""
        _need(name, str, "name")
        return cls._wrap(_tactor.Array.preset(name))

    @classmethod
    def from_file(cls, path: str | os.PathLike[str]) -> Array:
        """Reads an array file, see tactor.toml(5).

        What else the file says belongs to the array, as in the tool: [defaults] for what nobody says, the rate and channels of
        [output], the marker of [sync], the actuator of [texture], and for a `Player` on it also amplifier and limits. `replace` keeps
        it, and arrays that differ in it are not equal.

        Raises
        ------
        InputError
            With file, line and column.
        """
        with reading(path) as name:
            setup = _tactor.Setup.load(name)
            if setup.array is None:
                raise InputError(os.fspath(path), "it has no [array]", "add one, see tactor.toml(5)")
        return cls._wrap(setup.array, os.path.abspath(path), setup.besides(), setup.origin())

    @classmethod
    def grid(cls, name: str, rows: int, columns: int, pitch_mm: float | tuple[float, float]) -> Array:
        """Makes a rectangular grid; tactor and channel `row * columns + column`, the first at (0, 0).

        Parameters
        ----------
        name : str
        rows, columns : int
        pitch_mm : float or tuple of float
            Distance of neighbours, or that of columns (x) and that of rows (y).
        """
        try:
            x, y = pitch_mm  # type: ignore[misc]
        except (TypeError, ValueError):
            x = y = pitch_mm
        _need(name, str, "name")
        n, m = (_whole(what, count, 1, 1024, "use 1 to 1024 tactors") for what, count in (("rows", rows), ("columns", columns)))
        return cls._wrap(_tactor.Array.grid(name, n, m, _number("pitch_mm", x), _number("pitch_mm", y)))

    @classmethod
    def from_points(cls, points: _ArrayLike, name: str = "points") -> Array:
        """Makes an array of places [(x_mm, y_mm), ...]; channels count from 0 in this order."""
        return cls(name, [Tactor(Point(x, y), i) for i, (x, y) in enumerate(_places("points", points).tolist())])

    name: _Member[str] = _Member("name", "Name, for plans and pictures.")
    positions: _Member[_NDArray[_np.float64]] = _Member("positions", "Places, shape (n, 2), mm; a view that cannot be written.")
    channels: _Member[int] = _Member("channels", "Channels that the map needs, the highest and one.")

    site: _Member[str] = _Member("site", 'Place on the body that its file says, such as "left palm"; else empty.')
    up: _Member[str] = _Member("up", 'Direction of its upper edge on the body that its file says, such as "fingers"; else empty.')
    place: _Member[tuple[float, float] | None] = _Member(
        "place", "Place of its middle that its file says, from the site's landmark, mm; for pictures.")
    turn_deg: _Member[float | None] = _Member(
        "turn_deg", "Turn of the body part under it that its file says, clockwise on a screen; for pictures.")
    body_mm: _Member[float | None] = _Member("body_mm", "Length of the body part that its file says, such as the hand's; for pictures.")

    @property
    def tactors(self) -> tuple[Tactor, ...]:
        """The tactors by number."""
        return self._tactors

    faces: _Member[list[list[int]]] = _Member("faces", "Delaunay faces as numbers of tactors in order round each; none where all are in one line.")
    pitch_mm: _Member[float] = _Member("pitch_mm", "Median distance from a tactor to its nearest neighbour; 0 for a single one.")
    grid_lines: _Member[tuple[list[float], list[float]] | None] = _Member(
        "grid_lines", "The x of the columns and the y of the rows, mm, where the tactors form a rectangular grid; else None.")

    def contains(self, point: _t.Sequence[float]) -> bool:
        """Returns True for a place in the hull of the tactors, its edge included."""
        return self._core.contains(*_place("point", point))  # type: ignore[no-any-return]

    def nearest(self, point: _t.Sequence[float]) -> Point:
        """Returns the place of the hull that is nearest to a place."""
        return Point(*self._core.nearest(*_place("point", point)))

    @_t.overload
    def weights(self, point: tuple[float, float], phantom: str = "inverse-distance", intensity: float = 1.0, *,
                faces: str = "delaunay") -> dict[int, float]: ...
    @_t.overload
    def weights(self, point: _NDArray[_np.float64] | _t.Sequence[_t.Sequence[float]], phantom: str = "inverse-distance",
                intensity: float = 1.0, *, faces: str = "delaunay") -> _NDArray[_np.float64]: ...
    def weights(self, point: _t.Any, phantom: str = "inverse-distance", intensity: float = 1.0, *, faces: str = "delaunay") -> _t.Any:
        """Returns the tactors that make a phantom at a place, with their amplitudes.

        Parameters
        ----------
        point : (float, float) or array_like, shape (n, 2)
            A place or several, mm.
        phantom : str
            Name of a built-in model, see `plan`.
        intensity : float
            Linear.
        faces : str
            As in `plan`.

        Returns
        -------
        dict of int and float, or ndarray, shape (n, tactors)
            Of one place the amplitudes above 0 by number, of several all of them.

        Raises
        ------
        InputError
            For a place outside the array, as `plan` has it; for faces that do not go with the model.
        """
        import numpy as np
        _need(phantom, str, "phantom")
        _need(faces, str, "faces")
        strength = _number("intensity", intensity, 0.0)
        if np.ndim(point) == 2:
            return _tactor.phantom_weights(phantom, faces, self._core, _places("point", point), strength)
        (row,) = _tactor.phantom_weights(phantom, faces, self._core, np.array([_place("point", point)]), strength).tolist()
        return {i: amplitude for i, amplitude in enumerate(row) if amplitude > 0.0}

    def percept_map(self, step_mm: float = 1.0, phantom: str = "inverse-distance", *, faces: str = "delaunay") -> PerceptMap:
        """Predicts how phantoms feel all over the array.

        Parameters
        ----------
        step_mm : float
            Distance of the places, from 0.01 mm; at most a million places.
        phantom : str
            Name of a built-in model, see `plan`.
        faces : str
            As in `plan`.

        Returns
        -------
        PerceptMap

        Raises
        ------
        InputError
            For a step that gives more places; for faces that do not go with the model.
        """
        import numpy as np
        step = _number("step_mm", step_mm, 0.01, 1e6)
        low, high = self.positions.min(axis=0), self.positions.max(axis=0)
        counts = np.floor((high - low) / step + 1e-9) + 1
        if counts.prod() > 1e6:
            raise InputError("step_mm", f"{step:g} gives {counts.prod():.0f} places", "use a larger step: at most 1000000 places", field="step_mm")
        x, y = (low[axis] + step * np.arange(counts[axis]) for axis in (0, 1))
        asked = np.stack(np.meshgrid(x, y), axis=-1)
        inside = np.array([self.contains(place) for place in asked.reshape(-1, 2)]).reshape(asked.shape[:2])
        energy = self.weights(asked[inside].reshape(-1, 2), phantom, faces=faces) ** 2
        felt, intensity = np.full(asked.shape, np.nan), np.full(asked.shape[:2], np.nan)
        total = energy.sum(axis=1)
        felt[inside] = energy @ self.positions / total[:, None]
        intensity[inside] = np.sqrt(total)
        return PerceptMap(y, x, felt, np.hypot(*np.moveaxis(felt - asked, -1, 0)), intensity)

    def replace(self, *, name: str | None = None, tactors: _t.Iterable[Tactor] | None = None, channels: _t.Iterable[int] | None = None,
                gains: _EachTactor = None, max_dbfs: _EachTactor = None, thresholds: _Thresholds = None,
                polarities: _t.Iterable[int] | None = None) -> Array:
        """Returns the array with the given changes; the other tables of its file stay.

        Parameters
        ----------
        name : str, optional
        tactors : iterable of Tactor, optional
            All of them anew; the other arguments count on top.
        channels : iterable of int, optional
            Channel of each tactor.
        gains : float or iterable of float, optional
            Gain of all, or of each, dB.
        max_dbfs : float or iterable of float, optional
            Limit of all, or of each, at most 0 dBFS.
        thresholds : iterable of float, of None or of [(Hz, dBFS), ...], optional
            Threshold of each, dBFS; None where none was measured. What the file says of how they were measured goes.
        polarities : iterable of int, optional
            1 or -1 of each.

        Returns
        -------
        Array

        Raises
        ------
        InputError
            For another number of values than tactors, and as `Array` does.
        """
        made = self._tactors if tactors is None else _checked_tactors(tactors)
        for field, what, values in (("channel", "channels", channels), ("gain_db", "gains", gains), ("max_dbfs", "max_dbfs", max_dbfs),
                                    ("polarity", "polarities", polarities)):
            if values is not None:
                made = tuple(t._replace(**{field: value}) for t, value in zip(made, _each(what, values, len(made))))
        if thresholds is not None:
            made = tuple(t._replace(threshold_dbfs=None, thresholds=()) for t in made)
            for i, one in enumerate(_each("thresholds", thresholds, len(made))):
                listed = hasattr(one, "__len__") and not isinstance(one, str)
                made = (*made[:i], made[i]._replace(**{"thresholds" if listed else "threshold_dbfs": one}), *made[i + 1:])
        origin = self._origin if tactors is None and thresholds is None else ""
        return Array._wrap(_make_core(self.name if name is None else name, made, self._worn), self._file, self._besides, origin)

    def write(self, file: str | os.PathLike[str], force: bool = False) -> None:
        """Writes an array file that `from_file` and the tool read, with all that `replace` keeps. It needs no other file.

        Complete or not at all. The last line has a SHA-256: without `force` a file is replaced only as tactor wrote it.

        Parameters
        ----------
        file : path-like
        force : bool
            True replaces a file that tactor did not write, or that somebody changed since.

        Raises
        ------
        InputError
            For a folder that does not exist, and a file that `force` would replace.
        StreamError
            For what the file system refuses.
        """
        with reading(file) as to:
            _tactor.write_toml(to, self._core.text() + self._besides + self._origin, bool(force))

    def _settings(self) -> _t.Any:
        """Returns the other tables of its file; None if there are none."""
        if self._setup is None and self._besides:
            self._setup = _tactor.Setup.parse(self._besides)
        return self._setup

    def __len__(self) -> int:
        return len(self._tactors)

    @_t.overload
    def __getitem__(self, i: int) -> Tactor: ...
    @_t.overload
    def __getitem__(self, i: slice) -> tuple[Tactor, ...]: ...
    def __getitem__(self, i: int | slice) -> Tactor | tuple[Tactor, ...]:
        return self._tactors[i]

    def __iter__(self) -> _t.Iterator[Tactor]:
        return iter(self._tactors)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Array):
            return NotImplemented
        return all(getattr(self, what) == getattr(other, what) for what in ("name", "_worn", "_tactors", "_besides"))

    def __hash__(self) -> int:
        return hash((self.name, self._tactors))

    def __repr__(self) -> str:
        return f"<tactor.Array {self.name!r}: {_counted(len(self), 'tactor')}, {_counted(self.channels, 'channel')}>"

    def __reduce__(self) -> tuple[_t.Callable[..., _t.Any], tuple[_t.Any, ...]]:
        return _array_again, (self.name, self._tactors, self._file, self._besides, self._origin, self._worn)


def _places(what: str, points: _t.Any) -> _t.Any:
    places = _floats(what, points)
    if places.ndim != 2 or places.shape[1] != 2:
        raise InputError(what, f"their shape is {places.shape}", "give [(x_mm, y_mm), ...]", field=what)
    return places


def _row(t: Tactor) -> tuple[_t.Any, ...]:
    """Returns a tactor as the extension takes it."""
    def level(name: str) -> float | None:
        value = getattr(t, name)
        return None if value is None else _number(name, value)
    try:
        thresholds = [(_number("thresholds", hz), _number("thresholds", dbfs)) for hz, dbfs in t.thresholds]
    except (TypeError, ValueError) as e:
        if isinstance(e, InputError):
            raise
        raise InputError("thresholds", f"{_shown(t.thresholds)} is not a list of thresholds", "give [(Hz, dBFS), ...]", field="thresholds") from None
    return (_place("position", t.position), _whole("channel", t.channel, 0, 1023), _number("gain_db", t.gain_db), _number("max_dbfs", t.max_dbfs),
            level("threshold_dbfs"), _whole("polarity", t.polarity, -1, 1, "use 1 or -1"), t.actuator, thresholds, level("rise_s"),
            level("displacement_um_at_0dbfs"))


def _checked_tactors(tactors: _t.Iterable[Tactor]) -> tuple[Tactor, ...]:
    tactors = tuple(tactors)
    for t in tactors:
        _need(t, Tactor, "tactors")
    return tactors


def _make_core(name: str, tactors: _t.Iterable[Tactor], worn: _Worn = ("", "", None, None, None)) -> _t.Any:
    tactors = _checked_tactors(tactors)
    _need(name, str, "name")
    return _tactor.Array((name, [_row(t) for t in tactors], *worn))


def _each(what: str, values: _t.Any, count: int) -> list[_t.Any]:
    """Returns a value for each tactor: the members of an iterable, else the same for all."""
    if isinstance(values, (str, bytes)):
        raise InputError(what, f"{_shown(values)} is not a list", "give one for each tactor", field=what)
    try:
        all_of_them = list(values)
    except TypeError:
        return [values] * count
    if len(all_of_them) != count:
        raise InputError(what, f"there are {len(all_of_them)} for {_counted(count, 'tactor')}", "give one for each tactor", field=what)
    return all_of_them


def _array_again(name: str, tactors: tuple[Tactor, ...], file: str | None, besides: str, origin: str,
                 worn: _Worn) -> Array:
    return Array._wrap(_make_core(name, tactors, worn), file, besides, origin)


def array_presets() -> list[str]:
    """Returns the names of the built-in arrays."""
    return _tactor.array_presets()  # type: ignore[no-any-return]
