// SPDX-License-Identifier: MIT
#include "cli/experiment/experiment_options.hpp"

#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/say.hpp"
#include "core/sha256.hpp"
#include "core/words.hpp"
#include "files/json/json_value.hpp"
#include "study/session/prepared.hpp"
#include "study/session/trials.hpp"

namespace tactor::cli {
namespace {

using json = nlohmann::ordered_json;

json trials_json(const study::prepared_experiment& p, const std::vector<study::planned_trial>& trials)
{
    json all = json::array();
    for (const study::planned_trial& t : trials) {
        const study::trial_row r = study::planned_row(p, t, {static_cast<unsigned>(all.size() + 1)});
        all.push_back({{"trial", r.trial},
                       {"motion", r.motion},
                       {"method_1", r.method_1},
                       {"method_2", files::or_null(r.method_2)},
                       {"duration_s", r.duration_s},
                       {"rest_s", t.rest_s},
                       {"plan_1", r.plan_1},
                       {"plan_2", files::or_null(r.plan_2)}});
    }
    return all;
}

json time_json(const study::run_time& t)
{
    return {{"duration_s", t.total_s}, {"waits", t.waits}, {"waits_s", t.waits_s}};
}

json run_json(const study::prepared_experiment& p, const study::run_sequence& s, const study::run_time& t)
{
    const study::run_definition& r = p.definition.runs[s.run];
    json j{{"name", r.outline.name},
           {"file_name", r.outline.file_name},
           {"task", std::string(to_string(r.outline.task))}};
    j["attribute"] = files::or_null(r.attribute);
    j["question"] = r.question;
    j["animation"] = r.animation;
    j["min_response_s"] = r.min_response_s;
    j["scale"] = r.outline.task == study::task_kind::rate ? json(r.outline.scale) : json(nullptr);
    j["break_s"] = r.break_s;
    j.update(time_json(t));
    j["practice"] = trials_json(p, s.practice);
    j["trials"] = trials_json(p, s.trials);
    return j;
}

std::string time_text(const study::run_time& t)
{
    std::string text = fmt::format("{:.0f} s without the answers", t.total_s);
    if (t.waits != 0)
        text += fmt::format(", of which {:.0f} s are waits before {}", t.waits_s, counted(t.waits, "trial"));
    return text;
}

} // namespace

void print_dry_run_json(std::FILE* out, const study::prepared_experiment& p)
{
    json j{{"schema", "tactor-experiment/1"}};
    const study::experiment_definition& d = p.definition;
    j["experiment"] = {{"name", d.name}, {"title", d.title}, {"sha256", detail::sha256_text(d.text)}};
    j["participant"] = p.participant;
    j["seed"] = p.seed;
    j["array"] = p.where.tactors.name;
    j["level"] = study::level_facts(d);
    j["thresholds_assumed"] = p.assumed;
    j["rate"] = p.render.rate;
    j["gap_s"] = d.gap_s;
    j["rest_s"] = d.rest.is_random() ? json{d.rest.least_s, d.rest.most_s} : json(d.rest.least_s);
    j["masking"] = study::masking_facts(d.masking);
    j["runs"] = json::array();
    const std::vector<study::run_time> times = study::session_times(p, 0.0);
    for (std::size_t i = 0; i < p.runs.size(); ++i)
        j["runs"].push_back(run_json(p, p.runs[i], times[i]));
    j["stimuli"] = study::stimulus_facts(p);
    j["warnings"] = p.warnings;
    fmt::print(out, "{}\n", j.dump(1, ' ', false, json::error_handler_t::replace));
}

void print_dry_run_text(std::FILE* out, const study::prepared_experiment& p)
{
    const study::experiment_definition& d = p.definition;
    say_text(out, fmt::format("{}: {}\nparticipant {}, seed {}, array {}, level {}\n", d.name, d.title,
                              p.participant, p.seed, p.where.tactors.name,
                              d.level_dbfs ? fmt::format("{} dBFS", *d.level_dbfs)
                                           : fmt::format("{} dB SL", d.sl_db)));
    const auto row = [&](const study::planned_trial& t, const std::string& place) {
        const study::trial_row r = study::planned_row(p, t, {});
        say_text(out, fmt::format("{:>8}  {:<16} {:<16} {:<16} {:>7.3f}\n", place, r.motion, r.method_1,
                                  r.method_2.empty() ? "-" : r.method_2, r.duration_s));
    };
    const std::vector<study::run_time> times = study::session_times(p, 0.0);
    for (std::size_t i = 0; i < p.runs.size(); ++i) {
        const study::run_sequence& s = p.runs[i];
        const study::run_definition& r = d.runs[s.run];
        say_text(out, fmt::format("\nrun {} of {}: {} ({}{}), {}, {}\n{}\n", i + 1, p.runs.size(),
                                  r.outline.name, to_string(r.outline.task), r.animation ? ", animation" : "",
                                  counted(s.trials.size(), "trial"), time_text(times[i]), r.question));
        say_text(out, fmt::format("{:>8}  {:<16} {:<16} {:<16} {:>7}\n", "trial", "motion", "method_1",
                                  "method_2", "s"));
        for (const study::planned_trial& t : s.practice)
            row(t, "practice");
        for (std::size_t k = 0; k < s.trials.size(); ++k)
            row(s.trials[k], fmt::format("{}", k + 1));
    }
}

} // namespace tactor::cli
