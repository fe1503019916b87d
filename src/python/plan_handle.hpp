// SPDX-License-Identifier: MIT
/// \file
/// A plan with what it was made of and for, so that it can be recorded, drawn and rendered.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "python/binding.hpp"
#include "python/options.hpp"
#include "session/piece.hpp"

namespace tactor::python {

struct plan_handle {
    std::shared_ptr<array_handle> on;
    session::piece one;                          ///< of one stroke
    render_options sound = {};                   ///< how it sounds where nobody says otherwise
    std::vector<std::string> sound_options = {}; ///< names of those that were set

    /// Returns the plan placed at `start_s`. Its own start counts from its stroke's anchor.
    placed_plan at(std::optional<double> start_s) const
    {
        const placed_plan& p = placed();
        return {p.plan, start_s, start_s == p.start_s ? p.anchor : start_anchor{}};
    }
    const stroke& drawn() const noexcept { return one.strokes.front(); }
    const placed_plan& placed() const noexcept { return one.plans.front(); }
    const tactor::plan& plan() const noexcept { return placed().plan; }
};

/// Returns a piece of one stroke, fitted and timed as its file and the options ask. \throws error (bad_input)
/// where it is part of a group that is fitted as a single picture.
session::piece place_stroke(const stroke& s, const layout& faces, const wishes& w);

/// Fills in the channels that the array and the marker need, if no number is given.
render_options settled(const array& a, render_options o);

/// Returns all that decides how the plan sounds by itself, as values that Python compares and hashes.
py::tuple plan_recipe(const plan_handle& p);

/// Compares arrays. \throws error (bad_input) if the plan is for tactors elsewhere or on other channels.
void check_same_array(const plan_handle& p, const array& in_use);

} // namespace tactor::python
