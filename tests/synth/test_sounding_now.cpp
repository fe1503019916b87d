// SPDX-License-Identifier: MIT
#include "synth/score/sounding_now.hpp"

#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include "pieces.hpp"

namespace sounding_now_test {

using namespace tactor;
using namespace pieces;

TEST_CASE("a sounding stroke has its given strength at each frame, at any level, and none after its end")
{
    array a = row(3);
    a.tactors[1].gain_db = -6.0;
    a.tactors[2].polarity = -1;
    plan p;
    p.total_s = 0.3;
    for (const double onset_s : {0.0, 0.1, 0.2}) {
        burst b;
        b.onset_s = onset_s;
        b.duration_s = 0.1;
        b.drives = {{0, 0.25 + onset_s}, {1, 0.5}, {2, 1.0}};
        p.bursts.push_back(b);
    }
    render_options o;
    o.rate = 10000;
    synth::sounding_now now(score(a, {{p, 0.1}}, o));
    CHECK(now.at(999) == std::vector<double>{0.0, 0.0, 0.0});
    for (const std::uint64_t frame : {1000U, 1999U, 2000U, 3500U, 3999U}) {
        CAPTURE(frame);
        const auto& levels = now.at(frame);
        REQUIRE(levels.size() == 3);
        const double onset_s = 0.1 * std::floor(static_cast<double>(frame - 1000) / 1000.0);
        CHECK(levels[0] == doctest::Approx(0.25 + onset_s));
        CHECK(levels[1] == doctest::Approx(0.5));
        CHECK(levels[2] == doctest::Approx(1.0));
    }
    CHECK(now.at(1500)[0] == doctest::Approx(0.45)); // a past one is not found again: as at 3999
    CHECK(now.at(4000) == std::vector<double>{0.0, 0.0, 0.0});
}

} // namespace sounding_now_test
