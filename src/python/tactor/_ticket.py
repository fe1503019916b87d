# SPDX-License-Identifier: MIT
"""Strokes that a player was given: tickets, live strokes and reports."""
from __future__ import annotations

import collections
import sys
import threading
import time
import typing as _t
import warnings
import weakref

from tactor._checks import _Member, _number, _Unique

if _t.TYPE_CHECKING:
    import asyncio
    from types import TracebackType as _TracebackType
    from tactor._errors import Error
    _State = _t.Literal["finished", "cancelled", "interrupted"]
    _LogKind = _t.Literal["debug", "info", "warning", "error"]

_LOOK_S = 0.1  # longest time until Ctrl-C is noticed
_T = _t.TypeVar("_T")


class Delay(_t.NamedTuple):
    """The delay of a live stroke's points, s: from their time stamps until the DAC had the first frame that each changed.

    Attributes
    ----------
    points : int
        How many were counted: not those that a newer one overtook before the next period.
    least_s, mean_s, most_s : float
        Below 0 where a time stamp lies in the future.
    """

    points: int
    least_s: float
    mean_s: float
    most_s: float


class Report(_t.NamedTuple):
    """The end of a stroke.

    Attributes
    ----------
    state : str
        "finished": its last frame reached the DAC; "cancelled": faded out because it was asked for; "interrupted": an xrun, the loss
        of the device, a failure or a live stroke's silent producer cut it.
    reason : str
        Why it did not finish; empty for a stroke that finished, and for one that this program cancelled.
    frames : int
        Frames of it that were played.
    started_s : float or None
        Time of its first sample at the DAC, s of CLOCK_MONOTONIC, which is Python's `time.monotonic()`; None when it never sounded.
    late_s : float
        How much later than asked for that was; 0 when in time.
    delay : Delay or None
        Of a live stroke's points; None where none has sounded, and for other strokes.
    held_points : int
        Points of a live stroke with an intensity above 1, which sounded as 1.
    outside_points : int
        Points of a live stroke outside the array, which were moved to its edge.
    doubt : str
        The unit that a live stroke's points are likely in, if not millimetres; else empty.
    """

    state: _State
    reason: str
    frames: int
    started_s: float | None
    late_s: float
    delay: Delay | None = None
    held_points: int = 0
    outside_points: int = 0
    doubt: str = ""


class _Awaited(_Unique, _t.Generic[_T]):
    """A thing that ends once, with a result or an error: it can be awaited and waited for, and calls back."""

    def __init__(self) -> None:
        self._gate = _Gate()
        self._lock = threading.RLock()  # a signal's handler may interrupt who has it
        self._callbacks: list[_t.Callable[[_t.Any], object]] = []
        self._result: _T | None = None
        self._error: Error | None = None
        self._done = False

    def _wait(self, what: str, timeout: float | None, thread: threading.Thread) -> _T:
        """Waits for the end in another thread than `thread`, which reports it."""
        if timeout is not None:
            timeout = _number("timeout", timeout, finite=False)
        if not self._done and threading.current_thread() is thread:
            raise RuntimeError(f"a callback cannot wait for {what}")
        until = None if timeout is None else time.monotonic() + timeout
        # Wakes now and then: a signal that the kernel gives to another thread does not end this wait.
        while not self._gate.wait(_LOOK_S if until is None else min(max(until - time.monotonic(), 0.0), _LOOK_S)):
            if until is not None and time.monotonic() >= until:
                raise TimeoutError(f"{what} has not ended after {timeout:g} s")
        return self._answer()

    def add_done_callback(self, callback: _t.Callable[[_t.Any], object]) -> None:
        with self._lock:
            if not self._done:
                self._callbacks.append(callback)
                return
        callback(self)

    def __await__(self) -> _t.Generator[_t.Any, None, _T]:
        import asyncio
        loop = asyncio.get_running_loop()
        future: asyncio.Future[None] = loop.create_future()

        def set_result() -> None:
            if not future.done():
                future.set_result(None)

        def tell(_: _t.Any) -> None:
            try:
                loop.call_soon_threadsafe(set_result)
            except RuntimeError:
                pass  # the loop was closed meanwhile: nobody waits
        self.add_done_callback(tell)
        try:
            yield from future.__await__()
        except asyncio.CancelledError:
            self._forsake()
            raise
        return self._answer()

    def _forsake(self) -> None:
        """Cancels what it stands for, because the task that awaits it was cancelled."""

    def _answer(self) -> _T:
        if self._error is not None:
            raise self._error
        return self._result  # type: ignore[return-value]

    def _end(self, result: _T | None, error: Error | None = None) -> None:
        with self._lock:
            if self._done:
                return
            self._result, self._error, self._done = result, error, True
            callbacks, self._callbacks = self._callbacks, []
        self._gate.open()
        for callback in callbacks:
            _call(callback, self)


class Ticket(_Awaited[Report]):
    """A stroke that a player was given. Can be awaited, which gives the report; who cancels the waiting cancels the stroke.

    Callbacks run in the player's own thread of Python.
    """

    def __init__(self, player: _Shared, number: int) -> None:
        super().__init__()
        self._player = player
        self._number = number

    @property
    def id(self) -> int:
        """Number, unique in one player."""
        return self._number

    @property
    def rate(self) -> int:
        """Sample rate of the stream, Hz."""
        return self._player.rate

    @property
    def report(self) -> Report | None:
        """The report of its end; None until then."""
        return self._result

    def done(self) -> bool:
        """Returns True once it has ended."""
        return self._done

    def wait(self, timeout: float | None = None) -> Report:
        """Waits until it has ended. Ctrl-C fades it out.

        Parameters
        ----------
        timeout : float, optional
            Seconds.

        Returns
        -------
        Report

        Raises
        ------
        TimeoutError
            When it goes on after that.
        InputError
            For a timeout that is no number.
        StreamError
            In a process that was forked.
        RuntimeError
            In a callback, for a stroke that has not ended: its thread would have to bring the report.
        """
        if not self._done:
            self._player.core.refuse_child()
        try:
            return self._wait(f"stroke {self._number}", timeout, self._player.thread)
        except KeyboardInterrupt:
            self.cancel()
            self._gate.wait(1.0)
            raise

    def cancel(self) -> bool:
        """Fades it out. False when it has ended."""
        return not self._done and self._player.core.cancel(self._number)

    def add_done_callback(self, callback: _t.Callable[[_t.Any], object]) -> None:
        """Calls `callback(ticket)` once it has ended: in the player's thread of Python, or at once and here when it has already."""
        if not self._done:
            self._player.core.refuse_child()
        super().add_done_callback(callback)

    def _forsake(self) -> None:
        self.cancel()

    def __repr__(self) -> str:
        how = "goes on" if self._result is None else self._result.state
        return f"<tactor.{type(self).__name__} {self._number}: {how}>"


class LiveStroke(Ticket):
    """A stroke that is fed point by point. Leaving its block ends it, and waits for that; with an exception it fades out."""

    def __init__(self, player: _Shared, core: _t.Any) -> None:
        super().__init__(player, core.id)
        self._core = core
        self._intensity_max = core.intensity_max

    def to(self, x_mm: float, y_mm: float, intensity: float | None = None, *, at_s: float | None = None) -> bool:
        """Moves it to a place.

        Parameters
        ----------
        x_mm, y_mm : float
        intensity : float, optional
            Linear; 1, or `intensity_max`, is the level that was asked for, which is also the default. What is above sounds as that
            level: a UserWarning at the first such point, and counted in the report's `held_points`. A place outside the array
            moves to its edge: a UserWarning at the first, and counted in `outside_points`.
        at_s : float, optional
            When the touch was there, s of CLOCK_MONOTONIC (`time.monotonic()`), which the report's delay counts from; else now.

        Returns
        -------
        bool
            False when it has ended; the report says why.

        Raises
        ------
        InputError
            For what is not finite, a negative time, and with outside="error" for a place outside the array; it goes on where it was.
        Exception
            What a phantom model of your own raises, InputError where it returns rubbish, and StreamError where it calls this for the
            stroke that asks it; then the stroke ends with that as its reason.
        """
        if intensity is None:
            intensity = self._intensity_max
        if not (type(x_mm) is type(y_mm) is type(intensity) is float):
            x_mm, y_mm, intensity = _number("x_mm", x_mm), _number("y_mm", y_mm), _number("intensity", intensity, 0.0)
        intensity /= self._intensity_max
        if at_s is not None:
            at_s = _number("at_s", at_s, 0.0, 8e9, "give seconds as time.monotonic() gives them, or none for now")
        moved: bool = self._core.to(x_mm, y_mm, intensity, at_s)
        if moved:
            for remark in self._core.remarks(x_mm, y_mm, intensity):
                warnings.warn(remark, stacklevel=2)
        return moved

    def end(self) -> None:
        """Ends it, for no more points come: fades out, or plays its last burst to the end."""
        self._core.end()

    open: _Member[bool] = _Member("open", "True while it can be fed.")

    @property
    def counts(self) -> dict[str, int]:
        """Counts of the `points` taken, and of those moved from `outside`, `limited` at a channel's limit, and `held` at
        intensity 1."""
        return self._core.counts()  # type: ignore[no-any-return]

    def __enter__(self) -> LiveStroke:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: _TracebackType | None) -> None:
        if self._player.core.forked:
            return
        if kind is None:
            self.end()
        else:
            self._core.cancel()
        if threading.current_thread() is not self._player.thread:
            self.wait()


class _Gate:
    """A gate that opens once. A signal's handler may wait at it while it interrupts another wait, which threading.Event does not allow."""

    def __init__(self) -> None:
        self._open = False
        self._lock = threading.Lock()
        self._lock.acquire()

    def open(self) -> None:
        self._open = True
        self._lock.release()

    def wait(self, timeout: float) -> bool:
        if self._open:  # a wait that the handler interrupts may have the lock
            return True
        there = self._lock.acquire(timeout=timeout)
        if there:
            self._lock.release()
        return there


class _Held:
    """References that a player holds for its thread: callbacks may know the player, so a thread that held them would keep it alive."""

    def __init__(self, log: _t.Callable[[_LogKind, str], object] | None) -> None:
        self.log = log
        self.tickets: dict[int, Ticket] = {}


class _Shared:
    """Common state of a player, its tickets and its thread: not the player, so that a forgotten one can be collected."""

    def __init__(self, core: _t.Any, held: _Held) -> None:
        self.core = core
        self.rate: int = core.setup()["rate"]
        self.lock = threading.RLock()  # as a ticket's
        self.closing = threading.RLock()
        self.held: _t.Callable[[], _Held | None] = weakref.ref(held)
        self.events: collections.deque[tuple[_t.Any, ...]] = collections.deque()
        self.reported = _Gate()
        self.joined = False
        self.thread = threading.Thread(target=self._run, name="tactor", daemon=True)
        self.thread.start()

    def _run(self) -> None:
        try:
            while (event := self.core.next()) is not None:
                self.events.append(event)
                self._report()
            self._report()
        finally:
            self.reported.open()

    def wait_reported(self) -> None:
        """Waits until all is reported and the thread has ended."""
        while not self.reported.wait(_LOOK_S):
            pass
        # A handler that interrupts join() must not join, too: it would wait for a lock of the interrupted call.
        if not self.joined:
            self.joined = True
            self.thread.join()

    def _report(self) -> None:
        held = self.held()
        if held is None:  # the player is being collected: its close() gives it back
            return
        while self.events:
            event = self.events.popleft()
            if len(event) == 2:
                if held.log is not None:
                    _call(held.log, *event)
                continue
            number, state, reason, frames, started_s, late_s, delay, *points = event
            with self.lock:  # submit() holds it until the ticket is in there
                ticket = held.tickets.pop(number, None)
            if ticket is not None:
                ticket._end(Report(state, reason, frames, started_s, late_s, None if delay is None else Delay(*delay), *points))


def _call(function: _t.Callable[..., object], *arguments: _t.Any) -> None:
    """Calls a callback, and shows its exception as that of another thread; the player goes on."""
    try:
        function(*arguments)
    except BaseException:  # sys.exit(), too: it would end the player's thread, for which others wait
        sys.excepthook(*sys.exc_info())
