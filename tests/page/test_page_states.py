# SPDX-License-Identifier: MIT
"""The studio's states in a real Chromium: what is said when something is missing, who else is there, and that nothing drawn is
lost. Usage: test_page_states.py TOOL SOURCE_ROOT"""
import os
import signal
import sys

del sys.argv[3:]
from studio import TAKE, LIVE, StudioTest, quoted  # noqa: E402
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
        p.click("#play")
        number = self.next_stroke(watcher, "started")
        self.assertEqual(watcher.await_end(number)["state"], "finished")

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
        self.toast(p, "No connection: switch the amplifier off")
        p.until("tactor.state.takes.length === 2")
        p.mouse("mouseReleased", *self.at(p, [35, 20])[0])
        p.click("#play")
        self.toast(p, "shown, not felt")
        p.until("tactor.state.at_s > 0 && !tactor.state.playing")
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
        self.assertTrue(p.until("document.querySelector('#banner').hidden"))
        self.assertEqual(p.value("[location.hash, tactor.state.takes.length]"), ["", 2])
        self.plays(p, again)


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
        self.why(p, "“A phone”")
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
        self.why(p, "by “A phone”")
        self.toast(p, "Stopped by “A phone”")
        p.until("!tactor.state.playing")

    def test_the_own_name_is_told_to_others_and_outlasts_a_lost_connection(self):
        s = self.serve()
        p, watcher = self.ready(s)
        p.until("!document.querySelector('#others').hidden")
        p.click("#others")
        p.until("document.querySelector('#own-name-text').checkVisibility()")
        p.value("document.querySelector('#own-name-text').focus()")
        p.call("Input.insertText", text="Ada's laptop")
        p.value("document.querySelector('#own-name-text').blur()")
        self.until(lambda: "Ada's laptop" in [w["name"] for w in watcher.ok("status")["who"]])
        self.restart(s)
        p.until("tactor.state.link === 'lost'")
        self.await_service(p)
        p.until("tactor.state.status.who.some(w => w.name === `Ada's laptop`)")


class Everywhere(StudioTest):
    """Zoom by fingers and keys, many tactors, labels, and all of it by the keyboard."""

    def many(self, columns, rows, pitch=8):
        return self.write("many.toml", '[array]\nname = "many"\n' + "".join(
            f"[[tactor]]\nx_mm = {pitch * (i % columns)}\ny_mm = {pitch * (i // columns)}\n" for i in range(columns * rows)))

    def test_two_fingers_on_the_ground_zoom_and_draw_nothing(self):
        p, _ = self.ready(self.serve(), size=(390, 844), fingers=True)
        scale = p.value("tactor.view.scale")
        p.touch("touchStart", (1, 120, 130), (2, 270, 130))
        for k in range(1, 6):
            p.touch("touchMove", (1, 120 - 15 * k, 130), (2, 270 + 15 * k, 130))
        p.touch("touchEnd")
        self.assertAlmostEqual(p.until(f"tactor.view.scale > {1.5 * scale} && tactor.view.scale") / scale, 2, delta=0.1)
        self.assertEqual(p.value("[tactor.state.takes.length, tactor.state.drawing]"), [0, None])
        p.open_popover("#more", "#p-more")
        p.click("#show-all")
        p.until(f"Math.abs(tactor.view.scale - {scale}) < 0.01")
        p.key("Minus", "-")
        p.until(f"tactor.view.scale < {0.8 * scale}")

    def test_two_fingers_and_keys_zoom_the_timeline(self):
        p, _ = self.ready(self.serve(), fingers=True)
        self.draw(p, *self.way([5, 5], [35, 35]))
        self.planned(p)
        x, y, w, h = p.value("(r => [r.x, r.y, r.width, r.height])(document.querySelector('#lanes').getBoundingClientRect())")
        y += 100
        p.touch("touchStart", (1, x + w / 2 - 50, y), (2, x + w / 2 + 50, y))
        p.touch("touchMove", (1, x + w / 2 - 100, y), (2, x + w / 2 + 100, y))
        p.touch("touchEnd")
        span = p.until("tactor.lanes.span")
        self.assertAlmostEqual(p.value("tactor.state.plan.total_s") * 1.02 / span, 2, delta=0.1)
        p.key("KeyZ", "z")
        p.until("tactor.lanes.span === null")
        p.key("BracketRight", "]")
        p.until("tactor.lanes.span")
        p.open_popover("#more", "#p-more")
        p.click("#show-all")
        p.until("tactor.lanes.span === null")

    def test_another_density_draws_again(self):
        p, _ = self.ready(self.serve())
        p.value("for (const e of document.querySelectorAll('#stage, .lanes')) e.style.cssText = 'position: fixed; width: 600px; height: 300px'")
        p.until("document.querySelector('#lanes').width === 600 && document.querySelector('#field').width === 600")
        # The emulated browser tells of another density only with another size; that of the canvases stays.
        for density in (2, 1):
            p.resize((1440 + density, 900), density)
            p.until(f"['field', 'lanes'].every(id => (c => Math.abs(c.width - c.clientWidth * {density}) < 2)(document.getElementById(id)))")

    def test_lanes_of_many_tactors(self):
        p, _ = self.ready(self.serve("--array", self.many(8, 8)))
        self.assertEqual(p.value("document.querySelectorAll('#strokes button:enabled').length"), 20)
        p.click("#hint-example")
        p.until("tactor.state.plan && !tactor.state.playing")
        lanes = p.value("tactor.lane_tactors()")
        first = p.value("""tactor.lane_tactors().map(k => tactor.state.plan.onsets.find((t, i) =>
            tactor.state.plan.amplitudes[i * tactor.state.plan.tactors + k] >= 0.004))""")
        self.assertTrue(2 < len(lanes) < 64, lanes)
        self.assertEqual(first, sorted(first))
        # The example is as large as the array, and none of it lies outside.
        xs = [q[1] for q in self.take(p)["strokes"][0]["timed"]] + [q[2] for q in self.take(p)["strokes"][0]["timed"]]
        self.assertTrue(max(xs) - min(xs) > 28 and min(xs) > -1 and max(xs) < 57, (min(xs), max(xs)))
        self.assertEqual(p.value("tactor.state.outside.length"), 0)
        # Lanes are high enough, and scroll.
        self.assertGreaterEqual(p.value("tactor.lane_height(tactor.lanes)"), 18)
        p.value("tactor.lanes.scroll = 1e6, tactor.changed('take')")
        p.until("tactor.lanes.scroll < 1e6 && tactor.lanes.scroll > 0")

    def test_labels_never_lie_on_each_other(self):
        p, _ = self.ready(self.serve())
        for way in ([[20, 20], [24, 20]], [[20, 40], [20, 20]], [[2, 2], [38, 38]]):
            self.draw(p, *self.way(*way))
            self.planned(p)
            for size in ((1440, 900), (390, 844), (960, 540)):
                p.resize(size)
                p.until(f"innerWidth === {size[0]} && (f => f.clientHeight === f.parentElement.clientHeight)(document.querySelector('#field'))")
                p.frames()
                boxes = p.value("tactor.label_boxes()")
                self.assertGreater(len(boxes), 9)
                r = p.value("0.215 * 20 * tactor.view.scale")
                left, top = p.value("(r => [r.x, r.y])(document.querySelector('#field').getBoundingClientRect())")
                discs = [(x - left, y - top) for x, y in self.at(p, *([20 * i, 20 * j] for i in range(3) for j in range(3)))]
                for i, a in enumerate(boxes):
                    for b in boxes[:i]:
                        self.assertFalse(a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3], (a, b))
                    for x, y in discs:
                        near = (min(a[2], max(a[0], x)), min(a[3], max(a[1], y)))
                        self.assertGreaterEqual(((near[0] - x) ** 2 + (near[1] - y) ** 2) ** 0.5, r - 0.01)
            p.resize((1440, 900))
            p.until("innerWidth === 1440 && document.querySelector('#field').clientWidth > 800")

    def test_an_empty_page_has_no_time(self):
        p, _ = self.ready(self.serve())
        self.assertEqual(p.value("document.querySelector('.clock').textContent"), "0.00 / 0.00 s")

    def test_near_and_far_are_relative_to_the_pitch(self):
        p, _ = self.ready(self.serve("--array", self.many(3, 3, 60)))
        self.draw(p, *self.way([10, 10], [110, 90]))
        self.planned(p)
        errors = p.until("tactor.state.plan.errors?.lag_s !== undefined && tactor.state.plan.errors")
        part = errors["rms_to_path_mm"] / 60
        word = "on" if part < 0.03 else "near" if part < 0.1 else "off"
        lag = f"late by {errors['lag_s'] * 1000:.0f} ms" if errors["lag_s"] else "on time"
        self.assertEqual(p.until("document.querySelector('#predicted .tile p').textContent"), f"{word} the path{lag}")
        tiles = p.value("[...document.querySelectorAll('#predicted .tile > div')].map(e => e.textContent)")
        self.assertEqual(tiles, [f"{errors['rms_to_path_mm']:.1f}mm", f"{errors['speed_cv']:.2f}CV"])
        even = "even" if errors["speed_cv"] < 0.25 else "slightly uneven" if errors["speed_cv"] < 0.5 else "uneven"
        self.assertEqual(p.value("document.querySelector('#predicted .tile:last-child p').textContent"), f"{even} speed")
        p.value("document.querySelector('#pane .more:has(#all-errors)').open = true")
        shown = p.value("document.querySelector('#all-errors').innerText")
        for figure in (f"{errors['rms_error_mm']:.1f} mm RMS, at most {errors['largest_error_mm']:.1f} mm",
                       f"{errors['along_rms_mm']:.1f} mm RMS, at most {errors['along_max_mm']:.1f} mm",
                       f"{errors['across_rms_mm']:.1f} mm RMS, at most {errors['across_max_mm']:.1f} mm"):
            self.assertIn(figure, shown)

    def test_points_by_the_keyboard(self):
        p, _ = self.ready(self.serve())
        self.draw(p, *self.way([5, 5], [35, 12]), *self.way([35, 12], [8, 30]))
        p.value("document.querySelector('#field').focus()")
        p.key("KeyE", "e")
        p.key("Tab")
        p.key("Tab")
        p.until("tactor.state.knot === 1")
        p.key("ArrowRight")
        p.key("ArrowDown", modifiers=8)
        p.until(f"{TAKE}.strokes[0].knots")
        x, y = p.value(f"(k => [k.x, k.y])({TAKE}.strokes[0].knots[1])")
        p.key("ArrowRight")
        p.key("ArrowDown", modifiers=8)
        p.until(f"Math.abs({TAKE}.strokes[0].knots[1].x - {x} - 0.5) < 0.002 && Math.abs({TAKE}.strokes[0].knots[1].y - {y} - 0.1) < 0.002")
        corner = p.value(f"Boolean({TAKE}.strokes[0].knots[1].corner)")
        p.key("Enter")
        p.until(f"Boolean({TAKE}.strokes[0].knots[1].corner) === {str(not corner).lower()}")
        p.key("Tab", modifiers=8)
        p.until("tactor.state.knot === 0")
        # Shift Tab before the first point leaves the canvas.
        p.key("Tab", modifiers=8)
        p.until("document.activeElement.id !== 'field'")

    def test_clips_by_the_keyboard(self):
        p, _ = self.ready(self.serve())
        self.draw(p, *self.way([5, 5], [35, 12]))
        p.until("document.querySelectorAll('#clips button').length === 2")
        p.value("document.querySelector('#clips button').focus()")
        p.key("ArrowRight")
        p.key("ArrowRight", modifiers=8)
        p.until(f"Math.abs({TAKE}.strokes[0].start_s - 0.11) < 1e-6")
        p.until("document.activeElement.getAttribute('aria-label').includes('starts at 0.11 s')")
        p.value("document.querySelector('#clips button:last-child').focus()")
        p.call("Input.dispatchKeyEvent", type="keyDown", code="Enter", key="Enter", text="\r")
        p.call("Input.dispatchKeyEvent", type="keyUp", code="Enter", key="Enter")
        p.until("tactor.state.append")

    def test_forced_colours_mark_what_is_chosen(self):
        p, _ = self.ready(self.serve())
        p.call("Emulation.setEmulatedMedia", features=[{"name": "forced-colors", "value": "active"}])
        p.until("matchMedia('(forced-colors: active)').matches")
        self.assertEqual(p.value("""(e => [getComputedStyle(e("#tab-method")).outlineWidth, getComputedStyle(e("#play")).borderTopWidth,
            getComputedStyle(e("#field")).forcedColorAdjust])(s => document.querySelector(s))"""), ["3px", "1px", "none"])

    def test_a_phone_that_lies_has_the_whole_menu(self):
        p, _ = self.ready(self.serve(), size=(844, 390), fingers=True)
        p.open_popover("#more", "#p-more")
        self.assertEqual(p.value("[...document.querySelectorAll('#p-more button')].map(b => b.textContent)"),
                         ["Share", "Place on the body", "Feel while scrubbing", "Show all", "Light or dark", "Keys and help"])
        p.click("#p-more [data-press=p-keys]")
        p.until("document.querySelector('#p-keys').matches(':popover-open') && !document.querySelector('#p-more').matches(':popover-open')")


if __name__ == "__main__":
    main()
