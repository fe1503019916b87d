// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/split.hpp"
#include "core/words.hpp"
#include "study/data/text_table.hpp"
#include "study/results/cells.hpp"
#include "study/results/measures.hpp"
#include "study/results/model.hpp"
#include "study/tasks/task.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

class estimate final : public task {
public:
    estimate()
        : task({.name = "estimate",
                .trial =
                    "One stimulus, or a standard and then a stimulus, which the participant gives a number",
                .response = "The number above 0 that the participant gave",
                .keys = {"vary", "values", "standard", "trials_per_value"},
                .columns = {"intensity_estimate"},
                .sections = {"has_exponents"}})
    {
    }

    void read_outline(const detail::toml_table& t, run_definition& r) const override
    {
        run_outline& o = r.outline;
        read_values(t, o, read_vary(t, o));
        if (!o.on_db_axis && o.values.front() <= 0.0)
            t.fail("values", "an exponent needs values above 0", "leave the others out");
        read_trials(t, o);
    }

    std::vector<planned_trial> list_cells(const run_definition& r) const override
    {
        return list_value_cells(r, true);
    }

    trial_answers list_answers(const run_definition&, const page_words& w) const override
    {
        return {.possible = w["any_number"], .is_estimate = true};
    }
    void record_answer(trial_row& row, const run_definition& r, const trial_answer& answer) const override
    {
        task::record_answer(row, r, answer);
        row.intensity_estimate = answer.number;
    }
    std::vector<std::string> list_responses(const run_outline&) const override { return {}; }
    std::string name_response(const run_outline&, std::string_view) const override { return {}; }

    void read_row(trial& r, const text_table& t, std::size_t row, const run_outline& o) const override
    {
        read_comparison(r, t, row, o);
        r.estimate = read_either_column(t, row, properties().columns.front(), [&](std::string_view column) {
            const auto number = t.number(row, column); // R writes 100000 as 1e+05
            if (number && !(*number >= least_estimate && *number <= most_estimate))
                t.refuse(row, fmt::format("{} is \"{}\"", column, t.need(row, column)),
                         "give a number from 1e-11 to 1e12");
            return number;
        });
    }
    void score(trial& r, const run_outline&, std::string_view, const trial_answer& answer) const override
    {
        r.estimate = answer.number;
    }

    trial_answer simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        constexpr double modulus = 100.0; // estimate for the standard, or for the middle value
        const run_outline& o = who.run.outline;
        const double middle = o.standard.value_or(o.values[o.values.size() / 2]);
        const double ratio = size_ratio(o, find_value(who.definition, t).value(), middle);
        const double number =
            modulus * std::pow(ratio, find_exponent(who, t)) * std::exp(who.truth.sigma * r.normal());
        const auto rounded = detail::parse_number_text<double>(fmt::format("{:.3g}", number));
        return std::clamp(rounded.value_or(number), least_estimate, most_estimate);
    }

    // Results.

    std::vector<named_value> measure(const run_outline& o, const std::vector<trial>& trials,
                                     sigmoid) const override
    {
        return list_exponent(fit_exponent(o, trials));
    }

    std::vector<std::vector<result_outline>> outline_results() const override
    {
        return {outline_figure_results({{{"exponent"}, outline_figures<exponents>()}})};
    }

    std::vector<result> analyse(const run_outline& o, const run_people& people, sigmoid) const override
    {
        const auto fit = [&](const std::vector<trial>& trials, const std::string&) {
            return fit_exponent(o, trials);
        };
        return analyse_conditions(o, people, o.methods, 1.0, "exponent",
                                  "Exponents of the estimates over " + o.vary,
                                  [&](const condition_trials& c) {
                                      return measure_people(exponents{}, c, people, 1.0, fit, list_exponent);
                                  });
    }

    main_comparison name_comparison(const run_outline&) const override
    {
        return make_comparison("exponent", "t", 1.0);
    }

    std::vector<std::string_view> list_columns(const run_outline&) const override
    {
        return {"value", "signal", "positive", "estimate"};
    }

    named_texts describe_trial(const trial& t, const run_outline& own, const run_outline&) const override
    {
        const std::string text = fmt::format("{}", t.estimate);
        return {{"method", own.methods[t.method_1]},
                {"response", text},
                {"value", fmt::format("{}", t.value)},
                {"signal", "1"},
                {"estimate", text}};
    }

    // The logarithm of an estimate is linear in a level in dB, and in the logarithm of any other value.
    std::string format_r_model(const run_outline& o, const model_factors& f) const override
    {
        const double middle = std::sqrt(o.values.front() * o.values.back());
        return format_model_call(
            o, f,
            {"lmer(log(estimate)", "", "",
             o.on_db_axis ? format_value_term(o)
                          : fmt::format("log(value / {})", plain_number(o.standard.value_or(middle), 12))});
    }
};

} // namespace

const task& estimate_task()
{
    static const estimate one;
    return one;
}

} // namespace tactor::study
