# SPDX-License-Identifier: MIT
"""Parts of plans."""
from __future__ import annotations

import math
import operator
import typing as _t

from tactor._array import Point
from tactor._checks import _shown, _Value
from tactor._errors import InputError

if _t.TYPE_CHECKING:
    import numpy as _np
    from numpy.typing import NDArray as _NDArray


class PhantomModel(_t.Protocol):
    """A model of your own: `plan(array, stroke, phantom=model)`."""

    def weights(self, x_mm: float, y_mm: float, intensity: float) -> _t.Mapping[int, float]:
        """Amplitudes by tactor, finite and not below 0, that make a phantom of an intensity at a place in the hull.

        Its name in plans is the attribute `name`, or that of its class.
        """
        ...


def ask_model(model: _t.Any, name: str, x_mm: float, y_mm: float, intensity: float, tactors: int) -> list[tuple[int, float]]:
    """Returns the tactors and amplitudes above 0 that a model gives, in order of tactor; called by the extension."""
    said = model.weights(x_mm, y_mm, intensity)
    if not hasattr(said, "items"):
        raise _refused_answer(name, f"it returned {_shown(said)}")
    drives = []
    for one in said.items():
        if not isinstance(one, tuple) or len(one) != 2:
            raise _refused_answer(name, f"its items() have {_shown(one)}")
        drives.append((_answered_tactor(name, one[0], tactors), _answered_amplitude(name, *one)))
    drives.sort()
    for (tactor, _), (following, _) in zip(drives, drives[1:]):
        if tactor == following:
            raise _refused_answer(name, f"it drives tactor {tactor} twice")
    return [drive for drive in drives if drive[1] > 0.0]


def _answered_tactor(name: str, key: _t.Any, tactors: int) -> int:
    try:
        tactor = operator.index(key)
    except TypeError:
        raise _refused_answer(name, f"it drives tactor {_shown(key)}, which is no whole number") from None
    if not 0 <= tactor < tactors:
        raise _refused_answer(name, f"it drives tactor {_shown(tactor)} of {tactors}")
    return tactor


def _answered_amplitude(name: str, key: _t.Any, value: _t.Any) -> float:
    amplitude = -1.0
    if not isinstance(value, (str, bytes, bytearray)):
        try:
            amplitude = float(value)
        except (TypeError, ValueError, OverflowError):
            pass
    if not 0.0 <= amplitude < math.inf:
        raise _refused_answer(name, f"tactor {_shown(key)} has the amplitude {_shown(value)}")
    return amplitude


def _refused_answer(name: str, why: str) -> InputError:
    return InputError(f"phantom {name}", why, "weights() returns a dict of tactor and amplitude, which is finite and not below 0")


_T = _t.TypeVar("_T")


class Frozen(list[_T]):
    """A list that was made once and cannot be changed."""

    def _refuse(self, *_: object, **__: object) -> _t.NoReturn:
        raise TypeError("it belongs to a plan and cannot be changed: list() of it can")

    append = extend = insert = remove = pop = clear = sort = reverse = _refuse  # type: ignore[assignment]
    __setitem__ = __delitem__ = __iadd__ = __imul__ = _refuse  # type: ignore[assignment]

    def __reduce__(self) -> tuple[_t.Any, ...]:
        return list, (list(self),)


class Drive(_t.NamedTuple):
    """The part of a tactor in a burst: linear amplitude, where 1 is the requested intensity."""

    tactor: int
    amplitude: float


class Burst(_t.NamedTuple):
    """Tactors that sound together from `onset` for `duration` (s), felt at `position` (mm) with an `intensity` (linear)."""

    onset: float
    duration: float
    position: Point
    intensity: float
    drives: tuple[Drive, ...]


class Conflict(_t.NamedTuple):
    """Two or more bursts on one tactor at once, from a time to another in seconds."""

    tactor: int
    from_s: float
    to_s: float


class Meeting(_t.NamedTuple):
    """A time in seconds at which the target is at a place, for which there is no burst."""

    t: float
    position: Point


class PerceptSample(_t.NamedTuple):
    """An instant of a predicted percept: a model, never a measurement.

    `felt` is the centre of energy of the tactors that sound, None while none does; `speed` (mm/s) is smoothed over 0.1 s.
    """

    t: float
    target: Point
    felt: Point | None
    intensity: float
    target_intensity: float
    shared: bool
    speed: float | None


class _Columns(_Value):
    """Arrays of the same length that belong together and cannot be changed."""

    __slots__: tuple[str, ...] = ()

    def _take(self, *columns: _NDArray[_t.Any]) -> None:
        for name, values in zip(self.__slots__, columns):
            values = values.view()
            values.flags.writeable = False
            object.__setattr__(self, name, values)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a {type(self).__name__.lower()} cannot be changed, nor its {name!r}")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"a {type(self).__name__.lower()} cannot be changed, nor its {name!r}")

    def __reduce__(self) -> tuple[_t.Callable[..., _t.Any], tuple[_t.Any, ...]]:
        return type(self), tuple(getattr(self, name) for name in self.__slots__)

    def __len__(self) -> int:
        return len(getattr(self, self.__slots__[0]))

    def __eq__(self, other: object) -> bool:
        import numpy as np
        if type(self) is not type(other):
            return NotImplemented
        return all(np.array_equal(getattr(self, n), getattr(other, n), equal_nan=True) for n in self.__slots__)

    __hash__ = None  # type: ignore[assignment]


class Curve(_Columns):
    """A continuous stroke, sampled each millisecond, the last at its end. Immutable.

    Attributes
    ----------
    t : ndarray, shape (n,)
        Seconds.
    positions : ndarray, shape (n, 2)
        mm.
    intensities : ndarray, shape (n,)
        Linear.
    amplitudes : ndarray, shape (n, tactors)
        Linear, 0 where a tactor does not sound.
    """

    __slots__ = ("t", "positions", "intensities", "amplitudes")

    t: _NDArray[_np.float64]
    positions: _NDArray[_np.float64]
    intensities: _NDArray[_np.float64]
    amplitudes: _NDArray[_np.float64]

    def __init__(self, t: _NDArray[_np.float64], positions: _NDArray[_np.float64], intensities: _NDArray[_np.float64],
                 amplitudes: _NDArray[_np.float64]) -> None:
        self._take(t, positions, intensities, amplitudes)

    def __repr__(self) -> str:
        return f"<tactor.Curve: {len(self)} samples in {self.t[-1]:.6g} s>"


class Percept(_Columns):
    """The predicted percept of a plan, sampled each millisecond: a model, never a measurement. Immutable.

    Also a sequence of `PerceptSample`.

    Attributes
    ----------
    t : ndarray, shape (n,)
        Seconds.
    positions : ndarray, shape (n, 2)
        Centre of energy of the tactors that sound, mm; NaN while none does.
    intensity : ndarray, shape (n,)
        Linear; 0 while none sounds.
    speed : ndarray, shape (n,)
        mm/s, smoothed over 0.1 s; NaN where there is none.
    targets : ndarray, shape (n, 2)
        Where the stroke is, mm.
    target_intensity : ndarray, shape (n,)
        How strong it is meant to be, linear.
    shared : ndarray of bool, shape (n,)
        Whether bursts at different places sound at once.
    """

    __slots__ = ("t", "positions", "intensity", "speed", "targets", "target_intensity", "shared")

    t: _NDArray[_np.float64]
    positions: _NDArray[_np.float64]
    intensity: _NDArray[_np.float64]
    speed: _NDArray[_np.float64]
    targets: _NDArray[_np.float64]
    target_intensity: _NDArray[_np.float64]
    shared: _NDArray[_np.bool_]

    def __init__(self, t: _NDArray[_np.float64], positions: _NDArray[_np.float64], intensity: _NDArray[_np.float64],
                 speed: _NDArray[_np.float64], targets: _NDArray[_np.float64], target_intensity: _NDArray[_np.float64],
                 shared: _NDArray[_np.bool_]) -> None:
        self._take(t, positions, intensity, speed, targets, target_intensity, shared)

    @_t.overload
    def __getitem__(self, i: int) -> PerceptSample: ...
    @_t.overload
    def __getitem__(self, i: slice) -> list[PerceptSample]: ...
    def __getitem__(self, i: int | slice) -> PerceptSample | list[PerceptSample]:
        if isinstance(i, slice):
            return [self[k] for k in range(*i.indices(len(self)))]
        x, y = self.positions[i].tolist()
        speed = float(self.speed[i])
        return PerceptSample(float(self.t[i]), Point(*self.targets[i].tolist()), None if x != x else Point(x, y), float(self.intensity[i]),
                             float(self.target_intensity[i]), bool(self.shared[i]), None if speed != speed else speed)

    def __iter__(self) -> _t.Iterator[PerceptSample]:
        return (self[i] for i in range(len(self)))

    def __repr__(self) -> str:
        return f"<tactor.Percept: {len(self)} samples in {self.t[-1]:.6g} s>"


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

    def __init__(self, y: _NDArray[_np.float64], x: _NDArray[_np.float64], positions: _NDArray[_np.float64],
                 error_mm: _NDArray[_np.float64], intensity: _NDArray[_np.float64]) -> None:
        self._take(y, x, positions, error_mm, intensity)

    def __repr__(self) -> str:
        return f"<tactor.PerceptMap: {len(self.y)} x {len(self.x)} places>"
