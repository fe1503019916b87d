#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws through `tactor serve`, beside other programs: a preset, then a circle point by point. Needs neither NumPy nor this package.

    serve_client.py [SOCKET]       default: where a user's service listens, $XDG_RUNTIME_DIR/tactor.sock
"""
import json
import math
import os
import socket
import sys
import time


class Service:
    """JSON-RPC, an object a line: tactor-protocol(7)."""

    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.connect(path)
        self.lines = self.socket.makefile("rw", encoding="utf-8", newline="\n")
        self.calls = 0
        self.ends = {}

    def send(self, **message):
        self.lines.write(json.dumps({"jsonrpc": "2.0", **message}) + "\n")
        self.lines.flush()

    def receive(self):
        """Returns the next reply; keeps ends of strokes on the way."""
        line = self.lines.readline()
        if not line:
            sys.exit("the service has gone")
        message = json.loads(line)
        if message.get("method") == "stroke" and message["params"]["state"] != "started":
            self.ends[message["params"]["stroke"]] = message["params"]
        return message

    def call(self, method, **params):
        self.calls += 1
        self.send(id=self.calls, method=method, params=params)
        while (reply := self.receive()).get("id") != self.calls:
            pass
        if "error" in reply:
            why = reply["error"]["data"]
            sys.exit(f"{why['what']}: {why['why']} ({why['hint']})")
        return reply["result"]

    def tell(self, method, **params):
        """Sends a notification, which has no reply."""
        self.send(method=method, params=params)

    def wait(self, stroke):
        while stroke not in self.ends:
            self.receive()
        return self.ends[stroke]


service = Service(sys.argv[1] if len(sys.argv) > 1 else os.environ["XDG_RUNTIME_DIR"] + "/tactor.sock")
hello = service.call("hello")
print(f"{hello['protocol']} on {hello['array']['name']}, {hello['stream']['rate']} Hz")

played = service.call("play", stroke="park2016-1", options={"algorithm": "continuous", "duration": 0.5})
end = service.wait(played["stroke"])
print(f"park2016-1: {end['state']} after {end['frames']} frames")

live = service.call("begin")["stroke"]
for i in range(100):
    angle = 2 * math.pi * i / 100
    service.tell("to", stroke=live, x_mm=20 + 10 * math.cos(angle), y_mm=20 + 10 * math.sin(angle))
    time.sleep(0.005)
service.tell("end", stroke=live)
print(f"circle: {service.wait(live)['state']}")
