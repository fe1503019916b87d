// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/words.hpp"
#include "study/data/text_table.hpp"
#include "study/results/measures.hpp"
#include "study/results/model.hpp"
#include "study/tasks/task.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

constexpr std::string_view usual_question = "Make both feel equal.";

/// A participant's answer that does not end the trial.
struct move_row {
    std::string_view word; ///< word of the page
    char key;
    int sign; ///< direction; 0 plays both stimuli again without a change
    bool coarse;
};

// The keys are the same as in calibrate. Answers have numbers from 1 in this order. The number after the last
// row accepts the value.
constexpr std::array<move_row, 5> moves{{{"much_less", '-', -1, true},
                                         {"less", '<', -1, false},
                                         {"more", '>', 1, false},
                                         {"much_more", '+', 1, true},
                                         {"again", 'n', 0, false}}};
constexpr char accept_key = 'a';

// Returns true if the first stimulus of a trial is the comparison.
bool moves_first(const planned_trial& t, const run_definition& r)
{
    return std::ranges::none_of(r.variants,
                                [&](const auto& one) { return one.second.standard == t.method_1; });
}

// Returns the index of the comparison's value.
std::size_t find_value_place(const planned_trial& t, const run_definition& r)
{
    const std::size_t played = moves_first(t, r) ? t.method_1 : *t.method_2;
    for (const auto& [method, v] : r.variants)
        if (const auto at = std::ranges::find(v.values, played); at != v.values.end())
            return static_cast<std::size_t>(at - v.values.begin());
    return 0;
}

// Returns the number of values below the standard, and the number of values that are not above the standard.
std::pair<std::size_t, std::size_t> find_sides(const run_outline& o)
{
    const auto [from, to] = std::equal_range(o.values.begin(), o.values.end(), *o.standard);
    return {static_cast<std::size_t>(from - o.values.begin()),
            static_cast<std::size_t>(to - o.values.begin())};
}

planned_trial replace_value(planned_trial t, const run_definition& r, std::size_t place)
{
    set_value(t, r, place);
    return t;
}

class adjust final : public task {
public:
    adjust()
        : task(
              {.name = "adjust",
               .trial = "A standard and a comparison, whose value the participant moves until both are equal",
               .response =
                   "Value that the participant accepted; onset, frames and plans are those of its last "
                   "presentation",
               .questions = {usual_question, usual_question, usual_question},
               .keys = {"vary", "standard", "range", "steps", "start"},
               .columns = {"start", "moves"},
               .sections = {"has_adjustments"},
               .moves_value = true})
    {
    }

    void read_outline(const detail::toml_table& t, run_definition& r) const override
    {
        run_outline& o = r.outline;
        const detail::bounds b = read_vary(t, o);
        t.need(o.standard, "standard");
        const value_grid grid = read_grid(t, o, b, "vary");
        if (grid.sizes.size() > 2)
            t.fail("steps", fmt::format("{} steps are too many", grid.sizes.size()),
                   "give one or two step sizes: small, or small and large");
        constexpr std::size_t usual_coarse = 5;
        r.adjusting.coarse = grid.sizes.empty() ? usual_coarse : *std::ranges::max_element(grid.sizes);
        for (const double v : read_number_or_list(t, "start", {grid.least, grid.greatest}))
            r.adjusting.start.push_back(find_nearest(o.values, v));
        if (const auto [below, not_above] = find_sides(o);
            r.adjusting.start.empty() && (below == 0 || not_above == o.values.size()))
            t.fail("range", fmt::format("no value is {} the standard", below == 0 ? "below" : "above"),
                   "widen the range, or add start = [VALUE, ...]");
        read_trials(t, o);
    }

    std::vector<planned_trial> list_cells(const run_definition& r) const override
    {
        std::vector<std::size_t> start = r.adjusting.start;
        if (start.empty())
            start = {0,
                     r.outline.values.size() - 1}; // draw_initial_value() draws other values on these sides
        std::vector<planned_trial> cells;
        for (const std::size_t motion : r.motions)
            for (const std::size_t method : r.methods)
                for (const std::size_t place : start)
                    add_comparison(cells, motion, r.variants.at(method), place, false);
        return cells;
    }
    // Motions and methods take turns. Each repetition of a condition has the next start; after all starts,
    // the condition has its stimuli in the other order.
    std::vector<planned_trial> draw(const run_definition& r, std::size_t n,
                                    random_numbers& numbers) const override
    {
        const std::vector<planned_trial> cells = list_cells(r);
        std::vector<std::size_t> motions(r.motions.size());
        std::vector<std::size_t> methods(r.methods.size());
        std::iota(motions.begin(), motions.end(), 0);
        std::iota(methods.begin(), methods.end(), 0);
        shuffle(std::span(motions), numbers);
        shuffle(std::span(methods), numbers);
        std::vector<std::size_t> conditions; // methods shift by one before a condition repeats
        for (std::size_t i = 0; i < motions.size() * methods.size(); ++i)
            conditions.push_back(
                motions[i % motions.size()] * methods.size() +
                methods[(i + i / std::lcm(motions.size(), methods.size())) % methods.size()]);
        const std::size_t own = cells.size() / conditions.size();
        const std::size_t starts = own / 2; // each start has both orders
        const std::size_t first = numbers.below(static_cast<unsigned>(own));
        std::vector<planned_trial> all;
        for (std::size_t i = 0; i < n; ++i) {
            const std::size_t which = i % conditions.size();
            const std::size_t turn = i / conditions.size() + which + first;
            all.push_back(cells[conditions[which] * own + 2 * (turn % starts) + (turn / starts + which) % 2]);
        }
        return all;
    }
    void draw_initial_value(planned_trial& t, const run_definition& r, random_numbers& numbers) const override
    {
        if (!r.adjusting.start.empty())
            return;
        const auto [below, not_above] = find_sides(r.outline);
        const std::size_t above = r.outline.values.size() - not_above;
        set_value(t, r,
                  find_value_place(t, r) == 0 ? numbers.below(static_cast<unsigned>(below))
                                              : not_above + numbers.below(static_cast<unsigned>(above)));
    }

    trial_answers list_answers(const run_definition&, const page_words& w) const override
    {
        trial_answers a;
        std::vector<std::string> shown;
        for (const move_row& m : moves) {
            a.labels.push_back(w[m.word]);
            a.keys += m.key;
            shown.push_back(fmt::format("{} {}", m.key, a.labels.back()));
        }
        a.labels.push_back(w["equal"]);
        a.keys += accept_key;
        shown.push_back(fmt::format("{} {}", accept_key, a.labels.back()));
        a.possible = fmt::format("{}", fmt::join(shown, ", "));
        return a;
    }
    std::string announcement(const run_definition& r, const planned_trial& t,
                             const page_words& w) const override
    {
        return w[moves_first(t, r) ? "moves_first" : "moves_second"];
    }
    std::optional<planned_trial> find_next_move(const run_definition& r, const planned_trial& t,
                                                const trial_answer& answer) const override
    {
        const auto which = static_cast<std::size_t>(answer.number) - 1;
        if (which >= moves.size())
            return {};
        const move_row& m = moves[which];
        const std::size_t at = find_value_place(t, r);
        const std::size_t by = m.coarse ? r.adjusting.coarse : 1;
        const std::size_t top = r.outline.values.size() - 1;
        return replace_value(t, r,
                             m.sign > 0   ? std::min(at + by, top)
                             : m.sign < 0 ? at - std::min(at, by)
                                          : at);
    }
    std::vector<planned_trial> list_moves(const run_definition& r, const planned_trial& t,
                                          const trial_answer& answer) const override
    {
        const std::size_t to = find_nearest(r.outline.values, answer.number);
        std::vector<planned_trial> all;
        for (std::size_t at = find_value_place(t, r); at != to;) {
            const std::size_t apart = at < to ? to - at : at - to;
            const std::size_t by = apart >= r.adjusting.coarse ? r.adjusting.coarse : 1;
            at = at < to ? at + by : at - by;
            all.push_back(replace_value(t, r, at));
        }
        return all;
    }
    void record_answer(trial_row& row, const run_definition&, const trial_answer&) const override
    {
        row.response = fmt::format("{}", row.value.value());
    }
    std::vector<std::string> list_responses(const run_outline&) const override { return {}; }
    std::string name_response(const run_outline&, std::string_view) const override { return {}; }

    void read_row(trial& r, const text_table& t, std::size_t row, const run_outline& o) const override
    {
        read_comparison(r, t, row, o);
        const auto response = t.number(row, "response");
        if (!response)
            t.refuse(row, "the response is missing", "give one, or make the trial void");
        if (std::abs(*response - r.value) > 1e-6)
            t.refuse(row, fmt::format("response is {}, but value is {}", *response, r.value),
                     "correct the one that is wrong: in this task they are equal");
    }
    void score(trial& r, const run_outline&, std::string_view, const trial_answer& answer) const override
    {
        r.value = answer.number;
    }

    // Accepts the value that is nearest to the person's PSE plus noise. The standard deviation of the noise
    // is the slope of the person's psychometric function. A person who lapses accepts the first value.
    trial_answer simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        const std::vector<double>& values = who.run.outline.values;
        if (draw_lapse(who, r))
            return values[find_value_place(t, who.run)];
        const psychometric f = find_psychometric(who, t);
        return values[find_nearest(values, f.threshold + f.slope * r.normal())];
    }

    // Results.

    std::vector<named_value> measure(const run_outline& o, const std::vector<trial>& trials,
                                     sigmoid) const override
    {
        const adjustment a = average_adjustments(o, trials);
        return {{{"constant_error"}, a.constant_error}, {{"sd"}, a.sd}}; // pse would repeat constant_error
    }

    std::vector<std::vector<result_outline>> outline_results() const override
    {
        return {outline_figure_results({{{"adjustment"}, outline_figures<adjustments>()}})};
    }

    std::vector<result> analyse(const run_outline& o, const run_people& people, sigmoid) const override
    {
        const auto average = [&](const std::vector<trial>& trials, const std::string&) {
            return average_adjustments(o, trials);
        };
        return analyse_conditions(o, people, o.methods, o.standard, "adjustment",
                                  fmt::format("Adjustments of {} to {}", o.vary, plain_number(*o.standard)),
                                  [&](const condition_trials& c) {
                                      return measure_people(adjustments{}, c, people, 0.0, average,
                                                            list_adjustment);
                                  });
    }

    main_comparison name_comparison(const run_outline&) const override
    {
        return make_comparison("constant_error", "t", 0.0);
    }

    std::vector<std::string_view> list_columns(const run_outline&) const override { return {"value"}; }
    named_texts describe_trial(const trial& t, const run_outline& own, const run_outline&) const override
    {
        const std::string value = fmt::format("{}", t.value);
        return {{"method", own.methods[t.method_1]}, {"response", value}, {"value", value}};
    }
    std::string format_r_model(const run_outline& o, const model_factors& f) const override
    {
        return format_model_call(o, f, {"lmer(" + format_value_term(o)});
    }

    std::string describe(const run_outline& o) const override
    {
        return fmt::format("{} ({}); {} from {} to {} in steps of {}; standard {}", properties().trial,
                           fmt::join(o.methods, ", "), o.vary, plain_number(o.values.front()),
                           plain_number(o.values.back()), plain_number(o.values[1] - o.values[0]),
                           plain_number(*o.standard));
    }
    std::string describe_procedure(const run_definition& r, std::set<std::string_view>&) const override
    {
        const std::vector<double>& values = r.outline.values;
        std::vector<std::string> start;
        for (const std::size_t place : r.adjusting.start)
            start.push_back(plain_number(values[place]));
        return fmt::format("small moves of {} and large ones of {}; trials began at {}",
                           plain_number(values[1] - values[0]),
                           plain_number(static_cast<double>(r.adjusting.coarse) * (values[1] - values[0])),
                           start.empty() ? "random values, below and above the standard equally often"
                                         : fmt::format("{}", fmt::join(start, ", ")));
    }
};

} // namespace

const task& adjust_task()
{
    static const adjust one;
    return one;
}

} // namespace tactor::study
