# SPDX-License-Identifier: MIT
"""A server of the tool, and clients that speak its protocol, for the tests."""
import json
import signal
import socket
import subprocess

import jsonschema

from harness import PATIENCE_S, TOOL, ToolTest, end_process

# Every message of a server is checked against its schema.
SCHEMA = json.loads((TOOL.parent / "schemas/tactor-protocol-1.schema.json").read_text(encoding="utf-8"))
MESSAGE = jsonschema.Draft202012Validator(SCHEMA)
RESULTS = {method: jsonschema.Draft202012Validator({"$ref": f"#/$defs/results/properties/{method}", "$defs": SCHEMA["$defs"]})
           for method in SCHEMA["$defs"]["results"]["properties"]}

LONG = {"path": "M 0 0 L 40 40", "options": {"algorithm": "continuous", "duration": 300}}
SHORT = {"path": "M 0 0 L 40 40", "options": {"algorithm": "continuous", "duration": 0.05}}


class Client:
    """A connection. Keeps replies and notifications until a test asks for them."""

    def __init__(self, address):
        family = socket.AF_UNIX if isinstance(address, str) else socket.AF_INET
        self.socket = socket.socket(family, socket.SOCK_STREAM)
        self.socket.settimeout(PATIENCE_S)
        self.socket.connect(address)
        self.buffer = bytearray()
        self.told = []
        self.last = 0

    def send(self, message):
        self.raw(json.dumps(message).encode() + b"\n")

    def raw(self, data):
        self.socket.sendall(data)

    def next(self):
        """Returns the next message; None at the end."""
        looked = 0
        while (end := self.buffer.find(b"\n", looked)) < 0:
            looked = len(self.buffer)
            try:
                more = self.socket.recv(65536)
            except ConnectionResetError:
                return None
            if not more:
                return None
            self.buffer += more
        message = json.loads(self.buffer[:end])
        del self.buffer[:end + 1]
        MESSAGE.validate(message)
        return message

    def reply(self):
        """Returns the next message that is no notification."""
        while True:
            m = self.next()
            if m is None or isinstance(m, list) or "method" not in m:
                return m
            self.told.append(m)

    def call(self, method, **params):
        self.last += 1
        self.send({"jsonrpc": "2.0", "id": self.last, "method": method, "params": params})
        r = self.reply()
        assert r is not None and r["id"] == self.last, r
        return r

    def ok(self, method, **params):
        r = self.call(method, **params)
        assert "result" in r, r
        RESULTS[method].validate(r["result"])
        return r["result"]

    def error(self, method, **params):
        r = self.call(method, **params)
        assert "error" in r, r
        return r["error"]

    def notification(self, matches):
        """Returns the first message that matches, of those received and those to come."""
        for i, m in enumerate(self.told):
            if matches(m):
                return self.told.pop(i)
        while True:
            m = self.next()
            assert m is not None, "the connection ended"
            if "method" in m and matches(m):
                return m
            self.told.append(m)

    def stroke(self, number, *states):
        return self.notification(lambda m: m["method"] == "stroke" and m["params"]["stroke"] == number
                                 and m["params"]["state"] in states)["params"]

    def await_end(self, number):
        return self.stroke(number, "finished", "cancelled", "interrupted")

    def close(self):
        self.socket.close()


class Server:
    """`tactor serve`, listening once this is made; `where` is where it says that it listens."""

    def __init__(self, test, *args, env=None, device=("-D", "null"), config="", inherits=(), **more):
        """inherits: (name, socket) of the sockets that it gets as from systemd; more: of Popen."""
        self.test = test
        file = test.write("serve.toml", config)
        socket_option = () if "--socket" in args or env or inherits else ("--socket", str(test.dir / "s.sock"))
        command = [TOOL, "serve", *socket_option, *device, "--config", file, "--format", "json", *map(str, args)]
        env = test.env | (env or {})
        if inherits:  # LISTEN_PID must be that process, so a shell sets it
            passed = "".join(f"exec {3 + i}<&{s.fileno()}; " for i, (_, s) in enumerate(inherits))
            command = ["sh", "-c", f'{passed}export LISTEN_PID=$$; exec "$@"', "sh", *command]
            env |= {"LISTEN_FDS": str(len(inherits)), "LISTEN_FDNAMES": ":".join(name for name, _ in inherits)}
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=test.dir, env=env,
                                        pass_fds=[s.fileno() for s in {s for _, s in inherits}], **more)
        test.addCleanup(self.kill)
        line = self.process.stdout.readline()
        self.where = json.loads(line) if line else None
        if not line:
            self.process.wait(PATIENCE_S)
            self.errors = self.process.stderr.read()

    def client(self, tcp=False):
        address = self.where["socket"]
        if tcp:
            host, _, port = self.where["tcp"].rpartition(":")
            address = (host, int(port))
        c = Client(address)
        self.test.addCleanup(c.close)
        return c

    def watcher(self, *events):
        """Returns a client that hears of the strokes of all, or of other events."""
        c = self.client()
        c.ok("subscribe", events=events or ["strokes"])
        return c

    def terminate(self, with_signal=signal.SIGTERM):
        """Ends it; returns its exit status and the rest of its output."""
        self.process.send_signal(with_signal)
        out, err = self.process.communicate(timeout=PATIENCE_S)
        return self.process.returncode, out, err

    def kill(self):
        end_process(self.process)


class ServeTest(ToolTest):
    """Tests that start servers and check their refusals."""

    def serve(self, *args, **more):
        s = Server(self, *args, **more)
        if s.where is None:
            self.fail(s.errors)
        return s

    def refuses_to_start(self, status, *args, says, **more):
        s = Server(self, *args, **more)
        self.assertIsNone(s.where)
        self.assertEqual(s.process.returncode, status, s.errors)
        self.assertIn(says, s.errors)

    def token(self, text="secret"):
        """Returns the part of a configuration that asks for a token."""
        file = self.write("token", text + "\n")
        file.chmod(0o600)
        return f'[serve]\ntoken_file = "{file}"\n'

    def check_error(self, error, code, what=None):
        self.assertEqual(error["code"], code, error)
        self.assertEqual(set(error["data"]) - {"line", "column"}, {"kind", "what", "why", "hint"})
        self.assertNotIn("--", json.dumps(error))
        self.assertTrue(error["data"]["what"] and error["data"]["why"], error)
        if what is not None:
            self.assertEqual(error["data"]["what"], what, error)
