// SPDX-License-Identifier: MIT
// The steps of a session with a person.
#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "rounds.hpp"
#include "study/data/trial.hpp"
#include "study/experiment/trials.hpp"
#include "study/random/random.hpp"

namespace tactor::study::test_session_flow {
namespace {

flow_run make_flow_run(unsigned trials, unsigned practice = 0, bool rest = false)
{
    return {practice, 0, run_queue(std::vector<planned_trial>(trials)), rest};
}

// Plans n trials of three tracks by turns.
std::vector<planned_trial> make_tracks(unsigned n)
{
    std::vector<planned_trial> all(n);
    for (unsigned i = 0; i < n; ++i)
        all[i].track = i % 3 + 1;
    return all;
}

session_step trial_step(std::size_t run, unsigned trial, unsigned attempt = 1)
{
    return {.what = step_kind::trial, .run = run, .which = {trial, attempt}};
}

// Returns a session past consent, walk and introduction.
session_flow begun(std::vector<flow_run> runs)
{
    session_flow f(std::move(runs), false, 0);
    f.go_on();
    return f;
}

TEST_CASE("consent, then each tactor, then the question, practice, trials, a break, the next run")
{
    session_flow f({make_flow_run(1, 1, true), make_flow_run(1, 0, true)}, true, 2);
    CHECK(f.next().what == step_kind::consent);
    f.record_consent();
    CHECK(f.next() == session_step{.what = step_kind::walk, .tactor = 0});
    f.record_felt_tactor();
    CHECK(f.next().tactor == 1);
    f.return_to_last_tactor();
    f.return_to_last_tactor();
    CHECK(f.next().tactor == 0);
    f.record_felt_tactor();
    f.record_felt_tactor();
    CHECK(f.next() == session_step{.what = step_kind::introduce, .run = 0});
    f.go_on();
    CHECK(f.next() == session_step{.what = step_kind::trial, .run = 0, .practice = true, .which = {1, 1}});
    f.record_trial(false);
    CHECK(f.next() == trial_step(0, 1));
    f.record_trial(false);
    CHECK(f.next() == session_step{.what = step_kind::rest, .run = 0});
    f.go_on();
    CHECK(f.next() == session_step{.what = step_kind::introduce, .run = 1});
    f.go_on();
    CHECK(f.next() == trial_step(1, 1));
    f.record_trial(false);
    CHECK(f.next().what == step_kind::over); // no break after the last
}

TEST_CASE("a void trial comes again at the end of its run, its attempt counted up")
{
    session_flow f = begun({make_flow_run(2)});
    f.record_trial(true);
    CHECK(f.next() == trial_step(0, 2));
    f.record_trial(false);
    CHECK(f.next() == trial_step(0, 1, 2));
    f.record_trial(true);
    CHECK(f.next() == trial_step(0, 1, 3));
    f.record_trial(false);
    CHECK(f.next().what == step_kind::over);
}

TEST_CASE("void trials of practice do not come again")
{
    session_flow f = begun({make_flow_run(1, 1)});
    f.record_trial(true);
    CHECK(f.next() == trial_step(0, 1));
}

TEST_CASE("questionnaires come before the first run, between runs before the break, and after the last")
{
    using enum questionnaire_time;
    const auto ask = [](std::size_t form, std::size_t run = 0) {
        return session_step{.what = step_kind::ask, .run = run, .form = form};
    };
    session_flow f({make_flow_run(1, 0, true), make_flow_run(1)}, false, 1,
                   {{0, after}, {1, between}, {2, before, 0, 1, 1}, {3, before}});
    f.record_felt_tactor();
    CHECK(f.next() == ask(3)); // 2 was answered in an earlier session
    f.pause();
    CHECK(f.next().what == step_kind::pause);
    f.go_on();
    f.record_answer(ask(3));
    f.go_on();
    f.record_trial(false);
    CHECK(f.next() == ask(1));
    CHECK_FALSE(f.void_last_trial());
    f.record_answer(ask(1));
    CHECK(f.next().what == step_kind::rest);
    CHECK(f.void_last_trial()); // the run goes on
    CHECK(f.next() == trial_step(0, 1, 2));
    f.record_trial(false);
    CHECK(f.next().what == step_kind::rest);
    f.go_on();
    f.go_on();
    f.record_trial(false);
    CHECK(f.next() == ask(0));
    f.record_answer(ask(0));
    CHECK(f.next().what == step_kind::over);
    // Only questions are left: nothing is walked.
    run_queue done(std::vector<planned_trial>(1));
    done.remove_next(false);
    CHECK(session_flow({{0, 0, done, false}}, false, 9, {{0, after}}).next() == ask(0));
}

TEST_CASE("each item of a questionnaire is a step, and one can go back until a trial was played")
{
    using enum questionnaire_time;
    const auto ask = [](std::size_t form, std::size_t item) {
        return session_step{.what = step_kind::ask, .form = form, .item = item};
    };
    session_flow f({make_flow_run(1)}, false, 0, {{0, before, 0, 3, 1}, {1, before, 0, 2}, {2, after, 0, 1}});
    CHECK(f.next() == ask(0, 1)); // the first was answered before
    CHECK(f.go_back());
    CHECK_FALSE(f.go_back());
    for (std::size_t item = 0; item < 3; ++item) {
        CHECK(f.next() == ask(0, item));
        f.record_answer(f.next());
    }
    f.record_answer(ask(1, 0));
    for (const session_step& s : {ask(1, 0), ask(0, 2), ask(0, 1)}) {
        CHECK(f.go_back());
        CHECK(f.next() == s);
    }
    f.pause();
    CHECK_FALSE(f.go_back());
    f.go_on();
    for (const session_step& s : {ask(0, 1), ask(0, 2), ask(1, 0), ask(1, 1)})
        f.record_answer(s);
    CHECK(f.next().what == step_kind::introduce);
    CHECK(f.go_back());
    CHECK(f.next() == ask(1, 1));
    f.record_answer(ask(1, 1));
    f.go_on();
    CHECK_FALSE(f.go_back()); // a trial begins
    f.record_trial(false);
    CHECK(f.next() == ask(2, 0));
    CHECK_FALSE(f.go_back());
    f.record_answer(ask(2, 0));
    CHECK(f.next().what == step_kind::over);
    CHECK(f.go_back());
    CHECK(f.next() == ask(2, 0));
}

TEST_CASE("no trial is made void within a questionnaire")
{
    using enum questionnaire_time;
    session_flow f({make_flow_run(1, 0, true), make_flow_run(1)}, false, 0, {{0, between, 0, 2}});
    f.go_on();
    f.record_trial(false);
    f.pause();
    CHECK_FALSE(f.is_asking());
    f.go_on();
    for (int item = 0; item < 2; ++item) {
        CHECK(f.is_asking());
        CHECK_FALSE(f.void_last_trial());
        f.record_answer(f.next());
        f.pause();
        CHECK(f.is_asking() == (item == 0));
        CHECK(f.void_last_trial() == (item == 1));
        f.go_on();
    }
    CHECK(f.next() == trial_step(0, 1, 2));
}

TEST_CASE("the last trial can be made void once, until the next run begins")
{
    session_flow f = begun({make_flow_run(2, 0, true), make_flow_run(1)});
    CHECK_FALSE(f.void_last_trial()); // there is none
    f.record_trial(false);
    CHECK(f.void_last_trial());
    CHECK_FALSE(f.void_last_trial());
    CHECK(f.next() == trial_step(0, 2));
    f.record_trial(true);
    CHECK_FALSE(f.void_last_trial()); // it is void already
    f.record_trial(false);            // 1, attempt 2
    f.record_trial(false);            // 2, attempt 2
    CHECK(f.next().what == step_kind::rest);
    CHECK(f.last_trial_run() == 0);
    CHECK(f.void_last_trial()); // in the break: the run goes on
    CHECK(f.next() == trial_step(0, 2, 3));
    f.record_trial(false);
    f.go_on(); // the break
    CHECK(f.next() == session_step{.what = step_kind::introduce, .run = 1});
    CHECK(f.void_last_trial());
    f.record_trial(false);
    f.go_on();
    f.go_on();
    CHECK_FALSE(f.void_last_trial()); // the next has begun
    f.record_trial(false);
    CHECK(f.next().what == step_kind::over);
    CHECK(f.void_last_trial()); // even at the very end
    CHECK(f.next() == trial_step(1, 1, 2));
}

TEST_CASE("a pause comes before the next trial, and after five that became void by themselves")
{
    session_flow f = begun({make_flow_run(9)});
    f.pause();
    CHECK(f.next().what == step_kind::pause);
    f.go_on();
    CHECK(f.next() == trial_step(0, 1));
    for (unsigned i = 0; i < most_void_in_row; ++i) {
        CHECK(f.next().what == step_kind::trial);
        f.record_trial(true);
    }
    CHECK(f.next().what == step_kind::pause);
    f.go_on();
    f.record_trial(true);
    CHECK(f.next().what == step_kind::trial);
}

TEST_CASE("a resumed session skips its finished part")
{
    run_queue half(std::vector<planned_trial>(2));
    half.remove_next(true);
    run_queue done(std::vector<planned_trial>(1));
    done.remove_next(false);
    session_flow f({{0, 0, done, true}, {2, 1, half, true}}, false, 0);
    CHECK(f.next() == session_step{.what = step_kind::introduce, .run = 1});
    f.go_on();
    CHECK(f.next() == session_step{.what = step_kind::trial, .run = 1, .practice = true, .which = {2, 1}});
    f.record_trial(false);
    CHECK(f.next() == trial_step(1, 2));
    CHECK_FALSE(f.void_last_trial()); // of another session
    CHECK(session_flow({{0, 0, done, true}}, true, 9).next().what == step_kind::over);
}

TEST_CASE("trials of a track that has ended are skipped, until its last answer is made void")
{
    run_queue q(make_tracks(6)); // tracks 1, 2, 3, 1, 2, 3
    q.remove_next(true);         // track 1 comes again at the end
    q.remove_next(false, true);  // ends track 2
    CHECK(q.next() == pending_trial{3, 1});
    q.remove_next(false, true); // ends track 3
    CHECK(q.next() == pending_trial{4, 1});
    CHECK(q.requeue_last()); // track 3 goes on
    CHECK(q.next() == pending_trial{4, 1});
    q.remove_next(false);
    CHECK(q.next() == pending_trial{6, 1});
    q.remove_next(false);
    CHECK(q.next() == pending_trial{1, 2});
    q.remove_next(false, true); // ends track 1
    CHECK(q.next() == pending_trial{3, 2});
    q.remove_next(false, true);
    CHECK(q.done());
    CHECK(q.requeue_last());
    CHECK(q.next() == pending_trial{3, 3});
}

// A resumed session knows only the tables.
TEST_CASE("in any course of events each trial counts once, and lines alone restore the same place")
{
    random_numbers r("flow");
    for (int round = 0; round < test::rounds(300); ++round) {
        session_flow f = begun({flow_run{.trials = run_queue(make_tracks(9))}, make_flow_run(3)});
        struct line {
            pending_trial which;
            bool is_void;
        };
        std::map<std::size_t, std::vector<line>> lines;
        // Track 1 ends at its first answer, track 2 at its second; track 3 has only three trials.
        const auto ends = [](std::size_t run, const std::vector<line>& written) {
            const auto find_track = [](const line& l) { return (l.which.trial - 1) % 3 + 1; };
            return run == 0 && !written.back().is_void &&
                   std::ranges::count_if(written, [&](const line& l) {
                       return !l.is_void && find_track(l) == find_track(written.back());
                   }) == find_track(written.back());
        };
        for (session_step s = f.next(); s.what != step_kind::over; s = f.next()) {
            if (s.what != step_kind::trial) {
                f.go_on();
                continue;
            }
            const bool is_void = r.below(4) == 0;
            lines[s.run].push_back({s.which, is_void});
            f.record_trial(is_void, ends(s.run, lines[s.run]));
            if (r.below(5) == 0 && f.void_last_trial()) {
                REQUIRE_FALSE(lines[f.last_trial_run()].back().is_void);
                lines[f.last_trial_run()].back().is_void = true;
            }
        }
        for (const auto& [run, written] : lines) {
            run_queue again(run == 0 ? make_tracks(9) : std::vector<planned_trial>(3));
            std::vector<line> so_far;
            for (const line& l : written) {
                REQUIRE_FALSE(again.done());
                REQUIRE(again.next() == l.which);
                so_far.push_back(l);
                again.remove_next(l.is_void, ends(run, so_far));
            }
            CHECK(again.done());
            CHECK(std::ranges::count(written, false, &line::is_void) == (run == 0 ? 1 + 2 + 3 : 3));
        }
    }
}

} // namespace
} // namespace tactor::study::test_session_flow
