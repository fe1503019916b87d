# SPDX-License-Identifier: MIT
"""Calls that take options. Written from the table of options by src/options/write.py: change it there."""
from __future__ import annotations

import typing as _t

if _t.TYPE_CHECKING:
    import os
    from tactor._array import Array
    from tactor._parts import PhantomModel
    from tactor._plan import Plan
    from tactor._score import _Plans
    from tactor._stroke import Stroke
    from tactor._ticket import LiveStroke, _LogKind
    from tactor._tool import Comparison
    _Outside = _t.Literal["error", "clamp"]
    _Algorithm = _t.Literal["park2016", "tactile-brush", "continuous"]
    _Phantom = _t.Literal["inverse-distance", "barycentric", "linear", "log", "gaussian"]
    _Faces = _t.Literal["delaunay", "nearest"]
    _Timing = _t.Literal["fixed", "fit"]
    _Overlap = _t.Literal["energy", "max", "sum"]
    _Compensate = _t.Literal["none", "low-speed"]
    _Texture = _t.Literal["cycle", "time", "length"]
    _Phase = _t.Literal["stroke", "burst"]
    _IntensityScale = _t.Literal["linear", "sl", "stevens"]
    _SampleFormat = _t.Literal["float", "s16", "s24", "s24-4", "s32"]
    _Observer = _t.Literal["centroid", "low-speed"]


def plan(array: Array, stroke: Stroke, *, duration: float | None = None, speed: float | None = None, outside: _Outside | None = None,
         fit: bool | None = None, fit_margin: float | None = None, algorithm: _Algorithm | None = None,
         phantom: _t.Union[_Phantom, PhantomModel, None] = None, faces: _Faces | None = None, soa: float | None = None, burst: float | None = None,
         slope: float | None = None, intercept: float | None = None, timing: _Timing | None = None, min_duration: float | None = None,
         snap: bool | None = None, drop_points: bool | None = None, overlap: _Overlap | None = None, compensate: _Compensate | None = None,
         sigma_mm: float | None = None, sigma_v_mm_s: float | None = None, carrier: float | None = None, waveform: str | None = None,
         am: _t.Union[float, str, None] = None, noise_seed: int | None = None, texture: _Texture | None = None, texture_mm: float | None = None,
         phase: _Phase | None = None, ramp: float | None = None, envelope: str | None = None, attack: float | None = None,
         release: float | None = None, tukey_part: float | None = None, level_dbfs: float | None = None, sl: float | None = None,
         intensity_scale: _IntensityScale | None = None, stevens_exponent: float | None = None, rate: int | None = None) -> Plan:
    """Plans a stroke on an array. Options are the tool's, see tactor-options(7); None is its default.

    Parameters
    ----------
    array : Array
    stroke : Stroke
    duration : float
        Duration of each stroke (default: the file's or preset's). 0.001 to 86400 s.
    speed : float
        Speed of each stroke, in place of its duration (default 60 where nothing gives one). 0.001 to 100000 mm/s.
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
        Time from the onset of a burst to the onset of the next (default 0.07). Above 0.0473 to 0.07 s by the usual timing law; see burst for
        others.
    burst : float
        Duration of each burst (default: from the SOA by the timing law). 0.0001 to 10 s.
    slope : float
        Slope of the timing law SOA = A duration + S (default 0.32). 0.01 to 0.99.
    intercept : float
        Intercept of the timing law (default 0.0473). 0.001 to 10 s.
    timing : str
        Keep the SOA, or fit it so that the bursts end with the path (default fixed). One of "fixed", "fit".
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
        low-speed: spread of the speeds that are expected (default 100). 0.001 to 1000000 mm/s.
    carrier : float
        Frequency of the vibration (default 250). 1 to 384000 Hz.
    waveform : str
        Shape at the carrier's frequency, noise between two frequencies, or recording (default sine). As
        "sine|square|triangle|sawtooth|noise:LO-HI|FILE.wav".
    am : float or str
        Amplitude modulation, depth 0 to 1 (default: none; depth 1). As "HZ[:DEPTH]".
    noise_seed : int
        noise: seed of its samples (default 1). 0 to 9007199254740992.
    texture : str
        FILE.wav: play it as the carrier's cycle (default), in its own time, or along the path. One of "cycle", "time", "length".
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
        Time in which each burst falls (default: the time in which it rises). 0 to 10 s.
    tukey_part : float
        envelope tukey: part of the burst in which it rises and falls (default 0.5). 0 to 1.
    level_dbfs : float
        Peak of the carrier at intensity 1 (default -12). -200 to 0 dBFS.
    sl : float
        Level above each tactor's threshold, in place of dBFS. -60 to 100 dB SL.
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
    from tactor._plan import make_plan
    return make_plan(given)


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
    """What algorithms are predicted to feel like on the same stroke: a model, never a measurement.

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
        Model that predicts what is felt (default centroid). One of "centroid", "low-speed".
    spread : int
        Show what this many people would feel, drawn at random. 2 to 100000.
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
        A list of dicts. An algorithm that cannot play the stroke says why under "refused".

    Raises
    ------
    InputError
        Where none can play it.
    """
    given = dict(locals())
    from tactor._tool import make_comparison
    return make_comparison(given)


class ScoreCall:
    """The call that makes a score."""

    __slots__ = ()

    def __init__(self, array: Array, plans: _Plans, *, phase: _Phase | None = None, ramp: float | None = None, envelope: str | None = None,
                 attack: float | None = None, release: float | None = None, tukey_part: float | None = None, level_dbfs: float | None = None,
                 sl: float | None = None, rate: int | None = None, channels: int | None = None, marker_channel: int | None = None,
                 marker_s: float | None = None, power_dbfs: float | None = None, max_drive_s: float | None = None, drive_window_s: float | None = None) -> None:
        """Makes a score.

        Parameters
        ----------
        array : Array
        plans : Plan, or iterable of Plan or of (float, Plan)
            A number is the start in seconds; a plan without one starts at its stroke's, or when the plan before it has ended.
        phase, ramp, envelope, attack, release, tukey_part, level_dbfs, sl, rate
            As in `plan`.
        channels : int
            Channels of the stream (default: the configuration's, else what the array needs). 1 to 1024 channels.
        marker_channel : int
            Spare channel that marks each stroke's first frames. 0 to 1023.
        marker_s : float
            Duration of the mark (default 0.005). 0.000001 to 10 s.
        power_dbfs : float
            Limit on the power of all tactors together, above one channel's full scale (default 4.77). -120 to 60 dB.
        max_drive_s : float
            Longest drive of one tactor without a rest (default 5). 0.1 to 3600 s.
        drive_window_s : float
            Time of which a tactor may be driven for max_drive_s in the long run (default 10). 0.1 to 3600 s.

        Without any limit on power and drive time the piece is as it was designed: a player has its own.
        """
        given = dict(locals())
        del given["self"]
        self._make(given)

    def _make(self, given: dict[str, _t.Any]) -> None:
        raise NotImplementedError


class PlayerCalls:
    """The calls that open a player and begin a live stroke."""

    __slots__ = ()

    def __init__(self, device: str, array: Array, *, rate: int | None = None, sample_format: _SampleFormat | None = None,
                 channels: int | None = None, no_gpio: bool | None = None, power_dbfs: float | None = None, max_drive_s: float | None = None,
                 drive_window_s: float | None = None, latency: float | None = None, period_frames: int | None = None, periods: int | None = None,
                 require_realtime: bool | None = None, sync_delay: float | None = None, config: _t.Union[str, os.PathLike[str], None] = None,
                 log: _t.Callable[[_LogKind, str], object] | None = None, keep_drive_time: bool = True) -> None:
        """Opens a device.

        Parameters
        ----------
        device : str
            An ALSA name as `tactor play -D` takes it: "hw:CARD=Tactor", "null", "file:...".
        array : Array
            Gives each channel's limit; one from a file brings what that says of amplifier, lines and limits.
        config : path-like, optional
            Configuration; default: the tool's ($TACTOR_CONFIG, the user's, the system's), amplifier and limits included. os.devnull: none.
        log : callable, optional
            `log(kind, text)` is told of xruns, recovery, mutes and limits that act, in the player's thread of Python.
        keep_drive_time : bool
            What earlier players and runs of this user drove on this device counts, and what this one drives counts for later ones. False: it
            begins with 0, and is not kept.
        rate
            As in `plan`.
        sample_format : str
            Format of the samples (render: float; play: the device's). One of "float", "s16", "s24", "s24-4", "s32".
        channels : int
            Channels of the stream (default: the configuration's, else what the array needs). 1 to 1024 channels.
        no_gpio : bool
            Leave the lines of [amplifier] and [sync] alone.
        power_dbfs : float
            Limit on the power of all tactors together, above one channel's full scale (default 4.77). -120 to 60 dB.
        max_drive_s : float
            Longest drive of one tactor without a rest (default 5). 0.1 to 3600 s.
        drive_window_s : float
            Time of which a tactor may be driven for max_drive_s in the long run (default 10). 0.1 to 3600 s.
        latency : float
            Length of the device's buffer (periods x period). 0.0001 to 10 s.
        period_frames : int
            Frames in a period, in place of latency_ms (default: the configuration's, else 96). 1 to 1048576 frames.
        periods : int
            Periods in the buffer (default: the configuration's, else 3). 2 to 1024 periods.
        require_realtime : bool
            Fail without real-time priority and locked memory.
        sync_delay : float
            Time from the edge to the stroke's first sample at the DAC (default 0.05). 0 to 10 s.
        """
        given = dict(locals())
        del given["self"]
        self._open(given)

    def _open(self, given: dict[str, _t.Any]) -> None:
        raise NotImplementedError

    def live(self, *, outside: _Outside | None = None, algorithm: _Algorithm | None = None,
             phantom: _t.Union[_Phantom, PhantomModel, None] = None, faces: _Faces | None = None, soa: float | None = None,
             burst: float | None = None, slope: float | None = None, intercept: float | None = None, carrier: float | None = None,
             waveform: str | None = None, am: _t.Union[float, str, None] = None, noise_seed: int | None = None,
             texture: _Texture | None = None, phase: _Phase | None = None, ramp: float | None = None, envelope: str | None = None,
             attack: float | None = None, release: float | None = None, tukey_part: float | None = None, level_dbfs: float | None = None,
             sl: float | None = None, intensity_scale: _IntensityScale | None = None, stevens_exponent: float | None = None,
             timeout: float = 0.5, longest: float | None = None, smooth: float = 0.0, intensity_max: float | None = None) -> LiveStroke:
        """Begins a stroke that is fed point by point; silent until the first.

        Parameters
        ----------
        timeout : float
            A producer that gives no point for so long, s, has failed: it fades out, interrupted.
        longest : float
            A stroke that has sounded for so long, s, fades out, interrupted; None: it may go on for ever.
        smooth : float
            For points that come in bursts, s, 0 (off) to 1: it moves evenly, and is at each point so long after that came.
        intensity_max : float
            The intensity of a point that means 1, 0.001 to 1e6; 255 for a sensor of 8 bits. None: as the file says, else 1.
        outside, algorithm, phantom, faces, soa, burst, slope, intercept, carrier, waveform, am, noise_seed, texture, phase, ramp, envelope, attack
            As in `plan`.
        release, tukey_part, level_dbfs, sl, intensity_scale, stevens_exponent
            As in `plan`.

        What nobody says is as the array's file says; but `algorithm` is "continuous", and `outside` "clamp".

        Returns
        -------
        LiveStroke

        Raises
        ------
        InputError
            For options that cannot be.
        StreamError
            When the stream has ended.
        """
        given = dict(locals())
        del given["self"]
        return self._begin(given)

    def _begin(self, given: dict[str, _t.Any]) -> LiveStroke:
        raise NotImplementedError
