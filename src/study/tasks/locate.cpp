// SPDX-License-Identifier: MIT
#include <cstddef>

#include "study/tasks/drawn.hpp"

namespace tactor::study {
namespace {

// Returns the mean of all points.
tactor::point find_middle(const std::vector<std::vector<tactor::point>>& strokes)
{
    tactor::point sum;
    std::size_t n = 0;
    for (const auto& points : strokes)
        for (const tactor::point& p : points) {
            sum.x_mm += p.x_mm;
            sum.y_mm += p.y_mm;
            ++n;
        }
    return {sum.x_mm / static_cast<double>(n), sum.y_mm / static_cast<double>(n)};
}

class shown_place final : public drawn_task {
public:
    shown_place()
        : drawn_task({.name = "locate",
                      .trial = "One stimulus; the participant shows where it was",
                      .response = "Place that the participant showed: 0, then x and y in mm as in the array",
                      .questions = {"Where was it?", "Where was it?", "Where was it?"},
                      .columns = {"target"},
                      .sections = {"has_places"}},
                     drawing_kind::place)
    {
    }

    // The target is the mean position of the motion over time.
    std::string format_target(const motion_definition& m) const override
    {
        return to_text(drawing{{0.0, find_middle(sample_strokes(m.strokes))}});
    }

    trial_answer simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        tactor::point felt = find_middle(who.felt_paths(t.motion, t.method_1));
        felt.x_mm += who.truth.sigma * r.normal();
        felt.y_mm += who.truth.sigma * r.normal();
        return drawing{{0.0, felt}};
    }
};

} // namespace

const task& locate_task()
{
    static const shown_place one;
    return one;
}

} // namespace tactor::study
