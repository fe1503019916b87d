// SPDX-License-Identifier: MIT
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

class same_or_different final : public task {
public:
    same_or_different()
        : task({"same-different",
                "Two stimuli, one after the other",
                "Whether the stimuli were 1 the same or 2 different",
                {"Were both the same?", "Were both the same?", "Were both the same?"},
                true})
    {
    }
};

} // namespace

const task& same_different_task() noexcept
{
    static const same_or_different one;
    return one;
}

} // namespace tactor::study
