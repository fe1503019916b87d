// SPDX-License-Identifier: MIT
#include "server/stream.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <utility>

#include <boost/asio/post.hpp>

#include <tactor/error.hpp>

#include "server/clock.hpp"
#include "server/stream_watch.hpp"
#include "session/play_session.hpp"

namespace tactor::server {

std::string_view name_of(stream_state s) noexcept
{
    constexpr std::array<std::string_view, 5> names{"running", "idle", "lost", "muted", "closing"};
    return names[static_cast<std::size_t>(s)];
}

namespace {

constexpr double longest_pause_s = 5.0;

} // namespace

stream::stream(boost::asio::io_context& io, stream_options o, handlers h)
    : io_(io),
      options_(std::move(o)),
      handlers_(std::move(h)),
      watch_(std::make_shared<watch>(io)),
      peaks_(std::make_shared<level_peaks>(std::max(options_.wished.channels, options_.tactors.channels()))),
      setup_(options_.wished),
      again_(io),
      proof_(io),
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
    const double proof_s = tried_ && state_ == stream_state::lost ? options_.proof_s : 0.0;
    boost::asio::post(worker_, [this, w = watch_, number = number_ + 1, driven = driven_, proof_s] {
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
            lines.proof_s = proof_s;
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
            // A device that is there and cannot do it names the field that is in the way.
            if (e.kind() == error_kind::bad_input || !e.field().empty())
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
        if (closing_)
            return retire(std::exchange(closed_, {}));
        if (first || state_ != stream_state::lost)
            run();
        else
            prove();
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

void stream::run()
{
    pause_s_ = options_.retry_s;
    set(stream_state::running, "");
    busy(busy_);
}

// That it opens proves little: a full disk or a loose cable shows with the first periods.
void stream::prove()
{
    proof_.expires_after(steady_seconds(options_.proof_s));
    proof_.async_wait([this, number = number_](const boost::system::error_code& e) {
        if (e || player_ == nullptr || number != number_ || closing_ || player_->ended())
            return;
        run();
        look();
    });
}

void stream::tell_waiting()
{
    for (const auto& ready : std::exchange(waiting_, {}))
        ready();
}

void stream::retry()
{
    again_.expires_after(steady_seconds(pause_s_));
    pause_s_ = std::min(2.0 * pause_s_, longest_pause_s);
    again_.async_wait([this](const boost::system::error_code& e) {
        if (!e && !closing_ && player_ == nullptr && !opening_ && !left_on_)
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
    proof_.cancel();
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
            session::add_stats(before_, last);
            driven_ = driven.value_or(driven_);
            if (driven && options_.settled)
                options_.settled(*driven);
            if (last.left_on && !closing_)
                give_up();
            else if (!waiting_.empty() && !closing_)
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
        session::add_stats(all, player_->stats());
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

} // namespace tactor::server
