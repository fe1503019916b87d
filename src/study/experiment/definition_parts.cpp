// SPDX-License-Identifier: MIT
#include "study/experiment/definition.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/error.hpp>

#include "core/suggest.hpp"
#include "core/words.hpp"
#include "files/toml_reader.hpp"
#include "options/check.hpp"
#include "options/settle.hpp"
#include "options/words.hpp"

namespace tactor::study {
namespace {

using detail::toml_table;

// A key may have its unit behind it, as in stroke files, or not, as options do.
std::string_view spelled(const toml_table& t, std::string_view plain, std::string_view with_unit)
{
    if (t.has(plain) && t.has(with_unit))
        t.fail(with_unit, fmt::format("{} has both {} and {}", t.title(), plain, with_unit),
               "keep one of them");
    return t.has(with_unit) ? with_unit : plain;
}

std::string write_key(const options::option& o, std::string_view value)
{
    return value.empty() ? std::string(o.name) : fmt::format("{} = \"{}\"", o.name, value);
}

// Adds the place in the definition to what the library refuses.
template <class F>
auto at_key(const toml_table& t, std::string_view key, F make)
{
    try {
        return make();
    } catch (const error& e) {
        const error worded = options::spell(e, {write_key});
        throw error(e.kind(), t.where(key), fmt::format("{}: {}", worded.subject(), worded.why()),
                    worded.hint())
            .with_field(key);
    }
}

stroke read_file_stroke(const toml_table& t, const std::filesystem::path& folder)
{
    const double intensity_max = t.number("intensity_max", detail::bounds_of::intensity_max).value_or(1.0);
    std::vector<stroke> all = at_key(
        t, "file", [&] { return load_strokes(folder / *t.text("file"), intensity_max); }); // relative, or not
    if (all.size() != 1)
        t.fail("file", fmt::format("there are {} strokes in it", all.size()), "a motion is one stroke");
    return std::move(all.front());
}

stroke along_path(const toml_table& t, std::optional<double> duration_s, std::optional<double> speed_mm_s)
{
    return at_key(t, "path", [&] {
        const path way = path::from_svg(*t.text("path"));
        const double usual_s = way.length_mm() / speed_mm_s.value_or(default_speed_mm_s);
        return stroke{"path", trajectory::along(way, duration_s.value_or(usual_s)), {}, {}, {}};
    });
}

// Finds the option of a method that a key stands for, with its unit or without.
const options::option& find_method_option(const toml_table::said_key& k)
{
    const options::option* o = options::find(k.key);
    if (o == nullptr)
        o = options::find_field(k.key);
    if (o != nullptr && (o->where & options::in_method) != 0)
        return *o;
    const std::vector<std::string> names = options::dashed_names(options::in_method);
    std::vector<std::string_view> known(names.begin(), names.end());
    known.insert(known.begin(), "name");
    throw detail::unknown_key(k.key_at, k.key, "[[method]]", known);
}

constexpr std::array own_words{options::own_word{"level_dbfs", "level.dbfs"},
                               options::own_word{"sl_db", "level.sl_db"}, options::own_word{"fit=true", ""}};

std::string write_choice(const options::option& o, std::string_view value)
{
    if (value.empty())
        return std::string(o.field_name());
    const char* quote = o.what == options::kind::flag ? "" : "\"";
    return fmt::format("the method's {}, {}{}{},", options::dashed(o), quote, value, quote);
}

constexpr unsigned most_trials = 10000;

// Returns the default question in English, if there is one for the attribute.
std::string usual_question(const run_definition& r)
{
    const bool similar = r.attribute == "similarity";
    if (!similar && r.attribute != "uniformity" && r.outline.task != task_kind::identify)
        return {};
    if (r.outline.task == task_kind::choose)
        return similar ? "Which of the two was more like the target?" : "Which of the two was more even?";
    if (r.outline.task == task_kind::rate)
        return similar ? "How much was it like the target?" : "How even was it?";
    return "Which movement was it?";
}

// Returns the places in `all` that a run names, in the order of `all`; every place if it names none.
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

} // namespace

std::string name_in(const toml_table& t, std::string_view key)
{
    std::string text = t.need(t.text(key), key);
    const bool controls =
        std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; });
    if (controls || text == "n/a" || text.front() == ' ' || text.back() == ' ')
        t.fail(key, fmt::format("{} is no such name: {}", detail::shown(*t.node(key)), t.title()),
               "any but n/a, on one line, without tabs, not in blanks");
    return text;
}

bool is_mirrored(const toml_table& motion)
{
    return motion.boolean("mirror").value_or(false);
}

motion_definition read_motion(const toml_table& t, const std::filesystem::path& folder)
{
    t.only({"name", "preset", "path", "file", "duration", "duration_s", "speed", "speed_mm_s",
            "intensity_max", "mirror"});
    const std::string_view kind = t.one_of({"preset", "path", "file"});
    if (kind != "file" && t.has("intensity_max"))
        t.fail("intensity_max", fmt::format("{} has no file", t.title()),
               "it is the scale of a recording's intensities");
    const std::string_view duration_key = spelled(t, "duration", "duration_s");
    const std::string_view speed_key = spelled(t, "speed", "speed_mm_s");
    const auto duration = t.number(duration_key, detail::bounds_of::duration_s);
    const auto speed = t.number(speed_key, detail::bounds_of::speed_mm_s);
    if (duration && speed)
        t.fail(speed_key, fmt::format("{} has both {} and {}", t.title(), duration_key, speed_key),
               "keep one of them");
    stroke drawn = kind == "file"   ? read_file_stroke(t, folder)
                   : kind == "path" ? along_path(t, duration, speed)
                                    : at_key(t, "preset", [&] { return preset_stroke(*t.text("preset")); });
    if (duration)
        drawn.motion = at_key(t, duration_key, [&] { return drawn.motion.with_duration(*duration); });
    else if (speed && drawn.motion.length_mm() > 0.0)
        drawn.motion = at_key(t, speed_key, [&] { return drawn.motion.with_speed(*speed); });
    drawn.start_s.reset();                                // it is played alone
    drawn.choices = {.level_db = drawn.choices.level_db}; // methods choose the rest
    return {name_in(t, "name"), std::move(drawn), is_mirrored(t), t.where()};
}

method_definition read_method(const toml_table& t)
{
    options::wishes w;
    w.place = options::in_method;
    for (const toml_table::said_key& k : t.entries()) {
        if (k.key == "name")
            continue;
        const options::option& o = find_method_option(k);
        if (w.gives(o))
            t.fail(k.key, fmt::format("{} says {} twice", t.title(), o.name), "keep one of them");
        at_key(t, k.key, [&] { options::give(w, o, options::read_value(o, t.plain(*k.value, k.key))); });
    }
    at_key(t, "name", [&] { options::settle(w); });
    return {name_in(t, "name"), w.plan, t.where()};
}

std::string in_definition_words(std::string_view hint)
{
    return options::spell(hint, {write_choice, options::in_method, own_words});
}

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
    o.file_name = make_file_name(o.name);
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
            "break_s", "motions", "methods", "simulate_as", "min_response_s"});
    run_definition r = read_run_outline(t, d);
    // Some disks treat capitals and small letters as equal.
    for (const run_definition& other : d.runs)
        if (in_small_letters(other.outline.file_name) == in_small_letters(r.outline.file_name))
            t.fail(fmt::format("the runs \"{}\" and \"{}\" differ in capitals only", other.outline.name,
                               r.outline.name),
                   "another name: on some disks their files would be one");
    for (const std::string_view key : {"scale", "labels"})
        if (r.outline.task != task_kind::rate && t.has(key))
            t.fail(key, fmt::format("{} is of runs that rate", key), "leave it out, or task = \"rate\"");
    if (t.has("attribute") || r.outline.task != task_kind::identify)
        r.attribute = name_in(t, "attribute");
    const bool known = r.attribute == "similarity" || r.attribute == "uniformity";
    r.simulate_as = t.choice("simulate_as", {"similarity", "uniformity"}).value_or(known ? r.attribute : "");
    r.question = t.text("question").value_or(usual_question(r));
    if (r.question.empty())
        t.need(std::optional<std::string>{}, "question");
    r.min_response_s = t.number("min_response_s", {0.0, 10.0}).value_or(r.min_response_s);
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
