# SPDX-License-Identifier: MIT
"""The array on the body, to scale, in a real Chromium. Usage: test_page_body.py TOOL SOURCE_ROOT"""
import json
import re
import sys

del sys.argv[3:]
from studio import SIZES, DESKTOP, PHONE, StudioTest  # noqa: E402
from harness import main  # noqa: E402

LINES = "document.querySelector('#array-lines').textContent"
CHOSEN = "document.querySelector('.parts [aria-checked=true]').textContent"
SHIFT = 8


class Body(StudioTest):
    def placing(self, **more):
        p, _ = self.ready(self.serve(), **more)
        p.key("KeyH", "h")
        p.until("document.querySelector('#place-bar').checkVisibility()")
        p.frames()
        return p

    @staticmethod
    def lines(p):
        """Returns what the lines for the array's file say."""
        return {k: json.loads(v) for k, v in re.findall(r"(\w+) = (.+)", p.value(LINES))}

    def says(self, p, **values):
        for k, v in values.items():
            p.until(f"{LINES}.includes({json.dumps(f'{k} = {json.dumps(v)}')})")

    def file_says(self, p, **values):
        """Lets the service say what it reads from the array's file."""
        p.value(f"Object.assign(tactor.state.hello.array, {json.dumps(values)}), tactor.changed('array')")
        p.frames()

    def on_hand(self, p, x, y, place=(1, -56)):
        """Returns true if a place, mm from the middle of the wrist crease, is drawn as hand. The array lies around 20, 20."""
        [[px, py]] = self.at(p, [x - place[0] + 20, y - place[1] + 20])
        colours = p.value(f"""(() => {{
            const f = document.querySelector('#ground'), r = f.getBoundingClientRect(), k = f.width / r.width;
            const hex = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
            const d = f.getContext('2d').getImageData(Math.round(({px} - r.left) * k), Math.round(({py} - r.top) * k), 1, 1).data;
            return ['#' + [...d].slice(0, 3).map(v => v.toString(16).padStart(2, '0')).join(''), hex('--hand'), hex('--outside')];
        }})()""")
        self.assertIn(colours[0], colours[1:])
        return colours[0] == colours[1]

    def test_the_hand_is_as_large_as_it_says(self):
        p = self.placing()
        self.assertIn("56 mm from the wrist crease", p.value("document.querySelector('#place-bar h2').textContent"))
        self.assertIn("not in the array’s file", p.value(CHOSEN))
        # The wrist is 57 mm wide, and the middle finger ends 180 mm from its crease.
        for mm, hand in (((-26, 8), True), ((-31, 8), False), ((27, 8), True), ((32, 8), False), ((-9.6, -177), True), ((-9.6, -183), False)):
            self.assertEqual(self.on_hand(p, *mm), hand, mm)
        for _ in range(20):
            p.click("[aria-label=Longer]")
        self.says(p, body=200)
        p.key("Digit0", "0")
        p.frames()
        self.assertTrue(self.on_hand(p, -10.6, -196))
        self.assertFalse(self.on_hand(p, -10.6, -203))
        for _ in range(60):
            p.click("[aria-label=Shorter]")
        self.says(p, body=150)  # at least

    def test_a_right_hand_is_the_left_one_mirrored(self):
        p = self.placing()
        self.assertTrue(self.on_hand(p, -60, -70))  # the thumb
        self.assertFalse(self.on_hand(p, 60, -70))
        p.value("[...document.querySelectorAll('#place-bar button')].find(b => b.textContent === 'Right').click()")
        self.says(p, site="right palm", place=[-1, -56])
        p.frames()
        self.assertTrue(self.on_hand(p, 60, -70, (-1, -56)))
        self.assertFalse(self.on_hand(p, -60, -70, (-1, -56)))

    def test_keys_mouse_and_handle_move_and_turn_the_body_and_it_is_kept(self):
        p = self.placing()
        p.key("ArrowRight")
        self.says(p, place=[0, -56])
        p.key("ArrowDown", modifiers=SHIFT)
        self.says(p, place=[0, -56.1])
        # Ten millimetres down: the array lies nearer to the fingers.
        start, end = self.at(p, [20, 60], [20, 70])
        p.mouse("mousePressed", *start)
        p.move_to(end)
        p.mouse("mouseReleased", *end)
        self.assertAlmostEqual(self.lines(p)["place"][1], -66.1, delta=0.3)
        self.assertEqual(p.value("tactor.state.takes.length"), 0)
        # The handle is above the array; at its left side it has turned the body by a quarter.
        top, left = self.at(p, [20, 0], [0, 20])
        [[x, y]] = self.at(p, [20, 20])
        start, end = (x, top[1] - 44), (left[0] - 44, y)
        p.mouse("mousePressed", *start)
        p.move_to(end)
        p.mouse("mouseReleased", *end)
        self.says(p, turn=-90, up="little finger")
        before = p.value(LINES)
        p.key("Escape")
        p.until("!document.querySelector('#place-bar').checkVisibility()")
        self.draw(p, [5, 5], [30, 30])  # the tools are back
        self.reload(p)
        p.until(f"{LINES} === {json.dumps(before)}")

    def test_the_file_says_where_the_array_is_until_it_is_moved_here(self):
        p = self.placing()
        self.file_says(p, site="right index fingertip", place=[1, 2], turn=15, body=19)
        self.assertEqual(self.lines(p), {"site": "right fingertip", "up": "tip", "place": [1, 2], "turn": 15, "body": 19})
        self.assertEqual(p.value(CHOSEN), "Fingertip")
        p.value("document.querySelector('#field').focus()")
        p.key("ArrowLeft")
        p.until(f"{CHOSEN}.includes('not in the array’s file')")
        moved = self.lines(p)["place"]
        self.file_says(p)  # the same once more, as after a lost connection
        self.assertEqual(self.lines(p)["place"], moved)
        self.file_says(p, place=[3, 2])
        self.assertEqual(self.lines(p)["place"], [3, 2])

    def test_a_site_in_words_and_what_is_up_find_the_part_and_its_turn(self):
        p = self.placing()
        for site, name, up, turn in (("palm", "left palm", "thumb", 90), ("right hand", "right palm", "thumb", 270),
                                     ("back of the left hand", "left back of hand", "wrist", 180), ("left forearm", "left forearm", "elbow", 180),
                                     ("right wrist", "right wrist", "hand", 0), ("lower back", "back", "head", 0), ("thigh", "thigh", "knee", 0)):
            with self.subTest(site=site):
                self.file_says(p, site=site, up=up)
                self.assertEqual([self.lines(p)[k] for k in ("site", "up", "turn")], [name, up, turn])

    def test_the_locator_lies_on_nothing_and_a_tap_opens_the_mode(self):
        for size in SIZES:
            with self.subTest(size=size):
                p, _ = self.ready(self.serve("--socket", self.dir / f"{size[0]}.sock"), size=size, fingers=size != DESKTOP)
                p.until("document.querySelector('#locator .outline rect')")
                self.add_example(p)
                p.until("document.querySelector('#hint').hidden")
                left, top, right, bottom = p.value("(r => [r.left, r.top, r.right, r.bottom])(document.querySelector('#locator').getBoundingClientRect())")
                self.assertEqual((right - left, bottom - top), (74, 86))
                r = 20 * 0.215 * p.value("tactor.view.scale")
                for x, y in self.at(p, *([20 * i, 20 * j] for i in range(3) for j in range(3))):
                    away = max(left - x, x - right, 0) ** 2 + max(top - y, y - bottom, 0) ** 2
                    self.assertGreaterEqual(away, r * r, (x, y))
                x, y = p.middle("#locator")
                self.assertEqual(p.element_at(x, y), "locator")
                if size == PHONE:
                    p.touch("touchStart", (0, x, y))
                    p.touch("touchEnd")
                else:
                    p.tap(x, y)
                p.until("document.querySelector('#place-bar').checkVisibility()")
                self.assertEqual(p.element_at(*p.middle("#stop")), "stop")

    def test_drawing_draws_the_outline_once(self):
        p, _ = self.ready(self.serve())
        self.draw(p, *self.way([5, 30], [35, 5]))
        p.until("document.querySelector('#hint').hidden")
        self.planned(p)  # with the first take and its plan the canvas gets its size
        p.value("""(f => { globalThis.outlines = 0; CanvasRenderingContext2D.prototype.fill = function (...a) {
            outlines += a[0] instanceof Path2D; return f.apply(this, a); }; })(CanvasRenderingContext2D.prototype.fill)""")
        self.draw(p, *self.way([5, 5], [35, 30]))
        self.assertEqual(p.value("outlines"), 0)
        p.key("Equal", "+")
        p.until("outlines > 0")


if __name__ == "__main__":
    main()
