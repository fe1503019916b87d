// SPDX-License-Identifier: MIT
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

class detect final : public task {
public:
    detect()
        : task({"detect",
                "One stimulus or none",
                "Whether a stimulus was felt: 1 yes, 2 no",
                {"Did you feel it?", "Did you feel it?", "Did you feel it?"},
                true})
    {
    }
};

} // namespace

const task& detect_task() noexcept
{
    static const detect one;
    return one;
}

} // namespace tactor::study
