# SPDX-License-Identifier: MIT
"""tactor serve --osc with programs of music and art: real sockets, and liblo's oscsend and oscdump. tests/server has what each
message does."""
import contextlib
import os
import re
import socket
import subprocess

from harness import PATIENCE_S, ROOT, main
from osc import Sender, begun_by_a_time_tag
from serving import ServeTest

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


class ServeOsc(ServeTest):
    def test_the_first_line_and_the_end(self):
        s = self.serve("--osc", "0")
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

    def test_beyond_loopback_only_peers_are_heard(self):
        for address, says in (("0.0.0.0:0", "osc_peers"), ("[::]:0", "osc_peers"), ("nonsense:1:2", "not an address")):
            self.refuses_to_start(2, "--osc", address, says=says)
        self.refuses_to_start(2, "--osc", "0", config='[serve]\nosc_peers = ["10.0.0.0/40"]\n', says="neither an address nor a prefix")
        own = [a for a in subprocess.run(["hostname", "-I"], capture_output=True, text=True, check=False).stdout.split() if "." in a]
        for peers, heard in (("198.51.100.0/24", False), *((address, True) for address in own[:1])):
            s = self.serve("--osc", "0.0.0.0:0", config=f'[serve]\nosc_peers = ["{peers}"]\n')
            self.assertRegex(s.where["osc"], r"^0\.0\.0\.0:\d+$")
            others = [Sender(self, s, address) for address in own[:1]]
            for other in others:
                other.to = (own[0], other.to[1])
                other.say("/tactor/nonsense")
            # Loopback's later messages are answered later.
            local = Sender(self, s)
            local.say("/tactor/end")
            self.assertEqual(local.next()[1], "/tactor/end")
            for other in others:
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
        a = Sender(self, self.serve("--osc", "[::1]:0"), "::1")
        a.say("/tactor/drive", 4, 0.5, 0.01)
        self.assertEqual(a.next(), ["/tactor/stroke", 0, "started"])

    def test_an_inherited_socket_wins(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as given, socket.socket(socket.AF_INET, socket.SOCK_STREAM) as stream, \
                socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as unbound:
            for s in (given, stream):
                s.bind(("127.0.0.1", 0))
            stream.listen()
            self.refuses_to_start(2, "--socket", "i.sock", inherits=[("osc", stream)], says="it is not a UDP socket")
            self.refuses_to_start(2, "--socket", "i.sock", inherits=[("osc", unbound)], says="it is not a UDP socket with a port")
            s = self.serve("--socket", "i.sock", inherits=[("osc", given)])
            self.assertEqual(s.where["osc"], f"127.0.0.1:{given.getsockname()[1]}")
            self.assertEqual(s.terminate()[0], 0)

    def test_a_message_with_a_time_tag_does_not_begin_early(self):
        began, period_s = begun_by_a_time_tag(self, self.serve("--osc", "0"))
        # The live stroke to a period; timed/test_osc_times.py checks lateness and precision.
        self.assertGreater(min(began), -1.5 * period_s - 0.002)

    def test_an_xy_pad_draws_as_how_to_says(self):
        s = self.serve("--osc", "0")
        watcher = s.watcher("strokes", "touches")
        guide = (ROOT / "man/guide/how-to.md").read_text(encoding="utf-8").partition("## Draw with TouchOSC")[2].partition("\n## ")[0]
        rows = re.findall(r"^\| [^|]* \| `(/tactor/\w+)` \| ([^|]*) \|$", guide, re.M)
        self.assertEqual(rows, [("/tactor/begin", "the constant 1, the constant text `timeout_s=5`"),
                                ("/tactor/to", "the constant 1, x scaled to 0 to 40, y scaled to 0 to 40"), ("/tactor/end", "the constant 1")])
        for number, of_pad, end in ((1, int, 30.0), (2, float, 25.0)):  # whatever type the pad sends
            pad = Sender(self, s)
            pad.say("/tactor/begin", of_pad(number), "timeout_s=3600")  # 5 s may be short on a busy machine
            for x, y in ((0.0, 0.0), (40.0, 10.0), (20.0, end)):
                pad.say("/tactor/to", of_pad(number), x, y)
            # The last point is always shown.
            place = watcher.notification(lambda m: m["method"] == "touches" and m["params"]["y_mm"] == end)["params"]
            self.assertEqual((place["x_mm"], place["down"]), (20, True))
            pad.say("/tactor/end", of_pad(number))
            self.assertEqual([pad.next()[1:] for _ in range(2)], [[number, "started"], [number, "finished"]])
        pad.say("/tactor/play", 2, "park2016-1")
        self.assertEqual(pad.next(), ["/tactor/stroke", 2, "started"])
        pad.say("/tactor/stop")
        self.assertEqual(pad.next(), ["/tactor/stroke", 2, "cancelled"])

    def test_a_finger_at_rest_ends_a_stroke_without_a_longer_timeout(self):
        s = self.serve("--osc", "0")
        pad = Sender(self, s)
        pad.say("/tactor/begin", 1)
        pad.say("/tactor/to", 1, 20.0, 20.0)
        self.assertEqual([pad.next()[1:] for _ in range(2)], [[1, "started"], [1, "interrupted"]])
        pad.say("/tactor/to", 1, 21.0, 20.0)
        self.assertEqual(pad.next()[:2], ["/tactor/error", "/tactor/to"])

    def test_oscsend_and_oscdump_work(self):
        s = self.serve("--osc", "0")
        port = s.where["osc"].rpartition(":")[2]
        # At a port that the kernel chooses: a free one may be taken by then.
        dump = self.start_tool("-L", "0", program="oscdump", stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.until(lambda: udp_ports(dump.pid), dump)
        ears, = udp_ports(dump.pid)
        watcher = s.watcher()

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
