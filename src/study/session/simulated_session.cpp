// SPDX-License-Identifier: MIT

#include <cmath>
#include <cstdint>

#include "session/interrupt.hpp"
#include "study/bids/acq_time.hpp"
#include "study/session/trials.hpp"

namespace tactor::study {
namespace {

constexpr double pause_s = 0.5; // from an answer to what comes next

// Nothing happens at any time: the clock of a simulated session begins with the year 2000.
constexpr std::int64_t epoch_ns = 946684800LL * 1000000000LL;

class simulated_session {
public:
    simulated_session(const prepared_experiment& p, const simulation& s, session_store& store)
        : p_(p), simulation_(s), store_(store)
    {
    }

    int all()
    {
        for (const run_sequence& s : p_.runs)
            if (const int signal = run(s))
                return signal;
        return 0;
    }

private:
    std::uint64_t frames(double seconds) const
    {
        return static_cast<std::uint64_t>(std::llround(seconds * p_.render.rate));
    }

    std::string time_of(std::uint64_t frame) const
    {
        const std::uint64_t rate = p_.render.rate;
        const auto microseconds = frame / rate * 1000000 + frame % rate * 1000000 / rate;
        return acq_time_text(epoch_ns + static_cast<std::int64_t>(microseconds) * 1000);
    }

    // The clock after a trial, which a line says alone: a session that goes on has no other.
    void pass(const trial_row& row)
    {
        now_ = row.frame_1.value_or(now_) + frames(row.duration_s) +
               frames(row.response_time_s.value_or(0.0)) + frames(pause_s);
    }

    trial_row play(const run_definition& r, const planned_trial& t, const pending_trial& which,
                   const simulated_observer& who, bool practice)
    {
        if (r.animation)
            now_ += frames(p_.definition.motions[t.motion].drawn.motion.duration_s());
        const simulated_answer a = who.answer(t, which.trial, which.attempt, practice);
        trial_row row = planned_row(p_, t, which);
        row.stream = 1;
        row.frame_1 = now_;
        if (t.method_2)
            row.frame_2 = now_ + p_.stimuli.second(t);
        row.is_void = a.is_void;
        row.xruns = a.is_void ? 1 : 0;
        if (!a.is_void) {
            set_response(row, p_, r, a.response);
            row.response_time_s = a.response_time_ms * 1e-3;
        }
        return row;
    }

    void set_onset(trial_row& row, std::uint64_t first) const
    {
        row.onset_s = static_cast<double>(*row.frame_1 - first) / p_.render.rate;
    }

    void practise(const run_sequence& s, const simulated_observer& who)
    {
        const run_definition& r = p_.definition.runs[s.run];
        std::vector<trial_row> rows = store_.practice_rows(r);
        for (const trial_row& row : rows)
            pass(row);
        for (std::size_t i = rows.size(); i < s.practice.size(); ++i) {
            trial_row row = play(r, s.practice[i], {static_cast<unsigned>(i + 1), 1}, who, true);
            rows.push_back(row);
            set_onset(row, *rows.front().frame_1);
            store_.append_practice(r, row);
            pass(row);
        }
    }

    int run(const run_sequence& s)
    {
        const run_definition& r = p_.definition.runs[s.run];
        const simulated_observer who(simulation_, p_.definition, r, p_.stimuli, p_.participant);
        practise(s, who);
        const std::vector<trial_row> rows = store_.rows(r);
        for (const trial_row& row : rows)
            pass(row);
        run_queue queue = replay(p_, s, rows);
        std::optional<std::uint64_t> first;
        if (!rows.empty())
            first = rows.front().frame_1;
        while (!queue.done()) {
            if (const int signal = stop_.poll())
                return signal;
            const pending_trial next = queue.next();
            trial_row row = play(r, s.trials[next.trial - 1], next, who, false);
            first = first.value_or(*row.frame_1);
            set_onset(row, *first);
            store_.append(r, row, time_of(*first));
            pass(row);
            queue.take(row.is_void);
        }
        now_ += frames(r.break_s);
        return 0;
    }

    const prepared_experiment& p_;
    const simulation& simulation_;
    session_store& store_;
    session::interrupt stop_;
    std::uint64_t now_ = 0; ///< frame of the virtual stream
};

} // namespace

int simulate_session(const prepared_experiment& p, const simulation& s, session_store& store)
{
    return simulated_session(p, s, store).all();
}

} // namespace tactor::study
