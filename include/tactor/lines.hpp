// SPDX-License-Identifier: MIT
/// \file
/// The lines of a player: outputs that the player switches on and off, and inputs whose edges it watches.
/// Also the GPIO lines of this computer. Derive from the classes here to use other hardware.
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

/// Direction of the edges that an input reports.
enum class edge_kind { rising, falling, both };
TACTOR_KIND(edge_kind);

/// Pull resistor at an input.
enum class pull_kind {
    as_is, ///< unchanged
    none,
    up,
    down,
};
TACTOR_KIND(pull_kind);

/// Name of a GPIO line: a chip (label or path) and an offset, or the line's own name.
struct gpio_line_name {
    std::string chip = {};
    std::optional<unsigned> offset = {};
    std::string name = {};
    source_place where = {};
};

/// Settings of an amplifier's enable line.
struct amplifier_settings {
    gpio_line_name line = {};
    bool active_low = false;
    double settle_s = 0.010; ///< turn-on time of the amplifier
};

/// An output that is on or off, for example to the enable input of an amplifier. Derive from this class to
/// use other hardware.
class TACTOR_API enable_line {
public:
    enable_line() = default;
    enable_line(const enable_line&) = delete;
    enable_line& operator=(const enable_line&) = delete;
    virtual ~enable_line();
    /// Switches the line. Returns false on failure. If the line does not switch on, the player stops its
    /// stream. If the line does not switch off, the player tries again every 10 ms for a second, and once
    /// more when the player closes; see player_stats::left_on. Takes one ioctl or write of a few microseconds
    /// and does not allocate. The audio thread never calls this.
    [[nodiscard]] virtual bool set(bool on) noexcept = 0;
    /// Tells the line that the player is alive. The thread that calls set() calls this at least every 50 ms
    /// while the line is on. Returns false if the line is lost, or if it went off by itself because beat()
    /// was not called for too long: the player hung, or a signal had stopped it. The line then stays off
    /// until the next set(true). Does not block.
    [[nodiscard]] virtual bool beat() noexcept { return true; }
    /// Returns true while the line must be off, such as when the system is about to sleep. The thread that
    /// calls set() calls this at least every 50 ms. When this returns true, the player switches the line off,
    /// and strokes that sound end as muted. When it returns false again, the player switches the line on once
    /// the stream is known to run. Does not block.
    [[nodiscard]] virtual bool must_be_off() const noexcept { return false; }
};

/// An edge on an input.
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
    /// Returns a descriptor that is readable when an edge waits. This object owns the descriptor.
    [[nodiscard]] virtual int descriptor() const noexcept = 0;
    /// Returns the next edge, or nothing. Does not block.
    [[nodiscard]] virtual std::optional<gpio_edge> read() noexcept = 0;
};

/// Opens the amplifier's enable line. A small process, the holder, owns the line. The holder switches the
/// line off on request, 150 ms after the last beat() or set(), and when this process ends in any way, even by
/// SIGKILL. At first the line is off. Blocks until the holder has the line. This call forks: make it before
/// you start real-time threads and before you lock memory.
/// \throws error (not_available) if the chip or line does not exist (the message lists the existing ones), if
///         the line is in use (the message names the process), or if the permission is missing (the message
///         names the group to join).
[[nodiscard]] TACTOR_API std::unique_ptr<enable_line> open_amplifier(const amplifier_settings& s);

/// Opens a line for sync pulses. This process owns the line. At first the line is off; it goes off again when
/// the object is destroyed. Throws like open_amplifier().
[[nodiscard]] TACTOR_API std::unique_ptr<enable_line> open_output(const gpio_line_name& line,
                                                                  bool active_low = false);

/// Opens an input that reports edges. Drops an edge that follows another edge within `debounce_s` (0 to 10).
/// Throws like open_amplifier(), and throws error (bad_input) if `debounce_s` is out of range.
[[nodiscard]] TACTOR_API std::unique_ptr<edge_input> open_edges(const gpio_line_name& line, edge_kind edge,
                                                                double debounce_s = 0.001,
                                                                pull_kind pull = pull_kind::as_is);

/// A line of a GPIO chip, as the kernel describes it.
struct gpio_line_info {
    unsigned offset = 0;
    std::string name = {};     ///< empty: none
    std::string consumer = {}; ///< holder of the line; empty: none
    bool output = false;
};
/// A GPIO chip and its lines.
struct gpio_chip_info {
    std::string path = {};  ///< /dev/gpiochipN
    std::string name = {};  ///< gpiochipN
    std::string label = {}; ///< e.g. "pinctrl-rp1"
    std::vector<gpio_line_info> lines = {};
    std::string error = {}; ///< reason why the chip could not be opened; empty: it was opened
};

/// Lists the GPIO chips, by path. Does not throw for chips that cannot be opened. Blocks shortly.
/// \throws error (runtime) when the process has no descriptors left.
[[nodiscard]] TACTOR_API std::vector<gpio_chip_info> list_gpio();

/// An existing line and its chip.
struct gpio_line_place {
    std::string path = {};  ///< path of its chip
    std::string label = {}; ///< label of its chip
    gpio_line_info line = {};
};

/// Looks up a line as open_output() would, but does not request or drive it. Blocks shortly.
/// \throws error (not_available) if the chip or line does not exist (the message lists the existing ones), or
///         if the permission is missing (the message names the group to join).
/// \throws error (bad_input) for a name that has neither chip and offset nor the name of a line.
/// \throws error (runtime) as list_gpio() does.
[[nodiscard]] TACTOR_API gpio_line_place find_gpio_line(const gpio_line_name& line);

} // namespace v0
} // namespace tactor
