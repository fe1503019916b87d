// SPDX-License-Identifier: MIT
#include "plot/draw/timing_bars.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "plot/draw/axes.hpp"
#include "plot/draw/timeline.hpp"

namespace tactor::plot {
namespace {

constexpr std::size_t most_bars = 2500;
constexpr double narrowest_bar = 0.9; // pt
constexpr std::size_t most_hatches = 200;
constexpr std::size_t most_parted = 60; // strokes
constexpr std::size_t most_levels = 200;
constexpr double seen_through = 0.7;
constexpr const char* not_parted = "strokes on one tactor lie on each other";

std::size_t find_row(const timing_frame& f, unsigned tactor)
{
    return static_cast<std::size_t>(f.rows.row_by_tactor[tactor]);
}

// Time in which a stroke plays on a row.
struct stay {
    std::size_t stroke = 0;
    double from_s = 0.0;
    double to_s = 0.0;
};

// Returns the stays by row, in the order of their starts.
std::vector<std::vector<stay>> stays(const timing_frame& f, const timeline& t)
{
    std::vector<std::vector<stay>> all(f.rows.rows.size());
    for (const shown_burst& b : t.bursts)
        for (const drive& d : b.what->drives) {
            // An instant of a continuous stroke means the time up to its neighbours.
            const double more = b.to_s > b.from_s ? 0.0 : t.sample_s;
            const stay s{b.stroke, b.from_s - more, b.to_s + more};
            std::vector<stay>& row = all[find_row(f, d.tactor)];
            const auto known =
                std::find_if(row.rbegin(), row.rend(), [&](const stay& x) { return x.stroke == b.stroke; });
            if (known == row.rend())
                row.push_back(s);
            else
                *known = {b.stroke, std::min(known->from_s, s.from_s), std::max(known->to_s, s.to_s)};
        }
    for (std::vector<stay>& row : all)
        std::sort(row.begin(), row.end(), [](const stay& a, const stay& b) {
            return a.from_s != b.from_s ? a.from_s < b.from_s : a.stroke < b.stroke;
        });
    return all;
}

// Returns true if bars of one row overlap: only then must one show through the other.
bool rows_overlap(const timeline& t, const timing_frame& f)
{
    // Strokes that could lie on each other have levels of their own.
    const std::size_t strokes = f.levels.empty() ? 1 : t.starts_s.size();
    std::vector<double> ends(f.rows.rows.size() * strokes, -1.0);
    for (const shown_burst& b : t.bursts)
        for (const drive& d : b.what->drives) {
            double& end = ends[find_row(f, d.tactor) * strokes + (strokes == 1 ? 0 : b.stroke)];
            if (b.from_s < end - 1e-9)
                return true;
            end = std::max(end, b.to_s);
        }
    return false;
}

// Calls note(burst, time) for instants of a continuous plan, two for each column of the page.
template <class Note>
void sample_curve(const plan& p, const scale& x, Note&& note)
{
    const double columns = p.stroke_duration_s * x.per_unit() / column_width;
    const auto n = static_cast<std::size_t>(std::clamp(columns * 2.0, 1.0, 20000.0));
    burst b;
    for (std::size_t k = 0; k < n; ++k) {
        const double at = p.stroke_duration_s * (static_cast<double>(k) + 0.5) / static_cast<double>(n);
        p.curve->at(at, b);
        note(b, at);
    }
}

} // namespace

std::string part_strokes(timing_frame& f, const timeline& t, double space)
{
    const std::size_t strokes = t.starts_s.size();
    if (strokes < 2)
        return {};
    if (strokes > most_parted || f.rows.rows.size() < t.playing.size())
        return not_parted;
    const auto all = stays(f, t);
    f.levels.assign(all.size(), std::vector<std::size_t>(strokes, 0));
    std::size_t wanted = 0;
    for (std::size_t row = 0; row < all.size(); ++row) {
        std::vector<double> ends; // by level
        for (const stay& s : all[row]) {
            const auto free =
                std::find_if(ends.begin(), ends.end(), [&](double end) { return end <= s.from_s + 1e-9; });
            f.levels[row][s.stroke] = static_cast<std::size_t>(free - ends.begin());
            if (free == ends.end())
                ends.push_back(s.to_s);
            else
                *free = s.to_s;
        }
        f.rows.rows[row].levels = std::max<std::size_t>(1, ends.size());
        wanted += f.rows.rows[row].levels;
    }
    if (wanted <= most_levels && (f.rows.fit(space) || wanted == all.size()))
        return {};
    // The page would be too long: strokes lie on each other, and show through.
    f.levels.clear();
    for (lane& r : f.rows.rows)
        r.levels = 1;
    f.rows.fit(space);
    return not_parted;
}

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
        const colour fill = with_alpha(burst_colour(t, b), alpha);
        for (const drive& d : b.what->drives) {
            const double h = f.bar_height(d.amplitude);
            c.rect({f.x(b.from_s), f.base_y(find_row(f, d.tactor), b.stroke) - h,
                    (b.to_s - b.from_s) * f.x.per_unit(), h},
                   {.fill = fill, .stroke = ink, .width = 0.3},
                   {.kind = "bar",
                    .data = {{"burst", fmt::format("{}", b.number)},
                             {"tactor", fmt::format("{}", d.tactor)},
                             {"stroke", fmt::format("{}", b.stroke)}}});
        }
    }
}

void draw_columns(canvas& c, const scene& s, const timeline& t, const timing_frame& f)
{
    // Draws each stroke separately if it has a colour; else all together.
    const bool by_stroke = !f.levels.empty();
    std::vector<std::vector<column_profile>> profiles(
        by_stroke ? s.plans.size() : 1, std::vector<column_profile>(f.rows.rows.size(), column_profile(f.x)));
    const auto note = [&](std::size_t stroke, const burst& b, double from, double to) {
        for (const drive& d : b.drives)
            if (f.rows.row_by_tactor[d.tactor] >= 0)
                profiles[by_stroke ? stroke : 0][find_row(f, d.tactor)].add(from, to, d.amplitude);
    };
    for (const shown_burst& b : t.bursts)
        if (b.to_s > b.from_s)
            note(b.stroke, *b.what, b.from_s, b.to_s);
    for (std::size_t i = 0; i < s.plans.size(); ++i)
        if (const plan& p = s.plans[i].plan; p.curve)
            sample_curve(p, f.x, [&](const burst& b, double at) {
                note(i, b, t.starts_s[i] + at, t.starts_s[i] + at);
            });
    style look = t.sampled ? style{.fill = grey, .stroke = ink, .width = 0.5}
                           : style{.fill = dark_grey, .stroke = ink, .width = 0.1};
    for (std::size_t stroke = 0; stroke < profiles.size(); ++stroke) {
        if (by_stroke)
            look.fill = stroke_colour(t.looks[stroke]);
        for (std::size_t i = 0; i < f.rows.rows.size(); ++i)
            for (std::vector<spot>& shape :
                 profiles[stroke][i].outlines(f.base_y(i, stroke), f.bar_height(1.0), t.sampled))
                c.poly(std::move(shape), true, look,
                       {.kind = "envelope", .data = {{"row", fmt::format("{}", i)}}});
    }
}

bool draw_conflicts(canvas& c, const scene& s, const timeline& t, const timing_frame& f)
{
    const group g(c, {.id = "conflicts"});
    std::size_t drawn = 0;
    const double h = f.bar_height(f.peak);
    for (std::size_t i = 0; i < s.plans.size(); ++i)
        for (const conflict& k : s.plans[i].plan.conflicts) {
            if (f.rows.row_by_tactor[k.tactor] < 0 || drawn == most_hatches)
                continue;
            ++drawn;
            draw_hatch(c,
                       {f.x(t.starts_s[i] + k.from_s), f.base_y(find_row(f, k.tactor), i) - h,
                        (k.to_s - k.from_s) * f.x.per_unit(), h},
                       {.kind = "conflict", .data = {{"tactor", fmt::format("{}", k.tactor)}}});
        }
    return drawn != 0;
}

} // namespace tactor::plot
