// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>
#include <set>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/commands.hpp"
#include "cli/compare/compare_output.hpp"
#include "cli/input.hpp"
#include "cli/option_words.hpp"
#include "cli/picture_options.hpp"
#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "cli/warnings.hpp"
#include "core/kind_names.hpp"
#include "core/split.hpp"
#include "files/plan/plan_json.hpp"
#include "plot/compare_figure.hpp"
#include "plot/paint/output.hpp"
#include "session/pipes.hpp"

namespace tactor::cli {
namespace {

using detail::comparison;
using detail::comparison_choice;
using detail::comparison_row;

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
            throw error(error_kind::bad_input, option, fmt::format("\"{}\" is not known", name),
                        "one or more of " + join_names<Enum>());
        if (std::find(list.begin(), list.end(), *v) != list.end())
            throw error(error_kind::bad_input, option, fmt::format("\"{}\" is there twice", name),
                        "name each once");
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

void add_lists(CLI::App& c, const std::shared_ptr<compare_options>& o)
{
    auto* algorithms = add_text(
        c, "--algorithms", join_names<algorithm_kind>(), "algorithms to compare (default all three)",
        [o](const std::string& t) { o->choice.algorithms = parse_list<algorithm_kind>("--algorithms", t); });
    auto* phantoms = add_text(
        c, "--phantoms", join_names<phantom_kind>(), "phantom models to compare (default: that of --phantom)",
        [o](const std::string& t) { o->choice.phantoms = parse_list<phantom_kind>("--phantoms", t); });
    c.get_option("--algorithm")->description("only this one; see --algorithms")->excludes(algorithms);
    c.get_option("--phantom")->excludes(phantoms);
    add_format_option(c, o->format, {"text", "json", "csv"}, "format of the output (default text)");
}

void add_output_options(CLI::App& c, const std::shared_ptr<compare_options>& o)
{
    add_text(c, "-o,--output", "FILE.svg|.png|.pdf",
             "also draw target and prediction on the array, and speed over time", [o](const std::string& t) {
                 plot::find_format(t);
                 o->picture.file = t;
                 o->choice.keep_samples = true;
             });
    add_picture_options(c, o->picture, "85, one print column");
}

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
    const piece p = read_one_piece(s, e, faces);
    if (!asked.picture.file.empty() && p.strokes.size() > 1)
        throw error(error_kind::bad_input, "-o", fmt::format("there are {} strokes", p.strokes.size()),
                    "a picture shows one");
    if (!asked.picture.file.empty())
        plot::check_output(asked.picture.file, asked.picture.force);
    const std::vector<comparison> all = compare_all(p, e, faces, s.plan, std::move(choice));
    std::vector<std::string> titles;
    for (std::size_t i = 0; i < all.size(); ++i)
        titles.push_back(name_stroke(p, i));
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
    else if (asked.format == "csv")
        print_csv(stdout, all);
    else
        print_text(stdout, all, titles, e.tactors);
    if (static_cast<std::size_t>(playable) < all.size())
        throw why_refused(all, p);
    return status_ok;
}

} // namespace

command add_compare(CLI::App& app)
{
    CLI::App* c = app.add_subcommand("compare", "Compare predictions of what algorithms feel like");
    auto s = std::make_shared<settings>();
    auto asked = std::make_shared<compare_options>();
    add_strokes(*c, *s);
    add_options(*c, *s, options::on_compare);
    c->get_option("STROKE")->description(
        "preset (park2016-1 ... park2016-4; wave-2x4 and round-2x4 on palm-2x4), "
        "file (.toml, .csv, .svg), or - for such a file on standard input; no plan: it is planned here");
    add_lists(*c, asked);
    add_output_options(*c, asked);
    c->footer("tactor compare park2016-3\n"
              "tactor compare park2016-3 --phantoms inverse-distance,barycentric\n"
              "tactor compare --shape line --observer low-speed -o line.svg");
    const CLI::Option* algorithm = c->get_option("--algorithm");
    return [s, asked, algorithm] {
        return run_with(*s, [&] { return run(*s, *asked, algorithm->count() != 0); });
    };
}

} // namespace tactor::cli
