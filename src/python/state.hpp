// SPDX-License-Identifier: MIT
/// \file
/// Paths and strokes as bytes, for pickles and for comparing: the same bytes, the same value.
#pragma once

#include <string>
#include <string_view>

#include <tactor/tactor.hpp>

namespace tactor::python {

std::string state_of(const path& p);
std::string state_of(const stroke& s);

/// \throws error (bad_input) for bytes that state_of() does not give.
path path_from(std::string_view state);
stroke stroke_from(std::string_view state);

} // namespace tactor::python
