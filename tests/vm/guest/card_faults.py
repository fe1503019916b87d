# SPDX-License-Identifier: MIT
"""Cards that are pulled out, changed, reset, doubled or held by another program, by Linux's own driver of USB cards.

Each test has what the tool prints and the service tells, word for word.
"""
import fcntl
import json
import os
import pathlib
import re
import signal
import subprocess
import time
import unittest
import wave

from cards import ALSA, UsbTest, first_sound, setUpModule  # noqa: F401: unittest calls it
from rig import RATE, GpioSim, wait_for
from test_service import Client

SHORT_STROKE, LONG_STROKE = (("--path", "M 0 10 H 60", "--duration", duration) for duration in ("1", "60"))
LINE = 2
RESET = 0x5514  # USBDEVFS_RESET
GONE = "the device is gone"
STOOD_STILL = "the device stopped"
PCM = "hw:CARD=USB8x16"
NO_CARD = f'PCM "{PCM}": there is no card USB8x16'


def log_lines(text):
    """Returns the lines of a log without their times, and with # for other numbers that differ from run to run."""
    lines = re.findall(r"(?m)^\d{4}-\d\d-\d\dT[\d:.]+Z (.*)$", text)
    return [re.sub(r"\d{4}-\d\d-\d\dT[\d:.]+Z|\d+\.\d+", "#", line) for line in lines]


class FaultTest(UsbTest):
    def setUp(self):
        super().setUp()
        self.gpio = GpioSim()
        self.addCleanup(self.gpio.close)
        self.card = self.plug_in(8, 16)
        self.wired = self.array(self.card.name, 8, f'[amplifier]\nline = {{ chip = "{self.gpio.label}", offset = {LINE} }}\n')

    def is_on(self):
        return self.gpio.value(LINE) == 1

    def await_sound(self):
        # The amplifier goes off for the time in which the emulated machine stands still.
        wait_for(lambda: self.card.heard() > RATE // 2 and self.is_on(), "half a second of sound", 60)

    def await_silence(self):
        wait_for(lambda: not self.is_on(), "the amplifier is off", 5)

    def pull_out_in_mid_stroke(self):
        self.await_sound()
        self.pull_out(self.card)
        self.await_silence()

    def play_long(self, *more):
        return self.start("play", *LONG_STROKE, "--array", self.wired, "--format", "json", "--verbose", *more)

    def serve(self):
        """Starts the service. Returns its process and a client that gets the stream's states."""
        path = self.dir / "tactor.sock"
        p = self.start("serve", "--socket", path, "--array", self.wired, "--format", "json", "--verbose")
        self.assertIn("listening", p.stdout.readline())
        c = Client(path)
        self.addCleanup(c.close)
        c.call("subscribe", events=["stream"])
        return p, c

    def end(self, p):
        """Ends the service. Returns what it printed on standard error."""
        p.send_signal(signal.SIGTERM)
        _, err = p.communicate(timeout=60)
        self.assertEqual(p.returncode, 0, err)
        return err

    @staticmethod
    def begin(c):
        return c.call("play", path=LONG_STROKE[1], options={"duration": 60})["stroke"]

    def stream(self, c):
        found = c.call("status")["stream"]
        return found["state"], found["reason"]

    def await_stream(self, c, condition, seconds=60):
        try:
            wait_for(lambda: condition(self.stream(c)), "the state", seconds)
        except AssertionError:
            self.fail(self.stream(c))

    def await_state(self, c, state, reason, seconds=60):
        self.await_stream(c, lambda found: found == (state, reason), seconds)

    def play_through(self, c, card):
        """Plays a stroke through the service; checks that the card gets each byte."""
        rendered = self.render(self.wired, "s16", *SHORT_STROKE)
        begin = len(card.data)
        number = c.call("play", path=SHORT_STROKE[1], options={"duration": 1})["stroke"]
        self.assertEqual(c.await_end(number), "finished", c.told)
        data = bytes(card.data)[begin:]
        start = first_sound(data) - first_sound(rendered)
        self.assertEqual(start % card.frame, 0)
        self.assertTrue(data[start:].startswith(rendered))


class PulledOut(FaultTest):
    """Pulls the card out of its port in mid-stroke."""

    def test_play_says_so_and_ends(self):
        p = self.play_long("--log", self.dir / "log")
        self.pull_out_in_mid_stroke()
        out, err = p.communicate(timeout=60)
        self.assertEqual(p.returncode, 1, err)
        self.assertRegex(err, rf"(?m)^tactor: --path: interrupted after \d+\.\d{{3}} s: {GONE}$")
        stroke, = json.loads(out)["strokes"]
        self.assertEqual((stroke["state"], stroke["reason"]), ("interrupted", GONE))
        print(f"{stroke['frames']} frames of the stroke reported, {self.card.heard()} frames received")
        self.assertAlmostEqual(stroke["frames"], self.card.heard(), delta=RATE // 10)
        for text in (err, (self.dir / "log").read_text(encoding="utf-8")):
            lines = log_lines(text)
            self.assertIn(f"error the stream has ended: {GONE}", lines)
            self.assertIn(f"info stroke --path: began # (# s by CLOCK_MONOTONIC), interrupted after # s: {GONE}", lines)

    def test_serve_waits_and_plays_again(self):
        p, c = self.serve()
        number = self.begin(c)
        self.pull_out_in_mid_stroke()
        self.assertEqual(c.await_end(number), "interrupted")
        self.assertTrue(c.hear("stream", state="lost"))
        self.await_stream(c, lambda found: found[0] == "lost" and found[1].startswith(NO_CARD))
        again = self.plug_in(8, 16)
        self.await_state(c, "running", "")
        self.play_through(c, again)
        err = self.end(p)
        self.assertIn(f"tactor: warning: the stream is lost: {GONE}\n", err)
        self.assertIn("tactor: the stream runs again\n", err)

    def test_play_does_not_take_a_twin_for_the_card(self):
        twin = self.plug_in(8, 16, known_as=f"{self.card.name}_1")
        pcms = json.loads(self.tool("devices", "--array", self.wired, "--format", "json").stdout)["pcms"]
        self.assertEqual([(p["name"], p["fits"]) for p in pcms if p["hardware"] and "USB" in p["name"]], [(f"{PCM},DEV=0", True), (f"{PCM}_1,DEV=0", True)])
        strokes = [self.write(f"{s}.toml", f'[stroke]\npath = "{LONG_STROKE[1]}"\nduration_s = {s}\n') for s in (60, 1)]
        p = self.start("play", *strokes, "--array", self.wired, "--reopen-s", "60", "--verbose", "--format", "json")
        self.pull_out_in_mid_stroke()
        time.sleep(1)  # it tries to open the card meanwhile
        again = self.plug_in(8, 16)
        self.assertEqual(again.id, self.card.id)
        out, err = p.communicate(timeout=120)
        self.assertEqual([s["state"] for s in json.loads(out)["strokes"]], ["interrupted", "finished"], err)
        self.assertIn(f'tactor: waiting for "{PCM}" to come back (Ctrl-C ends)\ntactor: "{PCM}" is back\n',
                      re.sub(r"(?m)^\d{4}-.*\n", "", err))
        self.assertGreater(again.heard(), RATE // 2)
        self.assertEqual(len(twin.data), 0)

    def test_a_card_that_comes_back_with_too_few_channels(self):
        p, c = self.serve()
        number = self.begin(c)
        self.pull_out_in_mid_stroke()
        self.assertEqual(c.await_end(number), "interrupted")
        other = self.plug_in(2, 16, name=self.card.name)
        why = f'PCM "{PCM}": it cannot play 8 channels at {RATE} Hz in s32, float, s24, s24-4, s16: unsupported number of channels'
        self.await_stream(c, lambda found: found[0] == "lost" and found[1].startswith(why))
        self.pull_out(other)
        self.assertEqual(len(other.data), 0)
        again = self.plug_in(8, 16)
        self.await_state(c, "running", "")
        self.play_through(c, again)
        self.end(p)

    def test_a_card_that_comes_back_with_more_channels(self):
        p, c = self.serve()
        self.begin(c)
        self.pull_out_in_mid_stroke()
        self.plug_in(24, 32, name=self.card.name)
        self.await_state(c, "running", "")
        self.assertIn(f'info PCM "{PCM}": 8 of 24 channels, {RATE} Hz, s32', "\n".join(log_lines(self.end(p))))


class StandsStill(FaultTest):
    def test_a_card_that_stands_still_for_a_second_is_given_up(self):
        self.pull_out(self.card)
        card = self.plug_in(8, 16, pause=(2 * RATE, 1.0))
        p = self.play_long()
        wait_for(lambda: card.heard() > RATE // 2 and self.is_on(), "half a second of sound", 60)
        wait_for(lambda: card.pause is None, "the pause", 60)
        self.await_silence()
        out, err = p.communicate(timeout=60)
        self.assertEqual(p.returncode, 1, err)
        stroke, = json.loads(out)["strokes"]
        # The amplifier goes off after a tenth of a second, and the stream ends after half a second.
        self.assertIn((stroke["state"], stroke["reason"]), [("interrupted", why) for why in ("the amplifier was off", STOOD_STILL)])
        self.assertIn(f"error the stream has ended: {STOOD_STILL}", log_lines(err))


class BusErrors(FaultTest):
    def test_a_reset_takes_the_card_away_for_a_moment(self):
        p, c = self.serve()
        number = self.begin(c)
        self.await_sound()
        place = (ALSA / self.card.name / "usbbus").read_text(encoding="ascii").strip()
        device = os.open(f"/dev/bus/usb/{place}", os.O_WRONLY)
        self.addCleanup(os.close, device)
        fcntl.ioctl(device, RESET)
        self.await_silence()
        self.assertEqual(c.await_end(number), "interrupted")
        self.await_state(c, "running", "")
        self.play_through(c, self.card)
        self.assertIn(f"tactor: warning: the stream is lost: {GONE}\n", self.end(p))

    def test_packets_that_the_bus_loses_are_unknown_to_the_driver(self):
        self.pull_out(self.card)
        card = self.plug_in(8, 16, refused=(5 * RATE // 2, 3))
        rendered = self.render(self.wired, "s16", "--path", LONG_STROKE[1], "--duration", "3")
        r = self.tool("play", "--path", LONG_STROKE[1], "--duration", "3", "--array", self.wired, "--format", "json")
        self.assertEqual(r.returncode, 0, r.stderr)
        report = json.loads(r.stdout)
        self.assertEqual((report["counters"]["xruns"], report["strokes"][0]["state"]), (0, "finished"))
        self.assertEqual(len(card.lost), 3)
        data = bytearray(card.data)
        for frame, count in reversed(card.lost):
            data[frame * card.frame:frame * card.frame] = bytes(count * card.frame)
        start = first_sound(bytes(data)) - first_sound(rendered)
        wanted = bytearray(rendered)
        frame = card.lost[0][0] * card.frame - start
        count = sum(count for _, count in card.lost) * card.frame
        wanted[frame:frame + count] = bytes(count)
        self.assertTrue(bytes(data[start:]).startswith(bytes(wanted)))


class Held(FaultTest):
    """Other programs have the card open."""

    def start_other(self, *command, **more):
        try:
            p = subprocess.Popen(command, env=self.env, cwd=self.dir, **{"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL} | more)
        except FileNotFoundError as e:
            raise unittest.SkipTest(f"{e.filename} is not installed (tests/install-packages servers)") from e
        self.addCleanup(p.wait, 20)
        self.addCleanup(p.terminate)
        return p

    def await_playing(self):
        wait_for(lambda: "RUNNING" in (ALSA / self.card.id / "pcm0p/sub0/status").read_text(encoding="ascii"), "the card plays", 120)

    def test_errors_name_the_program(self):
        holder = self.start_other("aplay", "-q", "-D", PCM, "-t", "raw", "-f", "S16_LE", "-c", "8", "-r", str(RATE), "/dev/zero")
        self.await_playing()
        r = self.tool("play", *SHORT_STROKE, "--array", self.wired)
        self.assertEqual(r.returncode, 3)
        why = f"it is busy: aplay (process {holder.pid}) plays on it (stop that program, such as by kill {holder.pid})"
        self.assertIn(f'tactor: PCM "{PCM}": {why}\n', r.stderr)
        p, c = self.serve()
        self.await_state(c, "lost", f'PCM "{PCM}": {why}')
        holder.terminate()
        self.await_state(c, "running", "")
        self.play_through(c, self.card)
        self.assertIn(f'tactor: warning: waiting for the device: PCM "{PCM}": {why}\n', self.end(p))

    def test_wireplumber_gives_the_card_up_and_gets_it_back(self):
        number = (ALSA / self.card.id).resolve().name
        data = pathlib.Path("/run/udev/data")
        data.mkdir(parents=True, exist_ok=True)
        for name in ("seats", "sessions", "users", "machines"):
            pathlib.Path("/run/systemd", name).mkdir(parents=True, exist_ok=True)
        (data / f"+sound:{number}").write_text("I:1\nE:SOUND_INITIALIZED=1\n", encoding="ascii")  # no udev and no logind run here
        self.env |= {"XDG_RUNTIME_DIR": str(self.dir)}
        bus = self.dir / "bus"
        self.env |= {"DBUS_SESSION_BUS_ADDRESS": f"unix:path={bus}"}
        self.start_other("dbus-daemon", "--session", "--nofork", f"--address=unix:path={bus}")
        wait_for(bus.exists, "the bus", 60)
        self.start_other("pipewire")
        wait_for((self.dir / "pipewire-0").exists, "PipeWire", 60)
        self.start_other("wireplumber")

        def has_sink():
            r = subprocess.run(["wpctl", "inspect", "@DEFAULT_AUDIO_SINK@"], env=self.env, capture_output=True, text=True, timeout=60, check=False)
            return self.card.name in r.stdout
        wait_for(has_sink, "WirePlumber has the card", 120)
        with wave.open(str(self.dir / "music.wav"), "wb") as music:
            music.setparams((2, 2, RATE, 0, "NONE", ""))
            music.writeframes(bytes(4 * 300 * RATE))
        self.start_other("pw-play", "music.wav")
        self.await_playing()
        found = json.loads(self.tool("check", "--array", self.wired, "--format", "json").stdout)["findings"]
        device, = [f["found"] for f in found if f["check"] == "device"]
        self.assertRegex(device, r"; \S+ has given up the card for this check$")
        wait_for(has_sink, "WirePlumber has the card again", 120)
        self.await_playing()
        p = self.start("play", *SHORT_STROKE, "--array", self.wired, "--verbose")
        _, err = p.communicate(timeout=120)
        self.assertEqual(p.returncode, 0, err)
        self.assertRegex("\n".join(log_lines(err)), r"(?m)^info \S+ has given up the card until the stream ends$")
        wait_for(has_sink, "WirePlumber has the card after the play", 120)
