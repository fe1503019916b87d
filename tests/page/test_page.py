# SPDX-License-Identifier: MIT
"""The page of `tactor serve --http` in a real Chromium: drawing, stopping, playing, permissions, and its messages when
something is missing. Usage: test_page.py TOOL SOURCE_ROOT [FOLDER_FOR_PICTURES]"""
import http.server
import json
import pathlib
import sys
import threading

PICTURES = pathlib.Path(sys.argv.pop(3)).resolve() if len(sys.argv) > 3 else None
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from browser import BrowserTest  # noqa: E402
from harness import ToolTest, main  # noqa: E402
from serving import Server  # noqa: E402

DARK = [{"name": "prefers-color-scheme", "value": "dark"}]


class DrawingPage(BrowserTest, ToolTest):
    def serve(self, *args, **more):
        s = Server(self, "--http", "0", *args, **more)
        if s.where is None:
            self.fail(s.errors)
        return s

    def ready(self, s, **more):
        p = self.page(s.where["http"], **more)
        p.until("document.querySelector('#state').textContent.startsWith('running')")
        watcher = s.client()
        watcher.ok("subscribe", events=["strokes"])
        return p, watcher

    def place(self, p, part_x, part_y):
        """Returns a place on the field, by parts of the distance between the first tactor and the last."""
        a, b = p.middle(".ring"), p.value("(() => { const r = [...document.querySelectorAll('.ring')].at(-1)"
                                          ".getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]; })()")
        return a[0] + part_x * (b[0] - a[0]), a[1] + part_y * (b[1] - a[1])

    @staticmethod
    def next_stroke(watcher, state):
        return watcher.notification(lambda m: m["method"] == "stroke" and m["params"]["state"] == state)["params"]

    def says(self, p, text):
        p.until(f"document.querySelector('#says').textContent.includes({json.dumps(text)})")

    def test_the_mouse_draws_and_the_drawing_plays_again(self):
        p, watcher = self.ready(self.serve())
        self.assertEqual(p.value("document.querySelectorAll('.ring').length"), 9)
        self.assertTrue(p.value("document.querySelector('#again').disabled"))
        p.mouse("mousePressed", *self.place(p, 0.1, 0.1))
        first = self.next_stroke(watcher, "started")["stroke"]
        for i in range(1, 20):
            p.mouse("mouseMoved", *self.place(p, 0.1 + i * 0.04, 0.5))
        # The tactors move in the picture as they do on the skin.
        p.until("[...document.querySelectorAll('.beat')].some(b => Number(b.getAttribute('r')) > 0)")
        p.mouse("mouseMoved", *self.place(p, 1.1, 1.1))  # beside the array
        p.mouse("mouseReleased", *self.place(p, 0.9, 0.9))
        self.assertEqual(self.next_stroke(watcher, "finished")["stroke"], first)
        p.until("!document.querySelector('#again').disabled")
        self.assertEqual(p.value("drawn.length"), 1)
        self.assertGreater(p.value("drawn[0].points.length"), 5)
        p.click("#again")
        self.assertGreater(self.next_stroke(watcher, "started")["stroke"], first)
        self.next_stroke(watcher, "finished")
        self.assertEqual(p.value("document.querySelector('#says').className"), "")
        self.assertEqual(self.saved(p), "drawn.csv")
        self.assertEqual(self.run_tool("plan", "drawn.csv").returncode, 0)

    def saved(self, p):
        """Returns the name of the file that the page offers, once it exists."""
        name, text = p.value("""(async () => { let blob, name; const make = URL.createObjectURL;
            URL.createObjectURL = b => { blob = b; return make(b); };
            HTMLAnchorElement.prototype.click = function () { name = this.download; };
            document.querySelector('#save').click(); return [name, await blob.text()]; })()""")
        self.write(name, text)
        return name

    def test_each_finger_is_a_stroke(self):
        p, watcher = self.ready(self.serve(), size=(390, 844))
        p.touch("touchStart", (1, *self.place(p, 0.1, 0.1)), (2, *self.place(p, 0.9, 0.1)))
        both = {self.next_stroke(watcher, "started")["stroke"] for _ in range(2)}
        self.assertEqual(len(both), 2)
        p.touch("touchMove", (1, *self.place(p, 0.1, 0.9)), (2, *self.place(p, 0.9, 0.9)))
        p.touch("touchEnd")
        self.assertEqual({self.next_stroke(watcher, "finished")["stroke"] for _ in range(2)}, both)
        # And one recording, which plays and is saved as it was drawn.
        p.until("!document.querySelector('#again').disabled")
        self.assertEqual(p.value("drawn.length"), 2)
        p.click("#again")
        again = {self.next_stroke(watcher, "started")["stroke"] for _ in range(2)}
        self.assertEqual({self.next_stroke(watcher, "finished")["stroke"] for _ in range(2)}, again)
        self.assertFalse(again & both)
        self.assertEqual(self.saved(p), "drawn.toml")
        result = self.run_tool("plan", "drawn.toml", "--algorithm", "continuous", "--format", "json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual([s["stroke"]["name"] for s in json.loads(result.stdout)["plans"]], ["finger 1", "finger 2"])

    def test_fingers_that_touch_in_turn_are_one_recording_while_one_touches(self):
        p, watcher = self.ready(self.serve(), size=(390, 844))
        p.touch("touchStart", (1, *self.place(p, 0.1, 0.1)))
        self.next_stroke(watcher, "started")
        p.touch("touchStart", (1, *self.place(p, 0.1, 0.1)), (2, *self.place(p, 0.9, 0.1)))
        self.next_stroke(watcher, "started")
        p.touch("touchMove", (1, *self.place(p, 0.1, 0.9)), (2, *self.place(p, 0.9, 0.9)))
        p.touch("touchEnd")
        p.until("!document.querySelector('#again').disabled")
        self.assertEqual(p.value("drawn[0].start_s"), 0)
        self.assertGreater(p.value("drawn[1].start_s"), 0)
        # The next drawing replaces it.
        p.mouse("mousePressed", *self.place(p, 0.5, 0.5))
        p.mouse("mouseMoved", *self.place(p, 0.6, 0.5))
        p.mouse("mouseReleased", *self.place(p, 0.6, 0.5))
        p.until("drawn.length === 1")

    def test_a_finger_that_rests_plays_on(self):
        s = self.serve()
        p, watcher = self.ready(s)
        p.mouse("mousePressed", *self.place(p, 0.5, 0.5))
        number = self.next_stroke(watcher, "started")["stroke"]
        # Longer than the service waits for a point, by the stream's clock.
        began = s.client().ok("status")["stream"]["uptime_s"]
        asker = s.client()
        while asker.ok("status")["stream"]["uptime_s"] < began + 0.8:
            pass
        self.assertIn(number, [x["stroke"] for x in asker.ok("status")["strokes"]])
        p.mouse("mouseReleased", *self.place(p, 0.5, 0.5))
        self.assertEqual(self.next_stroke(watcher, "finished")["stroke"], number)

    def test_the_keyboard_draws_and_space_stops(self):
        p, watcher = self.ready(self.serve())
        p.value("document.querySelector('#field').focus()")
        p.key("Enter")
        number = self.next_stroke(watcher, "started")["stroke"]
        p.key("ArrowRight")
        p.key("ArrowDown", modifiers=8)
        p.key("Enter")
        self.assertEqual(self.next_stroke(watcher, "finished")["stroke"], number)
        p.click("#play")
        number = self.next_stroke(watcher, "started")["stroke"]
        p.key("Space", " ")
        ended = watcher.await_end(number)
        self.assertEqual(ended["state"], "cancelled")
        self.assertNotIn("somebody", p.value("document.querySelector('#says').textContent"))

    def test_space_stops_with_any_focus(self):
        p, watcher = self.ready(self.serve())
        for id in ("level", "file", "preset", "play", "field"):
            p.value("play({path: 'M 0 0 L 40 40'}).then(() => 1)")
            number = self.next_stroke(watcher, "started")["stroke"]
            p.value(f"document.querySelector('#{id}').focus()")
            p.key("Space", " ")
            self.assertEqual(watcher.await_end(number)["state"], "cancelled", id)

    def test_another_client_stops(self):
        s = self.serve()
        p, watcher = self.ready(s)
        p.value("play({path: 'M 0 0 L 40 40'}).then(() => 1)")
        self.next_stroke(watcher, "started")
        s.client().ok("stop")
        self.says(p, "stopped by another client")

    def test_files_and_their_errors_are_shown(self):
        p, watcher = self.ready(self.serve())
        upload = """(() => { const d = new DataTransfer(); d.items.add(new File([%s], %s));
            const f = document.querySelector('#file'); f.files = d.files; f.dispatchEvent(new Event('change')); })()"""
        p.value(upload % (json.dumps("t_s,x_mm,y_mm\n0,0,0\n0.2,40,40\n"), json.dumps("line.csv")))
        self.next_stroke(watcher, "started")
        p.value(upload % (json.dumps("t_s,x_mm,y_mm\n0,zero,0\n"), json.dumps("line.csv")))
        self.says(p, "zero")
        p.value(upload % (json.dumps("x"), json.dumps("line.exe")))
        self.says(p, "ends in .toml")

    def test_no_other_server_is_asked(self):
        s = self.serve()
        p, _ = self.ready(s)
        self.assertEqual({u for u in p.requests() if u != "data:,"}, {s.where["http"]})

    def test_the_token_is_required(self):
        token = self.write("token", "secret\n")
        token.chmod(0o600)
        s = self.serve(config=f'[serve]\ntoken_file = "{token}"\n')
        self.says(self.page(s.where["http"]), "token: it is owed")
        self.says(self.page(s.where["http"] + "#token=guess"), "token: it is wrong")
        p = self.page(s.where["http"] + "#token=secret")
        p.until("document.querySelector('#state').textContent.startsWith('running')")

    def test_another_origin_s_page_cannot_connect(self):
        s = self.serve("--tcp", "0")

        class Evil(http.server.BaseHTTPRequestHandler):
            def do_GET(self):
                self.send_response(200)
                self.end_headers()
                self.wfile.write(b"<title>evil</title>")

            def log_message(self, *_):
                pass

        with http.server.HTTPServer(("127.0.0.1", 0), Evil) as evil:
            threading.Thread(target=evil.serve_forever, daemon=True).start()
            self.addCleanup(evil.shutdown)
            p = self.page(f"http://127.0.0.1:{evil.server_port}/")
            p.until("document.title === 'evil'")
            address = s.where["http"].replace("http", "ws") + "rpc"
            tried = "new Promise(done => { const w = new WebSocket(%s); w.onopen = () => done('open'); w.onerror = () => done('refused'); })"
            self.assertEqual(p.value(tried % json.dumps(address)), "refused")
            # A simple POST of a form, to here and to the TCP port, does nothing either.
            play = json.dumps({"jsonrpc": "2.0", "method": "play", "params": {"path": "M 0 0 L 40 40", "start": "armed"}}) + "\n"
            for address in (s.where["http"], f"http://{s.where['tcp']}/"):
                p.value("fetch(%s, {method: 'POST', mode: 'no-cors', body: %s}).catch(() => 0).then(() => 1)"
                        % (json.dumps(address), json.dumps(play)))
            self.assertEqual(s.client().ok("status")["strokes"], [])
            evil.shutdown()

    def test_a_server_that_goes_and_comes_back(self):
        s = self.serve()
        p, _ = self.ready(s)
        port = s.where["http"].rsplit(":", 1)[1].rstrip("/")
        s.kill()
        p.until("document.querySelector('#state').textContent.includes('no connection')")
        self.assertEqual(p.value("document.querySelector('#state').dataset.bad"), "true")
        again = Server(self, "--http", port)
        self.assertIsNotNone(again.where)
        p.until("document.querySelector('#state').textContent.startsWith('running')")

    def test_a_missing_device_is_shown(self):
        p = self.page(self.serve(device=("-D", "hw:CARD=NotThere")).where["http"])
        p.until("document.querySelector('#state').textContent.startsWith('no device')")

    def test_it_fits_all_screens(self):
        s = self.serve()
        for size in ((1280, 800), (390, 844), (844, 390), (320, 568)):
            p, _ = self.ready(s, size=size)
            p.call("Emulation.setEmulatedMedia", features=DARK if size[0] == 844 else [])
            self.assertLessEqual(p.value("document.documentElement.scrollWidth"), size[0])
            for selector in ("#stop", "#play", "#field", "#level"):
                x, y, w, h = p.value(f"(() => {{ const r = document.querySelector('{selector}').getBoundingClientRect();"
                                     " return [r.x, r.y, r.width, r.height]; })()")
                self.assertTrue(x >= 0 and y >= 0 and x + w <= size[0] + 0.5, (size, selector, x, y, w, h))
                self.assertGreaterEqual(h, 44, (size, selector))
            stop = p.middle("#stop")
            self.assertTrue(0 <= stop[1] <= size[1], (size, stop))
            if PICTURES:
                p.picture(PICTURES / f"page-{size[0]}x{size[1]}.png")


if __name__ == "__main__":
    main()
