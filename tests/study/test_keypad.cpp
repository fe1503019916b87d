// SPDX-License-Identifier: MIT
// Answers of an input device's keys. For a device itself see tests/vm/guest/test_keypad.py.
#include "study/session/key_input.hpp"

#include <map>

#include <doctest/doctest.h>
#include <linux/input-event-codes.h>

#include <tactor/error.hpp>

namespace keypad_test {

using namespace tactor;
using study::find_answer;

TEST_CASE("keys of a keyboard, a number block, a button box and a joystick answer 1 to 9")
{
    const int block[] = {KEY_KP1, KEY_KP2, KEY_KP3, KEY_KP4, KEY_KP5, KEY_KP6, KEY_KP7, KEY_KP8, KEY_KP9};
    for (int i = 0; i < 9; ++i)
        for (const int code : {KEY_1 + i, block[i], BTN_0 + i, BTN_TRIGGER + i})
            CHECK(study::find_answer(static_cast<std::uint16_t>(code)) == static_cast<char>('1' + i));
}

TEST_CASE("a key of a terminal counts after 100 ms without it, so one that is held down does not")
{
    study::repeat_guard keys;
    const auto repeated = [&](char key, std::int64_t at_ms, bool again = false) {
        return keys.is_repeated(key, at_ms * 1000000, again);
    };
    CHECK_FALSE(repeated('1', 1000));
    for (std::int64_t at_ms = 1033; at_ms < 2000; at_ms += 33)
        CHECK(repeated('1', at_ms));
    CHECK_FALSE(repeated('2', 2000)); // another key is pressed, not repeated
    CHECK_FALSE(repeated('1', 2001));
    CHECK(repeated('1', 2100));
    CHECK_FALSE(repeated('1', 2200));
    CHECK(repeated('1', 2400, true)); // read together: nobody knows when each came
    CHECK(repeated('1', 2400));
}

TEST_CASE("an adjustment uses signs or arrows, and most keys answer nothing")
{
    std::map<char, unsigned> of;
    for (unsigned code = 0; code <= 0xFFFF; ++code)
        if (const auto c = study::find_answer(static_cast<std::uint16_t>(code)))
            ++of[*c];
    CHECK(of == std::map<char, unsigned>{{'+', 2},
                                         {'-', 3},
                                         {'>', 1},
                                         {'<', 1},
                                         {'a', 3},
                                         {'n', 3},
                                         {'1', 4},
                                         {'2', 4},
                                         {'3', 4},
                                         {'4', 4},
                                         {'5', 4},
                                         {'6', 4},
                                         {'7', 4},
                                         {'8', 4},
                                         {'9', 4}});
    CHECK(study::find_answer(KEY_UP) == '+');
    CHECK(study::find_answer(KEY_LEFT) == '<');
    CHECK(study::find_answer(KEY_ENTER) == 'a');
    CHECK(study::find_answer(KEY_0) == 'n');
}

TEST_CASE("missing keypads and other files are refused")
{
    const auto kind = [](const char* device) {
        try {
            const study::keypad k(device);
        } catch (const error& e) {
            return e.kind();
        }
        return error_kind::runtime;
    };
    CHECK(kind("/dev/input/by-id/nobody-event-kbd") == error_kind::not_available);
    CHECK(kind("/dev/null") == error_kind::bad_input);
    CHECK(kind("/etc/passwd") == error_kind::bad_input);
}

} // namespace keypad_test
