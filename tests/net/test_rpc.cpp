// SPDX-License-Identifier: MIT
// JSON-RPC, and its lines on a connection.
#include <algorithm>
#include <chrono>
#include <ctime>
#include <functional>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <doctest/doctest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "net/connection.hpp"
#include "net/rpc.hpp"

namespace rpc_test {

using namespace tactor::net;

namespace {

int refusal_code(std::string_view text)
{
    const rpc_message m = parse_rpc(text);
    REQUIRE(m.parts.size() == 1);
    const auto* r = std::get_if<rpc_refusal>(&m.parts.front());
    return r == nullptr ? 0 : r->why.code;
}

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
            {.message = [this](std::string_view t) { return take(t); },
             .closed = [this] { closed = true; },
             .met = is_first ? [this, is_first] { return is_first(lines.back()); } : std::function<bool()>(),
             .large =
                 [this](std::string text, std::function<void(bool)> done) {
                     lines.push_back(std::move(text));
                     large_done.push_back(std::move(done));
                 },
             .input_ended = [this] { input_over = true; },
             .fault =
                 [this](connection_fault f) {
                     faults.push_back(f);
                     end->send("why");
                 }});
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
    std::function<bool(std::string_view)> take = [this](std::string_view line) {
        lines.emplace_back(line);
        return true;
    };
    std::vector<connection_fault> faults;
    std::vector<std::function<void(bool)>> large_done; ///< of each large line
    bool input_over = false;
    bool closed = false;
};

} // namespace

TEST_CASE("requests, notifications and batches are told apart")
{
    const rpc_message one = parse_rpc(R"({"jsonrpc":"2.0","id":"a","method":"m","params":{"x":1}})");
    REQUIRE(one.parts.size() == 1);
    CHECK_FALSE(one.batch);
    const auto& r = std::get<rpc_request>(one.parts.front());
    CHECK(r.method == "m");
    CHECK(r.id == "a");
    CHECK(r.params["x"] == 1);
    CHECK(r.wants_reply);
    const rpc_message many = parse_rpc(R"([{"jsonrpc":"2.0","method":"m"},7])");
    CHECK(many.batch);
    REQUIRE(many.parts.size() == 2);
    CHECK_FALSE(std::get<rpc_request>(many.parts[0]).wants_reply);
    CHECK(std::get<rpc_refusal>(many.parts[1]).why.code == code_invalid_request);
    CHECK(parse_rpc(R"([{"jsonrpc":"2.0","method":"m"}])").batch);
}

TEST_CASE("a bad request has the standard's code")
{
    for (const char* text : {"", "{", "nul", "\"\xff\"", "{\"a\":1,}", "[1] 2", "\xc0\x80"})
        CHECK_MESSAGE(refusal_code(text) == code_parse_error, text);
    for (const char* text :
         {"1", "null", "[]", "{}", R"({"jsonrpc":"2.0"})", R"({"jsonrpc":2.0,"method":"m"})",
          R"({"jsonrpc":"2.0","method":1})", R"({"jsonrpc":"2.0","method":"m","params":"p"})",
          R"({"jsonrpc":"2.0","method":"m","id":true})", R"({"jsonrpc":"2.0","method":"m","id":{}})"})
        CHECK_MESSAGE(refusal_code(text) == code_invalid_request, text);
    CHECK(refusal_code(R"({"jsonrpc":"2.0","method":"m","params":[1],"id":null})") == 0);
}

TEST_CASE("no parameters are the same in each form")
{
    for (const char* text :
         {R"({"jsonrpc":"2.0","method":"m"})", R"({"jsonrpc":"2.0","method":"m","params":{}})",
          R"({"jsonrpc":"2.0","method":"m","params":[]})",
          R"({"jsonrpc":"2.0","method":"m","params":null})"}) {
        CAPTURE(text);
        CHECK(std::get<rpc_request>(parse_rpc(text).parts.front()).params == json::object());
    }
    for (const char* params : {"0", "false", "\"\"", "1"})
        CHECK(refusal_code(R"({"jsonrpc":"2.0","method":"m","params":)" + std::string(params) + "}") ==
              code_invalid_request);
}

TEST_CASE("a method that is accepted in any form is a request, whatever is beside its name")
{
    for (const char* rest :
         {"", R"(,"params":1)", R"(,"params":["x"],"id":5)", R"(,"jsonrpc":"1.0","params":{"x":[]},"id":5)",
          R"(,"id":{},"params":null)", R"(,"id":true)"}) {
        CAPTURE(rest);
        const std::string text = R"({"method":"stop")" + std::string(rest) + "}";
        const rpc_message m = parse_rpc(text);
        const auto& r = std::get<rpc_request>(m.parts.front());
        CHECK(r.method == "stop");
        CHECK(r.params == json::object());
        CHECK(r.wants_reply == (text.find("id") != std::string::npos));
        CHECK(r.id == (text.find("5") != std::string::npos ? json(5) : json(nullptr)));
    }
    CHECK(refusal_code(R"({"method":""})") == code_invalid_request); // as without such a method
}

TEST_CASE("a message refused as a whole still reports a method that is accepted in any form")
{
    const auto acts = [](const std::string& text) {
        const rpc_message m = parse_rpc(text);
        CHECK(std::holds_alternative<rpc_refusal>(m.parts.front()));
        return m.has_stop;
    };
    const auto crowd = [](const std::string& last) {
        std::string all = "[";
        for (int i = 0; i < 64; ++i)
            all += "1,";
        return all + last + ']';
    };
    const std::string deep = std::string(99, '[') + std::string(99, ']');
    CHECK(acts(crowd(R"({"method":"x"},{"id":[1,{}],"method":"stop"})")));
    CHECK_FALSE(acts(crowd(R"({"params":{"method":"stop"}})")));
    CHECK_FALSE(acts(crowd(R"([{"method":"stop"}])")));
    CHECK_FALSE(acts(crowd(R"("method","stop",{"x":"stop"})")));
    CHECK(acts(R"([{"params":[1e400,-1e999,)" + deep + R"(]},{"method":"stop"}])"));
    CHECK_FALSE(acts(R"({"method":"x","params":{"x":)" + deep + R"(,"method":"stop"}})"));
    CHECK_FALSE(acts(R"({"method":["stop"],"params":)" + deep + "}"));
    // Such a request is accepted also where it nests too deep.
    for (const std::string& text : {R"({"params":)" + deep + R"(,"id":7,"method":"stop"})",
                                    R"({"id":7,"method":"stop","params":{"x":)" + deep + "}}"}) {
        const rpc_message m = parse_rpc(text);
        CHECK(std::get<rpc_request>(m.parts.front()).id == 7);
    }
}

TEST_CASE("a number that no double holds is no number, and its message is answered")
{
    const rpc_message m = parse_rpc(
        R"({"jsonrpc":"2.0","id":6,"method":"a\"1e400","params":{"x":1e400,"y":[-1E+400,1e-400],"z":"1e400","d":2}})");
    const auto& r = std::get<rpc_request>(m.parts.front());
    CHECK(r.id == 6);
    CHECK(r.method == "a\"1e400");
    CHECK(r.params["x"].is_null());
    CHECK(r.params["y"][0].is_null());
    CHECK(r.params["y"][1] == 0.0);
    CHECK(r.params["z"] == "1e400");
    CHECK(r.params["d"] == 2);
    CHECK(refusal_code("[1e400,") == code_parse_error);
    // Read once, whatever follows: twice as long takes twice as long.
    CHECK(refusal_code("[1e400," + std::string(1U << 20, 'e')) == code_parse_error);
}

TEST_CASE("the time for a message grows linearly, whatever it is made of")
{
    const auto cpu_s = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
    const auto time_s = [&cpu_s](std::size_t n) {
        std::string text = R"({"jsonrpc":"2.0","id":1,"method":"status","params":[)";
        for (std::size_t i = 0; i < n; ++i)
            text += "{},";
        text += "1]}";
        double least = 1e9;
        for (int k = 0; k < 5; ++k) {
            const double before = cpu_s();
            CHECK(parse_rpc(text).parts.size() == 1);
            least = std::min(least, cpu_s() - before);
        }
        return least;
    };
    // Quadratic time would take 64 times as long.
    CHECK(time_s(40'000) < 24.0 * time_s(5'000));
}

TEST_CASE("nesting is counted outside of texts, and what is deeper is never built")
{
    const auto nested = [](std::size_t n) { return std::string(n, '['); };
    const auto closed = [&](std::size_t n) { return nested(n) + std::string(n, ']'); };
    CHECK(refusal_code(closed(65)) == code_limit);
    CHECK(refusal_code(closed(1'000'000)) == code_limit);
    CHECK(refusal_code(nested(1'000'000)) == code_limit);
    CHECK(refusal_code(nested(64)) == code_parse_error);
    CHECK(std::get<rpc_refusal>(parse_rpc(closed(65)).parts.front()).why.what == "max_nesting");
    CHECK(refusal_code(closed(64)) == code_invalid_request);
    const rpc_message m = parse_rpc(R"({"jsonrpc":"2.0","id":5,"method":"m","params":)" + closed(64) + "}");
    CHECK(std::get<rpc_refusal>(m.parts.front()).why.what == "max_nesting");
    CHECK(std::get<rpc_refusal>(m.parts.front()).id == 5);
    CHECK(refusal_code("\"" + nested(100) + "\\\"" + nested(100) + "\"") == code_invalid_request);
    std::string flat = "[";
    for (int i = 0; i < 1000; ++i)
        flat += "[],";
    CHECK(refusal_code(flat + "[]]") == code_limit); // a batch of 1001
    CHECK(refusal_code("[[[]]]") == code_invalid_request);
}

TEST_CASE("an error repeats at most 80 characters of a client's text")
{
    const std::string x(200, 'x');
    const std::string x80 = x.substr(0, 80) + "...";
    CHECK(truncate_echo("there is no \"" + x + "\", sorry") == "there is no \"" + x80 + "\", sorry");
    CHECK(truncate_echo("last read: '" + x + "'") == "last read: '" + x80 + "'");
    CHECK(truncate_echo(x + " " + x) == x80 + " " + x80);
    std::string blanks;
    std::string umlauts;
    for (int i = 0; i < 1000; ++i)
        blanks += "a ", umlauts += "\xc3\xa4";
    CHECK(truncate_echo('"' + blanks + '"') == '"' + blanks.substr(0, 80) + "...\"");
    CHECK(truncate_echo(umlauts) == umlauts.substr(0, 160) + "...");
    CHECK(truncate_echo(blanks) == blanks.substr(0, 1000) + "...");
    const std::string own =
        "one of algorithm, phantom, duration, speed, soa, burst, slope, intercept, timing, outside, \"snap\"";
    CHECK(truncate_echo(own) == own);
    const rpc_fault f{code_bad_params, "bad-input", x, "no '" + x + "'", "not \"" + x + '"'};
    CHECK(json_line(error_reply(7, f)).size() < 1000);
    CHECK(fault_text(f) == x80 + ": no '" + x80 + "' (not \"" + x80 + "\")");
    CHECK(refusal_code(R"({"jsonrpc":"2.0","method":"m","id":")" + x + "\"}") == code_invalid_request);
    CHECK(refusal_code(R"({"jsonrpc":"2.0","method":"m","id":")" + x.substr(0, 80) + "\"}") == 0);
    CHECK(
        json_line(error_reply(nullptr,
                              std::get<rpc_refusal>(parse_rpc(std::string(1U << 20, 'x')).parts.front()).why))
            .size() < 1000);
}

TEST_CASE("errors have kind, what, why and hint")
{
    const reply_json e = error_reply(7, {code_bad_params, "bad-input", "options.soa", "too long", "shorter"});
    CHECK(json_line(e) ==
          R"x({"jsonrpc":"2.0","id":7,"error":{"code":-32602,"message":"options.soa: too long (shorter)",)x"
          R"("data":{"kind":"bad-input","what":"options.soa","why":"too long","hint":"shorter"}}})");
    CHECK(json_line(result_reply(nullptr, reply_json::object())) ==
          R"({"jsonrpc":"2.0","id":null,"result":{}})");
    CHECK(json_line(notification("stroke", {{"stroke", 1}})) ==
          R"({"jsonrpc":"2.0","method":"stroke","params":{"stroke":1}})");
}

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

TEST_CASE("who ends a connection does not wait for a peer that reads nothing")
{
    pair p;
    p.end->send(std::string(2'000'000, 'x')); // more than a socket takes
    p.end->finish();
    while (!p.closed) // after a second; a minute is as good as never
        REQUIRE(p.io.run_one_for(std::chrono::minutes(1)) == 1);
}

TEST_CASE("a file that a peer asked for leaves room for messages")
{
    pair p({.waiting_bytes = 100'000});
    p.end->send_file(std::string(40'000'000, 'x'));
    CHECK(p.end->file_bytes() != 0);
    CHECK(p.end->queued_bytes() == 0);
    p.end->send(std::string(90'000, 'x'));
    CHECK(p.end->queued_bytes() == 90'000);
    p.io.poll();
    CHECK_FALSE(p.closed);
    std::vector<char> some(1U << 20);
    for (std::size_t n = 0; n != 40'090'002;) {
        p.io.poll();
        n += static_cast<std::size_t>(std::max<ssize_t>(0, ::read(p.peer, some.data(), some.size())));
    }
    p.io.poll();
    CHECK_FALSE(p.end->file_bytes() != 0);
    CHECK(p.end->queued_bytes() == 0);
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
    for (const std::size_t size : {65'536U, 65'537U, 500'000U}) {
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
    pair p({}, both);
    p.take = [](std::string_view) -> bool { throw std::bad_alloc(); }; // as an allocation fails
    p.write("x\n");
    other.write("one\n");
    other.until([&] { return other.lines.size() == 1 && !p.faults.empty(); });
    both->poll();
    CHECK(p.faults == std::vector<connection_fault>{connection_fault::memory});
    char bytes[10];
    CHECK(::read(p.peer, bytes, sizeof bytes) == 4);
}

} // namespace rpc_test
