// SPDX-License-Identifier: MIT
// Sessions with a person: their steps, the participant's page, and the keys of input devices (for a device
// itself see tests/vm/guest/test_keypad.py).
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
#include "study/data/dataset.hpp"
#include "study/experiment/trials.hpp"
#include "study/random/random.hpp"
#include "study/session/key_input.hpp"
#include "study/session/participant_page.hpp"

namespace tactor::study::test_session_flow {
namespace {

using json = nlohmann::ordered_json;

flow_run make_flow_run(unsigned trials, unsigned practice = 0, bool rest = false)
{
    return {practice, 0, run_queue(std::vector<planned_trial>(trials)), rest};
}

// Plans n trials of three tracks by turns.
std::vector<planned_trial> make_tracks(unsigned n)
{
    std::vector<planned_trial> all(n);
    for (unsigned i = 0; i < n; ++i)
        all[i].track = i % 3 + 1;
    return all;
}

session_step trial_step(std::size_t run, unsigned trial, unsigned attempt = 1)
{
    return {.what = step_kind::trial, .run = run, .which = {trial, attempt}};
}

// Returns a session past consent, walk and introduction.
session_flow begun(std::vector<flow_run> runs)
{
    session_flow f(std::move(runs), false, 0);
    f.go_on();
    return f;
}

TEST_CASE("consent, then each tactor, then the question, practice, trials, a break, the next run")
{
    session_flow f({make_flow_run(1, 1, true), make_flow_run(1, 0, true)}, true, 2);
    CHECK(f.next().what == step_kind::consent);
    f.agree();
    CHECK(f.next() == session_step{.what = step_kind::walk, .tactor = 0});
    f.felt();
    CHECK(f.next().tactor == 1);
    f.walk_back();
    f.walk_back();
    CHECK(f.next().tactor == 0);
    f.felt();
    f.felt();
    CHECK(f.next() == session_step{.what = step_kind::introduce, .run = 0});
    f.go_on();
    CHECK(f.next() == session_step{.what = step_kind::trial, .run = 0, .practice = true, .which = {1, 1}});
    f.took(false);
    CHECK(f.next() == trial_step(0, 1));
    f.took(false);
    CHECK(f.next() == session_step{.what = step_kind::rest, .run = 0});
    f.go_on();
    CHECK(f.next() == session_step{.what = step_kind::introduce, .run = 1});
    f.go_on();
    CHECK(f.next() == trial_step(1, 1));
    f.took(false);
    CHECK(f.next().what == step_kind::over); // no break after the last
}

TEST_CASE("a void trial comes again at the end of its run, its attempt counted up")
{
    session_flow f = begun({make_flow_run(2)});
    f.took(true);
    CHECK(f.next() == trial_step(0, 2));
    f.took(false);
    CHECK(f.next() == trial_step(0, 1, 2));
    f.took(true);
    CHECK(f.next() == trial_step(0, 1, 3));
    f.took(false);
    CHECK(f.next().what == step_kind::over);
}

TEST_CASE("void trials of practice do not come again")
{
    session_flow f = begun({make_flow_run(1, 1)});
    f.took(true);
    CHECK(f.next() == trial_step(0, 1));
}

TEST_CASE("questionnaires come before the first run, between runs before the break, and after the last")
{
    using enum questionnaire_time;
    const auto ask = [](std::size_t form, std::size_t run = 0) {
        return session_step{.what = step_kind::ask, .run = run, .form = form};
    };
    session_flow f({make_flow_run(1, 0, true), make_flow_run(1)}, false, 1,
                   {{0, after}, {1, between}, {2, before, 0, 1, 1}, {3, before}});
    f.felt();
    CHECK(f.next() == ask(3)); // 2 was answered in an earlier session
    f.pause();
    CHECK(f.next().what == step_kind::pause);
    f.go_on();
    f.answered(ask(3));
    f.go_on();
    f.took(false);
    CHECK(f.next() == ask(1));
    CHECK_FALSE(f.void_last());
    f.answered(ask(1));
    CHECK(f.next().what == step_kind::rest);
    CHECK(f.void_last()); // the run goes on
    CHECK(f.next() == trial_step(0, 1, 2));
    f.took(false);
    CHECK(f.next().what == step_kind::rest);
    f.go_on();
    f.go_on();
    f.took(false);
    CHECK(f.next() == ask(0));
    f.answered(ask(0));
    CHECK(f.next().what == step_kind::over);
    // Only questions are left: nothing is walked.
    run_queue done(std::vector<planned_trial>(1));
    done.take(false);
    CHECK(session_flow({{0, 0, done, false}}, false, 9, {{0, after}}).next() == ask(0));
}

TEST_CASE("each item of a questionnaire is a step, and one can go back until a trial was played")
{
    using enum questionnaire_time;
    const auto ask = [](std::size_t form, std::size_t item) {
        return session_step{.what = step_kind::ask, .form = form, .item = item};
    };
    session_flow f({make_flow_run(1)}, false, 0, {{0, before, 0, 3, 1}, {1, before, 0, 2}, {2, after, 0, 1}});
    CHECK(f.next() == ask(0, 1)); // the first was answered before
    CHECK(f.go_back());
    CHECK_FALSE(f.go_back());
    for (std::size_t item = 0; item < 3; ++item) {
        CHECK(f.next() == ask(0, item));
        f.answered(f.next());
    }
    f.answered(ask(1, 0));
    for (const session_step& s : {ask(1, 0), ask(0, 2), ask(0, 1)}) {
        CHECK(f.go_back());
        CHECK(f.next() == s);
    }
    f.pause();
    CHECK_FALSE(f.go_back());
    f.go_on();
    for (const session_step& s : {ask(0, 1), ask(0, 2), ask(1, 0), ask(1, 1)})
        f.answered(s);
    CHECK(f.next().what == step_kind::introduce);
    CHECK(f.go_back());
    CHECK(f.next() == ask(1, 1));
    f.answered(ask(1, 1));
    f.go_on();
    CHECK_FALSE(f.go_back()); // a trial begins
    f.took(false);
    CHECK(f.next() == ask(2, 0));
    CHECK_FALSE(f.go_back());
    f.answered(ask(2, 0));
    CHECK(f.next().what == step_kind::over);
    CHECK(f.go_back());
    CHECK(f.next() == ask(2, 0));
}

TEST_CASE("no trial is made void within a questionnaire")
{
    using enum questionnaire_time;
    session_flow f({make_flow_run(1, 0, true), make_flow_run(1)}, false, 0, {{0, between, 0, 2}});
    f.go_on();
    f.took(false);
    f.pause();
    CHECK_FALSE(f.is_asking());
    f.go_on();
    for (int item = 0; item < 2; ++item) {
        CHECK(f.is_asking());
        CHECK_FALSE(f.void_last());
        f.answered(f.next());
        f.pause();
        CHECK(f.is_asking() == (item == 0));
        CHECK(f.void_last() == (item == 1));
        f.go_on();
    }
    CHECK(f.next() == trial_step(0, 1, 2));
}

TEST_CASE("the last trial can be made void once, until the next run begins")
{
    session_flow f = begun({make_flow_run(2, 0, true), make_flow_run(1)});
    CHECK_FALSE(f.void_last()); // there is none
    f.took(false);
    CHECK(f.void_last());
    CHECK_FALSE(f.void_last());
    CHECK(f.next() == trial_step(0, 2));
    f.took(true);
    CHECK_FALSE(f.void_last()); // it is void already
    f.took(false);              // 1, attempt 2
    f.took(false);              // 2, attempt 2
    CHECK(f.next().what == step_kind::rest);
    CHECK(f.void_run() == 0);
    CHECK(f.void_last()); // in the break: the run goes on
    CHECK(f.next() == trial_step(0, 2, 3));
    f.took(false);
    f.go_on(); // the break
    CHECK(f.next() == session_step{.what = step_kind::introduce, .run = 1});
    CHECK(f.void_last());
    f.took(false);
    f.go_on();
    f.go_on();
    CHECK_FALSE(f.void_last()); // the next has begun
    f.took(false);
    CHECK(f.next().what == step_kind::over);
    CHECK(f.void_last()); // even at the very end
    CHECK(f.next() == trial_step(1, 1, 2));
}

TEST_CASE("a pause comes before the next trial, and after five that became void by themselves")
{
    session_flow f = begun({make_flow_run(9)});
    f.pause();
    CHECK(f.next().what == step_kind::pause);
    f.go_on();
    CHECK(f.next() == trial_step(0, 1));
    for (unsigned i = 0; i < most_void_in_row; ++i) {
        CHECK(f.next().what == step_kind::trial);
        f.took(true);
    }
    CHECK(f.next().what == step_kind::pause);
    f.go_on();
    f.took(true);
    CHECK(f.next().what == step_kind::trial);
}

TEST_CASE("a resumed session skips its finished part")
{
    run_queue half(std::vector<planned_trial>(2));
    half.take(true);
    run_queue done(std::vector<planned_trial>(1));
    done.take(false);
    session_flow f({{0, 0, done, true}, {2, 1, half, true}}, false, 0);
    CHECK(f.next() == session_step{.what = step_kind::introduce, .run = 1});
    f.go_on();
    CHECK(f.next() == session_step{.what = step_kind::trial, .run = 1, .practice = true, .which = {2, 1}});
    f.took(false);
    CHECK(f.next() == trial_step(1, 2));
    CHECK_FALSE(f.void_last()); // of another session
    CHECK(session_flow({{0, 0, done, true}}, true, 9).next().what == step_kind::over);
}

TEST_CASE("trials of a track that has ended are skipped, until its last answer is made void")
{
    run_queue q(make_tracks(6)); // tracks 1, 2, 3, 1, 2, 3
    q.take(true);                // track 1 comes again at the end
    q.take(false, true);         // ends track 2
    CHECK(q.next() == pending_trial{3, 1});
    q.take(false, true); // ends track 3
    CHECK(q.next() == pending_trial{4, 1});
    CHECK(q.take_back()); // track 3 goes on
    CHECK(q.next() == pending_trial{4, 1});
    q.take(false);
    CHECK(q.next() == pending_trial{6, 1});
    q.take(false);
    CHECK(q.next() == pending_trial{1, 2});
    q.take(false, true); // ends track 1
    CHECK(q.next() == pending_trial{3, 2});
    q.take(false, true);
    CHECK(q.done());
    CHECK(q.take_back());
    CHECK(q.next() == pending_trial{3, 3});
}

// A resumed session knows only the tables.
TEST_CASE("in any course of events each trial counts once, and lines alone restore the same place")
{
    random_numbers r("flow");
    for (int round = 0; round < test::rounds(300); ++round) {
        session_flow f = begun({flow_run{.trials = run_queue(make_tracks(9))}, make_flow_run(3)});
        struct line {
            pending_trial which;
            bool is_void;
        };
        std::map<std::size_t, std::vector<line>> lines;
        // Track 1 ends at its first answer, track 2 at its second; track 3 has only three trials.
        const auto ends = [](std::size_t run, const std::vector<line>& written) {
            const auto find_track = [](const line& l) { return (l.which.trial - 1) % 3 + 1; };
            return run == 0 && !written.back().is_void &&
                   std::ranges::count_if(written, [&](const line& l) {
                       return !l.is_void && find_track(l) == find_track(written.back());
                   }) == find_track(written.back());
        };
        for (session_step s = f.next(); s.what != step_kind::over; s = f.next()) {
            if (s.what != step_kind::trial) {
                f.go_on();
                continue;
            }
            const bool is_void = r.below(4) == 0;
            lines[s.run].push_back({s.which, is_void});
            f.took(is_void, ends(s.run, lines[s.run]));
            if (r.below(5) == 0 && f.void_last()) {
                REQUIRE_FALSE(lines[f.void_run()].back().is_void);
                lines[f.void_run()].back().is_void = true;
            }
        }
        for (const auto& [run, written] : lines) {
            run_queue again(run == 0 ? make_tracks(9) : std::vector<planned_trial>(3));
            std::vector<line> so_far;
            for (const line& l : written) {
                REQUIRE_FALSE(again.done());
                REQUIRE(again.next() == l.which);
                so_far.push_back(l);
                again.take(l.is_void, ends(run, so_far));
            }
            CHECK(again.done());
            CHECK(std::ranges::count(written, false, &line::is_void) == (run == 0 ? 1 + 2 + 3 : 3));
        }
    }
}

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

TEST_CASE("answers without keys have numbers: their places from 1, on a line from 0")
{
    for (const bool visual : {false, true}) {
        page_dialogue d(json::object());
        static_cast<void>(d.hear(1, hello, 0));
        const page_screen s{.name = "question", .choices = std::vector<std::string>(101), .is_line = visual};
        CHECK(only(d.show(s, 0), 1).contains("visual") == visual);
        CHECK_FALSE(d.press('1', 0).answer);
        CHECK_FALSE(d.hear(1, answer(1, 102), 0).answer);
        const auto last = d.hear(1, answer(1, 101), 0);
        CHECK(last.answer.has_value());
        CHECK(last.number == (visual ? 100U : 101U));
        static_cast<void>(d.show(s, 0));
        CHECK(d.hear(1, answer(2, 1), 0).number == (visual ? 0U : 1U));
    }
}

TEST_CASE("a number is entered within its bounds")
{
    page_dialogue d(json::object());
    static_cast<void>(d.hear(1, hello, 0));
    const page_screen s{.name = "question", .entry = entry_kind::number, .lowest = 0, .greatest = 24};
    CHECK(only(d.show(s, 0), 1)["entry"] == json{{"lowest", 0}, {"greatest", 24}});
    CHECK_FALSE(d.press('1', 0).answer); // no key is a whole number
    CHECK_FALSE(d.hear(1, answer(1, 25), 0).answer);
    const auto text = d.hear(1, R"({"ask":1,"text":"24"})", 0);
    CHECK_FALSE(text.answer);
    CHECK(only(text.replies, 1)["ask"] == 1);
    const auto least = d.hear(1, answer(1, 0), 0);
    CHECK(least.answer.has_value());
    CHECK(least.number == 0);
    CHECK_FALSE(d.hear(1, answer(1, 1), 0).answer);
    static_cast<void>(d.show(s, 0));
    CHECK(d.hear(1, answer(2, 24), 0).number == 24);
}

TEST_CASE("a text is entered up to its length, and without control characters")
{
    page_dialogue d(json::object());
    static_cast<void>(d.hear(1, hello, 0));
    const auto enter = [&d](const std::string& text) {
        static_cast<void>(d.show({.name = "question", .entry = entry_kind::text}, 0));
        unsigned ask = 0;
        for (const auto& m : d.hear(1, hello, 0).replies)
            ask = json::parse(m.text).value("ask", 0U);
        return d.hear(1, json{{"ask", ask}, {"text", text}}.dump(), 0);
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
    CHECK_FALSE(d.hear(1, answer(4, 1), 0).answer);
    CHECK(tidy_text("\xc3") == std::nullopt);
}

TEST_CASE("a page and a keypad go back where the screen says so")
{
    page_dialogue d(json::object());
    static_cast<void>(d.hear(1, hello, 0));
    page_screen s{.name = "questionnaire", .entry = entry_kind::text, .back = true};
    CHECK(only(d.show(s, 0), 1)["back"] == true);
    CHECK(d.hear(1, R"({"ask":1,"back":true})", 0).answer == 'b');
    CHECK_FALSE(d.hear(1, R"({"ask":1,"back":true})", 0).answer); // once
    static_cast<void>(d.show(s, 0));
    CHECK_FALSE(d.hear(1, R"({"ask":2,"back":false})", 0).understood);
    CHECK(d.press('b', 0).answer == 'b');
    s.back = false;
    CHECK_FALSE(only(d.show(s, 0), 1).contains("back"));
    const auto refused = d.hear(1, R"({"ask":3,"back":true})", 0);
    CHECK_FALSE(refused.answer);
    CHECK(only(refused.replies, 1)["ask"] == 3);
    CHECK_FALSE(d.press('b', 0).answer);
}

TEST_CASE("a part of a character is a beginning of a text")
{
    typed_text text;
    CHECK(text.is_empty());
    text.take('\xe9'); // of U+9000, whose other bytes are the same
    CHECK(text.text().empty());
    CHECK_FALSE(text.is_empty());
}

TEST_CASE("a text is typed up to Enter, a character at a time")
{
    const auto typed = [](const std::string& keys) {
        typed_text text;
        std::size_t taken = 0;
        while (taken < keys.size() && !text.take(keys[taken]))
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
         {"", "7", "[]", "{}", "{", R"({"answer":-1})", R"({"answer":1.5,"ask":1})", R"({"text":1})", "\xff"})
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

TEST_CASE("keys of a keyboard and of a number block answer 1 to 9, buttons of a joystick nothing")
{
    const int block[] = {KEY_KP1, KEY_KP2, KEY_KP3, KEY_KP4, KEY_KP5, KEY_KP6, KEY_KP7, KEY_KP8, KEY_KP9};
    for (int i = 0; i < 9; ++i)
        for (const int code : {KEY_1 + i, block[i]})
            CHECK(find_answer(static_cast<std::uint16_t>(code)) == static_cast<char>('1' + i));
    for (const int code : {KEY_ESC, KEY_EQUAL, BTN_0, BTN_TRIGGER})
        CHECK_FALSE(find_answer(static_cast<std::uint16_t>(code)));
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
            if (const auto n = number.take(key))
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
                                                                    {"1000000000", 1e9},
                                                                    {"0.000000001", 1e-9}})
        CHECK_MESSAGE(read_estimate(text) == number, text);
    for (const std::string& text :
         {std::string("0"), std::string("0.0"), std::string("-1"), std::string("+1"), std::string("1e5"),
          std::string("1e400"), std::string("nan"), std::string("inf"), std::string("12,5"),
          std::string("1.2.3"), std::string("."), std::string(""), std::string("1 000"),
          std::string("1000000001"), std::string("0.0000000001"), std::string(40, '1'),
          "1." + std::string(38, '0')})
        CHECK_MESSAGE(!read_estimate(text), text);
}

TEST_CASE("the page sends an estimate as it was typed")
{
    page_dialogue d(json::object());
    static_cast<void>(d.hear(1, hello, 0));
    const page_screen s{.name = "question", .entry = entry_kind::estimate};
    CHECK(only(d.show(s, 0), 1)["entry"] == json{{"lowest", 1e-9}, {"greatest", 1e9}, {"longest", 12}});
    CHECK_FALSE(d.press('1', 0).answer);
    for (const char* refused :
         {R"({"ask":1,"text":"12,5"})", R"({"ask":1,"text":"0"})", R"({"ask":1,"text":"-1"})",
          R"({"ask":1,"text":"nan"})", R"({"ask":1,"text":" 12"})", R"({"ask":1,"answer":12})"}) {
        const auto h = d.hear(1, refused, 0);
        CHECK(h.understood);
        CHECK_FALSE(h.answer);
        CHECK(only(h.replies, 1)["ask"] == 1);
    }
    const auto h = d.hear(1, R"({"ask":1,"text":"12.50"})", 0);
    CHECK(h.answer.has_value());
    CHECK(h.text == "12.50");
}

TEST_CASE("an adjustment uses signs or arrows, and most keys answer nothing")
{
    std::map<char, unsigned> of;
    for (unsigned code = 0; code <= 0xFFFF; ++code)
        if (const auto c = find_answer(static_cast<std::uint16_t>(code)))
            ++of[*c];
    std::map<char, unsigned> expected{{'+', 2}, {'-', 3}, {'>', 1}, {'<', 1},
                                      {'a', 3}, {'n', 3}, {'b', 2}, {'.', 1}};
    for (char digit = '1'; digit <= '9'; ++digit)
        expected[digit] = 2;
    CHECK(of == expected);
    CHECK(find_answer(KEY_UP) == '+');
    CHECK(find_answer(KEY_LEFT) == '<');
    CHECK(find_answer(KEY_ENTER) == 'a');
    CHECK(find_answer(KEY_0) == 'n');
    CHECK(find_answer(KEY_BACKSPACE) == 'b');
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
} // namespace tactor::study::test_session_flow
