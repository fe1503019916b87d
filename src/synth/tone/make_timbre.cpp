// SPDX-License-Identifier: MIT
#include "synth/tone/make_timbre.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/refused.hpp"
#include "core/words.hpp"
#include "synth/tone/vibration_loop.hpp"
#include "synth/wave/oscillator.hpp"

namespace tactor::synth {
namespace {

/// Number of points in a period of the highest harmonic. The error of interpolation between them is -89 dB of
/// that harmonic, and far less for lower harmonics.
constexpr std::size_t points_a_period = 32;

/// Margin for a peak between two points, and for rounding.
constexpr double above_peak = 1.0 + 2e-5;

double find_peak(const wave_samples& x)
{
    return static_cast<double>(std::accumulate(
        x.begin(), x.end(), 0.0F, [](float most, float v) { return std::max(most, std::abs(v)); }));
}

void scale(wave_samples& x, double peak)
{
    const double gain = peak > 0.0 ? 1.0 / (peak * above_peak) : 0.0;
    for (float& v : x)
        v = static_cast<float>(gain * static_cast<double>(v));
}

/// Returns the peak of a cycle, also between its points.
double cycle_peak(const wave_samples& cycle)
{
    constexpr std::size_t between = 8;
    const double points = static_cast<double>(cycle.size() - cycle_margin);
    double peak = 0.0;
    block turns;
    block x;
    const std::size_t all = between * (cycle.size() - cycle_margin);
    for (std::size_t at = 0; at < all; at += block_frames) {
        const auto n = static_cast<unsigned>(std::min<std::size_t>(block_frames, all - at));
        for (unsigned j = 0; j < n; ++j)
            turns[j] = static_cast<double>(at + j) / (between * points);
        read_cycle(cycle, turns.data(), n, x.data());
        for (unsigned j = 0; j < n; ++j)
            peak = std::max(peak, std::abs(x[j]));
    }
    return peak;
}

std::size_t count_cycle_points(std::size_t harmonics)
{
    return std::bit_ceil(points_a_period * std::max<std::size_t>(harmonics, 2));
}

/// Minimum peak after filtering, for samples with a peak of 1 to 2. A smaller peak is only rounding, and
/// scaling would make it as loud as a real signal.
constexpr double least_peak = 1e-5;

void require_signal(double peak, const recording& r)
{
    if (!(peak >= least_peak)) {
        throw error(error_kind::bad_input, recording_name(r),
                    "it has no frequencies below half its own rate and the stream's",
                    "give a slower vibration, a lower {carrier_hz} or a higher rate");
    }
}

/// Returns the samples without their mean, scaled by a power of 2 to a peak of 1 to 2. Sums of such samples
/// are finite and as exact as the samples, whatever the unit of the recording.
std::vector<float> unit_samples(const recording& r)
{
    std::vector<double> x(r.samples.begin(), r.samples.end());
    const auto to_unit = [&x] {
        const double peak = std::accumulate(
            x.begin(), x.end(), 0.0, [](double most, double v) { return std::max(most, std::abs(v)); });
        const double gain = peak > 0.0 ? std::ldexp(1.0, -std::ilogb(peak)) : 0.0;
        std::transform(x.begin(), x.end(), x.begin(), [gain](double v) { return gain * v; });
    };
    to_unit();
    const double mean = std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
    std::transform(x.begin(), x.end(), x.begin(), [mean](double v) { return v - mean; });
    to_unit();
    std::vector<float> samples(x.size());
    std::transform(x.begin(), x.end(), samples.begin(), [](double v) { return static_cast<float>(v); });
    return samples;
}

/// Returns one cycle of the real part of the sum of harmonics. It begins half a cycle before phase 0.
wave_samples make_cycle(spectrum harmonics)
{
    const std::size_t points = harmonics.size();
    for (std::size_t h = 1; h < points; h += 2)
        harmonics[h] = -harmonics[h]; // half a cycle
    compute_fourier_sum(harmonics);
    wave_samples x(points + cycle_margin);
    for (std::size_t i = 0; i < x.size(); ++i)
        x[i] = static_cast<float>(harmonics[(i + points - 1) % points].real());
    return x;
}

double harmonic_amplitude(waveform_kind shape, std::size_t h)
{
    const auto n = static_cast<double>(h);
    const bool odd = h % 2 == 1;
    switch (shape) {
    case waveform_kind::square:
        return odd ? 1.0 / n : 0.0;
    case waveform_kind::triangle:
        return odd ? (h % 4 == 1 ? 1.0 : -1.0) / (n * n) : 0.0;
    case waveform_kind::sawtooth:
        return (odd ? 1.0 : -1.0) / n;
    case waveform_kind::sine:
    case waveform_kind::noise:
    case waveform_kind::recording:
        break;
    }
    return h == 1 ? 1.0 : 0.0;
}

/// Returns the next number of Steele's SplitMix64 (OOPSLA 2014).
std::uint64_t next_random(std::uint64_t& state) noexcept
{
    std::uint64_t z = state += 0x9E3779B97F4A7C15U;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31U);
}

/// Table of a sinc function with a Blackman-Harris window. It is zero beyond width() samples.
class kernel {
public:
    /// Makes the table. `cutoff`: in cycles per sample of the input.
    explicit kernel(double cutoff) : width_(crossings / (2.0 * cutoff)), table_(size + 2)
    {
        for (std::size_t i = 0; i <= size; ++i) {
            const double u = static_cast<double>(i) / size; // 0: the middle, 1: the end
            const double t = u * crossings;
            const double sinc = i == 0 ? 1.0 : sincos_turns(0.5 * t).sin / (3.14159265358979323846 * t);
            const double a = 0.5 * u;
            const double window = 0.35875 + 0.48829 * sincos_turns(a).cos +
                                  0.14128 * sincos_turns(2 * a).cos + 0.01168 * sincos_turns(3 * a).cos;
            table_[i] = 2.0 * cutoff * sinc * window;
        }
    }

    double width() const noexcept { return width_; }
    double at(double d) const noexcept
    {
        const double place = std::min(std::abs(d) / width_, 1.0) * size;
        const auto i = static_cast<std::size_t>(place);
        return table_[i] + (place - static_cast<double>(i)) * (table_[i + 1] - table_[i]);
    }

private:
    static constexpr double crossings = 160.0;
    static constexpr std::size_t size = 327680; // 2048 points for each crossing: the error is 1e-7
    double width_;
    std::vector<double> table_;
};

wave_samples resample_loop(const std::vector<float>& in, std::size_t size)
{
    wave_samples out(size);
    const auto m = static_cast<std::int64_t>(in.size());
    const double step = static_cast<double>(in.size()) / static_cast<double>(out.size());
    // The window's transition, a twentieth of the band, ends at half of the lower rate.
    const kernel k(0.5 * (1.0 - 0.025) * std::min(1.0, 1.0 / step));
    const auto reach = static_cast<std::int64_t>(std::ceil(k.width()));
    // around[j] is sample j - reach of the loop.
    std::vector<float> around(in.size() + 2 * static_cast<std::size_t>(reach) + 2);
    for (std::size_t j = 0; j < around.size(); ++j)
        around[j] = in[static_cast<std::size_t>(((static_cast<std::int64_t>(j) - reach) % m + m) % m)];
    for (std::size_t n = 0; n < out.size(); ++n) {
        const double place = static_cast<double>(n) * step;
        const auto middle = static_cast<std::int64_t>(place);
        const float* x = around.data() + middle;
        const double first = place - static_cast<double>(middle - reach);
        double sum = 0.0;
        for (std::int64_t i = 0; i <= 2 * reach + 1; ++i)
            sum += static_cast<double>(x[i]) * k.at(first - static_cast<double>(i));
        out[n] = static_cast<float>(sum);
    }
    return out;
}

using complex = std::complex<double>;

complex unit(double turns)
{
    const sine_cosine v = sincos_turns(turns);
    return {v.cos, v.sin};
}

// Multiplies without the library's checks for infinities.
complex times(complex a, complex b)
{
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// Writes to `to` the Fourier sum of n elements: from[0], from[step], from[2 step] ...; n is a power of 2.
/// Combines the sum of the even elements and the sum of the odd elements (Cooley and Tukey 1965). `units[k]`
/// is exp(2 pi i k / size).
void add_up(const complex* from, std::size_t step, std::size_t n, const spectrum& units, complex* to)
{
    if (n == 1) {
        *to = *from;
        return;
    }
    const std::size_t half = n / 2;
    add_up(from, 2 * step, half, units, to);
    add_up(from + step, 2 * step, half, units, to + half);
    for (std::size_t k = 0; k < half; ++k) {
        const complex odd = times(units[k * step], to[half + k]);
        to[half + k] = to[k] - odd;
        to[k] += odd;
    }
}

/// Returns exp(sign pi i n^2 / m). Reduces n^2 as an integer, so that the angle is exact.
complex chirp(std::uint64_t n, std::uint64_t m, double sign)
{
    return unit(sign * static_cast<double>(n * n % (2 * m)) / static_cast<double>(2 * m));
}

/// Returns the first `count` coefficients c[k] = sum over n of x[n] exp(-2 pi i k n / size) / size. The
/// number of samples may be any: the sum is a convolution whose length may be a power of 2 (Bluestein 1970).
spectrum fourier_coefficients(std::span<const float> x, std::size_t count)
{
    const std::size_t m = x.size();
    const std::size_t n = std::bit_ceil(2 * m);
    spectrum a(n);
    spectrum b(n);
    for (std::size_t i = 0; i < m; ++i) {
        a[i] = static_cast<double>(x[i]) * chirp(i, m, -1.0);
        b[i] = chirp(i, m, 1.0);
        b[(n - i) % n] = b[i];
    }
    compute_fourier_sum(a);
    compute_fourier_sum(b);
    for (std::size_t i = 0; i < n; ++i)
        a[i] = times(a[i], b[i]);
    // The same sum gives the convolution backwards.
    compute_fourier_sum(a);
    spectrum c(count);
    const double scale = 1.0 / (static_cast<double>(n) * static_cast<double>(m));
    for (std::size_t k = 0; k < count; ++k)
        c[k] = scale * times(a[(n - k) % n], chirp(k, m, -1.0));
    return c;
}

/// Returns a table for read_cycle(): a square, triangle or sawtooth of harmonics 1 to `harmonics`, with a
/// peak of 1.
wave_samples make_shape_cycle(waveform_kind shape, std::size_t harmonics)
{
    spectrum x(count_cycle_points(harmonics));
    for (std::size_t h = 1; h <= harmonics; ++h)
        x[h] = {0.0, -harmonic_amplitude(shape, h)}; // the real part of -i exp(i a) is sin a
    wave_samples cycle = make_cycle(std::move(x));
    scale(cycle, cycle_peak(cycle));
    return cycle;
}

/// Returns one cycle of recorded samples, with at most `harmonics` harmonics, without its mean, and with a
/// peak of 1. Throws error (bad_input) if no signal remains.
wave_samples recorded_cycle(const recording& r, std::size_t harmonics)
{
    // The highest harmonic of an even number of samples has no phase, so it is dropped.
    const std::size_t own = std::max<std::size_t>((r.samples.size() - 1) / 2, 1);
    harmonics = std::min(harmonics, own);
    const spectrum c = fourier_coefficients(unit_samples(r), harmonics + 1);
    spectrum x(count_cycle_points(harmonics));
    std::copy(c.begin() + 1, c.end(), x.begin() + 1);
    wave_samples cycle = make_cycle(std::move(x));
    const double peak = cycle_peak(cycle);
    require_signal(peak, r);
    scale(cycle, peak);
    return cycle;
}

/// Returns noise between low_hz and high_hz that repeats after about 5 s. Its peak is 1.
wave_samples noise_loop(double low_hz, double high_hz, std::uint64_t seed, unsigned rate)
{
    const std::size_t frames = std::min(std::bit_ceil(std::size_t{4} * rate), std::size_t{1} << 20U);
    const double line = static_cast<double>(rate) / static_cast<double>(frames);
    const auto first = static_cast<std::size_t>(std::ceil(low_hz / line));
    const auto last = std::min(static_cast<std::size_t>(high_hz / line), frames / 2 - 1);
    spectrum x(frames);
    // So many lines of equal height and random phase are as good as Gaussian noise.
    for (std::size_t k = first; k <= last; ++k) {
        const sine_cosine v = sincos_turns(static_cast<double>(next_random(seed) >> 11U) * 0x1p-53);
        x[k] = {v.cos, v.sin};
    }
    compute_fourier_sum(x);
    wave_samples loop(frames);
    std::transform(x.begin(), x.end(), loop.begin(),
                   [](const std::complex<double>& v) { return static_cast<float>(v.real()); });
    scale(loop, find_peak(loop));
    return loop;
}

/// Returns a recording resampled to another rate, with the same duration. Its peak is 1, and its mean is
/// 0. Throws error (bad_input) if no signal remains.
wave_samples recorded_loop(const recording& r, unsigned rate)
{
    const double frames = static_cast<double>(r.samples.size()) * rate / r.rate_hz;
    wave_samples x = unit_samples(r);
    const std::size_t size = std::max<std::size_t>(static_cast<std::size_t>(std::llround(frames)), 2);
    if (x.size() != size)
        x = resample_loop(x, size);
    const double mean = std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
    for (float& v : x)
        v = static_cast<float>(static_cast<double>(v) - mean);
    const double peak = find_peak(x);
    require_signal(peak, r);
    scale(x, peak);
    return x;
}

/// Returns twice the mean square, but at least 1.
double wave_power(const wave_samples& x) noexcept
{
    const double sum = std::accumulate(x.begin(), x.end(), 0.0, [](double s, float v) {
        return s + static_cast<double>(v) * static_cast<double>(v);
    });
    return std::max(1.0, 2.0 * sum / static_cast<double>(x.size()));
}

/// Maximum number of harmonics of a cycle. In a slow cycle, higher harmonics are not felt.
constexpr std::size_t most_harmonics = 4096;

/// Maximum number of timbres that the strokes of a score share. Strokes with other timbres have their own.
constexpr std::size_t most_places = 64;

/// Maximum number of frames of a recording at the rate of the stream: 32 MB.
constexpr double most_loop_frames = 8388608.0;

/// Minimum distance between a modulation and a harmonic, Hz. A smaller distance gives a displacement that
/// stands still or changes slowly: it heats the actuator and presses on the skin, but is not felt as a
/// vibration.
constexpr double least_beat_hz = 5.0;

/// Minimum amplitude of a harmonic that counts, relative to the peak.
constexpr double least_harmonic = 0.01;

/// Returns the integral of the frequency between two points, cycles, as coefficients of u, u^2, ..., u^6.
std::array<double, 6> integrate(const carrier_point& from, const carrier_point& to)
{
    const double time_s = to.t_s - from.t_s;
    const std::array<double, 4>& b = from.bend;
    return {time_s * from.hz,
            time_s * (to.hz - from.hz + b[0]) / 2.0,
            time_s * (b[1] - b[0]) / 3.0,
            time_s * (b[2] - b[1]) / 4.0,
            time_s * (b[3] - b[2]) / 5.0,
            time_s * -b[3] / 6.0};
}

std::vector<course_part> make_course(const std::vector<carrier_point>& points, unsigned rate)
{
    std::vector<course_part> parts;
    double cycles = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const carrier_point& from = points[i];
        const carrier_point& to = points[std::min(i + 1, points.size() - 1)];
        const double frames = (to.t_s - from.t_s) * rate;
        const double change = frames > 0.0 ? (to.hz - from.hz) / rate / frames : 0.0;
        if (frames > 0.0 || i + 1 == points.size())
            parts.push_back({from.t_s * rate, cycles, from.hz / rate, 0.5 * change});
        if (frames > 0.0 && from.bend != carrier_point{}.bend) {
            parts.back().frames = frames;
            parts.back().bent = integrate(from, to);
            for (const double c : parts.back().bent)
                cycles += c;
        } else {
            cycles += 0.5 * (to.t_s - from.t_s) * (from.hz + to.hz);
        }
        cycles -= std::floor(cycles);
    }
    return parts;
}

/// Throws error for a course that no plan makes: times that do not ascend, and frequencies that cannot be
/// rendered, between its points, too. A plan from a file may have any numbers.
void check_course(const plan& p, unsigned rate)
{
    constexpr double latest_s = 1e6;
    constexpr double highest_speed = 1e9; // repetitions of a recording a second
    const double most_hz = p.wave.kind == waveform_kind::recording ? highest_speed : 0.5 * rate;
    double before_s = 0.0;
    for (std::size_t i = 0; i < p.course.size(); ++i) {
        const carrier_point& c = p.course[i];
        const double next_hz = p.course[std::min(i + 1, p.course.size() - 1)].hz;
        // Bent, the frequency is a polynomial of degree 5, which passes no limit unseen between so many
        // steps.
        const int steps = c.bend == carrier_point{}.bend ? 1 : 64;
        bool possible = c.t_s >= before_s && c.t_s <= latest_s && c.hz >= 0.0;
        for (int k = 0; k <= steps; ++k) {
            const double u = static_cast<double>(k) / steps;
            const double bent = c.bend[0] + u * (c.bend[1] + u * (c.bend[2] + u * c.bend[3]));
            const double hz = c.hz + u * (next_hz - c.hz) + u * (1.0 - u) * bent;
            possible = possible && std::abs(hz) < most_hz;
        }
        if (!possible)
            throw detail::bad_field(
                synth::carrier_field(p),
                fmt::format("point {} of its course cannot be rendered at a rate of {} Hz", i + 1, rate),
                fmt::format("use times in ascending order, and frequencies from 0 to below {} Hz", most_hz));
        before_s = c.t_s;
    }
}

/// Returns the lowest and the highest frequency of the carrier at the points of its profile.
std::pair<double, double> carrier_range(const plan& p)
{
    if (p.course.empty())
        return {p.carrier_hz, p.carrier_hz};
    const auto lower = [](const carrier_point& a, const carrier_point& b) { return a.hz < b.hz; };
    const auto [low, high] = std::minmax_element(p.course.begin(), p.course.end(), lower);
    return {low->hz, high->hz};
}

/// Throws error for a modulation at a harmonic of the carrier, or at a frequency that a harmonic of a varying
/// carrier passes.
void refuse_displacement(const timbre& t, const plan& p)
{
    const auto [low_hz, high_hz] = carrier_range(p);
    const std::size_t points = t.is_sine() ? 4 : t.samples->size() - cycle_margin;
    const double first = std::max(std::ceil((p.am.hz - least_beat_hz) / high_hz), 1.0);
    const double last = std::min(std::floor((p.am.hz + least_beat_hz) / low_hz), 0.5 * points - 1.0);
    if (!(first <= last))
        return;
    spectrum harmonics{0.0, 0.5};
    if (!t.is_sine())
        harmonics =
            fourier_coefficients(std::span(t.samples->data(), points), static_cast<std::size_t>(last) + 1);
    for (auto k = static_cast<std::size_t>(first); k <= static_cast<std::size_t>(last); ++k) {
        if (2.0 * std::abs(harmonics[k]) < least_harmonic)
            continue;
        const auto n = static_cast<double>(k);
        const std::string what = k == 1 ? "the carrier" : fmt::format("harmonic {} of the carrier", k);
        throw detail::bad_field("am",
                                p.course.empty()
                                    ? fmt::format("{} Hz is within {} Hz of {}, {} Hz: their product is a "
                                                  "slow displacement, not a vibration",
                                                  p.am.hz, least_beat_hz, what, n * p.carrier_hz)
                                    : fmt::format("{} passes {} Hz on its way from {} to {} Hz: there, their "
                                                  "product is a slow displacement, not a vibration",
                                                  what, p.am.hz, n * low_hz, n * high_hz),
                                "choose a rate farther from the carrier, such as 30 Hz");
    }
}

void check_length(double frames, const recording& r, unsigned rate)
{
    if (frames > most_loop_frames) {
        throw error(
            error_kind::bad_input, recording_name(r),
            fmt::format("it lasts {:.6g} s, which is too long at a rate of {} Hz", frames / rate, rate),
            fmt::format("give at most {:.6g} s", most_loop_frames / rate));
    }
}

void check_free_place(const char* what, double hz, double am_hz, unsigned rate)
{
    if (!(hz + am_hz < 0.5 * rate)) {
        throw detail::bad_field(what,
                                fmt::format("{}{} Hz cannot be rendered at a rate of {} Hz",
                                            am_hz > 0.0 ? "a modulated carrier of " : "", hz + am_hz, rate),
                                fmt::format("stay below {} Hz, half the rate", 0.5 * rate));
    }
}

/// Returns the number of a wave's harmonics below half the rate, sidebands included.
std::size_t count_harmonics(double hz, double am_hz, unsigned rate)
{
    const double partials = (0.5 * rate - am_hz) / hz;
    return static_cast<std::size_t>(
        std::clamp(std::ceil(partials) - 1.0, 1.0, static_cast<double>(most_cycle_samples)));
}

void fill_in(timbre& t, const plan& p, unsigned rate)
{
    const waveform& w = p.wave;
    const double am_hz = p.am.depth > 0.0 ? p.am.hz : 0.0;
    const bool timed = w.kind == waveform_kind::recording && w.texture == texture_kind::time;
    if (w.kind == waveform_kind::recording && w.recorded->source) {
        const vibration& v = *w.recorded->source;
        const actuator_numbers& a = v.actuator;
        const bool in_time = w.texture != texture_kind::length || p.course.empty();
        check_free_place("waveform", std::max({a.low_hz, a.high_hz, a.emphasis_low_hz, a.emphasis_high_hz}),
                         am_hz, rate);
        const double frames = std::ceil((in_time ? v.duration_s : p.total_s) * rate);
        check_length(frames, *w.recorded, rate);
        t.form = timbre::form_kind::loop;
        t.course.clear();
        t.samples = std::make_shared<const wave_samples>(
            vibration_loop(v, in_time ? std::vector<carrier_point>() : p.course,
                           static_cast<std::size_t>(std::max(frames, 2.0)), rate));
    } else if (w.kind == waveform_kind::noise) {
        check_free_place("waveform", w.high_hz, am_hz, rate);
        t.form = timbre::form_kind::loop;
        t.samples = std::make_shared<const wave_samples>(noise_loop(w.low_hz, w.high_hz, w.seed, rate));
    } else if (timed) {
        check_length(static_cast<double>(w.recorded->samples.size()) * rate / w.recorded->rate_hz,
                     *w.recorded, rate);
        t.form = timbre::form_kind::loop;
        t.samples = std::make_shared<const wave_samples>(recorded_loop(*w.recorded, rate));
    } else {
        const double high_hz = carrier_range(p).second;
        check_free_place(carrier_field(p), high_hz, am_hz, rate);
        if (w.kind == waveform_kind::sine)
            return;
        const std::size_t harmonics = count_harmonics(high_hz, am_hz, rate);
        t.form = timbre::form_kind::cycle;
        t.samples = std::make_shared<const wave_samples>(
            w.kind == waveform_kind::recording
                ? recorded_cycle(*w.recorded, harmonics)
                : make_shape_cycle(w.kind, std::min(harmonics, most_harmonics)));
    }
    t.power = wave_power(*t.samples);
}

bool have_same_sound(const plan& a, const plan& b)
{
    return a.carrier_hz == b.carrier_hz && a.am == b.am && a.course == b.course && a.wave == b.wave;
}

} // namespace

void compute_fourier_sum(spectrum& x)
{
    spectrum units(x.size() / 2);
    for (std::size_t k = 0; k < units.size(); ++k)
        units[k] = unit(static_cast<double>(k) / static_cast<double>(x.size()));
    const spectrum from = x;
    add_up(from.data(), 1, from.size(), units, x.data());
}

std::shared_ptr<const timbre> make_timbre(const plan& p, unsigned rate)
{
    validate(p.wave);
    validate(p.am);
    check_course(p, rate);
    const bool modulated = p.am.hz > 0.0 && p.am.depth > 0.0;
    if (p.wave.kind == waveform_kind::sine && !modulated && p.course.empty())
        return nullptr;
    auto t = std::make_shared<timbre>();
    t->cycles_per_frame = p.carrier_hz / rate;
    t->course = make_course(p.course, rate);
    if (modulated) {
        t->am_cycles_per_frame = p.am.hz / rate;
        t->am_depth = p.am.depth;
    }
    fill_in(*t, p, rate);
    const bool has_carrier =
        t->form != timbre::form_kind::loop &&
        !(p.wave.kind == waveform_kind::recording && p.wave.texture == texture_kind::length);
    if (modulated && has_carrier)
        refuse_displacement(*t, p);
    return t;
}

const char* carrier_field(const plan& p) noexcept
{
    return p.course.empty() || p.wave.kind == waveform_kind::recording ? "carrier_hz" : "carrier_profile";
}

bool crosses_zero(const plan& p) noexcept
{
    return p.course.empty() && p.wave.kind != waveform_kind::noise && p.wave.kind != waveform_kind::recording;
}

std::shared_ptr<const timbre> timbre_shelf::get(const plan& p, unsigned rate)
{
    for (const place& q : places_)
        if (have_same_sound(q.sound, p))
            return q.made;
    std::shared_ptr<const timbre> made = make_timbre(p, rate);
    if (made && places_.size() < most_places) {
        plan sound;
        sound.carrier_hz = p.carrier_hz;
        sound.wave = p.wave;
        sound.am = p.am;
        sound.course = p.course;
        places_.push_back({std::move(sound), made});
    }
    return made;
}

} // namespace tactor::synth
