// SPDX-License-Identifier: MIT
/// \file
/// Arrays, the other tables of their files, and strokes, as TOML that load_setup() and load_strokes() can
/// read.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include <tactor/setup.hpp>
#include <tactor/stroke.hpp>

namespace tactor::detail {

/// Returns a TOML string in double quotes.
std::string toml_string(std::string_view s);

/// Writes the tables [array] and [[tactor]], which hold a whole array.
std::string array_text(const array& a);

/// Writes the tables [output], [amplifier], [sync], [limits], [serve] and [defaults]. Two setups with the
/// same text drive an array alike.
std::string besides_text(const setup& besides);

/// Writes an array file with both kinds of tables. It needs no other file.
std::string array_text(const array& a, const setup& besides);

/// Writes the tables [calibration] and [[calibration.tactor]].
std::string origin_text(const calibration_origin& o);

/// Writes the table [stroke]. It has no place for warnings, the note and a start that counts from another
/// stroke.
/// \throws error (bad_input) for a stroke that no file can hold: an intensity above 1 along a path, a stroke
///         of a group that is fitted as a single picture.
std::string stroke_text(const stroke& s);

/// Writes a table [stroke], or a table [[stroke]] for each of several; each may start after the one before
/// it.
/// \throws error (bad_input) as above, and for a start that counts from a group (start_anchor::back).
std::string strokes_text(std::span<const stroke> all);

} // namespace tactor::detail
