# SPDX-License-Identifier: MIT
"""Studies: their trials with types, their statistics, and what is refused in their folders."""
import collections
import csv
import json
import math
import re
import shutil
import subprocess
import sys

import pytest

import tactor
from conftest import ROOT, refused, without_preloaded

KINDS = {"onset": float, "duration": float, "trial": int, "attempt": int, "response_time": float, "rating": int, "xruns": int, "stream": int,
         "frame_1": int, "frame_2": int, "void": lambda text: text == "true"}


@pytest.fixture(scope="module")
def studies(tmp_path_factory):
    """Folders of studies by name."""
    folder = tmp_path_factory.mktemp("studies")
    subprocess.run([sys.executable, ROOT / "tests/study/studies.py", folder], env=without_preloaded(), check=True)
    return {p.name: p for p in folder.iterdir() if (p / "participants.tsv").exists()}


@pytest.fixture
def study(studies, tmp_path):
    """Folder of a study that a test may change."""
    return shutil.copytree(studies["simulated"], tmp_path / "study")


def typed(row):
    return {column: None if text == "n/a" else KINDS.get(column, str)(text) for column, text in row.items()}


def test_trials_are_the_lines_of_the_tables_with_their_types(studies):
    for folder in studies.values():
        read = collections.defaultdict(list)
        for trial in tactor.study.read(folder):
            read[trial["participant"], re.sub("[^0-9A-Za-z]", "", trial["run"])].append(trial)
        for file in folder.glob("sub-*/beh/*_beh.tsv"):
            with open(file, newline="", encoding="utf-8") as table:
                rows = [typed(row) for row in csv.DictReader(table, delimiter="\t")]
            trials = read.pop(re.fullmatch("sub-([^_]+)_task-([^_]+)_beh", file.stem).groups())
            assert repr([{column: trial[column] for column in rows[0]} for trial in trials]) == repr(rows), file
            assert {trial["early"] for trial in trials} == {None}
        assert not read


def test_trials_say_which_run_they_are_of_and_who_answered(tool, tmp_path):
    tool("experiment", "park2016", "--participant", "P07", "-o", "study", "--simulate", "seed=1,sigma=1")
    trials = tactor.study.read(tmp_path / "study")
    assert collections.Counter((t["participant"], t["run"], t["task"], t["simulated"]) for t in trials) == {
        ("P07", "similarity", "choose", True): 40, ("P07", "uniformity", "choose", True): 40,
        ("P07", "similarity-rating", "rate", True): 40, ("P07", "uniformity-rating", "rate", True): 40}
    assert list(trials[0])[:6] == ["participant", "run", "task", "simulated", "onset", "duration"]
    assert {(type(t["early"]), type(t["void"]), type(t["duration"]), len(t["plan_1"])) for t in trials} == {(bool, bool, float, 64)}


def test_trials_have_the_number_of_their_session(tool, tmp_path):
    (tmp_path / "two.toml").write_text(tool("experiment", "park2016", "--print").replace("title", "sessions = 2\ntitle", 1))
    for n in ("2", "1"):
        tool("experiment", "two.toml", "--participant", "P07", "-o", "study", "--simulate", "seed=1,sigma=1", "--session", n)
    trials = tactor.study.read(tmp_path / "study")
    assert [(t["run"], t["session"], t["trial"]) for t in trials if t["run"] == "uniformity"] == [
        ("uniformity", n, i) for n in (1, 2) for i in range(1, 41)]


def test_statistics_are_those_that_the_tool_prints(studies, tool):
    for folder in studies.values():
        assert json.dumps(tactor.study.analyze(folder)) == json.dumps(json.loads(tool("analyze", folder, "--format", "json")))


def test_participants_are_chosen_as_by_the_tool(studies, tool):
    folder = studies["simulated"]
    some = json.loads(tool("analyze", folder, "--participants", "02,11", "--format", "json"))
    for chosen in ({"participants": ["sub-02", "11"]}, {"participants": "02,05,11", "exclude": ["05"]}):
        assert tactor.study.analyze(folder, **chosen) == some
        assert {t["participant"] for t in tactor.study.read(folder, **chosen)} == {"02", "11"}
    assert "11" not in {t["participant"] for t in tactor.study.read(folder, exclude="11")}


def test_trials_are_left_out_as_by_the_tool(studies, tool):
    folder = studies["simulated"]
    times = sorted(t["response_time"] for t in tactor.study.read(folder) if not t["void"])
    low, high = times[len(times) // 4], times[-2]
    rest = json.loads(tool("analyze", folder, "--drop-early", "--response-time", f"{low},{high}", "--format", "json"))
    assert 0 < sum(r["dropped"] for r in rest["runs"].values()) < len(times)
    assert tactor.study.analyze(folder, drop_early=True, response_time=(low, high)) == rest
    for times in ((1.0, 0.5), (0.2,), (-1.0, 1.0), (0.0, math.inf)):
        assert refused(lambda: tactor.study.analyze(folder, response_time=times)).field == "response_time"


@pytest.mark.parametrize("call", [tactor.study.read, tactor.study.analyze])
def test_what_is_refused_says_where_in_words_of_python(call, study):
    for codes in ({"participants": "99"}, {"exclude": ["99"]}, {"participants": []}):
        e = refused(lambda: call(study, **codes))
        assert [e.what] == [e.field] == list(codes) and "--" not in str(e)
    with pytest.raises(TypeError, match="participants: it must be a str, not int"):
        call(study, participants=[7])
    session = study / "sourcedata/sub-02/session.json"
    told = session.read_text()
    session.write_text(told.replace('"simulated": true', '"simulated": false'))
    assert refused(lambda: call(study)).hint == "choose people with participants or exclude"
    session.write_text(told)
    table = study / "sub-03/beh/sub-03_task-similarity_beh.tsv"
    lines = table.read_text().split("\n")
    table.write_text("\n".join([*lines[:5], lines[5].replace("false", "maybe").replace("true", "maybe"), *lines[6:]]))
    e = refused(lambda: call(study))
    assert (e.file, e.line, e.why) == (str(table), 6, 'void is "maybe"')
    assert isinstance(refused(lambda: call(table)), NotADirectoryError)
    table.unlink()
    table.mkdir()
    assert refused(lambda: call(study)).file == str(table)
