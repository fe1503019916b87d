# SPDX-License-Identifier: MIT
"""Playing on a device in real time."""
from __future__ import annotations

import atexit
import os
import threading
import time
import typing as _t
import warnings
import weakref

from tactor import _tactor
from tactor._array import Array
from tactor._checks import encoded, _need, _number, _Unique, _whole
from tactor._errors import InputError
from tactor._plan import Plan, plan
from tactor._score import _find_frames, Score
from tactor._ticket import LiveStroke, Report, Ticket, _call, _Held, _Shared

if _t.TYPE_CHECKING:
    from types import TracebackType as _TracebackType
    from numpy.typing import NDArray as _NDArray
    from tactor._plan import _Algorithm, _Faces, _IntensityScale, _Outside, _Phantom, _Phase, _SampleFormat, _Texture, PhantomModel
    from tactor._stroke import Stroke
    from tactor._ticket import _LogKind
    _At = _t.Literal["now", "armed"]


_LATEST_S = 8e9  # of a clock that counts nanoseconds in 64 bits
_CLOCK = "give seconds as time.monotonic() gives them"


class Player(_Unique):
    """Plays scores on a device in real time.

    Raises
    ------
    DeviceError
        When the device is missing, busy or cannot do what is asked.
    InputError
        For numbers that cannot be.

    Notes
    -----
    The interpreter's lock is released in all calls, and no thread that plays ever takes it. A player that is forgotten is closed when it is
    collected or the program ends. In a process that was forked every call raises `StreamError`, and its end leaves stream and amplifier alone.
    """

    def __init__(self, device: str, array: Array, *, rate: int | None = None, sample_format: _SampleFormat | None = None,
                 channels: int | None = None, no_gpio: bool | None = None, no_desktop: bool | None = None, power_dbfs: float | None = None,
                 max_drive_s: float | None = None, drive_window_s: float | None = None, latency: float | None = None,
                 period_frames: int | None = None, periods: int | None = None, require_realtime: bool | None = None, sync_delay: float | None = None,
                 config: _t.Union[str, os.PathLike[str], None] = None, log: _t.Callable[[_LogKind, str], object] | None = None,
                 keep_drive_time: bool = True) -> None:
        """Opens a device.

        Parameters
        ----------
        device : str
            An ALSA name as `tactor play -D` takes it: "hw:CARD=Tactor", "null", "file:...".
        array : Array
            Gives each channel's limit; one from a file brings what that says of amplifier, lines and limits. A preset is the
            configuration's array where that has its places: `array` is then that one.
        config : path-like, optional
            Configuration; default: the tool's ($TACTOR_CONFIG, the user's, the system's), amplifier and limits included. os.devnull: none.
        log : callable, optional
            `log(kind, text)` is told of xruns, recovery, mutes and limits that act, in the player's thread of Python.
        keep_drive_time : bool
            What other players and runs of this user drive on this device counts, earlier ones and those that play now, and what this one drives
            counts for them. False: it begins with 0, and is not kept.
        rate
            As in `plan`.
        sample_format : str
            Format of the samples (render: float; play: the device's). One of "float", "s16", "s24", "s24-4", "s32".
        channels : int
            Channels of the stream (default: the configuration's, else what the array needs). 1 to 1024 channels.
        no_gpio : bool
            Do not use the lines of [amplifier] and [sync].
        no_desktop : bool
            Do not ask RealtimeKit for priority, a sound server for its card, or logind to delay the system's sleep until the
            amplifier is off.
        power_dbfs : float
            Limit on the power of all tactors together, above one channel's full scale (default 4.77). -120 to 60 dB.
        max_drive_s : float
            Longest time that one tactor vibrates without a rest (default 5). 0.1 to 3600 s.
        drive_window_s : float
            Period in which a tactor may vibrate for max_drive_s in the long run (default 10). 0.1 to 3600 s.
        latency : float
            Length of the device's buffer (periods x period). 0.0001 to 10 s.
        period_frames : int
            Frames in a period, instead of latency_ms (default: the configuration's, else 96). 1 to 1048576 frames.
        periods : int
            Periods in the buffer (default: the configuration's, else 3). 2 to 1024 periods.
        require_realtime : bool
            Fail without real-time priority and locked memory.
        sync_delay : float
            Time from the edge to the stroke's first sample at the DAC (default 0.05). 0 to 10 s.
        """
        given = dict(locals())
        for name in ("self", "device", "array", "config", "log", "keep_drive_time"):
            del given[name]
        _need(array, Array, "array")
        _need(device, str, "device")
        encoded(device, "device")
        if sample_format is not None:
            _need(sample_format, str, "sample_format")
        _need(keep_drive_time, bool, "keep_drive_time")
        for name, least, hint in (("latency", 0.0001, "use 0.0001 to 10 s"), ("sync_delay", 0.0, "use 0 to 10 s")):
            value = given.pop(name)
            given[f"{name}_ms"] = None if value is None else 1e3 * _number(name, value, least, 10.0, hint)
        files = None if config is None else encoded(config, "config"), None if array._file is None else encoded(array._file)
        core = _tactor.Player(array._core, device, given, *files, log is not None, keep_drive_time)
        self._setup: dict[str, _t.Any] = core.setup()
        self._given: Array = array
        self._array: Array = array if core.configured is None else Array._wrap(core.configured)
        for doubt in (core.doubt, core.drive_time_doubt()):
            if doubt:
                warnings.warn(doubt, stacklevel=2)
        self._held = _Held(log)
        self._shared = _Shared(core, self._held)
        _open.add(self)

    @property
    def array(self) -> Array:
        """The array that it plays on."""
        return self._array

    @property
    def setup(self) -> dict[str, _t.Any]:
        """The setup of the device (name, channels, device_channels, rate, format, period_frames, buffer_frames, batch, has_clock)."""
        return dict(self._setup)

    @property
    def rate(self) -> int:
        """Hz."""
        return self._setup["rate"]  # type: ignore[no-any-return]

    @property
    def channels(self) -> int:
        """Channels of the stream."""
        return self._setup["channels"]  # type: ignore[no-any-return]

    @property
    def closed(self) -> bool:
        """True once it was closed."""
        return self._get().core.closed  # type: ignore[no-any-return]

    def play(self, score: Score | _NDArray[_t.Any], at: _At = "now", *, at_s: float | None = None, delay: float | None = None,
             frame: int | None = None) -> Report:
        """Plays a score or samples and waits until they have ended; Ctrl-C fades them out. See `submit`."""
        return self.submit(score, at, at_s=at_s, delay=delay, frame=frame).wait()

    def submit(self, score: Score | _NDArray[_t.Any], at: _At = "now", *, at_s: float | None = None, delay: float | None = None,
               frame: int | None = None) -> Ticket:
        """Plays a score without waiting for it. Several may sound at once.

        Parameters
        ----------
        score : Score, or ndarray of shape (frames, channels)
            At the stream's rate; a score of plans for fewer channels gets as many as the stream has. An array has samples of one's own, as
            `Score.from_samples` takes them, at the usual level: one at another level is made by that.
        at : str
            "now": with the next period that is written; "armed": waits for an edge at the trigger's line or for `fire`.
        at_s : float, optional
            Time at which the first sample is to be at the DAC, s of CLOCK_MONOTONIC: `time.monotonic() + 0.5`.
        delay : float, optional
            The same, counted from this call.
        frame : int, optional
            Or the frame of the stream.

        Returns
        -------
        Ticket

        Raises
        ------
        InputError
            When rate or channels differ from the stream's.
        StreamError
            When the stream has ended.
        """
        shared = self._get()
        if hasattr(score, "__array_interface__"):
            score = Score._make_own(self._array, _find_frames(_t.cast(_t.Any, score)), {"rate": self.rate}, self.channels)
        if not isinstance(score, Score):
            raise TypeError(f"score: it must be a Score, not {type(score).__name__}")
        if not isinstance(at, str) or at not in ("now", "armed"):
            raise InputError("at", f"{at!r} is unknown", 'use "now", "armed", or at_s=, delay= or frame=', field="at")
        if frame is not None:
            frame = _whole("frame", frame, 0, (1 << 63) - 1, "give 0 or more")
        times = [t for t in (at_s, delay, frame) if t is not None]
        if len(times) > 1 or (times and at != "now"):
            raise InputError("at", "several starts are given", "give one of at, at_s, delay and frame", field="at")
        if at_s is not None:
            at_s = _number("at_s", at_s, -_LATEST_S, _LATEST_S, _CLOCK)
        elif delay is not None:
            at_s = time.monotonic() + _number("delay", delay, -_LATEST_S, _LATEST_S, "give seconds")
        if score._own is not None:
            if self._array is not self._given and score._array == self._given:
                score = score._moved(self._array)
        elif self._array is not self._given and score._array == self._given:
            plans = [(start, Plan._wrap(p._core.moved(self._array._core), self._array, p._recorded)) for start, p in score._plans]
            score = Score(self._array, plans, **score._options)
        if score._own is None and score.channels < self.channels and score.rate == self.rate:
            options: dict[str, _t.Any] = {**score._options, "channels": self.channels}
            score = Score(score._array, score._plans, **options)
        with shared.lock:
            number = shared.core.submit(score._core, at == "armed", at_s, frame)
            ticket = self._held.tickets[number] = Ticket(shared, number)
        return ticket

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
        for name in ("self", "timeout", "longest", "smooth", "intensity_max"):
            del given[name]
        shared = self._get()
        times = (_number("timeout", timeout, 0.001, 86400.0), None if longest is None else _number("longest", longest, 0.001, 86400.0),
                 _number("smooth", smooth, 0.0, 1.0), None if intensity_max is None else _number("intensity_max", intensity_max, 0.001, 1e6))
        with shared.lock:
            core = shared.core.live(self._array._core, given, *times, self._array._settings())
            stroke = LiveStroke(shared, core)
            self._held.tickets[stroke.id] = stroke
        return stroke

    def fire(self, at_s: float | None = None) -> int:
        """Starts all armed strokes, now or at a time of CLOCK_MONOTONIC; returns their number."""
        return self._get().core.fire(time.monotonic() if at_s is None else _number("at_s", at_s, -_LATEST_S, _LATEST_S, _CLOCK))  # type: ignore[no-any-return]

    def stop(self, *_: object) -> None:
        """Fades everything out and stops the stream. Strokes that this ends count as cancelled. Ignores its arguments, such as the event of a button."""
        self._get().core.stop()

    @property
    def ended(self) -> str | None:
        """The reason for the end of the stream; empty after `stop` or `close`, None while it goes on."""
        return self._get().core.ended()  # type: ignore[no-any-return]

    def stats(self) -> dict[str, _t.Any]:
        """Returns the counters since it was opened, after `close` those of the end: periods, frames, xruns, limited_frames, power_limited_frames, drives_cut, stalls, realtime, ..."""
        return self._get().core.stats()  # type: ignore[no-any-return]

    def position(self) -> dict[str, _t.Any]:
        """Returns the place in the stream: running, played (frame at the DAC), stroke (number of the newest that sounds, or None), stroke_frame."""
        return self._get().core.position()  # type: ignore[no-any-return]

    def close(self) -> None:
        """Stops, closes the device and leaves the amplifier off. All strokes have been reported then, and their callbacks called."""
        shared = self._get()
        held = self._held
        shared.held = lambda: held  # a player that is collected still gets the reports of its strokes
        with shared.closing:  # a second caller finds it closed
            shared.core.close()
        _open.discard(self)
        if threading.current_thread() is not shared.thread:
            shared.wait_reported()
            shared.held = weakref.ref(held)

    def _get(self) -> _Shared:
        self._shared.core.refuse_child()
        return self._shared

    def __enter__(self) -> Player:
        self._get()
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: _TracebackType | None) -> None:
        if not self._shared.core.forked:
            self.close()

    def __del__(self) -> None:
        shared = getattr(self, "_shared", None)
        if shared is None or shared.core.forked or shared.core.closed:
            return
        warnings.warn(f"unclosed {self!r}", ResourceWarning, source=self)
        self.close()

    def __repr__(self) -> str:
        s = self._setup
        of = f" of {s['device_channels']}" if s["device_channels"] > s["channels"] else ""
        return f"<tactor.Player {s['name']!r}: {s['channels']}{of} channels, {s['rate']} Hz, {s['format']}, {s['period_frames']} of {s['buffer_frames']} frames>"


_open: weakref.WeakSet[Player] = weakref.WeakSet()


@atexit.register
def _close_all() -> None:
    """Closes forgotten players, and switches their amplifiers off, while Python can still print."""
    for player in list(_open):
        if not player._shared.core.forked:
            _call(player.close)


def play(device: str, array: Array, stroke: Stroke, **options: _t.Any) -> Report:
    """Plays a stroke once and waits until it has ended; Ctrl-C fades it out. A script that plays more keeps a `Player`.

    Parameters
    ----------
    device : str
        An ALSA name, as `Player` takes it.
    array : Array
    stroke : Stroke
    options
        Keywords of `plan`: level_dbfs=-40, phantom="barycentric", ...

    Returns
    -------
    Report
        How it ended, and when it began.

    Raises
    ------
    InputError
        For options or a stroke that cannot be planned, and for a level that a tactor may not have.
    DeviceError
        When the device cannot be opened.
    """
    rate = options.get("rate")
    with Player(device, array, rate=rate) as player:
        return player.play(Score(player.array, plan(player.array, stroke, **options)))
