// SPDX-License-Identifier: MIT
#include <array>
#include <utility>

#include "cli/analyze/analyze_output.hpp"

namespace tactor::cli {

std::string_view in_the_paper(std::string_view experiment, std::string_view run)
{
    constexpr std::array<std::pair<std::string_view, std::string_view>, 4> figures{
        {{"similarity",
          "79.2 %, t(11) = 6.84, p < 0.001; motions F(3, 33) = 11.43, p < 0.001; motion 2 differs from "
          "the others"},
         {"uniformity",
          "82.3 %, t(11) = 5.5, p < 0.001; motions F(3, 33) = 4.4, p = 0.01; motion 2 differs from 3 and 4"},
         {"similarity-rating",
          "2.65 and 3.89, t(11) = 13.23, p < 0.001; method F(1, 11) = 40.66, motion F(3, 33) = 9.1, "
          "interaction "
          "F(3, 33) = 7.87, all p < 0.001 (13.23^2 is 175.0, not 40.66, which F of two methods would be)"},
         {"uniformity-rating", "2.51 and 3.74, t(11) = 8.06, p < 0.001; method F(1, 11) = 40.04, p < 0.001, "
                               "motion F(3, 33) = 6.51, p = "
                               "0.001, interaction F(3, 33) = 3.91, p = 0.02 (8.06^2 is 65.0, not 40.04, "
                               "which F of two methods would "
                               "be)"}}};
    if (experiment == "park2016")
        for (const auto& [name, text] : figures)
            if (name == run)
                return text;
    return {};
}

} // namespace tactor::cli
