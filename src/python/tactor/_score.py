# SPDX-License-Identifier: MIT
"""Scores: plans as frames and channels."""
from __future__ import annotations

import collections.abc as _abc
import functools
import hashlib
import os
import typing as _t

from tactor import _tactor
from tactor._array import Array
from tactor._checks import _are_plain, _counted, _Member, _need, _number, reading, _Value, _whole
from tactor._errors import InputError
from tactor._plan import Plan

if _t.TYPE_CHECKING:
    import numpy as _np
    from numpy.typing import ArrayLike as _ArrayLike, DTypeLike as _DTypeLike, NDArray as _NDArray
    from tactor._plan import _Phase, _Together
    _WavFormat = _t.Literal["float", "s16", "s24", "s32"]
    _Plans = _t.Union[Plan, _t.Iterable[_t.Union[Plan, "tuple[float | None, Plan]"]]]


_FORMATS = {"<f4": "float", "<i2": "s16", "<i4": "s32"}  # by dtype.str


def _find_type(dtype: _DTypeLike) -> _np.dtype[_t.Any]:
    """Returns a type of samples that can be rendered."""
    import numpy as np
    try:
        found = np.dtype(dtype)
        if found.str in _FORMATS:
            return found
    except TypeError:
        pass
    raise InputError("dtype", f"{dtype!r} is unknown", 'use one of "float32", "int16", "int32"', field="dtype")


def _find_frames(samples: _ArrayLike) -> _NDArray[_t.Any]:
    """Returns the caller's samples as frames of a type that can be rendered, in C order."""
    import numpy as np
    raw: _t.Any = samples if isinstance(samples, np.ma.MaskedArray) else np.asarray(samples)
    if raw.ndim == 1:
        raw = raw[:, np.newaxis]
    wanted = np.dtype("float32") if raw.dtype == np.float64 else raw.dtype.newbyteorder("<")
    if raw.ndim != 2 or not raw.shape[1] or wanted.str not in _FORMATS or not _are_plain(raw):
        raise InputError("samples", f"an array of shape {raw.shape} and type {raw.dtype} has no samples to play",
                         "give one of shape (frames, channels), of float32 (full scale is 1), float64, int16 or int32", field="samples")
    with np.errstate(over="ignore"):  # it is refused as not finite
        return np.ascontiguousarray(raw, dtype=wanted)


def placed(plans: _Plans) -> list[tuple[float | None, Plan]]:
    """Returns plans with the times at which they start."""
    if isinstance(plans, Plan):
        return [(plans.start, plans)]
    if not isinstance(plans, _abc.Iterable):
        raise TypeError(f"plans: it must be a Plan or several, not {type(plans).__name__}")
    all_of_them = []
    for p in plans:
        pair = (p.start, p) if isinstance(p, Plan) else p
        if not (isinstance(pair, tuple) and len(pair) == 2 and isinstance(pair[1], Plan)):
            raise TypeError(f"plans: it must have plans or (start_s, plan), not {p!r}")
        all_of_them.append((None if pair[0] is None else _number("start", pair[0]), pair[1]))
    return all_of_them


class Score(_Value):
    """Plans at a sample rate and at levels: what can be rendered, written and played. Immutable.

    Raises
    ------
    InputError
        A carrier at or above half the rate, a level that a tactor may not have, too few channels, plans for another array, plans that
        differ in rate, phase, envelope or ramp, or of which only some have a level in dB SL.

    Notes
    -----
    Each plan keeps the level that it was made with, unless one is given here. Of all else that nobody gives here the plans must agree;
    what they do not say is as the array's file says.

    Two scores are equal, and hash alike, where the same samples are made in the same way: levels, phase, envelope, ramps and rate count,
    names do not.
    """

    __slots__ = ("_core", "_array", "_plans", "_options", "_recipe", "_own")

    _own: str | None  # type of samples of one's own; None: there are plans

    def __init__(self, array: Array, plans: _Plans, *, phase: _Phase | None = None, ramp: float | None = None, envelope: str | None = None,
                 attack: float | None = None, release: float | None = None, tukey_part: float | None = None, level_dbfs: float | None = None,
                 sl: float | None = None, together: _Together | None = None, rate: int | None = None, channels: int | None = None,
                 marker_channel: int | None = None, marker_s: float | None = None, power_dbfs: float | None = None, max_drive_s: float | None = None,
                 drive_window_s: float | None = None) -> None:
        """Makes a score.

        Parameters
        ----------
        array : Array
        plans : Plan, or iterable of Plan or of (float, Plan)
            A number is the start in seconds; a plan without one starts at its stroke's, or when the plan before it has ended.
        phase, ramp, envelope, attack, release, tukey_part, level_dbfs, sl, together, rate
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
            Longest time that one tactor vibrates without a rest (default 5). 0.1 to 3600 s.
        drive_window_s : float
            Period in which a tactor may vibrate for max_drive_s in the long run (default 10). 0.1 to 3600 s.

        Without any limit on power and drive time the piece is as it was designed: a player has its own.
        """
        given = dict(locals())
        del given["self"], given["array"], given["plans"]
        _need(array, Array, "array")
        self._array = array
        self._plans = tuple(placed(plans))
        self._options = given
        self._own = None
        self._core, self._recipe = _tactor.make_score(
            array._core, [(start, p._core, *p._place_on(array)) for start, p in self._plans], given)

    @classmethod
    def from_samples(cls, array: Array, samples: _ArrayLike, rate: int = 48000, *, level_dbfs: float | None = None,
                     marker_channel: int | None = None, marker_s: float | None = None) -> Score:
        """Makes a score of your own samples, which play exactly as they are.

        Parameters
        ----------
        array : Array
        samples : array_like, shape (frames, channels)
            Column i is for channel i of the stream; there is one for each of its channels. float32 (full scale is 1), int16 or int32;
            float64 becomes float32. At most 1 GB.
        rate : int
            Hz, that of the stream; nothing is resampled.
        level_dbfs : float
            Highest peak that a tactor may have, below its max_dbfs; louder samples are refused, never scaled (default: as for plans). At most 0 dBFS.
        marker_channel, marker_s
            As for a score of plans.

        Returns
        -------
        Score
            Without plans. gain_db, polarity and rise_s of the tactors have no effect on the samples; limits do. A channel without a
            tactor plays, too, up to full scale.

        Raises
        ------
        InputError
            For samples that are too loud, with the decibels, are not finite, or do not fit the array, and for a level in dB SL.
        """
        given = {"rate": rate, "level_dbfs": level_dbfs, "marker_channel": marker_channel, "marker_s": marker_s}
        return cls._make_own(array, _find_frames(samples), given)

    @classmethod
    def _make_own(cls, array: Array, frames: _NDArray[_t.Any], given: dict[str, _t.Any], stream_channels: int = 0) -> Score:
        _need(array, Array, "array")
        made = cls.__new__(cls)
        made._array = array
        made._plans = ()
        made._options = given
        made._own = frames.dtype.str
        channels = frames.shape[1]
        needed = max(t.channel for t in array.tactors) + 1
        options = {"channels": stream_channels or max(channels, needed), **given}
        made._core, made._recipe = _tactor.make_own_score(array._core, frames, channels, _FORMATS[made._own], options, array._settings())
        return made

    def _moved(self, array: Array) -> Score:
        """Returns a score of the same samples for another array."""
        return Score._make_own(array, self.render(_t.cast(str, self._own)), self._options)

    @property
    def array(self) -> Array:
        """The array of the score."""
        return self._array

    @property
    def plans(self) -> tuple[Plan, ...]:
        """The plans, in the order given; empty for a score of your own samples."""
        return tuple(p for _, p in self._plans)

    frames: _Member[int] = _Member("frames", "Length.")
    channels: _Member[int] = _Member("channels", "Samples of a frame.")
    rate: _Member[int] = _Member("rate", "Hz.")

    @property
    def duration(self) -> float:
        """Length, s."""
        return self.frames / self.rate

    starts: _Member[list[int]] = _Member("starts", "First frame of each plan.")
    weakened_db: _Member[float] = _Member("weakened_db", "How much weaker than asked for all of it is, so that no tactor exceeds the level, dB; 0 or less.")

    @property
    def meets(self) -> dict[str, _t.Any] | None:
        """Place where it would be loudest, with "tactor", "at" (s) and "plans" (numbers of those that sound there); None where it is not weakened."""
        return _t.cast("dict[str, _t.Any] | None", self._core.meets)

    def render(self, dtype: _DTypeLike = "float32", *, start: int = 0, frames: int | None = None,
               out: _NDArray[_t.Any] | None = None) -> _NDArray[_t.Any]:
        """Renders the samples, the same as `tactor render` writes.

        Parameters
        ----------
        dtype : data-type
            "float32" (full scale is 1.0), "int16" or "int32".
        start : int
            First frame, from 0. What is before it is computed, too, and dropped; `blocks` goes through a long score faster.
        frames : int, optional
            How many; default: to the end. After the end there is silence.
        out : ndarray, shape (frames, channels), optional
            Is filled and returned, in place of a new array; of that type, and contiguous in C's order.

        Returns
        -------
        ndarray, shape (frames, channels)

        Raises
        ------
        InputError
            For another type, and for an array that does not fit.
        """
        sample_type = _find_type(dtype if out is None else out.dtype)
        first = _whole("start", start, 0, 1 << 62)
        count = max(self.frames - first, 0) if frames is None and out is None else \
            len(_t.cast(_t.Any, out)) if frames is None else _whole("frames", frames, 0, 1 << 40)
        if out is None:
            import numpy as np
            out = np.empty((count, self.channels), sample_type)
        elif out.shape != (count, self.channels) or not out.flags.c_contiguous or not out.flags.writeable:
            raise InputError("out", f"an array of shape {out.shape} does not fit",
                             f"give one of shape ({count}, {self.channels}) that is writable, in C's order", field="out")
        renderer = _tactor.Renderer(self._core, _FORMATS[sample_type.str])
        renderer.skip(min(first, self.frames))
        renderer.into(out)
        return out

    def blocks(self, frames: int, dtype: _DTypeLike = "float32") -> _t.Iterator[_NDArray[_t.Any]]:
        """Renders the samples block by block, so that a long score need not be in memory.

        Parameters
        ----------
        frames : int
            Of each block, 1 to 16777216; the last one may be shorter.
        dtype : data-type
            As in `render`.

        Yields
        ------
        ndarray, shape (frames, channels)
            A new one each time.

        Raises
        ------
        InputError
            For another type or number.
        """
        return self._blocks(_find_type(dtype), _whole("frames", frames, 1, 1 << 24))

    def _blocks(self, sample_type: _np.dtype[_t.Any], frames: int) -> _t.Iterator[_NDArray[_t.Any]]:
        import numpy as np
        renderer = _tactor.Renderer(self._core, _FORMATS[sample_type.str])
        for first in range(0, self.frames, frames):
            block = np.empty((min(frames, self.frames - first), self.channels), sample_type)
            renderer.into(block)
            yield block

    def to_numpy(self) -> _NDArray[_np.float32]:
        """Does the same as `render()`."""
        return self.render()

    def write(self, file: str | os.PathLike[str], sample_format: _WavFormat = "float", force: bool = False) -> None:
        """Writes a WAV file, one channel per tactor, the same bytes as `tactor render` does.

        Complete or not at all. A comment after the samples has a SHA-256: without `force` a file is replaced only as tactor wrote it.

        Raises
        ------
        InputError
            For a folder that does not exist, a file that was read as input, and one that `force` would replace.
        StreamError
            For what the file system refuses.
        """
        with reading(file) as name:
            _need(sample_format, str, "sample_format")
            self._core.write(name, sample_format, bool(force))

    def __len__(self) -> int:
        return self.frames

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Score):
            return NotImplemented
        return self._sounds() == other._sounds() and all(
            a._core.sounds_like(b._core) for a, b in zip(self.plans, other.plans))

    def __hash__(self) -> int:
        return hash((self._sounds(), tuple((p.carrier, p.amplitudes.tobytes()) for p in self.plans)))

    def _sounds(self) -> tuple[_t.Any, ...]:
        """Returns everything that decides the samples, except the plans' bursts and curves."""
        return self._array.tactors, tuple(self.starts), self.frames, self._recipe, self._hash_samples()

    def _hash_samples(self) -> bytes | None:
        if self._own is None:
            return None
        digest = hashlib.sha256()
        for block in self.blocks(1 << 16, self._own):
            digest.update(block.tobytes())
        return digest.digest()

    def __repr__(self) -> str:
        held = _counted(len(self._plans), "plan") if self._own is None else "samples"
        return (f"<tactor.Score: {held}, {_counted(self.channels, 'channel')}, {self.rate} Hz, "
                f"{self.duration:.6g} s>")

    def __reduce__(self) -> tuple[_t.Callable[..., _t.Any], tuple[_t.Any, ...]]:
        if self._own is not None:
            return Score._make_own, (self._array, self.render(self._own), self._options)
        return functools.partial(Score, **self._options), (self._array, self._plans)
