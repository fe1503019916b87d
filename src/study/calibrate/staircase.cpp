// SPDX-License-Identifier: MIT
#include "study/calibrate/staircase.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "study/statistics/tests.hpp"

namespace tactor::study {
namespace {

constexpr std::size_t tries = 10;        // at the ceiling, at the floor
constexpr std::size_t enough = 8;        // of them, and of check trials
constexpr std::size_t counted_after = 8; // reversals where there were more than asked for
constexpr std::size_t most_staircases = 2;
constexpr double check_db = 6.0; // above and below the threshold
constexpr double halves_may_differ_db = 2.0;

} // namespace

reversal_mean average_reversals(std::span<const double> reversals_dbfs, std::size_t counted)
{
    const std::span<const double> v = reversals_dbfs.last(counted);
    reversal_mean m{mean(v)};
    m.sd_db = deviation(v, m.mean_dbfs);
    m.halves_db = std::abs(mean(v.first(v.size() / 2)) - mean(v.last(v.size() / 2)));
    return m;
}

staircase::staircase(staircase_options o) : o_(std::move(o)), level_(o_.start_dbfs)
{
}

bool staircase::answer(bool right)
{
    ++trials_;
    if (run_.threshold) {
        check(right);
        return false;
    }
    note_at_ceiling(right);
    note_at_floor(right);
    const bool turned = step(right);
    if (!end_ && run_.reversals.size() >= o_.reversals)
        settle();
    return turned;
}

// Steps down at each right answer until the first reversal. Three answers a step would need so many trials
// that a lapse on the way is likely, which would end the large steps far above the threshold.
bool staircase::step(bool right)
{
    const unsigned for_down = run_.reversals.empty() ? 1 : o_.right_for_down;
    if (right && ++run_.right_in_row < for_down)
        return false;
    run_.right_in_row = 0;
    const bool up = !right;
    const bool turned = turn(up);
    const double by = o_.steps_db[std::min(run_.reversals.size() / 2, o_.steps_db.size() - 1)];
    go_to(up ? level_ + by : level_ - by);
    return turned;
}

void staircase::go_to(double level_dbfs)
{
    const double rounded = std::round(level_dbfs * 1e6) / 1e6; // steps of 0.1 dB add up to decimal numbers
    level_ = std::clamp(rounded, floor_dbfs, o_.ceiling_dbfs);
}

// A step that the ceiling blocks has a direction all the same.
bool staircase::turn(bool up)
{
    const bool turned = run_.up && *run_.up != up;
    run_.up = up;
    if (turned)
        run_.reversals.push_back(level_);
    return turned;
}

void staircase::note_at_ceiling(bool right)
{
    if (level_ < o_.ceiling_dbfs)
        return;
    std::vector<bool>& all = run_.at_ceiling;
    all.push_back(right);
    if (all.size() >= tries &&
        std::count(all.end() - tries, all.end(), true) < static_cast<std::ptrdiff_t>(enough))
        end_ = staircase_end::not_felt;
}

void staircase::note_at_floor(bool right)
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
    // Two more at a time, so that the number asked for and this one are both even or both odd.
    if ((all.size() - o_.reversals) % 2 != 0)
        return;
    const reversal_mean m = average_reversals(all, counted);
    if (m.halves_db > halves_may_differ_db && all.size() + 2 <= most_reversals)
        return;
    run_.threshold = m;
    go_to(m.mean_dbfs + check_db);
}

// Below the threshold half of all guesses are right. Somebody who is right there more often feels it: a lapse
// held the staircase above, and it runs once more.
void staircase::check(bool right)
{
    const bool above = run_.above.given < check_count;
    check_trials& trials = above ? run_.above : run_.below;
    trials.right += right ? 1 : 0;
    if (++trials.given < check_count)
        return;
    if (above && trials.right >= enough) {
        go_to(run_.threshold->mean_dbfs - check_db);
    } else if (above) {
        end_ = staircase_end::not_felt;
    } else if (trials.right < too_many_below || staircases_ == most_staircases) {
        end_ = staircase_end::felt;
    } else {
        run_ = {};
        ++staircases_;
    }
}

} // namespace tactor::study
