# SPDX-License-Identifier: MIT
"""Samples, equal to the bytes of `tactor render`."""
import os
import pickle
import random
import threading

import numpy as np
import pytest

import tactor
from conftest import in_file, refused


def samples(file, dtype):
    """Returns the samples of a WAV file, behind which the tool's mark stands."""
    data = file.read_bytes()
    at = data.index(b"data") + 8
    return np.frombuffer(data[at:at + int.from_bytes(data[at - 4:at], "little")], dtype=dtype)


@pytest.mark.parametrize("dtype,name", [("float32", "float"), ("int16", "s16"), ("int32", "s32")])
def test_samples_are_those_of_the_tool(tool, tmp_path, palm, dtype, name):
    score = tactor.Score(palm, tactor.plan(palm, tactor.Stroke.preset("park2016-3")), level_dbfs=-6)
    x = score.render(dtype)
    assert x.shape == (score.frames, 9) and x.dtype == dtype and score.render(np.dtype(dtype)).dtype == dtype
    tool("render", "park2016-3", "--level-dbfs", "-6", "--sample-format", name, "-o", "tool.wav")
    assert x.tobytes() == samples(tmp_path / "tool.wav", dtype).tobytes()
    score.write(tmp_path / "ours.wav", name)
    score.write(str(tmp_path / "str.wav"), sample_format=name)
    assert (tmp_path / "ours.wav").read_bytes() == (tmp_path / "tool.wav").read_bytes() == (tmp_path / "str.wav").read_bytes()


def test_24_bits_are_written(tool, tmp_path, palm):
    tool("render", "park2016-3", "--sample-format", "s24", "-o", "tool.wav")
    tactor.Score(palm, tactor.plan(palm, tactor.Stroke.preset("park2016-3"))).write(tmp_path / "ours.wav", "s24")
    assert (tmp_path / "ours.wav").read_bytes() == (tmp_path / "tool.wav").read_bytes()


def test_samples_belong_to_the_caller(palm, stroke):
    score = tactor.Score(palm, tactor.plan(palm, stroke))
    x = score.render()
    x *= 2
    assert np.array_equal(score.render() * 2, x) and np.array_equal(score.to_numpy() * 2, x) and x.flags.c_contiguous


def random_array(rng):
    if rng.random() < 0.3:
        return tactor.Array.preset("palm-3x3")
    rows, columns = rng.randint(2, 4), rng.randint(2, 5)
    x, y = rng.uniform(8, 30), rng.uniform(8, 30)
    places = [(c * x + rng.uniform(-2, 2), r * y + rng.uniform(-2, 2)) for r in range(rows) for c in range(columns)]
    channels = rng.sample(range(len(places) + 3), len(places))
    return tactor.Array("random", [tactor.Tactor(tactor.Point(*p), n, gain_db=rng.choice([0.0, -1.5]), polarity=rng.choice([1, 1, -1]))
                                   for p, n in zip(places, channels)])


def array_file(array):
    lines = [f'[array]\nname = "{array.name}"\n']
    lines += [f"[[tactor]]\nx_mm = {t.position.x!r}\ny_mm = {t.position.y!r}\nchannel = {t.channel}\ngain_db = {t.gain_db!r}\n"
              f"polarity = {t.polarity}\n" for t in array]
    return "".join(lines)


def random_stroke(rng, name, start):
    def number(lo, hi):
        return round(rng.uniform(lo, hi), rng.randint(0, 6))
    if rng.random() < 0.5:
        kind = rng.choice("LCA")
        if kind == "A":
            data = f"M {number(0, 40)} {number(0, 40)} A {number(10, 30)} {number(10, 30)} {number(0, 90)} 0 1 {number(41, 60)} {number(0, 40)}"
        else:
            data = f"M {number(0, 10)} {number(0, 40)} {kind} " + " ".join(f"{number(20, 60)} {number(0, 60)}" for _ in range(3 if kind == "C" else 2))
        length = number(0.05, 0.3)
        stroke = tactor.Stroke.along(tactor.Path.svg(data), duration=max(length, 0.05), name=name, start=start)
        return stroke, f'path = "{data}"\nduration_s = {max(length, 0.05)!r}\n'
    times = [0.0, number(0.01, 0.1) + 0.01, number(0.1, 0.3) + 0.2]
    xs, ys, intensities = ([number(0, 60) for _ in range(3)] for _ in range(3))
    intensities = [round(v / 60, 3) for v in intensities]
    stroke = tactor.Stroke.timed(times, xs, ys, intensities, name=name, start=start)
    points = ", ".join(f"[{t!r}, {x!r}, {y!r}, {i!r}]" for t, x, y, i in zip(times, xs, ys, intensities))
    return stroke, f"timed = [{points}]\n"


def random_options(rng):
    options = {"outside": "clamp", "algorithm": rng.choice(["park2016", "park2016", "continuous"]),
               "phantom": rng.choice(["inverse-distance", "barycentric", "linear", "log", "gaussian"])}
    maybe = {"soa": lambda: rng.uniform(0.05, 0.07), "carrier": lambda: rng.uniform(60, 400), "phase": lambda: "burst",
             "ramp": lambda: rng.uniform(0, 0.01), "level_dbfs": lambda: rng.uniform(-60, -20), "rate": lambda: rng.choice([8000, 16000, 44100, 48000]),
             "overlap": lambda: rng.choice(["max", "sum"]), "burst": lambda: rng.uniform(0.01, 0.05)}
    options |= {name: make() for name, make in maybe.items() if rng.random() < 0.4}
    options.setdefault("level_dbfs", -40.0)
    return options


# Pieces of many strokes, so that the tool need not start for each.
@pytest.mark.parametrize("seed", range(2 if os.environ.get("TACTOR_SOAK") == "short" else 50))
def test_ten_thousand_random_strokes_are_the_bytes_of_the_tool(tool, tmp_path, seed):
    rng = random.Random(seed)
    array = random_array(rng)
    (tmp_path / "array.toml").write_text(array_file(array))
    assert tactor.Array.from_file(tmp_path / "array.toml") == array or array.name == "palm-3x3"
    options = random_options(rng)
    strokes, text = [], []
    for i in range(200):
        start = rng.choice([None, None, round(rng.uniform(0, 20), 3)])
        stroke, toml = random_stroke(rng, f"s{i}", start)
        strokes.append(stroke)
        text.append(f'[[stroke]]\nname = "s{i}"\n{toml}' + (f"start_s = {start!r}\n" if start is not None else ""))
    (tmp_path / "strokes.toml").write_text("".join(text))
    dtype, name = rng.choice([("float32", "float"), ("int16", "s16"), ("int32", "s32")])
    arguments = [a for option, value in options.items() for a in (f"--{option.replace('_', '-')}", repr(value) if isinstance(value, float) else value)]
    tool("render", "strokes.toml", "--array", "array.toml", *arguments, "--sample-format", name, "-o", "tool.wav")
    sound = {n: options.pop(n) for n in ("level_dbfs", "rate", "phase", "ramp") if n in options}
    score = tactor.Score(array, [tactor.plan(array, s, **options) for s in strokes], **sound)
    assert score.render(dtype).tobytes() == samples(tmp_path / "tool.wav", dtype).tobytes()


def test_pieces_of_several_plans(tool, tmp_path, root, palm):
    file = root / "examples/strokes/several.toml"
    plans = [tactor.plan(palm, s) for s in tactor.load(file)]
    tool("render", file, "-o", "tool.wav")
    score = tactor.Score(palm, plans)
    assert score.render().tobytes() == samples(tmp_path / "tool.wav", "float32").tobytes() and len(score.plans) == len(plans)
    shifted = tactor.Score(palm, [(0.5, plans[0]), (None, plans[1])])
    assert shifted.starts[0] == 24000 and shifted.starts[1] >= 24000
    assert not shifted.render()[:24000].any()


def test_markers_and_limits(palm, stroke):
    plan = tactor.plan(palm, stroke)
    marked = tactor.Score(palm, plan, marker_channel=9, marker_s=0.01)
    assert marked.channels == 10 and (marked.render()[:480, 9] == 1.0).all() and not marked.render()[480:, 9].any()
    for recorded in (tactor.Plan.from_dict(plan.to_dict()), pickle.loads(pickle.dumps(plan))):
        assert np.array_equal(tactor.Score(palm, recorded, marker_channel=9, marker_s=0.01).render(), marked.render())
    assert pickle.loads(pickle.dumps(marked)) == marked
    refused(lambda: tactor.Score(palm, plan, marker_channel=9, channels=9))
    limited = tactor.Score(palm, plan, level_dbfs=0, power_dbfs=-20)
    assert np.abs(limited.render()).max() < np.abs(tactor.Score(palm, plan, level_dbfs=0).render()).max()


@pytest.mark.parametrize("planned,said,what", [
    ({}, dict(tukey_part=0.3), "tukey_part"), (dict(envelope="linear"), dict(tukey_part=0.3), "tukey_part"), ({}, dict(marker_s=0.01), "marker_s"),
    (dict(envelope="tukey"), dict(ramp=0.01), "ramp"), (dict(envelope="tukey"), dict(attack=0.01), "attack"), ({}, dict(envelope="tukey", ramp=0.01), "ramp"),
])
def test_options_that_nothing_in_a_score_uses_are_refused(palm, stroke, planned, said, what):
    plan = tactor.plan(palm, stroke, **planned)
    for one in (plan, tactor.Plan.from_dict(plan.to_dict()), pickle.loads(pickle.dumps(plan))):
        assert refused(lambda: tactor.Score(palm, one, **said)).what == what


def test_a_score_may_add_to_its_plan_s_options(palm, palm_with, stroke):
    plan = tactor.plan(palm, stroke, envelope="tukey")
    expected = tactor.Score(palm, plan, envelope="tukey", tukey_part=0.3).render()
    assert np.array_equal(tactor.Score(palm, plan, tukey_part=0.3).render(), expected)
    assert not np.array_equal(tactor.Score(palm, plan).render(), expected)
    for p in (plan, tactor.plan(palm, stroke)):
        assert np.array_equal(tactor.Score(palm, p, envelope="tukey:0.3").render(), expected)
    assert np.array_equal(tactor.Score(palm, tactor.plan(palm, stroke, envelope="tukey:0.3")).render(), expected)
    array = palm_with("[defaults]\nramp = 0.003\n[sync]\nchannel = 9\n")
    for p in (plan, tactor.plan(array, stroke)):
        score = tactor.Score(array, p, envelope="tukey", marker_s=0.01)
        assert (score.render()[:480, 9] == 1.0).all() and pickle.loads(pickle.dumps(score)) == score


@pytest.mark.parametrize("make", [
    lambda a, p: tactor.Score(a, []), lambda a, p: tactor.Score(a, p, level_dbfs=1), lambda a, p: tactor.Score(a, p, sl=10),
    lambda a, p: tactor.Score(a, p, rate=100), lambda a, p: tactor.Score(a, p, channels=3), lambda a, p: tactor.Score(a, p, marker_channel=0),
    lambda a, p: tactor.Score(tactor.Array.preset("palm-2x4"), p), lambda a, p: tactor.Score(a, p).render("float64"),
    lambda a, p: tactor.Score(a, p).render("nonsense"), lambda a, p: tactor.Score(a, p).render(">i2"),
    lambda a, p: tactor.Score(a, p).write("/nonexistent/x.wav"), lambda a, p: tactor.Score(a, p).write("x.wav", "s24-4"),
    lambda a, p: tactor.Score(a, [(float("nan"), p)]), lambda a, p: tactor.Score(a, [(-1.0, p)]),
])
def test_impossible_scores_are_refused(palm, stroke, make):
    refused(lambda: make(palm, tactor.plan(palm, stroke)))


def test_anything_but_a_plan_is_a_type_error(palm):
    with pytest.raises(TypeError):
        tactor.Score(palm, [1])


def test_scores_are_values(palm, stroke):
    score = tactor.Score(palm, [(0.1, tactor.plan(palm, stroke))], level_dbfs=-20)
    again = pickle.loads(pickle.dumps(score))
    assert again == score and np.array_equal(again.render(), score.render())
    assert repr(score) == f"<tactor.Score: 1 plan, 9 channels, 48000 Hz, {score.duration:.6g} s>" and len(score) == score.frames


def test_a_score_keeps_its_plan_s_options_from_any_source(tmp_path, palm_with, stroke):
    quiet = palm_with("[defaults]\nlevel-dbfs = -30\n")
    plan = tactor.plan(quiet, stroke, level_dbfs=-50)
    expected = tactor.Score(quiet, plan).render()
    assert np.abs(expected).max() < 10 ** (-49.9 / 20)
    recorded = tactor.Plan.from_dict(plan.to_dict())
    again = pickle.loads(pickle.dumps(plan))
    for one in (recorded, again, pickle.loads(pickle.dumps(recorded))):
        assert np.array_equal(tactor.Score(quiet, one).render(), expected)
        assert np.array_equal(tactor.Score(tactor.Array.from_file(tmp_path / "palm.toml"), one).render(), expected)
    score = tactor.Score(quiet, plan)
    assert np.array_equal(pickle.loads(pickle.dumps(score)).render(), expected)
    plain = tactor.plan(tactor.Array.preset("palm-3x3"), stroke)  # without a file's values
    for one in (plain, pickle.loads(pickle.dumps(plain))):
        assert 10 ** (-35 / 20) < np.abs(tactor.Score(quiet, one).render()).max() < 10 ** (-29.9 / 20)


def test_rendering_releases_the_interpreter(palm, stroke):
    # The main thread counts while another renders: a held lock would stop it.
    score = tactor.Score(palm, [tactor.plan(palm, stroke, algorithm="continuous")] * 200)
    expected = score.render("int16")[:1000].copy()
    results = []
    ends = threading.Event()

    def work():
        results.append(score.render("int16")[:1000].copy())
        ends.set()
    threads = [threading.Thread(target=work)]
    threads[0].start()
    counted = 0
    while not ends.is_set():
        counted += 1
    threads[0].join()
    assert counted > 1000 and np.array_equal(results[0], expected)


@pytest.mark.parametrize("sound", [{"waveform": "square"}, {"waveform": "noise:50-500", "noise_seed": 7}, {"am": "30:0.5"},
                                   {"waveform": "triangle", "envelope": "linear", "attack": 0.01, "release": 0.02},
                                   {"intensity_scale": "stevens", "stevens_exponent": 0.9}])
def test_waves_and_envelopes_are_those_of_the_tool(tool, tmp_path, palm, sound):
    options = [o for name, value in sound.items()
               for o in ([f"stevens-exponent = {value}"] if name == "stevens_exponent" else [f"--{name.replace('_', '-')}", str(value)])]
    tool("render", "park2016-3", *in_file(tmp_path, options), "-o", "tool.wav")
    x = tactor.Score(palm, tactor.plan(palm, tactor.Stroke.preset("park2016-3"), **sound)).render("float32")
    assert x.tobytes() == samples(tmp_path / "tool.wav", "float32").tobytes()


def test_strokes_keep_their_sound_when_they_are_pickled(palm):
    text = '[stroke]\npath = "M 0 0 L 40 0"\nwaveform = "noise:50-300"\nam_hz = 20\ncarrier_profile = [[0, 100], [1, 200]]\n'
    one = tactor.parse(text)[0]
    again = pickle.loads(pickle.dumps(one))
    assert tactor.Score(palm, tactor.plan(palm, again)).render().tobytes() == tactor.Score(palm, tactor.plan(palm, one)).render().tobytes()
