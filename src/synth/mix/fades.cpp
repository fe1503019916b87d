// SPDX-License-Identifier: MIT
#include "synth/mix/fades.hpp"

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
