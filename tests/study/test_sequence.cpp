// SPDX-License-Identifier: MIT
// Random draws, orders of trials, and their stimuli.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <ranges>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <tactor/tactor.hpp>

#include "caught.hpp"
#include "core/sha256.hpp"
#include "folder.hpp"
#include "has.hpp"
#include "sequences.hpp"
#include "study/experiment/trials.hpp"
#include "study/random/random.hpp"
#include "study/session/questions.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study::test_sequence {
namespace {

constexpr std::uint64_t seeds = 10000;

std::string order_text(std::size_t n, const std::string& code)
{
    experiment_definition d;
    d.runs.resize(n);
    std::string text;
    for (const std::size_t r : square_row(d.order, n, default_row(d, code) - 1))
        text += std::to_string(r + 1);
    return text;
}

// Returns the levels in the order in which their trials come; a level that comes back is there twice.
std::vector<std::size_t> list_levels(const std::vector<planned_trial>& trials,
                                     std::size_t planned_trial::*level)
{
    std::vector<std::size_t> levels;
    for (const planned_trial& t : trials)
        if (levels.empty() || levels.back() != t.*level)
            levels.push_back(t.*level);
    return levels;
}

std::vector<std::size_t> list_runs(const std::vector<run_sequence>& all)
{
    std::vector<std::size_t> runs;
    for (const run_sequence& s : all)
        runs.push_back(s.run);
    return runs;
}

const std::string rate_24 = "task = \"rate\"\nattribute = \"similarity\"\ntrials = 24\n";

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
        const std::size_t rows = count_square_rows("williams", n);
        CHECK(rows == (n % 2 == 0 ? n : 2 * n));
        std::map<std::pair<std::size_t, std::size_t>, std::size_t> at;
        std::map<std::pair<std::size_t, std::size_t>, std::size_t> after;
        for (std::size_t row = 0; row < rows; ++row) {
            const std::vector<std::size_t> order = square_row("williams", n, row);
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

TEST_CASE("a random order of the runs is the participant's, and none is favoured")
{
    experiment_definition d =
        with_run(rate_24 + "[[run]]\nname = \"s\"\n" + rate_24 + "[[run]]\nname = \"t\"\n" + rate_24);
    d.order = "random";
    CHECK(count_rows(d) == 1);
    std::map<std::vector<std::size_t>, double> orders;
    for (unsigned code = 0; code < 600; ++code)
        ++orders[list_runs(make_sequence(d, std::to_string(code), 7))];
    REQUIRE(orders.size() == 6);
    std::vector<double> counts;
    for (const auto& [order, n] : orders)
        counts.push_back(n);
    CHECK(p_of_equal(counts) > 1e-4);
}

TEST_CASE("a row replaces that of the code, and leaves the participant's trials")
{
    const experiment_definition d = load_definition("park2016");
    CHECK(count_rows(d) == 4);
    CHECK(default_row(d, "P07") == 3);
    const std::vector<run_sequence> own = make_sequence(d, "P07", 1);
    const std::vector<run_sequence> other = make_sequence(d, "P07", 1, 2);
    CHECK(list_runs(other) == list_runs(make_sequence(d, "P02", 1)));
    CHECK(list_runs(other) != list_runs(own));
    for (const run_sequence& s : other)
        CHECK(std::find(own.begin(), own.end(), s) != own.end());
}

TEST_CASE("blocks keep the trials of a level together, each cell equally often")
{
    for (const bool by_method : {true, false}) {
        const auto level = by_method ? &planned_trial::method_1 : &planned_trial::motion;
        const experiment_definition d =
            with_run(rate_24 + fmt::format("blocks = \"{}\"\n", by_method ? "methods" : "motions"));
        const std::size_t levels = by_method ? 2 : 4;
        REQUIRE(count_rows(d) == levels);
        std::set<std::vector<std::size_t>> orders;
        for (std::size_t row = 1; row <= levels; ++row) {
            const run_sequence s = make_run(d, 0, "01", 5, row);
            CHECK(list_levels(s.trials, level).size() == levels);
            orders.insert(list_levels(s.trials, level));
            std::map<std::pair<std::size_t, std::size_t>, int> cells;
            for (const planned_trial& t : s.trials)
                ++cells[{t.motion, t.method_1}];
            CHECK(cells.size() == 8);
            CHECK(std::all_of(cells.begin(), cells.end(), [](const auto& c) { return c.second == 3; }));
        }
        CHECK(orders.size() == levels);
    }
}

TEST_CASE("over all rows each order of the runs meets each order of the blocks")
{
    const std::string blocks = rate_24 + "blocks = \"motions\"\n";
    experiment_definition d = with_run(blocks + "[[run]]\nname = \"s\"\n" + blocks, 3);
    for (const auto& [order, rows] : std::map<std::string, std::size_t>{{"williams", 12}, {"latin", 6}}) {
        d.order = order;
        REQUIRE(count_rows(d) == rows);
        std::set<std::pair<std::vector<std::size_t>, std::vector<std::size_t>>> seen;
        for (std::size_t row = 1; row <= rows; ++row) {
            const std::vector<run_sequence> all = make_sequence(d, "01", 5, row);
            seen.insert({list_runs(all), list_levels(all[0].trials, &planned_trial::motion)});
        }
        CHECK(seen.size() == rows);
    }
    d.order = "random";
    CHECK(list_levels(make_run(d, 0, "01", 5).trials, &planned_trial::motion).size() == 3);
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
                const bool pair = d.runs[s.run].outline.task == &find_task("choose");
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

// Returns the difference between the largest and the smallest count of so many keys.
int spread(const std::map<std::array<std::size_t, 3>, int>& counts, std::size_t keys)
{
    const auto [least, most] = std::ranges::minmax(std::views::values(counts));
    return most - (counts.size() < keys ? 0 : least);
}

TEST_CASE("pairs come equally often, in each motion and order too, as far as the number allows")
{
    for (const std::size_t methods : {3U, 4U, 5U})
        for (const unsigned n : {1U, 5U, 12U, 31U, 60U}) {
            const experiment_definition d =
                with_run(fmt::format("task = \"choose\"\nattribute = \"similarity\"\ntrials = {}\n", n), 2,
                         static_cast<unsigned>(methods));
            const std::size_t pairs = methods * (methods - 1) / 2;
            for (std::uint64_t seed = 0; seed < 20; ++seed) {
                std::array<std::map<std::array<std::size_t, 3>, int>, 5> counts;
                for (const planned_trial& t : make_run(d, 0, "01", seed).trials) {
                    const auto [low, high] = std::minmax(t.method_1, *t.method_2);
                    ++counts[0][{t.motion}];
                    ++counts[1][{low, high}];
                    ++counts[2][{t.method_1, *t.method_2}];
                    ++counts[3][{low, high, t.motion}];
                    ++counts[4][{t.method_1, *t.method_2, t.motion}];
                }
                for (std::size_t i = 0; i < 5; ++i)
                    CHECK(spread(counts[i],
                                 std::array{std::size_t{2}, pairs, 2 * pairs, 2 * pairs, 4 * pairs}[i]) <= 1);
            }
        }
}

TEST_CASE("of three stimuli each differs equally often in each interval, as far as the number allows")
{
    const std::string values = "vary = \"speed_mm_s\"\nvalues = [40, 60]\nstandard = 50\n";
    for (const bool varies : {false, true})
        for (const unsigned motions : {1U, 2U, 3U})
            for (const unsigned n : {1U, 3U, 5U, 6U, 7U, 12U, 24U, 31U, 72U, 75U}) {
                const experiment_definition d =
                    with_run(fmt::format("task = \"oddity\"\nquestion = \"?\"\nmax_in_a_row = 100\n{}"
                                         "trials = {}\n",
                                         varies ? values : "", n),
                             motions, 2);
                for (std::uint64_t seed = 0; seed < 20; ++seed) {
                    std::array<std::map<std::array<std::size_t, 3>, int>, 5> counts;
                    for (const planned_trial& t : make_run(d, 0, "01", seed).trials) {
                        const std::array all{t.method_1, t.method_2.value(), t.method_3.value()};
                        std::size_t place = 0;
                        while (std::ranges::count(all, all[place]) != 1)
                            ++place;
                        const std::size_t odd = all[place];
                        const std::size_t other = all[(place + 1) % 3];
                        CHECK(std::ranges::count(all, other) == 2);
                        // Without values method 0 or 1 differs, else a value or the standard.
                        const std::size_t which =
                            varies ? (d.methods[odd].name == "standard" ? 1U : 0U) : odd;
                        ++counts[0][{place}];
                        ++counts[1][{which}];
                        ++counts[2][{place, which}];
                        ++counts[3][{t.motion}];
                        ++counts[4][{t.motion, odd, other}];
                    }
                    for (std::size_t i = 0; i < 4; ++i)
                        CHECK(spread(counts[i], std::array<std::size_t, 4>{3, 2, 6, motions}[i]) <= 1);
                    if (n % (6 * motions * (varies ? 4 : 1)) == 0)
                        CHECK(spread(counts[4], counts[4].size()) == 0);
                }
            }
}

TEST_CASE("adjustments begin below and above the standard equally often, with each method too")
{
    for (const unsigned motions : {1U, 2U})
        for (const unsigned n : {1U, 2U, 5U, 6U, 12U, 20U, 24U, 40U}) {
            const experiment_definition d =
                with_run(fmt::format("task = \"adjust\"\nquestion = \"?\"\nmax_in_a_row = 100\n"
                                     "vary = \"speed_mm_s\"\nrange = [40, 80]\nstandard = 60\ntrials = {}\n",
                                     n),
                         motions, 2);
            for (std::uint64_t seed = 0; seed < 20; ++seed) {
                std::array<std::map<std::array<std::size_t, 3>, int>, 3> counts;
                std::map<std::size_t, std::map<std::array<std::size_t, 3>, int>> by_method;
                for (const planned_trial& t : make_run(d, 0, "01", seed).trials) {
                    const bool first = d.methods[t.method_1].name == "standard";
                    const std::size_t moved = first ? t.method_2.value() : t.method_1;
                    const std::size_t above = *d.methods[moved].value > 60.0 ? 1 : 0;
                    CHECK(*d.methods[moved].value != 60.0);
                    ++counts[0][{above}];
                    ++counts[1][{*d.methods[moved].made_of}];
                    ++counts[2][{first ? 0U : 1U}];
                    ++by_method[*d.methods[moved].made_of][{above}];
                }
                CHECK(spread(counts[0], 2) <= 1);
                CHECK(spread(counts[1], 2) <= 1);
                CHECK(spread(counts[2], 2) <= 2);
                for (const auto& [method, sides] : by_method)
                    CHECK(spread(sides, 2) <= (motions == 1 ? 1 : 2));
                if (n % (8 * motions) == 0)
                    CHECK(spread(counts[2], 2) == 0);
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
    const experiment_definition pairs =
        with_run("task = \"choose\"\nattribute = \"uniformity\"\ntrials = 5\n", 2, 3);
    std::map<std::array<std::size_t, 3>, double> kinds;
    for (std::uint64_t seed = 0; seed < seeds; ++seed)
        for (const planned_trial& t : make_run(pairs, 0, "01", seed).trials)
            ++kinds[{t.motion, t.method_1, *t.method_2}];
    cells.clear();
    for (const auto& [kind, count] : kinds)
        cells.push_back(count);
    CHECK(cells.size() == 12);
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
    other.outline.name = "mine";
    CHECK(make_run(other, 0, "01", 1).trials != s.trials);
}

TEST_CASE("orders are the same on every machine")
{
    std::string text;
    std::string practice;
    for (const run_sequence& s : make_sequence(load_definition("park2016"), "P07", 2016)) {
        for (const planned_trial& t : s.trials)
            text += fmt::format("{}{}{} ", t.motion, t.method_1, t.method_2.value_or(9));
        for (const planned_trial& t : s.practice)
            practice += fmt::format("{}{}{} ", t.motion, t.method_1, t.method_2.value_or(9));
    }
    CHECK(practice == "109 019 319 209 009 109 219 319 010 110 201 301 010 101 301 210 ");
    CHECK(detail::sha256_text(text) == "866bef5c522d737ae0444c7727c23b761f1c856c82d5569e5061dbc08b59e25e");
    CHECK(default_seed("abc") == 0xba7816bf);
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

TEST_CASE("xoshiro256** draws the numbers of its authors' program")
{
    random_numbers r(std::array<std::uint64_t, 4>{1, 2, 3, 4});
    for (const std::uint64_t known : {11520ULL, 0ULL, 1509978240ULL, 1215971899390074240ULL})
        CHECK(r.next() == known);
}

TEST_CASE("no number below n is favoured")
{
    random_numbers r("below");
    std::vector<double> counts(7);
    for (int i = 0; i < 70000; ++i)
        ++counts.at(r.below(7));
    CHECK(p_of_equal(counts) > 1e-3);
    // 3 * 2^30: without Lemire's rejections, the lowest quarter comes twice as often as the others.
    const std::uint32_t n = 3U << 30;
    std::vector<double> thirds(3);
    for (int i = 0; i < 30000; ++i)
        ++thirds.at(r.below(n) % 3);
    CHECK(p_of_equal(thirds) > 1e-3);
    CHECK(r.below(1) == 0);
}

TEST_CASE("all orders are equally likely")
{
    random_numbers r("shuffle");
    std::vector<double> counts(24);
    for (int i = 0; i < 24000; ++i) {
        std::array<unsigned, 4> v{0, 1, 2, 3};
        shuffle(std::span<unsigned>(v), r);
        unsigned rank = 0; // of the order, by its inversions
        for (std::size_t k = 0; k < v.size(); ++k) {
            unsigned smaller = 0;
            for (std::size_t m = k + 1; m < v.size(); ++m)
                smaller += v[m] < v[k] ? 1 : 0;
            rank = rank * static_cast<unsigned>(v.size() - k) + smaller;
        }
        ++counts.at(rank);
    }
    CHECK(p_of_equal(counts) > 1e-3);
}

TEST_CASE("normal numbers have mean 0 and variance 1")
{
    random_numbers r("normal");
    double sum = 0.0;
    double squares = 0.0;
    constexpr int n = 40000;
    for (int i = 0; i < n; ++i) {
        const double x = r.normal();
        sum += x;
        squares += x * x;
    }
    CHECK(std::abs(sum / n) < 0.02);
    CHECK(std::abs(squares / n - 1.0) < 0.03);
}

TEST_CASE("a stimulus that cannot be planned or played is refused with its motion and method")
{
    const auto refusal = [](const std::string& motion, const std::string& level,
                            const std::string& more = "") {
        const std::string text =
            "[experiment]\nname = \"x\"\nlevel = " + level + "\n[[motion]]\nname = \"m\"\n" + motion +
            "\n[[method]]\nname = \"brush\"\nalgorithm = \"tactile-brush\"\n" + more +
            "[[run]]\nname = \"r\"\ntask = \"rate\"\nattribute = \"similarity\"\ntrials = 2\n";
        const experiment_definition d = read_definition(text, "x.toml", {});
        render_options o{.level_dbfs = d.level_dbfs.value_or(-12.0)};
        if (!d.level_dbfs)
            o.sl_db = d.sl_db;
        return caught_message([&] { stimulus_set(d, felt_array(), o); });
    };
    CHECK(refusal("path = \"M0 0H40\"", "{ dbfs = -12 }").empty());
    const std::string off = refusal("path = \"M0 0H90\"", "{ dbfs = -12 }");
    CHECK_MESSAGE(has(off, "x.toml:4:"), off);
    CHECK_MESSAGE(has(off, "motion \"m\" with method \"brush\" (line 7)"), off);
    has(refusal("path = \"M0 0H40\"\nduration = 0.01", "{ dbfs = -12 }"), "method \"brush\"");
    const std::string loud = refusal("path = \"M0 0H40\"", "{ sl_db = 60 }");
    CHECK_MESSAGE(has(loud, "lower level.sl_db by"), loud);
    const std::string own = refusal("path = \"M0 0H40\"", "{ dbfs = -12 }", "sl_db = 60\n");
    CHECK_MESSAGE(has(own, "x.toml:10:9: motion \"m\" with method \"brush\", tactor "), own);
    CHECK_MESSAGE(has(own, "lower sl_db by"), own);
}

std::vector<std::byte> samples(const score& s)
{
    std::vector<std::byte> all(s.frames() * s.channels() * sample_bytes(format_kind::s32));
    renderer(s, format_kind::s32).process(all);
    return all;
}

experiment_definition with_methods(const std::string& motion, const std::string& methods,
                                   const std::filesystem::path& in = {})
{
    return read_definition("[experiment]\nname = \"x\"\ngap_s = 0.01\n[[motion]]\nname = \"m\"\n" + motion +
                               methods +
                               "[[run]]\nname = \"r\"\ntask = \"rate\"\nattribute = \"similarity\"\n"
                               "trials = 2\n",
                           "x.toml", in);
}

TEST_CASE("each stimulus of a pair sounds as its stroke with the options of its method alone")
{
    const folder f;
    const auto file = f.write("s.toml", "[stroke]\npath = \"M0 20H40\"\nduration_s = 0.7\n"
                                        "carrier_hz = 100.0\nwaveform = \"triangle\"\n");
    const experiment_definition d =
        with_methods("file = \"s.toml\"\n",
                     "[[method]]\nname = \"rough\"\nwaveform = \"square\"\nam = \"30:0.5\"\ncarrier = 200\n"
                     "envelope = \"linear\"\nattack = 0.005\nphase = \"burst\"\nlevel_dbfs = -30\n"
                     "[[method]]\nname = \"smooth\"\nalgorithm = \"continuous\"\nsl_db = 10\n",
                     f.path());
    array a = felt_array();
    for (tactor_spec& t : a.tactors)
        t.rise_s = 0.01; // bursts have a boost, which depends on the level
    const stimulus_set all(d, a, {.sl_db = 7.0});

    stroke drawn = load_strokes(file).front();
    const score smooth(a, make_plan(a, drawn, {.algorithm = algorithm_kind::continuous}), {.sl_db = 10.0});
    drawn.sound = {};
    plan_options o;
    o.carrier_hz = 200.0;
    o.wave.kind = waveform_kind::square;
    o.am = {30.0, 0.5};
    const score rough(a, make_plan(a, drawn, o),
                      {.phase = phase_kind::burst,
                       .level_dbfs = -30.0,
                       .envelope = {.kind = envelope_kind::linear, .attack_s = 0.005}});

    CHECK(samples(all.make_score({0, 0})) == samples(rough));
    const std::size_t frame = samples(smooth).size() / smooth.frames();
    std::vector<std::byte> both = samples(rough);
    both.resize(both.size() + 480 * frame); // the gap
    const std::vector<std::byte> second = samples(smooth);
    both.insert(both.end(), second.begin(), second.end());
    const score pair = all.make_score({0, 0, 1});
    CHECK(pair.frames() == all.count_frames({0, 0, 1}));
    CHECK(pair.starts() == all.starts({0, 0, 1}));
    CHECK(samples(pair) == both);

    both.resize(both.size() + 480 * frame);
    const std::vector<std::byte> third = samples(rough);
    both.insert(both.end(), third.begin(), third.end());
    const score three = all.make_score({0, 0, 1, 0});
    CHECK(three.frames() == all.count_frames({0, 0, 1, 0}));
    CHECK(three.starts() == all.starts({0, 0, 1, 0}));
    CHECK(samples(three) == both);
}

TEST_CASE("of two intervals one sounds, and the other is silence that is as long")
{
    const experiment_definition d =
        read_definition("[experiment]\nname = \"x\"\ngap_s = 0.01\n"
                        "[[motion]]\nname = \"m\"\npath = \"M0 20H40\"\n[[method]]\nname = \"a\"\n"
                        "[[run]]\nname = \"r\"\ntask = \"interval\"\nvary = \"speed_mm_s\"\n"
                        "values = [40, 80]\ntrials_per_value = 2\n",
                        "x.toml", {});
    const stimulus_set all(d, felt_array(), {});
    std::set<std::pair<double, bool>> played; // value, and whether the silence comes first
    for (const planned_trial& t : make_run(d, 0, "01", 1).trials) {
        const std::uint64_t length = all.at(t.motion, t.method_1).frames;
        CHECK(all.at(t.motion, *t.method_2).frames == length);
        const score s = all.make_score(t);
        const std::vector<std::byte> bytes = samples(s);
        const std::size_t frame = bytes.size() / s.frames();
        const auto sounds = [&](std::uint64_t from) {
            const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(from * frame);
            return std::any_of(begin, begin + static_cast<std::ptrdiff_t>(length * frame),
                               [](std::byte b) { return b != std::byte{0}; });
        };
        const bool silence_first = d.methods[t.method_1].name == "none";
        CHECK(sounds(0) == !silence_first);
        CHECK(sounds(all.starts(t)[1]) == silence_first);
        played.emplace(*find_value(d, t), silence_first);
    }
    CHECK(played.size() == 4);
}

TEST_CASE("a stimulus is compared with its motion in the time of the stroke that is played")
{
    const experiment_definition d = with_methods("path = \"M0 20H40\"\nduration = 0.7\n",
                                                 "[[method]]\nname = \"slow\"\nduration = 1.4\n"
                                                 "[[method]]\nname = \"beside\"\npath = \"M0 0H40\"\n"
                                                 "duration = 1.4\n");
    const stimulus_set all(d, felt_array(), {});
    CHECK(all.at(0, 0).made.plans[0].plan.stroke_duration_s == 1.4);
    CHECK(*all.at(0, 0).felt.rms_error_mm < 8.0);
    CHECK(*all.at(0, 1).felt.rms_error_mm > 12.0);
    for (const std::size_t method : {0, 1})
        CHECK(all.at(0, method).felt_paths[0].back().x_mm > 25.0); // not where it is after half the time
}

TEST_CASE("a motion of several strokes plays as its file, from its first stroke on")
{
    const folder f;
    const auto file = f.write("two.toml", "[[stroke]]\npath = \"M0 20H40\"\nduration_s = 0.7\nstart_s = 1.5\n"
                                          "[[stroke]]\npath = \"M20 40V0\"\nduration_s = 0.6\nstart_s = 1.0\n"
                                          "[[stroke]]\npath = \"M10 10\"\nduration_s = 0.2\n");
    const experiment_definition d =
        with_methods("file = \"two.toml\"\n", "[[method]]\nname = \"a\"\nlevel_dbfs = -30\n", f.path());
    const array a = felt_array();
    const stimulus_set all(d, a, {});

    const std::vector<stroke> drawn = load_strokes(file);
    const score alone(a,
                      {{make_plan(a, drawn[0], {}), 0.5},
                       {make_plan(a, drawn[1], {}), 0.0},
                       {make_plan(a, drawn[2], {}), {}}}, // when the one before it has sounded
                      {.level_dbfs = -30.0});
    CHECK(all.at(0, 0).frames == alone.frames());
    CHECK(all.make_score({0, 0, {}}).starts() == alone.starts());
    CHECK(samples(all.make_score({0, 0, {}})) == samples(alone));
    CHECK(find_duration_s(d.motions[0].strokes) == doctest::Approx(1.2));

    // The page shows a stroke only while it plays, on the array's hull.
    const auto shown = sample_target(d.motions[0].strokes, a, 12.0);
    REQUIRE(shown.size() == 3);
    CHECK(!shown[0][4]);
    REQUIRE(shown[0][12]);
    CHECK(shown[0][12]->x_mm == doctest::Approx(40.0));
    REQUIRE(shown[1][0]);
    CHECK(shown[1][0]->y_mm == doctest::Approx(40.0));
    CHECK(!shown[1][7]);
    CHECK(!shown[2][5]);
    CHECK(shown[2][7] == point{10.0, 10.0});
}

TEST_CASE("strokes vary together: their distance, their length, their turn about a common middle")
{
    const folder f;
    f.write("two.toml", "[[stroke]]\npath = \"M15 20H16\"\nduration_s = 0.4\nstart_s = 0\n"
                        "[[stroke]]\npath = \"M25 20H24\"\nduration_s = 0.4\nstart_s = 0\n");
    const auto plan = [&f](const std::string& motion, const std::string& vary, const std::string& values) {
        const experiment_definition d = read_definition(
            fmt::format("[experiment]\nname = \"x\"\nlevel = {{ dbfs = -30 }}\n[[motion]]\nname = \"m\"\n{}"
                        "[[method]]\nname = \"a\"\nalgorithm = \"continuous\"\nphantom = \"barycentric\"\n"
                        "[[run]]\nname = \"r\"\ntask = \"constant\"\nquestion = \"?\"\nchoices = [\"1\", "
                        "\"2\"]\nvary = \"{}\"\n"
                        "values = {}\ntrials = 4\n",
                        motion, vary, values),
            "x.toml", f.path());
        return stimulus_set(d, felt_array(), {});
    };
    const auto starts = [&plan](const std::string& vary, const std::string& values) {
        const stimulus_set all = plan("file = \"two.toml\"\n", vary, values);
        std::vector<std::vector<point>> firsts;
        for (const stimulus& s : all.all())
            firsts.push_back({s.felt_paths[0].front(), s.felt_paths[1].front()});
        return firsts;
    };
    const auto near_points = [](const std::vector<point>& felt, point a, point b) {
        return distance_mm(felt[0], a) < 1e-6 && distance_mm(felt[1], b) < 1e-6;
    };
    const auto apart = starts("apart_mm", "[6, 30]");
    CHECK(near_points(apart[0], {17.0, 20.0}, {23.0, 20.0}));
    CHECK(near_points(apart[1], {5.0, 20.0}, {35.0, 20.0}));
    const auto length = starts("length_mm", "[1, 2]"); // of the first: all is twice as large
    CHECK(near_points(length[0], {15.0, 20.0}, {25.0, 20.0}));
    CHECK(near_points(length[1], {10.0, 20.0}, {30.0, 20.0}));
    const auto turned = starts("rotate_deg", "[0, 90]");
    CHECK(near_points(turned[1], {20.0, 15.0}, {20.0, 25.0}));
    has(caught_message([&] { plan("path = \"M0 0H9\"\n", "apart_mm", "[1, 2]"); }),
        "no two strokes start at different places");
}

TEST_CASE("methods that make the same stimulus are named")
{
    const experiment_definition d = with_methods("path = \"M0 20H40\"\nduration = 0.7\n",
                                                 "[[method]]\nname = \"a\"\n"
                                                 "[[method]]\nname = \"b\"\noutside = \"clamp\"\n"
                                                 "[[method]]\nname = \"c\"\nramp = 0.01\n");
    std::vector<std::string> named = stimulus_set(d, felt_array(), {}).warnings();
    std::erase_if(named, [](const std::string& w) { return w.find("same stimulus") == w.npos; });
    CHECK(named == std::vector<std::string>{"motion \"m\": methods \"a\" and \"b\" make the same stimulus"});
}

} // namespace
} // namespace tactor::study::test_sequence
