// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "core/access.hpp"
#include "core/path/impl.hpp"
#include "core/path/shape.hpp"
#include "core/trajectory/impl.hpp"
#include "core/trajectory/spans.hpp"
#include "plan/curve_impl.hpp"
#include "plan/faces/layout_impl.hpp"
#include "plan/faces/same_tactors.hpp"
#include "plan/job.hpp"

namespace tactor::detail {
namespace {

/// Finds the parameters, ascending, at which a curve is locally nearest to or farthest from the line of a
/// side of the hull. Skips sides that the curve cannot cross.
void find_hull_turns(const shape& form, const std::vector<hull_side>& sides, std::vector<double>& turns_at)
{
    turns_at.clear();
    const std::array<point, 4> frame = control_frame(form);
    for (const hull_side& s : sides) {
        const bool within =
            std::all_of(frame.begin(), frame.end(), [&](point p) { return dot(s.out, p) <= s.reach; });
        if (within)
            continue;
        const std::vector<double> t = find_turns_in_direction(form, s.out);
        turns_at.insert(turns_at.end(), t.begin(), t.end());
    }
    std::sort(turns_at.begin(), turns_at.end());
}

/// Checks that a movement stays in the array at all times. Looks only at the corners of the path, and at the
/// points of curves that find_hull_turns() finds. This is enough, because the hull is convex: between two
/// corners only a curve can leave the hull, and find_hull_turns() finds the points where the curve is
/// farthest out. \throws error (bad_input) that names the place where the path first leaves the array.
void check_inside(const job& j)
{
    const std::vector<hull_side> sides = hull_sides(detail::access::of(j.faces));
    std::vector<double> turns_at;
    follower target(j);
    target.at(0.0);
    double latest_s = 0.0;
    const auto look = [&](double t_s) {
        latest_s = std::max(latest_s, t_s); // rounding may put a turn past the end of the curve
        target.at(latest_s);
    };
    for_each_span(j.motion.motion, [&](const trajectory_span& span) {
        if (span.curve != nullptr) {
            find_hull_turns(*span.curve, sides, turns_at);
            for (const double t : turns_at)
                look(span.time_at(t));
        }
        look(span.to_s);
        return true;
    });
}

/// Returns the movement with places on the curves precomputed.
trajectory prepare(const trajectory& t)
{
    trajectory::impl made = access::of(t);
    if (auto* drawn = std::get_if<drawn_path>(&made.law))
        drawn->way = with_places(drawn->way, drawn->way.length_mm() / made.duration_s * continuous_step_s);
    return access::make<trajectory>(std::make_shared<const trajectory::impl>(std::move(made)));
}

/// Curve with the phantom along a stroke.
class followed final : public curve::impl {
public:
    explicit followed(const job& j)
        : impl(j.motion.motion.duration_s()),
          motion_(prepare(j.motion.motion)),
          faces_(j.faces),
          model_(j.model),
          three_(dynamic_cast<const model_of_three*>(model_.get())),
          scale_(j.options.scale)
    {
        if (scale_.kind != scale_kind::linear || scale_.level_db == 0.0)
            return;
        // Moves the level into the movement, so that bounding_motion() includes the level.
        motion_ = scale_intensity(motion_, scale_.amplitude(1.0));
        scale_.level_db = 0.0;
    }

    void fill(std::uint64_t k, same_tactors& seen, burst& out) const override
    {
        const double t_s = sample_time_s(k, duration_s);
        const point p = motion_.position(t_s);
        const double a_v = scale_.amplitude(motion_.intensity(t_s));
        out.intensity = a_v;
        if (seen.holds(p) && a_v > 0.0 && std::isfinite(a_v)) {
            out.position = p;
            compute_same_drives(*three_, faces_, seen, p, a_v, out.drives);
            return;
        }
        out.position = clamp_to_array(faces_, p);
        compute_drives(*model_, faces_, out.position, a_v, out.drives);
        if (three_ != nullptr)
            update_same_tactors(*three_, faces_, out.position, seen);
    }

    const trajectory* bounding_motion(std::size_t tactors) const noexcept override
    {
        return scale_.kind == scale_kind::linear && faces_.places().size() <= tactors ? &motion_ : nullptr;
    }

private:
    trajectory motion_;
    layout faces_;
    std::shared_ptr<const phantom_model> model_;
    const model_of_three* three_; ///< model_, or null if it does not use three tactors
    intensity_scale scale_;
};

// Calls the user's model once for each sample, and stores the results, so that the plan is a value.
curve sample_model(const job& j)
{
    const followed f(j);
    if (static_cast<double>(f.size) > most_bursts)
        throw error(error_kind::bad_input, j.name(),
                    fmt::format("it needs {:.3g} samples of phantom model \"{}\"",
                                static_cast<double>(f.size), j.model->name()),
                    fmt::format("make the stroke shorter: at most {:.0f} samples, one each {} s", most_bursts,
                                continuous_step_s));
    curve_samples all;
    burst b;
    same_tactors seen;
    for (std::uint64_t k = 0; k < f.size; ++k) {
        f.fill(k, seen, b);
        all.add(b);
    }
    all.drives.shrink_to_fit();
    return {f.duration_s, std::move(all)};
}

} // namespace

void plan_continuous(const job& j, plan& out)
{
    if (j.options.outside == outside_kind::error)
        check_inside(j);
    out.total_s = out.stroke_duration_s;
    out.curve =
        j.options.custom_phantom ? sample_model(j) : curve_access::make(std::make_shared<followed>(j));
}

} // namespace tactor::detail
