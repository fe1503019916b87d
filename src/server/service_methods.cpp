// SPDX-License-Identifier: MIT
// Handlers of hello, status, options, qr and subscribe, and notifications about strokes and touches.
#include "server/service.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <new>
#include <utility>

#include <qrencode.h>

#include <fmt/format.h>

#include <tactor/stroke.hpp>

#include "core/words.hpp"
#include "files/stroke_format.hpp"
#include "rt/clock.hpp"
#include "server/faults.hpp"

namespace tactor::server {
namespace {

using net::json;
using net::reply_json;

// Returns a row for each format of stroke files.
reply_json formats_json()
{
    reply_json rows = reply_json::array();
    for (const detail::stroke_format* f : detail::stroke_formats())
        rows.push_back({{"name", f->name},
                        {"title", f->title},
                        {"extensions", f->extensions},
                        {"media_type", f->media_type},
                        {"written", f->write != nullptr},
                        {"only_points", f->only_points}});
    return rows;
}

// Returns true for a name without letters, and for a name that pages use for their own user or for the owner.
bool is_taken_name(std::string_view name)
{
    const std::string small = to_lower_case(remove_invisible(name));
    return small.empty() || small == "you" || small == "theowner";
}

constexpr std::chrono::nanoseconds touch_step{1'000'000'000 /
                                              30}; // least time between notifications of a stroke's touch
constexpr double most_touches_per_s = 10'000.0;    // for all clients together

} // namespace

reply_json service::hello_result(const client& c)
{
    const stream_setup& s = stream_.setup();
    const bool seen = s.buffer_frames != 0 && stream_.number() != 0;
    return {{"protocol", "tactor/1"},
            {"version", options_.version},
            {"array", options_.array},
            {"stream",
             {{"rate", s.rate},
              {"channels", s.channels},
              {"format", seen ? reply_json(std::string(to_string(s.format))) : reply_json(nullptr)},
              {"period_frames", s.period_frames},
              {"latency_s", static_cast<double>(s.buffer_frames) / s.rate},
              {"pcm", s.name}}},
            {"presets", stroke_presets()},
            {"shapes", stroke_shapes()},
            {"formats", formats_json()},
            {"clock", {{"monotonic_s", seconds(options_.now_ns())}, {"unix_s", seconds(rt::unix_ns())}}},
            {"max_level_dbfs", options_.plans.max_level_dbfs},
            {"client", c.number}};
}

void service::hello(client& c, const json& params, const answer& to)
{
    const std::string name = params.value("name", c.name);
    if (params.contains("name") && is_taken_name(name))
        refuse_param("name", "it is reserved for the pages", "choose another name");
    const std::string* token =
        params.contains("token") ? params["token"].get_ptr<const std::string*>() : nullptr;
    const auto refuse = [to, why = token == nullptr ? "a token is required" : "it is wrong"] {
        to.send_fault(
            {net::code_no_token, "token", "token", why, "give the token in the server's token_file"});
    };
    if (!clients_.admit(c, token, refuse))
        return;
    c.name = name;
    to.send_result(hello_result(c));
}

reply_json service::limits_json() const
{
    reply_json limits = reply_json::object();
    for (const auto& [name, value] : options::list_limits(options_.limits))
        if (value == std::floor(value))
            limits[std::string(name)] = static_cast<std::int64_t>(value);
        else
            limits[std::string(name)] = value;
    return limits;
}

void service::status(client& /*c*/, const json& /*params*/, const answer& to)
{
    to.send_result(status_json());
}

reply_json service::status_json()
{
    const player_stats s = stream_.stats();
    reply_json clients = reply_json::array();
    for (const auto& [number, c] : clients_.all())
        clients.push_back({{"client", number}, {"name", c->name}, {"from", c->from}});
    reply_json strokes = reply_json::array();
    for (const auto& [number, r] : strokes_)
        strokes.push_back({{"stroke", number}, {"state", r.state}, {"client", r.owner}});
    const double rate = stream_.setup().rate;
    return {{"version", options_.version},
            {"stream",
             {{"state", to_string(stream_.state())},
              {"reason", stream_.reason()},
              {"xruns", s.xruns},
              {"uptime_s", rate > 0.0 ? static_cast<double>(s.frames) / rate : 0.0},
              {"realtime", s.realtime}}},
            {"amplifier", to_string(stream_.amplifier())},
            {"clients", clients_.all().size()},
            {"who", clients},
            {"strokes", strokes},
            {"max_level_dbfs", options_.plans.max_level_dbfs},
            {"limits", limits_json()}};
}

void service::list_options(client& /*c*/, const json& /*params*/, const answer& to)
{
    to.send_result({{"options", option_rows(options_.plans.owner)}});
}

// Returns a QR code of a text as SVG path data. Each dark module is a unit square.
void service::make_qr(client& /*c*/, const json& params, const answer& to)
{
    const auto of = params["text"].get<std::string>();
    const std::unique_ptr<QRcode, decltype(&QRcode_free)> symbol(
        QRcode_encodeData(static_cast<int>(of.size()), reinterpret_cast<const unsigned char*>(of.data()), 0,
                          QR_ECLEVEL_L),
        &QRcode_free);
    if (!symbol)
        throw std::bad_alloc();
    std::string path;
    for (int y = 0; y < symbol->width; ++y)
        for (int x = 0; x < symbol->width; ++x)
            if ((symbol->data[y * symbol->width + x] & 1U) != 0)
                path += fmt::format("M{} {}h1v1h-1z", x, y);
    to.send_result({{"size", symbol->width}, {"path", std::move(path)}});
}

void service::send_stroke_event(stroke_record& r, std::string_view state, const stroke_report& how)
{
    const bool sounded = r.started_ns && (state == "started" || how.frames != 0 || how.started_ns);
    const std::int64_t at_ns = r.started_ns.value_or(0);
    const auto from = [&](std::int64_t origin_ns) {
        return sounded ? reply_json(seconds(at_ns + origin_ns)) : reply_json(nullptr);
    };
    reply_json event{{"stroke", r.number},
                     {"state", state},
                     {"reason", how.why},
                     {"frames", how.frames},
                     {"started_s", from(0)},
                     {"started_unix_s", from(rt::unix_ns() - options_.now_ns())},
                     {"late_s", how.late_s},
                     {"held_points", how.held_points},
                     {"outside_points", how.outside_points},
                     {"doubt", how.doubt}};
    if (r.released)
        clients_.send_stroke_event(r.owner, event);
    else
        r.held.push_back(std::move(event));
}

void service::subscribe(client& c, const json& params, const answer& to)
{
    clients_.subscribe(c, params["events"].get<std::set<std::string>>(), params.value("levels_hz", 30.0));
    to.send_result(reply_json::object());
}

// Sends the last point of a live stroke to other clients. Sends it later if the previous one was sent less
// than touch_step ago, or if too many touches are being sent.
void service::touch(stroke_record& r)
{
    const std::int64_t now = options_.now_ns();
    const bool is_early = r.shown_ns && now - *r.shown_ns < touch_step.count();
    const auto& all = clients_.all();
    const auto listeners = std::count_if(all.begin(), all.end(),
                                         [](const auto& c) { return c.second->events.contains("touches"); });
    if (!is_early && touches_.take(static_cast<double>(listeners), most_touches_per_s, now)) {
        touches_due_.erase(r.number);
        r.shown_ns = now;
        return send_touch_event(r, true);
    }
    if (!touches_due_.insert(r.number).second || touches_due_.size() > 1)
        return;
    touch_timer_.expires_after(touch_step);
    touch_timer_.async_wait([this](const boost::system::error_code& e) {
        if (e)
            return;
        for (const std::uint32_t n : std::exchange(touches_due_, {}))
            touch(strokes_.at(n));
    });
}

void service::send_touch_event(const stroke_record& r, bool down)
{
    clients_.send_event("touches",
                        {{"client", r.owner},
                         {"stroke", r.number},
                         {"x_mm", r.touched->x_mm},
                         {"y_mm", r.touched->y_mm},
                         {"down", down}},
                        r.owner);
}

} // namespace tactor::server
