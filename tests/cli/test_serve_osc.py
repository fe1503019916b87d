# SPDX-License-Identifier: MIT
"""tactor serve --osc with programs of music and art: real sockets, and liblo's oscsend and oscdump."""
import contextlib
import json
import os
import random
import socket
import struct
import subprocess
import time

from harness import PATIENCE_S, TOOL, ToolTest, main
from osc import Sender, begun_by_a_time_tag, bundle, message, text
from serving import Server

DRAWING = "M 0 0 L 40 40"


def udp_ports(pid):
    """Returns the ports at which a process listens."""
    own = set()
    for fd in os.listdir(f"/proc/{pid}/fd"):
        with contextlib.suppress(FileNotFoundError):  # closed since
            own.add(os.readlink(f"/proc/{pid}/fd/{fd}"))
    rows = []
    for name in ("udp", "udp6"):
        with open(f"/proc/net/{name}", encoding="ascii") as file:
            rows += [line.split() for line in file][1:]
    return {int(r[1].rpartition(":")[2], 16) for r in rows if f"socket:[{r[9]}]" in own}


class ServeOsc(ToolTest):
    def serve(self, *args, **more):
        s = Server(self, "--osc", "0", *args, **more)
        if s.where is None:
            self.fail(s.errors)
        return s

    def refuses_to_start(self, says, *args, **more):
        s = Server(self, *args, **more)
        self.assertIsNone(s.where)
        self.assertEqual(s.process.returncode, 2, s.errors)
        self.assertIn(says, s.errors)

    # Sockets.

    def test_the_first_line_and_the_end(self):
        s = self.serve()
        self.assertRegex(s.where["osc"], r"^127\.0\.0\.1:[1-9]\d*$")
        a = Sender(self, s)
        a.say("/tactor/play", 1, DRAWING, "duration=300")
        self.assertEqual(a.next(), ["/tactor/stroke", 1, "started"])
        a.say("/tactor/subscribe", "stream")  # an idle sender is notified of the end, too
        status, out, err = s.terminate()
        self.assertEqual((status, out), (0, ""), err)
        self.assertIn("osc 127.0.0.1", err)
        self.assertIn("every user of this machine", err)
        told = [a.next(), a.next()]
        self.assertIn(["/tactor/stroke", 1, "cancelled"], told)
        self.assertIn(["/tactor/stream", "closing"], told)

    def test_text_has_the_endpoint_too(self):
        self.write("t.toml", "[serve]\nosc = 0\n")
        p = subprocess.Popen([TOOL, "serve", "-D", "null", "--socket", "t.sock", "--config", "t.toml"], cwd=self.dir,
                             env=self.env, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(p.stdout.close)
        self.assertEqual(p.stdout.readline(), "listening: socket t.sock\n")
        self.assertRegex(p.stdout.readline(), r"^listening: osc 127\.0\.0\.1:\d+\n$")
        p.terminate()
        self.assertEqual(p.wait(PATIENCE_S), 0)

    def test_beyond_loopback_only_for_peers(self):
        self.refuses_to_start("osc_peers", "--osc", "0.0.0.0:0")
        self.refuses_to_start("osc_peers", "--osc", "[::]:0")
        self.refuses_to_start("neither an address nor a prefix", "--osc", "0", config='[serve]\nosc_peers = ["10.0.0.0/40"]\n')
        self.refuses_to_start("no address", "--osc", "nonsense:1:2")
        s = Server(self, "--osc", "0.0.0.0:0", config='[serve]\nosc_peers = ["10.0.0.0/8"]\n')
        self.assertRegex(s.where["osc"], r"^0\.0\.0\.0:\d+$")
        a = Sender(self, s)  # loopback is heard
        a.say("/tactor/nonsense")
        self.assertEqual(a.next()[:2], ["/tactor/error", "/tactor/nonsense"])

    def test_another_address_of_this_machine_is_heard_only_as_a_peer(self):
        own = [a for a in subprocess.run(["hostname", "-I"], capture_output=True, text=True, check=False).stdout.split() if "." in a]
        if not own:
            self.skipTest("this machine has no address but loopback")
        for peers, heard in (("198.51.100.0/24", False), (own[0], True)):
            s = Server(self, "--osc", "0.0.0.0:0", config=f'[serve]\nosc_peers = ["{peers}"]\n')
            other = Sender(self, s, own[0])
            other.to = (own[0], other.to[1])
            other.say("/tactor/nonsense")
            # Loopback's later messages are answered later.
            local = Sender(self, s)
            local.say("/tactor/end")
            self.assertEqual(local.next()[1], "/tactor/end")
            if heard:
                self.assertEqual(other.next()[1], "/tactor/nonsense")
            else:
                other.socket.setblocking(False)
                self.assertRaises(BlockingIOError, other.next)
            s.terminate()

    def test_ipv6_works(self):
        try:
            with socket.socket(socket.AF_INET6, socket.SOCK_DGRAM) as probe:
                probe.bind(("::1", 0))
        except OSError:
            self.skipTest("this machine has no IPv6")
        s = Server(self, "--osc", "[::1]:0")
        a = Sender(self, s, "::1")
        a.say("/tactor/drive", 4, 0.5, 0.01)
        self.assertEqual(a.next(), ["/tactor/stroke", 0, "started"])

    def test_an_inherited_socket_wins(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as given:
            given.bind(("127.0.0.1", 0))
            port = given.getsockname()[1]
            self.check_inherited(given, "osc", {"osc": f"127.0.0.1:{port}"})
        with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as given:
            given.bind(("127.0.0.1", 0))
            given.listen()
            self.check_inherited(given, "osc", None, "it is no UDP socket")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as given:
            self.check_inherited(given, "osc", None, "it is no UDP socket with a port")

    def check_inherited(self, given, name, where, says=""):
        os.set_inheritable(given.fileno(), True)
        command = f'exec 3<&{given.fileno()}; export LISTEN_PID=$$; exec "$@"'
        p = subprocess.Popen(["sh", "-c", command, "sh", TOOL, "serve", "-D", "null", "--format", "json",
                              "--socket", "i.sock"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                             cwd=self.dir, pass_fds=[given.fileno()], env=self.env | {"LISTEN_FDS": "1", "LISTEN_FDNAMES": name})
        line = p.stdout.readline()
        if where is not None:
            self.assertLess(where.items(), json.loads(line).items())
            p.terminate()
        _, err = p.communicate(timeout=PATIENCE_S)
        self.assertEqual(p.returncode, 0 if where else 2, err)
        self.assertIn(says, err)

    # Effects.

    def test_a_live_stroke_by_osc(self):
        s = self.serve()
        a = Sender(self, s)
        a.say("/tactor/begin", 3, "timeout_s=60")
        a.say("/tactor/to", 3, 10, 12.5)
        self.assertEqual(a.next(), ["/tactor/stroke", 3, "started"])
        a.say("/tactor/to", ("h", struct.pack(">q", 3)), ("d", struct.pack(">d", 11.0)), 12.5, 0.5)
        a.say("/tactor/end", 3)
        self.assertEqual(a.next(), ["/tactor/stroke", 3, "finished"])

    def test_silence_ends_a_live_stroke(self):
        a = Sender(self, self.serve())
        # In one packet: the second may be late.
        a.raw(bundle(None, message("/tactor/begin", 3, "timeout_s=1"), message("/tactor/to", 3, 20, 20)))
        self.assertEqual(a.next(), ["/tactor/stroke", 3, "started"])
        self.assertEqual(a.next(), ["/tactor/stroke", 3, "interrupted"])

    def test_a_message_with_a_time_tag_does_not_begin_early(self):
        began, period_s = begun_by_a_time_tag(self, self.serve())
        # The live stroke to a period; timed/test_osc_times.py checks lateness and precision.
        self.assertGreater(min(began), -1.5 * period_s - 0.002)

    def test_far_times_are_refused_and_the_past_is_now(self):
        a = Sender(self, self.serve())
        a.raw(bundle(time.time() + 3600, message("/tactor/play", 1, DRAWING)))
        self.assertRegex(a.next()[2], r"^time tag: it is 3[56]\d\d\.\d s ahead")
        for when in (time.time() - 1000, None, -2208988800):
            a.raw(bundle(when, message("/tactor/play", 1, DRAWING, "duration=0.02")))
            self.assertEqual(a.next(), ["/tactor/stroke", 1, "started"])
            self.assertEqual(a.next(), ["/tactor/stroke", 1, "finished"])

    def test_any_sender_may_stop(self):
        s = self.serve()
        a, b, c = Sender(self, s), Sender(self, s), s.client()
        a.say("/tactor/play", 1, DRAWING, "duration=300")
        self.assertEqual(a.next(), ["/tactor/stroke", 1, "started"])
        n = c.ok("play", path=DRAWING, options={"duration": 300})["stroke"]
        b.raw(bundle(time.time() + 50, message("/tactor/stop")))
        self.assertEqual(a.next(), ["/tactor/stroke", 1, "cancelled"])
        self.assertEqual(c.await_end(n)["state"], "cancelled")

    def test_levels_and_stream_go_to_a_chosen_port(self):
        s = self.serve()
        a, ears = Sender(self, s), Sender(self, s)
        a.say("/tactor/subscribe", ears.port, "levels", "stream")
        a.say("/tactor/drive", 4, 0.5, 5.0)
        while True:
            levels = ears.next("/tactor/levels")[1:]
            self.assertEqual(len(levels), 9)
            self.assertTrue(all(v == -200 for i, v in enumerate(levels) if i != 4), levels)
            if levels[4] > -30:
                break
        self.assertEqual(a.next(), ["/tactor/stroke", 0, "started"])

    # Refusals.

    def test_hostile_packets_get_words_or_nothing(self):
        s = self.serve()
        play = message("/tactor/play", 1, DRAWING)
        deep = play
        for _ in range(200):
            deep = bundle(None, deep)
        self.assertRefused(s, b"", "0 bytes")
        self.assertRefused(s, play[:-1], "no multiple of 4")
        self.assertRefused(s, play[:-4], "value")
        self.assertRefused(s, deep, "nest deeper")
        self.assertRefused(s, bundle(None, *[message("/tactor/stop")] * 300), "more than 256")
        self.assertRefused(s, b"#bundle\0" + bytes(8) + struct.pack(">i", 2**31 - 4) + play, "2147483644 bytes")
        self.assertRefused(s, text("/tactor/play") + b",s\0\0" + b"abcd", "value")
        self.assertRefused(s, text("/tactor/play") + b",s\0xabc\0", "types")
        self.assertRefused(s, message("/tactor/play", ("b", struct.pack(">i", 4) + b"abcd")), "it is no text")
        self.assertRefused(s, message("/tactor/to", 1, ("T", b""), 1.0), "it is no number")
        self.assertRefused(s, text("/tactor/play") + text(",s") + b"\xff\xfe\xfd\0", "stroke")
        random.seed(1)
        a = Sender(self, s)
        for _ in range(2000):
            a.raw(random.randbytes(4 * random.randrange(20)))
            mangled = bytearray(play)
            mangled[random.randrange(len(mangled))] = random.randrange(256)
            a.raw(bytes(mangled))
        self.assertEqual(s.client().ok("stop"), {})

    def assertRefused(self, server, packet, says):
        # Each from another address, with its separate count of errors.
        self.last = getattr(self, "last", 1) + 1
        a = Sender(self, server, f"127.0.0.{self.last}")
        a.raw(packet)
        kind, _, why = a.next()
        self.assertEqual(kind, "/tactor/error")
        self.assertIn(says, why)

    def test_an_address_gets_ten_errors_a_second(self):
        s = self.serve()
        began = time.monotonic()
        a, b = Sender(self, s), Sender(self, s)
        for _ in range(50):  # more than fit into a socket that is not read
            a.say("/tactor/nonsense")
            b.say("/tactor/nonsense")
        # Another address gets its errors: the server has dealt with all above.
        c = Sender(self, s, "127.0.0.2")
        c.say("/tactor/nonsense")
        c.next()
        took = time.monotonic() - began
        count = 0
        for x in (a, b):
            x.socket.setblocking(False)
            while True:
                try:
                    x.next()
                except BlockingIOError:
                    break
                count += 1
        self.assertGreaterEqual(count, 10)
        self.assertLessEqual(count, 10 * (1 + int(took)))

    def test_two_servers_that_hear_each_other_fall_silent(self):
        one = self.serve()
        two = self.serve("--socket", self.dir / "two.sock")
        # Each subscribes to the other: messages go from the port of one to that of the other.
        between = Sender(self, one)
        between.say("/tactor/subscribe", int(two.where["osc"].rpartition(":")[2]), "levels", "stream")
        # Messages of one to a sender go to the other.
        said = []
        between.say("/tactor/nonsense")
        said.append(between.next())
        between.say("/tactor/play", 1, DRAWING, "duration=0.02")
        said += [between.next(), between.next()]
        relay = Sender(self, two)
        for m in said + [["/tactor/levels", -12.0], ["/tactor/stream", "running"], ["/tactor/error"], ["/tactor/stroke", "x"]]:
            relay.say(*m)
        relay.say("/tactor/cancel", 77)
        self.assertEqual(relay.next()[:2], ["/tactor/error", "/tactor/cancel"])
        # The stroke's sender and the asker: no further client of the second.
        self.assertEqual(two.client().ok("status")["clients"], 1)

    def test_senders_are_forgotten(self):
        s = self.serve()
        for _ in range(200):
            a = Sender(self, s)
            a.say("/tactor/drive", 0, 0.1, 0.001)
            self.assertEqual(a.next()[1:], [0, "started"])
            self.assertEqual(a.next()[1:], [0, "finished"])
            a.socket.close()
        self.assertEqual(s.client().ok("status")["clients"], 1)

    # Programs of others.

    def test_oscsend_and_oscdump_work(self):
        s = self.serve()
        port = s.where["osc"].rpartition(":")[2]
        # At a port that the kernel chooses: a free one may be taken by then.
        dump = subprocess.Popen(["oscdump", "-L", "0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(dump.stdout.close)
        self.addCleanup(dump.wait)
        self.addCleanup(dump.kill)
        self.until(lambda: udp_ports(dump.pid), dump)
        ears, = udp_ports(dump.pid)
        watcher = s.client()
        watcher.ok("subscribe", events=["strokes"])

        def oscsend(*args):
            subprocess.run(["oscsend", "127.0.0.1", port, *args], check=True, timeout=PATIENCE_S)

        oscsend("/tactor/subscribe", "is", str(ears), "levels")
        line = dump.stdout.readline()
        self.assertRegex(line, r"^\S+ /tactor/levels f{9} (-200\.000000 ?){9}$")
        for args in (["/tactor/play", "is", "5", "park2016-1"], ["/tactor/play", "hss", "6", DRAWING, "duration=0.05"],
                     ["/tactor/drive", "ff", "4", "0.5"], ["/tactor/drive", "ddd", "4", "0.5", "0.01"]):
            oscsend(*args)
            watcher.notification(lambda m: m["params"].get("state") == "started")
            watcher.notification(lambda m: m["params"].get("state") == "finished")
        oscsend("/tactor/play", "ss", DRAWING, "duration=300")
        watcher.notification(lambda m: m["params"].get("state") == "started")
        oscsend("/tactor/stop")
        watcher.notification(lambda m: m["params"].get("state") == "cancelled")


if __name__ == "__main__":
    main()
