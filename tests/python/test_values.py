# SPDX-License-Identifier: MIT
"""Arrays, paths and strokes as values; copies of them are equal."""
import copy
import os
import pickle

import numpy as np
import pytest

import tactor
from conftest import refused

GRID = '[array]\nname = "forearm"\ngrid = { rows = 2, columns = 4, pitch_mm = [25.0, 40.0] }\n'


def test_an_array_is_a_sequence_of_tactors(palm):
    assert len(palm) == 9 and palm.channels == 9 and palm.name == "palm-3x3"
    assert palm[3] == palm.tactors[3] == list(palm)[3]
    assert palm[3].position == (0.0, 20.0) and palm[3].channel == 3 and palm[-1].channel == 8
    with pytest.raises(IndexError):
        palm[9]


def test_positions_are_a_read_only_view(palm):
    assert palm.positions.shape == (9, 2) and palm.positions.dtype == np.float64
    assert not palm.positions.flags.owndata and not palm.positions.flags.writeable
    assert palm.positions.tolist() == [list(t.position) for t in palm]
    kept = palm.positions
    del palm
    assert kept[8].tolist() == [40.0, 40.0]


def test_arrays_of_a_file_a_grid_and_points_agree(tmp_path):
    file = tmp_path / "forearm.toml"
    file.write_text(GRID)
    of_file = tactor.Array.from_file(file)
    assert of_file == tactor.Array.from_file(str(file)) == tactor.Array.grid("forearm", 2, 4, (25.0, 40.0))
    of_points = tactor.Array.from_points(of_file.positions, name="forearm")
    assert of_points == of_file and hash(of_points) == hash(of_file)
    assert of_points != tactor.Array.from_points(of_file.positions + 1, name="forearm")
    assert tactor.Array.grid("square", 2, 2, 10).positions.tolist() == [[0, 0], [10, 0], [0, 10], [10, 10]]


def test_an_array_knows_its_faces(palm):
    assert len(palm.faces) == 4 and palm.pitch_mm == 20.0
    assert palm.grid_lines == ([0.0, 20.0, 40.0], [0.0, 20.0, 40.0])
    assert palm.contains((40, 40)) and not palm.contains((40.1, 40)) and palm.nearest((50, 10)) == (40.0, 10.0)
    assert palm.weights((20.0, 20.0)) == {4: 1.0}


def test_the_values_of_a_tactor_are_kept():
    one = tactor.Tactor(tactor.Point(1.0, 2.0), 3, -1.0, -2.0, -40.0, -1, "piezo")
    more = one._replace(position=tactor.Point(9.0, 2.0), channel=0, threshold_dbfs=None, thresholds=((100.0, -20.0), (250.0, -41.0)), rise_s=0.02,
                        displacement_um_at_0dbfs=35.5)
    array = tactor.Array("two", [one, more])
    assert array[0] == one and array[1] == more and array.channels == 4
    again = pickle.loads(pickle.dumps(array))
    assert again == array and hash(again) == hash(array) and again[1] == more
    refused(lambda: tactor.Array("falls", [more._replace(thresholds=((250.0, -41.0), (100.0, -20.0)))]))


def test_the_place_on_the_body_is_kept(tmp_path):
    file = tmp_path / "palm.toml"
    file.write_text('[array]\nsite = "left palm"\nup = "fingers"\nplace = [1, -56]\nturn = 15\nbody = 180\npreset = "palm-3x3"\n')
    array = tactor.Array.from_file(file)
    worn = ("left palm", "fingers", (1, -56), 15, 180)
    assert (array.site, array.up, array.place, array.turn_deg, array.body_mm) == worn
    refused(lambda: array.replace(name="again").write(file))  # somebody wrote it
    array.replace(name="again").write(file, force=True)
    for again in (tactor.Array.from_file(file), pickle.loads(pickle.dumps(array)), array.replace(gains=-1.0)):
        assert (again.site, again.up, again.place, again.turn_deg, again.body_mm) == worn
    assert pickle.loads(pickle.dumps(array)) == array != tactor.Array(array.name, array)
    assert tactor.Array.preset("palm-3x3").site == ""


def test_a_recording_is_read_as_a_csv_file_is(tmp_path):
    rows = [(7, 0, 0, 51), (7, 5, 5, 255), (7.5, float("nan"), 20, 9), (8, 40, 40, 0)]
    csv = "t_s,x_mm,y_mm,intensity\n" + "".join(f"{t},{x},{y},{i}\n" for t, x, y, i in rows)
    (tmp_path / "r.csv").write_text(csv)
    recorded = tactor.Stroke.timed(*zip(*rows), intensity_max=255, name="r")
    [loaded] = tactor.load(tmp_path / "r.csv", intensity_max=255)
    for t in (0.0, 0.2, 0.9, 1.0):
        assert recorded.position(t) == loaded.position(t) and recorded.intensity(t) == loaded.intensity(t)
    assert recorded.duration == 1.0 and len(recorded.warnings) == len(loaded.warnings) == 2
    with pytest.raises(tactor.InputError, match="point 2: intensity 255 is above 1.*intensity_max=255 for 8 bits"):
        tactor.Stroke.timed([0, 1], [0, 1], [0, 1], [1, 255])


@pytest.mark.parametrize("make", [
    lambda: tactor.Array("none", []),
    lambda: tactor.Array.from_points([(0, 0), (0, 0)]),
    lambda: tactor.Array.from_points([0, 1, 2]),
    lambda: tactor.Array.from_points([(0, float("nan"))]),
    lambda: tactor.Array.grid("none", 0, 3, 10),
    lambda: tactor.Array.grid("less", -1, 3, 10),
    lambda: tactor.Array.grid("much", 1000, 1000, 10),
    lambda: tactor.Array.preset("palm"),
    lambda: tactor.Array("below", [tactor.Tactor(tactor.Point(0, 0), -1)]),
    lambda: tactor.Array("word", [tactor.Tactor(tactor.Point(0, 0), 0, actuator="steam")]),
])
def test_impossible_arrays_are_refused(make):
    refused(make)


def test_a_path_goes_by_arc_length():
    path = tactor.Path.polyline([(0, 0), (30, 0), (30, 40)])
    assert path.length_mm == 70.0
    assert path.at(40) == tactor.Point(30.0, 10.0) and path.at(-1) == (0.0, 0.0) and path.at(1e9) == (30.0, 40.0)
    assert path.at([0, 30, 70]).tolist() == [[0, 0], [30, 0], [30, 40]]
    assert path.at(np.float64(40)) == (30.0, 10.0)
    arc = tactor.Path.arc((20, 20), 10.0, 0.0, 90.0)
    assert arc.length_mm == pytest.approx(5 * np.pi) and arc.at(1e9) == pytest.approx((20, 30))
    assert tactor.Path.svg("M 0 0 L 30 0 30 40") == path
    assert path.meets_x(30.0) == [] and path.meets_y(20.0) == [50.0]


@pytest.mark.parametrize("data", ["M 0 10 C 20 -5 20 45 40 30", "M 0 0 A 20 10 30 1 1 30 30 L 0 40 Q 3 4 5 6 Z", "M 0.1 0.2 L 0.3 0.4"])
def test_paths_are_pickled_to_the_bit(data):
    path = tactor.Path.svg(data)
    again = pickle.loads(pickle.dumps(path))
    assert again == path and hash(again) == hash(path) and again.length_mm == path.length_mm and again.data == path.data
    lengths = np.linspace(0, path.length_mm, 1001)
    assert np.array_equal(again.at(lengths), path.at(lengths))


def test_strokes_have_their_movement(stroke):
    assert stroke.duration == 1.2 and stroke.position(0.0) == (0.0, 10.0) and stroke.intensity(0.5) == 1.0
    path = tactor.Path.polyline([(0, 0), (30, 0)])
    assert tactor.Stroke.along(path, speed=60.0).duration == 0.5 == tactor.Stroke.along(path).duration
    timed = tactor.Stroke.timed([0, 1, 3], [0, 10, 10], np.array([0, 0, 20], dtype=np.int32), intensity=[0, 1, 0.5])
    assert timed.position(2.0) == (10.0, 10.0) and timed.intensity(0.5) == 0.5 and timed.duration == 3.0
    assert tactor.Stroke.timed([0, 1], [0, 1], [0, 1]).intensity(0.3) == 1.0
    assert timed.with_duration(6.0).position(4.0) == (10.0, 10.0) and timed.with_intensity(0.5).intensity(1.0) == 0.5
    preset = tactor.Stroke.preset("park2016-1")
    assert preset.note == "reconstructed" and preset.name == "park2016-1"


def test_strokes_ease_change_their_speed_and_rest():
    path = tactor.Path.polyline([(0, 0), (40, 0)])
    eased = tactor.Stroke.along(path, duration=2.0, easing="minimum-jerk")
    assert all(abs(eased.position(2 * u).x / 40 - (10 * u**3 - 15 * u**4 + 6 * u**5)) < 1e-12 for u in np.linspace(0, 1, 101))
    assert abs(eased.position(eased.meets_x(7.0)[0]).x - 7.0) < 1e-12
    faster = tactor.Stroke.along(path, speed=[(0, 20), (1, 80)])
    assert abs(faster.duration - 40 * np.log(4) / 60) < 1e-12 and abs(faster.speed - 40 / faster.duration) < 1e-12
    resting = tactor.Stroke.along(path, speed=40, pauses=[(0.5, 0.5), (1, 0.25, 0)], intensity=[(0, 0.2), (1, 1)])
    assert abs(resting.duration - 1.75) < 1e-12 and resting.position(0.7) == (20.0, 0.0) and resting.speed == 40.0
    assert abs(resting.intensity(0.7) - 0.6) < 1e-12 and resting.intensity(1.7) == 0.0
    assert abs(resting.with_speed(20).duration - 2.75) < 1e-12
    assert resting.reversed().position(0.0) == (40.0, 0.0) and resting.reversed().intensity(0.1) == 0.0
    rising = tactor.parse("[stroke]\npoints = [[0, 0], [40, 0]]\nduration_s = 2\ncarrier_profile = [[0, 100], [0.25, 300]]\n")[0]
    course = tactor.plan(tactor.Array.preset("palm-3x3"), rising.reversed()).to_dict()["stroke"]["course"]
    assert [(p["t_s"], p["hz"]) for p in course] == [(0.0, 300.0), (1.5, 300.0), (2.0, 100.0)]
    for wrong in ({"easing": "fast"}, {"speed": [(0, 0)]}, {"speed": [(0.5, 1), (0.5, 2)]}, {"speed": [1, 2]}, {"pauses": [(0.5,)]},
                  {"pauses": [(0.5, -1)]}, {"duration": 1.0, "pauses": [(0.5, 1.0)]}, {"intensity": [(0, -1)]}, {"intensity": [(2, 1)]}):
        refused(lambda: tactor.Stroke.along(path, **wrong))


def test_strokes_of_files_have_starts_and_choices(tmp_path, palm):
    drawn = tmp_path / "s.toml"
    drawn.write_text("""[[stroke]]
path = "M 0 10 L 40 10"
duration_s = 0.7
repeat = 2
pause_s = 0.1
[[stroke]]
path = "M 0 10 L 40 10"
duration_s = 0.7
start_s = 0.05
start_from = "start"
phantom = "inverse-distance"
faces = "nearest"
soa_s = 0.06
""")
    first, again, last = tactor.load(drawn)
    assert (first.start, first.start_from) == (None, "piece") and (again.start, again.start_from) == (0.1, "end")
    assert last.choices == {"phantom": "inverse-distance", "faces": "nearest", "soa": 0.06} and first.choices == {}
    plans = [tactor.plan(palm, s) for s in (first, again, last)]
    assert plans[2].faces == "nearest" and plans[0].faces == "delaunay"
    starts = tactor.Score(palm, plans).starts
    total = plans[0].to_dict()["total_s"]
    assert [round(s / 48000, 3) for s in starts] == [0.0, round(total + 0.1, 3), 0.05]
    for s in (again, last):
        assert pickle.loads(pickle.dumps(s)) == s


def test_strokes_are_pickled_to_the_bit(stroke, tmp_path):
    drawn = tmp_path / "s.toml"
    drawn.write_text('[[stroke]]\npath = "M 0 0 C 1 2 3 4 40 40"\n')
    timed = tactor.Stroke.timed([0, 0.1, 1], [0, 10, 20], [0, 0, 7], [1, 0.5, 0.25], name="é", start=0.5, carrier=100.0)
    uneven = tactor.Stroke.along(tactor.Path.svg("M 0 0 C 1 2 3 4 40 40"), speed=[(0.1, 20), (1, 80)], intensity=[(0, 0.2), (1, 1)],
                                 easing="in-out", pauses=[(0.3, 0.1), (0.7, 0.3, 0.5)])
    for s in [stroke, timed, timed.with_duration(0.7).with_intensity(0.3), uneven, uneven.with_duration(0.77).with_intensity(0.3), *tactor.load(drawn), *map(tactor.Stroke.preset, tactor.stroke_presets())]:
        again = pickle.loads(pickle.dumps(s))
        assert again == s and hash(again) == hash(s)
        assert (again.name, again.duration, again.start, again.carrier, again.speed, again.note, again.warnings) == \
            (s.name, s.duration, s.start, s.carrier, s.speed, s.note, s.warnings)
        assert [again.position(t) for t in np.linspace(0, s.duration, 101)] == [s.position(t) for t in np.linspace(0, s.duration, 101)]
    assert stroke != stroke.with_duration(1.3) and stroke != timed


def test_damaged_pickles_are_refused(stroke):
    state = stroke._core.state()
    for cut in range(0, len(state), 7):
        refused(lambda: tactor._tactor.Stroke.from_state(state[:cut]), tactor.Error)


@pytest.mark.parametrize("make", [
    lambda: tactor.Path.svg("M"), lambda: tactor.Path.polyline([]), lambda: tactor.Path.polyline([("a", "b"), (0, 0)]),
    lambda: tactor.Path.arc((0, 0), -1, 0, 90),
    lambda: tactor.Stroke.along(tactor.Path.svg("M 0 0 L 1 1"), duration=0), lambda: tactor.Stroke.along(tactor.Path.svg("M 0 0 L 1 1"), speed=0),
    lambda: tactor.Stroke.along(tactor.Path.svg("M 0 0 L 1 1"), duration=1, speed=1),
    lambda: tactor.Stroke.timed([0, 1], [0, 1], [0]), lambda: tactor.Stroke.timed([0], [0], [0]),
    lambda: tactor.Stroke.timed([2, 1], [0, 1], [0, 1]), lambda: tactor.Stroke.timed([0, 1], [0, 1], [0, 1], [1, 255]), lambda: tactor.Stroke.timed([0, 1], [0, 1], [0, 1], [1, 2, 3]),
    lambda: tactor.Stroke.preset("park"), lambda: tactor.Stroke.shape("square"),
])
def test_impossible_paths_and_strokes_are_refused(make):
    refused(make)


def test_a_path_of_one_place_is_a_tap_of_the_given_duration():
    for place in (tactor.Path.svg("M 20 10"), tactor.Path.polyline([(20, 10)])):
        tap = tactor.Stroke.along(place, duration=0.3)
        assert (tap.length_mm, tap.duration, tap.position(0.3)) == (0, 0.3, (20, 10))
    for options in ({}, {"speed": 60}):
        assert "duration" in str(refused(lambda: tactor.Stroke.along(place, **options)))


@pytest.mark.parametrize("name", tactor.stroke_shapes())
def test_shapes_are_as_large_as_the_array(palm, name):
    for array in (palm, tactor.Array.grid("wide", 2, 5, 30)):
        plan = tactor.plan(array, tactor.Stroke.shape(name))
        x, y = np.ptp(plan.stroke.position(np.linspace(0, plan.stroke.duration, 500)), axis=0)
        width, height = np.ptp(array.positions, axis=0)
        assert x <= width + 1e-9 and y <= height + 1e-9
        assert name == "tap" or np.isclose(x, width, rtol=1e-3) or np.isclose(y, height, rtol=1e-3)


def test_files_are_loaded_like_by_the_tool(root):
    assert [s.name for s in tactor.load(root / "examples/strokes/several.toml")]
    csv = tactor.load(str(root / "examples/strokes/touch.csv"))
    of_text = tactor.parse((root / "examples/strokes/touch.csv").read_text())
    assert len(csv) == 1 and of_text[0].position(0.1) == csv[0].position(0.1)
    assert len(tactor.load(root / "examples/strokes/drawing.svg")) >= 1


def test_files_of_other_programs_are_loaded_for_one_place_and_fill_the_array(root, palm, tmp_path):
    file = root / "examples/strokes/swipe.tact"
    (front,) = tactor.load(file)
    assert "VestBack" in front.warnings[0] and front.position(0.9) == (1.0, 0.2)
    assert [s.start for s in tactor.parse(file.read_text(), position="VestBack")] == [0.3, 0.3]
    with pytest.raises(tactor.InputError, match="position"):
        tactor.load(file, position="Neck")
    (fitted,) = tactor.apply_fits([front], palm)
    assert np.allclose(fitted.position([0.0, 0.45, 0.9]), [(0, 8), (20, 32), (40, 8)]) and fitted.intensity(0.45) == 0.5
    assert pickle.loads(pickle.dumps(front)) == front
    plan = tactor.plan(palm, tactor.Stroke.shape("tap"), waveform=str(root / "examples/strokes/knock.haptic"))
    assert pickle.loads(pickle.dumps(plan)) == plan


def test_strokes_are_fitted(palm, stroke):
    far = tactor.Stroke.along(tactor.Path.svg("M 1000 1000 L 1100 1050"), duration=1.0)
    (fitted,), placed = tactor.fit_strokes([far], palm, 2.0)
    assert fitted == far.fitted(palm, 2.0) and palm.contains(fitted.position(0)) and placed.scale < 1
    assert tactor.plan(palm, far, fit=True, fit_margin=2.0).stroke == fitted


def test_a_group_is_fitted_together(tmp_path, palm):
    file = tmp_path / "group.toml"
    file.write_text('[[stroke]]\nfit = true\nfit_margin_mm = 5\n[[stroke.stroke]]\npath = "M 0 0 L 10 0"\n[[stroke.stroke]]\npath = "M 0 10 L 5 10"\n'
                    '[[stroke]]\npath = "M 1 2 L 30 40"\n')
    strokes = tactor.load(file)
    for take in (tactor.plan, tactor.compare):
        with pytest.raises(tactor.InputError, match="apply_fits"):
            take(palm, strokes[0])
    fitted = tactor.apply_fits(strokes, palm)
    assert fitted[2] == strokes[2] and fitted[0].position(0) == pytest.approx((5.0, 5.0)) and fitted[1].position(10) == pytest.approx((20.0, 35.0))
    assert tactor.apply_fits(fitted, palm) == fitted


def test_values_have_a_readable_repr(palm, stroke):
    assert repr(palm) == "<tactor.Array 'palm-3x3': 9 tactors, 9 channels>"
    assert repr(stroke) == f"<tactor.Stroke 'path': {stroke.length_mm:.6g} mm in 1.2 s>"
    assert repr(tactor.Path.svg("M 0 0 L 3 4")) == "<tactor.Path 'M 0 0 L 3 4': 5 mm>"


def test_values_need_their_arguments():
    for kind in (tactor.Path, tactor.Stroke, tactor.Plan):
        with pytest.raises(TypeError):
            kind()


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
def test_a_copy_stays_the_same_when_the_file_changes(tmp_path, palm_with, stroke, again):
    array = palm_with("[defaults]\nlevel-dbfs = -30\n")
    expected = tactor.Score(array, tactor.plan(array, stroke)).render()
    (tmp_path / "palm.toml").unlink()
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
