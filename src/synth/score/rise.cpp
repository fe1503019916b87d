// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <iterator>

#include "synth/mix/window.hpp"
#include "synth/score/frames.hpp"
#include "synth/score/levels.hpp"

namespace tactor::synth {

namespace {

/// Time constants after which an actuator has its strength, but for 0.7 %.
constexpr double enough_rises = 5.0;
/// Least amplitude of an added burst, of full scale (-100 dB).
constexpr double least_boost = 1e-5;

/// Returns what a window adds to a lag in frames from ... to - 1, at frame `to`.
double window_share(const burst_window& w, std::uint64_t from, std::uint64_t to, double rise)
{
    const double decay = std::exp(-1.0 / rise);
    double y = 0.0;
    for (std::uint64_t k = from; k < to; ++k)
        y = decay * y + (1.0 - decay) * window_at(static_cast<std::int64_t>(k), w);
    return y;
}

/// Strength that an actuator reaches in a burst, by the model of a first-order lag: 1 - e^(-t / rise_s) of a
/// steady vibration after t.
class lag {
public:
    /// Prepares for bursts that rise in `attack` frames and fall in `release`; `rise` in frames, above 0.
    lag(double rise, std::uint32_t attack, std::uint32_t release, envelope_kind shape)
        : rise_(rise), attack_(attack), release_(release)
    {
        const burst_window w{std::uint64_t{attack} + release, attack, release, shape};
        after_attack_ = window_share(w, 0, attack, rise);
        of_release_ = window_share(w, attack, w.length, rise);
    }

    /// Returns the part of a strength that is left after so many frames.
    double decay(double frames) const noexcept { return std::exp(-frames / rise_); }
    /// Returns the strength reached `frames` after the burst's begin, if strength 1 is asked for; not for
    /// times before the end of its attack.
    double risen(double frames) const noexcept
    {
        return 1.0 - (1.0 - after_attack_) * decay(frames - attack_);
    }
    /// Returns the same at the end of a burst of so many frames, after its release.
    double fallen(double frames) const noexcept
    {
        return risen(frames - release_) * decay(release_) + of_release_;
    }

private:
    double rise_;
    double attack_;
    double release_;
    double after_attack_;
    double of_release_; ///< what the release itself adds
};

/// State of a tactor after its latest drive.
struct motion {
    std::uint64_t until = 0; ///< end of the drive
    double strength = 0.0;   ///< of the actuator at that time, as an amplitude of drives
};

/// A boost: how long and how strong, in amplitudes of drives.
struct boost {
    std::uint64_t length = 0;
    double amplitude = 0.0;
};

class booster {
public:
    booster(score::impl& s, const array& a, const std::vector<double>& peaks)
        : s_(s), a_(a), peaks_(peaks), motions_(a.tactors.size())
    {
    }

    void run()
    {
        std::vector<item> more;
        for (const item& it : s_.list.items) {
            switch (it.kind) {
            case item_kind::burst:
                for (std::uint64_t k = it.first; k < it.first + it.count; ++k)
                    take_burst(it, s_.list.drive_tactors[k], s_.list.drive_amplitudes[k], more);
                break;
            case item_kind::joined:
                note(motions_[it.tactor], it.end(), s_.list.members[it.first].intensity);
                break;
            case item_kind::continuous:
                for (motion& m : motions_)
                    note(m, it.end(), 1.0);
                break;
            case item_kind::marker:
                break;
            }
        }
        std::copy(more.begin(), more.end(), std::back_inserter(s_.list.items));
    }

private:
    static void note(motion& m, std::uint64_t end, double strength)
    {
        m.strength = strength;
        m.until = std::max(m.until, end);
    }

    void take_burst(const item& it, std::size_t tactor, double amplitude, std::vector<item>& more)
    {
        motion& m = motions_[tactor];
        const auto rise_s = a_.tactors[tactor].rise_s;
        // Rounding may put the end of a burst into the first frame of the next, which it touches.
        if (!rise_s || it.start + 1 < m.until) {
            note(m, it.end(), amplitude);
            return;
        }
        const std::uint32_t release = release_frames(s_.envelope, s_.rate, it.length, it.ramp);
        const lag l(*rise_s * s_.rate, it.ramp, release, s_.envelope.kind);
        const std::uint64_t pause = it.start - std::min(m.until, it.start);
        const double before = m.strength * l.decay(static_cast<double>(pause));
        const double unit = std::abs(s_.tactors[tactor].gain) * s_.equalised(tactor, it.plan, it.start);
        const double headroom = (tactor_limit(a_, tactor) * (1.0 - 2e-9) - peaks_[tactor]) / unit;
        const boost b = find_boost(it, l, release, amplitude, before, headroom, *rise_s);
        if (b.amplitude * unit > least_boost)
            add(it, tactor, b, more);
        const auto length = static_cast<double>(it.length);
        m.strength = before * l.decay(length) + amplitude * l.fallen(length) +
                     b.amplitude * l.fallen(static_cast<double>(b.length)) *
                         l.decay(length - static_cast<double>(b.length));
        m.until = it.end();
    }

    /// Returns the shortest burst of whole half cycles that is enough, or the longest that fits.
    boost find_boost(const item& it, const lag& l, std::uint32_t release, double amplitude, double before,
                     double headroom, double rise_s) const
    {
        if (!(headroom > 0.0 && amplitude > before))
            return {};
        const double half_cycle = 0.5 * s_.rate / s_.plans[it.plan].plan.carrier_hz;
        const double longest = std::min(static_cast<double>(it.length), enough_rises * rise_s * s_.rate);
        const double shortest = std::max(1.0, static_cast<double>(it.ramp) + release);
        const auto first = static_cast<std::uint64_t>(std::ceil(shortest / half_cycle));
        const auto last = static_cast<std::uint64_t>(longest / half_cycle);
        if (last < std::max<std::uint64_t>(first, 1))
            return {};
        const auto needed = [&](std::uint64_t half_cycles) -> boost {
            const std::uint64_t frames = frame_at(static_cast<double>(half_cycles) * half_cycle, 1.0);
            const auto t = static_cast<double>(frames);
            const double missing = amplitude * (1.0 - l.risen(t)) - before * l.decay(t);
            return {frames, std::max(missing, 0.0) / l.fallen(t)};
        };
        std::uint64_t low = std::max<std::uint64_t>(first, 1);
        for (std::uint64_t high = last; low < high;) {
            const std::uint64_t middle = low + (high - low) / 2;
            if (needed(middle).amplitude <= headroom)
                high = middle;
            else
                low = middle + 1;
        }
        boost b = needed(low);
        b.amplitude = std::min(b.amplitude, headroom);
        return b;
    }

    void add(const item& it, std::size_t tactor, const boost& b, std::vector<item>& more)
    {
        item over = it;
        over.length = std::min(b.length, it.length);
        over.first = s_.list.drive_tactors.size();
        over.count = 1;
        s_.list.drive_tactors.push_back(static_cast<std::uint16_t>(tactor));
        s_.list.drive_amplitudes.push_back(b.amplitude);
        more.push_back(over);
    }

    score::impl& s_;
    const array& a_;
    const std::vector<double>& peaks_;
    std::vector<motion> motions_; ///< by tactor
};

} // namespace

bool boost_rises(score::impl& s, const array& a, const std::vector<double>& peaks)
{
    const auto rises = [](const tactor_spec& t) { return t.rise_s.has_value(); };
    if (std::none_of(a.tactors.begin(), a.tactors.end(), rises))
        return false;
    const std::size_t before = s.list.items.size();
    booster(s, a, peaks).run();
    return s.list.items.size() > before;
}

} // namespace tactor::synth
