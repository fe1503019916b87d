// SPDX-License-Identifier: MIT
#include <tactor/path.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include <boost/math/special_functions/cos_pi.hpp>
#include <boost/math/special_functions/sin_pi.hpp>
#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/access.hpp"
#include "core/limits.hpp"
#include "core/path/impl.hpp"

namespace tactor {
inline namespace v0 {
namespace {

// Neumaier's sum, which keeps all digits of a million short segments.
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

[[noreturn]] void refuse_absurd(std::string_view what, double value)
{
    throw error(error_kind::bad_input, what,
                std::isfinite(value) ? fmt::format("goes to {:.6g} mm, beyond {:g} mm", value, detail::max_mm)
                                     : "has a coordinate that is not finite",
                "coordinates are in millimetres");
}

// Returns a point of a circle, exact at multiples of 90 degrees.
point on_circle(point centre, double radius_mm, double degrees)
{
    return {centre.x_mm + radius_mm * boost::math::cos_pi(degrees / 180.0),
            centre.y_mm + radius_mm * boost::math::sin_pi(degrees / 180.0)};
}

} // namespace

} // namespace v0
} // namespace tactor

namespace tactor::detail {

path make_path(outline o, const std::function<std::string()>& what)
{
    if (const auto bad = absurd_coordinate(o))
        refuse_absurd(what(), *bad);
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
    if (!(made->s.back() > same_place_mm)) { // a single place
        made->vertices.resize(1);
        made->s.resize(1);
        made->curves.clear();
    }
    return detail::access::make<path>(std::shared_ptr<const path::impl>(std::move(made)));
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

path path::polyline(std::span<const point> points)
{
    if (points.empty())
        throw error(error_kind::bad_input, "polyline", "has no point",
                    "give where it starts and where it ends")
            .with_field("points");
    detail::outline o;
    o.vertices.reserve(points.size());
    o.vertices.push_back(points.front());
    for (const point p : points.subspan(1))
        o.line(p);
    return detail::make_path(std::move(o), [] { return "polyline"; });
}

path path::arc(point centre, double radius_mm, double from_deg, double sweep_deg)
{
    if (!(radius_mm > 0.0 && radius_mm <= detail::max_mm))
        throw error(error_kind::bad_input, "arc", fmt::format("radius {} mm", radius_mm),
                    fmt::format("it is more than 0 and at most {:g} mm", detail::max_mm))
            .with_field("radius_mm");
    if (!(std::abs(from_deg) <= 1e6))
        throw error(error_kind::bad_input, "arc", fmt::format("first angle {} degrees", from_deg),
                    "use -360 to 360 degrees")
            .with_field("from_deg");
    if (!(std::abs(sweep_deg) <= 360.0 && sweep_deg != 0.0))
        throw error(error_kind::bad_input, "arc", fmt::format("sweep of {} degrees", sweep_deg),
                    "it is between -360 and 360 degrees and not 0")
            .with_field("sweep_deg");
    constexpr double radian = 3.14159265358979323846 / 180.0;
    const double from = std::remainder(from_deg, 360.0);
    const bool whole = std::abs(sweep_deg) == 360.0;
    detail::outline o;
    o.vertices.push_back(on_circle(centre, radius_mm, from));
    o.arc({centre, {radius_mm, 0.0}, {0.0, radius_mm}, from * radian, sweep_deg * radian},
          whole ? o.vertices.front() : on_circle(centre, radius_mm, from + sweep_deg));
    return detail::make_path(std::move(o), [] { return "arc"; });
}

path::path(std::shared_ptr<const impl> p) noexcept : impl_(std::move(p))
{
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
    return detail::between(p.vertices[i], p.vertices[i + 1], along / (p.s[i + 1] - p.s[i]));
}

} // namespace v0
} // namespace tactor
