// SPDX-License-Identifier: MIT
/// \file
/// Open Sound Control 1.0: packets to messages, and messages to packets. Pure functions of their arguments.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace tactor::net {

/// A value of a type that is not read, by its tag: a blob, a colour, nil.
struct osc_other {
    char tag = '\0';
};

/// What i and h, f and d, s and S hold.
using osc_value = std::variant<std::int64_t, double, std::string, osc_other>;

struct osc_message {
    std::string address;
    std::vector<osc_value> values = {};
    /// Time tag of the innermost bundle that it is in, ns since 1970; none: at once.
    std::optional<std::int64_t> unix_ns = {};
};

struct osc_limits {
    std::size_t nesting = 8;    ///< bundles in bundles
    std::size_t messages = 256; ///< in one packet
};

/// Whether this build knows OSC: the functions below refuse where it does not.
bool osc_is_built() noexcept;

/// All messages of a packet, in order: of a broken one none.
/// \throws error (bad_input): what is wrong with it.
std::vector<osc_message> parse_osc(std::string_view packet, const osc_limits& l = {});

/// A packet of one message: numbers as i and f, without what does not fit in there, and s.
std::string osc_packet(const std::string& address, const std::vector<osc_value>& values);

/// A message, not a bundle, as it stands in a packet, by liblo. \throws error (bad_input).
osc_message parse_osc_message(std::string_view bytes);

} // namespace tactor::net
