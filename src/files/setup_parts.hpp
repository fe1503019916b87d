// SPDX-License-Identifier: MIT
// The tables of an array or configuration file, one function each.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/setup.hpp>

#include "files/toml_reader.hpp"

namespace tactor::detail {

/// Source of a text.
struct setup_source {
    std::string name;                          ///< in messages
    std::filesystem::path folder;              ///< of relative names; empty: the current one
    std::vector<std::filesystem::path> opened; ///< the files that led here, this one included
};

/// A setup, and the places of values on which two tables must agree.
struct located_setup {
    setup said;
    source_place channels_at;
    source_place sync_channel_at;
};

/// Reads a setup and checks it as a whole.
located_setup read_setup(std::string_view text, const setup_source& source);

/// Reads [array] and [[tactor]]; keeps the other tables of an included file, too.
void read_array(const toml_table& root, const setup_source& source, located_setup& out);
/// Reads and checks [calibration] and [[calibration.tactor]], which say how thresholds were measured, after
/// the array. Keeps the participant and the carrier.
void read_calibration(const toml_table& root, located_setup& said);
/// Read a table each: [output], [amplifier], [sync], [limits].
void read_output(const toml_table& root, located_setup& out);
void read_amplifier(const toml_table& root, located_setup& out);
void read_sync(const toml_table& root, located_setup& out);
void read_limits(const toml_table& root, located_setup& out);
/// Read [serve] and [defaults] as they are written.
void read_serve(const toml_table& root, setup& out);
void read_defaults(const toml_table& root, setup& out);

} // namespace tactor::detail
