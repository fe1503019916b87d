// SPDX-License-Identifier: MIT
#include "plot/timing_bars.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "plot/array_view.hpp"
#include "plot/dimensions.hpp"

namespace tactor::plot {
namespace {

constexpr std::size_t most_bars = 2500;
constexpr double narrowest_bar = 0.9; // pt
constexpr std::size_t most_hatches = 200;
constexpr double seen_through = 0.7;

std::size_t row_of(const timing_frame& f, unsigned tactor)
{
    return static_cast<std::size_t>(f.rows.row_of[tactor]);
}

// Whether bars of one row overlap: only then must one show through the other.
bool rows_overlap(const timeline& t, const timing_frame& f)
{
    std::vector<double> ends(f.rows.rows.size(), -1.0);
    for (const shown_burst& b : t.bursts)
        for (const drive& d : b.what->drives) {
            double& end = ends[row_of(f, d.tactor)];
            if (b.from_s < end - 1e-9)
                return true;
            end = std::max(end, b.to_s);
        }
    return false;
}

// Calls note(burst, time) for instants of a continuous plan, two to a column of the page.
template <class Note>
void look_up(const plan& p, const scale& x, Note&& note)
{
    const double columns = p.stroke_duration_s * x.per_unit() / column_width;
    const auto n = static_cast<std::size_t>(std::clamp(columns * 2.0, 1.0, 20000.0));
    burst b;
    for (std::size_t k = 0; k < n; ++k) {
        const double at = p.stroke_duration_s * (static_cast<double>(k) + 0.5) / static_cast<double>(n);
        p.at(at, b);
        note(b, at);
    }
}

} // namespace

bool too_dense(const timeline& t, const timing_frame& f)
{
    std::size_t bars = 0;
    std::size_t narrow = 0;
    for (const shown_burst& b : t.bursts) {
        bars += b.what->drives.size();
        narrow += (b.to_s - b.from_s) * f.x.per_unit() < narrowest_bar ? 1 : 0;
    }
    return t.sampled || bars > most_bars || 2 * narrow > t.bursts.size() ||
           f.rows.rows.size() < t.playing.size();
}

void draw_bars(canvas& c, const timeline& t, const timing_frame& f)
{
    const double alpha = rows_overlap(t, f) ? seen_through : 1.0;
    for (const shown_burst& b : t.bursts) {
        const colour fill = with_alpha(time_colour(t, b.target_s), alpha);
        for (const drive& d : b.what->drives) {
            const double h = f.bar_height(d.amplitude);
            c.rect(
                {f.x(b.from_s), f.base_of(row_of(f, d.tactor)) - h, (b.to_s - b.from_s) * f.x.per_unit(), h},
                {.fill = fill, .stroke = ink, .width = 0.3},
                {.kind = "bar",
                 .data = {{"burst", fmt::format("{}", b.number)}, {"tactor", fmt::format("{}", d.tactor)}}});
        }
    }
}

void draw_columns(canvas& c, const scene& s, const timeline& t, const timing_frame& f)
{
    std::vector<column_profile> profiles(f.rows.rows.size(), column_profile(f.x));
    const auto note = [&](const burst& b, double from, double to) {
        for (const drive& d : b.drives)
            if (f.rows.row_of[d.tactor] >= 0)
                profiles[row_of(f, d.tactor)].add(from, to, d.amplitude);
    };
    for (const shown_burst& b : t.bursts)
        if (b.to_s > b.from_s)
            note(*b.what, b.from_s, b.to_s);
    for (std::size_t i = 0; i < s.plans.size(); ++i)
        if (const plan& p = s.plans[i].schedule; p.at)
            look_up(p, f.x,
                    [&](const burst& b, double at) { note(b, t.starts_s[i] + at, t.starts_s[i] + at); });
    const style look = t.sampled ? style{.fill = grey, .stroke = ink, .width = 0.5}
                                 : style{.fill = dark_grey, .stroke = ink, .width = 0.1};
    for (std::size_t i = 0; i < profiles.size(); ++i)
        for (std::vector<spot>& shape : profiles[i].outlines(f.base_of(i), f.bar_height(1.0), t.sampled))
            c.poly(std::move(shape), true, look,
                   {.kind = "envelope", .data = {{"row", fmt::format("{}", i)}}});
}

bool draw_conflicts(canvas& c, const scene& s, const timeline& t, const timing_frame& f)
{
    const group g(c, {.id = "conflicts"});
    std::size_t drawn = 0;
    const double h = f.bar_height(f.peak);
    for (std::size_t i = 0; i < s.plans.size(); ++i)
        for (const conflict& k : s.plans[i].schedule.conflicts) {
            if (f.rows.row_of[k.tactor] < 0 || drawn == most_hatches)
                continue;
            ++drawn;
            draw_hatch(c,
                       {f.x(t.starts_s[i] + k.from_s), f.base_of(row_of(f, k.tactor)) - h,
                        (k.to_s - k.from_s) * f.x.per_unit(), h},
                       {.kind = "conflict", .data = {{"tactor", fmt::format("{}", k.tactor)}}});
        }
    return drawn != 0;
}

} // namespace tactor::plot
