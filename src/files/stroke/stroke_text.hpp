// SPDX-License-Identifier: MIT
/// \file
/// A stroke as TOML that load_strokes() reads again.
#pragma once

#include <string>

#include <tactor/stroke.hpp>

namespace tactor::detail {

/// The table [stroke]. It has no place for warnings, the note and a start that counts from another stroke.
/// \throws error (bad_input) for what no file can say: an intensity above 1 along a path, a stroke of a group
/// that is
///         fitted as one picture.
std::string stroke_text(const stroke& s);

} // namespace tactor::detail
