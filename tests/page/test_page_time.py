# SPDX-License-Identifier: MIT
"""The studio's timeline in a real Chromium: what plays from when until when, what is felt and copied. Usage: test_page_time.py TOOL SOURCE_ROOT"""
import math
import sys

del sys.argv[3:]
from studio import PHONE, TAKE, StudioTest  # noqa: E402
from harness import main  # noqa: E402

ALT, CONTROL, SHIFT = 1, 2, 8
RULER, CLIPS, LANES = 10, 43, 90  # px below the top of the timeline


class Time(StudioTest):
    def drawn(self, **more):
        """Returns a page with a take of one stroke of a second, and a client that watches what plays."""
        p, watcher = self.ready(self.serve(), **more)
        p.key("KeyF", "f")
        p.until("!tactor.state.feel")
        self.draw(p, *self.way([4, 20], [36, 20]))
        p.value("document.querySelector('#tab-timing').click()")
        self.set_slider(p, "Duration", 1000 * math.log(1 / 0.06) / math.log(599.9 / 0.06))
        self.planned(p)
        self.watch_sent(p)
        return p, watcher

    def at_time(self, p, t, y):
        """Returns a moment of the timeline as a pixel of the page."""
        return p.value(f"""(r => [r.x + 64 + ({t} - tactor.lanes.from) / (tactor.lanes.span ?? 1.02 * Math.max(tactor.state.plan.total_s,
            ...{TAKE}.strokes.map(s => s.start_s + s.timed.at(-1)[0]))) * (r.width - 122), r.y + {y}])(document.querySelector('#lanes').getBoundingClientRect())""")

    def drag(self, p, start, end, y, up=True):
        (ax, ay), (bx, by) = self.at_time(p, start, y), self.at_time(p, end, y)
        p.mouse("mousePressed", ax, ay)
        p.move_to(*((ax + (bx - ax) * k / 8, ay + (by - ay) * k / 8) for k in range(1, 9)))
        if up:
            p.mouse("mouseReleased", bx, by)

    def started(self, watcher):
        m = watcher.notification(lambda m: m["method"] == "stroke" and m["params"]["state"] == "started")
        return m["params"]["started_s"]

    def test_a_stroke_that_starts_later_is_silent_until_then(self):
        p, watcher = self.drawn()
        p.value("document.querySelector('#clips button').focus()")
        for _ in range(12):
            p.key("ArrowRight")
        p.until(f"{TAKE}.strokes[0].start_s === 1.2")
        self.planned(p)
        self.assertAlmostEqual(p.value("tactor.state.plan.onsets[0]"), 1.2, places=3)
        clock = watcher.ok("hello")["clock"]["monotonic_s"]
        p.key("KeyP", "p")
        self.assertGreater(self.started(watcher) - clock, 1.2)
        # The moment goes on in the silence, too, and is at the first burst when that sounds.
        p.until("tactor.state.at_s > 0.2 && tactor.state.at_s < 1.1 && tactor.state.dbfs.every(v => v === null)")
        self.assertGreater(p.until("tactor.state.dbfs.some(v => v !== null) && tactor.state.at_s"), 1.1)
        p.click("#stop")

    def test_a_clip_follows_the_pointer_while_its_drag_makes_the_take_shorter_or_longer(self):
        p, _ = self.drawn()
        clip = f"{TAKE}.strokes[0].timed.at(-1)[0] + ' ' + {TAKE}.strokes[0].start_s"
        # Held 4 px within its end, start and middle: no jump, and each step of the pointer is one of the clip.
        for grasp, by_s, wanted in ((-4, -0.5, lambda s: (length + s, start)), (4, 0.2, lambda s: (length - s, start + s)), (40, 0.7, lambda s: (length, start + s))):
            self.planned(p)
            p.frames()
            length, start = map(float, p.value(clip).split())
            (x, y), (one, _) = self.at_time(p, start + length if grasp < 0 else start, CLIPS), self.at_time(p, start + 1, CLIPS)
            px_s = one - self.at_time(p, start, CLIPS)[0]
            p.mouse("mousePressed", x + grasp, y)
            for step in range(1, 11):
                # With Alt it does not snap.
                p.call("Input.dispatchMouseEvent", type="mouseMoved", x=x + grasp + by_s * px_s * step / 10, y=y, button="left", buttons=1, modifiers=ALT)
                p.frames()
                self.planned(p)
                for is_now, ought in zip(map(float, p.value(clip).split()), wanted(by_s * step / 10)):
                    self.assertAlmostEqual(is_now, ought, delta=2 / px_s)
            p.mouse("mouseReleased", x + grasp + by_s * px_s, y)
        # The whole is shown again.
        p.until("!tactor.lanes.held_s")

    def test_the_curve_that_is_touched_has_points(self):
        p, _ = self.drawn()
        x, y, w, h = p.value("(r => [r.x, r.y, r.width, r.height])(document.querySelector('#lanes').getBoundingClientRect())")
        self.assertEqual(p.value("tactor.state.curve"), "")
        speed = p.value("tactor.curve_points(tactor.lanes).find(q => q.kind === 'speed' && q.index === 2)")
        strength = p.value("tactor.curve_points(tactor.lanes).find(q => q.kind === 'strength' && q.index === 0)")
        for point in (strength, speed, strength):
            p.call("Input.dispatchMouseEvent", type="mouseMoved", x=x + point["x"], y=y + point["y"])
            p.until(f"tactor.state.curve === '{point['kind']}'")
        p.call("Input.dispatchMouseEvent", type="mouseMoved", x=x + w / 2, y=y + h / 2)
        p.until("tactor.state.curve === ''")
        # A slider of the settings touches its curve, too.
        p.click("#tab-timing")
        p.click("#pane .more summary")
        for i, kind in ((0, "speed"), (5, "strength")):
            p.click(f"#pane .more .slider:nth-of-type({i + 1}) input" if kind == "speed" else "#pane .more div .slider input")
            p.until(f"tactor.state.curve === '{kind}'")

    def test_a_point_of_the_strength_is_chosen_where_it_is_and_keeps_its_distance(self):
        p, _ = self.drawn()
        rows, h = self.take(p)["strokes"][0]["timed"], p.until("tactor.lanes.curves && tactor.lanes.height")
        (t, u), (v, w) = next((a[:2], b[:2]) for a, b in zip(rows, rows[1:]) if a[1] <= 20 <= b[1])  # half of its way
        x, _ = self.at_time(p, t + (v - t) * (20 - u) / (w - u), 0)
        top, bottom = h - 58, h - 8  # the middle point is at the full strength: 12 px below the top
        y = self.at_time(p, 0, top + 12)[1] + 6
        before = p.value(f"JSON.stringify({TAKE})")
        p.mouse("mousePressed", x, y)
        p.move_to((x + 1, y + 1))
        p.mouse("mouseReleased", x + 1, y + 1)
        p.frames()
        self.assertEqual(p.value(f"JSON.stringify({TAKE})"), before)
        p.mouse("mousePressed", x, y)
        p.move_to((x, y + 10), (x, y + 19))
        p.mouse("mouseReleased", x, y + 19)
        p.until(f"{TAKE}.strokes[0].strength?.length === 3")
        self.assertAlmostEqual(p.value(f"{TAKE}.strokes[0].strength[1][1]"), 1 - 19 / (bottom - top - 12), delta=0.02)

    def test_a_range_is_dragged_played_looped_and_cleared(self):
        p, watcher = self.drawn()
        self.drag(p, 0.45, 0.2, RULER)
        low, high = p.until("tactor.state.marks.range")
        self.assertAlmostEqual(low, 0.2, delta=0.02)
        self.assertAlmostEqual(high, 0.45, delta=0.02)
        p.key("KeyP", "p")
        first = self.started(watcher)
        request = p.value("sent.findLast(m => m.method === 'play').toml")
        self.assertIn("start_s = 0\n", request)
        self.assertAlmostEqual(float(request.split("[")[-1].split(",")[0]), high - low, places=2)
        p.until("!tactor.state.playing")
        p.key("KeyL", "l")
        p.key("KeyP", "p")
        self.assertGreater(self.started(watcher), first)
        total = p.value("tactor.state.playing.total_s")
        self.assertGreaterEqual(total, high - low)
        self.assertLess(total, high - low + 0.08)  # the last burst
        for _ in range(3):
            p.until(f"tactor.state.at_s > {low + 0.6 * total}")
            p.until(f"tactor.state.at_s < {low + 0.4 * total}")
        self.assertLessEqual(p.value("sent.findLast(m => m.method === 'play').round_s"), total)
        self.assertTrue(low <= p.value("tactor.state.at_s") <= low + total)
        p.click("#stop")
        # A range beyond the end of a take that was cut plays all of it, and is there again where the cut is taken back.
        p.value("tactor.state.marks.range = [2.5, 2.8], tactor.changed('curves')")
        p.key("KeyL", "l")
        p.key("KeyP", "p")
        self.started(watcher)
        p.until("tactor.state.playing && tactor.state.playing.from_s === 0")
        p.click("#stop")
        p.value(f"tactor.state.marks.range = [{low}, {high}], tactor.changed('curves')")
        # An end is pulled; two taps clear it.
        (x, y), (end, _) = self.at_time(p, high, RULER), self.at_time(p, 0.8, RULER)
        p.mouse("mousePressed", x + 6, y)  # it keeps its distance from the pointer
        p.move_to((x + 20, y), (end + 6, y))
        p.mouse("mouseReleased", end + 6, y)
        p.until("Math.abs(tactor.state.marks.range[1] - 0.8) < 0.01")
        self.assertAlmostEqual(p.value("tactor.state.marks.range[0]"), low, places=3)
        for _ in range(2):
            p.tap(*self.at_time(p, 0.6, RULER))
        p.until("!tactor.state.marks.range && !tactor.state.marks.start_s")

    def test_play_begins_at_the_start_that_is_tapped(self):
        p, watcher = self.drawn()
        p.tap(*self.at_time(p, 0.5, RULER))
        start = p.until("tactor.state.marks.start_s")
        self.assertAlmostEqual(start, 0.5, delta=0.02)
        p.key("KeyP", "p")
        self.started(watcher)
        self.assertGreaterEqual(p.value("tactor.state.at_s"), start)
        self.assertAlmostEqual(p.value("tactor.state.playing.total_s"), 1.06 - start, delta=0.08)
        p.until("!tactor.state.playing")
        p.key("Home", modifiers=SHIFT)
        p.until("!tactor.state.marks.start_s")
        # By the keyboard: the start, and a range from there.
        p.value("document.querySelector('#lanes').focus()")
        p.key("Home")
        p.key("ArrowRight")
        p.key("Enter")
        p.until("tactor.state.marks.start_s > 0")
        p.key("End")
        p.key("Enter", modifiers=SHIFT)
        p.until("tactor.state.marks.range?.[1] > 1")

    def test_the_moment_that_is_dragged_is_felt_and_rests_in_silence(self):
        p, watcher = self.drawn()
        self.drag(p, 0.3, 0.5, LANES, up=False)
        number = self.next_stroke(watcher, "started")
        place = p.until("sent.find(m => m.method === 'to')")
        self.assertAlmostEqual(place["y_mm"], 20, delta=1)
        # It rests, the mouse still down.
        watcher.await_end(number)
        (x, y) = self.at_time(p, 0.9, LANES)
        p.move_to((x, y))
        number = self.next_stroke(watcher, "started")
        p.mouse("mouseReleased", x, y)
        watcher.await_end(number)
        times = p.value("sent.filter(m => m.method === 'to').map(m => m.ms)")
        self.assertLessEqual(len(times), 3 + (times[-1] - times[0]) / 50)
        # Stop ends it until the next drag; J makes it silent.
        self.drag(p, 0.3, 0.5, LANES, up=False)
        number = self.next_stroke(watcher, "started")
        p.key("Space", " ")
        watcher.await_end(number)
        begun = "sent.filter(m => m.method === 'begin').length"
        before = p.value(begun)
        p.move_to(*(self.at_time(p, t, LANES) for t in (0.6, 0.7, 0.8)))
        p.mouse("mouseReleased", *self.at_time(p, 0.8, LANES))
        p.key("KeyJ", "j")
        p.until("document.querySelector('#scrub').getAttribute('aria-pressed') === 'false'")
        self.drag(p, 0.8, 0.2, LANES)
        p.until("Math.abs(tactor.state.at_s - 0.2) < 0.02")
        self.assertEqual(p.value(begun), before)

    def test_moments_and_clips_snap_but_with_alt(self):
        p, _ = self.drawn()
        onset = p.value("tactor.state.plan.onsets[5]")
        x, y = self.at_time(p, onset, LANES)
        for modifiers, test in ((0, "==="), (ALT, "!==")):
            self.drag(p, 0.1, 0.2, LANES, up=False)
            p.call("Input.dispatchMouseEvent", type="mouseMoved", x=x + 4, y=y, button="left", buttons=1, modifiers=modifiers)
            p.until(f"Math.abs(tactor.state.at_s - {onset}) < 0.03 && tactor.state.at_s {test} {onset}")
            p.mouse("mouseReleased", x, y)

    def test_clips_are_copied_and_repeated(self):
        p, _ = self.drawn()
        p.value(f"tactor.rename(tactor.state.current, 'Slow S')")
        p.key("KeyD", "d", modifiers=CONTROL)
        names = f"{TAKE}.strokes.map(s => s.name).join()"
        p.until(f"{names} === 'Slow S,Slow S 2'")
        self.assertAlmostEqual(p.value(f"{TAKE}.strokes[1].start_s - {TAKE}.strokes[0].timed.at(-1)[0]"), 0.1, places=3)
        p.click("#undo")
        p.until(f"{TAKE}.strokes.length === 1")
        self.planned(p)
        # Alt drag.
        x, y = self.at_time(p, 0.5, CLIPS)
        for kind, dx in (("mousePressed", 0), ("mouseMoved", 20), ("mouseMoved", 40), ("mouseReleased", 40)):
            p.call("Input.dispatchMouseEvent", type=kind, x=x + dx, y=y, button="left", buttons=int(kind != "mouseReleased"), modifiers=ALT, clickCount=1)
        p.until(f"{names} === 'Slow S,Slow S 2'")
        self.assertEqual(p.value(f"{TAKE}.strokes[0].start_s"), 0)
        self.assertGreater(p.value(f"{TAKE}.strokes[1].start_s"), 0.03)
        p.click("#undo")
        p.until(f"{TAKE}.strokes.length === 1")
        self.planned(p)
        # Its end is pulled on: three times, then twice, in one step of undo.
        x, y = self.at_time(p, 1, CLIPS)
        p.mouse("mousePressed", x - 3, y)
        p.move_to((x + 20, y), (x + 60, y))
        p.until(f"{names} === 'Slow S,Slow S 2,Slow S 3'")
        self.toast(p, "“Slow S” × 3")
        p.move_to((x + 35, y))
        p.until(f"{names} === 'Slow S,Slow S 2'")
        p.mouse("mouseReleased", x + 35, y)
        p.click("#undo")
        p.until(f"{TAKE}.strokes.length === 1 && {TAKE}.name === 'Slow S'")

    def test_ends_of_a_range_are_wide_for_fingers(self):
        p, _ = self.drawn(fingers=True)
        self.drag(p, 0.2, 0.5, RULER)
        p.until("tactor.state.marks.range")
        x, y = self.at_time(p, 0.5, 35)
        p.touch("touchStart", (0, x + 20, y))
        for dx in (40, 60, 80):
            p.touch("touchMove", (0, x + dx, y))
        p.touch("touchEnd")
        p.until("tactor.state.marks.range[1] > 0.52")


if __name__ == "__main__":
    main()
