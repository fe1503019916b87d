// SPDX-License-Identifier: MIT
// Orders of trials in which no motion comes too often in a row.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "caught.hpp"
#include "has.hpp"
#include "sequences.hpp"
#include "study/experiment/trial_order.hpp"
#include "study/experiment/trials.hpp"
#include "study/random/random.hpp"

namespace tactor::study::test_trial_order {
namespace {

// Returns the length of the longest row of one motion.
std::size_t longest_row(std::span<const planned_trial> trials)
{
    std::size_t longest = 0;
    std::size_t row = 0;
    for (std::size_t i = 0; i < trials.size(); ++i) {
        row = i > 0 && trials[i].motion == trials[i - 1].motion ? row + 1 : 1;
        longest = std::max(longest, row);
    }
    return longest;
}

TEST_CASE("any number of trials with two motions and more has an order, each cell equally often")
{
    for (const unsigned n : {1U, 4U, 5U, 40U, 168U, 420U, 1001U, 10000U})
        for (const unsigned motions : {2U, 3U, 5U}) {
            CAPTURE(n);
            CAPTURE(motions);
            const auto trials =
                make_run(
                    with_run(fmt::format("task = \"rate\"\nattribute = \"similarity\"\ntrials = {}\n", n),
                             motions),
                    0, "01", 1)
                    .trials;
            CHECK(trials.size() == n);
            CHECK(longest_row(trials) <= 3);
            std::map<std::pair<std::size_t, std::size_t>, unsigned> cells;
            for (const planned_trial& t : trials)
                ++cells[{t.motion, t.method_1}];
            for (const auto& [cell, count] : cells)
                CHECK(count - n / (2 * motions) <= 1);
        }
    const std::string many = "task = \"rate\"\nattribute = \"similarity\"\ntrials = 200\n";
    CHECK(longest_row(make_run(with_run(many, 1), 0, "01", 1).trials) == 200);
}

TEST_CASE("a run with fewer trials than cells has an order too, in blocks and with catch trials")
{
    // Without care, the eight of 28 cells may all be of one motion.
    const std::string values =
        "question = \"?\"\nvary = \"level_dbfs\"\nvalues = [-60, -55, -50, -45, -40, -35, -30]\n";
    for (const std::string& run :
         {"task = \"constant\"\nstandard = -45\n" + values, "task = \"detect\"\ncatch = 0.25\n" + values,
          std::string("task = \"same-different\"\n"), std::string("task = \"identify\"\n")})
        for (const std::string& blocks : {std::string(), std::string("blocks = \"methods\"\n")})
            for (unsigned n = 1; n <= 14; ++n) {
                if (run.find("same") != std::string::npos && !blocks.empty())
                    continue;
                const experiment_definition d =
                    with_run(run + blocks + fmt::format("trials = {}\nmax_in_a_row = 2\n", n), 2);
                for (std::uint64_t seed = 0; seed < 40; ++seed) {
                    const std::vector<planned_trial> trials = make_run(d, 0, "01", seed).trials;
                    CAPTURE(run);
                    CAPTURE(n);
                    CAPTURE(seed);
                    REQUIRE(trials.size() == n);
                    std::map<std::size_t, std::vector<planned_trial>> parts; // by block
                    for (const planned_trial& t : trials)
                        parts[blocks.empty() ? 0 : d.methods[t.method_1].made_of.value_or(t.method_1)]
                            .push_back(t);
                    for (const auto& [part, own] : parts)
                        REQUIRE(longest_row(own) <= 2);
                }
            }
}

TEST_CASE("trials have an order exactly if one of all their permutations is one")
{
    for (const std::vector<std::size_t>& counts : std::vector<std::vector<std::size_t>>{
             {1, 2}, {1, 4}, {1, 5}, {2, 6}, {2, 7}, {3, 1, 1}, {6, 1, 0}, {7, 1, 1}, {2, 2, 2}, {1, 1, 5}})
        for (std::size_t most = 1; most <= 3; ++most) {
            std::vector<planned_trial> trials;
            for (std::size_t motion = 0; motion < counts.size(); ++motion)
                trials.insert(trials.end(), counts[motion], planned_trial{motion});
            bool possible = false;
            do
                possible = possible || longest_row(trials) <= most;
            while (std::ranges::next_permutation(trials, {}, &planned_trial::motion).found);
            CAPTURE(counts.size());
            CAPTURE(trials.size());
            CAPTURE(most);
            CHECK(has_order(trials, most) == possible);
            if (!possible)
                continue;
            random_numbers numbers("x");
            order_trials(trials, most, numbers);
            CHECK(longest_row(trials) <= most);
            for (std::size_t motion = 0; motion < counts.size(); ++motion)
                CHECK(static_cast<std::size_t>(std::ranges::count(trials, motion, &planned_trial::motion)) ==
                      counts[motion]);
        }
}

TEST_CASE("a short run is drawn until its order fits, so that a seed keeps its order")
{
    for (const unsigned n : {8U, 40U, 80U}) {
        const experiment_definition d =
            with_run(fmt::format("task = \"rate\"\nattribute = \"similarity\"\ntrials = {}\n", n), 2);
        for (std::uint64_t seed = 0; seed < 5; ++seed) {
            std::vector<planned_trial> drawn;
            for (std::size_t i = 0; i < n; ++i)
                drawn.push_back({i / 2 % 2, i % 2});
            random_numbers numbers(fmt::format("{}/e/01/r", seed));
            do
                shuffle(std::span(drawn), numbers);
            while (longest_row(drawn) > 3);
            CHECK(make_run(d, 0, "01", seed).trials == drawn);
        }
    }
}

TEST_CASE("an order that is built favours no motion at any place")
{
    constexpr std::size_t n = 420;
    const experiment_definition d =
        with_run(fmt::format("task = \"rate\"\nattribute = \"similarity\"\ntrials = {}\n", n), 2);
    constexpr std::array<std::size_t, 6> places{0, 1, 200, n - 3, n - 2, n - 1};
    std::array<std::array<double, 2>, places.size()> counts{};
    std::array<double, 2> follows{};
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
        const std::vector<planned_trial> trials = make_run(d, 0, "01", seed).trials;
        for (std::size_t i = 0; i < places.size(); ++i)
            ++counts[i][trials[places[i]].motion];
        ++follows[trials[100].motion == trials[300].motion ? 1 : 0];
    }
    for (const auto& own : counts)
        CHECK(p_of_equal({own.begin(), own.end()}) > 1e-4);
    CHECK(p_of_equal({follows.begin(), follows.end()}) > 1e-4);
}

TEST_CASE("max_in_a_row says how often a motion may come in a row")
{
    const std::string rate = "task = \"rate\"\nattribute = \"similarity\"\ntrials = 200\n";
    CHECK(longest_row(make_run(with_run(rate + "max_in_a_row = 2\n", 2), 0, "01", 1).trials) == 2);
    CHECK(longest_row(make_run(with_run(rate + "max_in_a_row = 100\n", 2), 0, "01", 1).trials) > 3);
    has(caught_message([&] { with_run(rate + "max_in_a_row = 1\n", 2); }), "max_in_a_row is 1");
}

} // namespace
} // namespace tactor::study::test_trial_order
