# SPDX-License-Identifier: MIT
"""Playing on ALSA's null device, which takes real time: strokes are short."""
import asyncio
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
import warnings

import numpy as np
import pytest

import tactor
from conftest import refused

LONG = 120.0  # s: a longer answer never comes


def run(code, *arguments, **environment):
    """Runs a separate program; returns its output."""
    env = {**os.environ, "TACTOR_CONFIG": os.devnull, **environment}
    # From Python 3.12 on, a fork beside threads gives a warning.
    warned = "-W", "error::ResourceWarning", "-W", "ignore:This process:DeprecationWarning"
    # A process that a shell starts in the background ignores Ctrl-C, and so do its children.
    r = subprocess.run([sys.executable, *warned, "-c", textwrap.dedent(code), *arguments], env=env, capture_output=True, text=True,
                       timeout=LONG, check=False, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
    return r.returncode, r.stdout, r.stderr


def test_a_score_is_played_to_its_end(player, short):
    before = time.monotonic()
    report = player.play(short)
    assert (report.state, report.reason, report.frames, report.late_s) == ("finished", "", short.frames, 0.0)
    assert before <= report.started_s <= time.monotonic()
    stats = player.stats()
    assert stats["frames"] >= short.frames and stats["xruns"] == 0 and isinstance(stats["realtime"], bool) and stats["xrun_s"] == []


def test_the_setup_is_that_of_the_device(palm):
    with tactor.Player("null", palm, rate=44100.0, period_frames=441, periods=4.0, config=os.devnull) as p:
        assert (p.rate, p.channels, p.setup["period_frames"], p.setup["buffer_frames"], p.setup["has_clock"]) == (44100, 9, 441, 1764, False)
        assert repr(p).startswith("<tactor.Player 'null': 9 channels, 44100 Hz")
        refused(lambda: p.submit(tactor.Score(palm, tactor.plan(palm, tactor.Stroke.preset("park2016-1")))))


def test_frames_that_reach_a_file_are_those_rendered(tmp_path, palm, short):
    raw = tmp_path / "played.raw"
    with tactor.Player(f"file:'{raw}',raw", palm, sample_format="float", config=os.devnull) as p:
        assert p.play(short).state == "finished"
    played = np.fromfile(raw, dtype="float32").reshape(-1, 9)
    first = int(np.flatnonzero(np.abs(played).any(axis=1))[0])
    own = short.render()
    lead = int(np.flatnonzero(np.abs(own).any(axis=1))[0])
    assert np.array_equal(played[first - lead:first - lead + short.frames], own)


def test_starts_at_a_time(player, short):
    at = time.monotonic() + 0.2
    tickets = player.submit(short, at_s=at), player.submit(short, delay=0.2)
    for ticket in tickets:
        report = ticket.wait(LONG)
        assert report.started_s > at - 0.1 and report.state == "finished"  # later on a busy machine; the engine's tests are exact
    late = player.submit(short, at_s=time.monotonic() - 1.0).wait(LONG)
    assert late.late_s >= 1.0


def test_armed_strokes_wait_to_be_fired(player, short):
    tickets = [player.submit(short, at="armed") for _ in range(2)]
    with pytest.raises(TimeoutError):
        tickets[0].wait(0.05)
    assert not tickets[0].done() and tickets[0].report is None and "goes on" in repr(tickets[0])
    assert player.fire() == 2 and [t.wait(LONG).state for t in tickets] == ["finished"] * 2 and player.fire() == 0


def test_cancelled_strokes_are_reported_so(player, endless):
    ticket = player.submit(endless)
    assert ticket.cancel() and ticket.wait(LONG).state == "cancelled" and not ticket.cancel()
    assert ticket.wait() is ticket.report and ticket.done() and repr(ticket).endswith("cancelled>")


def test_callbacks_run_in_a_thread_of_the_package(player, short, endless, capsys):
    called = threading.Event()
    seen = []

    def callback(ticket):
        seen.append((threading.current_thread(), ticket))
        with pytest.raises(RuntimeError):
            other.wait()
        called.set()
        raise ZeroDivisionError("mine")
    other = player.submit(endless)
    ticket = player.submit(short)
    ticket.add_done_callback(callback)
    assert called.wait(LONG) and seen[0][1] is ticket and seen[0][0] is not threading.main_thread()
    ticket.add_done_callback(lambda t: seen.append((threading.current_thread(), t)))
    assert seen[1] == (threading.main_thread(), ticket)
    other.cancel()
    other.wait(LONG)
    assert "ZeroDivisionError: mine" in capsys.readouterr().err and player.play(short).state == "finished"


def test_a_live_stroke_follows_its_points(player):
    with player.live(algorithm="continuous") as finger:
        assert finger.open and finger.to(12.0, 20.0) and finger.to(13.0, 20.0, intensity=0.5)
        assert finger.to(1000.0, 20.0)
    assert finger.report.state == "finished" and not finger.open and not finger.to(0.0, 0.0)
    assert finger.counts["points"] == 3 and finger.counts["outside"] == 1


@pytest.mark.parametrize("options,points,messages,held,outside", [
    ({}, [(20, 20, 80), (20, 20), (20, 20, 2)], ["an intensity of 80 plays as 1: the requested level is the ceiling"], 2, 0),
    (dict(intensity_max=255), [(640, 480, 255), (20, 20), (640, 480, 300)],
     ["the place (640, 480) mm is outside the array and moves to its edge", "an intensity of 300 plays as 255: the requested level is the ceiling"], 1, 2),
])
def test_points_too_strong_and_outside_are_counted_and_said_once(player, short, options, points, messages, held, outside):
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        with player.live(**options) as finger:
            assert all([finger.to(*point) for point in points])
    assert [str(w.message) for w in said] == messages and said[0].filename == __file__
    assert finger.counts["held"] == finger.report.held_points == held and finger.report.outside_points == outside
    assert player.play(short).held_points == 0


def test_a_live_strokes_report_has_the_delay_of_its_points(player, short):
    with player.live() as finger:
        stamp = time.monotonic() - 1.0
        finger.to(12.0, 20.0, at_s=stamp)
    delay = finger.report.delay
    assert isinstance(delay, tactor.Delay) and delay.points == 1
    assert delay.least_s == delay.mean_s == delay.most_s == pytest.approx(finger.report.started_s - stamp, abs=1e-6)
    assert delay.least_s > 1.0
    assert player.play(short).delay is None
    with player.live() as unfed:
        pass
    assert unfed.report.delay is None


def test_a_live_stroke_ends_with_its_block_or_its_producer(player):
    with pytest.raises(ZeroDivisionError):
        with player.live(algorithm="park2016", soa=0.06) as finger:
            finger.to(20, 20)
            raise ZeroDivisionError
    assert finger.report.state == "cancelled"
    silent = player.live(timeout=0.05)
    silent.to(20, 20)
    report = silent.wait(LONG)
    assert report.state == "interrupted" and report.reason
    long = player.live(timeout=LONG, longest=0.05)
    long.to(20, 20)
    assert long.wait(LONG).state == "interrupted" and "longest allowed duration" in long.report.reason
    with player.live(smooth=0.05) as even:
        even.to(10, 20)
        even.to(30, 20)
    assert even.report.state == "finished" and even.counts["points"] == 2


class All:
    def weights(self, x_mm, y_mm, intensity):
        if x_mm > 30:
            raise ZeroDivisionError("mine")
        return {4: intensity} if x_mm > 10 else {40: intensity}


@pytest.mark.parametrize("x_mm,raised,why", [(35, ZeroDivisionError, "ZeroDivisionError: mine"), (5, tactor.InputError, "40 is out of range")])
def test_a_model_of_python_shapes_a_live_stroke_until_it_raises_or_returns_rubbish(player, x_mm, raised, why):
    with player.live(phantom=All()) as finger:
        assert finger.to(20, 20) and finger.to(21, 20)
        with pytest.raises(raised):
            finger.to(x_mm, 20)
        assert not finger.to(20, 20)
    assert finger.report.state == "interrupted" and why in finger.report.reason and "\n" not in finger.report.reason


def test_a_live_stroke_follows_its_array_s_file(tmp_path, palm_with):
    quiet = palm_with('[defaults]\nlevel-dbfs = -30\nalgorithm = "tactile-brush"\nenvelope = "tukey:0.3"\nphantom = "barycentric"\n')

    def peak_dbfs(**options):
        raw = tmp_path / "played.raw"
        with tactor.Player(f"file:'{raw}',raw", quiet, sample_format="float", config=os.devnull) as p:
            with p.live(timeout=3600.0, **options) as finger:
                finger.to(20, 20)
                while p.position()["stroke_frame"] < 4800:
                    time.sleep(0.001)
        return 20 * np.log10(np.abs(np.fromfile(raw, dtype="float32")).max())
    assert peak_dbfs() == pytest.approx(-30.0, abs=0.1)
    assert peak_dbfs(level_dbfs=-20) == pytest.approx(-20.0, abs=0.1)


def test_sys_exit_in_a_callback_ends_nothing(player, short, capsys):
    ticket = player.submit(short)
    told = threading.Event()

    def leave(_):
        told.set()
        sys.exit(3)
    ticket.add_done_callback(leave)
    ticket.wait(LONG)
    assert told.wait(LONG) and player.submit(short).wait(LONG).state == "finished"
    assert "SystemExit" in capsys.readouterr().err


def test_awaiting_gives_the_report(player, short, endless):
    async def main():
        ticked = 0

        async def tick():
            nonlocal ticked
            while True:
                ticked += 1
                await asyncio.sleep(0.005)
        clock = asyncio.create_task(tick())
        first, second = await asyncio.gather(_report(player.submit(short)), _report(player.submit(short)))
        assert first.state == second.state == "finished" and ticked > 3
        assert (await player.submit(short)).frames == short.frames
        ticket = player.submit(endless)
        task = asyncio.create_task(_report(ticket))
        await asyncio.sleep(0)
        await asyncio.sleep(0.02)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        assert (await ticket).state == "cancelled"
        clock.cancel()

    async def _report(ticket):
        return await ticket
    asyncio.run(main())


def test_cancelling_a_wait_for_an_ended_stroke_cancels_nothing(palm, endless):
    async def main():
        p = tactor.Player("null", palm, config=os.devnull)
        ticket = p.submit(endless)
        waiting = asyncio.create_task(_await(ticket))
        await asyncio.sleep(0)
        p.close()
        waiting.cancel()
        with pytest.raises(asyncio.CancelledError):
            await waiting
        assert ticket.report.state == "cancelled" and not ticket.cancel()

    async def _await(ticket):
        return await ticket
    asyncio.run(main())


def test_several_threads_may_close_a_player_at_once(palm, endless):
    for _ in range(10):
        p = tactor.Player("null", palm, config=os.devnull)
        tickets = [p.submit(endless) for _ in range(3)]
        tickets[0].add_done_callback(lambda _, p=p: p.close())
        failed, together = [], threading.Barrier(6)

        def close(p=p, tickets=tickets, failed=failed, together=together):
            together.wait()
            try:
                p.close()
                assert p.closed and all(t.done() for t in tickets)
            except BaseException as e:
                failed.append(e)
        threads = [threading.Thread(target=close) for _ in range(6)]
        for t in threads:
            t.start()
        for t in threads:
            t.join(LONG)
        assert failed == [] and [t.report.state for t in tickets] == ["cancelled"] * 3


def test_waiting_releases_the_interpreter(player, endless):
    ticket = player.submit(endless)
    waiter = threading.Thread(target=ticket.wait)
    waiter.start()
    stopper = threading.Thread(target=player.stop)
    stopper.start()
    counted = 0
    while waiter.is_alive() or stopper.is_alive():
        counted += 1
    assert counted > 100 and ticket.report.state == "cancelled" and player.ended == ""
    refused(lambda: player.submit(endless), tactor.StreamError)


def test_many_threads_may_play(player, short):
    reports = []
    threads = [threading.Thread(target=lambda: reports.append(player.play(short))) for _ in range(16)]
    for t in threads:
        t.start()
    for t in threads:
        t.join(LONG)
    assert [r.state for r in reports] == ["finished"] * 16


def test_a_closed_player_is_reported(palm, short, endless):
    p = tactor.Player("null", palm, config=os.devnull)
    ticket = p.submit(endless)
    before = p.stats()
    assert p.ended is None
    p.close()
    assert ticket.report.state == "cancelled" and p.closed and p.stats().keys() == before.keys()
    p.close()
    assert ticket.cancel() is False
    assert p.ended == "" and p.stats()["frames"] > 0 and p.stats() == p.stats()
    for call in (lambda: p.submit(short), lambda: p.play(short), p.live, p.fire, p.stop, p.position):
        refused(call, tactor.StreamError)


def test_drive_time_counts_on_from_player_to_player(palm, felt_pcm, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    monkeypatch.setenv("ALSA_CONFIG_PATH", str(felt_pcm))
    tmp_path.chmod(0o700)
    still = tactor.Score(palm, tactor.plan(palm, tactor.Stroke.along(tactor.Path.svg("M 0 0 L 0.001 0"), duration=0.3), algorithm="continuous"))

    def player(device="felt", **more):
        return tactor.Player(device, palm, config=os.devnull, max_drive_s=0.5, drive_window_s=3600, **more)

    def count_cuts(**more):
        with player(**more) as p:
            p.play(still)
            return p.stats()["drives_cut"]

    assert [count_cuts(keep_drive_time=False) for _ in range(2)] == [0, 0]
    assert [count_cuts(device="null") for _ in range(2)] == [0, 0]
    assert not (tmp_path / "tactor").exists()
    assert [count_cuts() for _ in range(2)] == [0, 1]
    assert [f.name for f in (tmp_path / "tactor").iterdir()] == ["drive-time-felt"]
    # Two at the same time count together, too.
    monkeypatch.setenv("XDG_RUNTIME_DIR", "")
    with pytest.warns(UserWarning, match="there is no runtime folder"), player() as one, player() as other:
        one.play(still)
        other.play(still)
        assert (one.stats()["drives_cut"], other.stats()["drives_cut"]) == (0, 1)
    # A file that is cut counts as the limit, once.
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    (tmp_path / "tactor/drive-time-felt").write_text("")
    with pytest.warns(UserWarning, match="cannot be read completely: each tactor counts as driven for as long as allowed"), player() as p:
        p.play(still)
        assert p.stats()["drives_cut"] == 2  # also of the tactor that gets next to nothing


def test_missing_devices_are_errors(palm):
    e = refused(lambda: tactor.Player("hw:CARD=Nowhere", palm, config=os.devnull), tactor.DeviceError)
    assert "Nowhere" in str(e) and isinstance(e, OSError) and e.hint
    for options in (dict(rate=1), dict(periods=1), dict(period_frames=0), dict(rate=48000.5), dict(config="/nonexistent.toml"), dict(latency=-1), dict(latency=0),
                    dict(sync_delay=float("nan")), dict(channels=4)):
        refused(lambda: tactor.Player("null", palm, **{"config": os.devnull, **options}))


def test_the_configuration_counts(palm, tmp_path, monkeypatch, short):
    file = tmp_path / "tactor.toml"
    file.write_text("[output]\nrate = 44100\nperiod_frames = 128\n[limits]\npower_dbfs = -40.0\n")
    monkeypatch.setenv("TACTOR_CONFIG", str(file))
    for config in (None, file):
        with tactor.Player("null", palm, config=config) as p:
            assert (p.rate, p.setup["period_frames"]) == (44100, 128)
            p.play(tactor.Score(palm, short.plans[0], rate=44100))
            assert p.stats()["power_limited_frames"] > 0
    with tactor.Player("null", palm, power_dbfs=0.0) as p:
        p.play(tactor.Score(palm, short.plans[0], rate=44100))
        assert p.stats()["power_limited_frames"] == 0
    file.write_text('[amplifier]\nline = { chip = "no-such-chip", offset = 3 }\n')
    with pytest.raises(tactor.DeviceError, match="no-such-chip"):
        tactor.Player("null", palm)
    tactor.Player("null", palm, no_gpio=True).close()


def test_defaults_and_limits_of_an_array_s_file_are_the_streams_too(palm_with):
    array = palm_with('[output]\nchannels = 12\n[limits]\npower_dbfs = -40.0\n[defaults]\nrate = 44100\nsample-format = "s16"\nlatency-ms = 10\n')
    score = tactor.Score(array, tactor.plan(array, tactor.Stroke.preset("park2016-1"), duration=0.2))
    with tactor.Player("null", array, config=os.devnull) as p:
        assert (p.rate, p.setup["format"], p.setup["buffer_frames"]) == (44100, "s16", 441)
        assert p.channels == 12 == score.channels
        assert p.play(score).state == "finished" and p.stats()["power_limited_frames"] > 0
    with tactor.Player("null", array, config=os.devnull, rate=48000, sample_format="s32", period_frames=96) as p:
        assert (p.rate, p.setup["format"], p.setup["period_frames"]) == (48000, "s32", 96)


FIXED = """
import sys
import tactor
palm = tactor.Array.preset("palm-3x3")
score = tactor.Score(palm, tactor.plan(palm, tactor.Stroke.preset("park2016-1"), duration=0.2))
with tactor.Player("sixteen", palm) as p:
    print(p.channels, p.setup["device_channels"], p.play(score).state)
with tactor.Player("sixteen", palm, channels=16) as p:
    print(p.channels, p.setup["device_channels"], p.play(score).state)
for options in ({"channels": 9}, {"channels": 4}):
    try:
        tactor.Player("sixteen", palm, **options)
    except tactor.Error as e:
        print(type(e).__name__, e.what, e.why)
try:
    tactor.Player("eight", palm)
except tactor.DeviceError as e:
    print(e.hint)
"""


def test_a_card_of_fixed_channels_takes_the_array_or_names_one_that_fits(tmp_path):
    def fixed(name, n):
        bindings = " ".join(f"bindings.{c} {{ slave a channel {c} }}" for c in range(n))
        return f"pcm.{name} {{ type multi slaves.a {{ pcm {{ type null }} channels {n} }} {bindings} }}\n"
    (tmp_path / "asound.conf").write_text(fixed("sixteen", 16) + fixed("eight", 8))
    code, said, _ = run(FIXED, ALSA_CONFIG_PATH=str(tmp_path / "asound.conf"))
    out = said.splitlines()
    assert code == 0 and out[:2] == ["9 16 finished", "16 16 finished"]
    assert out[2].startswith('DeviceError PCM "sixteen" it cannot play 9 channels')
    assert out[3] == "InputError channels palm-3x3 needs 9 channels"
    assert "the array palm-2x4 fits" in out[4]


def test_the_log_is_called_in_the_package_s_thread(palm, short):
    lines = []
    with tactor.Player("null", palm, config=os.devnull, log=lambda kind, text: lines.append((threading.current_thread().name, kind, text))) as p:
        p.play(short)
    assert lines and {(name, kind) for name, kind, _ in lines} <= {("tactor", k) for k in ("debug", "info", "warning", "error")}


PLAYING = """
    import os, sys, signal, threading, time
    import tactor
    palm = tactor.Array.preset("palm-3x3")
    stroke = tactor.Stroke.along(tactor.Path.svg("M 0 10 L 40 30"), duration=60)
    score = tactor.Score(palm, tactor.plan(palm, stroke, algorithm="continuous"), level_dbfs=-60)
    player = tactor.Player("null", palm)
    ticket = player.submit(score)
"""


def test_a_forgotten_player_is_closed_at_exit():
    code, out, err = run(PLAYING + """
    ticket.add_done_callback(lambda t: print(t.report.state, flush=True))
    """)
    assert (code, out, err) == (0, "cancelled\n", "")


def test_ctrl_c_fades_out():
    code, out, err = run(PLAYING + """
    threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    try:
        print("ended by itself:", ticket.wait())
    except KeyboardInterrupt:
        print(ticket.report.state)
    player.close()
    """)
    assert (code, out, err) == (0, "cancelled\n", "")


@pytest.mark.unsanitized  # a child frees nothing of its parent's memory
def test_a_fork_leaves_the_player_to_its_parent():
    code, out, err = run(PLAYING + """
    import asyncio

    async def waited(t):
        return await t
    finger = player.live(timeout=10)
    finger.to(20, 20)
    child = os.fork()
    if child == 0:
        calls = [player.stats, player.stop, player.close, player.fire, player.position, player.live, ticket.cancel, ticket.wait,
                 lambda: player.submit(score), lambda: player.ended, lambda: finger.to(1, 1), finger.end, finger.wait,
                 lambda: asyncio.run(waited(ticket)), lambda: ticket.add_done_callback(print)]
        refused = 0
        for call in calls:
            try:
                call()
            except tactor.StreamError as e:
                refused += "fork" in str(e)
        print(refused == len(calls), flush=True)
        del player, ticket, finger
        sys.exit(0)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), ticket.done(), finger.to(21, 20), player.ended)
    player.close()
    print(ticket.report.state)
    """)
    assert err == "" and sorted(out.split("\n")) == sorted(["True", "0 False True None", "cancelled", ""]) and code == 0


@pytest.mark.unsanitized  # a child frees nothing of its parent's memory
def test_a_forked_process_may_have_a_player():
    code, out, err = run(PLAYING + """
    child = os.fork()
    if child == 0:
        with tactor.Player("null", palm) as own:
            t = own.submit(score)
            t.cancel()
            print(t.wait(20).state, flush=True)
        sys.exit(0)
    os.waitpid(child, 0)
    player.close()
    """)
    assert (code, out, err) == (0, "cancelled\n", "")


def test_a_player_leaves_nothing_behind(palm, short):
    def descriptors():
        return len(os.listdir("/proc/self/fd"))
    with tactor.Player("null", palm, config=os.devnull) as p:
        p.play(short)
    before = descriptors(), threading.active_count()
    for _ in range(5):
        with tactor.Player("null", palm, config=os.devnull) as p:
            p.submit(short)
    assert (descriptors(), threading.active_count()) == before


def test_python_s_signal_handlers_stay(player, short):
    before = signal.getsignal(signal.SIGINT)
    player.play(short)
    assert signal.getsignal(signal.SIGINT) is before
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        player.play(short)


def test_a_stroke_plays_by_one_call(palm):
    stroke = tactor.Stroke.preset("park2016-1")
    report = tactor.play("null", palm, stroke, level_dbfs=-40, rate=44100)
    assert (report.state, report.frames) == ("finished", tactor.Score(palm, tactor.plan(palm, stroke), rate=44100).frames)
    assert "level_dbfs" in str(refused(lambda: tactor.play("null", palm, stroke, level_dbfs=3)))
    refused(lambda: tactor.play("no such card", palm, stroke), tactor.DeviceError)
