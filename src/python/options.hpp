// SPDX-License-Identifier: MIT
/// \file
/// Keyword arguments: options of the table.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "options/option.hpp"
#include "python/binding.hpp"

namespace tactor::python {

using options::wishes;

/// Options with their values.
using given_options = std::vector<std::pair<const options::option*, options::value>>;

/// Takes what `given` says; None is as good as nothing. `tactors` is how many an own phantom model may name.
/// \throws error (bad_input) for names that are not known, and for values that cannot be.
void take_options(wishes& into, const py::dict& given, std::size_t tactors);

/// Refuses those of `names` that nothing uses when `all` options are as given. `place` is a function that has
/// them: "plan" or "compare". \throws error (bad_input).
void check_used(const std::vector<std::string>& names, const py::dict& all, const std::string& place);

/// Options of a player among `given`, checked. \throws error (bad_input).
given_options player_options_in(const py::dict& given);

/// Names of options: "planning", "sounding", "live", or all that take_options() knows.
std::vector<std::string> option_names(const std::string& which);

/// The rows of the table, for what is written from them (src/options/write.py).
py::list option_rows();

/// Values of [defaults] by the names of options. \throws error (bad_input) with the place in the file.
py::dict default_values(const setup& says);

/// An error of the library with options as keyword arguments: "soa", timing="fit".
error in_keywords(const error& e);

/// A Python object that says which tactors make a phantom: name, and weights(x_mm, y_mm, intensity).
std::shared_ptr<const phantom_model> wrap_model(const py::object& own, std::size_t tactors);

} // namespace tactor::python
