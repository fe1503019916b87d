# SPDX-License-Identifier: MIT
"""The studio in a real Chromium: drawing, feeling, playing and stopping, with mouse, fingers and keys.
Usage: test_page.py TOOL SOURCE_ROOT"""
import sys

del sys.argv[3:]
from studio import LONG, PHONE, TAKE, StudioTest  # noqa: E402
from harness import main  # noqa: E402

# Fields in which space is a character, and does not stop.
TEXTS = "input:is([type=text], [type=password], :not([type])):not([inputmode=decimal])"


class Drawing(StudioTest):
    def test_the_mouse_draws_and_the_drawing_plays_again(self):
        p, watcher = self.ready(self.serve())
        self.assertTrue(p.value("document.querySelector('#play').disabled"))
        last = self.press(p, [4, 4])
        p.move_to(*self.at(p, *self.way([4, 5], [36, 20])))
        first = self.next_stroke(watcher, "started")
        # It is felt, shown and predicted while it is drawn.
        p.until("tactor.state.drawing && tactor.state.dbfs.some(v => v !== null)")
        p.until("tactor.state.drawing && tactor.state.plan?.felt.length && document.querySelector('#predicted .tile')")
        p.move_to(*self.at(p, [50, 50]))  # beside the array
        p.mouse("mouseReleased", *last)
        self.assertEqual(self.next_stroke(watcher, "finished"), first)
        self.toast(p, "Kept as")
        self.planned(p)
        drawn = self.take(p)
        self.assertEqual(len(drawn["strokes"]), 1)
        self.assertGreater(len(drawn["strokes"][0]["timed"]), 5)
        p.click("#play")
        self.assertGreater(self.next_stroke(watcher, "started"), first)
        p.until("tactor.state.playing && tactor.state.at_s > 0 && document.querySelector('#play').textContent === 'Playing'")
        self.next_stroke(watcher, "finished")
        p.until("!tactor.state.playing && document.querySelector('#play').textContent === 'Play'")
        self.assertTrue(p.value("document.querySelector('#banner').hidden"))

    def test_each_finger_is_a_stroke_of_one_take(self):
        p, watcher = self.ready(self.serve(), size=PHONE, fingers=True)
        rows = (5, 20, 35)
        self.draw_rows(p, rows)
        all_three = {self.next_stroke(watcher, "started") for _ in rows}
        self.assertEqual(len(all_three), 3)
        p.touch("touchEnd")
        self.assertEqual({self.next_stroke(watcher, "finished") for _ in rows}, all_three)
        p.until("tactor.state.takes.length === 1")
        self.assertEqual([s["name"] for s in self.take(p)["strokes"]], ["finger 1", "finger 2", "finger 3"])
        # Strokes that meet would be louder than the level.
        p.until("document.querySelector('#warnings').textContent.includes('dB weaker') && tactor.state.plan.weakened_db < 0")
        p.click("#play")
        again = {self.next_stroke(watcher, "started") for _ in rows}
        self.assertEqual({self.next_stroke(watcher, "finished") for _ in rows}, again)
        self.assertFalse(again & all_three)

    def test_fingers_that_touch_in_turn_are_one_take_while_one_touches(self):
        p, watcher = self.ready(self.serve(), size=PHONE, fingers=True)
        self.fingers(p, "touchStart", [5, 5])
        self.fingers(p, "touchMove", [5, 10])
        self.next_stroke(watcher, "started")
        self.fingers(p, "touchStart", [5, 10], [35, 5])
        self.fingers(p, "touchMove", [5, 35], [35, 35])
        self.next_stroke(watcher, "started")
        p.touch("touchEnd")
        p.until("tactor.state.takes.length === 1")
        strokes = self.take(p)["strokes"]
        self.assertEqual(strokes[0]["start_s"], 0)
        self.assertGreater(strokes[1]["start_s"], 0)
        # The next drawing is a take of its own.
        self.draw(p, *self.way([10, 20], [30, 20]))
        self.assertEqual(p.value("tactor.state.takes.map(t => t.strokes.length)"), [1, 2])

    def test_more_fingers_than_are_felt_are_drawn_nevertheless(self):
        s = self.serve()
        p, watcher = self.ready(s, size=PHONE, fingers=True)
        most = s.client().ok("status")["limits"]["max_live_strokes"]
        rows = [4 + 32 * i / most for i in range(most + 1)]
        self.draw_rows(p, rows)
        felt = {self.next_stroke(watcher, "started") for _ in range(most)}
        p.until("document.querySelector('#toast').textContent")
        p.touch("touchEnd")
        self.assertEqual({self.next_stroke(watcher, "finished") for _ in range(most)}, felt)
        p.until("tactor.state.takes.length === 1")
        self.assertEqual(len(self.take(p)["strokes"]), most + 1)

    def test_a_finger_that_rests_plays_on(self):
        s = self.serve()
        p, watcher = self.ready(s)
        last = self.press(p, [20, 20], [22, 20])
        number = self.next_stroke(watcher, "started")
        # Longer than the service waits for a point, by the stream's clock.
        asker = s.client()
        began = asker.ok("status")["stream"]["uptime_s"]
        while asker.ok("status")["stream"]["uptime_s"] < began + 0.8:
            pass
        self.assertIn(number, [x["stroke"] for x in asker.ok("status")["strokes"]])
        p.mouse("mouseReleased", *last)
        self.assertEqual(self.next_stroke(watcher, "finished"), number)
        # And it rests as long in the take.
        self.assertGreater(p.until(f"tactor.state.takes.length && {'tactor.state.takes[0].strokes[0].timed.at(-1)[0]'}"), 0.75)

    def test_with_feel_off_a_drawing_is_silent(self):
        s = self.serve()
        p, _ = self.ready(s)
        p.click("#feel")
        p.until("document.querySelector('#feel').getAttribute('aria-checked') === 'false'")
        self.draw(p, *self.way([5, 5], [35, 35]))
        self.assertEqual(s.client().ok("status")["strokes"], [])
        self.assertEqual(p.value("tactor.state.takes.length"), 1)

    def test_the_line_tool_and_the_shift_key_draw_straight(self):
        p, _ = self.ready(self.serve())
        p.click("[data-tool=line]")
        self.draw(p, [5, 5], [10, 30], [35, 5])
        p.click("[data-tool=draw]")
        p.value("document.querySelector('#field').addEventListener('pointerdown', e => Object.defineProperty(e, 'shiftKey', {value: true}), {capture: true, once: true})")
        self.draw(p, [5, 35], [10, 10], [35, 35])
        for take in p.value("tactor.state.takes"):
            self.assertEqual({round(y) for _, _, y, _ in take["strokes"][0]["timed"]}, {5} if take["name"] == "Take 1" else {35})

    def test_a_pen_s_pressure_is_its_strength(self):
        p, _ = self.ready(self.serve())
        first, *rest = self.at(p, *self.way([5, 20], [35, 20]))
        pen = {"button": "left", "buttons": 1, "pointerType": "pen"}
        p.call("Input.dispatchMouseEvent", type="mousePressed", x=first[0], y=first[1], force=0.25, clickCount=1, **pen)
        for x, y in rest:
            p.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y, force=0.25, **pen)
        p.call("Input.dispatchMouseEvent", type="mouseReleased", x=x, y=y, **pen | {"buttons": 0})
        p.until("tactor.state.takes.length === 1")
        take = self.take(p)
        self.assertEqual(take["origin"], "drawn with a pen")
        for row in take["strokes"][0]["timed"]:  # to its end, where the pen is lifted
            self.assertAlmostEqual(row[3], 0.25, places=2)

    def test_a_tap_tries_a_tactor_and_the_device_shows_its_facts(self):
        p, watcher = self.ready(self.serve())
        place = self.at(p, [20, 20])[0]
        p.tap(*place)
        self.next_stroke(watcher, "started")
        self.toast(p, "Tactor 4")
        p.open_popover("#device", "#p-device")
        p.click("#try button:nth-child(5)")
        self.next_stroke(watcher, "started")
        p.until("document.querySelector('#tactor-facts').innerText.includes('20, 20 mm')")
        self.assertEqual(p.value("tactor.state.takes.length"), 0)

    def test_the_field_does_not_move_under_a_finger(self):
        s = self.serve()
        p, watcher = self.ready(s, size=PHONE, fingers=True)
        corners = ([0, 0], [40, 40])
        field = "(f => [f.width, f.height, f.clientWidth, f.clientHeight])(document.querySelector('#field'))"
        before = self.at(p, *corners), p.value(field)
        last = self.press(p, [5, 5], [10, 10])
        self.next_stroke(watcher, "started")
        s.kill()
        self.banner(p, "No connection")
        # A message is over the field, and cannot be touched by mistake.
        self.assertEqual(p.value("getComputedStyle(document.querySelector('#banner')).pointerEvents"), "none")
        p.value("document.querySelector('#settings').click()")
        p.resize((PHONE[0], PHONE[1] - 60))  # an address bar
        p.frames()
        self.assertEqual((self.at(p, *corners), p.value(field)), before)
        p.mouse("mouseReleased", *last)
        p.until("tactor.state.takes.length === 1")
        p.until("(f => f.clientHeight === f.parentElement.clientHeight)(document.querySelector('#field'))")


class Keys(StudioTest):
    @staticmethod
    def press_on(p, code, key, text=""):
        """Presses a key as a keyboard does: on what has the focus."""
        number = {"Enter": 13, "Tab": 9, "Space": 32}[code]
        for kind in ("keyDown", "keyUp"):
            p.call("Input.dispatchKeyEvent", type=kind, code=code, key=key, windowsVirtualKeyCode=number, **({"text": text} if kind == "keyDown" and text else {}))

    def test_the_keyboard_draws_plays_and_stops(self):
        p, watcher = self.ready(self.serve())
        p.value("document.querySelector('#field').focus()")
        p.key("Enter")
        p.key("ArrowRight")
        number = self.next_stroke(watcher, "started")
        p.key("ArrowDown", modifiers=8)
        p.key("ArrowRight")
        p.key("Enter")
        self.assertEqual(self.next_stroke(watcher, "finished"), number)
        p.until("tactor.state.takes.length === 1")
        self.assertEqual(self.take(p)["origin"], "drawn with keys")
        self.planned(p)
        p.key("KeyL", "l")
        p.key("KeyP", "p")
        self.next_stroke(watcher, "started")
        p.key("Space", " ")
        self.says(p, "Stopped")
        self.assertEqual(p.value("document.querySelector('#state-why').textContent"), " · by you")
        p.until("!tactor.state.playing")

    def test_space_stops_with_any_focus_but_in_a_text(self):
        s = self.serve()
        p, watcher = self.ready(s)
        player = s.client()
        self.assertGreater(p.value("""(globalThis.all = [...document.querySelectorAll("button, input, summary, [tabindex='0']")]
            .filter(e => e.checkVisibility() && !e.disabled && !e.matches("%s"))).length""" % TEXTS), 30)
        for i in range(p.value("all.length")):
            number = player.ok("play", toml=LONG)["stroke"]
            watcher.stroke(number, "started")
            p.until("tactor.state.dbfs.some(v => v !== null)")
            name = p.value(f"(all[{i}].focus(), document.activeElement === all[{i}] && (all[{i}].id || all[{i}].outerHTML.slice(0, 80)))")
            self.assertTrue(name, p.value(f"all[{i}].isConnected + all[{i}].outerHTML.slice(0, 200)"))
            p.key("Space", " ")
            self.assertEqual(watcher.await_end(number)["state"], "cancelled", name)
        # It did nothing else.
        self.assertEqual(p.value("[tactor.state.tool, tactor.state.feel, tactor.state.loop, tactor.state.takes.length]"), ["draw", True, False, 0])
        # X does it, too. In silence Space presses the button that has the focus.
        number = player.ok("play", toml=LONG)["stroke"]
        watcher.stroke(number, "started")
        p.key("KeyX", "x")
        self.assertEqual(watcher.await_end(number)["state"], "cancelled")
        p.until("tactor.state.dbfs.every(v => v === null) && !tactor.state.status.strokes.length && !tactor.state.stopping")
        for is_on in (True, False):
            p.value("document.querySelector('#loop').focus()")
            self.press_on(p, "Space", " ", " ")
            p.until(f"tactor.state.loop === {str(is_on).lower()}")
        # In a text it is a space; the button there is the way.
        p.value("document.querySelector('#p-others').showPopover(), document.querySelector('#own-name-text').focus()")
        number = player.ok("play", toml=LONG)["stroke"]
        watcher.stroke(number, "started")
        p.call("Input.dispatchKeyEvent", type="keyDown", code="Space", key=" ", text=" ")
        self.assertEqual(p.value("document.querySelector('#own-name-text').value"), " ")
        self.assertIn(number, [x["stroke"] for x in player.ok("status")["strokes"]])
        p.click("#stop")
        self.assertEqual(watcher.await_end(number)["state"], "cancelled")

    def test_a_number_is_typed_key_by_key_and_no_key_of_it_is_a_shortcut(self):
        p, _ = self.ready(self.serve())
        self.draw(p, *self.way([4, 20], [36, 20]))
        p.click("[data-tool=points]")
        p.until("tactor.state.tool === 'points'")
        p.value("tactor.state.knot = 1")
        shown = "JSON.stringify([tactor.state.tool, tactor.state.knot, tactor.view.zoom, tactor.state.at_s, tactor.state.takes.length, tactor.state.compare, tactor.state.loop])"
        before, found = p.value(shown), set()
        for tab in ("method", "timing", "vibration"):
            p.click(f"[data-tab={tab}]")
            p.until(f"document.querySelector('#pane').getAttribute('aria-labelledby') === 'tab-{tab}'")
            p.value("document.querySelectorAll('#pane details').forEach(d => { d.open = true; })")
            p.value("(globalThis.fields = [...document.querySelectorAll('#pane input[inputmode=decimal]')]).length")
            for i in range(p.value("fields.length")):
                found.add(p.value(f"(fields[{i}].scrollIntoView(), fields[{i}].focus(), fields[{i}].select(), fields[{i}].labels[0].textContent)"))
                p.type("-+0.12,3=45 dbpn[z")
                p.call("Input.dispatchKeyEvent", type="rawKeyDown", key="Backspace", code="Backspace", windowsVirtualKeyCode=8)
                typed = "-+0.12,3=45dbpn["  # a number has no blank, so Space stops
                self.assertEqual(p.value(f"[fields[{i}].value, {shown}]"), [typed, before])
                p.value(f"fields[{i}].value = ''")
        self.assertLess({"Starts at", "Slope of the law", "Spread of speeds"}, found)
        # The field keeps what was typed; Ctrl Z in it takes back the typing, and not the take.
        p.click("[data-tab=timing]")
        p.until("(globalThis.field = [...document.querySelectorAll('#pane .entry')].find(e => e.textContent.startsWith('Starts at'))?.querySelector('input'))")
        p.value("field.closest('details').open = true, field.focus(), field.select()")
        p.type("0,125")
        p.key("KeyZ", "z", modifiers=2)
        self.assertEqual(p.value("tactor.state.takes.length"), 1)
        p.value("field.select()")
        p.type("0,125")
        p.value("field.blur()")
        p.until(f"{TAKE}.strokes[0].start_s === 0.125")
        p.value("document.querySelector('#p-study').showPopover(), document.querySelector('#study [name=trials]').focus(), document.activeElement.select()")
        p.type("120")
        self.assertEqual(p.value("[document.activeElement.value, tactor.state.compare, tactor.view.zoom]"), ["120", None, 1])

    def test_the_menu_of_a_take_is_reached_by_keys(self):
        p, _ = self.ready(self.serve())
        self.draw(p, *self.way([5, 5], [35, 5]))
        p.value("document.querySelector('.more-button').focus()")
        self.press_on(p, "Enter", "Enter", "\r")
        p.until("document.activeElement.matches('#p-take .button:first-child')")
        self.press_on(p, "Tab", "Tab")
        self.assertEqual(p.value("document.activeElement.textContent"), "Duplicate")
        p.key("Escape", "Escape")
        p.until("document.activeElement.matches('.more-button')")
        self.press_on(p, "Enter", "Enter", "\r")
        p.until("document.activeElement.matches('#p-take .button:first-child')")
        self.press_on(p, "Tab", "Tab")
        self.press_on(p, "Enter", "Enter", "\r")
        p.until("tactor.state.takes.length === 2")

    def test_a_wheel_moves_and_zooms_with_ctrl(self):
        p, _ = self.ready(self.serve())
        x, y = self.at(p, [20, 20])[0]

        def wheel(dx, dy, modifiers=0):
            p.call("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=dx, deltaY=dy, modifiers=modifiers)
        wheel(0, 40)
        p.until(f"Math.abs(tactor.place_in_page([20, 20])[1] - {y - 40}) < 1")
        wheel(30, 0)
        p.until(f"Math.abs(tactor.place_in_page([20, 20])[0] - {x - 30}) < 1")
        self.assertEqual(p.value("tactor.view.zoom"), 1)
        wheel(0, -100, modifiers=2)  # ctrl, as a pinch
        p.until("tactor.view.zoom > 1.3")

    def test_space_stops_what_is_being_drawn(self):
        p, watcher = self.ready(self.serve())
        last = self.press(p, [5, 5], [20, 20])
        number = self.next_stroke(watcher, "started")
        p.key("Space", " ")
        self.assertIn(watcher.await_end(number)["state"], ("cancelled", "finished"))
        p.until("!tactor.state.drawing")
        # Moving on with the button down does not start it again.
        p.move_to(*self.at(p, [30, 30], [35, 5]))
        p.mouse("mouseReleased", *last)
        self.assertFalse(p.value("tactor.state.drawing"))


if __name__ == "__main__":
    main()
