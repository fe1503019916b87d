// SPDX-License-Identifier: MIT
/// \file
/// Parameters of requests: options, a start, and strokes, from which plans and scores are made.
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

/// Converts a time, ns, to seconds, as in messages.
inline double seconds(std::int64_t ns) noexcept
{
    return static_cast<double>(ns) * 1e-9;
}

/// Kind of strokes that options are for. Strokes that are planned ahead have more options than live ones.
enum class options_for { planned, live };

/// Returns the owner's options, overridden by those of a client.
/// \throws fault_error, or error with the option as its field.
options::option_values with_options(options::option_values w, const net::json& chosen, options_for which);

/// Returns the answer to the method `options`: a row for each option that a client may set, with the owner's
/// value.
net::reply_json option_rows(const options::option_values& owner);

/// Returns the owner's options, overridden by the request's `options` and `observer`.
/// \throws as with_options().
options::option_values resolve_options(options::option_values owner, const net::json& params);

/// Start of a stroke: now, at a time, or armed until `fire`.
struct start_time {
    bool armed = false;
    std::optional<std::int64_t> at_ns = {}; ///< CLOCK_MONOTONIC
    std::vector<std::uint32_t> after = {};  ///< strokes whose round must end first
};

/// Reads a start; null: now. \throws fault_error naming it.
start_time read_start(const net::json* start, std::int64_t now_ns);

/// Settings that all plans share.
struct planning {
    array tactors;
    options::option_values owner; ///< owner's options, with the stream's rate and channels
    double max_level_dbfs = -12.0;
    double max_stroke_s = 600.0; ///< longest stroke, and longest total of the strokes of one request
    std::size_t max_strokes = 64;
};

/// Planned strokes of a request.
struct planned : session::piece {
    render_options render = {};
    std::uint64_t rounds = 1; ///< number of times that one submission plays them, round_s() apart
    double least_round_s = 0.0;
    double pause_s = 0.0;                  ///< silence after each round
    detail::observer_choice observer = {}; ///< for the view percept
    double over_db = 0.0;                  ///< view only: amount by which it must be weaker to be played
    weakening weakened = {};               ///< weakening of all plans together

    double round_s() const { return std::max(total_s(), least_round_s) + pause_s; }
    std::vector<std::string> warnings() const;
    /// Returns the number of bursts of one round; a continuous stroke counts as one.
    double count_bursts() const;
    /// Returns the score of all rounds of one plan, as weak as all together, to be submitted by itself.
    score make_score(const array& a, std::size_t i) const;
};

/// Packs points that wait to be planned. As JSON they take ten times as much memory, in small blocks.
void pack_points(net::json& params);

/// Reads the strokes of a parameter.
/// \throws error, fault_error.
std::vector<stroke> read_strokes(const std::string& source, const net::json& v,
                                 const options::option_values& s);

/// Places the strokes on the array, each with its pace: fits those that request it, and with `fit` all of
/// them together.
/// \throws fault_error if there are too many or if they last too long; error.
std::vector<stroke> prepare_strokes(const planning& with, const layout& faces, std::vector<stroke> strokes,
                                    options::option_values s, bool fit);

/// Returns the parameter that contains strokes, one of session::source_names().
/// \throws fault_error for none or several.
std::string find_source(const net::json& params);

/// Refuses more bursts than the service plans at once.
/// \throws fault_error.
void check_bursts(double bursts, const char* hint);

/// Function that a planner calls between strokes. It may throw.
using go_on_check = std::function<void()>;

/// Plans p.strokes into p.plans and p.moved. `source`: parameter that contained them. With `picture` a level
/// that is too high is not a fault: p.over_db has the excess.
/// \throws fault_error for a level above the owner's; error.
void plan_strokes(const planning& with, const layout& faces, planned& p, const options::option_values& s,
                  const std::string& source, const go_on_check& go_on, bool picture = false);

/// Adds to an answer how much weaker than requested strokes are, and where they meet.
void add_weakening(net::reply_json& to, const weakening& w);

/// Reads and plans strokes. `s`: result of resolve_options() for these parameters.
/// \throws fault_error, and exceptions of `go_on`.
planned make_planned(
    const planning& with, const layout& faces, const net::json& params, const options::option_values& s,
    const go_on_check& go_on = [] {});

/// Returns a plan that drives a single tactor for a time.
/// \throws fault_error.
planned make_drive(const planning& with, const net::json& params);

/// Checks the level at an intensity and a carrier.
/// \throws fault_error if it is above the owner's. The fault is about the level, or about `source` if only
///         its intensity is too high.
void check_level(const planning& with, const options::option_values& s, double intensity, double carrier_hz,
                 const std::string& source);

} // namespace tactor::server
