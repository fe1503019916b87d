// SPDX-License-Identifier: MIT
/// \file
/// A peer on a stream socket that exchanges lines with the server.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <boost/asio/generic/stream_protocol.hpp>

#include "net/connection.hpp"

namespace tactor::net {

class line_connection final : public connection {
public:
    using socket_type = boost::asio::generic::stream_protocol::socket;

    line_connection(socket_type s, const message_limits& l);

private:
    void read() override;
    void write() override;
    void shut() override;
    void next_line();
    void read_more();
    void all_read();
    void watch();

    socket_type socket_;
    std::vector<char> chunk_;
    std::vector<std::string> blocks_; ///< the start of a line that is longer than a block
    std::size_t block_bytes_ = 0;     ///< of them
    std::string text_;        ///< the rest of it, or lines that were not handled, and the start of one
    std::size_t begin_ = 0;   ///< start of the next line in it
    std::size_t scanned_ = 0; ///< no line ends between begin_ and this place
    bool over_ = false;       ///< the peer sends no more
};

} // namespace tactor::net
