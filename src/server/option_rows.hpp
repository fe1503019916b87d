// SPDX-License-Identifier: MIT
/// \file
/// The answer to the method `options`: the table of options for clients that show all of them.
#pragma once

#include "net/rpc.hpp"
#include "options/wishes.hpp"

namespace tactor::server {

/// Returns a row for each option that a client may give, with the owner's value.
net::reply_json option_rows(const options::wishes& owner);

} // namespace tactor::server
