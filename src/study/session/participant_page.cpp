// SPDX-License-Identifier: MIT
#include "study/session/participant_page.hpp"

#include <utility>

#include "rt/clock.hpp"

namespace tactor::study {
namespace {

// page/participant.html with its styles and modules, as one document.
constexpr net::page_document document =
#include "study/participant_page.inc"
    ;

// Returns what a page needs to draw and to speak, without title and methods, which would give them away.
nlohmann::ordered_json make_facts(const page_words& texts, const array& a)
{
    nlohmann::ordered_json words;
    for (const page_word& w : page_words_in_english())
        words[std::string(w.key)] = texts[w.key];
    nlohmann::ordered_json tactors = nlohmann::ordered_json::array();
    for (const tactor_spec& t : a.tactors)
        tactors.push_back({t.position.x_mm, t.position.y_mm});
    return {{"words", words}, {"tactors", tactors}};
}

} // namespace

participant_page::participant_page(const page_words& words, const array& a, net::owned_fd listening)
    : dialogue_(make_facts(words, a)),
      server_(std::move(listening), document,
              {[this](auto v, std::string_view text) { return hear(v, text); }, [this](auto v) { leave(v); }})
{
}

// Sends under the lock, so that every page receives messages in order.
void participant_page::send(const std::vector<page_dialogue::message>& all)
{
    for (const page_dialogue::message& m : all) {
        server_.send(m.to, m.text);
        if (m.last)
            server_.finish(m.to);
    }
}

void participant_page::show(page_screen s)
{
    const std::lock_guard guard(mutex_);
    answer_.reset();
    static_cast<void>(answered_.consume());
    send(dialogue_.show(std::move(s), rt::monotonic_ns()));
}

bool participant_page::is_watched()
{
    const std::lock_guard guard(mutex_);
    return dialogue_.is_watched();
}

std::optional<page_answer> participant_page::poll()
{
    const std::lock_guard guard(mutex_);
    static_cast<void>(answered_.consume());
    return std::exchange(answer_, std::nullopt);
}

bool participant_page::hear(net::page_server::visitor v, std::string_view text)
{
    const std::int64_t now_ns = rt::monotonic_ns();
    const std::lock_guard guard(mutex_);
    const page_dialogue::heard h = dialogue_.hear(v, text, now_ns);
    take(h, now_ns);
    return h.understood;
}

void participant_page::press(char key)
{
    const std::int64_t now_ns = rt::monotonic_ns();
    const std::lock_guard guard(mutex_);
    take(dialogue_.press(key, now_ns), now_ns);
}

void participant_page::take(const page_dialogue::heard& h, std::int64_t now_ns)
{
    send(h.replies);
    if (!h.answer)
        return;
    answer_ = {*h.answer, now_ns};
    answered_.signal();
}

void participant_page::leave(net::page_server::visitor v)
{
    const std::lock_guard guard(mutex_);
    dialogue_.leave(v);
}

} // namespace tactor::study
