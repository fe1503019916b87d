// SPDX-License-Identifier: MIT
#include "core/trajectory/spans.hpp"
#include "core/access.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/path/impl.hpp"
#include "core/trajectory/impl.hpp"

namespace tactor::detail {
namespace {

using visitor = std::function<bool(const trajectory_span&)>;

void along_path(const trajectory::impl& motion, const drawn_path& law, const visitor& visit)
{
    const path::impl& way = detail::access::of(law.way);
    const double duration_s = motion.duration_s;
    const double length = way.s.back();
    const auto when = [&](double s_mm) { return motion.arrival_s(law, std::min(s_mm, length)); };
    const double steady = motion.gain * law.intensity;
    trajectory_span span;
    span.intensity = steady;
    auto curve = way.curves.begin();
    for (std::size_t i = 0; i + 1 < way.vertices.size(); ++i) {
        span.from_s = span.to_s;
        span.to_s = i + 2 == way.vertices.size() ? duration_s : when(way.s[i + 1]);
        if (law.moves)
            span.intensity = steady * law.moves->greatest(way.s[i] / length, way.s[i + 1] / length);
        span.curve = nullptr;
        span.time_at = nullptr;
        if (curve != way.curves.end() && curve->segment == i) {
            span.curve = &curve->form;
            span.time_at = [&way, &when, i, c = &*curve](double parameter) {
                return when(way.s[i] + c->measure.at(c->form, parameter));
            };
            ++curve;
        }
        if (!visit(span))
            return;
    }
}

void between_points(const timed_points& law, double duration_s, double gain, const visitor& visit)
{
    const std::vector<timed_point>& p = *law.points;
    const double own = law.duration_s();
    trajectory_span span;
    for (std::size_t i = 0; i + 1 < p.size(); ++i) {
        span.from_s = span.to_s;
        span.to_s = own == duration_s ? p[i + 1].t_s : p[i + 1].t_s / own * duration_s;
        span.intensity = gain * std::max(p[i].intensity, p[i + 1].intensity);
        if (!visit(span))
            return;
    }
}

} // namespace

void for_each_span(const trajectory& t, const visitor& visit)
{
    const trajectory::impl& d = detail::access::of(t);
    if (const auto* c = std::get_if<drawn_path>(&d.law))
        along_path(d, *c, visit);
    else
        between_points(*std::get_if<timed_points>(&d.law), d.duration_s, d.gain, visit);
}

} // namespace tactor::detail
