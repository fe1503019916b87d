// SPDX-License-Identifier: MIT
#include "engine/pulses.hpp"

#include <algorithm>

namespace tactor::engine {

void pulse_plan::forget(stroke_id id)
{
    std::erase_if(waiting_, [id](const pulse& p) { return p.id == id; });
}

std::optional<pulse> pulse_plan::next(const clock_line& line)
{
    std::erase_if(waiting_,
                  [&line](const pulse& p) { return p.epoch != line.epoch || p.frame < line.first; });
    if (waiting_.empty())
        return std::nullopt;
    return *waiting_.begin();
}

void pulse_emitter::send(std::int64_t due_ns, const std::function<bool()>& still) noexcept
{
    if (time_.now() - due_ns > latest_pulse_ns) {
        ++stats_.missed;
        return;
    }
    time_.sleep_until(due_ns - cost_ns_);
    if (!still())
        return;
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
