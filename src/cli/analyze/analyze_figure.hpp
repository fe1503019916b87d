// SPDX-License-Identifier: MIT
/// \file
/// The picture of `tactor analyze`. It is made from values only.
#pragma once

#include <array>
#include <utility>

#include "cli/settings.hpp"
#include "plot/figure.hpp"
#include "study/results/result.hpp"

namespace tactor::cli {

/// Kinds of error bars in a figure.
enum class error_bars { se, within, ci };

/// For each value of error_bars, in order: its name in --bars, and the words in the figure's note.
inline constexpr std::array<std::pair<const char*, const char*>, 3> all_error_bars{
    {{"se", "standard errors"},
     {"within", "95 % intervals within participants (Cousineau-Morey)"},
     {"ci", "95 % intervals of the means"}}};

/// Draws one or more panels for each run. A bar panel shows means by motion with error bars and the values of
/// the participants, as in figures 8 and 9 of the paper, or d'. A run that measures has a panel of
/// psychometric functions or estimates for each condition, and a panel of their means. A run that identifies
/// has a matrix of answers. A comparison between methods, sessions or groups has a panel with the figure by
/// level.
plot::canvas draw_analysis(const study::analysis& a, const picture_options& o, error_bars kind);

} // namespace tactor::cli
