# SPDX-License-Identifier: MIT
"""tactor serve for other programs: its sockets, their permissions, the protocol, its limits, and its end."""
import array
import contextlib
import json
import math
import os
import pathlib
import resource
import signal
import socket
import stat
import subprocess
import time

from harness import PATIENCE_S, main
from serving import LONG, MESSAGE, SHORT, Client, Server, ServeTest
from websocket import Peer


class Sockets(ServeTest):
    def test_the_first_line_and_the_end(self):
        s = self.serve("--tcp", "0")
        self.assertEqual(set(s.where), {"event", "socket", "tcp", "osc", "http", "max_level_dbfs"})
        self.assertEqual((s.where["event"], s.where["osc"], s.where["http"]), ("listening", None, None))
        self.assertRegex(s.where["tcp"], r"^127\.0\.0\.1:[1-9]\d*$")
        status, out, err = s.terminate()
        self.assertEqual((status, out), (0, ""), err)
        self.assertIn("every user of this machine", err)
        self.assertFalse(os.path.exists(s.where["socket"]))

    def test_what_lacks_descriptors_says_how_to_get_more(self):
        told = []
        for most in range(5, 20):
            s = Server(self, preexec_fn=lambda n=most: resource.setrlimit(resource.RLIMIT_NOFILE, (n, n)))
            if s.where:
                break
            told.append(s.errors)
        self.assertTrue(s.where)
        self.assertEqual([t for t in told if "or raise the limit: ulimit -n)" not in t], [])
        self.assertGreater(len(told), 2)

    def test_a_page_alone_needs_no_folder_for_a_socket(self):
        s = self.serve("--http", "0", env={"XDG_RUNTIME_DIR": "", "RUNTIME_DIRECTORY": ""})
        self.assertIsNone(s.where["socket"])
        self.assertRegex(s.where["http"], "^http://127")
        self.assertEqual(s.terminate()[0], 0)
        self.refused(2, "serve", "--socket", "", "--http", "0", "-D", "null")

    def test_a_program_that_it_starts_inherits_no_descriptor(self):
        s = self.serve("--tcp", "0", "--http", "0", "--osc", "0")
        s.client().ok("hello")
        process = pathlib.Path(f"/proc/{s.process.pid}")
        inherited = [os.readlink(process / "fd" / f.name) for f in (process / "fdinfo").iterdir()
                     if int(f.name) > 2 and not int(f.read_text(encoding="ascii").split()[3], 8) & os.O_CLOEXEC]
        self.assertLessEqual(set(inherited), {"/dev/null"})  # ALSA's own, of the device "null"

    def test_it_ends_well_with_any_signals(self):
        for signals in ((signal.SIGINT,), *((signal.SIGTERM, other) for other in (signal.SIGINT, signal.SIGHUP, signal.SIGTERM))):
            s = self.serve()
            for sent in signals:
                s.process.send_signal(sent)
            self.assertEqual(s.process.wait(PATIENCE_S), 0)
            self.assertFalse(os.path.exists(s.where["socket"]))

    def test_the_socket_of_another_server_stays(self):
        path = self.dir / "s"
        first = self.serve("--socket", path)
        path.unlink()
        second = self.serve("--socket", path)
        self.assertEqual(first.terminate()[0], 0)
        self.assertEqual(second.client().ok("hello")["protocol"], "tactor/1")

    def test_the_socket_has_its_mode_under_any_umask(self):
        for mask in (0, 0o777, 0o22):
            file = self.dir / f"mask{mask}"
            s = self.serve("--socket", file, env={"XDG_RUNTIME_DIR": str(self.dir)}, umask=mask)
            self.assertEqual(stat.S_IMODE(file.stat().st_mode), 0o600)
            self.assertEqual(s.terminate()[0], 0)

    def test_the_default_socket_is_the_system_s_with_its_group_or_the_user_s(self):
        (self.dir / "run").mkdir()
        for env, path, mode in (({"RUNTIME_DIRECTORY": str(self.dir / "run"), "XDG_RUNTIME_DIR": str(self.dir / "user")}, "run/tactor.sock", 0o660),
                                ({"XDG_RUNTIME_DIR": str(self.dir)}, "tactor.sock", 0o600)):
            s = self.serve(env=env)
            self.assertEqual(s.where["socket"], str(self.dir / path))
            self.assertEqual(stat.S_IMODE(os.stat(s.where["socket"]).st_mode), mode)

    def test_a_second_server_names_the_holder_of_the_socket(self):
        first = self.serve()
        self.refuses_to_start(3, says=f"process {first.process.pid}")
        self.assertEqual(first.client().ok("status")["amplifier"], "none")

    def test_a_killed_server_s_socket_is_replaced_and_nothing_else(self):
        first = self.serve()
        first.kill()
        self.assertTrue(os.path.exists(first.where["socket"]))
        self.assertEqual(self.serve().terminate()[0], 0)
        self.write("s.sock", "mine")
        self.refuses_to_start(2, says="not a socket")
        self.assertEqual((self.dir / "s.sock").read_text(), "mine")

    def test_inherited_sockets_win_stay_and_are_checked_like_bound_ones(self):
        path = str(self.dir / "given.sock")
        with socket.socket(socket.AF_UNIX) as given, socket.socket(socket.AF_UNIX) as nameless:
            given.bind(path)
            nameless.bind("\0" + path)
            for s in (given, nameless):
                s.listen()
            for mode, sockets, why in ((0o666, [given], "every user of this machine may write to it"),
                                       (0o660, [given, given], "two sockets have this name"),
                                       (0o660, [nameless], "it is not a file")):
                os.chmod(path, mode)
                self.refuses_to_start(2, inherits=[("socket", s) for s in sockets], says=why)
            s = self.serve(inherits=[("socket", given)])
            self.assertEqual(s.where["socket"], path)
            self.assertEqual(Client(path).ok("hello")["protocol"], "tactor/1")
            self.assertEqual(s.terminate()[0], 0)
            self.assertTrue(os.path.exists(path))

    def test_it_notifies_its_manager(self):
        path = str(self.dir / "notify")
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
            manager.bind(path)
            manager.settimeout(PATIENCE_S)
            s = self.serve("--socket", self.dir / "n.sock", env={"NOTIFY_SOCKET": path, "WATCHDOG_USEC": "200000"})
            said = set()
            while len(said) < 3:  # on a slow machine the watchdog is fed more than once before the rest comes
                said.add(manager.recv(1000))
            self.assertEqual(said, {b"READY=1", b"WATCHDOG=1", b"STATUS=stream: running"})
            for _ in range(2):  # repeatedly
                while manager.recv(1000) != b"WATCHDOG=1":
                    pass
            s.process.terminate()
            while manager.recv(1000) != b"STOPPING=1":
                pass

    def test_bad_addresses_are_refused_with_the_reason(self):
        short = {"config": self.token("fifteen letters"), "says": "15 characters (put at least 16"}
        for args, more in ((("--tcp", "nonsense:1:2"), {"says": "not an address"}), (("--tcp", "0.0.0.0:0"), {"says": "token_file"}),
                           (("--http", "0.0.0.0:0"), {"says": "token_file"}),
                           (("--tcp", "0.0.0.0:0"), short), (("--http", "0.0.0.0:0"), short), (("--socket", "x" * 200), {"says": "name"}),
                           ((), {"config": "[serve]\nhttpp = 4\n", "says": "httpp"}), ((), {"config": '[serve]\ntcp = "x"\n', "says": "serve.toml:2:"}),
                           (("--period-frames", "1"), {"says": "period"})):
            self.refuses_to_start(2, *args, **more)
        self.assertFalse((self.dir / "s.sock").exists())
        self.assertEqual(self.run_tool("serve", "-D", "null", env={"XDG_RUNTIME_DIR": "", "RUNTIME_DIRECTORY": ""}).returncode, 2)

    def test_too_few_descriptors_are_reported(self):
        hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
        for most, is_few in ((60, True), (hard, False)):
            s = self.serve(preexec_fn=lambda most=most: resource.setrlimit(resource.RLIMIT_NOFILE, (60, most)))
            self.assertEqual("too few descriptors: 60 may be open, but 64 clients need 160" in s.terminate()[2], is_few)

    # Permissions.

    def test_tcp_begins_with_hello(self):
        s = self.serve("--tcp", "0")
        c = s.client(tcp=True)
        self.assertEqual(c.ok("hello")["version"], self.run_tool("--version").stdout.split()[1])
        self.assertEqual(c.ok("status")["clients"], 1)
        for first in (b"POST / HTTP/1.1\r\nHost: x\r\n\r\n", b'{"jsonrpc":"2.0","id":1,"method":"stop"}\n', b"[]\n"):
            c = s.client(tcp=True)
            c.raw(first)
            self.assertIsNone(c.next())

    def test_a_token_is_required(self):
        config = self.token() + "tcp = 0\nmax_message_s = 600\n"
        (self.dir / "token").chmod(0o604)
        self.refuses_to_start(2, config=config, says="other users may read it")
        (self.dir / "token").chmod(0o600)
        s = self.serve(config=config)
        c = s.client(tcp=True)
        self.check_error(c.error("hello"), -32003, "token")
        self.check_error(c.error("play", stroke="park2016-1"), -32003)
        self.check_error(c.error("hello", token="secret "), -32003, "token")
        self.assertEqual(c.ok("hello", token="secret")["protocol"], "tactor/1")
        c.ok("status")
        c = s.client(tcp=True)
        for _ in range(3):
            self.check_error(c.error("hello", token="guess"), -32003)
        self.assertIsNone(c.next())
        s.client().ok("status")

    def test_a_token_that_does_not_come_ends_the_connection(self):
        s = self.serve("--tcp", "0", config=self.token() + "max_message_s = 0.2\n")
        for said in (b"\n", b'{"jsonrpc":"2.0","id":1,"method":"hello"}\n'):
            c = s.client(tcp=True)
            with contextlib.suppress(BrokenPipeError, ConnectionResetError):
                c.raw(said)
            *_, last = iter(c.next, None)
            self.check_error(last["error"], -32001, "max_message_s")
            self.assertIn("token", last["error"]["data"]["why"])


class Protocol(ServeTest):
    """tests/net and tests/server have the cases; here each method once, by its schema."""

    def test_hello_has_the_versions_and_the_array_s_place(self):
        palm = self.write("palm.toml", '[array]\nsite = "left palm"\nup = "fingers"\nplace = [1, -56]\nturn = 15\n'
                          'body = 180\npreset = "palm-3x3"\n')
        r = self.serve("--array", palm).client().ok("hello")
        self.assertEqual(list(r), ["protocol", "version", "array", "stream", "presets", "shapes", "formats", "clock", "max_level_dbfs", "client"])
        self.assertEqual(set(r["stream"]), {"rate", "channels", "format", "period_frames", "latency_s", "pcm"})
        self.assertEqual([r["array"].pop(k) for k in ("site", "up", "place", "turn", "body")], ["left palm", "fingers", [1, -56], 15, 180])
        self.assertEqual(r["array"], self.plan("park2016-1", "--array", palm)["array"])
        self.assertEqual((r["stream"]["pcm"], r["stream"]["channels"], r["max_level_dbfs"]), ("null", 9, -12.0))
        self.assertIn("park2016-1", r["presets"])
        self.assertLess(abs(r["clock"]["monotonic_s"] - time.monotonic()), PATIENCE_S)

    def test_play_takes_all_forms_and_plan_gives_the_output_of_the_tool(self):
        c = self.serve().client()
        toml = "[[stroke]]\npath = 'M 0 0 L 40 0'\nduration_s = 0.1\n[[stroke]]\npath = 'M 0 0 L 0 40'\nduration_s = 0.1\n"
        for params, count in (({"stroke": "park2016-1"}, 1), (SHORT, 1), ({"points": [[0, 0, 0], [0.1, 20, 20, 0.5]]}, 1),
                              ({"toml": toml}, 2), ({"csv": "t_s,x_mm,y_mm\n0,0,0\n0.1,20,20\n"}, 1),
                              ({"svg": '<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0 L20 0 M0 20 L20 20"/></svg>'}, 2)):
            r = c.ok("play", **params)
            self.assertEqual(set(r), {"stroke", "strokes", "total_s", "warnings", "weakened_db"})
            self.assertEqual((r["strokes"][0], len(r["strokes"])), (r["stroke"], count))
            for n in r["strokes"]:
                self.assertIsInstance(c.stroke(n, "started")["started_s"], float)
                end = c.await_end(n)
                self.assertEqual((end["state"], end["reason"]), ("finished", ""))
                self.assertGreater(end["frames"], 0)
                self.assertLess(abs(end["started_unix_s"] - time.time()), 2 * PATIENCE_S)
        self.assertEqual(c.ok("plan", stroke="park2016-3", options={"phantom": "barycentric"}),
                         self.plan("park2016-3", "--phantom", "barycentric"))
        for view in ("bursts", "percept", "peaks"):
            c.ok("plan", **SHORT, view=view, draft=7)
        long = {"path": "M 0 0 L 40 40", "options": {"algorithm": "continuous", "duration": 600}}
        self.check_error(c.error("plan", **long), -32001, "plan")
        self.assertEqual(len(c.ok("plan", **long, view="bursts")["onsets"]), 2000)

    def test_bad_parameters_are_named(self):
        c = self.serve().client()
        path = "M 0 0 L 40 40"
        for what, params in (("options.nonsense", {"path": path, "options": {"nonsense": 1}}), ("points", {"points": [[0, 0], [1, 2, 3]]}),
                             ("path", {"path": 1}), ("stroke", {"stroke": "/etc/passwd"}), ("svg", {"svg": "<svg"}),
                             ("path", {"stroke": "park2016-1", "path": path}), ("start.delay_s", {"path": path, "start": {"delay_s": -1}}),
                             ("dance", {"path": path, "dance": 1})):
            for method in ("play", "plan"):
                self.check_error(c.error(method, **params), -32602, what)
        said = c.error("play", path=path, options={"carrier": 30000})
        self.check_error(said, -32602, "options.carrier")
        self.assertEqual(said["message"].count("options.carrier"), 1, said)
        said = c.error("play", toml='[stroke]\npath = "M 0 0 L 40 40"\nsoas = 1\n')
        self.assertEqual((said["data"]["line"], said["data"]["column"]), (3, 1), said)
        self.assertTrue(said["message"].startswith("toml:3:1: "), said)
        for method, what, params in (("begin", "options.duration", {"options": {"duration": 1}}), ("to", "x_mm", {"stroke": 1}),
                                     ("drive", "tactor", {"tactor": 9}), ("subscribe", "events", {"events": ["x"]}),
                                     ("hello", "name", {"name": "a\x1bb"})):
            self.check_error(c.error(method, **params), -32602, what)
        self.assertTrue(c.ok("options")["options"])

    def test_the_server_refuses_what_the_schema_refuses(self):
        c = self.serve().client()
        path = {"path": "M 0 0 L 9 9", "options": {"snap": True}}
        requests = (
            ("hello", {"name": "pad", "token": "x"}), ("play", {**path, "start": "armed", "gain_db": -3, "repeat": 2, "round_s": 0, "pause_s": 0, "held": False}),
            ("play", {"points": [[0, 0, 0], [1, 9, 9]], "start": "armed", "repeat": True}), ("play", {**path, "start": {"delay_s": 600}}),
            ("plan", {**path, "start": {"after": [1]}, "view": "peaks", "bins": 3, "draft": 1}), ("plan", {**path, "view": "percept", "observer": "centroid"}),
            ("level", {"db": -3}), ("cancel", {"all": True}), ("fire", {}), ("status", {}), ("options", {}), ("qr", {"text": "x"}),
            ("begin", {"options": {"level_dbfs": -20}, "timeout_s": 1, "smooth_s": 0}), ("drive", {"tactor": 1, "intensity": 0.5, "duration_s": 0.1, "start": "armed"}),
            ("subscribe", {"events": ["levels"], "levels_hz": 1}), ("export", {**path, "as": "toml", "fit": False, "name": "x"}),
            ("import", {"text": '[stroke]\npath = "M 0 0 L 9 9"\n', "name": "a.toml", "fit": False, "intensity_max": 1, "position": ""}))
        wrong = (None, True, False, 0, -1, 1.5, 1e300, "", "x" * 500, "a\x1b", [], [0], ["x"], {}, {"x": 1}, {"delay_s": 1, "unix_s": 1}, {"after": []})
        refused = 0
        for method, params in requests:
            self.assertNotEqual(c.call(method, **params).get("error", {}).get("code"), -32602, (method, params))
            for name in (*params, "dance"):
                for changed in ({**params, name: value} for value in wrong):
                    if not MESSAGE.is_valid({"jsonrpc": "2.0", "method": method, "params": changed}):
                        said = c.call(method, **changed)
                        self.assertEqual(said.get("error", {}).get("code"), -32602, (method, changed, said))
                        self.assertEqual(said["error"]["data"]["what"].partition(".")[0], name, (method, changed, said))
                        refused += 1
                without = {k: v for k, v in params.items() if k != name}
                if not MESSAGE.is_valid({"jsonrpc": "2.0", "method": method, "params": without}):
                    self.assertEqual(c.call(method, **without).get("error", {}).get("code"), -32602, (method, without))
                    refused += 1
        self.assertGreater(refused, 500)

    def test_the_owner_s_speed_level_and_latency_hold(self):
        c = self.serve(config="[defaults]\nspeed = 20\nlatency-ms = 5\nlevel-dbfs = -20\n").client()
        line = {"path": "M 0 20 L 40 20"}
        for params, duration_s in ((line, 2.0), (line | {"options": {"speed": 80}}, 0.5),
                                   ({"toml": '[stroke]\npath = "M 0 20 L 40 20"\nduration_s = 1\n'}, 1.0), ({"points": [[0, 0, 20], [1, 40, 20]]}, 1.0)):
            self.assertAlmostEqual(c.ok("plan", **params)["stroke"]["duration_s"], duration_s)
        self.assertAlmostEqual(c.ok("hello")["stream"]["latency_s"], 0.005)
        self.assertEqual(c.ok("hello")["max_level_dbfs"], -20)
        self.write("a.toml", '[array]\ngrid = { rows = 3, columns = 3, pitch_mm = 20.0 }\n[[tactor]]\ntactor = 4\nmax_dbfs = -30\n')
        fault = self.serve("--socket", self.dir / "limited.sock", "--array", "a.toml").client().error("play", path="M 0 0 L 40 40")
        self.assertIn("above its max_dbfs of -30 dBFS", fault["message"])
        self.assertNotIn("a.toml", fault["message"])  # the owner's file
        c = self.serve("--socket", self.dir / "b.sock", config='[serve]\nmax_level_dbfs = -30\n[defaults]\nlevel-dbfs = -20\n').client()
        self.assertEqual(c.ok("hello")["max_level_dbfs"], -30)
        for method, params in (("play", line), ("begin", {})):
            self.check_error(c.error(method, **params, options={"level_dbfs": -29.9}), -32602, "options.level_dbfs")
        self.assertEqual(c.ok("plan", stroke="park2016-1")["render"]["level_dbfs"], -30)

    def test_sensation_levels_add_up_to_the_ceiling_and_not_to_a_gain_above_it(self):
        samples = self.dir / "out.raw"
        tactors = self.write("weak.toml", '[array]\nname = "weak"\n[[tactor]]\nx_mm = 0.0\ny_mm = 0.0\nchannel = 0\n'
                             'gain_db = 6.0\nthreshold_dbfs = -40.0\n')
        s = self.serve("--array", tactors, device=("-D", f"raw:{samples}"), config="[serve]\nmax_level_dbfs = -20\n")
        c = s.client()
        loud = {"path": "M 0 0 L 0.001 0", "options": {"algorithm": "continuous", "duration": 0.1, "sl": 20, "outside": "clamp"}}
        self.assertEqual(c.ok("hello")["stream"]["format"], "s32")
        strokes = [c.ok("play", **loud, start="armed")["stroke"] for _ in range(3)]
        c.ok("fire")
        for stroke in strokes:
            self.assertEqual(c.await_end(stroke)["state"], "finished")
        self.assertEqual(s.terminate()[0], 0)
        peak = max(map(abs, array.array("i", samples.read_bytes()))) / 2**31
        self.assertAlmostEqual(20 * math.log10(peak), -20, delta=0.01)

    def test_armed_and_waiting_strokes_are_fired_and_stopped(self):
        s = self.serve()
        a, b = s.client(), s.client()
        toml = "".join(f"[[stroke]]\npath = 'M 0 0 L 40 {y}'\nduration_s = 0.1\n" for y in (0, 10, 20))
        armed = a.ok("play", toml=toml, start="armed", options={"algorithm": "continuous"})["strokes"]
        later = a.ok("play", **SHORT, start={"delay_s": 3600})["stroke"]
        self.assertEqual({x["stroke"]: x["state"] for x in b.ok("status")["strokes"]}, dict.fromkeys(armed, "armed") | {later: "waiting"})
        self.check_error(b.error("cancel", stroke=later), -32002, "stroke")
        self.assertEqual([b.ok("fire"), b.ok("fire")], [{"count": 3}, {"count": 0}])
        starts = [a.stroke(n, "started")["started_s"] for n in armed]
        # Exact as far as two readings of the clock agree; timed/test_times.py checks the rest.
        self.assertGreaterEqual(starts[2] - starts[0], 0.199)
        self.assertEqual([a.await_end(n)["state"] for n in armed], ["finished"] * 3)
        self.assertEqual(b.ok("stop"), {})
        end = a.await_end(later)
        self.assertEqual((end["state"], end["frames"], end["started_s"]), ("cancelled", 0, None))
        n = a.ok("play", **SHORT)["stroke"]
        self.assertEqual(a.await_end(n)["state"], "finished")

    def test_a_leaving_client_ends_only_its_live_strokes_and_a_half_closed_one_gets_the_end(self):
        s = self.serve()
        c, watcher, half = s.client(), s.watcher("strokes", "touches", "stops"), s.client()
        live = c.ok("begin", timeout_s=3600)["stroke"]
        c.raw(b'{"jsonrpc":"2.0","id":77,"method":"to","params":{"stroke":%d,"x_mm":1e400,"y_mm":0}}\n' % live)
        self.check_error(c.reply()["error"], -32602, "x_mm")
        c.ok("to", stroke=live, x_mm=10, y_mm=20, intensity=100)
        place = watcher.notification(lambda m: m["method"] == "touches")["params"]
        self.assertEqual((place["stroke"], place["x_mm"], place["y_mm"], place["down"]), (live, 10, 20, True))
        played = c.ok("play", **LONG)["stroke"]
        c.stroke(played, "started")
        c.close()
        end = watcher.await_end(live)
        self.assertEqual((end["state"], end["held_points"]), ("finished", 1))
        self.assertEqual([(x["stroke"], x["state"]) for x in watcher.ok("status")["strokes"]], [(played, "started")])
        half.send({"jsonrpc": "2.0", "id": 1, "method": "play", "params": SHORT})
        half.socket.shutdown(socket.SHUT_WR)
        self.assertEqual(half.await_end(half.reply()["result"]["stroke"])["state"], "finished")
        self.assertIsNone(half.next())
        s.process.terminate()
        self.assertEqual(watcher.notification(lambda m: m["method"] == "stops")["params"], {"client": 0, "name": ""})

    def test_levels_are_those_of_the_tactors(self):
        c = self.serve().client()
        c.ok("subscribe", events=["levels"], levels_hz=100)
        n = c.ok("drive", tactor=3, duration_s=300)["stroke"]
        m = c.notification(lambda m: m["method"] == "levels" and m["params"]["dbfs"][3] is not None
                           and m["params"]["dbfs"][3] > -12.1)["params"]["dbfs"]
        self.assertEqual([v is None for v in m], [i != 3 for i in range(9)])
        self.assertLess(m[3], -11.9)
        c.ok("cancel", stroke=n)

    def test_status_has_its_fields_and_who_is_there(self):
        s = self.serve("--tcp", "0", "--http", "0")
        a, b = s.client(), s.client(tcp=True)
        mine = a.ok("hello", name="Ann \u2766")["client"]
        theirs = b.ok("hello", name="Bob")["client"]
        page = Peer(s.where["http"].removeprefix("http://").rstrip("/"))
        self.addCleanup(page.socket.close)
        self.assertEqual(page.upgrade(), 101)
        a.ok("play", **LONG)
        r = a.ok("status")
        self.assertEqual(list(r), ["version", "stream", "amplifier", "clients", "who", "strokes", "max_level_dbfs", "limits"])
        self.assertLessEqual({"state", "xruns", "uptime_s", "realtime"}, set(r["stream"]))
        self.assertEqual((r["stream"]["state"], r["amplifier"], r["clients"]), ("running", "none", 3))
        who = r["who"]
        self.assertEqual([(x["client"], x["name"], x["from"]) for x in who],
                         [(mine, "Ann \u2766", "this computer"), (theirs, "Bob", "127.0.0.1"), (who[-1]["client"], "", "127.0.0.1")])
        self.refused(3, "status", "--socket", self.write("file", ""), says=["it is not a socket"])
        said = self.ok("status", "--socket", s.where["socket"]).stdout
        for line in (f"  {mine} Ann \u2766 from this computer\n", f"  {theirs} Bob from 127.0.0.1\n", f"  {who[-1]['client']} from 127.0.0.1\n"):
            self.assertIn(line, said)
        self.assertEqual(json.loads(self.ok("status", "--socket", s.where["socket"], "--format", "json").stdout)["who"][:3], who)


class Limits(ServeTest):
    def test_the_configuration_s_limits_hold(self):
        c = self.serve(config="[serve]\nmax_strokes = 3\nmax_live_strokes = 1\nmax_points_per_s = 5\nmax_stroke_s = 300\nmax_message_bytes = 20000\n").client()
        self.check_error(c.error("play", path="M 0 0 L 40 40", options={"algorithm": "continuous", "duration": 300.1}),
                         -32001, "max_stroke_s")
        n = c.ok("begin", timeout_s=3600)["stroke"]
        self.check_error(c.error("begin"), -32001, "max_live_strokes")
        # At once: five more may come each second.
        c.raw(b"".join(json.dumps({"jsonrpc": "2.0", "id": i, "method": "to", "params": {"stroke": n, "x_mm": 1, "y_mm": 1}}).encode()
                       + b"\n" for i in range(100)))
        codes = [c.reply().get("error", {}).get("code") for _ in range(100)]
        self.assertEqual(codes[:5], [None] * 5)
        self.assertIn(-32001, codes)
        for _ in range(2):
            c.ok("play", **SHORT, start="armed")
        for method, params in (("play", SHORT), ("drive", {"tactor": 0})):
            self.check_error(c.error(method, **params), -32001, "max_strokes")
        c.raw(b" " * 20001)
        self.check_error(c.reply()["error"], -32001, "max_message_bytes")
        self.assertIsNone(c.reply())
        c = self.serve("--socket", self.dir / "slow.sock", config="[serve]\nmax_message_s = 0.2\n").client()
        self.check_error(c.next()["error"], -32001, "max_message_s")
        self.assertIsNone(c.next())

    def test_places_are_limited_and_freed(self):
        s = self.serve("--tcp", "0", config="[serve]\nmax_clients = 4\nkept_clients = 2\n")
        for _ in range(2):  # a place that leaks shows in the second round
            network = [s.client(tcp=True) for _ in range(2)]
            for c in network:
                c.ok("hello")
            third = s.client(tcp=True)
            refused = third.next()["error"]
            self.check_error(refused, -32001, "max_clients")
            self.assertIn("all 4 places for clients are taken, 2 of them only for this machine's socket", refused["message"])
            self.assertIsNone(third.next())
            local = [s.client() for _ in range(2)]
            for c in local:
                self.assertEqual(c.ok("hello")["protocol"], "tactor/1")
            self.check_error(s.client().next()["error"], -32001, "max_clients")
            for c in network + local[1:]:
                c.socket.shutdown(socket.SHUT_WR)
                self.assertIsNone(c.next())
            self.assertEqual(local[0].ok("status")["clients"], 1)
            local[0].socket.shutdown(socket.SHUT_WR)
            self.assertIsNone(local[0].next())

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
        self.assertRegex(log.read_text(), r" info stroke 1 \"path\" at -12 dBFS of client \d+ \(this computer\): began \S+Z \(\d+\.\d{6} s by CLOCK_MONOTONIC\), finished after 0\.05")
        # Accepts no further byte, like a full disk: the log ends with the reason, and nothing else ends.
        resource.prlimit(s.process.pid, resource.RLIMIT_FSIZE, (log.stat().st_size, resource.RLIM_INFINITY))
        self.assertEqual(c.await_end(c.ok("play", **SHORT)["stroke"])["state"], "finished")
        status, _, err = s.terminate()
        self.assertEqual(status, 0, err)
        self.assertIn("serve.log: File too large: the log ends here", err)
        self.assertFalse(os.path.exists(s.where["socket"]))

    def test_unwritable_standard_output_does_not_stop_it(self):
        file = str(self.dir / "full.sock")
        with open("/dev/full", "w", encoding="ascii") as full:
            p = self.start_tool("serve", "-D", "null", "--socket", file, stdout=full, stderr=subprocess.PIPE, text=True)
        said = next(line for line in p.stderr if "standard output" in line)
        self.assertIn("No space left on device: the addresses could not be printed", said)
        c = Client(file)
        self.assertEqual(c.await_end(c.ok("play", **SHORT)["stroke"])["state"], "finished")
        c.close()
        p.terminate()
        self.assertEqual(p.wait(PATIENCE_S), 0)

    def test_a_card_that_comes_later_is_used(self):
        conf = self.dir / "late.conf"
        conf.write_text("pcm.!default { type null }\n")
        c = self.serve(device=("-D", "late"), env={"ALSA_CONFIG_PATH": str(conf), "XDG_RUNTIME_DIR": str(self.dir)}).watcher("stream")
        for method, params in (("play", SHORT), ("begin", {})):
            self.check_error(c.error(method, **params), -32000, "stream")
        conf.write_text("pcm.!default { type null }\npcm.late { type null }\n")
        os.utime(conf, (time.time() + 10, time.time() + 10))  # ALSA looks at whole seconds
        c.notification(lambda m: m["method"] == "stream" and m["params"]["state"] == "running")
        n = c.ok("play", **SHORT)["stroke"]
        self.assertEqual(c.await_end(n)["state"], "finished")

    def test_an_idle_stream_stops_and_starts_with_the_next_stroke(self):
        c = self.serve("--idle-stop", "0.05").watcher("stream")
        # The notification may have come before anybody listened.
        while c.ok("status")["stream"]["state"] != "idle":
            pass
        for method, params in (("play", SHORT), ("drive", {"tactor": 0, "duration_s": 0.05})):
            n = c.ok(method, **params)["stroke"]
            self.assertEqual(c.await_end(n)["state"], "finished")
            c.notification(lambda m: m["method"] == "stream" and m["params"]["state"] == "idle")


if __name__ == "__main__":
    main()
