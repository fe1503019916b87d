// SPDX-License-Identifier: MIT
/// \file
/// Whether what is to be played fits what plays it. What is left out nobody feels, and nobody would know why.
#pragma once

#include <span>

#include <tactor/array.hpp>
#include <tactor/render.hpp>
#include <tactor/sink.hpp>

namespace tactor::engine {

/// The array itself. \throws error: bad_input for a tactor on a channel that the stream does not have,
///         not_available for one that reaches no channel of the device of its own.
const array& fitting(const array& a, const stream_setup& s);

/// `limits`: of the player's array, by channel of the stream; 0: no tactor.
/// \throws error (bad_input) for a score of another rate or number of channels, one that drives a channel on
///         which there is no tactor, or a tactor beyond its limit, and a marker on a tactor's channel.
void check_fits(const score& s, const stream_setup& stream, std::span<const double> limits);

} // namespace tactor::engine
