# SPDX-License-Identifier: MIT
"""Comparisons, figures and devices, equal to the tool's."""
import copy
import json
import os
import pickle
import xml.etree.ElementTree

import pytest

import tactor
from conftest import in_file, refused

# A stroke, and the same as a file of the tool.
RISING = tactor.Stroke.along(tactor.Path.svg("M 0 10 L 40 30"), duration=1.0, intensity=[(0, 0.2), (1, 1)], name="rising")
RISING_TOML = '[stroke]\npath = "M 0 10 L 40 30"\nduration_s = 1.0\nintensity = [[0, 0.2], [1, 1]]\n'


@pytest.mark.parametrize("arguments,options", [
    ([], {}),
    (["--phantoms", "linear,log"], dict(phantoms=["linear", "log"])),
    (["--algorithms", "continuous", "--phantom", "gaussian", "--duration", "2"], dict(algorithms="continuous", phantom="gaussian", duration=2)),
    (["--faces", "nearest"], dict(faces="nearest")),
    (["--observer", "low-speed", "sigma-v-mm-s = 80"], dict(observer="low-speed", sigma_v_mm_s=80)),
    (["--algorithm", "park2016", "--soa", "0.06", "--fit"], dict(algorithm="park2016", soa=0.06, fit=True)),
    (["--spread", "20"], dict(spread=20)),
    (["--spread", "20", "spread-seed = 7", "--spread-sigma", "3", "--observer", "low-speed", "--spread-threshold-db", "4", "--spread-place-mm", "1"],
     dict(spread=20, spread_seed=7, spread_sigma=3, observer="low-speed", spread_threshold_db=4, spread_place_mm=1)),
    (["--intensity-scale", "stevens", "stevens-exponent = 0.9"], dict(intensity_scale="stevens", stevens_exponent=0.9)),
    (["--phantoms", "linear,log", "--algorithm", "continuous"], dict(phantoms=iter(["linear", "log"]), algorithm="continuous")),
])
def test_comparisons_are_those_of_the_tool(tool, tmp_path, palm, arguments, options):
    (tmp_path / "rising.toml").write_text(RISING_TOML)
    printed = json.loads(tool("compare", "rising.toml", *in_file(tmp_path, arguments), "--format", "json"))
    compared = tactor.compare(palm, RISING, **options)
    assert compared == printed["results"] and compared.record == printed and isinstance(compared[0], dict)
    assert pickle.loads(pickle.dumps(compared)) == compared == copy.copy(compared)


@pytest.mark.parametrize("keys,speed", [("fit = true", None), ("", 45.0), ("rest", 45.0), ("fit = true\nfit_margin_mm = 5", 60.0)])
def test_a_strokes_own_fit_and_a_speed_are_the_tools(tool, tmp_path, palm, keys, speed):
    file = tmp_path / "s.toml"
    file.write_text(f'[stroke]\npath = "M 5 10 L 30 20"\n{keys}\n'.replace("rest", "pauses = [[0.5, 0.3]]"))
    said = tool("compare", file, *([] if speed is None else ["--speed", speed]), "--format", "json")
    printed = json.loads(said.replace("(use --snap to", "(use snap = true to"))  # the tool makes options of the library's fields
    assert tactor.compare(palm, tactor.load(file)[0], speed=speed) == printed["results"]


def test_an_algorithm_that_cannot_play_says_why(palm):
    line = tactor.Array.from_points([(0, 0), (13, 2), (29, 1), (11, 20)])
    rows = tactor.compare(line, tactor.Stroke.along(tactor.Path.svg("M 1 1 L 20 1.5"), duration=1.0))
    assert [r["refused"] is None for r in rows] == [True, False, True] and "grid" in rows[1]["refused"]
    refused(lambda: tactor.compare(palm, tactor.Stroke.along(tactor.Path.svg("M 0 0 L 500 0"), duration=1.0)))
    for options in (dict(algorithms=["park"]), dict(soa=0.5), dict(phantoms="none"), dict(spread=1), dict(spread=2.5), dict(spread_seed=3),
                    dict(spread=3, spread_sigma=0.5), dict(spread=3, spread_seed=-1), dict(sigma_mm=3), dict(sigma_v_mm_s=80, observer="centroid")):
        refused(lambda: tactor.compare(palm, tactor.Stroke.preset("park2016-1"), **options))


def test_a_comparison_is_drawn_like_the_tool_s(tool, tmp_path, palm):
    tool("compare", "park2016-3", "-o", "tool.svg")
    compared = tactor.compare(palm, tactor.Stroke.preset("park2016-3"))
    compared.plot(tmp_path / "ours.svg")
    assert compared._repr_svg_().encode() == (tmp_path / "ours.svg").read_bytes() == (tmp_path / "tool.svg").read_bytes()


@pytest.mark.parametrize("view", ["both", "array", "timing", "wave"])
def test_figures_are_those_of_the_tool(tool, tmp_path, palm, view):
    tool("plot", "park2016-3", "--view", view, "--width", "120", "-o", "tool.svg")
    plan = tactor.plan(palm, tactor.Stroke.preset("park2016-3"))
    tactor.plot(plan, tmp_path / "ours.svg", view=view, width=120)
    assert (tmp_path / "ours.svg").read_bytes() == (tmp_path / "tool.svg").read_bytes()


@pytest.mark.parametrize("kind", ["png", "pdf"])
def test_other_formats_are_painted_by_the_tool_s_module(tool, tmp_path, palm, kind):
    tool("plot", "park2016-3", "--dpi", "100", "-o", f"tool.{kind}")
    plan = tactor.plan(palm, tactor.Stroke.preset("park2016-3"))
    tactor.plot(plan, str(tmp_path / f"ours.{kind}"), dpi=100)
    assert (tmp_path / f"ours.{kind}").read_bytes() == (tmp_path / f"tool.{kind}").read_bytes()


def test_notebooks_show_strokes_and_plans(tool, tmp_path, palm, stroke):
    plan = tactor.plan(palm, tactor.Stroke.preset("park2016-3"))
    tool("plot", "park2016-3", "-o", "tool.svg")
    assert plan._repr_svg_().encode() == (tmp_path / "tool.svg").read_bytes()
    for s in (stroke, tactor.Stroke.along(tactor.Path.svg("M 100 100 L 900 100"), duration=1.0), tactor.Stroke.timed([0, 1], [5, 5], [5, 5])):
        assert xml.etree.ElementTree.fromstring(s._repr_svg_()).tag.endswith("svg")


def test_several_plans_in_one_figure(tmp_path, root, palm):
    plans = [tactor.plan(palm, s) for s in tactor.load(root / "examples/strokes/several.toml")]
    tactor.plot(plans, tmp_path / "s.svg", name="several.toml")
    assert "several.toml" in (tmp_path / "s.svg").read_text()


@pytest.mark.parametrize("file,options", [("x.gif", {}), ("x.svg", dict(view="side")), ("x.svg", dict(width=1)), ("x.png", dict(dpi=-1)), ("x.png", dict(dpi=100000)), ("none/x.svg", {})])
def test_impossible_figures_are_refused(tmp_path, palm, stroke, file, options):
    refused(lambda: tactor.plot(tactor.plan(palm, stroke), tmp_path / file, **options))
    assert list(tmp_path.iterdir()) == []


def test_figures_do_not_replace_inputs_nor_without_force_foreign_files(tmp_path, palm):
    drawing = tmp_path / "d.svg"
    text = '<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="40mm" viewBox="0 0 40 40"><path d="M 0 20 L 40 20"/></svg>'
    (tmp_path / "other.svg").write_text(text)
    drawing.write_text(text)
    stroke = tactor.load(drawing)[0]
    plan, compared = tactor.plan(palm, stroke), tactor.compare(palm, stroke)
    for draw in (lambda file, **more: tactor.plot(plan, file, **more), compared.plot):
        for force in (False, True):
            with pytest.raises(tactor.InputError, match="an input"):
                draw(drawing, force=force)
        with pytest.raises(tactor.InputError, match="force=True"):
            draw(tmp_path / "other.svg")
        assert drawing.read_text() == (tmp_path / "other.svg").read_text() == text
    tactor.plot(plan, tmp_path / "other.svg", force=True)
    tactor.plot(plan, tmp_path / "other.svg")


def test_devices_are_those_of_the_tool(tool, tmp_path, palm, monkeypatch):
    monkeypatch.setenv("TACTOR_CONFIG", os.devnull)
    assert tactor.devices() == tactor.devices(palm) == json.loads(tool("devices", "--format", "json"))
    other = json.loads(tool("devices", "--array", "palm-2x4", "-D", "null", "--rate", "44100", "--format", "json"))
    assert tactor.devices(tactor.Array.preset("palm-2x4"), device="null", rate=44100) == other
    (tmp_path / "own.toml").write_text('[array]\npreset = "palm-2x4"\n[output]\npcm = "null"\nchannels = 16\n')
    configured = json.loads(tool("devices", "--config", "own.toml", "--format", "json"))
    assert tactor.devices(config=tmp_path / "own.toml") == configured and configured["wanted"]["channels"] == 16
    assert tactor.devices(palm, config=tmp_path / "own.toml")["wanted"]["channels"] == 9


def test_tables_for_pandas(palm, stroke):
    pytest.importorskip("pandas", reason="pandas is not here")
    plan = tactor.plan(palm, stroke)
    table = plan.to_pandas()
    assert len(table) == 18 and list(table.columns)[:5] == ["onset_s", "duration_s", "x_mm", "y_mm", "intensity"]
    assert (table[[f"tactor_{i}" for i in range(9)]].to_numpy() == plan.amplitudes).all()


def test_a_comparisons_level_is_that_of_its_scale(palm, palm_with):
    by_level = [tactor.compare(palm, RISING, intensity_scale="sl", sl=sl) for sl in (5, 30)]
    assert by_level[0] != by_level[1]
    assert tactor.compare(palm_with('[defaults]\nintensity-scale = "sl"\nsl = 30\n'), RISING) == by_level[1]


@pytest.mark.parametrize("options,field", [
    (dict(algorithm="park2016", algorithms=["continuous"]), "algorithms"), (dict(phantom="log", phantoms="linear"), "phantoms"),
    (dict(algorithms=["continuous", "continuous"]), "algorithms"), (dict(phantoms=[]), "phantoms"), (dict(phantoms=3), "phantoms"),
    (dict(phantoms=[3]), "phantoms"), (dict(algorithm=3), "algorithm"), (dict(sl=3), "sl"), (dict(stevens_exponent=0.5), "stevens_exponent"),
])
def test_comparisons_that_drop_something_are_refused(palm, stroke, options, field):
    assert refused(lambda: tactor.compare(palm, stroke, **options)).field == field


def test_a_model_is_not_compared(palm, stroke):
    class Own:
        def weights(self, x_mm, y_mm, intensity):
            return {4: intensity}
    model = Own()
    for options in (dict(phantom=model), dict(phantoms=[model]), dict(phantoms=model)):
        assert refused(lambda: tactor.compare(palm, stroke, **options)).field in options
