// SPDX-License-Identifier: MIT
// Rendering in blocks of any size: the same bytes.
#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "pieces.hpp"
#include "rounds.hpp"

namespace blocks_test {

using namespace tactor;
using namespace pieces;

namespace {

std::vector<score> various()
{
    std::mt19937_64 random(11);
    std::vector<score> all;
    for (const phase_kind phase : {phase_kind::burst, phase_kind::stroke}) {
        for (const overlap_kind join : {overlap_kind::energy, overlap_kind::max, overlap_kind::sum}) {
            for (const unsigned rate : {8000U, 44100U, 48000U}) {
                render_options o;
                o.phase = phase;
                o.rate = rate;
                o.channels = 7;
                o.level_dbfs = -30.0;
                plan a = make_random(random, 5, 30, 0.4);
                plan b = make_random(random, 5, 10, 0.3);
                a.overlap = b.overlap = join;
                all.emplace_back(
                    row(5), std::vector<placed_plan>{{a, {}}, {make_continuous(5, 0.31), 0.1}, {b, 0.25}}, o);
            }
        }
    }
    return all;
}

} // namespace

TEST_CASE("any block size gives the same bytes")
{
    std::mt19937_64 random(3);
    const std::vector<score> all = various();
    for (int i = 0; i < tactor::test::rounds(18); ++i) {
        const score& s = all[static_cast<std::size_t>(i) * 7 % all.size()]; // all 18, or a few different ones
        for (const format_kind f : all_formats) {
            const auto whole = render(s, f);
            const std::size_t sizes[] = {1, 7, 63, 64, 65, 96, 1000, 4096};
            const std::size_t largest = sizes[random() % 8];
            const auto parts = render(
                s, f, [&] { return 1 + random() % largest; }, s.frames());
            CHECK((whole == parts));
            const std::size_t fixed = sizes[random() % 8];
            CHECK((whole == render(
                                s, f, [&] { return fixed; }, s.frames())));
        }
    }
}

TEST_CASE("the renderer goes on in silence after the end")
{
    const score s = various().front();
    const auto longer = render(
        s, format_kind::s16, [] { return 100; }, s.frames() + 1000);
    const auto exact = render(s, format_kind::s16);
    CHECK(std::equal(exact.begin(), exact.end(), longer.begin()));
    CHECK(std::all_of(longer.begin() + static_cast<std::ptrdiff_t>(exact.size()), longer.end(),
                      [](std::byte b) { return b == std::byte{0}; }));
}

TEST_CASE("a part of a frame is refused and writes nothing; an empty block is accepted")
{
    const score s = various().front();
    renderer r(s, format_kind::s16);
    std::vector<std::byte> out(100 * s.channels() * 2 + 1, std::byte{0x55});
    CHECK_THROWS_WITH_AS(r.process(out), doctest::Contains("whole number of frames"), error);
    CHECK(r.position() == 0);
    CHECK(std::all_of(out.begin(), out.end(), [](std::byte b) { return b == std::byte{0x55}; }));
    r.process({});
    CHECK(r.position() == 0);
    r.process(std::span(out).first(100 * s.channels() * 2));
    CHECK(r.position() == 100);
}

TEST_CASE("more voices than a block has frames keep their order")
{
    // Hundreds of overlapping plans on one tactor: sums in another order would differ in the last bits.
    std::mt19937_64 random(5);
    std::vector<placed_plan> plans;
    for (int i = 0; i < tactor::test::rounds(400); ++i)
        plans.push_back({make_random(random, 3, 3, 0.05), 0.0005 * i});
    render_options o;
    o.level_dbfs = -60.0;
    const score s(row(3), plans, o);
    const auto whole = render(s, format_kind::float32);
    CHECK((whole == render(
                        s, format_kind::float32, [] { return 1; }, s.frames())));
    CHECK((whole == render(
                        s, format_kind::float32, [&] { return 1 + random() % 300; }, s.frames())));
}

TEST_CASE("a stroke has the same bytes at any start")
{
    std::mt19937_64 random(23);
    for (int i = 0; i < 20; ++i) {
        const plan parts[] = {make_random(random, 3, 12, 0.2), make_continuous(3, 0.1)};
        for (const plan& p : parts) {
            const double later_s = 1.0 + static_cast<double>(random() % 100000) / 48000.0;
            render_options o;
            o.level_dbfs = -20.0;
            const score first(row(3), {{p, {}}}, o);
            const score later(row(3), {{p, later_s}}, o);
            for (const format_kind f : {format_kind::float32, format_kind::s32}) {
                const auto x = render(first, f);
                const auto y = render(later, f);
                REQUIRE(y.size() - x.size() == later.starts()[0] * 12);
                CHECK(std::equal(x.begin(), x.end(),
                                 y.begin() + static_cast<std::ptrdiff_t>(y.size() - x.size())));
            }
        }
    }
}

} // namespace blocks_test
