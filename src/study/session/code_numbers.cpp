// SPDX-License-Identifier: MIT
#include "study/session/code_numbers.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/error.hpp>

#include "core/words.hpp"
#include "study/data/outline.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

constexpr unsigned greatest_number = 255;

/// An event with its name, its settings and the parts that determine its number by default.
struct event_row {
    code_event event;
    std::string_view name;
    code_numbering code_settings::*given;
    std::vector<std::string> by;
};

const std::array<event_row, code_events>& list_events()
{
    static const std::array<event_row, code_events> rows{{
        {code_event::stimulus,
         "stimulus",
         &code_settings::stimulus,
         {"motion", "method", "value", "interval"}},
        {code_event::standard, "standard", &code_settings::standard, {"motion", "method", "interval"}},
        {code_event::silent, "catch", &code_settings::caught, {"motion", "method"}},
        {code_event::answer, "answer", &code_settings::answer, {"run", "answer"}},
        {code_event::made_void, "void", &code_settings::made_void, {}},
    }};
    return rows;
}

// Returns the intervals, from 1, in which an event occurs in the cells of a run. Returns only interval 1 if
// the event does not occur.
std::vector<unsigned> list_intervals(const experiment_definition& d, const std::vector<planned_trial>& cells,
                                     code_event e)
{
    std::set<unsigned> all;
    for (const planned_trial& t : cells) {
        unsigned interval = 0;
        for (const std::size_t method : t.list_methods())
            if (++interval; find_event(d.methods[method]) == e)
                all.insert(interval);
    }
    return all.empty() ? std::vector{1U} : std::vector(all.begin(), all.end());
}

// Lists the events of a run except answers, in the order of their numbers.
std::vector<coded_event> list_run_events(const experiment_definition& d, const run_definition& r)
{
    const std::vector<planned_trial> cells = find_run_task(r.outline).list_cells(r);
    std::map<code_event, std::vector<unsigned>> intervals;
    for (const code_event e : {code_event::stimulus, code_event::standard, code_event::silent})
        intervals[e] = list_intervals(d, cells, e);
    std::vector<coded_event> all;
    for (const std::size_t motion : r.motions)
        for (const std::size_t method : r.methods) {
            const method_variants& v = r.variants.at(method);
            const auto add = [&](code_event e, std::size_t played) {
                for (const unsigned interval : intervals.at(e))
                    all.push_back({e, &r, motion, played, interval});
            };
            for (const std::size_t value : v.values)
                add(code_event::stimulus, value);
            if (v.values.empty())
                add(code_event::stimulus, method);
            if (v.standard)
                add(code_event::standard, *v.standard);
            if (v.silent)
                add(code_event::silent, *v.silent);
            for (const std::size_t silence : v.silences)
                add(code_event::silent, silence);
            all.push_back({code_event::made_void, &r, motion, method});
        }
    return all;
}

} // namespace

std::string_view to_string(code_event e) noexcept
{
    return list_events()[static_cast<std::size_t>(e)].name;
}

code_event find_event(const method_definition& m) noexcept
{
    return m.silent                                    ? code_event::silent
           : m.is_variant() && m.name == standard_name ? code_event::standard
                                                       : code_event::stimulus;
}

std::string code_numbers::describe(const experiment_definition& d, const coded_event& e) const
{
    const run_outline& r = e.run->outline;
    const method_definition& m = d.methods[e.method];
    const bool is_stimulus = e.event != code_event::answer && e.event != code_event::made_void;
    std::vector<std::string> parts{std::string(to_string(e.event))};
    for (const std::string& part : by_[static_cast<std::size_t>(e.event)])
        if (part == "run")
            parts.push_back(fmt::format("run \"{}\"", r.name));
        else if (part == "motion")
            parts.push_back(fmt::format("motion \"{}\"", d.motions[e.motion].name));
        else if (part == "method")
            parts.push_back(fmt::format("method \"{}\"", d.methods[m.made_of.value_or(e.method)].name));
        else if (part == "value" && is_stimulus && m.value)
            parts.push_back(fmt::format("{} {}", r.vary, plain_number(*m.value)));
        else if (part == "interval" && is_stimulus && e.run->stimuli > 1)
            parts.push_back(fmt::format("interval {}", e.interval));
        else if (part == "answer" && e.event == code_event::answer)
            if (std::string answer = find_run_task(r).name_response(r, e.response); !answer.empty())
                parts.push_back(std::move(answer));
    return fmt::format("{}", fmt::join(parts, ", "));
}

code_numbers::code_numbers(const code_settings& c, const experiment_definition& whole)
{
    for (const event_row& row : list_events())
        by_.push_back((c.*row.given).by.value_or(row.by));
    const unsigned most = c.offsets.empty() ? greatest_number : (1U << c.offsets.size()) - 1;
    unsigned next = 1;
    for (const event_row& row : list_events()) {
        next = (c.*row.given).first.value_or(next);
        const auto add = [&](const coded_event& e) {
            if (e.event != row.event)
                return;
            const std::string text = describe(whole, e);
            if (!numbers_.emplace(text, next).second)
                return;
            meanings_[next++].push_back(text);
        };
        for (const run_definition& r : whole.runs) {
            std::vector<std::string> answers = find_run_task(r.outline).list_responses(r.outline);
            if (answers.empty())
                answers.emplace_back(); // all answers share a number
            for (const coded_event& e : list_run_events(whole, r)) {
                add(e);
                for (const std::string& answer : answers)
                    add({code_event::answer, &r, e.motion, e.method, 1, answer});
            }
        }
    }
    const auto last = std::ranges::max_element(numbers_, {}, &decltype(numbers_)::value_type::second);
    if (last->second > most)
        throw error(error_kind::bad_input, c.where,
                    fmt::format("code: {} events need numbers up to {} ({}), but {} is the largest",
                                numbers_.size(), last->second, last->first, most),
                    most == greatest_number
                        ? "combine events under [sync.codes]: stimulus = { by = [\"motion\", \"method\"] }"
                        : "use more lines, or combine events under [sync.codes]: stimulus = { by = "
                          "[\"motion\", \"method\"] }");
}

unsigned code_numbers::find_number(const experiment_definition& d, const coded_event& e) const
{
    return numbers_.at(describe(d, e));
}

} // namespace tactor::study
