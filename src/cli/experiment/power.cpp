// SPDX-License-Identifier: MIT
#include "cli/experiment/power.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <tactor/version.hpp>

#include "cli/experiment/experiment_options.hpp"
#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "core/members.hpp"
#include "core/sha256.hpp"
#include "core/split.hpp"
#include "core/words.hpp"
#include "files/json/json_value.hpp"
#include "files/json/schema.hpp"
#include "files/text_file.hpp"
#include "options/option.hpp"
#include "session/process.hpp"
#include "study/analysis/power.hpp"
#include "study/bids/disk.hpp"
#include "study/experiment/simulated.hpp"
#include "study/session/experiment_session.hpp"
#include "study/statistics/tests.hpp"
#include "study/tasks/task.hpp"

namespace tactor::cli {
namespace {

using json = nlohmann::ordered_json;

constexpr detail::bounds allowed_studies{1, 1000000};
constexpr detail::bounds allowed_participants{2, 1000};

std::vector<std::size_t> parse_participants(std::string_view text)
{
    std::vector<std::size_t> all;
    for (const std::string_view part : detail::split(text, ',')) {
        all.push_back(static_cast<std::size_t>(
            options::parse_whole("--power", std::string(part), allowed_participants, "")));
        if (std::count(all.begin(), all.end(), all.back()) > 1)
            refuse_option("--power", fmt::format("{} occurs twice", all.back()), "name each number once");
    }
    return all;
}

std::string comparison_text(const study::run_outline& r)
{
    return find_run_task(r).name_comparison(r).text;
}

// Returns a description of a figure's test between the levels of a factor.
std::string comparison_text(const study::tested_power& t)
{
    if (t.factor.starts_with("group"))
        return fmt::format("{} by {} ({}), participants in each, analysis of variance", t.figure, t.factor,
                           fmt::join(t.levels, ", "));
    return t.levels.size() == 2 ? fmt::format("{} by {}, {} - {}, paired t against 0", t.figure, t.factor,
                                              t.levels.front(), t.levels.back())
                                : fmt::format("{} by {}, analysis of variance (p_gg)", t.figure, t.factor);
}

// Result for one number of participants, as it is printed.
struct listed_power {
    study::power_at counts = {};
    double power = 0.0;
    std::array<double, 2> ci = {};
};

std::vector<listed_power> list_powers(const study::tested_power& t, std::size_t studies)
{
    std::vector<listed_power> all;
    for (const study::power_at& at : t.at) {
        const study::interval ci = study::binomial_interval(at.significant, studies);
        all.push_back(
            {at, static_cast<double>(at.significant) / static_cast<double>(studies), {ci.first, ci.second}});
    }
    return all;
}

void print_power_text(const study::prepared_experiment& e, const std::vector<study::run_power>& all,
                      std::size_t studies, const study::simulation& s)
{
    say(stdout,
        "{}: {} SIMULATED studies ({}): they say what the design can find if the model is right,\n"
        "and nothing about people\n",
        e.definition.outline.name, studies, study::to_text(s));
    for (const study::run_power& p : all) {
        const study::run_outline& r = e.definition.runs[p.run].outline;
        const auto has_main = [](const study::tested_power& t) { return t.factor.empty(); };
        if (std::ranges::none_of(p.tests, has_main))
            say(stdout, "\n{}: {}\n", r.name, comparison_text(r));
        for (const study::tested_power& t : p.tests) {
            say(stdout, "\n{}: {}\n", r.name, has_main(t) ? comparison_text(r) : comparison_text(t));
            say(stdout, "  {:>12} {:>11} {:>15} {:>11} {:>8}\n", "participants", "p < 0.05 in", "95 %",
                "for last in", "untested");
            for (const listed_power& one : list_powers(t, studies))
                say(stdout, "  {:>12} {:>9.1f} % {:>15} {:>9.1f} % {:>8}\n", one.counts.participants,
                    100.0 * one.power, fmt::format("{:.1f} ... {:.1f}", 100.0 * one.ci[0], 100.0 * one.ci[1]),
                    100.0 * static_cast<double>(one.counts.for_last) / static_cast<double>(studies),
                    one.counts.untested);
        }
    }
}

// Describes the counts for one number of participants. Files of --part also contain them.
template <class Io>
void describe_count_members(Io& io, const study::power_at& at)
{
    constexpr detail::about significant{
        "studies with a p below alpha, and among these the studies in which the mean was above the value "
        "compared with, or the last level's mean above the first's"};
    io("participants", at.participants, {"participants of each study", {2, detail::from_0.high}});
    io("significant", at.significant, significant);
    io("for_last", at.for_last, significant);
    io("untested", at.untested, {"studies without a test"});
}

template <class Io, detail::either<listed_power> Power>
void members(Io& io, Power& v)
{
    constexpr detail::about share{"significant / studies, and both ends of its exact binomial 95 % interval",
                                  {0.0, 1.0}};
    describe_count_members(io, v.counts);
    io("power", v.power, share);
    io("ci", v.ci, share);
}

// A test of a figure between the levels of a factor.
struct listed_test {
    std::string factor = {};
    std::string figure = {};
    std::string comparison = {};
    std::vector<listed_power> power = {};
};

template <class Io, detail::either<listed_test> Test>
void members(Io& io, Test& v)
{
    io("factor", v.factor,
       {"what the levels are: method, session or group; group:method is how groups differ in methods"});
    io("figure", v.figure, {"the figure, such as jnd"});
    io("comparison", v.comparison, {"the test, in words"});
    io("power", v.power, {"by the requested numbers of participants"});
}

struct listed_run_power {
    std::string name = {};
    std::string task = {};
    std::string comparison = {};
    std::vector<listed_power> power = {};
    std::vector<listed_test> comparisons = {};
};

template <class Io, detail::either<listed_run_power> Run>
void members(Io& io, Run& v)
{
    constexpr detail::about names{"name, and task"};
    io("name", v.name, names);
    io.one_of("task", v.task, study::task_names(), names);
    io("comparison", v.comparison, {"the comparison, in words"});
    io("power", v.power, {"by the requested numbers of participants; empty if there is nothing to compare"});
    io("comparisons", v.comparisons,
       {"each figure between methods, sessions and groups, as analyze tests it"});
}

struct listed_powers {
    experiment_name experiment = {};
    std::string simulation = {};
    std::size_t studies = 0;
    std::vector<listed_run_power> runs = {};
    std::vector<std::string> warnings = {};
};

template <class Io, detail::either<listed_powers> Powers>
void members(Io& io, Powers& v)
{
    io.constant("schema", "tactor-power/1");
    io.describe_derived("simulated", [] { return true; }, {"true: a model answered"});
    io("experiment", v.experiment, {"the experiment"});
    io("simulation", v.simulation, {"the observers, as --simulate accepts them"});
    io("studies", v.studies, {"number of simulated studies", detail::above_0});
    io.describe_derived("alpha", [] { return study::significant_p; },
                        {"a p below this is significant", {0.0, 1.0}});
    io("runs", v.runs, {"in the order of the definition"});
    io("warnings", v.warnings, {"warnings: unusual values that were accepted"});
}

void print_power_json(const study::prepared_experiment& e, const std::vector<study::run_power>& all,
                      std::size_t studies, const study::simulation& s)
{
    listed_powers listed{make_experiment_name(e.definition), study::to_text(s), studies, {}, e.warnings};
    for (const study::run_power& p : all) {
        const study::run_outline& r = e.definition.runs[p.run].outline;
        listed.runs.push_back({r.name, std::string(find_run_task(r).name()), comparison_text(r)});
        for (const study::tested_power& t : p.tests) {
            if (t.factor.empty())
                listed.runs.back().power = list_powers(t, studies);
            else
                listed.runs.back().comparisons.push_back(
                    {t.factor, t.figure, comparison_text(t), list_powers(t, studies)});
        }
    }
    fmt::print("{}", study::json_text(files::make_document(listed)));
}

std::size_t read_count(const files::json_value& v)
{
    const double n = v.need_number();
    if (n < 0.0 || n > allowed_studies.high || n != std::floor(n))
        v.refuse("it is not a whole number from 0 on");
    return static_cast<std::size_t>(n);
}

// Returns the members that all parts of one simulation, and the merged result, have in common.
json describe_parts(const study::prepared_experiment& e, const experiment_options& o)
{
    std::string stimuli;
    for (const study::stimulus& s : e.stimuli.all())
        stimuli += s.hash;
    return {{"schema", "tactor-power-part/1"},
            {"version", std::string(version())},
            {"definition", detail::sha256_text(e.definition.text)},
            {"group", files::or_null(e.definition.group)},
            {"stimuli", detail::sha256_text(stimuli)},
            {"simulation", study::to_text(*o.simulate)},
            {"seed", files::or_null(o.session.seed)},
            {"studies", o.studies},
            {"participants", o.power}};
}

void write_part(const std::string& file, json j, const study::power_request& asked,
                const std::vector<study::run_power>& all)
{
    j["part"] = asked.part;
    j["parts"] = asked.parts;
    j["runs"] = json::array();
    for (const study::run_power& p : all) {
        j["runs"].push_back(json::array());
        for (const study::tested_power& t : p.tests)
            for (const study::power_at& at : t.at)
                j["runs"].back().push_back(
                    files::make_object([&at](auto& io) { describe_count_members(io, at); }));
    }
    study::write_whole_file(file, study::json_text(j));
}

// Refuses to replace a file that is not a part of the same simulation with the same number. Such a file may
// be the result of hours of work.
void check_replaced_part(const std::string& file, const json& common, const study::power_request& asked)
{
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored) || std::filesystem::is_empty(file, ignored))
        return;
    std::ifstream stream(file); // not read_text_file(): it would note an input, which cannot be replaced
    const json there = json::parse(stream, nullptr, false);
    if (!there.is_object() || there.value("schema", json()) != common.at("schema"))
        throw error(error_kind::bad_input, file, "it exists, and tactor did not write it",
                    "name another file, or remove this one");
    json own = common;
    own["part"] = asked.part;
    own["parts"] = asked.parts;
    for (const auto& [key, value] : own.items())
        if (there.value(key, json()) != value)
            throw error(
                error_kind::bad_input, file,
                fmt::format("it holds part {} of {}{}", there.value("part", json()).dump(),
                            there.value("parts", json()).dump(),
                            common.contains(key) ? fmt::format(" of studies with a different {}", key) : ""),
                "name another file, or remove this one");
}

// Adds the counts of a part to those of other parts. Refuses a sum that is above the number of studies.
void add_counts(std::vector<study::run_power>& all, const files::json_value& runs, std::size_t studies)
{
    const std::vector<files::json_value> theirs = runs.need_list();
    if (theirs.size() != all.size())
        runs.refuse("the number of runs is not that of this experiment");
    for (std::size_t run = 0; run < all.size(); ++run) {
        const std::vector<files::json_value> counts = theirs[run].need_list();
        const std::size_t sizes = all[run].tests.empty() ? 0 : all[run].tests.front().at.size();
        if (counts.size() != all[run].tests.size() * sizes)
            theirs[run].refuse("the number of tests or sample sizes is not that of this simulation");
        for (std::size_t i = 0; i < counts.size(); ++i) {
            study::power_at& at = all[run].tests[i / sizes].at[i % sizes];
            for (const auto& [key, sum] : {std::pair("significant", &at.significant),
                                           {"for_last", &at.for_last},
                                           {"untested", &at.untested}}) {
                *sum += read_count(counts[i][key]);
                if (*sum > studies)
                    counts[i][key].refuse("it exceeds the number of studies");
            }
        }
    }
}

// Merges the parts of a simulation. The result is equal to that of a single run. \throws error (bad_input)
// naming the file.
void merge_parts(std::vector<study::run_power>& all, const json& common,
                 const std::vector<std::string>& names)
{
    std::map<std::size_t, std::string> seen;
    std::size_t parts = 0;
    for (const std::string& name : names) {
        const json own = json::parse(std::string_view(detail::read_text_file(name, detail::max_setup_bytes)),
                                     nullptr, false);
        const files::json_value part(own, name, "give only files that --part wrote for this simulation");
        part.need_members();
        for (const auto& [key, value] : common.items())
            if (const std::string its = own.value(key, json()).dump(), here = value.dump(); its != here)
                part[key].refuse(its.size() < 60 && here.size() < 60
                                     ? fmt::format("it is {}, but this simulation has {}", its, here)
                                     : "it is not that of this simulation");
        const std::size_t number = read_count(part["part"]);
        const std::size_t of = read_count(part["parts"]);
        if (parts != 0 && of != parts)
            part["parts"].refuse(fmt::format("it is {}, but {} has {}", of, names.front(), parts));
        parts = of;
        if (number < 1 || number > parts)
            part["part"].refuse(fmt::format("{} of {} is impossible", number, parts));
        if (const auto [at, is_new] = seen.emplace(number, name); !is_new)
            part["part"].refuse(fmt::format("part {} is also in {}", number, at->second));
        add_counts(all, part["runs"], common.at("studies").get<std::size_t>());
    }
    for (std::size_t k = 1; k <= parts; ++k)
        if (!seen.contains(k))
            refuse_option("--merge", fmt::format("part {}/{} is missing", k, parts),
                          "give the files of all parts");
}

// Runs the simulation. Returns nothing if a signal ends it.
std::optional<std::vector<study::run_power>> simulate(const study::prepared_experiment& e,
                                                      const study::power_request& asked, int& signal)
{
    session::interrupt stop;
    progress_line line("--power");
    std::size_t begun = 0;
    return study::simulate_power(e.definition, e.stimuli, asked, [&] {
        line.update(begun++, asked.studies / asked.parts);
        signal = stop.poll();
        return signal == 0;
    });
}

std::pair<std::size_t, std::size_t> parse_part(std::string_view text)
{
    const std::size_t slash = std::min(text.find('/'), text.size());
    const std::size_t part = detail::parse_number_text<std::size_t>(text.substr(0, slash)).value_or(0);
    const std::size_t parts =
        slash < text.size() ? detail::parse_number_text<std::size_t>(text.substr(slash + 1)).value_or(0) : 0;
    if (part < 1 || part > parts)
        refuse_option("--part", fmt::format("\"{}\" is not a part", text),
                      "give K/N with K from 1 to N, such as 3/100");
    return {part, parts};
}

} // namespace

void add_power_options(CLI::App& command, experiment_options& o)
{
    begin_group(command, "Power");
    CLI::Option* power =
        add_text_option(command, "--power", "N[,N...]",
                        "print how often simulated studies of N participants find a significant difference",
                        [&o](const std::string& t) { o.power = parse_participants(t); });
    power->needs(command.get_option("--simulate"));
    for (const char* other : {"--participant", "--resume", "--new", "--session", "--order", "--display",
                              "--page", "--keypad", "--masker", "--check-noise", "--print", "--dry-run"})
        power->excludes(command.get_option(other));
    add_text_option(
        command, "--studies", "K",
        fmt::format("--power: number of simulated studies (default {})", study::power_request{}.studies),
        [&o](const std::string& t) {
            o.studies = static_cast<std::size_t>(options::parse_whole("--studies", t, allowed_studies, ""));
        })
        ->needs(power);
    CLI::Option* part =
        add_text_option(command, "--part", "K/N", "--power: simulate part K of N and write it to -o FILE",
                        [&o](const std::string& t) { std::tie(o.part, o.parts) = parse_part(t); });
    part->needs(power)->needs(command.get_option("--output"));
    command.add_option("--merge", o.merge, "--power: join the files of all parts")
        ->type_name("FILE")
        ->expected(1, -1)
        ->needs(power)
        ->excludes(part);
    begin_group(command);
}

int print_power(const study::prepared_experiment& e, const experiment_options& o)
{
    if (o.parts > o.studies)
        refuse_option(
            "--part",
            fmt::format("{} parts are too many for {}", o.parts, counted(o.studies, "study", "studies")),
            "give each part at least one study");
    study::power_request asked{*o.simulate,    o.power, o.studies,
                               o.session.seed, o.part,  std::max<std::size_t>(o.parts, 1)};
    const json common = describe_parts(e, o);
    if (o.parts != 0) { // check now, not after hours
        check_replaced_part(o.folder, common, asked);
        study::check_file_creation(o.folder);
    }
    if (!o.merge.empty())
        asked.studies = 0; // the files contain the counts
    int signal = 0;
    auto powers = simulate(e, asked, signal);
    if (!powers) {
        say(stderr, "tactor: ended by a signal before there was a result\n");
        return session::interrupt::status(signal);
    }
    if (!o.merge.empty())
        merge_parts(*powers, common, o.merge);
    if (o.parts != 0)
        write_part(o.folder, common, asked, *powers);
    else if (o.format == "json")
        print_power_json(e, *powers, o.studies, *o.simulate);
    else
        print_power_text(e, *powers, o.studies, *o.simulate);
    return 0;
}

nlohmann::ordered_json power_schema()
{
    listed_powers all;
    return files::json_schema::describe_object([&all](auto& io) { members(io, all); });
}

} // namespace tactor::cli
