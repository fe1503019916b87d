// SPDX-License-Identifier: MIT
/// \file
/// Options of the commands that read a study: its folder, its participants, the output.
#pragma once

#include <filesystem>
#include <string>

#include "study/data/dataset.hpp"

namespace CLI {
class App;
}

namespace tactor::cli {

/// DIR, --participants and --exclude. `folder` and `who` must live as long as the command.
void add_study_options(CLI::App& command, std::string& folder, study::selection& who);

/// Makes the folder for what is made of a study, derivatives/tactor in it, where `file` lies there.
void make_derivatives(const std::filesystem::path& folder, const std::filesystem::path& file);

} // namespace tactor::cli
