// SPDX-License-Identifier: MIT
#include "cli/option_words.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "options/settle.hpp"

namespace tactor::cli {
namespace {

struct translation {
    std::string_view field;
    std::string_view option;
};

// Words of the library that are no field of an option.
constexpr std::array<translation, 7> own_words{
    {{"measure its detection threshold", "run tactor calibrate"},
     {"force = true", "--force"},
     {"array = ", "--array "},
     {"config = FILE", "--config FILE"},
     {"wider = true leaves", "without a number of channels it leaves"},
     {"leave array out", "say no --array"},
     {"fit_strokes()", "--fit"}}};

bool in_a_word(char c)
{
    return c == '_' || c == '-' || c == '.' || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
           (c >= 'A' && c <= 'Z');
}

// Writes `to` for each `from` that is no part of a longer word.
void replace_words(std::string& text, std::string_view from, std::string_view to)
{
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + 1)) {
        const std::size_t end = at + from.size();
        const bool begins = at == 0 || !in_a_word(text[at - 1]);
        const bool ends = from.back() == ' ' || end == text.size() || !in_a_word(text[end]);
        if (begins && ends)
            text.replace(at, from.size(), to);
    }
}

// Only words that can mean nothing else: "soa_s", "timing = fit", "snap = true". `but_keys`: a file has keys
// of these names.
std::string replaced(std::string text, bool but_keys = false)
{
    for (const translation& t : own_words)
        replace_words(text, t.field, t.option);
    for (const options::option& o : options::all()) {
        if (but_keys && (o.where & options::in_stroke) != 0)
            continue;
        const std::string name = option_name(o);
        if (o.what == options::kind::flag)
            replace_words(text, fmt::format("{} = true", o.name), name);
        else if (o.what == options::kind::choice)
            replace_words(text, fmt::format("{} = ", o.name), name + " ");
        if (o.field_name().find('_') != std::string_view::npos)
            replace_words(text, o.field_name(), name);
    }
    return text;
}

// Whether the library calls only the option so.
bool is_option(const options::option& o)
{
    if (o.what == options::kind::flag)
        return false;
    return o.what != options::kind::text || (o.where & options::by_client) != 0 || o.choices != nullptr;
}

std::string subject(std::string_view what)
{
    // A file's name and its keys stay as they are.
    const options::option* o = options::find_field(what.substr(0, what.find_first_of(": ")));
    if (o != nullptr && what == o->field_name() && is_option(*o))
        return option_name(*o);
    if (o != nullptr && what.starts_with(fmt::format("{} = ", o->name)))
        return replaced(std::string(what));
    if (o != nullptr && o->field_name().find('_') != std::string_view::npos)
        return replaced(std::string(what));
    return what == "simulate" ? "--simulate" : std::string(what);
}

std::string spell_option(const options::option& o, std::string_view value)
{
    return option_name(o) + (value.empty() ? "" : " ") + std::string(value);
}

} // namespace

std::string option_name(const options::option& o)
{
    std::string name = fmt::format("--{}", o.name);
    std::replace(name.begin() + 2, name.end(), '_', '-');
    return name;
}

std::string spelled(std::string_view marked)
{
    return options::spell_marks(marked, spell_option);
}

error in_options(const error& e)
{
    const error marked = options::spell_marks(e, spell_option);
    return marked.reworded(subject(marked.subject()), marked.why(),
                           replaced(std::string(marked.hint()), e.place().line != 0));
}

} // namespace tactor::cli
