// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/player.hpp>

#include "core/words.hpp"

namespace tactor {
inline namespace v0 {
namespace {

constexpr double rounding = 1e-6;

const std::vector<unsigned>& reached(const stream_wiring& w, const tactor_spec& t)
{
    static const std::vector<unsigned> none;
    return t.channel < w.outputs.size() ? w.outputs[t.channel] : none;
}

// The first other tactor that reaches this output, too.
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

// Describes gains that a plan's levels do not know; empty if there are none.
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
    std::map<unsigned, unsigned> users; // of each output
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
