// SPDX-License-Identifier: MIT
/// \file
/// Output of the tool, by the names of session/say.hpp: text, warnings and progress.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/tactor.hpp>

#include "session/say.hpp"

namespace tactor::cli {

using session::fit_lines;
using session::flush_output;
using session::output_error;
using session::say;
using session::say_error;
using session::say_text;
using session::show;
using session::shown;
using session::wrapped;

/// Prints warnings. Of warnings that differ only in numbers and quoted names, prints the first and how many
/// more there are.
void say_warnings(std::span<const std::string> warnings);

/// Returns the warnings of all plans, in order.
std::vector<std::string> collect_warnings(std::span<const placed_plan> plans);

/// Warns if the score of a STROKE is weaker than requested.
void warn_of_weakening(const std::string& name, const weakening& w, std::size_t strokes);

/// A line on standard error that shows progress in per cent. It needs a terminal, begins after half a second,
/// and erases itself at the end.
class progress_line {
public:
    /// `name` must outlive the line.
    explicit progress_line(std::string_view name) : name_(name) {}
    progress_line(const progress_line&) = delete;
    progress_line& operator=(const progress_line&) = delete;
    ~progress_line();

    /// Shows how much is done, at most twice a second.
    void update(std::uint64_t done, std::uint64_t all);

private:
    std::string_view name_;
    bool shown_ = false;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

} // namespace tactor::cli
