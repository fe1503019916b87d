// Preset strokes. Four are the target motions of Park et al. 2016 on the paper's array, palm-3x3. They agree
// with the paper's text, which does not contain the figure that shows the motions. Two are for palm-2x4,
// which is too low for the paper's circles.
#include <tactor/array.hpp>
#include <tactor/stroke.hpp>

#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/error.hpp>

#include "core/refused.hpp"
#include "core/suggest.hpp"

namespace tactor {
inline namespace v0 {
namespace {

// y points down. From -90 degrees (above the centre), a negative sweep turns to the left.
struct motion {
    std::string_view name;
    point centre;
    double from_deg;
    double sweep_deg;
};

constexpr double radius_mm = 16.0;
constexpr double quarter_turn_s = 0.7;

constexpr std::array motions{
    motion{"park2016-1", {20.0, 20.0}, -90.0, -180.0},
    motion{"park2016-2", {0.0, 20.0}, -90.0, 180.0},
    motion{"park2016-3", {20.0, 20.0}, 90.0, 270.0},
    motion{"park2016-4", {20.0, 20.0}, 0.0, -270.0},
};

struct drawing {
    std::string_view name;
    std::string_view path;
    double duration_s = 0.0; // 0 means at the usual speed
};

// Strokes within 60 mm by 20 mm, whose durations are whole numbers of bursts of 0.07 s.
constexpr std::array drawings{
    drawing{"wave-2x4", "M 0 10 C 5 -2 15 -2 20 10 S 35 22 40 10 S 55 -2 60 10", 2.1},
    drawing{"round-2x4", "M 58 10 A 28 8 0 0 1 2 10 A 28 8 0 0 1 58 10", 2.8},
};

// Shapes for first steps on any array. They are fitted to the array. y points down, so they begin clockwise.
constexpr std::array shapes{
    drawing{"tap", "M 0 0", 0.3},
    drawing{"line", "M 0 0 H 100"},
    drawing{"circle", "M 50 0 A 50 50 0 0 1 50 100 A 50 50 0 0 1 50 0"},
    drawing{"eight",
            "M 50 25 A 25 25 0 0 1 100 25 A 25 25 0 0 1 50 25 A 25 25 0 0 0 0 25 A 25 25 0 0 0 50 25"},
    drawing{"spiral", "M 0 0 A 5 5 0 0 1 10 0 A 10 10 0 0 1 -10 0 A 15 15 0 0 1 20 0 A 20 20 0 0 1 -20 0"},
};

struct preset {
    std::string_view name;
    unsigned rows;
    unsigned columns;
    double pitch_mm;
    unsigned first_channel = 0;
};

constexpr preset presets[] = {
    {"palm-3x3", 3, 3, 20.0},      // Park et al. 2016, section 3
    {"palm-2x4", 2, 4, 20.0},      // as many tactors as an eight-channel card has channels
    {"dualsense", 1, 2, 100.0, 2}, // the grips of a Sony DualSense; channels 0 and 1 are its loudspeaker
    {"usb-7.1", 2, 4, 20.0},       // a USB card with the channels FL FR FC LFE RL RR SL SR
};

template <class... Lists>
std::vector<std::string> collect_names(const Lists&... lists)
{
    std::vector<std::string> all;
    const auto add = [&all](const auto& list) {
        for (const auto& entry : list)
            all.emplace_back(entry.name);
    };
    (add(lists), ...);
    return all;
}

} // namespace

const std::vector<std::string>& stroke_presets()
{
    static const std::vector<std::string> names = collect_names(motions, drawings);
    return names;
}

stroke preset_stroke(std::string_view name)
{
    for (const motion& m : motions)
        if (m.name == name)
            return {.name = std::string(name),
                    .motion = trajectory::along(path::arc(m.centre, radius_mm, m.from_deg, m.sweep_deg),
                                                std::abs(m.sweep_deg) / 90.0 * quarter_turn_s),
                    .note = note_kind::reconstructed,
                    .made_for = "palm-3x3"};
    for (const drawing& d : drawings)
        if (d.name == name)
            return {.name = std::string(name),
                    .motion = trajectory::along(path::from_svg(d.path), d.duration_s),
                    .made_for = "palm-2x4"};
    throw error(error_kind::bad_input, "stroke", fmt::format("there is no preset {}", detail::quoted(name)),
                detail::preset_hint(name, stroke_presets()));
}

const std::vector<std::string>& stroke_shapes()
{
    static const std::vector<std::string> names = collect_names(shapes);
    return names;
}

stroke shape_stroke(std::string_view name)
{
    for (const drawing& d : shapes) {
        if (d.name != name)
            continue;
        const path p = path::from_svg(d.path);
        const bool has_time = d.duration_s > 0.0;
        return {.name = std::string(name),
                .motion = trajectory::along(p, has_time ? d.duration_s : p.length_mm() / default_speed_mm_s),
                .speed_mm_s = has_time ? std::nullopt : std::optional(default_speed_mm_s),
                .fit = stroke_fit{}};
    }
    throw detail::bad_field("shape", fmt::format("{} is unknown", detail::quoted(name)),
                            fmt::format("use one of {}", fmt::join(stroke_shapes(), ", ")));
}

const std::vector<std::string>& array_presets()
{
    static const std::vector<std::string> names = collect_names(presets);
    return names;
}

array preset_array(std::string_view name)
{
    for (const preset& p : presets)
        if (p.name == name) {
            array a = make_grid(std::string(name), p.rows, p.columns, p.pitch_mm, p.pitch_mm);
            for (tactor_spec& t : a.tactors)
                t.channel += p.first_channel;
            return a;
        }
    throw error(error_kind::bad_input, "array", fmt::format("there is no preset {}", detail::quoted(name)),
                detail::preset_hint(name, array_presets()));
}

} // namespace v0
} // namespace tactor
