# SPDX-License-Identifier: MIT
"""Holds a Python name, or a reason, for each public C++ name."""
import re

import tactor

# C++ name: its place in Python.
HAS = """
actuator_kind: Tactor.actuator
algorithm_kind: Plan.algorithm
alsa_options: Player
array: Array
array_presets: array_presets
build_facts: build_facts
burst: Burst
burst_duration_s: burst_duration
conflict: Conflict
curve: Plan.curve
curve_samples: Curve
drive: Drive
drive_limits: Score
easing_kind: Stroke.along
error: Error
error_kind: InputError
faces_kind: Plan.faces
find_grid: Array.grid_lines
apply_fits: apply_fits
fit_strokes: fit_strokes
fitted_strokes: fit_strokes
fitting: Fitting
format_kind: Score.write
gpio_chip_info: devices
gpio_line_info: devices
grid_lines: Array.grid_lines
layout: Array.faces
limit_settings: Player
list_gpio: devices
list_pcms: devices
live_counts: LiveStroke.counts
live_delay: Delay
live_options: Player.live
live_stroke: LiveStroke
load_setup: Array.from_file
calibrated_tactor: Array.from_file
calibration_origin: Array.from_file
load_strokes: load
log_function: Player
log_kind: Player
make_grid: Array.grid
make_phantom: Array.weights
make_plan: plan
meeting: Meeting
movement: Stroke.along
note_kind: Stroke.note
observer_kind: compare
person: compare
low_speed_observer: compare
predict_taps: compare
tap: compare
tap_summary: compare
compensated_plan: Plan.compensation
make_compensated_plan: plan
open_alsa: Player
open_amplifier: Player
open_edges: Player
open_output: Player
outside_kind: plan
output_settings: Array.from_file
overlap_kind: Plan.overlap
parse_strokes: parse
parse_strokes_csv: parse
parse_strokes_svg: parse
parse_strokes_toml: parse
path: Path
pcm_abilities: devices
pcm_info: devices
percept_sample: PerceptSample
percept_summary: Plan.percept_summary
phantom_kind: Plan.phantom
phantom_model: PhantomModel
phase_kind: Score
placed_plan: Plan.start
plan: Plan
plan_options: plan
player: Player
player_options: Player
player_position: Player.position
player_stats: Player.stats
point: Point
predict_percept: Plan.percept
follow_percept: Plan.percept
preset_array: Array.preset
preset_stroke: Stroke.preset
profile_point: Stroke.along
process_info: devices
render_options: Score
renderer: Score.render
rest: Stroke.along
score: Score
setup: Array.from_file
source_place: Error.file
start_at: Player.submit
start_kind: Player.submit
start_anchor: Stroke.start
start_from_kind: Stroke.start_from
start_times_s: Score.starts
state_kind: Report.state
reason_kind: Report.reason
stream_end: Player.ended
wait_kind: Ticket.wait
wait_result: Ticket.wait
stream_setup: Player.setup
stream_wiring: Player
lost_tactor: Player
read_wiring: Player
wiring_warnings: Player
stroke: Stroke
stroke_choices: Stroke.choices
stroke_id: Ticket.id
stroke_presets: stroke_presets
stroke_shapes: stroke_shapes
shape_stroke: Stroke.shape
stroke_report: Report
stroke_waiter: Ticket.__await__
summarise: Plan.percept_summary
tactor_spec: Tactor
timed_point: Stroke.timed
timing_kind: plan
timing_profile: plan
trajectory: Stroke
validate: Array
version: __version__
waveform: plan
waveform_kind: plan
texture_kind: plan
modulation: plan
envelope_kind: Score
burst_envelope: Score
scale_kind: plan
intensity_scale: plan
write_wav: Score.write
"""

# C++ names without a Python one, with the reason.
HAS_NOT = {
    "to_string all_values from_string": "closed sets are str",
    "error_category make_error_code": "exceptions have classes",
    "distance_mm": "math.dist",
    "same_place_mm edge_tolerance_mm continuous_step_s percept_step_s percept_window_s longest_percept_s default_speed_mm_s no_limit": "constants of the model, in the documents",
    "describe least_sigma_mm most_sigma_mm least_sigma_v_mm_s most_sigma_v_mm_s": "words and bounds, which messages say",
    "felt_places compensate compensated_places": "compare(observer=...) and plan(compensate=...) ask them of plans",
    "burst_ramp_s": "in the record of each burst: Plan.to_dict()",
    "sample_bytes": "the dtype's itemsize",
    "resolve_start_s": "Score does it for its plans",
    "parse_envelope envelope_text": "envelope and tukey_part of a Score",
    "parse_waveform waveform_names_file waveform_text parse_modulation recording load_recording": "plan(waveform=..., am=...) read texts and files",
    "least_noise_hz most_cycle_samples most_recording_samples max_pcm_channels": "bounds, which messages say",
    "stroke_fit stroke_sound stroke_places carrier_part carrier_point":
        "of stroke files: Stroke.load(), and the record of a plan: Plan.to_dict()",
    "threshold_point threshold_at": "Tactor.thresholds; a Score uses them",
    "score_builder": "a Score is made from plans that are there; the tool plans strokes while it places them",
    "sink paced_sink io_kind io_result stream_position": "what the audio thread calls cannot be Python",
    "enable_line edge_input gpio_edge gpio_line_name gpio_line_place find_gpio_line player_lines amplifier_settings sync_settings edge_kind pull_kind":
        "lines are the configuration's; a player opens them",
    "reopen_alsa": "make a Player again",
    "drive_time_fault": "a Player warns",
    "read_route pcm_route require_device_name read_card card_info card_holders count_range": "what devices and Player look at themselves",
    "probe_realtime_rights realtime_rights": "Player.stats()['realtime'], and `tactor check`",
    "parse_setup written_value": "Array.from_file reads files",
    "wav_progress": "Ctrl-C gives up",
}


def public_names(root):
    names = set()
    for header in (root / "include/tactor").glob("*.hpp"):
        text = re.sub(r"//[^\n]*", "", header.read_text(encoding="utf-8"))
        names |= set(re.findall(r"^(?:class|struct|enum class)\s+(?:TACTOR_API\s+)?(\w+)\b(?!::)(?=[^;]*\{)", text, re.M))
        names |= set(re.findall(r"^(?:\[\[\w+\]\] )*TACTOR_API\s[^;{(]*?\b(\w+)(?:<\w+>)?\s*\(", text, re.M))
        names |= set(re.findall(r"^inline\s[^;{(]*?\b(\w+)\s*[(=]", text, re.M))
        names |= set(re.findall(r"^using (\w+) =", text, re.M))
    return names


def test_each_public_name_has_its_python_one_or_a_reason(root):
    has = dict(line.split(": ") for line in HAS.strip().splitlines())
    has_not = {n for names in HAS_NOT for n in names.split()}
    assert not set(has) & has_not
    names = public_names(root)
    assert len(names) > 100
    assert names - set(has) - has_not == set(), "neither in HAS nor in HAS_NOT"
    assert (set(has) | has_not) - names - {"all_values", "from_string", "to_string"} == set(), "no longer a C++ name"
    for where in has.values():
        thing = tactor
        for part in where.split("."):
            fields = getattr(thing, "__annotations__", {}) if not hasattr(thing, part) else None
            assert fields is None or part in fields, where
            thing = getattr(thing, part, None)
