// SPDX-License-Identifier: MIT
/// \file
/// Options of `play` alone.
#pragma once

#include <optional>
#include <string>

namespace tactor::cli {

struct play_options {
    std::optional<std::string> socket = {}; ///< of a server to play through; here where none is named
    std::string format = "text";

    bool json() const { return format == "json"; }
};

} // namespace tactor::cli
