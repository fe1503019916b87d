// SPDX-License-Identifier: MIT
/// \file
/// Views of a plan: short answers to pages that request a plan while a person draws.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include <tactor/array.hpp>

#include "net/rpc.hpp"
#include "server/request.hpp"

namespace tactor::server {

/// Requested view of a plan. `full` is the plan itself, the others are data for pictures.
enum class view_kind { full, bursts, percept, peaks };
inline constexpr std::array<std::string_view, 4> view_names{"full", "bursts", "percept", "peaks"};

struct view_choice {
    view_kind kind = view_kind::full;
    std::size_t bins = 400; ///< number of bins in the view peaks
};

/// Reads `view` and `bins`.
/// \throws fault_error for `bins` with another view than peaks.
view_choice read_view(const net::json& params);

/// Returns a view as a JSON object on one line. Precondition: `v` is not `full`.
/// \throws std::bad_alloc if it has more than `most_bytes`.
std::string view_text(const planned& p, const array& a, const view_choice& v, std::size_t most_bytes);

} // namespace tactor::server
