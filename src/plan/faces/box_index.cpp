// SPDX-License-Identifier: MIT
#include "plan/faces/box_index.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

// Boost 1.74 includes a header of its own that it deprecates.
#define BOOST_ALLOW_DEPRECATED_HEADERS
// With much in one unit gcc 12 sees an overflow in the list of branches of a query, which is none.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Warray-bounds"
#include <boost/geometry.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/index/rtree.hpp>
#pragma GCC diagnostic pop

namespace tactor::detail {
namespace {

namespace bg = boost::geometry;
namespace bgi = boost::geometry::index;

using tree_point = bg::model::d2::point_xy<double>;
using tree_box = bg::model::box<tree_point>;
using entry = std::pair<tree_box, unsigned>;

// Squares of coordinates must stay finite in the tree.
constexpr double far_mm = 1e9;

tree_point to_tree(point p)
{
    return {std::clamp(p.x_mm, -far_mm, far_mm), std::clamp(p.y_mm, -far_mm, far_mm)};
}

tree_box around(point p, double margin_mm)
{
    return {to_tree({p.x_mm - margin_mm, p.y_mm - margin_mm}),
            to_tree({p.x_mm + margin_mm, p.y_mm + margin_mm})};
}

std::vector<entry> entries(const std::vector<box>& boxes)
{
    std::vector<entry> e;
    e.reserve(boxes.size());
    for (const box& b : boxes)
        e.emplace_back(tree_box{to_tree(b.low), to_tree(b.high)}, static_cast<unsigned>(e.size()));
    return e;
}

} // namespace

struct box_index::tree {
    bgi::rtree<entry, bgi::rstar<8>> items;
};

box box_around(const std::vector<point>& points)
{
    box b{points.front(), points.front()};
    for (const point& p : points) {
        b.low = {std::min(b.low.x_mm, p.x_mm), std::min(b.low.y_mm, p.y_mm)};
        b.high = {std::max(b.high.x_mm, p.x_mm), std::max(b.high.y_mm, p.y_mm)};
    }
    return b;
}

box_index::box_index(const std::vector<box>& boxes)
    : tree_(std::make_shared<tree>(tree{bgi::rtree<entry, bgi::rstar<8>>(entries(boxes))}))
{
}

void box_index::near(point p, double margin_mm, std::vector<unsigned>& out) const
{
    out.clear();
    const auto query = bgi::intersects(around(p, margin_mm));
    for (auto it = tree_->items.qbegin(query); it != tree_->items.qend(); ++it)
        out.push_back(it->second);
    std::sort(out.begin(), out.end());
}

unsigned box_index::nearest(point p, const std::function<double(unsigned)>& distance) const
{
    // The item with the nearest box says how far to look.
    entry guess;
    tree_->items.query(bgi::nearest(to_tree(p), 1U), &guess);
    unsigned best = guess.second;
    double least = distance(best);
    const auto query = bgi::intersects(around(p, least));
    for (auto it = tree_->items.qbegin(query); it != tree_->items.qend(); ++it) {
        const double d = distance(it->second);
        if (d < least || (d == least && it->second < best)) {
            least = d;
            best = it->second;
        }
    }
    return best;
}

} // namespace tactor::detail
