// SPDX-License-Identifier: MIT
/// \file
/// Progress of work that takes longer than half a second.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace tactor::cli {

/// A line on standard error that counts up in per cent. It needs a terminal, begins after half a second, and
/// leaves nothing behind.
class progress_line {
public:
    explicit progress_line(const std::string& name);
    progress_line(const progress_line&) = delete;
    progress_line& operator=(const progress_line&) = delete;
    ~progress_line();

    /// Shows how much is done, at most twice a second.
    void update(std::uint64_t done, std::uint64_t all);

private:
    std::string name_;
    bool terminal_;
    bool shown_ = false;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

} // namespace tactor::cli
