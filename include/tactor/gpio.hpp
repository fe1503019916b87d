// SPDX-License-Identifier: MIT
/// \file
/// GPIO lines of this computer: amplifier enable, sync pulses, start triggers. Through libgpiod, version 1
/// or 2.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/lines.hpp>

namespace tactor {
inline namespace v0 {

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

/// One line of a GPIO chip, as the kernel describes it.
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

/// All GPIO chips, by path. Does not throw for chips that cannot be opened. Blocks shortly.
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
