# SPDX-License-Identifier: MIT
"""Copies: a value's copy is equal; a device cannot be copied."""
import copy
import os
import pickle

import numpy as np
import pytest

import tactor

COPIES = [copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))]


@pytest.mark.parametrize("again", COPIES)
def test_unique_objects_are_not_copied(palm, stroke, again):
    score = tactor.Score(palm, tactor.plan(palm, stroke))
    with tactor.Player("null", palm, config=os.devnull) as player:
        with player.live(timeout=3600.0) as finger:
            finger.to(20, 20)
            ticket = player.submit(score, at="armed")
            for one in (player, ticket, finger):
                with pytest.raises(TypeError, match=f"^a {type(one).__name__} cannot be copied or pickled$"):
                    again(one)
            ticket.cancel()
        assert not player.closed and finger.report.state == "finished"
    for core in (player._shared.core, finger._core):
        with pytest.raises(TypeError):
            again(core)


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy])
def test_a_copy_stays_the_same_when_the_file_changes(tmp_path, stroke, again):
    file = tmp_path / "quiet.toml"
    file.write_text('[array]\npreset = "palm-3x3"\n[defaults]\nlevel-dbfs = -30\n')
    array = tactor.Array.from_file(file)
    expected = tactor.Score(array, tactor.plan(array, stroke)).render()
    file.unlink()
    other = again(array)
    assert other == array
    plan = tactor.plan(other, stroke)
    assert np.array_equal(tactor.Score(other, plan).render(), expected)
    assert np.array_equal(tactor.Score(again(other), again(plan)).render(), expected)


@pytest.mark.parametrize("again", COPIES)
def test_copies_are_equal(palm, stroke, again):
    path = tactor.Path.svg("M 0 0 L 30 40")
    plan = tactor.plan(palm, stroke, algorithm="continuous")
    for value in (palm, path, stroke, plan, plan.curve, tactor.Score(palm, plan)):
        assert again(value) == value


def test_a_curve_cannot_be_changed(palm, stroke):
    curve = tactor.plan(palm, stroke, algorithm="continuous").curve
    with pytest.raises(AttributeError):
        curve.t = None
    with pytest.raises(AttributeError):
        del curve.t
    for one in (curve, pickle.loads(pickle.dumps(curve)), tactor.Curve(*(np.zeros((3, 2)) for _ in range(4)))):
        for name in ("t", "positions", "intensities", "amplitudes"):
            with pytest.raises(ValueError):
                getattr(one, name)[0] = 1.0
