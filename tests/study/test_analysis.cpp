// SPDX-License-Identifier: MIT
#include "study/analysis/analysis.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <doctest/doctest.h>

namespace tactor::study::test_analysis {
namespace {

bool warns(const analysis& a, const std::string& text)
{
    const auto has = [&text](const std::vector<std::string>& all) {
        return std::find(all.begin(), all.end(), text) != all.end();
    };
    return has(a.warnings) || has(a.no_figures);
}

run_outline run(const std::string& name, task_kind task, unsigned trials)
{
    run_outline r;
    r.name = name;
    r.task = task;
    r.motions = {"m"};
    r.methods = {"a", "b"};
    r.trials = trials;
    return r;
}

// Makes trials of one motion, in which the second method was chosen.
run_data chosen(unsigned trials)
{
    run_data d;
    for (unsigned i = 1; i <= trials; ++i)
        d.trials.push_back({.place = i, .method_1 = i % 2, .method_2 = 1 - i % 2, .response = 1 + i % 2});
    return d;
}

TEST_CASE("missing trials are reported with their participants")
{
    dataset d;
    d.experiment.runs = {run("pairs", task_kind::choose, 4)};
    d.participants = {"1", "2", "3", "4"};
    d.data = {{chosen(4)}, {chosen(3)}, {chosen(5)}, {chosen(0)}};
    const analysis a = analyse(d);
    CHECK(warns(a, "pairs: sub-2 has 3 trials that count, of 4"));
    CHECK(warns(a, "pairs: sub-3 has 5 trials that count, of 4"));
    CHECK(warns(a, "pairs: sub-4 is left out: no trial that counts"));
    const auto named = std::count_if(a.warnings.begin(), a.warnings.end(), [](const std::string& w) {
        return w.find("that count, of") != std::string::npos;
    });
    CHECK(named == 2);
    d.experiment.runs[0].trials = 0; // the definition does not give their number
    CHECK_FALSE(warns(analyse(d), "pairs: sub-2 has 3 trials that count, of 0"));
}

// The first method is always rated 1, the second 5, except for some fours.
run_data rated(unsigned trials, unsigned fours)
{
    run_data d;
    for (unsigned i = 0; i < 2 * trials; ++i)
        d.trials.push_back({.place = i + 1,
                            .method_1 = i % 2,
                            .response = i % 2 == 0      ? 1U
                                        : i / 2 < fours ? 4U
                                                        : 5U});
    return d;
}

TEST_CASE("an effect too large for an interval is reported")
{
    dataset d;
    d.experiment.runs = {run("marks", task_kind::rate, 0)};
    d.participants = {"1", "2"};
    const std::string text = "marks: methods: the effect is too large for an interval";
    d.data = {{rated(2000, 0)}, {rated(2000, 1)}}; // t = 16000
    analysis a = analyse(d);
    CHECK(warns(a, text));
    CHECK(a.runs[0].paired.t);
    CHECK_FALSE(a.runs[0].paired.d_ci);
    d.data = {{rated(1000, 0)}, {rated(1000, 1)}}; // t = 8000
    a = analyse(d);
    CHECK_FALSE(warns(a, text));
    CHECK(a.runs[0].paired.d_ci);
    d.data = {{rated(1000, 0)}, {rated(1000, 0)}}; // no t at all
    CHECK_FALSE(warns(analyse(d), text));
}

} // namespace
} // namespace tactor::study::test_analysis
