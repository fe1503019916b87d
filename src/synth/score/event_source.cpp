// SPDX-License-Identifier: MIT
#include "synth/score/event_source.hpp"

#include <algorithm>
#include <deque>

#include "core/access.hpp"

namespace tactor::synth {

event_source::event_source(const score& s)
    : piece_(detail::access::shared(s)), expanders_(piece_->open_items), points_(piece_->open_continuous)
{
    free_expanders_.reserve(expanders_.size());
    for (expander& e : expanders_)
        free_expanders_.push_back(&e);
    free_points_.reserve(points_.size());
    for (control_points& p : points_) {
        p.reserve(piece_->tactors.size());
        free_points_.push_back(&p);
    }
    heap_.reserve(expanders_.size());
}

bool event_source::later(const expander* a, const expander* b) noexcept
{
    return a->event().start != b->event().start ? a->event().start > b->event().start
                                                : a->item_number() > b->item_number();
}

/// Lets every item begin that may have the next event.
void event_source::begin_items()
{
    const std::deque<item>& items = piece_->list.items;
    while (next_item_ < items.size() &&
           (heap_.empty() || items[next_item_].start <= heap_.front()->event().start)) {
        const bool is_continuous = items[next_item_].kind == item_kind::continuous;
        expander* e = free_expanders_.back();
        e->begin(*piece_, next_item_, is_continuous ? free_points_.back() : nullptr);
        ++next_item_;
        free_expanders_.pop_back();
        if (is_continuous)
            free_points_.pop_back();
        if (e->done()) {
            release(e);
            continue;
        }
        heap_.push_back(e);
        std::push_heap(heap_.begin(), heap_.end(), later);
    }
}

/// Takes the first event off the heap.
void event_source::move_on()
{
    expander* e = heap_.front();
    std::pop_heap(heap_.begin(), heap_.end(), later);
    try {
        e->advance();
    } catch (...) { // it still has that event
        std::push_heap(heap_.begin(), heap_.end(), later);
        throw;
    }
    popped_ = false;
    if (e->done()) {
        heap_.pop_back();
        release(e);
    } else {
        std::push_heap(heap_.begin(), heap_.end(), later);
    }
}

/// Takes an expander back that is done.
void event_source::release(expander* e) noexcept
{
    free_expanders_.push_back(e);
    if (e->points() != nullptr)
        free_points_.push_back(e->points());
}

const drive_event* event_source::peek()
{
    if (popped_)
        move_on();
    begin_items();
    return heap_.empty() ? nullptr : &heap_.front()->event();
}

void event_source::pop() noexcept
{
    popped_ = !heap_.empty();
}

} // namespace tactor::synth
