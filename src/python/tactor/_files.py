# SPDX-License-Identifier: MIT
"""Names of files, and errors that say which."""
from __future__ import annotations

import contextlib
import os
import typing as _t

from tactor._errors import Error, InputError


def encoded(name: str | os.PathLike[str], what: str = "file") -> bytes:
    """A name as the system takes it, which ends at a zero byte."""
    as_bytes = os.fsencode(name)
    if b"\0" in as_bytes:
        raise InputError(what, f"{os.fspath(name)!r} has a zero byte in it", "no file or device is called so", field=what)
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
