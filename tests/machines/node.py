# SPDX-License-Identifier: MIT
"""A virtual machine of clocks.py, which has two: a card, a clock, an amplifier and half of an array."""
import contextlib
import ctypes
import json
import mmap
import os
import pathlib
import re
import socket
import subprocess
import sys
import threading
import time

from namespaces import ends, wait_for

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests/vm/guest"), str(ROOT / "examples/python")]
import two_machines  # noqa: E402
from rig import TOOL, GpioSim, wav_data  # noqa: E402

ADDRESSES = {"left": "10.25.0.1", "right": "10.25.0.2"}
AGENT, ECHO, RPC, OSC = 9001, 9002, 4001, 4002
RATE, HALF, FRAME = 48000, 10, 40  # Hz, channels, bytes of ten samples
STROKE = "M 0 30 H 80"  # between the halves: both vibrate from the first sample
STATUS = pathlib.Path("/proc/asound/Tactor/pcm0p/sub0/status")
RUN = pathlib.Path("/run/tmp")
ARRAY = """[array]
name = "both"
grid = { rows = 4, columns = 5, pitch_mm = 20.0 }
[output]
period_frames = 480
periods = 8
[amplifier]
line = { chip = "tactor-sim-1", offset = 2 }
[defaults]
speed = 200
"""
SERVE = f"""[serve]
tcp = "0.0.0.0:{RPC}"
osc = "0.0.0.0:{OSC}"
osc_peers = ["10.25.0.0/24", "127.0.0.1"]
token_file = "{RUN}/token"
idle_stop_s = 4
"""
RECORDED = f"""pcm.recorded {{ type file slave.pcm "hw:CARD=Tactor" file "{RUN}/played.raw" format raw }}
"""


class Counter:
    """The processor's time stamp counter."""

    def __init__(self):
        # rdtsc; shl $32, %rdx; or %rdx, %rax; ret
        code = b"\x0f\x31\x48\xc1\xe2\x20\x48\x09\xd0\xc3"
        self.page = mmap.mmap(-1, mmap.PAGESIZE, prot=mmap.PROT_READ | mmap.PROT_WRITE | mmap.PROT_EXEC)
        self.page.write(code)
        self.read = ctypes.CFUNCTYPE(ctypes.c_uint64)(ctypes.addressof(ctypes.c_char.from_buffer(self.page)))


class Node:
    """A machine; right's is called by left, too."""

    def __init__(self, role):
        self.role, self.processes, self.samples, self.seen = role, {}, [], []
        kernel = re.search(r"kernel_root=(\S+)", pathlib.Path("/proc/cmdline").read_text(encoding="ascii"))[1]
        for module in ("virtio_net", "snd-dummy index=1 id=Tactor model=ice1712 hrtimer=1 fake_buffer=0"):
            subprocess.run(["modprobe", "-d", kernel, *module.split()], check=True)
        for command in (f"addr add {ADDRESSES[role]}/24 dev eth0", "link set eth0 up"):
            subprocess.run(["ip", *command.split()], check=True)
        self.counter, self.gpio = Counter(), GpioSim()
        (RUN / "array.toml").write_text(ARRAY, encoding="ascii")
        (RUN / "token").write_text("skin-and-skin-and-skin\n", encoding="ascii")
        (RUN / "token").chmod(0o600)
        (RUN / "tactor").mkdir()
        (RUN / "tactor/tactor.toml").write_text(SERVE, encoding="ascii")
        os.chdir(RUN)
        os.environ["PATH"] += f":{TOOL.parent}"
        two_machines.split("array.toml", f"left=0-{HALF - 1}", f"right={HALF}-{2 * HALF - 1}")
        half = (RUN / f"{role}.asoundrc").read_text(encoding="ascii").replace("hw:CARD=Tactor", "recorded")
        (RUN / ".asoundrc").write_text(RECORDED + half, encoding="ascii")
        for what in (self.sample, self.watch):
            threading.Thread(target=what, daemon=True).start()

    def now(self):
        """Returns (counter, CLOCK_MONOTONIC, CLOCK_REALTIME), the clocks in s, of the same moment within some microseconds."""
        tried = []
        for _ in range(5):
            before, monotonic, real, after = self.counter.read(), time.monotonic(), time.time(), self.counter.read()
            tried.append((after - before, before, monotonic, real))
        return min(tried)[1:]

    def sample(self):
        while True:
            self.samples.append(self.now())
            time.sleep(0.1)

    def watch(self):
        """Keeps each change of (amplifier is on, the stream runs), with its CLOCK_MONOTONIC."""
        while True:
            state = self.gpio.value(2) == 1, STATUS.read_text(encoding="ascii").startswith("state: RUNNING")
            if not self.seen or self.seen[-1][1:] != state:
                self.seen.append((time.monotonic(), *state))
            time.sleep(0.002)

    def start(self, name, *command):
        env = os.environ | {"HOME": str(RUN), "XDG_CONFIG_HOME": str(RUN), "XDG_RUNTIME_DIR": str(RUN)}
        with open(RUN / f"{name}.log", "wb") as log:
            self.processes[name] = subprocess.Popen(command, env=env, stdin=subprocess.DEVNULL, stdout=log, stderr=log)

    def serve(self):
        self.start("serve", TOOL, "serve", "--array", "array.toml", "-D", "tactor-half", "--socket", f"{RUN}/tactor.sock")

    def log(self, name):
        return (RUN / f"{name}.log").read_text(encoding="utf-8", errors="replace")

    def kill(self, name):
        self.processes[name].kill()
        self.processes[name].wait()

    def clocks(self):
        return self.samples

    def changes(self):
        return self.seen

    def trigger(self):
        """Returns the CLOCK_MONOTONIC at which the running stream began; nothing where none runs."""
        found = re.search(r"trigger_time: (\d+\.\d+)", STATUS.read_text(encoding="ascii"))
        return float(found[1]) if found else None

    def played(self):
        """Returns the first frame of each sound after 0.1 s of silence, and whether it is what `tactor render` writes of this half."""
        first, rendered = self.rendered()
        data, gap = (RUN / "played.raw").read_bytes(), RATE // 10 * FRAME
        at, found, silence = 0, [], bytes(gap)
        while at < len(data):
            piece = data[at:at + gap]
            if piece == silence[:len(piece)]:
                at += gap
                continue
            begin = at // FRAME + ends(piece, FRAME)[0]
            found.append([begin - first, data[FRAME * begin:FRAME * begin + len(rendered)] == rendered])
            at = FRAME * begin + len(rendered)
        return found

    def rendered(self):
        subprocess.run([TOOL, "render", "--array", "array.toml", "--path", STROKE, "--sample-format", "s32", "-o", "all.wav"], check=True,
                       stdout=subprocess.DEVNULL)
        data, begin = wav_data(RUN / "all.wav"), 0 if self.role == "left" else FRAME
        half = b"".join(data[i + begin:i + begin + FRAME] for i in range(0, len(data), 2 * FRAME))
        first, end = ends(half, FRAME)
        return first, half[FRAME * first:FRAME * end]

    def set_clock(self, ahead_s):
        time.clock_settime(time.CLOCK_REALTIME, time.time() + ahead_s)

    def power_off(self):
        pathlib.Path("/proc/sysrq-trigger").write_text("o", encoding="ascii")


def serve_agent(node):
    """Answers the other machine: calls of Node, an object a line, and datagrams, with this one's counter."""
    if os.fork() == 0:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(90))
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as s:
            s.bind((ADDRESSES[node.role], ECHO))
            while True:
                number, address = s.recvfrom(64)
                s.sendto(number + node.counter.read().to_bytes(8, "little"), address)
    with socket.create_server((ADDRESSES[node.role], AGENT)) as server:
        while True:
            connection, _ = server.accept()
            with connection, connection.makefile("rw", encoding="utf-8") as lines:
                for line in lines:
                    name, *args = json.loads(line)
                    lines.write(json.dumps(getattr(node, name)(*args)) + "\n")
                    lines.flush()


class Peer:
    """The Node of the other machine."""

    def __init__(self, address):
        self.address = address
        self.socket = wait_for(self.connect, "the other machine", 120)
        self.lines = self.socket.makefile("rw", encoding="utf-8")

    def connect(self):
        with contextlib.suppress(OSError):
            return socket.create_connection((self.address, AGENT), timeout=120)
        return None

    def tell(self, name, *args):
        """Calls without an answer."""
        self.lines.write(json.dumps([name, *args]) + "\n")
        self.lines.flush()

    def __getattr__(self, name):
        def call(*args):
            self.tell(name, *args)
            return json.loads(self.lines.readline())
        return call
