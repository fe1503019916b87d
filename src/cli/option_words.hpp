// SPDX-License-Identifier: MIT
/// \file
/// The library's errors speak of its fields, the tool's of its options.
#pragma once

#include <tactor/error.hpp>

namespace tactor::cli {

/// The same error with what it names, and what it advises, as options: "--soa" for "soa_s", "--timing fit"
/// for "timing = fit". Doing so twice changes nothing.
error in_options(const error& e);

} // namespace tactor::cli
