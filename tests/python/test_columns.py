# SPDX-License-Identifier: MIT
"""Arrays in, arrays out."""
import datetime
import decimal
import fractions

import numpy as np
import pytest

import tactor
from conftest import refused


def test_positions_and_intensities_of_many_times(stroke):
    t = np.linspace(-0.1, stroke.duration + 0.1, 50)
    assert np.array_equal(stroke.position(t), [stroke.position(v) for v in t]) and stroke.position(t).shape == (50, 2)
    assert np.array_equal(stroke.intensity(list(t)), [stroke.intensity(v) for v in t])
    assert stroke.position([]).shape == (0, 2) and stroke.intensity(()).shape == (0,)
    assert isinstance(stroke.position(np.float64(0.1)), tactor.Point) and isinstance(stroke.intensity(np.float32(0.1)), float)
    refused(lambda: stroke.position(np.zeros((2, 2))))


@pytest.mark.parametrize("phantom", ["inverse-distance", "barycentric", "gaussian"])
def test_weights_of_many_places(palm, phantom):
    places = np.random.default_rng(1).uniform(0, 40, (40, 2))
    every = palm.weights(places, phantom, 0.5)
    assert every.shape == (40, 9)
    for place, row in zip(places, every):
        assert palm.weights(tuple(place), phantom, 0.5) == {i: a for i, a in enumerate(row) if a > 0.0}
    assert palm.weights(np.empty((0, 2))).shape == (0, 9)


@pytest.mark.parametrize("place", [(45.0, 20.0), (-300.0, 5.0), (1e6, 1e6)])
def test_weights_outside_are_an_error_like_in_a_plan(palm, place):
    for points in (place, [(0.0, 0.0), place]):
        e = refused(lambda: palm.weights(points))
        assert "outside the array" in e.why and e.field == "point"
    refused(lambda: tactor.plan(palm, tactor.Stroke.along(tactor.Path.polyline([(1, 1), place]), 1.0)))


def test_a_percept_has_columns_and_samples(palm, stroke):
    plan = tactor.plan(palm, stroke)
    felt = plan.percept()
    n = len(felt)
    assert felt.t.shape == felt.intensity.shape == felt.speed.shape == felt.shared.shape == (n,) and felt.positions.shape == felt.targets.shape == (n, 2)
    assert felt is plan.percept() and felt == tactor.plan(palm, stroke).percept() and not felt.t.flags.writeable
    for i in (0, 5, n // 2, -1):
        sample = felt[i]
        assert sample.t == felt.t[i] and tuple(sample.target) == tuple(felt.targets[i])
        assert np.isnan(felt.positions[i]).all() if sample.felt is None else tuple(sample.felt) == tuple(felt.positions[i])
    assert len(list(felt)) == n and len(felt[2:5]) == 3
    errors = np.hypot(*(felt.positions - felt.targets).T)
    assert np.nanmax(errors) == pytest.approx(plan.percept_summary()["largest_error_mm"])
    with pytest.raises(AttributeError):
        felt.t = felt.t


@pytest.mark.parametrize("phantom", ["inverse-distance", "barycentric"])
def test_a_percept_map_agrees_with_single_places(palm, phantom):
    felt = palm.percept_map(5.0, phantom)
    assert felt.x.tolist() == felt.y.tolist() == list(range(0, 41, 5)) and felt.positions.shape == (9, 9, 2) and felt.error_mm.shape == (9, 9)
    weights = palm.weights((5.0, 15.0), phantom)
    energy = sum(a * a for a in weights.values())
    place = sum(a * a * palm.positions[i] for i, a in weights.items()) / energy
    assert np.allclose(felt.positions[3, 1], place) and felt.intensity[3, 1] == pytest.approx(energy ** 0.5)
    assert felt.error_mm[3, 1] == pytest.approx(np.hypot(*(place - (5.0, 15.0)))) and felt.error_mm[4, 4] == pytest.approx(0.0, abs=1e-9)
    corner = tactor.Array.from_points([(0, 0), (40, 0), (0, 40)]).percept_map(10.0)
    assert np.isnan(corner.error_mm[-1, -1]) and not np.isnan(corner.error_mm[0]).any()
    refused(lambda: palm.percept_map(0.01))


def test_bursts_are_made_once(palm, stroke):
    plan = tactor.plan(palm, stroke)
    assert plan.bursts is plan.bursts and plan.conflicts is plan.conflicts and plan.dropped is plan.dropped and isinstance(plan.bursts, list)
    for change in (lambda: plan.bursts.append(1), lambda: plan.bursts.clear(), lambda: plan.bursts.__setitem__(0, 1), lambda: plan.bursts.sort()):
        with pytest.raises(TypeError):
            change()
    assert list(plan.bursts) == plan.bursts and type(plan.bursts[:2]) is list


NO_NUMBERS = [np.ma.array([0.0, 1.0], mask=[False, True]), np.array([0, 1 + 1j]), np.array(["2020-01-01", "2020-01-02"], "datetime64[D]"),
              np.array([1, 2], "timedelta64[s]"), ["0", "1"], np.array(["0", "1"]), np.array([b"0", b"1"]), [True, False], np.array([False, True]),
              [datetime.datetime(2020, 1, 1), datetime.datetime(2020, 1, 2)], np.array([0, "1"], object), np.array([0, 1j], object), [0, None]]


@pytest.mark.parametrize("values", NO_NUMBERS, ids=repr)
def test_arrays_of_other_than_real_numbers_are_refused(values, palm, stroke):
    ones = [0.0, 1.0]
    for call in (lambda: tactor.Stroke.timed(values, ones, ones), lambda: tactor.Stroke.timed(ones, values, ones), lambda: tactor.Stroke.timed(ones, ones, ones, values),
                 lambda: stroke.position(values), lambda: stroke.intensity(values), lambda: tactor.Path.svg("M 0 0 L 9 9").at(values),
                 lambda: tactor.Array.from_points([values, values]) if not isinstance(values, np.ndarray) else tactor.Array.from_points(np.stack([values, values])),
                 lambda: tactor.Path.polyline([values, values]) if not isinstance(values, np.ndarray) else tactor.Path.polyline(np.ma.stack([values, values]))):
        refused(call)


@pytest.mark.parametrize("value", [np.complex128(1), np.datetime64("2020-01-01"), np.timedelta64(1, "s"), np.str_("1"), np.bool_(True), np.ma.masked, "1", 1j,
                                   np.array([1.0]), datetime.datetime(2020, 1, 1)], ids=repr)
def test_single_values_other_than_real_numbers_are_refused(value, palm, stroke):
    for call in (lambda: tactor.plan(palm, stroke, soa=value), lambda: tactor.plan(palm, stroke, level_dbfs=value), lambda: stroke.with_duration(value),
                 lambda: tactor.Array.grid("g", 2, 2, value), lambda: palm.contains((value, 1.0))):
        refused(call)


@pytest.mark.parametrize("values", [[0, 1], (0.0, 1.0), np.array([0, 1], np.float32), np.array([0, 1], np.int8), np.ma.array([0.0, 1.0]), range(2),
                                    [decimal.Decimal(0), decimal.Decimal(1)], [fractions.Fraction(0), fractions.Fraction(1)], np.longdouble([0, 1])], ids=repr)
def test_arrays_of_real_numbers_are_accepted(values):
    assert tactor.Stroke.timed(values, values, values) == tactor.Stroke.timed([0, 1], [0, 1], [0, 1], name="timed")


@pytest.mark.parametrize("dtype", ["float32", "int16", "int32"])
@pytest.mark.parametrize("algorithm", ["park2016", "continuous"])
def test_scores_are_rendered_in_parts(palm, stroke, dtype, algorithm):
    score = tactor.Score(palm, tactor.plan(palm, stroke, algorithm=algorithm), level_dbfs=-3)
    whole = score.render(dtype)
    blocks = list(score.blocks(480, dtype))
    assert [len(b) for b in blocks[:-1]] == [480] * (len(blocks) - 1) and 0 < len(blocks[-1]) <= 480
    assert np.array_equal(np.concatenate(blocks), whole) and np.array_equal(np.concatenate(list(score.blocks(10 ** 6, dtype))), whole)
    assert np.array_equal(score.render(dtype, start=1000, frames=77), whole[1000:1077]) and np.array_equal(score.render(dtype, start=50000), whole[50000:])
    beyond = score.render(dtype, start=score.frames - 5, frames=10)
    assert np.array_equal(beyond[:5], whole[-5:]) and not beyond[5:].any() and score.render(dtype, start=score.frames + 3).shape == (0, 9)
    out = np.ones((100, 9), dtype)
    assert score.render(out=out, start=300) is out and np.array_equal(out, whole[300:400])


def test_unsuitable_outputs_of_a_rendering_are_refused(palm, stroke):
    score = tactor.Score(palm, tactor.plan(palm, stroke))
    frozen = np.zeros((10, 9), "float32")
    frozen.flags.writeable = False
    for out in (np.zeros((10, 8), "float32"), np.zeros((9, 10), "float32").T, np.zeros((10, 9)), frozen, np.zeros(90, "float32")):
        refused(lambda: score.render(out=out))
    for wrong in (dict(start=-1), dict(frames=-1), dict(start=0.5), dict(frames=5, out=np.zeros((10, 9), "float32"))):
        refused(lambda: score.render(**wrong))
    for wrong in ((0,), (1.5,), (480, "float64")):
        refused(lambda: score.blocks(*wrong))


def test_faces_are_those_of_weights_plans_and_maps(palm):
    wide = tactor.Array.from_points([(x, y) for y in (0, 40, 80) for x in (0, 20, 40)])
    plan = tactor.plan(wide, tactor.Stroke.along(tactor.Path.svg("M 0 10 L 40 10"), 1.0), faces="nearest")
    assert plan.faces == "nearest" and "in one line" in plan.warnings[0] and "faces" in plan.to_dict()
    assert np.allclose(wide.weights(plan.positions, faces="nearest"), plan.amplitudes, rtol=0, atol=1e-9)
    assert not np.allclose(wide.weights(plan.positions), plan.amplitudes, rtol=0, atol=1e-9)
    assert np.nanmax(wide.percept_map(5.0, faces="nearest").error_mm) > np.nanmax(wide.percept_map(5.0).error_mm)
    for wrong in (lambda: palm.weights((5, 5), "log", faces="nearest"), lambda: palm.weights((5, 5), faces="neerest"),
                  lambda: tactor.plan(palm, tactor.Stroke.preset("park2016-1"), phantom="log", faces="nearest")):
        assert refused(wrong).what == "faces"
