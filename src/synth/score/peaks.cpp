// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/trajectory/spans.hpp"
#include "core/words.hpp"
#include "plan/curve_impl.hpp"
#include "synth/score/expander.hpp"
#include "synth/score/levels.hpp"

namespace tactor::synth {

namespace {

/// At a frame, a tactor's possible amplitude changes.
struct change {
    std::uint64_t frame;
    double by;
    std::size_t tactor;

    /// Orders by frame. At the same frame, changes downwards come first.
    bool operator>(const change& c) const { return std::tie(frame, by) > std::tie(c.frame, c.by); }
};

/// The greatest amplitude of each tactor, summed over the items that may sound at once. Items arrive by
/// start, so the heap holds only the changes of those that sound.
class sweep {
public:
    explicit sweep(std::size_t tactors)
        : sums_(tactors), peaks_(tactors), loudest_(tactors), factors_(tactors, 1.0)
    {
    }

    /// `from`: as score::impl::heard_from(). `factor` is in the peak, for the threshold at the carrier.
    void note(std::size_t tactor, const item& it, std::uint64_t from, double peak, double factor)
    {
        if (!(peak > 0.0 && from < it.end()))
            return;
        if (peak > loudest_[tactor]) {
            loudest_[tactor] = peak;
            factors_[tactor] = factor;
        }
        pass(it.start);
        add({from, peak, tactor});
        add({it.end(), -peak, tactor});
    }

    const std::vector<double>& peaks()
    {
        pass(UINT64_MAX);
        return peaks_;
    }

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
        }
    }

    std::vector<change> heap_;
    std::vector<double> sums_;  // by tactor
    std::vector<double> peaks_; // by tactor
    std::vector<double> loudest_;
    std::vector<double> factors_;
};

double joined_peak(const score::impl& s, std::size_t number)
{
    double peak = 0.0;
    expander e;
    for (e.begin(s, number, nullptr); !e.done(); e.advance()) {
        const channel_drive& d = e.event().drive[0];
        peak = std::max({peak, std::abs(d.from), std::abs(d.to)});
    }
    return peak;
}

/// Sums what the items may reach; `exact`: also where the intensity of a continuous stroke is a bound.
sweep sweep_items(const score::impl& s, bool exact)
{
    sweep all(s.tactors.size());
    const item_list& list = s.list;
    for (std::size_t i = 0; i < list.items.size(); ++i) {
        const item& it = list.items[i];
        const std::uint64_t from = s.heard_from(it);
        switch (it.kind) {
        case item_kind::joined:
            all.note(it.tactor, it, from, joined_peak(s, i), s.equalised(it.tactor, it.plan, it.start));
            break;
        case item_kind::continuous: {
            const plan& p = s.plans[it.plan].plan;
            std::vector<double> peaks =
                exact ? std::vector<double>{} : continuous_bounds(p, s.tactors.size());
            if (peaks.empty())
                peaks = continuous_peaks(p, s.tactors.size());
            for (std::size_t k = 0; k < peaks.size(); ++k) {
                const double factor = s.most_equalised(k, it.plan); // at the carrier that needs most
                all.note(k, it, from, peaks[k] * (std::abs(s.tactors[k].gain) * factor), factor);
            }
            break;
        }
        case item_kind::marker:
            break;
        case item_kind::burst:
            for (std::size_t k = it.first; k < it.first + it.count; ++k) {
                const std::size_t tactor = list.drive_tactors[k];
                const double factor = s.equalised(tactor, it.plan, it.start);
                const double gain = s.tactors[tactor].gain * factor;
                all.note(tactor, it, from, std::abs(list.drive_amplitudes[k] * gain), factor);
            }
            break;
        }
    }
    return all;
}

/// `factor`: as sweep::factors().
void check(const array& a, std::size_t i, double peak, double factor, const render_options& o)
{
    const double limit_db = std::min(0.0, a.tactors[i].max_dbfs);
    if (peak <= tactor_limit(a, i))
        return;
    const double excess_db = std::max(0.01, std::ceil((in_db(peak) - limit_db) * 100.0) / 100.0);
    const bool limited = limit_db < 0.0;
    const std::string limit =
        limited ? fmt::format("its limit of {:.4g} dBFS (max_dbfs)", limit_db) : "full scale (0 dBFS)";
    const std::string driven = fmt::format("would be driven at {:.4g} dBFS, above {}", in_db(peak), limit);
    const char* raise = limited ? ", or raise max_dbfs" : "";
    if (o.sl_db)
        refuse_tactor(a, i, o,
                      fmt::format("{}: with its threshold of {:.4g} dBFS {:.2f} dB are missing", driven,
                                  threshold_at(a.tactors[i], reference_hz).value_or(0.0) + in_db(factor),
                                  excess_db),
                      fmt::format("lower {{sl_db}} by {:.2f} dB or more{}", excess_db, raise));
    refuse_tactor(
        a, i, o, driven,
        fmt::format("lower {{level_dbfs}} or the tactor's gain_db by {:.2f} dB or more{}", excess_db, raise));
}

/// Refuses drives that cannot be rendered. A curve has them in order of tactor.
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
    const trajectory* motion = curve_access::of(*p.curve).bounds(tactors);
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

std::vector<double> check_peaks(score::impl& s, const array& a, const render_options& o)
{
    const auto within = [&](const std::vector<double>& peaks) {
        for (std::size_t i = 0; i < peaks.size(); ++i)
            if (!(peaks[i] <= tactor_limit(a, i)))
                return false;
        return std::none_of(s.unmeasured.begin(), s.unmeasured.end(),
                            [&](std::size_t i) { return peaks[i] > 0.0; });
    };
    // Nearly always the intensities say that all is well, and hours need not be looked through.
    sweep all = sweep_items(s, false);
    if (!within(all.peaks()))
        all = sweep_items(s, true);
    const std::vector<double>& peaks = all.peaks();
    for (const std::size_t i : s.unmeasured)
        if (peaks[i] > 0.0)
            refuse_unmeasured(a, i, o);
    for (std::size_t i = 0; i < peaks.size(); ++i)
        check(a, i, peaks[i], all.factors()[i], o);
    for (const std::size_t i : s.unmeasured)
        s.tactors[i].gain = 0.0; // nothing may sound there at full scale
    return peaks;
}

} // namespace tactor::synth

namespace tactor {
inline namespace v0 {

std::uint64_t score::impl::heard_from(const synth::item& it) const noexcept
{
    const bool joined = it.kind == synth::item_kind::joined;
    const std::uint32_t ramp = joined ? list.members[it.first].ramp : it.ramp;
    const waveform_kind wave = plans[it.plan].plan.wave.kind;
    const bool at_zero = (phase == phase_kind::burst || it.start == starts[it.plan]) &&
                         wave != waveform_kind::noise && wave != waveform_kind::recording;
    return it.start + (it.length > 1 && (ramp > 0 || at_zero) ? 1 : 0);
}

} // namespace v0
} // namespace tactor
