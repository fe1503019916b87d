// SPDX-License-Identifier: MIT
#include "study/masking/masking.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>
#include <span>
#include <vector>

#include <doctest/doctest.h>

#include "caught.hpp"
#include "has.hpp"
#include "rounds.hpp"

namespace tactor::study::test_masking {
namespace {

double measure_level(const std::vector<double>& x)
{
    double squares = 0.0;
    for (const double v : x)
        squares += v * v;
    return 10.0 * std::log10(squares / static_cast<double>(x.size()));
}

std::vector<double> samples(noise_color c, double dbfs, const char* seed, std::size_t n)
{
    noise source(c, dbfs, seed);
    std::vector<double> x(n);
    std::generate(x.begin(), x.end(), [&] { return source.next(); });
    return x;
}

// Returns the power in a Hz around a frequency, at 48 kHz, mean over blocks of 4096 with a Hann window.
double density_db(const std::vector<double>& x, double hz)
{
    constexpr std::size_t block = 4096;
    const double w = 2.0 * std::numbers::pi * hz / 48000.0;
    double power = 0.0;
    for (std::size_t from = 0; from + block <= x.size(); from += block) {
        double re = 0.0;
        double im = 0.0;
        for (std::size_t i = 0; i < block; ++i) {
            const double hann = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / block);
            re += hann * x[from + i] * std::cos(w * static_cast<double>(i));
            im += hann * x[from + i] * std::sin(w * static_cast<double>(i));
        }
        power += re * re + im * im;
    }
    return 10.0 * std::log10(power);
}

// Returns the mean around it, from 0.8 to 1.2 of it.
double band_db(const std::vector<double>& x, double hz)
{
    double sum = 0.0;
    for (int i = 0; i < 9; ++i)
        sum += density_db(x, hz * (0.8 + 0.05 * i));
    return sum / 9.0;
}

TEST_CASE("noise has the given level, and the same seed gives the same samples")
{
    for (const noise_color c : {noise_color::white, noise_color::pink}) {
        CAPTURE(static_cast<int>(c));
        const auto x = samples(c, -30.0, "a", 1 << 19);
        CHECK(measure_level(x) == doctest::Approx(-30.0).epsilon(0.02)); // pink is slow to settle
        CHECK(x == samples(c, -30.0, "a", 1 << 19));
        CHECK(x != samples(c, -30.0, "b", 1 << 19));
        const auto loud = samples(c, max_noise_dbfs(c), "a", 1 << 18);
        CHECK(std::count_if(loud.begin(), loud.end(), [](double v) { return std::abs(v) >= 1.0; }) == 0);
    }
}

TEST_CASE("white noise is equally strong at each frequency, pink falls by 3 dB an octave")
{
    const std::size_t n = static_cast<std::size_t>(test::rounds(128)) * 4096;
    const auto white = samples(noise_color::white, -20.0, "s", n);
    const auto pink = samples(noise_color::pink, -20.0, "s", n);
    for (const double hz : {100.0, 400.0, 1600.0, 6400.0}) {
        CAPTURE(hz);
        const double octaves = std::log2(hz / 1600.0);
        CHECK(std::abs(band_db(white, hz) - band_db(white, 1600.0)) < 1.5);
        CHECK(std::abs(band_db(pink, hz) - band_db(pink, 1600.0) + 3.0103 * octaves) < 1.5);
    }
}

// A device whose clock the test moves.
class own_sink final : public sink {
public:
    own_sink()
    {
        setup_.name = "phones";
        setup_.channels = 2;
        setup_.rate = 48000;
        setup_.format = format_kind::float32;
        setup_.period_frames = 100;
        setup_.buffer_frames = 400;
    }

    const stream_setup& setup() const noexcept override { return setup_; }
    io_kind prepare() noexcept override
    {
        ++prepared;
        written_ = played_ = 0;
        return preparing;
    }
    io_kind start() noexcept override { return io_kind::ok; }
    io_kind resume() noexcept override { return io_kind::failed; }
    std::size_t max_descriptors() const noexcept override { return 0; }
    std::size_t descriptors(std::span<pollfd>) noexcept override { return 0; }
    io_kind ready(std::span<pollfd>) noexcept override { return io_kind::ok; }
    io_result available() noexcept override
    {
        return {next, static_cast<std::size_t>(setup_.buffer_frames - (written_ - played_)), 0};
    }
    io_result write(std::span<const std::byte> offered) noexcept override
    {
        // Takes fewer than offered, as devices may.
        const std::size_t frames = std::min<std::size_t>(offered.size() / setup_.frame_bytes(), 37);
        std::vector<float> x(2 * frames);
        std::memcpy(x.data(), offered.data(), x.size() * sizeof(float));
        all.insert(all.end(), x.begin(), x.end());
        written_ += frames;
        return {io_kind::ok, frames, 0};
    }
    stream_position position() noexcept override { return {written_, played_, 0, true}; }
    void drop() noexcept override {}

    void play(std::uint64_t frames) { played_ = std::min(written_, played_ + frames); }

    std::vector<float> all;
    unsigned prepared = 0;
    io_kind next = io_kind::ok;
    io_kind preparing = io_kind::ok;

private:
    stream_setup setup_;
    std::uint64_t written_ = 0;
    std::uint64_t played_ = 0;
};

masking_options options()
{
    return {.level_dbfs = -12.0, .fade_s = 0.01, .seed = "x"}; // 480 frames
}

void go_on(masking_stream& m, own_sink& s, bool on, int periods)
{
    for (int i = 0; i < periods; ++i) {
        s.play(100);
        CHECK(m.step(io_kind::ok, on) == io_kind::ok);
    }
}

TEST_CASE("noise fades in and out, alike in both channels, and is full when it is at the DAC")
{
    own_sink s;
    masking_stream m(s, options());
    CHECK(m.begin() == io_kind::ok);
    CHECK(std::all_of(s.all.begin(), s.all.end(), [](float v) { return v == 0.0F; }));
    CHECK(m.state() == masking_state::silent);
    int periods = 0;
    while (m.state() != masking_state::full) {
        go_on(m, s, true, 1);
        ++periods;
    }
    CHECK(periods == 9); // 400 frames of silence and 480 of fade, then the first in full
    go_on(m, s, true, 10);
    const std::size_t until = s.all.size() / 2;
    go_on(m, s, false, 1);
    CHECK(m.state() == masking_state::fading);
    go_on(m, s, false, 8);
    CHECK(m.state() == masking_state::silent);
    for (std::size_t i = 0; i < s.all.size() / 2; ++i) {
        REQUIRE(s.all[2 * i] == s.all[2 * i + 1]);
        const double in = std::clamp((static_cast<double>(i) - 399.0) / 480.0, 0.0, 1.0);
        const double out =
            std::clamp(1.0 - (static_cast<double>(i) - static_cast<double>(until) + 1.0) / 480.0, 0.0, 1.0);
        const double gain = 0.5 - 0.5 * std::cos(std::numbers::pi * std::min(in, out));
        REQUIRE(std::abs(s.all[2 * i]) <= gain * std::pow(10.0, -12.0 / 20.0) * std::numbers::sqrt3 + 1e-6);
    }
    CHECK(m.breaks() == 0);
}

TEST_CASE("an xrun is counted, and the noise begins again from silence")
{
    own_sink s;
    masking_stream m(s, options());
    m.begin();
    go_on(m, s, true, 20);
    CHECK(m.state() == masking_state::full);
    CHECK(m.step(io_kind::xrun, true) == io_kind::ok);
    CHECK(m.breaks() == 1);
    CHECK(s.prepared == 2);
    CHECK(m.state() != masking_state::full);
    go_on(m, s, true, 20);
    CHECK(m.state() == masking_state::full);
    CHECK(m.breaks() == 1);
}

TEST_CASE("a device that is lost, or stands still all the time, ends the noise")
{
    own_sink s;
    masking_stream m(s, options());
    m.begin();
    CHECK(m.step(io_kind::again, true) == io_kind::ok);
    for (int i = 0; i < 3; ++i)
        CHECK(m.step(io_kind::xrun, true) == io_kind::ok);
    CHECK(m.step(io_kind::xrun, true) == io_kind::failed);

    own_sink t;
    masking_stream n(t, options());
    n.begin();
    t.next = io_kind::lost;
    CHECK(n.step(io_kind::ok, true) == io_kind::lost);
}

TEST_CASE("a masker whose device does not start is refused")
{
    auto s = std::make_unique<own_sink>();
    s->preparing = io_kind::lost;
    has(caught_message([&] { const masker m(std::move(s), {}); }),
        "phones: the masking noise does not start: lost");
}

} // namespace
} // namespace tactor::study::test_masking
