// SPDX-License-Identifier: MIT
#include "percept/percept_sounding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/words.hpp"
#include "plan/rounded.hpp"

namespace tactor::detail {
namespace {

constexpr double never_s = std::numeric_limits<double>::infinity();

double burst_end_s(const burst& b)
{
    return b.onset_s + b.duration_s;
}

} // namespace

sounding::sounding(const array& a, const plan& p, double end_s, std::vector<double> gains)
    : tactors_(a),
      plan_(p),
      end_s_(end_s),
      gains_(std::move(gains)),
      first_end_s_(never_s),
      parts_(a.tactors.size())
{
}

void sounding::at(double t_s, percept_sample& out)
{
    if (plan_.curve) {
        plan_.curve->at(t_s, sampled_);
        add(sampled_);
        sum_up();
    } else {
        const bool begun = begin_bursts(t_s);
        const bool ended = end_bursts(t_s);
        if (begun || ended) {
            for (const std::size_t i : active_)
                add(plan_.bursts[i]);
            sum_up();
        }
    }
    out.felt = now_.felt;
    out.intensity = now_.intensity;
    out.shared = now_.shared;
}

bool sounding::begin_bursts(double t_s)
{
    const std::size_t before = next_;
    for (; next_ < plan_.bursts.size() && plan_.bursts[next_].onset_s <= t_s + same_time_s; ++next_) {
        active_.push_back(next_);
        first_end_s_ = std::min(first_end_s_, burst_end_s(plan_.bursts[next_]));
    }
    return next_ != before;
}

bool sounding::end_bursts(double t_s)
{
    if (first_end_s_ > t_s + same_time_s)
        return false;
    // The Tactile Brush's last burst ends with the movement, and the one before often later. Both still count
    // at the last sample.
    const bool begun = next_ > 0 && plan_.bursts[next_ - 1].onset_s >= t_s - same_time_s;
    const bool closing = t_s > end_s_ - same_time_s && !begun;
    const double limit_s = closing ? t_s - same_time_s : t_s + same_time_s;
    std::erase_if(active_, [&](std::size_t i) { return burst_end_s(plan_.bursts[i]) <= limit_s; });
    first_end_s_ = never_s;
    for (const std::size_t i : active_)
        first_end_s_ = std::min(first_end_s_, burst_end_s(plan_.bursts[i]));
    return true;
}

void sounding::add(const burst& b)
{
    for (const drive& d : b.drives) {
        if (d.tactor >= parts_.size())
            throw error(error_kind::bad_input, "plan", fmt::format("drives tactor {}", d.tactor),
                        fmt::format("\"{}\" has {}", tactors_.name, counted(parts_.size(), "tactor")));
        part& x = parts_[d.tactor];
        if (x.bursts == 0)
            touched_.push_back(d.tactor);
        ++x.bursts;
        x.energy += d.amplitude * d.amplitude;
        x.sum += d.amplitude;
        x.largest = std::max(x.largest, d.amplitude);
        x.intensity = std::max(x.intensity, b.intensity);
    }
}

double sounding::amplitude(const part& x) const
{
    if (x.bursts == 1 || plan_.overlap == overlap_kind::sum)
        return x.sum;
    return plan_.overlap == overlap_kind::max ? x.largest : std::min(x.intensity, std::sqrt(x.energy));
}

void sounding::sum_up()
{
    now_ = {};
    double energy = 0.0;
    point moment;
    for (const unsigned i : touched_) {
        const double a = amplitude(parts_[i]) * (gains_.empty() ? 1.0 : gains_[i]);
        energy += a * a;
        moment.x_mm += a * a * tactors_.tactors[i].position.x_mm;
        moment.y_mm += a * a * tactors_.tactors[i].position.y_mm;
        now_.shared = now_.shared || parts_[i].bursts > 1;
        parts_[i] = {};
    }
    touched_.clear();
    now_.intensity = std::sqrt(energy);
    if (energy > 0.0)
        now_.felt = point{moment.x_mm / energy, moment.y_mm / energy};
}

} // namespace tactor::detail
