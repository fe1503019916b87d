// SPDX-License-Identifier: MIT
/// \file
/// The experiment that is built in, as it stands among the examples.
#pragma once

#include <string_view>

namespace tactor::study {

std::string_view park2016_text() noexcept;

} // namespace tactor::study
