// SPDX-License-Identifier: MIT
#include "synth/mix/mixer.hpp"

#include <algorithm>
#include <cstring>

#include "synth/mix/mixer_impl.hpp"

namespace tactor::synth {

mixer::mixer(std::span<const double> limits, format_kind format, std::size_t capacity,
             const guard_settings& guards)
    : impl_(std::make_unique<impl>(limits, format, capacity, guards))
{
}

mixer::~mixer() = default;

std::size_t mixer::channels() const noexcept
{
    return impl_->strips.size();
}

std::size_t mixer::available() const noexcept
{
    return impl_->voices.available();
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
    bool only_spare = true;
    if (v.cycles_per_frame == 0.0)
        each_channel(v, [&](std::uint32_t c) { only_spare = only_spare && strips[c].spare; });
    return only_spare;
}

bool mixer::add(const drive_event& e) noexcept
{
    impl& m = *impl_;
    const voice v = make_voice(e, m.strips.size());
    if ((v.drives == 0 && v.points == 0) || v.end <= m.position || m.fading.find(e.score) != fades::none ||
        !m.plays(v))
        return true;
    if (m.voices.available() == 0)
        return false;
    m.voices.add(v);
    return true;
}

bool mixer::fade_out(std::uint32_t score, std::uint32_t fade) noexcept
{
    impl& m = *impl_;
    std::int32_t i = m.fading.find(score);
    if (fade == 0) {
        if (i != fades::none)
            m.fading.end(i);
        m.voices.forget_if([score](const voice& v) { return v.score == score; });
        return true;
    }
    if (i != fades::none)
        return true;
    i = m.fading.begin(score, m.position, fade);
    if (i == fades::none)
        return false;
    m.voices.forget_if([&m, score, i](voice& v) {
        if (v.score != score)
            return false;
        v.fade = i;
        return v.start >= m.fading[i].end();
    });
    return true;
}

drive_history mixer::history() const
{
    return impl_->duty.history(impl_->clock);
}

void mixer::resume(const drive_history& h) noexcept
{
    impl_->duty.resume(h);
}

void mixer::reset() noexcept
{
    impl_->power.silence(0);
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
                std::min<std::uint64_t>({block_frames, frames, m.duty.longest_block()}));
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

void mixer::impl::end_fades() noexcept
{
    for (std::int32_t i = fading.ended(position); i != fades::none; i = fading.ended(position)) {
        voices.forget_if([i](const voice& v) { return v.fade == i; });
        fading.end(i);
    }
}

} // namespace tactor::synth
