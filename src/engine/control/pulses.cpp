// SPDX-License-Identifier: MIT
#include "engine/control/pulses.hpp"

#include <algorithm>
#include <optional>

namespace tactor::engine {

void pulse_plan::forget(stroke_id id, bool was_played)
{
    const std::size_t left =
        std::erase_if(waiting_, [id](const pulse& p) { return p.id == id; }) + board_.forget(id);
    missed_ += was_played ? left : 0;
    hand_over();
}

bool pulse_plan::add(stroke_id id, std::uint64_t frame, const clock_line& line)
{
    board_.forget_other_epochs(line.epoch);
    std::erase_if(waiting_, [&line](const pulse& p) { return p.epoch != line.epoch; });
    if (line.epoch == 0 || frame < line.first)
        return false;
    waiting_.insert({.epoch = line.epoch, .frame = frame, .id = id});
    hand_over();
    return true;
}

bool pulse_plan::hand_over()
{
    bool any = false;
    while (!waiting_.empty()) {
        const pulse first = *waiting_.begin();
        const std::optional<pulse> left = board_.offer(first);
        if (left == first)
            break;
        any = true;
        waiting_.erase(waiting_.begin());
        if (left)
            waiting_.insert(*left);
    }
    return any;
}

bool pulse_emitter::await(std::int64_t due_ns) noexcept
{
    if (time_.now() - due_ns > latest_pulse_ns)
        return false;
    time_.sleep_until(due_ns - cost_ns_);
    return true;
}

void pulse_emitter::send(std::int64_t due_ns) noexcept
{
    const std::int64_t before = time_.now();
    if (!line_.set(true)) {
        ++stats_.missed;
        line_.set(false);
        return;
    }
    const std::int64_t on = time_.now();
    // The first call may have paid for pages that were not there yet.
    cost_ns_ = stats_.sent < 2 ? on - before : cost_ns_ + (on - before - cost_ns_) / 8;
    const double late = static_cast<double>(on - due_ns) * 1e-9;
    ++stats_.sent;
    stats_.mean_late_s += (late - stats_.mean_late_s) / static_cast<double>(stats_.sent);
    stats_.worst_late_s = std::max(stats_.worst_late_s, late);
    time_.sleep_until(on + pulse_ns_);
    line_.set(false);
}

} // namespace tactor::engine
