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
    double peak = 0.0;  ///< what the voices could reach together
    bool spare = false; ///< no tactor: for markers
    bool sounding = false;
};

constexpr block ones = [] {
    block b{};
    b.fill(1.0);
    return b;
}();

} // namespace

struct mixer::impl {
    impl(std::span<const double> limits, sample_format f, std::size_t capacity, const guard_settings& g)
        : format(f),
          strips(limits.size()),
          voices(capacity),
          power(g.power, g.rate),
          duty(limits.size(), g.drive_frames, g.window_frames, g.rate)
    {
        std::transform(limits.begin(), limits.end(), strips.begin(), [](double l) {
            strip s;
            s.limit = clean_limit(l);
            s.spare = s.limit == 0.0;
            return s;
        });
        sounding.reserve(strips.size());
        powered.reserve(strips.size());
        frame_bytes = strips.size() * bytes_of(format);
    }

    void segment(unsigned n, std::byte* out) noexcept;
    void mix(const voice& v, unsigned n) noexcept;
    void guard(unsigned n) noexcept;
    void write(unsigned n, std::byte* out) noexcept;
    bool plays(const voice& v) const noexcept;
    void end_fades() noexcept;

    sample_format format;
    std::size_t frame_bytes = 0;
    std::vector<strip> strips;
    std::vector<std::uint32_t> sounding;
    schedule voices;
    fades fading;
    carrier_block carrier;
    power_guard power;
    drive_guard duty;
    std::vector<double*> powered; ///< sums that the power guard looks at
    std::uint64_t clock = 0;      ///< frames since the construction
    std::uint64_t position = 0;
    std::uint64_t limited = 0;
    std::uint64_t power_limited = 0;
};

mixer::mixer(std::span<const double> limits, sample_format format, std::size_t capacity,
             const guard_settings& guards)
    : impl_(std::make_unique<impl>(limits, format, capacity, guards))
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

std::uint64_t mixer::power_limited() const noexcept
{
    return impl_->power_limited;
}

std::uint64_t mixer::drives_cut() const noexcept
{
    return impl_->duty.cuts();
}

// A constant would push a tactor off its place for as long as it lasts.
bool mixer::impl::plays(const voice& v) const noexcept
{
    const bool marker = v.cycles_per_frame == 0.0;
    return !marker || std::all_of(v.drive.begin(), v.drive.begin() + v.drives,
                                  [&](const voice_drive& d) { return strips[d.channel].spare; });
}

bool mixer::add(const drive_event& e) noexcept
{
    impl& m = *impl_;
    const voice v = make_voice(e, m.strips.size());
    if (v.drives == 0 || v.end <= m.position || m.fading.find(e.score) != fades::none || !m.plays(v)) {
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
            m.clock += silent;
            m.power.silence(silent);
        } else {
            const auto n = static_cast<unsigned>(
                std::min<std::uint64_t>({block_frames, frames, m.duty.longest_block(m.clock)}));
            m.segment(n, out);
            out += n * m.frame_bytes;
            frames -= n;
            m.position += n;
            m.clock += n;
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
    guard(n);
    write(n, out);
}

void mixer::impl::mix(const voice& v, unsigned n) noexcept
{
    const auto from = static_cast<unsigned>(std::max(v.start, position) - position);
    const auto to = static_cast<unsigned>(std::min(v.end, position + n) - position);
    const double* s = v.cycles_per_frame == 0.0
                          ? ones.data()
                          : carrier.get(v, v.fade == fades::none ? nullptr : &fading[v.fade], position, n);
    const auto k = static_cast<double>(static_cast<std::int64_t>(position - v.start));
    for (std::uint32_t i = 0; i < v.drives; ++i) {
        const voice_drive& d = v.drive[i];
        strip& t = strips[d.channel];
        if (t.spare && v.cycles_per_frame != 0.0) {
            limited += to - from; // there is no tactor that it could be meant for
            continue;
        }
        if (duty.on() && d.peak >= least_counted_drive && !t.spare) {
            duty.drive(d.channel, clock + from, clock + to);
        }
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

void mixer::impl::guard(unsigned n) noexcept
{
    double most = 0.0; // sum of squares
    powered.clear();
    for (const std::uint32_t c : sounding) {
        strip& t = strips[c];
        if (t.spare) {
            limit_block(t.sum.data(), n, 1.0); // two markers at once are one
            continue;
        }
        if (!within_limit(t.peak, t.limit)) {
            limited += limit_block(t.sum.data(), n, t.limit);
        }
        if (duty.on()) {
            duty.apply(c, clock, n, t.sum.data());
        }
        const double peak = t.peak < t.limit ? t.peak : t.limit;
        most += peak * peak;
        powered.push_back(t.sum.data());
    }
    if (!power.passes(most)) {
        power_limited += power.apply(powered, n);
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

} // namespace tactor::synth
