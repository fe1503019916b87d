// SPDX-License-Identifier: MIT
/// \file
/// Finds places for labels beside what is drawn.
#pragma once

#include <vector>

#include "plot/canvas.hpp"

namespace tactor::plot {

/// Knows what is taken, and takes for each label the place where it covers least.
class label_placer {
public:
    /// Labels stay inside `area` if they can.
    explicit label_placer(box area) : area_(area) {}

    /// `weight`: how bad it is to be covered, to the square point.
    void block(box b, double weight) { taken_.push_back({b, weight}); }
    void block_disc(spot centre, double radius, double weight);
    void block_line(const std::vector<spot>& line, double width, double weight);

    /// Where to begin the baseline of `text` near `at`, at least `gap` away from it. The place is taken then.
    spot place(std::string_view text, double size, spot at, double gap);

    /// What it would cover, each square point with its weight.
    double cost(box b) const;

private:
    struct obstacle {
        box b;
        double weight;
    };
    box area_;
    std::vector<obstacle> taken_;
};

} // namespace tactor::plot
