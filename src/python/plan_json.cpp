// SPDX-License-Identifier: MIT
// Plans as JSON and back.
#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "core/words.hpp"
#include "files/plan/plan_file.hpp"
#include "files/plan/plan_json.hpp"
#include "python/plan_handle.hpp"

namespace tactor::python {
namespace {

constexpr const char* plan_itself = "plan";

} // namespace

render_options settled(const array& a, render_options o)
{
    const unsigned marker = o.marker_channel ? *o.marker_channel + 1 : 0;
    if (o.channels == 0)
        o.channels = std::max(a.channels(), marker);
    return o;
}

std::string json_of(const plan_handle& p)
{
    const without_lock free;
    const array& tactors = p.on->value();
    const render_options sound = settled(tactors, p.sound);
    const score samples(tactors, std::vector{p.placed}, sound);
    const std::span<const compensated_plan> moved(p.moved ? &*p.moved : nullptr, p.moved ? 1 : 0);
    return files::plans_text(
        {{&p.drawn, 1}, {&p.placed, 1}, moved, p.fit ? &*p.fit : nullptr, tactors, samples, sound});
}

plan_handle plan_from_json(const std::string& text, const std::string& named)
{
    const without_lock free;
    files::plan_file f = files::read_plans(text, named);
    if (f.plans.size() != 1)
        throw error(error_kind::bad_input, named, "there are " + counted(f.plans.size(), "plan") + " in it",
                    "take one of its \"plans\"");
    plan_handle p{std::make_shared<array_handle>(std::move(f.tactors)), std::move(f.strokes.front()),
                  std::move(f.plans.front()), f.fit};
    if (!f.moved.empty())
        p.moved = std::move(f.moved.front());
    p.sound = f.render;
    return p;
}

void check_same_array(const plan_handle& p, const array& in_use)
{
    files::check_same_array(plan_itself, p.on->value(), in_use);
}

} // namespace tactor::python
