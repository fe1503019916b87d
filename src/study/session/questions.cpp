// SPDX-License-Identifier: MIT
#include "study/session/questions.hpp"

#include <utility>

#include <fmt/format.h>

#include "study/session/key_input.hpp"

namespace tactor::study {
namespace {

constexpr double picture_points = 60.0; // nobody sees the straight lines between them

// Returns a key for each answer, or none if there are too many.
std::string number_keys(std::size_t answers)
{
    return answers <= most_keys ? std::string("123456789").substr(0, answers) : "";
}

// Lists the texts of the answers, empty if a number is enough.
std::vector<std::string> label_choices(const run_definition& r)
{
    return r.outline.task == task_kind::identify ? r.outline.motions
           : !r.choices.empty()                  ? r.choices
                                                 : spread_labels(r.outline.labels, choices_in(r));
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
    return text;
}

} // namespace

bool question::is_typed() const noexcept
{
    return is_text() || is_estimate() || screen.lowest == 0 || screen.greatest > most_keys;
}

unsigned choices_in(const run_definition& r)
{
    return r.outline.task == task_kind::rate       ? r.outline.scale - r.outline.lowest_rating() + 1
           : r.outline.task == task_kind::identify ? static_cast<unsigned>(r.motions.size())
                                                   : 2;
}

std::string choices_text(const experiment_definition& d, const run_definition& r)
{
    if (r.outline.task == task_kind::estimate)
        return d.page["any_number"];
    const std::string between = d.page[r.outline.task == task_kind::rate ? "to" : "or"];
    const bool named = r.outline.task == task_kind::identify;
    const std::vector<std::string> labels = label_choices(r);
    const bool each = named || r.outline.labels.size() == labels.size();
    std::string text;
    for (std::size_t i = 0; i < labels.size(); i += each ? 1 : labels.size() - 1) {
        text += i == 0 ? "" : each ? ", " : fmt::format(" {} ", between);
        text += fmt::format("{}", i + r.outline.lowest_rating());
        if (!labels[i].empty())
            text += fmt::format(fmt::runtime(named ? " {}" : " ({})"), labels[i]);
    }
    return text;
}

page_progress find_progress(const prepared_experiment& p, const session_step& s)
{
    const run_sequence& run = p.runs[s.run];
    return {s.run + 1, p.runs.size(), s.practice, s.what == step_kind::trial ? s.which.trial : 0,
            s.practice ? run.practice.size() : run.trials.size()};
}

std::vector<point> sample_way(const stroke& target, const array& a, double parts)
{
    const trajectory& m = target.motion;
    const layout faces(a);
    std::vector<point> way;
    for (double i = 0.0; i <= parts; ++i) {
        const point p = m.position(m.duration_s() * i / parts);
        way.push_back(faces.contains(p) ? p : faces.nearest(p));
    }
    return way;
}

question ask_about_trial(const prepared_experiment& p, const session_step& s)
{
    const run_definition& r = p.run_at(s.run);
    page_screen shown{.name = "question", .question = r.outline.question, .where = find_progress(p, s)};
    if (r.outline.task == task_kind::estimate) {
        shown.entry = entry_kind::estimate;
        return {std::move(shown), choices_text(p.definition, r)};
    }
    shown.lowest = r.outline.lowest_rating();
    shown.greatest = shown.lowest + choices_in(r) - 1;
    shown.choices = label_choices(r);
    shown.keys = number_keys(shown.choices.size());
    shown.visual = r.outline.visual;
    if (r.outline.task == task_kind::identify)
        for (const std::size_t m : r.motions)
            shown.pictures.push_back(
                sample_way(p.definition.motions[m].drawn, p.where.tactors, picture_points));
    return {std::move(shown), choices_text(p.definition, r)};
}

question ask_about_item(const questionnaire& q, std::size_t item, const page_words& w, bool back,
                        bool on_page)
{
    const questionnaire_item& i = q.items[item];
    page_screen shown{.name = "questionnaire",
                      .question = i.question,
                      .choices = label_answers(i),
                      .visual = i.visual,
                      .entry = i.kind == item_kind::number ? entry_kind::number
                               : i.kind == item_kind::text ? entry_kind::text
                                                           : entry_kind::none,
                      .lowest = i.lowest,
                      .greatest = i.greatest,
                      .back = back};
    shown.keys = number_keys(shown.choices.size());
    shown.where = page_progress{1, 1, false, static_cast<unsigned>(item + 1), q.items.size()};
    std::string possible = answers_text(i, w);
    if (back)
        possible += fmt::format("{}{} {}", possible.empty() ? "" : ", ",
                                i.kind == item_kind::text && !on_page ? "Backspace" : "b", w["back"]);
    return {std::move(shown), std::move(possible)};
}

} // namespace tactor::study
