// SPDX-License-Identifier: MIT
#include "study/experiment/simulated.hpp"

#include <cmath>
#include <string>

#include <boost/math/distributions/normal.hpp>
#include <doctest/doctest.h>

#include "caught.hpp"
#include "felt_array.hpp"
#include "has.hpp"

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
        chosen += o.answer({0, 0, 1}, i, 1, false).response == 2 ? 1 : 0;
    CHECK(chosen / static_cast<double>(n) == doctest::Approx(p).epsilon(0.03));
}

TEST_CASE("an observer judges what simulate_as says, and refuses an attribute that it does not know")
{
    rig r;
    r.d.runs[0].attribute = "pleasantness";
    r.d.runs[0].simulate_as = "uniformity";
    r.d.runs[0].outline.name = r.d.runs[1].outline.name; // a part of the seed
    const auto answer = [&](std::size_t run) {
        return r.observer(run, "sigma=0").answer({0, 0, 1}, 1, 1, false).response;
    };
    CHECK(answer(0) == answer(1));
    r.d.runs[0].simulate_as.clear();
    CHECK(has(caught_message([&] { answer(0); }), "how to judge \"pleasantness\" (simulate_as = "));
}

TEST_CASE("without noise the better one is chosen, in either place")
{
    const rig r;
    const simulated_observer o = r.observer(1, "sigma=0");
    const bool second = *r.stimuli.at(0, 1).felt.speed_cv < *r.stimuli.at(0, 0).felt.speed_cv;
    CHECK(o.answer({0, 0, 1}, 1, 1, false).response == (second ? 2 : 1));
    CHECK(o.answer({0, 1, 0}, 1, 1, false).response == (second ? 1 : 2));
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
            CHECK(o.answer({m, k}, 1, 1, false).response == static_cast<unsigned>(rating));
        }
}

TEST_CASE("ratings stay on the scale, and noise uses all of it")
{
    const rig r;
    const simulated_observer o = r.observer(3, "sigma=3");
    unsigned low = 9;
    unsigned high = 0;
    for (unsigned i = 1; i <= 500; ++i) {
        const unsigned a = o.answer({0, 0}, i, 1, false).response;
        low = std::min(low, a);
        high = std::max(high, a);
    }
    CHECK(low == 1);
    CHECK(high == 5);
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
            CHECK(sharp.answer({m, 0}, i, 1, false).response == m);
            right += dull.answer({m, 0}, i, 1, false).response == m ? 1 : 0;
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
    CHECK(a.response == b.response);
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

TEST_CASE("impossible simulations are refused")
{
    const auto refusal = [](const char* text) { return caught_message([&] { parse_simulation(text); }); };
    CHECK(has(refusal("sigma=-1"), "sigma is \"-1\""));
    CHECK(has(refusal("sigma=nan"), "sigma is \"nan\""));
    CHECK(has(refusal("noise=1"), "\"noise\" is not known"));
    CHECK(has(refusal("seed=1,seed=2"), "said twice"));
    CHECK(has(refusal("seed=1,"), "\"\" is not known"));
    CHECK(parse_simulation("sigma=2") == simulation{1, 2.0, 0.0});
    CHECK(to_text(parse_simulation("void=0.1,sigma=0.5,seed=9")) == "seed=9,sigma=0.5,void=0.1");
}

TEST_CASE("a stimulus that cannot be planned or played is refused with its motion and method")
{
    const auto refusal = [](const std::string& motion, const std::string& level) {
        const std::string text =
            "[experiment]\nname = \"x\"\nlevel = " + level + "\n[[motion]]\nname = \"m\"\n" + motion +
            "\n[[method]]\nname = \"brush\"\nalgorithm = \"tactile-brush\"\n"
            "[[run]]\nname = \"r\"\ntask = \"rate\"\nattribute = \"similarity\"\ntrials = 2\n";
        const experiment_definition d = read_definition(text, "x.toml", {});
        render_options o;
        o.level_dbfs = d.level_dbfs.value_or(-12.0);
        if (!d.level_dbfs)
            o.sl_db = d.sl_db;
        return caught_message([&] { stimulus_set(d, felt_array(), o); });
    };
    CHECK(refusal("path = \"M0 0H40\"", "{ dbfs = -12 }").empty());
    const std::string off = refusal("path = \"M0 0H90\"", "{ dbfs = -12 }");
    CHECK_MESSAGE(has(off, "x.toml:4:"), off);
    CHECK_MESSAGE(has(off, "motion \"m\" by method \"brush\" (line 7)"), off);
    CHECK(has(refusal("path = \"M0 0H40\"\nduration = 0.01", "{ dbfs = -12 }"), "method \"brush\""));
    const std::string loud = refusal("path = \"M0 0H40\"", "{ sl_db = 60 }");
    CHECK_MESSAGE(has(loud, "full scale"), loud);
}

} // namespace
} // namespace tactor::study::test_simulated
