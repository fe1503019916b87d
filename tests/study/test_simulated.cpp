// SPDX-License-Identifier: MIT
// Simulated observers, and the power of studies with them.
#include "study/experiment/simulated.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <ranges>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <boost/math/distributions/normal.hpp>
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <tactor/tactor.hpp>

#include "caught.hpp"
#include "has.hpp"
#include "sequences.hpp"
#include "study/analysis/analysis.hpp"
#include "study/analysis/power.hpp"
#include "study/experiment/trials.hpp"
#include "study/statistics/bradley_terry.hpp"

namespace tactor::study::test_simulated {
namespace {

struct rig {
    experiment_definition d = load_definition("park2016");
    stimulus_set stimuli{d, felt_array(), {}};

    simulated_observer observer(std::size_t run, const std::string& spec) const
    {
        return {simulation_ = parse_simulation(spec), d, d.runs[run], stimuli, "01"};
    }
    mutable simulation simulation_ = {};
};

TEST_CASE("a choice takes the larger -ln cost plus noise, as often as the normal distribution says")
{
    const rig r;
    const simulated_observer o = r.observer(0, "seed=3,sigma=1");
    const double brush = *r.stimuli.at(0, 0).felt.rms_error_mm;
    const double park = *r.stimuli.at(0, 1).felt.rms_error_mm;
    const double p =
        boost::math::cdf(boost::math::normal(), (std::log(brush) - std::log(park)) / std::sqrt(2.0));
    constexpr unsigned n = 20000;
    unsigned chosen = 0;
    for (unsigned i = 1; i <= n; ++i)
        chosen += o.answer({0, 0, 1}, i, 1, false).response.number == 2 ? 1 : 0;
    CHECK(chosen / static_cast<double>(n) == doctest::Approx(p).epsilon(0.03));
}

TEST_CASE("an observer judges what simulate_as says, and refuses an attribute that it does not know")
{
    rig r;
    r.d.runs[0].attribute = "pleasantness";
    r.d.runs[0].simulate_as = "uniformity";
    r.d.runs[0].outline.name = r.d.runs[1].outline.name; // a part of the seed
    const auto answer = [&](std::size_t run) {
        return r.observer(run, "sigma=0").answer({0, 0, 1}, 1, 1, false).response.number;
    };
    CHECK(answer(0) == answer(1));
    r.d.runs[0].simulate_as.clear();
    has(caught_message([&] { answer(0); }), "cannot judge \"pleasantness\" (add simulate_as = ");
}

TEST_CASE("without noise the better one is chosen, in either place")
{
    const rig r;
    const simulated_observer o = r.observer(1, "sigma=0");
    const bool second = *r.stimuli.at(0, 1).felt.speed_cv < *r.stimuli.at(0, 0).felt.speed_cv;
    CHECK(o.answer({0, 0, 1}, 1, 1, false).response.number == (second ? 2 : 1));
    CHECK(o.answer({0, 1, 0}, 1, 1, false).response.number == (second ? 1 : 2));
}

TEST_CASE("without noise a rating is the middle plus the advantage of the cost over the mean")
{
    const rig r;
    double mean = 0.0;
    for (std::size_t m = 0; m < 4; ++m)
        for (std::size_t k = 0; k < 2; ++k)
            mean -= std::log(std::max(1e-3, *r.stimuli.at(m, k).felt.rms_error_mm)) / 8.0;
    const simulated_observer o = r.observer(2, "sigma=0");
    for (std::size_t m = 0; m < 4; ++m)
        for (std::size_t k = 0; k < 2; ++k) {
            const double u = -std::log(*r.stimuli.at(m, k).felt.rms_error_mm);
            const double rating = std::min(5.0, std::max(1.0, std::round(3.0 + u - mean)));
            CHECK(o.answer({m, k}, 1, 1, false).response.number == static_cast<unsigned>(rating));
        }
}

TEST_CASE("ratings stay on the scale, and noise uses all of it")
{
    rig r;
    const auto range = [&](const std::string& spec) {
        const simulated_observer o = r.observer(3, spec);
        unsigned low = 1000;
        unsigned high = 0;
        for (unsigned i = 1; i <= 500; ++i) {
            const unsigned a = o.answer({0, 0}, i, 1, false).response.number;
            low = std::min(low, a);
            high = std::max(high, a);
        }
        return std::pair(low, high);
    };
    CHECK(range("sigma=3") == std::pair(1U, 5U));
    r.d.runs[3].outline.scale = 100;
    r.d.runs[3].outline.visual = true;
    CHECK(range("sigma=60") == std::pair(0U, 100U));
}

TEST_CASE("an identification names the nearest target: the right one without noise, any with much")
{
    const std::string text = "[experiment]\nname = \"i\"\nlevel = { dbfs = -12 }\n"
                             "[[motion]]\nname = \"right\"\npath = \"M0 20H40\"\n"
                             "[[motion]]\nname = \"down\"\npath = \"M20 0V40\"\n"
                             "[[motion]]\nname = \"left\"\npath = \"M40 20H0\"\n"
                             "[[method]]\nname = \"park\"\n"
                             "[[run]]\nname = \"which\"\ntask = \"identify\"\ntrials = 9\n";
    const experiment_definition d = read_definition(text, "i.toml", {});
    const stimulus_set stimuli(d, felt_array(), {});
    const simulation exact = parse_simulation("sigma=0");
    const simulation blurred = parse_simulation("sigma=5000");
    const simulated_observer sharp(exact, d, d.runs[0], stimuli, "01");
    const simulated_observer dull(blurred, d, d.runs[0], stimuli, "01");
    unsigned right = 0;
    for (std::size_t m = 0; m < 3; ++m)
        for (unsigned i = 1; i <= 100; ++i) {
            CHECK(sharp.answer({m, 0}, i, 1, false).response.number == m + 1);
            right += dull.answer({m, 0}, i, 1, false).response.number == m + 1 ? 1 : 0;
        }
    CHECK(right > 50);
    CHECK(right < 250);
}

TEST_CASE("an answer depends on its place and attempt alone")
{
    const rig r;
    const simulated_observer o = r.observer(0, "seed=1,sigma=1");
    const simulated_answer a = o.answer({0, 0, 1}, 7, 1, false);
    o.answer({1, 1, 0}, 8, 1, false);
    const simulated_answer b = o.answer({0, 0, 1}, 7, 1, false);
    CHECK(a.response.number == b.response.number);
    CHECK(a.response_time_ms == b.response_time_ms);
    CHECK(o.answer({0, 0, 1}, 7, 2, false).response_time_ms != a.response_time_ms);
    CHECK(o.answer({0, 0, 1}, 7, 1, true).response_time_ms != a.response_time_ms);
}

TEST_CASE("a given share of the trials is void, and no practice")
{
    const rig r;
    const simulated_observer o = r.observer(0, "void=0.25");
    unsigned voids = 0;
    for (unsigned i = 1; i <= 4000; ++i) {
        voids += o.answer({0, 0, 1}, i, 1, false).is_void ? 1 : 0;
        CHECK(!o.answer({0, 0, 1}, i, 1, true).is_void);
    }
    CHECK(voids > 900);
    CHECK(voids < 1100);
}

TEST_CASE("the deviations of people correlate between methods")
{
    const experiment_definition d =
        read_definition("[experiment]\nname = \"c\"\nlevel = { dbfs = -12 }\n"
                        "[[motion]]\nname = \"right\"\npath = \"M0 20H40\"\n"
                        "[[method]]\nname = \"a\"\n[[method]]\nname = \"b\"\nphantom = \"linear\"\n"
                        "[[run]]\nname = \"far\"\ntask = \"adjust\"\nvary = \"length_mm\"\n"
                        "range = [0.5, 39.5]\nsteps = [0.5]\nstandard = 20\ntrials = 8\n",
                        "c.toml", {});
    const stimulus_set stimuli(d, felt_array(), {});
    const run_definition& r = d.runs[0];
    constexpr unsigned people = 1500;
    for (const double correlation : {0.0, 0.5, 1.0}) {
        const simulation s = parse_simulation(fmt::format("pse_sd=4,jnd=0.001,correlation={}", correlation));
        double sum = 0.0;
        double product = 0.0;
        double square = 0.0;
        for (unsigned i = 0; i < people; ++i) {
            const simulated_observer who(s, d, r, stimuli, fmt::format("{}", i));
            std::array<double, 2> settled{};
            for (std::size_t m = 0; m < 2; ++m)
                settled.at(m) =
                    who.answer({0, r.variants.at(m).values[3], r.variants.at(m).standard}, 1, 1, true)
                        .response.number -
                    20.0;
            sum += settled[0] + settled[1];
            product += settled[0] * settled[1];
            square += settled[0] * settled[0] + settled[1] * settled[1];
        }
        CHECK(std::abs(sum / (2.0 * people)) < 0.4);
        CHECK(std::sqrt(square / (2.0 * people)) == doctest::Approx(4.0).epsilon(0.05));
        // The standard error of r is 1 / sqrt(n) at most: 0.026.
        CHECK(std::abs(2.0 * product / square - correlation) < 0.08);
    }
}

TEST_CASE("impossible simulations are refused")
{
    const auto refusal = [](const char* text) { return caught_message([&] { parse_simulation(text); }); };
    has(refusal("sigma=-1"), "sigma is \"-1\"");
    has(refusal("sigma=nan"), "sigma is \"nan\"");
    has(refusal("noise=1"), "the key \"noise\" is unknown");
    for (const char* seed : {"1e3", "1.0", "-1", "0.5", "9007199254740992"})
        has(refusal(("seed=" + std::string(seed)).c_str()),
            "\", not a whole number from 0 to 9007199254740991");
    has(refusal("seed=1,seed=2"), "occurs twice");
    has(refusal("seed=1,"), "\"\" has no =");
    CHECK(parse_simulation("sigma=2") == simulation{1, 2.0, 0.0});
    CHECK(to_text(parse_simulation("void=0.1,sigma=0.5,seed=9")) == "seed=9,sigma=0.5,void=0.1");
    for (const char* text : {"seed=1,sigma=1,pse=60,64,jnd=8,pse_sd=4,jnd_sd=2,correlation=0.5,method_sd=0.5",
                             "seed=1,sigma=1,dprime=2,exponent=0.5,0.7,dprime_sd=1,exponent_sd=0.1"})
        CHECK(to_text(parse_simulation(text)) == text);
    has(refusal("pse_sd=-1"), "pse_sd is \"-1\"");
}

struct power_rig {
    explicit power_rig(const std::string& second, const std::string& runs)
        : d(read_definition("[experiment]\nname = \"p\"\n"
                            "[[motion]]\nname = \"right\"\npath = \"M0 20H40\"\nduration = 0.7\n"
                            "[[motion]]\nname = \"down\"\npath = \"M20 0V40\"\nduration = 0.7\n"
                            "[[method]]\nname = \"a\"\nalgorithm = \"tactile-brush\"\n"
                            "[[method]]\nname = \"b\"\nalgorithm = \"" +
                                second + "\"\n" + runs,
                            "p.toml", {})),
          stimuli(d, felt_array(), {})
    {
    }

    std::vector<run_power> tell(const power_request& r) const
    {
        return simulate_power(d, stimuli, r, [] { return true; }).value();
    }

    experiment_definition d;
    stimulus_set stimuli;
};

constexpr const char* choose = "[[run]]\nname = \"pick\"\ntask = \"choose\"\nattribute = \"similarity\"\n"
                               "trials = 12\n";
constexpr const char* rate = "[[run]]\nname = \"mark\"\ntask = \"rate\"\nattribute = \"uniformity\"\n"
                             "trials = 12\n";

// A better method after the second, for power_rig.
constexpr const char* third = "park2016\"\n[[method]]\nname = \"c\"\nalgorithm = \"continuous\"\n"
                              "phantom = \"gaussian";

TEST_CASE("choices among three methods have the worths that their costs imply")
{
    const power_rig r(third, choose);
    const simulation s{.seed = 2, .sigma = 1.0};
    const boost::math::normal noise(0.0, std::sqrt(2.0) * s.sigma);
    dataset all;
    all.experiment = r.d.outline;
    std::vector<std::vector<double>> expected(3, std::vector<double>(3, 0.0));
    for (unsigned i = 1; i <= 40; ++i) {
        all.participants.push_back(fmt::format("{:02}", i));
        const simulated_observer who(s, r.d, r.d.runs[0], r.stimuli, all.participants.back());
        run_data data;
        for (const planned_trial& t : make_run(r.d, 0, all.participants.back(), 7).trials) {
            const auto place = static_cast<unsigned>(data.trials.size() + 1);
            const auto cost = [&](std::size_t method) {
                return *r.stimuli.at(t.motion, method).felt.rms_error_mm;
            };
            const double p = boost::math::cdf(noise, std::log(cost(*t.method_2) / cost(t.method_1)));
            expected[t.method_1][*t.method_2] += p;
            expected[*t.method_2][t.method_1] += 1.0 - p;
            data.trials.push_back(
                {.place = place,
                 .motion = t.motion,
                 .method_1 = t.method_1,
                 .method_2 = *t.method_2,
                 .response = static_cast<unsigned>(who.answer(t, place, 1, false).response.number)});
        }
        all.data.push_back({data});
    }
    const run_analysis found = analyse(all).runs[0];
    const std::vector<worth> truth = fit_bradley_terry(expected);
    const std::vector<worth> worths = list_values<worth_list>(found.results)[0]->worths;
    REQUIRE(worths.size() == 3);
    for (const std::size_t m : {1U, 2U}) {
        CHECK(*truth[m].log_worth > *truth[m - 1].log_worth + 0.5);
        CHECK(*worths[m].log_worth > *worths[m - 1].log_worth);
        CHECK(std::abs(*worths[m].log_worth - *truth[m].log_worth) < 4.0 * *worths[m].se);
    }
    const power_at at = r.tell({s, {6}, 40})[0].tests[0].at[0];
    CHECK(at.for_last == at.significant);
    CHECK(at.significant > 32);
}

TEST_CASE("where both methods are equal, one study in twenty is significant")
{
    const power_rig r("tactile-brush", std::string(choose) + rate);
    const std::vector<run_power> powers = r.tell({{.seed = 1, .sigma = 1.0}, {8}, 3000});
    REQUIRE(powers.size() == 2);
    for (const run_power& p : powers) {
        CHECK(p.tests[0].at[0].significant > 90); // counts are coarse, and so is their t: not 0.05 exactly
        CHECK(p.tests[0].at[0].significant < 210);
        CHECK(static_cast<double>(p.tests[0].at[0].for_last) ==
              doctest::Approx(static_cast<double>(p.tests[0].at[0].significant) / 2.0).epsilon(0.25));
    }
}

TEST_CASE("less noise and more people find more")
{
    const power_rig r("park2016", rate);
    const auto power = [&](double sigma, std::size_t n) {
        return r.tell({{.seed = 5, .sigma = sigma}, {n}, 300})[0].tests[0].at[0].significant;
    };
    CHECK(power(8.0, 6) < power(4.0, 6));
    CHECK(power(8.0, 6) < power(8.0, 24));
}

TEST_CASE("smaller studies are the first people of larger ones, in any given order")
{
    const power_rig r("park2016", std::string(choose) + rate);
    const simulation s{.seed = 3, .sigma = 4.0, .voids = 0.2};
    const auto both = r.tell({s, {9, 4}, 50});
    const auto less = r.tell({s, {4}, 50});
    for (std::size_t run = 0; run < 2; ++run) {
        CHECK(both[run].tests[0].at[1].participants == 4);
        CHECK(both[run].tests[0].at[1].significant == less[run].tests[0].at[0].significant);
        CHECK(both[run].tests[0].at[1].for_last == less[run].tests[0].at[0].for_last);
    }
}

TEST_CASE("without noise nobody differs, so nothing is tested")
{
    const power_rig r("park2016", choose);
    const power_at at = r.tell({{.sigma = 0.0}, {5}, 20})[0].tests[0].at[0];
    CHECK(at.untested == 20);
    CHECK(at.significant == 0);
}

TEST_CASE("ratings of one method have nothing to compare, identifications chance")
{
    const power_rig r("park2016", std::string(rate) + "methods = [\"b\"]\n[[run]]\nname = \"what\"\n"
                                                      "task = \"identify\"\ntrials = 8\n");
    const auto powers = r.tell({{.sigma = 30.0}, {6}, 20});
    CHECK(powers[0].tests.empty());
    REQUIRE(powers[1].tests[0].at.size() == 1);
    CHECK(powers[1].tests[0].at[0].significant > 0);
}

constexpr const char* measured =
    "[[run]]\nname = \"even\"\ntask = \"constant\"\nquestion = \"?\"\nvary = \"speed_mm_s\"\n"
    "standard = 60\nvalues = [20, 40, 50, 60, 70, 80, 100]\ntrials = 112\n"
    "motions = [\"right\"]\n";

// The test of a figure of the only run.
const tested_power& find_test(const std::vector<run_power>& powers, std::string_view figure)
{
    const auto& all = powers.at(0).tests;
    return *std::ranges::find(all, figure, &tested_power::figure);
}

TEST_CASE("a difference between methods is found by the test of its own figure")
{
    const power_rig r("park2016", measured);
    simulation s{.seed = 3, .pse = {60.0}, .jnd = {6.0, 18.0}};
    const auto wider = r.tell({s, {8}, 30});
    REQUIRE(wider[0].tests.size() == 3); // the PSE against 60, and both figures by method
    CHECK(find_test(wider, "jnd").at[0].significant >= 27);
    CHECK(find_test(wider, "jnd").at[0].for_last == find_test(wider, "jnd").at[0].significant);
    CHECK(find_test(wider, "pse").at[0].significant <= 6);
    s = {.seed = 3, .pse = {66.0, 54.0}, .jnd = {10.0}};
    const auto moved = r.tell({s, {8}, 30});
    CHECK(find_test(moved, "pse").at[0].significant == 30);
    CHECK(find_test(moved, "pse").at[0].for_last == 0);
    CHECK(find_test(moved, "jnd").at[0].significant <= 6);
    CHECK(moved[0].tests[0].at[0].significant <= 6); // their mean is the standard
}

TEST_CASE("each method of a list has its own d' and exponent")
{
    const power_rig r("park2016",
                      "[[run]]\nname = \"there\"\ntask = \"detect\"\ncatch = 0.5\ntrials = 10000\n"
                      "[[run]]\nname = \"size\"\ntask = \"estimate\"\nquestion = \"?\"\ntrials = 48\n"
                      "vary = \"speed_mm_s\"\nvalues = [30, 60]\nstandard = 30\n");
    const simulation s{.sigma = 0.0, .dprime = {1.0, 3.0}, .exponent = {0.4, 1.2}};
    const simulated_observer detector(s, r.d, r.d.runs[0], r.stimuli, "01");
    std::map<std::string, std::pair<double, double>> counts; // of yes and of all, by method or silence
    unsigned place = 0;
    for (const planned_trial& t : make_run(r.d, 0, "01", 7).trials) {
        const method_definition& m = r.d.methods[t.method_1];
        auto& [yes, all] = counts[m.silent ? "none" : m.name];
        yes += detector.answer(t, ++place, 1, false).response.number == 1 ? 1 : 0;
        ++all;
    }
    const auto z = [&counts](const char* name) {
        return boost::math::quantile(boost::math::normal(), counts.at(name).first / counts.at(name).second);
    };
    CHECK(z("a") - z("none") == doctest::Approx(1.0).epsilon(0.1));
    CHECK(z("b") - z("none") == doctest::Approx(3.0).epsilon(0.05));
    const simulated_observer estimator(s, r.d, r.d.runs[1], r.stimuli, "01");
    std::set<double> numbers; // of the second value, twice the standard: 100 times 2 to the exponent
    place = 0;
    for (const planned_trial& t : make_run(r.d, 1, "01", 7).trials)
        if (find_value(r.d, t) == 60.0)
            numbers.insert(estimator.answer(t, ++place, 1, false).response.number);
    CHECK(numbers == std::set{132.0, 230.0});
}

TEST_CASE("people who differ need larger studies, but do not make differences that are not there")
{
    const power_rig r("park2016", measured);
    const auto pse = [&r](double off, double sd) {
        const auto all = r.tell({{.seed = 9, .pse = {60.0 + off}, .jnd = {8.0}, .pse_sd = sd}, {8}, 200});
        return all[0].tests[0].at[0].significant;
    };
    CHECK(pse(4.0, 0.0) > 180);
    // t with 7 degrees of freedom and a noncentrality of 4 / sqrt((64 + error) / 8), some 1.3: a power of
    // 0.2.
    CHECK(pse(4.0, 8.0) > 20);
    CHECK(pse(4.0, 8.0) < 70);
    CHECK(pse(0.0, 8.0) < 20); // 10 expected, sd 3.1
    const auto all = r.tell({{.seed = 4, .jnd = {8.0}, .pse_sd = 6.0, .jnd_sd = 4.0}, {8}, 300});
    for (const std::string_view figure : {"pse", "jnd"}) {
        CHECK(find_test(all, figure).at[0].significant > 3);
        CHECK(find_test(all, figure).at[0].significant < 30); // 15 expected, sd 3.8
    }
}

TEST_CASE("participants have the spread that was asked for, the same in each run and session")
{
    const power_rig r("park2016", std::string(choose) + measured);
    const run_definition& run = r.d.runs[1];
    // A person without a JND to speak of answers by the PSE alone: the share of answers above it is measured.
    std::vector<double> shares;
    const auto share = [&](const std::string& code, unsigned session) {
        experiment_definition held = r.d;
        held.session = session;
        const simulated_observer who({.pse = {60.0}, .jnd = {1e-6}, .pse_sd = 20.0}, held, run, r.stimuli,
                                     code);
        unsigned more = 0;
        const auto trials = make_run(r.d, 1, code, 7).trials;
        for (unsigned i = 0; i < trials.size(); ++i) {
            const bool standard_first = r.d.methods[trials[i].method_1].name == "standard";
            more += (who.answer(trials[i], i + 1, 1, false).response.number == 2) == standard_first ? 1 : 0;
        }
        return static_cast<double>(more) / static_cast<double>(trials.size());
    };
    unsigned low = 0;
    for (int i = 0; i < 400; ++i) {
        shares.push_back(share(fmt::format("{}", i), 1));
        low += shares.back() > 4.5 / 7.0 ? 1 : 0;
    }
    CHECK(share("3", 2) == shares[3]);
    // Five values and more lie above a PSE below 50: 31 % of a normal distribution about 60 with an sd of 20.
    CHECK(low > 0.31 * 400 - 28);
    CHECK(low < 0.31 * 400 + 28);
}

TEST_CASE("the computation asks before each study whether to go on, and gives nothing when stopped")
{
    const power_rig r("park2016", choose);
    int asked = 0;
    const auto powers = simulate_power(r.d, r.stimuli, {{}, {3}, 100}, [&] { return ++asked < 4; });
    CHECK_FALSE(powers.has_value());
    CHECK(asked == 4);
}

} // namespace
} // namespace tactor::study::test_simulated
