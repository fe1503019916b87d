// SPDX-License-Identifier: MIT
/// \file
/// The parameters `options` and `start` of a request.
#pragma once

#include <cstdint>
#include <optional>

#include "net/rpc.hpp"
#include "options/wishes.hpp"

namespace tactor::server {

/// Strokes that are planned ahead know more options than live ones.
enum class options_for { planned, live };

/// Puts what a client gave over the owner's. \throws fault_error naming the option.
options::wishes with_options(options::wishes w, const net::json& given, options_for which);

/// "now" is no time, "armed" waits for fire.
struct start_wish {
    bool armed = false;
    std::optional<std::int64_t> at_ns = {}; ///< CLOCK_MONOTONIC
};

/// None is now. \throws fault_error naming it.
start_wish read_start(const net::json* start, std::int64_t now_ns);

} // namespace tactor::server
