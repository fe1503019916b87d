// SPDX-License-Identifier: MIT
/// \file
/// Open Sound Control 1.0: packets to messages, and messages to packets. Pure functions of their arguments.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace tactor::net {

/// A value of an unsupported type, with its tag: a blob, a colour, nil.
struct osc_other {
    char tag = '\0';
};

/// Value of an argument: of types i and h, f and d, s and S.
using osc_value = std::variant<std::int64_t, double, std::string, osc_other>;

struct osc_message {
    std::string address;
    std::vector<osc_value> values = {};
    /// Time tag of the innermost bundle around the message, ns since 1970; none: at once.
    std::optional<std::int64_t> unix_ns = {};
    std::string fault = {}; ///< reason why its values cannot be read; empty: none
};

/// Returns true if this build has OSC. If not, parse_osc() throws and packets are empty.
bool osc_is_built() noexcept;

/// Returns all messages of a packet, in order, also those whose values cannot be read.
/// \throws error (bad_input) for a broken packet, and for more than 256 messages or 8 nested bundles.
std::vector<osc_message> parse_osc(std::string_view packet);

/// Encodes a message as an OSC packet: integers as i, clamped to 32 bits, reals as f, text as s.
std::string osc_packet(const std::string& address, const std::vector<osc_value>& values);

} // namespace tactor::net
