// SPDX-License-Identifier: MIT
/// \file
/// Points as a recorder delivers them. The same rules apply to files, messages and arrays.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/error.hpp>
#include <tactor/stroke.hpp>

namespace tactor::detail {

/// Values of a recorded point. `row` stands for the whole point.
enum class recorded : std::size_t { t_s, x_mm, y_mm, intensity, row };

/// Points of one recording. Times are shifted so that the first is 0. Of points with equal times, the last
/// one counts. The touch is lifted where a place or an intensity is not a number (nan).
class recorded_points {
public:
    /// Function that returns the place in the file of a value of the newest point.
    using find_place = std::function<source_place(recorded)>;

    /// \param intensity_max value that means intensity 1, above 0
    /// \param where if empty, messages count points from 1
    /// \param unit word for a point in messages
    /// \throws error (bad_input) for an impossible intensity_max.
    explicit recorded_points(double intensity_max, find_place where = {}, std::string_view unit = "point");

    void reserve(std::size_t points) { points_.reserve(points); }

    /// Adds a point.
    /// \throws error (bad_input) for values out of range and descending times.
    void add(const timed_point& p);

    /// Returns the points.
    /// \throws error (bad_input) for fewer than two points.
    std::vector<timed_point> take();

    /// Returns warnings about irregular points that were accepted. Call it after take().
    const std::vector<std::string>& warnings() const noexcept { return warnings_; }

private:
    /// Number of points with a particular irregularity, and the place of the first such point.
    struct oddity {
        std::size_t count = 0;
        std::string first = {};
    };

    void check(const timed_point& p) const;
    double subtract_first_time(double t_s);
    void add_after_gap(const timed_point& p);
    void append(const timed_point& p);
    void warn();
    std::string here() const;
    void note(oddity& o);
    [[noreturn]] void refuse(recorded value, std::string_view why, std::string_view hint) const;

    double intensity_max_;
    find_place where_;
    std::string_view unit_;
    std::vector<timed_point> points_;
    std::size_t added_ = 0;
    bool in_gap_ = false;
    double first_time_s_ = 0.0;
    double last_time_s_ = 0.0;
    oddity gaps_;
    oddity repeated_;
    std::vector<std::string> warnings_;
};

} // namespace tactor::detail
