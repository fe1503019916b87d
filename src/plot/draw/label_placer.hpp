// SPDX-License-Identifier: MIT
/// \file
/// Finds places for labels beside what is drawn.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "plot/paint/canvas.hpp"

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

    /// The same, but only where the text lies inside the area and on no other label or tactor; nothing where
    /// there is no such place, which is not taken then. `reach`: how far away it may be, pt.
    std::optional<spot> place_clear(std::string_view text, double size, spot at, double gap, double reach);

    /// The same beside one of many sites, and only where that site is clearly the nearest to the text.
    std::optional<spot> place_at(std::string_view text, double size, const std::vector<spot>& sites,
                                 std::size_t own, double gap, double reach);

    /// Blocks what no label may lie on: a tactor or another label.
    void forbid(box b) { block(b, forbidden); }
    void forbid_disc(spot centre, double radius) { block_disc(centre, radius, forbidden); }

    /// What it would cover, each square point with its weight.
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
