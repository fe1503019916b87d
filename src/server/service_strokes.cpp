// SPDX-License-Identifier: MIT
// play, plan, drive, cancel, stop, fire.
#include <algorithm>
#include <cmath>
#include <utility>

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include "server/clock.hpp"
#include "server/service_impl.hpp"

namespace tactor::server {
namespace {

using net::json;
using net::reply_json;

constexpr double longest_wait_s = 86400.0;

// "now" is no time, "armed" waits for fire.
struct start_wish {
    bool armed = false;
    std::optional<std::int64_t> at_ns = {};
};

// Line ends within texts of JSON are escaped: these are blanks.
std::string on_one_line(std::string json_text)
{
    std::replace(json_text.begin(), json_text.end(), '\n', ' ');
    return json_text;
}

start_wish read_start(const json* start, std::int64_t now_ns)
{
    constexpr const char* forms = R"("now", "armed", {"delay_s":S}, {"monotonic_s":S} or {"unix_s":S})";
    if (start == nullptr || *start == "now")
        return {};
    if (*start == "armed")
        return {true, {}};
    if (!start->is_object() || start->size() != 1)
        bad_param("start", "it is not known", forms);
    const std::string name = start->begin().key();
    const json& value = start->begin().value();
    const std::string what = "start." + name;
    const double most_s = 9e9; // a time of day for centuries
    if (name == "delay_s")
        return {false, now_ns + std::llround(number(value, what, 0.0, longest_wait_s) * 1e9)};
    if (name != "monotonic_s" && name != "unix_s")
        bad_param(what, "it is not known", forms);
    std::int64_t at = std::llround(number(value, what, 0.0, most_s) * 1e9);
    if (name == "unix_s")
        at += now_ns - unix_ns();
    if (static_cast<double>(at - now_ns) * 1e-9 > longest_wait_s)
        bad_param(what, "it is more than a day ahead", forms);
    return {false, at};
}

} // namespace

void service::check_free_place(const client& c) const
{
    const std::size_t most = options_.limits.max_strokes;
    if (c.strokes.size() + c.coming >= most)
        limit_reached("max_strokes", fmt::format("{} strokes of yours go on", most),
                      "try again when one has ended");
    // Those of clients that have gone count here.
    if (strokes_.size() + jobs_ >= most * options_.limits.max_clients)
        limit_reached("max_strokes", "there are too many strokes of all clients", "try again later");
}

void service::plan_or_play(client& c, const json& params, const answer& to, bool play, std::size_t bytes)
{
    only(params, {"stroke", "path", "points", "toml", "csv", "svg", "options", "start"});
    static_cast<void>(source_of(params));
    static_cast<void>(read_start(member(params, "start"), options_.now_ns()));
    if (const json* o = member(params, "options"))
        static_cast<void>(with_options(options_.plans.owner, *o, options_for::planned));
    if (closing_)
        no_stream("the server ends");
    check_free_place(c);
    if (play && stream_.is_out())
        no_stream(stream_.reason());
    if (planning_bytes_ + bytes > options_.limits.max_all_unread_bytes)
        limit_reached("max_all_unread_bytes", "too much waits to be planned");
    planning_bytes_ += bytes;
    ++jobs_;
    ++c.coming;
    c.jobs.push_back({to, params, bytes, play, stops_});
    note_busy();
    if (!c.planning)
        next_job(c);
}

// One of each client at a time: who has many does not keep the others waiting.
void service::next_job(client& c)
{
    if (c.jobs.empty())
        return;
    plan_job job = std::move(c.jobs.front());
    c.jobs.pop_front();
    c.planning = job.to;
    post_job(c.number, std::move(job));
}

void service::post_job(client_number number, plan_job j)
{
    auto job = std::make_shared<plan_job>(std::move(j));
    boost::asio::post(planner_, [this, number, job] {
        std::shared_ptr<planned> p;
        std::vector<score> scores;
        std::string text;
        std::optional<net::rpc_fault> fault;
        try {
            p = std::make_shared<planned>(make_planned(options_.plans, faces_, job->params));
            for (std::size_t i = 0; job->play && i < p->plans.size(); ++i)
                scores.push_back(p->score_of(options_.plans.tactors, i));
            if (!job->play)
                text = on_one_line(options_.plan_text(*p, options_.limits.max_unread_bytes / 2));
        } catch (const std::bad_alloc&) {
            fault = net::rpc_fault{net::code_limit, "limit", "plan", "it is too large to be sent",
                                   "draw less, or plan it with the tool"};
        } catch (...) {
            fault = current_fault("params");
        }
        boost::asio::post(io_, [this, number, job, p, scores = std::move(scores), text = std::move(text),
                                fault = std::move(fault)]() mutable {
            job_done(number, *job, std::move(p), std::move(scores), std::move(text), std::move(fault));
        });
    });
}

void service::job_done(client_number number, const plan_job& job, std::shared_ptr<planned> p,
                       std::vector<score> scores, std::string text, std::optional<net::rpc_fault> fault)
{
    planning_bytes_ -= job.bytes;
    --jobs_;
    client* c = find(number);
    if (c != nullptr)
        c->planning.reset();
    if (closing_ && !fault)
        fault = net::rpc_fault{net::code_no_stream, "not-available", "stream", "the server ends", ""};
    if (fault || !job.play) {
        if (c != nullptr)
            --c->coming;
        if (fault)
            job.to.fault(*fault);
        else
            job.to.result_text(text);
    } else {
        // The stream may have to be started first.
        stream_.when_ready([this, number, job, p, scores = std::move(scores)] {
            if (client* then = find(number))
                --then->coming;
            submit_all(job, p, scores);
            note_busy();
        });
    }
    note_busy();
    c = find(number);
    if (c != nullptr && !c->planning)
        next_job(*c);
}

void service::submit_all(const plan_job& job, const std::shared_ptr<planned>& p,
                         const std::vector<score>& scores)
{
    try {
        const client_number number = job.to.all->to;
        if (const client* c = find(number);
            c != nullptr && scores.size() > 1 &&
            c->strokes.size() + c->coming + scores.size() > options_.limits.max_strokes)
            limit_reached("max_strokes",
                          fmt::format("{} strokes are more than the {} that a client may have at once",
                                      scores.size(), options_.limits.max_strokes),
                          "send fewer");
        const json* start = member(job.params, "start");
        const auto numbers =
            submit(number, start == nullptr ? json("now") : *start, *p, scores, job.stops != stops_);
        job.to.result({{"stroke", numbers.front()},
                       {"strokes", numbers},
                       {"total_s", p->total_s()},
                       {"warnings", p->warnings()}},
                      numbers);
    } catch (...) {
        job.to.fault(current_fault("stream"));
    }
}

std::vector<std::uint32_t> service::submit(client_number owner, const json& start, const planned& p,
                                           const std::vector<score>& scores, bool stopped)
{
    if (closing_)
        no_stream("the server ends");
    player* out = stream_.current();
    if (out == nullptr || out->ended())
        no_stream(stream_.reason());
    const std::int64_t now = options_.now_ns();
    const start_wish wish = read_start(&start, now);
    const std::vector<double> starts = p.starts_s();
    const stream_setup& s = out->setup();
    // Several strokes keep their distances: from a time that the first can be sure to reach.
    const auto lead_ns = std::int64_t{1'000'000'000} * (s.buffer_frames + 3 * s.period_frames) / s.rate;
    const std::int64_t base_ns = wish.at_ns.value_or(now + lead_ns);
    const auto first =
        static_cast<std::size_t>(std::min_element(starts.begin(), starts.end()) - starts.begin());
    std::vector<std::uint32_t> numbers;
    std::vector<stroke_record*> records;
    std::vector<std::string> refused(scores.size());
    for (std::size_t i = 0; i < scores.size(); ++i) {
        stroke_record& r = add_record(owner);
        numbers.push_back(r.number);
        records.push_back(&r);
        r.player = stream_.number();
        if (stopped)
            continue;
        if (wish.armed && i != first) {
            r.music = scores[i];
            continue;
        }
        const std::int64_t at = base_ns + std::llround(starts[i] * 1e9);
        start_at when = start_at::now();
        if (wish.armed)
            when = start_at::trigger();
        else if (wish.at_ns || scores.size() > 1) {
            when = start_at::time(at);
            if (wish.at_ns)
                r.asked_ns = at;
        }
        try {
            r.id = out->submit(scores[i], when);
        } catch (const error& e) {
            refused[i] = e.what(); // as where the stream has just ended: its number ends with it, below
            continue;
        }
        r.state = wish.armed ? "armed" : "waiting";
        by_player_[{r.player, r.id}] = r.number;
    }
    for (std::size_t i = 0; i < records.size(); ++i)
        if (records[i]->music)
            records[first]->followers.emplace_back(records[i]->number, starts[i] - starts[first]);
    const auto end = out->ended();
    for (std::size_t i = 0; i < records.size(); ++i)
        if (records[i]->id == stroke_id{} && !records[i]->music)
            finish(*records[i], stopped ? stroke_report{.state = state_kind::cancelled, .why = "stopped"}
                                        : stroke_report{.state = state_kind::interrupted,
                                                        .reason = end ? end->reason : reason_kind::failed,
                                                        .why = end ? end->why : refused[i]});
    return numbers;
}

void service::drive(client& c, const json& params, const answer& to)
{
    auto p = std::make_shared<planned>(make_drive(options_.plans, params));
    const json start = params.value("start", json("now"));
    static_cast<void>(read_start(&start, options_.now_ns()));
    check_free_place(c);
    if (closing_ || stream_.is_out())
        no_stream(stream_.reason());
    ++c.coming;
    note_busy();
    const std::vector<score> scores{p->score_of(options_.plans.tactors, 0)};
    stream_.when_ready([this, number = c.number, to, p, scores, start, stops = stops_] {
        if (client* then = find(number))
            --then->coming;
        try {
            const auto numbers = submit(number, start, *p, scores, stops != stops_);
            to.result({{"stroke", numbers.front()}}, numbers);
        } catch (...) {
            to.fault(current_fault("stream"));
        }
        note_busy();
    });
}

void service::cancel(client& c, const json& params, const answer& to)
{
    only(params, {"stroke"});
    const std::uint32_t n = need_stroke(params);
    if (!c.strokes.contains(n))
        no_such_stroke(n);
    stroke_record& r = *strokes_.at(n);
    to.result(reply_json::object());
    if (r.music) {
        // It waits for another to begin.
        finish(r, {.state = state_kind::cancelled});
        return;
    }
    if (player* p = stream_.current(); p != nullptr && r.player == stream_.number())
        p->cancel(r.id);
}

void service::stop(const json& params, const answer& to)
{
    only(params, {});
    ++stops_;
    player* p = stream_.current();
    std::vector<std::uint32_t> all;
    for (const auto& [number, r] : strokes_)
        all.push_back(number);
    for (const std::uint32_t n : all) {
        const auto found = strokes_.find(n);
        if (found == strokes_.end())
            continue;
        stroke_record& r = *found->second;
        if (r.music)
            finish(r, {.state = state_kind::cancelled, .why = "stopped"});
        else if (p != nullptr && r.player == stream_.number())
            p->cancel(r.id);
    }
    if (stopped_)
        stopped_();
    to.result(reply_json::object());
}

void service::fire(const json& params, const answer& to)
{
    only(params, {});
    player* p = stream_.current();
    if (p == nullptr)
        no_stream(stream_.reason());
    const std::size_t n = p->fire(options_.now_ns());
    for (const auto& [number, r] : strokes_)
        if (r->state == "armed" && r->player == stream_.number() && !r->music)
            r->state = "waiting";
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
