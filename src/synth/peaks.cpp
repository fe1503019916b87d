// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "synth/expander.hpp"
#include "synth/frames.hpp"
#include "synth/levels.hpp"

namespace tactor::synth {

namespace {

constexpr std::uint64_t most_points = std::uint64_t{1} << 20;

/// At a frame, a tactor's possible amplitude changes.
struct change {
    std::size_t tactor;
    std::uint64_t frame;
    double by;
};

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

void note_continuous(const score::impl& s, const item& it, std::vector<change>& changes)
{
    const plan& p = s.plans[it.plan].schedule;
    const auto points = static_cast<std::uint64_t>(std::ceil(p.stroke_duration_s / continuous_step_s)) + 1;
    const std::uint64_t stride = points / most_points + 1;
    std::vector<double> peaks(s.tactors.size(), 0.0);
    burst b;
    for (std::uint64_t k = 0; k < points + stride - 1; k += stride) {
        const double t = std::min(static_cast<double>(k) * continuous_step_s, p.stroke_duration_s);
        p.at(t, b);
        check_drives(b, t, peaks.size());
        for (const drive& d : b.drives) {
            peaks[d.tactor] = std::max(peaks[d.tactor], std::abs(d.amplitude * s.tactors[d.tactor].gain));
        }
    }
    for (std::size_t i = 0; i < peaks.size(); ++i) {
        note(changes, i, it, peaks[i]);
    }
}

std::vector<change> changes_of(const score::impl& s)
{
    std::vector<change> changes;
    for (std::size_t i = 0; i < s.list.items.size(); ++i) {
        const item& it = s.list.items[i];
        switch (it.kind) {
        case item_kind::joined:
            note_joined(s, i, changes);
            break;
        case item_kind::continuous:
            note_continuous(s, it, changes);
            break;
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

double in_db(double amplitude)
{
    return 20.0 * std::log10(amplitude);
}

void check(const array& a, std::size_t i, double peak, const render_options& o)
{
    const double limit_db = std::min(0.0, a.tactors[i].max_dbfs);
    if (peak <= std::pow(10.0, limit_db / 20.0) * (1.0 + 1e-9)) {
        return;
    }
    const double excess_db = std::max(0.01, std::ceil((in_db(peak) - limit_db) * 100.0) / 100.0);
    const bool limited = limit_db < 0.0;
    const std::string limit =
        limited ? fmt::format("its limit of {:.4g} dBFS (max_dbfs)", limit_db) : "full scale (0 dBFS)";
    refuse_tactor(a, i, fmt::format("would be driven at {:.4g} dBFS, above {}", in_db(peak), limit),
                  fmt::format("lower {} by {:.2f} dB or more{}",
                              o.sl_db ? "--sl" : "--level-dbfs or the tactor's gain_db", excess_db,
                              limited ? ", or raise max_dbfs" : ""));
}

} // namespace

void check_peaks(const score::impl& s, const array& a, const render_options& o)
{
    std::vector<change> changes = changes_of(s);
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
        check(a, tactor, peak, o);
    }
}

} // namespace tactor::synth
