// SPDX-License-Identifier: MIT
#include "session/interrupt.hpp"

#include <cerrno>
#include <csignal>
#include <system_error>

#include <sys/signalfd.h>
#include <unistd.h>

#include <tactor/error.hpp>

namespace tactor::session {
namespace {

volatile std::sig_atomic_t ending_signal = 0;

// Runs in a signal's handler: makes system calls only.
extern "C" void end_now(int)
{
    constexpr char text[] = "tactor: the device does not answer: ended all the same\n";
    static_cast<void>(!write(STDERR_FILENO, text, sizeof text - 1));
    _exit(interrupt::status(ending_signal));
}

} // namespace

interrupt::interrupt(unsigned grace_s) : grace_s_(grace_s)
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
    alarm(0);
    ending_signal = 0;
    close(fd_);
    if (!last_)
        pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

int interrupt::poll() noexcept
{
    signalfd_siginfo info{};
    if (read(fd_, &info, sizeof info) != sizeof info)
        return 0;
    const auto signal = static_cast<int>(info.ssi_signo);
    if (ending_signal == 0 && std::signal(SIGALRM, end_now) != SIG_ERR) {
        ending_signal = signal;
        alarm(grace_s_);
    }
    return signal;
}

} // namespace tactor::session
