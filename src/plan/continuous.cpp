// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "plan/job.hpp"

namespace tactor::detail {
namespace {

// Where the path leaves the array is looked for each continuous_step_s, but not oftener than this; a stroke
// of more than about a quarter of an hour is looked at in wider steps.
constexpr double most_checks = 1e6;

void check_inside(const job& j)
{
    const double end = j.motion.motion.duration_s();
    const double steps = std::min(std::max(std::ceil(end / continuous_step_s), 1.0), most_checks);
    follower target(j);
    for (double k = 0.0; k <= steps; ++k)
        target.at(end * (k / steps));
}

} // namespace

void plan_continuous(const job& j, plan& out)
{
    if (j.options.leave == outside::error)
        check_inside(j);
    out.total_s = out.stroke_duration_s;
    out.at = [motion = j.motion.motion, faces = j.faces, model = j.model](double t_s, burst& at) {
        const double t = t_s > 0.0 ? std::min(t_s, motion.duration_s()) : 0.0;
        const point p = motion.position(t);
        at.onset_s = t;
        at.duration_s = 0.0;
        at.tau_s.reset();
        at.position = faces.contains(p) ? p : faces.nearest(p);
        at.intensity = motion.intensity(t);
        drives_at(*model, faces, at.position, at.intensity, at.drives);
    };
}

} // namespace tactor::detail
