// SPDX-License-Identifier: MIT
// Calls that throw: files read and written, and texts as files hold them.
#include <memory>
#include <string>

#include <fcntl.h>

#include <tactor/config.hpp>
#include <tactor/render.hpp>
#include <tactor/setup.hpp>
#include <tactor/stroke.hpp>
#include <tactor/waveform.hpp>

#include "core/owned.hpp"
#include "exhaustion_calls.hpp"

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
    plan short_burst{.stroke_duration_s = 0.01, .total_s = 0.01};
    short_burst.bursts.push_back({.duration_s = 0.01, .drives = {{.tactor = 0, .amplitude = 1.0}}});
    write_wav(score(make_grid("one", 1, 1, 20.0, 20.0), short_burst), format_kind::s16, wave_file);
    const auto from = std::make_shared<detail::owned_fd>();
    const score sound(t.a, t.p);
    return {
        {"stroke_presets", [] { return stroke_presets().size(); }},
        {"preset_stroke", [] { return preset_stroke("park2016-4"); }},
        {"preset_stroke, unknown", [] { return preset_stroke("park2016-5"); }},
        {"stroke_shapes", [] { return stroke_shapes().size(); }},
        {"shape_stroke", [] { return shape_stroke("spiral"); }},
        {"shape_stroke, unknown", [] { return shape_stroke("square"); }},
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

} // namespace tactor::test
