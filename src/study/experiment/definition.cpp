// SPDX-License-Identifier: MIT
#include "study/experiment/definition.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/error.hpp>

#include "files/text_file.hpp"
#include "files/toml_reader.hpp"

namespace tactor::study {
namespace {

namespace fs = std::filesystem;
using detail::toml_table;

constexpr std::size_t most_bytes_of_text = std::size_t{1} << 20;

struct extent {
    const fs::path* folder = nullptr; ///< of files that the array and the motions name; null: leave them out
    bool outline_only = false;        ///< pass over all else, as other programs may write it
};

// Returns a preset's name, or the file beside the definition.
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

// Reads one time, or the least and the greatest of a pause that is drawn.
rest_range read_rest(const toml_table& t)
{
    constexpr detail::bounds possible{0.0, 60.0};
    const toml::node* n = t.node("rest_s");
    if (n == nullptr || !n->is_array()) {
        const double rest_s = t.number("rest_s", possible).value_or(0.0);
        return {rest_s, rest_s};
    }
    std::vector<double> range;
    for (const toml::node& one : *n->as_array())
        range.push_back(t.to_number(one, "rest_s", possible));
    if (range.size() != 2 || range[0] > range[1])
        t.fail("rest_s", fmt::format("rest_s is {}", detail::shown(*n)),
               "one time, or the least and the greatest: [2, 4]");
    return {range[0], range[1]};
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

void read_head(const toml_table& root, const extent& e, experiment_definition& d)
{
    const auto t = root.table("experiment", "[experiment]", "[experiment]");
    if (!t)
        root.fail("there is no [experiment]", "it begins with one");
    d.name = name_in(*t, "name");
    if (e.outline_only)
        return;
    t->only({"name", "title", "array", "level", "gap_s", "rest_s", "seed", "consent", "authors"});
    d.title = t->has("title") ? name_in(*t, "title") : d.name;
    if (t->has("array") && e.folder != nullptr)
        d.array = array_in(*t, *e.folder);
    read_level(*t, d);
    d.gap_s = t->number("gap_s", {0.0, 60.0}).value_or(d.gap_s);
    d.rest = read_rest(*t);
    d.seed = read_seed(*t);
    d.consent = t->text("consent").value_or("");
    d.authors = texts_in(*t, "authors", 1000);
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
    m.level_dbfs = t->number("level_dbfs", detail::bounds_of::masker_dbfs).value_or(m.level_dbfs);
    if (m.noise != noise_kind::none) {
        const double most = greatest_noise_dbfs(noise_options(m, {}).color);
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

std::vector<toml_table> need_tables(const toml_table& root, std::string_view key)
{
    std::vector<toml_table> all = root.tables(key);
    if (all.empty())
        root.fail(fmt::format("there is no [[{}]]", key), "an experiment has at least one");
    return all;
}

template <class T, class Read>
std::vector<T> read_all(const toml_table& root, std::string_view key, const Read& read)
{
    std::vector<T> all;
    for (const toml_table& t : need_tables(root, key)) {
        T one = read(t);
        if (std::any_of(all.begin(), all.end(), [&](const T& other) { return other.name == one.name; }))
            t.fail("name", fmt::format("the {} \"{}\" is there twice", key, one.name),
                   "each has a name of its own");
        all.push_back(std::move(one));
    }
    return all;
}

experiment_definition definition_in(std::string_view toml, const std::string& name, const extent& e)
{
    const toml::table document = detail::parse_toml(
        toml, name,
        {"tactor-experiment(5)", "the definition of an experiment is TOML, see tactor-experiment(5)"});
    const toml_table root(document, "the file", name);
    experiment_definition d;
    d.text = toml;
    if (!e.outline_only)
        root.only({"experiment", "masking", "page", "motion", "method", "run"});
    read_head(root, e, d);
    if (!e.outline_only) {
        d.masking = read_masking(root);
        d.page = read_page(root);
    }
    d.motions = read_all<motion_definition>(root, "motion", [&](const toml_table& t) {
        return e.folder != nullptr ? read_motion(t, *e.folder)
                                   : motion_definition{name_in(t, "name"), {}, is_mirrored(t), t.where()};
    });
    d.methods = read_all<method_definition>(root, "method", [&](const toml_table& t) {
        return e.outline_only ? method_definition{name_in(t, "name"), {}, t.where()} : read_method(t);
    });
    for (const toml_table& t : need_tables(root, "run"))
        d.runs.push_back(e.outline_only ? read_run_outline(t, d) : read_run_definition(t, d));
    return d;
}

constexpr std::array english{
    page_word{"language", "en"},
    page_word{"agree", "Do you agree?"},
    page_word{"yes", "Yes"},
    page_word{"no", "No"},
    page_word{"walk", "Each place vibrates once, in turn."},
    page_word{"felt", "Did you feel it?"},
    page_word{"again", "Once more"},
    page_word{"back", "The one before"},
    page_word{"begin", "Begin"},
    page_word{"practice", "Practice"},
    page_word{"part", "Part"},
    page_word{"target", "Watch how it moves."},
    page_word{"stimulus", "Attend to your hand."},
    page_word{"rest", "A break"},
    page_word{"pause", "A pause"},
    page_word{"wait", "One moment, please."},
    page_word{"over", "That was all. Thank you."},
    page_word{"elsewhere", "This session goes on in another window."},
    page_word{"offline", "There is no connection. Please tell the experimenter."},
    page_word{"full_screen", "Full screen"},
    // On a terminal only.
    page_word{"or", "or"},
    page_word{"to", "to"},
    page_word{"any_key_begins", "Any key begins."},
    page_word{"any_key_ends", "Any key ends."},
    page_word{"trial", "Trial"},
    page_word{"repeated", "again"},
    page_word{"later", "Once more, later."},
    page_word{"no_answer", "That is no answer"},
    // On the page of calibrate only.
    page_word{"calibrate_choose",
              "There are two intervals, one of which vibrates. Which one? Guess where you do not know."},
    page_word{"calibrate_interval", "Interval"},
    page_word{"calibrate_which", "Which one vibrated?"},
    page_word{"calibrate_right", "That was right."},
    page_word{"calibrate_wrong", "That was wrong."},
    page_word{"calibrate_adjust", "Something vibrates again and again. Set it so that you just feel it."},
    page_word{"calibrate_set", "Set it so that you just feel it."},
    page_word{"calibrate_much_weaker", "Much weaker"},
    page_word{"calibrate_weaker", "Weaker"},
    page_word{"calibrate_stronger", "Stronger"},
    page_word{"calibrate_much_stronger", "Much stronger"},
    page_word{"calibrate_that_is_it", "That is it"},
    page_word{"calibrate_not_felt", "Not felt at any level"},
};

std::size_t find_word(std::string_view key)
{
    const auto has_key = [&](const page_word& w) { return w.key == key; };
    return static_cast<std::size_t>(std::find_if(english.begin(), english.end(), has_key) - english.begin());
}

} // namespace

std::string_view to_string(noise_kind k) noexcept
{
    return k == noise_kind::white ? "white" : k == noise_kind::pink ? "pink" : "none";
}

experiment_definition read_definition(std::string_view toml, const std::string& name, const fs::path& folder)
{
    return definition_in(toml, name, {.folder = &folder});
}

experiment_definition read_design(std::string_view toml, const std::string& name)
{
    return definition_in(toml, name, {});
}

experiment_outline read_outline(std::string_view toml, const std::string& name)
{
    return make_outline(definition_in(toml, name, {.outline_only = true}));
}

experiment_outline make_outline(const experiment_definition& d)
{
    experiment_outline e{d.name};
    for (const run_definition& r : d.runs)
        e.runs.push_back(r.outline);
    return e;
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

masking_options noise_options(const masking_definition& m, std::string seed)
{
    return {.color = m.noise == noise_kind::pink ? noise_color::pink : noise_color::white,
            .level_dbfs = m.level_dbfs,
            .fade_s = m.fade_s,
            .seed = std::move(seed)};
}

std::span<const page_word> page_words_in_english()
{
    return english;
}

page_words::page_words() : set_(english.size(), false)
{
    for (const page_word& w : english)
        texts_.emplace_back(w.english);
}

const std::string& page_words::operator[](std::string_view key) const
{
    return texts_.at(find_word(key));
}

void page_words::set(std::string_view key, std::string text)
{
    texts_.at(find_word(key)) = std::move(text);
    set_.at(find_word(key)) = true;
}

std::vector<std::string_view> page_words::missing() const
{
    std::vector<std::string_view> all;
    for (std::size_t i = 0; i < english.size(); ++i)
        if (!set_[i])
            all.push_back(english[i].key);
    return all.size() < english.size() ? all : std::vector<std::string_view>();
}

page_words load_page_words(const std::string& file)
{
    const detail::whole_text text = detail::read_text_file(file, most_bytes_of_text);
    const toml::table document = detail::parse_toml(text, file);
    const toml_table root(document, "the file", file);
    if (!root.has("page"))
        root.fail("there is no [page]", "a definition of an experiment with the participant's words");
    return read_page(root);
}

std::string missing_words(const experiment_definition& d)
{
    const std::vector<std::string_view> missing = d.page.missing();
    return missing.empty() ? ""
                           : fmt::format("[page] lacks {}, which stay English", fmt::join(missing, ", "));
}

} // namespace tactor::study
