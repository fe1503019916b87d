// SPDX-License-Identifier: MIT
#include "core/path/curve_places.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "core/access.hpp"
#include "core/path/impl.hpp"

namespace tactor::detail {
namespace {

/// Places of the nodes in a piece, by parameter: (1 - cos(k pi / 6)) / 2.
constexpr std::array<double, 7> node_at{0.0, 0.0669872981077807, 0.25, 0.5, 0.75, 0.9330127018922193, 1.0};

/// Places between the nodes, where polynomials are farthest off.
constexpr std::array<double, 4> tried_at{0.03, 0.37, 0.63, 0.97};

/// Length of a piece that counts as one place, as at a cusp.
constexpr double short_mm = 2e-10;

/// Steps on a curve from which on its polynomials pay: they cost as much as some hundred places.
constexpr double least_steps = 256.0;

/// Pieces of a curve at most, and of a path: 6 MB.
constexpr std::size_t most_pieces_of_curve = 1024;
constexpr std::size_t most_pieces = 32768;

} // namespace

point curve_places::piece::at(double s_mm) const noexcept
{
    point p = c[nodes - 1];
    for (std::size_t i = nodes - 1; i-- > 0;)
        p = c[i] + (s_mm - s[i]) * p;
    return p;
}

// Halves the curve until each piece is near enough to it.
curve_places::curve_places(const shape& c, const arc_length& measure, std::size_t most)
{
    const double near_mm = std::max(2e-10, 1e-13 * rough_length(c)); // the measure's own error is a tenth
    std::vector<std::pair<double, double>> open{{0.0, 1.0}};
    while (!open.empty() && pieces_.size() <= most) {
        const auto [from, to] = open.back();
        open.pop_back();
        const auto parameter = [from = from, to = to](double part) { return from + part * (to - from); };
        piece p;
        for (std::size_t i = 0; i < nodes; ++i) {
            p.s[i] = measure.at(c, parameter(node_at[i]));
            p.c[i] = position(c, parameter(node_at[i]));
        }
        const bool is_short = p.s.back() - p.s.front() <= short_mm;
        for (std::size_t order = 1; order < nodes; ++order)
            for (std::size_t i = nodes - 1; i >= order; --i)
                p.c[i] = is_short ? point{} : 1.0 / (p.s[i] - p.s[i - order]) * (p.c[i] - p.c[i - 1]);
        const auto is_near = [&](double part) {
            const double t = parameter(part);
            return distance_mm(p.at(measure.at(c, t)), position(c, t)) <= near_mm;
        };
        if (is_short || std::all_of(tried_at.begin(), tried_at.end(), is_near)) {
            ends_mm_.push_back(p.s.back());
            pieces_.push_back(p);
        } else {
            open.emplace_back(parameter(0.5), to);
            open.emplace_back(from, parameter(0.5));
        }
    }
}

point curve_places::at(double s_mm) const noexcept
{
    const auto end = std::lower_bound(ends_mm_.begin(), ends_mm_.end() - 1, s_mm);
    return pieces_[static_cast<std::size_t>(end - ends_mm_.begin())].at(s_mm);
}

path with_places(const path& p, double step_mm)
{
    std::shared_ptr<path::impl> out;
    std::size_t left = most_pieces;
    const std::vector<path::impl::measured_curve>& curves = access::of(p).curves;
    for (std::size_t i = 0; i < curves.size() && left >= most_pieces_of_curve; ++i) {
        const arc_length& measure = curves[i].measure;
        if (measure.total() < least_steps * step_mm)
            continue;
        auto places = std::make_shared<const curve_places>(curves[i].form, measure, most_pieces_of_curve);
        left -= std::min(left, places->pieces());
        if (places->pieces() > most_pieces_of_curve)
            continue;
        if (out == nullptr)
            out = std::make_shared<path::impl>(access::of(p));
        out->curves[i].places = std::move(places);
    }
    return out == nullptr ? p : access::make<path>(std::shared_ptr<const path::impl>(std::move(out)));
}

} // namespace tactor::detail
