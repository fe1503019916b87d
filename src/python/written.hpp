// SPDX-License-Identifier: MIT
/// \file
/// What prints to a file, as text.
#pragma once

#include <cstdio>
#include <functional>
#include <string>

namespace tactor::python {

std::string written(const std::function<void(std::FILE*)>& write);

} // namespace tactor::python
