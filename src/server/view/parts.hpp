// SPDX-License-Identifier: MIT
/// \file
/// Parts of the answers to views.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <tactor/array.hpp>

#include "net/rpc.hpp"
#include "server/stroke_source.hpp"

namespace tactor::server {

/// Returns the rows that a curve, or the felt places, of a stroke can have.
std::size_t count_steps(const plan& p);

/// Shares the rows of a view among strokes that would need so many. A stroke that needs any has at least one.
std::vector<std::size_t> share_rows(const std::vector<std::size_t>& needed);

/// Adds the prediction to `head` and to its "strokes". Returns the felt places: a member with a comma before
/// it.
std::string add_percept(net::reply_json& head, const planned& p, const array& a);

/// Adds the width of the bins to `head`. Returns the largest amplitudes: a member with a comma before it.
std::string add_peaks(net::reply_json& head, const planned& p, std::size_t tactors, std::size_t bins);

} // namespace tactor::server
