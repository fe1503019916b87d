// SPDX-License-Identifier: MIT
#include "study/session/trials.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "session/interrupt.hpp"
#include "study/bids/study_folder.hpp"

namespace tactor::study {
namespace {

constexpr double pause_s = 0.5; // from an answer to what comes next

// Begin of a simulated session's clock: the year 2000, because its trials have no real time.
constexpr std::int64_t epoch_ns = 946684800LL * 1000000000LL;

class simulated_session {
public:
    simulated_session(const prepared_experiment& p, const simulation& s, session_store& store)
        : p_(p), simulation_(s), store_(store), flow_(make_flow(p, store, false))
    {
    }

    int hold()
    {
        go_to_end_of_lines();
        std::optional<run_tables> tables;
        std::optional<simulated_observer> who;
        for (session_step s = flow_.next(); s.what != step_kind::over; s = flow_.next()) {
            if (const int signal = stop_.poll())
                return signal;
            if (s.what == step_kind::introduce) {
                tables.emplace(store_, p_.run_at(s.run));
                who.emplace(simulation_, p_.definition, p_.run_at(s.run), p_.stimuli, p_.participant);
            }
            if (s.what == step_kind::rest)
                now_ += frames(p_.run_at(s.run).break_s);
            if (s.what != step_kind::trial) {
                flow_.go_on();
                continue;
            }
            const trial_row row = play(s, *who);
            tables->at(s).add(row, utc_ns(now_), p_.render.rate);
            pass(row);
            flow_.took(row.is_void);
        }
        return 0;
    }

private:
    std::uint64_t frames(double seconds) const
    {
        return static_cast<std::uint64_t>(std::llround(seconds * p_.render.rate));
    }

    std::int64_t utc_ns(std::uint64_t frame) const
    {
        const std::uint64_t rate = p_.render.rate;
        const auto microseconds = frame / rate * 1000000 + frame % rate * 1000000 / rate;
        return epoch_ns + static_cast<std::int64_t>(microseconds) * 1000;
    }

    // Sets the clock after a trial from its line alone: a session that goes on has nothing else.
    void pass(const trial_row& row)
    {
        now_ = row.frame_1.value_or(now_) + frames(row.duration_s) +
               frames(row.response_time_s.value_or(0.0)) + frames(pause_s);
    }

    // Sets the clock of a session that goes on.
    void go_to_end_of_lines()
    {
        for (const run_sequence& s : p_.runs) {
            const run_definition& r = p_.definition.runs[s.run];
            for (const trial_row& row : store_.practice_rows(r))
                pass(row);
            const std::vector<trial_row> rows = store_.rows(r);
            for (const trial_row& row : rows)
                pass(row);
            if (replay(p_, s, rows).done())
                now_ += frames(r.break_s);
        }
    }

    trial_row play(const session_step& s, const simulated_observer& who)
    {
        const run_definition& r = p_.run_at(s.run);
        const planned_trial& t = find_trial(p_, s);
        if (r.animation)
            now_ += frames(p_.definition.motions[t.motion].drawn.motion.duration_s());
        const simulated_answer a = who.answer(t, s.which.trial, s.which.attempt, s.practice);
        trial_row row = planned_row(p_, t, s.which);
        row.stream = 1;
        row.frame_1 = now_;
        if (t.method_2)
            row.frame_2 = now_ + p_.stimuli.second(t);
        row.is_void = a.is_void;
        row.xruns = a.is_void ? 1 : 0;
        if (!a.is_void)
            set_response(row, p_, r, a.response, a.response_time_ms * 1e-3);
        return row;
    }

    const prepared_experiment& p_;
    const simulation& simulation_;
    session_store& store_;
    session_flow flow_;
    session::interrupt stop_;
    std::uint64_t now_ = 0; ///< frame of the virtual stream
};

} // namespace

trial_row planned_row(const prepared_experiment& p, const planned_trial& t, const pending_trial& which)
{
    const experiment_definition& d = p.definition;
    trial_row row;
    row.trial = which.trial;
    row.attempt = which.attempt;
    row.duration_s = static_cast<double>(p.stimuli.frames(t)) / p.render.rate;
    row.motion = d.motions[t.motion].name;
    row.method_1 = d.methods[t.method_1].name;
    row.plan_1 = p.stimuli.at(t.motion, t.method_1).hash;
    if (t.method_2) {
        row.method_2 = d.methods[*t.method_2].name;
        row.plan_2 = p.stimuli.at(t.motion, *t.method_2).hash;
    }
    return row;
}

void set_response(trial_row& row, const prepared_experiment& p, const run_definition& r, unsigned response,
                  double time_s)
{
    const bool named = r.outline.task == task_kind::identify;
    row.response = named ? p.definition.motions.at(response).name : fmt::format("{}", response);
    if (r.outline.task == task_kind::rate)
        row.rating = response;
    row.response_time_s = time_s;
    row.early = time_s < r.min_response_s;
}

run_queue replay(const prepared_experiment& p, const run_sequence& s, const std::vector<trial_row>& rows)
{
    const std::string& run = p.definition.runs[s.run].outline.name;
    run_queue queue(s.trials.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const trial_row& row = rows[i];
        bool same = !queue.done();
        if (same) {
            const pending_trial next = queue.next();
            const trial_row planned = planned_row(p, s.trials[next.trial - 1], next);
            same = row.trial == next.trial && row.attempt == next.attempt && row.motion == planned.motion &&
                   row.plan_1 == planned.plan_1 && row.plan_2 == planned.plan_2;
        }
        if (!same)
            throw error(error_kind::bad_input, fmt::format("run {}: line {}", run, i + 2),
                        fmt::format("trial {}, attempt {} is not what comes there", row.trial, row.attempt),
                        "the table was changed, or is of another session");
        queue.take(row.is_void);
    }
    return queue;
}

bool finished(const prepared_experiment& p, const session_store& store)
{
    return std::all_of(p.runs.begin(), p.runs.end(), [&](const run_sequence& s) {
        return replay(p, s, store.rows(p.definition.runs[s.run])).done();
    });
}

session_flow make_flow(const prepared_experiment& p, const session_store& store, bool with_person)
{
    std::vector<flow_run> runs;
    for (const run_sequence& s : p.runs) {
        const run_definition& r = p.definition.runs[s.run];
        const auto practised = static_cast<unsigned>(store.practice_rows(r).size());
        runs.push_back({static_cast<unsigned>(s.practice.size()), practised, replay(p, s, store.rows(r)),
                        r.break_s > 0.0});
    }
    const bool consent = with_person && !p.definition.consent.empty() && !store.facts().contains("consent");
    const std::size_t walk = with_person ? p.where.tactors.tactors.size() : 0;
    return {std::move(runs), consent, static_cast<unsigned>(walk)};
}

const planned_trial& find_trial(const prepared_experiment& p, const session_step& s)
{
    const run_sequence& run = p.runs[s.run];
    return s.practice ? run.practice[s.which.trial - 1] : run.trials[s.which.trial - 1];
}

run_table::run_table(session_store& store, const run_definition& r, bool practice)
    : store_(store), run_(r), practice_(practice)
{
    const std::vector<trial_row> rows = practice ? store.practice_rows(r) : store.rows(r);
    if (rows.empty())
        return;
    empty_ = false;
    first_stream_ = rows.front().stream;
    first_frame_ = rows.front().frame_1;
    if (!practice)
        if (const auto text = store.acq_time(r))
            began_ns_ = acq_time_ns(*text);
}

void run_table::add(trial_row row, std::int64_t started_ns, unsigned rate)
{
    if (std::exchange(empty_, false)) {
        first_stream_ = row.stream;
        first_frame_ = row.frame_1;
        began_ns_ = started_ns;
    }
    // Exact within a stream; by the clock of the day over the gap between two streams.
    if (row.frame_1 && first_frame_ && row.stream == first_stream_)
        row.onset_s = static_cast<double>(*row.frame_1 - *first_frame_) / rate;
    else if (row.frame_1 && began_ns_)
        row.onset_s = std::max(0.0, static_cast<double>(started_ns - *began_ns_) * 1e-9);
    if (practice_)
        store_.append_practice(run_, row);
    else
        store_.append(run_, row, acq_time_text(began_ns_.value_or(started_ns)));
}

int simulate_session(const prepared_experiment& p, const simulation& s, session_store& store)
{
    return simulated_session(p, s, store).hold();
}

} // namespace tactor::study
