// SPDX-License-Identifier: MIT
/// \file
/// Contents of a picture: an array, strokes and their plans in one time.
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

/// Contents of a picture. Its parts must live as long.
struct scene {
    const array& tactors;
    std::string name; ///< of the whole
    const std::vector<stroke>& strokes;
    const std::vector<placed_plan>& plans; ///< one for each stroke
    const score* sound = nullptr;          ///< for the waveform
    /// Felt places of bursts that were moved for an observer; none, or one for each stroke.
    std::span<const compensated_plan> moved = {};
};

/// A burst in the time of the scene; for `continuous`, an instant.
struct shown_burst {
    std::size_t number = 0; ///< in the scene, from 0
    std::size_t stroke = 0;
    double from_s = 0.0;
    double to_s = 0.0;
    double target_s = 0.0; ///< time at which the target is at the burst's position
    const burst* what = nullptr;
};

/// Bursts of a scene in one time. The scene's plans must live as long.
struct timeline {
    std::vector<double> starts_s = {};   ///< of each stroke
    std::vector<double> ends_s = {};     ///< of each stroke, its last burst included
    std::vector<std::size_t> looks = {}; ///< of each stroke, from 0; repeats share one
    double total_s = 0.0;
    std::vector<shown_burst> bursts = {};
    std::vector<unsigned> playing = {}; ///< tactors that play, ascending
    double peak = 1.0;                  ///< largest amplitude, at least 1
    bool sampled = false;               ///< a plan is continuous: its "bursts" are instants
    double sample_s = 0.0;              ///< interval of the instants
    std::deque<burst> instants = {};    ///< the bursts of these instants

    /// Returns true for several strokes: then colours show strokes, not times.
    bool several() const noexcept { return starts_s.size() > 1; }

    timeline() = default;
    timeline(timeline&&) = default;
    timeline& operator=(timeline&&) = default;
};

timeline make_timeline(const scene& s);

/// Returns a stroke's name without " (2 of 3)", which repeats have in files; empty for other strokes.
std::string find_repeated_name(const std::string& name);

/// Draws a strip of the colours of time, along x; in an animated picture a mark moves over it.
void draw_time_strip(canvas& c, box where);

/// Returns the colour of a burst: of its time if there is one stroke, of its stroke if there are several.
colour burst_colour(const timeline& t, const shown_burst& b) noexcept;

} // namespace tactor::plot
