// SPDX-License-Identifier: MIT
/// \file
/// Parameters of requests: options, a start, and strokes, of which they make plans and scores.
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

/// Converts a time, ns, to the seconds that messages have.
inline double seconds(std::int64_t ns) noexcept
{
    return static_cast<double>(ns) * 1e-9;
}

/// Strokes that are planned ahead know more options than live ones.
enum class options_for { planned, live };

/// Returns the owner's options with those of a client over them. \throws fault_error, or error with the
/// option as its field.
options::wishes with_options(options::wishes w, const net::json& given, options_for which);

/// Returns the answer to the method `options`: a row for each option that a client may give, with the owner's
/// value.
net::reply_json option_rows(const options::wishes& owner);

/// Returns the owner's options with the request's `options` and `observer` over them. \throws what
/// with_options() throws.
options::wishes settle_options(options::wishes owner, const net::json& params);

/// Start of a stroke: now, at a time, or armed, which waits for fire.
struct start_time {
    bool armed = false;
    std::optional<std::int64_t> at_ns = {}; ///< CLOCK_MONOTONIC
    std::vector<std::uint32_t> after = {};  ///< strokes whose round is to end before
};

/// Reads a start; null: now. \throws fault_error naming it.
start_time read_start(const net::json* start, std::int64_t now_ns);

/// Settings that all plans share.
struct planning {
    array tactors;
    options::wishes owner; ///< with the stream's rate and channels
    double max_level_dbfs = -12.0;
    double max_stroke_s = 600.0; ///< of a stroke, and of the strokes of one request together
    std::size_t max_strokes = 64;
};

/// The planned strokes of a request.
struct planned : session::piece {
    render_options render = {};
    std::uint64_t rounds = 1; ///< how often one submission plays them, each round_s() after the last
    double least_round_s = 0.0;
    double pause_s = 0.0;                  ///< silence after each round
    detail::observer_choice observer = {}; ///< of the view percept
    double over_db = 0.0;                  ///< of a view: how much weaker it must be to be played
    weakening weakened = {};               ///< of all plans together

    double round_s() const { return std::max(total_s(), least_round_s) + pause_s; }
    std::vector<std::string> warnings() const;
    /// Returns the bursts of one round; a continuous stroke counts as one.
    double count_bursts() const;
    /// Returns the score of all rounds of a plan alone, to be submitted by itself, as weak as all together.
    score make_score(const array& a, std::size_t i) const;
};

/// Packs points that wait to be planned: as JSON they take ten times as much memory, in small blocks.
void pack_points(net::json& params);

/// Reads the strokes that a parameter says. \throws error, fault_error.
std::vector<stroke> read_strokes(const std::string& source, const net::json& v, const options::wishes& s);

/// Returns the strokes on the array, each with its pace: those that ask for it fitted, and with `fit` all of
/// them together. \throws fault_error if there are too many or if they last too long; error.
std::vector<stroke> settle_strokes(const planning& with, const layout& faces, std::vector<stroke> strokes,
                                   options::wishes s, bool fit);

/// Returns the one parameter of these that says what is drawn: "stroke", "path", "points", "toml", "csv" or
/// "svg". \throws fault_error for none or several.
const char* find_source(const net::json& params);

/// Refuses more bursts than are planned at once. \throws fault_error.
void check_bursts(double bursts, const char* hint);

/// A planner calls it between strokes. It may throw.
using go_on_check = std::function<void()>;

/// Plans p.strokes into p.plans and p.moved. `source`: parameter that said them. With `picture` a level that
/// may not be played is no fault: p.over_db has the excess. \throws fault_error for a level above the
/// owner's; error.
void plan_strokes(const planning& with, const layout& faces, planned& p, const options::wishes& s,
                  const std::string& source, const go_on_check& go_on, bool picture = false);

/// Adds to an answer how much weaker than asked for strokes are, and where they meet.
void add_weakening(net::reply_json& to, const weakening& w);

/// Reads and plans. `s`: what settle_options() returned for these parameters. \throws fault_error, and what
/// `go_on` throws.
planned make_planned(
    const planning& with, const layout& faces, const net::json& params, const options::wishes& s,
    const go_on_check& go_on = [] {});

/// Returns a plan that drives one tactor for a time. \throws fault_error.
planned make_drive(const planning& with, const net::json& params);

/// Checks the level at an intensity and a carrier. \throws fault_error if it is above the owner's: about the
/// level, or about `source` if only its intensity is too much.
void check_level(const planning& with, const options::wishes& s, double intensity, double carrier_hz,
                 const std::string& source);

} // namespace tactor::server
