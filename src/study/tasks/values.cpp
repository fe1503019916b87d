// SPDX-License-Identifier: MIT
#include "study/tasks/values.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/error.hpp>

#include "core/words.hpp"
#include "study/data/text_table.hpp"
#include "study/statistics/psychometric_fit.hpp"

namespace tactor::study {
namespace {

using detail::toml_table;

constexpr unsigned most_trials = 10000;

} // namespace

const options::option* find_numeric_option(std::string_view name)
{
    const options::option* o = options::find(name);
    const bool is_number =
        o != nullptr && (o->what == options::kind::number || o->what == options::kind::whole);
    return is_number && (o->where & options::in_method) != 0 ? o : nullptr;
}

namespace {

// Greatest number of values of a run.
inline constexpr std::size_t most_values = 401;

// A number that a run may vary.
struct varied {
    detail::bounds allowed;
    bool on_db_axis = false; ///< true for a level in dB
};

// Parameters of a stroke that a run may vary. Other names are options.
constexpr std::array<std::pair<std::string_view, detail::bounds>, 5> stroke_parameters{{
    {"x_mm", {-detail::max_mm, detail::max_mm}},
    {"y_mm", {-detail::max_mm, detail::max_mm}},
    {"length_mm", {0.0, detail::max_mm, true}},
    {"apart_mm", {0.0, detail::max_mm, true}},
    {"rotate_deg", detail::turn_deg},
}};

// Finds a numeric option of a method or a parameter of a stroke by its name. Returns nothing for other
// names.
std::optional<varied> find_varied(std::string_view name)
{
    const options::option* option = find_numeric_option(name);
    if (option != nullptr)
        return varied{option->allowed, option->unit.starts_with("dB")};
    const auto* at =
        std::ranges::find(stroke_parameters, name, &decltype(stroke_parameters)::value_type::first);
    return at != stroke_parameters.end() ? std::optional(varied{at->second, false}) : std::nullopt;
}

} // namespace

void read_trials(const toml_table& t, run_outline& o)
{
    o.trials = t.whole("trials", 1, most_trials).value_or(0);
    const auto each = t.whole("trials_per_value", 1, most_trials);
    if (!each)
        return;
    const std::size_t all = *each * o.values.size() * o.motions.size() * o.methods.size();
    if (t.has("trials"))
        t.fail("trials_per_value", fmt::format("{} has both trials and trials_per_value", t.title()),
               "keep one of them");
    if (all == 0 || o.catches || all > most_trials)
        t.fail("trials_per_value", fmt::format("trials_per_value gives {} trials in all", all),
               all > most_trials ? fmt::format("use trials instead, at most {}", most_trials)
                                 : "use trials instead");
    o.trials = static_cast<unsigned>(all);
}

detail::bounds read_vary(const toml_table& t, run_outline& o)
{
    o.vary = t.need(t.text("vary"), "vary");
    const std::optional<varied> v = find_varied(o.vary);
    if (!v)
        t.fail("vary", fmt::format("a run cannot vary \"{}\"", o.vary),
               "use an option of [[method]] such as level_dbfs, speed_mm_s or soa_s, or x_mm, y_mm, "
               "length_mm, apart_mm or rotate_deg of the stroke");
    o.on_db_axis = v->on_db_axis;
    o.standard = t.number("standard", v->allowed);
    if (o.standard)
        refuse_method_name(t, o, standard_name);
    return v->allowed;
}

std::vector<double> read_numbers(const toml_table& t, std::string_view key, const detail::bounds& b)
{
    std::vector<double> all;
    if (const toml::array* list = t.list(key, "numbers"))
        for (const toml::node& one : *list)
            all.push_back(t.to_number(one, key, b));
    return all;
}

std::vector<double> read_number_or_list(const toml_table& t, std::string_view key, const detail::bounds& b)
{
    const toml::node* n = t.node(key);
    return n != nullptr && !n->is_array() ? std::vector{*t.number(key, b)} : read_numbers(t, key, b);
}

void read_values(const toml_table& t, run_outline& o, const detail::bounds& b)
{
    o.values = read_numbers(t, "values", b);
    if (o.values.size() < 2 || o.values.size() > most_values)
        t.fail(t.has("values") ? "values" : "vary",
               fmt::format("values has {}", counted(o.values.size(), "number")),
               fmt::format("give 2 to {} numbers: values = [...]", most_values));
    std::ranges::sort(o.values);
    if (std::ranges::adjacent_find(o.values) != o.values.end())
        t.fail("values", "a value occurs twice", "give each value once");
}

value_grid read_grid(const toml_table& t, run_outline& o, const detail::bounds& b, std::string_view own)
{
    constexpr double parts = 40.0;
    constexpr double digits = 1e9; // rounds to nine decimals, which removes the error of a sum of steps
    const std::vector<double> range = read_numbers(t, "range", b);
    if (range.size() == 2 && !(range[0] < range[1]))
        t.fail("range", fmt::format("{} is not below {}", range[0], range[1]),
               "give the lowest value, then the highest");
    if (range.size() != 2)
        t.fail(t.has("range") ? "range" : own, "the run needs the range of its values",
               "add range = [LEAST, GREATEST]");
    const double width = range[1] - range[0];
    const std::vector<double> steps = read_numbers(t, "steps", {0.0, width, true});
    value_grid g{range[0], range[1],
                 !steps.empty() ? *std::ranges::min_element(steps)
                 : o.on_db_axis ? 1.0
                                : width / parts};
    const auto count = static_cast<std::size_t>(std::floor(width / g.step + 1e-6)) + 1;
    if (count > most_values)
        t.fail(t.has("steps") ? "steps" : "range", fmt::format("the range has {} steps", count),
               fmt::format("use at most {}", most_values));
    for (std::size_t i = 0; i < count; ++i)
        o.values.push_back(std::round((g.least + g.step * static_cast<double>(i)) * digits) / digits);
    for (const double s : steps) {
        g.sizes.push_back(static_cast<std::size_t>(std::llround(s / g.step)));
        if (std::abs(static_cast<double>(g.sizes.back()) * g.step - s) > 1e-6 * g.step)
            t.fail("steps", fmt::format("{} is not a multiple of the smallest step, {}", s, g.step),
                   "give multiples, such as [4, 2, 1]");
    }
    return g;
}

std::size_t find_nearest(const std::vector<double>& values, double v)
{
    const auto at = std::ranges::min_element(values, {}, [v](double one) { return std::abs(one - v); });
    return static_cast<std::size_t>(at - values.begin());
}

void refuse_method_blocks(const toml_table& t, const run_outline& o)
{
    if (t.text("blocks") == "methods")
        t.fail("blocks", fmt::format("run \"{}\" has two methods in each trial", o.name),
               "use blocks = \"motions\", or leave out blocks");
}

void refuse_method_name(const toml_table& t, const run_outline& o, std::string_view name)
{
    if (std::ranges::count(o.methods, name) != 0)
        t.fail(fmt::format("a method of run \"{}\" is called \"{}\"", o.name, name),
               "use another name: the tables use this one for stimuli without a method");
}

void add_comparison(std::vector<planned_trial>& cells, std::size_t motion, const method_variants& v,
                    std::size_t place, bool other_first, unsigned track)
{
    planned_trial t{motion, v.values[place], v.standard, {}, 0.0, track};
    if (!v.silences.empty())
        t.method_2 = v.silences[place];
    if (!t.method_2 || !other_first)
        cells.push_back(t);
    if (t.method_2) {
        std::swap(t.method_1, *t.method_2);
        cells.push_back(t);
    }
}

std::vector<planned_trial> list_value_cells(const run_definition& r, bool other_first)
{
    std::vector<planned_trial> cells;
    for (const std::size_t motion : r.motions)
        for (const std::size_t method : r.methods) {
            const method_variants& v = r.variants.at(method);
            if (v.values.empty())
                cells.push_back({motion, method});
            for (std::size_t place = 0; place < v.values.size(); ++place)
                add_comparison(cells, motion, v, place, other_first);
        }
    return cells;
}

std::size_t find_place(const text_table& t, std::size_t row, std::string_view column,
                       const std::vector<std::string>& known)
{
    const std::string_view name = t.need(row, column);
    const auto at = std::find(known.begin(), known.end(), name);
    if (at == known.end())
        t.refuse(row, fmt::format("{} \"{}\" is not in the run", column, name),
                 fmt::format("use one of {}", fmt::join(known, ", ")));
    return static_cast<std::size_t>(at - known.begin());
}

void read_pair(trial& r, const text_table& t, std::size_t row, const run_outline& o)
{
    r.method_1 = find_place(t, row, "method_1", o.methods);
    r.method_2 = find_place(t, row, "method_2", o.methods);
    if (r.method_1 == r.method_2)
        t.refuse(row, "both stimuli have the same method", "give two different methods");
}

unsigned read_response(const text_table& t, std::size_t row, unsigned lowest, unsigned greatest)
{
    const auto response = t.whole(row, "response", lowest, greatest);
    if (!response)
        t.refuse(row, "the response is missing", "give one, or make the trial void");
    return *response;
}

// Tables have six decimals, and other programs may round, too. Returns the exact value of the run.
double read_value(const text_table& t, std::size_t row, const run_outline& o)
{
    const auto value = t.number(row, "value");
    if (!value)
        t.refuse(row, "the value is missing", "give the value of the comparison");
    constexpr double rounding = 5.1e-7;
    constexpr std::size_t most_listed = 12; // values in a message
    const double nearest = o.values[find_nearest(o.values, *value)];
    if (std::abs(nearest - *value) > std::max(rounding, 1e-12 * std::abs(nearest)))
        t.refuse(row, fmt::format("value {} is not in the run", t.need(row, "value")),
                 o.values.size() > most_listed
                     ? fmt::format("use one of the run's {} values, from {} to {}", o.values.size(),
                                   o.values.front(), o.values.back())
                     : fmt::format("use one of {}", fmt::join(o.values, ", ")));
    return nearest;
}

void read_comparison(trial& r, const text_table& t, std::size_t row, const run_outline& o)
{
    read_comparison(r, t, row, o, o.standard ? standard_name : "");
}

void read_comparison(trial& r, const text_table& t, std::size_t row, const run_outline& o,
                     std::string_view other)
{
    const bool other_first = !other.empty() && t.need(row, "method_1") == other;
    if (!other.empty() && !other_first && t.need(row, "method_2") != other)
        t.refuse(row, fmt::format("neither method is \"{}\"", other), "give each trial one");
    r.method_1 = find_place(t, row, other_first ? "method_2" : "method_1", o.methods);
    r.value = read_value(t, row, o);
}

bool is_positive_response(const run_outline& o, std::string_view method_1, unsigned response) noexcept
{
    return (response == 2) == (!o.standard || method_1 == standard_name);
}

namespace {

// Returns the method of a trial, as an index in the definition. If there is a standard, returns the method of
// the comparison.
std::size_t find_base_method(const simulated_run& who, const planned_trial& t)
{
    const auto base = [&who](std::size_t m) { return who.definition.methods[m].made_of.value_or(m); };
    return std::ranges::count(who.run.methods, base(t.method_1)) == 0 && t.method_2 ? base(*t.method_2)
                                                                                    : base(t.method_1);
}

// Returns the deviation of a person's figure from the mean of all people, in standard deviations.
double find_deviation(const simulated_run& who, const planned_trial& t, double simulated_figures::*figure)
{
    const double common =
        find_run_task(who.run.outline).has_one_method(who.run.outline) ? who.truth.correlation : 1.0;
    const double own = who.person.figures_by_method[find_base_method(who, t)].*figure;
    return std::sqrt(common) * (who.person.figures.*figure) + std::sqrt(1.0 - common) * own +
           who.person.group;
}

// Returns the true value for the method of a trial.
std::optional<double> find_true_value(const std::vector<double>& values, const simulated_run& who,
                                      const planned_trial& t)
{
    if (values.size() < 2 || who.run.methods.size() < 2 ||
        !find_run_task(who.run.outline).has_one_method(who.run.outline))
        return values.empty() ? std::nullopt : std::optional(values.front());
    const auto at = std::ranges::find(who.run.methods, find_base_method(who, t));
    return values.at(static_cast<std::size_t>(at - who.run.methods.begin()));
}

} // namespace

psychometric find_psychometric(const simulated_run& who, const planned_trial& t)
{
    const run_outline& o = who.run.outline;
    const simulation& s = who.truth;
    const auto [least, greatest] = std::pair(o.values.front(), o.values.back());
    const double pse =
        find_true_value(s.pse, who, t).value_or(o.standard.value_or(0.5 * (least + greatest))) +
        s.pse_sd * find_deviation(who, t, &simulated_figures::pse);
    double jnd = find_true_value(s.jnd, who, t).value_or(0.1 * (greatest - least));
    if (s.jnd_sd > 0.0) {
        const double variance = std::log1p(std::pow(s.jnd_sd / jnd, 2.0));
        jnd *=
            std::exp(std::sqrt(variance) * find_deviation(who, t, &simulated_figures::jnd) - 0.5 * variance);
    }
    return {pse, jnd / normal_quartile, 0.0};
}

bool feels_more(const simulated_run& who, const planned_trial& t, random_numbers& r)
{
    const double value = find_value(who.definition, t).value();
    return r.unit() < normal_chance(value, find_psychometric(who, t), 0.0);
}

double find_dprime(const simulated_run& who, const planned_trial& t)
{
    return std::max(0.0, find_true_value(who.truth.dprime, who, t).value() +
                             who.truth.dprime_sd * find_deviation(who, t, &simulated_figures::dprime));
}

double find_exponent(const simulated_run& who, const planned_trial& t)
{
    return find_true_value(who.truth.exponent, who, t).value() +
           who.truth.exponent_sd * find_deviation(who, t, &simulated_figures::exponent);
}

std::optional<double> draw_lapse(const simulated_run& who, random_numbers& r, unsigned keys)
{
    if (!(who.truth.lapse > 0.0) || r.unit() >= who.truth.lapse)
        return {};
    return 1 + r.below(keys);
}

double simulate_comparison(const simulated_run& who, const planned_trial& t, random_numbers& r)
{
    if (const auto key = draw_lapse(who, r))
        return *key;
    const bool more = feels_more(who, t, r);
    const bool standard_first = who.definition.methods[t.method_1].name == standard_name;
    return more == (!t.method_2 || standard_first) ? 2 : 1;
}

void prepare_judge(simulated_run& who)
{
    const run_definition& r = who.run;
    if (r.simulate_as.empty())
        throw error(error_kind::bad_input, r.where,
                    fmt::format("simulate: the observer cannot judge \"{}\"", r.attribute),
                    "add simulate_as = \"similarity\" or \"uniformity\"");
    double sum = 0.0;
    for (const std::size_t motion : r.motions)
        for (const std::size_t method : r.methods)
            sum -= std::log(who.cost(motion, method));
    who.mean_utility = sum / static_cast<double>(r.motions.size() * r.methods.size());
}

double draw_deviation(const simulated_run& who, std::size_t method, random_numbers& r)
{
    return who.truth.method_sd * who.person.methods[method] + who.truth.sigma * r.normal();
}

double judge(const simulated_run& who, std::size_t motion, std::size_t method, random_numbers& r)
{
    return -std::log(who.cost(motion, method)) + draw_deviation(who, method, r);
}

} // namespace tactor::study
