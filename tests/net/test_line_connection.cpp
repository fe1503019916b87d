// SPDX-License-Identifier: MIT
#include <algorithm>
#include <functional>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <boost/asio/executor_work_guard.hpp>
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
    explicit pair(
        const message_limits& l = {},
        const std::shared_ptr<boost::asio::io_context>& on = std::make_shared<boost::asio::io_context>(),
        const std::function<bool(std::string_view)>& is_first = {})
        : owned(on), io(*on)
    {
        int fds[2] = {-1, -1};
        REQUIRE(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, fds) == 0);
        peer = fds[1];
        line_connection::socket_type s(io);
        s.assign(boost::asio::generic::stream_protocol(AF_UNIX, 0), fds[0]);
        end = std::make_shared<line_connection>(std::move(s), l);
        end->start(
            {.message =
                 [this](std::string_view t) {
                     lines.emplace_back(t);
                     return true;
                 },
             .closed = [this] { closed = true; },
             .met = is_first ? [this, is_first] { return is_first(lines.back()); } : std::function<bool()>(),
             .large =
                 [this](const std::vector<std::string>& parts, std::function<void(bool)> done) {
                     std::string& whole = lines.emplace_back();
                     for (const std::string& part : parts)
                         whole += part;
                     large_done.push_back(std::move(done));
                 },
             .input_ended = [this] { input_over = true; },
             .fault = [this](connection_fault f) { faults.push_back(f); }});
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

    std::shared_ptr<boost::asio::io_context> owned;
    boost::asio::io_context& io;
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work{io.get_executor()};
    int peer = -1;
    std::shared_ptr<line_connection> end;
    std::vector<std::string> lines;
    std::vector<connection_fault> faults;
    std::vector<std::function<void(bool)>> large_done; ///< of each large line
    bool input_over = false;
    bool closed = false;
};

} // namespace

TEST_CASE("lines come whole, cut in any way")
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
    CHECK(p.lines == std::vector<std::string>{"one", "two", "three"}); // that ends the line, too
    CHECK(p.faults.empty());
    p.end->send("still heard");
    p.end->finish();
    p.until([&] { return p.closed; });
    char bytes[100];
    CHECK(std::string_view(bytes, static_cast<std::size_t>(::read(p.peer, bytes, sizeof bytes))) ==
          "still heard\n");
}

TEST_CASE("a peer that sends no more may still read, and a closed one is gone")
{
    for (const bool at_once : {false, true}) {
        CAPTURE(at_once);
        pair p;
        p.write("one\n");
        if (!at_once) {
            ::shutdown(p.peer, SHUT_WR);
            p.until([&] { return p.input_over; });
            p.io.poll();
            CHECK_FALSE(p.closed);
        }
        ::close(std::exchange(p.peer, -1));
        p.until([&] { return p.closed; });
        CHECK(p.lines == std::vector<std::string>{"one"});
    }
}

TEST_CASE("a line that is too long is refused at its excess, not at its end")
{
    pair p({.message_bytes = 10});
    p.write("0123456789\n0123456789\r"); // the end is no part of it
    p.until([&] { return p.lines.size() == 1; });
    p.io.poll();
    CHECK_FALSE(p.closed);
    p.write("\n0123456789a");
    p.until([&] { return p.closed; });
    CHECK(p.lines == std::vector<std::string>{"0123456789", "0123456789"});
    CHECK(p.faults == std::vector<connection_fault>{connection_fault::too_long});
}

TEST_CASE("a message that is incomplete for too long, even the first, ends the connection")
{
    for (const char* begin : {"", "half", "whole\nhalf"}) {
        pair p({.message_s = 0.001});
        p.write(begin);
        p.until([&] { return p.closed; });
        CHECK(p.faults == std::vector<connection_fault>{connection_fault::too_slow});
    }
    pair p({.message_s = 0.001});
    p.write("whole\n");
    p.until([&] { return p.lines.size() == 1 || p.closed; });
    if (!p.closed) {
        p.io.poll();
        CHECK(p.faults.empty());
    }
}

TEST_CASE("a peer that does not read is dropped")
{
    pair p({.waiting_bytes = 1'000'000});
    for (int i = 0; i < 1000 && !p.closed; ++i) {
        p.end->send(std::string(10'000, 'x'));
        p.io.poll();
    }
    CHECK(p.closed);
}

TEST_CASE("a file that a peer asked for leaves room for messages")
{
    pair p({.waiting_bytes = 100'000});
    p.end->send_file(std::string(40'000'000, 'x'));
    CHECK(p.end->has_file());
    CHECK(p.end->waiting() == 0);
    p.end->send(std::string(90'000, 'x'));
    CHECK(p.end->waiting() == 90'000);
    p.io.poll();
    CHECK_FALSE(p.closed);
    std::vector<char> some(1U << 20);
    for (std::size_t n = 0; n != 40'090'002;) {
        p.io.poll();
        n += static_cast<std::size_t>(std::max<ssize_t>(0, ::read(p.peer, some.data(), some.size())));
    }
    p.io.poll();
    CHECK_FALSE(p.end->has_file());
    CHECK(p.end->waiting() == 0);
}

TEST_CASE("an empty line is no first message, and after that no late message")
{
    pair p({.message_s = 0.001});
    p.write("\n\r\n\n");
    p.until([&] { return p.closed; });
    CHECK(p.lines.empty());
    CHECK(p.faults == std::vector<connection_fault>{connection_fault::too_slow});
}

TEST_CASE("the first message may be missing until one is the right one")
{
    const auto is_right = [](std::string_view line) { return line == "right"; };
    pair p({.message_s = 0.001}, std::make_shared<boost::asio::io_context>(), is_right);
    p.write("wrong\n");
    p.until([&] { return p.closed; });
    CHECK(p.faults == std::vector<connection_fault>{connection_fault::too_slow});
    pair q({.message_s = 3600.0}, std::make_shared<boost::asio::io_context>(), is_right);
    q.write("wrong\nright\n");
    q.until([&] { return q.lines.size() == 2; });
    CHECK(q.faults.empty());
}

TEST_CASE("each peer has one line a turn")
{
    const auto both = std::make_shared<boost::asio::io_context>();
    pair many({}, both);
    pair one({}, both);
    std::string lines;
    for (int i = 0; i < 1000; ++i)
        lines += "line\n";
    many.write(lines);
    one.write("stop\n");
    one.until([&] { return one.lines.size() == 1; });
    CHECK(many.lines.size() < 10);
    many.until([&] { return many.lines.size() == 1000; });
}

TEST_CASE("a long line comes whole, and is given away")
{
    for (const std::size_t size :
         {65'536U, 65'537U, 114'688U, 131'072U, 131'073U, 229'375U, 229'376U, 500'000U}) {
        CAPTURE(size);
        std::string text;
        for (std::size_t i = 0; i < size; ++i)
            text += static_cast<char>('a' + i % 23);
        for (const char* end : {"\n", "\r\n", ""}) {
            pair p;
            const std::string all = text + end;
            for (std::size_t sent = 0; sent < all.size();) {
                const ssize_t n = ::write(p.peer, all.data() + sent, all.size() - sent);
                sent += n > 0 ? static_cast<std::size_t>(n) : 0;
                p.io.poll();
            }
            if (*end == '\0')
                ::shutdown(p.peer, SHUT_WR);
            p.until([&] { return p.lines.size() == 1; });
            CHECK(p.lines.front() == text);
            CHECK(p.large_done.size() == (size > large_message ? 1 : 0));
        }
    }
}

TEST_CASE("small lines pass large ones of their own peer, of which four wait at most")
{
    pair p;
    const std::string large = std::string(large_message + 1, 'x') + '\n';
    std::string all;
    for (int i = 0; i < 5; ++i)
        all += large + "stop\n";
    std::size_t sent = 0;
    const auto send = [&] {
        const ssize_t n = ::write(p.peer, all.data() + sent, all.size() - sent);
        sent += n > 0 ? static_cast<std::size_t>(n) : 0;
        p.io.poll();
    };
    while (p.lines.size() < 7)
        send();
    for (int i = 0; i < 10; ++i)
        send();
    CHECK(p.lines.size() == 7); // the fourth waits, and what is behind it
    p.large_done.front()(true);
    while (p.lines.size() < 9)
        send();
    CHECK(p.large_done.size() == 5);
    CHECK_FALSE(p.closed);
    p.large_done.back()(false);
    p.until([&] { return p.closed; });
    p.large_done[1](true); // a result for one that is gone
    CHECK(p.faults.empty());
}

TEST_CASE("a message beyond memory drops only its peer")
{
    const auto both = std::make_shared<boost::asio::io_context>();
    pair other({}, both);
    // The handler fails like an allocation.
    int fds[2] = {-1, -1};
    REQUIRE(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, fds) == 0);
    line_connection::socket_type s(*both);
    s.assign(boost::asio::generic::stream_protocol(AF_UNIX, 0), fds[0]);
    const auto end = std::make_shared<line_connection>(std::move(s), message_limits{});
    std::vector<connection_fault> faults;
    end->start({.message = [](std::string_view) -> bool { throw std::bad_alloc(); },
                .closed = [] {},
                .fault =
                    [&](connection_fault f) {
                        faults.push_back(f);
                        end->send("why");
                    }});
    REQUIRE(::write(fds[1], "x\n", 2) == 2);
    other.write("one\n");
    other.until([&] { return other.lines.size() == 1 && !faults.empty(); });
    both->poll();
    CHECK(faults == std::vector<connection_fault>{connection_fault::memory});
    char bytes[10];
    CHECK(::read(fds[1], bytes, sizeof bytes) == 4);
    ::close(fds[1]);
}

} // namespace line_connection_test
