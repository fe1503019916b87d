// SPDX-License-Identifier: MIT
/// \file
/// A questionnaire with somebody at a terminal or before a page, or with a simulated observer.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "study/experiment/page_words.hpp"
#include "study/experiment/questionnaire.hpp"
#include "study/session/key_input.hpp"
#include "study/session/participant_page.hpp"

namespace tactor::study {

/// Asks each item on a screen of its own; `page` may be null. Returns the answers: numbers from the item's
/// lowest on, or texts. Hands the experimenter's keys to `obey`. Throws as session_keys::wait() and `obey`.
std::vector<std::string> ask_questionnaire(const questionnaire& q, const page_words& w, session_keys& keys,
                                           participant_page* page,
                                           const std::function<void(operator_key)>& obey);

/// Draws such answers, each number as likely as the others; texts are "simulated".
std::vector<std::string> draw_answers(const questionnaire& q, std::string_view seed);

} // namespace tactor::study
