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
    /// Labels stay inside `area` if they can.
    explicit label_placer(box area) : area_(area) {}

    /// Blocks a box. `weight`: cost of covering a square point.
    void block(box b, double weight) { taken_.push_back({b, weight}); }
    void block_disc(spot centre, double radius, double weight);
    void block_line(const std::vector<spot>& line, double width, double weight);

    /// Returns the start of the baseline of `text` near `at`, at least `gap` away from it, and takes that
    /// place.
    spot place(std::string_view text, double size, spot at, double gap);

    /// Does the same, but only for a place inside the area and on no other label or tactor. Returns nothing
    /// if there is none. `reach`: largest distance, pt.
    std::optional<spot> place_clear(std::string_view text, double size, spot at, double gap, double reach);

    /// Does the same next to one of many sites, and only if that site is clearly the nearest to the text.
    std::optional<spot> place_at(std::string_view text, double size, const std::vector<spot>& sites,
                                 std::size_t own, double gap, double reach);

    /// Blocks a place on which no label may lie: a tactor or another label.
    void forbid(box b) { block(b, forbidden); }
    void forbid_disc(spot centre, double radius) { block_disc(centre, radius, forbidden); }

    /// Returns the sum of the covered square points, each with its weight.
    double cost(box b) const;

    static constexpr double forbidden = 20.0;

private:
    template <class Allowed>
    std::optional<spot> best_place(std::string_view text, double size, spot at, double gap, double reach,
                                   Allowed&& allowed);
    bool is_clear(box b) const;

    struct obstacle {
        box b;
        double weight;
    };
    box area_;
    std::vector<obstacle> taken_;
};

} // namespace tactor::plot
