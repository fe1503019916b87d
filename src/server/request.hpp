// SPDX-License-Identifier: MIT
/// \file
/// Parameters of requests: options, start times and strokes. Strokes become plans and scores.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/phantom.hpp>
#include <tactor/render.hpp>
#include <tactor/stroke.hpp>

#include "net/rpc.hpp"
#include "options/option.hpp"
#include "percept/compare.hpp"
#include "session/piece.hpp"

namespace tactor::server {

/// Converts nanoseconds to seconds, the unit in messages.
inline double seconds(std::int64_t ns) noexcept
{
    return static_cast<double>(ns) * 1e-9;
}

/// Kind of strokes to which options apply. Planned strokes have more options than live strokes.
enum class options_for { planned, live };

/// Returns the owner's options, with some values replaced by a client's options.
/// \throws fault_error, or error with the option as its field.
options::option_values replace_options(options::option_values w, const net::json& chosen, options_for which);

/// Returns the answer to the method `options`. It has a row with the owner's value for each option that a
/// client may set.
net::reply_json option_rows(const options::option_values& owner);

/// Returns the owner's options, with some values replaced by `options` and `observer` of a request.
/// \throws as replace_options() does.
options::option_values resolve_options(options::option_values owner, const net::json& params);

/// Longest time from a request to the start of its strokes.
inline constexpr double longest_wait_s = 86400.0;

/// Start of a stroke: immediately, at a time, after other strokes, or when `fire` is called.
struct start_time {
    bool armed = false;
    std::optional<std::int64_t> at_ns = {}; ///< CLOCK_MONOTONIC
    std::vector<std::uint32_t> after = {};  ///< strokes whose current round must end before the start
};

/// Reads a start that check_param() has checked.
/// \throws fault_error that names the start if it is too late.
start_time read_start(const net::json& start, std::int64_t now_ns);

/// Settings that apply to all plans.
struct planning {
    array tactors;
    options::option_values owner; ///< the owner's options, with rate and channels of the stream
    double max_level_dbfs = -12.0;
    double max_stroke_s = 600.0; ///< longest stroke, and longest total of a request's strokes
    std::size_t max_strokes = 64;
};

/// Strokes of a request, with their plans.
struct planned : session::piece {
    render_options render = {};
    std::uint64_t rounds = 1; ///< rounds that one submission plays; they are round_s() apart
    double least_round_s = 0.0;
    double pause_s = 0.0;                  ///< silence after each round
    detail::observer_choice observer = {}; ///< observer for the view percept
    double over_db = 0.0;                  ///< only for views: amount by which the plan is too loud to play
    weakening weakened = {};               ///< weakening of the score of all plans together

    double round_s() const { return std::max(total_s(), least_round_s) + pause_s; }
    std::vector<std::string> warnings() const;
    /// Returns the number of bursts in one round. A continuous stroke counts as one burst.
    double count_bursts() const;
    /// Returns the score of all rounds of plan i, which is submitted separately. It is weakened as much as
    /// the score of all plans together.
    score make_score(const array& a, std::size_t i) const;
};

/// Packs the points of a request that waits for planning. In JSON they take ten times as much memory, in
/// small blocks.
void pack_points(net::json& params);

/// Reads the strokes from parameter `source`.
/// \throws error, fault_error.
std::vector<stroke> read_strokes(const std::string& source, const net::json& v,
                                 const options::option_values& s);

/// Places strokes on the array, and sets the pace of each. Fits the strokes that request it. If `fit` is
/// true, fits all strokes as a whole.
/// \throws fault_error if there are too many strokes or if they last too long; error.
std::vector<stroke> prepare_strokes(const planning& with, const layout& faces, std::vector<stroke> strokes,
                                    options::option_values s, bool fit);

/// Returns the name of the parameter that contains strokes. It is one of session::source_names().
std::string find_source(const net::json& params);

/// Refuses a number of bursts that is above the limit of the service.
/// \throws fault_error.
void check_bursts(double bursts, const char* hint);

/// Function that a planner calls between two strokes. It may throw.
using go_on_check = std::function<void()>;

/// Plans p.strokes. Sets p.plans and p.moved. `source` is the parameter that contained the strokes. If
/// `picture` is true, a level that is too high is not an error, and p.over_db gets the excess.
/// \throws fault_error if the level is above the owner's limit; error.
void plan_strokes(const planning& with, const layout& faces, planned& p, const options::option_values& s,
                  const std::string& source, const go_on_check& go_on, bool picture = false);

/// Adds the weakening of strokes to an answer. If there is any, also adds the tactor, the time and the
/// strokes that overlap there.
void add_weakening(net::reply_json& to, const weakening& w);

/// Reads strokes and plans them. `s` is the result of resolve_options() for `params`.
/// \throws fault_error, and the exceptions of `go_on`.
planned plan_request(
    const planning& with, const layout& faces, const net::json& params, const options::option_values& s,
    const go_on_check& go_on = [] {});

/// Returns a plan that drives a single tactor for a time.
/// \throws fault_error.
planned make_drive(const planning& with, const net::json& params);

/// Checks the level for an intensity and a carrier.
/// \throws fault_error if the level is above the owner's limit. If it is too high only because of the
///         intensity, the fault is about `source`. Otherwise the fault is about the level.
void check_level(const planning& with, const options::option_values& s, double intensity, double carrier_hz,
                 const std::string& source);

} // namespace tactor::server
