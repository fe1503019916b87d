// SPDX-License-Identifier: MIT
#include "synth/score/score.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/words.hpp"
#include "synth/score/frames.hpp"

namespace tactor::synth {

namespace {

constexpr double longest_plan_s = 1e6;
constexpr const char* finite = "give a finite number";

[[noreturn]] void refuse(std::size_t number, const std::string& why, const std::string& hint)
{
    throw error(error_kind::bad_input, fmt::format("burst {} of the plan", number + 1), why, hint);
}

void check(const burst& b, std::size_t number, std::size_t tactors)
{
    if (!(b.onset_s >= 0.0 && b.duration_s >= 0.0 && b.onset_s + b.duration_s <= longest_plan_s)) {
        refuse(
            number,
            fmt::format("it starts at {} and lasts {}", seconds_text(b.onset_s), seconds_text(b.duration_s)),
            fmt::format("use 0 to {:.0f} s", longest_plan_s));
    }
    if (!std::isfinite(b.intensity))
        refuse(number, fmt::format("its intensity is {}", b.intensity), finite);
    for (const drive& d : b.drives) {
        if (d.tactor >= tactors)
            refuse(number, fmt::format("tactor {} is not in the array, which has {}", d.tactor, tactors),
                   "plan the stroke for this array");
        if (!std::isfinite(d.amplitude))
            refuse(number, fmt::format("the amplitude of tactor {} is {}", d.tactor, d.amplitude), finite);
    }
}

/// Returns the greatest amplitude that overlapping bursts may add up to: A_v, or its value on an intensity
/// scale.
double max_sum(const burst& b)
{
    const double energy =
        std::accumulate(b.drives.begin(), b.drives.end(), 0.0,
                        [](double sum, const drive& d) { return sum + d.amplitude * d.amplitude; });
    return energy > b.intensity * b.intensity * (1.0 + 1e-9) ? std::sqrt(energy) : b.intensity;
}

/// A burst that sounds in at least one frame.
struct placed_burst {
    const burst* source;
    double to_s;
    std::uint64_t from; ///< frame of the plan at which it starts
    std::uint64_t to;
};

/// Returns the bursts that sound, in order of start.
std::vector<placed_burst> sort_bursts(std::span<const burst> bursts, unsigned rate)
{
    std::vector<placed_burst> all;
    all.reserve(bursts.size());
    for (const burst& b : bursts) {
        const double to_s = b.onset_s + b.duration_s;
        const placed_burst placed{&b, to_s, frame_at(b.onset_s, rate), frame_at(to_s, rate)};
        if (placed.to > placed.from)
            all.push_back(placed);
    }
    const auto earlier = [](const placed_burst& a, const placed_burst& b) { return a.from < b.from; };
    if (!std::is_sorted(all.begin(), all.end(), earlier)) // planners return them in order
        std::stable_sort(all.begin(), all.end(), earlier);
    return all;
}

/// Run of overlapping bursts on one tactor. Bursts must come in order of start.
class run {
public:
    /// Adds a burst. Returns true if it continues the run; otherwise it begins a new run.
    bool add_burst(const placed_burst& s)
    {
        constexpr double touch_s = 1e-9;
        const bool goes_on = s.from < end_ && s.source->onset_s < end_s_ - touch_s;
        end_ = goes_on ? std::max(end_, s.to) : s.to;
        end_s_ = goes_on ? std::max(end_s_, s.to_s) : s.to_s;
        return goes_on;
    }

private:
    std::uint64_t end_ = 0;
    double end_s_ = 0.0;
};

/// Placer of the bursts of one plan. Marks each drive that overlaps with another drive of its tactor: such
/// drives are joined.
class placer {
public:
    placer(std::span<const burst> bursts, const plan& p, std::uint32_t number, std::uint64_t start,
           std::size_t tactors, const render_options& o, item_list& out)
        : plan_(p),
          number_(number),
          start_(start),
          tactors_(tactors),
          options_(o),
          out_(out),
          bursts_(sort_bursts(bursts, o.rate))
    {
    }

    /// Places the bursts and returns the frame at which they end.
    std::uint64_t place()
    {
        mark_joined_drives();
        if (any_joined_)
            append_joined_items();
        append_bursts();
        return end_;
    }

private:
    void mark_joined_drives()
    {
        std::vector<run> runs(tactors_);
        std::vector<std::size_t> latest(tactors_); // latest drive of each tactor
        for (const placed_burst& s : bursts_) {
            end_ = std::max(end_, start_ + s.to);
            for (const drive& d : s.source->drives) {
                const bool goes_on = runs[d.tactor].add_burst(s);
                if (goes_on) {
                    joined_[latest[d.tactor]] = true;
                    any_joined_ = true;
                }
                latest[d.tactor] = joined_.size();
                joined_.push_back(goes_on);
            }
        }
    }

    /// Appends an item for each run of bursts that overlap on a tactor, in order of start, then of tactor.
    void append_joined_items()
    {
        std::vector<run> runs(tactors_);
        std::vector<std::vector<item_member>> members(tactors_); // members of the latest run
        const std::size_t before = out_.items.size();
        std::size_t number = 0;
        for (const placed_burst& s : bursts_)
            for (const drive& d : s.source->drives) {
                const bool goes_on = runs[d.tactor].add_burst(s);
                if (!joined_[number++])
                    continue;
                if (!goes_on)
                    join(d.tactor, members[d.tactor]);
                const std::uint32_t attack = ramp(s);
                const std::uint32_t release =
                    release_frames(options_.envelope, options_.rate, s.to - s.from, attack);
                members[d.tactor].push_back(
                    {start_ + s.from, s.to - s.from, attack, release, d.amplitude, max_sum(*s.source)});
            }
        for (std::size_t i = 0; i < tactors_; ++i)
            join(i, members[i]);
        std::stable_sort(out_.items.begin() + static_cast<std::ptrdiff_t>(before), out_.items.end(),
                         [](const item& a, const item& b) {
                             return std::tie(a.start, a.tactor) < std::tie(b.start, b.tactor);
                         });
    }

    void join(std::size_t tactor, std::vector<item_member>& members)
    {
        if (members.empty())
            return;
        item it;
        it.kind = item_kind::joined;
        it.plan = number_;
        it.tactor = static_cast<std::uint16_t>(tactor);
        it.start = members.front().start;
        it.first = out_.members.size();
        it.count = static_cast<std::uint32_t>(members.size());
        for (const item_member& m : members)
            it.length = std::max(it.length, m.end() - it.start);
        out_.members.insert(out_.members.end(), members.begin(), members.end());
        out_.items.push_back(it);
        members.clear();
    }

    /// Appends the drives that do not overlap, burst by burst, in order of tactor.
    void append_bursts()
    {
        std::vector<drive> single;
        std::size_t number = 0;
        for (const placed_burst& s : bursts_) {
            single.clear();
            for (const drive& d : s.source->drives)
                if (!joined_[number++])
                    single.push_back(d);
            if (single.empty())
                continue;
            const auto lower = [](const drive& x, const drive& y) { return x.tactor < y.tactor; };
            if (!std::is_sorted(single.begin(), single.end(), lower))
                std::stable_sort(single.begin(), single.end(), lower);
            item it;
            it.start = start_ + s.from;
            it.length = s.to - s.from;
            it.ramp = ramp(s);
            it.plan = number_;
            it.first = out_.drive_tactors.size();
            it.count = static_cast<std::uint32_t>(single.size());
            for (const drive& d : single) {
                out_.drive_tactors.push_back(static_cast<std::uint16_t>(d.tactor));
                out_.drive_amplitudes.push_back(d.amplitude);
            }
            out_.items.push_back(it);
        }
    }

    std::uint32_t ramp(const placed_burst& s) const
    {
        return attack_frames(plain_ramp_s(s.source->onset_s, s.source->duration_s, plan_, options_),
                             options_.envelope, options_.rate, s.to - s.from);
    }

    const plan& plan_;
    std::uint32_t number_;
    std::uint64_t start_;
    std::size_t tactors_;
    const render_options& options_;
    item_list& out_;
    std::vector<placed_burst> bursts_;
    std::uint64_t end_ = start_;
    std::vector<bool> joined_; // by drive, in order of bursts_
    bool any_joined_ = false;
};

} // namespace

std::uint64_t place_bursts(std::span<const burst> bursts, std::size_t first, const plan& p,
                           std::uint32_t plan, std::uint64_t start, std::size_t tactors,
                           const render_options& o, item_list& out)
{
    for (std::size_t i = 0; i < bursts.size(); ++i)
        check(bursts[i], first + i, tactors);
    return placer(bursts, p, plan, start, tactors, o, out).place();
}

std::uint64_t append_continuous_item(const plan& p, std::uint32_t plan, std::uint64_t start,
                                     std::uint64_t bursts_end, const render_options& o, item_list& out)
{
    const auto check_length = [](const char* field, double s) {
        if (!(s >= 0.0 && s <= longest_plan_s))
            throw error(error_kind::bad_input, "plan", "it lasts " + seconds_text(s),
                        fmt::format("use 0 to {:.0f} s", longest_plan_s))
                .with_field(field);
    };
    check_length("total_s", p.total_s);
    check_length("stroke_duration_s", p.stroke_duration_s);
    const std::uint64_t total = start + frame_at(p.total_s, o.rate);
    if (!p.curve)
        return std::max(total, bursts_end);
    item it;
    it.kind = item_kind::continuous;
    it.start = start;
    it.length = frame_at(p.stroke_duration_s, o.rate);
    it.ramp = attack_frames(plain_ramp_s(0.0, p.stroke_duration_s, p, o), o.envelope, o.rate, it.length);
    it.plan = plan;
    if (it.length > 0)
        out.items.push_back(it);
    return std::max(total, it.end());
}

} // namespace tactor::synth
