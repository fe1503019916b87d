// SPDX-License-Identifier: MIT
#include "server/start_wish.hpp"

#include <cmath>
#include <string>

#include "server/clock.hpp"
#include "server/faults.hpp"

namespace tactor::server {
namespace {

constexpr double longest_wait_s = 86400.0;

} // namespace

start_wish read_start(const net::json* start, std::int64_t now_ns)
{
    constexpr const char* forms = R"("now", "armed", {"delay_s":S}, {"monotonic_s":S} or {"unix_s":S})";
    if (start == nullptr || *start == "now")
        return {};
    if (*start == "armed")
        return {true, {}};
    if (!start->is_object() || start->size() != 1)
        bad_param("start", "it is not known", forms);
    const std::string name = start->begin().key();
    const net::json& value = start->begin().value();
    const std::string what = "start." + name;
    const double most_s = 9e9; // a time of day for centuries
    if (name == "delay_s")
        return {false, now_ns + std::llround(number(value, what, {0.0, longest_wait_s}) * 1e9)};
    if (name != "monotonic_s" && name != "unix_s")
        bad_param(what, "it is not known", forms);
    std::int64_t at = std::llround(number(value, what, {0.0, most_s}) * 1e9);
    if (name == "unix_s")
        at += now_ns - unix_ns();
    if (static_cast<double>(at - now_ns) * 1e-9 > longest_wait_s)
        bad_param(what, "it is more than a day ahead", forms);
    return {false, at};
}

} // namespace tactor::server
