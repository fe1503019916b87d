// SPDX-License-Identifier: MIT
/// \file
/// The holder: a process that owns the amplifier's line and outlives the player for as long as it takes to
/// switch off. The player may have threads, so after fork() the holder only runs async-signal-safe code: it
/// does not allocate or lock, and everything it needs exists before.
#pragma once

#include <cstdint>

namespace tactor::amplifier {

/// Times that the player and the holder wait for each other. Programs use the defaults. Tests that do not
/// test time wait longer.
struct holder_limits {
    /// Silence of the player, without a command or beat, after which the line goes off. Beats come every 50
    /// ms.
    int silence_ms = 150;
    /// Time without an answer after which the holder counts as lost. It runs for microseconds at a time.
    int answer_ms = 500;
    /// Time that the player waits for the holder's greeting.
    int start_ms = 5000;
    /// Number of unanswered beats after which the holder counts as lost, too.
    unsigned unanswered = 10;
};

/// Message kinds, player to holder and back. The holder answers each command with its own kind and number.
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

/// Everything that the holder needs, made before the fork.
struct holder_job {
    bool (*set)(void* line, bool on) noexcept = nullptr; ///< async-signal-safe
    void* line = nullptr;
    int socket = -1;         ///< socket to the player
    int player = -1;         ///< pidfd of the player; -1: the kernel has none
    int player_socket = -1;  ///< the player's end, to close
    int* keep = nullptr;     ///< descriptors that `set` needs, sorted; null: not known, so close nothing
    unsigned keep_count = 0; ///< number of `keep`
    holder_limits limits = {};
};

/// Runs the holder in the forked process, and ends that process.
[[noreturn]] void run_holder(const holder_job& job) noexcept;

} // namespace tactor::amplifier
