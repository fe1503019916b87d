# SPDX-License-Identifier: MIT
"""Plans as arrays, equal to those of the tool."""
import json
import pickle
import re

import numpy as np
import pytest

import tactor
from conftest import in_file, refused
from tactor import _tactor


def test_bursts_and_arrays_are_the_same(palm, stroke):
    plan = tactor.plan(palm, stroke, algorithm="park2016", phantom="inverse-distance", soa=0.07)
    bursts = plan.bursts
    assert len(bursts) == 18 and plan.curve is None and plan.soa == 0.07
    assert plan.amplitudes.shape == (18, 9) and plan.amplitudes.dtype == np.float64
    assert plan.onsets.tolist() == [b.onset for b in bursts] and plan.durations.tolist() == [b.duration for b in bursts]
    assert plan.positions.tolist() == [list(b.position) for b in bursts] and plan.intensities.tolist() == [b.intensity for b in bursts]
    dense = np.zeros((18, 9))
    for i, b in enumerate(bursts):
        for d in b.drives:
            dense[i, d.tactor] = d.amplitude
    assert np.array_equal(plan.amplitudes, dense) and np.allclose((dense ** 2).sum(axis=1), 1.0)
    onset, duration, position, intensity, drives = bursts[0]
    assert (onset, duration, position, intensity) == (0.0, 0.07, (0.0, 10.0), 1.0) and len(drives) == 2


def test_arrays_are_views_of_the_plan_and_outlive_it(palm, stroke):
    plan = tactor.plan(palm, stroke)
    onsets, positions, amplitudes = plan.onsets, plan.positions, plan.amplitudes
    assert amplitudes is plan.amplitudes
    for a in (onsets, positions, amplitudes, plan.durations, plan.taus):
        assert not a.flags.writeable and not a.flags.owndata
        with pytest.raises(ValueError):
            a[0] = 1
    before = onsets.tolist(), positions.tolist(), amplitudes.tolist()
    del plan
    junk = [tactor.plan(palm, stroke) for _ in range(50)]
    assert (onsets.tolist(), positions.tolist(), amplitudes.tolist()) == before and junk


def test_a_continuous_stroke_is_a_curve(palm, stroke):
    plan = tactor.plan(palm, stroke, algorithm="continuous", phantom="barycentric")
    assert plan.bursts == [] and plan.amplitudes.shape == (0, 9) and plan.onsets.shape == (0,) and plan.positions.shape == (0, 2)
    c = plan.curve
    assert len(c) == 1201 and c.t[-1] == 1.2 and c.positions.shape == (1201, 2) and c.amplitudes.shape == (1201, 9)
    assert np.allclose((c.amplitudes ** 2).sum(axis=1), 1.0) and np.all(c.intensities == 1.0)
    assert np.allclose(c.positions[600], stroke.position(0.6))


CASES = [
    (["park2016-1"], {}),
    (["park2016-3", "--algorithm", "tactile-brush", "--snap", "--drop-points"], dict(algorithm="tactile-brush", snap=True, drop_points=True)),
    (["park2016-2", "--algorithm", "continuous", "--phantom", "gaussian", "--overlap", "max"],
     dict(algorithm="continuous", phantom="gaussian", overlap="max")),
    (["park2016-4", "--soa", "0.06", "--burst", "0.05", "--timing", "fit", "--duration", "2.5", "--carrier", "200"],
     dict(soa=0.06, burst=0.05, timing="fit", duration=2.5, carrier=200)),
    (["park2016-4", "slope = 0.4", "intercept = 0.03", "--soa", "0.05", "--speed", "30"], dict(slope=0.4, intercept=0.03, soa=0.05, speed=30)),
    (["wave-2x4", "--fit", "--fit-margin", "1.5", "--phase", "burst", "--ramp", "0.003", "--level-dbfs", "-20", "--rate", "44100"],
     dict(fit=True, fit_margin=1.5, phase="burst", ramp=0.003, level_dbfs=-20, rate=44100)),
    (["round-2x4", "--outside", "clamp"], dict(outside="clamp")),
    (["park2016-3", "--faces", "nearest"], dict(faces="nearest")),
    (["park2016-3", "--compensate", "low-speed", "--sigma-mm", "2"], dict(compensate="low-speed", sigma_mm=2)),
]


@pytest.mark.parametrize("arguments,options", CASES)
def test_the_record_is_the_tool_s(tool, tmp_path, palm, arguments, options):
    plan = tactor.plan(palm, tactor.Stroke.preset(arguments[0]), **options)
    printed = json.loads(tool("plan", *in_file(tmp_path, arguments), "--format", "json"))
    assert plan.to_dict() == printed
    again = tactor.Plan.from_dict(printed)
    assert again == plan and hash(again) == hash(plan)
    assert again.to_dict() == printed
    assert np.array_equal(tactor.Score(palm, again).render(), tactor.Score(palm, plan).render())
    assert pickle.loads(pickle.dumps(plan)) == plan and pickle.loads(pickle.dumps(plan)).stroke == plan.stroke


def test_options_have_the_names_of_the_tools(tool):
    said = {name.replace("-", "_") for command in ("plan", "compare") for name in re.findall(r"--([a-z][a-z-]+)", tool(command, "--help-all"))}
    not_ours = {"help", "help_all", "path", "array", "config", "format", "sample_format", "algorithms", "phantoms", "output", "width", "dpi",
                "shape", "title", "force", "version", "intensity_max", "position"}  # objects and arguments of this package
    own = {"channels", "marker_channel", "marker_s", "power_dbfs", "max_drive_s", "drive_window_s",  # a score's, from files and `play`
           "usual_speed",  # from [defaults] speed
           "slope", "intercept", "min_duration", "sigma_v_mm_s", "stevens_exponent", "spread_seed",  # the tool's from files
           "tukey_part"}  # the tool's --envelope tukey:PART
    ours = {row["name"] for row in _tactor.option_rows() if {"plan", "score", "compare"} & set(row["places"])}
    assert said - not_ours == ours - own


def test_an_unknown_option_is_a_type_error(palm, stroke):
    with pytest.raises(TypeError):
        tactor.plan(palm, stroke, sao=0.07)
    with pytest.raises(TypeError):
        tactor.plan(palm, stroke, "park2016")


@pytest.mark.parametrize("options,what", [
    (dict(soa=0.5), "soa"), (dict(soa="0.07"), "soa"), (dict(soa=float("nan")), "soa"), (dict(algorithm="park"), "algorithm"),
    (dict(phantom="none"), "phantom"), (dict(timing=1), "timing"), (dict(fit="yes"), "fit"), (dict(fit_margin=1.0), "fit_margin"),
    (dict(carrier=-1), "carrier"), (dict(carrier=True), "carrier"), (dict(duration=1, speed=1), "duration"), (dict(level_dbfs=1), "level_dbfs"),
    (dict(level_dbfs=-3, sl=3), "level_dbfs"), (dict(rate=48000.5), "rate"), (dict(slope=1.0), "slope"), (dict(burst=0.08), "burst"),
    (dict(sigma_mm=3), "sigma_mm"), (dict(sigma_v_mm_s=80, compensate="none"), "sigma_v_mm_s"),
    (dict(noise_seed=3), "noise_seed"), (dict(noise_seed=3, waveform="square"), "noise_seed"), (dict(texture="time"), "texture"),
    (dict(texture_mm=3), "texture_mm"), (dict(stevens_exponent=0.6), "stevens_exponent"), (dict(tukey_part=0.3), "tukey_part"),
    (dict(envelope="tukey:x"), "envelope"), (dict(envelope="linear:0.3"), "envelope"), (dict(envelope="tukey:0.3", tukey_part=0.3), "envelope"),
    (dict(envelope="tukey:2"), "envelope"), (dict(envelope="tukey", attack=0.01), "attack"), (dict(envelope="tukey", ramp=0.01), "ramp"),
    (dict(waveform="sqare"), "waveform"), (dict(waveform=3), "waveform"), (dict(am="x"), "am"), (dict(am=-1.0), "am"),
    (dict(envelope="round"), "envelope"), (dict(attack=-1.0), "attack"), (dict(texture="x"), "texture"),
    (dict(stevens_exponent=0.0), "stevens_exponent"), (dict(noise_seed=1.5), "noise_seed"),
])
def test_impossible_options_are_refused_by_their_name(palm, stroke, options, what):
    e = refused(lambda: tactor.plan(palm, stroke, **options))
    assert e.what == what and e.why


def test_an_unused_observer_of_a_file_is_accepted(palm_with, stroke):
    array = palm_with("[defaults]\nsigma-mm = 2.0\n")
    assert tactor.plan(array, stroke).compensation is None
    moved = tactor.plan(array, stroke, compensate="low-speed").compensation
    assert moved["sigma_mm"] == 2.0
    with pytest.raises(tactor.InputError, match="nothing here uses it"):
        tactor.plan(array, stroke, sigma_mm=3.0)


@pytest.mark.parametrize("options", [{}, {"sl": 10}, {"level_dbfs": -10}, {"carrier": 24000}, {"algorithm": "continuous"}])
def test_a_plan_that_is_too_loud_at_its_level_is_pickled_and_described(palm, stroke, options):
    quiet = palm.replace(max_dbfs=-30)
    plan = tactor.plan(quiet, stroke, compensate="low-speed" if "algorithm" not in options else None, **options)
    refused(lambda: plan.to_dict())
    again = pickle.loads(pickle.dumps(plan))
    assert again == plan and hash(again) == hash(plan) and again.array == quiet and again.stroke == plan.stroke
    refused(lambda: again.to_dict())
    if "algorithm" not in options:
        assert plan.compensation == again.compensation == tactor.plan(palm, stroke, compensate="low-speed").compensation
    loud_enough = {"level_dbfs": -50, "rate": 96000}
    score = tactor.Score(quiet, plan, **loud_enough)
    assert pickle.loads(pickle.dumps(score)) == score == tactor.Score(quiet, again, **loud_enough)


def test_bursts_cannot_be_emptied(palm, stroke):
    plan = tactor.plan(palm, stroke)
    with pytest.raises(TypeError, match="cannot be changed"):
        plan.bursts.__init__([])
    assert len(plan.bursts) == 18 and pickle.loads(pickle.dumps(plan.bursts)) == plan.bursts


def test_plans_are_equal_where_they_play_the_same(palm, stroke):
    plan = tactor.plan(palm, stroke)
    assert plan == tactor.plan(palm, stroke) and plan != tactor.plan(palm, stroke, soa=0.06) and plan != 1
    assert repr(plan) == "<tactor.Plan of 'path': park2016, inverse-distance, 18 bursts, 1.26 s on 'palm-3x3'>"


@pytest.mark.parametrize("change", [
    lambda d: d.pop("array"), lambda d: d.update(schema="x"), lambda d: d.update(total_s="1"), lambda d: d["bursts"][0].pop("onset_s"),
    lambda d: d["bursts"][0]["drives"][0].update(tactor=9), lambda d: d.update(total_s=float("nan")), lambda d: d.update(total_s={1}),
])
def test_impossible_records_are_refused(palm, stroke, change):
    d = tactor.plan(palm, stroke).to_dict()
    change(d)
    refused(lambda: tactor.Plan.from_dict(d))


class Nearest:
    """A model that drives the nearest tactor alone."""

    name = "nearest"

    def __init__(self, array):
        self.positions = np.array(array.positions)

    def weights(self, x_mm, y_mm, intensity):
        return {int(np.hypot(*(self.positions - (x_mm, y_mm)).T).argmin()): intensity}


def test_a_model_may_be_a_python_object(palm, stroke):
    for algorithm in ("park2016", "continuous"):
        plan = tactor.plan(palm, stroke, algorithm=algorithm, phantom=Nearest(palm))
        assert plan.phantom == "nearest"
        amplitudes = plan.amplitudes if plan.curve is None else plan.curve.amplitudes
        assert set(np.unique(amplitudes)) == {0.0, 1.0} and (amplitudes.sum(axis=1) == 1).all()
        assert pickle.loads(pickle.dumps(plan)) == plan


def test_exceptions_of_a_model_come_out(palm, stroke):
    class Raises:
        def weights(self, x_mm, y_mm, intensity):
            raise ZeroDivisionError("mine")
    with pytest.raises(ZeroDivisionError, match="mine"):
        tactor.plan(palm, stroke, algorithm="continuous", phantom=Raises())


def test_sensations_are_predicted(palm, stroke):
    plan = tactor.plan(palm, stroke, algorithm="continuous", phantom="barycentric")
    samples = plan.percept()
    assert len(samples) == 1201 and samples[600].target == pytest.approx(samples[600].felt, abs=1e-9)
    felt = plan.percept_summary()
    assert felt["rms_error_mm"] < 1e-9
    assert set(felt) == {*"rms_error_mm largest_error_mm lag_s rms_at_lag_mm along_rms_mm along_max_mm across_rms_mm across_max_mm".split(),
                         *"rms_to_path_mm speed_cv intensity_cv silent_share shared_share".split()}
    assert felt["lag_s"] == 0 and felt["rms_to_path_mm"] < 1e-9


def test_the_timing_law():
    assert tactor.burst_duration(soa=0.07) == pytest.approx(0.07) and tactor.burst_duration(soa=0.06) == pytest.approx((0.06 - 0.0473) / 0.32)
    assert tactor.burst_duration(soa=0.07, burst=0.02) == 0.02


def test_a_stroke_keeps_its_time_beside_a_files_speed(palm_with):
    slow = palm_with("[defaults]\nspeed = 20\n")
    path = tactor.Path.svg("M 0 20 L 40 20")
    lasts = {name: tactor.plan(slow, s, **options).to_dict()["stroke"]["duration_s"] for name, s, options in (
        ("time", tactor.Stroke.along(path, duration=1.0), {}), ("speed", tactor.Stroke.along(path, speed=80.0), {}),
        ("neither", tactor.Stroke.along(path), {}), ("asked", tactor.Stroke.along(path, duration=1.0), {"speed": 40}),
        ("copy", pickle.loads(pickle.dumps(tactor.Stroke.along(path))), {}), ("preset", tactor.Stroke.preset("park2016-1"), {}))}
    assert lasts == pytest.approx({"time": 1.0, "speed": 0.5, "neither": 2.0, "asked": 1.0, "copy": 2.0, "preset": 1.4})


def test_a_file_s_value_is_the_default(palm_with, tool):
    quiet = palm_with('[defaults]\nphantom = "barycentric"\nlevel-dbfs = -30\nsoa = 0.06\n[output]\nchannels = 12\nrate = 44100\n')
    plan = tactor.plan(quiet, tactor.Stroke.preset("park2016-1"), soa=0.065)
    assert plan.phantom == "barycentric" and plan.soa == 0.065
    assert plan.to_dict() == json.loads(tool("plan", "park2016-1", "--array", "palm.toml", "--soa", "0.065", "--format", "json"))
    score = tactor.Score(quiet, plan)
    assert (score.channels, score.rate) == (12, 44100) and tactor.Score(pickle.loads(pickle.dumps(quiet)), plan).channels == 12
    assert np.abs(score.render()).max() < 10 ** (-29.9 / 20)
    assert tactor.Score(quiet, plan, rate=48000, channels=9).channels == 9
    noisy = palm_with('[defaults]\nwaveform = "noise:50-300"\nnoise-seed = 7\nam = "30:0.5"\nenvelope = "tukey:0.3"\n')
    rough = tactor.plan(noisy, tactor.Stroke.preset("park2016-1")).to_dict()
    assert rough == json.loads(tool("plan", "park2016-1", "--array", "palm.toml", "--format", "json"))
    assert rough["render"]["envelope"]["tukey_part"] == 0.3
