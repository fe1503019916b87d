// SPDX-License-Identifier: MIT
#include "study/experiment/variation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/marks.hpp"
#include "core/trajectory/impl.hpp"
#include "core/words.hpp"
#include "options/option.hpp"
#include "options/resolve.hpp"
#include "study/experiment/read_definition.hpp"
#include "study/tasks/task.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

using detail::toml_table;

// Returns the mean of the start and end points of all strokes.
point find_middle(const std::vector<stroke>& all)
{
    point sum;
    for (const stroke& s : all)
        for (const double t_s : {0.0, s.motion.duration_s()}) {
            sum.x_mm += s.motion.position(t_s).x_mm;
            sum.y_mm += s.motion.position(t_s).y_mm;
        }
    const double share = 0.5 / static_cast<double>(all.size());
    return {share * sum.x_mm, share * sum.y_mm};
}

// Returns the length of the first stroke (length_mm), or the distance between the starts of the first two
// strokes (apart_mm). Throws error (bad_input) if it is 0.
double find_extent_mm(const std::vector<stroke>& all, const std::string& parameter)
{
    const trajectory& first = all.front().motion;
    if (parameter == "length_mm") {
        if (!(first.length_mm() > 0.0))
            throw error(error_kind::bad_input, parameter, "the stroke is a single place",
                        "use a path with a length");
        return first.length_mm();
    }
    const double apart_mm =
        all.size() > 1 ? distance_mm(first.position(0.0), all[1].motion.position(0.0)) : 0.0;
    if (!(apart_mm > 0.0))
        throw error(error_kind::bad_input, parameter, "no two strokes start at different places",
                    "use a file with two strokes that start at different places");
    return apart_mm;
}

} // namespace

void make_variants(const toml_table& t, run_definition& r, const std::vector<method_definition>& methods,
                   std::vector<method_definition>& more)
{
    const run_outline& o = r.outline;
    const auto add = [&](method_definition m, std::size_t made_of) {
        m.made_of = made_of;
        more.push_back(std::move(m));
        return methods.size() + more.size() - 1;
    };
    const auto vary = [&](const method_definition& base, double value, std::string_view key) {
        method_definition m = base;
        m.value = value;
        m.where = t.where(key);
        if (const options::option* option = find_numeric_option(o.vary)) {
            try {
                options::give(m.options, *option, options::read_value(*option, value));
                options::resolve(m.options);
            } catch (const error& e) {
                const std::string cause =
                    options::find(e.field()) == option ? "" : detail::plain(e.subject()) + ": ";
                t.fail(
                    key,
                    fmt::format("{} = {} of method \"{}\": {}{}", o.vary, value, base.name, cause, e.why()),
                    reword_hint(e.hint()));
            }
        } else {
            m.vary = o.vary;
        }
        return m;
    };
    for (const std::size_t i : r.methods) {
        method_variants& v = r.variants[i];
        for (const double value : o.values)
            v.values.push_back(add(vary(methods[i], value, t.has("range") ? "range" : "values"), i));
        if (o.standard) {
            v.standard = add(vary(methods[i], *o.standard, "standard"), i);
            more.back().name = standard_name;
        }
        const auto silence = [&](method_definition m) {
            m.name = catch_name;
            m.silent = true;
            return add(std::move(m), i);
        };
        if (r.catch_share > 0.0)
            v.silent = silence(methods[i]);
        if (find_run_task(o).properties().has_silences)
            for (const std::size_t of : v.values)
                v.silences.push_back(silence(more[of - methods.size()]));
    }
}

void vary_strokes(std::vector<stroke>& all, const method_definition& m)
{
    if (m.vary.empty())
        return;
    const double v = *m.value;
    const point middle = find_middle(all);
    detail::affine map;
    if (m.vary == "rotate_deg") {
        map = detail::rotation(v);
    } else if (m.vary == "length_mm" || m.vary == "apart_mm") {
        const double scale = v / find_extent_mm(all, m.vary);
        map = {scale, 0.0, 0.0, scale, 0.0, 0.0};
    }
    map.e = middle.x_mm + (m.vary == "x_mm" ? v : 0.0);
    map.f = middle.y_mm + (m.vary == "y_mm" ? v : 0.0);
    for (stroke& s : all) {
        s.motion = detail::map_trajectory(s.motion, middle, map, {}, m.vary);
        if (s.speed_mm_s && s.motion.length_mm() > 0.0)
            s.motion = s.motion.with_speed(*s.speed_mm_s);
    }
}

} // namespace tactor::study
