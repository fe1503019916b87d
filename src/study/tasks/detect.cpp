// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "study/data/text_table.hpp"
#include "study/results/cells.hpp"
#include "study/results/measures.hpp"
#include "study/results/model.hpp"
#include "study/tasks/task.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

std::optional<double> find_test_value(const run_outline& o)
{
    return o.vary.empty() && o.catches ? std::optional(0.0) : o.standard;
}

class detect final : public task {
public:
    detect()
        : task({.name = "detect",
                .trial = "One stimulus or none",
                .response = "Answer to the question of whether a stimulus was felt: 1 yes, 2 no",
                .questions = {"Did you feel it?", "Did you feel it?", "Did you feel it?"},
                .keys = {"choices", "feedback", "catch", "vary", "values", "trials_per_value"}})
    {
    }

    void read_outline(const detail::toml_table& t, run_definition& r) const override
    {
        run_outline& o = r.outline;
        r.catch_share = t.number("catch", {0.0, 0.9}).value_or(0.0);
        o.catches = r.catch_share > 0.0;
        if (o.catches)
            refuse_method_name(t, o, catch_name);
        if (t.has("vary"))
            read_values(t, o, read_vary(t, o));
        read_trials(t, o);
    }
    std::vector<std::string> default_choices(const page_words& w) const override
    {
        return {w["yes"], w["no"]};
    }

    std::vector<planned_trial> list_cells(const run_definition& r) const override
    {
        return list_value_cells(r, false);
    }

    void read_row(trial& r, const text_table& t, std::size_t row, const run_outline& o) const override
    {
        const bool is_silent = o.catches && t.need(row, "method_1") == catch_name;
        if (!is_silent && !o.vary.empty())
            read_comparison(r, t, row, o);
        else if (!is_silent)
            r.method_1 = find_place(t, row, "method_1", o.methods);
        else if (!o.vary.empty() && t.cell(row, "value"))
            t.refuse(row, "the trial has a value but no stimulus", "write n/a for the value");
        score(r, o, t.need(row, "method_1"), read_response(t, row));
    }
    void score(trial& r, const run_outline& o, std::string_view method_1,
               const trial_answer& answer) const override
    {
        task::score(r, o, method_1, answer);
        r.positive = r.response == 1;
        r.signal = !o.catches || method_1 != catch_name;
    }

    std::optional<bool> was_right(const experiment_definition& d, const run_definition&,
                                  const planned_trial& t, const trial_answer& answer) const override
    {
        return (answer.number == 1) != d.methods[t.method_1].silent;
    }

    trial_answer simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        if (const auto key = draw_lapse(who, r))
            return *key;
        const bool is_silent = who.definition.methods[t.method_1].silent;
        if (is_silent && !who.run.outline.vary.empty())
            return 2;
        if (find_value(who.definition, t))
            return feels_more(who, t, r) ? 1 : 2;
        // Uses one criterion for all methods, because all methods share the trials without a stimulus.
        std::vector<double> all;
        for (const std::size_t method : who.run.methods)
            all.push_back(find_dprime(who, {t.motion, method}));
        return (is_silent ? 0.0 : find_dprime(who, t)) + r.normal() > 0.5 * mean(all) ? 1 : 2;
    }

    // Results.

    std::vector<named_value> measure(const run_outline& o, const std::vector<trial>& trials,
                                     sigmoid kind) const override
    {
        std::vector<named_value> all;
        if (!o.vary.empty())
            all = list_threshold(fit_answers(trials, {kind}, ""));
        if (o.catches)
            for (named_value& v : list_sensitivity(measure_detection(trials, yes_no_sensitivity)))
                all.push_back(std::move(v));
        return all;
    }

    std::vector<std::vector<result_outline>> outline_results() const override
    {
        return {outline_figure_results({{{"psychometric"}, psychometric_functions{}, true},
                                        {{"dprime"}, outline_figures<sensitivities>(), true}})};
    }

    std::vector<result> analyse(const run_outline& o, const run_people& people, sigmoid kind) const override
    {
        const psychometric_functions begun{{}, {kind}, o.on_db_axis, "felt (%)"};
        const std::optional<double> against = find_test_value(o);
        std::vector<result> rows = begin_figure_results(o, against);
        std::vector<std::optional<double>> main;
        for (const condition_trials& c : split_conditions(o, people, o.methods)) {
            result functions = make_row(c, "psychometric", "Psychometric functions over " + o.vary, {});
            result differences = make_row(c, "dprime", "Sensitivity", {});
            if (!o.vary.empty()) {
                const auto fit = [&](const std::vector<trial>& trials, const std::string& code) {
                    return fit_answers(trials, {kind}, make_seed(o, c, code));
                };
                auto f = measure_people(begun, c, people, against, fit, list_threshold);
                main = c.name.empty() ? list_main_figures(f) : main;
                functions.value = std::move(f);
            }
            if (o.catches) {
                const auto fit = [](const std::vector<trial>& trials, const std::string&) {
                    return measure_detection(trials, yes_no_sensitivity);
                };
                auto d = measure_people(sensitivities{}, c, people, o.vary.empty() ? against : std::nullopt,
                                        fit, list_sensitivity);
                main = c.name.empty() && o.vary.empty() ? list_main_figures(d) : main;
                differences.value = std::move(d);
            }
            functions.is_main = c.name.empty() && !o.vary.empty();
            differences.is_main = c.name.empty() && o.vary.empty();
            rows.push_back(std::move(functions));
            rows.push_back(std::move(differences));
        }
        add_groups(rows, people, main);
        return rows;
    }

    bool is_silent(const trial& t) const override { return !t.signal; }

    main_comparison name_comparison(const run_outline& o) const override
    {
        return make_comparison(o.vary.empty() ? "dprime" : "threshold", "t", find_test_value(o));
    }

    std::string format_r_model(const run_outline& o, const model_factors& f) const override
    {
        return o.vary.empty() && o.catches
                   ? format_signal_call(o, f)
                   : format_model_call(o, f, {"glmer(positive", probit, "", format_value_term(o)});
    }

    std::vector<std::string_view> list_sections(const run_outline& o) const override
    {
        std::vector<std::string_view> all;
        if (!o.vary.empty())
            all.insert(all.end(), {"has_functions", "has_thresholds"});
        if (o.catches)
            all.insert(all.end(), {"has_dprime", "catches"});
        return all;
    }
};

} // namespace

const task& detect_task()
{
    static const detect one;
    return one;
}

} // namespace tactor::study
