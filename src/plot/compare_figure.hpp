// SPDX-License-Identifier: MIT
/// \file
/// What several algorithms are predicted to feel like (as figure 6 of Park et al. 2016), and how fast.
#pragma once

#include <string>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/observer.hpp>
#include <tactor/percept.hpp>
#include <tactor/stroke.hpp>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// What many people feel: part of them at each time, and the ways that some of them feel.
struct people_bands {
    struct range {
        double t_s = 0.0;
        double low = 0.0;
        double high = 0.0;
    };
    std::vector<range> speeds = {}; ///< mm/s
    std::vector<std::vector<point>> tracks = {};
};

/// One algorithm with one phantom model.
struct prediction {
    std::string algorithm;
    std::string phantom;
    const std::vector<percept_sample>& samples; ///< empty where refused
    percept_summary felt;
    std::string refused; ///< why there is no plan; empty where there is
    /// What the low-speed observer feels instead of samples.
    const std::vector<tap>& taps;
    std::string unpredicted; ///< why that one has no prediction; empty where it has
    people_bands people = {};
};

/// For each phantom model a row of panels, one for each algorithm, and under it all their speeds over time.
/// `title` stands over the picture, with the target's length and time; empty: neither. `note` stands under
/// it. \throws error (bad_input) for a width out of bounds (figure.hpp).
canvas draw_comparison(const array& a, const stroke& target, const std::vector<prediction>& all,
                       const std::string& title, const std::string& note, double width_mm);

} // namespace tactor::plot
