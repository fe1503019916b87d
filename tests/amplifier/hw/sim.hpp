// SPDX-License-Identifier: MIT
/// \file
/// The other side of a gpio-sim chip, in place of the hardware.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace tactor::test {

class sim_chip {
public:
    /// `folder`: /sys/devices/platform/<device>/<chip>.
    explicit sim_chip(const std::string& folder);

    /// /dev/gpiochipN
    std::string path() const;
    /// Returns the driven value of an output, or the pull of an input.
    int value(unsigned line) const;
    /// Pulls an input up or down, like a button.
    void pull(unsigned line, bool up) const;
    /// Polls a line; returns the CLOCK_MONOTONIC time in ns at which it was first low.
    std::optional<std::int64_t> low_at(unsigned line, std::int64_t within_ms) const;

private:
    std::string folder_;
};

/// Returns the chip that the program was started for.
const sim_chip& chip();

} // namespace tactor::test
