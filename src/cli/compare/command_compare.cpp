// SPDX-License-Identifier: MIT
#include <algorithm>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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
std::string join_enum_names()
{
    return fmt::format("{}", fmt::join(detail::kind_names<Enum>(), ","));
}

// Parses a list "a,b,c" and keeps its order. Refuses names that occur twice.
template <class Enum>
std::vector<Enum> parse_list(const char* option, std::string_view text)
{
    std::vector<Enum> list;
    for (const std::string_view name : detail::split(text, ',')) {
        const std::optional<Enum> v = detail::find_kind<Enum>(name);
        if (!v)
            refuse_option(option, fmt::format("\"{}\" is unknown", name),
                          "use one or more of " + join_enum_names<Enum>());
        if (std::find(list.begin(), list.end(), *v) != list.end())
            refuse_option(option, fmt::format("\"{}\" occurs twice", name), "name each once");
        list.push_back(*v);
    }
    return list;
}

// Options that only the command `compare` has.
struct compare_options {
    comparison_choice choice;
    std::string format = "text";
    picture_options picture;
};

// Returns the last reason why no algorithm can play the strokes. Prints the other reasons, without
// repetitions.
error report_refusals(const std::vector<comparison>& all, const piece& p)
{
    std::vector<error> reasons;
    std::set<std::string> seen;
    for (std::size_t k = 0; k < all.size(); ++k) {
        if (all[k].playable())
            continue;
        for (const comparison_row& r : all[k].rows) {
            const error reason = add_stroke_to_error(*r.refused, p, k);
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
                r.refused = reword_as_options(*r.refused);
    return all;
}

// Returns a number in the form for the table, or a dash if it is missing.
std::string number_text(std::optional<double> v)
{
    return v ? fmt::format("{:.3f}", *v) : "-";
}

std::string names(const comparison_row& r)
{
    return fmt::format("{:<13} {:<16}", to_string(r.algorithm), to_string(r.phantom));
}

// A column of a table. It has a title, a text for each row, and two more numbers for the ends of a spread.
struct column {
    std::string_view title;
    std::function<std::string(const comparison_row&)> text;
    std::optional<interval> row_spread::*spread = nullptr;
    double factor = 1.0; // factor for the ends of the spread
    int digits = 3;      // digits of the ends of the spread
};

// Returns a column that contains lengths or ratios.
column plain_column(std::string_view title, std::optional<double> percept_summary::*value,
                    std::optional<interval> row_spread::*spread)
{
    return {title, [value](const comparison_row& r) { return number_text(r.felt.*value); }, spread};
}

std::vector<column> place_columns()
{
    using felt = percept_summary;
    using ends = row_spread;
    return {plain_column("path", &felt::rms_to_path_mm, &ends::rms_to_path_mm),
            plain_column("RMS", &felt::rms_error_mm, &ends::rms_error_mm),
            plain_column("max", &felt::largest_error_mm, &ends::largest_error_mm),
            plain_column("RMS", &felt::along_rms_mm, &ends::along_rms_mm),
            plain_column("max", &felt::along_max_mm, &ends::along_max_mm),
            plain_column("RMS", &felt::across_rms_mm, &ends::across_rms_mm),
            plain_column("max", &felt::across_max_mm, &ends::across_max_mm)};
}

std::vector<column> time_columns(bool by_taps)
{
    using felt = percept_summary;
    using ends = row_spread;
    constexpr double ms = 1000.0;
    std::vector<column> all{{"bursts",
                             [](const comparison_row& r) {
                                 return r.plan->curve ? "-" : fmt::format("{}", r.plan->bursts.size());
                             }},
                            {"ms",
                             [](const comparison_row& r) {
                                 return r.felt.lag_s ? fmt::format("{:.0f}", ms * *r.felt.lag_s) : "-";
                             },
                             &ends::lag_s, ms, 1},
                            plain_column("lag", &felt::rms_at_lag_mm, &ends::rms_at_lag_mm)};
    const auto percent = [](double felt::*share) {
        return [share](const comparison_row& r) { return fmt::format("{:.1f}", 100.0 * r.felt.*share); };
    };
    if (by_taps) {
        all.push_back({"felt mm",
                       [](const comparison_row& r) { return number_text(r.tapped.felt_length_mm); },
                       &ends::felt_length_mm});
        all.push_back(
            {"target mm", [](const comparison_row& r) { return number_text(r.tapped.target_length_mm); }});
        all.push_back({"ratio", [](const comparison_row& r) { return number_text(r.tapped.length_ratio); },
                       &ends::length_ratio});
    } else {
        all.push_back(plain_column("speed", &felt::speed_cv, &ends::speed_cv));
        all.push_back(plain_column("intens.", &felt::intensity_cv, &ends::intensity_cv));
        all.push_back({"silent", percent(&felt::silent_share)});
        all.push_back({"shared", percent(&felt::shared_share)});
    }
    return all;
}

// Prints one line of a table. `text` returns the text for each column.
template <class Text>
void print_line(std::string_view begins, const std::vector<column>& columns, Text text)
{
    constexpr std::size_t least_width = 6;
    std::string line = fmt::format("{:<30}", begins);
    for (const column& c : columns)
        line += fmt::format(" {:>{}}", text(c), std::max(least_width, c.title.size()));
    fmt::print("{}\n", line);
}

// Prints the ends of a row's spread in a line below the row.
void print_spread(const comparison_row& r, const std::vector<column>& columns)
{
    if (!r.spread)
        return;
    for (const auto& [name, end] : {std::pair{"5 %", &interval::low}, std::pair{"95 %", &interval::high}})
        print_line(fmt::format("{:>30}", name), columns, [&, end = end](const column& c) {
            if (c.spread == nullptr)
                return std::string();
            const std::optional<interval>& v = (*r.spread).*c.spread;
            return v ? fmt::format("{:.{}f}", c.factor * (*v).*end, c.digits) : "-";
        });
}

// Prints a table. `groups` is the heading above the titles of the columns.
void print_table(const comparison& c, std::string_view groups, const std::vector<column>& columns)
{
    fmt::print("\n{}\n", groups);
    print_line("algorithm     phantom", columns, [](const column& one) { return one.title; });
    for (const comparison_row& r : c.rows) {
        if (r.refused || !r.unpredicted.empty())
            continue;
        print_line(names(r), columns, [&r](const column& one) { return one.text(r); });
        print_spread(r, columns);
    }
}

// Prints the reasons why some rows have no values.
void print_missing(const comparison& c)
{
    for (const comparison_row& r : c.rows)
        if (r.refused)
            say(stdout, "{} refused: {}\n", names(r), r.refused->what());
        else if (!r.unpredicted.empty())
            say(stdout, "{} no prediction: {}\n", names(r), r.unpredicted);
}

// Prints the warnings without repetitions, because most are the same for all phantom models.
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

void print_one(const comparison& c, const std::string& title, const array& a)
{
    const trajectory& m = c.target.motion;
    const std::string faces =
        c.faces == faces_kind::delaunay ? "" : fmt::format(", faces {}", to_string(c.faces));
    say(stdout, "{} on {}: {} mm in {}{}\n", title, make_printable(a.name), plain_number(m.length_mm()),
        seconds_text(m.duration_s()), faces);
    if (c.target.note != note_kind::none)
        say(stdout, "note: {}\n", files::note_text(c.target.note));
    const bool by_taps = c.observer.kind == observer_kind::low_speed;
    if (c.predicted()) {
        print_table(c,
                    fmt::format("{:<30} {:>6} {:>13} {:>13} {:>13}", "error mm", "to", "equal times ",
                                "along path ", "across path "),
                    place_columns());
        print_table(c,
                    fmt::format("{:<37} {:>6} {:>6} {:>{}}", "", "lag", "RMS at",
                                by_taps ? "length      " : "CV        % of time ", by_taps ? 25 : 28),
                    time_columns(by_taps));
    }
    print_missing(c);
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
            ? "Errors count at the onsets of the bursts; length: of the chain of bursts.\n"
              "Path: to its nearest point; lag: the delay with the least RMS error."
            : "Path: to its nearest point; lag: the delay with the least RMS error;\n"
              "CV: standard deviation / mean; shared: a tactor serves two bursts.",
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

    // If one algorithm cannot play the strokes, its row says so. If no algorithm can play a burst, the
    // command line is wrong.
    static_cast<void>(burst_duration_s(s.plan));
    const layout faces(e.tactors);
    const std::string argument = stroke_arguments(s).front();
    if (e.plans.contains(argument))
        throw error(error_kind::bad_input, shown_name(argument),
                    "it is a plan, which tactor compare does not accept", "give the stroke");
    refuse_samples(argument);
    const piece p = open_piece(s, e, faces, argument);
    if (!asked.picture.file.empty() && p.strokes.size() > 1)
        refuse_option("-o", fmt::format("a picture shows one stroke, not {}", p.strokes.size()),
                      "give one stroke");
    if (!asked.picture.file.empty())
        plot::check_output(asked.picture.file, asked.picture.force);
    const std::vector<comparison> all = compare_all(p, e, faces, s.plan, std::move(choice));
    std::vector<std::string> titles;
    for (std::size_t i = 0; i < all.size(); ++i)
        titles.push_back(format_stroke_name(p, i, e));
    const auto playable = std::count_if(all.begin(), all.end(), [](const auto& c) { return c.playable(); });
    if (playable == 0)
        throw report_refusals(all, p);
    if (!asked.picture.file.empty()) {
        session::report_pipe_wait(asked.picture.file);
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
        throw report_refusals(all, p);
    return status_ok;
}

} // namespace

int run_compare(command_line& line)
{
    compare_options o;
    CLI::App& c = line.app;
    add_stroke_argument(line);
    settings& s = add_options(line, options::on_compare);
    c.get_option("STROKE")->description("preset (park2016-1 ... park2016-4; wave-2x4 and round-2x4 on "
                                        "palm-2x4), file (.toml, .csv, .svg, .tact, .haptic, .ahap), "
                                        "or - for such a file on standard input; not a plan");
    auto* algorithms = add_text_option(
        c, "--algorithms", join_enum_names<algorithm_kind>(), "algorithms to compare (default all three)",
        [&o](const std::string& t) { o.choice.algorithms = parse_list<algorithm_kind>("--algorithms", t); });
    auto* phantoms =
        add_text_option(c, "--phantoms", join_enum_names<phantom_kind>(),
                        "phantom models to compare (default: that of --phantom)", [&o](const std::string& t) {
                            o.choice.phantoms = parse_list<phantom_kind>("--phantoms", t);
                        });
    c.get_option("--algorithm")
        ->description("compare only this algorithm; see --algorithms")
        ->excludes(algorithms);
    c.get_option("--phantom")->excludes(phantoms);
    add_format_option(c, o.format, {"text", "json"}, "format of the output (default text)");
    add_text_option(c, "-o,--output", "FILE.svg|.png|.pdf",
                    "also draw target and prediction on the array, and speed over time",
                    [&o](const std::string& t) {
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
