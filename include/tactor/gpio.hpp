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
/// SIGKILL included. The line is requested as off. Blocks until the holder has it. This forks: call it before
/// there are real-time threads and before memory is locked.
/// \throws error (not_available): no such chip or line (it says which there are), a line in use (by whom), or
///         one that may not be opened (which group to join).
[[nodiscard]] TACTOR_API std::unique_ptr<enable_line> open_amplifier(const amplifier_settings& s);

/// A line of this process's own, requested as an output that is off; switched off again when destroyed. For
/// sync pulses. Throws like open_amplifier.
[[nodiscard]] TACTOR_API std::unique_ptr<enable_line> open_output(const gpio_line_name& line,
                                                                  bool active_low = false);

/// Edges that follow another of these within `debounce_s` (0 to 10) are dropped. Throws like open_amplifier,
/// and bad_input for a time that cannot be.
[[nodiscard]] TACTOR_API std::unique_ptr<edge_input> open_edges(const gpio_line_name& line, edge_kind edge,
                                                                double debounce_s = 0.001,
                                                                pull_kind pull = pull_kind::as_is);

/// What `tactor devices` lists.
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
[[nodiscard]] TACTOR_API std::vector<gpio_chip_info> list_gpio();

/// A line that there is.
struct gpio_line_place {
    std::string path = {};  ///< of its chip
    std::string label = {}; ///< of its chip
    gpio_line_info line = {};
};

/// Looks a line up as open_output() would, without requesting it: nothing is driven. Blocks shortly.
/// \throws error: not_available when there is no such chip or line (which there are), or the chip may not be
///         opened (which group to join); bad_input for a name that says neither.
[[nodiscard]] TACTOR_API gpio_line_place find_gpio_line(const gpio_line_name& line);

} // namespace v0
} // namespace tactor
