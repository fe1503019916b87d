// SPDX-License-Identifier: MIT
/// \file
/// The lines of a player: outputs that it switches on and off, and inputs whose edges it watches; and the
/// GPIO lines of this computer. Derive from these classes for hardware of your own.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/error.hpp>

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

/// The amplifier's enable line, owned by a small process of its own, the holder. The holder switches the line
/// off when it is told to, 150 ms after the last beat() or set(), and when this process ends in any way,
/// SIGKILL included. The line is requested as off. Blocks until the holder has it. This call forks: make it
/// before there are real-time threads and before memory is locked.
/// \throws error (not_available): no such chip or line (the message lists those that there are), a line in
///         use (by whom), or one that may not be opened (which group to join).
[[nodiscard]] TACTOR_API std::unique_ptr<enable_line> open_amplifier(const amplifier_settings& s);

/// A line that this process owns, requested as an output that is off; switched off again when destroyed. For
/// sync pulses. Throws like open_amplifier.
[[nodiscard]] TACTOR_API std::unique_ptr<enable_line> open_output(const gpio_line_name& line,
                                                                  bool active_low = false);

/// Opens an input that reports edges. An edge that comes within `debounce_s` (0 to 10) after another of them
/// is dropped. Throws like open_amplifier, and bad_input for a `debounce_s` out of range.
[[nodiscard]] TACTOR_API std::unique_ptr<edge_input> open_edges(const gpio_line_name& line, edge_kind edge,
                                                                double debounce_s = 0.001,
                                                                pull_kind pull = pull_kind::as_is);

/// A line of a GPIO chip, as the kernel describes it.
struct gpio_line_info {
    unsigned offset = 0;
    std::string name = {};     ///< empty: none
    std::string consumer = {}; ///< who holds it; empty: nobody
    bool output = false;
};
struct gpio_chip_info {
    std::string path = {};  ///< /dev/gpiochipN
    std::string name = {};  ///< gpiochipN
    std::string label = {}; ///< e.g. "pinctrl-rp1"
    std::vector<gpio_line_info> lines = {};
    std::string error = {}; ///< why it could not be opened; empty: it could
};

/// Lists the GPIO chips, by path. Does not throw for chips that cannot be opened. Blocks shortly.
/// \throws error (runtime) when the process has no descriptors left.
[[nodiscard]] TACTOR_API std::vector<gpio_chip_info> list_gpio();

/// An existing line and its chip.
struct gpio_line_place {
    std::string path = {};  ///< of its chip
    std::string label = {}; ///< of its chip
    gpio_line_info line = {};
};

/// Looks up a line as open_output() would, without requesting it: nothing is driven. Blocks shortly.
/// \throws error: not_available when there is no such chip or line (the message lists those that there are),
///         or the chip may not be opened (which group to join); bad_input for a name with neither chip and
///         offset nor a line's name; runtime as list_gpio().
[[nodiscard]] TACTOR_API gpio_line_place find_gpio_line(const gpio_line_name& line);

} // namespace v0
} // namespace tactor
