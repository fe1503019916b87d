// SPDX-License-Identifier: MIT
#include "study/session/prepared.hpp"

#include <optional>
#include <utility>

#include <fmt/format.h>

#include "files/plan/plan_json.hpp"
#include "session/device.hpp"
#include "study/session/array_walk.hpp"
#include "study/session/calibration_facts.hpp"
#include "study/session/limit_check.hpp"

namespace tactor::study {
namespace {

// Returns what `tactor plan --format json` prints of a stroke.
std::string plan_text(const session::environment& e, const render_options& o, const stroke& s, const plan& p,
                      const score& sounds)
{
    const placed_plan one{p, std::nullopt};
    return files::plans_text({{&s, 1}, {&one, 1}, {}, nullptr, e.tactors, sounds, o});
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

} // namespace

prepared_experiment prepare(const session_request& r, session::settings& s)
{
    experiment_definition d = load_definition(r.definition);
    if (!s.array_name)
        s.array_name = d.array;
    session::environment e = session::read_environment(s);
    const bool assumed = !d.level_dbfs && assume_thresholds(e.tactors, r.who != audience::person);
    render_options render = session::settle_render(s, e);
    if (d.level_dbfs)
        render.level_dbfs = *d.level_dbfs;
    else
        render.sl_db = d.sl_db;
    // --dry-run needs no participant.
    const std::string code = r.participant.empty() ? "01" : r.participant;
    const std::uint64_t seed = r.seed.value_or(d.seed.value_or(seed_of(code)));
    auto runs = make_sequence(d, code, seed);
    stimulus_set stimuli(d, e.tactors, render, [&](const stroke& k, const plan& p, const score& sounds) {
        return plan_text(e, render, k, p, sounds);
    });
    if (r.who != audience::observer)
        check_walk(d, e.tactors, render);
    check_limits(d, runs, stimuli, session::settle_limits({}, e));
    std::vector<std::string> doubts;
    if (!d.level_dbfs)
        doubts = calibration_doubts(r.participant, e, stimuli);
    std::vector<std::string> warnings = stimuli.warnings();
    warnings.insert(warnings.end(), doubts.begin(), doubts.end());
    if (assumed)
        warnings.push_back(
            fmt::format("tactors without a threshold: {} dBFS is taken for it", assumed_threshold_dbfs));
    const std::string pcm = r.who == audience::person
                                ? session::device_options(s, {}, e, render.channels, render.rate).pcm
                                : "null";
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

} // namespace tactor::study
