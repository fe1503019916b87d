// SPDX-License-Identifier: MIT
/// \file
/// Output of the tool: text, warnings and progress. Also declares the names of session/say.hpp in this
/// namespace.
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
using session::make_printable;
using session::output_error;
using session::say;
using session::say_error;
using session::say_text;
using session::show;
using session::wrap_text;

/// Prints warnings. If several warnings differ only in numbers and quoted names, prints the first of them and
/// the number of the others.
void print_grouped_warnings(std::span<const std::string> warnings);

/// Returns the warnings of all plans, in order.
std::vector<std::string> collect_warnings(std::span<const placed_plan> plans);

/// Prints a warning if the score of a STROKE is weaker than requested.
void warn_of_weakening(const std::string& name, const weakening& w, std::size_t strokes);

/// A line on standard error that shows progress in per cent. It appears only on a terminal and after half a
/// second. The destructor erases it.
class progress_line {
public:
    /// Constructs a line. `name` must outlive it.
    explicit progress_line(std::string_view name) : name_(name) {}
    progress_line(const progress_line&) = delete;
    progress_line& operator=(const progress_line&) = delete;
    ~progress_line();

    /// Shows which part of the work is done. Changes the line at most twice a second.
    void update(std::uint64_t done, std::uint64_t all);

private:
    std::string_view name_;
    bool shown_ = false;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

} // namespace tactor::cli
