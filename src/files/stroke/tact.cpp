// SPDX-License-Identifier: MIT
// Reader of bHaptics' files (.tact). They are JSON with tracks of effects for one or more places on the body.
#include <tactor/stroke.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/bounds.hpp"
#include "core/suggest.hpp"
#include "core/words.hpp"
#include "files/json/json_value.hpp"
#include "files/stroke_format.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {
namespace {

using files::json_value;

constexpr const char* tact_hint = "export the file again from the program that made it";
constexpr std::size_t most_touches = 100'000;
constexpr bounds times_ms{0.0, longest_stroke_s * 1e3};
constexpr double shortest_path_s = 0.14; // two SOAs of 70 ms each

/// Linear change of a touch's intensity during the touch. The key playbackType selects it.
enum class fading { none, in, out, in_out };

double fade_factor(fading f, double part)
{
    return f == fading::in       ? part
           : f == fading::out    ? 1.0 - part
           : f == fading::in_out ? 1.0 - std::abs(2.0 * part - 1.0)
                                 : 1.0;
}

/// Returns the touch with its intensity multiplied by the fade. If fade and intensity both change, the
/// product is a curve. Points are added until the error is at most 1/2048.
trajectory fade(const trajectory& t, const std::vector<timed_point>& own, fading f)
{
    constexpr int parts = 32;
    if (f == fading::none)
        return t;
    std::vector<double> times{0.5 * t.duration_s()};
    for (std::size_t i = 0; i < own.size(); ++i) {
        times.push_back(own[i].t_s);
        if (i > 0 && own[i].intensity != own[i - 1].intensity)
            for (int k = 1; k < parts; ++k)
                times.push_back(std::lerp(own[i - 1].t_s, own[i].t_s, static_cast<double>(k) / parts));
    }
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
    std::vector<timed_point> points;
    points.reserve(times.size());
    for (const double at : times)
        points.push_back({at, t.position(at), t.intensity(at) * fade_factor(f, at / t.duration_s())});
    return trajectory::timed(std::move(points));
}

/// Returns the rank of a place on the body. The front ranks before the back, and the left before the right.
int rank_position(std::string_view name)
{
    const auto is_side = [name](std::string_view word, char letter) {
        return name.find(word) != std::string_view::npos || name.ends_with(letter);
    };
    return name.find("Front") != std::string_view::npos  ? 0
           : name.find("Back") != std::string_view::npos ? 1
           : is_side("Left", 'L')                        ? 2
           : is_side("Right", 'R')                       ? 3
                                                         : 4;
}

class tact_reader {
public:
    explicit tact_reader(const stroke_file_text& s)
        : input_(s),
          document_(files::read_foreign_object(s.text, s.name)),
          project_(json_value(document_, s.name, tact_hint)["project"])
    {
    }

    std::vector<stroke> read()
    {
        project_.need_members();
        const std::vector<json_value> effects = list_effects();
        position_ = choose_position(effects);
        for (const json_value& e : effects)
            add_effect(e);
        if (strokes_.empty())
            throw error(error_kind::bad_input, source_place{input_.name}, "no touch in it has a duration",
                        tact_hint);
        const std::string name = stem(input_.name);
        for (std::size_t i = 0; i < strokes_.size(); ++i)
            strokes_[i].name = strokes_.size() == 1 ? name : fmt::format("{}-{}", name, i + 1);
        warn();
        return std::move(strokes_);
    }

private:
    // Returns the effects of all tracks that are enabled.
    std::vector<json_value> list_effects() const
    {
        std::vector<json_value> effects;
        for (const json_value& track : project_["tracks"].list()) {
            const json_value enable = track["enable"];
            const std::string text = to_lower_case(enable.is_text() ? *enable.text() : "");
            if (!text.empty() && text != "true" && text != "false")
                enable.refuse(fmt::format("{} is neither true nor false", detail::quoted(text)));
            if (text.empty() ? enable.exists() && !enable.need_truth() : text == "false")
                continue;
            std::vector<json_value> more = track["effects"].list();
            effects.insert(effects.end(), std::move_iterator(more.begin()), std::move_iterator(more.end()));
        }
        return effects;
    }

    // Returns the touches of the mode that `mode` selects. A file may also contain the other mode, which the
    // editor did not remove.
    static std::vector<json_value> list_touches(const json_value& m, bool& dots)
    {
        const std::string kind = m["mode"].text().value_or("");
        dots = kind == "DOT_MODE";
        if (dots || kind == "PATH_MODE")
            return m[dots ? "dotMode" : "pathMode"]["feedback"].list();
        if (!kind.empty())
            m["mode"].refuse(fmt::format("{} is unknown", detail::quoted(kind)), "use DOT_MODE or PATH_MODE");
        return {};
    }

    static bool has_touches(const json_value& mode)
    {
        bool dots = false;
        const std::vector<json_value> all = list_touches(mode, dots);
        return std::any_of(all.begin(), all.end(),
                           [](const json_value& one) { return !one["pointList"].list().empty(); });
    }

    // Returns the requested position, or the first position by rank if none is requested. The order in the
    // file has no meaning.
    std::string choose_position(const std::vector<json_value>& effects)
    {
        std::map<std::pair<int, std::string>, bool> found;
        for (const json_value& e : effects)
            for (const std::string& name : e["modes"].keys())
                if (has_touches(e["modes"][name]))
                    found[{rank_position(name), name}] = true;
        if (found.empty())
            throw error(error_kind::bad_input, source_place{input_.name}, "nothing plays in it",
                        "enable a track that has touches");
        for (const auto& [position, unused] : found)
            positions_.push_back(position.second);
        const std::string wanted(input_.position.empty() ? positions_.front() : input_.position);
        const auto at = std::find(positions_.begin(), positions_.end(), wanted);
        if (at == positions_.end()) {
            const std::vector<std::string_view> known(positions_.begin(), positions_.end());
            throw bad_position(fmt::format("nothing plays at {} in {}", detail::quoted(wanted), input_.name),
                               choice_hint(wanted, known));
        }
        positions_.erase(at);
        return wanted;
    }

    void add_effect(const json_value& effect)
    {
        const json_value mode = effect["modes"][position_];
        if (!mode.exists())
            return;
        const double start_s = time_s(effect["startTime"]);
        bool dots = false;
        for (const json_value& touch : list_touches(mode, dots))
            if (dots)
                add_dots(touch, start_s);
            else
                add_path(touch, start_s, time_s(effect["offsetTime"])); // the effect's duration
    }

    void add_dots(const json_value& touch, double start_s)
    {
        const double from_s = time_s(touch["startTime"]);
        const double to_s = time_s(touch["endTime"]);
        for (const json_value& p : touch["pointList"].list()) {
            const double index = p["index"].need_number({0.0, 1e6}, true);
            const auto at = layout().find(index);
            if (at == layout().end())
                p["index"].refuse(
                    fmt::format("{} is not an index in project.layout.layouts.{}", index, position_));
            add(start_s + from_s, to_s - from_s, {{0.0, at->second, intensity(p)}}, read_fading(touch));
        }
    }

    void add_path(const json_value& touch, double start_s, double effect_s)
    {
        std::vector<timed_point> points;
        for (const json_value& p : touch["pointList"].list()) {
            const timed_point next{time_s(p["time"]), place(p), intensity(p)};
            if (!points.empty() && next.t_s < points.back().t_s)
                p["time"].refuse("it is before that of the previous point", "put times in ascending order");
            if (!points.empty() && next.t_s == points.back().t_s)
                points.back() = next; // if times are equal, the last point counts
            else
                points.push_back(next);
        }
        if (points.empty())
            return;
        const double first_s = points.front().t_s;
        for (timed_point& p : points)
            p.t_s -= first_s;
        const double last_s = points.size() == 1 ? effect_s : points.back().t_s;
        if (points.size() > 1 && last_s < shortest_path_s - same_time_s)
            ++short_paths_;
        add(start_s + first_s, last_s, std::move(points), read_fading(touch));
    }

    // Adds a touch. A touch with a single point lasts `duration_s`. Without a duration it is not played.
    void add(double start_s, double duration_s, std::vector<timed_point> points, fading f)
    {
        if (!(duration_s > 0.0))
            return;
        if (strokes_.size() == most_touches)
            throw error(error_kind::bad_input, source_place{input_.name},
                        fmt::format("it has more than {} touches", most_touches), "split the file");
        if (points.size() == 1)
            points.push_back({duration_s, points.front().position, points.front().intensity});
        strokes_.push_back({.motion = fade(trajectory::timed(points), points, f),
                            .start_s = start_s,
                            .fit = stroke_fit{.unit_square = true}});
    }

    static fading read_fading(const json_value& touch)
    {
        constexpr std::array<std::string_view, 4> names{"NONE", "FADE_IN", "FADE_OUT", "FADE_IN_OUT"};
        const json_value type = touch["playbackType"];
        const std::string name = type.text().value_or("NONE");
        const auto* const at = std::find(names.begin(), names.end(), name);
        if (at == names.end())
            type.refuse(fmt::format("{} is unknown", detail::quoted(name)), choice_hint(name, names));
        return static_cast<fading>(at - names.begin());
    }

    // Returns the places of the position's tactors. The key is a tactor's index.
    const std::map<double, point>& layout()
    {
        if (!layout_) {
            layout_.emplace();
            for (const json_value& t : project_["layout"]["layouts"][position_].list())
                (*layout_)[t["index"].need_number({0.0, 1e6}, true)] = place(t);
        }
        return *layout_;
    }

    static double time_s(const json_value& v)
    {
        return v.exists() ? v.need_number(times_ms, true) / 1e3 : 0.0;
    }

    double intensity(const json_value& p) const
    {
        const json_value v = p["intensity"];
        const double x = v.exists() ? v.need_number({0.0, max_mm}, true) : input_.intensity_max;
        if (x > input_.intensity_max)
            v.refuse(fmt::format("{} is above {:g}, the requested level", x, input_.intensity_max),
                     "name the value that means 1: {intensity_max=100} for per cent");
        return x / input_.intensity_max;
    }

    // Returns a place in the unit square or outside. Restores thirds, which editors round to three digits.
    static point place(const json_value& p)
    {
        const auto coordinate = [&p](const char* name) {
            constexpr double rounding = 1e-3 + 1e-9;
            const double v = p[name].need_number({-max_mm, max_mm}, true);
            return std::abs(v - 0.333) <= rounding   ? 1.0 / 3.0
                   : std::abs(v - 0.667) <= rounding ? 2.0 / 3.0
                                                     : v;
        };
        return {coordinate("x"), coordinate("y")};
    }

    static error bad_position(std::string_view why, std::string_view hint)
    {
        return error(error_kind::bad_input, "position", why, hint).with_field("position");
    }

    void warn()
    {
        std::vector<std::string>& warnings = strokes_.front().warnings;
        if (input_.position.empty() && !positions_.empty())
            warnings.push_back(fmt::format("{}: only {} plays; the option position chooses {}", input_.name,
                                           position_, fmt::join(positions_, " or ")));
        if (short_paths_ != 0)
            warnings.push_back(
                fmt::format("{}: {} shorter than 140 ms, of which park2016 makes two bursts", input_.name,
                            short_paths_ == 1 ? "1 path is" : fmt::format("{} paths are", short_paths_)));
    }

    const stroke_file_text& input_;
    nlohmann::ordered_json document_;
    json_value project_;
    std::string position_;
    std::vector<std::string> positions_; ///< other positions that have touches, by rank
    std::optional<std::map<double, point>> layout_;
    std::vector<stroke> strokes_;
    std::size_t short_paths_ = 0;
};

constexpr std::string_view tact_extensions[] = {".tact"};

} // namespace

extern const stroke_format tact_strokes{
    .name = "tact",
    .title = "TACT",
    .extensions = tact_extensions,
    .media_type = "application/json",
    .begins =
        [](std::string_view text) {
            return find_text_form(text) == text_form::json &&
                   text.find("\"tracks\"") != std::string_view::npos;
        },
    .parse = [](const stroke_file_text& s) { return tact_reader(s).read(); },
    .has_positions = true,
    .most_bytes = max_foreign_bytes,
};

} // namespace tactor::detail
