// SPDX-License-Identifier: MIT
/// \file
/// The page to draw on: studio.html with its styles and modules, as one document.
#pragma once

#include <string_view>

namespace tactor::server {

inline constexpr std::string_view studio_page =
#include "server/studio_page.inc"
    ;

} // namespace tactor::server
