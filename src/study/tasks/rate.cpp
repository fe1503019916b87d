// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/words.hpp"
#include "study/data/text_table.hpp"
#include "study/experiment/questionnaire.hpp"
#include "study/tasks/draw.hpp"
#include "study/tasks/task.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

class rate final : public task {
public:
    rate()
        : task({.name = "rate",
                .trial = "One stimulus, which the participant rates",
                .response = "The rating, {}",
                .questions = {"How much was it like the target?", "How even was it?", ""},
                .keys = {"scale", "labels"}})
    {
    }

    void read_outline(const detail::toml_table& t, run_definition& r) const override
    {
        task::read_outline(t, r);
        r.outline.scale = read_scale(t, r.outline.visual).value_or(r.outline.scale);
    }
    void read(const detail::toml_table& t, run_definition& r) const override
    {
        r.attribute = t.need(t.text("attribute"), "attribute");
        const run_outline& o = r.outline;
        const std::size_t labels = o.labels.size();
        if (o.visual && labels != 2)
            t.fail(t.has("labels") ? "labels" : "scale",
                   fmt::format("labels has {} for a visual analogue scale", counted(labels, "text")),
                   "give one for each end");
        if (labels != 0 && labels != 2 && labels != o.scale)
            t.fail("labels", fmt::format("labels has {} for a scale of {}", counted(labels, "text"), o.scale),
                   "give one for each end, or one for each step");
    }
    nlohmann::ordered_json scale(const run_outline& o) const override
    {
        return o.visual ? nlohmann::ordered_json("vas") : nlohmann::ordered_json(o.scale);
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
        const run_outline& o = r.outline;
        trial_answers a{.lowest = o.lowest_rating(), .is_line = o.visual};
        a.labels = spread_labels(o.labels, o.scale - a.lowest + 1);
        a.possible = describe_answers(a.labels, a.lowest, false, o.labels.size() == a.labels.size(), w["to"]);
        return a;
    }
    void take(trial_row& row, const run_definition& r, double answer) const override
    {
        task::take(row, r, answer);
        row.rating = static_cast<unsigned>(answer);
    }
    std::vector<std::string> list_responses(const run_outline& o) const override
    {
        std::vector<std::string> all;
        for (unsigned i = 1; i <= o.scale && !o.visual; ++i)
            all.push_back(fmt::format("{}", i));
        return all;
    }

    void read_row(trial& r, const text_table& t, std::size_t row, const run_outline& o) const override
    {
        r.method_1 = find_place(t, row, "method_1", o.methods);
        r.response = read_twice(t, row, "rating", [&](std::string_view column) {
            return t.whole(row, column, o.lowest_rating(), o.scale);
        });
    }

    void prepare(simulated_run& who) const override { prepare_judge(who); }
    double simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        const double lowest = who.run.outline.lowest_rating();
        const double highest = who.run.outline.scale;
        const double felt = judge(who, t.motion, t.method_1, r) - who.mean_utility;
        return std::clamp(std::round((highest + lowest) / 2.0 + felt), lowest, highest);
    }
};

} // namespace

const task& rate_task()
{
    static const rate one;
    return one;
}

} // namespace tactor::study
