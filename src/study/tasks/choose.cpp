// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstddef>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "study/data/text_table.hpp"
#include "study/results/cells.hpp"
#include "study/results/model.hpp"
#include "study/statistics/bradley_terry.hpp"
#include "study/tasks/balanced.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

// Lists the pairs of n methods, each pair in one order. The list is a cyclic design: in each group of n
// pairs, each method comes first once.
std::vector<planned_trial> list_pairs(std::size_t motion, const std::vector<std::size_t>& methods)
{
    const std::size_t n = methods.size();
    std::vector<planned_trial> all;
    for (std::size_t i = 0; i < n * (n - 1) / 2; ++i)
        all.push_back({motion, methods[i % n], methods[(i % n + i / n + 1) % n]});
    return all;
}

// Returns true if a run has three or more methods. Each method then has a row of cells and a worth.
bool has_several_methods(const run_outline& o)
{
    return o.methods.size() > 2;
}

std::size_t find_chosen_method(const trial& t)
{
    return t.response == 1 ? t.method_1 : t.method_2;
}

// Plans the percentage of trials in which people chose the last method. With three or more methods, plans for
// each method the percentage of the trials with this method in which people chose it.
cell_plan plan_choices(const run_outline& o)
{
    if (has_several_methods(o))
        return {o.methods,
                [](const trial& t) {
                    const bool first = t.response == 1;
                    return std::vector<std::pair<std::size_t, double>>{{t.method_1, first ? 100.0 : 0.0},
                                                                       {t.method_2, first ? 0.0 : 100.0}};
                },
                per_cents, 50.0, "chosen (% of its trials)"};
    return {{o.methods.back()},
            [last = o.methods.size() - 1](const trial& t) {
                return std::vector<std::pair<std::size_t, double>>{
                    {0, find_chosen_method(t) == last ? 100.0 : 0.0}};
            },
            per_cents,
            50.0,
            fmt::format("{} chosen (%)", o.methods.back())};
}

interval_share test_first_interval(const run_people& people)
{
    std::vector<double> shares;
    for (const person_trials& p : people.all)
        shares.push_back(100.0 * static_cast<double>(std::ranges::count(*p.trials, 1U, &trial::response)) /
                         static_cast<double>(p.trials->size()));
    return {test_mean(shares, 50.0)};
}

worth_list estimate_worths(const run_outline& o, const run_people& people)
{
    std::vector<std::vector<double>> wins(o.methods.size(), std::vector<double>(o.methods.size()));
    for (const person_trials& p : people.all)
        for (const trial& t : *p.trials)
            ++wins[find_chosen_method(t)][t.response == 1 ? t.method_2 : t.method_1];
    return {o.methods, fit_bradley_terry(wins)};
}

class choose final : public balanced_task {
public:
    choose()
        : balanced_task({.name = "choose",
                         .trial = "Two stimuli, one after the other; the participant chooses one",
                         .response = "Number of the chosen stimulus: 1 or 2",
                         .questions = {"Which of the two was more like the target?",
                                       "Which of the two was more even?", ""},
                         .keys = {"choices"}},
                        list_pairs)
    {
    }

    void check(const detail::toml_table& t, const run_outline& o) const override
    {
        if (o.methods.size() < 2)
            t.fail(fmt::format("run \"{}\" has one method to choose from", o.name),
                   "name two or more in methods");
    }
    void read(const detail::toml_table& t, run_definition& r) const override
    {
        t.need(t.text("attribute"), "attribute");
        refuse_method_blocks(t, r.outline);
    }

    trial_answers list_answers(const run_definition& r, const page_words& w) const override
    {
        trial_answers a = task::list_answers(r, w);
        a.names_stimuli = true;
        return a;
    }

    void read_row(trial& r, const text_table& t, std::size_t row, const run_outline& o) const override
    {
        read_pair(r, t, row, o);
        r.response = read_response(t, row);
    }

    void prepare(simulated_run& who) const override { prepare_judge(who); }
    trial_answer simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        const double first = judge(who, t.motion, t.method_1, r);
        return first >= judge(who, t.motion, t.method_2.value(), r) ? 1 : 2;
    }

    // Results.

    std::optional<cell_plan> plan_cells(const run_outline& o) const override { return plan_choices(o); }

    std::vector<std::vector<result_outline>> outline_results() const override
    {
        return {{{{"method"}, std::string()},
                 {{"preference"}, outline_cells(true)},
                 {{"first_interval"}, interval_share{}},
                 {{"anova"}, outline_effects({"motion"})},
                 {{"tukey"}, tukey_list{}},
                 outline_groups(false)},
                {{{"chosen", "*"}, outline_cells(true)},
                 {{"first_interval"}, interval_share{}},
                 {{"bradley_terry"}, worth_list{}}}};
    }

    std::vector<result> analyse(const run_outline& o, const run_people& people, sigmoid) const override
    {
        const cell_plan plan = plan_choices(o);
        const std::vector<cell_values> all = compute_all_cells(o, plan, people);
        const std::vector<cell_means> means = test_cells(o, plan, all);
        std::vector<result> rows;
        if (has_several_methods(o)) {
            // Rows of methods are not independent: each choice of one method is a loss for another.
            for (const cell_means& m : means)
                rows.push_back(
                    {{"chosen", m.method},
                     fmt::format("Per cent of the trials with {} in which people chose it, against 50",
                                 m.method),
                     m});
            rows.back().is_main = true;
            rows.push_back({{"first_interval"}, "", test_first_interval(people)});
            rows.push_back({{"bradley_terry"},
                            fmt::format("Worths (Bradley and Terry 1952) relative to {}, which has 0",
                                        o.methods.front()),
                            estimate_worths(o, people)});
            return rows;
        }
        rows.push_back({{"method"}, "", o.methods.back()});
        rows.push_back(
            {{"preference"},
             fmt::format("Per cent of trials in which people chose {}, against 50", o.methods.back()),
             means[0],
             true});
        rows.push_back({{"first_interval"}, "", test_first_interval(people)});
        rows.push_back({{"anova"}, "Analysis of variance", list_effects(o, all, false)});
        rows.push_back({{"tukey"}, "Tukey's comparisons of motions", compare_by_tukey(all, 0, means[0])});
        add_groups(rows, o, people, all, false);
        return rows;
    }

    std::vector<std::string> list_timed_methods(const run_outline&) const override { return {}; }

    main_comparison name_comparison(const run_outline& o) const override
    {
        return {fmt::format("{} chosen{}, t against 50 %", o.methods.back(),
                            has_several_methods(o) ? " in its trials" : ""),
                50.0, plan_choices(o).rounding()};
    }

    std::vector<std::string_view> list_columns(const run_outline& o) const override
    {
        return has_several_methods(o) ? std::vector<std::string_view>{"other"}
                                      : std::vector<std::string_view>{};
    }

    // `chosen` is 1 if the participant chose `method`. `method` is the last of two methods, or the method
    // that was felt first if the run has three or more methods.
    named_texts describe_trial(const trial& t, const run_outline& own,
                               const run_outline& whole) const override
    {
        const std::string& first = own.methods[t.method_1];
        const std::string& second = own.methods[t.method_2];
        const bool asks_first = has_several_methods(whole) || first == whole.methods.back();
        return {{"method", asks_first ? first : second},
                {"other", asks_first ? second : first},
                {"order", asks_first ? "0.5" : "-0.5"},
                {"response", fmt::format("{}", t.response)},
                {"chosen", (t.response == 1) == asks_first ? "1" : "0"}};
    }

    // The model of worths has a column for each method except the first: 1 if the method was felt first, -1
    // if it was felt second. The intercept is the preference for the first interval.
    std::string format_r_model(const run_outline& o, const model_factors& f) const override
    {
        if (!has_several_methods(o))
            return format_model_call(o, f, {"glmer(chosen", "family = binomial, ", "order + ", "", false});
        std::string others;
        for (std::size_t m = 1; m < o.methods.size(); ++m)
            others += (m > 1 ? ", " : "") + quote(o.methods[m]);
        const std::string factors = list_factors(o, f);
        return fmt::format("glmer(chosen ~ worth{} + (1 + worth{} | participant), family = binomial, "
                           "data = within(subset(d, run == {}), "
                           "worth <- sapply(c({}), function(m) (method == m) - (other == m))))",
                           factors == "1" ? "" : " + worth:" + factors,
                           f.session ? fmt::format(" + worth:{}", session_factor) : "", quote(o.name),
                           others);
    }

    std::string describe(const run_outline& o) const override
    {
        return fmt::format(
            "two stimuli of one motion, with {}, one after the other; the participant chose one",
            has_several_methods(o) ? fmt::format("two of {}", fmt::join(o.methods, ", "))
                                   : fmt::format("{}", fmt::join(o.methods, " and with ")));
    }

    std::vector<std::string_view> list_sections(const run_outline& o) const override
    {
        if (has_several_methods(o))
            return {"has_cells", "worths"};
        return {"has_cells"};
    }
};

} // namespace

const task& choose_task()
{
    static const choose one;
    return one;
}

} // namespace tactor::study
