// SPDX-License-Identifier: MIT
/// \file
/// What the participant's pages are sent, and which of their answers counts: a value, without a socket, a
/// clock or a thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include <tactor/path.hpp>

namespace tactor::study {

/// Where in the session it is.
struct page_progress {
    std::size_t run = 0; ///< from 1
    std::size_t runs = 0;
    bool practice = false;
    unsigned trial = 0; ///< from 1; 0: before the first
    std::size_t trials = 0;
};

/// What the participant sees. Nothing in it says by which method a motion is rendered.
struct page_screen {
    std::string name = "wait"; ///< of consent, walk, introduce, target, stimulus, question, rest, pause, over
    std::string text = {};
    std::string question = {};
    std::vector<std::string> choices = {}; ///< what can be answered; may be without words: their numbers are
                                           ///< shown
    std::string keys = {};                 ///< for each choice what it stands for
    std::vector<point> path = {};          ///< the target, at equal parts of its time
    double lasts_s = 0.0;                  ///< of target and rest
    std::optional<page_progress> where = {};
};

class page_dialogue {
public:
    using visitor = unsigned;

    struct message {
        visitor to = 0;
        std::string text = {};
        bool last = false; ///< the connection ends behind it
    };

    /// `facts` are what a page is told once, when it comes.
    explicit page_dialogue(nlohmann::ordered_json facts) : facts_(std::move(facts)) {}

    /// A new screen; `now_ns` is of the clock that hear() has, too. What was asked before is not any more.
    std::vector<message> show(page_screen s, std::int64_t now_ns);

    struct heard {
        bool understood = true; ///< else the visitor is to be sent away
        std::vector<message> replies = {};
        std::optional<char> answer = {}; ///< the key of what was asked; each question has one at most
    };
    /// A page says {"hello":true}, and is the participant's from then on; or {"ask":N,"answer":CHOICE}.
    heard hear(visitor from, std::string_view text, std::int64_t now_ns);

    /// A key of a keypad, for who looks at the page: what a choice stands for, or its number.
    heard press(char key, std::int64_t now_ns);

    void leave(visitor v);
    /// Whether there is a page that shows what is shown.
    bool is_watched() const noexcept { return theirs_.has_value(); }

private:
    std::string state(std::int64_t now_ns) const;

    nlohmann::ordered_json facts_;
    page_screen screen_ = {};
    std::int64_t since_ns_ = 0;
    unsigned asked_ = 0;                 ///< the number of the question that was asked last
    bool open_ = false;                  ///< and it has no answer yet
    std::optional<visitor> theirs_ = {}; ///< the page that came last
};

} // namespace tactor::study
