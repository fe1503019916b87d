# SPDX-License-Identifier: MIT
"""What plans are made of."""
from __future__ import annotations

import typing as _t

from tactor._array import Point
from tactor._checks import _Value

if _t.TYPE_CHECKING:
    import numpy as _np
    from numpy.typing import NDArray as _NDArray


class PhantomModel(_t.Protocol):
    """What a model of your own looks like: `plan(array, stroke, phantom=model)`."""

    def weights(self, x_mm: float, y_mm: float, intensity: float) -> _t.Mapping[int, float]:
        """Amplitudes by tactor, finite and not below 0, that make a phantom of an intensity at a place in the hull.

        Its name in plans is the attribute `name`, or that of its class.
        """
        ...


class Drive(_t.NamedTuple):
    """One tactor's part in a burst: linear amplitude, where 1 is the intensity asked for."""

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
    """One instant of what is predicted to be felt: a model, never a measurement.

    `felt` is the centre of energy of the tactors that sound, None while none does; `speed` (mm/s) is smoothed over 0.1 s.
    """

    t: float
    target: Point
    felt: Point | None
    intensity: float
    target_intensity: float
    shared: bool
    speed: float | None


class Curve(_Value):
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
        for name, values in zip(self.__slots__, (t, positions, intensities, amplitudes)):
            values = values.view()
            values.flags.writeable = False
            object.__setattr__(self, name, values)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a curve cannot be changed, nor its {name!r}")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"a curve cannot be changed, nor its {name!r}")

    def __reduce__(self) -> tuple[_t.Callable[..., _t.Any], tuple[_t.Any, ...]]:
        return Curve, tuple(getattr(self, name) for name in self.__slots__)

    def __len__(self) -> int:
        return len(self.t)

    def __eq__(self, other: object) -> bool:
        import numpy as np
        if not isinstance(other, Curve):
            return NotImplemented
        return all(np.array_equal(getattr(self, n), getattr(other, n)) for n in self.__slots__)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<tactor.Curve: {len(self)} samples in {self.t[-1]:.6g} s>"
