// SPDX-License-Identifier: MIT
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

class identify final : public task {
public:
    identify()
        : task({"identify",
                "One stimulus; the participant names its motion",
                "The motion that the participant named",
                {"Which movement was it?", "Which movement was it?", "Which movement was it?"}})
    {
    }
};

} // namespace

const task& identify_task() noexcept
{
    static const identify one;
    return one;
}

} // namespace tactor::study
