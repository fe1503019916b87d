# SPDX-License-Identifier: MIT
"""Machines with PipeWire in network namespaces, for rtp.py."""
import fcntl
import os
import pathlib
import re
import shutil
import subprocess
import threading
import time

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples/rtp"
# Hz, channels, bytes of 12 floats, frames of a cycle: as the examples say.
RATE, HALF, FRAME, CYCLE = 48000, 12, 48, 480
NAMES = [f"AUX{i}" for i in range(HALF)]
CARD = ("context.objects = [ { factory = adapter args = { factory.name = support.null-audio-sink node.name = card media.class = Audio/Sink "
        f"audio.channels = {HALF} audio.position = [ {' '.join(NAMES)} ] monitor.channel-volumes = false }} }} ]")


def wait_for(condition, what, seconds=30.0):
    end = time.monotonic() + seconds
    while not (value := condition()):
        if time.monotonic() > end:
            raise TimeoutError(what)
        time.sleep(0.01)
    return value


def run(*command):
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=True).stdout


def ends(data, frame=FRAME):
    """Returns the frame with the first sound, and the one after the last."""
    return (len(data) - len(data.lstrip(b"\0"))) // frame, -(-len(data.rstrip(b"\0")) // frame)


class Machine:
    """A network namespace with a PipeWire of its own; a cable leads from its eth0 to the switch."""

    def __init__(self, folder, name, address):
        self.name, self.folder = name, folder / name
        conf = self.folder / ".config/pipewire"
        for part in ("pipewire", "client"):
            (conf / f"{part}.conf.d").mkdir(parents=True)
        shutil.copy(EXAMPLES / f"{name}.conf", conf / "pipewire.conf.d")
        if name == "sender":
            shutil.copy(EXAMPLES / "client.conf", conf / "client.conf.d")
        else:
            (conf / "pipewire.conf.d/card.conf").write_text(CARD, encoding="ascii")
        holder, here = subprocess.Popen(["unshare", "--net", "sleep", "infinity"]), os.readlink("/proc/self/ns/net")
        wait_for(lambda: os.readlink(f"/proc/{holder.pid}/ns/net") != here, "no namespace")
        self.prefix = ["nsenter", "-t", str(holder.pid), "-n"]
        run("ip", "link", "add", "name", name, "type", "veth", "peer", "name", "eth0", "netns", str(holder.pid))
        run("ip", "link", "set", "dev", name, "master", "switch", "up")
        for command in ("link set dev lo up", "link set dev eth0 up", f"addr add {address}/24 dev eth0", "route add default dev eth0"):
            run(*self.prefix, "ip", *command.split())
        self.env = {k: v for k, v in os.environ.items() if not k.startswith(("PIPEWIRE", "XDG", "DBUS", "TACTOR"))}
        self.env |= {"XDG_RUNTIME_DIR": str(self.folder), "HOME": str(self.folder), "LC_ALL": "C",
                     "DBUS_SESSION_BUS_ADDRESS": f"unix:path={self.folder}/bus"}
        self.start("dbus-daemon", "--session", "--nofork", f"--address=unix:path={self.folder}/bus")
        wait_for((self.folder / "bus").exists, "no bus")
        self.start("ptp4l", "-f", str(EXAMPLES / "ptp4l.conf"), "-i", "eth0", "-m", *(["-s"] if name != "sender" else []), "--free_running=1",
                   f"--uds_address={self.folder}/ptp", f"--uds_ro_address={self.folder}/ptp-ro")
        self.begin()

    def start(self, *command, **more):
        with open(self.folder / f"{pathlib.Path(command[0]).name}.log", "ab") as log:
            out = {"stdout": log, "stderr": log} | more
            return subprocess.Popen([*self.prefix, *command], env=self.env, stdin=subprocess.DEVNULL, **out)

    def begin(self):
        self.servers = [self.start("pipewire")]
        wait_for(lambda: "tactor-rtp" in self.says("pw-dump"), f"{self.name}: RTP is not there")
        self.servers.append(self.start("wireplumber"))
        option, line = ("-i", "tactor-rtp:send_AUX23") if self.name == "sender" else ("-l", f"card:playback_AUX{HALF - 1}\n  |<- tactor-rtp")
        wait_for(lambda: line in self.says("pw-link", option), f"{self.name}: RTP is not linked")

    def kill(self):
        for process in self.servers:
            process.kill()
            process.wait()

    def says(self, *command):
        """Returns the output of a command; nothing where it fails, as it does while the server starts."""
        r = subprocess.run([*self.prefix, *command], env=self.env, capture_output=True, text=True, timeout=60, check=False)
        return r.stdout if r.returncode == 0 else ""

    def log(self, program, pattern):
        return re.findall(pattern, (self.folder / f"{program}.log").read_text(encoding="utf-8", errors="replace"))

    def late(self):
        """Returns how many cycles were not ready in time, as the log says."""
        return len(self.log("pipewire", "graph xrun"))

    def missing(self):
        """Returns how many packets the log of the receiver counts as missing."""
        return sum((int(a) - int(b)) % 65536 for a, b in self.log("pipewire", r"unexpected seq \((\d+) != (\d+)\)"))


class Recording(threading.Thread):
    """Reads the frames that the card of a machine plays, with the arrival time of each piece."""

    def __init__(self, machine):
        super().__init__(daemon=True)
        self.data, self.dropped, self.marks, self.lock = bytearray(), 0, [], threading.Lock()
        # The only thread of pw-record is an ordinary one, which loses cycles where others work. The pipe holds 0.4 s.
        self.recorder = machine.start(
            "chrt", "-f", "50", "pw-record", "--target", "card", "-P", "{ stream.capture.sink=true stream.dont-remix=true }",
            "--rate", str(RATE), "--channels", str(HALF), "--channel-map", ",".join(NAMES), "--format", "f32", "--latency", str(CYCLE), "--raw", "-",
            stdout=subprocess.PIPE)
        fcntl.fcntl(self.recorder.stdout, fcntl.F_SETPIPE_SZ, 1 << 20)
        self.start()
        wait_for(lambda: f"|-> pw-record:input_AUX{HALF - 1}" in machine.says("pw-link", "-l") and self.marks, "pw-record is not linked")

    def run(self):
        while piece := os.read(self.recorder.stdout.fileno(), 1 << 20):
            with self.lock:
                self.data += piece
                self.marks.append((self.dropped + len(self.data), time.monotonic()))

    def drop(self):
        with self.lock:
            whole = len(self.data) // FRAME * FRAME
            self.dropped += whole
            del self.data[:whole], self.marks[:-1]

    def sound(self):
        """Returns the sound from its first frame to its last, and the monotonic times at which these were played, in s."""
        half_second = RATE // 2 * FRAME
        wait_for(lambda: len(self.data) > half_second and not any(self.data[-half_second:]), "no silence")
        with self.lock:
            data, marks = bytes(self.data), self.marks[1:]
        first, end = ends(data)
        # A cycle's samples come when the cycle begins, some later because of other work: the earliest tell.
        came = [(t, (b - self.dropped) / FRAME) for b, t in marks]
        zero = min(t - frame / RATE for t, frame in came if first < frame <= end + CYCLE) + CYCLE / RATE
        return data[first * FRAME:end * FRAME], zero + first / RATE, zero + end / RATE
