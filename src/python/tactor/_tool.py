# SPDX-License-Identifier: MIT
"""Comparisons, pictures and devices, as the tool has them."""
from __future__ import annotations

import collections.abc as _abc
import os
import typing as _t

from tactor import _tactor
from tactor._array import Array
from tactor._checks import encoded, _need, _number, reading, _shown, _whole
from tactor._errors import InputError
from tactor._score import Score, placed
from tactor._stroke import Stroke

if _t.TYPE_CHECKING:
    from tactor._plan import _Algorithm, _Compensate, _Faces, _IntensityScale, _Observer, _Outside, _Overlap, _Phantom, _Timing
    from tactor._score import _Plans
    _View = _t.Literal["array", "timing", "wave", "both"]


def _size(width: float, dpi: int) -> tuple[float, int]:
    return _number("width", width, *_tactor.WIDTHS_MM), _whole("dpi", dpi, *_tactor.DPI)


class Comparison(list[dict[str, _t.Any]]):
    """The predicted percepts of algorithms: a dict for each algorithm with each phantom model, as the `results` of
    `tactor compare --format json`.

    Attributes
    ----------
    record : dict
        The whole tactor-compare/1 object.
    """

    record: dict[str, _t.Any]

    def __init__(self, core: _t.Any) -> None:
        import json
        self.record = json.loads(core.json())
        self._core = core
        super().__init__(self.record["results"])

    def plot(self, file: str | os.PathLike[str], *, width: float = 85.0, dpi: int = 300, force: bool = False) -> None:
        """Draws it, as `tactor compare -o` does: .svg, .png or .pdf, `width` in mm. `force`: as in `plot`."""
        with reading(file) as name:
            self._core.save(name, *_size(width, dpi), bool(force))

    def _repr_svg_(self) -> str:
        return self._core.svg(85.0)  # type: ignore[no-any-return]

    def __reduce__(self) -> _t.Any:
        return list, (list(self),)


def _names(what: str, value: str | _t.Iterable[str] | None, one: _t.Any) -> list[str]:
    """Returns the names in `value`; an empty list for None. Refuses names if `one`, the option for a single name, is set, too."""
    if value is None:
        return []
    if one is not None:
        raise InputError(what, f"it cannot be combined with {what[:-1]}", "give one of them", field=what)
    if not isinstance(value, (str, _abc.Iterable)):
        raise InputError(what, f"{_shown(value)} is not a list of names", field=what)
    names = value.split(",") if isinstance(value, str) else list(value)
    if not names:
        raise InputError(what, "there are none", "name at least one", field=what)
    for name in names:
        if not isinstance(name, str):
            raise InputError(what, f"{_shown(name)} is not a name", "name built-in ones", field=what)
        if names.count(name) > 1:
            raise InputError(what, f"{name!r} occurs twice", "name each once", field=what)
    return names


def compare(array: Array, stroke: Stroke, *, algorithms: _t.Union[str, _t.Iterable[_Algorithm], None] = None,
            phantoms: _t.Union[str, _t.Iterable[_Phantom], None] = None, duration: float | None = None, speed: float | None = None,
            outside: _Outside | None = None, fit: bool | None = None, fit_margin: float | None = None, algorithm: _Algorithm | None = None,
            phantom: _Phantom | None = None, faces: _Faces | None = None, soa: float | None = None, burst: float | None = None,
            slope: float | None = None, intercept: float | None = None, timing: _Timing | None = None, min_duration: float | None = None,
            snap: bool | None = None, drop_points: bool | None = None, overlap: _Overlap | None = None, compensate: _Compensate | None = None,
            sigma_mm: float | None = None, sigma_v_mm_s: float | None = None, carrier: float | None = None, sl: float | None = None,
            intensity_scale: _IntensityScale | None = None, stevens_exponent: float | None = None, observer: _Observer | None = None,
            spread: int | None = None, spread_seed: int | None = None, spread_sigma: float | None = None,
            spread_threshold_db: float | None = None, spread_place_mm: float | None = None) -> Comparison:
    """Predicts how the same stroke feels with several algorithms: a model, never a measurement.

    Parameters
    ----------
    array : Array
    stroke : Stroke
    algorithms : iterable of str
        What to compare; default: all three, or `algorithm` alone.
    phantoms : iterable of str
        With which phantom models; default: that of `phantom`.
    duration, speed, outside, fit, fit_margin, algorithm, phantom, faces, soa, burst, slope, intercept, timing, min_duration, snap, drop_points
        As in `plan`.
    overlap, compensate, sigma_mm, sigma_v_mm_s, carrier, sl, intensity_scale, stevens_exponent
        As in `plan`.
    observer : str
        Model that predicts what people feel (default centroid). One of "centroid", "low-speed".
    spread : int
        Also predict for this many people, drawn at random. 2 to 100000.
    spread_seed : int
        spread: seed of the draw (default 1). 0 to 4294967295.
    spread_sigma : float
        spread: factor by which people's low-speed sigma differs (default 2). 1 to 100.
    spread_threshold_db : float
        spread: range of thresholds, plus and minus (default 6). 0 to 60 dB.
    spread_place_mm : float
        spread: range of each tactor's place (default 2). 0 to 1000 mm.

    Returns
    -------
    Comparison
        A list of dicts with the errors of each: "rms_to_path_mm" from the path, "rms_error_mm" at equal times, "along_rms_mm" and
        "across_rms_mm" along and across the movement, "lag_s" and "rms_at_lag_mm", "speed_cv", and more: tactor-json(5) has all.
        An algorithm that cannot play the stroke says why under "refused".

    Raises
    ------
    InputError
        Where none can play it.
    """
    given = dict(locals())
    for name in ("array", "stroke", "algorithms", "phantoms"):
        del given[name]
    _need(array, Array, "array")
    _need(stroke, Stroke, "stroke")
    if hasattr(phantom, "weights"):
        raise InputError("phantom", "a model of your own cannot be compared", "name a built-in model, or use the percept() of plan(phantom=...)",
                         field="phantom")
    of = _names("algorithms", algorithms, algorithm), _names("phantoms", phantoms, phantom)
    if not of[0] and algorithm is None:
        of[0].extend(("park2016", "tactile-brush", "continuous"))
    return Comparison(_tactor.Compared(array._core, stroke._core, given, *of, array._settings()))


def plot(plans: _Plans, file: str | os.PathLike[str], *, view: _View = "both", width: float = 85.0, dpi: int = 300,
         name: str | None = None, force: bool = False) -> None:
    """Draws the array, the path, the bursts and who plays when, as `tactor plot` does.

    Parameters
    ----------
    plans : Plan or iterable of Plan or of (float, Plan)
    file : path-like
        Ends in .svg, .png or .pdf.
    view : str
        What is shown: "array", "timing", "wave" or "both" (the first two).
    width : float
        mm (85, one print column).
    dpi : int
        Of a PNG.
    name : str, optional
        The title; default: the stroke's name.
    force : bool
        Replace a file that tactor did not write, or that was changed since.

    Raises
    ------
    InputError
        For another extension, a width out of range, a file that was read as input, or one that `force` would replace.
    """
    _need(view, str, "view")
    all_of_them = placed(plans)
    if not all_of_them:
        raise InputError("plans", "there are none", "give at least one")
    first = all_of_them[0][1]
    score = Score(first.array, all_of_them)._core if view == "wave" else None
    if name is None:
        name = first.stroke.name if len(all_of_them) == 1 else f"{len(all_of_them)} strokes"
    _need(name, str, "name")
    with reading(file) as to:
        _tactor.save_picture(first.array._core, [(start, p._core) for start, p in all_of_them], name, score, view, to, *_size(width, dpi), bool(force))


def devices(array: Array | None = None, *, device: str | None = None, rate: int | None = None,
            config: str | os.PathLike[str] | None = None) -> dict[str, _t.Any]:
    """Lists PCMs, what they can do, and GPIO lines, as `tactor devices --format json` prints them: a tactor-devices/1 object.

    Parameters
    ----------
    array : Array, optional
        For which array; default: the configuration's, else palm-3x3.
    device : str, optional
        The PCM that is asked about; default: the configuration's.
    rate : int, optional
        Hz.
    config : path-like, optional
        Configuration; default: the tool's. os.devnull: none.
    """
    if array is not None:
        _need(array, Array, "array")
    if device is not None:
        _need(device, str, "device")
        encoded(device, "device")
    hz = None if rate is None else _whole("rate", rate, 8000, 768000)
    core, file = (None, None) if array is None else (array._core, array._file)
    import json
    text = _tactor.devices(core, None if file is None else encoded(file), device, hz, None if config is None else encoded(config, "config"))
    return json.loads(text)  # type: ignore[no-any-return]
