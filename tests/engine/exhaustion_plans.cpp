// SPDX-License-Identifier: MIT
// Calls that throw: layouts, phantoms, plans, predictions, scores and renderers.
#include <cstddef>
#include <memory>
#include <vector>

#include <tactor/percept.hpp>
#include <tactor/phantom.hpp>
#include <tactor/render.hpp>

#include "exhaustion_calls.hpp"

namespace tactor::test {
namespace {

plan_options planned_by(algorithm_kind k)
{
    plan_options o;
    o.algorithm = k;
    return o;
}

const std::vector<double> onsets_s{0.0, 0.1, 0.2};

} // namespace

call_table plan_calls(const call_things& t)
{
    const auto model = make_phantom(phantom_kind::gaussian, t.l);
    const auto samples = predict_percept(t.a, t.s, t.p);
    const auto taps = predict_taps(t.a, t.s, t.p);
    const std::vector<point> inside{{10.0, 20.0}, {20.0, 20.0}, {30.0, 20.0}};
    const std::vector<point> edges{{0.0, 0.0}, {40.0, 40.0}, {0.0, 40.0}};
    const std::vector<point> few{{10.0, 20.0}};
    stroke fitted = t.s;
    fitted.fit = stroke_fit{5.0};
    stroke outside = t.s;
    outside.motion = trajectory::along(path::from_svg("M 0 0 L 400 400"), 1.0);
    const person who{.sensitivity_db = std::vector<double>(9, 1.0), .shift = std::vector<point>(9)};
    return {
        {"layout::layout", [&t] { return layout(t.a); }},
        {"layout::contains",
         [&t] {
             return t.l.contains({1.0, 2.0});
         }},
        {"layout::nearest",
         [&t] {
             return t.l.nearest({-1.0, 2.0});
         }},
        {"make_phantom", [&t] { return make_phantom(phantom_kind::barycentric, t.l); }},
        {"make_phantom, of no such faces",
         [&t] { return make_phantom(phantom_kind::barycentric, t.l, faces_kind::nearest); }},
        {"phantom_model::weights",
         [model] {
             std::vector<drive> out;
             model->weights({11.0, 12.0}, 1.0, out);
         }},
        {"phantom_model::weights, below 0",
         [model] {
             std::vector<drive> out;
             model->weights({11.0, 12.0}, -1.0, out);
         }},
        {"intensity_scale::amplitude", [] { return intensity_scale{.kind = scale_kind::sl}.amplitude(0.5); }},
        {"burst_duration_s", [] { return burst_duration_s(timing_profile{}, 1.0); }},
        {"burst_duration_s", [] { return burst_duration_s({.soa_s = 1.0}); }},
        {"make_plan", [&t] { return make_plan(t.a, t.s); }},
        {"make_plan", [&t] { return make_plan(t.a, t.l, t.s, planned_by(algorithm_kind::tactile_brush)); }},
        {"make_plan, continuous",
         [&t] { return make_plan(t.a, t.l, t.s, planned_by(algorithm_kind::continuous)); }},
        {"make_plan, outside", [&t, outside] { return make_plan(t.a, t.l, outside, {}); }},
        {"make_plan, fitted", [&t, fitted] { return make_plan(t.a, t.l, fitted, {}); }},
        {"fit_strokes", [&t] { return fit_strokes({t.s}, t.l); }},
        {"apply_fits", [&t, fitted] { return apply_fits({fitted}, t.l); }},
        {"predict_percept", [&t] { return predict_percept(t.a, t.s, t.p); }},
        {"follow_percept", [&t, who] { follow_percept(t.a, t.s, t.p, who, [](const percept_sample&) {}); }},
        {"follow_percept, of too few tactors",
         [&t] { follow_percept(t.a, t.s, t.p, {.sensitivity_db = {1.0}}, [](const percept_sample&) {}); }},
        {"summarise", [samples] { return summarise(samples); }},
        {"summarise", [&t] { return summarise(t.a, t.s, t.p); }},
        {"summarise", [taps] { return summarise(taps); }},
        {"describe", [] { return describe(low_speed_observer{}); }},
        {"felt_places", [inside] { return felt_places({}, onsets_s, inside); }},
        {"felt_places, of too few", [few] { return felt_places({}, onsets_s, few); }},
        {"predict_taps", [&t] { return predict_taps(t.a, t.s, t.p); }},
        {"predict_taps", [&t, who] { return predict_taps(t.a, t.s, t.p, {}, who); }},
        {"compensate", [&t, inside] { return compensate(t.l, {}, onsets_s, inside); }},
        {"compensate, at the edge", [&t, edges] { return compensate(t.l, {}, onsets_s, edges); }},
        {"make_compensated_plan", [&t] { return make_compensated_plan(t.a, t.l, t.s, {}); }},
    };
}

call_table sound_calls(const call_things& t)
{
    const std::vector<placed_plan> plans{{.plan = t.p}, {.plan = t.p, .start_s = 1.0}};
    const std::vector<placed_plan> early{{.plan = t.p, .start_s = -1.0}};
    const auto sine = make_plan(t.a, t.l, t.s, planned_by(algorithm_kind::continuous));
    const auto sound = std::make_shared<score>(t.a, std::vector<placed_plan>{{.plan = sine}});
    plan_options spread = planned_by(algorithm_kind::continuous);
    spread.faces = faces_kind::nearest; // each of its samples needs memory
    const auto wide = std::make_shared<score>(t.a, make_plan(t.a, t.l, t.s, spread));
    const auto rendered_by = std::make_shared<renderer>(*sound, format_kind::s16);
    const auto builder = std::make_shared<score_builder>(t.a, render_options{});
    return {
        {"start_times_s", [plans] { return start_times_s(plans); }},
        {"start_times_s, before the piece", [early] { return start_times_s(early); }},
        {"score::score", [&t, plans] { return score(t.a, plans); }},
        {"score::score", [&t] { return score(t.a, t.p); }},
        {"score::score, continuous", [&t, sine] { return score(t.a, sine); }},
        {"score::score, too loud", [&t] { return score(t.a, t.p, {.level_dbfs = 1.0}); }},
        {"score_builder::score_builder", [&t] { const score_builder made(t.a, {}); }},
        {"score_builder::add",
         [&t] {
             score_builder made(t.a, {});
             made.add(t.p);
         }},
        {"score_builder::add",
         [&t] {
             score_builder made(t.a, {});
             made.add(t.l, t.s, {});
         }},
        {"score_builder::take", [builder] { return builder->take(); }, call_kind::plain,
         [builder, &t] {
             static_cast<void>(builder->take());
             builder->add(t.p);
         }},
        {"renderer::renderer", [sound] { const renderer made(*sound, format_kind::s16); }},
        {"renderer::process",
         [sound] {
             renderer made(*sound, format_kind::s16);
             std::vector<std::byte> out(2UL * 9 * 4096);
             made.process(out);
         }},
        {"renderer::process, gaussian",
         [wide] {
             renderer made(*wide, format_kind::s16);
             std::vector<std::byte> out(2UL * 9 * 1024);
             made.process(out);
         }},
        {"renderer::process, of half a frame",
         [rendered_by] {
             std::vector<std::byte> out(1);
             rendered_by->process(out);
         }},
        {"renderer::position", [rendered_by] { return rendered_by->position(); }},
    };
}

} // namespace tactor::test
