// SPDX-License-Identifier: MIT
#include "files/stroke/parts.hpp"

#include <vector>

#include <fmt/format.h>

#include "core/limits.hpp"
#include "core/pace.hpp"

namespace tactor::detail {
namespace {

constexpr bounds a_part{0.0, 1.0};
constexpr std::size_t most_profile_points = 1'000'000;

/// The numbers of an entry of a list whose first is a part of the path, which ascends.
class part_list {
public:
    part_list(const toml_table& t, std::string_view key, std::string_view shape)
        : table_(t), key_(key), list_(*t.list(key, shape)), shape_(shape)
    {
        if (list_.empty())
            t.fail(key, fmt::format("{} is an empty list", key), fmt::format("give {}", shape));
        if (list_.size() > most_profile_points)
            t.fail(key, fmt::format("{} has {} entries", key, list_.size()),
                   fmt::format("at most {}", most_profile_points));
    }

    /// Calls take(part, entry) for each.
    template <class Take>
    void each(std::size_t least, std::size_t most, Take take)
    {
        double before = -1.0;
        for (const toml::node& node : list_) {
            const toml::array* entry = node.as_array();
            if (!entry || entry->size() < least || entry->size() > most)
                fail_at(table_.where(node), fmt::format("an entry of {} is {}", key_, shown(node)),
                        fmt::format("give {}", shape_));
            const double part = table_.to_number((*entry)[0], "the part of the path", a_part);
            if (!(part > before))
                fail_at(table_.where(node),
                        fmt::format("the part {} of {} does not come after {}", part, key_, before),
                        "parts ascend from 0, the path's start, to 1, its end");
            before = part;
            take(part, *entry);
        }
    }

private:
    const toml_table& table_;
    std::string_view key_;
    const toml::array& list_;
    std::string_view shape_;
};

std::vector<profile_point> read_profile(const toml_table& t, std::string_view key, bounds values)
{
    std::vector<profile_point> points;
    part_list(t, key, "[[part, value], ...]").each(2, 2, [&](double part, const toml::array& entry) {
        points.push_back({part, t.to_number(entry[1], key, values)});
    });
    return points;
}

std::vector<rest> read_pauses(const toml_table& t)
{
    std::vector<rest> rests;
    part_list(t, "pauses", "[[part, seconds], ...] or [[part, seconds, intensity], ...]")
        .each(2, 3, [&](double part, const toml::array& entry) {
            const double time = t.to_number(entry[1], "a pause", {0.0, longest_stroke_s, true});
            const double intensity =
                entry.size() == 3 ? t.to_number(entry[2], "the intensity of a pause", {0.0, 1.0}) : 1.0;
            rests.push_back({part, time, intensity});
        });
    return rests;
}

bool is_list(const toml_table& t, std::string_view key)
{
    return t.has(key) && t.node(key)->is_array();
}

} // namespace

told_pace read_pace(const toml_table& t)
{
    told_pace p;
    const auto uneven = [&](std::string_view key) { p.key = p.key.empty() ? key : p.key; };
    p.duration_s = t.number("duration_s", {0.0, longest_stroke_s, true});
    if (const auto easing = t.kind<easing_kind>("easing")) {
        p.moves.easing = *easing;
        uneven("easing");
    }
    if (is_list(t, "speed_mm_s")) {
        p.moves.speed_mm_s = read_profile(t, "speed_mm_s", {least_speed_mm_s, max_mm});
        uneven("speed_mm_s");
    } else {
        p.speed_mm_s = t.number("speed_mm_s", {0.0, max_mm, true});
    }
    if (is_list(t, "intensity")) {
        p.moves.intensity = read_profile(t, "intensity", {0.0, 1.0});
        uneven("intensity");
    } else {
        p.intensity = t.number("intensity", {0.0, 1.0}).value_or(1.0);
    }
    if (t.has("pauses")) {
        p.moves.rests = read_pauses(t);
        uneven("pauses");
    }
    if (p.duration_s && t.has("speed_mm_s"))
        t.fail("speed_mm_s", fmt::format("{} has both duration_s and speed_mm_s", t.title()),
               "keep one of them");
    return p;
}

trajectory along_as_told(const toml_table& t, std::string_view kind, const path& way, const told_pace& told,
                         std::optional<double> own_s)
{
    const bool speeds = !told.moves.speed_mm_s.empty();
    std::optional<double> seconds = told.time_for(way.length_mm());
    std::string_view key = told.speed_mm_s || speeds ? "speed_mm_s" : told.duration_s ? "duration_s" : kind;
    if (!seconds && !speeds)
        seconds = own_s.value_or(way.length_mm() / default_speed_mm_s);
    movement m = told.moves;
    m.duration_s = seconds;
    // A speed, and a preset's own time, are of the movement: pauses come on top.
    if (seconds && !told.duration_s)
        for (const rest& r : m.rests)
            *m.duration_s += r.time_s;
    if (!m.rests.empty())
        key = "pauses";
    return t.at_key(key, [&] {
        return told.key.empty() ? trajectory::along(way, *seconds, told.intensity)
                                : trajectory::along(way, m, told.intensity);
    });
}

std::optional<double> kept_speed(const told_pace& told, double length_mm)
{
    if (!told.moves.speed_mm_s.empty())
        return length_mm / time_at_speeds_s(told.moves, length_mm);
    return told.speed_mm_s;
}

} // namespace tactor::detail
