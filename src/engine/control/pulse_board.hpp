// SPDX-License-Identifier: MIT
/// \file
/// Planned sync pulses, between the control side, which plans them, and the thread that sends them.
#pragma once

#include <array>
#include <atomic>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <tactor/live.hpp>

#include "engine/audio/dac_clock.hpp"

namespace tactor::engine {

/// A planned pulse: a stream frame of one epoch. After an xrun that frame is never played.
struct pulse {
    std::uint64_t epoch = 0;
    std::uint64_t frame = 0;
    stroke_id id = {};
    auto operator<=>(const pulse&) const = default;
};

/// A few places for pulses, without a lock, because the sending thread has the highest priority of all and
/// must not wait for another. A place has a counter, `turn`, which is odd while a pulse waits there. Either
/// side may take the pulse by a compare-and-swap that adds one; the side whose swap succeeds has it.
class pulse_board {
public:
    static constexpr std::size_t places = 256;

    /// A pulse that was seen waiting.
    struct seen {
        pulse what;
        std::size_t place = 0;
        std::uint32_t turn = 0;
    };

    // Planning side: one caller at a time.

    /// Puts a pulse on the board, from where it can be sent. Returns the pulse that has no place: none, a
    /// later one that made way, or `p` itself.
    std::optional<pulse> offer(const pulse& p) noexcept;
    /// Removes a stroke's pulses that the sender has not taken, and returns their number.
    std::size_t forget(stroke_id id) noexcept;
    void forget_other_epochs(std::uint64_t epoch) noexcept;

    // Sending side.

    /// Returns the first pulse that waits, of the clock's epoch.
    std::optional<seen> next(const clock_line& line) const noexcept;
    /// Takes a pulse in order to send it at once. Returns false if it was withdrawn or made way since it was
    /// seen.
    bool take(const seen& s) noexcept { return end_turn(s.place, s.turn); }

private:
    struct place {
        std::atomic<std::uint32_t> turn{0};
        // Atomic, because a place may change hands while the sender reads it. `turn` shows this, and the
        // sender then drops what it has read.
        std::atomic<stroke_id> id{};
        std::atomic<std::uint64_t> epoch{0};
        std::atomic<std::uint64_t> frame{0};
    };

    static pulse read(const place& p) noexcept;
    static void fill(place& p, const pulse& what, std::uint32_t turn) noexcept;
    bool end_turn(std::size_t n, std::uint32_t turn) noexcept;
    template <typename Unwanted>
    std::size_t remove(Unwanted unwanted) noexcept;

    std::array<place, places> places_{};
};

} // namespace tactor::engine
