// SPDX-License-Identifier: MIT
#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/input.hpp"
#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "core/kind_names.hpp"
#include "core/split.hpp"
#include "core/words.hpp"
#include "files/plan/plan_json.hpp"
#include "percept/compare.hpp"
#include "plot/figure.hpp"
#include "plot/paint/output.hpp"
#include "session/process.hpp"

namespace tactor::cli {
namespace {

using detail::comparison;
using detail::comparison_choice;
using detail::comparison_row;
using detail::interval;
using detail::row_spread;

template <class Enum>
std::string join_names()
{
    return fmt::format("{}", fmt::join(detail::kind_names<Enum>(), ","));
}

// "a,b,c", each once, in the order given.
template <class Enum>
std::vector<Enum> parse_list(const char* option, std::string_view text)
{
    const auto known = all_values<Enum>();
    std::vector<Enum> list;
    for (const std::string_view name : detail::split(text, ',')) {
        const auto v = std::find_if(known.begin(), known.end(), [&](Enum e) { return to_string(e) == name; });
        if (v == known.end())
            refuse_option(option, fmt::format("\"{}\" is not known", name),
                          "one or more of " + join_names<Enum>());
        if (std::find(list.begin(), list.end(), *v) != list.end())
            refuse_option(option, fmt::format("\"{}\" occurs twice", name), "name each once");
        list.push_back(*v);
    }
    return list;
}

// The options of this command alone.
struct compare_options {
    comparison_choice choice;
    std::string format = "text";
    picture_options picture;
};

// Returns the last reason why no algorithm can play the strokes, and prints the others, each once.
error why_refused(const std::vector<comparison>& all, const piece& p)
{
    std::vector<error> reasons;
    std::set<std::string> seen;
    for (std::size_t k = 0; k < all.size(); ++k) {
        if (all[k].playable())
            continue;
        for (const comparison_row& r : all[k].rows) {
            const error reason = of_stroke(*r.refused, p, k);
            if (seen.insert(reason.what()).second)
                reasons.push_back(reason);
        }
    }
    for (std::size_t i = 0; i + 1 < reasons.size(); ++i)
        say(stderr, "tactor: {}\n", reasons[i].what());
    return reasons.back();
}

std::vector<comparison> compare_all(const piece& p, const environment& e, const layout& faces,
                                    const plan_options& how, comparison_choice choice)
{
    progress_line line("compare");
    const std::size_t rows = p.strokes.size() * choice.algorithms.size() * choice.phantoms.size();
    std::size_t predicted = 0;
    choice.after_person = [&] { line.update(++predicted, rows * choice.spread.people); };
    std::vector<comparison> all;
    for (const stroke& k : p.strokes)
        all.push_back(detail::compare(k, e.tactors, faces, how, choice));
    for (comparison& c : all)
        for (comparison_row& r : c.rows)
            if (r.refused)
                r.refused = in_options(*r.refused);
    return all;
}

// A figure of the table, or a dash where there is none.
std::string figure(std::optional<double> v)
{
    return v ? fmt::format("{:.3f}", *v) : "-";
}

std::string names(const comparison_row& r)
{
    return fmt::format("{:<13} {:<16}", to_string(r.algorithm), to_string(r.phantom));
}

std::string one_end(const std::optional<interval>& v, double interval::*end)
{
    return figure(v ? std::optional(*v.*end) : std::nullopt);
}

// Under a row, in its columns.
void print_spread(const comparison_row& r, bool by_taps)
{
    if (!r.spread)
        return;
    const row_spread& s = *r.spread;
    for (const auto& [name, end] : {std::pair{"5 %", &interval::low}, std::pair{"95 %", &interval::high}}) {
        fmt::print("{:>30} {:>6} {:>6} {:>6} ", name, "", one_end(s.rms_error_mm, end),
                   one_end(s.largest_error_mm, end));
        if (by_taps)
            fmt::print("{:>8} {:>8} {:>6}\n", one_end(s.felt_length_mm, end), "",
                       one_end(s.length_ratio, end));
        else
            fmt::print("{:>6} {:>7}\n", one_end(s.speed_cv, end), one_end(s.intensity_cv, end));
    }
}

void print_row(const comparison_row& r, bool by_taps)
{
    if (r.refused) {
        say(stdout, "{} refused: {}\n", names(r), r.refused->what());
        return;
    }
    if (!r.unpredicted.empty()) {
        say(stdout, "{} no prediction: {}\n", names(r), r.unpredicted);
        return;
    }
    if (by_taps) {
        fmt::print("{} {:>6} {:>6} {:>6} {:>8} {:>8} {:>6}\n", names(r), r.plan->bursts.size(),
                   figure(r.felt.rms_error_mm), figure(r.felt.largest_error_mm),
                   figure(r.tapped.felt_length_mm), figure(r.tapped.target_length_mm),
                   figure(r.tapped.length_ratio));
        return;
    }
    const std::string bursts = r.plan->curve ? "-" : fmt::format("{}", r.plan->bursts.size());
    fmt::print("{} {:>6} {:>6} {:>6} {:>6} {:>7} {:>6.1f} {:>6.1f}\n", names(r), bursts,
               figure(r.felt.rms_error_mm), figure(r.felt.largest_error_mm), figure(r.felt.speed_cv),
               figure(r.felt.intensity_cv), 100.0 * r.felt.silent_share, 100.0 * r.felt.shared_share);
}

// Prints each warning once: most are the same for all phantom models.
void print_notes(const comparison& c)
{
    std::set<std::string> said;
    for (const comparison_row& r : c.rows)
        if (r.plan)
            for (const std::string& w : r.plan->warnings) {
                const std::string text = fmt::format("warning: {}: {}\n", to_string(r.algorithm), w);
                if (said.insert(text).second)
                    say_text(stdout, text);
            }
}

void print_heading(bool by_taps)
{
    if (by_taps) {
        fmt::print("\n{:<13} {:<16} {:>6} {:>13} {:>17}\n", "", "", "", "error mm   ", "length mm    ");
        fmt::print("{:<13} {:<16} {:>6} {:>6} {:>6} {:>8} {:>8} {:>6}\n", "algorithm", "phantom", "bursts",
                   "RMS", "max", "felt", "target", "ratio");
        return;
    }
    fmt::print("\n{:<13} {:<16} {:>6} {:>13} {:>14} {:>13}\n", "", "", "", "error mm   ", "CV      ",
               "% of time ");
    fmt::print("{:<13} {:<16} {:>6} {:>6} {:>6} {:>6} {:>7} {:>6} {:>6}\n", "algorithm", "phantom", "bursts",
               "RMS", "max", "speed", "intens.", "silent", "shared");
}

void print_one(const comparison& c, const std::string& title, const array& a)
{
    const trajectory& m = c.target.motion;
    const std::string faces =
        c.faces == faces_kind::delaunay ? "" : fmt::format(", faces {}", to_string(c.faces));
    say(stdout, "{} on {}: {} mm in {}{}\n", title, a.name, plain_number(m.length_mm()),
        seconds_text(m.duration_s()), faces);
    if (c.target.note != note_kind::none)
        say(stdout, "note: {}\n", files::note_text(c.target.note));
    const bool by_taps = c.observer.kind == observer_kind::low_speed;
    print_heading(by_taps);
    for (const comparison_row& r : c.rows) {
        print_row(r, by_taps);
        print_spread(r, by_taps);
    }
    print_notes(c);
}

void print_text(const std::vector<comparison>& all, const std::vector<std::string>& titles, const array& a)
{
    for (std::size_t i = 0; i < all.size(); ++i) {
        print_one(all[i], titles[i], a);
        fmt::print("\n");
    }
    const detail::observer_choice& o = all.front().observer;
    if (all.front().spread.people != 0)
        say(stdout, "{}.\n", detail::spread_note(all.front().spread, o.kind == observer_kind::low_speed));
    say(stdout, "{}\nThis is {}.\n",
        o.kind == observer_kind::low_speed
            ? "Errors count at the onsets of the bursts; length: of the chain of bursts."
            : "CV: standard deviation / mean; shared: a tactor serves two bursts.",
        detail::prediction_note(o));
}

int run(settings& s, const compare_options& asked, bool one_algorithm)
{
    const environment e = session::read_environment(s);
    comparison_choice choice = asked.choice;
    const auto every = all_values<algorithm_kind>();
    if (one_algorithm)
        choice.algorithms = {s.plan.algorithm};
    else if (choice.algorithms.empty())
        choice.algorithms.assign(every.begin(), every.end());
    if (choice.phantoms.empty())
        choice.phantoms = {s.plan.phantom};
    choice.observer = {s.observer, s.low_speed};
    choice.compensate = s.compensate;
    choice.spread = s.spread;

    // A row says what an algorithm cannot do; what nobody may ask for is wrong usage.
    static_cast<void>(burst_duration_s(s.plan));
    const layout faces(e.tactors);
    const std::string argument = stroke_arguments(s).front();
    if (e.plans.contains(argument))
        throw error(error_kind::bad_input, shown_name(argument), "it is a plan",
                    "give the stroke: compare plans it itself");
    const piece p = open_piece(s, e, faces, argument);
    if (!asked.picture.file.empty() && p.strokes.size() > 1)
        refuse_option("-o", fmt::format("there are {} strokes", p.strokes.size()), "a picture shows one");
    if (!asked.picture.file.empty())
        plot::check_output(asked.picture.file, asked.picture.force);
    const std::vector<comparison> all = compare_all(p, e, faces, s.plan, std::move(choice));
    std::vector<std::string> titles;
    for (std::size_t i = 0; i < all.size(); ++i)
        titles.push_back(name_stroke(p, i, e));
    const auto playable = std::count_if(all.begin(), all.end(), [](const auto& c) { return c.playable(); });
    if (playable == 0)
        throw why_refused(all, p);
    if (!asked.picture.file.empty()) {
        session::tell_of_pipe_to_write(asked.picture.file);
        const std::string title =
            asked.picture.has_title() ? asked.picture.choose_title(all[0].target.name) : "";
        plot::save(plot::draw_comparison(e.tactors, all[0], title, asked.picture.width_mm),
                   asked.picture.file, asked.picture.dpi, asked.picture.force);
    }
    if (asked.format == "json")
        fmt::print("{}", files::comparisons_text(all, e.tactors));
    else
        print_text(all, titles, e.tactors);
    if (static_cast<std::size_t>(playable) < all.size())
        throw why_refused(all, p);
    return status_ok;
}

} // namespace

int run_compare(command_line& line)
{
    compare_options o;
    CLI::App& c = line.app;
    add_strokes(line);
    settings& s = add_options(line, options::on_compare);
    c.get_option("STROKE")->description(
        "preset (park2016-1 ... park2016-4; wave-2x4 and round-2x4 on palm-2x4), file (.toml, .csv, .svg), "
        "or - for such a file on standard input; not a plan");
    auto* algorithms = add_text(
        c, "--algorithms", join_names<algorithm_kind>(), "algorithms to compare (default all three)",
        [&o](const std::string& t) { o.choice.algorithms = parse_list<algorithm_kind>("--algorithms", t); });
    auto* phantoms = add_text(
        c, "--phantoms", join_names<phantom_kind>(), "phantom models to compare (default: that of --phantom)",
        [&o](const std::string& t) { o.choice.phantoms = parse_list<phantom_kind>("--phantoms", t); });
    c.get_option("--algorithm")
        ->description("compare only this algorithm; see --algorithms")
        ->excludes(algorithms);
    c.get_option("--phantom")->excludes(phantoms);
    add_format_option(c, o.format, {"text", "json"}, "format of the output (default text)");
    add_text(c, "-o,--output", "FILE.svg|.png|.pdf",
             "also draw target and prediction on the array, and speed over time", [&o](const std::string& t) {
                 plot::find_format(t);
                 o.picture.file = t;
                 o.choice.keep_samples = true;
             });
    add_picture_options(c, o.picture, "85, one print column");
    c.footer("tactor compare park2016-3\n"
             "tactor compare park2016-3 --phantoms inverse-distance,barycentric\n"
             "tactor compare --shape line --observer low-speed -o line.svg");
    line.parse();
    return run(s, o, c.count("--algorithm") != 0);
}

} // namespace tactor::cli
