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
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

using detail::toml_table;

constexpr std::size_t most_values = 401;
constexpr unsigned most_tracks = 8;
constexpr double range_steps = 40.0; ///< of an adaptive run, in its range

/// Parameters of a stroke that a run may vary; others are options.
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

// Returns an option with a number that a method may have; null for none.
const options::option* find_number(std::string_view name)
{
    const options::option* o = options::find(name);
    const bool is_number =
        o != nullptr && (o->what == options::kind::number || o->what == options::kind::whole);
    return is_number && (o->where & options::in_method) != 0 ? o : nullptr;
}

std::vector<double> read_numbers(const toml_table& t, std::string_view key, const detail::bounds& b)
{
    std::vector<double> all;
    if (const toml::array* list = t.list(key, "numbers"))
        for (const toml::node& n : *list)
            all.push_back(t.to_number(n, key, b));
    return all;
}

// Reads numbers, or one of them.
std::vector<double> read_one_or_more(const toml_table& t, std::string_view key, const detail::bounds& b)
{
    const toml::node* n = t.node(key);
    return n != nullptr && !n->is_array() ? std::vector{*t.number(key, b)} : read_numbers(t, key, b);
}

// Reads two ends, between which `count` numbers come, or a list of other length.
std::vector<double> read_prior(const toml_table& t, std::string_view key, const detail::bounds& b,
                               std::vector<double> usual, std::size_t count, bool by_ratio)
{
    std::vector<double> all = t.has(key) ? read_one_or_more(t, key, b) : std::move(usual);
    if (all.empty())
        t.fail(key, fmt::format("{} is empty", key), "give numbers in brackets");
    if (all.size() != 2)
        return all;
    const double low = all[0];
    const double high = all[1];
    all.clear();
    for (std::size_t i = 0; i < count; ++i) {
        const double part = static_cast<double>(i) / static_cast<double>(count - 1);
        all.push_back(by_ratio ? low * std::pow(high / low, part) : low + (high - low) * part);
    }
    return all;
}

// Returns a number without the last digits, which a sum of steps leaves.
double tidy(double v)
{
    constexpr double digits = 1e9;
    return std::round(v * digits) / digits;
}

std::size_t find_nearest(const std::vector<double>& values, double v)
{
    const auto at = std::ranges::min_element(values, {}, [v](double one) { return std::abs(one - v); });
    return static_cast<std::size_t>(at - values.begin());
}

// Sets the steps of a staircase, as multiples of the least.
void set_steps(const toml_table& t, adaptive_options& a, const std::vector<double>& steps, double step)
{
    if (steps.empty())
        a.steps = {4, 2, 1};
    for (const double s : steps) {
        a.steps.push_back(static_cast<std::size_t>(std::llround(s / step)));
        if (std::abs(static_cast<double>(a.steps.back()) * step - s) > 1e-6 * step)
            t.fail("steps", fmt::format("{} is not a multiple of the smallest step, {}", s, step),
                   "give multiples, such as [4, 2, 1]");
    }
}

// Reads the procedure of an adaptive run. Its values are a grid over the range.
void read_procedure(const toml_table& t, run_definition& r, const detail::bounds& b)
{
    constexpr std::array<std::string_view, 4> names{"quest", "1up1down", "1up2down", "1up3down"};
    run_outline& o = r.outline;
    adaptive_options& a = r.adaptive;
    const std::string name = t.need(t.choice("procedure", {names.begin(), names.end()}), "procedure");
    a.down = static_cast<unsigned>(std::ranges::find(names, name) - names.begin());
    for (const auto& [key, of_quest] : {std::pair("steps", false), {"slope", true}, {"lapse", true}})
        if (t.has(key) && of_quest != (a.down == 0))
            t.fail(key, fmt::format("{} does not apply to procedure \"{}\"", key, name), "leave it out");
    const std::vector<double> range = read_numbers(t, "range", b);
    if (range.size() != 2 || !(range[0] < range[1]))
        t.fail(t.has("range") ? "range" : "procedure", "an adaptive run needs the range of its values",
               "add range = [LEAST, GREATEST]");
    const double width = range[1] - range[0];
    const std::vector<double> steps = read_numbers(t, "steps", {0.0, width, true});
    const double step = !steps.empty() ? *std::ranges::min_element(steps)
                        : o.on_db_axis ? 1.0
                                       : width / range_steps;
    const auto count = static_cast<std::size_t>(std::floor(width / step + 1e-6)) + 1;
    if (count > most_values)
        t.fail(t.has("steps") ? "steps" : "range", fmt::format("the range has {} steps", count),
               fmt::format("use at most {}", most_values));
    for (std::size_t i = 0; i < count; ++i)
        o.values.push_back(tidy(range[0] + step * static_cast<double>(i)));
    set_steps(t, a, steps, step);
    // A staircase that needs several answers for a step stays on one side of the pse: the fit would place it
    // there, and find a jnd that is too small.
    const bool one_sided = a.down > 1;
    a.tracks = t.whole("tracks", 1, most_tracks).value_or(one_sided ? 2 : 1);
    if (one_sided && a.tracks % 2 != 0)
        t.fail("tracks",
               fmt::format("{} of procedure \"{}\" would test one side of the pse more than the other",
                           counted(a.tracks, "track"), name),
               "use an even number: every second track is mirrored");
    const std::vector<double> start = read_one_or_more(t, "start", {range[0], range[1]});
    if (start.size() > 1 && start.size() != a.tracks)
        t.fail("start", fmt::format("start has {} values", start.size()), "give one, or one for each track");
    for (unsigned i = 0; i < a.tracks; ++i) // from both ends in turn
        a.start.push_back(find_nearest(o.values, start.empty()       ? range[i % 2 == 0 ? 1 : 0]
                                                 : start.size() == 1 ? start[0]
                                                                     : start[i]));
    a.slopes =
        read_prior(t, "slope", {0.0, detail::max_mm, true}, {width / range_steps, width / 2.0}, 5, true);
    a.lapses = read_prior(t, "lapse", {0.0, 0.5}, {0.0, 0.04}, 3, false);
}

void read_values(const toml_table& t, run_outline& o, const detail::bounds& b)
{
    o.values = read_numbers(t, "values", b);
    if (o.values.size() < 2 || o.values.size() > most_values)
        t.fail(t.has("values") ? "values" : "vary", fmt::format("there are {} values", o.values.size()),
               fmt::format("give 2 to {}: values = [..]", most_values));
    std::ranges::sort(o.values);
    if (std::ranges::adjacent_find(o.values) != o.values.end())
        t.fail("values", "a value occurs twice", "leave one of them out");
}

} // namespace

void read_variation(const toml_table& t, run_definition& r)
{
    run_outline& o = r.outline;
    const bool is_adaptive = o.task == task_kind::adaptive;
    for (const char* key : {"procedure", "start", "steps", "range", "tracks", "slope", "lapse"})
        if (!is_adaptive && t.has(key))
            t.fail(key, fmt::format("{} only applies to adaptive runs", key),
                   "leave it out, or set task = \"adaptive\"");
    if (t.has("catch") && o.task != task_kind::detect)
        t.fail("catch", "catch only applies to runs that detect", "leave it out, or set task = \"detect\"");
    r.catch_share = t.number("catch", {0.0, 0.9}).value_or(0.0);
    o.catches = r.catch_share > 0.0;
    const bool varies = find_task(o.task).about().varies || (o.task == task_kind::detect && t.has("vary"));
    for (const char* key : {"vary", "values", "standard", "trials_per_value"})
        if (t.has(key) && (!varies || (std::string_view(key) == "standard" && o.task == task_kind::detect)))
            t.fail(key, fmt::format("{} does not apply to runs with task \"{}\"", key, to_string(o.task)),
                   "leave it out");
    if (!varies)
        return;
    o.vary = t.need(t.text("vary"), "vary");
    const options::option* option = find_number(o.vary);
    const detail::bounds* parameter = find_parameter(o.vary);
    if (option == nullptr && parameter == nullptr)
        t.fail("vary", fmt::format("\"{}\" is not a number that a run can vary", o.vary),
               "use an option of [[method]] such as level_dbfs, speed_mm_s or soa_s, or x_mm, y_mm, "
               "length_mm or rotate_deg of the stroke");
    const detail::bounds allowed = option != nullptr ? option->allowed : *parameter;
    o.on_db_axis = option != nullptr && option->unit.starts_with("dB");
    o.standard = t.number("standard", allowed);
    if (is_adaptive) {
        if (t.has("values"))
            t.fail("values", "an adaptive run chooses its values", "use range = [LEAST, GREATEST]");
        read_procedure(t, r, allowed);
    } else {
        read_values(t, o, allowed);
    }
    if (o.task == task_kind::estimate && !o.on_db_axis && o.values.front() <= 0.0)
        t.fail("values", "an exponent needs values above 0", "leave the others out");
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
            v.values.push_back(
                add(vary(methods[i], value, r.outline.task == task_kind::adaptive ? "range" : "values"), i));
        if (o.standard) {
            v.standard = add(vary(methods[i], *o.standard, "standard"), i);
            more.back().name = standard_name;
        }
        if (o.catches) {
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

} // namespace tactor::study
