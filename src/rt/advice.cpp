// SPDX-License-Identifier: MIT
#include "rt/advice.hpp"

#include <unistd.h>

namespace tactor::rt {

std::string realtime_advice(const realtime_rights& r, int priority)
{
    if (r.priority >= priority && !r.lockable_bytes)
        return "the limits allow it, so the kernel's group scheduling must forbid it: write -1 to "
               "/proc/sys/kernel/sched_rt_runtime_us";
    if (geteuid() == 0)
        return "root without the capabilities for it, as in a container: start that with --cap-add SYS_NICE "
               "--cap-add IPC_LOCK";
    return "put the lines \"@audio - rtprio 70\" and \"@audio - memlock 262144\" into "
           "/etc/security/limits.d/tactor.conf, join the group audio (sudo usermod -aG audio $USER) and log "
           "in again; in a systemd unit, LimitRTPRIO=70 and LimitMEMLOCK=256M";
}

} // namespace tactor::rt
