// SPDX-License-Identifier: MIT
// A session with a simulated observer. It has no device. Its clock is computed from the lines of its trials.
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "session/process.hpp"
#include "study/random/random.hpp"
#include "study/session/experiment_session.hpp"
#include "study/session/sync_codes.hpp"

namespace tactor::study {
namespace {

constexpr double pause_s = 0.5; // time from an answer to the next step

// Start of a simulated session's clock: the year 2000, because simulated trials have no real time.
constexpr std::int64_t epoch_ns = 946684800LL * 1000000000LL;

class simulated_session {
public:
    simulated_session(const prepared_experiment& p, const simulation& s, session_store& store)
        : p_(p),
          simulation_(s),
          store_(store),
          codes_(p, store, nullptr, nullptr),
          flow_(make_flow(p, store, false))
    {
    }

    int run_session()
    {
        restore_clock();
        std::optional<held_run> run;
        std::optional<simulated_observer> who;
        for (session_step s = flow_.next(); s.what != step_kind::over; s = flow_.next()) {
            if (const int signal = stop_.poll())
                return signal;
            if (s.what == step_kind::introduce) {
                run.emplace(p_, s.run, store_);
                who.emplace(simulation_, p_.definition, p_.run_at(s.run), p_.stimuli, p_.participant);
            }
            if (s.what == step_kind::rest)
                now_ += count_frames(p_.run_at(s.run).break_s);
            if (s.what == step_kind::ask) {
                const questionnaire& q = p_.definition.outline.questionnaires[s.form];
                const std::string after = preceding_run_name(p_, q, s.run);
                store_.keep_answer(q, after, s.item, draw_answer(q, s.item, after));
                flow_.record_answer(s);
                continue;
            }
            if (s.what != step_kind::trial) {
                flow_.go_on();
                continue;
            }
            planned_trial t = run->find_trial(s);
            const trial_row row = play(s, *who, t);
            const bool ends_track = run->add(s, row, utc_ns(now_));
            note_codes(s, t, row);
            codes_.write(p_.run_at(s.run), row, run->find_table(s));
            advance_clock(row);
            flow_.record_trial(row.is_void, ends_track);
        }
        return 0;
    }

private:
    std::uint64_t count_frames(double seconds) const
    {
        return static_cast<std::uint64_t>(std::llround(seconds * p_.render.rate));
    }

    // Draws the answer to an item: each number is equally likely, and a text is "simulated".
    std::string draw_answer(const questionnaire& q, std::size_t place, const std::string& after) const
    {
        random_numbers r(fmt::format(
            "{}/{}/{}", session_seed(simulation_.seed, p_.definition, p_.participant), q.name, after));
        std::string answer;
        for (std::size_t i = 0; i <= place; ++i) // repeats the draws of earlier items
            if (const questionnaire_item& item = q.items[i]; item.kind == item_kind::text)
                answer = "simulated";
            else
                answer = fmt::format("{}", item.lowest + r.below(item.greatest - item.lowest + 1));
        return answer;
    }

    std::int64_t utc_ns(std::uint64_t frame) const
    {
        const std::uint64_t rate = p_.render.rate;
        const auto microseconds = frame / rate * 1000000 + frame % rate * 1000000 / rate;
        return epoch_ns + static_cast<std::int64_t>(microseconds) * 1000;
    }

    // Sets the clock to the time after a trial. Uses only the trial's line, because a resumed session has no
    // other data.
    void advance_clock(const trial_row& row)
    {
        now_ = row.frame_1.value_or(now_) + count_frames(row.duration_s) +
               count_frames(row.response_time_s.value_or(0.0)) + count_frames(pause_s);
    }

    // Sets the clock of a resumed session to the time after its last line.
    void restore_clock()
    {
        for (const run_sequence& s : p_.runs) {
            const run_definition& r = p_.definition.runs[s.run];
            for (const trial_row& row : store_.practice_rows(r))
                advance_clock(row);
            const std::vector<trial_row> rows = store_.rows(r);
            for (const trial_row& row : rows)
                advance_clock(row);
            if (replay(p_, s, rows, store_.table(r)).done())
                now_ += count_frames(r.break_s);
        }
    }

    // Simulates a trial, and returns its line. Sets `t` to the trial that the observer played last.
    trial_row play(const session_step& s, const simulated_observer& who, planned_trial& t)
    {
        const run_definition& r = p_.run_at(s.run);
        if (r.animation)
            now_ += count_frames(find_duration_s(p_.definition.motions[t.motion].strokes));
        now_ += codes_.count_lead_frames(s);
        const simulated_answer a = who.answer(t, s.which.trial, s.which.attempt, s.practice);
        const std::optional<double> start = find_value(p_.definition, t);
        const auto moves =
            a.is_void ? std::vector<planned_trial>() : find_run_task(r.outline).list_moves(r, t, a.response);
        for (const planned_trial& next : moves) {
            if (!s.practice)
                codes_.note_stimuli(s, t, now_, p_.stimuli.count_frames(t), utc_ns(now_));
            now_ += p_.stimuli.count_frames(t) + count_frames(pause_s) + codes_.count_lead_frames(s);
            t = next;
        }
        trial_row row = planned_row(p_, r, t, s.which);
        row.start = start;
        row.moves = static_cast<unsigned>(moves.size());
        row.stream = 1;
        set_first_frames(row, p_.stimuli.starts(t), now_, p_.stimuli.count_frames(t));
        row.is_void = a.is_void;
        row.xruns = a.is_void ? 1 : 0;
        if (!a.is_void)
            set_response(row, r, a.response, a.response_time_ms * 1e-3);
        return row;
    }

    void note_codes(const session_step& s, const planned_trial& t, const trial_row& row)
    {
        if (s.practice)
            return;
        codes_.note_stimuli(s, t, now_, p_.stimuli.count_frames(t), utc_ns(now_));
        const std::uint64_t then =
            now_ + p_.stimuli.count_frames(t) + count_frames(row.response_time_s.value_or(0.0));
        codes_.note(row.is_void ? code_event::made_void : code_event::answer, s, t, row.response, then,
                    utc_ns(then));
    }

    const prepared_experiment& p_;
    const simulation& simulation_;
    session_store& store_;
    sync_codes codes_;
    session_flow flow_;
    session::interrupt stop_;
    std::uint64_t now_ = 0; ///< frame of the virtual stream
};

} // namespace

void check_simulation(const prepared_experiment& p, const simulation& s)
{
    for (const run_sequence& r : p.runs)
        simulated_observer(s, p.definition, p.definition.runs[r.run], p.stimuli, p.participant);
}

int simulate_session(const prepared_experiment& p, const simulation& s, session_store& store)
{
    return simulated_session(p, s, store).run_session();
}

} // namespace tactor::study
