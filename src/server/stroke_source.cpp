// SPDX-License-Identifier: MIT
#include "server/stroke_source.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include <tactor/phantom.hpp>

#include "core/start_times.hpp"
#include "core/trajectory/recorded_points.hpp"
#include "core/words.hpp"
#include "server/faults.hpp"

namespace tactor::server {
namespace {

using net::json;

constexpr double rounding_db = 1e-9;
constexpr double most_excess_db = 100.0; // above it lies no sum of strokes that is planned
constexpr double least_excess_db = 0.01;
constexpr double most_bursts = 250'000.0;

timed_point read_point(const json& p, std::size_t i, double intensity_max)
{
    const auto what = [&] { return fmt::format("point {}", i + 1); };
    if (!p.is_array() || p.size() < 3 || p.size() > 4)
        bad_param("points", what() + " is not [t, x, y] or [t, x, y, intensity]");
    for (std::size_t k = 0; k < p.size(); ++k)
        if (!p[k].is_number() && (k == 0 || !p[k].is_null()))
            bad_param("points", what() + " has something that is no number");
    // JSON has null for nan.
    const auto value = [&p](std::size_t k) {
        return p[k].is_null() ? std::numeric_limits<double>::quiet_NaN() : p[k].get<double>();
    };
    return {value(0), {value(1), value(2)}, p.size() == 4 ? value(3) : intensity_max};
}

std::vector<stroke> read_points(const json& list, double intensity_max)
{
    if (list.is_binary())
        return read_points(json::from_msgpack(list.get_binary()), intensity_max);
    if (!list.is_array())
        bad_param("points", "they are no list", "[[t,x,y], ...]");
    detail::recorded_points recorded(intensity_max);
    recorded.reserve(list.size());
    for (std::size_t i = 0; i < list.size(); ++i)
        recorded.add(read_point(list[i], i, intensity_max));
    const trajectory motion = trajectory::timed(recorded.take());
    return {stroke{.name = "points", .motion = motion, .warnings = recorded.warnings()}};
}

void check_duration(const planning& with, double seconds)
{
    if (seconds > with.max_stroke_s)
        limit_reached("max_stroke_s",
                      fmt::format("it lasts {}, and a stroke at most {}", seconds_text(seconds),
                                  seconds_text(with.max_stroke_s)),
                      "draw less, or faster");
}

void check_count(const planning& with, std::size_t strokes)
{
    if (strokes > with.max_strokes)
        limit_reached("max_strokes",
                      fmt::format("{} strokes are more than the {} that a client may have at once", strokes,
                                  with.max_strokes),
                      "send fewer");
}

// Refuses strokes that last too long, alone or together: planning them takes as long.
void check_durations(const planning& with, const std::vector<stroke>& strokes)
{
    detail::start_times times;
    double together_s = 0.0;
    for (const stroke& k : strokes) {
        times.start(k.start_s, k.anchor);
        check_duration(with, times.lasts(k.motion.duration_s()));
        together_s += k.motion.duration_s();
    }
    if (together_s > with.max_stroke_s)
        limit_reached("max_stroke_s",
                      fmt::format("its strokes last {} together, and those of one request at most {}",
                                  seconds_text(together_s), seconds_text(with.max_stroke_s)),
                      "send them one by one");
}

// Returns the largest intensity, or amplitude, at the times that the plan samples.
double loudest(const stroke& k, const plan& p, intensity_scale scale)
{
    double most = 0.0;
    for (const burst& b : p.bursts)
        most = std::max(most, b.intensity);
    if (!p.curve)
        return most;
    for (std::uint64_t i = 0; i < p.curve->size(); ++i)
        most = std::max(most, k.motion.intensity(p.curve->time_s(i)));
    scale.level_db += k.choices.level_db;
    return scale.amplitude(most);
}

// Returns the bursts by park2016, before they are planned: a short SOA makes very many. None for an SOA that
// the planner refuses.
double park_bursts(const stroke& k, const plan_options& o)
{
    if (k.choices.algorithm.value_or(o.algorithm) != algorithm_kind::park2016)
        return 0.0;
    const double soa_s = k.choices.soa_s.value_or(o.soa_s);
    const bool is_free = k.choices.burst_s || o.burst_s;
    const bool is_possible =
        is_free ? soa_s >= detail::bounds_of::burst_s.low : soa_s > o.profile.intercept_s;
    return is_possible ? 1.0 + k.motion.duration_s() / soa_s : 0.0;
}

} // namespace

void pack_points(json& params)
{
    if (const auto points = params.find("points"); points != params.end() && points->is_array())
        *points = json::binary(json::to_msgpack(*points));
}

std::vector<stroke> read_strokes(const std::string& source, const json& v, const options::wishes& s)
{
    if (source == "points")
        return read_points(v, s.intensity_max.value_or(1.0));
    return session::read_strokes(source, text(v, source), source, s);
}

std::vector<stroke> settle_strokes(const planning& with, const layout& faces, std::vector<stroke> strokes,
                                   options::wishes s, bool fit)
{
    check_count(with, strokes.size());
    s.fit = fit;
    session::piece p{.strokes = std::move(strokes)};
    session::place_strokes(p, faces, s);
    check_durations(with, p.strokes);
    return std::move(p.strokes);
}

std::vector<double> path_starts_s(const std::vector<stroke>& strokes)
{
    detail::start_times times;
    for (const stroke& k : strokes) {
        times.start(k.start_s, k.anchor);
        times.lasts(k.motion.duration_s());
    }
    return std::move(times).all();
}

bool counts_from_group(const stroke& k) noexcept
{
    return k.anchor.back != 1;
}

void count_from_piece(std::vector<stroke>& strokes, const std::vector<double>& starts_s)
{
    for (std::size_t i = 0; i < strokes.size(); ++i)
        if (counts_from_group(strokes[i])) {
            strokes[i].start_s = starts_s[i];
            strokes[i].anchor = {};
        }
}

const char* find_source(const json& params)
{
    const char* found = find_one(params, {"stroke", "path", "points", "toml", "csv", "svg"});
    if (found == nullptr)
        bad_param("stroke", "nothing says what to draw", "one of stroke, path, points, toml, csv, svg");
    return found;
}

namespace {

// Returns the highest level of any tactor.
double highest_level(const planning& with, const options::wishes& s, double carrier_hz)
{
    if (!s.render.sl_db)
        return s.render.level_dbfs;
    double level = -1e9; // where none was measured, which is refused elsewhere
    for (const tactor_spec& t : with.tactors.tactors)
        level = std::max(level, threshold_at(t, carrier_hz).value_or(-1e9) + *s.render.sl_db);
    return level;
}

// Returns how much weaker plans must be so that they can be played, dB; 0: not at all. \throws error for what
// no level mends.
double find_excess_db(const planning& with, const planned& p)
{
    const auto try_to_play = [&](double weaker_db) {
        render_options weaker = p.render;
        (weaker.sl_db ? *weaker.sl_db : weaker.level_dbfs) -= weaker_db;
        static_cast<void>(score(with.tactors, p.plans, weaker));
    };
    const auto can_play = [&](double weaker_db) {
        try {
            try_to_play(weaker_db);
            return true;
        } catch (const error&) {
            return false;
        }
    };
    if (can_play(0.0))
        return 0.0;
    if (!can_play(most_excess_db))
        try_to_play(0.0); // throws
    double low = 0.0;
    double high = most_excess_db;
    while (high - low > least_excess_db) {
        const double middle = (low + high) / 2.0;
        (can_play(middle) ? high : low) = middle;
    }
    return high;
}

} // namespace

void check_level(const planning& with, const options::wishes& s, double intensity, double carrier_hz,
                 const std::string& source)
{
    if (intensity <= 0.0)
        return;
    const double over_db = 20.0 * std::log10(intensity);
    const double level = highest_level(with, s, carrier_hz);
    if (level + over_db <= with.max_level_dbfs + rounding_db)
        return;
    const char* const option = s.render.sl_db ? "options.sl" : "options.level_dbfs";
    bad_param(over_db > 0.0 && level <= with.max_level_dbfs + rounding_db ? source : option,
              fmt::format("{} dBFS{} is more than {} dBFS, which the owner allows", plain_number(level, 4),
                          over_db == 0.0 ? "" : fmt::format(" and intensity {}", plain_number(intensity, 4)),
                          plain_number(with.max_level_dbfs, 4)),
              "ask for less");
}

void check_bursts(double bursts, const char* hint)
{
    if (bursts > most_bursts)
        limit_reached("bursts",
                      fmt::format("its {:.0f} bursts are more than the {:.0f} that are planned at once",
                                  bursts, most_bursts),
                      hint);
}

std::vector<std::string> planned::warnings() const
{
    std::vector<std::string> all;
    for (const placed_plan& p : plans)
        all.insert(all.end(), p.plan.warnings.begin(), p.plan.warnings.end());
    return all;
}

double planned::count_bursts() const
{
    std::size_t n = 0;
    for (const placed_plan& p : plans)
        n += std::max<std::size_t>(1, p.plan.bursts.size());
    return static_cast<double>(n);
}

score planned::make_score(const array& a, std::size_t i) const
{
    score_builder made(a, render);
    const double round_s = total_s();
    for (std::uint64_t k = 0; k < rounds; ++k)
        made.add(plans[i].plan, static_cast<double>(k) * round_s);
    return made.take();
}

void plan_strokes(const planning& with, const layout& faces, planned& p, const options::wishes& s,
                  const std::string& source, const go_on_check& go_on, bool picture)
{
    double bursts = 0.0;
    for (const stroke& k : p.strokes)
        bursts += park_bursts(k, s.plan);
    check_bursts(bursts, "make it shorter, or the SOA longer");
    for (std::size_t i = 0; i < p.strokes.size(); ++i) {
        go_on();
        session::plan_stroke(p, i, with.tactors, faces, s);
        const plan& made = p.plans.back().plan;
        const double intensity = loudest(p.strokes[i], made, s.plan.scale);
        if (!picture)
            check_level(with, s, intensity, made.carrier_hz, source);
        else if (intensity > 0.0)
            p.over_db = std::max(p.over_db, highest_level(with, s, made.carrier_hz) +
                                                20.0 * std::log10(intensity) - with.max_level_dbfs);
    }
    check_duration(with, p.total_s());
    go_on();
    if (picture)
        p.over_db = std::max(p.over_db, find_excess_db(with, p));
    else
        static_cast<void>(score(with.tactors, p.plans, p.render)); // levels and carriers
}

planned make_planned(const planning& with, const layout& faces, const json& params, const go_on_check& go_on)
{
    const std::string source = find_source(params);
    const options::wishes s = settle_options(with.owner, params);
    try {
        planned p{{source, read_strokes(source, params[source], s)}, s.render};
        p.observer = {s.observer, s.low_speed};
        if (source == "stroke")
            p.name = p.strokes.front().name;
        p.strokes = settle_strokes(with, faces, std::move(p.strokes), s, false);
        plan_strokes(with, faces, p, s, source, go_on, read_view(params).kind != view_kind::full);
        return p;
    } catch (...) {
        throw fault_error(current_fault(source));
    }
}

planned make_drive(const planning& with, const json& params)
{
    allow_only(params, {"tactor", "intensity", "duration_s", "start"});
    const auto count = static_cast<double>(with.tactors.tactors.size());
    const double tactor = need_number(params, "tactor", {0, count - 1});
    if (tactor != std::floor(tactor))
        bad_param("tactor", fmt::format("{} is no whole number", tactor), "they count from 0");
    const json* given = member(params, "intensity");
    const double intensity = given == nullptr ? 1.0 : number(*given, "intensity", detail::bounds_of::part);
    given = member(params, "duration_s");
    constexpr double usual_s = 0.5;
    const double seconds =
        given == nullptr ? usual_s : number(*given, "duration_s", detail::bounds_of::duration_s);
    check_duration(with, seconds);
    check_level(with, with.owner, intensity, with.owner.plan.carrier_hz, "intensity");
    planned p{{"drive"}, with.owner.render};
    const point where = with.tactors.tactors[static_cast<std::size_t>(tactor)].position;
    plan one{.algorithm = "drive", .phantom = "none"};
    one.stroke_duration_s = seconds;
    one.total_s = seconds;
    one.carrier_hz = with.owner.plan.carrier_hz;
    burst b{.duration_s = seconds, .position = where, .intensity = intensity};
    if (intensity > 0.0)
        b.drives.push_back({static_cast<unsigned>(tactor), intensity});
    one.bursts.push_back(std::move(b));
    p.plans.push_back({std::move(one), {}});
    try {
        static_cast<void>(p.make_score(with.tactors, 0));
    } catch (...) {
        throw fault_error(current_fault("tactor"));
    }
    return p;
}

} // namespace tactor::server
