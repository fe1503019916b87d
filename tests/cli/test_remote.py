# SPDX-License-Identifier: MIT
"""Clients in the tool: play --socket, stop, status, and live strokes from standard input, here and through a server."""
import json
import signal
import socket
import subprocess
import time

from harness import PATIENCE_S, main
from serving import ServeTest

BRIEF = ("--path", "M 0 0 L 40 40", "--algorithm", "continuous", "--duration", "0.05")
LONG = ("--path", "M 0 0 L 40 40", "--algorithm", "continuous", "--duration", "300")


class Remote(ServeTest):
    def talking(self, *args):
        return self.start_tool(*args, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def ended(self, p, *statuses, stdin=None):
        """Waits until the tool ends with one of these exit statuses; returns its output and its messages."""
        out, err = p.communicate(stdin, timeout=PATIENCE_S)
        self.assertIn(p.returncode, statuses, out + err)
        return out, err

    def fed(self, where, *lines):
        """Begins a live stroke from standard input."""
        p = self.talking("play", "--live", "-", "--socket", where)
        p.stdin.write("".join(lines))
        p.stdin.flush()
        return p

    def started(self, client, states=("started",)):
        return client.notification(lambda m: m["method"] == "stroke" and m["params"]["state"] in states)["params"]

    def test_play_through_a_server(self):
        s = self.serve()
        r = self.ok("play", *BRIEF, "--socket", s.where["socket"])
        self.assertIn("--path: played 0.050 s", r.stdout)
        stroke = self.write("two.toml", "[[stroke]]\npath = 'M 0 0 L 40 0'\nduration_s = 0.1\n"
                                        "[[stroke]]\npath = 'M 0 0 L 0 40'\nduration_s = 0.1\n")
        record = json.loads(self.ok("play", "park2016-1", stroke, "--duration", "0.1", "--algorithm", "continuous", "--format",
                                    "json", "--socket", s.where["socket"]).stdout)
        self.assertEqual([(x["stroke"], x["state"]) for x in record["strokes"]],
                         [("park2016-1", "finished"), (str(stroke), "finished")])
        self.assertEqual(record["strokes"][1]["frames"], 9600)
        self.assertEqual((record["schema"], record["device"]["pcm"]), ("tactor-play/1", "null"))
        self.write("nine.wav", "RIFF")
        self.refused(2, "play", "nine.wav", "--socket", s.where["socket"], says=["nine.wav: it has samples, which a server does not accept"])
        self.write("meet.toml", "".join(f"[[stroke]]\nstart_s = 0.0\npath = '{path}'\nduration_s = 0.56\n" for path in ("M 0 20 H 40", "M 40 20 H 0")))
        for where in ((), ("--socket", s.where["socket"])):
            ran = self.ok("play", "meet.toml", "--format", "json", *where)
            self.assertIn("meet.toml: weakened by 6.02 dB: strokes 1 and 2 meet on tactor 4 at 0.28 s (use --together sum to let strokes add up)", ran.stderr)
            met = json.loads(ran.stdout)["strokes"][0]
            self.assertAlmostEqual(met["weakened_db"], -6.0206, 3)
            self.assertEqual((met["meets"]["tactor"], met["meets"]["strokes"]), (4, [0, 1]))

    def test_bursts_are_moved_through_a_server(self):
        s = self.serve()
        move = ("--compensate", "low-speed", "--sigma-mm", "8", "--phantom", "barycentric")
        here = self.ok("play", "park2016-1", *move, "--duration", "0.4")
        there = self.ok("play", "park2016-1", *move, "--duration", "0.4", "--socket", s.where["socket"])
        moved = [line for line in here.stderr.splitlines() if "bursts are moved" in line]
        self.assertEqual(len(moved), 1)
        self.assertIn(moved[0], there.stderr.splitlines())
        options = {"compensate": "low-speed", "sigma_mm": 8, "phantom": "barycentric", "duration": 0.4}
        record = s.client().ok("plan", stroke="park2016-1", options=options)
        self.assertEqual(record["compensation"], self.plan("park2016-1", *move, "--duration", "0.4")["compensation"])

    def test_a_file_has_the_same_format_through_a_server(self):
        s = self.serve()
        points = "t_s,x_mm,y_mm\n0,0,0\n0.05,40,40\n"
        self.write("points.CSV", "# of a tracker\n" + points)
        self.write("points", "\n# of a tracker\n" + points)
        self.write("nameless", "time,x,y\n0,0,0\n0.05,40,40\n")
        for name in ("points.CSV", "points"):
            self.assertIn("played 0.050 s", self.ok("play", name, "--algorithm", "continuous", "--socket", s.where["socket"]).stdout)
        here, there = (self.refused(2, "play", "nameless", *where).stderr for where in (("-D", "null"), ("--socket", s.where["socket"])))
        self.assertEqual(here, there)

    def test_the_users_socket_is_found(self):
        env = {"XDG_RUNTIME_DIR": str(self.dir)}
        s = self.serve(env=env)
        self.assertEqual(s.where["socket"], str(self.dir / "tactor.sock"))
        self.ok("stop", env=env)
        self.assertEqual(json.loads(self.ok("status", "--format", "json", env=env).stdout)["stream"]["state"], "running")
        self.assertIn("running", self.ok("status", env=env).stdout)

    def test_a_missing_server_is_a_missing_device(self):
        for command in (("stop",), ("status",), ("play", "park2016-1")):
            self.refused(3, *command, "--socket", "none.sock")
            for address in ("127.0.0.1:4919", "http://127.0.0.1:4003/"):
                self.refused(3, *command, "--socket", address, says=["give --socket the path that tactor serve prints"])

    def test_a_server_s_refusal_names_options_and_lines(self):
        s = self.serve()
        self.write("bad.toml", '[stroke]\npath = "M 0 0 L 40 40"\nsoas = 1\n')
        for args in (("--soa", "3"), ("--level-dbfs", "-1"), ("--sl", "7"), ("--sigma-mm", "8")):
            said = self.refused(2, "play", "park2016-1", *args, "--socket", s.where["socket"]).stderr
            self.assertNotIn("options.", said)
        for args in (("--path", "M 0 0 L 400 0"), ("nonsense",)):
            self.refused(2, "play", *args, "--socket", s.where["socket"])
        for option in ("--array palm-3x3", "-D null", "--fit", "--rate 48000", "--power-dbfs 3", "--max-drive-s 3", "--drive-window-s 9",
                       "--require-realtime", "--no-gpio", "--latency-ms 5", "--period-frames 96", "--periods 3", "--reopen-s 1",
                       "--sync-delay-ms 3", "--log x.log", "--verbose"):
            self.refused(2, "play", "park2016-1", *option.split(), "--socket", s.where["socket"],
                         says=("--socket", option.split()[0].replace("-D", "--device")))
        here, there = (self.refused(2, "play", "bad.toml", *where).stderr for where in (("-D", "null"), ("--socket", s.where["socket"])))
        self.assertEqual(there, here)
        plan = self.ok("plan", "park2016-1", "--format", "json").stdout
        self.write("plan.json", plan)
        for argument, name in (("plan.json", "plan.json"), ("-", "standard input")):
            self.refused(2, "play", argument, "--socket", s.where["socket"], stdin=plan, says=(f"{name}: it is a plan", "a server"))

    def test_stop_and_ctrl_c_end_it_with_their_status(self):
        s = self.serve()
        watcher = s.watcher()
        p = self.talking("play", *LONG, "--socket", s.where["socket"])
        self.started(watcher)
        self.ok("stop", "--socket", s.where["socket"])
        self.assertIn("cancelled", self.ended(p, 1)[1])
        p = self.talking("play", *LONG, "--socket", s.where["socket"])
        n = self.started(watcher)["stroke"]
        p.send_signal(signal.SIGINT)
        self.ended(p, 130)
        self.assertEqual(watcher.await_end(n)["state"], "cancelled")

    def test_a_signal_ends_a_client_whose_server_does_not_answer(self):
        hung = str(self.dir / "hung.sock")
        with socket.socket(socket.AF_UNIX) as door:
            door.bind(hung)
            door.listen()
            for command in (("status",), ("status", "--watch"), ("stop",), ("play", "park2016-1"), ("play", "--live", "-")):
                for sent, status in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
                    p = self.talking(*command, "--socket", hung)
                    with door.accept()[0] as taken:
                        self.assertTrue(taken.recv(1))  # it has asked
                        p.send_signal(sent)
                        self.ended(p, status)

    def test_nothing_begins_that_was_still_planned_at_ctrl_c(self):
        s = self.serve()
        watcher = s.watcher()
        much = ("--path", "M 0 0 L 40 40", "--duration", "240", "--soa", "0.001", "--burst", "0.001", "--level-dbfs", "-60")
        for signals in ((signal.SIGINT,), (signal.SIGINT, signal.SIGTERM)):
            p = self.talking("play", *much, "--socket", s.where["socket"])
            self.assertIn("through", p.stdout.readline())  # it asks next
            time.sleep(0.1)
            for sent in signals:
                p.send_signal(sent)
                time.sleep(0.05)
            self.ended(p, 130, 143)
            end = self.started(watcher, ("started", "finished", "cancelled", "interrupted"))
            self.assertEqual((end["state"], end["frames"], end["reason"]), ("cancelled", 0, "cancelled by its client"))

    def test_a_second_signal_does_not_wait_for_the_fade(self):
        s = self.serve()
        watcher = s.watcher()
        p = self.talking("play", *LONG, "--socket", s.where["socket"])
        self.started(watcher)
        s.process.send_signal(signal.SIGSTOP)
        for sent in (signal.SIGINT, signal.SIGTERM):  # two of one kind may be merged
            p.send_signal(sent)
        self.ended(p, 130, 143)
        s.process.send_signal(signal.SIGCONT)

    def test_status_watches(self):
        s = self.serve()
        p = self.talking("status", "--watch", "--format", "json", "--socket", s.where["socket"])
        self.assertEqual(json.loads(p.stdout.readline())["clients"], 1)
        n = s.client().ok("drive", tactor=0, duration_s=0.05)["stroke"]
        said = []
        while len(said) < 2:
            m = json.loads(p.stdout.readline())
            if m["method"] == "stroke":
                said.append(m["params"])
        self.assertEqual([(x["stroke"], x["state"]) for x in said], [(n, "started"), (n, "finished")])
        s.process.terminate()
        self.assertEqual(json.loads(p.stdout.readline())["params"]["state"], "closing")
        self.assertEqual(p.wait(PATIENCE_S), 0)

    def test_a_watch_ends_with_its_reader(self):
        s = self.serve()
        p = self.talking("status", "--watch", "--socket", s.where["socket"])
        p.stdout.readline()
        p.stdout.close()
        client = s.client()
        deadline = time.monotonic() + PATIENCE_S
        while p.poll() is None and time.monotonic() < deadline:
            client.ok("drive", tactor=0, duration_s=0.001)
            time.sleep(0.05)
        self.assertEqual((p.wait(PATIENCE_S), p.stderr.read()), (128 + signal.SIGPIPE, ""))

    def test_lines_move_a_live_stroke_through_a_server(self):
        s = self.serve()
        watcher = s.watcher()
        p = self.fed(s.where["socket"], "10 10\n\n# a remark\n20 20 0.5\n")
        n = self.started(watcher)["stroke"]
        self.assertIn("live: played", self.ended(p, 0, stdin="30 30")[0])
        self.assertEqual(watcher.await_end(n)["state"], "finished")
        p = self.fed(s.where["socket"], "10 10\n")
        n = self.started(watcher)["stroke"]
        self.assertIn("standard input:2:", self.ended(p, 2, stdin="10 x\n")[1])
        self.assertIn(watcher.await_end(n)["state"], ("cancelled", "finished"))
        # The server's interruption is a failure.
        p = self.fed(self.serve("--socket", self.dir / "b.sock", config="[serve]\nmax_stroke_s = 0.1\n").where["socket"], "10 10\n")
        self.assertEqual(p.wait(PATIENCE_S), 1)
        self.assertRegex(p.stderr.read(), "tactor: live: interrupted after .* s: limit: it reached the longest allowed duration\n")

    def played_at_a_door(self, points, answer):
        """Plays live points to a server in this test; `answer(params)` gives its reply to each of them, None: accepted."""
        path = str(self.dir / "door.sock")
        with socket.socket(socket.AF_UNIX) as door:
            door.bind(path)
            door.listen()
            p = self.fed(path, points)
            p.stdin.close()
            p.stdin = None
            with door.accept()[0] as peer, peer.makefile("rw", encoding="utf-8") as lines:
                for line in lines:
                    m = json.loads(line)
                    reply = {"result": {"stream": {"format": None, "state": "running"}, "stroke": 1}}
                    if m["method"] == "to":
                        reply = answer(m["params"]) or reply
                    if m["method"] == "end":
                        reply = {"method": "stroke", "params": {"stroke": 1, "state": "finished"} |
                                 {"reason": "", "frames": 1, "started_s": None, "late_s": 0}}
                    lines.write(json.dumps({"jsonrpc": "2.0"} | ({"id": m["id"]} if "id" in m else {}) | reply) + "\n")
                    lines.flush()
        self.assertEqual(self.ended(p, 0)[1], "")

    def test_points_that_a_limit_refuses_are_sent_again_and_none_is_lost(self):
        taken, refused = [], set()

        def answer(params):
            x = params["x_mm"]
            if x % 10 == 9 and x not in refused:  # the last one is among them
                refused.add(x)
                return {"error": {"code": -32001, "message": "too many"}}
            return taken.append(x)

        self.played_at_a_door("".join(f"{i} {i}\n" for i in range(40)), answer)
        self.assertEqual(taken, list(range(40)))

    def test_lines_move_a_live_stroke_here(self):
        r = self.ok("play", "--live", "-", "-D", "null", stdin="10 10\n20 20 0.5\n30, 30\n")
        self.assertRegex(r.stdout, r"live: played [0-9.]+ s; from [12] points? to the DAC [0-9.]+ ms \([0-9.]+ to [0-9.]+\)\n")
        record = json.loads(self.ok("play", "--live", "-", "-D", "null", "--format", "json", stdin="10 10\n").stdout)
        self.assertEqual(record["strokes"][0]["state"], "finished")
        delay = record["strokes"][0]["delay"]
        self.assertEqual(delay["points"], 1)
        self.assertGreater(delay["least_s"], 0.0)
        self.assertEqual({delay["least_s"], delay["most_s"]}, {delay["mean_s"]})
        for line in ("1\n", "1 2 3 4\n", "1 y\n", "1 2 -1\n", "1 inf\n", "x" * 5000, "20,5 10\n", "0.1,20,20\n", "20 ,5\n", "20, 5,\n", "20,, 5\n", "20 , , 5\n", "20, , 5\n", "20 5 ,\n",
                     ", 20 5\n", "ab\0cd 22\n"):
            self.refused(2, "play", "--live", "-", "-D", "null", stdin="10 10\n" + line, says=("standard input:2:",))
        r = self.ok("play", "--live", "-", "-D", "null", "--format", "json", stdin="20 , 10\n10,\t10 , 0.5\n30 , 30\n")
        self.assertEqual(json.loads(r.stdout)["strokes"][0]["outside_points"], 0)
        for lines in ("\ufeff20 20\n21 20\n", "+20 20\n21 +2e1\n", "20 20 127\n21 20\n"):  # of other programs
            r = self.ok("play", "--live", "-", "-D", "null", "--intensity-max", "127", "--format", "json", stdin=lines)
            self.assertEqual(json.loads(r.stdout)["strokes"][0]["held_points"], 0, r.stderr)
        self.refused(2, "play", "--live", "park2016-1")
        self.ok("play", "--live", "-", "-D", "null", "--smooth", "0.1", stdin="10 10\n20 20\n")
        self.refused(2, "play", "--live", "-", "-D", "null", "--smooth", "2")
        self.refused(2, "play", "park2016-1", "-D", "null", "--smooth", "0.1")
        for option in (("--duration", "1"), ("--compensate", "low-speed"), ("--sigma-mm", "3")):
            self.refused(2, "play", "--live", "-", *option, says=(option[0], "it does not apply to live strokes"))
        self.refused(2, "play", "--live", "-", "--level-dbfs", "-1", "--array", "none.toml")

    def test_points_outside_the_array_are_counted_and_reported(self):
        lines = "640 480\n20 20\n640 480\n"
        for where in (("-D", "null"), ("--socket", self.serve().where["socket"])):
            r = self.ok("play", "--live", "-", *where, "--format", "json", stdin=lines)
            self.assertEqual(json.loads(r.stdout)["strokes"][0]["outside_points"], 2)
            r = self.ok("play", "--live", "-", *where, stdin=lines)
            self.assertIn("; 2 points outside the array moved to its edge\n", r.stdout)
        r = self.ok("play", "--live", "-", "-D", "null", "--verbose", stdin=lines)
        self.assertEqual(r.stderr.count("warning: standard input:1: the place (640, 480) mm is outside the array and moves to its edge"), 1)
        self.assertRegex(r.stderr, "warning live stroke [0-9]+: 2 points outside the array moved to its edge\n")

    def test_points_in_metres_are_reported(self):
        lines = "0.005 0.005\n0.02 0.02\n0.035 0.03\n"
        for where in (("-D", "null"), ("--socket", self.serve().where["socket"])):
            self.assertIn("if they are metres, multiply them by 1000", self.ok("play", "--live", "-", *where, stdin=lines).stdout)

    def test_a_server_repeats_a_stroke(self):
        where = ("--socket", self.serve().where["socket"])
        stroke = ("--path", "M 0 10 H 1", "--duration", "0.1")
        played = self.ok("play", *stroke, *where, "--repeat", "3", "--pause", "0.2", "--format", "json").stdout
        (told,) = json.loads(played)["strokes"]
        self.assertEqual((told["rounds"], told["state"]), (None, "finished"))
        self.assertAlmostEqual(told["played_s"], 3 * 0.3, delta=0.21)  # the last pause may be left out
        self.refused(2, "play", "park2016-1", "park2016-2", *where, "--repeat", "2", says=("--repeat: a server can repeat only one STROKE argument",))

    def test_an_intensity_above_1_sounds_as_1_and_is_reported_once(self):
        lines = "20 20 80\n20, 20, 0.5\n0.1 20 20\n"
        warning = "tactor: warning: standard input:1: an intensity of 80 plays as 1: the requested level is the ceiling "
        for where in (("-D", "null"), ("--socket", self.serve().where["socket"])):
            r = self.ok("play", "--live", "-", *where, "--format", "json", stdin=lines)
            self.assertEqual(r.stderr.count("plays as 1"), 1, r.stderr)
            self.assertIn(warning, r.stderr)
            self.assertEqual(json.loads(r.stdout)["strokes"][0]["held_points"], 2)
        r = self.ok("play", "--live", "-", "-D", "null", "--verbose", stdin=lines)
        self.assertIn("live: played", r.stdout)
        self.assertIn("; 2 points above intensity 1 played as 1\n", r.stdout)
        self.assertRegex(r.stderr, "warning live stroke [0-9]+: 2 points above intensity 1 played as 1: the requested level is the ceiling\n")

    def test_nan_lifts_the_touch_until_the_next_point(self):
        taken = []
        self.played_at_a_door("nan nan\n10 10\n20\t15 0.5\nNaN nan\n nan -nan nan\n20 nan 1\nnan\n30, 30\n",
                              lambda params: taken.append([params[name] for name in ("x_mm", "y_mm", "intensity")]))
        self.assertEqual(taken, [[10, 10, 1], [20, 15, 0.5], *[[20, 15, 0]] * 4, [30, 30, 1]])
        self.ok("play", "--live", "-", "-D", "null", stdin="nan nan\n")

    def test_ctrl_c_ends_a_live_stroke(self):
        p = self.talking("play", "--live", "-", "-D", "null")
        self.assertIn("null", p.stdout.readline())
        p.send_signal(signal.SIGINT)
        self.ended(p, 130)


if __name__ == "__main__":
    main()
