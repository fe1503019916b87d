// SPDX-License-Identifier: MIT
// Places that are at hand are those that are computed, and no path is too awkward or too long for that.
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/path.hpp>

#include "core/access.hpp"
#include "core/path/impl.hpp"
#include "path_samples.hpp"
#include "rounds.hpp"

namespace curve_places_test {

using namespace tactor;

namespace {

std::size_t curves_at_hand(const path& p)
{
    std::size_t count = 0;
    for (const path::impl::measured_curve& c : detail::access::of(p).curves)
        count += c.places != nullptr ? 1 : 0;
    return count;
}

double farthest_mm(const path& a, const path& b)
{
    constexpr int places = 20'000;
    double most = 0.0;
    for (int i = 0; i <= places; ++i) {
        const double s_mm = a.length_mm() * i / places;
        most = std::max(most, distance_mm(a.at(s_mm), b.at(s_mm)));
    }
    return most;
}

} // namespace

TEST_CASE("places at hand are within 1e-9 mm of those that are computed, at cusps and in narrow turns, too")
{
    std::vector<std::string> all(test::awkward_curves.begin(), test::awkward_curves.end());
    all.emplace_back("M 2 20 A 18 9 20 1 1 30 30");
    all.emplace_back("M 0 0 A 30 0.01 0 1 1 40 0");
    all.emplace_back("M 0 0 A 20 20 0 1 1 10 0");
    std::mt19937_64 random(43);
    for (int i = 0; i < test::rounds(100); ++i)
        all.push_back(test::random_path(random, 5));
    std::size_t at_hand = 0;
    for (const std::string& data : all) {
        CAPTURE(data);
        const path p = path::from_svg(data);
        const path quick = detail::with_places(p, 1e-6);
        at_hand += curves_at_hand(quick);
        CHECK(quick.length_mm() == p.length_mm());
        CHECK(farthest_mm(p, quick) < (p.length_mm() > 1e3 ? 1e-7 : 1e-9));
        CHECK(curves_at_hand(p) == 0);
    }
    CHECK(at_hand > all.size());
}

TEST_CASE("curves that are passed in a moment are computed")
{
    const path curve = path::from_svg("M 0 10 C 20 -5 20 45 40 30");
    CHECK(curves_at_hand(detail::with_places(curve, curve.length_mm() / 300)) == 1);
    CHECK(curves_at_hand(detail::with_places(curve, curve.length_mm() / 200)) == 0);
}

TEST_CASE("a path of kilometres or of very many curves takes no more than some megabytes")
{
    const path huge =
        path::from_svg("M 0 0 C 900000 400000 -900000 500000 800000 1 A 300000 10 0 0 1 300000 1");
    CHECK(farthest_mm(huge, detail::with_places(huge, 1e-3)) < 1e-6);
    std::string many = "M 0 0";
    for (int i = 0; i < 4000; ++i)
        many += " q 10 30 20 0 q -10 -30 -20 0";
    const path p = path::from_svg(many);
    const std::size_t at_hand = curves_at_hand(detail::with_places(p, 1e-6));
    CHECK(at_hand > 500);
    CHECK(at_hand < 1000);
}

} // namespace curve_places_test
