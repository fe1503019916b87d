// SPDX-License-Identifier: MIT
#include "study/session/key_input.hpp"

#include <cerrno>
#include <cstring>

#include <poll.h>
#include <sys/epoll.h>
#include <unistd.h>

#include <tactor/error.hpp>

#include "session/pipes.hpp"

namespace tactor::study {

namespace {

// All in one, for who waits for one. A file is always ready, and cannot be waited for.
detail::owned_fd open_any(const std::list<keypad>& keypads, int besides)
{
    detail::owned_fd any(::epoll_create1(EPOLL_CLOEXEC));
    const auto add = [&any](int descriptor) {
        epoll_event readable{};
        readable.events = EPOLLIN;
        return ::epoll_ctl(any.get(), EPOLL_CTL_ADD, descriptor, &readable) == 0;
    };
    bool all = any && (besides < 0 || add(besides));
    for (const keypad& k : keypads)
        all = all && add(k.descriptor());
    if (!all)
        throw error(error_kind::runtime, "epoll", std::strerror(errno));
    static_cast<void>(add(STDIN_FILENO));
    return any;
}

} // namespace

key_input::key_input(const std::vector<std::string>& keypads, int besides)
    : terminal_(::isatty(STDIN_FILENO) != 0 && ::tcgetattr(STDIN_FILENO, &before_) == 0)
{
    for (const std::string& device : keypads)
        keypads_.emplace_back(device);
    if (!keypads_.empty() || besides >= 0)
        any_ = open_any(keypads_, besides);
    if (!terminal_)
        return;
    termios keys = before_;
    keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    keys.c_cc[VMIN] = 1;
    keys.c_cc[VTIME] = 0;
    ::tcsetattr(STDIN_FILENO, TCSANOW, &keys);
}

key_input::~key_input()
{
    if (terminal_)
        ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

void key_input::forget()
{
    while (pressed())
        ;
    if (!terminal_)
        return;
    ::tcflush(STDIN_FILENO, TCIFLUSH);
    text_.clear();
}

void key_input::fill()
{
    pollfd p{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    while (!ended_ && ::poll(&p, 1, 0) > 0) {
        char bytes[256];
        const ssize_t n = ::read(STDIN_FILENO, bytes, sizeof bytes);
        if (n < 0 && (errno == EINTR || errno == EAGAIN))
            return;
        if (n < 0)
            session::refuse_standard_input(errno);
        if (n == 0)
            end();
        text_.append(bytes, static_cast<std::size_t>(n));
        if (terminal_ || text_.find('\n') != text_.npos)
            return;
    }
}

void key_input::end()
{
    ended_ = true;
    if (any_) // it would be ready for ever
        static_cast<void>(::epoll_ctl(any_.get(), EPOLL_CTL_DEL, STDIN_FILENO, nullptr));
}

std::optional<char> key_input::pressed()
{
    for (keypad& k : keypads_)
        if (const auto key = k.next())
            return key;
    return {};
}

std::optional<std::string> key_input::next()
{
    const auto key = pressed();
    return key ? std::string(1, *key) : typed();
}

std::optional<std::string> key_input::typed()
{
    if (text_.find('\n') == text_.npos && (text_.empty() || !terminal_))
        fill();
    std::size_t end = terminal_ ? 1 : text_.find('\n');
    if (text_.empty() || (end == text_.npos && !ended_))
        return std::nullopt;
    std::string said = text_.substr(0, end);
    text_.erase(0, end == text_.npos ? end : end + (terminal_ ? 0 : 1));
    if (!terminal_)
        std::erase_if(said, [](char c) { return c == ' ' || c == '\t' || c == '\r'; });
    return said;
}

} // namespace tactor::study
