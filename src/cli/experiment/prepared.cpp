// SPDX-License-Identifier: MIT
#include "cli/experiment/prepared.hpp"

#include <optional>
#include <utility>

#include <fmt/format.h>

#include "cli/experiment/array_walk.hpp"
#include "cli/experiment/calibration_facts.hpp"
#include "cli/experiment/limit_check.hpp"
#include "cli/play/play_options.hpp"
#include "files/plan/plan_json.hpp"

namespace tactor::cli {
namespace {

// Returns what `tactor plan --format json` prints of a stroke.
std::string plan_text(const environment& e, const render_options& o, const stroke& s, const plan& p,
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

} // namespace tactor::cli
