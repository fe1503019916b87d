// SPDX-License-Identifier: MIT
/// \file
/// What `check` prints.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/check/finding.hpp"
#include "session/walk.hpp"

namespace tactor::cli {

/// What a walk with answers came to.
struct walk_told {
    const array& tactors;
    const session::walk_answers& felt;
    const session::walk_verdict& verdict;
};

/// For people. `brief`: a walk follows, which leaves out what is as it should be.
std::string check_text(const std::vector<finding>& all, bool brief);

/// One object of schema tactor-check/1.
std::string check_json(const std::vector<finding>& all, const std::optional<walk_told>& walked);

} // namespace tactor::cli
