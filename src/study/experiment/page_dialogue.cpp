// SPDX-License-Identifier: MIT
#include "study/experiment/page_dialogue.hpp"

#include <utility>

namespace tactor::study {
namespace {

using ordered = nlohmann::ordered_json;

std::string message_text(const ordered& j)
{
    return j.dump(-1, ' ', false, ordered::error_handler_t::replace);
}

// Returns a member that is a whole number; 0 for anything else.
std::uint64_t whole_number(const ordered& j, const char* key)
{
    const auto found = j.find(key);
    return found != j.end() && found->is_number_unsigned() ? found->get<std::uint64_t>() : 0;
}

ordered points_list(const std::vector<point>& path)
{
    ordered all = ordered::array();
    for (const point& p : path)
        all.push_back({p.x_mm, p.y_mm});
    return all;
}

} // namespace

std::string page_dialogue::state(std::int64_t now_ns) const
{
    ordered j{{"screen", screen_.name}, {"ask", open_ ? asked_ : 0}};
    if (!screen_.text.empty())
        j["text"] = screen_.text;
    if (!screen_.question.empty())
        j["question"] = screen_.question;
    if (!screen_.choices.empty())
        j["choices"] = screen_.choices;
    if (screen_.where)
        j["progress"] = {{"run", screen_.where->run},
                         {"runs", screen_.where->runs},
                         {"practice", screen_.where->practice},
                         {"trial", screen_.where->trial},
                         {"trials", screen_.where->trials}};
    for (const std::vector<point>& motion : screen_.pictures)
        j["pictures"].push_back(points_list(motion));
    if (screen_.stimuli > 0) {
        j["stimuli"] = screen_.stimuli;
        j["playing"] = screen_.playing;
    }
    if (screen_.path.size() > 1)
        j["path"] = points_list(screen_.path);
    if (screen_.lasts_s > 0.0) {
        j["lasts_s"] = screen_.lasts_s;
        j["passed_s"] = static_cast<double>(now_ns - since_ns_) * 1e-9;
    }
    return message_text(j);
}

std::vector<page_dialogue::message> page_dialogue::show(page_screen s, std::int64_t now_ns)
{
    screen_ = std::move(s);
    since_ns_ = now_ns;
    open_ = !screen_.choices.empty();
    if (open_)
        ++asked_;
    if (!theirs_)
        return {};
    return {{*theirs_, state(now_ns)}};
}

page_dialogue::heard page_dialogue::hear(visitor from, std::string_view text, std::int64_t now_ns)
{
    const ordered received = ordered::parse(text, nullptr, false);
    if (!received.is_object())
        return {.understood = false};
    heard h;
    if (received.contains("hello")) {
        if (theirs_ && *theirs_ != from)
            h.replies.push_back({*theirs_, message_text({{"screen", "elsewhere"}}), true});
        theirs_ = from;
        h.replies.push_back({from, message_text(facts_)});
        h.replies.push_back({from, state(now_ns)});
        return h;
    }
    const std::uint64_t choice = whole_number(received, "answer");
    if (choice == 0)
        return {.understood = false};
    if (theirs_ != from)
        return h; // the page knows that another one took its place
    if (!open_ || whole_number(received, "ask") != asked_ || choice > screen_.keys.size()) {
        h.replies.push_back({from, state(now_ns)});
        return h;
    }
    open_ = false;
    h.answer = screen_.keys[choice - 1];
    return h;
}

page_dialogue::heard page_dialogue::press(char key, std::int64_t now_ns)
{
    heard h;
    std::size_t choice = screen_.keys.find(key);
    if (choice == std::string::npos && key >= '1' && key <= '9')
        choice = static_cast<std::size_t>(key - '1');
    if (!theirs_ || !open_ || choice >= screen_.keys.size())
        return h;
    open_ = false;
    h.answer = screen_.keys[choice];
    h.replies.push_back({*theirs_, state(now_ns)});
    return h;
}

void page_dialogue::leave(visitor v)
{
    if (theirs_ == v)
        theirs_.reset();
}

} // namespace tactor::study
