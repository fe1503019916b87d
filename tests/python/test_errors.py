# SPDX-License-Identifier: MIT
"""Exceptions: fault and place."""
import errno
import json
import os
import pickle

import pytest

import tactor
from conftest import refused


def test_they_have_families():
    assert issubclass(tactor.InputError, tactor.Error) and issubclass(tactor.InputError, ValueError)
    assert issubclass(tactor.DeviceError, tactor.Error) and issubclass(tactor.DeviceError, OSError)
    assert issubclass(tactor.StreamError, tactor.Error) and issubclass(tactor.StreamError, RuntimeError)
    assert issubclass(tactor.Error, Exception)


def test_they_have_parts(palm, stroke):
    e = refused(lambda: tactor.plan(palm, stroke, soa=0.5), tactor.Error)
    assert (e.what, e.hint) == ("soa", "use 0.07, or set burst for a wider range") and e.why.startswith("0.5 s is out of range")
    assert str(e) == f"{e.what}: {e.why} ({e.hint})"
    assert (e.file, e.line, e.column) == (None, None, None)
    assert (e.field, e.errno) == ("soa", 0)
    assert refused(lambda: tactor.Array.grid("flat", 2, 2, (10.0, 0.0))).field == "pitch_mm"


def test_files_have_line_and_column(tmp_path):
    file = tmp_path / "a: b.toml"
    file.write_text('[array]\nname = "x"\npich = 3\n')
    e = refused(lambda: tactor.Array.from_file(file))
    assert (e.file, e.line, e.column) == (str(file), 3, 1)
    assert e.field == "pich"
    file.write_text('[[stroke]]\npath = "M 0 0 L"\n')
    e = refused(lambda: tactor.load(file))
    assert (e.file, e.line) == (str(file), 2)
    for missing in (lambda: tactor.load(tmp_path / "none.toml"), lambda: tactor.Array.from_file(tmp_path / "none.toml")):
        e = refused(missing)
        assert e.file == str(tmp_path / "none.toml") and e.line is None
        assert e.errno == errno.ENOENT


def test_a_plan_that_is_not_utf8_is_refused_at_its_place(tmp_path, palm, stroke):
    file = tmp_path / os.fsdecode(b"p\xff.json")
    plan = tactor.plan(palm, stroke)
    plan.write(file)
    assert tactor.load_plan(file) == plan
    text = file.read_bytes()
    at = text.index(b"onset_s", text.index(b"\n"))
    file.write_bytes(text[:at] + b"\xff" + text[at:])
    e = refused(lambda: tactor.load_plan(file))
    line = text[:at].count(b"\n") + 1
    assert (e.file, e.line) == (str(file), line) and e.column is not None and e.why


def test_file_names_may_be_any_bytes(tmp_path):
    name = (tmp_path / "x").as_posix() + "\udcff.toml"
    assert refused(lambda: tactor.load(name)).file == name


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
    (lambda a, out: tactor.plan(a, tactor.Stroke.along(out, duration=1)), 'use fit=True to scale the stroke, or outside="clamp" to play'),
    (lambda a, out: tactor.plan(a, tactor.Stroke.preset("wave-2x4")), 'use Array.preset("palm-2x4"), or fit=True'),
    (lambda a, out: tactor.plan(a, tactor.Stroke.along(tactor.Path.svg("M 5 7 H 20"), duration=1), algorithm="tactile-brush"), "use snap=True to use this point"),
    (lambda a, out: tactor.plan(a, tactor.Stroke.along(out, duration=1), faces="nearest", phantom="log"), 'use faces="delaunay" or phantom="inverse-distance"'),
])
def test_hints_name_keyword_arguments(palm, call, hint):
    e = refused(lambda: call(palm, tactor.Path.svg("M 0 10 L 70 33")), tactor.Error)
    assert hint in e.hint and "{" not in str(e)


@pytest.mark.parametrize("text,hint,field", [
    ('[[stroke]]\npath = "M 0 0 L 9 9"\nduration = 1\n', "did you mean 'duration_s'?", "duration"),
    ('[[stroke]]\npath = "M 0 0 L 9 9"\nspeed = 1\n', "did you mean 'speed_mm_s'?", "speed"),
    ('[[stroke]]\npath = "M 0 0 L 9 9"\nsoa = 0.07\n', "did you mean 'soa_s'?", "soa"),
    ('[[stroke]]\npath = "M 0 0 L 9 9"\nstart = 1\n', "did you mean 'start_s'?", "start"),
])
def test_errors_in_files_use_the_files_words(tmp_path, text, hint, field):
    (tmp_path / "s.toml").write_text(text)
    for read in (lambda: tactor.load(tmp_path / "s.toml"), lambda: tactor.parse(text)):
        e = refused(read)
        assert (e.hint, e.field, e.line) == (hint, field, 3)


@pytest.mark.parametrize("key", ["soa_s", "start_s", "total_s"])
def test_records_of_plans_keep_their_words(palm, stroke, tmp_path, key):
    record = {**tactor.plan(palm, stroke).to_dict(), key: "x"}
    e = refused(lambda: tactor.Plan.from_dict(record))
    assert (e.what, e.field, e.file) == ("plan", key, None)
    (tmp_path / "p.json").write_text(json.dumps(record))
    e = refused(lambda: tactor.load_plan(tmp_path / "p.json"))
    assert e.field == key and e.file == str(tmp_path / "p.json") and f"p.json: {key}: " in str(e)


def test_no_words_of_the_tool_appear(palm, stroke):
    e = refused(lambda: tactor.Score(tactor.Array.preset("palm-2x4"), tactor.plan(palm, stroke)))
    assert "--" not in str(e) and "plan.array" in e.hint
    e = refused(lambda: tactor.Player("hw:CARD=Nope", palm, config=os.devnull), tactor.DeviceError)
    assert "tactor devices" not in str(e) and " -D " not in str(e)
    assert "name a file" not in refused(lambda: tactor.Array.preset("palm")).hint
    assert refused(lambda: tactor.Player("null", palm, config=os.devnull, sample_format="x")).what == "sample_format"
    assert refused(lambda: tactor.Score(palm, tactor.plan(palm, stroke)).write("x.wav", "x")).what == "sample_format"
    with pytest.raises(TypeError, match="it must be an Array"):
        tactor.plan(stroke, stroke)


def missing(tmp_path, palm, plan):
    there = tmp_path / "none"
    return [lambda: tactor.load(there / "s.toml"), lambda: tactor.Array.from_file(there), lambda: tactor.load_plan(there / "p.json"),
            lambda: tactor.Player("null", palm, config=there), lambda: tactor.devices(config=there), lambda: tactor.plan(palm, plan.stroke, waveform=f"{there}.wav"),
            lambda: tactor.study.read(there), lambda: tactor.study.analyze(there),
            lambda: tactor.Score(palm, plan).write(there / "x.wav"), lambda: tactor.plot(plan, there / "x.svg"), lambda: palm.write(there / "a.toml"),
            lambda: plan.write(there / "p.json"), lambda: plan.stroke.write(there / "s.toml"), lambda: tactor.compare(palm, plan.stroke).plot(there / "x.svg")]


def test_a_missing_file_is_also_a_file_not_found_error(tmp_path, palm, stroke):
    for call in missing(tmp_path, palm, tactor.plan(palm, stroke)):
        e = refused(call, FileNotFoundError)
        assert isinstance(e, tactor.InputError) and e.errno == errno.ENOENT and e.filename == e.file
        assert str(tmp_path / "none") in str(e.filename)
        again = pickle.loads(pickle.dumps(e))
        assert isinstance(again, FileNotFoundError) and type(again) is type(e) and str(again) == str(e)


def test_folders_and_rights_have_their_classes_too(tmp_path, palm, stroke):
    for call in (lambda: tactor.load(tmp_path), lambda: tactor.Array.from_file(tmp_path), lambda: tactor.Score(palm, tactor.plan(palm, stroke)).write(tmp_path)):
        assert isinstance(refused(call, IsADirectoryError), tactor.InputError)


def test_a_full_disk_is_an_os_error_with_errno(palm, stroke, tmp_path):
    plan = tactor.plan(palm, stroke)
    (tmp_path / "full.json").symlink_to("/dev/full")
    (tmp_path / "full.toml").symlink_to("/dev/full")
    for call in (lambda: tactor.Score(palm, plan).write("/dev/full"), lambda: palm.write("/dev/full"), lambda: plan.write(tmp_path / "full.json"),
                 lambda: stroke.write(tmp_path / "full.toml")):
        e = refused(call, tactor.StreamError)
        assert isinstance(e, OSError) and isinstance(e, RuntimeError) and e.errno == errno.ENOSPC
