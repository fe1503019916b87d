# SPDX-License-Identifier: MIT
"""Nine channels through sound servers, to the bit. Usage: test_servers.py TOOL SOURCE_ROOT FOLDER"""
import os
import pathlib
import signal
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(sys.argv[2]) / "tests/cli"))
from harness import ROOT, TOOL, Wav, main  # noqa: E402
from rig import CHANNELS, FRAME_BYTES, QUANTUM, RATE, Jack, PipeWire, alsa_configuration, jack_pcm, wait_for  # noqa: E402

FOLDER = pathlib.Path(sys.argv[3]).resolve()
UNPACKED = FOLDER / "unpacked"
# Every tactor of palm-3x3 has its turn.
STROKE = ("--path", "M 0 0 L 40 0 L 40 20 L 0 20 L 0 40 L 40 40", "--speed", "160")
PLAY = ("play", *STROKE, "--sample-format", "float", "--period-frames", str(QUANTUM), "--periods", "3")
# A server without processor time loses frames without a report. Its changes of the samples are the same each time.
TRIES = 5


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
    def setUp(self):
        self.folder = FOLDER / ".".join(self.id().split(".")[1:])
        self.folder.mkdir()

    def run_tool(self, servers, *args, **env):
        return subprocess.run([TOOL, *args], env=servers.env | env, cwd=self.folder, capture_output=True, text=True, timeout=120, check=False)

    def ok(self, servers, *args, **env):
        r = self.run_tool(servers, *args, **env)
        self.assertEqual(r.returncode, 0, r.stdout + r.stderr)
        return r

    def rendered(self, servers):
        self.ok(servers, "render", *STROKE, "-o", "rendered.wav")
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
    def setUp(self):
        super().setUp()
        self.server = PipeWire(self.folder)
        self.addCleanup(self.server.close)
        plugins = next(UNPACKED.glob("usr/lib/*/alsa-lib"))
        definitions = UNPACKED / "usr/share/alsa/alsa.conf.d"
        conf = alsa_configuration(self.folder / "alsa.conf", *(f"<{f}>\n" for f in sorted(definitions.glob("*.conf"))))
        self.server.env |= {"ALSA_PLUGIN_DIR": str(plugins), "ALSA_CONFIG_PATH": str(conf)}

    def play(self, pcm, **env):
        file = self.folder / "recorded.wav"
        recorder = self.server.record(file)
        r = self.ok(self.server, *PLAY, "-D", pcm, **env)
        self.finish(recorder, file)
        self.assertIn("PipeWire is in between: it may mix, resample and hide xruns", r.stderr)
        return sound(Wav(file).data)

    def test_all_channels_arrive_to_the_bit(self):
        made = self.rendered(self.server)
        self.assert_the_same(lambda: self.play("pipewire"), made)

    def test_channels_arrive_as_the_default_device_too(self):
        made = self.rendered(self.server)
        self.assert_the_same(lambda: self.play("default"), made)

    def test_the_user_s_properties_of_the_stream_win(self):
        # The result without the tool's property: all is mixed down to two channels.
        self.assertLess(len(channels_in(self.play("pipewire", PIPEWIRE_ALSA="{ media.name = mine }"))), CHANNELS)

    def test_check_reports_it(self):
        out = " ".join(self.ok(self.server, "check", "-D", "pipewire").stdout.split())
        self.assertRegex(out, r"warning device pipewire: 9 channels.*PipeWire is in between: it may mix, resample and hide xruns "
                              r"-> -D hw:CARD=NAME plays on the card itself")


class ThroughJack(ServerTest):
    def setUp(self):
        super().setUp()
        self.server = Jack(self.folder)
        self.addCleanup(self.server.close)

    def configured(self, ports):
        return {"ALSA_CONFIG_PATH": str(alsa_configuration(self.folder / "play.conf", jack_pcm("nine", "playback", ports)))}

    def play(self):
        file = self.folder / "recorded.raw"
        recorder, ports = self.server.record(file)
        r = self.ok(self.server, *PLAY, "-D", "nine", **self.configured(ports))
        self.finish(recorder, file)
        self.assertIn("JACK is in between", r.stderr)
        return sound(file.read_bytes())

    def test_all_channels_arrive_to_the_bit(self):
        made = self.rendered(self.server)
        self.assert_the_same(self.play, made)

    def test_check_reports_it(self):
        out = self.ok(self.server, "check", "-D", "nine", **self.configured([f"system:playback_{i + 1}" for i in range(CHANNELS)])).stdout
        self.assertRegex(" ".join(out.split()), r"warning device nine: 9 channels.*JACK is in between")


if __name__ == "__main__":
    main()
