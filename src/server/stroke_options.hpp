// SPDX-License-Identifier: MIT
/// \file
/// The parameters of a request beside the stroke: `options`, `start`, and `plan`'s view.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "net/rpc.hpp"
#include "options/option.hpp"

namespace tactor::server {

/// Converts a time, ns, to the seconds that messages have.
inline double seconds(std::int64_t ns) noexcept
{
    return static_cast<double>(ns) * 1e-9;
}

/// Returns the time of day, ns since 1970.
inline std::int64_t unix_ns() noexcept
{
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::system_clock::now().time_since_epoch())
        .count();
}

/// Strokes that are planned ahead know more options than live ones.
enum class options_for { planned, live };

/// Returns the owner's options with those of a client over them. \throws fault_error, or error with the
/// option as its field.
options::wishes with_options(options::wishes w, const net::json& given, options_for which);

/// Returns the answer to the method `options`: a row for each option that a client may give, with the owner's
/// value.
net::reply_json option_rows(const options::wishes& owner);

/// Part of a plan that is asked for: all, or one for a picture.
enum class view_kind { full, bursts, percept, peaks };

/// Most rows of samples, and of felt places, in a view of all strokes together; least time from one to the
/// next of a stroke, s.
inline constexpr double most_view_rows = 2000.0;
inline constexpr double view_step_s = 0.002;

struct view_choice {
    view_kind kind = view_kind::full;
    std::size_t bins = 400; ///< of peaks
};

/// Reads `view` and `bins`. \throws fault_error naming the parameter.
view_choice read_view(const net::json& params);

/// Returns the owner's options with the request's `options` and `observer` over them. \throws what
/// with_options() throws.
options::wishes settle_options(options::wishes owner, const net::json& params);

/// Start of a stroke: now, at a time, or armed, which waits for fire.
struct start_time {
    bool armed = false;
    std::optional<std::int64_t> at_ns = {}; ///< CLOCK_MONOTONIC
};

/// Reads a start; null: now. \throws fault_error naming it.
start_time read_start(const net::json* start, std::int64_t now_ns);

} // namespace tactor::server
