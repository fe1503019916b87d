// SPDX-License-Identifier: MIT
#include "plan/job.hpp"

#include <algorithm>
#include <optional>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "core/words.hpp"
#include "plan/rounded.hpp"

namespace tactor::detail {

point follower::at(double t_s)
{
    const point p = job_.motion.motion.position(t_s);
    if (job_.faces.contains(p)) {
        inside_s_ = t_s;
        return p;
    }
    const point edge = job_.faces.nearest(p);
    if (job_.options.outside == outside_kind::error && distance_mm(p, edge) > edge_tolerance_mm)
        refuse(t_s);
    return edge;
}

double follower::farthest_outside_mm(double from_s) const
{
    constexpr int samples = 2000;
    const trajectory& motion = job_.motion.motion;
    double farthest = 0.0;
    for (int i = 0; i <= samples; ++i) {
        const point p = motion.position(from_s + (motion.duration_s() - from_s) * i / samples);
        farthest = std::max(farthest, distance_mm(p, job_.faces.nearest(p)));
    }
    return farthest;
}

void follower::refuse(double t_s) const
{
    const trajectory& motion = job_.motion.motion;
    const std::string& made_for = job_.motion.made_for;
    const std::string hint =
        (made_for.empty() ? "" : fmt::format("{{array={}| is the one it is drawn for, }}", made_for)) +
        "{fit=true| scales it to the array, }{outside=clamp} plays the nearest point of the array";
    if (inside_s_ < 0.0)
        throw error(error_kind::bad_input, job_.name(),
                    fmt::format("starts outside the array, at {}, and goes {} mm outside",
                                place(motion.position(t_s)), plain_number(farthest_outside_mm(t_s), 3)),
                    hint);
    double in = inside_s_;
    double out = t_s;
    // Until no double is left between, which is well within a micrometre.
    for (double middle = in + (out - in) / 2.0; in < middle && middle < out; middle = in + (out - in) / 2.0)
        (job_.faces.contains(motion.position(middle)) ? in : out) = middle;
    throw error(error_kind::bad_input, job_.name(),
                fmt::format("leaves the array at {} after {}, and goes {} mm outside",
                            place(motion.position(in)), seconds_text(in),
                            plain_number(farthest_outside_mm(out), 3)),
                hint);
}

std::vector<conflict> find_conflicts(const std::vector<burst>& bursts)
{
    std::vector<conflict> found;
    struct state {
        double sounds_until_s;
        std::ptrdiff_t last = -1; // place in `found`
    };
    std::vector<std::optional<state>> tactors;
    for (const burst& b : bursts)
        for (const drive& d : b.drives) {
            const double end = b.onset_s + b.duration_s;
            if (d.tactor >= tactors.size())
                tactors.resize(d.tactor + std::size_t{1});
            std::optional<state>& known = tactors[d.tactor];
            if (!known) {
                known = state{end};
                continue;
            }
            state& s = *known;
            const double until = std::min(end, s.sounds_until_s);
            if (until - b.onset_s > same_time_s) {
                if (s.last >= 0 && b.onset_s <= found[static_cast<std::size_t>(s.last)].to_s + same_time_s) {
                    double& to = found[static_cast<std::size_t>(s.last)].to_s;
                    to = std::max(to, until);
                } else {
                    s.last = static_cast<std::ptrdiff_t>(found.size());
                    found.push_back({d.tactor, b.onset_s, until});
                }
            }
            s.sounds_until_s = std::max(s.sounds_until_s, end);
        }
    std::sort(found.begin(), found.end(), [](const conflict& a, const conflict& b) {
        return std::tie(a.from_s, a.tactor) < std::tie(b.from_s, b.tactor);
    });
    return found;
}

} // namespace tactor::detail
