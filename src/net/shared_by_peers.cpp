// SPDX-License-Identifier: MIT
#include "net/shared_by_peers.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <boost/asio/post.hpp>

namespace tactor::net {

byte_budget::share::share(const byte_budget& all, std::function<void()> give_up)
    : all_(all.all_), give_up_(std::move(give_up))
{
    all_->shares.insert(this);
}

byte_budget::share::~share()
{
    leave();
}

bool byte_budget::share::add(std::size_t n)
{
    if (!all_->shares.contains(this))
        return false;
    const auto least = [&](const share* a, const share* b) {
        return a->held_ + (a == this ? n : 0) < b->held_ + (b == this ? n : 0);
    };
    while (all_->held + n > all_->most) {
        share* most = *std::max_element(all_->shares.begin(), all_->shares.end(), least);
        most->give_up();
        if (most == this)
            return false;
    }
    held_ += n;
    all_->held += n;
    return true;
}

void byte_budget::share::take(std::size_t n) noexcept
{
    n = std::min(n, held_);
    held_ -= n;
    all_->held -= n;
}

bool byte_budget::share::hold(std::size_t n)
{
    if (n > held_)
        return add(n - held_);
    take(held_ - n);
    return all_->shares.contains(this);
}

void byte_budget::share::give_up()
{
    leave();
    if (give_up_)
        std::exchange(give_up_, {})();
}

void byte_budget::share::leave() noexcept
{
    take(held_);
    all_->shares.erase(this);
}

void message_turns::join(std::function<void()> on_turn)
{
    waiting_.push_back(std::move(on_turn));
    if (!busy_)
        next();
}

void message_turns::pass()
{
    busy_ = false;
    if (!waiting_.empty())
        next();
}

void message_turns::next()
{
    busy_ = true;
    boost::asio::post(io_, [on_turn = std::move(waiting_.front())] { on_turn(); });
    waiting_.pop_front();
}

void short_turns::join(std::function<void()> on_turn)
{
    waiting_.push_back(std::move(on_turn));
    if (!std::exchange(posted_, true))
        boost::asio::post(io_, [this] { run(); });
}

// Runs turns for a millisecond, then posts the rest: Asio looks at the sockets between two posts.
void short_turns::run()
{
    using clock = std::chrono::steady_clock;
    constexpr std::chrono::milliseconds most{1};
    posted_ = false;
    const clock::time_point end = clock::now() + most;
    for (std::size_t n = waiting_.size(); n != 0 && clock::now() < end; --n) {
        const auto on_turn = std::move(waiting_.front());
        waiting_.pop_front();
        on_turn();
    }
    if (!waiting_.empty() && !std::exchange(posted_, true))
        boost::asio::post(io_, [this] { run(); });
}

} // namespace tactor::net
