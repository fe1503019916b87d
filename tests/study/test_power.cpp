// SPDX-License-Identifier: MIT
#include "study/experiment/simulated.hpp"

#include <string>

#include <doctest/doctest.h>

#include "felt_array.hpp"
#include "study/statistics/tests.hpp"

namespace tactor::study::test_power {
namespace {

struct rig {
    explicit rig(const std::string& second, const std::string& runs)
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

TEST_CASE("the interval of a share is that of Clopper and Pearson")
{
    CHECK(binomial_interval(0, 10).first == 0.0);
    CHECK(binomial_interval(0, 10).second == doctest::Approx(0.3084971).epsilon(1e-6));
    CHECK(binomial_interval(8, 10).first == doctest::Approx(0.4439045).epsilon(1e-6));
    CHECK(binomial_interval(8, 10).second == doctest::Approx(0.9747893).epsilon(1e-6));
    CHECK(binomial_interval(10, 10).first == doctest::Approx(0.6915029).epsilon(1e-6));
    CHECK(binomial_interval(10, 10).second == 1.0);
}

TEST_CASE("the quick test gives the t and p of the full one")
{
    const std::vector<double> v{62.5, 70.0, 41.0, 88.5, 50.0};
    const t_test quick = quick_test_mean(v, 50.0);
    const t_test whole = test_mean(v, 50.0);
    CHECK(quick.t == whole.t);
    CHECK(quick.p == whole.p);
    CHECK(quick.se == whole.se);
    CHECK(quick.df == whole.df);
    CHECK_FALSE(quick.d_ci.has_value());
}

TEST_CASE("where both methods are equal, one study in twenty is significant")
{
    const rig r("tactile-brush", std::string(choose) + rate);
    const std::vector<run_power> powers = r.tell({{.seed = 1, .sigma = 1.0}, {8}, 3000});
    REQUIRE(powers.size() == 2);
    for (const run_power& p : powers) {
        CHECK(p.at[0].power > 0.03); // counts are coarse, and so is their t: not 0.05 exactly
        CHECK(p.at[0].power < 0.07);
        CHECK(static_cast<double>(p.at[0].for_last) ==
              doctest::Approx(static_cast<double>(p.at[0].significant) / 2.0).epsilon(0.25));
        CHECK(p.at[0].ci == binomial_interval(p.at[0].significant, 3000));
    }
}

TEST_CASE("less noise and more people find more")
{
    const rig r("park2016", rate);
    const auto power = [&](double sigma, std::size_t n) {
        return r.tell({{.seed = 5, .sigma = sigma}, {n}, 300})[0].at[0].power;
    };
    CHECK(power(8.0, 6) < power(4.0, 6));
    CHECK(power(8.0, 6) < power(8.0, 24));
}

TEST_CASE("smaller studies are the first people of larger ones, in any given order")
{
    const rig r("park2016", std::string(choose) + rate);
    const simulation s{.seed = 3, .sigma = 4.0, .voids = 0.2};
    const auto both = r.tell({s, {9, 4}, 50});
    const auto less = r.tell({s, {4}, 50});
    for (std::size_t run = 0; run < 2; ++run) {
        CHECK(both[run].at[1].participants == 4);
        CHECK(both[run].at[1].significant == less[run].at[0].significant);
        CHECK(both[run].at[1].for_last == less[run].at[0].for_last);
    }
}

TEST_CASE("without noise nobody differs, so nothing is tested")
{
    const rig r("park2016", choose);
    const power_at at = r.tell({{.sigma = 0.0}, {5}, 20})[0].at[0];
    CHECK(at.untested == 20);
    CHECK(at.significant == 0);
    CHECK(at.ci.first == 0.0);
}

TEST_CASE("ratings of one method have nothing to compare, identifications chance")
{
    const rig r("park2016", std::string(rate) + "methods = [\"b\"]\n[[run]]\nname = \"what\"\n"
                                                "task = \"identify\"\ntrials = 8\n");
    const auto powers = r.tell({{.sigma = 30.0}, {6}, 20});
    CHECK(powers[0].at.empty());
    REQUIRE(powers[1].at.size() == 1);
    CHECK(powers[1].at[0].significant > 0);
}

TEST_CASE("the computation asks before each study whether to go on, and gives nothing when stopped")
{
    const rig r("park2016", choose);
    int asked = 0;
    const auto powers = simulate_power(r.d, r.stimuli, {{}, {3}, 100}, [&] { return ++asked < 4; });
    CHECK_FALSE(powers.has_value());
    CHECK(asked == 4);
}

} // namespace
} // namespace tactor::study::test_power
