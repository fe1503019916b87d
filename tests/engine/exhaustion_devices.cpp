// SPDX-License-Identifier: MIT
// Calls that throw: files, devices, lines and sinks, a player and its live strokes.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <fcntl.h>

#include <tactor/alsa.hpp>
#include <tactor/config.hpp>
#include <tactor/lines.hpp>
#include <tactor/live.hpp>
#include <tactor/player.hpp>
#include <tactor/render.hpp>
#include <tactor/setup.hpp>
#include <tactor/sink.hpp>
#include <tactor/stroke.hpp>
#include <tactor/waveform.hpp>

#include "amplifier/line.hpp"
#include "clock_runner.hpp"
#include "core/owned.hpp"
#include "exhaustion_calls.hpp"
#include "player_support.hpp"
#include "sink/alsa/pcm_sink.hpp"

namespace tactor::test {
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
        {"load_recording", [wave_file] { return load_recording(wave_file); }, opens},
        {"write_wav", [sound, &t] { write_wav(sound, format_kind::s16, t.here.path() / "x.wav"); }, opens},
    };
}

namespace {

class deaf_sink final : public paced_sink {
public:
    using paced_sink::paced_sink;

private:
    io_kind take(std::uint64_t, std::span<const std::byte>) noexcept override { return io_kind::ok; }
};

} // namespace

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
        {"player::submit, from a time on", [&t, &p] { return p.submit(t.s, start_at::time(0)); }},
        {"player::submit, when triggered", [&t, &p] { return p.submit(t.s, start_at::trigger()); }},
        {"player::submit, to a stream that has ended", [&t] { return t.anew.open->submit(t.s); }, plain,
         stopped},
        {"player::fire", [&p] { return p.fire(0); }, plain, armed},
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
        {"live_stroke::to", [&t] { return t.live->to(20.0, 20.0); }, plain, begun},
        {"lost_tactor", [shared] { return lost_tactor(palm(), shared); }},
        {"wiring_warnings", [quiet] { return wiring_warnings(palm(), quiet); }},
        {"drive_time_fault", [] { return drive_time_fault("null"); }},
    };
}

} // namespace tactor::test
