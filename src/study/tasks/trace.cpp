// SPDX-License-Identifier: MIT
#include <cstddef>

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

    // The observer draws the felt path in the time of the motion. The same noise moves all points of the
    // path.
    trial_answer simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        const double x_mm = who.truth.sigma * r.normal();
        const double y_mm = who.truth.sigma * r.normal();
        const std::vector<stroke>& own = who.definition.methods[t.method_1].strokes;
        drawing d = join_paths(who.felt_paths(t.motion, t.method_1),
                               own.empty() ? who.definition.motions[t.motion].strokes : own);
        for (drawn_point& p : d) {
            p.at.x_mm += x_mm;
            p.at.y_mm += y_mm;
        }
        return d;
    }
};

} // namespace

const task& trace_task()
{
    static const traced_path one;
    return one;
}

} // namespace tactor::study
