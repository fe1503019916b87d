// SPDX-License-Identifier: MIT
/// \file
/// The participant's page: what it shows, and the answers that come from it.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string_view>

#include <tactor/array.hpp>

#include "net/listen.hpp"
#include "net/page_server.hpp"
#include "rt/event_fd.hpp"
#include "study/experiment/page_dialogue.hpp"
#include "study/experiment/page_words.hpp"

namespace tactor::study {

struct page_answer {
    char key = 0;           ///< what the choice stands for
    std::int64_t at_ns = 0; ///< CLOCK_MONOTONIC of when it came
};

/// The sockets are served by a thread of their own; these functions are the session's.
class participant_page {
public:
    /// `listening` is a TCP socket. Signals must be blocked already.
    participant_page(const page_words& words, const array& a, net::owned_fd listening);

    /// Whatever was asked before is not any more, and an answer that nobody took is forgotten.
    void show(page_screen s);
    /// A keypad's key: an answer as the page's own, by what a choice stands for, or by its number. Others,
    /// and what nobody sees, count nothing.
    void press(char key);
    /// Whether somebody has the page before them.
    bool is_watched();
    /// The answer to what is asked, where there is one.
    std::optional<page_answer> poll();
    /// Readable while there is an answer.
    int descriptor() const noexcept { return told_.fd(); }

private:
    void take(const page_dialogue::heard& h, std::int64_t now_ns);
    bool said(net::page_server::visitor v, std::string_view text);
    void left(net::page_server::visitor v);
    void send(const std::vector<page_dialogue::message>& all);

    std::mutex mutex_;
    page_dialogue dialogue_;
    std::optional<page_answer> answer_ = {};
    rt::event_fd told_;
    net::page_server server_; // last: its thread uses what is above
};

} // namespace tactor::study
