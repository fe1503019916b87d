// SPDX-License-Identifier: MIT
#include "study/experiment/stimuli.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/marks.hpp"
#include "core/sha256.hpp"
#include "files/plan/plan_json.hpp"
#include "study/experiment/definition.hpp"

namespace tactor::study {
namespace {

constexpr double longest_stimulus_s = 600.0;

// Returns the felt places at equal parts of the target's time. While nothing is felt, the last place counts,
// and before the first one that.
std::vector<point> sample_path(const std::vector<percept_sample>& samples)
{
    std::vector<point> felt;
    std::optional<point> last;
    for (const percept_sample& s : samples)
        if (s.felt && !last)
            last = s.felt;
    for (const percept_sample& s : samples) {
        last = s.felt ? s.felt : last;
        felt.push_back(last.value_or(s.target));
    }
    std::vector<point> parts;
    for (std::size_t i = 0; i <= path_parts; ++i)
        parts.push_back(felt[i * (felt.size() - 1) / path_parts]);
    return parts;
}

} // namespace

std::vector<point> target_path(const stroke& s)
{
    std::vector<point> parts;
    for (std::size_t i = 0; i <= path_parts; ++i)
        parts.push_back(s.motion.position(s.motion.duration_s() * static_cast<double>(i) / path_parts));
    return parts;
}

stimulus_set::stimulus_set(const experiment_definition& d, const array& a, const render_options& o)
    : array_(a), options_(o), gap_frames_(static_cast<std::uint64_t>(std::llround(d.gap_s * o.rate)))
{
    const layout faces(a);
    for (const run_definition& r : d.runs)
        for (const std::size_t motion : r.motions)
            for (const std::size_t method : r.methods)
                if (find(motion, method) == nullptr) {
                    all_.push_back(make(d.motions[motion], d.methods[method], faces));
                    all_.back().motion = motion;
                    all_.back().method = method;
                }
}

stimulus stimulus_set::make(const motion_definition& motion, const method_definition& method,
                            const layout& faces)
{
    try {
        if (motion.drawn.motion.duration_s() > longest_stimulus_s)
            throw error(error_kind::bad_input, "stroke", "it takes more than ten minutes", "a shorter one");
        const stroke& drawn = motion.drawn;
        const files::piece one{.strokes = {drawn},
                               .plans = {{make_plan(array_, faces, drawn, method.options), std::nullopt}}};
        const score sounds(array_, one.plans, options_);
        stimulus s;
        s.plan = one.plans.front().plan;
        s.frames = sounds.frames();
        s.text = files::plans_text({one, array_, sounds, options_});
        s.hash = detail::sha256_text(s.text);
        const std::vector<percept_sample> samples = predict_percept(array_, drawn, s.plan);
        s.felt = summarise(samples);
        s.felt_path = sample_path(samples);
        for (const std::string& w : s.plan.warnings) {
            const std::string warning =
                fmt::format("motion \"{}\" by method \"{}\": {}", motion.name, method.name, w);
            if (std::find(warnings_.begin(), warnings_.end(), warning) == warnings_.end())
                warnings_.push_back(warning);
        }
        return s;
    } catch (const error& e) {
        if (e.kind() != error_kind::bad_input)
            throw;
        throw error(e.kind(), motion.where,
                    fmt::format("motion \"{}\" by method \"{}\" (line {}): {}: {}", motion.name, method.name,
                                method.where.line, detail::plain(e.subject()), e.why()),
                    in_definition_words(e.hint()));
    }
}

const stimulus* stimulus_set::find(std::size_t motion, std::size_t method) const noexcept
{
    for (const stimulus& s : all_)
        if (s.motion == motion && s.method == method)
            return &s;
    return nullptr;
}

const stimulus& stimulus_set::at(std::size_t motion, std::size_t method) const
{
    return *find(motion, method);
}

std::uint64_t stimulus_set::second(const planned_trial& t) const
{
    return at(t.motion, t.method_1).frames + gap_frames_;
}

std::uint64_t stimulus_set::frames(const planned_trial& t) const
{
    return t.method_2 ? second(t) + at(t.motion, *t.method_2).frames : at(t.motion, t.method_1).frames;
}

score stimulus_set::make_score(const planned_trial& t, const std::optional<drive_limits>& limits) const
{
    std::vector<placed_plan> plans{{at(t.motion, t.method_1).plan, 0.0}};
    if (t.method_2)
        plans.push_back({at(t.motion, *t.method_2).plan, static_cast<double>(second(t)) / options_.rate});
    render_options o = options_;
    o.limits = limits;
    return score(array_, std::move(plans), o);
}

} // namespace tactor::study
