// SPDX-License-Identifier: MIT
#include <algorithm>
#include <optional>
#include <tuple>
#include <vector>

#include "plan/job.hpp"
#include "plan/rounded.hpp"

namespace tactor::detail {

std::vector<conflict> find_conflicts(const std::vector<burst>& bursts)
{
    std::vector<conflict> found;
    struct state {
        double sounds_until_s;
        std::ptrdiff_t last = -1; // place in `found`
    };
    std::vector<std::optional<state>> tactors;
    for (const burst& b : bursts)
        for (const drive& d : b.drives) {
            const double end = b.onset_s + b.duration_s;
            if (d.tactor >= tactors.size())
                tactors.resize(d.tactor + std::size_t{1});
            std::optional<state>& there = tactors[d.tactor];
            if (!there) {
                there = state{end};
                continue;
            }
            state& s = *there;
            const double until = std::min(end, s.sounds_until_s);
            if (until - b.onset_s > same_time_s) {
                if (s.last >= 0 && b.onset_s <= found[static_cast<std::size_t>(s.last)].to_s + same_time_s) {
                    double& to = found[static_cast<std::size_t>(s.last)].to_s;
                    to = std::max(to, until);
                } else {
                    s.last = static_cast<std::ptrdiff_t>(found.size());
                    found.push_back({d.tactor, b.onset_s, until});
                }
            }
            s.sounds_until_s = std::max(s.sounds_until_s, end);
        }
    std::sort(found.begin(), found.end(), [](const conflict& a, const conflict& b) {
        return std::tie(a.from_s, a.tactor) < std::tie(b.from_s, b.tactor);
    });
    return found;
}

} // namespace tactor::detail
