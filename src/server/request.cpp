// SPDX-License-Identifier: MIT
#include "server/request.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "core/start_times.hpp"
#include "core/suggest.hpp"
#include "core/words.hpp"
#include "options/option.hpp"
#include "options/resolve.hpp"
#include "rt/clock.hpp"
#include "server/faults.hpp"
#include "server/params.hpp"
#include "server/view.hpp"
#include "synth/score/levels.hpp"

namespace tactor::server {
namespace {

using net::json;
using net::reply_json;
using options::option;

constexpr double rounding_db = 1e-9;
constexpr double most_bursts = 250'000.0;

options::value plain_value(const json& v)
{
    if (v.is_boolean())
        return v.get<bool>();
    if (v.is_number())
        return v.get<double>();
    if (v.is_string())
        return v.get<std::string>();
    return {};
}

const option& find_client_option(const std::string& name, options_for which)
{
    const option* o = options::find(name);
    if (o == nullptr || o->name != name || (o->where & options::by_client) == 0) {
        std::vector<std::string_view> names;
        for (const option& x : options::all())
            if ((x.where & options::by_client) != 0)
                names.push_back(x.name);
        refuse_param("options." + name, "it is not an option", detail::choice_hint(name, names));
    }
    if (which == options_for::live && (o->where & options::live) == 0)
        refuse_param("options." + name,
                     "it does not apply to live strokes, whose points have their own times",
                     "leave out options." + name);
    return *o;
}

// Refuses a waveform from a file, because clients must not open files of the server.
void refuse_file(const option& o, const options::value& v)
{
    const auto* text = std::get_if<std::string>(&v);
    if (o.name == "waveform" && text != nullptr && waveform_names_file(*text))
        refuse_param("options.waveform", "clients must not open files on the server",
                     "use sine, square, triangle, sawtooth or noise:LO-HI");
}

reply_json value_json(const option& o, const options::value& v)
{
    if (const auto* x = std::get_if<double>(&v); x != nullptr && o.what == options::kind::whole)
        return static_cast<std::int64_t>(*x);
    return std::visit(
        []<class T>(const T& x) -> reply_json {
            if constexpr (std::is_same_v<T, std::monostate>)
                return nullptr;
            else
                return x;
        },
        v);
}

reply_json row_json(const option& o, const options::option_values& owner)
{
    const bool is_number = o.what == options::kind::number || o.what == options::kind::whole;
    const bool has_bounds = is_number && o.range.empty(); // if not, bounds depend on other values
    const auto bound = [&](double x) { return has_bounds ? value_json(o, x) : reply_json(nullptr); };
    const bool in_file = (o.where & options::in_stroke) != 0;
    reply_json choices = reply_json::array();
    if (o.choices != nullptr)
        choices = o.choices();
    return {{"name", o.name},
            {"key", in_file ? reply_json(o.field_name()) : reply_json(nullptr)},
            {"group", o.in},
            {"kind", options::kind_names.at(static_cast<std::size_t>(o.what))},
            {"unit", o.unit},
            {"least", bound(o.allowed.low)},
            {"most", bound(o.allowed.high)},
            {"choices", choices},
            {"default", value_json(o, o.to.get(owner))},
            {"help", spell_for_protocol(o.help)},
            {"live", (o.where & options::live) != 0}};
}

timed_point read_point(const json& p, std::size_t i, double intensity_max)
{
    const auto what = [&] { return fmt::format("point {}", i + 1); };
    if (!p.is_array() || p.size() < 3 || p.size() > 4)
        refuse_param("points", what() + " is not [t, x, y] or [t, x, y, intensity]");
    for (std::size_t k = 0; k < p.size(); ++k)
        if (!p[k].is_number() && (k == 0 || !p[k].is_null()))
            refuse_param("points", what() + " has a value that is not a number");
    // null stands for nan, which JSON does not have.
    const auto value = [&p](std::size_t k) {
        return p[k].is_null() ? std::numeric_limits<double>::quiet_NaN() : p[k].get<double>();
    };
    return {value(0), {value(1), value(2)}, p.size() == 4 ? value(3) : intensity_max};
}

std::vector<timed_point> read_points(const json& list, double intensity_max)
{
    if (list.is_binary())
        return read_points(json::from_msgpack(list.get_binary()), intensity_max);
    if (!list.is_array())
        refuse_param("points", "they are not a list", "[[t,x,y], ...]");
    std::vector<timed_point> points;
    points.reserve(list.size());
    for (std::size_t i = 0; i < list.size(); ++i)
        points.push_back(read_point(list[i], i, intensity_max));
    return points;
}

void check_duration(const planning& with, double seconds)
{
    if (seconds > with.max_stroke_s)
        refuse_over_limit("max_stroke_s",
                          fmt::format("it lasts {}, but a stroke may last at most {}", seconds_text(seconds),
                                      seconds_text(with.max_stroke_s)),
                          "draw less, or faster");
}

// Refuses strokes if one of them, or all together, last too long. The time for planning is proportional to
// their duration.
void check_durations(const planning& with, const std::vector<stroke>& strokes)
{
    detail::start_times times;
    double together_s = 0.0;
    for (const stroke& k : strokes) {
        times.start(k.start_s, k.anchor);
        check_duration(with, times.set_duration(k.motion.duration_s()));
        together_s += k.motion.duration_s();
    }
    if (together_s > with.max_stroke_s)
        refuse_over_limit(
            "max_stroke_s",
            fmt::format("its strokes last {} together, but those of one request may last at most {}",
                        seconds_text(together_s), seconds_text(with.max_stroke_s)),
            "send them one by one");
}

// Returns the greatest intensity or amplitude at the times that the plan samples.
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

// Returns the number of bursts of algorithm park2016. It is computed before planning, because a short SOA
// gives very many bursts. Returns 0 for an SOA that the planner refuses.
double count_park_bursts(const stroke& k, const plan_options& o)
{
    if (k.choices.algorithm.value_or(o.algorithm) != algorithm_kind::park2016)
        return 0.0;
    const double soa_s = k.choices.soa_s.value_or(o.soa_s);
    const bool is_free = k.choices.burst_s || o.burst_s;
    const bool is_possible =
        is_free ? soa_s >= detail::bounds_of::burst_s.low : soa_s > o.profile.intercept_s;
    return is_possible ? 1.0 + k.motion.duration_s() / soa_s : 0.0;
}

// Returns the greatest level of all tactors.
double highest_level(const planning& with, const options::option_values& s, double carrier_hz)
{
    if (!s.render.sl_db)
        return s.render.level_dbfs;
    double level = -1e9; // for tactors without a threshold, which another check refuses
    for (const tactor_spec& t : with.tactors.tactors)
        level = std::max(level, threshold_at(t, carrier_hz).value_or(-1e9) + *s.render.sl_db);
    return level;
}

// Returns the attenuation that makes the plans playable, dB, or 0 if they are playable. Sets p.weakened to
// the weakening of the score at the attenuated level.
// \throws error if no level makes them playable.
double find_excess_db(const planning& with, planned& p)
{
    render_options weaker = p.render;
    for (double excess_db = 0.0;;)
        try {
            p.weakened = session::make_score(p, with.tactors, weaker).weakened();
            return excess_db;
        } catch (const synth::level_error& e) {
            excess_db += e.over_db;
            (weaker.sl_db ? *weaker.sl_db : weaker.level_dbfs) -= e.over_db;
        }
}

} // namespace

options::option_values replace_options(options::option_values w, const json& chosen, options_for which)
{
    if (!chosen.is_object())
        refuse_param("options", "they are not an object", R"(such as {"algorithm":"continuous"})");
    // The options of a client start from the owner's values.
    w.by_user.reset();
    w.in_file.clear();
    w.place = options::by_client;
    for (const auto& [name, value] : chosen.items()) {
        const option& o = find_client_option(name, which);
        const options::value v = options::read_value(o, plain_value(value));
        refuse_file(o, v);
        options::give(w, o, v);
    }
    options::resolve(w);
    return w;
}

options::option_values resolve_options(options::option_values owner, const json& params)
{
    const bool predicts = read_view(params).kind == view_kind::percept;
    if (!predicts)
        owner.observer = observer_kind::centroid; // the observer centroid has no options
    if (const auto observer = params.find("observer"); observer != params.end()) {
        if (!predicts)
            refuse_param("observer", "only the view percept uses it", R"(add "view":"percept")");
        owner.observer = from_string<observer_kind>(observer->get<std::string>());
    }
    const auto chosen = params.find("options");
    return chosen == params.end() ? owner : replace_options(std::move(owner), *chosen, options_for::planned);
}

start_time read_start(const json& start, std::int64_t now_ns)
{
    if (start.is_string())
        return {.armed = start == "armed"};
    const std::string name = start.begin().key();
    const json& value = start.begin().value();
    if (name == "after")
        return {.after = value.is_array() ? value.get<std::vector<std::uint32_t>>()
                                          : std::vector{value.get<std::uint32_t>()}};
    std::int64_t at = std::llround(value.get<double>() * 1e9);
    if (name == "delay_s")
        return {.at_ns = now_ns + at};
    if (name == "unix_s")
        at += now_ns - rt::unix_ns();
    if (seconds(at - now_ns) > longest_wait_s)
        refuse_param("start." + name, "it is more than a day ahead");
    return {.at_ns = at};
}

reply_json option_rows(const options::option_values& owner)
{
    reply_json rows = reply_json::array();
    for (const option& o : options::all())
        if ((o.where & options::by_client) != 0)
            rows.push_back(row_json(o, owner));
    return rows;
}

void pack_points(json& params)
{
    if (params.is_object() && params.contains("points") && params["points"].is_array())
        params["points"] = json::binary(json::to_msgpack(params["points"]));
}

std::vector<stroke> read_strokes(const std::string& source, const json& v, const options::option_values& s)
{
    return session::read_strokes(source == "points"
                                     ? read_points(v, s.intensity_max.value_or(1.0))
                                     : session::make_source(source, v.get_ref<const std::string&>()),
                                 source, s);
}

std::vector<stroke> prepare_strokes(const planning& with, const layout& faces, std::vector<stroke> strokes,
                                    options::option_values s, bool fit)
{
    if (strokes.size() > with.max_strokes)
        refuse_too_many_strokes(strokes.size(), with.max_strokes);
    s.fit = fit;
    session::piece p = session::read_piece(std::move(strokes), "stroke", faces, s);
    check_durations(with, p.strokes);
    return std::move(p.strokes);
}

std::string find_source(const json& params)
{
    const std::vector<std::string_view>& names = session::source_names();
    return std::string(*std::find_if(names.begin(), names.end(),
                                     [&params](std::string_view name) { return params.contains(name); }));
}

void check_level(const planning& with, const options::option_values& s, double intensity, double carrier_hz,
                 const std::string& source)
{
    if (intensity <= 0.0)
        return;
    const double over_db = 20.0 * std::log10(intensity);
    const double level = highest_level(with, s, carrier_hz);
    if (level + over_db <= with.max_level_dbfs + rounding_db)
        return;
    const char* const option = s.render.sl_db ? "options.sl" : "options.level_dbfs";
    const int digits = plain_number(level, 4) == plain_number(with.max_level_dbfs, 4) ? 9 : 4; // to differ
    refuse_param(
        over_db > 0.0 && level <= with.max_level_dbfs + rounding_db ? source : option,
        fmt::format("{} dBFS{} is above the owner's limit of {} dBFS", plain_number(level, digits),
                    over_db == 0.0 ? "" : fmt::format(" at intensity {}", plain_number(intensity, 4)),
                    plain_number(with.max_level_dbfs, digits)),
        "use a lower level");
}

void check_bursts(double bursts, const char* hint)
{
    if (bursts > most_bursts)
        refuse_over_limit("bursts",
                          fmt::format("it has {:.0f} bursts, but the server plans at most {:.0f} at once",
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
    render_options alone = render;
    alone.together = together_kind::sum;
    (alone.sl_db ? *alone.sl_db : alone.level_dbfs) += weakened.weakened_db;
    return session::make_score(plans[i].plan, a, alone, rounds, round_s());
}

void plan_strokes(const planning& with, const layout& faces, planned& p, const options::option_values& s,
                  const std::string& source, const go_on_check& go_on, bool picture)
{
    double bursts = 0.0;
    for (const stroke& k : p.strokes)
        bursts += count_park_bursts(k, s.plan);
    check_bursts(bursts, "use a shorter stroke or a longer SOA");
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
        p.weakened =
            session::make_score(p, with.tactors, p.render).weakened(); // this also checks levels and carriers
}

void add_weakening(reply_json& to, const weakening& w)
{
    to["weakened_db"] = w.weakened_db;
    if (w.weakened_db < 0.0)
        to["meets"] = {{"tactor", w.tactor}, {"at_s", w.at_s}, {"strokes", w.plans}};
}

planned plan_request(const planning& with, const layout& faces, const json& params,
                     const options::option_values& s, const go_on_check& go_on)
{
    const std::string source = find_source(params);
    try {
        planned p{{source, read_strokes(source, params[source], s)}, s.render};
        p.observer = {s.observer, s.low_speed};
        if (source == "stroke")
            p.name = p.strokes.front().name;
        p.strokes = prepare_strokes(with, faces, std::move(p.strokes), s, false);
        plan_strokes(with, faces, p, s, source, go_on, read_view(params).kind != view_kind::full);
        return p;
    } catch (...) {
        throw fault_error(current_fault(source));
    }
}

planned make_drive(const planning& with, const json& params)
{
    const auto tactor = params["tactor"].get<std::uint32_t>();
    check_range("tactor", tactor, {0.0, static_cast<double>(with.tactors.tactors.size()) - 1.0});
    const double intensity = params.value("intensity", 1.0);
    const double seconds = params.value("duration_s", 0.5);
    check_duration(with, seconds);
    check_level(with, with.owner, intensity, with.owner.plan.carrier_hz, "intensity");
    planned p{{fmt::format("tactor {}", tactor)}, with.owner.render};
    const point where = with.tactors.tactors[tactor].position;
    plan one{.algorithm = "drive", .phantom = "none"};
    one.stroke_duration_s = seconds;
    one.total_s = seconds;
    one.carrier_hz = with.owner.plan.carrier_hz;
    burst b{.duration_s = seconds, .position = where, .intensity = intensity};
    if (intensity > 0.0)
        b.drives.push_back({tactor, intensity});
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
