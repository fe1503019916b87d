// SPDX-License-Identifier: MIT
// Ends of a stream: it rests without strokes, is given up, or closes.
#include <utility>

#include <boost/asio/post.hpp>

#include "server/clock.hpp"
#include "server/stream_watch.hpp"

namespace tactor::server {
namespace {

constexpr double going_pause_s = 0.5;

} // namespace

void stream::tell_going()
{
    going_.cancel();
    if (!busy_ || player_ == nullptr || !options_.going)
        return;
    options_.going(setup_.channels);
    going_.expires_after(steady_seconds(going_pause_s));
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
    if (is || options_.idle_stop_s <= 0.0 || player_ == nullptr || closing_ || state_ == stream_state::lost)
        return;
    idle_.expires_after(steady_seconds(options_.idle_stop_s));
    idle_.async_wait([this](const boost::system::error_code& e) {
        if (e || busy_ || player_ == nullptr || closing_ || player_->ended())
            return;
        set(stream_state::idle, "nothing was drawn for a while; the next stroke starts it");
        retire({});
    });
}

// Opens nothing again while an amplifier may be on, as `play` does.
void stream::give_up()
{
    left_on_ = true;
    watch_->amplifier_on = true;
    set(stream_state::lost, "the amplifier may be on: its line cannot be switched off (cut the amplifier's "
                            "supply, then start the service again)");
    tell_waiting();
}

void stream::close(std::function<void()> done)
{
    closing_ = true;
    again_.cancel();
    idle_.cancel();
    proof_.cancel();
    set(stream_state::closing, "the server ends");
    tell_waiting();
    if (player_ != nullptr)
        return retire(std::move(done));
    if (opening_) {
        closed_ = std::move(done);
        return;
    }
    // The worker retires players before it comes to this.
    boost::asio::post(worker_, [this, done = std::move(done)] { boost::asio::post(io_, done); });
}

} // namespace tactor::server
