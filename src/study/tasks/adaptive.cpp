// SPDX-License-Identifier: MIT
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

class adaptive final : public task {
public:
    adaptive()
        : task({"adaptive",
                "One stimulus to judge, or a standard and a comparison to choose from; the previous answers "
                "choose the values",
                "Which of the two stimuli, or of the two words, was chosen: 1 or 2",
                {},
                true,
                true})
    {
    }
};

} // namespace

const task& adaptive_task() noexcept
{
    static const adaptive one;
    return one;
}

} // namespace tactor::study
