// SPDX-License-Identifier: MIT
/// \file
/// Version of the library that runs.
#pragma once

#include <tactor/api.hpp>

namespace tactor {

/// "0.1.0".
TACTOR_API const char* version() noexcept;

} // namespace tactor
