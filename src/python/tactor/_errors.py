# SPDX-License-Identifier: MIT
"""What goes wrong, as exceptions."""
from __future__ import annotations

import typing as _t

# The library speaks of its fields; here options have the names of the tool's.
_NAMES = {
    "soa_s": "soa", "burst_s": "burst", "carrier_hz": "carrier", "ramp_s": "ramp", "sl_db": "sl", "margin_mm": "fit_margin",
    "pitch_x_mm": "pitch_mm", "pitch_y_mm": "pitch_mm", "window_s": "drive_window_s", "rests": "pauses", "start_s": "start",
    "duration_s": "duration", "speed_mm_s": "speed", "timeout_s": "timeout", "longest_s": "longest", "smooth_s": "smooth", "at_ns": "at_s",
    "duration of a burst": "burst", "fit_strokes()": "fit=True", "snap = true": "snap=True", "force = true": "force=True", "drop_points = true": "drop_points=True",
}
_FIELDS = {"wave": "waveform"}  # words that stand elsewhere, too
_CHOICE = r"(?<![\w.-])(timing|outside|algorithm) = ([\w-]+)"


class Error(Exception):
    """Base of what the library raises.

    Attributes
    ----------
    what : str
        What it is about: an option, a field, a device, a file with line and column.
    why : str
        What is wrong with it.
    hint : str
        What to do about it; may be empty.
    file : str or None
        The file, where it is about one.
    line, column : int or None
        Place in the file, counting from 1.
    field : str or None
        The option or value that it is about; in a file, as that calls it. None where it is about none, or about how several go together.
    errno : int
        What the system said where a call of it failed; else 0.
    """

    what: str
    why: str
    hint: str
    file: str | None
    line: int | None
    column: int | None
    field: str | None
    errno: int  # not OSError's, which would be the first argument

    def __init__(self, what: str = "", why: str = "", hint: str = "", *, file: str | None = None, line: int | None = None,
                 column: int | None = None, field: str | None = None, errno: int = 0) -> None:
        super().__init__(what, why, hint)
        self.what = what
        self.why = why
        self.hint = hint
        self.file = file
        self.line = line
        self.column = column
        self.field = field
        self.errno = errno

    def __str__(self) -> str:
        text = f"{self.what}: {self.why}" if self.why else self.what
        return f"{text} ({self.hint})" if self.hint else text

    def __reduce__(self) -> tuple[_t.Callable[..., _t.Any], tuple[_t.Any, ...]]:
        return _again, (type(self), self.what, self.why, self.hint, self.file, self.line, self.column, self.field, self.errno)


class InputError(Error, ValueError):
    """Wrong input: a number, a name, a file."""


class DeviceError(Error, OSError):
    """A device or a line that is missing, busy, or cannot do what is asked."""

    def __init__(self, what: str = "", why: str = "", hint: str = "", **place: _t.Any) -> None:
        super().__init__(what, why, hint, **place)
        self.filename = self.file  # OSError takes its third argument for one


class StreamError(Error, RuntimeError):
    """What failed while it ran: the stream, a disk that is full."""


_KINDS: dict[str, type[Error]] = {"bad-input": InputError, "not-available": DeviceError, "runtime": StreamError}


def _again(kind: type[Error], what: str, why: str, hint: str, file: str | None, line: int | None, column: int | None,
           field: str | None, errno: int) -> Error:
    return kind(what, why, hint, file=file, line=line, column=column, field=field, errno=errno)


def _in_python(text: str) -> str:
    import re
    fields = "|".join(map(re.escape, _NAMES))
    text = re.sub(rf"(?<![\w.-])(?:{fields})(?![\w.-])", lambda m: _NAMES[m[0]], text)
    return re.sub(_CHOICE, r'\1="\2"', text)


def made(kind: str, what: str, why: str, hint: str, field: str = "", file: str = "", line: int = 0, column: int = 0,
         errno: int = 0) -> Error:
    """Makes the exception of a library's error; called by the extension."""
    placed = bool(file or line)
    return _KINDS[kind](what if placed else _in_python(what), why, _in_python(hint), file=file or None, line=line or None,
                        column=column or None, field=(field if placed else _FIELDS.get(field, _in_python(field))) or None, errno=errno)
