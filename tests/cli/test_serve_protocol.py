# SPDX-License-Identifier: MIT
"""The protocol of tactor serve for other programs."""
import array
import json
import math
import socket
import time

from harness import PATIENCE_S, main
from serving import LONG, MESSAGE, SHORT, ServeTest
from websocket import Peer


class Protocol(ServeTest):
    def test_hello_has_the_versions(self):
        r = self.serve().client().ok("hello")
        self.assertEqual(list(r), ["protocol", "version", "array", "stream", "presets", "shapes", "clock", "max_level_dbfs", "client"])
        self.assertEqual(set(r["stream"]), {"rate", "channels", "format", "period_frames", "latency_s", "pcm"})
        self.assertEqual(r["array"], self.plan("park2016-1")["array"])
        self.assertEqual((r["stream"]["pcm"], r["stream"]["channels"], r["max_level_dbfs"]), ("null", 9, -12.0))
        self.assertIn("park2016-1", r["presets"])
        self.assertLess(abs(r["clock"]["monotonic_s"] - time.monotonic()), PATIENCE_S)

    def test_json_rpc_is_followed(self):
        c = self.serve().client()

        def answer(raw):
            c.raw(raw + b"\n")
            return c.reply()

        for raw, code, number in (
                (b"{", -32700, None), (b'"\xff"', -32700, None), (b"1", -32600, None), (b"[]", -32600, None),
                (b'{"jsonrpc":"2.0","id":1}', -32600, 1), (b'{"jsonrpc":"1.0","id":2,"method":"status"}', -32600, 2),
                (b'{"jsonrpc":"2.0","id":"x","method":"dance"}', -32601, "x"),
                (b'{"jsonrpc":"2.0","id":3.5,"method":"status","params":[1]}', -32602, 3.5),
                (b'{"jsonrpc":"2.0","id":4,"method":"status","params":1}', -32600, 4),
                (b'{"jsonrpc":"2.0","id":[],"method":"status"}', -32600, None),
                (b'{"jsonrpc":"2.0","id":5,"method":"status","params":{"x":1}}', -32602, 5),
                (b'{"jsonrpc":"2.0","id":6,"method":"play","params":{"path":"M 0 0 L 9 9","":1}}', -32602, 6),
                (b"[" * 65, -32001, None),
                (json.dumps([{"jsonrpc": "2.0", "method": "status"}] * 65).encode(), -32001, None)):
            r = answer(raw)
            self.assertEqual((r["jsonrpc"], r["id"], r["error"]["code"]), ("2.0", number, code), raw)
            self.check_error(r["error"], code)
        self.assertEqual(answer(b'{"jsonrpc":"2.0","id":null,"method":"status"}')["id"], None)
        # Notifications have no reply, in a batch and alone.
        c.raw(b'{"jsonrpc":"2.0","method":"status"}\n{"jsonrpc":"2.0","method":"dance"}\n'
              b'[{"jsonrpc":"2.0","method":"stop"}]\n')
        batch = answer(b'[{"jsonrpc":"2.0","id":1,"method":"stop"}, 1, {"jsonrpc":"2.0","method":"stop"},'
                       b'{"jsonrpc":"2.0","id":2,"method":"play","params":' + json.dumps(SHORT).encode() + b'}]\r')
        self.assertEqual([r.get("id") for r in batch], [1, None, 2])
        self.assertEqual(batch[1]["error"]["code"], -32600)
        self.assertEqual(c.await_end(batch[2]["result"]["stroke"])["state"], "finished")

    def test_missing_parameters_are_empty_ones_for_every_method(self):
        c = self.serve().client()
        for method in ("hello", "play", "plan", "level", "cancel", "stop", "fire", "begin", "to", "end", "drive", "status", "subscribe", "options", "qr", "import", "export"):
            told = []
            for raw in (b"", b',"params":{}', b',"params":[]', b',"params":null'):
                c.raw(b'{"jsonrpc":"2.0","id":1,"method":"%s"%s}\n' % (method.encode(), raw))
                r = c.reply()
                told.append((list(r), r.get("error")))
            self.assertEqual(told, told[:1] * 4, method)

    def test_stop_is_never_refused_for_its_form(self):
        s = self.serve()
        a, b = s.client(), s.client()
        for raw, answered in ((b'"id":1,"params":[]', True), (b'"id":1,"params":null', True), (b'"id":1,"params":["now",1]', True),
                              (b'"id":1,"params":{"why":"hurts"}', True), (b'"id":1,"params":true', True),
                              (b'"id":[],"params":0', True), (b'"id":1,"params":' + b"[" * 99 + b"]" * 99, True), (b'"params":"x"', False)):
            mine = a.ok("play", **LONG)["stroke"]
            b.raw(b'{"jsonrpc":"2.0","method":"stop",' + raw + b'}\n')
            if answered:
                self.assertEqual(b.reply()["result"], {}, raw)
            self.assertEqual(a.await_end(mine)["state"], "cancelled", raw)
        quiet = b'{"jsonrpc":"2.0","method":"status"},'
        for raw in (b"[" + quiet * 70 + b'{"jsonrpc":"2.0","method":"stop"}]',
                    b"[" + quiet * 9000 + b'{"jsonrpc":"2.0","method":"stop"}]'):
            mine = a.ok("play", **LONG)["stroke"]
            b.raw(raw + b"\n")
            self.assertEqual(b.reply()["error"]["code"], -32001)
            self.assertEqual(a.await_end(mine)["state"], "cancelled")

    def test_play_takes_all_forms(self):
        c = self.serve().client()
        toml = "[[stroke]]\npath = 'M 0 0 L 40 0'\nduration_s = 0.1\n[[stroke]]\npath = 'M 0 0 L 0 40'\nduration_s = 0.1\n"
        for params, count in (({"stroke": "park2016-1"}, 1), (SHORT, 1), ({"points": [[0, 0, 0], [0.1, 20, 20, 0.5]]}, 1),
                              ({"toml": toml}, 2), ({"csv": "t_s,x_mm,y_mm\n0,0,0\n0.1,20,20\n"}, 1),
                              ({"svg": '<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0 L20 0 M0 20 L20 20"/></svg>'}, 2)):
            r = c.ok("play", **params)
            self.assertEqual(set(r), {"stroke", "strokes", "total_s", "warnings"})
            self.assertEqual((r["strokes"][0], len(r["strokes"])), (r["stroke"], count))
            for n in r["strokes"]:
                self.assertIsInstance(c.stroke(n, "started")["started_s"], float)
                end = c.await_end(n)
                self.assertEqual((end["state"], end["reason"]), ("finished", ""))
                self.assertGreater(end["frames"], 0)
                self.assertLess(abs(end["started_unix_s"] - time.time()), 2 * PATIENCE_S)
        self.assertEqual(c.ok("status")["strokes"], [])

    def test_plan_gives_the_output_of_the_tool(self):
        c = self.serve().client()
        self.assertEqual(c.ok("plan", stroke="park2016-3", options={"phantom": "barycentric"}),
                         self.plan("park2016-3", "--phantom", "barycentric"))
        self.check_error(c.error("plan", path="M 0 0 L 40 40", options={"algorithm": "continuous", "duration": 600}), -32001)

    def test_a_view_shows_a_part_of_the_plan(self):
        c = self.serve(config='[defaults]\nobserver = "low-speed"\n').client()
        for algorithm in ("park2016", "tactile-brush", "continuous"):
            line = {"path": "M 0 0 L 40 40", "options": {"algorithm": algorithm, "duration": 1.5}}
            plan, v = c.ok("plan", **line), c.ok("plan", **line, view="bursts")
            rows = plan["continuous"]["points"][:-1:2] if v["continuous"] else plan["bursts"]
            self.assertEqual(v["continuous"], algorithm == "continuous")
            self.assertEqual(v["onsets"], [round(r.get("onset_s", r.get("t_s")), 5) for r in rows])
            self.assertEqual(v["positions"], [round(r[x], 3) for r in rows for x in ("x_mm", "y_mm")])
            for i, r in enumerate(rows):
                on = {d["tactor"]: d["amplitude"] for d in r["drives"]}
                for k, a in enumerate(v["amplitudes"][9 * i:9 * i + 9]):
                    self.assertAlmostEqual(a, on.get(k, 0), delta=0.51e-4)
            for observer in ("centroid", None):
                v = c.ok("plan", **line, view="percept", **({"observer": observer} if observer else {}))
                self.assertEqual(v["observer"], observer or "low-speed")
                row = json.loads(self.ok("compare", "--path", line["path"], "--duration", 1.5, "--algorithm", algorithm, "--phantom",
                                         "inverse-distance", "--observer", v["observer"], "--format", "json").stdout)["results"][0]
                self.assertEqual(v["errors"], {k: row[k] for k in v["errors"]})
        v = c.ok("plan", **LONG, view="peaks", bins=100)
        self.assertEqual((v["step_s"], len(v["peaks"]), max(v["peaks"])), (3.0, 900, 1.0))
        self.assertEqual(c.ok("plan", **SHORT, view="bursts", draft=7)["strokes"][0]["count"], 25)
        for what, params in (("draft", {"draft": -1}), ("view", {"view": "all"}), ("bins", {"view": "peaks", "bins": 4001}), ("bins", {"bins": 9}),
                             ("observer", {"observer": "centroid"}), ("observer", {"view": "percept", "observer": "me"})):
            self.check_error(c.error("plan", **SHORT, **params), -32602, what)
        for what, value in (("view", "full"), ("draft", 1), ("bins", 9), ("observer", "centroid")):
            self.check_error(c.error("play", **SHORT, **{what: value}), -32602, what)
        # Views of a plan that is too large as a whole.
        long = {"path": "M 0 0 L 40 40", "options": {"algorithm": "continuous", "duration": 600}}
        self.check_error(c.error("plan", **long), -32001, "plan")
        self.assertEqual(len(c.ok("plan", **long, view="bursts")["onsets"]), 2000)

    def test_bad_strokes_and_options_name_their_parameter(self):
        c = self.serve().client()
        path = "M 0 0 L 40 40"
        for what, params in (("options.soa", {"path": path, "options": {"soa": 3}}),
                             ("options.soa", {"path": path, "options": {"soa": "0.07"}}),
                             ("options.nonsense", {"path": path, "options": {"nonsense": 1}}),
                             ("options.power_dbfs", {"path": path, "options": {"power_dbfs": 1}}),
                             ("options.level_dbfs", {"path": path, "options": {"level_dbfs": -11.9}}),
                             ("points", {"points": [[0, 0, 0], [1, 20, 20, 1.1]]}),
                             ("options.sl", {"path": path, "options": {"sl": 10}}),
                             ("options.algorithm", {"path": path, "options": {"algorithm": "x"}}),
                             ("options.snap", {"path": path, "options": {"snap": "true"}}),
                             ("options", {"path": path, "options": []}),
                             ("path", {"path": "M 0 0 L 400 400"}), ("path", {"path": "M 0 x"}), ("path", {"path": 1}),
                             ("points", {"points": [[0, 0, 0]]}), ("points", {"points": [[0, 0], [1, 2, 3]]}),
                             ("stroke", {"stroke": "/etc/passwd"}), ("toml", {"toml": "x = 1"}), ("csv", {"csv": "1,2"}),
                             ("svg", {"svg": "<svg"}), ("stroke", {}), ("path", {"stroke": "park2016-1", "path": path}),
                             ("start", {"path": path, "start": "soon"}), ("start.delay_s", {"path": path, "start": {"delay_s": -1}}),
                             ("dance", {"path": path, "dance": 1})):
            for method in ("play", "plan"):
                self.check_error(c.error(method, **params), -32602, what)
        said = c.error("play", path=path, options={"carrier": 30000})
        self.check_error(said, -32602, "options.carrier")
        self.assertEqual(said["message"].count("options.carrier"), 1, said)
        for what, options in (("options.sl", {"sl": 1}), ("options.carrier", {"carrier": 24001}),
                              ("options.algorithm", {"algorithm": "tactile-brush"})):
            self.check_error(c.error("begin", options=options), -32602, what)

    def test_faults_of_a_file_name_its_keys(self):
        c = self.serve().client()
        for line, word in (("soas = 1", "did you mean 'soa_s'?"), ("level_dbfs = 1", "unknown key 'level_dbfs'"), ("nonsense = 1", "carrier_hz")):
            said = c.error("play", toml=f'[stroke]\npath = "M 0 0 L 40 40"\n{line}\n')
            self.check_error(said, -32602, "toml")
            self.assertIn(word, said["message"])
            self.assertNotIn("options.", said["message"])
            self.assertEqual((said["data"]["line"], said["data"]["column"]), (3, 1), said)
            self.assertTrue(said["message"].startswith("toml:3:1: "), said)

    def test_a_number_that_no_double_holds_is_answered(self):
        c = self.serve().client()
        n = c.ok("begin", timeout_s=3600)["stroke"]
        c.raw(b'{"jsonrpc":"2.0","id":77,"method":"to","params":{"stroke":%d,"x_mm":1e400,"y_mm":0}}\n' % n)
        said = c.reply()
        self.assertEqual(said["id"], 77)
        self.check_error(said["error"], -32602, "x_mm")

    def test_the_owner_s_speed_is_for_strokes_without_time_and_speed(self):
        c = self.serve(config="[defaults]\nspeed = 20\nlatency-ms = 5\n").client()
        line = {"path": "M 0 20 L 40 20"}
        self.assertAlmostEqual(c.ok("plan", **line)["stroke"]["duration_s"], 2.0)
        self.assertAlmostEqual(c.ok("plan", **line, options={"speed": 80})["stroke"]["duration_s"], 0.5)
        self.assertAlmostEqual(c.ok("plan", toml='[stroke]\npath = "M 0 20 L 40 20"\nduration_s = 1\n')["stroke"]["duration_s"], 1.0)
        self.assertAlmostEqual(c.ok("plan", points=[[0, 0, 20], [1, 40, 20]])["stroke"]["duration_s"], 1.0)
        self.assertAlmostEqual(c.ok("hello")["stream"]["latency_s"], 0.005)

    def test_the_owner_s_level_is_the_ceiling(self):
        c = self.serve(config='[serve]\nmax_level_dbfs = -30\n[defaults]\nlevel-dbfs = -20\n').client()
        self.assertEqual(c.ok("hello")["max_level_dbfs"], -30)
        self.check_error(c.error("play", path="M 0 0 L 40 40", options={"level_dbfs": -29.9}), -32602, "options.level_dbfs")
        self.check_error(c.error("begin", options={"level_dbfs": -29.9}), -32602, "options.level_dbfs")
        self.assertEqual(c.ok("plan", stroke="park2016-1")["render"]["level_dbfs"], -30)
        c = self.serve("--socket", self.dir / "b.sock", config='[defaults]\nlevel-dbfs = -20\n').client()
        self.assertEqual(c.ok("hello")["max_level_dbfs"], -20)

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

    def test_cancel_stop_and_fire_work(self):
        s = self.serve()
        a, b = s.client(), s.client()
        mine = a.ok("play", **LONG)["stroke"]
        a.stroke(mine, "started")
        for method, params in (("cancel", {}), ("to", {"x_mm": 1, "y_mm": 1}), ("end", {})):
            self.check_error(b.error(method, stroke=mine, **params), -32002, "stroke")
        self.assertEqual(a.ok("cancel", stroke=mine), {})
        end = a.await_end(mine)
        self.assertEqual(end["state"], "cancelled")
        self.check_error(a.error("cancel", stroke=mine), -32002)
        armed = a.ok("play", **SHORT, start="armed")["stroke"]
        later = a.ok("play", **SHORT, start={"delay_s": 3600})["stroke"]
        self.assertEqual({x["stroke"]: x["state"] for x in b.ok("status")["strokes"]}, {armed: "armed", later: "waiting"})
        self.assertEqual(b.ok("fire"), {"count": 1})
        self.assertEqual(a.await_end(armed)["state"], "finished")
        self.assertEqual(b.ok("stop"), {})
        end = a.await_end(later)
        self.assertEqual((end["state"], end["frames"], end["started_s"]), ("cancelled", 0, None))
        n = a.ok("play", **SHORT)["stroke"]
        self.assertEqual(a.await_end(n)["state"], "finished")

    def test_an_armed_file_of_several_strokes_plays_them_all(self):
        c = self.serve().client()
        toml = "".join(f"[[stroke]]\npath = 'M 0 0 L 40 {y}'\nduration_s = 0.1\n" for y in (0, 10, 20))
        numbers = c.ok("play", toml=toml, start="armed", options={"algorithm": "continuous"})["strokes"]
        self.assertEqual({x["stroke"]: x["state"] for x in c.ok("status")["strokes"]}, {n: "armed" for n in numbers})
        self.assertEqual(c.ok("fire"), {"count": 3})
        self.assertNotIn("armed", [x["state"] for x in c.ok("status")["strokes"]])
        self.assertEqual(c.ok("fire"), {"count": 0})
        starts = [c.stroke(n, "started")["started_s"] for n in numbers]
        # Exact as far as two readings of the clock agree; timed/test_times.py checks the rest.
        self.assertGreaterEqual(starts[2] - starts[0], 0.199)
        self.assertEqual([c.await_end(n)["state"] for n in numbers], ["finished"] * 3)
        numbers = c.ok("play", toml=toml, start="armed")["strokes"]
        c.ok("stop")
        self.assertEqual([c.await_end(n)["state"] for n in numbers], ["cancelled"] * 3)

    def test_a_live_stroke_by_json_rpc(self):
        s = self.serve()
        c = s.client()
        n = c.ok("begin", timeout_s=3600)["stroke"]
        c.send({"jsonrpc": "2.0", "method": "to", "params": {"stroke": n, "x_mm": 10, "y_mm": 10}})
        self.assertIsNotNone(c.stroke(n, "started"))
        self.assertEqual(c.ok("to", stroke=n, x_mm=20, y_mm=20, intensity=100), {})
        self.assertEqual(c.ok("end", stroke=n), {})
        end = c.await_end(n)
        self.assertEqual((end["state"], end["held_points"]), ("finished", 1))
        self.check_error(c.error("to", stroke=n, x_mm=1, y_mm=1), -32002)
        n = c.ok("begin", timeout_s=0.01)["stroke"]
        self.assertEqual(c.await_end(n)["state"], "interrupted")
        self.check_error(c.error("begin", options={"duration": 1}), -32602, "options.duration")
        self.check_error(c.error("to", stroke=1), -32602, "x_mm")

    def test_a_leaving_client_ends_only_live_strokes(self):
        s = self.serve()
        c, watcher = s.client(), s.client()
        watcher.ok("subscribe", events=["strokes"])
        live = c.ok("begin", timeout_s=3600)["stroke"]
        c.ok("to", stroke=live, x_mm=10, y_mm=10)
        played = c.ok("play", **LONG)["stroke"]
        c.stroke(played, "started")
        c.close()
        self.assertEqual(watcher.await_end(live)["state"], "finished")
        self.assertEqual([(x["stroke"], x["state"]) for x in watcher.ok("status")["strokes"]], [(played, "started")])

    def test_half_closed_sockets_get_the_end(self):
        c = self.serve().client()
        c.send({"jsonrpc": "2.0", "id": 1, "method": "play", "params": SHORT})
        c.socket.shutdown(socket.SHUT_WR)
        n = c.reply()["result"]["stroke"]
        self.assertEqual(c.await_end(n)["state"], "finished")
        self.assertIsNone(c.next())

    def test_the_end_of_the_input_ends_the_last_line(self):
        s = self.serve()
        for sent, answered in ((b'{"jsonrpc":"2.0","id":1,"method":"stop"}', lambda r: r["result"] == {}),
                               (b'\n{"jsonrpc":"2.0","id":1,"method":"sto', lambda r: r["error"]["code"] == -32700)):
            c = s.client()
            c.raw(sent)
            c.socket.shutdown(socket.SHUT_WR)
            self.assertTrue(answered(c.next()), sent)
            self.assertIsNone(c.next())

    def test_drive_plays_one_tactor(self):
        c = self.serve().client()
        n = c.ok("drive", tactor=3, intensity=0.5, duration_s=0.05)["stroke"]
        self.assertEqual(c.await_end(n)["frames"], 2400)
        for what, params in (("tactor", {"tactor": 9}), ("tactor", {}), ("tactor", {"tactor": 0.5}),
                             ("intensity", {"tactor": 0, "intensity": 1.1}), ("duration_s", {"tactor": 0, "duration_s": -1})):
            self.check_error(c.error("drive", **params), -32602, what)

    def test_levels_are_those_of_the_tactors(self):
        c = self.serve().client()
        c.ok("subscribe", events=["levels"], levels_hz=100)
        c.ok("drive", tactor=3, duration_s=300)
        m = c.notification(lambda m: m["method"] == "levels" and m["params"]["dbfs"][3] is not None
                           and m["params"]["dbfs"][3] > -12.1)["params"]["dbfs"]
        self.assertEqual([v is None for v in m], [i != 3 for i in range(9)])
        self.assertLess(m[3], -11.9)
        self.check_error(c.error("subscribe", events=["x"]), -32602, "events")
        self.check_error(c.error("subscribe", events=[], levels_hz=101), -32602, "levels_hz")
        c.ok("subscribe", events=[])

    def test_status_has_its_fields(self):
        s = self.serve()
        c = s.client()
        c.ok("play", **SHORT)
        r = c.ok("status")
        self.assertEqual(list(r), ["version", "stream", "amplifier", "clients", "who", "strokes", "limits"])
        self.assertLessEqual({"state", "xruns", "uptime_s", "realtime"}, set(r["stream"]))
        self.assertEqual((r["stream"]["state"], r["amplifier"], r["clients"]), ("running", "none", 1))
        self.assertEqual(r["who"], [{"client": c.ok("hello")["client"], "name": "", "from": "this computer"}])

    def test_who_is_there_is_told_with_names_and_addresses(self):
        s = self.serve("--tcp", "0", "--http", "0")
        a, b = s.client(), s.client(tcp=True)
        mine = a.ok("hello", name="Ann \u2766")["client"]
        theirs = b.ok("hello", name="Bob")["client"]
        page = Peer(s.where["http"].removeprefix("http://").rstrip("/"))
        self.addCleanup(page.socket.close)
        self.assertEqual(page.upgrade(), 101)
        who = a.ok("status")["who"]
        self.assertEqual([(x["client"], x["name"], x["from"]) for x in who],
                         [(mine, "Ann \u2766", "this computer"), (theirs, "Bob", "127.0.0.1"), (who[-1]["client"], "", "127.0.0.1")])
        said = self.ok("status", "--socket", s.where["socket"]).stdout
        for line in (f"  {mine} Ann \u2766 from this computer\n", f"  {theirs} Bob from 127.0.0.1\n", f"  {who[-1]['client']} from 127.0.0.1\n"):
            self.assertIn(line, said)
        self.assertEqual(json.loads(self.ok("status", "--socket", s.where["socket"], "--format", "json").stdout)["who"][:3], who)
        self.check_error(a.error("hello", name="a\x1bb"), -32602, "name")

    def test_the_array_s_place_on_the_body_is_told(self):
        palm = self.write("palm.toml", '[array]\nsite = "left palm"\nup = "fingers"\nplace = [1, -56]\nturn = 15\n'
                          'body = 180\npreset = "palm-3x3"\n')
        self.ok("check", "--array", palm, "-D", "null")
        c = self.serve("--array", palm).client()
        array = c.ok("hello")["array"]
        self.assertEqual([array.pop(k) for k in ("site", "up", "place", "turn", "body")], ["left palm", "fingers", [1, -56], 15, 180])
        self.assertEqual(array, self.plan("park2016-1", "--array", palm)["array"])

    def test_touches_and_stops_of_others_are_told(self):
        s = self.serve()
        draws, looks = s.client(), s.client()
        me = draws.ok("hello", name="Ann")["client"]
        looks.ok("subscribe", events=["touches", "stops"])
        n = draws.ok("begin", timeout_s=3600)["stroke"]
        draws.ok("to", stroke=n, x_mm=10, y_mm=20)
        told = looks.notification(lambda m: m["method"] == "touches")["params"]
        self.assertEqual(told, {"client": me, "stroke": n, "x_mm": 10, "y_mm": 20, "down": True})
        draws.ok("stop")
        self.assertEqual(looks.notification(lambda m: m["method"] == "stops")["params"], {"client": me, "name": "Ann"})
        self.assertEqual(looks.notification(lambda m: m["method"] == "touches")["params"], told | {"down": False})
        s.process.terminate()
        self.assertEqual(looks.notification(lambda m: m["method"] == "stops")["params"], {"client": 0, "name": ""})

    def test_the_options_are_those_of_the_schema(self):
        c = self.serve(config="[defaults]\nsoa = 0.06\n").client()
        rows = {x["name"]: x for x in c.ok("options")["options"]}
        self.assertEqual(set(rows), set(MESSAGE.schema["$defs"]["options"]["properties"]))
        self.assertEqual((rows["soa"]["default"], rows["level_dbfs"]["default"]), (0.06, -12))


if __name__ == "__main__":
    main()
