// SPDX-License-Identifier: MIT
// Tests the statistics of the tasks that measure with the answers of observers that are no model of src: a
// cumulative normal by std::erfc, lapses to either key, and faults that no fit knows of. Prints what each
// fault does to each figure, as tactor-analyze(1) has them; with more studies, for minutes:
//   TACTOR_SOAK=whole nice build-tests/tests/study/test-study -sf="*observers*"
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "rounds.hpp"
#include "study/results/measures.hpp"
#include "study/statistics/psychometric_fit.hpp"
#include "study/statistics/signal_detection.hpp"
#include "study/statistics/tests.hpp"
#include "study/tasks/adaptive.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study::test_observers {
namespace {

// Checks a figure of simulated studies. An eighth of the studies, in the slow lanes, would prove
// nothing: there they only run.
#define CHECK_FIGURE(...)                                                                                    \
    do {                                                                                                     \
        if (!test::shortened())                                                                              \
            CHECK(__VA_ARGS__);                                                                              \
    } while (false)

double phi(double z)
{
    return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

// Faults of somebody who answers by two keys, in standard deviations of what they feel.
struct faults {
    std::string_view name = "none";
    double lapse = 0.0;  ///< share of trials in which either key is pressed
    double bias = 0.0;   ///< towards the second key
    double drift = 0.0;  ///< of what is felt, from the first trial to the last
    double serial = 0.0; ///< towards the key that was pressed last
};
// The suite has the first two.
constexpr faults all_faults[] = {
    {},
    {.name = "lapses of 4 %", .lapse = 0.04},
    {.name = "bias of half a deviation", .bias = 0.5},
    {.name = "drift of one deviation", .drift = 1.0},
    {.name = "pull of the last answer", .serial = 0.3},
};

std::span<const faults> faults_to_try()
{
    return std::span(all_faults).first(test::whole() ? std::size(all_faults) : 2);
}

class second_observer {
public:
    second_observer(const faults& f, std::uint64_t seed) : f_(f), engine_(seed) {}

    double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

    double normal()
    {
        return std::sqrt(-2.0 * std::log(1.0 - unit())) * std::cos(2.0 * std::numbers::pi * unit());
    }

    // Returns true for the second key. `felt` speaks for it, and drifts in the direction `way`. `part`: place
    // of the trial in the session, 0 to 1.
    bool presses_second(double felt, double part, double way = 1.0)
    {
        const double drifted = f_.drift * (part - 0.5) * way;
        bool second = unit() < phi(felt + drifted + f_.bias + f_.serial * last_);
        if (f_.lapse > 0.0 && unit() < f_.lapse)
            second = unit() < 0.5;
        last_ = second ? 1.0 : -1.0;
        return second;
    }

    // Returns the place, from 0, of the stimulus that differs. Of the three felt, the two that are closest
    // together are taken for alike. `bias` and `serial` add to the last one and to the one named last.
    std::size_t finds_odd(double dprime, std::size_t odd, double part)
    {
        std::array<double, 3> x{normal(), normal(), normal()};
        x[odd] += dprime;
        x[2] += f_.bias + f_.drift * (part - 0.5);
        x[named_] += f_.serial;
        const auto between = [&x](std::size_t i, std::size_t k) { return std::abs(x[i] - x[k]); };
        const std::array apart{between(1, 2), between(0, 2), between(0, 1)};
        named_ = static_cast<std::size_t>(std::ranges::min_element(apart) - apart.begin());
        if (f_.lapse > 0.0 && unit() < f_.lapse)
            named_ = static_cast<std::size_t>(3.0 * unit());
        return named_;
    }

    // Returns true if the comparison of a pair is chosen.
    bool chooses_comparison(double x_in_deviations, bool standard_first, double part)
    {
        const double way = standard_first ? 1.0 : -1.0;
        return presses_second(way * x_in_deviations, part, way) == standard_first;
    }

    // Returns true for "different".
    bool tells_different(double dprime, double criterion, double part)
    {
        const double felt = std::abs(dprime + normal() - normal()) - criterion;
        bool different = felt + f_.drift * (part - 0.5) + f_.bias + f_.serial * last_ > 0.0;
        if (f_.lapse > 0.0 && unit() < f_.lapse)
            different = unit() < 0.5;
        last_ = different ? 1.0 : -1.0;
        return different;
    }

private:
    faults f_;
    std::mt19937_64 engine_;
    std::size_t named_ = 0;
    double last_ = 0.0;
};

constexpr double jnd = 2.0;
constexpr double deviation = jnd / 0.6744897501960817;
constexpr double pse = 30.0;

// Figures of simulated studies whose participants all have this pse and jnd.
struct outcome {
    int studies = 0;
    int false_alarms = 0; ///< t tests of the pse with p < 0.05
    int people = 0;
    int jnds = 0;
    double pse_sum = 0.0; ///< less the truth
    double pse_squares = 0.0;
    double jnd_sum = 0.0;
    int intervals = 0;
    int hold_pse = 0;
    int hold_jnd = 0;

    void add(const fitted_function& m)
    {
        ++people;
        if (m.pse) {
            pse_sum += *m.pse - pse;
            pse_squares += (*m.pse - pse) * (*m.pse - pse);
        }
        if (m.jnd) {
            ++jnds;
            jnd_sum += *m.jnd;
        }
        if (m.bootstrap.threshold && m.jnd_ci) {
            const auto holds = [](const interval& i, double v) { return i.first <= v && v <= i.second; };
            ++intervals;
            hold_pse += holds(*m.bootstrap.threshold, pse) ? 1 : 0;
            hold_jnd += holds(*m.jnd_ci, jnd) ? 1 : 0;
        }
    }
    void test(const std::vector<double>& pses)
    {
        ++studies;
        const t_test t = test_mean_quickly(pses, pse);
        false_alarms += t.p && *t.p < 0.05 ? 1 : 0;
    }
    // In jnds.
    double bias() const { return pse_sum / people / jnd; }
    double bias_se() const { return std::sqrt(pse_squares) / people / jnd; }
    double jnd_ratio() const { return jnd_sum / jnds / jnd; }
    double false_share() const { return static_cast<double>(false_alarms) / studies; }

    void print(std::string_view what) const
    {
        fmt::print(
            "{}: {:.1f} % of {} t tests of the pse are false; pse off by {:+.3f} jnd, jnd {:.2f} of the "
            "truth",
            what, 100.0 * false_share(), studies, bias(), jnd_ratio());
        if (intervals > 0)
            fmt::print("; of {} intervals {:.1f} % hold the pse, {:.1f} % the jnd", intervals,
                       100.0 * hold_pse / intervals, 100.0 * hold_jnd / intervals);
        fmt::print("\n");
    }
};

run_outline make_run(const task* task)
{
    return {.name = "run",
            .file_name = "run",
            .task = task,
            .motions = {"m"},
            .methods = {"a"},
            .vary = "length_mm",
            .standard = pse};
}

constexpr std::size_t per_value = 20;
const std::vector<double> about_the_pse{-6.0, -3.0, -1.0, 0.0, 1.0, 3.0, 6.0};

std::vector<trial> hold_constant(second_observer& who, const std::vector<double>& offsets)
{
    std::vector<trial> all;
    std::vector<bool> first;
    for (std::size_t i = 0; i < per_value; ++i)
        for (const double x : offsets) {
            all.push_back({.value = pse + x});
            first.push_back(i % 2 == 0);
        }
    std::vector<std::size_t> order(all.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = i;
    for (std::size_t i = order.size() - 1; i > 0; --i)
        std::swap(order[i], order[static_cast<std::size_t>(who.unit() * static_cast<double>(i + 1))]);
    for (std::size_t i = 0; i < order.size(); ++i) {
        trial& t = all[order[i]];
        t.positive = who.chooses_comparison((t.value - pse) / deviation, first[order[i]],
                                            static_cast<double>(i) / static_cast<double>(order.size() - 1));
        t.response = t.positive == first[order[i]] ? 2 : 1;
    }
    return all;
}

// The first participant of each study has a bootstrap, if `seed` is given.
outcome constant_studies(const faults& f, std::size_t people, int studies, const std::vector<double>& offsets,
                         bool bootstrap = false)
{
    outcome o;
    for (int study = 0; study < studies; ++study) {
        std::vector<double> pses;
        for (std::size_t i = 0; i < people; ++i) {
            second_observer who(f, static_cast<std::uint64_t>(study) * 1000 + i);
            const fitted_function m =
                fit_comparisons(hold_constant(who, offsets), sigmoid::normal,
                                bootstrap && i == 0 ? std::to_string(study) : std::string());
            o.add(m);
            if (m.pse)
                pses.push_back(*m.pse);
        }
        o.test(pses);
    }
    return o;
}

// A run with values 1 apart, 13 on both sides of the pse.
run_outline make_adaptive(unsigned down, unsigned tracks)
{
    run_outline r = make_run(&find_task("adaptive"));
    for (int i = -13; i <= 13; ++i)
        r.values.push_back(pse + i);
    r.adaptive = {.steps = {4, 2, 1}, .lapses = {0.0, 0.02, 0.04}};
    for (unsigned i = 0; i < tracks; ++i)
        r.adaptive.tracks.push_back({down, down > 1 && i % 2 == 1, i % 2 == 0 ? r.values.size() - 1 : 0});
    for (int i = 0; i < 5; ++i)
        r.adaptive.slopes.push_back(0.65 * std::pow(20.0, i / 4.0)); // a fortieth to a half of the range
    return r;
}

outcome adaptive_studies(const faults& f, const run_outline& r, std::size_t people, int studies,
                         bool bootstrap = false)
{
    constexpr std::size_t trials = 60;
    outcome o;
    for (int study = 0; study < studies; ++study) {
        std::vector<double> pses;
        for (std::size_t i = 0; i < people; ++i) {
            second_observer who(f, static_cast<std::uint64_t>(study) * 1000 + i);
            adaptive_tracks tracks(r);
            std::vector<trial> all;
            for (std::size_t k = 0; k < trials; ++k) {
                const auto track = static_cast<unsigned>(k % r.adaptive.tracks.size() + 1);
                const double x = r.values[tracks.next(track)];
                const bool more =
                    who.chooses_comparison((x - pse) / deviation, who.unit() < 0.5,
                                           static_cast<double>(k) / static_cast<double>(trials - 1));
                tracks.answer(track, more);
                all.push_back({.value = x, .positive = more});
            }
            const fitted_function m = fit_comparisons(
                all, sigmoid::normal, bootstrap && i == 0 ? std::to_string(study) : std::string());
            o.add(m);
            if (m.pse)
                pses.push_back(*m.pse);
        }
        o.test(pses);
    }
    return o;
}

TEST_CASE("the t test of the pse is false in one study of twenty, with lapses and without")
{
    for (const std::size_t people : {12U, 24U})
        for (const double lapse : {0.0, 0.08}) {
            const outcome o =
                constant_studies({.lapse = lapse}, people, test::rounds(40, 1000), about_the_pse);
            o.print(fmt::format("constant, {} observers, lapses of {} %", people, 100.0 * lapse));
            CHECK_FIGURE(std::abs(o.bias()) < 3.5 * o.bias_se());
            CHECK_FIGURE(o.false_share() < (test::whole() ? 0.07 : 0.15));
            if (test::whole())
                CHECK_FIGURE(o.false_share() > 0.03);
        }
}

TEST_CASE("faults that the fit does not know of: constant stimuli, observers of a second kind")
{
    for (const faults& f : faults_to_try()) {
        const outcome o = constant_studies(f, 12, test::rounds(40, 500), about_the_pse);
        o.print(fmt::format("constant, 12 people, {}", f.name));
        CHECK_FIGURE(std::abs(o.bias()) < 4.0 * o.bias_se());
        CHECK_FIGURE(o.jnd_ratio() > 0.85);
        CHECK_FIGURE(o.jnd_ratio() < 1.10);
        const outcome one = constant_studies(f, 1, test::rounds(4, 150), about_the_pse, true);
        one.print(fmt::format("constant, intervals, {}", f.name));
        CHECK_FIGURE(one.hold_pse >= one.intervals * 9 / 10 - 1);
    }
}

TEST_CASE("values that lie on one side of the pse: observers without faults")
{
    const outcome o = constant_studies({}, 24, test::rounds(20, 1000), {-3.0, -1.0, 0.0, 1.0, 3.0, 6.0, 9.0});
    o.print("constant, 24 people, values from -3 to 9");
    CHECK_FIGURE(std::abs(o.bias()) < 0.05);
}

TEST_CASE("staircases that are mirrored leave the pse where it is: observers of a second kind")
{
    for (const unsigned down : {1U, 2U, 3U})
        for (const faults& f : faults_to_try()) {
            const run_outline r = make_adaptive(down, 2);
            const outcome o = adaptive_studies(f, r, 12, test::rounds(20, 400));
            o.print(fmt::format("1up{}down, 12 people, {}", down, f.name));
            if (f.drift == 0.0) { // a staircase asks at other times than values in random order do
                CHECK_FIGURE(std::abs(o.bias()) < 4.0 * o.bias_se());
                CHECK_FIGURE(o.false_share() < (test::whole() ? 0.08 : 0.26));
            }
            CHECK_FIGURE(o.jnd_ratio() > 0.7);
            CHECK_FIGURE(o.jnd_ratio() < 1.1);
            if (test::whole() && &f == all_faults)
                adaptive_studies(f, r, 1, 150, true)
                    .print(fmt::format("1up{}down, intervals, {}", down, f.name));
        }
}

TEST_CASE("QUEST+ leaves the pse where it is: observers of a second kind")
{
    const run_outline r = make_adaptive(0, 2);
    for (const faults& f : faults_to_try()) {
        if (!test::whole() && f.lapse > 0.0)
            continue;
        const outcome o = adaptive_studies(f, r, 12, test::rounds(2, 200));
        o.print(fmt::format("QUEST+, 12 people, {}", f.name));
        if (f.drift == 0.0)
            CHECK_FIGURE(std::abs(o.bias()) < 4.0 * o.bias_se());
        CHECK_FIGURE(o.jnd_ratio() > 0.75);
        if (test::whole() && &f == all_faults)
            adaptive_studies(f, r, 1, 150, true).print(fmt::format("QUEST+, intervals, {}", f.name));
    }
}

// Returns a participant's trials of detect, half of them without a stimulus, or of same-different. With
// values: of detect, whose stimuli are felt more the greater they are.
std::vector<trial> hold_signals(second_observer& who, const task* task, double dprime, bool by_value,
                                double catches)
{
    constexpr std::size_t trials = 120;
    std::vector<trial> all;
    for (std::size_t k = 0; k < trials; ++k) {
        const double part = static_cast<double>(k) / (trials - 1);
        trial t{.signal = who.unit() >= catches};
        t.value = by_value ? about_the_pse[static_cast<std::size_t>(who.unit() * 7.0)] : 0.0;
        if (task == &find_task("same-different"))
            t.positive = who.tells_different(t.signal ? dprime : 0.0, 1.4, part);
        else
            t.positive = who.presses_second(
                by_value ? (t.signal ? t.value / deviation : -9.0) : (t.signal ? 0.5 : -0.5) * dprime, part);
        all.push_back(t);
    }
    return all;
}

// Answers a trial of two intervals. The observer never guesses: it feels noise in both, and d' grows with the
// square of the amplitude. At 0 dB it is right in 75 % of the trials. `part`: as in presses_second().
trial hold_intervals(second_observer& who, double db, double part)
{
    constexpr double at_75_percent = 0.6744897501960817;
    const double felt = at_75_percent * std::pow(10.0, db / 10.0); // d' over the root of 2
    const bool second = who.unit() < 0.5;
    const bool pressed_second = who.presses_second(second ? felt : -felt, part, 0.0);
    return {.response = pressed_second ? 2U : 1U, .value = db, .positive = pressed_second == second};
}

// Returns a participant's trials at seven levels.
std::vector<trial> hold_intervals(second_observer& who)
{
    constexpr std::size_t trials = 140;
    std::vector<trial> all;
    for (std::size_t k = 0; k < trials; ++k)
        all.push_back(hold_intervals(who, std::array{-9.0, -6.0, -3.0, 0.0, 3.0, 6.0, 9.0}[k % 7],
                                     static_cast<double>(k) / (trials - 1)));
    return all;
}

// Runs a track of an adaptive run of two intervals; returns the estimated threshold, dB.
std::optional<double> track_intervals(second_observer& who, unsigned down)
{
    constexpr int trials = 80;
    run_outline r = make_adaptive(down, 1);
    r.adaptive.two_sided = false;
    for (double& v : r.values)
        v -= pse; // dB about the level of 75 %
    adaptive_tracks tracks(r);
    std::vector<trial> all;
    for (int k = 0; k < trials; ++k) {
        all.push_back(hold_intervals(who, r.values[tracks.next(1)], static_cast<double>(k) / (trials - 1)));
        tracks.answer(1, all.back().positive);
    }
    const auto fit = fit_answers(all, {.kind = sigmoid::normal, .guess = 0.5}, "").fit;
    return fit ? std::optional(fit->parameters.threshold) : std::nullopt;
}

TEST_CASE("the time-order error is the bias to an interval: observers of a second kind")
{
    const run_outline constant = make_run(&find_task("constant"));
    const run_outline intervals = make_run(&find_task("interval"));
    const int people = test::rounds(60, 1000);
    for (const double bias : {0.0, 0.5, -0.3}) {
        // Right answers at each level to a stimulus that is second, minus those to one that is first.
        double right = 0.0;
        for (const double db : {-9.0, -6.0, -3.0, 0.0, 3.0, 6.0, 9.0}) {
            const double felt = 0.6744897501960817 * std::pow(10.0, db / 10.0);
            right += 100.0 * (phi(felt + bias) - phi(felt - bias)) / 7.0;
        }
        std::vector<double> pses;
        std::vector<double> rights;
        for (int i = 0; i < people; ++i) {
            second_observer who({.bias = bias}, static_cast<std::uint64_t>(i));
            const auto compare = [](const run_outline& r, const std::vector<trial>& trials) {
                return *compare_intervals(*r.task->plan_intervals(r, sigmoid::normal), trials).front().value;
            };
            pses.push_back(compare(constant, hold_constant(who, about_the_pse)));
            rights.push_back(compare(intervals, hold_intervals(who)));
        }
        // The pse of each order moves by the bias.
        for (const auto& [name, found, truth] :
             {std::tuple("pse", &pses, 2.0 * bias * deviation), {"right", &rights, right}}) {
            const t_test t = test_mean_quickly(*found, truth);
            fmt::print("time-order error of {}: {:.2f} (se {:.2f}) with a bias of {}, true {:.2f}\n", name,
                       *t.mean, *t.se, bias, truth);
            CHECK_FIGURE(std::abs(*t.t) < 4.0);
        }
    }
}

TEST_CASE("adaptive tracks of two intervals find the level of 75 %: observers of a second kind")
{
    for (const unsigned down : {0U, 2U, 3U})
        for (const faults& f : faults_to_try()) {
            const int people = test::rounds(down == 0 ? 12 : 100, 1000);
            double sum = 0.0;
            int found = 0;
            for (int i = 0; i < people; ++i) {
                second_observer who(f, static_cast<std::uint64_t>(i));
                if (const auto threshold = track_intervals(who, down)) {
                    sum += *threshold;
                    ++found;
                }
            }
            fmt::print("interval, {}: threshold {:+.2f} dB of {} in {} with {}\n",
                       down == 0 ? std::string("QUEST+") : fmt::format("1up{}down", down), sum / found, found,
                       people, f.name);
            CHECK_FIGURE(found >= people * 9 / 10);
            if (f.lapse == 0.0 && f.bias == 0.0 && f.drift == 0.0 && f.serial == 0.0)
                CHECK_FIGURE(std::abs(sum / found) < 1.0);
        }
}

TEST_CASE("faults and d', thresholds, exponents and choices: observers of a second kind")
{
    const int people = test::rounds(120, 2000);
    for (const faults& f : faults_to_try()) {
        std::map<std::string_view, double> sums;
        double chosen = 0.0;
        for (int i = 0; i < people; ++i) {
            second_observer who(f, static_cast<std::uint64_t>(i));
            const auto felt_or_not = *measure_detection(
                hold_signals(who, &find_task("detect"), 1.5, false, 0.5), yes_no_sensitivity);
            sums["detect, d' of 1.5"] += felt_or_not.found.dprime / people;
            sums["detect, c of 0"] += felt_or_not.found.c / people;
            const auto fit =
                fit_answers(hold_signals(who, &find_task("detect"), 0.0, true, 0.5), {sigmoid::normal}, "")
                    .fit;
            sums["detect, threshold of 0, in jnds"] += fit ? fit->parameters.threshold / jnd / people : 0.0;
            const auto right =
                fit_answers(hold_intervals(who), {.kind = sigmoid::normal, .guess = 0.5}, "").fit;
            sums["interval, threshold of 0 dB"] += right ? right->parameters.threshold / people : 0.0;
            sums["same-different, d' of 2"] +=
                measure_detection(hold_signals(who, &find_task("same-different"), 2.0, false, 0.5),
                                  same_different_sensitivity)
                    ->found.dprime /
                people;
            std::vector<double> values;
            std::vector<double> numbers;
            double last = 0.0;
            for (int k = 0; k < 40; ++k) {
                values.push_back(
                    std::array{5.0, 10.0, 20.0, 40.0}[static_cast<std::size_t>(who.unit() * 4.0)]);
                const double felt = 0.6 * std::log(values.back() / 14.1);
                // In deviations of the noise of 0.2; who lapses names any number.
                const double off = 0.2 * (f.bias + f.drift * (k / 39.0 - 0.5)) + f.serial * (last - felt);
                last = who.unit() < f.lapse ? 2.0 * who.unit() - 1.0 : felt + off + 0.2 * who.normal();
                numbers.push_back(std::exp(last));
            }
            sums["exponent of 0.6"] += *stevens_exponent(values, numbers) / people;
            for (int k = 0; k < 40; ++k) { // the better method is felt half a deviation better
                const double way = who.unit() < 0.5 ? 1.0 : -1.0;
                chosen += who.presses_second(0.5 * way, k / 39.0, 0.0) == (way > 0.0) ? 2.5 / people : 0.0;
            }
        }
        for (const auto& [figure, sum] : sums)
            fmt::print("{}: {:.3f} with {}\n", figure, sum, f.name);
        fmt::print("choose, 69.1 %: {:.1f} % with {}\n", chosen, f.name);
        if (f.lapse == 0.0 && f.bias == 0.0 && f.drift == 0.0 && f.serial == 0.0) {
            CHECK(sums["detect, d' of 1.5"] == doctest::Approx(1.5).epsilon(0.06));
            CHECK(std::abs(sums["detect, threshold of 0, in jnds"]) < 0.15);
            CHECK_FIGURE(std::abs(sums["interval, threshold of 0 dB"]) < 0.8);
            CHECK(sums["same-different, d' of 2"] == doctest::Approx(2.0).epsilon(0.06));
            CHECK(sums["exponent of 0.6"] == doctest::Approx(0.6).epsilon(0.02));
        }
    }
}

TEST_CASE("d' of detect leans below 0 where few trials have no stimulus: observers who feel nothing")
{
    for (const double catches : {0.5, 0.2})
        for (const double yes : {0.02, 0.1, 0.3}) {
            const int studies = test::rounds(40, 1000);
            int found = 0;
            double sum = 0.0;
            for (int study = 0; study < studies; ++study) {
                std::vector<double> all;
                for (std::size_t i = 0; i < 12; ++i) {
                    second_observer who({}, static_cast<std::uint64_t>(study) * 1000 + i);
                    std::vector<trial> own(40);
                    for (std::size_t k = 0; k < own.size(); ++k) {
                        own[k].signal = static_cast<double>(k) >= catches * 40.0;
                        own[k].positive = who.unit() < yes;
                    }
                    all.push_back(measure_detection(own, yes_no_sensitivity)->found.dprime);
                    sum += all.back();
                }
                const t_test t = test_mean_quickly(all, 0.0);
                found += t.p && *t.p < 0.05 ? 1 : 0;
            }
            fmt::print("detect, 12 people, 40 trials, catch {}, yes in {} %: {:.1f} % of t tests are false, "
                       "d' {:+.2f}\n",
                       catches, 100.0 * yes, 100.0 * found / studies, sum / studies / 12.0);
            if (catches == 0.5)
                CHECK(found <= studies * 14 / 100);
        }
}

TEST_CASE("of studies without a difference 3 to 7 % find one, by observers of a second kind")
{
    constexpr std::size_t trials = 40;
    for (const faults& f : faults_to_try())
        for (const std::size_t people : {8U, 12U, 24U})
            for (const double criterion : {1.0, 2.5}) {
                const int studies = test::rounds(f.lapse > 0.0 ? 20 : 60, 1000);
                int found = 0;
                for (int study = 0; study < studies; ++study) {
                    std::vector<difference_counts> all(people);
                    for (std::size_t i = 0; i < people; ++i) {
                        second_observer who(f, static_cast<std::uint64_t>(study) * 1000 + i);
                        for (std::size_t k = 0; k < trials; ++k) {
                            const bool differ = who.unit() < 0.5;
                            const bool told =
                                who.tells_different(0.0, criterion, static_cast<double>(k) / (trials - 1));
                            (differ ? all[i].different : all[i].same) += 1;
                            (differ ? all[i].hits : all[i].false_alarms) += told ? 1 : 0;
                        }
                    }
                    found += test_difference(all, std::to_string(study))->p < 0.05 ? 1 : 0;
                }
                fmt::print("same-different, no difference, {} people, criterion {}, {}: {:.1f} % of {}\n",
                           people, criterion, f.name, 100.0 * found / studies, studies);
                CHECK_FIGURE(found <= (test::whole() ? studies * 7 / 100 : studies / 8 + 1));
                if (test::whole())
                    CHECK_FIGURE(found >= studies * 3 / 100);
            }
}

// Returns a participant's answers to three stimuli.
right_count find_odd_ones(second_observer& who, double dprime, std::size_t trials)
{
    right_count n{0, trials};
    for (std::size_t k = 0; k < trials; ++k) {
        const auto odd = static_cast<std::size_t>(3.0 * who.unit());
        n.right += who.finds_odd(dprime, odd, static_cast<double>(k) / (trials - 1)) == odd ? 1U : 0U;
    }
    return n;
}

TEST_CASE("d' of oddity is that of observers of a second kind, and without a difference few studies find one")
{
    for (const faults& f : faults_to_try()) {
        const int people = test::rounds(300, 4000);
        double sum = 0.0;
        for (int i = 0; i < people; ++i) {
            second_observer who(f, static_cast<std::uint64_t>(i));
            sum += triangle_dprime(corrected_right_share(find_odd_ones(who, 2.0, 120)));
        }
        fmt::print("oddity, d' of 2: {:.3f} with {}\n", sum / people, f.name);
        if (f.lapse == 0.0 && f.bias == 0.0 && f.drift == 0.0 && f.serial == 0.0)
            CHECK(sum / people == doctest::Approx(2.0).epsilon(0.05));
        for (const std::size_t n : {8U, 12U, 24U}) {
            const int studies = test::rounds(60, 1000);
            int found = 0;
            for (int study = 0; study < studies; ++study) {
                std::vector<right_count> all;
                for (std::size_t i = 0; i < n; ++i) {
                    second_observer who(f, static_cast<std::uint64_t>(study) * 1000 + i);
                    all.push_back(find_odd_ones(who, 0.0, 36));
                }
                found += test_oddity(all, std::to_string(study))->p < 0.05 ? 1 : 0;
            }
            fmt::print("oddity, no difference, {} people, {}: {:.1f} % of {}\n", n, f.name,
                       100.0 * found / studies, studies);
            CHECK_FIGURE(found <= (test::whole() ? studies * 7 / 100 : studies / 8 + 1));
            if (test::whole())
                CHECK_FIGURE(found >= studies * 3 / 100);
        }
    }
}

} // namespace
} // namespace tactor::study::test_observers
