// SPDX-License-Identifier: MIT
/// \file
/// A calibration of several tactors: the adaptive staircase of each (Levitt 1971) or its QUEST+ (Watson
/// 2017), the next trial, the effect of an answer, and the thresholds. Also a simulated observer, which tests
/// the software and says nothing about people.
/// Uses no clock and no device: the same settings and answers give the same trials.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "study/random/random.hpp"
#include "study/statistics/quest.hpp"
#include "study/statistics/up_down.hpp"

namespace tactor::study {

/// Lowest level: below it nothing is left of a sample of 24 bits.
inline constexpr double floor_dbfs = -144.0;
/// Number of reversals after which the threshold is final.
inline constexpr std::size_t most_reversals = 24;

/// Number of check trials above the threshold, and of those below it; and the number of right answers below
/// it from which the threshold is too high. Guesses reach it in 11 of 1024 series.
inline constexpr std::size_t check_count = 10;
inline constexpr std::size_t too_many_below = 9;

struct staircase_options {
    unsigned right_for_down = 3; ///< 3: 79.4 %, 2: 70.7 %
    double start_dbfs = -20.0;
    double ceiling_dbfs = 0.0;
    std::vector<double> steps_db = {4.0, 2.0, 1.0}; ///< the next one after every second reversal
    std::size_t reversals = 12;                     ///< at most most_reversals
    std::size_t discard = 4;                        ///< the first reversals; at least two must be left
};

enum class staircase_end {
    felt,
    not_felt,
    below_range, ///< right at floor_dbfs, so something other than the skin felt it
};

/// Mean and standard deviation (n - 1) of the reversals that count: an even number, the last ones.
struct reversal_mean {
    double mean_dbfs = 0.0;
    double sd_db = 0.0;
    double halves_db = 0.0; ///< difference of the means of both halves
};
/// Averages the last `counted` reversals.
reversal_mean average_reversals(std::span<const double> reversals_dbfs, std::size_t counted);

/// A tactor's measurement: a staircase, check trials above its threshold, and check trials below it. If too
/// many trials below are right, the staircase runs once more, from there.
class staircase {
public:
    explicit staircase(staircase_options o);

    /// Returns the level of the next trial; check trials included.
    double level_dbfs() const noexcept { return level_; }
    std::optional<staircase_end> end() const noexcept { return end_; }
    /// Takes the answer to the trial at level_dbfs(). Returns true if it turned the direction.
    bool answer(bool right);

    /// Trials of both staircases, and their check trials.
    std::size_t trials() const noexcept { return trials_; }
    /// Number of staircases begun: 1 or 2.
    std::size_t staircases() const noexcept { return staircases_; }
    /// Reversals of the last staircase. The functions below are about that one, too.
    const std::vector<double>& reversals_dbfs() const noexcept { return run_.reversals; }
    /// Number of right answers to the check trials above and below the threshold; nothing before there were
    /// any.
    std::optional<std::size_t> check_right() const noexcept { return run_.above.right_answers(); }
    std::optional<std::size_t> check_below_right() const noexcept { return run_.below.right_answers(); }
    /// Threshold from the reversals, even of a tactor that was not felt if the staircase got so far.
    std::optional<reversal_mean> threshold() const noexcept { return run_.threshold; }

private:
    struct check_trials {
        std::size_t given = 0;
        std::size_t right = 0;

        std::optional<std::size_t> right_answers() const noexcept
        {
            return given == 0 ? std::nullopt : std::optional(right);
        }
    };
    struct run {
        up_down_rule rule;
        std::vector<double> reversals = {};
        std::vector<bool> at_ceiling = {}; ///< right or not
        unsigned right_at_floor = 0;
        std::optional<reversal_mean> threshold = {};
        check_trials above = {};
        check_trials below = {};
    };

    bool step(bool right);
    up_down_rule make_rule() const;
    void note_at_ceiling(bool right);
    void note_at_floor(bool right);
    void settle();
    void check(bool right);
    void go_to(double level_dbfs);

    staircase_options o_;
    double level_;
    run run_;
    std::size_t staircases_ = 1;
    std::size_t trials_ = 0;
    std::optional<staircase_end> end_ = {};
};

enum class calibration_method { staircase, quest, adjustment };
constexpr std::string_view to_string(calibration_method m) noexcept
{
    constexpr std::string_view names[] = {"staircase", "quest", "adjustment"};
    return names[static_cast<std::size_t>(m)];
}
/// Returns true if a method asks which of two intervals vibrated.
constexpr bool asks(calibration_method m) noexcept
{
    return m != calibration_method::adjustment;
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
    std::vector<double> ceilings_dbfs = {}; ///< ceiling of each of these
    staircase_options staircase = {};       ///< its ceiling is not used
    std::size_t trials = 30;                ///< quest: for each tactor, at most
    std::optional<double> stop_sd_db = {};  ///< quest: posterior deviation at which a tactor ends early
    double carrier_hz = 250.0;
    double interval_s = 0.5;
    bool feedback = true;
    std::string masker = {};     ///< the masking noise in words; empty: none
    std::string masker_pcm = {}; ///< the device that it comes from
    unsigned practice = 0;       ///< trials at the start level on the first tactor, which do not count
    std::uint32_t seed = 0;
    std::string simulate = {}; ///< the simulated observer as it was asked for; empty: a person
    std::string date = {};     ///< UTC day on which it began
    std::string array = {};    ///< SHA-256 of what the array file will say besides the thresholds

    /// Returns the start level, before the ceiling of a tactor lowers it.
    double start_dbfs() const noexcept { return staircase.start_dbfs; }
};

/// Returns "1up3down" or "1up2down".
std::string rule_name(const calibration_settings& s);

struct calibration_trial {
    std::size_t number = 0; ///< from 1, over the whole session
    unsigned tactor = 0;
    double level_dbfs = 0.0;   ///< adjustment: level at which the series starts
    double ceiling_dbfs = 0.0; ///< of this tactor
    unsigned interval = 0;     ///< 1 or 2: which one sounds; 0: an adjustment
    bool practice = false;
    std::size_t place = 0;     ///< number of the tactor in the session, from 1
    std::size_t on_tactor = 0; ///< number among the trials or series of this tactor, from 1
};

/// An answer: to a trial of a staircase or of QUEST+ `interval`, to an adjustment the level set.
struct calibration_answer {
    unsigned interval = 0;
    std::optional<double> set_dbfs = {}; ///< nothing: not felt at any level
    std::optional<double> response_time_s = {};
    std::optional<std::uint64_t> onset_frame = {}; ///< frame of the stream with which the trial begins
};

/// A line of the log.
struct calibration_record {
    calibration_trial trial = {}; ///< for an adjustment with the level that was set
    std::string response = {};    ///< "1", "2"; "set", "none"
    std::optional<bool> correct = {};
    bool reversal = false;
    std::optional<double> response_time_s = {};
    std::optional<std::uint64_t> onset_frame = {};
};

struct tactor_threshold {
    unsigned tactor = 0;
    staircase_end end = staircase_end::felt;
    std::optional<double> threshold_dbfs = {}; ///< nothing if it was not felt
    std::optional<double> sd_db = {};
    std::optional<double> posterior_sd_db = {}; ///< quest
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
    quest make_quest() const;
    void after_interval(const calibration_answer& a, calibration_record& r);
    void after_quest(bool right);
    void after_series(const calibration_answer& a, calibration_record& r);
    void finish_tactor(tactor_threshold t);

    calibration_settings settings_;
    std::size_t place_ = 0; ///< in settings_.tactors
    std::size_t given_ = 0; ///< number of all answered trials
    unsigned practised_ = 0;
    random_numbers intervals_;
    staircase stairs_;
    std::optional<quest> quest_ = {};
    std::size_t answered_ = 0; ///< answered trials or series of this tactor
    std::size_t wrong_ = 0;    ///< quest: wrong answers of this tactor
    std::vector<double> series_dbfs_ = {};
    calibration_trial trial_ = {};
    std::vector<tactor_threshold> thresholds_ = {};
};

struct observer_settings {
    std::vector<double> thresholds_dbfs = {}; ///< one for all, or one for each measured tactor
    double spread_db = 2.0;                   ///< 0: a step at the threshold
    double lapse = 0.0;                       ///< 0 to 0.5
    std::optional<std::uint64_t> seed = {};   ///< none: the session's
};

/// Reads "seed=1,threshold=-45,spread=2,lapse=0.02"; threshold=-45,-50,... is a list. It has an entry for
/// each of the `measured` tactors, or for each of `all` tactors of the array. \throws error (bad_input)
/// naming simulate.
observer_settings parse_observer(std::string_view text, const std::vector<unsigned>& measured,
                                 std::size_t all);

/// Returns the chance of a right answer: 0.5 + (0.5 - lapse) Phi((level - threshold) / spread).
double right_at(const observer_settings& o, double threshold_dbfs, double level_dbfs);

/// Simulated observer that answers trials in order. To resume, it must answer all earlier trials again.
class observer {
public:
    observer(observer_settings o, const calibration_settings& s);

    calibration_answer answer(const calibration_trial& t);

private:
    double find_threshold(unsigned tactor) const;
    calibration_answer adjust(const calibration_trial& t);

    observer_settings o_;
    std::vector<unsigned> tactors_;
    random_numbers r_;
};

/// Returns "9 tactors, about 480 trials: some 30 minutes" for the rest of a calibration. Counts the trials
/// that a simulated observer needs, with time for the answers.
std::string time_text(const calibration& c);

} // namespace tactor::study
