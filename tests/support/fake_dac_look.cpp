// SPDX-License-Identifier: MIT
// State of the fake DAC that a test can see.
#include "fake_dac.hpp"

#include <algorithm>

namespace tactor::test {

std::vector<std::byte> fake_dac::captured(std::uint64_t from) const
{
    const std::lock_guard lock(mutex_);
    const std::uint64_t first = std::min<std::uint64_t>(from * frame_bytes_, captured_.size());
    return {captured_.begin() + static_cast<std::ptrdiff_t>(first), captured_.end()};
}

std::size_t fake_dac::captured_frames() const
{
    const std::lock_guard lock(mutex_);
    return static_cast<std::size_t>(total_);
}

std::size_t fake_dac::frame_bytes() const
{
    const std::lock_guard lock(mutex_);
    return frame_bytes_;
}

std::uint64_t fake_dac::queued() const
{
    const std::lock_guard lock(mutex_);
    return queued_locked();
}

unsigned fake_dac::starts() const
{
    const std::lock_guard lock(mutex_);
    return starts_;
}

unsigned fake_dac::prepares() const
{
    const std::lock_guard lock(mutex_);
    return prepares_;
}

unsigned fake_dac::drops() const
{
    const std::lock_guard lock(mutex_);
    return drops_;
}

unsigned fake_dac::asked_in_vain() const
{
    const std::lock_guard lock(mutex_);
    return asked_in_vain_;
}

void fake_dac::hide_descriptors_in_xrun()
{
    const std::lock_guard lock(mutex_);
    hides_descriptors_ = true;
}

bool fake_dac::closed() const
{
    const std::lock_guard lock(mutex_);
    return closed_;
}

bool fake_dac::running() const
{
    const std::lock_guard lock(mutex_);
    return running_;
}

void fake_dac::reserve_capture(std::size_t bytes)
{
    const std::lock_guard lock(mutex_);
    captured_.reserve(bytes);
    capture_limit_ = bytes;
}

void fake_dac::stop_capture()
{
    const std::lock_guard lock(mutex_);
    capture_limit_ = captured_.size();
}

} // namespace tactor::test
