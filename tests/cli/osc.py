# SPDX-License-Identifier: MIT
"""OSC 1.0 for the tests: packets written and read by hand, so that no other reader's mistakes enter."""
import socket
import struct
import time

from harness import PATIENCE_S

FROM_1900 = 2208988800


def text(s):
    data = s.encode() + b"\0"
    return data + bytes(-len(data) % 4)


def message(address, *values):
    """Encodes whole numbers as i, others as f, texts as s; (tag, bytes) unchanged."""
    tags, data = ",", b""
    for v in values:
        if isinstance(v, tuple):
            tags, data = tags + v[0], data + v[1]
        elif isinstance(v, int):
            tags, data = tags + "i", data + struct.pack(">i", v)
        elif isinstance(v, float):
            tags, data = tags + "f", data + struct.pack(">f", v)
        else:
            tags, data = tags + "s", data + text(v)
    return text(address) + text(tags) + data


def bundle(unix_s, *elements):
    """Encodes a time tag; None: at once."""
    tag = 1 if unix_s is None else round((unix_s + FROM_1900) * 2**32)
    return b"#bundle\0" + struct.pack(">Q", tag) + b"".join(struct.pack(">i", len(e)) + e for e in elements)


def read_text(data):
    end = data.index(b"\0")
    return data[:end].decode(), data[end // 4 * 4 + 4:]


def read(packet):
    """Decodes a message of i, f and s: [address, value...]."""
    assert len(packet) % 4 == 0, packet
    address, rest = read_text(packet)
    tags, rest = read_text(rest)
    found = [address]
    for tag in tags[1:]:
        if tag == "s":
            value, rest = read_text(rest)
        else:
            value, rest = struct.unpack(">" + tag, rest[:4])[0], rest[4:]
        found.append(value)
    assert tags[0] == "," and not rest, packet
    return found


class Sender:
    """A program that draws by OSC, at a separate port."""

    def __init__(self, test, server, host="127.0.0.1"):
        address, _, port = server.where["osc"].rpartition(":")
        self.to = ("127.0.0.1" if address == "0.0.0.0" else address.strip("[]"), int(port))
        self.socket = socket.socket(socket.AF_INET6 if ":" in self.to[0] else socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.settimeout(PATIENCE_S)
        self.socket.bind((host, 0))
        self.port = self.socket.getsockname()[1]
        test.addCleanup(self.socket.close)

    def raw(self, packet):
        self.socket.sendto(packet, self.to)

    def say(self, address, *values):
        self.raw(message(address, *values))

    def next(self, address=None):
        """Returns the next message, or the next to that address."""
        while True:
            found = read(self.socket.recv(65536))
            if address is None or found[0] == address:
                return found


def begun_by_a_time_tag(test, server):
    """Returns the lateness of a play, a drive and a live stroke of one bundle, s, and the time of a period, s."""
    watcher = server.watcher()
    stream = watcher.ok("hello")["stream"]
    a = Sender(test, server)
    then = time.time() + 0.6
    a.raw(bundle(then, message("/tactor/play", 1, "M 0 0 L 40 40", "duration=0.05"), message("/tactor/drive", 0, 0.5, 0.02),
                 message("/tactor/begin", 2, "timeout_s=3600"), message("/tactor/to", 2, 20, 20)))
    began = [watcher.notification(lambda m: m["params"].get("state") == "started")["params"]["started_unix_s"] - then
             for _ in range(3)]
    strokes = []  # a short one may end before another begins
    while sum(state == "started" for _, state in strokes) < 3:
        strokes.append(a.next()[1:])
    test.assertEqual(sorted(number for number, state in strokes if state == "started"), [0, 1, 2])
    return began, stream["period_frames"] / stream["rate"]
