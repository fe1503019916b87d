# SPDX-License-Identifier: MIT
"""tactor serve --http with browsers: permissions, the page, the status, and the WebSocket by RFC 6455."""
import base64
import gzip
import hashlib
import json
import re
import struct
import time

from harness import PATIENCE_S, main
from serving import MESSAGE, ServeTest
from websocket import BINARY, CLOSE, CONTINUATION, PING, PONG, TEXT, Peer, framed


class Caller(Peer):
    """A client that calls the service through the WebSocket."""

    def message(self):
        m = json.loads(self.text())
        MESSAGE.validate(m)
        return m

    def call(self, method, **params):
        self.frame(TEXT, json.dumps({"jsonrpc": "2.0", "id": 1, "method": method, "params": params}).encode())
        while True:
            m = self.message()
            if "method" not in m:
                return m


class Web(ServeTest):
    def serve(self, *args, **more):
        s = super().serve("--http", "0", *args, **more)
        self.assertRegex(s.where["http"], r"^http://127\.0\.0\.1:[1-9]\d*/$")
        s.address = s.where["http"].removeprefix("http://").rstrip("/")
        s.port = s.address.rpartition(":")[2]
        s.peer = lambda: self.kept(Caller(s.address))
        return s

    def kept(self, peer):
        self.addCleanup(peer.socket.close)
        return peer

    def websocket(self, s, **headers):
        p = s.peer()
        self.assertEqual(p.upgrade(**headers), 101)
        return p

    def in_time(self, s, *methods):
        """Returns an answer that came within max_message_s, for which a busy machine may need several tries."""
        deadline = time.monotonic() + PATIENCE_S
        while True:
            p = s.peer()
            try:
                self.assertEqual(p.upgrade(), 101)
                for method in methods:
                    self.assertIn("result", p.call(method))
                return p
            except (EOFError, BrokenPipeError, ConnectionResetError):
                p.socket.close()
                self.assertLess(time.monotonic(), deadline, "none is answered")

    # The page, and the status.

    def test_the_page_is_one_document_that_loads_nothing(self):
        s = self.serve()
        p = s.peer()
        status, headers = p.request()
        page = p.body(headers)
        self.assertEqual((status, headers["content-type"]), (200, "text/html; charset=utf-8"))
        policy = headers["content-security-policy"]
        self.assertTrue(policy.startswith("default-src 'none'; "), policy)
        self.assertIn("frame-ancestors 'none'", policy)
        self.assertNotIn("unsafe", policy)
        for kind in ("script", "style"):
            (text,) = re.findall(rf"(?s)<{kind}>(.*?)</{kind}>", page.decode())
            allowed = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
            self.assertIn(f"; {kind}-src 'sha256-{allowed}'; ", policy)
        self.assertFalse(re.findall(r"(?:src|href)=\"(?!data:)", page.decode()))
        self.assertFalse(re.findall(r"https?://(?!www\.w3\.org/2000/svg)", page.decode()))
        for accepted, is_taken in (("gzip, deflate, br", True), ("br", False)):
            p = s.peer()
            _, headers = p.request(Accept_Encoding=accepted)
            self.assertEqual((headers.get("content-encoding"), headers["vary"]), ("gzip" if is_taken else None, "Accept-Encoding"))
            body = p.body(headers)
            self.assertEqual(gzip.decompress(body) if is_taken else body, page)
            self.assertEqual(len(body) < len(page) / 2, is_taken)

    def test_status_is_served_and_nothing_else(self):
        s = self.serve()
        p = s.peer()
        status, headers = p.request("/status")
        self.assertEqual((status, headers["content-type"]), (200, "application/json"))
        told = json.loads(p.body(headers))
        self.assertEqual((told["clients"], told["stream"]["state"]), (0, "running"))
        for target, method, status in (("/x", "GET", 404), ("/status/", "GET", 404), ("/rpc", "GET", 426), ("/rpc", "HEAD", 426),
                                       ("/x?/", "GET", 404),
                                       ("/", "PUT", 405), ("/rpc", "POST", 405), ("/../etc/passwd", "GET", 404)):
            self.assertEqual(s.peer().request(target, method)[0], status, (target, method))
        status, page = s.peer().request("/")
        for target, method in (("/", "HEAD"), ("/?x", "HEAD"), ("/?", "GET"), ("/?token=1/status", "GET")):
            p = s.peer()
            status, headers = p.request(target, method)
            self.assertEqual((status, headers["content-length"]), (200, page["content-length"]), target)
            if method == "HEAD":
                self.assertRaises(EOFError, p.take, 1)
        p = s.peer()
        status, headers = p.request("/", host="evil.example")
        self.assertEqual(status, 403)
        self.assertIn("allow_hosts", p.body(headers).decode())
        self.assertEqual(s.peer().request("/", Content_Length="5")[0], 413)
        # Permissions are checked before the request: a body makes no difference.
        for body in ({"Content_Length": "40"}, {"Transfer_Encoding": "chunked"}):
            self.assertEqual(s.peer().request("/rpc", "POST", **body)[0], 405)
            self.assertEqual(s.peer().request("/rpc", "POST", Origin="http://evil.example", **body)[0], 403)
            self.assertEqual(s.peer().request("/status", host="evil.example", **body)[0], 403)
        for sent, status in ((b"\x16\x03\x01 nonsense\r\n\r\n", 400), (b"GET / HTTP/1.1\r\nHost: x\r\nX: " + b"a" * 20000, 413)):
            p = s.peer()
            p.send(sent)
            self.assertEqual(p.head()[0], status)

    def test_requests_in_pieces_work_and_unfinished_ones_end(self):
        s = self.serve(config="[serve]\nmax_message_s = 1\n")
        p = s.peer()
        p.send(b"GET / HTTP/1.1\r\n")
        self.assertEqual(p.head()[0], 408)
        self.assertRaises(EOFError, s.peer().head)  # no request was made
        s = self.serve("--socket", self.dir / "other.sock")
        p = s.peer()
        for b in b"GET / HTTP/1.1\r\nHost: %s\r\n\r\n" % s.address.encode():
            p.send(bytes([b]))
        self.assertEqual(p.head()[0], 200)

    # Permissions; tests/net has more names.

    def test_host_and_origin_are_checked(self):
        s = self.serve(config='[serve]\nallow_hosts = ["pi.lan"]\n')
        for host, status in ((s.address, 200), ("pi.lan", 200), (f"evil.example:{s.port}", 403), ("", 403)):
            p = s.peer()
            p.send(f"GET /status HTTP/1.1\r\nHost: {host}\r\n\r\n".encode())
            self.assertEqual(p.head()[0], status, host)
            # A whole address is a target, too.
            self.assertEqual(s.peer().request(f"http://{host}/status")[0], status, host)
            self.assertEqual(s.peer().upgrade(f"http://{host}/rpc"), 101 if status == 200 else 403, host)
        for text in ("", f"Host: {s.address}\r\nHost: {s.address}\r\n"):
            p = s.peer()
            p.send(f"GET / HTTP/1.1\r\n{text}\r\n".encode())
            self.assertEqual(p.head()[0], 403, text)
        for origin, status in ((f"http://{s.address}", 200), ("http://pi.lan", 200), ("null", 403), ("http://evil.example", 403)):
            self.assertEqual(s.peer().request("/status", Origin=origin)[0], status, origin)
            self.assertEqual(s.peer().upgrade(Origin=origin), 101 if status == 200 else 403, origin)
        # Each of several counts.
        for origins, status in (((f"http://{s.address}",) * 2, 200), ((f"http://{s.address}", "http://evil.example"), 403),
                                (("http://evil.example", f"http://{s.address}"), 403)):
            p = s.peer()
            lines = "".join(f"Origin: {origin}\r\n" for origin in origins)
            p.send(f"GET /status HTTP/1.1\r\nHost: {s.address}\r\n{lines}\r\n".encode())
            self.assertEqual(p.head()[0], status, origins)
        # A page of the called host, and no other.
        self.assertEqual(s.peer().request("http://pi.lan/status", Origin=f"http://{s.address}")[0], 403)

    def test_what_is_refused_leaves_a_line_in_the_log(self):
        log = self.dir / "serve.log"
        s = self.serve("--tcp", "0", "--log", log, config="[serve]\nmax_clients = 1\nkept_clients = 0\nmax_message_bytes = 1024\n")
        self.assertEqual(s.peer().request("/status", Origin="http://evil.example")[0], 403)
        c = s.client()
        c.ok("hello")
        self.assertEqual(s.peer().upgrade(), 503)
        self.assertIn("places for clients are taken", s.client(tcp=True).next()["error"]["message"])
        c.raw(b"x" * 2000 + b"\n")
        while c.next() is not None:
            pass
        self.assertEqual(s.terminate()[0], 0)
        lines = [line.partition(" warning ")[2] for line in log.read_text().splitlines() if "refused: " in line]
        self.assertEqual(lines, [f'refused: a browser\'s request for the host "{s.address}" by a page of "http://evil.example" from 127.0.0.1',
                                 "refused: a browser without a free place from 127.0.0.1",
                                 "refused: a connection without a free place from 127.0.0.1",
                                 "refused: a message that is too large from this computer"])

    def test_the_token_is_required(self):
        s = self.serve(config=self.token())
        self.assertEqual(s.peer().request("/")[0], 200)
        self.assertEqual(s.peer().request("/status")[0], 401)
        for wait_s in (0.2, 0.4):  # the later, the more guesses came from there
            began = time.monotonic()
            self.assertEqual(s.peer().request("/status", Authorization="Bearer guess")[0], 401)
            self.assertGreaterEqual(time.monotonic() - began, wait_s)
        self.assertEqual(s.peer().request("/status", Authorization="Basic secret")[0], 401)
        self.assertEqual(s.peer().request("/status", Authorization="Bearer secret")[0], 200)
        p = self.websocket(s)
        self.assertEqual(p.call("status")["error"]["code"], -32003)
        self.assertEqual(p.call("hello", token="secret")["result"]["protocol"], "tactor/1")
        self.assertIn("result", p.call("status"))
        p = self.websocket(s)
        began = time.monotonic()
        for _ in range(3):
            self.assertEqual(p.call("hello", token="guess")["error"]["code"], -32003)
        self.assertGreater(time.monotonic() - began, 0.2 + 0.4 + 0.8)  # each comes later
        self.assertEqual((p.end(), p.reason), (1008, "three wrong tokens"))

    # The WebSocket.

    def test_it_speaks_the_protocol_and_a_leaving_client_ends_its_live_stroke(self):
        s = self.serve()
        p = self.websocket(s)
        self.assertEqual(p.call("hello")["result"]["protocol"], "tactor/1")
        p.frame(TEXT, b"x" * 100_000)
        self.assertEqual(p.message()["error"]["code"], -32700)
        points = [[i / 10000, 20, 20] for i in range(1000)]
        self.assertEqual(len(p.call("play", points=points, start="armed")["result"]["strokes"]), 1)
        number = p.call("begin", timeout_s=86400)["result"]["stroke"]
        p.frame(TEXT, json.dumps({"jsonrpc": "2.0", "method": "to", "params": {"stroke": number, "x_mm": 5, "y_mm": 5}}).encode())
        self.assertEqual(p.message()["params"]["state"], "started")
        watcher = s.watcher()
        p.socket.close()
        self.assertEqual(watcher.await_end(number)["state"], "finished")

    def test_a_large_file_comes_whole_and_lets_control_frames_pass(self):
        p = self.websocket(self.serve(config="[serve]\nmax_unread_bytes = 100000\n"))
        p.frame(TEXT, json.dumps({"jsonrpc": "2.0", "id": 1, "method": "export", "params": {
            "path": "M 0 0 L 40 40", "options": {"duration": 12}, "as": "wav"}}).encode())
        kind, _ = p.next_frame()
        self.assertEqual((kind, p.is_last), (TEXT, False))
        p.frame(PING, b"are you there")
        size = 0
        while kind != PONG:
            kind, payload = p.next_frame()
            size += len(payload)
            self.assertIn(kind, (CONTINUATION, PONG))
            self.assertFalse(kind == CONTINUATION and p.is_last, "the whole message came first")
        self.assertEqual(payload, b"are you there")
        self.assertGreater(size + len(p.text()), 20_000_000)
        self.assertEqual(p.call("status")["result"]["clients"], 1)

    def test_control_frames_and_pieces_work(self):
        p = self.websocket(self.serve())
        text = b'{"jsonrpc":"2.0","id":1,"method":"hello"}'
        p.frame(TEXT, text[:5], last=False)
        p.frame(PING)
        p.frame(CONTINUATION, text[5:20], last=False)
        p.frame(CONTINUATION, text[20:])
        self.assertEqual(p.next_frame(), (PONG, b""))
        self.assertEqual(p.message()["result"]["protocol"], "tactor/1")
        p.frame(CLOSE, struct.pack("!H", 1000) + b"done")
        self.assertEqual(p.end(), 1000)

    def test_close_codes_are_right(self):
        s = self.serve(config="[serve]\nmax_message_bytes = 1024\n")
        for code, send in ((1003, lambda p: p.frame(BINARY, b"{}")), (1007, lambda p: p.frame(TEXT, b'{"x":"\xff"}')),
                           (1009, lambda p: p.frame(TEXT, b"a" * 1025)), (1002, lambda p: p.frame(TEXT, b"{}", masked=False))):
            p = self.websocket(s)
            send(p)
            self.assertEqual(p.end(), code)
        self.websocket(s).call("hello")

    def test_endless_messages_and_silent_clients_end(self):
        s = self.serve(config="[serve]\nmax_message_s = 1\n")
        for sent in (None, b""):
            silent = self.in_time(s)
            if sent is not None:
                silent.frame(TEXT, sent)
            self.assertEqual((silent.end(), silent.reason), (1008, "the first message did not come"))
        slow = self.in_time(s, "hello")
        slow.frame(TEXT, b'{"jsonrpc"', last=False)
        self.assertEqual((slow.end(), slow.reason), (1008, "a message took too long"))
        # Each packet has a message's end and the next one's begin.
        busy = self.in_time(s, "hello")
        ask = framed(TEXT, b'{"jsonrpc":"2.0","method":"status"}')
        busy.send(ask[:5])
        until = time.monotonic() + 3
        while time.monotonic() < until:
            busy.send(ask[5:] + ask[:5])
            time.sleep(0.05)
        busy.send(ask[5:])
        self.assertIn("result", busy.call("status"))
        patient = self.in_time(s, "hello")
        self.assertEqual(self.in_time(s).end(), 1008)  # patient was silent for that long
        self.assertIn("result", patient.call("status"))

    def test_visitors_beyond_the_places_are_refused_with_a_reason(self):
        s = self.serve(config="[serve]\nmax_clients = 1\nkept_clients = 0\nmax_message_s = 3600\n")
        waiting = [s.peer() for _ in range(33)]  # 32 page visitors beside the clients
        status, headers = s.peer().head()
        self.assertEqual(status, 503)
        self.assertEqual(headers["content-type"], "text/plain")
        self.assertEqual(waiting[0].request("/")[0], 200)

    def test_the_end_is_announced(self):
        s = self.serve()
        p = self.websocket(s)
        number = p.call("play", path="M 0 0 L 40 40", options={"algorithm": "continuous", "duration": 300})["result"]["stroke"]
        s.process.terminate()
        told = []
        while not told or told[-1]["method"] != "stroke" or told[-1]["params"]["state"] == "started":
            told.append(p.message())
        self.assertEqual((told[-1]["params"]["stroke"], told[-1]["params"]["state"]), (number, "cancelled"))
        self.assertEqual(p.end(), 1001)
        self.assertEqual(s.process.wait(PATIENCE_S), 0)


if __name__ == "__main__":
    main()
