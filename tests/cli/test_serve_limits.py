# SPDX-License-Identifier: MIT
"""tactor serve at its limits: too many, too long, too slow, no descriptors, a full disk, no card."""
import contextlib
import itertools
import json
import os
import resource
import socket
import subprocess
import time

from harness import PATIENCE_S, TOOL, main
from serving import LONG, SHORT, Client, ServeTest


class Limits(ServeTest):
    # Limits.

    def test_strokes_at_once_are_limited(self):
        c = self.serve(config="[serve]\nmax_strokes = 3\nmax_live_strokes = 1\n").client()
        c.ok("begin", timeout_s=3600)
        self.check_error(c.error("begin"), -32001, "max_live_strokes")
        for _ in range(2):
            c.ok("play", **SHORT, start="armed")
        self.check_error(c.error("play", **SHORT), -32001, "max_strokes")
        self.check_error(c.error("drive", tactor=0), -32001, "max_strokes")

    def test_the_length_and_the_points_of_strokes_are_limited(self):
        c = self.serve(config="[serve]\nmax_points_per_s = 5\nmax_stroke_s = 300\n").client()
        self.check_error(c.error("play", path="M 0 0 L 40 40", options={"algorithm": "continuous", "duration": 300.1}),
                         -32001, "max_stroke_s")
        n = c.ok("begin", timeout_s=3600)["stroke"]
        # At once: five more may come each second.
        c.raw(b"".join(json.dumps({"jsonrpc": "2.0", "id": i, "method": "to", "params": {"stroke": n, "x_mm": 1, "y_mm": 1}}).encode()
                       + b"\n" for i in range(100)))
        codes = [c.reply().get("error", {}).get("code") for _ in range(100)]
        self.assertEqual(codes[:5], [None] * 5)
        self.assertIn(-32001, codes)

    # Exhaustion.

    def test_exhausted_descriptors_refuse_new_clients(self):
        s = self.serve("--http", "0")
        busy = s.client()
        live = busy.ok("begin", timeout_s=3600)["stroke"]
        busy.ok("to", stroke=live, x_mm=10, y_mm=10)
        busy.stroke(live, "started")
        pid = s.process.pid
        used = len(os.listdir(f"/proc/{pid}/fd"))
        before = resource.prlimit(pid, resource.RLIMIT_NOFILE)
        highest = max(map(int, os.listdir(f"/proc/{pid}/fd")))
        resource.prlimit(pid, resource.RLIMIT_NOFILE, (highest + 1, before[1]))
        space = highest + 1 - used  # gaps among the open ones
        for c in [s.client() for _ in range(space + 10)][space:]:
            self.check_error(c.next()["error"], -32001, "descriptors")
            self.assertIsNone(c.next())
        host, _, port = s.where["http"].removeprefix("http://").rstrip("/").rpartition(":")
        with socket.create_connection((host, int(port)), PATIENCE_S) as page:
            self.assertTrue(page.recv(65536).startswith(b"HTTP/1.1 503 "))
        # Present clients go on.
        busy.ok("to", stroke=live, x_mm=20, y_mm=20)
        self.assertEqual(busy.await_end(busy.ok("play", **SHORT)["stroke"])["state"], "finished")
        resource.prlimit(pid, resource.RLIMIT_NOFILE, before)
        self.assertEqual(s.client().ok("hello")["protocol"], "tactor/1")
        busy.ok("end", stroke=live)
        self.assertEqual(busy.await_end(live)["state"], "finished")
        self.assertEqual(busy.ok("status")["stream"]["xruns"], 0)
        self.assertEqual(s.terminate()[0], 0)

    def test_a_full_disk_ends_only_the_log(self):
        log = self.dir / "serve.log"
        s = self.serve("--log", log)
        c = s.client()
        c.await_end(c.ok("play", **SHORT)["stroke"])
        self.assertRegex(log.read_text(), r" info stroke 1 of client \d+: began \S+Z \(\d+\.\d{6} s by CLOCK_MONOTONIC\), finished after 0\.05")
        # No further byte, like on a full disk: the log ends with the reason, and nothing else does.
        resource.prlimit(s.process.pid, resource.RLIMIT_FSIZE, (log.stat().st_size, resource.RLIM_INFINITY))
        self.assertEqual(c.await_end(c.ok("play", **SHORT)["stroke"])["state"], "finished")
        status, _, err = s.terminate()
        self.assertEqual(status, 0, err)
        self.assertIn("serve.log: File too large: the log ends here", err)
        self.assertFalse(os.path.exists(s.where["socket"]))

    def test_unwritable_standard_output_does_not_stop_it(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("there is no /dev/full")
        file = str(self.dir / "full.sock")
        with open("/dev/full", "w", encoding="ascii") as full:
            p = subprocess.Popen([TOOL, "serve", "-D", "null", "--socket", file], stdout=full, stderr=subprocess.PIPE, text=True,
                                 cwd=self.dir, env=self.env)
        self.addCleanup(p.stderr.close)
        said = next(line for line in p.stderr if "standard output" in line)
        self.assertIn("No space left on device: where it listens could not be said", said)
        c = Client(file)
        self.assertEqual(c.await_end(c.ok("play", **SHORT)["stroke"])["state"], "finished")
        c.close()
        p.terminate()
        self.assertEqual(p.wait(PATIENCE_S), 0)

    def test_places_are_limited_and_freed(self):
        s = self.serve("--tcp", "0", config="[serve]\nmax_clients = 4\nkept_clients = 2\n")
        for _ in range(3):  # a place that leaks shows in the second round
            network = [s.client(tcp=True) for _ in range(2)]
            for c in network:
                c.ok("hello")
            third = s.client(tcp=True)
            refused = third.next()["error"]
            self.check_error(refused, -32001, "max_clients")
            self.assertIn("4 clients are the most, 2 of them on this machine's socket", refused["message"])
            self.assertIsNone(third.next())
            local = [s.client() for _ in range(2)]
            for c in local:
                self.assertEqual(c.ok("hello")["protocol"], "tactor/1")
            fifth = s.client()
            self.check_error(fifth.next()["error"], -32001, "max_clients")
            for c in network + local[1:]:
                c.socket.shutdown(socket.SHUT_WR)
                self.assertIsNone(c.next())
            self.assertEqual(local[0].ok("status")["clients"], 1)
            local[0].socket.shutdown(socket.SHUT_WR)
            self.assertIsNone(local[0].next())

    def test_messages_that_are_too_long_or_too_slow_are_refused(self):
        c = self.serve(config="[serve]\nmax_message_bytes = 2000\n").client()
        c.raw(b" " * 2001)
        self.check_error(c.next()["error"], -32001, "max_message_bytes")
        self.assertIsNone(c.next())
        s = self.serve("--socket", self.dir / "slow.sock", config="[serve]\nmax_message_s = 0.2\n")
        c = s.client()
        self.check_error(c.next()["error"], -32001, "max_message_s")
        self.assertIsNone(c.next())
        # Depending on the machine, its message or a later client's arrives within the time.
        answered = False
        while not answered:
            c = s.client()
            try:
                c.raw(b'{"jsonrpc":"2.0","id":1,"method":"status"}\n{')
            except (BrokenPipeError, ConnectionResetError):
                c.close()
                continue
            m = c.next()
            answered = m is not None and "result" in m
            if not answered:
                c.close()
        self.check_error(c.next()["error"], -32001, "max_message_s")
        self.assertIsNone(c.next())

    def test_stop_stops_beside_large_messages(self):
        s = self.serve()
        c = s.client()
        path = "M 0 0" + "".join(f" L {i % 40} {i * 7 % 40}" for i in range(100_000))
        plan = {"jsonrpc": "2.0", "id": 1, "method": "plan", "params": {"path": path, "options": {"duration": 1}, "view": "bursts"}}
        many = [s.client() for _ in range(12)]
        for client, noise in zip(many, itertools.cycle((b"x" * (1 << 20), b"[" * 500_000 + b"]" * 500_000, json.dumps(plan).encode()))):
            client.raw(noise + b"\n")
        mine = c.ok("play", **LONG)["stroke"]
        self.assertEqual(c.ok("stop"), {})
        self.assertEqual(c.await_end(mine)["reason"], "cancelled by its client")
        for client in many:
            self.assertIsNotNone(client.next())
        self.assertEqual(c.await_end(c.ok("play", **SHORT)["stroke"])["state"], "finished")
        self.assertEqual(s.terminate()[0], 0)

    def test_an_answer_repeats_little(self):
        c = self.serve().client()
        much = "x" * 1_000_000
        for raw in (much, '"' + much, json.dumps({"jsonrpc": "2.0", "id": 1, "method": much}),
                    json.dumps({"jsonrpc": "2.0", "id": 1, "method": "status", "params": {much: 1}}),
                    json.dumps({"jsonrpc": "2.0", "id": 1, "method": "play", "params": {"stroke": much}}),
                    json.dumps({"jsonrpc": "2.0", "id": 1, "method": "play", "params": {"path": much}}),
                    json.dumps({"jsonrpc": "2.0", "id": 1, "method": "play", "params": {"toml": f"{much} = 1"}}),
                    json.dumps({"jsonrpc": "2.0", "id": 1, "method": "play", "params": {"csv": f"{much},1"}}),
                    json.dumps({"jsonrpc": "2.0", "id": 1, "method": "play", "params": {"path": "M 0 0 L 9 9", "options": {"phantom": much}}}),
                    json.dumps({"jsonrpc": "2.0", "id": 1, "method": "subscribe", "params": {"events": [much]}}),
                    json.dumps({"jsonrpc": "2.0", "id": much, "method": "status"})):
            c.raw(raw.encode() + b"\n")
            said = json.dumps(c.reply()["error"])
            self.assertLess(len(said), 3000)
            self.assertNotIn("x" * 81, said)

    def test_a_token_that_does_not_come_ends_the_connection(self):
        token = self.write("token", "secret\n")
        token.chmod(0o600)
        s = self.serve("--tcp", "0", config=f'[serve]\ntoken_file = "{token}"\nmax_message_s = 0.2\n')
        for said in (b"\n", b'{"jsonrpc":"2.0","id":1,"method":"hello"}\n'):
            c = s.client(tcp=True)
            with contextlib.suppress(BrokenPipeError, ConnectionResetError):
                c.raw(said)
            *_, last = iter(c.next, None)
            self.check_error(last["error"], -32001, "max_message_s")
            self.assertIn("token", last["error"]["data"]["why"])

    def test_a_client_that_does_not_read_is_dropped_and_others_play_on(self):
        s = self.serve(config="[serve]\nmax_unread_bytes = 100000\n")
        deaf, other = s.client(), s.client()
        deaf.socket.settimeout(PATIENCE_S)
        line = b'{"jsonrpc":"2.0","id":1,"method":"hello"}\n'
        with self.assertRaises((BrokenPipeError, ConnectionResetError)):
            for _ in range(1_000_000):
                deaf.raw(line * 100)
        n = other.ok("play", **SHORT)["stroke"]
        self.assertEqual(other.await_end(n)["state"], "finished")

    # Faults.

    def test_each_number_has_one_end_at_a_stop(self):
        s = self.serve()
        c = s.client()
        numbers = [c.ok("play", **LONG)["stroke"] for _ in range(3)] + [c.ok("play", **SHORT, start="armed")["stroke"]]
        live = c.ok("begin", timeout_s=3600)["stroke"]
        c.ok("to", stroke=live, x_mm=1, y_mm=1)
        c.stroke(numbers[0], "started")
        s.process.terminate()
        told = c.told
        while (m := c.next()) is not None:
            told.append(m)
        ends = [(m["params"]["stroke"], m["params"]["state"]) for m in told
                if m["method"] == "stroke" and m["params"]["state"] != "started"]
        self.assertEqual(sorted(ends), [(n, "cancelled") for n in sorted(numbers + [live])])
        self.assertIn("closing", [m["params"]["state"] for m in told if m["method"] == "stream"])
        self.assertEqual(s.process.wait(PATIENCE_S), 0)

    def test_a_card_that_comes_later_is_used(self):
        conf = self.dir / "late.conf"
        conf.write_text("pcm.!default { type null }\n")
        s = self.serve(device=("-D", "late"), env={"ALSA_CONFIG_PATH": str(conf), "XDG_RUNTIME_DIR": str(self.dir)})
        c = s.client()
        c.ok("subscribe", events=["stream"])
        self.assertEqual(c.ok("hello")["stream"]["format"], None)
        self.check_error(c.error("play", **SHORT), -32000, "stream")
        self.check_error(c.error("begin"), -32000, "stream")
        self.assertEqual(c.ok("status")["stream"]["state"], "lost")
        conf.write_text("pcm.!default { type null }\npcm.late { type null }\n")
        os.utime(conf, (time.time() + 10, time.time() + 10))  # ALSA looks at whole seconds
        c.notification(lambda m: m["method"] == "stream" and m["params"]["state"] == "running")
        n = c.ok("play", **SHORT)["stroke"]
        self.assertEqual(c.await_end(n)["state"], "finished")

    def test_an_idle_stream_stops_and_starts_with_the_next_stroke(self):
        c = self.serve("--idle-stop", "0.05").client()
        c.ok("subscribe", events=["stream"])
        # The notification may have come before anybody listened.
        while c.ok("status")["stream"]["state"] != "idle":
            pass
        for method, params in (("play", SHORT), ("drive", {"tactor": 0, "duration_s": 0.05})):
            n = c.ok(method, **params)["stroke"]
            self.assertEqual(c.await_end(n)["state"], "finished")
            c.notification(lambda m: m["method"] == "stream" and m["params"]["state"] == "idle")
        n = c.ok("begin", timeout_s=3600)["stroke"]
        self.assertEqual(c.ok("status")["stream"]["state"], "running")
        c.ok("end", stroke=n)
        c.await_end(n)


if __name__ == "__main__":
    main()
