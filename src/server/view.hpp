// SPDX-License-Identifier: MIT
/// \file
/// Views of a plan: small answers for pages that plan while somebody draws.
#pragma once

#include <cstddef>
#include <string>

#include <tactor/array.hpp>

#include "server/stroke_options.hpp"
#include "server/stroke_source.hpp"

namespace tactor::server {

/// Returns a view as a JSON object on one line. `v` is not `full`. \throws std::bad_alloc beyond so many
/// bytes.
std::string view_text(const planned& p, const array& a, const view_choice& v, std::size_t most_bytes);

} // namespace tactor::server
