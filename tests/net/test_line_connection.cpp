// SPDX-License-Identifier: MIT
#include <functional>
#include <memory>
#include <new>
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

struct machine {
    explicit machine(std::size_t most_unread = 64U << 20, std::size_t most_unfinished = 32U << 20)
        : all(io, most_unread, most_unfinished)
    {
    }
    boost::asio::io_context io;
    shared_by_peers all;
};

/// A connection and its peer, a plain descriptor.
struct pair {
    explicit pair(const line_limits& l = {}, const std::shared_ptr<machine>& m = std::make_shared<machine>(),
                  const std::function<bool(std::string_view)>& is_first = {})
        : on(m), io(m->io), all(m->all)
    {
        int fds[2] = {-1, -1};
        REQUIRE(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, fds) == 0);
        peer = fds[1];
        line_connection::socket_type s(io);
        s.assign(boost::asio::generic::stream_protocol(AF_UNIX, 0), fds[0]);
        end = std::make_shared<line_connection>(std::move(s), l, all);
        end->start(
            {.message =
                 [this](std::string_view t) {
                     lines.emplace_back(t);
                     return true;
                 },
             .closed = [this] { closed = true; },
             .met = is_first ? [this, is_first] { return is_first(lines.back()); } : std::function<bool()>(),
             .large =
                 [this](std::string t, std::function<void(bool)> done) {
                     lines.push_back(std::move(t));
                     large_done = std::move(done);
                 },
             .input_ended = [this] { input_over = true; },
             .fault = [this](line_fault f) { faults.push_back(f); }});
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

    std::shared_ptr<machine> on;
    boost::asio::io_context& io;
    shared_by_peers& all;
    int peer = -1;
    std::shared_ptr<line_connection> end;
    std::vector<std::string> lines;
    std::vector<line_fault> faults;
    std::function<void(bool)> large_done; ///< of the last large line
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
    CHECK(p.faults == std::vector<line_fault>{line_fault::too_long});
}

TEST_CASE("a message that is incomplete for too long, even the first, ends the connection")
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

namespace {

// Checks that a peer is dropped for what it has not read, and that nothing of it is held any more.
void check_dropped(pair& p)
{
    p.until([&] { return p.closed; });
    CHECK(p.faults == std::vector<line_fault>{line_fault::unread});
    p.io.poll();
    p.end.reset();
    p.io.poll();
    CHECK(p.all.unread.held() == 0);
}

} // namespace

TEST_CASE("a peer that does not read is dropped, and its waiting data are freed")
{
    pair p({.waiting_bytes = 1'000'000});
    for (int i = 0; i < 1000 && !p.closed; ++i) {
        p.end->send(std::string(10'000, 'x'));
        p.io.poll();
    }
    check_dropped(p);
}

TEST_CASE("a large message that a peer asked for leaves room for others, within what all may have")
{
    pair p({.waiting_bytes = 100'000});
    const std::size_t most = p.end->room();
    p.end->send_large(std::string(40'000'000, 'x'));
    CHECK(p.end->waiting() == 40'000'001);
    CHECK(p.end->room() == most - 40'000'001);
    p.end->send(std::string(90'000, 'x'));
    p.io.poll();
    CHECK_FALSE(p.closed);
    p.end->send(std::string(20'000, 'x'));
    check_dropped(p);
    pair q({.waiting_bytes = 100'000});
    q.end->send_large(std::string(most, 'x'));
    q.until([&] { return q.closed; });
    CHECK(q.faults == std::vector<line_fault>{line_fault::unread});
}

TEST_CASE("an empty line is no first message, and after that no late message")
{
    pair p({.message_s = 0.001});
    p.write("\n\r\n\n");
    p.until([&] { return p.closed; });
    CHECK(p.lines.empty());
    CHECK(p.faults == std::vector<line_fault>{line_fault::too_slow});
}

TEST_CASE("the first message may be missing until one is the right one")
{
    const auto is_right = [](std::string_view line) { return line == "right"; };
    pair p({.message_s = 0.001}, std::make_shared<machine>(), is_right);
    p.write("wrong\n");
    p.until([&] { return p.closed; });
    CHECK(p.faults == std::vector<line_fault>{line_fault::too_slow});
    pair q({.message_s = 3600.0}, std::make_shared<machine>(), is_right);
    q.write("wrong\nright\n");
    q.until([&] { return q.lines.size() == 2; });
    CHECK(q.faults.empty());
}

TEST_CASE("when all together have too much waiting, the one with most is dropped")
{
    byte_budget all(10'000);
    std::vector<int> given_up;
    const auto share = [&](int i) { return [&, i] { given_up.push_back(i); }; };
    byte_budget::share innocent(all, share(0));
    byte_budget::share hog(all, share(1));
    {
        byte_budget::share gone(all, share(2));
        CHECK(gone.add(9'000));
    }
    CHECK(all.held() == 0);
    CHECK(innocent.add(1'000));
    CHECK(hog.add(9'000));
    CHECK(innocent.add(1'000));
    CHECK(given_up == std::vector<int>{1});
    CHECK(all.held() == 2'000);
    CHECK_FALSE(hog.add(1));
    hog.take(9'000); // on its way when it was given up
    CHECK(all.held() == 2'000);
    innocent.take(2'000);
    CHECK_FALSE(innocent.add(10'001)); // more than there is
    CHECK(given_up == std::vector<int>{1, 0});
    CHECK(all.held() == 0);
}

TEST_CASE("a peer with a large message stays when another does not read")
{
    const auto both = std::make_shared<machine>(50'000);
    pair reads({}, both);
    pair deaf({}, both);
    while (deaf.end->waiting() < 45'000) {
        deaf.end->send(std::string(1'000, 'x'));
        both->io.poll();
    }
    reads.end->send("heard" + std::string(5'000, '.'));
    reads.until([&] { return deaf.closed; });
    CHECK(deaf.faults == std::vector<line_fault>{line_fault::unread});
    CHECK(reads.faults.empty());
    char bytes[100];
    REQUIRE(::read(reads.peer, bytes, sizeof bytes) == sizeof bytes);
    CHECK(std::string_view(bytes, 6) == "heard.");
}

TEST_CASE("each peer has one line a turn")
{
    const auto both = std::make_shared<machine>();
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

TEST_CASE("a long line comes whole, for any ends of its blocks")
{
    for (const std::size_t size : {100'000U, 114'688U, 131'070U, 131'072U, 131'073U, 262'144U, 500'000U}) {
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
            p.large_done(true);
            if (*end != '\0')
                p.write("next\n");
            if (*end != '\0')
                p.until([&] { return p.lines.size() == 2; });
            p.io.poll();
            CHECK(p.all.unfinished.held() < 1000);
        }
    }
}

TEST_CASE("large lines are read one at a time, and small ones of others pass them")
{
    const auto all = std::make_shared<machine>();
    pair first({}, all);
    pair second({}, all);
    pair small({}, all);
    const std::string large(small_message + 1, 'x');
    first.write(large + "\nnext\n");
    second.write(large + "\n");
    first.until([&] { return first.lines.size() + second.lines.size() == 1; });
    small.write("stop\n");
    small.until([&] { return small.lines.size() == 1; });
    all->io.poll();
    CHECK(first.lines.size() + second.lines.size() == 1);
    pair& earlier = first.lines.empty() ? second : first;
    pair& later = first.lines.empty() ? first : second;
    ::close(std::exchange(later.peer, -1)); // it waits all the same
    earlier.large_done(true);
    later.until([&] { return later.lines.size() == 1; });
    CHECK(later.lines.front() == large);
    CHECK_FALSE(later.closed);
    later.large_done(true);
    later.until([&] { return later.closed; });
    first.until([&] { return first.closed || first.lines.size() == 2; });
    CHECK(all->all.unfinished.held() < 4 * small_message);
}

TEST_CASE("when all together have too much unfinished, the one with most is dropped")
{
    const auto both = std::make_shared<machine>(64U << 20, 45'000);
    pair large({}, both);
    pair small({}, both);
    large.write(std::string(30'000, 'x'));
    both->io.poll();
    small.write(std::string(15'000, 'x'));
    both->io.poll();
    large.until([&] { return large.closed; });
    CHECK(large.faults == std::vector<line_fault>{line_fault::crowded});
    CHECK(both->all.unfinished.held() < 45'000);
    small.write("\n");
    small.until([&] { return small.lines.size() == 1; });
    small.large_done(true);
    CHECK(small.faults.empty());
}

TEST_CASE("a message beyond memory drops only its peer")
{
    const auto both = std::make_shared<machine>();
    pair other({}, both);
    // The handler fails like an allocation.
    int fds[2] = {-1, -1};
    REQUIRE(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, fds) == 0);
    line_connection::socket_type s(both->io);
    s.assign(boost::asio::generic::stream_protocol(AF_UNIX, 0), fds[0]);
    const auto end = std::make_shared<line_connection>(std::move(s), line_limits{}, both->all);
    std::vector<line_fault> faults;
    end->start({.message = [](std::string_view) -> bool { throw std::bad_alloc(); },
                .closed = [] {},
                .fault =
                    [&](line_fault f) {
                        faults.push_back(f);
                        end->send("why");
                    }});
    REQUIRE(::write(fds[1], "x\n", 2) == 2);
    other.write("one\n");
    other.until([&] { return other.lines.size() == 1 && !faults.empty(); });
    both->io.poll();
    CHECK(faults == std::vector<line_fault>{line_fault::memory});
    char bytes[10];
    CHECK(::read(fds[1], bytes, sizeof bytes) == 4);
    ::close(fds[1]);
}

} // namespace line_connection_test
