// SPDX-License-Identifier: MIT
#include "core/trajectory/units.hpp"

#include <fmt/format.h>

#include "core/words.hpp"

namespace tactor::detail {
namespace {

constexpr double near_mm = 1.0; // in metres, a hand is 0.2 wide and an arm 0.6 long
constexpr double slow_mm_s = 1.0;
constexpr double slow_from_s = 60.0; // a finger that rests is this slow for a shorter time
constexpr double fast_mm_s = 5000.0;
constexpr double judged_live_from_s = 1.0;

} // namespace

std::string unit_warning(const travel& t)
{
    if (!(t.length_mm > 0.0 && t.moving_s > 0.0))
        return {};
    if (t.farthest_mm < near_mm)
        return fmt::format(
            "all its places are within {} mm of (0, 0): if they are metres, multiply them by 1000",
            plain_number(t.farthest_mm, 3));
    const double mm_s = t.length_mm / t.moving_s;
    const bool is_live = t.source == pace_source::live;
    const bool is_fast = mm_s > fast_mm_s && (!is_live || t.moving_s > judged_live_from_s);
    if (!is_fast && (is_live || !(mm_s < slow_mm_s && t.moving_s > slow_from_s)))
        return {};
    const std::string how =
        fmt::format("it moves {} mm in {}, {} mm/s, {} than a hand", plain_number(t.length_mm, 4),
                    seconds_text(t.moving_s, 4), plain_number(mm_s, 3), is_fast ? "faster" : "slower");
    if (t.source == pace_source::speed)
        return fmt::format("{}: if its speed is in {}, {} it by 1000", how,
                           is_fast ? "micrometres a second" : "m/s", is_fast ? "divide" : "multiply");
    return is_fast ? fmt::format("{}: if its places are micrometres, divide them by 1000", how)
                   : fmt::format("{}: if its times are milliseconds, divide them by 1000", how);
}

} // namespace tactor::detail
