// SPDX-License-Identifier: MIT
#include "study/experiment/session_flow.hpp"

#include <map>
#include <vector>

#include <doctest/doctest.h>

#include "rounds.hpp"
#include "study/random/random.hpp"

namespace tactor::study::test_session_flow {
namespace {

flow_run make_flow_run(unsigned trials, unsigned practice = 0, bool rest = false)
{
    return {practice, 0, run_queue(trials), rest};
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
    f.agree(true);
    CHECK(f.next() == session_step{.what = step_kind::walk, .tactor = 0});
    f.felt(walk_answer::felt);
    CHECK(f.next().tactor == 1);
    f.felt(walk_answer::again);
    CHECK(f.next().tactor == 1);
    f.felt(walk_answer::back);
    f.felt(walk_answer::felt);
    f.felt(walk_answer::felt);
    CHECK(f.next() == session_step{.what = step_kind::introduce, .run = 0});
    f.go_on();
    CHECK(f.next() == session_step{.what = step_kind::trial, .run = 0, .practice = true, .which = {1, 1}});
    f.took(false);
    CHECK(f.next() == trial_step(0, 1));
    f.took(false);
    CHECK(f.next() == session_step{.what = step_kind::rest, .run = 0});
    f.go_on();
    CHECK(f.next() == session_step{.what = step_kind::introduce, .run = 1});
    f.go_on();
    CHECK(f.next() == trial_step(1, 1));
    f.took(false);
    CHECK(f.next().what == step_kind::over); // no break after the last
}

TEST_CASE("without consent, or where a tactor is not felt, nothing follows")
{
    session_flow no({make_flow_run(1)}, true, 3);
    no.agree(false);
    CHECK(no.next().what == step_kind::refused);
    session_flow f({make_flow_run(1)}, false, 3);
    f.felt(walk_answer::felt);
    f.felt(walk_answer::not_felt);
    CHECK(f.next() == session_step{.what = step_kind::not_felt, .tactor = 1});
}

TEST_CASE("a void trial comes again at the end of its run, its attempt counted up")
{
    session_flow f = begun({make_flow_run(2)});
    f.took(true);
    CHECK(f.next() == trial_step(0, 2));
    f.took(false);
    CHECK(f.next() == trial_step(0, 1, 2));
    f.took(true);
    CHECK(f.next() == trial_step(0, 1, 3));
    f.took(false);
    CHECK(f.next().what == step_kind::over);
}

TEST_CASE("void trials of practice do not come again")
{
    session_flow f = begun({make_flow_run(1, 1)});
    f.took(true);
    CHECK(f.next() == trial_step(0, 1));
}

TEST_CASE("the last trial can be made void once, until the next run begins")
{
    session_flow f = begun({make_flow_run(2, 0, true), make_flow_run(1)});
    CHECK_FALSE(f.void_last()); // there is none
    f.took(false);
    CHECK(f.void_last());
    CHECK_FALSE(f.void_last());
    CHECK(f.next() == trial_step(0, 2));
    f.took(true);
    CHECK_FALSE(f.void_last()); // it is void already
    f.took(false);              // 1, attempt 2
    f.took(false);              // 2, attempt 2
    CHECK(f.next().what == step_kind::rest);
    CHECK(f.void_run() == 0);
    CHECK(f.void_last()); // in the break: the run goes on
    CHECK(f.next() == trial_step(0, 2, 3));
    f.took(false);
    f.go_on(); // the break
    CHECK(f.next() == session_step{.what = step_kind::introduce, .run = 1});
    CHECK(f.void_last());
    f.took(false);
    f.go_on();
    f.go_on();
    CHECK_FALSE(f.void_last()); // the next has begun
    f.took(false);
    CHECK(f.next().what == step_kind::over);
    CHECK(f.void_last()); // even at the very end
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
        f.took(true);
    }
    CHECK(f.next().what == step_kind::pause);
    f.go_on();
    f.took(true);
    CHECK(f.next().what == step_kind::trial);
}

TEST_CASE("a resumed session skips its finished part")
{
    run_queue half(2);
    half.take(true);
    run_queue done(1);
    done.take(false);
    session_flow f({{0, 0, done, true}, {2, 1, half, true}}, false, 0);
    CHECK(f.next() == session_step{.what = step_kind::introduce, .run = 1});
    f.go_on();
    CHECK(f.next() == session_step{.what = step_kind::trial, .run = 1, .practice = true, .which = {2, 1}});
    f.took(false);
    CHECK(f.next() == trial_step(1, 2));
    CHECK_FALSE(f.void_last()); // of another session
    CHECK(session_flow({{0, 0, done, true}}, true, 9).next().what == step_kind::over);
}

// A resumed session knows only the tables.
TEST_CASE("in any course of events each trial counts once, and lines alone restore the same place")
{
    random_numbers r("flow");
    for (int round = 0; round < test::rounds(300); ++round) {
        session_flow f = begun({make_flow_run(6), make_flow_run(3)});
        struct line {
            pending_trial which;
            bool is_void;
        };
        std::map<std::size_t, std::vector<line>> lines;
        for (session_step s = f.next(); s.what != step_kind::over; s = f.next()) {
            if (s.what != step_kind::trial) {
                f.go_on();
                continue;
            }
            const bool is_void = r.below(4) == 0;
            lines[s.run].push_back({s.which, is_void});
            f.took(is_void);
            if (r.below(5) == 0 && f.void_last()) {
                REQUIRE_FALSE(lines[f.void_run()].back().is_void);
                lines[f.void_run()].back().is_void = true;
            }
        }
        for (const auto& [run, written] : lines) {
            run_queue again(run == 0 ? 6 : 3);
            for (const line& l : written) {
                REQUIRE(again.next() == l.which);
                again.take(l.is_void);
            }
            CHECK(again.done());
        }
    }
}

} // namespace
} // namespace tactor::study::test_session_flow
