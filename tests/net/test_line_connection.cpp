// SPDX-License-Identifier: MIT
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <doctest/doctest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "net/line_connection.hpp"

namespace line_connection_test {

using namespace tactor::net;

namespace {

/// A connection and its peer, a plain descriptor.
struct pair {
    explicit pair(const line_limits& l = {})
    {
        int fds[2] = {-1, -1};
        REQUIRE(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, fds) == 0);
        peer = fds[1];
        line_connection::socket_type s(io);
        s.assign(boost::asio::generic::stream_protocol(AF_UNIX, 0), fds[0]);
        end = std::make_shared<line_connection>(std::move(s), l, all);
        end->start({[this](std::string_view t) {
                        lines.emplace_back(t);
                        return true;
                    },
                    [this] { input_over = true; }, [this](line_fault f) { faults.push_back(f); },
                    [this] { closed = true; }});
    }
    ~pair()
    {
        if (peer >= 0)
            ::close(peer);
    }

    void write(const std::string& t) const
    {
        REQUIRE(::write(peer, t.data(), t.size()) == static_cast<ssize_t>(t.size()));
    }
    template <typename Condition>
    void until(Condition c)
    {
        while (!c())
            REQUIRE(io.run_one() == 1);
    }

    boost::asio::io_context io;
    write_budget all;
    int peer = -1;
    std::shared_ptr<line_connection> end;
    std::vector<std::string> lines;
    std::vector<line_fault> faults;
    bool input_over = false;
    bool closed = false;
};

} // namespace

TEST_CASE("lines come whole, however they were cut")
{
    pair p;
    p.write("on");
    p.io.poll();
    CHECK(p.lines.empty());
    p.write("e\r\ntwo\n\nthree");
    p.until([&] { return p.lines.size() == 2; });
    CHECK(p.lines == std::vector<std::string>{"one", "two"});
    ::shutdown(p.peer, SHUT_WR);
    p.until([&] { return p.input_over; });
    CHECK(p.lines.size() == 2); // what has no end was not finished
    p.end->send("still heard");
    p.end->finish();
    p.until([&] { return p.closed; });
    char bytes[100];
    CHECK(std::string_view(bytes, static_cast<std::size_t>(::read(p.peer, bytes, sizeof bytes))) ==
          "still heard\n");
}

TEST_CASE("a line that is too long is refused when that is known, not when it ends")
{
    pair p({.message_bytes = 10});
    p.write("0123456789\n0123456789a");
    p.until([&] { return p.closed; });
    CHECK(p.lines == std::vector<std::string>{"0123456789"});
    CHECK(p.faults == std::vector<line_fault>{line_fault::too_long});
}

TEST_CASE("a message that is not complete in time, also the first, ends the connection")
{
    for (const char* begin : {"", "half", "whole\nhalf"}) {
        pair p({.message_s = 0.001});
        p.write(begin);
        p.until([&] { return p.closed; });
        CHECK(p.faults == std::vector<line_fault>{line_fault::too_slow});
    }
    pair p({.message_s = 0.001});
    p.write("whole\n");
    p.until([&] { return p.lines.size() == 1 || p.closed; });
    if (!p.closed) {
        p.io.poll();
        CHECK(p.faults.empty());
    }
}

TEST_CASE("who does not read is dropped, and what waited is given back")
{
    pair p({.waiting_bytes = 1'000'000});
    for (int i = 0; i < 1000 && !p.closed; ++i) {
        p.end->send(std::string(10'000, 'x'));
        p.io.poll();
    }
    p.until([&] { return p.closed; });
    CHECK(p.faults == std::vector<line_fault>{line_fault::unread});
    p.io.poll();
    p.end.reset();
    p.io.poll();
    CHECK(p.all.waiting == 0);
}

TEST_CASE("all together have a budget")
{
    pair p;
    p.all.most = 50'000;
    p.all.waiting = 45'000;
    p.end->send(std::string(10'000, 'x'));
    p.until([&] { return p.closed; });
    CHECK(p.faults == std::vector<line_fault>{line_fault::unread});
    p.all.waiting -= 45'000;
}

} // namespace line_connection_test
