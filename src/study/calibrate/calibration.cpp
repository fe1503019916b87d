// SPDX-License-Identifier: MIT
#include "study/calibrate/calibration.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace tactor::study {
namespace {

constexpr double series_from_db = 15.0;

random_numbers numbers_for(const calibration_settings& s, const std::string& part)
{
    return random_numbers(fmt::format("{}/calibrate/{}/{}", s.seed, s.participant, part));
}

staircase_options settle_stairs(const calibration_settings& s, std::size_t place)
{
    staircase_options o = s.staircase;
    o.ceiling_dbfs = s.ceilings_dbfs[place];
    o.start_dbfs = std::min(o.start_dbfs, o.ceiling_dbfs);
    return o;
}

} // namespace

std::string rule_name(const calibration_settings& s)
{
    return fmt::format("1up{}down", s.staircase.right_for_down);
}

calibration::calibration(calibration_settings s)
    : settings_(std::move(s)), intervals_(numbers_for(settings_, "practice")), stairs_(settings_.staircase)
{
    if (settings_.practice == 0)
        begin_tactor();
    if (!done())
        make_trial();
}

void calibration::begin_tactor()
{
    if (done())
        return;
    intervals_ = numbers_for(settings_, fmt::format("{}", settings_.tactors[place_]));
    stairs_ = staircase(settle_stairs(settings_, place_));
    series_dbfs_.clear();
}

void calibration::make_trial()
{
    trial_ = {};
    trial_.number = given_ + 1;
    trial_.tactor = settings_.tactors[place_];
    trial_.ceiling_dbfs = settings_.ceilings_dbfs[place_];
    if (settings_.method == calibration_method::adjustment) {
        const double last = series_dbfs_.empty() ? settings_.start_dbfs() : series_dbfs_.back();
        const double by = series_dbfs_.size() % 2 == 0 ? series_from_db : -series_from_db;
        trial_.level_dbfs = std::clamp(last + by, floor_dbfs, trial_.ceiling_dbfs);
        return;
    }
    trial_.practice = practised_ < settings_.practice;
    trial_.level_dbfs =
        trial_.practice ? std::min(settings_.start_dbfs(), trial_.ceiling_dbfs) : stairs_.level_dbfs();
    trial_.interval = 1 + intervals_.below(2);
}

calibration_record calibration::answer(const calibration_answer& a)
{
    calibration_record r{.trial = trial_, .response_time_s = a.response_time_s, .onset_frame = a.onset_frame};
    ++given_;
    if (settings_.method == calibration_method::adjustment)
        after_series(a, r);
    else
        after_staircase(a, r);
    if (!done())
        make_trial();
    return r;
}

void calibration::after_staircase(const calibration_answer& a, calibration_record& r)
{
    const bool right = a.interval == trial_.interval;
    r.response = fmt::format("{}", a.interval);
    r.correct = right;
    if (trial_.practice) {
        if (++practised_ == settings_.practice)
            begin_tactor();
        return;
    }
    r.reversal = stairs_.answer(right);
    const auto end = stairs_.end();
    if (!end)
        return;
    tactor_threshold t{.tactor = trial_.tactor,
                       .end = *end,
                       .trials = stairs_.trials(),
                       .reversals_dbfs = stairs_.reversals_dbfs(),
                       .check_right = stairs_.check_right(),
                       .check_below_right = stairs_.check_below_right(),
                       .staircases = stairs_.staircases()};
    if (*end == staircase_end::felt) {
        t.threshold_dbfs = stairs_.threshold()->mean_dbfs;
        t.sd_db = stairs_.threshold()->sd_db;
    }
    finish_tactor(std::move(t));
}

void calibration::after_series(const calibration_answer& a, calibration_record& r)
{
    r.response = a.set_dbfs ? "set" : "none";
    if (a.set_dbfs) {
        r.trial.level_dbfs = *a.set_dbfs;
        series_dbfs_.push_back(*a.set_dbfs);
        if (series_dbfs_.size() < adjustment_series)
            return;
    }
    tactor_threshold t{.tactor = trial_.tactor,
                       .end = a.set_dbfs ? staircase_end::felt : staircase_end::not_felt,
                       .trials = series_dbfs_.size() + (a.set_dbfs ? 0 : 1)};
    if (a.set_dbfs) {
        const reversal_mean m = average_reversals(series_dbfs_, series_dbfs_.size());
        t.threshold_dbfs = m.mean_dbfs;
        t.sd_db = m.sd_db;
    }
    finish_tactor(std::move(t));
}

void calibration::finish_tactor(tactor_threshold t)
{
    thresholds_.push_back(std::move(t));
    ++place_;
    begin_tactor();
}

} // namespace tactor::study
