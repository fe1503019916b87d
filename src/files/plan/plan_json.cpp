// SPDX-License-Identifier: MIT
#include "files/plan/plan_json.hpp"

#include <algorithm>
#include <cstdint>

#include "files/json/schema.hpp"
#include "files/json/writer.hpp"
#include "files/plan/plan_members.hpp"

namespace tactor::files {
namespace {

/// Members of plan_parts, of a plan that is written.
struct written_plan {
    const std::string& name;
    note_kind note;
    double start_s;
    bool follows; ///< the stroke before it, from the frame at which that ends
    const tactor::plan& plan;
    plan_sound sound;
    const std::optional<fitting>& fit;
    const array& tactors;
    const render_options& options;
    const compensated_plan* moved; ///< null without compensation
    bool is_sampled;
    double step_s;
    std::uint64_t start_frame;
    std::uint64_t frames;
};

} // namespace

std::vector<double> piece::starts_s() const
{
    return start_times_s(plans);
}

double piece::total_s() const
{
    double end = 0.0;
    const std::vector<double> starts = starts_s();
    for (std::size_t i = 0; i < plans.size(); ++i)
        end = std::max(end, starts[i] + plans[i].plan.total_s);
    return end;
}

void write_plans(const plan_record& r, const text_sink& out)
{
    const auto starts = r.made.starts_s();
    const auto write = [&](std::size_t i) {
        std::string text;
        text += '{';
        const plan& p = r.made.plans[i].plan;
        const written_plan parts{r.made.strokes[i].name,
                                 r.made.strokes[i].note,
                                 starts[i],
                                 !r.made.plans[i].start_s,
                                 p,
                                 record_sound(p),
                                 r.made.fit,
                                 r.tactors,
                                 r.options,
                                 r.made.moved.empty() ? nullptr : &r.made.moved[i],
                                 p.curve.has_value(),
                                 continuous_step_s,
                                 r.samples.starts()[i],
                                 r.samples.frames()};
        json_writer io(text, &out);
        plan_members(io, parts);
        out(text + '}');
    };
    if (r.made.plans.size() == 1) {
        write(0);
        out("\n");
        return;
    }
    out("{\"schema\":\"tactor-plans/1\",\"plans\":[\n");
    for (std::size_t i = 0; i < r.made.plans.size(); ++i) {
        write(i);
        out(i + 1 < r.made.plans.size() ? ",\n" : "\n");
    }
    out("]}\n");
}

std::string plans_text(const plan_record& r)
{
    std::string text;
    write_plans(r, [&text](std::string_view part) { text += part; });
    return text;
}

nlohmann::ordered_json plan_schema()
{
    plan_parts parts;
    return json_schema::describe_object([&parts](auto& io) { plan_members(io, parts); });
}

} // namespace tactor::files
