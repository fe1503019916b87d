// SPDX-License-Identifier: MIT
#include "plot/draw/timeline.hpp"

#include <algorithm>
#include <map>
#include <string_view>

#include "plot/draw/axes.hpp"

namespace tactor::plot {
namespace {

constexpr std::size_t most_instants = 24; // of `continuous`, shown as positions
constexpr std::size_t looked_at = 4000;   // instants of `continuous` at which playing tactors are looked up

class maker {
public:
    explicit maker(const scene& s) : scene_(s), plays_(s.tactors.tactors.size(), false) {}

    timeline make()
    {
        place();
        find_looks();
        for (std::size_t i = 0; i < scene_.plans.size(); ++i) {
            const plan& p = scene_.plans[i].plan;
            if (p.curve)
                add_instants(i, p);
            else
                add_bursts(i, p);
        }
        for (unsigned i = 0; i < plays_.size(); ++i)
            if (plays_[i])
                t_.playing.push_back(i);
        return std::move(t_);
    }

private:
    void place()
    {
        t_.starts_s = start_times_s(scene_.plans);
        for (std::size_t i = 0; i < scene_.plans.size(); ++i) {
            const plan& p = scene_.plans[i].plan;
            t_.ends_s.push_back(t_.starts_s[i] + p.total_s);
            t_.total_s = std::max(t_.total_s, t_.ends_s.back());
            t_.sampled = t_.sampled || p.curve.has_value();
        }
        t_.sample_s = nice_ticks(0.0, std::max(t_.total_s, 1e-6), most_instants + 1).step;
    }

    void find_looks()
    {
        std::map<std::string, std::size_t> repeated;
        std::size_t next = 0;
        for (const stroke& s : scene_.strokes) {
            const std::string name = find_repeated_name(s.name);
            const auto known = name.empty() ? repeated.end() : repeated.find(name);
            t_.looks.push_back(known == repeated.end() ? next++ : known->second);
            if (!name.empty())
                repeated.emplace(name, t_.looks.back());
        }
    }

    void note(const burst& b)
    {
        for (const drive& d : b.drives) {
            plays_[d.tactor] = true;
            t_.peak = std::max(t_.peak, d.amplitude);
        }
    }

    void add_bursts(std::size_t stroke, const plan& p)
    {
        const double start = t_.starts_s[stroke];
        for (const burst& b : p.bursts) {
            note(b);
            t_.bursts.push_back({t_.bursts.size(), stroke, start + b.onset_s,
                                 start + b.onset_s + b.duration_s, start + b.tau_s.value_or(b.onset_s), &b});
        }
    }

    void add_instants(std::size_t stroke, const plan& p)
    {
        const double start = t_.starts_s[stroke];
        for (double k = 0.0; k * t_.sample_s <= p.stroke_duration_s + 1e-9; k += 1.0) {
            const double at = std::min(k * t_.sample_s, p.stroke_duration_s);
            burst& b = t_.instants.emplace_back();
            p.curve->at(at, b);
            t_.bursts.push_back({t_.bursts.size(), stroke, start + at, start + at, start + at, &b});
        }
        burst b;
        const auto n = static_cast<std::size_t>(
            std::clamp(p.stroke_duration_s / continuous_step_s, 1.0, static_cast<double>(looked_at)));
        for (std::size_t i = 0; i <= n; ++i) {
            p.curve->at(p.stroke_duration_s * static_cast<double>(i) / static_cast<double>(n), b);
            note(b);
        }
    }

    const scene& scene_;
    timeline t_;
    std::vector<bool> plays_;
};

} // namespace

std::string find_repeated_name(const std::string& name)
{
    constexpr std::string_view digits = "0123456789";
    const std::size_t open = name.rfind(" (");
    const std::size_t number = open == std::string::npos ? open : name.find_first_not_of(digits, open + 2);
    if (number == std::string::npos || number == open + 2 || name.compare(number, 4, " of ") != 0)
        return {};
    const std::size_t end = name.find_first_not_of(digits, number + 4);
    return end + 1 == name.size() && name[end] == ')' && end > number + 4 ? name.substr(0, open) : "";
}

timeline make_timeline(const scene& s)
{
    return maker(s).make();
}

colour burst_colour(const timeline& t, const shown_burst& b) noexcept
{
    return t.several() ? stroke_colour(t.looks[b.stroke])
                       : ordered(t.total_s > 0.0 ? b.target_s / t.total_s : 0.0);
}

void draw_time_strip(canvas& c, box where)
{
    constexpr int steps = 128;
    const group g(c, {.id = "time-colours", .title = "colour of each time"});
    // Each part reaches to the end, so that no seam shows between two.
    for (int i = 0; i < steps; ++i) {
        const double part = static_cast<double>(i) / steps;
        c.rect({where.x + part * where.width, where.y, (1.0 - part) * where.width, where.height},
               {.fill = ordered((i + 0.5) / steps)});
    }
    c.rect(where, {.stroke = ink, .width = 0.4});
    const spot start{where.x, where.y + where.height / 2.0};
    if (c.loop_s > loop_pause_s)
        c.moving_circle(start, 0.6 * where.height, {.fill = white, .stroke = ink, .width = 0.9},
                        {0.0, 1.0 - loop_pause_s / c.loop_s, {start, {where.right(), start.y}}},
                        {.kind = "now"});
}

} // namespace tactor::plot
