// SPDX-License-Identifier: MIT
/// \file
/// Trials as a study's tables hold them, and as the analysis reads them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "study/data/drawing.hpp"
#include "study/data/outline.hpp"

namespace tactor::study {

// Bounds of the number that a participant types as an estimate, and of its length in characters. The bounds
// have room for all numbers of this length.
inline constexpr double least_estimate = 1e-11;
inline constexpr double most_estimate = 1e12;
inline constexpr std::size_t most_estimate_characters = 12;

/// Reads an estimate: digits, with or without a decimal point. Returns nothing for other texts and for
/// numbers out of bounds.
std::optional<double> read_estimate(std::string_view text) noexcept;

/// A line of a table of trials. Empty texts and missing values are n/a in the file.
struct trial_row {
    std::optional<double> onset_s = {}; ///< time since the run's first sample at the DAC
    double duration_s = 0.0;            ///< time from the first stimulus frame to the last, including the gap
    unsigned trial = 0;                 ///< place in the sequence, from 1
    unsigned attempt = 1;
    std::string group = {};
    session_number session = {};
    std::string motion = {};
    std::string method_1 = {};
    std::string method_2 = {};
    std::string method_3 = {};
    std::string response = {};
    std::string target = {}; ///< target that the task compares the answer with; usually empty
    std::optional<double> response_time_s = {};
    std::optional<bool> early = {}; ///< missing if there is no answer, or if an older version wrote the data
    std::optional<unsigned> rating = {};
    std::optional<double> value = {};   ///< value that the run varies, if the trial has one
    std::optional<double> start = {};   ///< value from which the participant moved the comparison
    std::optional<unsigned> moves = {}; ///< number of moves
    std::optional<unsigned> track = {}; ///< track of an adaptive run, from 1
    std::optional<double> intensity_estimate = {};
    bool is_void = false;
    unsigned xruns = 0;
    unsigned stream = 0; ///< counts the openings of the device, from 1
    std::optional<std::uint64_t> frame_1 = {};
    std::optional<std::uint64_t> frame_2 = {};
    std::optional<std::uint64_t> frame_3 = {};
    std::string plan_1 = {}; ///< SHA-256 of the first stimulus' plan
    std::string plan_2 = {};
    std::string plan_3 = {};
};

/// Cells of a trial that describe one stimulus.
struct stimulus_cells {
    std::string trial_row::*method;
    std::optional<std::uint64_t> trial_row::*frame;
    std::string trial_row::*plan;
};

/// Greatest number of stimuli of a trial.
inline constexpr std::size_t most_stimuli = 3;

/// Cells of the stimuli, in the order in which they play.
inline constexpr std::array<stimulus_cells, most_stimuli> stimuli_cells{
    {{&trial_row::method_1, &trial_row::frame_1, &trial_row::plan_1},
     {&trial_row::method_2, &trial_row::frame_2, &trial_row::plan_2},
     {&trial_row::method_3, &trial_row::frame_3, &trial_row::plan_3}}};

/// A valid trial. `motion` and the methods are indices into the run's lists.
struct trial {
    unsigned place = 0; ///< place in the sequence, from 1
    unsigned attempt = 1;
    std::size_t motion = 0;
    std::size_t method_1 = 0;
    std::size_t method_2 = 0; ///< second method, only in choose
    unsigned odd = 0;         ///< place of the stimulus that differs, from 1 (oddity)
    unsigned response = 0;    ///< answer as in the table (identify: index of the motion); unused in estimate
    double estimate = 0.0;    ///< number that the participant gave (estimate)
    drawing drawn = {};       ///< answer (locate, trace)
    drawing target = {};      ///< target (locate, trace), see task::format_target()
    double value = 0.0;       ///< value of the option or parameter that the run varies
    bool positive = false;    ///< true for the answers felt, different, more, comparison or second word
    bool signal = true;       ///< true if there was a stimulus (detect) or stimuli differed (same-different)
    std::optional<double> response_time_s = {};
    std::optional<bool> early = {}; ///< true if sooner than min_response_s; missing if not recorded
    session_number session = {};
    unsigned track = 0; ///< track of an adaptive run, from 1; 0 if not recorded
};

/// A track of an adaptive run in a session.
struct played_track {
    session_number session = {};
    unsigned track = 0; ///< from 1
    std::string motion = {};
    std::string method = {};
    std::string procedure = {};
    std::size_t trials = 0;                    ///< number of trials that count
    bool ended = false;                        ///< true if stop_sd or reversals ended it
    std::optional<std::size_t> reversals = {}; ///< number of a staircase's reversals
    std::optional<double> sd = {};             ///< posterior sd of the threshold (QUEST+)
};

/// A participant's trials of one run in all sessions.
struct run_data {
    std::vector<trial> trials = {};
    std::size_t voids = 0;                        ///< number of void lines, which do not count
    std::size_t dropped = 0;                      ///< number of trials that the selection leaves out
    unsigned sessions = 1;                        ///< number of sessions that the participant has begun
    std::vector<predicted_path> predictions = {}; ///< predictions of the first session, for all runs
    std::vector<played_track> tracks = {};        ///< tracks, if they may end early; dropped trials count
};

/// A participant whose trials are left out, with the reason.
struct excluded_person {
    std::string participant;
    std::string why;
};

} // namespace tactor::study
