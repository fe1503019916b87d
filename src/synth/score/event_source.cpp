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
        begin_items();
    }

    static bool later(const expander* a, const expander* b) noexcept
    {
        return a->event().start != b->event().start ? a->event().start > b->event().start
                                                    : a->item_number() > b->item_number();
    }

    void begin_items() noexcept;
    void pop() noexcept;
    void release(expander* e) noexcept;

    std::shared_ptr<const score::impl> piece;
    std::vector<expander> expanders;
    std::vector<control_points> points;
    std::vector<expander*> free_expanders;
    std::vector<control_points*> free_points;
    std::vector<expander*> heap;
    std::size_t next_item = 0;
    std::string failure;
    std::uint64_t failed_at = 0;
};

/// Lets every item begin that may have the next event.
void event_source::impl::begin_items() noexcept
{
    const std::deque<item>& items = piece->list.items;
    while (next_item < items.size() &&
           (heap.empty() || items[next_item].start <= heap.front()->event().start)) {
        control_points* p = nullptr;
        if (items[next_item].kind == item_kind::continuous) {
            p = free_points.back();
            free_points.pop_back();
        }
        expander* e = free_expanders.back();
        free_expanders.pop_back();
        e->begin(*piece, next_item++, p);
        if (e->done()) {
            release(e);
            continue;
        }
        heap.push_back(e);
        std::push_heap(heap.begin(), heap.end(), later);
    }
}

void event_source::impl::pop() noexcept
{
    std::pop_heap(heap.begin(), heap.end(), later);
    expander* e = heap.back();
    heap.pop_back();
    e->advance();
    if (e->done()) {
        release(e);
        return;
    }
    heap.push_back(e);
    std::push_heap(heap.begin(), heap.end(), later);
}

/// Takes an expander back that is done. Where one fails, the whole score ends.
void event_source::impl::release(expander* e) noexcept
{
    if (e->failed()) {
        failure = std::move(e->points()->failure);
        failed_at = e->position();
        heap.clear();
        next_item = piece->list.items.size();
    }
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

const drive_event* event_source::peek() noexcept
{
    return impl_->heap.empty() ? nullptr : &impl_->heap.front()->event();
}

const std::string& event_source::failure() const noexcept
{
    return impl_->failure;
}

std::uint64_t event_source::failed_at() const noexcept
{
    return impl_->failed_at;
}

void event_source::pop() noexcept
{
    if (!impl_->heap.empty()) {
        impl_->pop();
        impl_->begin_items();
    }
}

} // namespace tactor::synth
