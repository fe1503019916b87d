# SPDX-License-Identifier: MIT
"""The first minute in a real Chromium: a page that plays sounds, the gallery and the tour. Usage: test_page_first.py TOOL SOURCE_ROOT"""
import re
import sys

del sys.argv[3:]
from studio import MISSING, NULL, PHONE, SIZES, StudioTest, quoted  # noqa: E402
from harness import ROOT, main  # noqa: E402

# Keeps the oscillators that the page makes.
LISTEN = """(make => { globalThis.heard = []; AudioContext.prototype.createOscillator = function () {
    const o = make.call(this); heard.push(o); return o; }; })(AudioContext.prototype.createOscillator)"""
CARDS = "[...document.querySelectorAll('#strokes button')]"


class Simulated(StudioTest):
    def simulated(self, **more):
        p = self.open(self.serve(device=MISSING), **more)
        self.says(p, "Simulated")
        p.until("document.querySelectorAll('#examples li').length && !document.querySelector('#hint').hidden")
        p.value(LISTEN)
        return p

    def test_without_a_card_the_page_plays_sounds(self):
        p = self.simulated()
        self.assertEqual(p.value("[document.querySelector('#device').dataset.tone, document.querySelector('#banner').hidden]"), ["off", True])
        self.assertIn("No card, so this page plays sounds.", p.value("document.querySelector('#hint').innerText"))
        p.click("#hint-example")
        p.until("tactor.state.at_s > 0")
        self.assertEqual(p.value("[...document.querySelectorAll('#examples b')].map(b => b.textContent)"), ["Three-quarter circle"])
        # Each tactor is a frequency at its place.
        self.assertEqual(p.value("heard.map(o => Math.round(o.frequency.value))"), [880] * 3 + [539] * 3 + [330] * 3)
        self.assertEqual(p.value("[tactor.state.takes.length, document.querySelector('#take-name').textContent]"), [0, "Three-quarter circle"])
        self.assertNotRegex(p.value("document.body.innerText"), re.compile(r"you feel|feel on|felt, predicted", re.I))
        self.assertIn("orange is the predicted feel", p.value("document.body.innerText"))
        p.click("#stop")
        p.until("!tactor.state.playing")

    def test_a_drawing_and_a_tactor_are_heard_until_stop(self):
        p = self.simulated()
        self.press(p, [5, 20], [20, 20])
        p.until("heard.length === 9 && tactor.state.dbfs[4] > -13")
        p.until("document.querySelector('#loudest').textContent.startsWith('loudest: tactor 4')")
        p.click("#stop")
        p.until("!tactor.state.drawing && tactor.state.dbfs.every(v => v === null) && document.querySelector('#hint').hidden")
        p.frames()  # the array moves to where the hint was
        p.tap(*self.at(p, [0, 0])[0])
        p.until("heard.length === 18 && tactor.state.dbfs[0] !== null")
        p.until("tactor.state.dbfs.length === 0")
        p.click("#feel")
        p.until("document.querySelector('#feel-text').textContent === 'Hear off'")
        self.draw(p, *self.way([5, 5], [35, 35]))
        self.planned(p)
        p.click("#play")
        self.toast(p, "No card: shown, not felt")
        p.until("tactor.state.at_s > 0 && !tactor.state.playing")  # it may have ended already
        self.assertEqual(p.value("heard.length"), 18)

    def test_a_service_that_plays_to_nobody_is_heard(self):
        s = self.serve(device=NULL)
        p = self.open(s)
        self.says(p, "Simulated")
        watcher = s.watcher()
        p.until("document.querySelectorAll('#examples li').length && !document.querySelector('#hint').hidden")
        p.value(LISTEN)
        self.assertNotRegex(p.value("document.body.innerText"), re.compile(r"you feel|feel on|felt, predicted|listen", re.I))
        # It sounds at the first touch, and the service plays, too: other clients see it.
        self.press(p, [5, 20], [20, 20])
        p.until("heard.length === 9 && tactor.state.dbfs[4] > -20")
        self.next_stroke(watcher, "started")
        p.click("#stop")
        p.until("!tactor.state.drawing")
        p.value("heard.length = 0")
        p.key("KeyG", "g")
        p.value(f"{CARDS}[3].click()")
        self.next_stroke(watcher, "started")
        p.until("heard.length >= 9 && tactor.state.dbfs.some(v => v > -30)")
        # A single button turns the sound off.
        p.click("#feel")
        p.until("document.querySelector('#feel-text').textContent === 'Hear off' && !tactor.state.speaker")
        self.assertFalse(p.value("document.querySelector('#speaker').checkVisibility()"))

    def test_share_shows_the_command_where_no_other_device_can_open_the_address(self):
        p, _ = self.ready(self.serve())
        p.open_popover("#more", "#p-more")
        p.click("[data-press=p-share]")
        p.until("document.querySelector('#p-share').matches(':popover-open')")
        self.assertRegex(p.value("document.querySelector('#link').textContent"), r"^tactor serve --http 0\.0\.0\.0:\d+ --config FILE$")
        self.assertFalse(p.value("document.querySelector('#qr').checkVisibility()"))

    def test_share_shows_a_code_of_an_address_that_a_phone_opens(self):
        s = self.serve(config='[serve]\nallow_hosts = ["pi.test"]\n')
        s.where["http"] = s.where["http"].replace("127.0.0.1", "pi.test")
        p, _ = self.ready(s)
        p.open_popover("#more", "#p-more")
        p.click("[data-press=p-share]")
        p.until("document.querySelector('#qr path')?.getAttribute('d').startsWith('M0 0h1v1h-1z')")
        self.assertEqual(p.value("document.querySelector('#link').textContent"), s.where["http"])


class Gallery(StudioTest):
    def test_a_card_plays_in_its_place_with_the_array_in_view(self):
        p, watcher = self.ready(self.serve())
        for size in SIZES:
            p.resize(size)
            p.value("document.querySelector('#p-gallery').showPopover()")
            p.frames()
            p.frames()
            with self.subTest(size=size):
                for name in ("stop", "level"):
                    self.assertEqual(p.element_at(*p.middle(f"#{name}"), f"#{name}"), name)
                for i, at in enumerate(p.value("tactor.state.hello.array.tactors.map(t => tactor.place_in_page([t.x_mm, t.y_mm]))")):
                    self.assertEqual(p.element_at(*at, "canvas"), "field", i)
                p.value(f"{CARDS}[3].click()")
                self.next_stroke(watcher, "started")
                # The card's picture moves, and stands still once the stroke has ended.
                p.until(f"{CARDS}[3].hasAttribute('data-playing') && tactor.state.at_s > 0.1")
                first = p.value(f"{CARDS}[3].querySelector('canvas').toDataURL()")
                p.until(f"{CARDS}[3].querySelector('canvas').toDataURL() !== {quoted(first)}")
                p.click("#stop")
                p.until("!document.querySelector('[data-playing]')")

    def test_a_tap_plays_and_the_first_change_makes_a_take(self):
        p, watcher = self.ready(self.serve())
        p.key("KeyG", "g")
        p.until(f"document.querySelector('#p-gallery').checkVisibility() && {CARDS}.length === 20")
        for name in ("stop", "level"):
            self.assertEqual(p.element_at(*p.middle(f"#{name}"), f"#{name}"), name)
        for i in range(20):
            p.value(f"{CARDS}[{i}].click()")
            name = p.value(f"{CARDS}[{i}].querySelector('b').textContent")
            with self.subTest(name=name):
                self.next_stroke(watcher, "started")
                p.until("tactor.state.plan && tactor.state.plan_of === tactor.state.trial")
                self.assertEqual(p.value("[tactor.state.takes.length, tactor.state.trial.name, tactor.state.outside.length]"), [0, name, 0])
                self.assertEqual(p.value("tactor.state.plan.warnings.filter(w => w.kind)"), [])
        p.key("Escape")
        p.until("!document.querySelector('#p-gallery').checkVisibility()")
        p.click("#tab-vibration")
        p.click("#pane [data-value=noise]")
        p.until("tactor.state.takes.length === 1 && tactor.state.takes[0].name === 'Two fingers'")
        p.click("#undo")
        p.until("tactor.state.takes.length === 0 && document.querySelector('#take-name').textContent === 'Two fingers'")
        p.click("#stop")

    def test_a_tactor_with_a_low_limit_is_named_and_makes_no_take(self):
        array = self.write("low.toml", "[array]\npreset = 'palm-3x3'\n[[tactor]]\ntactor = 4\nmax_dbfs = -30\n")
        p, watcher = self.ready(self.serve("--array", array))
        p.key("KeyG", "g")
        p.value(f"{CARDS}[0].click()")
        self.next_stroke(watcher, "started")
        self.toast(p, "tactor 4 is limited to −30 dBFS")
        self.assertEqual(p.value("[tactor.state.takes.length, tactor.state.trial.name]"), [0, "Line across"])
        self.assertLess(p.value("tactor.state.trial.gain_db"), -10)  # 18 dB, and less where no burst is on the tactor

    def test_a_row_of_tactors_has_what_makes_sense_there(self):
        for file, fitting in (("arm-line-4", 10), ("two", 6)):
            array = ROOT / f"examples/arrays/{file}.toml" if file != "two" else self.write(
                "two.toml", "[array]\n[[tactor]]\nx_mm = 0\ny_mm = 0\n[[tactor]]\nx_mm = 0\ny_mm = 30\n")
            with self.subTest(array=file):
                p, watcher = self.ready(self.serve("--array", array, "--socket", self.dir / f"{file}.sock"))
                self.assertEqual(p.value(f"{CARDS}.filter(b => !b.disabled).length"), fitting)
                self.assertIn("needs two rows", p.value(f"{CARDS}[2].textContent"))
                p.value(f"{CARDS}[5].click()")
                self.next_stroke(watcher, "started")


class Tour(StudioTest):
    def test_six_steps_that_play(self):
        p, watcher = self.ready(self.serve(), size=PHONE, fingers=True)
        p.click("#settings")
        p.click("button[data-sheet=takes]")
        p.until("document.querySelector('#tour-open').checkVisibility()")
        p.click("#tour-open")
        p.until("document.querySelector('#p-tour').textContent.startsWith('One tactorTactor 4 buzzes')")
        for step in range(1, 7):
            p.until(f"document.querySelector('#p-tour small').textContent === '{step} of 6'")
            if step < 6:
                if step not in (2, 3):
                    p.click("#p-tour .row button:last-child")
                self.next_stroke(watcher, "started")
                p.click("#p-tour .row:last-child button:last-child")
        self.assertEqual(p.element_at(*p.middle("#stop")), "stop")
        p.click("#p-tour .row button")
        p.until("!document.querySelector('#p-tour').matches(':popover-open') && tactor.state.current === null")
        self.assertEqual(p.value("tactor.state.takes.length"), 0)


if __name__ == "__main__":
    main()
