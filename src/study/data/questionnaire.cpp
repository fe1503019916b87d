// SPDX-License-Identifier: MIT
#include "study/data/questionnaire.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "core/words.hpp"
#include "files/toml_reader.hpp"

namespace tactor::study {
namespace {

using detail::toml_table;

constexpr unsigned most_steps = 101;  // greatest number of steps of a scale
constexpr unsigned visual_most = 100; // greatest answer on a visual analogue scale
constexpr unsigned most_choices = 50;
constexpr unsigned greatest_number = 9999;

// Reads a name that is safe as a file name and as the name of a column.
std::string plain_name(const toml_table& t)
{
    std::string name = t.need(t.text("name"), "name");
    const std::string small = to_lower_case(name);
    if (small.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") != small.npos)
        t.fail("name", fmt::format("name is {}", detail::shown(*t.node("name"))),
               "use letters, digits and _");
    return name;
}

// Reads the smallest and the largest answer.
void read_range(const toml_table& t, questionnaire_item& item)
{
    if (!t.has("range"))
        t.need(std::optional<unsigned>{}, "range");
    const toml::array& range = t.pair(*t.node("range"), "range");
    const auto low = range.get(0)->value_exact<std::int64_t>();
    const auto high = range.get(1)->value_exact<std::int64_t>();
    if (!low || !high || *low < 0 || *low >= *high || *high > greatest_number)
        t.fail("range", "range is not a pair of whole numbers from small to large",
               fmt::format("give the smallest and the largest number, from 0 to {}, such as [0, 120]",
                           greatest_number));
    item.lowest = static_cast<unsigned>(*low);
    item.greatest = static_cast<unsigned>(*high);
}

// Reads the number of steps, "vas", or a label for each step.
void read_steps(const toml_table& t, questionnaire_item& item)
{
    item.labels = t.texts("labels", most_steps);
    item.greatest = read_scale(t, item.is_line).value_or(static_cast<unsigned>(item.labels.size()));
    if (item.is_line)
        item.lowest = 0;
    const std::size_t labels = item.labels.size();
    const bool fits = item.is_line ? labels == 2 : labels == 0 || labels == 2 || labels == item.greatest;
    if (item.greatest < 2 || !fits)
        t.fail(t.has("labels") ? "labels" : "kind", fmt::format("a scale has {}", counted(labels, "label")),
               item.is_line ? "give one for each end"
                            : "give one for each step, or set scale and give one for each end or none");
}

questionnaire_item read_item(const toml_table& t)
{
    t.refuse_other_keys({"name", "question", "kind", "choices", "range", "labels", "scale"});
    questionnaire_item item;
    item.name = plain_name(t);
    item.question = t.need(t.text("question"), "question");
    constexpr std::array<std::string_view, 4> kinds{"choice", "number", "text", "scale"};
    const std::string kind = t.need(t.choice("kind", {kinds.begin(), kinds.end()}), "kind");
    item.kind = static_cast<item_kind>(std::ranges::find(kinds, kind) - kinds.begin());
    constexpr std::array keys{std::pair("choices", item_kind::choice), std::pair("range", item_kind::number),
                              std::pair("labels", item_kind::scale), std::pair("scale", item_kind::scale)};
    for (const auto& [key, of] : keys)
        if (item.kind != of && t.has(key))
            t.fail(
                key, fmt::format("{} does not apply to a {}", key, kind),
                fmt::format("leave out {}, or set kind = \"{}\"", key, kinds[static_cast<std::size_t>(of)]));
    if (item.kind == item_kind::choice) {
        item.labels = t.texts("choices", most_choices);
        item.greatest = static_cast<unsigned>(item.labels.size());
        if (item.greatest < 2)
            t.fail(t.has("choices") ? "choices" : "kind",
                   fmt::format("a choice has {}", counted(item.greatest, "text")),
                   "give two choices or more");
    } else if (item.kind == item_kind::number) {
        read_range(t, item);
    } else if (item.kind == item_kind::scale) {
        read_steps(t, item);
    }
    return item;
}

} // namespace

std::optional<unsigned> read_scale(const toml_table& t, bool& visual)
{
    const toml::node* n = t.node("scale");
    if (n == nullptr)
        return {};
    visual = n->value_exact<std::string>() == "vas";
    const auto most = visual ? std::optional<std::int64_t>(visual_most) : n->value_exact<std::int64_t>();
    if (!most || *most < 2 || *most > most_steps)
        t.fail("scale", fmt::format("scale is {}", detail::shown(*n)),
               fmt::format("give 2 to {}, or \"vas\"", most_steps));
    return static_cast<unsigned>(*most);
}

questionnaire read_questionnaire(const toml_table& run, const std::vector<questionnaire>& others)
{
    run.refuse_other_keys({"name", "task", "when", "title", "text", "item"});
    questionnaire q;
    q.name = plain_name(run);
    for (const questionnaire& other : others)
        if (to_lower_case(other.name) == to_lower_case(q.name))
            run.fail("name", fmt::format("the questionnaire \"{}\" occurs twice", q.name),
                     "give each questionnaire its own name, which names its file");
    const std::string when = run.choice("when", {"before", "between", "after"}).value_or("before");
    q.when = when == "before"    ? questionnaire_time::before
             : when == "between" ? questionnaire_time::between
                                 : questionnaire_time::after;
    q.title = run.text("title").value_or("");
    q.text = run.text("text").value_or("");
    for (const toml_table& t : run.tables("item")) {
        questionnaire_item item = read_item(t);
        // Columns that identify a row of answers: no item may have their names.
        constexpr std::array<std::string_view, 4> taken{"participant_id", "session", "session_id", "after"};
        if (std::ranges::count(taken, item.name) > 0 ||
            std::ranges::count(q.items, item.name, &questionnaire_item::name) > 0)
            t.fail("name", fmt::format("the column \"{}\" occurs twice", item.name),
                   "give each item its own name");
        q.items.push_back(std::move(item));
    }
    if (q.items.empty())
        run.fail(fmt::format("the questionnaire \"{}\" has no question", q.name), "add [[run.item]]");
    return q;
}

std::filesystem::path answers_path(const questionnaire& q, const char* extension)
{
    return std::filesystem::path("phenotype") / (q.name + extension);
}

std::string_view describe_time(questionnaire_time t) noexcept
{
    return t == questionnaire_time::before    ? "before the first run"
           : t == questionnaire_time::between ? "after each run but the last"
                                              : "after the last run";
}

std::vector<std::string> spread_labels(const std::vector<std::string>& labels, std::size_t answers)
{
    if (labels.size() == answers)
        return labels;
    std::vector<std::string> all(answers);
    if (!labels.empty()) {
        all.front() = labels.front();
        all.back() = labels.back();
    }
    return all;
}

std::vector<std::string> list_answer_labels(const questionnaire_item& item)
{
    if (item.kind == item_kind::number || item.kind == item_kind::text)
        return {};
    return spread_labels(item.labels, item.greatest - item.lowest + 1);
}

} // namespace tactor::study
