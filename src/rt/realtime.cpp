// SPDX-License-Identifier: MIT
#include <tactor/realtime.hpp>

#include <algorithm>
#include <fstream>

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

namespace tactor {
inline namespace v0 {
namespace {

constexpr unsigned cap_ipc_lock = 14; // capabilities(7)
constexpr unsigned cap_sys_nice = 23;

std::uint64_t effective_capabilities()
{
    std::ifstream in("/proc/self/status");
    for (std::string key; in >> key;) {
        if (key == "CapEff:") {
            std::uint64_t set = 0;
            in >> std::hex >> set;
            return set;
        }
    }
    return 0;
}

} // namespace

realtime_rights probe_realtime_rights()
{
    const std::uint64_t capabilities = effective_capabilities();
    const auto has = [capabilities](unsigned bit) { return (capabilities >> bit & 1U) != 0; };
    realtime_rights r;
    rlimit limit{};
    if (has(cap_sys_nice))
        r.priority = sched_get_priority_max(SCHED_FIFO);
    else if (getrlimit(RLIMIT_RTPRIO, &limit) == 0)
        r.priority = static_cast<int>(
            std::min<rlim_t>(limit.rlim_cur, static_cast<rlim_t>(sched_get_priority_max(SCHED_FIFO))));
    if (has(cap_ipc_lock))
        r.lockable_bytes.reset();
    else if (getrlimit(RLIMIT_MEMLOCK, &limit) == 0)
        r.lockable_bytes =
            limit.rlim_cur == RLIM_INFINITY ? std::nullopt : std::optional<std::uint64_t>(limit.rlim_cur);
    return r;
}

} // namespace v0
} // namespace tactor
