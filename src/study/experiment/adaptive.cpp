// SPDX-License-Identifier: MIT
#include "study/experiment/adaptive.hpp"

#include <algorithm>

#include "study/statistics/psychometric_fit.hpp"

namespace tactor::study {

void value_staircase::answer(bool positive)
{
    const bool counts = positive != mirrored_;
    in_row_ = counts ? in_row_ + 1 : 0;
    if (counts && in_row_ < needed_)
        return;
    in_row_ = 0;
    const bool up = !positive;
    reversals_ += up_ && *up_ != up ? 1 : 0;
    up_ = up;
    const std::size_t step = steps_[std::min(reversals_ / 2, steps_.size() - 1)];
    at_ = up ? std::min(at_ + step, top_) : at_ - std::min(at_, step);
}

adaptive_tracks::procedure& adaptive_tracks::find(unsigned track)
{
    if (const auto there = tracks_.find(track); there != tracks_.end())
        return there->second;
    const auto insert = [&](procedure p) -> procedure& {
        return tracks_.emplace(track, std::move(p)).first->second;
    };
    const adaptive_options& a = run_.adaptive;
    const std::vector<double>& values = run_.outline.values;
    const unsigned of_condition = (track - 1) % a.tracks;
    if (a.down > 0)
        return insert(value_staircase(a.down, of_condition % 2 == 1, a.steps, a.start[of_condition],
                                      values.size() - 1));
    const quest_grid grid{values, values, {}, a.slopes, a.lapses};
    return insert(quest(
        grid, [](double x, const psychometric& p) { return chance(x, p, two_answers(sigmoid::normal)); }));
}

std::size_t adaptive_tracks::next(unsigned track)
{
    return std::visit([](const auto& p) { return p.place(); }, find(track));
}

void adaptive_tracks::answer(unsigned track, bool positive)
{
    std::visit([positive](auto& p) { p.answer(positive); }, find(track));
}

} // namespace tactor::study
