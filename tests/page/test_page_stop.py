# SPDX-License-Identifier: MIT
"""Stop under any hand, and Play that never adds up, in a real Chromium. Usage: test_page_stop.py TOOL SOURCE_ROOT"""
import os
import signal
import sys

del sys.argv[3:]
from studio import LONG, TAKE, StudioTest  # noqa: E402
from harness import main  # noqa: E402

MOST_MS = 20.0  # from the touch, once the page has it, to the message
STOPS = "sent.filter(m => m.method === 'stop').length"
SOUNDING = "(tactor.state.status?.strokes ?? []).filter(s => s.state === 'started').length"


class Stop(StudioTest):
    def begin(self, fingers=True):
        """Returns a page of a touched screen, a client that watches, and a long stroke that sounds."""
        s = self.serve()
        p, watcher = self.ready(s, fingers=fingers)
        number = s.client().ok("play", toml=LONG)["stroke"]
        watcher.stroke(number, "started")
        self.watch_sent(p)
        p.value('addEventListener("pointerdown", () => { globalThis.touched = performance.now(); }, {capture: true})')
        return p, watcher, number

    def stopped(self, p, watcher, number):
        self.assertEqual(watcher.await_end(number)["state"], "cancelled")
        self.assertLess(p.value("sent.find(m => m.method === 'stop').ms - touched"), MOST_MS)

    def test_it_stops_while_a_finger_rests_on_the_array(self):
        p, watcher, number = self.begin()
        [finger] = self.at(p, [10, 10])
        p.touch("touchStart", (0, *finger))
        p.touch("touchStart", (0, *finger), (1, *p.middle("#stop")))
        self.stopped(p, watcher, number)

    def test_it_stops_though_the_finger_slides_away(self):
        p, watcher, number = self.begin()
        x, y = p.middle("#stop")
        p.touch("touchStart", (0, x, y))
        for step in range(1, 8):
            p.touch("touchMove", (0, x - 20 * step, y + 30 * step))
        p.touch("touchEnd")
        self.stopped(p, watcher, number)
        self.assertEqual(p.value(STOPS), 1)

    def test_it_stops_before_the_finger_is_lifted(self):
        p, watcher, number = self.begin()
        p.touch("touchStart", (0, *p.middle("#stop")))
        self.stopped(p, watcher, number)
        p.until("document.querySelector('#stop').dataset.state === 'done'")
        p.touch("touchEnd")
        p.until("document.querySelector('#stop').textContent.startsWith('Stop') && !document.querySelector('#stop').dataset.state")
        self.assertEqual(p.value(STOPS), 1)

    def test_media_keys_stop(self):
        s = self.serve()
        p = self.open(s)
        p.call("Page.addScriptToEvaluateOnNewDocument", source="globalThis.media_keys = {}; "
               "MediaSession.prototype.setActionHandler = (key, f) => { media_keys[key] = f; }")
        self.reload(p)
        c = s.client()
        for key in ("pause", "stop"):
            number = c.ok("play", toml=LONG)["stroke"]
            c.stroke(number, "started")
            p.value(f"media_keys.{key}({{action: '{key}'}})")
            self.assertEqual(c.await_end(number)["state"], "cancelled")

    def test_escape_stops_where_nothing_is_open(self):
        p, watcher, number = self.begin(fingers=False)
        p.open_popover("#device", "#p-device")
        p.key("Escape")
        p.until("!document.querySelector(':popover-open')")
        self.assertEqual(p.value(STOPS), 0)
        p.key("Escape")
        self.assertEqual(watcher.await_end(number)["state"], "cancelled")

    def test_no_answer_names_the_switch_and_is_sent_again(self):
        s = self.serve()
        p, watcher = self.ready(s)
        number = s.client().ok("play", toml=LONG)["stroke"]
        watcher.stroke(number, "started")
        self.watch_sent(p)
        os.kill(s.process.pid, signal.SIGSTOP)
        p.click("#stop")
        self.banner(p, "Switch the amplifier off")
        p.until("document.querySelector('#stop').textContent.startsWith('Stop again')")
        p.until(STOPS + " > 2")
        self.says(p, "No answer")
        self.assertNotEqual(p.value("document.querySelector('#toast').textContent"), "Stopped everybody's strokes")
        os.kill(s.process.pid, signal.SIGCONT)
        self.assertEqual(watcher.await_end(number)["state"], "cancelled")
        self.toast(p, "Stopped everybody's strokes")
        p.until("document.querySelector('#banner').hidden && !document.querySelector('#stop').dataset.state")

    def test_a_stop_that_is_not_sent_says_so_and_is_sent_once_it_can_be(self):
        s = self.serve()
        p, _ = self.ready(s)
        s.kill()
        self.says(p, "No connection")
        p.click("#stop")
        self.banner(p, "Stop is not sent: there is no connection to tactor. Switch the amplifier off.")
        p.until("document.querySelector('#stop').textContent.startsWith('Stop againnot sent, ')")
        self.watch_sent(p)
        self.restart(s)
        p.until(STOPS + " > 0")
        p.until("!tactor.state.stopping && document.querySelector('#banner').hidden")


class Play(StudioTest):
    def play(self, p, watcher):
        """Plays the take; returns the number of its stroke."""
        p.key("KeyP", "p")
        return self.next_stroke(watcher, "started")

    def loop(self, p, watcher):
        """Plays the take again and again; returns the number of its first stroke."""
        self.planned(p)
        p.key("KeyL", "l")
        return self.play(p, watcher)

    def test_playing_again_begins_anew(self):
        p, watcher = self.ready(self.serve())
        self.add_example(p)
        self.planned(p)
        p.key("KeyL", "l")
        numbers = [self.play(p, watcher) for _ in range(4)]
        self.assertEqual([watcher.await_end(n)["state"] for n in numbers[:3]], ["cancelled"] * 3)
        p.until(f"{SOUNDING} === 1")
        # A key that is held does it once.
        for _ in range(10):
            p.call("Input.dispatchKeyEvent", type="rawKeyDown", code="KeyP", key="p", autoRepeat=True)
        p.until("tactor.state.playing && !tactor.state.playing.waits")
        self.assertEqual(p.value("tactor.state.playing.numbers.has(%d)" % numbers[3]), True)
        p.click("#stop")

    def test_strokes_that_meet_play_weaker_and_leave_gain_and_level(self):
        p, watcher = self.ready(self.serve(), fingers=True)
        self.draw_rows(p, (5, 7, 9))
        p.touch("touchEnd")
        p.until(f"({TAKE})?.strokes.length === 3 && !tactor.state.drawing")
        p.until("document.querySelector('#warnings').textContent.includes('dB weaker') && tactor.state.plan.weakened_db < -6")
        p.click("#play")
        self.next_stroke(watcher, "started")
        self.assertFalse(p.value(f"{TAKE}.gain_db"))
        self.assertEqual(p.value("tactor.state.level_db"), 0)

    def test_what_plays_follows_the_level(self):
        p, watcher = self.ready(self.serve())
        self.add_example(p)
        number = self.loop(p, watcher)
        loudest = "Math.max(...tactor.state.dbfs.filter(v => v !== null))"
        p.until(f"{loudest} > -30")
        for level_db, test in ((-40, f"{loudest} < -45"), (0, f"{loudest} > -30")):
            p.value(f"(tactor.state.level_db = {level_db}, tactor.changed('level'), 0)")
            p.until(test)
        self.assertIn(number, p.value("[...tactor.state.playing.numbers]"))
        p.click("#stop")
        # A page that is opened again is no louder than it was.
        p.value("(tactor.state.level_db = -40, tactor.changed('level'), 0)")
        self.reload(p)
        self.loop(p, watcher)
        p.until(f"{loudest} > -80")
        self.assertLess(p.value(loudest), -45)

    def test_the_level_is_a_fader_on_a_scale_of_dbfs(self):
        p, watcher = self.ready(self.serve(config="[serve]\nmax_level_dbfs = -20\n"))
        x, y, w, h = p.value("(r => [r.x, r.y, r.width, r.height])(document.querySelector('.groove').getBoundingClientRect())")
        # From 30 dB below the ceiling, and a place of silence, to 6 dB above it.
        at = lambda dbfs: x + w * (dbfs + 50.5) / 36.5  # noqa: E731
        ticks = p.value("[...document.querySelectorAll('.ticks > *')].map(t => (r => [t.textContent, r.x + r.width / 2])(t.getBoundingClientRect()))")
        self.assertEqual([text for text, _ in ticks], ["−50 dBFS", "−40", "−30", "ceiling −20"])
        for (_, place), dbfs in zip(ticks, (-50, -40, -30, -20)):
            self.assertAlmostEqual(place, at(dbfs), delta=1)
        text = "document.querySelector('#level output').textContent"
        self.assertEqual(p.value(text), "100 % −20 dBFS")
        # A tap lowers at once, and raises by 3 dB; a drag goes where it leads, and beyond the ceiling nowhere.
        p.tap(at(-40), y + h / 2)
        p.until("tactor.state.level_db === -20")
        self.assertEqual(p.value(text), "10 % −40 dBFS")
        p.tap(at(-22), y + h / 2)
        p.until("tactor.state.level_db === -17")
        p.mouse("mousePressed", at(-37), y + h / 2)
        p.move_to((at(-30), y + h / 2), (at(-10), y + h / 2))
        p.mouse("mouseReleased", at(-10), y + h / 2)
        p.until("tactor.state.level_db === 0")
        for key, db in (("ArrowLeft", -1), ("PageDown", -7), ("ArrowRight", -6), ("End", 0), ("Home", -60)):
            p.key(key)
            p.until(f"tactor.state.level_db === {db}")
        self.assertEqual(p.value(text), "silent")
        # The fader shows the loudest tactor, which cannot pass the knob.
        self.add_example(p)
        p.key("End")
        self.loop(p, watcher)
        p.until("document.querySelector('.groove i').offsetWidth > 20")
        p.value("document.querySelector('#level input').focus()")
        for _ in range(2):
            p.key("PageDown")
        p.until("tactor.state.level_db === -12")
        p.until(f"(e => e.offsetWidth > 20 && e.offsetWidth <= {at(-32) - x + 2})(document.querySelector('.groove i'))")
        p.click("#stop")

    def test_a_touch_of_the_knob_binds_no_later_key(self):
        p, _ = self.ready(self.serve())
        p.value("(tactor.state.level_db = -20, tactor.changed('level'), 0)")
        p.until("document.querySelector('#level output').textContent.startsWith('10 %')")
        p.click("#level input")
        p.key("End")
        p.until("tactor.state.level_db === 0")

    def test_another_take_that_is_chosen_stands_still(self):
        p, watcher = self.ready(self.serve())
        self.draw(p, *self.way([5, 5], [35, 5]))
        first = p.value("tactor.state.current")
        self.add_example(p)
        self.loop(p, watcher)
        p.until("tactor.state.at_s > 0")
        p.value("document.querySelectorAll('#takes .take')[1].click()")
        p.until(f"tactor.state.current === {first!r} && tactor.state.plan_of === {TAKE}")
        p.until("performance.now() - tactor.state.playing.began_ms > 200")
        self.assertEqual(p.value("tactor.state.at_s"), 0)
        p.click("#stop")

    def test_a_take_that_plays_can_be_deleted(self):
        p, watcher = self.ready(self.serve())
        self.draw(p, *self.way([5, 5], [35, 5]))
        number = self.loop(p, watcher)
        p.value("document.querySelector('#takes .more-button').click(), [...document.querySelectorAll('#p-take button')].at(-1).click()")
        watcher.await_end(number)
        p.until("!tactor.state.playing")

    def test_a_loop_goes_on_while_its_page_does_nothing(self):
        s = self.serve()
        p, watcher = self.ready(s)
        self.add_example(p)
        p.value("document.querySelector('[data-value=continuous]').click()")
        number = self.loop(p, watcher)
        total_s = p.value("tactor.state.playing.total_s")
        asker = s.client()
        asker.ok("subscribe", events=["levels"], levels_hz=10)
        clock = asker.notification(lambda m: m["method"] == "levels")["params"]["t_s"]
        p.browser.send("Runtime.evaluate", p.session, expression=f"for (const end = performance.now() + {2500 * total_s}; performance.now() < end;);")
        t = clock
        while t < clock + 2.2 * total_s:
            levels = asker.notification(lambda m: m["method"] == "levels")["params"]
            t = levels["t_s"]
            self.assertTrue(any(v is not None for v in levels["dbfs"]), t - clock)
        # The page goes on where the round is, in a tab that is not shown, too.
        p.value("Object.defineProperty(document, 'hidden', {value: true}), requestAnimationFrame = () => 0")
        for _ in range(2):
            p.until(f"tactor.state.at_s > {0.6 * total_s}")
            p.until(f"tactor.state.at_s < {0.4 * total_s}")
        self.assertEqual(p.value("[...tactor.state.playing.numbers]"), [number])
        p.click("#stop")

    def test_what_is_changed_in_a_loop_comes_with_the_next_round(self):
        p, watcher = self.ready(self.serve())
        self.add_example(p)
        number = self.loop(p, watcher)
        self.watch_sent(p)
        p.value("document.querySelector('[data-value=continuous]').click()")
        changed = self.next_stroke(watcher, "started")
        self.assertEqual(watcher.await_end(number)["state"], "finished")
        p.until(f"tactor.state.playing.firsts[0] === {changed} && tactor.state.playing.numbers.size === 1")
        self.assertEqual(p.value("sent.filter(m => m.method === 'play').map(m => m.start.after)"), [[number]])
        # The end of a loop comes with its round.
        p.key("KeyL", "l")
        self.assertEqual(watcher.await_end(changed)["state"], "finished")
        p.until("!tactor.state.playing")
        self.assertEqual(p.value("sent.filter(m => m.method === 'end').length"), 1)

    def test_a_loop_that_is_switched_on_late_begins_without_a_gap(self):
        p, watcher = self.ready(self.serve())
        self.add_example(p)
        self.planned(p)
        number = self.play(p, watcher)
        p.key("KeyL", "l")
        begun = self.next_stroke(watcher, "started")
        self.assertEqual(watcher.await_end(number)["state"], "finished")
        p.until(f"tactor.state.playing.repeats && tactor.state.playing.firsts[0] === {begun}")
        p.click("#stop")

    def test_a_palm_that_the_system_cancels_leaves_nothing(self):
        p, _ = self.ready(self.serve(), fingers=True)
        f = "document.querySelector('#field')"
        p.value(f"""(({f}).setPointerCapture = () => 0, globalThis.touch = (kind, id, type, x, y) => {f}.dispatchEvent(new PointerEvent(kind,
            {{pointerId: id, pointerType: type, clientX: x, clientY: y, bubbles: true, isPrimary: id === 1, pressure: 0.5}})), 0)""")
        (ax, ay), (bx, by), (cx, cy) = self.at(p, [10, 10], [20, 20], [30, 30])
        # Two fingers, of which the system cancels one.
        p.value(f"touch('pointerdown', 1, 'touch', {ax}, {ay}), touch('pointerdown', 2, 'touch', {cx}, {cy})")
        for kind, x, y in (("pointermove", bx, by), ("pointerrawupdate", bx, by + 3)):
            p.value(f"touch('{kind}', 1, 'touch', {x}, {y}), touch('{kind}', 2, 'touch', {ax}, {y})")
        p.until("tactor.state.drawing?.tracks.length === 2")
        p.value("touch('pointercancel', 2, 'touch', 0, 0)")
        p.until("tactor.state.drawing?.tracks.length === 1")
        p.value(f"touch('pointerup', 1, 'touch', {bx}, {by})")
        p.until(f"({TAKE})?.strokes.length === 1")
        # While a pen draws touches do not.
        p.value(f"touch('pointerdown', 3, 'pen', {ax}, {ay}), touch('pointermove', 3, 'pen', {bx}, {by}), touch('pointerdown', 4, 'touch', {cx}, {cy})")
        p.value(f"touch('pointerrawupdate', 3, 'pen', {bx}, {by + 4}), touch('pointermove', 4, 'touch', {ax}, {ay}), touch('pointerrawupdate', 4, 'touch', {ax}, {ay})")
        p.until("tactor.state.drawing")
        self.assertEqual(p.value("tactor.state.drawing.tracks.length"), 1)
        p.value(f"touch('pointerup', 3, 'pen', {bx}, {by})")
        p.until("tactor.state.takes.length === 2 && !tactor.state.drawing")


if __name__ == "__main__":
    main()
