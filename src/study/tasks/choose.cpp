// SPDX-License-Identifier: MIT
#include <cstddef>

#include "study/data/text_table.hpp"
#include "study/tasks/draw.hpp"
#include "study/tasks/task.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

// Lists the pairs of methods in one order. They are a cyclic design: of the first n pairs, and of the next n,
// each of the n methods comes first once.
std::vector<planned_trial> list_pairs(std::size_t motion, const std::vector<std::size_t>& methods)
{
    const std::size_t n = methods.size();
    std::vector<planned_trial> all;
    for (std::size_t i = 0; i < n * (n - 1) / 2; ++i)
        all.push_back({motion, methods[i % n], methods[(i % n + i / n + 1) % n]});
    return all;
}

class choose final : public task {
public:
    choose()
        : task({.name = "choose",
                .trial = "Two stimuli, one after the other; the participant chooses one",
                .response = "Which of the two stimuli was chosen, 1 or 2",
                .questions = {"Which of the two was more like the target?", "Which of the two was more even?",
                              ""},
                .keys = {"choices"}})
    {
    }

    void check(const detail::toml_table& t, const run_outline& o) const override
    {
        if (o.methods.size() < 2)
            t.fail(fmt::format("{} has one method to choose from", o.name), "name two or more in methods");
    }
    void read(const detail::toml_table& t, run_definition& r) const override
    {
        r.attribute = t.need(t.text("attribute"), "attribute");
        refuse_method_blocks(t, r.outline);
    }

    std::vector<planned_trial> list_cells(const run_definition& r) const override
    {
        return cross_motions(r, list_pairs);
    }
    std::vector<planned_trial> draw(const run_definition& r, std::size_t n,
                                    random_numbers& numbers) const override
    {
        return draw_balanced(r, list_pairs, n, numbers);
    }

    trial_answers ask(const run_definition& r, const page_words& w) const override
    {
        trial_answers a = task::ask(r, w);
        a.names_stimuli = true;
        return a;
    }

    void read_row(trial& r, const text_table& t, std::size_t row, const run_outline& o) const override
    {
        r.method_1 = find_place(t, row, "method_1", o.methods);
        r.method_2 = find_place(t, row, "method_2", o.methods);
        if (r.method_1 == r.method_2)
            t.refuse(row, "both stimuli have the same method", "choose compares two");
        r.response = read_one_of_two(t, row);
    }

    void prepare(simulated_run& who) const override { prepare_judge(who); }
    double simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        const double first = judge(who, t.motion, t.method_1, r);
        return first >= judge(who, t.motion, t.method_2.value(), r) ? 1 : 2;
    }
};

} // namespace

const task& choose_task()
{
    static const choose one;
    return one;
}

} // namespace tactor::study
