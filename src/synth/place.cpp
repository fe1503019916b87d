// SPDX-License-Identifier: MIT
#include "synth/place.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/words.hpp>

#include "synth/frames.hpp"

namespace tactor::synth {

namespace {

constexpr double longest_plan_s = 1e6;

/// One drive of one burst: what has to be looked at for overlaps.
struct use {
    std::uint32_t tactor;
    double from_s;
    double to_s;
    std::size_t burst;
    item_member member;
};

[[noreturn]] void refuse(std::size_t number, const std::string& why)
{
    throw error(errc::bad_input, fmt::format("burst {} of the plan", number + 1), why);
}

void check(const burst& b, std::size_t number, std::size_t tactors)
{
    if (!(b.onset_s >= 0.0 && b.duration_s >= 0.0 && b.onset_s + b.duration_s <= longest_plan_s)) {
        refuse(number, fmt::format("it starts at {} and lasts {}", seconds_text(b.onset_s),
                                   seconds_text(b.duration_s)));
    }
    if (!std::isfinite(b.intensity)) {
        refuse(number, fmt::format("its intensity is {}", b.intensity));
    }
    for (const drive& d : b.drives) {
        if (d.tactor >= tactors) {
            refuse(number, fmt::format("tactor {} is not in the array, which has {}", d.tactor, tactors));
        }
        if (!std::isfinite(d.amplitude)) {
            refuse(number, fmt::format("the amplitude of tactor {} is {}", d.tactor, d.amplitude));
        }
    }
}

/// All drives by tactor, then by start.
std::vector<use> uses_of(const plan& p, std::uint64_t start, std::size_t tactors, const render_options& o)
{
    std::vector<use> uses;
    for (std::size_t i = 0; i < p.bursts.size(); ++i) {
        const burst& b = p.bursts[i];
        check(b, i, tactors);
        const double end_s = b.onset_s + b.duration_s;
        const std::uint64_t from = frame_at(b.onset_s, o.rate);
        const std::uint64_t length = frame_at(end_s, o.rate) - from;
        const std::uint32_t ramp =
            ramp_frames(burst_ramp_s(b.onset_s, b.duration_s, p.carrier_hz, o), o.rate, length);
        for (const drive& d : b.drives) {
            if (length > 0) {
                uses.push_back(
                    {d.tactor, b.onset_s, end_s, i, {start + from, length, ramp, d.amplitude, b.intensity}});
            }
        }
    }
    std::stable_sort(uses.begin(), uses.end(), [](const use& a, const use& b) {
        return a.tactor != b.tactor ? a.tactor < b.tactor : a.member.start < b.member.start;
    });
    return uses;
}

/// End of the run of uses from i on that overlap with one before them on the same tactor.
std::size_t run_end(const std::vector<use>& uses, std::size_t i)
{
    constexpr double touch_s = 1e-9;
    std::uint64_t end = uses[i].member.end();
    double end_s = uses[i].to_s;
    std::size_t next = i + 1;
    for (; next < uses.size() && uses[next].tactor == uses[i].tactor; ++next) {
        if (uses[next].member.start >= end || uses[next].from_s >= end_s - touch_s) {
            break;
        }
        end = std::max(end, uses[next].member.end());
        end_s = std::max(end_s, uses[next].to_s);
    }
    return next;
}

void append_joined(const std::vector<use>& uses, std::size_t from, std::size_t to, std::uint32_t plan,
                   item_list& out)
{
    item it;
    it.kind = item_kind::joined;
    it.plan = plan;
    it.tactor = uses[from].tactor;
    it.start = uses[from].member.start;
    it.first = out.members.size();
    it.count = to - from;
    for (std::size_t i = from; i < to; ++i) {
        out.members.push_back(uses[i].member);
        it.length = std::max(it.length, uses[i].member.end() - it.start);
    }
    out.items.push_back(it);
}

/// The drives that are in no group, burst by burst.
void append_bursts(std::vector<use>& single, std::uint32_t plan, item_list& out)
{
    std::stable_sort(single.begin(), single.end(),
                     [](const use& a, const use& b) { return a.burst < b.burst; });
    for (std::size_t i = 0; i < single.size();) {
        const item_member& m = single[i].member;
        item it;
        it.start = m.start;
        it.length = m.length;
        it.ramp = m.ramp;
        it.plan = plan;
        it.first = out.drives.size();
        const std::size_t number = single[i].burst;
        for (; i < single.size() && single[i].burst == number; ++i) {
            out.drives.push_back({single[i].tactor, single[i].member.amplitude});
        }
        it.count = out.drives.size() - it.first;
        out.items.push_back(it);
    }
}

std::uint64_t place_bursts(const plan& p, std::uint32_t plan, std::uint64_t start, std::size_t tactors,
                           const render_options& o, item_list& out)
{
    const std::vector<use> uses = uses_of(p, start, tactors, o);
    std::vector<use> single;
    std::uint64_t end = start;
    for (std::size_t i = 0; i < uses.size();) {
        const std::size_t next = run_end(uses, i);
        if (next - i > 1) {
            append_joined(uses, i, next, plan, out);
        } else {
            single.push_back(uses[i]);
        }
        for (; i < next; ++i) {
            end = std::max(end, uses[i].member.end());
        }
    }
    append_bursts(single, plan, out);
    return end;
}

} // namespace

std::uint64_t place_plan(const plan& p, std::uint32_t plan, std::uint64_t start, std::size_t tactors,
                         const render_options& o, item_list& out)
{
    for (const double s : {p.total_s, p.stroke_duration_s}) {
        if (!(s >= 0.0 && s <= longest_plan_s)) {
            throw error(errc::bad_input, "plan", "it lasts " + seconds_text(s),
                        fmt::format("between 0 and {} s can be rendered", longest_plan_s));
        }
    }
    const std::uint64_t total = start + frame_at(p.total_s, o.rate);
    if (!p.at) {
        return std::max(total, place_bursts(p, plan, start, tactors, o, out));
    }
    item it;
    it.kind = item_kind::continuous;
    it.start = start;
    it.length = frame_at(p.stroke_duration_s, o.rate);
    it.ramp = ramp_frames(o.ramp_s, 0.0, p.stroke_duration_s, p.carrier_hz, o.rate, it.length);
    it.plan = plan;
    if (it.length > 0) {
        out.items.push_back(it);
    }
    return std::max(total, it.end());
}

} // namespace tactor::synth

namespace tactor {

double burst_ramp_s(double onset_s, double duration_s, double carrier_hz, const render_options& o) noexcept
{
    const double carrier_s = o.phase == phase_mode::stroke ? onset_s : 0.0;
    return synth::ramp_seconds(o.ramp_s, carrier_s, duration_s, carrier_hz);
}

} // namespace tactor
