// SPDX-License-Identifier: MIT
/// \file
/// Where a stroke of a TOML file is moved from where it is drawn.
#pragma once

#include <tactor/stroke.hpp>

#include "files/toml_reader.hpp"

namespace tactor::detail {

/// The stroke mirrored, scaled, turned and moved as the keys mirror, scale, rotate_deg, translate_mm and
/// about_mm say; the very same without any. A stroke that says a speed keeps it. \throws error with file,
/// line and column.
stroke placed(const toml_table& t, stroke s);

} // namespace tactor::detail
