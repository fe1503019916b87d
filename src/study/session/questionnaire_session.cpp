// SPDX-License-Identifier: MIT
#include "study/session/questionnaire_session.hpp"

#include <fmt/format.h>

#include "session/say.hpp"
#include "study/random/random.hpp"

namespace tactor::study {
namespace {

page_screen item_screen(const questionnaire& q, std::size_t i)
{
    const questionnaire_item& item = q.items[i];
    page_screen s{.name = "questionnaire",
                  .question = item.question,
                  .choices = label_answers(item),
                  .visual = item.visual,
                  .entry = item.kind == item_kind::number ? entry_kind::number
                           : item.kind == item_kind::text ? entry_kind::text
                                                          : entry_kind::none,
                  .lowest = item.lowest,
                  .greatest = item.greatest};
    if (s.choices.size() <= most_keys)
        s.keys = std::string("123456789").substr(0, s.choices.size());
    s.where = page_progress{1, 1, false, static_cast<unsigned>(i + 1), q.items.size()};
    return s;
}

// Returns the possible answers for a terminal: "1 none, 2 slight", "1 (never) to 7 (always)", "0 to 120".
std::string answers_text(const questionnaire_item& item, const page_words& w)
{
    const std::vector<std::string> labels = label_answers(item);
    std::string text;
    if (!labels.empty() && labels.size() == item.labels.size())
        for (std::size_t i = 0; i < labels.size(); ++i)
            text += fmt::format("{}{} {}", i == 0 ? "" : ", ", i + item.lowest, labels[i]);
    else if (!item.labels.empty())
        text = fmt::format("{} ({}) {} {} ({})", item.lowest, labels.front(), w["to"], item.greatest,
                           labels.back());
    else if (item.kind != item_kind::text)
        text = fmt::format("{} {} {}", item.lowest, w["to"], item.greatest);
    return text.empty() ? text : text + ": ";
}

std::string ask_item(const questionnaire_item& item, const page_words& w, session_keys& keys,
                     const std::function<void(operator_key)>& obey)
{
    const std::string possible = answers_text(item, w);
    session::show(fmt::format("{} {}", item.question, possible));
    const bool is_text = item.kind == item_kind::text;
    const bool is_typed = is_text || item.lowest == 0 || item.greatest > most_keys;
    typed_text text;
    typed_number number(fmt::formatted_size("{}", item.greatest));
    for (;;) {
        const session_key k = is_text    ? keys.wait_for_text(text)
                              : is_typed ? keys.wait_for_number(number)
                                         : keys.wait();
        const bool is_shown = is_typed && k.is_key;
        if (k.command) {
            obey(*k.command);
        } else if (is_text && k.entered) {
            session::show(is_shown ? "\n" : *k.entered + "\n");
            return *k.entered;
        } else if (!is_text && k.answer && *k.answer >= item.lowest && *k.answer <= item.greatest) {
            session::show(is_shown ? "\n" : fmt::format("{}\n", *k.answer));
            return fmt::format("{}", *k.answer);
        } else if (is_typed || !keys.come_early()) {
            session::show(fmt::format("{}{}: {}", is_shown ? "\n" : "", w["no_answer"], possible));
        }
    }
}

} // namespace

std::vector<std::string> ask_questionnaire(const questionnaire& q, const page_words& w, session_keys& keys,
                                           participant_page* page,
                                           const std::function<void(operator_key)>& obey)
{
    keys.drop_keys();
    session::show("\n");
    for (const std::string& text : {q.title, q.text})
        if (!text.empty())
            session::show_lines(text);
    if (page != nullptr && (!q.title.empty() || !q.text.empty())) {
        page->show({.name = "questionnaire",
                    .text = q.text,
                    .question = q.title,
                    .choices = {w["begin"]},
                    .keys = " "});
        session::show("The participant begins, or g.\n");
        for (session_key k = keys.wait(); k.command && k.command != operator_key::go_on; k = keys.wait())
            obey(*k.command);
    }
    std::vector<std::string> answers;
    for (std::size_t i = 0; i < q.items.size(); ++i) {
        if (page != nullptr)
            page->show(item_screen(q, i));
        answers.push_back(ask_item(q.items[i], w, keys, obey));
    }
    return answers;
}

std::vector<std::string> draw_answers(const questionnaire& q, std::string_view seed)
{
    random_numbers r(seed);
    std::vector<std::string> answers;
    for (const questionnaire_item& item : q.items)
        answers.push_back(item.kind == item_kind::text
                              ? "simulated"
                              : fmt::format("{}", item.lowest + r.below(item.greatest - item.lowest + 1)));
    return answers;
}

} // namespace tactor::study
