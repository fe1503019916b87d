// SPDX-License-Identifier: MIT
// Starts and ends of strokes, and their notifications: each number has exactly one end.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "server/service_impl.hpp"
#include "session/log.hpp"

namespace tactor::server {

using net::reply_json;

service::stroke_record& service::add_record(client_number owner)
{
    auto r = std::make_unique<stroke_record>();
    r->number = ++last_stroke_;
    r->owner = owner;
    if (client* c = find(owner)) {
        c->strokes.insert(r->number);
        r->level_db = c->level_db;
    }
    return *strokes_.emplace(r->number, std::move(r)).first->second;
}

void service::begun(std::uint64_t player, stroke_id id, std::optional<std::int64_t> at_ns)
{
    const auto found = by_player_.find({player, id});
    if (found == by_player_.end())
        return;
    stroke_record& r = *strokes_.at(found->second);
    if (!r.open.empty() && r.open.back() == id)
        r.next_waits = false;
    if (r.state == "started") // it began again after an xrun, or with the next round
        return submit_next(r);
    r.state = "started";
    const std::int64_t now = options_.now_ns();
    r.started_ns = at_ns.value_or(now);
    stroke_report how;
    if (r.asked_ns)
        how.late_s = std::max(0.0, static_cast<double>(*r.started_ns - *r.asked_ns) * 1e-9);
    tell_stroke(r, "started", how);
    start_followers(r, *r.started_ns);
    submit_next(r);
}

// Submits the other strokes of an armed file, whose times are known only now.
void service::start_followers(stroke_record& first, std::int64_t at_ns)
{
    tactor::player* out = stream_.number() == first.player ? stream_.current() : nullptr;
    for (const auto& [number, after_s] : std::exchange(first.followers, {})) {
        const auto found = strokes_.find(number);
        if (found == strokes_.end() || !found->second->submits_later)
            continue;
        stroke_record& r = *found->second;
        if (r.ended_by != nullptr) { // stopped since the first began
            finish(r, {.state = state_kind::cancelled});
            continue;
        }
        const score later = *std::exchange(r.submits_later, {});
        try {
            if (out == nullptr)
                no_stream("");
            add_submission(
                r, out->submit(later, start_at::time(at_ns + std::llround(after_s * 1e9)), level_db(r)));
            r.state = "waiting";
        } catch (const error& e) {
            finish(r, {.state = state_kind::interrupted,
                       .reason = reason_kind::failed,
                       .why = out->ended() ? "the stream has ended" : e.what()});
        } catch (...) {
            finish(r, {.state = state_kind::interrupted,
                       .reason = reason_kind::failed,
                       .why = "the stream has ended"});
        }
    }
}

void service::ended(std::uint64_t player, const stroke_report& report)
{
    const auto found = by_player_.find({player, report.id});
    if (found == by_player_.end())
        return;
    stroke_record& r = *strokes_.at(found->second);
    by_player_.erase(found);
    if (report.started_ns && r.state != "started" && report.frames != 0) {
        r.started_ns = report.started_ns;
        tell_stroke(r, "started", {});
    }
    r.next_waits = r.next_waits && report.id != r.open.back();
    std::erase(r.open, report.id);
    r.frames += report.frames;
    if (report.state != state_kind::finished && !r.broken) {
        r.broken = report;
        end_rounds(r);
    }
    if (!r.open.empty())
        return;
    stroke_report whole = r.broken.value_or(report);
    if (whole.frames != r.frames) // it began with an earlier round
        whole.started_ns = r.started_ns;
    whole.frames = r.frames;
    finish(r, whole);
    note_busy();
}

// Notes a submission of a stroke: its only one, or its next round.
void service::add_submission(stroke_record& r, stroke_id id)
{
    r.open.push_back(id);
    by_player_[{r.player, id}] = r.number;
}

// Lets no round begin any more.
void service::end_rounds(stroke_record& r)
{
    r.again.reset();
    if (!std::exchange(r.next_waits, false))
        return;
    if (player* p = stream_.current(); p != nullptr && r.player == stream_.number())
        p->cancel(r.open.back());
    by_player_.erase({r.player, r.open.back()});
    r.open.pop_back();
}

void service::finish(stroke_record& r, const stroke_report& how)
{
    // A stroke that did not begin takes its followers with it.
    for (const auto& [number, after_s] : std::exchange(r.followers, {}))
        if (const auto f = strokes_.find(number); f != strokes_.end() && f->second->submits_later) {
            stroke_report same = how;
            same.frames = 0;
            same.started_ns.reset();
            f->second->ended_by = r.ended_by;
            finish(*f->second, same);
        }
    if (how.started_ns)
        r.started_ns = how.started_ns;
    r.submits_later.reset();
    const client_number owner = r.owner;
    if (client* c = find(owner)) {
        c->strokes.erase(r.number);
        if (r.live)
            --c->live;
    }
    r.state = "ended";
    end_touch(r);
    stroke_report report = how;
    report.why = reason(r, how);
    if (options_.log)
        options_.log(log_kind::info, session::stroke_text(fmt::format("{} of client {}", r.number, owner),
                                                          report, options_.plans.owner.render.rate));
    tell_stroke(r, to_string(report.state), report);
    if (r.released)
        strokes_.erase(r.number);
    check_all_sent(owner);
}

std::string service::reason(const stroke_record& r, const stroke_report& how) const
{
    if (how.state == state_kind::cancelled)
        return r.ended_by != nullptr ? r.ended_by : "stopped by the owner";
    switch (how.reason) {
    case reason_kind::xrun:
    case reason_kind::suspended:
    case reason_kind::lost:
    case reason_kind::failed:
        return "device: " + how.why;
    case reason_kind::crowded:
    case reason_kind::too_long:
        return "limit: " + how.why;
    default:
        return how.why;
    }
}

void service::tell_stroke(stroke_record& r, std::string_view state, const stroke_report& how)
{
    const bool sounded = r.started_ns && (state == "started" || how.frames != 0 || how.started_ns);
    const std::int64_t at_ns = r.started_ns.value_or(0);
    const auto from = [&](std::int64_t origin_ns) {
        return sounded ? reply_json(seconds(at_ns + origin_ns)) : reply_json(nullptr);
    };
    reply_json n = net::notification("stroke", {{"stroke", r.number},
                                                {"state", state},
                                                {"reason", how.why},
                                                {"frames", how.frames},
                                                {"started_s", from(0)},
                                                {"started_unix_s", from(unix_ns() - options_.now_ns())},
                                                {"late_s", how.late_s},
                                                {"held_points", how.held_points},
                                                {"outside_points", how.outside_points}});
    if (!r.released) {
        r.held.push_back(std::move(n));
        return;
    }
    send_to_listeners(r, n);
}

void service::send_to_listeners(const stroke_record& r, const reply_json& message)
{
    for (const auto& [number, c] : clients_)
        if (number == r.owner || (c->admitted && c->events.contains("strokes")))
            send(*c, message);
}

// Counts strokes alone: a request that waits for the stream wakes it.
void service::note_busy()
{
    stream_.busy(std::any_of(strokes_.begin(), strokes_.end(),
                             [](const auto& r) { return r.second->state != "ended"; }));
}

} // namespace tactor::server
