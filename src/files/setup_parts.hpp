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

/// Where a text comes from.
struct setup_source {
    std::string name;                          ///< in messages
    std::filesystem::path folder;              ///< of relative names; empty: the current one
    std::vector<std::filesystem::path> opened; ///< the files that led here, this one included
};

/// A setup and where it says what two tables must agree on.
struct located_setup {
    setup said;
    source_place channels_at;
    source_place sync_channel_at;
};

/// Text to setup, checked as a whole.
located_setup read_setup(std::string_view text, const setup_source& source);

/// [array] and [[tactor]]; what an included file says besides its array is kept too.
void read_array(const toml_table& root, const setup_source& source, located_setup& out);
/// [calibration] and [[calibration.tactor]]: how thresholds were measured. Checked, after the array was read;
/// of whom and at which carrier is kept.
void read_calibration(const toml_table& root, located_setup& said);
/// [output], [amplifier], [sync].
void read_output(const toml_table& root, located_setup& out);
void read_amplifier(const toml_table& root, located_setup& out);
void read_sync(const toml_table& root, located_setup& out);
void read_limits(const toml_table& root, located_setup& out);
/// [serve] and [defaults], as they are written.
void read_serve(const toml_table& root, setup& out);
void read_defaults(const toml_table& root, setup& out);

} // namespace tactor::detail
