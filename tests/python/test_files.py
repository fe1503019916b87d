# SPDX-License-Identifier: MIT
"""Plans, strokes and records as files."""
import hashlib
import json
import os
import re
import warnings
import wave

import numpy as np
import pytest

import tactor
from conftest import refused

PATH = "M 0 10 C 20 -5 20 45 40 30"


def drawn():
    path = tactor.Path.svg(PATH)
    yield tactor.Stroke.along(path, 1.2)
    yield tactor.Stroke.along(path, speed=47.0, name="a \"b\"", start=0.3, carrier=120)
    yield tactor.Stroke.along(path, 1.7, intensity=0.3).reversed().with_duration(0.123456789)
    yield tactor.Stroke.along(path, 1.0, easing="minimum-jerk")
    yield tactor.Stroke.along(path, 2.0, pauses=[(0.2, 0.1), (0.5, 0.3, 0.0)], intensity=[(0, 0.2), (1, 1)], easing="in-out")
    yield tactor.Stroke.timed([0, 0.1, 0.5], [0, 10, 40], [0, 20, 5], [1, 0.35, 0], name="t")
    yield tactor.Stroke.timed([0, 0.1, 0.5], [0, 10, 40], [0, 20, 5]).with_duration(0.7)
    yield tactor.Stroke.preset("park2016-3")
    yield tactor.Stroke.preset("wave-2x4")
    yield tactor.parse(f'[stroke]\nname = "all"\npath = "{PATH}"\nduration_s = 1.0\nam_hz = 30.0\nam_depth = 0.5\nwaveform = "noise:60-400"\nnoise_seed = 7\n'
                       'algorithm = "continuous"\nphantom = "barycentric"\nsoa_s = 0.06\nburst_s = 0.05\nfaces = "nearest"\nlevel_db = -3.0\nfit = true\nfit_margin_mm = 2.0\n')[0]
    yield tactor.parse(f'[stroke]\npath = "{PATH}"\nduration_s = 1.0\ncarrier_profile = [[0.0, 100.0], [1.0, 300.0]]\n', "p")[0]


@pytest.mark.parametrize("stroke", list(drawn()), ids=str)
def test_strokes_are_written_and_read_again(tmp_path, stroke):
    stroke.write(tmp_path / "s.toml")
    (again,) = tactor.load(tmp_path / "s.toml")
    assert again == stroke and again.note == stroke.note


def test_numbers_that_are_not_exact_are_written_closely(tmp_path):
    for stroke in (tactor.Stroke.along(tactor.Path.svg(PATH), speed=[(0, 20), (1, 80)], pauses=[(0.5, 0.2)]),
                   tactor.Stroke.along(tactor.Path.arc((20, 20), 8, 0, 300), 1.0, easing="in-out"),
                   tactor.Stroke.along(tactor.Path.svg(PATH), 3.0, speed=[(0, 20), (0.5, 80)]).with_duration(1.5),
                   *map(tactor.Stroke.shape, tactor.stroke_shapes())):
        stroke.write(tmp_path / "s.toml")
        (again,) = tactor.load(tmp_path / "s.toml")
        t = np.linspace(0, stroke.duration, 100)
        assert again.duration == pytest.approx(stroke.duration, rel=1e-12)
        assert np.allclose(again.position(t), stroke.position(t), rtol=0, atol=1e-8)


def test_strokes_that_were_read_are_changed_and_written_again(tmp_path, palm, stroke):
    stroke.write(tmp_path / "s.toml")
    palm.write(tmp_path / "a.toml")
    tactor.plan(palm, stroke).write(tmp_path / "p.json")
    for _ in range(2):
        (again,) = tactor.load(tmp_path / "s.toml")
        again.with_duration(again.duration / 2).write(tmp_path / "s.toml")
        array = tactor.Array.from_file(tmp_path / "a.toml")
        array.replace(gains=array[0].gain_db - 1).write(tmp_path / "a.toml")
        tactor.load_plan(tmp_path / "p.json").write(tmp_path / "p.json")
    assert tactor.load(tmp_path / "s.toml")[0].duration == pytest.approx(stroke.duration / 4)
    assert tactor.Array.from_file(tmp_path / "a.toml")[0].gain_db == palm[0].gain_db - 2


def test_a_file_that_somebody_wrote_or_changed_is_replaced_by_force_only(tmp_path, palm, stroke):
    plan, other = tactor.plan(palm, stroke), tactor.plan(palm, tactor.Stroke.preset("park2016-2"))
    for write, write_other, name in ((stroke.write, other.stroke.write, "s.toml"), (palm.write, palm.replace(gains=-1.0).write, "a.toml"),
                                     (tactor.Score(palm, plan).write, tactor.Score(palm, other).write, "s.wav"), (plan.write, other.write, "p.json")):
        file = tmp_path / name
        file.write_bytes(b"")
        write(file)
        ours = file.read_bytes()
        write(file)
        assert file.read_bytes() == ours
        if name != "p.json":  # what is not as tactor wrote it; a plan, whose bytes are its identity, has no place for a hash
            digits = re.search(rb"sha256 ([0-9a-f]{64})", ours)
            note = ours[-92:] if name == "s.wav" else ours[digits.start() - 3:]
            assert hashlib.sha256(ours.replace(note, b"")).hexdigest() == digits[1].decode()
            write_other(file)
            write(file)
        else:
            assert "other content" in refused(lambda: write_other(file)).why
        for changed in (b"x" + ours, ours + b"\n", b"a year of work"):
            file.write_bytes(changed)
            assert "force=True" in refused(lambda: write(file)).hint
            assert file.read_bytes() == changed
            write(file, force=True)
            assert file.read_bytes() == ours


def test_sound_does_not_replace_a_file_that_was_read(tmp_path, palm, stroke):
    score = tactor.Score(palm, tactor.plan(palm, stroke))
    score.write(tmp_path / "tone.wav")
    score.write(tmp_path / "tone.wav")  # not an input yet
    with wave.open(str(tmp_path / "tone.wav"), "wb") as tone:
        tone.setparams((1, 2, 48000, 0, "NONE", ""))
        tone.writeframes(bytes(range(128)))
    stroke.write(tmp_path / "s.toml")
    textured = tactor.plan(palm, tactor.load(tmp_path / "s.toml")[0], waveform=str(tmp_path / "tone.wav"))
    os.link(tmp_path / "s.toml", tmp_path / "link.wav")
    before = (tmp_path / "tone.wav").read_bytes(), (tmp_path / "s.toml").read_bytes()
    for name in ("tone.wav", "link.wav"):
        with pytest.raises(tactor.InputError, match="an input"):
            tactor.Score(palm, textured).write(tmp_path / name)
    assert before == ((tmp_path / "tone.wav").read_bytes(), (tmp_path / "s.toml").read_bytes())


def test_strokes_that_no_file_can_hold_are_refused(tmp_path, stroke):
    with pytest.raises(tactor.InputError, match="factor from 0 to 1"):
        stroke.with_intensity(2.0).write(tmp_path / "s.toml")
    with pytest.raises(tactor.InputError, match="TOML"):
        stroke.write(tmp_path / "s.svg")
    grouped = tactor.parse(f'[[stroke]]\nfit = true\n[[stroke.stroke]]\npath = "{PATH}"\n[[stroke.stroke]]\npath = "{PATH}"\n')
    with pytest.raises(tactor.InputError, match="group"):
        grouped[0].write(tmp_path / "s.toml")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("how", [{}, {"algorithm": "continuous"}, {"level_dbfs": -20, "rate": 44100, "envelope": "tukey:0.2"}])
def test_plans_are_written_and_read_again(tool, tmp_path, palm, stroke, how):
    plan = tactor.plan(palm, stroke, **how)
    plan.write(tmp_path / "p.json")
    again = tactor.load_plan(tmp_path / "p.json")
    assert again == plan and tactor.Score(palm, again) == tactor.Score(palm, plan)
    tool("render", "p.json", "-o", "tool.wav")
    tactor.Score(palm, plan).write(tmp_path / "ours.wav")
    assert (tmp_path / "ours.wav").read_bytes() == (tmp_path / "tool.wav").read_bytes()
    (tmp_path / "tool.json").write_text(tool("plan", "park2016-1", "--format", "json"))
    assert tactor.load_plan(str(tmp_path / "tool.json")).algorithm == "park2016"
    with pytest.raises(tactor.InputError, match="JSON"):
        plan.write(tmp_path / "p.txt")


def test_files_of_several_plans_say_so(tool, tmp_path, root):
    (tmp_path / "two.json").write_text(tool("plan", root / "examples/strokes/several.toml", "--format", "json"))
    e = refused(lambda: tactor.load_plan(tmp_path / "two.json"))
    assert "plans in it" in e.why and e.file == str(tmp_path / "two.json")
    one, *_ = json.loads((tmp_path / "two.json").read_text())["plans"]
    assert tactor.Plan.from_dict(one)


def changed(record, value, *keys):
    record = json.loads(json.dumps(record))
    at = record
    for key in keys[:-1]:
        at = at[key]
    at[keys[-1]] = value
    return record


@pytest.mark.parametrize("keys,hint", [
    (("levl_dbfs",), "see"), (("render", "level_db"), "level_dbfs"), (("stroke", "durations"), "duration_s"), (("array", "tactors", 2, "chanel"), "channel"),
    (("bursts", 3, "onsets"), "onset_s"), (("bursts", 3, "drives", 0, "amplitudes"), "amplitude")])
def test_keys_that_no_plan_has_are_refused(palm, stroke, tmp_path, keys, hint):
    record = changed(tactor.plan(palm, stroke).to_dict(), 1, *keys)
    e = refused(lambda: tactor.Plan.from_dict(record))
    assert e.field.endswith(keys[-1]) and hint in e.hint and e.file is None
    (tmp_path / "p.json").write_text(json.dumps(record))
    assert refused(lambda: tactor.load_plan(tmp_path / "p.json")).file == str(tmp_path / "p.json")


def test_strokes_are_saved_in_every_format_as_the_tool_converts_them(tool, tmp_path, palm, stroke):
    two = [stroke, tactor.Stroke.timed([0, 0.3, 1], [0, 20, 40], [0, 40, 0], name="timed", start=0.25)]
    tactor.save(two, tmp_path / "two.toml")
    assert [(s.name, s.start) for s in tactor.load(tmp_path / "two.toml")] == [(s.name, s.start) for s in two]
    with pytest.warns(UserWarning, match="SVG cannot hold the exact movement .* of stroke 2"):
        tactor.save(two, tmp_path / "two.svg")
    again = tactor.load(tmp_path / "two.svg")
    assert [(s.name, s.start, s.duration) for s in again] == [(s.name, s.start, s.duration) for s in two]
    assert tactor.plan(palm, again[0]) == tactor.plan(palm, stroke)
    with pytest.warns(UserWarning, match="CSV cannot hold the start"):
        tactor.save(two[1], tmp_path / "one.csv")
    with pytest.warns(UserWarning, match="HAPTIC cannot hold the movement of 2 strokes"):
        tactor.save(two, tmp_path / "two.haptic")
    assert tactor.load(tmp_path / "two.haptic")[0].duration == max(stroke.duration, 1.25)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tactor.save(tactor.load(tmp_path / "two.haptic"), tmp_path / "two.haptic")
    tool("convert", "two.toml", "tool.toml")
    assert (tmp_path / "tool.toml").read_text() == (tmp_path / "two.toml").read_text()
    for name in ("two.csv", "two.json", "two", "two.txt"):
        with pytest.raises(tactor.InputError):
            tactor.save(two, tmp_path / name)
    with pytest.raises(tactor.InputError, match="no stroke"):
        tactor.save([], tmp_path / "none.toml")
    (tmp_path / "two.toml").write_text("# mine\n")
    with pytest.raises(tactor.InputError, match="force=True"):
        tactor.save(two, tmp_path / "two.toml")
    tactor.save(two, tmp_path / "two.toml", force=True)
    assert len(tactor.load(tmp_path / "two.toml")) == 2


def test_the_actuator_of_an_array_file_plays_vibrations(tool, palm_with, root, tmp_path, palm):
    array = palm_with("[texture]\nlow_hz = 80\nhigh_hz = 300\nemphasis_high_wave = \"triangle\"\n")
    knock = root / "examples/strokes/knock.haptic"
    texture = {"waveform": str(knock), "texture": "time"}
    (tmp_path / "knock.haptic").write_bytes(knock.read_bytes())
    of_tool = {"texture": ("park2016-1", "--waveform", "knock.haptic", "--texture", "time"), "touch": ("knock.haptic",)}
    ours = {"texture": [tactor.plan(array, tactor.Stroke.preset("park2016-1"), **texture)],
            "touch": [tactor.plan(array, s) for s in tactor.apply_fits(tactor.load(knock, array=array), array)]}
    for name, args in of_tool.items():
        tool("render", *args, "--array", "palm.toml", "-o", f"{name}.wav")
        tactor.Score(array, ours[name]).write(tmp_path / f"{name}-ours.wav")
        assert (tmp_path / f"{name}-ours.wav").read_bytes() == (tmp_path / f"{name}.wav").read_bytes()
    assert array != palm and tactor.load(knock, array=array) != tactor.load(knock)
    array.write(tmp_path / "again.toml")
    assert tactor.Array.from_file(tmp_path / "again.toml") == array
    with pytest.raises(TypeError, match="array"):
        tactor.load(knock, array="palm-3x3")
