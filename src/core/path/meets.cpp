// SPDX-License-Identifier: MIT
#include "core/path/meets.hpp"

#include <algorithm>
#include <cstdint>

#include <boost/math/tools/toms748_solve.hpp>

#include "core/path/impl.hpp"

namespace tactor {
inline namespace v0 {
namespace {

using detail::axis;

// Nodes of a path: its vertices, and the turns of the coordinate inside its curves.
class path_nodes {
public:
    path_nodes(const path::impl& p, axis a, double line) : path_(p), axis_(a), line_(line)
    {
        nodes_.reserve(p.vertices.size());
        auto curve = p.curves.begin();
        for (std::size_t i = 0; i < p.vertices.size(); ++i) {
            nodes_.push_back({i, 0.0, distance(p.vertices[i]), p.s[i]});
            if (curve == p.curves.end() || curve->segment != i)
                continue;
            for (const double t : detail::turns(curve->form, a))
                nodes_.push_back({i, t, distance(detail::position(curve->form, t)), along(*curve, t)});
            ++curve;
        }
    }

    std::size_t size() const { return nodes_.size(); }
    double off(std::size_t i) const { return nodes_[i].off; }
    double when(std::size_t i) const { return nodes_[i].s; }
    double length(std::size_t i, std::size_t j) const { return nodes_[j].s - nodes_[i].s; }

    double root(std::size_t i) const
    {
        const node& a = nodes_[i];
        const node& b = nodes_[i + 1];
        const auto* c = path_.find_curve(a.segment);
        if (c == nullptr)
            return a.s + (b.s - a.s) * (a.off / (a.off - b.off));
        const double t = parameter_on_line(c->form, a.t, b.segment == a.segment ? b.t : 1.0);
        return along(*c, t);
    }

private:
    struct node {
        std::size_t segment;
        double t;
        double off;
        double s;
    };

    // Clamps the sum, which may exceed the curve's end by a rounding error.
    double along(const path::impl::measured_curve& c, double t) const
    {
        return std::min(path_.s[c.segment] + c.measure.at(c.form, t), path_.s[c.segment + 1]);
    }

    double distance(point p) const { return detail::coordinate(p, axis_) - line_; }

    double parameter_on_line(const detail::shape& form, double from, double to) const
    {
        const auto off = [&](double t) { return distance(detail::position(form, t)); };
        const double first = off(from);
        const double last = off(to);
        // Ends of a curve may differ from its vertices in the last digits.
        if (!((first < 0.0 && last > 0.0) || (first > 0.0 && last < 0.0)))
            return std::abs(first) < std::abs(last) ? from : to;
        std::uintmax_t steps = 100;
        const auto [low, high] = boost::math::tools::toms748_solve(
            off, from, to, first, last, boost::math::tools::eps_tolerance<double>(52), steps);
        return 0.5 * (low + high);
    }

    const path::impl& path_;
    axis axis_;
    double line_;
    std::vector<node> nodes_;
};

std::vector<double> meets(const path::impl& p, axis a, double line)
{
    if (!std::isfinite(line))
        return {};
    const path_nodes nodes(p, a, line);
    return detail::line_meetings(nodes).find();
}

} // namespace

std::vector<double> path::meets_x(double x_mm) const
{
    return meets(*impl_, axis::x, x_mm);
}

std::vector<double> path::meets_y(double y_mm) const
{
    return meets(*impl_, axis::y, y_mm);
}

} // namespace v0
} // namespace tactor
