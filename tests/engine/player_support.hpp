// SPDX-License-Identifier: MIT
/// \file
/// Support for tests of the player.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>
#include <tactor/player.hpp>
#include <tactor/sink.hpp>

#include "clock_runner.hpp"
#include "fake_dac.hpp"
#include "scores.hpp"
#include "sink/alsa/pcm_sink.hpp"

namespace tactor::test {

inline alsa_options nine(format_kind f = format_kind::s32)
{
    alsa_options o{.channels = 9, .format = f};
    return o;
}

/// A sink without a device or a memory.
class deaf_sink final : public paced_sink {
public:
    using paced_sink::paced_sink;

private:
    io_kind take(std::uint64_t, std::span<const std::byte>) noexcept override { return io_kind::ok; }
};

struct dac_holder {
    fake_dac dac{};
};

/// A player on a fake DAC, whose clock stands still until a running_clock moves it.
struct dac_player : dac_holder, player {
    explicit dac_player(const player_options& o = patient(), player_lines lines = {})
        : player(alsa::adopt(dac.pcm(), nine()), palm(), o, std::move(lines))
    {
    }
};

struct clock_holder : dac_holder {
    running_clock clock{dac};
};

/// A player on a fake DAC whose clock runs.
struct clocked_player : clock_holder, player {
    explicit clocked_player(const player_options& o = patient(), player_lines lines = {},
                            const array& a = palm())
        : player(alsa::adopt(dac.pcm(), nine()), a, o, std::move(lines))
    {
    }
};

/// Plays a score on a stream that fails before or after it begins. Returns the reason.
inline std::string play_to_failure(player& p, const score& s)
{
    try {
        const auto report = p.wait(p.submit(s));
        REQUIRE(report);
        CHECK(report->state == state_kind::interrupted);
        return report->why;
    } catch (const error& e) {
        CHECK(e.kind() == error_kind::runtime);
        return e.what();
    }
}

/// Blocks until a count, whose changes are notified, is at least `wanted`.
template <typename N>
void await(const std::atomic<N>& count, std::type_identity_t<N> wanted)
{
    for (N seen = count; seen < wanted; seen = count)
        count.wait(seen);
}

/// Returns n bytes from `from` on.
inline std::vector<std::byte> part(const std::vector<std::byte>& all, std::size_t from, std::size_t n)
{
    REQUIRE(from + n <= all.size());
    return {all.begin() + static_cast<std::ptrdiff_t>(from),
            all.begin() + static_cast<std::ptrdiff_t>(from + n)};
}

} // namespace tactor::test
