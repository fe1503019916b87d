// SPDX-License-Identifier: MIT
#include "study/experiment/read_definition.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <memory>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/error.hpp>
#include <tactor/waveform.hpp>

#include "core/start_times.hpp"
#include "core/suggest.hpp"
#include "core/words.hpp"
#include "files/text_file.hpp"
#include "files/toml_reader.hpp"
#include "options/option.hpp"
#include "options/resolve.hpp"
#include "session/piece.hpp"
#include "study/experiment/trials.hpp"
#include "study/experiment/variation.hpp"
#include "study/tasks/task.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

using detail::toml_table;

// Returns the spelling that the table uses for a key: plain, or with a unit as in stroke files.
// Throws error (bad_input) if the table has both spellings.
std::string_view find_spelling(const toml_table& t, std::string_view plain, std::string_view with_unit)
{
    if (t.has(plain) && t.has(with_unit))
        t.fail(with_unit, fmt::format("{} has both {} and {}", t.title(), plain, with_unit),
               "keep one of them");
    return t.has(with_unit) ? with_unit : plain;
}

std::string format_key_value(const options::option& o, std::string_view value)
{
    const bool is_text = o.what == options::kind::choice || o.what == options::kind::text;
    const char* quote = is_text ? "\"" : "";
    return value.empty() ? std::string(o.name) : fmt::format("{} = {}{}{}", o.name, quote, value, quote);
}

// Calls `make` and adds the place in the definition to its errors.
template <class F>
auto add_key_to_errors(const toml_table& t, std::string_view key, F make)
{
    try {
        return make();
    } catch (const error& e) {
        const error worded = options::spell(e, {format_key_value});
        const bool is_key = e.subject() == e.field(); // the definition may spell the key differently
        throw error(e.kind(), t.where(key),
                    fmt::format("{}: {}", is_key ? key : worded.subject(), worded.why()), worded.hint());
    }
}

// Shifts the strokes of a file so that the first starts at 0: a stimulus must not begin with a pause.
void remove_initial_pause(std::vector<stroke>& strokes)
{
    const std::vector<stroke_span> spans = list_spans(strokes);
    const double first_s = std::ranges::min(spans, {}, &stroke_span::start_s).start_s;
    for (stroke& s : strokes)
        if (s.start_s && s.anchor.from == start_from_kind::piece)
            *s.start_s -= first_s;
    if (strokes.front().start_s == 0.0)
        strokes.front().start_s.reset();
}

std::vector<stroke> read_file_strokes(const toml_table& t, const std::filesystem::path& folder)
{
    const double intensity_max = t.number("intensity_max", detail::bounds_of::intensity_max).value_or(1.0);
    return add_key_to_errors(t, "file", [&] {
        std::vector<stroke> all = load_strokes(folder / *t.text("file"), intensity_max,
                                               t.text("position").value_or("")); // place on the body
        remove_initial_pause(all);
        return all;
    });
}

// Keys of a stroke: three kinds of source, and two keys that apply to a file only.
constexpr std::array<std::string_view, 5> stroke_keys{"preset", "path", "file", "intensity_max", "position"};

std::vector<stroke> along_path(const toml_table& t, std::optional<double> duration_s,
                               std::optional<double> speed_mm_s)
{
    return add_key_to_errors(t, "path", [&] {
        stroke s = session::path_stroke(*t.text("path"), duration_s, speed_mm_s.value_or(default_speed_mm_s));
        s.speed_mm_s.reset(); // so that changing the length keeps the duration
        return std::vector{std::move(s)};
    });
}

// Reads the strokes of a motion or a method. Returns an empty list if the table has no preset, path or file.
std::vector<stroke> read_strokes(const toml_table& t, const std::filesystem::path& folder,
                                 std::optional<double> duration_s, std::optional<double> speed_mm_s)
{
    for (const char* key : {"intensity_max", "position"})
        if (!t.has("file") && t.has(key))
            t.fail(key, fmt::format("{} has no file", t.title()),
                   fmt::format("add file, or leave out {}", key));
    const std::vector<std::string_view> kinds(stroke_keys.begin(), stroke_keys.begin() + 3);
    if (std::none_of(kinds.begin(), kinds.end(), [&t](std::string_view key) { return t.has(key); }))
        return {};
    const std::string_view kind = t.one_of(kinds);
    std::vector<stroke> all =
        kind == "file" ? read_file_strokes(t, folder)
        : kind == "path"
            ? along_path(t, duration_s, speed_mm_s)
            : add_key_to_errors(t, "preset", [&] { return std::vector{preset_stroke(*t.text("preset"))}; });
    for (stroke& s : all)
        s.choices = {.level_db = s.choices.level_db}; // methods give the other options
    return all;
}

// Finds the option that a key of [[method]] names, with or without a unit. Throws error (bad_input) for
// unknown keys.
const options::option& find_method_option(const toml_table::key_value& k)
{
    const options::option* o = options::find(k.key);
    if (o != nullptr && (o->where & options::in_method) != 0)
        return *o;
    const std::vector<std::string> names = options::dashed_names(options::in_method);
    std::vector<std::string_view> known(names.begin(), names.end());
    known.insert(known.begin(), stroke_keys.begin(), stroke_keys.end());
    known.insert(known.begin(), "name");
    throw detail::unknown_key(k.key_at, k.key, "[[method]]", known);
}

// Sets an option of a method. The name of a waveform file is relative to `folder`. If `folder` is null, only
// stores the name, because the file may no longer exist.
void set_method_option(options::option_values& w, const options::option& o, options::value v,
                       const std::filesystem::path* folder)
{
    auto* text = std::get_if<std::string>(&v);
    if (text != nullptr && o.name == "waveform" && waveform_names_file(*text)) {
        if (folder == nullptr) {
            w.plan.wave.kind = waveform_kind::recording;
            w.plan.wave.recorded = std::make_shared<const recording>(recording{.file = *text});
            w.by_user.set(options::index(o));
            return;
        }
        *text = (*folder / *text).string();
    }
    options::give(w, o, v);
}

constexpr std::array own_words{options::own_word{"fit=true", ""},
                               options::own_word{"level_dbfs", "level.dbfs"},
                               options::own_word{"sl_db", "level.sl_db"}};

std::string format_method_option(const options::option& o, std::string_view value)
{
    if (value.empty())
        return std::string(o.field_name());
    const char* quote = o.what == options::kind::flag ? "" : "\"";
    return fmt::format("{} = {}{}{} in [[method]]", options::dashed(o), quote, value, quote);
}

// Returns the indices of the items of `all` that a table names, in the order of `all`. Returns all indices if
// the key is missing.
template <class T>
std::vector<std::size_t> read_item_indices(const toml_table& t, std::string_view key,
                                           const std::vector<T>& all)
{
    const toml::array* list = t.list(key, "names");
    if (list != nullptr && list->empty())
        t.fail(key, fmt::format("{} is empty", key), "give names in quotes, in brackets");
    std::vector<std::string> known;
    for (const T& one : all)
        known.push_back(one.name);
    std::vector<bool> wanted(all.size(), list == nullptr);
    for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
        const auto at = std::find(known.begin(), known.end(), list->get(i)->value_exact<std::string>());
        if (at == known.end())
            detail::fail_at(t.where(*list->get(i)), fmt::format("{} has an undefined name", key),
                            fmt::format("use one of {}", fmt::join(known, ", ")));
        wanted[static_cast<std::size_t>(at - known.begin())] = true;
    }
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < all.size(); ++i)
        if (wanted[i])
            places.push_back(i);
    return places;
}

template <class T>
std::vector<std::string> select_names(const std::vector<std::size_t>& places, const std::vector<T>& all)
{
    std::vector<std::string> names;
    for (const std::size_t i : places)
        names.push_back(all[i].name);
    return names;
}

namespace fs = std::filesystem;

struct extent {
    const fs::path* folder = nullptr; ///< folder of files; if null, array and strokes are not read
    bool outline_only = false;        ///< true to read only what the analysis needs
};

// Returns the array as the name of a preset, or as the path of a file in the definition's folder.
std::string read_array_name(const toml_table& t, const fs::path& folder)
{
    std::string text = *t.text("array");
    const std::vector<std::string>& presets = array_presets();
    if (std::find(presets.begin(), presets.end(), text) != presets.end())
        return text;
    std::error_code ignored;
    if (!fs::exists(folder / text, ignored))
        t.fail("array", fmt::format("there is no array '{}'", text),
               fmt::format("use {}, or name a file", fmt::join(presets, ", ")));
    return (folder / text).string();
}

void read_level(const toml_table& t, experiment_definition& d)
{
    const auto level = t.table("level", "level", "level = { sl_db = 7 } or { dbfs = -18 }");
    if (!level)
        return;
    level->refuse_other_keys({"sl_db", "dbfs"});
    const std::string_view kind = level->one_of({"sl_db", "dbfs"});
    if (kind == "dbfs")
        d.level_dbfs = level->number(kind, {-200.0, 0.0});
    else
        d.sl_db = *level->number(kind, {-60.0, 100.0});
}

// Reads a fixed pause, or the bounds of a random pause.
rest_range read_rest(const toml_table& t)
{
    constexpr detail::bounds possible{0.0, 60.0};
    const toml::node* n = t.node("rest_s");
    if (n == nullptr || !n->is_array()) {
        const double rest_s = t.number("rest_s", possible).value_or(0.0);
        return {rest_s, rest_s};
    }
    const std::vector<double> range = read_numbers(t, "rest_s", possible);
    if (range.size() != 2 || range[0] > range[1])
        t.fail("rest_s", fmt::format("rest_s is {}", detail::shown(*n)),
               "give one time, or the smallest and the largest: [2, 4]");
    return {range[0], range[1]};
}

std::optional<std::uint64_t> read_seed(const toml_table& t)
{
    constexpr std::int64_t most = (std::int64_t{1} << 53) - 1; // greatest integer that JSON keeps exactly
    const toml::node* n = t.node("seed");
    if (n == nullptr)
        return {};
    const auto v = n->value_exact<std::int64_t>();
    if (!v || *v < 0 || *v > most)
        t.fail("seed", fmt::format("seed is {}", detail::shown(*n)),
               fmt::format("give a whole number from 0 to {}", most));
    return static_cast<std::uint64_t>(*v);
}

// Reads a one-line text that a cell of a table can hold.
std::string name_in(const toml_table& t, std::string_view key)
{
    std::string text = t.need(t.text(key), key);
    const bool controls =
        std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; });
    if (controls || text == "n/a" || text.front() == ' ' || text.back() == ' ')
        t.fail(key, fmt::format("{} is {}", key, detail::shown(*t.node(key))),
               "use one line of text without tabs and without blanks at its ends, but not n/a");
    return text;
}

void read_head(const toml_table& root, const extent& e, experiment_definition& d)
{
    const auto t = root.table("experiment", "[experiment]", "[experiment]");
    if (!t)
        root.fail("there is no [experiment]", "add it at the start");
    d.outline.name = name_in(*t, "name");
    d.outline.sessions = t->whole("sessions", 1, 99).value_or(1);
    if (e.outline_only)
        return;
    t->refuse_other_keys({"name", "title", "array", "level", "gap_s", "rest_s", "order", "seed", "consent",
                          "authors", "sessions"});
    d.title = t->has("title") ? name_in(*t, "title") : d.outline.name;
    if (t->has("array") && e.folder != nullptr)
        d.array = read_array_name(*t, *e.folder);
    read_level(*t, d);
    d.gap_s = t->number("gap_s", {0.0, 60.0}).value_or(d.gap_s);
    d.rest = read_rest(*t);
    d.order = t->choice("order", {"williams", "latin", "random"}).value_or(d.order);
    d.seed = read_seed(*t);
    d.consent = t->text("consent").value_or("");
    d.authors = t->texts("authors", 1000);
}

masking_definition read_masking(const toml_table& root)
{
    masking_definition m;
    const auto t = root.table("masking", "[masking]", "[masking]");
    if (!t)
        return m;
    t->refuse_other_keys({"noise", "level_dbfs", "fade_s", "while"});
    const std::string noise = t->choice("noise", {"white", "pink", "none"}).value_or("white");
    masking_options o{.color = noise == "pink" ? noise_color::pink : noise_color::white};
    o.level_dbfs = t->number("level_dbfs", detail::bounds_of::masker_dbfs).value_or(o.level_dbfs);
    const double most = max_noise_dbfs(o.color);
    if (noise != "none" && o.level_dbfs > most)
        t->fail("level_dbfs",
                fmt::format("level_dbfs is {}, but the peaks of {} noise reach full scale at {} dBFS",
                            o.level_dbfs, noise, most),
                "lower the level, and turn up the headphone amplifier");
    o.fade_s = t->number("fade_s", {0.0, 10.0}).value_or(o.fade_s);
    m.through_run = t->choice("while", {"stimulus", "run"}).value_or("stimulus") == "run";
    if (noise != "none")
        m.noise = std::move(o);
    return m;
}

// Returns true if the motion is mirrored for left hands.
motion_definition read_motion(const toml_table& t, const std::filesystem::path& folder)
{
    t.refuse_other_keys({"name", "preset", "path", "file", "duration", "duration_s", "speed", "speed_mm_s",
                         "intensity_max", "position", "mirror"});
    static_cast<void>(t.one_of({"preset", "path", "file"})); // throws if there is no stroke
    const std::string_view duration_key = find_spelling(t, "duration", "duration_s");
    const std::string_view speed_key = find_spelling(t, "speed", "speed_mm_s");
    const auto duration = t.number(duration_key, detail::bounds_of::duration_s);
    const auto speed = t.number(speed_key, detail::bounds_of::speed_mm_s);
    if (duration && speed)
        t.fail(speed_key, fmt::format("{} has both {} and {}", t.title(), duration_key, speed_key),
               "keep one of them");
    std::vector<stroke> strokes = read_strokes(t, folder, duration, speed);
    for (stroke& s : strokes)
        if (duration)
            s.motion = add_key_to_errors(t, duration_key, [&] { return s.motion.with_duration(*duration); });
        else if (speed && s.motion.length_mm() > 0.0)
            s.motion = add_key_to_errors(t, speed_key, [&] { return s.motion.with_speed(*speed); });
    return {name_in(t, "name"), std::move(strokes), t.boolean("mirror").value_or(false), t.where()};
}

// Reads a method. `d` must already have the level. `folder`: folder of the method's files; if null, the files
// are not read.
method_definition read_method(const toml_table& t, const experiment_definition& d, const fs::path* folder)
{
    options::option_values w;
    w.place = options::in_method;
    if (!d.level_dbfs)
        w.render.sl_db = d.sl_db; // the method may replace this level below
    std::map<std::size_t, written_key> keys;
    for (const toml_table::key_value& k : t.entries()) {
        if (k.key == "name" || std::find(stroke_keys.begin(), stroke_keys.end(), k.key) != stroke_keys.end())
            continue;
        const options::option& o = find_method_option(k);
        if (!keys.emplace(options::index(o), written_key{std::string(k.key), t.where(k.key)}).second)
            t.fail(k.key, fmt::format("{} has {} twice", t.title(), o.name), "keep one of them");
        add_key_to_errors(t, k.key, [&] {
            set_method_option(w, o, options::read_value(o, t.read_scalar(*k.value, k.key)), folder);
        });
    }
    try {
        options::resolve(w);
    } catch (const error& e) {
        add_key_to_errors(t, keys.at(options::index(*options::find(e.field()))).key,
                          [&e] { throw error(e); });
    }
    std::vector<stroke> strokes;
    if (folder != nullptr)
        strokes = read_strokes(t, *folder, w.duration_s, w.speed_mm_s);
    return {name_in(t, "name"), std::move(w), std::move(strokes), t.where(), std::move(keys)};
}

// Throws error (bad_input) if a run has too few motions or methods for its task. `o`: the whole run, or the
// part of the run that a group plays.
void check_cells(const toml_table& t, const run_outline& o)
{
    if (o.motions.empty() || o.methods.empty())
        t.fail(fmt::format("{} has no motion or no method", o.name),
               "leave this run out of runs, or name motions and methods for it");
    find_run_task(o).check(t, o);
}

constexpr std::size_t most_texts = 1000; // read_definition() checks stricter bounds

// Reads the numbers of the sessions in which a run is played. Empty if all sessions play the run.
std::vector<unsigned> read_sessions(const toml_table& t, unsigned sessions)
{
    std::vector<unsigned> all;
    for (const double n : read_numbers(t, "sessions", {1.0, static_cast<double>(sessions)})) {
        if (n != std::floor(n) || std::ranges::count(all, static_cast<unsigned>(n)) != 0)
            t.fail("sessions",
                   n != std::floor(n) ? fmt::format("{} is not a whole number", n)
                                      : fmt::format("session {} occurs twice", n),
                   "give whole numbers, each once, such as [1, 3]");
        all.push_back(static_cast<unsigned>(n));
    }
    if (t.has("sessions") && all.empty())
        t.fail("sessions", "sessions is empty, so no session has the run",
               "leave out sessions to play the run in all");
    return all;
}

// Reads the parts of a [[run]] that the analysis needs. `d` must already have the motions, methods and
// earlier runs.
run_definition read_run_outline(const toml_table& t, const experiment_definition& d)
{
    run_definition r;
    r.where = t.where();
    run_outline& o = r.outline;
    o.name = name_in(t, "name");
    o.file_name = make_file_name(o.name);
    if (o.file_name.empty())
        t.fail("name", "a run's name has no letter or digit",
               "add letters or digits: the run's files are named by them");
    for (const run_definition& other : d.runs)
        if (other.outline.file_name == o.file_name)
            t.fail("name",
                   fmt::format("the files of the runs \"{}\" and \"{}\" would have the same name",
                               other.outline.name, o.name),
                   "make their letters and digits differ");
    o.task = &read_task(t);
    o.sessions = read_sessions(t, d.outline.sessions);
    r.motions = read_item_indices(t, "motions", d.motions);
    r.methods = read_item_indices(t, "methods", d.methods);
    o.motions = select_names(r.motions, d.motions);
    o.methods = select_names(r.methods, d.methods);
    o.labels = t.texts("labels", most_texts);
    o.choices = t.texts("choices", most_texts);
    find_run_task(o).read_outline(t, r);
    const std::string attribute = t.text("attribute").value_or("");
    const std::size_t kind = attribute == "similarity" ? 0 : attribute == "uniformity" ? 1 : 2;
    o.question = t.text("question").value_or(std::string(find_run_task(o).properties().questions[kind]));
    check_cells(t, o);
    return r;
}

// Throws error (bad_input) for unknown keys and for keys that only other tasks have.
void check_keys(const toml_table& t, const task& own)
{
    std::vector<std::string_view> known{"name",        "task",           "attribute", "question",
                                        "animation",   "trials",         "practice",  "break_s",
                                        "motions",     "methods",        "blocks",    "max_in_a_row",
                                        "simulate_as", "min_response_s", "sessions"};
    std::map<std::string_view, std::vector<std::string>> users;
    for (const task* one : list_tasks())
        for (const std::string_view key : one->properties().keys)
            users[key].push_back(fmt::format("\"{}\"", one->name()));
    users["training"] = users["feedback"]; // training is practice with feedback
    for (const auto& [key, tasks] : users)
        known.push_back(key);
    t.refuse_other_keys(known);
    const std::string named = fmt::format("\"{}\"", own.name());
    for (const auto& [key, tasks] : users)
        if (t.has(key) && std::ranges::count(tasks, named) == 0)
            t.fail(key, fmt::format("{} does not apply to runs with task {}", key, named),
                   fmt::format("leave out {}, or set task to {}{}", key, tasks.size() > 1 ? "one of " : "",
                               fmt::join(tasks, ", ")));
}

run_definition read_run_definition(const toml_table& t, experiment_definition& d,
                                   std::vector<method_definition>& variants)
{
    const task& own = read_task(t);
    check_keys(t, own);
    run_definition r = read_run_outline(t, d);
    // Some file systems ignore case.
    for (const run_definition& other : d.runs)
        if (to_lower_case(other.outline.file_name) == to_lower_case(r.outline.file_name))
            t.fail(fmt::format("the runs \"{}\" and \"{}\" would have the same file on some disks",
                               other.outline.name, r.outline.name),
                   "use names whose letters and digits differ in more than capitals");
    make_variants(t, r, d.methods, variants);
    if (t.has("attribute"))
        r.attribute = name_in(t, "attribute");
    own.read(t, r);
    const bool is_known = r.attribute == "similarity" || r.attribute == "uniformity";
    r.simulate_as =
        t.choice("simulate_as", {"similarity", "uniformity"}).value_or(is_known ? r.attribute : "");
    if (r.outline.question.empty())
        t.need(std::optional<std::string>{}, "question");
    r.min_response_s = t.number("min_response_s", {0.0, 10.0}).value_or(r.min_response_s);
    r.animation = t.boolean("animation").value_or(false);
    if (r.outline.trials == 0)
        t.need(std::optional<unsigned>{}, "trials");
    r.practice = t.whole("practice", 0, 10000).value_or(0);
    r.feedback = t.boolean("feedback").value_or(false);
    if (const auto training = t.whole("training", 1, 10000)) {
        if (t.has("practice"))
            t.fail("training", fmt::format("{} has both practice and training", t.title()),
                   "keep training to tell people whether they were right, or else practice");
        r.practice = *training;
        r.trains = true;
    }
    r.max_in_a_row =
        t.whole("max_in_a_row", 2, 100).value_or(r.max_in_a_row); // 1 would leave no order for catch trials
    if (t.has("choices") && r.outline.choices.size() != 2)
        t.fail("choices",
               fmt::format("choices has {}, but there are two answers",
                           counted(r.outline.choices.size(), "text")),
               "give one text for each answer");
    r.choices = t.has("choices") ? r.outline.choices : own.default_choices(d.page);
    r.break_s = t.number("break_s", {0.0, 86400.0}).value_or(0.0);
    r.blocks = t.choice("blocks", {"methods", "motions"}).value_or("");
    for (const planned_trial& cell : own.list_cells(r))
        r.stimuli = std::max(r.stimuli, cell.list_methods().size());
    return r;
}

// Reads a [[group]]. `d` must already have the runs.
group_outline read_group(const toml_table& t, const experiment_definition& d)
{
    group_outline g{name_in(t, "name"), d.outline.runs};
    const auto keep = [](std::vector<std::string>& names, const std::vector<std::string>& kept) {
        std::erase_if(names,
                      [&kept](const std::string& name) { return std::ranges::count(kept, name) == 0; });
    };
    const std::vector<std::size_t> runs = read_item_indices(t, "runs", d.outline.runs);
    const std::vector<std::string> motions =
        select_names(read_item_indices(t, "motions", d.motions), d.motions);
    const std::vector<std::string> methods =
        select_names(read_item_indices(t, "methods", d.methods), d.methods);
    for (std::size_t i = 0; i < g.runs.size(); ++i) {
        run_outline& r = g.runs[i];
        keep(r.motions, motions);
        keep(r.methods, methods);
        if (std::ranges::count(runs, i) != 0)
            check_cells(t, r);
        else
            r.motions.clear();
    }
    return g;
}

std::vector<toml_table> need_tables(const toml_table& root, std::string_view key)
{
    std::vector<toml_table> all = root.tables(key);
    if (all.empty())
        root.fail(fmt::format("there is no [[{}]]", key), "add one");
    return all;
}

template <class T, class Read>
std::vector<T> read_all(const toml_table& root, std::string_view key, const Read& read)
{
    std::vector<T> all;
    for (const toml_table& t : need_tables(root, key)) {
        T one = read(t);
        if (std::any_of(all.begin(), all.end(), [&](const T& other) { return other.name == one.name; }))
            t.fail("name", fmt::format("the {} \"{}\" occurs twice", key, one.name),
                   fmt::format("give each {} its own name", key));
        all.push_back(std::move(one));
    }
    return all;
}

experiment_definition parse_definition(std::string_view toml, const std::string& name, const extent& e)
{
    const toml::table document = detail::parse_toml(
        toml, name, {"tactor-experiment(5)", "write the definition in TOML, see tactor-experiment(5)"});
    const toml_table root(document, "the file", name);
    experiment_definition d;
    d.text = toml;
    if (!e.outline_only)
        root.refuse_other_keys({"experiment", "masking", "page", "motion", "method", "run", "group"});
    read_head(root, e, d);
    if (!e.outline_only) {
        d.masking = read_masking(root);
        d.page = read_page(root);
    }
    d.motions = read_all<motion_definition>(root, "motion", [&](const toml_table& t) {
        return e.folder != nullptr
                   ? read_motion(t, *e.folder)
                   : motion_definition{
                         name_in(t, "name"), {}, t.boolean("mirror").value_or(false), t.where()};
    });
    d.methods = read_all<method_definition>(root, "method", [&](const toml_table& t) {
        return e.outline_only ? method_definition{name_in(t, "name"), {}, {}, t.where()}
                              : read_method(t, d, e.folder);
    });
    std::vector<method_definition> variants;
    for (const toml_table& t : need_tables(root, "run")) {
        if (t.text("task") == "questionnaire") {
            std::vector<questionnaire>& all = d.outline.questionnaires;
            all.push_back(read_questionnaire(t, all));
            continue;
        }
        d.runs.push_back(e.outline_only ? read_run_outline(t, d) : read_run_definition(t, d, variants));
        d.outline.runs.push_back(d.runs.back().outline);
    }
    if (d.runs.empty())
        root.fail("each [[run]] is a questionnaire", "add a run with trials");
    if (root.has("group"))
        d.outline.groups = read_all<group_outline>(root, "group", [&](const toml_table& t) {
            if (!e.outline_only)
                t.refuse_other_keys({"name", "array", "runs", "motions", "methods"});
            group_outline g = read_group(t, d);
            if (t.has("array") && e.folder != nullptr)
                d.group_arrays[g.name] = read_array_name(t, *e.folder);
            return g;
        });
    std::ranges::move(variants, std::back_inserter(d.methods));
    return d;
}

} // namespace

std::string reword_hint(std::string_view hint, bool own_level)
{
    const std::span<const options::own_word> own(own_words);
    return options::spell(hint, {format_method_option, options::in_method, own_level ? own.first(1) : own});
}

bool uses_thresholds(const experiment_definition& d)
{
    return !d.level_dbfs || std::any_of(d.methods.begin(), d.methods.end(),
                                        [](const method_definition& m) { return m.options.gives("sl"); });
}

experiment_definition read_definition(std::string_view toml, const std::string& name, const fs::path& folder)
{
    return parse_definition(toml, name, {.folder = &folder});
}

experiment_definition read_design(std::string_view toml, const std::string& name)
{
    return parse_definition(toml, name, {});
}

experiment_outline read_outline(std::string_view toml, const std::string& name)
{
    return parse_definition(toml, name, {.outline_only = true}).outline;
}

experiment_definition load_definition(const std::string& name_or_file)
{
    if (name_or_file == shipped_experiment)
        return read_definition(park2016_text(), name_or_file, {});
    std::error_code ignored;
    if (!fs::exists(name_or_file, ignored) && name_or_file.find_first_of("./") == std::string::npos)
        throw error(error_kind::bad_input, "experiment", fmt::format("there is no '{}'", name_or_file),
                    fmt::format("use {}, or name a file", shipped_experiment));
    const detail::whole_text text = detail::read_text_file(name_or_file, most_definition_bytes);
    return read_definition(text, name_or_file, fs::path(name_or_file).parent_path());
}

} // namespace tactor::study
