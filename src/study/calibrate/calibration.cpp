// SPDX-License-Identifier: MIT
#include "study/calibrate/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/words.hpp"
#include "study/experiment/observer_text.hpp"
#include "study/statistics/tests.hpp"

namespace tactor::study {
namespace {

constexpr std::size_t tries = 10;        // trials at the ceiling or the floor that can end a measurement
constexpr std::size_t enough = 8;        // if this many of ten answers are right, the level is felt
constexpr std::size_t counted_after = 8; // reversals to average if there were more than requested
constexpr std::size_t most_staircases = 2;
constexpr double check_db = 6.0; // distance of check trials from the threshold
constexpr double halves_may_differ_db = 2.0;

constexpr double series_from_db = 15.0;

constexpr double guess_chance = 0.5; // one of two intervals

// Range of QUEST+ below and above the ceiling, in steps of 1 dB. A threshold above the ceiling means "not
// felt".
constexpr int levels_db = 80;
constexpr int above_ceiling_db = 10;
// If a tactor has this many right answers and no wrong answer, something other than the skin felt the
// stimuli.
constexpr std::size_t too_many_right = 20;
// Prior of QUEST+: the first tactor's threshold is expected below the start level, the threshold of each
// later tactor at the mean of the thresholds that were measured so far.
constexpr double below_start_db = 20.0;
constexpr double first_sd_db = 20.0;
constexpr double other_sd_db = 10.0;

double to_hundredths(double db)
{
    return std::round(db * 100.0) / 100.0;
}

random_numbers make_random_numbers(const calibration_settings& s, const std::string& part)
{
    return random_numbers(fmt::format("{}/calibrate/{}/{}", s.seed, s.participant, part));
}

// Reduces a list with one threshold for each tactor of the array to the measured tactors. Throws error
// (bad_input) if the number of thresholds does not fit.
void keep_measured_thresholds(observer_settings& o, const std::vector<unsigned>& measured, std::size_t all)
{
    const std::size_t n = o.thresholds_dbfs.size();
    if (n == 1 || n == measured.size())
        return;
    if (n != all)
        throw error(
            error_kind::bad_input, "--simulate",
            fmt::format("there are {} for {}", counted(n, "threshold"), counted(measured.size(), "tactor")),
            "give one for all, or one for each");
    std::vector<double> own;
    for (const unsigned t : measured)
        own.push_back(o.thresholds_dbfs[t]);
    o.thresholds_dbfs = std::move(own);
}

constexpr double usual_answer_s = 1.5; // time from the last interval to the answer
constexpr double before_s = 0.5;
constexpr double series_s = 20.0; // duration of an adjustment

} // namespace

reversal_mean average_reversals(std::span<const double> reversals_dbfs, std::size_t counted)
{
    const std::span<const double> v = reversals_dbfs.last(counted);
    reversal_mean m{mean(v)};
    m.sd_db = deviation(v, m.mean_dbfs);
    m.halves_db = std::abs(mean(v.first(v.size() / 2)) - mean(v.last(v.size() / 2)));
    return m;
}

staircase::staircase(staircase_options o) : o_(std::move(o)), level_(o_.start_dbfs), run_{.rule = make_rule()}
{
}

// Makes the rule of a staircase. Until the first reversal, one right answer lowers the level: with three, the
// descent would be so long that a lapse is likely, and a lapse would end the large steps too early.
up_down_rule staircase::make_rule() const
{
    return up_down_rule({.in_row = o_.right_for_down, .sizes = o_.steps_db.size(), .fast_to_reversal = true});
}

bool staircase::answer(bool right)
{
    ++trials_;
    if (run_.threshold) {
        check(right);
        return false;
    }
    record_ceiling_answer(right);
    record_floor_answer(right);
    const bool turned = step(right);
    if (!end_ && run_.reversals.size() >= o_.reversals)
        settle();
    return turned;
}

// Takes an answer; returns true if the direction turned, even if the ceiling blocks the step.
bool staircase::step(bool right)
{
    const auto step = run_.rule.answer(right);
    if (!step)
        return false;
    if (step->turned)
        run_.reversals.push_back(level_);
    const double by = o_.steps_db[step->size];
    move_to_level(step->up ? level_ + by : level_ - by);
    return step->turned;
}

void staircase::move_to_level(double level_dbfs)
{
    const double rounded = std::round(level_dbfs * 1e6) / 1e6; // steps of 0.1 dB add up to 0.3, not 0.30...04
    level_ = std::clamp(rounded, floor_dbfs, o_.ceiling_dbfs);
}

void staircase::record_ceiling_answer(bool right)
{
    if (level_ < o_.ceiling_dbfs)
        return;
    std::vector<bool>& all = run_.at_ceiling;
    all.push_back(right);
    if (all.size() >= tries &&
        std::count(all.end() - tries, all.end(), true) < static_cast<std::ptrdiff_t>(enough))
        end_ = staircase_end::not_felt;
}

void staircase::record_floor_answer(bool right)
{
    run_.right_at_floor = right && level_ <= floor_dbfs ? run_.right_at_floor + 1 : 0;
    if (run_.right_at_floor == tries)
        end_ = staircase_end::below_range;
}

void staircase::settle()
{
    const std::vector<double>& all = run_.reversals;
    const std::size_t kept = (all.size() - o_.discard) / 2 * 2;
    const std::size_t counted = all.size() == o_.reversals ? kept : std::min(kept, counted_after);
    // Continues by two reversals at a time, so that their number stays even or odd like the requested number.
    if ((all.size() - o_.reversals) % 2 != 0)
        return;
    const reversal_mean m = average_reversals(all, counted);
    if (m.halves_db > halves_may_differ_db && all.size() + 2 <= most_reversals)
        return;
    run_.threshold = m;
    move_to_level(m.mean_dbfs + check_db);
}

// Takes the answer to a check trial. Below the threshold, half of all guesses are right. A participant who is
// right more often feels the level: a lapse must have kept the staircase too high. Then a second staircase
// begins.
void staircase::check(bool right)
{
    const bool above = run_.above.given < check_count;
    check_trials& trials = above ? run_.above : run_.below;
    trials.right += right ? 1 : 0;
    if (++trials.given < check_count)
        return;
    if (above && trials.right >= enough) {
        move_to_level(run_.threshold->mean_dbfs - check_db);
    } else if (above) {
        end_ = staircase_end::not_felt;
    } else if (trials.right < too_many_below || staircases_ == most_staircases) {
        end_ = staircase_end::felt;
    } else {
        run_ = {.rule = make_rule()};
        ++staircases_;
    }
}

std::string rule_name(const calibration_settings& s)
{
    return fmt::format("1up{}down", s.staircase.right_for_down);
}

calibration::calibration(calibration_settings s)
    : settings_(std::move(s)),
      intervals_(make_random_numbers(settings_, "practice")),
      stairs_(settings_.staircase)
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
    intervals_ = make_random_numbers(settings_, fmt::format("{}", settings_.tactors[place_]));
    staircase_options o = settings_.staircase;
    o.ceiling_dbfs = settings_.ceilings_dbfs[place_];
    o.start_dbfs = std::min(o.start_dbfs, o.ceiling_dbfs);
    stairs_ = staircase(std::move(o));
    if (settings_.method == calibration_method::quest)
        quest_ = make_quest();
    answered_ = 0;
    wrong_ = 0;
    series_dbfs_.clear();
}

quest calibration::make_quest() const
{
    std::vector<double> measured;
    for (const tactor_threshold& t : thresholds_)
        if (t.threshold_dbfs)
            measured.push_back(*t.threshold_dbfs);
    const double expected = measured.empty() ? settings_.start_dbfs() - below_start_db : mean(measured);
    const double sd = measured.empty() ? first_sd_db : other_sd_db;
    quest_grid g{.slopes = {1.0, 1.6, 2.5, 4.0, 6.0}, .lapses = {0.0, 0.02, 0.04}};
    for (int i = -levels_db; i <= above_ceiling_db; ++i) {
        const double level = settings_.ceilings_dbfs[place_] + i;
        if (i <= 0)
            g.stimuli.push_back(level);
        g.thresholds.push_back(level);
        g.weights.push_back(std::exp(-0.5 * std::pow((level - expected) / sd, 2.0)));
    }
    return {g, [](double level, const psychometric& p) { return normal_chance(level, p, guess_chance); }};
}

void calibration::make_trial()
{
    trial_ = {};
    trial_.number = given_ + 1;
    trial_.tactor = settings_.tactors[place_];
    trial_.ceiling_dbfs = settings_.ceilings_dbfs[place_];
    trial_.place = place_ + 1;
    trial_.on_tactor = answered_ + 1;
    if (!asks(settings_.method)) {
        const double last = series_dbfs_.empty() ? settings_.start_dbfs() : series_dbfs_.back();
        const double by = series_dbfs_.size() % 2 == 0 ? series_from_db : -series_from_db;
        trial_.level_dbfs = std::clamp(last + by, floor_dbfs, trial_.ceiling_dbfs);
        return;
    }
    trial_.practice = practised_ < settings_.practice;
    trial_.level_dbfs = trial_.practice ? std::min(settings_.start_dbfs(), trial_.ceiling_dbfs)
                        : quest_        ? quest_->stimulus()
                                        : stairs_.level_dbfs();
    trial_.interval = 1 + intervals_.below(2);
}

calibration_record calibration::answer(const calibration_answer& a)
{
    calibration_record r{.trial = trial_, .response_time_s = a.response_time_s, .onset_frame = a.onset_frame};
    ++given_;
    if (asks(settings_.method))
        take_interval_answer(a, r);
    else
        take_series_answer(a, r);
    if (!done())
        make_trial();
    return r;
}

void calibration::take_interval_answer(const calibration_answer& a, calibration_record& r)
{
    const bool right = a.interval == trial_.interval;
    r.response = fmt::format("{}", a.interval);
    r.correct = right;
    if (trial_.practice) {
        if (++practised_ == settings_.practice)
            begin_tactor();
        return;
    }
    ++answered_;
    if (quest_)
        return take_quest_answer(right);
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

void calibration::take_quest_answer(bool right)
{
    quest_->answer(right);
    wrong_ += right ? 0 : 1;
    const double sd_db = quest_->threshold_sd();
    if (answered_ < settings_.trials && !(sd_db < settings_.stop_sd_db.value_or(0.0)))
        return;
    const double threshold_dbfs = to_hundredths(quest_->estimate().threshold);
    tactor_threshold t{.tactor = trial_.tactor, .trials = answered_};
    if (threshold_dbfs > trial_.ceiling_dbfs)
        t.end = staircase_end::not_felt;
    else if (threshold_dbfs < trial_.ceiling_dbfs - levels_db + 1.0 ||
             (wrong_ == 0 && answered_ >= too_many_right))
        t.end = staircase_end::below_range;
    else {
        t.threshold_dbfs = threshold_dbfs;
        t.posterior_sd_db = to_hundredths(sd_db);
    }
    finish_tactor(std::move(t));
}

void calibration::take_series_answer(const calibration_answer& a, calibration_record& r)
{
    r.response = a.set_dbfs ? "set" : "none";
    if (a.set_dbfs) {
        r.trial.level_dbfs = *a.set_dbfs;
        series_dbfs_.push_back(*a.set_dbfs);
        answered_ = series_dbfs_.size();
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

observer_settings parse_observer(std::string_view text, const std::vector<unsigned>& measured,
                                 std::size_t all)
{
    observer_settings o;
    const observer_key keys[] = {
        {"seed", 0.0, 0x1p53, [&](double v) { o.seed = static_cast<std::uint64_t>(v); }, true},
        {"threshold", -200.0, 1000.0, [&](double v) { o.thresholds_dbfs.push_back(v); }, false, true},
        {"spread", 0.0, 100.0, [&](double v) { o.spread_db = v; }},
        {"lapse", 0.0, 0.5, [&](double v) { o.lapse = v; }}};
    constexpr const char* example = "seed=1,threshold=-45,spread=2,lapse=0.02";
    read_observer(text, keys, example);
    if (o.thresholds_dbfs.empty())
        throw error(error_kind::bad_input, "--simulate", "threshold is missing",
                    fmt::format("give a value such as {}", example));
    keep_measured_thresholds(o, measured, all);
    return o;
}

double right_answer_chance(const observer_settings& o, double threshold_dbfs, double level_dbfs)
{
    if (o.spread_db == 0.0) // a step
        return level_dbfs < threshold_dbfs ? guess_chance : 1.0 - o.lapse;
    return normal_chance(level_dbfs, {threshold_dbfs, o.spread_db, o.lapse}, guess_chance);
}

observer::observer(observer_settings o, const calibration_settings& s)
    : o_(std::move(o)),
      tactors_(s.tactors),
      r_(fmt::format("{}/calibrate/{}/observer", o_.seed.value_or(s.seed), s.participant))
{
}

double observer::find_threshold(unsigned tactor) const
{
    if (o_.thresholds_dbfs.size() == 1)
        return o_.thresholds_dbfs.front();
    const auto at = std::find(tactors_.begin(), tactors_.end(), tactor) - tactors_.begin();
    return o_.thresholds_dbfs[static_cast<std::size_t>(at)];
}

calibration_answer observer::answer(const calibration_trial& t)
{
    if (t.interval == 0)
        return adjust(t);
    const bool right = r_.unit() < right_answer_chance(o_, find_threshold(t.tactor), t.level_dbfs);
    return {.interval = right ? t.interval : 3 - t.interval};
}

// Draws a threshold for this series, and moves the level towards it: first by steps of 2 dB, then of 0.5 dB.
calibration_answer observer::adjust(const calibration_trial& t)
{
    const double aim = find_threshold(t.tactor) + o_.spread_db * r_.normal();
    if (aim > t.ceiling_dbfs)
        return {};
    double level = t.level_dbfs;
    for (const double by : {2.0, 0.5})
        while (std::abs(level - aim) > by / 2.0) {
            const double to = std::clamp(level < aim ? level + by : level - by, floor_dbfs, t.ceiling_dbfs);
            if (to == level || std::abs(to - aim) >= std::abs(level - aim))
                break;
            level = to;
        }
    return {.set_dbfs = level};
}

std::string time_text(const calibration& c)
{
    const calibration_settings& s = c.settings();
    calibration rest = c;
    observer typical({.thresholds_dbfs = {-45.0}}, s);
    const double trial_s = before_s + 2.0 * s.interval_s + interval_gap_s + usual_answer_s;
    double seconds = 0.0;
    std::size_t trials = 0;
    std::set<unsigned> tactors;
    for (; !rest.done(); ++trials) {
        const calibration_trial t = rest.next();
        tactors.insert(t.tactor);
        seconds += t.interval != 0 ? trial_s : series_s;
        static_cast<void>(rest.answer(typical.answer(t)));
    }
    const auto minutes = static_cast<std::uint64_t>(std::max(1.0, std::round(seconds / 60.0)));
    return fmt::format("{}, about {}: some {}", counted(tactors.size(), "tactor"), counted(trials, "trial"),
                       counted(minutes, "minute"));
}

} // namespace tactor::study
