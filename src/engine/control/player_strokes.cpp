// SPDX-License-Identifier: MIT
// Strokes that wait for a trigger or for points, and the calls of handlers.
#include <exception>
#include <limits>
#include <list>
#include <new>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/access.hpp"
#include "engine/control/player_impl.hpp"
#include "engine/live/live_stroke.hpp"

namespace tactor {
inline namespace v0 {
namespace {

// Number of reads without an edge after which a readable descriptor counts as broken.
constexpr int most_empty_reads = 100;

} // namespace

std::size_t player::impl::fire(std::int64_t time_ns)
{
    const std::lock_guard lock(mutex);
    const std::size_t n = feed.fire(time_ns);
    if (n != 0)
        pump();
    return n;
}

// Reads the trigger line in the control thread. Returns false if the line is broken.
bool player::impl::edges()
{
    const auto delay = static_cast<std::int64_t>(lines.trigger_delay_s * 1e9);
    bool any = false;
    for (auto e = lines.trigger->read(); e; e = lines.trigger->read()) {
        any = true;
        std::int64_t due = 0;
        if (__builtin_add_overflow(e->time_ns, delay, &due))
            due = std::numeric_limits<std::int64_t>::max();
        try {
            fire(due);
        } catch (const std::bad_alloc&) {
            const std::lock_guard lock(mutex);
            unfired = due;
            link.to_control.signal();
        }
    }
    empty_reads = any ? 0 : empty_reads + 1;
    return empty_reads < most_empty_reads;
}

live_stroke player::impl::begin(const live_options& o)
{
    const stream_setup& setup = out->setup(); // not under the lock, because a sink may be the program's own
    const std::unique_lock lock(mutex);
    check_open();
    if (!faces)
        faces.emplace(tactors);
    const stroke_id id = next_id();
    auto stroke = std::make_shared<live_stroke::impl>(id, tactors, *faces, setup, o);
    feed.submit(id, std::shared_ptr<engine::live_voice>(stroke, &stroke->voice));
    pump();
    return detail::access::make<live_stroke>(std::move(stroke));
}

bool player::impl::on_end(stroke_id id, report_handler done)
{
    if (!done)
        throw error(error_kind::bad_input, "on_end", "there is nothing to call", "give a function");
    std::unique_lock lock(mutex);
    const auto found = ended.find(id);
    if (found == ended.end()) {
        if (!feed.knows(id))
            return false;
        watchers.emplace(id, std::move(done));
        return true;
    }
    const stroke_report r = found->second.report;
    lock.unlock();
    done(r);
    return true;
}

template <typename Call>
void player::impl::call(Call&& callee) noexcept
{
    try {
        callee();
    } catch (const std::exception& e) {
        give_up(e.what());
    } catch (...) {
        give_up("not a std::exception");
    }
}

// Calls the handlers, in the control thread and without the mutex. A handler may call the player, and may
// destroy it; then close() makes the remaining calls before it returns.
void player::impl::call_handlers()
{
    report_beginnings();
    std::unique_lock lock(mutex);
    while (!unreported.empty()) {
        std::list<stroke_report> one;
        one.splice(one.end(), unreported, unreported.begin());
        lock.unlock();
        call_handlers(one.front());
        lock.lock();
    }
}

// Reports beginnings before ends, because a stroke may have begun and ended since the last call.
void player::impl::report_beginnings()
{
    std::unique_lock lock(mutex);
    while (!begun.empty()) {
        const auto [id, at_ns] = begun.front();
        begun.pop_front();
        auto f = on_begun;
        lock.unlock();
        if (f != nullptr)
            call([&, id = id, at_ns = at_ns] { (*f)(id, at_ns); });
        f.reset(); // the last reference, if it was replaced: its contents may call the player
        lock.lock();
    }
}

void player::impl::call_handlers(const stroke_report& r)
{
    std::unique_lock lock(mutex);
    const auto common = handler;
    lock.unlock();
    const stroke_report* const before = std::exchange(reporting, &r);
    if (common != nullptr)
        call([&] { (*common)(r); });
    call_watchers(r);
    reporting = before;
}

void player::impl::call_watchers(const stroke_report& r)
{
    std::unique_lock lock(mutex);
    for (auto own = watchers.extract(r.id); own; own = watchers.extract(r.id)) {
        lock.unlock();
        call([&] { own.mapped()(r); });
        own = {}; // its contents may call the player
        lock.lock();
    }
}

// Ends the stream after a handler has failed: the program no longer knows what is on the skin.
void player::impl::give_up(const char* what) noexcept
{
    const std::lock_guard lock(mutex);
    if (stopping)
        return;
    try {
        handler_failed = fmt::format("a handler of the program threw: {}", what);
    } catch (const std::bad_alloc&) {
        handler_failed = "a handler threw"; // short enough to need no memory
    }
    end_stream(true);
}

} // namespace v0
} // namespace tactor
