// SPDX-License-Identifier: MIT
#include <algorithm>
#include <map>

#include <fmt/format.h>

#include <tactor/player.hpp>

namespace tactor {
inline namespace v0 {
namespace {

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

} // namespace

std::string lost_tactor(const array& a, const stream_wiring& w)
{
    if (w.outputs.empty())
        return {};
    std::map<unsigned, unsigned> users; // of each output
    for (const tactor_spec& t : a.tactors)
        for (const unsigned output : reached(w, t))
            ++users[output];
    for (std::size_t i = 0; i < a.tactors.size(); ++i) {
        const std::vector<unsigned>& mine = reached(w, a.tactors[i]);
        if (std::any_of(mine.begin(), mine.end(), [&](unsigned output) { return users[output] == 1; }))
            continue;
        const std::string who =
            fmt::format("tactor {} of {} is on channel {}", i, a.name, a.tactors[i].channel);
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
