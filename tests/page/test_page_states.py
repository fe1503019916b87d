# SPDX-License-Identifier: MIT
"""The studio's states in a real Chromium: what is said when something is missing, who else is there, and that nothing drawn is
lost. Usage: test_page_states.py TOOL SOURCE_ROOT"""
import os
import signal
import sys

del sys.argv[3:]
from studio import LIVE, MISSING, StudioTest, quoted  # noqa: E402
from harness import main  # noqa: E402


class NothingIsLost(StudioTest):
    """While a finger draws: the service is killed, stopped, started again, with another token."""

    def begin(self, s, fragment=""):
        p = self.open(s, fragment)
        self.await_service(p)
        self.draw(p, *self.way([5, 5], [35, 5]))
        self.last = self.press(p, *self.way([5, 20], [15, 20], 6))
        p.until("tactor.state.drawing?.tracks[0].points.length > 3")
        return p

    def go_on(self, p, *places):
        had = p.value("tactor.state.drawing.tracks[0].points.length")
        p.move_to(*self.at(p, *places))
        p.until(f"tactor.state.drawing.tracks[0].points.length > {had}")

    def end(self, p):
        """Lifts the finger. The take has the whole way, and so has the browser after the page is loaded again."""
        p.mouse("mouseReleased", *self.at(p, [35, 20])[0])
        p.until("tactor.state.takes.length === 2 && !tactor.state.drawing")
        timed = self.take(p)["strokes"][0]["timed"]
        self.assertAlmostEqual(timed[0][1], 5, delta=1)
        self.assertAlmostEqual(timed[-1][1], 35, delta=1)
        takes = p.value("tactor.state.takes")
        p.reload()
        p.until("tactor.state?.takes.length === 2")
        self.assertEqual(p.value("tactor.state.takes"), takes)

    def plays(self, p, s):
        """The take that was drawn meanwhile plays."""
        self.await_service(p)
        watcher = s.client()
        watcher.ok("subscribe", events=["strokes"])
        p.until("!document.querySelector('#play').disabled")
        p.click("#play")
        number = self.next_stroke(watcher, "started")
        self.assertEqual(watcher.await_end(number)["state"], "finished")

    def test_a_name_is_kept_over_a_lost_connection(self):
        s = self.serve()
        p, _ = self.ready(s)
        p.value("(e => { e.value = 'Ann'; e.dispatchEvent(new Event('change')); })(document.querySelector('#own-name-text'))")
        p.until("tactor.state.status.who.some(w => w.name === 'Ann')")
        self.restart(s)
        p.until("tactor.state.link === 'lost'")
        self.await_service(p)
        p.until("tactor.state.status.who.some(w => w.name === 'Ann')")

    def test_the_service_is_killed_and_comes_back_later(self):
        s = self.serve()
        p = self.begin(s)
        s.kill()
        self.go_on(p, [20, 20])
        self.says(p, "No connection")
        self.banner(p, "nothing is lost")
        self.go_on(p, [30, 20], [35, 20])
        # It is still shown, and Stop says what it can do.
        p.key("Space", " ")
        self.toast(p, "No connection: use the amplifier's switch")
        p.until("tactor.state.takes.length === 2")
        p.mouse("mouseReleased", *self.at(p, [35, 20])[0])
        p.click("#play")
        self.toast(p, "shown, not felt")
        p.until("tactor.state.playing")
        p.until("!tactor.state.playing")
        again = self.restart(s)
        self.says(p, "Running")
        self.assertTrue(p.until("document.querySelector('#banner').hidden"))
        self.plays(p, again)

    def test_the_service_starts_again_while_the_finger_is_down(self):
        s = self.serve()
        p = self.begin(s)
        again = self.restart(s)
        self.go_on(p, [20, 20], [25, 20])
        self.await_service(p)
        self.go_on(p, [30, 20], [35, 20])
        self.end(p)
        self.plays(p, again)

    def test_the_service_is_stopped_and_goes_on(self):
        s = self.serve()
        p = self.begin(s)
        os.kill(s.process.pid, signal.SIGSTOP)
        self.says(p, "No answer")
        self.assertEqual(p.value("tactor.state.link"), "connected")
        self.go_on(p, [20, 20], [30, 20])
        os.kill(s.process.pid, signal.SIGCONT)
        self.says(p, "Running")
        self.go_on(p, [33, 20], [35, 20])
        self.end(p)
        self.plays(p, s)

    def test_stop_is_sent_to_a_service_that_does_not_answer(self):
        s = self.serve()
        p, watcher = self.ready(s)
        number = s.client().ok("play", path="M 0 0 L 40 40", options={"algorithm": "continuous", "duration": 300})["stroke"]
        watcher.stroke(number, "started")
        os.kill(s.process.pid, signal.SIGSTOP)
        p.key("Space", " ")
        self.says(p, "No answer")
        self.assertNotEqual(p.value("document.querySelector('#toast').textContent"), "Stopped, everybody's strokes")
        os.kill(s.process.pid, signal.SIGCONT)
        self.assertEqual(watcher.await_end(number)["state"], "cancelled")
        self.toast(p, "Stopped, everybody's strokes")
        self.says(p, "Stopped")

    def test_the_token_changes(self):
        s = self.serve(config=self.token("secret"))
        p = self.begin(s, "#token=secret")
        again = self.restart(s, config=self.token("another"))
        self.says(p, "Locked")
        self.banner(p, "token is wrong")
        self.go_on(p, [20, 20], [30, 20], [35, 20])
        p.mouse("mouseReleased", *self.at(p, [35, 20])[0])
        p.until("tactor.state.takes.length === 2 && !tactor.state.drawing")
        p.click("#token-text")
        p.call("Input.insertText", text="another")
        p.click("#token button")
        self.says(p, "Running")
        self.assertEqual(p.value("[location.hash, tactor.state.takes.length]"), ["#token=another", 2])
        self.plays(p, again)


class Devices(StudioTest):
    def test_without_a_card_it_is_drawn_and_shown(self):
        p = self.open(self.serve(device=MISSING))
        self.says(p, "No card")
        self.banner(p, "No sound card. Plug it in and it goes on by itself.")
        p.click("#banner-more")
        self.assertIn("NotThere", p.until("!document.querySelector('#banner-details').hidden && document.querySelector('#banner-details').textContent"))
        self.draw(p, *self.way([5, 5], [35, 35]))
        self.planned(p)
        p.click("#play")
        self.toast(p, "No card: shown, not felt")
        p.until("tactor.state.playing && tactor.state.at_s > 0")
        p.until("!tactor.state.playing")


class Others(StudioTest):
    def why(self, p, text):
        p.until(f"document.querySelector('#state-why').textContent.includes({quoted(text)})")

    def test_touches_of_others_are_shown_and_who_plays(self):
        s = self.serve()
        p, _ = self.ready(s)
        phone = self.other(s, "A phone")
        p.until("document.querySelector('#others-text').textContent === '2 others'")
        number = phone.ok("begin", options=LIVE, timeout_s=86400)["stroke"]
        for x in (10, 20, 30):
            phone.ok("to", stroke=number, x_mm=x, y_mm=25)
        p.until("[...tactor.state.touches.values()].some(t => t.x_mm === 30 && t.y_mm === 25)")
        self.says(p, "Someone is playing")
        self.why(p, "A phone")
        p.click("#others")
        p.until("document.querySelector('#people').textContent.includes('A phone')")
        self.assertIn("playing", p.value("[...document.querySelectorAll('#people li')].find(l => l.textContent.includes('A phone')).textContent"))
        phone.ok("end", stroke=number)
        p.until("tactor.state.touches.size === 0")
        self.says(p, "Running")

    def test_who_stopped_is_said(self):
        s = self.serve()
        p, watcher = self.ready(s)
        p.click("#hint-example")
        number = self.next_stroke(watcher, "started")
        self.other(s, "A phone").ok("stop")
        self.assertIn(watcher.await_end(number)["state"], ("cancelled", "finished"))
        self.says(p, "Stopped")
        self.why(p, "by A phone")
        self.toast(p, "Stopped by A phone")
        p.until("!tactor.state.playing")

    def test_the_own_name_is_told_to_others(self):
        s = self.serve()
        p, watcher = self.ready(s)
        p.until("!document.querySelector('#others').hidden")
        p.click("#others")
        p.until("document.querySelector('#own-name-text').checkVisibility()")
        p.value("document.querySelector('#own-name-text').focus()")
        p.call("Input.insertText", text="Ada's laptop")
        p.value("document.querySelector('#own-name-text').blur()")
        self.until(lambda: "Ada's laptop" in [w["name"] for w in watcher.ok("status")["who"]])


if __name__ == "__main__":
    main()
