// SPDX-License-Identifier: MIT
#include "rt/thread.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <latch>
#include <optional>
#include <system_error>
#include <utility>

#include <linux/capability.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include "rt/clock.hpp"
#include "rt/nonblocking.hpp"

namespace tactor::rt {
namespace {

std::atomic<realtime_helper> helper = nullptr;

struct launch {
    const thread_options& options;
    std::function<void()> body;
    std::latch tried{1};
    std::latch helped{1};
    std::latch started{1};
    int fifo_error = -1;
    pid_t thread = 0;
};

int set_fifo_priority(int priority) noexcept
{
    sched_param p{};
    p.sched_priority =
        std::clamp(priority, sched_get_priority_min(SCHED_FIFO), sched_get_priority_max(SCHED_FIFO));
    // The thread sets its policy itself, because glibc's pthread attributes refuse the reset flag.
    if (sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &p) == 0)
        return 0;
    const int code = errno;
    // A lower priority than requested is still far better than none.
    rlimit most{};
    if (code != EPERM || getrlimit(RLIMIT_RTPRIO, &most) != 0 || most.rlim_cur == 0 ||
        most.rlim_cur >= static_cast<rlim_t>(p.sched_priority))
        return code;
    p.sched_priority = static_cast<int>(most.rlim_cur);
    return sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &p) == 0 ? 0 : errno;
}

void flush_denormals() noexcept
{
#if defined(__SSE2__)
    _mm_setcsr(_mm_getcsr() | 0x8040U); // FTZ and DAZ
#elif defined(__aarch64__)
    unsigned long fpcr = 0;
    __asm__ volatile("mrs %0, fpcr" : "=r"(fpcr));
    fpcr |= 1UL << 24;
    __asm__ volatile("msr fpcr, %0" : : "r"(fpcr));
#elif defined(__arm__) && defined(__ARM_FP)
    unsigned fpscr = 0;
    __asm__ volatile("vmrs %0, fpscr" : "=r"(fpscr));
    fpscr |= 1U << 24;
    __asm__ volatile("vmsr fpscr, %0" : : "r"(fpscr));
#endif
}

void* enter(void* argument) noexcept
{
    launch& l = *static_cast<launch*>(argument);
    const std::string name = l.options.name.substr(0, 15);
    pthread_setname_np(pthread_self(), name.c_str());
    if (l.options.fifo)
        l.fifo_error = set_fifo_priority(l.options.priority);
    l.thread = ::gettid();
    l.tried.count_down();
    l.helped.wait();
    if (l.options.audio) {
        prctl(PR_SET_TIMERSLACK, 1UL);
        flush_denormals();
    }
    const std::function<void()> body = std::move(l.body);
    l.started.count_down(); // `l` is destroyed from here on
    body();
    return nullptr;
}

std::int64_t to_ns(const timeval& t) noexcept
{
    return std::int64_t{t.tv_sec} * ns_per_s + std::int64_t{t.tv_usec} * 1000;
}

bool is_realtime() noexcept
{
    const permitted_call here{};
    const int policy = sched_getscheduler(0);
    return policy >= 0 &&
           ((policy & ~SCHED_RESET_ON_FORK) == SCHED_FIFO || (policy & ~SCHED_RESET_ON_FORK) == SCHED_RR);
}

} // namespace

void set_realtime_helper(realtime_helper h) noexcept
{
    helper = h;
}

thread::thread(const thread_options& o, std::function<void()> body)
{
    launch l{.options = o, .body = std::move(body)};
    pthread_attr_t attr;
    pthread_attr_init(&attr);
    pthread_attr_setstacksize(&attr, o.stack_bytes);
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before); // the new thread inherits the mask
    const int code = pthread_create(&handle_, &attr, enter, &l);
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    pthread_attr_destroy(&attr);
    if (code != 0)
        throw std::system_error(code, std::generic_category(), "thread " + o.name);

    joinable_ = true;
    l.tried.wait();
    const realtime_helper help = helper;
    if (l.fifo_error == EPERM && help != nullptr && help(l.thread, o.priority))
        l.fifo_error = 0;
    l.helped.count_down();
    l.started.wait();
    fifo_error_ = l.fifo_error;
}

thread::~thread()
{
    join();
}

void thread::join() noexcept
{
    if (joinable_)
        pthread_join(handle_, nullptr);
    joinable_ = false;
}

void thread::detach() noexcept
{
    if (joinable_)
        pthread_detach(handle_);
    joinable_ = false;
}

busy_watch::busy_watch() noexcept : on_(is_realtime())
{
}

bool busy_watch::look(std::int64_t now_ns) noexcept
{
    if (!on_ || now_ns < next_ns_)
        return false;
    next_ns_ = now_ns + pause_ns;
    const permitted_call here{};
    rusage u{};
    if (::getrusage(RUSAGE_THREAD, &u) != 0 ||
        !busy_.too_long(to_ns(u.ru_utime) + to_ns(u.ru_stime), u.ru_nvcsw))
        return false;
    on_ = false;
    const sched_param none{};
    // The thread may lack the right to clear this flag.
    return sched_setscheduler(0, SCHED_OTHER | SCHED_RESET_ON_FORK, &none) == 0;
}

std::string realtime_hint(const realtime_rights& r, int priority)
{
    if (r.priority >= priority && !r.lockable_bytes)
        return "write -1 to /proc/sys/kernel/sched_rt_runtime_us: the limits allow the priority, so the "
               "kernel's group scheduling must forbid it";
    if (geteuid() == 0)
        return "start the container with --cap-add SYS_NICE --cap-add IPC_LOCK: root lacks these "
               "capabilities";
    return "put the lines \"@audio - rtprio 70\" and \"@audio - memlock 262144\" into "
           "/etc/security/limits.d/tactor.conf, join the group audio (sudo usermod -aG audio $USER) and log "
           "in again; in a systemd unit, LimitRTPRIO=70 and LimitMEMLOCK=256M";
}

} // namespace tactor::rt

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
