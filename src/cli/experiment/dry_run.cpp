// SPDX-License-Identifier: MIT
// Option --dry-run of tactor experiment. It lists all trials of a session in order, as text or JSON.
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <tactor/render.hpp>

#include "cli/experiment/experiment_options.hpp"
#include "cli/say.hpp"
#include "core/members.hpp"
#include "core/sha256.hpp"
#include "core/words.hpp"
#include "files/json/json_value.hpp"
#include "files/json/schema.hpp"
#include "study/session/experiment_session.hpp"
#include "study/session/session_record.hpp"
#include "study/tasks/task.hpp"

namespace tactor::cli {
namespace {

using detail::about;
using detail::either;

// Returns the value of a trial. Returns nothing for a trial of a track, because its value depends on earlier
// answers.
std::optional<double> find_planned_value(const study::prepared_experiment& p, const study::planned_trial& t)
{
    return t.track > 0 ? std::nullopt : study::find_value(p.definition, t);
}

// Counts the trials of a run for each value. Trials without a stimulus come first. The result is empty if the
// run has no values.
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

// A trial whose value is known before the session.
struct listed_trial {
    study::trial_row row = {};
    double rest_s = 0.0;
};

template <class Io, either<listed_trial> Trial>
void members(Io& io, Trial& v)
{
    constexpr about methods{"methods of the stimuli; the second is null if there is only one stimulus, the "
                            "third is only in runs that have it"};
    constexpr about plans{"SHA-256 of the stimuli's plans"};
    const study::trial_row& r = v.row;
    io("trial", r.trial, {"place, from 1", detail::above_0});
    io("motion", r.motion, {"target"});
    io("method_1", r.method_1, methods);
    io.describe_or_null("method_2", detail::omit_empty(r.method_2), methods);
    io("method_3", detail::omit_empty(r.method_3), methods);
    io.describe_or_null(
        "value", r.value,
        {"value of the comparison, in a run that varies one, for adjust at the start; null if the answers "
         "choose it"});
    io.describe_or_null("track", r.track, {"track of an adaptive run, from 1; else null", detail::above_0});
    io("duration_s", r.duration_s,
       {"duration from the first frame to the last, including the gap", detail::from_0});
    io("rest_s", v.rest_s, {"pause before the trial", detail::from_0});
    io("plan_1", r.plan_1, plans);
    io.describe_or_null("plan_2", detail::omit_empty(r.plan_2), plans);
    io("plan_3", detail::omit_empty(r.plan_3), plans);
}

struct counted_value {
    std::optional<double> value = {};
    std::size_t trials = 0;
};

template <class Io, either<counted_value> Value>
void members(Io& io, Value& v)
{
    constexpr about what{"value, null for trials without a stimulus, and number of trials"};
    io.describe_or_null("value", v.value, what);
    io("trials", v.trials, {what.text, detail::above_0});
}

struct listed_run {
    std::string name = {};
    std::string file_name = {};
    std::string task = {};
    std::optional<std::string> attribute = {};
    std::string question = {};
    bool animation = false;
    double min_response_s = 0.0;
    std::optional<study::rating_scale> scale = {};
    double break_s = 0.0;
    study::run_time time = {};
    bool may_end_early = false;
    std::vector<counted_value> values = {};
    std::vector<listed_trial> practice = {};
    std::vector<listed_trial> trials = {};
};

template <class Io, either<listed_run> Run>
void members(Io& io, Run& v)
{
    constexpr about names{"name, its letters and digits, the task, and the attribute (or null)"};
    constexpr about introduced{"the question, and whether the target appears first"};
    constexpr about waiting{"number of trials that wait for max_drive_s, and their waits together; part of "
                            "duration_s",
                            detail::from_0};
    io("name", v.name, names);
    io("file_name", v.file_name, names);
    io.one_of("task", v.task, study::task_names(), names);
    io.describe_or_null("attribute", v.attribute, names);
    io("question", v.question, introduced);
    io("animation", v.animation, introduced);
    io("min_response_s", v.min_response_s, {"answers sooner than this are marked early", detail::from_0});
    io.describe_or_null("scale", v.scale, {"for rate: the highest rating, or vas; else null"});
    io("break_s", v.break_s, {"break after the run", detail::from_0});
    io("duration_s", v.time.total_s,
       {"duration of the run with its practice, without the time for answers", detail::from_0});
    io("waits", v.time.waits, waiting);
    io("waits_s", v.time.waits_s, waiting);
    io("may_end_early", v.may_end_early,
       {"whether tracks may end before all trials are played; trials and duration_s are then the most"});
    io("values", v.values,
       {"trials by value; empty if the run varies none, or if the answers choose the values"});
    io("practice", v.practice, {"practice trials, which do not count"});
    io("trials", v.trials, {"trials that count"});
}

struct listed_questionnaire {
    std::string name = {};
    std::string when = {};
    std::vector<std::string> items = {};
};

template <class Io, either<listed_questionnaire> Form>
void members(Io& io, Form& v)
{
    constexpr about what{"name, time, and the names of its items"};
    io("name", v.name, what);
    io("when", v.when, what);
    io("items", v.items, what);
}

struct listed_code {
    unsigned code = 0;
    std::vector<std::string> meanings = {};
};

template <class Io, either<listed_code> Code>
void members(Io& io, Code& v)
{
    io("code", v.code, {"number", {1, 255}});
    io("meanings", v.meanings, {"events that it marks"});
}

using rest_time = std::variant<double, std::array<double, 2>>;

struct dry_run {
    experiment_name experiment = {};
    std::string participant = {};
    std::optional<std::string> group = {};
    study::session_number session = {};
    std::size_t order_row = 1;
    std::uint64_t seed = 0;
    std::string array = {};
    study::listed_level level = {};
    bool thresholds_assumed = false;
    unsigned rate = 0;
    double gap_s = 0.0;
    rest_time rest_s = {};
    std::optional<study::listed_noise> masking = {};
    std::vector<listed_run> runs = {};
    std::vector<listed_questionnaire> questionnaires = {};
    std::vector<study::listed_stimulus> stimuli = {};
    std::vector<listed_code> codes = {};
    std::vector<std::string> warnings = {};
};

template <class Io, either<dry_run> Run>
void members(Io& io, Run& v)
{
    io.constant("schema", "tactor-experiment/1");
    io("experiment", v.experiment, {"the experiment"});
    io("participant", v.participant, {"code"});
    io.describe_or_null("group", v.group, {"group of the participant; null in a definition without groups"});
    io("session", v.session,
       {"number of the session; only for a definition with several sessions", detail::above_0});
    io("order_row", v.order_row, {"row of the orders, from 1", detail::above_0});
    io("seed", v.seed, {"seed of the trials"});
    io("array", v.array, {"name of the array"});
    io("level", v.level, {"level of the walk, and of stimuli without their own"});
    io("thresholds_assumed", v.thresholds_assumed, {"whether a threshold was assumed, not measured"});
    io("rate", v.rate, {"sample rate, Hz", detail::above_0});
    io("gap_s", v.gap_s, {"gap between two stimuli", detail::from_0});
    io("rest_s", v.rest_s,
       {"rest before each trial; a list of the smallest and the largest if it is drawn", detail::from_0});
    io.describe_or_null("masking", v.masking, {"noise that hides the sound of the array, or null"});
    io("runs", v.runs, {"in the participant's order"});
    io("questionnaires", v.questionnaires, {"in the order of the definition"});
    io("stimuli", v.stimuli, {"all stimuli"});
    io("codes", v.codes, {"numbers that [sync] code sends; empty without it"});
    io("warnings", v.warnings, {"warnings: unusual values that were accepted"});
}

std::vector<listed_trial> list_trials(const study::prepared_experiment& p, const study::run_definition& r,
                                      const std::vector<study::planned_trial>& trials)
{
    std::vector<listed_trial> all;
    for (const study::planned_trial& t : trials) {
        all.push_back({study::planned_row(p, r, t, {static_cast<unsigned>(all.size() + 1)}), t.rest_s});
        all.back().row.value = find_planned_value(p, t);
    }
    return all;
}

listed_run list_run(const study::prepared_experiment& p, const study::run_sequence& s,
                    const study::run_time& t)
{
    const study::run_definition& r = p.definition.runs[s.run];
    const study::task& task = find_run_task(r.outline);
    listed_run all{r.outline.name,
                   r.outline.file_name,
                   std::string(task.name()),
                   detail::omit_empty(r.attribute),
                   r.outline.question,
                   r.animation,
                   r.min_response_s,
                   task.scale(r.outline),
                   r.break_s,
                   t,
                   r.outline.adaptive.may_end_early()};
    for (const auto& [value, trials] : count_values(p, s))
        all.values.push_back({value, trials});
    all.practice = list_trials(p, r, s.practice);
    all.trials = list_trials(p, r, s.trials);
    return all;
}

dry_run list_dry_run(const study::prepared_experiment& p)
{
    const study::experiment_definition& d = p.definition;
    dry_run all{make_experiment_name(d),
                p.participant,
                detail::omit_empty(d.group),
                d.session,
                p.row,
                p.seed,
                p.where.tactors.name,
                study::list_level(p.render),
                p.assumed,
                p.render.rate,
                d.gap_s};
    if (d.rest.is_random())
        all.rest_s = std::array{d.rest.least_s, d.rest.most_s};
    else
        all.rest_s = d.rest.least_s;
    all.masking = study::list_noise(d.masking);
    const std::vector<study::run_time> times = study::session_times(p);
    for (std::size_t i = 0; i < p.runs.size(); ++i)
        all.runs.push_back(list_run(p, p.runs[i], times[i]));
    for (const study::questionnaire& q : d.outline.questionnaires) {
        all.questionnaires.push_back({q.name, std::string(describe_time(q.when))});
        for (const study::questionnaire_item& item : q.items)
            all.questionnaires.back().items.push_back(item.name);
    }
    all.stimuli = study::list_stimuli(p);
    for (const auto& [number, meanings] : p.codes.meanings())
        all.codes.push_back({number, meanings});
    all.warnings = p.warnings;
    return all;
}

std::string time_text(const study::run_time& t)
{
    std::string text = fmt::format("{:.0f} s without the answers", t.total_s);
    if (t.waits != 0)
        text += fmt::format(", including waits of {:.0f} s before {}", t.waits_s, counted(t.waits, "trial"));
    return text;
}

// Returns the text as a cell of a column that only runs with three stimuli have; "" for other runs.
std::string third_stimulus_cell(const study::run_definition& r, const std::string& text)
{
    return r.stimuli > 2 ? fmt::format("{:<16} ", text) : "";
}

std::string level_text(const render_options& o)
{
    return o.sl_db ? fmt::format("{} dB SL", *o.sl_db) : fmt::format("{} dBFS", o.level_dbfs);
}

} // namespace

void print_dry_run_json(const study::prepared_experiment& p)
{
    fmt::print("{}\n", files::make_document(list_dry_run(p)).dump(1));
}

nlohmann::ordered_json dry_run_schema()
{
    dry_run all;
    return files::json_schema::describe_object([&all](auto& io) { members(io, all); });
}

void print_dry_run_text(const study::prepared_experiment& p)
{
    const study::experiment_definition& d = p.definition;
    say(stdout, "{}: {}\nparticipant {}{}, row {} of {}, seed {}, array {}, level {}\n", d.outline.name,
        d.title, p.participant,
        (d.group.empty() ? "" : ", group " + d.group) +
            (d.session ? fmt::format(", session {} of {}", *d.session, d.outline.sessions) : ""),
        p.row, study::count_rows(d), p.seed, make_printable(p.where.tactors.name), level_text(p.render));
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
    const auto row = [&](const study::run_definition& run, const study::planned_trial& t,
                         const std::string& place) {
        const study::trial_row r = study::planned_row(p, run, t, {});
        const std::optional<double> v = find_planned_value(p, t);
        say(stdout, "{:>8}  {:<16} {:<16} {:<16} {}{:>8} {:>7.3f}\n", place, r.motion, r.method_1,
            r.method_2.empty() ? "-" : r.method_2, third_stimulus_cell(run, r.method_3),
            v             ? plain_number(*v)
            : t.track > 0 ? fmt::format("track {}", t.track)
                          : "-",
            r.duration_s);
    };
    const std::vector<study::run_time> times = study::session_times(p);
    for (std::size_t i = 0; i < p.runs.size(); ++i) {
        const study::run_sequence& s = p.runs[i];
        const study::run_definition& r = d.runs[s.run];
        const char* const most = r.outline.adaptive.may_end_early() ? "at most " : "";
        say(stdout, "\nrun {} of {}: {} ({}{}), {}{}, {}{}\n{}\n", i + 1, p.runs.size(), r.outline.name,
            find_run_task(r.outline).name(), r.animation ? ", animation" : "", most,
            counted(s.trials.size(), "trial"), most, time_text(times[i]), r.outline.question);
        std::vector<std::string> values;
        for (const auto& [value, trials] : count_values(p, s))
            values.push_back(
                fmt::format("{} in {}", value ? plain_number(*value) : "none", counted(trials, "trial")));
        if (!values.empty())
            say(stdout, "{}", wrap_text(r.outline.vary + ": ", fmt::format("{}", fmt::join(values, ", "))));
        say(stdout, "{:>8}  {:<16} {:<16} {:<16} {}{:>8} {:>7}\n", "trial", "motion", "method_1", "method_2",
            third_stimulus_cell(r, "method_3"), "value", "s");
        for (const study::planned_trial& t : s.practice)
            row(r, t, "practice");
        for (std::size_t k = 0; k < s.trials.size(); ++k)
            row(r, s.trials[k], fmt::format("{}", k + 1));
    }
}

} // namespace tactor::cli
