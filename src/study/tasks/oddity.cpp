// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/words.hpp"
#include "study/data/text_table.hpp"
#include "study/results/measures.hpp"
#include "study/results/model.hpp"
#include "study/tasks/task.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

constexpr unsigned intervals = 3;

/// Methods of the two different stimuli of a trial. One method is in one interval, and the other method is in
/// two intervals.
using stimulus_pair = std::pair<std::size_t, std::size_t>;

// Lists the pairs of a run: both methods, or each value of each method with the standard.
std::vector<stimulus_pair> list_stimulus_pairs(const run_definition& r)
{
    if (r.outline.vary.empty())
        return {{r.methods.front(), r.methods.back()}};
    std::vector<stimulus_pair> all;
    for (const std::size_t method : r.methods) {
        const method_variants& v = r.variants.at(method);
        for (const std::size_t value : v.values)
            all.emplace_back(value, v.standard.value());
    }
    return all;
}

// Number of different trials of a pair: either of the two methods can be odd, in any interval.
constexpr std::size_t orders = 2 * std::size_t{intervals};

// Returns the trial of a pair for an order, which may be any number. In `orders` successive orders, each
// method is odd equally often, and the odd stimulus is in each interval equally often.
planned_trial make_trial(std::size_t motion, const stimulus_pair& pair, std::size_t order)
{
    const auto [odd, other] = order % 2 == 0 ? pair : stimulus_pair(pair.second, pair.first);
    std::array<std::size_t, intervals> played{other, other, other};
    played[order % intervals] = odd;
    return {motion, played[0], played[1], played[2]};
}

class odd_one_out final : public task {
public:
    odd_one_out()
        : task({.name = "oddity",
                .trial = "Three stimuli, one after the other, of which two are alike",
                .response = "Interval of the stimulus that the participant felt to differ: 1, 2 or 3",
                .questions = {"Which was different from the two others?",
                              "Which was different from the two others?",
                              "Which was different from the two others?"},
                .keys = {"feedback", "vary", "values", "standard", "trials_per_value"},
                .sections = {"has_oddity"},
                .has_three_stimuli = true})
    {
    }

    void read_outline(const detail::toml_table& t, run_definition& r) const override
    {
        run_outline& o = r.outline;
        for (const char* key : {"values", "standard", "trials_per_value"})
            if (t.has(key) != t.has("vary") && (t.has(key) || key == std::string_view("standard")))
                t.fail(t.has(key) ? key : "vary", "vary, values and standard need one another",
                       "give all three, or leave them all out to compare two methods");
        if (t.has("vary")) {
            read_values(t, o, read_vary(t, o));
            if (std::ranges::count(o.values, *o.standard) != 0)
                t.fail("standard", "the standard is one of the values, so no stimulus would differ",
                       "remove the standard from values");
        }
        read_trials(t, o);
    }
    void check(const detail::toml_table& t, const run_outline& o) const override
    {
        if (o.vary.empty() && o.methods.size() != 2)
            t.fail(fmt::format("run \"{}\" needs two methods, but has {}", o.name,
                               counted(o.methods.size(), "method")),
                   "name two under methods, or add the keys vary, values and standard");
    }
    void read(const detail::toml_table& t, run_definition& r) const override
    {
        if (r.outline.vary.empty())
            refuse_method_blocks(t, r.outline);
    }

    std::vector<planned_trial> list_cells(const run_definition& r) const override
    {
        std::vector<planned_trial> cells;
        for (const std::size_t motion : r.motions)
            for (const stimulus_pair& pair : list_stimulus_pairs(r))
                for (std::size_t order = 0; order < orders; ++order)
                    cells.push_back(make_trial(motion, pair, order));
        return cells;
    }
    // In the trials that remain after complete sets of cells, motions, pairs and orders take turns. Pairs and
    // orders shift by one before a combination repeats.
    std::vector<planned_trial> draw(const run_definition& r, std::size_t n,
                                    random_numbers& numbers) const override
    {
        const std::vector<planned_trial> cells = list_cells(r);
        std::vector<planned_trial> all;
        for (std::size_t i = 0; i < n - n % cells.size(); ++i)
            all.push_back(cells[i % cells.size()]);
        std::vector<std::size_t> motions = r.motions;
        std::vector<stimulus_pair> pairs = list_stimulus_pairs(r);
        shuffle(std::span(motions), numbers);
        shuffle(std::span(pairs), numbers);
        const std::size_t first = numbers.below(orders);
        const std::size_t stimuli = motions.size() * pairs.size();
        for (std::size_t i = 0; all.size() < n; ++i) {
            const std::size_t at = i % stimuli;
            const std::size_t pair = at + at / std::lcm(motions.size(), pairs.size());
            all.push_back(make_trial(motions[at % motions.size()], pairs[pair % pairs.size()],
                                     first + i + i / std::lcm(stimuli, orders)));
        }
        return all;
    }

    trial_answers list_answers(const run_definition&, const page_words& w) const override
    {
        trial_answers a{.labels = std::vector<std::string>(intervals)};
        a.possible = describe_answers(a.labels, 1, false, false, w["to"]);
        return a;
    }
    std::vector<std::string> list_responses(const run_outline&) const override { return {"1", "2", "3"}; }
    std::optional<bool> was_right(const experiment_definition&, const run_definition&, const planned_trial& t,
                                  const trial_answer& answer) const override
    {
        return answer.number == find_odd_stimulus(t).value();
    }

    // The trial's method is the method of the value. In a run without values, it is the method of the odd
    // stimulus.
    void read_row(trial& r, const text_table& t, std::size_t row, const run_outline& o) const override
    {
        constexpr std::array<const char*, intervals> columns{"method_1", "method_2", "method_3"};
        std::array<std::string_view, intervals> names;
        for (std::size_t i = 0; i < intervals; ++i)
            names[i] = t.need(row, columns[i]);
        const auto differs = [&](std::size_t i) { return std::ranges::count(names, names[i]) == 1; };
        for (unsigned i = 0; i < intervals; ++i)
            if (differs(i))
                r.odd = i + 1;
        const bool has_standard = std::ranges::count(names, standard_name) != 0;
        if (r.odd == 0 || std::ranges::count_if(std::array{0U, 1U, 2U}, differs) != 1 ||
            has_standard == o.vary.empty())
            t.refuse(row, "the three methods do not make a trial",
                     o.vary.empty() ? "name one method twice, and another method once"
                                    : "name a method and the standard, one of them twice");
        for (std::size_t i = 0; i < intervals; ++i)
            if (names[i] != standard_name) {
                const std::size_t method = find_place(t, row, columns[i], o.methods);
                if (!o.vary.empty() || differs(i))
                    r.method_1 = method;
            }
        if (!o.vary.empty())
            r.value = read_value(t, row, o);
        score(r, o, {}, read_response(t, row, 1, intervals));
    }
    void score(trial& r, const run_outline& o, std::string_view method_1,
               const trial_answer& answer) const override
    {
        task::score(r, o, method_1, answer);
        r.positive = r.response == r.odd;
    }

    // In a run with values, d' is proportional to the distance of the value from the standard. At the
    // farthest value, d' is the person's own d'.
    trial_answer simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        if (const auto key = draw_lapse(who, r, intervals))
            return *key;
        double apart = find_dprime(who, t);
        if (const run_outline& o = who.run.outline; o.standard) {
            const auto distance = [&o](double value) { return std::abs(value - *o.standard); };
            apart *= distance(find_value(who.definition, t).value()) /
                     std::max(distance(o.values.front()), distance(o.values.back()));
        }
        std::array<double, intervals> felt{};
        for (double& one : felt)
            one = r.normal();
        felt.at(find_odd_stimulus(t).value() - 1) += apart;
        const double middle = std::accumulate(felt.begin(), felt.end(), 0.0) / intervals;
        const auto farthest =
            std::ranges::max_element(felt, {}, [middle](double one) { return std::abs(one - middle); });
        return static_cast<double>(farthest - felt.begin() + 1);
    }

    // Results.

    std::vector<named_value> measure(const run_outline&, const std::vector<trial>& trials,
                                     sigmoid) const override
    {
        return list_oddity(measure_oddity(trials));
    }

    std::vector<std::vector<result_outline>> outline_results() const override
    {
        return {outline_figure_results({{{"dprime"}, outline_figures<oddities>()}})};
    }

    std::vector<result> analyse(const run_outline& o, const run_people& people, sigmoid) const override
    {
        const auto measure = [&](const condition_trials& c) {
            return measure_by_ratio(oddities{}, o, c, people, measure_oddity, list_oddity, test_oddity);
        };
        return analyse_conditions(o, people, list_timed_methods(o), 0.0, "dprime", "Sensitivity", measure,
                                  o.values);
    }

    std::vector<std::string> list_timed_methods(const run_outline& o) const override
    {
        return has_one_method(o) ? o.methods : std::vector<std::string>();
    }
    bool has_one_method(const run_outline& o) const override { return !o.vary.empty(); }

    main_comparison name_comparison(const run_outline&) const override
    {
        return make_comparison("dprime", "likelihood ratio", 0.0);
    }

    compared_person compare(const run_outline&, const std::vector<trial>& trials) const override
    {
        const auto o = measure_oddity(trials);
        return {.right = o ? std::optional(o->counts) : std::nullopt};
    }

    compared test(const run_outline&, std::span<const compared_person> people,
                  std::string_view seed) const override
    {
        const auto difference =
            test_oddity(list_present_values(people, std::mem_fn(&compared_person::right)), seed);
        return {difference ? std::optional(difference->p) : std::nullopt, true};
    }

    // Uses the link function of the triangular model, with which the intercept is d'. The link function of
    // psyphy for three alternatives is for observers who know how the odd stimulus differs.
    std::string format_r_model(const run_outline& o, const model_factors& f) const override
    {
        const std::string apart =
            o.standard ? fmt::format("abs(value - {})", plain_number(*o.standard, 12)) : "";
        return format_model_call(
            o, f, {"glmer(positive", "family = sensR::triangle(), ", "", apart, has_one_method(o)});
    }

    std::vector<std::string_view> list_columns(const run_outline& o) const override
    {
        return o.vary.empty() ? std::vector<std::string_view>{"positive"}
                              : std::vector<std::string_view>{"value", "positive"};
    }
};

} // namespace

const task& oddity_task()
{
    static const odd_one_out one;
    return one;
}

} // namespace tactor::study
