// SPDX-License-Identifier: MIT
/// \file
/// What is drawn: an array, strokes and their plans in one time.
#pragma once

#include <deque>
#include <span>
#include <string>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/percept.hpp>
#include <tactor/plan.hpp>
#include <tactor/render.hpp>
#include <tactor/stroke.hpp>

#include "plot/paint/canvas.hpp"

namespace tactor::plot {

/// The matter of a picture. It refers to what it is made of.
struct scene {
    const array& tactors;
    std::string name; ///< of the piece
    const std::vector<stroke>& strokes;
    const std::vector<placed_plan>& plans; ///< one for each stroke
    const score* sound = nullptr;          ///< for the waveform
    /// Where bursts that were moved for an observer are felt; none, or one for each stroke.
    std::span<const compensated_plan> moved = {};
};

/// A burst in the time of the piece; for `continuous`, an instant.
struct shown_burst {
    std::size_t number = 0; ///< in the piece, from 0
    std::size_t stroke = 0;
    double from_s = 0.0;
    double to_s = 0.0;
    double target_s = 0.0; ///< when the target is at the burst's position
    const burst* what = nullptr;
};

/// All bursts of a scene in one time. It refers to the scene's plans.
struct timeline {
    std::vector<double> starts_s = {};   ///< of each stroke
    std::vector<std::size_t> looks = {}; ///< of each stroke, from 0; repeats of a stroke share one
    double total_s = 0.0;
    std::vector<shown_burst> bursts = {};
    std::vector<unsigned> playing = {}; ///< tactors that play, ascending
    double peak = 1.0;                  ///< largest amplitude, at least 1
    bool sampled = false;               ///< some plan is continuous: its "bursts" are instants
    double sample_s = 0.0;              ///< interval of the instants
    std::deque<burst> instants = {};    ///< what they refer to

    /// Then colours tell strokes apart, not times.
    bool several() const noexcept { return starts_s.size() > 1; }

    timeline() = default;
    timeline(timeline&&) = default;
    timeline& operator=(timeline&&) = default;
};

timeline make_timeline(const scene& s);

/// Returns a stroke's name without " (2 of 3)", which repeats have in files; empty for what is no repeat.
std::string find_repeated_name(const std::string& name);

/// Draws a strip of the colours of time, over x; in an animated picture a mark moves over it.
void draw_time_strip(canvas& c, box where);

/// Returns the colour of a burst: of its time in the piece where there is one stroke, of its stroke where
/// there are several.
colour colour_of(const timeline& t, const shown_burst& b) noexcept;

} // namespace tactor::plot
