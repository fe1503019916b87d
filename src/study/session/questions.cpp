// SPDX-License-Identifier: MIT
#include "study/session/questions.hpp"

#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "session/say.hpp"

namespace tactor::study {
namespace {

constexpr double picture_points = 60.0; // enough to look smooth

// Time within which a second press of the key that answered the previous question is ignored, ns.
constexpr std::int64_t second_press_ns = 300'000'000;

// Returns a key for each answer. Returns no keys if there are more answers than keys.
std::string list_answer_keys(std::size_t answers)
{
    return answers <= most_keys ? std::string("123456789").substr(0, answers) : "";
}

// Returns points on the path of each stroke, at equal time steps.
std::vector<std::vector<point>> sample_motion(const std::vector<stroke>& strokes, const layout& faces)
{
    std::vector<std::vector<point>> all;
    for (const stroke& s : strokes) {
        all.emplace_back();
        for (double i = 0.0; i <= picture_points; ++i)
            all.back().push_back(
                faces.nearest(s.motion.position(s.motion.duration_s() * i / picture_points)));
    }
    return all;
}

// Returns the possible answers for a terminal, such as "1 none, 2 slight", "0 to 120" or
// "1 (never) to 7 (always)".
std::string answers_text(const questionnaire_item& item, const page_words& w)
{
    const std::vector<std::string> labels = list_answer_labels(item);
    std::string text;
    if (!labels.empty() && labels.size() == item.labels.size())
        for (std::size_t i = 0; i < labels.size(); ++i)
            text += fmt::format("{}{} {}", i == 0 ? "" : ", ", i + item.lowest, labels[i]);
    else if (!item.labels.empty())
        text = fmt::format("{} ({}) {} {} ({})", item.lowest, labels.front(), w["to"], item.greatest,
                           labels.back());
    else if (item.kind != item_kind::text)
        text = fmt::format("{} {} {}", item.lowest, w["to"], item.greatest);
    return text;
}

// Returns the number of the choice with this key, from 1. Enter counts as the key a, as on a keypad.
std::optional<unsigned> find_choice(const page_screen& s, const std::string& key)
{
    const std::size_t at = key.size() == 1 ? s.keys.find(key == "\n" ? 'a' : key.front()) : s.keys.npos;
    return at != s.keys.npos ? std::optional(static_cast<unsigned>(at) + 1) : std::nullopt;
}

} // namespace

bool question::is_typed() const noexcept
{
    return is_text() || is_estimate() || screen.lowest == 0 || screen.greatest > most_keys;
}

std::optional<given_answer> question_asker::ask(const question& q,
                                                const std::function<bool(operator_key)>& obey,
                                                const std::string& subject)
{
    show(q.screen);
    const std::string possible = q.possible.empty() ? "" : q.possible + ": ";
    session::show(q.prompt.empty() ? fmt::format("{} {}", q.screen.question, possible) : q.prompt);
    typed_text text;
    typed_number number;
    for (;;) {
        const bool on_hand = q.is_drawn() && page_ != nullptr;
        session_key k = q.is_text() || on_hand ? keys_.wait_for_text(text)
                        : q.is_typed()         ? keys_.wait_for_number(number, q.is_estimate())
                                               : keys_.wait(subject);
        const auto choice = find_choice(q.screen, k.text);
        if (choice && !k.answer)
            k.answer = choice;
        const bool is_shown = q.is_typed() && k.is_key;
        const std::optional<double> estimate = q.is_estimate() ? read_estimate(k.text) : std::nullopt;
        const bool is_answer =
            q.is_text() || on_hand ? k.entered.has_value()
            : q.is_estimate()      ? estimate.has_value()
                              : k.answer && *k.answer >= q.screen.lowest && *k.answer <= q.screen.greatest;
        if (k.command) {
            if (!obey(*k.command))
                return {};
        } else if (is_answer && is_second_press(k)) {
            show(q.screen); // asks again, because the page took the press as an answer
        } else if (is_answer) {
            answered_ = k;
            if (q.is_text() || q.is_estimate() || on_hand)
                answered_.answer.reset();
            given_answer a{estimate.value_or(k.answer.value_or(0)), {}, k.at_ns};
            a.text = q.is_text() || on_hand ? *k.entered : fmt::format("{}", a.number);
            if (!is_shown && !on_hand)
                session::show(choice ? std::string(1, q.screen.keys[*choice - 1]) : a.text);
            session::show("\n");
            return a;
        } else if (q.is_typed() || !keys_.can_come_early()) {
            session::show(fmt::format("{}{}: {}", is_shown ? "\n" : "", words_["no_answer"], possible));
        }
    }
}

// Returns false for lines, which are not presses.
bool question_asker::is_second_press(const session_key& k) const
{
    return (k.is_key || page_ != nullptr) && k.answer && k.answer == answered_.answer &&
           k.at_ns - answered_.at_ns < second_press_ns;
}

void question_asker::show(const page_screen& s)
{
    if (page_ != nullptr)
        page_->show(s);
}

page_progress find_progress(const prepared_experiment& p, const session_step& s)
{
    const run_sequence& run = p.runs[s.run];
    return {s.run + 1,
            p.runs.size(),
            s.practice,
            s.what == step_kind::trial ? s.which.trial : 0,
            s.practice ? run.practice.size() : run.trials.size(),
            !s.practice && p.run_at(s.run).outline.adaptive.may_end_early()};
}

std::optional<point> find_place(const stroke& s, const stroke_span& when, const layout& faces, double t_s)
{
    if (t_s < when.start_s || t_s > when.end_s)
        return {};
    return faces.nearest(s.motion.position(t_s - when.start_s));
}

std::vector<std::vector<std::optional<point>>> sample_target(const std::vector<stroke>& target,
                                                             const array& a, double parts)
{
    const layout faces(a);
    const std::vector<stroke_span> spans = list_spans(target);
    const double duration_s = find_duration_s(target);
    std::vector<std::vector<std::optional<point>>> all(target.size());
    for (std::size_t s = 0; s < target.size(); ++s)
        for (double i = 0.0; i <= parts; ++i) // rounding may make the last time too large
            all[s].push_back(
                find_place(target[s], spans[s], faces, std::min(duration_s, duration_s * i / parts)));
    return all;
}

question make_trial_question(const prepared_experiment& p, const session_step& s, const planned_trial& t)
{
    const run_definition& r = p.run_at(s.run);
    trial_answers a = find_run_task(r.outline).list_answers(r, p.definition.page);
    page_screen shown{.name = "question",
                      .text = find_run_task(r.outline).announcement(r, t, p.definition.page),
                      .question = r.outline.question,
                      .where = find_progress(p, s)};
    if (a.is_estimate) {
        shown.entry = entry_kind::estimate;
        return {std::move(shown), std::move(a.possible)};
    }
    shown.draws = a.draws;
    if (a.draws == drawing_kind::place) { // at a terminal, participants type a tactor's number
        shown.greatest = static_cast<unsigned>(p.where.tactors.tactors.size());
        a.possible = fmt::format("{} {} {}", shown.lowest, p.definition.page["to"], shown.greatest);
    }
    if (a.draws != drawing_kind::none)
        return {std::move(shown), std::move(a.possible)};
    shown.lowest = a.lowest;
    shown.greatest = a.lowest + static_cast<unsigned>(a.labels.size()) - 1;
    shown.choices = std::move(a.labels);
    std::string prompt;
    if (!shown.text.empty())
        prompt = fmt::format("{} {} {}: ", shown.text, shown.question, fmt::join(a.keys, " "));
    shown.keys = a.keys.empty() ? list_answer_keys(shown.choices.size()) : std::move(a.keys);
    shown.is_line = a.is_line;
    shown.are_stimuli = r.stimuli > 2;
    if (a.shows_motions)
        for (const std::size_t m : r.motions)
            shown.pictures.push_back(sample_motion(p.definition.motions[m].strokes, layout(p.where.tactors)));
    return {std::move(shown), std::move(a.possible), std::move(prompt)};
}

trial_answer read_trial_answer(const question& q, const given_answer& a, const array& where)
{
    if (!q.is_drawn())
        return a.number;
    if (auto d = read_drawing(a.text))
        return *std::move(d);
    return drawing{{0.0, where.tactors.at(static_cast<std::size_t>(a.number) - 1).position}};
}

question make_item_question(const questionnaire& q, std::size_t item, const page_words& w, bool back,
                            bool on_page)
{
    const questionnaire_item& i = q.items[item];
    page_screen shown{.name = "questionnaire",
                      .question = i.question,
                      .choices = list_answer_labels(i),
                      .is_line = i.is_line,
                      .entry = i.kind == item_kind::number ? entry_kind::number
                               : i.kind == item_kind::text ? entry_kind::text
                                                           : entry_kind::none,
                      .lowest = i.lowest,
                      .greatest = i.greatest,
                      .back = back};
    shown.keys = list_answer_keys(shown.choices.size());
    shown.where = page_progress{1, 1, false, static_cast<unsigned>(item + 1), q.items.size()};
    std::string possible = answers_text(i, w);
    if (back)
        possible += fmt::format("{}{} {}", possible.empty() ? "" : ", ",
                                i.kind == item_kind::text && !on_page ? "Backspace" : "b", w["back"]);
    return {std::move(shown), std::move(possible)};
}

} // namespace tactor::study
