// SPDX-License-Identifier: MIT
// Any array, stroke and options: a plan whose numbers hold and, as the input says, which is the same twice,
// whose samples are within full scale, or whose percept is finite. Not all three each time: they take longer
// than the plan.
#include <cmath>
#include <optional>

#include <fuzzer/FuzzedDataProvider.h>

#include <tactor/percept.hpp>

#include "holds.hpp"

using namespace tactor;

namespace {

// A coordinate: near others, on a lattice, or anything that a double can be.
double coordinate(FuzzedDataProvider& in)
{
    switch (in.ConsumeIntegralInRange(0, 7)) {
    case 0:
        return in.ConsumeFloatingPoint<double>();
    case 1:
        return in.ConsumeFloatingPointInRange(-1e-5, 1e-5) + 10.0 * in.ConsumeIntegralInRange(-3, 3);
    case 2:
        return in.ConsumeFloatingPointInRange(-100.0, 100.0);
    default:
        return 10.0 * in.ConsumeIntegralInRange(-3, 3);
    }
}

point place(FuzzedDataProvider& in)
{
    const double x = coordinate(in);
    return {x, coordinate(in)};
}

array any_array(FuzzedDataProvider& in)
{
    if (in.ConsumeBool())
        return make_grid("grid", in.ConsumeIntegralInRange(1U, 5U), in.ConsumeIntegralInRange(1U, 5U),
                         in.ConsumeFloatingPointInRange(0.1, 50.0),
                         in.ConsumeFloatingPointInRange(0.1, 50.0));
    array a;
    const unsigned n = in.ConsumeIntegralInRange(1U, 24U);
    const bool on_circle = in.ConsumeBool();
    for (unsigned i = 0; i < n; ++i) {
        tactor_spec t;
        const double angle = 6.283185307179586 * i / n;
        t.position = on_circle ? point{30.0 * std::cos(angle), 30.0 * std::sin(angle)} : place(in);
        t.channel = i;
        a.tactors.push_back(t);
    }
    return a;
}

trajectory any_motion(FuzzedDataProvider& in)
{
    const int kind = in.ConsumeIntegralInRange(0, 3);
    if (kind == 0) {
        const path p = path::arc(place(in), in.ConsumeFloatingPointInRange(0.0, 60.0),
                                 in.ConsumeFloatingPointInRange(-720.0, 720.0),
                                 in.ConsumeFloatingPointInRange(-360.0, 360.0));
        return trajectory::along(p, in.ConsumeFloatingPointInRange(0.0, 10.0));
    }
    if (kind == 1)
        return preset_stroke(in.PickValueInArray({"park2016-1", "park2016-2", "park2016-3", "park2016-4",
                                                  "wave-2x4", "round-2x4"}))
            .motion;
    std::vector<timed_point> timed;
    std::vector<point> points;
    double t = 0.0;
    for (int n = in.ConsumeIntegralInRange(0, 12); n >= 0; --n) {
        points.push_back(place(in));
        timed.push_back({t, points.back(), in.ConsumeFloatingPointInRange(0.0, 1.0)});
        t += in.ConsumeFloatingPointInRange(0.0, 1.0);
    }
    return kind == 2 ? trajectory::timed(timed)
                     : trajectory::along(path::polyline(points), in.ConsumeFloatingPointInRange(0.0, 10.0));
}

// Mostly what is allowed.
double any_number(FuzzedDataProvider& in, double low, double high)
{
    return in.ConsumeIntegralInRange(0, 15) == 0 ? in.ConsumeFloatingPoint<double>()
                                                 : in.ConsumeFloatingPointInRange(low, high);
}

plan_options any_options(FuzzedDataProvider& in)
{
    plan_options o;
    o.algorithm = in.PickValueInArray(
        {algorithm_kind::park2016, algorithm_kind::tactile_brush, algorithm_kind::continuous});
    o.phantom = in.PickValueInArray({phantom_kind::inverse_distance, phantom_kind::barycentric,
                                     phantom_kind::linear, phantom_kind::log, phantom_kind::gaussian});
    if (o.phantom == phantom_kind::inverse_distance)
        o.faces = in.PickValueInArray({faces_kind::delaunay, faces_kind::nearest});
    o.timing = in.PickValueInArray({timing_kind::fixed, timing_kind::fit});
    o.outside = in.PickValueInArray({outside_kind::error, outside_kind::clamp});
    o.overlap = in.PickValueInArray({overlap_kind::energy, overlap_kind::max, overlap_kind::sum});
    o.snap = in.ConsumeBool();
    o.drop_points = in.ConsumeBool();
    if (in.ConsumeBool())
        return o;
    o.soa_s = any_number(in, 0.048, 0.07);
    o.min_duration_s = any_number(in, 0.005, 0.07);
    o.carrier_hz = any_number(in, 20.0, 1000.0);
    if (in.ConsumeBool())
        o.profile = {any_number(in, 0.1, 0.9), any_number(in, 0.01, 0.05), any_number(in, 0.05, 0.2)};
    return o;
}

void check_percept(const array& a, const stroke& s, const plan& p)
{
    if (p.stroke_duration_s > 2.0)
        return;
    for (const percept_sample& f : predict_percept(a, s, p)) {
        HOLDS(std::isfinite(f.intensity) && f.intensity >= 0.0);
        HOLDS(!f.felt || (std::isfinite(f.felt->x_mm) && std::isfinite(f.felt->y_mm)));
        HOLDS(!f.speed_mm_s || std::isfinite(*f.speed_mm_s));
    }
}

struct question {
    array a;
    stroke s;
    plan_options o;
};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    FuzzedDataProvider in(data, size);
    const auto q = fuzz::accepted([&] {
        array a = any_array(in);
        stroke s{"any", any_motion(in)};
        return std::optional(question{std::move(a), std::move(s), any_options(in)});
    });
    if (!q)
        return 0;
    const auto p = fuzz::accepted([&] { return std::optional(make_plan(q->a, q->s, q->o)); });
    if (!p)
        return 0;
    fuzz::check_array(q->a);
    fuzz::check_plan(q->a, q->s, q->o, *p);
    switch (in.ConsumeIntegralInRange(0, 2)) {
    case 0:
        HOLDS(*p == make_plan(q->a, q->s, q->o));
        break;
    case 1:
        if (const auto s = fuzz::accepted([&] { return std::optional(score(q->a, {{*p, {}}}, {})); }))
            fuzz::check_samples(*s);
        break;
    default:
        check_percept(q->a, q->s, *p);
    }
    return 0;
}
