# SPDX-License-Identifier: MIT
"""Files that are written from the table of options are current, and have each option."""
import importlib
import inspect
import pathlib
import re
import sys

import pytest

import tactor

pytestmark = pytest.mark.unsanitized


@pytest.fixture(scope="module")
def writer():
    sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/options"))
    return importlib.import_module("write")


def test_written_files_are_current(writer):
    assert {"_plan.py", "_player.py", "tactor-protocol-1.schema.json", "tactor-options.7", "tactor-play.1"} <= {file.name for file in writer.WRITTEN}
    for file, write in writer.WRITTEN.items():
        text = file.read_text(encoding="utf-8")
        assert text == write(text), f"{file.name}: run python3 src/options/write.py, where tactor can be imported"


def test_signatures_and_docstrings_have_each_option(writer):
    calls = {"plan": tactor.plan, "compare": tactor.compare, "score": tactor.Score, "player": tactor.Player}
    for row in map(writer.in_seconds, writer.ROWS):
        for place in set(row["places"]) & set(calls):
            assert inspect.signature(calls[place]).parameters[row["name"]].default is None
            doc = inspect.getdoc(calls[place].__init__ if inspect.isclass(calls[place]) else calls[place])
            assert re.search(rf"^(\w+, )*{row['name']}(,| :|$)", doc, re.M), row["name"]
    live = inspect.signature(tactor.Player.live).parameters
    assert {"soa", "envelope", "timeout"} <= set(live) and "duration" not in live
    assert live["smooth"].default == 0.0 and str(live["algorithm"].annotation) == "_Algorithm | None"
