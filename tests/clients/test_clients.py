# SPDX-License-Identifier: MIT
"""tactor serve with other people's programs: wscat, and SuperCollider and C# with the examples for them. Usage:
test_clients.py TOOL SOURCE_ROOT WSCAT"""
import json
import os
import pathlib
import pty
import re
import shutil
import subprocess
import sys
import threading
import unittest

WSCAT = pathlib.Path(sys.argv.pop(3))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from harness import PATIENCE_S, ROOT, ToolTest, Wav, main  # noqa: E402
from osc import Sender  # noqa: E402
from serving import LONG, MESSAGE, Server, ServeTest  # noqa: E402


class Program:
    """A process whose lines can be awaited; keeps its output in `said`."""

    def __init__(self, test, command, fd=None, **more):
        self.said = []
        self.process = test.start_tool(*command[1:], program=command[0], **more)
        self.output = self.process.stdout if fd is None else os.fdopen(fd, "rb")
        test.addCleanup(self.output.close)
        # A process that hangs is ended, and its lines with it.
        patience = threading.Timer(PATIENCE_S, self.process.kill)
        patience.start()
        test.addCleanup(patience.cancel)

    def until(self, pattern):
        """Returns the match in the first line from here on that has it."""
        for line in self.lines():
            if found := re.search(pattern, line):
                return found
        raise AssertionError(f"no {pattern!r} in {self.said}")

    def lines(self):
        while True:
            try:
                line = self.output.readline()
            except OSError:  # a terminal's end
                line = b""
            if not line:
                return
            # The text without cursor movements and overwritten parts.
            self.said.append(re.sub(r"\x1b\[[0-9;]*[A-Za-z]", "", line.decode()).strip().rpartition("\r")[2])
            yield self.said[-1]


class Wscat(ServeTest):
    def serve(self):
        s = super().serve("--http", "0")
        s.rpc = s.where["http"].replace("http:", "ws:") + "rpc"
        return s

    def on_a_terminal(self, s, *args):
        """A terminal: only there it prints how connections end."""
        screen, terminal = pty.openpty()
        p = Program(self, ["node", WSCAT, "--no-color", "-c", s.rpc, *args], fd=screen, stdin=subprocess.PIPE, stdout=terminal,
                    stderr=terminal)
        os.close(terminal)
        p.until("^Connected")
        return p

    def type(self, p, line):
        p.process.stdin.write(line.encode() + b"\n")
        p.process.stdin.flush()

    def message(self, p):
        m = json.loads(p.until(r"^< (\{.*\})$")[1])
        MESSAGE.validate(m)
        return m

    def call(self, p, method, **params):
        self.type(p, json.dumps({"jsonrpc": "2.0", "id": 7, "method": method, "params": params}))
        m = self.message(p)
        self.assertEqual(m["id"], 7)
        return m["result"]

    def run_wscat(self, s, *args):
        # Ends at the end of its input.
        held = os.pipe()
        for end in held:
            self.addCleanup(os.close, end)
        return subprocess.run(["node", WSCAT, "-c", s.rpc, *args], stdin=held[0], capture_output=True, text=True, timeout=PATIENCE_S,
                              check=False)

    def test_a_conversation(self):
        s = self.serve()
        p = self.on_a_terminal(s, "--slash", "-P")
        told = self.call(p, "hello")
        self.assertEqual((told["protocol"], told["array"]["name"], len(told["array"]["tactors"])), ("tactor/1", "palm-3x3", 9))
        number = self.call(p, "play", stroke="park2016-1")["stroke"]
        ends = [self.message(p), self.message(p)]
        self.assertEqual([(m["method"], m["params"]["stroke"], m["params"]["state"]) for m in ends],
                         [("stroke", number, "started"), ("stroke", number, "finished")])
        self.assertEqual(ends[1]["params"]["frames"], 70560)
        self.type(p, "/ping anybody?")
        p.until(r'^< Received pong \(data: "anybody\?"\)$')
        self.type(p, "/close 1000 done")
        self.assertEqual(p.until(r'^Disconnected \(code: (\d+)')[1], "1000")
        self.assertEqual(p.process.wait(PATIENCE_S), 0)
        self.assertEqual(s.client().ok("status")["clients"], 1)

    def test_the_server_ends(self):
        s = self.serve()
        p = self.on_a_terminal(s)
        self.call(p, "hello")
        s.process.terminate()
        self.assertEqual(self.message(p)["params"]["state"], "closing")
        self.assertEqual(p.until(r'^Disconnected \(code: (\d+)')[1], "1001")
        self.assertEqual(s.process.wait(PATIENCE_S), 0)

    def test_one_call_in_one_line_of_shell(self):
        # It closes as soon as it has asked, and is still answered.
        r = self.run_wscat(self.serve(), "-w", "0", "-x", '{"jsonrpc":"2.0","id":1,"method":"hello"}')
        self.assertEqual((r.returncode, r.stderr), (0, ""))
        self.assertEqual(json.loads(r.stdout)["result"]["protocol"], "tactor/1")

    def test_origins(self):
        s = self.serve()
        for origin in ("http://evil.example", "null"):
            r = self.run_wscat(s, "-o", origin)
            self.assertEqual((r.returncode, r.stdout, r.stderr), (255, "", "error: Unexpected server response: 403\n"))
        self.call(self.on_a_terminal(s, "-o", s.where["http"].rstrip("/")), "hello")


    def test_a_program_for_the_older_bhaptics_protocol(self):
        s = ServeTest.serve(self, "--bhaptics", "0")
        s.rpc = s.where["bhaptics"] + "?app_id=game&app_name=game"
        p = self.on_a_terminal(s)
        project = json.loads((ROOT / "examples/strokes/swipe.tact").read_text(encoding="utf-8"))["project"]
        self.type(p, json.dumps({"Register": [{"Key": "swipe", "Project": project}]}))
        p.until(r'^< \{.*"RegisteredKeys":\["swipe"\]')
        watcher = s.watcher()
        self.type(p, json.dumps({"Submit": [{"Type": "key", "Key": "swipe", "Parameters": {"scaleOption": {"intensity": 1, "duration": 0.5}}}]}))
        p.until(r'^< \{.*"ActiveKeys":\["swipe"\]')
        p.until(r'^< \{.*"ActiveKeys":\[\]')
        end = watcher.notification(lambda m: m["method"] == "stroke" and m["params"]["state"] != "started")["params"]
        self.assertEqual(end["state"], "finished")
        self.assertLess(end["frames"], 30000)  # the file lasts 0.9 s


# Evaluates a block of the example, as Ctrl-Return does, when it gets its number.
DRIVER = r"""
OSCdef(\evaluate, { |m| File.readAllString("FOLDER/block" ++ m[1]).interpret }, '/evaluate');
OSCdef(\leave, { 0.exit }, '/leave');
"evaluates at %".format(NetAddr.langPort).postln;
"""
# sclang is linked with Qt's browser, which does not run as root otherwise, and needs a screen where nothing is shown.
NO_SCREEN = {"QT_QPA_PLATFORM": "offscreen", "QTWEBENGINE_DISABLE_SANDBOX": "1"}


def blocks(text):
    """Returns the blocks that Ctrl-Return evaluates, in turn: from a ( that begins a line to the ) that does, or a line."""
    return re.findall(r"^\((?s:.*?)^\)|^[^\s(/)].*", text, re.M)


@unittest.skipUnless(shutil.which("sclang"), "sclang is not here")
class SuperCollider(ToolTest):
    def start(self, parts):
        for number, code in enumerate(parts):
            self.write(f"block{number}", code)
        driver = self.write("driver.scd", DRIVER.replace("FOLDER", str(self.dir)))
        # Without the user's files, and leaving none in their home.
        env = self.env | NO_SCREEN | {"HOME": str(self.dir), "XDG_CONFIG_HOME": str(self.dir / "config"), "XDG_DATA_HOME": str(self.dir / "data"),
                                      "XDG_RUNTIME_DIR": str(self.dir)}
        p = Program(self, ["sclang", driver], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=env)
        where = p.until(r"^evaluates at (\d+)$")[1]
        return p, Sender(self, type("At", (), {"where": {"osc": f"127.0.0.1:{where}"}}))

    def test_the_example(self):
        felt = self.dir / "felt.raw"
        s = Server(self, "--osc", "0", device=("-D", f"raw:{felt}"))
        watcher = s.watcher()
        port = s.where["osc"].rpartition(":")[2]
        parts = blocks((ROOT / "examples/serve_client.scd").read_text(encoding="utf-8").replace("4002", port))
        self.assertEqual(len(parts), 6)
        handlers, preset, circle, later, levels, stop = range(6)
        p, sclang = self.start(parts)

        sclang.say("/evaluate", handlers)
        for number, block in ((1, preset), (2, circle), (3, later)):
            sclang.say("/evaluate", block)
            p.until(f"^stroke {number}: started$")
            p.until(f"^stroke {number}: finished$")
        of_preset, of_circle = (watcher.notification(lambda m: m["params"]["state"] != "started")["params"] for _ in range(2))
        self.assertEqual((of_preset["state"], of_preset["frames"]), ("finished", 70560))
        # A second of points, however late they were sent.
        self.assertEqual(of_circle["state"], "finished")
        self.assertGreater(of_circle["frames"], 40000)

        other = Sender(self, s)
        other.say("/tactor/play", 1, "M 0 0 L 40 40", "duration=300")
        self.assertEqual(other.next(), ["/tactor/stroke", 1, "started"])
        sclang.say("/evaluate", levels)
        while max(dbfs := [float(v) for v in p.until(r"^\[ (-?\d.*) \]$")[1].split(",")]) < -30:
            pass
        self.assertEqual(len(dbfs), 9)
        self.assertEqual(min(dbfs), -200)
        sclang.say("/evaluate", stop)
        self.assertEqual(other.next(), ["/tactor/stroke", 1, "cancelled"])

        sclang.say("/leave")
        self.assertEqual([line for line in p.lines() if line.startswith("stroke")], [])
        self.assertEqual(p.process.wait(PATIENCE_S), 0)
        self.assertEqual([line for line in p.said if "ERROR" in line or "WARNING" in line], [])
        self.assertEqual(s.terminate()[0], 0)
        self.ok("render", "park2016-1", "--sample-format", "s32", "-o", "rendered.wav")
        self.assertIn(Wav(self.dir / "rendered.wav").data.strip(b"\0"), felt.read_bytes())


@unittest.skipUnless(shutil.which("mcs") and shutil.which("mono"), "Mono is not here")
class CSharp(ServeTest):
    def setUp(self):
        super().setUp()
        source = ROOT / "examples/serve_client.cs"
        compiler, *options = re.search(r"^//   (mcs .*)$", source.read_text(encoding="utf-8"), re.M)[1].split()
        self.env |= {"HOME": str(self.dir), "LC_ALL": "C.UTF-8"}
        built = self.start_tool(*options[:-1], "-warnaserror", f"-out:{self.dir}/serve_client.exe", source, program=compiler,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.assertEqual((built.communicate(timeout=PATIENCE_S)[0], built.returncode), ("", 0))

    def start_client(self, server, *args):
        host, _, port = server.where["tcp"].rpartition(":")
        stroke, *token = args or ["park2016-1"]
        return self.start_tool(self.dir / "serve_client.exe", stroke, host, port, *token, program="mono", stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)

    def check_end(self, client, status, out, err):
        self.assertEqual((*client.communicate(timeout=PATIENCE_S), client.returncode), (out, err, status))

    def test_a_stroke_is_played_to_its_end(self):
        felt = self.dir / "felt.raw"
        s = self.serve("--tcp", "0", device=("-D", f"raw:{felt}"))
        self.check_end(self.start_client(s), 0, "park2016-1: finished\n", "")
        self.assertEqual(s.terminate()[0], 0)
        self.ok("render", "park2016-1", "--sample-format", "s32", "-o", "rendered.wav")
        self.assertIn(Wav(self.dir / "rendered.wav").data.strip(b"\0"), felt.read_bytes())

    def test_a_name_with_quotes_reaches_the_service(self):
        nowhere = 'no "where"\\ \u00e9'
        p = self.start_client(self.serve("--tcp", "0"), nowhere)
        out, err = p.communicate(timeout=PATIENCE_S)
        self.assertEqual((p.returncode, out), (1, ""))
        self.assertTrue(err.startswith(f"serve_client: stroke: there is no preset '{nowhere}'"), err)

    def test_a_token(self):
        s = self.serve("--tcp", "0", config=self.token())
        self.check_end(self.start_client(s, "park2016-1", "secret"), 0, "park2016-1: finished\n", "")
        p = self.start_client(s, "park2016-1", "guess")
        self.assertIn("token", p.communicate(timeout=PATIENCE_S)[1])
        self.assertEqual(p.returncode, 1)

    def test_a_stroke_that_is_stopped(self):
        s = self.serve("--tcp", "0")
        watcher = s.watcher()
        other = s.client()
        other.ok("play", **LONG)  # its end is not taken for the client's
        p = self.start_client(s)
        for _ in range(2):
            watcher.notification(lambda m: m["params"]["state"] == "started")
        watcher.ok("stop")
        self.check_end(p, 1, "park2016-1: cancelled\n", "")

    def test_a_service_that_ends_or_is_not_there(self):
        s = self.serve("--tcp", "0")
        watcher = s.watcher()
        p = self.start_client(s)
        watcher.notification(lambda m: m["params"]["state"] == "started")
        s.kill()
        self.check_end(p, 1, "", "serve_client: the service closed the connection\n")
        self.check_end(self.start_client(s), 1, "", "serve_client: Connection refused\n")


if __name__ == "__main__":
    main()
