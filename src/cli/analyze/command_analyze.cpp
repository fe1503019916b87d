// SPDX-License-Identifier: MIT
// The commands that read a study: analyze and report.
#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <tactor/error.hpp>

#include "cli/analyze/analyze_output.hpp"
#include "cli/settings.hpp"
#include "core/split.hpp"
#include "plot/figure.hpp"
#include "plot/paint/output.hpp"
#include "session/process.hpp"
#include "study/analysis/analysis_json.hpp"
#include "study/bids/disk.hpp"
#include "study/data/dataset.hpp"
#include "study/report/report.hpp"

namespace tactor::cli {
namespace {

// Reads "A,B,...".
std::vector<std::string> parse_codes(const char* option, std::string_view text)
{
    std::vector<std::string> codes;
    for (const std::string_view code : detail::split(text, ',')) {
        if (code.empty())
            throw error(error_kind::bad_input, option, "a code is empty",
                        "codes with commas between, as 01,02");
        codes.emplace_back(code);
    }
    return codes;
}

// Reads "CODE:REASON,...": the reasons are optional, and have no comma.
void parse_excluded(std::string_view text, study::selection& who)
{
    for (const std::string& one : parse_codes("--exclude", text)) {
        const std::size_t colon = one.find(':');
        std::string& reason = who.without[one.substr(0, colon)];
        if (colon != one.npos)
            reason = one.substr(colon + 1);
    }
}

// Adds DIR, --participants and --exclude.
void add_study_options(CLI::App& command, std::string& folder, study::selection& who)
{
    command.add_option("DIR", folder, "folder of the study, as tactor experiment wrote it")->required();
    add_text(command, "--participants", "CODES", "participants to include (default all)",
             [&who](const std::string& t) { who.only = parse_codes("--participants", t); });
    add_text(command, "--exclude", "CODE[:REASON],...",
             "participants to leave out; the report names them with their reasons",
             [&who](const std::string& t) { parse_excluded(t, who); });
}

// Makes the folder for what is made of a study, derivatives/tactor in it, if `file` is to lie there.
void make_derivatives(const std::filesystem::path& folder, const std::filesystem::path& file)
{
    const std::filesystem::path ours = folder / "derivatives" / "tactor";
    std::error_code ignored;
    if (std::filesystem::weakly_canonical(std::filesystem::absolute(file, ignored).parent_path(), ignored) ==
        std::filesystem::weakly_canonical(std::filesystem::absolute(ours, ignored), ignored))
        std::filesystem::create_directories(ours, ignored);
}

// The error bars of a figure.
enum class error_bars { se, within, ci };

// Names in --bars and words in the figure's note, in the order of error_bars.
constexpr std::array<std::pair<const char*, const char*>, 3> all_error_bars{
    {{"se", "standard errors"},
     {"within", "95 % intervals within participants (Cousineau-Morey)"},
     {"ci", "95 % intervals of the means"}}};

struct analyze_options {
    std::string folder;
    std::string format = "text";
    error_bars bars = error_bars::se;
    study::sigmoid function = study::sigmoid::normal;
    picture_options picture{.width_mm = 170.0};
    study::selection who;
};

// Returns the ends of an error bar.
std::optional<study::interval> find_ends(const study::t_test& t, error_bars kind,
                                         const study::interval& possible)
{
    if (kind == error_bars::se)
        return t.se ? std::optional(study::interval{*t.mean - *t.se, *t.mean + *t.se}) : std::nullopt;
    const std::optional<study::interval>& i = kind == error_bars::within ? t.ci_within : t.ci;
    return i ? std::optional(study::cut_to(*i, possible)) : std::nullopt;
}

plot::bar_series make_bars(const std::string& name, const study::by_motion& b, error_bars kind,
                           const study::interval& possible)
{
    plot::bar_series s{name};
    for (std::size_t m = 0; m < b.motion.size(); ++m)
        s.bars.push_back({*b.motion[m].mean, find_ends(b.motion[m], kind, possible), b.motion_values[m]});
    s.bars.push_back({*b.all.mean, find_ends(b.all, kind, possible), b.all_values});
    return s;
}

plot::bar_panel make_panel(const study::run_analysis& r, error_bars kind)
{
    const study::interval possible = study::possible_values(r.run);
    plot::bar_panel p;
    p.title = fmt::format("{} (n = {})", r.run.name, r.n);
    p.groups = r.run.motions;
    p.groups.emplace_back("all");
    p.joined = r.run.motions.size();
    switch (r.run.task) {
    case study::task_kind::choose:
        p.level = 50.0;
        p.y_to = 100.0;
        if (has_worths(r.run)) {
            p.y_title = "chosen (% of its trials)";
            break;
        }
        p.y_title = fmt::format("{} chosen (%)", r.run.methods.back());
        p.series.push_back(make_bars("", r.cells[0], kind, possible));
        return p;
    case study::task_kind::rate:
        p.y_title = "mean rating";
        p.y_from = r.run.lowest_rating();
        p.y_to = r.run.scale;
        break;
    case study::task_kind::identify:
        p.y_title = "correct (%)";
        p.level = study::chance(r.run);
        p.y_to = 100.0;
        break;
    default:
        break;
    }
    for (std::size_t m = 0; m < r.run.methods.size(); ++m)
        p.series.push_back(make_bars(r.run.methods[m], r.cells[m], kind, possible));
    return p;
}

// Draws means with error bars and each participant by motion, a panel for each run, as the paper's figures 8
// and 9, and the answers of runs that identify.
plot::canvas draw_analysis(const study::analysis& a, const picture_options& o, error_bars kind)
{
    plot::bar_figure f;
    f.title = o.choose_title(a.experiment);
    f.heading = o.has_title();
    f.width_mm = o.width_mm;
    f.note = fmt::format("Means over participants; error bars: {}; dots and thin lines: participants.",
                         all_error_bars[static_cast<std::size_t>(kind)].second);
    f.across = a.simulated ? "simulated" : "";
    for (const study::run_analysis& r : a.runs) {
        if (r.n == 0 || find_task(r.run.task).measures)
            continue;
        f.panels.push_back(make_panel(r, kind));
        for (std::size_t m = 0; m < r.confusion.size(); ++m)
            f.matrices.push_back({fmt::format("{}: answers with {}", r.run.name, r.run.methods[m]), "played",
                                  "answered", r.run.motions, r.confusion[m]});
    }
    if (!f.matrices.empty())
        f.note += " Answers: their number, the darker the larger the share of the motion that was played.";
    return plot::draw_bar_figure(f);
}

void draw(const analyze_options& o, const study::analysis& a)
{
    if (std::all_of(a.runs.begin(), a.runs.end(), [](const study::run_analysis& r) { return r.n == 0; }))
        throw error(error_kind::bad_input, "-o", "there is nothing to draw",
                    "no run has a participant with a trial in each cell");
    plot::check_output(o.picture.file, o.picture.force);
    make_derivatives(o.folder, o.picture.file);
    session::tell_of_pipe_to_write(o.picture.file);
    plot::save(draw_analysis(a, o.picture, o.bars), o.picture.file, o.picture.dpi, o.picture.force);
}

int analyze(const analyze_options& o)
{
    const study::dataset d = study::read_dataset(o.folder, o.who);
    const study::analysis a = study::analyse(d, o.function);
    if (!o.picture.file.empty())
        draw(o, a);
    print_warnings(a);
    if (o.format == "json")
        fmt::print("{}", study::json_text(study::make_analysis_json(a)));
    else if (o.format == "tsv")
        print_trials(d);
    else if (o.format == "wide")
        print_wide(d, o.function);
    else
        print_analysis_text(a);
    return status_ok;
}

struct report_options {
    std::string folder;
    std::string file; // empty: standard output
    bool force = false;
    study::selection who;
};

int report(const report_options& o)
{
    const study::dataset d = study::read_dataset(o.folder, o.who);
    const study::study_facts f = study::read_facts(o.folder, d);
    const study::analysis a = study::analyse(d);
    const std::string text = study::methods_text(f, d, study::make_analysis_json(a));
    if (o.file.empty())
        fmt::print("{}", text);
    else {
        make_derivatives(o.folder, o.file);
        session::tell_of_pipe_to_write(o.file);
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
    add_study_options(c, o.folder, o.who);
    add_format_option(c, o.format, {"text", "json", "tsv", "wide"},
                      "format of the output; tsv has a line for each trial, for R; wide has a line for each "
                      "participant, for JASP and SPSS (default text)");
    add_text(c, "-o,--output", "FILE.svg|.png|.pdf",
             "also draw means with error bars, each participant, and the answers of identify",
             [&o](const std::string& t) {
                 plot::find_format(t);
                 o.picture.file = t;
             });
    add_text(c, "--bars", "se|within|ci",
             "error bars of the picture: standard errors, or 95 % intervals within participants or of the "
             "means (default se)",
             [&o](const std::string& t) {
                 std::vector<std::string> names;
                 for (const auto& [name, note] : all_error_bars)
                     names.emplace_back(name);
                 o.bars = static_cast<error_bars>(choose("--bars", t, names));
             });
    add_text(c, "--function", "normal|logistic",
             "shape of the psychometric functions (default normal, cumulative)", [&o](const std::string& t) {
                 o.function = static_cast<study::sigmoid>(choose("--function", t, {"normal", "logistic"}));
             });
    add_picture_options(c, o.picture, "170, the width of a page");
    c.footer("tactor analyze study\n"
             "tactor analyze study --format json -o study.pdf\n"
             "tactor analyze study --exclude 07:illness");
    line.parse();
    return analyze(o);
}

int run_report(command_line& line)
{
    report_options o;
    CLI::App& c = line.app;
    add_study_options(c, o.folder, o.who);
    add_text(c, "-o,--output", "FILE.md", "Markdown file to write (default: standard output)",
             [&o](const std::string& t) {
                 if (std::filesystem::path(t).extension() != ".md")
                     throw error(error_kind::bad_input, t, "the report is Markdown", "end the name in .md");
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
