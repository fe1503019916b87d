// SPDX-License-Identifier: MIT
/// \file
/// Sources of a score's drives, in order of start. An expander makes the drives of one item.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <tactor/render.hpp>

#include "plan/curve_impl.hpp"
#include "synth/score/score.hpp"
#include "synth/wave/event.hpp"

namespace tactor::synth {

/// A continuous stroke at a few control points.
struct control_points {
    void reserve(std::size_t tactors);
    /// Stores the drives of `now` as those of point i.
    void add(std::size_t i) noexcept;

    struct row {
        std::uint32_t tactor;
        std::array<double, points_per_line> amplitude; ///< by point
    };
    std::vector<row> rows; ///< by tactor
    std::array<std::uint16_t, points_per_line> frame{};
    std::size_t count = 0;
    burst now;         ///< latest of the points
    bool open = false; ///< more points are to come
    detail::same_tactors seen;
};

/// Events of one item in order of start. Allocates only for samples of continuous plans: begin() and
/// advance() may throw std::bad_alloc. If they are called again, they continue.
class expander {
public:
    /// Begins an item. `points`: for a continuous item; no other expander may use them at the same time.
    /// Events start `shift` frames later than in the score.
    void begin(const score::impl& s, std::size_t item_number, control_points* points,
               std::uint64_t shift = 0);

    bool done() const noexcept { return done_; }
    const drive_event& event() const noexcept { return event_; }
    std::size_t item_number() const noexcept { return number_; }
    control_points* points() const noexcept { return points_; }
    void advance();

private:
    void stretch(std::uint64_t start, std::uint64_t length) noexcept;
    void add(std::uint32_t tactor, double from, double to) noexcept;
    void draw(const control_points::row& r) noexcept;
    void make_burst_event() noexcept;
    void make_joined_event() noexcept;
    void continuous_event();
    void make_marker_event() noexcept;
    void make_own_event() noexcept;
    void take_sample(std::uint64_t step);
    bool advance_points();

    const score::impl* score_ = nullptr;
    const item* item_ = nullptr;
    control_points* points_ = nullptr;
    std::size_t number_ = 0;
    std::uint64_t shift_ = 0;
    std::uint64_t position_ = 0; ///< first frame of the stretch whose events come next
    std::uint64_t step_end_ = 0; ///< continuous: frame of the latest control point
    std::uint64_t step_ = 0;     ///< continuous: number of the latest control point
    std::size_t next_ = 0;       ///< index of the next drive, member or row
    bool done_ = true;
    drive_event event_;
};

/// Events of a score in order of start frame. Memory does not grow with the length of the score. Control
/// side, one thread at a time.
class event_source {
public:
    explicit event_source(const score& s);
    event_source(const event_source&) = delete;
    event_source(event_source&&) noexcept = default;
    event_source& operator=(event_source&&) noexcept = default;

    /// Returns the next event without removing it; null at the end. Throws std::bad_alloc if there is no
    /// memory for a sample of a continuous plan; the next call then tries again.
    const drive_event* peek();
    /// Removes the event that peek() returned.
    void pop() noexcept;

private:
    void advance_expander();
    void begin_items();
    void release(expander* e) noexcept;

    // Each item that has begun has an expander in a heap. The score knows the maximum number of expanders.
    std::shared_ptr<const score::impl> piece_;
    const score::impl* part_; ///< score whose items come next: the piece itself, or a part of a joined score
    std::uint64_t shift_ = 0; ///< frame of the piece at which the part begins
    std::size_t next_part_ = 0;
    std::vector<expander> expanders_;
    std::vector<control_points> points_;
    std::vector<expander*> free_expanders_;
    std::vector<control_points*> free_points_;
    std::vector<expander*> heap_;
    std::size_t next_item_ = 0;
    bool popped_ = false; ///< the heap's first event has been taken
};

} // namespace tactor::synth
