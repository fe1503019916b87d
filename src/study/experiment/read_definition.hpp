// SPDX-License-Identifier: MIT
/// \file
/// Reads the definition of an experiment, see tactor-experiment(5).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "study/data/definition.hpp"

namespace tactor::study {

/// Reads a definition. `name` names the text in messages. File names in the text are relative to `folder`.
/// \throws error (bad_input) with line and column if the text is not TOML, a key is missing, unknown, of the
///         wrong type or out of range, a name is unknown or used twice, or a motion cannot be read.
experiment_definition read_definition(std::string_view toml, const std::string& name,
                                      const std::filesystem::path& folder);

/// Reads the definition that is stored with a session. Skips the array and all strokes, because their files
/// may have moved. \throws error (bad_input).
experiment_definition read_design(std::string_view toml, const std::string& name);

/// Reads only the parts that the analysis needs. Ignores everything else, because other programs may write it
/// differently. \throws error (bad_input).
experiment_outline read_outline(std::string_view toml, const std::string& name);

/// Returns true if the level of the experiment or of a method is relative to the tactors' thresholds.
bool uses_thresholds(const experiment_definition& d);

/// Name of the built-in definition.
inline constexpr const char* shipped_experiment = "park2016";
/// Returns the text of the built-in definition, which is also one of the examples.
std::string_view park2016_text() noexcept;

/// Loads the built-in definition by its name, or a file. \throws error (bad_input).
experiment_definition load_definition(const std::string& name_or_file);

/// Rewrites a hint of the library for a definition: replaces names of fields by keys, and drops options that
/// a definition cannot set. `own_level`: true if the method has its own level.
std::string reword_hint(std::string_view hint, bool own_level = false);

} // namespace tactor::study
