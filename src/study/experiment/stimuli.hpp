// SPDX-License-Identifier: MIT
/// \file
/// The stimuli of an experiment: each motion by each method that a run asks for, planned and compared with
/// the array's limits before the session.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/percept.hpp>
#include <tactor/plan.hpp>
#include <tactor/render.hpp>

#include "study/experiment/definition.hpp"
#include "study/experiment/sequence.hpp"

namespace tactor::study {

struct stimulus {
    std::size_t motion = 0; ///< places in the definition
    std::size_t method = 0;
    tactor::plan plan = {};
    std::uint64_t frames = 0;          ///< from its first frame to its last sound's end
    std::string text = {};             ///< the plan as tactor-plan/1
    std::string hash = {};             ///< its SHA-256
    percept_summary felt = {};         ///< predicted
    std::vector<point> felt_path = {}; ///< predicted, at equal parts of the time
};

/// Number of equal parts in which movements are compared.
inline constexpr std::size_t path_parts = 100;

/// Returns the target's places at 0, 1, ... path_parts parts of its time.
std::vector<point> target_path(const stroke& s);

class stimulus_set {
public:
    /// Plans, predicts and checks all stimuli; keeps each warning of the planner once.
    /// \throws error (bad_input) with the motion's or method's line: it cannot be planned, or a level is too
    ///         high.
    stimulus_set(const experiment_definition& d, const array& a, const render_options& o);

    /// Returns a stimulus that a run asks for.
    const stimulus& at(std::size_t motion, std::size_t method) const;
    /// Lists all stimuli, in the order of the runs.
    const std::vector<stimulus>& all() const noexcept { return all_; }
    const std::vector<std::string>& warnings() const noexcept { return warnings_; }

    /// Return the frames of a trial, the gap included, and the frame at which the second stimulus begins.
    std::uint64_t frames(const planned_trial& t) const;
    std::uint64_t second(const planned_trial& t) const;
    /// Returns both stimuli in one score, exact to the frame. A renderer applies the limits, if any.
    score make_score(const planned_trial& t, const std::optional<drive_limits>& limits = {}) const;

private:
    const stimulus* find(std::size_t motion, std::size_t method) const noexcept;
    stimulus make(const motion_definition& motion, const method_definition& method, const layout& faces);

    array array_;
    render_options options_;
    std::uint64_t gap_frames_ = 0;
    std::vector<stimulus> all_ = {};
    std::vector<std::string> warnings_ = {};
};

} // namespace tactor::study
