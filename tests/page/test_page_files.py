# SPDX-License-Identifier: MIT
"""The studio's files in a real Chromium: from a drawing to the file that the tool renders, and files that are opened.
Usage: test_page_files.py TOOL SOURCE_ROOT"""
import base64
import json
import sys

del sys.argv[3:]
from studio import TAKE, StudioTest, quoted  # noqa: E402
from harness import main  # noqa: E402

DROP = """(() => { const d = new DataTransfer(); d.items.add(new File([%s], %s));
    for (const kind of ["dragenter", "drop"]) document.querySelector("#field").dispatchEvent(new DragEvent(kind, {dataTransfer: d, bubbles: true, cancelable: true})); })()"""

LINE = "t_s,x_mm,y_mm\n0,0,0\n0.2,40,40\n"


class FromDrawingToFile(StudioTest):
    def test_three_fingers_edited_fitted_heard_saved_reloaded_and_played(self):
        s = self.serve()
        p, watcher = self.ready(s, fingers=True)
        rows = (5, 20, 52)  # the last beyond the array
        self.fingers(p, "touchStart", *([5, y] for y in rows))
        for x in range(8, 36, 3):
            self.fingers(p, "touchMove", *([x, y - (x > 20)] for y in rows))
        p.touch("touchEnd")
        p.until("tactor.state.takes.length === 1")
        for _ in rows:
            self.next_stroke(watcher, "finished")

        # Edited by a point.
        before = self.take(p)["strokes"][0]
        knot = before["knots"][1]
        self.edit_point(p, [knot["x"], knot["y"]], [knot["x"], knot["y"] + 6])
        edited = p.until(f"{TAKE}.strokes[0].knots[1].y > {knot['y'] + 5} && {TAKE}")["strokes"]
        self.assertNotEqual(edited[0]["timed"], before["timed"])
        self.assertEqual(edited[1:], self.take(p)["strokes"][1:])

        # Fitted, and weaker where three strokes meet.
        p.until("document.querySelector('#warnings').textContent.includes('outside the array')")
        self.mend(p, "Fit to array")
        p.until(f"{TAKE}.strokes.every(s => s.timed.every(q => q[2] > -0.1 && q[2] < 40.1))")
        p.until("document.querySelector('#warnings').textContent.includes('dB weaker')")

        # Heard by loudspeakers, too.
        p.value("""globalThis.heard = 0; for (const name of ["start"]) { const was = OscillatorNode.prototype[name];
            OscillatorNode.prototype[name] = function (...a) { ++heard; return was.apply(this, a); }; }""")
        p.click("#speaker")
        p.click("#play")
        for _ in rows:
            self.next_stroke(watcher, "started")
        p.until("heard")
        for _ in rows:
            self.next_stroke(watcher, "finished")
        p.until("!tactor.state.playing")
        self.assertEqual(p.value("heard"), 1)  # begun once, when the strokes sounded

        # Saved.
        toml, wav = self.saved(p, "toml"), self.saved(p, "wav")
        self.write(toml.name, toml.read_bytes())
        kept = self.take(p)

        # The page is loaded again: what was drawn is there, and plays.
        self.reload(p)
        p.until("!document.querySelector('#play').disabled")
        self.assertEqual(self.take(p), kept)
        self.assertEqual(self.names(p), [kept["name"]])
        p.click("#play")
        for _ in rows:
            self.next_stroke(watcher, "started")
        for _ in rows:
            self.next_stroke(watcher, "finished")

        # The tool makes the same bytes of the saved file.
        self.ok("render", toml.name, "--outside", "clamp", "--level-dbfs", p.value("tactor.state.hello.max_level_dbfs + tactor.state.level_db"), "-o", "rendered.wav")
        self.assertEqual((self.dir / "rendered.wav").read_bytes(), wav.read_bytes())
        self.assertGreater(len(wav.read_bytes()), 1000)

    def test_all_kinds_of_files_are_saved(self):
        p, _ = self.ready(self.serve())
        self.draw(p, *self.way([5, 5], [35, 30]))
        heads = {"toml": b"[stroke]", "csv": b"t_s,x_mm,y_mm", "svg": b"<?xml", "png": b"\x89PNG", "pdf": b"%PDF", "wav": b"RIFF", "json": b"{", "haptic": b"{"}
        self.assertEqual(set(p.value("[...document.querySelectorAll('#p-save [data-kind]')].map(b => b.dataset.kind)")), set(heads))
        for kind, head in heads.items():
            with self.subTest(kind=kind):
                file = self.saved(p, kind)
                self.assertEqual(file.name, f"take-1.{kind}")
                self.assertTrue(file.read_bytes().lstrip().startswith((head, b"<svg") if kind == "svg" else head), file.read_bytes()[:40])

    def test_a_name_of_any_language_is_the_file_s(self):
        p, _ = self.ready(self.serve())
        self.draw(p, *self.way([5, 5], [35, 30]))
        for name, file in (("Übung größer", "übung-größer.toml"), ("触覚 1", "触覚-1.toml"), ("../a: µ\u202eb", "a-b.toml"), ("-?", "take.toml"), ("あ" * 60, "あ" * 30 + ".toml")):
            with self.subTest(name=name):
                p.value(f"tactor.rename({TAKE}.id, {quoted(name)})")
                self.assertEqual(self.saved(p, "toml").name, file)

    def test_a_table_is_not_offered_for_several_strokes(self):
        p, _ = self.ready(self.serve())
        for strokes, hidden in ((1, False), (2, True)):
            text = "[[stroke]]\npath = 'M 5 5 L 35 5'\n" * strokes
            p.value(DROP % (quoted(text), quoted("some.toml")))
            p.until(f"{TAKE}?.strokes.length === {strokes}")
            p.click("#save")
            p.until(f"document.querySelector('#p-save').matches(':popover-open') && document.querySelector('[data-kind=csv]').hasAttribute('hidden') === {str(hidden).lower()}")
            p.value("document.querySelector('#p-save').hidePopover()")

    def test_a_figure_opens_as_its_take_or_is_named(self):
        p, _ = self.ready(self.serve())
        self.draw(p, *self.way([5, 5], [35, 30]))
        drawn = self.take(p)["strokes"][0]
        figure = self.saved(p, "svg").read_text()
        p.value(DROP % (quoted(figure), quoted("figure.svg")))
        p.until("tactor.state.takes.length === 2")
        self.assertEqual(self.take(p)["strokes"][0]["timed"], drawn["timed"])
        # A figure of the tool itself, and one of pixels.
        p.value(DROP % (quoted(figure.split("<!-- stroke of")[0]), quoted("plot.svg")))
        self.banner(p, "“plot.svg” was not opened: it is a figure; open the stroke that it shows (.toml).")
        for kind in ("png", "pdf"):
            data = base64.b64encode(self.saved(p, kind).read_bytes()).decode()
            p.value(DROP % (f"Uint8Array.from(atob({quoted(data)}), c => c.charCodeAt(0))", quoted(f"plot.{kind}")))
            self.banner(p, f"“plot.{kind}” was not opened: it is a figure")

    def test_without_a_connection_a_stroke_is_saved_nevertheless(self):
        s = self.serve()
        p, _ = self.ready(s)
        self.draw(p, *self.way([5, 5], [35, 30]))
        s.kill()
        self.says(p, "No connection")
        self.ok("plan", self.write("offline.toml", self.saved(p, "toml").read_bytes()), "--array", "palm-3x3")
        self.ok("plan", self.write("offline.csv", self.saved(p, "csv").read_bytes()), "--array", "palm-3x3")

    def test_without_a_connection_no_other_plan_is_shown_or_heard(self):
        s = self.serve()
        p, _ = self.ready(s)
        for row in (10, 30):
            self.draw(p, *self.way([5, row], [35, row]))
            self.planned(p)
        p.value("""globalThis.heard = 0; for (const kind of [OscillatorNode, AudioBufferSourceNode]) { const was = kind.prototype.start;
            kind.prototype.start = function (...a) { ++heard; return was.apply(this, a); }; }""")
        s.kill()
        self.says(p, "No connection")
        self.assertTrue(p.value("tactor.state.plan"))  # it is of this take
        p.value("document.querySelectorAll('#takes .take')[1].click()")
        p.until("!tactor.state.plan && document.querySelector('#predicted').textContent === 'No connection: there is no plan.'")
        p.click("#speaker")
        p.click("#play")
        self.toast(p, "shown, not felt")
        p.until("tactor.state.at_s > 0 && !tactor.state.playing")
        self.assertEqual(p.value("heard"), 0)
        # A change, and a drawing, have no plan either.
        p.value("document.querySelectorAll('#takes .take')[0].click()")
        self.restart(s)
        self.await_service(p)
        self.planned(p)


# Every option that the page can set, in takes that can be planned; the last needs thresholds, and is only kept as text.
SETTINGS = (
    {"algorithm": "continuous", "phantom": "barycentric", "waveform": "noise:100-400", "noise_seed": 7, "am": "30:0.5", "outside": "error"},
    {"algorithm": "park2016", "faces": "nearest", "soa": 0.06, "burst": 0.03, "carrier": 200, "phase": "burst", "attack": 0.004, "release": 0.006, "envelope": "linear"},
    {"waveform": "square", "am": "30", "slope": 0.3, "intercept": 0.05, "timing": "fit", "min_duration": 0.01, "ramp": 0.003},
    {"algorithm": "tactile-brush", "snap": True, "drop_points": True, "overlap": "max", "together": "sum", "intensity_scale": "stevens", "stevens_exponent": 0.9},
    {"compensate": "low-speed", "sigma_mm": 4, "sigma_v_mm_s": 90},
    {"sl": 20, "phantom": "log"})
NOT_SET = {"level_dbfs", "duration", "speed", "intensity_max", "position"}  # the page's level, what is drawn, and what files alone have
PUT = """(takes => new Promise((done, failed) => { const asked = indexedDB.open("tactor", 1);
    asked.onerror = failed; asked.onsuccess = () => { const t = asked.result.transaction("takes", "readwrite");
        takes.forEach(take => t.objectStore("takes").put(take)); t.oncomplete = () => { asked.result.close(); done(1); }; }; }))(%s)"""
# Keeps the files that the page gives, in place of what a browser does with them.
GIVEN = """globalThis.given = []; URL.createObjectURL = blob => { given.push(blob); return "#"; };
    HTMLAnchorElement.prototype.click = function () { given.at(-1).named = this.download; }; 1"""


class RoundTrip(StudioTest):
    def given(self, p, count=1):
        """Returns the next files that the page gives: texts by their names."""
        p.until(f"given.length >= {count} && given.every(b => b.named)")
        return p.value("Promise.all(given.splice(0).map(async b => [b.named, await b.text()]))")

    def save(self, p, kind):
        p.value(f"document.querySelector('#p-save [data-kind={kind}]').click()")
        return self.given(p)[0]

    def opened(self, p, name, text):
        """Opens a file; returns its take."""
        count = p.value("tactor.state.takes.length")
        self.choose_files(p, {name: text})
        p.until(f"tactor.state.takes.length === {count + 1} && {TAKE}.origin === 'file'")
        return self.take(p)

    def check(self, take, wanted):
        for key, usual in (("options", {}), ("gain_db", None), ("leaves_array", None)):
            self.assertEqual(take.get(key, usual), wanted.get(key, usual))
        self.assertEqual([s["timed"] for s in take["strokes"]], [s["timed"] for s in wanted["strokes"]])

    def takes(self):
        """Returns a page with a take for each of the settings, the oldest first, and its service."""
        s = self.serve()
        p, _ = self.ready(s)
        self.draw(p, *self.way([5, 5], [35, 30]))  # the storage is there
        self.toast(p, "Kept as")
        stroke = {"name": "line", "start_s": 0, "timed": [[0, 0, 0, 1], [1, 40, 40, 1]]}
        takes = [{"id": f"t{i}", "made": i + 1, "name": f"set {i}", "origin": "drawn", "strokes": [stroke], "options": o, **more}
                 for i, (o, more) in enumerate(zip(SETTINGS, ({"gain_db": -6.5}, {"leaves_array": True}, {}, {"gain_db": -1}, {}, {})))]
        p.value(PUT % json.dumps(takes))
        self.reload(p)
        p.until(f"tactor.state.takes.length === {len(takes) + 1}")
        p.value(GIVEN)
        rows = p.value("tactor.state.options.map(o => o.name)")
        self.assertEqual({name for o in SETTINGS for name in o}, set(rows) - NOT_SET)
        return s, p, takes

    def choose(self, p, take):
        p.value(f"[...document.querySelectorAll('#takes .take')].find(b => b.querySelector('b').textContent === {quoted(take['name'])}).click()")
        p.until(f"{TAKE}.id === {quoted(take['id'])}")

    def test_each_option_comes_back_from_a_file_of_each_way_to_save(self):
        s, p, takes = self.takes()
        for take in takes:
            with self.subTest(options=take["options"]):
                self.choose(p, take)
                text = self.save(p, "toml")[1]
                self.ok("plan", self.write("saved.toml", text), "--outside", "clamp", "--array", "palm-3x3")
                wav = "sl" not in take["options"] and self.save(p, "wav")[1]
                # Neither the name nor what was shown before plays a part.
                self.choose(p, takes[3])
                self.check(self.opened(p, "other.toml", text), take)
                if wav:
                    self.planned(p)
                    self.assertEqual(self.save(p, "wav")[1], wav)
                    self.choose(p, take)
                    self.check(self.opened(p, "figure.svg", self.save(p, "svg")[1]), take)
        p.value("document.querySelector('#save-all').click()")
        files = dict(self.given(p, len(takes)))
        for take in takes:
            self.check(self.opened(p, "a.toml", files[f"{take['name'].replace(' ', '-')}.toml"]), take)
        # Without a connection; it is opened once that is there again.
        s.kill()
        self.says(p, "No connection")
        texts = []
        for take in takes:
            self.choose(p, take)
            texts.append(self.save(p, "toml")[1])
        self.restart(s)
        self.await_service(p)
        for take, text in zip(takes, texts):
            self.check(self.opened(p, "offline.toml", text), take)

    def test_a_file_has_its_own_method_and_not_the_one_that_was_shown(self):
        p, _ = self.ready(self.serve())
        self.draw(p, *self.way([5, 5], [35, 30]))
        p.value("document.querySelector('#pane [data-value=continuous]').click()")
        p.until(f"{TAKE}.options.algorithm === 'continuous'")
        self.assertEqual(self.opened(p, "line.csv", LINE)["options"], {})
        text = "[stroke]\npath = 'M 0 0 L 40 40'\nwaveform = 'noise:100-400'\nnoise_seed = 1\nalgorithm = 'tactile-brush'\n"
        self.assertEqual(self.opened(p, "brush.toml", text)["options"], {"waveform": "noise:100-400", "noise_seed": 1, "algorithm": "tactile-brush"})
        p.until("document.querySelector('#pane [data-value=tactile-brush]').getAttribute('aria-checked') === 'true'")


class Files(StudioTest):
    def drop(self, p, name, text):
        p.value(DROP % (quoted(text), quoted(name)))

    def test_dropped_files_become_takes_and_nothing_plays(self):
        s = self.serve()
        p, _ = self.ready(s)
        self.write("line.csv", LINE)
        plan = self.ok("plan", "line.csv", "--array", "palm-3x3", "--format", "json").stdout
        files = {"line.csv": LINE, "two.toml": "[[stroke]]\npath = 'M 5 5 L 35 5'\n[[stroke]]\npath = 'M 5 35 L 35 35'\n",
                 "arc.svg": '<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="40mm" viewBox="0 0 40 40"><path d="M 5 5 L 35 35"/></svg>', "plan.json": plan}
        for i, (name, text) in enumerate(files.items()):
            with self.subTest(name=name):
                self.drop(p, name, text)
                p.until(f"tactor.state.takes.length === {i + 1}")
                take = self.take(p)
                self.assertEqual(take["name"], name.split(".")[0])
                self.assertEqual(len(take["strokes"]), 2 if name == "two.toml" else 1)
        self.assertEqual(s.client().ok("status")["strokes"], [])

    def test_what_is_wrong_with_a_file_is_said_with_its_name(self):
        p, _ = self.ready(self.serve())
        self.drop(p, "line.csv", "t_s,x_mm,y_mm\n0,zero,0\n")
        self.banner(p, "“line.csv” was not opened")
        self.assertIn("zero", p.value("document.querySelector('#banner-text').textContent"))
        p.click("#banner-close")
        p.until("document.querySelector('#banner').hidden")
        self.drop(p, "notes.exe", "MZ")
        self.banner(p, "“notes.exe” was not opened")
        self.assertEqual(p.value("tactor.state.takes.length"), 0)

    def test_of_a_recording_in_per_cent_it_asks_for_the_full_level(self):
        p, _ = self.ready(self.serve())
        p.value("window.prompt = text => { window.question = text; return '200'; }")
        self.drop(p, "cent.csv", "t_s,x_mm,y_mm,intensity\n0,5,5,100\n1,35,5,50\n")
        p.until("tactor.state.takes.length === 1")
        self.assertIn("“cent.csv”: intensity 100 is above 1", p.value("window.question"))
        self.assertEqual(p.value("tactor.state.takes[0].strokes[0].timed.map(point => point[3])"), [0.5, 0.25])
        p.value("window.prompt = () => null")
        self.drop(p, "cent.csv", "t_s,x_mm,y_mm,intensity\n0,5,5,100\n1,35,5,50\n")
        self.banner(p, "“cent.csv” was not opened: line 2: intensity 100 is above 1")

    def test_each_of_several_bad_files_is_told_in_one_sentence(self):
        p, _ = self.ready(self.serve())
        self.choose_files(p, {"a.toml": "[[stroke]]\npath = 'M 5 5 L 35 5'\ncolour = 3\n", "b.csv": LINE, "c.jpg": b"\xff\xd8\xff\xe0\0\x10JFIF",
                              "d.csv": "t_s,x_mm,y_mm\n0,zero,0\n"})
        self.banner(p, "“a.toml” was not opened: line 3: unknown key 'colour' in [[stroke]]. “c.jpg” was not opened: it is not text; strokes are TOML, CSV, SVG, TACT, HAPTIC, AHAP or a plan. "
                       "“d.csv” was not opened: line 2")
        self.assertEqual(self.names(p), ["b"])

    def test_many_shapes_outside_are_one_warning(self):
        p, _ = self.ready(self.serve())
        self.drop(p, "many.svg", '<svg xmlns="http://www.w3.org/2000/svg" width="400mm" height="400mm" viewBox="0 0 400 400">' +
                  "".join(f'<path d="M {100 + i} 105 L 135 135"/>' for i in range(41)) + "</svg>")
        p.until("document.querySelector('#warnings').textContent.includes('41 strokes are up to')")
        self.assertEqual(p.value("[...document.querySelectorAll('#warnings p')].filter(e => /outside/.test(e.textContent)).length"), 1)

    def test_a_hostile_name_is_text(self):
        p, _ = self.ready(self.serve())
        name = '<img src=x onerror="globalThis.injected = 1">'
        self.drop(p, f"{name}.toml", f"[[stroke]]\nname = '{name}'\npath = 'M 0 0 L 40 40'\n")
        p.until("document.querySelectorAll('#takes li').length === 1")
        self.assertEqual(p.value("document.querySelector('#take-name').textContent"), name)
        self.assertIsNone(p.value("globalThis.injected"))
        self.ok("plan", self.write("again.toml", self.saved(p, "toml").read_bytes()), "--array", "palm-3x3")


if __name__ == "__main__":
    main()
