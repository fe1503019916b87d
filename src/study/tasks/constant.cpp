// SPDX-License-Identifier: MIT
#include "study/tasks/comparison.hpp"

namespace tactor::study {
namespace {

class constant final : public comparison_task {
public:
    constant()
        : comparison_task(
              {.name = "constant",
               .trial = "One stimulus to judge, or a standard and a comparison to choose from; fixed values",
               .response = "Number of the chosen stimulus, or of the chosen word: 1 or 2",
               .keys = {"choices", "feedback", "vary", "values", "standard", "trials_per_value"},
               .sections = {"has_functions", "has_comparisons"}})
    {
    }

    void read_outline(const detail::toml_table& t, run_definition& r) const override
    {
        read_values(t, r.outline, read_vary(t, r.outline));
        read_trials(t, r.outline);
    }

    std::vector<planned_trial> list_cells(const run_definition& r) const override
    {
        return list_value_cells(r, false);
    }
};

} // namespace

const task& constant_task()
{
    static const constant one;
    return one;
}

} // namespace tactor::study
