// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "core/words.hpp"
#include "study/data/questionnaire.hpp"
#include "study/data/text_table.hpp"
#include "study/results/cells.hpp"
#include "study/results/model.hpp"
#include "study/tasks/balanced.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

// Plans the mean rating of each method. The means are not tested against a value.
cell_plan plan_ratings(const run_outline& o)
{
    return {o.methods,
            [](const trial& t) {
                return std::vector<std::pair<std::size_t, double>>{{t.method_1, t.response}};
            },
            {o.lowest_rating(), o.scale},
            {},
            "mean rating",
            "rating"};
}

// Returns the mean of the last method minus the mean of the first method. Returns 0 if the means differ only
// by rounding.
double subtract_methods(const cell_values& cells, const cell_plan& plan)
{
    const double difference = mean(cells.back()) - mean(cells.front());
    return std::abs(difference) > plan.rounding() ? difference : 0.0;
}

class rate final : public balanced_task {
public:
    rate()
        : balanced_task({.name = "rate",
                         .trial = "One stimulus, which the participant rates",
                         .response = "The rating, {}",
                         .questions = {"How much was it like the target?", "How even was it?", ""},
                         .keys = {"scale", "labels"}},
                        list_methods)
    {
    }

    void read_outline(const detail::toml_table& t, run_definition& r) const override
    {
        task::read_outline(t, r);
        r.outline.scale = read_scale(t, r.outline.visual).value_or(r.outline.scale);
    }
    void read(const detail::toml_table& t, run_definition& r) const override
    {
        t.need(t.text("attribute"), "attribute");
        const run_outline& o = r.outline;
        const std::size_t labels = o.labels.size();
        if (o.visual && labels != 2)
            t.fail(t.has("labels") ? "labels" : "scale",
                   fmt::format("labels has {} for a visual analogue scale", counted(labels, "text")),
                   "give one for each end");
        if (labels != 0 && labels != 2 && labels != o.scale)
            t.fail("labels", fmt::format("labels has {} for a scale of {}", counted(labels, "text"), o.scale),
                   "give one for each end, or one for each step");
    }
    std::optional<rating_scale> scale(const run_outline& o) const override
    {
        return o.visual ? rating_scale("vas") : rating_scale(o.scale);
    }

    trial_answers list_answers(const run_definition& r, const page_words& w) const override
    {
        const run_outline& o = r.outline;
        trial_answers a{.lowest = o.lowest_rating(), .is_line = o.visual};
        a.labels = spread_labels(o.labels, o.scale - a.lowest + 1);
        a.possible = describe_answers(a.labels, a.lowest, false, o.labels.size() == a.labels.size(), w["to"]);
        return a;
    }
    void record_answer(trial_row& row, const run_definition& r, const trial_answer& answer) const override
    {
        task::record_answer(row, r, answer);
        row.rating = static_cast<unsigned>(answer.number);
    }
    std::vector<std::string> list_responses(const run_outline& o) const override
    {
        std::vector<std::string> all;
        for (unsigned i = 1; i <= o.scale && !o.visual; ++i)
            all.push_back(fmt::format("{}", i));
        return all;
    }
    std::string name_response(const run_outline& o, std::string_view response) const override
    {
        return o.visual ? "" : task::name_response(o, response);
    }

    void read_row(trial& r, const text_table& t, std::size_t row, const run_outline& o) const override
    {
        r.method_1 = find_place(t, row, "method_1", o.methods);
        r.response = read_either_column(t, row, "rating", [&](std::string_view column) {
            return t.whole(row, column, o.lowest_rating(), o.scale);
        });
    }

    void prepare(simulated_run& who) const override { prepare_judge(who); }
    trial_answer simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        const double lowest = who.run.outline.lowest_rating();
        const double highest = who.run.outline.scale;
        const double points = who.run.outline.visual ? line_points : 1.0;
        const double utility = -std::log(who.cost(t.motion, t.method_1)) - who.mean_utility;
        const double felt = points * utility + draw_deviation(who, t.method_1, r);
        return std::clamp(std::round((highest + lowest) / 2.0 + felt), lowest, highest);
    }

    // Results.

    std::optional<cell_plan> plan_cells(const run_outline& o) const override { return plan_ratings(o); }

    std::vector<std::vector<result_outline>> outline_results() const override
    {
        return {{{{"means", "*"}, outline_cells(false)},
                 {{"paired"}, method_difference{}, true},
                 {{"anova"}, outline_effects({"method", "motion", "method:motion"})},
                 {{"tukey", "*"}, tukey_list{}},
                 outline_groups(true),
                 outline_comparison("method"),
                 outline_comparison("session")}};
    }

    std::vector<result> analyse(const run_outline& o, const run_people& people, sigmoid) const override
    {
        const cell_plan plan = plan_ratings(o);
        const std::vector<cell_values> all = compute_all_cells(o, plan, people);
        const std::vector<cell_means> means = test_cells(o, plan, all);
        const bool compares = o.methods.size() > 1;
        std::vector<result> rows;
        for (const cell_means& m : means)
            rows.push_back({{"means", m.method},
                            fmt::format("Mean rating of {}, {}", m.method, rating_range(o)),
                            m,
                            !compares});
        rows.push_back({{"paired"}, "", std::monostate{}, compares});
        if (compares) {
            std::vector<double> differences;
            for (const cell_values& v : all)
                differences.push_back(subtract_methods(v, plan));
            rows.back().value = method_difference{o.methods.back(), o.methods.front(),
                                                  test_mean(differences, 0.0, plan.rounding())};
        }
        rows.push_back({{"anova"}, "Analysis of variance", list_effects(o, all, true)});
        for (std::size_t m = 0; m < means.size(); ++m)
            rows.push_back({{"tukey", means[m].method},
                            "Tukey's comparisons of motions within " + means[m].method,
                            compare_by_tukey(all, m, means[m])});
        add_groups(rows, o, people, all, true);
        return rows;
    }

    main_comparison name_comparison(const run_outline& o) const override
    {
        if (o.methods.size() < 2)
            return {"one method: nothing to compare"};
        return {fmt::format("{} less {}, paired t", o.methods.back(), o.methods.front()), 0.0,
                plan_ratings(o).rounding()};
    }

    compared_person compare(const run_outline& o, const std::vector<trial>& trials) const override
    {
        const cell_plan plan = plan_ratings(o);
        const auto cells = compute_cells(o, plan, trials);
        return {cells ? std::optional(subtract_methods(*cells, plan)) : std::nullopt};
    }

    named_texts describe_trial(const trial& t, const run_outline& own, const run_outline&) const override
    {
        const std::string rating = fmt::format("{}", t.response);
        return {{"method", own.methods[t.method_1]}, {"response", rating}, {"rating", rating}};
    }

    std::string format_r_model(const run_outline& o, const model_factors& f) const override
    {
        return format_model_call(o, f, {"lmer(rating"});
    }

    std::string describe(const run_outline& o) const override
    {
        return fmt::format("one stimulus ({}), which the participant rated from {}",
                           fmt::join(o.methods, ", "), rating_range(o));
    }
};

} // namespace

std::string rating_range(const run_outline& run)
{
    return fmt::format("{} to {}{}", run.lowest_rating(), run.scale,
                       run.visual ? " on a visual analogue scale" : "");
}

const task& rate_task()
{
    static const rate one;
    return one;
}

} // namespace tactor::study
