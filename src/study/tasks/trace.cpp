// SPDX-License-Identifier: MIT
#include <algorithm>

#include "study/tasks/drawn.hpp"

namespace tactor::study {
namespace {

class traced_path final : public drawn_task {
public:
    traced_path()
        : drawn_task({.name = "trace",
                      .trial = "One stimulus; the participant draws how it moved",
                      .response = "Points that the participant drew, with ; between them: time in s since "
                                  "the first point, then x and y in mm as in the array",
                      .questions = {"Draw how it moved.", "Draw how it moved.", "Draw how it moved."},
                      .columns = {"target"},
                      .sections = {"has_paths"}},
                     drawing_kind::path)
    {
    }

    std::string format_target(const motion_definition& m) const override
    {
        return to_text(join_paths(sample_strokes(m.strokes), m.strokes));
    }

    // The observer draws the felt path in the time of the motion. Independent noise moves the start, the
    // middle and the end. A parabola over time moves the points between them, so the drawing is also turned,
    // stretched and bent. Rounds as the tables do, so that --power has the same figures as an analysis.
    trial_answer simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        const auto draw_noise = [&] {
            const double x_mm = who.truth.sigma * r.normal();
            return point{x_mm, who.truth.sigma * r.normal()};
        };
        const point start = draw_noise();
        const point middle = draw_noise();
        const point end = draw_noise();
        const std::vector<stroke>& own = who.definition.methods[t.method_1].strokes;
        drawing d = join_paths(who.felt_paths(t.motion, t.method_1),
                               own.empty() ? who.definition.motions[t.motion].strokes : own);
        for (drawn_point& p : d) {
            const double s = p.time_s / d.back().time_s; // share of the time
            const double of_start = (1.0 - s) * (1.0 - 2.0 * s);
            const double of_middle = 4.0 * s * (1.0 - s);
            const double of_end = s * (2.0 * s - 1.0);
            const auto move = [&](double& at, double point::*axis) {
                at += of_start * start.*axis + of_middle * middle.*axis + of_end * end.*axis;
                at = std::clamp(at, -farthest_drawn_mm, farthest_drawn_mm);
            };
            move(p.at.x_mm, &point::x_mm);
            move(p.at.y_mm, &point::y_mm);
        }
        return read_drawing(to_text(d)).value();
    }
};

} // namespace

const task& trace_task()
{
    static const traced_path one;
    return one;
}

} // namespace tactor::study
