// SPDX-License-Identifier: MIT
// begin, to, end.
#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "server/service_impl.hpp"

namespace tactor::server {
namespace {

using net::json;
using net::reply_json;

// Farthest place, mm. The stroke clamps or refuses nearer places outside the array.
constexpr double farthest_mm = 1e6;

} // namespace

void service::begin(client& c, const json& params, const answer& to)
{
    allow_only(params, {"options", "timeout_s", "smooth_s"});
    const live_options usual;
    options::wishes s = options_.plans.owner;
    s.plan.algorithm = usual.plan.algorithm;
    s.plan.outside = usual.plan.outside;
    if (const json* o = member(params, "options"))
        s = with_options(s, *o, options_for::live);
    check_level(options_.plans, s, 1.0, s.plan.carrier_hz, "options");
    live_options o;
    o.plan = s.plan;
    o.render = s.render;
    o.longest_s = options_.limits.max_stroke_s;
    if (const json* t = member(params, "timeout_s"))
        o.timeout_s = number(*t, "timeout_s", detail::bounds_of::timeout_s);
    if (const json* t = member(params, "smooth_s"))
        o.smooth_s = number(*t, "smooth_s", detail::bounds_of::smooth_s);
    check_free_place(c);
    if (c.live >= options_.limits.max_live_strokes)
        limit_reached("max_live_strokes",
                      fmt::format("{} live strokes of yours go on", options_.limits.max_live_strokes),
                      "end one of them first");
    if (ending_ || stream_.is_out())
        no_stream(stream_.reason());
    ++c.coming;
    ++c.live;
    const double intensity_max = s.intensity_max.value_or(1.0);
    once_ready(to, "options", [this, number = c.number, o, to, intensity_max] {
        client* then = find(number);
        if (then == nullptr)
            return;
        --then->live;
        begin_now(*then, o, intensity_max, to, stop_reason_since(to));
    });
}

void service::begin_now(client& c, const live_options& o, double intensity_max, const answer& to,
                        const char* ended_by)
{
    player* out = stream_.current();
    if (ending_ || out == nullptr || out->ended())
        no_stream(ending_ ? "the server ends" : stream_.reason());
    if (ended_by != nullptr) {
        // It was cancelled while the stream was being started.
        const auto numbers = end_unbegun(c.number, 1, ended_by);
        to.result({{"stroke", numbers.front()}}, numbers);
        return;
    }
    live_stroke live = out->begin(o);
    stroke_record& r = add_record(c.number);
    r.player = stream_.number();
    add_submission(r, live.id());
    r.live = live;
    r.intensity_max = intensity_max;
    if (r.level_db != 0.0)
        out->set_level(live.id(), r.level_db);
    ++c.live;
    if (c.input_over)
        live.end();
    to.result({{"stroke", r.number}}, {r.number});
}

service::stroke_record& service::own_live(client& c, std::uint32_t number)
{
    if (!c.strokes.contains(number))
        no_such_stroke(number);
    stroke_record& r = *strokes_.at(number);
    if (!r.live)
        no_such_stroke(number, "it is no live stroke");
    return r;
}

void service::to(client& c, const json& params, const answer& to)
{
    allow_only(params, {"stroke", "x_mm", "y_mm", "intensity"});
    if (const double most = options_.limits.max_points_per_s; !c.points.take(1.0, most, options_.now_ns()))
        limit_reached("max_points_per_s", fmt::format("{} points in a second are the most", most));
    const std::uint32_t n = need_stroke(params);
    const double x = need_number(params, "x_mm", {-farthest_mm, farthest_mm});
    const double y = need_number(params, "y_mm", {-farthest_mm, farthest_mm});
    const json* given = member(params, "intensity");
    const double asked =
        given == nullptr ? 1.0 : number(*given, "intensity", {0.0, std::numeric_limits<double>::max()});
    stroke_record& r = own_live(c, n);
    const double intensity = given == nullptr ? 1.0 : asked / r.intensity_max;
    try {
        if (!r.live->to(x, y, intensity))
            no_such_stroke(n, "it has ended");
    } catch (const error& e) {
        throw fault_error(library_fault(e, "x_mm"));
    }
    r.touched = point{x, y};
    touch(r);
    to.result(reply_json::object());
}

void service::end(client& c, const json& params, const answer& to)
{
    allow_only(params, {"stroke"});
    own_live(c, need_stroke(params)).live->end();
    to.result(reply_json::object());
}

} // namespace tactor::server
