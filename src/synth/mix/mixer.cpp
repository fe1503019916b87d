// SPDX-License-Identifier: MIT
#include "synth/mix/mixer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "core/clones.hpp"
#include "synth/limits/guard.hpp"
#include "synth/mix/converter.hpp"
#include "synth/mix/voice.hpp"
#include "synth/tone/timbre.hpp"

namespace tactor::synth {
namespace {

// A channel in the current block.
struct strip {
    alignas(64) block sum;
    const double* lone = nullptr; // carrier of the only voice so far; gain * lone[j] replaces the sum
    double gain = 1.0;
    double limit = 0.0;
    double peak = 0.0;     // greatest sum of the voices
    double together = 0.0; // greatest sum of voices that overlap and end by `until`, a frame of the block
    unsigned until = 0;
    unsigned since = 0;           // frame of the block at which the first voice begins
    unsigned look = block_frames; // frame of the block from which the envelope is needed
    const voice* first = nullptr; // valid only in the block
    double power = 1.0;           // greatest power of the voices' timbres
    bool steady = false;          // a single voice with a constant envelope
    bool beats = false;           // voices with different carriers
    bool only_crests = false;     // the envelope between the crests is not needed
    bool spare = false;           // channel without a tactor, for markers
    bool sounding = false;

    // Adds the amplitude of a voice that sounds in frames `from` to `to` of the block. Voices come in order
    // of start.
    void add_amplitude(unsigned from, unsigned to, double amplitude) noexcept
    {
        together = from < until ? together + amplitude : amplitude;
        until = std::max(until, to);
        peak = std::max(peak, together);
    }
    // Returns the greatest possible squared envelope.
    double most() const noexcept { return limit * limit * power; }
    // Adds another voice. The carriers beat unless the two voices always have the same frequency.
    void join(const voice& v) noexcept
    {
        steady = false;
        beats = beats || !is_coherent(*first, v);
        power = v.sound != nullptr ? std::max(power, v.sound->power) : power;
    }
    // Returns true if the channel counts as not driven in this block, whatever the voices do.
    bool is_quiet() const noexcept { return std::min(peak, limit) * std::sqrt(power) <= least_counted_drive; }
    // Returns the sum. Computes it first if `lone` replaced it.
    double* summed(unsigned n) noexcept
    {
        if (lone != nullptr)
            std::transform(lone, lone + n, sum.begin(), [this](double x) { return gain * x; });
        lone = nullptr;
        return sum.data();
    }
};

// A block that is aligned to a cache line, also as an element of a vector.
struct alignas(64) aligned_block : block {};

// A few frames of a channel on which carriers beat.
struct crest {
    static constexpr std::size_t frames = 128;
    alignas(64) std::array<double, frames> x{}; // sum of the current carrier; zero between carriers
    alignas(64) std::array<double, frames> y{};
    alignas(64) std::array<double, frames> reach{}; // reach of the earlier carriers
    bool touched = false;
};

// A score that is about to leave the mixer: with a fade, or with a cut if it has none.
struct leaver {
    std::uint32_t score = 0;
    std::int32_t fade = fades::none;
    auto operator<=>(const leaver&) const = default;
};

constexpr block ones = [] {
    block b{};
    b.fill(1.0);
    return b;
}();

// Computes y[j] = x[j]^2 + y[j]^2, at most `most`; NaN becomes `most`.
TACTOR_CLONES void square_envelope(const double* x, double most, unsigned lo, unsigned hi, double* y) noexcept
{
    const double* __restrict in = x;
    double* __restrict out = y;
    for (unsigned j = lo; j < hi; ++j) {
        const double e = in[j] * in[j] + out[j] * out[j];
        out[j] = e < most ? e : most;
    }
}

// Adds the length of (x, y) to `reach`, whose square is `square`, and clears x and y.
TACTOR_CLONES void add_length(unsigned n, double* x, double* y, double* reach, double* square) noexcept
{
    double* __restrict sine = x;
    double* __restrict cosine = y;
    double* __restrict sum = reach;
    double* __restrict out = square;
    for (unsigned j = 0; j < n; ++j) {
        const double e = sine[j] * sine[j] + cosine[j] * cosine[j];
        const double length = std::sqrt(e);
        out[j] += e + 2.0 * sum[j] * length;
        sum[j] += length;
        sine[j] = 0.0;
        cosine[j] = 0.0;
    }
}

// The mixer's state and work. It is local to this file, so that the compiler can inline functions that are
// called once.
struct channel_mixer {
    channel_mixer(std::span<const double> limits, format_kind f, std::size_t capacity,
                  const guard_settings& g)
        : format(f),
          strips(limits.size()),
          voices(capacity),
          power(limits.size(), g.power, most_power * reach(limits), g.rate),
          duty(limits.size(), g),
          envelopes(power.on() || duty.on() ? limits.size() : 0),
          crests(power.on() ? limits.size() : 0)
    {
        for (std::size_t i = 0; i < strips.size(); ++i) {
            strips[i].limit = clamp_limit(limits[i]);
            strips[i].spare = strips[i].limit == 0.0;
        }
        sounding.reserve(strips.size());
        powered.reserve(strips.size());
        samples.reserve(strips.size());
        leaving.reserve(most_leaving);
        carriers.reserve(power.on() ? capacity : 0);
        frame_bytes = strips.size() * sample_bytes(format);
    }

    static double reach(std::span<const double> limits) noexcept
    {
        return std::accumulate(limits.begin(), limits.end(), 0.0,
                               [](double sum, double l) { return sum + clamp_limit(l) * clamp_limit(l); });
    }

    // Returns true if a voice is on suitable channels. A voice without a carrier, such as a marker, needs
    // channels without a tactor, because a constant would displace a tactor. Other voices need channels with
    // a tactor.
    bool plays(const voice& v) const noexcept
    {
        bool fits = true;
        for_each_channel(
            v, [&](std::uint32_t c) { fits = fits && strips[c].spare == (v.cycles_per_frame == 0.0); });
        return fits;
    }
    // Returns the carrier of a voice with its window, fade and gain.
    const double* shaped(const voice& v, std::uint64_t at, unsigned n, wave w) noexcept
    {
        return carrier.get(v, v.fade == fades::none ? nullptr : &fading[v.fade], gains.find(v.score, at), at,
                           n, w);
    }
    void add_wave(const voice& v, const stretch& p, wave w, unsigned look, unsigned n, double* sum) noexcept
    {
        const std::uint64_t at = position + look;
        if (p.end > at && p.start < position + n)
            add_stretch(shaped(v, at, n - look, w), p, at, n - look, sum);
    }
    void segment(unsigned n, std::byte* out) noexcept;
    void mix(const voice& v, bool last, unsigned n) noexcept;
    void limit(unsigned n) noexcept;
    void guard(unsigned n) noexcept;
    void find_envelope_starts(bool together, unsigned n) noexcept;
    void begin_strip(std::uint32_t channel, const voice& v, unsigned from) noexcept;
    void mix_line(const voice& v, const double* s, unsigned n) noexcept;
    void find_envelopes(unsigned n) noexcept;
    void count_drive(unsigned n) noexcept;
    void replace_beating_envelopes(unsigned from, unsigned n) noexcept;
    void list_carriers() noexcept;
    void find_crests(unsigned from, unsigned to) noexcept;
    void add_carrier(unsigned from, unsigned to) noexcept;
    void cut(unsigned n) noexcept;
    void guard_power(bool together, unsigned n) noexcept;
    void write(unsigned n, std::byte* out) noexcept;
    void remove_leaving_scores() noexcept;
    void end_fades() noexcept;

    static constexpr std::size_t most_leaving = 1024; // capacity of `leaving`

    format_kind format;
    std::size_t frame_bytes = 0;
    std::vector<strip> strips;
    std::vector<std::uint32_t> sounding;
    voice_list voices;
    fades fading;
    score_gains gains;
    std::vector<leaver> leaving; // scores that leave, since the last pass over the voices
    carrier_block carrier;
    power_guard power;
    drive_guard duty;
    std::vector<aligned_block> envelopes; // squared envelope of each channel; empty if not needed
    std::vector<powered_channel> powered;
    std::vector<crest> crests;                              // by channel
    std::vector<std::pair<double, std::uint32_t>> carriers; // cycles per frame, index among the active
    std::vector<channel_samples> samples;
    std::uint64_t clock = 0; // frames since the construction
    std::uint64_t position = 0;
    std::uint64_t limited = 0;
    std::uint64_t power_limited = 0;
};

} // namespace

struct mixer::impl : channel_mixer {
    using channel_mixer::channel_mixer;
};

mixer::mixer(std::span<const double> limits, format_kind format, std::size_t capacity,
             const guard_settings& guards)
    : impl_(std::make_unique<impl>(limits, format, capacity, guards))
{
}

mixer::~mixer() = default;

std::size_t mixer::available() const noexcept
{
    impl_->remove_leaving_scores();
    return impl_->voices.available();
}

std::size_t mixer::size() const noexcept
{
    impl_->remove_leaving_scores();
    return impl_->voices.size();
}

std::uint64_t mixer::position() const noexcept
{
    return impl_->position;
}

mixer_counts mixer::counts() const noexcept
{
    return {impl_->limited, impl_->power_limited, impl_->duty.cuts()};
}

bool mixer::add(const drive_event& e) noexcept
{
    impl& m = *impl_;
    m.remove_leaving_scores();
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
        m.remove_leaving_scores();
    if (fade == 0) {
        m.leaving.push_back({score, fades::none});
        return true;
    }
    if (m.fading.find(score) != fades::none)
        return true;
    std::int32_t i = m.fading.begin(score, m.position, fade);
    if (i == fades::none && !m.leaving.empty()) {
        m.remove_leaving_scores(); // a cut may end a fade
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
void channel_mixer::remove_leaving_scores() noexcept
{
    if (leaving.empty())
        return;
    std::sort(leaving.begin(), leaving.end()); // a cut comes before a fade of the same score
    voices.remove_if([this](voice& v) {
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

void mixer::raise(std::size_t channel, double level_s) noexcept
{
    impl_->duty.raise(channel, impl_->clock, level_s);
}

void mixer::cut() noexcept
{
    impl_->power.silence(0);
    impl_->voices.clear();
    impl_->fading.clear();
    impl_->leaving.clear();
    impl_->carrier.forget();
    impl_->gains.end_ramps();
}

void mixer::reset() noexcept
{
    cut();
    impl_->position = 0;
}

void mixer::process(std::size_t frames, std::byte* out) noexcept
{
    impl& m = *impl_;
    m.remove_leaving_scores();
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
                std::min<std::uint64_t>({block_frames, frames, m.duty.max_block_frames()}));
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

void channel_mixer::end_fades() noexcept
{
    if (!fading.any_ended(position))
        return;
    voices.remove_if(
        [this](const voice& v) { return v.fade != fades::none && fading[v.fade].end() <= position; });
    fading.end_all(position);
}

void channel_mixer::segment(unsigned n, std::byte* out) noexcept
{
    voices.activate(position + n);
    const std::span<const std::uint32_t> active = voices.active();
    for (std::size_t i = 0; i < active.size(); ++i)
        mix(voices[active[i]], i + 1 == active.size(), n);
    limit(n);
    if (!envelopes.empty())
        guard(n);
    write(n, out);
}

// Mixes a voice. Its carrier is valid until the next voice requests a carrier. The carrier of the last voice
// is valid until the block is written.
void channel_mixer::mix(const voice& v, bool last, unsigned n) noexcept
{
    const auto from = static_cast<unsigned>(std::max(v.start, position) - position);
    const auto to = static_cast<unsigned>(std::min(v.end, position + n) - position);
    const bool is_marker = v.cycles_per_frame == 0.0 && v.sound == nullptr;
    const double* s = is_marker ? ones.data() : shaped(v, position, n, wave::sine);
    if (v.points != 0) {
        mix_line(v, s, n);
        return;
    }
    for (std::uint32_t i = 0; i < v.drives; ++i) {
        const voice_drive& d = v.drive[i];
        const double peak = d.peak(v.end - v.start);
        strip& t = strips[d.channel];
        if (!t.sounding) {
            begin_strip(d.channel, v, from);
            t.steady = d.slope == 0.0 && carrier.is_plain(s) && (v.sound == nullptr || v.sound->is_steady());
            t.add_amplitude(from, to, peak);
            if (d.slope == 0.0 && to - from == n) {
                t.lone = s;
                t.gain = d.from;
                if (!last)
                    t.summed(n);
                continue;
            }
            std::fill_n(t.sum.begin(), n, 0.0);
        } else {
            t.add_amplitude(from, to, peak);
            t.join(v);
        }
        add_stretch(s, {v.start, v.end, d}, position, n, t.summed(n));
    }
}

void channel_mixer::begin_strip(std::uint32_t channel, const voice& v, unsigned from) noexcept
{
    strip& t = strips[channel];
    t.sounding = true;
    t.since = from;
    t.first = &v;
    t.power = v.sound == nullptr ? 1.0 : v.sound->power;
    t.steady = false;
    t.beats = false;
    t.peak = 0.0;
    t.until = 0;
    sounding.push_back(channel);
}

// Mixes a voice with a line. In the block the voice counts with its greatest amplitude, from the voice's
// start on, even if the line is silent at first, because voices come in order of start.
void channel_mixer::mix_line(const voice& v, const double* s, unsigned n) noexcept
{
    strip& t = strips[v.line.channel];
    const bool alone = !t.sounding;
    double* sum = alone ? t.sum.data() : t.summed(n);
    if (alone)
        std::fill_n(sum, n, 0.0);
    unsigned first = n;
    unsigned end = 0;
    double peak = 0.0;
    for_each_stretch(v, position, n, [&](const stretch& p) {
        const auto [from, to] = p.within(position, n);
        add_stretch(s, p, position, n, sum);
        first = std::min(first, from);
        end = to;
        peak = std::max(peak, p.drive.peak(p.end - p.start));
    });
    if (end == 0)
        return;
    if (alone)
        begin_strip(v.line.channel, v, first);
    else
        t.join(v);
    t.add_amplitude(static_cast<unsigned>(std::max(v.start, position) - position), end, peak);
}

void channel_mixer::limit(unsigned n) noexcept
{
    for (const std::uint32_t c : sounding) {
        strip& t = strips[c];
        if (t.spare)
            limit_block(t.summed(n), n, 1.0); // two markers at once are one marker
        else if (!is_within_limit(t.peak, t.limit))
            limited += limit_block(t.summed(n), n, t.limit);
    }
}

void channel_mixer::write(unsigned n, std::byte* out) noexcept
{
    std::sort(sounding.begin(), sounding.end());
    samples.clear();
    for (const std::uint32_t c : sounding) {
        strip& t = strips[c];
        samples.push_back(t.lone != nullptr ? channel_samples{c, t.lone, t.gain}
                                            : channel_samples{c, t.sum.data(), 1.0});
        t.lone = nullptr;
        t.sounding = false;
    }
    sounding.clear();
    interleave(format, samples, strips.size(), n, out);
}

// Limits the power of all channels together and the drive time of each channel. Both limits use the envelope
// sqrt(x^2 + y^2) of the samples x, where y is x a quarter of a cycle later.
void channel_mixer::guard(unsigned n) noexcept
{
    double most = 0.0; // sum of squares
    for (const std::uint32_t c : sounding) {
        const strip& t = strips[c];
        const double peak = t.peak < t.limit ? t.peak : t.limit;
        most += t.spare ? 0.0 : peak * peak * t.power;
    }
    const bool together = !power.passes(most);
    find_envelope_starts(together, n);
    find_envelopes(n);
    if (duty.on())
        count_drive(n);
    if (power.on())
        replace_beating_envelopes(together ? 0 : n - 1, n);
    if (duty.on())
        cut(n);
    if (power.on())
        guard_power(together, n);
}

// Finds the first frame of each channel whose envelope is needed: computing an envelope takes as long as the
// samples.
void channel_mixer::find_envelope_starts(bool together, unsigned n) noexcept
{
    for (const std::uint32_t c : sounding) {
        strip& t = strips[c];
        if (t.spare)
            continue;
        const bool known = !duty.on() || t.steady || t.is_quiet();
        t.look = together || !known ? 0 : power.on() ? n - 1 : n;
        t.only_crests = t.beats && known && power.on();
        std::fill(envelopes[c].begin() + t.look, envelopes[c].begin() + n, 0.0);
    }
}

void channel_mixer::find_envelopes(unsigned n) noexcept
{
    for (const std::uint32_t slot : voices.active()) {
        const voice& v = voices[slot];
        for_each_stretch(v, position, n, [&](const stretch& s) {
            const std::uint32_t c = s.drive.channel;
            const strip& t = strips[c];
            if (t.look < n && !t.only_crests)
                add_wave(v, s, wave::cosine, t.look, n, envelopes[c].data() + t.look);
        });
    }
    for (const std::uint32_t c : sounding) {
        strip& t = strips[c];
        double* y = envelopes[c].data();
        const double most = t.most();
        if (t.look + 1 == n && t.lone != nullptr) {
            const double x = t.gain * t.lone[t.look];
            square_envelope(&x, most, 0, 1, y + t.look);
        } else if (t.look < n) {
            square_envelope(t.summed(n), most, t.look, n, y);
        }
    }
}

void channel_mixer::count_drive(unsigned n) noexcept
{
    for (const std::uint32_t c : sounding) {
        const strip& t = strips[c];
        if (t.spare || t.is_quiet())
            continue;
        if (t.steady)
            duty.drive(c, clock + t.since, clock + t.until);
        else
            duty.follow(c, clock, envelopes[c].data(), n);
    }
}

void channel_mixer::cut(unsigned n) noexcept
{
    for (const std::uint32_t c : sounding) {
        strip& t = strips[c];
        if (!t.spare && duty.changes_block(c, clock, n))
            duty.apply(c, clock, n, t.summed(n), envelopes[c].data(), t.look);
    }
}

void channel_mixer::guard_power(bool together, unsigned n) noexcept
{
    powered.clear();
    for (const std::uint32_t c : sounding)
        if (!strips[c].spare)
            powered.push_back({c, strips[c].sum.data(), envelopes[c].data()});
    if (!together) {
        power.record_unchanged_block(powered, n);
        return;
    }
    for (const powered_channel& c : powered)
        strips[c.channel].summed(n);
    power_limited += power.apply(powered, n);
}

// Replaces the envelope by its crests on channels where carriers beat, because a gain that follows the beat
// would be felt. Carriers of the same frequency add up with their phases.
void channel_mixer::replace_beating_envelopes(unsigned from, unsigned n) noexcept
{
    list_carriers();
    if (carriers.empty())
        return;
    for (const std::uint32_t c : sounding) {
        strips[c].summed(n); // a single voice's sine would be lost
        if (strips[c].beats)
            std::fill(envelopes[c].begin() + from, envelopes[c].begin() + n, 0.0);
    }
    while (from < n) {
        const unsigned to = std::min(n, from + static_cast<unsigned>(crest::frames));
        find_crests(from, to);
        from = to;
    }
}

// Lists the voices on channels that beat, by frequency.
void channel_mixer::list_carriers() noexcept
{
    carriers.clear();
    const std::span<const std::uint32_t> active = voices.active();
    for (std::uint32_t i = 0; i < active.size(); ++i) {
        const voice& v = voices[active[i]];
        bool beats = false;
        for_each_channel(v, [&](std::uint32_t c) { beats = beats || strips[c].beats; });
        if (beats)
            carriers.emplace_back(v.cycles_per_frame, i);
    }
    std::sort(carriers.begin(), carriers.end());
}

void channel_mixer::find_crests(unsigned from, unsigned to) noexcept
{
    for (const std::uint32_t c : sounding)
        if (strips[c].beats)
            crests[c].reach.fill(0.0);
    for (std::size_t i = 0; i < carriers.size(); ++i) {
        const voice& v = voices[voices.active()[carriers[i].second]];
        for_each_stretch(v, position + from, to - from, [&](const stretch& s) {
            const std::uint32_t c = s.drive.channel;
            if (strips[c].beats) {
                crests[c].touched = true;
                add_wave(v, s, wave::sine, from, to, crests[c].x.data());
                add_wave(v, s, wave::cosine, from, to, crests[c].y.data());
            }
        });
        if (i + 1 == carriers.size() || !is_coherent(v, voices[voices.active()[carriers[i + 1].second]]))
            add_carrier(from, to);
    }
    for (const std::uint32_t c : sounding) {
        if (strips[c].beats) {
            const double most = strips[c].most();
            double* square = envelopes[c].data();
            for (unsigned j = from; j < to; ++j)
                square[j] = square[j] < most ? square[j] : most;
        }
    }
}

void channel_mixer::add_carrier(unsigned from, unsigned to) noexcept
{
    for (const std::uint32_t c : sounding) {
        crest& r = crests[c];
        if (r.touched) {
            add_length(to - from, r.x.data(), r.y.data(), r.reach.data(), envelopes[c].data() + from);
            r.touched = false;
        }
    }
}

} // namespace tactor::synth
