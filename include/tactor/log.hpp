// SPDX-License-Identifier: MIT
/// \file
/// Messages of the library about its own work, for programs that want them; off by default.
#pragma once

#include <functional>
#include <span>
#include <string_view>

#include <tactor/api.hpp>
#include <tactor/kinds.hpp>

namespace tactor {
inline namespace v0 {

/// How much it matters.
enum class log_kind {
    debug,   ///< what was tried
    info,    ///< what was agreed on, begins, goes on or ends in order
    warning, ///< what was felt wrongly, or may be: xruns, mutes, limits that acted
    error,   ///< what ended the stream
};
TACTOR_KIND(log_kind);

/// Takes one line without a line end, UTF-8, for people: its words may change with each version. An empty
/// function turns it off. Called by the thread that opens a device or a player, then by the player's control
/// thread, where no lock is held: it may call the player. The audio thread never calls it, but a slow
/// function keeps drives waiting. Exceptions from it are dropped, and so are lines for which there is no
/// memory.
using log_function = std::function<void(log_kind, std::string_view)>;

} // namespace v0
} // namespace tactor
