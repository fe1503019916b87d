// SPDX-License-Identifier: MIT
/// \file
/// The threads that parse large messages and plan, for each client in turn.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <optional>

#include <boost/asio/io_context.hpp>
#include <boost/asio/thread_pool.hpp>

namespace tactor::server {

using client_number = std::uint64_t;

/// Work for a planner. Its functions may share what they work on.
struct planner_job {
    client_number client = 0;
    std::function<void()> work; ///< runs on a planner's thread; must not throw
    std::function<void()> done; ///< follows it in the context's thread
    /// Replaces `done`, and `work` if it has not begun, when the server ends, its client has gone or a newer
    /// draft has come.
    std::function<void(bool outdated)> drop;
    std::optional<double> draft = {}; ///< its number
    bool quick = false;               ///< it passes what is not; each draft does
    bool outlives = false;            ///< its client may go
};

/// Two threads. Clients have turns, and each has one draft that waits at most. Only one thread works on what
/// is not quick, so that drafts and messages do not wait for it. Members are called in the context's thread.
class planners {
public:
    explicit planners(boost::asio::io_context& io) : io_(io) {}
    ~planners() { pool_.join(); }
    planners(const planners&) = delete;
    planners& operator=(const planners&) = delete;

    void add(planner_job j);
    /// Drops what waits for a client that has gone, but for what outlives it.
    void forget(client_number of);
    /// Drops all jobs: the server ends.
    void drop_all();
    /// Does something aside, such as to destroy what is large.
    void aside(std::function<void()> f);

private:
    void next();
    bool run_next(bool quick);
    void finished(std::list<planner_job>::iterator j);

    static constexpr unsigned threads = 2;

    boost::asio::io_context& io_;
    std::list<planner_job> waiting_; ///< in the order of their clients' turns
    std::list<planner_job> running_; ///< without `drop` once they are dropped
    boost::asio::thread_pool pool_{threads};
};

} // namespace tactor::server
