// SPDX-License-Identifier: MIT
/// \file
/// The holder: a process that owns the amplifier's line and outlives the player by as long as it takes to
/// switch off. After fork() it only runs code that is async-signal-safe, because the player may have threads:
/// it neither allocates nor locks, and everything it needs was made before.
#pragma once

#include <cstdint>

namespace tactor::gpio {

/// How long the player and the holder wait for each other. Programs use the defaults; tests that are not
/// about time wait longer.
struct holder_limits {
    /// Without a command or a beat for so long, a line that is on goes off. Beats come every 50 ms.
    int silence_ms = 150;
    /// A holder that does not answer for so long is taken for lost. It runs for microseconds at a time.
    int answer_ms = 500;
    /// How long the player waits for the holder's greeting.
    int start_ms = 5000;
    /// After so many beats without an answer the holder is taken for lost, too.
    unsigned unanswered = 10;
};

/// Message kinds, player to holder and back. Each command is answered with its own kind and number.
enum class message_kind : std::uint8_t {
    hello,  ///< from the holder: it runs and has the line
    on,     ///< command
    off,    ///< command
    beat,   ///< command: the player lives
    lapsed, ///< from the holder: it switched off because the player was silent
};

struct message {
    message_kind kind = message_kind::hello;
    std::uint8_t number = 0; ///< of the command
    bool done = true;        ///< answer: the line did it
    std::int32_t pid = 0;    ///< hello: of the holder
};

/// All that the holder needs, made before the fork.
struct holder_job {
    bool (*set)(void* line, bool on) noexcept = nullptr; ///< async-signal-safe
    void* line = nullptr;
    int socket = -1;         ///< of messages, to the player
    int player = -1;         ///< pidfd of the player; -1: this kernel has none
    int player_socket = -1;  ///< the player's end, to be closed
    int* keep = nullptr;     ///< descriptors that `set` needs, sorted; null: not known, close nothing
    unsigned keep_count = 0; ///< how many
    holder_limits limits = {};
};

/// The holder's whole life, in the process that forked off. Ends with the process.
[[noreturn]] void run_holder(const holder_job& job) noexcept;

} // namespace tactor::gpio
