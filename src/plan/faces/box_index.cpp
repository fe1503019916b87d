// SPDX-License-Identifier: MIT
#include "plan/faces/box_index.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace tactor::detail {
namespace {

// The most cells that a box lies in on average: cells are made larger until this holds, so that long boxes
// that lap over each other do not take memory by the square of their number.
constexpr std::size_t most_cells = 8;

box around(point p, double margin_mm)
{
    return {{p.x_mm - margin_mm, p.y_mm - margin_mm}, {p.x_mm + margin_mm, p.y_mm + margin_mm}};
}

bool meet(const box& a, const box& b)
{
    return a.low.x_mm <= b.high.x_mm && b.low.x_mm <= a.high.x_mm && a.low.y_mm <= b.high.y_mm &&
           b.low.y_mm <= a.high.y_mm;
}

std::vector<point> corners(const std::vector<box>& boxes)
{
    std::vector<point> c;
    for (const box& b : boxes)
        c.insert(c.end(), {b.low, b.high});
    return c;
}

double cell_size(const box& all, std::size_t boxes)
{
    const double width = all.high.x_mm - all.low.x_mm;
    const double height = all.high.y_mm - all.low.y_mm;
    const auto n = static_cast<double>(boxes);
    const double size = std::max(std::sqrt(width / n * height), std::max(width, height) / n);
    return size > 0.0 ? size : 1.0;
}

/// Returns the cell of a coordinate; places outside belong to the outermost cells.
std::size_t cell(double offset_mm, double cell_mm, std::size_t cells)
{
    const double i = offset_mm / cell_mm;
    if (!(i > 0.0))
        return 0;
    return i < static_cast<double>(cells) ? static_cast<std::size_t>(i) : cells - 1;
}

} // namespace

box box_around(const std::vector<point>& points)
{
    box b{points.front(), points.front()};
    for (const point& p : points) {
        b.low = {std::min(b.low.x_mm, p.x_mm), std::min(b.low.y_mm, p.y_mm)};
        b.high = {std::max(b.high.x_mm, p.x_mm), std::max(b.high.y_mm, p.y_mm)};
    }
    return b;
}

box_index::box_index(std::vector<box> boxes)
    : boxes_(std::move(boxes)), all_(box_around(corners(boxes_))), cell_mm_(cell_size(all_, boxes_.size()))
{
    for (std::size_t entries = 0;; entries = 0, cell_mm_ *= 2.0) {
        columns_ = static_cast<std::size_t>((all_.high.x_mm - all_.low.x_mm) / cell_mm_) + 1;
        rows_ = static_cast<std::size_t>((all_.high.y_mm - all_.low.y_mm) / cell_mm_) + 1;
        for (const box& b : boxes_) {
            const range r = cells(b);
            entries += (r.right - r.left + 1) * (r.high - r.low + 1);
        }
        if (entries <= most_cells * boxes_.size())
            break;
    }
    items_.resize(columns_ * rows_);
    for (unsigned i = 0; i < boxes_.size(); ++i) {
        const range r = cells(boxes_[i]);
        for (std::size_t row = r.low; row <= r.high; ++row)
            for (std::size_t column = r.left; column <= r.right; ++column)
                items_[row * columns_ + column].push_back(i);
    }
}

box_index::range box_index::cells(const box& b) const
{
    const auto column = [&](point p) { return cell(p.x_mm - all_.low.x_mm, cell_mm_, columns_); };
    const auto row = [&](point p) { return cell(p.y_mm - all_.low.y_mm, cell_mm_, rows_); };
    return {column(b.low), column(b.high), row(b.low), row(b.high)};
}

void box_index::near(point p, double margin_mm, std::vector<unsigned>& out) const
{
    out.clear();
    const box asked = around(p, margin_mm);
    const range r = cells(asked);
    for (std::size_t row = r.low; row <= r.high; ++row)
        for (std::size_t column = r.left; column <= r.right; ++column)
            for (const unsigned i : items_[row * columns_ + column])
                if (meet(boxes_[i], asked))
                    out.push_back(i);
    if (r.left == r.right && r.low == r.high)
        return;
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
}

unsigned box_index::nearest(point p, const std::function<double(unsigned)>& distance) const
{
    const double outside_mm = std::max({0.0, all_.low.x_mm - p.x_mm, p.x_mm - all_.high.x_mm,
                                        all_.low.y_mm - p.y_mm, p.y_mm - all_.high.y_mm});
    unsigned best = 0;
    double least = std::numeric_limits<double>::infinity();
    std::vector<unsigned> found;
    // The first items found say how far to look.
    for (double reach = outside_mm + 0.5 * cell_mm_;; reach = std::min(least, 2.0 * reach)) {
        near(p, reach, found);
        for (const unsigned i : found)
            if (const double d = distance(i); d < least || (d == least && i < best)) {
                least = d;
                best = i;
            }
        if (least <= reach)
            return best;
    }
}

} // namespace tactor::detail
