// SPDX-License-Identifier: MIT
#include <tactor/version.hpp>

#include <algorithm>
#include <array>
#include <cstdint>

#include <linux/capability.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace tactor {
inline namespace v0 {
namespace {

std::uint64_t effective_capabilities() noexcept
{
    // Does not read /proc/self/status, because there may be no descriptor left.
    __user_cap_header_struct version{.version = _LINUX_CAPABILITY_VERSION_3, .pid = 0};
    std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> sets{};
    if (::syscall(SYS_capget, &version, sets.data()) != 0)
        return 0;
    return std::uint64_t{sets[1].effective} << 32U | sets[0].effective;
}

} // namespace

realtime_rights probe_realtime_rights() noexcept
{
    const std::uint64_t capabilities = effective_capabilities();
    const auto has = [capabilities](unsigned bit) { return (capabilities >> bit & 1U) != 0; };
    realtime_rights r;
    rlimit limit{};
    if (has(CAP_SYS_NICE))
        r.priority = sched_get_priority_max(SCHED_FIFO);
    else if (getrlimit(RLIMIT_RTPRIO, &limit) == 0)
        r.priority = static_cast<int>(
            std::min<rlim_t>(limit.rlim_cur, static_cast<rlim_t>(sched_get_priority_max(SCHED_FIFO))));
    if (has(CAP_IPC_LOCK))
        r.lockable_bytes.reset();
    else if (getrlimit(RLIMIT_MEMLOCK, &limit) == 0)
        r.lockable_bytes =
            limit.rlim_cur == RLIM_INFINITY ? std::nullopt : std::optional<std::uint64_t>(limit.rlim_cur);
    return r;
}

} // namespace v0
} // namespace tactor
