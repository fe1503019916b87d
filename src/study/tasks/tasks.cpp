// SPDX-License-Identifier: MIT
// The list of tasks: a new one adds its file and a line here.
#include <array>
#include <cstddef>

#include "study/tasks/task.hpp"

namespace tactor::study {

const task& choose_task() noexcept;
const task& rate_task() noexcept;
const task& identify_task() noexcept;
const task& detect_task() noexcept;
const task& same_different_task() noexcept;
const task& estimate_task() noexcept;
const task& constant_task() noexcept;
const task& adaptive_task() noexcept;

std::span<const task* const> list_tasks() noexcept
{
    static const std::array all{&choose_task(),         &rate_task(),     &identify_task(), &detect_task(),
                                &same_different_task(), &estimate_task(), &constant_task(), &adaptive_task()};
    return all;
}

const task& find_task(task_kind t) noexcept
{
    return *list_tasks()[static_cast<std::size_t>(t)];
}

std::string_view to_string(task_kind t) noexcept
{
    return find_task(t).name();
}

} // namespace tactor::study
