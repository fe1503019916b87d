// SPDX-License-Identifier: MIT
#include "study/session/session_time.hpp"

#include <cmath>
#include <cstdint>

#include "session/device.hpp"
#include "synth/score/drive_room.hpp"

namespace tactor::study {
namespace {

/// A session without a person or a device, in frames.
class time_keeper {
public:
    time_keeper(const prepared_experiment& p, double answer_s)
        : p_(p),
          room_(p.render.channels, session::settle_limits({}, p.where), p.render.rate),
          answer_s_(answer_s)
    {
    }

    run_time run(const run_sequence& s)
    {
        const run_definition& r = p_.definition.runs[s.run];
        const std::uint64_t began = now_;
        run_time t;
        for (const auto* trials : {&s.practice, &s.trials})
            for (const planned_trial& one : *trials)
                trial(r, one, t);
        t.total_s = seconds(now_ - began);
        now_ += frames(r.break_s);
        return t;
    }

private:
    void trial(const run_definition& r, const planned_trial& one, run_time& t)
    {
        const score stimuli = p_.stimuli.make_score(one);
        const double shown_s =
            r.animation ? p_.definition.motions[one.motion].drawn.motion.duration_s() : 0.0;
        now_ += frames(p_.definition.rest_s);
        const std::uint64_t wait = room_.wait(stimuli, now_ + frames(shown_s + stimulus_lead_s)).value_or(0);
        t.waits += wait > 0 ? 1 : 0;
        t.waits_s += seconds(wait);
        now_ += wait + frames(shown_s + stimulus_lead_s);
        room_.played(stimuli, now_);
        now_ += stimuli.frames() + frames(answer_s_);
    }

    double seconds(std::uint64_t n) const { return static_cast<double>(n) / p_.render.rate; }
    std::uint64_t frames(double s) const
    {
        return static_cast<std::uint64_t>(std::llround(s * p_.render.rate));
    }

    const prepared_experiment& p_;
    synth::drive_room room_;
    double answer_s_;
    std::uint64_t now_ = 0;
};

} // namespace

std::vector<run_time> session_times(const prepared_experiment& p, double answer_s)
{
    time_keeper keeper(p, answer_s);
    std::vector<run_time> all;
    for (const run_sequence& s : p.runs)
        all.push_back(keeper.run(s));
    return all;
}

} // namespace tactor::study
