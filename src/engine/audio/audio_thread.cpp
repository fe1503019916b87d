// SPDX-License-Identifier: MIT
#include "engine/audio/audio_thread.hpp"

#include <latch>

#include <sys/resource.h>

#include "rt/clock.hpp"

namespace tactor::engine {
namespace {

// Counter of this thread's page faults after its first wake-ups, which touch its memory. Reads once a second.
class fault_watch {
public:
    explicit fault_watch(counters& c) noexcept : count_(c) {}

    void step(std::int64_t now) noexcept
    {
        constexpr unsigned warm_up = 16;
        if (steps_ < warm_up) {
            if (++steps_ == warm_up && getrusage(RUSAGE_THREAD, &before_) == 0)
                looked_ns_ = now;
        } else if (now - looked_ns_ >= rt::ns_per_s) {
            look();
            looked_ns_ = now;
        }
    }

    void look() noexcept
    {
        rusage u{};
        if (looked_ns_ == 0 || getrusage(RUSAGE_THREAD, &u) != 0)
            return;
        const auto store = [](std::atomic<std::uint64_t>& a, long n) {
            a.store(static_cast<std::uint64_t>(n), std::memory_order_relaxed);
        };
        store(count_.minor_faults, u.ru_minflt - before_.ru_minflt);
        store(count_.major_faults, u.ru_majflt - before_.ru_majflt);
    }

private:
    counters& count_;
    rusage before_{};
    std::int64_t looked_ns_ = 0;
    unsigned steps_ = 0;
};

} // namespace

audio_thread::audio_thread(audio_loop& loop, sink& s, link& l, const rt::thread_options& o)
    : loop_(loop), sink_(s), link_(l), fds_(s.max_descriptors() + 1)
{
    std::latch begun(1);
    // The thread itself starts the stream: ALSA's handle belongs to one thread, and nothing may delay the
    // first period after the start.
    thread_ = std::make_unique<rt::thread>(o, [this, &begun] {
        started_ = loop_.start(rt::monotonic_ns());
        begun.count_down();
        if (started_.status == io_kind::ok)
            run();
    });
    begun.wait();
}

void audio_thread::run() noexcept TACTOR_NONBLOCKING
{
    fault_watch faults(link_.count);
    rt::busy_watch busy;
    while (!loop_.over()) {
        const io_kind ready = wait();
        const std::int64_t now = rt::monotonic_ns();
        loop_.step(ready, now);
        faults.step(now);
        if (busy.look(now)) {
            link_.count.realtime_given_up.store(true, std::memory_order_relaxed);
            link_.to_control.signal();
        }
    }
    faults.look();
    link_.to_control.signal();
}

io_kind audio_thread::wait() noexcept
{
    const rt::permitted_call here{};
    const bool asks_sink = loop_.polls_sink();
    const std::size_t n =
        asks_sink ? sink_.descriptors(std::span(fds_).first(fds_.size() - 1)) : std::size_t{0};
    fds_[n] = {.fd = link_.to_audio.fd(), .events = POLLIN, .revents = 0};

    const timespec timeout = rt::to_timespec(loop_.timeout_ns());
    if (::ppoll(fds_.data(), n + 1, &timeout, nullptr) < 0)
        return io_kind::again;
    if (fds_[n].revents != 0)
        link_.to_audio.consume();
    return asks_sink ? sink_.ready(std::span(fds_).first(n)) : io_kind::again;
}

} // namespace tactor::engine
