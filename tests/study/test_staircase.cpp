// SPDX-License-Identifier: MIT
#include "study/calibrate/staircase.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "study/calibrate/calibration.hpp"
#include "study/calibrate/observer.hpp"

namespace tactor::study::test_staircase {
namespace {

// Answers '1' right and '0' wrong; returns the level of each trial.
std::vector<double> levels(staircase& s, std::string_view answers)
{
    std::vector<double> all;
    for (const char a : answers) {
        all.push_back(s.level_dbfs());
        s.answer(a == '1');
    }
    return all;
}

TEST_CASE("until the first reversal one right answer goes down, then three; a wrong one goes up")
{
    staircase s({});
    CHECK(levels(s, "1110111") == std::vector<double>{-20, -24, -28, -32, -28, -28, -28});
    CHECK(s.reversals_dbfs() == std::vector<double>{-32, -28});
    CHECK(s.level_dbfs() == -30); // the step at the second reversal is the new one
    staircase two({.right_for_down = 2});
    CHECK(levels(two, "1101") == std::vector<double>{-20, -24, -28, -24});
    two.answer(true);
    CHECK(two.level_dbfs() == -26);
    staircase up({});
    CHECK(levels(up, "00111") == std::vector<double>{-20, -16, -12, -16, -16});
    CHECK(up.reversals_dbfs() == std::vector<double>{-12});
}

TEST_CASE("each step begins to count anew")
{
    staircase s({});
    levels(s, "0111"); // the first right answer is the first reversal: two of the three count
    CHECK(s.level_dbfs() == -20);
    s.answer(true);
    CHECK(s.level_dbfs() == -24);
    levels(s, "110");
    CHECK(s.level_dbfs() == -22);
    levels(s, "11");
    CHECK(s.level_dbfs() == -22);
}

TEST_CASE("steps become smaller with every second reversal, and the last stays")
{
    staircase s({.right_for_down = 2});
    // down, up, down, ...: each a reversal from the second on
    const auto all = levels(s, "110110110110110");
    CHECK(s.reversals_dbfs() == std::vector<double>{-28, -24, -26, -24, -25, -24, -25, -24, -25});
    CHECK(s.level_dbfs() == -24);
    CHECK(all.size() == 15);
}

TEST_CASE("a step that the ceiling blocks counts as up")
{
    staircase s({.right_for_down = 2, .start_dbfs = -2.0, .ceiling_dbfs = -1.0});
    CHECK(levels(s, "0") == std::vector<double>{-2});
    CHECK(s.level_dbfs() == -1);
    s.answer(false);
    CHECK(s.level_dbfs() == -1);
    CHECK(s.reversals_dbfs().empty());
    s.answer(true); // down after a blocked step up: that is a turn
    CHECK(s.reversals_dbfs() == std::vector<double>{-1});
    CHECK(s.level_dbfs() == -5);
}

TEST_CASE("fewer than eight right of the last ten at the ceiling: not felt")
{
    staircase s({.start_dbfs = 0.0});
    levels(s, "0101100"); // the third to the sixth are below
    REQUIRE(s.level_dbfs() == 0.0);
    levels(s, "001100");
    CHECK(!s.end());
    s.answer(true);
    REQUIRE(s.end());
    CHECK(*s.end() == staircase_end::not_felt);
    CHECK(s.trials() == 14);
    CHECK(!s.check_right());
}

TEST_CASE("a participant right at the floor has no threshold")
{
    staircase s({.start_dbfs = -140.0});
    while (!s.end())
        s.answer(true);
    CHECK(*s.end() == staircase_end::below_range);
    CHECK(!s.threshold());
    CHECK(s.trials() < 30);
}

TEST_CASE("mean, deviation and halves of the counted reversals")
{
    const std::vector<double> r{-40, -10, -30, -20, -31, -29, -32, -28};
    const reversal_mean m = average_reversals(r, 4);
    CHECK(m.mean_dbfs == -30.0);
    CHECK(m.sd_db == doctest::Approx(std::sqrt(10.0 / 3.0)));
    CHECK(m.halves_db == 0.0);
    CHECK(average_reversals(r, 6).halves_db ==
          doctest::Approx(std::abs((-30 - 20 - 31) / 3.0 + (29 + 32 + 28) / 3.0)));
}

// Reports whether the threshold is there and the trials above it run.
bool checking(const staircase& s)
{
    return s.threshold() && !s.end();
}

// Answers so that the staircase turns at each step: right until it goes down, then wrong.
void turn(staircase& s, std::size_t reversals, double drift_db)
{
    while (s.reversals_dbfs().size() < reversals && !checking(s)) {
        const double aim = -20.0 + drift_db * static_cast<double>(s.reversals_dbfs().size());
        s.answer(s.level_dbfs() > aim);
    }
}

TEST_CASE("an odd number of counted reversals drops the earliest")
{
    staircase s({.reversals = 11, .discard = 4});
    turn(s, 11, 0.0);
    REQUIRE(checking(s));
    CHECK(s.threshold()->mean_dbfs == average_reversals(s.reversals_dbfs(), 6).mean_dbfs);
}

TEST_CASE(
    "two more reversals while the halves differ by more than 2 dB, 24 at most, and the last eight count")
{
    staircase s({});
    turn(s, 24, -1.2); // a threshold that falls all the time
    REQUIRE(checking(s));
    CHECK(s.reversals_dbfs().size() == most_reversals);
    CHECK(s.threshold()->halves_db > 2.0);
    CHECK(s.threshold()->mean_dbfs == average_reversals(s.reversals_dbfs(), 8).mean_dbfs);

    // For any setting.
    for (const auto& [reversals, discard] : {std::pair{9U, 2U}, std::pair{20U, 4U}, std::pair{6U, 4U}}) {
        staircase other({.reversals = reversals, .discard = discard});
        turn(other, 24, -1.2);
        REQUIRE(checking(other));
        REQUIRE(other.reversals_dbfs().size() > reversals);
        CHECK(other.threshold()->mean_dbfs ==
              average_reversals(other.reversals_dbfs(),
                                std::min<std::size_t>(8, (other.reversals_dbfs().size() - discard) / 2 * 2))
                  .mean_dbfs);
    }

    staircase steady({});
    turn(steady, 24, 0.0);
    CHECK(steady.reversals_dbfs().size() == 12);
    CHECK(steady.threshold()->mean_dbfs == average_reversals(steady.reversals_dbfs(), 8).mean_dbfs);

    staircase once({});
    std::vector<double> halves;
    while (!checking(once)) {
        // A jump of the threshold after the eighth reversal is behind the last eight at the sixteenth.
        const double aim = once.reversals_dbfs().size() < 8 ? -20.0 : -26.0;
        if (once.answer(once.level_dbfs() > aim) && once.reversals_dbfs().size() >= 12 &&
            once.reversals_dbfs().size() % 2 == 0)
            halves.push_back(average_reversals(once.reversals_dbfs(), 8).halves_db);
    }
    CHECK(halves.size() >= 2);
    for (std::size_t i = 0; i < halves.size(); ++i)
        CHECK((halves[i] > 2.0) == (i + 1 < halves.size()));
}

TEST_CASE("ten check trials, 6 dB above the threshold or at the ceiling, find tactors that are not felt")
{
    for (const double ceiling : {0.0, -18.0}) {
        staircase s({.ceiling_dbfs = ceiling});
        turn(s, 12, 0.0);
        REQUIRE(checking(s));
        CHECK(s.level_dbfs() == doctest::Approx(std::min(s.threshold()->mean_dbfs + 6.0, ceiling)));
        const std::size_t before = s.trials();
        staircase t = s;
        levels(s, "1111100111");
        CHECK(s.trials() == before + 10);
        CHECK(!s.end());
        CHECK(*s.check_right() == 8);
        CHECK(!s.check_below_right());
        levels(t, "1111100101");
        CHECK(*t.end() == staircase_end::not_felt);
        CHECK(*t.check_right() == 7);
    }
}

// Returns a staircase at the first of the ten check trials below.
staircase checked_above(staircase_options o = {})
{
    staircase s(std::move(o));
    turn(s, 12, 0.0);
    levels(s, "1111111111");
    return s;
}

TEST_CASE("up to eight right of ten, 6 dB below the threshold, confirm it")
{
    staircase s = checked_above();
    CHECK(s.level_dbfs() == doctest::Approx(s.threshold()->mean_dbfs - 6.0));
    const std::size_t before = s.trials();
    const auto all = levels(s, "1111111100");
    CHECK(all.front() == all.back());
    CHECK(s.trials() == before + 10);
    CHECK(*s.end() == staircase_end::felt);
    CHECK(*s.check_right() == 10);
    CHECK(*s.check_below_right() == 8);
    CHECK(s.staircases() == 1);
}

TEST_CASE("nine right 6 dB below the threshold: the staircase runs once more, from there")
{
    staircase s = checked_above();
    const double from = s.level_dbfs();
    const std::size_t before = s.trials();
    levels(s, "1111111110");
    CHECK(!s.end());
    CHECK(s.staircases() == 2);
    CHECK(s.level_dbfs() == from);
    CHECK(!s.threshold());
    CHECK(!s.check_right());
    CHECK(s.reversals_dbfs().empty());
    CHECK(levels(s, "110") == std::vector<double>{from, from - 4.0, from - 8.0}); // as from a start
    while (!checking(s))
        s.answer(s.level_dbfs() > -40.0);
    CHECK(s.threshold()->mean_dbfs == doctest::Approx(-40.0));
    CHECK(s.reversals_dbfs().size() == 12);
    levels(s, "1111111111");
    CHECK(!s.end());
    levels(s, "1111111111"); // not a third time
    CHECK(*s.end() == staircase_end::felt);
    CHECK(*s.check_below_right() == 10);
    CHECK(s.trials() > before + 30);
}

TEST_CASE("a threshold that the second staircase does not find is not felt")
{
    staircase s = checked_above({.ceiling_dbfs = -18.0});
    levels(s, "1111111111");
    REQUIRE(s.staircases() == 2);
    while (!s.end())
        s.answer(false);
    CHECK(*s.end() == staircase_end::not_felt);
    CHECK(!s.threshold());
    CHECK(!s.check_right());
}

calibration_settings make_settings(unsigned right_for_down, std::uint32_t seed)
{
    calibration_settings s;
    s.participant = "sim";
    s.tactors = {0};
    s.ceilings_dbfs = {0.0};
    s.staircase.right_for_down = right_for_down;
    s.seed = seed;
    return s;
}

tactor_threshold measured(unsigned right_for_down, std::uint32_t seed, const observer_settings& who)
{
    calibration c(make_settings(right_for_down, seed));
    observer o(who, c.settings());
    while (!c.done())
        c.answer(o.answer(c.next()));
    return c.thresholds().front();
}

// Returns the level at which an observer is right in that part of the trials, by halving.
double level_for(const observer_settings& o, double part)
{
    double low = -200.0;
    double high = 100.0;
    for (int i = 0; i < 100; ++i) {
        const double middle = (low + high) / 2.0;
        (right_at(o, o.thresholds_dbfs.front(), middle) < part ? low : high) = middle;
    }
    return high;
}

TEST_CASE("a thousand observers' thresholds are those that the rule targets")
{
    struct sort {
        unsigned right_for_down;
        double spread_db;
        double lapse;
        double within_db;
    };
    for (const sort& k : {sort{3, 2.0, 0.0, 0.5}, sort{2, 2.0, 0.0, 0.5}, sort{3, 1.0, 0.0, 0.5},
                          sort{2, 1.0, 0.0, 0.5}, sort{3, 2.0, 0.05, 1.0}, sort{2, 2.0, 0.05, 1.0}}) {
        const observer_settings who{{-45.0}, k.spread_db, k.lapse};
        const double target = level_for(who, std::pow(0.5, 1.0 / k.right_for_down));
        double sum = 0.0;
        double squares = 0.0;
        double trials = 0.0;
        int felt = 0;
        for (std::uint32_t seed = 0; seed < 1000; ++seed) {
            const tactor_threshold t = measured(k.right_for_down, seed, who);
            trials += static_cast<double>(t.trials);
            if (!t.threshold_dbfs)
                continue;
            ++felt;
            sum += *t.threshold_dbfs;
            squares += *t.threshold_dbfs * *t.threshold_dbfs;
        }
        const double mean = sum / felt;
        const double sd = std::sqrt(squares / felt - mean * mean);
        MESSAGE(fmt::format(
            "1up{}down, spread {} dB, lapse {}: {} felt, mean {:.3f} dBFS, target {:.3f}, off "
            "{:+.3f} dB, sd {:.3f} dB, {:.1f} trials",
            k.right_for_down, k.spread_db, k.lapse, felt, mean, target, mean - target, sd, trials / 1000.0));
        CHECK(std::abs(mean - target) < k.within_db);
        CHECK(felt >= 900);
        CHECK(sd < 3.0);
    }
}

TEST_CASE("an observer who never feels anything is reported so")
{
    for (const unsigned right_for_down : {3U, 2U}) {
        int not_felt = 0;
        for (std::uint32_t seed = 0; seed < 1000; ++seed)
            not_felt += measured(right_for_down, seed, {{1000.0}, 2.0, 0.0}).end == staircase_end::not_felt;
        MESSAGE(fmt::format("1up{}down: {} of 1000 not felt", right_for_down, not_felt));
        CHECK(not_felt >= 970);
    }
}

} // namespace
} // namespace tactor::study::test_staircase
