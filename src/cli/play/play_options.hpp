// SPDX-License-Identifier: MIT
/// \file
/// Options of `play` alone.
#pragma once

#include <optional>
#include <string>

#include "session/device.hpp"

namespace tactor::cli {

/// The options of `play`.
struct play_options : session::stream_options {
    std::optional<std::string> socket = {}; ///< of a server to play through; here where none is named
    std::string format = "text";

    bool json() const { return format == "json"; }
    /// Takes how the stream is opened and driven.
    void take(const session::stream_options& o) { static_cast<session::stream_options&>(*this) = o; }
};

} // namespace tactor::cli
