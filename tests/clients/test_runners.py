# SPDX-License-Identifier: MIT
"""tactor serve in the runners of laboratories: the examples for jsPsych in Chromium, and for Octave. Usage: test_runners.py TOOL
SOURCE_ROOT, with the folders of jsPsych's package and of Psychtoolbox's GetSecs in TACTOR_JSPSYCH and TACTOR_PSYCHTOOLBOX"""
import functools
import http.server
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import threading
import time
import unittest

PSYCHTOOLBOX = os.environ.get("TACTOR_PSYCHTOOLBOX")
JSPSYCH = os.environ.get("TACTOR_JSPSYCH")
for folder in ("cli", "page"):
    sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / folder))
from browser import PROGRAM, BrowserTest  # noqa: E402
from harness import PATIENCE_S, ROOT, end_process, main  # noqa: E402
from serving import LONG, ServeTest  # noqa: E402

BY_SCRIPT = """<!doctype html><script src="jspsych/dist/index.browser.js"></script><script src="plugin/index.js"></script>
<body><script>
const jsPsych = initJsPsych({on_finish() { window.rows = jsPsych.data.get().values(); }});
window.run = (trials) => jsPsych.run(trials.map((t) => ({type: jsPsychTactorStroke, ...t})));
</script>"""
BUNDLED = """import {initJsPsych} from 'jspsych';
import jsPsychTactorStroke from 'jspsych-plugin-tactor';
window.jsPsych = initJsPsych({on_finish() { window.rows = window.jsPsych.data.get().values(); }});
window.run = (trials) => window.jsPsych.run(trials.map((t) => ({type: jsPsychTactorStroke, ...t})));
"""
TAP = {"path": "M 20 20", "options": {"duration": 0.2}}
# Two clients; the second one leaves, and the first one waits for its stroke.
OCTAVE = """
port = str2double(argv(){1});
try, Tactor('127.0.0.1', 1); catch e, disp(e.message), end
first = Tactor('127.0.0.1', port);
try, first.play(struct('stroke', 'nowhere')); catch e, disp(e.message), end
long = struct('path', 'M 0 0 L 40 40', 'options', struct('algorithm', 'continuous', 'duration', 300));
stroke = first.play(long);
second = Tactor('127.0.0.1', port);
second.play(long);
input('', 's');
second.close();
disp(first.wait(stroke).state), fflush(stdout);
input('', 's');
try, first.call('status'); catch e, disp(e.message), end
"""


class RunnerTest(ServeTest):
    def device_to_lose(self):
        """Returns a file that takes sound until its reader is ended, and the reader."""
        fifo = self.dir / "fifo"
        os.mkfifo(fifo)
        return fifo, self.start_tool(fifo, program="cat", stdout=subprocess.DEVNULL)


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


@unittest.skipUnless(PROGRAM and JSPSYCH, "Chromium or jsPsych is not here")
class JsPsych(BrowserTest, RunnerTest):
    def setUp(self):
        super().setUp()
        # The laboratory's own web server, with jsPsych and the plug-in as npm lays them.
        for name, target in (("jspsych", JSPSYCH), ("plugin", ROOT / "examples/jspsych")):
            (self.dir / name).symlink_to(target)
        self.write("script.html", BY_SCRIPT)
        web = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=self.dir))
        threading.Thread(target=web.serve_forever, daemon=True).start()
        self.addCleanup(web.server_close)
        self.addCleanup(web.shutdown)
        self.web = f"localhost:{web.server_address[1]}"
        self.server = self.serve("--http", "0", config=f'[serve]\nallow_hosts = ["{self.web}"]\n')

    def run_trials(self, *trials, page="script.html", open_page=None):
        p = (open_page or self.page)(f"http://{self.web}/{page}")
        p.until("window.run")
        url = self.server.where["http"].replace("http:", "ws:") + "rpc"
        p.value(f"void run({json.dumps([{'url': url, **t} for t in trials])})")
        return p

    def rows(self, p):
        return p.until("window.rows")

    def check_onset(self, row, before_s, until_s):
        """The onset is within the time of the test, and the page's clock agrees with the service's."""
        self.assertEqual((row["state"], row["message"], row["void"]), ("finished", "", False))
        self.assertTrue(before_s < row["onset_s"] < until_s, row)
        self.assertTrue(0 <= row["onset_within"] < 1000, row)
        self.assertEqual(row["frames"], 10080)

    def test_the_onset_at_the_dac_is_in_the_data(self):
        before = time.monotonic()
        p = self.run_trials({"play": TAP, "prompt": "<p>Left (f) or right (j)?</p>", "choices": ["f", "j"]}, {"play": TAP})
        p.until("document.body.innerText.includes('Left (f)')")
        p.key("KeyX", "x")
        p.key("KeyF", "f")
        first, second = self.rows(p)
        for row in (first, second):
            self.check_onset(row, before, time.monotonic())
            # Two ways from the service's clock to the page's: by the round trips, and by the time of day.
            self.assertAlmostEqual(row["onset"], 1000 * row["onset_unix_s"] - p.value("performance.timeOrigin"), delta=row["onset_within"] + 100)
        self.assertEqual((first["trial_type"], first["response"], second["response"], second["rt"]), ("tactor-stroke", "f", None, None))
        self.assertLess(abs(first["rt"]), PATIENCE_S * 1000)
        self.assertLess(first["onset_s"], second["onset_s"])
        self.assertEqual(p.faults(), [])

    def test_the_example_takes_timeline_variables(self):
        (self.dir / "node_modules").mkdir()
        for name, target in (("jspsych", JSPSYCH), ("jspsych-plugin-tactor", ROOT / "examples/jspsych")):
            (self.dir / "node_modules" / name).symlink_to(target)
        (self.dir / "example.html").symlink_to(ROOT / "examples/jspsych/example.html")
        url = self.server.where["http"].replace("http:", "ws:") + "rpc"
        p = self.page(f"http://{self.web}/example.html?url={url}")
        for n in range(4):
            p.until(f"typeof jsPsych !== 'undefined' && jsPsych.getProgress().current_trial_global === {n} && document.body.innerText.includes('Left (f)')")
            p.key("KeyJ", "j")
        rows = self.rows(p)
        self.assertEqual([(r["state"], r["message"]) for r in rows], [("finished", "")] * 4)
        self.assertEqual(sorted((r["path"], r["duration"]) for r in rows),
                         sorted((path, d) for path in ("M 35 20 H 5", "M 5 20 H 35") for d in (0.2, 0.4)))
        # A burst each 0.07 s: three in 0.2 s.
        self.assertEqual({r["duration"]: r["frames"] > 12000 for r in rows}, {0.2: False, 0.4: True})

    @unittest.skipUnless(shutil.which("esbuild"), "esbuild is not here")
    def test_a_bundler_takes_it(self):
        modules = self.dir / "lab/node_modules"
        modules.mkdir(parents=True)
        for module in pathlib.Path(JSPSYCH).parent.iterdir():
            (modules / module.name).symlink_to(module)
        shutil.copytree(ROOT / "examples/jspsych", modules / "jspsych-plugin-tactor")
        self.write("lab/main.js", BUNDLED)
        subprocess.run(["esbuild", "--bundle", "main.js", "--outfile=bundle.js", "--log-level=warning"], cwd=self.dir / "lab", check=True)
        self.write("bundled.html", '<!doctype html><body><script src="lab/bundle.js"></script>')
        before = time.monotonic()
        row, = self.rows(self.run_trials({"play": TAP}, page="bundled.html"))
        self.check_onset(row, before, time.monotonic())

    def test_a_trial_without_its_stroke_ends_with_a_message(self):
        p = self.run_trials({"play": {"stroke": "nowhere"}}, {"play": TAP, "url": "ws://127.0.0.1:1/rpc", "choices": ["f"]},
                            {"play": TAP, "url": "nowhere://"}, {"play": LONG, "trial_duration": 300})
        refused, away, wrong, faded = self.rows(p)
        self.assertEqual([(r["state"], r["void"]) for r in (refused, away, wrong, faded)],
                         [("refused", True), ("lost", True), ("lost", True), ("cancelled", True)])
        self.assertIn("nowhere", refused["message"])
        self.assertEqual(away["message"], f"ws://127.0.0.1:1/rpc cannot be reached (start tactor serve --http; list {self.web} in allow_hosts)")
        self.assertIn("url: ", wrong["message"])
        self.assertEqual((away["onset"], away["rt"], away["response"]), (None, None, None))

    def test_a_page_that_is_not_listed_is_refused(self):
        self.server = self.serve("--http", "0", "--socket", self.dir / "other.sock")
        row, = self.rows(self.run_trials({"play": TAP}))
        self.assertIn("allow_hosts", row["message"])

    def test_a_token(self):
        self.server = self.serve("--http", "0", "--socket", self.dir / "other.sock",
                                 config=f'{self.token("0123456789abcdef")}allow_hosts = ["{self.web}"]\n')
        owed, right = self.rows(self.run_trials({"play": TAP}, {"play": TAP, "token": "0123456789abcdef"}))
        self.assertEqual((owed["state"], right["state"]), ("refused", "finished"))

    def test_a_service_that_ends_or_hangs_ends_the_trial(self):
        for how, message in ((signal.SIGKILL, " closed the connection"), (signal.SIGTERM, "stopped by the owner"),
                             (signal.SIGSTOP, "has not answered for 5 s")):
            with self.subTest(how):
                self.server = self.serve("--http", "0", "--socket", self.dir / f"{how}.sock", config=f'[serve]\nallow_hosts = ["{self.web}"]\n')
                watcher = self.server.watcher()
                p = self.run_trials({"play": LONG, "choices": ["f"]})
                watcher.notification(lambda m: m["params"]["state"] == "started")
                self.server.process.send_signal(how)
                row, = self.rows(p)
                self.assertIn(message, row["message"])
                self.assertTrue(row["void"])
                self.assertIsNotNone(row["onset"])

    def test_who_leaves_cancels_its_own_strokes_alone(self):
        other = self.server.client()
        own = other.ok("play", **LONG)["stroke"]
        watcher = self.server.watcher()
        for leave in ("jsPsych.abortExperiment()", "location.href = 'about:blank'", None):
            with self.subTest(leave):
                p = self.run_trials({"play": LONG}, open_page=self.page if leave else self.browser.open)
                started = watcher.notification(lambda m: m["params"]["state"] == "started")["params"]["stroke"]
                if leave:
                    p.value(f"void ({leave})")
                else:
                    p.close()
                self.assertEqual(watcher.await_end(started)["reason"], "cancelled by its client")
        self.assertIn(own, [s["stroke"] for s in other.ok("status")["strokes"]])

    def test_a_device_that_is_lost_voids_the_trial(self):
        fifo, reader = self.device_to_lose()
        self.server = self.serve("--http", "0", "--socket", self.dir / "other.sock", device=("-D", f"raw:{fifo}"),
                                 config=f'[serve]\nallow_hosts = ["{self.web}"]\n')
        watcher = self.server.watcher()
        p = self.run_trials({"play": LONG}, {"play": TAP})
        watcher.notification(lambda m: m["params"]["state"] == "started")
        end_process(reader)
        interrupted, refused = self.rows(p)
        self.assertEqual((interrupted["state"], interrupted["void"], refused["state"]), ("interrupted", True, "refused"))
        self.assertTrue(interrupted["message"].startswith("device: "), interrupted)


@unittest.skipUnless(shutil.which("octave-cli"), "Octave is not here")
class Octave(RunnerTest):
    def octave(self, *args, port, folder=None, **more):
        """Returns a process that runs the example or a program."""
        env = self.env | {"HOME": str(self.dir), "OCTAVE_PATH": str(folder or "")}
        return self.start_tool("-q", "--no-history", *args, port, program="octave-cli", cwd=ROOT / "examples/octave", env=env,
                               stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **more)

    def finish(self, p, typed=""):
        out, err = p.communicate(typed, timeout=PATIENCE_S)
        self.assertEqual(p.returncode, 0, err)
        return out

    def run_example(self, folder):
        s = self.serve("--tcp", "0")
        out = self.finish(self.octave("trial.m", port=s.where["tcp"].rpartition(":")[2], folder=folder), "f\nj\nj\nf\n")
        head, *rows = (line.split("\t") for line in out.replace("Left (f) or right (j)? ", "").splitlines())
        trials = [dict(zip(head, row)) for row in rows]
        self.assertEqual([(t["stroke"], t["state"], t["response"]) for t in trials],
                         [(n, "finished", r) for n, r in (("left", "f"), ("right", "j"), ("right", "j"), ("left", "f"))])
        return [{k: float(t[k]) for k in ("onset_s", "within_s", "response_time_s")} for t in trials]

    def test_trials_by_octave_s_clock(self):
        trials = self.run_example(None)
        onsets = [t["onset_s"] for t in trials]
        self.assertEqual(onsets, sorted(onsets))
        self.assertTrue(all(0 < t["within_s"] < 1 for t in trials), trials)

    @unittest.skipUnless(PSYCHTOOLBOX, "Psychtoolbox is not here")
    def test_trials_by_psychtoolbox_s_clock(self):
        before = time.time()
        trials = self.run_example(PSYCHTOOLBOX)
        # On Linux, GetSecs is the time of day.
        self.assertTrue(all(before < t["onset_s"] < time.time() for t in trials), trials)

    def test_what_goes_wrong_is_said(self):
        fifo, reader = self.device_to_lose()
        s = self.serve("--tcp", "0", device=("-D", f"raw:{fifo}"))
        watcher = s.watcher()
        program = self.write("program.m", OCTAVE)
        p = self.octave(program, port=s.where["tcp"].rpartition(":")[2])
        numbers = [watcher.notification(lambda m: m["params"]["state"] == "started")["params"]["stroke"] for _ in range(2)]
        p.stdin.write("close\n")
        p.stdin.flush()
        # The first client's stroke goes on when the second one leaves.
        self.assertEqual(watcher.await_end(numbers[1])["reason"], "cancelled by its client")
        self.assertIn(numbers[0], [r["stroke"] for r in watcher.ok("status")["strokes"]])
        end_process(reader)
        self.assertEqual(watcher.await_end(numbers[0])["state"], "interrupted")
        self.assertEqual(p.stdout.readline(), "tactor: 127.0.0.1:1 cannot be reached (start tactor serve --tcp 1)\n")
        self.assertIn("tactor: stroke: there is no preset 'nowhere'", p.stdout.readline())
        self.assertEqual(p.stdout.readline(), "interrupted\n")
        s.process.send_signal(signal.SIGSTOP)
        self.assertEqual(self.finish(p, "call\n"), "tactor: the service has not answered for 5 s\n")


if __name__ == "__main__":
    main()
