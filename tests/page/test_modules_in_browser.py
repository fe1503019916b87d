# SPDX-License-Identifier: MIT
"""The studio's modules that stand on what a browser alone has: its database and its sound.
Usage: test_modules_in_browser.py TOOL SOURCE_ROOT"""
import functools
import http.server
import pathlib
import sys
import threading

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
del sys.argv[3:]
from browser import BrowserTest  # noqa: E402
from harness import ROOT, ToolTest, main  # noqa: E402


class Files(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


class ModulesTest(BrowserTest, ToolTest):
    def setUp(self):
        super().setUp()
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Files, directory=ROOT / "src/server/page"))
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        threading.Thread(target=server.serve_forever).start()
        self.address = f"http://127.0.0.1:{server.server_port}"

    def open(self):
        p = self.page(f"{self.address}/takes/address.js")
        p.until("location.pathname === '/takes/address.js' && document.readyState === 'complete'")
        return p

    @staticmethod
    def call(p, module, body):
        """Runs the body of an asynchronous function that has the module as `m`."""
        return p.value(f"(async () => {{ const m = await import('{module}'); {body} }})()")


class Storage(ModulesTest):
    OPENED = "const s = await m.open_storage('takes');"

    def storage(self, p, body):
        return self.call(p, f"{self.address}/takes/storage.js", self.OPENED + body)

    def test_thousands_of_takes_outlast_the_page_and_load_at_once(self):
        p = self.open()
        self.assertTrue(self.storage(p, """
            const points = Array.from({length: 200}, (_, i) => [i / 100, i, i, 1]);
            await Promise.all(Array.from({length: 2000}, (_, i) => s.write({takes: [{id: i, name: `take ${i}`, points}]})));
            await s.write({takes: [{id: 7, name: "again"}], removed: [8], values: {current: 7, gone: 1}});
            await s.write({values: {gone: undefined}});
            return await s.get("gone") === undefined; """))
        p.reload()
        count, ids, again, current, asked = self.storage(p, """
            let asked = 0;
            const get_all = IDBObjectStore.prototype.getAll;
            IDBObjectStore.prototype.getAll = function () { ++asked; return get_all.call(this); };
            const takes = await s.load(), current = await s.get("current");
            return [takes.length, takes.slice(0, 9).map(t => t.id), takes[7], current, asked]; """)
        self.assertEqual((count, ids, again, current, asked), (1999, [0, 1, 2, 3, 4, 5, 6, 7, 9], {"id": 7, "name": "again"}, 7, 1))

    def test_a_full_disk_rejects_and_loses_nothing(self):
        p = self.open()
        # First: the browser remembers for a while how much there was.
        p.call("Storage.overrideQuotaForOrigin", origin=self.address, quotaSize=100_000)
        self.storage(p, "await s.write({takes: [{id: 1, name: 'kept'}]});")
        self.assertEqual(self.storage(p, """
            try { await s.write({takes: [{id: 2, bytes: new Uint8Array(5e6).map(() => 256 * Math.random())}]}); } catch (e) { return e.name; } """), "QuotaExceededError")
        self.assertEqual(self.storage(p, "return s.load();"), [{"id": 1, "name": "kept"}])


class Sound(ModulesTest):
    def test_a_burst_is_heard_on_its_side_and_in_its_time(self):
        # Two bursts, of the left tactor and the right; the largest sample of each 10 ms on both sides, from where the plan begins.
        left, right = self.call(self.open(), "/service/loudspeaker.js", """
            const context = new OfflineAudioContext(2, 48000, 48000);
            Object.assign(context, {resume: async () => {}, close() {}});
            const sound = m.start_loudspeaker({tactors: 2, strokes: [{first: 0, count: 2, continuous: false}],
                onsets: [0, 0.2], durations: [0.1, 0.1], amplitudes: [1, 0, 0, 0.5]}, [{x_mm: 0, y_mm: 0}, {x_mm: 40, y_mm: 0}], 0, {context});
            const heard = await context.startRendering();
            sound.stop();
            return [0, 1].map(side => Array.from({length: 40}, (_, i) =>
                Math.max(...heard.getChannelData(side).slice(2400 + 480 * i, 2400 + 480 * (i + 1)).map(Math.abs)))); """)
        for side, burst, level in ((left, range(0, 10), 0.25), (right, range(20, 30), 0.125)):
            for i, sample in enumerate(side):
                with self.subTest(i=i, level=level):
                    if i in burst:
                        self.assertAlmostEqual(sample, level, delta=0.02 if i not in (burst[0], burst[-1]) else level / 2)
                    else:
                        self.assertLess(sample, 1e-4)


if __name__ == "__main__":
    main()
