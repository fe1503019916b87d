// SPDX-License-Identifier: MIT
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

class choose final : public task {
public:
    choose()
        : task({"choose",
                "Two stimuli, one after the other; the participant chooses one",
                "Which of the two stimuli was chosen, 1 or 2",
                {"Which of the two was more like the target?", "Which of the two was more even?", ""}})
    {
    }
};

} // namespace

const task& choose_task() noexcept
{
    static const choose one;
    return one;
}

} // namespace tactor::study
