# SPDX-License-Identifier: MIT
"""From a stroke to a plan."""
from __future__ import annotations

import typing as _t

from tactor import _tactor
from tactor._array import Array
from tactor._checks import _need
from tactor._options import _PLANNING_AND_SOUNDING, _SOUNDING, settled
from tactor._parts import PhantomModel
from tactor._plan import Plan
from tactor._stroke import Stroke

if _t.TYPE_CHECKING:
    from tactor._options import _Algorithm, _Compensate, _Envelope, _Faces, _Outside, _Overlap, _Phantom, _Phase, _Scale, _Texture, _Timing


def plan(array: Array, stroke: Stroke, *, algorithm: _Algorithm | None = None, phantom: _t.Union[_Phantom, PhantomModel, None] = None,
         faces: _Faces | None = None, soa: float | None = None, burst: float | None = None, slope: float | None = None, intercept: float | None = None,
         duration: float | None = None, speed: float | None = None, timing: _Timing | None = None, min_duration: float | None = None,
         outside: _Outside | None = None, fit: bool | None = None, fit_margin: float | None = None, snap: bool | None = None, drop_points: bool | None = None,
         overlap: _Overlap | None = None, carrier: float | None = None, compensate: _Compensate | None = None,
         sigma_mm: float | None = None, sigma_v_mm_s: float | None = None, waveform: str | None = None,
         am: _t.Union[float, str, None] = None, noise_seed: int | None = None, texture: _Texture | None = None,
         texture_mm: float | None = None, intensity_scale: _Scale | None = None, stevens_exponent: float | None = None,
         phase: _Phase | None = None, ramp: float | None = None, envelope: _Envelope | None = None, attack: float | None = None,
         release: float | None = None, tukey_part: float | None = None, level_dbfs: float | None = None, sl: float | None = None,
         rate: int | None = None) -> Plan:
    """Plans a stroke on an array. Options are the tool's, see tactor(1); None is its default.

    Parameters
    ----------
    array : Array
    stroke : Stroke
    algorithm : str
        Who plays when: "park2016" (default), "tactile-brush" or "continuous".
    phantom : str or PhantomModel
        How strongly: "inverse-distance" (default; Park et al. 2016, Eq. 10), "barycentric", "linear", "log", "gaussian", or a model
        of your own.
    faces : str
        Which three tactors "inverse-distance" takes: those whose triangle holds the point ("delaunay", default), or the closest three
        of all ("nearest", Park et al. 2016 to the letter); a warning counts the bursts that their triangle misses.
    soa : float
        Onset to onset of two bursts, s (0.07).
    burst : float
        Duration of each burst, s; default: what the timing law gives for the SOA.
    slope, intercept : float
        The timing law SOA = slope duration + intercept (0.32, 0.0473 s; Israr and Poupyrev 2011).
    duration : float
        Time of the stroke, s, instead of its own.
    speed : float
        mm/s, instead of a time.
    timing : str
        SOA as given ("fixed"), or fitted to end with the path ("fit").
    min_duration : float
        Shortest burst that `timing="fit"` may use, s (0.02).
    outside : str
        Paths that leave the array: "error", or "clamp" to its edge.
    fit : bool
        Scale and centre what is drawn on the array.
    fit_margin : float
        Distance kept from the array's edge with `fit`, mm.
    snap : bool
        "tactile-brush": move a start or end onto the grid.
    drop_points : bool
        "tactile-brush": leave crossings out until the timing is possible.
    overlap : str
        Bursts that overlap on one tactor: "energy", "max" or "sum".
    carrier : float
        Frequency of the vibration, Hz (250).
    compensate : str
        "low-speed": moves bursts so that an observer who expects low speeds feels the target (Goldreich 2007).
    sigma_mm, sigma_v_mm_s : float
        That observer: how well places are known (5 mm), and which speeds are expected (100 mm/s).
    waveform : str
        What vibrates: "sine" (default), "square", "triangle", "sawtooth", "noise:LO-HI" or the name of a WAV file.
    am : float or str
        Amplitude modulation: Hz, or "HZ:DEPTH".
    noise_seed : int
        Which noise (1).
    texture : str
        Samples of a WAV file as the carrier's "cycle" (default), in their own "time", or along the path by its "length".
    texture_mm : float
        With "length": so much of the path has all samples, mm; 0 (default): all of it.
    intensity_scale : str
        What an intensity of one half is: half of the amplitude ("linear", default), of the sensation level `sl` ("sl"), or half as
        strong as it is felt ("stevens").
    stevens_exponent : float
        felt = amplitude^exponent (0.6, at 250 Hz on the finger; 0.95 at 60 Hz: Stevens 1968).
    phase, ramp, envelope, attack, release, tukey_part, level_dbfs, sl, rate
        How it is to sound: what a `Score` of it has where it says nothing else.

    Returns
    -------
    Plan

    Raises
    ------
    InputError
        SOA out of bounds, a path outside the array, timing that cannot be done, no grid for the Tactile Brush.
    """
    options = dict(locals())
    del options["array"], options["stroke"]
    _need(array, Array, "array")
    _need(stroke, Stroke, "stroke")
    options = settled(array, options, _PLANNING_AND_SOUNDING)
    asked = {name: options[name] for name in _SOUNDING if options.get(name) is not None}
    return Plan._of(_tactor.Plan(array._core, stroke._core, options), array, asked=asked)


def burst_duration(*, soa: float | None = None, burst: float | None = None, slope: float | None = None,
                   intercept: float | None = None) -> float:
    """Duration of park2016's bursts in seconds: `burst`, or what the timing law gives for the SOA.

    Raises
    ------
    InputError
        For an SOA out of bounds.
    """
    return _tactor.burst_duration(dict(soa=soa, burst=burst, slope=slope, intercept=intercept))  # type: ignore[no-any-return]
