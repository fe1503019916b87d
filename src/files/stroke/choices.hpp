// SPDX-License-Identifier: MIT
// How a stroke of a TOML file is planned, where it differs from the others.
#pragma once

#include <array>
#include <string_view>

#include <tactor/stroke.hpp>

#include "files/toml_reader.hpp"

namespace tactor::detail {

inline constexpr std::array<std::string_view, 8> choice_keys{
    "algorithm", "phantom", "faces", "soa_s", "burst_s", "level_db", "fit", "fit_margin_mm"};

/// The stroke with algorithm, phantom, faces, soa_s, burst_s, fit and fit_margin_mm as the file says.
/// \throws error with file, line and column, as all here.
stroke chosen(const toml_table& t, stroke s);

/// fit and fit_margin_mm: the margin; nothing where nothing is to be fitted.
std::optional<double> read_fit(const toml_table& t);

/// The stroke as much stronger or weaker as level_db says.
stroke levelled(const toml_table& t, stroke s);

} // namespace tactor::detail
