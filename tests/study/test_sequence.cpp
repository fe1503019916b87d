// SPDX-License-Identifier: MIT
#include "study/experiment/sequence.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>

#include <boost/math/distributions/chi_squared.hpp>
#include <doctest/doctest.h>
#include <fmt/format.h>

#include "caught.hpp"
#include "core/sha256.hpp"
#include "has.hpp"

namespace tactor::study::test_sequence {
namespace {

constexpr std::uint64_t seeds = 10000;

experiment_definition with_run(const std::string& run, unsigned motions = 4)
{
    std::string text = "[experiment]\nname = \"e\"\n";
    for (unsigned i = 1; i <= motions; ++i)
        text += fmt::format("[[motion]]\nname = \"m{}\"\npath = \"M0 0H{}\"\n", i, 10 * i);
    text += "[[method]]\nname = \"a\"\nalgorithm = \"tactile-brush\"\n[[method]]\nname = \"b\"\n";
    return read_definition(text + "[[run]]\nname = \"r\"\n" + run, "e.toml", {});
}

std::string order_text(std::size_t n, const std::string& code)
{
    std::string text;
    for (const std::size_t r : run_order(n, code))
        text += std::to_string(r + 1);
    return text;
}

// Returns the probability of counts so far from equal, if all are equally likely.
double p_of_equal(const std::vector<double>& counts)
{
    double sum = 0.0;
    for (const double c : counts)
        sum += c;
    const double expected = sum / static_cast<double>(counts.size());
    double chi2 = 0.0;
    for (const double c : counts)
        chi2 += (c - expected) * (c - expected) / expected;
    const boost::math::chi_squared d(static_cast<double>(counts.size() - 1));
    return boost::math::cdf(boost::math::complement(d, chi2));
}

TEST_CASE("four runs come in the paper's Williams square")
{
    CHECK(order_text(4, "01") == "1243");
    CHECK(order_text(4, "P02") == "2314");
    CHECK(order_text(4, "x3") == "3421");
    CHECK(order_text(4, "4") == "4132");
    CHECK(order_text(4, "5") == "1243");
    CHECK(order_text(4, "0") == "4132");
    CHECK(order_text(4, "P100000000000000000000000000001") == "1243");
    CHECK(order_text(1, "7") == "1");
}

TEST_CASE("a code without a number gets a row of the square too, and codes use them all")
{
    std::set<std::string> seen;
    for (const char* code : {"ada", "bob", "eve", "mallory", "zoe", "kim", "lee", "ann", "tom", "sue"})
        seen.insert(order_text(4, code));
    CHECK(seen == std::set<std::string>{"1243", "2314", "3421", "4132"});
}

TEST_CASE("over all rows each run is at each place, and after each other, equally often")
{
    for (std::size_t n = 2; n <= 7; ++n) {
        const std::size_t rows = n % 2 == 0 ? n : 2 * n;
        std::map<std::pair<std::size_t, std::size_t>, std::size_t> at;
        std::map<std::pair<std::size_t, std::size_t>, std::size_t> after;
        for (std::size_t row = 0; row < rows; ++row) {
            const std::vector<std::size_t> order = run_order(n, std::to_string(row + 1));
            for (std::size_t i = 0; i < n; ++i) {
                ++at[{i, order[i]}];
                if (i > 0)
                    ++after[{order[i - 1], order[i]}];
            }
        }
        CHECK(at.size() == n * n);
        CHECK(after.size() == n * (n - 1));
        CHECK(std::all_of(at.begin(), at.end(), [&](const auto& c) { return c.second == rows / n; }));
        CHECK(std::all_of(after.begin(), after.end(), [&](const auto& c) { return c.second == rows / n; }));
    }
}

TEST_CASE("each motion and order comes equally often, and no motion four times in a row")
{
    const experiment_definition d = load_definition("park2016");
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        for (const run_sequence& s : make_sequence(d, "01", seed)) {
            REQUIRE(s.trials.size() == 40);
            std::map<std::pair<std::size_t, std::size_t>, int> cells;
            std::size_t row = 0;
            for (std::size_t i = 0; i < 40; ++i) {
                ++cells[{s.trials[i].motion, s.trials[i].method_1}];
                row = i > 0 && s.trials[i].motion == s.trials[i - 1].motion ? row + 1 : 1;
                CHECK(row <= 3);
                const bool pair = d.runs[s.run].outline.task == task_kind::choose;
                CHECK(s.trials[i].method_2.has_value() == pair);
                CHECK((!pair || *s.trials[i].method_2 != s.trials[i].method_1));
            }
            CHECK(cells.size() == 8);
            CHECK(std::all_of(cells.begin(), cells.end(), [](const auto& c) { return c.second == 5; }));
            CHECK(s.practice.size() == 4);
        }
    }
}

TEST_CASE("a number that does not divide gives counts that differ by one at most")
{
    for (const unsigned n : {1U, 3U, 6U, 7U, 13U, 22U}) {
        const experiment_definition d =
            with_run(fmt::format("task = \"choose\"\nattribute = \"similarity\"\ntrials = {}\n", n), 3);
        for (std::uint64_t seed = 0; seed < 50; ++seed) {
            std::array<int, 3> motions{};
            std::array<int, 6> cells{};
            for (const planned_trial& t : make_run(d, 0, "01", seed).trials) {
                ++motions[t.motion];
                ++cells[t.motion * 2 + t.method_1];
            }
            CHECK(*std::max_element(motions.begin(), motions.end()) -
                      *std::min_element(motions.begin(), motions.end()) <=
                  1);
            CHECK(*std::max_element(cells.begin(), cells.end()) -
                      *std::min_element(cells.begin(), cells.end()) <=
                  1);
        }
    }
}

TEST_CASE("over 10,000 seeds no motion, order or position is favoured")
{
    const experiment_definition d = load_definition("park2016");
    std::vector<std::vector<double>> cells(40, std::vector<double>(8, 0.0));
    std::vector<double> after(16, 0.0);
    std::vector<double> first(2, 0.0);
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        const run_sequence s = make_run(d, 0, "01", seed);
        for (std::size_t i = 0; i < 40; ++i) {
            ++cells[i][s.trials[i].motion * 2 + s.trials[i].method_1];
            if (i > 0)
                ++after[s.trials[i - 1].motion * 4 + s.trials[i].motion];
        }
        ++first[s.trials[0].method_1];
    }
    // Forty tests: the smallest p of forty fair ones is below 1e-4 in one of 250, and the seeds are fixed.
    for (const std::vector<double>& at : cells)
        CHECK(p_of_equal(at) > 1e-4);
    CHECK(p_of_equal(first) > 1e-4);
    // Sequences: of twelve pairs of different motions none is favoured, nor of the four repetitions.
    std::vector<double> others;
    std::vector<double> same;
    for (std::size_t i = 0; i < 16; ++i)
        (i % 5 == 0 ? same : others).push_back(after[i]);
    CHECK(p_of_equal(others) > 1e-4);
    CHECK(p_of_equal(same) > 1e-4);
}

TEST_CASE("the remainder is drawn fairly, too")
{
    const experiment_definition d = with_run("task = \"rate\"\nattribute = \"uniformity\"\ntrials = 3\n");
    std::vector<double> cells(8, 0.0);
    for (std::uint64_t seed = 0; seed < seeds; ++seed)
        for (const planned_trial& t : make_run(d, 0, "01", seed).trials)
            ++cells[t.motion * 2 + t.method_1];
    CHECK(p_of_equal(cells) > 1e-4);
}

TEST_CASE("seed, experiment, code and run each change the order, and the same ones give the same")
{
    const experiment_definition d = load_definition("park2016");
    const run_sequence s = make_run(d, 0, "01", 1);
    CHECK(make_run(d, 0, "01", 1) == s);
    CHECK(make_run(d, 0, "01", 2).trials != s.trials);
    CHECK(make_run(d, 0, "02", 1).trials != s.trials);
    CHECK(make_run(d, 1, "01", 1).trials != s.trials);
    experiment_definition other = d;
    other.name = "mine";
    CHECK(make_run(other, 0, "01", 1).trials != s.trials);
}

TEST_CASE("orders are the same on every machine")
{
    std::string text;
    for (const run_sequence& s : make_sequence(load_definition("park2016"), "P07", 2016))
        for (const planned_trial& t : s.trials)
            text += fmt::format("{}{}{} ", t.motion, t.method_1, t.method_2.value_or(9));
    CHECK(detail::sha256_text(text) == "866bef5c522d737ae0444c7727c23b761f1c856c82d5569e5061dbc08b59e25e");
    CHECK(default_seed("abc") == 0xba7816bf);
}

TEST_CASE("an impossible order is refused, and one motion is no order")
{
    const std::string many = "task = \"rate\"\nattribute = \"similarity\"\ntrials = 200\n";
    CHECK(has(caught_message([&] { make_run(with_run(many, 2), 0, "01", 1); }),
              "several runs with fewer trials"));
    CHECK(make_run(with_run(many, 1), 0, "01", 1).trials.size() == 200);
}

TEST_CASE("long runs try fewer orders, so that the refusal comes soon")
{
    static_assert(most_draws(1) == 1000000);
    static_assert(most_draws(200) == 1000000);
    static_assert(most_draws(10000) == 20000);
    const std::string many = "task = \"rate\"\nattribute = \"similarity\"\ntrials = 10000\n";
    CHECK(has(caught_message([&] { make_run(with_run(many, 2), 0, "01", 1); }), "no order of 10000 trials"));
}

TEST_CASE("random rests are in their range, the same each time, and leave the order as it is")
{
    experiment_definition d =
        with_run("task = \"rate\"\nattribute = \"similarity\"\ntrials = 40\npractice = 4\n");
    const run_sequence without = make_run(d, 0, "01", 7);
    d.rest = {2.0, 4.0};
    const run_sequence drawn = make_run(d, 0, "01", 7);
    CHECK(drawn == make_run(d, 0, "01", 7));
    std::set<double> rests;
    for (std::size_t i = 0; i < drawn.trials.size(); ++i) {
        CHECK(drawn.trials[i].motion == without.trials[i].motion);
        CHECK(drawn.trials[i].method_1 == without.trials[i].method_1);
        CHECK(without.trials[i].rest_s == 0.0);
        rests.insert(drawn.trials[i].rest_s);
    }
    CHECK(rests.size() > 20);
    CHECK(*rests.begin() >= 2.0);
    CHECK(*rests.rbegin() <= 4.0);
}

} // namespace
} // namespace tactor::study::test_sequence
