// SPDX-License-Identifier: MIT
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

class estimate final : public task {
public:
    estimate()
        : task({"estimate",
                "One stimulus, or a standard and then a stimulus, which the participant gives a number",
                "The number above 0 that the participant gave",
                {},
                true,
                true})
    {
    }
};

} // namespace

const task& estimate_task() noexcept
{
    static const estimate one;
    return one;
}

} // namespace tactor::study
