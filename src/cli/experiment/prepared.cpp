// SPDX-License-Identifier: MIT
#include "cli/experiment/prepared.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <new>
#include <utility>

#include <fmt/format.h>

#include "cli/experiment/array_walk.hpp"
#include "cli/experiment/calibration_facts.hpp"
#include "cli/experiment/limit_check.hpp"
#include "cli/json_values.hpp"
#include "cli/plan/plan_output.hpp"
#include "cli/plan/plan_sound.hpp"
#include "cli/play/play_options.hpp"
#include "cli/say.hpp"
#include "core/words.hpp"
#include "study/random/sha256.hpp"

namespace tactor::cli {
namespace {

using json = nlohmann::ordered_json;

// What `tactor plan --format json` prints of a stroke.
std::string plan_text(const environment& e, const render_options& o, const stroke& s, const plan& p,
                      const score& sounds)
{
    char* bytes = nullptr;
    std::size_t size = 0;
    std::FILE* f = ::open_memstream(&bytes, &size);
    if (f == nullptr)
        throw std::bad_alloc();
    const piece one{s.name, {s}, {{p, std::nullopt}}};
    print_json(f, one, e, sounds, o);
    const bool written = std::fclose(f) == 0;
    const std::unique_ptr<char, decltype(&std::free)> owner(bytes, &std::free);
    if (!written)
        throw std::bad_alloc();
    return {bytes, size};
}

// -40 dBFS where nobody measured, at no frequency, and nobody feels it. A real session needs what was
// measured.
bool assume_thresholds(array& a, bool nobody_feels)
{
    std::vector<std::size_t> missing;
    for (std::size_t i = 0; i < a.tactors.size(); ++i)
        if (!a.tactors[i].threshold_dbfs && a.tactors[i].thresholds.empty())
            missing.push_back(i);
    if (missing.empty())
        return false;
    if (!nobody_feels)
        throw error(
            error_kind::bad_input, "--array",
            fmt::format("tactor {} has no threshold, and the level is above the threshold", missing.front()),
            "--array FILE that tactor calibrate made");
    for (const std::size_t i : missing)
        a.tactors[i].threshold_dbfs = assumed_threshold_dbfs;
    return true;
}

json level_json(const study::experiment_definition& d)
{
    return {{"sl_db", d.level_dbfs ? json(nullptr) : json(d.sl_db)}, {"dbfs", or_null(d.level_dbfs)}};
}

json array_facts(const array& a)
{
    json tactors = json::array();
    for (const tactor_spec& t : a.tactors)
        tactors.push_back({{"x_mm", t.position.x_mm},
                           {"y_mm", t.position.y_mm},
                           {"channel", t.channel},
                           {"polarity", t.polarity},
                           {"gain_db", t.gain_db},
                           {"max_dbfs", t.max_dbfs},
                           {"threshold_dbfs", threshold_json(t)},
                           {"actuator", std::string(to_string(t.actuator))}});
    return {{"name", a.name}, {"tactors", tactors}};
}

json experiment_facts(const study::experiment_definition& d)
{
    return {{"name", d.name}, {"sha256", study::sha256_text(d.text)}, {"text", d.text}};
}

// Which stimulus is behind a hash.
json stimulus_facts(const prepared_experiment& p)
{
    json all = json::array();
    for (const study::run_definition& r : p.definition.runs)
        for (const std::size_t motion : r.motions)
            for (const std::size_t method : r.methods) {
                const json one{{"sha256", p.stimuli.at(motion, method).hash},
                               {"motion", p.definition.motions[motion].name},
                               {"method", p.definition.methods[method].name}};
                if (std::find(all.begin(), all.end(), one) == all.end())
                    all.push_back(one);
            }
    return all;
}

json run_names(const prepared_experiment& p)
{
    json names = json::array();
    for (const study::run_sequence& r : p.runs)
        names.push_back(p.definition.runs[r.run].outline.name);
    return names;
}

json masking_facts(const study::masking_definition& m)
{
    if (m.noise == study::noise_kind::none)
        return nullptr;
    return {{"noise", std::string(to_string(m.noise))},
            {"level_dbfs", m.level_dbfs},
            {"fade_s", m.fade_s},
            {"while", m.through_run ? "run" : "stimulus"}};
}

json trial_json(const prepared_experiment& p, const study::planned_trial& t, std::size_t place)
{
    const study::experiment_definition& d = p.definition;
    json j{{"trial", place},
           {"motion", d.motions[t.motion].name},
           {"method_1", d.methods[t.method_1].name},
           {"method_2", nullptr},
           {"duration_s", static_cast<double>(p.stimuli.frames(t)) / p.render.rate},
           {"plan_1", p.stimuli.at(t.motion, t.method_1).hash},
           {"plan_2", nullptr}};
    if (t.method_2) {
        j["method_2"] = d.methods[*t.method_2].name;
        j["plan_2"] = p.stimuli.at(t.motion, *t.method_2).hash;
    }
    return j;
}

json trials_json(const prepared_experiment& p, const std::vector<study::planned_trial>& trials)
{
    json all = json::array();
    for (const study::planned_trial& t : trials)
        all.push_back(trial_json(p, t, all.size() + 1));
    return all;
}

json run_json(const prepared_experiment& p, const study::run_sequence& s)
{
    const study::run_definition& r = p.definition.runs[s.run];
    json j{{"name", r.outline.name},
           {"file_name", r.outline.file_name},
           {"task", std::string(to_string(r.outline.task))}};
    j["attribute"] = or_null(r.attribute);
    j["question"] = r.question;
    j["animation"] = r.animation;
    j["scale"] = r.outline.task == study::task_kind::rate ? json(r.outline.scale) : json(nullptr);
    j["break_s"] = r.break_s;
    j["practice"] = trials_json(p, s.practice);
    j["trials"] = trials_json(p, s.trials);
    return j;
}

double total_s(const prepared_experiment& p, const study::run_sequence& s)
{
    double sum = 0.0;
    for (const study::planned_trial& t : s.trials) {
        sum += static_cast<double>(p.stimuli.frames(t)) / p.render.rate;
        if (p.definition.runs[s.run].animation)
            sum += p.definition.motions[t.motion].drawn.motion.duration_s();
    }
    return sum;
}

} // namespace

prepared_experiment prepare(const experiment_options& o, settings& s, option_list& options)
{
    study::experiment_definition d = study::load_definition(o.definition);
    if (!s.array_name)
        s.array_name = d.array;
    environment e = read_environment(s, options);
    const bool assumed = !d.level_dbfs && assume_thresholds(e.tactors, o.dry_run || o.simulate);
    render_options render = settle_render(s, e);
    if (d.level_dbfs)
        render.level_dbfs = *d.level_dbfs;
    else
        render.sl_db = d.sl_db;
    // --dry-run needs no participant.
    const std::string code = o.participant.empty() ? "01" : o.participant;
    const std::uint64_t seed = o.seed.value_or(d.seed.value_or(study::seed_of(code)));
    auto runs = study::make_sequence(d, code, seed);
    study::stimulus_set stimuli(d, e.tactors, render,
                                [&](const stroke& k, const plan& p, const score& sounds) {
                                    return plan_text(e, render, k, p, sounds);
                                });
    const bool real = !o.dry_run && !o.simulate;
    if (real || o.dry_run)
        check_walk(d, e.tactors, render);
    check_limits(d, runs, stimuli, limits_of({}, e));
    std::vector<std::string> doubts;
    if (!d.level_dbfs)
        doubts = calibration_doubts(o.participant, e, stimuli);
    std::vector<std::string> warnings = stimuli.warnings();
    warnings.insert(warnings.end(), doubts.begin(), doubts.end());
    if (assumed)
        warnings.push_back(
            fmt::format("tactors without a threshold: {} dBFS is taken for it", assumed_threshold_dbfs));
    const std::string pcm = real ? device_options(s, {}, e, render.channels, render.rate).pcm : "null";
    return {std::move(d),
            code,
            seed,
            std::move(e),
            pcm,
            render,
            assumed,
            std::move(runs),
            std::move(stimuli),
            std::move(warnings),
            std::move(doubts)};
}

json session_facts(const prepared_experiment& p, const experiment_options& o)
{
    json thresholds = json::array();
    for (const tactor_spec& t : p.where.tactors.tactors)
        thresholds.push_back(threshold_json(t));
    json j{{"schema", "tactor-session/1"}, {"participant", p.participant}};
    j["simulated"] = o.simulate.has_value();
    j["simulation"] = o.simulate ? json(study::to_text(*o.simulate)) : json(nullptr);
    j["seed"] = p.seed;
    j["order"] = run_names(p);
    j["level"] = level_json(p.definition);
    j["array"] = array_facts(p.where.tactors);
    j["thresholds_dbfs"] = thresholds;
    j["thresholds_assumed"] = p.assumed;
    j["calibration"] = calibration_facts(p);
    j["rate"] = p.render.rate;
    j["channels"] = p.render.channels;
    j["masking"] = masking_facts(p.definition.masking);
    j["masker"] = o.simulate || o.masker.empty() ? json(nullptr) : json(o.masker);
    j["stimuli"] = stimulus_facts(p);
    j["experiment"] = experiment_facts(p.definition);
    j["versions"] = {{"tactor", std::string(version())}, {"build", std::string(build_facts())}};
    j["device"] = o.simulate ? json(nullptr) : json(p.pcm);
    j["sound_server"] = nullptr;
    j["masker_sound_server"] = nullptr;
    j["streams"] = json::array();
    j["date"] = nullptr;
    return j;
}

void print_dry_run_json(std::FILE* out, const prepared_experiment& p)
{
    json j{{"schema", "tactor-experiment/1"}};
    const study::experiment_definition& d = p.definition;
    j["experiment"] = {{"name", d.name}, {"title", d.title}, {"sha256", study::sha256_text(d.text)}};
    j["participant"] = p.participant;
    j["seed"] = p.seed;
    j["array"] = p.where.tactors.name;
    j["level"] = level_json(d);
    j["thresholds_assumed"] = p.assumed;
    j["rate"] = p.render.rate;
    j["gap_s"] = d.gap_s;
    j["masking"] = masking_facts(d.masking);
    j["runs"] = json::array();
    for (const study::run_sequence& s : p.runs)
        j["runs"].push_back(run_json(p, s));
    j["stimuli"] = stimulus_facts(p);
    j["warnings"] = p.warnings;
    fmt::print(out, "{}\n", j.dump(1, ' ', false, json::error_handler_t::replace));
}

void print_dry_run_text(std::FILE* out, const prepared_experiment& p)
{
    const study::experiment_definition& d = p.definition;
    say_text(out, fmt::format("{}: {}\nparticipant {}, seed {}, array {}, level {}\n", d.name, d.title,
                              p.participant, p.seed, p.where.tactors.name,
                              d.level_dbfs ? fmt::format("{} dBFS", *d.level_dbfs)
                                           : fmt::format("{} dB SL", d.sl_db)));
    const auto row = [&](const study::planned_trial& t, const std::string& place) {
        say_text(out, fmt::format("{:>8}  {:<16} {:<16} {:<16} {:>7.3f}\n", place, d.motions[t.motion].name,
                                  d.methods[t.method_1].name, t.method_2 ? d.methods[*t.method_2].name : "-",
                                  static_cast<double>(p.stimuli.frames(t)) / p.render.rate));
    };
    for (std::size_t i = 0; i < p.runs.size(); ++i) {
        const study::run_sequence& s = p.runs[i];
        const study::run_definition& r = d.runs[s.run];
        say_text(out, fmt::format("\nrun {} of {}: {} ({}{}), {}, {:.0f} s without the answers\n{}\n", i + 1,
                                  p.runs.size(), r.outline.name, to_string(r.outline.task),
                                  r.animation ? ", animation" : "", counted(s.trials.size(), "trial"),
                                  total_s(p, s), r.question));
        say_text(out, fmt::format("{:>8}  {:<16} {:<16} {:<16} {:>7}\n", "trial", "motion", "method_1",
                                  "method_2", "s"));
        for (const study::planned_trial& t : s.practice)
            row(t, "practice");
        for (std::size_t k = 0; k < s.trials.size(); ++k)
            row(s.trials[k], fmt::format("{}", k + 1));
    }
}

} // namespace tactor::cli
