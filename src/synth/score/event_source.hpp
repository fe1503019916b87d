// SPDX-License-Identifier: MIT
/// \file
/// The drives of a score, one after the other.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <tactor/render.hpp>

#include "synth/score/event.hpp"

namespace tactor::synth {

/// Walks through a score in order of start frame. Memory does not grow with the length of what was
/// walked through; next() does not allocate after the constructor. Control side, one thread at a time.
class event_source {
public:
    explicit event_source(const score& s);
    ~event_source();
    event_source(event_source&&) noexcept;
    event_source& operator=(event_source&&) noexcept;

    /// The next event, or nothing at the end; does not move on.
    const drive_event* peek() noexcept;
    /// Moves on.
    void pop() noexcept;

    /// Why there is no next event although the score has not ended: a plan threw, or gave something that
    /// cannot be rendered. Empty while all is well.
    const std::string& failure() const noexcept;
    /// Frame of the score up to which the failed plan could be followed.
    std::uint64_t failed_at() const noexcept;

private:
    struct impl;
    std::unique_ptr<impl> impl_;
};

} // namespace tactor::synth
