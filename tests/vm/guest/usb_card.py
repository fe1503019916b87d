# SPDX-License-Identifier: MIT
"""A USB Audio Class 2 card in software, for Linux's own driver (snd-usb-audio).

The kernel's vhci-hcd takes one end of a socket pair as a USB port; UsbCard answers at the other end, by the protocol of
USB/IP. Its pace is the card's clock. It keeps each byte that the driver sends, and when it took it.
"""
import bisect
import contextlib
import errno
import functools
import os
import pathlib
import random
import select
import socket
import struct
import threading
import time
from typing import NamedTuple

PORTS = pathlib.Path("/sys/devices/platform/vhci_hcd.0")
RATE, PACKETS_S = 48000, 8000  # frames and high-speed packets a second
HIGH_SPEED, FREE = 3, "004"
SUBMIT, UNLINK, SUBMITTED, UNLINKED = 1, 2, 3, 4
STREAM, FEEDBACK = 1, 1  # endpoints to the card, and from it
FEEDBACK_PACKETS = 8  # high-speed packets between two values
CLOCK = 0x10  # the clock's entity
GET, GET_CLASS = 0x80, 0xA1
DEVICE = bytes([18, 1, 0, 2, 0xEF, 2, 1, 64]) + struct.pack("<HHHBBBB", 0x1209, 0x7AC7, 0x100, 1, 2, 0, 1)
QUALIFIER = bytes([10, 6, 0, 2, 0xEF, 2, 1, 64, 1, 0])


def configuration(channels, bits, feedback):
    """Returns the descriptors (Audio Device Class 2.0, chapter 4): a clock, an output terminal, and one stream to it."""
    size = bits // 8
    control = (bytes([8, 0x24, 0x0A, CLOCK, 1, 1, 0, 0])
               + bytes([17, 0x24, 2, 1]) + struct.pack("<HBBBIBHB", 0x0101, 0, CLOCK, channels, 0, 0, 0, 0)
               + bytes([12, 0x24, 3, 2]) + struct.pack("<HBBBHB", 0x0301, 0, 1, CLOCK, 0, 0))
    most = (RATE // PACKETS_S + 1) * channels * size
    body = (bytes([8, 0x0B, 0, 2, 1, 0, 0x20, 0])
            + bytes([9, 4, 0, 0, 0, 1, 1, 0x20, 0])
            + bytes([9, 0x24, 1, 0, 2, 1]) + struct.pack("<HB", 9 + len(control), 0) + control
            + bytes([9, 4, 1, 0, 0, 1, 2, 0x20, 0])
            + bytes([9, 4, 1, 1, 1 + feedback, 1, 2, 0x20, 0])
            + bytes([16, 0x24, 1, 1, 0, 1]) + struct.pack("<IBIB", 1, channels, 0, 0)
            + bytes([6, 0x24, 2, 1, size, bits])
            + bytes([7, 5, STREAM, 0x05 if feedback else 0x09]) + struct.pack("<HB", most, 1)  # isochronous; asynchronous or adaptive
            + bytes([8, 0x25, 1, 0, 0, 0, 0, 0])
            + bytes([7, 5, 0x80 | FEEDBACK, 0x11, 4, 0, FEEDBACK_PACKETS.bit_length()]) * feedback)
    return bytes([9, 2]) + struct.pack("<HBBBBB", 9 + len(body), 2, 1, 0, 0xC0, 0) + body


@functools.lru_cache
def answered(packets, status=0):
    """Returns the reply's packets to a request's: all of each was taken. Most requests have the same, so the answer is quick."""
    return b"".join(struct.pack(">IIIi", offset, length, 0 if status else length, status)
                    for offset, length, _, _ in struct.iter_unpack(">IIII", packets))


class Transfer(NamedTuple):
    """Packets that the driver sent together, when the card plays them, and when it answers. Without data: those for feedback."""
    begin_s: float
    answer_s: float
    number: int
    data: bytes
    packets: bytes


class UsbCard:
    """A card with one output.

    `ppm`: how much faster its clock is than CLOCK_MONOTONIC. `pause`: (frame, seconds) at which it stands still, once.
    `feedback`: the card tells the driver its clock, and packets come at the pace of the bus; otherwise it takes frames at its
    own pace. `refused`: (frame, number of transfers) that it answers with a bus error, and does not play. `name`: of the product.
    `jitter_s`: by how much its answers to the driver are late, at most, and not its clock.
    """

    def __init__(self, channels, bits, ppm=0.0, pause=None, feedback=False, refused=None, name=None, jitter_s=0.0):
        self.channels = channels
        self.frame = channels * bits // 8
        self.name = name or f"USB{channels}x{bits}"
        self.frame_s = 1 / RATE / (1 + 1e-6 * ppm)
        self.feedback = feedback
        self.configuration = configuration(channels, bits, feedback)
        self.data = bytearray()
        self.sound = None  # first frame of the transfer in which the sound begins
        self.began = []  # (first frame, time in s) of each transfer
        self.pause = pause
        self.jitter_s = jitter_s
        self.random = random.Random(1)
        self.refused = refused
        self.lost = []  # (place in frames, number of frames) of each transfer that was refused
        self.packets = 0  # of the data
        self.ends_s = self.answers_s = self.told_s = 0.0  # end of the last transfer, its answer, and end of the last feedback
        self.queue = []

    def plug_in(self):
        ports = [line.split() for line in (PORTS / "status").read_text(encoding="ascii").splitlines()]
        port = next(int(number) for hub, number, state, *_ in ports if (hub, state) == ("hs", FREE))
        self.socket, kernels = socket.socketpair()
        with kernels:
            (PORTS / "attach").write_text(f"{port} {kernels.fileno()} {0x10000 + port} {HIGH_SPEED}", encoding="ascii")
        for comm in pathlib.Path("/proc").glob("[0-9]*/comm"):
            if comm.read_text(encoding="ascii").startswith("vhci_"):  # no real host controller waits for a processor, either
                os.sched_setscheduler(int(comm.parent.name), os.SCHED_FIFO, os.sched_param(89))
        self.thread = threading.Thread(target=self.serve, daemon=True)
        self.thread.start()

    def pull_out(self):
        with contextlib.suppress(OSError):  # pulled out before
            self.socket.shutdown(socket.SHUT_RDWR)
        self.thread.join()
        self.socket.close()

    def heard(self):
        """Returns how many frames the card has received since the sound began."""
        return 0 if self.sound is None else len(self.data) // self.frame - self.sound

    def find_time(self, frame):
        """Returns when the card played a frame: CLOCK_MONOTONIC, in s."""
        first, began_s = self.began[bisect.bisect(self.began, (frame, float("inf"))) - 1]
        return began_s + (frame - first) * self.frame_s

    def serve(self):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(90))  # a card waits for no processor
        with contextlib.suppress(EOFError, BrokenPipeError, ConnectionResetError):
            while True:
                wait_s = max(0.0, self.queue[0].answer_s - time.monotonic()) if self.queue else None
                if select.select([self.socket], [], [], wait_s)[0]:
                    self.answer()
                while self.queue and self.queue[0].answer_s <= time.monotonic():
                    self.complete(self.queue.pop(0))

    def receive(self, count):
        data = self.socket.recv(count, socket.MSG_WAITALL) if count else b""
        if len(data) < count:
            raise EOFError
        return data

    def reply(self, number, status, length=0, data=b"", packets=0):
        self.socket.sendall(struct.pack(">IIIIIiiiii8x", SUBMITTED, number, 0, 0, 0, status, length, 0, packets, 0) + data)

    def answer(self):
        """Reads one request, and answers it unless the card plays it later."""
        command, number, _, inwards, endpoint, victim, length, _, packets, _, setup = struct.unpack(">IIIIIIiiiI8s", self.receive(48))
        if command == UNLINK:
            waiting = [t for t in self.queue if t.number != victim]
            found = len(waiting) < len(self.queue)
            self.queue = waiting
            if not waiting:
                self.ends_s = self.answers_s = self.told_s = 0.0
            self.socket.sendall(struct.pack(">IIIIIi24x", UNLINKED, number, 0, 0, 0, -errno.ECONNRESET if found else 0))
            return
        data = b"" if inwards else self.receive(length)
        if packets > 0 and inwards:
            places = self.receive(16 * packets)
            begin_s = max(self.told_s, time.monotonic())
            self.told_s = begin_s + packets * FEEDBACK_PACKETS / PACKETS_S
            self.insert(Transfer(begin_s, self.told_s, number, b"", places))
            return
        if packets > 0:
            places = self.receive(16 * packets)
            begin_s = max(self.ends_s, time.monotonic())
            if self.pause and len(self.data) >= self.pause[0] * self.frame:
                begin_s += self.pause[1]
                self.pause = None
            self.ends_s = begin_s + (packets / PACKETS_S if self.feedback else len(data) // self.frame * self.frame_s)
            # The next transfer begins in time: only the answer is late.
            self.answers_s = max(self.answers_s, self.ends_s + self.random.uniform(0, self.jitter_s))
            self.insert(Transfer(begin_s, self.answers_s, number, data, places))
            return
        kind, request, value, _, most = struct.unpack("<BBHHH", setup)
        answer = self.control(kind, request, value) if endpoint == 0 else None
        if answer is None:
            self.reply(number, -errno.EPIPE)
        else:
            self.reply(number, 0, len(answer[:most]) if inwards else length, answer[:most])

    def insert(self, transfer):
        bisect.insort(self.queue, transfer, key=lambda t: t.answer_s)

    def complete(self, transfer):
        count = len(transfer.packets) // 16
        if not transfer.data:
            frames = struct.pack("<I", round((1 << 16) / self.frame_s / PACKETS_S))
            self.reply(transfer.number, 0, 4 * count, frames * count + answered(transfer.packets), count)
            return
        self.packets += count
        if self.refused and self.refused[1] and len(self.data) >= self.refused[0] * self.frame:
            self.refused = self.refused[0], self.refused[1] - 1
            self.lost.append((len(self.data) // self.frame, len(transfer.data) // self.frame))
            self.reply(transfer.number, -errno.EPROTO, 0, answered(transfer.packets, -errno.EPROTO), count)
            return
        self.began.append((len(self.data) // self.frame, transfer.begin_s))
        if self.sound is None and transfer.data.strip(b"\0"):
            self.sound = len(self.data) // self.frame
        self.data += transfer.data  # the packets lie without gaps
        self.reply(transfer.number, 0, len(transfer.data), answered(transfer.packets), count)

    def control(self, kind, request, value):
        """Returns the answer to a request of the control endpoint (USB 2.0, 9.4; Audio Device Class 2.0, 5.2); None refuses it."""
        if kind == GET and request == 6:
            return {1: DEVICE, 2: self.configuration, 3: self.text(value & 255), 6: QUALIFIER}.get(value >> 8)
        if kind == GET_CLASS and request in (1, 2):
            frequency = value >> 8 == 1
            return struct.pack("<HIII", 1, RATE, RATE, 0) if request == 2 else struct.pack("<I", RATE) if frequency else b"\1"
        answers = {(GET, 0): b"\1\0", (GET | 1, 10): b"\0"}
        return answers.get((kind, request)) if kind & 0x80 else b""

    def text(self, index):
        text = {1: "Tactor", 2: self.name}.get(index, "").encode("utf-16-le")
        return bytes([4, 3, 9, 4]) if index == 0 else bytes([2 + len(text), 3]) + text
