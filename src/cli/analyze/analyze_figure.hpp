// SPDX-License-Identifier: MIT
/// \file
/// The picture of `tactor analyze`, from values.
#pragma once

#include <array>
#include <utility>

#include "cli/settings.hpp"
#include "plot/figure.hpp"
#include "study/results/result.hpp"

namespace tactor::cli {

/// The error bars of a figure.
enum class error_bars { se, within, ci };

/// Names in --bars and words in the figure's note, in the order of error_bars.
inline constexpr std::array<std::pair<const char*, const char*>, 3> all_error_bars{
    {{"se", "standard errors"},
     {"within", "95 % intervals within participants (Cousineau-Morey)"},
     {"ci", "95 % intervals of the means"}}};

/// Draws a panel for each run. The panel shows means with error bars and each participant by motion, as the
/// paper's figures 8 and 9 do, or d'. Runs that measure have psychometric functions or estimates: one for
/// each condition, and their means. Runs that identify have their answers. Comparisons between methods,
/// sessions and groups have the figure by level.
plot::canvas draw_analysis(const study::analysis& a, const picture_options& o, error_bars kind);

} // namespace tactor::cli
