// SPDX-License-Identifier: MIT
#include "study/experiment/definition.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/error.hpp>

#include "core/words.hpp"
#include "files/text_file.hpp"
#include "files/toml_reader.hpp"
#include "study/experiment/noise_options.hpp"

namespace tactor::study {
namespace {

namespace fs = std::filesystem;
using detail::toml_table;

constexpr unsigned most_trials = 10000;
constexpr std::size_t most_bytes_of_text = std::size_t{1} << 20;

std::vector<std::string> texts(const toml_table& t, std::string_view key, std::size_t most)
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

// A name among the files beside the definition, unless it is a preset's.
std::string array_in(const toml_table& t, const fs::path& folder)
{
    std::string text = *t.text("array");
    const std::vector<std::string>& presets = array_presets();
    if (std::find(presets.begin(), presets.end(), text) != presets.end())
        return text;
    std::error_code ignored;
    if (!fs::exists(folder / text, ignored))
        t.fail("array", fmt::format("there is no array '{}'", text),
               fmt::format("{}, or a file", fmt::join(presets, ", ")));
    return (folder / text).string();
}

void read_level(const toml_table& t, experiment_definition& d)
{
    const auto level = t.table("level", "level", "level = { sl_db = 7 } or { dbfs = -18 }");
    if (!level)
        return;
    level->only({"sl_db", "dbfs"});
    const std::string_view kind = level->one_of({"sl_db", "dbfs"});
    if (kind == "dbfs")
        d.level_dbfs = level->number(kind, {-200.0, 0.0});
    else
        d.sl_db = *level->number(kind, {-60.0, 100.0});
}

std::optional<std::uint64_t> read_seed(const toml_table& t)
{
    constexpr std::int64_t most = (std::int64_t{1} << 53) - 1; // JSON's numbers go so far
    const toml::node* n = t.node("seed");
    if (n == nullptr)
        return {};
    const auto v = n->value_exact<std::int64_t>();
    if (!v || *v < 0 || *v > most)
        t.fail("seed", fmt::format("seed is {}", detail::shown(*n)),
               fmt::format("a whole number from 0 to {}", most));
    return static_cast<std::uint64_t>(*v);
}

// `folder`: where the array's file is looked for; none: it is not.
void read_head(const toml_table& root, const fs::path* folder, experiment_definition& d)
{
    const auto t = root.table("experiment", "[experiment]", "[experiment]");
    if (!t)
        root.fail("there is no [experiment]", "it begins with one");
    t->only({"name", "title", "array", "level", "gap_s", "rest_s", "seed", "consent", "authors"});
    d.name = name_in(*t, "name");
    d.title = t->has("title") ? name_in(*t, "title") : d.name;
    if (t->has("array") && folder != nullptr)
        d.array = array_in(*t, *folder);
    read_level(*t, d);
    d.gap_s = t->number("gap_s", {0.0, 60.0}).value_or(d.gap_s);
    d.rest_s = t->number("rest_s", {0.0, 60.0}).value_or(d.rest_s);
    d.seed = read_seed(*t);
    d.consent = t->text("consent").value_or("");
    d.authors = texts(*t, "authors", 1000);
}

masking_definition read_masking(const toml_table& root)
{
    masking_definition m;
    const auto t = root.table("masking", "[masking]", "[masking]");
    if (!t)
        return m;
    t->only({"noise", "level_dbfs", "fade_s", "while"});
    const std::string noise = t->choice("noise", {"white", "pink", "none"}).value_or("white");
    m.noise = noise == "white" ? noise_kind::white : noise == "pink" ? noise_kind::pink : noise_kind::none;
    m.level_dbfs = t->number("level_dbfs", {-120.0, 0.0}).value_or(m.level_dbfs);
    if (m.noise != noise_kind::none) {
        const double most = greatest_noise_dbfs(noise_of(m, {}).color);
        if (m.level_dbfs > most)
            t->fail("level_dbfs",
                    fmt::format("level_dbfs is {}, and the peaks of {} noise are at full scale from {} on",
                                m.level_dbfs, noise, most),
                    "less here, and more at the amplifier of the headphones");
    }
    m.fade_s = t->number("fade_s", {0.0, 10.0}).value_or(m.fade_s);
    m.through_run = t->choice("while", {"stimulus", "run"}).value_or("stimulus") == "run";
    return m;
}

page_words read_page(const toml_table& root)
{
    page_words words;
    const auto t = root.table("page", "[page]", "[page]");
    if (!t)
        return words;
    std::vector<std::string_view> known;
    for (const page_word& w : page_words_in_english())
        known.push_back(w.key);
    t->only(known);
    for (const std::string_view key : known)
        if (const auto text = t->text(key))
            words.set(key, *text);
    return words;
}

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

// Places of names in a list that has them.
template <class T>
std::vector<std::size_t> places(const std::vector<std::string>& names, const std::vector<T>& all)
{
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < all.size(); ++i)
        if (std::find(names.begin(), names.end(), all[i].name) != names.end())
            found.push_back(i);
    return found;
}

void check_task_keys(const toml_table& t, task_kind task)
{
    for (const std::string_view key : {"scale", "labels"})
        if (task != task_kind::rate && t.has(key))
            t.fail(key, fmt::format("{} is of runs that rate", key), "leave it out, or task = \"rate\"");
}

run_definition run_in(const toml_table& t)
{
    t.only({"name", "task", "attribute", "question", "animation", "trials", "practice", "scale", "labels",
            "break_s", "motions", "methods"});
    run_definition r;
    r.where = t.where();
    r.outline.name = name_in(t, "name");
    const std::string task = t.need(t.choice("task", {"choose", "rate", "identify"}), "task");
    r.outline.task = task == "choose" ? task_kind::choose
                     : task == "rate" ? task_kind::rate
                                      : task_kind::identify;
    check_task_keys(t, r.outline.task);
    r.attribute = t.choice("attribute", {"similarity", "uniformity"}).value_or("");
    if (r.attribute.empty() && r.outline.task != task_kind::identify)
        t.need(std::optional<std::string>{}, "attribute");
    r.question = t.text("question").value_or(question_of(r));
    r.animation = t.boolean("animation").value_or(false);
    r.outline.trials = t.need(t.whole("trials", 1, most_trials), "trials");
    r.practice = t.whole("practice", 0, most_trials).value_or(0);
    r.outline.scale = t.whole("scale", 2, 9).value_or(5);
    r.labels = texts(t, "labels", r.outline.scale);
    if (!r.labels.empty() && r.labels.size() != 2 && r.labels.size() != r.outline.scale)
        t.fail(
            "labels",
            fmt::format("labels has {} for a scale of {}", counted(r.labels.size(), "text"), r.outline.scale),
            "one for each end, or one for each step");
    r.break_s = t.number("break_s", {0.0, 86400.0}).value_or(0.0);
    t.list("motions", "names");
    t.list("methods", "names");
    return r;
}

// Not every disk tells capitals from small letters.
void check_file_names(const std::vector<run_definition>& runs)
{
    for (std::size_t i = 0; i < runs.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            if (in_small_letters(runs[i].outline.file_name) == in_small_letters(runs[k].outline.file_name))
                throw error(error_kind::bad_input, runs[i].where,
                            fmt::format("the runs \"{}\" and \"{}\" differ in capitals only",
                                        runs[k].outline.name, runs[i].outline.name),
                            "another name: on some disks their files would be one");
}

template <class T, class Read>
std::vector<T> read_all(const toml_table& root, std::string_view key, const Read& read)
{
    std::vector<T> all;
    for (const toml_table& t : root.tables(key))
        all.push_back(read(t));
    if (all.empty())
        root.fail(fmt::format("there is no [[{}]]", key), "an experiment has at least one");
    return all;
}

// All but the motions, whose files may be elsewhere.
experiment_definition design_in(const toml_table& root, std::string_view toml, const std::string& name,
                                const fs::path* folder)
{
    root.only({"experiment", "masking", "page", "motion", "method", "run"});
    experiment_definition d;
    d.text = toml;
    read_head(root, folder, d);
    d.masking = read_masking(root);
    d.page = read_page(root);
    d.methods = read_all<method_definition>(root, "method", read_method);
    d.runs = read_all<run_definition>(root, "run", run_in);
    // What the analysis will read of it; it knows which names go together.
    d.outline = read_outline(toml, name);
    for (std::size_t i = 0; i < d.runs.size(); ++i)
        d.runs[i].outline = d.outline.runs[i];
    return d;
}

} // namespace

std::string_view to_string(noise_kind k) noexcept
{
    return k == noise_kind::white ? "white" : k == noise_kind::pink ? "pink" : "none";
}

experiment_definition read_definition(std::string_view toml, const std::string& name, const fs::path& folder)
{
    const toml::table document = detail::parse_toml(toml, name);
    const toml_table root(document, "the file", name);
    experiment_definition d = design_in(root, toml, name, &folder);
    check_file_names(d.runs);
    d.motions = read_all<motion_definition>(root, "motion",
                                            [&](const toml_table& t) { return read_motion(t, folder); });
    for (run_definition& r : d.runs) {
        r.motions = places(r.outline.motions, d.motions);
        r.methods = places(r.outline.methods, d.methods);
    }
    return d;
}

experiment_definition read_design(std::string_view toml, const std::string& name)
{
    const toml::table document = detail::parse_toml(toml, name);
    return design_in(toml_table(document, "the file", name), toml, name, nullptr);
}

const std::vector<std::string>& shipped_experiments()
{
    static const std::vector<std::string> names{"park2016"};
    return names;
}

std::string_view shipped_experiment(std::string_view name)
{
    if (name != "park2016")
        throw error(error_kind::bad_input, "experiment", fmt::format("there is no '{}'", name),
                    fmt::format("{}, or a file", fmt::join(shipped_experiments(), ", ")));
    return park2016_text();
}

experiment_definition load_definition(const std::string& name_or_file)
{
    const std::vector<std::string>& shipped = shipped_experiments();
    const bool known = std::find(shipped.begin(), shipped.end(), name_or_file) != shipped.end();
    std::error_code ignored;
    if (known ||
        (!fs::exists(name_or_file, ignored) && name_or_file.find_first_of("./") == std::string::npos))
        return read_definition(shipped_experiment(name_or_file), name_or_file, {});
    const detail::whole_text text = detail::read_text_file(name_or_file, most_bytes_of_text);
    return read_definition(text, name_or_file, fs::path(name_or_file).parent_path());
}

} // namespace tactor::study
