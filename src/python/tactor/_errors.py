# SPDX-License-Identifier: MIT
"""Errors as exceptions."""
from __future__ import annotations

import typing as _t


class Error(Exception):
    """Base of the library's errors.

    Where a call of the system failed it is also an `OSError` with its errno: a missing file is an `InputError` and a
    `FileNotFoundError`, a full disk a `StreamError` and an `OSError`.

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
    _plain: type[Error] | None = None  # of a class that is also one of the system's: the kind alone

    def __init__(self, what: str = "", why: str = "", hint: str = "", *, file: str | None = None, line: int | None = None,
                 column: int | None = None, field: str | None = None, errno: int = 0) -> None:
        super().__init__(what, why, hint)
        self.args = what, why, hint  # OSError takes the third for a file's name
        self.what, self.why, self.hint = self.args
        self.line, self.column, self.field, self.errno = line, column, field, errno
        self._name_file(file)

    def _name_file(self, file: str | None) -> None:
        """Says which file it is about, in OSError's way, too."""
        self.file = file
        in_system: _t.Any = self
        if OSError in type(self).__mro__:
            in_system.strerror, in_system.filename = self.why, file

    def __str__(self) -> str:
        text = f"{self.what}: {self.why}" if self.why else self.what
        return f"{text} ({self.hint})" if self.hint else text

    def __reduce__(self) -> tuple[_t.Callable[..., _t.Any], tuple[_t.Any, ...]]:
        return _again, (self._plain or type(self), self._plain is not None, self.args,
                        {name: getattr(self, name) for name in ("file", "line", "column", "field", "errno")})


class InputError(Error, ValueError):
    """Wrong input: a number, a name, a file."""


class DeviceError(Error, OSError):
    """A device or a line that is missing, busy, or cannot do what is asked."""


class StreamError(Error, RuntimeError):
    """A failure at run time: of the stream, of a full disk."""


_KINDS: dict[str, type[Error]] = {"bad-input": InputError, "not-available": DeviceError, "runtime": StreamError}


def _system_kind(kind: type[Error], errno: int) -> type[Error]:
    """Returns the class of that kind that is also what Python raises for an errno; the kind itself for none."""
    base = type(OSError(errno, "")) if errno else kind
    if issubclass(kind, base):
        return kind
    if (kind, base) not in _joined:
        _joined[kind, base] = type(base.__name__, (kind, base), {"__doc__": kind.__doc__, "__module__": __name__, "_plain": kind})
    return _joined[kind, base]


_joined: dict[tuple[type, type], type[Error]] = {}


def _again(kind: type[Error], of_system: bool, texts: tuple[str, str, str], more: dict[str, _t.Any]) -> Error:
    return (_system_kind(kind, more["errno"]) if of_system else kind)(*texts, **more)


def make_error(kind: str, what: str, why: str, hint: str, field: str = "", file: str = "", line: int = 0, column: int = 0,
               errno: int = 0) -> Error:
    """Makes the exception of a library's error; called by the extension."""
    return _system_kind(_KINDS[kind], errno)(what, why, hint, file=file or None, line=line or None, column=column or None, field=field or None,
                                           errno=errno)
