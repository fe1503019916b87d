// SPDX-License-Identifier: MIT
#include "synth/mixer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "synth/carrier.hpp"
#include "synth/converter.hpp"
#include "synth/fades.hpp"
#include "synth/limiter.hpp"
#include "synth/voice.hpp"

namespace tactor::synth {

namespace {

/// One channel's sum in the current block.
struct strip {
    alignas(64) block sum;
    double limit = 0.0;
    double peak = 0.0; ///< what the voices could reach together
    bool sounding = false;
};

/// The limit as given, but nothing outside 0 ... 1.
double clean_limit(double l) noexcept
{
    return l > 0.0 ? std::min(l, 1.0) : 0.0;
}

} // namespace

struct mixer::impl {
    impl(std::span<const double> limits, sample_format f, std::size_t capacity)
        : format(f), strips(limits.size()), voices(capacity)
    {
        std::transform(limits.begin(), limits.end(), strips.begin(), [](double l) {
            strip s;
            s.limit = clean_limit(l);
            return s;
        });
        sounding.reserve(strips.size());
        frame_bytes = strips.size() * bytes_of(format);
    }

    void segment(unsigned n, std::byte* out) noexcept;
    void mix(const voice& v, unsigned n) noexcept;
    void write(unsigned n, std::byte* out) noexcept;
    void end_fades() noexcept;

    sample_format format;
    std::size_t frame_bytes = 0;
    std::vector<strip> strips;
    std::vector<std::uint32_t> sounding;
    schedule voices;
    fades fading;
    carrier_block carrier;
    std::uint64_t position = 0;
    std::uint64_t limited = 0;
};

mixer::mixer(std::span<const double> limits, sample_format format, std::size_t capacity)
    : impl_(std::make_unique<impl>(limits, format, capacity))
{
}

mixer::~mixer() = default;

std::size_t mixer::channels() const noexcept
{
    return impl_->strips.size();
}

std::size_t mixer::room() const noexcept
{
    return impl_->voices.room();
}

std::size_t mixer::size() const noexcept
{
    return impl_->voices.size();
}

std::uint64_t mixer::position() const noexcept
{
    return impl_->position;
}

std::uint64_t mixer::limited() const noexcept
{
    return impl_->limited;
}

bool mixer::add(const drive_event& e) noexcept
{
    impl& m = *impl_;
    const voice v = make_voice(e, m.strips.size());
    if (v.drives == 0 || v.end <= m.position || m.fading.find(e.score) != fades::none) {
        return true;
    }
    if (m.voices.room() == 0) {
        return false;
    }
    m.voices.add(v);
    return true;
}

bool mixer::fade_out(std::uint32_t score, std::uint32_t fade) noexcept
{
    impl& m = *impl_;
    std::int32_t i = m.fading.find(score);
    if (fade == 0) {
        if (i != fades::none) {
            m.fading.end(i);
        }
        m.voices.forget_if([score](const voice& v) { return v.score == score; });
        return true;
    }
    if (i != fades::none) {
        return true;
    }
    i = m.fading.begin(score, m.position, fade);
    if (i == fades::none) {
        return false;
    }
    m.voices.forget_if([&m, score, i](voice& v) {
        if (v.score != score) {
            return false;
        }
        v.fade = i;
        return v.start >= m.fading[i].end();
    });
    return true;
}

void mixer::reset() noexcept
{
    impl_->voices.clear();
    impl_->fading.clear();
    impl_->carrier.forget();
    impl_->position = 0;
}

void mixer::process(std::size_t frames, std::byte* out) noexcept
{
    impl& m = *impl_;
    while (frames > 0) {
        const std::uint64_t until_next = m.voices.next_start() - std::min(m.position, m.voices.next_start());
        if (m.voices.active().empty() && until_next > 0) {
            const std::size_t silent = static_cast<std::size_t>(std::min<std::uint64_t>(frames, until_next));
            std::memset(out, 0, silent * m.frame_bytes);
            out += silent * m.frame_bytes;
            frames -= silent;
            m.position += silent;
        } else {
            const auto n = static_cast<unsigned>(std::min<std::size_t>(block_frames, frames));
            m.segment(n, out);
            out += n * m.frame_bytes;
            frames -= n;
            m.position += n;
            m.voices.retire(m.position);
        }
        m.end_fades();
    }
}

void mixer::impl::segment(unsigned n, std::byte* out) noexcept
{
    voices.activate(position + n);
    for (const std::uint32_t slot : voices.active()) {
        mix(voices[slot], n);
    }
    write(n, out);
}

void mixer::impl::mix(const voice& v, unsigned n) noexcept
{
    const auto from = static_cast<unsigned>(std::max(v.start, position) - position);
    const auto to = static_cast<unsigned>(std::min(v.end, position + n) - position);
    const double* s = carrier.get(v, v.fade == fades::none ? nullptr : &fading[v.fade], position, n);
    const auto k = static_cast<double>(static_cast<std::int64_t>(position - v.start));
    for (std::uint32_t i = 0; i < v.drives; ++i) {
        const voice_drive& d = v.drive[i];
        strip& t = strips[d.channel];
        if (!t.sounding) {
            t.sounding = true;
            t.peak = d.peak;
            sounding.push_back(d.channel);
            if (d.slope == 0.0 && to - from == n) {
                set_constant(s, d.from, 0, n, t.sum.data());
                continue;
            }
            std::fill_n(t.sum.begin(), n, 0.0);
        } else {
            t.peak += d.peak;
        }
        if (d.slope == 0.0) {
            add_constant(s, d.from, from, to, t.sum.data());
        } else {
            add_line(s, d.from, d.slope, k, from, to, t.sum.data());
        }
    }
}

void mixer::impl::write(unsigned n, std::byte* out) noexcept
{
    if (sounding.size() < strips.size()) {
        std::memset(out, 0, n * frame_bytes);
    }
    const std::size_t sample = bytes_of(format);
    for (const std::uint32_t c : sounding) {
        strip& t = strips[c];
        if (!within_limit(t.peak, t.limit)) {
            limited += limit_block(t.sum.data(), n, t.limit);
        }
        convert(format, t.sum.data(), n, out + c * sample, frame_bytes);
        t.sounding = false;
    }
    sounding.clear();
}

void mixer::impl::end_fades() noexcept
{
    for (std::int32_t i = fading.ended(position); i != fades::none; i = fading.ended(position)) {
        voices.forget_if([i](const voice& v) { return v.fade == i; });
        fading.end(i);
    }
}

std::vector<double> channel_limits(const array& a, unsigned channels)
{
    std::vector<double> limits(channels, 0.0);
    for (const tactor_spec& t : a.tactors) {
        if (t.channel < channels) {
            limits[t.channel] = clean_limit(std::pow(10.0, t.max_dbfs / 20.0));
        }
    }
    return limits;
}

} // namespace tactor::synth
