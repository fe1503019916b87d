// SPDX-License-Identifier: MIT
/// \file
/// The participant's page. page_dialogue handles the page's screens, messages and answers; it uses no socket,
/// clock or thread. participant_page is the page's server.
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
#include "study/data/drawing.hpp"
#include "study/data/page_words.hpp"

namespace tactor::study {

/// Kind of answer that a participant types instead of choosing.
enum class entry_kind {
    none,
    number,   ///< a whole number
    estimate, ///< a number above 0, sent as a text
    text,     ///< one or several lines
};

/// Greatest length of a text that a participant enters, in characters.
inline constexpr std::size_t most_text_characters = 2000;

/// Returns a text without control characters: keeps \n, replaces each tab by a blank, and removes the others.
/// Returns nothing if the text is not UTF-8 or has more than most_text_characters.
std::optional<std::string> tidy_text(std::string_view entered);

/// Progress of the session.
struct page_progress {
    std::size_t run = 0; ///< number of the run, from 1
    std::size_t runs = 0;
    bool practice = false;
    unsigned trial = 0; ///< number of the trial, from 1; 0 before the first trial
    std::size_t trials = 0;
    bool may_end_early = false; ///< true if the run may end before its last trial
};

/// Content of the participant's screen. It does not reveal the method that renders a motion.
struct page_screen {
    /// Kind of screen: consent, walk, introduce, target, stimulus, question, questionnaire, right, wrong,
    /// rest, pause, wait, over.
    std::string name = "wait";
    std::string text = {};
    std::string question = {};
    std::vector<std::string> choices = {}; ///< possible answers; the page shows a number for an empty label
    std::string keys = {};                 ///< a key for each choice; may be empty
    bool is_line = false;     ///< true if the choices are places on a line without numbers, counted from 0
    bool are_stimuli = false; ///< true if the choices are the stimuli of the trial, in their order
    entry_kind entry = entry_kind::none;     ///< kind of typed answer, in place of choices
    drawing_kind draws = drawing_kind::none; ///< kind of drawing, in place of choices
    unsigned lowest = 1;                     ///< smallest number that may be entered
    unsigned greatest = 1;
    bool back = false; ///< true if key b goes to the previous question
    /// For each choice, the paths of a motion's strokes, sampled at equal time steps. May be empty.
    std::vector<std::vector<std::vector<point>>> pictures = {};
    unsigned stimuli = 0;                ///< number of stimuli that the page shows one by one, or 0
    unsigned playing = 0;                ///< stimulus that plays now, from 1; 0 if none
    std::vector<std::string> names = {}; ///< names of the stimuli; may be empty
    /// Positions of each stroke of the target, sampled at equal time steps. A position is missing while the
    /// stroke does not play.
    std::vector<std::vector<std::optional<point>>> paths = {};
    double lasts_s = 0.0; ///< duration of the target or the break
    std::optional<page_progress> where = {};
};

class page_dialogue {
public:
    using visitor = unsigned;

    struct message {
        visitor to = 0;
        std::string text = {};
        bool last = false; ///< true if the connection ends after this message
    };

    /// Keeps `facts`. Each page receives these facts once, in the reply to its hello message.
    explicit page_dialogue(nlohmann::ordered_json facts) : facts_(std::move(facts)) {}

    /// Shows a new screen and drops the open question. Returns the messages to send. `now_ns` is from the
    /// same clock as in receive_message().
    std::vector<message> show(page_screen s, std::int64_t now_ns);

    struct heard {
        bool understood = true; ///< false if the visitor must be disconnected
        std::vector<message> replies = {};
        std::optional<char> answer = {}; ///< key of the answer, or 0 if the answer has no key
        unsigned number = 0; ///< entered number, or number of the choice, from 1 (on a line from 0)
        /// Entered text after tidy_text(), estimate as it was typed, or drawing as to_text() writes it.
        std::optional<std::string> text = {};
    };
    /// Takes a message. {"hello":true} makes the sender the participant's page. {"ask":N,"answer":CHOICE or
    /// number}, {"ask":N,"text":TEXT} and {"ask":N,"drawing":[[TIME,X,Y],...]} answer question N.
    /// {"ask":N,"back":true} goes back to the previous question.
    heard receive_message(visitor from, std::string_view text, std::int64_t now_ns);

    /// Takes a keypad's key (the key or the number of a choice) in place of an answer from the page.
    heard press(char key, std::int64_t now_ns);

    void leave(visitor v);
    /// Returns true if a page shows the screen.
    bool is_watched() const noexcept { return theirs_.has_value(); }

private:
    std::string state(std::int64_t now_ns) const;
    /// Closes the question with a choice. `choice`: index from 0.
    heard close_with_choice(std::size_t choice);
    /// Closes the question with the key b.
    heard go_back();

    nlohmann::ordered_json facts_;
    page_screen screen_ = {};
    std::int64_t since_ns_ = 0;
    unsigned asked_ = 0;                 ///< number of the last question
    bool open_ = false;                  ///< true if the last question has no answer yet
    std::optional<visitor> theirs_ = {}; ///< page that said hello last
};

struct page_answer {
    char key = 0; ///< key of the choice; 0 if the choice has no key
    unsigned number = 0;
    std::optional<std::string> text = {}; ///< text that was entered
    std::int64_t at_ns = 0;               ///< CLOCK_MONOTONIC when the answer arrived
};

/// The server of the participant's page. A separate thread serves the sockets. The functions of this class
/// are for the session's thread.
class participant_page {
public:
    /// Serves pages on `listening`, a TCP socket. Signals must be blocked already.
    participant_page(const page_words& words, const array& a, net::owned_fd listening);

    /// Shows a screen. Drops the open question, and an answer that poll() has not yet returned.
    void show(page_screen s);
    /// Takes a keypad's key (the key or the number of a choice) as if it were an answer from the page.
    /// Ignores other keys, and all keys while no page is open.
    void press(char key);
    /// Returns true if somebody has the page open.
    bool is_watched();
    /// Returns the answer to the open question, if there is one. Returns each answer only once. Does not
    /// block.
    std::optional<page_answer> poll();
    /// Returns a descriptor that is readable while poll() has an answer.
    int descriptor() const noexcept { return answered_.fd(); }

private:
    void send_and_store(const page_dialogue::heard& h, std::int64_t now_ns);
    bool receive_message(net::page_server::visitor v, std::string_view text);
    void leave(net::page_server::visitor v);
    void send(const std::vector<page_dialogue::message>& all);

    std::mutex mutex_;
    page_dialogue dialogue_;
    std::optional<page_answer> answer_ = {};
    rt::event_fd answered_;
    net::page_server server_; // last, because its thread uses the members above
};

} // namespace tactor::study
