// SPDX-License-Identifier: MIT
/// \file
/// Views of a plan: small answers for pages that plan while a person draws.
#pragma once

#include <cstddef>
#include <string>

#include <tactor/array.hpp>

#include "net/rpc.hpp"
#include "server/request.hpp"

namespace tactor::server {

/// Requested part of a plan: all of it, or one for a picture.
enum class view_kind { full, bursts, percept, peaks };

struct view_choice {
    view_kind kind = view_kind::full;
    std::size_t bins = 400; ///< bins of the view peaks
};

/// Reads `view` and `bins`.
/// \throws fault_error that names the parameter.
view_choice read_view(const net::json& params);

/// Returns a view as a JSON object on one line. `v` is not `full`.
/// \throws std::bad_alloc beyond `most_bytes`.
std::string view_text(const planned& p, const array& a, const view_choice& v, std::size_t most_bytes);

} // namespace tactor::server
