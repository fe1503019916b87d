// SPDX-License-Identifier: MIT
// The numbers of an actuator: the table [texture], and actuator files (ACF), which are JSON5.
#include "files/vibration_file.hpp"

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/bounds.hpp"
#include "core/kind_names.hpp"
#include "core/suggest.hpp"
#include "files/json/json_value.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {
namespace {

using files::json_value;

constexpr bounds emphasis_times_s{0.0, 1.0, true};
constexpr bounds emphasis_times_ms{0.0, 1000.0, true};

struct actuator_key {
    std::string_view name;
    bounds range;
    double actuator_numbers::*number;
};

constexpr std::array actuator_keys{
    actuator_key{"gain", bounds_of::part, &actuator_numbers::gain},
    actuator_key{"ducking", bounds_of::part, &actuator_numbers::ducking},
    actuator_key{"low_hz", bounds_of::carrier_hz, &actuator_numbers::low_hz},
    actuator_key{"high_hz", bounds_of::carrier_hz, &actuator_numbers::high_hz},
    actuator_key{"emphasis_gain", bounds_of::part, &actuator_numbers::emphasis_gain},
    actuator_key{"fade_out", bounds_of::part, &actuator_numbers::fade_out},
    actuator_key{"emphasis_low_hz", bounds_of::carrier_hz, &actuator_numbers::emphasis_low_hz},
    actuator_key{"emphasis_high_hz", bounds_of::carrier_hz, &actuator_numbers::emphasis_high_hz},
    actuator_key{"emphasis_low_s", emphasis_times_s, &actuator_numbers::emphasis_low_s},
    actuator_key{"emphasis_high_s", emphasis_times_s, &actuator_numbers::emphasis_high_s}};

struct shape_key {
    std::string_view name;
    waveform_kind actuator_numbers::*shape;
};

constexpr std::array shape_keys{shape_key{"emphasis_low_wave", &actuator_numbers::emphasis_low_wave},
                                shape_key{"emphasis_high_wave", &actuator_numbers::emphasis_high_wave}};

constexpr std::array shapes{waveform_kind::sine, waveform_kind::square, waveform_kind::triangle,
                            waveform_kind::sawtooth};

waveform_kind read_shape(const json_value& v)
{
    constexpr std::array<std::string_view, shapes.size()> names{"sine", "square", "triangle", "saw"};
    const std::string name = v.need_text();
    for (std::size_t i = 0; i < names.size(); ++i)
        if (name == names[i])
            return shapes[i];
    v.refuse(fmt::format("{} is unknown", detail::quoted(name)), choice_hint(name, names));
}

} // namespace

actuator_numbers read_actuator(std::string_view text, const std::string& name)
{
    const auto document = files::read_foreign_object(text, name, true);
    const json_value root(document, name, "give an actuator file (ACF)");
    actuator_numbers a;
    const json_value c = root["continuous"];
    const json_value e = root["emphasis"];
    a.gain = c["gain"].need_number(bounds_of::part);
    a.ducking = c["emphasis_ducking"].need_number(bounds_of::part);
    a.low_hz = c["frequency_min"].need_number(bounds_of::carrier_hz);
    a.high_hz = c["frequency_max"].need_number(bounds_of::carrier_hz);
    a.emphasis_gain = e["gain"].need_number(bounds_of::part);
    a.fade_out = e["fade_out_percent"].need_number({0.0, 100.0}) / 100.0;
    const json_value low = e["frequency_min"];
    const json_value high = e["frequency_max"];
    a.emphasis_low_hz = low["output_frequency"].need_number(bounds_of::carrier_hz);
    a.emphasis_high_hz = high["output_frequency"].need_number(bounds_of::carrier_hz);
    a.emphasis_low_s = low["duration_ms"].need_number(emphasis_times_ms) / 1e3;
    a.emphasis_high_s = high["duration_ms"].need_number(emphasis_times_ms) / 1e3;
    a.emphasis_low_wave = read_shape(low["shape"]);
    a.emphasis_high_wave = read_shape(high["shape"]);
    return a;
}

actuator_numbers read_texture(const toml_table& t, const std::filesystem::path& folder)
{
    std::vector<std::string_view> known{"acf"};
    for (const actuator_key& k : actuator_keys)
        known.push_back(k.name);
    for (const shape_key& k : shape_keys)
        known.push_back(k.name);
    t.refuse_other_keys(known);
    actuator_numbers a;
    if (const auto file = t.text("acf"))
        a = t.add_key_to_errors("acf", [&, path = folder / *file] {
            return read_actuator(read_text_file(path, max_setup_bytes), path.string());
        });
    for (const actuator_key& k : actuator_keys)
        a.*k.number = t.number(k.name, k.range).value_or(a.*k.number);
    std::vector<std::string_view> names;
    for (const waveform_kind one : shapes)
        names.push_back(to_string(one));
    for (const shape_key& k : shape_keys)
        if (const auto name = t.choice(k.name, names))
            a.*k.shape = *find_kind<waveform_kind>(*name);
    return a;
}

std::string texture_text(const actuator_numbers& a)
{
    const actuator_numbers usual;
    std::string text = "\n[texture]\n";
    for (const actuator_key& k : actuator_keys)
        if (a.*k.number != usual.*k.number)
            text += fmt::format("{} = {}\n", k.name, a.*k.number);
    for (const shape_key& k : shape_keys)
        if (a.*k.shape != usual.*k.shape)
            text += fmt::format("{} = \"{}\"\n", k.name, to_string(a.*k.shape));
    return text;
}

} // namespace tactor::detail
