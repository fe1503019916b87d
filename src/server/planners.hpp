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

/// Work for a planner. Its functions may share data.
struct planner_job {
    client_number client = 0;
    std::function<void()> work; ///< runs on a planner's thread; must not throw
    std::function<void()> done; ///< runs after it, in the context's thread
    /// Runs instead of `done`, and instead of `work` if that has not begun, when the server ends, its client
    /// has gone or a newer draft has come.
    std::function<void(bool outdated)> drop;
    std::optional<double> draft = {}; ///< number of a draft; none: not a draft
    bool quick = false;               ///< passes slow jobs; each draft is quick
    bool outlives = false;            ///< stays when its client goes
};

/// Two planning threads. Clients have turns, and each has at most one waiting draft. Only one thread works on
/// slow jobs, so that drafts and messages do not wait for them. Members are called in the context's thread.
class planners {
public:
    explicit planners(boost::asio::io_context& io) : io_(io) {}
    ~planners() { pool_.join(); }
    planners(const planners&) = delete;
    planners& operator=(const planners&) = delete;

    void add(planner_job j);
    /// Drops the jobs of a client that has gone, except those that outlive it.
    void forget(client_number of);
    /// Drops all jobs when the server ends.
    void drop_all();
    /// Runs `f` on a planner's thread, for example to destroy large objects.
    void aside(std::function<void()> f);

private:
    void next();
    bool run_next(bool quick);
    void finished(std::list<planner_job>::iterator j);

    static constexpr unsigned threads = 2;

    boost::asio::io_context& io_;
    std::list<planner_job> waiting_; ///< in the order of their clients' turns
    std::list<planner_job> running_; ///< running jobs; without `drop` once they are dropped
    boost::asio::thread_pool pool_{threads};
};

} // namespace tactor::server
