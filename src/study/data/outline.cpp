// SPDX-License-Identifier: MIT
#include "study/data/outline.hpp"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>
#include <toml++/toml.h>

#include <tactor/error.hpp>

#include "files/toml_reader.hpp"

namespace tactor::study {
namespace {

[[noreturn]] void refuse(const std::string& name, const toml::node& at, std::string_view why,
                         std::string_view hint)
{
    const unsigned line = at.source().begin.line;
    throw error(error_kind::bad_input, source_place{name, line, at.source().begin.column}, why, hint);
}

std::string need_text(const toml::table& t, std::string_view key, const std::string& name)
{
    const toml::node* n = t.get(key);
    if (n == nullptr)
        refuse(name, t, fmt::format("{} is missing", key), "tactor-analyze(1) says what is read");
    const auto text = n->value_exact<std::string>();
    if (!text || text->empty())
        refuse(name, *n, fmt::format("{} is no text", key), "a text in quotes that is not empty");
    return *text;
}

unsigned whole(const toml::table& t, std::string_view key, unsigned least, unsigned otherwise,
               const std::string& name)
{
    const toml::node* n = t.get(key);
    if (n == nullptr)
        return otherwise;
    const auto v = n->value_exact<std::int64_t>();
    if (!v || *v < least || *v > 1000000)
        refuse(name, *n, fmt::format("{} is no whole number from {} to 1000000", key, least), "");
    return static_cast<unsigned>(*v);
}

// Each [[key]] of a document.
std::vector<const toml::table*> tables(const toml::table& t, std::string_view key, const std::string& name)
{
    std::vector<const toml::table*> all;
    const toml::node* n = t.get(key);
    const toml::array* list = n == nullptr ? nullptr : n->as_array();
    if (list == nullptr || list->empty())
        refuse(name, n == nullptr ? t : *n, fmt::format("there is no [[{}]]", key),
               "a study has at least one");
    for (const toml::node& one : *list) {
        if (!one.is_table())
            refuse(name, one, fmt::format("{} is no table", key), fmt::format("write [[{}]]", key));
        all.push_back(one.as_table());
    }
    return all;
}

std::vector<std::string> names(const toml::table& t, std::string_view key, const std::string& name)
{
    std::vector<std::string> all;
    for (const toml::table* one : tables(t, key, name)) {
        const std::string text = need_text(*one, "name", name);
        if (text == "n/a" || text.find_first_of("\t\r\n") != std::string::npos)
            refuse(name, *one->get("name"), fmt::format("a {} has no such name", key),
                   "any but n/a, on one line, without tabs");
        if (std::find(all.begin(), all.end(), text) != all.end())
            refuse(name, *one->get("name"), fmt::format("the {} \"{}\" is there twice", key, text),
                   "each has a name of its own");
        all.push_back(text);
    }
    return all;
}

// Those of `known` that a run names, in the order of `known`; all where it names none.
std::vector<std::string> chosen(const toml::table& run, std::string_view key,
                                const std::vector<std::string>& known, const std::string& name)
{
    const toml::node* n = run.get(key);
    if (n == nullptr)
        return known;
    std::vector<bool> wanted(known.size(), false);
    const toml::array* list = n->as_array();
    if (list == nullptr || list->empty())
        refuse(name, *n, fmt::format("{} is no list", key), "names in quotes, in brackets");
    for (const toml::node& one : *list) {
        const auto text = one.value_exact<std::string>();
        const auto at = std::find(known.begin(), known.end(), text.value_or(""));
        if (at == known.end())
            refuse(name, one, fmt::format("{} has what is not defined", key),
                   fmt::format("one of {}", fmt::join(known, ", ")));
        wanted[static_cast<std::size_t>(at - known.begin())] = true;
    }
    std::vector<std::string> all;
    for (std::size_t i = 0; i < known.size(); ++i)
        if (wanted[i])
            all.push_back(known[i]);
    return all;
}

task_kind task_of(const toml::table& t, const std::string& name)
{
    const std::string text = need_text(t, "task", name);
    for (const task_kind k : {task_kind::choose, task_kind::rate, task_kind::identify})
        if (to_string(k) == text)
            return k;
    refuse(name, *t.get("task"), fmt::format("the task \"{}\" is not known", text),
           "choose, rate or identify");
}

run_outline read_run(const toml::table& t, const std::vector<std::string>& motions,
                     const std::vector<std::string>& methods, const std::string& name)
{
    run_outline r;
    r.name = need_text(t, "name", name);
    r.file_name = file_name_of(r.name);
    if (r.file_name.empty())
        refuse(name, *t.get("name"), "a run's name has no letter or digit", "its files are called by those");
    r.task = task_of(t, name);
    r.motions = chosen(t, "motions", motions, name);
    r.methods = chosen(t, "methods", methods, name);
    r.trials = whole(t, "trials", 1, 0, name);
    r.scale = whole(t, "scale", 2, 5, name);
    if (r.task == task_kind::choose && r.methods.size() != 2)
        refuse(name, t, fmt::format("{} has {} methods to choose from", r.name, r.methods.size()),
               "choose compares two: name them in methods");
    if (r.task == task_kind::identify && r.motions.size() < 2)
        refuse(name, t, fmt::format("{} has one motion to identify", r.name), "name two or more in motions");
    return r;
}

} // namespace

std::string_view to_string(task_kind t) noexcept
{
    return t == task_kind::choose ? "choose" : t == task_kind::rate ? "rate" : "identify";
}

std::string file_name_of(std::string_view run)
{
    std::string name;
    for (const char c : run)
        if ((c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'))
            name += c;
    return name;
}

experiment_outline read_outline(std::string_view toml, const std::string& name)
{
    const toml::table t = detail::parse_toml(toml, name);
    const toml::node* head = t.get("experiment");
    if (head == nullptr || !head->is_table())
        refuse(name, head == nullptr ? t : *head, "there is no [experiment]", "it begins with one");
    experiment_outline e;
    e.name = need_text(*head->as_table(), "name", name);
    const std::vector<std::string> motions = names(t, "motion", name);
    const std::vector<std::string> methods = names(t, "method", name);
    for (const toml::table* run : tables(t, "run", name)) {
        run_outline r = read_run(*run, motions, methods, name);
        for (const run_outline& other : e.runs)
            if (other.file_name == r.file_name)
                refuse(name, *run->get("name"),
                       fmt::format("the files of the runs \"{}\" and \"{}\" would have one name", other.name,
                                   r.name),
                       "their letters and digits must differ");
        e.runs.push_back(std::move(r));
    }
    return e;
}

} // namespace tactor::study
