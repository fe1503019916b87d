// SPDX-License-Identifier: MIT
#include "study/session/keypad.hpp"

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <linux/input.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <tactor/error.hpp>

namespace tactor::study {
namespace {

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
