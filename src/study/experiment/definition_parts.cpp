// SPDX-License-Identifier: MIT
#include "study/experiment/definition.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/suggest.hpp"
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

// What the library refuses, with the place in the definition.
template <class F>
auto at_key(const toml_table& t, std::string_view key, F make)
{
    try {
        return make();
    } catch (const error& e) {
        const error said = options::spell(e, {write_key});
        throw error(e.kind(), t.where(key), fmt::format("{}: {}", said.subject(), said.why()), said.hint())
            .with_field(key);
    }
}

stroke read_file_stroke(const toml_table& t, const std::filesystem::path& folder)
{
    std::vector<stroke> all =
        at_key(t, "file", [&] { return load_strokes(folder / *t.text("file")); }); // relative, or not
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

motion_definition read_motion(const toml_table& t, const std::filesystem::path& folder)
{
    t.only({"name", "preset", "path", "file", "duration", "duration_s", "speed", "speed_mm_s"});
    const std::string_view kind = t.one_of({"preset", "path", "file"});
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
    return {name_in(t, "name"), std::move(drawn), t.where()};
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

} // namespace tactor::study
