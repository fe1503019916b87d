# SPDX-License-Identifier: MIT
"""Exceptions: fault and place."""
import errno
import json
import os
import pickle

import pytest

import tactor


def test_they_have_families():
    assert issubclass(tactor.InputError, tactor.Error) and issubclass(tactor.InputError, ValueError)
    assert issubclass(tactor.DeviceError, tactor.Error) and issubclass(tactor.DeviceError, OSError)
    assert issubclass(tactor.StreamError, tactor.Error) and issubclass(tactor.StreamError, RuntimeError)
    assert issubclass(tactor.Error, Exception)


def test_they_have_parts(palm, stroke):
    with pytest.raises(tactor.Error) as e:
        tactor.plan(palm, stroke, soa=0.5)
    assert (e.value.what, e.value.hint) == ("soa", "use 0.07") and e.value.why.startswith("0.5 s is out of bounds")
    assert str(e.value) == f"{e.value.what}: {e.value.why} ({e.value.hint})"
    assert (e.value.file, e.value.line, e.value.column) == (None, None, None)
    assert (e.value.field, e.value.errno) == ("soa", 0)
    with pytest.raises(tactor.InputError) as e:
        tactor.Array.grid("flat", 2, 2, (10.0, 0.0))
    assert e.value.field == "pitch_mm"


def test_files_have_line_and_column(tmp_path):
    file = tmp_path / "a: b.toml"
    file.write_text('[array]\nname = "x"\npich = 3\n')
    with pytest.raises(tactor.InputError) as e:
        tactor.Array.from_file(file)
    assert (e.value.file, e.value.line, e.value.column) == (str(file), 3, 1)
    assert e.value.field == "pich"
    file.write_text('[[stroke]]\npath = "M 0 0 L"\n')
    with pytest.raises(tactor.InputError) as e:
        tactor.load(file)
    assert (e.value.file, e.value.line) == (str(file), 2)
    for missing in (lambda: tactor.load(tmp_path / "none.toml"), lambda: tactor.Array.from_file(tmp_path / "none.toml")):
        with pytest.raises(tactor.InputError) as e:
            missing()
        assert e.value.file == str(tmp_path / "none.toml") and e.value.line is None
        assert e.value.errno == errno.ENOENT


def test_file_names_may_be_any_bytes(tmp_path):
    name = (tmp_path / "x").as_posix() + "\udcff.toml"
    with pytest.raises(tactor.InputError) as e:
        tactor.load(name)
    assert e.value.file == name


def test_the_file_name_of_a_device_error_is_no_hint():
    assert tactor.DeviceError("what", "why", "hint").filename is None
    e = pickle.loads(pickle.dumps(tactor.DeviceError("what", "why", "hint", file="f")))
    assert (e.filename, e.hint, str(e)) == ("f", "hint", "what: why (hint)")


@pytest.mark.parametrize("kind", [tactor.Error, tactor.InputError, tactor.DeviceError, tactor.StreamError])
def test_they_are_pickled(kind):
    e = kind("what", "why", "hint", file="f", line=1, column=2, field="x_mm", errno=5)
    again = pickle.loads(pickle.dumps(e))
    assert type(again) is kind and str(again) == str(e) == "what: why (hint)"
    assert (again.what, again.why, again.hint, again.file, again.line, again.column) == ("what", "why", "hint", "f", 1, 2)
    assert (again.field, again.errno) == ("x_mm", 5)
    assert e.args == ("what", "why", "hint") and "hint" in repr(e)


@pytest.mark.parametrize("call,hint", [
    (lambda a, out: tactor.plan(a, tactor.Stroke.along(out, duration=1)), 'fit=True scales it to the array, outside="clamp" plays'),
    (lambda a, out: tactor.plan(a, tactor.Stroke.preset("wave-2x4")), 'Array.preset("palm-2x4") is the one it is drawn for, fit=True'),
    (lambda a, out: tactor.plan(a, tactor.Stroke.along(tactor.Path.svg("M 5 7 H 20"), duration=1), algorithm="tactile-brush"), "snap=True moves it there"),
    (lambda a, out: tactor.plan(a, tactor.Stroke.along(out, duration=1), faces="nearest", phantom="log"), 'use faces="delaunay" or phantom="inverse-distance"'),
])
def test_hints_name_keyword_arguments(palm, call, hint):
    with pytest.raises(tactor.Error) as e:
        call(palm, tactor.Path.svg("M 0 10 L 70 33"))
    assert hint in e.value.hint and "{" not in str(e.value)


@pytest.mark.parametrize("text,hint,field", [
    ('[[stroke]]\npath = "M 0 0 L 9 9"\nduration = 1\n', "did you mean 'duration_s'?", "duration"),
    ('[[stroke]]\npath = "M 0 0 L 9 9"\nspeed = 1\n', "did you mean 'speed_mm_s'?", "speed"),
    ('[[stroke]]\npath = "M 0 0 L 9 9"\nsoa = 0.07\n', "did you mean 'soa_s'?", "soa"),
    ('[[stroke]]\npath = "M 0 0 L 9 9"\nstart = 1\n', "did you mean 'start_s'?", "start"),
])
def test_errors_in_files_use_the_files_words(tmp_path, text, hint, field):
    (tmp_path / "s.toml").write_text(text)
    for read in (lambda: tactor.load(tmp_path / "s.toml"), lambda: tactor.parse(text)):
        with pytest.raises(tactor.InputError) as e:
            read()
        assert (e.value.hint, e.value.field, e.value.line) == (hint, field, 3)


@pytest.mark.parametrize("key", ["soa_s", "start_s", "total_s"])
def test_records_of_plans_keep_their_words(palm, stroke, tmp_path, key):
    record = {**tactor.plan(palm, stroke).to_dict(), key: "x"}
    with pytest.raises(tactor.InputError) as e:
        tactor.Plan.from_dict(record)
    assert (e.value.what, e.value.field, e.value.file) == ("plan", key, None)
    (tmp_path / "p.json").write_text(json.dumps(record))
    with pytest.raises(tactor.InputError) as e:
        tactor.load_plan(tmp_path / "p.json")
    assert e.value.field == key and e.value.file == str(tmp_path / "p.json") and f"p.json: {key}: " in str(e.value)


def test_no_words_of_the_tool_appear(palm, stroke):
    with pytest.raises(tactor.InputError) as e:
        tactor.Score(tactor.Array.preset("palm-2x4"), tactor.plan(palm, stroke))
    assert "--" not in str(e.value) and "plan.array" in e.value.hint
    with pytest.raises(tactor.DeviceError) as e:
        tactor.Player("hw:CARD=Nope", palm, config=os.devnull)
    assert "tactor devices" not in str(e.value) and " -D " not in str(e.value)
    with pytest.raises(tactor.InputError) as e:
        tactor.Array.preset("palm")
    assert "name a file" not in e.value.hint
    with pytest.raises(tactor.InputError) as e:
        tactor.Player("null", palm, config=os.devnull, sample_format="x")
    assert e.value.what == "sample_format"
    with pytest.raises(tactor.InputError) as e:
        tactor.Score(palm, tactor.plan(palm, stroke)).write("x.wav", "x")
    assert e.value.what == "sample_format"
    with pytest.raises(TypeError, match="an Array is wanted"):
        tactor.plan(stroke, stroke)


def missing(tmp_path, palm, plan):
    there = tmp_path / "none"
    return [lambda: tactor.load(there / "s.toml"), lambda: tactor.Array.from_file(there), lambda: tactor.load_plan(there / "p.json"),
            lambda: tactor.Player("null", palm, config=there), lambda: tactor.devices(config=there), lambda: tactor.plan(palm, plan.stroke, waveform=f"{there}.wav"),
            lambda: tactor.Score(palm, plan).write(there / "x.wav"), lambda: tactor.plot(plan, there / "x.svg"), lambda: palm.write(there / "a.toml"),
            lambda: plan.write(there / "p.json"), lambda: plan.stroke.write(there / "s.toml"), lambda: tactor.compare(palm, plan.stroke).plot(there / "x.svg")]


def test_a_missing_file_is_also_a_file_not_found_error(tmp_path, palm, stroke):
    for call in missing(tmp_path, palm, tactor.plan(palm, stroke)):
        with pytest.raises(FileNotFoundError) as e:
            call()
        assert isinstance(e.value, tactor.InputError) and e.value.errno == errno.ENOENT and e.value.filename == e.value.file
        assert str(tmp_path / "none") in str(e.value.filename)
        again = pickle.loads(pickle.dumps(e.value))
        assert isinstance(again, FileNotFoundError) and type(again) is type(e.value) and str(again) == str(e.value)


def test_folders_and_rights_have_their_classes_too(tmp_path, palm, stroke):
    for call in (lambda: tactor.load(tmp_path), lambda: tactor.Array.from_file(tmp_path), lambda: tactor.Score(palm, tactor.plan(palm, stroke)).write(tmp_path)):
        with pytest.raises(IsADirectoryError) as e:
            call()
        assert isinstance(e.value, tactor.InputError)


def test_a_full_disk_is_an_os_error_with_errno(palm, stroke, tmp_path):
    plan = tactor.plan(palm, stroke)
    (tmp_path / "full.json").symlink_to("/dev/full")
    (tmp_path / "full.toml").symlink_to("/dev/full")
    for call in (lambda: tactor.Score(palm, plan).write("/dev/full"), lambda: palm.write("/dev/full"), lambda: plan.write(tmp_path / "full.json"),
                 lambda: stroke.write(tmp_path / "full.toml")):
        with pytest.raises(tactor.StreamError) as e:
            call()
        assert isinstance(e.value, OSError) and isinstance(e.value, RuntimeError) and e.value.errno == errno.ENOSPC
