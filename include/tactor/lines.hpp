// SPDX-License-Identifier: MIT
/// \file
/// The lines of a player: outputs that it switches on and off, and inputs whose edges it watches; and how a
/// GPIO line is named. <tactor/gpio.hpp> opens those of this computer; derive from these classes for hardware
/// of your own.
#pragma once

#include <cstdint>
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
TACTOR_KIND(edge_kind);

/// The resistor at an input.
enum class pull_kind {
    as_is, ///< as it was found
    none,
    up,
    down,
};
TACTOR_KIND(pull_kind);

/// A GPIO line: either chip (label or path) and offset, or a line name.
struct gpio_line_name {
    std::string chip = {};
    std::optional<unsigned> offset = {};
    std::string name = {};
    source_place where = {};
};

/// The line that enables an amplifier.
struct amplifier_settings {
    gpio_line_name line = {};
    bool active_low = false;
    double settle_s = 0.010; ///< turn-on time of the amplifier
};

/// One output that is on or off, e.g. the enable input of an amplifier. Derive from it for hardware of your
/// own.
class TACTOR_API enable_line {
public:
    enable_line() = default;
    enable_line(const enable_line&) = delete;
    enable_line& operator=(const enable_line&) = delete;
    virtual ~enable_line();
    /// Switches. False when that failed. An "on" that failed stops the player's stream; an "off" is called
    /// again every 10 ms for a second, and once more when the player closes, see player_stats::left_on. One
    /// ioctl or write of a few microseconds, no allocation. Not the audio thread.
    [[nodiscard]] virtual bool set(bool on) noexcept = 0;
    /// Says that the player lives; called every 50 ms while the line is on, by the thread that calls set().
    /// False when the line is no longer on: it went off by itself because the player was silent for too long
    /// (stopped by a signal, or hanging), or it was lost. Until the next set(true) it stays off. Does not
    /// block.
    [[nodiscard]] virtual bool beat() noexcept { return true; }
};

/// One edge on an input.
struct gpio_edge {
    std::int64_t time_ns = 0; ///< CLOCK_MONOTONIC, stamped by the kernel
    bool rising = true;
};

/// An input that reports edges.
class TACTOR_API edge_input {
public:
    edge_input() = default;
    edge_input(const edge_input&) = delete;
    edge_input& operator=(const edge_input&) = delete;
    virtual ~edge_input();
    /// Readable when an edge waits; owned by this object.
    [[nodiscard]] virtual int descriptor() const noexcept = 0;
    /// The next edge, or nothing. Does not block.
    [[nodiscard]] virtual std::optional<gpio_edge> read() noexcept = 0;
};

} // namespace v0
} // namespace tactor
