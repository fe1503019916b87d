// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <exception>
#include <string_view>

#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/words.hpp>

#include "synth/score/expander.hpp"
#include "synth/score/frames.hpp"

namespace tactor::synth {

namespace {

/// Empty where all can be played.
std::string unplayable(const burst& b, std::size_t tactors)
{
    for (const drive& d : b.drives) {
        if (d.tactor >= tactors || !std::isfinite(d.amplitude)) {
            return fmt::format("tactor {} at amplitude {} cannot be rendered", d.tactor, d.amplitude);
        }
    }
    return {};
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
    if (!why.empty()) {
        throw error(error_kind::bad_input, "stroke at " + seconds_text(t_s), why);
    }
}

void control_points::reserve(std::size_t tactors)
{
    before.reserve(tactors);
    changes.reserve(tactors);
    now.drives.reserve(tactors);
}

std::uint64_t control_frame(std::uint64_t k, unsigned rate, std::uint64_t length) noexcept
{
    return std::min(length, frame_at(static_cast<double>(k) * continuous_step_s, rate));
}

bool checked_sample(const plan& p, std::uint64_t k, std::size_t tactors, burst& out,
                    std::string& failure) noexcept
{
    const double t = p.curve->time_s(k);
    try {
        p.curve->sample(k, out);
        const std::string why = unplayable(out, tactors);
        if (!why.empty()) {
            tell(failure, t, why);
            return false;
        }
    } catch (const std::exception& e) {
        tell(failure, t, e.what());
        return false;
    } catch (...) {
        tell(failure, t, "an exception that is no std::exception");
        return false;
    }
    return true;
}

/// Moves on to the next two control points; tactors that are in one of them only come from or go to 0.
bool expander::next_points() noexcept
{
    position_ = step_end_;
    if (position_ >= item_->end()) {
        return false;
    }
    while (step_end_ == position_) {
        step_end_ = item_->start + control_frame(++step_, score_->rate, item_->length);
    }
    control_points& c = *points_;
    std::swap(c.before, c.now.drives);
    if (!checked_sample(score_->plans[item_->plan].schedule, step_, score_->tactors.size(), c.now,
                        c.failure)) {
        failed_ = true;
        return false;
    }
    c.changes.clear();
    next_ = 0;
    auto a = c.before.cbegin();
    auto b = c.now.drives.cbegin();
    while (a != c.before.cend() || b != c.now.drives.cend()) {
        if (b == c.now.drives.cend() || (a != c.before.cend() && a->tactor < b->tactor)) {
            c.changes.push_back({a->tactor, a->amplitude, 0.0});
            ++a;
        } else if (a == c.before.cend() || b->tactor < a->tactor) {
            c.changes.push_back({b->tactor, 0.0, b->amplitude});
            ++b;
        } else {
            c.changes.push_back({a->tactor, a->amplitude, b->amplitude});
            ++a;
            ++b;
        }
    }
    return true;
}

} // namespace tactor::synth
