// SPDX-License-Identifier: MIT
/// \file
/// Playing as an asynchronous operation of Boost.Asio. Header-only, and not part of <tactor/tactor.hpp>: a
/// program that does not use Asio needs none.
#pragma once

#include <exception>
#include <memory>
#include <type_traits>
#include <utility>

#include <boost/asio/associated_executor.hpp>
#include <boost/asio/async_result.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>

#include <tactor/error.hpp>
#include <tactor/player.hpp>

namespace tactor {
namespace detail {

/// A handler that waits for a stroke's end, and keeps the caller's executor at work until then.
template <typename Handler>
class stroke_waiter {
public:
    explicit stroke_waiter(Handler h)
        : handler_(std::move(h)), work_(boost::asio::get_associated_executor(handler_))
    {
    }

    void operator()(std::exception_ptr failed, stroke_report r)
    {
        auto work = std::move(work_);
        boost::asio::post(work.get_executor(),
                          [h = std::move(handler_), failed = std::move(failed), r = std::move(r)]() mutable {
                              std::move(h)(std::move(failed), std::move(r));
                          });
    }

private:
    using executor = boost::asio::associated_executor_t<Handler>;

    Handler handler_;
    boost::asio::executor_work_guard<executor> work_;
};

/// Calls the handler when the stroke that `id_of` names or starts has ended.
template <typename Handler, typename Start>
void wait_for_stroke(player& p, Handler&& h, Start id_of)
{
    // Shared, because std::function must be able to copy what it holds.
    auto w = std::make_shared<stroke_waiter<std::decay_t<Handler>>>(std::forward<Handler>(h));
    stroke_report none;
    try {
        none.id = id_of();
        if (p.on_end(none.id, [w](const stroke_report& r) { (*w)(nullptr, r); }))
            return;
        throw error(errc::bad_input, "stroke", "it is not known to this player, or was waited for before");
    } catch (...) {
        (*w)(std::current_exception(), none);
    }
}

} // namespace detail

/// Waits for a stroke's end: handler(std::exception_ptr, stroke_report). The handler runs in its associated
/// executor (boost::asio::bind_executor), never in this call and never in a thread of the player; with
/// use_future or use_awaitable the exception is rethrown there. The exception is an error (bad_input) for a
/// stroke that is not known; a stroke that was cancelled or interrupted is none: the report says so. The
/// player must live until the handler was called, or be closed before: closing ends all strokes.
template <typename Token>
auto async_wait(player& p, stroke_id id, Token&& token)
{
    return boost::asio::async_initiate<Token, void(std::exception_ptr, stroke_report)>(
        [&p, id](auto&& handler) {
            detail::wait_for_stroke(p, std::forward<decltype(handler)>(handler), [id] { return id; });
        },
        token);
}

/// Submits a score and waits for its end, as async_wait() does. What submit() throws comes as the exception.
/// The score is submitted when the operation is initiated: at once with callbacks and futures.
template <typename Token>
auto async_play(player& p, score s, start_at start, Token&& token)
{
    return boost::asio::async_initiate<Token, void(std::exception_ptr, stroke_report)>(
        [&p, s = std::move(s), start](auto&& handler) {
            detail::wait_for_stroke(p, std::forward<decltype(handler)>(handler),
                                    [&p, &s, start] { return p.submit(s, start); });
        },
        token);
}

} // namespace tactor
