// SPDX-License-Identifier: MIT
// Replacement for osc.cpp in builds without liblo.
#include <tactor/error.hpp>

#include "net/osc.hpp"

namespace tactor::net {

bool has_osc_support() noexcept
{
    return false;
}

std::vector<osc_message> parse_osc(std::string_view)
{
    throw error(error_kind::bad_input, "OSC", "this build has no OSC",
                "build tactor with liblo and -Dosc=enabled");
}

std::string osc_packet(const std::string&, const std::vector<osc_value>&)
{
    return {};
}

} // namespace tactor::net
