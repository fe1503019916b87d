// SPDX-License-Identifier: MIT
#include "study/session/key_input.hpp"

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <linux/input.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <tactor/error.hpp>

#include "rt/clock.hpp"
#include "session/pipes.hpp"
#include "session/say.hpp"

namespace tactor::study {
namespace {

// Puts all descriptors into one, so that a caller can wait for it. A file is always ready and stays out.
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

std::optional<operator_key> find_operator_key(char c)
{
    // In the order of operator_key.
    const std::size_t at = std::string_view("rvpgq").find(c);
    return at != std::string_view::npos ? std::optional(static_cast<operator_key>(at)) : std::nullopt;
}

unsigned digit(char c)
{
    return c >= '1' && c <= '9' ? static_cast<unsigned>(c - '0') : 0;
}

std::optional<session_key> read_key(const std::optional<std::string>& typed)
{
    if (!typed)
        return {};
    session_key k{.at_ns = rt::monotonic_ns()};
    if (typed->size() != 1)
        return k;
    k.character = typed->front();
    k.asked = find_operator_key(k.character);
    k.answer = digit(k.character);
    return k;
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

// Reads the keys of a terminal, so that a key which is still held down is known to be.
void key_input::forget()
{
    while (terminal_ ? next().has_value() : pressed().has_value())
        ;
}

void key_input::tell_of_repeats()
{
    if (!std::exchange(told_, true))
        session::say(stderr, "tactor: a key is held down: it answers nothing until it is let go\n");
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
        read_ns_ = rt::monotonic_ns();
        text_.append(bytes, static_cast<std::size_t>(n));
        if (terminal_ || text_.find('\n') != text_.npos)
            return;
    }
}

void key_input::end()
{
    ended_ = true;
    if (any_) // an ended input would be ready for ever
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
    repeated_ = false;
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
    std::string line = text_.substr(0, end);
    text_.erase(0, end == text_.npos ? end : end + (terminal_ ? 0 : 1));
    if (terminal_)
        repeated_ = guard_.is_repeated(line.front(), read_ns_, text_.starts_with(line));
    else
        std::erase_if(line, [](char c) { return c == ' ' || c == '\t' || c == '\r'; });
    return line;
}

std::optional<char> find_answer(std::uint16_t code) noexcept
{
    // Keys in a row. To the kernel a button box is a joystick, or has buttons without a purpose.
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
              ((keys[code / 8] >> (code % 8) & 1U) != 0 && find_answer(static_cast<std::uint16_t>(code)));
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
            if (const auto answer = find_answer(e.code))
                return answer;
    }
}

session_keys::session_keys(stage& s, const answering& with)
    : stage_(s), page_(with.page), input_(with.keypads, page_ == nullptr ? -1 : page_->descriptor())
{
}

void session_keys::drop_pressed()
{
    while (input_.pressed())
        ;
}

std::optional<session_key> session_keys::poll()
{
    if (page_ == nullptr) {
        std::optional<session_key> k = read_key(input_.next());
        if (k)
            k->repeated = input_.is_repeated() && !k->asked;
        return k;
    }
    while (const auto key = input_.pressed())
        page_->press(*key);
    while (const auto k = read_key(input_.typed()))
        if (k->asked)
            return session_key{.asked = k->asked, .at_ns = k->at_ns};
    if (const auto a = page_->poll())
        return session_key{.character = a->key, .answer = digit(a->key), .at_ns = a->at_ns};
    return {};
}

session_key session_keys::wait()
{
    for (;;) {
        if (const auto k = poll()) {
            if (!k->repeated)
                return *k;
            input_.tell_of_repeats();
            continue;
        }
        if (page_ == nullptr && input_.ended())
            throw error(error_kind::runtime, "the session", "there is no answer any more",
                        "what was answered is kept; --resume goes on");
        stage_.wait_for(input_.descriptor());
    }
}

} // namespace tactor::study
