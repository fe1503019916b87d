// SPDX-License-Identifier: MIT
#include "synth/tone/own_samples.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "core/refused.hpp"

namespace tactor::synth {
namespace {

static_assert(std::endian::native == std::endian::little, "the formats are little-endian");

/// Number of stretches in a second. The envelope is held over three of them, which contain half a cycle of 17
/// Hz.
constexpr std::size_t stretches_per_s = 100;

template <class T>
T load(const std::byte* at) noexcept
{
    T v;
    std::memcpy(&v, at, sizeof v);
    return v;
}

/// Returns an integer whose three upper bytes are read from `at`.
std::int32_t load_three_bytes(const std::byte* at) noexcept
{
    std::uint32_t v = 0;
    std::memcpy(&v, at, 3);
    return static_cast<std::int32_t>(v << 8U);
}

/// Calls visit(value), where value(address) reads a sample of this format; full scale is 1.
template <class Visit>
void visit_format(format_kind f, Visit visit)
{
    switch (f) {
    case format_kind::float32:
        return visit([](const std::byte* at) { return static_cast<double>(load<float>(at)); });
    case format_kind::s16:
        return visit([](const std::byte* at) { return load<std::int16_t>(at) * 0x1p-15; });
    case format_kind::s24_3:
    case format_kind::s24_4: // the fourth byte is ignored
        return visit([](const std::byte* at) { return load_three_bytes(at) * 0x1p-31; });
    case format_kind::s32:
        return visit([](const std::byte* at) { return load<std::int32_t>(at) * 0x1p-31; });
    }
}

/// Peak and sum of squares of a stretch of a channel.
struct stretch_sums {
    double peak = 0.0;
    double squares = 0.0;
};

/// Ends a stretch of all channels. The envelope of a stretch is the greater of its peak and the amplitude of
/// a sine with the same mean square.
void end_stretch(std::vector<stretch_sums>& sums, std::size_t frames, std::vector<own_channel>& channels)
{
    for (std::size_t c = 0; frames > 0 && c < channels.size(); ++c) {
        const auto [peak, squares] = sums[c];
        channels[c].peak = std::max(channels[c].peak, peak);
        channels[c].squares.push_back(std::max(peak * peak, 2.0 * squares / static_cast<double>(frames)));
        sums[c] = {};
    }
}

/// Computes the unit, the envelope and the power from the peak and the stretches.
void complete(own_channel& c)
{
    int exponent = 0;
    if (c.peak > 0.0)
        c.unit = std::ldexp(1.0, std::frexp(c.peak, &exponent) == 0.5 ? exponent - 1 : exponent);
    const std::vector<double> alone = c.squares;
    double most = 0.0;
    for (std::size_t i = 0; i < alone.size(); ++i) {
        const double held = std::max(
            {alone[i - std::min<std::size_t>(i, 1)], alone[i], alone[std::min(i + 1, alone.size() - 1)]});
        c.squares[i] = held / c.unit / c.unit;
        most = std::max(most, held);
    }
    if (c.peak > 0.0)
        c.power = std::max(1.0, most / c.peak / c.peak);
}

} // namespace

void own_channel::read(std::int64_t first, unsigned n, double* out) const noexcept
{
    const std::size_t sample = sample_bytes(all->format);
    const std::size_t frame = all->channels * sample;
    const auto frames = static_cast<std::int64_t>(count_frames(*all));
    const std::int64_t from = std::clamp<std::int64_t>(-first, 0, n);
    const std::int64_t to = std::clamp<std::int64_t>(frames - first, from, n);
    std::fill(out, out + from, 0.0);
    std::fill(out + to, out + n, 0.0);
    if (from == to)
        return;
    const std::byte* at =
        all->bytes.data() + static_cast<std::size_t>(first + from) * frame + channel * sample;
    const double scale = 1.0 / unit;
    visit_format(all->format, [&](auto value) {
        for (std::int64_t j = from; j < to; ++j, at += frame)
            out[j] = scale * value(at);
    });
}

void own_channel::complete_envelope(std::int64_t first, unsigned n, double* x) const noexcept
{
    for (unsigned j = 0; j < n;) {
        const std::int64_t at = first + j;
        const std::size_t i = static_cast<std::size_t>(std::max<std::int64_t>(at, 0)) / step;
        const std::int64_t end = at < 0 ? 0 : static_cast<std::int64_t>((i + 1) * step);
        const double square = at < 0 || i >= squares.size() ? 0.0 : squares[i];
        for (; j < n && first + j < end; ++j)
            x[j] = std::sqrt(std::max(square - x[j] * x[j], 0.0));
    }
}

double own_channel::envelope(std::uint64_t frame) const noexcept
{
    const std::uint64_t i = frame / step;
    return i < squares.size() ? std::sqrt(squares[static_cast<std::size_t>(i)]) : 0.0;
}

std::uint64_t count_frames(const own_samples& s) noexcept
{
    return s.bytes.size() / (s.channels * sample_bytes(s.format));
}

double half_step(format_kind f) noexcept
{
    return f == format_kind::float32 ? 0.0
           : f == format_kind::s16   ? 0x1p-16
           : f == format_kind::s32   ? 0x1p-32
                                     : 0x1p-24;
}

std::vector<own_channel> read_channels(const std::shared_ptr<const own_samples>& all)
{
    std::vector<own_channel> channels(all->channels);
    for (unsigned c = 0; c < all->channels; ++c) {
        channels[c].all = all;
        channels[c].channel = c;
        channels[c].step = std::max<std::size_t>(1, all->rate / stretches_per_s);
    }
    const std::size_t sample = sample_bytes(all->format);
    const std::uint64_t frames = count_frames(*all);
    std::vector<stretch_sums> sums(all->channels);
    visit_format(all->format, [&](auto value) {
        const std::byte* at = all->bytes.data();
        std::size_t done = 0; // frames of the stretch
        for (std::uint64_t k = 0; k < frames; ++k) {
            for (stretch_sums& s : sums) {
                const double v = value(at);
                if (!std::isfinite(v))
                    throw bad_samples(*all,
                                      fmt::format("channel {} is {} at frame {}", &s - sums.data(), v, k),
                                      "give finite samples");
                s.peak = std::max(s.peak, std::abs(v));
                s.squares += v * v;
                at += sample;
            }
            if (++done == channels.front().step) {
                end_stretch(sums, done, channels);
                done = 0;
            }
        }
        end_stretch(sums, done, channels);
    });
    std::for_each(channels.begin(), channels.end(), complete);
    return channels;
}

error bad_samples(const own_samples& s, std::string_view why, std::string_view hint)
{
    return s.file.empty() ? detail::bad_field("samples", why, hint)
                          : error(error_kind::bad_input, source_place{s.file}, why, hint);
}

} // namespace tactor::synth
