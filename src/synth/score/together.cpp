// SPDX-License-Identifier: MIT
#include "synth/score/together.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include "core/access.hpp"
#include "plan/curve_impl.hpp"
#include "synth/score/event_source.hpp"
#include "synth/wave/window.hpp"

namespace tactor::synth {
namespace {

/// Minimum number of parts into which a ramp is divided for sampling. The error is below a millionth of a
/// peak.
constexpr std::uint32_t ramp_parts = 1024;
constexpr double same_peak = 1e-9; // relative difference of peaks that count as equal

bool starts_at_zero(const waveform& w) noexcept
{
    return w.kind != waveform_kind::noise && w.kind != waveform_kind::recording;
}

void raise_peak(tactor_peak& peak, double to, std::uint64_t at) noexcept
{
    if (to > peak.level * (1.0 + same_peak))
        peak.frame = at;
    peak.level = std::max(peak.level, to);
}

/// Walk over the events of a score that finds the peak of each tactor.
class envelope_walk {
public:
    explicit envelope_walk(const std::shared_ptr<const score::impl>& s)
        : score_(*s),
          source_(detail::access::make<score>(std::shared_ptr<const score::impl>(s))),
          peaks_(score_.tactors.size()),
          driven_(score_.tactors.size())
    {
        std::uint32_t channels = score_.channels;
        for (const tactor_level& t : score_.tactors)
            channels = std::max(channels, t.channel + 1);
        tactors_.resize(channels);
        for (std::size_t i = 0; i < score_.tactors.size(); ++i)
            tactors_[score_.tactors[i].channel] = i;
        for (std::size_t i = 0; i < score_.plans.size(); ++i)
            if (!starts_at_zero(score_.plans[i].plan.wave))
                rough_.push_back(score_.sounds[i].get());
        std::sort(rough_.begin(), rough_.end());
    }

    std::vector<tactor_peak> run()
    {
        const drive_event* next = source_.peek();
        for (std::uint64_t now = 0; next != nullptr || !open_.empty();) {
            if (open_.empty())
                now = next->start;
            for (; next != nullptr && next->start <= now; next = source_.peek()) {
                open_.push_back({*next, begins_at_zero(*next)});
                source_.pop();
            }
            std::uint64_t end = next != nullptr ? next->start : std::numeric_limits<std::uint64_t>::max();
            for (const open_event& e : open_)
                end = std::min(end, e.next_bend(now));
            sample_frames(now, end);
            now = end;
            std::erase_if(open_, [now](const open_event& e) { return e.end() <= now; });
        }
        return std::move(peaks_);
    }

private:
    struct open_event {
        drive_event event;
        bool begins_at_zero; ///< the first frame is silent

        std::uint64_t end() const noexcept { return event.start + event.length; }
        burst_window window() const noexcept
        {
            return {event.window, event.ramp, event.release == as_ramp ? event.ramp : event.release,
                    event.shape};
        }
        std::int64_t place(std::uint64_t frame) const noexcept
        {
            return static_cast<std::int64_t>(event.ramp_position + (frame - event.start));
        }
        /// Returns the next frame after `at` at which the slope of the amplitude or the form of the window
        /// changes.
        std::uint64_t next_bend(std::uint64_t at) const noexcept
        {
            std::uint64_t next = end();
            const auto bend = [&](std::uint64_t frame) {
                if (frame > at)
                    next = std::min(next, frame);
            };
            if (begins_at_zero)
                bend(event.start + 1);
            const burst_window w = window();
            for (const std::uint64_t edge : {std::uint64_t{w.attack}, w.length - w.release})
                if (edge > event.ramp_position)
                    bend(event.start + (edge - event.ramp_position));
            for (std::uint32_t i = 0; i < event.points; ++i)
                bend(event.start + event.line.frame[i]);
            return next;
        }
        double level(std::uint32_t part, std::uint64_t frame) const noexcept
        {
            const auto t = static_cast<double>(frame - event.start);
            if (event.points == 0) {
                const channel_drive& d = event.drive[part];
                return std::abs(d.from + (d.to - d.from) * (t / event.length));
            }
            const channel_line& l = event.line;
            std::uint32_t i = 1;
            while (i + 1 < event.points && l.frame[i] < t)
                ++i;
            const double part_done = (t - l.frame[i - 1]) / std::max(1, l.frame[i] - l.frame[i - 1]);
            return std::abs(l.amplitude[i - 1] + (l.amplitude[i] - l.amplitude[i - 1]) * part_done);
        }
    };

    /// A channel of an event.
    struct part {
        std::size_t tactor;
        const open_event* event;
        std::uint32_t number;
    };

    bool begins_at_zero(const drive_event& e) const
    {
        if (e.ramp_position != 0 || e.window <= 1)
            return false;
        const bool at_zero = e.phase_frame == 0 && !std::binary_search(rough_.begin(), rough_.end(), e.sound);
        return e.ramp > 0 || at_zero;
    }

    /// Samples frames `from` to `to` - 1, in which the same events sound and none of them has a bend.
    void sample_frames(std::uint64_t from, std::uint64_t to)
    {
        collect(from);
        std::uint64_t step =
            std::max<std::uint64_t>(1, to - 1 - from); // if all is linear, the ends are enough
        for (const part& p : parts_) {
            if (driven_[p.tactor] > 1) {
                const burst_window w = p.event->window();
                const std::int64_t place = p.event->place(from);
                if (!window_is_flat(place, p.event->place(to), w)) {
                    const std::uint32_t ramp =
                        place < static_cast<std::int64_t>(w.attack) ? w.attack : w.release;
                    step = std::min<std::uint64_t>(step, std::max(1U, ramp / ramp_parts));
                }
                continue;
            }
            raise_peak(peaks_[p.tactor], p.event->level(p.number, from), from);
            raise_peak(peaks_[p.tactor], p.event->level(p.number, to - 1), to - 1);
        }
        std::erase_if(parts_, [this](const part& p) { return driven_[p.tactor] < 2; });
        if (parts_.empty())
            return;
        for (std::uint64_t frame = from; frame < to - 1; frame += step)
            add_up(frame);
        add_up(to - 1);
    }

    /// Lists the parts that may be felt, in order of tactor.
    void collect(std::uint64_t from)
    {
        parts_.clear();
        std::fill(driven_.begin(), driven_.end(), 0U);
        for (const open_event& e : open_) {
            if (e.event.cycles_per_frame == 0.0 && e.event.sound == nullptr)
                continue; // a marker
            if (e.begins_at_zero && from == e.event.start)
                continue;
            const bool is_line = e.event.points != 0;
            for (std::uint32_t i = 0; i < (is_line ? 1 : e.event.drives); ++i) {
                const std::uint32_t channel = is_line ? e.event.line.channel : e.event.drive[i].channel;
                const std::size_t tactor = *tactors_[channel];
                parts_.push_back({tactor, &e, i});
                ++driven_[tactor];
            }
        }
        std::stable_sort(parts_.begin(), parts_.end(),
                         [](const part& x, const part& y) { return x.tactor < y.tactor; });
    }

    /// Adds up the envelopes of each tactor in a frame.
    void add_up(std::uint64_t frame)
    {
        for (std::size_t i = 0; i < parts_.size();) {
            const std::size_t tactor = parts_[i].tactor;
            double sum = 0.0;
            for (; i < parts_.size() && parts_[i].tactor == tactor; ++i) {
                const part& p = parts_[i];
                sum += p.event->level(p.number, frame) * window_at(p.event->place(frame), p.event->window());
            }
            raise_peak(peaks_[tactor], sum, frame);
        }
    }

    const score::impl& score_;
    event_source source_;
    std::vector<std::optional<std::size_t>> tactors_; ///< by channel
    std::vector<open_event> open_;
    std::vector<part> parts_;
    std::vector<tactor_peak> peaks_;
    std::vector<unsigned> driven_;     ///< number of parts of each tactor
    std::vector<const timbre*> rough_; ///< timbres that do not start at zero
};

/// Returns true if a continuous plan drives a tactor at a time, or just before or after.
bool drives_at(const plan& p, double t_s, std::size_t tactor)
{
    const auto last = static_cast<double>(p.curve->size() - 1);
    const double step = t_s / continuous_step_s;
    burst now;
    for (const double k : {std::floor(step), std::ceil(step)}) {
        p.curve->sample(static_cast<std::uint64_t>(std::clamp(k, 0.0, last)), now);
        for (const drive& d : now.drives)
            if (d.tactor == tactor && d.amplitude != 0.0)
                return true;
    }
    return false;
}

/// Returns the numbers of the plans that sound on a tactor in a frame.
std::vector<std::size_t> plans_at(const score::impl& s, std::size_t tactor, std::uint64_t frame)
{
    const auto drives = [&](const item& it) {
        if (it.kind == item_kind::joined)
            return it.tactor == tactor;
        if (it.kind == item_kind::continuous)
            return drives_at(s.plans[it.plan].plan, static_cast<double>(frame - it.start) / s.rate, tactor);
        for (std::size_t k = it.first; it.kind == item_kind::burst && k < it.first + it.count; ++k)
            if (s.list.drive_tactors[k] == tactor && s.list.drive_amplitudes[k] != 0.0)
                return true;
        return false;
    };
    std::vector<std::size_t> all;
    for (const item& it : s.list.items)
        if (frame < it.end() && frame >= first_felt_frame(s, it) && drives(it))
            all.push_back(it.plan);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

} // namespace

std::uint64_t first_felt_frame(const score::impl& s, const item& it)
{
    const bool joined = it.kind == item_kind::joined;
    const std::uint32_t ramp = joined ? s.list.members[it.first].ramp : it.ramp;
    const bool at_zero = (s.phase == phase_kind::burst || it.start == s.starts[it.plan]) &&
                         starts_at_zero(s.plans[it.plan].plan.wave);
    return it.start + (it.length > 1 && (ramp > 0 || at_zero) ? 1 : 0);
}

std::vector<tactor_peak> find_peaks(const std::shared_ptr<const score::impl>& made)
{
    return envelope_walk(made).run();
}

void weaken_to_limits(score::impl& s, const std::vector<tactor_peak>& peaks,
                      const std::vector<double>& limits)
{
    std::size_t worst = 0;
    const auto excess = [&](std::size_t i) { return peaks[i].level / limits[i]; };
    for (std::size_t i = 1; i < peaks.size(); ++i)
        if (excess(i) > excess(worst) * (1.0 + same_peak))
            worst = i;
    s.weakened = {s.weakened.weakened_db - 20.0 * std::log10(excess(worst)), static_cast<unsigned>(worst),
                  static_cast<double>(peaks[worst].frame) / s.rate, plans_at(s, worst, peaks[worst].frame)};
    for (tactor_level& t : s.tactors)
        t.gain /= excess(worst);
}

bool weaken_to_level(const std::shared_ptr<score::impl>& made)
{
    score::impl& s = *made;
    // Counts in multiples of the requested level, so the gains and thresholds of tactors are left out.
    const std::vector<tactor_level> levels = s.tactors;
    for (tactor_level& t : s.tactors)
        t.gain = 1.0;
    std::vector<tactor_spec> measured = std::exchange(s.measured, {});
    const std::vector<tactor_peak> peaks = find_peaks(made);
    s.tactors = levels;
    s.measured = std::move(measured);
    if (std::none_of(peaks.begin(), peaks.end(),
                     [](const tactor_peak& p) { return p.level > 1.0 + same_peak; }))
        return false;
    weaken_to_limits(s, peaks, std::vector<double>(peaks.size(), 1.0));
    return true;
}

} // namespace tactor::synth
