// SPDX-License-Identifier: MIT
#include "server/planners.hpp"

#include <algorithm>
#include <utility>

#include <boost/asio/post.hpp>

namespace tactor::server {

void planners::add(planner_job j)
{
    j.quick = j.quick || j.draft;
    const auto older = std::find_if(waiting_.begin(), waiting_.end(), [&j](const planner_job& x) {
        return j.draft && x.draft && x.client == j.client;
    });
    if (older == waiting_.end()) {
        waiting_.push_back(std::move(j));
        return next();
    }
    // Give the newer draft the turn of the older draft. Otherwise a client that sends many drafts would never
    // get a turn.
    if (*j.draft >= *older->draft)
        std::swap(*older, j);
    j.drop(true);
}

void planners::next()
{
    const auto is_busy = [this] {
        return std::any_of(running_.begin(), running_.end(), [](const planner_job& j) { return !j.quick; });
    };
    while (running_.size() < threads && (run_next(true) || (!is_busy() && run_next(false)))) {
    }
}

// Starts the next quick or slow job. Then moves the other jobs of the same client to the end of the queue.
bool planners::run_next(bool quick)
{
    const auto found = std::find_if(waiting_.begin(), waiting_.end(),
                                    [quick](const planner_job& j) { return j.quick == quick; });
    if (found == waiting_.end())
        return false;
    running_.splice(running_.end(), waiting_, found);
    std::stable_partition(waiting_.begin(), waiting_.end(),
                          [found](const planner_job& j) { return j.client != found->client; });
    boost::asio::post(pool_, [this, found] {
        found->work();
        boost::asio::post(io_, [this, found] { finished(found); });
    });
    return true;
}

void planners::finished(std::list<planner_job>::iterator j)
{
    const planner_job over = std::move(*j);
    running_.erase(j);
    if (over.drop)
        over.done();
    next();
}

void planners::forget(client_number of)
{
    for (planner_job& j : std::exchange(waiting_, {}))
        if (j.client != of || j.outlives)
            waiting_.push_back(std::move(j));
        else
            j.drop(false);
}

void planners::drop_all()
{
    for (const planner_job& j : std::exchange(waiting_, {}))
        j.drop(false);
    for (planner_job& j : running_)
        if (const auto drop = std::exchange(j.drop, {}))
            drop(false);
}

void planners::run_in_thread(std::function<void()> f)
{
    boost::asio::post(pool_, std::move(f));
}

} // namespace tactor::server
