// SPDX-License-Identifier: MIT
/// \file
/// The other side of a gpio-sim chip: what the hardware would see and do.
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
    /// What the line is driven to, or read from its pull.
    int value(unsigned line) const;
    /// Pulls an input up or down, as a button would.
    void pull(unsigned line, bool up) const;
    /// CLOCK_MONOTONIC in ns at which the line was first seen low, by looking all the time.
    std::optional<std::int64_t> low_at(unsigned line, std::int64_t within_ms) const;

private:
    std::string folder_;
};

/// The chip that the program was started for.
const sim_chip& chip();

} // namespace tactor::test
