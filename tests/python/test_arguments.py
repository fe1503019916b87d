# SPDX-License-Identifier: MIT
"""Refusals name the caller's argument."""
import json
import os
import types

import numpy as np
import pytest

import tactor
from conftest import refused

HUGE = 10**400  # no double holds it
LINE = tactor.Path.svg("M 0 10 L 40 30")
PALM = tactor.Array.preset("palm-3x3")


@pytest.mark.parametrize("call", [
    lambda a, p: tactor.load("x\0.toml"), lambda a, p: tactor.Array.from_file("x\0.toml"), lambda a, p: tactor.Score(a, p).write("x\0.wav"),
    lambda a, p: tactor.plot(p, "x\0.svg"), lambda a, p: tactor.compare(a, p.stroke).plot("x\0.svg"), lambda a, p: tactor.Player("null\0", a),
    lambda a, p: tactor.Player("null", a, config="x\0.toml"), lambda a, p: tactor.devices(device="null\0"), lambda a, p: tactor.devices(config="x\0"),
    lambda a, p: tactor.plan(a, p.stroke, waveform="x\0.wav"),
])
def test_names_end_at_no_zero_byte(tmp_path, monkeypatch, palm, stroke, call):
    monkeypatch.chdir(tmp_path)
    plan = tactor.plan(palm, stroke)
    with pytest.raises(tactor.InputError, match="zero byte"):
        call(palm, plan)
    assert list(tmp_path.iterdir()) == []


def test_noise_seeds_go_as_far_as_the_tools(tool, palm, palm_with):
    stroke = tactor.Stroke.preset("park2016-1")
    for seed in (0, 2**32, 2**53):
        printed = json.loads(tool("plan", "park2016-1", "--waveform", "noise:50-300", "--noise-seed", seed, "--format", "json"))
        assert tactor.plan(palm, stroke, waveform="noise:50-300", noise_seed=seed).to_dict() == printed
        noisy = palm_with(f'[defaults]\nwaveform = "noise:50-300"\nnoise-seed = {seed}\n')
        assert tactor.plan(noisy, stroke).to_dict()["stroke"] == printed["stroke"]
    for seed in (-1, 2**53 + 1, 2**64, HUGE):
        assert refused(lambda: tactor.plan(palm, stroke, waveform="noise:50-300", noise_seed=seed)).field == "noise_seed"


def refusals(player, finger, ticket):
    """Calls, and the names under which they are refused."""
    palm, stroke = player.array, tactor.Stroke.along(LINE, duration=1.0)
    plan = tactor.plan(palm, stroke)
    score = tactor.Score(palm, plan)
    nan = float("nan")
    return [
        (lambda: finger.to(1, 1, at_s=-1), "at_s"), (lambda: finger.to("1", 1), "x_mm"), (lambda: finger.to(HUGE, 1), "x_mm"), (lambda: finger.to(1, None), "y_mm"),
        (lambda: finger.to(1, 1, "loud"), "intensity"), (lambda: finger.to(nan, 0), "x_mm"),
        (lambda: finger.to(1, 1, at_s=float("inf")), "at_s"), (lambda: finger.to(1, 1, at_s=1e10), "at_s"),
        (lambda: player.submit(score, at="soon"), "at"), (lambda: player.submit(score, at="armed", delay=1), "at"),
        (lambda: player.submit(score, at_s=1.0, delay=1.0), "at"), (lambda: player.submit(score, at_s=1e300), "at_s"),
        (lambda: player.submit(score, frame=-1), "frame"), (lambda: player.submit(score, frame=1 << 70), "frame"),
        (lambda: player.submit(score, delay=nan), "delay"), (lambda: player.submit(score, delay="soon"), "delay"), (lambda: player.submit(score, at_s=HUGE), "at_s"),
        (lambda: player.submit(score, at_s=nan), "at_s"), (lambda: player.submit(score, frame=1.5), "frame"), (lambda: player.play(score, frame=1.5), "frame"), (lambda: player.fire(nan), "at_s"),
        (lambda: player.live(timeout=0), "timeout"), (lambda: player.live(timeout=None), "timeout"), (lambda: player.live(longest=nan), "longest"),
        (lambda: player.live(longest=0), "longest"), (lambda: player.live(smooth=-0.1), "smooth"), (lambda: player.live(smooth=1.1), "smooth"),
        (lambda: player.live(soa=0.001, algorithm="park2016"), "soa"), (lambda: player.live(soa=0.001), "soa"), (lambda: player.live(soa=70), "soa"), (lambda: ticket.wait(nan), "timeout"),
        (lambda: finger.wait("long"), "timeout"),
        (lambda: tactor.Player("null", palm, config=os.devnull, drive_window_s=nan), "drive_window_s"),
        (lambda: tactor.Player("null", palm, config=os.devnull, drive_window_s=-1), "drive_window_s"),
        (lambda: tactor.Player("null", palm, config=os.devnull, rate=HUGE), "rate"), (lambda: tactor.Player("null", palm, config=os.devnull, periods="3"), "periods"),
        (lambda: tactor.Player("null", palm, config=os.devnull, max_drive_s="5"), "max_drive_s"),
        (lambda: tactor.Stroke.along(LINE, duration=1.0, pauses=[(0.5, 2.0)]), "pauses"), (lambda: tactor.Stroke.along(LINE, pauses=[(0.5, 1.0, 3.0)]), "pauses"),
        (lambda: tactor.Stroke.along(LINE, pauses=[3]), "pauses"), (lambda: tactor.Stroke.along(LINE, duration=0), "duration"),
        (lambda: tactor.Stroke.along(LINE, duration="long"), "duration"), (lambda: tactor.Stroke.along(LINE, speed=HUGE), "speed"),
        (lambda: tactor.Stroke.along(LINE, intensity=None), "intensity"), (lambda: tactor.Stroke.along(LINE, start=nan), "start"),
        (lambda: tactor.Stroke.along(LINE, start=-1), "start"), (lambda: tactor.Stroke.along(LINE, carrier=-250), "carrier"),
        (lambda: tactor.Stroke.timed([0, 1], [0, 1], [0, 1], carrier=HUGE), "carrier"), (lambda: tactor.Stroke.timed([0, 1], [0, None], [0, 1]), "x"),
        (lambda: stroke.with_duration(None), "duration"), (lambda: stroke.with_speed("x"), "speed"), (lambda: stroke.position(nan), "t"),
        (lambda: LINE.at(None), "s_mm"), (lambda: LINE.at([1, None]), "s_mm"), (lambda: LINE.at(nan), "s_mm"), (lambda: LINE.meets_x("3"), "x_mm"),
        (lambda: tactor.Path.arc(3, 1, 0, 90), "centre"), (lambda: tactor.Path.arc((0, 0), "1", 0, 90), "radius_mm"),
        (lambda: tactor.Path.polyline([(0, 0), (HUGE, 1)]), "points"),
        (lambda: tactor.Array.from_points([(0, 0), (1,)]), "points"), (lambda: tactor.Array.from_points([("a", "b")]), "points"),
        (lambda: tactor.Array.from_points(np.array(3.0)), "points"), (lambda: tactor.Array.grid("g", 2, 2, "10"), "pitch_mm"),
        (lambda: tactor.Array.grid("g", 2.5, 2, 10), "rows"), (lambda: tactor.Array.grid("g", 2, None, 10), "columns"),
        (lambda: tactor.Array("a", [tactor.Tactor(tactor.Point(0, 0), "3")]), "channel"), (lambda: tactor.Array("a", [tactor.Tactor(None, 3)]), "position"),
        (lambda: tactor.Array("a", [tactor.Tactor(tactor.Point(0, 0), 0, thresholds=3)]), "thresholds"),
        (lambda: tactor.Array("a", [tactor.Tactor(tactor.Point(0, 0), 0, gain_db=HUGE)]), "gain_db"),
        (lambda: palm.contains(3), "point"), (lambda: palm.nearest((1, "2")), "point"), (lambda: palm.weights((1, 2), intensity="1"), "intensity"),
        (lambda: tactor.plan(palm, stroke, soa=HUGE), "soa"), (lambda: tactor.plan(palm, stroke, soa=1j), "soa"),
        (lambda: tactor.plan(palm, stroke, soa=np.zeros(2)), "soa"), (lambda: tactor.Score(palm, [(HUGE, plan)]), "start"),
        (lambda: tactor.Score(palm, plan, level_dbfs=HUGE), "level_dbfs"), (lambda: tactor.plot(plan, "x.svg", dpi="300"), "dpi"),
        (lambda: tactor.plot(plan, "x.svg", width=None), "width"), (lambda: tactor.compare(palm, stroke).plot("x.svg", width=5), "width"), (lambda: stroke.fitted(palm, "1"), "margin_mm"),
        *((lambda f=f: player.submit(f), "samples") for f in (np.zeros((9, 3), "int16"), np.full((9, 9), 0.9), np.zeros((0, 9), "int16"))),
        (lambda: tactor.devices(rate=3), "rate"), (lambda: tactor.devices(rate=48000.5), "rate"), (lambda: tactor.devices(rate="48000"), "rate"),
    ]


WORDS = ("at_ns", "window_s (", "window_s:", "rests", "_kind", "::", "timeout_s", "longest_s", "smooth_s", "duration_s", "speed_mm_s")


def test_impossible_values_are_refused_by_the_name_they_were_given(palm):
    with tactor.Player("null", palm, config=os.devnull) as player:
        score = tactor.Score(palm, tactor.plan(palm, tactor.Stroke.along(LINE, duration=0.05)))
        ticket = player.submit(score, at="armed")
        with player.live(timeout=3600.0, outside="error") as finger:
            finger.to(20, 20)
            for i, (call, field) in enumerate(refusals(player, finger, ticket)):
                e = refused(call)
                assert e.field == field, (i, str(e))
                assert not any(word in str(e).replace("drive_window_s", "") for word in WORDS), str(e)
            with pytest.raises(tactor.InputError, match='outside="clamp"'):
                finger.to(1000, 20)
        assert finger.report.state == "finished" and finger.counts["points"] == 1
        ticket.cancel()


@pytest.mark.parametrize("call,what", [
    (lambda: tactor.Path.svg(3), "data"), (lambda: tactor.Array.preset(3), "name"), (lambda: tactor.Stroke.preset(None), "name"), (lambda: tactor.parse(b""), "text"),
    (lambda: tactor.Stroke.along(LINE, name=3), "name"), (lambda: tactor.Stroke.along(LINE, easing=3), "easing"), (lambda: tactor.Array(3, []), "name"),
    (lambda: tactor.fit_strokes([3], PALM), "strokes"), (lambda: tactor.devices(3), "array"),
    (lambda: tactor.devices(device=3), "device"), (lambda: tactor.Player("null", PALM, keep_drive_time=3), "keep_drive_time"),
    (lambda: tactor.Player("null", PALM, sample_format=3), "sample_format"),
    (lambda: tactor.plan(LINE, 3), "array"), (lambda: tactor.plan(PALM, "park2016-1"), "stroke"),
    (lambda: tactor.compare(PALM, 3), "stroke"), (lambda: tactor.Score(3, []), "array"),
    (lambda: tactor.Score(PALM, 3), "plans"), (lambda: tactor.plot(3, "x.svg"), "plans"), (lambda: tactor.Player("null", "palm"), "array"),
    (lambda: tactor.Player(3, PALM), "device"), (lambda: tactor.Array("x", [(0, 0)]), "tactors"),
    (lambda: tactor.Stroke.along("M 0 0 L 1 1"), "path"), (lambda: tactor.fit_strokes([], 3), "array"),
])
def test_another_type_is_said_with_the_arguments_name(call, what):
    with pytest.raises(TypeError, match=f"^{what}: "):
        call()


@pytest.mark.parametrize("call,field", [
    (lambda t: tactor.Path.svg("M 0 0 " + t), "data"), (lambda t: tactor.parse(t), "text"), (lambda t: tactor.parse("M 0 0 L 9 9", name=t), "name"),
    (lambda t: tactor.Stroke.preset(t), "name"), (lambda t: tactor.Stroke.along(LINE, duration=1, name=t), "name"), (lambda t: tactor.Array(t, PALM.tactors), "name"),
    (lambda t: tactor.plan(PALM, tactor.Stroke.along(LINE, duration=1), algorithm=t), "algorithm"),
    (lambda t: tactor.plan(PALM, tactor.Stroke.along(LINE, duration=1), waveform=t), "waveform"),
])
def test_lone_surrogates_are_refused(call, field):
    e = refused(lambda: call("x\udc80"))
    assert e.field == field and "surrogate" in e.why


@pytest.mark.parametrize("value", [np.datetime64("now"), np.float32(1), np.int64(1), np.array([1.0]), np.array([True]), np.timedelta64(1), 1, "yes"])
def test_flags_are_truths(palm, stroke, value):
    assert refused(lambda: tactor.plan(palm, stroke, algorithm="tactile-brush", snap=value)).field == "snap"


def test_truths_of_numpy_are_flags(palm):
    off_grid = tactor.Stroke.along(tactor.Path.svg("M 7 3 L 39 31"), duration=1.0)
    for yes, no in ((np.True_, np.False_), (np.array(True), np.array(False))):
        snapped = tactor.plan(palm, off_grid, algorithm="tactile-brush", snap=yes)
        assert snapped == tactor.plan(palm, off_grid, algorithm="tactile-brush", snap=True)
        refused(lambda: tactor.plan(palm, off_grid, algorithm="tactile-brush", snap=no))


def test_numbers_of_numpy_and_arrays_of_no_dimension_are_numbers(palm, stroke):
    assert tactor.plan(palm, stroke, soa=np.float64(0.06), fit=np.bool_(False), rate=np.int64(44100)) == tactor.plan(palm, stroke, soa=0.06, rate=44100)
    n = np.array
    assert tactor.Stroke.along(LINE, speed=n(40.0), intensity=n(0.5)) == tactor.Stroke.along(LINE, speed=40.0, intensity=0.5)
    assert LINE.at(n(3.0)) == LINE.at(3.0) and tactor.Array.grid("g", n(2), 2, n(10.0)) == tactor.Array.grid("g", 2, 2, 10.0)
    assert tactor.plan(palm, stroke, soa=n(0.06)) == tactor.plan(palm, stroke, soa=0.06)
    assert tactor.Array.grid("g", 2, 2, n([10.0, 20.0])) == tactor.Array.grid("g", 2, 2, (10.0, 20.0))


def test_a_plan_is_read_of_any_mapping(palm, stroke):
    plan = tactor.plan(palm, stroke)
    record = {**plan.to_dict(), "bursts": [types.MappingProxyType(b) for b in plan.to_dict()["bursts"]]}
    assert tactor.Plan.from_dict(types.MappingProxyType(record)) == plan
    assert tactor.Plan.from_dict({**record, "total_s": np.float32(record["total_s"]).astype(np.float64)}).total == pytest.approx(plan.total)
