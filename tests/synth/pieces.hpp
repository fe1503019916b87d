// SPDX-License-Identifier: MIT
/// \file
/// Small arrays, plans and renderings for the tests of synth and wav.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <random>
#include <span>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/plan.hpp>
#include <tactor/render.hpp>

#include "own_curve.hpp"
#include "synth/wave/event.hpp"

namespace pieces {

inline constexpr double pi = 3.14159265358979323846;

/// Makes n tactors in a row, channel = index.
inline tactor::array row(unsigned n)
{
    return tactor::make_grid("row", 1, n, 20.0, 20.0);
}

inline tactor::burst make_burst(double onset_s, double duration_s, std::vector<tactor::drive> drives,
                                double a_v = 1.0)
{
    return {.onset_s = onset_s, .duration_s = duration_s, .intensity = a_v, .drives = std::move(drives)};
}

/// Makes a drive of one channel without ramps.
inline tactor::synth::drive_event make_event(std::uint64_t start, std::uint32_t length,
                                             double cycles_per_frame, tactor::synth::channel_drive d)
{
    tactor::synth::drive_event e;
    e.start = start;
    e.length = e.window = length;
    e.cycles_per_frame = cycles_per_frame;
    e.drives = 1;
    e.drive[0] = d;
    return e;
}

inline tactor::plan make_plan(std::vector<tactor::burst> bursts, double carrier_hz = 250.0)
{
    tactor::plan p;
    p.algorithm = "by hand";
    p.carrier_hz = carrier_hz;
    for (const tactor::burst& b : bursts)
        p.total_s = std::max(p.total_s, b.onset_s + b.duration_s);
    p.stroke_duration_s = p.total_s;
    p.bursts = std::move(bursts);
    return p;
}

/// Makes a plan whose intensity moves from tactor 0 over the row to the last; each moment has one or two
/// tactors.
inline tactor::plan make_continuous(unsigned tactors, double duration_s, double carrier_hz = 250.0)
{
    tactor::plan p;
    p.algorithm = "continuous";
    p.carrier_hz = carrier_hz;
    p.total_s = p.stroke_duration_s = duration_s;
    p.curve = tactor::test::make_curve(duration_s, [tactors, duration_s](double t, tactor::burst& out) {
        const double place = t / duration_s * (tactors - 1);
        const auto left = static_cast<unsigned>(place);
        const double f = place - left;
        out.drives.clear();
        out.drives.push_back({left, std::sqrt(1.0 - f)});
        if (f > 0.0)
            out.drives.push_back({left + 1, std::sqrt(f)});
    });
    return p;
}

/// Makes random bursts, many of which overlap.
inline tactor::plan make_random(std::mt19937_64& random, unsigned tactors, unsigned bursts, double total_s)
{
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<tactor::burst> all;
    for (unsigned i = 0; i < bursts; ++i) {
        std::vector<tactor::drive> drives;
        for (unsigned t = 0; t < tactors; ++t)
            if (unit(random) < 0.5)
                drives.push_back({t, 0.01 + 0.4 * unit(random)});
        all.push_back(make_burst(total_s * unit(random), 0.001 + 0.1 * unit(random), drives));
    }
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.onset_s < b.onset_s; });
    return make_plan(std::move(all), 100.0 + 300.0 * unit(random));
}

/// Renders the whole piece in blocks of the sizes that next() gives.
template <class Next>
std::vector<std::byte> render(const tactor::score& s, tactor::format_kind f, Next next, std::size_t frames)
{
    const std::size_t frame_bytes = s.channels() * tactor::sample_bytes(f);
    std::vector<std::byte> out(frames * frame_bytes, std::byte{0x55});
    tactor::renderer r(s, f);
    for (std::size_t done = 0; done < frames;) {
        const std::size_t n = std::min<std::size_t>(frames - done, next());
        r.process(std::span(out).subspan(done * frame_bytes, n * frame_bytes));
        done += n;
    }
    return out;
}

inline std::vector<std::byte> render(const tactor::score& s, tactor::format_kind f)
{
    return render(
        s, f, [&s] { return std::max<std::size_t>(1, s.frames()); }, s.frames());
}

template <class T>
T sample(const std::vector<std::byte>& bytes, std::size_t i)
{
    T v;
    std::memcpy(&v, bytes.data() + i * sizeof(T), sizeof(T));
    return v;
}

/// Returns sample i of a rendering as an integer, in any format except float.
inline std::int64_t integer(const std::vector<std::byte>& bytes, tactor::format_kind f, std::size_t i)
{
    switch (f) {
    case tactor::format_kind::s16:
        return sample<std::int16_t>(bytes, i);
    case tactor::format_kind::s24_3: {
        std::uint32_t v = 0;
        std::memcpy(&v, bytes.data() + 3 * i, 3);
        return static_cast<std::int32_t>(v << 8) >> 8;
    }
    default:
        return sample<std::int32_t>(bytes, i);
    }
}

inline double full_scale(tactor::format_kind f)
{
    switch (f) {
    case tactor::format_kind::s16:
        return 32768.0;
    case tactor::format_kind::s32:
        return 2147483648.0;
    default:
        return 8388608.0;
    }
}

inline constexpr tactor::format_kind all_formats[] = {tactor::format_kind::float32, tactor::format_kind::s16,
                                                      tactor::format_kind::s24_3, tactor::format_kind::s24_4,
                                                      tactor::format_kind::s32};

/// Returns a channel of a rendering in floats.
inline std::vector<double> channel(const tactor::score& s, unsigned c)
{
    const auto bytes = render(s, tactor::format_kind::float32);
    std::vector<double> x(s.frames());
    for (std::size_t k = 0; k < x.size(); ++k)
        x[k] = static_cast<double>(sample<float>(bytes, k * s.channels() + c));
    return x;
}

/// Computes a carrier from the formula, whose phase is 0 at frame 0.
template <class T>
double sine(double hz, T frame, double rate = 48000.0)
{
    return std::sin(2.0 * pi * hz * static_cast<double>(frame) / rate);
}

/// Computes section 7's window from the formula.
inline double window(std::int64_t k, std::int64_t n, std::int64_t r)
{
    if (k < r)
        return 0.5 * (1.0 - std::cos(pi * static_cast<double>(k) / static_cast<double>(r)));
    if (k >= n - r)
        return 0.5 * (1.0 - std::cos(pi * static_cast<double>(n - k) / static_cast<double>(r)));
    return 1.0;
}

/// Hashes by FNV-1a, 64 bits.
inline std::uint64_t digest(std::span<const std::byte> bytes)
{
    std::uint64_t h = 14695981039346656037U;
    for (const std::byte b : bytes)
        h = (h ^ static_cast<std::uint64_t>(b)) * 1099511628211U;
    return h;
}

} // namespace pieces
