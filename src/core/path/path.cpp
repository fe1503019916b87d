// SPDX-License-Identifier: MIT
#include <tactor/path.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include <boost/math/special_functions/cos_pi.hpp>
#include <boost/math/special_functions/sin_pi.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/access.hpp"
#include "core/bounds.hpp"
#include "core/path/impl.hpp"

namespace tactor {
inline namespace v0 {
namespace {

using detail::axis;

// Neumaier's compensated sum. It keeps all digits when a million short segments are added.
class exact_sum {
public:
    void add(double v) noexcept
    {
        const double t = sum_ + v;
        lost_ += std::abs(sum_) >= std::abs(v) ? (sum_ - t) + v : (v - t) + sum_;
        sum_ = t;
    }
    double value() const noexcept { return sum_ + lost_; }

private:
    double sum_ = 0.0;
    double lost_ = 0.0;
};

// Returns a point of a circle. The point is exact at multiples of 90 degrees.
point on_circle(point centre, double radius_mm, double degrees)
{
    return {centre.x_mm + radius_mm * boost::math::cos_pi(degrees / 180.0),
            centre.y_mm + radius_mm * boost::math::sin_pi(degrees / 180.0)};
}

// Nodes of a path for find_intersections(): its vertices, and the points inside its curves at which the
// coordinate turns.
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
            for (const double t : detail::find_turning_points(curve->form, a))
                nodes_.push_back(
                    {i, t, distance(detail::position(curve->form, t)), arc_length_at(*curve, t)});
            ++curve;
        }
    }

    std::size_t size() const { return nodes_.size(); }
    double signed_distance(std::size_t i) const { return nodes_[i].off; }
    double progress(std::size_t i) const { return nodes_[i].s; }
    double length(std::size_t i, std::size_t j) const { return nodes_[j].s - nodes_[i].s; }

    double find_crossing(std::size_t i) const
    {
        const node& a = nodes_[i];
        const node& b = nodes_[i + 1];
        const auto* c = path_.find_curve(a.segment);
        if (c == nullptr)
            return a.s + (b.s - a.s) * (a.off / (a.off - b.off));
        const double t = find_line_parameter(c->form, a.t, b.segment == a.segment ? b.t : 1.0);
        return arc_length_at(*c, t);
    }

private:
    struct node {
        std::size_t segment;
        double t;
        double off;
        double s;
    };

    // Returns the arc length along the path at parameter t of a curve. Clamps it to the curve's end, which
    // the sum may exceed by a rounding error.
    double arc_length_at(const path::impl::measured_curve& c, double t) const
    {
        return std::min(path_.s[c.segment] + c.measure.at(c.form, t), path_.s[c.segment + 1]);
    }

    double distance(point p) const { return detail::coordinate(p, axis_) - line_; }

    double find_line_parameter(const detail::shape& form, double from, double to) const
    {
        const auto off = [&](double t) { return distance(detail::position(form, t)); };
        const double first = off(from);
        const double last = off(to);
        // The ends of a curve may differ from its vertices by a rounding error, so the signs may be equal.
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

std::vector<double> find_meetings(const path::impl& p, axis a, double line)
{
    if (!std::isfinite(line))
        return {};
    return detail::find_intersections(path_nodes(p, a, line));
}

using out = std::back_insert_iterator<std::string>;

void write(out o, const detail::cubic& c, point to)
{
    fmt::format_to(o, " C {} {} {} {} {} {}", c.p[1].x_mm, c.p[1].y_mm, c.p[2].x_mm, c.p[2].y_mm, to.x_mm,
                   to.y_mm);
}

constexpr double flat_mm = 1e-6; // smaller widths are lost to rounding at coordinates of up to a kilometre

// Writes an ellipse that is so flat that it is a line: writes straight lines to the ends that the arc
// reaches.
void write_flat_ellipse(out o, const detail::elliptic& e, double turn, point to)
{
    const double end = e.from + e.sweep;
    const double low = std::min(e.from, end);
    const double high = std::max(e.from, end);
    const auto first = static_cast<int>(std::ceil((low - turn) / std::numbers::pi));
    const auto last = static_cast<int>(std::floor((high - turn) / std::numbers::pi));
    for (int n = 0; n <= last - first; ++n) {
        const double t = turn + std::numbers::pi * (e.sweep > 0.0 ? first + n : last - n);
        const point p = detail::position(e, (t - e.from) / e.sweep);
        fmt::format_to(o, " L {} {}", p.x_mm, p.y_mm);
    }
    fmt::format_to(o, " L {} {}", to.x_mm, to.y_mm);
}

// Writes an arc of an ellipse. The conjugate radii u and v determine the principal axes: the eigenvalues of u
// u' + v v' are the squares of their lengths. Each written arc is less than a half turn, so readers find its
// centre without ambiguity.
void write(out o, const detail::elliptic& e, point to)
{
    const double xx = e.u.x_mm * e.u.x_mm + e.v.x_mm * e.v.x_mm;
    const double xy = e.u.x_mm * e.u.y_mm + e.v.x_mm * e.v.y_mm;
    const double yy = e.u.y_mm * e.u.y_mm + e.v.y_mm * e.v.y_mm;
    const double determinant = e.u.x_mm * e.v.y_mm - e.u.y_mm * e.v.x_mm;
    const double longer = std::sqrt(0.5 * (xx + yy + std::hypot(xx - yy, 2.0 * xy)));
    const double shorter = std::abs(determinant) / longer;
    if (shorter < flat_mm) {
        const double uu = e.u.x_mm * e.u.x_mm + e.u.y_mm * e.u.y_mm;
        const double uv = e.u.x_mm * e.v.x_mm + e.u.y_mm * e.v.y_mm;
        const double vv = e.v.x_mm * e.v.x_mm + e.v.y_mm * e.v.y_mm;
        return write_flat_ellipse(o, e, 0.5 * std::atan2(2.0 * uv, uu - vv), to);
    }
    const double turn = 0.5 * std::atan2(2.0 * xy, xx - yy) * 180.0 / std::numbers::pi;
    const bool clockwise = (determinant > 0.0) == (e.sweep > 0.0);
    const int parts = static_cast<int>(std::ceil(std::abs(e.sweep) / 2.1));
    for (int k = 1; k <= parts; ++k) {
        const point p = k == parts ? to : detail::position(e, static_cast<double>(k) / parts);
        fmt::format_to(o, " A {} {} {} 0 {} {} {}", longer, shorter, turn, clockwise ? 1 : 0, p.x_mm, p.y_mm);
    }
}

} // namespace
} // namespace v0
} // namespace tactor

namespace tactor::detail {
namespace {

[[noreturn]] void refuse_coordinate(std::string_view what, double value)
{
    throw error(error_kind::bad_input, what,
                std::isfinite(value) ? fmt::format("it goes to {:.6g} mm, beyond {:g} mm", value, max_mm)
                                     : "it has a coordinate that is not finite",
                "give coordinates in millimetres");
}

std::optional<double> find_bad_coordinate(point p)
{
    for (const double v : {p.x_mm, p.y_mm})
        if (!(std::abs(v) <= max_mm))
            return v;
    return std::nullopt;
}

std::optional<double> find_bad_coordinate(const shape& c)
{
    if (const auto* b = std::get_if<cubic>(&c)) {
        for (const point p : b->p)
            if (const auto bad = find_bad_coordinate(p))
                return bad;
        return std::nullopt;
    }
    const auto& e = std::get<elliptic>(c);
    for (const double v : {e.centre.x_mm, e.centre.y_mm, e.u.x_mm, e.u.y_mm, e.v.x_mm, e.v.y_mm, e.sweep})
        if (!std::isfinite(v))
            return v;
    for (const axis a : {axis::x, axis::y})
        for (const double t : find_turning_points(c, a))
            if (const auto bad = find_bad_coordinate(position(c, t)))
                return bad;
    return std::nullopt;
}

/// Least number of steps on a curve for which polynomials save time. Making the polynomials takes as long as
/// computing some hundred places.
constexpr double least_steps = 256.0;
/// Most pieces of one curve, and of all curves of a path (6 MB).
constexpr std::size_t most_pieces_of_curve = 1024;
constexpr std::size_t most_pieces = 32768;

} // namespace

void outline::line(point to)
{
    if (to != vertices.back())
        vertices.push_back(to);
}

void outline::bezier(point c1, point c2, point to)
{
    const point from = vertices.back();
    if (c1 == from && c2 == from && to == from)
        return;
    curves.push_back({vertices.size() - 1, cubic{{from, c1, c2, to}}});
    vertices.push_back(to);
}

void outline::quadratic(point c, point to)
{
    const point from = vertices.back();
    bezier(interpolate_points(from, c, 2.0 / 3.0), interpolate_points(to, c, 2.0 / 3.0), to);
}

void outline::arc(const elliptic& a, point to)
{
    if (a.sweep == 0.0)
        return line(to);
    curves.push_back({vertices.size() - 1, a});
    vertices.push_back(to);
}

outline apply_map(outline o, const affine& m)
{
    for (point& p : o.vertices)
        p = m(p);
    for (outline::curve& c : o.curves)
        c.form = apply_map(c.form, m);
    return o;
}

std::optional<double> find_bad_coordinate(const outline& o)
{
    for (const point p : o.vertices)
        if (const auto bad = find_bad_coordinate(p))
            return bad;
    for (const outline::curve& c : o.curves)
        if (const auto bad = find_bad_coordinate(c.form))
            return bad;
    return std::nullopt;
}

path make_path(outline o, std::string_view what)
{
    if (const auto bad = find_bad_coordinate(o))
        refuse_coordinate(what, *bad);
    auto made = std::make_shared<path::impl>();
    made->curves.reserve(o.curves.size());
    for (const outline::curve& c : o.curves)
        made->curves.push_back({c.segment, c.form, arc_length(c.form)});
    made->vertices = std::move(o.vertices);
    made->s.reserve(made->vertices.size());
    exact_sum length;
    auto curve = made->curves.begin();
    for (std::size_t i = 0; i < made->vertices.size(); ++i) {
        made->s.push_back(length.value());
        if (curve != made->curves.end() && curve->segment == i)
            length.add((curve++)->measure.total());
        else if (i + 1 < made->vertices.size())
            length.add(distance_mm(made->vertices[i], made->vertices[i + 1]));
    }
    if (!(made->s.back() > same_place_mm)) { // the path is a single place
        made->vertices.resize(1);
        made->s.resize(1);
        made->curves.clear();
    }
    return detail::access::make<path>(std::shared_ptr<const path::impl>(std::move(made)));
}

path with_places(const path& p, double step_mm)
{
    std::shared_ptr<path::impl> out;
    std::size_t remaining = most_pieces;
    const std::vector<path::impl::measured_curve>& curves = access::of(p).curves;
    for (std::size_t i = 0; i < curves.size() && remaining >= most_pieces_of_curve; ++i) {
        const arc_length& measure = curves[i].measure;
        if (measure.total() < least_steps * step_mm)
            continue;
        auto places = std::make_shared<const curve_places>(curves[i].form, measure, most_pieces_of_curve);
        remaining -= std::min(remaining, places->pieces());
        if (places->pieces() > most_pieces_of_curve)
            continue;
        if (out == nullptr)
            out = std::make_shared<path::impl>(access::of(p));
        out->curves[i].places = std::move(places);
    }
    return out == nullptr ? p : access::make<path>(std::shared_ptr<const path::impl>(std::move(out)));
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

path path::polyline(std::span<const point> points)
{
    if (points.empty())
        throw error(error_kind::bad_input, "polyline", "it has no point",
                    "give the start and the end of the path")
            .with_field("points");
    detail::outline o;
    o.vertices.reserve(points.size());
    o.vertices.push_back(points.front());
    for (const point p : points.subspan(1))
        o.line(p);
    return detail::make_path(std::move(o), "polyline");
}

path path::arc(point centre, double radius_mm, double from_deg, double sweep_deg)
{
    if (!(radius_mm > 0.0 && radius_mm <= detail::max_mm))
        throw error(error_kind::bad_input, "arc", fmt::format("a radius of {} mm is out of range", radius_mm),
                    fmt::format("give more than 0 and at most {:g} mm", detail::max_mm))
            .with_field("radius_mm");
    if (!(std::abs(from_deg) <= 1e6))
        throw error(error_kind::bad_input, "arc",
                    fmt::format("a first angle of {} degrees is out of range", from_deg),
                    "use -360 to 360 degrees")
            .with_field("from_deg");
    if (!(std::abs(sweep_deg) <= 360.0 && sweep_deg != 0.0))
        throw error(error_kind::bad_input, "arc",
                    fmt::format("a sweep of {} degrees is out of range", sweep_deg),
                    "give -360 to 360 degrees, not 0")
            .with_field("sweep_deg");
    constexpr double radian = 3.14159265358979323846 / 180.0;
    const double from = std::remainder(from_deg, 360.0);
    const bool whole = std::abs(sweep_deg) == 360.0;
    detail::outline o;
    o.vertices.push_back(on_circle(centre, radius_mm, from));
    o.arc({centre, {radius_mm, 0.0}, {0.0, radius_mm}, from * radian, sweep_deg * radian},
          whole ? o.vertices.front() : on_circle(centre, radius_mm, from + sweep_deg));
    return detail::make_path(std::move(o), "arc");
}

const path::impl::measured_curve* path::impl::find_curve(std::size_t segment) const noexcept
{
    const auto c = std::lower_bound(
        curves.begin(), curves.end(), segment,
        [](const measured_curve& a, std::size_t wanted) noexcept { return a.segment < wanted; });
    return c != curves.end() && c->segment == segment ? &*c : nullptr;
}

double path::length_mm() const noexcept
{
    return impl_->s.back();
}

point path::at(double s_mm) const noexcept
{
    const impl& p = *impl_;
    if (!(s_mm > 0.0))
        return p.vertices.front();
    if (s_mm >= p.s.back())
        return p.vertices.back();
    const auto i = static_cast<std::size_t>(std::upper_bound(p.s.begin(), p.s.end(), s_mm) - p.s.begin()) - 1;
    const double along = s_mm - p.s[i];
    if (along == 0.0)
        return p.vertices[i];
    if (const auto* c = p.find_curve(i))
        return c->places != nullptr ? c->places->at(along)
                                    : detail::position(c->form, c->measure.parameter(c->form, along));
    return detail::interpolate_points(p.vertices[i], p.vertices[i + 1], along / (p.s[i + 1] - p.s[i]));
}

std::vector<double> path::meets_x(double x_mm) const
{
    return find_meetings(*impl_, axis::x, x_mm);
}

std::vector<double> path::meets_y(double y_mm) const
{
    return find_meetings(*impl_, axis::y, y_mm);
}

std::string path::svg() const
{
    const impl& p = *impl_;
    std::string data = fmt::format("M {} {}", p.vertices[0].x_mm, p.vertices[0].y_mm);
    const out o(data);
    auto curve = p.curves.begin();
    for (std::size_t i = 0; i + 1 < p.vertices.size(); ++i) {
        const point to = p.vertices[i + 1];
        if (curve != p.curves.end() && curve->segment == i)
            std::visit([&](const auto& form) { write(o, form, to); }, (curve++)->form);
        else
            fmt::format_to(o, " L {} {}", to.x_mm, to.y_mm);
    }
    return data;
}

} // namespace v0
} // namespace tactor
