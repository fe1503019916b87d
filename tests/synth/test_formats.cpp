// SPDX-License-Identifier: MIT
#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include <tactor/error.hpp>

#include "pieces.hpp"
#include "synth/guard/guard.hpp"
#include "synth/mix/converter.hpp"
#include "synth/mix/oscillator.hpp"

namespace formats_test {

using namespace tactor;
using namespace pieces;

namespace {

std::vector<std::byte> converted(format_kind f, const std::vector<double>& x)
{
    std::vector<std::byte> out(x.size() * sample_bytes(f));
    for (std::size_t i = 0; i < x.size(); i += 64) {
        const auto n = static_cast<unsigned>(std::min<std::size_t>(64, x.size() - i));
        const synth::channel_samples one[] = {{0, x.data() + i, 1.0}};
        synth::interleave(f, one, 1, n, out.data() + i * sample_bytes(f));
    }
    return out;
}

} // namespace

TEST_CASE("full scale does not wrap in any format")
{
    const std::vector<double> x{1.0, -1.0, 1.0 - 1e-12, -1.0 + 1e-12, 1.0 + 1e-12, -1.0 - 1e-12};
    for (const format_kind f : all_formats) {
        const auto bytes = converted(f, x);
        for (std::size_t i = 0; i < x.size(); ++i) {
            CAPTURE(to_string(f));
            CAPTURE(x[i]);
            if (f == format_kind::float32) {
                CHECK(std::abs(static_cast<double>(sample<float>(bytes, i)) - x[i]) < 1e-6);
            } else {
                const double want = x[i] > 0.0 ? full_scale(f) - 1.0 : -full_scale(f);
                CHECK(std::abs(static_cast<double>(integer(bytes, f, i)) - want) <=
                      (f == format_kind::s32 ? 1.0 : 0.0));
            }
        }
    }
    CHECK(integer(converted(format_kind::s32, {1.0}), format_kind::s32, 0) == 2147483647);
    CHECK(integer(converted(format_kind::s32, {-1.0}), format_kind::s32, 0) == -2147483648LL);
}

TEST_CASE("integers are rounded to the nearest, ties to even")
{
    for (const format_kind f : all_formats) {
        if (f == format_kind::float32)
            continue;
        std::vector<double> x;
        for (int i = -1000; i <= 1000; ++i)
            x.push_back(0.125 * i / full_scale(f));
        const auto bytes = converted(f, x);
        for (std::size_t i = 0; i < x.size(); ++i)
            CHECK(static_cast<double>(integer(bytes, f, i)) == std::nearbyint(x[i] * full_scale(f)));
    }
}

TEST_CASE("S24 in four bytes is right-aligned and sign-extended")
{
    const auto bytes = converted(format_kind::s24_4, {-0.5, 0.5});
    CHECK(sample<std::int32_t>(bytes, 0) == -4194304);
    CHECK(sample<std::int32_t>(bytes, 1) == 4194304);
}

TEST_CASE("silence has no negative zeros")
{
    const auto bytes = converted(format_kind::float32, {-0.0, 0.0, -1e-300});
    CHECK(sample<std::uint32_t>(bytes, 0) == 0U);
    CHECK(sample<std::uint32_t>(bytes, 1) == 0U);
}

TEST_CASE("for any sounding channels, each sample is in its place and the others are silent")
{
    std::mt19937_64 random(3);
    std::vector<double> x(synth::block_frames);
    for (double& v : x)
        v = std::uniform_real_distribution<double>(-1.0, 1.0)(random);
    for (int i = 0; i < 3000; ++i) {
        const format_kind f = all_formats[random() % std::size(all_formats)];
        const auto channels = 1 + random() % 20;
        const auto n = static_cast<unsigned>(1 + random() % 70);
        std::vector<synth::channel_samples> sounding;
        for (std::uint32_t c = 0; c < channels; ++c)
            if (random() % 2 == 0)
                sounding.push_back({c, x.data() + c, 0.1 * (c + 1)});
        std::vector<std::byte> out(n * channels * sample_bytes(f) + 16, std::byte{0x55});
        synth::interleave(f, sounding, channels, n, out.data());
        std::vector<std::byte> want(out.size(), std::byte{0x55});
        std::fill(want.begin(), want.end() - 16, std::byte{});
        for (const synth::channel_samples& c : sounding) {
            for (std::size_t k = 0; k < n; ++k) {
                const auto one = converted(f, {c.gain * c.x[k]});
                std::copy(one.begin(), one.end(),
                          want.begin() +
                              static_cast<std::ptrdiff_t>((k * channels + c.channel) * sample_bytes(f)));
            }
        }
        REQUIRE(out == want);
    }
}

TEST_CASE("the limiter clamps, silences non-numbers, and counts")
{
    const double inf = std::numeric_limits<double>::infinity();
    std::vector<double> x{0.0, 0.4, -0.5, 0.6, -7.0, inf, -inf, std::nan("")};
    CHECK(synth::limit_block(x.data(), 8, 0.5) == 5);
    CHECK((x == std::vector<double>{0.0, 0.4, -0.5, 0.5, -0.5, 0.5, -0.5, 0.0}));
    CHECK(synth::limit_block(x.data(), 8, 0.5) == 0);
    CHECK(synth::limit_block(x.data(), 8, 0.0) == 6);
    std::vector<double> noise{0.5 * (1.0 + 4e-16)};
    CHECK(synth::limit_block(noise.data(), 1, 0.5) == 0);
    CHECK(noise[0] == 0.5);
}

TEST_CASE("sample formats have names and sizes")
{
    for (const format_kind f : all_formats)
        CHECK(from_string<format_kind>(to_string(f)) == f);
    CHECK(from_string<format_kind>("s24") == format_kind::s24_3);
    CHECK(from_string<format_kind>("s24-4") == format_kind::s24_4);
    CHECK(sample_bytes(format_kind::s24_3) == 3);
    CHECK(sample_bytes(format_kind::s24_4) == 4);
    CHECK(sample_bytes(format_kind::s16) == 2);
    CHECK_THROWS_AS(from_string<format_kind>("s25"), error);
    CHECK_THROWS_AS(from_string<format_kind>(""), error);
}

} // namespace formats_test
