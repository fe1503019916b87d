// SPDX-License-Identifier: MIT
/// \file
/// Arrays of all kinds for property tests, and the phantom that is expected on them.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/phantom.hpp>

namespace tactor::test {

inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinite = std::numeric_limits<double>::infinity();

using generator = std::mt19937_64;

inline double between(generator& g, double low, double high)
{
    return std::uniform_real_distribution<double>(low, high)(g);
}

inline unsigned pick(generator& g, unsigned low, unsigned high)
{
    return std::uniform_int_distribution<unsigned>(low, high)(g);
}

inline array make_array(const std::vector<point>& places)
{
    array a{.name = "test"};
    for (const point& p : places)
        a.tactors.push_back({.position = p, .channel = static_cast<unsigned>(a.tactors.size())});
    return a;
}

inline array make_ring(unsigned n, double radius_mm, bool centre, double turn_rad = 0.0)
{
    std::vector<point> p;
    for (unsigned i = 0; i < n; ++i) {
        const double angle = turn_rad + 2.0 * std::numbers::pi * i / n;
        p.push_back({radius_mm * std::cos(angle), radius_mm * std::sin(angle)});
    }
    if (centre)
        p.push_back({0.0, 0.0});
    return make_array(p);
}

inline array staggered(unsigned rows, unsigned columns, double pitch_mm)
{
    std::vector<point> p;
    for (unsigned r = 0; r < rows; ++r)
        for (unsigned c = 0; c < columns; ++c)
            p.push_back({pitch_mm * (c + (r % 2 == 1 ? 0.5 : 0.0)), pitch_mm * r * std::sqrt(0.75)});
    return make_array(p);
}

inline array cloud(generator& g, unsigned n)
{
    std::vector<point> p;
    while (p.size() < n) {
        const point q{between(g, -50.0, 50.0), between(g, -50.0, 50.0)};
        if (std::none_of(p.begin(), p.end(), [&](point o) { return distance_mm(o, q) < 0.5; }))
            p.push_back(q);
    }
    return make_array(p);
}

inline array line(generator& g, unsigned n)
{
    const double angle = between(g, 0.0, 6.3);
    std::vector<point> p;
    double at = 0.0;
    for (unsigned i = 0; i < n; ++i) {
        p.push_back({3.0 + at * std::cos(angle), -7.0 + at * std::sin(angle)});
        at += between(g, 2.0, 30.0);
    }
    return make_array(p);
}

constexpr unsigned kinds_of_array = 9;

inline array some_array(generator& g, unsigned kind)
{
    switch (kind) {
    case 0:
        return make_grid("grid", pick(g, 2, 6), pick(g, 2, 6), 20.0, 20.0);
    case 1:
        return make_grid("grid", pick(g, 2, 6), pick(g, 2, 6), between(g, 5.0, 40.0), between(g, 5.0, 40.0));
    case 2:
        return staggered(pick(g, 2, 5), pick(g, 2, 5), between(g, 5.0, 40.0));
    case 3:
        return make_ring(pick(g, 3, 24), between(g, 10.0, 60.0), false, between(g, 0.0, 6.3));
    case 4:
        return make_ring(pick(g, 3, 24), between(g, 10.0, 60.0), true, between(g, 0.0, 6.3));
    case 5:
        return line(g, pick(g, 3, 9));
    case 6:
        return line(g, 2);
    case 7:
        return make_array({{between(g, -9.0, 9.0), between(g, -9.0, 9.0)}});
    default:
        return cloud(g, pick(g, 3, 40));
    }
}

/// Draws a point in the hull: anywhere, on a segment between tactors, or on a tactor.
inline point some_point(generator& g, const layout& l)
{
    const std::vector<point>& t = l.places();
    const auto any = [&] { return t[pick(g, 0, static_cast<unsigned>(t.size()) - 1)]; };
    const point a = any();
    const point b = any();
    const point c = any();
    const unsigned how = pick(g, 0, 9);
    if (how == 0)
        return a;
    const double u = how == 1 ? 0.5 : between(g, 0.0, 1.0);
    const double v = how <= 2 ? 0.0 : between(g, 0.0, 1.0 - u);
    return l.nearest({a.x_mm + u * (b.x_mm - a.x_mm) + v * (c.x_mm - a.x_mm),
                      a.y_mm + u * (b.y_mm - a.y_mm) + v * (c.y_mm - a.y_mm)});
}

inline double energy(const std::vector<drive>& d)
{
    double sum = 0.0;
    for (const drive& x : d)
        sum += x.amplitude * x.amplitude;
    return sum;
}

inline point energy_centroid(const layout& l, const std::vector<drive>& d)
{
    point c;
    for (const drive& x : d) {
        const double w = x.amplitude * x.amplitude / energy(d);
        c.x_mm += w * l.places()[x.tactor].x_mm;
        c.y_mm += w * l.places()[x.tactor].y_mm;
    }
    return c;
}

/// Returns the same array with its tactors in another order; second: the new place of each old one.
inline std::pair<array, std::vector<unsigned>> shuffled(generator& g, const array& a)
{
    std::vector<unsigned> old(a.tactors.size());
    for (unsigned i = 0; i < old.size(); ++i)
        old[i] = i;
    std::shuffle(old.begin(), old.end(), g);
    array b = a;
    std::vector<unsigned> now(old.size());
    for (unsigned i = 0; i < old.size(); ++i) {
        b.tactors[i] = a.tactors[old[i]];
        now[old[i]] = i;
    }
    return {b, now};
}

inline std::vector<unsigned> list_tactors(const std::vector<drive>& d)
{
    std::vector<unsigned> t;
    for (const drive& x : d)
        t.push_back(x.tactor);
    return t;
}

inline std::vector<drive> weights(const layout& l, phantom_kind k, point p, double a_v = 1.0,
                                  faces_kind faces = faces_kind::delaunay)
{
    std::vector<drive> out;
    make_phantom(k, l, faces)->weights(p, a_v, out);
    return out;
}

inline array rotated(array a, double angle)
{
    for (tactor_spec& t : a.tactors)
        t.position = {t.position.x_mm * std::cos(angle) - t.position.y_mm * std::sin(angle),
                      t.position.x_mm * std::sin(angle) + t.position.y_mm * std::cos(angle)};
    return a;
}

// The phantom rules once more, written as they are read: every pair and every triple of a face.

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
