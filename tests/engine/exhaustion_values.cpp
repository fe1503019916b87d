// SPDX-License-Identifier: MIT
// Calls that throw: errors, arrays, paths, trajectories, curves, waveforms.
#include <memory>
#include <vector>

#include <tactor/tactor.hpp>

#include "exhaustion_calls.hpp"

namespace tactor::test {
namespace {

template <typename... Kinds>
void from_no_name()
{
    const auto one = []<typename Kind>(const Kind*) {
        try {
            static_cast<void>(from_string<Kind>("no such name"));
        } catch (const error&) { // as it should be
        }
    };
    (one(static_cast<const Kinds*>(nullptr)), ...);
}

curve_samples three_samples()
{
    burst b;
    b.drives = {{.tactor = 0, .amplitude = 0.5}};
    curve_samples all;
    for (int i = 0; i < 3; ++i)
        all.add(b);
    return all;
}

std::shared_ptr<const recording> some_recording()
{
    return std::make_shared<const recording>(recording{.file = "r.wav", .samples = {0.0F, 1.0F, -1.0F}});
}

} // namespace

call_table value_calls(const call_things& t)
{
    const auto line = path::from_svg("M 0 0 L 40 40 L 0 40");
    const auto motion = trajectory::along(line, 1.0);
    const auto wave = waveform{.kind = waveform_kind::recording, .recorded = some_recording()};
    const auto same_wave = waveform{.kind = waveform_kind::recording, .recorded = some_recording()};
    written_value said;
    said.said = std::string("a text that is longer than a short one");
    const written_value same_said = said;
    const curve c(0.002, three_samples());
    const curve same_c(0.002, three_samples());
    const error e(error_kind::runtime, "what", "why");
    return {
        {"error::error", [] { return error(error_kind::runtime, "what it is", "why it is so", "a hint"); }},
        {"error::error",
         [] { return error(error_kind::runtime, source_place{.file = "f", .line = 1}, "why"); }},
        {"error::with_field", [e] { return e.with_field("soa_s"); }},
        {"error::with_place", [e] { return e.with_place({.file = "f", .line = 1, .column = 2}); }},
        {"error::with_os_code", [e] { return e.with_os_code(2); }},
        {"error::reworded", [e] { return e.reworded("what else", "why else", "a longer hint than this"); }},
        {"source_place::text", [] { return source_place{.file = "a longer name", .line = 1}.text(); }},
        {"from_string",
         [] {
             from_no_name<actuator_kind, algorithm_kind, easing_kind, edge_kind, envelope_kind, error_kind,
                          faces_kind, format_kind, io_kind, log_kind, note_kind, observer_kind, outside_kind,
                          overlap_kind, phantom_kind, phase_kind, pull_kind, reason_kind, scale_kind,
                          start_from_kind, start_kind, state_kind, texture_kind, timing_kind, wait_kind,
                          waveform_kind>();
         }},
        {"build_facts", [] { return build_facts(); }},
        {"threshold_at", [&t] { return threshold_at(t.a.tactors.front(), 250.0); }},
        {"find_grid", [&t] { return find_grid(t.a); }},
        {"make_grid", [] { return make_grid("a", 2, 3, 20.0, 20.0); }},
        {"make_grid, none", [] { return make_grid("a", 0, 3, 20.0, 20.0); }},
        {"array_presets", [] { return array_presets().size(); }},
        {"preset_array", [] { return preset_array("palm-3x3"); }},
        {"preset_array, unknown", [] { return preset_array("palm-3x4"); }},
        {"validate", [&t] { validate(t.a); }},
        {"validate, of nothing", [] { validate(array{}); }},
        {"validate", [wave] { validate(wave); }},
        {"validate", [] { validate(modulation{.hz = 10.0}); }},
        {"path::from_svg", [] { return path::from_svg("M 0 10 C 20 -5 20 45 40 30"); }},
        {"path::from_svg, no path", [] { return path::from_svg("M 0 10 C 20"); }},
        {"path::polyline",
         [] {
             const std::vector<point> corners{{0.0, 0.0}, {10.0, 0.0}, {10.0, 10.0}};
             return path::polyline(corners);
         }},
        {"path::arc",
         [] {
             return path::arc({0.0, 0.0}, 10.0, 0.0, 90.0);
         }},
        {"path::meets_x", [line] { return line.meets_x(20.0); }},
        {"path::meets_y", [line] { return line.meets_y(20.0); }},
        {"path::svg", [line] { return line.svg(); }},
        {"trajectory::trajectory", [] { return trajectory(); }},
        {"trajectory::along", [line] { return trajectory::along(line, 1.0); }},
        {"trajectory::along, too long", [line] { return trajectory::along(line, 1e6); }},
        {"trajectory::along",
         [line] {
             const movement m{.easing = easing_kind::in_out,
                              .speed_mm_s = {{0.0, 10.0}, {1.0, 20.0}},
                              .intensity = {{0.0, 1.0}, {1.0, 0.5}},
                              .rests = {{.part = 0.5, .time_s = 0.1}}};
             return trajectory::along(line, m);
         }},
        {"trajectory::timed",
         [] {
             return trajectory::timed({{.t_s = 0.0}, {.t_s = 1.0, .position = {10.0, 0.0}}});
         }},
        {"trajectory::timed, one point", [] { return trajectory::timed({{.t_s = 0.0}}); }},
        {"trajectory::with_duration", [motion] { return motion.with_duration(2.0); }},
        {"trajectory::with_speed", [motion] { return motion.with_speed(20.0); }},
        {"trajectory::reversed", [motion] { return motion.reversed(); }},
        {"trajectory::with_intensity", [motion] { return motion.with_intensity(0.5); }},
        {"trajectory::meets_x", [motion] { return motion.meets_x(20.0); }},
        {"trajectory::meets_y", [motion] { return motion.meets_y(20.0); }},
        {"resolve_start_s", [] { return resolve_start_s(-1.0, {}, {}, {}); }},
        {"start_at::frame", [] { return start_at::frame(-1); }},
        {"curve_samples::add",
         [] {
             curve_samples all;
             all.add({.drives = {{.tactor = 0, .amplitude = 0.5}}});
         }},
        {"curve::curve", [] { return curve(0.002, three_samples()); }},
        {"curve::curve, too few samples", [] { return curve(0.2, three_samples()); }},
        {"curve::sample",
         [c] {
             burst b;
             c.sample(1, b);
         }},
        {"curve::at",
         [c] {
             burst b;
             c.at(0.0015, b);
         }},
        {"curve::operator==", [c, same_c] { return c == same_c; }},
        {"written_value::operator==", [said, same_said] { return said == same_said; }},
        {"waveform::operator==", [wave, same_wave] { return wave == same_wave; }},
        {"waveform_text", [wave] { return waveform_text(wave); }},
        {"parse_modulation", [] { return parse_modulation("20:0.5"); }},
        {"parse_modulation, of nothing", [] { return parse_modulation("twenty, or so"); }},
        {"parse_envelope", [] { return parse_envelope("tukey:0.5"); }},
        {"parse_envelope, of nothing", [] { return parse_envelope("turkey"); }},
        {"envelope_text",
         [] { return envelope_text({.kind = envelope_kind::tukey, .tukey_part = 0.123456789}); }},
    };
}

} // namespace tactor::test
