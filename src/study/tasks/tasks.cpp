// SPDX-License-Identifier: MIT
// The list of tasks, and defaults that most tasks share. A new task adds a line to the list.
#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "study/tasks/draw.hpp"
#include "study/tasks/task.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {

const task& choose_task();
const task& rate_task();
const task& identify_task();
const task& detect_task();
const task& same_different_task();
const task& estimate_task();
const task& constant_task();
const task& adaptive_task();
const task& interval_task();
const task& locate_task();
const task& trace_task();
const task& dissimilar_task();
const task& oddity_task();
const task& adjust_task();

std::span<const task* const> list_tasks() noexcept
{
    static const std::array all{
        &choose_task(),   &rate_task(),       &identify_task(), &detect_task(),   &same_different_task(),
        &estimate_task(), &constant_task(),   &adaptive_task(), &interval_task(), &locate_task(),
        &trace_task(),    &dissimilar_task(), &oddity_task(),   &adjust_task()};
    return all;
}

const task& find_task(std::string_view name) noexcept
{
    return **std::ranges::find(list_tasks(), name, &task::name);
}

std::vector<std::string_view> task_names()
{
    std::vector<std::string_view> names;
    for (const task* one : list_tasks())
        names.push_back(one->name());
    return names;
}

const task& read_task(const detail::toml_table& t)
{
    std::vector<std::string_view> names = task_names();
    names.emplace_back("questionnaire"); // the caller has read those
    return find_task(t.need(t.choice("task", names), "task"));
}

void task::read_outline(const detail::toml_table& t, run_definition& r) const
{
    read_trials(t, r.outline);
}

std::vector<planned_trial> task::draw(const run_definition& r, std::size_t n, random_numbers& numbers) const
{
    return draw_cells(r, list_cells(r), n, numbers);
}

std::unique_ptr<value_chooser> task::make_value_chooser(const run_definition&) const
{
    return std::make_unique<value_chooser>();
}

trial_answers task::list_answers(const run_definition& r, const page_words& w) const
{
    trial_answers a{.labels = r.choices.empty() ? std::vector<std::string>(2) : r.choices};
    a.possible = describe_answers(a.labels, 1, false, false, w["or"]);
    return a;
}

void task::record_answer(trial_row& row, const run_definition&, const trial_answer& answer) const
{
    row.response = fmt::format("{}", answer.number);
}

std::vector<std::string> task::list_responses(const run_outline&) const
{
    return {"1", "2"};
}

std::string task::name_response(const run_outline&, std::string_view response) const
{
    return fmt::format("answer {}", response);
}

void task::score(trial& r, const run_outline&, std::string_view, const trial_answer& answer) const
{
    r.response = static_cast<unsigned>(answer.number);
}

std::string describe_answers(const std::vector<std::string>& labels, unsigned lowest, bool named, bool each,
                             std::string_view between)
{
    std::string text;
    for (std::size_t i = 0; i < labels.size(); i += each ? 1 : labels.size() - 1) {
        text += i == 0 ? "" : each ? ", " : fmt::format(" {} ", between);
        text += fmt::format("{}", i + lowest);
        if (!labels[i].empty())
            text += fmt::format(fmt::runtime(named ? " {}" : " ({})"), labels[i]);
    }
    return text;
}

} // namespace tactor::study
