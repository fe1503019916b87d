// SPDX-License-Identifier: MIT
/// \file
/// A task whose answer chooses the comparison or the standard. Without a standard, the answer chooses one of
/// two words.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "study/data/text_table.hpp"
#include "study/results/measures.hpp"
#include "study/results/model.hpp"
#include "study/tasks/task.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {

class comparison_task : public task {
public:
    using task::task;

    void read(const detail::toml_table& t, run_definition& r) const override
    {
        if (!t.has("choices") && !r.outline.standard)
            t.fail("vary", "a run without a standard needs two words",
                   "add choices = [\"one\", \"two\"], or standard");
        for (const char* const key : {"feedback", "training"})
            if (t.has(key) && !r.outline.standard)
                t.fail(key,
                       fmt::format("{} needs a right answer, but a run without a standard has none", key),
                       fmt::format("leave out {}, or add standard", key));
    }

    // The stimulus with the greater value is the right answer. If both values are equal, no answer is right.
    std::optional<bool> was_right(const experiment_definition& d, const run_definition& r,
                                  const planned_trial& t, const trial_answer& answer) const override
    {
        const double value = find_value(d, t).value();
        if (value == *r.outline.standard)
            return {};
        const bool standard_first = d.methods[t.method_1].name == standard_name;
        return (answer.number == 2) == ((value > *r.outline.standard) == standard_first);
    }

    trial_answers list_answers(const run_definition& r, const page_words& w) const override
    {
        trial_answers a = task::list_answers(r, w);
        a.names_stimuli = r.outline.standard.has_value();
        return a;
    }

    void read_row(trial& r, const text_table& t, std::size_t row, const run_outline& o) const override
    {
        read_comparison(r, t, row, o);
        score(r, o, t.need(row, "method_1"), read_response(t, row));
    }
    void score(trial& r, const run_outline& o, std::string_view method_1,
               const trial_answer& answer) const override
    {
        task::score(r, o, method_1, answer);
        r.positive = is_positive_response(o, method_1, r.response);
    }

    trial_answer simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        return simulate_comparison(who, t, r);
    }

    // Results.

    std::vector<named_value> measure(const run_outline&, const std::vector<trial>& trials,
                                     sigmoid kind) const override
    {
        return list_pse(fit_comparisons(trials, kind, ""));
    }

    std::optional<interval_plan> plan_intervals(const run_outline& o, sigmoid kind) const override
    {
        if (!o.standard)
            return {};
        return interval_plan{
            "pse", "Time-order error: pse by the interval that held the standard, second minus first",
            [](const trial& t) { return t.positive == (t.response == 2); },
            [kind](const std::vector<trial>& trials) { return fit_comparisons(trials, kind, "").pse; }};
    }

    std::vector<std::vector<result_outline>> outline_results() const override
    {
        return {outline_figure_results({{{"psychometric"}, psychometric_functions{}}}, true)};
    }

    std::vector<result> analyse(const run_outline& o, const run_people& people, sigmoid kind) const override
    {
        return analyse_comparisons(o, people, kind);
    }

    main_comparison name_comparison(const run_outline& o) const override
    {
        return make_comparison("pse", "t", o.standard);
    }

    std::string format_r_model(const run_outline& o, const model_factors& f) const override
    {
        return format_model_call(o, f, {"glmer(positive", probit, "", format_value_term(o)});
    }
};

} // namespace tactor::study
