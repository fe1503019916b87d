// SPDX-License-Identifier: MIT
#include "study/calibrate/staircase.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace tactor::study {
namespace {

constexpr std::size_t tries = 10; // at the ceiling, at the floor, and to check
constexpr std::size_t enough = 8;
constexpr std::size_t counted_after = 8; // reversals where there were more than asked for
constexpr double check_above_db = 6.0;
constexpr double halves_may_differ_db = 2.0;

// Steps of 0.1 dB add up to what people would write.
double whole_micro_db(double v)
{
    return std::round(v * 1e6) / 1e6;
}

double mean(std::span<const double> v)
{
    return std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
}

} // namespace

reversal_mean mean_of(std::span<const double> reversals_dbfs, std::size_t counted)
{
    const std::span<const double> v = reversals_dbfs.last(counted);
    reversal_mean m{mean(v)};
    double squares = 0.0;
    for (const double x : v)
        squares += (x - m.mean_dbfs) * (x - m.mean_dbfs);
    m.sd_db = std::sqrt(squares / static_cast<double>(v.size() - 1));
    m.halves_db = std::abs(mean(v.first(v.size() / 2)) - mean(v.last(v.size() / 2)));
    return m;
}

staircase::staircase(staircase_options o) : o_(std::move(o)), level_(o_.start_dbfs)
{
}

std::optional<std::size_t> staircase::check_right() const noexcept
{
    return checks_ == 0 ? std::nullopt : std::optional(checks_right_);
}

bool staircase::answer(bool right)
{
    ++trials_;
    if (threshold_) {
        check(right);
        return false;
    }
    note_at_ceiling(right);
    note_at_floor(right);
    const bool turned = step(right);
    if (!end_ && reversals_.size() >= o_.reversals)
        settle();
    return turned;
}

// The rule from the first trial on; its counter is zero after every step.
bool staircase::step(bool right)
{
    if (right && ++right_in_row_ < o_.right_for_down)
        return false;
    right_in_row_ = 0;
    const bool up = !right;
    const bool turned = turn(up);
    const double by = o_.steps_db[std::min(reversals_.size() / 2, o_.steps_db.size() - 1)];
    level_ = std::clamp(whole_micro_db(up ? level_ + by : level_ - by), floor_dbfs, o_.ceiling_dbfs);
    return turned;
}

// A step that the ceiling blocks has a direction all the same.
bool staircase::turn(bool up)
{
    const bool turned = up_ && *up_ != up;
    up_ = up;
    if (turned)
        reversals_.push_back(level_);
    return turned;
}

void staircase::note_at_ceiling(bool right)
{
    if (level_ < o_.ceiling_dbfs)
        return;
    at_ceiling_.push_back(right);
    if (at_ceiling_.size() >= tries &&
        std::count(at_ceiling_.end() - tries, at_ceiling_.end(), true) < static_cast<std::ptrdiff_t>(enough))
        end_ = staircase_end::not_felt;
}

void staircase::note_at_floor(bool right)
{
    right_at_floor_ = right && level_ <= floor_dbfs ? right_at_floor_ + 1 : 0;
    if (right_at_floor_ == tries)
        end_ = staircase_end::below_range;
}

void staircase::settle()
{
    const std::size_t kept = (reversals_.size() - o_.discard) / 2 * 2;
    const std::size_t counted = reversals_.size() == o_.reversals ? kept : std::min(kept, counted_after);
    // Two more at a time, so that the number asked for and this one are both even or both odd.
    if ((reversals_.size() - o_.reversals) % 2 != 0)
        return;
    const reversal_mean m = mean_of(reversals_, counted);
    if (m.halves_db > halves_may_differ_db && reversals_.size() + 2 <= most_reversals)
        return;
    threshold_ = m;
    level_ = std::clamp(whole_micro_db(m.mean_dbfs + check_above_db), floor_dbfs, o_.ceiling_dbfs);
}

void staircase::check(bool right)
{
    checks_right_ += right ? 1 : 0;
    if (++checks_ == tries)
        end_ = checks_right_ < enough ? staircase_end::not_felt : staircase_end::felt;
}

} // namespace tactor::study
