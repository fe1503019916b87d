# SPDX-License-Identifier: MIT
"""The guest's bench: the tool, a loopback card to capture from, and a simulated GPIO chip."""
import csv
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import time
import unittest

ROOT = pathlib.Path(sys.argv[1])
BUILD = pathlib.Path(sys.argv[2])
TOOL = BUILD / "src/cli/tactor"
# A build in a separate root runs there.
INSIDE = os.environ.get("TACTOR_VM_ROOT", "")
ENTER = ["chroot", INSIDE] if INSIDE else []
RATE = 48000
# The loopback card runs on jiffies: at 250 Hz, 240 frames are the shortest period that it keeps.
PERIOD, PERIODS = 240, 16
OUT, BACK = "hw:CARD=Loopback,DEV=0,SUBDEV={}", "hw:CARD=Loopback,DEV=1,SUBDEV={}"


def wait_for(condition, what, seconds=20.0):
    """Polls a condition that nothing announces (sysfs, /proc)."""
    end = time.monotonic() + seconds
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > end:
            raise AssertionError(f"not within {seconds} s: {what}")
        time.sleep(0.002)


def wav_data(path):
    data = path.read_bytes()
    at = 12
    while data[at:at + 4] != b"data":
        at += 8 + int.from_bytes(data[at + 4:at + 8], "little")
    return data[at + 8:at + 8 + int.from_bytes(data[at + 4:at + 8], "little")]  # the file's mark follows


# Captures: a test that fails half-way leaves the card to the next one.
CAPTURING = []


class Capture:
    """arecord on the other end of the loopback."""

    def __init__(self, folder, channels, sample_format, subdevice=0):
        self.path = folder / f"capture{subdevice}.raw"
        self.path.unlink(missing_ok=True)  # of a recording before: its existence shows that this one runs
        self.frame_bytes = channels * {"S16_LE": 2, "S32_LE": 4}[sample_format]
        self.process = subprocess.Popen(
            ["arecord", "-q", "-D", BACK.format(subdevice), "-t", "raw", "-f", sample_format, "-c", str(channels),
             "-r", str(RATE), "--period-size=1024", "--buffer-size=16384", str(self.path)],
            stderr=subprocess.PIPE)
        CAPTURING.append(self.process)
        wait_for(lambda: self.path.exists() or self.process.poll() is not None, "arecord starts")

    def stop(self):
        self.process.terminate()
        said = self.process.communicate(timeout=30)[1]
        self.overruns = said.count(b"overrun!!!")
        data = self.path.read_bytes()
        return data[:len(data) - len(data) % self.frame_bytes]


class Card:
    """The loopback card, in and out of its socket."""
    DRIVER = pathlib.Path("/sys/bus/platform/drivers/snd_aloop")
    DEVICE = "snd_aloop.0"

    @staticmethod
    def plug_in():
        if not (Card.DRIVER / Card.DEVICE).exists():
            (Card.DRIVER / "bind").write_text(Card.DEVICE)
        wait_for(lambda: "Loopback" in pathlib.Path("/proc/asound/cards").read_text(), "the card is back")

    @staticmethod
    def pull_out():
        """Waits in the kernel until the player has closed the card: not in this process."""
        return subprocess.Popen(["sh", "-c", f"echo {Card.DEVICE} > {Card.DRIVER}/unbind"])


class GpioSim:
    """A simulated chip: outputs are read, inputs are pulled through sysfs."""
    COUNT = 0

    def __init__(self, lines=8, names=()):
        GpioSim.COUNT += 1
        self.config = pathlib.Path(f"/sys/kernel/config/gpio-sim/t{os.getpid()}-{GpioSim.COUNT}")
        bank = self.config / "bank0"
        bank.mkdir(parents=True)
        (bank / "num_lines").write_text(str(lines))
        self.label = f"tactor-sim-{GpioSim.COUNT}"
        (bank / "label").write_text(self.label)
        for offset, name in names:
            (bank / f"line{offset}").mkdir()
            (bank / f"line{offset}/name").write_text(name)
        (self.config / "live").write_text("1")
        self.lives = True
        self.chip = (bank / "chip_name").read_text().strip()
        self.sysfs = pathlib.Path("/sys/devices/platform") / (self.config / "dev_name").read_text().strip() / self.chip

    def value(self, offset):
        return int((self.sysfs / f"sim_gpio{offset}/value").read_text())

    def pull(self, offset, up):
        (self.sysfs / f"sim_gpio{offset}/pull").write_text("pull-up" if up else "pull-down")

    def close(self):
        if self.lives:
            (self.config / "live").write_text("0")
        self.lives = False


def until(process, words, seconds=120.0):
    """Reads a process's output up to these words, letter by letter; ends it when they do not come."""
    watchdog = threading.Timer(seconds, process.kill)
    watchdog.start()
    said = ""
    while not said.endswith(words):
        letter = process.stdout.read(1)
        if not letter:
            watchdog.cancel()
            raise AssertionError(f"{words!r} does not come after {said!r}; status {process.wait(60)}: {process.stderr.read()}")
        said += letter
    watchdog.cancel()


class RigTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.dir = pathlib.Path(folder.name)
        self.addCleanup(self.end_captures)
        self.env = os.environ | {"XDG_CONFIG_HOME": str(self.dir), "HOME": str(self.dir)}

    @staticmethod
    def end_captures():
        while CAPTURING:
            p = CAPTURING.pop()
            if p.poll() is None:
                p.kill()
                p.wait(20)

    def write(self, name, text):
        (self.dir / name).write_text(text)
        return self.dir / name

    def tool(self, *args, timeout=300):
        return subprocess.run([*ENTER, TOOL, *map(str, args)], capture_output=True, text=True, cwd=self.dir, env=self.env,
                              timeout=timeout, check=False)

    def start(self, *args, stdin=None):
        p = subprocess.Popen([*ENTER, TOOL, *map(str, args)], stdin=stdin, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                             cwd=self.dir, env=self.env)
        self.addCleanup(lambda: p.poll() is None and p.kill())
        return p

    def grid(self, channels=9, extra="", pcm=OUT.format(0), period=PERIOD, periods=PERIODS):
        """Writes an array file; the loopback card plays it unless `pcm` names another one."""
        rows, columns = {2: (1, 2), 8: (2, 4), 9: (3, 3), 16: (4, 4), 24: (4, 6)}[channels]
        return self.write("array.toml", f"""
[array]
name = "vm"
grid = {{ rows = {rows}, columns = {columns}, pitch_mm = 20.0 }}
[output]
pcm = "{pcm}"
period_frames = {period}
periods = {periods}
{extra}""")


class SessionTest(RigTest):
    """Sessions of tactor experiment whose answers are lines."""

    # A definition without a run.
    HEAD = """[experiment]
name = "vm"
array = "array.toml"
level = { dbfs = -20 }
[[motion]]
name = "east"
path = "M0 0H40"
duration = 0.2
[[method]]
name = "Alder"
algorithm = "tactile-brush"
"""

    def hold(self, definition, lines, *more, timeout=200):
        """Holds a whole session; returns what the tool wrote to standard error."""
        self.write("study.toml", definition)
        with self.write("lines", lines).open() as answers:
            p = self.start("experiment", "study.toml", "--participant", "01", "-o", "study", *more, stdin=answers)
            said, err = p.communicate(timeout=timeout)
        self.assertEqual(p.returncode, 0, said + err)
        return err

    def table(self, run, kind="beh"):
        with (self.dir / f"study/sub-01/beh/sub-01_task-{run}_{kind}.tsv").open(newline="") as file:
            return list(csv.DictReader(file, delimiter="\t"))

    def rendered(self, plan, array):
        file = self.dir / f"{plan}.wav"
        made = self.tool("render", f"study/sourcedata/sub-01/plans/{plan}.json", "--array", array, "--sample-format", "s32", "-o", file)
        self.assertEqual(made.returncode, 0, made.stderr)
        return wav_data(file)


class AmplifierTest(RigTest):
    """Writes an array whose amplifier is on line 2 of another chip."""
    LINE = 2
    LIMIT_S = 1.0 if INSIDE else 0.2  # other lanes run beside the lane of another Debian

    def setUp(self):
        super().setUp()
        self.gpio = GpioSim()
        self.addCleanup(self.gpio.close)
        self.array = self.grid(extra=f'[amplifier]\nline = {{ chip = "{self.gpio.label}", offset = {self.LINE} }}\n')

    def on(self):
        return self.gpio.value(self.LINE) == 1

    def playing(self, seconds="60", strokes=20):
        # An xrun of the emulated machine ends one stroke, not the run.
        p = self.start("play", *["park2016-1"] * strokes, "--duration", seconds, "--array", self.array)
        wait_for(lambda: self.on() or p.poll() is not None, "the amplifier is switched on")
        self.assertIsNone(p.poll(), p.stderr.read() if p.poll() is not None else "")
        return p

    def off_within(self, what, limit=LIMIT_S):
        began = time.monotonic()
        wait_for(lambda: not self.on(), f"off after {what}", 5)
        took = time.monotonic() - began
        print(f"off {took * 1000:.0f} ms after {what}")
        self.assertLess(took, limit, what)
