// SPDX-License-Identifier: MIT
#include <cmath>
#include <functional>
#include <numbers>

#include <fmt/format.h>

#include "core/words.hpp"
#include "study/data/text_table.hpp"
#include "study/results/cells.hpp"
#include "study/results/measures.hpp"
#include "study/results/model.hpp"
#include "study/tasks/task.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

class same_or_different final : public task {
public:
    same_or_different()
        : task({.name = "same-different",
                .trial = "Two stimuli, one after the other",
                .response = "Answer of the participant: 1 the stimuli are the same, 2 they differ",
                .questions = {"Were both the same?", "Were both the same?", "Were both the same?"},
                .keys = {"choices", "feedback"},
                .sections = {"has_dprime", "has_differences"}})
    {
    }

    void check(const detail::toml_table& t, const run_outline& o) const override
    {
        if (o.methods.size() != 2)
            t.fail(fmt::format("run \"{}\" needs two methods, but has {}", o.name,
                               counted(o.methods.size(), "method")),
                   "name two under methods");
    }
    void read(const detail::toml_table& t, run_definition& r) const override
    {
        refuse_method_blocks(t, r.outline);
    }
    std::vector<std::string> default_choices(const page_words& w) const override
    {
        return {w["same"], w["different"]};
    }

    std::vector<planned_trial> list_cells(const run_definition& r) const override
    {
        std::vector<planned_trial> cells;
        for (const std::size_t motion : r.motions)
            for (const std::size_t first : r.methods)
                for (const std::size_t second : r.methods)
                    cells.push_back({motion, first, second});
        return cells;
    }

    void read_row(trial& r, const text_table& t, std::size_t row, const run_outline& o) const override
    {
        r.method_1 = find_place(t, row, "method_1", o.methods);
        r.method_2 = find_place(t, row, "method_2", o.methods);
        score(r, o, {}, read_response(t, row));
    }
    void score(trial& r, const run_outline& o, std::string_view method_1,
               const trial_answer& answer) const override
    {
        task::score(r, o, method_1, answer);
        r.positive = r.response == 2;
        r.signal = r.method_1 != r.method_2;
    }

    std::optional<bool> was_right(const experiment_definition&, const run_definition&, const planned_trial& t,
                                  const trial_answer& answer) const override
    {
        return (answer.number == 2) == (t.method_1 != *t.method_2);
    }

    trial_answer simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        if (const auto key = draw_lapse(who, r))
            return *key;
        // Felt difference, in units of d', above which the observer answers "different".
        constexpr double criterion = std::numbers::sqrt2;
        const double apart = t.method_1 != *t.method_2 ? find_dprime(who, t) : 0.0;
        return std::abs(apart + r.normal() - r.normal()) > criterion ? 2 : 1;
    }

    // Results.

    std::vector<named_value> measure(const run_outline&, const std::vector<trial>& trials,
                                     sigmoid) const override
    {
        return list_sensitivity(measure_detection(trials, same_different_sensitivity));
    }

    std::vector<std::vector<result_outline>> outline_results() const override
    {
        return {outline_figure_results({{{"dprime"}, outline_figures<sensitivities>()}})};
    }

    std::vector<result> analyse(const run_outline& o, const run_people& people, sigmoid) const override
    {
        const auto measure = [&](const condition_trials& c) {
            const auto detect = [](const std::vector<trial>& trials) {
                return measure_detection(trials, same_different_sensitivity);
            };
            return measure_by_ratio(sensitivities{}, o, c, people, detect, list_sensitivity, test_difference);
        };
        return analyse_conditions(o, people, {}, 0.0, "dprime", "Sensitivity", measure);
    }

    bool has_one_method(const run_outline&) const override { return false; }

    main_comparison name_comparison(const run_outline&) const override
    {
        return make_comparison("dprime", "likelihood ratio", 0.0);
    }

    compared_person compare(const run_outline&, const std::vector<trial>& trials) const override
    {
        const auto d = measure_detection(trials, same_different_sensitivity);
        return {{}, d ? std::optional(d->counts) : std::nullopt};
    }

    compared test(const run_outline&, std::span<const compared_person> people,
                  std::string_view seed) const override
    {
        const auto difference =
            test_difference(list_present_values(people, std::mem_fn(&compared_person::counts)), seed);
        return {difference ? std::optional(difference->p) : std::nullopt, true};
    }

    std::string format_r_model(const run_outline& o, const model_factors& f) const override
    {
        return format_model_call(o, f, {"glmer(positive", probit, "", "signal", false});
    }
};

} // namespace

const task& same_different_task()
{
    static const same_or_different one;
    return one;
}

} // namespace tactor::study
