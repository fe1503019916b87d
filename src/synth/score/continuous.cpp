// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <exception>
#include <span>
#include <string_view>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/words.hpp"
#include "synth/score/expander.hpp"
#include "synth/score/frames.hpp"

namespace tactor::synth {

namespace {

/// What a plan may give more than it promised: the last digits.
constexpr double rounding = 1.0 + 1e-9;

/// Empty where all can be played.
std::string unplayable(const burst& b, std::size_t tactors)
{
    for (std::size_t i = 0; i < b.drives.size(); ++i) {
        const drive& d = b.drives[i];
        if (d.tactor >= tactors || !std::isfinite(d.amplitude))
            return fmt::format("tactor {} at amplitude {} cannot be rendered", d.tactor, d.amplitude);
        if (i > 0 && b.drives[i - 1].tactor >= d.tactor)
            return fmt::format("tactor {} after tactor {}", d.tactor, b.drives[i - 1].tactor);
    }
    return {};
}

/// Empty where no tactor gets more than was promised when its level was held against its limit.
std::string above(const burst& b, std::span<const double> promised)
{
    for (const drive& d : b.drives) {
        if (std::abs(d.amplitude) > promised[d.tactor] * rounding) {
            return fmt::format("tactor {} at amplitude {:.6g}, above the {:.6g} that it was planned with",
                               d.tactor, d.amplitude, promised[d.tactor]);
        }
    }
    return {};
}

/// Whether there is nothing to say of it.
bool is_good(const burst& b, std::span<const double> promised) noexcept
{
    std::size_t first_free = 0;
    for (const drive& d : b.drives) {
        if (d.tactor < first_free || d.tactor >= promised.size() ||
            !(std::abs(d.amplitude) <= promised[d.tactor] * rounding))
            return false;
        first_free = std::size_t{d.tactor} + 1;
    }
    return true;
}

/// Called where nothing may be thrown, not even for want of memory for the reason.
void tell(std::string& failure, double t_s, std::string_view why) noexcept
{
    try {
        failure = fmt::format("the plan failed at {} of the stroke: {}", seconds_text(t_s), why);
    } catch (...) {
        failure = "no memory";
    }
}

} // namespace

void check_drives(const burst& b, double t_s, std::size_t tactors)
{
    const std::string why = unplayable(b, tactors);
    if (!why.empty())
        throw error(error_kind::bad_input, "stroke at " + seconds_text(t_s), why);
}

void control_points::reserve(std::size_t tactors)
{
    rows.reserve(tactors);
    now.drives.reserve(tactors);
}

void control_points::add(std::size_t i) noexcept
{
    auto r = rows.begin();
    for (const drive& d : now.drives) {
        while (r != rows.end() && r->tactor < d.tactor)
            ++r;
        if (r == rows.end() || r->tactor != d.tactor) {
            if (d.amplitude == 0.0)
                continue;
            r = rows.insert(r, {d.tactor, {}});
        }
        r->amplitude[i] = d.amplitude;
        ++r;
    }
}

std::uint64_t control_frame(std::uint64_t k, unsigned rate, std::uint64_t length) noexcept
{
    return std::min(length, frame_at(static_cast<double>(k) * continuous_step_s, rate));
}

bool checked_sample(const plan& p, std::uint64_t k, std::span<const double> promised,
                    detail::same_tactors& seen, burst& out, std::string& failure) noexcept
{
    const double t = p.curve->time_s(k);
    try {
        curve_access::of(*p.curve).sample(k, seen, out);
        if (is_good(out, promised))
            return true;
        const std::string why = unplayable(out, promised.size());
        tell(failure, t, why.empty() ? above(out, promised) : why);
        return false;
    } catch (const std::exception& e) {
        tell(failure, t, e.what());
        return false;
    } catch (...) {
        tell(failure, t, "an exception that is no std::exception");
        return false;
    }
}

/// Moves on to the next control points. False at the end, and where the plan failed.
bool expander::next_points() noexcept
{
    position_ = step_end_;
    next_ = 0;
    control_points& c = *points_;
    c.rows.clear();
    failed_ = failing_;
    if (failed_ || position_ >= item_->end())
        return false;
    c.frame[0] = 0;
    c.add(0);
    c.count = 1;
    while (!failing_ && c.count < points_per_line && step_end_ < item_->end()) {
        const std::uint64_t before = step_end_;
        while (step_end_ == before)
            step_end_ = item_->start + control_frame(++step_, score_->rate, item_->length);
        failing_ = !checked_sample(score_->plans[item_->plan].plan, step_, score_->promised[item_->plan],
                                   c.seen, c.now, c.failure);
        if (failing_) {
            step_end_ = before;
        } else {
            c.frame[c.count] = static_cast<std::uint16_t>(step_end_ - position_);
            c.add(c.count++);
        }
    }
    if (c.count == 1)
        c.rows.clear(); // nothing lies between one point and none
    return true;
}

} // namespace tactor::synth
