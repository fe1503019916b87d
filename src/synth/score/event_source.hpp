// SPDX-License-Identifier: MIT
/// \file
/// The drives of a score, one after the other.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <tactor/render.hpp>

#include "synth/score/expander.hpp"

namespace tactor::synth {

/// Events of a score in order of start frame. Memory does not grow with the length of the score. Control
/// side, one thread at a time.
class event_source {
public:
    explicit event_source(const score& s);
    event_source(const event_source&) = delete;
    event_source(event_source&&) noexcept = default;
    event_source& operator=(event_source&&) noexcept = default;

    /// Returns the next event; null at the end. Does not move on. Throws std::bad_alloc without memory for a
    /// sample of a continuous plan; the next call then tries again.
    const drive_event* peek();
    /// Moves on to the next event.
    void pop() noexcept;

private:
    static bool later(const expander* a, const expander* b) noexcept;
    void move_on();
    void begin_items();
    void release(expander* e) noexcept;

    // Items that have begun are expanders in a heap; the score knows how many that are at most.
    std::shared_ptr<const score::impl> piece_;
    std::vector<expander> expanders_;
    std::vector<control_points> points_;
    std::vector<expander*> free_expanders_;
    std::vector<control_points*> free_points_;
    std::vector<expander*> heap_;
    std::size_t next_item_ = 0;
    bool popped_ = false; ///< the first event of the heap
};

} // namespace tactor::synth
