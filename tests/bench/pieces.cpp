// SPDX-License-Identifier: MIT
#include "pieces.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>
#include <map>

namespace bench {

using namespace tactor;

namespace {

constexpr double two_pi = 6.283185307179586477;

stroke across_a_face(unsigned i, unsigned faces_a_side)
{
    const point from{20.0 * (i % faces_a_side) + 3.0, 20.0 * (i / faces_a_side % faces_a_side) + 2.0};
    const point ends[] = {from, {from.x_mm + 12.0, from.y_mm + 9.0}};
    return {.motion = trajectory::along(path::polyline(ends), 1.4), .sound = {.carrier_hz = 150.0 + 2.0 * i}};
}

} // namespace

array square(unsigned channels)
{
    const auto side = static_cast<unsigned>(std::lround(std::sqrt(channels)));
    return make_grid("square", side, side, 20.0, 20.0);
}

std::vector<plan> strokes(const array& a, unsigned count, algorithm_kind algorithm)
{
    const layout l(a);
    const auto side = static_cast<unsigned>(std::lround(std::sqrt(a.tactors.size())));
    plan_options o;
    o.algorithm = algorithm;
    std::vector<plan> all;
    for (unsigned i = 0; i < count; ++i) {
        const stroke s = count == 1 ? preset_stroke("park2016-1") : across_a_face(i, side - 1);
        all.push_back(make_plan(a, l, s, o));
    }
    return all;
}

render_options levels(unsigned count)
{
    render_options o;
    o.level_dbfs = 20.0 * std::log10(0.2 / count);
    return o;
}

std::vector<placed_plan> plans(unsigned channels, unsigned count, algorithm_kind algorithm)
{
    const array a = square(channels);
    std::vector<placed_plan> placed;
    for (unsigned r = 0; r < std::max(1U, 8 / count); ++r)
        for (plan& p : strokes(a, count, algorithm))
            placed.push_back({std::move(p), 1.5 * r});
    return placed;
}

score piece(unsigned channels, unsigned count, algorithm_kind algorithm)
{
    return {square(channels), plans(channels, count, algorithm), levels(count)};
}

plain_loop::plain_loop(const score& s, const std::vector<placed_plan>& plans, double level)
    : frames_(s.frames()), channels_(s.channels()), rate_(s.rate())
{
    for (std::size_t i = 0; i < plans.size(); ++i) {
        const plan& p = plans[i].plan;
        add_bursts(p, s.starts()[i], level);
        if (p.curve)
            add_lines(p, s.starts()[i], level);
    }
    std::sort(tones_.begin(), tones_.end(), [](const tone& a, const tone& b) { return a.start < b.start; });
    for (const tone& t : tones_)
        longest_ = std::max(longest_, t.end - t.start);
}

void plain_loop::add_bursts(const plan& p, std::uint64_t start, double level)
{
    for (const burst& b : p.bursts) {
        const auto from = start + static_cast<std::uint64_t>(std::llround(b.onset_s * rate_));
        const auto to = from + static_cast<std::uint64_t>(std::llround(b.duration_s * rate_));
        for (const drive& d : b.drives)
            tones_.push_back({from, to, start, d.tactor, level * d.amplitude, 0.0, p.carrier_hz});
    }
}

void plain_loop::add_lines(const plan& p, std::uint64_t start, double level)
{
    const auto step = static_cast<std::uint64_t>(std::lround(continuous_step_s * rate_));
    const auto steps = static_cast<std::uint64_t>(std::lround(p.stroke_duration_s / continuous_step_s));
    std::map<unsigned, std::pair<double, double>> line; // amplitude here and at the next step
    burst here;
    burst next;
    p.curve->sample(0, here);
    for (std::uint64_t i = 0; i < steps; ++i) {
        p.curve->sample(i + 1, next);
        line.clear();
        for (const drive& d : here.drives)
            line[d.tactor].first = level * d.amplitude;
        for (const drive& d : next.drives)
            line[d.tactor].second = level * d.amplitude;
        for (const auto& [channel, ends] : line) {
            const double slope = (ends.second - ends.first) / static_cast<double>(step);
            const std::uint64_t from = start + i * step;
            tones_.push_back({from, from + step, start, channel, ends.first, slope, p.carrier_hz});
        }
        std::swap(here, next);
    }
}

void plain_loop::process(std::size_t frames, float* out)
{
    std::memset(out, 0, frames * channels_ * sizeof(float));
    const std::uint64_t end = position_ + frames;
    while (first_ < tones_.size() && tones_[first_].start + longest_ <= position_)
        ++first_;
    for (std::size_t i = first_; i < tones_.size() && tones_[i].start < end; ++i) {
        const tone& t = tones_[i];
        for (std::uint64_t k = std::max(t.start, position_); k < std::min(t.end, end); ++k) {
            const double amplitude = t.from + t.slope * static_cast<double>(k - t.start);
            const double angle = two_pi * t.hz * static_cast<double>(k - t.phase) / rate_;
            out[(k - position_) * channels_ + t.channel] += static_cast<float>(amplitude * std::sin(angle));
        }
    }
    position_ = end;
}

double cpu_s() noexcept
{
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

} // namespace bench
