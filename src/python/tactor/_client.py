# SPDX-License-Identifier: MIT
"""Drawing through `tactor serve`, beside other programs."""
from __future__ import annotations

import copy
import errno
import json
import os
import socket as _socket
import sys
import threading
import typing as _t

from tactor._checks import _need, _number, _shown, _Unique, _whole
from tactor._errors import _KINDS, DeviceError, Error, InputError, StreamError, _system_kind
from tactor._plan import Plan
from tactor._stroke import Path, Stroke
from tactor._ticket import Report, _Awaited

if _t.TYPE_CHECKING:
    from types import TracebackType as _TracebackType

_HELLO_S = 10.0


class Reply(_Awaited[_t.Any]):
    """The reply to a request of a `Client`, which was sent at once. Await it, or call `wait`.

    Both give the result, or raise what the service refused it with: `InputError`, `DeviceError` or `StreamError` with its words.
    """

    _what = "the request"

    def __init__(self, client: Client, convert: _t.Callable[[_t.Any], _t.Any] = lambda result: result) -> None:
        super().__init__()
        self._client = client._wire
        self._keeps = client  # one that nobody names any more is not closed before the answer
        self._convert = convert

    def done(self) -> bool:
        """Returns True once the answer is there."""
        return self._done

    def wait(self, timeout: float | None = None) -> _t.Any:
        """Blocks until the answer is there.

        Parameters
        ----------
        timeout : float, optional
            Seconds.

        Returns
        -------
        object

        Raises
        ------
        TimeoutError
            When there is none after that.
        Error
            What the service answered, or that it has gone.
        """
        return self._wait(self._what, timeout, self._client.thread)

    def add_done_callback(self, callback: _t.Callable[[_t.Any], object]) -> None:
        """Calls `callback(reply)` once the answer is there: in the client's thread, or at once and here when it is already."""
        super().add_done_callback(callback)

    def _take(self, result: _t.Any) -> None:
        """The service's result."""
        try:
            self._end(self._convert(result))
        except Error as e:
            self._end(None, e)

    def __repr__(self) -> str:
        how = "waits" if not self._done else "refused" if self._error is not None else "done"
        return f"<tactor.{type(self).__name__}: {how}>"


_R = _t.TypeVar("_R", bound=Reply)


class RemoteStroke(Reply):
    """A stroke that a service plays. Awaiting it, or `wait`, gives its `Report`; who cancels the awaiting cancels the stroke."""

    _what = "the stroke"

    def __init__(self, client: Client) -> None:
        super().__init__(client)
        self._numbers: list[int] = []
        self._open: set[int] = set()
        self._pending: str | None = None
        self.warnings: list[str] = []
        """Oddities that were accepted; there once the service has answered."""
        self.weakened_db = 0.0
        """How much weaker than asked for its strokes are, so that no tactor exceeds the level, dB; 0 or less."""
        self.meets: dict[str, _t.Any] | None = None
        """Place where they would be loudest, with "tactor", "at_s" and "strokes" (from 0); None where they are not weakened."""

    @property
    def id(self) -> int | None:
        """Its number in the service; None until that has answered."""
        return self._numbers[0] if self._numbers else None

    @property
    def report(self) -> Report | None:
        """The report of its end; None until then."""
        return self._result

    def cancel(self) -> None:
        """Fades it out."""
        self._later("cancel")

    def _later(self, method: str) -> None:
        """Sends it for each stroke: now, or once the numbers are known."""
        with self._lock:
            self._pending = method
            numbers = list(self._open)
        for number in numbers:
            self._client.tell(method, stroke=number)

    def _forsake(self) -> None:
        self.cancel()

    def _take(self, result: _t.Any) -> None:
        with self._lock:
            self._numbers = result.get("strokes", [result["stroke"]])
            self._open = set(self._numbers)
            self.warnings = result.get("warnings", [])
            self.weakened_db = result.get("weakened_db", 0.0)
            self.meets = result.get("meets")
            pending = self._pending
        for number in self._numbers:
            self._client.strokes[number] = self
        if pending is not None:
            self._later(pending)

    def _take_event(self, event: dict[str, _t.Any]) -> None:
        if event["state"] == "started":
            return
        self._open.discard(event["stroke"])
        if not self._open:
            self._end(Report(event["state"], event["reason"], event["frames"], event["started_s"], event["late_s"],
                             held_points=event["held_points"], outside_points=event["outside_points"], doubt=event["doubt"]))
        self._client.strokes.pop(event["stroke"], None)


class RemoteLive(RemoteStroke):
    """A live stroke in a service. Leaving its block ends it, with an exception it fades out; `async with` also waits for its end."""

    def to(self, x_mm: float, y_mm: float, intensity: float = 1.0) -> None:
        """Moves it to a place; without an answer, so that points do not wait for one another.

        Parameters
        ----------
        x_mm, y_mm : float
        intensity : float
            Linear; 1 is the level that was asked for.

        Raises
        ------
        InputError
            For what is not finite.
        StreamError
            When the service has gone.
        """
        point = {"x_mm": _number("x_mm", x_mm), "y_mm": _number("y_mm", y_mm), "intensity": _number("intensity", intensity, 0.0)}
        self._client.tell("to", stroke=self._numbers[0], **point)

    def end(self) -> None:
        """Ends it: no more points come."""
        self._later("end")

    def __enter__(self) -> RemoteLive:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: _TracebackType | None) -> None:
        self._later("end" if kind is None else "cancel")
        if kind is None:
            self.wait()

    async def __aenter__(self) -> RemoteLive:
        return self

    async def __aexit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: _TracebackType | None) -> None:
        self._later("end" if kind is None else "cancel")
        if kind is None:
            await self


def _open_unix(path: str) -> _socket.socket:
    made = _socket.socket(_socket.AF_UNIX, _socket.SOCK_STREAM | _socket.SOCK_CLOEXEC)
    try:
        made.connect(path)
    except BaseException:
        made.close()
        raise
    return made


def _open_tcp(address: tuple[str, int]) -> _socket.socket:
    made = _socket.create_connection(address, _HELLO_S)
    made.settimeout(None)
    made.setsockopt(_socket.IPPROTO_TCP, _socket.TCP_NODELAY, 1)
    return made


def _parse_address(tcp: str) -> tuple[str, int]:
    """Returns host and port of "127.0.0.1:4001", "[::1]:4001" or "4001"."""
    _need(tcp, str, "tcp")
    host, _, port = tcp.rpartition(":")
    bare = host[1:-1] if host.startswith("[") and host.endswith("]") else host
    try:
        bare.encode("idna")  # as the resolver does
        is_address = port.isascii() and port.isdigit() and 0 < int(port) < 65536 and (bare != host or ":" not in host)
    except ValueError:
        is_address = False
    if not is_address:
        raise InputError("tcp", f"{_shown(tcp)} is not an address", "give HOST:PORT as tactor serve --tcp prints it", field="tcp")
    return bare or "127.0.0.1", int(port)


def _error_number(e: OSError, by_tcp: bool) -> int:
    """Returns the system's number of a failed connection, also where Python found the fault itself; 0 for a name without an address."""
    if isinstance(e, _socket.gaierror):
        return 0
    return e.errno or (errno.ETIMEDOUT if isinstance(e, TimeoutError) else 0 if by_tcp else errno.ENAMETOOLONG)


class _Connection:
    """The socket and its thread: not the client, so that a forgotten one can be collected."""

    def __init__(self, path: str, tcp: tuple[str, int] | None = None) -> None:
        try:
            self.socket = _open_tcp(tcp) if tcp is not None else _open_unix(path)
        except OSError as e:
            code = _error_number(e, tcp is not None)
            why = os.strerror(code) if code else e.strerror or str(e)
            raise _system_kind(DeviceError, code)(
                path, why, "start one: tactor serve" + (" --tcp PORT" if tcp is not None else ""), file=path, errno=code) from None
        self.path = path
        self.owner = os.getpid()
        self.lock = threading.RLock()
        self.last = 0
        self.waiting: dict[int, Reply] = {}
        self.strokes: dict[int, RemoteStroke] = {}
        self.gone = False
        self.closed_here = False
        self.refusal: Error | None = None  # the service's reason to end the connection
        self.thread = threading.Thread(target=self._run, name="tactor-client", daemon=True)
        self.thread.start()

    def tell(self, method: str, **params: _t.Any) -> None:
        """Sends a message that gets no answer."""
        self._send({"jsonrpc": "2.0", "method": method, "params": params})

    def ask(self, reply: _R, method: str, params: dict[str, _t.Any]) -> _R:
        """Sends a request; gives its reply back."""
        with self.lock:
            self.last += 1
            number = self.last
            self.waiting[number] = reply
        try:
            self._send({"jsonrpc": "2.0", "id": number, "method": method, "params": params})
        except Error:
            self.waiting.pop(number, None)
            raise
        return reply

    def _send(self, message: dict[str, _t.Any]) -> None:
        if os.getpid() != self.owner:
            raise StreamError("client", "it belongs to the process that this one was forked from", "open a client in this process")
        try:
            line = json.dumps(message, allow_nan=False).encode() + b"\n"
        except (TypeError, ValueError) as e:
            raise InputError("params", f"they are not JSON: {e}", "give numbers, texts, lists and dicts") from None
        try:
            with self.lock:
                self.socket.sendall(line)
        except OSError:
            if threading.current_thread() is not self.thread:
                self.thread.join(_HELLO_S)  # it reads the service's last message, which may be the reason
            raise self._gone() from None
        if self.gone:
            raise self._gone()

    def _gone(self) -> Error:
        if self.closed_here:
            return StreamError("client", "it is closed", "make a new one")
        if self.refusal is not None:
            return copy.copy(self.refusal)
        return StreamError(self.path, "the service has ended", "start it again, and make a new client")

    def _run(self) -> None:
        try:
            with self.socket.makefile("rb") as lines:
                for line in lines:
                    self._received(json.loads(line))
        except (OSError, ValueError):
            pass
        finally:  # also where a message lacks a part
            self.gone = True
            for reply in [*self.waiting.values(), *self.strokes.values()]:
                reply._end(None, self._gone())

    def _received(self, message: dict[str, _t.Any]) -> None:
        if message.get("method") == "stroke":
            stroke = self.strokes.get(message["params"]["stroke"])
            if stroke is not None:
                stroke._take_event(message["params"])
            return
        number = message.get("id")
        if number is None and "error" in message:
            self.refusal = _refused(message["error"])
        reply = self.waiting.get(number or 0)
        if reply is None:
            return
        if "error" in message:
            reply._end(None, _refused(message["error"]))
        else:
            reply._take(message["result"])
        self.waiting.pop(number or 0, None)

    def close(self) -> None:
        if os.getpid() != self.owner:
            return
        self.closed_here = True
        try:
            self.socket.shutdown(_socket.SHUT_RDWR)
        except OSError:
            pass
        if threading.current_thread() is not self.thread:
            self.thread.join()
        self.socket.close()


def _refused(error: dict[str, _t.Any]) -> Error:
    data: dict[str, str] = error["data"]
    kind: type[Error] = _KINDS.get(data["kind"], StreamError)
    return kind(data["what"], data["why"], data["hint"], field=data["what"].rpartition(".")[2] or None)


def _connected(socket: str | os.PathLike[str] | None, tcp: str | None) -> _Connection:
    """Connects to the service at that socket or address, or to the first that listens: the user's, then the system's."""
    if tcp is not None:
        if socket is not None:
            raise InputError("tcp", "it cannot be combined with socket", "give one of them", field="tcp")
        return _Connection(tcp, _parse_address(tcp))
    if socket is not None:
        return _Connection(os.fspath(socket))
    folder = os.environ.get("XDG_RUNTIME_DIR")
    places = [f"{folder}/tactor.sock"] if folder else []
    first: Error | None = None
    for place in (*places, "/run/tactor.sock", "/run/tactor/tactor.sock"):
        try:
            return _Connection(place)
        except DeviceError as e:
            first = first or e
    assert first is not None
    raise first


class Client(_Unique):
    """Draws through `tactor serve`, with or without asyncio: tactor-protocol(7).

    Requests are sent at once. Await what a method returns, or call its `wait`::

        async with tactor.Client() as c:
            await c.play(stroke)

        with tactor.Client() as c:
            c.play(stroke).wait()

    Parameters
    ----------
    socket : path-like, optional
        The service's Unix socket; default: where a user's service listens ($XDG_RUNTIME_DIR/tactor.sock), else the system's.
    tcp : str, optional
        In its place the address of `tactor serve --tcp`, "HOST:PORT"; the service may be on another computer.
    token : str, optional
        The token that the service needs there: the first line of its token_file.

    Raises
    ------
    DeviceError
        When nobody listens there; a missing socket is a FileNotFoundError, too.
    StreamError
        For a token that is wrong or owed.
    """

    def __init__(self, socket: str | os.PathLike[str] | None = None, *, tcp: str | None = None, token: str | None = None) -> None:
        if token is not None:
            _need(token, str, "token")
        self._wire = _connected(socket, tcp)
        try:
            self._hello: dict[str, _t.Any] = self.call("hello", **({} if token is None else {"token": token})).wait(_HELLO_S)
        except BaseException:
            self._wire.close()
            raise

    @property
    def hello(self) -> dict[str, _t.Any]:
        """The service's greeting (protocol, version, array, stream, presets, clock and max_level_dbfs)."""
        return dict(self._hello)

    @property
    def closed(self) -> bool:
        """True once it was closed, or the service has gone."""
        return self._wire.gone

    def call(self, method: str, **params: _t.Any) -> Reply:
        """Calls any method of the protocol, with its parameters; gives its result as JSON has it."""
        _need(method, str, "method")
        return self._wire.ask(Reply(self), method, params)

    def play(self, stroke: _t.Union[Stroke, Path, str], *, start: _t.Union[str, dict[str, float]] = "now", at_s: float | None = None,
             delay: float | None = None, **options: _t.Any) -> RemoteStroke:
        """Plays a stroke.

        Parameters
        ----------
        stroke : Stroke, Path or str
            A text is the name of a preset.
        start : str or dict
            "now", "armed", or as the protocol has it.
        at_s : float, optional
            Time at which the first sample is to be at the DAC, s of CLOCK_MONOTONIC (`time.monotonic()`).
        delay : float, optional
            The same, counted from when the service has the stroke, s.
        options
            Keyword arguments as in `plan`: algorithm, phantom, soa, duration, level_dbfs, ..., except fit, fit_margin, texture, texture_mm,
            tukey_part and rate. Options that are not given have the owner's values.

        Returns
        -------
        RemoteStroke
            It gives a `Report`.

        Raises
        ------
        StreamError
            When the service has gone.
        """
        given = [value for value in (at_s, delay) if value is not None]
        if len(given) > 1 or (given and start != "now"):
            raise InputError("start", "several starts are given", "give one of start, at_s and delay", field="start")
        if at_s is not None:
            start = {"monotonic_s": _number("at_s", at_s)}
        elif delay is not None:
            start = {"delay_s": _number("delay", delay)}
        return self._wire.ask(RemoteStroke(self), "play", {**_source(stroke), "options": _option_values(options), "start": start})

    def plan(self, stroke: _t.Union[Stroke, Path, str], **options: _t.Any) -> Reply:
        """Plans a stroke as `play` would, and plays nothing; gives a `Plan`."""
        return self._wire.ask(Reply(self, Plan.from_dict), "plan", {**_source(stroke), "options": _option_values(options)})

    def live(self, *, timeout: float | None = None, smooth: float | None = None, **options: _t.Any) -> RemoteLive:
        """Begins a stroke that is fed point by point; silent until the first. Blocks until the service has answered.

        Parameters
        ----------
        timeout : float, optional
            A producer that gives no point for so long, s, has failed: it fades out, interrupted (0.5).
        smooth : float, optional
            For points that come in bursts, s, 0 (off) to 1.
        options
            Keyword arguments as in `Player.live`, except texture, tukey_part and longest. Options that are not given have the owner's values.

        Returns
        -------
        RemoteLive

        Raises
        ------
        Error
            What the service refuses it with.
        """
        params: dict[str, _t.Any] = {"options": _option_values(options)}
        if timeout is not None:
            params["timeout_s"] = _number("timeout", timeout)
        if smooth is not None:
            params["smooth_s"] = _number("smooth", smooth)
        stroke = RemoteLive(self)
        self._wire.ask(Reply(self, stroke._take), "begin", params).wait()
        return stroke

    def drive(self, tactor: int, intensity: float = 1.0, duration: float = 0.5) -> RemoteStroke:
        """Drives one tactor for a while, s, at an intensity of 0 to 1; gives a `Report`."""
        params = {"tactor": _whole("tactor", tactor, 0, 1023), "intensity": _number("intensity", intensity, 0.0, 1.0),
                  "duration_s": _number("duration", duration, 0.0)}
        return self._wire.ask(RemoteStroke(self), "drive", params)

    def stop(self) -> Reply:
        """Fades everybody's strokes out; the service goes on."""
        return self.call("stop")

    def fire(self) -> Reply:
        """Starts everybody's armed strokes; gives their count."""
        return self._wire.ask(Reply(self, lambda result: result["count"]), "fire", {})

    def status(self) -> Reply:
        """Asks for the state of the service: a dict with stream, amplifier, clients, strokes and limits."""
        return self.call("status")

    def close(self) -> None:
        """Leaves the service: live strokes end, what was asked to be played is played."""
        self._wire.close()

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    async def __aenter__(self) -> Client:
        return self

    async def __aexit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        wire = getattr(self, "_wire", None)
        if wire is not None and not sys.is_finalizing():
            wire.close()

    def __repr__(self) -> str:
        return f"<tactor.Client: {'closed' if self.closed else self._wire.path}>"


def _source(stroke: _t.Any) -> dict[str, str]:
    if isinstance(stroke, Stroke):
        return {"toml": stroke._core.text()}
    if isinstance(stroke, Path):
        return {"path": stroke.data}
    if isinstance(stroke, str):
        return {"stroke": stroke}
    raise TypeError(f"stroke: it must be a Stroke, a Path or the name of a preset, not {type(stroke).__name__}")


def _option_values(options: dict[str, _t.Any]) -> dict[str, _t.Any]:
    """Returns the options that are set, in JSON's types."""
    values = {}
    for name, value in options.items():
        if value is None:
            continue
        if hasattr(value, "weights"):
            raise InputError(name, f"{_shown(value)} exists only in this process", "use a built-in model", field=name)
        values[name] = value.item() if hasattr(value, "item") else value
    return values
