// SPDX-License-Identifier: MIT
/// \file
/// The phantom rules once more, written as they are read: every pair and every triple of a face.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <tactor/phantom.hpp>

namespace tactor::test {

inline double cross(point a, point b, point c)
{
    return (b.x_mm - a.x_mm) * (c.y_mm - a.y_mm) - (b.y_mm - a.y_mm) * (c.x_mm - a.x_mm);
}

inline double off_segment(point a, point b, point p)
{
    const double length = distance_mm(a, b);
    const double along =
        ((p.x_mm - a.x_mm) * (b.x_mm - a.x_mm) + (p.y_mm - a.y_mm) * (b.y_mm - a.y_mm)) / (length * length);
    const double u = std::clamp(along, 0.0, 1.0);
    return distance_mm(p, {a.x_mm + u * (b.x_mm - a.x_mm), a.y_mm + u * (b.y_mm - a.y_mm)});
}

inline bool in_triangle(point a, point b, point c, point p)
{
    const double u = cross(a, b, p);
    const double v = cross(b, c, p);
    const double w = cross(c, a, p);
    return (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0) ||
           std::min({off_segment(a, b, p), off_segment(b, c, p), off_segment(c, a, p)}) <= same_place_mm;
}

inline bool in_face(const layout& l, const std::vector<unsigned>& f, point p)
{
    for (std::size_t i = 2; i < f.size(); ++i)
        if (in_triangle(l.places()[f[0]], l.places()[f[i - 1]], l.places()[f[i]], p))
            return true;
    return false;
}

/// Returns the tactors that play at p, ascending. For arrays whose indices follow their ranks.
inline std::vector<unsigned> expected_tactors(const layout& l, point p)
{
    const std::vector<point>& t = l.places();
    for (unsigned i = 0; i < t.size(); ++i)
        if (distance_mm(t[i], p) <= same_place_mm)
            return {i};
    std::vector<std::vector<unsigned>> faces;
    for (const auto& f : l.faces())
        if (in_face(l, f, p))
            faces.push_back(f);

    std::optional<std::vector<unsigned>> best;
    double shortest = HUGE_VAL;
    for (auto f : faces) {
        std::sort(f.begin(), f.end());
        for (std::size_t i = 0; i < f.size(); ++i)
            for (std::size_t j = i + 1; j < f.size(); ++j) {
                const double length = distance_mm(t[f[i]], t[f[j]]);
                if (off_segment(t[f[i]], t[f[j]], p) > same_place_mm || length > shortest + same_place_mm)
                    continue;
                const std::vector<unsigned> ends{f[i], f[j]};
                if (!best || length < shortest - same_place_mm || ends < *best)
                    best = ends;
                shortest = std::min(shortest, length);
            }
    }
    if (best)
        return *best;

    for (auto f : faces) {
        std::sort(f.begin(), f.end());
        std::stable_sort(f.begin(), f.end(), [&](unsigned a, unsigned b) {
            return distance_mm(t[a], p) < distance_mm(t[b], p) - same_place_mm;
        });
        for (std::size_t i = 0; i < f.size(); ++i)
            for (std::size_t j = i + 1; j < f.size(); ++j)
                for (std::size_t k = j + 1; k < f.size(); ++k)
                    if (in_triangle(t[f[i]], t[f[j]], t[f[k]], p)) {
                        std::vector<unsigned> three{f[i], f[j], f[k]};
                        std::sort(three.begin(), three.end());
                        return three;
                    }
    }
    return {};
}

} // namespace tactor::test
