// SPDX-License-Identifier: MIT
#include "study/experiment/page_dialogue.hpp"

#include <string>

#include <doctest/doctest.h>

#include "rounds.hpp"
#include "study/random/random.hpp"

namespace tactor::study::test_page_dialogue {
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
    const auto h = d.hear(7, hello, 8 * second_ns);
    CHECK(h.understood);
    CHECK_FALSE(h.answer);
    REQUIRE(h.replies.size() == 2);
    CHECK(json::parse(h.replies[0].text) == json{{"words", "here"}});
    CHECK(json::parse(h.replies[1].text) ==
          json{{"screen", "rest"}, {"ask", 0}, {"lasts_s", 60.0}, {"passed_s", 3.0}});
}

TEST_CASE("a page gets pictures of motions, and which stimulus plays")
{
    page_dialogue d(json::object());
    static_cast<void>(d.hear(1, hello, 0));
    page_screen s = question();
    s.pictures = {{{0.0, 0.0}, {2.0, 1.0}}, {{2.0, 0.0}, {0.0, 0.0}}};
    const json asked = only(d.show(s, 0), 1);
    CHECK(asked["pictures"] == json{{{0.0, 0.0}, {2.0, 1.0}}, {{2.0, 0.0}, {0.0, 0.0}}});
    CHECK_FALSE(asked.contains("stimuli"));
    CHECK(only(d.show({.name = "stimulus", .stimuli = 2, .playing = 1}, 0), 1) ==
          json{{"screen", "stimulus"}, {"ask", 0}, {"stimuli", 2}, {"playing", 1}});
}

TEST_CASE("a question has one answer")
{
    page_dialogue d(json::object());
    static_cast<void>(d.hear(1, hello, 0));
    CHECK(only(d.show(question(), 0), 1)["ask"] == 1);
    CHECK(d.hear(1, answer(1, 3), 0).answer == std::nullopt); // there is no third
    CHECK(d.hear(1, answer(2, 1), 0).answer == std::nullopt); // nor a second question
    CHECK(d.hear(1, answer(1, 2), 0).answer == '2');
    const auto again = d.hear(1, answer(1, 1), 0);
    CHECK_FALSE(again.answer);
    CHECK(only(again.replies, 1)["ask"] == 0);
    CHECK(only(d.show(question("yn"), 0), 1)["ask"] == 2);
    CHECK_FALSE(d.hear(1, answer(1, 1), 0).answer); // it is of the last
    CHECK(d.hear(1, answer(2, 1), 0).answer == 'y');
}

TEST_CASE("a keypad answers for the page that shows the question")
{
    page_dialogue d(json::object());
    static_cast<void>(d.show(question("ynr"), 0));
    CHECK_FALSE(d.press('1', 0).answer); // no page shows the question
    static_cast<void>(d.hear(1, hello, 0));
    CHECK_FALSE(d.press('0', 0).answer);
    CHECK_FALSE(d.press('4', 0).answer);
    const auto pressed = d.press('2', 0);
    CHECK(pressed.answer == 'n');
    CHECK(only(pressed.replies, 1)["ask"] == 0); // its buttons have no effect any more
    CHECK_FALSE(d.press('2', 0).answer);
    CHECK_FALSE(d.hear(1, answer(1, 1), 0).answer);
}

TEST_CASE("a past question takes no answer")
{
    page_dialogue d(json::object());
    static_cast<void>(d.hear(1, hello, 0));
    static_cast<void>(d.show(question(), 0));
    CHECK(only(d.show({.name = "pause"}, 0), 1)["ask"] == 0);
    CHECK_FALSE(d.hear(1, answer(1, 1), 0).answer);
}

TEST_CASE("the newest of two pages answers, and the other is notified")
{
    page_dialogue d(json::object());
    static_cast<void>(d.hear(1, hello, 0));
    static_cast<void>(d.show(question(), 0));
    const auto h = d.hear(2, hello, 0);
    REQUIRE(h.replies.size() == 3);
    CHECK(h.replies[0].to == 1);
    CHECK(h.replies[0].last);
    CHECK(json::parse(h.replies[0].text) == json{{"screen", "elsewhere"}});
    CHECK_FALSE(d.hear(1, answer(1, 1), 0).answer);
    CHECK_FALSE(d.hear(3, answer(1, 1), 0).answer); // it has not said hello
    d.leave(1);                                     // changes nothing
    CHECK(d.is_watched());
    CHECK(d.hear(2, answer(1, 1), 0).answer == '1');
    d.leave(2);
    CHECK_FALSE(d.is_watched());
    CHECK(d.show(question(), 0).empty());
    CHECK_FALSE(d.hear(2, answer(2, 1), 0).answer);
}

TEST_CASE("nonsense is refused")
{
    page_dialogue d(json::object());
    for (const char* text :
         {"", "7", "[]", "{}", "{", R"({"answer":0})", R"({"answer":1.5,"ask":1})", "\xff"})
        CHECK_FALSE_MESSAGE(d.hear(1, text, 0).understood, text);
}

TEST_CASE("words that are not UTF-8 do not break a message")
{
    page_dialogue d(json::object());
    static_cast<void>(d.hear(1, hello, 0));
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
            static_cast<void>(d.hear(who, hello, i));
            break;
        case 2:
            d.leave(who);
            break;
        default: {
            const auto ask = static_cast<unsigned>(asked + r.below(3)) - 1;
            const auto h = d.hear(who, answer(ask, static_cast<unsigned>(r.below(4))), i);
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

} // namespace
} // namespace tactor::study::test_page_dialogue
