// SPDX-License-Identifier: MIT
/// \file
/// Values of all options, as plain structs of the library.
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include <tactor/choices.hpp>
#include <tactor/error.hpp>
#include <tactor/percept.hpp>
#include <tactor/plan.hpp>
#include <tactor/render.hpp>

#include "percept/compare.hpp"

namespace tactor::options {

struct option;

/// Opening, driving and recording of a stream.
struct stream_options {
    std::optional<double> latency_ms = {};
    std::optional<unsigned> period_frames = {};
    std::optional<unsigned> periods = {};
    bool require_realtime = false;
    double reopen_s = 0.0; ///< time that a lost device is waited for
    bool void_on_xrun = false;
    bool arm = false; ///< strokes wait for an edge on the [sync] in line
    double sync_delay_ms = 50.0;
    bool live = false;                   ///< points come from standard input
    std::optional<double> smooth_s = {}; ///< of those
    bool no_gpio = false;
    bool verbose = false; ///< log on standard error
    std::string log = {}; ///< file that log lines are appended to; empty: none
    std::optional<double> power_dbfs = {};
    std::optional<double> max_drive_s = {};
    std::optional<double> drive_window_s = {};
};

/// Most rows that the table may have.
inline constexpr std::size_t most_options = 128;

/// Values of the options; without one of the user or of [defaults] the built-in default.
struct wishes {
    std::optional<std::string> path_data = {};   ///< SVG path data in place of a stroke
    std::optional<std::string> shape = {};       ///< the same, by the name of a shape
    std::optional<std::string> array_name = {};  ///< preset or file
    std::optional<std::string> config_file = {}; ///< of the configuration
    std::optional<std::string> pcm = {};
    std::optional<double> duration_s = {};
    std::optional<double> speed_mm_s = {};
    std::optional<double> usual_speed_mm_s = {}; ///< of strokes that say neither a time nor a speed
    std::optional<double> intensity_max = {};    ///< value in a recording that means intensity 1
    bool fit = false;
    double fit_margin_mm = 0.0;
    std::optional<unsigned> rate = {};
    std::optional<unsigned> channels = {};
    std::optional<format_kind> format = {};
    bool compensate = false; ///< for low_speed
    observer_kind observer = observer_kind::centroid;
    low_speed_observer low_speed = {};
    detail::spread_choice spread = {};
    plan_options plan = {};
    render_options render = {};
    stream_options stream = {};

    std::uint64_t place = 0;                          ///< front end: bits of `place` in option.hpp
    std::bitset<most_options> given = {};             ///< rows of the user
    std::map<std::size_t, source_place> in_file = {}; ///< rows of [defaults], with their places

    /// Returns true if the user gave the option, which option.hpp defines. \pre There is one of that name.
    bool gives(std::string_view name) const;
    bool gives(const option& o) const;
};

} // namespace tactor::options
