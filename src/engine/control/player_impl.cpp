// SPDX-License-Identifier: MIT
#include "engine/control/player_impl.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <exception>
#include <limits>
#include <list>
#include <map>
#include <new>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>

#include <tactor/error.hpp>
#include <tactor/player.hpp>

#include "core/words.hpp"
#include "rt/clock.hpp"

namespace tactor {
inline namespace v0 {
namespace {

// Number of unread reports that are kept. Limits the memory of a program that only uses the handler.
constexpr std::size_t most_unread_reports = 4096;

// Number of reads without an edge after which a readable descriptor counts as broken.
constexpr int most_empty_reads = 100;

} // namespace

struct player::impl::control_thread::state {
    explicit state(impl& p) : player(p.weak_from_this()), event(p.link.to_control) {}

    void run()
    {
        while (!over) {
            std::array<pollfd, 2> fds{{{event.fd(), POLLIN, 0}, {watched, POLLIN, 0}}};
            if (::poll(fds.data(), fds.size(), -1) < 0)
                continue;
            const auto p = player.lock(); // a handler may destroy the player
            if (p != nullptr && fds[0].revents != 0) {
                event.consume();
                p->handle_wake_up();
            }
            if (!over && p != nullptr && fds[1].revents != 0 && !p->read_trigger_edges())
                watched = -1;
        }
    }

    std::weak_ptr<impl> player;
    rt::event_fd& event;
    std::atomic<int> watched{-1}; ///< poll() skips a negative descriptor
    std::atomic<bool> over{false};
};

player::impl::control_thread::control_thread(impl& p)
    : state_(std::make_shared<state>(p)),
      // The program's handlers run here, so the stack is larger.
      thread_({.name = "tactor-control", .stack_bytes = std::size_t{512} * 1024}, [s = state_] { s->run(); })
{
}

player::impl::control_thread::~control_thread()
{
    state_->over = true;
    if (thread_.is_current()) {
        thread_.detach();
        return;
    }
    state_->event.signal();
    thread_.join();
}

void player::impl::control_thread::watch(int fd)
{
    state_->watched = fd;
    state_->event.signal();
}

void player::impl::close()
{
    stop(true);
    if (control->is_current()) {
        // A handler destroys the player: this thread does here what it would do after the handler.
        if (reporting != nullptr)
            call_watchers(*reporting);
        for (handle_wake_up(); !all_delivered; handle_wake_up()) {
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
    if (feed.take_wake_request())
        link.to_audio.signal();
    return done;
}

void player::impl::stop(bool closing)
{
    std::unique_lock lock(mutex);
    end_stream(closing);
    if (!control->is_current())
        news.wait(lock, [this] { return all_delivered; });
}

void player::impl::handle_wake_up()
{
    engine::feeder::live_map ended_strokes;
    std::unique_lock lock(mutex);
    const bool done = take_reports() && (feed.stream_over() || pump());
    const bool last = done && feed.stream_over();
    if (log.on())
        log.look(link.status.load(), rt::monotonic_ns());
    if (last)
        log.end(handler_failed.empty() ? feed.end().why : handler_failed); // no copy: there may be no memory
    ended_strokes.swap(feed.ended_live_strokes());
    lock.unlock();
    ended_strokes.clear();
    news.notify_all();
    if (book.enter(link.driven, !last && link.sounds.load(std::memory_order_relaxed), link.raised))
        log.warn(stream, book.doubt());
    log.write();
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
            log.log_stroke_end(r);
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
bool player::impl::read_trigger_edges()
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
// destroy it; then close() makes the remaining calls before it returns. Reports beginnings before ends,
// because a stroke may have begun and ended since the last call.
void player::impl::call_handlers()
{
    std::unique_lock lock(mutex);
    while (!begun.empty()) {
        const auto [id, at_ns] = begun.front();
        begun.pop_front();
        auto f = on_begun;
        lock.unlock();
        if (f != nullptr)
            call([&, id = id, at_ns = at_ns] { (*f)(id, at_ns); });
        f.reset(); // may be the last reference, and its destructor may call the player
        lock.lock();
    }
    while (!unreported.empty()) {
        std::list<stroke_report> one;
        one.splice(one.end(), unreported, unreported.begin());
        auto common = handler;
        lock.unlock();
        const stroke_report* const before = std::exchange(reporting, &one.front());
        if (common != nullptr)
            call([&] { (*common)(one.front()); });
        common.reset();
        call_watchers(one.front());
        reporting = before;
        lock.lock();
    }
}

void player::impl::call_watchers(const stroke_report& r)
{
    std::unique_lock lock(mutex);
    for (auto own = watchers.extract(r.id); own; own = watchers.extract(r.id)) {
        lock.unlock();
        call([&] { own.mapped()(r); });
        own = {}; // destroys the handler without the lock: its destructor may call the player
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

namespace {

constexpr double rounding = 1e-6;

const std::vector<unsigned>& reached(const stream_wiring& w, const tactor_spec& t)
{
    static const std::vector<unsigned> none;
    return t.channel < w.outputs.size() ? w.outputs[t.channel] : none;
}

// Returns the first other tactor that also reaches this output.
std::size_t find_partner_tactor(const array& a, const stream_wiring& w, std::size_t i, unsigned output)
{
    std::size_t k = 0;
    while (k == i ||
           !std::binary_search(reached(w, a.tactors[k]).begin(), reached(w, a.tactors[k]).end(), output))
        ++k;
    return k;
}

std::span<const double> gains_at(const stream_wiring& w, const tactor_spec& t)
{
    return t.channel < w.gains.size() ? std::span<const double>(w.gains[t.channel])
                                      : std::span<const double>();
}

std::string place(const array& a, std::size_t i)
{
    return fmt::format("tactor {} of {} is on channel {}", i, a.name, a.tactors[i].channel);
}

std::string gain_text(double gain)
{
    return fmt::format("{} dB{}", plain_number(20.0 * std::log10(std::abs(gain)), 3),
                       gain < 0.0 ? " with its polarity reversed" : "");
}

// Describes gains that the plan's levels do not include. Empty if there are none.
std::string describe_gains(std::span<const double> gains)
{
    const auto is_one = [](double g) { return std::abs(g - 1.0) <= rounding; };
    if (gains.empty() || (gains.size() == 1 && is_one(gains.front())))
        return {};
    std::vector<std::string> levels;
    for (const double g : gains)
        levels.push_back(gain_text(g));
    if (gains.size() == 1)
        return fmt::format("which ALSA's configuration plays at {}", levels.front());
    return fmt::format("which reaches {} channels of the device, at {}", gains.size(),
                       fmt::join(levels, ", "));
}

} // namespace

std::vector<std::string> wiring_warnings(const array& a, const stream_wiring& w)
{
    std::vector<std::string> all;
    for (std::size_t i = 0; i < a.tactors.size(); ++i)
        if (const std::string odd = describe_gains(gains_at(w, a.tactors[i])); !odd.empty())
            all.push_back(fmt::format("{}, {}", place(a, i), odd));
    if (w.most_gain > 1.0 + rounding)
        all.push_back(fmt::format("ALSA's configuration amplifies samples by up to {} on the way to the "
                                  "device, and clips them there at full scale",
                                  gain_text(w.most_gain)));
    if (!w.level_by.empty())
        all.push_back(fmt::format(
            "a mixer control sets the level of all tactors: {} is between player and device", w.level_by));
    return all;
}

std::string lost_tactor(const array& a, const stream_wiring& w)
{
    if (w.outputs.empty())
        return {};
    for (std::size_t i = 0; i < a.tactors.size(); ++i)
        for (const double g : gains_at(w, a.tactors[i]))
            if (std::abs(g) > 1.0 + rounding)
                return fmt::format("{}, which ALSA's configuration plays at {}: louder than its limit allows",
                                   place(a, i), gain_text(g));
    std::map<unsigned, unsigned> users; // number of tactors by output
    for (const tactor_spec& t : a.tactors)
        for (const unsigned output : reached(w, t))
            ++users[output];
    for (std::size_t i = 0; i < a.tactors.size(); ++i) {
        const std::vector<unsigned>& mine = reached(w, a.tactors[i]);
        if (std::any_of(mine.begin(), mine.end(), [&](unsigned output) { return users[output] == 1; }))
            continue;
        const std::string tactor_text = place(a, i);
        if (mine.empty())
            return tactor_text + ", which reaches no channel of the device";
        const std::size_t other = find_partner_tactor(a, w, i, mine.front());
        return fmt::format("{}, which the PCM mixes with channel {} of tactor {}", tactor_text,
                           a.tactors[other].channel, other);
    }
    return {};
}

} // namespace v0
} // namespace tactor
