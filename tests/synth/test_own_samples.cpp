// SPDX-License-Identifier: MIT
// Samples of one's own: bit for bit what they were, under the limits that strokes have.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/render.hpp>

#include "caught.hpp"
#include "count_allocations.hpp"
#include "has.hpp"
#include "pieces.hpp"
#include "synth/score/score_view.hpp"

namespace own_samples_test {

using namespace tactor;
using namespace pieces;

namespace {

constexpr unsigned rate = 8000;
const render_options loud{.rate = rate, .level_dbfs = 0.0};

std::vector<std::byte> rendered(const score& s, format_kind f, std::vector<std::size_t> pieces = {4096})
{
    const std::size_t frame = s.channels() * sample_bytes(f);
    std::vector<std::byte> all(s.frames() * frame);
    renderer r(s, f);
    std::size_t done = 0;
    for (std::size_t i = 0; done < s.frames(); ++i) {
        const std::size_t n = std::min<std::size_t>(pieces[i % pieces.size()], s.frames() - done);
        r.process(std::span(all).subspan(done * frame, n * frame));
        done += n;
    }
    return all;
}

template <class T>
std::vector<std::byte> as_bytes(const std::vector<T>& values)
{
    std::vector<std::byte> b(values.size() * sizeof(T));
    std::memcpy(b.data(), values.data(), b.size());
    return b;
}

template <class T>
std::vector<T> read_values(const std::vector<std::byte>& bytes)
{
    std::vector<T> v(bytes.size() / sizeof(T));
    std::memcpy(v.data(), bytes.data(), bytes.size());
    return v;
}

own_samples floats(unsigned channels, const std::vector<float>& x)
{
    return {.rate = rate, .channels = channels, .bytes = as_bytes(x)};
}

/// Makes channels of 250 Hz whose amplitude in a frame is amplitude(t_s), all in phase.
template <class Amplitude>
own_samples tones(unsigned channels, double seconds, Amplitude amplitude)
{
    std::vector<float> x;
    for (unsigned k = 0; k < seconds * rate; ++k) {
        const double t_s = k / double{rate};
        const double v = amplitude(t_s) * std::sin(2.0 * pi * 250.0 * t_s);
        x.insert(x.end(), channels, static_cast<float>(v) + 0.0F); // a negative zero becomes zero
    }
    return floats(channels, x);
}

/// Random bits that are samples of a format, of 3 channels and 5000 frames.
own_samples random_samples(format_kind f)
{
    std::mt19937 random(7);
    own_samples s{.rate = rate, .channels = 3, .format = f};
    for (unsigned i = 0; i < 3 * 5000; ++i) {
        auto bits = static_cast<std::uint32_t>(random());
        if (f == format_kind::float32) // the sign, an exponent of 2^-40 to 2^-1, and any fraction
            bits = (bits & 0x807FFFFFU) | ((87U + static_cast<std::uint32_t>(random()) % 40U) << 23U);
        else if (f == format_kind::s24_4)
            bits = static_cast<std::uint32_t>(static_cast<std::int32_t>(bits) / 256);
        const auto* first = reinterpret_cast<const std::byte*>(&bits);
        s.bytes.insert(s.bytes.end(), first, first + sample_bytes(f));
    }
    return s;
}

} // namespace

TEST_CASE("one's own samples come out bit for bit, in pieces of any length, under limits, too")
{
    array a = row(3);
    a.tactors[0].gain_db = -7.0;
    a.tactors[1].polarity = -1;
    a.tactors[2].gain_db = 3.0;
    a.tactors[2].rise_s = 0.02;
    for (const format_kind f : all_values<format_kind>()) {
        CAPTURE(to_string(f));
        const own_samples s = random_samples(f);
        for (const bool limited : {false, true}) {
            render_options o = loud;
            if (limited)
                o.limits = drive_limits{};
            const score made = score::from_samples(a, s, o);
            CHECK(made.frames() == 5000);
            CHECK((rendered(made, f) == s.bytes));
            CHECK((rendered(made, f, {1, 7, 513, 40}) == s.bytes));
        }
    }
}

TEST_CASE("a format of more bits holds one's own samples, one of fewer rounds them")
{
    const own_samples s = random_samples(format_kind::s16);
    const score made = score::from_samples(row(3), s, loud);
    const auto narrow = read_values<std::int16_t>(s.bytes);
    const auto wide = read_values<std::int32_t>(rendered(made, format_kind::s32));
    const auto real = read_values<float>(rendered(made, format_kind::float32));
    bool same = true;
    for (std::size_t i = 0; i < narrow.size(); ++i)
        same = same && wide[i] == narrow[i] * 65536 && real[i] == static_cast<float>(narrow[i]) / 32768.0F;
    CHECK(same);
    const score small =
        score::from_samples(row(1), floats(1, {0.6F / 32768, 1.5F / 32768, -2.5F / 32768}), loud);
    CHECK((read_values<std::int16_t>(rendered(small, format_kind::s16)) ==
           std::vector<std::int16_t>{1, 2, -2}));
}

TEST_CASE("the limit on power weakens one's own samples that exceed it, and no others")
{
    render_options o = loud;
    o.limits = drive_limits{.max_drive_s = 10.0}; // the power of three sines at full scale
    const auto full = [](double) { return 1.0; };
    const own_samples three = tones(3, 0.5, full);
    CHECK((rendered(score::from_samples(row(3), three, o), format_kind::float32) == three.bytes));
    const auto out = read_values<float>(
        rendered(score::from_samples(row(4), tones(4, 0.5, full), o), format_kind::float32));
    double most = 0.0;
    for (std::size_t i = 4 * 2000; i < out.size(); ++i) // after it has settled
        most = std::max(most, std::abs(static_cast<double>(out[i])));
    CHECK(most == doctest::Approx(std::sqrt(3.0 / 4.0)).epsilon(0.001));
    for (std::size_t k = 0; k < out.size(); k += 4) {
        double sum = 0.0;
        for (std::size_t c = 0; c < 4; ++c)
            sum += static_cast<double>(out[k + c]) * static_cast<double>(out[k + c]);
        REQUIRE(sum < 3.0 * (1.0 + 1e-6));
    }
}

TEST_CASE("one's own samples count as driven where they are above -40 dBFS")
{
    render_options o = loud;
    o.limits = drive_limits{.max_drive_s = 1.0, .window_s = 3.0};
    const auto play = [&](const own_samples& s) {
        return read_values<float>(rendered(score::from_samples(row(1), s, o), format_kind::float32));
    };
    const auto steady = play(tones(1, 2.0, [](double) { return 0.1; }));
    const auto any = [&](const std::vector<float>& x, double from_s, double to_s) {
        return std::any_of(x.begin() + static_cast<std::ptrdiff_t>(from_s * rate),
                           x.begin() + static_cast<std::ptrdiff_t>(to_s * rate),
                           [](float v) { return v != 0.0F; });
    };
    CHECK(any(steady, 0.9, 0.99));
    CHECK_FALSE(any(steady, 1.03, 1.9));
    // Half of the time rests between, and the level falls by half a second a second.
    const own_samples beats = tones(1, 6.0, [](double t) { return std::fmod(t, 0.6) < 0.18 ? 0.5 : 0.0; });
    CHECK((as_bytes(play(beats)) == beats.bytes));
    // A click now and then does not make hours of weak noise count.
    const own_samples weak = tones(1, 6.0, [](double t) { return std::fmod(t, 1.5) < 0.01 ? 0.9 : 0.009; });
    CHECK((as_bytes(play(weak)) == weak.bytes));
}

TEST_CASE("a channel without a tactor plays one's own samples and the marker")
{
    render_options o = loud;
    o.level_dbfs = -12.0;
    o.channels = 2;
    own_samples s = tones(2, 0.1, [](double) { return 0.2; });
    auto x = read_values<float>(s.bytes);
    for (std::size_t i = 0; i < x.size(); i += 2)
        x[i + 1] = i < 80 ? 1.0F : 0.25F; // a constant may be there
    s.bytes = as_bytes(x);
    CHECK((rendered(score::from_samples(row(1), s, o), format_kind::float32) == s.bytes));
    o.marker_channel = 1; // of 40 frames: what the samples have there already
    CHECK((rendered(score::from_samples(row(1), s, o), format_kind::float32) == s.bytes));
    o.marker_s = 0.01;
    const auto marked = read_values<float>(rendered(score::from_samples(row(1), s, o), format_kind::float32));
    CHECK(marked[2 * 79 + 1] == 1.0F);
    CHECK(marked[2 * 80 + 1] == 0.25F);
}

TEST_CASE("one's own samples that are too loud are refused with the decibels")
{
    array a = row(2);
    const auto message = [&](const own_samples& s, double level_dbfs) {
        render_options o = loud;
        o.level_dbfs = level_dbfs;
        return caught_message([&] { static_cast<void>(score::from_samples(a, s, o)); });
    };
    own_samples s = floats(2, {0.25F, 0.1F, -0.5F, 0.75F});
    s.file = "two.wav";
    CHECK(message(s, 0.0).empty());
    CHECK(message(s, -2.49).empty()); // 0.75 is -2.4988 dBFS
    CHECK(message(s, -12.0) ==
          "two.wav: channel 1 (tactor 1) peaks at -2.49 dBFS, 9.51 dB above the level of "
          "-12 dBFS (make the samples quieter by 9.51 dB, or use level_dbfs = -2.49)");
    a.tactors[0].max_dbfs = -20.0;
    CHECK(message(s, -2.0) ==
          "two.wav: channel 0 (tactor 0) peaks at -6.02 dBFS, 13.98 dB above its "
          "max_dbfs of -20 dBFS (make the samples quieter by 13.98 dB, or raise max_dbfs)");
    a = row(1);
    CHECK(has(message(floats(1, {1.25F}), 0.0), "samples: channel 0 (tactor 0) peaks at 1.94 dBFS"));
    // Rounding does not lift what render() writes above its level.
    for (const double level_dbfs : {-12.0, -23.0, -41.0, -60.0})
        for (const format_kind f : all_values<format_kind>()) {
            a = row(1);
            a.tactors[0].max_dbfs = level_dbfs;
            const score tone(a, make_plan({make_burst(0.0, 0.1, {{0, 1.0}})}),
                             {.rate = rate, .level_dbfs = level_dbfs});
            own_samples again{.rate = rate, .channels = 1, .format = f, .bytes = rendered(tone, f)};
            CHECK(message(again, level_dbfs).empty());
            CHECK((rendered(score::from_samples(a, again, {.rate = rate, .level_dbfs = level_dbfs}), f) ==
                   again.bytes));
        }
}

TEST_CASE("one's own samples that do not fit are refused with what to do")
{
    const auto message = [](const own_samples& s, const render_options& o) {
        return caught_message([&] { static_cast<void>(score::from_samples(row(2), s, o)); });
    };
    const own_samples two = floats(2, {0.1F, 0.2F});
    CHECK(message(two, {.rate = 44100}) ==
          "samples: its rate is 8000 Hz, but the stream's is 44100 Hz (use rate = "
          "8000, or convert the file: sox IN -r 44100 OUT)");
    CHECK(has(message(floats(3, {0.1F, 0.2F, 0.0F}), loud),
              "it has 3 channels, but the stream has 2 (use channels = 3, or leave some channels out: sox IN "
              "OUT remix 1 2)"));
    CHECK(has(message(floats(1, {0.1F}), loud),
              "it has 1 channel, but the stream has 2 (add silent channels: sox IN OUT remix 1 0)"));
    CHECK(has(message(floats(2, {}), loud), "it has no samples"));
    CHECK(
        has(message(floats(2, {0.1F, 0.2F, 0.3F}), loud), "12 bytes are not a whole number of frames of 8"));
    CHECK(has(message(floats(2, {0.1F, 0.2F, 0.0F, std::numeric_limits<float>::quiet_NaN()}), loud),
              "channel 1 is nan at frame 1"));
    render_options sl = loud;
    sl.sl_db = 7.0;
    CHECK(has(message(two, sl), "a sensation level needs a carrier"));
}

TEST_CASE("silence of one's own is a stroke, too")
{
    const own_samples quiet = floats(2, std::vector<float>(200, 0.0F));
    const score s = score::from_samples(row(2), quiet, loud);
    CHECK((rendered(s, format_kind::float32) == quiet.bytes));
    CHECK(s.starts() == std::vector<std::uint64_t>{0});
    CHECK(s.plans().size() == 1);
}

TEST_CASE("the level of one's own samples is shown where they sound")
{
    render_options o = loud;
    o.level_dbfs = 20.0 * std::log10(0.5);
    const score s = score::from_samples(
        row(1), tones(1, 3.0, [](double t) { return t < 1.0   ? 0.5
                                                    : t < 2.0 ? 0.0
                                                              : 0.25; }), o);
    synth::sounding_now now(s);
    CHECK(now.at(rate / 2)[0] == doctest::Approx(1.0).epsilon(0.01));
    CHECK(now.at(3 * rate / 2)[0] == 0.0);
    CHECK(now.at(5 * rate / 2)[0] == doctest::Approx(0.5).epsilon(0.01));
}

COUNTING_TEST_CASE("one's own samples are played without allocating")
{
    render_options o = loud;
    o.limits = drive_limits{};
    const score s = score::from_samples(row(3), random_samples(format_kind::s24_3), o);
    std::vector<std::byte> block(128 * 3 * 4);
    renderer r(s, format_kind::float32);
    const test::count_allocations count;
    for (unsigned i = 0; i < 40; ++i)
        r.process(block);
    CHECK(count.calls() == 0);
}

} // namespace own_samples_test
