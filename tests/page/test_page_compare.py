# SPDX-License-Identifier: MIT
"""The studio in a real Chromium: two methods compared by feeling, and what is felt moved. Usage: test_page_compare.py TOOL SOURCE_ROOT"""
import json
import math
import sys

del sys.argv[3:]
from studio import TAKE, StudioTest, quoted  # noqa: E402
from harness import main  # noqa: E402

TEXT = "document.querySelector('{}').textContent"


class Compare(StudioTest):
    def compare(self, s):
        """Returns a page that compares the methods of an example, and a client."""
        p, watcher = self.ready(s)
        self.add_example(p)
        p.until(f"tactor.state.plan_of && tactor.state.plan_of === {TAKE}")
        self.watch_sent(p)
        p.key("KeyB", "b")
        p.until("tactor.state.playing?.numbers.size === 2 && !tactor.state.playing.waits && tactor.state.compare.rest")
        return p, watcher

    def test_two_methods_loop_in_step_and_one_of_them_sounds(self):
        s = self.serve()
        p, watcher = self.compare(s)
        p.value("tactor.state.level_db = -6; tactor.changed('level')")
        p.until("sent.some(m => m.db === -6 && m.stroke)")
        asker = s.client()
        a, b = p.value("tactor.state.playing.firsts")
        asker.ok("subscribe", events=["levels"], levels_hz=100)
        loudest, since = -100, asker.notification(lambda m: m["method"] == "levels")["params"]["t_s"]
        for key, stroke in ("2", b), ("1", a), ("2", b):
            # The moment stands still until a round sounds, and a round that ends begins anew.
            at_s = p.until(f"""(t => t > 0.1 && t < 1.2 && (sent.length = 0, globalThis.pressed = performance.now(),
                dispatchEvent(new KeyboardEvent('keydown', {{key: '{key}'}})), t))(tactor.state.at_s)""")
            # The page lowers all before it raises the other one.
            low, high = p.until("(all => (i => i >= 0 && all[i + 1] && all.slice(i, i + 2))(all.findIndex(m => m.db === -60)))(sent.filter(m => m.method === 'level'))")
            self.assertEqual((low["db"], low.get("stroke"), high["db"], high["stroke"]), (-60, None, -6, stroke))
            self.assertLess(high["ms"] - p.value("pressed"), 500)  # 70 ms at most, and what a busy machine adds
            self.assertGreaterEqual(high["at_s"], at_s)  # it goes on where it was
            p.until(f"document.querySelector('.side[aria-pressed=true] kbd').textContent === {quoted(key)}")
        # It loops, and the sum is never above the level, 6 dB below the ceiling of -12 dBFS.
        self.assertEqual(p.value("[...tactor.state.playing.numbers]"), [a, b])
        t = since
        while t < since + 2.5:
            levels = asker.notification(lambda m: m["method"] == "levels")["params"]
            t = levels["t_s"]
            loudest = max([loudest, *(v for v in levels["dbfs"] if v is not None)])
        self.assertLess(loudest, -17.9)
        self.assertGreater(loudest, -24)
        # A stop before the change stays one.
        p.value("['1', ' '].forEach(key => dispatchEvent(new KeyboardEvent('keydown', {key})))")
        p.until("tactor.state.compare.on === 0")
        self.assertIsNone(p.value("tactor.state.playing"))
        p.key("Escape", "Escape")
        p.until("!tactor.state.compare && !tactor.state.playing && document.querySelector('#compare').hidden")
        self.assertEqual(p.value("sent.findLast(m => m.method === 'level')")["db"], -6)

    def test_both_ribbons_are_drawn_and_settings_are_those_of_the_side_that_sounds(self):
        p, _ = self.compare(self.serve())
        p.key("Digit2", "2")
        p.until("tactor.state.compare.on === 1")
        p.value("document.querySelector('[data-value=continuous]').click()")
        p.until(f"{TEXT.format('.side:nth-child(2)')}.includes('Continuous') && /mm from the path, (slightly )?(un)?even/.test({TEXT.format('.side:nth-child(2)')})")
        self.assertIn("Park 2016", p.value(TEXT.format(".side")))
        self.assertEqual(self.take(p)["options"], {})
        p.until("tactor.state.plan.continuous && !tactor.state.compare.rest.continuous")
        rows = p.value("[tactor.state.plan, tactor.state.compare.rest].map(x => x.felt_rows[0].length)")
        self.assertTrue(all(rows))

    def test_a_blind_comparison_counts_and_reveals(self):
        p, _ = self.compare(self.serve())
        p.click("#blind")
        p.until("document.body.hasAttribute('data-blind')")
        self.assertNotIn("Park", p.value("document.querySelector('#compare').innerText"))
        for i in range(3):
            p.until("tactor.state.compare.heard.size === 1")
            p.until("document.querySelector('#votes button').disabled")
            p.key("Digit2", "2")
            p.until("!document.querySelector('#votes button').disabled")
            card = p.value("tactor.state.compare.order.indexOf(0)")
            p.click(f"#votes button:nth-child({3 if i == 2 else card + 1})")
            p.until(f"tactor.state.compare.answers.length === {i + 1}")
        p.until(f"{TEXT.format('#tally')} === '2 of 3 for the same one; too few for a result'")
        p.click("#blind")
        p.until(f"{TEXT.format('#tally')}.startsWith('2 of 3 for Park 2016')")

    def test_what_one_side_cannot_play_is_said_in_words_beside_the_bar(self):
        p, _ = self.ready(self.serve())
        self.choose_files(p, {"flick.csv": "t_s,x_mm,y_mm\n0,0,0\n0.06,40,40\n"})
        self.planned(p)
        for size in ((1440, 900), (390, 844)):
            p.resize(size)
            p.key("KeyB", "b")
            text = p.until("tactor.state.compare && !document.querySelector('#banner').hidden && document.querySelector('#banner-text').textContent")
            self.assertRegex(text, r"^[A-Z“].*\.$")
            self.assertNotRegex(text, "options|toml|_")
            bottom, top = p.value("[document.querySelector('#compare').getBoundingClientRect().bottom, document.querySelector('#banner').getBoundingClientRect().top]")
            self.assertGreaterEqual(top, bottom)
            p.click("#compare-end")
            p.until("!tactor.state.compare")
            p.click("#banner-close")
            p.until("document.querySelector('#banner').hidden")

    def study(self, p, count):
        """Saves a study of what is compared; returns the folder of its files, `count` of them."""
        p.open_popover("#study-open", "#p-study")
        folder = self.dir / "study"
        folder.mkdir()
        p.browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(folder), eventsEnabled=True)
        since = len(p.browser.events)
        p.value("document.querySelector('#study [name=question]').value = 'Which \"one\"?'")
        p.click("#study button")
        while sum(e.get("method") == "Browser.downloadProgress" and e["params"]["state"] == "completed" for e in p.browser.events[since:]) < count:
            p.browser.await_event(len(p.browser.events), lambda e: True)
        return folder

    def runs(self, folder):
        """Lets the tool plan the study of a folder; returns its definition."""
        r = self.run_tool("experiment", folder / "two-methods.toml", "--dry-run", "--format", "json")
        self.assertEqual(r.returncode, 0, r.stderr)
        return (folder / "two-methods.toml").read_text()

    def test_a_study_of_it_runs(self):
        p, _ = self.compare(self.serve())
        text = self.runs(self.study(p, 3))
        self.assertEqual(p.value(TEXT.format("#study-command")), "tactor experiment two-methods.toml --participant P01 -o results -D array")
        for line in ('question = "Which \\"one\\"?"', 'name = "park2016"', 'name = "tactile-brush"', f"name = {quoted(self.take(p)['name'])}"):
            self.assertIn(f"{line}\n", text)

    def test_a_study_has_every_stroke_and_the_array_that_was_drawn_on(self):
        # A row of five, which no preset is; a limit, a gain and thresholds are the owner's.
        tactors = [{"x_mm": 15 * i, "y_mm": 0, "channel": 4 - i, "gain_db": -2, "max_dbfs": -3.5, "polarity": -1, "threshold_dbfs": [[100, -50], [250, -55.25]]}
                   for i in range(5)]
        own = self.write("row.toml", '[array]\nname = "palm-like \\"row\\""\n' + "".join(
            "[[tactor]]\n" + "".join(f"{k} = {json.dumps(v)}\n" for k, v in t.items()) for t in tactors))
        p, _ = self.ready(self.serve("--array", own))
        self.choose_files(p, {"both.toml": "[[stroke]]\nname = 'there'\npath = 'M 0 0 L 60 0'\nlevel_db = -6\n[[stroke]]\nname = 'there'\npath = 'M 60 0 L 0 0'\nlevel_db = -6\nstart_s = 2\n"})
        p.until("tactor.state.takes.length === 1")
        p.key("KeyB", "b")
        p.until("tactor.state.compare")
        folder = self.study(p, 4)
        text = self.runs(folder)
        self.assertEqual({f.name for f in folder.iterdir()}, {f"two-methods{end}.toml" for end in ("", "-array", "-stroke-1", "-stroke-2")})
        for name, file in (("there", "two-methods-stroke-1.toml"), ("there 2", "two-methods-stroke-2.toml")):
            self.assertIn(f'[[motion]]\nname = "{name}"\nfile = "{file}"\n', text)
            self.assertIn("level_db = -6\n", (folder / file).read_text())
        # The tool finds the same array in both files.
        found = [json.loads(self.ok("plan", folder / "two-methods-stroke-1.toml", "--array", a, "--format", "json").stdout)["array"]
                 for a in (own, folder / "two-methods-array.toml")]
        self.assertEqual(*found)
        self.assertEqual(found[0]["tactors"][0]["threshold_dbfs"], tactors[0]["threshold_dbfs"])


class Felt(StudioTest):
    def diamonds(self, p):
        p.until(f"tactor.state.plan_of === {TAKE} && tactor.felt_points().length")
        return [[q["x"], q["y"]] for q in p.value("tactor.felt_points()")]

    def pull(self, p, start, end):
        p.value("document.querySelector('#toast').textContent = ''")
        p.mouse("mouseReleased", *self.press(p, start, end))
        p.until("/mm/.test(document.querySelector('#toast').textContent)")
        return p.value("document.querySelector('#toast').textContent")

    def felt(self):
        """Returns a page with an example and the tool Felt."""
        p, _ = self.ready(self.serve())
        self.add_example(p)
        p.until("tactor.state.takes.length")
        p.key("KeyW", "w")
        p.until("tactor.state.tool === 'felt'")
        return p

    def test_a_diamond_is_felt_where_it_is_put(self):
        p = self.felt()
        points, before = self.diamonds(p), p.value(f"JSON.stringify({TAKE}.strokes[0].timed)")
        at = len(points) // 2
        wish = [points[at][0] + 2, points[at][1] - 2]
        self.assertIn("Felt here, within", self.pull(p, points[at], wish))
        for a, b in zip(self.diamonds(p)[at], wish):
            self.assertAlmostEqual(a, b, delta=0.3)
        p.until("document.querySelector('#shape-curve').textContent === 'Edited, 1 point'")
        # Keys do the same. Each is one step.
        p.key("ArrowLeft", "ArrowLeft")
        p.until(f"tactor.felt_points()[{at}].x < {wish[0] - 0.4}")
        for _ in range(2):
            p.click("#undo")
        p.until(f"JSON.stringify({TAKE}.strokes[0].timed) === {quoted(before)}")
        p.click("#redo")
        p.until("!document.querySelector('#shape').hidden")
        # Undone before its first plan came, a move stays undone.
        self.diamonds(p)
        moved = p.value(f"JSON.stringify({TAKE}.strokes[0].timed)")
        p.value("""document.querySelector('#field').dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowLeft'}));
                   document.querySelector('#undo').click()""")
        self.diamonds(p)
        self.assertEqual(p.value(f"[JSON.stringify({TAKE}.strokes[0].timed), document.querySelector('#redo').disabled]"), [moved, False])
        p.click("#shape-ink")
        p.until("document.querySelector('#shape-ink').getAttribute('aria-pressed') === 'true'")

    def test_fewer_points_stay_within_their_tolerance_of_the_ink(self):
        p, _ = self.ready(self.serve())
        self.draw(p, *[[20 + 15 * math.cos(a / 10), 20 + 12 * math.sin(a / 5)] for a in range(64)])
        p.until(f"{TAKE}")
        p.click("[data-tool=points]")
        p.until("document.querySelector('#fit-mm').checkVisibility()")
        counts = []
        for mm in (0.2, 1, 2):
            p.value(f"(() => {{ const e = document.querySelector('#fit-mm'); e.value = {mm}; e.dispatchEvent(new Event('input')); }})()")
            p.until(f"document.querySelector('#shape-curve').textContent.endsWith('points, within {mm} mm')")
            counts.append(p.value(f"{TAKE}.strokes[0].knots.length"))
            off = p.value(f"""(() => {{ const {{base, timed}} = {TAKE}.strokes[0], to = (q, rows) => Math.min(...rows.slice(1).map((b, i) => {{
                    const a = rows[i], d = [b[1] - a[1], b[2] - a[2]], part = ((q[1] - a[1]) * d[0] + (q[2] - a[2]) * d[1]) / (d[0] ** 2 + d[1] ** 2 || 1), u = Math.min(1, Math.max(0, part));
                    return Math.hypot(a[1] + u * d[0] - q[1], a[2] + u * d[1] - q[2]); }}));
                return Math.max(...base.map(q => to(q, timed))); }})()""")
            self.assertLessEqual(off, mm + 0.05)
        self.assertGreater(counts[0], counts[1])
        self.assertGreaterEqual(counts[1], counts[2])

    def test_a_place_that_cannot_be_felt_says_how_near_it_comes(self):
        p = self.felt()
        points = self.diamonds(p)
        at = len(points) // 2
        self.assertRegex(self.pull(p, points[at], [-6, points[at][1]]), r"Cannot be felt there: [6-9]\.\d mm away at best")
        self.assertEqual(p.value("tactor.state.outside.length"), 0)


if __name__ == "__main__":
    main()
