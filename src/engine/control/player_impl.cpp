// SPDX-License-Identifier: MIT
#include "engine/control/player_impl.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <exception>
#include <limits>
#include <list>
#include <new>
#include <utility>

#include <poll.h>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "rt/clock.hpp"

namespace tactor {
inline namespace v0 {
namespace {

// Number of unread reports that are kept. A program that only uses the handler must not grow.
constexpr std::size_t most_unread_reports = 4096;

// Returns the time of a time-out, at most a century from now, so that the clock cannot overflow.
std::chrono::steady_clock::time_point deadline(double timeout_s)
{
    constexpr double century_s = 100.0 * 365.0 * 86400.0;
    const double wait_s = timeout_s > 0.0 ? std::min(timeout_s, century_s) : 0.0;
    return std::chrono::steady_clock::now() + std::chrono::nanoseconds(std::llround(wait_s * 1e9));
}

// Number of reads without an edge after which a readable descriptor counts as broken.
constexpr int most_empty_reads = 100;

} // namespace

void player::impl::close()
{
    stop(true);
    if (control->is_current()) {
        // A handler destroys the player: this thread does here what it would do after the handler.
        if (reporting != nullptr)
            call_watchers(*reporting);
        for (woken(); !all_delivered; woken()) {
            pollfd fd{.fd = link.to_control.fd(), .events = POLLIN, .revents = 0};
            if (::poll(&fd, 1, -1) > 0)
                link.to_control.consume();
        }
    }
    audio.join();
    pulses.reset();
    amplifier.reset();
    control.reset();
    lines = {};
    out.reset();
}

void player::impl::check_open() const
{
    if (!stopping && !feed.stream_over())
        return;
    const stream_end over = end();
    throw error(error_kind::runtime, stream, over.reason == reason_kind::none ? "it was stopped" : over.why,
                "open a new player");
}

stream_end player::impl::end() const
{
    if (!handler_failed.empty())
        return {.reason = reason_kind::handler, .why = handler_failed};
    return feed.end();
}

void player::impl::end_stream(bool closing) noexcept
{
    if (std::exchange(stopping, true))
        return;
    if (closing)
        feed.set_closing();
    link.requests.push({.what = engine::request::kind::stop, .closing = closing});
    link.to_audio.signal();
}

bool player::impl::pump()
{
    bool done = true;
    try {
        feed.pump(link.status.load().written, link.clock.load());
        if (pulses)
            pulses->hand_over();
        if (!feed.reports().empty())
            link.to_control.signal();
    } catch (const std::bad_alloc&) {
        done = false;
        link.to_control.signal();
    }
    if (feed.take_urgent())
        link.to_audio.signal();
    return done;
}

wait_result player::impl::wait(stroke_id id, std::optional<double> timeout_s)
{
    std::unique_lock lock(mutex);
    const auto settled = [&] { return find_report(id) != ended.end() || !feed.knows(id); };
    // In the control thread it would wait for itself.
    if (!control->is_current()) {
        if (timeout_s)
            news.wait_until(lock, deadline(*timeout_s), settled);
        else
            news.wait(lock, settled);
    }
    const auto found = find_report(id);
    if (found != ended.end()) {
        wait_result r(std::move(*found));
        ended.erase(found);
        return r;
    }
    if (feed.knows(id))
        return wait_kind::timeout;
    return id != stroke_id{} && id <= last_id ? wait_kind::taken : wait_kind::unknown;
}

void player::impl::stop(bool closing)
{
    std::unique_lock lock(mutex);
    end_stream(closing);
    if (!control->is_current())
        news.wait(lock, [this] { return all_delivered; });
}

void player::impl::woken()
{
    engine::feeder::live_map ended_strokes;
    std::unique_lock lock(mutex);
    const bool done = take_reports() && (feed.stream_over() || pump());
    const bool last = done && feed.stream_over();
    if (log.on())
        log.look(link.status.load(), rt::monotonic_ns());
    if (last)
        log.end(handler_failed.empty() ? feed.end().why : handler_failed); // no copy: there may be no memory
    ended_strokes.swap(feed.ended_live());
    lock.unlock();
    ended_strokes.clear();
    news.notify_all();
    log.write();
    book.enter(link.driven, !last && link.sounds.load(std::memory_order_relaxed));
    call_handlers();
    if (!done) {
        constexpr timespec soon{.tv_sec = 0, .tv_nsec = 10'000'000};
        ::nanosleep(&soon, nullptr); // other code may free memory
        link.to_control.signal();
    }
    if (!last)
        return;
    lock.lock();
    all_delivered = true;
    lock.unlock();
    news.notify_all();
}

// Handles the audio thread's reports. Returns false if memory ran out; the remaining reports stay in the
// ring.
bool player::impl::take_reports()
{
    try {
        for (const engine::report* r = link.reports.front(); r != nullptr; r = link.reports.front()) {
            feed.handle(*r);
            link.reports.drop_front();
        }
        if (unfired)
            feed.fire(*unfired);
        unfired.reset();
        begun.splice(begun.end(), feed.beginnings());
        for (auto& reports = feed.reports(); !reports.empty();) {
            stroke_report& r = reports.front();
            if (!handler_failed.empty() && r.reason == reason_kind::closed) {
                r.why = handler_failed;
                r.reason = reason_kind::handler;
            }
            ended.push_back(r);
            if (ended.size() > most_unread_reports)
                ended.pop_front();
            log.look_at_end(r);
            unreported.splice(unreported.end(), reports, reports.begin());
        }
    } catch (const std::bad_alloc&) {
        return false;
    }
    return true;
}

std::deque<stroke_report>::iterator player::impl::find_report(stroke_id id)
{
    return std::find_if(ended.begin(), ended.end(), [id](const stroke_report& r) { return r.id == id; });
}

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
