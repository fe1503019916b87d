// SPDX-License-Identifier: MIT
/// \file
/// A calibration of several tactors: the next trial, the effect of an answer, and the thresholds. Uses no
/// clock and no device: the same settings and answers give the same trials.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "study/calibrate/staircase.hpp"
#include "study/random/random.hpp"

namespace tactor::study {

enum class calibration_method { staircase, adjustment };
constexpr std::string_view to_string(calibration_method m) noexcept
{
    return m == calibration_method::staircase ? "staircase" : "adjustment";
}

/// Pause between the intervals of a trial, and ramps at their ends, s.
inline constexpr double interval_gap_s = 0.5;
inline constexpr double interval_ramp_s = 0.020;
/// Series for each tactor by adjustment.
inline constexpr unsigned adjustment_series = 6;

struct calibration_settings {
    std::string participant = {};
    calibration_method method = calibration_method::staircase;
    std::vector<unsigned> tactors = {};     ///< in the order in which they are measured
    std::vector<double> ceilings_dbfs = {}; ///< of each of these
    staircase_options staircase = {};       ///< its ceiling is not used
    double carrier_hz = 250.0;
    double interval_s = 0.5;
    bool feedback = true;
    std::string masker = {};     ///< the masking noise in words; empty: none
    std::string masker_pcm = {}; ///< the device that it comes from
    unsigned practice = 0;       ///< trials at the start level on the first tactor, which do not count
    std::uint32_t seed = 0;
    std::string simulate = {}; ///< the simulated observer as it was asked for; empty: a person
    std::string date = {};     ///< on which it began, UTC
    std::string array = {};    ///< SHA-256 of what the array file will say besides the thresholds

    double start_dbfs() const noexcept { return staircase.start_dbfs; } ///< at most each tactor's ceiling
};

/// Returns "1up3down" or "1up2down".
std::string rule_name(const calibration_settings& s);

struct calibration_trial {
    std::size_t number = 0; ///< from 1, over the whole session
    unsigned tactor = 0;
    double level_dbfs = 0.0;   ///< adjustment: at which the series starts
    double ceiling_dbfs = 0.0; ///< of this tactor
    unsigned interval = 0;     ///< 1 or 2: which one sounds; 0: an adjustment
    bool practice = false;
};

/// An answer: to a staircase's trial `interval`, to an adjustment the level set.
struct calibration_answer {
    unsigned interval = 0;
    std::optional<double> set_dbfs = {}; ///< nothing: not felt at any level
    std::optional<double> response_time_s = {};
    std::optional<std::uint64_t> onset_frame = {}; ///< of the stream: the first frame of the trial
};

/// A line of the log.
struct calibration_record {
    calibration_trial trial = {}; ///< of an adjustment with the level that was set
    std::string response = {};    ///< "1", "2"; "set", "none"
    std::optional<bool> correct = {};
    bool reversal = false;
    std::optional<double> response_time_s = {};
    std::optional<std::uint64_t> onset_frame = {};
};

struct tactor_threshold {
    unsigned tactor = 0;
    staircase_end end = staircase_end::felt;
    std::optional<double> threshold_dbfs = {}; ///< nothing where it was not felt
    std::optional<double> sd_db = {};
    std::size_t trials = 0;
    std::vector<double> reversals_dbfs = {};
    std::optional<std::size_t> check_right = {};       ///< of ten trials 6 dB above the threshold
    std::optional<std::size_t> check_below_right = {}; ///< of ten trials 6 dB below it
    std::size_t staircases = 1;
};

class calibration {
public:
    explicit calibration(calibration_settings s);

    bool done() const noexcept { return place_ == settings_.tactors.size(); }
    /// Returns the next trial. Not when done().
    const calibration_trial& next() const noexcept { return trial_; }
    /// Takes the answer to next().
    calibration_record answer(const calibration_answer& a);
    /// Thresholds of the tactors that are measured.
    const std::vector<tactor_threshold>& thresholds() const noexcept { return thresholds_; }
    const calibration_settings& settings() const noexcept { return settings_; }

private:
    void begin_tactor();
    void make_trial();
    void after_staircase(const calibration_answer& a, calibration_record& r);
    void after_series(const calibration_answer& a, calibration_record& r);
    void finish_tactor(tactor_threshold t);

    calibration_settings settings_;
    std::size_t place_ = 0; ///< in settings_.tactors
    std::size_t given_ = 0; ///< trials answered in all
    unsigned practised_ = 0;
    random_numbers intervals_;
    staircase stairs_;
    std::vector<double> series_dbfs_ = {};
    calibration_trial trial_ = {};
    std::vector<tactor_threshold> thresholds_ = {};
};

} // namespace tactor::study
