// SPDX-License-Identifier: MIT
#include "study/session/session_record.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/version.hpp>

#include "core/sha256.hpp"
#include "files/json/json_value.hpp"
#include "files/json/schema.hpp"
#include "study/session/sync_codes.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

std::optional<listed_calibration> list_calibration(const prepared_experiment& p)
{
    if (!p.where.config.calibration)
        return {};
    return listed_calibration{*p.where.config.calibration, p.calibration_doubts};
}

std::optional<listed_codes> list_codes(const prepared_experiment& p)
{
    const code_settings* const c = find_codes(p.where);
    if (c == nullptr)
        return {};
    listed_codes all;
    all.channel = c->channel;
    if (c->channel)
        all.bit_ms = c->bit_s * 1e3;
    if (!c->offsets.empty())
        all.lines = c->offsets;
    if (!c->serial.empty())
        all.serial = listed_serial{c->baud};
    if (c->lsl)
        all.lsl = true;
    if (!p.codes.meanings().empty())
        all.numbers.emplace();
    for (const auto& [number, meanings] : p.codes.meanings())
        all.numbers->all.emplace_back(fmt::format("{}", number),
                                      fmt::format("{}", fmt::join(meanings, "; ")));
    return all;
}

// Returns the rests before the trials of each run, s, in the order of the trials.
detail::by_name<std::vector<double>> list_rests(const prepared_experiment& p)
{
    detail::by_name<std::vector<double>> runs;
    for (const run_sequence& r : p.runs) {
        auto& [name, rests] =
            runs.all.emplace_back(p.definition.runs[r.run].outline.name, std::vector<double>{});
        for (const planned_trial& t : r.trials)
            rests.push_back(t.rest_s);
    }
    return runs;
}

// Returns the path that an observer is predicted to feel, with the strokes of the stimulus one after the
// other. Returns nothing if the observer makes no prediction for this stimulus.
std::optional<drawing> predict_drawing(const prepared_experiment& p, const stimulus& s, observer_kind who)
{
    const std::vector<stroke>& strokes = s.made.strokes;
    if (who == observer_kind::centroid)
        return join_paths(s.felt_paths, strokes);
    drawing d;
    double from_s = 0.0;
    for (std::size_t i = 0; i < strokes.size(); ++i) {
        const plan& own = s.made.plans[i].plan;
        if (own.curve)
            return {};
        for (const tap& t : predict_taps(p.where.tactors, strokes[i], own))
            d.push_back({from_s + t.onset_s, t.felt});
        from_s += strokes[i].motion.duration_s();
    }
    d = thin_out(std::move(d));
    return is_drawing(d) ? std::optional(std::move(d)) : std::nullopt;
}

// Returns the predictions for the runs in which participants draw; nothing without such runs.
std::optional<std::vector<listed_prediction>> list_predictions(const prepared_experiment& p)
{
    std::vector<listed_prediction> all;
    for (const stimulus& s : p.stimuli.all()) {
        const bool is_drawn = std::ranges::any_of(p.definition.runs, [&](const run_definition& r) {
            return find_run_task(r.outline).list_answers(r, p.definition.page).draws != drawing_kind::none &&
                   std::ranges::count(r.motions, s.motion) != 0 &&
                   std::ranges::count(r.methods, s.method) != 0;
        });
        for (const observer_kind who : {observer_kind::centroid, observer_kind::low_speed})
            if (const auto d = is_drawn ? predict_drawing(p, s, who) : std::nullopt)
                all.push_back({std::string(to_string(who)), p.definition.motions[s.motion].name,
                               p.definition.methods[s.method].name, to_text(*d)});
    }
    return all.empty() ? std::nullopt : std::optional(std::move(all));
}

} // namespace

listed_level list_level(const render_options& o)
{
    return {o.sl_db, o.sl_db ? std::nullopt : std::optional(o.level_dbfs)};
}

std::optional<listed_noise> list_noise(const masking_definition& m)
{
    if (!m.noise)
        return {};
    return listed_noise{std::string(to_string(m.noise->color)), m.noise->level_dbfs, m.noise->fade_s,
                        m.through_run ? "run" : "stimulus"};
}

std::vector<listed_stimulus> list_stimuli(const prepared_experiment& p)
{
    std::vector<listed_stimulus> all;
    for (const stimulus& s : p.stimuli.all()) {
        const method_definition& m = p.definition.methods[s.method];
        all.push_back({s.hash, p.definition.motions[s.motion].name, m.name, s.weakened_db, m.value,
                       m.has_level() ? std::optional(list_level(s.render)) : std::nullopt});
    }
    return all;
}

nlohmann::ordered_json describe_session(const prepared_experiment& p,
                                        const std::optional<simulation>& simulate, const std::string& masker)
{
    const experiment_definition& d = p.definition;
    session_record r;
    r.participant = p.participant;
    r.simulated = simulate.has_value();
    if (simulate)
        r.simulation = to_text(*simulate);
    r.seed = p.seed;
    r.group = detail::omit_empty(d.group);
    r.session = d.session;
    if (p.row != default_row(d, p.participant) ||
        std::ranges::any_of(d.runs, [](const auto& one) { return !one.blocks.empty(); }))
        r.order_row = p.row;
    for (const run_sequence& s : p.runs)
        r.order.push_back(d.runs[s.run].outline.name);
    r.level = list_level(p.render);
    if (p.hand)
        r.hand = *p.hand == hand_kind::left ? "left" : "right";
    if (d.rest.is_random())
        r.rests_s = list_rests(p);
    r.tactors = p.where.tactors;
    r.thresholds_assumed = p.assumed;
    r.calibration = list_calibration(p);
    r.codes = list_codes(p);
    r.rate = p.render.rate;
    r.channels = p.render.channels;
    r.masking = list_noise(d.masking);
    if (!simulate)
        r.masker = detail::omit_empty(masker);
    r.stimuli = list_stimuli(p);
    r.predictions = list_predictions(p);
    r.experiment = {d.outline.name, detail::sha256_text(d.text), d.text};
    r.versions = {std::string(version()), std::string(build_facts())};
    if (!simulate)
        r.device = p.pcm;
    return files::make_document(r);
}

nlohmann::ordered_json session_schema()
{
    const session_record r;
    return files::json_schema::describe_object([&r](auto& io) { members(io, r); });
}

} // namespace tactor::study
