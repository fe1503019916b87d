# SPDX-License-Identifier: MIT
"""Markers carry the times of the played frames. The library is a stand-in with the same calls."""
import os
import subprocess
import threading

import pytest

import tactor
import tactor.lsl
from conftest import refused, without_preloaded


@pytest.fixture(scope="session")
def library(tmp_path_factory):
    file = tmp_path_factory.mktemp("lsl") / "liblsl.so"
    source = os.path.join(os.path.dirname(__file__), "stand_in_lsl.c")
    subprocess.run([os.environ.get("CC", "cc"), "-shared", "-fPIC", "-o", file, source], env=without_preloaded(), check=True)
    return file


@pytest.fixture
def said(tmp_path, monkeypatch):
    file = tmp_path / "said"
    monkeypatch.setenv("STAND_IN_LSL", str(file))
    return lambda: file.read_text().splitlines()


@pytest.fixture
def score(palm):
    return tactor.Score(palm, tactor.plan(palm, tactor.Stroke.along(tactor.Path.svg("M 0 10 L 40 30"), duration=0.1)))


def ended(ticket):
    """Returns its report, when the callbacks before this one have been called."""
    called = threading.Event()
    ticket.add_done_callback(lambda _: called.set())
    assert called.wait(30)
    return ticket.report


def test_each_stroke_is_marked_where_it_sounded(library, said, player, score):
    with tactor.lsl.Markers("touch", "lab-1", library) as markers:
        reports = [ended(markers.mark(player.submit(score), label)) for label in ("left", "")]
        never = markers.mark(player.submit(score, at="armed"), "never")
        never.cancel()
        ended(never)
    lines = said()
    assert lines[:2] == ["info touch Markers 1 0 3 lab-1", "outlet 0 360"] and lines[-1] == "destroyed"
    marks = [line.split(" ", 2) for line in lines[2:-1]]
    assert [(through, text) for _, through, text in marks] == [("1", "start left"), ("1", "end left finished"), ("1", "start 2"), ("1", "end 2 finished")]
    for report, (start, end) in zip(reports, (marks[:2], marks[2:])):
        assert float(start[0]) == pytest.approx(report.started_s + 1000, abs=1e-3)
        assert float(end[0]) - float(start[0]) == pytest.approx(score.duration, abs=1e-3)


def test_closed_markers_are_not_sent(library, said, player, score):
    markers = tactor.lsl.Markers(library=library)
    ticket = markers.mark(player.submit(score))
    markers.close()
    markers.close()
    ended(ticket)
    assert said()[-1] == "destroyed" and len(said()) == 3 and repr(markers) == "<tactor.lsl.Markers: closed>"
    refused(lambda: markers.mark(player.submit(score)))


def test_a_library_that_cannot_be_loaded_is_reported(tmp_path, monkeypatch):
    (tmp_path / "liblsl.so").write_text("no library")
    for library in (tmp_path / "liblsl.so", tmp_path / "none.so", "libm.so.6"):
        with pytest.raises(tactor.DeviceError, match="liblsl: it cannot be loaded") as e:
            tactor.lsl.Markers(library=library)
        assert "PYLSL_LIB" in e.value.hint


def test_a_stream_that_cannot_be_made_is_reported(library, monkeypatch, tmp_path):
    monkeypatch.setenv("STAND_IN_LSL", str(tmp_path / "none" / "said"))
    with pytest.raises(tactor.DeviceError, match="cannot make a stream"):
        tactor.lsl.Markers(library=library)
