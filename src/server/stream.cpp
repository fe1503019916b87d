// SPDX-License-Identifier: MIT
#include "server/stream.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <span>
#include <system_error>

#include <boost/asio/post.hpp>
#include <fcntl.h>

#include <tactor/error.hpp>

namespace tactor::server {
namespace {

// Returns true if the device exists but does not support the configuration. Then the error names a field.
bool is_unsupported_config(const std::exception_ptr& failure)
try {
    if (failure != nullptr)
        std::rethrow_exception(failure);
    return false;
} catch (const error& e) {
    return e.kind() == error_kind::bad_input || !e.field().empty();
} catch (const std::exception&) {
    return false;
}

float magnitude(const std::byte* p, format_kind f) noexcept
{
    const std::size_t bytes = f == format_kind::s24_4 ? 3 : sample_bytes(f);
    std::uint32_t bits = 0; // the sample, in the highest bits
    for (std::size_t i = 0; i < bytes; ++i)
        bits |= static_cast<std::uint32_t>(p[i]) << 8U * (4 - bytes + i);
    if (f == format_kind::float32)
        return std::abs(std::bit_cast<float>(bits));
    return std::abs(static_cast<float>(static_cast<std::int32_t>(bits))) / 2147483648.0F;
}

class meter_sink final : public sink {
public:
    meter_sink(std::unique_ptr<sink> s, std::shared_ptr<level_peaks> peaks)
        : inner_(std::move(s)), peaks_(std::move(peaks))
    {
    }

    const stream_setup& setup() const noexcept override { return inner_->setup(); }
    io_kind prepare() noexcept override { return inner_->prepare(); }
    io_kind start() noexcept override { return inner_->start(); }
    io_kind resume() noexcept override { return inner_->resume(); }
    std::int64_t xrun_ns() noexcept override { return inner_->xrun_ns(); }
    std::size_t max_descriptors() const noexcept override { return inner_->max_descriptors(); }
    std::size_t descriptors(std::span<pollfd> f) noexcept override { return inner_->descriptors(f); }
    io_kind ready(std::span<pollfd> f) noexcept override { return inner_->ready(f); }
    io_result available() noexcept override { return inner_->available(); }
    stream_position position() noexcept override { return inner_->position(); }
    void drop() noexcept override { inner_->drop(); }

    io_result write(std::span<const std::byte> frames) noexcept override
    {
        const io_result r = inner_->write(frames);
        if (peaks_->listens())
            look(frames.data(), r.frames);
        return r;
    }

private:
    void look(const std::byte* data, std::size_t frames) noexcept
    {
        const stream_setup& s = inner_->setup();
        const std::size_t step = sample_bytes(s.format);
        const std::size_t channels = std::min<std::size_t>(s.channels, peaks_->size());
        for (std::size_t c = 0; c < channels; ++c) {
            float most = 0.0F;
            for (std::size_t f = 0; f < frames; ++f)
                most = std::max(most, magnitude(data + (f * s.channels + c) * step, s.format));
            if (most > 0.0F)
                peaks_->raise(c, most);
        }
    }

    std::unique_ptr<sink> inner_;
    std::shared_ptr<level_peaks> peaks_;
};

} // namespace

void level_peaks::raise(std::size_t channel, float peak) noexcept
{
    std::atomic<float>& p = peaks_[channel];
    float seen = p.load(std::memory_order_relaxed);
    // The reading thread only sets the peak to 0, so the loop ends after few attempts.
    while (peak > seen && !p.compare_exchange_weak(seen, peak, std::memory_order_relaxed)) {
    }
}

float level_peaks::take(std::size_t channel) noexcept
{
    return peaks_[channel].exchange(0.0F, std::memory_order_relaxed);
}

std::unique_ptr<sink> add_meter(std::unique_ptr<sink> s, std::shared_ptr<level_peaks> peaks)
{
    return std::make_unique<meter_sink>(std::move(s), std::move(peaks));
}

int copy_descriptor(int descriptor)
{
    const int copy = ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
    if (copy < 0)
        throw std::system_error(errno, std::generic_category(), "dup");
    return copy;
}

stream::stream(boost::asio::io_context& io, stream_options o)
    : device_stream(make_parts(*this, static_cast<const session::stream_parts&>(o))),
      io_(io),
      changed_(std::move(o.changed)),
      refused_(std::move(o.refused)),
      peaks_(std::make_shared<level_peaks>(std::max(o.wished.channels, o.tactors.channels()))),
      told_(state(), reason()),
      again_(io),
      news_(io, copy_descriptor(descriptor()))
{
    await_news();
}

stream::~stream()
{
    worker_.join();
    finish();
}

// Makes handlers run in the context's thread, and inserts the level meter.
session::stream_parts stream::make_parts(stream& s, session::stream_parts p)
{
    p.open = [&s, open = std::move(p.open)] { return add_meter(open(), s.peaks_); };
    p.begun = [&s, begun = std::move(p.begun)](auto... all) { s.hand_over([=] { begun(all...); }); };
    p.ended = [&s, ended = std::move(p.ended)](auto... all) { s.hand_over([=] { ended(all...); }); };
    return p;
}

void stream::hand_over(std::function<void()> report)
{
    const std::lock_guard lock(reports_mutex_);
    reports_.push_back(std::move(report));
    if (reports_.size() == 1)
        boost::asio::post(io_, [this] { pass_report(); });
}

// Passes one report to its handler, then posts the next. A stop may end thousands of strokes, and clients
// must get their turns between the reports.
void stream::pass_report()
{
    std::unique_lock lock(reports_mutex_);
    const std::function<void()>& report =
        reports_.front(); // the reference stays valid while other threads append reports
    lock.unlock();
    report();
    lock.lock();
    reports_.pop_front();
    if (!reports_.empty())
        return boost::asio::post(io_, [this] { pass_report(); });
    lock.unlock();
    report_state();
}

bool stream::has_no_reports()
{
    const std::lock_guard lock(reports_mutex_);
    return reports_.empty();
}

void stream::await_news()
{
    news_.async_wait(boost::asio::posix::descriptor_base::wait_read,
                     [this](const boost::system::error_code& e) {
                         if (e)
                             return;
                         take_news();
                         await_news();
                         go_on();
                     });
}

void stream::go_on()
{
    again_.cancel();
    // Requests that wait for the stream also count. Otherwise the end of one stroke could close the stream
    // before the next stroke begins.
    set_busy(busy_ || !waiting_.empty());
    if (const auto again = step()) {
        again_.expires_at(*again);
        again_.async_wait([this](const boost::system::error_code& e) {
            if (!e)
                go_on();
        });
    }
    if (number() != 0 || failure() != nullptr)
        if (const auto refused = std::exchange(refused_, {}); refused && is_unsupported_config(failure()))
            return refused(failure());
    if (begin_work())
        boost::asio::post(worker_, [this] {
            work();
            boost::asio::post(io_, [this] { go_on(); });
        });
    report_state();
}

bool stream::is_ready() const
{
    return current() != nullptr || is_unavailable() || state() == stream_state::closing;
}

void stream::report_state()
{
    if (std::pair now(state(), reason()); now != told_) {
        told_ = std::move(now);
        changed_(state(), reason());
    }
    if (is_ready() && !waiting_.empty()) {
        while (!waiting_.empty()) {
            const std::function<void()> ready = std::move(waiting_.front());
            waiting_.pop_front();
            ready();
        }
        return go_on();
    }
    if (closed_ && is_over() && has_no_reports())
        boost::asio::post(io_, std::exchange(closed_, {}));
}

void stream::call_when_ready(std::function<void()> ready)
{
    if (is_ready())
        return ready();
    waiting_.push_back(std::move(ready));
    wake();
    go_on();
}

void stream::cancel_all()
{
    device_stream::cancel_all();
    go_on();
}

void stream::set_has_strokes(bool is)
{
    busy_ = is;
    go_on();
}

bool stream::has_progressed()
{
    // A suspended device makes no progress until the system wakes up.
    return current() == nullptr || !current()->position().running ||
           current()->stats().periods != std::exchange(seen_periods_, current()->stats().periods);
}

void stream::close(std::function<void()> done)
{
    refused_ = {};
    closed_ = std::move(done);
    end();
    go_on();
}

} // namespace tactor::server
