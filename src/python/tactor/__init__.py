# SPDX-License-Identifier: MIT
"""Draws on skin: moving tactile strokes over sparse arrays of vibrating actuators::

    palm = tactor.Array.preset("palm-3x3")
    stroke = tactor.Stroke.along(tactor.Path.svg("M 0 10 C 20 -5 20 45 40 30"), duration=1.2)
    score = tactor.Score(palm, tactor.plan(palm, stroke))
    score.write("curve.wav")

Times are seconds, lengths mm, angles degrees, levels dB.
"""
import typing as _t

from tactor import _tactor
from tactor._array import Array, PerceptMap, Point, Tactor, array_presets
from tactor._errors import DeviceError, Error, InputError, StreamError
from tactor._plan import Burst, Conflict, Curve, Drive, Meeting, Percept, PerceptSample, PhantomModel, Plan, burst_duration, load_plan, plan
from tactor._score import Score
from tactor._stroke import Fitting, Path, Stroke, apply_fits, fit_strokes, load, parse, save, stroke_presets, stroke_shapes

if _t.TYPE_CHECKING:
    from tactor import lsl as lsl, study as study
    from tactor._client import Client, RemoteLive, RemoteStroke, Reply
    from tactor._player import Player, play
    from tactor._ticket import Delay, LiveStroke, Report, Ticket
    from tactor._tool import Comparison, compare, devices, plot

__version__: str = _tactor.version()

__all__ = [
    "Array", "Burst", "Client", "Comparison", "Conflict", "Curve", "Delay", "DeviceError", "Drive", "Error", "Fitting", "InputError", "LiveStroke",
    "Meeting", "Path", "Percept", "PerceptMap", "PerceptSample", "PhantomModel", "Plan", "Player", "Point", "RemoteLive",
    "RemoteStroke", "Reply", "Report", "Score", "StreamError", "Stroke", "Tactor", "Ticket",
    "array_presets", "build_facts", "burst_duration", "compare", "devices", "apply_fits", "fit_strokes", "load", "load_plan", "parse", "plan", "play", "plot",
    "save", "stroke_presets", "stroke_shapes",
]


def build_facts() -> str:
    """Returns the build facts of the library, for bug reports."""
    return _tactor.build_facts()  # type: ignore[no-any-return]


# Names that few scripts need. They are loaded on first use, which saves a fifth of the import's time.
_LATER = {
    "Client": "_client", "RemoteLive": "_client", "RemoteStroke": "_client", "Reply": "_client", "Player": "_player", "play": "_player", "Delay": "_ticket", "LiveStroke": "_ticket", "Report": "_ticket", "Ticket": "_ticket",
    "Comparison": "_tool", "compare": "_tool", "devices": "_tool", "plot": "_tool",
}


def __getattr__(name: str) -> _t.Any:
    import importlib
    if name in ("lsl", "study"):
        return importlib.import_module(f"tactor.{name}")
    if name not in _LATER:
        raise AttributeError(f"module 'tactor' has no attribute {name!r}")
    value = getattr(importlib.import_module("tactor." + _LATER[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
