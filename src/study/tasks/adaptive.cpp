// SPDX-License-Identifier: MIT
#include "study/tasks/adaptive.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/suggest.hpp"
#include "core/words.hpp"
#include "study/data/definition.hpp"
#include "study/statistics/psychometric_fit.hpp"
#include "study/tasks/comparison.hpp"

namespace tactor::study {
namespace {

using detail::toml_table;

constexpr unsigned most_tracks = 8;
constexpr unsigned most_reversals = 1000;
constexpr double slope_parts = 40.0; ///< the smallest slope is the range divided by this

// Names of procedures. For staircases, the index is the number of positive answers in a row that cause a step
// down.
constexpr std::array<std::string_view, 4> procedures{"quest", "1up1down", "1up2down", "1up3down"};

bool is_quest(const adaptive_track& t)
{
    return t.down == 0;
}

// Reads a list of numbers. If the list has two numbers, returns `count` numbers from the first to the second,
// with equal ratios if `by_ratio`, else with equal differences.
std::vector<double> read_prior(const toml_table& t, std::string_view key, const detail::bounds& b,
                               std::vector<double> usual, std::size_t count, bool by_ratio)
{
    std::vector<double> all = t.has(key) ? read_number_or_list(t, key, b) : std::move(usual);
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

// Returns the index of a name in `procedures`. The index is the value of adaptive_track::down.
unsigned find_procedure(const toml_table& t, const std::string& name)
{
    const auto at = std::ranges::find(procedures, name);
    if (at == procedures.end())
        t.fail("procedure", fmt::format("procedure {} is unknown", detail::quoted(name)),
               fmt::format("use {}", fmt::join(procedures, ", ")));
    return static_cast<unsigned>(at - procedures.begin());
}

// Reads the procedure of each track.
std::vector<adaptive_track> read_tracks(const toml_table& t, bool two_sided)
{
    std::vector<adaptive_track> all;
    const std::optional<unsigned> tracks = t.whole("tracks", 1, most_tracks);
    if (const toml::node* n = t.node("procedure"); n == nullptr || !n->is_array()) {
        const std::string name =
            t.need(t.choice("procedure", {procedures.begin(), procedures.end()}), "procedure");
        const unsigned down = find_procedure(t, name);
        all.resize(tracks.value_or(two_sided && down > 1 ? 2 : 1), {.down = down});
        return all;
    }
    for (const std::string& name : t.texts("procedure", most_tracks))
        all.push_back({.down = find_procedure(t, name)});
    if (all.empty())
        t.fail("procedure", "procedure is empty", "name a procedure for each track");
    if (tracks.value_or(all.size()) != all.size())
        t.fail("tracks", fmt::format("tracks is {}, but procedure has {}", *tracks, all.size()),
               "leave tracks out");
    return all;
}

// Refuses keys of QUEST+ in a run without QUEST+, and keys of staircases in a run without staircases.
void refuse_unused_keys(const toml_table& t, const adaptive_options& a)
{
    for (const auto& [key, of_quest] : {std::pair("steps", false),
                                        {"reversals", false},
                                        {"slope", true},
                                        {"lapse", true},
                                        {"stop_sd", true}})
        if (t.has(key) && std::ranges::count(a.tracks, of_quest, is_quest) == 0)
            t.fail(key,
                   fmt::format("{} does not apply to procedure \"{}\"", key, procedures.at(a.tracks[0].down)),
                   fmt::format("leave out {}", key));
}

// Sets the sides of tracks. Every second track of a procedure begins at the other end, and is mirrored if it
// needs several answers for a step. Without mirrored tracks, such staircases would stay on one side of the
// pse. A fit would then move the pse to that side and find a jnd that is too small. `greatest`: index of the
// greatest value.
void set_sides(const toml_table& t, adaptive_options& a, std::size_t greatest)
{
    std::array<std::size_t, procedures.size()> counts{};
    for (adaptive_track& one : a.tracks) {
        const bool is_other_side = a.two_sided && counts.at(one.down)++ % 2 == 1;
        one.mirrored = is_other_side && one.down > 1;
        one.start = is_other_side ? 0 : greatest;
        if (!a.two_sided && one.down == 1)
            t.fail("procedure", "1up1down leads to 50 % right answers, as guesses do",
                   "use 1up2down, 1up3down or quest");
    }
    for (const unsigned down : {2U, 3U})
        if (counts.at(down) % 2 != 0)
            t.fail(t.node("procedure")->is_array() ? "procedure" : "tracks",
                   fmt::format("{} of procedure \"{}\" would test one side of the pse more than the other",
                               counted(counts.at(down), "track"), procedures.at(down)),
                   "use an even number: every second track is mirrored");
}

class chooser final : public value_chooser {
public:
    chooser(const run_definition& r, is_positive positive) : run_(r), positive_(positive), tracks_(r.outline)
    {
    }

    void choose(planned_trial& t) override
    {
        if (t.track > 0)
            set_value(t, run_, tracks_.next(t.track));
    }
    void record_answer(unsigned track, std::string_view method_1, unsigned response) override
    {
        tracks_.answer(track, positive_(run_.outline, method_1, response));
    }
    bool has_ended(unsigned track) const override { return tracks_.has_ended(track); }

private:
    const run_definition& run_;
    is_positive positive_;
    adaptive_tracks tracks_;
};

psychometric_family find_family(const adaptive_options& a)
{
    return a.two_sided ? two_answer_family(sigmoid::normal) : right_answers(sigmoid::normal);
}

std::string format_numbers(const std::vector<double>& numbers)
{
    std::vector<std::string> texts;
    for (const double v : numbers)
        texts.push_back(plain_number(v, 4));
    return fmt::format("{}", fmt::join(texts, ", "));
}

std::string describe_quest(const adaptive_options& a)
{
    return fmt::format("QUEST+ (Watson 2017) chose the value with the lowest expected entropy. Priors were "
                       "uniform over thresholds at the values, slopes (standard deviations of the normal) of "
                       "{} and lapses of {}",
                       format_numbers(a.slopes), format_numbers(a.lapses));
}

// Describes the staircases of one procedure.
std::string describe_staircases(const run_outline& o, unsigned down)
{
    const adaptive_options& a = o.adaptive;
    std::vector<double> steps;
    for (const std::size_t places : a.steps)
        steps.push_back(static_cast<double>(places) * (o.values[1] - o.values[0]));
    std::vector<double> start;
    for (const adaptive_track& one : a.tracks)
        if (one.down == down)
            start.push_back(o.values[one.start]);
    const double led_to = 100.0 * std::pow(0.5, 1.0 / down);
    const std::string mirrored =
        fmt::format("; every second track mirrored, up after {} in a row, which leads to {:.1f} %",
                    counted(down, "negative answer"), 100.0 - led_to);
    const char* const positive = a.two_sided ? "positive answer" : "right answer";
    return fmt::format(
        "staircases (Levitt 1971) from {}: a step down after {} in a row, a step up after each "
        "other answer, which leads to {:.1f} % {}s{}; step sizes of {}, the next one after "
        "every second reversal",
        format_numbers(start), counted(down, positive), led_to, positive,
        a.two_sided && down > 1 ? mirrored : "", format_numbers(steps));
}

class adaptive final : public comparison_task {
public:
    adaptive()
        : comparison_task({.name = "adaptive",
                           .trial =
                               "One stimulus to judge, or a standard and a comparison to choose from; the "
                               "previous answers choose the values",
                           .response = "Number of the chosen stimulus, or of the chosen word: 1 or 2",
                           .keys = add_procedure_keys({"choices", "feedback", "vary", "standard"}),
                           .columns = {"track"},
                           .sections = {"has_functions", "has_comparisons"}})
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
    std::unique_ptr<value_chooser> make_value_chooser(const run_definition& r) const override
    {
        return make_adaptive_chooser(r, is_positive_response);
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
    run_outline& o = r.outline;
    adaptive_options& a = o.adaptive;
    a.two_sided = two_sided;
    a.tracks = read_tracks(t, two_sided);
    refuse_unused_keys(t, a);
    const value_grid grid = read_grid(t, o, b, "procedure");
    a.steps = grid.sizes.empty() ? std::vector<std::size_t>{4, 2, 1} : grid.sizes;
    set_sides(t, a, o.values.size() - 1);
    const std::vector<double> start = read_number_or_list(t, "start", {grid.least, grid.greatest});
    if (start.size() > 1 && start.size() != a.tracks.size())
        t.fail("start",
               fmt::format("start has {} values, but there {} {}", start.size(),
                           a.tracks.size() == 1 ? "is" : "are", counted(a.tracks.size(), "track")),
               "give one value, or one for each track");
    for (std::size_t i = 0; i < a.tracks.size() && !start.empty(); ++i)
        a.tracks[i].start = find_nearest(o.values, start[start.size() == 1 ? 0 : i]);
    const double width = grid.greatest - grid.least;
    a.slopes =
        read_prior(t, "slope", {0.0, detail::max_mm, true}, {width / slope_parts, width / 2.0}, 5, true);
    a.lapses = read_prior(t, "lapse", {0.0, 0.5}, {0.0, 0.04}, 3, false);
    a.stop_sd = t.number("stop_sd", {0.0, width, true});
    a.reversals = t.whole("reversals", 1, most_reversals);
}

std::string task::describe_procedure(const run_definition& r, std::set<std::string_view>& sections) const
{
    const run_outline& o = r.outline;
    const adaptive_options& a = o.adaptive;
    if (!o.is_adaptive())
        return {};
    std::vector<std::string> parts{fmt::format("{} in each condition, values from {} to {} in steps of {}",
                                               counted(a.tracks.size(), "track"),
                                               plain_number(o.values.front()), plain_number(o.values.back()),
                                               plain_number(o.values[1] - o.values[0]))};
    for (unsigned down = 0; down < procedures.size(); ++down) {
        const auto tracks = std::ranges::count(a.tracks, down, &adaptive_track::down);
        if (tracks == 0)
            continue;
        const std::string which = tracks == std::ssize(a.tracks) ? "" : fmt::format("{} of them: ", tracks);
        parts.push_back(which + (down == 0 ? describe_quest(a) : describe_staircases(o, down)));
        sections.insert(down == 0 ? "has_quest" : "has_staircases");
    }
    if (a.stop_sd)
        parts.push_back(fmt::format("a track of QUEST+ ended when the posterior standard deviation of its "
                                    "threshold was below {}, or without trials left",
                                    plain_number(*a.stop_sd)));
    if (a.reversals)
        parts.push_back(
            fmt::format("a staircase ended at its reversal number {}, or without trials left", *a.reversals));
    return fmt::format("{}", fmt::join(parts, "; "));
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
            for (const adaptive_track& one : r.outline.adaptive.tracks)
                add_comparison(cells, motion, r.variants.at(method), one.start, false, ++track);
    return cells;
}

std::unique_ptr<value_chooser> make_adaptive_chooser(const run_definition& r, is_positive positive)
{
    return std::make_unique<chooser>(r, positive);
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
    const adaptive_track& one = a.tracks[(track - 1) % a.tracks.size()];
    if (!is_quest(one))
        return insert(value_staircase(one, a.steps, run_.values.size() - 1));
    const quest_grid grid{run_.values, run_.values, {}, a.slopes, a.lapses};
    return insert(
        quest(grid, [f = find_family(a)](double x, const psychometric& p) { return chance(x, p, f); }));
}

std::size_t adaptive_tracks::next(unsigned track)
{
    return std::visit([](const auto& p) { return p.place(); }, find(track));
}

void adaptive_tracks::answer(unsigned track, bool positive)
{
    std::visit([positive](auto& p) { p.answer(positive); }, find(track));
}

bool adaptive_tracks::has_ended(unsigned track) const
{
    const adaptive_options& a = run_.adaptive;
    const procedure& p = tracks_.at(track);
    if (const auto* staircase = std::get_if<value_staircase>(&p))
        return a.reversals && staircase->reversals() >= *a.reversals;
    return a.stop_sd && std::get<quest>(p).threshold_sd() < *a.stop_sd;
}

void adaptive_tracks::describe(played_track& t) const
{
    t.ended = has_ended(t.track);
    const procedure& p = tracks_.at(t.track);
    if (const auto* staircase = std::get_if<value_staircase>(&p))
        t.reversals = staircase->reversals();
    else
        t.sd = std::get<quest>(p).threshold_sd();
}

unsigned count_tracks(const run_outline& o)
{
    return static_cast<unsigned>(o.motions.size() * o.methods.size() * o.adaptive.tracks.size());
}

std::vector<played_track> replay_tracks(const run_outline& o, const std::vector<trial>& trials)
{
    if (!o.adaptive.may_end_early() || std::ranges::count(trials, 0U, &trial::track) != 0)
        return {};
    std::vector<played_track> all;
    for (const std::string& motion : o.motions)
        for (const std::string& method : o.methods)
            for (const adaptive_track& one : o.adaptive.tracks)
                all.push_back({.track = static_cast<unsigned>(all.size() + 1),
                               .motion = motion,
                               .method = method,
                               .procedure = std::string(procedures.at(one.down))});
    adaptive_tracks tracks(o);
    for (const trial& t : trials) {
        tracks.answer(t.track, t.positive);
        ++all[t.track - 1].trials;
    }
    for (played_track& t : all)
        if (t.trials > 0)
            tracks.describe(t);
    return all;
}

std::string format_stop_rule(const adaptive_options& a)
{
    std::vector<std::string> keys;
    if (a.stop_sd)
        keys.push_back("stop_sd = " + plain_number(*a.stop_sd));
    if (a.reversals)
        keys.push_back(fmt::format("reversals = {}", *a.reversals));
    return fmt::format("{}", fmt::join(keys, ", "));
}

} // namespace tactor::study
