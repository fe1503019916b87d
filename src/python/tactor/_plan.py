# SPDX-License-Identifier: MIT
"""Plans: tactors, times and amplitudes. `src/options/write.py` writes the options of `plan` and their types."""
from __future__ import annotations

import collections.abc as _abc
import os
import typing as _t

from tactor import _tactor
from tactor._array import Array, Point
from tactor._checks import _Columns, _Member, _need, _number, reading, _shown, _Value, _whole
from tactor._errors import Error, InputError
from tactor._stroke import Stroke

if _t.TYPE_CHECKING:
    import numpy as _np
    from numpy.typing import NDArray as _NDArray
    _Outside = _t.Literal["error", "clamp"]
    _Algorithm = _t.Literal["park2016", "tactile-brush", "continuous"]
    _Phantom = _t.Literal["inverse-distance", "barycentric", "linear", "log", "gaussian"]
    _Faces = _t.Literal["delaunay", "nearest"]
    _Timing = _t.Literal["fixed", "fit"]
    _Overlap = _t.Literal["energy", "max", "sum"]
    _Compensate = _t.Literal["none", "low-speed"]
    _Texture = _t.Literal["cycle", "time", "length"]
    _Phase = _t.Literal["stroke", "burst"]
    _Together = _t.Literal["weaken", "sum"]
    _IntensityScale = _t.Literal["linear", "sl", "stevens"]
    _SampleFormat = _t.Literal["float", "s16", "s24", "s24-4", "s32"]
    _Observer = _t.Literal["centroid", "low-speed"]


class PhantomModel(_t.Protocol):
    """A model of your own: `plan(array, stroke, phantom=model)`."""

    def weights(self, x_mm: float, y_mm: float, intensity: float) -> _t.Mapping[int, float]:
        """Amplitudes by tactor, finite and not below 0, that make a phantom of an intensity at a place in the hull.

        Its name in plans is the attribute `name`, or that of its class.
        """
        ...


def ask_model(model: _t.Any, name: str, x_mm: float, y_mm: float, intensity: float, tactors: int) -> list[tuple[int, float]]:
    """Returns the tactors and amplitudes above 0 that a model gives, in order of tactor; called by the extension."""
    what = f"phantom {name}"
    hint = f"let weights() return a dict of tactors, 0 to {tactors - 1}, and finite amplitudes, 0 or more"
    answer = model.weights(x_mm, y_mm, intensity)
    if not hasattr(answer, "items"):
        raise InputError(what, f"it returned {_shown(answer)}", hint)
    drives = [(_whole(what, tactor, 0, tactors - 1, hint), _number(what, amplitude, 0.0, hint=hint))
              for tactor, amplitude in dict(answer.items()).items()]
    return sorted(drive for drive in drives if drive[1] > 0.0)


_T = _t.TypeVar("_T")


class Frozen(list[_T]):
    """A list that was made once and cannot be changed."""

    def __init__(self, values: _t.Iterable[_T] = ()) -> None:
        if self:
            self._refuse()
        super().__init__(values)

    def _refuse(self, *_: object, **__: object) -> _t.NoReturn:
        raise TypeError("it belongs to a plan and cannot be changed: change a copy, list(...)")

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
            raise InputError("plan", f"it is not JSON: {e}", "see tactor-json(5)") from None
        try:
            return cls._read(text, "plan")
        except Error as e:
            e.file = None
            raise

    @classmethod
    def _read(cls, text: str | bytes, name: str | bytes) -> Plan:
        """Reads a plan from JSON; `name` stands for it in messages."""
        core = _tactor.Plan.from_json(text, name)
        return cls._wrap(core, recorded=True)

    def write(self, file: str | os.PathLike[str], force: bool = False) -> None:
        """Writes the plan as `tactor plan --format json` does: a record of every sample, for `load_plan` and the tool.

        Complete or not at all.

        Parameters
        ----------
        file : path-like
            Ends in .json.
        force : bool
            True replaces a file with another content.

        Raises
        ------
        InputError
            For another extension, a folder that does not exist, a level that a tactor may not have, and a file that `force` would replace.
        StreamError
            For what the file system refuses.
        """
        with reading(file) as to:
            if not to.endswith(b".json"):
                raise InputError(os.fspath(file), "a plan is written as JSON", "end the name in .json")
            _tactor.write_plan(to, self._core.json(True), bool(force))

    def to_dict(self) -> dict[str, _t.Any]:
        """Returns the tactor-plan/1 object, as `tactor plan --format json` prints it: a record of every sample.

        Raises
        ------
        InputError
            For a level that a tactor may not have.
        """
        import json
        return json.loads(self._core.json(True))  # type: ignore[no-any-return]

    @property
    def array(self) -> Array:
        """The array of the plan."""
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
        return self._keep("dropped", lambda: Frozen(Meeting(t, Point(*at)) for t, at in self._core.dropped))  # type: ignore[no-any-return]

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
        import json
        return _t.cast("dict[str, _t.Any]", json.loads(self._core.json(False))).get("compensation")

    def percept(self) -> Percept:
        """Predicts the percept at 0, 1, 2 ... ms: a model, never a measurement.

        Returns
        -------
        Percept
            With the arrays t, positions, intensity and speed.
        """
        return self._keep("percept", lambda: Percept(*self._core.felt()))  # type: ignore[no-any-return]

    def percept_summary(self) -> dict[str, float | None]:
        """Compares prediction and target.

        Returns
        -------
        dict
            rms_error_mm and largest_error_mm at equal times; along_rms_mm, along_max_mm, across_rms_mm and across_max_mm, their parts along
            and across the target's movement; lag_s, how late the felt path is, and rms_at_lag_mm, the RMS error with that shift;
            rms_to_path_mm, from the felt place to the nearest point of the path; speed_cv and intensity_cv, standard deviation / mean;
            silent_share and shared_share, of the time. None where a figure does not exist.
        """
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
        """Returns True if the plan was made for another array, and then the other tables of that array's file, which say what the plan leaves
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
        return _tactor.svg(self._array._core, [(self.start, self._core)], self.stroke.name, "both")  # type: ignore[no-any-return]

    def __reduce__(self) -> tuple[_t.Callable[..., _t.Any], tuple[_t.Any, ...]]:
        return _plan_again, (self._core.json(False), self._core.stroke.state(), self._array, self._recorded, self._core.sound_options)


def plan(array: Array, stroke: Stroke, *, duration: float | None = None, speed: float | None = None, outside: _Outside | None = None,
         fit: bool | None = None, fit_margin: float | None = None, algorithm: _Algorithm | None = None,
         phantom: _t.Union[_Phantom, PhantomModel, None] = None, faces: _Faces | None = None, soa: float | None = None, burst: float | None = None,
         slope: float | None = None, intercept: float | None = None, timing: _Timing | None = None, min_duration: float | None = None,
         snap: bool | None = None, drop_points: bool | None = None, overlap: _Overlap | None = None, compensate: _Compensate | None = None,
         sigma_mm: float | None = None, sigma_v_mm_s: float | None = None, carrier: float | None = None, waveform: str | None = None,
         am: _t.Union[float, str, None] = None, noise_seed: int | None = None, texture: _Texture | None = None, texture_mm: float | None = None,
         phase: _Phase | None = None, ramp: float | None = None, envelope: str | None = None, attack: float | None = None,
         release: float | None = None, tukey_part: float | None = None, level_dbfs: float | None = None, sl: float | None = None,
         together: _Together | None = None, intensity_scale: _IntensityScale | None = None, stevens_exponent: float | None = None,
         rate: int | None = None) -> Plan:
    """Plans a stroke on an array. Options are the tool's, see tactor-options(7); None is its default.

    Parameters
    ----------
    array : Array
    stroke : Stroke
    duration : float
        Duration of each stroke (default: the file's or preset's). 0.001 to 86400 s.
    speed : float
        Speed of each stroke, instead of its duration (default 60 if neither is set). 0.001 to 100000 mm/s.
    outside : str
        Refuse paths that leave the array, or move them to its edge (default error). One of "error", "clamp".
    fit : bool
        Scale and centre the strokes on the array.
    fit_margin : float
        fit: distance from the array's edge (default 0). 0 to 1000000 mm.
    algorithm : str
        Method that chooses the tactors and the times (default park2016). One of "park2016", "tactile-brush", "continuous".
    phantom : str
        Model that shares the intensity among tactors (default inverse-distance). One of "inverse-distance", "barycentric", "linear", "log",
        "gaussian".
    faces : str
        inverse-distance: the three tactors around the point, or the three closest (default delaunay). One of "delaunay", "nearest".
    soa : float
        Time from the onset of a burst to the onset of the next (default 0.07). More than 0.0473 s and at most 0.07 s; set burst for a wider range.
    burst : float
        Duration of each burst (default: from the SOA by the timing law). 0.0001 to 10 s.
    slope : float
        Slope of the timing law SOA = A duration + S (default 0.32). 0.01 to 0.99.
    intercept : float
        Intercept of the timing law (default 0.0473). 0.001 to 10 s.
    timing : str
        Keep the SOA, or shorten it so that the bursts end with the path (default fixed). One of "fixed", "fit".
    min_duration : float
        timing fit: shortest burst (default 0.02). 0.0001 to 10 s.
    snap : bool
        tactile-brush: move a start or end onto the grid.
    drop_points : bool
        tactile-brush: drop crossings until the timing is possible.
    overlap : str
        Intensity of bursts that overlap on one tactor (default energy). One of "energy", "max", "sum".
    compensate : str
        Move bursts so that the low-speed observer feels the target (default none). One of "none", "low-speed".
    sigma_mm : float
        low-speed: uncertainty of a place on the skin (default 5). 0.001 to 1000 mm.
    sigma_v_mm_s : float
        low-speed: spread of the expected speeds (default 100). 0.001 to 1000000 mm/s.
    carrier : float
        Frequency of the vibration (default 250). 1 to 384000 Hz.
    waveform : str
        Shape at the carrier's frequency, noise between two frequencies, or recording (default sine). As
        "sine|square|triangle|sawtooth|noise:LO-HI|FILE".
    am : float or str
        Amplitude modulation, depth 0 to 1 (default: none; depth 1). As "HZ[:DEPTH]".
    noise_seed : int
        noise: seed of its samples (default 1). 0 to 9007199254740992.
    texture : str
        FILE: play it as the carrier's cycle (default), at its own rate, or along the path. One of "cycle", "time", "length".
    texture_mm : float
        texture="length": length of path for the whole file (default: the whole path). 0 to 1000000 mm.
    phase : str
        Start the carrier with the stroke (default), or again with each burst. One of "stroke", "burst".
    ramp : float
        Raised-cosine ramp inside each burst (default: 0 between zero crossings, else 0.002). 0 to 10 s.
    envelope : str
        Rise and fall of a burst (default raised-cosine; tukey: PART of the burst, default 0.5). As "raised-cosine|linear|exponential|tukey[:PART]".
    attack : float
        Time in which each burst rises (default: ramp). 0 to 10 s.
    release : float
        Time in which each burst falls (default: that of its rise). 0 to 10 s.
    tukey_part : float
        envelope tukey: part of the burst in which it rises and falls (default 0.5). 0 to 1.
    level_dbfs : float
        Peak of the carrier at intensity 1 (default -12). -200 to 0 dBFS.
    sl : float
        Level above each tactor's threshold, instead of dBFS. -60 to 100 dB SL.
    together : str
        Strokes that overlap on a tactor: weaken all to stay within the level, or let them add up (default weaken). One of "weaken", "sum".
    intensity_scale : str
        Scale of intensities: amplitude (default), dB of sl, or felt strength. One of "linear", "sl", "stevens".
    stevens_exponent : float
        Felt = amplitude^E (default 0.6, at 250 Hz; 0.95 at 60 Hz: Stevens 1968). 0.1 to 3.
    rate : int
        Sample rate (default 48000). 8000 to 768000 Hz.

    Returns
    -------
    Plan

    Raises
    ------
    InputError
        SOA out of bounds, a path outside the array, timing that cannot be done, no grid for the Tactile Brush.

    Notes
    -----
    `phantom` may be a model of your own. "inverse-distance" is that of Park et al. 2016, Eq. 10. "nearest" takes the closest three tactors of all, as
    their paper says it to the letter; a warning counts the bursts that their triangle misses. The timing law is of Israr and Poupyrev 2011, "low-speed"
    of Goldreich 2007. What says how the plan sounds counts for a `Score` that says nothing else.
    """
    given = dict(locals())
    del given["array"], given["stroke"]
    _need(array, Array, "array")
    _need(stroke, Stroke, "stroke")
    return Plan._wrap(_tactor.Plan(array._core, stroke._core, given, array._settings()), array)


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
        return Plan._read(_tactor.read_text(name), name)


def _plain(value: _t.Any) -> _t.Any:
    """Converts values that JSON does not know: other mappings, and numbers and arrays of NumPy."""
    if isinstance(value, _abc.Mapping):
        return dict(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"there is a {type(value).__name__} in it")


def _plan_again(text: str, stroke: bytes, array: Array, recorded: bool, sound_options: list[str]) -> Plan:
    return Plan._wrap(_tactor.Plan.from_parts(text, _tactor.Stroke.from_state(stroke), array._core, sound_options), array, recorded)
