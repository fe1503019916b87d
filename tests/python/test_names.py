# SPDX-License-Identifier: MIT
"""Holds a Python name, or a reason, for each public C++ name."""
import re

import tactor

# Place in Python: the C++ names that it stands for.
HAS = {
    "Tactor.actuator": "actuator_kind", "Plan.algorithm": "algorithm_kind",
    "Player": "alsa_options limit_settings log_function log_kind open_alsa open_amplifier open_edges open_output player player_options stream_wiring lost_tactor read_wiring wiring_warnings",
    "Array": "array validate", "array_presets": "array_presets", "build_facts": "build_facts", "Burst": "burst", "burst_duration": "burst_duration_s",
    "Conflict": "conflict", "Plan.curve": "curve", "Curve": "curve_samples", "Drive": "drive",
    "Score": "drive_limits phase_kind render_options score envelope_kind burst_envelope", "Stroke.along": "easing_kind movement profile_point rest",
    "Error": "error", "InputError": "error_kind", "Plan.faces": "faces_kind", "Array.grid_lines": "find_grid grid_lines", "apply_fits": "apply_fits",
    "fit_strokes": "fit_strokes fitted_strokes", "Fitting": "fitting", "Score.write": "format_kind write_wav",
    "devices": "gpio_chip_info gpio_line_info list_gpio list_pcms pcm_abilities pcm_info process_info", "Array.faces": "layout",
    "LiveStroke.counts": "live_counts", "Delay": "live_delay", "Player.live": "live_options", "LiveStroke": "live_stroke",
    "Array.from_file": "load_setup calibrated_tactor calibration_origin output_settings setup", "load": "load_strokes", "Array.grid": "make_grid",
    "Array.weights": "make_phantom",
    "plan": "make_plan make_compensated_plan outside_kind plan_options timing_kind timing_profile waveform waveform_kind texture_kind modulation scale_kind intensity_scale",
    "Meeting": "meeting", "Stroke.note": "note_kind", "compare": "observer_kind person low_speed_observer predict_taps tap tap_summary",
    "Plan.compensation": "compensated_plan", "Plan.overlap": "overlap_kind", "Score.weakened_db": "weakening together_kind",
    "parse": "parse_strokes parse_strokes_csv parse_strokes_svg parse_strokes_toml", "Path": "path", "PerceptSample": "percept_sample",
    "Plan.percept_summary": "percept_summary summarise", "Plan.phantom": "phantom_kind", "PhantomModel": "phantom_model", "Plan.start": "placed_plan",
    "Plan": "plan", "Player.position": "player_position", "Player.stats": "player_stats", "Point": "point",
    "Plan.percept": "predict_percept follow_percept", "Array.preset": "preset_array", "Stroke.preset": "preset_stroke", "Score.render": "renderer",
    "Error.file": "source_place", "Player.submit": "start_at start_kind", "Stroke.start": "start_anchor", "Stroke.start_from": "start_from_kind",
    "Score.from_samples": "own_samples", "Score.starts": "start_times_s", "Report.state": "state_kind", "Report.reason": "reason_kind", "Player.ended": "stream_end",
    "Ticket.wait": "wait_kind wait_result", "Player.setup": "stream_setup", "Stroke": "stroke trajectory", "Stroke.choices": "stroke_choices",
    "Ticket.id": "stroke_id", "stroke_presets": "stroke_presets", "stroke_shapes": "stroke_shapes", "Stroke.shape": "shape_stroke",
    "Report": "stroke_report", "Ticket.__await__": "stroke_waiter", "Tactor": "tactor_spec", "Stroke.timed": "timed_point", "__version__": "version",
}

# C++ names without a Python one, with the reason.
HAS_NOT = {
    "to_string all_values from_string": "closed sets are str",
    "error_category make_error_code": "exceptions have classes",
    "distance_mm": "math.dist",
    "same_place_mm edge_tolerance_mm continuous_step_s percept_step_s percept_window_s longest_lag_s longest_percept_s default_speed_mm_s no_limit": "constants of the model, in the documents",
    "describe least_sigma_mm most_sigma_mm least_sigma_v_mm_s most_sigma_v_mm_s": "words and bounds, which messages say",
    "felt_places compensate compensated_places": "compare(observer=...) and plan(compensate=...) ask them of plans",
    "burst_ramp_s": "in the record of each burst: Plan.to_dict()",
    "sample_bytes": "the dtype's itemsize",
    "monotonic_time": "seconds, as time.monotonic() has them",
    "resolve_start_s": "Score does it for its plans",
    "parse_envelope envelope_text": "envelope and tukey_part of a Score",
    "parse_waveform waveform_names_file waveform_text parse_modulation recording load_recording timed_value emphasis actuator_numbers vibration": "plan(waveform=..., am=...) read texts and files",
    "load_samples": "SciPy and others read WAV files",
    "least_noise_hz most_cycle_samples most_recording_samples most_own_bytes max_pcm_channels": "bounds, which messages say",
    "stroke_fit stroke_sound stroke_places carrier_part carrier_time carrier_point":
        "of stroke files: Stroke.load(), and the record of a plan: Plan.to_dict()",
    "threshold_point threshold_at": "Tactor.thresholds; a Score uses them",
    "score_builder": "a Score is made from plans that are there; the tool plans strokes while it places them",
    "sink paced_sink io_kind io_result stream_position": "what the audio thread calls cannot be Python",
    "enable_line edge_input gpio_edge gpio_line_name gpio_line_place find_gpio_line player_lines amplifier_settings sync_settings code_settings code_numbering edge_kind pull_kind":
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
        names |= set(re.findall(r"^(?:class|struct|enum class)\s+(?:\[\[\w+\]\]\s+)?(?:TACTOR_API\s+)?(\w+)\b(?!::)(?=[^;]*\{)", text, re.M))
        names |= set(re.findall(r"^(?:\[\[\w+\]\] )*TACTOR_API\s[^;{(]*?\b(\w+)(?:<\w+>)?\s*\(", text, re.M))
        names |= set(re.findall(r"^inline\s[^;{(]*?\b(\w+)\s*[(=]", text, re.M))
        names |= set(re.findall(r"^using (\w+) =", text, re.M))
    return names


def test_each_public_name_has_its_python_one_or_a_reason(root):
    has = {name: place for place, names in HAS.items() for name in names.split()}
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
