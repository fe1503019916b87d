# SPDX-License-Identifier: MIT
"""Samples of one's own: exact, or refused."""
import copy
import pickle
import wave

import numpy as np
import pytest

import tactor
from conftest import refused


def noise(dtype, frames=3000, channels=9):
    rng = np.random.default_rng(5)
    if dtype in ("float32", "float64"):
        return rng.uniform(-0.2, 0.2, (frames, channels)).astype(dtype)
    most = np.iinfo(dtype).max // 4
    return rng.integers(-most, most, (frames, channels)).astype(dtype)


@pytest.mark.parametrize("dtype", ["float32", "int16", "int32"])
def test_they_come_back_bit_for_bit(palm, dtype):
    x = noise(dtype)
    score = tactor.Score.from_samples(palm, x, 8000)
    assert score.render(dtype).tobytes() == x.tobytes() and (score.rate, score.channels, len(score)) == (8000, 9, 3000)
    assert np.concatenate(list(score.blocks(700, dtype))).tobytes() == x.tobytes()
    assert score.plans == () and score.starts == [0] and "samples" in repr(score)
    strided = np.asfortranarray(np.repeat(x, 2, axis=0))[::2]
    assert tactor.Score.from_samples(palm, strided, 8000) == score
    assert tactor.Score.from_samples(palm, x.astype(x.dtype.newbyteorder(">")), 8000) == score


def test_doubles_become_floats_and_one_column_is_one_channel():
    one = tactor.Array.grid("one", 1, 1, 20.0)
    x = noise("float64", channels=1)[:, 0]
    assert np.array_equal(tactor.Score.from_samples(one, x).render()[:, 0], x.astype("float32"))
    assert tactor.Score.from_samples(one, [0.1, -0.2]).render().tolist() == [[np.float32(0.1)], [np.float32(-0.2)]]


def test_they_are_values(palm):
    x = noise("int16")
    score = tactor.Score.from_samples(palm, x, level_dbfs=-10)
    for again in (pickle.loads(pickle.dumps(score)), copy.copy(score), tactor.Score.from_samples(palm, x.copy(), level_dbfs=-10)):
        assert again == score and hash(again) == hash(score) and again.render("int16").tobytes() == x.tobytes()
    assert tactor.Score.from_samples(palm, x, level_dbfs=-9) != score != tactor.Score.from_samples(palm, x[:-1], level_dbfs=-10)
    x[0, 0] += 1
    assert tactor.Score.from_samples(palm, x, level_dbfs=-10) != score


def test_a_wav_file_of_the_standard_library_and_the_tool_agree(palm, tool, tmp_path):
    x = noise("int16")
    with wave.open(str(tmp_path / "nine.wav"), "wb") as f:
        f.setparams((9, 2, 48000, 0, "NONE", ""))
        f.writeframes(x.tobytes())
    tool("render", "nine.wav", "-o", "again.wav")
    tactor.Score.from_samples(palm, x).write(tmp_path / "ours.wav")
    assert (tmp_path / "ours.wav").read_bytes() == (tmp_path / "again.wav").read_bytes()


def test_what_cannot_be_played_is_refused(palm):
    def message(*args, **more):
        return str(refused(lambda: tactor.Score.from_samples(palm, *args, **more)))

    loud = noise("float32")
    loud[17, 3] = 0.75
    assert "channel 3 (tactor 3) peaks at -2.49 dBFS, 9.51 dB above the level of -12 dBFS" in message(loud)
    assert "level_dbfs=-2.49" in message(loud) and tactor.Score.from_samples(palm, loud, level_dbfs=-2)
    assert "it has 8 channels, but the stream has 9 (give one column for each channel of the stream)" in message(loud[:, :8], level_dbfs=0)
    for one in (loud, loud[:, :8], loud[:0]):
        assert refused(lambda: tactor.Score.from_samples(palm, one)).field == "samples"
    loud[0, 0] = np.nan
    assert "channel 0 is nan at frame 0" in message(loud)
    assert "is inf at frame 0" in message(np.full((5, 9), 1e300))
    for other in (noise("float32").astype("int64"), noise("float32") + 0j, "nine.wav", np.zeros((2, 9, 1)), np.zeros((0, 9)), np.zeros((3, 0)), [],
                  np.ma.masked_array(np.zeros((2, 9)), True)):
        assert "samples" in message(other)
    assert refused(lambda: tactor.Score.from_samples("palm", loud), TypeError)
    assert refused(lambda: tactor.Score.from_samples(palm, loud, 7000)).field == "rate"


def test_a_player_takes_an_array(palm, tmp_path):
    x = noise("int16", 4800)
    with tactor.Player("null", palm, rate=48000) as player:
        assert player.play(x).state == "finished"
        assert player.play(tactor.Score.from_samples(palm, x, level_dbfs=-6)).frames == 4800
        assert "9 channels" not in str(refused(lambda: player.submit(x[:, :8])))
        assert "it has 8 channels, but the stream has 9" in str(refused(lambda: player.submit(x[:, :8])))
        assert "dB above the level of -12 dBFS" in str(refused(lambda: player.submit(x.astype("float32"))))
        assert "44100 Hz" in str(refused(lambda: player.submit(tactor.Score.from_samples(palm, x, 44100))))
        refused(lambda: player.submit([[0.0] * 9]), TypeError)
    wide = np.zeros((480, 12), "int16")
    wide[:, 11] = 32767  # no tactor is there
    with tactor.Player("null", palm, rate=48000, channels=12) as player:
        assert player.play(wide).state == "finished"
