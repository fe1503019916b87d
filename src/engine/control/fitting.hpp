// SPDX-License-Identifier: MIT
/// \file
/// Whether an array fits the stream, and a score the player. Otherwise some drives would reach no tactor, and
/// nobody would know why nothing is felt.
#pragma once

#include <span>

#include <tactor/array.hpp>
#include <tactor/render.hpp>
#include <tactor/sink.hpp>

namespace tactor::engine {

/// Returns the array if it fits.
/// \throws error: bad_input for a tactor on a channel that the stream does not have, not_available for one
///         that has no channel of the device to itself.
const array& fitting(const array& a, const stream_setup& s);

/// `limits`: of the player's array, by channel of the stream; 0: no tactor.
/// \throws error (bad_input) for a score that has another rate or number of channels, drives a channel
///         without a tactor, drives a tactor beyond its limit, or has its marker on a tactor's channel.
void check_fits(const score& s, const stream_setup& stream, std::span<const double> limits);

} // namespace tactor::engine
