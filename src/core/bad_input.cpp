// SPDX-License-Identifier: MIT
#include "core/bad_input.hpp"

namespace tactor::detail {

error bad_field(std::string_view field, std::string_view why, std::string_view hint)
{
    return error(error_kind::bad_input, field, why, hint).with_field(field);
}

} // namespace tactor::detail
