// SPDX-License-Identifier: MIT
// The commands `analyze` and `report`, which read a study.
#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <tactor/error.hpp>

#include "cli/analyze/analyze_figure.hpp"
#include "cli/analyze/analyze_output.hpp"
#include "cli/settings.hpp"
#include "core/split.hpp"
#include "plot/paint/output.hpp"
#include "session/process.hpp"
#include "study/analysis/analysis.hpp"
#include "study/analysis/result_json.hpp"
#include "study/bids/dataset.hpp"
#include "study/bids/disk.hpp"
#include "study/report/report.hpp"

namespace tactor::cli {
namespace {

// Parses "A,B,...".
std::vector<std::string> parse_codes(const char* option, std::string_view text)
{
    std::vector<std::string> codes;
    for (const std::string_view code : detail::split(text, ',')) {
        if (code.empty())
            throw error(error_kind::bad_input, option, "a code is empty",
                        "separate codes by commas, such as 01,02");
        codes.emplace_back(code);
    }
    return codes;
}

// Parses "CODE:REASON,...". Reasons are optional, and cannot contain commas.
void parse_exclusions(std::string_view text, study::selection& who)
{
    for (const std::string& one : parse_codes("--exclude", text)) {
        const std::size_t colon = one.find(':');
        std::string& reason = who.without[one.substr(0, colon)];
        if (colon != one.npos)
            reason = one.substr(colon + 1);
    }
}

// Parses two response times, s.
std::pair<double, double> parse_times(std::string_view text)
{
    std::vector<double> times;
    for (const std::string_view one : detail::split(text, ','))
        times.push_back(detail::parse_number_text<double>(one).value_or(-1.0));
    constexpr double longest_s = 1e6;
    if (times.size() != 2 || !(times[0] >= 0.0 && times[0] < times[1] && times[1] <= longest_s))
        throw error(error_kind::bad_input, "--response-time",
                    fmt::format("\"{}\" is not a range of times", text),
                    "give the shortest and the longest, such as 0.2,5");
    return {times[0], times[1]};
}

// Adds the options that select participants and trials.
void add_selection(CLI::App& command, study::selection& who)
{
    add_text_option(command, "--participants", "CODES", "participants to include (default all)",
                    [&who](const std::string& t) { who.only = parse_codes("--participants", t); });
    add_text_option(command, "--exclude", "CODE[:REASON],...",
                    "participants to leave out; the report names them with their reasons",
                    [&who](const std::string& t) { parse_exclusions(t, who); });
    command.add_flag("--drop-early", who.drop_early,
                     "leave out trials whose answers are marked early (default: they count)");
    add_text_option(command, "--response-time", "S,S",
                    "leave out trials with a response time outside these two, in s",
                    [&who](const std::string& t) { who.response_time_s = parse_times(t); });
}

// Creates the folder for results of a study, derivatives/tactor, if `file` is in it.
void make_derivatives_folder(const std::filesystem::path& folder, const std::filesystem::path& file)
{
    const std::filesystem::path ours = folder / "derivatives" / "tactor";
    std::error_code ignored;
    if (std::filesystem::weakly_canonical(std::filesystem::absolute(file, ignored).parent_path(), ignored) ==
        std::filesystem::weakly_canonical(std::filesystem::absolute(ours, ignored), ignored))
        std::filesystem::create_directories(ours, ignored);
}

struct analyze_options {
    std::vector<std::filesystem::path> folders;
    std::string format = "text";
    error_bars bars = error_bars::se;
    study::sigmoid function = study::sigmoid::normal;
    picture_options picture{.width_mm = 170.0};
    study::selection who;
};

void draw(const analyze_options& o, const study::analysis& a)
{
    if (std::all_of(a.runs.begin(), a.runs.end(), [](const study::run_analysis& r) { return r.n == 0; }))
        throw error(error_kind::bad_input, "-o",
                    "there is nothing to draw: no participant has a trial in each cell of a run",
                    "leave out -o");
    plot::check_output(o.picture.file, o.picture.force);
    make_derivatives_folder(o.folders.front(), o.picture.file);
    session::report_pipe_wait(o.picture.file);
    plot::save(draw_analysis(a, o.picture, o.bars), o.picture.file, o.picture.dpi, o.picture.force);
}

int analyze(const analyze_options& o)
{
    const study::dataset d = study::read_dataset(o.folders, o.who);
    const study::analysis a = study::analyse(d, o.function);
    if (!o.picture.file.empty())
        draw(o, a);
    print_warnings(a);
    if (o.format == "json")
        fmt::print("{}", study::json_text(study::make_analysis_json(a)));
    else if (o.format == "tsv")
        print_trials(d);
    else if (o.format == "wide")
        print_wide_table(d, o.function);
    else if (o.format == "tables")
        print_tables(a);
    else
        print_summary(a);
    return status_ok;
}

struct report_options {
    std::string folder;
    std::string file; // empty for standard output
    bool force = false;
    study::selection who;
};

int report(const report_options& o)
{
    const study::dataset d = study::read_dataset({o.folder}, o.who);
    const study::study_facts f = study::read_facts(o.folder, d);
    const study::analysis a = study::analyse(d);
    const std::string text = study::methods_text(f, d, a);
    if (o.file.empty())
        fmt::print("{}", text);
    else {
        make_derivatives_folder(o.folder, o.file);
        session::report_pipe_wait(o.file);
        study::write_report(o.file, text, o.force);
    }
    print_warnings(a);
    return status_ok;
}

} // namespace

int run_analyze(command_line& line)
{
    analyze_options o;
    CLI::App& c = line.app;
    c.add_option("DIR", o.folders,
                 "folder of the study, as tactor experiment wrote it; several count as one study")
        ->required();
    add_selection(c, o.who);
    add_format_option(c, o.format, {"text", "tables", "json", "tsv", "wide"},
                      "format of the output: text has the main figure of each run, tables all figures; tsv "
                      "has a line for each trial, for R; wide has a line for each participant, for JASP and "
                      "SPSS (default text)");
    add_text_option(
        c, "-o,--output", "FILE.svg|.png|.pdf",
        "also draw means with error bars, psychometric functions, each participant, and the answers of "
        "identify",
        [&o](const std::string& t) {
            plot::find_format(t);
            o.picture.file = t;
        });
    add_text_option(
        c, "--bars", "se|within|ci",
        "error bars of the picture: standard errors, or 95 % intervals within participants or of the "
        "means (default se)",
        [&o](const std::string& t) {
            std::vector<std::string> names;
            for (const auto& [name, note] : all_error_bars)
                names.emplace_back(name);
            o.bars = static_cast<error_bars>(choose("--bars", t, names));
        });
    add_text_option(
        c, "--function", "normal|logistic",
        "shape of the psychometric functions (default normal, cumulative)", [&o](const std::string& t) {
            o.function = static_cast<study::sigmoid>(choose("--function", t, {"normal", "logistic"}));
        });
    add_picture_options(c, o.picture, "170, the width of a page");
    c.footer("tactor analyze study\n"
             "tactor analyze study --format tables\n"
             "tactor analyze study --format json -o study.pdf --exclude 07:illness");
    line.parse();
    return analyze(o);
}

int run_report(command_line& line)
{
    report_options o;
    CLI::App& c = line.app;
    c.add_option("DIR", o.folder, "folder of the study, as tactor experiment wrote it")->required();
    add_selection(c, o.who);
    add_text_option(c, "-o,--output", "FILE.md", "Markdown file to write (default: standard output)",
                    [&o](const std::string& t) {
                        if (std::filesystem::path(t).extension() != ".md")
                            throw error(error_kind::bad_input, t, "the report is Markdown",
                                        "end the name in .md");
                        o.file = t;
                    });
    add_force_option(c, o.force);
    c.footer("tactor report study\n"
             "tactor report study -o methods.md\n"
             "tactor report study --exclude 07:illness");
    line.parse();
    return report(o);
}

} // namespace tactor::cli
