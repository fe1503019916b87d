// SPDX-License-Identifier: MIT
#include "study/data/drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/split.hpp"

namespace tactor::study {
namespace {

// Rounds to a multiple of 1 / parts. Returns 0 instead of -0.
double rounded(double v, double parts)
{
    return std::round(v * parts) / parts + 0.0;
}

bool is_point(const drawn_point& p) noexcept
{
    // NaN fails these comparisons.
    return p.time_s >= 0.0 && p.time_s <= longest_drawn_s && std::abs(p.at.x_mm) <= farthest_drawn_mm &&
           std::abs(p.at.y_mm) <= farthest_drawn_mm;
}

// Reads "TIME X Y".
std::optional<drawn_point> read_point(std::string_view text) noexcept
{
    std::array<double, 3> numbers{};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const std::size_t end = i + 1 < numbers.size() ? text.find(' ') : text.size();
        const std::optional<double> n =
            end < text.npos ? detail::parse_number_text<double>(text.substr(0, end)) : std::nullopt;
        if (!n)
            return {};
        numbers[i] = *n;
        text.remove_prefix(std::min(text.size(), end + 1));
    }
    return drawn_point{numbers[0], {numbers[1], numbers[2]}};
}

} // namespace

std::string to_text(const drawing& d)
{
    constexpr double per_s = 1000.0;
    constexpr double per_mm = 100.0;
    std::string text;
    for (const drawn_point& p : d)
        text += fmt::format("{}{} {} {}", text.empty() ? "" : ";", rounded(p.time_s, per_s),
                            rounded(p.at.x_mm, per_mm), rounded(p.at.y_mm, per_mm));
    return text;
}

drawing thin_out(drawing d)
{
    while (d.size() > most_drawn_points) {
        drawing half;
        for (std::size_t i = 0; i + 1 < d.size(); i += 2)
            half.push_back(d[i]);
        half.push_back(d.back());
        d = std::move(half);
    }
    return d;
}

bool is_drawing(const drawing& d) noexcept
{
    return !d.empty() && d.size() <= most_drawn_points && std::ranges::all_of(d, is_point) &&
           std::ranges::is_sorted(d, {}, &drawn_point::time_s);
}

std::optional<drawing> read_drawing(std::string_view text)
{
    drawing d;
    while (d.size() <= most_drawn_points) {
        const std::size_t end = text.find(';');
        const std::optional<drawn_point> p = read_point(text.substr(0, end));
        if (!p)
            return {};
        d.push_back(*p);
        if (end == text.npos)
            return is_drawing(d) ? std::optional(std::move(d)) : std::nullopt;
        text.remove_prefix(end + 1);
    }
    return {};
}

double find_length_mm(const drawing& d) noexcept
{
    double sum = 0.0;
    for (std::size_t i = 1; i < d.size(); ++i)
        sum += distance_mm(d[i - 1].at, d[i].at);
    return sum;
}

std::vector<point> divide(const drawing& d, std::size_t parts)
{
    const double length = find_length_mm(d);
    std::vector<point> all;
    std::size_t i = 1;
    double before = 0.0; // length up to point i - 1
    for (std::size_t k = 0; k <= parts; ++k) {
        const double at = length * static_cast<double>(k) / static_cast<double>(parts);
        double step = 0.0;
        for (; i < d.size(); ++i) {
            step = distance_mm(d[i - 1].at, d[i].at);
            if (before + step >= at && step > 0.0)
                break;
            before += step;
        }
        if (i >= d.size()) { // beyond the end by a rounding error
            all.push_back(d.back().at);
            continue;
        }
        const point& from = d[i - 1].at;
        const point& to = d[i].at;
        const double part = (at - before) / step;
        all.push_back({from.x_mm + part * (to.x_mm - from.x_mm), from.y_mm + part * (to.y_mm - from.y_mm)});
    }
    return all;
}

} // namespace tactor::study
