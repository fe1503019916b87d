// SPDX-License-Identifier: MIT
/// \file
/// A socket below a WebSocket, all of whose bytes that come are seen.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/compose.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/websocket/teardown.hpp>

namespace tactor::net {

/// A stream of Asio's, as much of one as Beast's WebSocket asks for.
class watched_socket {
public:
    using next_layer_type = boost::asio::ip::tcp::socket;
    using executor_type = next_layer_type::executor_type;
    using sight = std::function<void(std::span<const std::byte>)>;

    /// The socket must outlive it. `seen` is called before whoever reads has the bytes.
    watched_socket(next_layer_type& s, sight seen) : socket_(s), seen_(std::move(seen)) {}

    executor_type get_executor() noexcept { return socket_.get_executor(); }
    next_layer_type& next_layer() noexcept { return socket_; }
    const next_layer_type& next_layer() const noexcept { return socket_; }

    template <class Buffers, class Token>
    auto async_read_some(const Buffers& into, Token&& token)
    {
        return boost::asio::async_compose<Token, void(boost::system::error_code, std::size_t)>(
            [this, into, asked = false](auto& self, const boost::system::error_code& e = {},
                                        std::size_t n = 0) mutable {
                if (!std::exchange(asked, true))
                    return socket_.async_read_some(into, std::move(self));
                see(into, n);
                self.complete(e, n);
            },
            token, socket_);
    }
    template <class Buffers, class Token>
    auto async_write_some(const Buffers& from, Token&& token)
    {
        return socket_.async_write_some(from, std::forward<Token>(token));
    }

private:
    template <class Buffers>
    void see(const Buffers& into, std::size_t n)
    {
        const auto end = boost::asio::buffer_sequence_end(into);
        for (auto b = boost::asio::buffer_sequence_begin(into); b != end && n > 0; ++b) {
            const boost::asio::mutable_buffer one(*b);
            const std::size_t here = std::min(n, one.size());
            seen_({static_cast<const std::byte*>(one.data()), here});
            n -= here;
        }
    }

    next_layer_type& socket_;
    sight seen_;
};

template <class Handler>
void async_teardown(boost::beast::role_type role, watched_socket& s, Handler&& handler)
{
    using boost::beast::websocket::async_teardown;
    async_teardown(role, s.next_layer(), std::forward<Handler>(handler));
}

} // namespace tactor::net
