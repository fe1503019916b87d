// SPDX-License-Identifier: MIT
/// \file
/// A task with a trial for each motion and condition. The draw balances motions and conditions.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "study/tasks/draw.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {

class balanced_task : public task {
public:
    balanced_task(facts f, condition_list conditions) : task(std::move(f)), conditions_(std::move(conditions))
    {
    }

    std::vector<planned_trial> list_cells(const run_definition& r) const override
    {
        return cross_motions(r, conditions_);
    }
    std::vector<planned_trial> draw(const run_definition& r, std::size_t n,
                                    random_numbers& numbers) const override
    {
        return draw_balanced_trials(r, conditions_, n, numbers);
    }

private:
    condition_list conditions_;
};

} // namespace tactor::study
