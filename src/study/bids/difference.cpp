// SPDX-License-Identifier: MIT
// Compares the trials of two definitions, and the texts that give an answer its meaning.
#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "study/bids/dataset.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

template <class T>
std::string shown(const T& v)
{
    if constexpr (std::is_same_v<T, std::optional<double>>)
        return v ? fmt::format("{}", *v) : "none";
    else if constexpr (std::is_same_v<T, std::string>)
        return fmt::format("\"{}\"", v);
    else
        return fmt::format("{}", v);
}

template <class T>
std::vector<std::string> list_names(const std::vector<T>& all)
{
    std::vector<std::string> names;
    for (const T& one : all)
        names.push_back(one.name);
    return names;
}

// Search that keeps the first difference it finds.
class difference_search {
public:
    template <class T>
    void compare_key(const std::string& of, std::string_view name, const T& before, const T& now)
    {
        if (found_ || before == now)
            return;
        constexpr std::size_t longest = 90; // of both values
        found_ = {of, std::string(name), shown(before), shown(now)};
        if (found_.before.size() + found_.now.size() > longest)
            found_.before = found_.now = "";
    }

    void compare_runs(const std::string& of, const std::vector<run_outline>& before,
                      const std::vector<run_outline>& now)
    {
        compare_key(of, "runs", list_names(before), list_names(now));
        for (std::size_t i = 0; !found_ && i < before.size(); ++i)
            run(fmt::format("{}run \"{}\", ", of.empty() ? "in " : of, now[i].name), before[i], now[i]);
    }

    void compare_items(const questionnaire& before, const questionnaire& now)
    {
        const std::string of = fmt::format("in run \"{}\", ", now.name);
        compare_key(of, "time", std::string(describe_time(before.when)),
                    std::string(describe_time(now.when)));
        compare_key(of, "items", list_names(before.items), list_names(now.items));
        for (std::size_t i = 0; !found_ && i < before.items.size(); ++i) {
            const questionnaire_item& a = before.items[i];
            const questionnaire_item& b = now.items[i];
            const std::string item = fmt::format("{}item \"{}\", ", of, b.name);
            compare_key(item, "question", a.question, b.question);
            compare_key(item, "kind", static_cast<int>(a.kind), static_cast<int>(b.kind));
            compare_key(item, b.kind == item_kind::choice ? "choices" : "labels", a.labels, b.labels);
            compare_key(item, b.kind == item_kind::number ? "range" : "scale",
                        fmt::format("{} to {}", a.lowest, a.greatest),
                        fmt::format("{} to {}", b.lowest, b.greatest));
        }
    }

    const experiment_difference& difference() const noexcept { return found_; }

private:
    void run(const std::string& of, const run_outline& before, const run_outline& now)
    {
        compare_key(of, "task", std::string(find_run_task(before).name()),
                    std::string(find_run_task(now).name()));
        compare_key(of, "question", before.question, now.question);
        compare_key(of, "scale", rating_range(before), rating_range(now));
        compare_key(of, "labels", before.labels, now.labels);
        compare_key(of, "choices", before.choices, now.choices);
        compare_key(of, "motions", before.motions, now.motions);
        compare_key(of, "methods", before.methods, now.methods);
        compare_key(of, "sessions", before.sessions, now.sessions);
        compare_key(of, "number of trials", before.trials, now.trials);
        compare_key(of, "varied option", before.vary, now.vary);
        compare_key(of, "values", before.values, now.values);
        compare_key(of, "standard", before.standard, now.standard);
        compare_key(of, "share of catch trials", before.catches, now.catches);
    }

    experiment_difference found_;
};

} // namespace

experiment_difference find_difference(const experiment_outline& before, const experiment_outline& now)
{
    difference_search c;
    c.compare_key("", "experiment name", before.name, now.name);
    c.compare_key("", "number of sessions", before.sessions, now.sessions);
    c.compare_runs("", before.runs, now.runs);
    c.compare_key("", "groups", list_names(before.groups), list_names(now.groups));
    for (std::size_t i = 0; !c.difference() && i < before.groups.size(); ++i)
        c.compare_runs(fmt::format("in group \"{}\", ", now.groups[i].name), before.groups[i].runs,
                       now.groups[i].runs);
    for (const questionnaire& q : now.questionnaires)
        if (const auto was = std::ranges::find(before.questionnaires, q.name, &questionnaire::name);
            was != before.questionnaires.end())
            c.compare_items(*was, q);
    return c.difference();
}

} // namespace tactor::study
