// SPDX-License-Identifier: MIT
#include "study/session/key_input.hpp"

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdio>
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

#include <boost/locale/utf.hpp>

#include <tactor/error.hpp>

#include "core/split.hpp"
#include "rt/clock.hpp"
#include "session/process.hpp"
#include "session/say.hpp"

namespace tactor::study {
namespace {

// Returns an epoll descriptor that is ready when a keypad, `besides` (-1: none) or standard input is ready.
// Leaves out standard input if it is a file: epoll refuses files, because they are always ready.
detail::owned_fd open_input_poll(const std::list<keypad>& keypads, int besides)
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
        throw error(error_kind::runtime, "epoll", std::strerror(errno),
                    "raise the limit of open files (ulimit -n)");
    static_cast<void>(add(STDIN_FILENO));
    return any;
}

struct key {
    std::uint16_t code;
    char answer;
};

constexpr key other_keys[] = {
    {KEY_KP1, '1'},     {KEY_KP2, '2'},   {KEY_KP3, '3'},   {KEY_KP4, '4'},       {KEY_KP5, '5'},
    {KEY_KP6, '6'},     {KEY_KP7, '7'},   {KEY_KP8, '8'},   {KEY_KP9, '9'},       {KEY_KPPLUS, '+'},
    {KEY_KPMINUS, '-'}, {KEY_MINUS, '-'}, {KEY_UP, '+'},    {KEY_DOWN, '-'},      {KEY_RIGHT, '>'},
    {KEY_LEFT, '<'},    {KEY_A, 'a'},     {KEY_ENTER, 'a'}, {KEY_KPENTER, 'a'},   {KEY_N, 'n'},
    {KEY_0, 'n'},       {KEY_KP0, 'n'},   {KEY_B, 'b'},     {KEY_BACKSPACE, 'b'}, {KEY_KPDOT, '.'}};

// Time during which the key that answered the previous question cannot begin a number or text, ns. The
// participant may still hold the key, or press it twice.
constexpr std::int64_t first_key_ns = 1'000'000'000;

constexpr bool is_backspace(std::string_view key) noexcept
{
    return key == "\x7f" || key == "\b";
}

session_key make_key(std::string text, bool is_key)
{
    session_key k{.text = std::move(text), .is_key = is_key, .at_ns = rt::monotonic_ns()};
    if (!is_key) {
        k.entered = k.text;
        std::erase_if(k.text, [](char c) { return c == ' ' || c == '\t' || c == '\r'; });
    }
    constexpr std::string_view commands = "rvpgqb"; // in the order of operator_key
    if (const std::size_t at = commands.find(k.text); k.text.size() == 1 && at != commands.npos)
        k.command = static_cast<operator_key>(at);
    k.answer = detail::parse_number_text<unsigned>(k.text);
    return k;
}

// Shows on the terminal how a key changed the typed text.
void echo(const std::string& typed, std::size_t bytes_before)
{
    if (typed.size() > bytes_before)
        session::show(typed.substr(bytes_before));
    if (typed.size() < bytes_before) {
        std::fputs("\b \b", stdout); // show() would escape these characters
        session::flush_output();
    }
}

} // namespace

std::optional<char> find_key_character(std::uint16_t code) noexcept
{
    if (code >= KEY_1 && code <= KEY_9)
        return static_cast<char>('1' + (code - KEY_1));
    for (const key& k : other_keys)
        if (k.code == code)
            return k.answer;
    return {};
}

std::optional<std::string> typed_number::add_key(char key)
{
    constexpr std::string_view takes = "0123456789.,+-eE";
    constexpr std::size_t most = 16; // longer than any answer
    constexpr char backspace = '\x7f';
    if (takes.find(key) != takes.npos && text_.size() < most)
        text_ += key;
    else if ((key == backspace || key == '\b') && !text_.empty())
        text_.pop_back();
    else if ((key == '\n' || key == '\r') && !text_.empty())
        return std::exchange(text_, {});
    return {};
}

bool typed_text::add_byte(char byte)
{
    using utf8 = boost::locale::utf::utf_traits<char>;
    if (escape_ == '\x1b' && byte != '[' && byte != 'O')
        escape_ = '\0'; // the Esc key itself
    if (byte == '\x1b' || escape_ != '\0') {
        // Skips sequences such as ESC [ A, ESC O P and ESC [ 3 ~.
        const bool goes_on =
            byte == '\x1b' || escape_ == '\x1b' ||
            (escape_ != 'O' && std::string_view(";0123456789").find(byte) != std::string_view::npos);
        escape_ = goes_on ? byte : '\0';
        return false;
    }
    if (byte == '\n' || byte == '\r')
        return true;
    if (byte == '\x7f' || byte == '\b') {
        while (!text_.empty() && utf8::is_trail(text_.back()))
            text_.pop_back();
        if (!text_.empty())
            text_.pop_back();
        return false;
    }
    begun_ += byte;
    if (auto at = begun_.cbegin(); utf8::decode(at, begun_.cend()) == boost::locale::utf::incomplete)
        return false;
    if (auto more = tidy_text(text_ + std::exchange(begun_, {})))
        text_ = *std::move(more);
    return false;
}

keypad::keypad(std::string device)
    : device_(std::move(device)),
      descriptor_(::open(device_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY))
{
    if (!descriptor_)
        throw error(error_kind::not_available, device_, std::strerror(errno),
                    errno == EACCES ? "add the udev rule of tactor-calibrate(1)"
                                    : "list the keypads: ls /dev/input/by-id");
    std::array<unsigned char, KEY_MAX / 8 + 1> keys{};
    if (::ioctl(descriptor_.get(), EVIOCGBIT(EV_KEY, keys.size()), keys.data()) < 0)
        throw error(error_kind::bad_input, device_, "it is not an input device",
                    "name one, such as /dev/input/by-id/...-event-kbd");
    bool any = false;
    for (std::size_t code = 0; code <= KEY_MAX; ++code)
        any = any || ((keys[code / 8] >> (code % 8) & 1U) != 0 &&
                      find_key_character(static_cast<std::uint16_t>(code)));
    if (!any)
        throw error(error_kind::bad_input, device_, "it has no key for an answer",
                    "use a keypad, or a box whose buttons send the keys 1 to 9");
    if (::ioctl(descriptor_.get(), EVIOCGRAB, 1) < 0)
        throw error(error_kind::not_available, device_, std::strerror(errno),
                    "end the program that uses the device");
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
            throw error(error_kind::runtime, device_, n < 0 ? std::strerror(errno) : "it was unplugged",
                        resume_hint);
        // Value 1 is a press, 0 a release, 2 a repetition.
        if (e.type == EV_KEY && e.value == 1)
            if (const auto answer = find_key_character(e.code))
                return answer;
    }
}

session_keys::session_keys(stage& s, const answering& with)
    : stage_(s),
      page_(with.page),
      terminal_(::isatty(STDIN_FILENO) != 0 && ::tcgetattr(STDIN_FILENO, &before_) == 0)
{
    for (const std::string& device : with.keypads)
        keypads_.emplace_back(device);
    if (!keypads_.empty() || page_ != nullptr)
        any_ = open_input_poll(keypads_, page_ != nullptr ? page_->descriptor() : -1);
    if (!terminal_)
        return;
    termios keys = before_;
    keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    keys.c_cc[VMIN] = 1;
    keys.c_cc[VTIME] = 0;
    ::tcsetattr(STDIN_FILENO, TCSANOW, &keys);
}

session_keys::~session_keys()
{
    if (terminal_)
        ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

void session_keys::fill()
{
    pollfd p{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    while (!ended_ && ::poll(&p, 1, 0) > 0) {
        char bytes[256];
        const ssize_t n = ::read(STDIN_FILENO, bytes, sizeof bytes);
        if (n < 0 && (errno == EINTR || errno == EAGAIN))
            return;
        if (n < 0)
            session::refuse_standard_input(errno);
        ended_ = n == 0;
        if (ended_ && any_) // at its end, standard input would always be ready
            static_cast<void>(::epoll_ctl(any_.get(), EPOLL_CTL_DEL, STDIN_FILENO, nullptr));
        read_ns_ = rt::monotonic_ns();
        text_.append(bytes, static_cast<std::size_t>(n));
        if (terminal_ || text_.find('\n') != text_.npos)
            return;
    }
}

std::optional<char> session_keys::poll_keypads()
{
    for (keypad& k : keypads_)
        if (const auto key = k.next())
            return key;
    return {};
}

// Returns the next key or line of standard input, if any.
std::optional<std::string> session_keys::poll_standard_input()
{
    if (text_.find('\n') == text_.npos && (text_.empty() || !terminal_))
        fill();
    const std::size_t end = terminal_ ? 1 : text_.find('\n');
    if (text_.empty() || (end == text_.npos && !ended_))
        return std::nullopt;
    std::string line = text_.substr(0, end);
    text_.erase(0, end == text_.npos ? end : end + (terminal_ ? 0 : 1));
    return line;
}

void session_keys::drop_keypad_keys()
{
    while (poll_keypads())
        ;
}

// Also reads the terminal's keys, so that repeat_guard recognises a key that is still held.
void session_keys::drop_keys()
{
    drop_keypad_keys();
    while (terminal_ && page_ == nullptr && poll())
        ;
}

std::optional<session_key> session_keys::poll(bool repeated)
{
    if (page_ != nullptr)
        return poll_page();
    if (const auto key = poll_keypads()) {
        session_key k = make_key(std::string(1, *key == '.' ? 'b' : *key), true);
        k.from_keypad = true;
        k.is_dot = *key == '.';
        k.since_ns = guard_.since_ns(*key, k.at_ns);
        guard_.is_repeated(*key, k.at_ns, false);
        return k;
    }
    while (auto line = poll_standard_input()) {
        const char key = line->empty() ? '\n' : line->front();
        const std::int64_t since_ns = guard_.since_ns(key, read_ns_);
        const bool is_held = terminal_ && guard_.is_repeated(key, read_ns_, text_.starts_with(*line));
        session_key k = make_key(*std::move(line), terminal_);
        k.is_held = is_held;
        k.since_ns = since_ns;
        if (!is_held || repeated || k.command)
            return k;
        if (!std::exchange(warned_, true))
            session::say(stderr, "tactor: a key is held down: it does not answer until it is released\n");
    }
    return {};
}

std::optional<session_key> session_keys::poll_page()
{
    while (const auto key = poll_keypads())
        page_->press(*key == '.' ? 'b' : *key);
    while (auto line = poll_standard_input())
        if (const session_key k = make_key(*std::move(line), terminal_); k.command)
            return session_key{.command = k.command, .at_ns = k.at_ns};
    const auto a = page_->poll();
    if (!a)
        return {};
    session_key k{.text = a->text.value_or(std::string(1, a->key)),
                  .answer = a->number,
                  .entered = a->text,
                  .at_ns = a->at_ns};
    if (a->key == 'b')
        k.command = operator_key::back;
    return k;
}

session_key session_keys::wait(const std::string& subject, bool repeated)
{
    for (;;) {
        if (auto k = poll(repeated))
            return *std::move(k);
        if (has_ended()) {
            session::show("\n");
            throw error(error_kind::runtime, subject, "the input ended", resume_hint);
        }
        stage_.wait_for(any_ ? any_.get() : STDIN_FILENO);
    }
}

session_key session_keys::wait_for_number(typed_number& number, bool estimate)
{
    const std::string& shown = number.text();
    for (;;) {
        session_key k = wait("the session", true);
        const bool is_point = k.is_dot && estimate;
        // While a number is being typed, a keypad's b erases its last digit.
        const bool erases = k.from_keypad && k.command && !is_point && !shown.empty();
        if (!k.is_key || (k.command && !erases && !is_point))
            return k;
        if (shown.empty() && k.since_ns < first_key_ns)
            continue;
        const std::size_t before = shown.size();
        const char key = k.text.front();
        // For adjustments, find_key_character() returns a for a keypad's Enter and n for its 0. This converts
        // them back.
        auto typed = number.add_key(!k.from_keypad ? key
                                    : key == 'a'   ? '\n'
                                    : key == 'n'   ? '0'
                                    : is_point     ? '.'
                                    : erases       ? '\b'
                                                   : key);
        k.command.reset();
        if (typed) {
            k.answer = detail::parse_number_text<unsigned>(*typed);
            k.text = *std::move(typed);
            return k;
        }
        echo(shown, before);
    }
}

session_key session_keys::wait_for_text(typed_text& text)
{
    for (;;) {
        session_key k = wait("the session", true);
        if (page_ != nullptr || (k.from_keypad && k.command))
            return k;
        if (k.from_keypad)
            continue;
        k.command.reset();
        const bool is_first = k.is_key && text.is_empty();
        if (is_first && k.since_ns < first_key_ns)
            continue;
        if (is_first && is_backspace(k.text)) {
            k.command = operator_key::back;
            return k;
        }
        const std::size_t before = text.text().size();
        if (k.is_key && !text.add_byte(k.text.front())) {
            echo(text.text(), before);
            continue;
        }
        k.entered = k.is_key ? text.text() : tidy_text(*k.entered);
        return k;
    }
}

} // namespace tactor::study
