// SPDX-License-Identifier: MIT
#include "study/tasks/adaptive.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/words.hpp"
#include "study/experiment/definition.hpp"
#include "study/experiment/variation.hpp"
#include "study/statistics/psychometric_fit.hpp"
#include "study/tasks/comparison.hpp"

namespace tactor::study {
namespace {

using detail::toml_table;

constexpr unsigned most_tracks = 8;
constexpr double range_steps = 40.0; ///< number of steps in the range of values

// Reads a list of numbers. If it has two, returns `count` numbers from the first to the second.
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

// Returns a number rounded to nine decimals, which removes the error of a sum of steps.
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

// Sets the steps of a staircase, as multiples of the smallest step.
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

class chooser final : public value_chooser {
public:
    chooser(const run_definition& r, const psychometric_family& family, is_positive positive)
        : run_(r), positive_(positive), tracks_(r, family)
    {
    }

    void choose(planned_trial& t) override
    {
        if (t.track > 0)
            set_value(t, run_, tracks_.next(t.track));
    }
    void take(unsigned track, std::string_view method_1, unsigned response) override
    {
        tracks_.answer(track, positive_(run_.outline, method_1, response));
    }

private:
    const run_definition& run_;
    is_positive positive_;
    adaptive_tracks tracks_;
};

std::string list_numbers(const std::vector<double>& numbers)
{
    std::vector<std::string> texts;
    for (const double v : numbers)
        texts.push_back(plain_number(v, 4));
    return fmt::format("{}", fmt::join(texts, ", "));
}

class adaptive final : public comparison_task {
public:
    adaptive()
        : comparison_task({.name = "adaptive",
                           .trial =
                               "One stimulus to judge, or a standard and a comparison to choose from; the "
                               "previous answers choose the values",
                           .response = "Number of the chosen stimulus, or of the chosen word: 1 or 2",
                           .keys = add_procedure_keys({"choices", "vary", "standard"}),
                           .column = "track"})
    {
    }

    void read_outline(const toml_table& t, run_definition& r) const override
    {
        read_procedure(t, r, read_vary(t, r.outline), true);
        read_trials(t, r.outline);
    }

    std::vector<planned_trial> list_cells(const run_definition& r) const override
    {
        return list_track_cells(r);
    }
    std::unique_ptr<value_chooser> choose_values(const run_definition& r) const override
    {
        return choose_adaptively(r, two_answers(sigmoid::normal), is_more);
    }

    // Results.

    std::string describe(const run_outline& o) const override { return describe_range(*this, o); }

    std::string describe_procedure(const run_definition& r, std::string_view& section) const override
    {
        return describe_adaptive(r, section);
    }
};

} // namespace

const task& adaptive_task()
{
    static const adaptive one;
    return one;
}

void read_procedure(const toml_table& t, run_definition& r, const detail::bounds& b, bool two_sided)
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
    // A staircase that needs several answers for a step stays on one side of the pse. A fit would then move
    // the pse to that side and find a jnd that is too small.
    o.is_adaptive = true;
    a.two_sided = two_sided;
    if (!two_sided && a.down == 1)
        t.fail("procedure", "1up1down leads to 50 % right answers, which guesses reach",
               "use 1up2down, 1up3down or quest");
    a.tracks = t.whole("tracks", 1, most_tracks).value_or(a.is_mirrored() ? 2 : 1);
    if (a.is_mirrored() && a.tracks % 2 != 0)
        t.fail("tracks",
               fmt::format("{} of procedure \"{}\" would test one side of the pse more than the other",
                           counted(a.tracks, "track"), name),
               "use an even number: every second track is mirrored");
    const std::vector<double> start = read_one_or_more(t, "start", {range[0], range[1]});
    if (start.size() > 1 && start.size() != a.tracks)
        t.fail("start", fmt::format("start has {} values", start.size()), "give one, or one for each track");
    for (unsigned i = 0; i < a.tracks; ++i) // with two sides alternates between both ends
        a.start.push_back(find_nearest(o.values, start.empty()       ? range[two_sided && i % 2 == 1 ? 0 : 1]
                                                 : start.size() == 1 ? start[0]
                                                                     : start[i]));
    a.slopes =
        read_prior(t, "slope", {0.0, detail::max_mm, true}, {width / range_steps, width / 2.0}, 5, true);
    a.lapses = read_prior(t, "lapse", {0.0, 0.5}, {0.0, 0.04}, 3, false);
}

std::string describe_adaptive(const run_definition& r, std::string_view& section)
{
    const adaptive_options& a = r.adaptive;
    const std::vector<double>& values = r.outline.values;
    const double step = values[1] - values[0];
    const std::string text =
        fmt::format("{} in each condition, values from {} to {} in steps of {}; ", counted(a.tracks, "track"),
                    plain_number(values.front()), plain_number(values.back()), plain_number(step));
    section = a.down == 0 ? "has_quest" : "has_staircases";
    if (a.down == 0)
        return text + fmt::format("QUEST+ (Watson 2017) chose the value with the lowest expected entropy. "
                                  "Priors were uniform over thresholds at the values, slopes (standard "
                                  "deviations of the normal) of {} and lapses of {}",
                                  list_numbers(a.slopes), list_numbers(a.lapses));
    std::vector<double> steps;
    for (const std::size_t places : a.steps)
        steps.push_back(static_cast<double>(places) * step);
    std::vector<double> start;
    for (const std::size_t place : a.start)
        start.push_back(values[place]);
    const double led_to = 100.0 * std::pow(0.5, 1.0 / a.down);
    const std::string mirrored =
        fmt::format("; every second track mirrored, up after {} in a row, which leads to {:.1f} %",
                    counted(a.down, "negative answer"), 100.0 - led_to);
    const char* const positive = a.two_sided ? "positive answer" : "right answer";
    return text + fmt::format("staircases (Levitt 1971) from {}: a step down after {} in a row, a step up "
                              "after each other answer, which leads to {:.1f} % {}s{}; step "
                              "sizes of {}, the next one after every second reversal",
                              list_numbers(start), counted(a.down, positive), led_to, positive,
                              a.is_mirrored() ? mirrored : "", list_numbers(steps));
}

std::vector<std::string_view> add_procedure_keys(std::vector<std::string_view> keys)
{
    keys.insert(keys.end(), procedure_keys.begin(), procedure_keys.end());
    return keys;
}

std::vector<planned_trial> list_track_cells(const run_definition& r)
{
    std::vector<planned_trial> cells;
    unsigned track = 0;
    for (const std::size_t motion : r.motions)
        for (const std::size_t method : r.methods)
            for (const std::size_t start : r.adaptive.start)
                add_comparison(cells, motion, r.variants.at(method), start, false, ++track);
    return cells;
}

std::string describe_range(const task& of, const run_outline& o)
{
    return fmt::format("{} ({}); {} chosen by the answers from {} to {}{}", of.about().trial,
                       fmt::join(o.methods, ", "), o.vary, plain_number(o.values.front()),
                       plain_number(o.values.back()),
                       o.standard ? "; standard " + plain_number(*o.standard) : "");
}

std::unique_ptr<value_chooser> choose_adaptively(const run_definition& r, const psychometric_family& family,
                                                 is_positive positive)
{
    return std::make_unique<chooser>(r, family, positive);
}

void value_staircase::answer(bool positive)
{
    const auto step = rule_.answer(positive);
    if (!step)
        return;
    const std::size_t by = steps_[step->size];
    at_ = step->up ? std::min(at_ + by, top_) : at_ - std::min(at_, by);
}

adaptive_tracks::procedure& adaptive_tracks::find(unsigned track)
{
    if (const auto there = tracks_.find(track); there != tracks_.end())
        return there->second;
    const auto insert = [&](procedure p) -> procedure& {
        return tracks_.emplace(track, std::move(p)).first->second;
    };
    const adaptive_options& a = run_.adaptive;
    const std::vector<double>& values = run_.outline.values;
    const unsigned of_condition = (track - 1) % a.tracks;
    if (a.down > 0)
        return insert(value_staircase(a.down, a.is_mirrored() && of_condition % 2 == 1, a.steps,
                                      a.start[of_condition], values.size() - 1));
    const quest_grid grid{values, values, {}, a.slopes, a.lapses};
    return insert(quest(grid, [f = family_](double x, const psychometric& p) { return chance(x, p, f); }));
}

std::size_t adaptive_tracks::next(unsigned track)
{
    return std::visit([](const auto& p) { return p.place(); }, find(track));
}

void adaptive_tracks::answer(unsigned track, bool positive)
{
    std::visit([positive](auto& p) { p.answer(positive); }, find(track));
}

} // namespace tactor::study
