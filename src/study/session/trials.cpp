// SPDX-License-Identifier: MIT
#include "study/session/trials.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "study/bids/acq_time.hpp"

namespace tactor::study {

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

void set_response(trial_row& row, const prepared_experiment& p, const run_definition& r, unsigned response)
{
    const bool named = r.outline.task == task_kind::identify;
    row.response = named ? p.definition.motions.at(response).name : fmt::format("{}", response);
    if (r.outline.task == task_kind::rate)
        row.rating = response;
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

run_table::run_table(session_store& store, const run_definition& r, bool practice)
    : store_(store), run_(r), practice_(practice)
{
    const std::vector<trial_row> rows = practice ? store.practice_rows(r) : store.rows(r);
    rows_ = rows.size();
    if (rows.empty())
        return;
    first_stream_ = rows.front().stream;
    first_frame_ = rows.front().frame_1;
    if (!practice)
        if (const auto text = store.acq_time(r))
            began_ns_ = acq_time_ns(*text);
}

void run_table::add(trial_row& row, std::int64_t started_ns, unsigned rate)
{
    if (rows_++ == 0) {
        first_stream_ = row.stream;
        first_frame_ = row.frame_1;
        began_ns_ = started_ns;
    }
    // Exact within a stream; over the gap between two of them by the clock of the day.
    if (row.frame_1 && first_frame_ && row.stream == first_stream_)
        row.onset_s = static_cast<double>(*row.frame_1 - *first_frame_) / rate;
    else if (row.frame_1 && began_ns_)
        row.onset_s = std::max(0.0, static_cast<double>(started_ns - *began_ns_) * 1e-9);
    if (practice_)
        store_.append_practice(run_, row);
    else
        store_.append(run_, row, acq_time_text(began_ns_.value_or(started_ns)));
}

} // namespace tactor::study
