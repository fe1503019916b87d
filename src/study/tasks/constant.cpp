// SPDX-License-Identifier: MIT
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

class constant final : public task {
public:
    constant()
        : task({"constant",
                "One stimulus to judge, or a standard and a comparison to choose from; fixed values",
                "Which of the two stimuli, or of the two words, was chosen: 1 or 2",
                {},
                true,
                true})
    {
    }
};

} // namespace

const task& constant_task() noexcept
{
    static const constant one;
    return one;
}

} // namespace tactor::study
