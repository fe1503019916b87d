# SPDX-License-Identifier: MIT
"""Strokes through `tactor serve --tcp 4001` as a device of PsychoPy 2024.1 or later, by the published interface of its devices.

Tested with a stand-in for PsychoPy; not tried with PsychoPy itself. Needs nothing but PsychoPy, on any system: the service runs on
Linux, on this computer or another one.

    from psychopy.hardware import DeviceManager
    tactor = DeviceManager.addDevice("psychopy_tactor.TactorDevice", "tactor", port=4001)
    stroke = tactor.play(stroke="park2016-1", options={"duration": 0.5})
    report = tactor.wait(stroke)         # report["state"], report["onset_s"] by core.getTime(), report["within_s"]
"""
import json
import socket

from psychopy.core import getTime
from psychopy.hardware.base import BaseDevice

READINGS = 10  # of the service's clock, of which the quickest counts
SILENCE_S = 5  # after which the service counts as away


class TactorDevice(BaseDevice, aliases=["tactor"]):
    def __init__(self, host="127.0.0.1", port=4001, token=None):
        self.host, self.port = host, int(port)
        self.token = {} if token is None else {"token": token}
        self._calls = 0
        self._received = b""
        self._ends = {}
        try:
            self._socket = socket.create_connection((self.host, self.port), SILENCE_S)
        except OSError as e:
            raise ConnectionError(f"tactor: {host}:{port}: {e} (start tactor serve --tcp {port})") from e
        self._socket.settimeout(1)
        self._hello()

    def isSameDevice(self, other):
        if not isinstance(other, dict):
            other = {"host": getattr(other, "host", None), "port": getattr(other, "port", None)}
        return (other.get("host"), other.get("port")) == (self.host, self.port)

    @staticmethod
    def getAvailableDevices():
        """Returns the service of this computer, if it runs at its usual port."""
        try:
            socket.create_connection(("127.0.0.1", 4001), 1).close()
        except OSError:
            return []
        return [{"deviceName": "tactor", "host": "127.0.0.1", "port": 4001}]

    def call(self, method, **params):
        """Returns the result of a method of tactor-protocol(7). Raises ValueError with the service's text."""
        call = self._send(method, params)
        while (reply := self._receive()).get("id") != call:
            pass
        if "error" in reply:
            raise ValueError(f"tactor: {reply['error']['message']}")
        return reply["result"]

    def play(self, **params):
        """Returns the number of the stroke. Takes the parameters of `play`: stroke, path, points, ..., options, start."""
        return self.call("play", **params)["stroke"]

    def wait(self, stroke):
        """Returns how a stroke ended, once it has, with its onset at the DAC by core.getTime() and the greatest error of that, s."""
        while stroke not in self._ends:
            self._receive()
        report = self._ends.pop(stroke)
        ahead, within = self._read_clock()
        started = report["started_s"]
        return {**report, "onset_s": None if started is None else started - ahead, "within_s": within}

    def stop(self):
        """Fades everybody's strokes."""
        self.call("stop")

    def close(self):
        """Fades this client's strokes, which would play on, and ends the connection. DeviceManager calls it."""
        try:
            self.call("cancel", all=True)
        except OSError:
            pass  # the service has gone, and the strokes with it
        self._socket.close()

    def _hello(self):
        return self.call("hello", name="PsychoPy", **self.token)

    def _read_clock(self):
        """Returns how far the service's clock is ahead of PsychoPy's, and the greatest error, s."""
        ahead, within = 0.0, float("inf")
        for _ in range(READINGS):
            before = getTime()
            theirs = self._hello()["clock"]["monotonic_s"]
            after = getTime()
            if (after - before) / 2 < within:
                ahead, within = theirs - (before + after) / 2, (after - before) / 2
        return ahead, within

    def _send(self, method, params):
        self._calls += 1
        message = {"jsonrpc": "2.0", "id": self._calls, "method": method, "params": params}
        self._socket.sendall(json.dumps(message).encode() + b"\n")
        return self._calls

    def _receive(self):
        """Returns the next message; keeps the ends of strokes. Raises ConnectionError if the service is away."""
        silence_s = 0
        while b"\n" not in self._received:
            try:
                more = self._socket.recv(65536)
            except socket.timeout:
                silence_s += 1
                if silence_s >= SILENCE_S:
                    self._socket.close()
                    raise ConnectionError(f"tactor: the service has not answered for {SILENCE_S} s") from None
                self._send("status", {})  # a stroke may last long: ask whether the service is there
                continue
            if not more:
                raise ConnectionError("tactor: the service closed the connection")
            self._received += more
            silence_s = 0
        line, _, self._received = self._received.partition(b"\n")
        message = json.loads(line)
        if message.get("method") == "stroke" and message["params"]["state"] != "started":
            self._ends[message["params"]["stroke"]] = message["params"]
        return message
