// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cerrno>
#include <span>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sys/timerfd.h>

#include <tactor/error.hpp>
#include <tactor/sink.hpp>

#include "core/bounds.hpp"
#include "core/refused.hpp"
#include "sink/pacer.hpp"

namespace tactor::detail {
namespace {

constexpr std::uint64_t second = 1'000'000'000;

} // namespace

pacer::pacer(unsigned rate, unsigned buffer_frames, unsigned period_frames)
    : virtual_queue(rate, buffer_frames),
      period_(period_frames),
      fd_(::timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC))
{
    if (!fd_)
        throw std::system_error(errno, std::generic_category(), "timerfd");
}

void pacer::start(std::uint64_t written) noexcept
{
    virtual_queue::start(rt::monotonic_ns(), written);
}

void pacer::arm() noexcept
{
    const std::int64_t t = room_time_ns(period_);
    itimerspec when{};
    when.it_value = rt::to_timespec(t);
    // Setting the timer also clears expirations, so nothing needs to read them.
    ::timerfd_settime(fd_.get(), TFD_TIMER_ABSTIME, &when, nullptr);
}

// Returns the duration of `frames` frames, ns, rounded up. Computes whole seconds separately, so that years
// do not overflow.
std::int64_t virtual_queue::duration(std::uint64_t frames) const noexcept
{
    const std::uint64_t rest = frames % rate_;
    return static_cast<std::int64_t>(frames / rate_ * second + (rest * second + rate_ - 1) / rate_);
}

void virtual_queue::start(std::int64_t now, std::uint64_t written) noexcept
{
    origin_ = now;
    written_ = written;
}

std::uint64_t virtual_queue::played(std::int64_t now) noexcept
{
    const auto t = static_cast<std::uint64_t>(now - origin_);
    const std::uint64_t due = t / second * rate_ + t % second * rate_ / second;
    if (due <= written_)
        return due;
    origin_ = now - duration(written_);
    return written_;
}

std::uint64_t virtual_queue::available(std::int64_t now) noexcept
{
    const std::uint64_t queued = written_ - played(now);
    return queued < buffer_ ? buffer_ - queued : 0;
}

std::int64_t virtual_queue::room_time_ns(std::uint64_t frames) const noexcept
{
    const std::uint64_t least_played = written_ + frames > buffer_ ? written_ + frames - buffer_ : 0;
    return origin_ + duration(least_played);
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {
namespace {

void check(const char* field, const char* what, unsigned value, unsigned lo, unsigned hi)
{
    if (value < lo || value > hi)
        throw error(error_kind::bad_input, "paced_sink", fmt::format("{} {} is out of range", value, what),
                    fmt::format("give {} to {}", lo, hi))
            .with_field(field);
}

stream_setup require_valid(stream_setup s)
{
    constexpr unsigned most_frames = 1U << 24;
    if (s.period_frames == 0)
        s.period_frames = 96;
    if (s.buffer_frames == 0)
        s.buffer_frames = 3 * s.period_frames;
    check("channels", "channels", s.channels, 1, detail::max_channels);
    check("rate", "Hz", s.rate, 8000, 768000);
    check("period_frames", "frames in a period", s.period_frames, detail::min_period_frames(s.rate),
          most_frames / 2);
    check("buffer_frames", "frames in the buffer", s.buffer_frames, 2 * s.period_frames, most_frames);
    s.has_clock = false;
    return s;
}

detail::pacer make_pacer(const stream_setup& s)
try {
    return detail::pacer(s.rate, s.buffer_frames, s.period_frames);
} catch (const std::system_error& e) {
    detail::throw_resource_error(s.name, e.code().value(), e.what());
}

} // namespace

// These are here because alsa/ and engine/ both build on this folder.
sink::~sink() = default;

std::int64_t sink::xrun_ns() noexcept
{
    return 0;
}

struct paced_sink::impl {
    explicit impl(stream_setup s)
        : setup(require_valid(std::move(s))), frame_bytes(setup.frame_bytes()), pacer(make_pacer(setup))
    {
    }

    std::size_t available() noexcept
    {
        return running ? static_cast<std::size_t>(pacer.available())
                       : setup.buffer_frames - static_cast<std::size_t>(written);
    }

    stream_setup setup;
    std::size_t frame_bytes;
    detail::pacer pacer;
    std::uint64_t written = 0; // in this epoch
    bool running = false;
};

paced_sink::paced_sink(stream_setup s) : impl_(std::make_unique<impl>(std::move(s)))
{
}

paced_sink::~paced_sink() = default;

const stream_setup& paced_sink::setup() const noexcept
{
    return impl_->setup;
}

io_kind paced_sink::prepare() noexcept
{
    impl_->running = false;
    impl_->written = 0;
    return io_kind::ok;
}

io_kind paced_sink::start() noexcept
{
    impl_->pacer.start(impl_->written);
    impl_->running = true;
    return io_kind::ok;
}

io_kind paced_sink::resume() noexcept
{
    return io_kind::ok;
}

std::size_t paced_sink::max_descriptors() const noexcept
{
    return 1;
}

std::size_t paced_sink::descriptors(std::span<pollfd> fds) noexcept
{
    impl_->pacer.arm();
    fds[0] = {.fd = impl_->pacer.fd(), .events = POLLIN, .revents = 0};
    return 1;
}

io_kind paced_sink::ready(std::span<pollfd>) noexcept
{
    return impl_->pacer.due() ? io_kind::ok : io_kind::again;
}

io_result paced_sink::available() noexcept
{
    return {io_kind::ok, impl_->available(), 0};
}

io_result paced_sink::write(std::span<const std::byte> frames) noexcept
{
    const std::size_t bytes = impl_->frame_bytes;
    const std::size_t all = std::min(frames.size() / bytes, impl_->available());
    for (std::size_t done = 0; done < all;) {
        const std::size_t n = std::min<std::size_t>(all - done, impl_->setup.period_frames);
        const io_kind s = take(impl_->written, frames.subspan(done * bytes, n * bytes));
        if (s != io_kind::ok)
            return {s, done, 0};
        done += n;
        impl_->written += n;
        if (impl_->running)
            impl_->pacer.wrote(n);
    }
    return {all == 0 ? io_kind::again : io_kind::ok, all, 0};
}

stream_position paced_sink::position() noexcept
{
    const std::int64_t now = rt::monotonic_ns();
    const std::uint64_t played = impl_->running ? impl_->pacer.played(now) : 0;
    return {impl_->written, played, now, impl_->running};
}

void paced_sink::drop() noexcept
{
    impl_->running = false;
}

} // namespace v0
} // namespace tactor
