// SPDX-License-Identifier: MIT
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

class rate final : public task {
public:
    rate()
        : task({"rate",
                "One stimulus, which the participant rates",
                "The rating, {}",
                {"How much was it like the target?", "How even was it?", ""}})
    {
    }
};

} // namespace

const task& rate_task() noexcept
{
    static const rate one;
    return one;
}

} // namespace tactor::study
