// SPDX-License-Identifier: MIT
#include "synth/score/levels.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/refused.hpp"
#include "core/trajectory/spans.hpp"
#include "core/words.hpp"
#include "plan/curve_impl.hpp"
#include "synth/score/event_source.hpp"
#include "synth/score/frames.hpp"
#include "synth/score/together.hpp"
#include "synth/wave/window.hpp"

namespace tactor::synth {

namespace {

/// Returns an error (bad_input) with the tactor's number and its line in the array file.
error tactor_error(std::size_t i, const render_options& o, std::string_view why, std::string_view hint,
                   const source_place& at)
{
    const std::string name = fmt::format("tactor {}", i);
    if (at.text().empty())
        return error(error_kind::bad_input, name, fmt::format("it {}", why), hint)
            .with_field(o.sl_db ? "sl_db" : "level_dbfs");
    return {error_kind::bad_input, at, fmt::format("{} {}", name, why), hint};
}

// Returns a tactor's level, dBFS. A tactor without a threshold gets full scale, so that check_peaks() finds
// its drives.
double level_db(const array& a, std::size_t i, const render_options& o)
{
    const tactor_spec& t = a.tactors[i];
    if (o.sl_db) {
        const auto threshold = threshold_at(t, reference_hz);
        return threshold ? *threshold + *o.sl_db : 0.0;
    }
    const double level = o.level_dbfs + t.gain_db;
    if (!(level <= 1e-9)) {
        throw level_error(
            tactor_error(
                i, o,
                fmt::format(
                    "would play at {:.4g} dBFS, above full scale: gain_db is {} at a level of {} dBFS", level,
                    t.gain_db, o.level_dbfs),
                fmt::format("lower gain_db, or {{level_dbfs}} to {:.4g} or less", -t.gain_db), t.where),
            level);
    }
    return level;
}

/// Returns the limit of a tactor, dBFS.
double limit_db(const array& a, std::size_t i)
{
    return std::min(0.0, a.tactors[i].max_dbfs);
}

} // namespace

void refuse_unmeasured(const array& a, std::size_t i, const render_options& o)
{
    throw tactor_error(i, o,
                       fmt::format("has no threshold_dbfs, but the level is a sensation level of {} dB",
                                   o.sl_db.value_or(0.0)),
                       "run {command:calibrate}, or use {level_dbfs}", a.tactors[i].where);
}

std::vector<std::size_t> unmeasured_tactors(const array& a, const render_options& o)
{
    std::vector<std::size_t> all;
    for (std::size_t i = 0; o.sl_db && i < a.tactors.size(); ++i)
        if (!threshold_at(a.tactors[i], reference_hz))
            all.push_back(i);
    return all;
}

double threshold_factor(const tactor_spec& t, double hz)
{
    if (t.thresholds.empty())
        return 1.0;
    const double db = *threshold_at(t, hz) - *threshold_at(t, reference_hz);
    return std::pow(10.0, db / 20.0);
}

double tactor_limit(const array& a, std::size_t i)
{
    return std::pow(10.0, limit_db(a, i) / 20.0) * (1.0 + 1e-9);
}

std::vector<tactor_level> tactor_levels(const array& a, const render_options& o)
{
    if (o.sl_db && !std::isfinite(*o.sl_db)) {
        throw detail::bad_field("sl_db", fmt::format("{} is not a level", *o.sl_db),
                                "give a finite level; the paper uses 7 dB SL");
    }
    if (!o.sl_db && !(std::isfinite(o.level_dbfs) && o.level_dbfs <= 0.0)) {
        throw detail::bad_field("level_dbfs",
                                fmt::format("{} dBFS is not a level of 0 dBFS or less", o.level_dbfs),
                                "give a level of 0 dBFS or less; the default is -12");
    }
    std::vector<tactor_level> levels;
    levels.reserve(a.tactors.size());
    for (std::size_t i = 0; i < a.tactors.size(); ++i) {
        const tactor_spec& t = a.tactors[i];
        const double gain = std::pow(10.0, level_db(a, i, o) / 20.0);
        levels.push_back({t.channel, t.polarity < 0 ? -gain : gain});
    }
    return levels;
}

namespace {

/// Relative difference of levels that is only rounding.
constexpr double last_digits = 1e-9;

/// A change of a tactor's possible amplitude at a frame.
struct change {
    std::uint64_t frame;
    double by;
    double plain; // change without the tactor's level
    std::size_t tactor;

    /// Orders by frame. At the same frame, decreases come first.
    bool operator>(const change& c) const { return std::tie(frame, by) > std::tie(c.frame, c.by); }
};

/// Greatest amplitude of each tactor, summed over the items that may sound at once. Items must be added in
/// order of start, so that the heap holds only the changes of sounding items.
class sweep {
public:
    explicit sweep(std::size_t tactors)
        : sums_(tactors),
          plain_sums_(tactors),
          peaks_(tactors),
          plain_peaks_(tactors),
          loudest_(tactors),
          factors_(tactors, 1.0)
    {
    }

    /// Adds an item. `from`: result of first_felt_frame(). `amplitude`: 1 is the requested level. `factor`:
    /// accounts for the threshold at the carrier.
    void note(std::size_t tactor, const item& it, std::uint64_t from, double amplitude, double gain,
              double factor)
    {
        const double peak = amplitude * (gain * factor);
        if (!(peak > 0.0 && from < it.end()))
            return;
        if (peak > loudest_[tactor]) {
            loudest_[tactor] = peak;
            factors_[tactor] = factor;
        }
        pass(it.start);
        add({from, peak, amplitude, tactor});
        add({it.end(), -peak, -amplitude, tactor});
    }

    /// Ends the sweep.
    void end() { pass(UINT64_MAX); }
    const std::vector<double>& peaks() const noexcept { return peaks_; }
    /// Returns the greatest sum on any tactor; 1 is the requested level.
    double plain_peak() const { return *std::max_element(plain_peaks_.begin(), plain_peaks_.end()); }

    /// Returns the level of each tactor's loudest item.
    const std::vector<double>& loudest() const noexcept { return loudest_; }
    /// Returns the factor of each tactor's loudest item.
    const std::vector<double>& factors() const noexcept { return factors_; }

private:
    void add(const change& c)
    {
        heap_.push_back(c);
        std::push_heap(heap_.begin(), heap_.end(), std::greater<>{});
    }

    /// Applies the changes before a frame.
    void pass(std::uint64_t frame)
    {
        while (!heap_.empty() && heap_.front().frame < frame) {
            const change c = heap_.front();
            std::pop_heap(heap_.begin(), heap_.end(), std::greater<>{});
            heap_.pop_back();
            sums_[c.tactor] += c.by;
            peaks_[c.tactor] = std::max(peaks_[c.tactor], sums_[c.tactor]);
            plain_sums_[c.tactor] += c.plain;
            plain_peaks_[c.tactor] = std::max(plain_peaks_[c.tactor], plain_sums_[c.tactor]);
        }
    }

    std::vector<change> heap_;
    // By tactor.
    std::vector<double> sums_;
    std::vector<double> plain_sums_;
    std::vector<double> peaks_;
    std::vector<double> plain_peaks_;
    std::vector<double> loudest_;
    std::vector<double> factors_;
};

// Returns the greatest amplitude of a joined item; 1 is the requested level.
double joined_peak(const score::impl& s, std::size_t number)
{
    double peak = 0.0;
    expander e;
    for (e.begin(s, number, nullptr); !e.done(); e.advance()) {
        const channel_drive& d = e.event().drive[0];
        peak = std::max({peak, std::abs(d.from), std::abs(d.to)});
    }
    const item& it = s.list.items[number];
    return peak / (std::abs(s.tactors[it.tactor].gain) * s.equalising_factor(it.tactor, it.plan, it.start));
}

/// Sums the possible amplitudes of the items. `exact`: reads the samples of continuous strokes even if their
/// intensity is a bound.
sweep sweep_items(const score::impl& s, bool exact)
{
    sweep all(s.tactors.size());
    const item_list& list = s.list;
    for (std::size_t i = 0; i < list.items.size(); ++i) {
        const item& it = list.items[i];
        const std::uint64_t from = first_felt_frame(s, it);
        switch (it.kind) {
        case item_kind::joined:
            all.note(it.tactor, it, from, joined_peak(s, i), std::abs(s.tactors[it.tactor].gain),
                     s.equalising_factor(it.tactor, it.plan, it.start));
            break;
        case item_kind::continuous: {
            const plan& p = s.plans[it.plan].plan;
            std::vector<double> peaks =
                exact ? std::vector<double>{} : continuous_bounds(p, s.tactors.size());
            if (peaks.empty())
                peaks = continuous_peaks(p, s.tactors.size());
            for (std::size_t k = 0; k < peaks.size(); ++k) {
                const double factor =
                    s.max_equalising_factor(k, it.plan); // at the carrier with the greatest factor
                all.note(k, it, from, peaks[k], std::abs(s.tactors[k].gain), factor);
            }
            break;
        }
        case item_kind::marker:
        case item_kind::own:
            break;
        case item_kind::burst:
            for (std::size_t k = it.first; k < it.first + it.count; ++k) {
                const std::size_t tactor = list.drive_tactors[k];
                const double factor = s.equalising_factor(tactor, it.plan, it.start);
                all.note(tactor, it, from, std::abs(list.drive_amplitudes[k]),
                         std::abs(s.tactors[tactor].gain), factor);
            }
            break;
        }
    }
    all.end();
    return all;
}

/// Throws error if the peak of a tactor is above its limit. `factor`: element of sweep::factors(). `over_db`:
/// excess of the whole score.
void check(const array& a, std::size_t i, double peak, double factor, const render_options& o, double over_db)
{
    if (peak <= tactor_limit(a, i))
        return;
    const double most_db = limit_db(a, i);
    const double excess_db = std::max(0.01, std::ceil((in_db(peak) - most_db) * 100.0) / 100.0);
    const bool limited = most_db < 0.0;
    const std::string limit = limited ? fmt::format("its max_dbfs of {:.4g} dBFS", most_db) : "full scale";
    const std::string driven = fmt::format("would play at {:.4g} dBFS, above {}", in_db(peak), limit);
    const char* raise = limited ? ", or raise max_dbfs" : "";
    const tactor_spec& t = a.tactors[i];
    const source_place& at = t.limit_where.text().empty() ? t.where : t.limit_where;
    if (o.sl_db)
        throw level_error(
            tactor_error(i, o,
                         fmt::format("{}, because its threshold is {:.4g} dBFS", driven,
                                     threshold_at(t, reference_hz).value_or(0.0) + in_db(factor)),
                         fmt::format("lower {{sl_db}} by {:.2f} dB or more{}", excess_db, raise), at),
            over_db);
    throw level_error(
        tactor_error(i, o, driven,
                     fmt::format("lower {{level_dbfs}} or the tactor's gain_db by {:.2f} dB or more{}",
                                 excess_db, raise),
                     at),
        over_db);
}

/// Throws error for drives that cannot be rendered. The drives of a curve are already in order of tactor.
void check_drives(const burst& b, std::size_t tactors)
{
    for (const drive& d : b.drives)
        if (d.tactor >= tactors || !std::isfinite(d.amplitude))
            throw error(error_kind::bad_input, "stroke at " + seconds_text(b.onset_s),
                        fmt::format("tactor {} at amplitude {} cannot be rendered", d.tactor, d.amplitude));
}

} // namespace

double in_db(double amplitude)
{
    return 20.0 * std::log10(amplitude);
}

std::vector<double> continuous_bounds(const plan& p, std::size_t tactors)
{
    const trajectory* motion = curve_access::of(*p.curve).bounding_motion(tactors);
    if (motion == nullptr)
        return {};
    double greatest = 0.0;
    detail::for_each_span(*motion, [&](const detail::trajectory_span& s) {
        greatest = s.intensity <= greatest ? greatest : s.intensity;
        return std::isfinite(greatest);
    });
    return std::isfinite(greatest) ? std::vector<double>(tactors, greatest) : std::vector<double>{};
}

std::vector<double> continuous_peaks(const plan& p, std::size_t tactors)
{
    std::vector<double> peaks(tactors, 0.0);
    burst now;
    detail::same_tactors seen;
    for (std::uint64_t k = 0; k < p.curve->size(); ++k) {
        curve_access::of(*p.curve).sample(k, seen, now);
        check_drives(now, tactors);
        for (const drive& d : now.drives)
            peaks[d.tactor] = std::max(peaks[d.tactor], std::abs(d.amplitude));
    }
    return peaks;
}

namespace {

/// Weakens the score if a sum exceeds a tactor's limit and no single item does. Returns the level of each
/// tactor.
std::vector<double> weaken_sums(const std::shared_ptr<score::impl>& made, const array& a, const sweep& all)
{
    std::vector<double> peaks;
    std::vector<double> limits;
    bool is_sum = false;
    bool is_alone = false;
    const std::vector<tactor_peak> found = find_peaks(made);
    for (std::size_t i = 0; i < found.size(); ++i) {
        peaks.push_back(found[i].level);
        limits.push_back(tactor_limit(a, i));
        is_sum = is_sum || peaks[i] > limits[i];
        is_alone = is_alone || all.loudest()[i] > limits[i];
    }
    if (!is_sum || is_alone)
        return peaks;
    const double before_db = made->weakened.weakened_db;
    weaken_to_limits(*made, found, limits);
    for (double& peak : peaks)
        peak *= std::pow(10.0, (made->weakened.weakened_db - before_db) / 20.0) * (1.0 - 1e-12);
    return peaks;
}

} // namespace

std::vector<double> check_peaks(const std::shared_ptr<score::impl>& made, const array& a,
                                const render_options& o)
{
    score::impl& s = *made;
    const auto within = [&](const std::vector<double>& peaks) {
        for (std::size_t i = 0; i < peaks.size(); ++i)
            if (!(peaks[i] <= tactor_limit(a, i)))
                return false;
        return std::none_of(s.unmeasured.begin(), s.unmeasured.end(),
                            [&](std::size_t i) { return peaks[i] > 0.0; });
    };
    // Nearly always the intensities show that all levels are within limits; then hours of samples need not be
    // read.
    sweep all = sweep_items(s, false);
    const bool weakens = o.together == together_kind::weaken;
    if (weakens && all.plain_peak() > 1.0 + last_digits && weaken_to_level(made))
        all = sweep_items(s, false);
    if (!within(all.peaks()))
        all = sweep_items(s, true);
    std::vector<double> peaks = all.peaks();
    if (weakens && !within(peaks))
        peaks = weaken_sums(made, a, all);
    for (const std::size_t i : s.unmeasured)
        if (peaks[i] > 0.0)
            refuse_unmeasured(a, i, o);
    const std::vector<double>& refused = weakens ? all.loudest() : peaks;
    const auto excess_db = [&a](const std::vector<double>& of, std::size_t i) {
        return in_db(of[i]) - limit_db(a, i);
    };
    double over_db = 0.0;
    std::size_t worst = 0; // lowering the level by its excess is enough for all
    for (std::size_t i = 0; i < peaks.size(); ++i) {
        over_db = std::max(over_db, excess_db(refused, i));
        if (excess_db(peaks, i) > excess_db(peaks, worst))
            worst = i;
    }
    check(a, worst, peaks[worst], all.factors()[worst], o, over_db);
    for (const std::size_t i : s.unmeasured)
        s.tactors[i].gain = 0.0; // nothing may sound there at full scale
    return peaks;
}

namespace {

/// Number of time constants after which an actuator is within 0.7 % of its strength.
constexpr double enough_rises = 5.0;
/// Minimum amplitude of an added burst, relative to full scale (-100 dB).
constexpr double least_boost = 1e-5;

/// Returns the output at frame `to` of a first-order lag whose input is a window's frames `from` to `to` - 1.
double lag_output(const burst_window& w, std::uint64_t from, std::uint64_t to, double rise)
{
    const double decay = std::exp(-1.0 / rise);
    double y = 0.0;
    for (std::uint64_t k = from; k < to; ++k)
        y = decay * y + (1.0 - decay) * window_at(static_cast<std::int64_t>(k), w);
    return y;
}

/// Model of the strength that an actuator reaches in a burst: a first-order lag. After a time t it has
/// reached 1 - e^(-t / rise_s) of a steady vibration.
class lag {
public:
    /// Prepares for bursts that rise in `attack` frames and fall in `release`; `rise` in frames, above 0.
    lag(double rise, std::uint32_t attack, std::uint32_t release, envelope_kind shape)
        : rise_(rise), attack_(attack), release_(release)
    {
        const burst_window w{std::uint64_t{attack} + release, attack, release, shape};
        after_attack_ = lag_output(w, 0, attack, rise);
        of_release_ = lag_output(w, attack, w.length, rise);
    }

    /// Returns the remaining part of a strength after `frames`.
    double decay(double frames) const noexcept { return std::exp(-frames / rise_); }
    /// Returns the strength reached `frames` after the burst's start, if strength 1 is requested. Only for
    /// times after the attack.
    double strength_after(double frames) const noexcept
    {
        return 1.0 - (1.0 - after_attack_) * decay(frames - attack_);
    }
    /// Returns the strength at the end of a burst of `frames`, after its release.
    double fallen(double frames) const noexcept
    {
        return strength_after(frames - release_) * decay(release_) + of_release_;
    }

private:
    double rise_;
    double attack_;
    double release_;
    double after_attack_;
    double of_release_; ///< contribution of the release itself
};

/// State of a tactor after its latest drive.
struct motion {
    std::uint64_t until = 0; ///< end of the drive
    double strength = 0.0;   ///< strength of the actuator at that time, in the unit of drive amplitudes
};

/// A boost. Its amplitude is in the unit of drive amplitudes.
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
                    boost_burst(it, s_.list.drive_tactors[k], s_.list.drive_amplitudes[k], more);
                break;
            case item_kind::joined:
                note(motions_[it.tactor], it.end(), s_.list.members[it.first].intensity);
                break;
            case item_kind::continuous:
                for (motion& m : motions_)
                    note(m, it.end(), 1.0);
                break;
            case item_kind::marker:
            case item_kind::own:
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

    void boost_burst(const item& it, std::size_t tactor, double amplitude, std::vector<item>& more)
    {
        motion& m = motions_[tactor];
        const auto rise_s = a_.tactors[tactor].rise_s;
        // Rounding may put the end of a burst into the first frame of a burst that follows at once.
        if (!rise_s || it.start + 1 < m.until) {
            note(m, it.end(), amplitude);
            return;
        }
        const std::uint32_t release = release_frames(s_.envelope, s_.rate, it.length, it.ramp);
        const lag l(*rise_s * s_.rate, it.ramp, release, s_.envelope.kind);
        const std::uint64_t pause = it.start - std::min(m.until, it.start);
        const double before = m.strength * l.decay(static_cast<double>(pause));
        const double unit =
            std::abs(s_.tactors[tactor].gain) * s_.equalising_factor(tactor, it.plan, it.start);
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

    /// Returns the shortest boost of whole half cycles that suffices, or the longest one that fits.
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
            const double missing = amplitude * (1.0 - l.strength_after(t)) - before * l.decay(t);
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
