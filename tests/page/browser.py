# SPDX-License-Identifier: MIT
"""A headless Chromium, driven by the DevTools protocol over a WebSocket. The client of that is in cli."""
import base64
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
import unittest

from harness import PATIENCE_S
from websocket import TEXT, Peer

PROGRAM = shutil.which("chromium")
AXE = os.environ.get("TACTOR_AXE")  # axe.min.js
MIDDLE = "(r => [r.x + r.width / 2, r.y + r.height / 2])(document.querySelector(%s).getBoundingClientRect())"


class Browser:
    def __init__(self):
        self.folder = tempfile.mkdtemp(prefix="tactor-chromium-")
        # It runs, as root and in containers, without its sandbox; it only ever sees this test's pages.
        self.process = subprocess.Popen(
            [PROGRAM, "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
             "--disable-background-networking", "--disable-component-update", "--remote-debugging-port=0",
             "--host-resolver-rules=MAP pi.test 127.0.0.1",
             f"--user-data-dir={self.folder}", "about:blank"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        told = pathlib.Path(self.folder) / "DevToolsActivePort"
        until = time.monotonic() + PATIENCE_S
        while not told.exists() or len(told.read_text(encoding="ascii").splitlines()) < 2:
            if self.process.poll() is not None or time.monotonic() > until:
                raise RuntimeError("chromium does not start")
            time.sleep(0.05)  # only the file can be waited for
        port, path = told.read_text(encoding="ascii").splitlines()[:2]
        self.channel = Peer(f"127.0.0.1:{port}")
        assert self.channel.upgrade(path) == 101
        self.last = 0
        self.events = []

    def send(self, method, session=None, **params):
        """Sends a command, and waits for nothing."""
        self.last += 1
        self.channel.frame(TEXT, json.dumps({"id": self.last, "method": method, "params": params}
                                     | ({"sessionId": session} if session else {})).encode())

    def call(self, method, session=None, **params):
        self.send(method, session, **params)
        while (m := json.loads(self.channel.text())).get("id") != self.last:
            if "method" in m:
                self.events.append(m)
        assert "error" not in m, (method, m)
        return m["result"]

    def await_event(self, since, matches):
        """Returns the first event that matches, from number `since` on, of those that came and those to come."""
        while not (found := next(filter(matches, self.events[since:]), None)):
            self.events.append(json.loads(self.channel.text()))
        return found

    def open(self, address, size=(1280, 800)):
        return Page(self, address, size)

    def close(self):
        self.channel.socket.close()
        self.process.terminate()
        self.process.wait(PATIENCE_S)
        shutil.rmtree(self.folder, ignore_errors=True)


class Page:
    def __init__(self, browser, address, size):
        self.browser = browser
        self.target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = browser.call("Target.attachToTarget", targetId=self.target, flatten=True)["sessionId"]
        self.resize(size)
        for domain in ("Network", "Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")
        self.call("Page.navigate", url=address)

    def call(self, method, **params):
        return self.browser.call(method, self.session, **params)

    def reload(self):
        """Waits until nothing of the document before is left."""
        since = len(self.browser.events)
        self.call("Page.reload")
        self.browser.await_event(since, lambda e: (e.get("method"), e.get("sessionId")) == ("Page.frameNavigated", self.session))

    def value(self, expression):
        r = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in r, r
        return r["result"].get("value")

    def until(self, expression):
        """Returns the value of an expression once it is true; the page itself checks it once a frame."""
        return self.value(f"""new Promise((done, failed) => {{
            const end = performance.now() + {PATIENCE_S * 1000};
            const look = () => {{ let v; try {{ v = {expression}; }} catch {{}}
                if (v) done(v); else if (performance.now() > end) failed(new Error(document.body.innerText));
                else setTimeout(look, 16); }};
            look(); }})""")

    def frames(self):
        """Waits until the page has drawn what has changed."""
        self.value("new Promise(f => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(f, 0))))")

    def resize(self, size, density=1):
        self.call("Emulation.setDeviceMetricsOverride", width=size[0], height=size[1], deviceScaleFactor=density, mobile=False)

    def element_at(self, x, y, selector="button"):
        """Returns the id of what a pointer meets there, or of its button."""
        return self.value(f"document.elementFromPoint({x}, {y})?.closest({json.dumps(selector)})?.id")

    def requests(self):
        return [e["params"]["request"]["url"] for e in self.browser.events
                if e.get("sessionId") == self.session and e.get("method") == "Network.requestWillBeSent"]

    def faults(self):
        """Returns what the page threw and what the browser holds against it (its policy, say), but not refused connections."""
        self.value("0")
        own = [e for e in self.browser.events if e.get("sessionId") == self.session]
        entries = [e["params"]["entry"] for e in own if e.get("method") == "Log.entryAdded"]
        return [e["params"]["exceptionDetails"] for e in own if e.get("method") == "Runtime.exceptionThrown"] + [
            e for e in entries if e["level"] == "error" and e["source"] != "network"]

    def middle(self, selector):
        return self.value(MIDDLE % json.dumps(selector))

    def mouse(self, kind, x, y, send=None):
        (send or self.browser.call)("Input.dispatchMouseEvent", self.session, type=kind, x=x, y=y, button="left",
                                    buttons=0 if kind == "mouseReleased" else 1, clickCount=1)

    def tap(self, x, y):
        """Presses and releases at once: what is held for half a second is no tap."""
        self.mouse("mousePressed", x, y, self.browser.send)
        self.mouse("mouseReleased", x, y)

    def click(self, selector):
        """Clicks an element, once it is enabled."""
        element = json.dumps(selector)
        self.tap(*self.until(f"!document.querySelector({element}).disabled && {MIDDLE % element}"))

    def open_popover(self, button, popover):
        self.click(button)
        self.until(f"document.querySelector({json.dumps(popover)}).matches(':popover-open')")

    def move_to(self, *places):
        """Moves the mouse with its button down."""
        for place in places:
            self.mouse("mouseMoved", *place)

    def touch(self, kind, *points):
        self.call("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y, "id": i} for i, x, y in points])

    def key(self, code, key=None, modifiers=0):
        for kind in ("rawKeyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, code=code, key=key or code, modifiers=modifiers)

    def type(self, text):
        """Presses the key of each character, as a hand does: what takes a key as a shortcut keeps it from the field."""
        for c in text:
            self.call("Input.dispatchKeyEvent", type="keyDown", key=c, text=c)
            self.call("Input.dispatchKeyEvent", type="keyUp", key=c)

    def picture(self, file):
        self.call("Page.bringToFront")  # a tab behind another is not painted
        data = self.call("Page.captureScreenshot", format="png")["data"]
        pathlib.Path(file).write_bytes(base64.b64decode(data))

    def axe_findings(self):
        """Returns what axe-core finds wrong with the page as it is: the rule, and each element with what to do."""
        if not AXE:
            raise unittest.SkipTest("axe-core is not there (tests/lanes/page gets it)")
        if not self.value("'axe' in window"):
            self.value(pathlib.Path(AXE).read_text(encoding="utf-8") + "\n0")
        # Requests nothing, because the page has no styles from elsewhere.
        return self.value("""axe.run(document, {resultTypes: ["violations"], preload: false}).then(r => r.violations.flatMap(v =>
            v.nodes.map(n => `${v.id}: ${n.target.join(" ")}: ${n.failureSummary}`)))""")

    def close(self):
        self.browser.call("Target.closeTarget", targetId=self.target)


class BrowserTest:
    """A mix-in for unittest.TestCase: one browser for the tests of a class, as self.browser."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)

    def page(self, address, **more):
        p = self.browser.open(address, **more)
        self.addCleanup(p.close)
        return p
