// SPDX-License-Identifier: MIT
#include "plan/continuous.hpp"

#include <algorithm>

#include "plan/job.hpp"
#include "plan/leaving.hpp"

namespace tactor::detail {

void plan_continuous(const job& j, plan& out)
{
    if (j.options.leave == outside::error)
        check_inside(j);
    out.total_s = out.stroke_duration_s;
    out.at = continuous_at{j.motion.motion, j.faces, j.model, j.options.custom_phantom == nullptr};
}

void continuous_at::operator()(double t_s, burst& at) const
{
    const double t = t_s > 0.0 ? std::min(t_s, motion.duration_s()) : 0.0;
    const point p = motion.position(t);
    at.onset_s = t;
    at.duration_s = 0.0;
    at.tau_s.reset();
    at.position = faces.contains(p) ? p : faces.nearest(p);
    at.intensity = motion.intensity(t);
    drives_at(*model, faces, at.position, at.intensity, at.drives);
}

} // namespace tactor::detail
