// SPDX-License-Identifier: MIT
#include "plan/missed_places.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "core/words.hpp"
#include "plan/faces/plane.hpp"
#include "plan/rounded.hpp"

namespace tactor::detail {
namespace {

constexpr std::uint64_t most_samples = 4000;

bool in_one_line(point a, point b, point c)
{
    const double longest = std::max({length_mm(a, b), length_mm(b, c), length_mm(c, a)});
    return std::abs(turn(a, b, c)) <= same_place_mm * longest;
}

// Its edge included, which rounding may make either side.
bool holds(point a, point b, point c, point p)
{
    if (turn(a, b, c) < 0.0)
        std::swap(b, c);
    return triangle_distance_mm(a, b, c, p) <= 2.0 * same_place_mm;
}

} // namespace

void missed_places::add(const layout& l, const burst& b)
{
    ++all_;
    if (b.drives.size() != 3)
        return;
    const auto at = [&](std::size_t i) { return l.places()[b.drives[i].tactor]; };
    const bool line = in_one_line(at(0), at(1), at(2));
    if (!line && holds(at(0), at(1), at(2), b.position))
        return;
    if (missed_ == 0)
        first_ = b.position;
    ++missed_;
    in_line_ += line ? 1 : 0;
}

void missed_places::add(const layout& l, const curve& c)
{
    const std::uint64_t step = 1 + c.size() / most_samples;
    burst b;
    for (std::uint64_t k = 0; k < c.size(); k += step) {
        c.sample(k, b);
        add(l, b);
    }
}

std::string missed_places::warning(std::string_view what) const
{
    if (missed_ == 0)
        return {};
    const std::string line =
        in_line_ == 0 ? "" : fmt::format("; for {} of them the three are in one line", in_line_);
    return fmt::format("{} of {} {} outside the triangle of the three closest tactors, first at {}{}: felt "
                       "elsewhere (faces = delaunay)",
                       missed_, counted(all_, what), missed_ == 1 ? "lies" : "lie", place(first_), line);
}

void warn_of_faces(const layout& l, const plan_options& o, missed_places& missed, plan& p)
{
    if (p.faces == faces_kind::nearest && p.curve)
        missed.add(l, *p.curve);
    if (std::string text = missed.warning(p.curve ? "sample" : "burst"); !text.empty())
        p.warnings.push_back(std::move(text));
    if (o.faces != p.faces)
        p.warnings.push_back(fmt::format(
            "faces = {} is not used: tactile-brush plays on the lines of the grid", to_string(o.faces)));
}

} // namespace tactor::detail
