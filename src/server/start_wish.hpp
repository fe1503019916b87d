// SPDX-License-Identifier: MIT
/// \file
/// The parameter `start` of a request.
#pragma once

#include <cstdint>
#include <optional>

#include "net/rpc.hpp"

namespace tactor::server {

/// "now" is no time, "armed" waits for fire.
struct start_wish {
    bool armed = false;
    std::optional<std::int64_t> at_ns = {}; ///< CLOCK_MONOTONIC
};

/// None is now. \throws fault_error naming it.
start_wish read_start(const net::json* start, std::int64_t now_ns);

} // namespace tactor::server
