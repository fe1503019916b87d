// SPDX-License-Identifier: MIT
#include <cstddef>

#include "study/experiment/simulated.hpp"
#include "study/tasks/drawn.hpp"

namespace tactor::study {
namespace {

// Number of points of a target, and of a simulated drawing, for each stroke.
constexpr std::size_t stroke_points = 50;

class traced_path final : public drawn_task {
public:
    traced_path()
        : drawn_task({.name = "trace",
                      .trial = "One stimulus; the participant draws how it moved",
                      .response = "Points that the participant drew, with ; between them: time in s since "
                                  "the first point, then x and y in mm as in the array",
                      .questions = {"Draw how it moved.", "Draw how it moved.", "Draw how it moved."},
                      .column = "target"},
                     drawing_kind::path)
    {
    }

    // Strokes follow each other in the order of the motion.
    std::string write_target(const motion_definition& m) const override
    {
        drawing d;
        double from_s = 0.0;
        for (const stroke& s : m.strokes) {
            for (std::size_t i = 0; i <= stroke_points; ++i) {
                const double t_s = s.motion.duration_s() * static_cast<double>(i) / stroke_points;
                d.push_back({from_s + t_s, s.motion.position(t_s)});
            }
            from_s += s.motion.duration_s();
        }
        return to_text(d);
    }

    // The observer draws the felt path in the motion's time, all of it moved by the same noise.
    trial_answer simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        const double x_mm = who.truth.sigma * r.normal();
        const double y_mm = who.truth.sigma * r.normal();
        const std::vector<stroke>& strokes = who.definition.motions[t.motion].strokes;
        drawing d;
        double from_s = 0.0;
        const auto& felt = who.felt_paths(t.motion, t.method_1);
        for (std::size_t s = 0; s < felt.size(); ++s) {
            const double lasts_s = strokes[s % strokes.size()].motion.duration_s();
            for (std::size_t i = 0; i < felt[s].size(); i += path_parts / stroke_points)
                d.push_back({from_s + lasts_s * static_cast<double>(i) / path_parts,
                             {felt[s][i].x_mm + x_mm, felt[s][i].y_mm + y_mm}});
            from_s += lasts_s;
        }
        return d;
    }

    std::vector<std::string_view> list_sections(const run_outline&) const override { return {"has_paths"}; }
};

} // namespace

const task& trace_task()
{
    static const traced_path one;
    return one;
}

} // namespace tactor::study
