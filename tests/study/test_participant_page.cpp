// SPDX-License-Identifier: MIT
// The participant's page, and the keys of terminals and input devices (for a device itself see
// tests/vm/guest/test_keypad.py).
#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <linux/input-event-codes.h>

#include <tactor/error.hpp>

#include "rounds.hpp"
#include "study/data/trial.hpp"
#include "study/random/random.hpp"
#include "study/session/key_input.hpp"
#include "study/session/participant_page.hpp"

namespace tactor::study::test_participant_page {
namespace {

using json = nlohmann::ordered_json;

constexpr std::int64_t second_ns = 1'000'000'000;
constexpr const char* hello = R"({"hello":true})";

page_screen question(const std::string& keys = "12")
{
    return {.name = "question",
            .question = "Which?",
            .choices = std::vector<std::string>(keys.size()),
            .keys = keys};
}

std::string answer(unsigned ask, unsigned choice)
{
    return json{{"ask", ask}, {"answer", choice}}.dump();
}

// Returns the only message.
json only(const std::vector<page_dialogue::message>& all, page_dialogue::visitor to)
{
    REQUIRE(all.size() == 1);
    CHECK(all.front().to == to);
    return json::parse(all.front().text);
}

TEST_CASE("a new page gets the facts and the present state")
{
    page_dialogue d(json{{"words", "here"}});
    CHECK(d.show({.name = "rest", .lasts_s = 60.0}, 5 * second_ns).empty()); // without a page
    const auto h = d.receive_message(7, hello, 8 * second_ns);
    CHECK(h.understood);
    CHECK_FALSE(h.answer);
    REQUIRE(h.replies.size() == 2);
    CHECK(json::parse(h.replies[0].text) == json{{"words", "here"}});
    CHECK(json::parse(h.replies[1].text) ==
          json{{"screen", "rest"}, {"ask", 0}, {"lasts_s", 60.0}, {"passed_s", 3.0}});
}

TEST_CASE("a page is told if a run may have fewer trials")
{
    page_dialogue d(json::object());
    static_cast<void>(d.receive_message(1, hello, 0));
    page_screen s = question();
    s.where = {.run = 1, .runs = 2, .trial = 3, .trials = 60};
    CHECK_FALSE(only(d.show(s, 0), 1)["progress"].contains("at_most"));
    s.where->may_end_early = true;
    CHECK(only(d.show(s, 0), 1)["progress"]["at_most"] == true);
}

TEST_CASE("a page gets pictures of motions, and which stimulus plays")
{
    page_dialogue d(json::object());
    static_cast<void>(d.receive_message(1, hello, 0));
    page_screen s = question();
    s.pictures = {{{{0.0, 0.0}, {2.0, 1.0}}}, {{{2.0, 0.0}, {0.0, 0.0}}, {{1.0, 0.0}}}};
    const json asked = only(d.show(s, 0), 1);
    CHECK(asked["pictures"] == json::parse("[[[[0, 0], [2, 1]]], [[[2, 0], [0, 0]], [[1, 0]]]]"));
    CHECK(only(d.show({.name = "target", .paths = {{point{3.0, 4.0}, {}}}}, 0), 1)["paths"] ==
          json::parse("[[[3, 4], null]]"));
    CHECK_FALSE(asked.contains("stimuli"));
    CHECK(only(d.show({.name = "stimulus", .stimuli = 2, .playing = 1}, 0), 1) ==
          json{{"screen", "stimulus"}, {"ask", 0}, {"stimuli", 2}, {"playing", 1}});
    CHECK(only(d.show({.name = "stimulus", .stimuli = 2, .names = {"left", "right"}}, 0), 1)["names"] ==
          json{"left", "right"});
}

TEST_CASE("a question has one answer")
{
    page_dialogue d(json::object());
    static_cast<void>(d.receive_message(1, hello, 0));
    CHECK(only(d.show(question(), 0), 1)["ask"] == 1);
    CHECK(d.receive_message(1, answer(1, 3), 0).answer == std::nullopt); // there is no third
    CHECK(d.receive_message(1, answer(2, 1), 0).answer == std::nullopt); // nor a second question
    CHECK(d.receive_message(1, answer(1, 2), 0).answer == '2');
    const auto again = d.receive_message(1, answer(1, 1), 0);
    CHECK_FALSE(again.answer);
    CHECK(only(again.replies, 1)["ask"] == 0);
    CHECK(only(d.show(question("yn"), 0), 1)["ask"] == 2);
    CHECK_FALSE(d.receive_message(1, answer(1, 1), 0).answer); // it is of the last
    CHECK(d.receive_message(1, answer(2, 1), 0).answer == 'y');
}

TEST_CASE("a keypad answers for the page that shows the question")
{
    page_dialogue d(json::object());
    static_cast<void>(d.show(question("ynr"), 0));
    CHECK_FALSE(d.press('1', 0).answer); // no page shows the question
    static_cast<void>(d.receive_message(1, hello, 0));
    CHECK_FALSE(d.press('0', 0).answer);
    CHECK_FALSE(d.press('4', 0).answer);
    const auto pressed = d.press('2', 0);
    CHECK(pressed.answer == 'n');
    CHECK(only(pressed.replies, 1)["ask"] == 0); // its buttons have no effect any more
    CHECK_FALSE(d.press('2', 0).answer);
    CHECK_FALSE(d.receive_message(1, answer(1, 1), 0).answer);
}

TEST_CASE("answers without keys have numbers: their places from 1, on a line from 0")
{
    for (const bool visual : {false, true}) {
        page_dialogue d(json::object());
        static_cast<void>(d.receive_message(1, hello, 0));
        const page_screen s{.name = "question", .choices = std::vector<std::string>(101), .is_line = visual};
        CHECK(only(d.show(s, 0), 1).contains("visual") == visual);
        CHECK_FALSE(d.press('1', 0).answer);
        CHECK_FALSE(d.receive_message(1, answer(1, 102), 0).answer);
        const auto last = d.receive_message(1, answer(1, 101), 0);
        CHECK(last.answer.has_value());
        CHECK(last.number == (visual ? 100U : 101U));
        static_cast<void>(d.show(s, 0));
        CHECK(d.receive_message(1, answer(2, 1), 0).number == (visual ? 0U : 1U));
    }
}

TEST_CASE("a number is entered within its bounds")
{
    page_dialogue d(json::object());
    static_cast<void>(d.receive_message(1, hello, 0));
    const page_screen s{.name = "question", .entry = entry_kind::number, .lowest = 0, .greatest = 24};
    CHECK(only(d.show(s, 0), 1)["entry"] == json{{"lowest", 0}, {"greatest", 24}});
    CHECK_FALSE(d.press('1', 0).answer); // no key is a whole number
    CHECK_FALSE(d.receive_message(1, answer(1, 25), 0).answer);
    const auto text = d.receive_message(1, R"({"ask":1,"text":"24"})", 0);
    CHECK_FALSE(text.answer);
    CHECK(only(text.replies, 1)["ask"] == 1);
    const auto least = d.receive_message(1, answer(1, 0), 0);
    CHECK(least.answer.has_value());
    CHECK(least.number == 0);
    CHECK_FALSE(d.receive_message(1, answer(1, 1), 0).answer);
    static_cast<void>(d.show(s, 0));
    CHECK(d.receive_message(1, answer(2, 24), 0).number == 24);
}

TEST_CASE("a text is entered up to its length, and without control characters")
{
    page_dialogue d(json::object());
    static_cast<void>(d.receive_message(1, hello, 0));
    const auto enter = [&d](const std::string& text) {
        static_cast<void>(d.show({.name = "question", .entry = entry_kind::text}, 0));
        unsigned ask = 0;
        for (const auto& m : d.receive_message(1, hello, 0).replies)
            ask = json::parse(m.text).value("ask", 0U);
        return d.receive_message(1, json{{"ask", ask}, {"text", text}}.dump(), 0);
    };
    CHECK(enter("").text == "");
    CHECK(enter("na\u00efve\r\nor\t\x07not\x7f").text == "na\u00efve\nor not");
    std::string longest;
    for (std::size_t i = 0; i < most_text_characters; ++i)
        longest += "\u00e9";
    CHECK(enter(longest).text == longest);
    const auto refused = enter(longest + "e");
    CHECK_FALSE(refused.answer);
    CHECK(only(refused.replies, 1)["ask"] != 0);
    CHECK_FALSE(d.receive_message(1, answer(4, 1), 0).answer);
    CHECK(tidy_text("\xc3") == std::nullopt);
}

TEST_CASE("a page and a keypad go back where the screen says so")
{
    page_dialogue d(json::object());
    static_cast<void>(d.receive_message(1, hello, 0));
    page_screen s{.name = "questionnaire", .entry = entry_kind::text, .back = true};
    CHECK(only(d.show(s, 0), 1)["back"] == true);
    CHECK(d.receive_message(1, R"({"ask":1,"back":true})", 0).answer == 'b');
    CHECK_FALSE(d.receive_message(1, R"({"ask":1,"back":true})", 0).answer); // once
    static_cast<void>(d.show(s, 0));
    CHECK_FALSE(d.receive_message(1, R"({"ask":2,"back":false})", 0).understood);
    CHECK(d.press('b', 0).answer == 'b');
    s.back = false;
    CHECK_FALSE(only(d.show(s, 0), 1).contains("back"));
    const auto refused = d.receive_message(1, R"({"ask":3,"back":true})", 0);
    CHECK_FALSE(refused.answer);
    CHECK(only(refused.replies, 1)["ask"] == 3);
    CHECK_FALSE(d.press('b', 0).answer);
}

TEST_CASE("a part of a character is a beginning of a text")
{
    typed_text text;
    CHECK(text.is_empty());
    text.add_byte('\xe9'); // of U+9000, whose other bytes are the same
    CHECK(text.text().empty());
    CHECK_FALSE(text.is_empty());
}

TEST_CASE("a text is typed up to Enter, a character at a time")
{
    const auto typed = [](const std::string& keys) {
        typed_text text;
        std::size_t taken = 0;
        while (taken < keys.size() && !text.add_byte(keys[taken]))
            ++taken;
        CHECK_MESSAGE(taken + 1 == keys.size(), keys);
        return text.text();
    };
    CHECK(typed("\n") == "");
    CHECK(typed("quiet, then p\r") == "quiet, then p");
    CHECK(typed("a\u00e9\x7f\xe2\x82\xac\b\b\bb\n") == "b");
    CHECK(typed("a\x1b[Ab\x1b[3~c\x1bOPd\x07\n") == "abcd");
    CHECK(typed("\x1b"
                "2024\n") == "2024");
    CHECK(typed("a\xff"
                "b\n") == "ab");
    CHECK(typed(std::string(most_text_characters, 'a') + "a\n").size() == most_text_characters);
}

TEST_CASE("a past question takes no answer")
{
    page_dialogue d(json::object());
    static_cast<void>(d.receive_message(1, hello, 0));
    static_cast<void>(d.show(question(), 0));
    CHECK(only(d.show({.name = "pause"}, 0), 1)["ask"] == 0);
    CHECK_FALSE(d.receive_message(1, answer(1, 1), 0).answer);
}

TEST_CASE("the newest of two pages answers, and the other is notified")
{
    page_dialogue d(json::object());
    static_cast<void>(d.receive_message(1, hello, 0));
    static_cast<void>(d.show(question(), 0));
    const auto h = d.receive_message(2, hello, 0);
    REQUIRE(h.replies.size() == 3);
    CHECK(h.replies[0].to == 1);
    CHECK(h.replies[0].last);
    CHECK(json::parse(h.replies[0].text) == json{{"screen", "elsewhere"}});
    CHECK_FALSE(d.receive_message(1, answer(1, 1), 0).answer);
    CHECK_FALSE(d.receive_message(3, answer(1, 1), 0).answer); // it has not said hello
    d.leave(1);                                                // changes nothing
    CHECK(d.is_watched());
    CHECK(d.receive_message(2, answer(1, 1), 0).answer == '1');
    d.leave(2);
    CHECK_FALSE(d.is_watched());
    CHECK(d.show(question(), 0).empty());
    CHECK_FALSE(d.receive_message(2, answer(2, 1), 0).answer);
}

TEST_CASE("nonsense is refused")
{
    page_dialogue d(json::object());
    for (const char* text :
         {"", "7", "[]", "{}", "{", R"({"answer":-1})", R"({"answer":1.5,"ask":1})", R"({"text":1})", "\xff"})
        CHECK_FALSE_MESSAGE(d.receive_message(1, text, 0).understood, text);
}

TEST_CASE("words that are not UTF-8 do not break a message")
{
    page_dialogue d(json::object());
    static_cast<void>(d.receive_message(1, hello, 0));
    CHECK(only(d.show({.name = "consent", .text = "\xff"}, 0), 1)["text"] == "\xEF\xBF\xBD");
}

// Pages that come, go, and send any message, at any time.
TEST_CASE("each question is answered at most once, and only as it was asked")
{
    random_numbers r("pages");
    page_dialogue d(json::object());
    unsigned asked = 0;
    bool open = false;
    for (int i = 0; i < test::rounds(20000); ++i) {
        const auto who = static_cast<page_dialogue::visitor>(r.below(3));
        switch (r.below(6)) {
        case 0:
            static_cast<void>(d.show(question(), i));
            ++asked;
            open = true;
            break;
        case 1:
            static_cast<void>(d.receive_message(who, hello, i));
            break;
        case 2:
            d.leave(who);
            break;
        default: {
            const auto ask = static_cast<unsigned>(asked + r.below(3)) - 1;
            const auto h = d.receive_message(who, answer(ask, static_cast<unsigned>(r.below(4))), i);
            if (h.answer) {
                REQUIRE(open);
                REQUIRE(ask == asked);
                open = false;
            }
        }
        }
    }
    CHECK(asked > 0);
}

TEST_CASE("keys of a keyboard and of a number block answer 1 to 9, buttons of a joystick nothing")
{
    const int block[] = {KEY_KP1, KEY_KP2, KEY_KP3, KEY_KP4, KEY_KP5, KEY_KP6, KEY_KP7, KEY_KP8, KEY_KP9};
    for (int i = 0; i < 9; ++i)
        for (const int code : {KEY_1 + i, block[i]})
            CHECK(find_key_character(static_cast<std::uint16_t>(code)) == static_cast<char>('1' + i));
    for (const int code : {KEY_ESC, KEY_EQUAL, BTN_0, BTN_TRIGGER})
        CHECK_FALSE(find_key_character(static_cast<std::uint16_t>(code)));
}

TEST_CASE("a key of a terminal counts after 100 ms without it, so one that is held down does not")
{
    repeat_guard keys;
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
    CHECK(keys.since_ns('1', 2500 * 1000000LL) == 100 * 1000000LL);
    CHECK(keys.since_ns('2', 2500 * 1000000LL) == std::numeric_limits<std::int64_t>::max());
}

TEST_CASE("a number is typed up to Enter, and a keypad has 0 and Enter, too")
{
    const auto typed = [](const std::string& keys) {
        typed_number number;
        std::vector<std::string> all;
        for (const char key : keys)
            if (const auto n = number.add_key(key))
                all.push_back(*n);
        CHECK_MESSAGE(number.text().empty(), keys);
        return all;
    };
    using texts = std::vector<std::string>;
    CHECK(typed("57\n0\n100\r11\n") == texts{"57", "0", "100", "11"});
    CHECK(typed("57\b5\n\x7f"
                "8\x7f\n9\n") == texts{"55", "9"});
    CHECK(typed("1na0\n\n") == texts{"10"});
    CHECK(typed("1234\n x-3\n1.5\n12,5\n1e400\n") == texts{"1234", "-3", "1.5", "12,5", "1e400"});
    CHECK(typed(std::string(40, '1') + "\n").at(0).size() > most_estimate_characters);
}

TEST_CASE("an estimate is a number above 0 as people type it")
{
    for (const auto& [text, number] : std::map<std::string, double>{{"0.5", 0.5},
                                                                    {"12.5", 12.5},
                                                                    {".25", 0.25},
                                                                    {"7.", 7.0},
                                                                    {"007", 7.0},
                                                                    {"1500", 1500.0},
                                                                    {"999999999999", 999999999999.0},
                                                                    {"0.0000000001", 1e-10}})
        CHECK_MESSAGE(read_estimate(text) == number, text);
    for (const std::string& text :
         {std::string("0"), std::string("0.0"), std::string("-1"), std::string("+1"), std::string("1e5"),
          std::string("1e400"), std::string("nan"), std::string("inf"), std::string("12,5"),
          std::string("1.2.3"), std::string("."), std::string(""), std::string("1 000"),
          std::string("1000000000001"), std::string("0.00000000001"), std::string(40, '1'),
          "1." + std::string(38, '0')})
        CHECK_MESSAGE(!read_estimate(text), text);
}

TEST_CASE("the page sends an estimate as it was typed")
{
    page_dialogue d(json::object());
    static_cast<void>(d.receive_message(1, hello, 0));
    const page_screen s{.name = "question", .entry = entry_kind::estimate};
    CHECK(only(d.show(s, 0), 1)["entry"] == json{{"lowest", 1e-11}, {"greatest", 1e12}, {"longest", 12}});
    CHECK_FALSE(d.press('1', 0).answer);
    for (const char* refused :
         {R"({"ask":1,"text":"12,5"})", R"({"ask":1,"text":"0"})", R"({"ask":1,"text":"-1"})",
          R"({"ask":1,"text":"nan"})", R"({"ask":1,"text":" 12"})", R"({"ask":1,"answer":12})"}) {
        const auto h = d.receive_message(1, refused, 0);
        CHECK(h.understood);
        CHECK_FALSE(h.answer);
        CHECK(only(h.replies, 1)["ask"] == 1);
    }
    const auto h = d.receive_message(1, R"({"ask":1,"text":"12.50"})", 0);
    CHECK(h.answer.has_value());
    CHECK(h.text == "12.50");
}

TEST_CASE("an adjustment uses signs or arrows, and most keys answer nothing")
{
    std::map<char, unsigned> of;
    for (unsigned code = 0; code <= 0xFFFF; ++code)
        if (const auto c = find_key_character(static_cast<std::uint16_t>(code)))
            ++of[*c];
    std::map<char, unsigned> expected{{'+', 2}, {'-', 3}, {'>', 1}, {'<', 1},
                                      {'a', 3}, {'n', 3}, {'b', 2}, {'.', 1}};
    for (char digit = '1'; digit <= '9'; ++digit)
        expected[digit] = 2;
    CHECK(of == expected);
    CHECK(find_key_character(KEY_UP) == '+');
    CHECK(find_key_character(KEY_LEFT) == '<');
    CHECK(find_key_character(KEY_ENTER) == 'a');
    CHECK(find_key_character(KEY_0) == 'n');
    CHECK(find_key_character(KEY_BACKSPACE) == 'b');
}

TEST_CASE("missing keypads and other files are refused")
{
    const auto kind = [](const char* device) {
        try {
            const keypad k(device);
        } catch (const error& e) {
            return e.kind();
        }
        return error_kind::runtime;
    };
    CHECK(kind("/dev/input/by-id/nobody-event-kbd") == error_kind::not_available);
    CHECK(kind("/dev/null") == error_kind::bad_input);
    CHECK(kind("/etc/passwd") == error_kind::bad_input);
}

} // namespace
} // namespace tactor::study::test_participant_page
