// SPDX-License-Identifier: MIT
/// \file
/// Writers of TOML that load_setup() and load_strokes() can read: arrays, the other tables of array files,
/// and strokes.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include <tactor/setup.hpp>
#include <tactor/stroke.hpp>

namespace tactor::detail {

/// Returns a text as a TOML string in double quotes.
std::string toml_string(std::string_view s);

/// Writes the tables [array] and [[tactor]] for a complete array.
std::string array_text(const array& a);

/// Writes the tables [output], [amplifier], [sync], [limits], [serve], [defaults] and [texture]. Two setups
/// with the same text drive an array in the same way.
std::string format_settings(const setup& besides);

/// Writes a complete array file, which does not refer to other files: the array and the other tables.
std::string array_text(const array& a, const setup& besides);

/// Writes the tables [calibration] and [[calibration.tactor]].
std::string format_calibration(const calibration_origin& o);

/// Writes the table [stroke]. The table cannot contain warnings, the note, or a start that is relative to
/// another stroke.
/// \throws error (bad_input) for a stroke that no file can represent: an intensity above 1 along a path, or a
///         stroke of a group that is fitted as a whole.
std::string stroke_text(const stroke& s);

/// Writes a table [stroke] for one stroke, or tables [[stroke]] for several. Each stroke may start after the
/// previous one.
/// \throws error (bad_input) as stroke_text() does, and for a start that is relative to a group
///         (start_anchor::back).
std::string strokes_text(std::span<const stroke> all);

} // namespace tactor::detail
