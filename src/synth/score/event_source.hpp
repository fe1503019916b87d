// SPDX-License-Identifier: MIT
/// \file
/// The drives of a score, one after the other.
#pragma once

#include <cstdint>
#include <memory>

#include <tactor/render.hpp>

#include "synth/score/event.hpp"

namespace tactor::synth {

/// Walks through a score in order of start frame. Memory does not grow with the length of what was
/// walked through. Control side, one thread at a time.
class event_source {
public:
    explicit event_source(const score& s);
    ~event_source();
    event_source(event_source&&) noexcept;
    event_source& operator=(event_source&&) noexcept;

    /// Returns the next event, or nothing at the end; does not move on. Throws std::bad_alloc where there is
    /// no memory for a sample of a continuous plan; the event is then there when it is asked for again.
    const drive_event* peek();
    /// Moves on from what peek() returned.
    void pop() noexcept;

private:
    struct impl;
    std::unique_ptr<impl> impl_;
};

} // namespace tactor::synth
