// SPDX-License-Identifier: MIT
/// \file
/// The participant's page: its screens, and the answers from it.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string_view>

#include <tactor/array.hpp>

#include "net/listen.hpp"
#include "net/web.hpp"
#include "rt/event_fd.hpp"
#include "study/experiment/definition.hpp"
#include "study/experiment/page_dialogue.hpp"

namespace tactor::study {

struct page_answer {
    char key = 0;           ///< of the choice
    std::int64_t at_ns = 0; ///< CLOCK_MONOTONIC at its arrival
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
