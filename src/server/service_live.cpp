// SPDX-License-Identifier: MIT
// Live strokes: begin, points and end.
#include "server/service.hpp"

#include <string>

#include <fmt/format.h>

#include "server/faults.hpp"

namespace tactor::server {

using net::json;
using net::reply_json;

void service::begin(client& c, const json& params, const answer& to)
{
    live_options o;
    options::option_values s = options_.plans.owner;
    s.plan.algorithm = o.plan.algorithm;
    s.plan.outside = o.plan.outside;
    if (params.contains("options"))
        s = replace_options(s, params["options"], options_for::live);
    check_level(options_.plans, s, 1.0, s.plan.carrier_hz, "options");
    o.plan = s.plan;
    o.render = s.render;
    o.longest_s = options_.limits.max_stroke_s;
    o.timeout_s = params.value("timeout_s", o.timeout_s);
    o.smooth_s = params.value("smooth_s", o.smooth_s);
    check_free_place(c);
    if (c.live >= options_.limits.max_live_strokes)
        refuse_over_limit("max_live_strokes",
                          fmt::format("you have {} live strokes already", options_.limits.max_live_strokes),
                          "end one of them first");
    if (ending_ || stream_.is_unavailable())
        refuse_without_stream(stream_.reason());
    ++c.coming;
    ++c.live;
    const double intensity_max = s.intensity_max.value_or(1.0);
    run_when_ready(to, "options", [this, number = c.number, o, to, intensity_max] {
        if (client* then = clients_.find(number)) {
            --then->live;
            begin_live_stroke(*then, o, intensity_max, to);
        }
    });
}

void service::begin_live_stroke(client& c, const live_options& o, double intensity_max, const answer& to)
{
    player* out = stream_.current();
    if (ending_ || out == nullptr || out->ended())
        refuse_without_stream(ending_ ? "the server ends" : stream_.reason());
    if (const char* ended_by = stop_reason_since(to)) { // stopped while the stream was starting
        const auto numbers = end_stopped_strokes(c.number, 1, ended_by);
        return to.send_result({{"stroke", numbers.front()}}, numbers);
    }
    live_stroke live = out->begin(o);
    stroke_record& r = add_record(c.number);
    r.player = stream_.number();
    add_submission(r, live.id());
    r.live = live;
    r.intensity_max = intensity_max;
    set_log_details(r, "live", o.render);
    if (r.level_db != 0.0)
        out->set_level(live.id(), r.level_db);
    ++c.live;
    if (c.input_over)
        live.end();
    to.send_result({{"stroke", r.number}}, {r.number});
}

service::stroke_record& service::find_own_live_stroke(client& c, std::uint32_t number)
{
    stroke_record& r = find_own_stroke(c, number);
    if (!r.live)
        refuse_unknown_stroke(number, "it is not a live stroke");
    return r;
}

void service::to(client& c, const json& params, const answer& to)
{
    if (const double most = options_.limits.max_points_per_s; !c.points.take(1.0, most, options_.now_ns()))
        refuse_over_limit("max_points_per_s",
                          fmt::format("a client may send at most {} points a second", most));
    const auto n = params["stroke"].get<std::uint32_t>();
    const auto x = params["x_mm"].get<double>();
    const auto y = params["y_mm"].get<double>();
    stroke_record& r = find_own_live_stroke(c, n);
    const double intensity = params.value("intensity", r.intensity_max);
    try {
        if (!r.live->to(x, y, intensity / r.intensity_max))
            refuse_unknown_stroke(n, "it has ended");
    } catch (const error& e) {
        throw fault_error(library_fault(e, "x_mm"));
    }
    r.touched = point{x, y};
    touch(r);
    to.send_result(reply_json::object());
}

void service::end(client& c, const json& params, const answer& to)
{
    const auto n = params["stroke"].get<std::uint32_t>();
    if (const stroke_record& r = find_own_stroke(c, n); r.rounds.again || r.rounds.last)
        end_request(r);
    else
        find_own_live_stroke(c, n).live->end();
    to.send_result(reply_json::object());
}

} // namespace tactor::server
