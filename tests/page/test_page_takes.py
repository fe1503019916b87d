# SPDX-License-Identifier: MIT
"""The studio's takes in a real Chromium: edited, kept, named, undone, set, by the thousand. Usage: test_page_takes.py TOOL SOURCE_ROOT"""
import sys

del sys.argv[3:]
from studio import DESKTOP, PHONE, TAKE, StudioTest, quoted  # noqa: E402
from harness import main  # noqa: E402

# Takes put where the browser keeps them.
STORE = """new Promise((done, failed) => { const asked = indexedDB.open("tactor", 1);
    asked.onerror = failed; asked.onsuccess = () => { const t = asked.result.transaction("takes", "readwrite");
        for (let i = 0; i < %d; ++i) t.objectStore("takes").put({id: `t${i}`, made: i, name: `Take ${i}`, origin: "drawn", options: {}, strokes: [
            {name: "stroke 1", start_s: 0, timed: Array.from({length: 60}, (_, k) => [k / 50, 20 + 18 * Math.cos(k / 10 + i), 20 + 18 * Math.sin(k / 10 + i), 1])}]});
        t.oncomplete = () => { asked.result.close(); done(1); }; }; })"""


class Takes(StudioTest):
    def menu(self, p, number, word):
        """Chooses from the menu of one of the takes."""
        p.until("document.querySelectorAll('#takes li').length === tactor.state.takes.length")
        p.click(f"#takes li:nth-child({number}) .more-button")
        p.until("document.querySelector('#p-take').matches(':popover-open')")
        p.value(f"[...document.querySelectorAll('#p-take button')].find(b => b.textContent.includes({quoted(word)})).click()")

    def test_takes_are_named_duplicated_deleted_undone_and_outlast_the_page(self):
        p, _ = self.ready(self.serve())
        for y in (5, 20, 35):
            self.draw(p, *self.way([5, y], [35, y]))
        p.until("document.querySelectorAll('#takes li').length === 3")
        self.assertEqual(self.names(p), ["Take 3", "Take 2", "Take 1"])
        self.menu(p, 2, "Rename")
        p.until("document.querySelector('input.rename')")
        p.call("Input.insertText", text="Middle of the palm")
        p.key("Enter")
        p.until("[...document.querySelectorAll('#takes b')].some(b => b.textContent === 'Middle of the palm')")
        self.menu(p, 2, "Duplicate")
        p.until("document.querySelectorAll('#takes li').length === 4")
        self.menu(p, 1, "Delete")
        p.until("document.querySelectorAll('#takes li').length === 3")
        self.toast(p, "Deleted")
        after = ["Middle of the palm, copy", "Middle of the palm", "Take 1"]
        self.assertEqual(self.names(p), after)
        for _ in range(4):
            p.key("KeyZ", "z", modifiers=2)
        p.until("document.querySelectorAll('#takes li').length === 2")
        self.assertEqual(self.names(p), ["Take 2", "Take 1"])
        for _ in range(4):
            p.key("KeyZ", "z", modifiers=2 | 8)
        p.until("document.querySelectorAll('#takes li').length === 3 && document.querySelector('#redo').disabled")
        p.reload()
        self.await_service(p)
        p.until("document.querySelectorAll('#takes li').length === 3")
        self.assertEqual(self.names(p), after)

    def test_a_new_take_after_a_reload_has_a_name_of_its_own(self):
        p, _ = self.ready(self.serve())
        for y in (5, 20):
            self.draw(p, *self.way([5, y], [35, y]))
        self.menu(p, 2, "Delete")
        p.until("document.querySelectorAll('#takes li').length === 1")
        p.reload()
        self.await_service(p)
        self.draw(p, *self.way([5, 35], [35, 35]))
        p.until("document.querySelectorAll('#takes li').length === 2")
        self.assertEqual(len(set(self.names(p))), 2)

    def test_a_drawing_after_plus_follows_the_last_stroke(self):
        p, watcher = self.ready(self.serve())
        self.draw(p, *self.way([5, 5], [35, 5]))
        self.planned(p)
        end = self.take(p)["strokes"][0]["timed"][-1][0]
        # The plus stands right of the last clip.
        x, y, w = p.value("(r => [r.x, r.y, r.width])(document.querySelector('#lanes').getBoundingClientRect())")
        for step in range(int(w), 0, -8):
            p.mouse("mousePressed", x + step, y + 40)
            p.mouse("mouseReleased", x + step, y + 40)
            if p.value("tactor.state.append"):
                break
        self.assertTrue(p.value("tactor.state.append"))
        p.mouse("mouseReleased", *self.press(p, *self.way([5, 35], [35, 35])))
        p.until(f"{TAKE}.strokes.length === 2")
        self.assertAlmostEqual(self.take(p)["strokes"][1]["start_s"], end + 0.1, places=3)  # a pause for the last burst
        self.assertEqual(p.value("tactor.state.takes.length"), 1)

    def test_points_are_moved_made_corners_added_and_deleted(self):
        p, _ = self.ready(self.serve())
        self.draw(p, *self.way([4, 20], [36, 20]))
        knots = self.take(p)["strokes"][0]["knots"]
        self.edit_point(p, [knots[1]["x"], knots[1]["y"]], [knots[1]["x"], knots[1]["y"] - 8])
        p.until("!document.querySelector('#points').hidden")
        self.assertEqual(p.value("document.querySelector('#point-text').textContent"), f"Point 2 of {len(knots)}")
        p.click("#point-corner")
        p.until(f"{TAKE}.strokes[0].knots[1].corner")
        p.click("#point-bin")
        p.until(f"{TAKE}.strokes[0].knots.length === {len(knots) - 1}")
        # The keyboard does the same.
        p.value("document.querySelector('#field').focus()")
        place = self.take(p)["strokes"][0]["knots"][1]["x"]
        p.key("ArrowRight")
        p.until(f"{TAKE}.strokes[0].knots[1].x > {place}")
        p.key("Delete")
        p.until(f"{TAKE}.strokes[0].knots.length === {len(knots) - 2}")
        for _ in range(5):
            p.click("#undo")
        p.until(f"{TAKE}.strokes[0].knots.length === {len(knots)}")
        self.assertEqual(self.take(p)["strokes"][0]["knots"], knots)

    def test_the_longest_and_the_shortest_duration_can_be_played(self):
        p, _ = self.ready(self.serve())
        self.draw(p, *self.way([4, 20], [36, 20]))
        p.click("[data-tab=timing]")
        for place in (0, 1000):
            p.until("(globalThis.slider = [...document.querySelectorAll('#pane .slider')].find(s => s.textContent.startsWith('Duration'))?.querySelector('input'))")
            p.value(f"slider.value = {place}, slider.dispatchEvent(new Event('input')), slider.dispatchEvent(new Event('change'))")
            p.until(f"tactor.state.plan_of === {TAKE} || tactor.state.plan_fault")
            self.assertIsNone(p.value("tactor.state.plan_fault"))

    def test_settings_are_the_take_s_and_reach_the_plan(self):
        p, _ = self.ready(self.serve())
        self.draw(p, *self.way([4, 20], [36, 20]))
        self.planned(p)
        p.value("document.querySelector('#pane [data-value=continuous]').click()")
        p.until("tactor.state.plan?.continuous")
        p.click("[data-tab=vibration]")
        p.until("document.querySelector('#pane [data-value=square]')")
        p.value("document.querySelector('#pane [data-value=square]').click()")
        p.until(f"{TAKE}.options.waveform === 'square'")
        text = self.saved(p, "toml").read_text()
        self.assertIn("square", text)
        self.assertIn("continuous", text)
        # Another take of the same session begins with these; undo takes them back one by one.
        p.click("#undo")
        p.until(f"{TAKE}.options.waveform === undefined && {TAKE}.options.algorithm === 'continuous'")
        p.click("#undo")
        p.until(f"tactor.state.plan && !tactor.state.plan.continuous && {TAKE}.options.algorithm === undefined")

    def test_each_option_has_its_place_in_one_tab(self):
        p, _ = self.ready(self.serve())
        self.draw(p, *self.way([4, 20], [36, 20]))
        shown = {}
        for tab in ("method", "timing", "vibration"):
            p.click(f"[data-tab={tab}]")
            p.until(f"document.querySelector('#pane').getAttribute('aria-labelledby') === 'tab-{tab}'")
            shown[tab] = p.value("document.querySelector('#pane').textContent")
        for tab, words in (("method", ("Beyond the array", "Tactors of a point")), ("timing", ("Slope of the law", "Shortest burst")),
                           ("vibration", ("Amplitude modulation", "Seed of the noise", "Scale of strength"))):
            for word in words:
                self.assertEqual([t for t in shown if word in shown[t]], [tab], word)

    def test_what_is_left_outside_stays_left(self):
        p, _ = self.ready(self.serve())
        self.draw(p, *self.way([20, 20], [20, 50]))
        p.until("document.querySelector('#warnings').textContent.includes('outside the array')")
        self.mend(p, "Leave it")
        p.until("document.querySelector('#warnings').textContent === ''")
        p.reload()
        self.await_service(p)
        p.until(f"{TAKE}?.leaves_array && document.querySelector('#warnings').textContent === ''")

    def test_other_methods_are_predicted_beside_this_one(self):
        p, _ = self.ready(self.serve())
        p.click("#hint-example")
        p.until("[...document.querySelectorAll('#pane .error')].length > 5 && [...document.querySelectorAll('#pane .error')].every(e => /mm|not possible/.test(e.textContent))")

    def test_examples_have_names_for_people_and_play(self):
        p, watcher = self.ready(self.serve())
        self.assertEqual(p.value("[...document.querySelectorAll('#examples b')].map(b => b.textContent)"),
                         ["Half circle, left", "Half circle, right", "Three-quarter circle", "Three-quarter circle, mirrored", "Wave", "Round"])
        p.click("#hint-example")
        number = self.next_stroke(watcher, "started")
        self.assertEqual(self.next_stroke(watcher, "finished"), number)
        self.assertEqual(self.names(p), ["Half circle, left"])

    def test_a_loop_plays_round_after_round(self):
        p, watcher = self.ready(self.serve())
        self.draw(p, *self.way([5, 5], [35, 35]))
        self.planned(p)
        p.click("#loop")
        p.click("#play")
        rounds = [self.next_stroke(watcher, "started") for _ in range(3)]
        self.assertEqual(len(set(rounds)), 3)
        self.assertTrue(p.value("tactor.state.playing !== null"))
        p.click("#stop")
        p.until("!tactor.state.playing")

    def test_strokes_of_the_same_time_are_chosen_in_turn(self):
        p, _ = self.ready(self.serve(), fingers=True)
        self.fingers(p, "touchStart", [5, 5], [5, 20], [5, 35])
        self.fingers(p, "touchMove", [35, 5], [35, 20], [35, 35])
        p.touch("touchEnd")
        p.until("tactor.state.takes.length === 1")
        x, y = p.value("(r => [r.x + r.width / 2, r.y + 43])(document.querySelector('#lanes').getBoundingClientRect())")
        for wanted in (1, 2, 0):
            p.mouse("mousePressed", x, y)
            p.mouse("mouseReleased", x, y)
            p.until(f"tactor.state.stroke === {wanted}")

    def test_a_clip_is_trimmed_and_the_moment_is_looked_at(self):
        p, _ = self.ready(self.serve())
        p.click("#hint-example")
        p.until(f"tactor.state.takes.length && !tactor.state.playing && tactor.state.at_s > 1 && tactor.state.plan_of === {TAKE}")
        x, y, w = p.value("(r => [r.x, r.y, r.width])(document.querySelector('#lanes').getBoundingClientRect())")
        p.mouse("mousePressed", x + w / 2, y + 100)
        p.mouse("mouseReleased", x + w / 2, y + 100)
        p.until("tactor.state.at_s > 0.4 && tactor.state.at_s < 1.1")
        p.value("document.querySelector('#lanes').focus()")
        at = p.value("tactor.state.at_s")
        p.key("ArrowRight")
        p.until(f"tactor.state.at_s > {at}")
        p.key("Comma", ",")
        before = self.take(p)["strokes"][0]["timed"][-1][0]
        p.mouse("mousePressed", x + 60, y + 43)
        p.move_to((x + 90, y + 43), (x + 150, y + 43))
        p.mouse("mouseReleased", x + 150, y + 43)
        p.until(f"{TAKE}.strokes[0].timed.at(-1)[0] < {before} - 0.1")


class Many(StudioTest):
    def test_a_thousand_takes(self):
        self.check_thousand(size=DESKTOP)

    def test_a_thousand_takes_on_a_phone(self):
        self.check_thousand(size=PHONE, fingers=True)

    def check_thousand(self, **screen):
        p, _ = self.ready(self.serve(), **screen)
        p.value(STORE % 1000)
        p.reload()
        self.await_service(p)
        p.until("document.querySelectorAll('#takes li').length === 1000")
        loaded_ms = p.value("performance.now()")
        # Adding one, choosing one and taking it back: each in a few frames.
        before = p.value("tactor.state.takes.length")
        self.draw(p, *self.way([5, 5], [35, 35]))
        p.until(f"document.querySelectorAll('#takes li').length === {before + 1}")
        added_ms = p.value(f"""(async () => {{ const begin = performance.now();
            document.querySelector("#undo").click();
            while (document.querySelectorAll("#takes li").length !== {before}) await new Promise(requestAnimationFrame);
            const undone = performance.now();
            document.querySelector("#redo").click();
            while (document.querySelectorAll("#takes li").length !== {before + 1}) await new Promise(requestAnimationFrame);
            const redone = performance.now();
            document.querySelector("#takes li:nth-child(800) .take").click();
            while (!document.querySelector("#takes li:nth-child(800) .take").hasAttribute("aria-current")) await new Promise(requestAnimationFrame);
            return [undone - begin, redone - undone, performance.now() - redone].map(Math.round); }})()""")
        print(f"1000 takes{screen}: shown {loaded_ms / 1000:.2f} s after the start; undo, redo, choose: {added_ms} ms")
        self.assertLess(max(added_ms), 1000)


if __name__ == "__main__":
    main()
