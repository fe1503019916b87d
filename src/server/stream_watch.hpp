// SPDX-License-Identifier: MIT
/// \file
/// Carries news of a stream's players to the context's thread.
#pragma once

#include <atomic>
#include <memory>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

#include <tactor/lines.hpp>

#include "server/stream.hpp"

namespace tactor::server {

/// Tells the context's thread that something happened to a player. Outlives both.
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

/// A line that tells the watch when the amplifier goes on or off.
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

} // namespace tactor::server
