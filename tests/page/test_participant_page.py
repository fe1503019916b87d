# SPDX-License-Identifier: MIT
"""The participant's page of tactor experiment and calibrate in a real Chromium: a simulated participant clicks, types and
taps through sessions. Usage: test_participant_page.py TOOL SOURCE_ROOT [FOLDER_FOR_PICTURES]"""
import math
import pathlib
import re
import sys

PICTURES = pathlib.Path(sys.argv.pop(3)).resolve() if len(sys.argv) > 3 else None
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from browser import BrowserTest  # noqa: E402
from experiments import ADJUST, BARE, DRAWINGS, ESTIMATES, IDENTIFY, LINE, SHORT, read_table  # noqa: E402
from harness import main  # noqa: E402
from pages import PageTest, Session  # noqa: E402
from studies import toml  # noqa: E402

# Without the transitions between themes, which pictures would catch.
THEMES = {theme: [{"name": "prefers-color-scheme", "value": theme}, {"name": "prefers-reduced-motion", "value": "reduce"}]
          for theme in ("light", "dark")}
SIZES = ((1440, 900), (820, 1180), (390, 844), (844, 390))
PHONE = SIZES[2]
FRAME_S = 1 / 60


class ParticipantPage(BrowserTest, PageTest):
    def open(self, s, **more):
        return self.page(f"http://{s.address}/", **more)

    @staticmethod
    def asked(p, screen, ask=0):
        """Returns the number of a question that is newer than `ask`."""
        return p.until(f"state.screen === '{screen}' && state.ask > {ask} && !document.querySelector('#answers button').disabled && state.ask")

    def click(self, p, screen, choice, ask=0):
        ask = self.asked(p, screen, ask)
        p.click(f"#answers button:nth-child({choice})")
        return ask

    def key(self, p, screen, key, ask=0):
        ask = self.asked(p, screen, ask)
        p.key({" ": "Space"}.get(key, f"Digit{key}"), key)
        return ask

    def tap(self, p, screen, choice, ask=0):
        ask = self.asked(p, screen, ask)
        x, y = p.middle(f"#answers button:nth-child({choice})")
        p.touch("touchStart", (1, x, y))
        p.touch("touchEnd")
        return ask

    def begin(self, p):
        """Answers all before the first run; returns the number of the last question."""
        return self.click(p, "introduce", 1, self.walk(p, self.click(p, "consent", 1)))

    def walk(self, p, ask=0):
        for _ in (0, 1):
            ask = self.click(p, "walk", 1, ask)
        return ask

    def picture(self, p, name):
        """Checks each size: nothing outside the screen and no button too small. Pictures are light and dark."""
        for width, height in SIZES:
            p.resize((width, height))
            self.assertLessEqual(p.value("document.documentElement.scrollWidth"), width, name)
            for x, y, w, h in p.value("[...document.querySelectorAll('#answers button')].map(b => { const r ="
                                      " b.getBoundingClientRect(); return [r.x, r.y, r.width, r.height]; })"):
                self.assertTrue(x >= 0 and y >= 0 and x + w <= width and y + h <= height, (name, width, x, y, w, h))
                self.assertGreaterEqual(min(w, h), 44, (name, width))
            for theme, features in THEMES.items() if PICTURES else ():
                p.call("Emulation.setEmulatedMedia", features=features)
                p.until(f"document.documentElement.dataset.theme === '{theme}'")
                p.picture(PICTURES / f"participant-{name}-{width}x{height}-{theme}.png")

    def test_mouse_keys_and_touch_answer(self):
        self.write("short.toml", SHORT.replace("break_s = 0.3", "break_s = 60"))
        s = self.start()
        p = self.open(s)
        self.asked(p, "consent")
        self.picture(p, "consent")
        ask = self.click(p, "consent", 1)
        ask = self.asked(p, "walk", ask)
        ask = self.key(p, "walk", "1")
        ask = self.asked(p, "walk", ask)
        self.picture(p, "walk")
        ask = self.tap(p, "walk", 1)
        self.asked(p, "introduce", ask)
        self.picture(p, "introduce")
        ask = self.key(p, "introduce", " ")
        ask = self.click(p, "question", 2, ask)
        ask = self.asked(p, "question", ask)
        self.picture(p, "choose")
        p.key("Digit7", "7")  # there is none
        ask = self.key(p, "question", "2")
        ask = self.tap(p, "question", 1, ask)
        p.until("state.screen === 'rest' && /^(1:00|[1-5]?[0-9])$/.test(document.querySelector('#left').textContent)")
        self.assertEqual(p.value("['valuenow', 'valuemax'].map(v => document.querySelector('#bar').getAttribute(`aria-${v}`))"), ["2", "2"])
        self.picture(p, "rest")
        s.key("g")
        ask = self.click(p, "introduce", 1, ask)
        ask = self.asked(p, "question", ask)
        self.picture(p, "rate")
        ask = self.key(p, "question", "3")
        self.key(p, "question", "1", ask)
        p.until("state.screen === 'over'")
        self.picture(p, "over")
        self.assertEqual(s.end(), 0, s.said)
        self.assertEqual(self.answers(), [("1", "1", "false", "2"), ("2", "1", "false", "1")])
        self.assertEqual(self.answers("marks", "rating"), [("1", "1", "false", "3"), ("2", "1", "false", "1")])
        # The end does not count as a lost connection, and no other server was asked.
        self.assertTrue(p.value("document.querySelector('#offline').hidden"))
        self.assertEqual(p.faults(), [])
        self.assertEqual({u.split("/rpc")[0].rstrip("/").replace("ws:", "http:") for u in p.requests() if not u.startswith("data:")},
                         {f"http://{s.address}"})

    def test_the_target_moves_in_its_own_time(self):
        self.write("slow.toml", SHORT.replace("duration = 0.2", "duration = 2.0").replace("practice = 1\n", ""))
        s = self.start(definition="slow.toml")
        p = self.open(s)
        ask = self.begin(p)
        # The target's place in each frame, and the place at the plan's time.
        p.until("state.screen === 'target' && document.querySelector('#field .dot')")
        self.assertGreater(p.value("document.querySelector('#field .dot').getBoundingClientRect().width"), 4)
        seen = p.value("""new Promise(done => { const all = [];
            const look = () => {
                if (state.screen !== 'target') return done([all, state.screen]);
                all.push([(performance.now() - began) / 1000, Number(document.querySelector('#field .dot').getAttribute('cx'))]);
                requestAnimationFrame(look); };
            requestAnimationFrame(look); })""")
        places, after = seen
        self.assertEqual(after, "stimulus")
        self.assertEqual(p.value("document.querySelector('#field').getClientRects().length"), 0)
        self.assertGreater(len(places), 10)
        ask = self.click(p, "question", 1, ask)
        p.until("state.screen === 'target' && document.querySelector('#field .dot')")
        self.picture(p, "target")  # takes its time
        # The stimulus that plays is lit where its answer will be.
        for playing in (1, 2):
            p.until(f"document.querySelector('#stimuli .on')?.textContent === '{playing}' && document.querySelector('#playing').textContent === '{playing}'")
            self.picture(p, f"stimulus-{playing}")
        lit = p.middle("#stimuli .on")
        self.asked(p, "question", ask)
        self.assertEqual(p.middle("#answers button:nth-child(2)"), lit)
        s.key("q")
        self.assertEqual(s.end(), 130)
        speed = 20 / 2.0
        east = places[-1][1] > places[0][1]
        for t, x in places:
            self.assertLessEqual(abs((x if east else 20 - x) - speed * min(t, 2.0)), speed * FRAME_S, (t, x))

    def test_all_160_trials(self):
        """Runs the paper's four runs, with quick motions."""
        text = self.ok("experiment", "park2016", "--print").stdout
        for pattern, other in ((r"^(preset = .*)", r"\1\nduration = 0.15"), ("^gap_s.*", "gap_s = 0.05"), ("^rest_s.*", "rest_s = 0"),
                               ("^break_s.*", "break_s = 0.2"), ("^practice.*", "practice = 1"), ("^level = .*", "level = { dbfs = -20 }"), ("^noise = .*", 'noise = "none"')):
            text = re.sub(pattern, other, text, flags=re.M)
        self.write("quick.toml", text)
        s = self.start(definition="quick.toml")
        p = self.open(s)
        ask = self.click(p, "consent", 1)
        for _ in range(9):
            ask = self.key(p, "walk", "1", ask)
        given, ways = {}, (self.click, self.key, self.tap)
        for run in range(4):
            ask = self.key(p, "introduce", " ", ask)
            # Practice, and forty. Where the stream was late a trial is void: it is not asked, and comes again after the others.
            n = -1
            while n < 40:
                ask = self.asked(p, "question", ask)
                told = p.value("state")
                self.assertEqual(told["progress"]["run"], run + 1)
                n = 0 if told["progress"]["practice"] else max(n, 0) + 1
                choice = (7 * n + run) % len(told["choices"]) + 1
                ways[n % 3](p, "question", str(choice) if n % 3 == 1 else choice)
                if n > 0:
                    given.setdefault(told["question"], []).append((str(told["progress"]["trial"]), str(choice)))
        self.assertEqual(s.end(), 0, s.said)
        questions = dict(zip(re.findall('^name = "(.*-rating|similarity|uniformity)"', text, re.M), re.findall('^question = "(.*)"', text, re.M)))
        self.assertEqual(sum(map(len, given.values())), 160)
        for name, question in questions.items():
            rows = self.rows("01", name.replace("-", ""))
            self.assertEqual([(r["trial"], r["response"]) for r in rows if r["void"] == "false"], given[question], (name, s.said))
            self.assertEqual([r["trial"] for r in rows if r["attempt"] == "1"], [str(i) for i in range(1, 41)])
            for r in rows:
                if r["void"] == "true":
                    self.assertIn(f"trial {r['trial']} is void", s.said)

    def test_reload_second_tab_and_lost_connection(self):
        s = self.start()
        p = self.open(s)
        self.asked(p, "consent")
        p.reload()
        ask = self.begin(p)
        ask = self.click(p, "question", 1, ask)  # practice
        p.until("state.screen === 'stimulus'")
        p.reload()  # in mid-trial
        ask = self.asked(p, "question", ask)
        p.reload()  # during the question
        self.assertEqual(self.asked(p, "question"), ask)
        second = self.open(s, size=PHONE)
        self.assertEqual(self.asked(second, "question"), ask)
        p.until("state.screen === 'elsewhere'")
        self.picture(p, "elsewhere")
        p.key("Digit1", "1")
        second.call("Page.bringToFront")
        # A lost connection: shown, and restored by itself; the question stays.
        self.assertTrue(second.value("""new Promise(done => {
            socket.addEventListener("close", () => done(!document.querySelector("#offline").hidden));
            socket.close(); })"""))
        self.assertEqual(self.asked(second, "question"), ask)
        second.until("document.querySelector('#offline').hidden")
        # Doubled: by hand, against the page's guard.
        second.value(f"socket.send('{{\"ask\":{ask},\"answer\":2}}'); socket.send('{{\"ask\":{ask},\"answer\":1}}')")
        ask = self.asked(second, "question", ask)
        # At once, so that nothing that they could answer comes in between.
        second.value("for (let i = 0; i < 3; i++) dispatchEvent(new KeyboardEvent('keydown', {key: '1'}))")
        ask = self.click(second, "introduce", 1, ask)
        for _ in (1, 2):
            ask = self.tap(second, "question", 2, ask)
        self.assertEqual(s.end(), 0, s.said)
        self.assertEqual(self.answers(), [("1", "1", "false", "2"), ("2", "1", "false", "1")])
        self.assertEqual(self.answers("marks", "rating"), [("1", "1", "false", "2"), ("2", "1", "false", "2")])
        self.assertEqual(p.value("state.screen"), "elsewhere")

    def test_a_program_that_is_killed_and_comes_back(self):
        s = self.start()
        p = self.open(s)
        self.asked(p, "consent")
        s.process.kill()
        p.until("!document.querySelector('#offline').hidden")
        self.assertTrue(p.value("document.querySelector('#answers button').disabled"))
        self.picture(p, "offline")
        s.end()
        self.start("--page", s.address.rpartition(":")[2])
        self.asked(p, "consent")
        self.assertTrue(p.value("document.querySelector('#offline').hidden"))

    def test_a_motion_of_two_strokes_shows_each_while_it_plays(self):
        self.write("two.toml", '[[stroke]]\npath = "M0 0H20"\nduration_s = 2.0\nstart_s = 0\n'
                               '[[stroke]]\npath = "M20 0H0"\nduration_s = 1.0\nstart_s = 1.0\n')
        self.write("both.toml", BARE + toml("motion", "both", file="two.toml")
                   + toml("run", "how", task="rate", attribute="similarity", animation=True, trials=2, scale=3, motions=["both"], methods=["Birch"])
                   + toml("run", "what", task="identify", trials=2, motions=["east", "both"], methods=["Birch"]))
        s = self.start(definition="both.toml")
        p = self.open(s)
        ask = self.click(p, "introduce", 1, self.walk(p))
        p.until("state.screen === 'target' && document.querySelector('#field .dot')")
        seen = p.value("""new Promise(done => { const all = [];
            const look = () => {
                if (state.screen !== 'target') return done(all);
                all.push([(performance.now() - began) / 1000, [...document.querySelectorAll('#field .dot')].map(
                    e => getComputedStyle(e).display === 'none' ? null : Number(e.getAttribute('cx')))]);
                requestAnimationFrame(look); };
            requestAnimationFrame(look); })""")
        alone = [dots for at, dots in seen if at < 0.95]
        both = [(at, dots) for at, dots in seen if 1.05 < at < 1.95]
        self.assertTrue(alone and both)
        self.assertTrue(all(a is not None and b is None for a, b in alone), alone)
        for at, (a, b) in both:
            self.assertLess(abs(a - 10 * at), 1.5)  # 20 mm in 2 s, and a frame or two late
            self.assertLess(abs(b - (40 - 20 * at)), 3)
        ask = self.click(p, "question", 1, ask)
        p.until("state.screen === 'target' && document.querySelectorAll('#field .dot:not(.away)').length === 2")
        if PICTURES:
            p.picture(PICTURES / "participant-two-strokes.png")
        ask = self.click(p, "question", 1, ask)
        ask = self.click(p, "introduce", 1, ask)
        ask = self.asked(p, "question", ask)
        self.assertEqual(p.value("[...document.querySelectorAll('#answers button')].map(b => [b.querySelectorAll('.start').length, b.querySelectorAll('.end').length])"),
                         [[1, 1], [2, 2]])
        self.picture(p, "names-of-two-strokes")
        self.click(p, "question", 2)
        self.click(p, "question", 2, ask)
        self.assertEqual(s.end(), 0, s.said)
        self.assertEqual([r["response"] for r in self.rows("01", "what") if r["void"] == "false"], ["both", "both"])

    def test_two_intervals_are_marked_alike_and_answered_by_keys(self):
        self.write("felt.toml", BARE + toml("run", "felt", task="interval", vary="level_dbfs", values=[-40, -20], trials=4, motions=["east"], methods=["Birch"]))
        s = self.start(definition="felt.toml")
        p = self.open(s)
        ask = self.click(p, "introduce", 1, self.walk(p))
        for answer in "1221":
            for playing in (1, 2):
                p.until(f"document.querySelector('#stimuli .on')?.textContent === '{playing}'")
            ask = self.asked(p, "question", ask)
            self.assertEqual(p.value("[document.querySelector('#question').textContent, ...[...document.querySelectorAll('#answers button')].map(b => b.textContent)]"),
                             ["In which interval did you feel it?", "1", "2"])
            if answer == "1":
                self.picture(p, "two-intervals")
            ask = self.key(p, "question", answer, ask - 1)
        self.assertEqual(s.end(), 0, s.said)
        rows = self.rows("01", "felt")
        self.assertEqual([r["response"] for r in rows], list("1221"))
        self.assertEqual({tuple(sorted((r["method_1"], r["method_2"]))) for r in rows}, {("Birch", "none")})
        right = sum((r["response"] == "2") == (r["method_1"] == "none") for r in rows)
        self.assertEqual([r["positive"] for r in self.trials()[1]].count("1"), right)

    def test_three_stimuli_light_up_where_their_answers_are(self):
        self.write("odd.toml", BARE + toml("run", "odd", task="oddity", trials=4, motions=["east"]))
        s = self.start(definition="odd.toml")
        p = self.open(s)
        ask = self.click(p, "introduce", 1, self.walk(p))
        for answer in "1233":
            lit = []
            for playing in (1, 2, 3):
                p.until(f"document.querySelector('#stimuli .on')?.textContent === '{playing}'")
                lit.append(p.middle("#stimuli .on"))
            ask = self.asked(p, "question", ask)
            self.assertEqual(p.value("[document.querySelector('#question').textContent, ...[...document.querySelectorAll('#answers button')].map(b => b.textContent)]"),
                             ["Which was different from the two others?", "1", "2", "3"])
            self.assertEqual([p.middle(f"#answers button:nth-child({i})") for i in (1, 2, 3)], lit)
            if answer == "1":
                self.picture(p, "three-stimuli")
            ask = self.key(p, "question", answer, ask - 1)
        self.assertEqual(s.end(), 0, s.said)
        self.assertEqual([r["response"] for r in self.rows("01", "odd")], list("1233"))

    def test_places_and_paths_are_drawn_by_mouse_finger_and_keys(self):
        self.write("drawn.toml", DRAWINGS)
        s = self.start(definition="drawn.toml")
        p = self.open(s)
        ask = self.click(p, "introduce", 1, self.walk(p))

        def asked():
            return p.until(f"state.screen === 'question' && state.ask > {ask} && document.querySelector('#hand:not(.closed)') && state.ask")

        def to_px(x, y):
            return p.value("(m => [m.a * %g + m.e, m.d * %g + m.f])(document.querySelector('#hand').getScreenCTM())" % (x, y))

        def confirm():
            p.click("#answers button")

        ask = asked()
        self.picture(p, "place")
        p.resize(SIZES[0])
        p.key("Enter")  # nothing is shown yet
        self.assertEqual(p.value("[state.ask, document.querySelector('#answers button').disabled]"), [ask, True])
        p.tap(*to_px(4, 1))
        p.tap(*to_px(12, -2))  # replaces it
        self.picture(p, "place-shown")
        p.resize(SIZES[0])
        confirm()
        ask = asked()
        x, y = to_px(3, 2)
        p.touch("touchStart", (1, x, y))
        p.touch("touchEnd")
        confirm()
        ask = asked()
        for key in ("ArrowRight", "ArrowDown", "ArrowDown"):  # from the middle of the array
            p.key(key)
        p.key("Enter")
        ask = self.click(p, "introduce", 1, ask)
        ask = asked()
        self.assertTrue(p.value("document.querySelector('#answers button').disabled"))
        corners = [(0, 0), (10, 5), (20, 0)]
        for corner in ((5, 9), (6, 9)):  # a first try, which the next replaces
            p.mouse("mousePressed" if corner[0] == 5 else "mouseMoved", *to_px(*corner))
        p.mouse("mouseReleased", *to_px(6, 9))
        for i, corner in enumerate(corners):
            p.mouse("mouseMoved" if i else "mousePressed", *to_px(*corner))
        self.assertTrue(p.value("document.querySelector('#answers button').disabled"))  # while it is drawn
        p.mouse("mouseReleased", *to_px(20, 0))
        self.picture(p, "path-drawn")
        p.resize(SIZES[0])
        confirm()
        ask = asked()
        p.resize(PHONE)
        # A drawing that is longer than a message keeps its shape and its end.
        count = p.value("""(async () => {
            const hand = document.querySelector('#hand'), m = hand.getScreenCTM(), say = (type, x, y) => hand.dispatchEvent(new PointerEvent(type,
              {pointerId: 7, isPrimary: true, clientX: m.a * x + m.e, clientY: m.d * y + m.f, bubbles: true, cancelable: true}));
            hand.setPointerCapture = () => {};
            say('pointerdown', 0, 0);
            for (let i = 1; i <= 2000; i++) say('pointermove', i / 100, i % 2 ? 2 : 0);
            say('pointerup', 20, 0);
            return document.querySelector('#hand .drawn').getAttribute('points').split(' ').length / 2; })()""")
        self.assertTrue(300 <= count <= 600, count)
        confirm()
        self.assertEqual(s.end(), 0, s.said)
        drawn = [[tuple(map(float, q.split())) for q in r["response"].split(";")] for r in self.rows("01", "where") + self.rows("01", "how")]
        for [(_, x, y)], expected in zip(drawn[:3], ((12, -2), (3, 2), (11, 2))):
            self.assertLess(max(abs(x - expected[0]), abs(y - expected[1])), 0.3)
        self.assertEqual(len(drawn[3]), 3)
        for (_, x, y), expected in zip(drawn[3], corners):
            self.assertLess(max(abs(x - expected[0]), abs(y - expected[1])), 0.3)
        self.assertEqual(drawn[3][0][0], 0)
        self.assertLess(math.dist(drawn[4][-1][1:], (20, 0)), 0.5)
        self.assertEqual(p.faults(), [])

    def test_scales_with_words_at_their_ends_and_names(self):
        self.write("many.toml", BARE + toml("run", "marks", task="rate", attribute="similarity", trials=1, scale=9, labels=["very uneven", "very even"])
                   + IDENTIFY.replace("trials = 2", "trials = 1"))
        s = self.start(definition="many.toml")
        p = self.open(s)
        ask = self.walk(p)
        for run in ("scale", "names"):
            ask = self.click(p, "introduce", 1, ask)
            ask = self.asked(p, "question", ask)
            self.picture(p, run)
            if run == "scale":
                self.assertEqual(p.value("document.querySelector('#ends').innerText.split(/\\s*\\n\\s*/)"), ["very uneven", "very even"])
                self.key(p, "question", "9")
            else:
                self.assertEqual(p.value("[...document.querySelectorAll('#answers span')].map(e => e.textContent)"), ["east", "west"])
                # The pictures: where each motion ends is its arrow.
                ends = p.value("[...document.querySelectorAll('#answers .end')].map(e => e.getAttribute('transform').match(/[-.0-9]+/g).map(Number))")
                self.assertEqual([(x, angle) for x, y, angle, size in ends], [(20, 0), (0, 180)])
                self.click(p, "question", 2)
        self.assertEqual(s.end(), 0, s.said)
        self.assertEqual([r["rating"] for r in self.rows("01", "marks") if r["void"] == "false"], ["9"])
        self.assertEqual([r["response"] for r in self.rows("01", "what") if r["void"] == "false"], ["west"])

    def mark(self, p, part, ask, name):
        """Waits for a line that is newer than `ask`, and taps on it at a part of its width. Returns the number of the question."""
        ask = p.until(f"state.ask > {ask} && document.querySelector('#answers input:enabled') && state.ask")
        p.key("Enter")  # nothing is set
        p.key("Digit5", "5")
        self.assertEqual(p.value("[document.querySelector('#answers.unset button').disabled, document.querySelector('#answers output').textContent, state.ask]"),
                         [True, "", ask])
        self.picture(p, name)
        x, y, w, h = p.value("(r => [r.x, r.y, r.width, r.height])(document.querySelector('#answers input').getBoundingClientRect())")
        self.assertGreaterEqual(h, 44)
        p.tap(x + 1 + part * (w - 2), y + h / 2)
        p.until("!document.querySelector('#answers button').disabled")
        return ask

    def test_an_estimate_is_any_positive_number(self):
        self.write("sizes.toml", ESTIMATES)
        s = self.start(definition="sizes.toml")
        p = self.open(s)
        ask = self.asked(p, "introduce", self.walk(p))
        self.key(p, "introduce", " ")
        for refused, number in (("12,5", "0.5"), ("0", "12.5"), ("1e5", "1500"), ("1" * 40, "0.25")):
            ask = p.until(f"state.ask > {ask} && document.activeElement === document.querySelector('#answers input:enabled') && state.ask")
            self.assertEqual(p.value("document.querySelector('#range').textContent"), "a number above 0, with a point: 0.5, 12, 1500")
            for text in (refused, number):
                p.value("document.activeElement.select()")
                p.call("Input.insertText", text=text)
                self.assertEqual(p.value("[document.activeElement.value, document.activeElement.ariaInvalid, document.querySelector('#answers button').disabled]"),
                                 [text, str(text == refused).lower(), text == refused])
            if refused == "1e5":
                self.picture(p, "estimate")
            p.key("Enter")
        self.assertEqual(s.end(), 0, s.said)
        self.assertEqual([r["response"] for r in self.rows("01", "size")], ["0.5", "12.5", "1500", "0.25"])

    def test_numbers_and_texts_are_typed(self):
        self.write("form.toml", BARE + toml("run", "form", task="questionnaire", title="About you", text="Some questions, which nobody but us will read.") + """item = [
  { name = "age", question = "How old are you?", kind = "number", range = [18, 99] },
  { name = "free", question = "What else?", kind = "text" },
  { name = "more", question = "Nothing else?", kind = "text" },
  { name = "hand", question = "Which hand?", kind = "choice", choices = ["left", "right"] },
]
""" + toml("run", "marks", task="rate", attribute="uniformity", trials=1, scale=3))
        s = self.start(definition="form.toml")
        p = self.open(s)
        ask = self.asked(p, "questionnaire", self.walk(p))
        self.picture(p, "form")
        self.key(p, "questionnaire", " ")

        def place(kind, ask):
            return p.until(f"state.ask > {ask} && document.activeElement === document.querySelector('#answers {kind}:enabled') && state.ask")

        def is_disabled():
            return p.value("document.querySelector('#answers button').disabled")
        ask = place("input", ask)
        self.picture(p, "number")
        self.assertEqual(p.value("document.querySelector('#range').textContent"), "18–99")
        self.assertTrue(is_disabled())
        p.key("Enter")  # nothing is typed
        for text, refused in (("a1", True), ("7", True), ("2.", True), ("-18", True), ("18", False)):
            if text in ("7", "2.", "-18", "18"):
                p.value("document.activeElement.select()")
            p.call("Input.insertText", text=text)
            self.assertEqual(is_disabled(), refused, text)
        self.assertEqual(p.value("[document.querySelector('#answers input').value, state.ask]"), ["18", ask])
        p.key("Enter")
        ask = place("textarea", ask)
        self.picture(p, "text")
        p.key("Digit1", "1")  # answers nothing
        p.call("Input.insertText", text="1 2\nof äll " + "x" * 2000)  # the last do not fit
        p.click("#answers button")
        ask = place("textarea", ask)
        self.assertEqual(p.value("document.querySelector('#answers textarea').value"), "")
        p.click("#answers button")
        ask = self.asked(p, "questionnaire", ask)
        self.picture(p, "form-choice")
        p.value("document.querySelector('#answers button').dispatchEvent(new MouseEvent('click', {detail: 2}))")  # of a double click
        self.assertEqual(p.value("state.ask"), ask)
        self.assertEqual(p.value("document.querySelector('#back').textContent"), "Back")
        p.click("#back")
        ask = place("textarea", ask)
        p.key("KeyB", "b")  # is a letter there
        self.assertEqual(p.value("state.ask"), ask)
        p.click("#answers button")
        ask = self.asked(p, "questionnaire", ask)
        p.key("KeyB", "b")
        ask = place("textarea", ask)
        p.click("#answers button")
        ask = self.asked(p, "questionnaire", ask)
        ask = self.key(p, "questionnaire", "2")
        ask = self.click(p, "introduce", 1, ask)
        self.click(p, "question", 1, ask)
        self.assertEqual(s.end(), 0, s.said)
        row, = read_table(self.dir / "study/phenotype/form.tsv")
        self.assertEqual((row["age"], row["more"], row["hand"]), ("18", "n/a", "2"))
        self.assertRegex(row["free"], r"^1 2\\nof äll x{1989}$")

    def test_a_line_answers_once_it_is_set(self):
        self.write("line.toml", LINE.replace("trials = 4", "trials = 3").replace("duration = 0.2", "duration = 0.6") + "".join(
            toml("run", name, attribute="uniformity", question="How even?", trials=1, **keys) for name, keys in (
                ("steps", dict(task="rate", scale=21, labels=["not", "all"])), ("eleven", dict(task="rate", scale=11)),
                ("pairs", dict(task="choose", choices=["first", "second"])))))
        s = self.start(definition="line.toml")
        p = self.open(s)
        number = "document.querySelector('#answers output').textContent"
        ask = self.mark(p, 0, self.begin(p), "line")
        p.click("#answers button")
        ask = self.mark(p, 0.5, ask, "line")
        p.key("ArrowRight")
        self.assertEqual(p.value(number), "")
        p.key("Enter")
        ask = self.mark(p, 1, ask, "line")
        x, y = p.middle("#answers button")
        p.touch("touchStart", (1, x, y))
        p.touch("touchEnd")
        ask = self.mark(p, 0.5, self.click(p, "introduce", 1, ask), "steps")
        self.assertEqual(p.value(number), "11")
        p.key("Home")
        p.until(f"{number} === '1 not'")
        p.click("#answers button")
        # The words of a choice are where its answers will be.
        ask = self.click(p, "introduce", 1, ask)
        lit = p.until("document.querySelector('#stimuli .on')?.textContent === '2second' && document.querySelector('#playing').textContent === '2 second' && "
                      "(r => [r.x + r.width / 2, r.y + r.height / 2])(document.querySelector('#stimuli .on').getBoundingClientRect())")
        ask = self.asked(p, "question", ask)
        self.assertEqual(p.middle("#answers button:nth-child(2)"), lit)
        self.assertEqual(p.value("document.querySelector('#answers').innerText.split(/\\s+/)"), ["1", "first", "2", "second"])
        ask = self.click(p, "introduce", 1, self.key(p, "question", "2"))
        ask = self.asked(p, "question", ask)
        self.picture(p, "eleven")
        p.key("Digit1", "1")  # 1, 10 or 11?
        self.click(p, "question", 11)
        self.assertEqual(s.end(), 0, s.said)
        self.assertEqual([[r["response"] for r in self.rows("01", name) if r["void"] == "false"] for name in ("marks", "steps", "pairs", "eleven")],
                         [["0", "51", "100"], ["1"], ["2"], ["11"]])

    def test_differences_are_set_on_a_line_and_answers_are_called_right_or_wrong(self):
        self.write("apart.toml", BARE.replace("gap_s = 0.1", 'gap_s = 0.1\norder = "latin"') + toml("method", "Cedar", burst=0.02)
                   + toml("run", "apart", task="dissimilar", attribute="similarity", motions=["east"], trials=3)
                   + IDENTIFY.replace("trials = 2", "trials = 2\nfeedback = true"))
        s = self.start(definition="apart.toml")
        p = self.open(s)
        ask = self.click(p, "introduce", 1, self.walk(p))
        for share in (0, 0.25, 1):
            ask = self.mark(p, share, ask, "apart")
            self.assertEqual(p.value("document.querySelector('#answers').innerText.split('\\n').filter(t => t).slice(0, 2)"), ["The same", "As different as can be"])
            p.click("#answers button")
        ask = self.click(p, "introduce", 1, ask)
        told = []
        for _ in range(2):
            ask = self.click(p, "question", 1, ask)
            told.append(p.until("['right', 'wrong'].includes(state.screen) && [state.screen, document.body.innerText.match(/That was (right|wrong)\\./)?.[1]]"))
        self.assertEqual(s.end(), 0, s.said)
        self.assertEqual([r["response"] for r in self.rows("01", "apart")], ["0", "25", "100"])
        truth = ["right" if r["motion"] == "east" else "wrong" for r in self.rows("01", "what")]
        self.assertEqual(told, [[t, t] for t in truth])

    def test_a_comparison_is_moved_by_buttons_and_keys(self):
        self.write("equal.toml", ADJUST.replace("trials = 4", "trials = 1").replace("[-40, -22]", "[-40]"))
        s = self.start(definition="equal.toml")
        p = self.open(s)
        ask = self.asked(p, "question", self.click(p, "introduce", 1, self.walk(p)))
        self.assertRegex(p.value("document.querySelector('main').innerText"), "^You change the (first|second) one\\.\\s+Make both feel equal\\.\\s")
        self.picture(p, "adjust")
        ask = self.click(p, "question", 4)
        ask = self.key(p, "question", "3", ask)
        self.click(p, "question", 6, ask)
        self.assertEqual(s.end(), 0, s.said)
        self.assertEqual([(r["start"], r["response"], r["moves"]) for r in self.rows("01", "equal")], [("-40.000000", "-34", "2")])

    def test_thresholds_are_measured_on_it(self):
        for method in ("staircase", "adjustment"):
            s = Session(self, ("calibrate", "--participant", "01", "-o", f"{method}.toml", "-D", "null", "--tactors", "0", "--interval", "0.05",
                               "--method", method, "--display", "page"))
            p = self.open(s)
            self.asked(p, "introduce")
            self.picture(p, f"{method}-begin")
            ask = self.click(p, "introduce", 1)
            self.asked(p, "question", ask)
            self.picture(p, method)
            if method == "staircase":
                self.key(p, "question", "2", ask)
                p.until("/That was (right|wrong)/.test(document.querySelector('#text').textContent)")
                self.picture(p, "told")
                s.process.terminate()
                self.assertEqual(s.end(), 143, s.said)
                continue
            # The keyboard's focus stays on a button that is pressed again and again.
            ask = self.asked(p, "question", ask)
            p.value("document.querySelector('#answers button:nth-child(2)').focus(); document.activeElement.click()")
            self.asked(p, "question", ask)
            self.assertEqual(p.value("document.activeElement.textContent"), "2Weaker")
            for choice in (1, 3, 5, 5, 5, 5, 5, 5):  # much weaker, stronger, and the six series as they are then
                ask = self.tap(p, "question", choice, ask)
            p.until("state.screen === 'over'")
            self.assertEqual(s.end(), 0, s.said)


if __name__ == "__main__":
    main()
