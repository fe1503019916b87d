// SPDX-License-Identifier: MIT
// play and plan: requests that wait, their turns, and their results.
#include <algorithm>
#include <utility>

#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include "core/words.hpp"
#include "server/service_impl.hpp"
#include "server/stroke_options.hpp"
#include "server/view/view.hpp"

namespace tactor::server {
namespace {

using net::json;

// Client of all requests that disconnected clients left behind: together they have one turn.
constexpr client_number nobody = 0;

// Replaces line ends, which are blanks here: JSON escapes them within texts.
std::string on_one_line(std::string json_text)
{
    std::replace(json_text.begin(), json_text.end(), '\n', ' ');
    return json_text;
}

// Estimates the size of the text or list that says what to draw, bytes.
std::size_t estimate_source_bytes(const json& source)
{
    constexpr std::size_t point_bytes = 16;
    const auto* text = source.get_ptr<const json::string_t*>();
    return text != nullptr ? text->size() : source.size() * point_bytes;
}

net::rpc_fault too_large_to_send()
{
    return {net::code_limit, "limit", "plan", "it is too large to be sent",
            "draw less, or plan it with the tool"};
}

net::rpc_fault no_room()
{
    return {net::code_limit, "limit", "max_all_unread_bytes", "too much waits to be read by clients",
            "try again later, or make it smaller"};
}

net::rpc_fault server_ends()
{
    return {net::code_no_stream, "not-available", "stream", "the server ends", ""};
}

net::rpc_fault outdated()
{
    return {net::code_limit, "limit", "draft", "outdated", ""};
}

} // namespace

service::planner_lane& service::lane_for(const plan_job& j) noexcept
{
    return *std::find_if(lanes_.begin(), lanes_.end() - 1, [&j](const planner_lane& l) {
        return j.bytes <= l.most_bytes && j.steps <= l.most_steps;
    });
}

void service::plan_or_play(client& c, json&& params, const answer& to, bool play, std::size_t bytes)
{
    if (play)
        allow_only(params, {"stroke", "path", "points", "toml", "csv", "svg", "options", "start", "gain_db",
                            "repeat"});
    else
        allow_only(params, {"stroke", "path", "points", "toml", "csv", "svg", "options", "start", "view",
                            "draft", "bins", "observer"});
    bytes = std::max(bytes, estimate_source_bytes(params[find_source(params)]));
    static_cast<void>(read_start(member(params, "start"), options_.now_ns()));
    static_cast<void>(settle_options(options_.plans.owner, params));
    std::optional<double> draft;
    if (const json* given = member(params, "draft"))
        draft = whole(*given, "draft", {0.0, 0x1p53});
    const json* start = member(params, "start");
    plan_job job{to, {}, start == nullptr ? json("now") : *start, bytes, play, mark(c)};
    job.view = read_view(params);
    job.draft = draft;
    if (const json* gain = member(params, "gain_db"))
        job.gain_db = number(*gain, "gain_db", {player::least_level_db, 0.0});
    if (const json* repeat = member(params, "repeat"))
        job.rounds =
            *repeat == json(true) ? 0 : static_cast<std::uint64_t>(whole(*repeat, "repeat", {1.0, 1e6}));
    job.params = std::move(params);
    admit_job(c, std::move(job));
}

void service::admit_job(client& c, plan_job j)
{
    if (closing_)
        no_stream("the server ends");
    check_free_place(c);
    if (j.play && stream_.is_out())
        no_stream(stream_.reason());
    if (planning_bytes_ + j.bytes > options_.limits.max_all_unread_bytes)
        limit_reached("max_all_unread_bytes", "too much waits to be planned");
    planning_bytes_ += j.bytes;
    ++jobs_;
    ++c.coming;
    queue_job(c.number, std::move(j));
}

void service::queue_job(client_number number, plan_job j)
{
    if (number == nobody && !j.play)
        return refuse(j, {net::code_no_stream, "not-available", "plan", "its client has gone", ""});
    if (j.draft && !outdate_drafts(number, j))
        return;
    planner_lane& lane = lane_for(j);
    std::deque<plan_job>& own = lane.queued[number];
    if (own.empty())
        lane.turns.push_back(number);
    own.push_back(std::move(j));
    next_job(lane);
}

// Refuses the older of this draft and one of its client that waits; one waits at most. Returns true if `j` is
// still to be queued.
bool service::outdate_drafts(client_number number, plan_job& j)
{
    for (planner_lane& lane : lanes_) {
        const auto own = lane.queued.find(number);
        if (own == lane.queued.end())
            continue;
        std::deque<plan_job>& jobs = own->second;
        const auto waits =
            std::find_if(jobs.begin(), jobs.end(), [](const plan_job& x) { return x.draft.has_value(); });
        if (waits == jobs.end())
            continue;
        const bool newer = *j.draft >= *waits->draft;
        const bool fits = j.bytes <= lane.most_bytes;
        if (newer)
            std::swap(*waits, j); // the new one has its turn: else a client that sends many never has one
        refuse(j, outdated());
        if (!newer || fits)
            return false;
        j = std::move(*waits);
        jobs.erase(waits);
        if (jobs.empty()) {
            lane.queued.erase(own);
            std::erase(lane.turns, number);
        }
        return true;
    }
    return true;
}

// Ends the count of a request without a stroke.
void service::uncount(const plan_job& j)
{
    forget_job(j);
    if (client* c = find(j.to.all->to))
        --c->coming;
}

void service::refuse(const plan_job& j, const net::rpc_fault& f)
{
    uncount(j);
    j.to.fault(f);
}

// Begins the next request, of each client in turn: a client with many does not keep the others waiting. A
// draft passes other requests; after each that did, the first of these comes.
void service::next_job(planner_lane& lane)
{
    if (lane.planning || lane.turns.empty())
        return;
    const auto is_draft = [&lane](client_number c) { return lane.queued.at(c).front().draft.has_value(); };
    auto turn = lane.turns.begin();
    if (!std::exchange(lane.passed, false))
        turn = std::find_if(turn, lane.turns.end(), is_draft);
    if (turn == lane.turns.end())
        turn = lane.turns.begin();
    lane.passed = turn != lane.turns.begin();
    const client_number number = *turn;
    lane.turns.erase(turn);
    const auto own = lane.queued.find(number);
    plan_job job = std::move(own->second.front());
    own->second.pop_front();
    if (own->second.empty())
        lane.queued.erase(own);
    else
        lane.turns.push_back(number);
    lane.planning = job.to;
    post_job(lane, std::move(job));
}

// Keeps the requests of a client that has gone: they are played.
void service::keep_jobs(client_number number)
{
    for (planner_lane& lane : lanes_) {
        auto own = lane.queued.extract(number);
        if (own.empty())
            continue;
        std::erase(lane.turns, number);
        for (plan_job& j : own.mapped())
            queue_job(nobody, std::move(j));
    }
}

// Ends the count of a request that no longer waits.
void service::forget_job(const plan_job& j)
{
    planning_bytes_ -= j.bytes;
    --jobs_;
}

// Refuses all requests when the server ends.
void service::refuse_jobs()
{
    ending_ = true;
    for (planner_lane& lane : lanes_) {
        lane.turns.clear();
        for (const auto& [number, jobs] : std::exchange(lane.queued, {}))
            for (const plan_job& j : jobs)
                refuse(j, server_ends());
        if (lane.planning)
            lane.planning->fault(server_ends());
    }
}

// Weighs a request. A planner calls it between reading the text and the work. Returns false if the work is
// for another lane.
bool service::weigh(plan_job& j, const planner_lane& in, const planning_work& w)
{
    constexpr double text_bytes = 64.0; // least size of a burst or a sample in tactor-plan/1
    constexpr double burst_bytes = 256.0;
    constexpr double plan_bytes = 1024.0; // of each further round
    const double rounds = std::max(1.0, static_cast<double>(j.rounds));
    const service_limits& l = options_.limits;
    j.steps = w.steps;
    const double least_bytes = j.view.kind == view_kind::full
                                   ? (w.bursts + w.samples) * text_bytes
                                   : least_view_bytes(j.view, w, options_.plans.tactors.tactors.size());
    if (!j.play && !j.make_text && least_bytes > static_cast<double>(l.max_unread_bytes) / 2.0)
        throw fault_error(too_large_to_send());
    if (rounds * w.bursts * burst_bytes + (rounds - 1.0) * plan_bytes >
        static_cast<double>(l.max_all_unread_bytes))
        limit_reached(
            "max_all_unread_bytes",
            fmt::format("its {:.0f} bursts take more memory than all requests may", rounds * w.bursts),
            rounds > 1.0 ? "repeat less, or with true until it is cancelled"
                         : "make it shorter, or the SOA longer");
    return &lane_for(j) == &in;
}

// Moves a request with a short text and much work, or a draft with less work than the one before, to the end
// of the queue for such work.
void service::move_up(planner_lane& from, plan_job&& j)
{
    if (ending_)
        return job_done(from, j, {}, {}, {}, server_ends());
    from.planning.reset();
    const client_number number = j.to.all->to;
    queue_job(find(number) != nullptr ? number : nobody, std::move(j));
    next_job(from);
}

// Returns the answer to plan. Throws std::bad_alloc if it is too large to be sent.
std::string service::answer_text(const planned& p, const view_choice& view) const
{
    const std::size_t most = options_.limits.max_unread_bytes / 2;
    return view.kind == view_kind::full ? on_one_line(options_.plan_text(p, most))
                                        : view_text(p, options_.plans.tactors, view, most);
}

void service::post_job(planner_lane& lane, plan_job j)
{
    auto job = std::make_shared<plan_job>(std::move(j));
    boost::asio::post(lane.thread, [this, &lane, job] {
        std::shared_ptr<planned> p;
        std::vector<score> scores;
        std::string text;
        std::optional<net::rpc_fault> fault;
        const auto go_on = [this] {
            if (ending_)
                throw fault_error(server_ends());
        };
        const planning_checks checks{go_on, [&](const planning_work& w) { return weigh(*job, lane, w); }};
        try {
            if (job->make_text)
                text = job->make_text(job->params, checks);
            else
                p = std::make_shared<planned>(make_planned(options_.plans, faces_, job->params, checks));
            if (p ? p->plans.empty() : text.empty())
                return boost::asio::post(io_, [this, &lane, job] { move_up(lane, std::move(*job)); });
            if (job->play)
                p->rounds = count_rounds(*job, *p);
            for (std::size_t i = 0; job->play && i < p->plans.size(); ++i) {
                go_on();
                scores.push_back(p->make_score(options_.plans.tactors, i));
            }
            if (p && !job->play)
                text = answer_text(*p, job->view);
            if (!text.empty())
                text = job->to.write_reply(text);
        } catch (const std::bad_alloc&) {
            fault = too_large_to_send();
        } catch (...) {
            fault = current_fault("params");
        }
        job->params = nullptr;
        boost::asio::post(io_, [this, &lane, job, p, scores = std::move(scores), text = std::move(text),
                                fault = std::move(fault)]() mutable {
            job_done(lane, *job, std::move(p), std::move(scores), std::move(text), std::move(fault));
        });
    });
}

void service::job_done(planner_lane& lane, const plan_job& job, std::shared_ptr<planned> p,
                       std::vector<score> scores, std::string text, std::optional<net::rpc_fault> fault)
{
    lane.planning.reset();
    const client_number number = job.to.all->to;
    if (closing_ && !fault)
        fault = server_ends();
    if (!fault && job.make_text) {
        const client* c = find(number);
        if (c != nullptr && text.size() >= c->link->room())
            fault = no_room();
    }
    if (fault) {
        refuse(job, *fault);
    } else if (!job.play) {
        uncount(job);
        job.to.whole_reply(std::move(text), job.make_text != nullptr);
    } else {
        forget_job(job);
        // The stream may have to be started first.
        once_ready(number, job.to, "stream", job.asked, [this, job, p, scores = std::move(scores)] {
            const std::shared_ptr<void> after(nullptr, [&](void*) {
                boost::asio::post(reader_, [p] {}); // which frees it
            });
            submit_all(job, *p, scores);
        });
    }
    next_job(lane);
}

// Returns how often strokes are played by one submission. What has no end is submitted again while the last
// one sounds, and that must be long enough.
std::uint64_t service::count_rounds(const plan_job& job, const planned& p) const
{
    constexpr double endless_s = 2.0;
    const double round_s = p.total_s();
    if (job.rounds == 0)
        return static_cast<std::uint64_t>(std::ceil(endless_s / round_s));
    const double all_s = static_cast<double>(job.rounds) * round_s;
    if (job.rounds > 1 && all_s > options_.plans.max_stroke_s)
        limit_reached("max_stroke_s",
                      fmt::format("{} times last {}, and at most {} are played", job.rounds,
                                  seconds_text(all_s), seconds_text(options_.plans.max_stroke_s)),
                      "repeat less, or with true until it is cancelled");
    return job.rounds;
}

void service::submit_all(const plan_job& job, const planned& p, const std::vector<score>& scores)
{
    const client_number number = job.to.all->to;
    if (const client* c = find(number);
        c != nullptr && scores.size() > 1 &&
        c->strokes.size() + c->coming + scores.size() > options_.limits.max_strokes)
        limit_reached("max_strokes",
                      fmt::format("{} strokes are more than the {} that a client may have at once",
                                  scores.size(), options_.limits.max_strokes),
                      "send fewer");
    const auto numbers = submit(number, job.start, p, scores, stop_reason_since(job.asked, number),
                                job.gain_db, job.rounds == 0);
    auto warnings = p.warnings();
    for (std::string& w : warnings)
        w = net::cut_echo(w);
    job.to.result(
        {{"stroke", numbers.front()}, {"strokes", numbers}, {"total_s", p.total_s()}, {"warnings", warnings}},
        numbers);
}

} // namespace tactor::server
