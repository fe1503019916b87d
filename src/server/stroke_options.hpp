// SPDX-License-Identifier: MIT
/// \file
/// The parameter `options` of a request.
#pragma once

#include "net/rpc.hpp"
#include "options/wishes.hpp"

namespace tactor::server {

/// Strokes that are planned ahead know more options than live ones.
enum class options_for { planned, live };

/// Puts what a client gave over the owner's. \throws fault_error naming the option.
options::wishes with_options(options::wishes w, const net::json& given, options_for which);

} // namespace tactor::server
