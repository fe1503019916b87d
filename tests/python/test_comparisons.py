# SPDX-License-Identifier: MIT
"""Options of a comparison: each counts or is refused."""
import json

import pytest

import tactor

LINE = tactor.Path.svg("M 0 10 L 40 30")


@pytest.mark.parametrize("arguments,options", [
    (["--intensity-scale", "stevens", "--stevens-exponent", "0.9"], dict(intensity_scale="stevens", stevens_exponent=0.9)),
    (["--phantoms", "linear,log", "--algorithm", "continuous"], dict(phantoms=iter(["linear", "log"]), algorithm="continuous")),
])
def test_a_comparison_has_the_tools_scale(tool, palm, arguments, options):
    stroke = tactor.Stroke.along(LINE, duration=1.0, intensity=[(0, 0.2), (1, 1)])
    with open(tool.folder / "s.toml", "w", encoding="utf-8") as file:
        file.write('[stroke]\npath = "M 0 10 L 40 30"\nduration_s = 1.0\nintensity = [[0, 0.2], [1, 1]]\n')
    printed = json.loads(tool("compare", "s.toml", *arguments, "--format", "json"))["results"]
    assert tactor.compare(palm, stroke, **options) == printed


def test_a_comparisons_level_is_that_of_its_scale(tmp_path, palm):
    stroke = tactor.Stroke.along(LINE, duration=1.0, intensity=[(0, 0.2), (1, 1)])
    by_level = [tactor.compare(palm, stroke, intensity_scale="sl", sl=sl) for sl in (5, 30)]
    assert by_level[0] != by_level[1]
    (tmp_path / "a.toml").write_text('[array]\npreset = "palm-3x3"\n[defaults]\nintensity-scale = "sl"\nsl = 30\n')
    assert tactor.compare(tactor.Array.from_file(tmp_path / "a.toml"), stroke) == by_level[1]


@pytest.mark.parametrize("options,field", [
    (dict(algorithm="park2016", algorithms=["continuous"]), "algorithms"), (dict(phantom="log", phantoms="linear"), "phantoms"),
    (dict(algorithms=["continuous", "continuous"]), "algorithms"), (dict(phantoms=[]), "phantoms"), (dict(phantoms=3), "phantoms"),
    (dict(phantoms=[3]), "phantoms"), (dict(algorithm=3), "algorithm"), (dict(sl=3), "sl"), (dict(stevens_exponent=0.5), "stevens_exponent"),
])
def test_comparisons_that_drop_something_are_refused(palm, stroke, options, field):
    with pytest.raises(tactor.InputError) as e:
        tactor.compare(palm, stroke, **options)
    assert e.value.field == field


def test_a_model_is_not_compared(palm, stroke):
    class Own:
        def weights(self, x_mm, y_mm, intensity):
            return {4: intensity}
    model = Own()
    for options in (dict(phantom=model), dict(phantoms=[model]), dict(phantoms=model)):
        with pytest.raises(tactor.InputError) as e:
            tactor.compare(palm, stroke, **options)
        assert e.value.field in options
