// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "study/data/text_table.hpp"
#include "study/experiment/simulated.hpp"
#include "study/tasks/draw.hpp"
#include "study/tasks/task.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

// Returns the target's places at equal parts of its time.
std::vector<tactor::point> target_path(const stroke& s)
{
    std::vector<tactor::point> parts;
    for (std::size_t i = 0; i <= path_parts; ++i)
        parts.push_back(s.motion.position(s.motion.duration_s() * static_cast<double>(i) / path_parts));
    return parts;
}

double mean_distance(const std::vector<tactor::point>& a, const std::vector<tactor::point>& b)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += std::hypot(b[i].x_mm - a[i].x_mm, b[i].y_mm - a[i].y_mm);
    return sum / static_cast<double>(a.size());
}

class identify final : public task {
public:
    identify()
        : task({.name = "identify",
                .trial = "One stimulus; the participant names its motion",
                .response = "The motion that the participant named",
                .questions = {"Which movement was it?", "Which movement was it?", "Which movement was it?"}})
    {
    }

    void check(const detail::toml_table& t, const run_outline& o) const override
    {
        if (o.motions.size() < 2)
            t.fail(fmt::format("{} has one motion to identify", o.name), "name two or more in motions");
    }

    std::vector<planned_trial> list_cells(const run_definition& r) const override
    {
        return cross_motions(r, list_methods);
    }
    std::vector<planned_trial> draw(const run_definition& r, std::size_t n,
                                    random_numbers& numbers) const override
    {
        return draw_balanced(r, list_methods, n, numbers);
    }

    trial_answers ask(const run_definition& r, const page_words& w) const override
    {
        trial_answers a{.labels = r.outline.motions, .shows_motions = true};
        a.possible = describe_answers(a.labels, 1, true, true, w["or"]);
        return a;
    }
    void take(trial_row& row, const run_definition& r, double answer) const override
    {
        row.response = r.outline.motions.at(static_cast<std::size_t>(answer) - 1);
    }
    std::vector<std::string> list_responses(const run_outline& o) const override { return o.motions; }
    std::string name_response(std::string_view response) const override
    {
        return fmt::format("answer \"{}\"", response);
    }

    void read_row(trial& r, const text_table& t, std::size_t row, const run_outline& o) const override
    {
        r.method_1 = find_place(t, row, "method_1", o.methods);
        r.response = static_cast<unsigned>(find_place(t, row, "response", o.motions));
    }
    void score(trial& r, const run_outline&, std::string_view, double answer) const override
    {
        r.response = static_cast<unsigned>(answer) - 1;
    }

    void prepare(simulated_run& who) const override
    {
        for (const std::size_t m : who.run.motions)
            who.targets.push_back(target_path(who.definition.motions[m].drawn));
    }
    double simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        std::vector<tactor::point> felt = who.felt_path(t.motion, t.method_1);
        for (tactor::point& p : felt) {
            p.x_mm += who.truth.sigma * r.normal();
            p.y_mm += who.truth.sigma * r.normal();
        }
        std::vector<double> distances;
        for (const std::vector<tactor::point>& target : who.targets)
            distances.push_back(mean_distance(target, felt));
        return static_cast<double>(std::ranges::min_element(distances) - distances.begin() + 1);
    }
};

} // namespace

const task& identify_task()
{
    static const identify one;
    return one;
}

} // namespace tactor::study
