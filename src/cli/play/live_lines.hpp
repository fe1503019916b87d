// SPDX-License-Identifier: MIT
/// \file
/// Lines "x y [intensity]" that move a live stroke.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <tactor/stroke.hpp>

namespace tactor::cli {

/// Time-out of live strokes, s: only the end of the pipe ends them.
inline constexpr double live_timeout_s = 86400.0;

/// Reader of points in lines.
class live_lines {
public:
    /// Reads the descriptor without waiting, whatever its mode. An intensity of `intensity_max` means 1.
    explicit live_lines(int descriptor, double intensity_max = 1.0)
        : fd_(descriptor), intensity_max_(intensity_max)
    {
    }

    /// Returns the next available place, mm, and its intensity; nothing if there is none yet, and at the end.
    /// Skips empty lines and those that begin with #. A line with nan gives the last place at intensity 0.
    /// \throws error (bad_input) with the line.
    std::optional<timed_point> next();
    /// Warns of how the newest point is played.
    void warn(const std::string& remark) const;
    /// Returns true once the input has ended and all points were returned.
    bool over() const noexcept { return end_ && buffer_.empty(); }
    double intensity_max() const noexcept { return intensity_max_; }
    /// Returns the descriptor, which is readable when input is available.
    int descriptor() const noexcept { return fd_; }

private:
    bool fill();
    std::optional<timed_point> parse(std::string_view line);

    int fd_;
    double intensity_max_;
    std::string buffer_;
    std::size_t line_ = 0;
    std::optional<point> last_ = {}; ///< newest place
    bool end_ = false;
};

} // namespace tactor::cli
