// SPDX-License-Identifier: MIT
/// \file
/// The threads that parse large messages and make plans. Clients take turns.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <optional>

#include <boost/asio/io_context.hpp>
#include <boost/asio/thread_pool.hpp>

namespace tactor::server {

using client_number = std::uint64_t;

/// A job for a planner thread. The functions of a job may share data.
struct planner_job {
    client_number client = 0;
    std::function<void()> work; ///< runs on a planner thread; must not throw
    std::function<void()> done; ///< runs after `work`, in the context's thread
    /// Runs instead of `done` if the server ends, and instead of `work` and `done` if the client disconnects
    /// or a newer draft arrives before `work` begins.
    std::function<void(bool outdated)> drop;
    std::optional<double> draft = {}; ///< number of the draft, if the job is a draft
    bool quick = false;               ///< true if it may overtake slow jobs, as every draft may
    bool outlives = false;            ///< true if it remains when its client disconnects
};

/// Two planner threads. Clients take turns, and each client has at most one draft waiting. Slow jobs run on
/// only one thread at a time, so that drafts and messages do not wait for them. Call the members in the
/// context's thread.
class planners {
public:
    explicit planners(boost::asio::io_context& io) : io_(io) {}
    ~planners() { pool_.join(); }
    planners(const planners&) = delete;
    planners& operator=(const planners&) = delete;

    void add(planner_job j);
    /// Drops the waiting jobs of a client that has disconnected. Jobs with `outlives` remain.
    void forget(client_number of);
    /// Drops all jobs, because the server ends.
    void drop_all();
    /// Runs `f` on a planner thread, for example to destroy large objects there.
    void run_in_thread(std::function<void()> f);

private:
    void next();
    bool run_next(bool quick);
    void finished(std::list<planner_job>::iterator j);

    static constexpr unsigned threads = 2;

    boost::asio::io_context& io_;
    std::list<planner_job> waiting_; ///< waiting jobs, in the order of the clients' turns
    std::list<planner_job> running_; ///< running jobs; a dropped job has no `drop` any more
    boost::asio::thread_pool pool_{threads};
};

} // namespace tactor::server
