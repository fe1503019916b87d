// SPDX-License-Identifier: MIT
/// \file
/// How many errors an address is sent: who forges another's address cannot bury it in them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>

#include <boost/asio/ip/address.hpp>

namespace tactor::server {

/// In any second, so many to an address; of so many addresses.
class error_allowance {
public:
    static constexpr std::size_t most = 10;
    static constexpr std::size_t most_addresses = 1024;
    static constexpr std::int64_t span_ns = 1'000'000'000;

    /// Whether one more may be sent now, which is then counted.
    bool take(const boost::asio::ip::address& to, std::int64_t now_ns)
    {
        if (sent_.size() >= most_addresses && !sent_.contains(to))
            std::erase_if(sent_, [&](const auto& s) { return s.second.back() + span_ns <= now_ns; });
        if (sent_.size() >= most_addresses && !sent_.contains(to))
            return false;
        std::deque<std::int64_t>& times = sent_[to];
        if (times.size() == most) {
            if (times.front() + span_ns > now_ns)
                return false;
            times.pop_front();
        }
        times.push_back(now_ns);
        return true;
    }

private:
    std::map<boost::asio::ip::address, std::deque<std::int64_t>> sent_; ///< when, the oldest first
};

} // namespace tactor::server
