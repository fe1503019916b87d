// SPDX-License-Identifier: MIT
/// \file
/// What the owner of the array allows: [serve], and the options of `tactor serve`.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "cli/input.hpp"
#include "server/server.hpp"
#include "server/stroke_source.hpp"

namespace tactor::cli {

/// Options of `tactor serve` alone; of [serve], those that the command line has too.
struct serve_options : options::serve_settings {
    std::string format = "text";
};

/// Returns `s`, which the configuration says, with the options over it.
options::serve_settings settle_serve(const serve_options& o, options::serve_settings s);

/// Where to listen. \throws error (bad_input) where nothing says which socket, and for a network beyond
/// loopback without a token.
server::endpoint_options settle_endpoints(const options::serve_settings& s);

/// Raises how many files may be open to what so many clients need; warns where that is not allowed.
void provide_descriptors(const server::service_limits& l);

/// Returns what `tactor plan --format json` prints, for the service's answers. \throws std::bad_alloc above
/// `most_bytes`.
std::string plan_text(const server::planned& p, const environment& e, std::size_t most_bytes);

} // namespace tactor::cli
