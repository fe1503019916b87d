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
    impl_->let_go();
    return impl_->voices.available();
}

std::size_t mixer::size() const noexcept
{
    impl_->let_go();
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

// Returns false for a constant on a tactor's channel, which would displace the tactor as long as it lasts.
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
    m.let_go();
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
    if (m.leaving.size() == m.leaving.capacity())
        m.let_go();
    if (fade == 0) {
        m.leaving.push_back({score, fades::none});
        return true;
    }
    if (m.fading.find(score) != fades::none)
        return true;
    std::int32_t i = m.fading.begin(score, m.position, fade);
    if (i == fades::none && !m.leaving.empty()) {
        m.let_go(); // a cut may end a fade
        i = m.fading.begin(score, m.position, fade);
    }
    if (i == fades::none)
        return false;
    m.leaving.push_back({score, i});
    return true;
}

bool mixer::set_gain(std::uint32_t score, double gain, std::uint32_t ramp) noexcept
{
    return impl_->gains.set(score, gain, impl_->position, ramp);
}

void mixer::forget_gain(std::uint32_t score) noexcept
{
    impl_->gains.forget(score);
}

// Removes all scores that leave in one pass over the voices: a stop may end hundreds.
void mixer::impl::let_go() noexcept
{
    if (leaving.empty())
        return;
    std::sort(leaving.begin(), leaving.end()); // a cut comes before a fade of the same score
    voices.forget_if([this](voice& v) {
        const auto l = std::lower_bound(leaving.begin(), leaving.end(), leaver{v.score, fades::none});
        if (l == leaving.end() || l->score != v.score)
            return false;
        v.fade = l->fade;
        return l->fade == fades::none || v.start >= fading[l->fade].end();
    });
    for (const leaver& l : leaving) {
        const std::int32_t cut = l.fade == fades::none ? fading.find(l.score) : fades::none;
        if (cut != fades::none)
            fading.end(cut);
    }
    leaving.clear();
}

std::uint64_t mixer::driven(std::size_t channel) const noexcept
{
    return impl_->duty.driven(channel);
}

void mixer::resume(std::span<const double> levels_s) noexcept
{
    impl_->duty.resume(levels_s);
}

void mixer::cut() noexcept
{
    impl_->power.silence(0);
    impl_->voices.clear();
    impl_->fading.clear();
    impl_->leaving.clear();
    impl_->carrier.forget();
    impl_->gains.settle();
}

void mixer::reset() noexcept
{
    cut();
    impl_->position = 0;
}

void mixer::process(std::size_t frames, std::byte* out) noexcept
{
    impl& m = *impl_;
    m.let_go();
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
    if (!fading.any_ended(position))
        return;
    voices.forget_if(
        [this](const voice& v) { return v.fade != fades::none && fading[v.fade].end() <= position; });
    fading.end_all(position);
}

} // namespace tactor::synth
