// SPDX-License-Identifier: MIT
#include <tactor/percept.hpp>

#include <array>

#include <fmt/format.h>

#include "core/words.hpp"
#include "percept/percept_sounding.hpp"
#include "percept/person.hpp"
#include "percept/running_speed.hpp"
#include "percept/summaries.hpp"
#include "percept/summing.hpp"
#include "plan/rounded.hpp"

namespace tactor {
inline namespace v0 {
namespace {

std::size_t count_samples(double duration_s)
{
    if (!(duration_s <= longest_percept_s))
        throw error(error_kind::bad_input, "stroke",
                    fmt::format("lasts {}, too long to predict what is felt", seconds_text(duration_s)),
                    fmt::format("at most {} s", longest_percept_s));
    return static_cast<std::size_t>((duration_s + detail::same_time_s) / percept_step_s) + 1;
}

percept_sample target_at(const stroke& s, std::size_t i)
{
    percept_sample x;
    x.t_s = static_cast<double>(i) * percept_step_s;
    x.target = s.motion.position(x.t_s);
    x.target_intensity = s.motion.intensity(x.t_s);
    return x;
}

/// One plan, summed up while it is followed.
struct followed_plan {
    detail::sounding now;
    detail::running_speed speed = {};
    detail::summing sums = {};
};

} // namespace

void follow_percept(const array& a, const stroke& s, const plan& p, const person& who,
                    const std::function<void(const percept_sample&)>& each)
{
    constexpr std::size_t delay = detail::running_speed::delay;
    const std::size_t count = count_samples(s.motion.duration_s());
    const array felt = detail::felt_array(a, who);
    detail::sounding now(felt, p, s.motion.duration_s(), detail::gains_of(a, who));
    detail::running_speed speed;
    std::array<percept_sample, delay + 1> waiting; // for their speed
    for (std::size_t i = 0; i < count + delay; ++i) {
        if (i < count) {
            percept_sample& x = waiting[i % waiting.size()];
            x = target_at(s, i);
            now.at(x.t_s, x);
            if (const auto v = speed.next(x.felt))
                waiting[(i - delay) % waiting.size()].speed_mm_s = v;
        }
        if (i >= delay)
            each(waiting[(i - delay) % waiting.size()]);
    }
}

std::vector<percept_sample> predict_percept(const array& a, const stroke& s, const plan& p, const person& who)
{
    std::vector<percept_sample> samples;
    samples.reserve(count_samples(s.motion.duration_s()));
    follow_percept(a, s, p, who, [&](const percept_sample& x) { samples.push_back(x); });
    return samples;
}

percept_summary summarise(const array& a, const stroke& s, const plan& p, const person& who)
{
    detail::summing sums;
    follow_percept(a, s, p, who, [&](const percept_sample& x) { sums.add_all(x); });
    return sums.result();
}

percept_summary summarise(const std::vector<percept_sample>& samples)
{
    detail::summing sums;
    for (const percept_sample& x : samples)
        sums.add_all(x);
    return sums.result();
}

} // namespace v0
} // namespace tactor

namespace tactor::detail {

std::vector<percept_summary> predict_summaries(const array& a, const stroke& s,
                                               std::span<const plan* const> plans)
{
    const std::size_t count = count_samples(s.motion.duration_s());
    std::vector<followed_plan> all;
    all.reserve(plans.size());
    for (const plan* p : plans)
        all.push_back({detail::sounding(a, *p, s.motion.duration_s(), {})});
    for (std::size_t i = 0; i < count; ++i) {
        percept_sample x = target_at(s, i);
        for (followed_plan& f : all) {
            f.now.at(x.t_s, x);
            f.sums.add(x);
            const auto v = f.speed.next(x.felt);
            if (v && f.speed.was_felt())
                f.sums.add_speed(*v);
        }
    }
    std::vector<percept_summary> summaries;
    for (const followed_plan& f : all)
        summaries.push_back(f.sums.result());
    return summaries;
}

} // namespace tactor::detail
