# SPDX-License-Identifier: MIT
"""The examples do what their first lines say, without hardware."""
import contextlib
import json
import os
import pathlib
import re
import select
import signal
import socket
import struct
import subprocess
import sys
import time
import tomllib
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from harness import PATIENCE_S, ROOT, ToolTest, Wav, main  # noqa: E402
from serving import Server  # noqa: E402

EXAMPLES = pathlib.Path(sys.argv[3]).resolve()
SYN, KEY, REL, ABS = 0, 1, 2, 3
BTN_LEFT, BTN_TOUCH = 0x110, 0x14a
SO_RCVBUFFORCE = 33  # asm-generic/socket.h

# A device that is closed while its stroke plays, and another whose service then says nothing.
PSYCHOPY = """
import socket
import psychopy_tactor
from psychopy.hardware import DeviceManager
from psychopy_tactor import TactorDevice
psychopy_tactor.SILENCE_S = 600
tactor = DeviceManager.addDevice("tactor", "t", port=PORT)
try:
    tactor.play(stroke="nowhere")
except ValueError as e:
    print(e)
try:
    TactorDevice(port=1)
except ConnectionError as e:
    print(e)
print(tactor.isSameDevice({"host": "127.0.0.1", "port": PORT}), tactor.isSameDevice({"host": "127.0.0.1", "port": 1}))
tactor.play(path="M 0 0 L 40 40", options={"algorithm": "continuous", "duration": 300})
DeviceManager.removeDevice("t")
psychopy_tactor.SILENCE_S = 1
mute = socket.create_server(("127.0.0.1", 0))
try:
    TactorDevice(port=mute.getsockname()[1])
except ConnectionError as e:
    print(e)
"""


def events(*steps):
    """Returns input events as the kernel writes them: (type, code, value) each, and SYN_REPORT after each step."""
    return b"".join(struct.pack("@llHHi", 0, 0, *e) for step in steps for e in (*step, (SYN, 0, 0)))


def touch(x, y, *more):
    return (*more, (ABS, 0, x), (ABS, 1, y))


class Examples(ToolTest):
    def start(self, name, *args):
        return self.start_tool(*args, program=EXAMPLES / name, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def run_example(self, name, *args, status=0):
        p = self.start(name, *args)
        out, err = p.communicate(timeout=PATIENCE_S)
        self.assertEqual(p.returncode, status, err)
        return out if status == 0 else err

    def test_each_example_is_short_and_tested(self):
        sources = sorted((pathlib.Path(__file__).resolve().parents[2] / "examples").glob("*.cpp"))
        tested = pathlib.Path(__file__).read_text(encoding="utf-8")
        self.assertGreaterEqual(len(sources), 6)
        for source in sources:
            text = source.read_text(encoding="utf-8")
            self.assertLess(text.count("\n"), 80, source)
            if "tactor::player" in text:  # a first try on somebody's skin
                self.assertIn("level_dbfs = -40.0", text, source)
            self.assertIn(f'"{source.stem}"', tested)
            self.assertRegex(text.splitlines()[1], r"^// \w", source)

    def test_play_preset(self):
        self.assertEqual(self.run_example("play_preset"), "finished after 104160 frames\n")
        self.assertIn("nowhere", self.run_example("play_preset", "nowhere", status=1))

    def test_render_wav_writes_the_tool_s_bytes(self):
        out = self.run_example("render_wav", "a.wav")
        self.assertRegex(out, r"a\.wav: 9 channels, \d\.\d{3} s")
        self.ok("render", "--path", "M 0 10 C 20 -5 20 45 40 30", "--speed", "80", "--phantom", "barycentric",
                "--level-dbfs", "-6", "--sample-format", "s24", "-o", "b.wav")
        own, tools = ((self.dir / name).read_bytes() for name in ("a.wav", "b.wav"))
        self.assertEqual(own[8:], tools[8:len(own)])  # the tool's mark follows, and counts in the size of the file
        self.assertIn("usage", self.run_example("render_wav", status=2))

    def test_own_phantom(self):
        def errors(*args):
            rows = re.findall(r"^(\S+) +RMS error ([\d.]+) mm, CV of speed ([\d.]+)$",
                              self.run_example("own_phantom", *args), re.M)
            self.assertEqual([r[0] for r in rows], ["inverse-distance", "barycentric", "inverse-power"])
            return [float(r[1]) for r in rows]

        squared, paper = errors(), errors(1)
        self.assertEqual(squared[:2], [2.09, 1.43])  # the values of `tactor compare park2016-3`
        self.assertEqual(paper[:2], squared[:2])
        self.assertNotEqual(paper[2], squared[2])
        self.assertLess(max(paper[2], squared[2]), 10.0)

    def heard(self, file, channel):
        """Returns whether a raw file of nine channels of s32 has sound on a channel in its last 0.1 s."""
        if not file.exists():
            return False
        with open(file, "rb") as f:
            f.seek(max(0, os.fstat(f.fileno()).st_size // 36 - 4800) * 36)
            samples = memoryview(f.read(4800 * 36))
        samples = samples[:len(samples) // 36 * 36].cast("i")
        return any(samples[channel::9])

    def live_touches(self):
        """Returns the ends of the strokes of two touches: down in one corner, at rest, to the other, up; and once more."""
        raw, pipe = self.dir / "out.raw", self.dir / "events"
        os.mkfifo(pipe)
        p = self.start("live_touch", pipe, f"raw:{raw}")
        with open(pipe, "wb", buffering=0) as finger:
            finger.write(events(touch(0, 0, (KEY, BTN_TOUCH, 1))))
            self.until(lambda: self.heard(raw, 0), p)
            # A second of rest, twice the life of a stroke without points.
            size = raw.stat().st_size
            self.until(lambda: raw.stat().st_size > size + 48000 * 36, p)
            self.assertFalse(self.heard(raw, 8))
            finger.write(events(touch(4095, 4095)))
            self.until(lambda: self.heard(raw, 8) and not self.heard(raw, 0), p)
            finger.write(events([(KEY, BTN_TOUCH, 0)]))
            self.until(lambda: not self.heard(raw, 8), p)
            # A second touch, which the end of the events ends.
            finger.write(events(touch(4095, 0, (KEY, BTN_TOUCH, 1))))
            self.until(lambda: self.heard(raw, 2), p)
        out, err = p.communicate(timeout=PATIENCE_S)
        self.assertEqual((p.returncode, err), (0, ""))
        return out.splitlines()

    def test_live_touch_follows_a_finger(self):
        ends = self.live_touches()
        # A program without processor time has its stroke interrupted, and the next one goes on: timed/test_live_touch.py checks
        # that a finger at rest keeps one alive.
        self.assertGreaterEqual(len(ends), 2)
        self.assertLessEqual(set(ends), {"finished", "interrupted"})

    def test_live_touch_follows_a_mouse_in_a_recording(self):
        left = [(KEY, BTN_LEFT, 1)], [(REL, 0, -1000), (REL, 1, 1000)], [(KEY, BTN_LEFT, 0)]
        self.write("mouse", events([(REL, 0, 30)], *left, *left))
        self.assertEqual(self.run_example("live_touch", "mouse"), "finished\nfinished\n")
        self.assertIn("usage", self.run_example("live_touch", "nothing-here", status=2))

    def test_asio_server_answers_when_a_stroke_has_been_felt(self):
        p = self.start("asio_server", 0)
        port = int(re.fullmatch(r"listening on port (\d+)\n", p.stdout.readline())[1])
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as s:
            s.settimeout(PATIENCE_S)
            for request in ("park2016-1", "park2016-2", "park2016-9"):
                s.sendto(request.encode(), ("127.0.0.1", port))
            answers = sorted(s.recv(1000).decode() for _ in range(3))
            self.assertEqual(answers[:2], ["park2016-1: finished", "park2016-2: finished"])
            self.assertIn("park2016-4", answers[2])  # the existing presets
            s.sendto(b"park2016-3", ("127.0.0.1", port))
        p.send_signal(signal.SIGTERM)
        self.assertEqual(p.communicate(timeout=PATIENCE_S), ("", ""))
        self.assertEqual(p.returncode, 0)

    def test_udp_sink_sends_render_s_bytes(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as s:
            # Room for all of them, however late this reads. Only root may have as much.
            with contextlib.suppress(PermissionError):
                s.setsockopt(socket.SOL_SOCKET, SO_RCVBUFFORCE, 1 << 24)
            room_for_all = s.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF) >= 1 << 24
            s.bind(("127.0.0.1", 0))
            p = self.start("udp_sink", "127.0.0.1", s.getsockname()[1])
            datagrams = {}
            while p.poll() is None or select.select([s], [], [], 0)[0]:
                if select.select([s], [], [], 0.01)[0]:
                    d = s.recv(2000)
                    datagrams[struct.unpack("<Q", d[:8])[0]] = d[8:]
        self.assertEqual(p.communicate(timeout=PATIENCE_S), ("finished\n", ""))
        self.ok("render", "park2016-1", "--level-dbfs", "-40", "--sample-format", "s16", "-o", "o.wav")
        data = Wav(self.dir / "o.wav").data
        # Each at its number; packets beyond a smaller buffer are lost.
        numbers = range(0, max(datagrams) + 48, 48)
        self.assertLessEqual(set(datagrams), set(numbers))
        self.assertEqual({len(d) for d in datagrams.values()}, {48 * 18})
        if room_for_all:
            self.assertEqual(set(datagrams), set(numbers))
            sound = b"".join(datagrams[n] for n in numbers).strip(b"\0")
            self.assertIn(sound, data)
            self.assertGreater(len(sound), 18 * 48000)
        for d in datagrams.values():
            self.assertIn(d.strip(b"\0"), data)
        self.assertIn("usage", self.run_example("udp_sink", status=2))

    def test_serve_client(self):
        server = Server(self)
        self.assertEqual(self.run_example("serve_client", server.where["socket"]), "park2016-1: finished\ncircle: finished\n")
        self.assertIn("No such file", self.run_example("serve_client", self.dir / "nowhere", status=1))

    def test_the_shells_serve_client(self):
        server = Server(self)
        for stroke, said in (("park2016-1", "finished\n"), ("nonsense", "refused: ")):
            r = subprocess.run([ROOT / "examples/serve_client.sh", server.where["socket"], stroke], capture_output=True, text=True,
                               check=False, timeout=PATIENCE_S)
            self.assertEqual(r.returncode, 0, r.stderr)
            self.assertTrue(r.stdout.startswith(said), r.stdout)

    def test_psychopy(self):
        server = Server(self, "--tcp", "0")
        port = server.where["tcp"].rpartition(":")[2]
        here = {"PYTHONPATH": os.pathsep.join(str(ROOT / f) for f in ("tests/examples/stand_in", "examples/psychopy")), "PYTHONDONTWRITEBYTECODE": "1"}

        def python(*args, cwd=None):
            return subprocess.run([sys.executable, *map(str, args)], capture_output=True, text=True, check=False, env=self.env | here,
                                  timeout=PATIENCE_S, cwd=cwd)

        before = time.monotonic()
        r = python("-c", "import runpy, psychopy_tactor; psychopy_tactor.SILENCE_S = 600; runpy.run_path('trial.py')", port, cwd=ROOT / "examples/psychopy")
        self.assertEqual((r.returncode, r.stderr), (0, ""))
        head, *rows = (line.split("\t") for line in r.stdout.splitlines())
        trials = [dict(zip(head, row)) for row in rows]
        self.assertEqual([(t["stroke"], t["state"]) for t in trials], [(n, "finished") for n in ("left", "right", "right", "left")])
        onsets = [float(t["onset_s"]) + 1234.5 for t in trials]  # the stand-in's clock
        self.assertTrue(before < onsets[0] < onsets[3] < time.monotonic(), onsets)
        # Whoever answers at once does so before the onset, which was asked for 0.1 s later.
        self.assertTrue(all(-PATIENCE_S < float(t["response_time_s"]) < float(t["within_s"]) for t in trials), trials)

        watcher = server.watcher()
        program = self.write("program.py", PSYCHOPY.replace("PORT", port))
        r = python(program)
        self.assertEqual((r.returncode, r.stderr), (0, ""))
        refused, away, same, lost = r.stdout.splitlines()
        self.assertIn("tactor: stroke: there is no preset 'nowhere'", refused)
        self.assertRegex(away, r"^tactor: 127\.0\.0\.1:1: .*Connection refused \(start tactor serve --tcp 1\)$")
        self.assertEqual((same, lost), ("True False", "tactor: the service has not answered for 1 s"))
        # Closed by the device manager, which had not waited for its stroke.
        self.assertEqual(watcher.notification(lambda m: m["params"]["state"] == "cancelled")["params"]["reason"], "cancelled by its client")

        entry = tomllib.loads((ROOT / "examples/psychopy/pyproject.toml").read_text(encoding="utf-8"))["project"]["entry-points"]["psychopy.hardware"]
        self.assertEqual(entry, {"TactorDevice": "psychopy_tactor:TactorDevice"})

    def test_the_lines_for_any_runner(self):
        page = (ROOT / "man/guide/runners.md").read_text(encoding="utf-8")
        blocks = [[json.loads(line) for line in block.split("\n")] for block in re.findall(r'^    (\{"jsonrpc".*(?:\n    \{.*)*)$', page, re.M)]
        play, end = blocks[:2]
        self.assertEqual([m["method"] for m in play + end], ["hello", "play", "play", "cancel", "stop"])
        c = Server(self, "--tcp", "0").client(tcp=True)
        # Sends all lines at once, as printed: both strokes are played.
        for m in play:
            c.send(m)
        strokes = [c.reply()["result"].get("stroke") for _ in play][1:]
        self.assertEqual([c.await_end(stroke)["state"] for stroke in strokes], ["finished", "finished"])
        for m in end:
            c.send(play[2])
            stroke = c.reply()["result"]["stroke"]
            c.send(m)
            c.reply()
            self.assertEqual(c.await_end(stroke)["state"], "cancelled")

    def test_the_serve_client_of_node(self):
        server = Server(self)
        for socket, status, said in ((server.where["socket"], 0, ("park2016-1: finished\ncircle: finished\n", "")),
                                     (self.dir / "nowhere", 1, ("", f"serve_client: connect ENOENT {self.dir}/nowhere\n"))):
            r = subprocess.run(["node", ROOT / "examples/serve_client.js", socket], capture_output=True, text=True, check=False, timeout=PATIENCE_S)
            self.assertEqual((r.returncode, r.stdout, r.stderr), (status, *said))

    @unittest.skipUnless(os.environ.get("TACTOR_OSC") == "true", "this build has no OSC")
    def test_the_patch_for_pure_data(self):
        server = Server(self, "--osc", "0")
        port = server.where["osc"].rpartition(":")[2]
        patch = self.write("client.pd", (ROOT / "examples/serve_client.pd").read_text(encoding="utf-8").replace("4002", port))
        pd = self.start_tool("-nogui", "-noaudio", "-nomidi", "-open", patch, "-send", "play bang", program="pd", env=None,
                             stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        said = []
        for line in pd.stderr:
            said.append(line.strip())
            if said[-1] == "print: tactor stroke 1 finished":
                break
        self.assertIn("print: tactor stroke 1 started", said)
        self.assertEqual(said[-1], "print: tactor stroke 1 finished")


if __name__ == "__main__":
    main()
