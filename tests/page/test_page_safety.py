# SPDX-License-Identifier: MIT
"""The studio in a real Chromium: who may ask and be asked, and what fits which screen. Usage: test_page_safety.py TOOL SOURCE_ROOT"""
import http.server
import json
import sys
import threading

del sys.argv[3:]
from studio import DARK, SIZES, StudioTest  # noqa: E402
from harness import main  # noqa: E402


class Safety(StudioTest):
    def test_no_other_server_is_asked(self):
        s = self.serve()
        p, _ = self.ready(s)
        own = s.where["http"]
        self.assertEqual({u for u in p.requests() if not u.startswith(("data:", "about:", "blob:" + own))}, {own})

    def test_a_policy_allows_nothing_that_the_page_does_not_need(self):
        p, _ = self.ready(self.serve())
        self.assertEqual(p.value("fetch('http://127.0.0.1:9/').then(() => 'sent', () => 'refused')"), "refused")
        p.value("document.body.append(Object.assign(document.createElement('script'), {textContent: 'globalThis.injected = 1'}))")
        self.assertIsNone(p.value("globalThis.injected"))
        refused = p.faults()
        self.assertTrue(refused and all("Content Security Policy" in f["text"] for f in refused), refused)
        p.browser.events.clear()

    def test_the_token_is_required(self):
        s = self.serve(config=self.token("secret"))
        p = self.open(s)
        self.banner(p, "needs a token")
        self.says(p, "Locked")
        self.says(self.open(s, "#token=secret"), "Running")

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


class Screens(StudioTest):
    CONTROLS = ("[...document.querySelectorAll(\"button, input, summary, [role=slider], [role=radio]\")].filter(e => e.checkVisibility({visibilityProperty: true, contentVisibilityAuto: true})"
                " && !e.closest('[popover]'))")

    def test_light_and_dark_follow_the_system_until_one_is_chosen(self):
        p, _ = self.ready(self.serve())
        theme = "document.documentElement.dataset.theme"
        for wanted in ("dark", "light"):
            p.call("Emulation.setEmulatedMedia", features=DARK if wanted == "dark" else [])
            p.until(f"{theme} === '{wanted}'")
        p.open_popover("#more", "#p-more")
        p.click("#theme")
        p.until(f"{theme} === 'dark'")
        self.reload(p)
        self.assertEqual(p.value(theme), "dark")

    def test_it_fits_all_screens_and_fingers(self):
        s = self.serve()
        for size in (*SIZES, (320, 568), (1280, 800)):
            with self.subTest(size=size):
                p, _ = self.ready(s, size=size, fingers=size[0] < 1100)
                self.assertEqual(p.value("[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"), list(size))
                boxes = p.value(f"""{self.CONTROLS}.map(e => {{ const all = e.type === 'range' ? [e, e.parentElement] : [e];
                    const r = all.map(b => b.getBoundingClientRect()).reduce((a, b) => b.height > a.height ? b : a);
                    return [e.id || e.dataset.tool || e.textContent.trim() || e.getAttribute('aria-label'), r.x, r.y, r.width, r.height]; }})""")
                for name, x, y, w, h in boxes:
                    with self.subTest(size=size, name=name):
                        if name in ("stop", "play", "field", "feel", "draw", "device", "save"):
                            self.assertTrue(x >= -0.5 and y >= -0.5 and x + w <= size[0] + 0.5 and y + h <= size[1] + 0.5, (x, y, w, h))
                        if size[0] < 1100:
                            self.assertTrue(w >= 43.5 and h >= 43.5, (x, y, w, h))
                # The array is whole, and nothing lies over Stop.
                for x, y in self.at(p, [0, 0], [40, 40]):
                    self.assertEqual(p.element_at(x, y, "*"), "field")
                self.assertEqual(p.element_at(*p.middle("#stop")), "stop")


if __name__ == "__main__":
    main()
