# SPDX-License-Identifier: MIT
"""Markers for EEG: each stroke's start and end to the Lab Streaming Layer, stamped with the frame that was played::

    markers = tactor.lsl.Markers()
    ticket = markers.mark(player.submit(score), "left")

liblsl is loaded when the first `Markers` is made, and nothing of it before.
"""
from __future__ import annotations

import ctypes
import ctypes.util
import os
import threading
import time
import typing as _t

from tactor._checks import _Unique
from tactor._errors import DeviceError, InputError
from tactor._ticket import Report, Ticket

__all__ = ["Markers"]

_T = _t.TypeVar("_T", bound=Ticket)
_STRING = 3  # cft_string
_NAMES = ("liblsl.so.2", "liblsl.so", "liblsl64.so")


def _load(library: str | os.PathLike[str] | None) -> ctypes.CDLL:
    names = [os.fspath(library)] if library is not None else [n for n in (os.environ.get("PYLSL_LIB"), ctypes.util.find_library("lsl"), *_NAMES) if n]
    why = ""
    for name in names:
        try:
            lsl = ctypes.CDLL(name)
            for function, result, arguments in (
                    ("lsl_local_clock", ctypes.c_double, []),
                    ("lsl_create_streaminfo", ctypes.c_void_p,
                     [ctypes.c_char_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_double, ctypes.c_int, ctypes.c_char_p]),
                    ("lsl_create_outlet", ctypes.c_void_p, [ctypes.c_void_p, ctypes.c_int, ctypes.c_int]),
                    ("lsl_push_sample_strtp", ctypes.c_int, [ctypes.c_void_p, ctypes.POINTER(ctypes.c_char_p), ctypes.c_double, ctypes.c_int]),
                    ("lsl_destroy_outlet", None, [ctypes.c_void_p]),
                    ("lsl_destroy_streaminfo", None, [ctypes.c_void_p])):
                f = getattr(lsl, function)
                f.restype, f.argtypes = result, arguments
            return lsl
        except (OSError, AttributeError) as e:
            why = why or str(e)
    raise DeviceError("liblsl", f"it cannot be loaded: {why}",
                      "install it from the Lab Streaming Layer's releases, and name it in PYLSL_LIB if the system does not find it")


class Markers(_Unique):
    """A stream of markers: "start LABEL" and "end LABEL STATE" for each stroke that sounded.

    They are sent when the stroke has ended, for only then is known which frames were played; their times are those of the first sample at
    the DAC and of the one after the last, in LSL's clock.

    Parameters
    ----------
    name : str
        Name of the stream; its type is "Markers".
    source_id : str
        By which a recorder finds it again after a restart.
    library : path-like, optional
        liblsl; default: $PYLSL_LIB, else where the system finds it.

    Raises
    ------
    DeviceError
        If liblsl cannot be loaded, or cannot make a stream.
    """

    def __init__(self, name: str = "tactor", source_id: str = "tactor", library: str | os.PathLike[str] | None = None) -> None:
        self._lock = threading.Lock()
        self._outlet: int | None = None
        self._info: int | None = None
        self._lsl = _load(library)
        self._info = self._lsl.lsl_create_streaminfo(name.encode(), b"Markers", 1, 0.0, _STRING, source_id.encode())
        self._outlet = self._lsl.lsl_create_outlet(self._info, 0, 360) if self._info else None
        if not self._outlet:
            self.close()
            raise DeviceError("liblsl", "it cannot make a stream", "see its log")

    def mark(self, ticket: _T, label: str = "", rate: int | None = None) -> _T:
        """Sends the markers of a stroke once it has ended; gives the ticket back.

        Parameters
        ----------
        ticket : Ticket
        label : str
            What it is called in the markers; default: its number.
        rate : int, optional
            The stream's sample rate, Hz; default: that of the ticket's player.
        """
        if self._outlet is None:
            raise InputError("markers", "they are closed", "make new ones")
        hz = ticket.rate if rate is None else rate
        ticket.add_done_callback(lambda t: self._send(t.report, label or str(t.id), hz))
        return ticket

    def _send(self, report: Report, label: str, rate: int) -> None:
        with self._lock:  # close() may come from another thread
            if report.started_s is None or self._outlet is None:
                return
            ahead = self._ahead()
            self._push(f"start {label}", report.started_s + ahead)
            self._push(f"end {label} {report.state}", report.started_s + report.frames / rate + ahead)

    def _ahead(self) -> float:
        """LSL's clock less CLOCK_MONOTONIC: measured, of several the reading that took least."""
        best, ahead = float("inf"), 0.0
        for _ in range(5):
            before = time.monotonic()
            theirs = self._lsl.lsl_local_clock()
            after = time.monotonic()
            if after - before < best:
                best, ahead = after - before, theirs - (before + after) / 2
        return ahead

    def _push(self, text: str, at_s: float) -> None:
        sample = (ctypes.c_char_p * 1)(text.encode())
        self._lsl.lsl_push_sample_strtp(self._outlet, sample, at_s, 1)

    def close(self) -> None:
        """Ends the stream. Strokes that end later are not marked."""
        with self._lock:
            outlet, self._outlet = self._outlet, None
            info, self._info = self._info, None
            if outlet:
                self._lsl.lsl_destroy_outlet(outlet)
            if info:
                self._lsl.lsl_destroy_streaminfo(info)

    def __enter__(self) -> Markers:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<tactor.lsl.Markers: {'closed' if self._outlet is None else 'open'}>"
