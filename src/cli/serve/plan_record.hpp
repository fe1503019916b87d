// SPDX-License-Identifier: MIT
/// \file
/// What `tactor plan --format json` prints, for the service's answers.
#pragma once

#include <cstddef>
#include <string>

#include "cli/input.hpp"
#include "server/stroke_source.hpp"

namespace tactor::cli {

/// \throws std::bad_alloc where it has more bytes.
std::string plan_record(const server::planned& p, const environment& e, std::size_t most_bytes);

} // namespace tactor::cli
