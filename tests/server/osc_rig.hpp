// SPDX-License-Identifier: MIT
/// \file
/// The service with senders of OSC, whose clock the test turns.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "server/osc/clients.hpp"
#include "service_rig.hpp"

namespace tactor::test {

/// Without a socket: what is sent waits in `sent`.
class osc_rig : public service_rig {
public:
    using endpoint = server::osc_clients::endpoint;
    using values = std::vector<net::osc_value>;

    explicit osc_rig(
        const std::function<void(server::service_options&, server::stream_options&)>& change = {})
        : service_rig(change)
    {
    }

    static endpoint at(std::uint16_t port, const char* address = "127.0.0.1")
    {
        return {boost::asio::ip::make_address(address), port};
    }
    static std::string message(const std::string& address, const values& v)
    {
        return net::osc_packet(address, v);
    }
    /// A bundle for `unix_ns`.
    static std::string bundle(std::int64_t unix_ns, const std::vector<std::string>& messages)
    {
        constexpr std::uint64_t from_1900 = 2'208'988'800;
        const auto ns = static_cast<std::uint64_t>(unix_ns);
        const std::uint64_t fraction = ((ns % 1'000'000'000U << 32U) + 999'999'999U) / 1'000'000'000U;
        std::string b("#bundle\0", 8);
        const auto put = [&b](std::uint64_t n, unsigned bytes) {
            while (bytes-- != 0)
                b += static_cast<char>(n >> (8U * bytes) & 0xffU);
        };
        put(ns / 1'000'000'000U + from_1900, 4);
        put(fraction, 4);
        for (const std::string& m : messages) {
            put(m.size(), 4);
            b += m;
        }
        return b;
    }

    void say(const endpoint& from, const std::string& address, const values& v = {})
    {
        osc.receive(message(address, v), from);
    }
    /// The next message to somebody, in words: "/tactor/stroke 3 started".
    std::string next(const endpoint& to)
    {
        std::string found;
        until([&] {
            for (auto s = sent.begin(); s != sent.end(); ++s)
                if (s->first == to) {
                    found = s->second;
                    sent.erase(s);
                    return true;
                }
            return false;
        });
        return found;
    }
    /// Returns whether no message waits for an address once all present work is done.
    bool silent(const endpoint& to)
    {
        io.poll();
        return std::none_of(sent.begin(), sent.end(), [&](const auto& s) { return s.first == to; });
    }
    /// The clock goes on by so much, and what is due is done.
    void pass(double seconds)
    {
        passed_ns += static_cast<std::int64_t>(seconds * 1e9);
        osc.act();
        io.poll();
    }
    std::int64_t unix_ns() const { return 1'800'000'000'000'000'000 + passed_ns; }

    static std::string words(const std::string& packet)
    {
        std::string all;
        for (const net::osc_message& m : net::parse_osc(packet)) {
            all += m.address;
            for (const net::osc_value& v : m.values) {
                all += ' ';
                if (const auto* n = std::get_if<std::int64_t>(&v))
                    all += std::to_string(*n);
                else if (const auto* x = std::get_if<double>(&v))
                    all += std::to_string(*x);
                else
                    all += std::get<std::string>(v);
            }
        }
        return all;
    }

    std::int64_t passed_ns = 0;
    std::int64_t jitter_ns = 0; ///< each reading of the clock is up to six times this early
    std::int64_t reads = 0;
    std::deque<std::pair<endpoint, std::string>> sent;    ///< in words; next() takes one out
    std::deque<std::pair<endpoint, std::string>> packets; ///< the same as they are, all
    server::osc_clients osc{io,
                            *all,
                            {[this](const endpoint& to, const std::string& packet) {
                                 packets.emplace_back(to, packet);
                                 sent.emplace_back(to, words(packet));
                             },
                             [this] { return own_clock() + passed_ns - jitter_ns * (++reads % 7); },
                             [this] { return unix_ns(); }}};

private:
    // Stands still but for pass(), at the time when the test began.
    std::int64_t own_clock() const { return began_ns; }
    std::int64_t began_ns = [] {
        timespec now{};
        clock_gettime(CLOCK_MONOTONIC, &now);
        return std::int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
    }();
};

} // namespace tactor::test
