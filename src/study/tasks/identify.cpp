// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/words.hpp"
#include "study/data/text_table.hpp"
#include "study/results/cells.hpp"
#include "study/results/model.hpp"
#include "study/tasks/balanced.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

using paths = std::vector<std::vector<tactor::point>>; // points of each stroke

// Returns the mean distance between the paths of two motions. Compares the strokes in their order. If a
// motion has fewer strokes than the other, repeats its strokes.
double mean_distance(const paths& a, const paths& b)
{
    const std::size_t strokes = std::max(a.size(), b.size());
    double sum = 0.0;
    for (std::size_t s = 0; s < strokes; ++s) {
        const std::vector<tactor::point>& p = a[s % a.size()];
        const std::vector<tactor::point>& q = b[s % b.size()];
        for (std::size_t i = 0; i < p.size(); ++i)
            sum += std::hypot(q[i].x_mm - p[i].x_mm, q[i].y_mm - p[i].y_mm);
    }
    return sum / static_cast<double>(strokes * a.front().size());
}

double find_chance(const run_outline& o)
{
    return 100.0 / static_cast<double>(o.motions.size());
}

// Plans the percentage of right answers for each method, to be tested against chance.
cell_plan plan_right_answers(const run_outline& o)
{
    return {o.methods,
            [](const trial& t) {
                return std::vector<std::pair<std::size_t, double>>{
                    {t.method_1, t.response == t.motion ? 100.0 : 0.0}};
            },
            per_cents,
            find_chance(o),
            "correct (%)",
            "correct"};
}

std::vector<answer_counts> count_answers(const run_outline& o, const run_people& people)
{
    std::vector<answer_counts> all;
    for (const std::string& method : o.methods)
        all.push_back({method, o.motions,
                       std::vector<std::vector<std::size_t>>(o.motions.size(),
                                                             std::vector<std::size_t>(o.motions.size()))});
    for (const person_trials& p : people.all)
        for (const trial& t : *p.trials)
            ++all[t.method_1].counts[t.motion][t.response];
    return all;
}

class identify final : public balanced_task {
public:
    identify()
        : balanced_task(
              {.name = "identify",
               .trial = "One stimulus; the participant names its motion",
               .response = "The motion that the participant named",
               .questions = {"Which movement was it?", "Which movement was it?", "Which movement was it?"},
               .keys = {"feedback"}},
              list_methods)
    {
    }

    void check(const detail::toml_table& t, const run_outline& o) const override
    {
        if (o.motions.size() < 2)
            t.fail(fmt::format("run \"{}\" has one motion to identify", o.name),
                   "name two or more in motions");
    }

    trial_answers list_answers(const run_definition& r, const page_words& w) const override
    {
        trial_answers a{.labels = r.outline.motions, .shows_motions = true};
        a.possible = describe_answers(a.labels, 1, true, true, w["or"]);
        return a;
    }
    void record_answer(trial_row& row, const run_definition& r, const trial_answer& answer) const override
    {
        row.response = r.outline.motions.at(static_cast<std::size_t>(answer.number) - 1);
    }
    std::vector<std::string> list_responses(const run_outline& o) const override { return o.motions; }
    std::string name_response(const run_outline&, std::string_view response) const override
    {
        return fmt::format("answer \"{}\"", response);
    }

    void read_row(trial& r, const text_table& t, std::size_t row, const run_outline& o) const override
    {
        r.method_1 = find_place(t, row, "method_1", o.methods);
        r.response = static_cast<unsigned>(find_place(t, row, "response", o.motions));
    }
    void score(trial& r, const run_outline&, std::string_view, const trial_answer& answer) const override
    {
        r.response = static_cast<unsigned>(answer.number) - 1;
    }

    std::optional<bool> was_right(const experiment_definition&, const run_definition& r,
                                  const planned_trial& t, const trial_answer& answer) const override
    {
        return r.motions.at(static_cast<std::size_t>(answer.number) - 1) == t.motion;
    }

    void prepare(simulated_run& who) const override
    {
        for (const std::size_t m : who.run.motions)
            who.targets.push_back(sample_strokes(who.definition.motions[m].strokes));
    }
    trial_answer simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        paths felt = who.felt_paths(t.motion, t.method_1);
        for (std::vector<tactor::point>& path : felt)
            for (tactor::point& p : path) {
                p.x_mm += who.truth.sigma * r.normal();
                p.y_mm += who.truth.sigma * r.normal();
            }
        std::vector<double> distances;
        for (const paths& target : who.targets)
            distances.push_back(mean_distance(target, felt));
        return static_cast<double>(std::ranges::min_element(distances) - distances.begin() + 1);
    }

    // Results.

    std::optional<cell_plan> plan_cells(const run_outline& o) const override { return plan_right_answers(o); }

    std::vector<std::vector<result_outline>> outline_results() const override
    {
        return {{{{"chance"}, 0.0},
                 {{"confusion", "*"}, answer_counts{}},
                 {{"correct", "*"}, outline_cells(true)},
                 {{"pairs", "*"}, paired_list{}},
                 outline_groups(true),
                 outline_comparison("method"),
                 outline_comparison("session")}};
    }

    std::vector<result> analyse(const run_outline& o, const run_people& people, sigmoid) const override
    {
        const cell_plan plan = plan_right_answers(o);
        const std::vector<cell_values> all = compute_all_cells(o, plan, people);
        const std::vector<cell_means> means = test_cells(o, plan, all);
        std::vector<result> rows{{{"chance"}, "", find_chance(o)}};
        for (answer_counts& c : count_answers(o, people)) {
            const std::string method = c.method;
            rows.push_back({{"confusion", method}, "Answers with " + method, std::move(c)});
        }
        for (const cell_means& m : means)
            rows.push_back({{"correct", m.method},
                            fmt::format("Per cent correct with {}, against {}", m.method,
                                        plain_number(find_chance(o), 4)),
                            m});
        rows.back().is_main = true;
        for (const cell_means& m : means)
            rows.push_back(
                {{"pairs", m.method},
                 fmt::format("Per cent correct with {}, motions in pairs by paired t tests", m.method),
                 compare_in_pairs(m, plan.rounding())});
        add_groups(rows, o, people, all, true);
        return rows;
    }

    main_comparison name_comparison(const run_outline& o) const override
    {
        return {fmt::format("{} correct, t against {:.2f} %", o.methods.back(), find_chance(o)),
                find_chance(o), plan_right_answers(o).rounding()};
    }

    named_texts describe_trial(const trial& t, const run_outline& own, const run_outline&) const override
    {
        return {{"method", own.methods[t.method_1]},
                {"response", own.motions[t.response]},
                {"correct", t.response == t.motion ? "1" : "0"}};
    }

    std::string format_r_model(const run_outline& o, const model_factors& f) const override
    {
        return format_model_call(o, f, {"glmer(correct", "family = binomial, "});
    }

    std::string describe(const run_outline& o) const override
    {
        return fmt::format("one stimulus ({}); the participant named one of {}", fmt::join(o.methods, ", "),
                           counted(o.motions.size(), "motion"));
    }
};

} // namespace

const task& identify_task()
{
    static const identify one;
    return one;
}

} // namespace tactor::study
