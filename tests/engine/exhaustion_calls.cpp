// SPDX-License-Identifier: MIT
// Calls that throw: values, paths, plans, predictions and scores; files, devices, lines and sinks; a player.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>

#include <tactor/alsa.hpp>
#include <tactor/config.hpp>
#include <tactor/lines.hpp>
#include <tactor/percept.hpp>
#include <tactor/phantom.hpp>
#include <tactor/player.hpp>
#include <tactor/render.hpp>
#include <tactor/setup.hpp>
#include <tactor/sink.hpp>
#include <tactor/stroke.hpp>
#include <tactor/tactor.hpp>
#include <tactor/waveform.hpp>

#include "amplifier/line.hpp"
#include "clock_runner.hpp"
#include "core/owned.hpp"
#include "exhaustion_calls.hpp"
#include "player_support.hpp"
#include "sink/alsa/pcm_sink.hpp"

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
    curve_samples all;
    for (int i = 0; i < 3; ++i)
        all.add({.drives = {{.tactor = 0, .amplitude = 0.5}}});
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
    const std::vector<point> corners{{0.0, 0.0}, {10.0, 0.0}, {10.0, 10.0}};
    const std::vector<timed_point> times{{.t_s = 0.0}, {.t_s = 1.0, .position = {10.0, 0.0}}};
    const movement varied{.easing = easing_kind::in_out,
                          .speed_mm_s = {{0.0, 10.0}, {1.0, 20.0}},
                          .intensity = {{0.0, 1.0}, {1.0, 0.5}},
                          .rests = {{.part = 0.5, .time_s = 0.1}}};
    const auto wave = waveform{.kind = waveform_kind::recording, .recorded = some_recording()};
    const auto same_wave = waveform{.kind = waveform_kind::recording, .recorded = some_recording()};
    written_value said;
    said.value = std::string("a text that is longer than a short one");
    const written_value same_said = said;
    const curve c(0.002, three_samples());
    const curve same_c(0.002, three_samples());
    const auto out = std::make_shared<burst>();
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
                          start_from_kind, start_kind, state_kind, texture_kind, timing_kind, together_kind,
                          wait_kind, waveform_kind>();
         }},
        {"build_facts", [] { return build_facts(); }},
        {"threshold_at", [&t] { return threshold_at(t.a.tactors.front(), 250.0); }},
        {"find_grid", [&t] { return find_grid(t.a); }},
        {"make_grid", [] { return make_grid("a", 2, 3, 20.0, 20.0); }},
        {"array_presets", [] { return array_presets().size(); }},
        {"preset_array", [] { return preset_array("palm-3x3"); }},
        {"validate", [&t] { validate(t.a); }},
        {"validate", [wave] { validate(wave); }},
        {"validate", [] { validate(modulation{.hz = 10.0}); }},
        {"path::from_svg", [] { return path::from_svg("M 0 10 C 20 -5 20 45 40 30"); }},
        {"path::polyline", [corners] { return path::polyline(corners); }},
        {"path::arc", [] { return path::arc(point(), 10.0, 0.0, 90.0); }},
        {"path::meets_x", [line] { return line.meets_x(20.0); }},
        {"path::meets_y", [line] { return line.meets_y(20.0); }},
        {"path::svg", [line] { return line.svg(); }},
        {"trajectory::trajectory", [] { return trajectory(); }},
        {"trajectory::along", [line] { return trajectory::along(line, 1.0); }},
        {"trajectory::along", [line, varied] { return trajectory::along(line, varied); }},
        {"trajectory::timed", [times] { return trajectory::timed(times); }},
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
        {"curve::sample", [c, out] { c.sample(1, *out); }},
        {"curve::at", [c, out] { c.at(0.0015, *out); }},
        {"curve::operator==", [c, same_c] { return c == same_c; }},
        {"written_value::operator==", [said, same_said] { return said == same_said; }},
        {"waveform::operator==", [wave, same_wave] { return wave == same_wave; }},
        {"waveform_text", [wave] { return waveform_text(wave); }},
        {"parse_modulation", [] { return parse_modulation("20:0.5"); }},
        {"parse_envelope", [] { return parse_envelope("tukey:0.5"); }},
        {"envelope_text",
         [] { return envelope_text({.kind = envelope_kind::tukey, .tukey_part = 0.123456789}); }},
    };
}

namespace {

plan_options planned_by(algorithm_kind k)
{
    return {.algorithm = k};
}

const std::vector<double> onsets_s{0.0, 0.1, 0.2};
constexpr point place{11.0, 12.0};

} // namespace

call_table plan_calls(const call_things& t)
{
    const auto model = make_phantom(phantom_kind::gaussian, t.l);
    const auto samples = predict_percept(t.a, t.s, t.p);
    const auto taps = predict_taps(t.a, t.s, t.p);
    const std::vector<point> inside{{10.0, 20.0}, {20.0, 20.0}, {30.0, 20.0}};
    const std::vector<point> edges{{0.0, 0.0}, {40.0, 40.0}, {0.0, 40.0}};
    stroke fitted = t.s;
    fitted.fit = stroke_fit{5.0};
    const person who{.sensitivity_db = std::vector<double>(9, 1.0), .shift = std::vector<point>(9)};
    return {
        {"layout::layout", [&t] { return layout(t.a); }},
        {"layout::contains", [&t] { return t.l.contains(place); }},
        {"layout::nearest", [&t] { return t.l.nearest(place); }},
        {"make_phantom", [&t] { return make_phantom(phantom_kind::barycentric, t.l); }},
        {"phantom_model::weights",
         [model] {
             std::vector<drive> out;
             model->weights(place, 1.0, out);
         }},
        {"intensity_scale::amplitude", [] { return intensity_scale{.kind = scale_kind::sl}.amplitude(0.5); }},
        {"burst_duration_s", [] { return burst_duration_s(timing_profile{}, 1.0); }},
        {"burst_duration_s", [] { return burst_duration_s({.soa_s = 1.0}); }},
        {"make_plan", [&t] { return make_plan(t.a, t.s); }},
        {"make_plan", [&t] { return make_plan(t.a, t.l, t.s, planned_by(algorithm_kind::tactile_brush)); }},
        {"make_plan, continuous",
         [&t] { return make_plan(t.a, t.l, t.s, planned_by(algorithm_kind::continuous)); }},
        {"make_plan, fitted", [&t, fitted] { return make_plan(t.a, t.l, fitted, {}); }},
        {"fit_strokes", [&t] { return fit_strokes({t.s}, t.l); }},
        {"apply_fits", [&t, fitted] { return apply_fits({fitted}, t.l); }},
        {"predict_percept", [&t] { return predict_percept(t.a, t.s, t.p); }},
        {"follow_percept", [&t, who] { follow_percept(t.a, t.s, t.p, who, [](const percept_sample&) {}); }},
        {"summarise", [samples] { return summarise(samples); }},
        {"summarise", [&t] { return summarise(t.a, t.s, t.p); }},
        {"summarise", [taps] { return summarise(taps); }},
        {"describe", [] { return describe(low_speed_observer{}); }},
        {"felt_places", [inside] { return felt_places({}, onsets_s, inside); }},
        {"predict_taps", [&t] { return predict_taps(t.a, t.s, t.p); }},
        {"predict_taps, of a person", [&t, who] { return predict_taps(t.a, t.s, t.p, {}, who); }},
        {"compensate", [&t, inside] { return compensate(t.l, {}, onsets_s, inside); }},
        {"compensate, at the edge", [&t, edges] { return compensate(t.l, {}, onsets_s, edges); }},
        {"make_compensated_plan", [&t] { return make_compensated_plan(t.a, t.l, t.s, {}); }},
    };
}

call_table sound_calls(const call_things& t)
{
    const std::vector<placed_plan> plans{{.plan = t.p}, {.plan = t.p, .start_s = 1.0}};
    const auto sine = make_plan(t.a, t.l, t.s, planned_by(algorithm_kind::continuous));
    const auto sound = std::make_shared<score>(t.a, std::vector<placed_plan>{{.plan = sine}});
    // Each of its samples needs memory.
    const auto wide = std::make_shared<score>(t.a, make_continuous(t.s, faces_kind::nearest));
    const auto rendered_by = std::make_shared<renderer>(*sound, format_kind::s16);
    const auto builder = std::make_shared<score_builder>(t.a, render_options{});
    return {
        {"start_times_s", [plans] { return start_times_s(plans); }},
        {"score::score", [&t, plans] { return score(t.a, plans); }},
        {"score::score", [&t] { return score(t.a, t.p); }},
        {"score::score, continuous", [&t, sine] { return score(t.a, sine); }},
        {"score::from_samples",
         [] {
             const array one = make_grid("one", 1, 1, 20.0, 20.0);
             return score::from_samples(one, {.bytes = std::vector<std::byte>(4096)});
         }},
        {"score_builder::score_builder", [&t] { const score_builder made(t.a, {}); }},
        {"score_builder::add",
         [&t] {
             score_builder made(t.a, {});
             made.add(t.p);
         }},
        {"score_builder::add",
         [&t] {
             score_builder made(t.a, {});
             made.add(t.l, t.s, {});
         }},
        {"score_builder::take", [builder] { return builder->take(); }, call_kind::plain,
         [builder, &t] {
             static_cast<void>(builder->take());
             builder->add(t.p);
         }},
        {"renderer::renderer", [sound] { const renderer made(*sound, format_kind::s16); }},
        {"renderer::process",
         [sound] {
             renderer made(*sound, format_kind::s16);
             std::vector<std::byte> out(2UL * 9 * 4096);
             made.process(out);
         }},
        {"renderer::process, gaussian",
         [wide] {
             renderer made(*wide, format_kind::s16);
             std::vector<std::byte> out(2UL * 9 * 1024);
             made.process(out);
         }},
        {"renderer::position", [rendered_by] { return rendered_by->position(); }},
    };
}

namespace {

const std::string csv_text = "t_s,x_mm,y_mm\n0,0,0\n1,10,0\n";
const std::string svg_text =
    R"(<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="40mm" viewBox="0 0 40 40">)"
    R"(<path d="M 0 10 L 40 30"/></svg>)";
const std::string toml_text = "[[stroke]]\npath = \"M 0 0 L 40 40\"\n";
const std::string array_text = "[array]\ngrid = { rows = 1, columns = 2, pitch_mm = 20.0 }\n";

} // namespace

call_table file_calls(const call_things& t)
{
    using enum call_kind;
    const auto csv_file = t.here.write("s.csv", csv_text);
    const auto toml_file = t.here.write("s.toml", toml_text);
    const auto array_file = t.here.write("a.toml", array_text);
    const auto wave_file = t.here.path() / "w.wav";
    const plan short_burst = make_bursts({{.duration_s = 0.01, .drives = {{0, 1.0}}}});
    write_wav(score(make_grid("one", 1, 1, 20.0, 20.0), short_burst), format_kind::s16, wave_file);
    const auto from = std::make_shared<detail::owned_fd>();
    const score sound(t.a, t.p);
    return {
        {"stroke_presets", [] { return stroke_presets().size(); }},
        {"preset_stroke", [] { return preset_stroke("park2016-4"); }},
        {"stroke_shapes", [] { return stroke_shapes().size(); }},
        {"shape_stroke", [] { return shape_stroke("spiral"); }},
        {"load_strokes", [csv_file] { return load_strokes(csv_file); }, opens},
        {"load_strokes, of TOML", [toml_file] { return load_strokes(toml_file); }, opens_ends},
        {"load_strokes", [from] { return load_strokes(from->get(), "input"); }, plain,
         [from, csv_file] { *from = detail::owned_fd(::open(csv_file.c_str(), O_RDONLY | O_CLOEXEC)); }},
        {"parse_strokes_toml", [] { return parse_strokes_toml(toml_text, "s.toml"); }, ends},
        {"parse_strokes_csv", [] { return parse_strokes_csv(csv_text, "s.csv"); }},
        {"parse_strokes_svg", [] { return parse_strokes_svg(svg_text, "s.svg"); }},
        {"parse_strokes", [] { return parse_strokes(svg_text, "input"); }},
        {"parse_strokes, of TOML", [] { return parse_strokes(toml_text, "input"); }, ends},
        {"load_setup", [array_file] { return load_setup(array_file); }, opens_ends},
        {"parse_setup", [] { return parse_setup(array_text, "a.toml"); }, ends},
        {"parse_waveform, of noise", [] { return parse_waveform("noise:50-500"); }},
        {"parse_waveform", [wave_file] { return parse_waveform(wave_file.string()); }, opens},
        {"load_samples", [wave_file] { return load_samples(wave_file); }, opens},
        {"load_recording", [wave_file] { return load_recording(wave_file); }, opens},
        {"write_wav", [sound, &t] { write_wav(sound, format_kind::s16, t.here.path() / "x.wav"); }, opens},
    };
}

call_table device_calls()
{
    using enum call_kind;
    const gpio_line_name line{.name = "no-such-line"};
    const call_kind looks = amplifier::built_in() ? opens : plain;
    return {
        {"open_alsa", [] { return open_alsa(nine()); }, opens_ends},
        {"open_alsa, of a card", [] { return open_alsa({.pcm = "hw:0", .channels = 2}); }, opens_ends},
        {"open_alsa, of nothing", [] { return open_alsa({.pcm = "no such PCM", .channels = 2}); },
         opens_ends},
        {"reopen_alsa", [] { return reopen_alsa(nine(), [n = 0](double) mutable { return n++ == 0; }); },
         opens_ends},
        {"reopen_alsa, never", [] { return reopen_alsa(nine(), {}); }},
        {"list_pcms", [] { return list_pcms(); }, opens_ends},
        {"list_pcms, that suit", [] { return list_pcms(nine()); }, opens_ends},
        {"read_route", [] { return read_route("null"); }, opens_ends},
        {"read_wiring", [] { return read_wiring("null", 2); }, opens_ends},
        {"require_device_name", [] { require_device_name("null"); }, opens_ends},
        {"read_card", [] { return read_card("hw:0"); }, opens},
        {"card_holders", [] { return card_holders(0); }, opens},
        {"list_gpio", [] { return list_gpio(); }, opens},
        {"find_gpio_line", [line] { return find_gpio_line(line); }, looks},
        {"open_output", [line] { return open_output(line); }, looks},
        {"open_edges", [line] { return open_edges(line, edge_kind::rising); }, looks},
        {"open_amplifier", [line] { return open_amplifier({.line = line}); }, looks},
        {"paced_sink::paced_sink",
         []() -> std::unique_ptr<paced_sink> {
             return std::make_unique<deaf_sink>(stream_setup{.name = "deaf", .channels = 2, .rate = 48000});
         },
         opens},
    };
}

namespace {

// Things made anew before each call.
struct fresh {
    std::unique_ptr<fake_dac> dac = {};
    std::unique_ptr<running_clock> clock = {};
    std::unique_ptr<sink> out = {};
    std::unique_ptr<clocked_player> open = {};

    void make_sink()
    {
        out.reset();
        clock.reset();
        dac = std::make_unique<fake_dac>();
        clock = std::make_unique<running_clock>(*dac);
        out = alsa::adopt(dac->pcm(), nine());
    }
    void make_player()
    {
        open.reset();
        open = std::make_unique<clocked_player>();
    }
};

live_options soon_over()
{
    return {.timeout_s = 0.001};
}

} // namespace

struct player_things {
    clocked_player open{};
    fresh anew = {};
    score s = tone(0.001);
    stroke_id id = {};
    std::optional<live_stroke> live = {};
};

std::shared_ptr<player_things> make_player_things()
{
    return std::make_shared<player_things>();
}

call_table player_calls(player_things& t)
{
    using enum call_kind;
    player& p = t.open;
    const auto submitted = [&t, &p] { t.id = p.submit(t.s); };
    const auto armed = [&t, &p] { t.id = p.submit(t.s, start_at::trigger()); };
    const auto begun = [&t, &p] {
        if (t.live)
            t.live->cancel();
        t.live.emplace(p.begin({.timeout_s = 86400.0}));
    };
    const stream_wiring shared{.outputs = {{0}, {0}}};
    const stream_wiring quiet{.outputs = {{0}}, .gains = {{0.1}}, .level_by = "type softvol"};
    const auto stopped = [&t] {
        t.anew.make_player();
        t.anew.open->stop();
    };
    return {
        {"player::player", [&t] { const player made(std::move(t.anew.out), palm(), patient()); }, opens,
         [&t] { t.anew.make_sink(); }},
        {"player::submit", [&t, &p] { return p.submit(t.s); }},
        {"player::submit, from a frame on", [&t, &p] { return p.submit(t.s, start_at::frame(0)); }},
        {"player::submit, from a time on",
         [&t, &p] { return p.submit(t.s, start_at::time(rt::to_time(0))); }},
        {"player::submit, when triggered", [&t, &p] { return p.submit(t.s, start_at::trigger()); }},
        {"player::submit, to a stream that has ended", [&t] { return t.anew.open->submit(t.s); }, plain,
         stopped},
        {"player::fire", [&p] { return p.fire({}); }, plain, armed},
        {"player::begin", [&p] { return p.begin(soon_over()); }},
        {"player::begin, of bursts",
         [&p] {
             live_options o = soon_over();
             o.plan.algorithm = algorithm_kind::park2016;
             return p.begin(o);
         }},
        {"player::cancel", [&t, &p] { return p.cancel(t.id); }, plain, armed},
        {"player::set_level", [&t, &p] { return p.set_level(t.id, -6.0); }, plain, armed},
        {"player::first_frame", [&t, &p] { return !p.first_frame(t.id); }, plain, armed},
        {"player::cancel_all", [&p] { return p.cancel_all(); }, plain, armed},
        {"player::wait", [&t, &p] { return p.wait(t.id); }, plain, submitted},
        {"player::on_begin", [&p] { p.on_begin([](stroke_id, std::optional<std::int64_t>) {}); }},
        {"player::on_report", [&p] { p.on_report([](const stroke_report&) {}); }},
        {"player::on_end", [&t, &p] { return p.on_end(t.id, [](const stroke_report&) {}); }, plain, armed},
        {"player::stop", [&t] { t.anew.open->stop(); }, plain, [&t] { t.anew.make_player(); }},
        {"player::ended", [&t] { return t.anew.open->ended(); }, plain, stopped},
        {"player::stats", [&p] { return p.stats(); }},
        {"player::drive_levels_s", [&p] { return p.drive_levels_s(); }},
        {"player::drive_time_doubt", [&p] { return p.drive_time_doubt(); }},
        {"live_stroke::to", [&t] { return t.live->to(20.0, 20.0); }, plain, begun},
        {"lost_tactor", [shared] { return lost_tactor(palm(), shared); }},
        {"wiring_warnings", [quiet] { return wiring_warnings(palm(), quiet); }},
        {"drive_time_fault", [] { return drive_time_fault("null"); }},
    };
}

} // namespace tactor::test
