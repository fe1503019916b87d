// SPDX-License-Identifier: MIT
#include "session/interrupt.hpp"

#include <cerrno>
#include <system_error>

#include <sys/signalfd.h>
#include <unistd.h>

#include <tactor/error.hpp>

namespace tactor::session {

interrupt::interrupt()
{
    sigset_t set;
    sigemptyset(&set);
    for (int s : {SIGINT, SIGTERM, SIGHUP, SIGQUIT})
        sigaddset(&set, s);
    pthread_sigmask(SIG_BLOCK, &set, &before_);
    fd_ = signalfd(-1, &set, SFD_NONBLOCK | SFD_CLOEXEC);
    if (fd_ < 0)
        throw error(error_kind::runtime, "signals", std::generic_category().message(errno));
}

interrupt::~interrupt()
{
    close(fd_);
    if (!last_)
        pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

int interrupt::poll() noexcept
{
    signalfd_siginfo info{};
    if (read(fd_, &info, sizeof info) != sizeof info)
        return 0;
    return static_cast<int>(info.ssi_signo);
}

} // namespace tactor::session
