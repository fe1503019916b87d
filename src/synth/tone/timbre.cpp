// SPDX-License-Identifier: MIT
#include "synth/tone/timbre.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/clones.hpp"
#include "synth/tone/own_samples.hpp"
#include "synth/wave/oscillator.hpp"

namespace tactor::synth {

namespace {

/// Computes the turns of a carrier in n frames from the stroke's frame `first` on. Takes the part by value,
/// so that the compiler knows that writing to `out` does not change it.
void compute_turns(course_part p, double first, unsigned n, double* out) noexcept
{
    const double from = first - p.start;
    const double unit = 1.0 / p.frames;
    const std::array<double, 6>& c = p.bent;
    for (int j = 0; j < static_cast<int>(n); ++j) {
        const double k = from + j;
        const double u = k * unit;
        out[j] = p.frames > 0.0
                     ? p.cycles + u * (c[0] + u * (c[1] + u * (c[2] + u * (c[3] + u * (c[4] + u * c[5])))))
                     : p.cycles + k * (p.cycles_per_frame + k * p.half_slope);
    }
}

TACTOR_CLONES void sines(const double* turns, unsigned n, bool cosine, double* out) noexcept
{
    const double* __restrict in = turns;
    double* __restrict o = out;
    const double ahead = cosine ? 0.25 : 0.0;
    for (int j = 0; j < static_cast<int>(n); ++j)
        o[j] = sincos_turns(in[j] + ahead).sin;
}

void read_loop(const wave_samples& loop, std::int64_t first, unsigned n, double* out) noexcept
{
    const auto size = static_cast<std::int64_t>(loop.size());
    auto at = static_cast<std::size_t>(((first % size) + size) % size);
    while (n > 0) {
        const auto length = static_cast<unsigned>(std::min<std::size_t>(n, loop.size() - at));
        out = std::copy_n(loop.data() + at, length, out);
        n -= length;
        at = 0;
    }
}

/// Replaces x by the second wave that makes the envelope equal in all frames.
void complete_envelope(double power, unsigned n, double* x) noexcept
{
    std::transform(x, x + n, x, [power](double v) { return std::sqrt(std::max(power - v * v, 0.0)); });
}

void play(const timbre& t, const double* turns, unsigned n, wave w, double* out) noexcept
{
    if (t.is_sine())
        sines(turns, n, w == wave::cosine, out);
    else
        read_cycle(*t.samples, turns, n, out);
}

using course_parts = std::vector<course_part>;

/// Returns the first part that begins after a frame.
course_parts::const_iterator find_part_after(const course_parts& course, double frame) noexcept
{
    return std::upper_bound(course.begin(), course.end(), frame,
                            [](double at, const course_part& p) { return at < p.start; });
}

/// Returns the part that ends where `next` begins, or the first part if `next` is the first.
const course_part& part_before(const course_parts& course, course_parts::const_iterator next) noexcept
{
    return next == course.begin() ? *next : *(next - 1);
}

/// Returns the turns of the carrier at a frame, except for a whole number.
double turns_at(const course_parts& course, double frame) noexcept
{
    double turns = 0.0;
    compute_turns(part_before(course, find_part_after(course, frame)), frame, 1, &turns);
    return turns;
}

/// Computes each frame from its own place on the carrier, so that results do not depend on blocks.
void follow(const timbre& t, std::int64_t first, std::int64_t origin, unsigned n, wave w,
            double* out) noexcept
{
    alignas(64) block turns;
    if (t.course.empty()) {
        const auto from = static_cast<double>(first - origin);
        for (int j = 0; j < static_cast<int>(n); ++j)
            turns[static_cast<std::size_t>(j)] = (from + j) * t.cycles_per_frame;
        play(t, turns.data(), n, w, out);
        return;
    }
    const double turned = origin == 0 ? 0.0 : turns_at(t.course, static_cast<double>(origin));
    auto next = find_part_after(t.course, static_cast<double>(first));
    for (unsigned done = 0; done < n;) {
        const auto at = static_cast<double>(first + done);
        while (next != t.course.end() && next->start <= at)
            ++next;
        course_part p = part_before(t.course, next);
        p.cycles -= turned;
        unsigned length = n - done;
        if (next != t.course.end())
            length = static_cast<unsigned>(std::min<double>(length, std::ceil(next->start - at)));
        if (p.rests()) {
            std::fill_n(out + done, length, 0.0); // a constant would displace the tactor
        } else {
            compute_turns(p, at, length, turns.data());
            play(t, turns.data(), length, w, out + done);
        }
        done += length;
    }
}

} // namespace

TACTOR_CLONES void read_cycle(const wave_samples& cycle, const double* turns, unsigned n,
                              double* out) noexcept
{
    const auto points = static_cast<double>(cycle.size() - cycle_margin);
    const float* __restrict x = cycle.data();
    const double* __restrict in = turns;
    double* __restrict o = out;
    for (int j = 0; j < static_cast<int>(n); ++j) {
        const double place = (in[j] - nearest(in[j]) + 0.5) * points;
        const int i = static_cast<int>(place);
        const double t = place - i;
        const auto a = static_cast<double>(x[i]);
        const auto b = static_cast<double>(x[i + 1]);
        const auto c = static_cast<double>(x[i + 2]);
        const auto d = static_cast<double>(x[i + 3]);
        const double cubic = (d - a) * (1.0 / 6.0) + (b - c) * 0.5;
        const double square = (a + c) * 0.5 - b;
        const double line = c - a * (1.0 / 3.0) - b * 0.5 - d * (1.0 / 6.0);
        o[j] = b + t * (line + t * (square + t * cubic));
    }
}

void timbre::fill(std::int64_t first, std::int64_t origin, unsigned n, double* out, wave w) const noexcept
{
    if (form == form_kind::own) {
        own->read(first, n, out);
        if (w == wave::cosine)
            own->complete_envelope(first, n, out);
        return;
    }
    if (form == form_kind::loop)
        read_loop(*samples, first, n, out);
    else
        follow(*this, first, origin, n, w, out);
    if (w == wave::cosine && !is_sine())
        complete_envelope(power, n, out);
}

void modulate_block(oscillator_tables& tables, double cycles_per_frame, double depth, std::int64_t first,
                    unsigned n, double* out) noexcept
{
    const oscillator_table& t = tables.get(cycles_per_frame);
    const double whole = 1.0 / (1.0 + depth);
    for_each_part(first, 0, n, [&](const table_part& p) {
        // A sine is a cosine delayed by a quarter of a cycle.
        const sine_cosine base = sincos_turns(static_cast<double>(p.base) * cycles_per_frame - 0.25);
        apply_cosine_factor(t, base, whole, depth * whole, p, out);
    });
}

} // namespace tactor::synth
