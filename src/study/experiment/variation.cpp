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

#include "core/trajectory/impl.hpp"
#include "core/words.hpp"
#include "options/option.hpp"
#include "options/resolve.hpp"
#include "study/experiment/trials.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

using detail::toml_table;

/// Parameters of a stroke that a run may vary. Other names are options.
constexpr std::array<std::pair<std::string_view, detail::bounds>, 4> stroke_parameters{{
    {"x_mm", {-detail::max_mm, detail::max_mm}},
    {"y_mm", {-detail::max_mm, detail::max_mm}},
    {"length_mm", {0.0, detail::max_mm, true}},
    {"rotate_deg", detail::turn_deg},
}};

const detail::bounds* find_parameter(std::string_view name)
{
    const auto* at =
        std::ranges::find(stroke_parameters, name, &decltype(stroke_parameters)::value_type::first);
    return at == stroke_parameters.end() ? nullptr : &at->second;
}

// Finds a numeric option of a method; null for other names.
const options::option* find_number(std::string_view name)
{
    const options::option* o = options::find(name);
    const bool is_number =
        o != nullptr && (o->what == options::kind::number || o->what == options::kind::whole);
    return is_number && (o->where & options::in_method) != 0 ? o : nullptr;
}

} // namespace

std::optional<varied> find_varied(std::string_view name)
{
    const options::option* option = find_number(name);
    if (option != nullptr)
        return varied{option->allowed, option->unit.starts_with("dB")};
    const detail::bounds* parameter = find_parameter(name);
    return parameter != nullptr ? std::optional(varied{*parameter, false}) : std::nullopt;
}

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
        if (const options::option* option = find_number(o.vary)) {
            try {
                options::give(m.options, *option, options::read_value(*option, value));
                options::resolve(m.options);
            } catch (const error& e) {
                t.fail(key, fmt::format("{} = {} of method \"{}\": {}", o.vary, value, base.name, e.why()),
                       spell_for_definition(e.hint()));
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
        if (r.catch_share > 0.0) {
            v.silent = add(methods[i], i);
            more.back().name = catch_name;
            more.back().silent = true;
        }
    }
}

stroke vary_stroke(stroke s, const method_definition& m)
{
    if (m.vary.empty())
        return s;
    const double v = *m.value;
    const point from = s.motion.position(0.0);
    const point to = s.motion.position(s.motion.duration_s());
    const point middle{0.5 * (from.x_mm + to.x_mm), 0.5 * (from.y_mm + to.y_mm)};
    detail::affine map;
    if (m.vary == "rotate_deg") {
        map = detail::rotation(v);
    } else if (m.vary == "length_mm") {
        if (!(s.motion.length_mm() > 0.0))
            throw error(error_kind::bad_input, "length_mm", "the stroke is a single place",
                        "use a path with a length");
        const double scale = v / s.motion.length_mm();
        map = {scale, 0.0, 0.0, scale, 0.0, 0.0};
    }
    map.e = middle.x_mm + (m.vary == "x_mm" ? v : 0.0);
    map.f = middle.y_mm + (m.vary == "y_mm" ? v : 0.0);
    s.motion = detail::moved(s.motion, middle, map, {}, m.vary);
    if (s.speed_mm_s && s.motion.length_mm() > 0.0)
        s.motion = s.motion.with_speed(*s.speed_mm_s);
    return s;
}

void set_value(planned_trial& t, const run_definition& r, std::size_t place)
{
    for (const auto& [method, v] : r.variants) {
        if (std::ranges::count(v.values, t.method_1) != 0)
            t.method_1 = v.values[place];
        else if (t.method_2 && std::ranges::count(v.values, *t.method_2) != 0)
            t.method_2 = v.values[place];
        else
            continue;
        return;
    }
}

std::optional<double> find_value(const experiment_definition& d, const planned_trial& t)
{
    const bool standard_first = t.method_2 && d.methods[t.method_1].name == standard_name;
    return d.methods[standard_first ? *t.method_2 : t.method_1].value;
}

} // namespace tactor::study
