# SPDX-License-Identifier: MIT
"""Support for the tests of the tool: running it, reading WAV files, and the closing line.

Each test file is run as: python3 test_X.py TOOL SOURCE_ROOT
"""
import csv
import json
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import time
import unittest

TOOL = pathlib.Path(sys.argv[1]).resolve()
ROOT = pathlib.Path(sys.argv[2]).resolve()
sys.path.insert(0, str(ROOT / "tests/study"))  # studies.py


class Messages:
    """The errors that a file of tests provokes, each once, as messages/NAME.txt has them and a user reads them.

    TACTOR_UPDATE_GOLDEN=1 writes the file anew; the diff then shows what changes for users. <any> in the file stands for what differs
    from run to run, or from one version of a library to another, and is kept. So are all messages where a test is skipped: some are
    provoked by an ordinary user alone.
    """

    def __init__(self, file, folders):
        """file: the golden file; folders: name shown for each folder of the machine."""
        self.file = file
        self.folders = folders
        self.update = bool(os.environ.get("TACTOR_UPDATE_GOLDEN"))
        lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
        self.held = {line: re.compile(re.escape(line).replace("<any>", ".*")) for line in lines}
        self.seen = set()

    def check(self, stderr, folders):
        """Returns what is wrong with the last line of stderr; "" where the file holds it."""
        message = stderr.rstrip("\n").rsplit("\n", 1)[-1]
        for folder, name in {**folders, **self.folders}.items():
            message = message.replace(str(folder), name)
        message = re.sub(r"\btmp\w{8}\b", "TMP", message)
        held = message if message in self.held else next((line for line, form in self.held.items() if form.fullmatch(message)), None)
        self.seen.add(held or message)
        return "" if held or self.update else f"{self.file.name} does not hold: {message}\n(TACTOR_UPDATE_GOLDEN=1 adds it)"

    def end(self, is_whole):
        """Returns the messages of the file that no test provoked; writes the file where that is asked for. Keeps the messages
        where tests were skipped or failed."""
        kept = self.seen if is_whole else self.seen | self.held.keys()
        if self.update and kept:
            self.file.write_text("".join(f"{line}\n" for line in sorted(kept)), encoding="utf-8")
        return [] if self.update else sorted(self.held.keys() - kept)


MESSAGES = Messages(ROOT / "tests/cli/messages" / f"{pathlib.Path(sys.argv[0]).stem.removeprefix('test_')}.txt", {ROOT: "SOURCE", TOOL: "tactor"})

# With a sanitizer the tool is twenty times slower and uses more memory. (Meson sets ASAN_OPTIONS for every test.)
SANITIZED = os.environ.get("TACTOR_SANITIZE", "none") != "none"
PATIENCE_S = 600  # anything slower hangs

# A configuration by the tests alone: neither the user's nor the system's of ALSA or tactor.
ALSA_CONFIG = """
pcm.!default { type null }
pcm.null { type null }
pcm.raw {
    @args [ FILE ]
    @args.FILE { type string }
    type file
    slave.pcm { type null }
    file $FILE
    format raw
}
pcm.eight {
    type multi
    slaves.a { pcm { type null } channels 4 }
    slaves.b { pcm { type null } channels 4 }
    bindings.0 { slave a channel 0 }
    bindings.1 { slave a channel 1 }
    bindings.2 { slave a channel 2 }
    bindings.3 { slave a channel 3 }
    bindings.4 { slave b channel 0 }
    bindings.5 { slave b channel 1 }
    bindings.6 { slave b channel 2 }
    bindings.7 { slave b channel 3 }
}
"""

# Adds a PCM that may be felt, though no card is there.
FELT_CONFIG = f'''
pcm_type.felt {{ lib "{os.environ.get("TACTOR_FELT_PCM", "")}" }}
pcm.felt {{ type felt }}
pcm.felt2 {{ type felt }}
'''

# An array file of a user: with comments, an unusual setting and a device that is always there.
GRID = """# the array on my desk
[array]
name = "desk"   # oak
grid = { rows = 1, columns = 2, pitch_mm = 20.0 }
actuator = "piezo"
[[tactor]]
tactor = 1      # repaired in May
channel = 1
gain_db = -3.0
[output]
pcm = "null"
"""


def end_process(process):
    """Ends a process if it still runs, and closes its streams."""
    process.kill()
    process.wait()
    for stream in (process.stdin, process.stdout, process.stderr):
        if stream is not None:
            stream.close()


class ToolTest(unittest.TestCase):
    """A test with a temporary folder, in which the tool runs."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.dir = pathlib.Path(self.folder.name)
        self.write("alsa.conf", ALSA_CONFIG)
        self.env = {k: v for k, v in os.environ.items() if k not in ("TACTOR_CONFIG", "DISPLAY")}
        self.env |= {"XDG_CONFIG_HOME": str(self.dir / "none"), "ALSA_CONFIG_PATH": str(self.dir / "alsa.conf"),
                     "RUNTIME_DIRECTORY": "", "XDG_RUNTIME_DIR": "", "LC_ALL": "C"}

    def write(self, name, text):
        path = self.dir / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    def defaults(self, **keys):
        """Writes keys of [defaults] as a configuration. Returns the option that names it."""
        self.write("defaults.toml", "[defaults]\n" + "".join(f"{key.replace('_', '-')} = {json.dumps(value)}\n" for key, value in keys.items()))
        return "--config", "defaults.toml"

    def until(self, condition, process=None):
        """Polls a condition that nothing announces, for as long as the process that causes it runs."""
        deadline = time.monotonic() + PATIENCE_S
        while not condition():
            self.assertTrue(process is None or process.poll() is None, "it ended early")
            self.assertLess(time.monotonic(), deadline, "it hangs")
            time.sleep(0.01)

    def start_tool(self, *args, program=TOOL, **more):
        """Starts the tool, or another program, which ends with the test at the latest."""
        process = subprocess.Popen([program, *map(str, args)], **({"cwd": self.dir, "env": self.env} | more))
        self.addCleanup(end_process, process)
        return process

    def run_tool(self, *args, stdin="", env=None, timeout=PATIENCE_S, before=None):
        """Runs the tool; `before` is called in the process before it becomes the tool."""
        return subprocess.run([TOOL, *map(str, args)], input=stdin, capture_output=True, text=True, timeout=timeout,
                              cwd=self.dir, env=self.env | (env or {}), check=False, preexec_fn=before)

    def begun(self, *args, stdin=""):
        """Starts the tool with pipes for its text, and writes to its standard input, which stays open."""
        p = self.start_tool(*args, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        p.stdin.write(stdin)
        p.stdin.flush()
        return p

    def ok(self, *args, **more):
        result = self.run_tool(*args, **more)
        self.assertEqual(result.returncode, 0, f"{args}: {result.stderr}")
        return result

    def refused(self, status, *args, says=(), **more):
        """Runs the tool; it must fail with this status and with the error that messages/ holds, which has all these texts."""
        result = self.run_tool(*args, **more)
        self.assertEqual(result.returncode, status, f"{args}: {result.stdout[:300]} {result.stderr}")
        self.assertTrue(result.stderr.startswith("tactor: "), result.stderr)
        for text in says:
            self.assertIn(text, result.stderr)
        said = re.sub(r"^libgcov .*\n", "", result.stderr, flags=re.M)  # of a process that may not write, where lines are counted
        self.assertEqual(MESSAGES.check(said, {self.dir: "DIR"}), "")
        return result

    def plan(self, *args, **more):
        return json.loads(self.ok("plan", *args, "--format", "json", **more).stdout)

    def trials(self, study="study"):
        """Returns the comments of --format tsv and its rows."""
        lines = self.ok("analyze", study, "--format", "tsv").stdout.splitlines()
        return [line for line in lines if line[0] == "#"], list(csv.DictReader((line for line in lines if line[0] != "#"), delimiter="\t"))


def wav_bytes(samples, rate=8000, channels=1, bits=16, tag=1):
    """Makes a WAV file of one channel; its header says what the arguments ask for."""
    return wav_file(b"".join(struct.pack("<h", round(32767 * s)) for s in samples), channels, bits, tag, rate)


def wav_file(data, channels, bits, tag=1, rate=48000):
    """Makes a WAV file of these bytes of samples."""
    size = bits // 8 * channels
    head = struct.pack("<HHIIHH", tag, channels, rate, rate * size, size, bits)
    chunks = b"fmt " + struct.pack("<I", len(head)) + head + b"data" + struct.pack("<I", len(data)) + data
    return b"RIFF" + struct.pack("<I", 4 + len(chunks)) + b"WAVE" + chunks


class Wav:
    """A WAV or RF64 file, read chunk by chunk."""

    def __init__(self, path):
        data = pathlib.Path(path).read_bytes()
        assert data[:4] in (b"RIFF", b"RF64") and data[8:12] == b"WAVE", data[:12]
        self.chunks = {}
        at = 12
        while at + 8 <= len(data):
            name, size = data[at:at + 4], struct.unpack("<I", data[at + 4:at + 8])[0]
            self.chunks[name] = data[at + 8:at + 8 + size]
            at += 8 + size + size % 2
        self.tag, self.channels, self.rate, _, self.frame_bytes, self.bits = struct.unpack(
            "<HHIIHH", self.chunks[b"fmt "][:16])
        self.data = self.chunks[b"data"]
        self.frames = len(self.data) // self.frame_bytes

    def samples(self):
        """Returns all samples as numbers, full scale 1, frame by frame."""
        if self.tag == 3:
            values = [v for (v,) in struct.iter_unpack("<f", self.data)]
        else:
            size = self.bits // 8
            values = [int.from_bytes(self.data[i:i + size], "little", signed=True) / 2.0 ** (self.bits - 1)
                      for i in range(0, len(self.data), size)]
        n = self.channels
        return [values[i:i + n] for i in range(0, len(values), n)]


def main():
    """Runs the file's tests and closes with the line that the suite's summary counts."""
    result = unittest.TextTestRunner(stream=sys.stdout, verbosity=1).run(
        unittest.defaultTestLoader.loadTestsFromModule(sys.modules["__main__"]))
    for test, why in result.skipped:
        print(f"SKIPPED: {test}: {why}")
    failed = len(result.failures) + len(result.errors)
    unused = MESSAGES.end(not failed and not result.skipped)
    for message in unused:
        print(f"no test provokes what {MESSAGES.file.name} holds: {message}")
    print(f"{result.testsRun - failed - len(result.skipped)} passed, {failed} failed, {len(result.skipped)} skipped")
    sys.exit(1 if failed or unused or not result.testsRun else 0)
