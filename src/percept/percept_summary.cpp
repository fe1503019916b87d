// SPDX-License-Identifier: MIT
#include <tactor/percept.hpp>

#include "percept/summing.hpp"

namespace tactor {
inline namespace v0 {

percept_summary summarise(const std::vector<percept_sample>& samples)
{
    detail::summing sums;
    for (const percept_sample& x : samples) {
        sums.add(x);
        if (x.felt && x.speed_mm_s)
            sums.add_speed(*x.speed_mm_s);
    }
    return sums.result();
}

} // namespace v0
} // namespace tactor
