// SPDX-License-Identifier: MIT
#include "pieces.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace bench {

using namespace tactor;

namespace {

constexpr int repeats = 20;
constexpr double level = 0.05;
constexpr double two_pi = 6.283185307179586477;

plan field_plan(const array& a, int i)
{
    const point from{20.0 * (i % 7) + 3.0, 20.0 * (i / 8 % 7) + 2.0};
    const point to{from.x_mm + 12.0, from.y_mm + 9.0};
    const point ends[] = {from, to};
    return make_plan(a, {"", trajectory::along(path::polyline(ends), 1.4), {}, 150.0 + 2.0 * i, ""});
}

render_options field_levels()
{
    render_options o;
    o.level_dbfs = 20.0 * std::log10(level) - 20.0;
    return o;
}

} // namespace

score palm()
{
    const array a = preset_array("palm-3x3");
    const plan p = make_plan(a, preset_stroke("park2016-1"));
    render_options o;
    o.level_dbfs = 20.0 * std::log10(level);
    return {a, std::vector<placed_plan>(repeats, placed_plan{p, {}}), o};
}

score field()
{
    const array a = make_grid("field", 8, 8, 20.0, 20.0);
    std::vector<placed_plan> plans;
    for (int r = 0; r < repeats; ++r) {
        for (int i = 0; i < 64; ++i)
            plans.push_back({field_plan(a, i), 1.5 * r});
    }
    return {a, plans, field_levels()};
}

std::vector<score> strokes_64()
{
    const array a = make_grid("field", 8, 8, 20.0, 20.0);
    std::vector<score> all;
    for (int i = 0; i < 64; ++i)
        all.emplace_back(a, std::vector<placed_plan>{{field_plan(a, i), {}}}, field_levels());
    return all;
}

plain_loop::plain_loop(const score& s) : frames_(s.frames()), channels_(s.channels()), rate_(s.rate())
{
    for (std::size_t i = 0; i < s.plans().size(); ++i) {
        const plan& p = s.plans()[i].schedule;
        for (const burst& b : p.bursts) {
            const auto from = s.starts()[i] + static_cast<std::uint64_t>(std::llround(b.onset_s * rate_));
            const auto to = from + static_cast<std::uint64_t>(std::llround(b.duration_s * rate_));
            longest_ = std::max(longest_, to - from);
            for (const drive& d : b.drives) {
                tones_.push_back({from, to, d.tactor, level * d.amplitude, p.carrier_hz});
            }
        }
    }
    std::sort(tones_.begin(), tones_.end(), [](const tone& a, const tone& b) { return a.start < b.start; });
}

void plain_loop::process(std::size_t frames, float* out)
{
    std::memset(out, 0, frames * channels_ * sizeof(float));
    const std::uint64_t end = position_ + frames;
    while (first_ < tones_.size() && tones_[first_].start + longest_ <= position_) {
        ++first_;
    }
    for (std::size_t i = first_; i < tones_.size() && tones_[i].start < end; ++i) {
        const tone& t = tones_[i];
        for (std::uint64_t k = std::max(t.start, position_); k < std::min(t.end, end); ++k) {
            const double angle = two_pi * t.hz * static_cast<double>(k - t.start) / rate_;
            out[(k - position_) * channels_ + t.channel] += static_cast<float>(t.amplitude * std::sin(angle));
        }
    }
    position_ = end;
}

} // namespace bench
