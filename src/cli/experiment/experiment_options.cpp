// SPDX-License-Identifier: MIT
#include "cli/experiment/experiment_options.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <tactor/render.hpp>

#include "cli/experiment/power.hpp"
#include "cli/say.hpp"
#include "cli/session/page_options.hpp"
#include "cli/settings.hpp"
#include "core/sha256.hpp"
#include "core/words.hpp"
#include "files/json/json_value.hpp"
#include "options/option.hpp"
#include "study/bids/study_folder.hpp"
#include "study/experiment/simulated.hpp"
#include "study/session/experiment_session.hpp"
#include "study/tasks/task.hpp"

namespace tactor::cli {
namespace {

using json = nlohmann::ordered_json;

// Returns the value of a trial; none for one of a track, which the answers choose.
std::optional<double> find_planned_value(const study::prepared_experiment& p, const study::planned_trial& t)
{
    return t.track > 0 ? std::nullopt : study::find_value(p.definition, t);
}

// Counts the trials of a run by value, those without a stimulus first; empty if the run has no values.
std::map<std::optional<double>, std::size_t> count_values(const study::prepared_experiment& p,
                                                          const study::run_sequence& s)
{
    std::map<std::optional<double>, std::size_t> counts;
    const study::run_outline& r = p.definition.runs[s.run].outline;
    for (const study::planned_trial& t : s.trials)
        if (!r.vary.empty() && t.track == 0)
            ++counts[find_planned_value(p, t)];
    return counts;
}

json trials_json(const study::prepared_experiment& p, const std::vector<study::planned_trial>& trials)
{
    json all = json::array();
    for (const study::planned_trial& t : trials) {
        const study::trial_row r = study::planned_row(p, t, {static_cast<unsigned>(all.size() + 1)});
        all.push_back({{"trial", r.trial},
                       {"motion", r.motion},
                       {"method_1", r.method_1},
                       {"method_2", files::or_null(r.method_2)},
                       {"value", files::or_null(find_planned_value(p, t))},
                       {"track", t.track > 0 ? json(t.track) : json(nullptr)},
                       {"duration_s", r.duration_s},
                       {"rest_s", t.rest_s},
                       {"plan_1", r.plan_1},
                       {"plan_2", files::or_null(r.plan_2)}});
    }
    return all;
}

json run_json(const study::prepared_experiment& p, const study::run_sequence& s, const study::run_time& t)
{
    const study::run_definition& r = p.definition.runs[s.run];
    json j{{"name", r.outline.name},
           {"file_name", r.outline.file_name},
           {"task", std::string(task_in(r.outline).name())}};
    j["attribute"] = files::or_null(r.attribute);
    j["question"] = r.outline.question;
    j["animation"] = r.animation;
    j["min_response_s"] = r.min_response_s;
    j["scale"] = task_in(r.outline).scale(r.outline);
    j["break_s"] = r.break_s;
    j["duration_s"] = t.total_s;
    j["waits"] = t.waits;
    j["waits_s"] = t.waits_s;
    j["values"] = json::array();
    for (const auto& [value, trials] : count_values(p, s))
        j["values"].push_back({{"value", files::or_null(value)}, {"trials", trials}});
    j["practice"] = trials_json(p, s.practice);
    j["trials"] = trials_json(p, s.trials);
    return j;
}

std::string time_text(const study::run_time& t)
{
    std::string text = fmt::format("{:.0f} s without the answers", t.total_s);
    if (t.waits != 0)
        text += fmt::format(", including waits of {:.0f} s before {}", t.waits_s, counted(t.waits, "trial"));
    return text;
}

std::string level_text(const render_options& o)
{
    return o.sl_db ? fmt::format("{} dB SL", *o.sl_db) : fmt::format("{} dBFS", o.level_dbfs);
}

} // namespace

void add_experiment_options(CLI::App& command, experiment_options& o)
{
    command
        .add_option("EXPERIMENT", o.session.definition,
                    "park2016, or the file of a definition, see tactor-experiment(5)")
        ->required()
        ->type_name("");
    add_text(command, "--participant", "CODE", "the participant: letters and digits",
             [&o](const std::string& t) {
                 study::check_code(t);
                 o.session.participant = t;
             });
    command.add_option("-o,--output", o.folder, "folder of the study (BIDS), the same for all participants")
        ->type_name("DIR");
    CLI::Option* resume =
        command.add_flag("--resume", o.resume, "continue the participant's session at its next trial");
    add_text(command, "--hand", "left|right",
             "hand that wears the array; left mirrors the motions that the definition marks",
             [&o](const std::string& t) {
                 o.session.hand = choose("--hand", t, {"left", "right"}) == 0 ? study::hand_kind::left
                                                                              : study::hand_kind::right;
             });
    command.add_option("--group", o.session.group, "the participant's group, for a definition with groups")
        ->type_name("NAME");
    add_text(command, "--session", "N", "number of the session, for a definition with several",
             [&o](const std::string& t) {
                 o.session.session = static_cast<unsigned>(options::parse_whole("--session", t, {1, 99}, ""));
             });
    add_text(
        command, "--order", "N",
        "row of the orders, such as that of a replaced participant (default: from the code)",
        [&o](const std::string& t) { // prepare() knows how many there are
            o.session.row = static_cast<std::size_t>(options::parse_whole("--order", t, {1, 1000000}, ""));
        });
    add_page_options(command, o.page);
    add_keypad_option(command, o.keypads);
    CLI::Option* masker = add_masker_option(
        command, o.masker, "play the definition's masking noise on this second device, in stereo");
    CLI::Option* check = command
                             .add_flag("--check-noise", o.check_noise,
                                       "play the masking noise with stimuli until its level is right")
                             ->needs(masker)
                             ->excludes(resume);
    command.add_flag("--allow-sound-server", o.allow_sound_server,
                     "allow a sound server, which may hide xruns; the data record it");
    add_text(
        command, "--seed", "N", "seed of the order of trials (default: the definition's, else from the code)",
        [&o](const std::string& t) {
            constexpr double most = (std::uint64_t{1} << 53) - 1;
            o.session.seed = static_cast<std::uint64_t>(options::parse_whole("--seed", t, {0, most}, ""));
        });
    add_text(command, "--simulate", "SPEC", "let a model answer: seed=1,sigma=1", [&o](const std::string& t) {
        o.simulate = study::parse_simulation(t);
    })->excludes(check);
    command.add_flag("--print", o.print, "print the definition, for you to copy and edit")->excludes(resume);
    command.add_flag("--dry-run", o.dry_run, "check everything and list each trial in order, without sound")
        ->excludes(resume);
    add_format_option(command, o.format, {"text", "json"}, "format of --dry-run and --power (default text)");
    add_power_options(command, o);
}

void check_experiment_options(const settings& s, const experiment_options& o)
{
    const bool power = !o.power.empty();
    if (o.format == "json" && !o.dry_run && !power)
        refuse_option("--format", "only --dry-run and --power use it", "leave it out");
    if (const std::string asked = asked_of_stream(s); !asked.empty() && (o.simulate || o.print || o.dry_run))
        refuse_option(asked, "a simulated session plays nothing", "leave it out");
    check_page_options(o.page, o.simulate.has_value() && !o.print && !o.dry_run);
    if (power && !o.folder.empty() && o.parts == 0)
        refuse_option("-o", "--power prints its result", "add --part K/N, or leave it out");
    if (o.print || o.dry_run || o.check_noise || power)
        return;
    if (o.simulate && !o.keypads.empty())
        refuse_option("--keypad", "a simulated session has no participant at a display",
                      "leave one of them out");
    if (o.session.participant.empty())
        refuse_option("--participant", "the participant is missing",
                      "give a code of letters and digits, as P07");
    if (o.folder.empty())
        refuse_option("-o", "the folder for the data is missing", "give the folder of the study");
}

void print_dry_run_json(const study::prepared_experiment& p)
{
    json j{{"schema", "tactor-experiment/1"}};
    const study::experiment_definition& d = p.definition;
    j["experiment"] = {{"name", d.outline.name}, {"title", d.title}, {"sha256", detail::sha256_text(d.text)}};
    j["participant"] = p.participant;
    j["group"] = files::or_null(d.group);
    if (d.session)
        j["session"] = *d.session;
    j["order_row"] = p.row;
    j["seed"] = p.seed;
    j["array"] = p.where.tactors.name;
    j["level"] = study::level_facts(p.render);
    j["thresholds_assumed"] = p.assumed;
    j["rate"] = p.render.rate;
    j["gap_s"] = d.gap_s;
    j["rest_s"] = d.rest.is_random() ? json{d.rest.least_s, d.rest.most_s} : json(d.rest.least_s);
    j["masking"] = study::masking_facts(d.masking);
    j["runs"] = json::array();
    const std::vector<study::run_time> times = study::session_times(p);
    for (std::size_t i = 0; i < p.runs.size(); ++i)
        j["runs"].push_back(run_json(p, p.runs[i], times[i]));
    j["questionnaires"] = json::array();
    for (const study::questionnaire& q : d.outline.questionnaires) {
        json items = json::array();
        for (const study::questionnaire_item& item : q.items)
            items.push_back(item.name);
        j["questionnaires"].push_back(
            {{"name", q.name}, {"when", std::string(describe_time(q.when))}, {"items", items}});
    }
    j["stimuli"] = study::stimulus_facts(p);
    j["codes"] = json::array();
    for (const auto& [number, meanings] : p.codes.meanings())
        j["codes"].push_back({{"code", number}, {"meanings", meanings}});
    j["warnings"] = p.warnings;
    fmt::print("{}\n", j.dump(1, ' ', false, json::error_handler_t::replace));
}

void print_dry_run_text(const study::prepared_experiment& p)
{
    const study::experiment_definition& d = p.definition;
    say(stdout, "{}: {}\nparticipant {}{}, row {} of {}, seed {}, array {}, level {}\n", d.outline.name,
        d.title, p.participant,
        (d.group.empty() ? "" : ", group " + d.group) +
            (d.session ? fmt::format(", session {} of {}", *d.session, d.outline.sessions) : ""),
        p.row, study::count_rows(d), p.seed, p.where.tactors.name, level_text(p.render));
    for (const study::method_definition& m : d.methods)
        if (m.has_level() && !m.is_variant())
            say(stdout, "method {}: level {}\n", m.name, level_text(m.options.render));
    for (const study::stimulus& s : p.stimuli.all())
        if (s.weakened_db < 0.0)
            say(stdout,
                "motion {} with method {}: weakened by {:.2f} dB, so that no tactor exceeds the level\n",
                d.motions[s.motion].name, d.methods[s.method].name, -s.weakened_db);
    for (const study::questionnaire& q : d.outline.questionnaires)
        say(stdout, "questionnaire {}: {}, {}\n", q.name, describe_time(q.when),
            counted(q.items.size(), "item"));
    for (const auto& [number, meanings] : p.codes.meanings())
        say(stdout, "code {}: {}\n", number, fmt::join(meanings, "; "));
    const auto row = [&](const study::planned_trial& t, const std::string& place) {
        const study::trial_row r = study::planned_row(p, t, {});
        const std::optional<double> v = find_planned_value(p, t);
        say(stdout, "{:>8}  {:<16} {:<16} {:<16} {:>8} {:>7.3f}\n", place, r.motion, r.method_1,
            r.method_2.empty() ? "-" : r.method_2,
            v             ? plain_number(*v)
            : t.track > 0 ? fmt::format("track {}", t.track)
                          : "-",
            r.duration_s);
    };
    const std::vector<study::run_time> times = study::session_times(p);
    for (std::size_t i = 0; i < p.runs.size(); ++i) {
        const study::run_sequence& s = p.runs[i];
        const study::run_definition& r = d.runs[s.run];
        say(stdout, "\nrun {} of {}: {} ({}{}), {}, {}\n{}\n", i + 1, p.runs.size(), r.outline.name,
            task_in(r.outline).name(), r.animation ? ", animation" : "", counted(s.trials.size(), "trial"),
            time_text(times[i]), r.outline.question);
        std::vector<std::string> values;
        for (const auto& [value, trials] : count_values(p, s))
            values.push_back(
                fmt::format("{} in {}", value ? plain_number(*value) : "none", counted(trials, "trial")));
        if (!values.empty())
            say(stdout, "{}", wrapped(r.outline.vary + ": ", fmt::format("{}", fmt::join(values, ", "))));
        say(stdout, "{:>8}  {:<16} {:<16} {:<16} {:>8} {:>7}\n", "trial", "motion", "method_1", "method_2",
            "value", "s");
        for (const study::planned_trial& t : s.practice)
            row(t, "practice");
        for (std::size_t k = 0; k < s.trials.size(); ++k)
            row(s.trials[k], fmt::format("{}", k + 1));
    }
}

} // namespace tactor::cli
