# SPDX-License-Identifier: MIT
"""The studio in a browser, for its tests: a service, a page of it, and hands that draw."""
import base64
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from browser import BrowserTest  # noqa: E402
from harness import ALSA_CONFIG, ToolTest  # noqa: E402
from serving import Server  # noqa: E402

DESKTOP, TABLET, PHONE, LYING = (1440, 900), (820, 1180), (390, 844), (844, 390)
SIZES = (DESKTOP, TABLET, PHONE, LYING)
DARK = [{"name": "prefers-color-scheme", "value": "dark"}]
LIVE = {"algorithm": "continuous"}  # options of a live stroke
MISSING, NULL = ("-D", "hw:CARD=NotThere"), ("-D", "null")
ARRAY = ("-D", "array")  # a device that counts as a card: only the PCM null plays to nobody
LONG = "[[stroke]]\npath = 'M 0 0 L 40 40'\nduration_s = 60.0\n"
# Keeps the toasts of a page: one may cover another at once.
TOASTS = """globalThis.toasts = []; addEventListener("DOMContentLoaded", () => new MutationObserver(all => toasts.push(
    ...all.map(change => [...change.addedNodes].map(n => n.textContent).join("")))).observe(document.querySelector("#toast"), {childList: true}))"""
TAKE = "(tactor.state.takes.find(t => t.id === tactor.state.current) ?? tactor.state.trial)"

quoted = json.dumps  # as a literal of JavaScript


class StudioTest(BrowserTest, ToolTest):
    def setUp(self):
        super().setUp()
        self.write("alsa.conf", ALSA_CONFIG + "pcm.array { type null }\n")

    def serve(self, *args, device=ARRAY, **more):
        s = Server(self, "--http", "0", *args, device=device, **more)
        if s.where is None:
            self.fail(s.errors)
        return s

    def other(self, s, name):
        """Returns another client, with a name."""
        c = s.client()
        c.ok("hello", name=name)
        return c

    def token(self, text):
        path = self.write("token", text + "\n")
        path.chmod(0o600)
        return f'[serve]\ntoken_file = "{path}"\n'

    def restart(self, s, **more):
        """Kills a service and starts another at the same address."""
        port = s.where["http"].rsplit(":", 1)[1].rstrip("/")
        s.kill()
        again = Server(self, "--http", port, **{"device": ARRAY} | more)
        self.assertIsNotNone(again.where)
        return again

    def open(self, s, fragment="", fingers=False, **more):
        """Opens the page. With `fingers` the screen is one that is touched."""
        p = self.page("about:blank", **({"size": DESKTOP} | more))
        if fingers:
            p.call("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=5)
        p.call("Page.addScriptToEvaluateOnNewDocument", source=TOASTS)
        p.call("Page.navigate", url=s.where["http"] + fragment)
        p.call("Page.bringToFront")  # a tab behind another has no frames
        p.until("tactor.state")
        # Whatever a test does, the page throws nothing and keeps to its policy.
        self.addCleanup(lambda: self.assertEqual(p.faults(), []))
        return p

    def ready(self, s, **more):
        """Returns a page that is connected and has its array, and a client that watches what plays."""
        p = self.open(s, **more)
        self.await_service(p)
        watcher = s.client()
        watcher.ok("subscribe", events=["strokes"])
        return p, watcher

    @staticmethod
    def await_service(p):
        p.until("tactor.state.link === 'connected' && tactor.state.options.length && document.querySelector('#state').textContent === 'Running'"
                " && document.querySelectorAll('#examples li').length")

    def reload(self, p):
        p.reload()
        self.await_service(p)

    def says(self, p, word):
        """Waits until the chip says so."""
        p.until(f"document.querySelector('#state').textContent === {quoted(word)}")

    @staticmethod
    def toast(p, text):
        """Waits for a toast; those before it are done with."""
        p.until(f"(i => i >= 0 && toasts.splice(0, i + 1))(toasts.findIndex(t => t.includes({quoted(text)})))")

    @staticmethod
    def banner(p, text):
        p.until(f"!document.querySelector('#banner').hidden && document.querySelector('#banner-text').textContent.includes({quoted(text)})")

    # Hands. Places are in millimetres of the array.

    @staticmethod
    def at(p, *places):
        """Returns places of the array as pixels of the page."""
        return [tuple(q) for q in p.value(f"{json.dumps(places)}.map(tactor.place_in_page)")]

    def press(self, p, *places):
        """Puts the mouse down and moves it; it stays down."""
        first, *rest = self.at(p, *places)
        p.mouse("mousePressed", *first)
        p.move_to(*rest)
        return (first, *rest)[-1]

    def draw(self, p, *places):
        """Draws with the mouse; returns once it is a take."""
        before = p.value("tactor.state.takes.length")
        p.mouse("mouseReleased", *self.press(p, *places))
        p.until(f"tactor.state.takes.length > {before} && !tactor.state.drawing")

    @staticmethod
    def way(start, end, steps=12):
        """Returns places along a straight way."""
        return [[a + (b - a) * i / steps for a, b in zip(start, end)] for i in range(steps + 1)]

    def fingers(self, p, kind, *places):
        p.touch(kind, *((i, *q) for i, q in enumerate(self.at(p, *places))))

    def draw_rows(self, p, rows):
        """Draws a row with each finger, from left to right; all stay down."""
        self.fingers(p, "touchStart", *([5, y] for y in rows))
        for x in range(8, 36, 3):
            self.fingers(p, "touchMove", *([x, y] for y in rows))

    def planned(self, p):
        """Waits for the plan of the current take as it is now."""
        p.until(f"tactor.state.plan && tactor.state.plan_of === {TAKE}")

    @staticmethod
    def mend(p, word):
        """Does what one of the warnings offers."""
        p.until(f"(globalThis.offer = [...document.querySelectorAll('#warnings button')].find(b => b.textContent === {quoted(word)}))")
        p.value("offer.click()")

    @staticmethod
    def choose_files(p, files):
        """Opens files, {name: text or bytes}, by the page's field for files."""
        data = {name: base64.b64encode(v.encode() if isinstance(v, str) else v).decode() for name, v in files.items()}
        p.value("""(files => { const d = new DataTransfer(), e = document.querySelector("#file");
            for (const [name, v] of Object.entries(files)) d.items.add(new File([Uint8Array.from(atob(v), c => c.charCodeAt(0))], name));
            e.files = d.files; e.dispatchEvent(new Event("change")); })(%s)""" % json.dumps(data))

    @staticmethod
    def watch_sent(p):
        """Keeps what the page sends from now on in `sent`: method, ms, the moment of the take, and the parameters."""
        p.value("""globalThis.sent = []; (send => { WebSocket.prototype.send = function (text) { const {method, params} = JSON.parse(text);
            sent.push({method, ms: performance.now(), at_s: tactor.state.at_s, ...params}); return send.call(this, text); }; })(WebSocket.prototype.send)""")

    @staticmethod
    def add_example(p):
        p.value("document.querySelector('#examples button').click()")

    @staticmethod
    def set_slider(p, label, place):
        """Sets a slider of the pane to one of its places, 0 to 1000."""
        p.until("(globalThis.found = [...document.querySelectorAll('#pane .slider')].find(s => s.textContent.startsWith(%s))?.querySelector('input'))"
                % quoted(label))
        p.value(f"found.value = {place}, found.dispatchEvent(new Event('input')), found.dispatchEvent(new Event('change'))")

    @staticmethod
    def next_stroke(watcher, state):
        return watcher.notification(lambda m: m["method"] == "stroke" and m["params"]["state"] == state)["params"]["stroke"]

    def take(self, p):
        return p.value(TAKE)

    def saved(self, p, kind):
        """Saves the current take with the page's own buttons; returns the file."""
        folder = self.dir / "downloads"
        folder.mkdir(exist_ok=True)
        p.browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(folder), eventsEnabled=True)
        since = len(p.browser.events)
        p.open_popover("#save", "#p-save")
        p.click(f"#p-save [data-kind={kind}]")
        done = p.browser.await_event(since, lambda e: e.get("method") == "Browser.downloadProgress" and e["params"]["state"] != "inProgress")["params"]
        self.assertEqual(done["state"], "completed")
        begun = p.browser.await_event(since, lambda e: e.get("method") == "Browser.downloadWillBegin" and e["params"]["guid"] == done["guid"])
        return folder / begun["params"]["suggestedFilename"]

    def names(self, p):
        return p.value("[...document.querySelectorAll('#takes .take b')].map(b => b.textContent)")

    def edit_point(self, p, start, end):
        """Drags a point of the stroke that is edited."""
        p.click("[data-tool=points]")
        p.until("tactor.state.tool === 'points'")
        p.mouse("mouseReleased", *self.press(p, start, end))
