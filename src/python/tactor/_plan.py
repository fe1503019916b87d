# SPDX-License-Identifier: MIT
"""Plans: tactors, times and amplitudes."""
from __future__ import annotations

import collections.abc as _abc
import os
import typing as _t

from tactor import _tactor
from tactor._array import Array, Point
from tactor._checks import _Member, _need, reading, _split_envelope, _Value
from tactor._errors import Error, InputError
from tactor._parts import Burst, Conflict, Curve, Drive, Frozen, Meeting, Percept
from tactor._stroke import Stroke

if _t.TYPE_CHECKING:
    import numpy as _np
    from numpy.typing import NDArray as _NDArray
    from tactor._calls import _Faces, _Overlap


class Plan(_Value):
    """The tactors, times and amplitudes of a stroke: bursts or, of a continuous stroke, a curve. Immutable.

    Made by `tactor.plan` or `from_dict`. Arrays are read-only views of the plan's memory; those of other shapes are made at their
    first use.
    """

    __slots__ = ("_core", "_array", "_recorded", "_kept")

    _core: _t.Any
    _array: Array
    _recorded: bool
    _kept: dict[str, _t.Any]

    def __init__(self) -> None:
        raise TypeError("use tactor.plan() or Plan.from_dict()")

    @classmethod
    def _wrap(cls, core: _t.Any, array: Array | None = None, recorded: bool = False) -> Plan:
        made = cls.__new__(cls)
        made._core = core
        made._array = array if array is not None else Array._wrap(core.array)
        made._recorded = recorded
        made._kept = {}
        return made

    @classmethod
    def from_dict(cls, d: _t.Mapping[str, _t.Any]) -> Plan:
        """Reads a plan from a tactor-plan/1 object, as `to_dict` or `tactor plan --format json` gives it.

        Raises
        ------
        InputError
            That names the field: one that is missing, one that no plan has, an amplitude above its burst's intensity.
        """
        import json
        try:
            text = json.dumps(d, allow_nan=False, default=_plain)
        except (TypeError, ValueError, RecursionError) as e:
            raise InputError("plan", f"it is no JSON: {e}", "see tactor-json(5)") from None
        try:
            return cls._read(text, "plan")
        except Error as e:
            e.file = None
            raise

    @classmethod
    def _read(cls, text: str, name: str) -> Plan:
        """Reads a plan from JSON; `name` stands for it in messages."""
        core = _tactor.Plan.from_json(text, name)
        return cls._wrap(core, recorded=True)

    def write(self, file: str | os.PathLike[str]) -> None:
        """Writes the plan as `tactor plan --format json` does: a record of every sample, for `load_plan` and the tool.

        Complete or not at all: an existing file, also one that was read, is replaced at the end.

        Parameters
        ----------
        file : path-like
            Ends in .json.

        Raises
        ------
        InputError
            For another extension, a folder that does not exist, and a level that a tactor may not have.
        StreamError
            For what the file system refuses.
        """
        with reading(file) as to:
            if not to.endswith(b".json"):
                raise InputError(os.fspath(file), "a plan is written as JSON", "end the name in .json")
            _tactor.write_text(to, self._core.json())

    def to_dict(self) -> dict[str, _t.Any]:
        """Returns the tactor-plan/1 object, as `tactor plan --format json` prints it: a record of every sample.

        Raises
        ------
        InputError
            For a level that a tactor may not have.
        """
        import json
        return json.loads(self._core.json())  # type: ignore[no-any-return]

    @property
    def array(self) -> Array:
        """The array that it is for."""
        return self._array

    @property
    def stroke(self) -> Stroke:
        """The stroke as it was planned, fitted and timed."""
        return Stroke._wrap(self._core.stroke)

    algorithm: _Member[str] = _Member("algorithm", "Name of the planner.")
    phantom: _Member[str] = _Member("phantom", "Name of the phantom model.")
    faces: _Member[_Faces] = _Member("faces", 'Which three tactors "inverse-distance" took.')
    overlap: _Member[_Overlap] = _Member("overlap", "Rule for bursts that overlap on the same tactor.")
    start: _Member[float | None] = _Member("start_s", "Seconds from the start of a piece; None is when the plan before it has ended.")
    stroke_duration: _Member[float] = _Member("stroke_duration_s", "Time of the stroke, s.")
    stroke_length_mm: _Member[float] = _Member("stroke_length_mm", "Length of the stroke.")
    carrier: _Member[float] = _Member("carrier_hz", "Frequency of the vibration, Hz.")
    soa: _Member[float | None] = _Member("soa_s", "Onset to onset of two bursts, s; None where they have none in common.")
    total: _Member[float] = _Member("total_s", "End of the last sound, s.")
    warnings: _Member[list[str]] = _Member("warnings", "Oddities that were accepted.")

    @property
    def conflicts(self) -> list[Conflict]:
        """Overlaps of bursts on the same tactor."""
        return self._keep("conflicts", lambda: Frozen(Conflict(*c) for c in self._core.conflicts))  # type: ignore[no-any-return]

    @property
    def dropped(self) -> list[Meeting]:
        """Crossings of the Tactile Brush that were left out."""
        return self._keep("dropped", lambda: Frozen(Meeting(t, Point(x, y)) for t, x, y in self._core.dropped))  # type: ignore[no-any-return]

    @property
    def bursts(self) -> list[Burst]:
        """Bursts by onset; empty for a continuous stroke. The list is made once and cannot be changed."""
        return self._keep("bursts", lambda: Frozen(  # type: ignore[no-any-return]
            Burst(onset, duration, Point(*at), intensity, tuple(Drive(*d) for d in drives))
            for onset, duration, at, intensity, drives in self._core.rows()))

    @property
    def curve(self) -> Curve | None:
        """The samples of a continuous stroke; None for bursts."""
        return self._keep("curve", lambda: Curve(*self._core.samples()) if self._core.continuous else None)  # type: ignore[no-any-return]

    @property
    def amplitudes(self) -> _NDArray[_np.float64]:
        """Shape (bursts, tactors), linear; 0 where a tactor does not sound."""
        return self._keep("amplitudes", self._core.amplitudes)  # type: ignore[no-any-return]

    onsets: _Member[_NDArray[_np.float64]] = _Member("onsets", "Shape (bursts,), s.")
    durations: _Member[_NDArray[_np.float64]] = _Member("durations", "Shape (bursts,), s.")
    positions: _Member[_NDArray[_np.float64]] = _Member("positions", "Shape (bursts, 2), mm.")
    intensities: _Member[_NDArray[_np.float64]] = _Member("intensities", "Shape (bursts,), linear.")

    @property
    def taus(self) -> _NDArray[_np.float64]:
        """Shape (bursts,), s, when the target is at the burst's position, of the Tactile Brush; NaN of others."""
        return self._keep("taus", self._core.taus)  # type: ignore[no-any-return]

    @property
    def compensation(self) -> dict[str, _t.Any] | None:
        """The effect of `compensate`, as in the record (observer, residuals and taps); None without it."""
        return self.to_dict().get("compensation")

    def percept(self) -> Percept:
        """Predicts the percept at 0, 1, 2 ... ms: a model, never a measurement.

        Returns
        -------
        Percept
            With the arrays t, positions, intensity and speed.
        """
        def made() -> Percept:
            t, targets, positions, intensity, target_intensity, shared, speed = self._core.felt()
            return Percept(t, positions, intensity, speed, targets, target_intensity, shared != 0.0)
        return self._keep("percept", made)  # type: ignore[no-any-return]

    def percept_summary(self) -> dict[str, float | None]:
        """Compares prediction and target: rms_error_mm, largest_error_mm, speed_cv, intensity_cv, silent_share, shared_share."""
        return self._core.summary()  # type: ignore[no-any-return]

    def to_pandas(self) -> _t.Any:
        """Returns a pandas DataFrame with a row for each burst (or sample) and a column `tactor_N` for each tactor's amplitude."""
        import pandas  # type: ignore
        c = self.curve
        columns: dict[str, _t.Any]
        if c is None:
            columns = {"onset_s": self.onsets, "duration_s": self.durations, "x_mm": self.positions[:, 0], "y_mm": self.positions[:, 1],
                       "intensity": self.intensities}
            amplitudes = self.amplitudes
        else:
            columns = {"t_s": c.t, "x_mm": c.positions[:, 0], "y_mm": c.positions[:, 1], "intensity": c.intensities}
            amplitudes = c.amplitudes
        columns |= {f"tactor_{i}": amplitudes[:, i] for i in range(amplitudes.shape[1])}
        return pandas.DataFrame(columns)

    def _place_on(self, array: Array) -> tuple[bool, _t.Any]:
        """Returns True if it was made for another array, and then the other tables of that array's file, which say what the plan leaves
        open. A record says all, and a plan has taken over what its own array's file says."""
        elsewhere = not (self._recorded or self._array is array or self._array == array)
        return elsewhere, array._settings() if elsewhere else None

    def _keep(self, name: str, make: _t.Callable[[], _t.Any]) -> _t.Any:
        if name not in self._kept:
            self._kept[name] = make()
        return self._kept[name]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Plan):
            return NotImplemented
        return (bool(self._core.same(other._core)) and self.start == other.start and self._array == other._array
                and self._core.recipe == other._core.recipe)

    def __hash__(self) -> int:
        return hash((self.algorithm, self.phantom, self.total, self._core.size, self._array, self._core.recipe))

    def __repr__(self) -> str:
        what = "continuous" if self._core.continuous else f"{self._core.size} burst{'s' if self._core.size != 1 else ''}"
        return f"<tactor.Plan of {self.stroke.name!r}: {self.algorithm}, {self.phantom}, {what}, {self.total:.6g} s on {self._array.name!r}>"

    def _repr_svg_(self) -> str:
        from tactor._tool import svg_of_plans
        return svg_of_plans(self)

    def __reduce__(self) -> tuple[_t.Callable[..., _t.Any], tuple[_t.Any, ...]]:
        return _plan_again, (self._core.json(), self._core.stroke.state(), self._array, self._recorded, self._core.asked)


def make_plan(given: dict[str, _t.Any]) -> Plan:
    """Makes the plan of plan()'s arguments."""
    options = _split_envelope(given)
    array, stroke = options.pop("array"), options.pop("stroke")
    _need(array, Array, "array")
    _need(stroke, Stroke, "stroke")
    return Plan._wrap(_tactor.Plan(array._core, stroke._core, options, array._settings()), array)


def burst_duration(*, soa: float | None = None, burst: float | None = None, slope: float | None = None,
                   intercept: float | None = None) -> float:
    """Returns the duration of park2016's bursts in seconds: `burst`, or what the timing law gives for the SOA.

    Raises
    ------
    InputError
        For an SOA out of bounds.
    """
    return _tactor.burst_duration(dict(soa=soa, burst=burst, slope=slope, intercept=intercept))  # type: ignore[no-any-return]


def load_plan(file: str | os.PathLike[str]) -> Plan:
    """Reads a plan that `Plan.write` or `tactor plan --format json` wrote.

    Parameters
    ----------
    file : path-like

    Returns
    -------
    Plan

    Raises
    ------
    InputError
        That names the file and the field, and for several plans in one file. A missing file is a FileNotFoundError, too.
    """
    with reading(file) as name:
        text = _tactor.read_text(name)
        return Plan._read(text, os.fspath(file))


def _plain(value: _t.Any) -> _t.Any:
    """Converts values that JSON does not know: other mappings, and numbers and arrays of NumPy."""
    if isinstance(value, _abc.Mapping):
        return dict(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"there is a {type(value).__name__} in it")


def _plan_again(text: str, stroke: bytes, array: Array, recorded: bool, asked: list[str]) -> Plan:
    return Plan._wrap(_tactor.Plan.from_parts(text, _tactor.Stroke.from_state(stroke), array._core, asked), array, recorded)
