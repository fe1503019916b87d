// SPDX-License-Identifier: MIT
/// \file
/// The holder, a process that owns the amplifier's line and outlives the player until it has switched the
/// line off. Also the player's side of it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <sys/types.h>

#include <tactor/lines.hpp>

#include "core/owned.hpp"

namespace tactor::amplifier {

/// Times that the player and the holder wait for each other. Programs use the defaults. Tests of other things
/// use longer times.
struct holder_limits {
    /// Time without a command or beat from the player after which the line goes off. Beats come at least
    /// every 50 ms.
    int silence_ms = 150;
    /// Time without an answer after which the holder counts as lost. The holder runs for only microseconds at
    /// a time.
    int answer_ms = 500;
    /// Time that the player waits for the holder's greeting.
    int start_ms = 5000;
    /// Number of unanswered beats after which the holder counts as lost, too.
    unsigned unanswered = 10;
};

/// Kinds of messages between player and holder. The holder answers each command with a message of the same
/// kind and number.
enum class message_kind : std::uint8_t {
    hello,  ///< from the holder: it runs and owns the line
    on,     ///< command
    off,    ///< command
    beat,   ///< command: the player lives
    lapsed, ///< from the holder: it switched off because the player was silent
};

struct message {
    message_kind kind = message_kind::hello;
    std::uint8_t number = 0; ///< number of the command
    bool done = true;        ///< answer: the line obeyed
    std::int32_t pid = 0;    ///< hello: pid of the holder
};

/// The line that the holder takes over.
struct held_line {
    bool (*set)(void* line, bool on) noexcept = nullptr; ///< async-signal-safe
    void* line = nullptr;                                ///< must live until start_holder() has returned
    std::vector<int> descriptors = {}; ///< descriptors that `set` needs; -1: unknown, the holder closes none
};

/// A line that a holder owns. One thread at a time.
class holder_link final : public enable_line {
public:
    holder_link(detail::owned_fd socket, std::int32_t pid, std::function<bool()> rescue,
                const holder_limits& limits);
    ~holder_link() override;
    holder_link(const holder_link&) = delete;
    holder_link& operator=(const holder_link&) = delete;

    bool set(bool on) noexcept override;
    bool beat() noexcept override;
    pid_t pid() const noexcept { return pid_; }

private:
    bool send(message_kind kind) noexcept;
    bool await_answer(message_kind kind) noexcept;
    std::optional<message> receive() noexcept;
    void give_up() noexcept;
    bool call_rescue() noexcept;

    detail::owned_fd socket_;
    pid_t pid_;
    detail::owned_fd process_; ///< pidfd of the holder
    std::function<bool()> rescue_;
    holder_limits limits_;
    std::uint8_t number_ = 0;
    unsigned unanswered_ = 0;
    bool lapsed_ = false;
    bool on_ = false; ///< true also if the state is not known
    bool gone_ = false;
    bool rescued_ = false;
};

/// Starts the holder. Forks twice, so that no process has to wait for the holder as its child. The line must
/// be off. On return the holder owns the line, and the caller must release its own copy. If the holder is
/// lost, `rescue` is called: it switches the line off and returns true on success.
/// \throws error (not_available).
std::unique_ptr<holder_link> start_holder(const held_line& line, std::function<bool()> rescue,
                                          const holder_limits& limits = {});

} // namespace tactor::amplifier
