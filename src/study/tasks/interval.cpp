// SPDX-License-Identifier: MIT
#include <algorithm>

#include <fmt/format.h>

#include "study/data/text_table.hpp"
#include "study/results/measures.hpp"
#include "study/results/model.hpp"
#include "study/statistics/psychometric_fit.hpp"
#include "study/tasks/adaptive.hpp"
#include "study/tasks/task.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

bool is_correct(const run_outline&, std::string_view method_1, unsigned response)
{
    return (response == 2) == (method_1 == catch_name);
}

// Returns the percentage of right answers.
std::optional<double> percent_right(const std::vector<trial>& trials)
{
    if (trials.empty())
        return {};
    return 100.0 * static_cast<double>(std::ranges::count(trials, true, &trial::positive)) /
           static_cast<double>(trials.size());
}

// Reads the values of a run without a procedure. Refuses keys that only a procedure has.
void read_fixed_values(const detail::toml_table& t, run_outline& o, const detail::bounds& b)
{
    for (const std::string_view key : procedure_keys)
        if (t.has(key))
            t.fail(key, fmt::format("{} does not apply to a run without a procedure", key),
                   fmt::format("leave out {}, or replace values with procedure", key));
    read_values(t, o, b);
}

class interval_choice final : public task {
public:
    interval_choice()
        : task({.name = "interval",
                .trial = "Two intervals, one with a stimulus and one with silence that is as long",
                .response = "Interval in which the participant felt the stimulus: 1 or 2",
                .questions = {"In which interval did you feel it?", "In which interval did you feel it?",
                              "In which interval did you feel it?"},
                .keys = add_procedure_keys({"feedback", "vary", "values", "trials_per_value"}),
                .columns = {"track"},
                .sections = {"has_functions", "has_intervals"},
                .has_silences = true})
    {
    }

    void read_outline(const detail::toml_table& t, run_definition& r) const override
    {
        refuse_method_name(t, r.outline, catch_name);
        const detail::bounds b = read_vary(t, r.outline);
        if (t.has("procedure") == t.has("values"))
            t.fail(t.has("values") ? "values" : "vary",
                   t.has("values") ? "the run has both values and procedure"
                                   : "the run has neither values nor procedure",
                   "give one of the two");
        if (t.has("procedure"))
            read_procedure(t, r, b, false);
        else
            read_fixed_values(t, r.outline, b);
        read_trials(t, r.outline);
    }

    std::vector<planned_trial> list_cells(const run_definition& r) const override
    {
        return r.outline.is_adaptive() ? list_track_cells(r) : list_value_cells(r, false);
    }
    std::unique_ptr<value_chooser> make_value_chooser(const run_definition& r) const override
    {
        return r.outline.is_adaptive() ? make_adaptive_chooser(r, is_correct) : task::make_value_chooser(r);
    }
    bool has_own_columns(const run_outline& o) const override { return o.is_adaptive(); }

    void read_row(trial& r, const text_table& t, std::size_t row, const run_outline& o) const override
    {
        read_comparison(r, t, row, o, catch_name);
        score(r, o, t.need(row, "method_1"), read_response(t, row));
    }
    void score(trial& r, const run_outline& o, std::string_view method_1,
               const trial_answer& answer) const override
    {
        task::score(r, o, method_1, answer);
        r.positive = is_correct(o, method_1, r.response);
    }

    std::optional<bool> was_right(const experiment_definition& d, const run_definition&,
                                  const planned_trial& t, const trial_answer& answer) const override
    {
        return (answer.number == 2) == d.methods[t.method_1].silent;
    }

    trial_answer simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        if (const auto key = draw_lapse(who, r))
            return *key;
        const bool silence_first = who.definition.methods[t.method_1].silent;
        const bool right = feels_more(who, t, r) || r.below(2) == 0;
        return right == silence_first ? 2 : 1;
    }

    // Results.

    std::vector<named_value> measure(const run_outline&, const std::vector<trial>& trials,
                                     sigmoid kind) const override
    {
        return list_threshold(fit_answers(trials, right_answers(kind), ""));
    }

    std::optional<interval_plan> plan_intervals(const run_outline&, sigmoid) const override
    {
        return interval_plan{
            "right",
            "Time-order error: right answers (%) by the interval that held the stimulus, second minus first",
            [](const trial& t) { return t.positive == (t.response == 1); }, percent_right};
    }

    std::vector<std::vector<result_outline>> outline_results() const override
    {
        return {outline_figure_results({{{"psychometric"}, psychometric_functions{}}}, true)};
    }

    std::vector<result> analyse(const run_outline& o, const run_people& people, sigmoid kind) const override
    {
        const psychometric_functions begun{{}, right_answers(kind), o.on_db_axis, "right (%)"};
        const auto measure = [&](const condition_trials& c) {
            const auto fit = [&](const std::vector<trial>& trials, const std::string& code) {
                return fit_answers(trials, begun.family, make_seed(o, c, code));
            };
            return measure_people(begun, c, people, {}, fit, list_threshold);
        };
        return analyse_conditions(o, people, o.methods, {}, "psychometric",
                                  "Psychometric functions over " + o.vary, measure);
    }

    main_comparison name_comparison(const run_outline&) const override
    {
        return make_comparison("threshold", "t", {});
    }

    std::string format_r_model(const run_outline& o, const model_factors& f) const override
    {
        return format_model_call(
            o, f,
            {"glmer(positive", "family = binomial(psyphy::mafc.probit(2)), ", "", format_value_term(o)});
    }
};

} // namespace

const task& interval_task()
{
    static const interval_choice one;
    return one;
}

} // namespace tactor::study
