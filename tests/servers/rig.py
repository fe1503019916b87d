# SPDX-License-Identifier: MIT
"""Sound servers of a test: PipeWire with a null sink of nine channels, JACK with its dummy driver."""
import os
import pathlib
import subprocess
import tempfile
import time

CHANNELS = 9
RATE = 48000
FRAME_BYTES = 4 * CHANNELS
# Long, so that a machine that does other work keeps up: no server reports lost frames.
QUANTUM = 4096


def wait_for(condition, what, seconds=60.0):
    """Waits until the condition is true; returns its value."""
    end = time.monotonic() + seconds
    while True:
        if value := condition():
            return value
        if time.monotonic() > end:
            raise TimeoutError(what)
        time.sleep(0.02)


class Servers:
    """Processes that end, in reverse order, with this object. They see nothing of the user's."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.processes = []
        self.env = {k: v for k, v in os.environ.items() if not k.startswith(("PIPEWIRE", "JACK", "XDG", "DBUS", "TACTOR"))}
        # Sockets are made here, whose names may have 107 bytes.
        self.runtime = tempfile.TemporaryDirectory(prefix="tactor-")
        (self.folder / "home").mkdir()
        self.env |= {"XDG_RUNTIME_DIR": self.runtime.name, "HOME": str(self.folder / "home"), "LC_ALL": "C"}

    def start(self, *command, **more):
        with open(self.folder / f"{pathlib.Path(command[0]).name}.log", "ab") as log:
            out = {"stdout": log, "stderr": log} | more
            process = subprocess.Popen(command, env=self.env, cwd=self.folder, stdin=subprocess.DEVNULL, **out)
        self.processes.append(process)
        return process

    def end(self, process):
        process.terminate()
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        self.processes.remove(process)

    def close(self):
        while self.processes:
            self.end(self.processes[-1])
        self.runtime.cleanup()

    def says(self, *command):
        """Returns the output of a command; nothing where it fails, as it does while the server starts."""
        r = subprocess.run(command, env=self.env, cwd=self.folder, capture_output=True, text=True, timeout=60, check=False)
        return r.stdout if r.returncode == 0 else ""


class PipeWire(Servers):
    def __init__(self, folder):
        super().__init__(folder)
        bus = self.start("dbus-daemon", "--session", "--nofork", "--print-address", stdout=subprocess.PIPE, text=True)
        self.env["DBUS_SESSION_BUS_ADDRESS"] = bus.stdout.readline().strip()
        self.start("pipewire")
        wait_for(lambda: self.says("pw-cli", "info", "0"), "PipeWire does not answer")
        self.says("pw-metadata", "-n", "settings", "0", "clock.force-quantum", str(QUANTUM))
        places = ",".join(f"AUX{i}" for i in range(CHANNELS))
        self.says("pw-cli", "create-node", "adapter",
                  "{ factory.name=support.null-audio-sink node.name=nine media.class=Audio/Sink object.linger=true "
                  f"audio.rate={RATE} audio.channels={CHANNELS} audio.position=[{places}] monitor.channel-volumes=false }}")
        self.start("wireplumber")
        wait_for(lambda: "nine" in self.says("wpctl", "inspect", "@DEFAULT_AUDIO_SINK@"), "the sink is not the default one")

    def record(self, file):
        """Records the sink's input, from when this returns."""
        recorder = self.start("pw-record", "--target", "nine", "-P", "{ stream.capture.sink=true stream.dont-remix=true }",
                              "--rate", str(RATE), "--channels", str(CHANNELS), "--format", "f32", "--latency", str(QUANTUM),
                              "--channel-map", ",".join(f"AUX{i}" for i in range(CHANNELS)), file)
        wait_for(lambda: f"pw-record:input_AUX{CHANNELS - 1}" in self.says("pw-link", "-l"), "pw-record is not linked")
        return recorder


class Jack(Servers):
    def __init__(self, folder):
        super().__init__(folder)
        self.env |= {"JACK_DEFAULT_SERVER": f"tactor-{os.getpid()}", "JACK_NO_START_SERVER": "1", "JACK_NO_AUDIO_RESERVATION": "1"}
        self.start("jackd", "-n", self.env["JACK_DEFAULT_SERVER"], *(["-R"] if os.geteuid() == 0 else ["-r"]), "-d", "dummy", "-r", str(RATE),
                   "-p", str(QUANTUM), "-P", str(CHANNELS), "-C", str(CHANNELS))
        wait_for(lambda: f"system:playback_{CHANNELS}" in self.says("jack_lsp"), "JACK does not answer")

    def record(self, file):
        """Records the input of the ports that this returns, in order, with the recorder."""
        self.env["ALSA_CONFIG_PATH"] = str(alsa_configuration(self.folder / "record.conf", jack_pcm(
            "recorder", "capture", [f"system:capture_{i + 1}" for i in range(CHANNELS)])))
        recorder = self.start("arecord", "-q", "-D", "recorder", "-t", "raw", "-f", "FLOAT_LE", "-c", str(CHANNELS), "-r", str(RATE),
                              f"--period-size={QUANTUM}", f"--buffer-size={8 * QUANTUM}", file)
        ports = wait_for(lambda: [p for p in self.says("jack_lsp").split() if p.startswith("arecord.") and ":in_" in p][CHANNELS - 1:]
                         and sorted(p for p in self.says("jack_lsp").split() if p.startswith("arecord.")), "arecord is not there")
        return recorder, ports


def jack_pcm(name, direction, ports):
    return f"pcm.{name} {{ type jack {direction}_ports {{ " + " ".join(f"{i} {p}" for i, p in enumerate(ports)) + " } }\n"


def alsa_configuration(file, *parts):
    file.write_text("</usr/share/alsa/alsa.conf>\n" + "".join(parts), encoding="ascii")
    return file
