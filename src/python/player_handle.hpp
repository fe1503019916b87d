// SPDX-License-Identifier: MIT
/// \file
/// A player as the tool's `play` opens it: configuration, lines and limits included.
#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <string>
#include <utility>
#include <variant>

#include <sys/types.h>

#include "python/binding.hpp"
#include "python/options.hpp"
#include "session/device.hpp"
#include "session/lines.hpp"

namespace tactor::python {

struct log_line {
    std::string kind;
    std::string text;
};

using event = std::variant<stroke_report, log_line>;

/// Events of a player on their way to a thread of Python's. The player's threads leave them here and never
/// wait for the interpreter.
class event_queue {
public:
    void put(event e)
    {
        {
            const std::lock_guard lock(mutex_);
            if (std::holds_alternative<log_line>(e) && waiting_.size() >= most_waiting)
                return; // an unread log; reports are as many as there are strokes
            waiting_.push_back(std::move(e));
        }
        there_.notify_one();
    }

    /// Ends the queue: no more events come. next() still gives those that wait.
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

/// Returns the configuration that applies, with this array; null: with the configuration's. Fills in
/// rate and format from [defaults] where `s` has none. \throws error.
session::environment read_environment(session::settings& s, const array* a);

/// Calls may come from any thread, but not from a process that was forked: there they are errors, and nothing
/// of the parent's is touched when it ends.
class player_handle {
public:
    /// Opens the device. What `s` does not set is the configuration's, then the tool's default. `keep`: as
    /// player_options::keep_drive_time. Without the interpreter's lock. \throws error.
    player_handle(const array& a, session::settings s, bool keep, bool wants_log);
    ~player_handle();
    player_handle(const player_handle&) = delete;
    player_handle& operator=(const player_handle&) = delete;

    const stream_setup& setup() const noexcept { return setup_; }
    event_queue& events() noexcept { return *events_; }
    bool forked() const noexcept;

    /// Calls `f` with the player. \throws error (runtime) once it is closed, and in a forked process.
    template <class F>
    auto use(F&& f) const
    {
        refuse_child();
        const std::shared_lock lock(open_->mutex);
        if (open_->stream == nullptr)
            throw error(error_kind::runtime, "player", "it is closed", "make a new one");
        return std::forward<F>(f)(*open_->stream);
    }

    /// Return the player's; once it is closed, those of its end. \throws error in a forked process.
    player_stats stats() const;
    std::optional<std::string> ended() const;

    /// Returns false if the stroke has ended, as all have once it is closed. \throws error in a forked
    /// process.
    bool cancel(stroke_id id) const;
    /// Fades out, stops and closes; all strokes have been reported then. Once more: nothing.
    void close();
    bool closed() const;

    void refuse_child() const;

private:
    /// Remains of a closed player.
    struct last_words {
        player_stats stats = {};
        std::optional<std::string> ended = {};
    };
    static std::optional<std::string> end_reason(const player& p);

    // State that a forked process must not touch, not even to destroy it.
    struct open_state {
        mutable std::shared_mutex mutex;
        session::lent_lines lines;
        std::unique_ptr<player> stream;
        last_words last; ///< without a stream
    };

    pid_t owner_;
    stream_setup setup_;
    std::shared_ptr<event_queue> events_;
    std::unique_ptr<open_state> open_;
};

} // namespace tactor::python
