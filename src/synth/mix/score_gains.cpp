// SPDX-License-Identifier: MIT
#include "synth/mix/score_gains.hpp"

#include <algorithm>

namespace tactor::synth {
namespace {

template <class Fades, class Test>
std::int32_t first(const Fades& all, Test test) noexcept
{
    const auto i = std::find_if(all.begin(), all.end(), test);
    return i == all.end() ? fades::none : static_cast<std::int32_t>(i - all.begin());
}

} // namespace

void score_gain::apply(std::uint64_t frame, unsigned n, double* samples) const noexcept
{
    if (is_over(frame)) { // as nearly always
        for (unsigned j = 0; j < n; ++j)
            samples[j] *= to;
        return;
    }
    for (unsigned j = 0; j < n; ++j)
        samples[j] *= at(frame + j);
}

const score_gain* score_gains::find(std::uint32_t score, std::uint64_t frame) const noexcept
{
    const std::size_t i = place(score);
    return i == used_ || (gains_[i].to == 1.0 && gains_[i].is_over(frame)) ? nullptr : &gains_[i];
}

bool score_gains::set(std::uint32_t score, double to, std::uint64_t at, std::uint64_t length) noexcept
{
    const std::size_t i = place(score);
    if (i == used_) {
        if (to == 1.0)
            return true;
        if (used_ == gains_.size())
            return false;
        gains_[used_++] = {};
    }
    score_gain& g = gains_[i];
    g = {.score = score, .from = length == 0 ? to : g.at(at), .to = to, .start = at, .length = length};
    return true;
}

void score_gains::forget(std::uint32_t score) noexcept
{
    if (const std::size_t i = place(score); i != used_)
        gains_[i] = gains_[--used_];
}

void score_gains::settle() noexcept
{
    for (std::size_t i = 0; i < used_; ++i)
        gains_[i] = {.score = gains_[i].score, .from = gains_[i].to, .to = gains_[i].to};
}

std::int32_t fades::find(std::uint32_t score) const noexcept
{
    return any() ? first(fades_, [score](const fade& f) { return f.used && f.score == score; }) : none;
}

bool fades::any_ended(std::uint64_t by) const noexcept
{
    return any() && first(fades_, [by](const fade& f) { return f.used && f.end() <= by; }) != none;
}

void fades::end_all(std::uint64_t by) noexcept
{
    for (fade& f : fades_)
        if (f.used && f.end() <= by) {
            f.used = false;
            --used_;
        }
}

std::int32_t fades::begin(std::uint32_t score, std::uint64_t start, std::uint64_t length) noexcept
{
    const std::int32_t i =
        used_ == fades_.size() ? none : first(fades_, [](const fade& f) { return !f.used; });
    if (i != none) {
        fades_[static_cast<std::size_t>(i)] = {true, score, start, length};
        ++used_;
    }
    return i;
}

void fades::end(std::int32_t i) noexcept
{
    fades_[static_cast<std::size_t>(i)].used = false;
    --used_;
}

void fades::clear() noexcept
{
    fades_.fill({});
    used_ = 0;
}

} // namespace tactor::synth
