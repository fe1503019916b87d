// SPDX-License-Identifier: MIT
// Planned strokes are submitted; drive, cancel, stop, fire.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "server/service_impl.hpp"
#include "server/stroke_options.hpp"

namespace tactor::server {
namespace {

using net::json;
using net::reply_json;

constexpr const char* cancelled_by_client = "cancelled by its client";

} // namespace

void service::check_free_place(const client& c) const
{
    const std::size_t most = options_.limits.max_strokes;
    if (c.strokes.size() + c.coming >= most)
        limit_reached("max_strokes", fmt::format("{} strokes of yours go on", most),
                      "try again when one has ended");
    // Strokes of disconnected clients count here.
    if (strokes_.size() + jobs_ >= most * options_.limits.max_clients)
        limit_reached("max_strokes", "there are too many strokes of all clients", "try again later");
}

std::vector<std::uint32_t> service::submit(client_number owner, const json& start, const planned& p,
                                           const std::vector<score>& scores, const char* ended_by,
                                           double gain_db, bool again)
{
    if (ending_)
        no_stream("the server ends");
    if (ended_by != nullptr)
        return end_unbegun(owner, scores.size(), ended_by);
    player* out = stream_.current();
    if (out == nullptr || out->ended())
        no_stream(stream_.reason());
    const std::int64_t now = options_.now_ns();
    const start_time asked = read_start(&start, now);
    const std::vector<double> starts = p.starts_s();
    const stream_setup& s = out->setup();
    // Several strokes keep their distances: they count from a time that the first is sure to reach.
    const auto lead_ns = std::int64_t{1'000'000'000} * (s.buffer_frames + 3 * s.period_frames) / s.rate;
    const std::int64_t base_ns = asked.at_ns.value_or(now + lead_ns);
    const auto first =
        static_cast<std::size_t>(std::min_element(starts.begin(), starts.end()) - starts.begin());
    const auto rounds_frames =
        static_cast<std::uint64_t>(std::llround(static_cast<double>(p.rounds) * p.total_s() * s.rate));
    std::vector<std::uint32_t> numbers;
    std::vector<stroke_record*> records;
    std::vector<std::string> refused(scores.size());
    for (std::size_t i = 0; i < scores.size(); ++i) {
        stroke_record& r = add_record(owner);
        numbers.push_back(r.number);
        records.push_back(&r);
        r.player = stream_.number();
        r.gain_db = gain_db;
        if (const client* c = find(owner); again && c != nullptr && !c->input_over)
            r.again = repeated{scores[i], rounds_frames};
        if (asked.armed && i != first) {
            r.submits_later = scores[i];
            r.state = "armed";
            continue;
        }
        const std::int64_t at = base_ns + std::llround(starts[i] * 1e9);
        start_at when = start_at::now();
        if (asked.armed)
            when = start_at::trigger();
        else if (asked.at_ns || scores.size() > 1) {
            when = start_at::time(at);
            if (asked.at_ns)
                r.asked_ns = at;
        }
        try {
            add_submission(r, out->submit(scores[i], when, level_db(r)));
        } catch (const error& e) {
            refused[i] = e.what(); // the stream may just have ended: the number ends below
            continue;
        }
        r.state = asked.armed ? "armed" : "waiting";
    }
    for (std::size_t i = 0; i < records.size(); ++i)
        if (records[i]->submits_later)
            records[first]->followers.emplace_back(records[i]->number, starts[i] - starts[first]);
    const auto end = out->ended();
    for (std::size_t i = 0; i < records.size(); ++i)
        if (records[i]->open.empty() && !records[i]->submits_later && records[i]->state != "ended")
            finish(*records[i], {.state = state_kind::interrupted,
                                 .reason = end ? end->reason : reason_kind::failed,
                                 .why = end ? end->why : refused[i]});
    return numbers;
}

// Submits what is repeated for the frame after it, which begins now.
void service::submit_next(stroke_record& r)
{
    player* out = stream_.number() == r.player ? stream_.current() : nullptr;
    if (!r.again || r.next_waits || r.open.empty() || r.ended_by != nullptr || out == nullptr)
        return;
    const auto from = out->first_frame(r.open.back());
    if (!from) // it has ended, and its report comes
        return;
    try {
        add_submission(r,
                       out->submit(r.again->rounds, start_at::frame(*from + r.again->frames), level_db(r)));
        r.next_waits = true;
    } catch (const error& e) {
        r.again.reset();
        r.broken =
            stroke_report{.state = state_kind::interrupted, .reason = reason_kind::failed, .why = e.what()};
    }
}

// Numbers strokes that were stopped before the stream had them, and ends them.
std::vector<std::uint32_t> service::end_unbegun(client_number owner, std::size_t n, const char* why)
{
    std::vector<std::uint32_t> numbers;
    std::vector<stroke_record*> records;
    for (std::size_t i = 0; i < n; ++i) {
        records.push_back(&add_record(owner));
        records.back()->ended_by = why;
        numbers.push_back(records.back()->number);
    }
    for (stroke_record* r : records)
        finish(*r, {.state = state_kind::cancelled});
    return numbers;
}

// Calls `then` for a request of a client that is `coming`, once the stream runs or it is known that it does
// not; at once if it was stopped since it came. Answers with the fault that it throws, about `source`.
void service::once_ready(const answer& to, const char* source, std::function<void()> then)
{
    std::function<void()> ready = [this, to, source, then = std::move(then)] {
        if (client* c = find(to.all->to))
            --c->coming;
        try {
            then();
        } catch (...) {
            to.fault(current_fault(source));
        }
        note_busy();
    };
    if (stop_reason_since(to) != nullptr)
        return ready(); // it must not start a device that is closed
    stream_.when_ready(std::move(ready));
}

void service::drive(client& c, const json& params, const answer& to)
{
    auto p = std::make_shared<planned>(make_drive(options_.plans, params));
    const json start = params.value("start", json("now"));
    static_cast<void>(read_start(&start, options_.now_ns()));
    check_free_place(c);
    if (ending_ || stream_.is_out())
        no_stream(stream_.reason());
    const std::vector<score> scores{p->make_score(options_.plans.tactors, 0)};
    ++c.coming;
    once_ready(to, "stream", [this, number = c.number, to, p, scores, start] {
        const auto numbers = submit(number, start, *p, scores, stop_reason_since(to));
        to.result({{"stroke", numbers.front()}}, numbers);
    });
}

// Returns the reason of strokes that the last stop ended.
const char* service::stop_reason(client_number owner) const
{
    return owner == stopped_by_ ? cancelled_by_client : "stopped by another client";
}

service::stop_mark service::mark(const client& c) const
{
    return {stops_, c.cancels, *c.cancels};
}

// Returns the reason of a stroke that must not begin because it was stopped since its request came; null: it
// may.
const char* service::stop_reason_since(const answer& to) const
{
    const stop_mark& m = to.asked;
    const client_number owner = to.all->to;
    if (*m.cancels != m.own)
        return cancelled_by_client;
    return m.stops != stops_ ? stop_reason(owner) : nullptr;
}

// Returns how far below what it asks for a stroke sounds.
double service::level_db(const stroke_record& r) noexcept
{
    return std::max(player::least_level_db, r.level_db + r.gain_db);
}

void service::set_level(stroke_record& r, double db)
{
    r.level_db = db;
    if (player* p = stream_.current(); p != nullptr && r.player == stream_.number())
        for (const stroke_id id : r.open)
            p->set_level(id, level_db(r));
}

// Sets the level of a client's strokes, those to come too, or of one.
void service::level(client& c, const json& params, const answer& to)
{
    allow_only(params, {"db", "stroke"});
    const double db = need_number(params, "db", {player::least_level_db, 0.0});
    if (params.contains("stroke")) {
        const std::uint32_t n = need_stroke(params);
        if (!c.strokes.contains(n))
            no_such_stroke(n);
        set_level(*strokes_.at(n), db);
    } else {
        c.level_db = db;
        for (const std::uint32_t n : c.strokes)
            set_level(*strokes_.at(n), db);
    }
    to.result(reply_json::object());
}

void service::cancel(client& c, const json& params, const answer& to)
{
    allow_only(params, {"stroke", "all"});
    if (const json* all = member(params, "all")) {
        if (!all->is_boolean() || !all->get<bool>() || params.contains("stroke"))
            bad_param("all", "it is true, and stands alone", R"({"stroke":N} or {"all":true})");
        cancel_all(c);
        return to.result(reply_json::object());
    }
    const std::uint32_t n = need_stroke(params);
    if (!c.strokes.contains(n))
        no_such_stroke(n);
    to.result(reply_json::object());
    cancel(*strokes_.at(n), cancelled_by_client);
}

// Cancels all strokes of a client. Requests that are being planned, or wait for the stream, check the count.
void service::cancel_all(client& c)
{
    ++*c.cancels;
    for (const std::uint32_t n : std::set(c.strokes))
        if (const auto found = strokes_.find(n); found != strokes_.end())
            cancel(*found->second, cancelled_by_client);
}

void service::cancel(stroke_record& r, const char* why)
{
    if (r.ended_by == nullptr)
        r.ended_by = why;
    if (r.submits_later) // it waits for another to begin
        return finish(r, {.state = state_kind::cancelled});
    r.again.reset();
    if (player* p = stream_.current(); p != nullptr && r.player == stream_.number())
        for (const stroke_id id : r.open)
            p->cancel(id);
}

void service::stop(client& c, const json& /*params*/, const answer& to)
{
    stop_all(c.number);
    to.result(reply_json::object());
}

void service::stop_all(client_number by)
{
    ++stops_;
    stopped_by_ = by;
    // Followers in an armed file end with the stroke that they wait for.
    for (const auto& [number, r] : strokes_)
        if (r->ended_by == nullptr)
            r->ended_by = stop_reason(r->owner);
    stream_.cancel_all();
    if (stopped_)
        stopped_();
    tell_stop(by);
}

void service::fire(client& /*c*/, const json& params, const answer& to)
{
    allow_only(params, {});
    player* p = stream_.current();
    if (p == nullptr && stream_.is_out())
        no_stream(stream_.reason());
    // Armed strokes keep a stream going: if it was stopped for want of strokes, there is nothing to start.
    const std::int64_t now = options_.now_ns();
    std::size_t n = p == nullptr ? 0 : p->fire(now);
    for (const auto& [number, r] : strokes_) {
        if (r->state != "armed" || r->player != stream_.number())
            continue;
        r->state = "waiting";
        if (r->submits_later)
            ++n; // it follows another stroke of its file
        else
            r->asked_ns = now;
    }
    to.result({{"count", n}});
}

void service::release(const std::vector<std::uint32_t>& numbers)
{
    for (const std::uint32_t n : numbers) {
        const auto found = strokes_.find(n);
        if (found == strokes_.end())
            continue;
        stroke_record& r = *found->second;
        r.released = true;
        for (const reply_json& held : std::exchange(r.held, {}))
            send_to_listeners(r, held);
        if (r.state == "ended")
            strokes_.erase(found);
    }
}

} // namespace tactor::server
