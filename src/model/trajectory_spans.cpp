// SPDX-License-Identifier: MIT
#include "model/trajectory_spans.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "model/path_impl.hpp"
#include "model/trajectory_impl.hpp"

namespace tactor::detail {
namespace {

using visitor = std::function<bool(const trajectory_span&)>;

void along_path(const constant_speed& law, double duration_s, double gain, const visitor& visit)
{
    const path::impl& way = law.way.data();
    const auto when = [&](double s_mm) { return std::min(s_mm / way.s.back(), 1.0) * duration_s; };
    trajectory_span span;
    span.intensity = gain * law.intensity;
    auto curve = way.curves.begin();
    for (std::size_t i = 0; i + 1 < way.vertices.size(); ++i) {
        span.from_s = span.to_s;
        span.to_s = i + 2 == way.vertices.size() ? duration_s : when(way.s[i + 1]);
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
    const trajectory::impl& d = t.data();
    if (const auto* c = std::get_if<constant_speed>(&d.law))
        along_path(*c, d.duration_s, d.gain, visit);
    else
        between_points(*std::get_if<timed_points>(&d.law), d.duration_s, d.gain, visit);
}

} // namespace tactor::detail
