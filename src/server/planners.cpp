// SPDX-License-Identifier: MIT
#include "server/planners.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include <boost/asio/post.hpp>

namespace tactor::server {

void planners::add(client_number of, planner_job j)
{
    client_jobs& own = find_jobs(of);
    if (j.draft && !outdate(own, j))
        return;
    j.quick = j.quick || j.draft;
    (j.quick ? own.quick : own.others).push_back(std::move(j));
    next();
}

planners::client_jobs& planners::find_jobs(client_number of)
{
    const auto found =
        std::find_if(turns_.begin(), turns_.end(), [of](const client_jobs& c) { return c.number == of; });
    return found != turns_.end() ? *found : turns_.emplace_back(client_jobs{of});
}

// Drops the older of this draft and the one that waits. The newer one has the turn: else a client that sends
// many would never have one. Returns true if `j` is still to be added.
bool planners::outdate(client_jobs& own, planner_job& j)
{
    const auto waits = std::find_if(own.quick.begin(), own.quick.end(),
                                    [](const planner_job& x) { return x.draft.has_value(); });
    if (waits == own.quick.end())
        return true;
    if (*j.draft >= *waits->draft)
        std::swap(*waits, j);
    j.drop(true);
    return false;
}

void planners::next()
{
    const auto is_busy = [this] {
        return std::any_of(running_.begin(), running_.end(), [](const running& r) { return !r.job.quick; });
    };
    while (running_.size() < threads &&
           (run_next(&client_jobs::quick) || (!is_busy() && run_next(&client_jobs::others)))) {
    }
}

// Runs a job of the next client that has one.
bool planners::run_next(std::deque<planner_job> client_jobs::*jobs)
{
    const auto turn = std::find_if(turns_.begin(), turns_.end(),
                                   [jobs](const client_jobs& c) { return !(c.*jobs).empty(); });
    if (turn == turns_.end())
        return false;
    planner_job j = std::move(((*turn).*jobs).front());
    ((*turn).*jobs).pop_front();
    if (turn->quick.empty() && turn->others.empty())
        turns_.erase(turn);
    else
        turns_.splice(turns_.end(), turns_, turn);
    run(std::move(j));
    return true;
}

void planners::run(planner_job j)
{
    running_.push_back(running{std::move(j)});
    const auto r = std::prev(running_.end());
    boost::asio::post(pool_, [this, r] {
        r->job.work();
        boost::asio::post(io_, [this, r] { finished(r); });
    });
}

void planners::finished(std::list<running>::iterator r)
{
    const running over = std::move(*r);
    running_.erase(r);
    if (!over.dropped)
        over.job.done();
    next();
}

void planners::forget(client_number of)
{
    client_jobs& own = find_jobs(of);
    for (std::deque<planner_job>* jobs : {&own.quick, &own.others})
        for (planner_job& j : std::exchange(*jobs, {}))
            if (j.outlives)
                jobs->push_back(std::move(j));
            else
                j.drop(false);
    if (own.quick.empty() && own.others.empty())
        turns_.remove_if([of](const client_jobs& c) { return c.number == of; });
}

void planners::drop_all()
{
    for (client_jobs& c : turns_)
        for (std::deque<planner_job>* jobs : {&c.quick, &c.others})
            for (const planner_job& j : std::exchange(*jobs, {}))
                j.drop(false);
    for (running& r : running_)
        if (!std::exchange(r.dropped, true))
            r.job.drop(false);
}

void planners::aside(std::function<void()> f)
{
    boost::asio::post(pool_, std::move(f));
}

} // namespace tactor::server
