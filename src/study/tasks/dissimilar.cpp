// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/words.hpp"
#include "study/data/questionnaire.hpp"
#include "study/data/text_table.hpp"
#include "study/results/cells.hpp"
#include "study/results/model.hpp"
#include "study/tasks/balanced.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

constexpr unsigned most_different = 100;

using method_pair = std::pair<std::size_t, std::size_t>;

// Lists all pairs of indices of methods, with the smaller index first. `methods`: number of methods.
std::vector<method_pair> list_index_pairs(std::size_t methods)
{
    std::vector<method_pair> all;
    for (std::size_t a = 0; a < methods; ++a)
        for (std::size_t b = a + 1; b < methods; ++b)
            all.emplace_back(a, b);
    return all;
}

// Lists a trial for each pair; the draw adds the other order.
std::vector<planned_trial> list_all_pairs(std::size_t motion, const std::vector<std::size_t>& methods)
{
    std::vector<planned_trial> all;
    for (const auto& [a, b] : list_index_pairs(methods.size()))
        all.push_back({motion, methods[a], methods[b]});
    return all;
}

// Plans the mean difference for each pair, over both orders.
cell_plan plan_pairs(const run_outline& o)
{
    const std::vector<method_pair> pairs = list_index_pairs(o.methods.size());
    std::vector<std::string> names;
    for (const auto& [a, b] : pairs)
        names.push_back(fmt::format("{} - {}", o.methods[a], o.methods[b]));
    return {names,
            [pairs](const trial& t) {
                const auto at = std::ranges::find(pairs, method_pair(std::minmax(t.method_1, t.method_2)));
                return std::vector<std::pair<std::size_t, double>>{
                    {static_cast<std::size_t>(at - pairs.begin()), t.response}};
            },
            {0.0, most_different},
            {},
            "mean difference",
            "difference"};
}

// Places methods in a plane according to the differences of all pairs.
scaled_methods scale_methods(std::size_t methods, const std::vector<double>& pairs)
{
    scaled_methods s{std::vector<std::vector<double>>(methods, std::vector<double>(methods))};
    auto difference = pairs.begin();
    for (const auto& [a, b] : list_index_pairs(methods))
        s.differences[a][b] = s.differences[b][a] = *difference++;
    s.scaled = scale_items(s.differences);
    return s;
}

class dissimilar final : public balanced_task {
public:
    dissimilar()
        : balanced_task({.name = "dissimilar",
                         .trial = "Two stimuli of one motion; the participant says how different they were",
                         .response = "How different both were, from 0 (the same) to 100",
                         .questions = {"How different were they?", "How different were they?",
                                       "How different were they?"},
                         .keys = {"labels"}},
                        list_all_pairs)
    {
    }

    void check(const detail::toml_table& t, const run_outline& o) const override
    {
        if (o.methods.size() < 3)
            t.fail(fmt::format("run \"{}\" has {} to place by their differences", o.name,
                               counted(o.methods.size(), "method")),
                   "name three or more in methods");
    }
    void read(const detail::toml_table& t, run_definition& r) const override
    {
        refuse_method_blocks(t, r.outline);
        if (const std::size_t labels = r.outline.labels.size(); labels != 0 && labels != 2)
            t.fail("labels", fmt::format("labels has {}, but the line has two ends", counted(labels, "text")),
                   "give one text for each end");
    }

    trial_answers list_answers(const run_definition& r, const page_words& w) const override
    {
        trial_answers a{.lowest = 0, .is_line = true};
        a.labels = spread_labels(r.outline.labels.empty() ? std::vector{w["same"], w["most_different"]}
                                                          : r.outline.labels,
                                 most_different + 1);
        a.possible = describe_answers(a.labels, a.lowest, false, false, w["to"]);
        return a;
    }

    void read_row(trial& r, const text_table& t, std::size_t row, const run_outline& o) const override
    {
        read_pair(r, t, row, o);
        r.response = read_response(t, row, 0, most_different);
    }

    void prepare(simulated_run& who) const override { prepare_judge(who); }
    trial_answer simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        const double apart =
            line_points *
            std::abs(std::log(who.cost(t.motion, t.method_1) / who.cost(t.motion, *t.method_2)));
        const double noise = who.truth.sigma * r.normal();
        return std::clamp(std::round(apart + noise), 0.0, static_cast<double>(most_different));
    }

    // Results.

    std::optional<cell_plan> plan_cells(const run_outline& o) const override { return plan_pairs(o); }

    std::vector<std::vector<result_outline>> outline_results() const override
    {
        return {{{{"means", "*"}, outline_cells(false)},
                 {{"scaling"}, method_map{}},
                 outline_groups(true),
                 outline_comparison("session")}};
    }

    std::vector<result> analyse(const run_outline& o, const run_people& people, sigmoid) const override
    {
        const cell_plan plan = plan_pairs(o);
        const std::vector<cell_values> all = compute_all_cells(o, plan, people);
        std::vector<result> rows;
        std::vector<double> pairs(plan.methods.size());
        method_map map{o.methods};
        for (std::size_t i = 0; i < all.size(); ++i) {
            std::vector<double> own;
            for (const std::vector<double>& pair : all[i])
                own.push_back(mean(pair));
            for (std::size_t k = 0; k < own.size(); ++k)
                pairs[k] += own[k] / static_cast<double>(all.size());
            map.codes.push_back(people.all[i].code);
            map.people.push_back(scale_methods(o.methods.size(), own));
        }
        map.all = scale_methods(o.methods.size(), pairs);
        for (const cell_means& m : test_cells(o, plan, all))
            rows.push_back({{"means", m.method},
                            fmt::format("Mean difference of {}, 0 to {}", m.method, most_different),
                            m,
                            rows.empty()});
        rows.push_back({{"scaling"},
                        "Methods in the plane, by classical scaling of their mean differences",
                        std::move(map)});
        add_groups(rows, o, people, all, true);
        return rows;
    }

    std::vector<std::string> list_timed_methods(const run_outline&) const override { return {}; }
    bool has_one_method(const run_outline&) const override { return false; }

    main_comparison name_comparison(const run_outline&) const override
    {
        return {"differences are compared with nothing"};
    }

    std::vector<std::string_view> list_columns(const run_outline&) const override { return {"other"}; }
    named_texts describe_trial(const trial& t, const run_outline& own, const run_outline&) const override
    {
        return {{"method", own.methods[t.method_1]},
                {"other", own.methods[t.method_2]},
                {"response", fmt::format("{}", t.response)}};
    }

    // Both orders of two methods are the same pair.
    std::string format_r_model(const run_outline& o, const model_factors& f) const override
    {
        const std::string factors = list_factors(o, f);
        return fmt::format(
            "lmer(response ~ pair{} + (1{} | participant), data = within(subset(d, run == {}), {{"
            "pair <- paste(pmin(method, other), pmax(method, other)); response <- as.numeric(response)}}))",
            factors == "1" ? "" : " * " + factors, f.session ? fmt::format(" + {}", session_factor) : "",
            quote(o.name));
    }

    std::string describe(const run_outline& o) const override
    {
        return fmt::format("two stimuli of one motion, with two of {}, one after the other; the participant "
                           "said how different they were, from 0 to {}",
                           fmt::join(o.methods, ", "), most_different);
    }
};

} // namespace

const task& dissimilar_task()
{
    static const dissimilar one;
    return one;
}

} // namespace tactor::study
