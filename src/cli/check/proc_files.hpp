// SPDX-License-Identifier: MIT
/// \file
/// Files of the kernel's, which may go while they are read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace tactor::cli {

/// In order of name; none for a folder that cannot be read.
std::vector<std::filesystem::path> entries(const std::filesystem::path& folder);

/// Without the end of the last line; /proc also ends texts with zeros. Empty where it cannot be read.
std::string text_of(const std::filesystem::path& file);

struct process_folder {
    int pid = 0;
    std::filesystem::path path = {};
};

/// `root`/proc/NUMBER, by number.
std::vector<process_folder> processes(const std::filesystem::path& root);

} // namespace tactor::cli
