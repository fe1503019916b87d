// SPDX-License-Identifier: MIT
/// \file
/// What a player tells, on its way to a thread of Python's. The player's threads leave it here and never wait
/// for the interpreter.
#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include <tactor/player.hpp>

namespace tactor::python {

struct log_line {
    std::string kind;
    std::string text;
};

using event = std::variant<stroke_report, log_line>;

class event_queue {
public:
    void put(event e)
    {
        {
            const std::lock_guard lock(mutex_);
            if (std::holds_alternative<log_line>(e) && waiting_.size() >= most_waiting)
                return; // a log that nobody reads; reports are as many as there are strokes
            waiting_.push_back(std::move(e));
        }
        there_.notify_one();
    }

    /// No more are to come; what waits is still given.
    void close()
    {
        {
            const std::lock_guard lock(mutex_);
            closed_ = true;
        }
        there_.notify_all();
    }

    /// Waits for the next one; none once it is closed and empty.
    std::optional<event> next()
    {
        std::unique_lock lock(mutex_);
        there_.wait(lock, [this] { return closed_ || !waiting_.empty(); });
        if (waiting_.empty())
            return {};
        event e = std::move(waiting_.front());
        waiting_.pop_front();
        return e;
    }

private:
    static constexpr std::size_t most_waiting = 4096;

    std::mutex mutex_;
    std::condition_variable there_;
    std::deque<event> waiting_;
    bool closed_ = false;
};

} // namespace tactor::python
