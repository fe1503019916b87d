// SPDX-License-Identifier: MIT
// The requests play, plan, import and export, which planner threads handle, and their results.
#include "server/service.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/words.hpp"
#include "server/faults.hpp"
#include "server/files.hpp"
#include "server/params.hpp"

namespace tactor::server {
namespace {

using net::json;

// Replaces line ends by blanks. All of them are outside JSON strings, because strings contain line ends only
// as escapes.
std::string on_one_line(std::string json_text)
{
    std::replace(json_text.begin(), json_text.end(), '\n', ' ');
    return json_text;
}

net::rpc_fault too_large_fault()
{
    return {net::code_limit, "limit", "plan", "it is too large to send", "draw less, or plan with the tool"};
}

net::rpc_fault server_end_fault()
{
    return {net::code_no_stream, "not-available", "stream", "the server ends", ""};
}

net::rpc_fault outdated_fault()
{
    return {net::code_limit, "limit", "draft", "outdated", ""};
}

} // namespace

void service::add_job(client& c, net::rpc_request& r, const answer& to, std::size_t bytes)
{
    plan_job made{to, r.method, bytes, std::move(r.params)};
    read_job(made);
    if (ending_)
        refuse_without_stream("the server ends");
    check_free_place(c);
    if (made.plays() && stream_.is_unavailable())
        refuse_without_stream(stream_.reason());
    if (c.bytes + bytes > 2 * options_.limits.max_message_bytes)
        refuse_over_limit("max_message_bytes", "too many of your requests wait to be planned",
                          "try again after an answer");
    c.bytes += bytes;
    ++c.coming;
    ++jobs_;
    const auto job = std::make_shared<plan_job>(std::move(made));
    planners_.add(
        {.client = c.number,
         .work = [this, job] { run_job(*job); },
         .done = [this, job] { finish_job(job); },
         .drop = [this, job](bool old) { refuse(*job, old ? outdated_fault() : server_end_fault()); },
         .draft = job->draft,
         .outlives = job->plays()});
}

// Reads the parameters of play and plan, except the strokes. A planner thread reads the strokes, and the
// parameters of import and export.
void service::read_job(plan_job& j) const
{
    const json& params = j.params;
    if (j.is_file())
        return;
    j.values = resolve_options(options_.plans.owner, params);
    j.start = params.value("start", j.start);
    static_cast<void>(read_start(j.start, options_.now_ns()));
    if (params.contains("draft"))
        j.draft = params["draft"].get<double>();
    j.view = read_view(params);
    j.gain_db = params.value("gain_db", 0.0);
    if (params.contains("repeat"))
        j.rounds = params["repeat"].is_boolean() ? 0 : params["repeat"].get<std::uint64_t>();
    j.round_s = params.value("round_s", 0.0);
    j.pause_s = params.value("pause_s", 0.0);
    for (const auto& [name, value] : {std::pair("round_s", j.round_s), std::pair("pause_s", j.pause_s)})
        check_range(name, value, {0.0, options_.plans.max_stroke_s});
    j.held = params.value("held", false);
}

// Computes the result. Runs on a planner thread.
void service::run_job(plan_job& j)
{
    const auto go_on = [this] {
        if (ending_)
            throw fault_error(server_end_fault());
    };
    try {
        go_on();
        if (j.plays())
            make_scores(j, go_on);
        else
            j.text = j.to.format_reply(make_result_text(j, go_on));
    } catch (const std::bad_alloc&) {
        j.fault = too_large_fault();
    } catch (...) {
        j.fault = current_fault("params");
    }
    if (j.fault) {
        j.made.reset();
        j.scores.clear();
    }
    j.params = nullptr;
}

void service::make_scores(plan_job& j, const go_on_check& go_on)
{
    j.made = std::make_shared<planned>(plan_request(options_.plans, faces_, j.params, j.values, go_on));
    j.made->least_round_s = j.round_s;
    j.made->pause_s = j.pause_s;
    j.made->rounds = count_rounds(j, *j.made);
    for (std::size_t i = 0; i < j.made->plans.size(); ++i) {
        go_on();
        j.scores.push_back(j.made->make_score(options_.plans.tactors, i));
    }
}

std::string service::make_result_text(const plan_job& j, const go_on_check& go_on)
{
    if (j.method == "import")
        return import_strokes(options_.plans, faces_, j.params);
    if (j.method == "export")
        return export_strokes(options_, faces_, j.params, go_on);
    const std::size_t most = options_.limits.max_unread_bytes / 2;
    const planned p = plan_request(options_.plans, faces_, j.params, j.values, go_on);
    return j.view.kind == view_kind::full ? on_one_line(options_.plan_text(p, most))
                                          : view_text(p, options_.plans.tactors, j.view, most);
}

// Returns true if a file does not make the unread files of all clients too large. A file alone has room.
bool service::has_room_for(std::size_t bytes) const
{
    constexpr std::size_t most_bytes = std::size_t{96} << 20;
    std::size_t unread = 0;
    for (const auto& [number, c] : clients_.all())
        unread += c->link->file_bytes();
    return unread == 0 || unread + bytes <= most_bytes;
}

void service::finish_job(const std::shared_ptr<plan_job>& j)
{
    const client* c = clients_.find(j->to.all->to);
    if (ending_ && !j->fault)
        j->fault = server_end_fault();
    if (!j->fault && j->is_file() && c != nullptr && c->link->file_bytes() != 0)
        j->fault = net::rpc_fault{net::code_limit, "limit", "max_unread_bytes",
                                  "you have not read an earlier file yet", "try again after reading it"};
    if (!j->fault && j->is_file() && !has_room_for(j->text.size()))
        j->fault = net::rpc_fault{net::code_limit, "limit", "max_unread_bytes",
                                  "other clients have not read their files yet", "try again later"};
    if (j->fault)
        return refuse(*j, *j->fault);
    if (!j->plays()) {
        remove_from_counts(*j);
        return j->to.send_reply(std::move(j->text), j->is_file());
    }
    forget(*j);
    // The stream may not be running yet.
    run_when_ready(j->to, "stream", [this, j] {
        const std::shared_ptr<void> after(nullptr, [&](void*) {
            planners_.run_in_thread(
                [made = std::move(j->made), scores = std::move(j->scores)] {}); // freed on a planner thread
        });
        submit_all(*j);
    });
}

// Removes a request from the counts of waiting requests.
void service::forget(const plan_job& j)
{
    --jobs_;
    if (j.bytes > net::large_message)
        schedule_memory_trim();
    if (client* c = clients_.find(j.to.all->to))
        c->bytes -= j.bytes;
}

// Removes a request from all counts, because it has no strokes.
void service::remove_from_counts(const plan_job& j)
{
    forget(j);
    if (client* c = clients_.find(j.to.all->to))
        --c->coming;
}

void service::refuse(const plan_job& j, const net::rpc_fault& f)
{
    remove_from_counts(j);
    j.to.send_fault(f);
}

// Returns the number of rounds in one submission. An endless stroke is submitted again while its previous
// submission plays, so each submission must last long enough for that.
std::uint64_t service::count_rounds(const plan_job& job, const planned& p) const
{
    constexpr double endless_s = 2.0;
    const double round_s = p.round_s();
    if (job.rounds == 0) {
        const double rounds = std::ceil(endless_s / round_s);
        check_bursts(rounds * p.count_bursts(), "use a longer stroke, or a pause between its rounds");
        return static_cast<std::uint64_t>(rounds);
    }
    check_bursts(static_cast<double>(job.rounds) * p.count_bursts(),
                 "repeat less often, or use true and cancel the stroke later");
    const double all_s = static_cast<double>(job.rounds) * round_s;
    if (job.rounds > 1 && all_s > options_.plans.max_stroke_s)
        refuse_over_limit("max_stroke_s",
                          fmt::format("{} rounds last {}, but at most {} may play", job.rounds,
                                      seconds_text(all_s), seconds_text(options_.plans.max_stroke_s)),
                          "repeat less often, or use true and cancel the stroke later");
    return job.rounds;
}

void service::submit_all(const plan_job& job)
{
    const client_number number = job.to.all->to;
    const planned& p = *job.made;
    const std::vector<score>& scores = job.scores;
    if (const client* c = clients_.find(number);
        c != nullptr && scores.size() > 1 &&
        c->strokes.size() + c->coming + scores.size() > options_.limits.max_strokes)
        refuse_too_many_strokes(scores.size(), options_.limits.max_strokes);
    const char* ended_by = stop_reason_since(job.to);
    if (const client* c = clients_.find(number); job.held && (c == nullptr || c->input_over))
        ended_by = connection_ended;
    const auto numbers = submit(number, job.start, p, scores, ended_by, job.gain_db, job.rounds == 0);
    for (const std::uint32_t n : numbers)
        if (const auto found = strokes_.find(n); found != strokes_.end())
            found->second.ends_with_client = job.held;
    auto warnings = p.warnings();
    for (std::string& w : warnings)
        w = net::truncate_echo(w);
    net::reply_json reply{
        {"stroke", numbers.front()}, {"strokes", numbers}, {"total_s", p.total_s()}, {"warnings", warnings}};
    add_weakening(reply, p.weakened);
    job.to.send_result(reply, numbers);
}

} // namespace tactor::server
