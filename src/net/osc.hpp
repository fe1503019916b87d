// SPDX-License-Identifier: MIT
/// \file
/// Open Sound Control 1.0: conversion of packets to messages and of messages to packets. Pure functions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace tactor::net {

/// A value of a type that is not supported, such as a blob, a colour or nil, represented by its type tag.
struct osc_other {
    char tag = '\0';
};

/// Value of an argument. The types i and h become integers, f and d become reals, s and S become text.
using osc_value = std::variant<std::int64_t, double, std::string, osc_other>;

struct osc_message {
    std::string address;
    std::vector<osc_value> values = {};
    /// Time tag of the innermost bundle around the message, ns since 1970. Not set if the message takes
    /// effect immediately.
    std::optional<std::int64_t> unix_ns = {};
    std::string fault = {}; ///< reason why the values cannot be read, or empty
};

/// Returns true if this build supports OSC. Otherwise parse_osc() throws, and osc_packet() returns "".
bool has_osc_support() noexcept;

/// Returns all messages of a packet in order, including messages whose values cannot be read.
/// \throws error (bad_input) for a malformed packet, and for more than 256 messages or 8 nested bundles.
std::vector<osc_message> parse_osc(std::string_view packet);

/// Encodes a message as an OSC packet. Integers become i, clamped to 32 bits; reals become f; text becomes s.
std::string osc_packet(const std::string& address, const std::vector<osc_value>& values);

} // namespace tactor::net
