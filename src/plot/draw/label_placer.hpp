// SPDX-License-Identifier: MIT
/// \file
/// Places of labels next to the drawing.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// Keeper of the taken places. Finds for each label the place at which it covers least.
class label_placer {
public:
    /// Labels stay inside `area`.
    explicit label_placer(box area) : area_(area) {}

    /// Weight of a tactor or label, on which no label may lie.
    static constexpr double forbidden = 1e9;

    /// Blocks a box. `weight`: cost of covering a square point.
    void block(box b, double weight) { taken_.push_back({b, weight}); }
    void block_disc(spot centre, double radius, double weight);
    void block_line(const std::vector<spot>& line, double width, double weight);

    /// Returns the start of the baseline of `text` next to one of many sites, from `gap` up to `reach` pt
    /// farther away, and takes that place. Returns nothing if each place is off the area, on a tactor or
    /// label, or not clearly nearer to that site than to the others.
    std::optional<spot> place(std::string_view text, double size, const std::vector<spot>& sites,
                              std::size_t own, double gap, double reach);

    /// Returns the sum of the covered square points, each with its weight.
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
