// SPDX-License-Identifier: MIT
#include "study/experiment/definition.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/error.hpp>

#include "core/words.hpp"
#include "files/toml_reader.hpp"

namespace tactor::study {
namespace {

using detail::toml_table;

constexpr unsigned most_trials = 10000;

std::string question_of(const run_definition& r)
{
    const bool similar = r.attribute == "similarity";
    switch (r.outline.task) {
    case task_kind::choose:
        return similar ? "Which of the two was more like the target?" : "Which of the two was more even?";
    case task_kind::rate:
        return similar ? "How much was it like the target?" : "How even was it?";
    case task_kind::identify:
        break;
    }
    return "Which movement was it?";
}

// Places in `all` of those that a run names, in the order of `all`; of all where it names none.
template <class T>
std::vector<std::size_t> places_in(const toml_table& run, std::string_view key, const std::vector<T>& all)
{
    const toml::array* list = run.list(key, "names");
    if (list != nullptr && list->empty())
        run.fail(key, fmt::format("{} is empty", key), "names in quotes, in brackets");
    std::vector<std::string> known;
    for (const T& one : all)
        known.push_back(one.name);
    std::vector<bool> wanted(all.size(), list == nullptr);
    for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
        const auto at = std::find(known.begin(), known.end(), list->get(i)->value_exact<std::string>());
        if (at == known.end())
            detail::fail_at(run.where(*list->get(i)), fmt::format("{} has what is not defined", key),
                            fmt::format("one of {}", fmt::join(known, ", ")));
        wanted[static_cast<std::size_t>(at - known.begin())] = true;
    }
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < all.size(); ++i)
        if (wanted[i])
            places.push_back(i);
    return places;
}

void check_task_keys(const toml_table& t, task_kind task)
{
    for (const std::string_view key : {"scale", "labels"})
        if (task != task_kind::rate && t.has(key))
            t.fail(key, fmt::format("{} is of runs that rate", key), "leave it out, or task = \"rate\"");
}

} // namespace

std::vector<std::string> texts_in(const toml_table& t, std::string_view key, std::size_t most)
{
    std::vector<std::string> all;
    const toml::array* list = t.list(key, "texts in quotes");
    if (list == nullptr)
        return all;
    for (const toml::node& n : *list) {
        if (!n.is_string())
            detail::fail_at(t.where(n), fmt::format("{} has {}", key, detail::shown(n)),
                            "texts in quotes, with commas between");
        all.push_back(n.as_string()->get());
    }
    if (all.size() > most)
        t.fail(key, fmt::format("{} has {} texts", key, all.size()), fmt::format("at most {}", most));
    return all;
}

run_definition read_run_outline(const toml_table& t, const experiment_definition& d)
{
    run_definition r;
    r.where = t.where();
    run_outline& o = r.outline;
    o.name = name_in(t, "name");
    o.file_name = file_name_of(o.name);
    if (o.file_name.empty())
        t.fail("name", "a run's name has no letter or digit", "its files are called by those");
    for (const run_definition& other : d.runs)
        if (other.outline.file_name == o.file_name)
            t.fail("name",
                   fmt::format("the files of the runs \"{}\" and \"{}\" would have one name",
                               other.outline.name, o.name),
                   "their letters and digits must differ");
    const std::string task = t.need(t.choice("task", {"choose", "rate", "identify"}), "task");
    o.task = task == "choose" ? task_kind::choose : task == "rate" ? task_kind::rate : task_kind::identify;
    o.trials = t.whole("trials", 1, most_trials).value_or(0);
    o.scale = t.whole("scale", 2, 9).value_or(o.scale);
    r.motions = places_in(t, "motions", d.motions);
    r.methods = places_in(t, "methods", d.methods);
    for (const std::size_t i : r.motions)
        o.motions.push_back(d.motions[i].name);
    for (const std::size_t i : r.methods)
        o.methods.push_back(d.methods[i].name);
    if (o.task == task_kind::choose && r.methods.size() != 2)
        t.fail(fmt::format("{} has {} methods to choose from", o.name, r.methods.size()),
               "choose compares two: name them in methods");
    if (o.task == task_kind::identify && r.motions.size() < 2)
        t.fail(fmt::format("{} has one motion to identify", o.name), "name two or more in motions");
    return r;
}

run_definition read_run_definition(const toml_table& t, const experiment_definition& d)
{
    t.only({"name", "task", "attribute", "question", "animation", "trials", "practice", "scale", "labels",
            "break_s", "motions", "methods"});
    run_definition r = read_run_outline(t, d);
    // Not every disk tells capitals from small letters.
    for (const run_definition& other : d.runs)
        if (in_small_letters(other.outline.file_name) == in_small_letters(r.outline.file_name))
            t.fail(fmt::format("the runs \"{}\" and \"{}\" differ in capitals only", other.outline.name,
                               r.outline.name),
                   "another name: on some disks their files would be one");
    check_task_keys(t, r.outline.task);
    r.attribute = t.choice("attribute", {"similarity", "uniformity"}).value_or("");
    if (r.attribute.empty() && r.outline.task != task_kind::identify)
        t.need(std::optional<std::string>{}, "attribute");
    r.question = t.text("question").value_or(question_of(r));
    r.animation = t.boolean("animation").value_or(false);
    if (r.outline.trials == 0)
        t.need(std::optional<unsigned>{}, "trials");
    r.practice = t.whole("practice", 0, most_trials).value_or(0);
    r.labels = texts_in(t, "labels", r.outline.scale);
    if (!r.labels.empty() && r.labels.size() != 2 && r.labels.size() != r.outline.scale)
        t.fail(
            "labels",
            fmt::format("labels has {} for a scale of {}", counted(r.labels.size(), "text"), r.outline.scale),
            "one for each end, or one for each step");
    r.break_s = t.number("break_s", {0.0, 86400.0}).value_or(0.0);
    return r;
}

} // namespace tactor::study
