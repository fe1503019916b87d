# SPDX-License-Identifier: MIT
"""A client of HTTP and of WebSockets (RFC 6455) that shows the bytes on the wire; uses only Python's standard library."""
import base64
import hashlib
import os
import socket
import struct

from harness import PATIENCE_S

GUID = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
CONTINUATION, TEXT, BINARY, CLOSE, PING, PONG = 0, 1, 2, 8, 9, 10


def framed(kind, payload=b"", last=True, masked=True):
    size = len(payload)
    head = bytes([kind | (0x80 if last else 0)])
    mask = 0x80 if masked else 0
    if size < 126:
        head += bytes([mask | size])
    elif size < 65536:
        head += struct.pack("!BH", mask | 126, size)
    else:
        head += struct.pack("!BQ", mask | 127, size)
    if not masked:
        return head + payload
    secret = os.urandom(4)
    return head + secret + bytes(b ^ secret[i % 4] for i, b in enumerate(payload))


class Peer:
    """A connection to host:port, byte by byte."""

    def __init__(self, address):
        host, _, port = address.rpartition(":")
        self.socket = socket.create_connection((host, int(port)), PATIENCE_S)
        self.buffer = b""
        self.reason = None

    def send(self, data):
        self.socket.sendall(data)

    def take(self, n):
        while len(self.buffer) < n:
            try:
                more = self.socket.recv(65536)
            except ConnectionResetError:
                more = b""
            if not more:
                raise EOFError
            self.buffer += more
        taken, self.buffer = self.buffer[:n], self.buffer[n:]
        return taken

    def head(self):
        text = b""
        while not text.endswith(b"\r\n\r\n"):
            text += self.take(1)
        lines = text.decode().split("\r\n")[:-2]
        return int(lines[0].split()[1]), {k.lower(): v.strip() for k, _, v in (line.partition(":") for line in lines[1:])}

    def request(self, target="/", method="GET", host=None, **headers):
        peer = "{}:{}".format(*self.socket.getpeername()[:2])
        lines = [f"{method} {target} HTTP/1.1", f"Host: {host or peer}"]
        lines += [f"{k.replace('_', '-')}: {v}" for k, v in headers.items()]
        self.send("\r\n".join(lines).encode() + b"\r\n\r\n")
        return self.head()

    def body(self, headers):
        return self.take(int(headers.get("content-length", 0)))

    # WebSocket.

    def upgrade(self, target="/rpc", **headers):
        key = base64.b64encode(os.urandom(16))
        status, said = self.request(target, Upgrade="websocket", Connection="Upgrade", Sec_WebSocket_Version="13",
                                    Sec_WebSocket_Key=key.decode(), **headers)
        if status == 101:
            assert said["sec-websocket-accept"] == base64.b64encode(hashlib.sha1(key + GUID).digest()).decode()
        return status

    def frame(self, kind, payload=b"", last=True, masked=True):
        self.send(framed(kind, payload, last, masked))

    def next_frame(self):
        first, second = self.take(2)
        assert second < 0x80, "a server masks nothing"
        size = second
        if size == 126:
            size, = struct.unpack("!H", self.take(2))
        elif size == 127:
            size, = struct.unpack("!Q", self.take(8))
        self.is_last = bool(first & 0x80)
        return first & 0x0F, self.take(size)

    def text(self):
        """Returns the next message of text; answers pings as a browser does."""
        pieces = []
        while True:
            kind, payload = self.next_frame()
            if kind == PING:
                self.frame(PONG, payload)
            if kind == CLOSE:
                raise EOFError(payload)
            if kind in (TEXT, CONTINUATION):
                pieces.append(payload)
                if self.is_last:
                    return b"".join(pieces)

    def end(self):
        """Returns the close frame's code; None for none. Its text is then in `reason`."""
        try:
            while True:
                kind, payload = self.next_frame()
                if kind == CLOSE:
                    self.reason = payload[2:].decode()
                    return struct.unpack("!H", payload[:2])[0] if payload else None
        except EOFError:
            return None
