# SPDX-License-Identifier: MIT
"""Levels, limits and defaults stay with their objects."""
import pickle

import numpy as np
import pytest

import tactor
from conftest import refused

FILE = """
[array]
preset = "palm-3x3"
[output]
rate = 44100
[sync]
channel = 12
[limits]
power_dbfs = -6.0
max_drive_s = 2.5
[amplifier]
line = { name = "amp" }
settle_ms = 0.3
[defaults]
level-dbfs = -40
envelope = "tukey:0.3"
latency-ms = 5
"""


@pytest.fixture
def tap(palm):
    return tactor.Stroke.along(tactor.Path.svg("M 5 5 L 35 30"), duration=0.5)


def parts(score):
    """Returns the level of each plan in a score."""
    x = score.render()
    return [x[a:b] for a, b in zip(score.starts, [*score.starts[1:], score.frames])]


@pytest.mark.parametrize("how", [{}, {"algorithm": "continuous"}, {"algorithm": "continuous", "duration": 6.0}, {"overlap": "energy", "soa": 0.0695, "burst": 0.069}])
def test_each_plan_keeps_its_level(palm, tap, how):
    plans = [tactor.plan(palm, tap, level_dbfs=level, **how) for level in (-30, -3, -12.5)] + [tactor.plan(palm, tap, **how)]
    for plan, part in zip(plans, parts(tactor.Score(palm, plans))):
        alone = tactor.Score(palm, plan).render()
        assert np.allclose(part[:len(alone)], alone[:len(part)], rtol=0, atol=1e-7) and np.abs(alone).max() > 0.02
    loud = tactor.Score(palm, plans, level_dbfs=-20)
    assert all(np.array_equal(parts(loud)[0][:1000], part[:1000]) for part in parts(loud))


@pytest.mark.parametrize("algorithm", ["park2016", "continuous"])
def test_plans_that_meet_are_no_louder_than_the_level(palm, algorithm):
    lines = [tactor.Stroke.along(tactor.Path.svg(d), duration=1.4) for d in ("M 0 20 H 40", "M 40 20 H 0", "M 20 0 V 40")]
    plans = [(0.0, tactor.plan(palm, line, algorithm=algorithm, level_dbfs=-40)) for line in lines]
    score, summed = tactor.Score(palm, plans), tactor.Score(palm, plans, together="sum")
    assert np.abs(score.render()).max() == pytest.approx(0.01, rel=1e-3)
    assert np.abs(summed.render()).max() == pytest.approx(0.03, rel=1e-3)
    assert np.allclose(3 * score.render(), summed.render(), rtol=0, atol=1e-7)
    assert score.weakened_db == pytest.approx(-20 * np.log10(3), abs=1e-4)
    assert score.meets == {"tactor": 4, "at": pytest.approx(0.7, abs=0.05), "plans": [0, 1, 2]}
    assert (summed.weakened_db, summed.meets) == (0, None) and score != summed
    mixed = [plans[0], (0.0, tactor.plan(palm, lines[1], algorithm=algorithm, level_dbfs=-40, together="sum"))]
    assert refused(lambda: tactor.Score(palm, mixed)).field == "together"


def test_sensation_levels_are_kept(tap):
    palm = tactor.Array.preset("palm-3x3").replace(thresholds=[-40.0] * 9)
    quiet, loud = (tactor.plan(palm, tap, sl=sl) for sl in (7, 17))
    first, second = parts(tactor.Score(palm, [quiet, loud]))
    assert np.allclose(first[:1000] * 10 ** 0.5, second[:1000], rtol=0, atol=1e-7) and first.any()
    e = refused(lambda: tactor.Score(palm, [quiet, tactor.plan(palm, tap, level_dbfs=-12)]))
    assert e.field == "sl" and "differ" in e.why
    assert tactor.Score(palm, [quiet, tactor.plan(palm, tap, level_dbfs=-12)], sl=7).frames


@pytest.mark.parametrize("name,a,b", [("rate", 44100, 48000), ("phase", "stroke", "burst"), ("ramp", 0.001, 0.002), ("ramp", None, 0.002),
                                      ("attack", 0.001, 0.003), ("release", 0.001, 0.003), ("envelope", "linear", "exponential"),
                                      ("envelope", "tukey:0.2", "tukey:0.3")])
def test_plans_that_disagree_are_refused(palm, tap, name, a, b):
    plans = [tactor.plan(palm, tap, **{name: value}) for value in (a, b)]
    e = refused(lambda: tactor.Score(palm, plans))
    assert e.field == name and "differ" in e.why and f"{name}=" in e.hint
    said = tactor.Score(palm, plans, **{name: b})
    assert said == tactor.Score(palm, [plans[1], plans[1]], **{name: b})


@pytest.mark.parametrize("name,a,b", [("level_dbfs", -30, -3), ("phase", "stroke", "burst"), ("envelope", "raised-cosine", "linear"), ("rate", 44100, 48000),
                                      ("ramp", 0.001, 0.002), ("attack", 0.001, 0.002), ("release", 0.001, 0.002), ("envelope", "tukey:0.2", "tukey:0.3")])
def test_plans_that_sound_different_are_not_equal(palm, tap, name, a, b):
    one, other = (tactor.plan(palm, tap, **{name: value}) for value in (a, b))
    assert one != other and hash(one) != hash(other)
    assert tactor.Score(palm, one) != tactor.Score(palm, other) and hash(tactor.Score(palm, one)) != hash(tactor.Score(palm, other))
    plain = tactor.plan(palm, tap)
    assert tactor.Score(palm, plain, **{name: a}) != tactor.Score(palm, plain, **{name: b})
    # For the plan or for its score, it is the same.
    assert tactor.Score(palm, plain, **{name: a}) == tactor.Score(palm, one)
    assert hash(tactor.Score(palm, plain, **{name: a})) == hash(tactor.Score(palm, one))
    assert pickle.loads(pickle.dumps(one)) == one == tactor.Plan.from_dict(one.to_dict())


def test_scores_are_equal_where_their_samples_are_made_alike(palm, tap):
    plan = tactor.plan(palm, tap)
    assert tactor.Score(palm, plan) == tactor.Score(palm, plan, level_dbfs=-12, rate=48000, channels=9) == tactor.Score(palm, [(0.0, plan)])
    assert tactor.Score(palm, plan) == tactor.Score(palm.replace(name="other"), plan)
    for other in (dict(channels=10), dict(marker_channel=9), dict(power_dbfs=0.0)):
        assert tactor.Score(palm, plan) != tactor.Score(palm, plan, **other)
    assert tactor.Score(palm, plan) != tactor.Score(palm, [(0.1, plan)])
    assert tactor.Score(palm, plan) != tactor.Score(palm.replace(gains=-1.0), plan)


@pytest.fixture
def filed(tmp_path):
    (tmp_path / "a.toml").write_text(FILE)
    return tactor.Array.from_file(tmp_path / "a.toml")


def test_keys_of_a_file_count_in_equality_and_stay(filed, tmp_path, tap):
    bare = tactor.Array(filed.name, filed.tactors)
    assert bare != filed and filed == tactor.Array.from_file(tmp_path / "a.toml")
    assert bare == tactor.Array.preset("palm-3x3")
    kept = filed.replace(gains=-1.0, channels=range(8, -1, -1))
    assert [t.gain_db for t in kept] == [-1.0] * 9 and kept[0].channel == 8 and kept != filed and kept.replace(gains=0.0, channels=range(9)) == filed
    for array in (filed, kept, pickle.loads(pickle.dumps(filed))):
        plan = tactor.plan(array, tap)
        assert plan.to_dict()["render"]["level_dbfs"] == -40 and tactor.Score(array, plan).rate == 44100
        assert tactor.Score(array, plan).channels == 13


@pytest.mark.parametrize("line", ["power_dbfs = -6.0", "level-dbfs = -40", "channel = 12", "settle_ms = 0.3"])
def test_each_table_of_a_file_counts(filed, tmp_path, line):
    (tmp_path / "b.toml").write_text(FILE.replace(line, ""))
    assert tactor.Array.from_file(tmp_path / "b.toml") != filed


def test_arrays_are_written(tool, filed, tmp_path):
    kept = filed.replace(thresholds=[-30.0, None, [(100, -20.0), (250, -41.5)], *[-35.0] * 6], polarities=[-1] + [1] * 8, name="P07")
    kept.write(tmp_path / "b.toml")
    assert tactor.Array.from_file(tmp_path / "b.toml") == kept
    assert "13 channels, 44100 Hz" in tool("render", "park2016-1", "--array", "b.toml", "-o", "x.wav")
    again = pickle.loads(pickle.dumps(kept))
    (tmp_path / "a.toml").unlink()
    assert again == kept
    refused(lambda: kept.write(tmp_path / "none" / "b.toml"))


def test_calibrations_are_written_as_long_as_they_hold(tool, tmp_path):
    tool("calibrate", "--participant", "S1", "--simulate", "threshold=-40,spread=2", "--seed", "3", "--tactors", "0", "-o", "S1.toml")
    array = tactor.Array.from_file(tmp_path / "S1.toml")
    array.write(tmp_path / "again.toml")
    assert 'participant = "S1"' in (tmp_path / "again.toml").read_text() and tactor.Array.from_file(tmp_path / "again.toml") == array
    array.replace(thresholds=-40.0).write(tmp_path / "new.toml")
    assert "[calibration]" not in (tmp_path / "new.toml").read_text()


@pytest.mark.parametrize("what,value", [("channels", [0, 1]), ("gains", "loud"), ("gains", [0.0] * 8), ("thresholds", [-30.0] * 10), ("polarities", 2),
                                        ("channels", [0] * 9), ("thresholds", [[(250, -41), (100, -20)]] * 9)])
def test_replacements_that_do_not_fit_are_refused(palm, what, value):
    refused(lambda: palm.replace(**{what: value}))


def test_levels_go_along_to_another_array(palm, filed, tap):
    """Checks that given options of a plan stay; others follow the array's file."""
    said, open_ = tactor.plan(palm, tap, level_dbfs=-30), tactor.plan(palm, tap)
    assert tactor.Score(filed, said) == tactor.Score(filed, open_, level_dbfs=-30)
    assert tactor.Score(filed, open_) == tactor.Score(filed, tactor.plan(filed, tap))
    assert tactor.Score(palm, tactor.plan(filed, tap)) == tactor.Score(palm, open_, level_dbfs=-40, rate=44100, envelope="tukey:0.3", marker_channel=12)
