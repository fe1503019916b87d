// SPDX-License-Identifier: MIT
/// \file
/// Strokes for tests, and messages of errors.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/plan.hpp>

#include "caught.hpp"

namespace tactor::test {

inline stroke make_stroke(trajectory t)
{
    return {"", std::move(t), {}, {}};
}

inline stroke along(std::string_view svg, double duration_s = 1.0)
{
    return make_stroke(trajectory::along(path::from_svg(svg), duration_s));
}

/// Returns a line through the middle of `palm`.
inline stroke across(double duration_s)
{
    return along("M 0 20 L 40 20", duration_s);
}

inline stroke timed(std::vector<timed_point> p)
{
    return make_stroke(trajectory::timed(std::move(p)));
}

/// Returns the planner's message; empty if none.
inline std::string refusal(const array& a, const stroke& s, const plan_options& o)
{
    return caught_message([&] { return make_plan(a, s, o); });
}

/// Returns the number after `word` in a text.
inline double number_after(const std::string& text, std::string_view word)
{
    const auto at = text.find(word);
    return at == std::string::npos ? -1.0 : std::stod(text.substr(at + word.size()));
}

inline const array arm = make_grid("arm", 3, 4, 15.0, 15.0);
inline const array palm = preset_array("palm-3x3");

inline plan_options continuous()
{
    return {.algorithm = algorithm_kind::continuous};
}

inline plan_options brush()
{
    return {.algorithm = algorithm_kind::tactile_brush};
}

} // namespace tactor::test
