# SPDX-License-Identifier: MIT
"""Exceptions say what is wrong, and where."""
import errno
import pickle

import pytest

import tactor
from tactor import _errors


def test_their_families():
    assert issubclass(tactor.InputError, tactor.Error) and issubclass(tactor.InputError, ValueError)
    assert issubclass(tactor.DeviceError, tactor.Error) and issubclass(tactor.DeviceError, OSError)
    assert issubclass(tactor.StreamError, tactor.Error) and issubclass(tactor.StreamError, RuntimeError)
    assert issubclass(tactor.Error, Exception)


def test_their_parts(palm, stroke):
    with pytest.raises(tactor.Error) as e:
        tactor.plan(palm, stroke, soa=0.5)
    assert (e.value.what, e.value.hint) == ("soa", "use 0.07") and e.value.why.startswith("0.5 s is out of bounds")
    assert str(e.value) == f"{e.value.what}: {e.value.why} ({e.value.hint})"
    assert (e.value.file, e.value.line, e.value.column) == (None, None, None)
    assert (e.value.field, e.value.errno) == ("soa", 0)
    with pytest.raises(tactor.InputError) as e:
        tactor.Array.grid("flat", 2, 2, (10.0, 0.0))
    assert e.value.field == "pitch_mm"


def test_files_with_line_and_column(tmp_path):
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


def test_each_kind_of_the_library_has_its_class():
    assert type(_errors.made("bad-input", "soa_s", "no", "timing = fit")) is tactor.InputError
    assert type(_errors.made("not-available", "pcm", "no", "")) is tactor.DeviceError
    assert type(_errors.made("runtime", "stream", "no", "")) is tactor.StreamError
    e = _errors.made("bad-input", "soa_s", "no", "try timing = fit or snap = true")
    assert (e.what, e.hint) == ("soa", 'try timing="fit" or snap=True')


@pytest.mark.parametrize("call,what", [
    (lambda a, s: tactor.plan(s, a), "array"), (lambda a, s: tactor.plan(a, "park2016-1"), "stroke"), (lambda a, s: tactor.compare(a, 3), "stroke"),
    (lambda a, s: tactor.Score(s, []), "array"), (lambda a, s: tactor.Score(a, 3), "plans"), (lambda a, s: tactor.plot(3, "x.svg"), "plans"),
    (lambda a, s: tactor.Player("null", "palm"), "array"), (lambda a, s: tactor.Player(a, a), "device"), (lambda a, s: tactor.Array("x", [(0, 0)]), "tactors"),
    (lambda a, s: tactor.Stroke.along("M 0 0 L 1 1"), "path"), (lambda a, s: tactor.fit_strokes([s], s), "array"),
])
def test_another_type_is_said_with_the_arguments_name(palm, stroke, call, what):
    with pytest.raises(TypeError, match=f"^{what}: "):
        call(palm, stroke)


def test_a_full_disk_is_a_stream_error(palm, stroke):
    with pytest.raises(tactor.StreamError):
        tactor.Score(palm, tactor.plan(palm, stroke)).write("/dev/full")
