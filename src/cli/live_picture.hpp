// SPDX-License-Identifier: MIT
/// \file
/// The array on a terminal while it plays.
#pragma once

#include <string>
#include <vector>

#include <tactor/tactor.hpp>

namespace tactor::cli {

/// What the plans of a piece do at one time.
struct instant {
    std::vector<double> levels;  ///< per tactor, linear, 1 is the intensity asked for
    std::optional<point> target; ///< where the phantom is
};

/// Looks a time of a piece up in its plans. `starts_s`: start of each plan.
instant at_time(const std::vector<placed_plan>& plans, const std::vector<double>& starts_s,
                std::size_t tactors, double t_s);

/// Draws over itself. Restores the cursor when destroyed. Where standard output is no terminal, or
/// NO_COLOR is set, it draws nothing.
class live_picture {
public:
    explicit live_picture(const array& a, bool wanted = true);
    ~live_picture();
    live_picture(const live_picture&) = delete;
    live_picture& operator=(const live_picture&) = delete;

    bool active() const noexcept { return active_; }
    void draw(const instant& now, double t_s, double total_s);

private:
    struct cell {
        unsigned row = 0;
        unsigned column = 0;
    };
    cell cell_of(point p) const;
    void clear();

    bool active_;
    point origin_;
    double mm_per_column_ = 1.0;
    unsigned rows_ = 1;
    unsigned columns_ = 1;
    std::vector<cell> tactors_;
    unsigned drawn_lines_ = 0;
};

} // namespace tactor::cli
