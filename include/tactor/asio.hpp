// SPDX-License-Identifier: MIT
/// \file
/// Playback as an asynchronous operation of Boost.Asio. Header-only. <tactor/tactor.hpp> does not include
/// this header, so that other programs need no Asio.
#pragma once

#include <exception>
#include <memory>
#include <type_traits>
#include <utility>

#include <boost/asio/associated_executor.hpp>
#include <boost/asio/async_result.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/system_executor.hpp>

#include <tactor/error.hpp>
#include <tactor/player.hpp>

namespace tactor::detail {

/// A handler that waits for a stroke's end. Until then it keeps work on two executors: that of the wrapped
/// handler, and the one that the caller named.
template <typename Handler, typename Named>
class stroke_waiter {
public:
    stroke_waiter(Handler h, const Named& named)
        : handler_(std::move(h)), named_(named), work_(boost::asio::get_associated_executor(handler_, named))
    {
    }

    void operator()(std::exception_ptr failed, stroke_report r)
    {
        const auto named = std::move(named_); // until the handler has been posted
        auto work = std::move(work_);
        boost::asio::post(work.get_executor(),
                          [h = std::move(handler_), failed = std::move(failed), r = std::move(r)]() mutable {
                              std::move(h)(std::move(failed), std::move(r));
                          });
    }

private:
    using executor = boost::asio::associated_executor_t<Handler, Named>;

    Handler handler_;
    boost::asio::executor_work_guard<Named> named_;
    boost::asio::executor_work_guard<executor> work_;
};

/// Returns `where` if it is an executor, else the executor of `where`: a context, a socket or a timer.
template <typename Where>
auto find_executor(Where& where)
{
    if constexpr (requires { where.get_executor(); })
        return where.get_executor();
    else
        return where;
}

/// True for a completion token that is a plain callback, which names no context to run in.
template <typename Token>
constexpr bool runs_nowhere = std::is_invocable_v<std::decay_t<Token>&, std::exception_ptr, stroke_report>&&
    std::is_same_v<boost::asio::associated_executor_t<std::decay_t<Token>>, boost::asio::system_executor>;

/// Calls the handler when a stroke has ended. `start` returns the stroke's id, and may start the stroke.
template <typename Named, typename Handler, typename Start>
void wait_for_stroke(const Named& named, player& p, Handler&& h, Start start)
{
    // Shared, because std::function needs a copyable target.
    auto w = std::make_shared<stroke_waiter<std::decay_t<Handler>, Named>>(std::forward<Handler>(h), named);
    stroke_report none;
    try {
        none.id = start();
        if (p.on_end(none.id, [w](const stroke_report& r) { (*w)(nullptr, r); }))
            return;
        throw error(error_kind::bad_input, "stroke",
                    "it is not known to this player, or was waited for before");
    } catch (...) {
        (*w)(std::current_exception(), none);
    }
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

/// Waits for a stroke's end, then calls handler(std::exception_ptr, stroke_report). `where` is an executor,
/// or an object with an executor such as an io_context or a socket.
///
/// The handler runs on its associated executor (boost::asio::bind_executor) if it has one, else on that of
/// `where`. It never runs inside this call, and never in a thread of the player. With use_future or
/// use_awaitable, the future or the coroutine rethrows the exception. Both executors have work until the
/// handler runs, so io_context::run() does not return earlier.
///
/// For an unknown stroke the exception is an error (bad_input). A cancelled or interrupted stroke gives no
/// exception: see the report. The player must live until the handler is called, or be closed earlier: closing
/// the player ends all strokes.
template <typename Where, typename Token>
auto async_wait(Where&& where, player& p, stroke_id id, Token&& token)
{
    return boost::asio::async_initiate<Token, void(std::exception_ptr, stroke_report)>(
        [named = detail::find_executor(where), &p, id](auto&& handler) {
            detail::wait_for_stroke(named, p, std::forward<decltype(handler)>(handler), [id] { return id; });
        },
        token);
}

/// Waits like the function above, for tokens that have an executor: use_awaitable, use_future,
/// bind_executor().
template <typename Token>
auto async_wait(player& p, stroke_id id, Token&& token)
{
    static_assert(!detail::runs_nowhere<Token>,
                  "name the context: async_wait(io_context, player, id, handler)");
    return async_wait(boost::asio::system_executor(), p, id, std::forward<Token>(token));
}

/// Submits a score and waits for its end, as async_wait() does. If submit() throws, the handler receives the
/// exception. The score is submitted when the operation starts. With callbacks and futures, the operation
/// starts at once.
template <typename Where, typename Token>
auto async_play(Where&& where, player& p, score s, start_at start, Token&& token)
{
    return boost::asio::async_initiate<Token, void(std::exception_ptr, stroke_report)>(
        [named = detail::find_executor(where), &p, s = std::move(s), start](auto&& handler) {
            detail::wait_for_stroke(named, p, std::forward<decltype(handler)>(handler),
                                    [&p, &s, start] { return p.submit(s, start); });
        },
        token);
}

/// Plays like the function above, for tokens that have an executor: use_awaitable, use_future,
/// bind_executor().
template <typename Token>
auto async_play(player& p, score s, start_at start, Token&& token)
{
    static_assert(!detail::runs_nowhere<Token>,
                  "name the context: async_play(io_context, player, score, start, handler)");
    return async_play(boost::asio::system_executor(), p, std::move(s), start, std::forward<Token>(token));
}

} // namespace v0
} // namespace tactor
