// SPDX-License-Identifier: MIT
#include "study/data/outline.hpp"

namespace tactor::study {

std::string_view to_string(task_kind t) noexcept
{
    return t == task_kind::choose ? "choose" : t == task_kind::rate ? "rate" : "identify";
}

std::string file_name_of(std::string_view run)
{
    std::string name;
    for (const char c : run)
        if ((c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'))
            name += c;
    return name;
}

} // namespace tactor::study
