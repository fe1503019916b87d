// SPDX-License-Identifier: MIT
#include "server/planning_work.hpp"

#include <algorithm>

#include <tactor/plan.hpp>

namespace tactor::server {
namespace {

constexpr double moving = 4.0;           // time of a burst that `compensate` moves, against another
constexpr double tactors_a_step = 128.0; // that a phantom model looks at in the time of a step
constexpr double crossings = 4.0;        // of a grid's lines in one pitch of a path, at most
constexpr double least_soa_s = 0.0001;
constexpr double least_pitch_mm = 1.0;

double park_bursts(const stroke& k, const plan_options& o)
{
    const double soa_s = k.choices.soa_s.value_or(o.soa_s);
    const bool is_free = k.choices.burst_s || o.burst_s;
    const bool is_possible = is_free ? soa_s >= least_soa_s : soa_s > o.profile.intercept_s;
    return is_possible ? 1.0 + k.motion.duration_s() / soa_s : 0.0;
}

} // namespace

planning_work estimate_work(const std::vector<stroke>& strokes, const options::wishes& s, const layout& faces)
{
    planning_work w;
    for (const stroke& k : strokes) {
        switch (k.choices.algorithm.value_or(s.plan.algorithm)) {
        case algorithm_kind::park2016:
            w.bursts += park_bursts(k, s.plan);
            break;
        case algorithm_kind::tactile_brush:
            w.bursts += 1.0 + crossings * k.motion.length_mm() / std::max(faces.pitch_mm(), least_pitch_mm);
            break;
        case algorithm_kind::continuous:
            w.samples += 1.0 + k.motion.duration_s() / continuous_step_s;
            break;
        }
    }
    const double wide = 1.0 + static_cast<double>(faces.places().size()) / tactors_a_step;
    w.steps = (w.samples + w.bursts * (s.compensate ? moving : 1.0)) * wide;
    return w;
}

} // namespace tactor::server
