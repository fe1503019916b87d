// SPDX-License-Identifier: MIT
#include "study/session/trials.hpp"

#include <algorithm>

#include <fmt/format.h>

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

} // namespace tactor::study
