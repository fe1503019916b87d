# SPDX-License-Identifier: MIT
"""Options of a plan and of its sound."""
from __future__ import annotations

import typing as _t

from tactor import _tactor
from tactor._array import Array
from tactor._errors import InputError

# Options that plan a stroke, and those of its sound, which are a score's.
_PLANNING = frozenset(_tactor.option_names("planning"))
_SOUNDING = frozenset(_tactor.option_names("sounding"))
_PLANNING_AND_SOUNDING = _PLANNING | _SOUNDING
# A live stroke's; which algorithm, and what is done outside, no file says of it, as in the tool.
_LIVE = frozenset(_tactor.option_names("live")) - {"algorithm", "outside"}


_NOTHING: _t.Mapping[str, _t.Any] = {}


def settled(array: Array, given: dict[str, _t.Any], known: frozenset[str], before: _t.Mapping[str, _t.Any] = _NOTHING) -> dict[str, _t.Any]:
    """Completes options with the [defaults] and [output] of the array's file, as the tool does.

    None sets nothing. Refuses options that nothing uses; in a file they may be for other strokes. `before`: options of a plan.
    """
    given = in_parts(given)
    setup = array._settings()
    options = given if setup is None else _completed(setup, given, known)
    check_used(given, {**before, **{name: value for name, value in options.items() if value is not None}}, "compare" if "observer" in known else "plan")
    return options


def in_parts(given: dict[str, _t.Any]) -> dict[str, _t.Any]:
    """Splits the tool's envelope "tukey:PART" into its two options."""
    envelope = given.get("envelope")
    if not isinstance(envelope, str) or not envelope.startswith("tukey:"):
        return given
    if given.get("tukey_part") is not None:
        raise InputError("envelope", f'there are "{envelope}" and tukey_part', "give the part once", field="envelope")
    try:
        return {**given, "envelope": "tukey", "tukey_part": float(envelope[len("tukey:"):])}
    except ValueError:
        raise InputError("envelope", f'"{envelope}" is not known', "tukey:PART, such as tukey:0.3", field="envelope") from None


def check_used(given: dict[str, _t.Any], options: dict[str, _t.Any], place: str = "plan") -> None:
    """Refuses given options that nothing uses. `options`: all that are set; `place`: the function that has them, "plan" or "compare"."""
    _tactor.check_used([name for name, value in given.items() if value is not None], options, place)


def _completed(setup: _t.Any, given: dict[str, _t.Any], known: frozenset[str]) -> dict[str, _t.Any]:
    options = dict(given)

    def says(name: str) -> bool:
        return options.get(name) is not None

    for name, value in setup.defaults.items():
        rival = {"speed": "duration", "sl": "level_dbfs", "level_dbfs": "sl"}.get(name)
        if name in known and not says(name) and not (rival is not None and given.get(rival) is not None):
            # A stroke's own speed comes before a file's.
            options["usual_speed" if name == "speed" else name] = value
    kind, _, part = str(options.get("envelope") or "").partition(":")
    if part and given.get("envelope") is None:  # tukey:PART, as the tool takes it
        options["envelope"] = kind
        if not says("tukey_part"):
            options["tukey_part"] = float(part)
    if "rate" in known:
        if setup.rate is not None and not says("rate"):
            options["rate"] = setup.rate
        if setup.channels is not None and not says("channels"):
            options["channels"] = setup.channels
        if setup.marker is not None and not says("marker_channel"):
            options["marker_channel"], pulse_s = setup.marker
            options["marker_s"] = given["marker_s"] if given.get("marker_s") is not None else pulse_s
    return options
