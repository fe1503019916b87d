// SPDX-License-Identifier: MIT
#include "synth/score/event_source.hpp"
#include "core/access.hpp"

#include <algorithm>
#include <deque>
#include <utility>
#include <vector>

#include "synth/score/expander.hpp"
#include "synth/score/score.hpp"

namespace tactor::synth {

/// Items that have begun are expanders in a heap; the score knows how many that are at most.
struct event_source::impl {
    explicit impl(std::shared_ptr<const score::impl> data)
        : piece(std::move(data)), expanders(piece->open_items), points(piece->open_continuous)
    {
        free_expanders.reserve(expanders.size());
        for (expander& e : expanders)
            free_expanders.push_back(&e);
        free_points.reserve(points.size());
        for (control_points& p : points) {
            p.reserve(piece->tactors.size());
            free_points.push_back(&p);
        }
        heap.reserve(expanders.size());
    }

    static bool later(const expander* a, const expander* b) noexcept
    {
        return a->event().start != b->event().start ? a->event().start > b->event().start
                                                    : a->item_number() > b->item_number();
    }

    void move_on();
    void begin_items();
    void release(expander* e) noexcept;

    std::shared_ptr<const score::impl> piece;
    std::vector<expander> expanders;
    std::vector<control_points> points;
    std::vector<expander*> free_expanders;
    std::vector<control_points*> free_points;
    std::vector<expander*> heap;
    std::size_t next_item = 0;
    bool popped = false; ///< the first event of the heap
};

/// Lets every item begin that may have the next event.
void event_source::impl::begin_items()
{
    const std::deque<item>& items = piece->list.items;
    while (next_item < items.size() &&
           (heap.empty() || items[next_item].start <= heap.front()->event().start)) {
        const bool is_continuous = items[next_item].kind == item_kind::continuous;
        expander* e = free_expanders.back();
        e->begin(*piece, next_item, is_continuous ? free_points.back() : nullptr);
        ++next_item;
        free_expanders.pop_back();
        if (is_continuous)
            free_points.pop_back();
        if (e->done()) {
            release(e);
            continue;
        }
        heap.push_back(e);
        std::push_heap(heap.begin(), heap.end(), later);
    }
}

/// Takes the first event off the heap.
void event_source::impl::move_on()
{
    expander* e = heap.front();
    std::pop_heap(heap.begin(), heap.end(), later);
    try {
        e->advance();
    } catch (...) { // it still has that event
        std::push_heap(heap.begin(), heap.end(), later);
        throw;
    }
    popped = false;
    if (e->done()) {
        heap.pop_back();
        release(e);
    } else {
        std::push_heap(heap.begin(), heap.end(), later);
    }
}

/// Takes an expander back that is done.
void event_source::impl::release(expander* e) noexcept
{
    free_expanders.push_back(e);
    if (e->points() != nullptr)
        free_points.push_back(e->points());
}

event_source::event_source(const score& s) : impl_(std::make_unique<impl>(detail::access::shared(s)))
{
}

event_source::~event_source() = default;
event_source::event_source(event_source&&) noexcept = default;
event_source& event_source::operator=(event_source&&) noexcept = default;

const drive_event* event_source::peek()
{
    if (impl_->popped)
        impl_->move_on();
    impl_->begin_items();
    return impl_->heap.empty() ? nullptr : &impl_->heap.front()->event();
}

void event_source::pop() noexcept
{
    impl_->popped = !impl_->heap.empty();
}

} // namespace tactor::synth
