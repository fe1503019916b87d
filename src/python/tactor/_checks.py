# SPDX-License-Identifier: MIT
"""Checks of arguments, and bases of the classes."""
from __future__ import annotations

import contextlib
import math
import operator
import os
import typing as _t

from tactor._errors import Error, InputError

if _t.TYPE_CHECKING:
    from numpy.typing import NDArray as _NDArray


def _floats(what: str, values: _t.Any, nan: bool = False) -> _t.Any:
    """Returns numbers as an array of float64; refuses those that would lose something, as complex numbers, times and masks do."""
    import numpy as np
    try:
        raw: _t.Any = values if isinstance(values, np.ma.MaskedArray) else np.asarray(values)
        if raw.size and not _are_plain(raw):
            raise TypeError("it has " + ("masked values" if _is_masked(raw) else f"values of type {raw.dtype}"))
        numbers: _t.Any = np.ascontiguousarray(raw, dtype=np.float64) if raw.ndim else np.float64(raw)
    except (TypeError, ValueError, OverflowError) as e:
        raise InputError(what, f"it is not an array of numbers: {e}", "give real numbers", field=what) from None
    if np.isnan(numbers).any() and not (nan and raw.dtype.kind == "f"):  # which None becomes, too
        raise InputError(what, "it has a value that is not a number", field=what)
    return numbers


def _are_plain(array: _t.Any) -> bool:
    """Returns True for an array of real numbers alone."""
    if array.dtype.kind == "O":
        return all(not isinstance(v, (str, bytes, bool, complex)) and _is_plain(v) for v in array.flat)
    return array.dtype.kind in "iuf" and not _is_masked(array)


def _is_masked(array: _t.Any) -> bool:
    mask = getattr(array, "mask", False)
    return bool(mask.any() if hasattr(mask, "any") else mask)


def _is_plain(value: _t.Any) -> bool:
    """Returns False for NumPy's types that are no real number: complex numbers, times, truths, texts, masked and several values."""
    dtype = getattr(value, "dtype", None)
    if dtype is None:
        return True
    return getattr(dtype, "kind", "") in "iuf" and getattr(value, "ndim", 0) == 0 and not getattr(value, "mask", False)


def _number(what: str, value: _t.Any, least: float = -math.inf, most: float = math.inf, hint: str = "", finite: bool = True) -> float:
    """Returns a number between bounds; refuses all else by the name `what`."""
    if not hint and math.isfinite(least):
        hint = f"use {least:g} to {most:g}" if math.isfinite(most) else f"use {least:g} or more"
    try:
        if isinstance(value, (str, bytes, bytearray, memoryview, bool)) or not _is_plain(value):
            raise TypeError
        number = float(value)
    except (TypeError, ValueError):
        raise InputError(what, f"{_shown(value)} is not a number", hint, field=what) from None
    except OverflowError:
        number = math.inf
    if not ((math.isfinite(number) or not finite) and least <= number <= most):
        raise InputError(what, f"{_shown(value)} is out of range", hint, field=what)
    return number


def _whole(what: str, value: _t.Any, least: int, most: int, hint: str = "") -> int:
    """Returns a whole number between bounds; 48000.0 is one, too."""
    hint = hint or f"give a whole number from {least} to {most}"
    number = _number(what, value, least, most, hint)
    if number != int(number):
        raise InputError(what, f"{_shown(value)} is not a whole number", hint, field=what)
    try:
        return operator.index(value)  # to its last digit
    except TypeError:
        return int(number)


def _place(what: str, value: _t.Any) -> tuple[float, float]:
    """Returns (x_mm, y_mm)."""
    try:
        x, y = value
    except (TypeError, ValueError):
        raise InputError(what, f"{_shown(value)} is not a place", "give (x_mm, y_mm)", field=what) from None
    return _number(what, x), _number(what, y)


def _shown(value: object) -> str:
    try:
        text = repr(value)
    except Exception:  # as for a number of more digits than Python writes
        return "that"
    return text if len(text) <= 80 else text[:80] + "..."


def _need(value: object, kind: type, what: str) -> None:
    """Refuses an argument of another type by its name."""
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIOU" else "a"
        raise TypeError(f"{what}: it must be {article} {kind.__name__}, not {type(value).__name__}")
    if isinstance(value, str):
        _need_utf8(value, what)


def _need_utf8(text: str, what: str) -> None:
    """Refuses a text with lone surrogates, which has no UTF-8."""
    try:
        text.encode()
    except UnicodeEncodeError as e:
        raise InputError(what, f"its character {e.start + 1} is a lone surrogate", "give text that UTF-8 can encode", field=what) from None


def _counted(n: int, noun: str) -> str:
    return f"{n} {noun}" if n == 1 else f"{n} {noun}s"


def encoded(name: str | os.PathLike[str], what: str = "file") -> bytes:
    """Returns a name as the system takes it; refuses zero bytes, which would end it."""
    as_bytes = os.fsencode(name)
    if b"\0" in as_bytes:
        raise InputError(what, f"{os.fspath(name)!r} has a zero byte", "give a name without it", field=what)
    return as_bytes


@contextlib.contextmanager
def reading(file: str | os.PathLike[str]) -> _t.Iterator[bytes]:
    """Gives the name as the extension takes it; an error within says the file, whether or not it knows the line."""
    name = os.fspath(file)
    try:
        yield encoded(name)
    except Error as e:
        if e.file is None:
            e._name_file(name)
        raise


_M = _t.TypeVar("_M")


class _Member(property, _t.Generic[_M]):
    # Returns a property that reads a member of the extension's object in _core. Each caller sets its own docstring.

    def __init__(self, name: str, doc: str) -> None:
        super().__init__(operator.attrgetter("_core." + name))
        self.__doc__ = doc

    if _t.TYPE_CHECKING:
        @_t.overload
        def __get__(self, instance: None, owner: type) -> _Member[_M]: ...
        @_t.overload
        def __get__(self, instance: object, owner: type | None = None) -> _M: ...
        def __get__(self, instance: object, owner: type | None = None) -> _t.Any: ...
        def __set__(self, instance: object, value: _t.NoReturn) -> None: ...


class _Value:
    """A value that cannot change: a copy of it is itself."""

    __slots__ = ()

    def __copy__(self) -> _t.Any:
        return self

    def __deepcopy__(self, memo: dict[int, _t.Any]) -> _t.Any:
        return self


class _Columns(_Value):
    """Arrays of the same length that belong together and cannot be changed."""

    __slots__: tuple[str, ...] = ()

    def __init__(self, *columns: _NDArray[_t.Any]) -> None:
        for name, values in zip(self.__slots__, columns):
            values = values.view()
            values.flags.writeable = False
            object.__setattr__(self, name, values)

    def __setattr__(self, name: str, *_: object) -> None:
        raise AttributeError(f"a {type(self).__name__.lower()} cannot be changed, nor its {name!r}")

    __delattr__ = __setattr__

    def __reduce__(self) -> tuple[_t.Callable[..., _t.Any], tuple[_t.Any, ...]]:
        return type(self), tuple(getattr(self, name) for name in self.__slots__)

    def __len__(self) -> int:
        return len(getattr(self, self.__slots__[0]))

    def __eq__(self, other: object) -> bool:
        import numpy as np
        if type(self) is not type(other):
            return NotImplemented
        return all(np.array_equal(getattr(self, n), getattr(other, n), equal_nan=True) for n in self.__slots__)

    __hash__ = None  # type: ignore[assignment]


_S = _t.TypeVar("_S", bound="_Stated")


class _Stated(_Value):
    """A value of the extension, which writes it as bytes. Values with the same bytes are equal."""

    __slots__ = ("_core",)

    _core: _t.Any

    @classmethod
    def _wrap(cls: type[_S], core: _t.Any) -> _S:
        made = cls.__new__(cls)
        made._core = core
        return made

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, type(self)):
            return NotImplemented
        return bool(self._core.state() == other._core.state())

    def __hash__(self) -> int:
        return hash(self._core.state())

    def __reduce__(self) -> tuple[_t.Callable[..., _t.Any], tuple[_t.Any, ...]]:
        return _again, (type(self), type(self._core), self._core.state())


def _again(kind: type[_S], core: _t.Any, state: bytes) -> _S:
    return kind._wrap(core.from_state(state))


class _Unique:
    """An object that cannot be copied, such as a device: two would close each other."""

    __slots__ = ()

    def __reduce__(self) -> _t.NoReturn:
        raise TypeError(f"a {type(self).__name__} cannot be copied or pickled")
