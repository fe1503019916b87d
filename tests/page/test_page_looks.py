# SPDX-License-Identifier: MIT
"""The looks of the studio in a real Chromium, in each state, size and theme. Usage: test_page_looks.py TOOL SOURCE_ROOT [FOLDER_FOR_PICTURES]"""
import json
import pathlib
import re
import sys
import unittest

PICTURES = pathlib.Path(sys.argv.pop(3)).resolve() if len(sys.argv) > 3 else None
from studio import ARRAY, DARK, LIVE, MISSING, SIZES, TAKE, StudioTest  # noqa: E402
from browser import AXE  # noqa: E402
from harness import ROOT, main  # noqa: E402


class Drawn(StudioTest):
    def drawn(self, s):
        """Returns a page with a take that leaves the array, and a client that watches what plays."""
        p, watcher = self.ready(s)
        self.draw(p, *self.way([5, 5], [35, 12]), *self.way([35, 12], [8, 30]), *self.way([8, 30], [48, 36]))
        p.until("document.querySelector('#warnings').textContent.includes('outside')")
        self.planned(p)
        return p, watcher


class Looks(Drawn):
    """Each state in each size, light and dark: within the screen, Stop to be seen, nothing that axe-core finds."""

    @unittest.skipUnless(AXE, "axe-core is not there (tests/lanes/page gets it)")
    def test_axe_core_is_there(self):
        pass

    def look(self, p, name, sizes=SIZES):
        for size in sizes:
            p.resize(size)
            p.call("Emulation.setTouchEmulationEnabled", enabled=size[0] < 1100, maxTouchPoints=5)
            for theme in ("light", "dark"):
                p.call("Emulation.setEmulatedMedia", features=DARK if theme == "dark" else [])
                p.until(f"document.documentElement.dataset.theme === '{theme}'")
                p.frames()
                p.until("document.getAnimations().length === 0")
                picture = f"{name}-{size[0]}x{size[1]}-{theme}"
                if PICTURES:
                    p.picture(PICTURES / f"studio-{picture}.png")
                with self.subTest(picture=picture):
                    self.assertEqual(p.value("[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"), list(size))
                    self.assertEqual(p.element_at(*p.middle("#stop")), "stop")
                    if AXE:
                        self.assertEqual(p.axe_findings(), [])
        p.call("Emulation.setTouchEmulationEnabled", enabled=False)
        p.resize(SIZES[0])
        p.until(f"innerWidth === {SIZES[0][0]} && (f => f.clientHeight === f.parentElement.clientHeight)(document.querySelector('#field'))")

    def pretend(self, p, **values):
        """Lets the state say what no test can bring about with a device that is none."""
        for name, v in values.items():
            p.value(f"Object.defineProperty(tactor.state, '{name}', {{get: () => ({v}), set() {{}}}}), tactor.changed('link', 'stream')")

    def test_running(self):
        p, _ = self.ready(self.serve())
        self.look(p, "empty")
        p.click("#hint-example")
        p.until("tactor.state.takes.length && !tactor.state.playing")
        self.planned(p)
        self.look(p, "take")

    def test_a_moment_of_the_gallery(self):
        """studio-moment-1440x900-light.png of the pictures is examples/studio.png, which README and the guide show."""
        p = self.open(self.serve())
        self.await_service(p)
        self.add_example(p)
        self.planned(p)
        # The figures are those of the tool; a burst holds its place for one SOA, so the lag is half of it.
        found = json.loads(self.ok("compare", self.saved(p, "toml"), "--array", "palm-3x3", "--algorithms", "park2016", "--format", "json").stdout)["results"][0]
        self.assertEqual(p.value("[...document.querySelectorAll('#predicted .tile > *')].map(e => e.textContent)"),
                         [f"{found['rms_to_path_mm']:.1f}mm", f"on the pathlate by {1000 * found['soa_s'] / 2:.0f} ms", f"{found['speed_cv']:.2f}CV", "uneven speed"])
        p.until("!document.querySelector('#toast').classList.contains('on')")
        p.value("tactor.state.at_s = 0.99, tactor.changed('moment')")
        self.look(p, "moment", (*SIZES, (1024, 768)))

    def test_a_take_with_a_warning_and_its_points(self):
        p, _ = self.drawn(self.serve())
        self.look(p, "warning")
        p.click("[data-tool=points]")
        knot = self.take(p)["strokes"][0]["knots"][3]
        p.mouse("mouseReleased", *self.press(p, [knot["x"], knot["y"]], [knot["x"] - 4, knot["y"] + 2]))
        p.until("!document.querySelector('#points').hidden")
        self.planned(p)
        self.look(p, "points")

    def test_arrays_of_all_shapes(self):
        for file in sorted((ROOT / "examples/arrays").glob("*.toml")):
            with self.subTest(array=file.stem):
                text = re.sub(r"\[amplifier\][^[]*", "", file.read_text(encoding="utf-8"))  # this machine has none
                s = self.serve("--array", self.write(file.name, text), "--socket", self.dir / f"{file.stem}.sock")
                p = self.open(s)
                p.until("tactor.state.link === 'connected' && tactor.state.options.length")
                tactors = [[t["x_mm"], t["y_mm"]] for t in p.value("tactor.state.hello.array.tactors")]
                self.draw(p, *self.way(tactors[0], tactors[len(tactors) // 2]), *self.way(tactors[len(tactors) // 2], tactors[-1]))
                p.until(f"tactor.state.plan_of === {TAKE} || tactor.state.plan_fault")
                self.assertIsNone(p.value("tactor.state.plan_fault"))
                self.look(p, f"array-{file.stem}", SIZES[::2])

    def test_panes_and_sheets(self):
        p, _ = self.drawn(self.serve())
        for tab in ("method", "timing", "vibration"):
            p.value(f"document.querySelector('[data-tab={tab}]').click(), document.querySelector('#settings').click()")
            p.until(f"document.querySelector('[data-tab={tab}]').getAttribute('aria-selected') === 'true'")
            self.look(p, f"pane-{tab}")
            p.value("for (const d of document.querySelectorAll('#pane details')) d.open = true; document.querySelector('#sheet-close').click()")
            self.look(p, f"pane-{tab}-more", SIZES[:1])
        for sheet in ("time", "takes"):
            p.value(f"document.querySelector('button[data-sheet={sheet}]').click()")
            self.look(p, f"sheet-{sheet}", SIZES[2:])

    def test_popovers(self):
        p, _ = self.drawn(self.serve())
        for name in ("device", "others", "share", "save", "more", "keys"):
            p.value(f"document.querySelector('#p-{name}').showPopover()")
            p.until(f"document.querySelector('#p-{name}').matches(':popover-open')")
            self.look(p, f"popover-{name}")
        p.value("document.querySelector('#p-keys').hidePopover(); document.querySelector('.more-button').click()")
        self.look(p, "popover-take", SIZES[:1])

    def test_playing_and_drawing(self):
        s = self.serve()
        p, watcher = self.drawn(s)
        p.value("document.querySelector('#loop').click(); document.querySelector('#play').click()")
        self.next_stroke(watcher, "started")
        p.until("tactor.state.playing && tactor.state.at_s > 0.02")
        self.look(p, "playing")
        p.click("#stop")
        p.until("!tactor.state.playing")
        self.look(p, "stopped")
        last = self.press(p, *self.way([5, 35], [30, 10]))
        p.until("tactor.state.drawing && tactor.state.plan?.felt.length")
        self.look(p, "drawing", SIZES[:1])
        p.mouse("mouseReleased", *last)

    def test_someone_plays(self):
        s = self.serve()
        p, _ = self.drawn(s)
        phone = self.other(s, "A phone")
        number = phone.ok("begin", options=LIVE, timeout_s=86400)["stroke"]
        phone.ok("to", stroke=number, x_mm=12, y_mm=14)
        p.until("tactor.state.touches.size && tactor.state.status.who.some(w => w.name === 'A phone')")
        self.pretend(p, touches=f"new Map([[1, {{client: tactor.state.status.who.find(w => w.name === 'A phone').client, x_mm: 12, y_mm: 14, at: performance.now()}}]])",
                     status=p.value("JSON.stringify(tactor.state.status)").replace('"strokes":[]', '"strokes":[{"stroke":1,"state":"started","client":0}]'))
        self.look(p, "other", SIZES)

    def test_devices(self):
        p = self.open(self.serve(device=MISSING))
        self.says(p, "Simulated")
        p.until("document.querySelectorAll('#examples li').length && !document.querySelector('#hint').hidden")
        self.look(p, "no-card")
        p.value("document.querySelector('#gallery-open').click()")
        self.look(p, "gallery")
        p.value("document.querySelector('#tour-open').click()")
        self.look(p, "tour")

    def test_streams_that_break(self):
        p, _ = self.drawn(self.serve())
        self.pretend(p, stream='{state: "muted", reason: "2 xruns within a second"}')
        self.says(p, "Muted")
        self.look(p, "muted")
        self.pretend(p, slow="true")
        self.says(p, "No answer")
        self.look(p, "no-answer")

    def test_card_lost(self):
        p, _ = self.drawn(self.serve())
        self.pretend(p, stream='{state: "lost", reason: "No such device"}')
        p.value("tactor.state.hello.stream.format ??= 'S32_LE', tactor.changed('link')")
        self.says(p, "Card lost")
        self.look(p, "card-lost")

    def test_no_connection(self):
        s = self.serve()
        p, _ = self.drawn(s)
        s.kill()
        self.says(p, "No connection")
        self.look(p, "no-connection")

    def test_locked(self):
        p = self.open(self.serve(config=self.token("secret")), "#token=guess")
        self.banner(p, "token is wrong")
        self.look(p, "locked")


class Shapes(Drawn):
    """In each shape of window the canvas keeps half of the height, and nothing lies on the transport."""
    SHAPES = ((1440, 900), (1366, 768), (1280, 600), (1100, 700), (1093, 614), (1024, 768), (960, 540), (899, 900), (820, 1180),
              (768, 1024), (600, 960), (600, 501), (390, 844), (844, 390), (360, 640))
    # Buttons on which something lies, or that are cut off.
    COVERED = """[...document.querySelectorAll(".transport button, #level input, .tools button, #locator")].filter(b => b.checkVisibility() && !b.disabled).filter(b => {
        const r = b.getBoundingClientRect();
        return [[0.5, 0.5], [0.05, 0.2], [0.95, 0.8]].some(([x, y]) => !b.contains(document.elementFromPoint(r.x + x * r.width, r.y + y * r.height)));
    }).map(b => b.id || b.type)"""

    def resize(self, p, size, touch):
        p.resize(size)
        p.call("Emulation.setTouchEmulationEnabled", enabled=touch, maxTouchPoints=5)
        p.until(f"innerWidth === {size[0]} && innerHeight === {size[1]} && matchMedia('(pointer: coarse)').matches === {str(touch).lower()}"
                " && (f => f.clientHeight === f.parentElement.clientHeight)(document.querySelector('#field'))")
        p.frames()

    # Tactors of which a part lies under something, or under a toast.
    HIDDEN = """(toast => { toast.textContent = "Undone, and a text of some length"; toast.classList.add("on");
        const r = toast.getBoundingClientRect(), found = tactor.state.hello.array.tactors.filter(t => [[0, 0], [4, 0], [-4, 0], [0, 4], [0, -4]].some(([dx, dy]) => {
            const [x, y] = tactor.place_in_page([t.x_mm + dx, t.y_mm + dy]);
            return document.elementFromPoint(x, y)?.id !== "field" || x > r.left && x < r.right && y > r.top && y < r.bottom; })).map(t => t.tactor ?? t.channel);
        toast.classList.remove("on"); return found; })(document.querySelector("#toast"))"""

    # True if the pill with the error lies on the words about the take.
    PILL_ON_WORDS = """(pill => { const q = pill.getBoundingClientRect(), words = document.createRange();
        words.selectNodeContents(document.querySelector(".title"));
        return pill.checkVisibility() && [...words.getClientRects()].some(r => r.right > q.left && r.left < q.right && r.bottom > q.top && r.top < q.bottom);
    })(document.querySelector("#pill"))"""

    def test_the_canvas_keeps_half_of_the_height(self):
        p, _ = self.drawn(self.serve())
        p.click("[data-tool=points]")
        knot = self.take(p)["strokes"][0]["knots"][3]
        p.mouse("mouseReleased", *self.press(p, [knot["x"], knot["y"]], [knot["x"] - 2, knot["y"] + 2]))
        p.until("!document.querySelector('#shape').hidden")
        p.click("[data-tool=draw]")
        for touch in (False, True):
            for size in self.SHAPES:
                self.resize(p, size, touch)
                for unfolded in (False, True) if p.value("document.querySelector('#time-fold').checkVisibility()") else (False,):
                    if unfolded:
                        p.key("KeyT", "t")
                        p.until("'timeOpen' in document.body.dataset")
                        self.resize(p, size, touch)
                    name = f"{size[0]}x{size[1]}{'-touch' if touch else ''}{'-unfolded' if unfolded else ''}"
                    if PICTURES:
                        p.picture(PICTURES / f"shape-{name}.png")
                    with self.subTest(shape=name):
                        self.assertGreaterEqual(p.value("document.querySelector('#field').clientHeight / innerHeight"), 0.5)
                        self.assertEqual(p.value("[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"), list(size))
                        self.assertEqual(p.value(self.COVERED), [])
                        self.assertGreaterEqual(p.value("document.querySelector('#level').offsetHeight"), 56)
                        self.assertTrue(p.value("document.querySelector('#level').checkVisibility()"))
                        self.assertEqual(p.value(self.HIDDEN), [])
                        self.assertFalse(p.value(self.PILL_ON_WORDS))
                    if unfolded:
                        p.key("KeyT", "t")
                        p.until("!('timeOpen' in document.body.dataset)")

    # Buttons and discs of tactors that the hint covers, and discs that are not on the stage.
    UNDER_THE_HINT = """(hint => { const q = hint.getBoundingClientRect(), stage = document.querySelector("#stage").getBoundingClientRect();
        const is_under = r => r.left < q.right && r.right > q.left && r.top < q.bottom && r.bottom > q.top;
        const {tactors} = tactor.state.hello.array, r_mm = 0.215 * 20, discs = tactors.map(t => {
            const [[left, top], [right, bottom]] = [-r_mm, r_mm].map(d => tactor.place_in_page([t.x_mm + d, t.y_mm + d]));
            return {name: t.tactor, left, top, right, bottom}; });
        return [...[...document.querySelectorAll("button, input")].filter(b => !hint.contains(b) && b.checkVisibility({visibilityProperty: true})
            && is_under(b.getBoundingClientRect())).map(b => b.id || b.textContent), ...discs.filter(d => is_under(d) || d.left < stage.left
            || d.right > stage.right || d.top < stage.top || d.bottom > stage.bottom).map(d => d.name)]; })(document.querySelector("#hint"))"""

    def test_the_first_words_lie_on_no_tactor_and_no_button(self):
        for device in (MISSING, ARRAY):
            p = self.open(self.serve("--socket", self.dir / f"{device[1][:2]}.sock", device=device))
            p.until("tactor.state.link === 'connected' && document.querySelector('#hint').checkVisibility()")
            for touch in (False, True):
                for size in ((1440, 900), (1024, 768), (960, 540), (844, 390), (390, 844)):
                    self.resize(p, size, touch)
                    with self.subTest(size=size, touch=touch, device=device[1]):
                        if PICTURES:
                            p.picture(PICTURES / f"hint-{size[0]}x{size[1]}{'-touch' if touch else ''}-{device[1][:2]}.png")
                        self.assertTrue(p.value("document.querySelector('#hint').checkVisibility()"))
                        self.assertEqual(p.value(self.UNDER_THE_HINT), [])
                        self.assertLessEqual(p.value("document.querySelector('#hint').getBoundingClientRect().bottom - document.querySelector('#stage').getBoundingClientRect().bottom"), 0)

    def test_nothing_is_lost_in_forced_colours(self):
        p, _ = self.drawn(self.serve())
        p.call("Emulation.setEmulatedMedia", features=[{"name": "forced-colors", "value": "active"}])
        p.frames()
        style = "getComputedStyle(document.querySelector('{}'), '{}').{}"
        ground = p.value(style.format(".time", "", "backgroundColor"))
        for element in (".moment", ".groove i"):
            self.assertNotIn(p.value(style.format(element, "", "backgroundColor")), (ground, "rgba(0, 0, 0, 0)"), element)
        self.assertTrue(p.value("document.querySelector('#level input').checkVisibility()"))
        self.assertIn("gradient", p.value(style.format(".beyond", "", "backgroundImage")))

    def test_settings_with_a_warning_show_the_settings(self):
        p, _ = self.drawn(self.serve())
        for size, touch in (((1024, 768), True), ((960, 540), False), ((1093, 614), False), ((820, 1180), True), ((600, 501), False),
                            ((390, 844), True), ((360, 640), True), ((844, 390), True)):
            self.resize(p, size, touch)
            if p.value("document.querySelector('#settings').checkVisibility() && document.body.dataset.sheetOpen !== 'inspector'"):
                p.click("#settings")
                p.until("document.querySelector('#tabs').checkVisibility()")
                p.until("document.getAnimations().length === 0")
            for theme in ("light", "dark"):
                p.call("Emulation.setEmulatedMedia", features=DARK if theme == "dark" else [])
                p.until(f"document.documentElement.dataset.theme === '{theme}'")
                p.frames()
                name = f"{size[0]}x{size[1]}-{theme}"
                if PICTURES:
                    p.picture(PICTURES / f"settings-{name}.png")
            with self.subTest(shape=name):
                # The tabs and the head of the chosen method are on the screen, above the level.
                self.assertTrue(p.value("""[document.querySelector("#tab-method"), document.querySelector(".warning button"),
                    document.querySelector("#pane .cards [aria-checked=true] b")].every(e => { const r = e.getBoundingClientRect();
                    return e.contains(document.elementFromPoint(r.x + r.width / 2, r.y + r.height / 2)); })"""))


if __name__ == "__main__":
    main()
