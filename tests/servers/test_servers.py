# SPDX-License-Identifier: MIT
"""Nine channels through sound servers, to the bit: PipeWire with a null sink of nine channels, JACK with its dummy driver.

Usage: test_servers.py TOOL SOURCE_ROOT FOLDER
"""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(sys.argv[2]) / "tests/cli"))
from harness import TOOL, Wav, main  # noqa: E402

CHANNELS = 9
RATE = 48000
FRAME_BYTES = 4 * CHANNELS
# Long, so that a machine that does other work keeps up: no server reports lost frames.
QUANTUM = 4096
FOLDER = pathlib.Path(sys.argv[3]).resolve()
UNPACKED = FOLDER / "unpacked"
# Every tactor of palm-3x3 has its turn.
STROKE = ("--path", "M 0 0 L 40 0 L 40 20 L 0 20 L 0 40 L 40 40", "--speed", "160")
PLAY = ("play", *STROKE, "--sample-format", "float", "--period-frames", str(QUANTUM), "--periods", "3")
# A server without processor time loses frames without a report. Its changes of the samples are the same each time.
TRIES = 5


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


def frames(data):
    return [data[i:i + FRAME_BYTES] for i in range(0, len(data) - FRAME_BYTES + 1, FRAME_BYTES)]


def sound(data):
    """Returns the frames from the first sound to the last; a zero is a zero, whatever its sign."""
    values = [frame.replace(b"\0\0\0\x80", b"\0\0\0\0") if b"\0\0\0\x80" in frame else frame for frame in frames(data)]
    loud = [i for i, v in enumerate(values) if any(v)]
    return values[loud[0]:loud[-1] + 1] if loud else []


def channels_in(some):
    return {c for frame in some for c in range(CHANNELS) if any(frame[4 * c:4 * c + 4])}


class ServerTest(unittest.TestCase):
    server_kind = None

    def setUp(self):
        self.folder = FOLDER / ".".join(self.id().split(".")[1:])
        self.folder.mkdir()
        self.server = self.server_kind(self.folder)
        self.addCleanup(self.server.close)

    def ok(self, *args, **env):
        r = subprocess.run([TOOL, *args], env=self.server.env | env, cwd=self.folder, capture_output=True, text=True, timeout=120, check=False)
        self.assertEqual(r.returncode, 0, r.stdout + r.stderr)
        return r

    def rendered(self):
        self.ok("render", *STROKE, "-o", "rendered.wav")
        made = sound(Wav(self.folder / "rendered.wav").data)
        self.assertEqual(channels_in(made), set(range(CHANNELS)))
        return made

    def finish(self, recorder, file):
        """Waits until a second has been recorded after the stroke: then it is complete."""
        enough = file.stat().st_size + RATE * FRAME_BYTES
        wait_for(lambda: file.stat().st_size >= enough, "nothing is recorded")
        recorder.send_signal(signal.SIGINT)
        recorder.wait(30)

    def assert_the_same(self, play_once, made):
        for attempt in range(1, TRIES + 1):
            heard = play_once()
            if heard == made:
                print(f"{self.id()}: {len(made)} frames of {CHANNELS} channels, the same at try {attempt}")
                return
        first = next((i for i, (a, b) in enumerate(zip(heard, made)) if a != b), min(len(heard), len(made)))
        self.fail(f"{len(heard)} frames arrived in channels {channels_in(heard)}, {len(made)} were rendered; they differ from frame {first}")


class ThroughPipeWire(ServerTest):
    server_kind = PipeWire

    def setUp(self):
        super().setUp()
        plugins = next(UNPACKED.glob("usr/lib/*/alsa-lib"))
        definitions = UNPACKED / "usr/share/alsa/alsa.conf.d"
        conf = alsa_configuration(self.folder / "alsa.conf", *(f"<{f}>\n" for f in sorted(definitions.glob("*.conf"))))
        self.server.env |= {"ALSA_PLUGIN_DIR": str(plugins), "ALSA_CONFIG_PATH": str(conf)}

    def play(self, pcm, **env):
        file = self.folder / "recorded.wav"
        recorder = self.server.record(file)
        r = self.ok(*PLAY, "-D", pcm, **env)
        self.finish(recorder, file)
        self.assertIn("PipeWire is between player and device, and may mix, resample and hide xruns", r.stderr)
        return sound(Wav(file).data)

    def test_all_channels_arrive_to_the_bit(self):
        made = self.rendered()
        self.assert_the_same(lambda: self.play("pipewire"), made)

    def test_channels_arrive_as_the_default_device_too(self):
        made = self.rendered()
        self.assert_the_same(lambda: self.play("default"), made)

    def test_the_user_s_properties_of_the_stream_win(self):
        # The result without the tool's property: all is mixed down to two channels.
        self.assertLess(len(channels_in(self.play("pipewire", PIPEWIRE_ALSA="{ media.name = mine }"))), CHANNELS)

    def test_check_reports_it(self):
        out = " ".join(self.ok("check", "-D", "pipewire").stdout.split())
        self.assertRegex(out, r"warning device pipewire: 9 channels.*PipeWire is between player and device, and may mix, resample and hide xruns "
                              r"-> use -D hw:CARD=NAME to play on the card itself")


class ThroughJack(ServerTest):
    server_kind = Jack

    def configured(self, ports):
        return {"ALSA_CONFIG_PATH": str(alsa_configuration(self.folder / "play.conf", jack_pcm("nine", "playback", ports)))}

    def play(self):
        file = self.folder / "recorded.raw"
        recorder, ports = self.server.record(file)
        r = self.ok(*PLAY, "-D", "nine", **self.configured(ports))
        self.finish(recorder, file)
        self.assertIn("JACK is between player and device", r.stderr)
        return sound(file.read_bytes())

    def test_all_channels_arrive_to_the_bit(self):
        made = self.rendered()
        self.assert_the_same(self.play, made)

    def test_check_reports_it(self):
        out = self.ok("check", "-D", "nine", **self.configured([f"system:playback_{i + 1}" for i in range(CHANNELS)])).stdout
        self.assertRegex(" ".join(out.split()), r"warning device nine: 9 channels.*JACK is between player and device")


if __name__ == "__main__":
    main()
