// SPDX-License-Identifier: MIT
/// \file
/// GPIO lines as values: which one is meant and what it is for. They are opened by <tactor/gpio.hpp>.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <tactor/api.hpp>
#include <tactor/error.hpp>
#include <tactor/kinds.hpp>

namespace tactor {
inline namespace v0 {

/// Which changes of an input count.
enum class edge_kind { rising, falling, both };

TACTOR_API std::string_view to_string(edge_kind k) noexcept;
template <>
TACTOR_API edge_kind from_string<edge_kind>(std::string_view name);
template <>
TACTOR_API std::span<const edge_kind> values_of<edge_kind>() noexcept;

/// The resistor at an input.
enum class pull_kind {
    as_is, ///< as it was found
    none,
    up,
    down,
};

TACTOR_API std::string_view to_string(pull_kind k) noexcept;
template <>
TACTOR_API pull_kind from_string<pull_kind>(std::string_view name);
template <>
TACTOR_API std::span<const pull_kind> values_of<pull_kind>() noexcept;

/// A GPIO line: either chip (label or path) and offset, or a line name.
struct gpio_line_name {
    std::string chip = {};
    std::optional<unsigned> offset = {};
    std::string name = {};
    source_place where = {};
};

/// [amplifier]: the line that enables the amplifier.
struct amplifier_settings {
    gpio_line_name line = {};
    bool active_low = false;
    double settle_s = 0.010; ///< turn-on time of the amplifier
};

/// [sync]: triggers out and in.
struct sync_settings {
    std::optional<gpio_line_name> out = {};
    double pulse_s = 0.005;
    std::optional<unsigned> channel = {}; ///< marker on a spare PCM channel
    std::optional<gpio_line_name> in = {};
    edge_kind edge = edge_kind::rising;
    double debounce_s = 0.001; ///< edges that follow another within this are dropped
    pull_kind pull = pull_kind::as_is;
};

} // namespace v0
} // namespace tactor
