// SPDX-License-Identifier: MIT
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/words.hpp"
#include "study/data/text_table.hpp"
#include "study/experiment/simulated.hpp"
#include "study/tasks/task.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

class same_or_different final : public task {
public:
    same_or_different()
        : task({.name = "same-different",
                .trial = "Two stimuli, one after the other",
                .response = "Whether the stimuli were 1 the same or 2 different",
                .questions = {"Were both the same?", "Were both the same?", "Were both the same?"},
                .keys = {"choices"},
                .measures = true})
    {
    }

    void check(const detail::toml_table& t, const run_outline& o) const override
    {
        if (o.methods.size() != 2)
            t.fail(fmt::format("{} has {}", o.name, counted(o.methods.size(), "method")),
                   "use two, which are the same or differ");
    }
    void read(const detail::toml_table& t, run_definition& r) const override
    {
        refuse_method_blocks(t, r.outline);
    }
    std::vector<std::string> usual_choices(const page_words& w) const override
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
        score(r, o, {}, read_one_of_two(t, row));
    }
    void score(trial& r, const run_outline& o, std::string_view method_1, double answer) const override
    {
        task::score(r, o, method_1, answer);
        r.positive = r.response == 2;
        r.signal = r.method_1 != r.method_2;
    }

    double simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        if (double key = 0.0; lapses(who, r, key))
            return key;
        // Differs if what is felt is further apart than this, in units of d'.
        constexpr double criterion = std::numbers::sqrt2;
        const double apart = t.method_1 != *t.method_2 ? who.truth.dprime : 0.0;
        return std::abs(apart + r.normal() - r.normal()) > criterion ? 2 : 1;
    }
};

} // namespace

const task& same_different_task()
{
    static const same_or_different one;
    return one;
}

} // namespace tactor::study
