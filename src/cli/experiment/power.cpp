// SPDX-License-Identifier: MIT
#include "cli/experiment/experiment_options.hpp"

#include <algorithm>
#include <optional>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <tactor/error.hpp>

#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "cli/warnings.hpp"
#include "core/sha256.hpp"
#include "core/split.hpp"
#include "session/interrupt.hpp"
#include "study/analysis/analysis.hpp"
#include "study/experiment/simulated.hpp"

namespace tactor::cli {
namespace {

using json = nlohmann::ordered_json;

constexpr std::size_t default_studies = 200;
constexpr std::size_t most_studies = 1000000;
constexpr std::size_t most_participants = 1000;

std::size_t count_in(const char* option, std::string_view text, std::size_t least, std::size_t most)
{
    const auto n = detail::number_in<std::size_t>(text);
    if (!n || *n < least || *n > most)
        refuse_option(option, fmt::format("\"{}\" is no such number", text),
                      fmt::format("a whole number from {} to {}", least, most));
    return *n;
}

std::vector<std::size_t> participants_in(std::string_view text)
{
    std::vector<std::size_t> all;
    for (const std::string_view part : detail::split(text, ',')) {
        all.push_back(count_in("--power", part, 2, most_participants));
        if (std::count(all.begin(), all.end(), all.back()) > 1)
            refuse_option("--power", fmt::format("{} is said twice", all.back()), "each number once");
    }
    return all;
}

std::string comparison_text(const study::run_outline& r)
{
    switch (r.task) {
    case study::task_kind::choose:
        return fmt::format("{} chosen, t against 50 %", r.methods.back());
    case study::task_kind::rate:
        return r.methods.size() < 2
                   ? std::string("one method: nothing to compare")
                   : fmt::format("{} less {}, paired t", r.methods.back(), r.methods.front());
    case study::task_kind::identify:
        break;
    }
    return fmt::format("{} correct, t against {:.2f} %", r.methods.back(), study::chance(r));
}

void print_power_text(const study::prepared_experiment& e, const std::vector<study::run_power>& all,
                      std::size_t studies, const study::simulation& s)
{
    say(stdout,
        "{}: {} SIMULATED studies ({}): this says what the design can do where the model is right,\n"
        "and nothing about people\n",
        e.definition.name, studies, study::to_text(s));
    for (const study::run_power& p : all) {
        const study::run_outline& r = e.definition.runs[p.run].outline;
        say(stdout, "\n{}: {}\n", r.name, comparison_text(r));
        if (!p.at.empty())
            say(stdout, "  {:>12} {:>11} {:>15} {:>11} {:>8}\n", "participants", "p < 0.05 in", "95 %",
                "for last in", "untested");
        for (const study::power_at& at : p.at)
            say(stdout, "  {:>12} {:>9.1f} % {:>15} {:>9.1f} % {:>8}\n", at.participants, 100.0 * at.power,
                fmt::format("{:.1f} ... {:.1f}", 100.0 * at.ci.first, 100.0 * at.ci.second),
                100.0 * static_cast<double>(at.for_last) / static_cast<double>(studies), at.untested);
    }
}

json run_power_json(const study::run_power& p, const study::run_outline& r)
{
    json j{{"name", r.name}, {"task", std::string(to_string(r.task))}, {"comparison", comparison_text(r)}};
    j["power"] = json::array();
    for (const study::power_at& at : p.at)
        j["power"].push_back({{"participants", at.participants},
                              {"significant", at.significant},
                              {"for_last", at.for_last},
                              {"untested", at.untested},
                              {"power", at.power},
                              {"ci", {at.ci.first, at.ci.second}}});
    return j;
}

void print_power_json(const study::prepared_experiment& e, const std::vector<study::run_power>& all,
                      std::size_t studies, const study::simulation& s)
{
    const study::experiment_definition& d = e.definition;
    json j{{"schema", "tactor-power/1"}, {"simulated", true}};
    j["experiment"] = {{"name", d.name}, {"title", d.title}, {"sha256", detail::sha256_text(d.text)}};
    j["simulation"] = study::to_text(s);
    j["studies"] = studies;
    j["alpha"] = study::significant_p;
    j["runs"] = json::array();
    for (const study::run_power& p : all)
        j["runs"].push_back(run_power_json(p, d.runs[p.run].outline));
    j["warnings"] = e.warnings;
    fmt::print("{}\n", j.dump(2, ' ', false, json::error_handler_t::replace));
}

// Returns nothing where a signal ends it.
std::optional<std::vector<study::run_power>> simulate(const study::prepared_experiment& e,
                                                      const study::power_request& asked, int& signal)
{
    session::interrupt stop;
    progress_line line("--power");
    std::size_t begun = 0;
    return study::simulate_power(e.definition, e.stimuli, asked, [&] {
        line.update(begun++, asked.studies);
        signal = stop.poll();
        return signal == 0;
    });
}

} // namespace

void add_power_options(CLI::App& command, power_options& p)
{
    begin_group(command, "Power");
    add_text(command, "--power", "N[,N...]",
             "print how often simulated studies of N participants find a significant difference",
             [&p](const std::string& t) { p.participants = participants_in(t); });
    add_text(command, "--studies", "K",
             fmt::format("--power: number of simulated studies (default {})", default_studies),
             [&p](const std::string& t) { p.studies = count_in("--studies", t, 1, most_studies); });
    begin_group(command);
}

void check_power_options(const settings& s, const power_options& p, const experiment_options& o)
{
    if (p.participants.empty()) {
        if (p.studies)
            refuse_option("--studies", "there is no --power", "it says how many studies --power simulates");
        return;
    }
    if (!o.simulate)
        refuse_option("--power", "it is not said who answers", "--simulate seed=1,sigma=1");
    const bool session = !o.participant.empty() || !o.folder.empty() || o.resume;
    if (session || o.dry_run || o.print)
        refuse_option("--power", "it holds no session, and writes nothing",
                      "leave out --participant, -o, --resume, --dry-run and --print");
    const std::string asked = asked_of_stream(s);
    if (!asked.empty() || o.check_noise || o.page.shown() || !o.masker.empty() || !o.keypads.empty())
        refuse_option("--power", "nothing is played, and nobody sits there",
                      fmt::format("leave out --check-noise, --masker, --display, --page, --keypad and {}",
                                  asked.empty() ? "--verbose" : asked));
}

int tell_power(const study::prepared_experiment& e, const power_options& p, const experiment_options& o)
{
    const std::size_t studies = p.studies.value_or(default_studies);
    int signal = 0;
    const auto told = simulate(e, {*o.simulate, p.participants, studies, o.seed}, signal);
    if (!told) {
        say(stderr, "tactor: ended by a signal, before there was a result\n");
        return session::interrupt::status(signal);
    }
    if (o.format == "json")
        print_power_json(e, *told, studies, *o.simulate);
    else
        print_power_text(e, *told, studies, *o.simulate);
    return 0;
}

} // namespace tactor::cli
