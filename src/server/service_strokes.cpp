// Methods drive, level, cancel, stop and fire; submissions, starts and ends of strokes. Each stroke number
// has exactly one end.
#include "server/service.hpp"

#include <algorithm>
#include <new>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/words.hpp"
#include "rt/clock.hpp"
#include "server/faults.hpp"
#include "session/log.hpp"

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
        refuse_over_limit("max_strokes", fmt::format("you have {} strokes already", most),
                          "try again when one has ended");
    // Includes strokes of clients that have disconnected.
    if (strokes_.size() + jobs_ >= most * options_.limits.max_clients)
        refuse_over_limit("max_strokes", "too many strokes at once, all clients together", "try again later");
}

std::vector<std::uint32_t> service::submit(client_number owner, const json& start, const planned& p,
                                           const std::vector<score>& scores, const char* ended_by,
                                           double gain_db, bool again)
{
    if (ending_)
        refuse_without_stream("the server ends");
    if (ended_by != nullptr)
        return end_stopped_strokes(owner, scores.size(), ended_by);
    player* out = stream_.current();
    if (out == nullptr || out->ended())
        refuse_without_stream(stream_.reason());
    const std::int64_t now = options_.now_ns();
    const start_time wanted = read_start(start, now);
    const std::vector<double> starts = p.starts_s();
    const stream_setup& s = out->setup();
    // Keeps the time between several strokes. Their start times are relative to a time that is late enough
    // for the first stroke.
    const auto lead_ns = std::int64_t{1'000'000'000} * (s.buffer_frames + 3 * s.period_frames) / s.rate;
    const std::int64_t base_ns = wanted.at_ns.value_or(now + lead_ns);
    const bool joins = !wanted.after.empty();
    const std::uint64_t base_frame = joins ? end_requests(owner, wanted.after) : 0;
    const auto first =
        static_cast<std::size_t>(std::min_element(starts.begin(), starts.end()) - starts.begin());
    const auto rounds_frames =
        static_cast<std::uint64_t>(std::llround(static_cast<double>(p.rounds) * p.round_s() * s.rate));
    std::vector<std::uint32_t> numbers;
    std::vector<stroke_record*> records;
    for (std::size_t i = 0; i < scores.size(); ++i) {
        stroke_record& r = add_record(owner);
        numbers.push_back(r.number);
        records.push_back(&r);
        r.player = stream_.number();
        r.gain_db = gain_db;
        set_log_details(r, i < p.strokes.size() ? p.strokes[i].name : p.name, p.render);
        r.request = numbers.front();
        r.rounds.frames = rounds_frames;
        if (const client* c = clients_.find(owner); again && c != nullptr && !c->input_over)
            r.rounds.again = scores[i];
        if (wanted.armed)
            r.state = "armed";
        const bool keeps_distance = joins || wanted.at_ns || scores.size() > 1;
        if (const double from_s = wanted.armed ? starts[first] : 0.0; keeps_distance)
            r.rounds.offset = static_cast<std::uint64_t>(std::llround((starts[i] - from_s) * s.rate));
        if (wanted.armed && i != first) {
            r.submits_later = scores[i];
            continue;
        }
        start_at when = wanted.armed ? start_at::trigger() : start_at::now();
        if (joins) {
            when = start_at::frame(base_frame + r.rounds.offset);
        } else if (!wanted.armed && keeps_distance) {
            const std::int64_t at = base_ns + std::llround(starts[i] * 1e9);
            when = start_at::time(rt::to_time(at));
            if (wanted.at_ns)
                r.requested_ns = at;
        }
        try {
            add_submission(r, out->submit(scores[i], when, level_db(r)));
        } catch (const error& e) { // if the stream has just ended, the stroke ends below
            r.broken = {.state = state_kind::interrupted, .reason = reason_kind::failed, .why = e.what()};
        }
    }
    for (std::size_t i = 0; i < records.size(); ++i)
        if (records[i]->submits_later)
            records[first]->followers.emplace_back(records[i]->number, starts[i] - starts[first]);
    for (stroke_record* r : records) {
        if (!r->broken)
            continue;
        if (const auto end = out->ended()) {
            r->broken->reason = end->reason;
            r->broken->why = end->why;
        }
        finish(*r, *r->broken);
    }
    return numbers;
}

// Submits the stroke again. The new submission follows the one that begins now without a gap.
void service::submit_next(stroke_record& r)
{
    player* out = find_player(r);
    submissions& all = r.rounds;
    if (all.last && all.newest >= *all.last)
        all.again.reset();
    if (!all.again || r.next_waits || r.open.empty() || r.ended_by != nullptr || out == nullptr)
        return;
    const auto from = out->first_frame(r.open.back());
    if (!from) // the stroke has ended, and its report will arrive soon
        return;
    try {
        add_submission(r, out->submit(*all.again, start_at::frame(*from + all.frames), level_db(r)));
        r.next_waits = true;
        ++all.newest;
    } catch (const error& e) {
        all.again.reset();
        r.broken =
            stroke_report{.state = state_kind::interrupted, .reason = reason_kind::failed, .why = e.what()};
    }
}

// Assigns numbers to strokes that were stopped before they were submitted, and ends these strokes.
std::vector<std::uint32_t> service::end_stopped_strokes(client_number owner, std::size_t n, const char* why)
{
    std::vector<std::uint32_t> numbers;
    for (std::size_t i = 0; i < n; ++i) {
        stroke_record& r = add_record(owner);
        numbers.push_back(r.number);
        r.ended_by = why;
        finish(r, {.state = state_kind::cancelled});
    }
    return numbers;
}

// Calls `then` for a request that is counted in client::coming. Waits until it is known whether the stream
// runs, but not if the request has been stopped. If `then` throws, answers with a fault about `source`.
void service::run_when_ready(const answer& to, const char* source, std::function<void()> then)
{
    std::function<void()> ready = [this, to, source, then = std::move(then)] {
        if (client* c = clients_.find(to.all->to))
            --c->coming;
        try {
            then();
        } catch (...) {
            to.send_fault(current_fault(source));
        }
        update_busy();
    };
    if (stop_reason_since(to) != nullptr)
        return ready(); // a stopped request must not open the device
    stream_.call_when_ready(std::move(ready));
}

void service::drive(client& c, const json& params, const answer& to)
{
    auto p = std::make_shared<planned>(make_drive(options_.plans, params));
    const json start = params.value("start", json("now"));
    static_cast<void>(read_start(start, options_.now_ns()));
    check_free_place(c);
    if (ending_ || stream_.is_unavailable())
        refuse_without_stream(stream_.reason());
    const std::vector<score> scores{p->make_score(options_.plans.tactors, 0)};
    ++c.coming;
    run_when_ready(to, "stream", [this, number = c.number, to, p, scores, start] {
        const auto numbers = submit(number, start, *p, scores, stop_reason_since(to));
        to.send_result({{"stroke", numbers.front()}}, numbers);
    });
}

// Returns the reason why the last stop ended a stroke. It depends on the stroke's owner.
const char* service::stop_reason(client_number owner) const
{
    return owner == stopped_by_ ? cancelled_by_client : "stopped by another client";
}

service::stop_mark service::mark(const client& c) const
{
    return {stops_, c.cancels, *c.cancels};
}

// Returns the reason why a stroke must not begin, because it was stopped after its request arrived. Returns
// null if it may begin.
const char* service::stop_reason_since(const answer& to) const
{
    const stop_mark& m = to.since;
    const client_number owner = to.all->to;
    if (*m.cancels != m.own)
        return cancelled_by_client;
    return m.stops != stops_ ? stop_reason(owner) : nullptr;
}

// Returns the player of a stroke, or null if this player no longer exists.
player* service::find_player(const stroke_record& r) const noexcept
{
    return r.player == stream_.number() ? stream_.current() : nullptr;
}

// Returns the level of a stroke relative to its planned level, dB, at most 0.
double service::level_db(const stroke_record& r) noexcept
{
    return std::max(player::least_level_db, r.level_db + r.gain_db);
}

void service::set_level(stroke_record& r, double db)
{
    r.level_db = db;
    if (player* p = find_player(r))
        for (const stroke_id id : r.open)
            p->set_level(id, level_db(r));
}

// Sets the level of one stroke, or of all present and future strokes of a client.
void service::level(client& c, const json& params, const answer& to)
{
    const auto db = params["db"].get<double>();
    if (params.contains("stroke")) {
        set_level(find_own_stroke(c, params["stroke"]), db);
    } else {
        c.level_db = db;
        for (const std::uint32_t n : c.strokes)
            set_level(strokes_.at(n), db);
    }
    to.send_result(reply_json::object());
}

void service::cancel(client& c, const json& params, const answer& to)
{
    if (params.contains("all")) {
        // Requests that are being planned or wait for the stream compare this count.
        ++*c.cancels;
        for (const std::uint32_t n : std::set(c.strokes))
            if (const auto found = strokes_.find(n); found != strokes_.end())
                cancel(found->second, cancelled_by_client);
        return to.send_result(reply_json::object());
    }
    stroke_record& r = find_own_stroke(c, params["stroke"]);
    to.send_result(reply_json::object());
    cancel(r, cancelled_by_client);
}

void service::cancel(stroke_record& r, const char* why)
{
    if (r.ended_by == nullptr)
        r.ended_by = why;
    if (r.submits_later) // it waits for another stroke to begin
        return finish(r, {.state = state_kind::cancelled});
    r.rounds.again.reset();
    if (player* p = find_player(r))
        for (const stroke_id id : r.open)
            p->cancel(id);
}

void service::stop(client& c, const json& /*params*/, const answer& to)
{
    stop_all(c.number);
    to.send_result(reply_json::object());
}

void service::stop_all(client_number by)
{
    ++stops_;
    stopped_by_ = by;
    // Marks all strokes: followers in an armed file end together with the stroke that they follow.
    for (auto& [number, r] : strokes_)
        if (r.ended_by == nullptr)
            r.ended_by = stop_reason(r.owner);
    stream_.cancel_all();
    if (stopped_)
        stopped_();
    clients_.send_stop_event(by);
}

void service::fire(client& /*c*/, const json& /*params*/, const answer& to)
{
    player* p = stream_.current();
    if (p == nullptr && stream_.is_unavailable())
        refuse_without_stream(stream_.reason());
    // An armed stroke keeps the stream running, so there is nothing to start if the stream is idle.
    const std::int64_t now = options_.now_ns();
    std::size_t n = p == nullptr ? 0 : p->fire(rt::to_time(now));
    for (auto& [number, r] : strokes_) {
        if (r.state != "armed" || r.player != stream_.number())
            continue;
        r.state = "waiting";
        if (r.submits_later)
            ++n; // counts a stroke that follows another stroke of its file
        else
            r.requested_ns = now;
    }
    to.send_result({{"count", n}});
}

void service::release(const std::vector<std::uint32_t>& numbers)
{
    for (const std::uint32_t n : numbers) {
        const auto found = strokes_.find(n);
        if (found == strokes_.end())
            continue;
        stroke_record& r = found->second;
        r.released = true;
        for (const reply_json& held : std::exchange(r.held, {}))
            clients_.send_stroke_event(r.owner, held);
        if (r.state == "ended")
            strokes_.erase(found);
    }
}

service::stroke_record& service::add_record(client_number owner)
{
    stroke_record& r = strokes_[++last_stroke_];
    r.number = last_stroke_;
    r.owner = owner;
    if (client* c = clients_.find(owner)) {
        c->strokes.insert(r.number);
        r.level_db = c->level_db;
    }
    return r;
}

void service::handle_begin(std::uint64_t player, stroke_id id, std::optional<std::int64_t> at_ns)
{
    const auto found = by_player_.find({player, id});
    if (found == by_player_.end())
        return;
    stroke_record& r = strokes_.at(found->second);
    if (!r.open.empty() && r.open.back() == id)
        r.next_waits = false;
    note_beginning(r, id);
    if (r.state == "started") // the stroke begins again after an xrun or with its next round
        return submit_next(r);
    r.state = "started";
    const std::int64_t now = options_.now_ns();
    r.started_ns = at_ns.value_or(now);
    stroke_report how;
    if (r.requested_ns)
        how.late_s = std::max(0.0, seconds(*r.started_ns - *r.requested_ns));
    send_stroke_event(r, "started", how);
    start_followers(r, *r.started_ns);
    submit_next(r);
}

// Submits the other strokes of an armed file. Their times depend on the start of the first stroke.
void service::start_followers(stroke_record& first, std::int64_t at_ns)
{
    player* out = find_player(first);
    for (const auto& [number, after_s] : std::exchange(first.followers, {})) {
        const auto found = strokes_.find(number);
        if (found == strokes_.end() || !found->second.submits_later)
            continue;
        stroke_record& r = found->second;
        if (r.ended_by != nullptr) { // it was stopped after the first stroke began
            finish(r, {.state = state_kind::cancelled});
            continue;
        }
        const score later = *std::exchange(r.submits_later, {});
        std::string why = "the stream has ended";
        if (out != nullptr)
            try {
                add_submission(
                    r, out->submit(later, start_at::time(rt::to_time(at_ns + std::llround(after_s * 1e9))),
                                   level_db(r)));
                r.state = "waiting";
                continue;
            } catch (const error& e) {
                if (!out->ended())
                    why = e.what();
            } catch (const std::bad_alloc&) {
                why = "there is not enough memory for it";
            }
        finish(r, {.state = state_kind::interrupted, .reason = reason_kind::failed, .why = why});
    }
}

void service::handle_end(std::uint64_t player, const stroke_report& report)
{
    const auto found = by_player_.find({player, report.id});
    if (found == by_player_.end())
        return;
    stroke_record& r = strokes_.at(found->second);
    by_player_.erase(found);
    if (report.started_ns && r.state != "started" && report.frames != 0) {
        r.started_ns = report.started_ns;
        send_stroke_event(r, "started", {});
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
    if (whole.frames != r.frames) // the stroke began in an earlier round
        whole.started_ns = r.started_ns;
    whole.frames = r.frames;
    finish(r, whole);
    update_busy();
}

// Records a submission of a stroke.
void service::add_submission(stroke_record& r, stroke_id id)
{
    r.open.push_back(id);
    by_player_[{r.player, id}] = r.number;
}

// Records the stream frame in which the request of a planned stroke began.
void service::note_beginning(stroke_record& r, stroke_id id)
{
    const player* out = find_player(r);
    if (out == nullptr || r.live)
        return;
    const auto frame = out->first_frame(id);
    if (!frame)
        return;
    submissions& all = r.rounds;
    const auto newer = static_cast<std::uint64_t>(r.open.end() - std::find(r.open.begin(), r.open.end(), id));
    const std::uint64_t before = all.offset + (all.newest + 1 - newer) * all.frames;
    if (const std::uint64_t first = frame.value(); first >= before)
        all.begun = first - before;
}

// Returns the strokes of r's request that have not ended.
std::vector<service::stroke_record*> service::find_request_strokes(const stroke_record& r)
{
    std::vector<stroke_record*> found;
    for (auto at = strokes_.lower_bound(r.request); at != strokes_.end(); ++at)
        if (at->second.request == r.request && at->second.state != "ended")
            found.push_back(&at->second);
    return found;
}

// Makes the current submission the last one for all strokes of a request. If it ends too soon, the next
// submission is the last. Returns the first frame of the stream after it, or nothing if the request has not
// begun.
std::optional<std::uint64_t> service::end_request(const stroke_record& of)
{
    const std::vector<stroke_record*> strokes = find_request_strokes(of);
    const auto known = std::find_if(strokes.begin(), strokes.end(),
                                    [](const stroke_record* r) { return r->rounds.begun.has_value(); });
    const player* out = find_player(of);
    std::uint64_t last = 0;
    std::optional<std::uint64_t> end;
    if (known != strokes.end() && out != nullptr) {
        const submissions& any = (*known)->rounds;
        const stream_setup& s = out->setup();
        const std::uint64_t reached =
            out->stats().frames + s.buffer_frames + std::uint64_t{3} * s.period_frames;
        last = any.last.value_or(any.again && reached > *any.begun ? (reached - *any.begun) / any.frames : 0);
        end = *any.begun + (last + 1) * any.frames;
    }
    for (stroke_record* r : strokes) {
        r->rounds.last = last;
        // The player reports the start of a submission before it is heard. Therefore several submissions may
        // still have to be removed.
        for (; r->rounds.newest > last && r->open.size() > 1; --r->rounds.newest) {
            r->next_waits = true;
            end_rounds(*r);
        }
    }
    return end;
}

// Calls end_request() for several requests. Returns the first frame after all of them.
std::uint64_t service::end_requests(client_number owner, const std::vector<std::uint32_t>& numbers)
{
    const client* c = clients_.find(owner);
    std::uint64_t end = 0;
    for (const std::uint32_t n : numbers) {
        if (c == nullptr || find_own_stroke(*c, n).live)
            refuse_unknown_stroke(n);
        const auto own = end_request(strokes_.at(n));
        if (!own)
            refuse_unknown_stroke(n, "it has not begun, or its stream has ended");
        end = std::max(end, *own);
    }
    return end;
}

// Prevents further rounds. Removes the newest submission if it is a round that has not begun.
void service::end_rounds(stroke_record& r)
{
    r.rounds.again.reset();
    if (!std::exchange(r.next_waits, false))
        return;
    if (player* p = find_player(r))
        p->cancel(r.open.back());
    by_player_.erase({r.player, r.open.back()});
    r.open.pop_back();
}

void service::finish(stroke_record& r, const stroke_report& how)
{
    // Followers of a stroke that did not begin end with it.
    for (const auto& [number, after_s] : std::exchange(r.followers, {}))
        if (const auto f = strokes_.find(number); f != strokes_.end() && f->second.submits_later) {
            stroke_report same = how;
            same.frames = 0;
            same.started_ns.reset();
            f->second.ended_by = r.ended_by;
            finish(f->second, same);
        }
    if (how.started_ns)
        r.started_ns = how.started_ns;
    r.submits_later.reset();
    const client_number owner = r.owner;
    if (client* c = clients_.find(owner)) {
        c->strokes.erase(r.number);
        if (r.live)
            --c->live;
    }
    r.state = "ended";
    touches_due_.erase(r.number);
    if (r.touched)
        send_touch_event(r, false);
    stroke_report report = how;
    report.why = reason(r, how);
    if (options_.log)
        options_.log(log_kind::info,
                     session::stroke_text(describe_for_log(r), report, options_.plans.owner.render.rate));
    send_stroke_event(r, to_string(report.state), report);
    if (r.released)
        strokes_.erase(r.number);
    clients_.check_all_sent(owner);
}

// Stores facts about a stroke for its line in the log.
void service::set_log_details(stroke_record& r, std::string_view name, const render_options& o)
{
    r.name = name;
    r.is_sl = o.sl_db.has_value();
    r.requested_db = o.sl_db.value_or(o.level_dbfs);
}

// Returns the description of a stroke for the log: 7 "park2016-1" at -12 dBFS of client 3 "pad"
// (192.168.1.7).
std::string service::describe_for_log(const stroke_record& r)
{
    std::string text = fmt::format("{}", r.number);
    if (!r.name.empty())
        text += fmt::format(" \"{}\" at {} {}", net::truncate_echo(r.name),
                            plain_number(r.requested_db + level_db(r), 4), r.is_sl ? "dB SL" : "dBFS");
    text += fmt::format(" of client {}", r.owner);
    const client* const c = clients_.find(r.owner);
    if (c != nullptr && !c->name.empty())
        text += fmt::format(" \"{}\"", c->name);
    if (c != nullptr && !c->from.empty())
        text += fmt::format(" ({})", c->from);
    return text;
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

// Considers only strokes: a request that waits for the stream wakes the stream itself.
void service::update_busy()
{
    stream_.set_has_strokes(std::any_of(strokes_.begin(), strokes_.end(),
                                        [](const auto& r) { return r.second.state != "ended"; }));
}

service::stroke_record& service::find_own_stroke(const client& c, std::uint32_t number)
{
    if (!c.strokes.contains(number))
        refuse_unknown_stroke(number);
    return strokes_.at(number);
}

} // namespace tactor::server
