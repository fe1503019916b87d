// SPDX-License-Identifier: MIT
#include "study/session/participant_page.hpp"

#include <algorithm>
#include <utility>

#include <boost/locale/utf.hpp>

#include "files/plan/plan_json.hpp"
#include "net/rpc.hpp"
#include "rt/clock.hpp"
#include "study/data/trial.hpp"

namespace tactor::study {
namespace {

using ordered = nlohmann::ordered_json;

// Returns a member's value if it is a whole number.
std::optional<std::uint64_t> whole_number(const ordered& j, const char* key)
{
    const auto found = j.find(key);
    return found != j.end() && found->is_number_unsigned() ? std::optional(found->get<std::uint64_t>())
                                                           : std::nullopt;
}

ordered point_list(const std::optional<point>& p)
{
    return p ? ordered{p->x_mm, p->y_mm} : ordered();
}

template <class Points>
ordered paths_list(const std::vector<Points>& paths)
{
    ordered all = ordered::array();
    for (const Points& path : paths) {
        all.push_back(ordered::array());
        for (const auto& p : path)
            all.back().push_back(point_list(p));
    }
    return all;
}

// Reads the points of a drawing: the time of each point, s, and its x and y, mm. Returns nothing if they are
// not valid.
std::optional<drawing> read_points(const ordered& j)
{
    if (!j.is_array() || j.size() > most_drawn_points)
        return {};
    drawing d;
    for (const ordered& p : j) {
        if (!p.is_array() || p.size() != 3 ||
            !std::ranges::all_of(p, [](const ordered& n) { return n.is_number(); }))
            return {};
        d.push_back({p[0].get<double>(), {p[1].get<double>(), p[2].get<double>()}});
    }
    return is_drawing(d) ? std::optional(std::move(d)) : std::nullopt;
}

// page/participant.html with its styles and modules, as one document.
constexpr net::page_document document =
#include "study/participant_page.inc"
    ;

// Returns what a page must know: its words, the positions of the tactors, and where the array is worn. Leaves
// out the study's title and methods, which could influence the participant.
nlohmann::ordered_json make_page_facts(const page_words& texts, const array& a)
{
    nlohmann::ordered_json words;
    for (const page_word& w : english_page_words())
        words[std::string(w.key)] = texts[w.key];
    nlohmann::ordered_json tactors = nlohmann::ordered_json::array();
    for (const tactor_spec& t : a.tactors)
        tactors.push_back({t.position.x_mm, t.position.y_mm});
    nlohmann::ordered_json facts{{"words", words}, {"tactors", tactors}};
    facts.update(files::describe_site(a));
    return facts;
}

} // namespace

std::optional<std::string> tidy_text(std::string_view entered)
{
    std::string tidy;
    std::size_t characters = 0;
    for (const char* at = entered.data(); at != entered.data() + entered.size();) {
        const char* const first = at;
        const auto c = boost::locale::utf::utf_traits<char>::decode(at, entered.data() + entered.size());
        if (!boost::locale::utf::is_valid_codepoint(c))
            return {};
        if (c == '\t')
            tidy += ' ';
        else if (c == '\n' || (c >= 0x20 && (c < 0x7f || c > 0x9f)))
            tidy.append(first, at);
        else
            continue;
        if (++characters > most_text_characters)
            return {};
    }
    return tidy;
}

std::string page_dialogue::state(std::int64_t now_ns) const
{
    ordered j{{"screen", screen_.name}, {"ask", open_ ? asked_ : 0}};
    if (!screen_.text.empty())
        j["text"] = screen_.text;
    if (!screen_.question.empty())
        j["question"] = screen_.question;
    if (!screen_.choices.empty())
        j["choices"] = screen_.choices;
    if (screen_.is_line)
        j["visual"] = true;
    if (screen_.are_stimuli)
        j["are_stimuli"] = true;
    if (screen_.entry == entry_kind::text)
        j["entry"] = {{"most", most_text_characters}};
    if (screen_.entry == entry_kind::estimate)
        j["entry"] = {
            {"lowest", least_estimate}, {"greatest", most_estimate}, {"longest", most_estimate_characters}};
    if (screen_.entry == entry_kind::number)
        j["entry"] = {{"lowest", screen_.lowest}, {"greatest", screen_.greatest}};
    if (screen_.draws != drawing_kind::none)
        j["entry"] = {{"draw", screen_.draws == drawing_kind::place ? "place" : "path"},
                      {"most", most_drawn_points}};
    if (screen_.back)
        j["back"] = true;
    if (screen_.where) {
        j["progress"] = {{"run", screen_.where->run},
                         {"runs", screen_.where->runs},
                         {"practice", screen_.where->practice},
                         {"trial", screen_.where->trial},
                         {"trials", screen_.where->trials}};
        if (screen_.where->may_end_early)
            j["progress"]["at_most"] = true;
    }
    for (const auto& motion : screen_.pictures)
        j["pictures"].push_back(paths_list(motion));
    if (screen_.stimuli > 0) {
        j["stimuli"] = screen_.stimuli;
        j["playing"] = screen_.playing;
        if (!screen_.names.empty())
            j["names"] = screen_.names;
    }
    if (!screen_.paths.empty())
        j["paths"] = paths_list(screen_.paths);
    if (screen_.lasts_s > 0.0) {
        j["lasts_s"] = screen_.lasts_s;
        j["passed_s"] = static_cast<double>(now_ns - since_ns_) * 1e-9;
    }
    return net::json_line(j);
}

std::vector<page_dialogue::message> page_dialogue::show(page_screen s, std::int64_t now_ns)
{
    screen_ = std::move(s);
    since_ns_ = now_ns;
    open_ =
        !screen_.choices.empty() || screen_.entry != entry_kind::none || screen_.draws != drawing_kind::none;
    if (open_)
        ++asked_;
    if (!theirs_)
        return {};
    return {{*theirs_, state(now_ns)}};
}

page_dialogue::heard page_dialogue::close_with_choice(std::size_t choice)
{
    open_ = false;
    return {.answer = choice < screen_.keys.size() ? screen_.keys[choice] : '\0',
            .number = static_cast<unsigned>(choice) + (screen_.is_line ? 0U : 1U)};
}

page_dialogue::heard page_dialogue::go_back()
{
    open_ = false;
    return {.answer = 'b'};
}

page_dialogue::heard page_dialogue::receive_message(visitor from, std::string_view text, std::int64_t now_ns)
{
    const ordered received = ordered::parse(text, nullptr, false);
    if (!received.is_object())
        return {.understood = false};
    heard h;
    if (received.contains("hello")) {
        if (theirs_ && *theirs_ != from)
            h.replies.push_back({*theirs_, net::json_line({{"screen", "elsewhere"}}), true});
        theirs_ = from;
        h.replies.push_back({from, net::json_line(facts_)});
        h.replies.push_back({from, state(now_ns)});
        return h;
    }
    const auto text_entered = received.find("text");
    const bool is_text = text_entered != received.end() && text_entered->is_string();
    const std::optional<std::uint64_t> number = whole_number(received, "answer");
    const auto points = received.find("drawing");
    const bool is_drawn = points != received.end();
    const auto back = received.find("back");
    const bool is_back = back != received.end() && *back == true;
    if (!is_text && !number && !is_drawn && !is_back)
        return {.understood = false};
    if (theirs_ != from)
        return h; // the page already knows that another page replaced it
    if (open_ && whole_number(received, "ask") == asked_) {
        if (is_back && screen_.back)
            return go_back();
        if (number > 0U && number <= screen_.choices.size())
            return close_with_choice(*number - 1);
        const bool is_number = screen_.entry == entry_kind::number && number && *number >= screen_.lowest &&
                               *number <= screen_.greatest;
        if (screen_.entry == entry_kind::text && is_text)
            h.text = tidy_text(text_entered->get_ref<const std::string&>());
        if (screen_.entry == entry_kind::estimate && is_text &&
            read_estimate(text_entered->get_ref<const std::string&>()))
            h.text = text_entered->get<std::string>();
        if (screen_.draws != drawing_kind::none && is_drawn)
            if (const auto d = read_points(*points);
                d && (screen_.draws == drawing_kind::path || d->size() == 1))
                h.text = to_text(*d);
        if (is_number || h.text) {
            open_ = false;
            h.answer = '\0';
            h.number = is_number ? static_cast<unsigned>(*number) : 0;
            return h;
        }
    }
    h.replies.push_back({from, state(now_ns)});
    return h;
}

page_dialogue::heard page_dialogue::press(char key, std::int64_t now_ns)
{
    std::size_t choice = screen_.keys.find(key);
    if (choice == std::string::npos && key >= '1' && key <= '9')
        choice = static_cast<std::size_t>(key - '1');
    const bool is_choice = choice < screen_.keys.size();
    if (!theirs_ || !open_ || !(is_choice || (screen_.back && key == 'b')))
        return {};
    heard h = is_choice ? close_with_choice(choice) : go_back();
    h.replies.push_back({*theirs_, state(now_ns)});
    return h;
}

void page_dialogue::leave(visitor v)
{
    if (theirs_ == v)
        theirs_.reset();
}

participant_page::participant_page(const page_words& words, const array& a, net::owned_fd listening)
    : dialogue_(make_page_facts(words, a)),
      server_(std::move(listening), document,
              {[this](auto v, std::string_view text) { return receive_message(v, text); },
               [this](auto v) { leave(v); }})
{
}

// Sends messages. Callers hold the lock, so that every page receives messages in order.
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

bool participant_page::receive_message(net::page_server::visitor v, std::string_view text)
{
    const std::int64_t now_ns = rt::monotonic_ns();
    const std::lock_guard guard(mutex_);
    const page_dialogue::heard h = dialogue_.receive_message(v, text, now_ns);
    send_and_store(h, now_ns);
    return h.understood;
}

void participant_page::press(char key)
{
    const std::int64_t now_ns = rt::monotonic_ns();
    const std::lock_guard guard(mutex_);
    send_and_store(dialogue_.press(key, now_ns), now_ns);
}

void participant_page::send_and_store(const page_dialogue::heard& h, std::int64_t now_ns)
{
    send(h.replies);
    if (!h.answer)
        return;
    answer_ = {*h.answer, h.number, h.text, now_ns};
    answered_.signal();
}

void participant_page::leave(net::page_server::visitor v)
{
    const std::lock_guard guard(mutex_);
    dialogue_.leave(v);
}

} // namespace tactor::study
