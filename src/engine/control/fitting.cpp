// SPDX-License-Identifier: MIT
#include "engine/control/fitting.hpp"

#include <cstddef>
#include <string>

#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/player.hpp>

#include "core/access.hpp"
#include "core/words.hpp"
#include "synth/score/levels.hpp"
#include "synth/score/score.hpp"

namespace tactor::engine {
namespace {

constexpr const char* replan = "plan it for the array that the player was opened with";

void check_tactor(const score::impl& s, std::size_t i, std::span<const double> limits)
{
    constexpr double rounding = 1.0 + 1e-6;
    const std::uint32_t channel = s.tactors[i].channel;
    const double limit = limits[channel];
    if (limit == 0.0)
        throw error(
            error_kind::bad_input, "stroke",
            fmt::format("it drives tactor {} on channel {}, where the player's array has none", i, channel),
            replan);
    if (s.asked[i] > limit * rounding)
        throw error(error_kind::bad_input, "stroke",
                    fmt::format("it drives tactor {} at up to {:.4g} dBFS, but the player's array allows "
                                "{:.4g} dBFS on channel {}",
                                i, synth::in_db(s.asked[i]), synth::in_db(limit), channel),
                    replan);
}

} // namespace

const array& fitting(const array& a, const stream_setup& s)
{
    for (std::size_t i = 0; i < a.tactors.size(); ++i)
        if (a.tactors[i].channel >= s.channels)
            throw error(error_kind::bad_input, "player",
                        fmt::format("tactor {} of {} is on channel {}, but the stream has {} channel{}", i,
                                    a.name, a.tactors[i].channel, s.channels, s.channels == 1 ? "" : "s"),
                        fmt::format("open it with {}; they count from 0", counted(a.channels(), "channel")));
    if (const std::string lost = lost_tactor(a, s.wiring); !lost.empty())
        throw error(
            error_kind::not_available, fmt::format("stream on \"{}\"", s.name), lost,
            "give each channel one of the device's, at 1, where the PCM is defined (ttable, bindings), "
            "or play on the card itself, hw:CARD=NAME");
    return a;
}

void check_fits(const score& s, const stream_setup& stream, std::span<const double> limits)
{
    if (s.rate() != stream.rate || s.channels() != stream.channels)
        throw error(error_kind::bad_input, "stroke",
                    fmt::format("made for {} at {} Hz, the stream has {} at {} Hz",
                                counted(s.channels(), "channel"), s.rate(), stream.channels, stream.rate),
                    "render it with the stream's rate and channels")
            .with_field(s.channels() == stream.channels ? "rate"
                        : s.rate() == stream.rate       ? "channels"
                                                        : "");
    const score::impl& made = detail::access::of(s);
    for (std::size_t i = 0; i < made.asked.size(); ++i)
        if (made.asked[i] > 0.0)
            check_tactor(made, i, limits);
    if (made.marker && limits[*made.marker] > 0.0)
        throw error(
            error_kind::bad_input, "stroke",
            fmt::format("its marker is on channel {}, where the player's array has a tactor", *made.marker),
            "choose a spare channel for it")
            .with_field("marker_channel");
}

} // namespace tactor::engine
