// SPDX-License-Identifier: MIT
#include "study/session/key_input.hpp"

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <linux/input.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/ioctl.h>
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

struct key {
    std::uint16_t code;
    char answer;
};

constexpr key others[] = {{KEY_KP1, '1'}, {KEY_KP2, '2'},    {KEY_KP3, '3'},     {KEY_KP4, '4'},
                          {KEY_KP5, '5'}, {KEY_KP6, '6'},    {KEY_KP7, '7'},     {KEY_KP8, '8'},
                          {KEY_KP9, '9'}, {KEY_KPPLUS, '+'}, {KEY_KPMINUS, '-'}, {KEY_MINUS, '-'},
                          {KEY_UP, '+'},  {KEY_DOWN, '-'},   {KEY_RIGHT, '>'},   {KEY_LEFT, '<'},
                          {KEY_A, 'a'},   {KEY_ENTER, 'a'},  {KEY_KPENTER, 'a'}, {KEY_N, 'n'},
                          {KEY_0, 'n'},   {KEY_KP0, 'n'}};

constexpr std::uint16_t digit_keys = 9;

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

std::optional<char> answer_of_key(std::uint16_t code) noexcept
{
    // Keys in a row; a button box is a joystick to the kernel, or has buttons without a purpose.
    for (const std::uint16_t first : {std::uint16_t{KEY_1}, std::uint16_t{BTN_0}, std::uint16_t{BTN_TRIGGER}})
        if (code >= first && code < first + digit_keys)
            return static_cast<char>('1' + (code - first));
    for (const key& k : others)
        if (k.code == code)
            return k.answer;
    return {};
}

keypad::keypad(std::string device)
    : device_(std::move(device)),
      descriptor_(::open(device_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY))
{
    if (!descriptor_)
        throw error(error_kind::not_available, device_, std::strerror(errno),
                    errno == EACCES ? "a udev rule gives it to you: tactor-experiment(1)"
                                    : "the keypads that are there: ls /dev/input/by-id");
    hold();
}

void keypad::hold()
{
    std::array<unsigned char, KEY_MAX / 8 + 1> keys{};
    if (::ioctl(descriptor_.get(), EVIOCGBIT(EV_KEY, keys.size()), keys.data()) < 0)
        throw error(error_kind::bad_input, device_, "it is no input device",
                    "as /dev/input/by-id/...-event-kbd");
    bool any = false;
    for (std::size_t code = 0; code <= KEY_MAX; ++code)
        any = any ||
              ((keys[code / 8] >> (code % 8) & 1U) != 0 && answer_of_key(static_cast<std::uint16_t>(code)));
    if (!any)
        throw error(error_kind::bad_input, device_, "it has no key that answers anything",
                    "a keypad, a button box, or buttons with the codes of the digits");
    if (::ioctl(descriptor_.get(), EVIOCGRAB, 1) < 0)
        throw error(error_kind::not_available, device_, std::strerror(errno), "another program holds it");
}

std::optional<char> keypad::next()
{
    input_event e{};
    for (;;) {
        const ssize_t n = ::read(descriptor_.get(), &e, sizeof e);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0 && errno == EAGAIN)
            return {};
        if (n != static_cast<ssize_t>(sizeof e))
            throw error(error_kind::runtime, device_, n < 0 ? std::strerror(errno) : "it has ended",
                        "what was answered is kept; --resume goes on");
        // 1: pressed; 0 and 2: let go, and repeated.
        if (e.type == EV_KEY && e.value == 1)
            if (const auto answer = answer_of_key(e.code))
                return answer;
    }
}

} // namespace tactor::study
