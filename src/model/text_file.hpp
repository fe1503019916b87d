// SPDX-License-Identifier: MIT
// Reading a whole text file that a user named.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace tactor::detail {

/// Array and configuration files are written by hand.
inline constexpr std::size_t max_setup_bytes = std::size_t{16} << 20;

/// The bytes of a file; pipes and devices are read up to `max_bytes` as well.
/// \throws error (bad_input) naming the file when it is missing, a directory, not readable or longer.
std::string read_text_file(const std::filesystem::path& file, std::size_t max_bytes);

} // namespace tactor::detail
