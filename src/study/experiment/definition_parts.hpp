// SPDX-License-Identifier: MIT
/// \file
/// The tables of a definition, one function each.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "files/toml_reader.hpp"
#include "study/experiment/definition.hpp"

namespace tactor::study {

/// A text of one line that can stand in a table. \throws error (bad_input).
std::string name_in(const detail::toml_table& t, std::string_view key);

/// [[motion]]: a stroke from a preset, path data or a file, in the time that is asked for.
motion_definition read_motion(const detail::toml_table& t, const std::filesystem::path& folder);

/// [[method]]: options of a plan.
method_definition read_method(const detail::toml_table& t);

} // namespace tactor::study
