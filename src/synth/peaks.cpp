// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <tuple>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "synth/continuous_items.hpp"
#include "synth/expander.hpp"
#include "synth/levels.hpp"

namespace tactor::synth {

namespace {

/// At a frame, a tactor's possible amplitude changes.
struct change {
    std::size_t tactor;
    std::uint64_t frame;
    double by;
};

/// What a continuous item asks of each tactor.
using continuous_peaks_of = std::function<const std::vector<double>&(std::size_t number)>;

/// The last frame does not count: of two bursts that touch, rounding may put the end of one into the first
/// frame of the other.
void note(std::vector<change>& changes, std::size_t tactor, const item& it, double peak)
{
    if (peak > 0.0 && it.length > 1) {
        changes.push_back({tactor, it.start, peak});
        changes.push_back({tactor, it.end() - 1, -peak});
    }
}

void note_joined(const score::impl& s, std::size_t number, std::vector<change>& changes)
{
    const item& it = s.list.items[number];
    double peak = 0.0;
    expander e;
    for (e.begin(s, number, nullptr); !e.done(); e.advance()) {
        const channel_drive& d = e.event().drive[0];
        peak = std::max({peak, std::abs(d.from), std::abs(d.to)});
    }
    note(changes, it.tactor, it, peak);
}

std::vector<change> changes_of(const score::impl& s, const continuous_peaks_of& continuous)
{
    std::vector<change> changes;
    for (std::size_t i = 0; i < s.list.items.size(); ++i) {
        const item& it = s.list.items[i];
        switch (it.kind) {
        case item_kind::joined:
            note_joined(s, i, changes);
            break;
        case item_kind::continuous: {
            const std::vector<double>& peaks = continuous(i);
            for (std::size_t k = 0; k < peaks.size(); ++k) {
                note(changes, k, it, peaks[k]);
            }
            break;
        }
        case item_kind::marker:
            break;
        case item_kind::burst:
            for (std::size_t k = it.first; k < it.first + it.count; ++k) {
                const item_drive& d = s.list.drives[k];
                note(changes, d.tactor, it, std::abs(d.amplitude * s.tactors[d.tactor].gain));
            }
            break;
        }
    }
    return changes;
}

/// Calls found(tactor, greatest sum) for each tactor that plays, until it gives false.
template <class Found>
bool sum_up(std::vector<change> changes, Found found)
{
    std::sort(changes.begin(), changes.end(), [](const change& x, const change& y) {
        return std::tie(x.tactor, x.frame, x.by) < std::tie(y.tactor, y.frame, y.by);
    });
    for (std::size_t i = 0; i < changes.size();) {
        const std::size_t tactor = changes[i].tactor;
        double sum = 0.0;
        double peak = 0.0;
        for (; i < changes.size() && changes[i].tactor == tactor; ++i) {
            sum += changes[i].by;
            peak = std::max(peak, sum);
        }
        if (!found(tactor, peak)) {
            return false;
        }
    }
    return true;
}

double in_db(double amplitude)
{
    return 20.0 * std::log10(amplitude);
}

void check(const array& a, std::size_t i, double peak, const render_options& o)
{
    const double limit_db = std::min(0.0, a.tactors[i].max_dbfs);
    if (peak <= tactor_limit(a, i)) {
        return;
    }
    const double excess_db = std::max(0.01, std::ceil((in_db(peak) - limit_db) * 100.0) / 100.0);
    const bool limited = limit_db < 0.0;
    const std::string limit =
        limited ? fmt::format("its limit of {:.4g} dBFS (max_dbfs)", limit_db) : "full scale (0 dBFS)";
    refuse_tactor(a, i, fmt::format("would be driven at {:.4g} dBFS, above {}", in_db(peak), limit),
                  fmt::format("lower {} by {:.2f} dB or more{}",
                              o.sl_db ? "sl_db" : "level_dbfs or the tactor's gain_db", excess_db,
                              limited ? ", or raise max_dbfs" : ""));
}

} // namespace

void check_peaks(const score::impl& s, const array& a, const render_options& o)
{
    continuous_items continuous(s, a);
    // Nearly always the intensities say that all is well, and hours need not be looked through.
    if (continuous.have_bounds() &&
        sum_up(changes_of(
                   s, [&](std::size_t i) -> const auto& { return continuous.bounds(i); }),
               [&](std::size_t tactor, double peak) { return peak <= tactor_limit(a, tactor); })) {
        return;
    }
    sum_up(changes_of(
               s, [&](std::size_t i) -> const auto& { return continuous.peaks(i); }),
           [&](std::size_t tactor, double peak) {
               check(a, tactor, peak, o);
               return true;
           });
}

} // namespace tactor::synth
