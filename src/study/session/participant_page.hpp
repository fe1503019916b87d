// SPDX-License-Identifier: MIT
/// \file
/// The participant's page: its screens, the messages to it and the answers that count, as a value without a
/// socket, a clock or a thread; and the server of the page.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include <tactor/array.hpp>
#include <tactor/path.hpp>

#include "net/listen.hpp"
#include "net/web.hpp"
#include "rt/event_fd.hpp"
#include "study/experiment/page_words.hpp"

namespace tactor::study {

/// Kind of answer that a participant enters in place of a choice.
enum class entry_kind {
    none,
    number,   ///< a whole number
    estimate, ///< a number above 0, sent as a text
    text,     ///< one or several lines
};

/// Length of a text that a participant enters, in characters, at most.
inline constexpr std::size_t most_text_characters = 2000;

/// Returns a text with line ends as \n, blanks for tabs, and without other control characters. Returns
/// nothing for a text that is too long or no UTF-8.
std::optional<std::string> tidy_text(std::string_view entered);

/// Place in the session.
struct page_progress {
    std::size_t run = 0; ///< from 1
    std::size_t runs = 0;
    bool practice = false;
    unsigned trial = 0; ///< from 1; 0: before the first
    std::size_t trials = 0;
};

/// Content of the participant's screen. Nothing in it says by which method a motion is rendered.
struct page_screen {
    /// Kind of screen: consent, walk, introduce, target, stimulus, question, questionnaire, right, wrong,
    /// rest, pause, wait, over.
    std::string name = "wait";
    std::string text = {};
    std::string question = {};
    std::vector<std::string> choices = {}; ///< possible answers; the page shows the number of an empty one
    std::string keys = {};                 ///< a key for each choice, or none
    bool is_line = false;                ///< the choices are places on a line, from 0 on, and have no numbers
    entry_kind entry = entry_kind::none; ///< in place of choices
    unsigned lowest = 1;                 ///< of a number that is entered
    unsigned greatest = 1;
    bool back = false;                             ///< the participant may go to the question before: key b
    std::vector<std::vector<point>> pictures = {}; ///< a motion for each choice, as the path; may be empty
    unsigned stimuli = 0;                          ///< in the trial; 0: the page does not tell them apart
    unsigned playing = 0;                          ///< the one that plays now, from 1; 0: none
    std::vector<std::string> names = {};           ///< of the stimuli; may be empty
    std::vector<point> path = {};                  ///< the target, at equal parts of its time
    double lasts_s = 0.0;                          ///< of target and rest
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

    /// `facts` are sent to each page once, when it comes.
    explicit page_dialogue(nlohmann::ordered_json facts) : facts_(std::move(facts)) {}

    /// Shows a new screen and drops the open question; `now_ns` is from the same clock as in hear().
    std::vector<message> show(page_screen s, std::int64_t now_ns);

    struct heard {
        bool understood = true; ///< else the visitor is to be sent away
        std::vector<message> replies = {};
        std::optional<char> answer = {}; ///< its key, or 0; each question has one at most
        unsigned number =
            0; ///< of the answer: its place from 1, or from 0 if they are on a line; or the one entered
        std::optional<std::string> text = {}; ///< that was entered, tidy; an estimate
    };
    /// Takes a message. A page that says {"hello":true} is the participant's from then on;
    /// {"ask":N,"answer":CHOICE or number} and {"ask":N,"text":TEXT} answer, {"ask":N,"back":true} goes back.
    heard hear(visitor from, std::string_view text, std::int64_t now_ns);

    /// Takes a key of a keypad for the page: that of a choice, or its number.
    heard press(char key, std::int64_t now_ns);

    void leave(visitor v);
    /// Returns true if a page shows the screen.
    bool is_watched() const noexcept { return theirs_.has_value(); }

private:
    std::string state(std::int64_t now_ns) const;
    /// Closes the question with a choice, from 0.
    heard take(std::size_t choice);
    /// Closes the question with the key b.
    heard go_back();

    nlohmann::ordered_json facts_;
    page_screen screen_ = {};
    std::int64_t since_ns_ = 0;
    unsigned asked_ = 0;                 ///< the number of the question that was asked last
    bool open_ = false;                  ///< and it has no answer yet
    std::optional<visitor> theirs_ = {}; ///< the page that came last
};

struct page_answer {
    char key = 0; ///< of the choice; 0: it has none
    unsigned number = 0;
    std::optional<std::string> text = {}; ///< that was entered
    std::int64_t at_ns = 0;               ///< CLOCK_MONOTONIC at its arrival
};

/// The page's server. A separate thread serves the sockets; these functions are for the session's thread.
class participant_page {
public:
    /// Serves pages on `listening`, a TCP socket. Signals must be blocked already.
    participant_page(const page_words& words, const array& a, net::owned_fd listening);

    /// Shows a screen; drops the open question, and an answer that nobody took.
    void show(page_screen s);
    /// Takes a keypad's key as an answer from the page: the key of a choice, or its number. Ignores others,
    /// and all keys while nobody sees the page.
    void press(char key);
    /// Returns true if somebody has the page open.
    bool is_watched();
    /// Returns the answer to the open question, if any.
    std::optional<page_answer> poll();
    /// Readable while there is an answer.
    int descriptor() const noexcept { return answered_.fd(); }

private:
    void take(const page_dialogue::heard& h, std::int64_t now_ns);
    bool hear(net::page_server::visitor v, std::string_view text);
    void leave(net::page_server::visitor v);
    void send(const std::vector<page_dialogue::message>& all);

    std::mutex mutex_;
    page_dialogue dialogue_;
    std::optional<page_answer> answer_ = {};
    rt::event_fd answered_;
    net::page_server server_; // last: its thread uses what is above
};

} // namespace tactor::study
