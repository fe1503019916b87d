// SPDX-License-Identifier: MIT
#include "server/stream.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <exception>
#include <utility>

#include <boost/asio/post.hpp>

#include <tactor/error.hpp>

namespace tactor::server {
namespace {

constexpr double longest_pause_s = 5.0;
constexpr double going_pause_s = 0.5;

std::chrono::steady_clock::duration duration(double seconds)
{
    return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(seconds));
}

} // namespace

std::string_view name_of(stream_state s) noexcept
{
    constexpr std::array<std::string_view, 5> names{"running", "idle", "lost", "muted", "closing"};
    return names[static_cast<std::size_t>(s)];
}

/// What the player's threads tell the context's: that something happened. Outlives both.
struct stream::watch : std::enable_shared_from_this<stream::watch> {
    explicit watch(boost::asio::io_context& c) : io(c) {}

    void stir()
    {
        if (stirred.exchange(true))
            return;
        boost::asio::post(io, [self = shared_from_this()] {
            self->stirred = false;
            if (self->owner != nullptr)
                self->owner->look();
        });
    }

    boost::asio::io_context& io;
    stream* owner = nullptr; ///< the context's thread
    std::atomic<bool> stirred{false};
    std::atomic<bool> amplifier_on{false};
    std::atomic<bool> was_on{false}; ///< by this player
};

namespace {

template <typename Watch>
class watched_line final : public enable_line {
public:
    watched_line(std::unique_ptr<enable_line> l, std::shared_ptr<Watch> w)
        : line_(std::move(l)), watch_(std::move(w))
    {
    }
    ~watched_line() override { watch_->amplifier_on = false; }
    watched_line(const watched_line&) = delete;
    watched_line& operator=(const watched_line&) = delete;

    bool set(bool on) noexcept override
    {
        const bool done = line_->set(on);
        if (!done || watch_->amplifier_on.exchange(on) == on)
            return done;
        if (on)
            watch_->was_on = true;
        try {
            watch_->stir();
        } catch (...) { // NOLINT(bugprone-empty-catch): told with what happens next
        }
        return done;
    }
    bool beat() noexcept override { return line_->beat(); }

private:
    std::unique_ptr<enable_line> line_;
    std::shared_ptr<Watch> watch_;
};

void add(player_stats& sum, const player_stats& more)
{
    sum.periods += more.periods;
    sum.frames += more.frames;
    sum.xruns += more.xruns;
    sum.realtime = more.realtime;
}

} // namespace

stream::stream(boost::asio::io_context& io, stream_options o, handlers h)
    : io_(io),
      options_(std::move(o)),
      handlers_(std::move(h)),
      watch_(std::make_shared<watch>(io)),
      peaks_(std::make_shared<level_peaks>(std::max(options_.wished.channels, options_.tactors.channels()))),
      setup_(options_.wished),
      again_(io),
      idle_(io),
      going_(io)
{
    watch_->owner = this;
}

stream::~stream()
{
    watch_->owner = nullptr;
    worker_.join();
}

void stream::start()
{
    pause_s_ = options_.retry_s;
    open();
}

void stream::when_ready(std::function<void()> ready)
{
    if (player_ == nullptr && !closing_ && (opening_ || retiring_ || state_ == stream_state::idle)) {
        waiting_.push_back(std::move(ready));
        if (!opening_ && !retiring_)
            open();
        return;
    }
    ready();
}

// In the worker: what blocks. In the context's thread again: opened().
void stream::open()
{
    opening_ = true;
    if (options_.driven)
        driven_ = options_.driven();
    boost::asio::post(worker_, [this, w = watch_, number = number_ + 1, driven = driven_] {
        std::unique_ptr<player> p;
        std::string failure;
        std::exception_ptr bad;
        try {
            player_options o = options_.player;
            o.driven = driven;
            o.log = [w, log = options_.log](log_kind k, std::string_view text) {
                if (log)
                    log(k, text);
                w->stir();
            };
            player_lines lines = options_.lines ? options_.lines() : player_lines{};
            w->was_on = false;
            if (lines.amplifier != nullptr)
                lines.amplifier = std::make_unique<watched_line<watch>>(std::move(lines.amplifier), w);
            p = std::make_unique<player>(metered(options_.open(), peaks_), options_.tactors, o,
                                         std::move(lines));
            p->on_begin([w, number](stroke_id id, std::optional<std::int64_t> at_ns) {
                boost::asio::post(w->io, [w, number, id, at_ns] {
                    if (w->owner != nullptr)
                        w->owner->handlers_.begun(number, id, at_ns);
                });
            });
            p->on_report([w, number](const stroke_report& r) {
                boost::asio::post(w->io, [w, number, r] {
                    if (w->owner != nullptr)
                        w->owner->handlers_.ended(number, r);
                });
                w->stir();
            });
        } catch (const error& e) {
            failure = e.what();
            if (e.kind() == error_kind::bad_input)
                bad = std::current_exception();
        } catch (const std::exception& e) {
            failure = e.what();
        }
        const auto made = std::make_shared<std::unique_ptr<player>>(std::move(p));
        boost::asio::post(
            io_, [this, made, failure = std::move(failure), bad] { opened(std::move(*made), failure, bad); });
    });
}

void stream::opened(std::unique_ptr<player> p, std::string failure, const std::exception_ptr& bad)
{
    opening_ = false;
    const bool first = !std::exchange(tried_, true);
    if (bad != nullptr && first && !closing_ && options_.refused)
        return options_.refused(bad);
    if (p != nullptr) {
        player_ = std::move(p);
        ++number_;
        setup_ = player_->setup();
        pause_s_ = options_.retry_s;
        if (closing_)
            return retire(std::exchange(closed_, {}));
        set(stream_state::running, "");
        busy(busy_);
        tell_waiting();
        return look();
    }
    if (closing_) {
        tell_waiting();
        if (closed_)
            std::exchange(closed_, {})();
        return;
    }
    set(stream_state::lost, failure);
    tell_waiting();
    retry();
}

void stream::tell_waiting()
{
    for (const auto& ready : std::exchange(waiting_, {}))
        ready();
}

void stream::retry()
{
    again_.expires_after(duration(pause_s_));
    pause_s_ = std::min(2.0 * pause_s_, longest_pause_s);
    again_.async_wait([this](const boost::system::error_code& e) {
        if (!e && !closing_ && player_ == nullptr && !opening_)
            open();
    });
}

// Something happened: did the stream end, is the amplifier off?
void stream::look()
{
    if (player_ == nullptr || closing_)
        return;
    if (const auto end = player_->ended()) {
        set(stream_state::lost, end->reason == reason_kind::none ? "the stream was stopped" : end->why);
        return retire([this] { retry(); });
    }
    if (!options_.has_amplifier || (state_ != stream_state::running && state_ != stream_state::muted))
        return;
    const bool muted = watch_->was_on && !watch_->amplifier_on;
    set(muted ? stream_state::muted : stream_state::running,
        muted ? "the amplifier is off until the stream is sound" : "");
}

// Closes the player where that may block; its reports come before `then`.
void stream::retire(std::function<void()> then)
{
    retiring_ = true;
    idle_.cancel();
    std::shared_ptr<player> p(std::move(player_));
    boost::asio::post(worker_, [this, p = std::move(p), then = std::move(then)]() mutable {
        p->stop();
        player_stats last = p->stats();
        std::optional<drive_history> driven;
        try {
            driven = p->history();
        } catch (const error&) { // NOLINT(bugprone-empty-catch): what was known before still counts
        }
        p.reset();
        boost::asio::post(io_, [this, last = std::move(last), driven = std::move(driven), then] {
            retiring_ = false;
            add(before_, last);
            driven_ = driven.value_or(driven_);
            if (driven && options_.settled)
                options_.settled(*driven);
            if (!waiting_.empty() && !closing_)
                open();
            if (then)
                then();
        });
    });
}

player_stats stream::stats() const
{
    player_stats all = before_;
    if (player_ != nullptr)
        add(all, player_->stats());
    return all;
}

std::string_view stream::amplifier() const noexcept
{
    return !options_.has_amplifier ? "none" : watch_->amplifier_on ? "on" : "off";
}

bool stream::progresses()
{
    if (player_ == nullptr)
        return true;
    return player_->stats().periods != std::exchange(seen_periods_, player_->stats().periods);
}

void stream::tell_going()
{
    going_.cancel();
    if (!busy_ || player_ == nullptr || !options_.going)
        return;
    options_.going(setup_.channels);
    going_.expires_after(duration(going_pause_s));
    going_.async_wait([this](const boost::system::error_code& e) {
        if (!e)
            tell_going();
    });
}

void stream::busy(bool is)
{
    busy_ = is;
    idle_.cancel();
    tell_going();
    if (is || options_.idle_stop_s <= 0.0 || player_ == nullptr || closing_)
        return;
    idle_.expires_after(duration(options_.idle_stop_s));
    idle_.async_wait([this](const boost::system::error_code& e) {
        if (e || busy_ || player_ == nullptr || closing_ || player_->ended())
            return;
        set(stream_state::idle, "nothing was drawn for a while; the next stroke starts it");
        retire({});
    });
}

void stream::set(stream_state s, std::string reason)
{
    if (s == state_ && reason == reason_)
        return;
    state_ = s;
    reason_ = std::move(reason);
    if (options_.changed)
        options_.changed(state_, reason_);
    handlers_.changed(state_, reason_);
}

void stream::close(std::function<void()> done)
{
    closing_ = true;
    again_.cancel();
    idle_.cancel();
    set(stream_state::closing, "the server ends");
    tell_waiting();
    if (player_ != nullptr)
        return retire(std::move(done));
    if (opening_) {
        closed_ = std::move(done);
        return;
    }
    // What is being retired comes before this in the worker.
    boost::asio::post(worker_, [this, done = std::move(done)] { boost::asio::post(io_, done); });
}

} // namespace tactor::server
