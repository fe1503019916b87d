# SPDX-License-Identifier: MIT
"""What lasts while it is held, a tactor or a method, in a real Chromium. Usage: test_page_hold.py TOOL SOURCE_ROOT"""
import sys

del sys.argv[3:]
from studio import LONG, NULL, PHONE, TAKE, StudioTest, quoted  # noqa: E402
from harness import main  # noqa: E402

CONTINUOUS = "[data-value=continuous]"
HELD = "document.querySelector('[data-held]')"


class Hands(StudioTest):
    @staticmethod
    def key_down(p, key, code=None, repeat=False):
        p.call("Input.dispatchKeyEvent", type="rawKeyDown", key=key, code=code or key, autoRepeat=repeat)

    @staticmethod
    def key_up(p, key, code=None):
        p.call("Input.dispatchKeyEvent", type="keyUp", key=key, code=code or key)

    @staticmethod
    def silent(p):
        """Waits until the page knows that nothing sounds: the space bar stops what does."""
        p.until("!tactor.state.status.strokes.length && tactor.state.dbfs.every(v => v === null)")

    @staticmethod
    def sounds_on(s, number, seconds):
        """Waits by the stream's clock; the stroke sounds on."""
        asker = s.client()
        began = asker.ok("status")["stream"]["uptime_s"]
        while asker.ok("status")["stream"]["uptime_s"] < began + seconds:
            pass
        return number in [k["stroke"] for k in asker.ok("status")["strokes"]]


class Tactor(Hands):
    def test_it_buzzes_while_it_is_held_and_no_longer(self):
        s = self.serve(config="[serve]\nmax_level_dbfs = -20\n")
        p, watcher = self.ready(s)
        place = self.at(p, [20, 20])[0]
        p.mouse("mousePressed", *place)
        number = self.next_stroke(watcher, "started")
        # It alone, at the level; longer than a tap, and than the service waits for a sign of life.
        level, *others = p.until("tactor.state.dbfs[4] !== null && tactor.state.dbfs[4] > -21 && [tactor.state.dbfs[4], ...tactor.state.dbfs.filter((v, i) => v !== null && i !== 4)]")
        self.assertLessEqual(level, -19.9)
        self.assertEqual(others, [])
        self.assertTrue(self.sounds_on(s, number, 1.5))
        p.mouse("mouseReleased", *place)
        self.assertEqual(watcher.await_end(number)["state"], "finished")
        self.assertEqual(p.value("tactor.state.takes.length"), 0)

    def test_a_gaussian_phantom_spreads_it_to_no_other(self):
        p, watcher = self.ready(self.serve(config='[defaults]\nphantom = "gaussian"\nalgorithm = "park2016"\n'))
        place = self.at(p, [0, 40])[0]
        p.mouse("mousePressed", *place)
        self.next_stroke(watcher, "started")
        self.assertEqual(p.until("tactor.state.dbfs[6] > -13 && tactor.state.dbfs.filter(v => v !== null).length"), 1)
        p.mouse("mouseReleased", *place)

    def test_fingers_hold_a_tactor_each(self):
        p, watcher = self.ready(self.serve(), size=PHONE, fingers=True)
        self.fingers(p, "touchStart", [0, 0], [40, 40])
        numbers = {self.next_stroke(watcher, "started") for _ in range(2)}
        p.until("tactor.state.dbfs[0] !== null && tactor.state.dbfs[8] !== null")
        p.touch("touchEnd")
        for number in numbers:
            watcher.await_end(number)
        self.assertEqual(p.value("tactor.state.takes.length"), 0)

    def test_it_ends_with_the_touch_with_escape_and_where_the_page_is_left(self):
        p, watcher = self.ready(self.serve(), fingers=True)

        def escape():
            p.key("Escape")

        def cancel():
            p.touch("touchCancel")

        def leave():
            self.page("about:blank").call("Page.bringToFront")

        for end in (escape, cancel, leave):
            with self.subTest(end=end.__name__):
                self.fingers(p, "touchStart", [20, 20])
                number = self.next_stroke(watcher, "started")
                p.until(HELD)
                end()
                watcher.await_end(number)
                p.call("Page.bringToFront")
                p.until(f"!{HELD}")
                if end is not cancel:
                    p.touch("touchEnd")

    def test_it_ends_with_the_connection_and_with_another_s_stop(self):
        s = self.serve()
        p, watcher = self.ready(s)
        place = self.at(p, [20, 20])[0]
        p.mouse("mousePressed", *place)
        number = self.next_stroke(watcher, "started")
        self.other(s, "A phone").ok("stop")
        self.assertEqual(watcher.await_end(number)["state"], "cancelled")
        p.mouse("mouseReleased", *place)
        p.mouse("mousePressed", *place)
        number = self.next_stroke(watcher, "started")
        p.reload()
        watcher.await_end(number)

    def test_keys_hold_it_on_the_array_and_in_the_list(self):
        s = self.serve()
        p, watcher = self.ready(s)
        p.value("document.querySelector('#field').focus()")
        self.key_down(p, "Enter")
        number = self.next_stroke(watcher, "started")
        for _ in range(5):
            self.key_down(p, "Enter", repeat=True)
        self.assertTrue(self.sounds_on(s, number, 1))
        self.key_up(p, "Enter")
        watcher.await_end(number)
        p.open_popover("#device", "#p-device")
        for key, code in ((" ", "Space"), ("Enter", "Enter")):
            self.silent(p)
            p.value("document.querySelector('#try button:nth-child(3)').focus()")
            self.key_down(p, key, code)
            number = self.next_stroke(watcher, "started")
            p.until("tactor.state.dbfs[2] !== null")
            self.key_down(p, key, code, repeat=True)
            self.assertTrue(self.sounds_on(s, number, 1))
            self.key_up(p, key, code)
            self.assertEqual(watcher.await_end(number)["state"], "finished")
        self.assertEqual(p.value("[tactor.state.takes.length, tactor.state.drawing]"), [0, None])

    def test_a_page_that_plays_to_nobody_is_heard(self):
        p = self.open(self.serve(device=NULL))
        self.says(p, "Simulated")
        p.until("document.querySelectorAll('#examples li').length && document.querySelector('#hint-example').textContent === 'Hear where it moves'")
        p.frames()  # the array makes room for the hint
        p.frames()
        place = self.at(p, [20, 20])[0]
        p.mouse("mousePressed", *place)
        p.until("tactor.state.tapped === 4")
        p.mouse("mouseReleased", *place)
        p.until("tactor.state.tapped === -1")


class Method(Hands):
    def drawn(self, s, **more):
        p, watcher = self.ready(s, **more)
        self.draw(p, *self.way([5, 5], [35, 35]))
        watcher.await_end(self.next_stroke(watcher, "started"))  # it was felt
        self.planned(p)
        p.until("document.querySelector('[data-value=park2016]').getAttribute('aria-checked') === 'true'")
        self.watch_sent(p)
        return p, watcher

    @staticmethod
    def felt(p):
        """Waits until the held method sounds: the rounds of a short take begin and end quickly."""
        p.until("tactor.state.tried && tactor.state.playing && !tactor.state.playing.waits && tactor.state.dbfs.some(v => v !== null)")

    def unchanged(self, p, before):
        """The service is silent, and the page is as it was."""
        self.silent(p)
        p.until(f"!tactor.state.tried && !tactor.state.playing && !{HELD}")
        self.assertEqual(p.value(f"JSON.stringify([{TAKE}, tactor.state.loop])"), before)
        self.planned(p)
        self.assertEqual(p.value("[tactor.state.plan.continuous ?? false, document.querySelector('[data-value=park2016]').getAttribute('aria-checked')]"), [False, "true"])

    def test_the_take_is_felt_by_it_until_it_is_let_go(self):
        p, watcher = self.drawn(self.serve())
        before = p.value(f"JSON.stringify([{TAKE}, tactor.state.loop])")
        place = p.middle(CONTINUOUS)
        p.mouse("mousePressed", *place)
        numbers = [self.next_stroke(watcher, "started")]
        p.until("tactor.state.plan.continuous && tactor.state.dbfs.some(v => v !== null)")
        # Again and again.
        numbers += [self.next_stroke(watcher, "started") for _ in range(2)]
        p.mouse("mouseReleased", *place)
        watcher.await_end(numbers[-1])
        plays = p.value("sent.filter(m => m.method === 'play').map(m => [m.options.algorithm, m.held])")
        self.assertEqual({tuple(play) for play in plays}, {("continuous", True)})
        self.unchanged(p, before)
        # A tap chooses, and plays nothing.
        p.click(CONTINUOUS)
        p.until(f"{TAKE}.options.algorithm === 'continuous'")
        self.assertEqual(p.value("sent.filter(m => m.method === 'play').length"), len(plays))

    def test_phantoms_are_held_too(self):
        p, watcher = self.drawn(self.serve())
        p.click("[aria-label='More phantoms']")
        p.until("document.querySelector('[data-value=linear]').checkVisibility()")
        p.value("document.querySelector('[data-value=linear]').scrollIntoView()")
        place = p.middle("[data-value=linear]")
        p.mouse("mousePressed", *place)
        number = self.next_stroke(watcher, "started")
        p.mouse("mouseReleased", *place)
        watcher.await_end(number)
        self.assertEqual(p.value("sent.find(m => m.method === 'play').options.phantom"), "linear")

    def test_keys_hold_it(self):
        p, _ = self.drawn(self.serve())
        before = p.value(f"JSON.stringify([{TAKE}, tactor.state.loop])")
        for key, code in (("Enter", "Enter"), (" ", "Space")):
            self.silent(p)
            p.value(f"document.querySelector({quoted(CONTINUOUS)}).focus()")
            self.key_down(p, key, code)
            self.felt(p)
            self.key_down(p, key, code, repeat=True)
            self.key_up(p, key, code)
            self.unchanged(p, before)
        p.key("Enter")
        p.until(f"{TAKE}.options.algorithm === 'continuous'")

    def test_it_ends_with_the_touch_with_escape_and_where_the_page_is_left(self):
        p, _ = self.drawn(self.serve(), fingers=True)
        before = p.value(f"JSON.stringify([{TAKE}, tactor.state.loop])")
        place = p.middle(CONTINUOUS)
        ends = {"escape": lambda: p.key("Escape"), "cancel": lambda: p.touch("touchCancel"),
                "leave": lambda: self.page("about:blank").call("Page.bringToFront"), "stop": lambda: p.key("KeyX", "x")}
        for name, end in ends.items():
            with self.subTest(end=name):
                if name == "cancel":
                    p.touch("touchStart", (0, *place))
                else:
                    p.mouse("mousePressed", *place)
                self.felt(p)
                end()
                self.silent(p)
                p.call("Page.bringToFront")
                if name != "cancel":
                    p.mouse("mouseReleased", *place)
                self.unchanged(p, before)

    def test_the_service_ends_it_with_the_connection(self):
        s = self.serve()
        p, watcher = self.ready(s)
        self.choose_files(p, {"long.toml": LONG})
        self.planned(p)
        p.mouse("mousePressed", *p.middle(CONTINUOUS))
        number = self.next_stroke(watcher, "started")
        p.reload()
        self.assertEqual(watcher.await_end(number)["state"], "cancelled")

    def test_the_page_ends_it_where_it_loses_the_connection(self):
        s = self.serve()
        p, watcher = self.drawn(s)
        place = p.middle(CONTINUOUS)
        p.mouse("mousePressed", *place)
        self.next_stroke(watcher, "started")
        s.kill()
        self.says(p, "No connection")
        p.until(f"!tactor.state.tried && !tactor.state.playing && !{HELD}")
        p.mouse("mouseReleased", *place)
        p.frames()
        self.assertEqual(p.value(f"{TAKE}.options.algorithm ?? 'park2016'"), "park2016")


if __name__ == "__main__":
    main()
