// SPDX-License-Identifier: MIT
/// \file
/// A calibration, which measures the thresholds of several tactors by an adaptive staircase (Levitt 1971),
/// QUEST+ (Watson 2017) or adjustment. Also a simulated observer, which tests the software but does not
/// predict the answers of people.
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

/// Lowest level: below it, samples of 24 bits are 0.
inline constexpr double floor_dbfs = -144.0;
/// Greatest number of reversals of a staircase.
inline constexpr std::size_t most_reversals = 24;

/// Number of check trials above the threshold, and again below the threshold. If too_many_below or more
/// answers below the threshold are right, the threshold is too high. Guesses reach this number in 11 of 1024
/// series.
inline constexpr std::size_t check_count = 10;
inline constexpr std::size_t too_many_below = 9;

struct staircase_options {
    unsigned right_for_down = 3; ///< right answers that lower the level: 3 (to 79.4 % right) or 2 (to 70.7 %)
    double start_dbfs = -20.0;
    double ceiling_dbfs = 0.0;
    std::vector<double> steps_db = {4.0, 2.0, 1.0}; ///< step sizes; every second reversal goes to the next
    std::size_t reversals = 12;                     ///< number of reversals, at most most_reversals
    std::size_t discard = 4;                        ///< first reversals to ignore; at least two must remain
};

enum class staircase_end {
    felt,
    not_felt,
    below_range, ///< right answers at floor_dbfs: something other than the skin felt the stimuli
};

/// Mean and standard deviation (n - 1) of the last reversals of a staircase, an even number.
struct reversal_mean {
    double mean_dbfs = 0.0;
    double sd_db = 0.0;
    double halves_db = 0.0; ///< distance between the means of the first and second half
};
/// Averages the last `counted` reversals.
reversal_mean average_reversals(std::span<const double> reversals_dbfs, std::size_t counted);

/// The measurement of one tactor: a staircase, then check trials above and below the threshold. If too many
/// answers below the threshold are right, a second staircase starts from that level.
class staircase {
public:
    explicit staircase(staircase_options o);

    /// Returns the level of the next trial, which may be a check trial.
    double level_dbfs() const noexcept { return level_; }
    std::optional<staircase_end> end() const noexcept { return end_; }
    /// Takes the answer to the trial at level_dbfs(). Returns true if the answer reversed the direction.
    bool answer(bool right);

    /// Number of trials of all staircases, including check trials.
    std::size_t trials() const noexcept { return trials_; }
    /// Number of staircases begun: 1 or 2.
    std::size_t staircases() const noexcept { return staircases_; }
    /// Reversals of the last staircase. The functions below also refer to the last staircase.
    const std::vector<double>& reversals_dbfs() const noexcept { return run_.reversals; }
    /// Number of right answers to the check trials above and below the threshold; nothing before the first
    /// check trial.
    std::optional<std::size_t> check_right() const noexcept { return run_.above.right_answers(); }
    std::optional<std::size_t> check_below_right() const noexcept { return run_.below.right_answers(); }
    /// Threshold from the reversals; nothing if the staircase has not reached it. A tactor that was not felt
    /// may have a threshold, too.
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
        std::vector<bool> at_ceiling = {}; ///< true for each right answer
        unsigned right_at_floor = 0;
        std::optional<reversal_mean> threshold = {};
        check_trials above = {};
        check_trials below = {};
    };

    bool step(bool right);
    up_down_rule make_rule() const;
    void record_ceiling_answer(bool right);
    void record_floor_answer(bool right);
    void settle();
    void check(bool right);
    void move_to_level(double level_dbfs);

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

/// Pause between the intervals of a trial, and ramps at the ends of an interval, s.
inline constexpr double interval_gap_s = 0.5;
inline constexpr double interval_ramp_s = 0.020;
/// Number of series for each tactor in an adjustment.
inline constexpr unsigned adjustment_series = 6;

struct calibration_settings {
    std::string participant = {};
    calibration_method method = calibration_method::staircase;
    std::vector<unsigned> tactors = {};     ///< tactors in the order of measurement
    std::vector<double> ceilings_dbfs = {}; ///< ceiling of each tactor in `tactors`
    staircase_options staircase = {};       ///< ceiling_dbfs is not used
    std::size_t trials = 30;                ///< greatest number of trials for a tactor (quest)
    std::optional<double> stop_sd_db = {};  ///< posterior sd below which a tactor ends early (quest)
    double carrier_hz = 250.0;
    double interval_s = 0.5;
    bool feedback = true;
    std::string masker = {};     ///< description of the masking noise; empty without noise
    std::string masker_pcm = {}; ///< device that plays the masking noise
    unsigned practice = 0;       ///< number of practice trials: on the first tactor, at the start level
    std::uint32_t seed = 0;
    std::string simulate = {}; ///< text that describes the simulated observer; empty for a person
    std::string date = {};     ///< UTC day on which the session began
    std::string array = {};    ///< SHA-256 of the array file to be written, without the thresholds

    /// Returns the start level. The ceiling of a tactor may lower it.
    double start_dbfs() const noexcept { return staircase.start_dbfs; }
};

/// Returns "1up3down" or "1up2down".
std::string rule_name(const calibration_settings& s);

struct calibration_trial {
    std::size_t number = 0; ///< number of the trial in the session, from 1
    unsigned tactor = 0;
    double level_dbfs = 0.0;   ///< level of the stimulus, or start level of an adjustment
    double ceiling_dbfs = 0.0; ///< highest level of this tactor
    unsigned interval = 0;     ///< interval with the stimulus, 1 or 2; 0 in an adjustment
    bool practice = false;
    std::size_t place = 0;     ///< number of the tactor in the session, from 1
    std::size_t on_tactor = 0; ///< number among the trials or series of this tactor, from 1
};

/// An answer: `interval` for a trial of a staircase or of QUEST+, `set_dbfs` for an adjustment.
struct calibration_answer {
    unsigned interval = 0;
    std::optional<double> set_dbfs = {}; ///< missing if no level was felt
    std::optional<double> response_time_s = {};
    std::optional<std::uint64_t> onset_frame = {}; ///< frame of the stream at which the trial begins
};

/// A line of the log.
struct calibration_record {
    calibration_trial trial = {}; ///< in an adjustment, with the level that was set
    std::string response = {};    ///< "1" or "2"; in an adjustment, "set" or "none"
    std::optional<bool> correct = {};
    bool reversal = false;
    std::optional<double> response_time_s = {};
    std::optional<std::uint64_t> onset_frame = {};
};

struct tactor_threshold {
    unsigned tactor = 0;
    staircase_end end = staircase_end::felt;
    std::optional<double> threshold_dbfs = {}; ///< missing if the tactor was not felt
    std::optional<double> sd_db = {};
    std::optional<double> posterior_sd_db = {}; ///< posterior sd of the threshold (quest)
    std::size_t trials = 0;
    std::vector<double> reversals_dbfs = {};
    std::optional<std::size_t> check_right = {};       ///< right answers in ten trials 6 dB above threshold
    std::optional<std::size_t> check_below_right = {}; ///< right answers in ten trials 6 dB below threshold
    std::size_t staircases = 1;
};

class calibration {
public:
    explicit calibration(calibration_settings s);

    bool done() const noexcept { return place_ == settings_.tactors.size(); }
    /// Returns the next trial. \pre !done()
    const calibration_trial& next() const noexcept { return trial_; }
    /// Takes the answer to next(). Returns the line for the log.
    calibration_record answer(const calibration_answer& a);
    /// Thresholds of the tactors that were measured so far.
    const std::vector<tactor_threshold>& thresholds() const noexcept { return thresholds_; }
    const calibration_settings& settings() const noexcept { return settings_; }

private:
    void begin_tactor();
    void make_trial();
    quest make_quest() const;
    void take_interval_answer(const calibration_answer& a, calibration_record& r);
    void take_quest_answer(bool right);
    void take_series_answer(const calibration_answer& a, calibration_record& r);
    void finish_tactor(tactor_threshold t);

    calibration_settings settings_;
    std::size_t place_ = 0; ///< index into settings_.tactors
    std::size_t given_ = 0; ///< number of all answered trials
    unsigned practised_ = 0;
    random_numbers intervals_;
    staircase stairs_;
    std::optional<quest> quest_ = {};
    std::size_t answered_ = 0; ///< answered trials or series of this tactor
    std::size_t wrong_ = 0;    ///< wrong answers for this tactor (quest)
    std::vector<double> series_dbfs_ = {};
    calibration_trial trial_ = {};
    std::vector<tactor_threshold> thresholds_ = {};
};

struct observer_settings {
    std::vector<double> thresholds_dbfs = {}; ///< one threshold for all tactors, or one for each
    double spread_db = 2.0;                   ///< sd of the psychometric function; 0 for a step
    double lapse = 0.0;                       ///< lapse rate, 0 to 0.5
    std::optional<std::uint64_t> seed = {};   ///< seed; if missing, the session's seed
};

/// Reads a text such as "seed=1,threshold=-45,spread=2,lapse=0.02". A list of thresholds, as in
/// threshold=-45,-50, must have one for each of the `measured` tactors, or one for each of the array's `all`
/// tactors. \throws error (bad_input) with the name --simulate.
observer_settings parse_observer(std::string_view text, const std::vector<unsigned>& measured,
                                 std::size_t all);

/// Returns the chance of a right answer: 0.5 + (0.5 - lapse) Phi((level - threshold) / spread).
double right_answer_chance(const observer_settings& o, double threshold_dbfs, double level_dbfs);

/// Simulated observer that answers trials in order. To resume a session, it must answer all earlier trials
/// again.
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

/// Returns a text such as "9 tactors, about 480 trials: some 30 minutes" for the rest of a calibration.
/// Counts the trials that a simulated observer needs, and adds time for the answers of a person.
std::string time_text(const calibration& c);

} // namespace tactor::study
