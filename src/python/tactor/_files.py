# SPDX-License-Identifier: MIT
"""Names of files, and errors that say which."""
from __future__ import annotations

import contextlib
import os
import typing as _t

from tactor._errors import Error


@contextlib.contextmanager
def reading(file: str | os.PathLike[str]) -> _t.Iterator[bytes]:
    """Gives the name as the extension takes it; an error within says the file, whether or not it knows the line."""
    name = os.fspath(file)
    try:
        yield os.fsencode(name)
    except Error as e:
        if e.file is None:
            e.file = name
        raise
