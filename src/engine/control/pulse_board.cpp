// SPDX-License-Identifier: MIT
#include "engine/control/pulse_board.hpp"

namespace tactor::engine {
namespace {

constexpr bool is_taken(std::uint32_t turn) noexcept
{
    return turn % 2 == 1;
}

} // namespace

// Acquire and release: a reader that sees one word of a newer pulse also sees the newer turn.
pulse pulse_board::read(const place& p) noexcept
{
    return {.epoch = p.epoch.load(std::memory_order_acquire),
            .frame = p.frame.load(std::memory_order_acquire),
            .id = p.id.load(std::memory_order_acquire)};
}

void pulse_board::fill(place& p, const pulse& what, std::uint32_t turn) noexcept
{
    p.epoch.store(what.epoch, std::memory_order_release);
    p.frame.store(what.frame, std::memory_order_release);
    p.id.store(what.id, std::memory_order_release);
    p.turn.store(turn + 1, std::memory_order_release);
}

bool pulse_board::end_turn(std::size_t n, std::uint32_t turn) noexcept
{
    return places_[n].turn.compare_exchange_strong(turn, turn + 1, std::memory_order_acq_rel);
}

std::optional<pulse> pulse_board::offer(const pulse& p) noexcept
{
    std::size_t last = places;
    pulse latest = p;
    std::uint32_t latest_turn = 0;
    for (std::size_t n = 0; n < places; ++n) {
        const std::uint32_t turn = places_[n].turn.load(std::memory_order_acquire);
        if (!is_taken(turn)) {
            fill(places_[n], p, turn);
            return std::nullopt;
        }
        if (const pulse here = read(places_[n]); here > latest) {
            last = n;
            latest = here;
            latest_turn = turn;
        }
    }
    if (last == places)
        return p;
    const bool made_way = end_turn(last, latest_turn);
    // The place is free in either case: otherwise its pulse has just been sent.
    fill(places_[last], p, latest_turn + 1);
    return made_way ? std::optional(latest) : std::nullopt;
}

template <typename Unwanted>
std::size_t pulse_board::remove(Unwanted unwanted) noexcept
{
    std::size_t removed = 0;
    for (std::size_t n = 0; n < places; ++n) {
        const std::uint32_t turn = places_[n].turn.load(std::memory_order_acquire);
        if (is_taken(turn) && unwanted(read(places_[n])) && end_turn(n, turn))
            ++removed;
    }
    return removed;
}

std::size_t pulse_board::forget(stroke_id id) noexcept
{
    return remove([id](const pulse& p) { return p.id == id; });
}

void pulse_board::forget_other_epochs(std::uint64_t epoch) noexcept
{
    remove([epoch](const pulse& p) { return p.epoch != epoch; });
}

std::optional<pulse_board::seen> pulse_board::next(const clock_line& line) const noexcept
{
    std::optional<seen> first;
    for (std::size_t n = 0; n < places; ++n) {
        const std::uint32_t turn = places_[n].turn.load(std::memory_order_acquire);
        if (!is_taken(turn))
            continue;
        const seen here{.what = read(places_[n]), .place = n, .turn = turn};
        if (here.what.epoch == line.epoch && (!first || here.what < first->what) &&
            places_[n].turn.load(std::memory_order_acquire) == turn)
            first = here;
    }
    return first;
}

} // namespace tactor::engine
