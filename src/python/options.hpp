// SPDX-License-Identifier: MIT
/// \file
/// Keyword arguments: options of the table.
#pragma once

#include "options/option.hpp"
#include "python/binding.hpp"

namespace tactor::python {

using options::wishes;

/// Sets the options `given`; None sets nothing. For others the [defaults] of `file` count, and in a score its
/// rate, channels and marker; options that `into.given` has already keep their values. `tactors`: number of
/// tactors that a phantom model in Python may name. \throws error (bad_input) for impossible values, and for
/// options that nothing uses.
void take_options(wishes& into, const py::dict& given, std::size_t tactors, const setup* file = nullptr);

/// Takes the options of a player among `given`. \throws error (bad_input).
void give_player_options(wishes& into, const py::dict& given);

/// Returns the rows of the table, for src/options/write.py.
py::list option_rows();

/// Returns an error of the library with options as keyword arguments: "soa", timing="fit".
error in_keywords(const error& e);

} // namespace tactor::python
