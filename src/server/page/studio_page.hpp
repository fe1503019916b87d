// SPDX-License-Identifier: MIT
/// \file
/// The page to draw on: studio.html with its styles and modules, as one document.
#pragma once

#include "net/web_connection.hpp"

namespace tactor::server {

inline constexpr net::page_document studio_page =
#include "server/studio_page.inc"
    ;

} // namespace tactor::server
