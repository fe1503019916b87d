// SPDX-License-Identifier: MIT
#include "engine/control/player_impl.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

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
        throw error(error_kind::not_available, fmt::format("stream on \"{}\"", s.name), lost,
                    "give each channel one of the device's, at 1, where the PCM is defined (ttable, "
                    "bindings), or play on the card itself, hw:CARD=NAME");
    return a;
}

void check_fits(const score& s, const stream_setup& stream, std::span<const double> limits)
{
    if (s.rate() != stream.rate || s.channels() != stream.channels)
        throw error(error_kind::bad_input, "stroke",
                    fmt::format("made for {} at {} Hz, the stream has {} at {} Hz",
                                counted(s.channels(), "channel"), s.rate(), stream.channels, stream.rate),
                    "render it with the stream's rate and channels, or open the stream with the score's")
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

namespace tactor {
inline namespace v0 {
namespace {

constexpr double rounding = 1e-6;

const std::vector<unsigned>& reached(const stream_wiring& w, const tactor_spec& t)
{
    static const std::vector<unsigned> none;
    return t.channel < w.outputs.size() ? w.outputs[t.channel] : none;
}

// Returns the first other tactor that also reaches this output.
std::size_t partner(const array& a, const stream_wiring& w, std::size_t i, unsigned output)
{
    std::size_t k = 0;
    while (k == i ||
           !std::binary_search(reached(w, a.tactors[k]).begin(), reached(w, a.tactors[k]).end(), output))
        ++k;
    return k;
}

std::span<const double> gains_at(const stream_wiring& w, const tactor_spec& t)
{
    return t.channel < w.gains.size() ? std::span<const double>(w.gains[t.channel])
                                      : std::span<const double>();
}

std::string place(const array& a, std::size_t i)
{
    return fmt::format("tactor {} of {} is on channel {}", i, a.name, a.tactors[i].channel);
}

std::string gain_text(double gain)
{
    return fmt::format("{} dB{}", plain_number(20.0 * std::log10(std::abs(gain)), 3),
                       gain < 0.0 ? " with its polarity reversed" : "");
}

// Describes gains that a plan's levels do not include; empty if there are none.
std::string remark(std::span<const double> gains)
{
    const auto is_one = [](double g) { return std::abs(g - 1.0) <= rounding; };
    if (gains.empty() || (gains.size() == 1 && is_one(gains.front())))
        return {};
    std::vector<std::string> levels;
    for (const double g : gains)
        levels.push_back(gain_text(g));
    if (gains.size() == 1)
        return fmt::format("which ALSA's configuration plays at {}", levels.front());
    return fmt::format("which reaches {} channels of the device, at {}", gains.size(),
                       fmt::join(levels, ", "));
}

} // namespace

std::vector<std::string> wiring_warnings(const array& a, const stream_wiring& w)
{
    std::vector<std::string> all;
    for (std::size_t i = 0; i < a.tactors.size(); ++i)
        if (const std::string odd = remark(gains_at(w, a.tactors[i])); !odd.empty())
            all.push_back(fmt::format("{}, {}", place(a, i), odd));
    if (w.most_gain > 1.0 + rounding)
        all.push_back(fmt::format("ALSA's configuration raises samples by up to {} on the way to the device, "
                                  "and clips them there at full scale",
                                  gain_text(w.most_gain)));
    if (!w.level_by.empty())
        all.push_back(
            fmt::format("a mixer control sets the level of all tactors: {} is between", w.level_by));
    return all;
}

std::string lost_tactor(const array& a, const stream_wiring& w)
{
    if (w.outputs.empty())
        return {};
    for (std::size_t i = 0; i < a.tactors.size(); ++i)
        for (const double g : gains_at(w, a.tactors[i]))
            if (std::abs(g) > 1.0 + rounding)
                return fmt::format("{}, which ALSA's configuration plays at {}: louder than its limit allows",
                                   place(a, i), gain_text(g));
    std::map<unsigned, unsigned> users; // number of tactors by output
    for (const tactor_spec& t : a.tactors)
        for (const unsigned output : reached(w, t))
            ++users[output];
    for (std::size_t i = 0; i < a.tactors.size(); ++i) {
        const std::vector<unsigned>& mine = reached(w, a.tactors[i]);
        if (std::any_of(mine.begin(), mine.end(), [&](unsigned output) { return users[output] == 1; }))
            continue;
        const std::string who = place(a, i);
        if (mine.empty())
            return who + ", which reaches no channel of the device";
        const std::size_t other = partner(a, w, i, mine.front());
        return fmt::format("{}, which reaches the device only together with channel {} of tactor {}", who,
                           a.tactors[other].channel, other);
    }
    return {};
}

} // namespace v0
} // namespace tactor
