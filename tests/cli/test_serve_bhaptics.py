# SPDX-License-Identifier: MIT
"""tactor serve --bhaptics with programs that speak SDK1, written from its schema."""
import json

from harness import main
from serving import ServeTest
from websocket import TEXT, Peer


class Program(Peer):
    """A program as the SDK makes them: it registers, submits, and reads the status."""

    def say(self, **message):
        self.frame(TEXT, json.dumps(message).encode())

    def submit(self, kind, key="", **more):
        self.say(Submit=[{"Type": kind, "Key": key, **more}])

    def draw(self, key, ms, *places, position="VestFront"):
        points = [{"X": x, "Y": y, "Intensity": 100, "MotorCount": 3} for x, y in places]
        self.submit("frame", key, Frame={"DurationMillis": ms, "Position": position, "PathPoints": points, "DotPoints": []})

    def status(self, matches=lambda s: True):
        """Returns the next status that matches."""
        while True:
            s = json.loads(self.text())
            assert set(s) == {"RegisteredKeys", "ActiveKeys", "ConnectedDeviceCount", "ConnectedPositions", "Status"}, s
            if matches(s):
                return s

    def await_keys(self, *keys):
        return self.status(lambda s: s["ActiveKeys"] == sorted(keys))


class Bhaptics(ServeTest):
    PATH = "/v2/feedbacks?app_id=game&app_name=A%20game"

    def serve(self, *args, **more):
        s = super().serve("--bhaptics", "0", *args, **more)
        self.assertRegex(s.where["bhaptics"], r"^ws://127\.0\.0\.1:[1-9]\d*/v2/feedbacks$")
        s.address = s.where["bhaptics"].removeprefix("ws://").partition("/")[0]
        return s

    def program(self, s, expected=101, target=PATH, **headers):
        p = Program(s.address)
        self.addCleanup(p.socket.close)
        self.assertEqual(p.upgrade(target, **headers), expected)
        return p

    def test_a_frame_sounds_where_it_lies_below_the_ceiling(self):
        s = self.serve("--max-level-dbfs", "-30")
        watcher = s.watcher("levels")
        p = self.program(s)
        p.draw("a", 60000, (0, 0), (1, 1))
        p.await_keys("a")
        loud = watcher.notification(lambda m: m["method"] == "levels" and any(v is not None for v in m["params"]["dbfs"]))
        dbfs = watcher.notification(lambda m: m["method"] == "levels" and any(v is not None for v in m["params"]["dbfs"]))["params"]["dbfs"]
        self.assertEqual([i for i, v in enumerate(dbfs) if v is not None and v > -60], [0, 8], loud)
        self.assertLessEqual(max(v for v in dbfs if v is not None), -30 + 1e-3)
        self.assertGreater(max(v for v in dbfs if v is not None), -31)
        said = p.status(lambda s: any(s["Status"]["VestFront"]))
        self.assertEqual([i for i, v in enumerate(said["Status"]["VestFront"]) if v], [0, 8])
        p.submit("turnOff", "a")
        p.await_keys()

    def test_what_programs_register_and_submit_is_in_the_status(self):
        s = self.serve()
        p = self.program(s)
        first = p.status()
        self.assertEqual((first["RegisteredKeys"], first["ActiveKeys"]), ([], []))
        self.assertEqual(first["ConnectedDeviceCount"], len(first["ConnectedPositions"]))
        self.assertIn("Vest", first["ConnectedPositions"])
        p.say(Register=[{"Key": "shot", "Project": {"tracks": [], "layout": {}}}, {"Key": "", "Project": {}}, {"Key": "x"}])
        self.assertEqual(p.status(lambda s: s["RegisteredKeys"])["RegisteredKeys"], ["shot"])
        p.draw("b", 60000, (0.5, 0.5))
        p.draw("c", 60000, (0.5, 0.5))
        p.await_keys("b", "c")
        p.submit("turnOffAll")
        p.await_keys()
        p.draw("d", 100, (0.5, 0.5))
        p.await_keys("d")
        p.await_keys()

    def test_two_programs_have_their_own_keys_and_one_that_leaves_takes_its_strokes_along(self):
        s = self.serve()
        a, b = self.program(s), self.program(s)
        watcher = s.watcher()
        a.draw("x", 60000, (0.5, 0.5))
        b.draw("x", 60000, (0.1, 0.5))
        a.await_keys("x")
        b.await_keys("x")
        self.assertEqual(len(watcher.ok("status")["strokes"]), 2)
        a.socket.close()
        end = watcher.notification(lambda m: m["method"] == "stroke" and m["params"]["state"] != "started")["params"]
        self.assertEqual((end["state"], end["reason"]), ("cancelled", "its client's connection has ended"))
        self.assertEqual(len(watcher.ok("status")["strokes"]), 1)
        b.submit("turnOff", "x")
        b.await_keys()

    def test_one_mebibyte_registers_and_more_is_too_long(self):
        s = self.serve()
        p = self.program(s)
        p.say(Register=[{"Key": "large", "Project": {"tracks": [], "name": "x" * 900_000}}])
        self.assertEqual(p.status(lambda s: s["RegisteredKeys"])["RegisteredKeys"], ["large"])
        for text in ("[" * 1_000_000, '{"Register":' * 50_000, "{", "7", '{"Submit": 7}', '{"Submit": [{"Type": "key", "Key": "nobody"}]}'):
            p.frame(TEXT, text.encode())
        p.draw("a", 60000, (0.5, 0.5))
        p.await_keys("a")
        with self.assertRaises((EOFError, ConnectionError)) as e:
            p.frame(TEXT, b"[" + b" " * (1 << 20) + b"]")  # refused while it is being sent
            while True:
                p.text()
        if isinstance(e.exception, EOFError) and e.exception.args:
            self.assertEqual(int.from_bytes(e.exception.args[0][:2], "big"), 1009)

    def test_a_flood_stays_within_the_places_of_a_client_and_a_stop_works(self):
        s = self.serve()
        p = self.program(s)
        for i in range(3000):
            p.draw(f"key {i % 300}", 60000, (i % 7 / 6, i % 5 / 4))
        watcher = s.client()
        self.until(lambda: watcher.ok("status")["strokes"], s.process)
        self.assertLessEqual(len(watcher.ok("status")["strokes"]), 64)
        p.submit("turnOffAll")
        self.until(lambda: not watcher.ok("status")["strokes"], s.process)
        watcher.ok("stop")
        self.assertEqual(s.terminate()[0], 0)

    def test_pages_of_others_and_other_paths_are_refused(self):
        s = self.serve()
        for target in ("/rpc", "/", "/v2/feedback", "/v2/feedbacks/"):
            self.program(s, 404, target)
        self.program(s, 403, Origin="http://evil.example")
        self.program(s, 403, host="evil.example")
        self.program(s, Origin=f"http://{s.address}")
        refused = super().serve("--socket", str(self.dir / "2.sock"), "--bhaptics", "0", config='[serve]\nallow_hosts = ["game.example"]\n')
        refused.address = refused.where["bhaptics"].removeprefix("ws://").partition("/")[0]
        self.program(refused, Origin="https://game.example")

    def test_it_is_off_unless_asked_for_and_stays_on_this_machine(self):
        s = super().serve()
        self.assertNotIn("bhaptics", s.where)
        s.terminate()
        self.refuses_to_start(2, "--bhaptics", "0.0.0.0:0", says="other machines can reach it, and osc_peers lists none")
        self.refuses_to_start(2, "--bhaptics", "nowhere:x", says="--bhaptics")
        s = super().serve("--socket", str(self.dir / "2.sock"), config="[serve]\nbhaptics = 0\n")
        self.assertTrue(s.where["bhaptics"])
        # A token guards tcp and http; these programs have none.
        s = self.serve("--socket", str(self.dir / "3.sock"), config=self.token())
        self.program(s).status()


if __name__ == "__main__":
    main()
