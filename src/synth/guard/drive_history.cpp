// SPDX-License-Identifier: MIT
#include "synth/guard/drive_history.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace tactor::synth {
namespace {

using driven_stretch = drive_history::stretch;

/// Joins stretches that overlap, and returns them in order.
std::vector<driven_stretch> apart(std::vector<driven_stretch> all)
{
    std::sort(all.begin(), all.end(),
              [](const driven_stretch& a, const driven_stretch& b) { return a.begin_s < b.begin_s; });
    std::vector<driven_stretch> out;
    for (const driven_stretch& s : all) {
        if (out.empty() || s.begin_s >= out.back().end_s) {
            out.push_back(s);
            continue;
        }
        driven_stretch& last = out.back();
        last.end_s = std::max(last.end_s, s.end_s);
        last.driven_s = std::min(last.driven_s + s.driven_s, last.end_s - last.begin_s);
    }
    return out;
}

} // namespace

void drive_history::pass(double seconds) noexcept
{
    for (channel& c : channels) {
        c.opens_s -= seconds;
        for (stretch& s : c.stretches) {
            s.begin_s -= seconds;
            s.end_s -= seconds;
        }
    }
}

void drive_history::end_now() noexcept
{
    for (channel& c : channels) {
        while (!c.stretches.empty() && c.stretches.back().begin_s >= 0.0)
            c.stretches.pop_back();
        if (!c.stretches.empty()) {
            driven_stretch& last = c.stretches.back();
            last.end_s = std::min(last.end_s, 0.0);
            last.driven_s = std::min(last.driven_s, last.end_s - last.begin_s);
        }
    }
}

void drive_history::add_ahead(std::size_t n, double seconds)
{
    drive_history ahead;
    ahead.channels.resize(n, {.stretches = {{0.0, seconds, seconds}}});
    *this = together(*this, ahead);
}

bool drive_history::empty() const noexcept
{
    return std::all_of(channels.begin(), channels.end(), [](const channel& c) { return c.empty(); });
}

drive_history together(const drive_history& a, const drive_history& b)
{
    drive_history sum = a;
    sum.channels.resize(std::max(a.channels.size(), b.channels.size()));
    for (std::size_t i = 0; i < b.channels.size(); ++i) {
        drive_history::channel& into = sum.channels[i];
        const drive_history::channel& more = b.channels[i];
        into.opens_s = std::max(into.opens_s, more.opens_s);
        into.stretches.insert(into.stretches.end(), more.stretches.begin(), more.stretches.end());
        into.stretches = apart(std::move(into.stretches));
    }
    return sum;
}

void forget(drive_history& h, double older_s)
{
    for (drive_history::channel& c : h.channels) {
        const auto kept = std::find_if(c.stretches.begin(), c.stretches.end(),
                                       [&](const driven_stretch& s) { return s.end_s > -older_s; });
        c.stretches.erase(c.stretches.begin(), kept);
    }
}

void coarsen(drive_history& h, std::size_t most)
{
    for (drive_history::channel& c : h.channels) {
        if (c.stretches.size() <= most)
            continue;
        const auto newer = c.stretches.end() - static_cast<std::ptrdiff_t>(most - 1);
        driven_stretch old = c.stretches.front();
        for (auto s = c.stretches.begin() + 1; s != newer; ++s) {
            old.end_s = s->end_s;
            old.driven_s += s->driven_s;
        }
        *(newer - 1) = old;
        c.stretches.erase(c.stretches.begin(), newer - 1);
    }
}

} // namespace tactor::synth
