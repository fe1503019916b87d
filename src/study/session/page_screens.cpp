// SPDX-License-Identifier: MIT
#include "study/session/person_session.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace tactor::study {
namespace {

// Points of a path on the page: nobody sees the straight lines between them.
constexpr double points_per_s = 200.0;
constexpr double most_points = 4000.0;
constexpr double picture_points = 60.0;

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

// Lists the texts of the answers, empty if a number is enough.
std::vector<std::string> label_choices(const prepared_experiment& p, const run_definition& r)
{
    std::vector<std::string> all(choices_in(r));
    if (r.outline.task == task_kind::identify)
        for (std::size_t i = 0; i < r.motions.size(); ++i)
            all[i] = p.definition.motions[r.motions[i]].name;
    else if (r.labels.size() == all.size())
        all = r.labels;
    else if (r.labels.size() == 2) {
        all.front() = r.labels.front();
        all.back() = r.labels.back();
    }
    return all;
}

// Returns the steps of the scale with their labels, or its ends.
std::string scale_text(const page_words& w, const run_definition& r)
{
    const unsigned last = r.outline.scale;
    const bool each = r.labels.size() == last;
    std::string text;
    for (unsigned i = 1; i <= last; ++i) {
        if (!each && i != 1 && i != last)
            continue;
        if (i != 1)
            text += each ? ", " : fmt::format(" {} ", w["to"]);
        text += fmt::format("{}", i);
        if (each)
            text += fmt::format(" ({})", r.labels[i - 1]);
        else if (r.labels.size() == 2)
            text += fmt::format(" ({})", r.labels[i == 1 ? 0 : 1]);
    }
    return text;
}

} // namespace

unsigned choices_in(const run_definition& r)
{
    return r.outline.task == task_kind::choose ? 2
           : r.outline.task == task_kind::rate ? r.outline.scale
                                               : static_cast<unsigned>(r.motions.size());
}

std::string choices_text(const experiment_definition& d, const run_definition& r)
{
    if (r.outline.task == task_kind::choose)
        return fmt::format("1 {} 2", d.page["or"]);
    if (r.outline.task == task_kind::rate)
        return scale_text(d.page, r);
    std::string text;
    for (std::size_t i = 0; i < r.motions.size(); ++i)
        text += fmt::format("{}{} {}", i == 0 ? "" : ", ", i + 1, d.motions[r.motions[i]].name);
    return text;
}

page_progress find_progress(const prepared_experiment& p, const session_step& s)
{
    const run_sequence& run = p.runs[s.run];
    return {s.run + 1, p.runs.size(), s.practice, s.what == step_kind::trial ? s.which.trial : 0,
            s.practice ? run.practice.size() : run.trials.size()};
}

page_screen idle_screen(const prepared_experiment& p, std::string_view key)
{
    return {.name = std::string(key), .text = p.definition.page[key]};
}

page_screen walk_screen(const prepared_experiment& p, unsigned tactor, bool asked)
{
    const page_words& w = p.definition.page;
    page_screen s{.name = "walk", .text = w["walk"]};
    s.where = {1, 1, false, tactor + 1, p.where.tactors.tactors.size()};
    if (!asked)
        return s;
    s.question = w["felt"];
    s.choices = {w["yes"], w["no"], w["again"]};
    s.keys = "ynr";
    if (tactor > 0) {
        s.choices.push_back(w["back"]);
        s.keys += 'b';
    }
    return s;
}

page_screen target_screen(const prepared_experiment& p, const session_step& s, const stroke& target)
{
    page_screen shown = idle_screen(p, "target");
    shown.lasts_s = target.motion.duration_s();
    shown.path = sample_way(target, p.where.tactors,
                            std::clamp(std::ceil(shown.lasts_s * points_per_s), 50.0, most_points));
    shown.where = find_progress(p, s);
    return shown;
}

page_screen stimulus_screen(const prepared_experiment& p, const session_step& s, unsigned playing)
{
    page_screen shown = idle_screen(p, "stimulus");
    shown.stimuli = p.run_at(s.run).outline.task == task_kind::choose ? 2 : 0;
    shown.playing = playing;
    shown.where = find_progress(p, s);
    return shown;
}

page_screen question_screen(const prepared_experiment& p, const session_step& s)
{
    const run_definition& r = p.run_at(s.run);
    page_screen shown{.name = "question", .question = r.question, .choices = label_choices(p, r)};
    for (std::size_t i = 0; i < shown.choices.size(); ++i)
        shown.keys += static_cast<char>('1' + i);
    if (r.outline.task == task_kind::identify)
        for (const std::size_t m : r.motions)
            shown.pictures.push_back(
                sample_way(p.definition.motions[m].drawn, p.where.tactors, picture_points));
    shown.where = find_progress(p, s);
    return shown;
}

} // namespace tactor::study
